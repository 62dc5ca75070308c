//! What a reviewer of plans objects to and geometry can tell, over many seeds: showers that stand about, desks in ragged
//! rows, nurses far from their corridor, isolation rooms without their anteroom, homes entered by the bedrooms.
//!
//! No rule forbids these; they are what makes a plan look wrong.

#![allow(clippy::unwrap_used)] // helpers of tests are tests

use std::sync::atomic::AtomicBool;

use d3dgen_model::Rect;
use d3dgen_model::floorplan::{DoorKind, PlanRoom};
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::{Settings, generate_world};
use d3dgen_pipeline::scene_graph::{Request, generate};
use d3dgen_plugins::Registry;

/// Bodies nearer than this touch, m: skirting and tiles.
const TOUCH_M: f64 = 0.13;

fn worlds(prompt: &str, seeds: u64) -> Vec<World> {
    let registry = Registry::builtin();
    let made = (0..seeds).map(|seed| {
        let request = Request { prompt: prompt.into(), seed, ..Request::default() };
        generate_world(&request, &registry, &Settings::default(), &mut |_| (), &AtomicBool::new(false)).unwrap().world
    });
    made.collect()
}

fn placed<'w>(world: &'w World, room: &'w PlanRoom, object: &'w str) -> impl Iterator<Item = &'w Placement> {
    let own = move |p: &&Placement| p.room_id == room.room_id && p.object == object;
    world.placements.placements.iter().filter(own)
}

/// Returns how far a body is from the walls of its room to the left or right and below or above it, m.
fn to_walls(room: &PlanRoom, body: &Rect) -> [f64; 2] {
    let corners = room.net_polygon.corners();
    let mut nearest = [f64::MAX; 2];
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        if (a.x - b.x).abs() < 1e-6 {
            if a.y.min(b.y) < body.y1 && a.y.max(b.y) > body.y0 {
                nearest[0] = nearest[0].min((body.x0 - a.x).abs()).min((body.x1 - a.x).abs());
            }
        } else if a.x.min(b.x) < body.x1 && a.x.max(b.x) > body.x0 {
            nearest[1] = nearest[1].min((body.y0 - a.y).abs()).min((body.y1 - a.y).abs());
        }
    }
    nearest
}

#[test]
fn showers_stand_in_corners() {
    let (mut all, mut cornered) = (0, 0);
    for prompt in ["flat with 5 rooms", "family house in Germany with 8 rooms", "hospital ward with 8 rooms"] {
        for world in worlds(prompt, 8) {
            for room in &world.floorplan.rooms {
                for shower in placed(&world, room, "shower") {
                    all += 1;
                    cornered += u32::from(to_walls(room, &shower.footprint().bounds()).iter().all(|d| *d < TOUCH_M));
                }
            }
        }
    }
    assert!(all >= 24, "{all} showers in 24 worlds");
    assert!(f64::from(cornered) >= 0.9 * f64::from(all), "{cornered} of {all} showers stand in a corner");
}

#[test]
fn desks_of_an_open_office_stand_face_to_face() {
    let (mut all, mut together) = (0, 0);
    for prompt in ["office with 5 rooms", "office in the United States with 8 rooms", "office in London with 10 rooms"]
    {
        for world in worlds(prompt, 6) {
            for room in world.floorplan.rooms.iter().filter(|r| r.room_type == "open_office") {
                let desks: Vec<Rect> = placed(&world, room, "desk").map(|p| p.footprint().bounds()).collect();
                let touches = |a: &Rect, b: &Rect| {
                    let within = |a0: f64, a1: f64, b0: f64, b1: f64| a0 < b1 - TOUCH_M && b0 < a1 - TOUCH_M;
                    let side_by_side = (a.x1 - b.x0).abs() < TOUCH_M || (b.x1 - a.x0).abs() < TOUCH_M;
                    let above = (a.y1 - b.y0).abs() < TOUCH_M || (b.y1 - a.y0).abs() < TOUCH_M;
                    side_by_side && within(a.y0, a.y1, b.y0, b.y1) || above && within(a.x0, a.x1, b.x0, b.x1)
                };
                let neighbors = |d: &Rect| desks.iter().filter(|o| *o != d && touches(d, o)).count();
                all += desks.len();
                together += desks.iter().filter(|d| neighbors(d) >= 2).count();
            }
        }
    }
    assert!(all > 100, "{all} desks in 18 offices");
    assert!(together as f64 >= 0.6 * all as f64, "{together} of {all} desks have two others beside and opposite them");
}

