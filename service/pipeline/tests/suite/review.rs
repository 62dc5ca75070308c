//! What a reviewer of plans objects to and geometry can tell, over many seeds: showers that stand about, nurses far from their corridor, isolation rooms without their anteroom, homes with nowhere to eat, screens beside
//! the sofa's axis, machines on the sink, coats far from the entrance, docks behind rugs, chairs against the wall, visitors
//! behind the counter, robots that stop in a doorway.
//!
//! No rule forbids these; they are what makes a plan look wrong.

use d3dgen_model::Rect;
use d3dgen_model::domain::Mount;
use d3dgen_model::floorplan::{Door, DoorKind, PlanRoom, Window};
use d3dgen_model::placements::Placement;
use d3dgen_model::scenario::RoiKind;
use d3dgen_model::world::World;
use d3dgen_pipeline::scene_graph::{Request, generate};
use d3dgen_plugins::Registry;

use crate::common::{body, gap, in_room, most, named, seen_from, worlds};

/// Distance up to which a sofa looks at its screen, between the bodies, m.
const VIEW_M: f64 = 4.2;
/// Bodies nearer than this touch, m: skirting and tiles.
const TOUCH_M: f64 = 0.13;

/// Returns how far a body is from the walls of its room to the left or right and below or above it, m.
fn to_walls(room: &PlanRoom, body: &Rect) -> [f64; 2] {
    let corners = room.net_polygon.corners();
    let mut nearest = [f64::MAX; 2];
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        if (a.x - b.x).abs() < 1e-6 {
            if a.y.min(b.y) < body.y1 && a.y.max(b.y) > body.y0 {
                nearest[0] = nearest[0].min((body.x0 - a.x).abs()).min((body.x1 - a.x).abs());
            }
        } else if a.x.min(b.x) < body.x1 && a.x.max(b.x) > body.x0 {
            nearest[1] = nearest[1].min((body.y0 - a.y).abs()).min((body.y1 - a.y).abs());
        }
    }
    nearest
}

/// Returns the floor on both sides of a door as deep as its leaf is wide.
fn swept(door: &Door) -> Rect {
    let (a, b, depth) = (door.line.start, door.line.end, door.clear_width_m);
    let (dx, dy) = if door.line.is_vertical() { (depth, 0.0) } else { (0.0, depth) };
    Rect::new(a.x.min(b.x) - dx, a.y.min(b.y) - dy, a.x.max(b.x) + dx, a.y.max(b.y) + dy)
}

const HOMES: [&str; 4] =
    ["flat with 5 rooms", "flat with three bedrooms in Vienna", "house with 8 rooms", "home with 5 rooms and a robot"];

#[test]
fn homes_without_a_dining_room_have_a_table_and_seats() {
    let (mut four, mut some) = (Vec::new(), Vec::new());
    for world in HOMES.iter().flat_map(|prompt| worlds(prompt, 6)) {
        let room = |kind: &str| world.floorplan.rooms.iter().find(|r| r.room_type == kind);
        if room("dining_room").is_none() && room("living_room").is_some_and(|r| r.net_area_m2 >= 20.0) {
            let chairs = world.placements.placements.iter().filter(|p| p.object == "dining_chair").count();
            four.push(chairs >= 4);
            some.push(chairs >= 2);
        }
    }
    // no table stands between the sofa and its screen, so small ones do with two seats
    most("homes with four seats at a table", 0.75, &four);
    most("homes with seats at a table", 1.0, &some);
}

