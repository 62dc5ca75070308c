//! Which constraints of a knowledge base apply to a building, what each is about, and what it requires.

use std::collections::BTreeSet;

use d3dgen_model::domain::Shape;
use d3dgen_model::knowledge::{AMENDMENT, Constraint, KnowledgeBase, Reference, Value};
use d3dgen_model::report::Citation;

use crate::conditions::{self, Conditions, Guard};
use crate::draw_limits;
use crate::figure::{self, Bounds};
use crate::jurisdiction;
use crate::limits::Limits;
use crate::measure::Measure;
use crate::query::Query;
use crate::resolve::{self, Conflict, Policy};
use crate::tables::{QuantityRow, SpaceKind, TABLES};

/// The constraints of a building.
#[derive(Debug, Clone, PartialEq)]
pub struct Retrieval {
    /// Jurisdictions whose rules were taken, nearest first.
    pub jurisdictions: Vec<String>,
    /// Jurisdictions of the country and of its division; empty where no country is known.
    pub national: Vec<String>,
    /// Constraints about something in the building, in the order of the knowledge base.
    pub constraints: Vec<Applicable>,
    /// Constraints of these jurisdictions about something the building does not have.
    pub not_applicable: u32,
    /// Figures for the floorplan.
    pub limits: Limits,
    /// People at a time that figures by head count were taken for.
    pub persons: u32,
    /// False when `persons` is only reckoned from the area.
    pub persons_stated: bool,
    /// Number of robots.
    pub robots: u32,
    /// Where mandatory constraints contradict each other, and which one is kept.
    pub conflicts: Vec<Conflict>,
}

/// A constraint that applies.
#[derive(Debug, Clone, PartialEq)]
pub struct Applicable {
    /// The rule.
    pub constraint: Constraint,
    /// Reference it belongs to.
    pub ref_id: String,
    /// Where it comes from.
    pub citation: Citation,
    /// True for regulations and standards, false for advice.
    pub mandatory: bool,
    /// What it is about.
    pub scope: Scope,
    /// Conditions that remain to be asked of each room.
    pub guards: Vec<Guard>,
    /// Which condition the documents do not tell: the constraint is kept where its figure is, else nobody can say.
    pub unsure: Option<String>,
    /// How it is measured and what it requires, or why it cannot be decided.
    pub decision: Result<Rule, String>,
    /// Id of the constraint that goes before this one: of a nearer jurisdiction, or by the policy asked for.
    pub superseded_by: Option<String>,
    /// True when reports judge it and plans do not aim at it.
    pub reported_only: bool,
}

impl Applicable {
    /// Returns true for rules whose figure somebody read where it is printed, in more than a page of the web that nothing
    /// vouches for: plans go by these only.
    pub fn is_vouched_for(&self) -> bool {
        self.constraint.verified != PARTLY_SEEN && self.citation.source.source_type != WEB_PAGE
    }

    /// Returns true where free floor on one of both sides is enough.
    pub fn is_one_sided(&self) -> bool {
        self.constraint.measurement_basis.contains("one side")
    }
}

/// Word of `verified` for what a search quoted of a page that nobody read.
const PARTLY_SEEN: &str = "partly_seen";
/// Type of sources of which nothing says what they are.
const WEB_PAGE: &str = "web_page";

/// What a constraint is about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Scope {
    /// Rooms of these types.
    Rooms(BTreeSet<String>),
    /// Corridors and halls.
    Circulation,
    /// Every door of rooms.
    Doors,
    /// The main entrance door.
    Entrance,
    /// The building as a whole.
    Building,
    /// Objects of these builds.
    Objects(Vec<Shape>),
}

impl Scope {
    /// Returns true when something is in both scopes.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Rooms(a), Self::Rooms(b)) => !a.is_disjoint(b),
            _ => self == other,
        }
    }
}

/// A quantity with its required figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// What is measured.
    pub quantity: &'static QuantityRow,
    /// What is required.
    pub bounds: Bounds,
    /// Room types of the other space of distances and pairs.
    pub to: BTreeSet<String>,
}

/// Returns the constraints that apply to a building; where they contradict each other, the nearest jurisdiction goes
/// first, and in it the strictest figure.
pub fn retrieve(knowledge: &KnowledgeBase, query: &Query) -> Retrieval {
    retrieve_with(knowledge, query, &Policy::Strictest)
}

