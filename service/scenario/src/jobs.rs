//! What robots do: the tasks that the brief gives them, else the usual work of their kind at the points that they visit.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use d3dgen_model::Point;
use d3dgen_model::brief::{Ask, AskedTask, Brief, Fact, RobotsAsk, Subject};
use d3dgen_model::domain::{Domain, Goods};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::offer;
use d3dgen_model::robot_kind::{brings, charge_s, cleans};
use d3dgen_model::scenario::{Poi, RobotJob, RobotJobKind, RobotTask, RoiKind, Scenario};
use serde::Deserialize;

use super::people::{PeopleBuilding, PeopleRoom};

/// Corners of a way over a floor at most, over all rooms: a scenario is read by people too.
const MOST_CORNERS: usize = 6000;
/// Share of a charge that a job plans with: the rest is for detours, the way from and to the dock, and age.
const PLANNED_CHARGE: f64 = 0.5;
/// How much of the last lane the next one covers again, as a share of the robot's width.
const OVERLAP: f64 = 0.1;

/// A kind of work, from `data/jobs.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Work {
    kind: RobotJobKind,
    /// Verbs of briefs that mean it.
    verbs: Vec<String>,
    /// Kinds of robots that do it where nothing is said.
    robots: Vec<String>,
    /// Time at each stop, s.
    seconds: f64,
    /// Mass of what is carried where nothing is said, kg.
    #[serde(default)]
    load_kg: f64,
}

static WORKS: LazyLock<Vec<Work>> = LazyLock::new(|| {
    let mut read: BTreeMap<String, Vec<Work>> =
        toml::from_str(include_str!("../data/jobs.toml")).expect("a test reads jobs.toml");
    read.remove("jobs").unwrap_or_default()
});

/// Returns the work that is meant by a verb, or that robots of a kind usually do.
fn work(of: impl Fn(&Work) -> bool) -> Option<&'static Work> {
    WORKS.iter().find(|w| of(w))
}

fn usual(kind: &str) -> &'static Work {
    let own = work(|w| w.robots.iter().any(|k| k == kind));
    own.or_else(|| work(|w| w.kind == if brings(kind) { RobotJobKind::Deliver } else { RobotJobKind::Patrol }))
        .expect("a test reads these kinds of work")
}

/// Adds the jobs of all robots.
pub(crate) fn add(scenario: &mut Scenario, building: &PeopleBuilding, brief: Option<&Brief>) {
    let asks: Vec<(&Ask, &RobotsAsk)> = brief.iter().flat_map(|b| &b.asks).filter_map(robots_of).collect();
    let mut robots = std::mem::take(&mut scenario.robots);
    let mut turns: BTreeMap<String, usize> = BTreeMap::new();
    for task in &mut robots {
        let own: Vec<&(&Ask, &RobotsAsk)> =
            asks.iter().filter(|(_, r)| r.kind == task.robot.kind && !r.tasks.is_empty()).collect();
        let turn = turns.entry(task.robot.kind.clone()).or_default();
        let ask = own.get(*turn % own.len().max(1)).copied();
        *turn += 1;
        let mut jobs: Vec<RobotJob> = Vec::new();
        for (asked, ask_id) in ask.iter().flat_map(|(ask, robots)| robots.tasks.iter().map(|t| (t, &ask.id))) {
            jobs.extend(asked_job(scenario, building, task, asked, ask_id));
        }
        if jobs.is_empty() {
            jobs.extend(usual_job(scenario, building, task));
        }
        let place = |id: &str| scenario.pois.iter().find(|p| p.poi_id == id).map(|p| Point::new(p.pose.x, p.pose.y));
        let mut jobs: Vec<RobotJob> = jobs.iter().flat_map(|job| charges(&task.robot.kind, job, place)).collect();
        let mut count: BTreeMap<&str, u32> = BTreeMap::new();
        for job in &mut jobs {
            let n = count.entry(job.kind.name()).or_default();
            *n += 1;
            job.job_id = format!("{}_{n}", job.kind.name());
        }
        task.jobs = jobs;
    }
    scenario.robots = robots;
}

