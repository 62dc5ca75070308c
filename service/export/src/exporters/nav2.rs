//! What nav2 needs to drive robots through a world: maps, masks, docks, a route graph, parameters, a launch file.
//!
//! Every storey has a folder of its own (`nav2/0/` is the ground floor). The map is what a robot as high as those of the
//! world finds: what hangs above it leaves the floor free. The frame is the world's, in meters.

use std::collections::BTreeSet;

use d3dgen_model::geometry::{Point, Pose, to_mm};
use d3dgen_model::occupancy::CELL_M;
use d3dgen_model::scenario::{Poi, RoiKind};
use d3dgen_model::world::World;
use serde_json::{Value, json};

use super::Exporter;
use crate::error::Error;
use crate::file::File;
use crate::roadmap::{Body, Ground, Place, Roadmap};
use crate::scene::SimScene;
use crate::subject::Subject;
use crate::yaml;

/// Writes the nav2 folder.
pub struct Nav2;

/// Cells of black frame around the floor.
const FRAME: usize = 5;
/// Largest side of a map, px: 500 m of building.
const LIMIT: usize = 10_000;
/// Grays of a map: free, and what is there.
const FREE: u8 = 254;
const OCCUPIED: u8 = 0;
/// Speed that a limit of 100 % means, m/s: what the robots of `params.yaml` drive at most.
const FULL_SPEED_M_S: f64 = 1.0;
/// How far before a dock nav2 begins to drive up to it, m.
const STAGING_M: f64 = 0.7;
/// Speed limits of a mask and of lanes, percent: 0 would mean none.
const LIMITS: [f64; 2] = [1.0, 100.0];

impl Exporter for Nav2 {
    fn name(&self) -> &'static str {
        "nav2"
    }

    fn about(&self) -> &'static str {
        "nav2 folder: map for the robot at hand, keep-out and speed masks, docks, route graph, parameters and a launch file"
    }

    fn roots(&self) -> &'static [&'static str] {
        &["nav2"]
    }

    fn export(&self, subject: &Subject<'_>) -> Result<Vec<File>, Error> {
        let world = subject.world;
        let body = Body::of(world);
        let mut files = vec![File::new("nav2/nav2.launch.py", include_str!("nav2/nav2.launch.py"))];
        for (level, storey) in &world.storeys() {
            let at = |name: &str| format!("nav2/{level}/{name}");
            let ground = Ground::of(storey, body);
            let roadmap = Roadmap::of(storey, &ground);
            let raster = Raster::of(&ground);
            let mut layer = |name: &str, scale: bool, gray: &dyn Fn(usize, usize) -> u8| -> Result<(), Error> {
                files.push(File::new(at(&format!("{name}.png")), raster.png(gray)?));
                files.push(File::new(at(&format!("{name}.yaml")), yaml::to_string(&raster.yaml(name, scale))));
                Ok(())
            };
            layer("map", false, &|i, j| if ground.occupancy.free.get(i, j) { FREE } else { OCCUPIED })?;
            layer("keepout_mask", false, &|i, j| if ground.kept_out.get(i, j) { OCCUPIED } else { FREE })?;
            let slow = slow_floor(storey, &ground);
            layer("speed_mask", true, &|i, j| slow[j * ground.occupancy.frame.nx + i])?;
            if let Some(docks) = docks(storey, &ground) {
                files.push(File::new(at("docks.yaml"), yaml::to_string(&docks)));
            }
            if !roadmap.lanes.is_empty() {
                files.push(File::new(at("route_graph.geojson"), graph(&roadmap).to_string() + "\n"));
            }
            files.push(File::new(at("params.yaml"), params(storey, body)));
        }
        files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(files)
    }

    /// Rooms and doors that robots get to are nodes of a route graph.
    fn places(&self, scene: &SimScene, files: &[File]) -> Vec<(String, String)> {
        let known: BTreeSet<&str> = scene.ids().into_iter().map(|(id, _)| id).collect();
        let mut places = Vec::new();
        for file in files.iter().filter(|f| f.path.ends_with(".geojson")) {
            let graph: Value = serde_json::from_slice(&file.bytes).unwrap_or_default();
            for node in graph["features"].as_array().into_iter().flatten().map(|f| &f["properties"]) {
                if let Some(name) = node["metadata"]["name"].as_str().filter(|name| known.contains(name)) {
                    places.push((name.to_owned(), format!("{}#{}", file.path, node["id"])));
                }
            }
        }
        places
    }
}

