//! Open-RMF's building map and navigation graph: walls, doors, lifts over storeys, lanes, chargers, waiting places.
//!
//! `rmf/<name>.building.yaml` is in meters (`cartesian_meters`), in the world's frame; `rmf/nav_graphs/0.yaml` is the graph
//! that fleet adapters read. Storeys are `L1` (the ground floor), `L2`, ... and `B1`, `B2`, ... below it.

mod lifts;

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::floorplan::{Door, DoorKind, Floorplan};
use d3dgen_model::geometry::{Point, to_mm};
use d3dgen_model::scenario::Poi;
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::world::World;
use serde_json::{Map, Value, json};

use super::Exporter;
use crate::error::Error;
use crate::file::File;
use crate::roadmap::{Body, Ground, Lane, Place, Roadmap};
use crate::scene::SimScene;
use crate::subject::Subject;
use crate::yaml;

/// Writes the building map and the navigation graph.
pub struct Rmf;

/// Highest number of a graph.
const MOST_GRAPHS: u32 = 8;

impl Exporter for Rmf {
    fn name(&self) -> &'static str {
        "rmf"
    }

    fn about(&self) -> &'static str {
        "Open-RMF building.yaml with lanes, doors, lifts over storeys, chargers and waiting places, and its navigation graph"
    }

    fn roots(&self) -> &'static [&'static str] {
        &["rmf"]
    }

    fn export(&self, subject: &Subject<'_>) -> Result<Vec<File>, Error> {
        let world = subject.world;
        let building = Building::of(world);
        let plan = &world.floorplan;
        let levels = building.storeys.iter().map(|s| (level_name(s.level), s.document(&building.lifts)));
        let document = json!({
            "name": world.name, "coordinate_system": "cartesian_meters", "graphs": {},
            "levels": levels.collect::<Map<_, _>>(), "lifts": lifts::document(plan, &building.lifts),
        });
        let mut files = vec![File::new(format!("rmf/{}.building.yaml", world.name), yaml::to_string(&document))];
        let graphs: BTreeSet<u32> = building.storeys.iter().filter_map(|s| s.graph).collect();
        for graph in graphs {
            let own = building.storeys.iter().filter(|s| s.graph == Some(graph));
            let levels = own.map(|s| (level_name(s.level), s.graph(&building.lifts))).collect::<Map<_, _>>();
            let document = json!({
                "building_name": world.name, "doors": doors_of_graph(plan, &building.lifts), "levels": levels,
                "lifts": lifts::graph(plan, &building.lifts),
            });
            files.push(File::new(format!("rmf/nav_graphs/{graph}.yaml"), yaml::to_string(&document)));
        }
        files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(files)
    }

    /// Doors and rooms that lanes pass have their names in the building's map; a name is an entry of its own there.
    fn places(&self, scene: &SimScene, files: &[File]) -> Vec<(String, String)> {
        let Some(map) = files.iter().find(|f| f.path.ends_with(".building.yaml")) else { return Vec::new() };
        let text = String::from_utf8_lossy(&map.bytes);
        let entries: BTreeSet<&str> = text.lines().filter_map(|line| line.trim().strip_prefix("- ")).collect();
        let ids = scene.ids().into_iter().filter(|(id, kind)| matches!(*kind, "room" | "door") && entries.contains(id));
        ids.map(|(id, _)| (id.to_owned(), format!("{}#{id}", map.path))).collect()
    }
}

/// The storeys of a world with their lanes, and the lifts that robots ride.
struct Building {
    storeys: Vec<Storey>,
    lifts: BTreeSet<String>,
}

