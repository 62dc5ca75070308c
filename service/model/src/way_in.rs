//! The way into a room that several people come to: floor inside its door, through the narrow part that a room with a corner
//! begins with, to where the room is wide. Furniture, docks and goods keep off it.

use crate::floorplan::Door;
use crate::{Point, Polygon, Rect};

/// Depth of the way inside a door, m, and how far it goes on where the room becomes wide.
const DEPTH_M: f64 = 1.5;
const BEYOND_M: f64 = 0.9;
/// Width of the way where it turns along the wall of the door, m.
const WIDTH_M: f64 = 1.1;
/// Grain of the search, m, and area that is none, m^2.
const STEP_M: f64 = 0.05;
const NONE_M2: f64 = 1e-3;

/// Returns the floor of the way from a door into a room with this net outline; nothing where the door leads elsewhere.
pub fn way_in(outline: &Polygon, door: &Door) -> Vec<Rect> {
    let pieces = outline.rects();
    let inside = |r: &Rect| {
        let covered: f64 = pieces.iter().map(|p| p.common_area(r)).sum();
        r.area() - covered < NONE_M2
    };
    let Some(main) = largest(outline, &inside) else { return Vec::new() };
    let vertical = door.line.is_vertical();
    let a = door.line.start;
    let opening = door.line.bounds();
    let face = door.wall_thickness_m / 2.0;
    let strip = |sign: f64, from: f64, to: f64| {
        let (from, to) = (sign * from, sign * to);
        match vertical {
            true => Rect { x0: a.x + from.min(to), x1: a.x + from.max(to), ..opening },
            false => Rect { y0: a.y + from.min(to), y1: a.y + from.max(to), ..opening },
        }
    };
    let Some(sign) = [1.0, -1.0].into_iter().find(|s| inside(&strip(*s, face, face + STEP_M))) else {
        return Vec::new();
    };
    let slice = |k: u32| strip(sign, face + f64::from(k) * STEP_M, face + f64::from(k + 1) * STEP_M);
    let run = (0..).take_while(|k| inside(&slice(*k))).count() as u32;
    let wide = (0..run).find(|k| slice(*k).common_area(&main) > slice(*k).area() - NONE_M2);
    if let Some(wide) = wide {
        let far = f64::from(wide) * STEP_M;
        let depth = DEPTH_M.max(far + if wide > 0 { BEYOND_M } else { 0.0 });
        return vec![strip(sign, face, face + depth.min(f64::from(run) * STEP_M))];
    }
    let depth = WIDTH_M.min(f64::from(run) * STEP_M);
    let first = strip(sign, face, face + depth);
    // around the corner, along the wall of the door
    let turned = match vertical {
        true if main.y0 > first.y1 => Rect { y0: first.y1, y1: main.y0 + BEYOND_M, ..first },
        true => Rect { y0: main.y1 - BEYOND_M, y1: first.y0, ..first },
        false if main.x0 > first.x1 => Rect { x0: first.x1, x1: main.x0 + BEYOND_M, ..first },
        false => Rect { x0: main.x1 - BEYOND_M, x1: first.x0, ..first },
    };
    let turns = turned.width() > 0.0 && turned.height() > 0.0 && inside(&turned);
    [first].into_iter().chain(turns.then_some(turned)).collect()
}

/// Returns the largest rectangle inside an outline.
fn largest(outline: &Polygon, inside: &dyn Fn(&Rect) -> bool) -> Option<Rect> {
    let list = |of: &dyn Fn(&Point) -> f64| {
        let mut all: Vec<f64> = outline.corners().iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    };
    let (xs, ys) = (list(&|p| p.x), list(&|p| p.y));
    let pairs = |all: &[f64]| -> Vec<(f64, f64)> {
        all.iter().enumerate().flat_map(|(i, a)| all[i + 1..].iter().map(|b| (*a, *b))).collect()
    };
    let (wide, high) = (pairs(&xs), pairs(&ys));
    let all = wide.iter().flat_map(|(x0, x1)| high.iter().map(|(y0, y1)| Rect { x0: *x0, y0: *y0, x1: *x1, y1: *y1 }));
    all.filter(|r| inside(r)).max_by(|a, b| a.area().total_cmp(&b.area()))
}