#[test]
fn screens_stand_at_a_wall_across_from_the_sofa_and_near_it() {
    let (mut axis, mut wall, mut seen, mut near) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let others = ["spacious villa with 6 rooms and a large living room", "house, 10 rooms, UK, service robot"];
    for world in HOMES.iter().chain(&others).flat_map(|prompt| worlds(prompt, 6)) {
        for room in world.floorplan.rooms.iter().filter(|r| r.room_type == "living_room") {
            let (Some(sofa), Some(stand)) =
                (named(&world, room, "sofa").into_iter().next(), named(&world, room, "tv_stand").into_iter().next())
            else {
                continue;
            };
            let (ahead, aside) = seen_from(sofa, stand.pose.x, stand.pose.y);
            axis.push(ahead > 0.0 && aside.abs() <= 0.45);
            near.push(gap(&body(sofa), &body(stand)) <= VIEW_M);
            wall.push(to_walls(room, &body(stand)).iter().any(|d| *d < TOUCH_M));
            let between = |p: &&Placement| {
                let (far, off) = seen_from(sofa, p.pose.x, p.pose.y);
                far > 0.6 && far < ahead - 0.4 && (off - aside).abs() < stand.size_m[0] / 2.0
            };
            let tall = in_room(&world, &room.room_id).filter(|p| p.top_m() > 0.5);
            seen.push(!tall.filter(|p| p.mount == Mount::Floor).any(|p| between(&p)));
        }
    }
    most("screens seen from the sofa", 0.97, &seen);
    most("screens on the sofa's axis", 0.9, &axis);
    most("screens at a wall", 1.0, &wall);
    most("screens near their sofa", 0.85, &near);
}

#[test]
fn nothing_stands_on_bowls_and_rings() {
    let registry = Registry::builtin();
    let prompts = ["office with 8 rooms", "office in London with 10 rooms and clutter", "hospital ward with 8 rooms"];
    let mut held = Vec::new();
    for world in prompts.iter().flat_map(|prompt| worlds(prompt, 4)) {
        let domain = &registry.get(&world.scene_graph.domain).unwrap().domain();
        let all = &world.placements.placements;
        for thing in all.iter().filter(|p| p.support.is_some()) {
            let host = all.iter().find(|p| Some(&p.placement_id) == thing.support.as_ref()).unwrap();
            let Some(kind) = domain.object(&host.object).filter(|o| !o.top_taken.is_empty()) else { continue };
            // shares of the width from the left of who stands before it, which is its own right
            let along = body(thing).corners().map(|c| 0.5 + seen_from(host, c.x, c.y).1 / host.size_m[0]);
            let (from, to) = (along.iter().copied().fold(1.0, f64::min), along.iter().copied().fold(0.0, f64::max));
            held.push(kind.top_taken.iter().all(|t| to <= t[0] + 0.01 || from >= t[1] - 0.01));
        }
    }
    most("things beside bowls and rings", 1.0, &held);
}

#[test]
fn kitchens_have_an_aisle_and_radiators_a_window_wall() {
    let (mut aisles, mut heated) = (Vec::new(), Vec::new());
    for world in HOMES.iter().flat_map(|prompt| worlds(prompt, 6)) {
        for room in &world.floorplan.rooms {
            let runs: Vec<&Placement> =
                ["sink_unit", "hob", "base_cabinet", "wide_base_cabinet", "fridge", "tall_cabinet"]
                    .iter()
                    .flat_map(|kind| named(&world, room, kind))
                    .collect();
            for (i, a) in runs.iter().enumerate() {
                let turned = |b: &&&Placement| (a.pose.yaw_rad - b.pose.yaw_rad).cos() < -0.9;
                for b in runs[..i].iter().filter(turned) {
                    let (ahead, aside) = seen_from(a, b.pose.x, b.pose.y);
                    if aside.abs() < (a.size_m[0] + b.size_m[0]) / 2.0 - 0.05 {
                        aisles.push(ahead - (a.size_m[1] + b.size_m[1]) / 2.0 > 0.99);
                    }
                }
            }
            for radiator in named(&world, room, "radiator") {
                let behind = |w: &Window| {
                    let (ahead, _) = seen_from(radiator, w.line.middle().x, w.line.middle().y);
                    w.room_id == room.room_id && ahead < 0.0 && ahead > -0.6
                };
                heated.push(world.floorplan.windows.iter().any(behind));
            }
        }
    }
    most("aisles of kitchens", 0.98, &aisles);
    most("radiators at the wall of a window", 1.0, &heated);
}