/// The cells of a storey's floor with a frame around them.
struct Raster {
    origin: Point,
    nx: usize,
    ny: usize,
}

impl Raster {
    fn of(ground: &Ground) -> Self {
        let frame = &ground.occupancy.frame;
        let edge = FRAME as f64 * CELL_M;
        let origin = Point::new(frame.origin.x - edge, frame.origin.y - edge);
        Self { origin, nx: frame.nx + 2 * FRAME, ny: frame.ny + 2 * FRAME }
    }

    /// Returns the description of a picture: `scale` for masks whose gray is a figure.
    fn yaml(&self, name: &str, scale: bool) -> Value {
        let (mode, occupied, free) = if scale { ("scale", 1.0, 0.0) } else { ("trinary", 0.65, 0.196) };
        json!({
            "image": format!("{name}.png"), "mode": mode, "resolution": CELL_M,
            "origin": [to_mm(self.origin.x), to_mm(self.origin.y), 0.0], "negate": 0,
            "occupied_thresh": occupied, "free_thresh": free,
        })
    }

    /// Returns a picture of the cells, the northernmost row first; the frame has the gray of its kind of nothing.
    ///
    /// # Errors
    /// `TooLarge` when a side would pass the limit.
    fn png(&self, gray: &dyn Fn(usize, usize) -> u8) -> Result<Vec<u8>, Error> {
        let picture = "map.png";
        let (width, height) = (self.nx, self.ny);
        if width.max(height) > LIMIT {
            return Err(Error::TooLarge { picture, width, height, limit: LIMIT });
        }
        // what is beyond the floor is as the corner of the grid, where no floor is either
        let beyond = gray(0, 0);
        let mut pixels = vec![beyond; width * height];
        for j in 0..height - 2 * FRAME {
            let row = (height - 1 - FRAME - j) * width + FRAME;
            for i in 0..width - 2 * FRAME {
                pixels[row + i] = gray(i, j);
            }
        }
        crate::picture::gray(picture, &pixels, width, height)
    }
}

/// Returns by cell the gray that tells how much slower than usual a robot drives there: white where no limit is.
fn slow_floor(storey: &World, ground: &Ground) -> Vec<u8> {
    let frame = &ground.occupancy.frame;
    let mut out = vec![255; frame.nx * frame.ny];
    for roi in storey.scenario.rois.iter().filter(|r| r.kind == RoiKind::SpeedZone) {
        let Some(limit) = roi.max_speed_m_s.and_then(percent) else { continue };
        // the mask says by how many percent the speed is less
        let gray = (255.0 * limit / 100.0).round() as u8;
        for (i, j) in frame.cells(&roi.polygon.bounds()) {
            if roi.polygon.contains(frame.center(i, j)) {
                let cell = &mut out[j * frame.nx + i];
                *cell = gray.min(*cell);
            }
        }
    }
    out
}

/// Returns a speed as a share of the full one, percent; none where it is no limit.
fn percent(speed_m_s: f64) -> Option<f64> {
    let share = 100.0 * speed_m_s / FULL_SPEED_M_S;
    (share < LIMITS[1]).then(|| share.max(LIMITS[0]))
}

/// Returns the docks that a robot can drive up to, in the form of nav2's docking server.
fn docks(storey: &World, ground: &Ground) -> Option<Value> {
    let mut docks = serde_json::Map::new();
    for poi in storey.scenario.pois.iter().filter(|p| p.kind == Poi::DOCK) {
        let Some(yaw) = approach(&poi.pose, ground) else { continue };
        let (pose, id) = (json!([to_mm(poi.pose.x), to_mm(poi.pose.y), (yaw * 1e4).round() / 1e4]), &poi.poi_id);
        docks.insert(id.clone(), json!({"type": "charging_dock", "frame": "map", "pose": pose, "id": id}));
    }
    (!docks.is_empty()).then(|| json!({"docks": docks}))
}

