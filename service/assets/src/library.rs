//! The library that is shipped with the program: every object of the domains in every size is an asset that is made when
//! it is needed. It is found like any other asset, with no database at all.

use std::collections::BTreeMap;

use d3dgen_mesh::Model3d;
use d3dgen_model::domain::Mount;

use crate::annotate::{camel, color, description, joint_notes, significant};
use crate::annotation::{Annotation, Basis, Front, FrontAxis, Mass, Origin, Swatch};
use crate::catalog::{Catalog, CatalogObject, ModelFacts, kind_density};

/// The assets that the catalog stands for.
#[derive(Debug, Clone)]
pub struct Library<'c> {
    catalog: &'c Catalog,
}

/// One asset of the library: an object in one of its sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LibraryAsset<'c> {
    /// What it is.
    pub object: &'c CatalogObject,
    /// Domain under which it is named.
    pub domain: &'c str,
    /// Which of its sizes.
    pub size: usize,
}

impl<'c> Library<'c> {
    /// Returns the library of a catalog.
    pub fn new(catalog: &'c Catalog) -> Self {
        Self { catalog }
    }

    /// Returns the catalog it is made of.
    pub fn catalog(&self) -> &'c Catalog {
        self.catalog
    }

    /// Returns each object in each size once, under the first domain that has it.
    pub fn assets(&self) -> impl Iterator<Item = LibraryAsset<'c>> + use<'c> {
        self.catalog.objects().iter().flat_map(Self::sizes_of)
    }

    /// Returns an object in each of its sizes, under the first domain that has it.
    pub fn sizes_of(object: &'c CatalogObject) -> impl Iterator<Item = LibraryAsset<'c>> + use<'c> {
        let domain = object.domains.first().map_or("common", String::as_str);
        (0..object.sizes_m.len()).map(move |size| LibraryAsset { object, domain, size })
    }

    /// Returns the asset of a reference as worlds write it, with or without a size: `Hospital/HospitalBed`,
    /// `Hospital/HospitalBed_1000x2200x850`.
    pub fn get(&self, asset_id: &str) -> Option<LibraryAsset<'c>> {
        let (domain, name) = asset_id.split_once('/')?;
        self.catalog.objects().iter().find_map(|object| {
            let rest = name.strip_prefix(&camel(&object.object_id))?;
            let domain = object.domains.iter().find(|d| camel(d) == domain)?;
            let sized = |size: &usize| LibraryAsset { object, domain, size: *size }.suffix() == rest;
            let size = if rest.is_empty() { 0 } else { (0..object.sizes_m.len()).find(sized)? };
            Some(LibraryAsset { object, domain, size })
        })
    }
}

impl LibraryAsset<'_> {
    /// Returns its reference: the plain one for the most common size.
    pub fn asset_id(&self) -> String {
        let suffix = if self.size == 0 { String::new() } else { self.suffix() };
        format!("{}/{}{suffix}", camel(self.domain), camel(&self.object.object_id))
    }

    /// Returns extents in the model frame, m.
    pub fn size_m(&self) -> [f64; 3] {
        self.object.sizes_m.get(self.size).copied().unwrap_or([1.0; 3])
    }

    fn suffix(&self) -> String {
        let [w, d, h] = self.size_m().map(|v| (v * 1000.0).round() as i64);
        format!("_{w}x{d}x{h}")
    }

    /// Returns what is known of it: what the object says, and of its model what the model says.
    pub fn annotation(&self, catalog: &Catalog) -> Annotation {
        let facts = catalog.makers().facts(self.domain, &self.object.object_id, self.size_m());
        self.described(catalog, self.size_m(), facts.as_deref())
    }

    /// Returns what is known of a model of the object that was made with a seed, in any size.
    pub fn annotation_of(&self, catalog: &Catalog, model: &Model3d, size_m: [f64; 3], seed: u64) -> Annotation {
        let mut annotation = self.described(catalog, size_m, Some(&ModelFacts::of(model)));
        annotation.asset_id = format!("{}/{}", camel(self.domain), model.name);
        let (domain, object) = (self.domain.to_owned(), self.object.object_id.clone());
        annotation.origin = Origin::Generated { domain, object, seed };
        annotation
    }

    /// `facts` are none for an object whose model cannot be made: its mass is then guessed.
    fn described(&self, catalog: &Catalog, size_m: [f64; 3], facts: Option<&ModelFacts>) -> Annotation {
        let (object, [w, d, h]) = (self.object, size_m);
        let (hw, hd) = (w / 2.0, d / 2.0);
        let box_m3 = w.max(0.01) * d.max(0.01) * h.max(0.01);
        let mass = match facts {
            Some(ModelFacts { inertia, .. }) => {
                let t = inertia.tensor;
                Mass {
                    mass_kg: inertia.mass_kg,
                    center_m: inertia.center_m.map(|v| (v * 1e6).round() / 1e6 + 0.0),
                    inertia_kg_m2: [t[0][0], t[1][1], t[2][2], t[0][1], t[0][2], t[1][2]].map(significant),
                    density_kg_m3: significant(inertia.mass_kg / box_m3),
                }
            }
            None => {
                let mass_kg = (box_m3 * kind_density(&object.kind)).max(0.01);
                let moment = |a: f64, b: f64| mass_kg * (a * a + b * b) / 12.0;
                Mass {
                    mass_kg: significant(mass_kg),
                    center_m: [0.0, 0.0, h / 2.0],
                    inertia_kg_m2: [moment(d, h), moment(w, h), moment(w, d), 0.0, 0.0, 0.0].map(significant),
                    density_kg_m3: kind_density(&object.kind),
                }
            }
        };
        let basis = ["size_m", "object", "kind", "mount", "front", "affordances", "materials", "room_types"];
        let mut basis: BTreeMap<String, Basis> = basis.map(|f| (f.to_owned(), Basis::Given)).into();
        basis.extend(["description", "palette"].map(|f| (f.to_owned(), Basis::Guessed)));
        basis.insert("mass".into(), if facts.is_some() { Basis::Given } else { Basis::Guessed });
        let mut annotation = Annotation {
            version: 1,
            asset_id: self.asset_id(),
            name: object.label.clone(),
            description: String::new(),
            bounding_box_m: [[-hw, hw], [-hd, hd], [0.0, h]],
            size_m: [w, d, h],
            front: Front { axis: FrontAxis::MinusY, found_by: "models made here have it there".into() },
            mount: object.mount,
            mount_height_m: object.mount_height_m.filter(|_| object.mount != Mount::Floor),
            kind: object.kind.clone(),
            object: Some(object.object_id.clone()),
            domains: object.domains.clone(),
            room_types: object.room_types.clone(),
            tags: object.tags.clone(),
            materials: vec![object.material.clone()],
            palette: swatch(&object.color).into_iter().collect(),
            affordances: object.affordances.clone(),
            footprint_m: vec![[-hw, -hd], [hw, -hd], [hw, hd], [-hw, hd]],
            triangle_count: facts.map_or(0, |f| f.triangle_count),
            mass: Some(mass),
            joints: joint_notes(facts.map_or(&[], |f| &f.joints)),
            thumbnail: None,
            origin: Origin::Library { domain: self.domain.to_owned(), object: object.object_id.clone() },
            model_from_file: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
            basis,
            changes: Vec::new(),
        };
        annotation.description = description(&annotation, Some(object), None, catalog);
        annotation
    }
}

