//! Threads for what takes the processor: bounded, with a bounded number of calls that wait, and told when nobody waits for
//! the answer any more.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use tokio::sync::Semaphore;
use tonic::Status;

use crate::metrics::{Metrics, Raised};
use crate::status;

/// How long to wait before trying again when too many wait.
const RETRY: Duration = Duration::from_millis(500);
/// Lookups at a time for each thread that works: they are short and mostly wait for memory.
pub(crate) const LOOKUPS: usize = 4;

/// Set when nobody waits for an answer any more; work looks at it now and then.
pub type Stop = Arc<AtomicBool>;

/// Sets a [`Stop`] when it is dropped: when the call ended, the client went away, or the deadline passed.
#[derive(Debug)]
pub struct StopOnDrop(pub Stop);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

/// What work is like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lane {
    /// Milliseconds: searches, records.
    Lookup,
    /// Longer: stages, checks, exports.
    Work,
}

/// The threads.
#[derive(Debug)]
pub struct Pool {
    lookups: Arc<Semaphore>,
    work: Arc<Semaphore>,
    waiting: AtomicUsize,
    limit: usize,
    metrics: Arc<Metrics>,
}

impl Pool {
    /// Returns a pool of so many threads, for whose turn at most `limit` calls wait.
    pub fn new(threads: usize, limit: usize, metrics: Arc<Metrics>) -> Self {
        Self {
            lookups: Arc::new(Semaphore::new(threads * LOOKUPS)),
            work: Arc::new(Semaphore::new(threads)),
            waiting: AtomicUsize::new(0),
            limit,
            metrics,
        }
    }

    /// Does work on a thread and returns its answer. When the future is dropped, the flag that the work was given is set.
    ///
    /// # Errors
    /// What the work returns; `RESOURCE_EXHAUSTED` when too many wait; `INTERNAL` when the work panicked.
    pub async fn run<T: Send + 'static>(
        &self,
        lane: Lane,
        work: impl FnOnce(&AtomicBool) -> Result<T, Status> + Send + 'static,
    ) -> Result<T, Status> {
        let stop = Stop::default();
        let _guard = StopOnDrop(Arc::clone(&stop));
        self.run_with(lane, stop, move |stop| work(stop)).await
    }

    /// Does as [`Pool::run`], with a flag of the caller, which the caller sets.
    ///
    /// # Errors
    /// As [`Pool::run`].
    pub async fn run_with<T: Send + 'static>(
        &self,
        lane: Lane,
        stop: Stop,
        work: impl FnOnce(&AtomicBool) -> Result<T, Status> + Send + 'static,
    ) -> Result<T, Status> {
        let semaphore = match lane {
            Lane::Lookup => &self.lookups,
            Lane::Work => &self.work,
        };
        let permit = match Arc::clone(semaphore).try_acquire_owned() {
            Ok(permit) => permit,
            Err(_) => {
                let _place = Waiting::new(self)?;
                let permit = Arc::clone(semaphore).acquire_owned().await;
                permit.map_err(|_| Status::unavailable("the server is stopping"))?
            }
        };
        let metrics = Arc::clone(&self.metrics);
        let done = tokio::task::spawn_blocking(move || {
            let _busy = Raised::new(&metrics.threads_busy);
            let _permit = permit; // until the work is done, whoever waits for it
            if stop.load(Ordering::SeqCst) {
                return Err(Status::cancelled("the call was given up"));
            }
            work(&stop)
        });
        done.await.unwrap_or_else(|panic| Err(status::internal(&panic)))
    }
}

/// A place among those who wait.
struct Waiting<'a> {
    pool: &'a Pool,
    _gauge: Raised<'a>,
}

impl<'a> Waiting<'a> {
    fn new(pool: &'a Pool) -> Result<Self, Status> {
        if pool.waiting.fetch_add(1, Ordering::SeqCst) >= pool.limit {
            pool.waiting.fetch_sub(1, Ordering::SeqCst);
            return Err(status::exhausted("too many calls wait for a thread", RETRY));
        }
        Ok(Self { pool, _gauge: Raised::new(&pool.metrics.waiting) })
    }
}

impl Drop for Waiting<'_> {
    fn drop(&mut self) {
        self.pool.waiting.fetch_sub(1, Ordering::SeqCst);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn work_beyond_the_bound_is_refused_and_dropped_calls_stop_theirs() {
        let pool = Arc::new(Pool::new(1, 1, Arc::default()));
        let (begun, wait) = tokio::sync::oneshot::channel();
        let long = {
            let pool = Arc::clone(&pool);
            tokio::spawn(async move {
                pool.run(Lane::Work, move |stop| {
                    let _ = begun.send(());
                    while !stop.load(Ordering::SeqCst) {
                        std::thread::sleep(Duration::from_millis(1));
                    }
                    Err::<(), _>(Status::cancelled("stopped"))
                })
                .await
            })
        };
        wait.await.unwrap();
        let second = {
            let pool = Arc::clone(&pool);
            tokio::spawn(async move { pool.run(Lane::Work, |_| Ok(2)).await })
        };
        while pool.waiting.load(Ordering::SeqCst) == 0 {
            tokio::task::yield_now().await;
        }
        let third = pool.run(Lane::Work, |_| Ok(3)).await.unwrap_err();
        assert_eq!(third.code(), tonic::Code::ResourceExhausted);
        assert!(third.metadata().contains_key("retry-after"));
        long.abort();
        assert_eq!(second.await.unwrap().unwrap(), 2);
        let broken = pool.run::<()>(Lane::Work, |_| panic!("a bug")).await.unwrap_err();
        assert_eq!(broken.code(), tonic::Code::Internal);
        assert_eq!(pool.run(Lane::Lookup, |_| Ok(4)).await.unwrap(), 4);
    }
}
