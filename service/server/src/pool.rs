//! Threads for what takes the processor: in lanes, so that short work does not wait behind long, bounded, with a bounded
//! number of calls that wait, and told when nobody waits for the answer any more.
//!
//! No thread waits for a client: what it makes is handed to the call ([`crate::grpc`]), which the client takes from as it can.

use std::collections::BTreeMap;
use std::future::Future;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::Semaphore;
use tonic::Status;

use crate::metrics::{Metrics, Raised};
use crate::status;

/// How long to wait before trying again when too many wait.
const RETRY: Duration = Duration::from_millis(500);
/// Lookups at a time for each thread that works: they are short and mostly wait for memory.
const LOOKUPS: usize = 4;
/// How long work may go on after its deadline: it looks now and then whether it is to stop.
const GRACE: Duration = Duration::from_secs(5);

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
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lane {
    /// Milliseconds: searches, records.
    Lookup,
    /// Tens of milliseconds: sentences read, rooms listed.
    Short,
    /// Longer: stages, checks, exports.
    Work,
    /// Changes, one at a time; whoever waits for its turn holds no thread.
    Write,
}

impl Lane {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Lookup, Self::Short, Self::Work, Self::Write];

    /// Returns its name, for logs and health.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lookup => "lookup",
            Self::Short => "short",
            Self::Work => "work",
            Self::Write => "write",
        }
    }

    /// Returns how many work in it at a time, for so many threads of the server.
    fn width(self, threads: usize) -> usize {
        match self {
            Self::Lookup => threads * LOOKUPS,
            Self::Short | Self::Work => threads,
            Self::Write => 1,
        }
    }
}

/// The call that work is for.
#[derive(Debug, Clone)]
pub struct Asked {
    /// Path of its method.
    pub method: Arc<str>,
    /// Its request id.
    pub id: Arc<str>,
    /// Its deadline.
    pub until: Instant,
}

tokio::task_local! {
    static ASKED: Asked;
}

/// Runs the handler of a call; work that it hands to a pool is known as the call's.
pub fn asked<F: Future>(call: Asked, handler: F) -> impl Future<Output = F::Output> {
    ASKED.scope(call, handler)
}

/// Runs a part of a call's handler in a task of its own, which ends when what this returns is dropped.
pub fn spawn(part: impl Future<Output = ()> + Send + 'static) -> AbortOnDrop {
    let task = match ASKED.try_with(Clone::clone) {
        Ok(call) => tokio::spawn(ASKED.scope(call, part)),
        Err(_) => tokio::spawn(part),
    };
    AbortOnDrop(task.abort_handle())
}

/// A task that ends when this is dropped.
#[derive(Debug)]
pub struct AbortOnDrop(tokio::task::AbortHandle);

impl Drop for AbortOnDrop {
    fn drop(&mut self) {
        self.0.abort();
    }
}

/// The threads.
#[derive(Debug)]
pub struct Pool {
    threads: usize,
    lanes: [Arc<Semaphore>; Lane::ALL.len()],
    waiting: AtomicUsize,
    limit: usize,
    metrics: Arc<Metrics>,
    begun: Arc<Mutex<BTreeMap<u64, Begun>>>,
    next: AtomicU64,
}

/// Work on a thread.
#[derive(Debug)]
struct Begun {
    lane: Lane,
    call: Option<Asked>,
    since: Instant,
    /// True once it was said that it is overdue.
    told: bool,
}

/// Work that goes on although nobody can be waiting for it any more.
#[derive(Debug, Clone)]
pub struct Overdue {
    /// Its lane.
    pub lane: Lane,
    /// Path of the method.
    pub method: Arc<str>,
    /// Id of the call.
    pub request_id: Arc<str>,
    /// How long it has been on its thread.
    pub time: Duration,
    /// True when this is told for the first time.
    pub is_new: bool,
}

impl Pool {
    /// Returns a pool of so many threads, for whose turn at most `limit` calls wait.
    pub fn new(threads: usize, limit: usize, metrics: Arc<Metrics>) -> Self {
        Self {
            threads,
            lanes: Lane::ALL.map(|lane| Arc::new(Semaphore::new(lane.width(threads)))),
            waiting: AtomicUsize::new(0),
            limit,
            metrics,
            begun: Arc::default(),
            next: AtomicU64::new(0),
        }
    }

    /// Returns how many threads the lanes of so many threads of a server need.
    pub fn threads_for(threads: usize) -> usize {
        Lane::ALL.map(|lane| lane.width(threads)).into_iter().sum()
    }

