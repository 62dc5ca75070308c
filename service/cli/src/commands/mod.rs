//! The commands, one file each; the order here is the order of the help.

pub mod assets;
mod bench;
mod brief;
mod check;
mod completions;
mod dataset;
mod doctor;
mod domains;
mod edit;
mod eval;
mod explain;
mod export;
mod floorplan;
mod formats;
mod furnish;
mod generate;
mod jobs;
mod knowledge;
mod man;
mod mcp;
mod migrate;
mod model;
mod placement;
mod render;
mod research;
mod scenario;
mod scene_graph;
mod self_test;
mod serve;
mod simulate;
mod version;
mod view;
#[cfg(feature = "cluster")]
mod worker;
mod world;

use clap::Subcommand;

#[cfg(test)]
pub use explain::explanations;
pub use formats::Formats;
pub use model::LlmArgs;

use crate::error::Error;

/// Everything `d3dgen` can do.
#[derive(Subcommand)]
pub enum Command {
    /// Make a checked world (or many) from a sentence
    Generate(Box<generate::Args>),
    /// Furnish and judge a plan of yours: floorplan.json, GeoJSON, SVG, DXF, Open-RMF, nav2 map
    Furnish(Box<furnish::Args>),
    /// What a prompt asks for, fact by fact, before anything is planned
    Brief(brief::Args),
    /// Stage 1: rooms and relations of a prompt
    SceneGraph(scene_graph::Args),
    /// Stage 2: room outlines, walls, doors and windows of a scene graph
    Floorplan(floorplan::Args),
    /// Stage 3: furniture of a floorplan
    Placement(placement::Args),
    /// Stage 4: robots, people and named areas of a furnished plan; more scenarios of a world, by the hour
    Scenario(scenario::Args),
    /// Move the people and robots of a world's scenario: tracks, figures of social navigation, a film
    Simulate(simulate::Args),
    /// Stage 5: one world of the four documents, checked
    World(world::Args),
    /// Change a world: move a wall, add a room, swap an object; the rest stays and is checked
    Edit(edit::Args),
    /// Judge worlds: every hard rule and every constraint that applies
    Check(check::Args),
    /// Measure worlds: layout, collisions, navigability, compliance, diversity
    Eval(eval::Args),
    /// Make the worlds of a published benchmark and measure them
    Bench(bench::Args),
    /// Make data sets of many worlds, on one machine or many: spec, shards, index, card
    Dataset(dataset::Args),
    /// Make worlds of data sets for somebody else's `dataset make --nats`
    #[cfg(feature = "cluster")]
    Worker(worker::Args),
    /// Write a world in other formats
    Export(export::Args),
    /// A page that shows a world in three dimensions, to walk in and to open doors
    View(view::Args),
    /// Pictures of a world in three dimensions, from above and from inside
    Render(render::Args),
    /// List, show and validate the kinds of building
    Domains(domains::Args),
    /// Make a knowledge base of documents or of a model's search; find the rules in sentences
    Research(research::Args),
    /// Search, change and look after the database of building rules
    Knowledge(knowledge::Args),
    /// Look into files of 3D models, and look after the database of them
    Assets(assets::Args),
    /// Put a folder of models into the asset database; as `assets ingest`
    Ingest(assets::ingest::Command),
    /// Answer clients in any language over gRPC: the service
    Serve(Box<serve::Args>),
    /// List, watch and cancel the jobs of a server
    Jobs(jobs::Args),
    /// Give agents the commands as tools over the Model Context Protocol (standard input and output)
    Mcp(mcp::Args),
    /// Say what this machine has of what d3dgen can use, and what each missing part would be for
    Doctor(doctor::Args),
    /// Make a world of each kind twice, in a temporary folder, and compare: does this program work here
    SelfTest(self_test::Args),
    /// Bring documents and databases of earlier releases to the form of this one
    Migrate(migrate::Args),
    /// Say what the code of an error means, and what to do
    Explain(explain::Args),
    /// Print a completion script for a shell
    Completions(completions::Args),
    /// Print or write the manual pages of the commands
    Man(man::Args),
    /// Print the version, and the versions of the documents it reads
    Version,
}

impl Command {
    /// Runs the command.
    ///
    /// # Errors
    /// What the user should read; [`Error::exit_code`] says how the process ends.
    pub fn run(self) -> Result<(), Error> {
        match self {
            Self::Generate(args) => args.run(),
            Self::Furnish(args) => args.run(),
            Self::Brief(args) => args.run(),
            Self::SceneGraph(args) => args.run(),
            Self::Floorplan(args) => args.run(),
            Self::Placement(args) => args.run(),
            Self::Scenario(args) => args.run(),
            Self::Simulate(args) => args.run(),
            Self::World(args) => args.run(),
            Self::Edit(args) => args.run(),
            Self::Check(args) => args.run(),
            Self::Eval(args) => args.run(),
            Self::Bench(args) => args.run(),
            Self::Dataset(args) => args.run(),
            #[cfg(feature = "cluster")]
            Self::Worker(args) => args.run(),
            Self::Export(args) => args.run(),
            Self::View(args) => args.run(),
            Self::Render(args) => args.run(),
            Self::Domains(args) => args.run(),
            Self::Research(args) => args.run(),
            Self::Knowledge(args) => args.run(),
            Self::Assets(args) => args.run(),
            Self::Ingest(args) => args.run(),
            Self::Serve(args) => args.run(),
            Self::Jobs(args) => args.run(),
            Self::Mcp(args) => args.run(),
            Self::Doctor(args) => args.run(),
            Self::SelfTest(args) => args.run(),
            Self::Migrate(args) => args.run(),
            Self::Explain(args) => args.run(),
            Self::Completions(args) => args.run(),
            Self::Man(args) => args.run(),
            Self::Version => version::run(),
        }
    }
}

/// Returns the name of a world when Arena takes it.
fn world_name(text: &str) -> Result<String, String> {
    let fits = !text.is_empty() && text.bytes().all(|b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'_'));
    if fits { Ok(text.to_owned()) } else { Err("a name has only a-z, 0-9 and _".into()) }
}
