//! Where along a wall a unit cannot stand, told from its outlines at once instead of place by place.

use d3dgen_model::domain::Mount;

use crate::geom::{Box2, Solid};
use crate::space::WallSide;
use crate::state::{Rule, State, takes_floor};
use crate::unit::Unit;

/// Positions of a unit along one wall at which something that belongs to it whatever happens breaks a rule of
/// [`State::test`]: open intervals, mm.
///
/// Rules that look at walls and tops are not among them, so that a position outside of all intervals is still to be tested.
pub(super) struct Barred(Vec<(i32, i32, Rule)>);

impl Barred {
    /// Looks along a wall; `u` is where the origin of the unit is, counted from the wall's frame.
    pub fn along(state: &State, unit: &Unit, wall: &WallSide, u: i32, at_window: bool) -> Self {
        let (space, q) = (state.space, (4 - wall.q) % 4);
        let depth = unit.parts.iter().map(|part| &part.solid.rect).chain(&unit.clears);
        let (x0, x1) = depth.fold((i32::MAX, i32::MIN), |(lo, hi), b| (lo.min(b.x0), hi.max(b.x1)));
        let strip = Box2::new(u + x0, wall.v0, u + x1, wall.v1).turned(wall.q);
        let near = |b: &Box2| b.overlaps(&strip).then(|| b.turned(q));
        let solids: Vec<Solid> = state
            .solids
            .iter()
            .filter(|s| !(s.is_flat() && s.z0 == 0))
            .filter_map(|s| Some(Solid { rect: near(&s.rect)?, ..*s }))
            .collect();
        let holes: Vec<Box2> = space.holes().iter().filter_map(near).collect();
        let clears: Vec<Box2> = state.clears.iter().filter_map(near).collect();
        let bodies: Vec<Box2> = state.bodies.iter().filter_map(near).collect();
        let lanes: Vec<Box2> = space.lanes(state.open).iter().filter_map(near).collect();
        let doors: Vec<(Box2, i32)> =
            space.doors.iter().filter_map(|d| Some((near(d.kept(state.open))?, d.height))).collect();

        let mut out = Vec::new();
        let mut bar = |own: &Box2, other: &Box2, rule: Rule| {
            if own.x0 + u < other.x1 && other.x0 < own.x1 + u {
                out.push((other.y0 - own.y1, other.y1 - own.y0, rule));
            }
        };
        for part in unit.parts.iter().filter(|part| !part.may_go()) {
            let Solid { rect, z0, z1 } = &part.solid;
            holes.iter().for_each(|hole| bar(rect, hole, Rule::Outside));
            if part.solid.is_flat() && *z0 == 0 {
                continue; // floor covering lies anywhere
            }
            solids.iter().filter(|s| *z0 < s.z1 && s.z0 < *z1).for_each(|s| bar(rect, &s.rect, Rule::Collision));
            if !at_window {
                let darkened = space.windows.iter().filter(|w| w.is_as_high(&part.solid));
                darkened.filter_map(|w| near(w.kept(state.open))).for_each(|w| bar(rect, &w, Rule::Window));
            }
            if part.mount == Mount::Surface {
                continue;
            }
            doors.iter().filter(|(_, height)| z0 < height).for_each(|(floor, _)| bar(rect, floor, Rule::Door));
            if takes_floor(part, &part.solid) {
                lanes.iter().for_each(|floor| bar(rect, floor, Rule::Door));
                clears.iter().for_each(|floor| bar(rect, floor, Rule::Clearance));
            }
        }
        for floor in &unit.clears {
            holes.iter().chain(&bodies).for_each(|other| bar(floor, other, Rule::Clearance));
        }
        Self(out)
    }

    /// Returns a rule that is broken at a position along the wall.
    pub fn rule_at(&self, v: i32) -> Option<Rule> {
        self.0.iter().find(|(from, to, _)| (from + 1..*to).contains(&v)).map(|(.., rule)| *rule)
    }
}
