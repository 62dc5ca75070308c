//! `d3dgen placement`: a floorplan gets its furniture.

use std::path::PathBuf;

use d3dgen_model::document::Document;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::Placements;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::generate::retrieve;
use d3dgen_pipeline::placement;

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
    /// Earlier placements; those with `locked: true` stay where they are
    #[arg(long, value_name = "PLACEMENTS")]
    pin: Option<PathBuf>,
    /// Seed, instead of the floorplan's own: other furniture in the same rooms
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
        let pinned = self.pin.as_deref().map(document::<Placements>).transpose()?;
        let registry = self.registry.load()?;
        let plugin = domain(&registry, &graph.domain)?;
        graph.seed = self.seed.unwrap_or(plan.seed);
        let limits = retrieve(&graph, plugin).limits;
        let placements = placement::generate(&graph, &plan, plugin.domain(), &limits, pinned.as_ref())?;
        write_text(self.out.as_deref(), &placements.to_json())
    }
}
