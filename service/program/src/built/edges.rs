//! How the rooms connect: circulation, hosts, what the prompt asks for, and the domain's adjacency rules.

use d3dgen_knowledge::jurisdiction::rules_here;
use d3dgen_model::domain::{Adjacency, AdjacencyRelation};
use d3dgen_model::scene_graph::{BY_CIRCULATION, BY_HOST, BY_PROMPT, BY_STYLE, Connector, GraphEdge, GraphRoom, Note};
use d3dgen_model::style::LayoutStyle;

use super::hosts::{are_public, is_beside};
use super::rooms;
use crate::built::growth::{hub_hall, way_through};
use crate::built::planned::Planned;
use crate::named::compounds::opens_to;
use crate::named::numbered::is_meant;
use crate::reading::Reading;
use crate::wished::relations::Spread;
use crate::wished::wishes::{Apart, Pair};

/// Rooms that one room can be asked to be beside: those at its two ends and one at its back. More are wished for only.
const MOST_WALLS: usize = 3;
/// The same of rooms of one type: a room stands in one row of such.
const MOST_ALIKE: usize = 2;
/// Names of a note, at most.
const MOST_NAMED: usize = 6;

/// Edges and pairs to keep apart.
#[derive(Debug, Default)]
pub(crate) struct Web {
    pub edges: Vec<GraphEdge>,
    pub apart: Vec<[String; 2]>,
}

/// Connects the rooms; adds the corridor where the building needs one.
pub(crate) fn connect(reading: &mut Reading, planned: &[Planned], rooms: &mut Vec<GraphRoom>) -> Web {
    let hub = hub(reading, planned, rooms);
    Web::around(reading, planned, rooms, hub, true)
}

/// States the pairs of the prompt that came to nothing: of rooms on different storeys, or of one that is not there.
pub(crate) fn state_unmet(reading: &mut Reading, rooms: &[GraphRoom], edges: &[GraphEdge]) {
    let mut unmet = Vec::new();
    for pair in reading.wishes.pairs.iter().filter(|p| !p.belongs && ruled_out(reading, p).is_none()) {
        let (from, to) = (of_kind(rooms, &pair.a, pair.which[0]), of_kind(rooms, &pair.b, pair.which[1]));
        let joins = |e: &GraphEdge| {
            let is = |all: &[usize], id: &String| all.iter().any(|&i| &rooms[i].id == id);
            is(&from, &e.a) && is(&to, &e.b) || is(&from, &e.b) && is(&to, &e.a)
        };
        if edges.iter().any(joins) {
            continue;
        }
        let [a, b] = [(&pair.a, pair.which[0]), (&pair.b, pair.which[1])].map(|(id, n)| {
            let number = n.map_or(String::new(), |n| format!(" {n}"));
            format!("{}{number}", id.replace('_', " "))
        });
        let why = match (from.as_slice(), to.as_slice()) {
            ([], _) => format!("no {a} was planned"),
            (_, []) => format!("no {b} was planned"),
            ([i, ..], [j, ..]) if rooms[*i].level != rooms[*j].level => "they are on different storeys".to_owned(),
            _ => "there is only one of them".to_owned(),
        };
        unmet.push(Note::new("not_beside", format!("{a} and {b} cannot be beside each other: {why}")));
    }
    reading.conflicts.extend(unmet);
}

/// Connects the rooms of one storey of several around its own corridor, which becomes the last of them.
pub(crate) fn connect_storey(
    reading: &mut Reading,
    planned: &[Planned],
    rooms: &mut Vec<GraphRoom>,
    corridor: GraphRoom,
    ground: bool,
) -> Web {
    let hub = rooms.len();
    rooms.push(corridor);
    Web::around(reading, planned, rooms, hub, ground)
}

