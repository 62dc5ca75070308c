//! What the layout search needs to know about each room, in one place: the scene graph's wishes, the domain's room types
//! and the knowledge base's limits, merged. The strictest figure wins.

use std::collections::BTreeMap;

use d3dgen_knowledge::jurisdiction::rules_here;
use d3dgen_knowledge::{Limit, Limits, RoomLimits};
use d3dgen_model::domain::{
    Adjacency, AdjacencyRelation, Arrangement, Attached, BuildingType, Daylight, Domain, Materials, Privacy, Relation,
    RobotUse, RoomType, Shape, Zone,
};
use d3dgen_model::measures::JAMB_M;
use d3dgen_model::offer::{has_docks, seated_in};
use d3dgen_model::scene_graph::{BY_PROMPT, Connector, GraphEdge, GraphRoom, Note, SceneGraph};
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::Error;
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::style::{Form, SpaceStyle, StyleWord, Symmetry};

use super::core::Core;
use super::lattice::OUTER_HALF_M;
use super::party::Party;
use crate::measures::{LEAST_WALL_M, SYMMETRIC};

/// Code of the conflict that a building has another form than was asked for.
const FORM_NOT_BUILT: &str = "form_not_built";
/// Code of the conflict that a building has no neighbors where it was to have some.
const STANDS_FREE: &str = "stands_free";
/// Code of the conflict that a plan is not alike on both sides.
const NOT_SYMMETRIC: &str = "not_symmetric";
/// Clear width that a wheelchair and most robots need through a door, m; used when the prompt asks for access.
const ACCESSIBLE_DOOR_M: f64 = 0.9;

/// Advice widens a corridor by this factor at most: what asks for more is about another kind of corridor.
const MOST_ADVISED_WIDTH: f64 = 1.4;
/// The same in a home of several storeys, whose halls have no floor to spare.
const MOST_ADVISED_WITH_STAIRS: f64 = 1.0;
/// Hall of a storey of a home for each square meter of its rooms, and the height of a storey before it is known, m.
const HALL_BESIDE_ROOMS: f64 = 0.1;
const USUAL_STOREY_M: f64 = 2.8;
/// Advice widens a door by this much at most, m.
const MOST_ADVISED_DOOR_M: f64 = 0.1;
/// Share by which the area aimed for differs from seed to seed, what one room has more of it by itself and many share,
/// and the range from which on an area may differ.
const AREA_VARIATION: f64 = 0.07;
const FEW_ROOMS_VARIATION: f64 = 0.4;
const FREE_RANGE: f64 = 1.3;
/// Share by which a corridor is wider than it must be, from seed to seed, and what one room has more of it by itself and
/// many share.
const WIDTH_VARIATION: f64 = 0.1;
const FEW_ROOMS_WIDTH: f64 = 0.3;
/// Share of a target area kept from the edges of what is advised, for the search to move in.
const ADVICE_MARGIN: f64 = 0.03;

/// Area up to which a room of a place to work at is one cell, m^2: without a corner, its desks or beds find no wall.
const CELL_M2: f64 = 25.0;

/// One room as the search sees it. Areas are net m^2, lengths net m.
#[derive(Debug, Clone)]
pub(crate) struct RoomSpec {
    pub id: String,
    pub room_type: String,
    pub name: String,
    pub circulation: bool,
    pub area_min: f64,
    pub area_target: f64,
    pub area_max: f64,
    pub min_dimension: f64,
    /// Clear lengths of its sides, for a room by itself of which they are told.
    pub sides: Option<[f64; 2]>,
    pub daylight: Daylight,
    /// True for windows above what stands at the outer wall.
    pub high_windows: bool,
    /// True for rooms that rows of desks are for: who sits there looks along the windows.
    pub desk_rows: bool,
    pub zone: Zone,
    pub wet: bool,
    /// True for rooms that one locks behind oneself.
    pub private: bool,
    /// True for rooms that are for anybody.
    pub public: bool,
    /// True for rooms that robots go in and out of by themselves.
    pub docks: bool,
    pub open_front: bool,
    /// True for rooms into which no leaf opens.
    pub slides: bool,
    /// True for rooms whose doors open by themselves, for robots.
    pub automatic: bool,
    /// True for rooms whose doors only people open.
    pub by_hand: bool,
    /// True for rooms that robots stay out of.
    pub kept_out: bool,
    pub entrance: bool,
    /// True for a room that the prompt wants near the entrance.
    pub by_entrance: bool,
    /// True for a room that the domain wants near an entrance hall, in a building without one.
    pub for_guests: bool,
    /// People who work, meet or wait there, as the scene graph says.
    pub people: u32,
    /// Clear width of the gate through which its vehicles come in, or of its own door to outdoors, m.
    pub gate: Option<f64>,
    /// Height of that gate where vehicles need more than a door, m.
    pub gate_height: f64,
    pub door_width: f64,
    pub ceiling_height: f64,
    /// Limits of its type, for what depends on the finished room.
    pub limits: RoomLimits,
    pub materials: Materials,
    /// True when a door leads from the spine into it.
    pub on_spine: bool,
    /// Room that it is entered from, for en suites and the like.
    pub host: Option<usize>,
    /// True for stairwells and elevators, whose size follows from what they hold.
    pub fixed: bool,
    /// True for elevators: their doors slide and they have no windows.
    pub elevator: bool,
    /// Unit of a large building that it belongs to, counted from 0.
    pub unit: Option<usize>,
    /// True for rooms at the part of the corridor behind a lock, while it is looked for as one.
    pub locked: bool,
}

