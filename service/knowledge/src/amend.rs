//! From what a person says to reviewed edits: a rule of the building's owner, or another figure of a rule there is.
//!
//! What it is not for: finding the rule in the sentence (`research` does) and storing the edits (`database`).

use d3dgen_model::knowledge::{AMENDMENT, Constraint, KnowledgeBase, LOCAL, Reference, Source, Value};
use d3dgen_model::units;

use crate::database::{Edit, Provenance, difference};
use crate::error::Error;
use crate::phrase;
use crate::tables::TABLES;

/// A rule as somebody states it, in printed units.
#[derive(Debug, Clone, PartialEq)]
pub struct Statement {
    /// What is limited, snake case.
    pub name: String,
    /// `minimum`, `maximum`, ...
    pub constraint_type: String,
    /// The figure, in `unit`.
    pub value: Value,
    /// Unit as printed.
    pub unit: String,
    /// Space it is about, as the knowledge base calls it where it can be known.
    pub space: String,
    /// When it holds, in words.
    pub conditions: Vec<String>,
}

/// Returns the edits that make a statement a rule of the owner, beside the law; the same question asked again replaces
/// the owner's earlier answer.
///
/// Name, space and basis are taken from the rule of the knowledge base that asks the same, so that worlds are planned
/// and checked by it as by that one.
///
/// # Errors
/// `Input` when the statement names no space.
pub fn state(knowledge: &KnowledgeBase, said: &Statement, by: &Provenance) -> Result<Vec<Edit>, Error> {
    if said.space.is_empty() {
        return Err(Error::Input("the sentence does not say which space it is about; name one, as in `corridors are at least 2.6 m wide`".into()));
    }
    let domain = &knowledge.metadata.domain;
    let mut after = knowledge.clone();
    let ref_id = format!("{domain}_local_rules");
    let at = after.references.iter().position(|r| r.ref_id == ref_id).unwrap_or_else(|| {
        after.references.push(Reference {
            ref_id: ref_id.clone(),
            building_type: domain.clone(),
            jurisdiction: LOCAL.into(),
            retrieved_at: day(by),
            sources: Vec::new(),
            constraints: Vec::new(),
        });
        after.references.len() - 1
    });
    let mut rule = drafted(knowledge, said);
    let local = &mut after.references[at];
    rule.source_ids = vec![add_source(local, by)];
    rule.constraint_id = format!("{domain}_local_{}_{}", rule.name, rule.space_type);
    let same = |c: &Constraint| c.constraint_id.starts_with(&rule.constraint_id) && c.conditions == rule.conditions && c.constraint_type == rule.constraint_type;
    match local.constraints.iter().position(same) {
        Some(old) => {
            rule.constraint_id.clone_from(&local.constraints[old].constraint_id);
            local.constraints[old] = rule;
        }
        None => {
            let taken = |id: &str| local.constraints.iter().any(|c| c.constraint_id == id);
            let free = (2..).map(|n| format!("{}_{n}", rule.constraint_id)).find(|id| !taken(id));
            if taken(&rule.constraint_id) {
                rule.constraint_id = free.expect("numbers do not end");
            }
            local.constraints.push(rule);
        }
    }
    Ok(difference(knowledge, &after, true))
}

/// Returns the edits that give a rule another figure, with the amendment as its first source and the old figure in its
/// note.
///
/// # Errors
/// `Input` when there is no such rule, or the figure is the one it has.
pub fn correct(knowledge: &KnowledgeBase, constraint_id: &str, value: Value, by: &Provenance) -> Result<Vec<Edit>, Error> {
    let mut after = knowledge.clone();
    let found = after.references.iter_mut().find_map(|r| {
        let at = r.constraints.iter().position(|c| c.constraint_id == constraint_id)?;
        Some((r, at))
    });
    let Some((reference, at)) = found else {
        let domain = &knowledge.metadata.domain;
        return Err(Error::Input(format!("domain `{domain}` has no rule `{constraint_id}`; `knowledge search` finds ids")));
    };
    if reference.constraints[at].value == value {
        return Err(Error::Input(format!("`{constraint_id}` has this figure already")));
    }
    let source = add_source(reference, by);
    let rule = &mut reference.constraints[at];
    let was = format!("was {} before {}", phrase::requirement(rule), day(by));
    rule.note = if rule.note.is_empty() { was } else { format!("{}; {was}", rule.note) };
    rule.source_ids.insert(0, source);
    rule.value = value;
    Ok(difference(knowledge, &after, true))
}

