//! `d3dgen assets remove`, `restore`, `verify`, `stats` and `history`: looking after the database.

use std::collections::BTreeSet;

use d3dgen_assets::search::SearchQuery;

use super::common::{Choice, World, by, existing, open};
use crate::error::Error;
use crate::input::write_text;
use crate::interrupt;
use crate::progress::Progress;
use crate::registry::RegistryArgs;
use crate::table::table;

/// Arguments of `remove`.
#[derive(clap::Args)]
pub struct RemoveArgs {
    /// Assets to remove; of the shipped library, the object is removed in all its sizes
    #[arg(value_name = "ASSET_ID")]
    asset_ids: Vec<String>,
    #[command(flatten)]
    choice: Choice,
    /// Bring removed objects of the library back instead, by their ids; all without any
    #[arg(long, conflicts_with_all = ["filter", "domain", "kind", "origin"])]
    restore: bool,
    /// Say what would be removed, and remove nothing
    #[arg(long)]
    dry_run: bool,
    /// Why, for the history
    #[arg(long, default_value = "removed by hand", value_name = "SENTENCE")]
    why: String,
    /// Print what is removed as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

/// Arguments of `verify` and `stats`.
#[derive(clap::Args)]
pub struct LookArgs {
    /// Print as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl RemoveArgs {
    pub fn run(self) -> Result<(), Error> {
        let world = World::load(&self.registry)?;
        if self.restore {
            return self.bring_back();
        }
        let filters = self.choice.filters()?;
        if self.asset_ids.is_empty() && filters.is_empty() {
            return Err(Error::Input("name assets to remove, or choose them with --filter or --kind".into()));
        }
        let (mut own, mut objects) = (BTreeSet::new(), BTreeSet::new());
        {
            // Made first, so that removals of the library have where to be remembered.
            drop(open(&self.registry.store)?);
            let mut ids = self.asset_ids.clone();
            if !filters.is_empty() {
                let searcher = world.searcher(&self.registry.store)?;
                let query = SearchQuery { filters, limit: usize::MAX, ..SearchQuery::default() };
                ids.extend(searcher.search(&query)?.into_iter().map(|f| f.annotation.asset_id));
            }
            let shelf = world.shelf(&self.registry.store)?;
            for id in ids {
                let is_own = shelf.database().map(|d| d.get(&id)).transpose()?.flatten().is_some();
                match shelf.of_library(&id).filter(|_| !is_own) {
                    Some(asset) => drop(objects.insert(asset.object.object_id.clone())),
                    None => {
                        shelf.get(&id)?;
                        own.insert(id);
                    }
                }
            }
        }
        let (own, objects): (Vec<String>, Vec<String>) = (own.into_iter().collect(), objects.into_iter().collect());
        let some = !own.is_empty() || !objects.is_empty();
        if some && !self.dry_run {
            open(&self.registry.store)?.remove(&own, &objects, &by(None, &self.why))?;
        }
        if self.json {
            let line = serde_json::json!({ "assets": own, "objects": objects, "dry_run": self.dry_run });
            return write_text(None, &format!("{line}\n"));
        }
        let verb = if self.dry_run { "would be removed" } else { "removed" };
        let mut text = format!("{} kept assets and {} objects of the library {verb}\n", own.len(), objects.len());
        own.iter().chain(&objects).for_each(|id| text += &format!("  {id}\n"));
        write_text(None, &text)
    }

    fn bring_back(&self) -> Result<(), Error> {
        let database = open(&self.registry.store)?;
        let removed = database.removed()?;
        let objects: Vec<String> = match self.asset_ids.is_empty() {
            true => removed.into_keys().collect(),
            false => {
                let unknown = self.asset_ids.iter().find(|id| !removed.contains_key(*id));
                if let Some(id) = unknown {
                    let known: Vec<&str> = removed.keys().map(String::as_str).collect();
                    return Err(Error::Input(format!("`{id}` is not removed; {} are", known.join(", "))));
                }
                self.asset_ids.clone()
            }
        };
        if !self.dry_run && !objects.is_empty() {
            database.restore(&objects, &by(None, &self.why))?;
        }
        write_text(None, &format!("{} objects of the library are back\n", objects.len()))
    }
}

impl LookArgs {
    /// Looks at every record, annotation and file.
    pub fn verify(self) -> Result<(), Error> {
        let Some(database) = existing(&self.registry.store)? else {
            return write_text(None, "there is no database; the library needs none\n");
        };
        interrupt::listen();
        let progress = Progress::of(1);
        let damage =
            database.verify(&mut |done, total| progress.doing(&format!("{done} of {total}")), interrupt::flag());
        progress.finish();
        let damage = damage?;
        if self.json {
            write_text(None, &damage.iter().map(|d| format!("{}\n", serde_json::json!(d))).collect::<String>())?;
        }
        match damage.len() {
            0 if self.json => Ok(()),
            0 => write_text(None, &format!("{} assets, nothing wrong\n", database.stats()?.assets)),
            count => {
                let lines: String = damage.iter().map(|d| format!("\n  {}: {}", d.place, d.reason)).collect();
                Err(Error::Input(format!("{count} things are wrong:{lines}")))
            }
        }
    }

    /// Counts.
    pub fn stats(self) -> Result<(), Error> {
        let world = World::load(&self.registry)?;
        let searcher = world.searcher(&self.registry.store)?;
        let stats = searcher.shelf().database().map(|d| d.stats()).transpose()?.unwrap_or_default();
        let facets = ["origin", "domain", "kind", "mount", "affordance", "material", "color", "articulated"];
        if self.json {
            let values: serde_json::Map<String, serde_json::Value> =
                facets.iter().map(|f| ((*f).to_owned(), serde_json::json!(searcher.values(f)))).collect();
            let line = serde_json::json!({ "database": stats, "findable": searcher.len(), "values": values });
            return write_text(None, &format!("{line}\n"));
        }
        let mut text = format!(
            "{} assets can be found; {} are kept in the database ({} files ingested, {:.1} MiB of models), {} objects of \
             the library are removed, {} changes\n\n",
            searcher.len(),
            stats.assets,
            stats.paths,
            stats.model_bytes as f64 / f64::from(1 << 20),
            stats.removed,
            stats.changes
        );
        let mut rows = Vec::new();
        for facet in facets {
            let mut values: Vec<(String, usize)> = searcher.values(facet).into_iter().collect();
            values.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
            let listed: Vec<String> = values.iter().take(8).map(|(value, count)| format!("{value} {count}")).collect();
            rows.push(vec![facet.to_owned(), values.len().to_string(), listed.join(", ")]);
        }
        text += &table(&["filter", "values", "most common"], &rows);
        write_text(None, &text)
    }
}
