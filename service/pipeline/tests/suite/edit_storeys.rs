//! Edits of buildings with several storeys: the storey that is meant changes, the others stay to the millimeter, stairs and
//! elevators stay above each other, and the outcome is sound.

use std::sync::atomic::AtomicBool;

use d3dgen_model::document::Document;
use d3dgen_model::domain::Mount;
use d3dgen_model::edits::Edit;
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;
use d3dgen_pipeline::edit::{self, Edited};
use d3dgen_pipeline::generate::{Settings, generate_world, retrieve};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::variations::variations;
use d3dgen_pipeline::{Error, Stop};
use d3dgen_plugins::Registry;

use crate::common::in_room;

const HOUSE: &str = "two-storey house with 3 bedrooms";
const OFFICE: &str = "three floor office building";
const STOREYS: &str = "hotel with 3 storeys, a basement floor with a storage, and 12 guest rooms";

fn world(registry: &Registry, prompt: &str, seed: u64, pinned: Option<Floorplan>) -> World {
    let request = Request { prompt: prompt.into(), seed, ..Request::default() };
    let settings = Settings { pinned_floorplan: pinned, ..Settings::default() };
    let made = generate_world(&request, registry, &settings, &mut |_| {}, &AtomicBool::new(false)).expect(prompt);
    let broken: Vec<_> = made.report.rules.iter().filter(|r| !r.violations.is_empty()).map(|r| &r.rule).collect();
    assert!(made.report.sound, "{prompt} with seed {seed} breaks {broken:?}");
    made.world
}

/// Returns one storey of a plan without what is said of the whole building.
fn storey(plan: &Floorplan, level: i32) -> Floorplan {
    let mut storey = plan.storey(level);
    (storey.cost, storey.conflicts, storey.seed) = (Vec::new(), Vec::new(), 0);
    storey
}

/// Checks that stairs and elevators stand where they stood, each with its doors.
fn cores_stay(before: &Floorplan, after: &Floorplan) {
    assert_eq!(before.links, after.links);
    for id in before.links.iter().flat_map(|l| &l.room_ids) {
        assert_eq!(before.room(id), after.room(id), "{id}");
        let doors = |plan: &Floorplan| plan.doors_of(id).cloned().collect::<Vec<_>>();
        assert_eq!(doors(before), doors(after), "{id}");
    }
}

/// Applies edits of one storey and checks all that must hold of it.
fn edited(registry: &Registry, world: &World, level: i32, edits: &[Edit]) -> Result<Edited, Error> {
    let plugin = registry.get(&world.scene_graph.domain).expect("its domain is built in");
    let edited = edit::apply(world, edits, plugin, Stop::never())?;
    let broken: Vec<_> = edited.report.rules.iter().filter(|r| !r.violations.is_empty()).map(|r| &r.rule).collect();
    assert!(edited.report.sound, "{edits:?} breaks {broken:?}");
    assert_eq!(edited.world.check(), []);
    let (before, after) = (&world.floorplan, &edited.world.floorplan);
    cores_stay(before, after);
    for other in before.level_numbers().into_iter().filter(|l| *l != level) {
        assert_eq!(storey(before, other), storey(after, other), "{edits:?}: storey {other}");
        for room in before.rooms.iter().filter(|r| r.level == other) {
            assert!(in_room(world, &room.room_id).eq(in_room(&edited.world, &room.room_id)), "{edits:?}");
        }
    }
    for room in &after.rooms {
        let changed = edited.changed_room_ids.contains(&room.room_id);
        assert!(!changed || room.level == level, "{edits:?} changed {} on storey {}", room.room_id, room.level);
        if let Some(old) = before.room(&room.room_id).filter(|_| !changed) {
            assert_eq!(old.net_polygon, room.net_polygon, "{edits:?}: {}", room.room_id);
            assert!(in_room(world, &room.room_id).eq(in_room(&edited.world, &room.room_id)), "{edits:?}");
        }
    }
    Ok(edited)
}

fn plain_rooms(world: &World, level: i32) -> Vec<&PlanRoom> {
    world.floorplan.rooms.iter().filter(|r| r.level == level && !r.circulation).collect()
}

