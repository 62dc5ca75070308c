//! `d3dgen knowledge`: the database of building rules.

mod amend;
mod history;
mod retrieve;
pub(super) mod search;
mod stats;
mod transfer;
mod verify;

use clap::Subcommand;

use crate::error::Error;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    /// Find rules by words, by meaning and by filters
    Search(search::Args),
    /// The rules that apply to rooms of a building in a country, contradictions settled
    Retrieve(retrieve::Args),
    /// Counts of each knowledge base, and the share of its rules that worlds can be held against
    Stats(stats::Args),
    /// Put a knowledge base into the database
    Import(transfer::ImportArgs),
    /// Write a knowledge base with every change in force
    Export(transfer::ExportArgs),
    /// Change rules: a sentence, another figure, or an edited file; shown first, listed in `history`
    Amend(amend::Args),
    /// List the changes of the database, or show one of them
    History(history::HistoryArgs),
    /// Take a change back
    Undo(history::UndoArgs),
    /// Look at every record and document of the database
    Verify(verify::Args),
    /// Copy the whole database into one file
    Snapshot(transfer::SnapshotArgs),
    /// Make a database of a snapshot
    Restore(transfer::RestoreArgs),
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        match self.action {
            Action::Search(args) => args.run(),
            Action::Retrieve(args) => args.run(),
            Action::Stats(args) => args.run(),
            Action::Import(args) => args.run(),
            Action::Export(args) => args.run(),
            Action::Amend(args) => args.run(),
            Action::History(args) => args.run(),
            Action::Undo(args) => args.run(),
            Action::Verify(args) => args.run(),
            Action::Snapshot(args) => args.run(),
            Action::Restore(args) => args.run(),
        }
    }
}