impl RoomSpec {
    /// Returns true for rooms of which a corner can be cut out: large ones, and those for water, whose neighbors share its pipes.
    pub(crate) fn spares_a_corner(&self) -> bool {
        self.wet || self.area_target >= CELL_M2
    }

    /// Returns true when a hard rule puts it on the facade: daylight rooms and balconies.
    pub(crate) fn needs_outer_wall(&self) -> bool {
        self.daylight == Daylight::Required || self.zone == Zone::Outdoor || self.gate.is_some()
    }

    /// Returns true where its own door to outdoors is one that people push open: no gate for vehicles, beds or baggage.
    pub(crate) fn is_gate_by_hand(&self) -> bool {
        self.gate.is_some_and(|wide| wide < BY_MOTOR_M)
    }

    /// Returns the least length of one piece of outer wall that a room on the facade needs, m.
    pub(crate) fn least_outer_wall(&self) -> f64 {
        self.gate.map_or(LEAST_WALL_M, |g| Brief::opening(g) + 2.0 * (JAMB_M + OUTER_HALF_M))
    }
}

/// How much wider than a vehicle its gate is, m.
const BESIDE_VEHICLE_M: f64 = 0.6;
/// Air over a vehicle in its gate, and lintel over a gate, m.
const OVER_VEHICLE_M: f64 = 0.4;
const OVER_GATE_M: f64 = 0.4;
/// Clear width of a door to outdoors from which on lorries come to it, m, and how high it is for them (practice: 3 m and more).
const DOCK_GATE_M: f64 = 2.4;
const DOCK_GATE_HEIGHT_M: f64 = 3.0;
/// Clear width of a door to outdoors from which on it opens by a motor, m.
const BY_MOTOR_M: f64 = 1.4;
/// What a robot's circle has to spare where it passes, both sides together, m.
const PASSING_M: f64 = 0.1;
/// Floor that rooms have for a usual robot to turn on anyway, m^2.
const TURNING_M2: f64 = 0.6;

/// A relation between two rooms other than the spine.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Link {
    pub a: usize,
    pub b: usize,
    pub connector: Connector,
    pub required: bool,
}

/// The whole task.
#[derive(Debug, Clone)]
pub(crate) struct Brief {
    /// Largest share of the net floor area that circulation should have.
    pub share_advised: Option<f64>,
    pub rooms: Vec<RoomSpec>,
    /// Index of the corridor, hall or hub room; `None` for a single room.
    pub spine: Option<usize>,
    /// The piece of corridor that closes a ring with the spine, if any.
    pub ring: Option<usize>,
    /// The part of the corridor behind a lock, if any.
    pub locked: Option<usize>,
    /// True when the spine is a room of its own right (a warehouse hall) and takes its width from its area.
    pub hub: bool,
    /// Clear corridor width, m.
    pub spine_width: f64,
    /// What the corridor has beyond that and beyond what its entrance needs, m.
    pub spine_extra: f64,
    pub links: Vec<Link>,
    pub apart: Vec<[usize; 2]>,
    /// Pairs that the domain would rather not have wall to wall.
    pub aloof: Vec<[usize; 2]>,
    pub second_exit: bool,
    /// Net floor area asked for in total, m^2.
    pub area: Option<f64>,
    /// Whether the plan is to be alike on both sides of an axis.
    pub symmetry: Option<Symmetry>,
    /// True while plans are looked for that are alike on both sides by construction.
    pub mirrored: bool,
    /// Form that is asked for.
    pub form: Option<Form>,
    /// True where the building is to be compact.
    pub compact: bool,
    pub entrance_width: f64,
    /// Least width of a court, m.
    pub court_width: f64,
    pub conflicts: Vec<Note>,
    /// By room: the larger room that is entered through it (an isolation room through its anteroom), if any.
    pub guests: Vec<Option<usize>>,
    /// True for a wing: the spine of the building passes the start of its corridor.
    pub stem: bool,
    /// True for a storey that one does not enter from outdoors.
    pub upper: bool,
    /// True for a storey of a home, whatever is on it.
    pub of_home: bool,
    /// Areas of the rooms that stand on this storey together, corridors and stairs aside, net m^2; 0 for the highest one.
    pub carries: f64,
    /// Stairs and elevator of a building with several storeys.
    pub core: Option<Core>,
    /// True in a domain of homes.
    pub for_homes: bool,
    /// Rooms that may have the door to the garden, best first.
    pub garden: Vec<usize>,
    /// What it stands wall to wall with, if anything.
    pub attached: Option<Attached>,
    /// The walls that this stands against, in the frame of the boxes at hand, while such a plan is looked for.
    pub party: Option<Party>,
}

