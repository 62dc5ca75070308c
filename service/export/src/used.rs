//! Which distinct models a world has: one folder each, shared by all exporters.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use d3dgen_mesh::{Library, Model3d, generate};
use d3dgen_model::domain::{Domain, Mount, ObjectType, Shape, Stock};
use d3dgen_model::placements::Placement;
use d3dgen_model::seed::Stream;
use d3dgen_model::world::World;

use crate::error::Error;
use crate::file::File;
use crate::models::{self, KeptModels, ModelRequest};

/// Variants that the models of an object come in; the first is the one that its build shows first.
const VARIANTS: usize = 3;

/// Size in whole millimeters: what tells two models of one asset apart.
type SizeMm = [i64; 3];

/// The distinct models of a world.
pub(crate) struct UsedModels {
    /// Asset reference, size and seed of its variant -> model.
    by_asset: BTreeMap<(String, SizeMm, u64), Model>,
    seeds: Seeds,
}

/// Room and asset -> seed of the variant: a set of chairs is alike, those of the next room need not be.
struct Seeds(BTreeMap<(String, String), u64>);

struct Model {
    /// `Hospital`.
    domain: String,
    /// `Patient_Bed`, with the size behind it when the world has the asset in several sizes, and the variant if not the first.
    name: String,
    /// Object id of the catalog.
    object: String,
    size_m: [f64; 3],
    mount: Mount,
    /// Seed of its variant.
    seed: u64,
}

impl UsedModels {
    /// Returns the models that a world uses.
    ///
    /// # Errors
    /// `Unsupported` when an asset reference is not of the form `Domain/Name`; `Kept` when the database cannot give a model.
    pub fn of(world: &World, domain: &Domain, kept: &dyn KeptModels) -> Result<Self, Error> {
        let placements = &world.placements.placements;
        let seeds = Seeds::of(world, domain, kept)?;
        let mut sizes: BTreeMap<&str, BTreeSet<SizeMm>> = BTreeMap::new();
        for p in placements {
            sizes.entry(&p.asset).or_default().insert(size_mm(p));
        }
        let mut by_asset = BTreeMap::new();
        for p in placements {
            let (domain, base) = split(p)?;
            let (size, seed) = (size_mm(p), seeds.of_placement(p));
            let mut name = match sizes.get(p.asset.as_str()) {
                Some(all) if all.len() > 1 => format!("{base}_{}x{}x{}", size[0], size[1], size[2]),
                _ => base.to_owned(),
            };
            if seed > 0 {
                name.push_str(&format!("_v{seed}"));
            }
            by_asset.entry((p.asset.clone(), size, seed)).or_insert_with(|| Model {
                domain: domain.to_owned(),
                name,
                object: p.object.clone(),
                size_m: p.size_m,
                mount: p.mount,
                seed,
            });
        }
        Ok(Self { by_asset, seeds })
    }

    /// Returns the `model:` value of a placement.
    ///
    /// # Errors
    /// `Unsupported` when the placement is not of the world these models were made for.
    pub fn reference(&self, p: &Placement) -> Result<String, Error> {
        self.by_asset
            .get(&(p.asset.clone(), size_mm(p), self.seeds.of_placement(p)))
            .map(|m| format!("{}/{}", m.domain, m.name))
            .ok_or_else(|| unsupported(p, "has no model among the world's assets"))
    }

    /// Returns the files of every model under `root`.
    ///
    /// # Errors
    /// `Model` when a build of the domain cannot be made, `Kept` when the database cannot give a model.
    pub fn files(&self, root: &str, domain: &Domain, kept: &dyn KeptModels) -> Result<Vec<File>, Error> {
        let library = own_library(domain);
        let mut files = Vec::new();
        for ((asset, ..), model) in &self.by_asset {
            let own = match kept.model(asset)? {
                Some(kept) => models::kept_files(&model.domain, &model.name, kept)?,
                None => model.files(library.as_ref(), domain)?,
            };
            files.extend(own.into_iter().map(|f| File { path: format!("{root}/{}", f.path), ..f }));
        }
        Ok(files)
    }
}

/// A model of a world.
pub(crate) struct Made {
    /// Reference `Domain/Name`, with the size where the world has the asset in several.
    pub reference: String,
    /// Object id of the catalog.
    pub object: String,
    pub model: Arc<Model3d>,
    /// It is of the database, and its licence is that of its source.
    pub is_kept: bool,
}

impl UsedModels {
    /// Returns the models themselves, by reference.
    ///
    /// # Errors
    /// As [`UsedModels::files`].
    pub fn made(&self, domain: &Domain, kept: &dyn KeptModels) -> Result<Vec<Made>, Error> {
        let library = own_library(domain);
        let one = |((asset, ..), model): (&(String, SizeMm, u64), &Model)| {
            let reference = format!("{}/{}", model.domain, model.name);
            let kept = kept.model(asset)?;
            let is_kept = kept.is_some();
            let made = match kept {
                Some(kept) => Arc::new(kept.model),
                None => model.made(library.as_ref(), domain)?,
            };
            Ok(Made { reference, object: model.object.clone(), model: made, is_kept })
        };
        self.by_asset.iter().map(one).collect()
    }
}

