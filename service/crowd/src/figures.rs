//! The figures of social navigation papers, from the tracks: success, length and irregularity of paths, distances kept, time to
//! collision, groups walked through, density and flow; and what became of the scenario's conditions.
//!
//! Definitions: intimate, personal and social space end 0.45, 1.2 and 3.6 m from the center of a person (Hall 1966); time to
//! collision is that of two discs that go on as they do; irregularity is the turning per meter (rad/m); somebody intrudes on a
//! group when it is within the hull of its people (Francis et al. 2025, "Principles and guidelines for evaluating social robot
//! navigation").

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::Point;
use d3dgen_model::scenario::{Condition, ConditionOp};
use d3dgen_model::trajectory::{Sample, Track, Trajectory};
use d3dgen_model::world::World;
use serde_json::{Map, Value, json};

use crate::mover::Mover;
use crate::space::Space;

/// Time between two looks, s.
const LOOK_S: f64 = 0.5;
/// Ends of intimate, personal and social space, m.
const SPACES_M: [f64; 3] = [0.45, 1.2, 3.6];
/// Time to collision that is short, s, and the longest that is looked for.
const SHORT_S: f64 = 2.0;
const LONGEST_S: f64 = 10.0;
/// Steps shorter than this turn nobody, m.
const STEP_M: f64 = 0.01;
/// Rooms and doorways that are listed.
const LISTED: usize = 12;

/// What somebody did of what it was to do.
pub struct Outcome {
    id: String,
    robot: bool,
    tasks: usize,
    done: usize,
    missed: u32,
    jobs: BTreeMap<String, bool>,
}

impl Outcome {
    pub fn of(m: &Mover) -> Self {
        let done: BTreeSet<usize> = m.done.iter().copied().collect();
        let mut jobs: BTreeMap<String, bool> = BTreeMap::new();
        for (k, task) in m.tasks.iter().enumerate() {
            if let Some(job) = &task.job {
                let whole = jobs.entry(job.clone()).or_insert(true);
                *whole &= done.contains(&k);
            }
        }
        Self { id: m.id.clone(), robot: m.robot, tasks: m.tasks.len(), done: m.done.len(), missed: m.missed, jobs }
    }
}

/// What was seen of somebody beside the others.
#[derive(Clone)]
struct Seen {
    closest: f64,
    within: [f64; 3],
    ttc: f64,
    short: f64,
    intruded: f64,
}

/// Everybody at one time.
struct Moment<'t> {
    track: &'t Track,
    robot: bool,
    here: Sample,
    velocity: Point,
    seated: bool,
}

/// Returns all figures.
pub fn measure(world: &World, spaces: &[Space], trajectory: &Trajectory, outcomes: &[Outcome], seconds: f64) -> Value {
    let tracks: Vec<(&Track, bool)> =
        trajectory.agents.iter().map(|t| (t, false)).chain(trajectory.robots.iter().map(|t| (t, true))).collect();
    let mut seen: BTreeMap<&str, Seen> = BTreeMap::new();
    let mut rooms: BTreeMap<(i32, usize), (f64, f64)> = BTreeMap::new();
    let mut visited: BTreeMap<&str, Vec<(f64, usize, i32)>> = BTreeMap::new();
    let steps = (seconds / LOOK_S) as u32;
    for k in 0..=steps {
        let t = f64::from(k) * LOOK_S;
        let now: Vec<Moment> = tracks.iter().filter_map(|(track, robot)| moment(track, *robot, t)).collect();
        look(&now, &mut seen);
        count(spaces, &now, &mut rooms, &mut visited, t);
    }
    let figures = |id: &str, track: &Track| -> Value {
        let outcome = outcomes.iter().find(|o| o.id == id);
        of_track(track, outcome, seen.get(id))
    };
    let list =
        |tracks: &[Track]| -> Map<String, Value> { tracks.iter().map(|t| (t.id.clone(), figures(&t.id, t))).collect() };
    json!({
        "format": "crowd-metrics/1",
        "world": world.name,
        "seed": trajectory.seed,
        "hour": trajectory.hour,
        "seconds": seconds,
        "people": trajectory.agents.len(),
        "robots": list(&trajectory.robots),
        "all": summary(trajectory, outcomes, &seen),
        "density": density(spaces, &rooms, steps),
        "flow": flow(spaces, &visited, seconds),
        "conditions": conditions(world, spaces, &visited, trajectory),
        "agents": list(&trajectory.agents),
    })
}

