//! Rules about what joins the storeys of a building.

use std::collections::BTreeSet;

use d3dgen_model::Rect;
use d3dgen_model::floorplan::PlanRoom;
use d3dgen_model::measures::MOST_OVERHANG;
use d3dgen_model::storeys::{LinkKind, VerticalLink};

use super::Findings;
use crate::context::Context;

/// How far the outlines of a stairwell or shaft may lie apart from storey to storey, m.
const OFFSET_M: f64 = 0.05;

fn rooms<'c>(c: &'c Context, link: &'c VerticalLink) -> impl Iterator<Item = &'c PlanRoom> {
    link.room_ids.iter().filter_map(|id| c.plan().room(id))
}

fn joins(c: &Context, kind: LinkKind, a: i32, b: i32) -> bool {
    let has = |link: &VerticalLink, level: i32| rooms(c, link).any(|r| r.level == level);
    c.plan().links.iter().any(|l| l.kind == kind && has(l, a) && has(l, b))
}

pub fn stairs(c: &Context, out: &mut Findings) {
    for pair in c.plan().level_numbers().windows(2) {
        out.look();
        if !joins(c, LinkKind::Stairs, pair[0], pair[1]) {
            out.add(format!("level {}", pair[1]), format!("no stairs lead from it to level {}", pair[0]));
        }
    }
}

pub fn offset(c: &Context, out: &mut Findings) {
    for link in &c.plan().links {
        let all: Vec<&PlanRoom> = rooms(c, link).collect();
        let Some(first) = all.first() else { continue };
        for room in &all[1..] {
            out.look();
            let (a, b) = (first.polygon.bounds(), room.polygon.bounds());
            let off =
                [a.x0 - b.x0, a.y0 - b.y0, a.x1 - b.x1, a.y1 - b.y1].map(f64::abs).into_iter().fold(0.0, f64::max);
            if off > OFFSET_M + d3dgen_model::TOLERANCE_M {
                let message = format!("lies {off:.2} m off `{}`, which it leads to", first.room_id);
                out.add_figure(&room.room_id, message, off, OFFSET_M, "m");
            }
            // the car's door is in one place
            let door = |r: &PlanRoom| c.plan().doors_of(&r.room_id).next().map(|d| d.line.middle());
            let apart = door(first).zip(door(room)).map_or(0.0, |(a, b)| a.distance(b));
            if link.kind == LinkKind::Elevator && apart > OFFSET_M + d3dgen_model::TOLERANCE_M {
                let message = format!("its door is {apart:.2} m off that of `{}`, one car has both", first.room_id);
                out.add_figure(&room.room_id, message, apart, OFFSET_M, "m");
            }
        }
    }
}

pub fn closed(c: &Context, out: &mut Findings) {
    for room in c.plan().links.iter().flat_map(|l| rooms(c, l)) {
        out.look();
        if c.plan().doors_of(&room.room_id).next().is_none() {
            out.add(&room.room_id, "no door or opening leads into it");
        }
    }
}

pub fn elevator(c: &Context, out: &mut Findings) {
    let Some(rules) = c.domain.circulation.storeys.as_ref().and_then(|s| s.elevator.as_ref()) else { return };
    let levels = c.plan().level_numbers();
    let usual = rules.from_levels.is_some_and(|n| levels.len() >= n as usize);
    // what was ruled out, or not asked for where it must be asked for, has no link in the scene graph
    let asked = c.graph().accessible || c.graph().links.iter().any(|l| l.kind == LinkKind::Elevator);
    let ruled_out = c.graph().assumptions.iter().any(|n| n.code == "no_elevator");
    if !(usual || asked) || ruled_out {
        return;
    }
    for pair in levels.windows(2) {
        out.look();
        if !joins(c, LinkKind::Elevator, pair[0], pair[1]) {
            out.add(format!("level {}", pair[1]), format!("no elevator goes from it to level {}", pair[0]));
        }
    }
}

pub fn overhang(c: &Context, out: &mut Findings) {
    let plan = c.plan();
    let floor = |level: i32| {
        let here = plan.rooms.iter().filter(move |r| r.level == level);
        here.flat_map(|r| r.polygon.rects()).collect::<Vec<Rect>>()
    };
    for pair in plan.level_numbers().windows(2).filter(|pair| pair[0] >= 0) {
        out.look();
        let (lower, upper) = (floor(pair[0]), floor(pair[1]));
        let without = |free: Vec<Rect>, cut: &Rect| free.iter().flat_map(|f| f.without(cut)).collect();
        let free = lower.iter().fold(upper.clone(), without);
        let area = |rects: &[Rect]| rects.iter().map(Rect::area).sum::<f64>();
        let share = area(&free) / area(&upper).max(1.0);
        if share > MOST_OVERHANG {
            let message = format!("{:.0} % of it has nothing of level {} below it", 100.0 * share, pair[0]);
            out.add_figure(format!("level {}", pair[1]), message, share, MOST_OVERHANG, "ratio");
        }
    }
}

pub fn reach(c: &Context, out: &mut Findings) {
    let plan = c.plan();
    let mut reached: BTreeSet<&str> = BTreeSet::new();
    let mut open: Vec<&str> = plan
        .ways_out()
        .into_iter()
        .flat_map(|d| d.room_ids.iter().map(String::as_str))
        .filter(|id| plan.room(id).is_some_and(|r| r.level == 0))
        .collect();
    while let Some(id) = open.pop() {
        if !reached.insert(id) {
            continue;
        }
        open.extend(plan.doors_of(id).flat_map(|d| d.room_ids.iter().map(String::as_str)));
        let links = plan.links.iter().filter(|l| l.kind == LinkKind::Stairs);
        open.extend(
            links.filter(|l| l.room_ids.iter().any(|r| r == id)).flat_map(|l| l.room_ids.iter().map(String::as_str)),
        );
    }
    for room in &plan.rooms {
        out.look();
        if !reached.contains(room.room_id.as_str()) {
            out.add(&room.room_id, "no way leads to it from the entrance");
        }
    }
}
