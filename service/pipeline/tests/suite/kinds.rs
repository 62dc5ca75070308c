//! Buildings of every kind: what they are counted by is there, and so is what makes the kind.

use d3dgen_model::floorplan::PlanRoom;
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;
use d3dgen_model::{Point, sanitary};
use d3dgen_plugins::Registry;

use crate::common::{body, count, in_room, most, named, rooms, worlds};

/// Seeds that each prompt is tried with.
const SEEDS: u64 = 2;

/// Prompts with what they count: the rooms, the objects in them, and how many there are in all.
const COUNTED: [(&str, &str, &str, usize); 14] = [
    ("gym with a spinning room for 20 bikes", "spinning_studio", "spin_bike", 20),
    ("parking garage for 60 cars", "parking_hall", "parked_car", 60),
    ("dairy barn for 80 cows", "barn_hall", "cow_stall", 80),
    ("stable for 12 horses", "stable_hall", "horse_box", 12),
    ("data center with 40 racks", "data_hall", "server_rack", 40),
    ("supermarket with five checkouts", "sales_floor", "checkout_counter", 5),
    ("hair salon with six chairs", "salon_floor", "salon_chair", 6),
    ("슈퍼마켓 계산대 6개, 정육 코너, 베이커리, 창고와 하역장", "sales_floor", "checkout_counter", 6),
    ("hostel with four eight-bed dorms with bunk beds", "dorm_room", "bunk_bed", 16),
    ("post office with five counters and a sorting room", "post_hall", "teller_counter", 5),
    ("airport terminal with six check-in desks", "check_in_hall", "check_in_desk", 6),
    (
        "dental laboratory with a milling room with 3 milling machines and an office",
        "dental_milling_room",
        "dental_mill",
        3,
    ),
    ("veterinary clinic with an inpatient room with 9 cages and a reception", "kennel_room", "kennel_cage", 9),
    (
        "Tierarztpraxis mit Stationsraum mit 6 Käfigen, zwei Behandlungsräumen und Empfang",
        "kennel_room",
        "kennel_cage",
        6,
    ),
];

/// Prompts with rooms that are told by what is in them.
const CALLED: [(&str, &str, usize); 5] = [
    ("airport terminal with four gates", "gate_lounge", 4),
    ("train station with two platforms", "platform_hall", 2),
    ("fire station with three engines", "vehicle_bay", 3),
    ("cinema with two screens", "auditorium", 2),
    ("shopping mall with eight shops", "mall_unit", 8),
];

