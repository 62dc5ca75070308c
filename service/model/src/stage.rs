//! What every stage has in common: how it fails, and how a caller ends it early.

use std::sync::atomic::{AtomicBool, Ordering};

/// Why a stage could not produce its artifact.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The request cannot be honored in any form; the message says what and what to ask instead.
    #[error("{stage}: {message}")]
    Refused {
        /// Stage that refused.
        stage: &'static str,
        /// What is wrong and what would work: lower case, no full stop.
        message: String,
    },
    /// No artifact satisfies all hard rules within the search budget.
    #[error("{stage}: no solution found: {message}")]
    Infeasible {
        /// Stage that gave up.
        stage: &'static str,
        /// Which rules clash, and the least change that would help.
        message: String,
    },
    /// A change of a finished world leaves a hard rule broken, however what is around it is repaired.
    #[error("{stage}: no solution found: {message}")]
    Breaks {
        /// Stage that gave up.
        stage: &'static str,
        /// Id of the first rule that would be broken.
        rule: String,
        /// Id of what would break it.
        subject: String,
        /// Rule and reason in words.
        message: String,
    },
    /// The request names a kind of building that no domain knows, and nothing else to plan.
    #[error(
        "scene_graph: no domain knows a kind of building called `{name}`; the nearest are {}; there are kinds of the domains {}; \
         name one, list the rooms that it has, or plan them with `--domain {fallback}`",
        nearest.join(", "), domains.join(", ")
    )]
    UnknownBuilding {
        /// What the request calls it.
        name: String,
        /// Kinds of building that are called most alike, best first.
        nearest: Vec<String>,
        /// Ids of the domains that there are.
        domains: Vec<String>,
        /// Id of the domain whose rooms suit most buildings.
        fallback: String,
    },
    /// A document handed in does not fit the others (a floorplan of another graph).
    #[error("{stage}: {message}")]
    Mismatch {
        /// Stage that found it.
        stage: &'static str,
        /// What does not fit, with ids.
        message: String,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}

/// The wish to stop, of whoever waits for an answer: a flag that the solvers look at every few steps. It changes when work
/// ends, never what it makes.
#[derive(Debug, Clone, Copy)]
pub struct Stop<'a>(Option<&'a AtomicBool>);

impl<'a> Stop<'a> {
    /// Returns the wish of somebody who waits for as long as it takes.
    pub const fn never() -> Self {
        Self(None)
    }

    /// Returns true once the flag is set.
    pub fn is_set(self) -> bool {
        self.0.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Goes on unless the flag is set.
    ///
    /// # Errors
    /// `Cancelled`.
    pub fn check(self) -> Result<(), Error> {
        if self.is_set() { Err(Error::Cancelled) } else { Ok(()) }
    }
}

impl<'a> From<&'a AtomicBool> for Stop<'a> {
    fn from(flag: &'a AtomicBool) -> Self {
        Self(Some(flag))
    }
}
