//! Occupancy map of a plan: white where a robot could stand with no furniture in, black everywhere else.
//!
//! Arena draws doors as free floor and everything outside the rooms as occupied; nav2 reads the same file.

use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::geometry::{Rect, to_mm};
use serde_json::{Value, json};

use crate::error::Error;

/// Edge of a cell, m.
const RESOLUTION_M: f64 = 0.05;
/// Cells of black frame around the rooms.
const PADDING: usize = 5;
/// Largest side, px: 500 m of building.
const LIMIT: usize = 10_000;
const FREE: u8 = 255;
const OCCUPIED: u8 = 0;

/// Returns `map.yaml`.
pub(super) fn yaml(plan: &Floorplan) -> Value {
    let (x0, y0) = origin(bounds(plan));
    json!({
        "image": "map.png", "resolution": RESOLUTION_M, "origin": [to_mm(x0), to_mm(y0), 0.0], "negate": 0,
        "occupied_thresh": 0.9, "free_thresh": 0.1, "mode": "trinary",
    })
}

/// Returns `map.png`, 8-bit gray.
///
/// # Errors
/// `TooLarge` when a side would pass the limit.
pub(super) fn png(plan: &Floorplan) -> Result<Vec<u8>, Error> {
    let picture = "map.png";
    let around = bounds(plan);
    let cells = |extent: f64| (extent / RESOLUTION_M).ceil().max(1.0) as usize + 2 * PADDING;
    let (width, height) = (cells(around.width()), cells(around.height()));
    if width.max(height) > LIMIT {
        return Err(Error::TooLarge { picture, width, height, limit: LIMIT });
    }
    let (x0, y0) = origin(around);
    let mut pixels = vec![OCCUPIED; width * height];
    // Cells whose centers lie between two coordinates.
    let span = |from: f64, to: f64, start: f64, count: usize| {
        let index = |v: f64| ((v - start) / RESOLUTION_M - 0.5 - 1e-6).ceil().clamp(0.0, count as f64) as usize;
        index(from)..index(to)
    };
    let mut paint = |rect: &Rect, value: u8| {
        let columns = span(rect.x0, rect.x1, x0, width);
        for row in span(rect.y0, rect.y1, y0, height) {
            let line = (height - 1 - row) * width;
            pixels[line + columns.start..line + columns.end].fill(value);
        }
    };
    floor_rects(plan).iter().for_each(|rect| paint(rect, FREE));
    let standing = plan.obstacles.iter().flat_map(|o| o.outline.cover(RESOLUTION_M));
    standing.for_each(|rect| paint(&rect, OCCUPIED));
    crate::picture::gray(picture, &pixels, width, height)
}

/// Net floors, and the openings between them through the thickness of their wall.
fn floor_rects(plan: &Floorplan) -> Vec<Rect> {
    let mut rects: Vec<Rect> = plan.rooms.iter().flat_map(|r| r.net_polygon.rects()).collect();
    rects.extend(plan.doors.iter().map(|d| {
        let (a, b, half) = (d.line.start, d.line.end, d.wall_thickness_m / 2.0);
        let around = Rect::new(a.x, a.y, b.x, b.y);
        if d.line.is_vertical() {
            Rect { x0: around.x0 - half, x1: around.x1 + half, ..around }
        } else {
            Rect { y0: around.y0 - half, y1: around.y1 + half, ..around }
        }
    }));
    rects
}

fn bounds(plan: &Floorplan) -> Rect {
    plan.rooms.iter().map(|r| r.polygon.bounds()).reduce(|a, b| a.union(&b)).unwrap_or(Rect::new(0.0, 0.0, 0.0, 0.0))
}

fn origin(around: Rect) -> (f64, f64) {
    let frame = PADDING as f64 * RESOLUTION_M;
    (around.x0 - frame, around.y0 - frame)
}