/// Returns the index of the room all others open to: a hub of the domain, a new corridor, or the only room.
fn hub(reading: &mut Reading, planned: &[Planned], rooms: &mut Vec<GraphRoom>) -> usize {
    let circulation = &reading.domain.circulation;
    let by_type = hub_hall(reading, planned).or_else(|| way_through(reading, planned));
    let free: Vec<usize> = (0..planned.len()).filter(|&i| planned[i].host.is_none()).collect();
    let forbidden = reading.wishes.forbidden.contains(&circulation.room_type);
    match (by_type, free.as_slice()) {
        (Some(hub), _) => hub,
        (None, [only]) => *only,
        _ => {
            if forbidden {
                let message = format!(
                    "{} rooms cannot be reached without a {}; one was added",
                    free.len(),
                    circulation.room_type
                );
                reading.conflicts.push(Note::new("circulation_needed", message));
                // what the building cannot do without is not ruled out any more
                reading.wishes.forbidden.retain(|f| f != &circulation.room_type);
            }
            rooms.push(rooms::circulation(reading));
            rooms.len() - 1
        }
    }
}

impl Web {
    /// Connects the rooms around one of them, which one enters the building through unless the prompt or domain has another
    /// one for that. Storeys off the ground have no entrance.
    fn around(
        reading: &mut Reading,
        planned: &[Planned],
        rooms: &mut [GraphRoom],
        hub: usize,
        has_entrance: bool,
    ) -> Self {
        let mut web = Self::default();
        web.circulate(planned, rooms, hub);
        if has_entrance {
            choose_entrance(reading, rooms, hub);
        }
        keep_apart(reading, rooms, &mut web);
        web.follow_prompt(reading, planned, rooms, hub);
        web.stay_near_entrance(reading, rooms);
        web.open_named(reading, planned, rooms);
        web.open_up(reading, rooms);
        web.follow_rules(reading, rooms);
        web
    }

    fn put(&mut self, rooms: &[GraphRoom], (a, b): (usize, usize), connector: Connector, required: bool, reason: &str) {
        let (a, b) = (rooms[a].id.clone(), rooms[b].id.clone());
        let same = |e: &&mut GraphEdge| e.a == a && e.b == b || e.a == b && e.b == a;
        let walkable = |c| matches!(c, Connector::Door | Connector::Open);
        match self.edges.iter_mut().find(same) {
            // a door already joins them; an opening asked for takes its place
            Some(known) if walkable(known.connector) => {
                if required && (connector == Connector::Open || !known.required) {
                    known.connector = if walkable(connector) { connector } else { known.connector };
                    known.required |= walkable(connector);
                    known.reason = reason.into();
                }
            }
            // a wall asked for does not rule out a door in it
            Some(known) if known.required && walkable(connector) => {
                self.edges.push(GraphEdge { a, b, connector, required, reason: reason.into() });
            }
            Some(known) if known.required || !required => {}
            Some(known) => *known = GraphEdge { a, b, connector, required, reason: reason.into() },
            None => self.edges.push(GraphEdge { a, b, connector, required, reason: reason.into() }),
        }
    }

    fn circulate(&mut self, planned: &[Planned], rooms: &[GraphRoom], hub: usize) {
        for (i, room) in planned.iter().enumerate().filter(|(i, _)| *i != hub) {
            let open = room.kind.open_front && room.host.is_none();
            let connector = if open { Connector::Open } else { Connector::Door };
            let reason = if room.host.is_some() { BY_HOST } else { BY_CIRCULATION };
            self.put(rooms, (i, room.host.unwrap_or(hub)), connector, true, reason);
        }
    }

    fn has_apart(&self, a: &str, b: &str) -> bool {
        self.apart.iter().any(|[x, y]| x == a && y == b || x == b && y == a)
    }

