//! One world of many: that of a request and its seed, whatever comes of it. Data sets, their workers and the batches of a server
//! make all their worlds here, so that a task is one thing wherever it is run.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicBool;

use d3dgen_plugins::Registry;

use crate::generate::{Generated, Settings, contradictions, furnish_and_check};
use crate::scene_graph::Request;
use crate::{Error, brief};

/// Why a task has no world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Why {
    /// The request cannot be honored in any form, or contradicts itself.
    Refused,
    /// No plan, or no furniture, was found.
    Infeasible,
    /// The program has a fault here.
    Crashed,
}

/// A task that came to no world.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct Failure {
    /// Why.
    pub why: Why,
    /// One sentence for people.
    pub reason: String,
}

/// How the worlds of a run are made.
#[derive(Debug, Clone, Copy, Default)]
pub struct Terms<'a> {
    /// Name of each world; of its kind and seed when absent.
    pub name: Option<&'a str>,
    /// Build requests that contradict themselves.
    pub allow_conflicts: bool,
}

/// Makes the world of a request; the report tells whether it is sound.
///
/// # Errors
/// `Cancelled` alone: what a request does not come to is an outcome of its own, and other tasks go on.
///
/// ```
/// use d3dgen_pipeline::scene_graph::Request;
/// use d3dgen_pipeline::task::{self, Terms, Why};
/// use d3dgen_plugins::Registry;
/// use std::sync::atomic::AtomicBool;
///
/// let (registry, running) = (Registry::builtin(), AtomicBool::new(false));
/// let request = |prompt: &str| Request { prompt: prompt.into(), seed: 3, ..Request::default() };
/// let world = task::make(&request("flat with one bedroom"), &registry, Terms::default(), &running)?;
/// assert!(world.expect("there is one").report.sound);
/// let none = task::make(&request("office with 3000 rooms"), &registry, Terms::default(), &running)?;
/// assert_eq!(none.unwrap_err().why, Why::Refused);
/// # Ok::<(), d3dgen_pipeline::Error>(())
/// ```
pub fn make(
    request: &Request,
    registry: &Registry,
    terms: Terms<'_>,
    cancelled: &AtomicBool,
) -> Result<Result<Generated, Failure>, Error> {
    match caught(|| attempt(request, registry, terms, cancelled)) {
        Ok(Ok(made)) => Ok(Ok(made)),
        Ok(Err(Error::Cancelled)) => Err(Error::Cancelled),
        Ok(Err(error)) => Ok(Err(Failure::of(&error))),
        Err(failure) => Ok(Err(failure)),
    }
}

/// Runs a part of a task; a fault of the program in it is a failure of the task, not the end of the run.
///
/// # Errors
/// [`Why::Crashed`] with what the fault said.
pub fn caught<T>(work: impl FnOnce() -> T) -> Result<T, Failure> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let said = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
        Failure { why: Why::Crashed, reason: said.unwrap_or("panicked").trim().to_owned() }
    })
}

impl Failure {
    /// Returns that a stage came to nothing.
    pub fn of(error: &Error) -> Self {
        let why = if matches!(error, Error::Infeasible { .. }) { Why::Infeasible } else { Why::Refused };
        Self { why, reason: error.to_string() }
    }
}

fn attempt(
    request: &Request,
    registry: &Registry,
    terms: Terms<'_>,
    cancelled: &AtomicBool,
) -> Result<Generated, Error> {
    let (graph, brief) = brief::rooms(request, registry)?;
    let messages = contradictions(&graph);
    if !terms.allow_conflicts && !messages.is_empty() {
        let message = format!("the prompt contradicts itself: {}", messages.join("; "));
        return Err(Error::Refused { stage: "scene_graph", message });
    }
    let settings = Settings { name: terms.name.map(str::to_owned), brief, ..Settings::default() };
    furnish_and_check(&graph, registry, &settings, &mut |_| (), cancelled)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_of_the_program_is_the_failure_of_one_task() {
        let failure = caught(|| panic!("no floor at {}", 3)).unwrap_err();
        assert_eq!(failure, Failure { why: Why::Crashed, reason: "no floor at 3".into() });
        assert_eq!(caught(|| 7), Ok(7));
    }
}
