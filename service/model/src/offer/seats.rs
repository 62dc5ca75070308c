//! Seats of rooms that people meet, eat and wait in, and counters at which they are served.

use crate::domain::{Arrangement, Domain, Furnishing, ObjectType, RoomType, Shape};
use crate::measures::BENCH_SEAT_M;

/// Floor of a room beside what its seats need, m^2: the way in, the display, the cupboard.
const SPARE_M2: f64 = 5.0;
/// Floor for each seat at one table, m^2.
const AT_TABLE_M2: f64 = 2.3;
/// Most floor for each seat in rows, m^2.
const IN_ROWS_M2: f64 = 1.7;
/// Most floor for each seat at small tables, m^2.
const AT_TABLES_M2: f64 = 2.6;
/// Floor for each counter with who serves there and who is served, m^2.
const AT_COUNTER_M2: f64 = 11.0;
/// Tag of rooms to eat in.
const EAT: &str = "eat";
/// Half of the tolerance that lengths of benches are counted in seats with.
const ROUNDING: f64 = 1e-9;

/// Returns how many people sit on an object of its most common size.
pub fn seats_on(object: &ObjectType) -> u32 {
    seats_across(object.shape, object.sizes_m.first().map_or(0.0, |s| s[0]))
}

/// Returns how many people sit on a thing of this shape and width, m; a bench has a seat for each [`BENCH_SEAT_M`], and one at
/// least.
pub fn seats_across(shape: Shape, width_m: f64) -> u32 {
    match shape {
        Shape::Bench => ((width_m / BENCH_SEAT_M + ROUNDING) as u32).max(1),
        Shape::Chair | Shape::SwivelChair | Shape::Stool => 1,
        _ => 0,
    }
}

/// Returns how many people sit at an object or a group.
pub fn seats_of(domain: &Domain, item: &str) -> u32 {
    domain.counted_objects_of(item).map(|(id, count)| count * domain.object(id).map_or(0, seats_on)).sum()
}

/// Returns the line of counters at which several are served side by side, with its number; none in rooms where one eats: who
/// counts their places means the seats, not the buffets.
pub fn counters<'a>(domain: &Domain, kind: &'a RoomType) -> Option<(usize, &'a Furnishing)> {
    let is_counter =
        |f: &Furnishing| f.required && f.max > 1 && domain.anchor(&f.item).is_some_and(|o| o.shape == Shape::Counter);
    let eats = kind.tags.iter().any(|t| t == EAT);
    kind.furnishing.iter().enumerate().find(|(_, f)| !eats && is_counter(f))
}

/// Returns true for rooms with counters side by side.
pub fn has_counters(domain: &Domain, kind: &RoomType) -> bool {
    counters(domain, kind).is_some()
}

/// Seats of a room for so many people.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seating {
    /// Most seats at its one table, or most counters; `u32::MAX` where seats stand in rows.
    pub most: u32,
    /// Floor that the seats asked for need, m^2.
    pub area_m2: f64,
}

/// Returns the seats of a room of a type that `wanted` people are to sit in, and the floor they need; `None` for rooms that
/// nobody sits in.
pub fn seating(domain: &Domain, kind: &RoomType, wanted: u32) -> Option<Seating> {
    let n = f64::from(wanted);
    if let Some((_, line)) = counters(domain, kind) {
        return Some(Seating { most: line.max, area_m2: 2.0 * SPARE_M2 + AT_COUNTER_M2 * n });
    }
    let many = kind.furnishing.iter().filter(|f| f.max > 1 && f.area_per_item_m2 > 0.0);
    let many = many.map(|f| (f, seats_of(domain, &f.item))).find(|(f, each)| *each > 0 && eats_or_waits(domain, f));
    if let Some((line, each)) = many {
        let small = domain.anchor(&line.item).is_some_and(|o| matches!(o.shape, Shape::Bench | Shape::Chair));
        let most = if small { IN_ROWS_M2 } else { AT_TABLES_M2 };
        let apiece = (line.area_per_item_m2 / f64::from(each)).min(most);
        return Some(Seating { most: u32::MAX, area_m2: SPARE_M2 + apiece * n });
    }
    let table = |f: &&Furnishing| f.max == 1 && f.arrangement == Arrangement::Center;
    let most = kind.furnishing.iter().filter(table).map(|f| seats_of(domain, &f.item)).max().filter(|n| *n > 0)?;
    Some(Seating { most, area_m2: SPARE_M2 + AT_TABLE_M2 * n })
}

/// Returns how many people a room of this area (m^2) seats in rows or at small tables, where nobody says a number; 0 for all other
/// rooms, those with one table among them.
pub fn seated_in(domain: &Domain, kind: &RoomType, area_m2: f64) -> u32 {
    let Some((one, two)) = seating(domain, kind, 1).zip(seating(domain, kind, 2)) else { return 0 };
    let apiece = two.area_m2 - one.area_m2;
    let spare = one.area_m2 - apiece;
    if one.most < u32::MAX { 0 } else { ((area_m2 - spare) / apiece).max(0.0) as u32 }
}

/// Returns true for seats that fill a room: not the chairs for visitors beside its desks.
fn eats_or_waits(domain: &Domain, line: &Furnishing) -> bool {
    let shape = domain.anchor(&line.item).map(|o| o.shape);
    let bench = shape == Some(Shape::Bench);
    line.required || bench || matches!(shape, Some(Shape::Table | Shape::RoundTable))
}
