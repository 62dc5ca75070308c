//! Model folders as other people's packages have them: Gazebo Fuel, those of AWS, Arena, and odd ones.

use std::path::{Path, PathBuf};

use d3dgen_assets::ingest::{Walk, walk};
use d3dgen_assets::readers::{ReadModel, Refusal, read};
use d3dgen_mesh::{Collision, JointKind};
use tempfile::TempDir;

/// Writes files into a folder of their own.
fn home(files: &[(&str, &str)]) -> TempDir {
    let home = tempfile::tempdir().expect("a folder");
    for (path, text) in files {
        let file = home.path().join(path);
        std::fs::create_dir_all(file.parent().expect("a folder")).expect("made");
        std::fs::write(file, text).expect("written");
    }
    home
}

/// Returns an OBJ of boxes, each an object of its name between two corners.
fn obj(boxes: &[(&str, [f64; 3], [f64; 3])]) -> String {
    let mut text = String::new();
    for (n, (name, min, max)) in boxes.iter().enumerate() {
        text += &format!("o {name}\n");
        for k in 0..8 {
            let at = |i: usize| if k >> i & 1 == 0 { min[i] } else { max[i] };
            text += &format!("v {} {} {}\n", at(0), at(1), at(2));
        }
        for quad in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            let corners: Vec<String> = quad.iter().map(|c| (n * 8 + c + 1).to_string()).collect();
            text += &format!("f {}\n", corners.join(" "));
        }
    }
    text
}

fn cuboid(size: [f64; 3]) -> String {
    let [x, y, z] = size;
    obj(&[("box", [-x / 2.0, -y / 2.0, 0.0], [x / 2.0, y / 2.0, z])])
}

fn model(name: &str, inside: &str) -> String {
    format!("<?xml version='1.0'?><sdf version='1.7'><model name='{name}'>{inside}</model></sdf>")
}

fn visual(pose: &str, geometry: &str) -> String {
    format!("<visual name='v'><pose>{pose}</pose><geometry>{geometry}</geometry></visual>")
}

fn mesh(uri: &str) -> String {
    format!("<mesh><uri>{uri}</uri></mesh>")
}

fn link(inside: &str) -> String {
    format!("<link name='link'>{inside}</link>")
}

fn seen(read: &Result<ReadModel, Refusal>) -> [f64; 3] {
    let model = &read.as_ref().unwrap_or_else(|r| panic!("{r}")).model;
    let [min, max] = model.bounds().expect("a box");
    std::array::from_fn(|i| ((max[i] - min[i]) * 1e6).round() / 1e6)
}

fn assets(folder: &Path) -> Vec<String> {
    let Walk { models, .. } = walk(folder).expect("walked");
    models.into_iter().map(|m| m.0).collect()
}

#[test]
fn folders_of_other_people_are_assets_of_what_they_show() {
    let part = |uri: &str| link(&visual("0 0 0 0 0 0", &mesh(uri)));
    let desk = cuboid([1.6, 0.8, 0.75]);
    let fuel = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Reading%20Desk/2/files/meshes/desk.obj";
    let files = [
        ("aws/models/desk_01/model.sdf", model("desk_01", &part("model://desk_01/meshes/desk.obj"))),
        (
            "aws/models/desk_01/model.config",
            "<model><name>Desk</name><sdf version='1.7'>model.sdf</sdf></model>".into(),
        ),
        ("fuel/reading desk/2/model.sdf", model("Reading Desk", &part(fuel))),
        ("arena/static/desk/sdf/desk.sdf", model("desk", &part("model://desk/sdf/meshes/desk.obj"))),
        ("beside/office/model.sdf", model("office", &part("model://desk_of_shop/meshes/desk.obj"))),
        ("file/desk/model.sdf", model("desk", &part("file://meshes/desk.obj"))),
        ("absolute/desk/model.sdf", model("desk", &part("file:///home/bob/ws/src/shop/models/desk/meshes/desk.obj"))),
        ("plain/desk/model.sdf", model("desk", &part("meshes/desk.obj"))),
        ("package/desk/model.sdf", model("desk", &part("package://desk/meshes/desk.obj"))),
        ("windows/desk/model.sdf", model("desk", &part(r"meshes\desk.obj"))),
        ("bom/desk/model.sdf", format!("\u{feff}{}", model("desk", &part("meshes/desk.obj")))),
    ];
    let meshes = [
        "aws/models/desk_01/meshes/desk.obj",
        "fuel/reading desk/2/meshes/desk.obj",
        "arena/static/desk/sdf/meshes/desk.obj",
        "beside/desk_of_shop/meshes/desk.obj",
        "file/desk/meshes/desk.obj",
        "absolute/desk/meshes/desk.obj",
        "plain/desk/meshes/desk.obj",
        "package/desk/meshes/desk.obj",
        "windows/desk/meshes/desk.obj",
        "bom/desk/meshes/desk.obj",
    ];
    let all: Vec<(&str, &str)> =
        files.iter().map(|(p, t)| (*p, t.as_str())).chain(meshes.iter().map(|m| (*m, desk.as_str()))).collect();
    let home = home(&all);
    let mut expected: Vec<String> = files.iter().map(|f| f.0.to_owned()).filter(|f| f.ends_with(".sdf")).collect();
    expected.sort();
    assert_eq!(assets(home.path()), expected);
    for path in expected {
        let read = read(&home.path().join(&path), None);
        assert_eq!(seen(&read), [1.6, 0.8, 0.75], "{path}");
    }
}

