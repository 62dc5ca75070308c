//! Where the parts of a model come as its joints move, and whether boxes overlap there: what a door or a drawer meets.

use crate::affine::{Vec3, add, cross, dot, length, scale, sub};
use crate::dynamics::{bodies_moved, moved_by, turned};
use crate::model3d::{Collision, Joint, JointKind, Model3d};

/// Positions of a joint's range at which its bodies are looked at.
const POSITIONS: usize = 24;
/// Boxes that touch, or overlap by less than this, do not meet, m.
const TOUCH_M: f64 = 0.001;
/// Edges closer to parallel than this (sine) span no axis of their own.
const PARALLEL: f64 = 1e-6;

/// A box in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Middle, m.
    pub center_m: Vec3,
    /// Half its extents along its axes, m.
    pub half_m: Vec3,
    /// Its axes: unit vectors.
    pub axes: [Vec3; 3],
}

impl Block {
    /// Returns the box around a shape; a round bar counts as the box around it.
    pub fn around(shape: &Collision) -> Self {
        if let Collision::TurnedBox { center, half, axes } = shape {
            return Self { center_m: *center, half_m: *half, axes: *axes };
        }
        let [min, max] = shape.bounds();
        Self {
            center_m: std::array::from_fn(|i| (min[i] + max[i]) / 2.0),
            half_m: std::array::from_fn(|i| (max[i] - min[i]) / 2.0),
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        }
    }

    /// Returns the box with this much more on each side, m.
    pub fn grown(&self, by_m: f64) -> Self {
        Self { half_m: self.half_m.map(|h| h + by_m), ..*self }
    }

    /// Returns the box of a model that stands at a place, turned about z.
    pub fn placed(&self, at_m: Vec3, yaw_rad: f64) -> Self {
        let up = [0.0, 0.0, 1.0];
        Self {
            center_m: add(at_m, turned(self.center_m, up, yaw_rad)),
            axes: self.axes.map(|a| turned(a, up, yaw_rad)),
            ..*self
        }
    }

    /// Returns true when two boxes overlap by more than a millimeter: no plane along a face or a pair of edges parts them.
    pub fn meets(&self, other: &Self) -> bool {
        let way = sub(other.center_m, self.center_m);
        if length(way) >= length(self.half_m) + length(other.half_m) {
            return false;
        }
        let reach = |block: &Self, axis: Vec3| -> f64 {
            (0..3).map(|i| dot(block.axes[i], axis).abs() * block.half_m[i]).sum()
        };
        let parts = |axis: Vec3| dot(way, axis).abs() > reach(self, axis) + reach(other, axis) - TOUCH_M;
        let edges = self.axes.iter().flat_map(|a| other.axes.iter().map(move |b| cross(*a, *b)));
        let edges = edges.filter(|e| length(*e) > PARALLEL).map(|e| scale(e, 1.0 / length(e)));
        !self.axes.iter().chain(&other.axes).copied().chain(edges).any(parts)
    }
}

/// Returns the boxes that the bodies held by a joint sweep over its range, each with the index of its body; all others stay at
/// zero. Nothing of a joint without limits, which turns in its place.
pub fn swept(model: &Model3d, joint: &Joint) -> Vec<(usize, Block)> {
    let Some([low, high]) = joint.limits else { return Vec::new() };
    let position = |step: usize| low + (high - low) * step as f64 / (POSITIONS - 1) as f64;
    let moved = |block: Block, position: f64| Block {
        center_m: moved_by(joint, position, block.center_m),
        axes: match joint.kind {
            JointKind::Prismatic => block.axes,
            JointKind::Revolute | JointKind::Continuous => block.axes.map(|a| turned(a, joint.axis, position)),
        },
        ..block
    };
    let bodies = bodies_moved(model, joint).into_iter();
    let shapes = bodies.flat_map(|b| {
        model.bodies.get(b).into_iter().flat_map(move |body| body.collisions.iter().map(move |s| (b, s)))
    });
    let blocks: Vec<(usize, Block)> = shapes.map(|(body, shape)| (body, Block::around(shape))).collect();
    (0..POSITIONS)
        .flat_map(|step| blocks.iter().map(move |(body, block)| (*body, moved(*block, position(step)))))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model3d::Body;

    fn block(min: Vec3, max: Vec3) -> Block {
        Block::around(&Collision::Box { min, max })
    }

    #[test]
    fn boxes_meet_where_they_overlap_however_they_are_turned() {
        let cube = block([-0.5; 3], [0.5; 3]);
        let beside = cube.placed([1.05, 0.0, 0.0], 0.0);
        assert!(!cube.meets(&beside) && cube.meets(&beside.placed([0.0; 3], 0.0).placed([-0.2, 0.0, 0.0], 0.0)));
        // Turned by an eighth its corner reaches 0.71 m.
        let turned = cube.placed([1.05, 0.0, 0.0], std::f64::consts::FRAC_PI_4);
        assert!(cube.meets(&turned) && !cube.meets(&cube.placed([1.3, 0.0, 0.0], std::f64::consts::FRAC_PI_4)));
        assert!(!cube.meets(&cube.placed([0.0, 0.0, 0.9995], 0.3)), "what stands on it touches it");
    }

    #[test]
    fn a_door_sweeps_a_quarter_before_its_cupboard() {
        let joint = Joint {
            name: "door".into(),
            kind: JointKind::Revolute,
            parent: 0,
            child: 1,
            origin: [0.0; 3],
            axis: [0.0, 0.0, -1.0],
            limits: Some([0.0, 1.6]),
        };
        let leaf = Collision::Box { min: [0.0, -0.02, 0.0], max: [0.6, 0.0, 1.0] };
        let bodies = vec![Body::default(), Body { collisions: vec![leaf], ..Body::default() }];
        let model = Model3d { bodies, joints: vec![joint.clone()], ..Model3d::default() };
        let swept = swept(&model, &joint);
        let met = |min: Vec3, max: Vec3| swept.iter().any(|(body, b)| *body == 1 && b.meets(&block(min, max)));
        assert!(met([0.3, -0.4, 0.2], [0.35, -0.35, 0.6]) && !met([0.5, -0.5, 0.2], [0.55, -0.45, 0.6]));
        assert!(!met([0.0, 0.01, 0.0], [0.6, 0.5, 1.0]) && !met([0.3, -0.4, 1.2], [0.35, -0.35, 1.6]));
    }
}
