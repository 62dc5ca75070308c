//! What came of a world, for people (a table) and programs (a JSON line).

use std::path::{Path, PathBuf};
use std::time::Duration;

use d3dgen_model::report::{ConstraintSummary, Report};
use d3dgen_model::scene_graph::Note;
use d3dgen_pipeline::generate::Generated;
use serde_json::{Value, json};

use crate::error::Error;
use crate::table::table;

/// Most notes and violations that are printed of one world; the report has all.
const MOST_LINES: usize = 12;

/// The figures of one world.
pub struct Summary {
    name: String,
    domain: String,
    seed: u64,
    path: PathBuf,
    sound: bool,
    rooms: usize,
    circulation: usize,
    area_m2: f64,
    objects: usize,
    constraints: ConstraintSummary,
    broken: Vec<String>,
    notes: Vec<Note>,
    attempts: u32,
    times: Vec<(&'static str, Duration)>,
}

impl Summary {
    /// Returns the figures of a world written to a folder, with the time each stage took.
    pub fn new(made: &Generated, path: &Path, times: Vec<(&'static str, Duration)>) -> Self {
        let Generated { world, report, attempts } = made;
        let graph = &world.scene_graph;
        let circulation = world.floorplan.rooms.iter().filter(|r| r.circulation).count();
        let notes = graph.conflicts.iter().chain(&world.floorplan.conflicts);
        Self {
            name: world.name.clone(),
            domain: graph.domain.clone(),
            seed: graph.seed,
            path: path.to_path_buf(),
            sound: report.sound,
            rooms: world.floorplan.rooms.len() - circulation,
            circulation,
            area_m2: world.floorplan.rooms.iter().map(|r| r.net_area_m2).sum(),
            objects: world.placements.placements.len(),
            constraints: report.summary.clone(),
            broken: broken_lines(report),
            notes: notes.cloned().collect(),
            attempts: *attempts,
            times,
        }
    }

    /// Returns true when the world holds every hard rule.
    pub fn sound(&self) -> bool {
        self.sound
    }

    /// Returns the name of the world.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns one JSON value with everything; areas in m2, times in ms.
    pub fn json(&self) -> Value {
        let times: serde_json::Map<String, Value> =
            self.times.iter().map(|(stage, t)| ((*stage).to_owned(), json!(round(ms(*t), 2)))).collect();
        json!({
            "world": self.name, "domain": self.domain, "seed": self.seed, "path": self.path.display().to_string(),
            "sound": self.sound, "rooms": self.rooms, "circulation_rooms": self.circulation,
            "area_m2": round(self.area_m2, 2), "objects": self.objects, "constraints": self.constraints,
            "violations": self.broken, "conflicts": self.notes, "attempts": self.attempts, "stage_ms": times,
        })
    }

    fn row(&self) -> Vec<String> {
        let c = &self.constraints;
        let rooms =
            if self.circulation == 0 { self.rooms.to_string() } else { format!("{}+{}", self.rooms, self.circulation) };
        let times: Vec<String> = self.times.iter().map(|(_, t)| format!("{:.0}", ms(*t))).collect();
        vec![
            self.name.clone(),
            if self.sound { "sound" } else { "UNSOUND" }.to_owned(),
            rooms,
            format!("{:.1}", self.area_m2),
            self.objects.to_string(),
            format!("{}/{}/{}", c.satisfied, c.violated, c.not_decidable),
            times.join(" + "),
        ]
    }
}

/// Returns the closing table of some worlds, with what was changed or broken below it.
pub fn closing(worlds: &[Summary]) -> String {
    let header = ["world", "", "rooms", "m2", "objects", "satisfied/violated/open", "ms"];
    let mut text = table(&header, &worlds.iter().map(Summary::row).collect::<Vec<_>>());
    if let Some(first) = worlds.first() {
        let stages: Vec<&str> = first.times.iter().map(|(stage, _)| *stage).collect();
        text += &format!(
            "rooms + circulation; constraints satisfied/violated/not decidable; ms of {}\n",
            stages.join(" + ")
        );
    }
    for world in worlds {
        let notes = world.notes.iter().map(|n| n.message.as_str());
        let lines: Vec<String> = notes.map(|m| format!("changed: {m}")).chain(world.broken.iter().cloned()).collect();
        for line in lines.iter().take(MOST_LINES) {
            text += &format!("{}: {line}\n", world.name);
        }
        if lines.len() > MOST_LINES {
            text += &format!("{}: and {} more, see report.json\n", world.name, lines.len() - MOST_LINES);
        }
    }
    text
}

/// Returns a line for each violation.
pub fn broken_lines(report: &Report) -> Vec<String> {
    let violations = report.rules.iter().flat_map(|r| &r.violations);
    violations.map(|v| format!("{} {}: {}", v.code, v.subject, v.message)).collect()
}

/// Prints what a world breaks.
pub fn print_broken(report: &Report) {
    broken_lines(report).iter().for_each(|line| eprintln!("{}: {line}", report.world));
}

/// Returns the error of an unsound world.
pub fn unsound(report: &Report) -> Error {
    let rules: Vec<&str> = report.rules.iter().filter(|r| !r.violations.is_empty()).map(|r| r.rule.as_str()).collect();
    Error::Unsound(format!("{} breaks {} hard rule(s): {}", report.world, rules.len(), rules.join(", ")))
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1000.0
}

fn round(value: f64, digits: i32) -> f64 {
    let scale = 10_f64.powi(digits);
    (value * scale).round() / scale
}