/// Returns the heading in which a robot drives up to a dock, rad: from where the largest robot has room to turn.
fn approach(pose: &Pose, ground: &Ground) -> Option<f64> {
    use std::f64::consts::{PI, TAU};
    let at = Point::new(pose.x, pose.y);
    let clear = |yaw: &f64| {
        let staging = Point::new(at.x - STAGING_M * yaw.cos(), at.y - STAGING_M * yaw.sin());
        if ground.along(staging, at) > 0.0 { ground.clearance(staging) } else { 0.0 }
    };
    let turned = |yaw: f64| (yaw + PI).rem_euclid(TAU) - PI;
    let headings = [turned(pose.yaw_rad), turned(pose.yaw_rad + PI)];
    headings
        .into_iter()
        .map(|yaw| (clear(&yaw), yaw))
        .filter(|(c, _)| *c >= ground.radius_m())
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|b| b.1)
}

/// Returns the roadmap as the graph of nav2's route server: every lane once for each direction.
fn graph(roadmap: &Roadmap) -> Value {
    let point = |p: Point| json!([to_mm(p.x), to_mm(p.y)]);
    let mut features: Vec<Value> = Vec::new();
    for (id, node) in roadmap.nodes.iter().enumerate() {
        let mut metadata = serde_json::Map::new();
        let (kind, named) = match &node.place {
            Place::Poi(id) => ("poi", id.as_str()),
            Place::Door(id) => ("door", id.as_str()),
            Place::Lift(id) => ("lift", id.as_str()),
            Place::Room(id) => ("room", id.as_str()),
            Place::Corner => ("corner", ""),
        };
        metadata.insert("class".into(), json!(kind));
        if !named.is_empty() {
            metadata.insert("name".into(), json!(named));
        }
        features.push(json!({
            "type": "Feature", "properties": {"id": id, "frame": "map", "metadata": metadata},
            "geometry": {"type": "Point", "coordinates": point(node.at)},
        }));
    }
    // programs that show graphs take one id for one thing
    let mut id = roadmap.nodes.len();
    for lane in &roadmap.lanes {
        let [a, b] = lane.ends;
        for (from, to) in [(a, b), (b, a)] {
            let mut metadata = serde_json::Map::new();
            if let Some(limit) = lane.max_speed_m_s.and_then(percent) {
                metadata.insert("speed_limit".into(), json!(limit));
            }
            if let Some(door) = &lane.door {
                metadata.insert("door".into(), json!(door));
            }
            let [start, end] = [from, to].map(|n| point(roadmap.nodes[n].at));
            features.push(json!({
                "type": "Feature",
                "properties": {"id": id, "startid": from, "endid": to, "overridable": true, "metadata": metadata},
                "geometry": {"type": "MultiLineString", "coordinates": [[start, end]]},
            }));
            id += 1;
        }
    }
    json!({"type": "FeatureCollection", "name": "route_graph", "features": features})
}

/// Returns the parameters of the servers that the launch file starts; it puts the paths of the files in.
fn params(storey: &World, body: Body) -> String {
    let start = storey.scenario.robots.first().map(|r| r.start);
    let (x, y, yaw) = start.map_or((0.0, 0.0, 0.0), |p| (to_mm(p.x), to_mm(p.y), (p.yaw_rad * 1e4).round() / 1e4));
    include_str!("nav2/params.yaml")
        .replace("ROBOT_RADIUS", &format!("{:.3}", body.radius_m))
        .replace("INFLATION_RADIUS", &format!("{:.3}", body.radius_m + 0.3))
        .replace("FULL_SPEED", &format!("{FULL_SPEED_M_S:.1}"))
        .replace("STAGING", &format!("{:.2}", -STAGING_M))
        .replace("START_X", &format!("{x:.3}"))
        .replace("START_YAW", &format!("{yaw:.4}"))
        .replace("START_Y", &format!("{y:.3}"))
}

#[cfg(test)]
mod tests;
