//! Extents of objects.

use super::site::Object;
use crate::figure;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule};

/// Returns an extent of an object, m; `None` when the quantity is no extent.
pub(super) fn figure(object: &Object, a: &Applicable, rule: &Rule) -> Option<f64> {
    let [width, depth, _] = object.placement.size_m;
    of_extents([width, depth, object.placement.top_m()], a, rule)
}

/// Returns what a quantity of extents is for a width, a depth and a top, m; `None` when the quantity is no extent.
pub(crate) fn of_extents([width, depth, top]: [f64; 3], a: &Applicable, rule: &Rule) -> Option<f64> {
    match rule.quantity.measure {
        Measure::ObjectWidth => Some(width),
        Measure::ObjectDepth => Some(depth),
        Measure::ObjectHeight => Some(top),
        Measure::ObjectSize => {
            let [_, long] = rule.bounds.sides?;
            let (short, own) = (width.min(depth), width.max(depth));
            Some(if own >= long - crate::compliance::SLACK { short } else { 0.0 })
        }
        Measure::ObjectExtents => outside([width, depth, top], a),
        _ => None,
    }
}

/// Returns how far the extents lie outside those of the constraint at most, m.
///
/// Which plan side a rule calls width is not the same everywhere: the way that fits better counts.
fn outside([width, depth, top]: [f64; 3], a: &Applicable) -> Option<f64> {
    let extents = figure::extents(&a.constraint).ok()?;
    let worst = |width: f64, depth: f64| {
        let off = extents.iter().map(|(name, low, high)| {
            let own = match *name {
                "width" => width,
                "height" => top,
                _ => depth,
            };
            (low - own).max(own - high).max(0.0)
        });
        off.fold(0.0, f64::max)
    };
    let both_sides = extents.iter().filter(|e| e.0 != "height").count() == 2;
    let straight = worst(width, depth);
    Some(if both_sides { straight.min(worst(depth, width)) } else { straight })
}
