//! A scenario becomes those who move: people with their steps, robots with their jobs, sources of those who come.

use std::collections::BTreeMap;

use d3dgen_model::Point;
use d3dgen_model::domain::{Domain, Role};
use d3dgen_model::robot_kind::WORK_M_S;
use d3dgen_model::scenario::{Act, Agent, Flow, PERSON_RADIUS_M, RobotTask, Scenario, Station, Step};
use d3dgen_model::seed::Stream;
use d3dgen_model::world::World;

use crate::engine::{Engine, Source};
use crate::mover::{Mover, State, Task};
use crate::routes::Link;
use crate::space::Space;

/// Time at a corner of a way over a floor, s.
const CORNER_S: f64 = 0.0;
/// Time that somebody stands in a room where no step says it, s.
const STAY_S: f64 = 15.0;
/// Time between two moments at which people of a scenario begin what they do, s: not all at once.
const STAGGER_S: f64 = 0.7;

/// Returns the storeys.
pub fn spaces(world: &World) -> Vec<Space> {
    let levels = world.floorplan.level_numbers();
    let space = |level: &i32| {
        let plan = world.floorplan.storey_at(*level);
        let placements = world.placements.storey(&plan);
        Space::new(*level, &plan, &placements)
    };
    levels.iter().map(space).collect()
}

/// Where rooms are: by id, the index of the storey and of the room on it.
struct Places<'s> {
    rooms: BTreeMap<&'s str, (usize, usize)>,
    stations: BTreeMap<&'s str, usize>,
}

/// Returns the engine with everybody in it.
pub fn engine<'e>(
    world: &World,
    domain: &Domain,
    (spaces, links): (&'e [Space], &'e [Link]),
    seed: u64,
    seconds: f64,
) -> Engine<'e> {
    let scenario = &world.scenario;
    let rooms: BTreeMap<&str, (usize, usize)> = spaces
        .iter()
        .enumerate()
        .flat_map(|(level, space)| space.rooms.iter().enumerate().map(move |(i, id)| (id.as_str(), (level, i))))
        .collect();
    let known: Vec<(usize, usize, Station)> = scenario
        .stations
        .iter()
        .filter_map(|s| rooms.get(s.room_id.as_str()).map(|(level, room)| (*level, *room, s.clone())))
        .collect();
    let stations = known.iter().enumerate().map(|(i, (.., s))| (s.station_id.clone(), i)).collect::<Vec<_>>();
    let places = Places { rooms, stations: stations.iter().map(|(id, i)| (id.as_str(), *i)).collect() };
    let mut engine = Engine::new(spaces, links, known, seconds);
    let mut roles: BTreeMap<&str, usize> = BTreeMap::new();
    for (k, agent) in scenario.agents.iter().enumerate() {
        let access = access(world, domain, spaces, &agent.role, &mut roles, &mut engine.access);
        if let Some(mover) = person(agent, &places, spaces, (k, access)) {
            let on = agent.on.as_ref().and_then(|id| places.stations.get(id.as_str())).copied();
            engine.movers.push(mover);
            if let Some(station) = on {
                sit(&mut engine, station, agent);
            }
        }
    }
    for flow in &scenario.flows {
        let access = access(world, domain, spaces, &flow.role, &mut roles, &mut engine.access);
        engine.sources.extend(source(flow, &places, seed, access));
    }
    engine.access.push(spaces.iter().map(|s| vec![true; s.rooms.len()]).collect());
    let anywhere = engine.access.len() - 1;
    engine.movers.extend(scenario.robots.iter().filter_map(|r| robot(r, scenario, &places, spaces, anywhere)));
    engine
}

/// Returns which rooms a role may enter: an index into those of all roles.
fn access<'w>(
    world: &World,
    domain: &Domain,
    spaces: &[Space],
    role: &'w str,
    known: &mut BTreeMap<&'w str, usize>,
    all: &mut Vec<Vec<Vec<bool>>>,
) -> usize {
    if let Some(&index) = known.get(role) {
        return index;
    }
    let of = domain.roles.iter().find(|r| r.id == role);
    let may = |id: &String| {
        let kind = world.floorplan.room(id).map(|r| domain.room_type_or_generic(&r.room_type));
        // of a role that the domain does not know nothing is forbidden
        let enters = |role: &Role| kind.is_some_and(|k| role.may_enter(k, &domain.tags_of(k)));
        of.is_none_or(enters)
    };
    all.push(spaces.iter().map(|s| s.rooms.iter().map(may).collect()).collect());
    known.insert(role, all.len() - 1);
    all.len() - 1
}

/// Puts somebody onto the seat or bed that it begins on.
fn sit(engine: &mut Engine, station: usize, agent: &Agent) {
    let i = engine.movers.len() - 1;
    let s = engine.stations[station].2.clone();
    engine.take(station, i);
    let mover = &mut engine.movers[i];
    let first = agent.steps.first().map_or(f64::MAX, |step| step.seconds);
    mover.station = Some(station);
    mover.at = Point::new(s.at.x, s.at.y);
    mover.state = State::On { until: first };
    mover.begin_pause(0.0, if s.act == Act::Lie { "bed" } else { "seat" });
}