    /// Does work on a thread and returns its answer. When the future is dropped, the flag that the work was given is set,
    /// and work that has not begun leaves the queue.
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
        let semaphore = &self.lanes[lane as usize];
        let permit = match Arc::clone(semaphore).try_acquire_owned() {
            Ok(permit) => permit,
            Err(_) => {
                let permit = self.waits(Arc::clone(semaphore).acquire_owned()).await?;
                permit.map_err(|_| Status::unavailable("the server is stopping"))?
            }
        };
        let metrics = Arc::clone(&self.metrics);
        let noted = self.note(lane);
        let done = tokio::task::spawn_blocking(move || {
            let _busy = Raised::new(&metrics.threads_busy);
            let _held = (permit, noted); // until the work is done, whoever waits for it
            if stop.load(Ordering::SeqCst) {
                return Err(Status::cancelled("the call was given up"));
            }
            work(&stop)
        });
        done.await.unwrap_or_else(|panic| Err(status::internal(&panic)))
    }

    /// Waits for something, in a place among those who wait.
    ///
    /// # Errors
    /// `RESOURCE_EXHAUSTED` when too many wait.
    pub async fn waits<T>(&self, until: impl Future<Output = T>) -> Result<T, Status> {
        let _place = Waiting::new(self)?;
        Ok(until.await)
    }

    /// Returns the work that goes on well after its deadline, and remembers that it was told.
    pub fn overdue(&self) -> Vec<Overdue> {
        let now = Instant::now();
        let mut begun = locked(&self.begun);
        let late = begun.values_mut().filter_map(|work| {
            let call = work.call.as_ref().filter(|call| now > call.until + GRACE)?;
            let (method, request_id) = (Arc::clone(&call.method), Arc::clone(&call.id));
            let is_new = !std::mem::replace(&mut work.told, true);
            Some(Overdue { lane: work.lane, method, request_id, time: now - work.since, is_new })
        });
        late.collect()
    }

    /// Returns the lanes in which such work has taken every place.
    pub fn stuck(&self, overdue: &[Overdue]) -> Vec<Lane> {
        let held = |lane: &Lane| overdue.iter().filter(|o| o.lane == *lane).count();
        Lane::ALL.into_iter().filter(|lane| held(lane) >= lane.width(self.threads)).collect()
    }

    fn note(&self, lane: Lane) -> Noted {
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        let call = ASKED.try_with(Clone::clone).ok();
        locked(&self.begun).insert(id, Begun { lane, call, since: Instant::now(), told: false });
        Noted { begun: Arc::clone(&self.begun), id }
    }
}

fn locked(begun: &Mutex<BTreeMap<u64, Begun>>) -> MutexGuard<'_, BTreeMap<u64, Begun>> {
    begun.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Work that is known to be on a thread, for as long as this lives.
struct Noted {
    begun: Arc<Mutex<BTreeMap<u64, Begun>>>,
    id: u64,
}

impl Drop for Noted {
    fn drop(&mut self) {
        locked(&self.begun).remove(&self.id);
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

    /// Begins work that goes on until it is told to stop.
    async fn long(pool: &Arc<Pool>, call: Asked) -> tokio::task::JoinHandle<Result<(), Status>> {
        let (begun, wait) = tokio::sync::oneshot::channel();
        let pool = Arc::clone(pool);
        let work = tokio::spawn(asked(call, async move {
            let until_told = |stop: &AtomicBool| {
                let _ = begun.send(());
                while !stop.load(Ordering::SeqCst) {
                    std::thread::sleep(Duration::from_millis(1));
                }
                Err::<(), _>(Status::cancelled("stopped"))
            };
            pool.run(Lane::Work, until_told).await
        }));
        wait.await.unwrap();
        work
    }

    fn call(until: Instant) -> Asked {
        Asked { method: "/a/B".into(), id: "1".into(), until }
    }

    #[tokio::test]
    async fn work_beyond_the_bound_is_refused_and_dropped_calls_stop_theirs() {
        let pool = Arc::new(Pool::new(1, 1, Arc::default()));
        let long = long(&pool, call(Instant::now() + Duration::from_secs(60))).await;
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
        // short work has a lane of its own
        assert_eq!(pool.run(Lane::Short, |_| Ok(5)).await.unwrap(), 5);
        long.abort();
        assert_eq!(second.await.unwrap().unwrap(), 2);
        let broken = pool.run::<()>(Lane::Work, |_| panic!("a bug")).await.unwrap_err();
        assert_eq!(broken.code(), tonic::Code::Internal);
        assert_eq!(pool.run(Lane::Lookup, |_| Ok(4)).await.unwrap(), 4);
    }

    #[tokio::test]
    async fn work_older_than_its_deadline_is_told_once_and_sticks_its_lane() {
        let pool = Arc::new(Pool::new(1, 1, Arc::default()));
        let past = Instant::now().checked_sub(GRACE + Duration::from_secs(1)).unwrap();
        let work = long(&pool, call(past)).await;
        let late = pool.overdue();
        assert!(late.len() == 1 && late[0].is_new && &*late[0].method == "/a/B", "{late:?}");
        assert_eq!(pool.stuck(&late), [Lane::Work]);
        assert!(!pool.overdue()[0].is_new);
        work.abort();
        while !pool.overdue().is_empty() {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
        assert!(pool.stuck(&[]).is_empty());
    }
}
