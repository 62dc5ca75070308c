//! A plan as cells that can be moved: what one room takes, another or the outdoors gives.

use d3dgen_model::floorplan::{Floorplan, PlanRoom};

use super::lattice::{Cellbox, INNER_HALF_M, OUTER_HALF_M, meters, nearest};
use super::outline::Mosaic;
use super::realize::Layout;
use super::spec::Brief;
use crate::lattice::tidied;

/// How far a corner may lie from the lattice, m.
const OFF_LATTICE_M: f64 = 1e-4;
/// Least opening between two pieces of a room, lattice units: 0.6 m.
const NECK: i32 = 12;
/// Pieces of one room at most; more is no shape that anybody builds.
const MOST_PIECES: usize = 4;

/// The cells of each room, in the order of the brief.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Board {
    pub rooms: Vec<Vec<Cellbox>>,
}

impl Board {
    /// Reads the rooms of a plan; a room of the brief that the plan does not have has no cells.
    ///
    /// # Errors
    /// The room or wall that this engine cannot have made, for people.
    pub(crate) fn read(brief: &Brief, plan: &Floorplan) -> Result<Self, String> {
        for wall in &plan.walls {
            let half = if wall.exterior { OUTER_HALF_M } else { INNER_HALF_M };
            if (wall.thickness_m - 2.0 * half).abs() > OFF_LATTICE_M {
                return Err(format!(
                    "`{}` is {} m thick where this engine builds {} m, so no part of the plan can be planned anew; lock all of it",
                    wall.wall_id,
                    wall.thickness_m,
                    2.0 * half
                ));
            }
        }
        let mut rooms = vec![Vec::new(); brief.rooms.len()];
        for (own, spec) in rooms.iter_mut().zip(&brief.rooms) {
            if let Some(room) = plan.room(&spec.id) {
                *own = cells(room)?;
            }
        }
        Ok(Self { rooms })
    }

    /// Writes the cells as a layout.
    pub(crate) fn write(&self, layout: &mut Layout) {
        layout.boxes.clear();
        layout.boxes.extend(self.rooms.iter().enumerate().flat_map(|(i, cells)| cells.iter().map(move |b| (i, *b))));
    }

    /// Returns the cells as a layout.
    pub(crate) fn layout(&self) -> Layout {
        let mut layout = Layout::default();
        self.write(&mut layout);
        layout
    }

    /// Returns which rooms own parts of a rectangle, and how much, in square units.
    pub(crate) fn owners(&self, area: &Cellbox) -> Vec<(usize, i64)> {
        let share = |cells: &[Cellbox]| cells.iter().filter_map(|b| b.overlap(area)).map(|o| units(&o)).sum::<i64>();
        let shares = self.rooms.iter().enumerate().map(|(i, cells)| (i, share(cells)));
        shares.filter(|(_, share)| *share > 0).collect()
    }

    /// Gives a rectangle to a room, whoever had it.
    pub(crate) fn give(&mut self, room: usize, area: &Cellbox) {
        self.clear(area);
        self.rooms[room].push(*area);
        self.rooms[room] = tidied(&self.rooms[room]);
    }

    /// Gives a rectangle to the outdoors.
    pub(crate) fn clear(&mut self, area: &Cellbox) {
        for cells in &mut self.rooms {
            if cells.iter().any(|b| b.overlap(area).is_some()) {
                let left: Vec<Cellbox> = cells.iter().flat_map(|b| b.without(area)).collect();
                *cells = tidied(&left);
            }
        }
    }

    /// Returns true when a room is one piece of a shape that can be built.
    pub(crate) fn is_whole(&self, room: usize) -> bool {
        let cells = &self.rooms[room];
        if cells.is_empty() || cells.len() > MOST_PIECES {
            return false;
        }
        let mut reached = vec![false; cells.len()];
        let mut waiting = vec![0];
        while let Some(i) = waiting.pop() {
            if std::mem::replace(&mut reached[i], true) {
                continue;
            }
            let joined = |j: &usize| cells[i].contact(&cells[*j]).is_some_and(|(_, from, to)| to - from >= NECK);
            waiting.extend((0..cells.len()).filter(|j| !reached[*j]).filter(joined));
        }
        reached.into_iter().all(|r| r)
    }

