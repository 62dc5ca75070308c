//! `d3dgen assets`: the database of 3D models, and what is known about single files.

mod annotate;
pub mod common;
mod export;
mod generate;
pub mod ingest;
mod inspect;
mod keep;
pub mod reader;
mod search;
mod sheet;
mod show;

use clap::Subcommand;
use d3dgen_assets::annotation::asa;
use d3dgen_assets::catalog::Catalog;
use d3dgen_assets::database::Database;
use d3dgen_assets::stock::Stock;
use d3dgen_export::models::{KeptModel, KeptModels};
use d3dgen_model::domain::Domain;
use d3dgen_plugins::Registry;

use crate::database::StoreArgs;
use crate::error::Error;

/// Gives every domain the assets of the database that stand for its objects. Without a database, or with one that has no
/// assets of its own and nothing removed, nothing changes.
///
/// # Errors
/// `Assets` when the database is damaged.
pub fn stock(registry: &mut Registry, store: &StoreArgs) -> Result<(), Error> {
    let Some(database) = common::if_there(store)? else { return Ok(()) };
    if database.is_empty()? {
        return Ok(());
    }
    let domains: Vec<Domain> = registry.iter().map(|p| p.domain().clone()).collect();
    let catalog = Catalog::new(&domains);
    if let Some(stock) = Stock::read(&database, &catalog)? {
        for stocked in domains.iter().filter_map(|d| stock.stocked(d)) {
            registry.set_domain(stocked);
        }
    }
    Ok(())
}

/// The models of the database, for the files of worlds.
pub struct Kept(Option<Database>);

impl Kept {
    /// Opens the database when there is one.
    ///
    /// # Errors
    /// `Assets` when it is damaged.
    pub fn of(store: &StoreArgs) -> Result<Self, Error> {
        common::if_there(store).map(Self)
    }
}

impl KeptModels for Kept {
    fn model(&self, asset_id: &str) -> Result<Option<KeptModel>, d3dgen_export::Error> {
        let Some(database) = &self.0 else { return Ok(None) };
        let kept = database.placed_model(asset_id);
        let kept =
            kept.map_err(|e| d3dgen_export::Error::Kept { asset: asset_id.to_owned(), reason: e.to_string() })?;
        Ok(kept.map(|(model, annotation)| {
            let tags = asa::tags(&annotation);
            KeptModel { model, tags, description: annotation.description }
        }))
    }
}

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    /// Find assets by what they are for: words, meaning, size, place, conditions
    Search(search::Args),
    /// Print all that is known of an asset
    Show(show::Args),
    /// List assets, by id
    List(search::ListArgs),
    /// Put a folder of models into the database: read, judged, annotated, indexed
    Ingest(ingest::Args),
    /// Make models of an object and keep them
    Generate(generate::Args),
    /// Change what is known of an asset
    Annotate(annotate::Args),
    /// Write models with their annotations as files: USDZ, GLB, SDF
    Export(export::Args),
    /// Remove assets, also of the shipped library; bring those back
    Remove(keep::RemoveArgs),
    /// Draw assets on a contact sheet
    Sheet(sheet::Args),
    /// Look at every record, annotation and file of the database
    Verify(keep::LookArgs),
    /// Count what there is
    Stats(keep::LookArgs),
    /// Print what files of models hold, without storing them
    Inspect(inspect::Args),
    /// Read the models named on standard input; the process that other commands start, with limits
    #[command(hide = true, name = reader::READ_MODELS)]
    ReadModels {
        /// Most memory of the process
        memory_bytes: u64,
    },
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        match self.action {
            Action::Search(args) => args.run(),
            Action::Show(args) => args.run(),
            Action::List(args) => args.run(),
            Action::Ingest(args) => args.run(),
            Action::Generate(args) => args.run(),
            Action::Annotate(args) => args.run(),
            Action::Export(args) => args.run(),
            Action::Remove(args) => args.run(),
            Action::Sheet(args) => args.run(),
            Action::Verify(args) => args.verify(),
            Action::Stats(args) => args.stats(),
            Action::Inspect(args) => args.run(),
            Action::ReadModels { memory_bytes } => reader::serve(memory_bytes),
        }
    }
}
