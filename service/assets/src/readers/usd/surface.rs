//! Materials: which one a prim wears, what their surfaces say, and the pictures that anything in the scene names.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use d3dgen_mesh::Material;
use openusd::sdf::{Path, Value};
use openusd::usd::{Collection, MembershipQuery, Prim, Stage, TimeCode, is_collection_api_path};

use super::space::Space;
use super::value::{number, three, threes, token_of, value};
use crate::readers::builder::Builder;
use crate::readers::facts::TextureFact;

/// The longest chain of connections.
const MAX_HOPS: usize = 16;
/// The metadata that makes a binding win against those below it.
const STRENGTH: &str = "bindMaterialAs";

/// The bindings of a prim, and those of the prims above it.
pub struct Level {
    above: Option<Rc<Level>>,
    collections: Vec<(Option<MembershipQuery>, Path, bool)>,
    direct: Option<(Path, bool)>,
}

impl Level {
    /// Returns the bindings at a prim, or those above it when it has none.
    pub fn of(stage: &Stage, prim: &Prim, above: &Option<Rc<Self>>) -> Option<Rc<Self>> {
        const RELATION: &str = "material:binding";
        let names = prim.property_names().unwrap_or_default();
        let bindings = || names.iter().map(|n| n.as_str()).filter(|n| n.starts_with(RELATION));
        if bindings().next().is_none() {
            return above.clone();
        }
        let strong = |name: &str| {
            let value = prim.attribute(name).get_metadata::<Value>(STRENGTH).ok().flatten();
            value.as_ref().and_then(super::text).as_deref() == Some("strongerThanDescendants")
        };
        let mut level = Self { above: above.clone(), collections: Vec::new(), direct: None };
        for name in bindings() {
            let targets = || prim.relationship(name).forwarded_targets().unwrap_or_default();
            // Of the bindings only those for all purposes count: they have no purpose in their name.
            if name == RELATION {
                level.direct = targets().into_iter().next().map(|t| (t, strong(name)));
            } else if let Some(rest) = name.strip_prefix("material:binding:collection:")
                && rest.matches(':').count() != 1
                && let [collection, material] = targets().as_slice()
            {
                let query = is_collection_api_path(collection)
                    .and_then(|(prim, name)| Collection::new(prim, name).compute_membership_query(stage).ok());
                level.collections.push((query, material.clone(), strong(name)));
            }
        }
        Some(Rc::new(level))
    }

    /// Returns the material that wins here for a prim, with whether it wins below too.
    fn winner(&self, prim: &Path, is_material: &mut impl FnMut(&Path) -> bool) -> Option<(Path, bool)> {
        let member = |query: &Option<MembershipQuery>| query.as_ref().is_some_and(|q| q.is_path_included(prim));
        let by_collection = self.collections.iter().find(|(query, material, _)| member(query) && is_material(material));
        let direct = || self.direct.clone().filter(|(material, _)| is_material(material));
        by_collection.map(|(_, material, strong)| (material.clone(), *strong)).or_else(direct)
    }
}

#[derive(Default)]
struct Known {
    name: String,
    /// How many prims with geometry wear it.
    worn: usize,
    color: Option<[f64; 3]>,
    index: usize,
}

/// The materials of a scene.
pub struct Surfaces {
    space: Space,
    /// In the order of the scene.
    order: Vec<String>,
    known: BTreeMap<String, Known>,
    worn: BTreeMap<String, usize>,
    textures: BTreeMap<String, bool>,
    shown: BTreeMap<[u32; 3], usize>,
    is_material: BTreeMap<String, bool>,
}

impl Surfaces {
    /// Returns none yet.
    pub fn new(space: Space) -> Self {
        Self {
            space,
            order: Vec::new(),
            known: BTreeMap::new(),
            worn: BTreeMap::new(),
            textures: BTreeMap::new(),
            shown: BTreeMap::new(),
            is_material: BTreeMap::new(),
        }
    }

    /// Notes the pictures and other files that attributes of a prim name.
    pub fn textures_of(&mut self, prim: &Prim) {
        for attribute in prim.attributes().unwrap_or_default() {
            if attribute.type_name().ok().flatten().is_none_or(|t| t.as_str() != "asset") {
                continue;
            }
            if let Ok(Some(Value::AssetPath(path))) = attribute.get_at::<Value>(TimeCode::EARLIEST)
                && !path.asset_path().is_empty()
            {
                let resolves = path.resolved_path().is_some_and(|p| !p.is_empty());
                self.textures.insert(path.as_str().to_owned(), resolves);
            }
        }
    }

    /// Returns the material that a prim is bound to.
    pub fn bound(&mut self, stage: &Stage, prim: &Path, bindings: &Option<Rc<Level>>) -> Option<Path> {
        let mut is_material = |path: &Path| {
            *self.is_material.entry(path.as_str().to_owned()).or_insert_with(|| {
                stage.prim(path.clone()).type_name().ok().flatten().is_some_and(|t| t.as_str() == "Material")
            })
        };
        let mut winner = None;
        let mut level = bindings.as_ref();
        while let Some(here) = level {
            if let Some((material, strong)) = here.winner(prim, &mut is_material)
                && (winner.is_none() || strong)
            {
                winner = Some(material);
            }
            level = here.above.as_ref();
        }
        winner
    }

    /// Notes that a prim with geometry wears a material.
    pub fn wear(&mut self, material: &Path) {
        *self.worn.entry(material.as_str().to_owned()).or_default() += 1;
    }

    /// Notes a material at its place in the scene, and reads it.
    pub fn material(&mut self, builder: &mut Builder, stage: &Stage, path: &Path) {
        self.order.push(path.as_str().to_owned());
        self.load(builder, stage, path);
    }