/// Returns the color of `#rrggbb` with its name.
fn swatch(hex: &str) -> Option<Swatch> {
    let digits = hex.strip_prefix('#').filter(|d| d.len() == 6)?;
    let value = u32::from_str_radix(digits, 16).ok()?;
    let rgb = [16, 8, 0].map(|shift| f64::from((value >> shift) & 0xff) / 255.0);
    Some(Swatch { name: color::name(rgb, 1.0).to_owned(), hex: hex.to_lowercase(), share: 1.0 })
}

#[cfg(test)]
mod tests {
    use d3dgen_model::Document;

    use super::*;
    use crate::sample;

    #[test]
    fn what_is_told_of_a_model_is_what_the_model_says() {
        let catalog = sample::catalog();
        let library = d3dgen_mesh::Library::shipped();
        let mut articulated = 0;
        for asset in Library::new(catalog).assets().filter(|a| a.size == 0) {
            let told = asset.annotation(catalog);
            let domain = sample::domains().iter().find(|d| d.id == asset.domain).expect("of a domain");
            let object = domain.objects.iter().find(|o| o.id == asset.object.object_id).expect("its object");
            let own = library.with(&domain.builds);
            let model = d3dgen_mesh::generate(&own, object, asset.size_m(), 0).expect("it is made");
            assert_eq!(told.triangle_count, model.triangle_count() as u64, "{}", told.asset_id);
            let mass: f64 = model.bodies.iter().map(|b| b.mass_kg).sum();
            let said = told.mass.as_ref().map_or(0.0, |m| m.mass_kg);
            assert!((said - mass).abs() <= 0.01 * mass, "{}: {said} kg, its bodies {mass} kg", told.asset_id);
            assert_eq!(told.joints.len(), model.joints.len(), "{}", told.asset_id);
            articulated += usize::from(told.is_articulated());
        }
        assert!(articulated > 50, "{articulated} of the library have joints");
    }

    #[test]
    fn every_size_of_every_object_is_an_asset() {
        let catalog = sample::catalog();
        let library = Library::new(catalog);
        let mut ids = std::collections::BTreeSet::new();
        for asset in library.assets() {
            let annotation = asset.annotation(catalog);
            assert_eq!(annotation.check(), [], "{}", annotation.asset_id);
            assert!(ids.insert(annotation.asset_id.clone()), "{} twice", annotation.asset_id);
            assert_eq!(library.get(&annotation.asset_id), Some(asset));
        }
        assert!(ids.len() > 700, "{}", ids.len());
        let desk = library.get("Hospital/Desk").expect("hospitals have desks");
        assert_eq!((desk.domain, desk.asset_id().as_str()), ("hospital", "Hospital/Desk"));
        assert_eq!(library.get("Hospital/Nothing"), None);
        assert_eq!(library.get("Desk"), None);
        assert_eq!(library.get("Office/Desk_1x1x1"), None);
    }
}