impl Brief {
    /// Returns the merged task.
    ///
    /// # Errors
    /// `Mismatch` when an edge names a room that is not in the graph.
    pub(crate) fn new(graph: &SceneGraph, domain: &Domain, limits: &Limits) -> Result<Self, Error> {
        let index: BTreeMap<&str, usize> = graph.rooms.iter().enumerate().map(|(i, r)| (r.id.as_str(), i)).collect();
        let find = |id: &str| {
            index.get(id).copied().ok_or_else(|| Error::Mismatch {
                stage: "floorplan",
                message: format!("an edge names room `{id}`, which the scene graph does not have"),
            })
        };
        let mut conflicts = Vec::new();
        let mut rooms: Vec<RoomSpec> =
            graph.rooms.iter().map(|r| room_spec(r, graph, domain, limits, &mut conflicts)).collect();
        let spine = spine_of(graph, domain, &index);
        let locked = locked_of(graph, spine);
        let mut units: Vec<&str> = Vec::new();
        for (spec, room) in rooms.iter_mut().zip(&graph.rooms) {
            spec.host = host_of(room, graph, domain, spine).filter(|_| !is_at_corridor(room, graph, locked));
            let Some(unit) = room.unit.as_deref() else { continue };
            if !units.contains(&unit) {
                units.push(unit);
            }
            spec.unit = units.iter().position(|u| *u == unit);
        }
        // what belongs to no unit is by the entrance
        if !units.is_empty() {
            rooms.iter_mut().for_each(|spec| spec.unit = spec.unit.or(Some(0)));
        }
        let hard_width = limits.corridor_m(&domain.circulation);
        // a home with stairs has little floor left for wide halls, unless somebody turns a wheelchair there
        let for_homes = is_for_homes(domain);
        let of_home = !graph.links.is_empty() && for_homes;
        let most_advised = if of_home && !graph.accessible { MOST_ADVISED_WITH_STAIRS } else { MOST_ADVISED_WIDTH };
        let advised_width = limits.corridor_width_advised.unwrap_or(0.0).min(most_advised * hard_width);
        let fitted = fitted_width(graph);
        let circulation_width = hard_width.max(advised_width).max(fitted).max(limits.two_way_m(graph));
        let mut brief = Self {
            hub: spine.is_some_and(|s| !rooms[s].circulation),
            ring: ring_of(graph, spine),
            locked,
            rooms,
            spine,
            spine_width: circulation_width,
            spine_extra: 0.0,
            share_advised: limits.circulation_share_advised.filter(|_| graph.links.is_empty()),
            links: Vec::new(),
            apart: Vec::new(),
            aloof: aloof(graph, domain),
            second_exit: domain.circulation.second_exit && graph.rooms.iter().all(|r| r.level == 0),
            area: match graph.area_m2 {
                Some(_) if of_home => Some(storey_m2(graph, domain)),
                area => area.filter(|_| graph.links.is_empty()),
            },
            symmetry: graph.style.symmetry,
            mirrored: graph.style.symmetry == Some(Symmetry::Symmetric),
            form: graph.style.form,
            compact: graph.style.space == Some(SpaceStyle::Compact),
            entrance_width: limits.entrance_m(&domain.circulation).max(fitted),
            court_width: domain.circulation.court_width_m,
            conflicts,
            guests: Vec::new(),
            stem: false,
            upper: graph.rooms.iter().any(|r| r.level != 0),
            of_home,
            carries: 0.0,
            core: None,
            for_homes,
            garden: Vec::new(),
            attached: None,
            party: None,
        };
        brief.find_guests();
        if let Some(building) = graph.building_type.as_deref().and_then(|id| domain.building_type(id)) {
            brief.stand(building);
        }
        let asked = |(i, room): (usize, &GraphRoom)| (room.garden_door && !brief.upper).then_some(i);
        let asked: Vec<usize> = graph.rooms.iter().enumerate().filter_map(asked).collect();
        if !asked.is_empty() {
            brief.garden = asked;
        }
        if let Some(spine) = brief.spine
            && !brief.upper
            && !brief.rooms.iter().any(|r| r.entrance)
        {
            brief.rooms[spine].entrance = true;
        }
        for edge in &graph.edges {
            let (a, b) = (find(&edge.a)?, find(&edge.b)?);
            brief.add_edge(a, b, edge.connector, edge.required);
        }
        for [a, b] in &graph.apart {
            brief.apart.push([find(a)?, find(b)?]);
        }
        Ok(brief)
    }

