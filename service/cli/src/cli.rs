//! The command line as a whole.

use clap::Parser;

use crate::commands::Command;

const AFTER_HELP: &str = "\
Exit codes:
  0    done
  1    a world breaks a hard rule: its report is written, the world is not
  2    the request, a file or the output folder cannot be used: nothing is written
  130  interrupted: nothing half-written is left behind

An error ends with its code; `d3dgen explain CODE` says what it means and what to do.

Data goes to standard output, everything else to standard error. FILE may be `-` for standard input, or the output
folder of a world.";

/// Makes simulator-ready, robot-ready indoor worlds from a sentence.
#[derive(Parser)]
#[command(name = "d3dgen", version, after_help = AFTER_HELP, arg_required_else_help = true, disable_help_subcommand = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_consistent_and_every_flag_is_explained() {
        fn explained(command: &clap::Command) {
            for arg in command.get_arguments() {
                assert!(arg.get_help().is_some(), "{} of {} has no help", arg.get_id(), command.get_name());
            }
            for sub in command.get_subcommands() {
                assert!(sub.get_about().is_some(), "{} has no help", sub.get_name());
                explained(sub);
            }
        }
        let mut command = Cli::command();
        command.build();
        command.clone().debug_assert();
        explained(&command);
    }
}
