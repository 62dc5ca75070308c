//! Rounds become steps: which room, which place in it, for how long.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{RoundStep, is_named};
use d3dgen_model::scenario::{Act, Agent, Poi, RobotTask, Station, Step};
use d3dgen_model::seed::Stream;
use d3dgen_model::{Point, Pose};

use super::ground::{Building, Room};
use super::{facing, stations};

/// Floor for each who stands in a room, m^2: more than that is a crowd (level of service B, Fruin 1971).
const STANDING_M2: f64 = 3.0;
/// How often the places of a line are taken by another one, of people who are there from the start: more would wait for ever.
const TURNS: u32 = 3;
/// Rooms of those that suit a step among which the seed chooses: the nearest.
const NEAREST: usize = 3;
/// Places of a room that are looked at for one away from others.
const TRIES: usize = 12;
/// Distance of two who begin near each other, and of one who stands from others, m.
const BEGIN_APART_M: f64 = 0.5;
const STAND_APART_M: f64 = 0.75;
/// Distance of those who talk to each other, m: the near part of what is personal (Hall 1966).
const TALK_M: f64 = 0.8;
/// Distance of another storey, m, where the nearest room is looked for.
const STOREY_M: f64 = 100.0;
/// Distance of another part of the building, m.
const UNIT_M: f64 = 30.0;
/// How long somebody stands at a place where no round says it, s.
const VISIT_S: [f64; 2] = [5.0, 20.0];
/// Rooms that somebody without rounds walks between at most.
const MOST_VISITS: usize = 4;
/// Play that is left around a robot which starts or charges somewhere, m.
const ROBOT_PLAY_M: f64 = 0.3;

/// Writes steps, and knows what is taken.
pub(super) struct Writer<'s, 'a> {
    building: &'s Building<'a>,
    /// Places of a room by act, once somebody asks.
    stations: BTreeMap<(usize, Act), Vec<Station>>,
    /// Places that belong to somebody.
    owned: BTreeSet<String>,
    /// Where people begin, and where robots stand, with the storey.
    begun: Vec<(i32, Point)>,
    robots: Vec<(i32, Point, f64)>,
    /// Where people stand for a while.
    stood: Vec<(i32, Point)>,
    /// How many stand in a room.
    crowd: BTreeMap<usize, u32>,
}

impl<'s, 'a> Writer<'s, 'a> {
    pub fn new(building: &'s Building<'a>, robots: &[RobotTask], pois: &[Poi]) -> Self {
        let at = |pose: &Pose| Point::new(pose.x, pose.y);
        let radius = robots.iter().map(|r| r.robot.radius_m).fold(0.3, f64::max);
        let starts = robots.iter().map(|r| (r.level, at(&r.start), r.robot.radius_m));
        let docks = pois.iter().filter(|p| p.kind == Poi::DOCK || p.kind == Poi::WAITING_BAY);
        let docks = docks.map(|p| (building.level_of(&p.room_id), at(&p.pose), radius));
        let (stations, owned) = (BTreeMap::new(), BTreeSet::new());
        Self {
            building,
            stations,
            owned,
            begun: Vec::new(),
            robots: starts.chain(docks).collect(),
            stood: Vec::new(),
            crowd: BTreeMap::new(),
        }
    }

    /// Returns all places that were looked at, room by room.
    pub fn stations(&self) -> impl Iterator<Item = &Station> {
        self.stations.values().flatten()
    }

    /// Returns the steps of one of several people of a round.
    pub fn steps(
        &mut self,
        round: &[RoundStep],
        allowed: &BTreeSet<&str>,
        share: (usize, usize),
        known: &[&Agent],
        stream: &mut Stream,
    ) -> Vec<Step> {
        let mut out: Vec<Step> = Vec::new();
        for step in round {
            if !stream.chance(step.chance) {
                continue;
            }
            if let Some(role) = &step.to_role {
                let all = of_role(known, role, allowed);
                let own = all[share.0 * all.len() / share.1..(share.0 + 1) * all.len() / share.1].to_vec();
                out.extend(own.into_iter().map(|agent| self.to_person(agent, step, stream)));
                continue;
            }
            let from = out.last().map(|s| s.pose);
            let rooms = self.rooms(&step.at, allowed, from, share);
            if step.all {
                let all = &rooms.first().map(|(_, rooms)| rooms.clone()).unwrap_or_default();
                let mut own = all.clone();
                own.sort_unstable();
                let own = own[share.0 * own.len() / share.1..(share.0 + 1) * own.len() / share.1].to_vec();
                out.extend(own.into_iter().map(|room| self.in_room(room, step, stream)));
                continue;
            }
            out.extend(self.at_one_of(&rooms, step, &out, stream));
        }
        out
    }

