//! Short tours: in which order a robot visits places, by how far it drives from one to the next.
//!
//! Distances go from door to door through the rooms, straight within a room. The nearest place is next, and what can be
//! turned around to make the tour shorter is (2-opt). Rooms with clean goods come first and those with soiled ones last.

use std::collections::BTreeMap;

use d3dgen_model::Point;
use d3dgen_model::domain::Goods;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::scenario::Poi;

/// Places up to which all distances are measured through the doors; among more the straight line counts.
const MOST_MEASURED: usize = 200;
/// Most rounds of improvement.
const ROUNDS: usize = 40;
/// Gain that is worth a change, m.
const GAIN_M: f64 = 1e-6;
/// Distance of what no door leads to, m: last on every tour.
const FAR_M: f64 = 1e6;

/// A place of a tour.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stop<'a> {
    pub room: &'a str,
    pub at: Point,
}

impl<'a> Stop<'a> {
    pub fn of_poi(poi: &'a Poi) -> Self {
        Self { room: &poi.room_id, at: Point::new(poi.pose.x, poi.pose.y) }
    }
}

/// Returns the places in the order of short tours from a start: one of those with clean goods, from its end one of the
/// usual ones, at last one of those with soiled goods.
pub(crate) fn in_turn(doors: &Doors, start: Option<Stop>, stops: &[(Goods, Stop)]) -> Vec<usize> {
    let mut out: Vec<usize> = Vec::with_capacity(stops.len());
    for goods in [Goods::Clean, Goods::Usual, Goods::Soiled] {
        let own: Vec<usize> = (0..stops.len()).filter(|&i| stops[i].0 == goods).collect();
        let places: Vec<Stop> = own.iter().map(|&i| stops[i].1).collect();
        let here = out.last().map(|&i| stops[i].1).or(start);
        out.extend(order(doors, here, &places).into_iter().map(|i| own[i]));
    }
    out
}

/// Returns the places in the order of a short round trip from a start, or from the first of them.
fn order(doors: &Doors, start: Option<Stop>, stops: &[Stop]) -> Vec<usize> {
    let Some(first) = start.or_else(|| stops.first().copied()) else { return Vec::new() };
    // the start is number 0
    let all: Vec<Stop> = std::iter::once(first).chain(stops.iter().copied()).collect();
    let apart = distances(doors, &all);
    let mut tour = nearest_next(&apart);
    for _ in 0..ROUNDS {
        if !improved(&mut tour, &apart) {
            break;
        }
    }
    tour.into_iter().filter_map(|i| i.checked_sub(1)).collect()
}

fn nearest_next(apart: &[Vec<f64>]) -> Vec<usize> {
    let mut tour = vec![0];
    let mut left: Vec<usize> = (1..apart.len()).collect();
    let mut here = 0;
    while let Some(at) = (0..left.len()).min_by(|a, b| apart[here][left[*a]].total_cmp(&apart[here][left[*b]])) {
        here = left.remove(at);
        tour.push(here);
    }
    tour
}

/// Turns stretches of a round trip around where that makes it shorter; returns true when it did.
fn improved(tour: &mut [usize], apart: &[Vec<f64>]) -> bool {
    let n = tour.len();
    let mut any = false;
    for i in 1..n {
        for j in i + 1..n {
            let (before, first, last, after) = (tour[i - 1], tour[i], tour[j], tour[(j + 1) % n]);
            let gain = apart[before][first] + apart[last][after] - apart[before][last] - apart[first][after];
            if gain > GAIN_M {
                tour[i..=j].reverse();
                any = true;
            }
        }
    }
    any
}

/// Returns the distance of each place to each other, m.
fn distances(doors: &Doors, stops: &[Stop]) -> Vec<Vec<f64>> {
    let straight = |a: &Stop| stops.iter().map(|b| a.at.distance(b.at)).collect();
    if stops.len() > MOST_MEASURED {
        return stops.iter().map(straight).collect();
    }
    stops.iter().map(|a| doors.to_all(a, stops)).collect()
}

/// The doors of a storey, which of them each room has, and how far each is from those of its rooms.
pub(crate) struct Doors<'a> {
    middles: Vec<Point>,
    next: Vec<Vec<(usize, f64)>>,
    of_room: BTreeMap<&'a str, Vec<usize>>,
}

impl<'a> Doors<'a> {
    pub fn new(plan: &'a Floorplan) -> Self {
        let mut of_room: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (i, door) in plan.doors.iter().enumerate() {
            door.room_ids.iter().for_each(|id| of_room.entry(id).or_default().push(i));
        }
        let middles: Vec<Point> = plan.doors.iter().map(|d| d.line.middle()).collect();
        let next = plan.doors.iter().zip(&middles).map(|(door, at)| {
            let others = door.room_ids.iter().filter_map(|id| of_room.get(id.as_str())).flatten();
            others.map(|&d| (d, at.distance(middles[d]))).collect()
        });
        Self { next: next.collect(), middles, of_room }
    }

    fn of(&self, room: &str) -> &[usize] {
        self.of_room.get(room).map_or(&[], Vec::as_slice)
    }

    fn to_all(&self, from: &Stop, stops: &[Stop]) -> Vec<f64> {
        let mut far = vec![f64::MAX; self.middles.len()];
        self.of(from.room).iter().for_each(|&d| far[d] = from.at.distance(self.middles[d]));
        let mut left: Vec<usize> = (0..far.len()).collect();
        while let Some(at) = (0..left.len()).min_by(|a, b| far[left[*a]].total_cmp(&far[left[*b]])) {
            let here = left.swap_remove(at);
            if far[here] == f64::MAX {
                break;
            }
            for &(next, apart) in &self.next[here] {
                far[next] = far[next].min(far[here] + apart);
            }
        }
        let to = |stop: &Stop| {
            let ways = self.of(stop.room).iter().map(|&d| far[d] + self.middles[d].distance(stop.at));
            let through = ways.fold(FAR_M, f64::min);
            if stop.room == from.room { from.at.distance(stop.at) } else { through }
        };
        stops.iter().map(to).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clean_goods_come_first_and_soiled_ones_last() {
        let at = |x: f64| Stop { room: "ward_1", at: Point::new(x, 0.0) };
        let doors = Doors { middles: Vec::new(), next: Vec::new(), of_room: BTreeMap::new() };
        let stops = [
            (Goods::Soiled, at(1.0)),
            (Goods::Usual, at(2.0)),
            (Goods::Clean, at(9.0)),
            (Goods::Usual, at(8.0)),
            (Goods::Clean, at(3.0)),
        ];
        assert_eq!(in_turn(&doors, Some(at(0.0)), &stops), [4, 2, 3, 1, 0]);
    }

    #[test]
    fn a_round_trip_crosses_itself_no_more() {
        // on a ring, visited crosswise at first
        let at =
            [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (2.0, 5.0), (2.0, -1.0)].map(|(x, y)| Point::new(x, y));
        let apart: Vec<Vec<f64>> = at.iter().map(|a| at.iter().map(|b| a.distance(*b)).collect()).collect();
        let long = |t: &[usize]| (0..t.len()).map(|i| apart[t[i]][t[(i + 1) % t.len()]]).sum::<f64>();
        let mut tour = vec![0, 2, 1, 3, 5, 4];
        let before = long(&tour);
        while improved(&mut tour, &apart) {}
        assert!(long(&tour) < 0.75 * before && tour[0] == 0, "{tour:?}");
        assert_eq!(nearest_next(&apart)[..2], [0, 5]);
    }
}