fn way_of(world: &World, level: i32) -> String {
    let linked = |id: &String| world.floorplan.links.iter().any(|l| l.room_ids.contains(id));
    let way = world.floorplan.rooms.iter().find(|r| r.level == level && r.circulation && !linked(&r.room_id));
    way.unwrap_or_else(|| panic!("storey {level} has a corridor")).room_id.clone()
}

#[test]
fn walls_move_on_their_storey() {
    let registry = Registry::builtin();
    for prompt in [HOUSE, OFFICE] {
        let world = world(&registry, prompt, 3, None);
        for level in world.floorplan.level_numbers() {
            let (mut moved, mut refused) = (0, 0);
            let plan = world.floorplan.storey(level);
            for wall in plan.walls.iter().filter(|w| !w.exterior && w.line.length() > 1.0) {
                for by_m in [0.2, -0.2] {
                    let edits = [Edit::MoveWall { wall_id: wall.wall_id.clone(), by_m }];
                    match edited(&registry, &world, level, &edits) {
                        Ok(done) => {
                            let across =
                                |s: &d3dgen_model::Segment| if s.is_vertical() { s.start.x } else { s.start.y };
                            let there = done.world.floorplan.walls.iter().any(|w| {
                                w.room_ids.iter().all(|id| wall.room_ids.contains(id))
                                    && w.line.is_vertical() == wall.line.is_vertical()
                                    && (across(&w.line) - across(&wall.line) - by_m).abs() < 1e-6
                            });
                            assert!(there, "{prompt}: {} did not move by {by_m}", wall.wall_id);
                            moved += 1;
                        }
                        Err(
                            Error::Breaks { message, .. }
                            | Error::Infeasible { message, .. }
                            | Error::Refused { message, .. },
                        ) => {
                            assert!(message.starts_with("edit 1: "), "{message}");
                            refused += 1;
                        }
                        Err(other) => panic!("{prompt}: {other}"),
                    }
                }
            }
            assert!(moved > 0, "{prompt}: no wall of storey {level} could move, {refused} were refused");
        }
    }
}

#[test]
fn stairs_and_shafts_keep_their_walls() {
    let registry = Registry::builtin();
    let world = world(&registry, OFFICE, 3, None);
    let link = &world.floorplan.links[0];
    for id in &link.room_ids {
        let wall = world.floorplan.walls.iter().find(|w| w.room_ids.contains(id)).expect("a stairwell has walls");
        let edits = [Edit::MoveWall { wall_id: wall.wall_id.clone(), by_m: 0.2 }];
        let refused = edited(&registry, &world, 0, &edits).expect_err("stairs line up");
        assert!(refused.to_string().contains("lines up with other storeys"), "{refused}");
        let refused = edited(&registry, &world, 0, &[Edit::RemoveRoom { room_id: id.clone() }]).expect_err("stairs");
        assert!(refused.to_string().contains("joins the storeys"), "{refused}");
        let add = Edit::AddRoom { room_type: "storage".into(), area_m2: None, entered_from: Some(id.clone()) };
        let refused = edited(&registry, &world, 0, &[add]).expect_err("no room is entered from stairs");
        assert!(refused.to_string().contains("name the corridor or hall of its storey"), "{refused}");
    }
}

#[test]
fn rooms_come_and_go_on_every_storey() {
    let registry = Registry::builtin();
    for prompt in [HOUSE, OFFICE, STOREYS] {
        let world = world(&registry, prompt, 5, None);
        for level in world.floorplan.level_numbers() {
            let from = way_of(&world, level);
            let add =
                Edit::AddRoom { room_type: "storage".into(), area_m2: Some(4.0), entered_from: Some(from.clone()) };
            let done = edited(&registry, &world, level, &[add]).unwrap_or_else(|e| panic!("{prompt}, {level}: {e}"));
            let new: Vec<&PlanRoom> =
                done.world.floorplan.rooms.iter().filter(|r| world.floorplan.room(&r.room_id).is_none()).collect();
            assert_eq!(new.len(), 1, "{prompt}");
            assert_eq!((new[0].level, new[0].room_type.as_str()), (level, "storage"), "{prompt}");
            let id = new[0].room_id.clone();
            assert!(done.world.floorplan.doors_of(&id).any(|d| d.room_ids.contains(&from)), "{prompt}: {id}");
            // and out again
            let gone = edited(&registry, &done.world, level, &[Edit::RemoveRoom { room_id: id.clone() }]);
            let gone = gone.unwrap_or_else(|e| panic!("{prompt}, {level}: {e}"));
            assert!(gone.world.floorplan.room(&id).is_none());
        }
        // without a word it comes to the ground floor
        let add = Edit::AddRoom { room_type: "storage".into(), area_m2: Some(4.0), entered_from: None };
        edited(&registry, &world, 0, &[add]).unwrap_or_else(|e| panic!("{prompt}: {e}"));
    }
}

