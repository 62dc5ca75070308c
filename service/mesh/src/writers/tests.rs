use super::*;
use crate::model3d::{Body, Collision, Joint, JointKind, Material, Mesh, Texture, Visual};

/// A box with a door: every kind of collision shape, a joint, a texture.
fn model() -> Model3d {
    let square = |y: f32| Mesh {
        positions: vec![[0.0, y, 0.0], [1.0, y, 0.0], [1.0, y, 1.0], [0.0, y, 1.0]],
        normals: vec![[0.0, -1.0, 0.0]; 4],
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let (sin, cos) = 0.5_f64.sin_cos();
    let body = |name: &str, y: f32, material, collisions| Body {
        name: name.into(),
        visuals: vec![Visual { name: "front".into(), mesh: square(y), material: Some(material) }],
        collisions,
        mass_kg: 2.5,
    };
    Model3d {
        name: "Cupboard_1".into(),
        bodies: vec![
            body(
                "base",
                0.5,
                0,
                vec![
                    Collision::Box { min: [0.0, 0.4, 0.0], max: [1.0, 0.5, 1.0] },
                    Collision::Sphere { center: [0.5; 3], radius: 0.1 },
                    Collision::TurnedBox {
                        center: [0.5; 3],
                        half: [0.3, 0.2, 0.1],
                        axes: [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]],
                    },
                ],
            ),
            body(
                "door",
                0.0,
                1,
                vec![Collision::Cylinder { center: [0.5, 0.0, 0.5], radius: 0.1, length: 1.0, axis: 1 }],
            ),
        ],
        joints: vec![Joint {
            name: "door_joint".into(),
            kind: JointKind::Revolute,
            parent: 0,
            child: 1,
            origin: [0.0, 0.1, 0.5],
            axis: [0.0, 0.0, -1.0],
            limits: Some([0.0, std::f64::consts::FRAC_PI_2]),
        }],
        materials: vec![
            Material { name: "Main".into(), opacity: 0.5, ..Material::default() },
            Material { name: "Main".into(), texture: Some(0), emissive: [0.1, 0.0, 0.0], ..Material::default() },
        ],
        textures: vec![Texture { path: "a.png".into(), bytes: Some(b"\x89PNG rest".to_vec()) }],
    }
}

#[test]
fn usd_holds_units_bodies_joints_and_masses() {
    let text = usda(&model()).unwrap();
    for line in [
        "    metersPerUnit = 1\n",
        "    upAxis = \"Z\"\n",
        "    defaultPrim = \"Cupboard_1\"\n",
        "def Material \"Main_2\"",
        "def PhysicsRevoluteJoint \"door_joint\"",
        "float physics:upperLimit = 90\n",
        "float physics:mass = 2.5\n",
        "asset inputs:file = @texture_0.png@",
        "texCoord2f[] primvars:st = [(0,0),(1,0),(1,1),(0,1)]",
        "rel physics:body0 = </Cupboard_1>\n",
    ] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
    assert_eq!(text.matches("\"PhysicsCollisionAPI\"").count(), 4);
    assert_eq!(text.matches('{').count(), text.matches('}').count());
}

#[test]
fn glb_is_a_container_whose_bodies_hang_at_their_joints() {
    let bytes = glb(&model()).unwrap();
    let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let root: serde_json::Value = serde_json::from_slice(&bytes[20..20 + word(12)]).unwrap();
    assert_eq!(root["nodes"][0]["children"], serde_json::json!([1]));
    assert_eq!(root["nodes"][1]["children"], serde_json::json!([2]));
    assert_eq!(root["nodes"][2]["translation"], serde_json::json!([0.0, 0.5, -0.1]));
    assert_eq!(root["nodes"][2]["extras"]["joint"]["axis"], serde_json::json!([0.0, -1.0, 0.0]));
    let positions =
        &root["accessors"][root["meshes"][1]["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap() as usize];
    assert_eq!(positions["max"][1].as_f64(), Some(0.5), "counted from the hinge, z up is y up");
    assert_eq!(root["images"][0]["mimeType"], "image/png");
    assert_eq!(root["materials"][0]["alphaMode"], "BLEND");
}

#[test]
fn sdf_comes_with_its_meshes_and_materials() {
    let files = sdf(&model()).unwrap();
    let names: Vec<&str> = files.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["Cupboard_1.mtl", "Cupboard_1.sdf", "base.obj", "door.obj", "texture_0.png"]);
    let text = |i: usize| String::from_utf8(files[i].bytes.clone()).unwrap();
    for line in [
        "<static>false</static>",
        "<joint name=\"door_joint\" type=\"revolute\">",
        "<xyz>0 0 -1</xyz>",
        "<uri>door.obj</uri>",
    ] {
        assert!(text(1).contains(line), "{line}");
    }
    assert!(text(0).contains("map_Kd texture_0.png") && text(3).contains("f 1/1/1 2/2/1 3/3/1\n"), "{}", text(3));
    let mut still = model();
    still.joints.clear();
    let still = sdf(&still).unwrap();
    assert!(String::from_utf8_lossy(&still[1].bytes).contains("<static>true</static>"));
}

#[test]
fn broken_models_are_refused_by_name() {
    let breaks: [fn(&mut Model3d); 6] = [
        |m| m.name = "a/b".into(),
        |m| m.bodies.clear(),
        |m| m.bodies[0].visuals[0].mesh.triangles[0][0] = 9,
        |m| m.bodies[0].visuals[0].mesh.positions[0][0] = f32::NAN,
        |m| m.bodies[0].visuals[0].material = Some(7),
        |m| m.joints[0].child = 5,
    ];
    for (i, break_it) in breaks.iter().enumerate() {
        let mut broken = model();
        break_it(&mut broken);
        for error in [usda(&broken).err(), glb(&broken).err(), sdf(&broken).err(), usdz(&broken).err()] {
            assert!(matches!(error, Some(Error::Model { .. })), "case {i}");
        }
    }
}

#[test]
fn frames_become_quaternions_and_angles() {
    for direction in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.3, -0.5, 0.8]] {
        let axes = frame_along(direction);
        let [w, x, y, z] = quaternion(axes);
        // The quaternion turns x to the direction.
        let turned = [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)];
        let [roll, pitch, yaw] = roll_pitch_yaw(axes);
        let third = [
            yaw.cos() * pitch.sin() * roll.cos() + yaw.sin() * roll.sin(),
            yaw.sin() * pitch.sin() * roll.cos() - yaw.cos() * roll.sin(),
            pitch.cos() * roll.cos(),
        ];
        for k in 0..3 {
            assert!((turned[k] - axes[0][k]).abs() < 1e-9, "{direction:?}: {turned:?}");
            assert!((third[k] - axes[2][k]).abs() < 1e-9, "{direction:?}: {third:?} {axes:?}");
        }
    }
}
