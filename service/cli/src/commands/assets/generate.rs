//! `d3dgen assets generate`: models of objects, made and kept.

use d3dgen_assets::annotate::camel;
use d3dgen_assets::database::{Kind, NewAsset};
use d3dgen_assets::library::LibraryAsset;

use super::common::{World, by, open, size_text};
use super::search::parse_size;
use crate::error::Error;
use crate::input::write_text;
use crate::registry::RegistryArgs;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Object to make, as a domain names it: hospital_bed
    #[arg(value_name = "OBJECT")]
    object: String,
    /// Domain that has the object; otherwise the first that does
    #[arg(long, value_name = "ID")]
    domain: Option<String>,
    /// Size, m; otherwise the most common one of the object
    #[arg(long, value_name = "WxDxH", value_parser = parse_size)]
    size: Option<[f64; 3]>,
    /// Seed of its variant
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,
    /// How many variants, with seeds that follow each other
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1000))]
    count: u64,
    /// Print one JSON line for each asset
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let world = World::load(&self.registry)?;
        let object = world.catalog.object(&self.object).ok_or_else(|| {
            Error::Input(format!("no domain has an object `{}`; `assets search` finds by any words", self.object))
        })?;
        let domain = match &self.domain {
            Some(domain) if object.domains.contains(domain) => domain.as_str(),
            Some(domain) => {
                let others = object.domains.join(", ");
                return Err(Error::Input(format!("domain {domain} has no object `{}`; {others} have", self.object)));
            }
            None => object.domains.first().map_or("", String::as_str),
        };
        let asset = LibraryAsset { object, domain, size: 0 };
        let size = self.size.unwrap_or_else(|| asset.size_m());
        let mut assets = Vec::new();
        for seed in self.seed..self.seed.saturating_add(self.count) {
            let mut model = world.generate(domain, &self.object, size, seed)?;
            model.name = format!("{}_v{seed}", camel(&self.object));
            let annotation = asset.annotation_of(&world.catalog, &model, size, seed);
            assets.push(NewAsset::new(annotation, Some(model), Default::default()));
        }
        let database = open(&self.registry.store)?;
        let ids = database.put(Kind::Generate, assets, &by(None, &format!("{} generated", self.object)))?;
        let mut text = String::new();
        for id in ids {
            let a = database.get(&id)?.ok_or_else(|| Error::Input(format!("{id} is not there")))?;
            text += &if self.json {
                format!("{}\n", serde_json::json!({ "asset_id": id, "annotation": a }))
            } else {
                format!("{id}  {} m, {} triangles\n", size_text(a.size_m), a.triangle_count)
            };
        }
        write_text(None, &text)
    }
}
