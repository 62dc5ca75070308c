//! `d3dgen man`: the manual pages, made of the same text as `--help`.

use std::io;
use std::path::PathBuf;

use clap::CommandFactory;
use clap_mangen::Man;

use crate::cli::Cli;
use crate::error::Error;
use crate::input::write_text;
use crate::output::Output;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Command whose page is printed, as `generate` or `knowledge search`
    #[arg(value_name = "COMMAND", conflicts_with = "out")]
    words: Vec<String>,
    /// Write the pages of all commands into this folder, as `d3dgen.1`, `d3dgen-generate.1`
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let mut command = Cli::command();
        command.build();
        let Some(out) = self.out else {
            let wanted = self.words.iter().try_fold(&command, |at, word| at.find_subcommand(word).ok_or(word));
            let wanted =
                wanted.map_err(|word| Error::Input(format!("there is no command `{word}`; see d3dgen --help")))?;
            return write_text(None, &page(wanted)?);
        };
        let folder = Output::among(&out)?;
        write_all(&command, &folder)?;
        folder.commit().map(|_| ())
    }
}

/// Writes the page of a command, and those of the commands below it.
fn write_all(command: &clap::Command, folder: &Output) -> Result<(), Error> {
    folder.write(&Man::new(command.clone()).get_filename(), page(command)?.as_bytes())?;
    command.get_subcommands().filter(|sub| !sub.is_hide_set()).try_for_each(|sub| write_all(sub, folder))
}

fn page(command: &clap::Command) -> Result<String, Error> {
    let mut text = Vec::new();
    let refused = |source: io::Error| Error::Write { path: "manual page".into(), source };
    Man::new(command.clone()).render(&mut text).map_err(refused)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page_with_its_flags() {
        fn checked(command: &clap::Command) {
            let page = page(command).unwrap().replace('\\', "");
            assert!(page.starts_with(".ie") || page.contains(".TH"), "{page}");
            for flag in command.get_arguments().filter(|a| !a.is_hide_set()).filter_map(clap::Arg::get_long) {
                assert!(page.contains(&format!("--{flag}")), "--{flag} of {} is not in its page", command.get_name());
            }
            command.get_subcommands().for_each(checked);
        }
        let mut command = Cli::command();
        command.build();
        checked(&command);
    }

    #[test]
    fn all_pages_go_to_a_folder() {
        let home = tempfile::TempDir::new().unwrap();
        Args { words: Vec::new(), out: Some(home.path().to_path_buf()) }.run().unwrap();
        for name in ["d3dgen.1", "d3dgen-generate.1", "d3dgen-knowledge-search.1"] {
            assert!(home.path().join(name).is_file(), "{name}");
        }
        let wrong = Args { words: vec!["knowledge".into(), "dance".into()], out: None }.run().unwrap_err().to_string();
        assert!(wrong.contains("dance"), "{wrong}");
    }
}
