//! `d3dgen completions`: a completion script for a shell.

use clap::CommandFactory;
use clap_complete::Shell;

use crate::cli::Cli;
use crate::error::Error;
use crate::input::write_text;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Shell the script is for
    shell: Shell,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "d3dgen", &mut script);
        write_text(None, &String::from_utf8_lossy(&script))
    }
}
