//! The processes that read models: this very program with a hidden command, for every command that reads files of others.

use d3dgen_assets::readers::{Limits, Pool, Program, run_child};

use crate::error::Error;

/// Name of the hidden command that reads models.
pub const READ_MODELS: &str = "read-models";

/// Returns a pool with a worker for each processor.
///
/// # Errors
///
/// When this program does not know its own file.
pub fn pool() -> Result<Pool, Error> {
    let path = std::env::current_exe().map_err(|source| Error::Read { path: "d3dgen".into(), source })?;
    let arguments = vec!["assets".to_owned(), READ_MODELS.to_owned()];
    let workers = std::thread::available_parallelism().map_or(1, |n| n.get()).min(8);
    Ok(Pool::new(Program { path, arguments, limits: Limits::default() }, workers))
}

/// Reads models for the program that started this one.
pub fn serve(memory_bytes: u64) -> Result<(), Error> {
    run_child(std::io::stdin(), std::io::stdout(), memory_bytes)
        .map_err(|source| Error::Read { path: "standard input".into(), source })
}
