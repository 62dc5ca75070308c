//! Scores the prompt reader: prompts with the facts a sensible person reads in them, and texts that make no sense.
//!
//! The sets in `prompts/` belong to this repository: `own.jsonl`, `odd.jsonl` (in keywords, with numbers of many things),
//! `audit.jsonl`, `spelling.jsonl`, `relations.jsonl` and `rules.jsonl` (adjacency rules of one country asked for in another). One more in the
//! same form is scored where it lies beside the workspace. Room counts are minima, `n_rooms` counts rooms other than
//! circulation, adjacency means any edge.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use d3dgen_model::document::Document;
use d3dgen_model::scene_graph::{Connector, GraphEdge, GraphRoom, SceneGraph};
use d3dgen_pipeline::Error;
use d3dgen_pipeline::scene_graph::{Request, generate};
use d3dgen_plugins::Registry;
use serde::Deserialize;

/// Domains that the prompts call by name; every other one is `other`.
const NAMED_DOMAINS: [&str; 3] = ["residential", "office", "hospital"];
/// Room type of a charging place.
const CHARGING: &str = "robot_charging";

/// A prompt and what it says; fields that a set leaves out are not scored.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Case {
    id: String,
    prompt: String,
    domain: String,
    /// Further domains that are right too.
    alt_domains: Vec<String>,
    country_code: Option<String>,
    n_rooms: Option<usize>,
    must_rooms: BTreeMap<String, usize>,
    adjacency: Vec<[String; 2]>,
    not_adjacent: Vec<[String; 2]>,
    /// Pairs that are to be joined by an opening.
    open: Vec<[String; 2]>,
    forbidden_rooms: Vec<String>,
    /// Robot kinds, and `charging`.
    robot: Vec<String>,
    robot_radius_m: Option<f64>,
    area_m2: Option<f64>,
    staff: Option<u32>,
    beds: Option<u32>,
    desks: Option<u32>,
    accessible: bool,
    reject: bool,
    clarify: bool,
    /// Objects that some room is to have.
    things: Vec<String>,
    /// Robots by kind, exactly.
    robots: Option<BTreeMap<String, u32>>,
    /// How many rooms of a type there are, exactly.
    rooms: BTreeMap<String, usize>,
    /// Types of rooms that robots stay out of.
    keep_out: Vec<String>,
    /// The highest speed of robots in rooms of a type, m/s.
    speeds: BTreeMap<String, f64>,
    /// Storeys in all.
    storeys: Option<usize>,
    /// The storey that all rooms of a type are on.
    levels: BTreeMap<String, i32>,
    /// Types of rooms that are to have a dock.
    docks: Vec<String>,
    building_type: Option<String>,
    /// Pairs of room types of which there are equally many.
    same: Vec<[String; 2]>,
    /// People, beds or seats of every room of a type.
    occupants: BTreeMap<String, u32>,
    /// Whether the corridors are to be wide enough for robots that pass each other.
    two_way: bool,
    /// Codes of conflicts that are to be there.
    has_conflicts: Vec<String>,
    /// Codes of assumptions that are to be there.
    has_assumptions: Vec<String>,
    /// Codes of conflicts that the prompt does not have.
    no_conflicts: Vec<String>,
    /// Codes of assumptions that it does not have.
    no_assumptions: Vec<String>,
    /// What conflicts or assumptions are to tell.
    told: Vec<String>,
    tags: Vec<String>,
}

/// What was got wrong, one line a fact.
struct Misses(Vec<String>);

impl Misses {
    fn check<T: std::fmt::Debug>(&mut self, right: bool, fact: &str, expected: T, got: impl std::fmt::Debug) {
        if !right {
            self.0.push(format!("{fact}: expected {expected:?}, got {got:?}"));
        }
    }
}

fn request(prompt: &str) -> Request {
    Request { prompt: prompt.into(), ..Request::default() }
}

