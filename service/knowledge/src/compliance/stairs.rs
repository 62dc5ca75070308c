//! Steps and flights of stairs.

use super::site::{Object, Site};
use crate::measure::Measure;
use crate::retrieve::Rule;

/// Reads a figure of stairs: of two flights side by side for a building's own, of one for a flight that stands in a room.
pub(super) fn figure(site: &Site, object: &Object, rule: &Rule) -> Option<f64> {
    let [width, _, height] = object.placement.size_m;
    let stairs = site.domain.circulation.storeys.as_ref().map(|s| &s.stairs);
    let own = stairs.filter(|s| s.object == object.placement.object);
    match (rule.quantity.measure, own) {
        (Measure::FlightWidth, Some(stairs)) => Some(stairs.flight_width_of(width)),
        (Measure::FlightWidth, None) => Some(width),
        (Measure::StepRise, Some(stairs)) => Some(height / f64::from(stairs.rises(height))),
        (Measure::StepGoing, Some(stairs)) => Some(stairs.going_m),
        (Measure::StairsPitch, Some(stairs)) => {
            let rise = height / f64::from(stairs.rises(height));
            Some((rise / stairs.going_m).atan().to_degrees())
        }
        _ => None,
    }
}