/// Prompts of kinds with a room and an object by which one knows them without its label.
const KNOWN_BY: [(&str, &str, &str); 50] = [
    ("prison with 12 cells", "guard_post", "control_console"),
    ("Gefängnis mit 8 Zellen", "prison_cell", "combination_wc"),
    ("indoor swimming pool", "pool_hall", "lifeguard_chair"),
    ("piscine couverte", "pool_hall", "life_ring"),
    ("BSL-3 laboratory", "containment_lab", "biosafety_cabinet"),
    ("embassy with visa section", "visa_section", "teller_counter"),
    ("airport terminal", "security_checkpoint", "security_lane"),
    ("train station", "platform_hall", "rail_track"),
    ("car parts factory with an assembly line", "assembly_hall", "assembly_station"),
    ("newsroom of a daily newspaper", "broadcast_studio", "studio_camera"),
    ("town hall with council chamber", "council_chamber", "presiding_table"),
    ("field hospital with 20 beds", "field_ward", "camp_bed"),
    ("theatre with 150 seats", "theatre_hall", "theatre_stage"),
    ("milking parlour in a dairy barn", "milking_parlour", "milking_stand"),
    ("print shop with a reception", "print_hall", "printing_press"),
    ("Steinmetzbetrieb mit Büro", "stone_hall", "bridge_saw"),
    ("déchetterie avec un bureau", "collection_hall", "skip_container"),
    ("autoescuela con dos aulas", "simulator_room", "driving_simulator"),
    ("schronisko dla zwierząt", "kennel_hall", "dog_run"),
    ("гончарная мастерская с магазином", "throwing_room", "pottery_wheel"),
    ("cantina vinicola con negozio", "barrel_cellar", "barrel_rack"),
    ("柔道場と更衣室", "mat_hall", "mat_field"),
    ("jeugdhuis met een keuken", "youth_room", "sofa"),
    ("ateliê de costura com provador", "sewing_workshop", "sewing_table"),
    ("密室逃脱馆", "puzzle_room", "safe"),
    ("푸드뱅크", "food_hand_out", "shop_counter"),
    ("marina office with showers", "reception", "small_reception_desk"),
    ("tattoo studio with three cabins", "tattoo_cabin", "massage_table"),
    ("bookshop with a reading corner for children", "book_shop", "double_bookshelf"),
    ("palestra di arrampicata con area boulder", "climbing_area", "climbing_wall"),
    ("Boulderhalle mit Umkleiden und Café", "bouldering_area", "bouldering_wall"),
    ("casa de leilões com sala de leilões e dois escritórios", "saleroom", "auction_rostrum"),
    ("agência dos correios com triagem e cais de carga", "mail_sorting_room", "sorting_frame"),
    ("паромный терминал с залом ожидания", "boarding_gate", "ticket_gate"),
    ("stadsarchief met een leeszaal", "archive_store", "mobile_shelving"),
    ("sąd z dwiema salami rozpraw", "courtroom", "judges_bench"),
    ("Dentallabor mit Gipsraum, Fräsraum und Büro", "dental_plaster_room", "worktop_sink"),
    ("dental laboratory with a milling room and a ceramics room", "dental_milling_room", "dental_mill"),
    ("recording studio with an editing suite and two vocal booths", "vocal_booth", "stool"),
    ("녹음 스튜디오, 라이브룸 1개, 편집실 2개, 휴게실", "editing_suite", "control_console"),
    ("radio station with two studios and a control room", "studio_control_room", "control_console"),
    ("музей с двумя выставочными залами и кассой", "ticket_desk", "shop_counter"),
    ("Bäckerei mit Backstube und Verkaufstheke", "bakery_shop", "shop_counter"),
    ("健身房，25米泳池，男女更衣室和淋浴间", "pool_hall", "lifeguard_chair"),
    ("hemeroteca y sala infantil en una biblioteca municipal", "reading_room", "dining_chair"),
    ("小学校、教室6つ、職員室、体育館", "gym", "court_lines"),
    ("lavanderia a gettoni con 12 lavatrici", "laundry_hall", "washing_machine"),
    ("autodealer met een werkplaats", "car_showroom", "display_car"),
    ("каток с раздевалками", "ice_hall", "ice_sheet"),
    ("kręgielnia z barem", "bowling_hall", "bowling_lane"),
];

/// Rooms of one trade that a building of another was given for a word that both use.
const OF_ANOTHER_TRADE: [(&str, &str); 4] = [
    ("музей с тремя выставочными залами, гардеробом, кассой и кафе", "checkout"),
    ("Kino mit drei Sälen, Foyer mit Kasse und Popcorntheke", "bar"),
    ("Bäckerei mit Café für 20 Gäste, Backstube und Verkaufstheke", "bar"),
    ("recording studio with a live room and a control room", "ct_control_room"),
];

#[test]
fn a_room_is_of_the_trade_of_its_building() {
    for (prompt, strange) in OF_ANOTHER_TRADE {
        for world in worlds(prompt, SEEDS) {
            assert_eq!(rooms(&world, strange).count(), 0, "{prompt} has a {strange}");
        }
    }
}

#[test]
fn what_is_counted_is_there() {
    for (prompt, room_type, object, wanted) in COUNTED {
        let held: Vec<bool> = worlds(prompt, SEEDS).iter().map(|w| count(w, room_type, object) == wanted).collect();
        most(prompt, 1.0, &held);
    }
}

#[test]
fn rooms_are_told_by_what_they_are_called_in_such_a_building() {
    for (prompt, room_type, wanted) in CALLED {
        let held: Vec<bool> = worlds(prompt, SEEDS).iter().map(|w| rooms(w, room_type).count() == wanted).collect();
        most(prompt, 1.0, &held);
    }
}

#[test]
fn every_kind_has_what_makes_it() {
    for (prompt, room_type, object) in KNOWN_BY {
        let held: Vec<bool> = worlds(prompt, SEEDS).iter().map(|w| count(w, room_type, object) > 0).collect();
        most(prompt, 1.0, &held);
    }
}

/// Places of work and of the public in several countries.
const WORKED_IN: [&str; 4] = [
    "建筑设计事务所，24个工位，两间会议室，前台和展示区",
    "office in Berlin for 24 people with two meeting rooms",
    "agence de 12 postes à Lyon avec une salle de réunion",
    "laundromat with 12 washers",
];