/// Returns the mandatory constraints that ask for a kind of room the building does not have.
///
/// Looks at nothing else, for it is asked of a building whose rooms are not settled yet.
pub fn missing_rooms(knowledge: &KnowledgeBase, query: &Query) -> Vec<Applicable> {
    let chain = jurisdiction::chain(query.country_code.as_deref());
    let references = knowledge.references.iter().filter(|r| chain.contains(&r.jurisdiction));
    let mut asking: Vec<Applicable> = references
        .filter(|r| conditions::document_holds(r, query))
        .flat_map(|r| r.constraints.iter().map(move |c| (r, c)))
        .filter(|(_, c)| TABLES.quantity_of(c, asks_for_rooms).is_some())
        .filter_map(|(reference, c)| applicable(c, reference, query, &knowledge.metadata.date))
        .collect();
    resolve::settle(&mut asking, &chain, &Policy::Strictest);
    asking.retain(|a| {
        let none = matches!(&a.scope, Scope::Rooms(types) if types.is_empty());
        let asks = a.decision.as_ref().is_ok_and(|rule| rule.bounds.min.is_some_and(|n| n >= 1.0));
        none && asks && a.mandatory
    });
    asking
}

/// As [`retrieve`], with another rule for sources of one jurisdiction that contradict each other.
pub fn retrieve_with(knowledge: &KnowledgeBase, query: &Query, policy: &Policy) -> Retrieval {
    let chain = jurisdiction::chain(query.country_code.as_deref());
    let mut constraints = Vec::new();
    let mut not_applicable = 0;
    for reference in knowledge.references.iter().filter(|r| chain.contains(&r.jurisdiction)) {
        if !conditions::document_holds(reference, query) {
            not_applicable += reference.constraints.len() as u32;
            continue;
        }
        for constraint in &reference.constraints {
            match applicable(constraint, reference, query, &knowledge.metadata.date) {
                Some(found) => constraints.push(found),
                None => not_applicable += 1,
            }
        }
    }
    let mut planned: Vec<Applicable> = constraints.iter().filter(|a| !a.reported_only).cloned().collect();
    resolve::settle(&mut planned, &chain, policy);
    let conflicts = resolve::settle(&mut constraints, &chain, policy);
    let limits = draw_limits::draw(&planned, &constraints, &chain, query);
    // plans leave room for robots that may come; a world without any breaks none of their rules
    let before = constraints.len();
    constraints.retain(|a| !query.robots.is_empty() || !is_about_robots(a));
    not_applicable += (before - constraints.len()) as u32;
    let used = |code: &String| {
        code == jurisdiction::INTERNATIONAL || constraints.iter().any(|c| &c.citation.jurisdiction == code)
    };
    Retrieval {
        jurisdictions: chain.iter().filter(|c| used(c)).cloned().collect(),
        national: jurisdiction::national(query.country_code.as_deref()),
        not_applicable,
        limits,
        persons: query.persons,
        persons_stated: query.persons_stated,
        robots: query.robot_count(),
        constraints,
        conflicts,
    }
}

/// Returns a constraint with its meaning for this building; `None` when it is about nothing there. What had ended `on` the day
/// of the knowledge base binds nobody.
fn applicable(c: &Constraint, reference: &Reference, query: &Query, on: &str) -> Option<Applicable> {
    let quantity = TABLES.quantity(c);
    let conditions = conditions::evaluate(c, quantity, query);
    if conditions.fails.is_some() {
        return None;
    }
    // a rule that asks for a room speaks of buildings without it too
    let presence = quantity.is_some_and(|q| asks_for_rooms(q.measure) || q.measure == Measure::RoomKindArea);
    let scope = match scope(&c.space_type, query) {
        None if presence => Scope::Rooms(BTreeSet::new()),
        found => narrowed(found?, &conditions, query)?,
    };
    let decision = match quantity {
        None => Err(TABLES.unknown(c)),
        Some(quantity) => figure::bounds(c, quantity.measure, &query.facts()).map(|bounds| Rule {
            quantity,
            bounds,
            to: quantity.to.iter().flat_map(|s| types_of(s, query)).collect(),
        }),
    };
    Some(Applicable {
        citation: citation(c, reference)?,
        mandatory: is_mandatory(c, reference)
            && !c.has_ended(on)
            && conditions.unknown.is_none()
            && !quantity.is_some_and(|q| q.advice),
        reported_only: conditions.reported_only
            || quantity.is_some_and(|q| q.reported_only)
            || matches!(c.value, Value::Expression { .. }),
        constraint: c.clone(),
        ref_id: reference.ref_id.clone(),
        scope,
        guards: conditions.guards,
        unsure: conditions.unknown,
        decision,
        superseded_by: None,
    })
}

