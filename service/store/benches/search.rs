//! Figures of the index: how long it takes to make, to open and to ask, and where the graph of neighbors overtakes the
//! scan. `cargo bench -p d3dgen-store --bench search` measures 100,000 documents made up like building rules; run as a
//! test it does everything once with 500. It prints and never fails: figures of a busy machine are no verdict.
//!
//! Every time is also given as a multiple of a baseline of the same run, one dot product with each full vector, which
//! is what a search without any index would cost.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use d3dgen_store::Error;
use d3dgen_store::embed::{Embedder, StaticTable};
use d3dgen_store::index::measuring::Paths;
use d3dgen_store::index::{Document, Filter, Index, IndexSpec, Mode, Watch};

const QUANTITIES: &[&str] = &[
    "corridor width",
    "door clear width",
    "room area",
    "ceiling height",
    "window area",
    "stair riser height",
    "ramp slope",
    "turning circle",
    "travel distance",
    "illuminance",
    "air changes",
    "bed spacing",
    "desk area",
    "toilet count",
    "sill height",
    "handrail height",
    "parking width",
    "aisle width",
    "dock clearance",
    "robot speed",
    "sound insulation",
    "storage volume",
    "shower size",
    "counter height",
    "sink count",
    "shelf depth",
    "gap under door",
    "exit count",
];
const SPACES: &[&str] = &[
    "kitchen",
    "corridor",
    "bedroom",
    "office",
    "ward",
    "patient room",
    "operating room",
    "bathroom",
    "toilet",
    "lobby",
    "meeting room",
    "classroom",
    "gymnasium",
    "warehouse hall",
    "loading bay",
    "stairwell",
    "elevator",
    "balcony",
    "pantry",
    "laundry",
    "nurse station",
    "waiting area",
    "laboratory",
    "pharmacy",
    "library",
    "canteen",
    "server room",
    "archive",
    "reception",
    "locker room",
    "recovery room",
    "isolation room",
    "garage",
    "basement",
    "attic",
    "hallway",
    "dining room",
];
const CONDITIONS: &[&str] = &[
    "in new buildings",
    "for wheelchair users",
    "when sprinklers are installed",
    "with more than fifty persons",
    "at night",
    "on the ground floor",
    "measured between finished surfaces",
    "where beds are moved",
    "for children",
    "if no window opens",
    "unless the authority agrees",
    "per person present",
    "in existing buildings after alteration",
    "with natural light",
    "behind fire doors",
    "on escape routes",
    "next to wet rooms",
    "for two-way traffic",
    "within a dwelling",
    "for staff only",
];
const KINDS: &[&str] = &["minimum", "maximum", "recommended", "range", "count", "presence"];
const UNITS: &[&str] = &["m", "m2", "lx", "1/h", "persons", "dB", "percent"];
const QUESTIONS: &[&str] = &[
    "how wide must a {s} be",
    "{q} in the {s}",
    "smallest {q} of a {s} {c}",
    "{s} {q}",
    "what is the {q} {c}",
    "rules for {s} {c}",
    "{q} {c}",
    "Mindestmaß {s} {q}",
    "corridr widht {s}",
    "space needed for people in a {s}",
];

/// A fixed sequence of numbers.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn pick<'a>(&mut self, from: &[&'a str]) -> &'a str {
        from[self.next() as usize % from.len()]
    }
}

fn spec() -> IndexSpec {
    IndexSpec::default()
        .field("name", 3.0)
        .field("space", 2.0)
        .field("text", 1.0)
        .facets(&["domain", "country", "space", "kind", "unit"])
        .numbers(&["value", "year"])
}

fn documents(count: usize) -> Vec<Document> {
    let mut random = Random(1);
    let one = |i: usize| {
        let (quantity, space, kind, unit) =
            (random.pick(QUANTITIES), random.pick(SPACES), random.pick(KINDS), random.pick(UNITS));
        let (first, second) = (random.pick(CONDITIONS), random.pick(CONDITIONS));
        let value = (random.next() % 5000) as f64 / 100.0;
        let text = format!(
            "{kind} {quantity} of the {space}: {value} {unit}, {first}, {second}, section {}",
            random.next() % 900
        );
        Document {
            key: format!("rule_{i:06}"),
            embed_text: format!("{quantity} {space} {kind}, {first}, {second}"),
            texts: [("name", quantity.to_owned()), ("space", space.to_owned()), ("text", text)]
                .map(|(name, text)| (name.to_owned(), text))
                .into(),
            facets: [
                ("domain", ["hospital", "office", "residential"][i % 3].to_owned()),
                ("country", format!("C{:02}", random.next() % 24)),
                ("space", space.to_owned()),
                ("kind", kind.to_owned()),
                ("unit", unit.to_owned()),
            ]
            .map(|(name, value)| (name.to_owned(), vec![value]))
            .into(),
            numbers: [("value".to_owned(), value), ("year".to_owned(), (1990 + random.next() % 36) as f64)].into(),
        }
    };
    (0..count).map(one).collect()
}

