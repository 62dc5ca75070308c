//! What point instancers repeat, put in all its places.
//!
//! What it is not for: the facts, which count a prototype once and where it stands, as USD's own traversal does.

use std::collections::HashMap;
use std::rc::Rc;

use openusd::sdf::Path;
use openusd::usd::{Prim, Stage};

use super::scene::{State, add, parts};
use super::shape::{MeshShape, Triangles, simple};
use super::surface::Surfaces;
use super::value::{integers, quaternions, threes, unit, value};
use crate::readers::builder::Builder;
use crate::readers::facts::Refusal;
use crate::readers::frame::Matrix;

/// The most instances, over all levels.
const MAX_INSTANCES: usize = 20_000;
/// The most visits of prims.
const MAX_VISITS: usize = 100_000;
/// The deepest nesting of instancers.
const MAX_NESTING: usize = 6;

type Parts = Rc<Vec<(Triangles, Option<usize>)>>;

struct Places<'a> {
    stage: &'a Stage,
    surfaces: &'a mut Surfaces,
    shapes: HashMap<String, Parts>,
    instances: usize,
    visits: usize,
}

/// Adds what instancers repeat.
///
/// # Errors
///
/// When it becomes too much.
pub fn place(
    builder: &mut Builder,
    stage: &Stage,
    surfaces: &mut Surfaces,
    instancers: Vec<(Path, State)>,
) -> Result<(), Refusal> {
    let mut places = Places { stage, surfaces, shapes: HashMap::new(), instances: 0, visits: 0 };
    instancers.into_iter().try_for_each(|(path, state)| places.instancer(builder, &stage.prim(path), &state, 0))
}

impl Places<'_> {
    fn instancer(&mut self, builder: &mut Builder, prim: &Prim, state: &State, level: usize) -> Result<(), Refusal> {
        let prototypes = prim.relationship("prototypes").forwarded_targets().unwrap_or_default();
        let positions = value(prim, "positions").and_then(threes).unwrap_or_default();
        let scales = value(prim, "scales").and_then(threes).unwrap_or_default();
        let mut turns = quaternions(value(prim, "orientations"));
        if turns.len() != positions.len() {
            turns = quaternions(value(prim, "orientationsf"));
        }
        let ids = integers(value(prim, "ids"));
        let hidden = integers(value(prim, "invisibleIds"));
        for (index, prototype) in integers(value(prim, "protoIndices")).into_iter().enumerate() {
            self.instances += 1;
            if self.instances > MAX_INSTANCES || level > MAX_NESTING {
                return Err(format!("repeats more than {MAX_INSTANCES} things; it is a scene and no object").into());
            }
            let id = ids.get(index).copied().unwrap_or(index as i64);
            let path = usize::try_from(prototype).ok().and_then(|p| prototypes.get(p));
            let (Some(path), Some(position), false) = (path, positions.get(index), hidden.contains(&id)) else {
                continue;
            };
            let turn = turns.get(index).map_or(Matrix::IDENTITY, |q| Matrix::rotation(unit(*q)));
            let scale = scales.get(index).map_or(Matrix::IDENTITY, |s| Matrix::scale(s.map(f64::from)));
            let mut own = state.clone();
            own.world = state.world * Matrix::translation(position.map(f64::from)) * turn * scale;
            self.subtree(builder, &self.stage.prim(path.clone()), &own, level)?;
        }
        Ok(())
    }

    fn subtree(&mut self, builder: &mut Builder, root: &Prim, state: &State, level: usize) -> Result<(), Refusal> {
        let mut open = vec![(root.clone(), state.clone())];
        while let Some((prim, inherited)) = open.pop() {
            self.visits += 1;
            if self.visits > MAX_VISITS {
                return Err(format!("repeats more than {MAX_VISITS} prims; it is a scene and no object").into());
            }
            if !prim.is_active().unwrap_or(true) {
                continue;
            }
            let kind = prim.type_name().ok().flatten().map(|t| t.as_str().to_owned()).unwrap_or_default();
            let state = inherited.of(self.stage, &prim, &kind);
            if !state.is_seen() {
                continue;
            }
            if kind == "PointInstancer" {
                self.instancer(builder, &prim, &state, level + 1)?;
                continue;
            }
            for (shape, material) in self.shape(builder, &prim, &kind, &state)?.iter() {
                add(builder, &prim, shape.clone(), *material, &state.world)?;
            }
            open.extend(prim.children().unwrap_or_default().into_iter().map(|child| (child, state.clone())));
        }
        Ok(())
    }

    /// Returns the geometry of a prim, read once.
    fn shape(&mut self, builder: &mut Builder, prim: &Prim, kind: &str, state: &State) -> Result<Parts, Refusal> {
        if let Some(shape) = self.shapes.get(prim.path().as_str()) {
            return Ok(shape.clone());
        }
        let bound = self.surfaces.bound(self.stage, prim.path(), &state.bindings);
        let shape = match kind {
            "Mesh" => {
                let mesh = MeshShape::of(prim);
                parts(builder, self.surfaces, self.stage, prim, &mesh, bound.as_ref())?
            }
            kind if super::shape::GPRIMS.contains(&kind) => {
                let material = self.surfaces.index(builder, prim, bound.as_ref());
                simple(prim, kind).1.into_iter().map(|shape| (shape, material)).collect()
            }
            _ => Vec::new(),
        };
        let shape = Rc::new(shape);
        self.shapes.insert(prim.path().as_str().to_owned(), shape.clone());
        Ok(shape)
    }
}
