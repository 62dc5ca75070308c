//! Which doors, drawers and lifts of things pass what stands in their way.

use std::collections::BTreeSet;

use d3dgen_mesh::sweep::{Block, swept};
use d3dgen_mesh::{Joint, JointKind};

use super::{Mobility, SimModel, SimObject, SimPass};

/// How far from where it stands what can be moved may be, m: chairs turn, and what has wheels rolls.
const ASIDE_M: f64 = 0.05;
const ROLLS_M: f64 = 0.3;

/// Returns the parts of things that would be jammed by what can be moved where it stands.
pub(super) fn all(models: &[SimModel], objects: &[SimObject]) -> Vec<SimPass> {
    let mut passes = Vec::new();
    for (index, object) in objects.iter().enumerate() {
        let Some(model) = models.get(object.model).map(|m| &m.model) else { continue };
        let swept: Vec<(usize, Block)> = model.joints.iter().flat_map(|j| swept(model, j)).collect();
        let swept: Vec<(usize, Block)> =
            swept.into_iter().map(|(body, block)| (body, block.placed(object.at_m, object.yaw_rad))).collect();
        if swept.is_empty() {
            continue;
        }
        for (other, moved) in objects.iter().enumerate().filter(|(k, o)| *k != index && in_reach(object, o)) {
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
    let Some(model) = models.get(object.model).map(|m| &m.model) else { return Vec::new() };
    let aside = if model.joints.iter().any(rolls) { ROLLS_M } else { ASIDE_M };
    let shapes = model.bodies.iter().flat_map(|b| &b.collisions);
    shapes.map(|s| Block::around(s).grown(aside).placed(object.at_m, object.yaw_rad)).collect()
}

/// Returns true for the axle of a wheel.
fn rolls(joint: &Joint) -> bool {
    joint.kind == JointKind::Continuous && joint.axis[2].abs() < 0.5
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use d3dgen_mesh::{Body, Collision, Joint, JointKind, Model3d};

    use super::*;

    fn model(id: &str, shapes: [[f64; 3]; 2], drawer: bool) -> SimModel {
        let body =
            |[min, max]: [[f64; 3]; 2]| Body { collisions: vec![Collision::Box { min, max }], ..Body::default() };
        let joint = Joint {
            name: "drawer".into(),
            kind: JointKind::Prismatic,
            parent: 0,
            child: 1,
            origin: [0.0; 3],
            axis: [0.0, -1.0, 0.0],
            limits: Some([0.0, 0.3]),
        };
        let bodies = if drawer { vec![Body::default(), body(shapes)] } else { vec![body(shapes)] };
        let model = Model3d { bodies, joints: if drawer { vec![joint] } else { Vec::new() }, ..Model3d::default() };
        SimModel { reference: id.into(), id: id.into(), object: id.into(), is_kept: false, model: Arc::new(model) }
    }

    fn object(model: usize, mobility: Mobility, at_m: [f64; 3]) -> SimObject {
        SimObject {
            id: format!("thing_{model}"),
            class: String::new(),
            label: String::new(),
            room_id: "room".into(),
            level: 0,
            model,
            at_m,
            yaw_rad: 0.0,
            support: None,
            mobility,
            collides: true,
            mass_kg: 1.0,
            friction: 0.5,
            restitution: 0.1,
        }
    }

    #[test]
    fn a_drawer_passes_the_arm_of_a_chair_that_it_would_brush() {
        let desk = model("desk", [[-0.24, -0.3, 0.6], [0.24, -0.28, 0.7]], true);
        let arm = model("chair", [[0.0, -0.1, 0.65], [0.07, 0.1, 0.68]], false);
        let beside = |x: f64| {
            let objects = [object(0, Mobility::Fixed, [0.0; 3]), object(1, Mobility::Movable, [x, -0.5, 0.0])];
            all(&[desk.clone(), arm.clone()], &objects).len()
        };
        assert_eq!([beside(0.0), beside(0.24), beside(0.4)], [1, 1, 0]);
        let bed = [object(0, Mobility::Movable, [0.0; 3]), object(1, Mobility::Movable, [0.0, -0.5, 0.0])];
        assert_eq!(all(&[desk.clone(), arm.clone()], &bed).len(), 1, "what can be moved itself is not jammed either");
    }
}
