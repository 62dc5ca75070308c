//! What one passes in the hall of a home on the way from the entrance to the room where guests are taken to.
//!
//! It looks at the walls between the hall and the rooms, where their doors will be: the middles of rooms say little about
//! the end of a long hall at which one comes in.

use d3dgen_model::domain::Zone;

use super::lattice::Cellbox;
use super::realize::door_need;
use super::spec::Brief;
use crate::lattice::between;

/// How much nearer to the entrance a bedroom's door is at least to count as passed, m.
pub(crate) const PLAINLY_M: f64 = 0.3;
/// What a bedroom counts that is passed, what a meter more between the doors counts, and up to how many.
const PASSED: f64 = 0.5;
const FURTHER: f64 = 0.15;
const FURTHEST_M: f64 = 4.0;

/// Returns how wrong a place for the entrance is, given by twice its coordinates, lattice units: every bedroom counts whose
/// door cannot be further from it than that of the living room.
pub(crate) fn passed_bedrooms(brief: &Brief, boxes: &[(usize, Cellbox)], entrance: (i32, i32)) -> f64 {
    let Some((spine, living)) = brief.spine.zip(room_of_guests(brief)) else { return 0.0 };
    let entered = brief.rooms.iter().position(|r| r.entrance).unwrap_or(spine);
    // from an entrance hall one gets on where it meets the hall
    let from = if entered == spine {
        entrance
    } else {
        let Some(door) = fronts(boxes, entered, spine, 0).map(|[a, b]| ((a.0 + b.0) / 2, (a.1 + b.1) / 2)).next()
        else {
            return 0.0;
        };
        door
    };
    let ways = |room: usize| {
        let need = door_need(brief.rooms[room].door_width);
        fronts(boxes, room, spine, need).flatten().map(move |p| between(p, from))
    };
    let Some(to_living) = ways(living).reduce(f64::min) else { return 0.0 };
    let beds = (0..brief.rooms.len()).filter(|r| brief.rooms[*r].zone == Zone::Night && brief.rooms[*r].on_spine);
    beds.filter_map(|bed| {
        let nearer = to_living - ways(bed).reduce(f64::max)?;
        (nearer > PLAINLY_M).then(|| PASSED + FURTHER * nearer.min(FURTHEST_M))
    })
    .sum()
}

/// Returns the largest room of the day that opens to the hall of a home on the storey of its entrance, beside bedrooms.
pub(crate) fn room_of_guests(brief: &Brief) -> Option<usize> {
    if !brief.is_home() || brief.upper {
        return None;
    }
    let by_day = |r: &usize| brief.rooms[*r].zone == Zone::Day && brief.rooms[*r].on_spine;
    let area = |r: &usize| brief.rooms[*r].area_target;
    (0..brief.rooms.len()).filter(by_day).max_by(|a, b| area(a).total_cmp(&area(b)).then(b.cmp(a)))
}

/// Returns the first and the last place for a door of a room to the hall in each wall between them, as twice the coordinates.
fn fronts(
    boxes: &[(usize, Cellbox)],
    room: usize,
    spine: usize,
    need: i32,
) -> impl Iterator<Item = [(i32, i32); 2]> + '_ {
    let of = move |room: usize| boxes.iter().filter(move |(r, _)| *r == room).map(|(_, b)| *b);
    of(room).flat_map(move |own| {
        of(spine).filter_map(move |hall| {
            let (side, from, to) = own.contact(&hall)?;
            let (from, to) = (2 * from + need, 2 * to - need);
            (from <= to).then(|| {
                [from, to].map(|along| match side {
                    0 => (2 * own.x0, along),
                    1 => (2 * own.x1, along),
                    2 => (along, 2 * own.y0),
                    _ => (along, 2 * own.y1),
                })
            })
        })
    })
}
