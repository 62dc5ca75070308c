//! What nurses and architects object to in hospitals and clinics: what was read for the building, ways in, what a station
//! sees, where a robot charges.

use d3dgen_model::floorplan::{Door, DoorKind};
use d3dgen_model::world::World;
use d3dgen_model::{Point, Polygon, Rect};

use crate::common::{body, gap, most, worlds};

/// Returns how many rooms of a type a world has.
fn count(world: &World, kind: &str) -> usize {
    world.floorplan.rooms.iter().filter(|r| r.room_type == kind).count()
}

/// Returns the doors to outdoors of rooms of a type.
fn ways_in<'w>(world: &'w World, kind: &str) -> Vec<&'w Door> {
    let of = |id: &str| world.floorplan.room(id).is_some_and(|r| r.room_type == kind);
    world.floorplan.doors.iter().filter(|d| matches!(&d.room_ids[..], [room] if of(room))).collect()
}

/// Returns how many doors of patient rooms one sees from some place in a nurse station, and how many there are.
fn doors_in_sight(world: &World) -> (usize, usize) {
    let plan = &world.floorplan;
    let of = |kind: &'static str| plan.rooms.iter().filter(move |r| r.room_type == kind);
    let is_patient = |id: &String| plan.room(id).is_some_and(|r| r.room_type.starts_with("patient_room"));
    let halls: Vec<&Polygon> = plan.rooms.iter().filter(|r| r.circulation).map(|r| &r.polygon).collect();
    let openings: Vec<Rect> = plan.doors.iter().filter(|d| d.kind == DoorKind::Open).map(|d| around(d, 0.2)).collect();
    let sees = |station: &Polygon, from: Point, to: Point| {
        let steps = (from.distance(to) / 0.15).ceil();
        (0..steps as usize - 1).map(|n| n as f64 / steps).all(|t| {
            let p = Point::new(from.x + t * (to.x - from.x), from.y + t * (to.y - from.y));
            let here = Rect::new(p.x, p.y, p.x, p.y);
            station.contains(p) || halls.iter().any(|h| h.contains(p)) || openings.iter().any(|o| o.contains(&here))
        })
    };
    let views: Vec<(&Polygon, Vec<Point>)> = of("nurse_station")
        .map(|station| {
            let all = station.net_polygon.bounds();
            let grid = |from: f64, length: f64| (0..(length / 0.4) as usize).map(move |n| from + 0.2 + 0.4 * n as f64);
            let points =
                grid(all.x0, all.width()).flat_map(|x| grid(all.y0, all.height()).map(move |y| Point::new(x, y)));
            (&station.net_polygon, points.filter(|p| station.net_polygon.contains(*p)).collect())
        })
        .collect();
    let leads_in = |d: &&Door| {
        let from_hall = d.room_ids.iter().any(|id| plan.room(id).is_some_and(|r| r.circulation));
        from_hall && d.room_ids.iter().any(is_patient)
    };
    let doors: Vec<Point> = plan.doors.iter().filter(leads_in).map(|d| d.line.middle()).collect();
    let seen = doors.iter().filter(|to| views.iter().any(|(s, from)| from.iter().any(|p| sees(s, *p, **to)))).count();
    (seen, doors.len())
}

/// Returns the rectangle around a door that reaches `margin` m beyond its line.
fn around(door: &Door, margin: f64) -> Rect {
    let (a, b) = (door.line.start, door.line.end);
    Rect::new(a.x.min(b.x), a.y.min(b.y), a.x.max(b.x), a.y.max(b.y)).grown(margin)
}

#[test]
fn stations_see_the_doors_of_their_patients() {
    let cases = [
        ("hospital ward with 10 rooms", 0.9),
        ("hospital ward with 12 patient rooms and one nurse station", 0.5),
        ("racetrack hospital ward with 20 patient rooms and a nurse station", 0.5),
    ];
    for (prompt, least) in cases {
        let found: Vec<(usize, usize)> = worlds(prompt, 4).iter().map(doors_in_sight).collect();
        let share = |of: fn(&(usize, usize)) -> usize| found.iter().map(of).sum::<usize>() as f64;
        let seen = share(|f| f.0) / share(|f| f.1);
        assert!(seen >= least, "{prompt}: {seen:.2} of the doors, {found:?}");
    }
}

#[test]
fn ambulances_have_a_way_in_of_their_own() {
    for prompt in
        ["emergency department with 6 treatment rooms", "servicio de urgencias con triaje y 8 boxes en Sevilla"]
    {
        for world in worlds(prompt, 3) {
            assert_eq!(count(&world, "ambulance_entrance"), 1, "{prompt}");
            let doors = ways_in(&world, "ambulance_entrance");
            assert!(matches!(&doors[..], [door] if !door.entrance), "{prompt}: {doors:?}");
            let main: Vec<&Door> = world.floorplan.doors.iter().filter(|d| d.entrance).collect();
            assert!(matches!(&main[..], [door] if door.kind != DoorKind::Sliding), "{prompt}: {main:?}");
        }
    }
}

