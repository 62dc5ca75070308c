//! `d3dgen floorplan`: a scene graph becomes room outlines, walls, doors and windows.

use std::path::PathBuf;

use d3dgen_model::document::Document;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::generate::Settings;
use d3dgen_pipeline::{floorplan, generate};

use crate::error::Error;
use crate::input::{document, tell, write_text};
use crate::interrupt;
use crate::registry::{RegistryArgs, domain};

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// scene_graph.json
    #[arg(value_name = "GRAPH")]
    graph: PathBuf,
    /// Earlier floorplan whose rooms with `locked: true` are kept
    #[arg(long, value_name = "PLAN")]
    pin: Option<PathBuf>,
    /// Seed, instead of the graph's own: another plan of the same rooms
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
        let pinned = self.pin.as_deref().map(document::<Floorplan>).transpose()?;
        let registry = self.registry.load()?;
        let plugin = domain(&registry, &graph.domain)?;
        graph.seed = self.seed.unwrap_or(graph.seed);
        let whole =
            |graph| generate::furnish_and_check(graph, &registry, &Settings::default(), &mut |_| {}, interrupt::flag());
        let plan = match pinned {
            // The plan `generate` takes: a first one that cannot be furnished is passed over there, too.
            None if let Ok(made) = whole(&graph) => made.world.floorplan,
            _ => {
                let limits = generate::retrieve(&graph, plugin).limits;
                floorplan::generate(&graph, plugin.domain(), &limits, pinned.as_ref())?
            }
        };
        tell(&plan.conflicts);
        write_text(self.out.as_deref(), &plan.to_json())
    }
}