#[test]
fn toilets_of_a_step_free_office_have_a_wc_for_a_wheelchair() {
    let mut held = Vec::new();
    for world in worlds("office with 8 rooms, wheelchair accessible", 8) {
        held.push(world.floorplan.rooms.iter().any(|r| !named(&world, r, "accessible_wc").is_empty()));
    }
    most("offices with a WC for a wheelchair", 0.8, &held);
}

#[test]
fn visitors_sit_beside_the_bed() {
    let mut held = Vec::new();
    for world in ["hospital ward with 8 rooms in Germany", "ward with ten rooms"].iter().flat_map(|p| worlds(p, 6)) {
        for room in world.floorplan.rooms.iter().filter(|r| r.room_type.starts_with("patient_room")) {
            for chair in named(&world, room, "visitor_chair") {
                let near = |bed: &Placement| gap(&body(bed), &body(chair)) < 1.5;
                held.push(named(&world, room, "hospital_bed").into_iter().any(near));
            }
        }
    }
    most("visitor chairs near a bed", 0.9, &held);
}

#[test]
fn who_works_in_a_single_office_sees_the_door() {
    let mut held = Vec::new();
    let prompts = ["office with three private offices, a meeting room and a reception", "office with 8 rooms"];
    for world in prompts.iter().flat_map(|prompt| worlds(prompt, 6)) {
        for room in world.floorplan.rooms.iter().filter(|r| r.room_type == "office") {
            let door = world.floorplan.doors_of(&room.room_id).next().unwrap().line.middle();
            let Some(chair) = named(&world, room, "swivel_chair").into_iter().next() else { continue };
            held.push(seen_from(chair, door.x, door.y).0 > 0.0);
        }
    }
    most("people who see their door", 0.8, &held);
}

#[test]
fn sofas_in_offices_have_a_table() {
    let mut held = Vec::new();
    for world in worlds("office with 8 rooms and a reception", 8) {
        for room in &world.floorplan.rooms {
            let tables: Vec<Rect> =
                ["low_table", "side_table"].iter().flat_map(|t| named(&world, room, t)).map(body).collect();
            let near = |sofa: &Placement| tables.iter().any(|t| gap(t, &body(sofa)) < 0.7);
            held.extend(named(&world, room, "lounge_sofa").into_iter().map(near));
        }
    }
    most("sofas with a table", 1.0, &held);
}

#[test]
fn halls_of_homes_have_coat_hooks_and_mats_lie_clear_of_doors() {
    let (mut hooks, mut mats) = (Vec::new(), Vec::new());
    for world in worlds("home with 6 rooms and a delivery robot 0.6 m wide", 8) {
        hooks.push(world.placements.placements.iter().any(|p| p.object == "coat_hooks" || p.object == "coat_rack"));
        for room in &world.floorplan.rooms {
            let swings: Vec<Rect> = world
                .floorplan
                .doors_of(&room.room_id)
                .filter(|d| d.swing.as_ref().is_some_and(|s| s.into_room_id.as_ref() == Some(&room.room_id)))
                .map(swept)
                .collect();
            mats.extend(
                named(&world, room, "bath_mat").into_iter().map(|mat| swings.iter().all(|s| !s.overlaps(&body(mat)))),
            );
        }
    }
    most("halls with hooks for coats", 0.9, &hooks);
    most("mats clear of doors", 1.0, &mats);
}

#[test]
fn showers_stand_in_corners() {
    let (mut all, mut cornered) = (0, 0);
    for prompt in ["flat with 5 rooms", "family house in Germany with 8 rooms", "hospital ward with 8 rooms"] {
        for world in worlds(prompt, 8) {
            for room in &world.floorplan.rooms {
                for shower in named(&world, room, "shower") {
                    all += 1;
                    cornered += u32::from(to_walls(room, &shower.footprint().bounds()).iter().all(|d| *d < TOUCH_M));
                }
            }
        }
    }
    assert!(all >= 24, "{all} showers in 24 worlds");
    assert!(f64::from(cornered) >= 0.9 * f64::from(all), "{cornered} of {all} showers stand in a corner");
}

