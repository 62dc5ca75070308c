//! Places that a room has many of and that a prompt counts: bays for cars, racks, stalls, chairs to be treated in.

use super::seats_of;
use crate::domain::{Domain, Furnishing, Privacy, RoomType, Shape};

/// Floor of a room over what its places need, as a factor: the way in, the basin, the desk.
const SPARE: f64 = 1.25;

/// The places of rooms of a type.
#[derive(Debug, Clone, Copy)]
pub struct Places<'a> {
    /// The furnishing line whose units they are.
    pub line: &'a Furnishing,
    /// Places of one unit: four at a table to read at, one for a car.
    pub each: u32,
}

impl Places<'_> {
    /// Returns how many units so many places are.
    pub fn units(&self, places: u32) -> u32 {
        places.div_ceil(self.each)
    }

    /// Returns the floor of a room with so many places, m^2.
    pub fn area_m2(&self, places: u32) -> f64 {
        SPARE * self.line.area_per_item_m2 * f64::from(self.units(places))
    }

    /// Returns how many places a room of at most so much floor has, m^2; one at least.
    pub fn most(&self, area_m2: f64) -> u32 {
        let by_area = (area_m2 / (SPARE * self.line.area_per_item_m2)) as u32;
        (self.line.max.min(by_area) * self.each).max(1)
    }
}

/// Returns the places of rooms of a type: those that its words count, else those to lie at where several are treated;
/// `None` for all other rooms, those among them that have one such place each.
pub fn places<'a>(domain: &Domain, kind: &'a RoomType) -> Option<Places<'a>> {
    let line = kind.furnishing.first().filter(|f| f.required && f.max > 1 && f.area_per_item_m2 > 0.0)?;
    if !kind.places.is_empty() {
        return Some(Places { line, each: seats_of(domain, &line.item).max(1) });
    }
    let lies =
        domain.anchor(&line.item).is_some_and(|o| matches!(o.shape, Shape::Bed | Shape::HospitalBed | Shape::Sofa));
    // nobody is treated on the sofas of a lounge
    (lies && kind.privacy == Privacy::Shared).then_some(Places { line, each: 1 })
}