    /// Returns a step in the first of some rooms where there is something to do it at: a place that it has already, or one that is
    /// free; where there is none, standing.
    fn at_one_of(
        &mut self,
        rooms: &[(String, Vec<usize>)],
        step: &RoundStep,
        before: &[Step],
        stream: &mut Stream,
    ) -> Option<Step> {
        for named in rooms {
            let own = before.iter().find(|s| s.act == step.act && s.station.is_some() && self.suits(s, &named.0));
            let again = own.map(|s| Step { seconds: seconds(step, stream), ..s.clone() });
            let made = again.or_else(|| self.at_station(std::slice::from_ref(named), step, stream));
            if made.is_some() {
                return made;
            }
        }
        self.somewhere(rooms, step, stream)
    }

    /// Returns the steps of people who come in: they take places that are free when they get there.
    pub fn open_steps(
        &mut self,
        round: &[RoundStep],
        allowed: &BTreeSet<&str>,
        known: &[&Agent],
        stream: &mut Stream,
    ) -> Vec<Step> {
        let mut out: Vec<Step> = Vec::new();
        for step in round {
            if !stream.chance(step.chance) {
                continue;
            }
            if let Some(role) = &step.to_role {
                let all = of_role(known, role, allowed);
                out.extend(stream.pick(&all).map(|agent| self.to_person(agent, step, stream)));
                continue;
            }
            let rooms = self.rooms(&step.at, allowed, None, (0, 1));
            let room = match self.with_places(&rooms, step.act, stream) {
                Some(room) => room,
                None => match rooms.first().and_then(|(_, rooms)| stream.pick(rooms).copied()) {
                    Some(room) => room,
                    None => continue,
                },
            };
            out.push(self.in_room(room, step, stream));
        }
        out
    }

    /// Returns a room where an act has places: of a line the first one, of all else any, as often as it has places.
    fn with_places(&mut self, rooms: &[(String, Vec<usize>)], act: Act, stream: &mut Stream) -> Option<usize> {
        act.affordance()?;
        let mut places: Vec<usize> = Vec::new();
        let mut known: BTreeSet<usize> = BTreeSet::new();
        for room in rooms.iter().flat_map(|(_, rooms)| rooms.iter().copied()) {
            let count = if known.insert(room) { self.of_room(room, act).len() } else { 0 };
            if act == Act::Queue && count > 0 {
                return Some(room);
            }
            places.extend(std::iter::repeat_n(room, count));
        }
        stream.pick(&places).copied()
    }

    /// Returns the steps of a person of whom only the rooms are known that it walks between.
    pub fn rounds_of_visits(&mut self, visits: &[String], allowed: &BTreeSet<&str>, stream: &mut Stream) -> Vec<Step> {
        let step = |name: &String| RoundStep {
            at: vec![name.clone()],
            to_role: None,
            act: Act::Stand,
            seconds: VISIT_S,
            all: false,
            chance: 1.0,
        };
        let round: Vec<RoundStep> = visits.iter().map(step).collect();
        let mut out = self.steps(&round, allowed, (0, 1), &[], stream);
        out.truncate(MOST_VISITS);
        stream.shuffle(&mut out);
        out
    }

    /// Returns true for a step at which a person may be at the beginning: nobody else begins there.
    pub fn can_begin(&self, step: &Step) -> bool {
        step.with.is_none() && self.is_clear(self.building.level_of(&step.room_id), &step.pose)
    }

    /// Notes that a person begins at a step.
    pub fn begin(&mut self, step: &Step) {
        self.begun.push((self.building.level_of(&step.room_id), Point::new(step.pose.x, step.pose.y)));
    }

    /// Returns true for a step in a room that a name means.
    fn suits(&self, step: &Step, name: &str) -> bool {
        let room = self.building.rooms.iter().find(|r| r.plan.room_id == step.room_id);
        room.is_some_and(|r| is_named(name, r.kind, &r.tags))
    }

