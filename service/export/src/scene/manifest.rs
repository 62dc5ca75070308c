//! What a scene holds, in the form in which checks of simulators read it: `world-manifest/1`.

use d3dgen_model::floorplan::DoorKind;
use serde_json::{Value, json};

use super::{Mobility, SimScene};

impl SimScene {
    /// Returns the manifest of a format, in which `path` is where it has what an id of the scene names.
    pub fn world_manifest(&self, path: impl Fn(&str) -> String) -> Value {
        let rooms =
            self.rooms.iter().map(|r| json!({"path": path(&r.id), "id": r.id, "class": "room", "type": r.class}));
        let doors = self.doors.iter().map(|d| {
            let kind = match d.kind {
                DoorKind::Open => "opening",
                DoorKind::Hinged | DoorKind::DoubleHinged => "hinged",
                DoorKind::Sliding => "sliding",
            };
            json!({"path": path(&d.id), "id": d.id, "class": "door", "type": kind})
        });
        let objects = self.objects.iter().map(|o| {
            let dynamic = o.mobility != Mobility::Fixed;
            json!({"path": path(&o.id), "id": o.id, "class": o.class, "dynamic": dynamic, "mobility": o.mobility.name()})
        });
        json!({
            "format": "world-manifest/1",
            "world": self.name,
            "counts": {"rooms": self.rooms.len(), "doors": self.doors.len(), "objects": self.objects.len()},
            "rooms": rooms.collect::<Vec<_>>(),
            "doors": doors.collect::<Vec<_>>(),
            "objects": objects.collect::<Vec<_>>(),
        })
    }

    /// Returns every id of the scene with what kind of thing it names.
    pub fn ids(&self) -> Vec<(&str, &'static str)> {
        let mut ids: Vec<(&str, &'static str)> = self.rooms.iter().map(|r| (r.id.as_str(), "room")).collect();
        ids.extend(self.walls.iter().map(|w| (w.id.as_str(), "wall")));
        ids.extend(self.doors.iter().map(|d| (d.id.as_str(), "door")));
        ids.extend(self.windows.iter().map(|w| (w.id.as_str(), "window")));
        ids.extend(self.objects.iter().map(|o| (o.id.as_str(), "object")));
        ids.extend(self.lights.iter().map(|l| (l.id.as_str(), "light")));
        ids.extend(self.zones.iter().map(|z| (z.id.as_str(), "zone")));
        ids.extend(self.robots.iter().map(|r| (r.id.as_str(), "robot")));
        ids
    }
}
