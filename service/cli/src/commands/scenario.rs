//! `d3dgen scenario`: robots, people and named areas of a furnished plan.

use std::path::PathBuf;

use d3dgen_model::document::Document;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::Placements;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::scenario;

use crate::error::Error;
use crate::input::{document, write_text};
use crate::registry::{RegistryArgs, domain};

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// scene_graph.json
    #[arg(value_name = "GRAPH")]
    graph: PathBuf,
    /// floorplan.json
    #[arg(value_name = "PLAN")]
    plan: PathBuf,
    /// placements.json
    #[arg(value_name = "PLACEMENTS")]
    placements: PathBuf,
    /// Seed, instead of the placements' own
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// File to write; otherwise standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let mut graph: SceneGraph = document(&self.graph)?;
        let plan: Floorplan = document(&self.plan)?;
        let placements: Placements = document(&self.placements)?;
        let registry = self.registry.load()?;
        let plugin = domain(&registry, &graph.domain)?;
        graph.seed = self.seed.unwrap_or(placements.seed);
        let scenario = scenario::generate(&graph, &plan, &placements, plugin.domain())?;
        write_text(self.out.as_deref(), &scenario.to_json())
    }
}
