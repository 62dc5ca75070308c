//! Storeys in prompts, and cores that line up: `prompts/storeys.jsonl` says what a sensible person reads.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use d3dgen_model::Document;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::storeys::LinkKind;
use d3dgen_pipeline::generate::{Settings, generate_world};
use d3dgen_pipeline::scene_graph::{Request, generate};
use d3dgen_plugins::Registry;
use serde::Deserialize;

/// A prompt and its storeys.
#[derive(Debug, Deserialize)]
struct Case {
    prompt: String,
    levels: Vec<i32>,
    /// By storey: room types with how many at least.
    #[serde(default)]
    on: BTreeMap<i32, BTreeMap<String, usize>>,
    #[serde(default)]
    elevator: Option<bool>,
    #[serde(default)]
    conflict: Option<String>,
}

fn request(prompt: &str, seed: u64) -> Request {
    Request { prompt: prompt.into(), seed, ..Request::default() }
}

fn misses(case: &Case, graph: &SceneGraph) -> Vec<String> {
    let mut out: Vec<String> = graph.check().iter().map(|p| format!("{p}")).collect();
    let levels = graph.level_numbers();
    if levels != case.levels {
        out.push(format!("levels {levels:?}, not {:?}", case.levels));
    }
    for (level, types) in &case.on {
        for (room_type, least) in types {
            let n = graph.rooms.iter().filter(|r| r.level == *level && &r.room_type == room_type).count();
            if n < *least {
                out.push(format!("level {level} has {n} {room_type}, not {least}"));
            }
        }
    }
    let elevator = graph.links.iter().any(|l| l.kind == LinkKind::Elevator);
    if case.elevator.is_some_and(|e| e != elevator) {
        out.push(format!("elevator: {elevator}"));
    }
    if let Some(code) = &case.conflict
        && !graph.conflicts.iter().any(|n| &n.code == code)
    {
        out.push(format!("no conflict {code}, but {:?}", graph.conflicts));
    }
    out
}

#[test]
fn prompts_say_which_rooms_are_on_which_storey() {
    let registry = Registry::builtin();
    let text = include_str!("../prompts/storeys.jsonl");
    let mut wrong = Vec::new();
    for line in text.lines() {
        let case: Case = serde_json::from_str(line).unwrap();
        match generate(&request(&case.prompt, 0), &registry) {
            Ok(graph) => wrong.extend(misses(&case, &graph).into_iter().map(|m| format!("{}: {m}", case.prompt))),
            Err(error) => wrong.push(format!("{}: {error}", case.prompt)),
        }
    }
    assert!(text.lines().count() >= 25);
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn every_storey_of_a_large_building_has_its_share_of_the_rooms() {
    let registry = Registry::builtin();
    for (prompt, storeys) in [
        ("hospital with 60 rooms on 3 storeys with lifts", 3),
        ("office tower with 5 storeys and 50 rooms", 5),
        ("hospital with 40 rooms on 3 storeys", 3),
        ("hospital on 3 storeys with lifts, for two delivery robots", 3),
        ("office building with 4 floors", 4),
        ("office for 150 people on 4 floors", 4),
        ("school with 60 rooms on 3 storeys", 3),
    ] {
        for seed in 0..3 {
            let graph = generate(&request(prompt, seed), &registry).unwrap();
            let link = |id: &String| graph.links.iter().any(|l| l.room_ids.contains(id));
            let on = |level: i32| {
                graph
                    .rooms
                    .iter()
                    .filter(move |r| r.level == level && !r.circulation && !link(&r.id))
                    .collect::<Vec<_>>()
            };
            let counts: Vec<usize> = graph.level_numbers().into_iter().map(|l| on(l).len()).collect();
            assert_eq!(counts.len(), storeys, "{prompt}");
            let all: usize = counts.iter().sum();
            assert!(counts.iter().all(|n| 2 * n * storeys >= all), "{prompt}, seed {seed}: {counts:?}");
            let wet = |id: &str| id.contains("toilet") || id.contains("restroom") || id.contains("bathroom");
            for level in graph.level_numbers() {
                assert!(on(level).iter().any(|r| wet(&r.room_type)), "{prompt}, seed {seed}: none on {level}");
            }
        }
    }
}

#[test]
fn cores_line_up_for_every_seed() {
    let registry = Registry::builtin();
    let prompts = [
        "two-storey house in Germany with 7 rooms",
        "office in the US with 21 rooms on 3 floors",
        "hospital with 20 rooms on 2 floors",
        "three floor office building without an elevator, 12 rooms",
    ];
    for prompt in prompts {
        for seed in 0..5 {
            let made = generate_world(
                &request(prompt, seed),
                &registry,
                &Settings::default(),
                &mut |_| {},
                &AtomicBool::new(false),
            )
            .unwrap();
            let broken: Vec<_> = made.report.rules.iter().flat_map(|r| &r.violations).collect();
            assert!(made.report.sound, "{prompt}, seed {seed}: {broken:?}");
            let plan = &made.world.floorplan;
            assert_eq!(plan.levels.len(), plan.level_numbers().len());
            assert!(!plan.links.is_empty());
            for link in &plan.links {
                assert_eq!(link.room_ids.len(), plan.levels.len(), "{prompt}, seed {seed}: {}", link.link_id);
                let outlines: Vec<_> = link.room_ids.iter().map(|id| plan.room(id).unwrap().polygon.bounds()).collect();
                for pair in outlines.windows(2) {
                    let (a, b) = (pair[0], pair[1]);
                    let off = [a.x0 - b.x0, a.y0 - b.y0, a.x1 - b.x1, a.y1 - b.y1].map(f64::abs);
                    assert!(off.iter().all(|o| *o < 1e-6), "{prompt}, seed {seed}: {} is {off:?} off", link.link_id);
                }
            }
        }
    }
}

#[test]
fn a_single_storey_house_is_a_home() {
    let graph = generate(&request("single-storey house with two bedrooms", 1), &Registry::builtin()).unwrap();
    assert_eq!((graph.domain.as_str(), graph.level_numbers()), ("residential", vec![0]));
}