#[test]
fn kinds_of_health_buildings_are_read_as_such() {
    let cases = [
        ("hospital pharmacy with 3 rooms", "pharmacy", 1),
        ("hospital pharmacy and outpatient department in Dublin", "pharmacy", 1),
        ("blood donation centre with 8 donor chairs in Dublin", "infusion_bay", 1),
        // the eighth bed is that of its isolation room
        ("stroke unit with 8 monitored beds, Germany", "icu_room", 7),
        ("surgical department with 3 operating theatres", "operating_room", 3),
    ];
    for (prompt, kind, least) in cases {
        let world = worlds(prompt, 1).remove(0);
        assert!(count(&world, kind) >= least, "{prompt}: {} x {kind}", count(&world, kind));
    }
    let both = worlds("hospital pharmacy and outpatient department in Dublin", 1).remove(0);
    assert!(count(&both, "exam_room") >= 1);
}

#[test]
fn an_infectious_patient_has_a_toilet_of_the_own_room() {
    for world in worlds("infectious diseases ward with 4 isolation rooms", 2) {
        assert_eq!(count(&world, "isolation_room"), 4);
        assert_eq!(count(&world, "ensuite"), 4);
    }
}

#[test]
fn small_wards_have_a_dock_for_their_robot() {
    let mut held = Vec::new();
    for world in worlds("hospital ward with 8 rooms in Germany, for a delivery robot", 8) {
        held.push(world.placements.placements.iter().any(|p| p.object == "robot_dock"));
    }
    most("wards with a dock", 0.9, &held);
}

#[test]
fn who_sees_people_has_a_room_for_it() {
    let cases = [
        ("Cabinet médical pour quatre médecins généralistes et une infirmière à Lyon, accueil, salle d'attente", 4, 1),
        ("practice for three GPs and a nurse with reception and waiting room", 3, 1),
        ("Hausarztpraxis für drei Ärzte mit Labor, Empfang und Wartezimmer", 3, 0),
        ("centro de salud con seis médicos y dos enfermeras, recepción, sala de espera", 6, 2),
    ];
    for (prompt, exam, treatment) in cases {
        let world = worlds(prompt, 1).remove(0);
        assert_eq!(count(&world, "exam_room"), exam, "{prompt}");
        assert!(count(&world, "treatment_room") >= treatment, "{prompt}");
    }
    // rooms that are counted themselves stay as they are
    let world = worlds("clinic with two doctors, three exam rooms, reception and waiting room", 1).remove(0);
    assert_eq!(count(&world, "exam_room"), 3);
    let world = worlds("dental practice for three dentists, reception, waiting room", 1).remove(0);
    assert_eq!(count(&world, "dental_room"), 3);
}

#[test]
fn rooms_that_are_some_of_others_are_not_added_to_them() {
    let cases = [
        "ward with ten single rooms, two of which are isolation rooms, nurse station",
        "Station mit zehn Einzelzimmern, davon zwei Isolationszimmer, Stützpunkt",
        "ward with ten single rooms and a nurse station, two of the single rooms are isolation rooms",
    ];
    for prompt in cases {
        let world = worlds(prompt, 1).remove(0);
        assert_eq!((count(&world, "patient_room"), count(&world, "isolation_room")), (8, 2), "{prompt}");
    }
}

#[test]
fn each_resident_has_the_bathroom_that_all_have() {
    for prompt in [
        "Pflegeheim-Wohngruppe für 14 Bewohner mit Einzelzimmern und eigenen Bädern, Aufenthaltsraum",
        "care home for 14 residents with single rooms and private bathrooms, day room",
    ] {
        let world = worlds(prompt, 1).remove(0);
        assert_eq!((count(&world, "resident_room"), count(&world, "ensuite")), (14, 14), "{prompt}");
    }
}

#[test]
fn the_country_of_a_building_is_read_from_its_adjective() {
    for (prompt, code) in [
        ("Service d'urgences d'un hôpital français avec six box", Some("FR")),
        ("clínica dental española con tres salas", Some("ES")),
        ("deutsches Krankenhaus mit 8 Räumen", Some("DE")),
        ("ward of a german hospital with 8 rooms", Some("DE")),
        ("restaurante italiano con cocina y sala", None),
        ("Italienisches Restaurant mit Küche und Gastraum", None),
    ] {
        let world = worlds(prompt, 1).remove(0);
        assert_eq!(world.scene_graph.country_code.as_deref(), code, "{prompt}");
    }
}

#[test]
fn robots_that_disinfect_are_no_floor_cleaners() {
    for prompt in
        ["ward with 8 rooms and an autonomous disinfection robot", "Station mit 8 Räumen und UV-Desinfektionsroboter"]
    {
        let world = worlds(prompt, 1).remove(0);
        let kinds: Vec<&str> = world.scene_graph.robots.iter().map(|r| r.kind.as_str()).collect();
        assert_eq!(kinds, ["disinfection"], "{prompt}");
        assert!(world.scenario.robots.iter().all(|r| !r.goals.is_empty()), "{prompt}");
    }
}

