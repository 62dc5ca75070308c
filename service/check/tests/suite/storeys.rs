//! The rules of buildings with several storeys, each broken by one change to a sound world.

use std::collections::BTreeSet;
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

use d3dgen_model::Document;
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::world::World;

use crate::{REGISTRY, Sample, broken, names};
use d3dgen_check::rules::STOREY_RULES;
use d3dgen_pipeline::generate::{Settings, generate_world, retrieve};
use d3dgen_pipeline::scene_graph::Request;

const PROMPTS: [&str; 2] = [
    "two-storey house in Germany with a living room, a kitchen and a toilet downstairs, three bedrooms and a bathroom upstairs",
    "office building in the US with 3 storeys and 18 rooms",
];

static SAMPLES: LazyLock<Vec<Sample>> = LazyLock::new(|| {
    let sample = |prompt: &&str| {
        let request = Request { prompt: (*prompt).to_owned(), seed: 7, ..Request::default() };
        let made =
            generate_world(&request, &REGISTRY, &Settings::default(), &mut |_| {}, &AtomicBool::new(false)).unwrap();
        let plugin = REGISTRY.get(&made.world.scene_graph.domain).unwrap();
        let retrieval = retrieve(&made.world.scene_graph, plugin);
        Sample { world: made.world, domain: plugin.domain(), retrieval }
    };
    PROMPTS.iter().map(sample).collect()
});

/// Rule, rules that break with it, and the change: it returns the subject of the violation, where it applies.
type Break = (&'static str, &'static [&'static str], fn(&mut World) -> Option<String>);

fn top_room(world: &World, kind: LinkKind) -> Option<String> {
    world.floorplan.links.iter().find(|l| l.kind == kind)?.room_ids.last().cloned()
}

const BREAKS: &[Break] = &[
    ("stairs_missing", &["storey_cut_off"], |world| {
        world.floorplan.links.retain(|l| l.kind != LinkKind::Stairs);
        Some("level 1".into())
    }),
    (
        "link_offset",
        &["zone_net", "wall_gap", "wall_stray", "door_floating", "door_unlinked", "zone_overlap"],
        |world| {
            let id = top_room(world, LinkKind::Stairs)?;
            let room = world.floorplan.rooms.iter_mut().find(|r| r.room_id == id)?;
            room.polygon.0.iter_mut().for_each(|p| p.x += 0.06);
            Some(id)
        },
    ),
    (
        "link_closed",
        &[
            "graph_edge_missing",
            "storey_cut_off",
            "adjacency_missing",
            "no_entrance",
            "wall_gap",
            "unreachable_zone",
            "private_passage",
            "pose_taken",
            "door_width",
        ],
        |world| {
            let id = top_room(world, LinkKind::Stairs)?;
            world.floorplan.doors.retain(|d| !d.room_ids.contains(&id));
            Some(id)
        },
    ),
    ("elevator_missing", &[], |world| {
        let had = world.floorplan.links.iter().any(|l| l.kind == LinkKind::Elevator);
        world.floorplan.links.retain(|l| l.kind != LinkKind::Elevator);
        had.then(|| "level 1".into())
    }),
    (
        "storey_in_the_air",
        &[
            "zone_net",
            "wall_gap",
            "wall_stray",
            "door_floating",
            "door_unlinked",
            "zone_overlap",
            "window_misplaced",
            "region_outside",
        ],
        |world| {
            let ground = world.floorplan.rooms.iter_mut().filter(|r| r.level == 0 && !r.circulation);
            let room = ground.max_by(|a, b| a.net_area_m2.total_cmp(&b.net_area_m2))?;
            room.polygon.0.iter_mut().for_each(|p| p.x += 100.0);
            Some("level 1".into())
        },
    ),
    ("storey_cut_off", &["stairs_missing"], |world| {
        world.floorplan.links.iter_mut().for_each(|l| l.room_ids.truncate(1));
        let upper = world.floorplan.rooms.iter().find(|r| r.level == 1 && !r.circulation)?;
        Some(upper.room_id.clone())
    }),
];

pub(super) fn rules() -> impl Iterator<Item = &'static str> {
    BREAKS.iter().map(|b| b.0)
}

#[test]
fn buildings_with_storeys_are_sound() {
    for sample in SAMPLES.iter() {
        let report = sample.check(&sample.world);
        assert!(report.sound, "{}: {:?}", sample.world.name, broken(&report));
        assert_eq!(sample.world.check(), vec![], "{}", sample.world.name);
        assert!(STOREY_RULES.iter().all(
            |rule| report.rules.iter().any(|r| r.rule == rule.id && r.checked > 0) || rule.id == "elevator_missing"
        ));
    }
}

#[test]
fn each_change_between_storeys_is_reported() {
    for (rule, also, change) in BREAKS {
        let mut tried = 0;
        for sample in SAMPLES.iter() {
            let mut world = sample.world.clone();
            let Some(subject) = change(&mut world) else { continue };
            tried += 1;
            let report = sample.check(&world);
            assert!(names(&report, rule, &subject), "{rule} of {subject} in {}: {:?}", world.name, broken(&report));
            let expected: BTreeSet<&str> = also.iter().copied().chain([*rule]).collect();
            let strange: Vec<&str> = broken(&report).into_iter().filter(|r| !expected.contains(r)).collect();
            // without its link a stairwell is a room like any other, and is judged as one
            let unlinked = ["elevator_missing", "stairs_missing", "storey_cut_off"].contains(rule);
            assert!(strange.is_empty() || unlinked, "{rule} in {}: {strange:?}", world.name);
        }
        assert!(tried > 0, "{rule} was never broken");
    }
}

#[test]
fn storeys_are_worlds_of_their_own() {
    for sample in SAMPLES.iter() {
        let storeys = sample.world.storeys();
        assert_eq!(storeys.len(), sample.world.floorplan.levels.len());
        for (level, storey) in storeys {
            let entrances = storey.floorplan.doors.iter().filter(|d| d.entrance).count();
            assert_eq!(entrances, 1, "level {level} of {}", sample.world.name);
            let shafts = sample.world.floorplan.links.iter().flat_map(|l| &l.room_ids);
            let left = shafts.filter(|id| storey.floorplan.room(id).is_some()).count();
            assert_eq!(left == 0, level != 0, "level {level} of {}", sample.world.name);
        }
    }
}

#[test]
fn an_elevator_has_its_doors_in_one_place() {
    let mut tried = 0;
    for sample in SAMPLES.iter() {
        let mut world = sample.world.clone();
        let Some(id) = top_room(&world, LinkKind::Elevator) else { continue };
        tried += 1;
        let door = world.floorplan.doors.iter_mut().find(|d| d.room_ids.contains(&id)).expect("a shaft has a door");
        let line = &mut door.line;
        for p in [&mut line.start, &mut line.end] {
            p.x += 0.2;
            p.y += 0.2;
        }
        assert!(names(&sample.check(&world), "link_offset", &id), "{id} of {}", world.name);
    }
    assert!(tried > 0, "no sample has an elevator");
}
