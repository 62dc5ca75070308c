//! What Isaac Lab starts from: a scene configuration in Python, and an environment graph of Isaac Lab Arena.

use serde_json::{Value, json};

use crate::file::File;
use crate::scene::{Mobility, SimScene};
use crate::yaml;

/// Returns the files.
pub(super) fn files(scene: &SimScene) -> [File; 2] {
    [
        File::new("usd/isaaclab/arena_env_graph.yaml", yaml::to_string(&graph(scene))),
        File::new("usd/isaaclab/scene_cfg.py", scene_cfg(scene)),
    ]
}

/// Returns the scene in the words of Isaac Lab: the world, its lamps in it, and where robots start.
fn scene_cfg(scene: &SimScene) -> String {
    let class: String = scene.name.split('_').map(capital).collect();
    let starts: Vec<String> = scene
        .robots
        .iter()
        .map(|r| {
            let [x, y, z] = r.start_m;
            let (sin, cos) = (r.yaw_rad / 2.0).sin_cos();
            format!("    \"{}\": (({x:.4}, {y:.4}, {z:.4}), ({cos:.6}, 0.0, 0.0, {sin:.6})),\n", r.id)
        })
        .collect();
    let doors: Vec<String> = scene
        .doors
        .iter()
        .flat_map(|d| {
            d.leaves.iter().map(move |l| format!("    \"{{ENV_REGEX_NS}}/World/Doors/{}/{}\",\n", d.id, l.id))
        })
        .collect();
    format!(
        r#""""Isaac Lab scene of the world `{name}`: give it a robot and step it.

    from scene_cfg import {class}SceneCfg, ROBOT_STARTS
    scene_cfg = {class}SceneCfg(num_envs=1, env_spacing=0.0)
    scene_cfg.robot = MY_ROBOT_CFG.replace(prim_path="{{ENV_REGEX_NS}}/Robot")
    scene_cfg.robot.init_state.pos, scene_cfg.robot.init_state.rot = next(iter(ROBOT_STARTS.values()))
"""

from pathlib import Path

import isaaclab.sim as sim_utils
from isaaclab.assets import AssetBaseCfg
from isaaclab.scene import InteractiveSceneCfg
from isaaclab.utils import configclass

WORLD_USD = str(Path(__file__).resolve().parents[1] / "world.usda")

# Where robots start: position in m, and orientation w, x, y, z.
ROBOT_STARTS = {{
{starts}}}

# Bodies of door leaves; each is held by a joint beside it.
DOOR_LEAVES = [
{doors}]


@configclass
class {class}SceneCfg(InteractiveSceneCfg):
    """The world as it is; its lamps, doors and things are in it."""

    world = AssetBaseCfg(prim_path="{{ENV_REGEX_NS}}/World", spawn=sim_utils.UsdFileCfg(usd_path=WORLD_USD))
"#,
        name = scene.name,
        starts = starts.concat(),
        doors = doors.concat(),
    )
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Returns the environment graph: the world as background, what can be grasped as objects that stand on what they stand on.
fn graph(scene: &SimScene) -> Value {
    let grasped = scene.objects.iter().filter(|o| o.mobility == Mobility::Graspable);
    let references = |id: &str| json!({"id": id, "parent_id": scene.name, "object_type": "rigid", "params": {"prim_path": format!("{{ENV_REGEX_NS}}/World/Objects/{id}")}});
    let mut anchors: Vec<&str> = grasped.clone().filter_map(|o| o.support.as_deref()).collect();
    anchors.sort_unstable();
    anchors.dedup();
    let mut relations: Vec<Value> = anchors.iter().map(|a| json!({"kind": "is_anchor", "subject": a})).collect();
    relations.extend(grasped.clone().filter_map(|o| {
        let support = o.support.as_deref()?;
        Some(json!({"kind": "on", "subject": o.id, "reference": support}))
    }));
    let mut objects: Vec<Value> = anchors
        .iter()
        .map(|a| json!({"id": a, "parent_id": scene.name, "object_type": "base", "params": {"prim_path": format!("{{ENV_REGEX_NS}}/World/Objects/{a}")}}))
        .collect();
    objects.extend(grasped.map(|o| references(&o.id)));
    json!({
        "env_name": scene.name,
        "background": {"id": scene.name, "registry_name": scene.name, "params": {"usd_path": "../world.usda"}},
        "objects": [],
        "object_references": objects,
        "relations": relations,
    })
}
