//! `d3dgen dataset status`: how far a data set is.

use std::path::PathBuf;
use std::time::Duration;

use d3dgen_dataset::standing::{Doing, Pace, Standing, failed};
use serde_json::json;

use super::disk;
use crate::error::Error;
use crate::input::write_text;

/// Failures that are said one by one.
const MOST_FAILURES: usize = 10;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Folder of a data set, finished or not, or of a shard
    folder: PathBuf,
    /// Print one JSON line
    #[arg(long)]
    json: bool,
    /// How many tasks without a world to say with their reason
    #[arg(long, value_name = "N", default_value_t = MOST_FAILURES)]
    failures: usize,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let standing = Standing::of(&self.folder)?;
        let failures = if standing.failed > 0 { failed(&self.folder, self.failures)? } else { Vec::new() };
        if self.json {
            let mut line = serde_json::to_value(&standing).expect("it has string keys only");
            line["failures"] = json!(failures);
            return write_text(None, &format!("{line}\n"));
        }
        eprintln!(
            "{}: {} of {} tasks done, {} worlds, {} without one, {}{}",
            match standing.doing {
                Doing::Finished => "finished",
                Doing::Running => "in the making",
                Doing::Stopped => "stopped",
            },
            standing.done(),
            standing.tasks,
            standing.worlds,
            standing.failed,
            disk::size(standing.bytes),
            standing.pace.map_or_else(String::new, said)
        );
        for failure in &failures {
            eprintln!("  `{}`, seed {}: {}", failure.prompt, failure.seed, failure.reason);
        }
        if standing.failed > failures.len() as u64 {
            eprintln!("  and {} more, --failures {}", standing.failed - failures.len() as u64, standing.failed);
        }
        Ok(())
    }
}

fn said(pace: Pace) -> String {
    let left = humantime::format_duration(Duration::from_secs(pace.seconds_left.ceil() as u64));
    format!(", {:.1} a second, {left} left", pace.per_second)
}
