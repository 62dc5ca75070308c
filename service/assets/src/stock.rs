//! Domains stocked from the database: which assets stand for an object when worlds are furnished, and why.
//!
//! In stages: the same object, then, where the library's own is removed, the same kind for the same use on the same
//! mount; each must be of a size that the object has about in every direction, and those of the domain and its rooms come
//! first. What stands for an object that people in wheelchairs use keeps its figures. Where nothing fits, the object is
//! made. A database without own assets or removals changes nothing.

use std::collections::BTreeMap;

use d3dgen_model::TOLERANCE_M;
use d3dgen_model::domain::{Domain, ObjectType, StockedAsset};

use crate::annotation::Annotation;
use crate::catalog::Catalog;
use crate::database::{Database, Shelf};
use crate::error::Error;
use crate::plausibility::misfit;

/// How far each extent of an asset may be from that of a size of the object, as a share of it.
const SHARE_OFF: f64 = 0.25;
/// The same for objects whose figures must hold, and in m.
const SHARE_OFF_ACCESSIBLE: f64 = 0.05;
const ACCESSIBLE_M: f64 = 0.02;
/// Tag of objects whose figures must hold.
const ACCESSIBLE: &str = "accessible";
/// Assets that stand for one object at most.
const MOST: usize = 4;

/// The assets kept in a database, ready to be chosen from.
pub struct Stock<'c> {
    shelf: Shelf<'c>,
    by_object: BTreeMap<String, Vec<Annotation>>,
    by_kind: BTreeMap<String, Vec<Annotation>>,
}

/// An asset chosen for an object.
struct Choice<'a> {
    asset: &'a Annotation,
    off: f64,
    score: f64,
    reason: String,
}

impl<'c> Stock<'c> {
    /// Reads the assets of a database; none when it changes nothing.
    ///
    /// # Errors
    /// `Store`.
    pub fn read(database: &Database, catalog: &'c Catalog) -> Result<Option<Self>, Error> {
        let shelf = Shelf::new(Some(database.clone()), catalog)?;
        let (mut by_object, mut by_kind) = (BTreeMap::<String, Vec<_>>::new(), BTreeMap::<String, Vec<_>>::new());
        database.each(|a| {
            if let Some(object) = &a.object {
                by_object.entry(object.clone()).or_default().push(a.clone());
            }
            by_kind.entry(a.kind.clone()).or_default().push(a);
            Ok(())
        })?;
        let changes = !by_kind.is_empty() || catalog.objects().iter().any(|o| shelf.is_removed(&o.object_id));
        Ok(changes.then_some(Self { shelf, by_object, by_kind }))
    }

    /// Returns a domain with the sizes of the assets that stand for its objects, and which they are; none when nothing
    /// is other than the library has it.
    pub fn stocked(&self, domain: &Domain) -> Option<Domain> {
        let mut stocked = domain.clone();
        let mut changed = false;
        for object in &mut stocked.objects {
            let removed = self.shelf.is_removed(&object.id);
            let mut choices = self.of_object(object, &domain.id);
            if choices.is_empty() && removed {
                choices = self.of_kind(object, &domain.id);
            }
            if choices.is_empty() && !removed {
                continue;
            }
            changed = true;
            if choices.is_empty() {
                let why = "the library's own is removed and no asset of the database fits".to_owned();
                object.stock.made_because = Some(why);
                continue;
            }
            let mut sizes: Vec<[f64; 3]> = Vec::new();
            for choice in choices {
                let size = choice.asset.width_depth_height().map(|v| (v * 1000.0).round().max(1.0) / 1000.0);
                if !sizes.contains(&size) {
                    sizes.push(size);
                    let asset = choice.asset.asset_id.clone();
                    object.stock.assets.push(StockedAsset { size_m: size, asset, reason: choice.reason });
                }
            }
            if !removed {
                sizes.extend(object.sizes_m.clone());
            }
            object.sizes_m = sizes;
        }
        changed.then_some(stocked)
    }

    fn of_object(&self, object: &ObjectType, domain: &str) -> Vec<Choice<'_>> {
        let all = self.by_object.get(&object.id).map(Vec::as_slice).unwrap_or_default();
        choose(all, object, domain, "the same object")
    }

    fn of_kind(&self, object: &ObjectType, domain: &str) -> Vec<Choice<'_>> {
        let Some(known) = self.shelf.catalog().object(&object.id) else { return Vec::new() };
        let all = self.by_kind.get(&known.kind).map(Vec::as_slice).unwrap_or_default();
        let same_use = |a: &Annotation| match known.affordances.first() {
            Some(first) => a.affordances.contains(first),
            None => true,
        };
        let fitting: Vec<Choice<'_>> = choose(all, object, domain, "of the same kind and use");
        fitting.into_iter().filter(|c| same_use(c.asset)).collect()
    }
}

/// Tells whether an asset of a size may stand for an object of another: `[width, depth, height]`, m.
fn stands_for(size: [f64; 3], wanted: [f64; 3], is_accessible: bool) -> bool {
    let most = |wanted: f64| match is_accessible {
        true => (SHARE_OFF_ACCESSIBLE * wanted).min(ACCESSIBLE_M),
        false => SHARE_OFF * wanted,
    };
    size.iter().zip(wanted).all(|(is, wanted)| (is - wanted).abs() <= most(wanted) + TOLERANCE_M)
}

