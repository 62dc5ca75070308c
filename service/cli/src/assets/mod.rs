//! `d3dgen assets`: the database of 3D models, and what is known about single files.

mod inspect;
pub mod reader;

use clap::Subcommand;

use crate::error::Error;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    /// Print what files of models hold, without storing them
    Inspect(inspect::Args),
    /// Read the models named on standard input; the process that other commands start, with limits
    #[command(hide = true, name = reader::READ_MODELS)]
    ReadModels {
        /// Most memory of the process
        memory_bytes: u64,
    },
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        match self.action {
            Action::Inspect(args) => args.run(),
            Action::ReadModels { memory_bytes } => reader::serve(memory_bytes),
        }
    }
}
