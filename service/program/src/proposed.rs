//! Scene graphs out of proposals: what the prompt states goes first, then what is proposed, then what the building needs.
//!
//! A proposal is unchecked words of somebody else (a language model). It chooses rooms where the prompt leaves them open,
//! their areas and their objects, and wishes for connections; counts, types and bans of the prompt are not its business,
//! nor are corridors and stairs, which follow from the plan. Every proposed thing is accounted for.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_knowledge::jurisdiction::rules_here;
use d3dgen_model::domain::{AdjacencyRelation, Domain, GENERIC_ROOM_TYPE, RoomType};
use d3dgen_model::offer::suits;
use d3dgen_model::proposal::{Fate, ItemKind, ProposedItem};
use d3dgen_model::scene_graph::{Connector, GraphEdge, SceneGraph};
use d3dgen_model::stage::Error;
use d3dgen_plugins::Registry;

use super::built::occupants;
use super::built::program;
use super::built::rooms::wished_assets;
use super::built::vital;
use super::given::Names;
use super::reading::Reading;
use crate::built::growth::{circulation_share, may_grow};
use crate::built::planned::Planned;
use crate::read;
use crate::request::{MAX_ROOMS, Request};
use crate::settle::settle;

/// Reason of the edges that a proposal wishes for.
pub const BY_PROPOSAL: &str = "proposal";

/// Most connections that a proposal may wish for at one room.
const MOST_EDGES: usize = 4;
/// Most objects that a proposal may name for one room.
const MOST_OBJECTS: usize = 15;
/// Share by which an area is still the one proposed.
const SAME_AREA: f64 = 0.1;

/// What somebody proposes for a scene graph.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Draft {
    /// Rooms.
    pub rooms: Vec<DraftRoom>,
    /// Connections.
    pub edges: Vec<DraftEdge>,
}

/// A proposed room.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DraftRoom {
    /// The proposal's own name of it, for its edges.
    pub id: String,
    /// Room type id, or words for it.
    pub room_type: String,
    /// Name for people; tells the type where `room_type` does not.
    pub name: String,
    /// Net floor area, m^2.
    pub area_m2: Option<f64>,
    /// Object ids, or words for them.
    pub objects: Vec<String>,
}

/// A proposed connection.
#[derive(Debug, Clone, PartialEq)]
pub struct DraftEdge {
    /// Id of a proposed room.
    pub a: String,
    /// Id of a proposed room.
    pub b: String,
    /// How they meet.
    pub connector: Connector,
}

/// A proposal with the graph it became.
#[derive(Debug, Clone, PartialEq)]
pub struct Settled {
    /// The graph.
    pub graph: SceneGraph,
    /// What became of each proposed thing; edges that are wishes count as kept until there is a plan.
    pub items: Vec<ProposedItem>,
}

/// Turns a request into a scene graph with what a proposal adds to it.
///
/// # Errors
/// As [`super::generate`]; the proposal itself is never an error.
pub fn propose(request: &Request, registry: &Registry, draft: &Draft) -> Result<Settled, Error> {
    let mut reading = read::read(request, registry)?;
    let own = program::complete(&mut reading.clone());
    let mut chosen = Choice::new(&reading, &own, draft);
    chosen.take_what_the_prompt_asks_for();
    chosen.take_what_the_building_needs();
    chosen.take_what_is_proposed();
    chosen.fill_up();
    let Choice { mut rooms, mut sources, mut items, .. } = chosen;
    if sources.iter().all(Option::is_none) {
        // nothing proposed is of use: the building is the one without a proposal
        return Ok(Settled { graph: super::generate(request, registry)?, items });
    }
    add_vital(&mut reading, &mut rooms, &mut sources, &mut items);
    let mut planned = program::finish(&mut reading, rooms);
    let mut graph = settle(request, registry, &mut reading, &mut planned);
    let ids = ids(&planned);
    for (room, source) in sources.iter().enumerate() {
        let (Some(source), Some(id)) = (source, ids.get(room)) else { continue };
        let Some(item) = items.get_mut(*source) else { continue };
        name_room(item, &draft.rooms[*source], id, &graph);
    }
    let mut extra = objects(&mut graph, reading.domain, draft, &sources, &ids);
    let by_draft = by_draft(draft, &sources, &ids, &items, &graph);
    let edges = wish_for_edges(&mut graph, &reading, draft, &by_draft);
    // rooms that were added come after those that were proposed
    for (room, id) in ids.iter().enumerate().filter(|(i, _)| sources.get(*i).is_none_or(Option::is_none)) {
        let asked = planned[room].requested;
        let reason = if asked { "the prompt asks for it" } else { "such a building has it" };
        items.push(ProposedItem { id: Some(id.clone()), ..item(ItemKind::Room, id, Fate::Added, reason) });
    }
    items.append(&mut extra);
    items.extend(edges);
    Ok(Settled { graph, items })
}

