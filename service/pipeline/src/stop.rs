//! How a caller ends a search early: a flag that the solvers look at every few steps.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::Error;

/// The wish to stop, of whoever waits for an answer. It changes when work ends, never what it makes.
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
