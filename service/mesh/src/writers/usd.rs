//! USD as text: one component of rigid bodies with meshes, collision shapes and joints; meters, z up.

use std::fmt::Write;

use super::number::{n, push, small};
use super::{check, frame_along, picture_extension, quaternion, texture_of};
use crate::affine::Vec3;
use crate::dynamics;
use crate::mass::inertia;
use crate::{Body, Collision, Error, Joint, JointKind, Material, Model3d, Visual};

/// Returns the text of the layer.
///
/// # Errors
/// `Model` when the model is broken.
pub fn usda(model: &Model3d) -> Result<String, Error> {
    check(model)?;
    let root = identifier(&model.name);
    let [min, max] = model.bounds().unwrap_or([[0.0; 3]; 2]);
    let moving = !model.joints.is_empty();
    let schemas = if moving { "\"GeomModelAPI\", \"PhysicsArticulationRootAPI\"" } else { "\"GeomModelAPI\"" };
    let mut out = String::with_capacity(4096 + 60 * model.meshes().map(|m| m.positions.len()).sum::<usize>());
    let _ = write!(
        out,
        "#usda 1.0\n(\n    defaultPrim = \"{root}\"\n    kilogramsPerUnit = 1\n    metersPerUnit = 1\n    upAxis = \
         \"Z\"\n)\n\ndef Xform \"{root}\" (\n    prepend apiSchemas = [{schemas}]\n    kind = \"component\"\n)\n{{\n    \
         float3[] extentsHint = [{}, {}]\n\n    def Scope \"Looks\"\n    {{\n",
        triple(min),
        triple(max),
    );
    let looks = names("Looks", model.materials.iter().map(|m| m.name.as_str()));
    for (i, (material, name)) in model.materials.iter().zip(&looks).enumerate() {
        write_material(&mut out, model, i, material, &format!("/{root}/Looks/{name}"), name);
    }
    out.push_str("    }\n");
    let bodies = names("Looks", model.bodies.iter().map(|b| b.name.as_str()));
    for (body, name) in model.bodies.iter().zip(&bodies) {
        write_body(&mut out, model, body, name, &root, &looks);
    }
    if moving {
        // To the root prim and not to the world: the joint moves with the model that a scene places.
        let _ = write!(
            out,
            "\n    def PhysicsFixedJoint \"root_joint\"\n    {{\n        rel physics:body0 = </{root}>\n        rel \
             physics:body1 = </{root}/{}>\n    }}\n",
            bodies[0]
        );
    }
    let joints = names("root_joint", model.joints.iter().map(|j| j.name.as_str()));
    for (joint, name) in model.joints.iter().zip(&joints) {
        write_joint(&mut out, model, joint, name, &root, &bodies);
    }
    out.push_str("}\n");
    Ok(out)
}

/// Returns the name under which a texture is packed beside the layer.
pub(super) fn texture_name(index: usize, bytes: &[u8]) -> Option<String> {
    picture_extension(bytes).map(|extension| format!("texture_{index}.{extension}"))
}

fn write_material(out: &mut String, model: &Model3d, index: usize, material: &Material, path: &str, name: &str) {
    let texture = texture_of(model, index).and_then(|(t, bytes)| texture_name(t, bytes));
    let color = |c: [f32; 3]| triple(c.map(f64::from));
    let diffuse = match &texture {
        Some(_) => format!("color3f inputs:diffuseColor.connect = <{path}/Texture.outputs:rgb>"),
        None => format!("color3f inputs:diffuseColor = {}", color(material.base_color)),
    };
    let _ = write!(
        out,
        "        def Material \"{name}\"\n        {{\n            token outputs:surface.connect = \
         <{path}/Surface.outputs:surface>\n\n            def Shader \"Surface\"\n            {{\n                uniform \
         token info:id = \"UsdPreviewSurface\"\n                {diffuse}\n                float inputs:metallic = \
         {}\n                float inputs:roughness = {}\n",
        n(f64::from(material.metallic)),
        n(f64::from(material.roughness)),
    );
    if material.opacity < 1.0 {
        let _ = writeln!(out, "                float inputs:opacity = {}", n(f64::from(material.opacity)));
    }
    if material.emissive != [0.0; 3] {
        let _ = writeln!(out, "                color3f inputs:emissiveColor = {}", color(material.emissive));
    }
    out.push_str("                token outputs:surface\n            }\n");
    if let Some(file) = texture {
        let _ = write!(
            out,
            "\n            def Shader \"Texture\"\n            {{\n                uniform token info:id = \
             \"UsdUVTexture\"\n                asset inputs:file = @{file}@\n                token inputs:sourceColorSpace = \
             \"sRGB\"\n                float2 inputs:st.connect = <{path}/Reader.outputs:result>\n                token \
             inputs:wrapS = \"repeat\"\n                token inputs:wrapT = \"repeat\"\n                float3 \
             outputs:rgb\n            }}\n\n            def Shader \"Reader\"\n            {{\n                uniform token \
             info:id = \"UsdPrimvarReader_float2\"\n                string inputs:varname = \"st\"\n                float2 \
             outputs:result\n            }}\n"
        );
    }
    out.push_str("        }\n");
}

