//! Edits of finished worlds: what is asked for is done or refused, what it does not touch stays to the millimeter, and the
//! outcome is sound.

use std::sync::atomic::AtomicBool;

use d3dgen_model::document::Document;
use d3dgen_model::edits::Edit;
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::placements::Placement;
use d3dgen_model::sanitary;
use d3dgen_model::world::World;
use d3dgen_pipeline::edit::{self, Edited};
use d3dgen_pipeline::generate::{Generated, Settings, generate_world};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::{Error, Stop};
use d3dgen_plugins::Registry;

use crate::common::in_room;

const HOME: &str = "apartment with a living room, a kitchen, two bedrooms and a bathroom";
const OFFICE: &str = "office with 9 rooms for a cleaning robot";
const WARD: &str = "hospital ward with 8 rooms in Germany";
const LARGER_WARD: &str = "hospital ward with 10 rooms in Germany";

fn made(registry: &Registry, prompt: &str, seed: u64, settings: &Settings) -> Generated {
    let request = Request { prompt: prompt.into(), seed, ..Request::default() };
    let made = generate_world(&request, registry, settings, &mut |_| {}, &AtomicBool::new(false)).expect(prompt);
    assert!(made.report.sound, "{prompt} with seed {seed}");
    made
}

fn world(registry: &Registry, prompt: &str, seed: u64) -> World {
    made(registry, prompt, seed, &Settings::default()).world
}

fn edited(registry: &Registry, world: &World, edits: &[Edit]) -> Result<Edited, Error> {
    let plugin = registry.get(&world.scene_graph.domain).expect("its domain is built in");
    let edited = edit::apply(world, edits, plugin, Stop::never())?;
    let broken: Vec<_> = edited.report.rules.iter().filter(|r| !r.violations.is_empty()).map(|r| &r.rule).collect();
    assert!(edited.report.sound, "{edits:?} breaks {broken:?}");
    assert_eq!(edited.world.check(), []);
    // What the edit did not change is as it was.
    for room in &edited.world.floorplan.rooms {
        let Some(old) = world.floorplan.room(&room.room_id) else { continue };
        if edited.changed_room_ids.contains(&room.room_id) {
            continue;
        }
        assert_eq!(outline(room), outline(old), "{edits:?}: {}", room.room_id);
        let id = &room.room_id;
        assert!(in_room(&edited.world, id).eq(in_room(world, id)), "{edits:?}: {id} is furnished otherwise");
    }
    Ok(edited)
}

fn outline(room: &PlanRoom) -> String {
    format!("{:?}", room.net_polygon)
}

fn find<'w>(world: &'w World, object: &str) -> &'w Placement {
    let found = world.placements.placements.iter().find(|p| p.object == object);
    found.unwrap_or_else(|| panic!("{} has no {object}", world.name))
}

/// Returns the outlines of rooms that are not locked, to compare plans by.
fn free_outlines(plan: &Floorplan) -> Vec<String> {
    plan.rooms.iter().filter(|r| !r.locked).map(outline).collect()
}

#[test]
fn locked_rooms_stay_and_the_others_are_planned_anew() {
    let registry = Registry::builtin();
    for (prompt, kind) in [(HOME, "bedroom"), (OFFICE, "meeting_room"), (WARD, "patient_room")] {
        let first = world(&registry, prompt, 11);
        let mut pinned = first.floorplan.clone();
        let room = pinned.rooms.iter_mut().find(|r| r.room_type.starts_with(kind));
        let room = room.unwrap_or_else(|| panic!("{prompt} has a {kind}"));
        room.locked = true;
        let id = room.room_id.clone();
        let doors = |plan: &Floorplan| plan.doors_of(&id).map(|d| (d.door_id.clone(), d.line)).collect::<Vec<_>>();
        let windows =
            |plan: &Floorplan| plan.windows.iter().filter(|w| w.room_id == id).map(|w| w.line).collect::<Vec<_>>();
        let mut others = Vec::new();
        for seed in 20..24 {
            let request = Request { prompt: prompt.into(), seed, ..Request::default() };
            let settings = Settings { pinned_floorplan: Some(pinned.clone()), ..Settings::default() };
            let made =
                generate_world(&request, &registry, &settings, &mut |_| {}, &AtomicBool::new(false)).expect(prompt);
            assert!(made.report.sound, "{prompt} with {id} locked, seed {seed}");
            let plan = &made.world.floorplan;
            assert_eq!(plan.room(&id), pinned.room(&id), "{prompt}, seed {seed}");
            assert_eq!(doors(plan), doors(&pinned));
            assert_eq!(windows(plan), windows(&pinned));
            others.push(free_outlines(plan));
        }
        // around a locked room there may be nothing else; that is then said
        let same = others.iter().filter(|o| **o == free_outlines(&pinned)).count();
        assert!(same <= 1, "{prompt}: the rooms that are not locked were not planned anew");
        others.sort();
        others.dedup();
        assert!(others.len() > 1, "{prompt}: seeds make no difference");
    }
}