/// Returns the assets of a size that fits, the best first.
fn choose<'a>(all: &'a [Annotation], object: &ObjectType, domain: &str, what: &str) -> Vec<Choice<'a>> {
    let mut choices: Vec<Choice<'a>> = Vec::new();
    let is_accessible = object.tags.iter().any(|t| t == ACCESSIBLE);
    for asset in all.iter().filter(|a| a.mount == object.mount) {
        let size = asset.width_depth_height();
        let alike = object.sizes_m.iter().filter(|s| stands_for(size, **s, is_accessible));
        let Some(off) = alike.map(|s| misfit(size, *s)).reduce(f64::min) else { continue };
        let of_domain = asset.domains.iter().any(|d| d == domain);
        let place = if of_domain { format!(", of domain {domain}") } else { String::new() };
        let reason = format!("{what}{place}, size {:.0} % off", (off.exp() - 1.0) * 100.0);
        choices.push(Choice { asset, off, score: if of_domain { 0.3 } else { 0.0 } - off, reason });
    }
    choices.sort_by(|a, b| {
        let order = b.score.total_cmp(&a.score).then(a.off.total_cmp(&b.off));
        order.then_with(|| a.asset.asset_id.cmp(&b.asset.asset_id))
    });
    choices.truncate(MOST);
    choices
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::annotation::Origin;
    use crate::database::{Kind, NewAsset, Provenance};
    use crate::library::Library;
    use crate::sample;

    fn asset(object: &str, id: &str, size: [f64; 3]) -> NewAsset {
        let catalog = sample::catalog();
        let found = Library::new(catalog).assets().find(|a| a.object.object_id == object).expect("shipped");
        let mut annotation = found.annotation(catalog);
        let [x, y, z] = size;
        annotation.asset_id = id.into();
        annotation.size_m = size;
        annotation.bounding_box_m = [[-x / 2.0, x / 2.0], [-y / 2.0, y / 2.0], [0.0, z]];
        annotation.origin = Origin::Ingested { path: id.into(), hash: id.into() };
        NewAsset::new(annotation, None, BTreeMap::new())
    }

    #[test]
    fn a_stand_in_is_within_a_quarter_in_each_direction() {
        let wanted = [1.6, 0.8, 0.74];
        for (size, fits) in [
            ([1.6, 0.8, 0.74], true),
            ([1.95, 0.65, 0.9], true),
            ([1.6, 0.8, 0.5], false),
            ([2.1, 0.8, 0.74], false),
            ([1.6, 0.55, 0.74], false),
        ] {
            assert_eq!(stands_for(size, wanted, false), fits, "{size:?}");
        }
        let wc = [0.4, 0.75, 0.48];
        assert!(stands_for([0.39, 0.74, 0.47], wc, true) && !stands_for([0.4, 0.75, 0.44], wc, true));
        let tagged = |id: &str| id.starts_with("accessible_");
        for domain in sample::domains() {
            for object in domain.objects.iter().filter(|o| tagged(&o.id)) {
                assert!(object.tags.iter().any(|t| t == ACCESSIBLE), "{} {}", domain.id, object.id);
            }
        }
    }

    #[test]
    fn own_assets_stand_for_objects_and_removed_ones_are_replaced() {
        let dir = tempfile::tempdir().expect("a folder");
        let database = Database::open_or_create(&dir.path().join("store"), &d3dgen_store::Options::default());
        let database = database.expect("a store");
        let by = Provenance { who: "t".into(), when: "2026-11-21T00:00:00Z".into(), why: "test".into() };
        let catalog = sample::catalog();
        assert!(Stock::read(&database, catalog).expect("readable").is_none());
        let office = sample::domains().iter().find(|d| d.id == "office").expect("shipped");
        let own = vec![
            asset("dining_chair", "Own/Chair", [0.45, 0.5, 0.87]),
            asset("desk", "Own/Desk", [1.7, 0.82, 0.73]),
            asset("desk", "Own/TinyDesk", [0.1, 0.1, 0.1]),
            // As large as the room for it allows, and not of the height that its users need.
            asset("accessible_wc", "Own/LowWc", [0.4, 0.72, 0.42]),
            asset("accessible_wc", "Own/TinyWc", [0.31, 0.48, 0.45]),
        ];
        database.put(Kind::Ingest, own, &by).expect("stored");
        let stock = Stock::read(&database, catalog).expect("readable").expect("it changes things");
        let stocked = stock.stocked(office).expect("changed");
        let object = |id: &str| stocked.objects.iter().find(|o| o.id == id).expect("there");
        assert_eq!(object("desk").sizes_m[0], [1.7, 0.82, 0.73]);
        let first = |id: &str| object(id).stock.assets[0].clone();
        assert!(first("desk").asset == "Own/Desk" && first("desk").reason.starts_with("the same object"));
        assert!(!object("desk").sizes_m.contains(&[0.1, 0.1, 0.1]));
        let wc = |stocked: &Domain| stocked.objects.iter().find(|o| o.id == "accessible_wc").cloned();
        assert_eq!(wc(&stocked), wc(office), "an accessible WC keeps its figures");
        let before = office.objects.iter().find(|o| o.id == "cafe_chair").expect("there");
        assert_eq!(object("cafe_chair"), before);
        database.remove(&[], &["cafe_chair".into(), "whiteboard".into()], &by).expect("removed");
        let stock = Stock::read(&database, catalog).expect("readable").expect("it changes things");
        let stocked = stock.stocked(office).expect("changed");
        let object = |id: &str| stocked.objects.iter().find(|o| o.id == id).expect("there");
        assert_eq!(object("cafe_chair").sizes_m, [[0.45, 0.5, 0.87]]);
        assert!(object("cafe_chair").stock.assets[0].reason.contains("same kind and use"));
        assert!(object("whiteboard").stock.made_because.is_some());
    }
}
