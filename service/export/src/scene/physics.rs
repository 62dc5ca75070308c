//! How things behave, from `data/physics.toml` and what domains say of their objects.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use d3dgen_mesh::Model3d;
use d3dgen_model::domain::{Mount, ObjectType};
use serde::Deserialize;

use super::Mobility;

/// The word of `extra` by which an object type says what follows for its mobility.
const MOBILITY: &str = "mobility";
/// The material whose figures count where a domain has another word.
const OTHER: &str = "other";

/// How far up a lamp the middle of its shade is.
const SHADE: f64 = 0.85;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    mobility: Mobilities,
    material: BTreeMap<String, Contact>,
    lamp: Lamps,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Mobilities {
    movable: Vec<String>,
    moved_kg: f64,
    lifted_kg: f64,
    grip_m: f64,
}

/// How a surface meets another.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Contact {
    pub friction: f64,
    pub restitution: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Lamps {
    ceiling: Lamp,
    other: Lamp,
}

/// The light of a lamp.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Lamp {
    pub lumens: f64,
    pub kelvin: f64,
}

static TABLE: LazyLock<Table> =
    LazyLock::new(|| toml::from_str(include_str!("../../data/physics.toml")).expect("a test reads physics.toml"));

/// Returns whether a thing can be moved: as its type says, else by its mount, shape, size and mass.
pub(super) fn mobility(object: &ObjectType, mount: Mount, size_m: [f64; 3], mass_kg: f64) -> Mobility {
    let told = object.extra.get(MOBILITY).and_then(|word| {
        [Mobility::Fixed, Mobility::Movable, Mobility::Graspable].into_iter().find(|m| m.name() == word)
    });
    let table = &TABLE.mobility;
    let moves = mass_kg <= table.moved_kg;
    let guess = match mount {
        Mount::Wall | Mount::Ceiling => Mobility::Fixed,
        Mount::Surface if mass_kg <= table.lifted_kg && size_m.iter().any(|v| *v <= table.grip_m) => {
            Mobility::Graspable
        }
        Mount::Surface if moves => Mobility::Movable,
        Mount::Floor if moves && table.movable.iter().any(|s| s == object.shape.name()) => Mobility::Movable,
        Mount::Surface | Mount::Floor => Mobility::Fixed,
    };
    told.unwrap_or(guess)
}

/// Returns friction and restitution of a thing by its main material.
pub(super) fn contact(object: &ObjectType) -> Contact {
    let found = TABLE.material.get(&object.material).or_else(|| TABLE.material.get(OTHER));
    *found.unwrap_or(&Contact { friction: 0.5, restitution: 0.2 })
}

/// Returns the light of a lamp, and where on its model: amid what gives light, else amid its shade, which is on top.
pub(super) fn light(model: &Model3d, mount: Mount) -> Option<(Lamp, [f64; 3])> {
    let gives = |material: Option<usize>| {
        material.and_then(|m| model.materials.get(m)).is_some_and(|m| m.emissive.iter().any(|e| *e > 0.0))
    };
    let seen =
        model.bodies.iter().flat_map(|b| &b.visuals).filter(|v| gives(v.material)).filter_map(|v| v.mesh.bounds());
    let lit = seen
        .reduce(|a, b| [std::array::from_fn(|i| a[0][i].min(b[0][i])), std::array::from_fn(|i| a[1][i].max(b[1][i]))]);
    let middle = |a: f64, b: f64, share: f64| a + (b - a) * share;
    let [min, max] = lit.or_else(|| model.bounds())?;
    let up = if lit.is_some() { 0.5 } else { SHADE };
    let at = [middle(min[0], max[0], 0.5), middle(min[1], max[1], 0.5), middle(min[2], max[2], up)];
    Some((if mount == Mount::Ceiling { TABLE.lamp.ceiling } else { TABLE.lamp.other }, at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_read_and_names_shapes_there_are() {
        for word in &TABLE.mobility.movable {
            assert!(d3dgen_model::domain::Shape::all().any(|s| s.name() == word), "{word} is no shape");
        }
        assert!(TABLE.material.contains_key(OTHER) && TABLE.lamp.ceiling.lumens > TABLE.lamp.other.lumens);
        assert!(TABLE.material.values().all(|c| (0.0..=1.0).contains(&c.restitution) && c.friction > 0.0));
    }
}
