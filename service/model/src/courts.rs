//! Courts: open ground with rooms of its storey all around. A door to one leads outdoors and is no way out.

use crate::TOLERANCE_M;
use crate::floorplan::{Door, Floorplan, PlanRoom};
use crate::geometry::{Point, Rect};

/// How far beyond its wall the ground is that a door opens on, m.
const BEYOND_M: f64 = 0.05;

/// Open ground with rooms all around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Court {
    /// Storey it lies on.
    pub level: i32,
    /// Rectangles that make it up, on center lines of its walls, m.
    pub rects: Vec<Rect>,
}

impl Court {
    /// Returns its area on center lines of its walls, m^2.
    pub fn area_m2(&self) -> f64 {
        self.rects.iter().map(Rect::area).sum()
    }

    /// Returns true for a point of it.
    pub fn contains(&self, p: Point) -> bool {
        self.rects.iter().any(|r| r.contains(&Rect::new(p.x, p.y, p.x, p.y)))
    }

    /// Returns the rectangle around it.
    pub fn bounds(&self) -> Rect {
        self.rects.iter().copied().reduce(|a, b| a.union(&b)).unwrap_or(Rect::new(0.0, 0.0, 0.0, 0.0))
    }
}

/// Returns the courts between rooms, storey by storey.
pub fn between(rooms: &[PlanRoom]) -> Vec<Court> {
    let mut levels: Vec<i32> = rooms.iter().map(|r| r.level).collect();
    levels.sort_unstable();
    levels.dedup();
    levels.into_iter().flat_map(|level| on_level(rooms, level)).collect()
}

fn on_level(rooms: &[PlanRoom], level: i32) -> Vec<Court> {
    let floor: Vec<Rect> = rooms.iter().filter(|r| r.level == level).flat_map(|r| r.polygon.rects()).collect();
    let lines = |ends: fn(&Rect) -> [f64; 2]| {
        let mut all: Vec<f64> = floor.iter().flat_map(ends).collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| *a - *b < TOLERANCE_M);
        all
    };
    let (xs, ys) = (lines(|r| [r.x0, r.x1]), lines(|r| [r.y0, r.y1]));
    let (columns, rows) = (xs.len().saturating_sub(1), ys.len().saturating_sub(1));
    let line = |all: &[f64], at: f64| all.partition_point(|l| *l < at - TOLERANCE_M);
    let mut built = vec![false; columns * rows];
    for r in &floor {
        for j in line(&ys, r.y0)..line(&ys, r.y1) {
            built[j * columns..][line(&xs, r.x0)..line(&xs, r.x1)].fill(true);
        }
    }
    let mut courts: Vec<Court> = Vec::new();
    for (cell, court) in enclosed(columns, &built).into_iter().enumerate() {
        let Some(court) = court else { continue };
        courts.resize_with(courts.len().max(court + 1), || Court { level, rects: Vec::new() });
        let (i, j) = (cell % columns, cell / columns);
        add(&mut courts[court].rects, Rect::new(xs[i], ys[j], xs[i + 1], ys[j + 1]));
    }
    courts
}

/// Adds a cell to those west and south of it: to the last one where it goes on with it, and both to what they complete below.
fn add(rects: &mut Vec<Rect>, cell: Rect) {
    let goes_on = |last: &&mut Rect| (last.y0, last.y1, last.x1) == (cell.y0, cell.y1, cell.x0);
    let row = match rects.last_mut().filter(goes_on) {
        Some(last) => {
            last.x1 = cell.x1;
            *last
        }
        None => {
            rects.push(cell);
            cell
        }
    };
    let last = rects.len() - 1;
    if let Some(below) = rects[..last].iter_mut().find(|r| (r.x0, r.x1, r.y1) == (row.x0, row.x1, row.y0)) {
        below.y1 = row.y1;
        rects.pop();
    }
}

/// Returns which court each cell of a grid belongs to, of which `built` says row by row where rooms are: a court is free cells
/// to which one does not come from the rim past rooms.
pub fn enclosed(columns: usize, built: &[bool]) -> Vec<Option<usize>> {
    let rows = built.len().checked_div(columns).unwrap_or(0);
    let mut free: Vec<bool> = built.iter().map(|b| !b).collect();
    let mut spread = |from: Vec<usize>| {
        let (mut ahead, mut reached) = (from, Vec::new());
        while let Some(cell) = ahead.pop() {
            if !std::mem::take(&mut free[cell]) {
                continue;
            }
            reached.push(cell);
            let (i, j) = (cell % columns, cell / columns);
            let beside = [(i > 0, cell.wrapping_sub(1)), (i + 1 < columns, cell + 1)];
            let across = [(j > 0, cell.wrapping_sub(columns)), (j + 1 < rows, cell + columns)];
            ahead.extend(beside.into_iter().chain(across).filter(|(is_there, _)| *is_there).map(|(_, cell)| cell));
        }
        reached
    };
    let is_rim = |cell: &usize| {
        let (i, j) = (cell % columns, cell / columns);
        i == 0 || j == 0 || i + 1 == columns || j + 1 == rows
    };
    spread((0..built.len()).filter(is_rim).collect());
    let mut court_of = vec![None; built.len()];
    let mut count = 0;
    for cell in 0..built.len() {
        let court = spread(vec![cell]);
        court.iter().for_each(|&c| court_of[c] = Some(count));
        count += usize::from(!court.is_empty());
    }
    court_of
}

/// Returns true for a door by which one leaves the building; the courts are those between the rooms.
pub fn leads_out(door: &Door, rooms: &[PlanRoom], courts: &[Court]) -> bool {
    let [room] = door.room_ids.as_slice() else { return false };
    let level = rooms.iter().find(|r| r.room_id == *room).map_or(0, |r| r.level);
    let (middle, away) = (door.line.middle(), door.wall_thickness_m / 2.0 + BEYOND_M);
    let sides = [-away, away].map(|by| match door.line.is_vertical() {
        true => Point::new(middle.x + by, middle.y),
        false => Point::new(middle.x, middle.y + by),
    });
    // of a storey off the ground the stairwells are no floor, and one of their doors is its entrance
    door.entrance || !courts.iter().any(|c| c.level == level && sides.iter().any(|p| c.contains(*p)))
}

impl Floorplan {
    /// Returns the courts between its rooms, storey by storey.
    pub fn courts(&self) -> Vec<Court> {
        between(&self.rooms)
    }

    /// Returns the doors by which one leaves the building.
    pub fn ways_out(&self) -> Vec<&Door> {
        let courts = self.courts();
        self.doors.iter().filter(|d| leads_out(d, &self.rooms, &courts)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(rows: &[&str]) -> Vec<Option<usize>> {
        let built: Vec<bool> = rows.iter().flat_map(|row| row.chars().map(|c| c == '#')).collect();
        enclosed(rows[0].len(), &built)
    }

    #[test]
    fn ground_with_rooms_all_around_is_a_court_and_a_yard_is_none() {
        let two = grid(&["#####", "#.#.#", "#.###", "###.#"]);
        let of = |court: usize| two.iter().filter(|c| **c == Some(court)).count();
        assert_eq!([of(0), of(1), of(2)], [2, 1, 0], "{two:?}");
        assert!(grid(&["###", "#.#", "#.#"]).iter().all(Option::is_none));
        assert!(enclosed(0, &[]).is_empty());
    }
}
