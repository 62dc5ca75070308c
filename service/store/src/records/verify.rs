//! Walks all records and says everything that is wrong. It changes nothing.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use super::envelope;
use super::state::{self, State, Tally};
use super::view::{OUT_OF_ORDER, View};
use crate::error::{Error, Result};
use crate::kv::KeyRange;

/// How many records are looked at between two reports.
const STEP: u64 = 256;

/// How far a long task is, in records.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Records done.
    pub done: u64,
    /// Records in all, as far as known.
    pub total: u64,
}

/// One thing that is wrong with what is stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The table.
    pub table: String,
    /// The record; none when the table as a whole is meant.
    pub key: Option<String>,
    /// What is wrong.
    pub reason: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.key {
            Some(key) => write!(f, "record {key} of table {}: {}", self.table, self.reason),
            None => write!(f, "table {}: {}", self.table, self.reason),
        }
    }
}

/// Reports to the caller and asks whether to go on.
pub(crate) struct Steps<'a> {
    now: Progress,
    observe: &'a mut dyn FnMut(Progress),
    cancelled: &'a AtomicBool,
}

impl<'a> Steps<'a> {
    pub(crate) fn new(total: u64, observe: &'a mut dyn FnMut(Progress), cancelled: &'a AtomicBool) -> Self {
        Self { now: Progress { done: 0, total }, observe, cancelled }
    }

    /// One more record is done.
    pub(crate) fn step(&mut self) -> Result<()> {
        self.now.done += 1;
        if self.now.done.is_multiple_of(STEP) { self.report() } else { Ok(()) }
    }

    /// Tells the caller where we are.
    pub(crate) fn report(&mut self) -> Result<()> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(Error::Cancelled);
        }
        (self.observe)(self.now);
        Ok(())
    }
}

/// Does what [`super::Store::verify`] promises.
pub(super) fn verify(
    view: &View<'_>,
    observe: &mut dyn FnMut(Progress),
    cancelled: &AtomicBool,
) -> Result<Vec<Problem>> {
    let mut problems = Vec::new();
    let state = match State::read(view.raw()) {
        Ok(state) => Some(state),
        Err(Error::Damaged { table, key, reason }) => {
            problems.push(Problem { table, key: Some(key), reason });
            None
        }
        Err(other) => return Err(other),
    };
    let expected = state.as_ref().map(|s| &s.tallies);
    let total = expected.map_or(0, |tallies| tallies.values().map(|t| t.count).sum());
    let mut steps = Steps::new(total, observe, cancelled);
    steps.report()?;

    let mut tables: BTreeSet<String> = view.raw().tables()?.into_iter().filter(|t| t != state::TABLE).collect();
    tables.extend(expected.into_iter().flat_map(BTreeMap::keys).cloned());
    for table in tables {
        let found = match walk(view, &table, &mut steps, &mut problems) {
            Ok(found) => found,
            Err(Error::Corrupt { reason, .. }) => {
                problems.push(Problem { table, key: None, reason: format!("cannot be read to its end ({reason})") });
                continue;
            }
            Err(other) => return Err(other),
        };
        let Some(expected) = expected else { continue };
        let expected = expected.get(&table).copied().unwrap_or_default();
        if found.count != expected.count {
            let reason = format!("has {} records, {} were stored", found.count, expected.count);
            problems.push(Problem { table, key: None, reason });
        } else if found.keys != expected.keys {
            let reason = "has other keys than were stored".to_owned();
            problems.push(Problem { table, key: None, reason });
        }
    }
    steps.report()?;
    Ok(problems)
}

/// Looks at each record of a table, both in order and by its key.
fn walk(view: &View<'_>, table: &str, steps: &mut Steps<'_>, problems: &mut Vec<Problem>) -> Result<Tally> {
    let mut found = Tally::default();
    let mut last: Option<Vec<u8>> = None;
    view.raw().scan(table, &KeyRange::all(), &mut |key, bytes| {
        found.add(table, key);
        let mut wrong = envelope::unwrap(table, key, bytes).err();
        if wrong.is_none() && std::str::from_utf8(key).is_err() {
            wrong = Some("its key is no UTF-8 text".to_owned());
        }
        if wrong.is_none() && !view.raw().contains(table, key)? {
            wrong = Some("it is not found by its key".to_owned());
        }
        // A damaged file may lead in circles.
        let circles = last.as_ref().is_some_and(|last| last.as_slice() >= key);
        if circles {
            wrong = Some(OUT_OF_ORDER.to_owned());
        }
        if let Some(reason) = wrong {
            let key = Some(String::from_utf8_lossy(key).into_owned());
            problems.push(Problem { table: table.to_owned(), key, reason });
        }
        steps.step()?;
        last = Some(key.to_vec());
        Ok(if circles { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    Ok(found)
}
