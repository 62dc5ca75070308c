//! Rules about getting around: everybody is a disc of the largest robot's radius, 0.30 m at least.

use super::Findings;
use crate::context::{Context, Room};
use d3dgen_knowledge::clearance::is_shallow;
use d3dgen_model::TOLERANCE_M;
use d3dgen_model::measures::LEAST_RADIUS_M;

/// Share of a room's free floor that must be reachable.
const ROOM_SHARE: f64 = 0.5;
/// Share of all free floor that must be connected.
const CONNECTED_SHARE: f64 = 0.96;
/// How far from the entrance door the disc's center may stop, beside its radius, m.
const AT_DOOR_M: f64 = 0.4;

pub fn zones(c: &Context, out: &mut Findings) {
    let reach = c.reach();
    for room in &c.rooms {
        out.look();
        let share = reach.room_share.get(&room.plan.room_id).copied().unwrap_or(0.0);
        if share < ROOM_SHARE {
            let message = format!("{:.0} % of the room's free floor can be reached", share * 100.0);
            out.add_figure(&room.plan.room_id, message, share, ROOM_SHARE, "ratio");
        }
    }
    out.look();
    if !c.plan().ways_out().into_iter().any(|d| c.near(&reach.main, &d.line, c.radius + AT_DOOR_M)) {
        out.add("building", "no entrance opens on the floor that can be reached");
    }
}

pub fn split(c: &Context, out: &mut Findings) {
    out.look();
    let share = c.reach().largest_share;
    if share < CONNECTED_SHARE {
        let message = format!("the largest connected part is {:.1} % of the free floor", share * 100.0);
        out.add_figure("building", message, share, CONNECTED_SHARE, "ratio");
    }
}

/// Bare corridors keep what the domain and the building rules ask for; furnished ones what the domain asks for, and the
/// width that the robots need to pass. What hangs flat on a wall narrows nothing.
pub fn corridors(c: &Context, out: &mut Findings) {
    let domain = c.domain.circulation.width_m(!c.retrieval.limits.no_beds);
    let limit = c.retrieval.limits.corridor_width.as_ref();
    let robots = 2.0 * c.radius.max(LEAST_RADIUS_M);
    // stairwells and shafts are as wide as what they hold
    let passed = |r: &&Room| r.plan.circulation && c.plan().link_of(&r.plan.room_id).is_none();
    for room in c.rooms.iter().filter(passed) {
        out.look();
        let width = |space: d3dgen_knowledge::freespace::FreeSpace| space.passage(&room.doors);
        let bare = width(room.space(std::iter::empty()));
        let (needed, why) = match limit {
            Some(l) if l.value > domain => (l.value, format!(", by {}", l.constraint_id)),
            _ => (domain, String::new()),
        };
        if bare < needed - TOLERANCE_M {
            let message = format!("the circulation is {bare:.2} m wide, needs {needed:.2} m{why}");
            out.add_figure(&room.plan.room_id, message, bare, needed, "m");
            continue;
        }
        let furnished = width(room.space(furniture(c, room)));
        let needed = domain.max(robots);
        if furnished < needed - TOLERANCE_M {
            let message = format!("furniture leaves {furnished:.2} m of the circulation, needs {needed:.2} m");
            out.add_figure(&room.plan.room_id, message, furnished, needed, "m");
        }
    }
}

fn furniture<'s>(c: &'s Context, room: &'s Room) -> impl Iterator<Item = &'s crate::context::Object<'s>> {
    c.objects_in(&room.plan.room_id).filter(|o| !is_shallow(o.placement))
}
