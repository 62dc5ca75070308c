//! Many read or one writes, for a backend without read transactions.
//!
//! Not `std::sync::RwLock`: that may let a thread wait for ever that reads twice while somebody waits to write, and so
//! may a thread that waits for another one which wants to read.

use std::collections::HashMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::ThreadId;
use std::time::Duration;

/// How long a new reader lets a waiting writer go first. Then it reads, so that nobody waits in a circle.
const COURTESY: Duration = Duration::from_millis(10);

/// Lets readers and writers in.
#[derive(Default)]
pub(super) struct Gate {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    /// How often each thread is in.
    readers: HashMap<ThreadId, usize>,
    writing: bool,
    /// How many wait to write.
    waiting: usize,
}

impl Gate {
    /// Waits for whoever writes.
    pub(super) fn read(&self) -> Reading<'_> {
        let thread = std::thread::current().id();
        let mut state = self.lock();
        if !state.readers.contains_key(&thread) {
            let polite = self.changed.wait_timeout_while(state, COURTESY, |s| s.waiting > 0);
            state = polite.unwrap_or_else(PoisonError::into_inner).0;
        }
        state = self.changed.wait_while(state, |s| s.writing).unwrap_or_else(PoisonError::into_inner);
        *state.readers.entry(thread).or_default() += 1;
        Reading { gate: self, thread }
    }

    /// Waits until nobody is in.
    pub(super) fn write(&self) -> Writing<'_> {
        let mut state = self.lock();
        state.waiting += 1;
        let busy = |s: &mut State| s.writing || !s.readers.is_empty();
        state = self.changed.wait_while(state, busy).unwrap_or_else(PoisonError::into_inner);
        state.waiting -= 1;
        state.writing = true;
        Writing { gate: self }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing below can panic halfway through a change.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A reader that is in.
pub(super) struct Reading<'a> {
    gate: &'a Gate,
    thread: ThreadId,
}

impl Drop for Reading<'_> {
    fn drop(&mut self) {
        let mut state = self.gate.lock();
        if let Some(times) = state.readers.get_mut(&self.thread) {
            *times -= 1;
            if *times == 0 {
                state.readers.remove(&self.thread);
            }
        }
        self.gate.changed.notify_all();
    }
}

/// The writer that is in.
pub(super) struct Writing<'a> {
    gate: &'a Gate,
}

impl Drop for Writing<'_> {
    fn drop(&mut self) {
        self.gate.lock().writing = false;
        self.gate.changed.notify_all();
    }
}
