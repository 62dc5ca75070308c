//! Median time of each stage for a world of 10 rooms in each of three domains, one thread, and its ratio to a yardstick
//! measured in the same run: writing and reading the same world as JSON. Ratios compare between machines.
//!
//! `cargo bench -p d3dgen-tests` measures; run as a test (`cargo test --benches`), it makes each world once.

use std::hint::black_box;
use std::time::{Duration, Instant};

use d3dgen_export::exporters;
use d3dgen_model::document::Document;
use d3dgen_model::world::World;
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::{floorplan, generate, placement, scenario, scene_graph, world};
use d3dgen_plugins::Registry;

const PROMPTS: &[(&str, &str)] = &[
    ("residential", "house in Germany, for a cleaning robot"),
    ("office", "office in the United States, for a service robot"),
    ("hospital", "hospital ward in Germany, for a delivery robot"),
];
const STAGES: &[&str] = &["scene_graph", "floorplan", "placement", "scenario", "world", "arena", "sum", "yardstick"];

fn main() {
    let measuring = std::env::args().any(|a| a == "--bench");
    let seeds = if measuring { 31 } else { 1 };
    let registry = Registry::builtin();
    println!("medians of {seeds} seeds in ms, 10 rooms; x: times the yardstick (the world to JSON and back)");
    println!("{:<12}{}", "domain", STAGES.iter().map(|s| format!("{s:>18}")).collect::<String>());
    for (domain, prompt) in PROMPTS {
        let mut times = vec![Vec::new(); STAGES.len()];
        let request = |seed| Request {
            prompt: (*prompt).into(),
            seed,
            domain: Some((*domain).into()),
            country: None,
            rooms: Some(10),
            area_m2: None,
            robot_radius_m: None,
        };
        run(&request(1000), &registry, &mut vec![Vec::new(); STAGES.len()]); // warms caches and parsed domains
        for seed in 0..seeds {
            run(&request(seed), &registry, &mut times);
        }
        let medians: Vec<f64> = times.iter_mut().map(median_ms).collect();
        let yardstick = medians[STAGES.len() - 1];
        let cells: Vec<String> = medians.iter().map(|m| format!("{m:>9.2} {:>6.1} x", m / yardstick)).collect();
        println!("{domain:<12}{}", cells.concat());
    }
}

/// Takes a request through all stages and notes the time of each.
fn run(request: &Request, registry: &Registry, times: &mut [Vec<Duration>]) {
    let mut stage = 0;
    let begun = Instant::now();
    let mut last = begun;
    let mut lap = |times: &mut [Vec<Duration>]| {
        times[stage].push(last.elapsed());
        stage += 1;
        last = Instant::now();
    };
    let graph = scene_graph::generate(request, registry).expect("the prompts are plain");
    lap(times);
    let plugin = registry.get(&graph.domain).expect("the graph names a domain of the registry");
    let (domain, retrieved) = (plugin.domain(), generate::retrieve(&graph, plugin));
    let plan = floorplan::generate(&graph, domain, &retrieved.limits, None).expect("10 rooms can be planned");
    lap(times);
    let placements = placement::generate(&graph, &plan, domain, None).expect("10 rooms can be furnished");
    lap(times);
    let scenario = scenario::generate(&graph, &plan, &placements, domain).expect("a furnished plan has a scenario");
    lap(times);
    let made = world::assemble("bench", graph, plan, placements, scenario);
    black_box(world::check(&made, domain, &retrieved).to_json());
    lap(times);
    black_box(
        exporters::get("arena").expect("arena is shipped").export(&made, domain).expect("worlds can be exported"),
    );
    lap(times);
    times[STAGES.len() - 2].push(begun.elapsed());

    let begun = Instant::now();
    let text = made.to_json();
    let back: World = serde_json::from_str(&text).expect("our own JSON");
    black_box(back);
    times[STAGES.len() - 1].push(begun.elapsed());
}

fn median_ms(times: &mut Vec<Duration>) -> f64 {
    times.sort();
    times.get(times.len() / 2).map_or(0.0, |t| t.as_secs_f64() * 1000.0)
}