fn write_body(out: &mut String, model: &Model3d, body: &Body, name: &str, root: &str, looks: &[String]) {
    let inertia = inertia(body);
    let (moments, axes) = inertia.principal();
    let moments = moments.map(|v| small(v.max(1e-9)));
    let _ = write!(
        out,
        "\n    def Xform \"{name}\" (\n        prepend apiSchemas = [\"PhysicsRigidBodyAPI\", \
         \"PhysicsMassAPI\"]\n    )\n    {{\n"
    );
    if model.joints.is_empty() {
        // Stands where it is put, as furniture does for a robot; set to 0 to let it be pushed.
        out.push_str("        bool physics:kinematicEnabled = 1\n");
    }
    let _ = write!(
        out,
        "        float physics:mass = {}\n        point3f physics:centerOfMass = {}\n        float3 \
         physics:diagonalInertia = ({}, {}, {})\n        quatf physics:principalAxes = {}\n",
        small(inertia.mass_kg),
        triple(inertia.center_m),
        moments[0],
        moments[1],
        moments[2],
        quat(quaternion(axes)),
    );
    let taken = (0..body.collisions.len()).map(|i| format!("collision_{i}"));
    let all: Vec<String> = taken.chain(body.visuals.iter().map(|v| v.name.clone())).collect();
    let all = names("", all.iter().map(String::as_str));
    let (shapes, visuals) = all.split_at(body.collisions.len());
    for (visual, name) in body.visuals.iter().zip(visuals) {
        write_mesh(out, model, visual, name, root, looks);
    }
    for (shape, name) in body.collisions.iter().zip(shapes) {
        write_collision(out, shape, name);
    }
    out.push_str("    }\n");
}

fn write_mesh(out: &mut String, model: &Model3d, visual: &Visual, name: &str, root: &str, looks: &[String]) {
    let mesh = &visual.mesh;
    let Some([min, max]) = mesh.bounds() else { return };
    let schemas = if visual.material.is_some() {
        " (\n            prepend apiSchemas = [\"MaterialBindingAPI\"]\n        )"
    } else {
        ""
    };
    let _ = write!(
        out,
        "\n        def Mesh \"{name}\"{schemas}\n        {{\n            float3[] extent = [{}, {}]\n            uniform \
         token subdivisionScheme = \"none\"\n",
        triple(min),
        triple(max),
    );
    out.push_str("            int[] faceVertexCounts = [3");
    for _ in 1..mesh.triangles.len() {
        out.push_str(",3");
    }
    out.push_str("]\n            int[] faceVertexIndices = [");
    for (i, index) in mesh.triangles.iter().flatten().enumerate() {
        if i > 0 {
            out.push(',');
        }
        push(out, f64::from(*index), 0);
    }
    out.push_str("]\n            point3f[] points = [");
    vectors(out, &mesh.positions, 6);
    out.push_str("]\n");
    if !mesh.normals.is_empty() {
        out.push_str("            normal3f[] normals = [");
        vectors(out, &mesh.normals, 4);
        out.push_str("] (\n                interpolation = \"vertex\"\n            )\n");
    }
    if let Some(index) = visual.material {
        if texture_of(model, index).is_some() && !mesh.uvs.is_empty() {
            out.push_str("            texCoord2f[] primvars:st = [");
            vectors(out, &mesh.uvs, 5);
            out.push_str("] (\n                interpolation = \"vertex\"\n            )\n");
        }
        let material = &model.materials[index];
        let _ = writeln!(
            out,
            "            color3f[] primvars:displayColor = [{}]\n            rel material:binding = </{root}/Looks/{}>",
            triple(material.base_color.map(f64::from)),
            looks[index],
        );
    }
    out.push_str("        }\n");
}

fn vectors<const N: usize>(out: &mut String, list: &[[f32; N]], decimals: u32) {
    for (i, vector) in list.iter().enumerate() {
        out.push_str(if i > 0 { ",(" } else { "(" });
        for (k, v) in vector.iter().enumerate() {
            if k > 0 {
                out.push(',');
            }
            push(out, f64::from(*v), decimals);
        }
        out.push(')');
    }
}

fn write_collision(out: &mut String, shape: &Collision, name: &str) {
    let (kind, lines) = match shape {
        Collision::Box { min, max } => {
            let center: Vec3 = std::array::from_fn(|i| (min[i] + max[i]) / 2.0);
            let size: Vec3 = std::array::from_fn(|i| max[i] - min[i]);
            ("Cube", cube(center, size, None))
        }
        Collision::TurnedBox { center, half, axes } => {
            ("Cube", cube(*center, half.map(|v| 2.0 * v), Some(quaternion(*axes))))
        }
        Collision::Cylinder { center, radius, length, axis } => {
            let half: Vec3 = std::array::from_fn(|i| if i == *axis { length / 2.0 } else { *radius });
            let token = ["X", "Y", "Z"][*axis];
            let mut lines = vec![
                format!("uniform token axis = \"{token}\""),
                format!("double height = {}", n(*length)),
                format!("double radius = {}", n(*radius)),
                format!("float3[] extent = [{}, {}]", triple(half.map(|v| -v)), triple(half)),
            ];
            lines.extend(moved(*center));
            ("Cylinder", lines)
        }
        Collision::Sphere { center, radius } => {
            let mut lines = vec![
                format!("double radius = {}", n(*radius)),
                format!("float3[] extent = [{}, {}]", triple([-radius; 3]), triple([*radius; 3])),
            ];
            lines.extend(moved(*center));
            ("Sphere", lines)
        }
    };
    let _ = write!(
        out,
        "\n        def {kind} \"{name}\" (\n            prepend apiSchemas = [\"PhysicsCollisionAPI\"]\n        )\n        \
         {{\n            uniform token purpose = \"guide\"\n"
    );
    for line in lines {
        let _ = writeln!(out, "            {line}");
    }
    out.push_str("        }\n");
}

