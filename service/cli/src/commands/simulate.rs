//! `d3dgen simulate`: the people and robots of a world's scenario, moved.

use std::path::PathBuf;

use d3dgen_crowd::{Options, Run, simulate};
use d3dgen_export::film;
use d3dgen_model::document::Document;

use super::scenario::{ScenarioArgs, world_with};
use crate::error::Error;
use crate::interrupt;
use crate::output::Output;
use crate::progress::Progress;
use crate::registry::{RegistryArgs, domain};

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// world.json, or a world's folder
    #[arg(value_name = "WORLD")]
    world: PathBuf,
    #[command(flatten)]
    scenario: ScenarioArgs,
    /// Length, s
    #[arg(long, default_value_t = 600.0, value_name = "S")]
    seconds: f64,
    /// Folder to write trajectory.json, walkable.geojson, metrics.json, scenario.json and the film crowd.png into
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// No film
    #[arg(long)]
    no_film: bool,
    /// Print the figures of all together as one JSON line
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let output = Output::run_of(&self.out)?;
        let registry = self.registry.load()?;
        let mut world = super::scenario::world_of(&self.world)?;
        let plugin = domain(&registry, &world.scene_graph.domain)?;
        world.scenario = world_with(&world, &self.world, plugin.domain(), &self.scenario)?;
        let options = Options { seconds: self.seconds, seed: self.scenario.seed };
        let progress = Progress::of(1);
        let mut observe = |t: f64| {
            progress.doing(&format!("{t:.0} of {:.0} s", self.seconds));
            interrupt::check().is_ok()
        };
        let run = simulate(&world, plugin.domain(), options, &mut observe);
        progress.finish();
        interrupt::check()?;
        let run = run.map_err(|e| Error::Input(e.to_string()))?;
        output.write("trajectory.json", compact(&run.trajectory)?.as_bytes())?;
        output.write("walkable.geojson", compact(&run.walkable)?.as_bytes())?;
        output.write("metrics.json", format!("{:#}\n", run.metrics).as_bytes())?;
        output.write("scenario.json", world.scenario.to_json().as_bytes())?;
        if !self.no_film {
            output.write("crowd.png", &film::film(&world, &run.trajectory, self.seconds)?)?;
        }
        output.commit()?;
        self.tell(&run)
    }

    fn tell(&self, run: &Run) -> Result<(), Error> {
        if self.json {
            let line = serde_json::json!({"world": run.trajectory.world, "people": run.trajectory.agents.len(), "robots": run.trajectory.robots.len(), "all": run.metrics["all"]});
            return crate::input::write_text(None, &format!("{line}\n"));
        }
        let conditions = run.metrics["conditions"].as_array().map_or(0, Vec::len);
        let held = run.metrics["conditions"].as_array().into_iter().flatten().filter(|c| c["holds"] == true).count();
        eprintln!(
            "simulated {} s of {}: {} people, {} robots, {held} of {conditions} conditions hold; wrote {}",
            self.seconds,
            run.trajectory.world,
            run.trajectory.agents.len(),
            run.trajectory.robots.len(),
            self.out.display()
        );
        Ok(())
    }
}

/// Returns a record as one line of JSON.
fn compact(value: &impl serde::Serialize) -> Result<String, Error> {
    serde_json::to_string(value).map(|line| line + "\n").map_err(|e| Error::Input(e.to_string()))
}
