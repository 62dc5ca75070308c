//! A worker: takes blocks of any run, makes them, lays them into the store.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use async_nats::jetstream::consumer::PullConsumer;
use async_nats::jetstream::{AckKind, Message};
use d3dgen_export::models::KeptModels;

use super::queue::{Ticket, take};
use super::{Objects, Poison, Queue, Run, failed, places};
use crate::digest::sha256;
use crate::error::Error;
use crate::maker::Maker;
use crate::pack::block;
use crate::part::{Done, outcomes, worlds_in};
use crate::snapshot::Snapshot;
use crate::spec::Spec;
use crate::tasks::Tasks;

/// How often a worker looks for runs that have begun or ended.
const LOOK: Duration = Duration::from_secs(3);
/// How long a block rests that could not be made or stored, the first time; twice as long each further time.
const REST: Duration = Duration::from_secs(5);
/// How long it rests at most.
const LONGEST_REST: Duration = Duration::from_secs(300);
/// How often a worker tries to reach the queue when it begins.
const MOST_ATTEMPTS: u32 = 20;
/// Runs whose domains a worker keeps in memory.
const MOST_RUNS: usize = 4;

/// What a worker has done, for metrics.
#[derive(Debug, Default)]
pub struct Counters {
    /// Blocks in the ledger by this worker.
    pub blocks: AtomicU64,
    /// Worlds in them.
    pub worlds: AtomicU64,
    /// Tasks in them that came to none.
    pub failed: AtomicU64,
    /// Bytes in them.
    pub bytes: AtomicU64,
    /// Blocks that somebody else had done already.
    pub doubled: AtomicU64,
    /// Blocks given back after an error.
    pub errors: AtomicU64,
    /// Blocks set aside.
    pub poisoned: AtomicU64,
    /// Blocks in hand now.
    pub in_hand: AtomicU64,
}

/// A worker.
pub struct Worker {
    /// Where blocks come from.
    pub queue: Queue,
    /// Where results go.
    pub objects: Objects,
    /// Models of the asset database, for formats with models.
    pub kept: Arc<dyn KeptModels + Send>,
    /// What it has done.
    pub counters: Arc<Counters>,
    /// Set when it is to end.
    pub cancelled: &'static AtomicBool,
    /// How long it waits for blocks before it ends; for ever when absent.
    pub idle: Option<Duration>,
    runs: Mutex<BTreeMap<String, Arc<Prepared>>>,
}

/// A run that a worker makes blocks of.
struct Prepared {
    run: Run,
    tasks: Tasks,
    maker: Maker<'static>,
}

impl Worker {
    /// Returns a worker.
    pub fn new(
        queue: Queue,
        objects: Objects,
        kept: Arc<dyn KeptModels + Send>,
        cancelled: &'static AtomicBool,
    ) -> Self {
        let (counters, runs) = (Arc::default(), Mutex::default());
        Self { queue, objects, kept, counters, cancelled, idle: None, runs }
    }

    /// Takes blocks with some hands at once until it is to end; `say` hears of what goes wrong.
    ///
    /// # Errors
    /// `Cluster` when the queue cannot be used at all.
    pub async fn work(
        self: Arc<Self>,
        hands: usize,
        say: impl Fn(String) + Send + Sync + 'static,
    ) -> Result<(), Error> {
        for attempt in 1.. {
            match self.queue.runs().await {
                Ok(_) => break,
                Err(error) if attempt >= MOST_ATTEMPTS => return Err(error),
                Err(error) => say(error.to_string()),
            }
            tokio::time::sleep(LOOK).await;
        }
        let say: Arc<dyn Fn(String) + Send + Sync> = Arc::new(say);
        let mut all = tokio::task::JoinSet::new();
        for _ in 0..hands.max(1) {
            let (worker, say) = (Arc::clone(&self), Arc::clone(&say));
            all.spawn(async move { worker.hand(&*say).await });
        }
        while all.join_next().await.is_some() {}
        Ok(())
    }

