//! Rooms as nodes, relations as edges; no coordinates yet.

use std::ops::RangeInclusive;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::{Document, Problem, check_unique};
use crate::levels::{VerticalLink, check_links, is_ground};
use crate::robot_body::RobotBody;
use crate::style::Style;

/// Reason of the doors to the corridor or hall.
pub const BY_CIRCULATION: &str = "circulation";

/// Reason of the edges that a prompt asks for.
pub const BY_PROMPT: &str = "prompt";

/// Reason of the openings of an open layout.
pub const BY_STYLE: &str = "style";

/// Reason of the edge between a room and the one it is entered from.
pub const BY_HOST: &str = "host";

/// What was asked for, understood.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneGraph {
    /// Format version; 1.
    pub version: u32,
    /// The prompt as given.
    pub prompt: String,
    /// Seed of every random choice downstream.
    pub seed: u64,
    /// Domain id (`residential`, `office`, `hospital`, `school`, ..., `general`).
    pub domain: String,
    /// Building type inside the domain (`ward`, `hotel`), where known.
    #[serde(default)]
    pub building_type: Option<String>,
    /// ISO 3166-1 alpha-2 code whose rules apply; absent means international rules only.
    #[serde(default)]
    pub country_code: Option<String>,
    /// ISO 3166-2 code of the division of that country whose rules apply too (`CA-ON`), where a city, a division or its code is named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub division_code: Option<String>,
    /// ISO 639-1 code of the prompt's language.
    pub language: String,
    /// Requested total net floor area, m^2.
    #[serde(default)]
    pub area_m2: Option<f64>,
    /// Head counts and other figures the prompt gives.
    #[serde(default)]
    pub occupancy: Occupancy,
    /// True when the prompt speaks of somebody in a wheelchair: more than access without steps.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub wheelchair: bool,
    /// True when the prompt asks for access without steps.
    #[serde(default)]
    pub accessible: bool,
    /// How the building is to be, where the request says.
    #[serde(default, skip_serializing_if = "Style::is_plain")]
    pub style: Style,
    /// Rooms; those with `circulation` were added to connect the others and are not counted.
    pub rooms: Vec<GraphRoom>,
    /// Connections; every `door` and `open` edge is walkable in the finished world.
    pub edges: Vec<GraphEdge>,
    /// Stairs and elevators of a building with several storeys.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<VerticalLink>,
    /// Pairs of rooms that share no door and no wall.
    #[serde(default)]
    pub apart: Vec<[String; 2]>,
    /// Room types that must not occur.
    #[serde(default)]
    pub forbidden_room_types: Vec<String>,
    /// Robots the world is for.
    #[serde(default)]
    pub robots: Vec<Robot>,
    /// What the prompt asks of robots room by room: where they stay out, how fast they drive.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robot_rules: Vec<RobotRule>,
    /// True where corridors are to be so wide that two robots pass each other.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub two_way: bool,
    /// What was assumed where the prompt is silent.
    #[serde(default)]
    pub assumptions: Vec<Note>,
    /// What contradicts itself or could not be honored, and what was done instead.
    #[serde(default)]
    pub conflicts: Vec<Note>,
}

/// Figures from the prompt; absent when not stated.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Occupancy {
    /// People who work there.
    #[serde(default)]
    pub staff: Option<u32>,
    /// Patient beds.
    #[serde(default)]
    pub beds: Option<u32>,
    /// Desks.
    #[serde(default)]
    pub desks: Option<u32>,
    /// Guests, pupils or customers.
    #[serde(default)]
    pub visitors: Option<u32>,
    /// People who live there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residents: Option<u32>,
}

/// A room to be planned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GraphRoom {
    /// Unique, snake case: `patient_room_3`; the zone name in `world.yaml`.
    #[schemars(regex(pattern = "^[a-z0-9_]+$"))]
    pub id: String,
    /// Room type id of the domain, or a type only the prompt names (planned as the domain's generic `room`).
    pub room_type: String,
    /// Name on the plan: `Patient room 3`.
    pub name: String,
    /// What it is for.
    pub description: String,
    /// Net floor area to aim for, m^2.
    pub target_area_m2: f64,
    /// Least and largest net floor area allowed, m^2.
    pub area_range_m2: [f64; 2],
    /// 8 to 15 objects wished for, most important first (object ids of the domain).
    pub wished_assets: Vec<String>,
    /// Clear lengths of its sides, m, for a room planned by itself of which the prompt says them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sides_m: Option<[f64; 2]>,
    /// People, beds or desks it must hold, where the prompt or program says.
    #[serde(default)]
    pub occupants: Option<u32>,
    /// True for corridors, halls and lobbies that were added to connect rooms.
    #[serde(default)]
    pub circulation: bool,
    /// True when the prompt names it.
    #[serde(default)]
    pub requested: bool,
    /// True when one enters the building through it.
    #[serde(default)]
    pub entrance: bool,
    /// True keeps the room as it is when the graph is fed back.
    #[serde(default)]
    pub locked: bool,
    /// Storey it lies on: 0 at the ground, 1 above it, -1 below it.
    #[serde(default, skip_serializing_if = "is_ground")]
    pub level: i32,
    /// Unit of a large building that it belongs to (`ward_2`), whose rooms lie together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// True when it is to have the door to the garden; of several such rooms one gets it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub garden_door: bool,
}