fn questions(count: usize) -> Vec<(String, Filter)> {
    let mut random = Random(2);
    let one = |i: usize| {
        let text = random.pick(QUESTIONS).replace("{s}", random.pick(SPACES));
        let text = text.replace("{q}", random.pick(QUANTITIES)).replace("{c}", random.pick(CONDITIONS));
        let domain = Filter::facet("domain", [["hospital", "office", "residential"][i % 3]]);
        let country = format!("C{:02}", random.next() % 24);
        let filter = match i % 5 {
            0 => domain,
            1 => domain.and(Filter::facet("country", [country])),
            2 => Filter::facet("space", [random.pick(SPACES), random.pick(SPACES), random.pick(SPACES)]),
            3 => Filter::number("year", Some(2005.0), None).and(Filter::facet("kind", ["minimum"])),
            _ => Filter::facet("country", [country]).negate().and(Filter::facet("unit", ["m", "m2"])),
        };
        (text, filter)
    };
    (0..count).map(one).collect()
}

fn main() {
    let measuring = std::env::args().any(|a| a == "--bench");
    let rows = std::env::var("ROWS").ok().and_then(|r| r.parse().ok());
    let rows: usize = rows.unwrap_or(if measuring { 100_000 } else { 500 });
    // Before anything else has touched the table.
    small_open();
    let documents = documents(rows);
    let embedder = StaticTable::new();
    let texts: Vec<&str> = documents.iter().map(|d| d.embed_text.as_str()).collect();
    let begun = Instant::now();
    let vectors: Vec<Vec<f32>> = embedder.embed(&texts).expect("the table does not fail");
    println!("embedding: {:.0} texts/s", rows as f64 / begun.elapsed().as_secs_f64());
    let baseline = baseline(&vectors);
    println!("baseline, one dot product with each of {rows} full vectors: {:.2} ms", ms(baseline));
    ask(documents, baseline, if measuring { 500 } else { 20 });
    let sizes: &[usize] = if measuring { &[3_000, 10_000, 30_000, 100_000] } else { &[300] };
    sizes.iter().filter(|size| **size <= rows).for_each(|size| compare_paths(&vectors[..*size], embedder));
}

/// Opens an index of 1,000 documents, as a command does once.
fn small_open() {
    let dir = tempfile::tempdir().expect("there is a place for temporary files");
    let documents = documents(1000);
    let made = || Ok::<_, Error>(documents.clone());
    let mut times = Vec::new();
    for _ in 0..9 {
        let begun = Instant::now();
        let table = Arc::new(StaticTable::new());
        let opened = Index::open_or_rebuild(dir.path(), &spec(), table, 1, made, Watch::nobody()).expect("it opens");
        let hits = opened.index.search("corridor width", &Filter::Everything, 10, Mode::Hybrid).expect("it answers");
        assert_eq!(hits.len(), 10);
        times.push(begun.elapsed());
    }
    println!(
        "1,000 documents: made and asked in {:.1} ms, opened and asked in {:.1} ms",
        ms(times[0]),
        ms(median(times[1..].to_vec()))
    );
}