/// Adds the amendment to the sources of a document and returns its id.
fn add_source(reference: &mut Reference, by: &Provenance) -> String {
    let earlier = reference.sources.iter().filter(|s| s.source_type == AMENDMENT).count();
    let source_id = format!("amendment_{}", earlier + 1);
    reference.sources.push(Source {
        source_id: source_id.clone(),
        title: by.why.clone(),
        publisher: by.who.clone(),
        edition_or_year: day(by),
        url: None,
        source_type: AMENDMENT.into(),
    });
    source_id
}

fn day(by: &Provenance) -> String {
    by.when.chars().take(10).collect()
}

/// Returns the rule in SI, in the words of the one that asks the same where there is one; ids are left to the caller.
fn drafted(knowledge: &KnowledgeBase, said: &Statement) -> Constraint {
    let (value, unit, original_value) = in_si(&said.value, &said.unit);
    let like = alike(knowledge, said, &unit);
    let or_said = |word: fn(&Constraint) -> &String, said: &str| like.map_or_else(|| said.to_owned(), |c| word(c).clone());
    Constraint {
        constraint_id: String::new(),
        name: or_said(|c| &c.name, &said.name),
        topic: or_said(|c| &c.topic, "room_size"),
        constraint_type: said.constraint_type.clone(),
        value,
        unit,
        measurement_basis: or_said(|c| &c.measurement_basis, &said.name),
        space_type: or_said(|c| &c.space_type, &said.space),
        conditions: said.conditions.clone(),
        confidence: "high".into(),
        verified: "known".into(),
        original_value,
        note: String::new(),
        source_ids: Vec::new(),
        seen_at: None,
    }
}

fn in_si(value: &Value, unit: &str) -> (Value, String, Option<String>) {
    let Some(to) = units::conversion(unit) else { return (value.clone(), unit.to_owned(), None) };
    if to.is_identity() {
        return (value.clone(), to.unit, None);
    }
    let converted = match value {
        Value::Number(v) => Value::Number(to.apply(*v)),
        Value::Range { min, max } => Value::Range { min: to.apply(*min), max: to.apply(*max) },
        other => return (other.clone(), unit.to_owned(), None),
    };
    let printed = match value {
        Value::Range { min, max } => format!("{min} to {max} {unit}"),
        Value::Number(v) => format!("{v} {unit}"),
        _ => unit.to_owned(),
    };
    (converted, to.unit, Some(printed))
}

/// Returns the rule that asks the same of the same space: one that is measured goes before one that is not, then the one
/// whose name has most words of the statement's, then one that holds always.
fn alike<'a>(knowledge: &'a KnowledgeBase, said: &Statement, unit: &str) -> Option<&'a Constraint> {
    let words = |text: &str| -> Vec<String> { text.split('_').filter(|w| w.len() > 2).map(str::to_owned).collect() };
    let asked: Vec<String> = words(&said.name);
    let space = words(&said.space);
    let all = knowledge.references.iter().flat_map(|r| &r.constraints);
    let candidates = all.filter(|c| {
        c.unit == unit && (c.space_type == said.space || space.last().is_some_and(|last| *last == c.space_type))
    });
    let rank = |c: &&Constraint| {
        let own = format!("{}_{}", c.name, c.measurement_basis);
        let shared = asked.iter().filter(|w| words(&own).contains(w) && !space.contains(w)).count();
        let measured = TABLES.quantity(c).is_some();
        (shared, measured, c.space_type == said.space, c.conditions.is_empty(), c.constraint_type == said.constraint_type)
    };
    // the first of the best, in the order of the file
    let best = candidates.rev().max_by_key(rank)?;
    (rank(&best).0 > 0 || asked.iter().all(|w| space.contains(w))).then_some(best)
}
