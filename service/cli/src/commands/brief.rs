//! `d3dgen brief`: what a prompt asks for, fact by fact, before anything is planned.

use std::path::PathBuf;

use d3dgen_model::document::Document;
use d3dgen_prompt::{PromptReader, ReadPrompt};

use crate::error::Error;
use crate::input::write_text;
use crate::registry::RegistryArgs;
use crate::request::prompt;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// What to build, in a sentence (`-`: from standard input)
    #[arg(allow_hyphen_values = true)]
    prompt: String,
    /// Print which rule of the grammar took which words
    #[arg(long, conflicts_with = "json")]
    explain: bool,
    /// Print the document
    #[arg(long)]
    json: bool,
    /// File to write the document to
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let read = PromptReader::new(&self.registry.load()?).read(&prompt(&self.prompt)?);
        if self.json || self.out.is_some() {
            write_text(self.out.as_deref(), &read.brief.to_json())?;
        }
        if !self.json {
            write_text(None, &lines(&read, self.explain))?;
        }
        Ok(())
    }
}

/// Returns a brief as lines for people.
pub(super) fn lines(read: &ReadPrompt, explain: bool) -> String {
    let brief = &read.brief;
    let mut lines = vec![format!("languages: {}", brief.languages.join(", "))];
    lines.extend(
        read.unread_language.iter().map(|l| format!("not read: {l}; only words that languages share are understood")),
    );
    let building = |b: &d3dgen_model::brief::AskedBuilding| {
        let known = b.building_type.as_deref().or(b.domain.as_deref()).unwrap_or("no kind that is known");
        format!("{known} (`{}`, {:.0} %)", b.name, 100.0 * b.confidence)
    };
    lines.extend(brief.building.iter().map(|b| format!("building: {}", building(b))));
    lines.extend(brief.other_buildings.iter().map(|b| format!("     or: {}", building(b))));
    lines.extend(
        brief.place.iter().map(|p| {
            format!("place: {}{}", p.country_code, p.city.as_ref().map_or(String::new(), |c| format!(", {c}")))
        }),
    );
    lines.extend(
        read.facts.iter().zip(&brief.asks).map(|(fact, ask)| format!("{}: {fact}   <- {}", ask.id, ask.said())),
    );
    lines.extend(read.misspelled.iter().map(|(written, meant)| format!("`{written}` is read as `{meant}`")));
    lines.extend(brief.not_understood.iter().map(|w| format!("not understood: {}", w.text)));
    if explain {
        lines.push("rules:".to_owned());
        lines.extend(read.steps.iter().map(|s| format!("  {} `{}` <- {}", s.file, s.rule, s.words)));
    }
    lines.join("\n") + "\n"
}
