//! `d3dgen eval`: measures of the worlds below a folder.

mod worlds;

use std::path::PathBuf;

use d3dgen_eval::figures::{FIGURES, Figure};
use d3dgen_eval::html::{self, Picture};
use d3dgen_eval::{Evaluation, compare, figures};
use d3dgen_model::document::Document;

use crate::error::Error;
use crate::input::write_text;
use crate::parallel;
use crate::registry::RegistryArgs;
use crate::table::table;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Folder with any number of worlds (world.json, and report.json beside it), at any depth
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Write all measures as a document (schemas/evaluation.schema.json); `-`: to standard output, in place of the table
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write a web page with tables and plans, in one file
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Most plans in the page, taken evenly from all worlds
    #[arg(long, value_name = "N", default_value_t = PICTURES)]
    pictures: usize,
    /// Folder with other worlds: layouts are compared with those of the same domain in it
    #[arg(long, value_name = "DIR")]
    reference: Option<PathBuf>,
    /// Make every world once more from its scene graph, to tell how long that takes; one thread unless --threads says more
    #[arg(long)]
    time: bool,
    /// Threads; otherwise one for each core
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    #[command(flatten)]
    registry: RegistryArgs,
}

/// Most plans in a page when nothing else is asked for.
pub const PICTURES: usize = 60;

impl Args {
    pub fn run(self) -> Result<(), Error> {
        // worlds that are made at a time are in each other's way
        let usual = || if self.time { 1 } else { parallel::default_threads() };
        let threads = self.threads.map_or_else(usual, usize::from);
        let makers = self.time.then(|| self.registry.load()).transpose()?;
        let found = worlds::measured(&self.folder, threads, makers.as_ref())?;
        let reference = self.reference.as_ref().map(|dir| worlds::measured(dir, threads, None)).transpose()?;
        let (reference, unread) = reference.map_or_else(Default::default, |r| (r.worlds, r.broken));
        let evaluation = compare::evaluation(found.worlds, &reference, [found.broken, unread].concat());
        if let Some(file) = &self.html {
            let title = format!("Worlds of {}", self.folder.display());
            let chosen = html::chosen(&evaluation, self.pictures);
            let draw =
                |i: &usize| Ok(Picture { world: *i, svg: worlds::picture(&self.folder, &evaluation.worlds[*i])? });
            write_text(Some(file), &html::page(&evaluation, &title, &parallel::map(&chosen, threads, draw)?))?;
        }
        if let Some(file) = &self.json {
            write_text(Some(file), &evaluation.to_json())?;
        }
        if self.json.as_deref().is_none_or(|f| f != "-") {
            print(&evaluation)?;
        }
        for broken in &evaluation.broken {
            eprintln!("{}: {}", broken.path, broken.message);
        }
        match evaluation.broken.first() {
            None => Ok(()),
            Some(first) => Err(Error::Input(format!(
                "{} file(s) could not be read, first {}; {} worlds were measured",
                evaluation.broken.len(),
                first.path,
                evaluation.worlds.len()
            ))),
        }
    }
}

/// Prints the tables of all groups.
///
/// # Errors
/// `Write`.
pub fn print(evaluation: &Evaluation) -> Result<(), Error> {
    // three tables of a width that a terminal shows
    let mut text = String::new();
    for names in FIGURES.chunks(FIGURES.len().div_ceil(3)) {
        text += &groups(evaluation, names);
        text.push('\n');
    }
    text += &diversity(evaluation);
    let rows: Vec<Vec<String>> = evaluation
        .distances
        .iter()
        .map(|d| {
            [
                vec![format!("{} - {}", d.a, d.b)],
                d.features.values().chain([&d.mean]).map(|v| format!("{v:.2}")).collect(),
            ]
            .concat()
        })
        .collect();
    if let Some(first) = evaluation.distances.first() {
        let header: Vec<&str> = ["distance of layouts"]
            .into_iter()
            .chain(first.features.keys().map(String::as_str))
            .chain(["mean"])
            .collect();
        text += &format!("\n{}", table(&header, &rows));
    }
    write_text(None, &text)
}

fn groups(evaluation: &Evaluation, figures: &[Figure]) -> String {
    let (header, rows) = evaluation.group_table(&evaluation.measured(figures));
    table(&header, &rows)
}

/// Returns how different the worlds of one prompt are, over all prompts.
fn diversity(evaluation: &Evaluation) -> String {
    let prompts = &evaluation.prompts;
    if prompts.is_empty() {
        return String::new();
    }
    let mean = |of: fn(&d3dgen_eval::metrics::diversity::Diversity) -> f64| {
        figures::Form::Percent.text(prompts.iter().map(of).sum::<f64>() / prompts.len() as f64)
    };
    format!(
        "different plans of one prompt, mean of {} prompts: adjacency {}, geometry {}, both {}\n",
        prompts.len(),
        mean(|p| p.adjacencies),
        mean(|p| p.geometries),
        mean(|p| p.plans)
    )
}
