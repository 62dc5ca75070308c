//! Rules about windows.

use d3dgen_model::Rect;
use d3dgen_model::domain::{Daylight, Shape};
use d3dgen_model::floorplan::Window;

use super::Findings;
use crate::context::{Context, ON_LINE_M, shared, uncovered};

/// Depth in front of a window in which tall things stand in its light, m.
const LIGHT_M: f64 = 0.25;
/// Share of a window that something tall may hide.
const HIDDEN_SHARE: f64 = 0.05;

pub fn misplaced(c: &Context, out: &mut Findings) {
    for window in &c.plan().windows {
        out.look();
        let walls = c.plan().walls.iter().filter(|w| w.exterior && w.room_ids.contains(&window.room_id));
        let off = uncovered(&window.line, walls.map(|w| &w.line), ON_LINE_M);
        if off > ON_LINE_M {
            let message = format!("{off:.2} m of the window lie in no outer wall of `{}`", window.room_id);
            out.add_figure(&window.window_id, message, off, 0.0, "m");
        }
        let ceiling = c.room(&window.room_id).map_or(f64::MAX, |r| r.plan.ceiling_height_m);
        if window.sill_m < 0.0 || window.head_m <= window.sill_m || window.head_m > ceiling {
            out.add(&window.window_id, format!("the window reaches from {} m to {} m", window.sill_m, window.head_m));
        }
    }
}

pub fn overlap(c: &Context, out: &mut Findings) {
    let windows = &c.plan().windows;
    for (i, window) in windows.iter().enumerate() {
        out.look();
        let others = windows[i + 1..].iter().map(|w| (&w.window_id, &w.line));
        let doors = c.plan().doors.iter().map(|d| (&d.door_id, &d.line));
        for (id, line) in others.chain(doors) {
            if let Some((from, to)) = shared(&window.line, line, ON_LINE_M)
                && to - from > ON_LINE_M
            {
                out.add(format!("{}|{id}", window.window_id), format!("they share {:.2} m of wall", to - from));
            }
        }
    }
}

pub fn blocked(c: &Context, out: &mut Findings) {
    for window in &c.plan().windows {
        out.look();
        let strip = light(window);
        for object in c.objects_in(&window.room_id) {
            // daylight falls on flights of stairs; they are no piece of furniture
            let curtain = object.kind.is_some_and(|k| matches!(k.shape, Shape::Curtain | Shape::Stairs));
            let (low, high) = (object.placement.pose.z, object.placement.top_m());
            let in_light = high > window.sill_m + ON_LINE_M && low < window.head_m - ON_LINE_M;
            let hides = object.outline.area_in(&strip) > HIDDEN_SHARE * LIGHT_M * window.line.length();
            if !curtain && in_light && hides {
                let id = &object.placement.placement_id;
                let message = format!("`{id}` is {high:.2} m high in front of a sill at {:.2} m", window.sill_m);
                out.add_figure(format!("{}|{id}", window.window_id), message, high, window.sill_m, "m");
            }
        }
    }
}

/// Returns the floor in front of a window on both sides of its wall; outdoors nothing stands.
fn light(window: &Window) -> Rect {
    let r = window.line.bounds();
    let reach = window.wall_thickness_m / 2.0 + LIGHT_M;
    if window.line.is_vertical() {
        Rect { x0: r.x0 - reach, x1: r.x1 + reach, ..r }
    } else {
        Rect { y0: r.y0 - reach, y1: r.y1 + reach, ..r }
    }
}

pub fn daylight(c: &Context, out: &mut Findings) {
    for room in c.rooms.iter().filter(|r| r.kind.daylight == Daylight::Required) {
        out.look();
        if !c.plan().windows.iter().any(|w| w.room_id == room.plan.room_id) {
            out.add(&room.plan.room_id, "the room needs daylight and has no window");
        }
    }
}