#[test]
fn every_place_of_work_has_a_toilet_for_wheelchairs() {
    for prompt in WORKED_IN {
        for world in worlds(prompt, 1) {
            let there = rooms(&world, "accessible_toilet").count();
            assert!(there > 0, "{prompt}: {:?}", world.scene_graph.assumptions);
        }
    }
}

/// Rooms for so many people with what they sit on and how many have a place on each.
const SEATED: [(&str, &str, &str, usize, usize); 4] = [
    ("university building with a lecture hall for 200 students", "lecture_hall", "chair_row", 4, 200),
    ("hotel with 14 rooms and a breakfast room for 44 guests", "breakfast_room", "dining_chair", 1, 44),
    ("courthouse with two courtrooms for 60 spectators each and a waiting area", "courtroom", "church_pew", 4, 120),
    ("community centre with an event room for 150 people and a kitchen", "event_room", "chair_row", 4, 150),
];

#[test]
fn rooms_grow_until_everybody_has_a_seat() {
    for (prompt, room_type, object, each, wanted) in SEATED {
        for world in worlds(prompt, SEEDS) {
            let seats = each * count(&world, room_type, object);
            assert!((wanted..wanted + 4).contains(&seats), "{prompt}: {seats} seats of {wanted}");
        }
    }
}

/// Rooms that the kind of building has none of, by what makes them such a room.
const BORROWED: [(&str, &str, &str); 3] = [
    ("office for 12 people with a courtroom and a sauna", "courtroom", "church_pew"),
    ("primary school with four classrooms, a waiting area and an x-ray room", "xray_room", "bucky_stand"),
    ("Büro für 8 Personen mit Maschinenhalle, Besprechungsraum und Lager", "machine_hall", "panel_saw"),
];

#[test]
fn a_room_of_another_kind_of_building_is_furnished_as_there() {
    for (prompt, room_type, object) in BORROWED {
        for world in worlds(prompt, 1) {
            assert!(count(&world, room_type, object) > 0, "{prompt}: {:?}", world.scene_graph.assumptions);
            let said = world.scene_graph.assumptions.iter().any(|note| note.code == "room_borrowed");
            assert!(said, "{prompt} does not say where the room is from");
        }
    }
}

/// Rooms by names that no lexicon has, with what they are and an object that such a room has.
const TOLD_BY_A_PART: [(&str, &str, &str); 8] = [
    ("crematorium with a bouquet room and a chapel", "flower_workroom", "flower_buckets"),
    ("community centre with a luthier's room and an office", "workshop", "workbench"),
    ("sports club with a sumo hall and changing rooms", "mat_hall", "mat_field"),
    ("Gemeindehaus mit Saal, Küche und Textilraum", "sewing_workshop", "sewing_table"),
    ("centre culturel avec une salle de sérigraphie et un bureau", "print_hall", "printing_press"),
    ("carnicería con sala de despiece y vestuario", "butchery", "prep_table"),
    ("dom kultury z salą taneczną i biblioteką", "fitness_studio", "wall_mirror"),
    ("公民館 多目的ホール、陶芸室、事務室", "throwing_room", "pottery_wheel"),
];

#[test]
fn a_room_that_no_lexicon_has_is_furnished_by_a_part_of_its_name() {
    for (prompt, room_type, object) in TOLD_BY_A_PART {
        for world in worlds(prompt, 1) {
            assert!(count(&world, room_type, object) > 0, "{prompt}: {:?}", world.scene_graph.rooms);
            let said = world.scene_graph.assumptions.iter().any(|note| note.code == "room_likely");
            assert!(said, "{prompt} does not say as what the room was furnished");
        }
    }
}

#[test]
fn a_room_that_tells_nothing_has_a_table_chairs_and_cupboards() {
    for prompt in [
        "museum with a lobby, two exhibition rooms and a flumbarium",
        "office with a flumbarium, two offices and a lobby",
    ] {
        for world in worlds(prompt, SEEDS) {
            let room = world.floorplan.rooms.iter().find(|r| r.room_type == "flumbarium").expect("it is asked for");
            assert!(in_room(&world, &room.room_id).count() >= 5, "{prompt}: the room is bare");
            assert!(world.scene_graph.assumptions.iter().any(|note| note.code == "unknown_room"), "{prompt}");
        }
    }
}

