//! The leader of a run: puts its blocks into the queue, again and again what the ledger lacks, and brings the results home.
//! It may die at any time: another one that is started with the same spec goes on.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::queue::Ticket;
use super::{Objects, Poison, Queue, Run, places, run_id};
use crate::digest::sha256;
use crate::error::Error;
use crate::part::{Done, Part};

/// How often the leader reads the ledger.
const LOOK: Duration = Duration::from_secs(2);
/// Most blocks that are in the queue at once.
const MOST_QUEUED: u64 = 2_000;
/// Looks at an idle queue after which what the ledger lacks is put in again.
const PATIENCE: u32 = 2;
/// Rounds in a row that may fail: a few minutes, the time-outs of queue and store aside.
const MOST_FAILURES: u32 = 60;

/// A leader.
pub struct Leader<'p> {
    /// The part that results are brought into.
    pub part: &'p Part,
    /// The queue.
    pub queue: Queue,
    /// The store that workers lay results into.
    pub objects: Objects,
    /// Turns that workers give the run for each turn of a run of priority 1.
    pub priority: u8,
}

/// How far a run is.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Standing {
    /// Blocks in the ledger.
    pub done: u64,
    /// Blocks that wait in the queue.
    pub waiting: u64,
    /// Blocks in the hands of workers.
    pub in_hand: u64,
    /// Blocks that were put in again because the queue had lost them.
    pub again: u64,
}

/// What a leader remembers from round to round.
#[derive(Debug, Default)]
struct Round {
    standing: Standing,
    announced: bool,
    /// Blocks that were put into the queue in this pass.
    queued: BTreeSet<u64>,
    /// Tells what is put in again from what is only said twice.
    pass: u64,
    /// Rounds in which the queue had nothing for anybody.
    idle: u32,
    /// Blocks set aside, once nothing else is missing.
    aside: Vec<Poison>,
}

/// Hears of a block that came home, or of none, with how far the run is; its error ends the run.
type News<'a> = dyn Fn(Option<&Done>, &Standing) -> Result<(), Error> + Sync + 'a;

