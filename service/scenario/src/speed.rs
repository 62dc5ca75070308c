//! Slow floor: before rooms that people sleep in, where corridors cross, at counters.

use d3dgen_knowledge::freespace::FreeSpace;
use d3dgen_model::domain::{RobotUse, Shape, Zone};
use d3dgen_model::floorplan::Door;
use d3dgen_model::scenario::{Roi, RoiKind};
use d3dgen_model::{Polygon, Rect};

use super::floor::{Floor, Room, floor_in_front, lane};
use super::points::served;
use super::regions::clipped;

/// Speed on slow floor, m/s: that of a small delivery robot among people (rule `tinyrobot_max_speed`, Open-RMF `rmf_demos`).
const SLOW_M_S: f64 = 0.5;
/// Speed where there is too little beside the robot, m/s (rule `hazard_zone_speed`, ISO 3691-4).
const CREEP_M_S: f64 = 0.3;
/// Floor on both sides of a robot on which a person gets out of its way, m (rule `side_clearance_to_fixed_objects`).
const ESCAPE_M: f64 = 0.5;
/// Slow floor on both sides of a door, m, and how deep it is: in circulation from wall to wall of usual corridors.
const BESIDE_M: f64 = 0.5;
const DEPTH_M: f64 = 1.5;
const ACROSS_M: f64 = 3.0;
/// Widest corridor that has crossings, m, and how far it must go on beyond one.
const WIDEST_M: f64 = 4.0;
const BEYOND_M: f64 = 1.0;
/// Difference that is none, m.
const SAME_M: f64 = 0.01;

/// A slow area before it has a name.
struct Slow<'f> {
    room: &'f Room<'f>,
    rect: Rect,
    /// Rooms it lies before.
    before: Vec<&'f str>,
    note: String,
}

/// Returns all slow floor of a storey, room by room.
pub(crate) fn all(floor: &Floor) -> Vec<Roi> {
    let mut out = Vec::new();
    for room in floor.rooms.iter().filter(|r| !r.keep_out) {
        let mut slow = joined(before_doors(floor, room));
        let crossings = crossings(room);
        let known = |r: &Rect| slow.iter().any(|s| s.rect.grown(SAME_M).contains(r));
        let new: Vec<Rect> = crossings.into_iter().filter(|r| !known(r)).collect();
        let note = || String::from("where corridors cross");
        slow.extend(new.into_iter().map(|rect| Slow { room, rect, before: Vec::new(), note: note() }));
        slow.extend(at_counter(floor, room));
        out.extend(slow.into_iter().enumerate().map(|(i, s)| s.into_roi(floor, i)));
        out.extend(asked_for(room));
    }
    out
}

impl Slow<'_> {
    fn into_roi(self, floor: &Floor, number: usize) -> Roi {
        let id = &self.room.plan.room_id;
        let across = self.rect.width().min(self.rect.height());
        let tight = self.room.plan.circulation && across < 2.0 * (floor.radius + ESCAPE_M);
        let speed = if tight { CREEP_M_S } else { SLOW_M_S };
        let why = if tight { format!("; less than {ESCAPE_M} m is left beside a robot") } else { String::new() };
        let what = match self.before.len() {
            0 => self.note,
            1 => format!("before {}", self.before[0]),
            n => format!("before {} and {} more", self.before[0], n - 1),
        };
        let polygon = Polygon(self.rect.corners().to_vec());
        let roi = Roi::new(format!("speed_zone_{id}_{}", number + 1), RoiKind::SpeedZone, id, polygon, what + &why);
        Roi { max_speed_m_s: Some(self.room.max_speed_m_s.map_or(speed, |most| most.min(speed))), ..roi }
    }
}

/// Returns all of a room where the prompt says how fast robots drive.
fn asked_for(room: &Room) -> Option<Roi> {
    let id = &room.plan.room_id;
    let polygon = room.plan.net_polygon.clone();
    let roi = Roi::new(format!("speed_zone_{id}"), RoiKind::SpeedZone, id, polygon, "as the prompt asks".into());
    Some(Roi { max_speed_m_s: Some(room.max_speed_m_s?), ..roi })
}

