//! `d3dgen bench paper`: the paper's 450 worlds of a fixed list of prompts, timed, measured, beside the paper's figures.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use d3dgen_eval::bench::{self, Task};
use d3dgen_eval::html::{self, Picture};
use d3dgen_eval::{Known, WorldMeasures, compare, measure, picture};
use d3dgen_model::document::Document;
use d3dgen_pipeline::generate::{Generated, Settings, generate_world};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_plugins::Registry;

use crate::bundle;
use crate::commands::Formats;
use crate::commands::eval::{PICTURES, print};
use crate::commands::formats::FormatArgs;
use crate::error::Error;
use crate::input::write_text;
use crate::interrupt;
use crate::output::Output;
use crate::parallel;
use crate::progress::Progress;
use crate::registry::{RegistryArgs, domain};
use crate::stage_clock::StageClock;
use crate::table::table;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Folder to keep the worlds in, with evaluation.json and evaluation.html; new or empty
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Formats of the worlds kept, with commas between; no pictures but plan.svg
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "arena", requires = "out")]
    format: Vec<String>,
    /// Worlds of each domain and number of rooms; the paper has 50
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    each: u32,
    /// Threads; otherwise one for each core
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    #[command(flatten)]
    registry: RegistryArgs,
}

/// What came of a task.
enum Outcome {
    /// A world: its measures, its plan where it is wanted, and the first rules it breaks.
    Made(Box<WorldMeasures>, Option<String>),
    /// None, and why.
    Failed(String),
}

/// What all worlds share.
struct Maker<'a> {
    registry: Registry,
    formats: Formats,
    out: Option<&'a Path>,
    progress: Progress,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let (cases, published) = (bench::cases()?, bench::published()?);
        if let Some(out) = &self.out {
            check_empty(out)?;
        }
        let threads = self.threads.map_or_else(parallel::default_threads, usize::from);
        let tasks = bench::tasks(&cases, self.each);
        let maker = Maker {
            registry: self.registry.load()?,
            formats: FormatArgs::without_png(self.format.clone()).chosen(&self.registry.store)?,
            out: self.out.as_deref(),
            progress: Progress::of(tasks.len()),
        };
        let begun = Instant::now();
        let outcomes = parallel::map(&tasks, threads, |task| maker.make(task))?;
        let took = begun.elapsed().as_secs_f64();
        maker.progress.finish();

        let (mut worlds, mut plans, mut failed) = (Vec::new(), BTreeMap::new(), Vec::new());
        for (task, outcome) in tasks.iter().zip(outcomes) {
            match outcome {
                Outcome::Made(measures, plan) => {
                    plans.extend(plan.map(|svg| (measures.path.clone(), svg)));
                    worlds.push(*measures);
                }
                Outcome::Failed(reason) => failed.push(format!("{} (seed {}): {reason}", task.prompt, task.seed)),
            }
        }
        let evaluation = compare::evaluation(worlds, &[], Vec::new());
        if let Some(out) = &self.out {
            let pictures: Vec<Picture> = html::chosen(&evaluation, PICTURES)
                .into_iter()
                .filter_map(|world| {
                    let svg = plans.remove(&evaluation.worlds[world].path)?;
                    Some(Picture { world, svg })
                })
                .collect();
            write_text(Some(&out.join("evaluation.json")), &evaluation.to_json())?;
            let page = html::page(&evaluation, "The paper's benchmark", &pictures);
            write_text(Some(&out.join("evaluation.html")), &page)?;
        }
        for t in bench::tables(&published, &evaluation) {
            let header: Vec<&str> = t.header.iter().map(String::as_str).collect();
            write_text(None, &format!("{}\n{}\n", t.title, table(&header, &t.rows)))?;
        }
        print(&evaluation)?;
        write_text(None, &stages(&evaluation.worlds))?;
        eprintln!(
            "{} worlds made, checked, measured{} in {took:.1} s on {threads} thread(s)",
            evaluation.worlds.len(),
            if self.out.is_some() { " and written" } else { "" }
        );
        failed.iter().for_each(|line| eprintln!("not made: {line}"));
        let unsound: Vec<&str> =
            evaluation.worlds.iter().filter(|w| w.sound == Some(false)).map(|w| w.path.as_str()).collect();
        unsound.iter().for_each(|path| eprintln!("breaks hard rules: {path}"));
        if failed.is_empty() && unsound.is_empty() {
            return Ok(());
        }
        Err(Error::Unsound(format!(
            "{} of {} worlds were not made and {} break hard rules",
            failed.len(),
            tasks.len(),
            unsound.len()
        )))
    }
}

impl Maker<'_> {
    /// Makes, checks and measures a world, and writes it where worlds are kept.
    fn make(&self, task: &Task) -> Result<Outcome, Error> {
        let request = Request {
            prompt: task.prompt.clone(),
            seed: task.seed,
            domain: None,
            country: None,
            rooms: None,
            area_m2: None,
            robot_radius_m: None,
            ..Request::default()
        };
        let settings = Settings { name: Some(task.path.replace('/', "_")), ..Settings::default() };
        let mut clock = StageClock::default();
        let made =
            generate_world(&request, &self.registry, &settings, &mut |event| clock.hear(&event), interrupt::flag());
        self.progress.count();
        let made = match made {
            Ok(made) => made,
            Err(d3dgen_pipeline::Error::Cancelled) => return Err(Error::Interrupted),
            Err(error) => return Ok(Outcome::Failed(error.to_string())),
        };
        let known = Known { rooms_asked: Some(task.rooms), stage_ms: clock.stage_ms() };
        let measures = measure(&made.world, Some(&made.report), &task.path, &known);
        let plan = self.out.map(|_| picture::svg(&made.world, &measures));
        self.write(task, &made)?;
        Ok(Outcome::Made(Box::new(measures), plan))
    }

    fn write(&self, task: &Task, made: &Generated) -> Result<(), Error> {
        let Some(out) = self.out else { return Ok(()) };
        let domain = domain(&self.registry, &made.world.scene_graph.domain)?.domain();
        let output = Output::new(&out.join(&task.path))?;
        bundle::write(&made.world, &made.report, domain, &self.formats, &output)?;
        output.commit().map(drop)
    }
}

/// Returns the table of the stages' times.
fn stages(worlds: &[WorldMeasures]) -> String {
    let mut times: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for world in worlds {
        world.stage_ms.iter().for_each(|(stage, ms)| times.entry(stage).or_default().push(*ms));
        times.entry("all").or_default().push(world.stage_ms.values().sum());
    }
    let order = d3dgen_pipeline::generate::Stage::ALL.iter().map(|s| s.name()).chain(["all"]);
    let row = |stage: &str| {
        let mut ms = times.get(stage)?.clone();
        ms.sort_by(f64::total_cmp);
        let at = |share: f64| format!("{:.1}", ms[((ms.len() - 1) as f64 * share).round() as usize]);
        Some(vec![stage.to_owned(), at(0.5), at(0.95), at(1.0)])
    };
    let rows: Vec<Vec<String>> = order.filter_map(row).collect();
    format!("\n{}", table(&["stage", "median ms", "95 % ms", "most ms"], &rows))
}

/// Refuses a folder that holds anything.
fn check_empty(path: &Path) -> Result<(), Error> {
    let refused = |source| Error::Read { path: path.to_path_buf(), source };
    if path.exists() && std::fs::read_dir(path).map_err(refused)?.next().is_some() {
        return Err(Error::Input(format!("{} is not empty; --out needs a new or empty folder", path.display())));
    }
    Ok(())
}
