//! Parts of a USD layer that models and worlds share: materials, meshes, collision shapes, joints.

use super::text::{Text, names, quat, quoted, schemas, triple};
use crate::affine::Vec3;
use crate::dynamics;
use crate::model3d::{Collision, Joint, JointKind, Material, Texture, Visual};
use crate::writers::number::{n, push};
use crate::writers::{frame_along, picture_of, quaternion};

/// Where the pictures of materials lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pictures<'a> {
    /// Folder beside the layer with a slash at its end; `""` for the layer's own.
    pub folder: &'a str,
    /// Whether normal maps are there: of walls and floors, not of the many small files of models.
    pub relief: bool,
}

/// Writes a material of the preview surface with a label of what it is.
pub fn material(
    text: &mut Text,
    material: &Material,
    textures: &[Texture],
    path: &str,
    name: &str,
    pictures: &Pictures<'_>,
) {
    let folder = pictures.folder;
    let picture = picture_of(material, textures);
    let normal = material.worn().filter(|f| pictures.relief && f.pictures().normal.is_some());
    let normal = normal.map(|f| format!("{folder}{}_normal.png", f.id));
    let color = |c: [f32; 3]| triple(c.map(f64::from));
    text.prim("def Material", name, &[schemas(&["SemanticsLabelsAPI:material"])], |text| {
        text.labels("material", &[&material.name.to_lowercase()]);
        text.line(format_args!("token outputs:surface.connect = <{path}/Surface.outputs:surface>"));
        text.prim("def Shader", "Surface", &[], |text| {
            text.line("uniform token info:id = \"UsdPreviewSurface\"");
            match &picture {
                Some(_) => {
                    text.line(format_args!("color3f inputs:diffuseColor.connect = <{path}/Texture.outputs:rgb>"));
                }
                None => text.line(format_args!("color3f inputs:diffuseColor = {}", color(material.base_color))),
            }
            text.line(format_args!("float inputs:metallic = {}", n(f64::from(material.metallic))));
            text.line(format_args!("float inputs:roughness = {}", n(f64::from(material.roughness))));
            if material.opacity < 1.0 {
                text.line(format_args!("float inputs:opacity = {}", n(f64::from(material.opacity))));
            }
            if material.emissive != [0.0; 3] {
                text.line(format_args!("color3f inputs:emissiveColor = {}", color(material.emissive)));
            }
            if normal.is_some() {
                text.line(format_args!("normal3f inputs:normal.connect = <{path}/Normal.outputs:rgb>"));
            }
            text.line("token outputs:surface");
        });
        let Some(picture) = &picture else { return };
        let file = format!("{folder}{}", picture.name);
        texture(text, path, "Texture", &file, |text| {
            text.line("token inputs:sourceColorSpace = \"sRGB\"");
            if picture.factor != [1.0; 3] {
                let [r, g, b] = picture.factor.map(|v| n(f64::from(v)));
                text.line(format_args!("float4 inputs:scale = ({r}, {g}, {b}, 1)"));
            }
        });
        if let Some(file) = &normal {
            texture(text, path, "Normal", file, |text| {
                text.line("token inputs:sourceColorSpace = \"raw\"");
                text.line("float4 inputs:scale = (2, 2, 2, 1)");
                text.line("float4 inputs:bias = (-1, -1, -1, 0)");
            });
        }
        text.prim("def Shader", "Reader", &[], |text| {
            text.line("uniform token info:id = \"UsdPrimvarReader_float2\"");
            text.line("string inputs:varname = \"st\"");
            text.line("float2 outputs:result");
        });
    });
}

fn texture(text: &mut Text, path: &str, name: &str, file: &str, more: impl FnOnce(&mut Text)) {
    text.prim("def Shader", name, &[], |text| {
        text.line("uniform token info:id = \"UsdUVTexture\"");
        text.line(format_args!("asset inputs:file = @{file}@"));
        more(text);
        text.line(format_args!("float2 inputs:st.connect = <{path}/Reader.outputs:result>"));
        text.line("token inputs:wrapS = \"repeat\"");
        text.line("token inputs:wrapT = \"repeat\"");
        text.line("float3 outputs:rgb");
    });
}