    /// Returns the rooms that each of some names means, the nearest first; names that mean none are left out.
    fn rooms(
        &self,
        names: &[String],
        allowed: &BTreeSet<&str>,
        from: Option<Pose>,
        share: (usize, usize),
    ) -> Vec<(String, Vec<usize>)> {
        let all = &self.building.rooms;
        let open = |i: &usize| allowed.contains(all[*i].plan.room_id.as_str());
        let of = |name: &String| -> Vec<usize> {
            let named = (0..all.len()).filter(|i| is_named(name, all[*i].kind, &all[*i].tags)).filter(open);
            let mut rooms: Vec<usize> = named.collect();
            match from {
                Some(pose) => {
                    let here = Point::new(pose.x, pose.y);
                    let room = all.iter().find(|r| r.plan.net_polygon.contains(here));
                    rooms.sort_by(|a, b| self.apart(here, room, *a).total_cmp(&self.apart(here, room, *b)));
                }
                // the first rooms belong to the first people
                None if !rooms.is_empty() => {
                    let turn = share.0 * rooms.len() / share.1.max(1) % rooms.len();
                    rooms.rotate_left(turn);
                }
                None => {}
            }
            rooms
        };
        names.iter().map(|name| (name.clone(), of(name))).filter(|(_, rooms)| !rooms.is_empty()).collect()
    }

    /// Returns how far a room is, m, by and large.
    fn apart(&self, here: Point, from: Option<&Room>, to: usize) -> f64 {
        let to = &self.building.rooms[to];
        let storeys =
            from.map_or(0, |r| self.building.grounds[r.ground].level.abs_diff(self.building.grounds[to.ground].level));
        let other = from.is_some_and(|r| r.unit != to.unit);
        here.distance(to.plan.net_polygon.bounds().center())
            + f64::from(storeys) * STOREY_M
            + if other { UNIT_M } else { 0.0 }
    }

    /// Returns the places of a room where an act is done.
    fn of_room(&mut self, room: usize, act: Act) -> &[Station] {
        let building = self.building;
        let of = || {
            let room = &building.rooms[room];
            stations::of_room(&building.grounds[room.ground], room, act)
        };
        self.stations.entry((room, act)).or_insert_with(of)
    }

    /// Returns the step at a place of its own in one of some rooms; `None` where none is left.
    fn at_station(&mut self, rooms: &[(String, Vec<usize>)], step: &RoundStep, stream: &mut Stream) -> Option<Step> {
        if step.act == Act::Queue || step.act.affordance().is_none() {
            return None;
        }
        for room in rooms.iter().flat_map(|(_, rooms)| rooms.iter().copied()) {
            let free: Vec<Station> = self.of_room(room, step.act).to_vec();
            let open = |s: &&Station| !self.owned.contains(&s.station_id) && self.is_free(room, s);
            let free: Vec<&Station> = free.iter().filter(open).collect();
            if let Some(station) = stream.pick(&free) {
                self.owned.insert(station.station_id.clone());
                return Some(Step {
                    room_id: station.room_id.clone(),
                    act: step.act,
                    pose: station.before,
                    seconds: seconds(step, stream),
                    station: Some(station.station_id.clone()),
                    with: None,
                });
            }
        }
        None
    }

    /// Returns true for a place before which nobody begins.
    fn is_free(&self, room: usize, station: &Station) -> bool {
        self.is_clear(self.building.grounds[self.building.rooms[room].ground].level, &station.before)
    }

    /// Returns true for a place of a storey away from all who begin on it and from its robots.
    fn is_clear(&self, level: i32, pose: &Pose) -> bool {
        let at = Point::new(pose.x, pose.y);
        let off = |(other, p, radius): &(i32, Point, f64)| *other != level || p.distance(at) >= radius + ROBOT_PLAY_M;
        self.begun.iter().all(|(other, p)| *other != level || p.distance(at) >= BEGIN_APART_M)
            && self.robots.iter().all(off)
    }

    /// Returns the step in one of the nearest rooms that suit.
    fn somewhere(&mut self, rooms: &[(String, Vec<usize>)], step: &RoundStep, stream: &mut Stream) -> Option<Step> {
        let mut lines: BTreeMap<usize, u32> = BTreeMap::new();
        if step.act == Act::Queue {
            for room in rooms.iter().flat_map(|(_, rooms)| rooms.iter().copied()) {
                let places = self.of_room(room, Act::Queue).iter().map(|s| 1 + s.queue.len() as u32);
                lines.insert(room, places.sum::<u32>());
            }
        }
        let has_floor = |room: &usize| {
            let floor = (self.building.rooms[*room].plan.net_area_m2 / STANDING_M2).max(1.0) as u32;
            let line = lines.get(room).copied().filter(|places| *places > 0);
            let most = line.map_or(floor, |places| TURNS * places.min(floor));
            self.crowd.get(room).is_none_or(|n| *n < most)
        };
        let with_floor =
            |rooms: &[usize]| rooms.iter().copied().filter(has_floor).take(NEAREST).collect::<Vec<usize>>();
        // where all are full, nobody goes
        let near = rooms.iter().map(|(_, rooms)| with_floor(rooms)).find(|near| !near.is_empty())?;
        let room = *stream.pick(&near)?;
        if lines.get(&room).is_some_and(|places| *places > 0) {
            *self.crowd.entry(room).or_default() += 1;
        }
        Some(self.in_room(room, step, stream))
    }

