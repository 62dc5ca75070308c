//! Free floor, door sides, docks and labels of finished worlds, over prompts of many kinds of building.

use std::sync::atomic::AtomicBool;

use d3dgen_eval::{Known, measure};
use d3dgen_export::exporters::plan::legibility;
use d3dgen_model::Rect;
use d3dgen_model::floorplan::{Door, DoorKind};
use d3dgen_model::scenario::RoiKind;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::{Settings, generate_world};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_plugins::Registry;

const PROMPTS: [&str; 9] = [
    "Modern apartment with 5 rooms in Germany for a cleaning robot",
    "House with 4 bedrooms, kitchen, dining room, study and two bathrooms",
    "two-bedroom flat in Spain",
    "Hospital ward with 8 rooms in Germany, for a delivery robot",
    "clinic with five exam rooms, a laboratory and a waiting area in the United States",
    "office for 12 people with two meeting rooms",
    "Office with 8 rooms in Japan",
    "primary school with four classrooms",
    "hotel with 9 rooms in total",
];

fn world(registry: &Registry, prompt: &str, seed: u64) -> World {
    let request = Request { prompt: prompt.into(), seed, ..Request::default() };
    let made = generate_world(&request, registry, &Settings::default(), &mut |_| (), &AtomicBool::new(false)).unwrap();
    assert!(made.report.is_writable(), "{prompt}, seed {seed}");
    made.world
}

fn worlds(seeds: std::ops::Range<u64>) -> impl Iterator<Item = (String, World)> {
    let registry = Registry::builtin();
    PROMPTS
        .iter()
        .flat_map(move |prompt| seeds.clone().map(move |seed| (*prompt, seed)))
        .map(move |(prompt, seed)| (format!("{prompt}, seed {seed}"), world(&registry, prompt, seed)))
}

#[test]
fn no_pocket_of_floor_is_closed_off_and_no_door_side_blocked() {
    let (mut closed, mut windows, mut taken) = (Vec::new(), 0, 0);
    for (name, world) in worlds(0..3) {
        let found = measure(&world, None, "w", &Known::default());
        let nav = &found.navigability;
        if nav.house < 1.0 || nav.rooms_least < 1.0 {
            closed.push(format!("{name}: {} of the house, {} of {}", nav.house, nav.rooms_least, nav.least_room));
        }
        let doors = world.floorplan.doors.iter().map(|d| &d.door_id);
        let before: Vec<_> = found.openings.blocked.iter().filter(|b| doors.clone().any(|id| *id == b[0])).collect();
        assert!(before.is_empty(), "{name}: {before:?}");
        windows += found.openings.windows;
        taken += (found.openings.windows_blocked * f64::from(found.openings.windows)).round() as u32;
    }
    assert!(closed.is_empty(), "{closed:#?}");
    assert!(windows > 150 && taken * 50 <= windows, "{taken} of {windows} windows have something before them");
}

/// Returns the floor over which a door's leaf swings.
fn swing(door: &Door, world: &World) -> Option<Rect> {
    let room = world.floorplan.room(door.swing.as_ref()?.into_room_id.as_deref()?)?;
    let (a, b, length) = (door.line.start, door.line.end, door.line.length());
    let depth = if door.kind == DoorKind::DoubleHinged { length / 2.0 } else { length };
    let depth = depth + door.wall_thickness_m / 2.0;
    let center = room.net_polygon.bounds().center();
    let side = |at: f64, middle: f64| if middle > at { depth } else { -depth };
    let (dx, dy) = if door.line.is_vertical() { (side(a.x, center.x), 0.0) } else { (0.0, side(a.y, center.y)) };
    Some(Rect::new(a.x, a.y, b.x + dx, b.y + dy))
}

#[test]
fn robots_charge_clear_of_door_swings() {
    let registry = Registry::builtin();
    let (mut docks, mut swept) = (0, Vec::new());
    for prompt in [
        "A flat with five rooms in Berlin, Germany, for a cleaning robot",
        "house with 3 bedrooms and a cleaning robot",
        "Hospital ward with 6 rooms in Germany, for a delivery robot",
        "office with 7 rooms for a delivery robot",
    ] {
        for seed in 200..208 {
            let world = world(&registry, prompt, seed);
            let buffers = world.scenario.rois.iter().filter(|r| r.kind == RoiKind::ChargingBuffer);
            for buffer in buffers {
                docks += 1;
                let doors = world
                    .floorplan
                    .doors_of(&buffer.room_id)
                    .filter(|d| d.swing.as_ref().is_some_and(|s| s.into_room_id.as_ref() == Some(&buffer.room_id)));
                let bounds = buffer.polygon.bounds().grown(-0.001);
                swept.extend(
                    doors
                        .filter(|d| swing(d, &world).is_some_and(|s| s.overlaps(&bounds)))
                        .map(|d| format!("{prompt}, seed {seed}: {} by {}", buffer.roi_id, d.door_id)),
                );
            }
        }
    }
    assert!(docks >= 20, "{docks}");
    // a room may have no other place, and no other room may suit
    assert!(swept.len() * 20 <= docks, "{} of {docks}: {swept:#?}", swept.len());
}

#[test]
fn room_names_stand_on_free_floor() {
    let registry = Registry::builtin();
    let (mut rooms, mut numbered) = (0, 0);
    let (mut labels, mut on_furniture, mut on_swings) = (0.0, 0.0, 0.0);
    for (_, world) in worlds(0..2) {
        let domain = registry.get(&world.scene_graph.domain).unwrap().domain();
        let found = legibility(&world, domain);
        rooms += found.rooms;
        numbered += found.numbered;
        labels += found.labels_m2;
        on_furniture += found.on_furniture_m2;
        on_swings += found.on_swings_m2;
    }
    println!(
        "{rooms} rooms, {numbered} numbered; of {labels:.1} m2 {on_furniture:.3} on furniture, {on_swings:.3} on swings"
    );
    assert!(rooms > 140, "{rooms}");
    assert!(numbered * 50 <= rooms, "{numbered} of {rooms} rooms have a number only");
    assert!(on_furniture <= 0.001 * labels, "{on_furniture:.3} of {labels:.1} m2 lie on furniture");
    assert!(on_swings <= 0.01 * labels, "{on_swings:.3} of {labels:.1} m2 lie where doors swing");
}