/// Writes a mesh; `looks` are the paths of the materials that visuals name by index, `class` what it is a part of.
pub fn mesh(text: &mut Text, visual: &Visual, materials: &[Material], name: &str, looks: &[String], class: &str) {
    let mesh = &visual.mesh;
    let Some([min, max]) = written_bounds(&mesh.positions).filter(|_| !mesh.triangles.is_empty()) else { return };
    let material = visual.material.and_then(|m| Some((materials.get(m)?, looks.get(m)?)));
    let mut apis = vec!["SemanticsLabelsAPI:class"];
    if material.is_some() {
        apis.insert(0, "MaterialBindingAPI");
    }
    text.prim("def Mesh", name, &[schemas(&apis)], |text| {
        text.labels("class", &[class]);
        text.line(format_args!("float3[] extent = [{}, {}]", triple(min), triple(max)));
        text.line("uniform token subdivisionScheme = \"none\"");
        list(text, "int[] faceVertexCounts = [", (0..mesh.triangles.len()).map(|_| 3), "]");
        list(text, "int[] faceVertexIndices = [", mesh.triangles.iter().flatten().copied(), "]");
        vectors(text, "point3f[] points = [", mesh.positions.iter().copied(), DECIMALS, "]");
        let each = "] (\n    interpolation = \"vertex\"\n)";
        if !mesh.normals.is_empty() {
            vectors(text, "normal3f[] normals = [", mesh.normals.iter().copied(), 3, each);
        }
        if let Some((material, path)) = material {
            let worn = material.worn();
            if (worn.is_some() || material.texture.is_some()) && !mesh.uvs.is_empty() {
                let size = worn.map_or([1.0; 2], |f| f.size_m.map(|v| v as f32));
                let st = mesh.uvs.iter().map(|uv| [uv[0] / size[0], uv[1] / size[1]]);
                vectors(text, "texCoord2f[] primvars:st = [", st, 4, each);
            }
            text.line(format_args!(
                "color3f[] primvars:displayColor = [{}]",
                triple(material.base_color.map(f64::from))
            ));
            text.line(format_args!("rel material:binding = <{path}>"));
        }
    });
}

/// Decimals of corners, m.
const DECIMALS: u32 = 5;

/// Returns the box around all corners as they are written, used by triangles or not.
fn written_bounds(positions: &[[f32; 3]]) -> Option<[Vec3; 2]> {
    let unit = 10_f64.powi(DECIMALS as i32);
    let written = positions.iter().map(|p| p.map(|v| (f64::from(v) * unit).round() / unit));
    written.map(|p| [p, p]).reduce(|[low, high], [p, _]| {
        [std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k]))]
    })
}

fn list(text: &mut Text, before: &str, values: impl Iterator<Item = u32>, after: &str) {
    text.indent();
    text.out.push_str(before);
    for (i, value) in values.enumerate() {
        if i > 0 {
            text.out.push(',');
        }
        push(&mut text.out, f64::from(value), 0);
    }
    text.out.push_str(after);
    text.out.push('\n');
}

fn vectors<const N: usize>(
    text: &mut Text,
    before: &str,
    values: impl Iterator<Item = [f32; N]>,
    decimals: u32,
    after: &str,
) {
    text.indent();
    text.out.push_str(before);
    for (i, vector) in values.enumerate() {
        text.out.push_str(if i > 0 { ",(" } else { "(" });
        for (k, v) in vector.iter().enumerate() {
            if k > 0 {
                text.out.push(',');
            }
            push(&mut text.out, f64::from(*v), decimals);
        }
        text.out.push(')');
    }
    text.out.push_str(after);
    text.out.push('\n');
}

/// Writes a shape that collides and is not seen.
pub fn collision(text: &mut Text, shape: &Collision, name: &str, class: &str) {
    let api = schemas(&["PhysicsCollisionAPI", "SemanticsLabelsAPI:class"]);
    let guide = |text: &mut Text| {
        text.labels("class", &[class]);
        text.line("uniform token purpose = \"guide\"");
    };
    match shape {
        Collision::Box { min, max } => {
            let center: Vec3 = std::array::from_fn(|i| (min[i] + max[i]) / 2.0);
            cuboid(text, name, center, std::array::from_fn(|i| (max[i] - min[i]) / 2.0), None, class);
        }
        Collision::TurnedBox { center, half, axes } => {
            cuboid(text, name, *center, *half, Some(quaternion(*axes)), class);
        }
        Collision::Cylinder { center, radius, length, axis } => {
            let half: Vec3 = std::array::from_fn(|i| if i == *axis { length / 2.0 } else { *radius });
            text.prim("def Cylinder", name, &[api], |text| {
                guide(text);
                text.line(format_args!("uniform token axis = \"{}\"", ["X", "Y", "Z"][*axis]));
                text.line(format_args!("double height = {}", n(*length)));
                text.line(format_args!("double radius = {}", n(*radius)));
                text.line(format_args!("float3[] extent = [{}, {}]", triple(half.map(|v| -v)), triple(half)));
                text.placed(*center, None);
            });
        }
        Collision::Sphere { center, radius } => {
            text.prim("def Sphere", name, &[api], |text| {
                guide(text);
                text.line(format_args!("double radius = {}", n(*radius)));
                text.line(format_args!("float3[] extent = [{}, {}]", triple([-radius; 3]), triple([*radius; 3])));
                text.placed(*center, None);
            });
        }
    }
}

