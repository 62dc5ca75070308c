//! Every hard rule is broken on purpose: a sound world breaks none, the smallest change that breaks one is reported as
//! that rule, at that subject.

#![allow(clippy::unwrap_used)] // helpers of tests are tests

mod answers;
mod building;
mod compliance;
mod furnishing;
mod openings;
mod storeys;

use std::collections::BTreeSet;
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

use d3dgen_check::check;
use d3dgen_check::rules::{RULES, STOREY_RULES};
use d3dgen_knowledge::Retrieval;
use d3dgen_model::domain::{Domain, Mount, Shape};
use d3dgen_model::floorplan::Door;
use d3dgen_model::placements::Placement;
use d3dgen_model::report::Report;
use d3dgen_model::world::World;
use d3dgen_model::{Pose, Rect, Segment};
use d3dgen_pipeline::generate::{Settings, generate_world, retrieve};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_plugins::Registry;

static REGISTRY: LazyLock<Registry> = LazyLock::new(Registry::builtin);

const PROMPTS: [&str; 4] = [
    "two-bedroom flat in the US",
    "office in Germany with an open office for 8 people, a meeting room, a kitchenette and toilets",
    "hospital in Germany with four patient rooms, an isolation room with an anteroom and a nurse station",
    "warehouse with a loading dock, an office, a break room and two transport robots with a charging station",
];

/// A sound world with what it is checked against.
struct Sample {
    world: World,
    domain: &'static Domain,
    retrieval: Retrieval,
}

impl Sample {
    fn check(&self, world: &World) -> Report {
        check(world, self.domain, &self.retrieval)
    }
}

static SAMPLES: LazyLock<Vec<Sample>> = LazyLock::new(|| {
    let sample = |prompt: &&str| {
        let request = Request { prompt: (*prompt).to_owned(), seed: 7, ..Request::default() };
        let made =
            generate_world(&request, &REGISTRY, &Settings::default(), &mut |_| {}, &AtomicBool::new(false)).unwrap();
        let plugin = REGISTRY.get(&made.world.scene_graph.domain).unwrap();
        let retrieval = retrieve(&made.world.scene_graph, plugin);
        Sample { world: made.world, domain: plugin.domain(), retrieval }
    };
    PROMPTS.iter().map(sample).collect()
});

/// A changed world and the subject of the violation it must show.
type Change = (World, String);

/// A way to break a rule.
struct Break {
    rule: &'static str,
    /// Rules that the change cannot but break as well.
    also: &'static [&'static str],
    /// True when each change breaks the rule wherever it is made; false when it depends on what stands near.
    always: bool,
    changes: fn(&Sample) -> Vec<Change>,
}

const fn always(rule: &'static str, changes: fn(&Sample) -> Vec<Change>) -> Break {
    Break { rule, also: &[], always: true, changes }
}

const fn somewhere(rule: &'static str, also: &'static [&'static str], changes: fn(&Sample) -> Vec<Change>) -> Break {
    Break { rule, also, always: false, changes }
}

fn table() -> impl Iterator<Item = &'static Break> {
    building::BREAKS.iter().chain(openings::BREAKS).chain(furnishing::BREAKS)
}

/// How many changes of one kind are checked in each world at most.
const MOST: usize = 400;
/// How many changes that always break their rule are checked in each world.
const ALWAYS_MOST: usize = 11;

/// Returns the rules that a report says are broken.
fn broken(report: &Report) -> BTreeSet<&str> {
    report.rules.iter().filter(|r| !r.violations.is_empty()).map(|r| r.rule.as_str()).collect()
}

fn names(report: &Report, rule: &str, subject: &str) -> bool {
    let found = report.rules.iter().find(|r| r.rule == rule).unwrap();
    found.violations.iter().any(|v| v.code == rule && v.subject == subject && !v.message.is_empty())
}

/// Returns what is wrong with the table's entry.
fn failure(entry: &Break) -> Option<String> {
    let (mut exact, mut tried, mut closest) = (false, 0, String::new());
    for sample in SAMPLES.iter() {
        let mut most = if entry.always { ALWAYS_MOST } else { MOST };
        for (world, subject) in (entry.changes)(sample) {
            if most == 0 || (exact && !entry.always) {
                break;
            }
            most -= 1;
            tried += 1;
            let report = sample.check(&world);
            let rules = broken(&report);
            let found = names(&report, entry.rule, &subject);
            if found && report.sound {
                return Some("a broken world is called sound".into());
            }
            if !found && entry.always {
                let rule = report.rules.iter().find(|r| r.rule == entry.rule).unwrap();
                return Some(format!("`{subject}` of {} is not reported, but {:?}", world.name, rule.violations));
            }
            exact |= found && rules.iter().all(|r| *r == entry.rule || entry.also.contains(r));
            if found || !closest.contains("found true") {
                closest = format!("{subject} in {}: found {found}, broke {rules:?}", world.name);
            }
        }
    }
    (!exact).then(|| format!("{tried} changes, none breaks this rule alone; last {closest}"))
}

