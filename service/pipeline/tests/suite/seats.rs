//! Rooms full of tables: as many seats as guests were asked for, and rows without holes.

use std::collections::BTreeMap;

use d3dgen_model::placements::Placement;

use crate::common::{in_room, most, named, rooms, worlds};

/// Share of the guests of a prompt who find a seat in most worlds: floor for people and robots goes before the last table, which
/// in a cafe is one of six.
const SEATED: f64 = 0.8;

/// Prompts with the type of the room that is to seat so many, and what they sit on.
const GUESTS: [(&str, &str, &str, usize); 3] = [
    ("restaurant with 40 seats in Spain", "dining_room", "dining_chair", 40),
    ("restaurant for 80 guests in Italy, for a service robot", "dining_room", "dining_chair", 80),
    ("cafe with 24 seats", "cafe", "dining_chair", 24),
];

#[test]
fn guests_find_a_seat() {
    for (prompt, room_type, seat, guests) in GUESTS {
        let seats = |world| rooms(world, room_type).map(|room| named(world, room, seat).len()).sum::<usize>();
        let held: Vec<bool> = worlds(prompt, 8).iter().map(|w| seats(w) as f64 >= SEATED * guests as f64).collect();
        most(prompt, 0.8, &held);
    }
}

#[test]
fn rows_of_pupils_have_no_holes() {
    // tables of one row by where it runs; the last one may be shorter than the others
    let whole = |tables: &[&Placement]| {
        let mut rows: BTreeMap<i64, usize> = BTreeMap::new();
        for p in tables {
            let (sin, cos) = p.pose.yaw_rad.sin_cos();
            *rows.entry(((p.pose.x * cos + p.pose.y * sin) * 20.0).round() as i64).or_default() += 1;
        }
        let longest = rows.values().max().copied().unwrap_or(0);
        rows.values().filter(|n| **n < longest).count() <= 1
    };
    let mut held = Vec::new();
    for world in worlds("primary school with 4 classrooms", 6) {
        for room in rooms(&world, "classroom") {
            let tables: Vec<&Placement> =
                in_room(&world, &room.room_id).filter(|p| p.object == "pupil_table").collect();
            assert!(!tables.is_empty(), "no pupil sits in {}", room.room_id);
            held.push(whole(&tables));
        }
    }
    most("rows without holes", 0.9, &held);
}
