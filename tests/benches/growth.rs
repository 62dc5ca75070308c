//! How time grows with the number of rooms: each stage for 10 to 500 rooms in three domains, one thread, as a table and as
//! a plot (`target/growth.svg`).
//!
//! After all sizes 450 small worlds are made on two threads, as papers make them for their tables.
//!
//! `cargo bench -p d3dgen-tests --bench growth` measures (`-- hospital 50 200` only some of it); run as a test, it makes
//! the smallest worlds once. The last column is the exponent of the growth between two sizes: 1 is linear, n log n lies at about 1.2.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use d3dgen_pipeline::generate::{Artifact, Event, Settings, Stage, generate_world};
use d3dgen_pipeline::scene_graph::Request;
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
const SIZES: [u32; 6] = [10, 20, 50, 100, 200, 500];
/// Stages and what lies between them.
const COLUMNS: usize = Stage::ALL.len() + 1;

/// The median world of one size.
struct Row {
    rooms: u32,
    ms: [f64; COLUMNS],
    /// Mean cost of the plans, as they state it themselves.
    cost: f64,
    /// Mean number of objects.
    things: f64,
    attempts: f64,
    sound: String,
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let measuring = arguments.iter().any(|a| a == "--bench");
    let wanted = |name: &str| {
        let mut named = PROMPTS.iter().filter(|(d, _)| arguments.iter().any(|a| a == d)).peekable();
        named.peek().is_none() || named.any(|(d, _)| *d == name)
    };
    // one number is the largest size, two are the smallest and the largest
    let numbers: Vec<u32> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let least = if numbers.len() > 1 { numbers[0] } else { 0 };
    let most = if measuring { numbers.last().copied().unwrap_or(u32::MAX) } else { SIZES[0] };
    let registry = Registry::builtin();
    let mut curves: Vec<(&str, Vec<Row>)> = Vec::new();
    for (domain, prompt) in PROMPTS.iter().filter(|(d, _)| wanted(d)) {
        println!("{domain}: medians, one thread, ms");
        let names = Stage::ALL.iter().map(|s| s.name());
        let heads =
            ["rooms"].into_iter().chain(names).chain(["together", "cost", "things", "attempts", "sound", "exponent"]);
        println!("{}", heads.map(|h| format!("{h:>12}")).collect::<String>());
        make(domain, prompt, 10, 1000, &registry); // parses the domain
        let mut rows: Vec<Row> = Vec::new();
        for rooms in SIZES.into_iter().filter(|r| (least..=most).contains(r)) {
            let seeds = if measuring { (1000 / u64::from(rooms)).clamp(3, 41) } else { 1 };
            let row = measure(domain, prompt, rooms, seeds, &registry);
            let exponent = rows.last().map_or(String::new(), |last| {
                let growth = (row.ms[COLUMNS - 1] / last.ms[COLUMNS - 1]).ln();
                format!("{:.2}", growth / f64::from(rooms).ln_div(f64::from(last.rooms)))
            });
            let times = row.ms.iter().map(|t| format!("{t:>12.2}")).collect::<String>();
            let (cost, things, attempts, sound) = (row.cost, row.things, row.attempts, &row.sound);
            println!("{rooms:>12}{times}{cost:>12.2}{things:>12.1}{attempts:>12.1}{sound:>12}{exponent:>12}");
            rows.push(row);
        }
        curves.push((domain, rows));
    }
    if measuring && numbers.is_empty() && curves.len() == PROMPTS.len() {
        many(&registry);
    }
    if measuring {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/growth.svg");
        std::fs::write(&file, plot(&curves)).expect("the plot can be written");
        println!("plot: target/growth.svg");
    }
}

/// Makes 450 worlds with their checks, 50 each of 5, 8 and 10 rooms in three domains, on two threads.
fn many(registry: &Registry) {
    let jobs: Vec<(usize, u32, u64)> = (0..PROMPTS.len())
        .flat_map(|p| [5, 8, 10].into_iter().flat_map(move |rooms| (0..50).map(move |seed| (p, rooms, seed))))
        .collect();
    let next = AtomicUsize::new(0);
    let begun = Instant::now();
    let work = || {
        let mut sound = 0;
        while let Some(&(p, rooms, seed)) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
            let (domain, prompt) = PROMPTS[p];
            sound += u32::from(make(domain, prompt, rooms, seed, registry).sound);
        }
        sound
    };
    let sound: u32 = std::thread::scope(|scope| {
        let threads = [scope.spawn(work), scope.spawn(work)];
        threads.map(|t| t.join().expect("a world is made or refused")).into_iter().sum()
    });
    println!("{} worlds with checks, two threads: {:.1} s, {sound} sound", jobs.len(), begun.elapsed().as_secs_f64());
}

/// Logarithm of a quotient.
trait LnDiv {
    fn ln_div(self, other: f64) -> f64;
}

impl LnDiv for f64 {
    fn ln_div(self, other: f64) -> f64 {
        (self / other).ln()
    }
}

