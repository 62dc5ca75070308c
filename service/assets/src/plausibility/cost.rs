//! What contradicting a file costs, and what being implausible does. One is about what a slip of a factor of 1.6 in
//! every extent costs beyond the tolerance.

use super::Declared;
use crate::catalog::{CatalogObject, NameMatch, kind_fits_people};

/// Unit factors that files lie by, and how rare each is: cost beside the one of contradicting the unit.
pub const UNITS: &[(f64, f64)] = &[
    (1.0, 0.0),
    (0.01, 0.0),
    (100.0, 0.0),
    (0.001, 0.1),
    (1000.0, 0.1),
    (0.0254, 0.2),
    (1.0 / 0.0254, 0.2),
    (0.1, 1.3),
    (10.0, 1.3),
    (0.3048, 1.2),
    (1.0 / 0.3048, 1.2),
    (2.54, 0.5),
    (1.0 / 2.54, 0.5),
];

/// Cost of another unit than that of the files beside it.
pub const UNLIKE_NEIGHBORS: f64 = 1.0;
/// Extents of one kind of thing differ by this factor (as logarithm) without any doubt.
const TOLERANCE: f64 = 0.38;
/// How far the logarithms of the ratios of the extents scatter where the proportions are those of an object.
const PROPORTIONED: f64 = 0.33;
/// Mean logarithm of the ratios of the extents from which nothing of the kind is as large, or as small.
const FAR: f64 = 0.9;
/// Cost of each further factor of e.
const STEEPNESS: f64 = 2.0;
/// Least extent counted: sheets and mats have any thickness, m.
const THIN: f64 = 0.02;

/// How far each statement of a file is trusted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trust {
    /// Cost of keeping the declared axis.
    pub declared_axis: f64,
    /// Cost of another axis.
    pub other_axis: f64,
    /// Cost of another unit.
    pub other_unit: f64,
    /// Cost of saying that it is no unit, the model is simply not to scale; infinite where that cannot be.
    pub not_to_scale: f64,
}

impl Trust {
    /// Returns how far the statements of a file are trusted.
    pub fn of(declared: &Declared) -> Self {
        if declared.simulator.is_some() {
            // What a simulator loads was looked at by people; it ignores declared axes.
            let y = declared.up_axis == Some('Y');
            let (declared_axis, other_axis) = if y { (3.0, 0.0) } else { (0.0, 3.0) };
            return Self { declared_axis, other_axis, other_unit: 3.0, not_to_scale: f64::INFINITY };
        }
        let (other_axis, other_unit) = match declared.format.as_str() {
            // The format leaves no choice, yet exporters forget to convert.
            "glb" | "gltf" => (2.6, 1.9),
            "obj" | "stl" => (0.12, 0.6),
            _ => {
                let axis = if declared.up_axis_authored { 1.9 } else { 0.9 };
                (axis, if declared.unit_authored { 1.9 } else { 0.8 })
            }
        };
        Self { declared_axis: 0.0, other_axis, other_unit, not_to_scale: 0.25 }
    }
}

/// Returns how far a size is from one of a catalog: the root mean square of the logarithms of the ratios of the extents,
/// whichever horizontal one is the width.
pub fn misfit(size: [f64; 3], wanted: [f64; 3]) -> f64 {
    let logs = ratios(size, wanted);
    (logs.iter().map(|l| l * l).sum::<f64>() / 3.0).sqrt()
}

/// Returns the logarithms of wanted over found, the longer horizontal extents together.
fn ratios(size: [f64; 3], wanted: [f64; 3]) -> [f64; 3] {
    let sorted = |s: [f64; 3]| [s[0].max(s[1]), s[0].min(s[1]), s[2]].map(|v| v.max(1e-9));
    let (found, wanted) = (sorted(size), sorted(wanted));
    let scale = found.iter().copied().fold(0.0, f64::max) / wanted.iter().copied().fold(0.0, f64::max);
    // Thin things compare by thickness only down to the thickness of a mat of their size.
    let floor = THIN * scale.clamp(1e-6, 1e6);
    std::array::from_fn(|i| (wanted[i].max(THIN) / found[i].max(floor)).ln())
}

