//! What a reviewer of plans objects to in the order of things: rooms larger than they should be, steps in a facade, things
//! side by side that disturb each other, robots that leave out rooms where they have work.

use d3dgen_model::floorplan::{Door, DoorKind, Floorplan, PlanRoom};
use d3dgen_model::placements::Placement;
use d3dgen_model::scenario::{Roi, RoiKind};
use d3dgen_model::world::World;
use d3dgen_model::{Point, Rect};

use crate::common::{body, gap, in_room, most, rooms, worlds};

/// Length from which a step in an outline is one that somebody meant, m.
const STEP_M: f64 = 0.85;

fn standing<'w>(world: &'w World, room: &'w PlanRoom) -> impl Iterator<Item = &'w Placement> {
    in_room(world, &room.room_id).filter(|p| p.support.is_none() && p.pose.z < 1.2)
}

#[test]
fn the_living_room_is_larger_than_the_hall() {
    let homes = ["house with 8 rooms", "house, 10 rooms, UK, service robot", "villa with 10 rooms in Italy"];
    let mut larger = Vec::new();
    for world in homes.iter().flat_map(|prompt| worlds(prompt, 8)) {
        let largest = |kind: &str| rooms(&world, kind).map(|r| r.net_area_m2).fold(0.0, f64::max);
        larger.push(largest("living_room") >= largest("hallway"));
    }
    most("living rooms larger than the hall", 0.85, &larger);
}

/// Returns the lengths of the straight pieces of a plan's outline, openings closed, m.
fn outline(plan: &Floorplan) -> Vec<f64> {
    let mut pieces: Vec<(bool, i64, f64, f64)> = Vec::new();
    for wall in plan.walls.iter().filter(|w| w.exterior) {
        let (a, b) = (wall.line.start, wall.line.end);
        let vertical = wall.line.is_vertical();
        let (at, from, to) = if vertical { (a.x, a.y, b.y) } else { (a.y, a.x, b.x) };
        pieces.push((vertical, (at * 1000.0).round() as i64, from.min(to), from.max(to)));
    }
    pieces.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
    let mut lengths: Vec<(bool, i64, f64, f64)> = Vec::new();
    for piece in pieces {
        match lengths.last_mut() {
            // the widest door in a wall
            Some(last) if (last.0, last.1) == (piece.0, piece.1) && piece.2 - last.3 < 2.5 => {
                last.3 = last.3.max(piece.3)
            }
            _ => lengths.push(piece),
        }
    }
    lengths.into_iter().map(|(_, _, from, to)| to - from).collect()
}

#[test]
fn facades_step_back_for_a_reason_or_not_at_all() {
    let mut held = Vec::new();
    for prompt in ["house with 8 rooms", "office with 8 rooms", "hospital ward with 8 rooms in Germany"] {
        for world in worlds(prompt, 8) {
            held.push(outline(&world.floorplan).iter().all(|length| *length >= STEP_M));
        }
    }
    most("plans without a small step", 0.9, &held);
}

#[test]
fn one_gets_past_a_counter_to_the_staffs_side() {
    let mut held = Vec::new();
    for prompt in
        ["hospital ward with 8 rooms in Germany", "office with 8 rooms and a reception", "clinic with 8 rooms"]
    {
        for world in worlds(prompt, 8) {
            for room in &world.floorplan.rooms {
                let counter =
                    |p: &&Placement| matches!(p.object.as_str(), "small_nurse_counter" | "small_reception_desk");
                for p in standing(&world, room).filter(counter) {
                    let own = body(p);
                    let (wide, across) = (0.8, p.pose.yaw_rad.cos().abs() > 0.5);
                    let way = |from: f64| match across {
                        true => Rect { y0: from, y1: from + wide, ..own },
                        false => Rect { x0: from, x1: from + wide, ..own },
                    };
                    let (low, high) = if across { (own.y0, own.y1) } else { (own.x0, own.x1) };
                    let free = |way: Rect| {
                        let inside = way.corners().iter().all(|c| {
                            let (dx, dy) = (way.center().x - c.x, way.center().y - c.y);
                            room.net_polygon.contains(Point::new(c.x + 0.01 * dx, c.y + 0.01 * dy))
                        });
                        let others = standing(&world, room).filter(|o| o.placement_id != p.placement_id);
                        inside && !others.filter(|o| o.top_m() > 0.03).any(|o| body(o).overlaps(&way.grown(-0.01)))
                    };
                    held.push([low - wide, high].into_iter().any(|from| free(way(from))));
                }
            }
        }
    }
    assert!(held.len() >= 24, "{}", held.len());
    most("counters with 0.8 m past them", 0.95, &held);
}

