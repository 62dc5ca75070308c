//! Kept models as worlds place them: the front at -y, with masses and collision shapes.

use d3dgen_mesh::{Body, Collision, Mesh, Model3d, parts};

use crate::annotation::{Annotation, FrontAxis};

/// Returns the model of an asset with its front at -y. A body without collision shapes gets boxes around its parts, a model without masses the one of its annotation, spread by the volume of the bodies' boxes.
pub fn placed(mut model: Model3d, annotation: &Annotation) -> Model3d {
    // A quarter turn about z that brings the front to -y; the origin is in the middle of the footprint.
    let [x, y] = match annotation.front.axis {
        FrontAxis::MinusY | FrontAxis::Any => [[1.0, 0.0], [0.0, 1.0]],
        FrontAxis::PlusY => [[-1.0, 0.0], [0.0, -1.0]],
        FrontAxis::MinusX => [[0.0, -1.0], [1.0, 0.0]],
        FrontAxis::PlusX => [[0.0, 1.0], [-1.0, 0.0]],
    };
    crate::moved::move_by(&mut model, &[[x[0], x[1], 0.0, 0.0], [y[0], y[1], 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
    for body in model.bodies.iter_mut().filter(|b| b.collisions.is_empty()) {
        body.collisions = parts::boxes(&body.visuals.iter().map(|v| &v.mesh).collect::<Vec<&Mesh>>());
    }
    if let Some(mass) = annotation.mass.as_ref().filter(|_| model.bodies.iter().all(|b| b.mass_kg <= 0.0)) {
        let volumes: Vec<f64> = model.bodies.iter().map(volume).collect();
        let all: f64 = volumes.iter().sum();
        for (body, volume) in model.bodies.iter_mut().zip(volumes) {
            body.mass_kg = mass.mass_kg * volume / all;
        }
    }
    model
}

/// Returns the volume of the collision shapes' boxes, m^3; a little for a body that is flat, so that it weighs something.
fn volume(body: &Body) -> f64 {
    let of = |shape: &Collision| {
        let [min, max] = shape.bounds();
        (0..3).map(|i| (max[i] - min[i]).max(1e-3)).product::<f64>()
    };
    body.collisions.iter().map(of).sum::<f64>().max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::Library;
    use crate::measure::tests::boxes;
    use crate::sample;

    #[test]
    fn kept_models_face_the_front_weigh_and_collide() {
        let catalog = sample::catalog();
        let mut annotation = Library::new(catalog).assets().next().expect("shipped").annotation(catalog);
        annotation.front.axis = FrontAxis::PlusX;
        annotation.mass.as_mut().expect("library assets weigh").mass_kg = 12.0;
        // the front, at +x, has a knob
        let model = boxes(&[[[-0.2, -0.5, 0.0], [0.2, 0.5, 1.0]], [[0.2, -0.1, 0.4], [0.3, 0.1, 0.6]]]);
        let bare = |b: &Body| Body { mass_kg: 0.0, collisions: Vec::new(), ..b.clone() };
        let model = Model3d { bodies: model.bodies.iter().map(bare).collect(), ..model };
        let placed = placed(model, &annotation);
        let [min, max] = placed.bounds().expect("it has triangles");
        let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
        assert!(near(min[1], -0.3) && near(max[1], 0.2) && near(min[0], -0.5) && near(max[0], 0.5), "{min:?} {max:?}");
        let mass: f64 = placed.bodies.iter().map(|b| b.mass_kg).sum();
        assert!(near(mass, 12.0), "{mass}");
        assert!(placed.bodies.iter().all(|b| !b.collisions.is_empty()));
        let knob = placed.bodies[0].collisions.iter().map(Collision::bounds).find(|[_, max]| max[1] < -0.15);
        assert!(knob.is_some_and(|[min, max]| max[2] - min[2] < 0.3), "the knob alone sticks out: {knob:?}");
    }
}
