//! One line of equal units across the way out: tills, ticket gates, security lanes. Who leaves comes through between them.

use std::rc::Rc;

use super::rows::{Batch, Terms};
use super::{Rule, Tally};
use crate::demand::Task;
use crate::space::{DoorZone, Space};
use crate::state::{Placed, State, at_frame};
use crate::style::grain;
use crate::unit::Unit;

/// Floor between the wall of the way out and the line, mm: who has paid packs there and who comes in passes.
const TO_WALL: [i32; 5] = [2800, 2400, 2000, 3400, 1600];
/// Narrowest lane between two units, mm: a wheelchair and a shopping cart pass (ADA 904.3.1 and 403.5.1: 36 in).
const LANE: i32 = 920;
/// What each unit counts that finds a place, and what a line loses for each meter that it is away from its door.
const EACH: f64 = 8.0;
const ASIDE: f64 = 0.3;
/// Lines handed to the search.
const KEPT: usize = 6;

/// Returns lines of a task's units before the ways out of the room, best first; each position holds, routes not looked at.
pub(crate) fn lines_at_exit<'a>(
    state: &State<'a, '_>,
    task: &Task,
    index: usize,
    unit: &Rc<Unit<'a>>,
    terms: &Terms,
    tally: &mut Tally,
) -> Vec<Batch<'a>> {
    let lane = LANE.max(terms.robot).max(unit.bbox.y0 - unit.reach.y0).max(unit.reach.y1 - unit.bbox.y1);
    let mut out = Vec::new();
    for (nth, door) in ways_out(state.space).enumerate() {
        for (far, to_wall) in TO_WALL.into_iter().enumerate() {
            for start in starts(state.space, door, unit, lane, task.count as i32) {
                let line = Line { door, to_wall, start, lane };
                let placed = line.set_up(state, task, index, unit, tally);
                if placed.is_empty() {
                    continue;
                }
                let share = placed.len() as f64 / f64::from(task.count.max(1));
                let aside = f64::from(line.off_door(unit, task.count as i32)) / 1000.0;
                let noise = 0.2 * grain(terms.salt, far as i64, i64::from(start));
                let score = EACH * (share - 1.0) - ASIDE * aside - nth as f64 - 0.2 * far as f64 + noise;
                out.push(Batch { placed, in_pairs: false, score });
            }
        }
    }
    out.sort_by(|a, b| b.score.total_cmp(&a.score));
    out.truncate(KEPT);
    out
}

/// Returns the doors by which one leaves, the one that leads out most directly first.
fn ways_out(space: &Space) -> impl Iterator<Item = &DoorZone> {
    let best = space.doors.iter().map(|d| d.rank).min();
    space.doors.iter().filter(move |d| Some(d.rank) == best)
}

/// Returns where along the wall of a door a line may begin: before it, beside it, at the ends of the wall.
fn starts(space: &Space, door: &DoorZone, unit: &Unit, lane: i32, count: i32) -> Vec<i32> {
    let wall = &space.walls[door.wall];
    let length = count * unit.bbox.height() + (count - 1) * lane;
    let middle = (door.v0 + door.v1 - length) / 2;
    let mut out = vec![middle, wall.v0 + lane, wall.v1 - lane - length, wall.v0 + 50, wall.v1 - 50 - length];
    out.iter_mut().for_each(|v| *v = (*v).clamp(wall.v0, (wall.v1 - length).max(wall.v0)) / 50 * 50);
    out.dedup();
    out
}

/// Units side by side, in the frame of the wall of a way out; lengths in mm.
struct Line<'d> {
    door: &'d DoorZone,
    to_wall: i32,
    start: i32,
    lane: i32,
}

impl Line<'_> {
    /// Returns how far the middle of the line is from that of the door, along its wall.
    fn off_door(&self, unit: &Unit, count: i32) -> i32 {
        let length = count * unit.bbox.height() + (count - 1) * self.lane;
        ((self.door.v0 + self.door.v1 - length) / 2 - self.start).abs()
    }

    /// Places the units of the line that break no rule.
    fn set_up<'a>(
        &self,
        state: &State<'a, '_>,
        task: &Task,
        index: usize,
        unit: &Rc<Unit<'a>>,
        tally: &mut Tally,
    ) -> Vec<Placed<'a>> {
        let wall = &state.space.walls[self.door.wall];
        let b = unit.bbox;
        let mut out: Vec<Placed> = Vec::new();
        for k in 0..task.count as i32 {
            let v = self.start + k * (b.height() + self.lane);
            // its front to the hall: who comes from there meets it first
            let placed = at_frame(unit, wall.q, wall.u + self.to_wall - b.x0, v - b.y0, index);
            match state.fit(placed, false) {
                Ok(placed) => out.push(placed),
                Err(rule) => tally[rule as usize] += 1,
            }
        }
        if out.is_empty() {
            tally[Rule::NoPlace as usize] += 1;
        }
        out
    }
}
