//! People who fill the scene, by the roles of the domain: how many at this hour, where they begin, what they do in turn, and
//! who comes and goes.
//!
//! `ground` knows the rooms and where one can stand, `stations` what is used at objects, `access` who may go where, `rounds`
//! turns the rounds of roles into steps. All of it is the domain's data; nothing here knows a role or a room by name.

mod access;
mod ground;
mod kept;
mod rounds;
mod stations;

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Counted, Domain, Role, RoleKind, Round, is_named};
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::hours::Hour;
use d3dgen_model::scenario::{Act, Agent, Flow, Itinerary, Scenario, Station, Step};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::seed::Stream;
use d3dgen_model::{Point, Pose};

use access::Access;
use ground::Building;
pub(crate) use kept::keep as keep_steps;
use rounds::Writer;

/// People at most, all roles together, who are there from the start.
const MOST_PEOPLE: usize = 400;
/// Itineraries of a flow at most.
const MOST_ITINERARIES: u32 = 8;
/// Rooms that a person's list of waypoints names at most.
const MOST_WAYPOINTS: usize = 8;
/// Share of the time that a counter is busy at most: near 1 the line before it grows beyond any floor (Erlang's waiting formula).
const BUSIEST: f64 = 0.8;
/// Fewest people of a flow in the building at a time.
const LEAST_IN_FLOW: u32 = 2;

/// What people of all roles share.
struct Scene<'s, 'a> {
    building: &'s Building<'a>,
    access: &'s Access<'a>,
    graph: &'s SceneGraph,
    domain: &'a Domain,
    hour: &'s Hour,
}

/// Adds the people of an hour to a scenario: those who are there, the places at objects that they use, and who comes.
pub(crate) fn fill(scenario: &mut Scenario, graph: &SceneGraph, plan: &Floorplan, building: &Building, hour: &Hour) {
    let domain = building.domain;
    let access = Access::new(plan, domain);
    let scene = Scene { building, access: &access, graph, domain, hour };
    let counts = counts(&scene);
    let mut writer = Writer::new(building, &scenario.robots, &scenario.pois);
    let mut agents: Vec<((usize, usize), Agent)> = Vec::new();
    // those that others go to are known before these
    let visited = |role: &Role| {
        domain.roles.iter().flat_map(|r| &r.rounds).flat_map(|r| &r.steps).any(|s| s.to_role.as_ref() == Some(&role.id))
    };
    let mut order: Vec<usize> = (0..domain.roles.len()).collect();
    order.sort_by_key(|&i| !visited(&domain.roles[i]));
    let mut flows: Vec<(usize, Flow)> = Vec::new();
    for i in order {
        let role = &domain.roles[i];
        let rounds = role.rounds_at(&hour.id);
        let there: Vec<&Round> = rounds.iter().copied().filter(|r| r.arrivals_per_h == 0.0).collect();
        let count = if rounds.is_empty() || !there.is_empty() { counts[i] } else { 0 };
        let count = (count as usize).min(MOST_PEOPLE.saturating_sub(agents.len()));
        for number in evenly(count) {
            let round = if there.is_empty() { None } else { Some(there[number % there.len()]) };
            let known: Vec<&Agent> = agents.iter().map(|(_, a)| a).collect();
            let made = person(&scene, &mut writer, (role, round), (number, count), &known);
            agents.extend(made.map(|agent| ((i, number), agent)));
        }
        for (k, round) in rounds.iter().filter(|r| r.arrivals_per_h > 0.0).enumerate() {
            let known: Vec<&Agent> = agents.iter().map(|(_, a)| a).collect();
            flows.extend(flow(&scene, &mut writer, (role, round, k), counts[i], &known).map(|f| (i, f)));
        }
    }
    let stations: Vec<&Station> = writer.stations().collect();
    serve(flows.iter_mut().map(|(_, flow)| flow).collect(), &stations);
    agents.sort_by_key(|(place, _)| *place);
    flows.sort_by_key(|(i, _)| *i);
    scenario.agents = agents.into_iter().map(|(_, a)| a).collect();
    scenario.flows = flows.into_iter().map(|(_, f)| f).collect();
    scenario.stations = used(&writer, &scenario.agents, &scenario.flows);
}