/// Lists of rooms that leave out what the kind is there for, which joins them.
const WITHOUT_THE_HEART: [(&str, &str); 5] = [
    ("bookshop with a till, a store and a staff toilet", "book_shop"),
    ("kindergarten with a kitchen, a staff room and a pram store", "group_room"),
    ("Infusionszentrum mit Labor und Personalraum", "infusion_bay"),
    ("coworking space with two meeting rooms and a cafe", "open_office"),
    ("dance studio with a reception and showers", "fitness_studio"),
];

#[test]
fn a_list_without_the_heart_of_its_kind_gets_it() {
    for (prompt, room_type) in WITHOUT_THE_HEART {
        for world in worlds(prompt, 1) {
            assert!(rooms(&world, room_type).count() > 0, "{prompt}: {:?}", world.scene_graph.rooms);
        }
    }
}

/// Lists of rooms that name no toilet.
const WITHOUT_TOILETS: [&str; 6] = [
    "museum with three exhibition rooms, a lobby and a store",
    "mosque for 120 worshippers with a prayer hall, an ablution room and an imam's office",
    "Bibliothek mit Lesesaal, Kinderbereich und Büro",
    "workshop building with a workshop, a store and an office for two",
    "restaurant with a dining room for 80 guests and a kitchen",
    "two-storey community center: an event room and a cafe on the ground floor, two training rooms and an office upstairs",
];

#[test]
fn a_list_without_toilets_gets_them_on_every_storey_that_visitors_come_to() {
    let registry = Registry::builtin();
    for prompt in WITHOUT_TOILETS {
        for world in worlds(prompt, 1) {
            let domain = registry.get(&world.scene_graph.domain).expect("built in").domain();
            assert_eq!(sanitary::without_accessible(&world.scene_graph, domain), Vec::<i32>::new(), "{prompt}");
            assert!(!sanitary::is_left_out(&world.scene_graph), "{prompt}: {:?}", world.scene_graph.conflicts);
        }
    }
}

#[test]
fn a_restaurant_has_toilets_for_its_guests() {
    for world in worlds("restaurant with a dining room for 150 guests and a kitchen", SEEDS) {
        let closets = |room: &PlanRoom| in_room(&world, &room.room_id).filter(|p| is_closet(p)).count();
        let all: usize = world.floorplan.rooms.iter().map(closets).sum();
        // 150 people at 75 a closet, women and men for themselves, and one for wheelchairs
        assert!(all >= 3, "{all} closets");
        let names: Vec<&str> = world.floorplan.rooms.iter().map(|r| r.name.as_str()).collect();
        assert!(
            names.iter().any(|n| n.starts_with("Women")) && names.iter().any(|n| n.starts_with("Men")),
            "{names:?}"
        );
    }
}

fn is_closet(p: &Placement) -> bool {
    ["toilet", "wc_cubicle", "accessible_wc"].contains(&p.object.as_str())
}

#[test]
fn tills_stand_in_one_line_between_the_shelves_and_the_way_out() {
    let held: Vec<bool> = worlds("supermarket with five checkouts", SEEDS).iter().map(are_before_the_exit).collect();
    most("tills before the way out", 1.0, &held);
}

/// Returns true where all tills are in one line and no shelf in the middle of the floor is nearer to the entrance.
fn are_before_the_exit(world: &World) -> bool {
    let Some(floor) = rooms(world, "sales_floor").next() else { return false };
    let tills = named(world, floor, "checkout_counter");
    let Some(door) = world.floorplan.doors.iter().find(|d| d.entrance) else { return false };
    let (middle, wall) = (door.line.middle(), door.line);
    let upright = (wall.start.x - wall.end.x).abs() < (wall.start.y - wall.end.y).abs();
    let away = |p: &Placement| {
        let at = body(p).center();
        if upright { (at.x - middle.x).abs() } else { (at.y - middle.y).abs() }
    };
    let line: Vec<f64> = tills.iter().map(|p| away(p)).collect();
    let (near, far) = (line.iter().copied().fold(f64::MAX, f64::min), line.iter().copied().fold(0.0, f64::max));
    let shelves = named(world, floor, "gondola_shelf");
    let behind = shelves.iter().filter(|p| away(p) > far).count();
    far - near < 0.3 && 5 * behind >= 4 * shelves.len()
}

