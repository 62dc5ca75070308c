//! Layout distribution distance: how far the layouts of two sets of worlds lie apart.
//!
//! The paper compares layout distributions between its domains (arXiv 2608.11876) without printing a formula. Here it is
//! the Wasserstein-1 (earth mover's) distance between the values of each of four features of rooms, divided by the
//! standard deviation of both sets together, and their mean: 0 for equal distributions, about 1 when they lie a standard
//! deviation apart. Features: net floor area, proportion (longer by shorter side), doors, objects by area.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::round;
use crate::evaluation::WorldMeasures;

/// Distance of two sets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Distance {
    /// One set: a domain.
    pub a: String,
    /// The other: a domain, or the same domain of the reference set.
    pub b: String,
    /// Mean over the features.
    pub mean: f64,
    /// By feature.
    pub features: BTreeMap<String, f64>,
}

type Feature = fn(&WorldMeasures) -> Vec<f64>;

/// Name of a feature, and its values for the rooms of a world.
const FEATURES: [(&str, Feature); 4] = [
    ("room_area", |w| w.layout.room_areas_m2.clone()),
    ("room_proportion", |w| w.layout.room_proportions.clone()),
    ("room_doors", |w| w.layout.room_doors.iter().map(|n| f64::from(*n)).collect()),
    ("room_density", |w| {
        let rooms = w.layout.room_objects.iter().zip(&w.layout.room_areas_m2);
        rooms.map(|(n, area)| f64::from(*n) / area.max(1e-9)).collect()
    }),
];

/// Returns the distances between domains, and of each domain from the same one in the reference set.
pub(crate) fn together(worlds: &[WorldMeasures], reference: &[WorldMeasures]) -> Vec<Distance> {
    let (ours, theirs) = (by_domain(worlds), by_domain(reference));
    let mut out = Vec::new();
    for (i, (a, first)) in ours.iter().enumerate() {
        for (b, second) in ours.iter().skip(i + 1) {
            out.push(between(a, (*b).to_owned(), first, second));
        }
        if let Some(second) = theirs.get(a) {
            out.push(between(a, format!("{a} (reference)"), first, second));
        }
    }
    out
}

fn by_domain(worlds: &[WorldMeasures]) -> BTreeMap<&str, Vec<&WorldMeasures>> {
    let mut out: BTreeMap<&str, Vec<&WorldMeasures>> = BTreeMap::new();
    worlds.iter().for_each(|w| out.entry(&w.domain).or_default().push(w));
    out
}

fn between(a: &str, b: String, first: &[&WorldMeasures], second: &[&WorldMeasures]) -> Distance {
    let values = |set: &[&WorldMeasures], of: Feature| set.iter().flat_map(|w| of(w)).collect::<Vec<f64>>();
    let features: BTreeMap<String, f64> = FEATURES
        .iter()
        .map(|(name, of)| ((*name).to_owned(), round(distance(values(first, *of), values(second, *of)))))
        .collect();
    let mean = round(features.values().sum::<f64>() / features.len() as f64);
    Distance { a: a.to_owned(), b, mean, features }
}

/// Returns the Wasserstein-1 distance of two samples in standard deviations of both together; 0 for an empty one.
fn distance(mut a: Vec<f64>, mut b: Vec<f64>) -> f64 {
    if a.is_empty() || b.is_empty() {
        return 0.0;
    }
    a.sort_by(f64::total_cmp);
    b.sort_by(f64::total_cmp);
    let mut all: Vec<f64> = a.iter().chain(&b).copied().collect();
    all.sort_by(f64::total_cmp);
    let below = |sorted: &[f64], v: f64| sorted.partition_point(|x| *x <= v) as f64 / sorted.len() as f64;
    let area: f64 = all.windows(2).map(|w| (below(&a, w[0]) - below(&b, w[0])).abs() * (w[1] - w[0])).sum();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    let deviation = (all.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / all.len() as f64).sqrt();
    if deviation < 1e-12 { 0.0 } else { area / deviation }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::measure;
    use crate::sample;

    #[test]
    fn shifted_samples_are_apart_by_the_shift() {
        assert_eq!(distance(vec![1.0, 2.0, 3.0], vec![3.0, 1.0, 2.0]), 0.0);
        // all mass moves by 2; deviation of 0, 0, 2, 2 is 1
        assert!((distance(vec![0.0, 0.0], vec![2.0, 2.0]) - 2.0).abs() < 1e-12);
        assert_eq!(distance(vec![1.0], vec![1.0]), 0.0);
        assert_eq!(distance(Vec::new(), vec![1.0]), 0.0);
    }

    #[test]
    fn domains_are_compared_with_each_other_and_with_the_reference() {
        let of = |domain: &str| {
            let mut world = sample::world();
            world.scene_graph.domain = domain.into();
            measure(&world, None, domain, &Default::default())
        };
        let mut large = of("office");
        large.layout.room_areas_m2.iter_mut().for_each(|a| *a *= 2.0);
        let found = together(&[of("hospital"), large], &[of("office")]);
        let named: Vec<_> = found.iter().map(|d| (d.a.as_str(), d.b.as_str())).collect();
        assert_eq!(named, [("hospital", "office"), ("office", "office (reference)")]);
        assert_eq!((found[0].features["room_doors"], found[0].features["room_area"]), (0.0, 2.0));
        assert!(found[1].mean > 0.0);
    }
}
