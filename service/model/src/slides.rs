//! Which way sliding leaves go: each into the wall beside its opening, where no other opening and no other leaf is.

use crate::TOLERANCE_M;
use crate::floorplan::{Door, DoorKind, Slide, Wall};

/// What it costs that the wall is too short for a leaf, or that two leaves need the same piece of it.
const NO_WALL: f64 = 10.0;
/// What it costs that another wall meets this one along the leaf, that there are two leaves, or two behind each other, and
/// that there would be more wall on the other side.
const ACROSS: f64 = 1.0;
const TWO_LEAVES: f64 = 1.2;
const STACKED: f64 = 1.5;
const SHORTER: f64 = 0.1;

/// Tells sliding doors of one storey which way their leaves go; doors that know it already keep to it. Gates that open by
/// themselves go up; of other doors in outer walls, before the panes beside them, it is not said.
pub fn aim(doors: &mut [Door], walls: &[Wall]) {
    for gate in doors.iter_mut().filter(|d| d.kind == DoorKind::Sliding && d.room_ids.len() == 1 && d.automatic) {
        gate.slide = gate.slide.or(Some(Slide::Up));
    }
    let slides = |d: &Door| d.kind == DoorKind::Sliding && d.room_ids.len() > 1;
    let mut order: Vec<usize> = (0..doors.len()).filter(|&i| slides(&doors[i])).collect();
    let place = |d: &Door| {
        let (at, from, _) = d.line.span();
        (d.line.is_vertical(), at, from)
    };
    order.sort_by(|&a, &b| {
        let ((va, ata, froma), (vb, atb, fromb)) = (place(&doors[a]), place(&doors[b]));
        va.cmp(&vb).then(ata.total_cmp(&atb)).then(froma.total_cmp(&fromb))
    });
    let in_one_line = |a: &usize, b: &usize| {
        let (a, b) = (place(&doors[*a]), place(&doors[*b]));
        a.0 == b.0 && (a.1 - b.1).abs() < TOLERANCE_M
    };
    let lines: Vec<Vec<usize>> = order.chunk_by(in_one_line).map(<[usize]>::to_vec).collect();
    for line in lines {
        let beside: Vec<Beside> = line.iter().map(|&i| Beside::of(&doors[i], walls)).collect();
        for (i, slide) in line.into_iter().zip(best(&beside)) {
            doors[i].slide = Some(slide);
        }
    }
}

/// Returns how the leaves of the doors in one line go that cost least together, the doors in order along it.
fn best(doors: &[Beside]) -> Vec<Slide> {
    // the cheapest choices up to each door, by the choice of the last one
    let mut paths: Vec<(f64, Vec<Slide>)> = vec![(0.0, Vec::new())];
    for (n, door) in doors.iter().enumerate() {
        let next = door.choices().into_iter().filter_map(|slide| {
            let longer = paths.iter().map(|(cost, path)| {
                let shared =
                    n.checked_sub(1).zip(path.last()).map_or(0.0, |(p, last)| door.shares(&doors[p], *last, slide));
                (cost + door.cost(slide) + shared, path)
            });
            let (cost, path) = longer.min_by(|a, b| a.0.total_cmp(&b.0))?;
            Some((cost, path.iter().copied().chain([slide]).collect()))
        });
        paths = next.collect();
    }
    paths.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, path)| path).unwrap_or_default()
}

/// A sliding door with the wall at its two ends, lower coordinates first.
struct Beside {
    from: f64,
    to: f64,
    /// Width of the leaf, both where there are two, m.
    leaf: f64,
    /// True where the line of the door runs towards higher coordinates.
    upward: bool,
    /// Inner wall up to the next opening or corner, m.
    free: [f64; 2],
    /// Wall up to the first other wall that meets it, m.
    plain: [f64; 2],
    given: Option<Slide>,
}