fn ask(documents: Vec<Document>, baseline: Duration, count: usize) {
    let rows = documents.len();
    let dir = tempfile::tempdir().expect("there is a place for temporary files");
    let table = Arc::new(StaticTable::new());
    let before = resident_mb();
    let begun = Instant::now();
    let made = || Ok::<_, Error>(documents);
    let opened =
        Index::open_or_rebuild(dir.path(), &spec(), table.clone(), 1, made, Watch::nobody()).expect("it is made");
    let took = begun.elapsed().as_secs_f64();
    println!("{rows} documents: made in {took:.1} s, {:.0} documents/s", rows as f64 / took);
    drop(opened);
    let begun = Instant::now();
    let none = || Ok::<_, Error>(Vec::new());
    let index = Index::open_or_rebuild(dir.path(), &spec(), table, 1, none, Watch::nobody()).expect("it opens").index;
    println!(
        "opened in {:.0} ms; {:.0} MB resident before, {:.0} MB after",
        ms(begun.elapsed()),
        before,
        resident_mb()
    );
    let begun = Instant::now();
    let _ = index.search("first question of all", &Filter::Everything, 10, Mode::Vector);
    println!(
        "first unfiltered question by meaning, which would read a graph: {:.0} ms, then {:.0} MB",
        ms(begun.elapsed()),
        resident_mb()
    );
    for (label, mode, filtered) in [
        ("hybrid, filtered", Mode::Hybrid, true),
        ("hybrid, all", Mode::Hybrid, false),
        ("words, filtered", Mode::Text, true),
        ("words, all", Mode::Text, false),
        ("meaning, filtered", Mode::Vector, true),
        ("meaning, all", Mode::Vector, false),
    ] {
        let mut times = Vec::new();
        let ran = running();
        for (text, filter) in questions(count) {
            let filter = if filtered { filter } else { Filter::Everything };
            let begun = Instant::now();
            let hits = index.search(&text, &filter, 10, mode).expect("it answers");
            times.push(begun.elapsed());
            black_box(hits);
        }
        times.sort();
        let (p50, p99) = (times[times.len() / 2], times[times.len() * 99 / 100]);
        let ratio = p50.as_secs_f64() / baseline.as_secs_f64();
        let ran = ms(running() - ran) / count as f64;
        println!(
            "{label:<18} p50 {:6.2} ms  p99 {:6.2} ms  {ratio:.2} x baseline; {ran:.2} ms running",
            ms(p50),
            ms(p99)
        );
    }
}

/// Compares the scan with the graph, for filters that leave all, half, an eighth or little of the rows.
fn compare_paths(vectors: &[Vec<f32>], embedder: StaticTable) {
    let full: Vec<f32> = vectors.iter().flatten().copied().collect();
    let (begun, ran) = (Instant::now(), running());
    let paths = Paths::new(embedder.dim(), full, true).expect("vectors can be linked");
    let (took, ran) = (begun.elapsed(), running() - ran);
    println!("{} vectors: linked in {:.1} s, {:.1} s running", vectors.len(), took.as_secs_f64(), ran.as_secs_f64());
    let texts: Vec<String> = questions(100).into_iter().map(|(text, _)| text).collect();
    let questions =
        embedder.embed(&texts.iter().map(String::as_str).collect::<Vec<_>>()).expect("the table does not fail");
    for every in [1, 2, 64] {
        let line: Vec<String> = [false, true].map(|by_graph| measure_path(&paths, &questions, every, by_graph)).into();
        println!("  1/{every:<3} scan {}   graph {}", line[0], line[1]);
    }
}

fn measure_path(paths: &Paths, questions: &[Vec<f32>], every: u32, by_graph: bool) -> String {
    let (begun, ran) = (Instant::now(), running());
    let found: Vec<_> = questions.iter().map(|q| paths.nearest(q, 10, every, by_graph)).collect();
    let each = begun.elapsed().as_secs_f64() / questions.len() as f64;
    let ran = ms(running() - ran) / questions.len() as f64;
    let (mut right, mut all) = (0, 0);
    for (question, found) in questions.iter().zip(found) {
        let exact = paths.exact(question, 10, every);
        // Made-up rules repeat themselves: any row as near as the tenth is right.
        let least = exact.last().map_or(f32::MAX, |(_, score)| score - 1e-6);
        right += found.iter().filter(|(_, score)| *score >= least).count().min(exact.len());
        all += exact.len();
    }
    format!("{:7.0} questions/s, {ran:.2} ms running, recall@10 {:.4}", 1.0 / each, right as f64 / all as f64)
}

fn baseline(vectors: &[Vec<f32>]) -> Duration {
    let once = |question: &Vec<f32>| {
        let begun = Instant::now();
        for vector in vectors {
            black_box(vector.iter().zip(question).map(|(a, b)| a * b).sum::<f32>());
        }
        begun.elapsed()
    };
    median(vectors.iter().take(15).map(once).collect())
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times[times.len() / 2]
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1000.0
}

/// Time this thread was running, where the system tells: on a busy machine it says more than the clock on the wall.
fn running() -> Duration {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    Duration::from_nanos(stat.split(' ').next().and_then(|ns| ns.parse().ok()).unwrap_or(0))
}

/// Memory of this process in use, where the system tells.
fn resident_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|l| l.trim().split(' ').next()?.parse::<f64>().ok()).unwrap_or(f64::NAN) / 1024.0
}
