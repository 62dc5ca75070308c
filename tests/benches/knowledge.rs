//! The knowledge database with 100,000 made-up rules: how fast they go in, how long the index takes, how long a hybrid
//! search with filters takes. Times of searches are also given as multiples of a baseline measured in the same run, a
//! fixed piece of work that is none of ours.
//!
//! `cargo bench -p d3dgen-tests --bench knowledge` measures; run as a test, it does all once with 500 rules.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use d3dgen_knowledge::database::{Database, Provenance, SearchQuery, Searcher};
use d3dgen_model::knowledge::{Constraint, KnowledgeBase, Reference, Source, Value};
use d3dgen_model::seed::Stream;
use d3dgen_store::Options;
use d3dgen_store::embed::StaticTable;
use d3dgen_store::index::Watch;

const RULES: usize = 100_000;
const RULES_A_DOCUMENT: usize = 50;
const SEARCHES: usize = 400;

const PLACES: [&str; 8] = ["DE", "US", "GB", "FR", "EU", "INT", "SG", "AU"];
const TOPICS: [&str; 4] = ["room_size", "fire_safety_evacuation", "convenience_accessibility", "energy_hvac_daylight"];
const SPACES: [&str; 20] = [
    "corridor",
    "patient_room",
    "office",
    "kitchen",
    "bathroom",
    "stairwell",
    "ward",
    "lobby",
    "meeting_room",
    "laboratory",
    "pharmacy",
    "canteen",
    "archive",
    "classroom",
    "garage",
    "balcony",
    "laundry",
    "elevator",
    "ramp",
    "toilet",
];
const QUANTITIES: [(&str, &str); 12] = [
    ("clear_width", "m"),
    ("net_floor_area", "m^2"),
    ("ceiling_height", "m"),
    ("door_width", "m"),
    ("window_area", "m^2"),
    ("travel_distance", "m"),
    ("illuminance", "lx"),
    ("turning_circle", "m"),
    ("sill_height", "m"),
    ("bed_spacing", "m"),
    ("handrail_height", "m"),
    ("air_changes", "ACH"),
];
const CONDITIONS: [&str; 10] = [
    "new buildings",
    "existing buildings",
    "beds are moved",
    "wheelchair users",
    "more than 20 people",
    "two-way traffic",
    "emergency access",
    "night operation",
    "public access",
    "robots operate",
];

fn main() {
    let measuring = std::env::args().any(|a| a == "--bench");
    let rules = if measuring { RULES } else { 500 };
    let folder = tempfile::tempdir().expect("there is a place for temporary files");
    let knowledge = made_up(rules);

    let begun = Instant::now();
    let database = Database::open_or_create(&folder.path().join("store"), &Options::default()).expect("a new store");
    let by = Provenance { who: "bench".into(), when: "2026-11-21T12:00:00Z".into(), why: "bench".into() };
    database.import(&knowledge, false, &by).expect("valid rules").expect("new rules");
    let import = begun.elapsed();

    let begun = Instant::now();
    let open = || Searcher::open(&database, Arc::new(StaticTable::new()), Watch::nobody()).expect("an index");
    let searcher = open();
    let build = begun.elapsed();
    assert!(searcher.rebuilt.is_some());
    let begun = Instant::now();
    assert!(open().rebuilt.is_none());
    let reopen = begun.elapsed();

    let mut stream = Stream::new(7, "bench");
    let (mut times, mut baselines) = (Vec::new(), Vec::new());
    for n in 0..SEARCHES.min(rules) {
        let query = question(&mut stream);
        let begun = Instant::now();
        let found = searcher.search(&query).expect("an answer");
        times.push(begun.elapsed());
        assert!(rules < RULES || !found.is_empty(), "{query:?}");
        if n % 8 == 0 {
            baselines.push(baseline());
        }
    }
    let ms = |d: Duration| d.as_secs_f64() * 1000.0;
    let unit = ms(at(&mut baselines, 0.5));
    println!("{rules} rules; x: multiples of the baseline, {unit:.2} ms");
    println!("import, checked and durable   {:8.0} rules/s", rules as f64 / import.as_secs_f64());
    println!("index made                    {:8.0} rules/s", rules as f64 / build.as_secs_f64());
    println!("index opened                  {:8.1} ms", ms(reopen));
    for (name, part) in [("p50", 0.5), ("p99", 0.99)] {
        let time = ms(at(&mut times, part));
        println!("hybrid search, two filters {name} {time:8.2} ms {:8.2} x", time / unit);
    }
}

