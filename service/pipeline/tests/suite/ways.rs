//! Ways through furnished rooms: beds leave patient rooms, people come through a reception, robots stand at their docks.

use d3dgen_knowledge::clearance::is_shallow;
use d3dgen_knowledge::freespace::FreeSpace;
use d3dgen_model::Rect;
use d3dgen_model::domain::{Domain, Mount, Shape};
use d3dgen_model::floorplan::{Door, PlanRoom};
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;
use d3dgen_plugins::Registry;

use crate::common::{in_room, worlds, worlds_of};

/// What people walk under, m.
const HEAD_ROOM_M: f64 = 2.03;

fn shape(domain: &Domain, p: &Placement) -> Option<Shape> {
    domain.object(&p.object).map(|o| o.shape)
}

/// Returns what stands in a room and what hangs so low and far out that people go around it.
fn bodies<'w>(world: &'w World, room: &'w PlanRoom) -> impl Iterator<Item = &'w Placement> {
    let in_the_way = |p: &&Placement| match p.mount {
        Mount::Floor => p.top_m() > 0.03,
        Mount::Wall => p.pose.z < HEAD_ROOM_M && !is_shallow(p),
        Mount::Ceiling | Mount::Surface => false,
    };
    in_room(world, &room.room_id).filter(in_the_way)
}

/// Returns the doors of a room to corridors and halls.
fn inward<'w>(world: &'w World, room: &'w PlanRoom) -> Vec<&'w Door> {
    let circulation = |id: &String| *id != room.room_id && world.floorplan.room(id).is_some_and(|r| r.circulation);
    world.floorplan.doors_of(&room.room_id).filter(|d| d.room_ids.iter().any(circulation)).collect()
}

#[test]
fn a_bed_can_be_pushed_out_of_its_room() {
    let registry = Registry::builtin();
    let (mut beds, mut stuck) = (0, Vec::new());
    for prompt in ["hospital ward with 5 rooms", "Hospital ward with 8 rooms in Germany, for a delivery robot"] {
        for world in worlds_of(prompt, 100..112) {
            let domain = registry.get(&world.scene_graph.domain).unwrap().domain();
            for room in world.floorplan.rooms.iter().filter(|r| r.room_type.starts_with("patient_room")) {
                let is_bed = |p: &Placement| shape(domain, p) == Some(Shape::HospitalBed);
                for bed in bodies(&world, room).filter(|p| is_bed(p)) {
                    beds += 1;
                    // what belongs to the bed goes with it
                    let with_bed = |p: &Placement| p.group.is_some() && p.group == bed.group;
                    let fixed = bodies(&world, room).filter(|p| !with_bed(p));
                    let fixed: Vec<Rect> =
                        fixed.filter(|p| p.placement_id != bed.placement_id).map(|p| p.footprint().bounds()).collect();
                    let floor = FreeSpace::new(&room.net_polygon, &fixed);
                    let own = bed.footprint().bounds();
                    let (width, length) = (own.width().min(own.height()), own.width().max(own.height()));
                    let out =
                        |door: &&Door| floor.leads(door, &own, width + 0.04) && floor.turns_in(door, length, width);
                    if !inward(&world, room).iter().any(out) {
                        stuck.push(format!("{prompt}, seed {}: {}", world.scene_graph.seed, bed.placement_id));
                    }
                }
            }
        }
    }
    assert!(beds >= 48, "{beds} beds");
    assert!(stuck.is_empty(), "{} of {beds} beds: {stuck:#?}", stuck.len());
}

#[test]
fn one_comes_through_a_reception_past_robots_at_their_docks() {
    let registry = Registry::builtin();
    let (mut receptions, mut narrow) = (0, Vec::new());
    for prompt in [
        "An office with five rooms and a reception where a mobile robot guides visitors",
        "office with 8 rooms and a reception at the entrance, for a delivery robot",
        "clinic with a reception, three exam rooms and a waiting area",
    ] {
        for world in worlds(prompt, 8) {
            let domain = registry.get(&world.scene_graph.domain).unwrap().domain();
            let robot_m = world.scene_graph.robots.iter().map(|r| 2.0 * r.radius_m).fold(0.6, f64::max);
            for room in world.floorplan.rooms.iter().filter(|r| !r.circulation) {
                let entrance = world.floorplan.doors_of(&room.room_id).find(|d| d.entrance);
                let inward = inward(&world, room);
                let Some(entrance) = entrance.filter(|_| !inward.is_empty()) else { continue };
                receptions += 1;
                let own: Vec<&Placement> = bodies(&world, room).collect();
                let docks = own.iter().filter(|p| shape(domain, p) == Some(Shape::Dock));
                let parked = docks.map(|p| {
                    let (sin, cos) = p.pose.yaw_rad.sin_cos();
                    let far = (p.size_m[1] + robot_m) / 2.0;
                    let (x, y) = (p.pose.x + cos * far, p.pose.y + sin * far);
                    Rect::new(x - robot_m / 2.0, y - robot_m / 2.0, x + robot_m / 2.0, y + robot_m / 2.0)
                });
                let taken: Vec<Rect> = own.iter().map(|p| p.footprint().bounds()).chain(parked).collect();
                let doors: Vec<&Door> = inward.iter().copied().chain([entrance]).collect();
                let width = FreeSpace::new(&room.net_polygon, &taken).passage(&doors);
                if width < 1.2 - 0.01 {
                    narrow.push(format!("{prompt}, seed {}: {} {width:.2} m", world.scene_graph.seed, room.room_id));
                }
            }
        }
    }
    assert!(receptions >= 12, "{receptions}");
    // small ones have no room for desk, robot and way
    assert!(narrow.len() * 10 <= receptions, "{} of {receptions}: {narrow:#?}", narrow.len());
}

#[test]
fn a_robot_at_its_dock_touches_nothing() {
    let registry = Registry::builtin();
    let (mut docks, mut touched) = (0, Vec::new());
    for prompt in [
        "house with 8 rooms where a service robot of 0.6 m diameter helps an elderly couple",
        "office with 8 rooms for a delivery robot",
        "Hospital ward with 8 rooms in Germany, for a delivery robot",
    ] {
        for world in worlds(prompt, 8) {
            let domain = registry.get(&world.scene_graph.domain).unwrap().domain();
            let robot_m = world.scene_graph.robots.iter().map(|r| 2.0 * r.radius_m).fold(0.0, f64::max);
            assert!(robot_m > 0.0, "{prompt}");
            for room in &world.floorplan.rooms {
                let own: Vec<&Placement> = bodies(&world, room).collect();
                for dock in own.iter().filter(|p| shape(domain, p) == Some(Shape::Dock)) {
                    docks += 1;
                    let (sin, cos) = dock.pose.yaw_rad.sin_cos();
                    let far = (dock.size_m[1] + robot_m) / 2.0;
                    let (x, y) = (dock.pose.x + cos * far, dock.pose.y + sin * far);
                    let half = robot_m / 2.0 - 0.01;
                    let parked = Rect::new(x - half, y - half, x + half, y + half);
                    let others = own.iter().filter(|p| p.placement_id != dock.placement_id);
                    touched.extend(
                        others
                            .filter(|p| p.pose.z < 1.5 && p.footprint().bounds().overlaps(&parked))
                            .map(|p| format!("{prompt}, seed {}: {}", world.scene_graph.seed, p.placement_id)),
                    );
                }
            }
        }
    }
    assert!(docks >= 12, "{docks}");
    assert!(touched.is_empty(), "{touched:#?}");
}