#[test]
fn nurses_sit_at_their_corridor() {
    let (mut all, mut near) = (0, 0);
    for prompt in ["hospital ward with 8 rooms in Germany", "Medical ward of ten rooms in London"] {
        for world in worlds(prompt, 10) {
            for room in world.floorplan.rooms.iter().filter(|r| r.room_type == "nurse_station") {
                let open = |d: &&Door| d.kind == DoorKind::Open;
                let Some(opening) = world.floorplan.doors_of(&room.room_id).find(open) else { continue };
                let from = opening.line.start;
                let to = opening.line.end;
                for counter in named(&world, room, "small_nurse_counter") {
                    all += 1;
                    let body = counter.footprint().bounds();
                    let away = if opening.line.is_vertical() {
                        (body.x0 - from.x).abs().min((body.x1 - from.x).abs())
                    } else {
                        (body.y0 - to.y).abs().min((body.y1 - to.y).abs())
                    };
                    near += u32::from(away < 2.5);
                }
            }
        }
    }
    assert!(all >= 15, "{all} counters at open fronts in 20 wards");
    assert!(f64::from(near) >= 0.9 * f64::from(all), "{near} of {all} counters are within 2.5 m of the corridor");
}

#[test]
fn isolation_rooms_have_their_anteroom() {
    let registry = Registry::builtin();
    let mut found = 0;
    for rooms in 5..=16 {
        let prompt = format!("intensive care unit with {rooms} rooms");
        let graph = generate(&Request { prompt, ..Request::default() }, &registry).unwrap();
        let count = |kind: &str| graph.rooms.iter().filter(|r| r.room_type == kind).count();
        assert_eq!(count("icu_isolation_room"), count("anteroom"), "{rooms} rooms");
        let asked = graph.rooms.iter().filter(|r| !r.circulation).count();
        assert_eq!(asked, rooms);
        found += count("icu_isolation_room");
    }
    assert!(found > 0, "some intensive care unit has an isolation room");
}

/// Returns the door from outdoors.
fn entrance(world: &World) -> &Door {
    world.floorplan.doors.iter().find(|d| d.entrance).unwrap()
}

#[test]
fn one_comes_past_the_living_room_before_the_last_bedroom_and_it_is_the_largest() {
    let (mut order, mut size) = (Vec::new(), Vec::new());
    for world in HOMES.iter().flat_map(|prompt| worlds(prompt, 10)) {
        let plan = &world.floorplan;
        let way = |room: &PlanRoom| {
            let doors = plan.doors_of(&room.room_id).map(|d| d.line.middle().distance(entrance(&world).line.middle()));
            doors.fold(f64::MAX, f64::min)
        };
        let of = |kind: &'static str| plan.rooms.iter().filter(move |r| r.room_type == kind);
        let Some(living) = of("living_room").next() else { continue };
        order.push(way(living) <= of("bedroom").map(way).fold(0.0, f64::max));
        size.push(of("bedroom").all(|r| r.net_area_m2 <= living.net_area_m2));
    }
    most("living rooms before the last bedroom", 0.85, &order);
    most("living rooms larger than bedrooms", 0.9, &size);
}

#[test]
fn coats_hang_by_the_entrance() {
    let mut held = Vec::new();
    for world in HOMES.iter().flat_map(|prompt| worlds(prompt, 6)) {
        let door = entrance(&world);
        let Some(hall) = world.floorplan.room(&door.room_ids[0]) else { continue };
        held.extend(
            named(&world, hall, "coat_hooks").into_iter().map(|p| body(p).center().distance(door.line.middle()) < 3.0),
        );
    }
    most("coat hooks near the entrance", 0.95, &held);
}

