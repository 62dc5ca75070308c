//! `d3dgen assets search` and `list`: assets by what they are for.

use std::path::PathBuf;

use d3dgen_assets::annotation::asa::mount_name;
use d3dgen_assets::search::{Found, SearchQuery};
use d3dgen_store::index::Mode;

use super::common::{Choice, World, json_line, size_text};
use super::sheet;
use crate::error::Error;
use crate::input::write_text;
use crate::registry::RegistryArgs;
use crate::remote::{self, ServerArgs};
use crate::table::table;

/// Arguments of `search`.
#[derive(clap::Args)]
pub struct Args {
    /// What to find, in any words; conditions such as height<1.0 or "under 80 cm wide" may be among them
    #[arg(value_name = "WORDS")]
    words: Vec<String>,
    #[command(flatten)]
    choice: Choice,
    /// Assets most like this one come first, instead of words
    #[arg(long, value_name = "ASSET_ID", conflicts_with = "words")]
    like: Option<String>,
    /// Room type it is for: assets that belong there come first
    #[arg(long, value_name = "ID")]
    room: Option<String>,
    /// Size it should have about, m: 1.6x0.8x0.74
    #[arg(long, value_name = "WxDxH", value_parser = parse_size)]
    size: Option<[f64; 3]>,
    /// Most assets to print
    #[arg(long, default_value_t = 10, value_name = "N")]
    limit: usize,
    /// How to find: by words, by meaning, or both
    #[arg(long, default_value = "hybrid", value_parser = ["hybrid", "text", "vector"])]
    mode: String,
    /// Show objects of the library in each of their sizes
    #[arg(long)]
    all_sizes: bool,
    /// Also draw what is found as a contact sheet
    #[arg(long, value_name = "FILE.png")]
    sheet: Option<PathBuf>,
    /// Print one JSON line for each asset
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
    #[command(flatten)]
    server: ServerArgs,
}

/// Arguments of `list`.
#[derive(clap::Args)]
pub struct ListArgs {
    #[command(flatten)]
    choice: Choice,
    /// Most assets to print
    #[arg(long, default_value_t = 1000, value_name = "N")]
    limit: usize,
    /// List objects of the library in each of their sizes
    #[arg(long)]
    all_sizes: bool,
    /// Print one JSON line for each asset
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let remote = self.server.instead_of(&self.registry)?;
        let mode = match self.mode.as_str() {
            "text" => Mode::Text,
            "vector" => Mode::Vector,
            _ => Mode::Hybrid,
        };
        let query = SearchQuery {
            text: self.words.join(" "),
            filters: self.choice.filters()?,
            room_type: self.room,
            domain: self.choice.domain,
            size_m: self.size,
            limit: self.limit,
            mode,
            one_per_object: !self.all_sizes,
        };
        if let Some(remote) = remote {
            if self.sheet.is_some() {
                return Err(Error::Input(
                    "--sheet and --server: contact sheets are drawn of a database here only".into(),
                ));
            }
            return print(&remote::assets::search(&remote, &query, self.like.as_deref())?, self.json);
        }
        let world = World::load(&self.registry)?;
        let searcher = world.searcher(&self.registry.store)?;
        let found = match &self.like {
            Some(id) => searcher.like(id, &query)?,
            None => searcher.search(&query)?,
        };
        if let Some(path) = &self.sheet {
            let ids: Vec<String> = found.iter().map(|f| f.annotation.asset_id.clone()).collect();
            sheet::draw(&world, searcher.shelf(), &ids, path, sheet::TILE, None)?;
        }
        print(&found, self.json)
    }
}

impl ListArgs {
    pub fn run(self) -> Result<(), Error> {
        let world = World::load(&self.registry)?;
        let searcher = world.searcher(&self.registry.store)?;
        let query = SearchQuery {
            filters: self.choice.filters()?,
            limit: self.limit,
            one_per_object: !self.all_sizes,
            ..SearchQuery::default()
        };
        print(&searcher.search(&query)?, self.json)
    }
}

fn print(found: &[Found], json: bool) -> Result<(), Error> {
    if json {
        return write_text(None, &found.iter().map(|f| format!("{}\n", json_line(f))).collect::<String>());
    }
    if found.is_empty() {
        eprintln!("nothing fits; `assets list` shows what there is, `assets stats` the values of filters");
        return Ok(());
    }
    let rows: Vec<Vec<String>> = found.iter().map(row).collect();
    write_text(None, &table(&["asset", "name", "kind", "size m", "mount", "why"], &rows))
}

fn row(found: &Found) -> Vec<String> {
    let a = &found.annotation;
    vec![
        a.asset_id.clone(),
        a.name.clone(),
        a.kind.clone(),
        size_text(a.size_m),
        mount_name(a.mount).to_owned(),
        found.reasons.iter().take(2).cloned().collect::<Vec<_>>().join("; "),
    ]
}

/// Reads `1.6x0.8x0.74`.
pub fn parse_size(text: &str) -> Result<[f64; 3], String> {
    let figures: Vec<f64> = text.split('x').filter_map(|f| f.trim().parse().ok()).collect();
    match figures[..] {
        [w, d, h] if [w, d, h].iter().all(|v| (0.001..=100.0).contains(v)) => Ok([w, d, h]),
        _ => Err("a size is width x depth x height in m, such as 1.6x0.8x0.74".into()),
    }
}
