//! Pictures of a world in three dimensions: from above with the ceiling off, and from inside each room.
//!
//! The same world gives the same pictures. Where the eye stands in a room is chosen: where it sees most of it.

use d3dgen_mesh::World3d;
use d3dgen_mesh::picture::studio::{Camera, Daylight, Effort, Studio};
use d3dgen_mesh::world3d::Node;
use d3dgen_model::geometry::{Point, Rect};

use crate::error::Error;
use crate::file::File;
use crate::scene::{SimRoom, SimScene};
use crate::view::{CEILING, storey_layer};

/// Which pictures are wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    /// Width and height, px.
    pub size_px: [usize; 2],
    /// Work for each picture.
    pub effort: Effort,
    /// Height of the eye in rooms above the floor, m.
    pub eye_m: f64,
    /// Lamps on, no sun.
    pub night: bool,
    /// Room ids of the pictures from inside; none for all rooms.
    pub rooms: Option<Vec<String>>,
    /// Pictures from above.
    pub overview: bool,
}

/// A picture to be taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Shot {
    /// Name of its file without extension: `overview`, `overview_level_1`, `room_kitchen`.
    pub name: String,
    /// From where.
    pub camera: Camera,
    /// From above: the layers that are taken off.
    hidden: Option<Vec<String>>,
}

/// Angle of view from the lower to the upper edge in rooms and from above, degrees.
const ROOM_VIEW_DEG: f64 = 62.0;
const ABOVE_VIEW_DEG: f64 = 30.0;
/// Direction from the middle of a building to the eye above it.
const ABOVE: [f64; 3] = [0.30, -0.62, 1.5];
/// Share of the picture that a building takes.
const FILLS: f64 = 0.93;
/// Distance between places where the eye could stand, and its least distance to anything, m.
const STEP_M: f64 = 0.4;
const ELBOW_M: f64 = 0.28;
/// How far the eye looks down, m over m.
const DOWN: f64 = 0.22;
/// What is farther than this is seen no better, and what is nearer hides the room, m.
const FAR_M: f64 = 7.0;
const NEAR_M: f64 = 0.9;
/// What a ray ends this far before is still in the room, m.
const WALL_M: f64 = 0.1;
/// How far doors stand open in pictures from above.
const AJAR: f64 = 0.75;

/// Takes the pictures, one after the other; `done` gets each with how many there will be, and may stop by an error.
///
/// # Errors
/// `Unsupported` when a room is asked for that is not there, `Model` when a picture cannot be written; those of `done`.
pub fn pictures<E: From<Error>>(
    scene: &SimScene,
    world: &World3d,
    wish: &Wish,
    done: &mut dyn FnMut(File, usize) -> Result<(), E>,
) -> Result<(), E> {
    let doors: Vec<&str> = scene.doors.iter().map(|d| d.id.as_str()).collect();
    let ajar = |node: &Node| match &node.motion {
        Some(motion) if doors.contains(&motion.name.as_str()) => AJAR,
        _ => 0.0,
    };
    let inside = Studio::new(world, &[], &|_| 0.0);
    let shots = shots(scene, &inside, wish)?;
    let daylight = if wish.night { Daylight::night() } else { Daylight::day() };
    for shot in &shots {
        let picture = match &shot.hidden {
            Some(hidden) => {
                let hidden: Vec<&str> = hidden.iter().map(String::as_str).collect();
                Studio::new(world, &hidden, &ajar).picture(&shot.camera, &daylight, wish.effort)
            }
            None => inside.picture(&shot.camera, &daylight, wish.effort),
        };
        let bytes = picture.png().map_err(Error::from)?;
        done(File::new(format!("{}.png", shot.name), bytes), shots.len())?;
    }
    Ok(())
}

