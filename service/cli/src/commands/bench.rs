//! `d3dgen bench`: the worlds of a published benchmark, made and measured.

mod paper;

use clap::Subcommand;

use crate::error::Error;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// The paper's 450 worlds: 150 of each domain, 50 each with 5, 8 and 10 rooms, beside the paper's own figures
    Paper(paper::Args),
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        match self.command {
            Command::Paper(args) => args.run(),
        }
    }
}