/// Returns a job as so many jobs as it takes charges of the battery of a robot of this kind.
fn charges(kind: &str, job: &RobotJob, place: impl Fn(&str) -> Option<Point>) -> Vec<RobotJob> {
    let needed = (job.least_seconds(place) / (PLANNED_CHARGE * charge_s(kind))).ceil().max(1.0) as usize;
    let a_charge = |items: usize| items.div_ceil(needed).max(1);
    if job.path.is_empty() {
        job.to.chunks(a_charge(job.to.len())).map(|to| RobotJob { to: to.to_vec(), ..job.clone() }).collect()
    } else {
        let part = |path: &[Point]| RobotJob { path: path.to_vec(), ..job.clone() };
        job.path.chunks(a_charge(job.path.len())).map(part).collect()
    }
}

fn robots_of(ask: &Ask) -> Option<(&Ask, &RobotsAsk)> {
    match &ask.fact {
        Fact::Robots(robots) => Some((ask, robots)),
        _ => None,
    }
}

/// Returns the points that a robot visits at a place that a brief names: in rooms of that type or name, in those that have such
/// objects, at the entrance.
fn points_in(scenario: &Scenario, building: &PeopleBuilding, task: &RobotTask, subject: &Subject) -> Vec<String> {
    let entrance = subject.id.as_deref() == Some(Poi::ENTRANCE);
    let there = |p: &Poi| {
        let room = building.rooms.iter().find(|r| r.plan.room_id == p.room_id);
        entrance && p.kind == Poi::ENTRANCE || room.is_some_and(|r| is_meant(building.domain, r, subject))
    };
    let poi = |id: &&String| scenario.pois.iter().find(|p| &p.poi_id == *id);
    task.goals.iter().filter(|id| poi(id).is_some_and(there)).cloned().collect()
}

/// Returns true for a room that a name of the brief means.
fn is_meant(domain: &Domain, room: &PeopleRoom, subject: &Subject) -> bool {
    let kind = room.kind;
    let Some(id) = subject.id.as_deref() else {
        return room.plan.name.to_lowercase().contains(&subject.name.to_lowercase());
    };
    let object = domain.object(id).filter(|_| domain.room_type(id).is_none());
    kind.id == id || object.is_some_and(|o| offer::has_shape(domain, kind, &[o.shape]))
}

fn asked_job(
    scenario: &Scenario,
    building: &PeopleBuilding,
    task: &RobotTask,
    asked: &AskedTask,
    ask_id: &str,
) -> Option<RobotJob> {
    let verb = asked.verb.to_lowercase();
    let work = work(|w| w.verbs.contains(&verb)).unwrap_or_else(|| usual(&task.robot.kind));
    let from = asked.from.as_ref().and_then(|s| points_in(scenario, building, task, s).into_iter().next());
    let mut to: Vec<String> = asked.to.iter().flat_map(|s| points_in(scenario, building, task, s)).collect();
    // where no place is named its work is everywhere; a place that is named and not there is none elsewhere
    if asked.to.is_empty() {
        to = task.goals.iter().filter(|id| Some(*id) != from.as_ref()).cloned().collect();
    }
    let job = job(scenario, building, task, work, from, to)?;
    Some(RobotJob { what: asked.what.clone().unwrap_or_default(), ask_id: Some(ask_id.to_owned()), ..job })
}

fn usual_job(scenario: &Scenario, building: &PeopleBuilding, task: &RobotTask) -> Option<RobotJob> {
    let work = usual(&task.robot.kind);
    let clean = |id: &&String| {
        let room = scenario.pois.iter().find(|p| &p.poi_id == *id).map(|p| p.room_id.as_str());
        building.rooms.iter().any(|r| Some(r.plan.room_id.as_str()) == room && r.kind.goods == Goods::Clean)
    };
    let loads = work.kind == RobotJobKind::Deliver && task.goals.len() > 1;
    let from = if loads { task.goals.iter().find(clean).or(task.goals.first()).cloned() } else { None };
    let to = task.goals.iter().filter(|id| Some(*id) != from.as_ref()).cloned().collect();
    job(scenario, building, task, work, from, to)
}

/// Returns a job of a robot; `None` where there is nowhere to do it.
fn job(
    scenario: &Scenario,
    building: &PeopleBuilding,
    task: &RobotTask,
    work: &Work,
    from: Option<String>,
    to: Vec<String>,
) -> Option<RobotJob> {
    let path = if work.kind == RobotJobKind::Clean && cleans(&task.robot.kind) {
        lanes(scenario, building, task, &to)
    } else {
        Vec::new()
    };
    if to.is_empty() && path.is_empty() {
        return None;
    }
    Some(RobotJob {
        job_id: String::new(),
        kind: work.kind,
        what: String::new(),
        load_kg: work.load_kg,
        from,
        to,
        path,
        seconds: work.seconds,
        ask_id: None,
    })
}