impl Beside {
    fn of(door: &Door, walls: &[Wall]) -> Self {
        let (at, from, to) = door.line.span();
        let vertical = door.line.is_vertical();
        let in_line: Vec<(f64, f64)> = walls
            .iter()
            .filter(|w| w.line.is_vertical() == vertical && !w.exterior)
            .map(|w| w.line.span())
            .filter(|(other, ..)| (other - at).abs() < TOLERANCE_M)
            .map(|(_, low, high)| (low, high))
            .collect();
        // other walls that meet the line, with half their thickness
        let meeting: Vec<(f64, f64)> = walls
            .iter()
            .filter(|w| w.line.is_vertical() != vertical)
            .map(|w| (w.line.span(), w.thickness_m / 2.0))
            .filter(|((_, low, high), _)| *low < at + TOLERANCE_M && *high > at - TOLERANCE_M)
            .map(|((across, ..), half)| (across, half))
            .collect();
        let end = |mut v: f64, up: bool| {
            while let Some(next) = in_line.iter().find_map(|&(low, high)| {
                let (near, far) = if up { (low, high) } else { (high, low) };
                ((near - v).abs() < TOLERANCE_M && (far - v).abs() > TOLERANCE_M).then_some(far)
            }) {
                v = next;
            }
            v
        };
        let ends = [end(from, false), end(to, true)];
        let half = |v: f64| meeting.iter().filter(|m| (m.0 - v).abs() < TOLERANCE_M).map(|m| m.1).fold(0.0, f64::max);
        let free = [from - ends[0] - half(ends[0]), ends[1] - to - half(ends[1])];
        let first = |side: usize| {
            let met = meeting.iter().map(|&(v, half)| if side == 0 { from - v - half } else { v - half - to });
            met.filter(|gap| *gap > -TOLERANCE_M).fold(free[side], f64::min)
        };
        let upward = if vertical { door.line.end.y > door.line.start.y } else { door.line.end.x > door.line.start.x };
        let leaf = door.clear_width_m.min(to - from);
        Self { from, to, leaf, upward, free, plain: [first(0), first(1)], given: door.slide }
    }

    fn choices(&self) -> Vec<Slide> {
        let all =
            [Slide::BeyondStart, Slide::BeyondEnd, Slide::Apart, Slide::StackedBeyondStart, Slide::StackedBeyondEnd];
        self.given.map_or(all.to_vec(), |slide| vec![slide])
    }

    /// Returns how much wall the leaves take on the lower and the upper side, m.
    fn takes(&self, slide: Slide) -> [f64; 2] {
        let width = self.leaf;
        let (start, end) = match slide {
            Slide::BeyondStart => (width, 0.0),
            Slide::BeyondEnd => (0.0, width),
            Slide::Apart => (width / 2.0, width / 2.0),
            Slide::StackedBeyondStart => (width / 2.0, 0.0),
            Slide::StackedBeyondEnd => (0.0, width / 2.0),
            Slide::Up => (0.0, 0.0),
        };
        if self.upward { [start, end] } else { [end, start] }
    }

    fn cost(&self, slide: Slide) -> f64 {
        let takes = self.takes(slide);
        let side = |i: usize| {
            let lacks = (takes[i] - self.free[i]).max(0.0);
            let short = if lacks > TOLERANCE_M { NO_WALL * (1.0 + lacks) } else { 0.0 };
            short + if takes[i] > self.plain[i] + TOLERANCE_M { ACROSS } else { 0.0 }
        };
        let leaves = match slide {
            Slide::Apart => TWO_LEAVES,
            Slide::StackedBeyondStart | Slide::StackedBeyondEnd => STACKED,
            _ => 0.0,
        };
        let [low, high] = takes;
        let shorter = (high > low && self.free[1] < self.free[0]) || (low > high && self.free[0] < self.free[1]);
        side(0) + side(1) + leaves + if shorter { SHORTER } else { 0.0 }
    }

    /// Returns what it costs that the leaves of this door and of the one before it in its line need the same wall.
    fn shares(&self, before: &Self, theirs: Slide, own: Slide) -> f64 {
        let needs = before.takes(theirs)[1] + self.takes(own)[0];
        if needs > self.from - before.to + TOLERANCE_M { NO_WALL } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Segment};

