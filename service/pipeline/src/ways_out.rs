//! How far it is to a way out, said where that is farther than a law allows. Plans have stairs and doors at the ends of their
//! corridors; a large storey may need more of either than they give it, or sprinklers, which no plan shows.

use std::collections::BTreeMap;

use d3dgen_knowledge::compliance::longest_way_out;
use d3dgen_knowledge::{Measure, Retrieval};
use d3dgen_model::domain::Domain;
use d3dgen_model::report::{ConstraintResult, Report, Status};
use d3dgen_model::scene_graph::Note;
use d3dgen_model::world::World;

/// Code of the conflict that a way out is longer than allowed.
const TOO_FAR: &str = "way_out_too_long";

/// Returns what to say of the longest way out: that it is longer than a law of the country allows, or where none is known than
/// is usual, and what would mend it.
pub(crate) fn told(world: &World, report: &Report, domain: &Domain, retrieved: &Retrieval) -> Option<Note> {
    let laws = laws(report, retrieved);
    let said = if laws.is_empty() { beyond_usual(world, domain, retrieved) } else { beyond_law(world, &laws) };
    said.map(|message| Note { code: TOO_FAR.into(), message })
}

/// Returns the verdicts on the length of ways out that regulations have.
fn laws<'r>(report: &'r Report, retrieved: &Retrieval) -> Vec<&'r ConstraintResult> {
    let by_id: BTreeMap<&str, Measure> = retrieved
        .constraints
        .iter()
        .filter(|a| a.mandatory && a.superseded_by.is_none())
        .filter_map(|a| Some((a.constraint.constraint_id.as_str(), a.decision.as_ref().ok()?.quantity.measure)))
        .collect();
    let about_ways = |r: &&ConstraintResult| by_id.get(r.constraint_id.as_str()) == Some(&Measure::TravelDistance);
    report.constraints.iter().filter(about_ways).collect()
}

fn beyond_law(world: &World, laws: &[&ConstraintResult]) -> Option<String> {
    let missed = laws.iter().filter(|r| r.status == Status::Violated);
    let worst = missed.max_by(|a, b| a.measured.unwrap_or(0.0).total_cmp(&b.measured.unwrap_or(0.0)))?;
    let (way, most) = (worst.measured?, worst.required_max?);
    // a law for other circumstances, which no plan shows, may allow it
    let allowed = laws.iter().find(|r| r.status == Status::Satisfied && r.required_max.is_some_and(|m| m >= way));
    let mend = match allowed {
        Some(law) => format!(
            "the building was taken to be as {} asks, which allows {:.1} m",
            law.constraint_id,
            law.required_max.unwrap_or(way)
        ),
        None => more_ways(world).into(),
    };
    Some(format!(
        "the longest way out, from {}, is {way:.1} m, more than the {most:.1} m of {}; {mend}",
        worst.subject, worst.constraint_id
    ))
}

fn beyond_usual(world: &World, domain: &Domain, retrieved: &Retrieval) -> Option<String> {
    let most = domain.circulation.way_out_m?;
    let (room, way) = longest_way_out(world, domain, retrieved, most)?;
    let source = &domain.circulation.way_out_source;
    let mend = more_ways(world);
    (way > most).then(|| {
        format!("the longest way out, from {room}, is {way:.1} m, more than the {most:.1} m that were taken as allowed ({source}); {mend}")
    })
}

/// Returns what would make the ways of a building shorter.
fn more_ways(world: &World) -> &'static str {
    if world.floorplan.levels.len() > 1 {
        "one more staircase, or fewer rooms on a storey, would mend it"
    } else {
        "one more door to outdoors there, or a second storey, would mend it"
    }
}
