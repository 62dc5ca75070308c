//! A model put into another frame.

use d3dgen_mesh::{Collision, Model3d};

/// Moves all of a model by the rows of a 3 x 4 matrix, which turns by quarters, scales and shifts.
pub(crate) fn move_by(model: &mut Model3d, rows: &[[f64; 4]; 3]) {
    let point = |p: [f64; 3]| rows.map(|[a, b, c, d]| a * p[0] + b * p[1] + c * p[2] + d);
    let direction = |v: [f64; 3]| {
        // Of a turn with a scale along each axis, the directions of normals are scaled the other way.
        let turned = rows.map(|row| {
            let scale = row[..3].iter().map(|v| v * v).sum::<f64>().max(f64::MIN_POSITIVE);
            (row[0] * v[0] + row[1] * v[1] + row[2] * v[2]) / scale
        });
        let length = turned.iter().map(|v| v * v).sum::<f64>().sqrt();
        if length > 0.0 { turned.map(|v| v / length) } else { v }
    };
    let scale = rows.map(|row| row[..3].iter().map(|v| v * v).sum::<f64>().sqrt());
    let mean = scale.iter().sum::<f64>() / 3.0;
    for body in &mut model.bodies {
        for mesh in body.visuals.iter_mut().map(|v| &mut v.mesh) {
            for p in &mut mesh.positions {
                *p = point(p.map(f64::from)).map(|v| v as f32);
            }
            for n in &mut mesh.normals {
                *n = direction(n.map(f64::from)).map(|v| v as f32);
            }
        }
        for shape in &mut body.collisions {
            match shape {
                Collision::Box { min, max } => {
                    let (a, b) = (point(*min), point(*max));
                    *min = std::array::from_fn(|i| a[i].min(b[i]));
                    *max = std::array::from_fn(|i| a[i].max(b[i]));
                }
                Collision::Cylinder { center, radius, length, axis } => {
                    let along = (0..3).max_by(|&i, &j| rows[i][*axis].abs().total_cmp(&rows[j][*axis].abs()));
                    *center = point(*center);
                    *axis = along.unwrap_or(*axis);
                    *length *= scale[*axis];
                    *radius *= mean;
                }
                Collision::TurnedBox { center, half, axes } => {
                    *center = point(*center);
                    *half = half.map(|h| h * mean);
                    *axes = axes.map(direction);
                }
                Collision::Sphere { center, radius } => {
                    *center = point(*center);
                    *radius *= mean;
                }
            }
        }
    }
    for joint in &mut model.joints {
        joint.origin = point(joint.origin);
        joint.axis = direction(joint.axis);
        if joint.kind == d3dgen_mesh::JointKind::Prismatic {
            joint.limits = joint.limits.map(|l| l.map(|v| v * mean));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::tests::boxes;

    #[test]
    fn models_turn_scale_and_shift() {
        let mut model = boxes(&[[[0.0; 3], [1.0, 2.0, 3.0]]]);
        model.bodies[0].visuals[0].mesh.normals = vec![[0.0, 0.0, 1.0]; 8];
        model.bodies[0].collisions = vec![Collision::Box { min: [0.0; 3], max: [1.0, 2.0, 3.0] }];
        // y up to z up, twice as large
        move_by(&mut model, &[[2.0, 0.0, 0.0, -1.0], [0.0, 0.0, -2.0, 0.0], [0.0, 2.0, 0.0, 0.5]]);
        assert_eq!(model.bounds(), Some([[-1.0, -6.0, 0.5], [1.0, 0.0, 4.5]]));
        assert_eq!(model.bodies[0].visuals[0].mesh.normals[0], [0.0, -1.0, 0.0]);
        assert_eq!(model.bodies[0].collisions[0], Collision::Box { min: [-1.0, -6.0, 0.5], max: [1.0, 0.0, 4.5] });
    }
}