    /// Fills in what follows from how the building stands: its garden, and the walls of others.
    fn stand(&mut self, building: &BuildingType) {
        let at = |id: &String| (0..self.rooms.len()).filter(|&r| &self.rooms[r].room_type == id).collect::<Vec<_>>();
        // from a terrace one gets to the garden anyway
        let terrace = self.rooms.iter().any(|r| r.zone == Zone::Outdoor);
        if !self.upper && !terrace {
            self.garden = building.garden_rooms.iter().flat_map(at).collect();
        }
        self.attached = building.attached;
    }

    /// Gives up the neighbors: a plan that stands free is better than none, and says so.
    pub(crate) fn stand_free(&mut self) {
        if self.party.take().is_some() {
            self.conflicts.push(Note {
                code: STANDS_FREE.into(),
                message:
                    "no plan was found with neighbors wall to wall at both ends; it has windows on other sides too"
                        .into(),
            });
        }
    }

    /// Returns the task in the frame of boxes that were turned.
    pub(crate) fn turned(&self, swapped: bool) -> Self {
        let party = self.party.map(|p| Party { vertical: p.vertical != swapped, ..p });
        Self { party, ..self.clone() }
    }

    /// Gives up the form that is asked for: what would close a ring of corridors is a piece of corridor like any other room.
    pub(crate) fn take_any_form(&mut self) {
        (self.form, self.ring) = (None, None);
    }

    /// Says so where another form was built than was asked for.
    pub(crate) fn tell_form(&mut self, asked: Option<Form>, is_built: impl Fn(Form) -> bool) {
        self.conflicts.retain(|n| n.code != FORM_NOT_BUILT);
        let Some(form) = asked.filter(|f| !is_built(*f)) else { return };
        let asked = StyleWord::Form(form).label().replace('_', "-");
        self.conflicts.push(Note {
            code: FORM_NOT_BUILT.into(),
            message: format!(
                "no plan of {} rooms was found in the form asked for ({asked}); another form was built",
                self.rooms.iter().filter(|r| !r.circulation).count()
            ),
        });
    }

    /// Says so where a symmetric plan was asked for and too small a share of the one that was found has its like across the
    /// axis.
    pub(crate) fn tell_symmetry(&mut self, share: f64) {
        self.conflicts.retain(|n| n.code != NOT_SYMMETRIC);
        if self.symmetry != Some(Symmetry::Symmetric) || share >= SYMMETRIC {
            return;
        }
        self.conflicts.push(Note {
            code: NOT_SYMMETRIC.into(),
            message: format!(
                "a symmetric plan was asked for; of the floor {:.0} % has a room of the same kind for its mirror image, less than \
                 {:.0} %: the rooms asked for do not pair up",
                (100.0 * share).floor(),
                100.0 * SYMMETRIC
            ),
        });
    }

    /// Returns true for a room that stands where the core puts it.
    pub(crate) fn in_core(&self, room: usize) -> bool {
        self.core.as_ref().is_some_and(|c| c.has(room, self.spine))
    }

    /// Fills in which larger room is entered through which.
    pub(crate) fn find_guests(&mut self) {
        self.guests = vec![None; self.rooms.len()];
        for (i, room) in self.rooms.iter().enumerate().rev() {
            if let Some(host) = room.host.filter(|&h| room.area_target > self.rooms[h].area_target) {
                self.guests[host] = Some(i);
            }
        }
    }

    /// Changes the areas aimed for a little where they are free to change: the same rooms for another family, so that two
    /// seeds do not end in one best plan.
    pub(crate) fn vary(&mut self, rng: &mut Stream) {
        let share = AREA_VARIATION + FEW_ROOMS_VARIATION / self.rooms.len().max(1) as f64;
        let alike = self.symmetry == Some(Symmetry::Symmetric);
        let mut drawn: BTreeMap<String, f64> = BTreeMap::new();
        for room in &mut self.rooms {
            // rooms that are to mirror each other change together
            let at = rng.unit();
            let at = if alike { *drawn.entry(room.room_type.clone()).or_insert(at) } else { at };
            let (least, most) = (room.area_min * 1.02, room.area_max * 0.98);
            let free = (least..=most).contains(&room.area_target) && most > FREE_RANGE * least;
            let [advised, too_much] = room.limits.area_advised.unwrap_or([0.0, f64::MAX]);
            let low = (room.area_target * (1.0 - share)).max(least).max(advised);
            let high = (room.area_target * (1.0 + share)).min(most).min(too_much);
            if free && low < high {
                room.area_target = low + at * (high - low);
            }
        }
    }

