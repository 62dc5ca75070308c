//! Sizes, heights and windows of rooms.

use d3dgen_model::TOLERANCE_M;

use super::Reading;
use super::site::{Room, Site};
use crate::freespace::FreeSpace;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule};

/// Reads a quantity of every room the constraint is about; rooms without it (no bed for an area per bed) are left out.
pub(super) fn read(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    site.rooms_of(a).filter_map(|room| Some(Reading::new(&room.plan.room_id, figure(site, room, rule)?))).collect()
}

fn figure(site: &Site, room: &Room, rule: &Rule) -> Option<f64> {
    let per = |whole: f64, parts: usize| (parts > 0).then(|| whole / parts as f64);
    let area = room.plan.net_area_m2;
    Some(match rule.quantity.measure {
        Measure::RoomArea => area,
        Measure::AreaPerBed => per(area, room.beds())?,
        Measure::AreaPerPerson => per(area, room.persons())?,
        Measure::AirVolumePerPerson => per(area * room.plan.ceiling_height_m, room.persons())?,
        Measure::AreaPerRobot => per(area, site.retrieval.robots as usize)?,
        Measure::BedsPerRoom => (room.beds() > 0).then_some(room.beds() as f64)?,
        Measure::LeastDimension => bare(room).largest_square(),
        Measure::InnerRectangle => bare(room).width_at_length(rule.bounds.sides?[1]),
        Measure::FreeRectangle => room.space().width_at_length(rule.bounds.sides?[1]),
        Measure::TurningCircle => room.space().largest_square(),
        Measure::Proportion => {
            let b = room.plan.net_polygon.bounds();
            b.width().max(b.height()) / b.width().min(b.height()).max(TOLERANCE_M)
        }
        Measure::CeilingHeight => room.plan.ceiling_height_m,
        Measure::WindowSill => room.windows.iter().map(|w| w.sill_m).reduce(f64::min)?,
        Measure::WindowRatio => {
            let glass: f64 = room.windows.iter().map(|w| w.line.length() * (w.head_m - w.sill_m)).sum();
            glass / area.max(TOLERANCE_M)
        }
        Measure::Windows => room.windows.len() as f64,
        _ => return None,
    })
}

/// Returns the floor between the walls, without furniture.
fn bare(room: &Room) -> FreeSpace {
    FreeSpace::new(&room.plan.net_polygon, &[])
}
