//! How a finished world fares against the constraints that apply to it: measured, required, status, source.
//!
//! Areas and extents are net, between wall faces. A constraint on many rooms, doors or objects is listed once for each
//! that breaks it, or once with the closest call when all hold.

mod approach;
mod circle;
mod counts;
mod doors;
mod fixtures;
mod kitchen;
mod objects;
pub(crate) mod reading;
mod robots;
mod rooms;
mod routes;
mod sight;
mod site;
pub(crate) mod sizes;
mod spacing;
mod stairs;

use d3dgen_model::domain::Domain;
use d3dgen_model::knowledge::Value;
use d3dgen_model::report::{ConstraintResult, ConstraintSummary, Status};
use d3dgen_model::world::World;

use crate::measure::Measure;
use crate::retrieve::{Applicable, Retrieval, Rule};
use crate::tables::Sure;
use reading::{Reading, SLACK};
use site::Site;

/// Returns the room from which the way out is longest, and how long it is, m; of several storeys to the stairs. `None` where no
/// way of the building can be longer than `least`, or nothing leads out.
pub fn longest_way_out(world: &World, domain: &Domain, retrieval: &Retrieval, least: f64) -> Option<(String, f64)> {
    let whole = world.floorplan.rooms.iter().map(|r| r.polygon.bounds()).reduce(|a, b| a.union(&b))?;
    if whole.width() + whole.height() <= least {
        return None;
    }
    let storeys = world.storeys();
    let ways = storeys.iter().flat_map(|(_, storey)| routes::farthest_from_exit(&Site::new(storey, domain, retrieval)));
    let longest = ways.max_by(|a, b| a.value.total_cmp(&b.value))?;
    Some((longest.subject, longest.value))
}

/// Evaluates every constraint that applies, in the order of the retrieval.
///
/// What has no subject in this world is counted in the summary and not listed.
pub fn evaluate(world: &World, domain: &Domain, retrieval: &Retrieval) -> (Vec<ConstraintResult>, ConstraintSummary) {
    // figures of the building are of all storeys, what is measured on a floor is of one after the other
    let site = Site::new(world, domain, retrieval);
    let several = world.floorplan.has_storeys();
    let storeys = if several { world.storeys() } else { Vec::new() };
    let storeys: Vec<Site> = storeys.iter().map(|(_, storey)| Site::new(storey, domain, retrieval)).collect();
    let mut summary = ConstraintSummary { not_applicable: retrieval.not_applicable, ..ConstraintSummary::default() };
    let mut out = Vec::new();
    for a in &retrieval.constraints {
        let national = u32::from(a.mandatory && retrieval.national.contains(&a.citation.jurisdiction));
        let rule = match &a.decision {
            Ok(rule) => rule,
            Err(reason) => {
                summary.national_mandatory += national;
                summary.not_decidable += 1;
                out.push(result(a, None, "building", Status::NotDecidable, None, reason.clone()));
                continue;
            }
        };
        let readings = readings(&site, &storeys, a, rule);
        if readings.is_empty() {
            summary.not_applicable += 1;
            continue;
        }
        let found = judge(a, rule, &readings, retrieval);
        summary.national_mandatory += national;
        if found.first().is_some_and(|r| r.status != Status::NotDecidable) {
            summary.national_decided += national;
        }
        match found.first().map(|r| r.status) {
            Some(Status::Violated) => summary.violated += 1,
            Some(Status::NotDecidable) => summary.not_decidable += 1,
            _ => summary.satisfied += 1,
        }
        out.extend(found);
    }
    (out, summary)
}

/// Reads the quantity wherever the world has it; each family of quantities answers for its own.
fn readings(site: &Site, storeys: &[Site], a: &Applicable, rule: &Rule) -> Vec<Reading> {
    let ground = storeys.first().unwrap_or(site);
    if !ground.admits(a, rule.quantity.single_exit) {
        return Vec::new();
    }
    let floors = if storeys.is_empty() { std::slice::from_ref(site) } else { storeys };
    let each = |read: fn(&Site, &Applicable, &Rule) -> Vec<Reading>| floors.iter().flat_map(move |f| read(f, a, rule));
    let measured = [rooms::read, doors::read, routes::read, sight::read].into_iter().flat_map(each);
    let counted = counts::read(site, a, rule);
    let used = [objects::read, robots::read].into_iter().flat_map(each);
    measured.chain(counted).chain(used).collect()
}