/// Tells whether a size has the proportions of one of a catalog, whatever the unit it is told in.
pub fn is_proportioned(size: [f64; 3], wanted: [f64; 3]) -> bool {
    let logs = ratios(size, wanted);
    let mean = logs.iter().sum::<f64>() / 3.0;
    (logs.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / 3.0).sqrt() <= PROPORTIONED
}

/// Returns the cost of a misfit.
pub fn of_misfit(misfit: f64) -> f64 {
    STEEPNESS * (misfit - TOLERANCE).max(0.0)
}

/// Returns the cost of a name that explains a share of the words.
pub fn of_name(coverage: f64) -> f64 {
    0.6 * (1.0 - coverage).max(0.0)
}

/// Returns the cost of where the origin is: most models stand on it or have it in their middle.
pub fn origin(low: f64, height: f64) -> f64 {
    if height <= 0.0 {
        return 0.0;
    }
    let at = low / height;
    let centered = (at + 0.5).abs();
    let off = if at < 0.0 { -at * 3.0 } else { at * 1.5 };
    if centered < 0.03 { 0.45 } else { ((off - 0.05) * 1.2).clamp(0.0, 0.75) }
}

/// Returns the cost of lying: what stands on floors would have its floor upright, at the origin, and its middle at the
/// height of the origin.
pub fn lying(low: [f64; 3], size: [f64; 3]) -> f64 {
    let centered = |i: usize| (low[i] / size[i] + 0.5).abs() < 0.12;
    let edge = |i: usize| low[i].abs().min((low[i] + size[i]).abs()) < 0.03 * size[i];
    let lies = centered(2) && (edge(0) && centered(1) || edge(1) && centered(0));
    if lies { 1.6 } else { 0.0 }
}

/// Returns the cost of a size that nothing indoors has, whatever it is.
pub fn bounds(size: [f64; 3]) -> f64 {
    let largest = size.iter().copied().fold(0.0, f64::max);
    let over = |limit: f64, value: f64| (value / limit).ln().max(0.0);
    // Height alone tells which axis is up, never the unit: halls have tall things.
    let tall = (over(3.2, size[2]) * 1.2).min(1.2);
    let long = over(12.0, largest) * 1.2;
    let tiny = if largest > 0.0 { over(largest, 0.004) * 1.2 } else { 0.0 };
    tall.max(long) + tiny
}

/// Returns the cost of a size that none of the things has which the name surely means: in the proportions of one of them,
/// and far larger or smaller than all.
pub fn unlike_all(size: [f64; 3], matches: &[NameMatch<'_>]) -> f64 {
    let surely = || matches.iter().filter(|m| m.coverage > 0.99 && kind_fits_people(&m.object.kind));
    let sizes = || surely().flat_map(|m| &m.object.sizes_m);
    let far = |s: &[f64; 3]| (ratios(size, *s).iter().sum::<f64>() / 3.0).abs() >= FAR;
    let is = sizes().all(far) && sizes().any(|s| is_proportioned(size, *s));
    if is { 2.5 } else { 0.0 }
}

/// Returns the factor that makes a model as large as the object its name surely means, when it is off in all extents
/// alike and by more than things of a kind differ.
pub fn to_catalog<'c>(size: [f64; 3], matches: &[NameMatch<'c>], trust: &Trust) -> Option<(f64, &'c CatalogObject)> {
    if !trust.not_to_scale.is_finite() {
        return None;
    }
    let mut best: Option<(f64, f64, &'c CatalogObject)> = None;
    let surely = matches.iter().filter(|m| m.coverage > 0.99 && kind_fits_people(&m.object.kind));
    for (m, wanted) in surely.flat_map(|m| m.object.sizes_m.iter().map(move |s| (m, *s))) {
        let logs = ratios(size, wanted);
        let mean = logs.iter().sum::<f64>() / 3.0;
        let spread = (logs.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / 3.0).sqrt();
        if best.is_none_or(|(_, b, _)| spread < b) {
            best = Some((mean, spread, m.object));
        }
        if mean.abs() < 0.4 && spread < 0.3 {
            return None; // it is about as large as one of them
        }
    }
    best.filter(|(mean, spread, _)| mean.abs() >= 0.4 && mean.abs() < 1.6 && *spread <= 0.18)
        .map(|(mean, _, object)| (mean.exp(), object))
}