    /// Adds what the prompt asks for.
    fn follow_prompt(&mut self, reading: &mut Reading, planned: &[Planned], rooms: &[GraphRoom], hub: usize) {
        let mut left: Vec<Left> = Vec::new();
        for pair in reading.wishes.pairs.clone() {
            let (from, to) = (of_kind(rooms, &pair.a, pair.which[0]), of_kind(rooms, &pair.b, pair.which[1]));
            let hangs = |i: usize, j: usize| planned.get(i).is_some_and(|p| p.host == Some(j));
            let met = from.iter().all(|&i| to.iter().any(|&j| hangs(i, j) || hangs(j, i)));
            if from.is_empty() || to.is_empty() || met {
                continue;
            }
            if pair.belongs {
                let beside = are_public(reading, &pair) || is_beside(reading, &pair);
                let pairs = if beside { spread(rooms, &from, &to, Spread::Each) } else { Vec::new() };
                for (i, j) in pairs {
                    if !self.has_apart(&rooms[i].id, &rooms[j].id) {
                        self.put(rooms, (i, j), Connector::Door, false, BY_PROMPT);
                    }
                }
                continue;
            }
            if let Some(rule) = ruled_out(reading, &pair) {
                let Adjacency { via, reason, source, .. } = rule;
                let message = format!("{} and {} may not be joined by a {via}: {reason} ({source})", pair.a, pair.b);
                reading.conflicts.push(Note::new("forbidden_adjacency", message));
                continue;
            }
            let near = pair.connector == Connector::Near;
            for (i, j) in spread(rooms, &from, &to, pair.spread) {
                if self.has_apart(&rooms[i].id, &rooms[j].id) {
                    continue;
                }
                let is_full = |k: usize, other: usize| {
                    let beside = self.neighbors(rooms, k);
                    let alike = beside.iter().filter(|r| r.room_type == rooms[other].room_type).count();
                    k != hub && (alike >= MOST_ALIKE || beside.len() >= MOST_WALLS)
                };
                let free = near || self.joins(rooms, (i, j));
                let full = [(i, j), (j, i)].into_iter().find(|&(k, other)| !free && is_full(k, other)).map(|f| f.0);
                let connector = if full.is_some() { Connector::Near } else { pair.connector };
                self.put(rooms, (i, j), connector, connector != Connector::Near, BY_PROMPT);
                if let Some(k) = full {
                    Left::add(&mut left, k, if k == i { j } else { i });
                }
            }
        }
        for crowd in left {
            reading.conflicts.push(crowd.note(self, rooms));
        }
    }

