//! What a call tells its client while it is at work. Whoever makes it never waits: a client that takes slowly finds the
//! oldest passing news gone, and what the call comes to is kept until it is taken or the call ends.

use std::collections::VecDeque;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker};

use tonic::Status;

use crate::pool::{AbortOnDrop, StopOnDrop};

/// News that wait for a client at most, beside what the call comes to.
const WAITING: usize = 64;

/// How much it matters that news arrive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    /// Later news say it again.
    Passing,
    /// Goes only when nothing passing is left to go.
    Kept,
}

/// The end of who makes the news.
pub(super) struct Outbox<T>(Arc<Mutex<Inner<T>>>);

/// The end of the client, with the work that ends when it goes.
pub struct Inbox<T> {
    inner: Arc<Mutex<Inner<T>>>,
    _work: (StopOnDrop, AbortOnDrop),
}

struct Inner<T> {
    waiting: VecDeque<(Weight, T)>,
    /// What comes last, once there is to be nothing more.
    last: Option<Result<T, Status>>,
    ended: bool,
    reader: Option<Waker>,
}

impl<T> Clone for Outbox<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Outbox<T> {
    pub(super) fn new() -> Self {
        Self(Arc::new(Mutex::new(Inner { waiting: VecDeque::new(), last: None, ended: false, reader: None })))
    }

    /// Returns the client's end; `stop` tells the work that the client is gone, `queue` is the task that waits for it.
    pub(super) fn inbox(&self, stop: StopOnDrop, queue: AbortOnDrop) -> Inbox<T> {
        Inbox { inner: Arc::clone(&self.0), _work: (stop, queue) }
    }

    /// Tells something. Never waits.
    pub(super) fn tell(&self, weight: Weight, news: T) {
        let mut inner = locked(&self.0);
        if inner.ended {
            return;
        }
        if inner.waiting.len() >= WAITING {
            let oldest = inner.waiting.iter().position(|(weight, _)| *weight == Weight::Passing).unwrap_or_default();
            inner.waiting.remove(oldest);
        }
        inner.waiting.push_back((weight, news));
        wake(inner);
    }

    /// Tells what the call came to: it arrives after everything else. Only the first end counts.
    pub(super) fn end(&self, last: Result<T, Status>) {
        let mut inner = locked(&self.0);
        if !inner.ended {
            inner.ended = true;
            inner.last = Some(last);
            wake(inner);
        }
    }
}

fn locked<T>(inner: &Mutex<Inner<T>>) -> MutexGuard<'_, Inner<T>> {
    inner.lock().unwrap_or_else(PoisonError::into_inner)
}

fn wake<T>(mut inner: MutexGuard<'_, Inner<T>>) {
    let reader = inner.reader.take();
    drop(inner);
    if let Some(reader) = reader {
        reader.wake();
    }
}

impl<T> tokio_stream::Stream for Inbox<T> {
    type Item = Result<T, Status>;

    fn poll_next(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Self::Item>> {
        let mut inner = locked(&self.inner);
        if let Some((_, news)) = inner.waiting.pop_front() {
            return Poll::Ready(Some(Ok(news)));
        }
        if inner.ended {
            return Poll::Ready(inner.last.take());
        }
        inner.reader = Some(context.waker().clone());
        Poll::Pending
    }
}

#[cfg(test)]
mod tests {
    use tokio_stream::StreamExt;

    use super::*;
    use crate::pool::{self, Stop};

    #[tokio::test]
    async fn nobody_waits_for_a_client_and_the_end_arrives() {
        let outbox = Outbox::new();
        let stop = Stop::default();
        let inbox = outbox.inbox(StopOnDrop(Arc::clone(&stop)), pool::spawn(std::future::pending()));
        for n in 0..10 * WAITING {
            outbox.tell(if n % 100 == 1 { Weight::Kept } else { Weight::Passing }, n);
        }
        outbox.end(Ok(usize::MAX));
        outbox.end(Err(Status::cancelled("too late")));
        outbox.tell(Weight::Kept, 0);
        let taken: Vec<usize> = inbox.map(|n| n.unwrap()).collect().await;
        let kept: Vec<usize> = taken.iter().copied().filter(|n| n % 100 == 1).collect();
        assert_eq!(kept, [1, 101, 201, 301, 401, 501, 601]);
        assert!(taken.len() == WAITING + 1 && taken.last() == Some(&usize::MAX) && taken.is_sorted(), "{taken:?}");
        assert!(stop.load(std::sync::atomic::Ordering::SeqCst), "the work hears that its client is gone");
    }
}