fn misses(case: &Case, registry: &Registry) -> Vec<String> {
    let mut misses = Misses(Vec::new());
    match (d3dgen_pipeline::brief::rooms(&request(&case.prompt), registry).map(|r| r.0), case.reject) {
        (Err(Error::Refused { .. }), true) => {}
        (Ok(graph), true) => misses.check(false, "refusal", "a refusal", format!("{} rooms", graph.rooms.len())),
        (Err(error), _) => misses.check(false, "result", "a scene graph", error.to_string()),
        (Ok(graph), false) => {
            let problems = graph.check();
            misses.check(problems.is_empty(), "document", "no problem", &problems);
            check_facts(case, &graph, &mut misses);
            check_rooms(case, &graph, &mut misses);
            check_robots(case, &graph, &mut misses);
        }
    }
    misses.0
}

fn check_facts(case: &Case, graph: &SceneGraph, misses: &mut Misses) {
    let domain = if NAMED_DOMAINS.contains(&graph.domain.as_str()) { graph.domain.as_str() } else { "other" };
    let underspecified = case.tags.iter().any(|t| t == "underspecified") && case.must_rooms.is_empty() && case.clarify;
    let right = domain == case.domain || case.alt_domains.iter().any(|d| d == domain);
    misses.check(right || underspecified, "domain", &case.domain, &graph.domain);
    misses.check(graph.country_code == case.country_code, "country", &case.country_code, &graph.country_code);
    if let Some(area) = case.area_m2 {
        let right = graph.area_m2.is_some_and(|got| (got - area).abs() <= 0.02 * area);
        misses.check(right, "area", area, graph.area_m2);
    }
    let heads = &graph.occupancy;
    for (fact, expected, got) in
        [("staff", case.staff, heads.staff), ("beds", case.beds, heads.beds), ("desks", case.desks, heads.desks)]
    {
        misses.check(expected.is_none() || expected == got, fact, expected, got);
    }
    misses.check(!case.accessible || graph.accessible, "accessible", true, graph.accessible);
    for thing in &case.things {
        let right = graph.rooms.iter().any(|r| r.wished_assets.contains(thing));
        misses.check(right, "things", thing, graph.rooms.iter().map(|r| &r.wished_assets).collect::<Vec<_>>());
    }
    let false_ones: Vec<_> = graph.conflicts.iter().filter(|c| case.no_conflicts.contains(&c.code)).collect();
    misses.check(false_ones.is_empty(), "no_conflicts", &case.no_conflicts, &false_ones);
    let false_ones: Vec<_> = graph.assumptions.iter().filter(|c| case.no_assumptions.contains(&c.code)).collect();
    misses.check(false_ones.is_empty(), "no_assumptions", &case.no_assumptions, &false_ones);
    for words in &case.told {
        let all = || graph.conflicts.iter().chain(&graph.assumptions).map(|n| &n.message);
        misses.check(all().any(|m| m.contains(words)), "told", words, all().collect::<Vec<_>>());
    }
    for (fact, codes, notes) in [
        ("conflicts", &case.has_conflicts, &graph.conflicts),
        ("assumptions", &case.has_assumptions, &graph.assumptions),
    ] {
        for code in codes {
            misses.check(notes.iter().any(|n| &n.code == code), fact, code, notes);
        }
    }
    let kind = &case.building_type;
    misses.check(kind.is_none() || kind == &graph.building_type, "building type", kind, &graph.building_type);
    let stated = !graph.conflicts.is_empty() || !graph.assumptions.is_empty();
    misses.check(!case.clarify || stated, "clarify", "a conflict or an assumption", "none");
}

