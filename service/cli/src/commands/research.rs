//! `d3dgen research`: building rules out of text.

use std::path::{Path, PathBuf};

use clap::Subcommand;
use d3dgen_research::jsonl;

use crate::error::Error;
use crate::input::{text, write_text};

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
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
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        match self.action {
            Action::Extract { file, out } => extract(&file, out.as_deref()),
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
                #[allow(unreachable_patterns)] // the crate's other errors are of documents and addresses
                other => format!("{name}: {other}"),
            })
            .collect();
        Error::Input(lines.join("\n"))
    })?;
    write_text(out, &jsonl::extract(&passages))
}
