//! Long work: kept in records, so that it goes on after a restart; bounded, and fair between clients.
//!
//! A job is stored before it is acknowledged. What it has finished (its checkpoint, its lines of log, its pieces) is stored
//! as it goes; a job that was cut short waits again when the server starts, and goes on from there.

pub mod batch;
pub mod ingest;
mod queue;
mod record;
pub mod research;
mod run;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use d3dgen_store::{Batch, KeyRange, Store};
use tokio::sync::{Notify, watch};
use tonic::Status;

use crate::clock::Clock;
use crate::config;
use crate::error::Error;
use crate::metrics::Metrics;
use crate::own::{self, JOB_LOGS, JOBS};
use crate::pool::Stop;
use crate::status;
use queue::Queue;

pub use record::{Failure, Job, Level, Line, Spec, State};
pub use run::Run;

/// When to come back after the queue was full.
const RETRY: Duration = Duration::from_secs(10);
/// Lines of a job's log that are kept.
const LINES: u64 = 10_000;
/// How often a job may be cut short without having finished anything in between.
const CUT_SHORT: u32 = 5;
/// Records removed with one batch.
const REMOVED: usize = 2000;

/// All jobs of a server.
pub struct Jobs {
    store: Store,
    clock: Clock,
    limits: config::Jobs,
    metrics: Arc<Metrics>,
    inner: Mutex<Inner>,
    wake: Notify,
    changed: watch::Sender<u64>,
    stopping: AtomicBool,
}

#[derive(Default)]
struct Inner {
    jobs: BTreeMap<String, Job>,
    queue: Queue,
    running: BTreeMap<String, Stop>,
    next: u64,
}

impl Jobs {
    /// Reads the jobs; those that were cut short wait again.
    ///
    /// # Errors
    /// `Store`; `Record` when one is damaged.
    pub fn open(store: &Store, limits: config::Jobs, clock: Clock, metrics: Arc<Metrics>) -> Result<Self, Error> {
        let mut inner = Inner::default();
        let mut cut = Vec::new();
        own::each(store, JOBS, &KeyRange::all(), |id, mut job: Job| {
            inner.next = inner.next.max(job.number + 1);
            if job.state == State::Running {
                job.cut_short += 1;
                job.state = State::Queued;
                if job.cut_short >= CUT_SHORT {
                    job.state = State::Failed;
                    job.ended_ms = Some(clock.now_ms());
                    job.failure = Some(Failure {
                        code: "INTERNAL".into(),
                        message: format!("the server ended {CUT_SHORT} times while it ran, before any piece was done"),
                        problems: Vec::new(),
                    });
                }
                cut.push(id.to_owned());
            }
            if job.state == State::Queued {
                inner.queue.push(&job.owner, id);
            }
            inner.jobs.insert(id.to_owned(), job);
            Ok(ControlFlow::Continue(()))
        })?;
        let jobs = Self {
            store: store.clone(),
            clock,
            limits,
            metrics,
            inner: Mutex::new(inner),
            wake: Notify::new(),
            changed: watch::Sender::new(0),
            stopping: AtomicBool::new(false),
        };
        for id in cut {
            let what = "the server ended while the job ran; it goes on from what is finished";
            jobs.change(&id, |job, batch| jobs.line(job, batch, Level::Warning, what))?;
        }
        jobs.gauges();
        Ok(jobs)
    }

