//! Kinds of people in a building: how many there are, where they may go, and what they do at which hour.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Domain, RoomType};
use crate::document::Problem;
use crate::hours;
use crate::scenario::script::{Act, GROUP_SIZES, WALKING_SPEEDS_M_S};

/// A kind of person in the building, for scenarios.
///
/// Rooms are named by the id of their type or by a tag ([`Domain::tags_of`]): `corridor`, `care`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Role {
    /// Snake-case id, for instance `nurse`.
    pub id: String,
    /// Arena human model, `Domain/name`.
    pub model: String,
    /// Walking speed, m/s.
    pub speed_m_s: f64,
    /// Rooms this person walks between where no round says it better, most frequent first.
    #[serde(default)]
    pub visits: Vec<String>,
    /// Whose rules of access hold for this person.
    #[serde(default, skip_serializing_if = "RoleKind::is_staff")]
    pub kind: RoleKind,
    /// Rooms it may enter beside those it visits, the public ones and the ways between.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub enters: Vec<String>,
    /// Rooms of which one must be there for this person to be: where it works, waits or sleeps. None: always.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub home: Vec<String>,
    /// How many there are at an hour of full work.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub number: Option<Number>,
    /// What it does; the first round that suits the hour is taken by the first person, the next by the next.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rounds: Vec<Round>,
}

/// Whose rules of access hold for a person.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RoleKind {
    /// From outside: public rooms and what it visits; never rooms of the staff, service rooms, dirty or restricted ones.
    Visitor,
    /// Lives, stays, learns or is treated there: public rooms and what it visits.
    Occupant,
    /// Works there: rooms of the staff too.
    #[default]
    Staff,
}

impl RoleKind {
    fn is_staff(&self) -> bool {
        *self == Self::Staff
    }

    /// Returns the name that hours have for it: `visitor`, `occupant`, `staff`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Visitor => "visitor",
            Self::Occupant => "occupant",
            Self::Staff => "staff",
        }
    }
}

/// How many people of a role there are: one for each so many of something in the rooms that are its home.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Number {
    /// What is counted.
    pub of: Counted,
    /// So many of it for each person.
    pub each: f64,
    /// Fewest.
    #[serde(default)]
    pub least: u32,
    /// Most.
    pub most: u32,
}

/// What the number of people follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Counted {
    /// Beds and couches that one lies on.
    Beds,
    /// Seats.
    Seats,
    /// Counters, machines and what else is operated.
    Posts,
    /// Rooms.
    Rooms,
    /// Net floor, m^2.
    AreaM2,
    /// Those who live there: as many as the prompt says, else one a bed.
    Residents,
}

/// What a person does at some hours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Round {
    /// Hours it belongs to; none: all that no other round of the role names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hours: Vec<String>,
    /// How many such people come in by an entrance in an hour, for each that the role's number says; 0 where they are there
    /// from the start.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub arrivals_per_h: f64,
    /// Fewest and most who come together.
    #[serde(default = "alone")]
    pub group: [u32; 2],
    /// True for people who are named in what is to be observed: their steps are told one by one.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub spotlight: bool,
    /// True when they leave the building at the end; else they begin anew.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub leaves: bool,
    /// What they do, in turn.
    pub steps: Vec<RoundStep>,
}

/// A step of a round.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoundStep {
    /// Where: the first of these that is there. Empty for steps to people.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub at: Vec<String>,
    /// Role of the people it goes to, each of its share in turn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_role: Option<String>,
    /// What it does there.
    #[serde(default, skip_serializing_if = "Act::is_stand")]
    pub act: Act,
    /// Least and most time there, s.
    pub seconds: [f64; 2],
    /// True when it goes to all such rooms of its share, not to one.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub all: bool,
    /// Share of the people who do it, 0 to 1.
    #[serde(default = "always")]
    pub chance: f64,
}

fn is_zero(v: &f64) -> bool {
    *v == 0.0
}

fn always() -> f64 {
    1.0
}

fn alone() -> [u32; 2] {
    [1, 1]
}

impl Role {
    /// Returns the rounds of an hour: those that name it, else those that name none.
    pub fn rounds_at(&self, hour: &str) -> Vec<&Round> {
        let named: Vec<&Round> = self.rounds.iter().filter(|r| r.hours.iter().any(|h| h == hour)).collect();
        if named.is_empty() { self.rounds.iter().filter(|r| r.hours.is_empty()).collect() } else { named }
    }