#[test]
fn therapy_in_psychiatry_is_talk_and_every_scanner_has_its_control_room() {
    let world = worlds("psychiatric ward for 14 patients with day room and therapy rooms", 1).remove(0);
    assert_eq!((count(&world, "physiotherapy_gym"), count(&world, "group_therapy_room")), (0, 2));
    let prompt = "Radiology department with MRI, CT, two x-ray rooms, control rooms and a reporting room";
    for world in worlds(prompt, 2) {
        for (control, room) in
            [("mri_control_room", "mri_room"), ("ct_control_room", "ct_room"), ("xray_control_room", "xray_room")]
        {
            assert_eq!(count(&world, control), 1, "{control}");
            assert!(joined(&world, control, room), "{control} beside {room}");
        }
        assert!(!joined(&world, "mri_room", "corridor"), "the magnet is not entered from the corridor");
    }
}

/// Returns true where a door joins rooms of two types.
fn joined(world: &World, a: &str, b: &str) -> bool {
    let of = |id: &String| world.floorplan.room(id).map(|r| r.room_type.as_str());
    let meets =
        |d: &&Door| matches!(&d.room_ids[..], [x, y] if [(of(x), of(y)), (of(y), of(x))].contains(&(Some(a), Some(b))));
    world.floorplan.doors.iter().any(|d| meets(&d))
}

#[test]
fn lists_of_emergency_rooms_have_what_serves_them() {
    let prompt = "Service d'urgences : accueil, salle d'attente, tri, huit box de soins, une salle de déchocage, poste de soins, radiologie";
    let world = worlds(prompt, 1).remove(0);
    for kind in ["accessible_toilet", "clean_utility", "dirty_utility", "staff_room", "toilet", "ambulance_entrance"] {
        assert_eq!(count(&world, kind), 1, "{kind}");
    }
}

#[test]
fn surgeons_scrub_before_every_theatre() {
    let prompt = "Operating block with four theatres, recovery for six beds, staff changing rooms and sterile store";
    for world in worlds(prompt, 2) {
        assert_eq!((count(&world, "operating_room"), count(&world, "scrub_room")), (4, 2));
        let kind = |id: &String| world.floorplan.room(id).map(|r| r.room_type.as_str());
        for theatre in world.floorplan.rooms.iter().filter(|r| r.room_type == "operating_room") {
            let doors: Vec<&Door> = world.floorplan.doors_of(&theatre.room_id).collect();
            let from = |what: &str| doors.iter().any(|d| d.room_ids.iter().any(|id| kind(id) == Some(what)));
            assert!(from("scrub_room") && !from("corridor"), "{}", theatre.room_id);
        }
        for lobby in world.floorplan.rooms.iter().filter(|r| r.room_type == "scrub_room") {
            let sink =
                world.placements.placements.iter().any(|p| p.room_id == lobby.room_id && p.object == "scrub_sink");
            assert!(sink, "{} has a sink", lobby.room_id);
        }
    }
}

#[test]
fn newborns_have_staff_between_them() {
    let mut held = Vec::new();
    for world in worlds("maternity ward with 8 single rooms, two delivery rooms and a nursery", 3) {
        let beds: Vec<_> = world.placements.placements.iter().filter(|p| p.object == "bassinet").map(body).collect();
        assert!(beds.len() > 2, "{}", beds.len());
        for (i, a) in beds.iter().enumerate() {
            held.extend(beds[..i].iter().map(|b| gap(a, b) > 0.85));
        }
    }
    most("bassinets apart", 0.98, &held);
}

#[test]
fn single_rooms_keep_the_size_that_is_advised() {
    let mut held = Vec::new();
    for prompt in ["hospital ward with 5 rooms", "hospital ward with 8 rooms in Canada", "hospital with 10 rooms"] {
        for world in worlds(prompt, 5) {
            let singles = world.floorplan.rooms.iter().filter(|r| r.room_type == "patient_room");
            held.extend(singles.map(|r| r.net_area_m2 <= 18.01));
        }
    }
    most("single rooms of 18 m2 at most", 0.93, &held);
}

#[test]
fn each_resident_has_one_bathroom() {
    for world in worlds("care home with 18 residents", 3) {
        let rooms = world.floorplan.rooms.iter().filter(|r| r.room_type.starts_with("resident_room"));
        for room in rooms {
            let baths = world
                .floorplan
                .doors_of(&room.room_id)
                .filter(|d| d.room_ids.iter().any(|id| id.starts_with("ensuite")));
            assert_eq!(baths.count(), 1, "seed {}: {}", world.floorplan.seed, room.room_id);
        }
    }
}