/// Returns the floor in a room before the doors of others that people sleep in.
fn before_doors<'f>(floor: &'f Floor, room: &'f Room) -> Vec<Slow<'f>> {
    let passed = room.plan.circulation || matches!(room.kind.zone, Zone::Day | Zone::Public);
    let depth = if room.plan.circulation { ACROSS_M } else { DEPTH_M };
    let doors = floor.plan.doors_of(&room.plan.room_id).filter(|_| passed);
    let slow = doors.filter_map(|door| {
        let other = door.room_ids.iter().find(|id| **id != room.plan.room_id)?;
        let other = floor.rooms.iter().find(|r| &r.plan.room_id == other)?;
        if other.kind.zone != Zone::Night || other.plan.circulation {
            return None;
        }
        let rect = clipped(room, &around(door, depth))?.bounds();
        Some(Slow { room, rect, before: vec![&other.plan.room_id], note: String::new() })
    });
    slow.collect()
}

/// Returns the floor before and behind a door, and a little beside it.
fn around(door: &Door, depth: f64) -> Rect {
    let r = lane(door, depth);
    match door.line.is_vertical() {
        true => Rect { y0: r.y0 - BESIDE_M, y1: r.y1 + BESIDE_M, ..r },
        false => Rect { x0: r.x0 - BESIDE_M, x1: r.x1 + BESIDE_M, ..r },
    }
}

/// Joins what overlaps and is as long, or as deep, as each other.
fn joined(mut slow: Vec<Slow>) -> Vec<Slow> {
    let near = |a: f64, b: f64| (a - b).abs() < SAME_M;
    let joins = |a: &Rect, b: &Rect| {
        let row = near(a.y0, b.y0) && near(a.y1, b.y1) || near(a.x0, b.x0) && near(a.x1, b.x1);
        row && a.grown(SAME_M).overlaps(b) || a.contains(b) || b.contains(a)
    };
    let mut i = 0;
    while i < slow.len() {
        let Some(j) = (i + 1..slow.len()).find(|&j| joins(&slow[i].rect, &slow[j].rect)) else {
            i += 1;
            continue;
        };
        let other = slow.remove(j);
        slow[i].rect = slow[i].rect.union(&other.rect);
        slow[i].before.extend(other.before);
        slow[i].before.dedup();
        i = 0;
    }
    slow
}

/// Returns where two stretches of a corridor cross or meet.
fn crossings(room: &Room) -> Vec<Rect> {
    if !room.plan.circulation || room.plan.net_polygon.corners().len() <= 4 {
        return Vec::new();
    }
    let space = FreeSpace::new(&room.plan.net_polygon, &[]);
    let along = |r: &&Rect| r.height() <= WIDEST_M && r.width() > r.height();
    let up = |r: &&Rect| r.width() <= WIDEST_M && r.height() > r.width();
    let mut out: Vec<Rect> = Vec::new();
    for a in space.rects.iter().filter(along) {
        for b in space.rects.iter().filter(up) {
            let c = Rect { x0: a.x0.max(b.x0), y0: a.y0.max(b.y0), x1: a.x1.min(b.x1), y1: a.y1.min(b.y1) };
            let goes_on = (c.x0 - a.x0).max(a.x1 - c.x1).min((c.y0 - b.y0).max(b.y1 - c.y1)) >= BEYOND_M;
            let is_area = c.x1 > c.x0 + SAME_M && c.y1 > c.y0 + SAME_M;
            if is_area && goes_on && !out.iter().any(|o| o.overlaps(&c)) {
                out.push(c);
            }
        }
    }
    out
}

/// Returns the floor where people stand at the counter of a room for visitors or staff.
fn at_counter<'f>(floor: &Floor, room: &'f Room) -> Option<Slow<'f>> {
    if !matches!(room.kind.zone, Zone::Public | Zone::Staff) {
        return None;
    }
    let (counter, _) =
        served(floor, room).filter(|(_, kind)| kind.shape == Shape::Counter && room.is_for(RobotUse::Service))?;
    let rect = clipped(room, &floor_in_front(counter, DEPTH_M, BESIDE_M))?.bounds();
    Some(Slow { room, rect, before: Vec::new(), note: format!("at {}", counter.placement_id) })
}
