//! `d3dgen scenario`: robots, people and named areas of a furnished plan; several scenarios of one world.

use std::path::{Path, PathBuf};

use d3dgen_model::document::Document;
use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::hours;
use d3dgen_model::placements::Placements;
use d3dgen_model::scenario::Scenario;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::world::World;
use d3dgen_pipeline::scenario::{self, Wishes};

use crate::error::Error;
use crate::input::{document, write_text};
use crate::registry::{RegistryArgs, domain};

/// Folder of a world's further scenarios.
const FOLDER: &str = "scenarios";

/// Which scenario of a world.
#[derive(clap::Args)]
pub struct ScenarioArgs {
    /// Name of the scenario among those of the world: scenarios/NAME.json in its folder
    #[arg(long = "scenario", value_name = "NAME", value_parser = super::world_name)]
    name: Option<String>,
    /// Hour of the day: night, shift_change, opening, morning_round, school_break, day, lunch, boarding, visiting, busy, evening,
    /// closing
    #[arg(long, value_name = "HOUR", value_parser = hour)]
    time: Option<String>,
    /// Seed, instead of the placements' own
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
}

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// A world (its folder or world.json), or scene_graph.json, floorplan.json and placements.json
    #[arg(value_name = "WORLD | GRAPH PLAN PLACEMENTS", required = true, num_args = 1..=3)]
    documents: Vec<PathBuf>,
    #[command(flatten)]
    scenario: ScenarioArgs,
    /// File to write; otherwise scenarios/NAME.json of the world where the scenario has a name, else standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    registry: RegistryArgs,
}

/// Returns an hour that is known.
fn hour(text: &str) -> Result<String, String> {
    match hours::get(text) {
        Some(hour) => Ok(hour.id.clone()),
        None => Err(format!("there are {}", hours::ids().join(", "))),
    }
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let registry = self.registry.load()?;
        let (graph, plan, placements, brief) = match self.documents.as_slice() {
            [world] => {
                let world = world_of(world)?;
                (world.scene_graph, world.floorplan, world.placements, world.brief)
            }
            [graph, plan, placements] => (
                document::<SceneGraph>(graph)?,
                document::<Floorplan>(plan)?,
                document::<Placements>(placements)?,
                None,
            ),
            _ => return Err(Error::Input("give a world, or its scene graph, floorplan and placements".into())),
        };
        let plugin = domain(&registry, &graph.domain)?;
        let seed = self.scenario.seed.unwrap_or(placements.seed);
        let graph = SceneGraph { seed, ..graph };
        let wishes = Wishes { brief: brief.as_ref(), ..self.scenario.wishes() };
        let made = scenario::generate_as(&graph, &plan, &placements, plugin.domain(), &wishes)?;
        let own = self.scenario.name.as_ref().filter(|_| self.documents.len() == 1);
        let own = own.map(|name| file_of(&self.documents[0], name));
        write_text(self.out.as_deref().or(own.as_deref()), &made.to_json())
    }
}

impl ScenarioArgs {
    fn wishes(&self) -> Wishes<'_> {
        Wishes { name: self.name.as_deref().unwrap_or_default(), hour: self.time.as_deref(), ..Wishes::default() }
    }
}

/// Returns the file of a scenario of a world.
fn file_of(world: &Path, name: &str) -> PathBuf {
    let folder = if world.is_dir() { world } else { world.parent().unwrap_or(Path::new(".")) };
    folder.join(FOLDER).join(format!("{name}.json"))
}

/// Returns a world from its file or folder.
///
/// # Errors
/// `Read`, or `Document` with every problem.
pub fn world_of(path: &Path) -> Result<World, Error> {
    document(path)
}

/// Returns the scenario of a world that is asked for: the one of this name, else one made for this hour or seed, else its own.
///
/// # Errors
/// `Read` or `Document` for a file that is none, `Stage` when none can be made.
pub fn world_with(world: &World, path: &Path, domain: &Domain, asked: &ScenarioArgs) -> Result<Scenario, Error> {
    if let Some(name) = &asked.name {
        let file = file_of(path, name);
        if asked.time.is_none() || file.exists() {
            return document(&file);
        }
    }
    if asked.time.is_none() && asked.seed.is_none() {
        return Ok(world.scenario.clone());
    }
    let graph = SceneGraph { seed: asked.seed.unwrap_or(world.placements.seed), ..world.scene_graph.clone() };
    let wishes = Wishes { brief: world.brief.as_ref(), ..asked.wishes() };
    Ok(scenario::generate_as(&graph, &world.floorplan, &world.placements, domain, &wishes)?)
}
