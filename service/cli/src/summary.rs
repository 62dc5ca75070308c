//! What came of a world, for people (a table) and programs (a JSON line).

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Duration;

use d3dgen_model::report::{
    AskAnswer, Citation, ConstraintResult, ConstraintSummary, Fate, Report, RobotFit, Status, Violation,
};
use d3dgen_model::scene_graph::Note;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::Generated;
use serde_json::{Value, json};

use crate::error::Error;
use crate::output::Kept;
use crate::table::table;

/// Most notes, broken rules and constraints that are printed of one run; the reports have all.
const MOST_LINES: usize = 12;

/// The figures of one world.
pub struct Summary {
    name: String,
    domain: String,
    building_type: Option<String>,
    country_code: Option<String>,
    place_code: Option<String>,
    seed: u64,
    path: PathBuf,
    kept: Option<Kept>,
    sound: bool,
    verdict: &'static str,
    rules: usize,
    rooms: usize,
    circulation: usize,
    area_m2: f64,
    objects: usize,
    robots: usize,
    robot_fit: Vec<String>,
    people: usize,
    constraints: ConstraintSummary,
    national: String,
    violated: Vec<String>,
    broken: Vec<String>,
    assumptions: Vec<Note>,
    conflicts: Vec<Note>,
    asks: Vec<AskAnswer>,
    not_understood: Vec<String>,
    attempts: u32,
    times: Vec<(&'static str, Duration)>,
    proposals: Vec<(String, String)>,
}

impl Summary {
    /// Returns the figures of a world written to a folder, with the time each stage took.
    pub fn new(made: &Generated, path: &Path, times: Vec<(&'static str, Duration)>) -> Self {
        let Generated { world, report, attempts } = made;
        let graph = &world.scene_graph;
        let circulation = world.floorplan.rooms.iter().filter(|r| r.circulation).count();
        Self {
            name: world.name.clone(),
            domain: graph.domain.clone(),
            building_type: graph.building_type.clone(),
            country_code: graph.country_code.clone(),
            place_code: graph.place_code().map(str::to_owned),
            seed: graph.seed,
            path: path.to_path_buf(),
            kept: None,
            sound: report.sound,
            verdict: verdict(report),
            rules: report.rules.len(),
            rooms: world.floorplan.rooms.len() - circulation,
            circulation,
            area_m2: world.floorplan.rooms.iter().map(|r| r.net_area_m2).sum(),
            objects: world.placements.placements.len(),
            robots: world.scenario.robots.len(),
            robot_fit: report.robot_fit.iter().map(fit_line).collect(),
            people: world.scenario.agents.len(),
            constraints: report.summary.clone(),
            national: report.applied_rules().line(graph.place_code()),
            violated: violated_lines(report),
            broken: broken_lines(report),
            assumptions: graph.assumptions.clone(),
            conflicts: graph.conflicts.iter().chain(&world.floorplan.conflicts).cloned().collect(),
            asks: report.asks.clone(),
            not_understood: not_understood(world),
            attempts: *attempts,
            times,
            proposals: Vec::new(),
        }
    }

    /// Returns the figures with what became of a model's proposals: stage and a line for each.
    pub fn with_proposals(self, proposals: Vec<(String, String)>) -> Self {
        Self { proposals, ..self }
    }

    /// Returns the figures of a world that was not written, for the folder keeps an earlier one.
    pub fn with_kept(self, kept: Option<Kept>) -> Self {
        Self { kept, ..self }
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
        let mut value = json!({
            "world": self.name, "domain": self.domain, "building_type": self.building_type,
            "country_code": self.country_code, "place_code": self.place_code, "seed": self.seed, "path": self.path.display().to_string(),
            "written": self.kept.is_none(),
            "sound": self.sound, "verdict": self.verdict.to_lowercase(),
            "rooms": self.rooms, "circulation_rooms": self.circulation,
            "area_m2": round(self.area_m2, 2), "objects": self.objects, "robots": self.robots, "people": self.people,
            "constraints": self.constraints, "violations": self.broken, "assumptions": self.assumptions,
            "conflicts": self.conflicts, "asks": self.asks, "not_understood": self.not_understood, "attempts": self.attempts, "stage_ms": times,
        });
        if !self.proposals.is_empty() {
            let proposals: serde_json::Map<String, Value> =
                self.proposals.iter().map(|(stage, line)| (stage.clone(), json!(line))).collect();
            value["proposals"] = Value::Object(proposals);
        }
        value
    }

    /// Returns the closing lines of a single world.
    pub fn page(&self) -> String {
        let c = &self.constraints;
        let building_type = self.building_type.as_deref().filter(|t| *t != self.domain);
        let building = [Some(self.domain.as_str()), building_type, self.place_code.as_deref()];
        let stages: Vec<String> = self.times.iter().map(|(stage, t)| format!("{stage} {:.0}", ms(*t))).collect();
        let again = if self.attempts > 1 { format!(", in {} attempts", self.attempts) } else { String::new() };
        let circulation =
            if self.circulation > 0 { format!(" + {} for circulation", self.circulation) } else { String::new() };
        let rules =
            if self.broken.is_empty() { "all hold".into() } else { format!("broken {} times", self.broken.len()) };
        let rows = [
            ("building", building.into_iter().flatten().collect::<Vec<_>>().join(", ")),
            ("rooms", format!("{}{circulation}, {:.1} m2", self.rooms, self.area_m2)),
            ("objects", format!("{}, {:.1} a room", self.objects, self.objects_per_room())),
            ("robots", format!("{}, people {}", self.robots, self.people)),
            ("hard rules", format!("{} checked, {rules}", self.rules)),
            ("law", self.national.clone()),
            (
                "constraints",
                format!(
                    "{} satisfied, {} violated, {} not decidable from a plan",
                    c.satisfied, c.violated, c.not_decidable
                ),
            ),
            ("time", format!("{:.0} ms: {}{again}", self.total_ms(), stages.join(", "))),
            ("folder", self.folder()),
        ];
        let mut text = format!("\n{}, seed {}: {}{}\n", self.name, self.seed, self.verdict, self.wishes());
        for (label, value) in rows {
            text += &format!("  {label:<12} {value}\n");
        }
        let proposed: Vec<String> = self.proposals.iter().map(|(stage, line)| format!("{stage}: {line}")).collect();
        for (label, lines) in [
            ("robot", self.robot_fit.clone()),
            ("proposed", proposed),
            ("not as asked", self.asks.iter().filter(|a| a.fate != Fate::Honored).map(ask_line).collect()),
            ("not read", self.not_understood.clone()),
            ("assumed", messages(&self.assumptions)),
            ("changed", messages(&self.conflicts)),
            ("violated", self.violated.clone()),
            ("broken", self.broken.clone()),
        ] {
            text += &listed(label, &lines);
        }
        text
    }

    /// Returns how many of the wishes are met, as the verdict goes on; nothing where none was read.
    fn wishes(&self) -> String {
        let met = self.asks.iter().filter(|a| a.fate == Fate::Honored).count();
        match self.asks.len() {
            0 => String::new(),
            all => format!("; {met} of {all} wishes met"),
        }
    }

    fn folder(&self) -> String {
        self.kept.as_ref().map_or_else(|| self.path.display().to_string(), Kept::to_string)
    }

    fn row(&self) -> Vec<String> {
        let c = &self.constraints;
        vec![
            self.name.clone(),
            self.verdict.to_owned(),
            self.rooms.to_string(),
            self.circulation.to_string(),
            format!("{:.1}", self.area_m2),
            self.objects.to_string(),
            format!("{:.1}", self.objects_per_room()),
            c.satisfied.to_string(),
            c.violated.to_string(),
            self.attempts.to_string(),
            format!("{:.0}", self.total_ms()),
        ]
    }

    fn objects_per_room(&self) -> f64 {
        self.objects as f64 / (self.rooms + self.circulation).max(1) as f64
    }

    fn total_ms(&self) -> f64 {
        self.times.iter().map(|(_, t)| ms(*t)).sum()
    }
}

/// Returns the words of a prompt that nobody understood.
fn not_understood(world: &World) -> Vec<String> {
    world.brief.iter().flat_map(|b| &b.not_understood).map(|w| w.text.clone()).collect()
}

/// Returns a wish that is not met as it was said, and why.
fn ask_line(ask: &AskAnswer) -> String {
    format!("`{}`: {}", ask.said, ask.reason)
}

/// Returns whether a robot fits, and else how many rooms it gets to and the narrowest place on its way to the others.
fn fit_line(fit: &RobotFit) -> String {
    let body = format!("{} robot that needs {:.2} m", fit.kind, 2.0 * fit.radius_m);
    let reached = fit.rooms.iter().filter(|w| w.reachable).count();
    let missed = fit.rooms.iter().chain(&fit.points).filter(|w| !w.reachable);
    let narrow = missed.min_by(|a, b| b.clear_width_m.total_cmp(&a.clear_width_m));
    match narrow.filter(|_| !fit.fits) {
        Some(way) => {
            let height = way.clear_height_m.map(|h| format!("{h:.2} m of height"));
            let clear = height.unwrap_or_else(|| format!("{:.2} m", way.clear_width_m));
            let rooms = fit.rooms.len();
            format!("{body} gets to {reached} of {rooms} rooms; to {} there are {clear} at {}", way.to, way.narrowest)
        }
        None => format!("{body} fits"),
    }
}

/// Returns the closing table of many worlds, with what was changed or broken below it.
pub fn closing(worlds: &[Summary]) -> String {
    let header = [
        "world",
        "",
        "rooms",
        "circulation",
        "area m2",
        "objects",
        "a room",
        "satisfied",
        "violated",
        "attempts",
        "time ms",
    ];
    let mut text = format!("\n{}", table(&header, &worlds.iter().map(Summary::row).collect::<Vec<_>>()));
    let mut changes = BTreeSet::new(); // worlds of one prompt mostly share them
    let changed = worlds.iter().flat_map(|w| messages(&w.conflicts)).filter(|m| changes.insert(m.clone()));
    text += &listed("changed", &changed.collect::<Vec<_>>());
    let broken = worlds.iter().flat_map(|w| w.broken.iter().map(|line| format!("{}: {line}", w.name)));
    text += &listed("broken", &broken.collect::<Vec<_>>());
    let kept = worlds.iter().filter_map(|w| w.kept.as_ref());
    text += &listed("folder", &kept.map(Kept::to_string).collect::<Vec<_>>());
    text
}

/// Returns lines under one label, the last one saying how many were left out.
fn listed(label: &str, lines: &[String]) -> String {
    let mut text: String = lines.iter().take(MOST_LINES).map(|line| format!("  {label:<12} {line}\n")).collect();
    if lines.len() > MOST_LINES {
        text += &format!("  {label:<12} and {} more, see report.json\n", lines.len() - MOST_LINES);
    }
    text
}

fn messages(notes: &[Note]) -> Vec<String> {
    notes.iter().map(|n| n.message.clone()).collect()
}

/// Returns the verdict in a word: `given` where only the plan that was brought is to blame.
pub fn verdict(report: &Report) -> &'static str {
    if report.sound {
        "sound"
    } else if report.is_given() {
        "given"
    } else {
        "UNSOUND"
    }
}

/// Returns a line for each violated constraint, mandatory ones first.
fn violated_lines(report: &Report) -> Vec<String> {
    let mut violated: Vec<_> = report.constraints.iter().filter(|c| c.status == Status::Violated).collect();
    violated.sort_by_key(|c| !c.mandatory);
    violated.into_iter().map(violated_line).collect()
}

/// Returns a violated constraint with its figures and where it comes from.
fn violated_line(c: &ConstraintResult) -> String {
    let limits = [("at least", c.required_min), ("at most", c.required_max)];
    let limits: Vec<String> =
        limits.iter().filter_map(|(word, v)| v.map(|v| format!("{word} {}", round(v, 3)))).collect();
    let measured = c.measured.map_or_else(|| "not measured".into(), |m| round(m, 3).to_string());
    let force = if c.mandatory { "mandatory" } else { "advice" };
    format!(
        "{} of {}: {measured}, should be {} {} ({force}, {}: {})",
        c.name,
        c.subject,
        limits.join(" and "),
        c.unit,
        c.citation.jurisdiction,
        place(&c.citation)
    )
}

/// Returns where a rule stands: document, clause, what is quoted of it, the page where it was read, and when it ended.
fn place(citation: &Citation) -> String {
    let mut text = citation.source.title.clone();
    if let Some(clause) = &citation.clause {
        text += &format!(", {clause}");
    }
    if let Some(quotation) = &citation.quotation {
        text += &format!(", \"{quotation}\"");
    }
    if let Some(page) = &citation.seen_at {
        text += &format!(", {page}");
    }
    if let Some(last) = &citation.in_force_until {
        text += &format!("; ended {last}");
        text += &citation.superseded_by.as_ref().map(|by| format!(", see {by}")).unwrap_or_default();
    }
    text
}

/// Returns a line for each violation of a hard rule.
pub fn broken_lines(report: &Report) -> Vec<String> {
    let violations = report.rules.iter().flat_map(|r| &r.violations);
    let given = |v: &Violation| if v.given { " (given plan)" } else { "" };
    violations.map(|v| format!("{} {}: {}{}", v.code, v.subject, v.message, given(v))).collect()
}

/// Prints what a world breaks.
pub fn print_broken(report: &Report) {
    broken_lines(report).iter().for_each(|line| eprintln!("{}: {line}", report.world));
}

/// Returns Ok for a sound world.
///
/// # Errors
/// `Unsound`, which says whether the world may be used all the same because only the plan that was brought is to blame.
pub fn judged(report: &Report) -> Result<(), Error> {
    if report.sound {
        return Ok(());
    }
    let rules: Vec<&str> = report.rules.iter().filter(|r| !r.violations.is_empty()).map(|r| r.rule.as_str()).collect();
    let (count, list) = (rules.len(), rules.join(", "));
    Err(Error::Unsound(if report.is_given() {
        format!("{} is written, but its plan as given breaks {count} hard rule(s): {list}", report.world)
    } else {
        format!("{} breaks {count} hard rule(s): {list}", report.world)
    }))
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1000.0
}

fn round(value: f64, digits: i32) -> f64 {
    let scale = 10_f64.powi(digits);
    (value * scale).round() / scale
}