/// Returns the pictures that are to be taken: those from above first.
///
/// # Errors
/// `Unsupported` when a room is asked for that is not there.
pub fn shots(scene: &SimScene, studio: &Studio, wish: &Wish) -> Result<Vec<Shot>, Error> {
    let missing = |id: &&String| !scene.rooms.iter().any(|r| &r.room_id == *id);
    if let Some(id) = wish.rooms.iter().flatten().find(missing) {
        return Err(Error::Unsupported {
            exporter: "render",
            subject: scene.name.clone(),
            reason: format!("has no room `{id}`"),
        });
    }
    let mut shots = Vec::new();
    if wish.overview {
        shots.extend(scene.storeys.iter().filter_map(|s| above(scene, s.level, wish)));
    }
    let wanted = |room: &&SimRoom| match &wish.rooms {
        Some(ids) => ids.contains(&room.room_id),
        None => !room.outdoor && !room.ceiling.is_empty(),
    };
    shots.extend(scene.rooms.iter().filter(wanted).map(|room| Shot {
        name: format!("room_{}", room.id),
        camera: within(scene, studio, room, wish),
        hidden: None,
    }));
    Ok(shots)
}

/// Returns the picture of a storey from above, without what is over it.
fn above(scene: &SimScene, level: i32, wish: &Wish) -> Option<Shot> {
    let rooms = scene.rooms.iter().filter(|r| r.level == level);
    let bounds = rooms.clone().map(|r| r.net.bounds()).reduce(|a, b| a.union(&b))?.grown(0.3);
    let floor = scene.storeys.iter().find(|s| s.level == level)?.elevation_m;
    let top = rooms.map(|r| r.ceiling_m).fold(2.4, f64::max);
    let mut hidden = vec![CEILING.to_owned()];
    hidden.extend(scene.storeys.iter().filter(|s| s.level > level).map(|s| storey_layer(s.level)));
    let name = if scene.storeys.len() == 1 { "overview".to_owned() } else { format!("overview_level_{level}") };
    Some(Shot { name, camera: fitted(&bounds, [floor, floor + top], wish.size_px), hidden: Some(hidden) })
}

/// Returns the camera that sees a box from above as large as it fits.
fn fitted(bounds: &Rect, z: [f64; 2], size_px: [usize; 2]) -> Camera {
    let middle = bounds.center();
    let center = [middle.x, middle.y, z[0]];
    let length = ABOVE.iter().map(|v| v * v).sum::<f64>().sqrt();
    // A building that is deeper than wide is seen from its long side.
    let from = if bounds.height() > 1.3 * bounds.width() { [0.62, -0.30, ABOVE[2]] } else { ABOVE };
    let toward = from.map(|v| v / length);
    let flat = toward[0].hypot(toward[1]);
    let right = [-toward[1] / flat, toward[0] / flat, 0.0];
    let up = [-toward[2] * right[1], toward[2] * right[0], toward[0] * right[1] - toward[1] * right[0]];
    let up = up.map(|v| if up[2] < 0.0 { -v } else { v });
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let tall = (ABOVE_VIEW_DEG / 2.0).to_radians().tan();
    let wide = tall * size_px[0] as f64 / size_px[1].max(1) as f64;
    let corners = bounds.corners();
    let corners = corners.iter().flat_map(|p| z.map(|z| [p.x - center[0], p.y - center[1], z - center[2]]));
    let corners: Vec<[f64; 3]> = corners.collect();
    // The least distance at which every corner is in the picture, when the middle of what is seen is in its middle.
    let mut shift = [0.0; 2];
    let mut distance = 1.0;
    for _ in 0..8 {
        let needs = |c: &[f64; 3]| {
            let (x, y, near) = (dot(*c, right) - shift[0], dot(*c, up) - shift[1], dot(*c, toward));
            near + (x.abs() / wide).max(y.abs() / tall) / FILLS
        };
        distance = corners.iter().map(needs).fold(1.0, f64::max);
        for (k, axis) in [right, up].into_iter().enumerate() {
            let seen = |c: &[f64; 3]| (dot(*c, axis) - shift[k]) / (distance - dot(*c, toward));
            let low = corners.iter().map(seen).fold(f64::MAX, f64::min);
            let high = corners.iter().map(seen).fold(f64::MIN, f64::max);
            shift[k] += (low + high) / 2.0 * distance;
        }
    }
    let target: [f64; 3] = std::array::from_fn(|i| center[i] + right[i] * shift[0] + up[i] * shift[1]);
    let eye = std::array::from_fn(|i| target[i] + toward[i] * distance);
    Camera { eye, target, view_deg: ABOVE_VIEW_DEG, size_px }
}

