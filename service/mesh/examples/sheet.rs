//! A contact sheet of the builds on disk: `cargo run -p d3dgen-mesh --example sheet -- [OPTION]... OUT.png`
//!
//! For authors of `domains/builds/*.toml`: reads builds and objects from disk, so that no rebuild is needed.
//!
//! ```text
//! --only ID,ID     objects or builds with one of these ids
//! --domain NAME    objects of this domain
//! --shapes         every shape at a usual size instead of objects
//! --px N           side of a picture (160)
//! --columns N      pictures in a row (10)
//! --seed N         seed of the variants (0)
//! --right N        turn of the eye to the right, degrees (33)
//! --all-sizes      every size of an object, not only its first
//! --pose SHARE     joints at this share of their range (0 to 1; ones without limits turn by it): doors open
//! ```
//! Prints one line an object: id, build, size, triangles, bodies, mass; errors with their place.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use d3dgen_mesh::picture::{self, View};
use d3dgen_mesh::{JointKind, Library, Model3d, generate};
use d3dgen_model::domain::{Build, ObjectType, Shape};
use serde_json::{Map, Value};

fn main() {
    let mut options: BTreeMap<String, String> = BTreeMap::new();
    let mut out = None;
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.strip_prefix("--") {
            Some("shapes" | "all-sizes") => drop(options.insert(argument[2..].to_owned(), String::new())),
            Some(name) => drop(options.insert(name.to_owned(), arguments.next().unwrap_or_default())),
            None => out = Some(argument),
        }
    }
    let Some(out) = out else {
        eprintln!(
            "usage: sheet [--only ID,ID] [--domain NAME] [--shapes] [--all-sizes] [--px N] [--columns N] OUT.png"
        );
        std::process::exit(2);
    };
    let number = |name: &str, other: f64| options.get(name).and_then(|v| v.parse().ok()).unwrap_or(other);
    let domains = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../domains");
    let builds = builds(&domains.join("builds"));
    let problems = Library::problems(&builds);
    for problem in &problems {
        let index = problem.path.split('/').nth(2).and_then(|i| i.parse::<usize>().ok());
        let id = index.and_then(|i| builds.get(i)).map_or("", |b| b.id.as_str());
        eprintln!("problem in {id}: {problem}");
    }
    let library = Library::default().with(&builds);
    let mut objects: Vec<ObjectType> =
        if options.contains_key("shapes") { shapes() } else { objects(&domains, options.get("domain")) };
    if let Some(only) = options.get("only") {
        let wanted: Vec<&str> = only.split(',').collect();
        objects.retain(|o| {
            wanted.contains(&o.id.as_str()) || library.of(o).is_ok_and(|b| wanted.contains(&b.id.as_str()))
        });
    }
    let px = number("px", 160.0) as usize;
    let view = View { right_deg: number("right", 33.0), ..View::default() };
    let (mut tiles, mut failed) = (Vec::new(), 0);
    for object in &objects {
        let sizes = if options.contains_key("all-sizes") { &object.sizes_m[..] } else { &object.sizes_m[..1] };
        for size in sizes {
            match generate(&library, object, *size, number("seed", 0.0) as u64) {
                Ok(mut model) => {
                    if let Some(share) = options.get("pose").and_then(|v| v.parse().ok()) {
                        pose(&mut model, share);
                    }
                    let build = library.of(object).map_or("", |b| b.id.as_str());
                    let mass: f64 = model.bodies.iter().map(|b| b.mass_kg).sum();
                    println!(
                        "{:>4} {:<28} {build:<22} {size:?} {} triangles, {} bodies, {mass:.1} kg",
                        tiles.len(),
                        object.id,
                        model.triangle_count(),
                        model.bodies.len(),
                    );
                    tiles.push(picture::render(&model, px, &view));
                }
                Err(error) => {
                    failed += 1;
                    println!("     {:<28} {error}", object.id);
                }
            }
        }
    }
    let bytes = picture::sheet(&tiles, number("columns", 10.0) as usize, 6).png().expect("a sheet is a picture");
    std::fs::write(&out, bytes).unwrap_or_else(|e| panic!("{out}: {e}"));
    println!("{} pictures in {out}, {failed} failed, {} problems", tiles.len(), problems.len());
}