fn task(step: &Step, places: &Places) -> Option<Task> {
    let &(level, room) = places.rooms.get(step.room_id.as_str())?;
    let station = step.station.as_ref().and_then(|id| places.stations.get(id.as_str())).copied();
    let at = Point::new(step.pose.x, step.pose.y);
    Some(Task { level, room, at, act: step.act, seconds: step.seconds, station, job: None })
}

fn person(agent: &Agent, places: &Places, spaces: &[Space], (k, access): (usize, usize)) -> Option<Mover> {
    let level = spaces.iter().position(|s| s.level == agent.level)?;
    let at = Point::new(agent.start.x, agent.start.y);
    let mut mover = Mover::new(agent.agent_id.clone(), agent.role.clone(), PERSON_RADIUS_M, agent.speed_m_s, level, at);
    mover.tasks = match agent.steps.is_empty() {
        false => agent.steps.iter().filter_map(|s| task(s, places)).collect(),
        true => agent.waypoints.iter().filter_map(|id| stay(id, places, spaces)).collect(),
    };
    // who leaves does so by where it is told to come in, else at its last step
    mover.exit = agent.leaves.then(|| exit(spaces)).flatten();
    mover.repeats = !agent.leaves;
    mover.group.clone_from(&agent.group);
    mover.begins = agent.begins_s + (k % 7) as f64 * STAGGER_S;
    mover.access = access;
    Some(mover)
}

/// Returns where people leave: before the first door to the outside, as the storey's doors know it.
fn exit(spaces: &[Space]) -> Option<(usize, Point)> {
    let level = spaces.iter().position(|s| s.level == 0).unwrap_or(0);
    spaces.get(level)?.exit.map(|p| (level, p))
}

/// Returns the task of standing a while in the middle of a room.
fn stay(room_id: &str, places: &Places, spaces: &[Space]) -> Option<Task> {
    let &(level, room) = places.rooms.get(room_id)?;
    let at = spaces[level].outlines[room].bounds().center();
    Some(Task { level, room, at, act: Act::Stand, seconds: STAY_S, station: None, job: None })
}

fn source(flow: &Flow, places: &Places, seed: u64, access: usize) -> Option<Source> {
    let &(level, _) = places.rooms.get(flow.room_id.as_str())?;
    let itineraries = flow.itineraries.iter().map(|i| i.steps.iter().filter_map(|s| task(s, places)).collect());
    Some(Source {
        id: flow.flow_id.clone(),
        role: flow.role.clone(),
        speed: flow.speed_m_s,
        level,
        at: Point::new(flow.pose.x, flow.pose.y),
        per_min: flow.per_min,
        most: flow.most as usize,
        group: flow.group,
        itineraries: itineraries.collect(),
        access,
        stream: Stream::new(seed, &format!("crowd/{}", flow.flow_id)),
        next: 0.0,
        count: 0,
        waiting: Vec::new(),
    })
}

fn robot(r: &RobotTask, scenario: &Scenario, places: &Places, spaces: &[Space], access: usize) -> Option<Mover> {
    let level = spaces.iter().position(|s| s.level == r.level)?;
    let start = Point::new(r.start.x, r.start.y);
    let mut mover = Mover::new(r.robot_id.clone(), r.robot.kind.clone(), r.robot.radius_m, WORK_M_S, level, start);
    let point = |id: &String, seconds: f64, job: Option<&String>| {
        let poi = scenario.pois.iter().find(|p| &p.poi_id == id)?;
        let &(level, room) = places.rooms.get(poi.room_id.as_str())?;
        let at = Point::new(poi.pose.x, poi.pose.y);
        Some(Task { level, room, at, act: Act::Stand, seconds, station: None, job: job.cloned() })
    };
    for job in &r.jobs {
        mover.tasks.extend(job.from.iter().filter_map(|id| point(id, job.seconds, Some(&job.job_id))));
        if job.path.is_empty() {
            mover.tasks.extend(job.to.iter().filter_map(|id| point(id, job.seconds, Some(&job.job_id))));
        }
        let corner = |p: &Point| {
            let room = spaces[level].room_at(*p)?;
            Some(Task {
                level,
                room,
                at: *p,
                act: Act::Pass,
                seconds: CORNER_S,
                station: None,
                job: Some(job.job_id.clone()),
            })
        };
        mover.tasks.extend(job.path.iter().filter_map(corner));
    }
    if r.jobs.is_empty() {
        mover.tasks.extend(r.goals.iter().filter_map(|id| point(id, STAY_S, None)));
    }
    mover.tasks.extend(r.dock.iter().filter_map(|id| point(id, STAY_S, None)));
    mover.robot = true;
    mover.access = access;
    Some(mover)
}
