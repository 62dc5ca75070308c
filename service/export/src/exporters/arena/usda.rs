//! A USD component of primitive prims with preview materials, meters, z up.

use std::fmt::Write;

use super::assets::Look;
use crate::shapes::{Axis, Solid, Tone};

/// Returns the `.usda` text.
pub(super) fn stage(look: &Look<'_>) -> String {
    let root = identifier(look.name);
    let mut tones: Vec<Tone> = look.parts.iter().map(|p| p.tone).collect();
    tones.sort();
    tones.dedup();
    let [w, d, h] = look.size_m;
    let mut out = String::with_capacity(1024 + 500 * look.parts.len());
    let _ = write!(
        out,
        "#usda 1.0\n(\n    defaultPrim = \"{root}\"\n    metersPerUnit = 1\n    upAxis = \"Z\"\n)\n\n\
         def Xform \"{root}\" (\n    prepend apiSchemas = [\"GeomModelAPI\"]\n    kind = \"component\"\n)\n{{\n    \
         float3[] extentsHint = [{}, {}]\n\n    def Scope \"Looks\"\n    {{\n",
        triple([-w / 2.0, -d / 2.0, 0.0]),
        triple([w / 2.0, d / 2.0, h]),
    );
    for tone in &tones {
        write_material(&mut out, &root, *tone, tone.color(look.color).to_linear());
    }
    out.push_str("    }\n\n    def Xform \"Geometry\"\n    {\n");
    for (i, part) in look.parts.iter().enumerate() {
        let color = triple(part.tone.color(look.color).to_linear());
        let (kind, body) = prim(&part.solid);
        let _ = write!(
            out,
            "        def {kind} \"part_{i}\" (\n            prepend apiSchemas = [\"MaterialBindingAPI\", \
             \"PhysicsCollisionAPI\"]\n        )\n        {{\n{body}            color3f[] primvars:displayColor = \
             [{color}]\n            rel material:binding = </{root}/Looks/{}>\n        }}\n",
            part.tone.name(),
        );
    }
    out.push_str("    }\n}\n");
    out
}

fn write_material(out: &mut String, root: &str, tone: Tone, linear: [f64; 3]) {
    let name = tone.name();
    let (metallic, roughness) = if tone == Tone::Metal { (0.6, 0.4) } else { (0.0, 0.7) };
    let _ = write!(
        out,
        "        def Material \"{name}\"\n        {{\n            token outputs:surface.connect = \
         </{root}/Looks/{name}/Surface.outputs:surface>\n\n            def Shader \"Surface\"\n            {{\n                \
         uniform token info:id = \"UsdPreviewSurface\"\n                color3f inputs:diffuseColor = {}\n                \
         float inputs:metallic = {metallic}\n                float inputs:roughness = {roughness}\n                \
         token outputs:surface\n            }}\n        }}\n",
        triple(linear),
    );
}

/// Returns the prim type and the lines that give its geometry and place.
fn prim(solid: &Solid) -> (&'static str, String) {
    let mut body = String::new();
    let mut line = |text: String| {
        let _ = writeln!(body, "            {text}");
    };
    let center = triple(solid.center());
    let kind = match solid {
        Solid::Box { .. } => {
            line("double size = 1".into());
            line("float3[] extent = [(-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)]".into());
            line(format!("double3 xformOp:translate = {center}"));
            line(format!("float3 xformOp:scale = {}", triple(solid.size())));
            line("uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:scale\"]".into());
            return ("Cube", body);
        }
        Solid::Cylinder { radius, length, axis, .. } => {
            let (token, half) = match axis {
                Axis::X => ("X", [length / 2.0, *radius, *radius]),
                Axis::Y => ("Y", [*radius, length / 2.0, *radius]),
                Axis::Z => ("Z", [*radius, *radius, length / 2.0]),
            };
            line(format!("uniform token axis = \"{token}\""));
            line(format!("double radius = {}", n(*radius)));
            line(format!("double height = {}", n(*length)));
            line(format!("float3[] extent = [{}, {}]", triple(half.map(|v| -v)), triple(half)));
            "Cylinder"
        }
        Solid::Sphere { radius, .. } => {
            line(format!("double radius = {}", n(*radius)));
            line(format!("float3[] extent = [{}, {}]", triple([-radius; 3]), triple([*radius; 3])));
            "Sphere"
        }
    };
    line(format!("double3 xformOp:translate = {center}"));
    line("uniform token[] xformOpOrder = [\"xformOp:translate\"]".into());
    (kind, body)
}

/// Returns a prim name: letters, digits and underscores, no digit first.
fn identifier(name: &str) -> String {
    let mut id: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if id.starts_with(|c: char| c.is_ascii_digit()) {
        id.insert(0, '_');
    }
    id
}

fn triple(v: [f64; 3]) -> String {
    let [x, y, z] = v.map(n);
    format!("({x}, {y}, {z})")
}

/// Writes a number in at most six decimals.
fn n(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}
