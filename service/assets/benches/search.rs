//! Figures of the asset database: how long it takes to keep, to index, to open and to ask, and the memory it needs.
//! `cargo bench -p d3dgen-assets --bench search` measures 100,000 made-up annotations; run as a test it does everything
//! once with few. It prints and never fails: figures of a busy machine are no verdict.
//!
//! Times of questions are also given as a multiple of a baseline of the same run: reading and parsing 80 records, which
//! is what judging the candidates of a question costs without finding them.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use d3dgen_assets::annotation::{Annotation, Origin, Swatch};
use d3dgen_assets::catalog::Catalog;
use d3dgen_assets::database::{Database, Kind, NewAsset, Provenance, Searcher, Shelf};
use d3dgen_assets::library::Library;
use d3dgen_assets::search::SearchQuery;
use d3dgen_model::domain::Domain;
use d3dgen_plugins::{Plugin, Registry};
use d3dgen_store::Options;
use d3dgen_store::embed::StaticTable;
use d3dgen_store::index::Watch;

const LOOKS: &[&str] =
    &["Oslo", "Milano", "Kyoto", "Porto", "Aalto", "Bauhaus", "Rustic", "Nova", "Luna", "Terra", "Vega", "Onyx"];
const COLORS: &[(&str, &str)] = &[
    ("white", "#f2f2f2"),
    ("black", "#141414"),
    ("brown", "#6b4423"),
    ("blue", "#2a4a8c"),
    ("red", "#a02525"),
    ("green", "#2f6b3a"),
];
const QUESTIONS: &[&str] = &[
    "{n}",
    "{c} {n}",
    "{n} for the {r}",
    "small {n} height<1.0",
    "{l} {n}",
    "something to sit on in the {r}",
    "{n} mount=floor color={c}",
    "where to keep clothes",
    "machine for the {r}",
    "{c} {l} {n} under 80 cm wide",
    "wooden {n}",
    "Schrank",
    "Lampe mount=ceiling",
    "place to wash hands",
    "light over the {n}",
];

/// Small numbers that look random and are the same each time.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % sides.max(1)
    }

    fn pick<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.roll(list.len())]
    }
}

fn made_up(base: &[Annotation], i: usize, dice: &mut Dice) -> Annotation {
    let mut a = dice.pick(base).clone();
    let (look, color, scale) = (dice.pick::<&str>(LOOKS), dice.pick(COLORS), 0.8 + dice.roll(400) as f64 / 1000.0);
    a.name = format!("{look} {}", a.name.to_lowercase());
    a.asset_id = format!("Office/{look}_{}_{i}", a.object.clone().unwrap_or_default());
    a.size_m = a.size_m.map(|v| (v * scale * 1e6).round() / 1e6);
    let [x, y, z] = a.size_m;
    a.bounding_box_m = [[-x / 2.0, x / 2.0], [-y / 2.0, y / 2.0], [0.0, z]];
    a.palette = vec![Swatch { name: color.0.into(), hex: color.1.into(), share: 1.0 }];
    a.triangle_count = dice.roll(50_000) as u64;
    a.tags.push(look.to_lowercase());
    a.origin = Origin::Ingested { path: format!("{i}.glb"), hash: format!("{i:064x}") };
    a
}

fn main() {
    let full = std::env::args().any(|a| a == "--bench");
    let (count, rounds) = if full { (100_000, 40) } else { (300, 1) };
    let registry = Registry::builtin();
    let domains: Vec<&Domain> = registry.iter().map(Plugin::domain).collect();
    let catalog = Catalog::new(domains);
    let base: Vec<Annotation> = Library::new(&catalog).assets().map(|a| a.annotation(&catalog)).collect();
    let dir = tempfile::tempdir().expect("a folder");
    let database = Database::open_or_create(&dir.path().join("store"), &Options::default()).expect("a store");
    let by = Provenance { who: "bench".into(), when: "2026-11-21T00:00:00Z".into(), why: "made up".into() };
    let mut dice = Dice(7);

    let begun = Instant::now();
    for start in (0..count).step_by(1000) {
        let assets = (start..(start + 1000).min(count)).map(|i| made_up(&base, i, &mut dice));
        let assets = assets.map(|annotation| NewAsset::new(annotation, None, BTreeMap::new())).collect();
        database.put(Kind::Ingest, assets, &by).expect("stored");
    }
    println!("{count} annotations kept in {:.1} s", begun.elapsed().as_secs_f64());
    for what in ["indexed", "opened"] {
        let begun = Instant::now();
        drop(searcher(&database, &catalog));
        println!("{what} in {:.2} s", begun.elapsed().as_secs_f64());
    }

    let searcher = searcher(&database, &catalog);
    let baseline = baseline(&database, &mut dice, count);
    let mut times: Vec<(Duration, String)> = Vec::new();
    for _ in 0..rounds {
        for question in QUESTIONS {
            let a = dice.pick(&base);
            let room = a.room_types.first().and_then(|r| catalog.room_label(r)).unwrap_or("office");
            let text = question
                .replace("{n}", &a.name.to_lowercase())
                .replace("{c}", dice.pick(COLORS).0)
                .replace("{l}", dice.pick::<&str>(LOOKS))
                .replace("{r}", &room.to_lowercase());
            let query = SearchQuery { text: text.clone(), limit: 10, one_per_object: true, ..SearchQuery::default() };
            let begun = Instant::now();
            let found = searcher.search(&query).expect("an answer");
            times.push((begun.elapsed(), text));
            assert!(found.len() <= 10);
        }
    }
    times.sort();
    let at = |share: f64| &times[((times.len() - 1) as f64 * share) as usize];
    let ms = |d: Duration| d.as_secs_f64() * 1000.0;
    for (name, share) in [("p50", 0.5), ("p90", 0.9), ("p99", 0.99), ("max", 1.0)] {
        let (time, text) = at(share);
        println!("search {name} {:.2} ms, {:.1} x baseline ({text:?})", ms(*time), ms(*time) / ms(baseline));
    }
    println!("baseline, 80 records read: {:.2} ms", ms(baseline));
    if let Some(line) = std::fs::read_to_string("/proc/self/status")
        .ok()
        .and_then(|s| s.lines().find(|l| l.starts_with("VmHWM")).map(str::to_owned))
    {
        println!("most memory: {}", line.trim_start_matches("VmHWM:").trim());
    }
}

fn searcher<'c>(database: &Database, catalog: &'c Catalog) -> Searcher<'c> {
    let shelf = Shelf::new(Some(database.clone()), catalog).expect("readable");
    Searcher::open(shelf, Arc::new(StaticTable::new()), Watch::nobody()).expect("an index")
}

fn baseline(database: &Database, dice: &mut Dice, count: usize) -> Duration {
    let ids = database.ids().expect("readable");
    let mut times: Vec<Duration> = (0..9)
        .map(|_| {
            let begun = Instant::now();
            for _ in 0..80 {
                let id = &ids[dice.roll(count.min(ids.len()))];
                assert!(database.get(id).expect("readable").is_some());
            }
            begun.elapsed()
        })
        .collect();
    times.sort();
    times[4]
}
