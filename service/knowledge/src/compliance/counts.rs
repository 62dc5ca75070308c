//! Figures of the whole building: areas, numbers of rooms and of water closets.

use d3dgen_model::domain::Shape;

use super::Reading;
use super::site::Site;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule, Scope};

/// Reads a quantity of the building; nothing when it has none (no bed for beds per toilet).
pub(super) fn read(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    figure(site, a, rule).map(|v| Reading::new("building", v)).into_iter().collect()
}

fn figure(site: &Site, a: &Applicable, rule: &Rule) -> Option<f64> {
    let area = |circulation_only: bool| -> f64 {
        let rooms = site.rooms.iter().filter(|r| r.plan.circulation || !circulation_only);
        rooms.map(|r| r.plan.net_area_m2).sum()
    };
    let toilets = site.count(&[Shape::Toilet, Shape::Cubicle]);
    let per_toilet = |n: f64| (toilets > 0 && n > 0.0).then(|| n / toilets as f64);
    match rule.quantity.measure {
        Measure::BuildingArea => Some(area(false)),
        Measure::CirculationShare => (area(true) > 0.0).then(|| area(true) / area(false)),
        Measure::RoomsPresent | Measure::RoomNeededAbovePersons => match &a.scope {
            Scope::Rooms(types) => Some(site.rooms.iter().filter(|r| types.contains(&r.plan.room_type)).count() as f64),
            _ => None,
        },
        Measure::ToiletsForPersons => Some(toilets as f64),
        Measure::PersonsPerToilet => per_toilet(f64::from(site.retrieval.persons)),
        Measure::BedsPerToilet => per_toilet(site.rooms.iter().map(|r| r.beds()).sum::<usize>() as f64),
        _ => None,
    }
}
