//! Rules about furniture as the domain describes it: what a room must have, how groups stand, what backs to walls.

use std::collections::BTreeSet;

use d3dgen_knowledge::clearance::{Side, free_depth, is_shallow, quarter};
use d3dgen_model::domain::{Arrangement, FacingRule, Furnishing, Group, Member, Mount, Relation, Shape};
use d3dgen_model::offer::other_bed;
use d3dgen_model::placements::Placement;
use d3dgen_model::{Rect, TOLERANCE_M};

use super::Findings;
use crate::context::{Context, Object, Room};

/// Farthest a back may be from the wall it belongs to, m: a heater, a skirting, a curtain fit between.
const BACK_M: f64 = 0.30;
/// Distance from which a sofa with its back to the room leaves a way behind it, m.
const WAY_BEHIND_M: f64 = 0.90;
/// Share of its usual free floor that an object must keep to be of use.
const USABLE_SHARE: f64 = 0.5;

pub fn required(c: &Context, out: &mut Findings) {
    let graph = c.graph();
    let asked = |line: &&Furnishing| {
        line.required && line.is_for(graph.rooms.iter().map(|r| r.room_type.as_str()), graph.accessible)
    };
    for room in &c.rooms {
        // the bed that somebody asked for stands for the usual one
        let bed = graph.room(&room.plan.room_id).and_then(|r| other_bed(c.domain, r));
        for line in room.kind.furnishing.iter().filter(asked) {
            out.look();
            let asked_for = bed.filter(|b| b.instead_of.contains(&line.item)).map(|b| &b.item);
            let items = std::iter::once(&line.item).chain(&line.instead_of).chain(asked_for);
            let count: u32 = items.map(|item| instances(c, room, item)).sum();
            if count < line.min {
                let message = format!("has {count} {}, needs {}", line.item, line.min);
                out.add_figure(&room.plan.room_id, message, f64::from(count), f64::from(line.min), "count");
            }
        }
    }
    for item in c.world.placements.unplaced.iter().filter(|u| u.required) {
        out.look();
        out.add(&item.room_id, format!("`{}` has no place: {}", item.item, item.reason));
    }
}

/// Returns how many of an item stand in a room: whole groups, or objects (in groups or not).
fn instances(c: &Context, room: &Room, item: &str) -> u32 {
    let here = || c.objects_in(&room.plan.room_id).map(|o| o.placement);
    match c.domain.group(item) {
        Some(group) => members(c, room, group).filter(|m| is_whole(group, m)).count() as u32,
        None => here().filter(|p| p.object == item).count() as u32,
    }
}

/// Returns the placements of each instance of a group in a room.
fn members<'c>(c: &'c Context, room: &'c Room, group: &'c Group) -> impl Iterator<Item = Vec<&'c Placement>> {
    let here = || c.objects_in(&room.plan.room_id).map(|o| o.placement);
    let ids: BTreeSet<&str> =
        here().filter_map(|p| p.group.as_deref()).filter(|id| group_id(id, room) == Some(&group.id)).collect();
    ids.into_iter().map(move |id| here().filter(|p| p.group.as_deref() == Some(id)).collect())
}

/// Returns the group id in the id of an instance: `bed_place` in `patient_room_3_bed_place_1`.
fn group_id<'i>(instance: &'i str, room: &Room) -> Option<&'i str> {
    let rest = instance.strip_prefix(&room.plan.room_id)?.strip_prefix('_')?;
    rest.rsplit_once('_').map(|(id, _)| id)
}

fn is_whole(group: &Group, found: &[&Placement]) -> bool {
    let has = |object: &str| found.iter().any(|p| p.object == object);
    has(&group.anchor) && group.members.iter().filter(|m| m.required).all(|m| has(&m.object))
}

pub fn facing(c: &Context, out: &mut Findings) {
    for room in &c.rooms {
        for group in &c.domain.groups {
            for found in members(c, room, group) {
                let Some(anchor) = found.iter().find(|p| p.object == group.anchor) else { continue };
                for p in found.iter().filter(|p| p.placement_id != anchor.placement_id && p.mount != Mount::Ceiling) {
                    let mut rules = group.members.iter().filter(|m| m.object == p.object).map(facing_of).peekable();
                    if rules.peek().is_none() {
                        continue;
                    }
                    out.look();
                    if !rules.any(|rule| faces(p, anchor, rule)) {
                        let message = format!("faces away from how it is used with `{}`", anchor.placement_id);
                        out.add(&p.placement_id, message);
                    }
                }
            }
        }
    }
}

/// Returns how a member faces: what stands around something faces it whatever its line says.
fn facing_of(member: &Member) -> FacingRule {
    if member.relation == Relation::Around { FacingRule::Toward } else { member.facing }
}

/// Heading of each quarter turn.
const HEADINGS: [(f64, f64); 4] = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];

fn faces(p: &Placement, anchor: &Placement, rule: FacingRule) -> bool {
    let (own, other) = (quarter(p.pose.yaw_rad), quarter(anchor.pose.yaw_rad));
    match rule {
        FacingRule::Same => own == other,
        FacingRule::Opposite => own == (other + 2) % 4,
        FacingRule::Toward => {
            let (dx, dy) = HEADINGS[usize::from(own % 4)];
            let (x, y) = (anchor.pose.x - p.pose.x, anchor.pose.y - p.pose.y);
            // along the heading lies the anchor's outline, not only its center: a chair at a long table
            dx * x + dy * y > 0.0 || x.hypot(y) < TOLERANCE_M
        }
    }
}

