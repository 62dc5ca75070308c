//! `d3dgen assets ingest`: folders of models into the database.

use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::Instant;

use d3dgen_assets::ingest::{Options, Summary, ingest};

use super::common::{World, by, open};
use super::reader;
use crate::error::Error;
use crate::input::write_text;
use crate::interrupt;
use crate::progress::Progress;
use crate::registry::RegistryArgs;
use crate::remote::{self, ServerArgs};

/// Refused files that are printed in full.
const SHOWN: usize = 40;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Folder of models, or one file: USD, USDZ, GLB, glTF, OBJ, DAE, STL, SDF
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Domain under which assets are kept when neither metadata nor folders tell: Office
    #[arg(long, value_name = "NAME")]
    domain: Option<String>,
    /// Who does it; otherwise the user's name
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
    /// Why, for the history
    #[arg(long, default_value = "models ingested", value_name = "SENTENCE")]
    why: String,
    /// Print what became of each file as one JSON line each, then the counts
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
    #[command(flatten)]
    server: ServerArgs,
}

/// Arguments of `d3dgen ingest`.
#[derive(clap::Args)]
pub struct Command {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    /// Put a folder of models into the asset database; other formats than USDZ in it too
    UsdzFolder(Args),
}

impl Command {
    pub fn run(self) -> Result<(), Error> {
        match self.what {
            What::UsdzFolder(args) => args.run(),
        }
    }
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        if let Some(remote) = self.server.instead_of(&self.registry)? {
            let (begun, progress) = (Instant::now(), Progress::of(1));
            let asked = (self.domain.as_deref(), self.why.as_str());
            let summary = remote::assets::ingest(&remote, &self.folder, asked, &progress);
            progress.finish();
            return self.print(&summary?, begun.elapsed().as_secs_f64());
        }
        let world = World::load(&self.registry)?;
        std::fs::metadata(&self.folder).map_err(|source| Error::Read { path: self.folder.clone(), source })?;
        let database = open(&self.registry.store)?;
        interrupt::listen();
        let (begun, progress) = (Instant::now(), Progress::of(1));
        let report = |done: usize, total: usize, path: &str| progress.doing(&format!("{done} of {total}: {path}"));
        let cancelled = || interrupt::flag().load(Ordering::SeqCst);
        let provenance = by(self.by.as_deref(), &self.why);
        let options = Options {
            domain: self.domain.as_deref(),
            by: &provenance,
            workers: std::thread::available_parallelism().map_or(1, |n| n.get()).min(8),
            progress: &report,
            cancelled: &cancelled,
        };
        let summary = ingest(&database, &self.folder, &world.catalog, &reader::pool()?, &options);
        progress.finish();
        self.print(&summary?, begun.elapsed().as_secs_f64())
    }

    fn print(&self, summary: &Summary, seconds: f64) -> Result<(), Error> {
        if self.json {
            write_text(None, &json(summary, seconds))?;
        } else {
            write_text(None, &shown(summary, seconds))?;
        }
        if summary.cancelled { Err(Error::Interrupted) } else { Ok(()) }
    }
}

fn shown(summary: &Summary, seconds: f64) -> String {
    let [added, updated, unchanged, refused] = summary.counts();
    let rate = (added + updated) as f64 / seconds.max(1e-9);
    let mut text = format!(
        "{added} added, {updated} updated, {unchanged} unchanged, {refused} refused in {seconds:.1} s ({rate:.0} models/s)\n"
    );
    for (path, reason) in summary.refused().take(SHOWN) {
        text += &format!("refused {path}: {reason}\n");
    }
    if refused > SHOWN {
        text += &format!("and {} more; --json names all\n", refused - SHOWN);
    }
    text
}

fn json(summary: &Summary, seconds: f64) -> String {
    let [added, updated, unchanged, refused] = summary.counts();
    let mut text = String::new();
    for (path, outcome) in &summary.files {
        let mut line = serde_json::to_value(outcome).unwrap_or_default();
        line["file"] = path.as_str().into();
        text += &format!("{line}\n");
    }
    let counts = serde_json::json!({
        "added": added, "updated": updated, "unchanged": unchanged, "refused": refused, "seconds": seconds,
        "cancelled": summary.cancelled,
    });
    text + &format!("{counts}\n")
}