    fn ends(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// One hand: a turn for each run in rotation, as many as its priority, so that no run waits for another to end.
    async fn hand(self: Arc<Self>, say: &(dyn Fn(String) + Send + Sync)) {
        let mut idle = Duration::ZERO;
        while !self.ends() && self.idle.is_none_or(|most| idle < most) {
            let turns = self.turns().await.unwrap_or_else(|error| {
                say(error.to_string());
                Vec::new()
            });
            let mut took = false;
            for (name, consumer, turns) in &turns {
                took |= self.turns_of(name, consumer, *turns, say).await;
            }
            if turns.is_empty() {
                tokio::time::sleep(LOOK).await;
            }
            let waited = if turns.is_empty() { LOOK } else { Duration::from_secs(turns.len() as u64) };
            idle = if took { Duration::ZERO } else { idle + waited };
        }
    }

    /// Gives a run its turns; false when it had no block.
    async fn turns_of(
        &self,
        run: &str,
        consumer: &PullConsumer,
        turns: u8,
        say: &(dyn Fn(String) + Send + Sync),
    ) -> bool {
        let mut took = false;
        for _ in 0..turns {
            match self.turn(run, consumer, say).await {
                Ok(true) => took = true,
                Ok(false) => break,
                Err(error) => {
                    say(error.to_string());
                    tokio::time::sleep(Duration::from_secs(1)).await;
                    break;
                }
            }
        }
        took
    }

    /// Returns the runs of the queue with how many turns each has.
    async fn turns(&self) -> Result<Vec<(String, PullConsumer, u8)>, Error> {
        let mut turns = Vec::new();
        for name in self.queue.runs().await? {
            let Some(consumer) = self.queue.join(&name).await? else { continue };
            let known = self.known(&name);
            turns.push((name, consumer, known.map_or(1, |p| p.run.priority.max(1))));
        }
        Ok(turns)
    }

    fn known(&self, run: &str) -> Option<Arc<Prepared>> {
        self.runs.lock().unwrap_or_else(PoisonError::into_inner).get(run).cloned()
    }

    /// Takes a block of a run and deals with it; false when the run has none now.
    async fn turn(
        &self,
        run: &str,
        consumer: &PullConsumer,
        say: &(dyn Fn(String) + Send + Sync),
    ) -> Result<bool, Error> {
        if self.ends() {
            return Ok(false);
        }
        let Some(message) = take(consumer).await? else { return Ok(false) };
        self.counters.in_hand.fetch_add(1, Ordering::Relaxed);
        let dealt = self.deal(run, &message).await;
        self.counters.in_hand.fetch_sub(1, Ordering::Relaxed);
        match dealt {
            Ok(()) => {}
            Err(Error::Interrupted) => answer(&message, AckKind::Nak(None)).await?,
            Err(error) => {
                self.counters.errors.fetch_add(1, Ordering::Relaxed);
                say(format!("{run}: {error}"));
                self.give_back(run, &message, &error).await?;
                tokio::time::sleep(Duration::from_secs(1)).await;
            }
        }
        Ok(true)
    }

    /// Gives a block back that could not be made or stored; the last one that may take it sets it aside with the reason.
    async fn give_back(&self, run: &str, message: &Message, error: &Error) -> Result<(), Error> {
        let deliveries = message.info().map_or(1, |info| info.delivered);
        let ticket = serde_json::from_slice::<Ticket>(&message.payload).ok();
        if let Some(ticket) = ticket.filter(|_| deliveries >= i64::from(self.queue.settings().deliveries)) {
            let reason = format!("{deliveries} workers took it, and the last one ended with: {error}");
            return self.set_aside(run, ticket.block, reason, message).await;
        }
        answer(message, AckKind::Nak(Some(rest(deliveries)))).await
    }

    async fn deal(&self, run: &str, message: &Message) -> Result<(), Error> {
        let unreadable =
            |e: &dyn std::fmt::Display| Error::Cluster(format!("a message of the queue cannot be read: {e}"));
        let ticket: Ticket = serde_json::from_slice(&message.payload).map_err(|e| unreadable(&e))?;
        let deliveries = message.info().map_err(|e| unreadable(&e))?.delivered;
        let line = places::line(run, ticket.block);
        if self.objects.get(&line).await?.is_some() {
            self.counters.doubled.fetch_add(1, Ordering::Relaxed);
            return answer(message, AckKind::Ack).await;
        }
        if deliveries > i64::from(self.queue.settings().deliveries) {
            let reason = format!("{} workers took it and none came back with it", deliveries - 1);
            return self.set_aside(run, ticket.block, reason, message).await;
        }
        let prepared = self.prepared(run).await?;
        let (bytes, worlds, tasks) = self.make(prepared, ticket.block, message).await?;
        let done = Done {
            block: ticket.block,
            sha256: sha256(&bytes),
            bytes: bytes.len() as u64,
            worlds,
            failed: tasks - worlds,
        };
        self.objects.put_new(&places::blob(&done.sha256), bytes).await?;
        self.enter(&line, &done).await?;
        answer(message, AckKind::Ack).await
    }

    /// Writes a block into the ledger; where another worker did, it must say the same.
    async fn enter(&self, line: &str, done: &Done) -> Result<(), Error> {
        let text = serde_json::to_vec(done).expect("it has string keys only");
        if self.objects.put_new(line, text.clone()).await? {
            for (counter, n) in [
                (&self.counters.blocks, 1),
                (&self.counters.worlds, done.worlds),
                (&self.counters.failed, done.failed),
                (&self.counters.bytes, done.bytes),
            ] {
                counter.fetch_add(n, Ordering::Relaxed);
            }
            return Ok(());
        }
        self.counters.doubled.fetch_add(1, Ordering::Relaxed);
        match self.objects.get(line).await? {
            Some(there) if there == text => Ok(()),
            _ => Err(Error::Cluster(format!(
                "{line} says other bytes than this worker made: the builds of two workers differ"
            ))),
        }
    }

    async fn set_aside(&self, run: &str, block: u64, reason: String, message: &Message) -> Result<(), Error> {
        let poison = serde_json::to_vec(&Poison { block, reason }).expect("it has string keys only");
        self.objects.put_new(&places::poisoned(run, block), poison).await?;
        self.counters.poisoned.fetch_add(1, Ordering::Relaxed);
        answer(message, AckKind::Term).await
    }

    /// Makes a block on a thread of its own, with a sign of life to the queue meanwhile.
    async fn make(
        &self,
        prepared: Arc<Prepared>,
        number: u64,
        message: &Message,
    ) -> Result<(Vec<u8>, u64, u64), Error> {
        let cancelled = self.cancelled;
        let mut made = tokio::task::spawn_blocking(move || {
            let from = number * prepared.run.tasks_per_block;
            let range = from..(from + prepared.run.tasks_per_block).min(prepared.tasks.len());
            let count = range.end.saturating_sub(range.start);
            let outcomes = outcomes(&prepared.tasks, range, &mut prepared.maker.bench(), cancelled)?;
            Ok((block(&outcomes), worlds_in(&outcomes), count))
        });
        let mut sign = tokio::time::interval(self.queue.settings().lease / 3);
        loop {
            tokio::select! {
                made = &mut made => return made.map_err(|e| failed("a block")(&e))?,
                _ = sign.tick() => {
                    let _ = message.ack_with(AckKind::Progress).await; // the next one may get through
                }
            }
        }
    }

    /// Returns the spec and the domains of a run, read from the store once.
    async fn prepared(&self, name: &str) -> Result<Arc<Prepared>, Error> {
        if let Some(known) = self.known(name) {
            return Ok(known);
        }
        let missing =
            |place: &str| Error::Cluster(format!("the store has no {place}: worker and leader use different stores"));
        let get = async |place: String| self.objects.get(&place).await?.ok_or_else(|| missing(&place));
        let run: Run = serde_json::from_slice(&get(places::about(name)).await?)
            .map_err(|e| Error::Cluster(format!("{}: {e}", places::about(name))))?;
        let spec_text = get(places::spec(name)).await?;
        let spec = Spec::from_toml(&String::from_utf8_lossy(&spec_text), &places::spec(name))?;
        let bytes = get(places::snapshot(&run.snapshot)).await?;
        let (kept, file) = (Arc::clone(&self.kept), run.snapshot.clone());
        let prepare = move || -> Result<Prepared, Error> {
            let snapshot = Snapshot::from_bytes(&bytes, std::path::Path::new(&file))?;
            let tasks = Tasks::of(&spec).map_err(Error::Input)?;
            let maker = Maker::of_shared(&spec, &snapshot, kept)?;
            Ok(Prepared { run, tasks, maker })
        };
        let prepared = tokio::task::spawn_blocking(prepare).await.map_err(|e| failed("a run")(&e))??;
        let prepared = Arc::new(prepared);
        let mut runs = self.runs.lock().unwrap_or_else(PoisonError::into_inner);
        if runs.len() >= MOST_RUNS {
            runs.clear();
        }
        runs.insert(name.to_owned(), Arc::clone(&prepared));
        Ok(prepared)
    }
}

/// Returns how long a block rests after it was taken so often in vain.
fn rest(deliveries: i64) -> Duration {
    let doublings = u32::try_from(deliveries - 1).unwrap_or(0).min(16);
    REST.saturating_mul(1 << doublings).min(LONGEST_REST)
}

async fn answer(message: &Message, kind: AckKind) -> Result<(), Error> {
    // with the queue's word that it heard: an answer that is lost only costs a second making
    let heard = message.double_ack_with(kind).await;
    heard.map_err(|e| failed("the queue does not hear an answer")(&e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_that_fails_again_rests_longer() {
        let rests: Vec<u64> = [0, 1, 2, 3, 7, 8, 1000].into_iter().map(|n| rest(n).as_secs()).collect();
        assert_eq!(rests, [5, 5, 10, 20, 300, 300, 300]);
    }
}