    /// Makes the corridor a little wider than it must be, as [`Brief::vary`] changes areas.
    pub(crate) fn widen(&mut self, rng: &mut Stream) {
        let share = WIDTH_VARIATION + FEW_ROOMS_WIDTH / self.rooms.len().pow(2).max(1) as f64;
        self.spine_extra = share * self.spine_width * rng.unit();
    }

    /// Returns the task of a wing with some of the rooms, in their order, and the corridor last.
    pub(crate) fn wing(&self, rooms: &[usize]) -> Self {
        let spine = self.spine.filter(|_| !self.hub);
        let list: Vec<usize> = rooms.iter().copied().chain(spine).collect();
        let mut index = vec![None; self.rooms.len()];
        list.iter().enumerate().for_each(|(i, &r)| index[r] = Some(i));
        let mut specs: Vec<RoomSpec> = list.iter().map(|&r| self.rooms[r].clone()).collect();
        for spec in &mut specs {
            spec.host = spec.host.and_then(|h| index[h]);
        }
        let entered = spine.is_some_and(|s| self.rooms[s].entrance);
        if let Some(corridor) = spine.and_then(|s| index[s]) {
            specs[corridor].entrance = false;
        }
        let link = |l: &Link| Some(Link { a: index[l.a]?, b: index[l.b]?, ..*l });
        let area = |rooms: &[RoomSpec]| rooms.iter().filter(|r| !r.circulation).map(|r| r.area_target).sum::<f64>();
        let carries = self.carries * area(&specs) / area(&self.rooms).max(1.0);
        let both = |pairs: &[[usize; 2]]| pairs.iter().filter_map(|[a, b]| Some([index[*a]?, index[*b]?])).collect();
        let mut out = Self {
            rooms: specs,
            spine: spine.and_then(|s| index[s]),
            ring: None,
            locked: None,
            hub: false,
            links: self.links.iter().filter_map(link).collect(),
            apart: both(&self.apart),
            aloof: both(&self.aloof),
            // its corridor is as wide as the building's
            second_exit: self.second_exit || entered,
            area: None,
            conflicts: Vec::new(),
            guests: Vec::new(),
            stem: true,
            carries,
            core: None,
            garden: Vec::new(),
            ..*self
        };
        out.find_guests();
        out
    }

    fn add_edge(&mut self, a: usize, b: usize, connector: Connector, required: bool) {
        let walkable = matches!(connector, Connector::Door | Connector::Open);
        if let Some(spine) = self.spine
            && (a == spine || b == spine)
        {
            let room = if a == spine { b } else { a };
            if walkable && required {
                self.rooms[room].on_spine = true;
                self.rooms[room].open_front |= connector == Connector::Open;
            }
            return;
        }
        self.links.push(Link { a, b, connector, required });
    }

    /// Returns the rooms of one type that vehicles come to by gates of their own, for each type with several.
    pub(crate) fn docks(&self) -> Vec<Vec<usize>> {
        let mut docks: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (room, spec) in self.rooms.iter().enumerate() {
            if spec.gate.is_some() && !spec.is_gate_by_hand() {
                docks.entry(&spec.room_type).or_default().push(room);
            }
        }
        docks.into_values().filter(|rooms| rooms.len() > 1).collect()
    }

    /// Returns true for buildings that people live in: they sleep there, and nobody works or is received.
    pub(crate) fn is_home(&self) -> bool {
        let any = |zone: Zone| self.rooms.iter().any(|r| r.zone == zone);
        self.of_home || self.for_homes || any(Zone::Night) && !any(Zone::Staff) && !any(Zone::Public)
    }

    /// Returns the structural opening of a door with this clear width, m, on the lattice.
    pub(crate) fn opening(clear: f64) -> f64 {
        ((clear + 0.08) / 0.05 - 1e-6).ceil() * 0.05
    }

    /// Returns the clear width of a passage between two rooms: the wider need of the more demanding side that it serves.
    pub(crate) fn door_width(&self, a: usize, b: usize) -> f64 {
        match self.spine {
            Some(s) if s == a => self.rooms[b].door_width,
            Some(s) if s == b => self.rooms[a].door_width,
            // a corridor behind a lock is one like the other
            _ if Some(a) == self.locked => self.rooms[b].door_width,
            _ if Some(b) == self.locked => self.rooms[a].door_width,
            // Between two rooms the door serves the one that hangs on the other, or the lesser need of equals.
            _ if self.rooms[a].host == Some(b) => self.rooms[a].door_width,
            _ if self.rooms[b].host == Some(a) => self.rooms[b].door_width,
            _ => self.rooms[a].door_width.min(self.rooms[b].door_width),
        }
    }
}

