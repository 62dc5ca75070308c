//! A static SDF model of primitive parts, each with a collision of its own.

use std::fmt::Write;

use super::assets::Look;
use crate::shapes::Solid;

/// Returns the SDF text.
pub(super) fn model(look: &Look<'_>) -> String {
    let [w, d, h] = look.size_m;
    let m = look.mass_kg;
    let inertia = |a: f64, b: f64| m / 12.0 * (a * a + b * b);
    let mut out = String::with_capacity(1024 + 800 * look.parts.len());
    let _ = write!(
        out,
        "<?xml version=\"1.0\"?>\n<sdf version=\"1.7\">\n  <model name=\"{}\">\n    <static>true</static>\n    \
         <link name=\"link\">\n      <inertial>\n        <pose>0 0 {} 0 0 0</pose>\n        <mass>{}</mass>\n        \
         <inertia><ixx>{}</ixx><ixy>0</ixy><ixz>0</ixz><iyy>{}</iyy><iyz>0</iyz><izz>{}</izz></inertia>\n      \
         </inertial>\n",
        look.name,
        n(h / 2.0),
        n(m),
        n(inertia(d, h)),
        n(inertia(w, h)),
        n(inertia(w, d)),
    );
    for (i, part) in look.parts.iter().enumerate() {
        let (pose, geometry) = geometry(&part.solid);
        let [r, g, b] = part.tone.color(look.color).0.map(n);
        // The static colliders are the parts themselves: a robot passes under a table between its legs.
        let _ = write!(
            out,
            "      <collision name=\"part_{i}_collision\">\n        <pose>{pose}</pose>\n        \
             <geometry>{geometry}</geometry>\n      </collision>\n      <visual name=\"part_{i}_visual\">\n        \
             <pose>{pose}</pose>\n        <geometry>{geometry}</geometry>\n        <material><ambient>{r} {g} {b} \
             1</ambient><diffuse>{r} {g} {b} 1</diffuse><specular>0.1 0.1 0.1 1</specular></material>\n      \
             </visual>\n",
        );
    }
    out.push_str("    </link>\n  </model>\n</sdf>\n");
    out
}

fn geometry(solid: &Solid) -> (String, String) {
    use crate::shapes::Axis;
    let [x, y, z] = solid.center().map(n);
    match solid {
        Solid::Box { .. } => {
            let [w, d, h] = solid.size().map(n);
            (format!("{x} {y} {z} 0 0 0"), format!("<box><size>{w} {d} {h}</size></box>"))
        }
        Solid::Cylinder { radius, length, axis, .. } => {
            let turn = match axis {
                Axis::X => "0 1.570796 0",
                Axis::Y => "1.570796 0 0",
                Axis::Z => "0 0 0",
            };
            let shape = format!("<cylinder><radius>{}</radius><length>{}</length></cylinder>", n(*radius), n(*length));
            (format!("{x} {y} {z} {turn}"), shape)
        }
        Solid::Sphere { radius, .. } => {
            (format!("{x} {y} {z} 0 0 0"), format!("<sphere><radius>{}</radius></sphere>", n(*radius)))
        }
    }
}

/// Writes a number in at most six decimals.
fn n(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}
