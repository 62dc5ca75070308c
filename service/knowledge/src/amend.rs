//! From what a person says to reviewed edits: a rule of the building's owner, or another figure of a rule there is.
//!
//! What it is not for: finding the rule in the sentence (`research` does) and storing the edits (`database`).

use d3dgen_model::knowledge::{AMENDMENT, Constraint, KnowledgeBase, LOCAL, Reference, Source, Statement, Value};
use d3dgen_model::{plausible, units};

use crate::database::{Edit, Provenance, difference};
use crate::draw_limits::ROBOT_TOPIC;
use crate::error::Error;
use crate::import::scale;
use crate::phrase;
use crate::tables::TABLES;

/// Returns the edits that make a statement a rule of the owner, beside the law; the same question asked again replaces
/// the owner's earlier answer.
///
/// Name, space and basis are taken from the rule of the knowledge base that asks the same, so that worlds are planned
/// and checked by it as by that one.
///
/// # Errors
/// `Input` when the statement names no space, or a figure that no building has.
pub fn state(knowledge: &KnowledgeBase, said: &Statement, by: &Provenance) -> Result<Vec<Edit>, Error> {
    states(knowledge, std::slice::from_ref(said), by)
}

/// Returns the edits that make each of some statements a rule of the owner, in their order, as [`state`] does for one.
///
/// # Errors
/// As [`state`].
pub fn states(knowledge: &KnowledgeBase, all: &[Statement], by: &Provenance) -> Result<Vec<Edit>, Error> {
    let mut after = knowledge.clone();
    for said in all {
        add(&mut after, said, by)?;
    }
    Ok(difference(knowledge, &after, true))
}

/// Makes a statement a rule of the owner.
fn add(after: &mut KnowledgeBase, said: &Statement, by: &Provenance) -> Result<(), Error> {
    if said.space.is_empty() {
        return Err(Error::Input(
            "the sentence does not say which space it is about; name one, as in `corridors are at least 2.6 m wide`"
                .into(),
        ));
    }
    let mut rule = drafted(after, said);
    let domain = &after.metadata.domain;
    let ref_id = format!("{domain}_local_rules");
    rule.constraint_id = format!("{domain}_local_{}_{}", rule.name, rule.space_type);
    let at = after.references.iter().position(|r| r.ref_id == ref_id).unwrap_or_else(|| {
        after.references.push(Reference {
            ref_id,
            building_type: after.metadata.domain.clone(),
            jurisdiction: LOCAL.into(),
            retrieved_at: day(by),
            sources: Vec::new(),
            constraints: Vec::new(),
        });
        after.references.len() - 1
    });
    plausible(&rule)?;
    let local = &mut after.references[at];
    rule.source_ids = vec![add_source(local, by)];
    let same = |c: &Constraint| {
        c.constraint_id.starts_with(&rule.constraint_id)
            && c.conditions == rule.conditions
            && c.constraint_type == rule.constraint_type
    };
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
    Ok(())
}

/// Returns the edits that give a rule another figure, with the amendment as its first source and the old figure in its
/// note.
///
/// # Errors
/// `Input` when there is no such rule, when the figure is the one it has, or one that no building has.
pub fn correct(
    knowledge: &KnowledgeBase,
    constraint_id: &str,
    value: Value,
    by: &Provenance,
) -> Result<Vec<Edit>, Error> {
    let mut after = knowledge.clone();
    let found = after.references.iter_mut().find_map(|r| {
        let at = r.constraints.iter().position(|c| c.constraint_id == constraint_id)?;
        Some((r, at))
    });
    let Some((reference, at)) = found else {
        let domain = &knowledge.metadata.domain;
        return Err(Error::Input(format!(
            "domain `{domain}` has no rule `{constraint_id}`; `knowledge search` finds ids"
        )));
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
    plausible(rule)?;
    Ok(difference(knowledge, &after, true))
}

/// Refuses a rule that cannot mean what it says.
fn plausible(rule: &Constraint) -> Result<(), Error> {
    match plausible::doubt_of(rule) {
        None => Ok(()),
        Some(reason) => Err(Error::Input(format!("{} of {}: {reason}", rule.name, rule.space_type))),
    }
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
    let or_said =
        |word: fn(&Constraint) -> &String, said: &str| like.map_or_else(|| said.to_owned(), |c| word(c).clone());
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
        clause: None,
        quotation: None,
        in_force_from: None,
        in_force_until: None,
        superseded_by: None,
    }
}

fn in_si(value: &Value, unit: &str) -> (Value, String, Option<String>) {
    let Some(to) = units::conversion(unit) else { return (value.clone(), unit.to_owned(), None) };
    if to.is_identity() {
        return (value.clone(), to.unit, None);
    }
    let mut converted = value.clone();
    if !scale(&mut converted, &to) {
        return (converted, unit.to_owned(), None);
    }
    (converted, to.unit, Some(format!("{value} {unit}")))
}

/// Names that say no more than the unit does: which extent of a space they mean is told by what its rules ask of it.
const GENERIC: [&str; 5] = ["dimension", "length", "distance", "size", "value"];

