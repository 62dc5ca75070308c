//! The verdict on a world: every hard rule, then every constraint that applies.

use d3dgen_knowledge::{Retrieval, compliance};
use d3dgen_model::domain::Domain;
use d3dgen_model::report::{Report, RuleResult};
use d3dgen_model::world::World;

use super::context::Context;
use super::figures;
use super::rules::{Findings, RULES, Rule, STOREY_RULES};

/// Checks a world against every hard rule and every constraint that applies to it.
///
/// `sound` is true when no hard rule is broken. Constraints are hard where the floorplan had to keep them (the limits of
/// the retrieval, by the rules that name them); the others are reported with their status.
pub fn check(world: &World, domain: &Domain, retrieval: &Retrieval) -> Report {
    let several = world.floorplan.level_numbers().len() > 1;
    let storeys = if several { world.storeys() } else { Vec::new() };
    let whole = Context::new(world, domain, retrieval);
    let storeys: Vec<Context> = storeys.iter().map(|(_, storey)| Context::new(storey, domain, retrieval)).collect();
    // what looks across a floor looks at one storey at a time
    let seen = |rule: &Rule| if several && !rule.whole { storeys.iter().collect() } else { vec![&whole] };
    let mut rules: Vec<RuleResult> = Vec::with_capacity(RULES.len());
    for rule in RULES.iter().chain(if several { STOREY_RULES } else { &[] }) {
        // what is broken at the root would only be echoed (or crash geometry) further down
        let hopeless = rules.iter().any(|r| r.rule == "not_finite" && !r.violations.is_empty());
        let mut findings = Findings::new(rule.id);
        if !hopeless {
            seen(rule).into_iter().for_each(|context| (rule.check)(context, &mut findings));
        }
        rules.push(findings.into_result(rule.title));
    }
    let finite = rules.iter().all(|r| r.rule != "not_finite" || r.violations.is_empty());
    let (constraints, summary) =
        if finite { compliance::evaluate(world, domain, retrieval) } else { Default::default() };
    Report {
        version: 1,
        world: world.name.clone(),
        sound: rules.iter().all(|r| r.violations.is_empty()),
        figures: if finite { figures::measure(&whole, &storeys) } else { Default::default() },
        rules,
        jurisdictions: retrieval.jurisdictions.clone(),
        summary,
        constraints,
    }
}