#[test]
fn chairs_at_tables_can_be_pushed_back() {
    let mut held = Vec::new();
    for world in HOMES.iter().flat_map(|prompt| worlds(prompt, 6)) {
        let all = &world.placements.placements;
        for chair in all.iter().filter(|p| p.object == "dining_chair") {
            let room = world.floorplan.room(&chair.room_id).unwrap();
            let (sin, cos) = chair.pose.yaw_rad.sin_cos();
            let own = body(chair).grown(-0.02);
            let back = Rect::new(own.x0 - 0.2 * cos, own.y0 - 0.2 * sin, own.x1 - 0.2 * cos, own.y1 - 0.2 * sin);
            let others = all.iter().filter(|p| p.room_id == chair.room_id && p.group != chair.group);
            let mut solid = others.filter(|p| p.mount == Mount::Floor && p.size_m[2] > 0.05);
            let inside = back.corners().iter().all(|c| room.net_polygon.contains(*c));
            held.push(inside && !solid.any(|p| body(p).overlaps(&back)));
        }
    }
    most("chairs with floor behind them", 0.98, &held);
}

#[test]
fn docks_stand_clear_of_furniture_and_rugs() {
    let prompts = [
        "house with 8 rooms and a cleaning robot",
        "office with 8 rooms for a delivery robot",
        "ward with 8 rooms for a delivery robot",
    ];
    let mut held = Vec::new();
    for world in prompts.iter().flat_map(|prompt| worlds(prompt, 8)) {
        for roi in world.scenario.rois.iter().filter(|r| r.kind == RoiKind::ChargingBuffer) {
            let floor = roi.polygon.bounds().grown(-0.02);
            let own =
                world.placements.placements.iter().filter(|p| p.room_id == roi.room_id && p.object != "robot_dock");
            let mut there = own.filter(|p| p.mount == Mount::Floor && p.support.is_none());
            held.push(!there.any(|p| body(p).overlaps(&floor)));
        }
    }
    // a hall or a reception may have no wall with so much floor before it
    most("docks with their floor free", 0.75, &held);
}

#[test]
fn patients_have_a_wardrobe_and_visitors_a_seat() {
    let (mut wardrobes, mut seats) = (Vec::new(), Vec::new());
    for world in worlds("hospital ward with 8 rooms", 8) {
        let rooms = world.floorplan.rooms.iter().filter(|r| r.room_type == "patient_room");
        wardrobes.extend(rooms.map(|r| !named(&world, r, "patient_wardrobe").is_empty()));
    }
    for world in worlds("office with 8 rooms and a reception", 16) {
        for room in world.floorplan.rooms.iter().filter(|r| r.room_type == "reception") {
            let soft = |p: &Placement| p.object == "visitor_chair" || p.object.contains("sofa");
            let mut own = in_room(&world, &room.room_id);
            seats.push(own.any(soft));
        }
    }
    most("patient rooms with a wardrobe", 0.85, &wardrobes);
    most("receptions with a seat for visitors", 0.9, &seats);
}

#[test]
fn light_comes_from_the_side_of_most_screens() {
    let mut held = Vec::new();
    for world in worlds("office with 8 rooms", 20) {
        for screen in world.placements.placements.iter().filter(|p| p.object == "monitor") {
            let faces = |w: &&Window| {
                let (ahead, aside) = seen_from(screen, w.line.middle().x, w.line.middle().y);
                let across = (screen.pose.yaw_rad.cos().abs() > 0.5) == w.line.is_vertical();
                w.room_id == screen.room_id && across && ahead.abs() < 3.0 && aside.abs() < w.line.length() / 2.0 + 0.3
            };
            held.push(!world.floorplan.windows.iter().any(|w| faces(&w)));
        }
    }
    // corner rooms have windows on two sides
    most("screens without a window before or behind them", 0.72, &held);
}