fn check_rooms(case: &Case, graph: &SceneGraph, misses: &mut Misses) {
    let counted: Vec<&str> = graph.rooms.iter().filter(|r| !r.circulation).map(|r| r.room_type.as_str()).collect();
    // toilets that no building is without come to those that a list names
    let vital =
        |r: &GraphRoom| !r.requested && r.room_type.ends_with("toilet") && !case.rooms.contains_key(&r.room_type);
    let beyond = graph.rooms.iter().filter(|r| !r.circulation && vital(r)).count();
    if let Some(n) = case.n_rooms {
        let kept = counted.len() == n || counted.len() == n + beyond;
        misses.check(kept, "n_rooms", n, (counted.len(), &counted));
    }
    for (room_type, least) in &case.must_rooms {
        let n = graph.rooms.iter().filter(|r| r.room_type == *room_type || means(graph, room_type, r)).count();
        misses.check(n >= *least, "must_rooms", (room_type, least), (n, &counted));
    }
    let of_type = |id: &str| graph.rooms.iter().filter(|r| r.room_type == id).collect::<Vec<_>>();
    for (room_type, n) in &case.rooms {
        misses.check(of_type(room_type).len() == *n, "rooms", (room_type, n), &counted);
    }
    for [a, b] in &case.same {
        misses.check(of_type(a).len() == of_type(b).len(), "same", (a, b), &counted);
    }
    for (room_type, n) in &case.occupants {
        let held: Vec<Option<u32>> = of_type(room_type).iter().map(|r| r.occupants).collect();
        let right = !held.is_empty() && held.iter().all(|h| *h == Some(*n));
        misses.check(right, "occupants", (room_type, n), &held);
    }
    for (room_type, level) in &case.levels {
        let levels: Vec<i32> = of_type(room_type).iter().map(|r| r.level).collect();
        misses.check(!levels.is_empty() && levels.iter().all(|l| l == level), "levels", (room_type, level), &levels);
    }
    if let Some(storeys) = case.storeys {
        misses.check(graph.level_numbers().len() == storeys, "storeys", storeys, graph.level_numbers());
    }
    for room_type in &case.docks {
        let docked = of_type(room_type).iter().any(|r| r.wished_assets.iter().any(|a| a.contains("dock")));
        misses.check(docked, "docks", room_type, graph.rooms.iter().map(|r| &r.wished_assets).collect::<Vec<_>>());
    }
    for room_type in &case.forbidden_rooms {
        misses.check(!counted.contains(&room_type.as_str()), "forbidden_rooms", room_type, &counted);
    }
    let edges = || -> Vec<String> {
        graph.edges.iter().filter(|e| e.reason != "circulation").map(|e| format!("{}-{}", e.a, e.b)).collect()
    };
    for pair in &case.adjacency {
        misses.check(has_edge(graph, pair), "adjacency", pair, edges());
    }
    for [a, b] in &case.open {
        let between =
            |e: &GraphEdge| is(graph, &e.a, a) && is(graph, &e.b, b) || is(graph, &e.a, b) && is(graph, &e.b, a);
        let open = graph.edges.iter().any(|e| e.connector == Connector::Open && e.required && between(e));
        misses.check(open, "open", (a, b), edges());
    }
    for pair in &case.not_adjacent {
        let listed = graph.apart.iter().any(|[x, y]| {
            is(graph, x, &pair[0]) && is(graph, y, &pair[1]) || is(graph, x, &pair[1]) && is(graph, y, &pair[0])
        });
        misses.check(listed && !has_edge(graph, pair), "not_adjacent", pair, &graph.apart);
    }
}

fn is(graph: &SceneGraph, id: &str, room_type: &str) -> bool {
    let right =
        |r: &GraphRoom| r.room_type == room_type || room_type == "entrance" && r.entrance || means(graph, room_type, r);
    graph.room(id).is_some_and(right)
}

/// Returns true for a room that is what this building means by words for rooms of a type: the dental rooms of a dental
/// practice are its treatment rooms.
fn means(graph: &SceneGraph, room_type: &str, room: &GraphRoom) -> bool {
    static REGISTRY: LazyLock<Registry> = LazyLock::new(Registry::builtin);
    let Some(domain) = REGISTRY.get(&graph.domain).map(|p| p.domain()) else { return false };
    let building = domain.building_types.iter().find(|b| Some(&b.id) == graph.building_type.as_ref());
    let program = building.and_then(|b| domain.program(&b.program));
    program.and_then(|p| p.means.get(room_type)).is_some_and(|id| *id == room.room_type)
}

