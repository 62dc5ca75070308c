//! Simulates worlds: `crowd SECONDS WORLD.json OUT...`.
use std::time::Instant;
use d3dgen_model::Document;
use d3dgen_model::world::World;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let seconds: f64 = args[1].parse().expect("seconds");
    for pair in args[2..].chunks(2) {
        let world = World::from_json(&std::fs::read_to_string(&pair[0]).expect("file")).expect("world");
        let registry = d3dgen_plugins::Registry::builtin();
        let plugin = registry.get(&world.scene_graph.domain).expect("domain");
        let begun = Instant::now();
        let run = d3dgen_crowd::simulate(&world, plugin.domain(), d3dgen_crowd::Options { seconds, seed: None }, &mut |_| true).expect("run");
        println!("{} {} people {} robots {:.2?} {}", world.name, run.trajectory.agents.len(), run.trajectory.robots.len(), begun.elapsed(), run.metrics["all"]);
        std::fs::create_dir_all(&pair[1]).expect("dir");
        for (name, text) in [("trajectory.json", serde_json::to_string(&run.trajectory).expect("j")), ("walkable.geojson", run.walkable.to_string()), ("metrics.json", format!("{:#}", run.metrics))] {
            std::fs::write(format!("{}/{name}", pair[1]), text).expect("write");
        }
    }
}
