//! A composed scene as a model: prims in their order, with the matrix, visibility and purpose they inherit.
//!
//! Facts count every mesh, seen or not, and prims of instances each time; the box and the model have what is visible and
//! of the purposes `default` and `render`.

use std::collections::BTreeMap;
use std::rc::Rc;

use openusd::pcp::ArcType;
use openusd::sdf::{Path, Value};
use openusd::usd::{Prim, Stage};

use super::instances;
use super::shape::{GPRIMS, MeshShape, Triangles, simple};
use super::space::Space;
use super::surface::{Level, Surfaces};
use super::value::{local_matrix, token_of, tokens, value};
use crate::readers::builder::{Builder, Piece};
use crate::readers::facts::{Feature, Refusal};
use crate::readers::frame::{Extent, Matrix};

/// The most prims of a scene.
const MAX_PRIMS: usize = 20_000;
/// The deepest nesting of prims.
const MAX_DEPTH: usize = 200;

/// What a prim inherits.
#[derive(Clone)]
pub struct State {
    /// From the prim to the top.
    pub world: Matrix,
    pub invisible: bool,
    pub purpose: Option<Rc<str>>,
    pub bindings: Option<Rc<Level>>,
    /// Whether it is part of what a point instancer repeats.
    pub prototype: bool,
    defined: bool,
}

impl State {
    /// Returns what the top of a scene has.
    pub fn top() -> Self {
        Self {
            world: Matrix::IDENTITY,
            invisible: false,
            purpose: None,
            bindings: None,
            prototype: false,
            defined: true,
        }
    }

    /// Tells whether it is seen.
    pub fn is_seen(&self) -> bool {
        !self.invisible && matches!(self.purpose.as_deref(), None | Some("default" | "render"))
    }

    /// Returns what a prim of a kind has, beyond what it inherits.
    pub fn of(&self, stage: &Stage, prim: &Prim, kind: &str) -> Self {
        let mut state = self.clone();
        if is_transformed(kind) {
            let (local, reset) = local_matrix(prim);
            state.world = if reset { local } else { self.world * local };
        }
        if !kind.is_empty() {
            state.invisible |= token_of(prim, "visibility").as_deref() == Some("invisible");
            if let Some(purpose) = token_of(prim, "purpose") {
                state.purpose = Some(purpose.into());
            }
        }
        state.bindings = Level::of(stage, prim, &self.bindings);
        state
    }
}

fn is_transformed(kind: &str) -> bool {
    matches!(kind, "Xform" | "Camera" | "SkelRoot" | "Skeleton" | "PointInstancer" | "Model")
        || kind.contains("Light")
        || GPRIMS.contains(&kind)
}

#[derive(Default)]
struct Tally {
    counts: BTreeMap<&'static str, u64>,
    gprims: BTreeMap<String, u64>,
    purposes: BTreeMap<String, u64>,
    subdivision: BTreeMap<String, u64>,
    variants: Vec<String>,
    broken: u64,
    unmoved: u64,
    wrong_extents: u64,
    varying: bool,
}

impl Tally {
    fn add(&mut self, name: &'static str, when: bool) {
        *self.counts.entry(name).or_default() += u64::from(when);
    }
}

/// Reads the scene into a builder.
///
/// # Errors
///
/// When it is too large.
pub fn read(builder: &mut Builder, stage: &Stage, space: &Space) -> Result<(), Refusal> {
    let mut tally = Tally::default();
    let mut surfaces = Surfaces::new(space.clone());
    let mut instancers: Vec<(Path, State)> = Vec::new();
    let mut prims = 0usize;
    let top = stage.root_prims().map_err(|e| super::reason(&e))?;
    let child = |parent: &str, name: &str| Path::new(&format!("{parent}/{name}")).ok();
    let mut open: Vec<(Path, State, usize)> =
        top.iter().rev().filter_map(|n| Some((child("", n.as_str())?, State::top(), 0))).collect();
    let mut result = Ok(());
    while let Some((path, inherited, depth)) = open.pop() {
        prims += 1;
        if prims > MAX_PRIMS || depth > MAX_DEPTH {
            result = Err(Refusal::new(format!(
                "its scene has more than {MAX_PRIMS} prims or is nested deeper than {MAX_DEPTH} levels"
            )));
            break;
        }
        let prim = stage.prim(path.clone());
        if !prim.is_active().unwrap_or(true) {
            tally.add("inactive", true);
            continue;
        }
        let defined = inherited.defined && prim.is_defined().unwrap_or(false);
        let kind = prim.type_name().ok().flatten().map(|t| t.as_str().to_owned()).unwrap_or_default();
        surfaces.textures_of(&prim);
        let mut state = inherited.of(stage, &prim, &kind);
        state.defined = defined;
        let is_abstract = prim.is_abstract().unwrap_or(false);
        if defined && kind == "Material" {
            surfaces.material(builder, stage, &path);
        }
        if defined && !is_abstract {
            count(&mut tally, &prim, &kind);
            if let Err(refusal) = gprim(builder, &mut tally, &mut surfaces, stage, &prim, &kind, &state) {
                result = Err(refusal);
                break;
            }
            if kind == "PointInstancer" {
                if !state.prototype && state.is_seen() {
                    instancers.push((path.clone(), state.clone()));
                }
                state.prototype = true;
            }
        }
        let names = prim.child_names().unwrap_or_default();
        open.extend(
            names.iter().rev().filter_map(|n| Some((child(path.as_str(), n.as_str())?, state.clone(), depth + 1))),
        );
    }
    // Also of a scene that is refused: they tell what it is.
    note(builder, stage, tally);
    surfaces.finish(builder);
    result?;
    instances::place(builder, stage, &mut surfaces, instancers)
}

