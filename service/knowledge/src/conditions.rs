//! Whether the conditions of a constraint hold for a building.

use d3dgen_model::knowledge::{Constraint, Reference};

use crate::query::Query;
use crate::tables::{ConditionRow, TABLES, When};

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
}

/// Returns what the conditions of a constraint come to.
pub(crate) fn evaluate(c: &Constraint, query: &Query) -> Conditions {
    let mut out = Conditions::default();
    for phrase in &c.conditions {
        let Some(row) = TABLES.condition(phrase) else {
            if !is_code(phrase) && out.unknown.is_none() {
                out.unknown = Some(format!("depends on \"{phrase}\", which the documents do not tell"));
            }
            continue;
        };
        out.except.extend(row.except.iter().cloned());
        out.reported_only |= row.reported_only;
        match guard(row) {
            Some(guard) => out.guards.push(guard),
            None if holds(row, query) => out.beds |= row.when == When::Beds,
            None => out.fails = Some(row.reason.clone().unwrap_or_else(|| format!("holds only for \"{phrase}\""))),
        }
    }
    out
}

/// Returns why the conditions of a constraint are never known to hold; `None` when some building meets them.
pub(crate) fn never(c: &Constraint) -> Option<String> {
    c.conditions.iter().find_map(|phrase| match TABLES.condition(phrase) {
        None if is_code(phrase) => None,
        None => Some(format!("depends on \"{phrase}\", which the documents do not tell")),
        Some(row) => (row.when == When::Never).then(|| row.reason.clone().unwrap_or_default()),
    })
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
        When::Beds => Some(beds),
        When::NoBeds => Some(!beds),
        When::TwoRobots => Some(query.robot_count() >= 2),
        When::Public | When::Persons | When::Area | When::RoomsOf | When::BedsInRoom => None,
        When::SeatsInRoom | When::ObjectsInRoom | When::Exits | When::Named => None,
        When::OpensInto | When::OpensOut => None,
    }
}

/// Returns true for room codes of guidelines, `1BR-ST` or `CLUR-12`: they name the room once more.
fn is_code(phrase: &str) -> bool {
    phrase.chars().any(|c| c.is_ascii_uppercase())
        && phrase.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || "-/. ".contains(c))
}
