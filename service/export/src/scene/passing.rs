//! Which doors and drawers of furniture pass what stands in their way.

use std::collections::BTreeSet;

use d3dgen_mesh::sweep::{Block, swept};

use super::{Mobility, SimModel, SimObject, SimPass};

/// Returns the parts of things that stand fast and would be jammed by what can be moved where it stands.
pub(super) fn all(models: &[SimModel], objects: &[SimObject]) -> Vec<SimPass> {
    let mut passes = Vec::new();
    for (index, object) in objects.iter().enumerate().filter(|(_, o)| o.mobility == Mobility::Fixed) {
        let Some(model) = models.get(object.model).map(|m| &m.model) else { continue };
        let swept: Vec<(usize, Block)> = model.joints.iter().flat_map(|j| swept(model, j)).collect();
        let swept: Vec<(usize, Block)> =
            swept.into_iter().map(|(body, block)| (body, block.placed(object.at_m, object.yaw_rad))).collect();
        for (other, moved) in objects.iter().enumerate().filter(|(_, o)| in_reach(object, o)) {
            let blocks = blocks(models, moved);
            let met = swept.iter().filter(|(_, own)| blocks.iter().any(|b| own.meets(b))).map(|(body, _)| *body);
            let met: BTreeSet<usize> = met.collect();
            passes.extend(met.into_iter().map(|b| SimPass {
                object: index,
                body: model.bodies[b].name.clone(),
                other,
            }));
        }
    }
    passes
}

/// Returns true for furniture that can be moved in the room of a thing; what a hand lifts gives way.
fn in_reach(object: &SimObject, other: &SimObject) -> bool {
    other.mobility == Mobility::Movable && other.collides && other.room_id == object.room_id
}

fn blocks(models: &[SimModel], object: &SimObject) -> Vec<Block> {
    let bodies = models.get(object.model).into_iter().flat_map(|m| &m.model.bodies);
    bodies.flat_map(|b| &b.collisions).map(|s| Block::around(s).placed(object.at_m, object.yaw_rad)).collect()
}