    /// Returns the rooms that the prompt has beside a room.
    fn neighbors<'r>(&self, rooms: &'r [GraphRoom], room: usize) -> Vec<&'r GraphRoom> {
        let id = &rooms[room].id;
        let beside = self.edges.iter().filter(|e| e.required && e.reason == BY_PROMPT && (&e.a == id || &e.b == id));
        let others: Vec<&String> = beside.map(|e| if &e.a == id { &e.b } else { &e.a }).collect();
        if others.is_empty() { Vec::new() } else { rooms.iter().filter(|r| others.contains(&&r.id)).collect() }
    }

    /// Returns true where an edge that must be joins two rooms already.
    fn joins(&self, rooms: &[GraphRoom], (i, j): (usize, usize)) -> bool {
        let (a, b) = (&rooms[i].id, &rooms[j].id);
        self.edges.iter().any(|e| e.required && (&e.a == a && &e.b == b || &e.a == b && &e.b == a))
    }

    /// Wishes for rooms near the entrance that the prompt wants there, where they are on its storey.
    fn stay_near_entrance(&mut self, reading: &Reading, rooms: &[GraphRoom]) {
        let Some(entrance) = rooms.iter().find(|r| r.entrance) else { return };
        let near = rooms.iter().filter(|r| reading.wishes.by_entrance.contains(&r.room_type) && r.id != entrance.id);
        let edges = near.map(|r| GraphEdge {
            a: r.id.clone(),
            b: entrance.id.clone(),
            connector: Connector::Near,
            required: false,
            reason: BY_PROMPT.into(),
        });
        self.edges.extend(edges);
    }

    /// Opens the rooms that the prompt calls open to the first of those that an open layout joins them to.
    fn open_named(&mut self, reading: &Reading, planned: &[Planned], rooms: &[GraphRoom]) {
        let of = |kind: &str| (0..rooms.len()).filter(|&i| rooms[i].room_type == kind).collect::<Vec<_>>();
        for id in &reading.wishes.open {
            let met = |i: usize| {
                let joined = |e: &GraphEdge| e.connector == Connector::Open && e.required;
                self.edges.iter().any(|e| joined(e) && (e.a == rooms[i].id || e.b == rooms[i].id))
            };
            let from: Vec<usize> = of(id).into_iter().filter(|&i| !met(i)).collect();
            let Some(to) = opens_to(reading.domain, id).map(|p| of(p)).find(|to| !to.is_empty()) else { continue };
            for (i, j) in spread(rooms, &from, &to, Spread::Each) {
                let free = [i, j].iter().all(|&k| planned.get(k).is_none_or(|p| p.host.is_none()));
                if free && !self.has_apart(&rooms[i].id, &rooms[j].id) {
                    self.put(rooms, (i, j), Connector::Open, true, BY_PROMPT);
                }
            }
        }
    }

    /// Joins the rooms that flow into each other in an open layout.
    fn open_up(&mut self, reading: &Reading, rooms: &[GraphRoom]) {
        if reading.style.layout != Some(LayoutStyle::Open) {
            return;
        }
        let closed = |id: &String| reading.wishes.closed.contains(id);
        for [a, b] in reading.domain.layouts.open_joins.iter().filter(|[a, b]| !closed(a) && !closed(b)) {
            let of = |kind: &str| -> Vec<usize> { (0..rooms.len()).filter(|&i| rooms[i].room_type == kind).collect() };
            for (i, j) in spread(rooms, &of(a), &of(b), Spread::Each) {
                if !self.has_apart(&rooms[i].id, &rooms[j].id) {
                    self.put(rooms, (i, j), Connector::Open, true, BY_STYLE);
                }
            }
        }
    }

    /// Returns true when required doors lead from one room to another past the circulation.
    fn has_way(&self, from: &str, to: &str) -> bool {
        let walk = |e: &&GraphEdge| {
            e.required && e.reason != BY_CIRCULATION && matches!(e.connector, Connector::Door | Connector::Open)
        };
        let mut reached = vec![from];
        let mut next = 0;
        while let Some(&at) = reached.get(next) {
            next += 1;
            for e in self.edges.iter().filter(walk).filter(|e| e.a == at || e.b == at) {
                let other = if e.a == at { e.b.as_str() } else { e.a.as_str() };
                if !reached.contains(&other) {
                    reached.push(other);
                }
            }
        }
        reached.contains(&to)
    }

    /// Returns the rooms of the second that have none of the first yet, each with one that serves two: a room to scrub
    /// between two operating rooms.
    fn shared(&self, rooms: &[GraphRoom], from: &[usize], to: &[usize]) -> Vec<(usize, usize)> {
        let joins = |i: usize, j: usize| {
            let walk = |e: &&GraphEdge| e.required && matches!(e.connector, Connector::Door | Connector::Open);
            let (a, b) = (&rooms[i].id, &rooms[j].id);
            self.edges.iter().filter(walk).any(|e| &e.a == a && &e.b == b || &e.a == b && &e.b == a)
        };
        let mut out: Vec<(usize, usize)> = Vec::new();
        for &j in to.iter().filter(|&&j| !from.iter().any(|&i| joins(i, j))) {
            let serves = |i: usize| to.iter().filter(|&&k| joins(i, k) || out.contains(&(i, k))).count();
            let free = from.iter().copied().find(|&i| serves(i) < 2 && rooms[i].unit == rooms[j].unit);
            let free = free.filter(|&i| !self.has_apart(&rooms[i].id, &rooms[j].id));
            out.extend(free.map(|i| (i, j)));
        }
        out
    }

    /// Adds the domain's rules: `must` as required edges, `should` as wishes.
    fn follow_rules(&mut self, reading: &Reading, rooms: &[GraphRoom]) {
        for rule in rules_here(reading.domain, reading.country_code.as_deref()) {
            let required = match rule.relation {
                AdjacencyRelation::Must => true,
                AdjacencyRelation::Should => false,
                AdjacencyRelation::ShouldNot | AdjacencyRelation::MustNot => continue,
            };
            let of = |kind: &str| -> Vec<usize> { (0..rooms.len()).filter(|&i| rooms[i].room_type == kind).collect() };
            let (from, to) = (of(&rule.a), of(&rule.b));
            if from.is_empty() || to.is_empty() || rule.a == rule.b {
                continue;
            }
            let connector = match connector(&rule.via) {
                Connector::Open
                    if reading.style.layout == Some(LayoutStyle::Cellular)
                        || [&rule.a, &rule.b].iter().any(|id| reading.wishes.closed.contains(id)) =>
                {
                    Connector::Door
                }
                usual => usual,
            };
            for (i, j) in spread(rooms, &from, &to, Spread::Each) {
                let joined = |e: &GraphEdge| {
                    let walk = matches!(e.connector, Connector::Door | Connector::Open);
                    let other = if e.a == rooms[i].id { &e.b } else { &e.a };
                    let touches = e.a == rooms[i].id || e.b == rooms[i].id;
                    walk && e.required && touches && to.iter().any(|&k| &rooms[k].id == other)
                };
                if !self.edges.iter().any(joined) && !self.has_apart(&rooms[i].id, &rooms[j].id) {
                    self.put(rooms, (i, j), connector, required && connector != Connector::Near, &rule.source);
                }
            }
            if required && connector == Connector::Door {
                for (i, j) in self.shared(rooms, &from, &to) {
                    // doors in a ring seldom have a plan
                    let open = !self.has_way(&rooms[i].id, &rooms[j].id);
                    self.put(rooms, (i, j), connector, open, &rule.source);
                }
            }
        }
    }
}