#[test]
fn inner_walls_move_or_say_why_not() {
    let registry = Registry::builtin();
    let (mut moved, mut refused) = (0, 0);
    for prompt in [HOME, OFFICE, WARD] {
        let world = world(&registry, prompt, 3);
        for wall in world.floorplan.walls.iter().filter(|w| !w.exterior && w.line.length() > 1.0) {
            for by_m in [0.2, -0.2] {
                let edits = [Edit::MoveWall { wall_id: wall.wall_id.clone(), by_m }];
                match edited(&registry, &world, &edits) {
                    Ok(done) => {
                        let across = |s: &d3dgen_model::Segment| if s.is_vertical() { s.start.x } else { s.start.y };
                        let there = done.world.floorplan.walls.iter().any(|w| {
                            let same = |id: &String| wall.room_ids.contains(id);
                            w.room_ids.iter().all(same)
                                && w.line.is_vertical() == wall.line.is_vertical()
                                && (across(&w.line) - across(&wall.line) - by_m).abs() < 1e-6
                        });
                        assert!(there, "{prompt}: {} did not move by {by_m}", wall.wall_id);
                        moved += 1;
                    }
                    Err(Error::Breaks { .. } | Error::Infeasible { .. } | Error::Refused { .. }) => refused += 1,
                    Err(error) => panic!("{prompt}: {} by {by_m}: {error}", wall.wall_id),
                }
            }
        }
    }
    eprintln!("{moved} walls moved, {refused} refused");
    assert!(moved > refused, "{moved} moved, {refused} refused");
}

#[test]
fn doors_and_windows_slide_along_their_walls_or_say_why_not() {
    let registry = Registry::builtin();
    let (mut moved, mut refused) = (0, 0);
    for prompt in [HOME, OFFICE, WARD] {
        let world = world(&registry, prompt, 3);
        let plan = &world.floorplan;
        let doors = plan.doors.iter().map(|d| (&d.door_id, d.line));
        let openings = doors.chain(plan.windows.iter().map(|w| (&w.window_id, w.line)));
        for (id, line) in openings {
            for by_m in [0.1, -0.1] {
                let edits = [Edit::MoveOpening { opening_id: id.clone(), by_m }];
                match edited(&registry, &world, &edits) {
                    Ok(done) => {
                        let (dx, dy) = if line.is_vertical() { (0.0, by_m) } else { (by_m, 0.0) };
                        let plan = &done.world.floorplan;
                        let doors = plan.doors.iter().map(|d| (&d.door_id, d.line));
                        let now = doors
                            .chain(plan.windows.iter().map(|w| (&w.window_id, w.line)))
                            .find(|(other, _)| *other == id);
                        let middle = line.moved(dx, dy).middle();
                        assert!(
                            now.is_some_and(|(_, now)| now.middle().distance(middle) < 2e-3),
                            "{prompt}: {id} by {by_m}"
                        );
                        moved += 1;
                    }
                    Err(Error::Breaks { .. } | Error::Infeasible { .. } | Error::Refused { .. }) => refused += 1,
                    Err(error) => panic!("{prompt}: {id} by {by_m}: {error}"),
                }
            }
        }
    }
    eprintln!("{moved} openings moved, {refused} refused");
    assert!(moved > refused, "{moved} moved, {refused} refused");
}