/// Writes a box that collides and is not seen.
pub fn cuboid(text: &mut Text, name: &str, center: Vec3, half: Vec3, turn: Option<[f64; 4]>, class: &str) {
    let api = schemas(&["PhysicsCollisionAPI", "SemanticsLabelsAPI:class"]);
    text.prim("def Cube", name, &[api], |text| {
        text.labels("class", &[class]);
        text.line("uniform token purpose = \"guide\"");
        text.line("double size = 1");
        text.line("float3[] extent = [(-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)]");
        text.line(format_args!("double3 xformOp:translate = {}", triple(center)));
        let mut order = vec!["\"xformOp:translate\""];
        if let Some(q) = turn {
            text.line(format_args!("quatf xformOp:orient = {}", quat(q)));
            order.push("\"xformOp:orient\"");
        }
        text.line(format_args!("float3 xformOp:scale = {}", triple(half.map(|v| 2.0 * v))));
        order.push("\"xformOp:scale\"");
        text.line(format_args!("uniform token[] xformOpOrder = [{}]", order.join(", ")));
    });
}

/// Writes an upright prism of a convex outline, counter-clockwise, as a convex mesh that collides and is not seen.
pub fn convex_prism(text: &mut Text, name: &str, outline: &[[f64; 2]], z: [f64; 2], class: &str) {
    let apis = ["PhysicsCollisionAPI", "PhysicsMeshCollisionAPI", "SemanticsLabelsAPI:class"];
    let count = outline.len();
    let corners: Vec<Vec3> = z.iter().flat_map(|z| outline.iter().map(move |p| [p[0], p[1], *z])).collect();
    let mut faces: Vec<Vec<usize>> = vec![(0..count).rev().collect(), (count..2 * count).collect()];
    faces.extend((0..count).map(|i| vec![i, (i + 1) % count, count + (i + 1) % count, count + i]));
    let bound = |pick: fn(f64, f64) -> f64, start: f64| -> Vec3 {
        corners.iter().fold([start; 3], |sum, p| std::array::from_fn(|k| pick(sum[k], p[k])))
    };
    let joined = |list: Vec<String>| list.join(", ");
    text.prim("def Mesh", name, &[schemas(&apis)], |text| {
        text.labels("class", &[class]);
        text.line("uniform token purpose = \"guide\"");
        text.line("uniform token physics:approximation = \"convexHull\"");
        text.line("uniform token subdivisionScheme = \"none\"");
        text.line(format_args!(
            "float3[] extent = [{}, {}]",
            triple(bound(f64::min, f64::MAX)),
            triple(bound(f64::max, f64::MIN))
        ));
        text.line(format_args!(
            "int[] faceVertexCounts = [{}]",
            joined(faces.iter().map(|f| f.len().to_string()).collect())
        ));
        let indices = faces.iter().flatten().map(ToString::to_string).collect();
        text.line(format_args!("int[] faceVertexIndices = [{}]", joined(indices)));
        text.line(format_args!("point3f[] points = [{}]", joined(corners.iter().map(|p| triple(*p)).collect())));
    });
}

/// A joint as USD knows it; lengths in m, angles in rad.
#[derive(Debug, Clone, PartialEq)]
pub struct UsdJoint<'a> {
    /// Prim name.
    pub name: &'a str,
    /// Turn or slide.
    pub kind: JointKind,
    /// Path of the body that stands; none for the world.
    pub parent: Option<&'a str>,
    /// Path of the body that moves.
    pub child: &'a str,
    /// A point of the axis in the frames of parent and child.
    pub at: [Vec3; 2],
    /// The turn from the frames of parent and child to one whose x is the axis: w, x, y, z.
    pub turn: [[f64; 4]; 2],
    /// Least and largest position.
    pub limits: Option<[f64; 2]>,
    /// What it resists with.
    pub resists: dynamics::Drive,
}

