//! Rooms that came out with fewer places than they are for: they get more floor before the world says what is missing.

use d3dgen_model::scene_graph::{GraphRoom, Note, Robot, SceneGraph};

use crate::scene_graph::Short;

/// How often rooms grow before what is missing is said: each round plans and furnishes the whole building again.
pub(crate) const ROUNDS: usize = 2;
/// How often plan and furniture are tried in a round, at most.
pub(crate) const ATTEMPTS: u32 = 2;
/// Least and most that a room grows at a time, as factors on its area.
const LEAST: f64 = 1.08;
const MOST: f64 = 2.0;
/// Share of a room's floor that grows with its places, by round: the way in and the stage do not, but where that was too little
/// the rows leave more over than they fill.
const FOR_PLACES: [f64; ROUNDS] = [0.8, 1.1];
/// Least and greatest area of a room that grew, as shares of the one that it aims for.
const NEAR: [f64; 2] = [0.9, 1.3];
/// Code of the note that names the rooms that grew.
const GREW: &str = "rooms_grew";
/// Most over least area up to which the prompt gives the area in figures: such a room stays.
const TOLD: f64 = 1.3;

/// Returns the graph with more floor in the rooms that are short of places, as much as those that did not fit should take;
/// `None` where none of them may grow. `round` counts from 0.
pub(crate) fn with_more_floor(graph: &SceneGraph, short: &[Short], round: usize) -> Option<SceneGraph> {
    // whoever asks for a robot that the rooms are made for is told which one fits
    if graph.robots.iter().any(Robot::is_fitted) {
        return None;
    }
    let mut out = graph.clone();
    let mut grown: Vec<String> = Vec::new();
    let open = |r: &&mut GraphRoom| !r.locked && r.area_range_m2[1] > TOLD * r.area_range_m2[0];
    for room in out.rooms.iter_mut().filter(open) {
        let Some(short) = short.iter().find(|s| s.room_id == room.id) else { continue };
        let ratio = f64::from(short.wanted) / f64::from(short.have.max(1));
        enlarge(room, (1.0 + FOR_PLACES[round] * (ratio - 1.0)).clamp(LEAST, MOST));
        grown.push(room.name.clone());
    }
    if grown.is_empty() {
        return None;
    }
    out.assumptions.retain(|note| note.code != GREW);
    let message = format!("larger than first meant, for the places that were asked for: {}", grown.join(", "));
    out.assumptions.push(Note { code: GREW.into(), message });
    Some(out)
}

/// Makes a room aim for `factor` times its area, and lets it have that.
pub(crate) fn enlarge(room: &mut GraphRoom, factor: f64) {
    let tenth = |area: f64| (10.0 * area).round() / 10.0;
    let [low, high] = room.area_range_m2;
    room.target_area_m2 = tenth(factor * room.target_area_m2);
    let [least, most] = NEAR.map(|share| tenth(share * room.target_area_m2));
    room.area_range_m2 = [low.max(least), high.max(most)];
}

/// Returns how many places the rooms are short of.
pub(crate) fn missing(short: &[Short]) -> u32 {
    short.iter().map(|s| s.wanted.saturating_sub(s.have)).sum()
}