#[test]
fn models_in_models_stand_where_their_poses_say() {
    let chair = model("chair", &link(&visual("0 0 0.25 0 0 0", "<box><size>0.5 0.5 0.5</size></box>")));
    let set = model(
        "set",
        "<link name='table'><visual name='v'><pose>0 0 0.35 0 0 0</pose><geometry><box><size>1 1 0.7</size></box>\
         </geometry></visual></link>\
         <include><uri>model://chair</uri><name>east</name><pose>1.5 0 0 0 0 0</pose></include>\
         <include><uri>model://chair</uri><name>north</name><pose relative_to='table'>0 1.5 0 0 0 1.5707963</pose></include>\
         <model name='lamp'><pose>0 0 0.7 0 0 0</pose><link name='l'><visual name='v'><pose>0 0 0.2 0 0 0</pose>\
         <geometry><cylinder><radius>0.1</radius><length>0.4</length></cylinder></geometry></visual></link>\
         <joint name='stand' type='fixed'><parent>world</parent><child>l</child></joint></model>\
         <joint name='swivel' type='revolute'><parent>table</parent><child>lamp::l</child>\
         <axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>",
    );
    let home = home(&[("chair/model.sdf", &chair), ("set/model.sdf", &set)]);
    let read = read(&home.path().join("set/model.sdf"), Some(home.path()));
    assert_eq!(seen(&read), [2.25, 2.25, 1.1]);
    let model = read.expect("read").model;
    let joint = &model.joints[0];
    assert_eq!((joint.kind, &*model.bodies[joint.child].name), (JointKind::Revolute, "lamp__l"));
    assert!((joint.origin[2] - 0.7).abs() < 1e-9, "{:?}", joint.origin);
    assert_eq!(assets(home.path()), ["chair/model.sdf", "set/model.sdf"]);
    let circle = model_that_includes("a", "b");
    let other = model_that_includes("b", "a");
    let home = self::home(&[("a/model.sdf", &circle), ("b/model.sdf", &other)]);
    let refused = self::read(&home.path().join("a/model.sdf"), Some(home.path())).expect_err("a circle");
    assert!(refused.reason.contains("circle"), "{refused}");
    let missing = model_that_includes("a", "nowhere");
    let home = self::home(&[("a/model.sdf", &missing)]);
    let refused = self::read(&home.path().join("a/model.sdf"), Some(home.path())).expect_err("not there");
    assert!(refused.reason.contains("model://nowhere"), "{refused}");
}

fn model_that_includes(name: &str, other: &str) -> String {
    model(name, &format!("<include><uri>model://{other}</uri></include>"))
}

#[test]
fn parts_of_meshes_are_read_alone() {
    let set = obj(&[("seat", [5.0, 5.0, 0.0], [5.5, 5.4, 0.5]), ("back", [0.0, 0.0, 0.0], [2.0, 0.1, 1.0])]);
    let part = |name: &str, center: &str| {
        let text = format!(
            "<mesh><uri>meshes/set.obj</uri><submesh><name>{name}</name><center>{center}</center></submesh></mesh>"
        );
        model("chair", &link(&visual("0 0 1 0 0 0", &text)))
    };
    let files = [part("seat", "true"), part("back", "false"), part("leg", "false")];
    let home = home(&[
        ("a/model.sdf", &files[0]),
        ("a/meshes/set.obj", &set),
        ("b/model.sdf", &files[1]),
        ("b/meshes/set.obj", &set),
        ("c/model.sdf", &files[2]),
        ("c/meshes/set.obj", &set),
    ]);
    let seat = read(&home.path().join("a/model.sdf"), None);
    assert_eq!(seen(&seat), [0.5, 0.4, 0.5]);
    let [min, _] = seat.expect("read").model.bounds().expect("a box");
    assert!((min[0] + 0.25).abs() < 1e-6 && (min[2] - 0.75).abs() < 1e-6, "{min:?}");
    assert_eq!(seen(&read(&home.path().join("b/model.sdf"), None)), [2.0, 0.1, 1.0]);
    let refused = read(&home.path().join("c/model.sdf"), None).expect_err("no such part");
    assert!(refused.reason.contains("`leg`") && refused.reason.contains("back, seat"), "{refused}");
}