/// Returns one result for each reading that breaks the rule, or the closest call; one that says why nobody can tell where
/// the documents bound the figure from one side only, or do not say whether the rule applies.
fn judge(a: &Applicable, rule: &Rule, readings: &[Reading], retrieval: &Retrieval) -> Vec<ConstraintResult> {
    let (min, max) = required(rule);
    // distance to the nearer limit: negative when broken
    let margin = |r: &Reading| {
        let low = min.map_or(f64::MAX, |m| r.value - m);
        let high = max.map_or(f64::MAX, |m| m - r.value);
        low.min(high)
    };
    let order = |x: &&Reading, y: &&Reading| margin(x).total_cmp(&margin(y));
    let one = |r: Option<&Reading>, status: Status, extra: String| {
        let note = note(a, rule, retrieval, extra);
        r.map(|r| result(a, Some(rule), &r.subject, status, Some(r.value), note)).into_iter().collect()
    };
    let mut broken: Vec<&Reading> = readings.iter().filter(|r| margin(r) < -SLACK).collect();
    if rule.quantity.any && broken.len() < readings.len() {
        broken.clear();
    }
    // one place that keeps a rule is enough for some: the tightest of those that do is told then
    let keeping = readings.iter().filter(|r| margin(r) >= -SLACK).count();
    let closest = match rule.quantity.any && keeping > 0 {
        true => readings.iter().filter(|r| margin(r) >= -SLACK).min_by(order),
        false if rule.quantity.any => readings.iter().max_by(order),
        false => readings.iter().min_by(order),
    };
    if let Some(reason) = nobody_knows(a, rule, retrieval, broken.is_empty()) {
        return one(closest, Status::NotDecidable, reason);
    }
    if let Some(reason) = outranked(a, rule, retrieval).filter(|_| !broken.is_empty()) {
        return one(closest, Status::NotDecidable, reason);
    }
    if rule.quantity.any && !broken.is_empty() {
        return one(closest, Status::Violated, format!("best of {}", readings.len()));
    }
    if !broken.is_empty() {
        let text = note(a, rule, retrieval, against(a, rule, retrieval));
        let each = broken.into_iter();
        return each
            .map(|r| result(a, Some(rule), &r.subject, Status::Violated, Some(r.value), text.clone()))
            .collect();
    }
    let among = match readings.len() {
        0 | 1 => String::new(),
        all if keeping < all => format!("closest of {keeping} of {all} that keep it"),
        all => format!("closest of {all}"),
    };
    let whatever = a.unsure.as_ref().map(|reason| format!("kept either way: {reason}"));
    let parts: Vec<String> = [Some(among), whatever].into_iter().flatten().filter(|p| !p.is_empty()).collect();
    one(closest, Status::Satisfied, parts.join("; "))
}

/// Returns why advice is not followed where other constraints on the same thing leave no figure that keeps both.
fn against(a: &Applicable, rule: &Rule, retrieval: &Retrieval) -> String {
    let first = rivals(a, rule, retrieval).next();
    first.map_or(String::new(), |b| format!("no figure keeps this and {}", b.constraint.constraint_id))
}

/// Returns the constraints on the same thing that leave no figure that keeps both them and this advice.
fn rivals<'r>(a: &'r Applicable, rule: &'r Rule, retrieval: &'r Retrieval) -> impl Iterator<Item = &'r Applicable> {
    let (min, max) = required(rule);
    let apart = move |other: &Applicable, r: &Rule| {
        let (low, high) = required(r);
        let disjoint = min.zip(high).is_some_and(|(m, h)| m > h) || max.zip(low).is_some_and(|(m, l)| m < l);
        disjoint && r.quantity.measure == rule.quantity.measure && r.to == rule.to && a.scope.meets(&other.scope)
    };
    let all = retrieval.constraints.iter().filter_map(|b| Some((b, b.decision.as_ref().ok()?)));
    all.filter(move |(b, r)| b.superseded_by.is_none() && !a.mandatory && apart(b, r)).map(|(b, _)| b)
}

/// Returns why advice says nothing here: a law, or advice of a nearer jurisdiction, asks what rules it out. A single room of
/// 19 m^2, as advised in the country, is no breach of the 15 to 18 m^2 advised anywhere.
fn outranked(a: &Applicable, rule: &Rule, retrieval: &Retrieval) -> Option<String> {
    let rank = |b: &Applicable| retrieval.jurisdictions.iter().position(|j| *j == b.citation.jurisdiction);
    let first = rivals(a, rule, retrieval).find(|b| b.guards.is_empty() && (b.mandatory || rank(b) < rank(a)))?;
    Some(format!("no figure keeps this and {}, which goes before it", first.constraint.constraint_id))
}

/// Returns why a verdict would be a guess.
fn nobody_knows(a: &Applicable, rule: &Rule, retrieval: &Retrieval, kept: bool) -> Option<String> {
    if by_users(a, rule) && !retrieval.persons_stated {
        return Some(format!(
            "the number of people is not stated; measured for {}, reckoned from the area",
            retrieval.persons
        ));
    }
    match (&a.unsure, rule.quantity.sure) {
        (Some(reason), _) if !kept => Some(reason.clone()),
        (_, Some(Sure::Kept)) if !kept => Some(rule.quantity.why.clone()),
        (_, Some(Sure::Broken)) if kept => Some(rule.quantity.why.clone()),
        _ => None,
    }
}

/// Returns true when the figure goes by the number of people who use the building.
fn by_users(a: &Applicable, rule: &Rule) -> bool {
    let by_formula =
        matches!(&a.constraint.value, Value::Expression { expr } if expr.split(is_no_letter).any(|w| w == "N"));
    rule.quantity.measure.is_by_users() || by_formula
}

fn is_no_letter(c: char) -> bool {
    !c.is_ascii_alphanumeric() && c != '_'
}

/// Returns what a reader must know to check a verdict.
fn note(a: &Applicable, rule: &Rule, retrieval: &Retrieval, extra: String) -> String {
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
    if by_head_count(a, rule) && !by_users(a, rule) && !retrieval.persons_stated {
        parts.push(format!("for {} people, reckoned from the area", retrieval.persons));
    }
    parts.retain(|p| !p.is_empty());
    parts.join("; ")
}

/// Returns true for ways out that are as wide as the people on them need.
fn by_head_count(a: &Applicable, rule: &Rule) -> bool {
    let of_ways = matches!(rule.quantity.measure, Measure::CirculationWidth | Measure::DoorWidth);
    let of_people = matches!(rule.quantity.measure, Measure::PersonsBySingleExit | Measure::ExitWidthPerPerson);
    of_people || (of_ways && a.constraint.constraint_type == "table")
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
