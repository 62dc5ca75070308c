//! The figures a floorplan must keep and those it should aim for, drawn from constraints whose quantity, space and conditions are understood.

use std::collections::BTreeMap;

use d3dgen_model::domain::Circulation;
use d3dgen_model::scene_graph::{Robot, SceneGraph};

use crate::aims::ObjectAims;

/// Figures for the floorplan stage: the strictest of what applies, hard unless called advised.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Limits {
    /// True where no bed on wheels goes through the building: it has narrower ways.
    pub no_beds: bool,
    /// Least clear width of circulation, m.
    pub corridor_width: Option<Limit>,
    /// Width that advice asks of circulation beyond the hard figure, m; a wish.
    pub corridor_width_advised: Option<f64>,
    /// Width of circulation in which two of the robots pass each other, m; a wish.
    pub corridor_width_two_way: Option<f64>,
    /// Largest circulation over all net floor area that all advice allows; a wish.
    pub circulation_share_advised: Option<f64>,
    /// Least clear width of the main entrance door, m.
    pub entrance_width: Option<Limit>,
    /// Net floor area of the whole building for each workplace, m^2; a wish.
    pub area_per_workplace_advised: Option<f64>,
    /// Limits by room type id.
    pub rooms: BTreeMap<String, RoomLimits>,
    /// What to aim at when objects are chosen and placed; wishes.
    pub objects: ObjectAims,
}

/// What two robots that pass each other have to spare where no rule says more, each of them, m.
const PASSING_M: f64 = 0.1;

impl Limits {
    /// Returns the clear width that circulation has by the domain and by the rules, m.
    pub fn corridor_m(&self, circulation: &Circulation) -> f64 {
        circulation.width_m(!self.no_beds).max(self.corridor_width.as_ref().map_or(0.0, |l| l.value))
    }

    /// Returns the clear width that the entrance has by the domain and by the rules, m.
    pub fn entrance_m(&self, circulation: &Circulation) -> f64 {
        circulation.entrance_width_m(!self.no_beds).max(self.entrance_width.as_ref().map_or(0.0, |l| l.value))
    }

    /// Returns the width of circulation in which two of a graph's robots pass each other, m; 0 where they need not.
    pub fn two_way_m(&self, graph: &SceneGraph) -> f64 {
        let widest = graph.robots.iter().map(Robot::width_m).reduce(f64::max).filter(|_| graph.is_two_way());
        widest.map_or(0.0, |width| self.corridor_width_two_way.unwrap_or(2.0 * (width + PASSING_M)))
    }
}

/// Limits of one room type.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RoomLimits {
    /// Least net floor area, m^2.
    pub area_min: Option<Limit>,
    /// Largest net floor area, m^2.
    pub area_max: Option<Limit>,
    /// Net floor area between which all advice is met, or most of it where advice contradicts itself, m^2; a wish.
    pub area_advised: Option<[f64; 2]>,
    /// Net floor area for each person that works or sits in it, m^2; a wish.
    pub area_per_person_advised: Option<f64>,
    /// Least clear extent in both directions, m.
    pub dimension_min: Option<Limit>,
    /// Diameter of the circle that a wheelchair turns on, m.
    pub turning_circle: Option<Limit>,
    /// Least clear width of its door, m.
    pub door_width: Option<Limit>,
    /// Clear width of its door that all advice asks for, m; a wish.
    pub door_width_advised: Option<f64>,
    /// Least clear height, m.
    pub ceiling_height_min: Option<Limit>,
    /// Least clear heights that depend on the net floor area, m.
    pub ceiling_heights_by_area: Vec<AreaLimit>,
}

/// A figure and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// The figure in SI units.
    pub value: f64,
    /// Id of the constraint in the knowledge base.
    pub constraint_id: String,
}

/// A figure for rooms of a range of net floor areas.
#[derive(Debug, Clone, PartialEq)]
pub struct AreaLimit {
    /// Least area it holds for, m^2.
    pub above_m2: f64,
    /// Largest area it holds for, m^2.
    pub up_to_m2: f64,
    /// The figure.
    pub limit: Limit,
}

impl RoomLimits {
    /// Returns the least clear height of a room of this net floor area, m.
    pub fn ceiling_height(&self, area_m2: f64) -> Option<f64> {
        let steps = self.ceiling_heights_by_area.iter().filter(|s| s.above_m2 <= area_m2 && area_m2 <= s.up_to_m2);
        steps.map(|s| s.limit.value).chain(self.ceiling_height_min.iter().map(|l| l.value)).reduce(f64::max)
    }
}