pub fn back(c: &Context, out: &mut Findings) {
    for room in &c.rooms {
        for object in c.objects_in(&room.plan.room_id) {
            if !belongs_to_wall(c, room, object.placement) {
                continue;
            }
            out.look();
            // a sofa may stand nearer to its screen when one gets past behind it
            let free = object.kind.is_some_and(|k| k.shape == Shape::Sofa).then_some(WAY_BEHIND_M);
            let wrong = |gap: &f64| *gap > BACK_M && free.is_none_or(|way| *gap < way - TOLERANCE_M);
            if let Some(gap) = behind(&rear(c, object), object.placement, room).filter(wrong) {
                let message = format!("its back is {gap:.2} m from the wall");
                out.add_figure(&object.placement.placement_id, message, gap, BACK_M, "m");
            }
        }
    }
}

/// Returns true for floor objects that every furnishing line of the room puts against a wall.
fn belongs_to_wall(c: &Context, room: &Room, p: &Placement) -> bool {
    let item = p.group.as_deref().and_then(|id| group_id(id, room));
    let anchor = item.and_then(|id| c.domain.group(id)).map(|g| g.anchor.as_str());
    // members other than the anchor stand as their group says
    if p.mount != Mount::Floor || (item.is_some() && anchor != Some(p.object.as_str())) {
        return false;
    }
    let name = item.unwrap_or(&p.object);
    let mut lines = room.kind.furnishing.iter().filter(|f| f.item == name).peekable();
    let against = |f: &Furnishing| {
        matches!(
            f.arrangement,
            Arrangement::Wall | Arrangement::SolidWall | Arrangement::WindowWall | Arrangement::Corner
        )
    };
    lines.peek().is_some() && lines.all(against)
}

/// Returns the outline of an anchor with what its group has behind it: a counter with its staff's side, a table with
/// seats on both sides. Their back is the group's.
fn rear(c: &Context, object: &Object) -> Rect {
    let Some(group) = object.placement.group.as_deref() else { return object.rect };
    let (dx, dy) = HEADINGS[usize::from(quarter(object.placement.pose.yaw_rad) % 4)];
    let own = object.rect.center();
    let members = c.objects_in(&object.placement.room_id).filter(|o| {
        let center = o.rect.center();
        let ahead = dx * (center.x - own.x) + dy * (center.y - own.y);
        o.placement.group.as_deref() == Some(group) && o.placement.mount == Mount::Floor && ahead < 0.0
    });
    members.fold(object.rect, |r, o| r.union(&o.rect))
}

/// Returns the distance from the back of an outline to the wall behind it, m; very far without a wall behind.
fn behind(r: &Rect, p: &Placement, room: &Room) -> Option<f64> {
    let gaps = room.plan.net_polygon.edges().filter_map(|e| {
        let w = e.bounds();
        let (across, gap) = match quarter(p.pose.yaw_rad) {
            0 => ((w.y0, w.y1, r.y0, r.y1, e.is_vertical()), r.x0 - w.x0),
            1 => ((w.x0, w.x1, r.x0, r.x1, !e.is_vertical()), r.y0 - w.y0),
            2 => ((w.y0, w.y1, r.y0, r.y1, e.is_vertical()), w.x0 - r.x1),
            _ => ((w.x0, w.x1, r.x0, r.x1, !e.is_vertical()), w.y0 - r.y1),
        };
        let (w0, w1, o0, o1, parallel) = across;
        let behind = parallel && w0 < (o0 + o1) / 2.0 && (o0 + o1) / 2.0 < w1 && gap > -BACK_M;
        behind.then_some(gap.max(0.0))
    });
    Some(gaps.reduce(f64::min).unwrap_or(f64::from(u8::MAX)))
}

pub fn clearance(c: &Context, out: &mut Findings) {
    for room in &c.rooms {
        // what hangs flat on a wall takes nobody's floor
        let blocks = |o: &&Object| o.blocks && !is_shallow(o.placement);
        let blocking: Vec<&Object> = c.objects_in(&room.plan.room_id).filter(blocks).collect();
        for object in &blocking {
            let p = object.placement;
            let Some(kind) = object.kind.filter(|k| k.clearance_front_m > 0.0 && p.mount == Mount::Floor) else {
                continue;
            };
            out.look();
            let others = blocking.iter().filter(|o| !together(o.placement, p)).map(|o| o.rect);
            let depth = free_depth(p, Side::Front, &room.plan.net_polygon, others);
            let needed = kind.clearance_front_m * USABLE_SHARE;
            // what faces its own group (a chair at its desk) is reached from behind or the side
            let tucked = p.group.is_some() && blocking.iter().any(|o| o.placement.group == p.group && in_front(p, o));
            if depth < needed - 0.01 && !tucked {
                let message = format!("has {depth:.2} m free in front, needs {needed:.2} m to be used");
                out.add_figure(&p.placement_id, message, depth, needed, "m");
            }
        }
    }
}

fn together(a: &Placement, b: &Placement) -> bool {
    a.placement_id == b.placement_id || (a.group.is_some() && a.group == b.group)
}

/// Returns true when the other object lies ahead of this one.
fn in_front(p: &Placement, other: &Object) -> bool {
    let (dx, dy) = HEADINGS[usize::from(quarter(p.pose.yaw_rad) % 4)];
    let center = other.rect.center();
    other.placement.placement_id != p.placement_id
        && dx * (center.x - p.pose.x) + dy * (center.y - p.pose.y) > p.size_m[1] / 2.0
}
