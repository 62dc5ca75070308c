//! A folder for every distinct model in a world: ASA annotation, SDF and USD.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Domain, Mount, ObjectType, Shape};
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;
use serde_json::{Value, json};

use super::{sdf, usda};
use crate::color::Rgb;
use crate::exporters::File;
use crate::shapes::{self, Part};
use crate::{Error, yaml};

/// Size in whole millimeters: what tells two models of one asset apart.
type SizeMm = [i64; 3];

/// The distinct models of a world.
pub(super) struct Models {
    /// Asset reference and size -> model.
    by_asset: BTreeMap<(String, SizeMm), Model>,
}

struct Model {
    /// `Hospital`.
    domain: String,
    /// `Patient_Bed`, with the size behind it when the world has the asset in several sizes.
    name: String,
    /// Object id of the catalog.
    object: String,
    size_m: [f64; 3],
    mount: Mount,
}

/// What the SDF and USD writers need to know of a model.
pub(super) struct Look<'a> {
    pub name: &'a str,
    pub size_m: [f64; 3],
    pub parts: Vec<Part>,
    pub color: Rgb,
    pub mass_kg: f64,
}

impl Models {
    /// Returns the models that a world uses.
    ///
    /// # Errors
    /// `Unsupported` when an asset reference is not of the form `Domain/Name`.
    pub fn of(world: &World) -> Result<Self, Error> {
        let placements = &world.placements.placements;
        let mut sizes: BTreeMap<&str, BTreeSet<SizeMm>> = BTreeMap::new();
        for p in placements {
            sizes.entry(&p.asset).or_default().insert(size_mm(p));
        }
        let mut by_asset = BTreeMap::new();
        for p in placements {
            let (domain, base) = split(p)?;
            let size = size_mm(p);
            let name = match sizes.get(p.asset.as_str()) {
                Some(all) if all.len() > 1 => format!("{base}_{}x{}x{}", size[0], size[1], size[2]),
                _ => base.to_owned(),
            };
            by_asset.entry((p.asset.clone(), size)).or_insert_with(|| Model {
                domain: domain.to_owned(),
                name,
                object: p.object.clone(),
                size_m: p.size_m,
                mount: p.mount,
            });
        }
        Ok(Self { by_asset })
    }

    /// Returns the `model:` value of a placement.
    ///
    /// # Errors
    /// `Unsupported` when the placement is not of the world these models were made for.
    pub fn reference(&self, p: &Placement) -> Result<String, Error> {
        self.by_asset
            .get(&(p.asset.clone(), size_mm(p)))
            .map(|m| format!("{}/{}", m.domain, m.name))
            .ok_or_else(|| unsupported(p, "has no model among the world's assets"))
    }

    /// Returns the files of every model under `root`.
    pub fn files(&self, root: &str, domain: &Domain) -> Vec<File> {
        self.by_asset.values().flat_map(|m| m.files(root, domain)).collect()
    }
}

impl Model {
    fn files(&self, root: &str, domain: &Domain) -> [File; 3] {
        let object = domain.object(&self.object);
        let parts = shapes::parts(object.map_or(Shape::Box, |o| o.shape), self.size_m);
        let material = object.map_or("", |o| o.material.as_str());
        let look = Look {
            name: &self.name,
            size_m: self.size_m,
            mass_kg: shapes::mass_kg(&parts, material),
            parts,
            color: Rgb::from_css(object.map_or("", |o| o.color.as_str())),
        };
        let folder = format!("{root}/{}/Object/{}", self.domain, self.name);
        [
            File::new(format!("{folder}/annotation.yaml"), yaml::to_string(&self.annotation(object, look.color))),
            File::new(format!("{folder}/{0}.sdf/{0}.sdf", self.name), sdf::model(&look)),
            File::new(format!("{folder}/{}.usda", self.name), usda::stage(&look)),
        ]
    }

    /// Returns the ASA annotation; the model's front is -y.
    fn annotation(&self, object: Option<&ObjectType>, color: Rgb) -> Value {
        let [w, d, h] = self.size_m;
        let round = |v: f64| (v * 1e4).round() / 1e4;
        let mut tags = vec![format!("domain::{}", self.domain.to_lowercase())];
        if let Some(o) = object {
            tags.push(format!("kind::{}", kind(o.shape)));
        }
        tags.push(format!("mount::{}", mount(self.mount)));
        if let Some(o) = object {
            tags.extend(o.affordances.iter().map(|a| format!("hoi::{}", super::snake(a))));
            tags.push(format!("color::{}", color.word()));
            if !o.material.is_empty() {
                tags.push(format!("material::{}", super::snake(&o.material)));
            }
        }
        json!({
            "asa": 1,
            "bounding_box": [[round(-w / 2.0), round(w / 2.0)], [round(-d / 2.0), round(d / 2.0)], [0.0, round(h)]],
            "desc": object.map_or(self.object.as_str(), |o| o.label.as_str()),
            "face": "-y",
            "name": self.name,
            "note": "Simple parametric model",
            "path": format!("Object/{}", self.name),
            "tags": tags,
        })
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

fn mount(mount: Mount) -> &'static str {
    match mount {
        Mount::Floor => "floor",
        Mount::Wall => "wall",
        Mount::Ceiling => "ceiling",
        Mount::Surface => "surface",
    }
}

/// Returns the `kind` of the ASA vocabulary that a build stands for.
fn kind(shape: Shape) -> &'static str {
    match shape {
        Shape::Box | Shape::Cylinder => "container",
        Shape::Cabinet => "cabinet",
        Shape::Shelf | Shape::Rack => "shelf",
        Shape::Table | Shape::RoundTable => "table",
        Shape::Desk => "desk",
        Shape::Chair | Shape::SwivelChair => "chair",
        Shape::Stool => "stool",
        Shape::Sofa => "sofa",
        Shape::Bench => "bench",
        Shape::Bed | Shape::HospitalBed => "bed",
        Shape::Counter => "counter",
        Shape::Sink | Shape::Basin | Shape::Toilet | Shape::Bathtub | Shape::Shower | Shape::Cubicle => "sanitary",
        Shape::Panel | Shape::Rug => "decor",
        Shape::Trolley => "cart",
        Shape::Pole | Shape::Dock | Shape::Vehicle | Shape::Scanner => "equipment",
        Shape::Plant => "plant",
        Shape::Lamp => "lamp",
        Shape::Appliance | Shape::Stove => "appliance",
        Shape::Curtain => "curtain",
    }
}
