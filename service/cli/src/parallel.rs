//! The same work for many things on several threads; results come in the order of the things, whatever the threads do.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::error::Error;
use crate::interrupt;

/// Returns the number of threads when none is asked for: one for each core.
pub fn default_threads() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// Returns what `work` makes of each item.
///
/// # Errors
/// The first error in the order of the items; `Interrupted` after Ctrl-C.
pub fn map<T: Sync, R: Send>(
    items: &[T],
    threads: usize,
    work: impl Fn(&T) -> Result<R, Error> + Sync,
) -> Result<Vec<R>, Error> {
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<Result<R, Error>>>> = Mutex::new(items.iter().map(|_| None).collect());
    thread::scope(|scope| {
        for _ in 0..threads.clamp(1, items.len().max(1)) {
            scope.spawn(|| {
                while let Some((i, item)) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, items.get(i)?)))
                {
                    let result = interrupt::check().and_then(|()| work(item));
                    let failed = result.is_err();
                    if let Ok(mut results) = results.lock() {
                        results[i] = Some(result);
                    }
                    if failed {
                        next.store(items.len(), Ordering::Relaxed); // nobody begins another one
                    }
                }
            });
        }
    });
    let results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    // items are begun in order, so an error stands before the first one that was not begun
    results.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_keep_their_order_and_errors_stop_the_rest() {
        let items: Vec<u64> = (0..100).collect();
        assert_eq!(map(&items, 4, |i| Ok(i * 2)).unwrap(), items.iter().map(|i| i * 2).collect::<Vec<_>>());
        assert_eq!(map(&items[..0], 4, |i| Ok(*i)).unwrap(), [0; 0]);
        let refused = |i: &u64| if *i == 7 { Err(Error::Input("seven".into())) } else { Ok(*i) };
        assert_eq!(map(&items, 3, refused).unwrap_err().to_string(), "seven");
    }
}