impl UsdJoint<'_> {
    /// Writes it with a drive that damps and balances its weight, and stops that are hard.
    pub fn write(&self, text: &mut Text) {
        let resists = &self.resists;
        let slides = self.kind == JointKind::Prismatic;
        // Angles are degrees in USD, those of damping and stiffness too.
        let (what, drive, per_angle, angle) = match slides {
            true => ("def PhysicsPrismaticJoint", "linear", 1.0, 1.0),
            false => ("def PhysicsRevoluteJoint", "angular", 1.0_f64.to_radians(), 1.0_f64.to_degrees()),
        };
        let apis = [format!("PhysicsDriveAPI:{drive}"), format!("PhysxJointAxisAPI:{drive}")];
        text.prim(what, self.name, &[schemas(&apis.each_ref().map(String::as_str))], |text| {
            text.line("uniform token physics:axis = \"X\"");
            if let Some(parent) = self.parent {
                text.line(format_args!("rel physics:body0 = <{parent}>"));
            }
            text.line(format_args!("rel physics:body1 = <{}>", self.child));
            for (side, (at, turn)) in self.at.iter().zip(&self.turn).enumerate() {
                text.line(format_args!("point3f physics:localPos{side} = {}", triple(*at)));
                text.line(format_args!("quatf physics:localRot{side} = {}", quat(*turn)));
            }
            if let Some([low, high]) = self.limits {
                text.line(format_args!("float physics:lowerLimit = {}", n(low * angle)));
                text.line(format_args!("float physics:upperLimit = {}", n(high * angle)));
            }
            let value = |text: &mut Text, name: &str, v: f64| text.line(format_args!("float {name} = {}", n(v)));
            let of_drive = |name: &str| format!("drive:{drive}:physics:{name}");
            value(text, &of_drive("damping"), resists.damping * per_angle);
            value(text, &of_drive("stiffness"), 0.0);
            // An even push is damping times a velocity that is never reached.
            value(text, &of_drive("targetVelocity"), resists.push / resists.damping * angle);
            // Doors and drawers stay where they are left. Friction has no word in UsdPhysics; PhysX and Newton have theirs.
            for name in ["staticFrictionEffort", "dynamicFrictionEffort"] {
                value(text, &format!("physxJointAxis:{drive}:{name}"), resists.friction);
            }
            value(text, "newton:friction", resists.friction);
            let armature = dynamics::armature(self.limits);
            value(text, &format!("physxJointAxis:{drive}:armature"), armature);
            value(text, "newton:armature", armature);
            text.line("float newton:limitStiffness = inf");
        });
    }
}

/// Writes a joint of a model whose bodies have these paths; their frames are that of the model.
pub(super) fn joint(text: &mut Text, joint: &Joint, resists: dynamics::Drive, name: &str, bodies: &[String]) {
    let turn = quaternion(frame_along(joint.axis));
    let joint = UsdJoint {
        name,
        kind: joint.kind,
        parent: Some(&bodies[joint.parent]),
        child: &bodies[joint.child],
        at: [joint.origin; 2],
        turn: [turn; 2],
        limits: joint.limits,
        resists,
    };
    joint.write(text);
}

/// Returns the turn (w, x, y, z) to a frame whose x is a direction.
pub fn turn_to(direction: Vec3) -> [f64; 4] {
    quaternion(frame_along(direction))
}

/// Returns a turn (w, x, y, z) as seen from a frame that is itself turned.
pub fn turn_within([w, x, y, z]: [f64; 4], turn: [f64; 4]) -> [f64; 4] {
    crate::affine::product([w, -x, -y, -z], turn)
}

/// Returns the names and paths of materials in a scope.
pub fn looks(materials: &[Material], scope: &str) -> (Vec<String>, Vec<String>) {
    let names = names("Looks", materials.iter().map(|m| m.name.as_str()));
    let paths = names.iter().map(|n| format!("{scope}/{n}")).collect();
    (names, paths)
}

/// Returns a header line of text metadata.
pub(super) fn string(key: &str, value: &str) -> String {
    format!("string {key} = {}", quoted(value))
}
