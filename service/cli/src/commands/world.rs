//! `d3dgen world`: one world of the four stage documents, checked.

use std::path::PathBuf;

use d3dgen_model::document::Document;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::{brief, generate, world};

use super::formats;
use crate::bundle;
use crate::error::Error;
use crate::input::{document, write_text};
use crate::output::Output;
use crate::registry::{RegistryArgs, domain};
use crate::summary;

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
    /// scenario.json
    #[arg(value_name = "SCENARIO")]
    scenario: PathBuf,
    /// Name of the world, lower case with underscores
    #[arg(long, value_name = "NAME", value_parser = super::world_name)]
    name: Option<String>,
    /// Folder to write as `generate` does; otherwise the world goes to standard output
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    formats: formats::FormatArgs,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let formats = self.formats.chosen(&self.registry.store)?;
        let graph: SceneGraph = document(&self.graph)?;
        let registry = self.registry.load()?;
        let plugin = domain(&registry, &graph.domain)?;
        let name = self.name.unwrap_or_else(|| generate::world_name(&graph));
        let retrieved = generate::retrieve(&graph, plugin);
        let mut world = world::assemble(
            &name,
            graph,
            document(&self.plan)?,
            document(&self.placements)?,
            document(&self.scenario)?,
        );
        world.brief = brief::of_plan(&world.scene_graph.prompt, Some(&world.floorplan), &registry);
        let problems = world.check();
        if !problems.is_empty() {
            let source = d3dgen_model::Error::Invalid { kind: "world", problems };
            return Err(Error::Document { path: "the documents together".into(), source });
        }
        let report = world::check(&world, plugin.domain(), &retrieved);
        world.rules = Some(report.applied_rules());
        let mut kept = None;
        if let Some(folder) = &self.out {
            let output = Output::new(folder)?;
            bundle::write(&world, &report, plugin.domain(), &formats, &output)?;
            kept = output.commit()?;
        }
        summary::print_broken(&report);
        if let Some(kept) = kept {
            eprintln!("{kept}");
        }
        if self.out.is_none() && report.is_writable() {
            write_text(None, &world.to_json())?;
        }
        summary::judged(&report)
    }
}