/// Returns the ends of the lanes in which a robot goes over the floor to be cleaned of the rooms that it visits, room by room,
/// each lane the other way than the one before. Between two ends it goes where there is floor.
fn lanes(scenario: &Scenario, building: &PeopleBuilding, task: &RobotTask, to: &[String]) -> Vec<Point> {
    let mut out: Vec<Point> = Vec::new();
    let Some(ground) = building.grounds.iter().find(|g| g.level == task.level) else { return out };
    let frame = &ground.occupancy.frame;
    let clear = ground.occupancy.clear(task.robot.radius_m + d3dgen_model::occupancy::CELL_M);
    let start = Point::new(task.start.x, task.start.y);
    let Some(cell) = ground.occupancy.nearest(&clear, start).and_then(|p| frame.cell(p)) else { return out };
    let mut seed = d3dgen_model::occupancy::Bitmap::new(frame.nx, frame.ny);
    seed.set(cell.0, cell.1);
    let reached = clear.flood(&seed);
    let step = ((2.0 * task.robot.radius_m * (1.0 - OVERLAP)) / d3dgen_model::occupancy::CELL_M).max(1.0) as usize;
    let rooms = to.iter().filter_map(|id| scenario.pois.iter().find(|p| &p.poi_id == id)).map(|p| p.room_id.as_str());
    for room in rooms {
        let zones = scenario.rois.iter().filter(|r| r.kind == RoiKind::CleaningZone && r.room_id == room);
        for zone in zones {
            let (i0, i1, j0, j1) = frame.span(&zone.polygon.bounds());
            let inside = |i: usize, j: usize| reached.get(i, j) && zone.polygon.contains(frame.center(i, j));
            let columns = || i0.max(0) as usize..i1.min(frame.nx as i64).max(0) as usize;
            for (k, j) in (j0.max(0) as usize..j1.min(frame.ny as i64).max(0) as usize).step_by(step).enumerate() {
                let mut row: Vec<Point> = Vec::new();
                for i in columns().filter(|i| inside(*i, j)) {
                    let first = i == 0 || !inside(i - 1, j);
                    let last = i + 1 == frame.nx || !inside(i + 1, j);
                    if first || last {
                        let p = frame.center(i, j);
                        row.push(Point::new(to_mm(p.x), to_mm(p.y)));
                    }
                }
                if k % 2 == 1 {
                    row.reverse();
                }
                out.extend(row);
            }
        }
        if out.len() > MOST_CORNERS {
            break;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_robot_has_work_and_every_verb_one_meaning() {
        for kind in d3dgen_model::robot_kind::names() {
            assert!(usual(kind).seconds >= 0.0, "{kind}");
        }
        let mut verbs: Vec<&String> = WORKS.iter().flat_map(|w| &w.verbs).collect();
        let all = verbs.len();
        verbs.sort();
        verbs.dedup();
        assert_eq!(verbs.len(), all);
        assert_eq!(usual("no_such_kind").kind, RobotJobKind::Deliver);
        assert_eq!(usual("cleaning").kind, RobotJobKind::Clean);
    }

    #[test]
    fn work_of_more_than_a_charge_is_done_in_several_jobs() {
        let lane = |k: u32| [Point::new(0.0, f64::from(k) * 0.36), Point::new(20.0, f64::from(k) * 0.36)];
        let path: Vec<Point> = (0..300).flat_map(lane).collect();
        let floor = RobotJob {
            job_id: String::new(),
            kind: RobotJobKind::Clean,
            what: String::new(),
            load_kg: 0.0,
            from: None,
            to: vec![String::from("hall")],
            path: path.clone(),
            seconds: 10.0,
            ask_id: None,
        };
        let nowhere = |_: &str| None;
        assert!(floor.least_seconds(nowhere) > charge_s("cleaning"));
        let jobs = charges("cleaning", &floor, nowhere);
        assert!(jobs.iter().all(|j| j.least_seconds(nowhere) < charge_s("cleaning")), "{}", jobs.len());
        assert_eq!(jobs.iter().flat_map(|j| j.path.clone()).collect::<Vec<_>>(), path, "nothing is left out");
    }
}