/// A relation between two rooms.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GraphEdge {
    /// Room id.
    pub a: String,
    /// Room id.
    pub b: String,
    /// How they meet.
    pub connector: Connector,
    /// True when the plan is wrong without it.
    pub required: bool,
    /// Who asked: the prompt, an adjacency rule's source, or `circulation`.
    pub reason: String,
}

/// How neighboring rooms meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Connector {
    /// By a door.
    Door,
    /// By an opening without a leaf.
    Open,
    /// By a shared wall.
    Wall,
    /// Close to each other, not necessarily touching.
    Near,
}

impl Connector {
    /// Returns the name that documents have for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Door => "door",
            Self::Open => "open",
            Self::Wall => "wall",
            Self::Near => "near",
        }
    }
}

/// Speeds that a robot in a building can be asked to keep to, m/s.
pub const ROBOT_SPEEDS_M_S: RangeInclusive<f64> = 0.05..=5.0;
/// Sides that a room can be asked to have, m.
const SIDES_M: RangeInclusive<f64> = 0.5..=500.0;
/// Radius of a usual service robot, m: what a building has ways for that is too small for the robot somebody has.
const USUAL_RADIUS_M: f64 = 0.30;

/// A robot the world must suit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// `cleaning`, `disinfection`, `delivery`, `service`, `transport`.
    pub kind: String,
    /// How many.
    pub count: u32,
    /// Radius of the disc that must find its way, m: of the circle it turns in; of a long body half its width, for that
    /// drives straight through what is narrow.
    pub radius_m: f64,
    /// Height, m.
    pub height_m: f64,
    /// True when it needs a charging dock in the building.
    pub charging: bool,
    /// What more is known of its body, and whether the building is made so that it fits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<RobotBody>,
    /// Ids of the rooms that the prompt has it go to; none: to all that robots of its kind go to.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stops: Vec<String>,
    /// Types of the rooms that it works in, where the prompt says so; empty for wherever its kind works.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub room_types: Vec<String>,
    /// True when the building is made without it: it is too large for these rooms, and drives only where it can.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub misfit: bool,
}

/// What the prompt asks of all robots in one room.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotRule {
    /// Room id.
    pub room_id: String,
    /// True where robots stay out.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub keep_out: bool,
    /// Highest speed of robots there, m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_speed_m_s: Option<f64>,
}

/// A statement about how the prompt was read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Note {
    /// Snake-case kind: `default_domain`, `unknown_place`, `contradicting_counts`, ...
    pub code: String,
    /// One sentence for people.
    pub message: String,
}

impl Note {
    /// Returns a note of a kind.
    pub fn new(code: &str, message: String) -> Self {
        Self { code: code.to_owned(), message }
    }
}

impl Robot {
    /// Returns the radius of the disc that the building has ways for, m.
    pub fn planned_radius_m(&self) -> f64 {
        if self.misfit { USUAL_RADIUS_M.min(self.radius_m) } else { self.radius_m }
    }

    /// Returns the width of its body, m: that of a robot of which only the circle is known is the circle's.
    pub fn width_m(&self) -> f64 {
        self.body.and_then(|b| b.width_m).unwrap_or(2.0 * self.radius_m)
    }

    /// Returns true when the building is made so that it fits.
    pub fn is_fitted(&self) -> bool {
        self.body.is_some_and(|b| b.fit)
    }
}

impl SceneGraph {
    /// Returns the code of the nearest place that is known: of the division, else of the country.
    pub fn place_code(&self) -> Option<&str> {
        self.division_code.as_deref().or(self.country_code.as_deref())
    }

    /// Returns true where robots meet in corridors that are made for them: because the prompt says so, or because there are
    /// several and the building is made so that they fit.
    pub fn is_two_way(&self) -> bool {
        let fitted = self.robots.iter().filter(|r| r.is_fitted()).map(|r| r.count).fold(0, u32::saturating_add);
        self.two_way || fitted > 1
    }