fn measure(domain: &str, prompt: &str, rooms: u32, seeds: u64, registry: &Registry) -> Row {
    let mut times = vec![Vec::new(); COLUMNS];
    let (mut cost, mut things, mut attempts, mut good) = (0.0, 0, 0, 0);
    for seed in 0..seeds {
        let made = make(domain, prompt, rooms, seed, registry);
        made.laps.iter().zip(&mut times).for_each(|(lap, times)| times.push(*lap));
        cost += made.cost;
        things += made.things;
        attempts += made.attempts;
        good += u64::from(made.sound);
    }
    let ms: Vec<f64> = times.into_iter().map(median_ms).collect();
    Row {
        rooms,
        ms: std::array::from_fn(|i| ms[i]),
        cost: cost / seeds as f64,
        things: things as f64 / seeds as f64,
        attempts: f64::from(attempts) / seeds as f64,
        sound: format!("{good}/{seeds}"),
    }
}

/// One world and what it took.
struct Made {
    laps: [Duration; COLUMNS],
    cost: f64,
    things: usize,
    attempts: u32,
    sound: bool,
}

fn make(domain: &str, prompt: &str, rooms: u32, seed: u64, registry: &Registry) -> Made {
    let request =
        Request { prompt: prompt.into(), seed, domain: Some(domain.into()), rooms: Some(rooms), ..Request::default() };
    let mut made = Made { laps: [Duration::ZERO; COLUMNS], cost: 0.0, things: 0, attempts: 0, sound: false };
    let begun = Instant::now();
    let mut last = begun;
    let mut observe = |event: Event<'_>| {
        let Event::Finished(stage, _, artifact) = event else { return };
        made.laps[stage as usize] += last.elapsed();
        match artifact {
            Artifact::Floorplan(plan) => made.cost = plan.cost.iter().map(|t| t.cost).sum(),
            Artifact::Placements(p) => made.things = p.placements.len(),
            _ => {}
        }
        last = Instant::now();
    };
    let world = generate_world(&request, registry, &Settings::default(), &mut observe, &AtomicBool::new(false));
    made.laps[COLUMNS - 1] = begun.elapsed();
    match world {
        Ok(world) => (made.attempts, made.sound) = (world.attempts, world.report.sound),
        Err(error) => println!("{domain}, {rooms} rooms, seed {seed}: {error}"),
    }
    made
}

fn median_ms(mut times: Vec<Duration>) -> f64 {
    times.sort();
    times.get(times.len() / 2).map_or(0.0, |t| t.as_secs_f64() * 1000.0)
}

/// Draws time over rooms, both by their logarithms, with the line of n log n through the first point of each curve.
fn plot(curves: &[(&str, Vec<Row>)]) -> String {
    const COLORS: [&str; 3] = ["#1b6ca8", "#c8553d", "#3a7d44"];
    let x = |rooms: u32| 70.0 + 560.0 * f64::from(rooms).ln_div(10.0) / 50f64.ln();
    let y = |ms: f64| 420.0 - 380.0 * ms.max(1.0).log10() / 5.0;
    let mut out = String::from(
        "<svg xmlns='http://www.w3.org/2000/svg' width='720' height='480' font-family='sans-serif' font-size='12'>\n\
         <rect width='720' height='480' fill='#fff'/>\n",
    );
    for power in 0..=5 {
        let (ms, at) = (10f64.powi(power), y(10f64.powi(power)));
        let _ =
            writeln!(out, "<path d='M70 {at:.1}H650' stroke='#ddd'/><text x='8' y='{:.1}'>{ms} ms</text>", at + 4.0);
    }
    for rooms in SIZES {
        let at = x(rooms);
        let _ = writeln!(out, "<path d='M{at:.1} 40V420' stroke='#eee'/><text x='{at:.1}' y='438'>{rooms}</text>");
    }
    let _ =
        writeln!(out, "<text x='330' y='462'>rooms</text><text x='8' y='24'>time of a world; dashed: n log n</text>");
    for ((domain, rows), color) in curves.iter().zip(COLORS) {
        let line = |points: Vec<(u32, f64)>| {
            points.iter().map(|(n, ms)| format!("{:.1},{:.1}", x(*n), y(*ms))).collect::<Vec<_>>().join(" ")
        };
        let Some(first) = rows.first() else { continue };
        let weight = |n: u32| f64::from(n) * f64::from(n).ln();
        let ideal =
            rows.iter().map(|r| (r.rooms, first.ms[COLUMNS - 1] * weight(r.rooms) / weight(first.rooms))).collect();
        let real: Vec<(u32, f64)> = rows.iter().map(|r| (r.rooms, r.ms[COLUMNS - 1])).collect();
        let _ = writeln!(
            out,
            "<polyline points='{}' fill='none' stroke='{color}' stroke-dasharray='4 4'/>\n\
             <polyline points='{}' fill='none' stroke='{color}' stroke-width='2'/>",
            line(ideal),
            line(real.clone())
        );
        if let Some((n, ms)) = real.last() {
            let _ = writeln!(out, "<text x='{:.1}' y='{:.1}' fill='{color}'>{domain}</text>", x(*n) + 4.0, y(*ms));
        }
    }
    out.push_str("</svg>\n");
    out
}