#[test]
fn screens_and_stages_are_away_from_where_one_comes_in() {
    let mut held = Vec::new();
    for (prompt, room_type, shown) in [
        ("cinema with two screens", "auditorium", "cinema_screen"),
        ("theatre with 150 seats", "theatre_hall", "theatre_stage"),
    ] {
        for world in worlds(prompt, SEEDS) {
            for room in rooms(&world, room_type) {
                let stage = named(&world, room, shown);
                let doors = || world.floorplan.doors_of(&room.room_id).map(|d| d.line.middle());
                let behind = |p: &&Placement| {
                    // all doors are nearer to the back wall than to what is shown
                    let size = room.net_polygon.bounds();
                    let reach = if p.pose.yaw_rad.sin().abs() < 0.5 { size.width() } else { size.height() };
                    doors().all(|d| d.distance(Point::new(p.pose.x, p.pose.y)) > 0.3 * reach)
                };
                held.push(stage.iter().any(behind));
            }
        }
    }
    most("screens away from the doors", 0.8, &held);
}

/// Prompts with the lock they name, and what lies behind it, whether they say so or not.
const LOCKED: [(&str, &str, &str); 7] = [
    (
        "veterinary clinic with an isolation room behind an airlock, two exam rooms and a reception",
        "lab_airlock",
        "isolation_room",
    ),
    ("Labor mit Schleuse, zwei Laborräumen, Umkleide und Pausenraum", "lab_airlock", "laboratory"),
    ("recording studio with a live room, a control room, a sound lock and a lounge", "sound_lock", "live_room"),
    ("estudio de grabación con sala de grabación, esclusa acústica y sala de montaje", "sound_lock", "live_room"),
    ("factory with a clean room, an airlock, an office and a locker room", "lab_airlock", "clean_room"),
    ("animal shelter with a quarantine and an airlock", "lab_airlock", "animal_quarantine"),
    (
        "veterinary clinic with a surgery, a preparation room, an exam room and a reception",
        "theatre_preparation_room",
        "vet_surgery",
    ),
];

#[test]
fn what_a_lock_is_there_for_is_entered_through_it_alone() {
    for (prompt, lock, behind) in LOCKED {
        for world in worlds(prompt, SEEDS) {
            let id = |kind: &str| {
                let rooms = world.floorplan.rooms.iter().filter(|r| r.room_type == kind);
                rooms.map(|r| r.room_id.clone()).next().unwrap_or_else(|| panic!("{prompt}: no {kind}"))
            };
            let (lock, inner) = (id(lock), id(behind));
            let doors = world.floorplan.doors.iter().filter(|d| d.room_ids.contains(&inner));
            let from: Vec<&String> = doors.flat_map(|d| &d.room_ids).filter(|id| **id != inner).collect();
            assert_eq!(from, [&lock], "{prompt}: {behind}");
        }
    }
}

#[test]
fn a_lock_that_leads_nowhere_is_said() {
    let prompt = "insurance office with an airlock, three offices, a meeting room and a toilet";
    for world in worlds(prompt, SEEDS) {
        assert_eq!(rooms(&world, "lab_airlock").count(), 1, "{prompt}");
        let mut said = world.scene_graph.conflicts.iter();
        assert!(said.any(|note| note.code == "lock_leads_nowhere"), "{:?}", world.scene_graph.conflicts);
    }
}

/// Prompts with more floor than their rooms need, the room that people are counted for, and how many there are.
const ROOMY: [(&str, &str, u32); 4] = [
    (
        "ferry terminal, 900 m2, with three ticket counters, a waiting hall with 80 seats, left luggage and toilets",
        "waiting_area",
        80,
    ),
    ("Bibliothek 1200 m2 mit Lesesaal für 20 Personen, zwei Büros und Magazin", "reading_room", 20),
    ("museo de 800 m2 con una cafetería para 16 personas y dos salas de exposición", "cafe", 16),
    ("laboratory of 700 m2 with a waiting area for 15 people, two laboratories and an office", "waiting_area", 15),
];
/// Most floor for each who waits, reads or eats there in a building with floor to spare, m2.
const MOST_EACH_M2: f64 = 8.0;

#[test]
fn floor_to_spare_blows_no_room_up() {
    for (prompt, kind, people) in ROOMY {
        for world in worlds(prompt, SEEDS) {
            let most = rooms(&world, kind).map(|r| r.net_area_m2).fold(0.0, f64::max);
            assert!(most > 0.0, "{prompt}: no {kind}");
            assert!(most <= MOST_EACH_M2 * f64::from(people), "{prompt}: {kind} of {most:.0} m2");
        }
    }
}