/// Adds what such a building is not without and the proposal left out; where the number of rooms is fixed, in place of what
/// can be spared.
fn add_vital<'a>(
    reading: &mut Reading<'a>,
    rooms: &mut Vec<Planned<'a>>,
    sources: &mut Vec<Option<usize>>,
    items: &mut [ProposedItem],
) {
    let before: Vec<String> = rooms.iter().map(|r| r.room_type.clone()).collect();
    vital::accompany(reading, rooms);
    vital::complete(reading, rooms);
    sources.resize(rooms.len(), None);
    for (room, old) in before.iter().enumerate().filter(|(i, old)| &rooms[*i].room_type != *old) {
        let Some(item) = sources[room].take().and_then(|s| items.get_mut(s)) else { continue };
        item.fate = Fate::Dropped;
        let label = rooms[room].kind.label.to_lowercase();
        item.reason =
            format!("such a building is not without a {label}, which takes the place of the {}", old.replace('_', " "));
    }
}

fn item(kind: ItemKind, proposed: &str, fate: Fate, reason: impl Into<String>) -> ProposedItem {
    let (proposed, reason) = (proposed.to_owned(), reason.into());
    ProposedItem { kind, proposed, fate, id: None, from: None, to: None, rule: None, reason }
}

/// Returns the ids that rooms get in a graph, in their order.
fn ids(planned: &[Planned]) -> Vec<String> {
    let mut seen: BTreeMap<&str, u32> = BTreeMap::new();
    let mut out = Vec::with_capacity(planned.len());
    for room in planned {
        let n = seen.entry(&room.room_type).or_default();
        *n += 1;
        out.push(format!("{}_{n}", room.room_type));
    }
    out
}

/// The choice of rooms.
struct Choice<'r, 'a> {
    reading: &'r Reading<'a>,
    own: &'r [Planned<'a>],
    draft: &'r Draft,
    /// By proposed room: its type, while nobody has taken or refused it.
    open: Vec<Option<&'a RoomType>>,
    rooms: Vec<Planned<'a>>,
    /// By chosen room: the proposed one.
    sources: Vec<Option<usize>>,
    items: Vec<ProposedItem>,
}

