//! Arena's world folder: `world.yaml`, its map, a default scenario and a model of every object used.
//!
//! Arena finds the world when `ARENA_WORLD_PATH` names the folder `arena/worlds`. One world has one level, `0`.

mod assets;
mod map;
mod scenario;
mod world_yaml;

use d3dgen_model::domain::Domain;
use d3dgen_model::world::World;
use serde_json::{Value, json};

use super::{Exporter, File};
use crate::models::snake;
use crate::{Error, yaml};

/// Writes the Arena bundle.
pub struct Arena;

impl Exporter for Arena {
    fn name(&self) -> &'static str {
        "arena"
    }

    fn about(&self) -> &'static str {
        "Arena world folder: world.yaml, occupancy map, default scenario and USDZ, GLB and SDF models of the objects"
    }

    fn export(&self, world: &World, domain: &Domain) -> Result<Vec<File>, Error> {
        if snake(&world.name) != world.name || world.name.is_empty() {
            let reason = "a world's name is of lower-case letters, digits and underscores".to_owned();
            return Err(Error::Unsupported { exporter: "arena", subject: world.name.clone(), reason });
        }
        let root = format!("arena/worlds/{}", world.name);
        let models = assets::Models::of(world)?;
        let mut files = vec![
            File::new(format!("{root}/0/world.yaml"), yaml::to_string(&world_yaml::level(world, domain, &models)?)),
            File::new(format!("{root}/0/map.png"), map::png(&world.floorplan)?),
            File::new(format!("{root}/0/map.yaml"), yaml::to_string(&map::yaml(&world.floorplan))),
            File::new(format!("{root}/scenarios/default/scenario.yaml"), yaml::to_string(&scenario::scenario(world))),
        ];
        files.extend(models.files(&format!("{root}/assets"), domain)?);
        files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(files)
    }
}

/// Returns a position as Arena writes it.
fn position(x: f64, y: f64, z: f64) -> Value {
    use d3dgen_model::geometry::to_mm;
    json!({"x": to_mm(x), "y": to_mm(y), "z": to_mm(z)})
}

#[cfg(test)]
mod tests;