/// Returns the numbers of people so that the first few are from all over: those who begin in one room follow each other, and what
/// has few places, such as the floor of a hall, goes to some of each room.
fn evenly(count: usize) -> impl Iterator<Item = usize> {
    // steps of about the golden section leave no gap much larger than another (three-gap theorem)
    let near = (count as f64 * 0.618) as usize;
    let stride = (near.max(1)..).find(|stride| coprime(*stride, count)).unwrap_or(1);
    (0..count).map(move |k| k * stride % count)
}

fn coprime(mut a: usize, mut b: usize) -> bool {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

/// Has no more people come than the counters that they line up at serve: with more, lines grow without end.
fn serve(flows: Vec<&mut Flow>, stations: &[&Station]) {
    let mut loads: BTreeMap<String, f64> = BTreeMap::new();
    for flow in &flows {
        for step in flow.steps().filter(|s| s.act == Act::Queue) {
            *loads.entry(step.room_id.clone()).or_default() +=
                flow.people_per_s() * step.seconds / flow.itineraries.len() as f64;
        }
    }
    let counters = |room: &str| stations.iter().filter(|s| s.act == Act::Queue && s.room_id == room).count();
    // where nobody serves there is no line either
    let shares = loads.into_iter().map(|(room, load)| (counters(&room) as f64 * BUSIEST / load, room));
    let shares: BTreeMap<String, f64> =
        shares.filter(|(share, _)| *share > 0.0).map(|(share, room)| (room, share)).collect();
    for flow in flows {
        let share = flow.steps().filter(|s| s.act == Act::Queue).filter_map(|s| shares.get(&s.room_id)).copied();
        flow.per_min = rate(flow.per_min * share.fold(1.0, f64::min));
    }
}

/// Returns a rate as it is written.
fn rate(per_min: f64) -> f64 {
    (per_min * 1000.0).round() / 1000.0
}

/// Returns the stations that steps name, and all of the rooms and acts of steps that take what is free.
fn used(writer: &Writer, agents: &[Agent], flows: &[Flow]) -> Vec<Station> {
    let steps: Vec<&Step> = agents.iter().flat_map(|a| &a.steps).chain(flows.iter().flat_map(Flow::steps)).collect();
    let named: BTreeSet<&str> = steps
        .iter()
        .filter_map(|s| s.station.as_deref())
        .chain(agents.iter().filter_map(|a| a.on.as_deref()))
        .collect();
    let open: BTreeSet<(&str, &str)> =
        steps.iter().filter(|s| s.station.is_none()).map(|s| (s.room_id.as_str(), s.act.name())).collect();
    let is_used =
        |s: &&Station| named.contains(s.station_id.as_str()) || open.contains(&(s.room_id.as_str(), s.act.name()));
    writer.stations().filter(is_used).cloned().collect()
}

/// Returns how many people of each role there are at the hour, of those who are there and of those who come.
fn counts(scene: &Scene) -> Vec<u32> {
    let Scene { building, graph, domain, hour, .. } = scene;
    let residents = graph.occupancy.residents.unwrap_or_else(|| building.beds().clamp(1, 8));
    let lives = |role: &Role| {
        role.kind == RoleKind::Occupant && role.number.as_ref().is_some_and(|n| n.of == Counted::Residents)
    };
    let at_home: Vec<bool> = domain.roles.iter().map(|r| lives(r) && has_home(scene, r)).collect();
    let mut out: Vec<u32> =
        domain.roles.iter().map(|role| if lives(role) { 0 } else { count(scene, role, residents) }).collect();
    // one of each kind of those who live there, then more of the first
    for i in (0..at_home.len()).filter(|i| at_home[*i]).cycle().take(if at_home.contains(&true) {
        residents as usize
    } else {
        0
    }) {
        out[i] += 1;
    }
    // as many as are said to work there, not more
    let works = |i: &usize| {
        domain.roles[*i].kind != RoleKind::Visitor
            && domain.roles[*i].number.as_ref().is_some_and(|n| !matches!(n.of, Counted::Residents | Counted::Beds))
    };
    if let Some(told) =
        graph.occupancy.staff.map(|n| (f64::from(n) * hour.share(RoleKind::Staff)).round().max(1.0) as u32)
    {
        let working: Vec<usize> = (0..out.len()).filter(works).collect();
        while working.iter().map(|i| out[*i]).sum::<u32>() > told {
            let Some(&most) = working.iter().rev().max_by_key(|i| out[**i]) else { break };
            out[most] -= 1;
        }
    }
    out
}

fn has_home(scene: &Scene, role: &Role) -> bool {
    role.home.is_empty()
        || scene.building.rooms.iter().any(|r| role.home.iter().any(|name| is_named(name, r.kind, &r.tags)))
}

fn count(scene: &Scene, role: &Role, residents: u32) -> u32 {
    if !has_home(scene, role) {
        return 0;
    }
    // a role of a domain that says no number: one
    let Some(number) = &role.number else { return 1 };
    let rooms = || {
        let home =
            |r: &&ground::Room| role.home.is_empty() || role.home.iter().any(|name| is_named(name, r.kind, &r.tags));
        scene.building.rooms.iter().filter(home)
    };
    let all = match number.of {
        Counted::Rooms => rooms().count() as f64,
        Counted::AreaM2 => rooms().map(|r| r.plan.net_area_m2).sum(),
        Counted::Residents => f64::from(residents),
        Counted::Beds => f64::from(rooms().map(|r| r.count("lie")).sum::<u32>()),
        Counted::Seats => f64::from(rooms().map(|r| r.count("sit")).sum::<u32>()),
        Counted::Posts => f64::from(rooms().map(|r| r.count("operate")).sum::<u32>()),
    };
    let full = ((all / number.each.max(0.01)).floor() as u32).clamp(number.least, number.most.max(number.least));
    let share = scene.hour.share(role.kind);
    // whoever looks after somebody is never away altogether
    let looks_after = role.rounds_at(&scene.hour.id).iter().flat_map(|r| &r.steps).any(|s| s.to_role.is_some());
    let least = u32::from(looks_after && full > 0 && share > 0.0);
    ((f64::from(full) * share).round() as u32).max(least)
}

/// Returns one person with the steps of its round; `None` where it finds no place to begin at.
fn person(
    scene: &Scene,
    writer: &mut Writer,
    (role, round): (&Role, Option<&Round>),
    (number, count): (usize, usize),
    known: &[&Agent],
) -> Option<Agent> {
    let agent_id = format!("{}_{}", role.id, number + 1);
    let mut stream = Stream::new(scene.graph.seed, &format!("scenario/{}/{agent_id}", scene.hour.id));
    let allowed = scene.access.reach(role, scene.building.home_of(role, number, count));
    let mut steps = match round {
        Some(round) => writer.steps(&round.steps, &allowed, (number, count), known, &mut stream),
        None => writer.rounds_of_visits(&role.visits, &allowed, &mut stream),
    };
    let begin = steps.iter().position(|s| writer.can_begin(s))?;
    steps.rotate_left(begin);
    let first = &steps[0];
    writer.begin(first);
    let mut waypoints: Vec<String> = steps.iter().map(|s| s.room_id.clone()).collect();
    waypoints.dedup();
    waypoints.truncate(MOST_WAYPOINTS);
    let on = first.station.as_ref().filter(|_| first.act.affordance().is_some_and(|a| a != "operate"));
    Some(Agent {
        role: role.id.clone(),
        model: role.model.clone(),
        speed_m_s: role.speed_m_s,
        start: first.pose,
        level: scene.building.level_of(&first.room_id),
        on: on.cloned(),
        waypoints,
        group: None,
        spotlight: round.is_some_and(|r| r.spotlight),
        leaves: round.is_some_and(|r| r.leaves),
        begins_s: 0.0,
        locked: false,
        steps,
        agent_id,
    })
}

/// Returns those of a role who come in by an entrance; `None` where there is no entrance, or nothing to do for them.
fn flow(
    scene: &Scene,
    writer: &mut Writer,
    (role, round, number): (&Role, &Round, usize),
    count: u32,
    known: &[&Agent],
) -> Option<Flow> {
    if count == 0 {
        return None;
    }
    let flow_id = format!("{}_flow_{}", role.id, number + 1);
    let (door, room_id, at) = scene.building.entrance()?;
    let allowed = scene.access.reach(role, Some(room_id));
    let mut stream = Stream::new(scene.graph.seed, &format!("scenario/{}/{flow_id}", scene.hour.id));
    let mut itineraries: Vec<Itinerary> = Vec::new();
    for _ in 0..MOST_ITINERARIES {
        let made = Itinerary { steps: writer.open_steps(&round.steps, &allowed, known, &mut stream) };
        if !made.steps.is_empty() && !itineraries.contains(&made) {
            itineraries.push(made);
        }
    }
    if itineraries.is_empty() {
        return None;
    }
    let per_h = f64::from(count) * round.arrivals_per_h * scene.hour.arrivals;
    Some(Flow {
        flow_id,
        role: role.id.clone(),
        model: role.model.clone(),
        speed_m_s: role.speed_m_s,
        door_id: door.to_owned(),
        room_id: room_id.to_owned(),
        pose: at,
        per_min: rate(per_h / 60.0),
        most: (2 * count).max(LEAST_IN_FLOW).max(round.group[1]),
        group: round.group,
        itineraries,
    })
}

/// Returns the pose at a point that looks at another one.
fn facing(from: Point, to: Point) -> Pose {
    use d3dgen_model::geometry::to_mm;
    let yaw = (to.y - from.y).atan2(to.x - from.x);
    Pose { x: to_mm(from.x), y: to_mm(from.y), z: 0.0, yaw_rad: (yaw * 1e4).round() / 1e4 }
}

pub(crate) use ground::{Building as PeopleBuilding, Room as PeopleRoom};

/// Rooms by id, with those that one gets to from each.
type Neighbors<'a> = BTreeMap<&'a str, BTreeSet<&'a str>>;

#[cfg(test)]
mod tests {
    use super::*;

    fn queue(room: &str, seconds: f64) -> Step {
        let pose = Pose { x: 0.0, y: 0.0, z: 0.0, yaw_rad: 0.0 };
        Step { room_id: room.to_owned(), act: Act::Queue, pose, seconds, station: None, with: None }
    }

    fn flow(room: &str, per_min: f64, seconds: f64) -> Flow {
        Flow {
            flow_id: format!("{room}_flow"),
            role: String::from("traveller"),
            model: String::new(),
            speed_m_s: 1.3,
            door_id: String::from("door_1"),
            room_id: String::from("hall"),
            pose: queue(room, 0.0).pose,
            per_min,
            most: 80,
            group: [1, 3],
            itineraries: vec![Itinerary { steps: vec![queue(room, seconds)] }, Itinerary { steps: Vec::new() }],
        }
    }

    #[test]
    fn the_first_few_of_many_are_from_all_over() {
        for count in [0, 1, 2, 3, 8, 112] {
            let mut all: Vec<usize> = evenly(count).collect();
            all.sort_unstable();
            assert_eq!(all, (0..count).collect::<Vec<_>>(), "each once");
        }
        let classes: BTreeSet<usize> = evenly(112).take(12).map(|number| number * 6 / 112).collect();
        assert_eq!(classes.len(), 6, "some of each of six classes: {classes:?}");
    }

    #[test]
    fn no_more_people_come_than_counters_serve() {
        let counter = |n: u32| Station {
            station_id: format!("counter_{n}"),
            room_id: String::from("check_in"),
            placement_id: String::from("counter"),
            act: Act::Queue,
            before: queue("check_in", 0.0).pose,
            at: queue("check_in", 0.0).pose,
            queue: vec![Point::new(0.0, 1.0)],
        };
        let counters = [counter(1), counter(2)];
        let stations: Vec<&Station> = counters.iter().collect();
        // 12 groups of two a minute, every second one of which takes a counter for 30 s a person: 6 counters' work
        let (mut crowd, mut few, mut elsewhere) =
            (flow("check_in", 12.0, 30.0), flow("check_in", 0.6, 30.0), flow("kiosk", 9.0, 60.0));
        serve(vec![&mut crowd, &mut few, &mut elsewhere], &stations);
        let work = |f: &Flow| f.people_per_s() * 30.0 / 2.0;
        assert!((work(&crowd) + work(&few) - 2.0 * BUSIEST).abs() < 0.01, "{} {}", crowd.per_min, few.per_min);
        assert!((crowd.per_min / few.per_min - 20.0).abs() < 0.2, "all come less often alike");
        assert_eq!(elsewhere.per_min, 9.0, "no line, no limit");
        let mut quiet = flow("check_in", 1.0, 30.0);
        serve(vec![&mut quiet], &stations);
        assert_eq!(quiet.per_min, 1.0);
    }
}
