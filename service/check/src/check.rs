//! The verdict on a world: every hard rule, then every constraint that applies.

use d3dgen_knowledge::{Retrieval, compliance};
use d3dgen_model::domain::Domain;
use d3dgen_model::placements::Placements;
use d3dgen_model::report::{Report, RuleResult};
use d3dgen_model::world::World;

use super::answers::answers;
use super::context::Context;
use super::rules::{About, Findings, RULES, Rule, STOREY_RULES, is_cramped};
use super::{figures, fit};

/// Checks a world against every hard rule and every constraint that applies to it.
///
/// `sound` is true when no hard rule is broken. Constraints are hard where the floorplan had to keep them (the limits of
/// the retrieval, by the rules that name them); the others are reported with their status.
pub fn check(world: &World, domain: &Domain, retrieval: &Retrieval) -> Report {
    let parts = storeys_of(world);
    let whole = Context::new(world, domain, retrieval);
    let storeys: Vec<Context> = parts.iter().map(|(_, storey)| Context::new(storey, domain, retrieval)).collect();
    let mut rules = judge(&whole, &storeys);
    let given_plan = world.floorplan.is_given();
    if given_plan && rules.iter().any(|r| !r.violations.is_empty()) {
        mark_given((&whole, &storeys), &mut rules);
    }
    let finite = rules.iter().all(|r| r.rule != "not_finite" || r.violations.is_empty());
    let (constraints, summary) =
        if finite { compliance::evaluate(world, domain, retrieval) } else { Default::default() };
    Report {
        version: 1,
        world: world.name.clone(),
        sound: rules.iter().all(|r| r.violations.is_empty()),
        given_plan,
        asks: world.brief.as_ref().filter(|_| finite).map(|b| answers(b, world, domain)).unwrap_or_default(),
        figures: if finite { figures::measure(&whole, &storeys) } else { Default::default() },
        robot_fit: if finite { fit::measure(world, &parts, domain) } else { Vec::new() },
        rules,
        jurisdictions: retrieval.jurisdictions.clone(),
        summary,
        constraints,
    }
}

/// Returns the storeys of a world as worlds of their own; none of a world with one.
fn storeys_of(world: &World) -> Vec<(i32, World)> {
    if world.floorplan.has_storeys() { world.storeys() } else { Vec::new() }
}

/// Returns the rules that apply to a building of one storey, or of several.
fn rules_for(several: bool) -> impl Iterator<Item = &'static Rule> {
    RULES.iter().chain(if several { STOREY_RULES } else { &[] })
}

/// Runs every rule; what looks across a floor looks at one storey at a time.
fn judge(whole: &Context, storeys: &[Context]) -> Vec<RuleResult> {
    let several = !storeys.is_empty();
    let mut rules: Vec<RuleResult> = Vec::with_capacity(RULES.len());
    for rule in rules_for(several) {
        // what is broken at the root would only be echoed (or crash geometry) further down
        let hopeless = rules.iter().any(|r| r.rule == "not_finite" && !r.violations.is_empty());
        let mut findings = Findings::new(rule.id);
        if !hopeless && several && !rule.whole {
            storeys.iter().for_each(|storey| (rule.check)(storey, &mut findings));
        } else if !hopeless {
            (rule.check)(whole, &mut findings);
        }
        rules.push(findings.into_result(rule.title));
    }
    rules
}

/// Marks the violations that a brought plan has by itself.
///
/// Those of rules about plans: what they find with nothing in the rooms, too. Those of rules about furniture: what a room
/// lacks (the bed of a bedroom) that is smaller than its type needs, and what the building lacks (a dock) when such rooms
/// are the only ones that lack something. Whatever else is wrong with the furniture is the fault of who placed it.
fn mark_given((whole, furnished): (&Context, &[Context]), rules: &mut [RuleResult]) {
    let (world, domain, retrieval) = (whole.world, whole.domain, whole.retrieval);
    let nothing = Placements { placements: Vec::new(), ..world.placements.clone() };
    let bare = World { placements: nothing, ..world.clone() };
    let parts = storeys_of(&bare);
    let context = Context::new(&bare, domain, retrieval);
    let storeys: Vec<Context> = parts.iter().map(|(_, storey)| Context::new(storey, domain, retrieval)).collect();
    context.judge_from(whole);
    storeys.iter().zip(furnished).for_each(|(bare, furnished)| bare.judge_from(furnished));
    let of_plan = judge(&context, &storeys);
    let mut lacking: Option<bool> = None;
    let mut of_building = Vec::new();
    for ((rule, result), alone) in rules_for(!storeys.is_empty()).zip(rules.iter_mut()).zip(&of_plan) {
        for violation in &mut result.violations {
            if rule.about == About::Plan {
                violation.given = alone.violations.iter().any(|v| v.subject == violation.subject);
            } else if let Some(room) = context.room(&violation.subject) {
                violation.given = is_cramped(&context, room);
                lacking = Some(lacking.unwrap_or(true) && violation.given);
            } else if !world.placements.placements.iter().any(|p| p.placement_id == violation.subject) {
                of_building.push(violation);
            }
        }
    }
    of_building.into_iter().for_each(|v| v.given = lacking == Some(true));
}