impl Leader<'_> {
    /// Leads the run to its end; `news` hears of each block that came home, and now and then how far the run is.
    ///
    /// # Errors
    /// `Interrupted`; `Cluster` when queue or store fail for good, or with the blocks that were set aside.
    pub async fn lead(&self, cancelled: &AtomicBool, news: &News<'_>) -> Result<(), Error> {
        let run = run_id(self.part);
        let mut round = Round::default();
        let mut failures = 0;
        loop {
            if cancelled.load(Ordering::Relaxed) {
                return Err(Error::Interrupted);
            }
            match self.round(&run, &mut round, news).await {
                Ok(true) => break,
                Ok(false) => failures = 0,
                // a server that elects another one, a store that is full for a while
                Err(Error::Cluster(_)) if failures < MOST_FAILURES && round.aside.is_empty() => {
                    failures += 1;
                    round.announced = false;
                }
                Err(error) => return Err(error),
            }
            tokio::time::sleep(LOOK).await;
        }
        let _ = self.queue.close(&run).await; // what is left there would find the ledger full
        Ok(())
    }

    /// Brings home what is done and puts in what is missing; true when nothing is.
    async fn round(&self, run: &str, round: &mut Round, news: &News<'_>) -> Result<bool, Error> {
        if !round.announced {
            self.announce(run).await?;
            round.announced = true;
        }
        let missing = self.bring_home(run, &mut round.standing, news).await?;
        if missing.is_empty() {
            return Ok(true);
        }
        let aside = self.aside(run).await?;
        let open: Vec<u64> = missing.into_iter().filter(|b| !aside.iter().any(|p| p.block == *b)).collect();
        if open.is_empty() {
            round.aside = aside;
            return self.give_up(run, &round.aside).await.map(|()| false);
        }
        let now = self.queue.queued(run).await?;
        (round.standing.waiting, round.standing.in_hand) = (now.waiting, now.in_hand);
        // the queue has nothing for anybody, and the ledger lacks what was in it: it was lost
        let stalls = now.waiting + now.in_hand == 0 && open.iter().all(|b| round.queued.contains(b));
        round.idle = if stalls { round.idle + 1 } else { 0 };
        if round.idle >= PATIENCE {
            (round.pass, round.idle) = (round.pass + 1, 0);
            round.standing.again += open.len() as u64;
            round.queued.clear();
        }
        let room = MOST_QUEUED.saturating_sub(now.waiting) as usize;
        let next: Vec<u64> = open.into_iter().filter(|b| !round.queued.contains(b)).take(room).collect();
        for block in next {
            self.queue.put(&Ticket { run: run.to_owned(), block }, round.pass).await?;
            round.queued.insert(block);
        }
        news(None, &round.standing)?;
        Ok(false)
    }

    /// Lays spec and snapshot into the store, and opens a place in the queue.
    async fn announce(&self, run: &str) -> Result<(), Error> {
        let snapshot = &self.part.snapshot;
        self.objects.put_new(&places::snapshot(&snapshot.file_name()), snapshot.to_bytes()).await?;
        self.objects.put_new(&places::spec(run), self.part.spec_text.clone().into_bytes()).await?;
        let about = Run {
            snapshot: snapshot.file_name(),
            tasks_per_block: self.part.tasks_per_block(),
            priority: self.priority,
        };
        let text = serde_json::to_vec(&about).expect("it has string keys only");
        self.objects.put_new(&places::about(run), text).await?;
        self.queue.open(run).await.map(|_| ())
    }

    /// Brings the results of the ledger into the part; returns the blocks that the ledger lacks.
    async fn bring_home(&self, run: &str, standing: &mut Standing, news: &News<'_>) -> Result<BTreeSet<u64>, Error> {
        let lines = self.objects.list(&places::ledger(run)).await?;
        standing.done = lines.len() as u64;
        let in_ledger: BTreeSet<u64> = lines.iter().filter_map(|l| places::block_of(l)).collect();
        let missing: BTreeSet<u64> = self.part.missing().into_iter().collect();
        for block in missing.intersection(&in_ledger) {
            let line = places::line(run, *block);
            let text = self.objects.get(&line).await?.unwrap_or_default();
            let done: Done =
                serde_json::from_slice(&text).map_err(|e| Error::Cluster(format!("{line} cannot be read: {e}")))?;
            let blob = places::blob(&done.sha256);
            let bytes = self.objects.get(&blob).await?;
            let bytes =
                bytes.ok_or_else(|| Error::Cluster(format!("{line} names {blob}, which the store does not have")))?;
            if sha256(&bytes) != done.sha256 {
                return Err(Error::Cluster(format!("{blob} is not what its name says: the store has damaged it")));
            }
            let kept = self.part.keep(*block, &bytes, done.worlds)?;
            news(Some(&kept), standing)?;
        }
        Ok(missing.difference(&in_ledger).copied().collect())
    }

    async fn aside(&self, run: &str) -> Result<Vec<Poison>, Error> {
        let mut found = Vec::new();
        for place in self.objects.list(&places::poison(run)).await? {
            let text = self.objects.get(&place).await?.unwrap_or_default();
            found.extend(serde_json::from_slice::<Poison>(&text).ok());
        }
        Ok(found)
    }

    async fn give_up(&self, run: &str, aside: &[Poison]) -> Result<(), Error> {
        for poison in aside {
            self.objects.remove(&places::poisoned(run, poison.block)).await?; // the next leader tries again
        }
        let first = &aside[0];
        let tasks = self.part.tasks_of(first.block);
        Err(Error::Cluster(format!(
            "{} block(s) were set aside, the first is {} (tasks {} to {}): {}; all others are done: run the same command to try these again, or make them here without --nats to see where they end",
            aside.len(),
            first.block,
            tasks.start,
            tasks.end.saturating_sub(1),
            first.reason
        )))
    }
}