    /// Returns the step in a room: at what is free there when one gets there, where the act needs an object, else standing.
    fn in_room(&mut self, room: usize, step: &RoundStep, stream: &mut Stream) -> Step {
        let place = self.of_room(room, step.act).first().map(|s| s.before);
        let act = match (step.act, place) {
            (act, None) if act.affordance().is_some() => Act::Stand,
            (act, _) => act,
        };
        let pose = match place {
            Some(pose) => pose,
            None => {
                *self.crowd.entry(room).or_default() += 1;
                self.spot(room, act == Act::Talk, stream)
            }
        };
        let room_id = self.building.rooms[room].plan.room_id.clone();
        Step { room_id, act, pose, seconds: seconds(step, stream), station: None, with: None }
    }

    /// Returns where somebody stands in a room: away from others, or beside those who talk.
    fn spot(&mut self, room: usize, talks: bool, stream: &mut Stream) -> Pose {
        let here = &self.building.rooms[room];
        let level = self.building.grounds[here.ground].level;
        let taken = |p: Point| {
            let people =
                self.stood.iter().chain(&self.begun).filter(|(other, _)| *other == level).map(|(_, o)| o.distance(p));
            let robots =
                self.robots.iter().filter(|(other, ..)| *other == level).map(|(_, o, r)| o.distance(p) - r + 0.25);
            people.chain(robots).fold(f64::MAX, f64::min)
        };
        let tries: Vec<Point> = (0..TRIES).filter_map(|_| stream.pick(&here.spots).copied()).collect();
        // those who talk stand close, but not too close
        let talking = |p: &Point| talks && (TALK_M - 0.2..TALK_M + 0.6).contains(&taken(*p));
        let apart = |p: &Point| taken(*p) >= STAND_APART_M;
        let best = tries.iter().copied().find(talking).or_else(|| tries.iter().copied().find(apart));
        let best = best.or_else(|| tries.iter().copied().max_by(|a, b| taken(*a).total_cmp(&taken(*b))));
        // a room that is known has a spot
        let at = best.or_else(|| here.spots.first().copied()).unwrap_or(here.plan.net_polygon.bounds().center());
        let partner = self.stood.iter().filter(|(other, p)| talks && *other == level && p.distance(at) < 2.0 * TALK_M);
        let partner = partner.map(|(_, p)| *p).min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)));
        self.stood.push((level, at));
        facing(at, partner.unwrap_or(here.plan.net_polygon.bounds().center()))
    }

    /// Returns the step to a person: to where one stands beside its bed or seat, or near where it begins.
    fn to_person(&self, agent: &Agent, step: &RoundStep, stream: &mut Stream) -> Step {
        let room_id = agent.steps.first().map_or_else(String::new, |s| s.room_id.clone());
        let act = if step.act.affordance().is_some() { Act::Stand } else { step.act };
        Step {
            room_id,
            act,
            pose: agent.start,
            seconds: seconds(step, stream),
            station: None,
            with: Some(agent.agent_id.clone()),
        }
    }
}

/// Returns the people of a role who begin in one of some rooms.
fn of_role<'p>(known: &[&'p Agent], role: &str, allowed: &BTreeSet<&str>) -> Vec<&'p Agent> {
    known.iter().copied().filter(|a| a.role == role && is_in(a, allowed)).collect()
}

/// Returns true for a person who begins in one of some rooms.
fn is_in(agent: &Agent, allowed: &BTreeSet<&str>) -> bool {
    agent.steps.first().is_some_and(|s| allowed.contains(s.room_id.as_str()))
}

fn seconds(step: &RoundStep, stream: &mut Stream) -> f64 {
    let [low, high] = step.seconds;
    (low + (high - low) * stream.unit()).round()
}