fn moment(track: &Track, robot: bool, t: f64) -> Option<Moment<'_>> {
    let here = track.at(t)?;
    let before = track.at(t - 0.2).filter(|s| s.level == here.level);
    let velocity =
        before.map_or(Point::new(0.0, 0.0), |b| Point::new((here.at.x - b.at.x) / 0.2, (here.at.y - b.at.y) / 0.2));
    let seated = track.pause_at(t).is_some_and(|kind| matches!(kind, "seat" | "bed"));
    Some(Moment { track, robot, here, velocity, seated })
}

/// Looks at everybody who is not on a seat beside all people.
fn look<'t>(now: &[Moment<'t>], seen: &mut BTreeMap<&'t str, Seen>) {
    let groups = groups(now);
    let far = SPACES_M[2].max(LONGEST_S);
    for me in now.iter().filter(|m| !m.seated) {
        let nothing = Seen { closest: f64::MAX, within: [0.0; 3], ttc: f64::MAX, short: 0.0, intruded: 0.0 };
        let entry = seen.entry(me.track.id.as_str()).or_insert(nothing);
        let (mut closest, mut ttc) = (f64::MAX, f64::MAX);
        for other in now.iter().filter(|o| !o.robot && o.track.id != me.track.id && o.here.level == me.here.level) {
            let offset = Point::new(other.here.at.x - me.here.at.x, other.here.at.y - me.here.at.y);
            if offset.x.abs() > far || offset.y.abs() > far {
                continue;
            }
            closest = closest.min(offset.x.hypot(offset.y));
            ttc = ttc.min(time_to_collision(me, other, offset));
        }
        entry.closest = entry.closest.min(closest);
        entry.ttc = entry.ttc.min(ttc);
        if let Some(zone) = SPACES_M.iter().position(|end| closest < *end) {
            entry.within[zone] += LOOK_S;
        }
        if ttc < SHORT_S {
            entry.short += LOOK_S;
        }
        let own = me.track.group.as_deref();
        let inside = groups
            .iter()
            .any(|(name, level, hull)| Some(*name) != own && *level == me.here.level && is_within(hull, me.here.at));
        if inside {
            entry.intruded += LOOK_S;
        }
    }
}

fn time_to_collision(me: &Moment, other: &Moment, offset: Point) -> f64 {
    let (vx, vy) = (me.velocity.x - other.velocity.x, me.velocity.y - other.velocity.y);
    let near = offset.x * vx + offset.y * vy;
    let a = vx * vx + vy * vy;
    let c = offset.x * offset.x + offset.y * offset.y - (me.track.radius + other.track.radius).powi(2);
    let disc = near * near - a * c;
    if near <= 0.0 || disc < 0.0 || a < 1e-6 || c <= 0.0 {
        return f64::MAX;
    }
    (near - disc.sqrt()) / a
}

/// Returns the hulls of groups of which two people or more are on one storey.
fn groups<'t>(now: &[Moment<'t>]) -> Vec<(&'t str, i32, Vec<Point>)> {
    let mut by: BTreeMap<(&str, i32), Vec<Point>> = BTreeMap::new();
    for m in now {
        if let Some(group) = &m.track.group {
            by.entry((group.as_str(), m.here.level)).or_default().push(m.here.at);
        }
    }
    by.into_iter().filter(|(_, p)| p.len() > 1).map(|((name, level), p)| (name, level, p)).collect()
}

