//! SDF 1.9: a link a body with inertia, an OBJ mesh and convex collision shapes; joints between them.

use std::fmt::Write;

use super::number::{n, small};
use super::{ModelFile, check, obj, picture_extension, roll_pitch_yaw, texture_of};
use crate::affine::Vec3;
use crate::dynamics;
use crate::error::Error;
use crate::mass::inertia;
use crate::model3d::welded;
use crate::model3d::{Body, Collision, Joint, JointKind, Model3d};

/// Returns `<name>.sdf` and the meshes and materials it refers to, all for one folder.
///
/// A model without joints is static; one with joints is fixed to the world by its root.
///
/// # Errors
/// `Model` when the model is broken.
pub fn sdf(model: &Model3d) -> Result<Vec<ModelFile>, Error> {
    check(model)?;
    let library = format!("{}.mtl", model.name);
    let mut out = format!("<?xml version=\"1.0\"?>\n<sdf version=\"1.9\">\n  <model name=\"{}\">\n", model.name);
    let moving = !model.joints.is_empty();
    let _ = writeln!(out, "    <static>{}</static>", !moving);
    let mut files = Vec::new();
    for body in &model.bodies {
        let seen = body.visuals.iter().any(|v| !v.mesh.triangles.is_empty());
        let mesh = seen.then(|| format!("{}.obj", body.name));
        write_link(&mut out, body, mesh.as_deref(), None);
        if let Some(name) = mesh {
            files.push(ModelFile { name, bytes: obj::obj(model, body, &library).into_bytes() });
        }
    }
    if moving {
        let _ = writeln!(
            out,
            "    <joint name=\"root_joint\" type=\"fixed\">\n      <parent>world</parent>\n      <child>{}</child>\n    \
             </joint>",
            model.bodies[0].name
        );
    }
    for joint in &model.joints {
        write_joint(&mut out, model, joint);
    }
    out.push_str("  </model>\n</sdf>\n");
    files.push(ModelFile { name: format!("{}.sdf", model.name), bytes: out.into_bytes() });
    files.push(ModelFile { name: library, bytes: obj::mtl(model).into_bytes() });
    files.extend(pictures(model));
    files.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(files)
}

/// Returns a model as one rigid body that can be moved: `model.sdf` and, for its folder `meshes`, the mesh with its materials.
///
/// `uri` is where the folder is found: `model://chair/meshes`. What joints hold is held fast with every joint at zero.
///
/// # Errors
/// `Model` when the model is broken.
pub fn sdf_body(model: &Model3d, uri: &str, friction: f64) -> Result<(Vec<u8>, Vec<ModelFile>), Error> {
    check(model)?;
    let one = welded(model);
    let library = format!("{}.mtl", one.name);
    let mesh = format!("{}.obj", one.name);
    let mut out = format!("<?xml version=\"1.0\"?>\n<sdf version=\"1.9\">\n  <model name=\"{}\">\n", one.name);
    let body = &one.bodies[0];
    let seen = body.visuals.iter().any(|v| !v.mesh.triangles.is_empty());
    let place = format!("{uri}/{mesh}");
    write_link(&mut out, body, seen.then_some(place.as_str()), Some(friction));
    out.push_str("  </model>\n</sdf>\n");
    let mut files = Vec::new();
    if seen {
        files.push(ModelFile { name: mesh, bytes: obj::obj(&one, body, &library).into_bytes() });
        files.push(ModelFile { name: library, bytes: obj::mtl(&one).into_bytes() });
        files.extend(pictures(&one));
    }
    Ok((out.into_bytes(), files))
}

/// Returns the pictures that materials refer to, each once.
fn pictures(model: &Model3d) -> Vec<ModelFile> {
    let mut files: Vec<ModelFile> = Vec::new();
    for material in 0..model.materials.len() {
        if let Some((index, bytes)) = texture_of(model, material)
            && let Some(extension) = picture_extension(bytes)
        {
            let name = format!("texture_{index}.{extension}");
            if files.iter().all(|f| f.name != name) {
                files.push(ModelFile { name, bytes: bytes.to_vec() });
            }
        }
    }
    files
}