#[test]
fn sitting_groups_and_printers_leave_desks_alone() {
    let mut held = Vec::new();
    for world in ["office with 8 rooms", "office with 10 rooms"].iter().flat_map(|prompt| worlds(prompt, 8)) {
        for room in rooms(&world, "open_office") {
            let of = |names: &'static [&'static str]| {
                standing(&world, room).filter(move |p| names.contains(&p.object.as_str())).map(body)
            };
            let desks: Vec<Rect> = of(&["desk"]).collect();
            let chairs: Vec<Rect> = of(&["swivel_chair"]).collect();
            let clear = |thing: Rect, all: &[Rect], least: f64| all.iter().all(|o| gap(&thing, o) >= least - 0.01);
            held.extend(of(&["low_table", "lounge_sofa", "meeting_table_4"]).map(|p| clear(p, &desks, 0.45)));
            held.extend(of(&["printer"]).map(|p| clear(p, &chairs, 1.0)));
        }
    }
    assert!(held.len() >= 16, "{}", held.len());
    most("things that leave desks alone", 1.0, &held);
}

#[test]
fn a_toilet_for_wheelchairs_has_a_room_of_its_own() {
    for world in worlds("Plan an office of eight rooms in Canada where every door suits a wheelchair", 6) {
        // a room of its own type, or the only toilet made so
        let own = rooms(&world, "accessible_toilet").count();
        for room in rooms(&world, "accessible_toilet").chain(rooms(&world, "toilet").filter(|_| own == 0)) {
            let count = |object: &str| standing(&world, room).filter(|p| p.object == object).count();
            assert_eq!((count("accessible_wc"), count("wc_cubicle")), (1, 0), "{}", world.scene_graph.seed);
        }
    }
    let mut two = Vec::new();
    for world in worlds("office with 14 rooms", 6) {
        let cubicles = |room: &PlanRoom| standing(&world, room).filter(|p| p.object == "wc_cubicle").count();
        two.extend(rooms(&world, "toilet").map(|r| cubicles(r) >= 2));
    }
    most("toilets of an office with two cubicles", 0.75, &two);
}

#[test]
fn robots_go_wherever_they_have_work() {
    for (prompt, kind) in [
        ("Government office in Canberra with 10 rooms; the robot must reach them all", "service_point"),
        ("house with 10 rooms and a cleaning robot", "cleaning_point"),
        ("office, 8 rooms, Singapore, two cleaning robots with charging", "cleaning_point"),
    ] {
        for world in worlds(prompt, 3) {
            let scenario = &world.scenario;
            let mut goals: Vec<&String> = scenario.robots.iter().flat_map(|r| &r.goals).collect();
            let mut points: Vec<&String> = scenario.pois.iter().filter(|p| p.kind == kind).map(|p| &p.poi_id).collect();
            goals.sort();
            points.sort();
            assert!(points.len() >= 6, "{prompt}: {points:?}");
            assert_eq!(goals, points, "{prompt}");
        }
    }
}