/// Returns the area that a storey of a home has by what its rooms are to have: with a hall as short as they allow, and its stairs.
fn storey_m2(graph: &SceneGraph, domain: &Domain) -> f64 {
    let rooms: f64 = graph.rooms.iter().filter(|r| !r.circulation).map(|r| r.target_area_m2).sum();
    let stairs = domain.circulation.storeys.as_ref().map_or(0.0, |s| {
        let (width, depth) = s.stairs.size_m(USUAL_STOREY_M);
        width * depth * graph.rooms.iter().filter(|r| r.room_type == s.stairs.room_type).count() as f64
    });
    (1.0 + HALL_BESIDE_ROOMS) * rooms + stairs
}

/// Returns the part of the corridor that one comes to through a door from the other.
fn locked_of(graph: &SceneGraph, spine: Option<usize>) -> Option<usize> {
    let spine = &graph.rooms[spine?];
    let joined = |id: &str| {
        let ends = |e: &GraphEdge| e.a == id && e.b == spine.id || e.b == id && e.a == spine.id;
        graph.edges.iter().any(|e| e.required && e.connector == Connector::Door && ends(e))
    };
    let way = |r: &GraphRoom| r.circulation && r.room_type == spine.room_type && r.id != spine.id && joined(&r.id);
    graph.rooms.iter().position(way)
}

/// Returns true for a room with a door to the corridor behind a lock.
fn is_at_corridor(room: &GraphRoom, graph: &SceneGraph, locked: Option<usize>) -> bool {
    let Some(corridor) = locked.map(|l| &graph.rooms[l].id) else { return false };
    let walkable = |e: &&GraphEdge| e.required && matches!(e.connector, Connector::Door | Connector::Open);
    let joins = |e: &GraphEdge| &e.a == corridor && e.b == room.id || e.a == room.id && &e.b == corridor;
    graph.edges.iter().filter(walkable).any(joins)
}

/// Returns the piece of corridor that is open to the spine, so that both together can run around a core or a court.
fn ring_of(graph: &SceneGraph, spine: Option<usize>) -> Option<usize> {
    let spine = &graph.rooms[spine?];
    let joined = |id: &str| {
        let ends = |e: &GraphEdge| e.a == id && e.b == spine.id || e.b == id && e.a == spine.id;
        graph.edges.iter().any(|e| e.required && e.connector == Connector::Open && ends(e))
    };
    graph.rooms.iter().position(|r| r.circulation && r.id != spine.id && joined(&r.id))
}

/// Returns the pairs of rooms that the domain advises against putting wall to wall.
fn aloof(graph: &SceneGraph, domain: &Domain) -> Vec<[usize; 2]> {
    let advice = |r: &&Adjacency| r.relation == AdjacencyRelation::ShouldNot && r.via == "wall";
    let of = |kind: &str| -> Vec<usize> {
        graph.rooms.iter().enumerate().filter(|(_, r)| r.room_type == kind).map(|(i, _)| i).collect()
    };
    let pairs = rules_here(domain, graph.place_code()).filter(advice).flat_map(|rule| {
        let others = of(&rule.b);
        of(&rule.a).into_iter().flat_map(move |a| others.clone().into_iter().map(move |b| [a, b]))
    });
    pairs.filter(|[a, b]| a != b).collect()
}

/// Returns the width that the robots need to pass which the building is made for, m; 0 without such.
fn fitted_width(graph: &SceneGraph) -> f64 {
    let widths = graph.robots.iter().filter(|r| r.is_fitted()).map(|r| 2.0 * r.radius_m + PASSING_M);
    widths.fold(0.0, f64::max)
}

fn max_limit(base: f64, limit: Option<&Limit>) -> f64 {
    limit.map_or(base, |l| base.max(l.value))
}

/// Returns true for a domain of homes: in none of its rooms people work or receive anybody but their guests.
fn is_for_homes(domain: &Domain) -> bool {
    !domain.room_types.iter().any(|kind| matches!(kind.zone, Zone::Staff | Zone::Public))
}

/// Returns true for a room that rows of desks are for.
fn has_desk_rows(domain: &Domain, kind: &RoomType) -> bool {
    let desk = |item: &str| domain.anchor(item).is_some_and(|o| o.shape == Shape::Desk);
    kind.furnishing.first().is_some_and(|f| f.required && f.arrangement == Arrangement::Rows && desk(&f.item))
}

