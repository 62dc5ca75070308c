//! Center of mass and inertia of rigid bodies, in closed form from their collision shapes.

use crate::affine::Vec3;
use crate::model3d::{Body, Collision, Model3d};

/// How a body resists being moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Center of mass in the frame of the model, m.
    pub center_m: [f64; 3],
    /// Inertia about the center of mass, kg m^2, along the axes of the model: a symmetric matrix.
    pub tensor: [[f64; 3]; 3],
}

/// Returns the inertia of a body whose mass is spread evenly over its collision shapes, or over the box around what is
/// seen when it has none; shapes that overlap count twice there.
pub fn inertia(body: &Body) -> Inertia {
    let mut shapes: Vec<Collision> = body.collisions.clone();
    if shapes.is_empty() {
        let bounds = body.visuals.iter().filter_map(|v| v.mesh.bounds()).reduce(|a, b| {
            [std::array::from_fn(|i| a[0][i].min(b[0][i])), std::array::from_fn(|i| a[1][i].max(b[1][i]))]
        });
        let [min, max] = bounds.unwrap_or([[-0.05; 3], [0.05; 3]]);
        shapes.push(Collision::Box { min, max });
    }
    // A plate without thickness would have no volume and its body no inertia.
    let volumes: Vec<f64> = shapes.iter().map(|s| volume(s).max(1e-12)).collect();
    let total: f64 = volumes.iter().sum();
    let masses: Vec<f64> = volumes.iter().map(|v| body.mass_kg * v / total).collect();
    let centers: Vec<Vec3> = shapes.iter().map(center).collect();
    let center: Vec3 =
        std::array::from_fn(|i| centers.iter().zip(&volumes).map(|(c, v)| c[i] * v / total).sum::<f64>());
    let mut tensor = [[0.0; 3]; 3];
    for ((shape, mass), at) in shapes.iter().zip(&masses).zip(&centers) {
        let own = own_tensor(shape, *mass);
        let way: Vec3 = std::array::from_fn(|i| at[i] - center[i]);
        let square: f64 = way.iter().map(|v| v * v).sum();
        for i in 0..3 {
            for j in 0..3 {
                let same = if i == j { square } else { 0.0 };
                tensor[i][j] += own[i][j] + mass * (same - way[i] * way[j]);
            }
        }
    }
    Inertia { mass_kg: body.mass_kg, center_m: center, tensor }
}

/// Returns the inertia of all bodies of a model as one, with every joint at zero.
pub fn whole(model: &Model3d) -> Inertia {
    let all: Vec<Inertia> = model.bodies.iter().map(inertia).collect();
    let mass_kg: f64 = all.iter().map(|b| b.mass_kg).sum();
    let share = |b: &Inertia| if mass_kg > 0.0 { b.mass_kg / mass_kg } else { 1.0 / all.len() as f64 };
    let center_m: Vec3 = std::array::from_fn(|i| all.iter().map(|b| b.center_m[i] * share(b)).sum());
    let mut tensor = [[0.0; 3]; 3];
    for body in &all {
        let way: Vec3 = std::array::from_fn(|i| body.center_m[i] - center_m[i]);
        let square: f64 = way.iter().map(|v| v * v).sum();
        for i in 0..3 {
            for j in 0..3 {
                let same = if i == j { square } else { 0.0 };
                tensor[i][j] += body.tensor[i][j] + body.mass_kg * (same - way[i] * way[j]);
            }
        }
    }
    Inertia { mass_kg, center_m, tensor }
}

/// Returns the volume of a shape, m^3.
pub fn volume(shape: &Collision) -> f64 {
    use std::f64::consts::PI;
    match shape {
        Collision::Box { min, max } => (0..3).map(|i| max[i] - min[i]).product(),
        Collision::Cylinder { radius, length, .. } => PI * radius * radius * length,
        Collision::Sphere { radius, .. } => 4.0 / 3.0 * PI * radius.powi(3),
        Collision::TurnedBox { half, .. } => 8.0 * half.iter().product::<f64>(),
    }
}

fn center(shape: &Collision) -> Vec3 {
    match shape {
        Collision::Box { min, max } => std::array::from_fn(|i| (min[i] + max[i]) / 2.0),
        Collision::Cylinder { center, .. } | Collision::Sphere { center, .. } | Collision::TurnedBox { center, .. } => {
            *center
        }
    }
}

/// Returns the inertia of a shape about its own middle.
fn own_tensor(shape: &Collision, mass: f64) -> [[f64; 3]; 3] {
    let diagonal = |d: Vec3| std::array::from_fn(|i| std::array::from_fn(|j| if i == j { d[i] } else { 0.0 }));
    let block = |half: Vec3| -> Vec3 {
        let square = half.map(|v| v * v);
        std::array::from_fn(|i| mass / 3.0 * (square[(i + 1) % 3] + square[(i + 2) % 3]))
    };
    match shape {
        Collision::Box { min, max } => diagonal(block(std::array::from_fn(|i| (max[i] - min[i]) / 2.0))),
        Collision::Sphere { radius, .. } => diagonal([0.4 * mass * radius * radius; 3]),
        Collision::Cylinder { radius, length, axis, .. } => {
            let across = mass / 12.0 * (3.0 * radius * radius + length * length);
            let along = mass / 2.0 * radius * radius;
            diagonal(std::array::from_fn(|i| if i == *axis { along } else { across }))
        }
        Collision::TurnedBox { half, axes, .. } => {
            let own = block(*half);
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| own[k] * axes[k][i] * axes[k][j]).sum()))
        }
    }
}