/// A room that was to be beside more others than its walls have place for.
struct Left {
    room: usize,
    others: Vec<usize>,
}

impl Left {
    fn add(all: &mut Vec<Self>, room: usize, other: usize) {
        match all.iter_mut().find(|l| l.room == room) {
            Some(known) => known.others.push(other),
            None => all.push(Self { room, others: vec![other] }),
        }
    }

    /// Returns what was planned instead.
    fn note(&self, web: &Web, rooms: &[GraphRoom]) -> Note {
        let room = &rooms[self.room];
        let beside = web.neighbors(rooms, self.room).len();
        let named: Vec<&str> = self.others.iter().take(MOST_NAMED).map(|&i| rooms[i].name.as_str()).collect();
        let more = if self.others.len() > named.len() { ", ..." } else { "" };
        let message = format!(
            "{} was to be beside {} rooms; its walls take {beside} of them, the other {} were kept near: {}{more}",
            room.name,
            beside + self.others.len(),
            self.others.len(),
            named.join(", "),
        );
        Note::new("too_many_neighbors", message)
    }
}

/// Returns the rooms of a type, or the one of them with a number of its own.
fn of_kind(rooms: &[GraphRoom], kind: &str, number: Option<u32>) -> Vec<usize> {
    (0..rooms.len()).filter(|&i| is_meant(&rooms[i], kind, number)).collect()
}

/// Returns the rule of the domain that rules out what a pair asks for.
fn ruled_out<'d>(reading: &Reading<'d>, pair: &Pair) -> Option<&'d Adjacency> {
    let mut rules = rules_here(reading.domain, reading.country_code.as_deref());
    let forbids = |rule: &&Adjacency| {
        let via = rule.via == "wall" || pair.connector != Connector::Wall;
        rule.relation == AdjacencyRelation::MustNot && is_pair(rule, &pair.a, &pair.b) && via
    };
    rules.find(forbids).filter(|_| pair.connector != Connector::Near)
}