impl<'r, 'a> Choice<'r, 'a> {
    fn new(reading: &'r Reading<'a>, own: &'r [Planned<'a>], draft: &'r Draft) -> Self {
        let domain = reading.domain;
        let names = Names::new(domain);
        let mut open = Vec::with_capacity(draft.rooms.len());
        let mut items = Vec::with_capacity(draft.rooms.len());
        for room in &draft.rooms {
            let mut item = item(ItemKind::Room, &room.id, Fate::Dropped, "");
            let found = names.find(&room.room_type).or_else(|| names.find(&room.name)).map(|f| f.0);
            let mut kind = found.and_then(|id| domain.room_type(id)).filter(|k| k.id != GENERIC_ROOM_TYPE);
            match kind {
                None => item.reason = format!("domain {} knows no such room type", domain.id),
                Some(k) if is_circulation(domain, &k.id) => {
                    item.fate = Fate::Replaced;
                    item.reason = "corridors and stairs follow from the plan".into();
                    kind = None;
                }
                Some(k) if reading.wishes.forbidden.contains(&k.id) => {
                    item.rule = Some("room_forbidden".into());
                    item.reason = "the prompt rules it out".into();
                    kind = None;
                }
                Some(_) => {}
            }
            open.push(kind);
            items.push(item);
        }
        Self { reading, own, draft, open, rooms: Vec::new(), sources: Vec::new(), items }
    }

    fn count(&self, room_type: &str) -> usize {
        self.rooms.iter().filter(|r| r.room_type == room_type).count()
    }

    fn own_count(&self, room_type: &str) -> usize {
        self.own.iter().filter(|r| r.room_type == room_type).count()
    }

    /// Takes the first open proposal of a room type for a room.
    fn push(&mut self, mut room: Planned<'a>) {
        let source = self.open.iter().position(|k| k.is_some_and(|k| k.id == room.room_type));
        if let Some(source) = source {
            self.open[source] = None;
            self.items[source].fate = Fate::Kept;
            let range = room.kind.area_m2;
            let area = self.draft.rooms[source].area_m2.filter(|a| a.is_finite() && *a > 0.0);
            room.proposed_area_m2 = area.map(|a| a.clamp(range.min, range.max));
        }
        room.host = None;
        if self.reading.program.rooms.iter().any(|e| e.room_type == room.room_type) {
            // people are spread over all rooms of the type once these are settled
            (room.occupants, room.people_area_m2) = (None, None);
        }
        self.rooms.push(room);
        self.sources.push(source);
    }

    fn take_what_the_prompt_asks_for(&mut self) {
        for room in self.own.iter().filter(|r| r.requested) {
            self.push(room.clone());
        }
    }

    /// Takes the rooms that the program cannot do without, and those that head counts ask for.
    fn take_what_the_building_needs(&mut self) {
        for room in self.own.iter().filter(|r| !r.requested) {
            let entry = self.reading.program.rooms.iter().find(|e| e.room_type == room.room_type);
            let own = self.own_count(&room.room_type);
            let counted = occupants::is_counted(self.reading, &room.room_type);
            let least = if counted { own } else { own.min(entry.map_or(0, |e| e.min as usize)) };
            if self.count(&room.room_type) < least {
                self.push(room.clone());
            }
        }
    }

    /// Returns how many rooms there may be.
    fn capacity(&self) -> usize {
        let own = self.own.len();
        match (self.reading.total, self.reading.closed) {
            (Some(total), _) => total as usize,
            (None, true) => own,
            (None, false) => (own + own / 2 + 2).min(MAX_ROOMS as usize),
        }
    }

    /// Takes what is proposed beyond that, where the prompt leaves it open.
    fn take_what_is_proposed(&mut self) {
        let capacity = self.capacity();
        let area = self.reading.area_m2.map(|a| a * (1.0 - circulation_share(self.reading, self.own)));
        for source in 0..self.open.len() {
            let Some(kind) = self.open[source] else { continue };
            let (have, own) = (self.count(&kind.id), self.own_count(&kind.id));
            let entry = self.reading.program.rooms.iter().find(|e| e.room_type == kind.id);
            let usual = entry.map_or(0, |e| e.max as usize).min(2 * own + 2).max(own).max(1);
            let least: f64 = self.rooms.iter().map(|r| r.kind.area_m2.min).sum();
            let reason = if self.reading.closed && self.reading.total.is_none() && have >= own {
                "the prompt lists all rooms there are to be".to_owned()
            } else if self.rooms.len() >= capacity {
                format!("{capacity} rooms are as many as the prompt asks for or such a building has")
            } else if have >= own && !may_grow(self.reading, &kind.id) {
                "the prompt says how many of these there are".to_owned()
            } else if have >= usual {
                format!("{have} of these are as many as such a building has")
            } else if area.is_some_and(|a| 1.1 * (least + kind.area_m2.min) > a) {
                "the area that the prompt gives is used up".to_owned()
            } else {
                self.push(Planned::new(&kind.id, kind));
                continue;
            };
            self.open[source] = None;
            self.items[source].reason = reason;
        }
    }

    /// Fills up to the number of rooms that the prompt gives.
    fn fill_up(&mut self) {
        let wanted = self.reading.total.unwrap_or(0) as usize;
        for room in self.own {
            if self.rooms.len() < wanted && self.count(&room.room_type) < self.own_count(&room.room_type) {
                self.push(room.clone());
            }
        }
    }
}

