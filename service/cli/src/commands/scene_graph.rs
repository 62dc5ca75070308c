//! `d3dgen scene-graph`: the rooms and relations of a prompt, or those of an earlier document.

use std::path::PathBuf;

use d3dgen_model::document::Document;
use d3dgen_pipeline::brief;

use crate::error::Error;
use crate::input::{self, write_text};
use crate::registry::RegistryArgs;
use crate::request::RequestArgs;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// What to build, in a sentence (`-`: from standard input), or a brief.json
    #[arg(required_unless_present_any = ["from", "brief"], conflicts_with = "from", allow_hyphen_values = true)]
    prompt: Option<String>,
    /// Take the graph of a scene_graph.json, a world.json, or a world's folder
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// Write only ids, room types and the connections that must exist: what a referee compares a world with
    #[arg(long)]
    simple: bool,
    /// File to write; otherwise standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    request: RequestArgs,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let graph = match (&self.from, &self.prompt) {
            (Some(file), _) => input::scene_graph(file)?,
            (None, text) => {
                let request = self.request.request(text.as_deref())?;
                brief::rooms(&request, &self.registry.load()?)?.0
            }
        };
        input::tell(&graph.conflicts);
        let text = if self.simple { format!("{:#}\n", graph.to_simple()) } else { graph.to_json() };
        write_text(self.out.as_deref(), &text)
    }
}