fn is_pair(rule: &Adjacency, a: &str, b: &str) -> bool {
    rule.a == a && rule.b == b || rule.a == b && rule.b == a
}

fn connector(via: &str) -> Connector {
    match via {
        "door" => Connector::Door,
        "open" => Connector::Open,
        "wall" => Connector::Wall,
        _ => Connector::Near,
    }
}

/// Returns the pairs of rooms that a pair of room types stands for, those of one unit with each other where they can.
fn spread(rooms: &[GraphRoom], from: &[usize], to: &[usize], how: Spread) -> Vec<(usize, usize)> {
    if from.is_empty() || to.is_empty() {
        return Vec::new();
    }
    let mut out: Vec<(usize, usize)> = match how {
        Spread::All => from.iter().flat_map(|&i| to.iter().map(move |&j| (i, j))).collect(),
        Spread::Between => from.iter().flat_map(|&i| to.iter().take(2).map(move |&j| (i, j))).collect(),
        Spread::Each => each_with_one(rooms, from, to),
    };
    // rooms of one type beside each other: a chain
    if from == to {
        out = from.windows(2).map(|w| (w[0], w[1])).collect();
    }
    out.retain(|(i, j)| i != j);
    out
}

/// Returns every room of the first with one of the second, evenly spread over those of its unit.
fn each_with_one(rooms: &[GraphRoom], from: &[usize], to: &[usize]) -> Vec<(usize, usize)> {
    let mut out = Vec::with_capacity(from.len());
    for part in from.chunk_by(|&a, &b| rooms[a].unit == rooms[b].unit) {
        let near: Vec<usize> = to.iter().copied().filter(|&j| rooms[j].unit == rooms[part[0]].unit).collect();
        let to = if near.is_empty() { to } else { &near };
        out.extend(part.iter().enumerate().map(|(k, &i)| (i, to[k * to.len().min(part.len()) / part.len()])));
    }
    out
}

/// Marks the room one enters the building through.
fn choose_entrance(reading: &mut Reading, rooms: &mut [GraphRoom], hub: usize) {
    let of = |kind: &String| rooms.iter().position(|r| &r.room_type == kind);
    let wished = reading.wishes.entrance.iter().find_map(of);
    let usual = reading.domain.circulation.entrance_room_types.iter().find_map(of);
    rooms[wished.or(usual).unwrap_or(hub)].entrance = true;
}

/// Lists the pairs that share neither door nor wall: those the prompt names, and those the domain rules out.
fn keep_apart(reading: &mut Reading, rooms: &[GraphRoom], web: &mut Web) {
    let rules = rules_here(reading.domain, reading.country_code.as_deref());
    let walls = rules.filter(|r| r.relation == AdjacencyRelation::MustNot && r.via == "wall");
    let ruled = walls.map(|r| Apart { rooms: [r.a.clone(), r.b.clone()], which: [None, None] });
    let pairs: Vec<Apart> = reading.wishes.apart.iter().cloned().chain(ruled).collect();
    for Apart { rooms: [a, b], which } in pairs {
        let (from, to) = (of_kind(rooms, &a, which[0]), of_kind(rooms, &b, which[1]));
        for (x, y) in
            from.iter().flat_map(|&i| to.iter().filter(move |&&j| j != i).map(move |&j| (&rooms[i], &rooms[j])))
        {
            let joined = web.edges.iter().any(|e| e.a == x.id && e.b == y.id || e.a == y.id && e.b == x.id);
            if joined {
                let message = format!("{} and {} cannot be apart: one is entered through the other", x.name, y.name);
                reading.conflicts.push(Note::new("apart_but_joined", message));
            } else if !web.has_apart(&x.id, &y.id) {
                web.apart.push([x.id.clone(), y.id.clone()]);
            }
        }
    }
}