impl Building {
    /// Finds lanes and lifts. Storeys that lifts join have one graph; those that no robot gets to from its dock have none.
    fn of(world: &World) -> Self {
        let body = Body::of(world);
        // with the shafts of its lifts, which on other floors than the ground are no floor to others
        let storeys = world.floorplan.level_numbers().into_iter().map(|level| {
            let world = world.storey(level);
            let roadmap = Roadmap::of(&world, &Ground::of(&world, body));
            Storey { level, roadmap, graph: None, world }
        });
        let mut storeys: Vec<Storey> = storeys.collect();
        let cabin = |s: &Storey, id: &String| {
            s.roadmap.nodes.iter().any(|n| matches!(&n.place, Place::Lift(link) if link == id))
        };
        let links = world.floorplan.links.iter().filter(|l| l.kind == LinkKind::Elevator).map(|l| &l.link_id);
        let rides = |id: &&String| storeys.iter().filter(|s| cabin(s, id)).count() > 1;
        let lifts: BTreeSet<String> = links.filter(rides).cloned().collect();
        // storeys with a lift in common are of one group
        let mut group: Vec<usize> = (0..storeys.len()).collect();
        for id in &lifts {
            let on: Vec<usize> = (0..storeys.len()).filter(|k| cabin(&storeys[*k], id)).collect();
            let least = on.iter().map(|k| group[*k]).min().unwrap_or(0);
            let joined: Vec<usize> = on.iter().map(|k| group[*k]).collect();
            group.iter_mut().filter(|g| joined.contains(g)).for_each(|g| *g = least);
        }
        let docked = |k: &usize| {
            let is_dock =
                |id: &String| storeys[*k].world.scenario.pois.iter().any(|p| &p.poi_id == id && p.kind == Poi::DOCK);
            storeys[*k].roadmap.nodes.iter().any(|n| matches!(&n.place, Place::Poi(id) if is_dock(id)))
        };
        let with_dock: BTreeSet<usize> = (0..storeys.len()).filter(docked).map(|k| group[k]).collect();
        let mut numbers: Vec<usize> = Vec::new();
        for (storey, group) in storeys.iter_mut().zip(group) {
            if with_dock.is_empty() || with_dock.contains(&group) {
                let known = numbers.iter().position(|g| *g == group);
                let number = known.unwrap_or_else(|| {
                    numbers.push(group);
                    numbers.len() - 1
                });
                storey.graph = u32::try_from(number).ok().filter(|n| *n <= MOST_GRAPHS);
            }
            if storey.graph.is_none() {
                storey.roadmap = Roadmap::default();
            }
        }
        // a lift with one stop takes no robot anywhere
        for node in storeys.iter_mut().flat_map(|s| &mut s.roadmap.nodes) {
            if matches!(&node.place, Place::Lift(id) if !lifts.contains(id)) {
                node.place = Place::Corner;
            }
        }
        Self { storeys, lifts }
    }
}

/// Returns the name of a storey.
fn level_name(level: i32) -> String {
    if level < 0 { format!("B{}", -level) } else { format!("L{}", level + 1) }
}

/// Returns the leaves of a plan that are doors to Open-RMF: those of lifts are the lifts' own, and passages have none.
fn leaves<'a>(plan: &'a Floorplan, lifts: &BTreeSet<String>) -> impl Iterator<Item = &'a Door> {
    let shafts: Vec<&String> =
        plan.links.iter().filter(|l| lifts.contains(&l.link_id)).flat_map(|l| &l.room_ids).collect();
    let of_lift = move |d: &&Door| d.room_ids.iter().any(|id| shafts.contains(&id));
    plan.doors.iter().filter(|d| d.kind != DoorKind::Open).filter(move |d| !of_lift(d))
}

/// Returns values as Open-RMF reads them: with a number for their type.
fn text(value: &str) -> Value {
    json!([1, value])
}

fn whole(value: i64) -> Value {
    json!([2, value])
}

fn figure(value: f64) -> Value {
    json!([3, value])
}

fn yes() -> Value {
    json!([4, true])
}

/// Vertices of a level, each point once; those with a name or properties are their own.
#[derive(Default)]
struct Vertices {
    list: Vec<Value>,
    bare: BTreeMap<(i64, i64), usize>,
}

impl Vertices {
    fn point(&mut self, p: Point) -> usize {
        let key = ((p.x * 1000.0).round() as i64, (p.y * 1000.0).round() as i64);
        if let Some(known) = self.bare.get(&key) {
            return *known;
        }
        self.list.push(json!([to_mm(p.x), to_mm(p.y), 0.0, ""]));
        self.bare.insert(key, self.list.len() - 1);
        self.list.len() - 1
    }

    fn named(&mut self, p: Point, name: &str, properties: Map<String, Value>) -> usize {
        self.list.push(json!([to_mm(p.x), to_mm(p.y), 0.0, name, properties]));
        self.list.len() - 1
    }
}