fn room_spec(
    room: &GraphRoom,
    graph: &SceneGraph,
    domain: &Domain,
    limits: &Limits,
    conflicts: &mut Vec<Note>,
) -> RoomSpec {
    let kind: &RoomType = domain.room_type_or_generic(&room.room_type);
    let none = RoomLimits::default();
    let limit = limits.rooms.get(&room.room_type).unwrap_or(&none);
    let [low, high] = room.area_range_m2;
    let area_min = max_limit(low, limit.area_min.as_ref());
    let mut area_max = high;
    if area_min > high * 0.9 {
        area_max = (area_min * 1.25).max(high);
        if area_min > high {
            conflicts.push(Note {
                code: "area_raised_by_rule".into(),
                message: format!(
                    "{} is at least {area_min:.1} m2 by rule {}, more than the {high:.1} m2 allowed; the rule was followed",
                    room.name,
                    limit.area_min.as_ref().map_or("", |l| l.constraint_id.as_str()),
                ),
            });
        }
    }
    let mut area_target = room.target_area_m2;
    if let Some([least, most]) = limit.area_advised {
        let least = least * (1.0 + ADVICE_MARGIN);
        area_target = area_target.clamp(least, (most * (1.0 - ADVICE_MARGIN)).max(least));
    }
    if graph.accessible {
        area_target = area_target.max(kind.step_free_m2.min(area_max));
    }
    // beds need floor beside them for who comes in a wheelchair
    let step_free = if graph.accessible { kind.step_free_dimension_m } else { 0.0 };
    let least_dimension = kind.min_dimension_m.max(step_free.min(area_max.sqrt()));
    // a robot that is to fit turns in the room beside what stands there
    let fitted = fitted_width(graph);
    area_target = (area_target + (fitted * fitted - TURNING_M2).max(0.0)).min(area_max.max(area_target));
    let mut door_width = max_limit(kind.door_width_m, limit.door_width.as_ref());
    if graph.accessible {
        door_width = door_width.max(ACCESSIBLE_DOOR_M);
    }
    let advised = limit.door_width_advised.unwrap_or(0.0).min(door_width + MOST_ADVISED_DOOR_M);
    door_width = door_width.max(advised);
    // A robot's circle passes with 5 cm to spare on both sides.
    let robot = graph.robots.iter().map(|r| 2.0 * r.planned_radius_m() + 0.1).fold(0.0, f64::max);
    let robots = !graph.robots.is_empty();
    let sent = graph.robots.iter().any(|r| r.stops.contains(&room.id) || r.room_types.contains(&room.room_type));
    let works = sent || kind.robot.iter().any(|u| *u != RobotUse::KeepOut);
    // nobody lives behind motors: those doors stand open for the robot
    let motors = domain.circulation.automatic_doors;
    let automatic = robots && works && motors;
    // what hangs in the air or lies below the ground has no drive
    let gate = gate(domain, kind).filter(|_| room.level == 0);
    RoomSpec {
        id: room.id.clone(),
        room_type: room.room_type.clone(),
        name: room.name.clone(),
        circulation: room.circulation,
        area_min,
        area_target: area_target.clamp((area_min * 1.02).min(area_max), area_max),
        area_max,
        min_dimension: max_limit(least_dimension, limit.dimension_min.as_ref()).max(fitted),
        sides: room.sides_m.filter(|_| graph.rooms.len() == 1),
        daylight: kind.daylight,
        high_windows: kind.high_windows,
        desk_rows: has_desk_rows(domain, kind),
        zone: kind.zone,
        wet: kind.wet,
        private: kind.privacy == Privacy::Private,
        public: kind.privacy == Privacy::Public,
        docks: has_docks(domain, kind) || robots && kind.robot.contains(&RobotUse::Charging),
        open_front: kind.open_front,
        // who uses a wheelchair has no floor to spare for a leaf
        slides: kind.sliding_door || graph.accessible && kind.wet && kind.privacy == Privacy::Private || automatic,
        automatic,
        by_hand: robots && !motors,
        kept_out: kind.robot.contains(&RobotUse::KeepOut) && !sent,
        entrance: room.entrance,
        by_entrance: is_by_entrance(room, graph),
        for_guests: is_for_guests(room, graph, domain),
        people: people(room, domain, kind),
        gate,
        gate_height: gate_height(domain, kind),
        door_width: door_width.max(robot),
        ceiling_height: kind.ceiling_height_m,
        limits: limit.clone(),
        materials: kind.materials.clone(),
        on_spine: false,
        host: None,
        fixed: false,
        elevator: graph.links.iter().any(|l| l.kind == LinkKind::Elevator && l.room_ids.contains(&room.id)),
        unit: None,
        locked: false,
    }
}

/// Returns how many people work, meet, eat or wait in a room; 0 for rooms to sleep in.
fn people(room: &GraphRoom, domain: &Domain, kind: &RoomType) -> u32 {
    let seated = || seated_in(domain, kind, room.target_area_m2);
    if kind.zone == Zone::Night { 0 } else { room.occupants.unwrap_or_else(seated) }
}

