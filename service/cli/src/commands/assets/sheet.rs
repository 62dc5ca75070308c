//! `d3dgen assets sheet`: pictures of many assets on one page.

use std::path::{Path, PathBuf};

use d3dgen_assets::database::Shelf;
use d3dgen_assets::search::SearchQuery;
use d3dgen_mesh::picture;

use super::common::{Choice, World, write_picture};
use crate::error::Error;
use crate::interrupt;
use crate::progress::Progress;
use crate::registry::RegistryArgs;

/// Side of a picture on a sheet, px.
pub const TILE: usize = 160;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// What to show, in any words; without, everything that the conditions leave
    #[arg(value_name = "WORDS")]
    words: Vec<String>,
    #[command(flatten)]
    choice: Choice,
    /// The picture to write
    #[arg(long, value_name = "FILE.png")]
    out: PathBuf,
    /// Side of each picture, px
    #[arg(long, default_value_t = TILE as u32, value_name = "PX", value_parser = clap::value_parser!(u32).range(16..=1024))]
    px: u32,
    /// Pictures in a row; otherwise about as many as rows
    #[arg(long, value_name = "N")]
    columns: Option<usize>,
    /// Most assets to show
    #[arg(long, default_value_t = 200, value_name = "N")]
    limit: usize,
    /// Show objects of the library in each of their sizes
    #[arg(long)]
    all_sizes: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let world = World::load(&self.registry)?;
        let searcher = world.searcher(&self.registry.store)?;
        let query = SearchQuery {
            text: self.words.join(" "),
            filters: self.choice.filters()?,
            limit: self.limit,
            one_per_object: !self.all_sizes,
            ..SearchQuery::default()
        };
        let found = searcher.search(&query)?;
        let ids: Vec<String> = found.into_iter().map(|f| f.annotation.asset_id).collect();
        draw(&world, searcher.shelf(), &ids, &self.out, self.px as usize, self.columns)
    }
}

/// Draws assets on a sheet, in rows; prints which is where on standard error.
///
/// # Errors
/// `Input` without any asset; `Assets`; `Write`; `Interrupted`.
pub fn draw(
    world: &World,
    shelf: &Shelf<'_>,
    ids: &[String],
    path: &Path,
    px: usize,
    columns: Option<usize>,
) -> Result<(), Error> {
    if ids.is_empty() {
        return Err(Error::Input("nothing fits, so there is nothing to draw".into()));
    }
    let progress = Progress::of(1);
    let mut tiles = Vec::with_capacity(ids.len());
    for (i, id) in ids.iter().enumerate() {
        interrupt::check()?;
        progress.doing(&format!("drawing {} of {}: {id}", i + 1, ids.len()));
        tiles.push(picture::thumbnail(&world.model(shelf, id)?, px));
    }
    progress.finish();
    let columns = columns.unwrap_or_else(|| (ids.len() as f64).sqrt().ceil() as usize).max(1);
    write_picture(path, &picture::sheet(&tiles, columns, 8))?;
    eprintln!("{}: {} assets, {columns} in a row", path.display(), ids.len());
    Ok(())
}
