//! SUP: objects that something holds (SceneEval v1.1, `SUP`).
//!
//! As there, an object is supported in the direction its kind asks for: down for floor and surface (at least 4 contacts
//! nearer than 1 cm, and the center above their convex hull), up for the ceiling and back for a wall (at least one
//! contact nearer than 1 cm). SceneEval asks a language model for the kind; here the document says it. The wall above a
//! door holds what hangs there; curtains and blinds hang on the frame of their window.

use d3dgen_model::Point;
use d3dgen_model::domain::Mount;
use parry2d::math::Vector;
use parry2d::query::PointQuery;
use parry2d::shape::ConvexPolygon;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::share;
use crate::kinds::Kinds;
use crate::solid::{Scene, Solid, along, vector};

/// How near a contact is, m.
const NEAR_M: f64 = 0.01;
/// Fewest contacts that hold an object from below.
const FEWEST: usize = 4;
/// Points tried along each side of a face.
const SAMPLES: usize = 9;

/// Objects that something holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Share of objects that are supported.
    pub object_share: f64,
    /// Placement ids of the others.
    pub unsupported: Vec<String>,
}

/// Measures a world.
pub(crate) fn measure(scene: &Scene<'_>) -> Support {
    let loose: Vec<String> =
        scene.solids.iter().filter(|s| !held(scene, s)).map(|s| s.placement.placement_id.clone()).collect();
    Support { object_share: share(scene.solids.len() - loose.len(), scene.solids.len()), unsupported: loose }
}

fn held(scene: &Scene<'_>, s: &Solid<'_>) -> bool {
    match s.placement.mount {
        Mount::Floor | Mount::Surface => {
            let contacts: Vec<Point> = s.samples(SAMPLES).filter(|p| rests(scene, s, *p)).collect();
            contacts.len() >= FEWEST && in_hull(&contacts, s.center)
        }
        Mount::Ceiling => (scene.ceiling(&s.placement.room_id) - s.z1).abs() <= NEAR_M,
        Mount::Wall => hangs(scene, s),
    }
}

/// Returns true when there is floor or another object's top right below a point of the underside.
fn rests(scene: &Scene<'_>, s: &Solid<'_>, p: Point) -> bool {
    let touches =
        |o: &Solid<'_>| !std::ptr::eq(o.placement, s.placement) && (o.z1 - s.z0).abs() <= NEAR_M && o.covers(p, 0.0);
    (s.z0.abs() <= NEAR_M && scene.has_floor(p)) || scene.solids.iter().any(touches)
}

/// Returns true when a wall, or another object, is right behind a point of the back.
fn hangs(scene: &Scene<'_>, s: &Solid<'_>) -> bool {
    let [width, depth, height] = s.placement.size_m;
    let plan = &scene.world.floorplan;
    let near = s.bounds.grown(NEAR_M);
    let walls: Vec<_> =
        plan.walls.iter().map(|w| along(&w.line, w.thickness_m / 2.0)).filter(|r| r.overlaps(&near)).collect();
    let lintels: Vec<_> = plan
        .doors
        .iter()
        .map(|d| (along(&d.line, d.wall_thickness_m / 2.0), d.height_m))
        .filter(|(r, _)| r.overlaps(&near))
        .collect();
    let covering = Kinds::builtin().covers_windows(&s.placement.object);
    let holes: Vec<_> = plan
        .windows
        .iter()
        .filter(|_| !covering)
        .map(|w| (along(&w.line, w.wall_thickness_m / 2.0), w.sill_m, w.head_m))
        .filter(|(r, ..)| r.overlaps(&near))
        .collect();
    let at = |i: usize| (i as f64 + 0.5) / SAMPLES as f64 - 0.5;
    (0..SAMPLES).any(|i| {
        let p = s.at(-depth / 2.0 - NEAR_M, at(i) * width);
        let inside = |r: &d3dgen_model::Rect| r.x0 <= p.x && p.x <= r.x1 && r.y0 <= p.y && p.y <= r.y1;
        (0..SAMPLES).any(|j| {
            let z = (s.z0 + s.z1) / 2.0 + at(j) * height;
            let hole = holes.iter().any(|(r, sill, head)| inside(r) && *sill < z && z < *head);
            let other =
                |o: &Solid<'_>| !std::ptr::eq(o.placement, s.placement) && o.z0 <= z && z <= o.z1 && o.covers(p, 0.0);
            let above = lintels.iter().any(|(r, head)| inside(r) && *head <= z);
            let wall = (above || !hole && walls.iter().any(inside)) && z <= scene.ceiling(&s.placement.room_id);
            wall || scene.solids.iter().any(other)
        })
    })
}