/// Returns true for a room that the prompt wants near the entrance.
fn is_by_entrance(room: &GraphRoom, graph: &SceneGraph) -> bool {
    graph.edges.iter().any(|e| {
        let of = e.a == room.id && e.connector == Connector::Near && e.reason == BY_PROMPT;
        of && graph.room(&e.b).is_some_and(|r| r.entrance)
    })
}

/// Returns true for a room that belongs near the entrance hall in a building that has none: it lies near the entrance then.
fn is_for_guests(room: &GraphRoom, graph: &SceneGraph, domain: &Domain) -> bool {
    let halls = &domain.circulation.entrance_room_types;
    let wanted = |rule: &Adjacency| {
        rule.relation == AdjacencyRelation::Should && rule.a == room.room_type && halls.contains(&rule.b)
    };
    !graph.rooms.iter().any(|r| halls.contains(&r.room_type)) && rules_here(domain, graph.place_code()).any(wanted)
}

/// Returns the height of the gate that the vehicles of a room need, or those that come to it, m.
fn gate_height(domain: &Domain, kind: &RoomType) -> f64 {
    let high = |item: &str| {
        let vehicle = domain.anchor(item).filter(|o| o.shape == Shape::Vehicle)?;
        vehicle.sizes_m.first().map(|size| size[2] + OVER_VEHICLE_M)
    };
    let parked = kind.furnishing.iter().filter(|f| f.required).filter_map(|f| high(&f.item)).reduce(f64::max);
    // lorries back up to a dock
    let lorries = || kind.outdoor_door_m.filter(|wide| *wide >= DOCK_GATE_M).map(|_| DOCK_GATE_HEIGHT_M);
    parked.or_else(lorries).unwrap_or(0.0).min(kind.ceiling_height_m - OVER_GATE_M)
}

/// Returns the clear width of the gate that the vehicles of a room need, or of its own door to outdoors, m.
fn gate(domain: &Domain, kind: &RoomType) -> Option<f64> {
    let vehicle = |id: &str| {
        let vehicle = domain.object(id).filter(|o| o.shape == Shape::Vehicle)?;
        vehicle.sizes_m.first().map(|size| size[0])
    };
    // those that stand side by side come in side by side
    let wide = |item: &str| {
        let Some(group) = domain.group(item) else { return vehicle(item) };
        let others = group.members.iter().filter(|m| matches!(m.relation, Relation::Left | Relation::Right));
        let beside = others.filter_map(|m| Some(f64::from(m.count) * (vehicle(&m.object)? + m.gap_m)));
        Some(vehicle(&group.anchor)? + beside.sum::<f64>())
    };
    let parked = kind.furnishing.iter().filter(|f| f.required).filter_map(|f| wide(&f.item));
    parked.reduce(f64::max).map(|wide| wide + BESIDE_VEHICLE_M).or(kind.outdoor_door_m)
}

/// Returns the index of the room that another is entered from when no door leads from the spine into it.
fn host_of(room: &GraphRoom, graph: &SceneGraph, domain: &Domain, spine: Option<usize>) -> Option<usize> {
    let walkable = |e: &&GraphEdge| e.required && matches!(e.connector, Connector::Door | Connector::Open);
    let other = |e: &GraphEdge| match (e.a == room.id, e.b == room.id) {
        (true, _) => graph.rooms.iter().position(|r| r.id == e.b),
        (_, true) => graph.rooms.iter().position(|r| r.id == e.a),
        _ => None,
    };
    let mut others: Vec<usize> = graph.edges.iter().filter(walkable).filter_map(other).collect();
    if graph.rooms.iter().position(|r| r.id == room.id) == spine || others.iter().any(|o| Some(*o) == spine) {
        return None;
    }
    // a room between two that hang on each other (an anteroom) is entered from the outer one
    let hosts = &domain.room_type_or_generic(&room.room_type).hosts;
    others.sort_by_key(|&o| !hosts.contains(&graph.rooms[o].room_type));
    others.first().copied()
}

/// Returns the circulation room, or the hub that takes its part.
fn spine_of(graph: &SceneGraph, domain: &Domain, index: &BTreeMap<&str, usize>) -> Option<usize> {
    if let Some(i) = graph.rooms.iter().position(|r| r.circulation) {
        return Some(i);
    }
    let degree = |id: &str| graph.edges.iter().filter(|e| e.required && (e.a == id || e.b == id)).count();
    domain
        .circulation
        .hub_room_types
        .iter()
        .flat_map(|t| graph.rooms.iter().filter(move |r| &r.room_type == t))
        .chain(&graph.rooms)
        .max_by(|x, y| {
            let key = |r: &GraphRoom| {
                let listed = domain.circulation.hub_room_types.contains(&r.room_type);
                (listed, degree(&r.id), (r.target_area_m2 * 100.0) as u64)
            };
            key(x).cmp(&key(y)).then(y.id.cmp(&x.id))
        })
        .map(|r| index[r.id.as_str()])
}
