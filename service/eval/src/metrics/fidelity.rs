//! Room-count fidelity: are the rooms of the plan exactly those that were asked for?
//!
//! The paper reports room-count fidelity (arXiv 2608.11876): built against requested rooms. Here types count too. What was
//! asked for is the scene graph, and the number in the prompt where the caller knows it (`bench paper` does). Corridors
//! and halls that were added to connect rooms are no rooms in this sense.

use std::collections::BTreeMap;

use d3dgen_model::world::World;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Rooms asked for against rooms built.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fidelity {
    /// Rooms asked for.
    pub rooms_asked: u32,
    /// Rooms built.
    pub rooms_built: u32,
    /// Room types asked for and not built, each as often as it is missing.
    pub missing: Vec<String>,
    /// Room types built and not asked for.
    pub surplus: Vec<String>,
    /// True when number and types agree.
    pub exact: bool,
}

/// Measures a world; `asked` is the number in the prompt, where it is known.
pub(crate) fn measure(world: &World, asked: Option<u32>) -> Fidelity {
    let wanted: Vec<&str> =
        world.scene_graph.rooms.iter().filter(|r| !r.circulation).map(|r| r.room_type.as_str()).collect();
    let built: Vec<&str> =
        world.floorplan.rooms.iter().filter(|r| !r.circulation).map(|r| r.room_type.as_str()).collect();
    let mut balance: BTreeMap<&str, i64> = BTreeMap::new();
    wanted.iter().for_each(|t| *balance.entry(t).or_default() += 1);
    built.iter().for_each(|t| *balance.entry(t).or_default() -= 1);
    let listed = |sign: i64| {
        let off = balance.iter().filter(|(_, n)| **n * sign > 0);
        off.flat_map(|(t, n)| std::iter::repeat_n((*t).to_owned(), n.unsigned_abs() as usize)).collect::<Vec<_>>()
    };
    let (missing, surplus) = (listed(1), listed(-1));
    let rooms_asked = asked.unwrap_or(wanted.len() as u32);
    let exact = missing.is_empty() && surplus.is_empty() && rooms_asked as usize == built.len();
    Fidelity { rooms_asked, rooms_built: built.len() as u32, missing, surplus, exact }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn number_and_types_must_agree() {
        let mut world = sample::world();
        let found = measure(&world, None);
        assert_eq!((found.rooms_asked, found.rooms_built, found.exact), (2, 2, true));
        assert!(!measure(&world, Some(3)).exact, "the prompt said three");
        world.floorplan.rooms[1].room_type = "storage".into();
        let found = measure(&world, None);
        assert_eq!((found.exact, found.missing, found.surplus), (false, vec!["room".into()], vec!["storage".into()]));
    }
}