#[test]
fn sound_worlds_break_no_rule() {
    for sample in SAMPLES.iter() {
        let report = sample.check(&sample.world);
        assert!(report.sound && broken(&report).is_empty(), "{}: {:?}", sample.world.name, broken(&report));
        assert_eq!(report.rules.len(), RULES.len());
    }
}

#[test]
fn each_change_is_reported_as_the_rule_it_breaks() {
    let failures: Vec<String> =
        table().filter_map(|entry| Some(format!("{}: {}", entry.rule, failure(entry)?))).collect();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn every_rule_is_broken_by_some_change() {
    let known: BTreeSet<&str> = RULES.iter().chain(STOREY_RULES).map(|r| r.id).collect();
    let covered: BTreeSet<&str> = table().map(|b| b.rule).chain(storeys::rules()).collect();
    assert_eq!(covered, known, "each rule has a change in the table that breaks it");
}

/// Returns one changed world for each of the things, where there is a change to make.
fn each<T>(
    sample: &Sample,
    things: impl Iterator<Item = T>,
    f: impl Fn(&mut World, T) -> Option<String>,
) -> Vec<Change> {
    let change = |thing| {
        let mut world = sample.world.clone();
        f(&mut world, thing).map(|subject| (world, subject))
    };
    things.filter_map(change).collect()
}

/// Returns one changed world.
fn one(sample: &Sample, f: impl Fn(&mut World) -> Option<String>) -> Vec<Change> {
    each(sample, std::iter::once(()), |world, ()| f(world))
}

/// Adds a plain thing on the floor that no furnishing line speaks of, and returns its id.
fn add_thing(world: &mut World, domain: &Domain, room_id: &str, rect: Rect, height: f64) -> Option<String> {
    let room = world.floorplan.room(room_id)?;
    let kind = domain.room_type_or_generic(&room.room_type);
    let plain = |shape| matches!(shape, Shape::Box | Shape::Plant | Shape::Cylinder | Shape::Cabinet | Shape::Trolley);
    let object = domain.objects.iter().find(|o| {
        o.mount == Mount::Floor
            && o.clearance_front_m == 0.0
            && plain(o.shape)
            && !kind.furnishing.iter().any(|f| f.item == o.id)
    })?;
    let (id, center) = ("added_thing".to_owned(), rect.center());
    world.placements.placements.push(Placement {
        placement_id: id.clone(),
        room_id: room_id.to_owned(),
        object: object.id.clone(),
        asset: String::new(),
        asset_choice: None,
        pose: Pose { x: center.x, y: center.y, z: 0.0, yaw_rad: 0.0 },
        size_m: [rect.height(), rect.width(), height],
        mount: Mount::Floor,
        support: None,
        group: None,
        rule: String::new(),
        locked: false,
    });
    Some(id)
}

/// Returns the rectangle at a door, on its side toward greater (`ahead`) or lesser coordinates: from `from` to `to` m
/// off the center line, along the wall from `start` to `end` m of the door's lesser end.
fn at_door(door: &Door, ahead: bool, (from, to): (f64, f64), (start, end): (f64, f64)) -> Rect {
    at_line(&door.line, ahead, (from, to), (start, end))
}

fn at_line(line: &Segment, ahead: bool, (from, to): (f64, f64), (start, end): (f64, f64)) -> Rect {
    let sign = if ahead { 1.0 } else { -1.0 };
    let (x, y) = (line.start.x.min(line.end.x), line.start.y.min(line.end.y));
    if line.is_vertical() {
        Rect::new(x + sign * from, y + start, x + sign * to, y + end)
    } else {
        Rect::new(x + start, y + sign * from, x + end, y + sign * to)
    }
}

/// Returns the room whose floor a point-sized rectangle lies on.
fn room_at(world: &World, rect: &Rect) -> Option<String> {
    let room = world.floorplan.rooms.iter().find(|r| r.net_polygon.contains(rect.center()))?;
    Some(room.room_id.clone())
}

fn placement<'w>(world: &'w mut World, id: &str) -> &'w mut Placement {
    world.placements.placements.iter_mut().find(|p| p.placement_id == id).unwrap()
}

/// Returns the ids of the placements that a test is true of.
fn ids(sample: &Sample, which: impl Fn(&Placement) -> bool) -> std::vec::IntoIter<String> {
    let all = sample.world.placements.placements.iter();
    all.filter(|p| which(p)).map(|p| p.placement_id.clone()).collect::<Vec<_>>().into_iter()
}