fn cube(center: Vec3, size: Vec3, turn: Option<[f64; 4]>) -> Vec<String> {
    let mut lines = vec![
        "double size = 1".to_owned(),
        "float3[] extent = [(-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)]".to_owned(),
        format!("double3 xformOp:translate = {}", triple(center)),
    ];
    let mut order = vec!["\"xformOp:translate\""];
    if let Some(q) = turn {
        lines.push(format!("quatf xformOp:orient = {}", quat(q)));
        order.push("\"xformOp:orient\"");
    }
    lines.push(format!("float3 xformOp:scale = {}", triple(size)));
    order.push("\"xformOp:scale\"");
    lines.push(format!("uniform token[] xformOpOrder = [{}]", order.join(", ")));
    lines
}

fn moved(center: Vec3) -> [String; 2] {
    [
        format!("double3 xformOp:translate = {}", triple(center)),
        "uniform token[] xformOpOrder = [\"xformOp:translate\"]".to_owned(),
    ]
}

fn write_joint(out: &mut String, model: &Model3d, joint: &Joint, name: &str, root: &str, bodies: &[String]) {
    // Angles are degrees in USD, those of damping too.
    let resists = dynamics::of(model, joint);
    let spring = resists.spring.unwrap_or(dynamics::Spring { stiffness: 0.0, reference: 0.0 });
    let (kind, drive, damping, stiffness, reference) = match joint.kind {
        JointKind::Prismatic => {
            ("PhysicsPrismaticJoint", "linear", resists.damping, spring.stiffness, spring.reference)
        }
        JointKind::Revolute | JointKind::Continuous => {
            let [damping, stiffness] = [resists.damping, spring.stiffness].map(f64::to_radians);
            ("PhysicsRevoluteJoint", "angular", damping, stiffness, spring.reference.to_degrees())
        }
    };
    let turn = quat(quaternion(frame_along(joint.axis)));
    let at = triple(joint.origin);
    let _ = write!(
        out,
        "\n    def {kind} \"{name}\" (\n        prepend apiSchemas = [\"PhysicsDriveAPI:{drive}\"]\n    )\n    {{\n        uniform token physics:axis = \"X\"\n        rel physics:body0 = \
         </{root}/{}>\n        rel physics:body1 = </{root}/{}>\n        point3f physics:localPos0 = {at}\n        point3f \
         physics:localPos1 = {at}\n        quatf physics:localRot0 = {turn}\n        quatf physics:localRot1 = {turn}\n",
        bodies[joint.parent], bodies[joint.child],
    );
    if let Some([low, high]) = joint.limits {
        let unit = |v: f64| if joint.kind == JointKind::Prismatic { n(v) } else { n(v.to_degrees()) };
        let _ = write!(
            out,
            "        float physics:lowerLimit = {}\n        float physics:upperLimit = {}\n",
            unit(low),
            unit(high)
        );
    }
    // Doors and drawers stay where they are left. Friction has no word in UsdPhysics; Newton and PhysX know this one.
    let _ = write!(
        out,
        "        float drive:{drive}:physics:damping = {}\n        float drive:{drive}:physics:stiffness = {}\n        \
         float drive:{drive}:physics:targetPosition = {}\n        float newton:friction = {}\n    }}\n",
        n(damping),
        n(stiffness),
        n(reference),
        n(resists.friction)
    );
}

/// Returns prim names of a list: valid, different from each other and from `taken`.
fn names<'a>(taken: &str, list: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for name in list {
        let base = identifier(name);
        let mut name = base.clone();
        let mut number = 1;
        while name == taken || out.contains(&name) {
            number += 1;
            name = format!("{base}_{number}");
        }
        out.push(name);
    }
    out
}

/// Returns a prim name: letters, digits and underscores, no digit first.
fn identifier(name: &str) -> String {
    let mut id: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if id.is_empty() || id.starts_with(|c: char| c.is_ascii_digit()) {
        id.insert(0, '_');
    }
    id
}

fn triple(v: Vec3) -> String {
    let [x, y, z] = v.map(n);
    format!("({x}, {y}, {z})")
}

fn quat(q: [f64; 4]) -> String {
    let [w, x, y, z] = q.map(n);
    format!("({w}, {x}, {y}, {z})")
}
