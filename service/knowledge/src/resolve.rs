//! Which of several mandatory constraints is kept when they ask different figures of the same quantity of the same space.
//!
//! First the nearest jurisdiction, then the policy asked for. Rules of the building's owner stand beside the law: they
//! neither give way to it nor set it aside, so that of the two the stricter is planned for.

use d3dgen_model::knowledge::LOCAL;

use crate::figure::Bounds;
use crate::retrieve::Applicable;

/// How sources of one jurisdiction that contradict each other are weighed.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Policy {
    /// All of them hold: the strictest figure is planned for.
    #[default]
    Strictest,
    /// The one with the latest year of edition.
    Newest,
    /// The first whose title, publisher or reference has one of these words, in their order; else the strictest.
    Preferred(Vec<String>),
}

impl Policy {
    /// Returns the name that reports and flags use.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Strictest => "strictest",
            Self::Newest => "newest",
            Self::Preferred(_) => "preferred",
        }
    }
}

/// Mandatory constraints on one quantity that ask different figures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Conflict {
    /// Space they are about.
    pub space_type: String,
    /// Constraint that is kept.
    pub kept: String,
    /// Constraint that is not, or that is looser.
    pub against: String,
    /// Why: `nearest jurisdiction`, or the policy's name.
    pub by: &'static str,
}

/// Marks what goes before what, takes the force of a law from those that give way, and returns the contradictions.
pub(crate) fn settle(constraints: &mut [Applicable], chain: &[String], policy: &Policy) -> Vec<Conflict> {
    let mut conflicts = nearest_first(constraints, chain);
    let mut done: Vec<usize> = Vec::new();
    for i in 0..constraints.len() {
        if done.contains(&i) || !contends(&constraints[i]) {
            continue;
        }
        let rivals: Vec<usize> =
            (i..constraints.len()).filter(|&j| same_question(&constraints[i], &constraints[j])).collect();
        done.extend(&rivals);
        let Some(&kept) = rivals.iter().max_by(|&&a, &&b| {
            let order = weight(&constraints[a], policy).cmp(&weight(&constraints[b], policy));
            // the earlier one of equals
            order.then(strictness(&constraints[a]).total_cmp(&strictness(&constraints[b]))).then(b.cmp(&a))
        }) else {
            continue;
        };
        let kept_id = constraints[kept].constraint.constraint_id.clone();
        let wanted = required(&constraints[kept]);
        for &other in rivals.iter().filter(|&&j| j != kept) {
            let looser = &mut constraints[other];
            if required(looser) == wanted {
                continue;
            }
            conflicts.push(Conflict {
                space_type: looser.constraint.space_type.clone(),
                kept: kept_id.clone(),
                against: looser.constraint.constraint_id.clone(),
                by: policy.name(),
            });
            if *policy != Policy::Strictest {
                looser.superseded_by = Some(kept_id.clone());
                looser.mandatory = false;
            }
        }
    }
    conflicts
}

/// Marks what a mandatory constraint of a nearer jurisdiction on the same quantity of the same space goes before.
fn nearest_first(constraints: &mut [Applicable], chain: &[String]) -> Vec<Conflict> {
    let rank = |a: &Applicable| chain.iter().position(|c| *c == a.citation.jurisdiction).unwrap_or(chain.len());
    let key = |a: &Applicable| {
        a.decision.as_ref().ok().map(|r| (r.quantity.measure, a.constraint.space_type.clone(), r.bounds.min.is_some()))
    };
    let nearer: Vec<_> = constraints
        .iter()
        .filter(|a| a.mandatory && a.guards.is_empty() && a.citation.jurisdiction != LOCAL)
        .filter_map(|a| Some((key(a)?, rank(a), a.constraint.constraint_id.clone())))
        .collect();
    let mut conflicts = Vec::new();
    for a in constraints.iter_mut().filter(|a| a.mandatory && a.citation.jurisdiction != LOCAL) {
        let Some(own) = key(a) else { continue };
        let here = rank(a);
        let Some((.., id)) = nearer.iter().find(|(k, r, _)| *k == own && *r < here) else { continue };
        conflicts.push(Conflict {
            space_type: a.constraint.space_type.clone(),
            kept: id.clone(),
            against: a.constraint.constraint_id.clone(),
            by: "nearest jurisdiction",
        });
        a.superseded_by = Some(id.clone());
        a.mandatory = false;
    }
    conflicts
}

/// Returns true for constraints that bind and have a figure to compare.
fn contends(a: &Applicable) -> bool {
    a.mandatory && a.decision.is_ok()
}

/// Returns true when two constraints of one jurisdiction ask a figure of the same quantity under the same conditions.
fn same_question(a: &Applicable, b: &Applicable) -> bool {
    let (Ok(x), Ok(y)) = (&a.decision, &b.decision) else { return false };
    let (here, there) = (&a.citation.jurisdiction, &b.citation.jurisdiction);
    contends(b)
        && x.quantity.measure == y.quantity.measure
        && x.to == y.to
        && x.bounds.min.is_some() == y.bounds.min.is_some()
        && a.constraint.space_type == b.constraint.space_type
        && a.constraint.conditions == b.constraint.conditions
        && (here == there || here == LOCAL || there == LOCAL)
}

fn required(a: &Applicable) -> Option<Bounds> {
    a.decision.as_ref().ok().map(|r| r.bounds)
}

/// Returns how much a constraint asks, comparable among those of one question.
fn strictness(a: &Applicable) -> f64 {
    match required(a) {
        Some(Bounds { min: Some(min), .. }) => min,
        Some(Bounds { max: Some(max), .. }) => -max,
        _ => f64::NEG_INFINITY,
    }
}

/// Returns the rank that a policy gives a constraint; the owner's rules are never outranked.
fn weight(a: &Applicable, policy: &Policy) -> u32 {
    match policy {
        Policy::Strictest => 0,
        _ if a.citation.jurisdiction == LOCAL => u32::MAX,
        Policy::Newest => year(&a.citation.source.edition_or_year).unwrap_or(0),
        Policy::Preferred(words) => {
            let text =
                format!("{} {} {}", a.citation.source.title, a.citation.source.publisher, a.ref_id).to_lowercase();
            let place = words.iter().position(|w| text.contains(&w.to_lowercase()));
            place.map_or(0, |p| u32::MAX - 1 - p as u32)
        }
    }
}

/// Returns the latest year named in an edition: `2015 (2020 am.)` is of 2020.
fn year(edition: &str) -> Option<u32> {
    let numbers = edition.split(|c: char| !c.is_ascii_digit()).filter(|n| n.len() == 4);
    numbers.filter_map(|n| n.parse().ok()).filter(|y| (1800..2200).contains(y)).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_year_of_an_edition() {
        let cases =
            [("2015 (2020 am.)", Some(2020)), ("27 June 1996", Some(1996)), ("n.d.", None), ("DIN 18040", None)];
        for (edition, expected) in cases {
            assert_eq!(year(edition), expected, "{edition}");
        }
    }
}