/// Returns true for rooms that only join others.
fn is_circulation(domain: &Domain, room_type: &str) -> bool {
    let rules = &domain.circulation;
    rules.room_type == room_type || rules.storeys.as_ref().is_some_and(|s| s.joins(room_type))
}

/// Says what became of a room that was taken.
fn name_room(item: &mut ProposedItem, draft: &DraftRoom, id: &str, graph: &SceneGraph) {
    item.id = Some(id.to_owned());
    let Some(room) = graph.room(id) else { return };
    let mut said = Vec::new();
    if draft.room_type != room.room_type {
        said.push(format!("read as {}", room.room_type));
    }
    let area = room.target_area_m2;
    if draft.area_m2.is_some_and(|a| !a.is_finite() || (a - area).abs() > SAME_AREA * area.max(1.0)) {
        item.fate = Fate::Moved;
        let [min, max] = room.area_range_m2;
        said.push(format!(
            "{area} m2 were taken: the range is {min} to {max} m2, and the prompt's own figures go first"
        ));
    }
    item.reason = said.join("; ");
}

/// Returns the room of the graph for each proposed one that is there: circulation is the graph's own.
fn by_draft(
    draft: &Draft,
    sources: &[Option<usize>],
    ids: &[String],
    items: &[ProposedItem],
    graph: &SceneGraph,
) -> BTreeMap<String, String> {
    let mut out = BTreeMap::new();
    for (source, id) in sources.iter().zip(ids) {
        if let Some(room) = source.and_then(|s| draft.rooms.get(s)) {
            out.entry(room.id.clone()).or_insert_with(|| id.clone());
        }
    }
    let corridor = graph.rooms.iter().find(|r| r.circulation);
    for (room, item) in draft.rooms.iter().zip(items) {
        if let Some(corridor) = corridor.filter(|_| item.fate == Fate::Replaced) {
            out.entry(room.id.clone()).or_insert_with(|| corridor.id.clone());
        }
    }
    out
}

/// Puts the proposed objects first among those that rooms wish for.
fn objects(
    graph: &mut SceneGraph,
    domain: &Domain,
    draft: &Draft,
    sources: &[Option<usize>],
    ids: &[String],
) -> Vec<ProposedItem> {
    let mut items = Vec::new();
    for (source, id) in sources.iter().zip(ids) {
        let Some(wanted) = source.and_then(|s| draft.rooms.get(s)) else { continue };
        let Some(room) = graph.rooms.iter_mut().find(|r| &r.id == id) else { continue };
        let kind = domain.room_type_or_generic(&room.room_type);
        let mut named = Vec::new();
        for (n, word) in wanted.objects.iter().enumerate() {
            let mut item = item(ItemKind::Object, word, Fate::Dropped, "");
            match object(domain, word) {
                _ if n >= MOST_OBJECTS => item.reason = format!("a room has at most {MOST_OBJECTS} wishes"),
                None => item.reason = format!("domain {} knows no such object", domain.id),
                Some(object) if !suits(domain, kind, object) => {
                    item.reason = format!("`{object}` stands in no room like this one");
                }
                Some(object) => {
                    (item.fate, item.id) = (Fate::Kept, Some(format!("{id}/{object}")));
                    if !named.iter().any(|o| o == object) {
                        named.push(object.to_owned());
                    }
                }
            }
            items.push(item);
        }
        room.wished_assets = wished_assets(domain, kind, &named);
    }
    items
}