/// Counts what a prim is.
fn count(tally: &mut Tally, prim: &Prim, kind: &str) {
    tally.add("instances", prim.is_instance().unwrap_or(false));
    if prim.has_composition_arc().unwrap_or(false)
        && let Ok(graph) = prim.prim_index().graph()
    {
        let direct = |arc: ArcType| {
            graph.all_nodes().any(|node| {
                let parent = node.parent().map(|p| graph.node(p).path().prim_element_count());
                node.arc() == arc && parent == Some(usize::from(node.namespace_depth()))
            })
        };
        tally.add("references", direct(ArcType::Reference));
        tally.add("payloads", direct(ArcType::Payload));
        tally.add("inherits", direct(ArcType::Inherit));
        tally.add("specializes", direct(ArcType::Specialize));
        for (set, choice) in prim.variant_sets().get_all_variant_selections().unwrap_or_default() {
            tally.variants.push(format!("{}:{set}={choice}", prim.path().as_str()));
        }
    }
    tally.add("cameras", kind == "Camera");
    tally.add("lights", kind.contains("Light"));
    tally.add("curves", kind.contains("Curves"));
    tally.add("geom_subsets", kind == "GeomSubset");
    tally.add("point_instancers", kind == "PointInstancer");
    tally.add("skel", matches!(kind, "SkelRoot" | "Skeleton"));
    tally.add("blend_shapes", kind == "BlendShape");
    if is_transformed(kind) {
        let order = prim.attribute("xformOpOrder").get::<Value>().ok().flatten().map(tokens).unwrap_or_default();
        let moves = |name: &String| {
            let name = name.strip_prefix("!invert!").unwrap_or(name);
            prim.attribute(name).value_might_be_time_varying().unwrap_or(false)
        };
        let there = |name: &String| value(prim, name.strip_prefix("!invert!").unwrap_or(name)).is_some();
        tally.unmoved += order.iter().filter(|n| n.contains("xformOp:")).filter(|n| !there(n)).count() as u64;
        let moving = order.iter().filter(|n| n.contains("xformOp:")).any(moves);
        tally.add("animated_xforms", moving);
        tally.varying |= moving;
    }
}

/// Takes in a prim with geometry.
fn gprim(
    builder: &mut Builder,
    tally: &mut Tally,
    surfaces: &mut Surfaces,
    stage: &Stage,
    prim: &Prim,
    kind: &str,
    state: &State,
) -> Result<(), Refusal> {
    if !GPRIMS.contains(&kind) {
        return Ok(());
    }
    let purpose = state.purpose.as_deref().unwrap_or("default").to_owned();
    *tally.purposes.entry(purpose).or_default() += 1;
    tally.add("invisible_prims", state.invisible);
    let bound = surfaces.bound(stage, prim.path(), &state.bindings);
    if let Some(material) = &bound {
        surfaces.wear(material);
    }
    if kind != "Mesh" {
        *tally.gprims.entry(kind.to_owned()).or_default() += 1;
        let (bounds, shape) = simple(prim, kind);
        if let (true, Some(bounds)) = (state.is_seen(), bounds) {
            builder.extent.add_box(bounds, &state.world);
        }
        if let (true, false, Some(shape)) = (state.is_seen(), state.prototype, shape) {
            let material = surfaces.index(builder, prim, bound.as_ref());
            add(builder, prim, shape, material, &state.world)?;
        }
        return Ok(());
    }
    let mesh = MeshShape::of(prim);
    builder.facts.mesh_count += 1;
    builder.facts.triangle_count += mesh.triangle_count();
    tally.broken += u64::from(!mesh.is_whole());
    tally.add("left_handed", mesh.left_handed);
    let moving = prim.attribute("points").value_might_be_time_varying().unwrap_or(false);
    tally.add("animated_points", moving);
    tally.varying |= moving;
    let skinned = prim.attribute("primvars:skel:jointIndices").get::<Value>().is_ok_and(|v| v.is_some());
    tally.add("skinned_meshes", skinned);
    let scheme = token_of(prim, "subdivisionScheme").unwrap_or_else(|| "catmullClark".into());
    if scheme != "none" {
        *tally.subdivision.entry(scheme).or_default() += 1;
    }
    if !state.is_seen() {
        return Ok(());
    }
    tally.wrong_extents += u64::from(!extent_holds(prim, &mesh.points));
    mesh.points.iter().for_each(|p| builder.extent.add(state.world.point(p.map(f64::from))));
    if state.prototype {
        return Ok(());
    }
    for (triangles, material) in parts(builder, surfaces, stage, prim, &mesh, bound.as_ref())? {
        add(builder, prim, triangles, material, &state.world)?;
    }
    Ok(())
}

