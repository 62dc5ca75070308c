//! Lifts of Open-RMF: a car and its doors, placed on the level of reference, drawn on every level where it has doors.

use std::collections::BTreeMap;

use d3dgen_model::Point;
use serde::Deserialize;
use serde_json::Value;

use super::{FORMAT, Frame};
use crate::drawing::{Drawing, DrawnCabin, note};
use crate::error::Error;

/// A lift: the middle of its car in units of a level, all else in meters and radians.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Lift {
    x: f64,
    y: f64,
    #[serde(default)]
    yaw: f64,
    width: f64,
    depth: f64,
    reference_floor_name: String,
    #[serde(default)]
    doors: BTreeMap<String, Door>,
    /// Doors that open on each level.
    #[serde(default)]
    level_doors: BTreeMap<String, Vec<String>>,
}

/// A door of a car: its middle as the car sees it, m.
#[derive(Debug, Clone, Deserialize)]
struct Door {
    x: f64,
    y: f64,
    width: f64,
    #[serde(default)]
    motion_axis_orientation: f64,
}

/// Reads a lift.
///
/// # Errors
/// `Broken` with its name.
pub(super) fn read((name, value): (&String, &Value)) -> Result<(String, Lift), Error> {
    let place = || format!("lifts/{name}");
    let lift: Lift =
        serde_json::from_value(value.clone()).map_err(|e| Error::broken(FORMAT, place(), e.to_string()))?;
    let sizes = [lift.width, lift.depth];
    if !sizes.iter().all(|s| (0.3..=20.0).contains(s)) {
        let message = format!("its car is {} m by {} m; cars have 0.3 to 20 m", lift.width, lift.depth);
        return Err(Error::broken(FORMAT, place(), message));
    }
    Ok((name.clone(), lift))
}

/// Draws the car and its doors on the levels where it has some.
pub(super) fn draw(drawing: &mut Drawing, name: &str, lift: &Lift, frames: &BTreeMap<&str, Frame>) {
    let Some(frame) = frames.get(lift.reference_floor_name.as_str()) else {
        let message = format!("lift {name} refers to level `{}`, which is not there", lift.reference_floor_name);
        drawing.notes.push(note("lift_left_out", message));
        return;
    };
    if !lift.level_doors.keys().any(|level| frames.contains_key(level.as_str())) {
        drawing.notes.push(note("lift_left_out", format!("lift {name} has no doors on any level; it was left out")));
        return;
    }
    let middle = frame.at(lift.x, lift.y);
    let turned = |x: f64, y: f64, yaw: f64| {
        let (sin, cos) = (yaw + frame.shift.angle_rad()).sin_cos();
        Point::new(x * cos - y * sin, x * sin + y * cos)
    };
    let placed = |x: f64, y: f64| {
        let p = turned(x, y, lift.yaw);
        Point::new(middle.x + p.x, middle.y + p.y)
    };
    let (w, d) = (lift.width / 2.0, lift.depth / 2.0);
    let corners = [(-w, -d), (w, -d), (w, d), (-w, d)].map(|(x, y)| placed(x, y));
    let door = |door: &Door| {
        let (at, half) = (placed(door.x, door.y), door.width / 2.0);
        let along = turned(half, 0.0, lift.yaw + door.motion_axis_orientation);
        [Point::new(at.x - along.x, at.y - along.y), Point::new(at.x + along.x, at.y + along.y)]
    };
    for (level, doors) in lift.level_doors.iter().filter(|(level, _)| frames.contains_key(level.as_str())) {
        let doors = doors.iter().filter_map(|id| lift.doors.get(id)).map(door).collect();
        drawing.cabins.push(DrawnCabin { name: name.to_owned(), corners, doors, level: Some(level.clone()) });
    }
}