#[test]
fn nurses_sit_at_their_corridor() {
    let (mut all, mut near) = (0, 0);
    for prompt in ["hospital ward with 8 rooms in Germany", "Medical ward of ten rooms in London"] {
        for world in worlds(prompt, 10) {
            for room in world.floorplan.rooms.iter().filter(|r| r.room_type == "nurse_station") {
                let open = |d: &&d3dgen_model::floorplan::Door| d.kind == DoorKind::Open;
                let Some(opening) = world.floorplan.doors_of(&room.room_id).find(open) else { continue };
                let from = opening.line.start;
                let to = opening.line.end;
                for counter in placed(&world, room, "small_nurse_counter") {
                    all += 1;
                    let body = counter.footprint().bounds();
                    let away = if opening.line.is_vertical() {
                        (body.x0 - from.x).abs().min((body.x1 - from.x).abs())
                    } else {
                        (body.y0 - to.y).abs().min((body.y1 - to.y).abs())
                    };
                    near += u32::from(away < 2.5);
                }
            }
        }
    }
    assert!(all >= 15, "{all} counters at open fronts in 20 wards");
    assert!(f64::from(near) >= 0.9 * f64::from(all), "{near} of {all} counters are within 2.5 m of the corridor");
}

#[test]
fn isolation_rooms_have_their_anteroom() {
    let registry = Registry::builtin();
    let mut found = 0;
    for rooms in 5..=16 {
        let prompt = format!("intensive care unit with {rooms} rooms");
        let graph = generate(&Request { prompt, ..Request::default() }, &registry).unwrap();
        let count = |kind: &str| graph.rooms.iter().filter(|r| r.room_type == kind).count();
        assert_eq!(count("isolation_room"), count("anteroom"), "{rooms} rooms");
        let asked = graph.rooms.iter().filter(|r| !r.circulation).count();
        assert_eq!(asked, rooms);
        found += count("isolation_room");
    }
    assert!(found > 0, "some intensive care unit has an isolation room");
}

#[test]
fn homes_are_entered_by_the_rooms_of_the_day() {
    let (mut homes, mut first, mut last, mut wrong_order) = (0_u32, 0, 0, 0);
    for prompt in ["flat with 5 rooms", "family house in Germany with 8 rooms", "house with 4 bedrooms and two bathrooms"]
    {
        for world in worlds(prompt, 16) {
            let plan = &world.floorplan;
            let Some(entrance) = plan.doors.iter().find(|d| d.entrance) else { continue };
            let walk = |room: &PlanRoom| {
                let doors = plan.doors_of(&room.room_id).map(|d| d.line.middle());
                let far = doors.map(|p| (p.x - entrance.line.middle().x).abs() + (p.y - entrance.line.middle().y).abs());
                far.fold(f64::MAX, f64::min)
            };
            let of = |kind: &'static str| plan.rooms.iter().filter(move |r| r.room_type == kind);
            let Some(living) = of("living_room").next() else { continue };
            let nights: Vec<f64> = of("bedroom").map(walk).collect();
            homes += 1;
            first += u32::from(nights.iter().all(|far| walk(living) <= *far));
            last += u32::from(nights.iter().all(|far| walk(living) > *far));
            wrong_order += u32::from(of("bedroom").any(|bed| bed.net_area_m2 > living.net_area_m2));
        }
    }
    assert!(homes >= 40, "{homes}");
    println!("of {homes} homes {first} have the living room first, {last} last, {wrong_order} a larger bedroom");
    assert!(first * 3 >= homes && last * 4 <= homes, "{first} first, {last} last of {homes}");
    assert!(wrong_order * 20 <= homes, "{wrong_order} of {homes} have a bedroom larger than the living room");
}
