//! Figures of a knowledge base as a whole: how much it holds, from where, and what share of it worlds can be held against.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Domain, ObjectType, RoomType};
use d3dgen_model::knowledge::{Constraint, KnowledgeBase};
use serde::Serialize;

use crate::conditions;
use crate::figure::{self, Facts};
use crate::tables::{QuantityRow, SpaceKind, TABLES};

/// Facts of a building in which every formula and table has a figure.
const SOME_BUILDING: Facts =
    Facts { persons: 4, robots: 2, robot_radius: Some(0.3), robot_body: [None; 2], bedrooms: 2 };

/// Counts of one knowledge base.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stats {
    /// Domain id.
    pub domain: String,
    /// Documents.
    pub references: usize,
    /// Rules drawn from them.
    pub constraints: usize,
    /// Rules for each document.
    pub constraints_per_reference: f64,
    /// Distinct spaces that rules speak of.
    pub room_types: usize,
    /// Distinct kinds of constraint (`minimum`, `ratio`, ...).
    pub type_families: usize,
    /// Distinct places whose rules there are.
    pub jurisdictions: usize,
    /// Rules by confidence.
    pub confidence: BTreeMap<String, usize>,
    /// Size of the file, bytes.
    pub file_bytes: usize,
    /// Rules that some world of the domain can be held against.
    pub decided: usize,
    /// Those among them of which worlds are sure one way only: a condition is not told, or the figure is a bound.
    pub decided_one_way: usize,
    /// Decided rules over all rules.
    pub share_decided: f64,
    /// Rules that no world can be held against, by reason.
    pub not_decidable: BTreeMap<String, usize>,
}

impl Stats {
    /// Counts a knowledge base; `file_bytes` is the size it is stored in.
    pub fn of(knowledge: &KnowledgeBase, domain: &Domain, file_bytes: usize) -> Self {
        let all = || knowledge.references.iter().flat_map(|r| &r.constraints);
        let distinct = |word: fn(&Constraint) -> &str| all().map(word).collect::<BTreeSet<_>>().len();
        let (references, constraints) = (knowledge.references.len(), all().count());
        let (mut confidence, mut not_decidable, mut decided_one_way) = (BTreeMap::new(), BTreeMap::new(), 0);
        for c in all() {
            *confidence.entry(c.confidence.clone()).or_insert(0) += 1;
            match decidable(c, domain) {
                Err(reason) => *not_decidable.entry(reason).or_insert(0) += 1,
                Ok(()) => decided_one_way += usize::from(is_one_way(c)),
            }
        }
        let decided = constraints - not_decidable.values().sum::<usize>();
        let places: BTreeSet<&str> = knowledge.references.iter().map(|r| r.jurisdiction.as_str()).collect();
        let share = |part: usize, whole: usize| if whole > 0 { part as f64 / whole as f64 } else { 0.0 };
        Self {
            domain: domain.id.clone(),
            references,
            constraints,
            constraints_per_reference: share(constraints, references),
            room_types: distinct(|c| &c.space_type),
            type_families: distinct(|c| &c.constraint_type),
            jurisdictions: places.len(),
            confidence,
            file_bytes,
            decided,
            decided_one_way,
            share_decided: share(decided, constraints),
            not_decidable,
        }
    }
}

/// Tells whether some world of a domain can be held against a constraint: its quantity, conditions and figure are
/// understood, and worlds of the domain have what it is about.
///
/// # Errors
/// Says what is missing.
pub fn decidable(c: &Constraint, domain: &Domain) -> Result<(), String> {
    let quantity = TABLES.quantity(c).ok_or_else(|| TABLES.unknown(c))?;
    if let Some(reason) = conditions::never(c, Some(quantity)) {
        return Err(reason);
    }
    figure::bounds(c, quantity.measure, &SOME_BUILDING)?;
    if has_subject(c, quantity, domain) {
        Ok(())
    } else {
        Err(format!("no world of {} has what `{}` is about", domain.id, c.space_type))
    }
}

/// Returns true when worlds are sure of one verdict only.
fn is_one_way(c: &Constraint) -> bool {
    let quantity = TABLES.quantity(c);
    quantity.is_some_and(|q| q.sure.is_some()) || conditions::untold(c, quantity).is_some()
}

/// Returns true when worlds of the domain have the space of a constraint, and the objects it is about stand there.
fn has_subject(c: &Constraint, quantity: &QuantityRow, domain: &Domain) -> bool {
    let row = TABLES.space(&c.space_type, &domain.id);
    let named = |t: &&RoomType| t.id == c.space_type || t.spaces.contains(&c.space_type);
    let in_row = |t: &&RoomType| row.is_some_and(|r| r.kind == SpaceKind::Rooms && r.room_types.contains(&t.id));
    let mut rooms: Vec<&RoomType> = domain.room_types.iter().filter(|t| named(t) || in_row(t)).collect();
    let everywhere = row.is_some_and(|r| r.kind != SpaceKind::Rooms);
    if everywhere {
        rooms = domain.room_types.iter().collect();
    }
    let shapes = row.map(|r| r.shapes.as_slice()).unwrap_or_default();
    let wanted = |o: &ObjectType| match quantity.names_objects() {
        true => quantity.picks(o),
        false => shapes.contains(&o.shape),
    };
    let about_objects = quantity.names_objects() || !shapes.is_empty();
    if about_objects { rooms.iter().any(|t| holds(t, domain, &wanted)) } else { everywhere || !rooms.is_empty() }
}

/// Returns true when a room type may be furnished with such an object.
fn holds(room: &RoomType, domain: &Domain, wanted: &dyn Fn(&ObjectType) -> bool) -> bool {
    let is_wanted = |id: &str| domain.object(id).is_some_and(wanted);
    room.furnishing.iter().any(|f| match domain.group(&f.item) {
        Some(group) => is_wanted(&group.anchor) || group.members.iter().any(|m| is_wanted(&m.object)),
        None => is_wanted(&f.item),
    })
}
