//! The surfaces that a world names, as materials beside its models: MDL for Isaac Sim, with pictures that any other reader can
//! use by their names.

use std::collections::BTreeSet;
use std::fmt::Write;

use d3dgen_mesh::finish::{self, Finish};
use d3dgen_model::world::World;

use crate::file::File;

/// Returns the files of every surface of a world under `root`.
pub(super) fn files(world: &World, root: &str) -> Vec<File> {
    let rooms = world.floorplan.rooms.iter().map(|r| &r.materials);
    let names: BTreeSet<&String> = rooms.flat_map(|m| [&m.floor, &m.wall, &m.ceiling]).collect();
    // Names become those of files; what a path could not hold is no name of a material.
    let is_word = |n: &&&String| !n.is_empty() && n.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    names.iter().filter(is_word).flat_map(|name| surface(name, root)).collect()
}

fn surface(name: &str, root: &str) -> Vec<File> {
    let finish = finish::named(name);
    let folder = format!("{root}/Common/Material/{name}");
    let mut files = vec![File::new(format!("{folder}/{name}.mdl"), mdl(name, finish))];
    if finish.is_drawn() {
        let pictures = finish.pictures();
        files.push(File::new(format!("{folder}/{name}.png"), pictures.color.clone()));
        if let Some(normal) = &pictures.normal {
            files.push(File::new(format!("{folder}/{name}_normal.png"), normal.clone()));
        }
    }
    files
}

/// Returns the material in NVIDIA's Material Definition Language: OmniPBR, projected along the axes of the world at its real
/// size.
fn mdl(name: &str, finish: &Finish) -> String {
    let [r, g, b] = finish.mean();
    let [u, v] = finish.size_m.map(|s| 1.0 / s);
    let mut lines = String::new();
    if finish.is_drawn() {
        let _ = writeln!(lines, "    diffuse_texture: texture_2d(\"./{name}.png\", ::tex::gamma_srgb),");
        if finish.pictures().normal.is_some() {
            let _ = writeln!(lines, "    normalmap_texture: texture_2d(\"./{name}_normal.png\", ::tex::gamma_linear),");
        }
    } else {
        let _ = writeln!(lines, "    diffuse_color_constant: color({r:.4}f, {g:.4}f, {b:.4}f),");
    }
    if finish.opacity < 1.0 {
        let _ = writeln!(lines, "    enable_opacity: true,\n    opacity_constant: {:.2}f,", finish.opacity);
    }
    format!(
        "mdl 1.6;\n\nimport ::OmniPBR::OmniPBR;\nimport ::anno::*;\nimport ::tex::gamma_mode;\n\nexport material {name}(*)\n[[\n    \
         ::anno::display_name(\"{name}\")\n]]\n = ::OmniPBR::OmniPBR(\n{lines}    reflection_roughness_constant: {:.2}f,\n    \
         metallic_constant: {:.1}f,\n    project_uvw: true,\n    world_or_object: true,\n    texture_scale: float2({u:.4}f, {v:.4}f)\n);\n",
        finish.roughness, finish.metallic,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn every_surface_of_a_world_is_a_material_with_its_pictures() {
        let world = sample::world();
        let all = files(&world, "assets");
        for room in &world.floorplan.rooms {
            for name in [&room.materials.floor, &room.materials.wall, &room.materials.ceiling] {
                let path = format!("assets/Common/Material/{name}/{name}.mdl");
                let file = all.iter().find(|f| f.path == path).unwrap_or_else(|| panic!("{path} is missing"));
                let text = String::from_utf8_lossy(&file.bytes);
                assert!(text.contains(&format!("export material {name}(*)")));
                for named in text.split("\"./").skip(1).filter_map(|t| t.split('"').next()) {
                    let beside = format!("assets/Common/Material/{name}/{named}");
                    assert!(all.iter().any(|f| f.path == beside), "{beside} is missing");
                }
            }
        }
    }
}