    /// Keeps a new job and puts it into the queue; `also` goes to the disk with it.
    ///
    /// # Errors
    /// `RESOURCE_EXHAUSTED` when too many wait.
    pub fn start(
        &self,
        owner: &str,
        title: String,
        spec: Spec,
        id: Option<String>,
        also: impl FnOnce(&Job, &mut Batch),
    ) -> Result<Job, Status> {
        let mut inner = self.lock();
        let limits = &self.limits;
        if inner.queue.len() >= limits.waiting {
            return Err(status::exhausted(&format!("{} jobs wait, the limit", limits.waiting), RETRY));
        }
        if inner.queue.len_of(owner) >= limits.waiting_per_client {
            let message = format!("{} jobs of this client wait, the limit", limits.waiting_per_client);
            return Err(status::exhausted(&message, RETRY));
        }
        let number = inner.next;
        let id = id.unwrap_or_else(|| self.id_of(number));
        let job = Job::new(id.clone(), number, owner, title, spec, self.clock.now_ms());
        let mut batch = Batch::new();
        own::put(&mut batch, JOBS, &id, &job);
        also(&job, &mut batch);
        self.store.apply(batch).map_err(status::store)?;
        inner.next += 1;
        inner.queue.push(owner, &id);
        inner.jobs.insert(id, job.clone());
        drop(inner);
        self.tell();
        self.wake.notify_one();
        Ok(job)
    }

    /// Returns the id that the next job would have, for files that are there before it is.
    pub fn reserve(&self) -> String {
        let mut inner = self.lock();
        let number = inner.next;
        inner.next += 1;
        self.id_of(number)
    }

    fn id_of(&self, number: u64) -> String {
        // in the order of their making
        format!("job-{number:08}")
    }

    /// Returns a job.
    pub fn get(&self, id: &str) -> Option<Job> {
        self.lock().jobs.get(id).cloned()
    }

    /// Returns the jobs that fit, newest first.
    pub fn list(&self, fits: impl Fn(&Job) -> bool) -> Vec<Job> {
        let mut found: Vec<Job> = self.lock().jobs.values().filter(|j| fits(j)).cloned().collect();
        found.sort_by_key(|j| std::cmp::Reverse(j.number));
        found
    }

    /// Returns what changes whenever a job does.
    pub fn changes(&self) -> watch::Receiver<u64> {
        self.changed.subscribe()
    }