/// Returns the object that a word names: by id, label or keyword.
fn object<'a>(domain: &'a Domain, word: &str) -> Option<&'a str> {
    let plain = |s: &str| s.trim().to_lowercase().replace([' ', '-'], "_");
    let word = plain(word);
    let named = |o: &&d3dgen_model::domain::ObjectType| {
        o.id == word || plain(&o.label) == word || o.keywords.values().flatten().any(|k| plain(k) == word)
    };
    domain.object(&word).or_else(|| domain.objects.iter().find(named)).map(|o| o.id.as_str())
}

/// Adds the proposed connections that break nothing, as wishes.
fn wish_for_edges(
    graph: &mut SceneGraph,
    reading: &Reading,
    draft: &Draft,
    by_draft: &BTreeMap<String, String>,
) -> Vec<ProposedItem> {
    let mut items = Vec::new();
    let mut seen: BTreeSet<[String; 2]> = BTreeSet::new();
    for edge in &draft.edges {
        let mut item = item(ItemKind::Edge, &format!("{} - {}", edge.a, edge.b), Fate::Dropped, "");
        let ends = by_draft.get(&edge.a).zip(by_draft.get(&edge.b));
        let Some((a, b)) = ends.filter(|(a, b)| a != b) else {
            item.reason = match ends {
                Some(_) => "it joins a room to itself".into(),
                None => "one of its rooms is not there".into(),
            };
            items.push(item);
            continue;
        };
        item.id = Some(format!("{a} - {b}"));
        let pair = if a < b { [a.clone(), b.clone()] } else { [b.clone(), a.clone()] };
        if !seen.insert(pair) {
            item.reason = "it is there twice".into();
        } else {
            judge(&mut item, graph, reading, (a, b), edge.connector);
        }
        items.push(item);
    }
    items
}

/// Judges one connection, and adds it to the graph where it is new.
fn judge(item: &mut ProposedItem, graph: &mut SceneGraph, reading: &Reading, (a, b): (&str, &str), wanted: Connector) {
    let walkable = |c: Connector| matches!(c, Connector::Door | Connector::Open);
    let between = |e: &&GraphEdge| e.a == a && e.b == b || e.a == b && e.b == a;
    let of =
        |id: &str| graph.room(id).map_or((String::new(), 0, false), |r| (r.room_type.clone(), r.level, r.circulation));
    let ((type_a, level_a, way_a), (type_b, level_b, way_b)) = (of(a), of(b));
    if let Some(known) = graph.edges.iter().find(between) {
        item.fate = if known.connector == wanted { Fate::Kept } else { Fate::Replaced };
        if known.connector != wanted {
            item.reason = "the rooms are joined otherwise".into();
            item.rule = Some(known.reason.clone());
        }
        return;
    }
    let apart = graph.apart.iter().any(|[x, y]| x == a && y == b || x == b && y == a);
    let rule = rules_here(reading.domain, reading.country_code.as_deref()).find(|r| {
        let pair = r.a == type_a && r.b == type_b || r.a == type_b && r.b == type_a;
        let against = matches!(r.relation, AdjacencyRelation::MustNot | AdjacencyRelation::ShouldNot);
        pair && against && (r.via == "wall" || walkable(wanted))
    });
    let at = |id: &str| graph.edges.iter().filter(|e| e.reason == BY_PROPOSAL && (e.a == id || e.b == id)).count();
    if apart || rule.is_some() {
        item.rule = Some(rule.map_or_else(|| "adjacency_forbidden".to_owned(), |r| r.source.clone()));
        item.reason = rule.map_or_else(|| "the two are to be apart".to_owned(), |r| r.reason.clone());
    } else if level_a != level_b {
        item.reason = "the two are on different storeys".into();
    } else if way_a || way_b {
        item.reason = "the room is entered from another one".into();
    } else if at(a) >= MOST_EDGES || at(b) >= MOST_EDGES {
        item.reason = format!("a room has at most {MOST_EDGES} wishes for neighbors");
    } else {
        item.fate = Fate::Kept;
        let (a, b) = (a.to_owned(), b.to_owned());
        graph.edges.push(GraphEdge { a, b, connector: wanted, required: false, reason: BY_PROPOSAL.into() });
    }
}