/// Tells whether the extent that a mesh says is that of its corners, when it says one.
fn extent_holds(prim: &Prim, points: &[[f32; 3]]) -> bool {
    let Some(said) = value(prim, "extent").and_then(super::value::threes).filter(|e| e.len() == 2) else { return true };
    let mut found = Extent::default();
    points.iter().for_each(|p| found.add(p.map(f64::from)));
    let Some(found) = found.scaled(1.0) else { return true };
    let size = (0..3).map(|i| found[1][i] - found[0][i]).fold(1e-9, f64::max);
    (0..6).all(|i| (f64::from(said[i / 3][i % 3]) - found[i / 3][i % 3]).abs() <= 1e-3 * size)
}

/// Returns a mesh by materials: one part for each subset of faces with a material of its own, and one for the rest.
///
/// # Errors
///
/// When it is too large.
pub fn parts(
    builder: &mut Builder,
    surfaces: &mut Surfaces,
    stage: &Stage,
    prim: &Prim,
    mesh: &MeshShape,
    bound: Option<&Path>,
) -> Result<Vec<(Triangles, Option<usize>)>, Refusal> {
    let mut out = Vec::new();
    let mut taken = vec![false; mesh.counts.len().min(mesh.indices.len() + 1)];
    for child in prim.children().unwrap_or_default() {
        let is_subset = child.type_name().ok().flatten().is_some_and(|t| t.as_str() == "GeomSubset");
        if !is_subset || token_of(&child, "elementType").is_some_and(|t| t != "face") {
            continue;
        }
        let level = Level::of(stage, &child, &None);
        let own = surfaces.bound(stage, child.path(), &level);
        let Some(own) = own else { continue };
        let mut faces = vec![false; taken.len()];
        for face in super::value::integers(value(&child, "indices")) {
            if let Some(index) = usize::try_from(face).ok().filter(|i| *i < taken.len()) {
                faces[index] = !taken[index];
                taken[index] = true;
            }
        }
        let triangles = mesh.triangles(|f| faces.get(f).copied().unwrap_or(false))?;
        out.push((triangles, surfaces.index(builder, prim, Some(&own))));
    }
    let rest = mesh.triangles(|f| !taken.get(f).copied().unwrap_or(false))?;
    if !rest.triangles.is_empty() || out.is_empty() {
        out.push((rest, surfaces.index(builder, prim, bound)));
    }
    Ok(out)
}

/// Adds triangles under the name of a prim.
pub fn add(
    builder: &mut Builder,
    prim: &Prim,
    shape: Triangles,
    material: Option<usize>,
    place: &Matrix,
) -> Result<(), Refusal> {
    let name = prim.path().name().unwrap_or_default().to_owned();
    let Triangles { positions, uvs, triangles } = shape;
    builder.add(0, Piece { name, positions, uvs, triangles, material }, place)
}

fn note(builder: &mut Builder, stage: &Stage, tally: Tally) {
    let facts = &mut builder.facts;
    const COUNTS: &[&str] = &[
        "references",
        "payloads",
        "inherits",
        "specializes",
        "instances",
        "point_instancers",
        "cameras",
        "lights",
        "curves",
        "left_handed",
        "geom_subsets",
        "invisible_prims",
        "inactive",
        "animated_xforms",
        "animated_points",
        "skinned_meshes",
    ];
    for name in COUNTS {
        facts.feature(name, Feature::Count(tally.counts.get(name).copied().unwrap_or(0)));
    }
    for name in ["skel", "blend_shapes"] {
        facts.feature(name, Feature::Flag(tally.counts.get(name).is_some_and(|c| *c > 0)));
    }
    facts.feature("animated", Feature::Flag(tally.varying));
    facts.feature("variants", Feature::Names(tally.variants));
    facts.feature("subdivision", Feature::Counts(tally.subdivision));
    facts.feature("purposes", Feature::Counts(tally.purposes));
    facts.feature("gprims", Feature::Counts(tally.gprims));
    if let Some(name) = stage.default_prim() {
        facts.feature("default_prim", Feature::Text(name.as_str().chars().take(200).collect()));
    }
    if tally.unmoved > 0 {
        facts.warn(format!("{} transformations are named that are not there", tally.unmoved));
    }
    if tally.wrong_extents > 0 {
        facts.warn(format!("{} meshes say another extent than their corners have", tally.wrong_extents));
    }
    if tally.broken > 0 {
        facts.warn(format!(
            "{} meshes whose faces name corners that are not there or are not as many as said",
            tally.broken
        ));
    }
}