    /// Returns true when this person may enter a room with these tags.
    pub fn may_enter(&self, kind: &RoomType, tags: &BTreeSet<&str>) -> bool {
        let named = |list: &[String]| list.iter().any(|name| is_named(name, kind, tags));
        let closed = VISITORS_NEVER.iter().any(|tag| tags.contains(tag));
        match self.kind {
            RoleKind::Visitor if closed => false,
            RoleKind::Staff if tags.contains(super::tags::STAFF) => true,
            _ => {
                let open = tags.contains(super::tags::PUBLIC) || tags.contains(super::tags::WAY);
                open && !tags.contains(super::tags::RESTRICTED) || named(&self.visits) || named(&self.enters)
            }
        }
    }

    pub(super) fn check(&self, path: &str, domain: &Domain, problems: &mut Vec<Problem>) {
        let tags: BTreeMap<&str, BTreeSet<&str>> =
            domain.room_types.iter().map(|t| (t.id.as_str(), domain.tags_of(t))).collect();
        let known = |name: &String| domain.room_type(name).is_some() || super::tags::is_known(name);
        let lists = [("visits", &self.visits), ("enters", &self.enters), ("home", &self.home)];
        for (key, list) in lists {
            for (j, name) in list.iter().enumerate().filter(|(_, name)| !known(name)) {
                let message = format!("room type `{name}` is not in room_types, nor is it a tag");
                problems.push(Problem::new(format!("{path}/{key}/{j}"), message));
            }
        }
        if !(WALKING_SPEEDS_M_S[0]..=WALKING_SPEEDS_M_S[1]).contains(&self.speed_m_s) {
            let [low, high] = WALKING_SPEEDS_M_S;
            let message = format!("{} m/s is outside {low}-{high} m/s, at which people walk", self.speed_m_s);
            problems.push(Problem::new(format!("{path}/speed_m_s"), message));
        }
        for (j, name) in self.visits.iter().enumerate().filter(|_| self.kind == RoleKind::Visitor) {
            let own = tags.get(name.as_str());
            if let Some(tag) = VISITORS_NEVER.iter().find(|tag| own.is_some_and(|own| own.contains(*tag))) {
                let message = format!("`{name}` is {tag}: visitors stay out of it");
                problems.push(Problem::new(format!("{path}/visits/{j}"), message));
            }
        }
        for (j, round) in self.rounds.iter().enumerate() {
            round.check(&format!("{path}/rounds/{j}"), domain, &known, problems);
        }
    }
}

impl Round {
    fn check(&self, path: &str, domain: &Domain, known: &dyn Fn(&String) -> bool, problems: &mut Vec<Problem>) {
        for (j, hour) in self.hours.iter().enumerate().filter(|(_, id)| hours::get(id).is_none()) {
            let message = format!("`{hour}` is none of the hours {}", hours::ids().join(", "));
            problems.push(Problem::new(format!("{path}/hours/{j}"), message));
        }
        if !(1..=self.group[1]).contains(&self.group[0]) || self.group[1] > GROUP_SIZES[1] {
            let message = format!("{:?} is not within 1 and {} people", self.group, GROUP_SIZES[1]);
            problems.push(Problem::new(format!("{path}/group"), message));
        }
        for (j, step) in self.steps.iter().enumerate() {
            let path = format!("{path}/steps/{j}");
            for (k, name) in step.at.iter().enumerate().filter(|(_, name)| !known(name)) {
                let message = format!("room type `{name}` is not in room_types, nor is it a tag");
                problems.push(Problem::new(format!("{path}/at/{k}"), message));
            }
            if step.at.is_empty() == step.to_role.is_none() {
                problems.push(Problem::new(path.as_str(), "goes to rooms (`at`) or to people (`to_role`)"));
            }
            if step.to_role.as_ref().is_some_and(|id| !domain.roles.iter().any(|r| &r.id == id)) {
                problems.push(Problem::new(format!("{path}/to_role"), "is not in roles"));
            }
            if !(0.0 <= step.seconds[0] && step.seconds[0] <= step.seconds[1]) {
                problems.push(Problem::new(format!("{path}/seconds"), "needs 0 <= least <= most"));
            }
        }
    }
}

/// Tags of rooms that no visitor enters, whatever a role says.
pub const VISITORS_NEVER: [&str; 4] =
    [super::tags::STAFF, super::tags::SERVICE, super::tags::DIRTY, super::tags::RESTRICTED];

/// Returns true when a name means a room: the id of its type, or one of its tags.
pub fn is_named(name: &str, kind: &RoomType, tags: &BTreeSet<&str>) -> bool {
    kind.id == name || tags.contains(name)
}
