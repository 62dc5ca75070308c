//! Every object of every shipped domain, at every size it comes in, has a sound model by its own build.

#![allow(clippy::unwrap_used)] // helpers of tests are tests

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_mesh::builds::MOST_TRIANGLES;
use d3dgen_mesh::{Library, Mesh, Model3d, generate_by};
use d3dgen_model::domain::{ObjectType, Shape};
use d3dgen_plugins::{Plugin, Registry};

/// Thinner things are plates.
const FLAT_M: f64 = 0.12;

/// A domain's objects, with the shipped builds and its own.
struct Stock {
    domain: String,
    library: Library,
    objects: Vec<ObjectType>,
}

fn stocks() -> Vec<Stock> {
    let of = |p: &dyn Plugin| Stock {
        domain: p.id().to_owned(),
        library: Library::shipped().with(&p.domain().builds),
        objects: p.domain().objects.clone(),
    };
    Registry::builtin().iter().map(of).collect()
}

fn open_edges(mesh: &Mesh) -> usize {
    let key = |i: u32| mesh.positions[i as usize].map(|v| (v + 0.0).to_bits());
    let mut edges: BTreeMap<([u32; 3], [u32; 3]), i32> = BTreeMap::new();
    for t in &mesh.triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            *edges.entry((key(a), key(b))).or_default() += 1;
            *edges.entry((key(b), key(a))).or_default() -= 1;
        }
    }
    edges.values().filter(|count| **count != 0).count()
}

/// Returns what is wrong with a model of this size.
fn problems(model: &Model3d, size: [f64; 3]) -> Vec<String> {
    let mut found = Vec::new();
    if model.triangle_count() > MOST_TRIANGLES {
        found.push(format!("{} triangles", model.triangle_count()));
    }
    let [min, max] = model.bounds().unwrap();
    for k in 0..3 {
        let low = if k == 2 { 0.0 } else { -size[k] / 2.0 };
        if (min[k] - low).abs() > 1e-6 * size[k] || (max[k] - low - size[k]).abs() > 1e-6 * size[k] {
            found.push(format!("spans {} to {} on axis {k} of {size:?}", min[k], max[k]));
        }
    }
    for body in &model.bodies {
        if body.mass_kg <= 0.0 || body.mass_kg > 20_000.0 {
            found.push(format!("{} weighs {} kg", body.name, body.mass_kg));
        }
        if body.collisions.len() > 24 {
            found.push(format!("{} has {} collision shapes", body.name, body.collisions.len()));
        }
        for visual in &body.visuals {
            let mesh = &visual.mesh;
            if open_edges(mesh) > 0 {
                found.push(format!("{}/{} is not closed", body.name, visual.name));
            }
            if mesh.normals.len() != mesh.positions.len() || mesh.uvs.len() != mesh.positions.len() {
                found.push(format!("{}/{} lacks normals or texture coordinates", body.name, visual.name));
            }
        }
    }
    if model.bodies[0].collisions.is_empty() {
        found.push("its base does not collide".to_owned());
    }
    for joint in &model.joints {
        let reach = (0..3).map(|k| (joint.origin[k].abs() - size[k]).max(0.0)).fold(0.0, f64::max);
        let length: f64 = joint.axis.iter().map(|v| v * v).sum();
        if (length - 1.0).abs() > 1e-9 || reach > 0.5 || joint.limits.is_some_and(|[a, b]| a > b) {
            found.push(format!("{} is no joint of it: {joint:?}", joint.name));
        }
    }
    found
}

#[test]
fn every_shipped_object_has_a_sound_model_at_every_size() {
    let (mut wrong, mut triangles, mut seen) = (Vec::new(), Vec::new(), BTreeSet::new());
    let stocks = stocks();
    for (Stock { domain, library, .. }, object) in stocks.iter().flat_map(|s| s.objects.iter().map(move |o| (s, o))) {
        for size in &object.sizes_m {
            let made = library.of(object).and_then(|build| generate_by(build, object, *size, 0));
            match made {
                Err(error) => wrong.push(format!("{domain}/{}: {error}", object.id)),
                Ok(model) => {
                    triangles.push(model.triangle_count());
                    wrong.extend(
                        problems(&model, *size).iter().map(|p| format!("{domain}/{} {size:?}: {p}", object.id)),
                    );
                }
            }
        }
        seen.insert(format!("{domain}/{}", object.id));
    }
    triangles.sort_unstable();
    println!(
        "{} objects, {} models, triangles: median {}, most {}",
        seen.len(),
        triangles.len(),
        triangles[triangles.len() / 2],
        triangles[triangles.len() - 1]
    );
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(seen.len() > 259);
}

#[test]
fn variants_of_the_shipped_objects_are_sound_too() {
    let mut wrong = Vec::new();
    let stocks = stocks();
    for (Stock { domain, library, .. }, object) in stocks.iter().flat_map(|s| s.objects.iter().map(move |o| (s, o))) {
        let Ok(build) = library.of(object) else { continue };
        if build.choices.is_empty() {
            continue;
        }
        for seed in 1..6 {
            match generate_by(build, object, object.sizes_m[0], seed) {
                Err(error) => wrong.push(format!("{domain}/{} seed {seed}: {error}", object.id)),
                Ok(model) => {
                    let found = problems(&model, object.sizes_m[0]);
                    wrong.extend(found.iter().map(|p| format!("{domain}/{} seed {seed}: {p}", object.id)));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_shape_has_a_build_that_holds_at_all_sizes_of_its_objects() {
    let library = Library::shipped();
    let missing: Vec<&str> = Shape::all().map(Shape::name).filter(|name| library.get(name).is_none()).collect();
    assert!(missing.is_empty(), "no builds are called {missing:?}");
    let mut wrong = Vec::new();
    let stocks = stocks();
    for (Stock { domain, .. }, object) in stocks.iter().flat_map(|s| s.objects.iter().map(move |o| (s, o))) {
        let build = library.get(object.shape.name()).unwrap();
        // Things as flat as a shelf board are made by their own builds, and by a box where they have none.
        for size in object.sizes_m.iter().filter(|s| s.iter().all(|v| *v > FLAT_M)) {
            let found = match generate_by(build, object, *size, 0) {
                Err(error) => vec![error.to_string()],
                Ok(model) => problems(&model, *size),
            };
            wrong.extend(found.iter().map(|p| format!("{} as {domain}/{} {size:?}: {p}", build.id, object.id)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
