//! Median time of each stage for a world of 10 rooms in each of three domains, one thread, from the prompt to the files
//! on disk without the picture, against the target of 100 ms. Times are also given as multiples of a baseline measured in
//! the same run, a fixed piece of work that is none of ours: those compare between machines. Below that stand an edit of
//! each world (a room is furnished anew) and the check of the edited world, against the target of 5 ms.
//!
//! `cargo bench -p d3dgen-tests` measures; run as a test (`cargo test --benches`), it makes each world once.

use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use d3dgen_export::Subject;
use d3dgen_export::exporters::{self, File, plan};
use d3dgen_export::models::NothingKept;
use d3dgen_model::document::Document;
use d3dgen_model::edits::Edit;
use d3dgen_pipeline::generate::{Event, Generated, Settings, Stage, generate_world, retrieve};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::{Stop, edit, world};
use d3dgen_plugins::Registry;
use mimalloc::MiMalloc;

/// As the command has it.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

const PROMPTS: &[(&str, &str)] = &[
    ("residential", "house in Germany, for a cleaning robot"),
    ("office", "office in the United States, for a service robot"),
    ("hospital", "hospital ward in Germany, for a delivery robot"),
];
const SEEDS: u64 = 31;
const TARGET_MS: f64 = 100.0;
const CHECK_TARGET_MS: f64 = 5.0;
/// Stages, files, all together.
const MADE_ROWS: usize = Stage::ALL.len() + 2;
/// And the edit with all that follows, the check of the edited world.
const ROWS: usize = MADE_ROWS + 2;

fn main() {
    let measuring = std::env::args().any(|a| a == "--bench");
    let seeds = if measuring { SEEDS } else { 1 };
    let registry = Registry::builtin();
    let folder = tempfile::tempdir().expect("there is a place for temporary files");
    let mut baselines = Vec::new();
    let (mut columns, mut sound) = (Vec::new(), Vec::new());
    for (domain, prompt) in PROMPTS {
        let mut times = vec![Vec::new(); ROWS];
        make(domain, prompt, 1000, &registry, folder.path()); // warms caches and parsed domains
        let mut good = 0;
        for seed in 0..seeds {
            let (laps, made) = make(domain, prompt, seed, &registry, folder.path());
            let laps = laps.into_iter().chain(change(&made, &registry));
            laps.zip(&mut times).for_each(|(lap, times)| times.push(lap));
            good += u64::from(made.report.sound);
            baselines.push(baseline());
        }
        columns.push(times.into_iter().map(median_ms).collect::<Vec<f64>>());
        sound.push(format!("{good} of {seeds}"));
    }
    report(seeds, &columns, &sound, median_ms(baselines));
}

/// Prints the table.
fn report(seeds: u64, columns: &[Vec<f64>], sound: &[String], baseline_ms: f64) {
    println!(
        "medians of {seeds} seeds, worlds of 10 rooms, one thread; x: multiples of the baseline, {baseline_ms:.1} ms"
    );
    let line = |label: &str, cells: Vec<String>| {
        println!("{label:<14}{}", cells.iter().map(|c| format!("{c:>22}")).collect::<String>());
    };
    line("", PROMPTS.iter().map(|(domain, _)| (*domain).to_owned()).collect());
    let more = ["files, no PNG", "together", "an edit", "re-check"];
    let labels = Stage::ALL.iter().map(|s| s.name()).chain(more);
    for (row, label) in labels.enumerate() {
        let cell = |c: &Vec<f64>| format!("{:.2} ms {:>6.2} x", c[row], c[row] / baseline_ms);
        line(label, columns.iter().map(cell).collect());
    }
    for (row, what, target_ms) in [(MADE_ROWS - 1, "made", TARGET_MS), (ROWS - 1, "check", CHECK_TARGET_MS)] {
        let verdict = |c: &Vec<f64>| if c[row] <= target_ms { "met".to_owned() } else { "MISSED".to_owned() };
        line(&format!("{what} <= {target_ms:.0} ms"), columns.iter().map(verdict).collect());
    }
    line("sound worlds", sound.to_vec());
}