#[test]
fn rooms_of_the_program_can_be_taken_out() {
    let registry = Registry::builtin();
    let (mut done, mut in_vain, mut refused) = (0, 0, 0);
    for seed in 1..=3 {
        let world = world(&registry, OFFICE, seed, None);
        for level in world.floorplan.level_numbers() {
            for room in plain_rooms(&world, level) {
                match edited(&registry, &world, level, &[Edit::RemoveRoom { room_id: room.room_id.clone() }]) {
                    Ok(_) => done += 1,
                    Err(Error::Breaks { .. } | Error::Infeasible { .. }) => in_vain += 1,
                    // the way to the others, and the last one of its storey
                    Err(Error::Refused { .. }) => refused += 1,
                    Err(other) => panic!("{}: {other}", room.room_id),
                }
            }
        }
    }
    assert!(done > 2 * in_vain && done > 2 * refused, "{done} done, {in_vain} in vain, {refused} refused");
}

/// Returns an object that stands by itself, the only one of its kind in its room, with the room.
fn loose_thing(world: &World, level: i32) -> (&PlanRoom, Placement) {
    let alone = |things: &[&Placement], p: &Placement| {
        let carries = things.iter().any(|q| q.support.as_ref() == Some(&p.placement_id));
        let kin = things.iter().filter(|q| q.object == p.object).count();
        p.mount == Mount::Floor && p.group.is_none() && p.support.is_none() && !carries && kin == 1
    };
    let of_room = |room: &PlanRoom| {
        let things: Vec<&Placement> = in_room(world, &room.room_id).collect();
        things.iter().find(|p| alone(&things, p)).map(|p| (*p).clone())
    };
    let found = plain_rooms(world, level).into_iter().find_map(|r| Some((r, of_room(r)?)));
    found.unwrap_or_else(|| panic!("storey {level} has no object that stands by itself"))
}

#[test]
fn furniture_changes_in_its_room() {
    let registry = Registry::builtin();
    let world = world(&registry, OFFICE, 2, None);
    for level in world.floorplan.level_numbers() {
        let (room, bin) = loose_thing(&world, level);
        let edits = [
            Edit::RemoveObject { placement_id: bin.placement_id.clone() },
            Edit::AddObject { room_id: room.room_id.clone(), object: bin.object.clone() },
            Edit::Lock { ids: vec![room.room_id.clone()], locked: true, contents: true },
        ];
        let done = edited(&registry, &world, level, &edits).unwrap_or_else(|e| panic!("storey {level}: {e}"));
        assert_eq!(in_room(&done.world, &room.room_id).filter(|p| p.object == bin.object).count(), 1);
        assert!(in_room(&done.world, &room.room_id).all(|p| p.locked));
        assert!(done.world.floorplan.room(&room.room_id).expect("it stays").locked);
        let refurnish = Edit::Refurnish { room_id: room.room_id.clone() };
        edited(&registry, &world, level, &[refurnish]).unwrap_or_else(|e| panic!("storey {level}: {e}"));
        let stay = Edit::MoveObject { placement_id: bin.placement_id, x: bin.pose.x, y: bin.pose.y, yaw_rad: None };
        edited(&registry, &world, level, &[stay]).unwrap_or_else(|e| panic!("storey {level}: {e}"));
    }
}