    /// Returns how many square meters of a room differ from another board.
    pub(crate) fn changed_m2(&self, other: &Self) -> f64 {
        let difference = |a: &Vec<Cellbox>, b: &Vec<Cellbox>| {
            let total: i64 = a.iter().chain(b).map(units).sum();
            let shared: i64 = a.iter().flat_map(|x| b.iter().filter_map(|y| x.overlap(y))).map(|o| units(&o)).sum();
            total - 2 * shared
        };
        let sum: i64 = self.rooms.iter().zip(&other.rooms).filter(|(a, b)| a != b).map(|(a, b)| difference(a, b)).sum();
        sum as f64 * meters(1) * meters(1)
    }

    /// Returns the thin strips just outside the rooms chosen: those that are outdoors, and those that are indoors.
    ///
    /// A room stays as it is while the first stay free and the second stay built on.
    pub(crate) fn rims(&self, chosen: &[bool]) -> (Vec<Cellbox>, Vec<Cellbox>) {
        let (mut outdoors, mut indoors) = (Vec::new(), Vec::new());
        for s in Mosaic::new(&self.layout().boxes).stretches() {
            for (room, before) in [(s.low, false), (s.high, true)] {
                if !room.is_some_and(|r| chosen[r]) {
                    continue;
                }
                // the other side of the line
                let (at, to) = if before { (s.at - 1, s.at) } else { (s.at, s.at + 1) };
                let strip =
                    if s.vertical { Cellbox::new(at, s.from, to, s.to) } else { Cellbox::new(s.from, at, s.to, to) };
                if s.is_outer() { outdoors.push(strip) } else { indoors.push(strip) }
            }
        }
        (outdoors, indoors)
    }
}

/// Returns the cells of a room of a plan.
///
/// # Errors
/// Why this engine cannot have made it, for people.
pub(crate) fn cells(room: &PlanRoom) -> Result<Vec<Cellbox>, String> {
    let mut out = Vec::new();
    for rect in room.polygon.rects() {
        let edges = [rect.x0, rect.y0, rect.x1, rect.y1];
        let [x0, y0, x1, y1] = edges.map(nearest);
        if [x0, y0, x1, y1].iter().zip(edges).any(|(units, m)| (meters(*units) - m).abs() > OFF_LATTICE_M) {
            return Err(format!(
                "`{}` has a corner off the 5 cm lattice, so no part of the plan can be planned anew; lock all of it",
                room.room_id
            ));
        }
        out.push(Cellbox { x0, y0, x1, y1 });
    }
    Ok(tidied(&out))
}

/// Returns the size of a rectangle in square units.
pub(crate) fn units(b: &Cellbox) -> i64 {
    i64::from(b.width()) * i64::from(b.height())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x0: i32, y0: i32, x1: i32, y1: i32) -> Cellbox {
        Cellbox { x0, y0, x1, y1 }
    }

    #[test]
    fn pieces_become_few_rectangles_with_the_largest_first() {
        let l = [square(0, 0, 10, 20), square(10, 0, 20, 20), square(0, 20, 5, 30)];
        assert_eq!(tidied(&l), [square(0, 0, 20, 20), square(0, 20, 5, 30)]);
    }

    #[test]
    fn what_one_room_takes_the_other_gives() {
        let mut board = Board { rooms: vec![vec![square(0, 0, 10, 10)], vec![square(10, 0, 20, 10)]] };
        board.give(0, &square(10, 0, 14, 10));
        assert_eq!(board.rooms, [vec![square(0, 0, 14, 10)], vec![square(14, 0, 20, 10)]]);
        assert_eq!(board.owners(&square(13, 0, 15, 1)), [(0, 1), (1, 1)]);
        board.clear(&square(0, 0, 20, 5));
        assert_eq!(board.rooms[1], [square(14, 5, 20, 10)]);
    }

    #[test]
    fn a_room_in_two_pieces_is_not_whole() {
        let apart = Board { rooms: vec![vec![square(0, 0, 10, 10), square(20, 0, 30, 10)]] };
        let together = Board { rooms: vec![vec![square(0, 0, 20, 20), square(20, 6, 40, 20)]] };
        let neck = Board { rooms: vec![vec![square(0, 0, 20, 20), square(20, 16, 40, 40)]] };
        assert!(!apart.is_whole(0) && together.is_whole(0) && !neck.is_whole(0));
    }

    #[test]
    fn rims_tell_what_is_outside_of_a_kept_room() {
        let board = Board { rooms: vec![vec![square(0, 0, 10, 10)], vec![square(10, 0, 20, 10)]] };
        let (outdoors, indoors) = board.rims(&[true, false]);
        assert_eq!(indoors, [square(10, 0, 11, 10)]);
        assert_eq!(outdoors.len(), 3);
    }
}