fn write_link(out: &mut String, body: &Body, mesh: Option<&str>, friction: Option<f64>) {
    let inertia = inertia(body);
    let [x, y, z] = inertia.center_m.map(n);
    let t = inertia.tensor;
    let _ = write!(
        out,
        "    <link name=\"{}\">\n      <inertial>\n        <pose>{x} {y} {z} 0 0 0</pose>\n        \
         <mass>{}</mass>\n        \
         <inertia><ixx>{}</ixx><ixy>{}</ixy><ixz>{}</ixz><iyy>{}</iyy><iyz>{}</iyz><izz>{}</izz></inertia>\n      \
         </inertial>\n",
        body.name,
        small(inertia.mass_kg),
        small(t[0][0]),
        small(t[0][1]),
        small(t[0][2]),
        small(t[1][1]),
        small(t[1][2]),
        small(t[2][2]),
    );
    if let Some(mesh) = mesh {
        let _ = write!(
            out,
            "      <visual name=\"{}_visual\">\n        <geometry><mesh><uri>{mesh}</uri></mesh></geometry>\n      \
             </visual>\n",
            body.name
        );
    }
    let surface = friction.map_or_else(String::new, |mu| {
        let mu = n(mu);
        format!("        <surface><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface>\n")
    });
    for (i, shape) in body.collisions.iter().enumerate() {
        let (pose, geometry) = geometry(shape);
        let _ = write!(
            out,
            "      <collision name=\"{}_collision_{i}\">\n        <pose>{pose}</pose>\n        \
             <geometry>{geometry}</geometry>\n{surface}      </collision>\n",
            body.name
        );
    }
    out.push_str("    </link>\n");
}

fn geometry(shape: &Collision) -> (String, String) {
    let pose = |center: Vec3, turn: Vec3| center.into_iter().chain(turn).map(n).collect::<Vec<_>>().join(" ");
    let cube = |size: Vec3| format!("<box><size>{}</size></box>", size.map(n).join(" "));
    match shape {
        Collision::Box { min, max } => {
            let center = std::array::from_fn(|i| (min[i] + max[i]) / 2.0);
            (pose(center, [0.0; 3]), cube(std::array::from_fn(|i| max[i] - min[i])))
        }
        Collision::TurnedBox { center, half, axes } => {
            (pose(*center, roll_pitch_yaw(*axes)), cube(half.map(|v| 2.0 * v)))
        }
        Collision::Cylinder { center, radius, length, axis } => {
            let quarter = std::f64::consts::FRAC_PI_2;
            let turn = [[0.0, quarter, 0.0], [-quarter, 0.0, 0.0], [0.0; 3]][*axis];
            let shape = format!("<cylinder><radius>{}</radius><length>{}</length></cylinder>", n(*radius), n(*length));
            (pose(*center, turn), shape)
        }
        Collision::Sphere { center, radius } => {
            (pose(*center, [0.0; 3]), format!("<sphere><radius>{}</radius></sphere>", n(*radius)))
        }
    }
}

fn write_joint(out: &mut String, model: &Model3d, joint: &Joint) {
    let kind = match joint.kind {
        JointKind::Revolute => "revolute",
        JointKind::Prismatic => "prismatic",
        JointKind::Continuous => "continuous",
    };
    let [x, y, z] = joint.origin.map(n);
    let _ = write!(
        out,
        "    <joint name=\"{}\" type=\"{kind}\">\n      <parent>{}</parent>\n      <child>{}</child>\n      <pose>{x} {y} \
         {z} 0 0 0</pose>\n      <axis>\n        <xyz>{}</xyz>\n",
        joint.name,
        model.bodies[joint.parent].name,
        model.bodies[joint.child].name,
        joint.axis.map(n).join(" "),
    );
    if let Some([low, high]) = joint.limits {
        let _ = writeln!(out, "        <limit><lower>{}</lower><upper>{}</upper></limit>", n(low), n(high));
    }
    // Doors and drawers stay where they are left.
    let resists = dynamics::of(model, joint);
    let spring = resists.spring.map_or_else(String::new, |s| {
        let (reference, stiffness) = (n(s.reference), n(s.stiffness));
        format!("<spring_reference>{reference}</spring_reference><spring_stiffness>{stiffness}</spring_stiffness>")
    });
    let _ = write!(
        out,
        "        <dynamics><damping>{}</damping><friction>{}</friction>{spring}</dynamics>\n      </axis>\n    \
         </joint>\n",
        n(resists.damping),
        n(resists.friction)
    );
}
