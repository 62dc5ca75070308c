//! Rules about room outlines and names.

use std::collections::BTreeSet;

use d3dgen_model::{Point, Polygon, Pose, Segment};

use super::Findings;
use crate::context::Context;

/// Floor that two rooms may share by rounding, m^2.
const OVERLAP_M2: f64 = 0.01;

pub fn not_finite(c: &Context, out: &mut Findings) {
    let plan = c.plan();
    let point = |p: &Point| p.x.is_finite() && p.y.is_finite();
    let polygon = |p: &Polygon| p.corners().iter().all(point);
    let line = |s: &Segment| point(&s.start) && point(&s.end);
    let pose = |p: &Pose| p.x.is_finite() && p.y.is_finite() && p.z.is_finite() && p.yaw_rad.is_finite();
    let mut look = |id: &str, finite: bool| {
        out.look();
        if !finite {
            out.add(id, format!("`{id}` has a coordinate that is not a number"));
        }
    };
    for r in &plan.rooms {
        let sizes = r.net_area_m2.is_finite() && r.ceiling_height_m.is_finite();
        look(&r.room_id, polygon(&r.polygon) && polygon(&r.net_polygon) && sizes);
    }
    plan.walls.iter().for_each(|w| look(&w.wall_id, line(&w.line) && w.thickness_m.is_finite()));
    plan.doors.iter().for_each(|d| {
        let sizes = [d.clear_width_m, d.height_m, d.wall_thickness_m];
        look(&d.door_id, line(&d.line) && sizes.iter().all(|v| v.is_finite()));
    });
    plan.windows.iter().for_each(|w| {
        let sizes = [w.sill_m, w.head_m, w.wall_thickness_m];
        look(&w.window_id, line(&w.line) && sizes.iter().all(|v| v.is_finite()));
    });
    for p in &c.world.placements.placements {
        look(&p.placement_id, pose(&p.pose) && p.size_m.iter().all(|v| v.is_finite()));
    }
    let scenario = &c.world.scenario;
    scenario.pois.iter().for_each(|p| look(&p.poi_id, pose(&p.pose)));
    scenario.agents.iter().for_each(|a| look(&a.agent_id, pose(&a.start)));
    scenario.robots.iter().for_each(|r| look(&r.robot_id, pose(&r.start)));
    scenario.rois.iter().for_each(|r| look(&r.roi_id, polygon(&r.polygon)));
}

pub fn invalid(c: &Context, out: &mut Findings) {
    if c.rooms.is_empty() {
        out.add("building", "the plan has no room");
    }
    for room in &c.rooms {
        out.look();
        for outline in [&room.plan.polygon, &room.plan.net_polygon] {
            if outline.corners().len() < 3 || outline.area() < 1e-6 {
                out.add(&room.plan.room_id, "the outline encloses no area");
            } else if !outline.is_simple() {
                out.add(&room.plan.room_id, "the outline crosses or touches itself");
            }
        }
    }
}

pub fn clockwise(c: &Context, out: &mut Findings) {
    for room in &c.rooms {
        out.look();
        for outline in [&room.plan.polygon, &room.plan.net_polygon] {
            let corners = outline.corners();
            if outline.signed_area() <= 0.0 {
                out.add(&room.plan.room_id, "the outline runs clockwise");
            }
            if corners.len() > 1 && corners.first() == corners.last() {
                out.add(&room.plan.room_id, "the outline repeats its first corner");
            }
        }
    }
}

pub fn overlap(c: &Context, out: &mut Findings) {
    for (i, a) in c.rooms.iter().enumerate() {
        for b in &c.rooms[i + 1..] {
            out.look();
            let area: f64 = a.rects.iter().flat_map(|r| b.rects.iter().map(move |s| r.common_area(s))).sum();
            if area > OVERLAP_M2 {
                let subject = format!("{}|{}", a.plan.room_id, b.plan.room_id);
                out.add_figure(subject, format!("the rooms share {area:.2} m2"), area, OVERLAP_M2, "m^2");
            }
        }
    }
}

pub fn net(c: &Context, out: &mut Findings) {
    for room in &c.rooms {
        out.look();
        let area = room.plan.net_polygon.area();
        let inside: f64 = room.net.iter().flat_map(|r| room.rects.iter().map(move |s| r.common_area(s))).sum();
        if area - inside > 1e-3 {
            out.add_figure(&room.plan.room_id, "the net outline reaches beyond the outline", area - inside, 0.0, "m^2");
        }
        if (area - room.plan.net_area_m2).abs() > 0.01 {
            let message =
                format!("the stated net area is {:.2} m2, the outline has {area:.2} m2", room.plan.net_area_m2);
            out.add_figure(&room.plan.room_id, message, room.plan.net_area_m2, area, "m^2");
        }
    }
}

pub fn names(c: &Context, out: &mut Findings) {
    let plan = c.plan();
    let ids = plan.rooms.iter().map(|r| &r.room_id).chain(plan.doors.iter().map(|d| &d.door_id));
    let ids = ids.chain(plan.windows.iter().map(|w| &w.window_id));
    let ids = ids.chain(c.world.placements.placements.iter().map(|p| &p.placement_id));
    let mut seen = BTreeSet::new();
    for id in ids {
        out.look();
        if !seen.insert(id) {
            out.add(id, format!("`{id}` names two things"));
        }
    }
}
