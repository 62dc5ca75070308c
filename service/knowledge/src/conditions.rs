//! Whether the conditions of a constraint hold for a building.

use d3dgen_model::knowledge::{Constraint, Reference};

use crate::query::Query;
use crate::tables::{ConditionRow, QuantityRow, TABLES, When};

/// What the conditions of one constraint come to.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Conditions {
    /// Why the constraint does not apply at all.
    pub fails: Option<String>,
    /// Why it cannot be said whether it applies.
    pub unknown: Option<String>,
    /// What is left to ask of each room.
    pub guards: Vec<Guard>,
    /// Spaces the constraint leaves out.
    pub except: Vec<String>,
    /// True when it is about the ways of beds on wheels only.
    pub beds: bool,
    /// True when reports judge it and plans do not aim at it.
    pub reported_only: bool,
}

/// A condition that depends on the room.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Guard {
    /// Net floor area above the first and up to the second figure, m^2.
    Area(f64, f64),
    /// Number of beds, ends included.
    Beds(f64, f64),
    /// Number of seats, ends included.
    Seats(f64, f64),
    /// Number of objects of the row's kinds, ends included.
    Objects(&'static ConditionRow, f64, f64),
    /// Number of exits of the building, ends included.
    Exits(f64, f64),
    /// A word of the row is part of the room's name.
    Named(&'static ConditionRow),
    /// The door opens into the room (true) or out of it.
    OpensInto(bool),
    /// A figure of the room lies in the row's interval.
    Room(&'static ConditionRow),
    /// A figure of the finished building lies in the row's interval.
    Whole(&'static ConditionRow),
}

impl Guard {
    /// Returns true when plans aim at a figure although not every room has to keep it.
    pub(crate) fn is_planned(&self) -> bool {
        match self {
            Self::Room(row) | Self::Whole(row) => row.planned,
            // a room that several people work in
            Self::Seats(least, most) => *least <= 2.0 && *most == f64::MAX,
            _ => false,
        }
    }
}

/// Returns what the conditions of a constraint come to: those it names, and those its quantity brings along.
pub(crate) fn evaluate(c: &Constraint, quantity: Option<&QuantityRow>, query: &Query) -> Conditions {
    let mut out = Conditions::default();
    for phrase in phrases(c, quantity) {
        let Some(row) = TABLES.condition(phrase) else {
            if !is_code(phrase) && out.unknown.is_none() {
                out.unknown = Some(not_told(phrase));
            }
            continue;
        };
        out.except.extend(row.except.iter().cloned());
        out.reported_only |= row.reported_only;
        match guard(row) {
            Some(guard) => out.guards.push(guard),
            None if !holds(row, query) => {
                out.fails = Some(row.reason.clone().unwrap_or_else(|| format!("holds only for \"{phrase}\"")));
            }
            None if row.when.is_unknown() => {
                out.unknown.get_or_insert_with(|| row.reason.clone().unwrap_or_else(|| not_told(phrase)));
            }
            None => out.beds |= row.when == When::Beds,
        }
    }
    out
}

/// Returns why the conditions of a constraint are never known to hold; `None` when some building meets them.
pub(crate) fn never(c: &Constraint, quantity: Option<&QuantityRow>) -> Option<String> {
    let rows = phrases(c, quantity).filter_map(|phrase| TABLES.condition(phrase));
    rows.filter(|row| row.when == When::Never).map(|row| row.reason.clone().unwrap_or_default()).next()
}

/// Returns which condition no document tells; a world that keeps the figure all the same keeps the constraint.
pub(crate) fn untold(c: &Constraint, quantity: Option<&QuantityRow>) -> Option<String> {
    phrases(c, quantity).find_map(|phrase| match TABLES.condition(phrase) {
        None => (!is_code(phrase)).then(|| not_told(phrase)),
        Some(row) => row.when.is_unknown().then(|| row.reason.clone().unwrap_or_else(|| not_told(phrase))),
    })
}

fn phrases<'a>(c: &'a Constraint, quantity: Option<&'a QuantityRow>) -> impl Iterator<Item = &'a String> {
    c.conditions.iter().chain(quantity.into_iter().flat_map(|q| &q.conditions))
}

fn not_told(phrase: &str) -> String {
    format!("depends on \"{phrase}\", which the documents do not tell")
}

/// Returns true when a document is about buildings such as this one.
pub(crate) fn document_holds(reference: &Reference, query: &Query) -> bool {
    let titled = |title: &String| reference.sources.iter().any(|s| s.title.contains(title.as_str()));
    let rows = TABLES.documents.iter().filter(|d| d.domains.contains(&query.domain) && d.titles.iter().any(titled));
    rows.into_iter().all(|d| fact(d.when, query).unwrap_or(true))
}

fn guard(row: &'static ConditionRow) -> Option<Guard> {
    let (min, max) = (row.min.unwrap_or(f64::MIN), row.max.unwrap_or(f64::MAX));
    match row.when {
        When::Area => Some(Guard::Area(min, max)),
        When::BedsInRoom => Some(Guard::Beds(min, max)),
        When::SeatsInRoom => Some(Guard::Seats(min, max)),
        When::ObjectsInRoom => Some(Guard::Objects(row, min, max)),
        When::Exits => Some(Guard::Exits(min, max)),
        When::Named => Some(Guard::Named(row)),
        When::OpensInto => Some(Guard::OpensInto(true)),
        When::OpensOut => Some(Guard::OpensInto(false)),
        when if when.is_of_room() => Some(Guard::Room(row)),
        when if when.is_of_building() => Some(Guard::Whole(row)),
        _ => None,
    }
}

fn holds(row: &ConditionRow, query: &Query) -> bool {
    if let Some(fact) = fact(row.when, query) {
        return fact;
    }
    match row.when {
        When::Public => query.accessible || !row.except_domains.contains(&query.domain),
        When::Persons => row.holds(f64::from(query.persons)),
        When::RoomsOf => {
            let count: u32 =
                query.rooms.iter().filter(|r| row.room_types.contains(&r.room_type)).map(|r| r.count).sum();
            row.holds(f64::from(count))
        }
        When::RobotKind | When::Robots | When::RobotModel => {
            query.robots.iter().any(|r| row.words.is_empty() || row.words.contains(&r.kind))
        }
        When::BuildingType => query.building_type.as_ref().is_some_and(|t| row.words.contains(t)),
        _ => true,
    }
}

/// Returns whether a fact holds that needs no figures of a row.
fn fact(when: When, query: &Query) -> Option<bool> {
    let beds = query.rooms.iter().any(|r| r.beds);
    match when {
        When::Always => Some(true),
        When::Never => Some(false),
        When::Accessible => Some(query.accessible),
        When::Wheelchair => Some(query.wheelchair),
        When::Beds => Some(beds),
        When::NoBeds => Some(!beds),
        When::TwoRobots => Some(query.robot_count() >= 2),
        _ => None,
    }
}

/// Returns true for room codes of guidelines, `1BR-ST` or `CLUR-12`: they name the room once more.
fn is_code(phrase: &str) -> bool {
    phrase.chars().any(|c| c.is_ascii_uppercase())
        && phrase.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || "-/. ".contains(c))
}