/// Makes a world and writes it; returns the time of each stage (all attempts), of the files, and of everything.
fn make(
    domain: &str,
    prompt: &str,
    seed: u64,
    registry: &Registry,
    folder: &Path,
) -> ([Duration; MADE_ROWS], Generated) {
    let request = Request {
        prompt: prompt.into(),
        seed,
        domain: Some(domain.into()),
        country: None,
        rooms: Some(10),
        area_m2: None,
        robot_radius_m: None,
        ..Request::default()
    };
    let mut laps = [Duration::ZERO; MADE_ROWS];
    let begun = Instant::now();
    let mut last = begun;
    let mut observe = |event: Event<'_>| {
        if let Event::Finished(stage, ..) = event {
            laps[stage as usize] += last.elapsed();
        }
        // rooms are furnished within their stage
        if !matches!(event, Event::Furnished(..)) {
            last = Instant::now();
        }
    };
    let made = generate_world(&request, registry, &Settings::default(), &mut observe, &AtomicBool::new(false))
        .expect("a building of 10 rooms can be made");
    let files = Instant::now();
    write(&made, registry, &folder.join(format!("{domain}_{seed}")));
    laps[MADE_ROWS - 2] = files.elapsed();
    laps[MADE_ROWS - 1] = begun.elapsed();
    (laps, made)
}

/// Furnishes a room anew and checks the outcome; returns the time of the whole edit and of a check.
fn change(made: &Generated, registry: &Registry) -> [Duration; 2] {
    let plugin = registry.get(&made.world.scene_graph.domain).expect("the world is of this domain");
    let room = made.world.floorplan.rooms.iter().find(|r| !r.circulation).expect("it has rooms");
    let edits = [Edit::Refurnish { room_id: room.room_id.clone() }];
    let begun = Instant::now();
    let edited = edit::apply(&made.world, &edits, plugin, Stop::never()).expect("a room can be furnished anew");
    let whole = begun.elapsed();
    let retrieval = retrieve(&edited.world.scene_graph, plugin);
    let begun = Instant::now();
    let report = black_box(world::check(&edited.world, plugin.domain(), &retrieval));
    let check = begun.elapsed();
    assert_eq!(report.sound, edited.report.sound, "{}", edited.world.name);
    [whole, check]
}

/// Writes what `generate --no-png` writes.
fn write(made: &Generated, registry: &Registry, folder: &Path) {
    let world = &made.world;
    let domain = registry.get(&world.scene_graph.domain).expect("the world is of this domain").domain();
    let mut files = exporters::get("arena")
        .expect("arena is shipped")
        .export(&Subject::new(world, domain, &NothingKept))
        .expect("it can be exported");
    files.push(File::new("plan.svg", plan::svg(world, domain)));
    let documents = [
        ("world.json", world.to_json()),
        ("report.json", made.report.to_json()),
        ("scene_graph.json", world.scene_graph.to_json()),
        ("floorplan.json", world.floorplan.to_json()),
        ("placements.json", world.placements.to_json()),
        ("scenario.json", world.scenario.to_json()),
    ];
    files.extend(documents.into_iter().map(|(name, text)| File::new(name, text)));
    for file in files {
        let path = folder.join(&file.path);
        let parent = path.parent().expect("it lies in the folder");
        std::fs::create_dir_all(parent).and_then(|()| std::fs::write(&path, &file.bytes)).expect("it can be written");
    }
}

/// Does the fixed piece of work: half a million figures drawn, sorted and added up.
fn baseline() -> Duration {
    let begun = Instant::now();
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut figures: Vec<u64> = (0..500_000)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state
        })
        .collect();
    figures.sort_unstable();
    black_box(figures.iter().step_by(7).fold(0, |sum: u64, f| sum.wrapping_add(*f)));
    begun.elapsed()
}

fn median_ms(mut times: Vec<Duration>) -> f64 {
    times.sort();
    times.get(times.len() / 2).map_or(0.0, |t| t.as_secs_f64() * 1000.0)
}