/// Returns true when some edge joins the two room types; to the entrance, being it is close enough.
fn has_edge(graph: &SceneGraph, [a, b]: &[String; 2]) -> bool {
    let at_entrance =
        |kind: &str, other: &str| other == "entrance" && graph.rooms.iter().any(|r| r.entrance && r.room_type == kind);
    at_entrance(a, b)
        || at_entrance(b, a)
        || graph
            .edges
            .iter()
            .any(|e| is(graph, &e.a, a) && is(graph, &e.b, b) || is(graph, &e.a, b) && is(graph, &e.b, a))
}

fn check_robots(case: &Case, graph: &SceneGraph, misses: &mut Misses) {
    for kind in &case.robot {
        let right = match kind.as_str() {
            "charging" => {
                graph.robots.iter().any(|r| r.charging) || graph.rooms.iter().any(|r| r.room_type == CHARGING)
            }
            kind => graph.robots.iter().any(|r| r.kind == kind),
        };
        misses.check(right, "robot", kind, &graph.robots);
    }
    if let Some(robots) = &case.robots {
        let got: BTreeMap<String, u32> = graph.robots.iter().map(|r| (r.kind.clone(), r.count)).collect();
        misses.check(&got == robots, "robots", robots, &got);
    }
    let of_type = |id: &str| graph.rooms.iter().filter(|r| r.room_type == id).collect::<Vec<_>>();
    for room_type in &case.keep_out {
        let rooms = of_type(room_type);
        let right = !rooms.is_empty() && rooms.iter().all(|r| graph.keeps_robots_out(&r.id));
        misses.check(right, "keep out", room_type, &graph.robot_rules);
    }
    for (room_type, speed) in &case.speeds {
        let rooms = of_type(room_type);
        let right = !rooms.is_empty() && rooms.iter().all(|r| graph.robot_speed_m_s(&r.id) == Some(*speed));
        misses.check(right, "speed", (room_type, speed), &graph.robot_rules);
    }
    misses.check(graph.two_way == case.two_way, "two-way", case.two_way, graph.two_way);
    if let Some(radius) = case.robot_radius_m {
        let right = graph.robots.iter().any(|r| (r.radius_m - radius).abs() < 1e-6);
        misses.check(right, "robot radius", radius, &graph.robots);
    }
}

/// Scores a set; returns how many are right and how many there are, and prints the rest.
fn score(path: &Path) -> (usize, usize) {
    let registry = Registry::builtin();
    let text = std::fs::read_to_string(path).expect("the caller looked for the file");
    let cases: Vec<Case> =
        text.lines().map(|line| serde_json::from_str(line).expect("a line of the set is a case")).collect();
    let mut right = 0;
    for case in &cases {
        let misses = misses(case, &registry);
        right += usize::from(misses.is_empty());
        if !misses.is_empty() {
            println!("{} {:?}", case.id, case.prompt);
            misses.iter().for_each(|miss| println!("    {miss}"));
        }
    }
    println!("{right} of {} prompts right in {}", cases.len(), path.display());
    (right, cases.len())
}