/// Returns true for rules about robots, their software and machines that move, other than laws on what a building has.
fn is_about_robots(a: &Applicable) -> bool {
    let law = a.citation.source.source_type == "regulation" && a.decision.is_ok();
    a.constraint.topic == draw_limits::ROBOT_TOPIC && !law
}

/// Returns true for quantities of rooms that a building may lack.
fn asks_for_rooms(measure: Measure) -> bool {
    matches!(measure, Measure::RoomsPresent | Measure::RoomNeededAbovePersons)
}

/// Returns what a space name means in this building; `None` when it has none of it.
fn scope(space: &str, query: &Query) -> Option<Scope> {
    let named = types_of(space, query);
    match TABLES.space(space, &query.domain).map(|s| (s.kind, s)) {
        Some((SpaceKind::Circulation, _)) if query.rooms.iter().any(|r| r.circulation) || !named.is_empty() => {
            Some(Scope::Circulation)
        }
        Some((SpaceKind::Circulation, _)) => None,
        Some((SpaceKind::AllRooms, _)) => Some(Scope::Rooms(query.rooms.iter().map(|r| r.room_type.clone()).collect())),
        Some((SpaceKind::Doors, _)) => Some(Scope::Doors),
        Some((SpaceKind::Entrance, _)) => Some(Scope::Entrance),
        Some((SpaceKind::Building, _)) => Some(Scope::Building),
        Some((SpaceKind::Objects, row)) => Some(Scope::Objects(row.shapes.clone())),
        Some((SpaceKind::Robots, _)) => (!query.robots.is_empty()).then_some(Scope::Building),
        Some((SpaceKind::Rooms, _)) | None => (!named.is_empty()).then_some(Scope::Rooms(named)),
    }
}

/// Returns the room types at hand that a space name covers.
fn types_of(space: &str, query: &Query) -> BTreeSet<String> {
    let row = TABLES.space(space, &query.domain);
    let rooms = query.rooms.iter().filter(|r| {
        r.room_type == space
            || r.spaces.iter().any(|s| s == space)
            || row.is_some_and(|row| row.kind == SpaceKind::Rooms && row.room_types.contains(&r.room_type))
    });
    rooms.map(|r| r.room_type.clone()).collect()
}

/// Takes from a scope what the conditions leave out.
fn narrowed(scope: Scope, conditions: &Conditions, query: &Query) -> Option<Scope> {
    let rolling = || query.rooms.iter().filter(|r| r.beds).map(|r| r.room_type.clone()).collect::<BTreeSet<_>>();
    let scope = match scope {
        Scope::Doors if conditions.beds => Scope::Rooms(rolling()),
        Scope::Rooms(types) if conditions.beds => Scope::Rooms(types.intersection(&rolling()).cloned().collect()),
        other => other,
    };
    let except: BTreeSet<String> = conditions.except.iter().flat_map(|s| types_of(s, query)).collect();
    match scope {
        Scope::Rooms(types) => {
            let left: BTreeSet<String> = types.difference(&except).cloned().collect();
            (!left.is_empty()).then_some(Scope::Rooms(left))
        }
        other => Some(other),
    }
}

fn citation(c: &Constraint, reference: &Reference) -> Option<Citation> {
    let source = c.source_ids.iter().find_map(|id| reference.sources.iter().find(|s| &s.source_id == id))?;
    Some(Citation {
        jurisdiction: reference.jurisdiction.clone(),
        source: source.clone(),
        note: c.note.clone(),
        printed: c.original_value.clone(),
        confidence: c.confidence.clone(),
        clause: c.clause.clone(),
        quotation: c.quotation.clone(),
        seen_at: c.seen_at.clone(),
        in_force_until: c.in_force_until.clone(),
        superseded_by: c.superseded_by.clone(),
    })
}

/// Returns true for rules of law, of standards and of the owner; a rule that was amended keeps the force of its source.
fn is_mandatory(c: &Constraint, reference: &Reference) -> bool {
    let sources = || c.source_ids.iter().filter_map(|id| reference.sources.iter().find(|s| &s.source_id == id));
    let source = sources().find(|s| s.source_type != AMENDMENT).or_else(|| sources().next());
    source.is_some_and(|s| matches!(s.source_type.as_str(), "regulation" | "standard" | AMENDMENT))
        && c.verified != PARTLY_SEEN
        && !matches!(c.constraint_type.as_str(), "recommendation" | "rule_of_thumb")
}
