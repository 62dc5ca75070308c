//! Sizes, heights and windows of rooms.

use d3dgen_model::TOLERANCE_M;
use d3dgen_model::storeys::LinkKind;

use super::circle;
use super::site::{Room, Site};
use crate::aims::is_mirror;
use crate::compliance::reading::Reading;
use crate::freespace::FreeSpace;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule};

/// Windows with a lower sill than this reach down to the floor, m.
const FLOOR_GLASS_M: f64 = 0.10;

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
        Measure::TurningCircle => {
            let standing = site.world.floorplan.obstacles_of(&room.plan.room_id).map(|o| o.outline.clone());
            let furniture = room.objects.iter().filter(|o| o.blocks).map(|o| o.placement.footprint());
            circle::largest(&room.plan.net_polygon, &furniture.chain(standing).collect::<Vec<_>>())
        }
        Measure::Proportion => {
            let b = room.plan.net_polygon.bounds();
            b.width().max(b.height()) / b.width().min(b.height()).max(TOLERANCE_M)
        }
        Measure::CeilingHeight => room.plan.ceiling_height_m,
        Measure::WindowSill => room.windows.iter().map(|w| w.sill_m).reduce(f64::min)?,
        Measure::WindowRatio | Measure::OpenableRatio => {
            let glass: f64 = room.windows.iter().map(|w| w.line.length() * (w.head_m - w.sill_m)).sum();
            glass / area.max(TOLERANCE_M)
        }
        Measure::Windows => room.windows.len() as f64,
        Measure::WindowWidth => room.windows.iter().map(|w| w.line.length()).reduce(f64::max)?,
        Measure::WindowHeight => room.windows.iter().map(|w| w.head_m - w.sill_m).reduce(f64::max)?,
        Measure::WindowArea => room.windows.iter().map(|w| w.line.length() * (w.head_m - w.sill_m)).reduce(f64::max)?,
        Measure::DepthToHeight => depth_behind_windows(room)? / room.plan.ceiling_height_m.max(TOLERANCE_M),
        // a storey has no steps but those of its stairwells, which robots need not climb beside an elevator
        Measure::NoStairs => {
            let links = &site.world.floorplan.links;
            let lift = links.is_empty() || links.iter().any(|l| l.kind == LinkKind::Elevator);
            if lift { 1.0 } else { 0.0 }
        }
        Measure::NoGlassOrMirrors => {
            let glass = room.windows.iter().any(|w| w.sill_m < FLOOR_GLASS_M);
            let mirror = room.objects.iter().any(|o| o.kind.is_some_and(is_mirror));
            if glass || mirror { 0.0 } else { 1.0 }
        }
        Measure::AreaPerObject => {
            per(area, room.objects.iter().filter(|o| o.kind.is_some_and(|k| rule.quantity.picks(k))).count())?
        }
        Measure::GrossAreaPerPerson => per(room.plan.polygon.signed_area().abs(), room.persons())?,
        Measure::AreaPerFurther => per(area - rule.quantity.base, room.persons().checked_sub(1)?)?,
        Measure::FreeAreaPerPerson => {
            let taken: f64 =
                room.objects.iter().filter(|o| o.blocks && o.placement.support.is_none()).map(|o| o.rect.area()).sum();
            per(area - taken, room.persons())?
        }
        Measure::PersonsPer100 => (room.persons() > 0).then(|| room.persons() as f64 * 100.0 / area)?,
        _ => return None,
    })
}

/// Returns the floor between the walls, without furniture.
fn bare(room: &Room) -> FreeSpace {
    FreeSpace::new(&room.plan.net_polygon, &[])
}

/// Returns how deep a room with windows on one side only lies behind them, m; `None` for other rooms.
fn depth_behind_windows(room: &Room) -> Option<f64> {
    let first = room.windows.first()?;
    let across = |w: &d3dgen_model::floorplan::Window| {
        let middle = w.line.middle();
        if w.line.is_vertical() { middle.x } else { middle.y }
    };
    let same_side = |w: &&d3dgen_model::floorplan::Window| {
        w.line.is_vertical() == first.line.is_vertical() && (across(w) - across(first)).abs() < TOLERANCE_M
    };
    let bounds = room.plan.net_polygon.bounds();
    let depth = if first.line.is_vertical() { bounds.width() } else { bounds.height() };
    room.windows.iter().all(same_side).then_some(depth)
}