/// Returns true when a point lies in the convex hull of others.
fn in_hull(points: &[Point], p: Point) -> bool {
    let points: Vec<Vector> = points.iter().copied().map(vector).collect();
    ConvexPolygon::from_convex_hull(&points).is_some_and(|hull| hull.distance_to_local_point(vector(p), true) <= 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    fn loose(change: impl FnOnce(&mut d3dgen_model::world::World)) -> Vec<String> {
        let mut world = sample::world();
        change(&mut world);
        measure(&Scene::new(&world)).unsupported
    }

    #[test]
    fn a_sound_world_holds_everything() {
        assert_eq!(loose(|_| ()), [""; 0]);
    }

    #[test]
    fn what_floats_is_found_by_each_kind_of_mount() {
        assert_eq!(
            loose(|w| sample::object_mut(w, "table").pose.z = 0.05),
            ["table_1", "cup_1"],
            "the cup stood on it"
        );
        assert_eq!(loose(|w| sample::object_mut(w, "cup").pose.z += 0.02), ["cup_1"]);
        assert_eq!(loose(|w| sample::object_mut(w, "clock").pose.y -= 0.02), ["clock_1"]);
        assert_eq!(loose(|w| sample::object_mut(w, "lamp").pose.z -= 0.02), ["lamp_1"]);
    }

    #[test]
    fn more_than_half_over_the_edge_falls() {
        let reach = |over: f64| loose(|w| sample::object_mut(w, "cup").pose.x += 0.3 - 0.05 + over);
        assert_eq!(reach(0.04), [""; 0]);
        assert_eq!(reach(0.07), ["cup_1"]);
    }

    #[test]
    fn a_window_holds_nothing() {
        // the window runs from x = 5 to 7 in the north wall, 0.9 to 2.1 m up; the wall's face is at y = 2.9
        let sign = |z: f64| {
            let mut sign = sample::thing("sign", (6.0, 2.85), [0.5, 0.1, 0.3]);
            (sign.mount, sign.pose.z, sign.room_id) = (Mount::Wall, z, "b_1".into());
            sign.pose.yaw_rad = -std::f64::consts::FRAC_PI_2;
            loose(|w| w.placements.placements.push(sign))
        };
        assert_eq!(sign(1.2), ["sign_1"]);
        assert_eq!(sign(0.7), [""; 0], "its lower half hangs on the wall below");
        let hung = |object: &str| {
            let mut thing = sample::thing(object, (6.0, 2.85), [0.5, 0.1, 0.3]);
            (thing.mount, thing.pose.z, thing.pose.yaw_rad) = (Mount::Wall, 1.2, -std::f64::consts::FRAC_PI_2);
            loose(|w| w.placements.placements.push(thing))
        };
        assert_eq!((hung("blind"), hung("picture")), (Vec::new(), vec!["picture_1".to_owned()]));
    }

    #[test]
    fn the_wall_above_a_door_holds_a_camera() {
        // the door runs from y = 1 to 2 at x = 4, 2 m high; the second room's wall face is at x = 4.1
        let camera = |z: f64| {
            let mut camera = sample::thing("camera", (4.175, 1.5), [0.1, 0.15, 0.1]);
            (camera.mount, camera.pose.z) = (Mount::Wall, z);
            loose(|w| w.placements.placements.push(camera))
        };
        assert_eq!((camera(2.2), camera(1.8)), (Vec::new(), vec!["camera_1".to_owned()]));
    }
}