    fn segment(x0: f64, y0: f64, x1: f64, y1: f64) -> Segment {
        Segment { start: Point::new(x0, y0), end: Point::new(x1, y1) }
    }

    fn wall(line: Segment, exterior: bool) -> Wall {
        let room_ids = vec!["a_1".into(), "b_1".into()];
        Wall { wall_id: String::new(), line, thickness_m: 0.1, room_ids, exterior, locked: false }
    }

    fn door(from: f64, to: f64) -> Door {
        Door {
            door_id: String::new(),
            kind: DoorKind::Sliding,
            line: segment(from, 3.0, to, 3.0),
            clear_width_m: (to - from).abs(),
            height_m: 2.1,
            wall_thickness_m: 0.1,
            room_ids: vec!["a_1".into(), "b_1".into()],
            entrance: false,
            swing: None,
            slide: None,
            automatic: false,
            locked: false,
        }
    }

    /// Doors in a wall from x = 0 to x = 6 between two outer walls; `walls` meet it from the south.
    fn aimed(mut doors: Vec<Door>, walls: &[f64]) -> Vec<Option<Slide>> {
        let mut cuts: Vec<f64> = doors.iter().flat_map(|d| [d.line.start.x, d.line.end.x]).collect();
        cuts.sort_by(f64::total_cmp);
        let ends: Vec<f64> = [0.0].into_iter().chain(cuts).chain([6.0]).collect();
        let pieces = ends.chunks(2).map(|piece| wall(segment(piece[0], 3.0, piece[1], 3.0), false));
        let outer = [0.0, 6.0].map(|x| wall(segment(x, 0.0, x, 5.0), true));
        let meeting = walls.iter().map(|&x| wall(segment(x, 0.0, x, 3.0), false));
        let walls: Vec<Wall> = pieces.chain(outer).chain(meeting).collect();
        aim(&mut doors, &walls);
        doors.into_iter().map(|d| d.slide).collect()
    }

    #[test]
    fn a_leaf_goes_where_there_is_more_wall() {
        assert_eq!(aimed(vec![door(1.5, 2.5)], &[]), [Some(Slide::BeyondEnd)]);
        assert_eq!(aimed(vec![door(3.5, 4.5)], &[]), [Some(Slide::BeyondStart)]);
        // a line that runs the other way has its end there
        assert_eq!(aimed(vec![door(4.5, 3.5)], &[]), [Some(Slide::BeyondEnd)]);
    }

    #[test]
    fn a_leaf_keeps_out_of_corners_and_of_walls_that_meet_its_own() {
        assert_eq!(aimed(vec![door(0.9, 1.9)], &[2.2]), [Some(Slide::BeyondEnd)], "0.85 m are too short");
        assert_eq!(aimed(vec![door(1.5, 2.5)], &[2.9]), [Some(Slide::BeyondStart)]);
    }

    #[test]
    fn two_leaves_do_not_meet_in_one_wall() {
        // 1.4 m between the doors take one leaf of 1 m, not two
        let slides = aimed(vec![door(1.2, 2.2), door(3.6, 4.6)], &[]);
        let towards = |slide| [Some(slide); 2];
        assert!(slides == towards(Slide::BeyondStart) || slides == towards(Slide::BeyondEnd), "{slides:?}");
        assert_eq!(
            aimed(vec![door(0.3, 1.3), door(4.6, 5.6)], &[]),
            [Some(Slide::BeyondEnd), Some(Slide::BeyondStart)]
        );
    }

    #[test]
    fn a_door_with_little_wall_on_both_sides_has_two_leaves() {
        assert_eq!(aimed(vec![door(0.8, 2.0), door(2.8, 5.9)], &[])[0], Some(Slide::Apart));
    }

    #[test]
    fn what_is_told_stays() {
        let told = Door { slide: Some(Slide::BeyondStart), ..door(1.5, 2.5) };
        assert_eq!(aimed(vec![told], &[]), [Some(Slide::BeyondStart)]);
    }
}