/// A storey on its way out.
struct Storey {
    world: World,
    level: i32,
    roadmap: Roadmap,
    /// Number of the graph of its lanes.
    graph: Option<u32>,
}

impl Storey {
    fn plan(&self) -> &Floorplan {
        &self.world.floorplan
    }

    /// Returns the name of a node, unique in the building, and what it is to a fleet; corners and sides of doors have none.
    fn waypoint(&self, node: usize) -> (String, Map<String, Value>) {
        let mut out = Map::new();
        let node = &self.roadmap.nodes[node];
        let name = match &node.place {
            Place::Poi(id) => {
                let kind = self.world.scenario.pois.iter().find(|p| &p.poi_id == id).map(|p| p.kind.as_str());
                if kind == Some(Poi::DOCK) {
                    for property in ["is_charger", "is_parking_spot", "is_holding_point"] {
                        out.insert(property.into(), yes());
                    }
                    out.insert("dock_name".into(), text(id));
                    let own = self.world.scenario.robots.iter().find(|r| r.dock.as_ref() == Some(id));
                    if let Some(task) = own {
                        out.insert("spawn_robot_name".into(), text(&task.robot_id));
                        out.insert("spawn_robot_type".into(), text(&task.robot.kind));
                    }
                } else if kind == Some(Poi::WAITING_BAY) {
                    out.insert("is_holding_point".into(), yes());
                    out.insert("is_parking_spot".into(), yes());
                }
                id.clone()
            }
            Place::Room(id) => id.clone(),
            Place::Lift(id) => {
                out.insert("lift_cabin".into(), text(id));
                format!("{id}_{}", level_name(self.level))
            }
            Place::Door(_) | Place::Corner => String::new(),
        };
        (name, out)
    }

    /// Returns the level as a building map has it.
    fn document(&self, lifts: &BTreeSet<String>) -> Value {
        let plan = self.plan();
        let mut vertices = Vertices::default();
        let nodes: Vec<usize> = (0..self.roadmap.nodes.len())
            .map(|n| {
                let (name, properties) = self.waypoint(n);
                vertices.named(self.roadmap.nodes[n].at, &name, properties)
            })
            .collect();
        let line = |vertices: &mut Vertices, a: Point, b: Point, properties: Value| {
            json!([vertices.point(a), vertices.point(b), properties])
        };
        let look = json!({
            "alpha": figure(1.0), "texture_height": figure(2.5), "texture_name": text("default"),
            "texture_scale": figure(1.0), "texture_width": figure(1.0),
        });
        let walls: Vec<Value> =
            plan.walls.iter().map(|w| line(&mut vertices, w.line.start, w.line.end, look.clone())).collect();
        let doors: Vec<Value> =
            leaves(plan, lifts).map(|d| line(&mut vertices, d.line.start, d.line.end, motion(d, plan))).collect();
        let floors: Vec<Value> = plan
            .rooms
            .iter()
            .map(|room| {
                let corners: Vec<usize> = room.polygon.corners().iter().map(|p| vertices.point(*p)).collect();
                json!({"parameters": {
                    "ceiling_scale": figure(1.0), "ceiling_texture": text("blue_linoleum"), "indoor": whole(0),
                    "texture_name": text("blue_linoleum"), "texture_rotation": figure(0.0), "texture_scale": figure(1.0),
                }, "vertices": corners})
            })
            .collect();
        let lanes: Vec<Value> = self
            .roadmap
            .lanes
            .iter()
            .map(|lane| {
                json!([nodes[lane.ends[0]], nodes[lane.ends[1]], {
                    "bidirectional": yes(), "graph_idx": whole(i64::from(self.graph.unwrap_or(0))), "orientation": text(""),
                    "speed_limit": figure(lane.max_speed_m_s.unwrap_or(0.0)),
                    "demo_mock_floor_name": text(""), "demo_mock_lift_name": text(""), "mutex": text(""),
                }])
            })
            .collect();
        let elevation = plan.levels.iter().find(|l| l.level == self.level).map_or(0.0, |l| l.elevation_m);
        json!({
            "elevation": elevation, "vertices": vertices.list, "walls": walls, "doors": doors, "floors": floors,
            "lanes": lanes, "models": [], "layers": {}, "fiducials": [], "measurements": [],
        })
    }