    /// Returns lines of a job's log with numbers above `after`.
    ///
    /// # Errors
    /// `Store`.
    pub fn lines(&self, id: &str, after: u64, most: usize) -> Result<Vec<Line>, Error> {
        let mut found = Vec::new();
        let range = KeyRange::prefix(format!("{id}/")).after(line_key(id, after));
        own::each(&self.store, JOB_LOGS, &range, |_, line: Line| {
            found.push(line);
            Ok(if found.len() < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
        })?;
        Ok(found)
    }

    /// Asks a job to stop.
    ///
    /// # Errors
    /// `NOT_FOUND`.
    pub fn cancel(&self, id: &str) -> Result<Job, Status> {
        let running = self.lock().running.get(id).cloned();
        let job = self.change(id, |job, batch| {
            if job.state == State::Queued {
                job.state = State::Cancelled;
                job.ended_ms = Some(self.clock.now_ms());
            }
            if !job.state.is_ended() {
                job.cancelled = true;
            }
            self.line(job, batch, Level::Info, "the client asked to stop");
        });
        let job = job.map_err(status::own)?.ok_or_else(|| no_job(id))?;
        if job.state == State::Cancelled {
            self.lock().queue.remove(id);
        }
        if let Some(stop) = running {
            stop.store(true, Ordering::SeqCst);
        }
        self.gauges();
        Ok(job)
    }

    /// Puts an ended job back into the queue.
    ///
    /// # Errors
    /// `NOT_FOUND`; `FAILED_PRECONDITION` for a job that has succeeded or has not ended; `RESOURCE_EXHAUSTED`.
    pub fn resume(&self, id: &str) -> Result<Job, Status> {
        {
            let inner = self.lock();
            let job = inner.jobs.get(id).ok_or_else(|| no_job(id))?;
            match job.state {
                State::Failed | State::Cancelled => {}
                State::Succeeded => return Err(Status::failed_precondition(format!("{id} has succeeded"))),
                _ => return Err(Status::failed_precondition(format!("{id} has not ended"))),
            }
            if inner.queue.len() >= self.limits.waiting {
                return Err(status::exhausted("too many jobs wait", RETRY));
            }
        }
        let job = self.change(id, |job, batch| {
            job.state = State::Queued;
            job.cancelled = false;
            job.failure = None;
            job.ended_ms = None;
            job.cut_short = 0;
            self.line(job, batch, Level::Info, "the client asked to go on");
        });
        let job = job.map_err(status::own)?.ok_or_else(|| no_job(id))?;
        self.lock().queue.push(&job.owner, id);
        self.gauges();
        self.wake.notify_one();
        Ok(job)
    }

    /// Waits for the turn of the next job and marks it as running; none once the server stops.
    pub async fn next(&self) -> Option<(Job, Stop)> {
        loop {
            if self.stopping.load(Ordering::SeqCst) {
                return None;
            }
            let id = self.lock().queue.pop();
            let Some(id) = id else {
                self.wake.notified().await;
                continue;
            };
            let stop = Stop::default();
            let begun = self.change(&id, |job, batch| {
                job.state = State::Running;
                job.runs += 1;
                job.started_ms.get_or_insert(self.clock.now_ms());
                job.stage = "begin".into();
                self.line(job, batch, Level::Info, &format!("begins, run {}", job.runs));
            });
            match begun {
                Ok(Some(job)) if job.cancelled => self.end(&id, Err(Status::cancelled("the client asked to stop"))),
                Ok(Some(job)) => {
                    self.lock().running.insert(id, Arc::clone(&stop));
                    self.gauges();
                    return Some((job, stop));
                }
                Ok(None) => {}
                Err(error) => {
                    tracing::error!(job = id, reason = %error, "job cannot be marked as running");
                    tokio::time::sleep(RETRY).await;
                }
            }
        }
    }

    /// Notes how a run ended.
    pub fn end(&self, id: &str, outcome: Result<serde_json::Value, Status>) {
        let stopping = self.stopping.load(Ordering::SeqCst);
        let ended = self.change(id, |job, batch| {
            let (state, text) = match &outcome {
                Ok(value) => {
                    job.outcome = value.clone();
                    job.fraction = 1.0;
                    (State::Succeeded, "is done".to_owned())
                }
                Err(refused) if gives_way(refused) && !job.cancelled => (State::Queued, "others go first".to_owned()),
                Err(_) if job.cancelled => (State::Cancelled, "stopped as asked; what is finished stays".to_owned()),
                Err(refused) if stopping && refused.code() == tonic::Code::Cancelled => {
                    (State::Queued, "the server stops; the job goes on when it starts again".to_owned())
                }
                Err(refused) => {
                    job.failure = Some(Failure::of(refused));
                    (State::Failed, refused.message().to_owned())
                }
            };
            let level = if state == State::Failed { Level::Error } else { Level::Info };
            job.state = state;
            job.stage = state.name().into();
            if state.is_ended() {
                job.ended_ms = Some(self.clock.now_ms());
            }
            self.line(job, batch, level, &text);
        });
        let mut inner = self.lock();
        inner.running.remove(id);
        if let (Ok(Some(job)), Err(refused)) = (&ended, &outcome)
            && job.state == State::Queued
            && gives_way(refused)
        {
            inner.queue.push(&job.owner, id);
        }
        drop(inner);
        self.wake.notify_one();
        if let Err(error) = ended {
            tracing::error!(job = id, reason = %error, "the end of a job cannot be kept; it begins again at the next start");
        }
        self.gauges();
    }

    /// Tells all jobs to stop and the workers to take no more; those that run wait again at the next start.
    pub fn stop(&self) {
        self.stopping.store(true, Ordering::SeqCst);
        for stop in self.lock().running.values() {
            stop.store(true, Ordering::SeqCst);
        }
        self.wake.notify_waiters();
        self.wake.notify_one();
    }

    /// Returns true when jobs wait for their turn.
    pub fn is_waiting(&self) -> bool {
        self.lock().queue.len() > 0
    }

    /// Returns how many jobs run.
    pub fn running(&self) -> usize {
        self.lock().running.len()
    }

    /// Forgets the oldest ended jobs beyond the number to keep, and returns their ids.
    ///
    /// # Errors
    /// `Store`.
    pub fn forget(&self) -> Result<Vec<String>, Error> {
        let mut inner = self.lock();
        let mut ended: Vec<(u64, String)> =
            inner.jobs.values().filter(|j| j.state.is_ended()).map(|j| (j.number, j.id.clone())).collect();
        ended.sort();
        let many = ended.len().saturating_sub(self.limits.kept);
        let gone: Vec<String> = ended.into_iter().take(many).map(|(_, id)| id).collect();
        for id in &gone {
            for table in [JOB_LOGS, batch::WORLDS] {
                loop {
                    let mut keys = Vec::new();
                    self.store.view()?.scan(table, &KeyRange::prefix(format!("{id}/")), |key, _| {
                        keys.push(key.to_owned());
                        let go_on = keys.len() < REMOVED;
                        Ok::<_, Error>(if go_on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
                    })?;
                    let last = keys.len() < REMOVED;
                    let mut batch = Batch::new();
                    for key in keys {
                        batch.delete(table, key);
                    }
                    self.store.apply(batch)?;
                    if last {
                        break;
                    }
                }
            }
            let mut batch = Batch::new();
            batch.delete(JOBS, id.as_str());
            self.store.apply(batch)?;
            inner.jobs.remove(id);
        }
        Ok(gone)
    }

    /// Changes a job, on the disk first; returns it, or none when there is no such job.
    fn change(&self, id: &str, edit: impl FnOnce(&mut Job, &mut Batch)) -> Result<Option<Job>, Error> {
        let mut inner = self.lock();
        let Some(mut job) = inner.jobs.get(id).cloned() else { return Ok(None) };
        let mut batch = Batch::new();
        edit(&mut job, &mut batch);
        own::put(&mut batch, JOBS, id, &job);
        self.store.apply(batch)?;
        inner.jobs.insert(id.to_owned(), job.clone());
        drop(inner);
        self.tell();
        Ok(Some(job))
    }

    /// Changes what is only shown of a job, in memory.
    fn show(&self, id: &str, edit: impl FnOnce(&mut Job)) {
        if let Some(job) = self.lock().jobs.get_mut(id) {
            edit(job);
        }
        self.tell();
    }

    fn line(&self, job: &mut Job, batch: &mut Batch, level: Level, text: &str) {
        job.lines += 1;
        let line = Line { seq: job.lines, at_ms: self.clock.now_ms(), level, text: text.to_owned() };
        own::put(batch, JOB_LOGS, &line_key(&job.id, line.seq), &line);
        if job.lines > LINES {
            batch.delete(JOB_LOGS, line_key(&job.id, job.lines - LINES));
        }
    }

    fn tell(&self) {
        self.changed.send_modify(|n| *n += 1);
    }

    fn gauges(&self) {
        let inner = self.lock();
        let (waiting, running) = (inner.queue.len(), inner.running.len());
        self.metrics.jobs_waiting.store(i64::try_from(waiting).unwrap_or(i64::MAX), Ordering::Relaxed);
        self.metrics.jobs_running.store(i64::try_from(running).unwrap_or(i64::MAX), Ordering::Relaxed);
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns true when a run has ended to let others go first.
fn gives_way(ended: &Status) -> bool {
    ended.code() == tonic::Code::Unavailable && ended.message() == run::GIVES_WAY
}

fn line_key(id: &str, seq: u64) -> String {
    format!("{id}/{seq:010}")
}

/// Returns the answer to an id that is no job's.
pub fn no_job(id: &str) -> Status {
    Status::not_found(format!("there is no job {:?}", id.chars().take(60).collect::<String>()))
}
