//! Ctrl-C and termination: a flag that long work looks at, so that temporary folders are removed on the way out.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::Error;

static STOP: AtomicBool = AtomicBool::new(false);

/// Starts listening, once there is something to clean up; a second signal ends the process at once.
pub fn listen() {
    static LISTENING: Once = Once::new();
    LISTENING.call_once(install);
}

fn install() {
    let listening = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    });
    if let Err(e) = listening {
        eprintln!("warning: cannot listen for Ctrl-C ({e}); an interrupted run may leave a .tmp folder behind");
    }
}

/// Returns the flag, for work that takes one.
pub fn flag() -> &'static AtomicBool {
    &STOP
}

/// Returns an error once the user has asked to stop.
///
/// # Errors
/// `Interrupted`.
pub fn check() -> Result<(), Error> {
    if STOP.load(Ordering::SeqCst) { Err(Error::Interrupted) } else { Ok(()) }
}