impl Inertia {
    /// Returns the principal moments, kg m^2, and their axes: unit vectors, right-handed.
    pub fn principal(&self) -> ([f64; 3], [[f64; 3]; 3]) {
        // Jacobi's method: turns away the largest mixed moment until none is left.
        let mut m = self.tensor;
        let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for _ in 0..32 {
            let pairs = [(0, 1), (0, 2), (1, 2)];
            let (p, q) =
                pairs.into_iter().max_by(|a, b| m[a.0][a.1].abs().total_cmp(&m[b.0][b.1].abs())).unwrap_or((0, 1));
            let scale = m[0][0].abs() + m[1][1].abs() + m[2][2].abs();
            if m[p][q].abs() <= 1e-12 * scale {
                break;
            }
            let angle = 0.5 * (2.0 * m[p][q]).atan2(m[q][q] - m[p][p]);
            let (sin, cos) = angle.sin_cos();
            for row in &mut m {
                let (a, b) = (row[p], row[q]);
                (row[p], row[q]) = (cos * a - sin * b, sin * a + cos * b);
            }
            for k in 0..3 {
                let (a, b) = (m[p][k], m[q][k]);
                (m[p][k], m[q][k]) = (cos * a - sin * b, sin * a + cos * b);
                let (a, b) = (axes[p][k], axes[q][k]);
                (axes[p][k], axes[q][k]) = (cos * a - sin * b, sin * a + cos * b);
            }
        }
        ([m[0][0], m[1][1], m[2][2]], axes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(collisions: Vec<Collision>, mass_kg: f64) -> Body {
        Body { name: "b".into(), collisions, mass_kg, ..Body::default() }
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9 * (1.0 + b.abs())
    }

    #[test]
    fn a_box_cut_in_two_is_the_box() {
        let whole = inertia(&body(vec![Collision::Box { min: [0.0; 3], max: [2.0, 1.0, 3.0] }], 6.0));
        let halves = vec![
            Collision::Box { min: [0.0; 3], max: [0.5, 1.0, 3.0] },
            Collision::Box { min: [0.5, 0.0, 0.0], max: [2.0, 1.0, 3.0] },
        ];
        let cut = inertia(&body(halves, 6.0));
        for i in 0..3 {
            assert!(close(whole.center_m[i], [1.0, 0.5, 1.5][i]) && close(cut.center_m[i], whole.center_m[i]));
            for j in 0..3 {
                assert!(close(whole.tensor[i][j], cut.tensor[i][j]), "{:?} {:?}", whole.tensor, cut.tensor);
            }
        }
        assert!(close(whole.tensor[0][0], 6.0 / 12.0 * (1.0 + 9.0)));
    }

    #[test]
    fn principal_axes_of_a_turned_box_are_its_own() {
        let (sin, cos) = 0.5_f64.sin_cos();
        let axes = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
        let turned = Collision::TurnedBox { center: [1.0, 2.0, 3.0], half: [1.0, 0.5, 0.2], axes };
        let (moments, found) = inertia(&body(vec![turned], 3.0)).principal();
        let expected = [0.25 + 0.04, 1.0 + 0.04, 1.0 + 0.25];
        for (moment, axis) in moments.iter().zip(found) {
            let k = expected.iter().position(|e| close(*e, *moment)).expect("a moment of the box");
            let along: f64 = (0..3).map(|i| axis[i] * axes[k][i]).sum();
            assert!(close(along.abs(), 1.0), "{axis:?}");
        }
        let triple = crate::affine::dot(crate::affine::cross(found[0], found[1]), found[2]);
        assert!(close(triple, 1.0));
    }

    #[test]
    fn a_model_of_two_bodies_is_as_heavy_as_both() {
        let [low, high] = [[0.0, 1.5], [1.5, 3.0]]
            .map(|[a, b]| body(vec![Collision::Box { min: [0.0, 0.0, a], max: [2.0, 1.0, b] }], 3.0));
        let both = whole(&Model3d { bodies: vec![low, high], ..Model3d::default() });
        let one = inertia(&body(vec![Collision::Box { min: [0.0; 3], max: [2.0, 1.0, 3.0] }], 6.0));
        assert!(close(both.mass_kg, 6.0) && (0..3).all(|i| close(both.center_m[i], one.center_m[i])));
        assert!((0..9).all(|k| close(both.tensor[k / 3][k % 3], one.tensor[k / 3][k % 3])), "{both:?} {one:?}");
        assert_eq!(whole(&Model3d::default()).mass_kg, 0.0);
    }

    #[test]
    fn bodies_without_shapes_have_inertia_too() {
        let made = inertia(&body(Vec::new(), 2.0));
        assert!(made.tensor[0][0] > 0.0 && made.mass_kg == 2.0);
    }
}
