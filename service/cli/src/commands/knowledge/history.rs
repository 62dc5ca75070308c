//! `d3dgen knowledge history` and `undo`.

use d3dgen_knowledge::database::{Change, Edit};

use crate::database::provenance;
use crate::error::Error;
use crate::input::{write_lines, write_text};
use crate::registry::RegistryArgs;
use crate::table::table;

/// Arguments of `history`.
#[derive(clap::Args)]
pub struct HistoryArgs {
    /// Number of a change to show in full
    seq: Option<u64>,
    /// Only changes of this domain
    #[arg(long, value_name = "ID")]
    domain: Option<String>,
    /// Print one JSON line for each change, or each edit of the change to show
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl HistoryArgs {
    pub fn run(self) -> Result<(), Error> {
        let registry = self.registry.load_as_brought()?;
        let database = self.registry.store.read(&registry)?;
        if let Some(seq) = self.seq {
            let edits = database.edits(seq)?;
            return if self.json { write_lines(&edits) } else { write_text(None, &shown(&edits)) };
        }
        let mut changes = database.history()?;
        changes.retain(|c| self.domain.as_ref().is_none_or(|d| *d == c.domain));
        if self.json {
            return write_lines(&changes);
        }
        let rows: Vec<Vec<String>> = changes.iter().map(row).collect();
        write_text(None, &table(&["change", "what", "domain", "+", "~", "-", "when", "who", "why"], &rows))
    }
}

fn row(c: &Change) -> Vec<String> {
    let what = match (c.undoes, c.undone_by) {
        (Some(seq), _) => format!("{} of {seq}", c.kind.name()),
        (_, Some(seq)) => format!("{}, undone by {seq}", c.kind.name()),
        _ => c.kind.name().to_owned(),
    };
    let counts = [c.added, c.changed, c.removed].map(|n| n.to_string());
    let by = [&c.provenance.when, &c.provenance.who, &c.provenance.why].map(Clone::clone);
    [vec![c.seq.to_string(), what, c.domain.clone()], counts.to_vec(), by.to_vec()].concat()
}

/// Returns edits for people to review: each entry with the fields that differ.
pub fn shown(edits: &[Edit]) -> String {
    let mut text = String::new();
    for edit in edits {
        let sign = match (&edit.before, &edit.after) {
            (None, _) => '+',
            (_, None) => '-',
            _ => '~',
        };
        text += &format!("{sign} {}\n", edit.target.id());
        for f in edit.fields() {
            text += &match (f.before.as_str(), f.after.as_str()) {
                ("", after) => format!("    {}: {after}\n", f.field),
                (before, "") => format!("    {}: {before} (removed)\n", f.field),
                (before, after) => format!("    {}: {before} -> {after}\n", f.field),
            };
        }
    }
    text
}

/// Arguments of `undo`.
#[derive(clap::Args)]
pub struct UndoArgs {
    /// Number of the change, as `history` lists it
    seq: u64,
    /// Who does it; otherwise the user's name
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
    /// Why
    #[arg(long, value_name = "TEXT", default_value = "taken back")]
    why: String,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl UndoArgs {
    pub fn run(self) -> Result<(), Error> {
        let registry = self.registry.load_as_brought()?;
        let database = self.registry.store.open(&registry, None)?;
        let change = database.undo(self.seq, &provenance(self.by.as_deref(), &self.why))?;
        eprint!("{}", shown(&database.edits(change.seq)?));
        eprintln!("change {} takes change {} back", change.seq, self.seq);
        Ok(())
    }
}