impl Seeds {
    /// Returns the variants of a world: those of objects whose builds have several, and nothing stands on; what stands on a
    /// table was put there for the table that the build shows first.
    fn of(world: &World, domain: &Domain, kept: &dyn KeptModels) -> Result<Self, Error> {
        let placements = &world.placements.placements;
        let own = own_library(domain);
        let library = own.as_ref().unwrap_or(Library::shipped());
        let bears: BTreeSet<&str> = placements.iter().filter_map(|p| p.support.as_deref()).collect();
        let mut varies: BTreeMap<&str, bool> = BTreeMap::new();
        let mut seeds = BTreeMap::new();
        for p in placements {
            let varies = match varies.get(p.asset.as_str()) {
                Some(known) => *known,
                None => {
                    let build = domain.object(&p.object).and_then(|object| library.of(object).ok());
                    let found = build.is_some_and(|b| !b.choices.is_empty()) && kept.model(&p.asset)?.is_none();
                    varies.insert(&p.asset, found);
                    found
                }
            };
            let label = format!("variants/{}/{}", p.room_id, p.asset);
            let drawn = || if varies { Stream::new(world.placements.seed, &label).below(VARIANTS) as u64 } else { 0 };
            let seed = seeds.entry((p.room_id.clone(), p.asset.clone())).or_insert_with(drawn);
            if bears.contains(p.placement_id.as_str()) {
                *seed = 0;
            }
        }
        Ok(Self(seeds))
    }

    fn of_placement(&self, p: &Placement) -> u64 {
        self.0.get(&(p.room_id.clone(), p.asset.clone())).copied().unwrap_or(0)
    }
}

/// Returns the builds of a domain beside the shipped ones; none where it has none of its own.
fn own_library(domain: &Domain) -> Option<Library> {
    (!domain.builds.is_empty()).then(|| Library::shipped().with(&domain.builds))
}

impl Model {
    fn made(&self, own: Option<&Library>, domain: &Domain) -> Result<Arc<Model3d>, Error> {
        let object = self.object_type(domain);
        let request = self.request(&object);
        match own {
            Some(library) => Ok(Arc::new(generate(library, &object, self.size_m, self.seed)?)),
            None => models::remembered_model(&request),
        }
    }

    fn files(&self, own: Option<&Library>, domain: &Domain) -> Result<Vec<File>, Error> {
        let object = self.object_type(domain);
        let request = self.request(&object);
        match own {
            Some(library) => models::files(library, &request),
            None => Ok(models::remembered_files(&request)?.to_vec()),
        }
    }

    fn request<'a>(&'a self, object: &'a ObjectType) -> ModelRequest<'a> {
        let Self { domain, name, size_m, mount, seed, .. } = self;
        ModelRequest { domain, name, object, size_m: *size_m, mount: *mount, seed: *seed }
    }

    fn object_type<'a>(&self, domain: &'a Domain) -> Cow<'a, ObjectType> {
        match domain.object(&self.object) {
            Some(object) => Cow::Borrowed(object),
            None => Cow::Owned(plain(&self.object, self.size_m, self.mount)),
        }
    }
}

/// Returns the object type of a placement whose object the domain does not know: a plain box.
pub(crate) fn plain(id: &str, size_m: [f64; 3], mount: Mount) -> ObjectType {
    ObjectType {
        id: id.to_owned(),
        label: id.to_owned(),
        keywords: BTreeMap::new(),
        sizes_m: vec![size_m],
        mount,
        mount_height_m: None,
        clearance_front_m: 0.0,
        clearance_side_m: 0.0,
        clear_sides: 0,
        elbow_room_m: 0.0,
        free_around_m: 0.0,
        surface: false,
        top_taken: Vec::new(),
        shape: Shape::Box,
        build: None,
        color: String::new(),
        material: String::new(),
        affordances: Vec::new(),
        tags: Vec::new(),
        source: String::new(),
        extra: BTreeMap::new(),
        stock: Stock::default(),
    }
}

fn size_mm(p: &Placement) -> SizeMm {
    p.size_m.map(|v| (v * 1000.0).round() as i64)
}

fn split(p: &Placement) -> Result<(&str, &str), Error> {
    let word = |s: &str, extra: &str| {
        !s.is_empty() && s.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || extra.contains(c))
    };
    match p.asset.split_once('/') {
        // A name of dots only would leave the asset folder.
        Some((domain, name)) if word(domain, "") && word(name, ".-") && !name.starts_with('.') => Ok((domain, name)),
        _ => Err(unsupported(p, &format!("asset `{}` is not of the form Domain/Name", p.asset))),
    }
}

fn unsupported(p: &Placement, reason: &str) -> Error {
    Error::Unsupported { exporter: "arena", subject: p.placement_id.clone(), reason: reason.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::NothingKept;
    use crate::sample;

    #[test]
    fn chairs_of_a_room_are_alike_and_what_bears_things_is_as_its_build_shows_it_first() {
        let (mut world, domain) = (sample::world(), sample::domain());
        let mut seen = BTreeSet::new();
        let assets: BTreeSet<(String, String)> =
            world.placements.placements.iter().map(|p| (p.room_id.clone(), p.asset.clone())).collect();
        for seed in 0..8 {
            world.placements.seed = seed;
            let used = UsedModels::of(&world, &domain, &NothingKept).unwrap();
            for (room, asset) in &assets {
                let all = world.placements.placements.iter().filter(|p| p.room_id == *room && p.asset == *asset);
                let names: BTreeSet<u64> = all.map(|p| used.seeds.of_placement(p)).collect();
                assert_eq!(names.len(), 1, "{asset} in {room}");
                seen.extend(names);
            }
            let bears: BTreeSet<&str> =
                world.placements.placements.iter().filter_map(|p| p.support.as_deref()).collect();
            let bearing = world.placements.placements.iter().filter(|p| bears.contains(p.placement_id.as_str()));
            for p in bearing {
                assert_eq!(used.seeds.of_placement(p), 0, "{}", p.placement_id);
                assert!(!used.reference(p).unwrap().contains("_v"));
            }
        }
        assert_eq!(seen, BTreeSet::from([0, 1, 2]));
    }
}
