//! The side that starts the process which reads a PDF file, feeds it, waits for it within limits, and ends it.
//!
//! What it is not for: choosing the program; the command passes itself with a hidden subcommand.

use std::io::{Read, Write};
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc;
use std::time::Duration;

use super::wire::{Answer, File, MARK};

/// What the reading of one PDF file may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// The most memory of the process, in bytes.
    pub memory_bytes: u64,
    /// The longest it may run.
    pub time: Duration,
    /// The most it may print, in bytes.
    pub output_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { memory_bytes: 1 << 30, time: Duration::from_secs(60), output_bytes: 64 << 20 }
    }
}

/// The program that is started for each PDF file. It must call `read::pdf::run_child` with its input and output, the
/// memory in bytes and the time in seconds, which are appended to its arguments in this order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    /// The file of the program.
    pub path: PathBuf,
    /// Its arguments, before the two that are appended.
    pub arguments: Vec<String>,
    /// What the process may take.
    pub limits: Limits,
}

/// Why a PDF file cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// The program cannot be started or spoken to.
    #[error("the program that reads PDF files cannot be run: {0}")]
    Start(String),
    /// It ran too long and was ended.
    #[error("took more than {} s to read and was given up", .0.as_secs_f32())]
    Timeout(Duration),
    /// It printed more than allowed.
    #[error("says more than {0} bytes and was given up")]
    TooMuch(u64),
    /// It ended without an answer: out of memory, or a crash of the library.
    #[error("needs more memory than {memory_bytes} bytes, or crashes the library that reads it ({status})")]
    Crashed {
        /// The memory it had.
        memory_bytes: u64,
        /// How it ended.
        status: String,
    },
    /// The file is damaged, protected, or of a form that is not understood.
    #[error("{0}")]
    File(String),
}

impl Fault {
    /// Returns the code of `Error::Read`.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Start(_) => "pdf_unavailable",
            Self::Timeout(_) => "pdf_timeout",
            Self::TooMuch(_) => "pdf_too_much",
            Self::Crashed { .. } => "pdf_crashed",
            Self::File(_) => "pdf_unreadable",
        }
    }
}

/// Ends and reaps the process when it goes out of scope, whatever happened before.
struct Owned(Child);

impl Drop for Owned {
    fn drop(&mut self) {
        // Fails when it has ended, which is what is wanted.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Returns what a PDF file says, as told by the program.
pub fn ask(bytes: &[u8], program: &Program) -> Result<File, Fault> {
    let limits = program.limits;
    let start = |e: std::io::Error| Fault::Start(format!("{}: {e}", program.path.display()));
    let mut command = Command::new(&program.path);
    command.args(&program.arguments);
    command.args([limits.memory_bytes.to_string(), limits.time.as_secs().max(1).to_string()]);
    // A file must not find the keys of providers in the memory of the process that it may take over.
    command.env_clear().stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut process = Owned(command.spawn().map_err(start)?);
    let missing = || Fault::Start("no pipe to it".into());
    let mut input = process.0.stdin.take().ok_or_else(missing)?;
    let output = process.0.stdout.take().ok_or_else(missing)?;
    let bytes = bytes.to_vec();
    // Both threads end with the process: their pipes close when it is killed.
    std::thread::spawn(move || drop(input.write_all(&bytes)));
    let (send, receive) = mpsc::channel();
    std::thread::spawn(move || {
        let mut text = Vec::new();
        let result = output.take(limits.output_bytes + 1).read_to_end(&mut text).map(|_| text);
        drop(send.send(result));
    });
    let text = match receive.recv_timeout(limits.time) {
        Ok(result) => result.map_err(start)?,
        Err(_) => return Err(Fault::Timeout(limits.time)),
    };
    if text.len() as u64 > limits.output_bytes {
        return Err(Fault::TooMuch(limits.output_bytes));
    }
    match answer(&text) {
        Some(Answer::File(file)) => Ok(file),
        Some(Answer::Failed(reason)) => Err(Fault::File(reason)),
        None => {
            let status = process.0.wait().map_err(start)?;
            Err(ended(status, limits))
        }
    }
}

/// Finds the answer behind whatever the library printed.
fn answer(output: &[u8]) -> Option<Answer> {
    let mark = MARK.as_bytes();
    let at = output.windows(mark.len()).rposition(|w| w == mark)?;
    let rest = output.get(at + mark.len()..)?;
    let end = rest.iter().position(|b| *b == b'\n')?;
    let length: usize = std::str::from_utf8(rest.get(..end)?).ok()?.parse().ok()?;
    serde_json::from_slice(rest.get(end + 1..)?.get(..length)?).ok()
}

fn ended(status: ExitStatus, limits: Limits) -> Fault {
    #[cfg(unix)]
    {
        use std::os::unix::process::ExitStatusExt;
        const SIGXCPU: i32 = 24;
        const SIGKILL: i32 = 9;
        // The kernel ends a process over its CPU time with either.
        if matches!(status.signal(), Some(SIGXCPU | SIGKILL)) {
            return Fault::Timeout(limits.time);
        }
    }
    Fault::Crashed { memory_bytes: limits.memory_bytes, status: status.to_string() }
}
