//! The process that reads models for another one: it limits itself, and answers one file after the other.
//!
//! What it is not for: being called in the process of the program: it takes away memory and files from whoever calls it.

use std::io::{Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::facts::{ReadModel, Refusal};
use super::wire::{Request, receive, send};

/// The stack for files whose parts are nested deep.
const STACK_BYTES: usize = 64 << 20;
/// The longest request: two paths.
const MAX_REQUEST_BYTES: u64 = 1 << 20;

/// Reads the names of files from `input` and writes what they hold to `output`, in the form that a [`super::Pool`]
/// expects, until the input ends. This is all that the process started by a `Program` has to do. `memory_bytes` bounds
/// the process from here on; 0 sets no bound.
///
/// # Errors
///
/// When the input cannot be read or the output not be written; a file that cannot be read is no error but an answer.
pub fn run_child(
    mut input: impl Read + Send + 'static,
    mut output: impl Write + Send + 'static,
    memory_bytes: u64,
) -> std::io::Result<()> {
    limit(memory_bytes);
    // The message of a panic goes into the answer.
    std::panic::set_hook(Box::new(|_| {}));
    let work = move || -> std::io::Result<()> {
        while let Some(request) = receive::<Request>(&mut input, MAX_REQUEST_BYTES)? {
            send(&mut output, &answer(&request))?;
        }
        Ok(())
    };
    let worker = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(work)?;
    worker.join().unwrap_or_else(|_| Err(std::io::Error::other("the reader stopped")))
}

fn answer(request: &Request) -> Result<ReadModel, Refusal> {
    let root = request.root.as_ref().map(|r| r.path());
    let read = || super::read(&request.path.path(), root.as_deref());
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
        let text = text.unwrap_or("without a message").lines().next().unwrap_or_default();
        let text = super::folder::shortened(text);
        Err(format!("is damaged or made in a way that is not understood ({text})").into())
    })
}

/// Bounds this process: memory, and no file may be written.
#[cfg(unix)]
fn limit(memory_bytes: u64) {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let set = |resource, most: u64| {
        let limit = Rlimit { current: Some(most), maximum: Some(most) };
        // A stricter limit may be in force already, which is as good.
        let _ = setrlimit(resource, limit);
    };
    set(Resource::Core, 0);
    set(Resource::Fsize, 0);
    if memory_bytes > 0 {
        set(Resource::Data, memory_bytes);
        // Address space is also taken by what is only reserved, such as stacks.
        set(Resource::As, memory_bytes.saturating_mul(4));
    }
    #[cfg(target_os = "linux")]
    let _ = rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL));
}

#[cfg(not(unix))]
fn limit(_: u64) {}
