//! Files that lie, and files that do not.

use super::*;
use crate::sample;
use crate::words;

fn bounds(size: [f64; 3], low: [f64; 3]) -> [[f64; 3]; 2] {
    [low, std::array::from_fn(|i| low[i] + size[i])]
}

fn standing(size: [f64; 3]) -> [[f64; 3]; 2] {
    bounds(size, [-size[0] / 2.0, -size[1] / 2.0, 0.0])
}

fn declared(format: &str, up: Option<char>, authored: bool) -> Declared {
    let (up_axis_authored, unit_authored) = (authored, authored);
    Declared { format: format.into(), up_axis: up, up_axis_authored, unit_authored, unit_beside: None, simulator: None }
}

#[track_caller]
fn check(name: &str, bounds: [[f64; 3]; 2], declared: &Declared, expected: [f64; 3]) {
    let verdict = judge(bounds, declared, &[words::split(name)], sample::catalog());
    let size: [f64; 3] = {
        let (a, b) = (verdict.turn.apply(bounds[0]), verdict.turn.apply(bounds[1]));
        std::array::from_fn(|i| (a[i] - b[i]).abs() * verdict.scale[i])
    };
    let close = size.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.002 + 0.005 * b);
    assert!(close, "{name}: {size:?} instead of {expected:?}: {:?}", verdict.changes);
    let changed = verdict.turn != Turn::None || verdict.scale != [1.0; 3];
    assert_eq!(changed, !verdict.changes.is_empty(), "{name}");
}

#[test]
fn lying_units_are_repaired() {
    let glb = declared("glb", Some('Y'), true);
    check("sofa", standing([0.022, 0.0095, 0.0088]), &glb, [2.2, 0.95, 0.88]);
    check("Car_01", standing([276.0, 120.0, 95.0]), &glb, [2.76, 1.2, 0.95]);
    check("office_chair", standing([620.0, 640.0, 1050.0]), &glb, [0.62, 0.64, 1.05]);
    check("Wardrobe", standing([47.0, 24.0, 82.0]), &declared("usdc", Some('Y'), true), [1.1938, 0.6096, 2.0828]);
    check("desk", standing([0.016, 0.008, 0.0074]), &declared("usda", Some('Y'), false), [1.6, 0.8, 0.74]);
    check("thing_without_name", standing([214.0, 109.0, 96.0]), &declared("obj", None, false), [2.14, 1.09, 0.96]);
}

#[test]
fn a_word_of_the_name_never_beats_a_unit_against_the_proportions() {
    let sdf = declared("sdf", Some('Z'), true);
    let glb = declared("glb", Some('Y'), true);
    for told in [&sdf, &glb] {
        check("washer", standing([0.035, 0.035, 0.002]), told, [0.035, 0.035, 0.002]);
        check("table_screw", standing([0.006, 0.006, 0.04]), told, [0.006, 0.006, 0.04]);
        check("door_stopper", standing([0.05, 0.05, 0.03]), told, [0.05, 0.05, 0.03]);
        check("lamp_socket", standing([0.03, 0.03, 0.05]), told, [0.03, 0.03, 0.05]);
        check("sink_plug", standing([0.045, 0.045, 0.02]), told, [0.045, 0.045, 0.02]);
    }
    // Where the proportions agree the unit is what lies, whatever else the name says.
    for told in [&sdf, &glb] {
        check("leather_sofa_03", standing([0.022, 0.0095, 0.0088]), told, [2.2, 0.95, 0.88]);
        check("sofa", standing([0.022, 0.0095, 0.0088]), told, [2.2, 0.95, 0.88]);
    }
    for (told, size) in [(&glb, [4.5, 3.75, 1.5]), (&sdf, [4.5, 3.75, 1.5]), (&glb, [5.05, 4.58, 3.23])] {
        let verdict = judge(standing(size), told, &[words::split("BathroomSink")], sample::catalog());
        assert!((0.05..0.3).contains(&verdict.scale[0]), "no sink is {size:?} m: {verdict:?}");
    }
}

#[test]
fn files_beside_tell_the_unit_where_nothing_else_does() {
    let glb = |unit| Declared { unit_beside: unit, ..declared("glb", Some('Y'), true) };
    check("gizmo", standing([0.4, 0.4, 0.4]), &glb(Some(0.01)), [0.004, 0.004, 0.004]);
    check("gizmo", standing([4.0, 4.0, 2.0]), &glb(Some(0.1)), [0.4, 0.4, 0.2]);
    check("gizmo", standing([4.0, 4.0, 2.0]), &glb(Some(1.0)), [4.0, 4.0, 2.0]);
    // What its own name and proportions say for sure is surer.
    check("sofa", standing([0.022, 0.0095, 0.0088]), &glb(Some(1.0)), [2.2, 0.95, 0.88]);
}

