//! The side that starts processes which read models, hands them files, and ends those that take too long.
//!
//! What it is not for: choosing the program; the command passes itself with a hidden subcommand.

use std::collections::BTreeMap;
use std::io::BufReader;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

use super::facts::{ReadModel, Refusal};
use super::wire::{Name, Request, receive, send};
use crate::Error;

/// What the reading of files may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// The most memory of a process, in bytes.
    pub memory_bytes: u64,
    /// The longest that one file may take.
    pub time: Duration,
    /// The longest answer, in bytes.
    pub answer_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { memory_bytes: 448 << 20, time: Duration::from_secs(8), answer_bytes: 160 << 20 }
    }
}

/// The program that reads models. It must call [`super::run_child`] with its input and output and the memory in bytes,
/// which is appended to its arguments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    /// The file of the program.
    pub path: PathBuf,
    /// Its arguments, before the one that is appended.
    pub arguments: Vec<String>,
    /// What the process may take.
    pub limits: Limits,
}

/// Reads models in a process of its own, which is started at the first file and again after a file broke it.
#[derive(Debug)]
pub struct Worker {
    program: Program,
    running: Option<Running>,
}

#[derive(Debug)]
struct Running {
    process: Child,
    input: ChildStdin,
    answers: Receiver<std::io::Result<Option<Result<ReadModel, Refusal>>>>,
    /// Whether it has read a file already.
    used: bool,
}

impl Drop for Running {
    fn drop(&mut self) {
        // Fails when it has ended, which is what is wanted.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Worker {
    /// Returns a worker; its process starts at the first file.
    pub fn new(program: Program) -> Self {
        Self { program, running: None }
    }

    /// Reads a file, as [`super::read`] does.
    ///
    /// # Errors
    ///
    /// [`Error::Start`] when the process cannot be started. What is wrong with the file is the inner result.
    pub fn read(&mut self, path: &Path, root: Option<&Path>) -> Result<Result<ReadModel, Refusal>, Error> {
        loop {
            let limits = self.program.limits;
            let running = match self.running.take() {
                Some(running) => running,
                None => start(&self.program)?,
            };
            let running = self.running.insert(running);
            let fresh = !std::mem::replace(&mut running.used, true);
            let request = Request { path: Name::of(path), root: root.map(Name::of) };
            // A process that has ended is noticed by its missing answer.
            let _ = send(&mut running.input, &request);
            let reason = match running.answers.recv_timeout(limits.time) {
                Ok(Ok(Some(answer))) => return Ok(answer),
                Err(RecvTimeoutError::Timeout) => {
                    format!("takes more than {} s to read and was given up", limits.time.as_secs_f32())
                }
                Ok(_) | Err(RecvTimeoutError::Disconnected) => {
                    let used = limits.memory_bytes >> 20;
                    format!("needs more memory than {used} MiB to read, or is damaged so that its reader breaks")
                }
            };
            let timeout = reason.starts_with("takes");
            self.running = None;
            // Files before it may have left the process short of memory: it gets one of its own.
            if fresh || timeout {
                return Ok(Err(reason.into()));
            }
        }
    }
}

fn start(program: &Program) -> Result<Running, Error> {
    let failed = |source| Error::Start { program: program.path.clone(), source };
    let mut command = Command::new(&program.path);
    command.args(&program.arguments).arg(program.limits.memory_bytes.to_string());
    // A file must not find the keys of providers in the memory of the process that it may take over.
    command.env_clear().stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
    // The command's allocator takes memory ahead, which would count against the limit of the process.
    command.env("MIMALLOC_ARENA_EAGER_COMMIT", "0");
    let mut process = command.spawn().map_err(failed)?;
    let pipes = process.stdin.take().zip(process.stdout.take());
    let (input, output) = pipes.ok_or_else(|| failed(std::io::Error::other("no pipe to it")))?;
    let (send, answers) = channel();
    let most = program.limits.answer_bytes;
    // Ends with the process: its pipe closes when it is killed.
    std::thread::spawn(move || {
        let mut output = BufReader::with_capacity(1 << 16, output);
        loop {
            let message = receive(&mut output, most);
            let more = matches!(message, Ok(Some(_)));
            if send.send(message).is_err() || !more {
                break;
            }
        }
    });
    Ok(Running { process, input, answers, used: false })
}

/// Reads many files with several workers at once.
#[derive(Debug, Clone)]
pub struct Pool {
    program: Program,
    workers: usize,
}

struct Shared {
    /// The next file to read.
    next: usize,
    /// How many results were handed over.
    delivered: usize,
    done: BTreeMap<usize, Result<Result<ReadModel, Refusal>, Error>>,
    stopped: bool,
}

impl Pool {
    /// Returns a pool of so many workers, at least one.
    pub fn new(program: Program, workers: usize) -> Self {
        Self { program, workers: workers.max(1) }
    }

    /// Reads files, and hands each result to `each` in the order of the files, in the thread of the caller, until `each`
    /// breaks. Few more files than there are workers are in memory at a time.
    ///
    /// # Errors
    ///
    /// [`Error::Start`] when a process cannot be started.
    pub fn read(
        &self,
        files: &[PathBuf],
        root: Option<&Path>,
        mut each: impl FnMut(usize, Result<ReadModel, Refusal>) -> ControlFlow<()>,
    ) -> Result<(), Error> {
        let shared = Mutex::new(Shared { next: 0, delivered: 0, done: BTreeMap::new(), stopped: false });
        let changed = Condvar::new();
        let lock = || shared.lock().unwrap_or_else(PoisonError::into_inner);
        let workers = self.workers.min(files.len());
        let work = || {
            let mut worker = Worker::new(self.program.clone());
            loop {
                let mut state = lock();
                while state.next >= state.delivered + 2 * workers && !state.stopped {
                    state = changed.wait(state).unwrap_or_else(PoisonError::into_inner);
                }
                let index = state.next;
                let Some(file) = files.get(index).filter(|_| !state.stopped) else { return };
                state.next += 1;
                drop(state);
                let result = worker.read(file, root);
                lock().done.insert(index, result);
                changed.notify_all();
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..workers {
                scope.spawn(work);
            }
            let mut outcome = Ok(());
            for index in 0..files.len() {
                let mut state = lock();
                let result = loop {
                    if let Some(result) = state.done.remove(&index) {
                        break result;
                    }
                    state = changed.wait(state).unwrap_or_else(PoisonError::into_inner);
                };
                state.delivered = index + 1;
                drop(state);
                changed.notify_all();
                let flow = match result {
                    Ok(result) => each(index, result),
                    Err(error) => {
                        outcome = Err(error);
                        ControlFlow::Break(())
                    }
                };
                if flow.is_break() {
                    break;
                }
            }
            lock().stopped = true;
            changed.notify_all();
            outcome
        })
    }
}
