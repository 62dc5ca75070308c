//! Appliances that a home has one of, in whichever room has a place: a washing machine that the kitchen cannot take
//! stands in the bathroom or the store.

use std::collections::BTreeSet;

use d3dgen_knowledge::Limits;
use d3dgen_model::domain::{Domain, Furnishing, ObjectType, Shape};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::placements::{Placement, Placements};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::stage::{Error, Stop};

use super::{Wanted, insert, one_more};

/// Puts what stands in no room, and had no place where it was wanted, into another room whose type knows it.
///
/// # Errors
/// `Cancelled`.
pub(crate) fn place(
    graph: &SceneGraph,
    plan: &Floorplan,
    (domain, limits): (&Domain, &Limits),
    out: &mut Placements,
    stop: Stop<'_>,
) -> Result<(), Error> {
    let wanted: BTreeSet<&str> =
        out.unplaced.iter().filter_map(|u| shared(domain, &u.item)).map(|o| o.id.as_str()).collect();
    let missing = wanted.into_iter().filter(|id| !out.placements.iter().any(|p| p.object == *id));
    for object in missing.filter_map(|id| domain.object(id)).collect::<Vec<_>>() {
        let knows = |room: &&PlanRoom| {
            let kind = domain.room_type_or_generic(&room.room_type);
            kind.furnishing.iter().any(|f| f.item == object.id)
        };
        let found = plan.rooms.iter().filter(knows).find_map(|room| {
            let storey = &plan.storey_at(room.level);
            let here: Vec<&Placement> = out.placements.iter().filter(|p| p.room_id == room.room_id).collect();
            let one = [Wanted::IfFree(object), Wanted::Only(object)]
                .into_iter()
                .find_map(|wanted| one_more(graph, storey, room, (domain, limits), &here, wanted, stop));
            one.filter(|p| p.object == object.id)
        });
        stop.check()?;
        let Some(more) = found else { continue };
        out.unplaced.retain(|u| u.item != object.id || u.required);
        insert(out, more);
    }
    Ok(())
}

/// Returns an appliance by its id that rooms have only where no other room is for it.
fn shared<'d>(domain: &'d Domain, item: &str) -> Option<&'d ObjectType> {
    let object = domain.object(item).filter(|o| o.shape == Shape::Appliance)?;
    let one = |f: &Furnishing| f.item == object.id && f.max == 1 && !f.required && !f.unless_rooms.is_empty();
    domain.room_types.iter().any(|kind| kind.furnishing.iter().any(one)).then_some(object)
}
