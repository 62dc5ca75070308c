//! Doors to courts: ground with the building all around that nobody can enter is of use to nobody. They are no ways out.

use std::collections::BTreeSet;

use d3dgen_model::domain::Zone;
use d3dgen_model::floorplan::Door;
use d3dgen_model::scene_graph::Note;

use super::super::lattice::{meters, up};
use super::super::outline::{Mosaic, Stretch};
use super::super::spec::Brief;
use super::spot::Spot;
use super::{BETWEEN_DOORS_M, Laid, Site};
use crate::measures::LEAST_WALL_M;

/// Area from which on a court has two doors, on center lines, m^2.
const LARGE_COURT_M2: f64 = 150.0;
/// What it costs that a door to a court leads there from a room and not from a corridor, and from one that is not for all.
const FROM_ROOM: f64 = 20.0;
/// Wall in the middle of which a door to a court stands best, m, and what each meter less of it costs.
const ROOMY_WALL_M: f64 = 10.0;
const LESS_WALL: f64 = 0.1;
/// What a meter is worth by which the second door to a court is farther from the first.
const APART: f64 = 0.2;

impl Site<'_> {
    /// Places a door to each court, two to a large one: from a corridor that borders it, else from a room for all.
    pub(super) fn lay_court_doors(&self, laid: &mut Laid) {
        let courts: BTreeSet<usize> = self.stretches.iter().filter_map(|s| s.court).collect();
        if courts.is_empty() {
            return;
        }
        let shafts = Mosaic::new(self.boxes).shafts(up(self.brief.court_width));
        for court in courts.difference(&shafts).copied() {
            let around: Vec<&Stretch> = self.stretches.iter().filter(|s| s.court == Some(court)).collect();
            let rooms: BTreeSet<usize> = around.iter().filter_map(|s| s.only_room()).collect();
            let count = if area_m2(&around) >= LARGE_COURT_M2 { 2 } else { 1 };
            let standing = |room: &usize| self.standing_spots(&[*room], false, Some(court)).collect::<Vec<_>>();
            let mut placed: Vec<Spot> = rooms.iter().flat_map(standing).take(count).collect();
            for spot in &placed {
                laid.take_best(vec![spot.clone()]);
            }
            while placed.len() < count {
                let away = |spot: &Spot| {
                    let ways = placed.iter().map(|p| p.door.line.middle().distance(spot.door.line.middle()));
                    ways.reduce(f64::min)
                };
                let mut spots: Vec<Spot> = around.iter().flat_map(|s| self.court_spots(s)).collect();
                spots.retain(|spot| away(spot).is_none_or(|way| way >= BETWEEN_DOORS_M));
                spots.iter_mut().for_each(|spot| spot.penalty -= APART * away(spot).unwrap_or(0.0));
                if !laid.take_best(spots) {
                    break;
                }
                placed.extend(laid.spots.last().cloned());
            }
        }
    }

    /// Returns the places for a door from a stretch to the court on its other side: in the middle of a corridor's wall, at the
    /// ends of a room's, which keeps its window.
    fn court_spots(&self, s: &Stretch) -> Vec<Spot> {
        let Some((room, penalty_of)) = s.only_room().and_then(|room| Some((room, self.penalty_of(room)?))) else {
            return Vec::new();
        };
        let clear = self.brief.entrance_width;
        let opening = Brief::opening(clear);
        let (from, to) = self.usable(s);
        let window = if self.brief.rooms[room].circulation { 0.0 } else { LEAST_WALL_M };
        if to - from < opening + window - 1e-9 {
            return Vec::new();
        }
        let starts = if window > 0.0 { vec![from, to - opening] } else { vec![(from + to - opening) / 2.0] };
        let penalty = penalty_of + LESS_WALL * (ROOMY_WALL_M - (to - from)).max(0.0);
        starts.into_iter().filter_map(|start| self.outward_spot(s, room, (start, clear), penalty)).collect()
    }

    /// Returns what a door from a room to a court costs beside one from a corridor; `None` for rooms that are private.
    fn penalty_of(&self, room: usize) -> Option<f64> {
        let spec = &self.brief.rooms[room];
        match spec.zone {
            _ if spec.circulation => (!spec.fixed).then_some(0.0),
            Zone::Day | Zone::Public if spec.public => Some(FROM_ROOM),
            Zone::Day | Zone::Public if !spec.private => Some(2.0 * FROM_ROOM),
            _ => None,
        }
    }
}

/// Says so where a court has no door.
pub(in super::super) fn shut_courts(stretches: &[Stretch], doors: &[Door]) -> Option<Note> {
    let courts: BTreeSet<usize> = stretches.iter().filter_map(|s| s.court).collect();
    let on = |d: &Door, s: &Stretch| {
        let (at, from, to) = d.line.span();
        let along = meters(s.from) <= from && to <= meters(s.to);
        s.vertical == d.line.is_vertical() && (meters(s.at) - at).abs() < 1e-6 && along
    };
    let is_shut = |court: &usize| {
        !stretches.iter().filter(|s| s.court == Some(*court)).any(|s| doors.iter().any(|door| on(door, s)))
    };
    courts.iter().any(is_shut).then(|| Note {
        code: "court_without_door".into(),
        message: "a court has no door: only private rooms border it, or no wall there is long enough".into(),
    })
}

/// Returns the area of a court from the walls around it, m^2.
fn area_m2(around: &[&Stretch]) -> f64 {
    let upright = around.iter().filter(|s| s.vertical);
    // the court is on the side without a room
    let share = |s: &&&Stretch| if s.low.is_none() { meters(s.at) } else { -meters(s.at) };
    upright.map(|s| share(&s) * meters(s.len())).sum()
}
