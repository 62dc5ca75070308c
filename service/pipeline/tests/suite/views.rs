//! What a reviewer of plans objects to in what one sees and what opens where: bathrooms one looks into, leaves that shut
//! someone in, baths that a wheelchair cannot use.

use d3dgen_model::floorplan::{Door, DoorKind};
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;

use crate::common::{gap, most, worlds};

/// Across a corridor no wider than this one looks from one room into the other, m.
const ACROSS_M: f64 = 2.5;

/// Returns where a door stands: its wall's direction, the wall and the two ends along it.
fn extent(door: &Door) -> (bool, f64, f64, f64) {
    let (a, b) = (door.line.start, door.line.end);
    let vertical = door.line.is_vertical();
    let (at, from, to) = if vertical { (a.x, a.y, b.y) } else { (a.y, a.x, b.x) };
    (vertical, at, from.min(to), from.max(to))
}

/// Returns the doors of rooms of some types.
fn doors<'w>(world: &'w World, types: &'w [&'w str]) -> impl Iterator<Item = &'w Door> {
    let is = move |id: &String| world.floorplan.room(id).is_some_and(|r| types.contains(&r.room_type.as_str()));
    world.floorplan.doors.iter().filter(move |d| d.room_ids.iter().any(is))
}

#[test]
fn one_does_not_look_from_the_kitchen_or_the_table_into_a_bathroom() {
    let mut held = Vec::new();
    for prompt in ["house with 8 rooms", "apartment with 10 rooms in Berlin", "five rooms, residential, Japan"] {
        for world in worlds(prompt, 8) {
            let faces = |a: &Door, b: &Door| {
                let ((v, at, from, to), (w, other, low, high)) = (extent(a), extent(b));
                let across = (0.05..ACROSS_M).contains(&(at - other).abs());
                v == w && across && to.min(high) - from.max(low) > 0.25
            };
            let private = |d: &&Door| doors(&world, &["hallway"]).any(|h| h.door_id == d.door_id);
            let company: Vec<&Door> =
                doors(&world, &["kitchen", "dining_room", "living_room"]).filter(private).collect();
            let baths = doors(&world, &["bathroom", "toilet"]).filter(private);
            held.extend(baths.map(|bath| !company.iter().any(|room| faces(bath, room))));
        }
    }
    assert!(held.len() >= 20, "{}", held.len()); // en suites have no door to the hall
    most("bathroom doors that face no kitchen, table or sofa", 0.9, &held);
}

#[test]
fn no_leaf_shuts_in_who_has_fallen_behind_it() {
    let sliding = |world: &World, types: &[&str]| -> Vec<bool> {
        doors(world, types).map(|d| d.kind == DoorKind::Sliding).collect()
    };
    let mut held = Vec::new();
    for world in worlds("hospital ward with 8 rooms and en suites in Germany", 6) {
        held.extend(sliding(&world, &["ensuite", "accessible_toilet", "assisted_bathroom"]));
    }
    for world in worlds("house with 8 rooms in Hamburg, barrier-free", 6) {
        held.extend(sliding(&world, &["bathroom", "toilet"]));
    }
    most("doors of wet rooms that slide", 1.0, &held);
}

#[test]
fn step_free_bathrooms_hold_a_toilet_for_wheelchairs() {
    let mut held = Vec::new();
    for world in worlds("Haus mit 10 Räumen in Hamburg, barrierefrei", 8) {
        for room in world.floorplan.rooms.iter().filter(|r| r.room_type == "bathroom") {
            let own = |p: &&Placement| p.room_id == room.room_id;
            held.push(world.placements.placements.iter().filter(own).any(|p| p.object == "accessible_wc"));
        }
    }
    most("step-free bathrooms", 0.9, &held);
}

#[test]
fn ways_out_of_wards_open_outwards() {
    for world in worlds("hospital ward with 8 rooms", 4) {
        let out = world.floorplan.doors.iter().filter(|d| d.room_ids.len() == 1);
        let open = |d: &Door| d.swing.as_ref().is_none_or(|s| s.into_room_id.is_none());
        assert!(out.clone().count() > 0 && out.clone().all(open), "a way out opens against those who flee");
    }
}

#[test]
fn clean_and_dirty_utilities_seldom_share_a_wall() {
    let mut held = Vec::new();
    for world in worlds("A geriatric ward of 10 rooms in Japan", 24) {
        let of = |kind: &'static str| world.floorplan.rooms.iter().filter(move |r| r.room_type == kind);
        for clean in of("clean_utility") {
            let own = clean.net_polygon.bounds();
            held.extend(of("dirty_utility").map(|dirty| gap(&own, &dirty.net_polygon.bounds()) > 0.3));
        }
    }
    assert!(held.len() >= 8, "{}", held.len());
    most("clean and dirty utilities apart", 0.75, &held);
}