#[test]
fn staff_rooms_have_a_table_with_seats() {
    let mut held = Vec::new();
    for world in worlds("hospital ward with 10 rooms and a staff room", 12) {
        let seated = |room: &PlanRoom| standing(&world, room).any(|p| p.object == "dining_chair");
        held.extend(rooms(&world, "staff_room").map(seated));
    }
    most("staff rooms with seats at a table", 0.9, &held);
}

/// Returns the floor before an object, as wide as it and so deep.
fn before(p: &Placement, deep: f64) -> Rect {
    let own = body(p);
    match (p.pose.yaw_rad.cos().round() as i32, p.pose.yaw_rad.sin().round() as i32) {
        (1, _) => Rect { x0: own.x1, x1: own.x1 + deep, ..own },
        (-1, _) => Rect { x0: own.x0 - deep, x1: own.x0, ..own },
        (_, 1) => Rect { y0: own.y1, y1: own.y1 + deep, ..own },
        _ => Rect { y0: own.y0 - deep, y1: own.y0, ..own },
    }
}

/// Returns the floor on both sides of an opening.
fn landing(door: &Door, deep: f64) -> Rect {
    let (a, b) = (door.line.start, door.line.end);
    let own = Rect::new(a.x.min(b.x), a.y.min(b.y), a.x.max(b.x), a.y.max(b.y));
    match door.line.is_vertical() {
        true => Rect { x0: own.x0 - deep, x1: own.x1 + deep, ..own },
        false => Rect { y0: own.y0 - deep, y1: own.y1 + deep, ..own },
    }
}

#[test]
fn nobody_queues_at_a_counter_where_others_come_in() {
    let mut held = Vec::new();
    for prompt in ["office with 8 rooms and a reception near the entrance", "law firm office with five rooms in Zurich"]
    {
        for world in worlds(prompt, 10) {
            for room in rooms(&world, "reception") {
                let entrances =
                    world.floorplan.doors.iter().filter(|d| d.entrance && d.room_ids.contains(&room.room_id));
                let landings: Vec<Rect> = entrances.map(|d| landing(d, 1.1)).collect();
                let desks = standing(&world, room).filter(|p| p.object.ends_with("reception_desk"));
                held.extend(desks.filter(|_| !landings.is_empty()).map(|p| {
                    let queue = before(p, 0.9).grown(-0.01);
                    !landings.iter().any(|l| l.overlaps(&queue))
                }));
            }
        }
    }
    assert!(held.len() >= 10, "{}", held.len());
    most("counters away from the way in", 0.85, &held);
}

#[test]
fn one_comes_to_rows_of_desks_through_an_aisle() {
    let mut held = Vec::new();
    for world in ["office with 8 rooms", "call center with eight rooms"].iter().flat_map(|prompt| worlds(prompt, 20)) {
        for room in rooms(&world, "open_office").filter(|r| r.net_polygon.rects().len() == 1) {
            let desks: Vec<&Placement> = standing(&world, room).filter(|p| p.object.ends_with("desk")).collect();
            let Some(all) = desks.iter().map(|p| body(p)).reduce(|a, b| a.union(&b)) else {
                continue;
            };
            let net = room.net_polygon.bounds();
            let ends = match desks[0].pose.yaw_rad.cos().abs() > 0.5 {
                true => [all.y0 - net.y0, net.y1 - all.y1],
                false => [all.x0 - net.x0, net.x1 - all.x1],
            };
            held.push(ends.into_iter().any(|end| end >= 0.9 - 1e-6));
        }
    }
    most("open offices with an aisle at one end of the rows", 0.95, &held);
}

