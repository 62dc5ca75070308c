//! How a finished world fares against the constraints that apply to it: measured, required, status, source.
//!
//! Areas and extents are net, between wall faces. A constraint on many rooms, doors or objects is listed once for each
//! that breaks it, or once with the closest call when all hold.

mod approach;
mod counts;
mod doors;
mod objects;
mod rooms;
mod routes;
mod site;
mod sizes;
mod spacing;

use d3dgen_model::domain::Domain;
use d3dgen_model::report::{ConstraintResult, ConstraintSummary, Status};
use d3dgen_model::world::World;

use crate::measure::Measure;
use crate::retrieve::{Applicable, Retrieval, Rule};
use site::Site;

/// Lengths and areas closer than this to their limit meet it.
const SLACK: f64 = 1e-3;

/// A measured figure of one thing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reading {
    /// Id of the room, door or placement, or `building`.
    pub subject: String,
    /// The figure, in the constraint's unit.
    pub value: f64,
}

impl Reading {
    fn new(subject: &str, value: f64) -> Self {
        Self { subject: subject.to_owned(), value }
    }

    /// Returns the reading of a statement: 1 when it holds.
    fn flag(subject: &str, holds: bool) -> Self {
        Self::new(subject, if holds { 1.0 } else { 0.0 })
    }
}

/// Evaluates every constraint that applies, in the order of the retrieval.
///
/// What has no subject in this world is counted in the summary and not listed.
pub fn evaluate(world: &World, domain: &Domain, retrieval: &Retrieval) -> (Vec<ConstraintResult>, ConstraintSummary) {
    let site = Site::new(world, domain, retrieval);
    let mut summary = ConstraintSummary { not_applicable: retrieval.not_applicable, ..ConstraintSummary::default() };
    let mut out = Vec::new();
    for a in &retrieval.constraints {
        let rule = match &a.decision {
            Ok(rule) => rule,
            Err(reason) => {
                summary.not_decidable += 1;
                out.push(result(a, None, "building", Status::NotDecidable, None, reason.clone()));
                continue;
            }
        };
        let readings = readings(&site, a, rule);
        if readings.is_empty() {
            summary.not_applicable += 1;
            continue;
        }
        let found = judge(a, rule, &readings, retrieval);
        match found.first().map(|r| r.status) {
            Some(Status::Violated) => summary.violated += 1,
            _ => summary.satisfied += 1,
        }
        out.extend(found);
    }
    (out, summary)
}

/// Reads the quantity wherever the world has it; each family of quantities answers for its own.
fn readings(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    if !site.admits(a, rule.quantity.single_exit) {
        return Vec::new();
    }
    let families = [rooms::read, doors::read, routes::read, counts::read, objects::read];
    families.iter().flat_map(|read| read(site, a, rule)).collect()
}

/// Returns one result for each reading that breaks the rule, or the closest call.
fn judge(a: &Applicable, rule: &Rule, readings: &[Reading], retrieval: &Retrieval) -> Vec<ConstraintResult> {
    let (min, max) = required(rule);
    // distance to the nearer limit: negative when broken
    let margin = |r: &Reading| {
        let low = min.map_or(f64::MAX, |m| r.value - m);
        let high = max.map_or(f64::MAX, |m| m - r.value);
        low.min(high)
    };
    let note = |extra: String| {
        let mut parts = vec![extra];
        if let Some([short, long]) = rule.bounds.sides {
            parts.push(format!("needs {short} x {long} m; measured is the width at that length"));
        }
        if rule.quantity.measure == Measure::ObjectExtents {
            parts.push("measured is how far an extent lies outside the usual ones, a tenth off allowed".to_owned());
        }
        if let Some(id) = &a.superseded_by {
            parts.push(format!("{id} of a nearer jurisdiction goes before it"));
        }
        if by_head_count(a) && rule.quantity.measure != Measure::DocksPerRobot && !retrieval.persons_stated {
            parts.push(format!("for {} people, reckoned from the area", retrieval.persons));
        }
        parts.retain(|p| !p.is_empty());
        parts.join("; ")
    };
    let broken: Vec<&Reading> = readings.iter().filter(|r| margin(r) < -SLACK).collect();
    if !broken.is_empty() {
        let each = broken.into_iter();
        return each
            .map(|r| result(a, Some(rule), &r.subject, Status::Violated, Some(r.value), note(String::new())))
            .collect();
    }
    let closest = readings.iter().min_by(|x, y| margin(x).total_cmp(&margin(y)));
    let among = if readings.len() > 1 { format!("closest of {}", readings.len()) } else { String::new() };
    closest
        .map(|r| result(a, Some(rule), &r.subject, Status::Satisfied, Some(r.value), note(among)))
        .into_iter()
        .collect()
}

fn by_head_count(a: &Applicable) -> bool {
    a.constraint.constraint_type == "table" || a.constraint.unit == "count"
}

/// Returns the least and largest allowed figures; for a needed room the figure is the head count, not the room count.
fn required(rule: &Rule) -> (Option<f64>, Option<f64>) {
    match rule.quantity.measure {
        Measure::RoomNeededAbovePersons => (Some(1.0), None),
        _ => (rule.bounds.min, rule.bounds.max),
    }
}

fn result(
    a: &Applicable,
    rule: Option<&Rule>,
    subject: &str,
    status: Status,
    measured: Option<f64>,
    note: String,
) -> ConstraintResult {
    let (required_min, required_max) = rule.map_or((None, None), required);
    ConstraintResult {
        constraint_id: a.constraint.constraint_id.clone(),
        ref_id: a.ref_id.clone(),
        name: a.constraint.name.clone(),
        subject: subject.to_owned(),
        status,
        mandatory: a.mandatory,
        measured: measured.map(|v| (v * 1000.0).round() / 1000.0),
        required_min,
        required_max,
        unit: a.constraint.unit.clone(),
        note,
        citation: a.citation.clone(),
    }
}