/// Moves every body to a share of the range of its joint.
fn pose(model: &mut Model3d, share: f64) {
    // A joint stands after the one that moves its parent: from the last on, each moves its child with all it carries.
    for j in (0..model.joints.len()).rev() {
        let joint = model.joints[j].clone();
        let [low, high] = joint.limits.unwrap_or([0.0, 1.0]);
        let value = low + share * (high - low);
        let mut carried = vec![joint.child];
        for next in &model.joints[j + 1..] {
            if carried.contains(&next.parent) {
                carried.push(next.child);
            }
        }
        for body in carried {
            for visual in &mut model.bodies[body].visuals {
                for p in &mut visual.mesh.positions {
                    let from: [f64; 3] = std::array::from_fn(|k| f64::from(p[k]) - joint.origin[k]);
                    let to = match joint.kind {
                        JointKind::Prismatic => std::array::from_fn(|k| from[k] + value * joint.axis[k]),
                        _ => turned(from, joint.axis, value),
                    };
                    *p = std::array::from_fn(|k| (to[k] + joint.origin[k]) as f32);
                }
                for n in &mut visual.mesh.normals {
                    if joint.kind != JointKind::Prismatic {
                        *n = turned(n.map(f64::from), joint.axis, value).map(|v| v as f32);
                    }
                }
            }
        }
    }
}

/// Returns a vector turned about a unit axis.
fn turned(v: [f64; 3], axis: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    let dot: f64 = (0..3).map(|k| v[k] * axis[k]).sum();
    let cross = |k: usize| axis[(k + 1) % 3] * v[(k + 2) % 3] - axis[(k + 2) % 3] * v[(k + 1) % 3];
    std::array::from_fn(|k| v[k] * cos + cross(k) * sin + axis[k] * dot * (1.0 - cos))
}

/// Returns the lists called `key` of every TOML file of a folder whose name begins with `prefix`.
fn lists(folder: &Path, prefix: &str, key: &str) -> Vec<Value> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
    files.retain(|f| {
        f.extension().is_some_and(|x| x == "toml")
            && f.file_name().is_some_and(|n| n.to_string_lossy().starts_with(prefix))
    });
    files.sort();
    let mut list = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        match toml::from_str::<Map<String, Value>>(&text) {
            Ok(mut table) => match table.remove(key) {
                Some(Value::Array(items)) => list.extend(items),
                _ => eprintln!("{} has no [[{key}]]", file.display()),
            },
            Err(error) => {
                eprintln!("{}: {error}", file.display());
                std::process::exit(1);
            }
        }
    }
    list
}

fn builds(folder: &Path) -> Vec<Build> {
    let read = |value: Value| {
        let id = value["id"].as_str().unwrap_or("?").to_owned();
        serde_json::from_value(value).map_err(|e| eprintln!("build {id}: {e}")).ok()
    };
    lists(folder, "", "builds").into_iter().filter_map(read).collect()
}

/// Returns the objects of the domains, each id once.
fn objects(domains: &Path, only: Option<&String>) -> Vec<ObjectType> {
    let mut folders: Vec<PathBuf> =
        std::fs::read_dir(domains).expect("domains is there").flatten().map(|e| e.path()).collect();
    folders.retain(|f| only.is_none_or(|d| f.file_name().is_some_and(|n| n == d.as_str())));
    folders.sort();
    let mut seen = std::collections::BTreeSet::new();
    let all = folders.iter().filter(|f| f.join("domain.toml").is_file()).flat_map(|f| lists(f, "objects", "objects"));
    let read = |value: Value| serde_json::from_value::<ObjectType>(value).map_err(|e| eprintln!("object: {e}")).ok();
    all.filter_map(read).filter(|o| seen.insert(o.id.clone())).collect()
}

/// Returns one plain object of each shape.
fn shapes() -> Vec<ObjectType> {
    Shape::all()
        .map(|shape| {
            let text = format!(
                r##"{{"id": "any_{0}", "label": "{0}", "sizes_m": [[0.8, 0.6, 0.9]], "mount": "floor", "shape": "{0}",
                "color": "#a88a62", "material": "wood"}}"##,
                shape.name()
            );
            serde_json::from_str(&text).expect("an object of each shape")
        })
        .collect()
}