    /// Returns true for a room that the prompt keeps robots out of.
    pub fn keeps_robots_out(&self, room_id: &str) -> bool {
        self.robot_rules.iter().any(|r| r.keep_out && r.room_id == room_id)
    }

    /// Returns the highest speed of robots in a room, m/s, where the prompt says one.
    pub fn robot_speed_m_s(&self, room_id: &str) -> Option<f64> {
        self.robot_rules.iter().filter(|r| r.room_id == room_id).filter_map(|r| r.max_speed_m_s).reduce(f64::min)
    }

    /// Returns the room with this id.
    pub fn room(&self, id: &str) -> Option<&GraphRoom> {
        self.rooms.iter().find(|r| r.id == id)
    }

    /// Returns the graph in the referee's simple form: rooms with id and room type, edges with a, b, connector.
    pub fn to_simple(&self) -> serde_json::Value {
        serde_json::json!({
            "rooms": self.rooms.iter().map(|r| serde_json::json!({"id": r.id, "room_type": r.room_type})).collect::<Vec<_>>(),
            "edges": self.edges.iter().filter(|e| e.required)
                .map(|e| serde_json::json!({"a": e.a, "b": e.b, "connector": e.connector})).collect::<Vec<_>>(),
        })
    }
}

impl Document for SceneGraph {
    const KIND: &'static str = "scene_graph";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        if self.rooms.is_empty() {
            problems.push(Problem::new("/rooms", "is empty; a building needs at least one room"));
        }
        let within = |division: &str, country: &str| division.strip_prefix(country).is_some_and(|d| d.starts_with('-'));
        let country = self.country_code.as_deref().unwrap_or_default();
        if let Some(division) = self.division_code.as_deref().filter(|d| country.is_empty() || !within(d, country)) {
            problems.push(Problem::new("/division_code", format!("`{division}` is no division of `{country}`")));
        }
        check_unique("/rooms", self.rooms.iter().map(|r| r.id.as_str()), &mut problems);
        for (i, room) in self.rooms.iter().enumerate() {
            if let Some(side) = room.sides_m.iter().flatten().find(|s| !SIDES_M.contains(*s)) {
                let (least, most) = (SIDES_M.start(), SIDES_M.end());
                let message = format!("{side} m is outside {least}-{most} m");
                problems.push(Problem::new(format!("/rooms/{i}/sides_m"), message));
            }
            let [min, max] = room.area_range_m2;
            if !(0.0 < min && min <= room.target_area_m2 && room.target_area_m2 <= max) {
                problems.push(Problem::new(
                    format!("/rooms/{i}/target_area_m2"),
                    format!("{} m2 is outside area_range_m2 {min}-{max} m2", room.target_area_m2),
                ));
            }
        }
        for (i, edge) in self.edges.iter().enumerate() {
            for (end, id) in [("a", &edge.a), ("b", &edge.b)] {
                if self.room(id).is_none() {
                    problems.push(Problem::new(format!("/edges/{i}/{end}"), format!("room `{id}` is not in rooms")));
                }
            }
            if edge.a == edge.b {
                problems.push(Problem::new(format!("/edges/{i}"), format!("connects `{}` to itself", edge.a)));
            }
        }
        check_links(&self.links, |id| self.room(id).map(|r| r.level), &mut problems);
        for (i, pair) in self.apart.iter().enumerate() {
            for (j, id) in pair.iter().enumerate() {
                if self.room(id).is_none() {
                    problems.push(Problem::new(format!("/apart/{i}/{j}"), format!("room `{id}` is not in rooms")));
                }
            }
        }
        for (i, rule) in self.robot_rules.iter().enumerate() {
            if self.room(&rule.room_id).is_none() {
                let message = format!("room `{}` is not in rooms", rule.room_id);
                problems.push(Problem::new(format!("/robot_rules/{i}/room_id"), message));
            }
            if let Some(speed) = rule.max_speed_m_s.filter(|v| !ROBOT_SPEEDS_M_S.contains(v)) {
                let (least, most) = (ROBOT_SPEEDS_M_S.start(), ROBOT_SPEEDS_M_S.end());
                let message = format!("{speed} m/s is outside {least}-{most} m/s");
                problems.push(Problem::new(format!("/robot_rules/{i}/max_speed_m_s"), message));
            }
        }
        for (i, robot) in self.robots.iter().enumerate() {
            if !(0.05..=2.0).contains(&robot.radius_m) {
                problems.push(Problem::new(
                    format!("/robots/{i}/radius_m"),
                    format!("{} m is outside 0.05-2 m", robot.radius_m),
                ));
            }
        }
        problems
    }
}