#[test]
fn counters_keep_their_staffs_floor_and_visitors_sit_before_them() {
    let (mut kept, mut before) = (Vec::new(), Vec::new());
    for world in worlds("office with 8 rooms in Germany", 12) {
        let all = &world.placements.placements;
        for counter in all.iter().filter(|p| p.object == "small_reception_desk") {
            let edge = -counter.size_m[1] / 2.0;
            let (sin, cos) = counter.pose.yaw_rad.sin_cos();
            let at = |u: f64, v: f64| (counter.pose.x + u * cos - v * sin, counter.pose.y + u * sin + v * cos);
            let half = counter.size_m[0] / 2.0 - 0.02;
            let ((xa, ya), (xb, yb)) = (at(edge - 0.7, -half), at(edge - 0.02, half));
            let staff = Rect::new(xa.min(xb), ya.min(yb), xa.max(xb), ya.max(yb));
            let here = all.iter().filter(|p| p.room_id == counter.room_id && p.group != counter.group);
            let stands = here.filter(|p| p.mount == Mount::Floor && p.support.is_none());
            kept.push(!stands.clone().any(|p| body(p).overlaps(&staff)));
            let seats = stands.filter(|p| ["visitor_chair", "lounge_sofa"].contains(&p.object.as_str()));
            before.extend(seats.map(|p| seen_from(counter, p.pose.x, p.pose.y).0 > edge));
        }
    }
    most("counters with free floor behind them", 0.9, &kept);
    // a way in or a dock may leave no other wall
    most("seats of visitors on their side of the counter", 0.7, &before);
}

#[test]
fn nobody_squeezes_past_tables_that_could_be_left_out() {
    let mut held = Vec::new();
    let prompts = ["office with 10 rooms in the Netherlands", "office with 10 rooms"];
    for world in prompts.iter().flat_map(|prompt| worlds(prompt, 12)) {
        let all = &world.placements.placements;
        let tables = all.iter().filter(|p| p.object == "meeting_table_4" && p.room_id.starts_with("open_office"));
        for table in tables {
            let others = all.iter().filter(|p| p.room_id == table.room_id && p.group != table.group);
            let desks = others.filter(|p| ["desk", "small_desk", "printer"].contains(&p.object.as_str()));
            held.push(desks.map(|p| gap(&body(p), &body(table))).fold(f64::MAX, f64::min) >= 0.295);
        }
    }
    most("tables with floor around them", 1.0, &held);
}

#[test]
fn robots_stop_clear_of_walls_and_doorways() {
    let prompts =
        ["hospital ward with 8 rooms in Germany, for a delivery robot", "office with 10 rooms, for a mail robot"];
    let mut held = Vec::new();
    for world in prompts.iter().flat_map(|prompt| worlds(prompt, 10)) {
        let radius = world.scene_graph.robots[0].radius_m;
        for poi in world.scenario.pois.iter().filter(|p| p.kind == "service_point") {
            let around = Rect::new(poi.pose.x, poi.pose.y, poi.pose.x, poi.pose.y).grown(radius);
            let room = world.floorplan.room(&poi.room_id).unwrap();
            held.push(around.corners().iter().all(|c| room.net_polygon.contains(*c)));
        }
    }
    most("stops with the robot inside the room", 0.97, &held);
}

#[test]
fn both_sides_of_double_beds_can_be_reached() {
    let mut held = Vec::new();
    for world in HOMES.iter().flat_map(|prompt| worlds(prompt, 6)) {
        let all = &world.placements.placements;
        for bed in all.iter().filter(|p| p.object == "double_bed") {
            let others = all.iter().filter(|p| p.room_id == bed.room_id && p.placement_id != bed.placement_id);
            let stands: Vec<&Placement> =
                others.filter(|p| p.mount == Mount::Floor && p.support.is_none() && p.size_m[2] > 0.1).collect();
            let [half, foot] = [bed.size_m[0] / 2.0, bed.size_m[1] / 2.0];
            let (sin, cos) = bed.pose.yaw_rad.sin_cos();
            for side in [-half, half] {
                let (x, y) = (bed.pose.x + foot * cos - side * sin, bed.pose.y + foot * sin + side * cos);
                let corner = Rect::new(x, y, x, y);
                let mut near = stands.iter().filter(|p| gap(&body(p), &corner) < 0.4);
                held.push(!near.any(|p| {
                    let (ahead, left) = seen_from(bed, p.pose.x, p.pose.y);
                    ahead > foot && left * side.signum() > half
                }));
            }
        }
    }
    // a small room may have no other place for its wardrobe
    most("sides of beds with a way in at the foot", 0.93, &held);
}