#[test]
fn robots_dock_behind_doors_that_open_by_themselves() {
    let mut held = Vec::new();
    for prompt in ["office with 8 rooms and a cleaning robot", "clinic with 8 rooms and a cleaning robot"] {
        for world in worlds(prompt, 8) {
            let docks = world.placements.placements.iter().filter(|p| p.object.contains("dock"));
            held.extend(docks.map(|dock| {
                let inner = |d: &&Door| d.room_ids.len() == 2 && d.room_ids.contains(&dock.room_id);
                let mut doors = world.floorplan.doors.iter().filter(inner).peekable();
                doors.peek().is_none() || doors.any(|d| matches!(d.kind, DoorKind::Sliding | DoorKind::Open))
            }));
        }
    }
    assert!(held.len() >= 12, "{}", held.len());
    most("docks that a robot gets to by itself", 0.95, &held);
}

#[test]
fn robots_serve_clear_of_the_swing_of_doors() {
    let mut held = Vec::new();
    for prompt in ["house with 8 rooms and a delivery robot", "clinic with 8 rooms and a delivery robot"] {
        for world in worlds(prompt, 6) {
            let service = |r: &&Roi| r.kind == RoiKind::ServiceZone;
            for zone in world.scenario.rois.iter().filter(service) {
                let own = zone.polygon.bounds().grown(-0.02);
                let opens =
                    |d: &&Door| d.swing.as_ref().is_some_and(|s| s.into_room_id.as_ref() == Some(&zone.room_id));
                let leaf = |d: &Door| match d.kind {
                    DoorKind::DoubleHinged => d.line.length() / 2.0,
                    _ => d.line.length(),
                };
                let mut doors = world.floorplan.doors.iter().filter(opens);
                held.push(!doors.any(|d| landing(d, leaf(d)).overlaps(&own)));
            }
        }
    }
    assert!(held.len() >= 60, "{}", held.len());
    most("floor to serve at, clear of doors", 0.95, &held);
}

#[test]
fn hand_basins_are_at_the_door() {
    let mut held = Vec::new();
    for world in ["hospital ward with 8 rooms in Germany", "clinic with 8 rooms"].iter().flat_map(|p| worlds(p, 8)) {
        for room in
            world.floorplan.rooms.iter().filter(|r| matches!(r.room_type.as_str(), "patient_room" | "exam_room"))
        {
            let basins = world
                .placements
                .placements
                .iter()
                .filter(|p| p.object == "clinical_basin" && p.room_id == room.room_id);
            let way = |p: &Placement| {
                let corridor = |id: &String| world.floorplan.room(id).is_some_and(|r| r.circulation);
                let doors = world.floorplan.doors_of(&room.room_id).filter(|d| d.room_ids.iter().any(corridor));
                doors.map(|d| d.line.middle().distance(Point::new(p.pose.x, p.pose.y))).fold(f64::MAX, f64::min)
            };
            held.extend(basins.map(way).reduce(f64::min).map(|way| way <= 2.6));
        }
    }
    assert!(held.len() >= 30, "{}", held.len());
    most("hand basins near the door", 0.85, &held);
}

#[test]
fn nobody_is_served_from_behind() {
    // with eight counters there are two lines: who sits at one has not the customers of the other at the back
    let mut held = Vec::new();
    for world in worlds("government service office in Madrid with 8 counters and a waiting hall", 6) {
        let counters: Vec<&Placement> =
            world.placements.placements.iter().filter(|p| p.object == "teller_counter").collect();
        assert!(counters.len() >= 7, "{}", counters.len());
        let behind = |p: &Placement, other: &Placement| {
            let (dx, dy) = (other.pose.x - p.pose.x, other.pose.y - p.pose.y);
            let (c, s) = (p.pose.yaw_rad.cos(), p.pose.yaw_rad.sin());
            let (ahead, aside) = (dx * c + dy * s, (dy * c - dx * s).abs());
            let alike = (p.pose.yaw_rad - other.pose.yaw_rad).cos() > 0.9;
            alike && ahead < -0.9 && aside < 0.9
        };
        held.push(!counters.iter().any(|p| counters.iter().any(|other| behind(p, other))));
    }
    most("counters with nobody served behind them", 0.6, &held);
}