#[test]
fn what_collides_becomes_shapes_of_the_body() {
    let collision = |pose: &str, geometry: &str| {
        format!("<collision name='c'><pose>{pose}</pose><geometry>{geometry}</geometry></collision>")
    };
    let table = cuboid([1.0, 1.0, 0.7]);
    let shown = visual("0 0 0 0 0 0", &mesh("meshes/table.obj"));
    let bar = "<cylinder><radius>0.1</radius><length>1.0</length></cylinder>";
    let simple = link(&format!("{shown}{}", collision("0 0 0.35 0 0 0", "<box><size>1 1 0.7</size></box>")));
    let turned = link(&format!(
        "{shown}{}{}",
        collision("0 0 0.6 0 1.5707963 0", bar),
        collision("0 0 0.35 0 0 0.7853982", "<box><size>0.7 0.7 0.7</size></box>")
    ));
    let hull = link(&format!("{shown}{}", collision("0 0 0 0 0 0", &mesh("meshes/hull.stl.obj"))));
    let wrong = link(&format!("{shown}{}", collision("0 0 9 0 0 0", "<box><size>1 1 0.7</size></box>")));
    let clear = link(&format!(
        "{shown}<visual name='zone'><transparency>1</transparency><geometry><box><size>9 9 9</size></box></geometry></visual>"
    ));
    let texts: Vec<String> = [simple, turned, hull, wrong, clear].iter().map(|l| model("table", l)).collect();
    let mut files: Vec<(String, &str)> = Vec::new();
    for (i, text) in texts.iter().enumerate() {
        files.push((format!("{i}/model.sdf"), text));
        files.push((format!("{i}/meshes/table.obj"), &table));
        files.push((format!("{i}/meshes/hull.stl.obj"), &table));
    }
    let files: Vec<(&str, &str)> = files.iter().map(|(p, t)| (p.as_str(), *t)).collect();
    let home = home(&files);
    let shapes = |i: usize| {
        let read = read(&home.path().join(format!("{i}/model.sdf")), None);
        assert_eq!(seen(&read), [1.0, 1.0, 0.7]);
        read.expect("read").model.bodies[0].collisions.clone()
    };
    assert!(matches!(shapes(0)[..], [Collision::Box { .. }]), "{:?}", shapes(0));
    assert!(
        matches!(shapes(1)[..], [Collision::Cylinder { axis: 0, .. }, Collision::TurnedBox { .. }]),
        "{:?}",
        shapes(1)
    );
    assert!(matches!(shapes(2)[..], [Collision::Box { .. }]), "{:?}", shapes(2));
    assert_eq!((shapes(3), shapes(4)), (vec![], vec![]));
    assert_eq!(assets(home.path()).len(), 5, "a hull is no asset");
}

#[test]
fn old_and_static_models_have_their_joints_and_bodies() {
    let part = |name: &str, x: f64| {
        format!(
            "<link name='{name}'><pose>{x} 0 0 0 0 1.5707963</pose><inertial><mass>2</mass></inertial><visual name='v'>\
             <geometry><box><size>1 1 1</size></box></geometry></visual></link>"
        )
    };
    let door = "<joint name='hinge' type='revolute'><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz>\
                <limit><lower>0</lower><upper>1.5</upper></limit></axis></joint>";
    let old = model("old", &format!("{}{}{door}", part("a", 0.0), part("b", 1.0))).replace("'1.7'", "'1.4'");
    let new = model("new", &format!("{}{}{door}", part("a", 0.0), part("b", 1.0)));
    let still = model("still", &format!("<static>true</static>{}{}", part("a", 0.0), part("b", 1.0)));
    let home = home(&[("o/model.sdf", &old), ("n/model.sdf", &new), ("s/model.sdf", &still)]);
    let model = |name: &str| read(&home.path().join(name).join("model.sdf"), None).expect("read").model;
    let axis = |name: &str| model(name).joints[0].axis.map(|v| v.round());
    // Until version 1.4 an axis is one of the model, since then one of the joint.
    assert_eq!((axis("o"), axis("n")), ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
    let still = model("s");
    assert_eq!((still.bodies.len(), still.bodies[0].mass_kg, still.bodies[0].visuals.len()), (1, 4.0, 2));
}

fn cases() -> Option<PathBuf> {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/cases");
    cases.join("16_assets_collision_meshes").is_dir().then_some(cases)
}

#[test]
fn the_cases_of_models_give_what_is_expected() {
    let Some(cases) = cases() else {
        eprintln!("skipped: the cases are not here");
        return;
    };
    let folder = cases.join("16_assets_collision_meshes/a");
    let found = assets(&folder);
    let names = ["cabinet_two_parts", "cooking_bench", "side_table_boxes", "wardrobe_small", "washer"];
    assert_eq!(found, names.map(|n| format!("{n}/model.sdf")));
    assert_eq!(seen(&read(&folder.join(&found[2]), None)), [1.2, 0.6, 0.745]);
    assert_eq!(seen(&read(&folder.join(&found[0]), None)), [0.8, 0.4, 1.8]);
    let desk = cases.join("20_assets_inspect_arena_uri/static/office_desk/sdf/office_desk.sdf");
    assert_eq!(seen(&read(&desk, None)), [1.6, 0.8, 0.75]);
    assert_eq!(seen(&read(&desk, desk.parent().and_then(Path::parent))), [1.6, 0.8, 0.75]);
}