/// Returns a search by words with two filters.
fn question(stream: &mut Stream) -> SearchQuery {
    let mut pick = |words: &[&'static str]| words[stream.below(words.len())];
    let (space, quantity, condition) = (pick(&SPACES), pick(&QUANTITIES.map(|q| q.0)), pick(&CONDITIONS));
    let (place, topic) = (pick(&PLACES), pick(&TOPICS));
    SearchQuery {
        text: format!("minimum {} of a {} when {condition}", quantity.replace('_', " "), space.replace('_', " ")),
        filters: [("jurisdiction", place), ("topic", topic)].map(|(k, v)| (k.to_owned(), [v.to_owned()].into())).into(),
        limit: 10,
        ..SearchQuery::default()
    }
}

fn made_up(rules: usize) -> KnowledgeBase {
    let mut stream = Stream::new(3, "rules");
    let mut knowledge = KnowledgeBase::empty("bench");
    for d in 0..rules.div_ceil(RULES_A_DOCUMENT) {
        let source = Source {
            source_id: "s".into(),
            title: format!("Building code {d}, part {}", d % 7),
            publisher: "Bench".into(),
            edition_or_year: (1990 + d % 35).to_string(),
            url: None,
            source_type: "regulation".into(),
        };
        let constraints =
            (0..RULES_A_DOCUMENT.min(rules - d * RULES_A_DOCUMENT)).map(|n| rule(d, n, &mut stream)).collect();
        knowledge.references.push(Reference {
            ref_id: format!("r{d}"),
            building_type: "bench".into(),
            jurisdiction: PLACES[d % PLACES.len()].into(),
            retrieved_at: "2026-11-21".into(),
            sources: vec![source],
            constraints,
        });
    }
    knowledge
}

fn rule(document: usize, n: usize, stream: &mut Stream) -> Constraint {
    let mut below = |count: usize| stream.below(count);
    let (name, unit) = QUANTITIES[below(QUANTITIES.len())];
    Constraint {
        constraint_id: format!("c{document}_{n}"),
        name: name.into(),
        topic: TOPICS[below(TOPICS.len())].into(),
        constraint_type: ["minimum", "maximum", "recommendation"][below(3)].into(),
        value: Value::Number(below(500) as f64 / 100.0),
        unit: unit.into(),
        measurement_basis: name.into(),
        space_type: SPACES[below(SPACES.len())].into(),
        conditions: vec![CONDITIONS[below(CONDITIONS.len())].into()],
        confidence: "high".into(),
        verified: "seen".into(),
        original_value: None,
        note: String::new(),
        source_ids: vec!["s".into()],
        seen_at: None,
        clause: None,
        quotation: None,
        in_force_from: None,
        in_force_until: None,
        superseded_by: None,
    }
}

/// Returns a quantile.
fn at(times: &mut [Duration], part: f64) -> Duration {
    times.sort();
    times[((times.len() - 1) as f64 * part).round() as usize]
}

/// A fixed piece of work: sorts a million numbers' worth of steps.
fn baseline() -> Duration {
    let begun = Instant::now();
    let mut numbers: Vec<u64> = (0..50_000u64).map(|n| n.wrapping_mul(0x9E37_79B9_7F4A_7C15)).collect();
    numbers.sort_unstable();
    black_box(numbers);
    begun.elapsed()
}