#[test]
fn rooms_come_and_go() {
    let registry = Registry::builtin();
    for (prompt, room_type) in [(HOME, "home_office"), (OFFICE, "meeting_room"), (LARGER_WARD, "patient_room")] {
        for seed in 0..3 {
            let world = world(&registry, prompt, seed);
            let Some(kind) = registry.get(&world.scene_graph.domain).and_then(|p| p.domain().room_type(room_type))
            else {
                panic!("{} has no {room_type}", world.scene_graph.domain)
            };
            let add = Edit::AddRoom { room_type: kind.id.clone(), area_m2: None, entered_from: None };
            let more = edited(&registry, &world, &[add]).unwrap_or_else(|e| panic!("{prompt}, seed {seed}: {e}"));
            assert_eq!(more.world.floorplan.rooms.len(), world.floorplan.rooms.len() + 1);
            let new = more.world.floorplan.rooms.iter().find(|r| world.floorplan.room(&r.room_id).is_none());
            let new = new.expect("one room more").room_id.clone();
            assert!(in_room(&more.world, &new).next().is_some(), "{new} stands empty");
            let kept = more.changed_room_ids.len();
            assert!(
                kept <= world.floorplan.rooms.len() / 2 + 2,
                "{prompt}, seed {seed}: {:?} changed",
                more.changed_room_ids
            );
            let less = edited(&registry, &more.world, &[Edit::RemoveRoom { room_id: new.clone() }])
                .unwrap_or_else(|e| panic!("{prompt}, seed {seed}: {e}"));
            assert!(less.world.floorplan.room(&new).is_none());
            assert_eq!(less.world.floorplan.rooms.len(), world.floorplan.rooms.len());
        }
    }
}

#[test]
fn taking_out_what_no_building_is_without_is_said_until_it_is_back() {
    let registry = Registry::builtin();
    let codes = ["vital_room_missing", sanitary::LEFT_OUT];
    let missed = |w: &World| w.scene_graph.conflicts.iter().any(|n| codes.contains(&n.code.as_str()));
    let cases = [
        ("two-bedroom flat with one bathroom", "bathroom_1", true),
        ("two-bedroom flat with one bathroom", "bedroom_2", false),
        ("office with 2 offices, a meeting room and a toilet", "toilet_1", false), // the one for wheelchairs is left
        ("office with 2 offices, a meeting room and a toilet", "meeting_room_1", false),
    ];
    for (prompt, room_id, vital) in cases {
        let world = world(&registry, prompt, 1);
        let room_type = world.scene_graph.room(room_id).unwrap().room_type.clone();
        assert!(!missed(&world), "{prompt}");
        let less = edited(&registry, &world, &[Edit::RemoveRoom { room_id: room_id.into() }]).unwrap().world;
        assert_eq!(missed(&less), vital, "{prompt} without {room_id}: {:?}", less.scene_graph.conflicts);
        let back = [Edit::AddRoom { room_type, area_m2: None, entered_from: None }];
        assert!(!missed(&edited(&registry, &less, &back).unwrap().world), "{prompt}");
    }
}

