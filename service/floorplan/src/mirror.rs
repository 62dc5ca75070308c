//! How alike a layout is on both sides of an axis: as a measure of finished plans, and as a cost where a plan is not made
//! alike by construction (`symmetric`).

use d3dgen_model::style::Symmetry;

use super::lattice::{Cellbox, meters};
use super::spec::Brief;
use crate::lattice::distance;
/// Share of a room that the mirror image of another covers at least, and the other way round, for the two to be a pair.
const COVERS: f64 = 0.98;
/// Weight of what is not alike, where a symmetric plan is asked for.
const WEIGHT: f64 = 15.0;

/// A line that a plan is mirrored at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Axis {
    /// From south to north, at half this x.
    Upright(i32),
    /// From west to east, at half this y.
    Level(i32),
}

impl Axis {
    /// Returns the mirror image of a rectangle.
    pub(crate) fn image(self, b: Cellbox) -> Cellbox {
        match self {
            Self::Upright(x2) => Cellbox { x0: x2 - b.x1, x1: x2 - b.x0, ..b },
            Self::Level(y2) => Cellbox { y0: y2 - b.y1, y1: y2 - b.y0, ..b },
        }
    }

    /// Returns the two axes through the middle of a building.
    fn of(boxes: &[(usize, Cellbox)]) -> Option<[Self; 2]> {
        let (x2, y2) = boxes.iter().map(|(_, b)| *b).reduce(Cellbox::around)?.center2();
        Some([Self::Upright(x2), Self::Level(y2)])
    }
}

/// How much of a layout is alike on both sides of an axis.
#[derive(Debug, Clone)]
pub(crate) struct Likeness {
    pub axis: Axis,
    /// Share of the floor area whose mirror image is a room of the same kind.
    pub share: f64,
    /// Share of the floor area whose mirror image is a room of the same type.
    pub of_type: f64,
    /// By room: the room of the same kind that its mirror image is, itself for one on the axis. Pieces of corridor are one
    /// room.
    pub images: Vec<Option<usize>>,
}

/// Returns how alike a layout is, about the better of the two axes through its middle.
pub(crate) fn likeness(brief: &Brief, boxes: &[(usize, Cellbox)]) -> Option<Likeness> {
    let found = Axis::of(boxes)?.map(|axis| alike(brief, boxes, axis));
    found.into_iter().reduce(|a, b| if b.share > a.share { b } else { a })
}

/// Returns the share of the floor area whose mirror image is a room of the same kind.
pub(crate) fn share(brief: &Brief, boxes: &[(usize, Cellbox)]) -> f64 {
    likeness(brief, boxes).map_or(0.0, |found| found.share)
}

fn alike(brief: &Brief, boxes: &[(usize, Cellbox)], axis: Axis) -> Likeness {
    let count = brief.rooms.len();
    let whole = |room: usize| whole(brief, room);
    let area = |b: &Cellbox| i64::from(b.width()) * i64::from(b.height());
    let mut areas = vec![0_i64; count];
    boxes.iter().for_each(|(room, b)| areas[whole(*room)] += area(b));
    let mut shared = vec![0_i64; count * count];
    for (room, b) in boxes {
        let image = axis.image(*b);
        for (other, c) in boxes {
            if let Some(both) = image.overlap(c)
                && same_kind(brief, whole(*room), whole(*other))
            {
                shared[whole(*room) * count + whole(*other)] += area(&both);
            }
        }
    }
    let covers = |room: usize, other: usize| shared[room * count + other] as f64 >= COVERS * areas[room] as f64;
    let image = |room: usize| (0..count).find(|&other| areas[room] > 0 && covers(room, other) && covers(other, room));
    let images: Vec<Option<usize>> = (0..count).map(|room| image(whole(room))).collect();
    let total = areas.iter().sum::<i64>().max(1) as f64;
    let of = |chosen: &dyn Fn(usize, usize) -> bool| {
        let mirrored = (0..count).filter(|&room| whole(room) == room && images[room].is_some_and(|i| chosen(room, i)));
        mirrored.map(|room| areas[room]).sum::<i64>() as f64 / total
    };
    let same_type = |a: usize, b: usize| brief.rooms[a].room_type == brief.rooms[b].room_type;
    Likeness { axis, share: of(&|_, _| true), of_type: of(&same_type), images }
}

/// Returns the corridor for each of its pieces, which are one room here; else the room.
pub(crate) fn whole(brief: &Brief, room: usize) -> usize {
    let is_piece = brief.rooms[room].circulation && !brief.hub;
    if is_piece { brief.spine.unwrap_or(room) } else { room }
}

/// Returns true for rooms of one part of the building: those that the picture of a plan tints alike.
pub(crate) fn same_kind(brief: &Brief, a: usize, b: usize) -> bool {
    let (a, b) = (&brief.rooms[a], &brief.rooms[b]);
    a.room_type == b.room_type || (a.zone, a.circulation) == (b.zone, b.circulation)
}

/// Returns what a layout costs under a wish, from the largest box of each room, its area, and the box of the room one
/// enters by.
pub(crate) fn cost(wish: Symmetry, rooms: &[(Cellbox, f64)], entrance: Cellbox) -> f64 {
    let (cx, cy) = entrance.center2();
    let [upright, level] = [Axis::Upright(cx), Axis::Level(cy)].map(|axis| unlike(rooms, axis));
    let unlike = upright.min(level);
    match wish {
        Symmetry::Symmetric => WEIGHT * unlike,
        // unlike enough is unlike: no plan is torn apart for it
        Symmetry::Asymmetric => WEIGHT * (0.25 - unlike).max(0.0),
    }
}

/// Returns how far the mirrored rooms lie from those nearest to them in place and size, over the size of the whole.
fn unlike(rooms: &[(Cellbox, f64)], axis: Axis) -> f64 {
    let total: f64 = rooms.iter().map(|r| r.1).sum();
    let far = |(shape, area): &(Cellbox, f64)| {
        let image = axis.image(*shape);
        let apart = |other: &(Cellbox, f64)| {
            let sizes = (image.width() - other.0.width()).abs() + (image.height() - other.0.height()).abs();
            distance(image, other.0) + 0.5 * meters(sizes)
        };
        area * rooms.iter().map(apart).fold(f64::MAX, f64::min)
    };
    rooms.iter().map(far).sum::<f64>() / (total * total.sqrt()).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirrored_plan_costs_nothing_and_a_lopsided_one_does() {
        let shape = |x0, x1, y0, y1| (Cellbox { x0, x1, y0, y1 }, f64::from((x1 - x0) * (y1 - y0)) * 0.0025);
        let hall = shape(0, 200, 90, 120);
        let alike =
            [hall, shape(0, 100, 0, 90), shape(100, 200, 0, 90), shape(0, 100, 120, 210), shape(100, 200, 120, 210)];
        assert_eq!(cost(Symmetry::Symmetric, &alike, hall.0), 0.0);
        assert!(cost(Symmetry::Asymmetric, &alike, hall.0) > 3.0);
        let lopsided =
            [hall, shape(0, 150, 0, 90), shape(150, 200, 0, 90), shape(0, 60, 120, 180), shape(60, 200, 120, 180)];
        assert!(cost(Symmetry::Symmetric, &lopsided, hall.0) > 0.5);
    }
}