#[test]
fn lying_axes_are_repaired() {
    let dae = declared("dae", Some('Y'), true);
    let door = [[-0.708, -2.2696, 0.039], [0.708, 0.0002, 0.124]];
    check("elevator_01_door_visual", door, &dae, [1.416, 0.085, 2.2698]);
    let fridge = [[-0.3, -1.8, -0.33], [0.3, 0.0, 0.33]];
    check("fridge", fridge, &declared("usdc", Some('Y'), false), [0.6, 0.66, 1.8]);
    let fallen = [[-0.25, -0.9, -0.26], [0.25, 0.0, 0.26]];
    check("dining_chair", fallen, &declared("usdc", Some('Y'), true), [0.5, 0.52, 0.9]);
    let hung = [[-0.3, -0.04, -0.4], [0.3, 0.0, 0.4]];
    check("mirror", hung, &declared("usdc", Some('Y'), true), [0.6, 0.04, 0.8]);
    let lying = [[-0.3, -0.33, 0.0], [0.3, 0.33, 1.8]];
    let y_up_obj: [[f64; 3]; 2] = [[-0.3, 0.0, -0.33], [0.3, 1.8, 0.33]];
    check("fridge", y_up_obj, &declared("obj", None, false), [0.6, 0.66, 1.8]);
    check("fridge", lying, &declared("obj", None, false), [0.6, 0.66, 1.8]);
}

#[test]
fn the_simulator_around_a_mesh_is_believed() {
    let scaled = Simulator { scale: Some([0.00817; 3]) };
    let obj = Declared { simulator: Some(scaled), ..declared("obj", None, false) };
    check("IVStand", standing([53.6594, 54.5373, 172.9406]), &obj, [0.4384, 0.4456, 1.4129]);
    let shown = Declared { simulator: Some(Simulator { scale: None }), ..declared("dae", Some('Y'), true) };
    check("ramp_visual", [[-1.2, -0.175, -1.2], [1.2, 0.0, 1.2]], &shown, [2.4, 2.4, 0.175]);
    let desk = Declared { simulator: Some(Simulator { scale: Some([1.0; 3]) }), ..declared("obj", None, false) };
    check("Desk", standing([0.49, 0.84, 0.55]), &desk, [0.49, 0.84, 0.55]);
}

#[test]
fn files_that_are_right_stay_as_they_are() {
    let glb = declared("glb", Some('Y'), true);
    for (name, size) in [
        ("office_desk", [1.4, 0.818, 0.72]),
        ("basemesh_coffee_table_02", [0.55, 0.5, 0.4]),
        ("library_stool", [0.41, 0.41, 0.37]),
        ("kitchenFridge", [0.99, 0.67, 2.11]),
        ("desk", [0.49, 0.84, 0.55]),
        ("organizer_drawers_01", [0.26, 0.35, 0.49]),
        ("keyboard", [0.52, 0.19, 0.027]),
        ("television_modern", [1.85, 0.58, 1.75]),
        ("rug_round", [1.1, 1.1, 0.01]),
        ("nurses_station", [7.0, 4.84, 3.02]),
        ("plant_small", [0.25, 0.25, 0.37]),
        ("juice_box", [0.09, 0.073, 0.166]),
        ("Teapot", [0.3, 0.49, 0.23]),
        ("all_primitives", [0.095, 0.02, 0.02]),
    ] {
        check(name, standing(size), &glb, size);
    }
    let pivot = bounds([0.53, 0.3, 0.9], [-0.26, -0.05, 1.19]);
    check("bathroomCabinet", pivot, &glb, [0.53, 0.3, 0.9]);
    let centered = bounds([1.4, 0.4, 2.04], [-0.7, -0.2, -1.02]);
    check("bookshelf_modern", centered, &declared("usdz", Some('Y'), true), [1.4, 0.4, 2.04]);
}

#[test]
fn what_is_not_to_scale_becomes_as_large_as_its_kind() {
    let glb = declared("gltf", Some('Y'), true);
    let verdict = judge(standing([3.1, 3.0, 1.0]), &glb, &[words::split("bed_double_A")], sample::catalog());
    assert_eq!(verdict.turn, Turn::None);
    assert!((0.5..0.75).contains(&verdict.scale[0]), "{verdict:?}");
    assert_eq!(verdict.changes[0].what, "unit");
}