#[test]
fn reads_our_own_prompts() {
    let (right, all) = score(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/prompts/own.jsonl"));
    assert!(all >= 70, "{all} prompts");
    assert!(right * 100 >= all * 95, "{right} of {all}");
}

#[test]
fn reads_odd_prompts() {
    let (right, all) = score(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/prompts/odd.jsonl"));
    assert!(all >= 60, "{all} prompts");
    assert_eq!(right, all);
}

#[test]
fn reads_what_an_audit_found() {
    let (right, all) = score(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/prompts/audit.jsonl"));
    assert!(all >= 80, "{all} prompts");
    assert_eq!(right, all);
}

#[test]
fn reads_misspelled_prompts() {
    let (right, all) = score(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/prompts/spelling.jsonl"));
    assert!(all >= 12, "{all} prompts");
    assert_eq!(right, all);
}

#[test]
fn reads_counts_and_groups() {
    let (right, all) = score(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/prompts/counts.jsonl"));
    assert!(all >= 80, "{all} prompts");
    assert_eq!(right, all);
}

/// In languages that only the brief is read in, and where it keeps more of a prompt than the words that were read.
#[test]
fn reads_prompts_of_which_the_rooms_come_from_the_brief() {
    let (right, all) = score(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/prompts/briefed.jsonl"));
    assert!(all >= 30, "{all} prompts");
    assert_eq!(right, all);
}

#[test]
fn reads_how_rooms_lie_to_each_other() {
    let (right, all) = score(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/prompts/relations.jsonl"));
    assert!(all >= 45, "{all} prompts");
    assert_eq!(right, all);
}

#[test]
fn keeps_to_the_rules_of_the_country_alone() {
    let (right, all) = score(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/prompts/rules.jsonl"));
    assert!(all >= 6, "{all} prompts");
    assert_eq!(right, all);
}

#[test]
fn a_rule_that_forbids_a_door_is_named_with_its_source() {
    let prompt = "House in Texas with a garage, kitchen, living room, bathroom and one bedroom; the garage has a door to the bedroom";
    let graph = generate(&request(prompt), &Registry::builtin()).unwrap();
    let told = graph.conflicts.iter().find(|n| n.code == "forbidden_adjacency").expect("the rule forbids the door");
    assert!(told.message.ends_with("(IRC R302.5.1)"), "{}", told.message);
}

#[test]
fn reads_the_open_prompts_where_they_are() {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/llm/prompts_open.jsonl");
    if !path.is_file() {
        println!("skipped: {} is not there", path.display());
        return;
    }
    let (right, all) = score(&path);
    assert_eq!(right, all);
}

/// Bytes that look random, the same on every run.
fn noise(seed: u64, length: usize, letters: &[char]) -> String {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    (0..length).map(|_| letters[next() % letters.len()]).collect()
}

#[test]
fn nonsense_gives_an_answer_and_soon() {
    let registry = Registry::builtin();
    let letters: Vec<char> = "abc xyz,.:-/&'\"0123456789 m2 ½²³ äöüß éè ñ 室厅卫三两个间 방개실한두 🏠🤖 \t\n\r\0\u{7f}\u{200d}\u{202e}\u{feff}\u{301}"
        .chars()
        .collect();
    let words = ["two ", "bedrooms ", "next to ", "the ", "kitchen, ", "no ", "-", "7 ", "each with ", "and ", ". "];
    let mut texts: Vec<String> = (0..200).map(|seed| noise(seed, 10 + 3 * seed as usize, &letters)).collect();
    texts.extend((0..60).map(|seed| {
        let picks = noise(seed, 12, &['0', '1', '2', '3', '4', '5', '6', '7', '8', '9', ':']);
        picks.bytes().map(|b| words[usize::from(b - b'0')]).collect::<String>()
    }));
    let long = 100_000;
    texts.extend([
        "office ".repeat(long / 7),
        "a".repeat(long),
        "zzq ".repeat(long / 4),
        "9".repeat(long),
        "两".repeat(long / 3),
        "방".repeat(long / 3),
        "two bedrooms next to the kitchen and ".repeat(long / 37),
        noise(7, long, &letters),
        "🏠🤖🛏️".repeat(long / 15),
        "\u{0}\u{1}\u{2}\u{1b}[31m".into(),
        "1 2 3 4 5 6 7 8 9 10".into(),
        "99999999999999999999999999 bedrooms".into(),
        "3e999 rooms, 1e-9 m2, NaN desks, 0 staff".into(),
        "m2 m2 m2 sq ft".into(),
        "robot robot radius 0 m radius 1e9 km".into(),
    ]);
    let mut slowest = Duration::ZERO;
    for text in &texts {
        let start = Instant::now();
        let result = generate(&request(text), &registry);
        let took = start.elapsed();
        let head: String = text.chars().take(60).collect();
        if took > slowest {
            slowest = took;
            println!("{took:?} for {} bytes: {head:?}", text.len());
        }
        assert!(took < Duration::from_secs(5), "{head:?} took {took:?}");
        match result {
            Ok(graph) => assert_eq!(graph.check().len(), 0, "{head:?}: {:?}", graph.check()),
            Err(Error::Refused { message, .. }) => assert!(message.len() > 20, "{head:?}: {message}"),
            Err(other) => panic!("{head:?}: {other}"),
        }
    }
}
