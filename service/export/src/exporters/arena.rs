//! Arena's world folder: `world.yaml`, its map, a default scenario and a model of every object used.
//!
//! Arena finds the world when `ARENA_WORLD_PATH` names the folder `arena/worlds`. Every storey is a level: `0`
//! is the ground floor, and stairwells and shafts above it are no zones but the ways in.

mod map;
mod scenario;
mod surfaces;
mod world_yaml;

use d3dgen_model::floorplan::DoorKind;
use serde_json::{Value, json};

use super::Exporter;
use crate::error::Error;
use crate::file::File;
use crate::models::snake;
use crate::scene::SimScene;
use crate::subject::Subject;
use crate::used::UsedModels;
use crate::yaml;

/// Writes the Arena bundle.
pub struct Arena;

impl Exporter for Arena {
    fn name(&self) -> &'static str {
        "arena"
    }

    fn about(&self) -> &'static str {
        "Arena world folder: world.yaml, occupancy map, default scenario and USDZ, GLB and SDF models of the objects"
    }

    fn roots(&self) -> &'static [&'static str] {
        &["arena"]
    }

    fn is_usual(&self) -> bool {
        true
    }

    fn export(&self, subject: &Subject<'_>) -> Result<Vec<File>, Error> {
        let Subject { world, domain, kept, .. } = *subject;
        if snake(&world.name) != world.name || world.name.is_empty() {
            let reason = "a world's name is of lower-case letters, digits and underscores".to_owned();
            return Err(Error::Unsupported { exporter: "arena", subject: world.name.clone(), reason });
        }
        let root = format!("arena/worlds/{}", world.name);
        let models = UsedModels::of(world, domain, kept)?;
        let storeys = world.storeys();
        let ground = storeys.iter().find(|(level, _)| *level == 0).map_or(world, |(_, storey)| storey);
        let default = yaml::to_string(&scenario::scenario(ground));
        let mut files = vec![File::new(format!("{root}/scenarios/default/scenario.yaml"), default)];
        for (level, storey) in &storeys {
            let (at, plan) = (format!("{root}/{level}"), &storey.floorplan);
            let document = yaml::to_string(&world_yaml::level(storey, domain, &models)?);
            files.push(File::new(format!("{at}/world.yaml"), document));
            files.push(File::new(format!("{at}/map.png"), map::png(plan)?));
            files.push(File::new(format!("{at}/map.yaml"), yaml::to_string(&map::yaml(plan))));
            if *level != 0 {
                let document = yaml::to_string(&scenario::scenario(storey));
                files.push(File::new(format!("{root}/scenarios/level_{level}/scenario.yaml"), document));
            }
        }
        let assets = format!("{root}/assets");
        files.extend(models.files(&assets, domain, kept)?);
        files.extend(surfaces::files(world, &assets));
        files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(files)
    }

    fn places(&self, scene: &SimScene, _: &[File]) -> Vec<(String, String)> {
        let file = |level: i32| format!("arena/worlds/{}/{level}/world.yaml", scene.name);
        let rooms = scene.rooms.iter().map(|r| (&r.id, r.level, "zones", r.room_id.clone()));
        let doors = scene.doors.iter().filter(|d| d.kind != DoorKind::Open || d.room_ids.len() == 1);
        let doors = doors.map(|d| (&d.id, d.level, "doors", snake(&d.id)));
        let things = scene.objects.iter().map(|o| (&o.id, o.level, "entities", o.id.clone()));
        let all = rooms.chain(doors).chain(things);
        all.map(|(id, level, list, name)| (id.clone(), format!("{}#{list}/{name}", file(level)))).collect()
    }
}

/// Returns a position as Arena writes it.
fn position(x: f64, y: f64, z: f64) -> Value {
    use d3dgen_model::geometry::to_mm;
    json!({"x": to_mm(x), "y": to_mm(y), "z": to_mm(z)})
}

#[cfg(test)]
mod tests;
