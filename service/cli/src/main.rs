//! The `d3dgen` command. Data goes to standard output, talk to standard error.
//!
//! What it is not for: deciding anything about buildings. Commands read documents, call a stage, write what comes back.

mod bundle;
mod cli;
mod code;
mod commands;
mod database;
mod error;
mod input;
mod interrupt;
mod output;
mod parallel;
mod progress;
mod registry;
mod remote;
mod request;
mod shelf;
mod stage_clock;
mod summary;
mod table;

use std::process::ExitCode;

use clap::Parser;
use mimalloc::MiMalloc;

#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    match cli.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}\ncode: {}", error.code());
            ExitCode::from(error.exit_code())
        }
    }
}
