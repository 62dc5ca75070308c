//! A caller who asks to stop is heard inside the searches, also those of a very large building, and what is made without
//! such a wish is the same whether or not somebody could have asked.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use d3dgen_model::Document;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::generate::{Event, Settings, Stage, furnish_and_check, retrieve};
use d3dgen_pipeline::scene_graph::{self, Request};
use d3dgen_pipeline::{Error, Stop, floorplan, placement};
use d3dgen_plugins::Registry;

/// Longest time from the wish to the end; a quiet machine needs less than 0.1 s.
const PATIENCE: Duration = Duration::from_secs(5);

fn ward(rooms: u32, registry: &Registry) -> SceneGraph {
    let prompt = "hospital ward in Germany, for a delivery robot".to_owned();
    let request = Request { prompt, seed: 1, rooms: Some(rooms), ..Request::default() };
    scene_graph::generate(&request, registry).expect("a ward")
}

/// Makes a world and sets the flag as soon as `when` says so; returns how many events came after that, and the end.
fn stopped_when(graph: &SceneGraph, registry: &Registry, when: &dyn Fn(&Event<'_>) -> bool) -> (usize, Error) {
    let (flag, mut after) = (AtomicBool::new(false), 0);
    let mut observe = |event: Event<'_>| {
        after += usize::from(flag.load(Ordering::SeqCst));
        if when(&event) {
            flag.store(true, Ordering::SeqCst);
        }
    };
    let made = furnish_and_check(graph, registry, &Settings::default(), &mut observe, &flag);
    (after, made.map(|w| w.world.name).expect_err("it was asked to stop"))
}

#[test]
fn the_searches_hear_of_it() {
    let registry = Registry::builtin();
    let graph = ward(500, &registry);
    // asked once the stage has begun: only the search itself can notice
    for stage in [Stage::Floorplan, Stage::Placement] {
        let (after, error) = stopped_when(&graph, &registry, &|e| matches!(e, Event::Started(s, _) if *s == stage));
        assert!(after == 0 && matches!(error, Error::Cancelled), "{stage:?}: {after} events more, {error}");
    }
    let third = |e: &Event<'_>| matches!(e, Event::Furnished(_, room) if room.done == 3);
    let (after, error) = stopped_when(&graph, &registry, &third);
    assert!(after == 0 && matches!(error, Error::Cancelled), "{after} events more, {error}");
}

#[test]
fn a_large_request_ends_soon_after_it_is_given_up() {
    let registry = Registry::builtin();
    let graph = ward(500, &registry);
    for wait_ms in [20, 300, 900, 2_000] {
        let (flag, ended) = (AtomicBool::new(false), AtomicBool::new(false));
        std::thread::scope(|scope| {
            let asked = scope.spawn(|| {
                std::thread::sleep(Duration::from_millis(wait_ms));
                flag.store(true, Ordering::SeqCst);
                (Instant::now(), ended.load(Ordering::SeqCst))
            });
            let mut stage = None;
            let mut observe = |event: Event<'_>| {
                if let Event::Started(begun, _) = event {
                    stage = Some(begun);
                }
            };
            let made = furnish_and_check(&graph, &registry, &Settings::default(), &mut observe, &flag);
            ended.store(true, Ordering::SeqCst);
            let end = Instant::now();
            let (asked, too_late) = asked.join().expect("a clock");
            if too_late {
                return; // a fast machine
            }
            let took = end.saturating_duration_since(asked);
            println!("asked after {wait_ms} ms: stopped in {:.1} ms, in {stage:?}", took.as_secs_f64() * 1e3);
            assert!(took < PATIENCE, "{took:?}");
            assert!(matches!(made, Err(Error::Cancelled)) || stage == Some(Stage::World), "{:?}", made.err());
        });
    }
}

#[test]
fn a_wish_that_never_comes_changes_nothing() {
    let registry = Registry::builtin();
    let graph = ward(40, &registry);
    let plugin = registry.get(&graph.domain).expect("shipped");
    let limits = retrieve(&graph, plugin).limits;
    let flag = AtomicBool::new(false);
    let plan = floorplan::generate(&graph, plugin.domain(), &limits, None).expect("a plan");
    let other = floorplan::generate_until(&graph, plugin.domain(), &limits, None, Stop::from(&flag)).expect("a plan");
    assert_eq!(plan.to_json(), other.to_json());
    let furnished = placement::generate(&graph, &plan, plugin.domain(), &limits, None).expect("furniture");
    let mut by_room = Vec::new();
    let mut observe = |room: placement::Furnished<'_>| by_room.extend_from_slice(room.placements);
    let stop = Stop::from(&flag);
    let other = placement::generate_until(&graph, &plan, plugin.domain(), &limits, None, &mut observe, stop);
    assert_eq!(furnished.to_json(), other.expect("furniture").to_json());
    assert_eq!(furnished.placements, by_room);
}