#[test]
fn a_room_is_added_by_what_prompts_call_it() {
    let registry = Registry::builtin();
    let world = world(&registry, HOME, 0);
    let add = |name: &str| [Edit::AddRoom { room_type: name.into(), area_m2: None, entered_from: None }];
    for name in ["study", "Arbeitszimmer", "home_office"] {
        let more = edited(&registry, &world, &add(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(more.world.floorplan.room("home_office_1").is_some(), "{name}");
    }
    assert!(matches!(edited(&registry, &world, &add("throne hall")), Err(Error::Mismatch { .. })));
}

#[test]
fn objects_are_swapped_moved_added_and_removed() {
    let registry = Registry::builtin();
    let world = world(&registry, HOME, 5);
    let swap = |from: &Placement, to: &str| {
        let edit = Edit::SwapObject { placement_id: from.placement_id.clone(), object: Some(to.into()), asset: None };
        edited(&registry, &world, &[edit])
    };
    let shelf = find(&world, "bookshelf").clone();
    let done = swap(&shelf, "plant").expect("a plant is smaller than a bookshelf");
    assert!(!in_room(&done.world, &shelf.room_id).any(|p| p.object == "bookshelf"));
    assert!(in_room(&done.world, &shelf.room_id).any(|p| p.object == "plant" && p.rule.contains("edit")));
    let required = swap(find(&world, "double_bed"), "plant").map(|_| ()).map_err(|e| e.to_string());
    assert!(required.is_err_and(|e| e.contains("would break")), "a bedroom cannot do without its bed");

    let bed = find(&world, "double_bed").clone();
    let moved =
        [0.1, -0.1, 0.2, -0.2, 0.3, -0.3].into_iter().flat_map(|d| [(d, 0.0), (0.0, d)]).find_map(|(dx, dy)| {
            let (x, y) = (bed.pose.x + dx, bed.pose.y + dy);
            let shift = Edit::MoveObject { placement_id: bed.placement_id.clone(), x, y, yaw_rad: None };
            edited(&registry, &world, &[shift]).ok().map(|done| (done, x, y))
        });
    let (done, x, y) = moved.expect("a bed can be moved a little to some side");
    let now = done.world.placements.placements.iter().find(|p| p.placement_id == bed.placement_id);
    let now = now.expect("it is still there");
    assert!((now.pose.x - x).abs() < 0.001 && (now.pose.y - y).abs() < 0.001);
    assert_eq!(done.changed_room_ids, std::slice::from_ref(&bed.room_id));

    let count = |w: &World, room: &str| in_room(w, room).filter(|p| p.object == "plant").count();
    let added = world.floorplan.rooms.iter().filter(|r| !r.circulation).find_map(|room| {
        let add = Edit::AddObject { room_id: room.room_id.clone(), object: "plant".into() };
        Some((room.room_id.as_str(), edited(&registry, &world, &[add]).ok()?))
    });
    let (room, done) = added.expect("some room has a place for a plant");
    assert_eq!(count(&done.world, room), count(&world, room) + 1);
    let plant = in_room(&done.world, room).filter(|p| p.rule.contains("edit")).last().expect("added");
    let remove = Edit::RemoveObject { placement_id: plant.placement_id.clone() };
    let back = edited(&registry, &done.world, &[remove]).expect("a plant can go");
    assert_eq!(count(&back.world, room), count(&world, room));
}

#[test]
fn what_is_taken_away_is_gone_or_the_rule_is_named_that_it_would_break() {
    let registry = Registry::builtin();
    let world = world(&registry, HOME, 1);
    let (mut gone, mut refused) = (0, 0);
    for p in &world.placements.placements {
        let edits = [Edit::RemoveObject { placement_id: p.placement_id.clone() }];
        match edited(&registry, &world, &edits) {
            Ok(done) => {
                let count = |w: &World| in_room(w, &p.room_id).filter(|q| q.object == p.object).count();
                assert!(count(&done.world) < count(&world), "{} is there again", p.placement_id);
                gone += 1;
            }
            Err(error) => {
                assert!(error.to_string().contains("it would break "), "{}: {error}", p.placement_id);
                refused += 1;
            }
        }
    }
    eprintln!("{gone} objects taken away, {refused} refused");
    assert!(gone > 4 * refused && refused > 0, "{gone} gone, {refused} refused");
}

#[test]
fn what_is_locked_or_unknown_is_refused_with_the_number_of_the_edit() {
    let registry = Registry::builtin();
    let world = world(&registry, HOME, 5);
    let sofa = find(&world, "sofa").placement_id.clone();
    let lock = Edit::Lock { ids: vec![sofa.clone(), "kitchen_1".into()], locked: true, contents: false };
    let text = |edits: &[Edit]| match edited(&registry, &world, edits) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("{edits:?} was carried out"),
    };
    let remove = Edit::RemoveObject { placement_id: sofa };
    assert!(text(&[lock.clone(), remove]).contains("edit 2: `living_room_1_sofa_1` is locked"));
    let wall = world.floorplan.walls.iter().find(|w| !w.exterior && w.room_ids.contains(&"kitchen_1".to_owned()));
    let wall_id = wall.expect("a kitchen has an inner wall").wall_id.clone();
    let shift = Edit::MoveWall { wall_id, by_m: 0.1 };
    assert!(text(&[lock, shift]).contains("kitchen_1`, which is locked"));
    assert!(text(&[Edit::RemoveRoom { room_id: "cellar_1".into() }]).contains("no room `cellar_1`"));
    let room_type = "dungeon".to_owned();
    assert!(text(&[Edit::AddRoom { room_type, area_m2: None, entered_from: None }]).contains("it has "));
    let far = Edit::MoveObject { placement_id: "living_room_1_sofa_1".into(), x: 900.0, y: 0.0, yaw_rad: None };
    assert!(text(&[far]).contains("does not stand inside"));
}

#[test]
fn the_same_edits_give_the_same_world() {
    let registry = Registry::builtin();
    let world = world(&registry, OFFICE, 8);
    let edits = [Edit::AddRoom { room_type: "storage".into(), area_m2: Some(8.0), entered_from: None }];
    let [a, b] = [0, 1].map(|_| edited(&registry, &world, &edits).expect("there is a place").world.to_json());
    assert_eq!(a, b);
}
