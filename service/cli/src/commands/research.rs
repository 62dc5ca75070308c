//! `d3dgen research`: building rules out of documents, out of a model's search, and out of single sentences.

mod model;
mod run;

use std::path::{Path, PathBuf};

use clap::Subcommand;
use d3dgen_research::{jsonl, read};

use crate::error::Error;
use crate::input::{text, write_text};

pub use run::pdf_program;

/// Arguments.
#[derive(clap::Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = run::AFTER_HELP,
)]
pub struct Args {
    #[command(subcommand)]
    action: Option<Action>,
    #[command(flatten)]
    run: Box<run::RunArgs>,
}

#[derive(Subcommand)]
enum Action {
    /// Find the constraints in sentences, without a language model
    Extract {
        /// One JSON object {id, text, lang} a line; `-` for standard input
        #[arg(value_name = "FILE.jsonl")]
        file: PathBuf,
        /// File to write, one JSON object {id, constraints} a line; standard output when left out
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Read a PDF file from standard input; the process that `research` starts for each, with limits
    #[command(hide = true, name = run::READ_PDF)]
    ReadPdf {
        /// Most memory of the process
        memory_bytes: u64,
        /// Longest time of the process
        seconds: u64,
    },
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        match self.action {
            Some(Action::Extract { file, out }) => extract(&file, out.as_deref()),
            Some(Action::ReadPdf { memory_bytes, seconds }) => {
                let (input, output) = (std::io::stdin().lock(), std::io::stdout().lock());
                read::pdf::run_child(input, output, memory_bytes, seconds)
                    .map_err(|source| Error::Read { path: "standard input".into(), source })
            }
            None => self.run.run(),
        }
    }
}

fn extract(file: &Path, out: Option<&Path>) -> Result<(), Error> {
    let (path, text) = text(file, "sentences.jsonl")?;
    let passages = jsonl::parse(&text).map_err(|errors| {
        let name = if path == Path::new("-") { "standard input".into() } else { path.display().to_string() };
        let lines: Vec<String> = errors
            .iter()
            .map(|e| match e {
                d3dgen_research::Error::Line { line, reason } => format!("{name}:{line}: {reason}"),
                other => format!("{name}: {other}"),
            })
            .collect();
        Error::Input(lines.join("\n"))
    })?;
    write_text(out, &jsonl::extract(&passages))
}