/// Returns the camera that sees most of a room from inside.
fn within(scene: &SimScene, studio: &Studio, room: &SimRoom, wish: &Wish) -> Camera {
    let height = room.floor_m + wish.eye_m.clamp(0.1, (room.ceiling_m - 0.25).max(0.15));
    let bounds = room.net.bounds();
    let middle = interest(scene, room);
    let camera = |p: Point, toward: [f64; 2]| Camera {
        eye: [p.x, p.y, height],
        target: [p.x + toward[0], p.y + toward[1], height - DOWN * wish.eye_m.min(1.6) / 1.6],
        view_deg: ROOM_VIEW_DEG,
        size_px: wish.size_px,
    };
    let mut best: Option<(f64, Camera)> = None;
    let steps = |length: f64| ((length / STEP_M).floor() as usize).clamp(1, 40);
    let (columns, rows) = (steps(bounds.width()), steps(bounds.height()));
    for i in 0..=columns {
        for j in 0..=rows {
            let share = |k: usize, n: usize, from: f64, to: f64| {
                from + ELBOW_M + (to - from - 2.0 * ELBOW_M) * k as f64 / n as f64
            };
            let p = Point::new(share(i, columns, bounds.x0, bounds.x1), share(j, rows, bounds.y0, bounds.y1));
            if !room.net.contains(p) || !has_elbow_room(studio, p, height) {
                continue;
            }
            let (dx, dy) = (middle.x - p.x, middle.y - p.y);
            let way = dx.hypot(dy);
            if way < 0.3 {
                continue;
            }
            let candidate = camera(p, [dx / way, dy / way]);
            let seen = seen(studio, room, &candidate);
            if best.as_ref().is_none_or(|(most, _)| seen > *most) {
                best = Some((seen, candidate));
            }
        }
    }
    let anywhere = || camera(Point::new(bounds.x0 + ELBOW_M, bounds.y0 + ELBOW_M), [0.7, 0.7]);
    best.map_or_else(anywhere, |(_, camera)| camera)
}

/// Returns the middle of what stands in a room and of the room itself.
fn interest(scene: &SimScene, room: &SimRoom) -> Point {
    let center = room.net.bounds().center();
    let here: Vec<_> = scene.objects.iter().filter(|o| o.room_id == room.room_id).collect();
    let count = here.len() as f64;
    let mean =
        |k: usize, own: f64| (here.iter().map(|o| o.at_m[k]).sum::<f64>() + own * (count + 1.0)) / (2.0 * count + 1.0);
    Point::new(mean(0, center.x), mean(1, center.y))
}

fn has_elbow_room(studio: &Studio, p: Point, height: f64) -> bool {
    (0..8).all(|k| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
        let reach = studio.reach([p.x, p.y, height], [p.x + cos, p.y + sin, height]);
        reach.is_none_or(|d| d > ELBOW_M * 0.8)
    })
}

/// Returns how much a camera sees: how far it sees in all directions of its picture, less for what is right before it.
fn seen(studio: &Studio, room: &SimRoom, camera: &Camera) -> f64 {
    let [w, h] = camera.size_px;
    let tall = (camera.view_deg / 2.0).to_radians().tan();
    let wide = tall * w as f64 / h.max(1) as f64;
    let (dx, dy, dz) =
        (camera.target[0] - camera.eye[0], camera.target[1] - camera.eye[1], camera.target[2] - camera.eye[2]);
    let mut sum = 0.0;
    for column in -4..=4 {
        for row in -2..=2 {
            let (u, v) = (f64::from(column) / 4.0 * wide, f64::from(row) / 2.0 * tall);
            let toward = [dx + dy * u, dy - dx * u, dz + v].map(|c| c * 10.0);
            let target = std::array::from_fn(|i| camera.eye[i] + toward[i]);
            let reach = studio.reach(camera.eye, target).unwrap_or(FAR_M).min(FAR_M);
            let length = toward.iter().map(|c| c * c).sum::<f64>().sqrt();
            let [x, y] = [0, 1].map(|k| camera.eye[k] + toward[k] / length * (reach - WALL_M).max(0.0));
            // What is seen through a doorway is another room.
            let within = if room.net.contains(Point::new(x, y)) { 1.0 } else { 0.3 };
            sum += within * if reach < NEAR_M { reach - 2.0 * (NEAR_M - reach) - 2.0 } else { reach.sqrt() };
        }
    }
    sum
}