/// Returns the rule that asks the same of the same space: of those that share most words with the statement, the one
/// whose quantity most rules of the space are about.
fn alike<'a>(knowledge: &'a KnowledgeBase, said: &Statement, unit: &str) -> Option<&'a Constraint> {
    let words = |text: &str| -> Vec<String> { text.split('_').filter(|w| w.len() > 2).map(str::to_owned).collect() };
    let space = words(&said.space);
    let mut asked = words(&said.name);
    asked.retain(|w| !space.contains(w) && !GENERIC.contains(&w.as_str()));
    let all = knowledge.references.iter().flat_map(|r| &r.constraints);
    let candidates: Vec<&Constraint> = all
        .filter(|c| {
            let named = c.space_type == said.space || space.last().is_some_and(|last| *last == c.space_type);
            c.unit == unit && named && c.topic != ROBOT_TOPIC
        })
        .collect();
    let measure = |c: &Constraint| TABLES.quantity(c).map(|q| q.measure);
    let measures: Vec<_> = candidates.iter().map(|c| measure(c)).collect();
    let rank = |c: &&Constraint| {
        let own = words(&format!("{}_{}", c.name, c.measurement_basis));
        let shared = asked.iter().filter(|w| own.contains(w)).count();
        let usual = measure(c).map_or(0, |m| measures.iter().filter(|other| **other == Some(m)).count());
        (shared, usual, c.space_type == said.space, c.constraint_type == said.constraint_type, c.conditions.is_empty())
    };
    // the first of the best, in the order of the file
    let best = candidates.iter().copied().rev().max_by_key(rank)?;
    (asked.is_empty() || rank(&best).0 > 0).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::knowledge;

    fn by() -> Provenance {
        Provenance { who: "head nurse".into(), when: "2026-11-21T12:00:00Z".into(), why: "our beds are wide".into() }
    }

    fn said(name: &str, space: &str, value: f64, unit: &str) -> Statement {
        Statement {
            name: name.into(),
            constraint_type: "minimum".into(),
            value: Value::Number(value),
            unit: unit.into(),
            space: space.into(),
            conditions: Vec::new(),
        }
    }

    fn rule(edits: &[Edit]) -> &Constraint {
        let mut rules = edits.iter().filter_map(|e| match &e.after {
            Some(crate::database::Entry::Constraint(_, c)) => Some(&**c),
            _ => None,
        });
        rules.next_back().expect("a rule")
    }

    #[test]
    fn what_is_said_of_a_space_is_measured_as_its_rules_are() {
        let hospital = knowledge("hospital");
        for (name, space, unit, measure) in [
            ("dimension", "corridor", "m", Some(crate::Measure::CirculationWidth)),
            ("corridor_width", "corridor", "cm", Some(crate::Measure::CirculationWidth)),
            ("width", "ward_corridor", "m", Some(crate::Measure::CirculationWidth)),
            ("area", "patient_room_single", "m^2", Some(crate::Measure::RoomArea)),
            ("smell", "corridor", "lx", None),
        ] {
            let edits = state(&hospital, &said(name, space, 2.5, unit), &by()).expect("edits");
            let found = rule(&edits);
            assert_eq!(TABLES.quantity(found).map(|q| q.measure), measure, "{name} of {space}: {found:?}");
        }
    }

    #[test]
    fn the_owner_changes_his_mind_in_place() {
        let mut office = knowledge("office");
        let first = state(&office, &said("width", "corridor", 180.0, "cm"), &by()).expect("edits");
        assert_eq!(rule(&first).value, Value::Number(1.8));
        assert_eq!(rule(&first).original_value.as_deref(), Some("180 cm"));
        crate::database::apply(&mut office, &first);
        let second = state(&office, &said("width", "corridor", 2.0, "m"), &by()).expect("edits");
        assert_eq!(rule(&second).constraint_id, rule(&first).constraint_id);
        crate::database::apply(&mut office, &second);
        let local = office.references.iter().find(|r| r.jurisdiction == LOCAL).expect("the owner's rules");
        assert_eq!((local.constraints.len(), local.sources.len()), (1, 2));
        assert!(state(&office, &said("width", "", 2.0, "m"), &by()).is_err());
    }

    #[test]
    fn a_corrected_rule_says_who_and_what_it_was() {
        let hospital = knowledge("hospital");
        let id = "hospital_de_bed_corridor_width_corridor";
        let edits = correct(&hospital, id, Value::Number(2.3), &by()).expect("edits");
        let rule = rule(&edits);
        assert_eq!((rule.source_ids[0].as_str(), &rule.value), ("amendment_1", &Value::Number(2.3)));
        assert!(rule.note.ends_with("was at least 2.25 m before 2026-11-21"), "{}", rule.note);
        assert!(correct(&hospital, "nothing", Value::Number(1.0), &by()).is_err());
        assert!(correct(&hospital, id, Value::Number(2.25), &by()).is_err(), "nothing changes");
        for (wrong, why) in
            [(Value::Number(500.0), "500"), (Value::Number(-5.0), "-5"), (Value::Range { min: 3.0, max: 2.0 }, "above")]
        {
            let refused = correct(&hospital, id, wrong, &by()).expect_err("no corridor is so").to_string();
            assert!(refused.contains(why), "{refused}");
        }
        assert!(state(&hospital, &said("width", "corridor", 500.0, "m"), &by()).is_err(), "no corridor is so wide");
    }
}
