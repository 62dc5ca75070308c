//! Changes of the database of assets.

use std::collections::BTreeSet;

use d3dgen_assets::annotate::camel;
use d3dgen_assets::annotation::{Annotation, Basis};
use d3dgen_assets::database::{Kind, NewAsset, Provenance};
use d3dgen_assets::library::LibraryAsset;
use d3dgen_proto::v1::{AnnotateAssetRequest, GenerateAssetsRequest, RemoveAssetsRequest, RestoreAssetsRequest};
use tonic::Status;

use super::{files, shelf, size};
use crate::convert::{masked, message, part};
use crate::core::Core;
use crate::grpc::{Once, required};
use crate::names;
use crate::status::{self, invalid};

/// What a person may say of an asset; all else is measured.
const FIELDS: [&str; 11] = [
    "name",
    "description",
    "kind",
    "mount",
    "front.axis",
    "object_id",
    "room_types",
    "domain_ids",
    "tags",
    "affordances",
    "materials",
];
/// Variants of one call at most.
const VARIANTS: u32 = 100;

/// Returns the provenance of a change, and whether an attempt that was cut short has made it.
fn begin(core: &Core, once: &Once, who: &str, why: &str) -> Result<(Provenance, Option<Vec<String>>), Status> {
    let (at_ms, again) = once.intend(core)?;
    let by = Provenance { who: who.to_owned(), when: crate::clock::text(at_ms), why: why.to_owned() };
    if !again {
        return Ok((by, None));
    }
    let history = core.databases.assets.history().map_err(status::assets)?;
    let made = history.into_iter().rev().find(|c| c.provenance == by).map(|c| c.assets);
    Ok((by, made))
}

pub(super) fn annotate(core: &Core, who: &str, asked: AnnotateAssetRequest, once: &Once) -> Result<Annotation, Status> {
    let given = required("asset", asked.asset)?;
    names::reference("asset.asset_id", &given.asset_id)?;
    let was = core.databases.assets.get(&given.asset_id).map_err(status::assets)?;
    let was = was.ok_or_else(|| {
        Status::not_found(format!(
            "{} is not kept in the database; only ingested and generated assets are annotated",
            given.asset_id
        ))
    })?;
    let paths = asked.update_mask.clone().unwrap_or_default().paths;
    let base: d3dgen_proto::v1::AssetAnnotation = message(&was);
    if let Some(path) = paths.iter().find(|p| !FIELDS.contains(&p.as_str())) {
        return Err(invalid("update_mask", format!("`{path}` cannot be changed; {} can", FIELDS.join(", "))));
    }
    let changed = masked("", base, &given, asked.update_mask, &[])?;
    let mut changed: Annotation = part("asset", &changed)?;
    for path in &paths {
        let field = match path.as_str() {
            "front.axis" => {
                changed.front.found_by = "a person".into();
                "front"
            }
            "object_id" => "object",
            "domain_ids" => "domains",
            other => other,
        };
        changed.basis.insert(field.to_owned(), Basis::Given);
    }
    let (by, made) = begin(core, once, who, &asked.why)?;
    if made.is_none() {
        core.databases.assets.annotate(changed.clone(), &by).map_err(status::assets)?;
    }
    core.changed_assets(std::slice::from_ref(&changed.asset_id))?;
    Ok(changed)
}

pub(super) fn generate(
    core: &Core,
    who: &str,
    asked: &GenerateAssetsRequest,
    once: &Once,
) -> Result<Vec<Annotation>, Status> {
    if asked.count > VARIANTS {
        return Err(invalid("count", format!("is {}, at most {VARIANTS}", asked.count)));
    }
    let now = core.domains.now();
    let object = now.catalog.object(&asked.object_id);
    let object = object.ok_or_else(|| invalid("object_id", "no domain has such an object"))?;
    let domain = match &asked.domain_id {
        Some(domain) if object.domains.contains(domain) => domain.as_str(),
        Some(_) => {
            return Err(invalid("domain_id", format!("has no such object; {} have", object.domains.join(", "))));
        }
        None => object.domains.first().map_or("", String::as_str),
    };
    let asset = LibraryAsset { object, domain, size: 0 };
    let extents = asked.size_m.map_or(Ok(asset.size_m()), |s| size("size_m", s))?;
    let (by, made) = begin(core, once, who, &format!("{} generated", asked.object_id))?;
    let ids = match made {
        Some(ids) => ids,
        None => {
            let mut assets = Vec::new();
            for seed in asked.seed..asked.seed.saturating_add(u64::from(asked.count.max(1))) {
                let mut model = files::generate(&now, domain, &asked.object_id, extents, seed)?;
                model.name = format!("{}_v{seed}", camel(&asked.object_id));
                let a = asset.annotation_of(&now.catalog, &model, extents, seed);
                assets.push(NewAsset::new(a, Some(model), Default::default()));
            }
            core.databases.assets.put(Kind::Generate, assets, &by).map_err(status::assets)?
        }
    };
    core.changed_assets(&ids)?;
    let get = |id: &String| core.databases.assets.get(id).transpose();
    ids.iter().filter_map(get).collect::<Result<_, _>>().map_err(status::assets)
}

pub(super) fn remove(core: &Core, who: &str, asked: RemoveAssetsRequest, once: &Once) -> Result<Vec<String>, Status> {
    if asked.asset_ids.is_empty() {
        return Err(invalid("asset_ids", "is empty: name an asset"));
    }
    let (by, made) = match asked.validate_only {
        true => (Provenance { who: who.into(), when: core.clock.text(), why: asked.why.clone() }, None),
        false => begin(core, once, who, &asked.why)?,
    };
    let mut changed = made.clone().unwrap_or_default();
    if made.is_none() {
        let now = core.domains.now();
        let shelf = shelf(core, &now.catalog)?;
        let (mut own, mut objects) = (BTreeSet::new(), BTreeSet::new());
        for (i, id) in asked.asset_ids.iter().enumerate() {
            names::reference(&format!("asset_ids[{i}]"), id)?;
            let is_own = core.databases.assets.get(id).map_err(status::assets)?.is_some();
            match shelf.of_library(id).filter(|_| !is_own) {
                Some(asset) => drop(objects.insert(asset.object.object_id.clone())),
                None => {
                    shelf.get(id).map_err(status::assets)?;
                    own.insert(id.clone());
                }
            }
        }
        if !asked.validate_only {
            let (own, objects): (Vec<_>, Vec<_>) = (own.into_iter().collect(), objects.into_iter().collect());
            core.databases.assets.remove(&own, &objects, &by).map_err(status::assets)?;
            changed = [own, objects].concat();
        }
    }
    if !asked.validate_only {
        core.changed_assets(&changed)?;
    }
    Ok(asked.asset_ids)
}

pub(super) fn restore(core: &Core, who: &str, asked: RestoreAssetsRequest, once: &Once) -> Result<Vec<String>, Status> {
    let removed = core.databases.assets.removed().map_err(status::assets)?;
    let (by, made) = begin(core, once, who, "objects of the library brought back")?;
    if let Some(made) = made {
        return Ok(made);
    }
    if let Some(unknown) = asked.object_ids.iter().find(|id| !removed.contains_key(*id)) {
        return Err(invalid(
            "object_ids",
            format!("{:?} is not removed", unknown.chars().take(60).collect::<String>()),
        ));
    }
    let objects: Vec<String> =
        if asked.object_ids.is_empty() { removed.into_keys().collect() } else { asked.object_ids };
    if !objects.is_empty() {
        core.databases.assets.restore(&objects, &by).map_err(status::assets)?;
        core.changed_assets(&objects)?;
    }
    Ok(objects)
}