    /// Reads a material, each once.
    fn load(&mut self, builder: &mut Builder, stage: &Stage, path: &Path) {
        if self.known.contains_key(path.as_str()) {
            return;
        }
        let mut known = Known { name: path.name().unwrap_or_default().to_owned(), ..Known::default() };
        let mut material = Material { name: known.name.clone(), ..Material::default() };
        if let Some(surface) = surface(stage, path) {
            let input = |name: &str| producing(stage, &surface, &format!("inputs:{name}"), 0);
            let scalar = |name: &str| match input(name) {
                Some(Source::Value(value)) => number(&value).filter(|v| v.is_finite()).map(|v| v as f32),
                _ => None,
            };
            match input("diffuseColor") {
                Some(Source::Value(value)) => known.color = three(&value),
                Some(Source::Shader(shader)) => {
                    material.texture = picture(stage, &shader).map(|(name, found)| {
                        let space = &self.space;
                        builder.picture_with(&name, |most| space.content(&found?, most))
                    });
                }
                None => {}
            }
            if let Some(color) = known.color {
                material.base_color = color.map(|v| v as f32);
            }
            material.opacity = scalar("opacity").unwrap_or(1.0).clamp(0.0, 1.0);
            material.metallic = scalar("metallic").unwrap_or(0.0).clamp(0.0, 1.0);
            material.roughness = scalar("roughness").unwrap_or(0.5).clamp(0.0, 1.0);
            if let Some(Source::Value(value)) = input("emissiveColor") {
                material.emissive = three(&value).unwrap_or_default().map(|v| v as f32);
            }
        }
        known.index = builder.materials.len();
        builder.materials.push(material);
        self.known.insert(path.as_str().to_owned(), known);
    }

    /// Returns the index of the material that a prim wears: the one it is bound to, or one of its display color.
    pub fn index(&mut self, builder: &mut Builder, prim: &Prim, bound: Option<&Path>) -> Option<usize> {
        if let Some(path) = bound {
            // Materials may stand behind what wears them.
            let stage = prim.stage().clone();
            self.load(builder, &stage, path);
            return self.known.get(path.as_str()).map(|k| k.index);
        }
        let colors = value(prim, "primvars:displayColor").and_then(threes)?;
        let [color] = colors.as_slice() else { return None };
        Some(*self.shown.entry(color.map(f32::to_bits)).or_insert_with(|| {
            let name = format!("display_color_{}", builder.materials.len());
            builder.materials.push(Material { name, base_color: *color, ..Material::default() });
            builder.materials.len() - 1
        }))
    }

    /// Notes what is worn.
    pub fn finish(&mut self, builder: &mut Builder) {
        for (path, count) in &self.worn {
            if let Some(known) = self.known.get_mut(path) {
                known.worn = *count;
            }
        }
        let worn = || self.order.iter().filter_map(|p| self.known.get(p)).filter(|k| k.worn > 0);
        let names: BTreeSet<&String> = worn().map(|k| &k.name).collect();
        builder.facts.material_names = names.into_iter().cloned().collect();
        builder.facts.diffuse_colors = worn().filter_map(|k| k.color).collect();
        let textures = std::mem::take(&mut self.textures);
        builder.facts.textures = textures
            .into_iter()
            .map(|(path, resolves)| TextureFact { path: Some(path), resolves, embedded: None })
            .collect();
    }
}

/// Where a value comes from.
enum Source {
    Value(Value),
    /// An output of a shader.
    Shader(Path),
}

/// Returns the shader of a material's surface.
fn surface(stage: &Stage, material: &Path) -> Option<Path> {
    match producing(stage, material, "outputs:surface", 0)? {
        Source::Shader(shader) => Some(shader),
        Source::Value(_) => None,
    }
}

/// Follows the connections of an attribute to what gives it its value.
fn producing(stage: &Stage, prim: &Path, name: &str, hops: usize) -> Option<Source> {
    if hops > MAX_HOPS {
        return None;
    }
    let prim = stage.prim(prim.clone());
    let attribute = prim.attribute(name);
    for connection in attribute.connections().unwrap_or_default() {
        let Some((source, property)) = connection.split_property() else { continue };
        let property = property.trim_start_matches('.').to_owned();
        let kind = stage.prim(source.clone()).type_name().ok().flatten();
        let kind = kind.as_ref().map(|t| t.as_str()).unwrap_or_default();
        if kind == "Shader" && property.starts_with("outputs:") {
            return Some(Source::Shader(source));
        }
        if matches!(kind, "Material" | "NodeGraph" | "Shader")
            && let Some(found) = producing(stage, &source, &property, hops + 1)
        {
            return Some(found);
        }
    }
    attribute.get_at::<Value>(TimeCode::EARLIEST).ok().flatten().map(Source::Value)
}

/// Returns the picture that a texture shader reads: as it is named, and under which name it is found.
fn picture(stage: &Stage, shader: &Path) -> Option<(String, Option<String>)> {
    let mut shader = shader.clone();
    for _ in 0..MAX_HOPS {
        if let Some(Source::Value(Value::AssetPath(path))) = producing(stage, &shader, "inputs:file", 0) {
            let found = path.resolved_path().filter(|p| !p.is_empty()).map(str::to_owned);
            return Some((path.as_str().to_owned(), found));
        }
        // Something between the picture and the surface, such as a change of its brightness.
        let prim = stage.prim(shader.clone());
        token_of(&prim, "info:id")?;
        let next =
            ["inputs:in", "inputs:input", "inputs:color", "inputs:tex"].iter().find_map(|name| {
                match producing(stage, &shader, name, 0) {
                    Some(Source::Shader(next)) => Some(next),
                    _ => None,
                }
            });
        shader = next?;
    }
    None
}