/// Returns true for a point within a tenth of a meter of a line between two of some points, or among three of them.
fn is_within(points: &[Point], p: Point) -> bool {
    let turn = |a: Point, b: Point, c: Point| (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    let near = |a: Point, b: Point| {
        let length = a.distance(b).max(1e-9);
        let along = ((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / length;
        (0.0..=length).contains(&along) && (turn(a, b, p) / length).abs() < 0.1
    };
    for (i, &a) in points.iter().enumerate() {
        for (j, &b) in points.iter().enumerate().skip(i + 1) {
            if near(a, b) {
                return true;
            }
            for &c in &points[j + 1..] {
                let signs = [turn(a, b, p), turn(b, c, p), turn(c, a, p)];
                if signs.iter().all(|s| *s > 0.0) || signs.iter().all(|s| *s < 0.0) {
                    return true;
                }
            }
        }
    }
    false
}

/// Counts who is in which room.
fn count<'t>(
    spaces: &[Space],
    now: &[Moment<'t>],
    rooms: &mut BTreeMap<(i32, usize), (f64, f64)>,
    visited: &mut BTreeMap<&'t str, Vec<(f64, usize, i32)>>,
    t: f64,
) {
    let mut here: BTreeMap<(i32, usize), f64> = BTreeMap::new();
    for m in now {
        let Some(space) = spaces.iter().find(|s| s.level == m.here.level) else { continue };
        let Some(room) = space.room_at(m.here.at) else { continue };
        if !m.robot {
            *here.entry((space.level, room)).or_default() += 1.0;
        }
        let list = visited.entry(m.track.id.as_str()).or_default();
        if list.last().is_none_or(|(_, r, l)| (*r, *l) != (room, space.level)) {
            list.push((t, room, space.level));
        }
    }
    for (room, n) in here {
        let entry = rooms.entry(room).or_default();
        entry.0 += n;
        entry.1 = entry.1.max(n);
    }
}

fn of_track(track: &Track, outcome: Option<&Outcome>, seen: Option<&Seen>) -> Value {
    let (length, turned) = path(track);
    let mut out = json!({
        "role": track.role,
        "success": outcome.is_some_and(|o| o.missed == 0 && (!o.robot || o.jobs.values().all(|whole| *whole))),
        "tasks": outcome.map_or(0, |o| o.tasks),
        "tasks_done": outcome.map_or(0, |o| o.done),
        "tasks_missed": outcome.map_or(0, |o| o.missed),
        "path_length_m": round(length),
        "path_irregularity_rad_m": if length > 0.5 { round(turned / length) } else { 0.0 },
    });
    if let Some(jobs) = outcome.filter(|o| o.robot).map(|o| &o.jobs) {
        out["jobs_done"] = json!(jobs);
    }
    if let Some(seen) = seen {
        out["closest_person_m"] = finite(seen.closest);
        out["time_in_intimate_space_s"] = json!(seen.within[0]);
        out["time_in_personal_space_s"] = json!(seen.within[1]);
        out["time_in_social_space_s"] = json!(seen.within[2]);
        out["min_ttc_s"] = finite(seen.ttc);
        out["time_ttc_below_2s"] = json!(seen.short);
        out["time_in_groups_s"] = json!(seen.intruded);
    }
    out
}

fn round(v: f64) -> f64 {
    (v * 1000.0).round() / 1000.0
}

fn finite(v: f64) -> Value {
    if v < 1e6 { json!(round(v)) } else { Value::Null }
}

/// Returns the length of a path, m, and by how much it turns, rad.
fn path(track: &Track) -> (f64, f64) {
    let (mut length, mut turned, mut last): (f64, f64, Option<f64>) = (0.0, 0.0, None);
    for pair in track.samples.windows(2).filter(|w| w[0].level == w[1].level) {
        let (dx, dy) = (pair[1].at.x - pair[0].at.x, pair[1].at.y - pair[0].at.y);
        let step = dx.hypot(dy);
        length += step;
        if step > STEP_M {
            let heading = dy.atan2(dx);
            if let Some(before) = last {
                let mut by = heading - before;
                by -= std::f64::consts::TAU * (by / std::f64::consts::TAU).round();
                turned += by.abs();
            }
            last = Some(heading);
        }
    }
    (length, turned)
}

fn summary(trajectory: &Trajectory, outcomes: &[Outcome], seen: &BTreeMap<&str, Seen>) -> Value {
    let people: Vec<&Outcome> = outcomes.iter().filter(|o| !o.robot).collect();
    let lengths: f64 = trajectory.agents.iter().map(|t| path(t).0).sum();
    json!({
        "tasks_done": people.iter().map(|o| o.done).sum::<usize>(),
        "tasks_missed": people.iter().map(|o| o.missed).sum::<u32>(),
        "path_length_m": round(lengths),
        "closest_m": finite(seen.values().map(|s| s.closest).fold(f64::MAX, f64::min)),
        "time_in_intimate_space_s": seen.values().map(|s| s.within[0]).sum::<f64>(),
        "min_ttc_s": finite(seen.values().map(|s| s.ttc).fold(f64::MAX, f64::min)),
    })
}

/// Returns the rooms with most people on their floor.
fn density(spaces: &[Space], rooms: &BTreeMap<(i32, usize), (f64, f64)>, steps: u32) -> Value {
    let mut all: Vec<(f64, Value)> = rooms
        .iter()
        .filter_map(|((level, room), (sum, most))| {
            let space = spaces.iter().find(|s| s.level == *level)?;
            let area = space.outlines[*room].area().max(0.01);
            let mean = sum / f64::from(steps + 1) / area;
            let entry =
                json!({"room_id": space.rooms[*room], "mean_per_m2": round(mean), "most_per_m2": round(most / area)});
            Some((most / area, entry))
        })
        .collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all.into_iter().take(LISTED).map(|(_, v)| v).collect()
}

/// Returns the pairs of rooms between which most go, both ways.
fn flow(spaces: &[Space], visited: &BTreeMap<&str, Vec<(f64, usize, i32)>>, seconds: f64) -> Value {
    let mut pairs: BTreeMap<(i32, usize, usize), u32> = BTreeMap::new();
    for list in visited.values() {
        for w in list.windows(2).filter(|w| w[0].2 == w[1].2) {
            *pairs.entry((w[0].2, w[0].1.min(w[1].1), w[0].1.max(w[1].1))).or_default() += 1;
        }
    }
    let mut all: Vec<((i32, usize, usize), u32)> = pairs.into_iter().collect();
    all.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    let entry = |((level, a, b), n): ((i32, usize, usize), u32)| {
        let space = spaces.iter().find(|s| s.level == level)?;
        Some(json!({"between": [space.rooms[a], space.rooms[b]], "per_min": round(f64::from(n) * 60.0 / seconds)}))
    };
    all.into_iter().take(LISTED).filter_map(entry).collect()
}

/// Returns which conditions hold.
fn conditions(
    world: &World,
    spaces: &[Space],
    visited: &BTreeMap<&str, Vec<(f64, usize, i32)>>,
    trajectory: &Trajectory,
) -> Value {
    let roles: BTreeMap<&str, &str> =
        trajectory.agents.iter().chain(&trajectory.robots).map(|t| (t.id.as_str(), t.role.as_str())).collect();
    let first = |subject: &str, room: &str| -> Option<f64> {
        let subjects = visited.iter().filter(|(id, _)| **id == subject || roles.get(*id) == Some(&subject));
        let inside = |(_, room_index, level): &&(f64, usize, i32)| {
            spaces.iter().any(|s| s.level == *level && s.rooms[*room_index] == room)
        };
        subjects.filter_map(|(_, list)| list.iter().find(inside).map(|(t, ..)| *t)).min_by(f64::total_cmp)
    };
    let holds = |c: &Condition| -> bool {
        let at = first(&c.subject, &c.room_id);
        match c.op {
            ConditionOp::Eventually => at.is_some(),
            ConditionOp::Never => at.is_none(),
            ConditionOp::Before => {
                let then = c.then_room_id.as_ref().and_then(|room| first(&c.subject, room));
                then.is_none_or(|then| at.is_some_and(|at| at <= then))
            }
        }
    };
    let entry = |c: &Condition| json!({"condition_id": c.condition_id, "text": c.text, "holds": holds(c)});
    world.scenario.conditions.iter().map(entry).collect()
}
