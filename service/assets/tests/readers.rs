//! Small models with known figures; those of USD, glTF, OBJ and COLLADA were also found by the tools of others
//! (`usd-core`, `pycollada`, `trimesh`), but for what these leave out.

mod packages;
mod packing;

use std::path::{Path, PathBuf};

use d3dgen_assets::readers::{Bounds, Facts, Feature, ReadModel, Refusal, all, read};
use d3dgen_mesh::JointKind;

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models")
}

fn model(name: &str) -> ReadModel {
    read(&models().join(name), None).unwrap_or_else(|r| panic!("{name}: {r}"))
}

fn near(found: Option<Bounds>, expected: Bounds) {
    let found = found.expect("a box");
    let off = found.iter().flatten().zip(expected.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-5, "{found:?} is not {expected:?}");
}

fn count(facts: &Facts, name: &str) -> u64 {
    match facts.features.get(name) {
        Some(Feature::Count(count)) => *count,
        other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn usd_composes_turns_and_counts() {
    let ReadModel { model, facts, .. } = model("chair.usda");
    assert_eq!((facts.up_axis.as_deref(), facts.meters_per_unit), (Some("Y"), Some(0.01)));
    assert_eq!((facts.mesh_count, facts.triangle_count), (1, 12));
    // As USD counts: the prototype of the instancer where it stands, and the guide not at all.
    near(facts.bbox_zup, [[0.09, -0.01, -0.2], [0.6, 0.4, 0.45]]);
    assert_eq!(facts.material_names, ["Seat"]);
    assert_eq!(facts.diffuse_colors, [[1.0, 0.0, 0.0]]);
    assert_eq!(facts.textures[0].path.as_deref(), Some("./cloth.png"));
    assert!(!facts.textures[0].resolves);
    assert_eq!(
        (count(&facts, "inherits"), count(&facts, "point_instancers"), count(&facts, "geom_subsets")),
        (1, 1, 1)
    );
    // The model has the three studs where the instancer puts them, and the cushion's own material.
    near(model.bounds(), [[0.1, 0.0, -0.2], [0.6, 0.4, 0.46]]);
    let visuals = &model.bodies[0].visuals;
    assert_eq!(visuals.len(), 6);
    let worn: Vec<&str> = visuals.iter().filter_map(|v| v.material).map(|m| model.materials[m].name.as_str()).collect();
    assert_eq!(worn, ["Cushion", "Seat"]);
    assert_eq!(visuals[0].mesh.uvs.len(), visuals[0].mesh.positions.len());
}

#[test]
fn usd_follows_sublayers_references_payloads_instances_and_time() {
    let ReadModel { model, facts, .. } = model("rig.usda");
    near(facts.bbox_stage, [[-0.5, -0.3, -0.01], [2.5, 0.3, 0.01]]);
    near(model.bounds(), [[-0.5, -0.3, -0.01], [2.5, 0.3, 0.01]]);
    assert_eq!((facts.mesh_count, model.triangle_count()), (0, 36));
    let counts = ["references", "payloads", "instances", "animated_xforms"].map(|n| count(&facts, n));
    assert_eq!(counts, [1, 1, 1, 3]);
}

#[test]
fn gltf_has_sparse_normalized_and_strips() {
    let ReadModel { model, facts, .. } = model("chair.gltf");
    near(facts.bbox_zup, [[0.4, 0.0, 0.0], [1.1, 0.5, 2.1]]);
    near(model.bounds(), [[0.4, 0.0, 0.0], [1.1, 0.5, 2.1]]);
    assert_eq!((facts.mesh_count, facts.triangle_count, model.triangle_count()), (2, 5, 5));
    assert_eq!(facts.material_names, ["#1", "oak"]);
    assert_eq!(facts.diffuse_colors, [[0.6, 0.4, 0.2], [1.0, 1.0, 1.0]]);
    assert_eq!(facts.textures[0].path.as_deref(), Some("oak%20board.png"));
    assert_eq!(model.textures.len(), 1);
}

#[test]
fn obj_counts_what_faces_use() {
    let ReadModel { model, facts, companions } = model("table.obj");
    let names: Vec<_> = companions.iter().filter_map(|f| f.file_name()).collect();
    assert_eq!(names, ["table.mtl"]);
    assert_eq!((facts.up_axis, facts.meters_per_unit, facts.bbox_zup), (None, None, None));
    near(facts.bbox_stage, [[0.0; 3], [1.2, 0.6, 0.7]]);
    assert_eq!((facts.mesh_count, facts.triangle_count), (2, 3));
    assert_eq!(facts.material_names, ["wood", "steel"]);
    assert_eq!(facts.diffuse_colors, [[0.6, 0.4, 0.2], [0.5, 0.5, 0.5]]);
    assert_eq!(facts.textures[0].path.as_deref(), Some("textures\\wood.png"));
    assert_eq!(model.bodies[0].visuals.len(), 2);
    assert_eq!(model.materials[1].opacity, 0.5);
}

#[test]
fn dae_has_units_instances_and_bound_materials() {
    let ReadModel { model, facts, .. } = model("lamp.dae");
    near(facts.bbox_stage, [[0.0, 0.0, -0.2], [0.0, 0.8, 0.0]]);
    assert_eq!((facts.mesh_count, facts.triangle_count, model.triangle_count()), (2, 10, 10));
    assert_eq!(facts.material_names, ["brass", "shade"]);
    assert_eq!(facts.diffuse_colors, [[0.8, 0.6, 0.2]]);
    let shade = model.materials.iter().find(|m| m.name == "shade").expect("a shade");
    assert_eq!(shade.texture.map(|t| model.textures[t].path.as_str()), Some("shade.png"));
}

#[test]
fn stl_text_and_binary_are_one() {
    let text = model("wedge.stl");
    near(text.facts.bbox_stage, [[0.0; 3], [2.0, 1.0, 0.5]]);
    assert_eq!((text.facts.triangle_count, text.model.bodies[0].visuals[0].mesh.positions.len()), (2, 4));
    let mut bytes = vec![0u8; 80];
    bytes[..5].copy_from_slice(b"solid");
    bytes.extend(2u32.to_le_bytes());
    for triangle in [[[0f32; 3], [0., 1., 0.], [2., 0., 0.]], [[0.; 3], [2., 0., 0.], [0., 0., 0.5]]] {
        bytes.extend([0u8; 12]);
        triangle.iter().flatten().for_each(|v| bytes.extend(v.to_le_bytes()));
        bytes.extend([0u8; 2]);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wedge.stl");
    std::fs::write(&path, &bytes).unwrap();
    let binary = read(&path, None).unwrap();
    assert_eq!(binary.model.bodies[0].visuals[0].mesh, text.model.bodies[0].visuals[0].mesh);
    std::fs::write(&path, &bytes[..100]).unwrap();
    assert!(read(&path, None).unwrap_err().reason.contains("cut off"));
}

#[test]
fn sdf_has_links_poses_scales_and_joints() {
    let ReadModel { model, facts, .. } = model("cart/model.sdf");
    // The deck is 1 x 0.5 x 1 m from 0.2 m up, the handle lies along y at 0.7 m, the knob is fixed to the drawer.
    near(model.bounds(), [[-0.02, -0.3, 0.05], [1.0, 0.5, 1.2]]);
    assert_eq!(facts.mesh_count, 4);
    let names: Vec<&str> = model.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["body", "drawer"]);
    assert_eq!((model.bodies[0].mass_kg, model.bodies[1].visuals.len()), (12.5, 2));
    let joint = &model.joints[0];
    assert_eq!((joint.kind, joint.parent, joint.child, joint.limits), (JointKind::Prismatic, 0, 1, Some([0.0, 0.4])));
    assert_eq!(joint.origin, [0.1, 0.0, 0.2]);
    assert_eq!(joint.axis, [1.0, 0.0, 0.0]);
}

#[test]
fn packages_hold_their_files_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chair.usdz");
    let chair = std::fs::read(models().join("chair.usda")).unwrap();
    let result = |files: &[(&str, &[u8])]| {
        std::fs::write(&path, packing::zip(files)).unwrap();
        read(&path, None)
    };
    let picture: &[u8] = b"\x89PNG\r\n\x1a\n and so on";
    let whole = result(&[("chair.usda", &chair), ("cloth.png", picture)]).unwrap();
    assert_eq!((whole.facts.format.as_str(), whole.facts.triangle_count), ("usdz", 12));
    assert!(whole.facts.textures[0].resolves);
    assert_eq!(whole.model.textures[0].bytes.as_deref(), Some(picture));
    // A package in a package, and a layer beside the root.
    let inner = packing::zip(&[("shelf.usda", &std::fs::read(models().join("shelf.usda")).unwrap())]);
    let root = b"#usda 1.0\n(upAxis = \"Z\"\nmetersPerUnit = 1)\ndef \"R\" (references = @./parts/inner.usdz@) {}\n";
    let nested = result(&[("root.usda", root), ("parts/inner.usdz", &inner)]).unwrap();
    near(nested.facts.bbox_zup, [[-0.5, -0.15, -0.01], [0.5, 0.15, 0.01]]);
    for (files, reason) in [
        (&[("a.png", picture), ("chair.usda", &chair)][..], "no USD layer"),
        (&[("chair.usda", &chair), ("../evil.png", picture)], "leads out of it"),
        (&[("chair.usda", &chair), ("/tmp/evil.png", picture)], "leads out of it"),
        (&[], "empty"),
    ] {
        let refusal = result(files).unwrap_err();
        assert!(refusal.reason.contains(reason), "{refusal}");
    }
    let mut cut = packing::zip(&[("chair.usda", &chair)]);
    cut.truncate(cut.len() / 2);
    std::fs::write(&path, cut).unwrap();
    assert!(read(&path, None).unwrap_err().reason.contains("cut off"));
}

#[test]
fn a_name_that_lies_is_refused_with_what_the_file_is() {
    let folder = tempfile::tempdir().unwrap();
    let cases: &[(&str, &[u8], &str)] = &[
        ("a.glb", b"PK\x03\x04 and more", "ZIP archive"),
        ("a.usdz", b"<!DOCTYPE html><html></html>", "web page"),
        ("a.usdz", b"version https://git-lfs.github.com/spec/v1\n", "Git LFS"),
        ("a.usdz", b"", "0 bytes"),
        ("a.usda", b"def \"x\" {}", "does not begin"),
        ("a.obj", b"# nothing\n", "no geometry"),
        ("a.txt", b"hello", "no known format"),
        ("a.glb", b"#usda 1.0\n", "is usd inside"),
    ];
    for (name, bytes, reason) in cases {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let refusal = read(&path, None).unwrap_err();
        assert!(refusal.reason.contains(reason), "{name}: {refusal}");
    }
    assert!(read(&folder.path().join("gone.usda"), None).is_err());
    assert_eq!(read(folder.path(), None).map_err(|r: Refusal| r.reason.contains("folder")), Err(true));
}

#[cfg(unix)]
#[test]
fn nothing_outside_of_the_folder_is_read() {
    let top = tempfile::tempdir().unwrap();
    let folder = top.path().join("in");
    std::fs::create_dir(&folder).unwrap();
    std::fs::copy(models().join("shelf.usda"), top.path().join("shelf.usda")).unwrap();
    std::fs::copy(models().join("wedge.stl"), top.path().join("wedge.stl")).unwrap();
    std::os::unix::fs::symlink(top.path().join("wedge.stl"), folder.join("link.stl")).unwrap();
    let refusal = read(&folder.join("link.stl"), Some(&folder)).unwrap_err();
    assert!(refusal.reason.contains("link"), "{refusal}");
    let layer = "#usda 1.0\ndef \"R\" (references = @../shelf.usda@) { def Cube \"c\" { double size = 2 } }\n";
    std::fs::write(folder.join("up.usda"), layer).unwrap();
    let within = read(&folder.join("up.usda"), Some(top.path())).unwrap();
    let without = read(&folder.join("up.usda"), Some(&folder)).unwrap();
    assert!(within.model.triangle_count() > without.model.triangle_count());
    assert!(!without.facts.warnings.is_empty());
}

#[test]
fn every_reader_is_listed_once_and_has_endings_of_its_own() {
    let mut endings: Vec<&str> = all().iter().flat_map(|r| r.endings()).copied().collect();
    let count = endings.len();
    endings.sort_unstable();
    endings.dedup();
    assert_eq!(endings.len(), count);
}