#[test]
fn what_is_not_there_is_named_with_the_edit() {
    let registry = Registry::builtin();
    let world = world(&registry, HOUSE, 1, None);
    let add =
        |from: &str| Edit::AddRoom { room_type: "storage".into(), area_m2: None, entered_from: Some(from.into()) };
    let fine = Edit::Refurnish { room_id: plain_rooms(&world, 1)[0].room_id.clone() };
    for (edit, says) in [
        (Edit::MoveWall { wall_id: "wall_999".into(), by_m: 0.2 }, "no wall `wall_999`"),
        (add("hallway_9"), "no room `hallway_9`"),
        (Edit::RemoveRoom { room_id: "attic_1".into() }, "no room `attic_1`"),
        (Edit::RemoveRoom { room_id: way_of(&world, 1) }, "entered through"),
        (Edit::Refurnish { room_id: "attic_1".into() }, "no room `attic_1`"),
    ] {
        let error = edited(&registry, &world, 1, &[fine.clone(), edit]).expect_err(says).to_string();
        assert!(error.contains("edit 2: ") && error.contains(says), "{error}");
    }
}

#[test]
fn locked_rooms_stay_and_all_other_storeys_are_planned_anew_around_the_core() {
    let registry = Registry::builtin();
    for prompt in [HOUSE, OFFICE] {
        let first = world(&registry, prompt, 11, None);
        let mut pinned = first.floorplan.clone();
        let top = *pinned.level_numbers().last().expect("it has storeys");
        let room = pinned.rooms.iter_mut().find(|r| r.level == top && !r.circulation).expect("the top has rooms");
        room.locked = true;
        let id = room.room_id.clone();
        let mut others = Vec::new();
        for seed in 20..24 {
            let made = world(&registry, prompt, seed, Some(pinned.clone()));
            let plan = &made.floorplan;
            assert_eq!(plan.room(&id), pinned.room(&id), "{prompt}, seed {seed}");
            for id in pinned.links.iter().flat_map(|l| &l.room_ids) {
                assert_eq!(plan.room(id), pinned.room(id), "{prompt}, seed {seed}");
            }
            others.push(format!("{:?}", plan.rooms.iter().map(|r| &r.net_polygon).collect::<Vec<_>>()));
        }
        others.sort();
        others.dedup();
        assert!(others.len() > 2, "{prompt}: seeds make {} plans", others.len());
    }
}

#[test]
fn variations_differ_on_several_storeys_and_keep_what_is_locked() {
    let registry = Registry::builtin();
    let made = world(&registry, OFFICE, 11, None);
    let plugin = registry.get(&made.scene_graph.domain).expect("its domain is built in");
    let limits = retrieve(&made.scene_graph, plugin).limits;
    let all = |pinned: Option<&Floorplan>| {
        let found = variations(&made.scene_graph, plugin.domain(), &limits, pinned, 3, Stop::never());
        let found = found.unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(found.len(), 3);
        assert!(found.iter().all(|v| v.plan.level_numbers() == [0, 1, 2]));
        found
    };
    assert!(all(None).iter().all(|v| v.difference > 0.2));
    let mut pinned = made.floorplan.clone();
    let kept: Vec<PlanRoom> = pinned
        .rooms
        .iter_mut()
        .filter(|r| r.level == 1)
        .map(|r| {
            r.locked = true;
            r.clone()
        })
        .collect();
    for variation in all(Some(&pinned)) {
        assert!(variation.difference > 0.0);
        assert!(kept.iter().all(|room| variation.plan.room(&room.room_id) == Some(room)), "a locked room moved");
    }
}

#[test]
fn a_pinned_plan_of_other_storeys_is_refused() {
    let registry = Registry::builtin();
    let mut pinned = world(&registry, HOUSE, 1, None).floorplan;
    pinned.rooms[0].locked = true;
    let request = Request { prompt: "three-storey house with 3 bedrooms".into(), seed: 1, ..Request::default() };
    let settings = Settings { pinned_floorplan: Some(pinned), ..Settings::default() };
    let made = generate_world(&request, &registry, &settings, &mut |_| {}, &AtomicBool::new(false));
    let error = made.expect_err("the storeys differ").to_string();
    assert!(error.contains("the plan has storeys 0, 1, the scene graph 0, 1, 2"), "{error}");
}