    /// Returns the level as a navigation graph has it: every lane once for each direction.
    fn graph(&self, lifts: &BTreeSet<String>) -> Value {
        let vertices: Vec<Value> = self
            .roadmap
            .nodes
            .iter()
            .enumerate()
            .map(|(n, node)| {
                let (name, typed) = self.waypoint(n);
                let mut properties = Map::from_iter([("name".to_owned(), json!(name))]);
                // a graph has the bare values, and robots and docks stand elsewhere
                for (key, value) in typed {
                    let key = if key == "lift_cabin" { "lift".to_owned() } else { key };
                    if !key.starts_with("spawn_") && key != "dock_name" {
                        properties.insert(key, value[1].clone());
                    }
                }
                json!([to_mm(node.at.x), to_mm(node.at.y), properties])
            })
            .collect();
        let dock = |n: usize| match &self.roadmap.nodes[n].place {
            Place::Poi(id) if self.waypoint(n).1.contains_key("dock_name") => Some(id.clone()),
            _ => None,
        };
        let doors: Vec<&str> = leaves(self.plan(), lifts).map(|d| d.door_id.as_str()).collect();
        let directed = |lane: &Lane| {
            let [a, b] = lane.ends;
            [(a, b), (b, a)].map(|(from, to)| {
                let mut properties = Map::new();
                if let Some(door) = lane.door.as_ref().filter(|d| doors.contains(&d.as_str())) {
                    properties.insert("door_name".into(), json!(door));
                }
                if let Some(dock) = dock(to) {
                    properties.insert("dock_name".into(), json!(dock));
                }
                if let Some(dock) = dock(from) {
                    properties.insert("undock_name".into(), json!(dock));
                }
                if let Some(speed) = lane.max_speed_m_s {
                    properties.insert("speed_limit".into(), json!(speed));
                }
                json!([from, to, properties])
            })
        };
        let lanes: Vec<Value> = self.roadmap.lanes.iter().flat_map(directed).collect();
        json!({"lanes": lanes, "vertices": vertices})
    }
}

/// Returns how a door moves.
fn motion(door: &Door, plan: &Floorplan) -> Value {
    let kind = match door.kind {
        DoorKind::Hinged => "hinged",
        DoorKind::DoubleHinged => "double_hinged",
        DoorKind::Sliding | DoorKind::Open => "sliding",
    };
    let at_start = door.swing.as_ref().is_none_or(|s| s.hinge_at_start);
    // the leaf turns to the left of who looks along the door from its hinge, or to the right
    let into = door.swing.as_ref().and_then(|s| s.into_room_id.as_deref()).and_then(|id| plan.room(id));
    let (s, e, m) = (door.line.start, door.line.end, door.line.middle());
    let length = door.line.length().max(1e-9);
    let beside = door.wall_thickness_m / 2.0 + 0.05;
    let left = Point::new(m.x - (e.y - s.y) / length * beside, m.y + (e.x - s.x) / length * beside);
    let to_left = match (into, door.swing.is_some()) {
        (Some(room), _) => room.polygon.contains(left),
        (None, true) => !plan.rooms.iter().any(|r| r.polygon.contains(left)),
        (None, false) => true,
    };
    json!({
        "name": text(&door.door_id), "type": text(kind), "motion_axis": text(if at_start { "start" } else { "end" }),
        "motion_degrees": figure(90.0), "motion_direction": whole(if to_left == at_start { 1 } else { -1 }),
        "plugin": text("normal"), "right_left_ratio": figure(1.0),
    })
}

/// Returns the doors of all storeys by name, with their ends.
fn doors_of_graph(plan: &Floorplan, lifts: &BTreeSet<String>) -> Value {
    let ends =
        |d: &Door| json!([[to_mm(d.line.start.x), to_mm(d.line.start.y)], [to_mm(d.line.end.x), to_mm(d.line.end.y)]]);
    let level = |d: &Door| d.room_ids.iter().find_map(|id| plan.room(id)).map_or(0, |r| r.level);
    let entry = |d: &Door| (d.door_id.clone(), json!({"endpoints": ends(d), "map": level_name(level(d))}));
    Value::Object(leaves(plan, lifts).map(entry).collect())
}

#[cfg(test)]
mod tests;
