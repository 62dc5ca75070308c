//! Constraints of the shipped knowledge bases on built worlds: kept by one figure, broken by another, always with source.

use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

use d3dgen_knowledge::{Measure, Query, Retrieval, Stats, Sure, compliance, retrieve};
use d3dgen_model::Document;
use d3dgen_model::floorplan::Door;
use d3dgen_model::placements::Placement;
use d3dgen_model::report::{ConstraintResult, Status};
use d3dgen_model::world::World;
use d3dgen_model::{Point, Pose};

use crate::{REGISTRY, SAMPLES, Sample};
use d3dgen_pipeline::generate::{Settings, generate_world, retrieve as retrieve_world};
use d3dgen_pipeline::scene_graph::Request;

/// Returns the retrieval with every required figure replaced by one least figure, all conditions and people being told.
fn with_least(retrieval: &Retrieval, least: f64) -> Retrieval {
    let mut retrieval = Retrieval { persons_stated: true, ..retrieval.clone() };
    retrieval.constraints.iter_mut().for_each(|a| a.unsure = None);
    for rule in retrieval.constraints.iter_mut().filter_map(|a| a.decision.as_mut().ok()) {
        (rule.bounds.min, rule.bounds.max) = (Some(least), None);
    }
    retrieval
}

/// Returns what applies to a world wherever its knowledge base has rules and access is asked for.
fn everywhere(sample: &Sample) -> Vec<Retrieval> {
    let graph = &sample.world.scene_graph;
    let knowledge = REGISTRY.get(&graph.domain).unwrap().knowledge();
    let places: BTreeSet<&str> = knowledge.references.iter().map(|r| r.jurisdiction.as_str()).collect();
    let query = |place: &&str| Query {
        country_code: Some((*place).to_owned()),
        accessible: true,
        ..Query::of_graph(graph, sample.domain)
    };
    places.iter().map(|place| retrieve(knowledge, &query(place))).collect()
}

/// Worlds with what the common samples lack.
const MORE: [&str; 10] = [
    "hospital in the US with two exam rooms, a treatment room, a waiting area and three toilets",
    "office in the US with an open office for 12 people, a storage room next to a robot charging room, two delivery robots \
     and two cleaning robots",
    "hospital in India with two four-bed patient rooms and two delivery robots",
    "house in the US with three bedrooms, an ensuite, a garage and an entry hall for four people",
    "hospital ward in Germany with two four-bed patient rooms, a day room, an assisted bathroom and toilets",
    "intensive care unit in the US with two ICU bays and a nurse station",
    "office in the US with an open office for 70 people and toilets",
    "office in the US with an open office for 60 people, two meeting rooms, a kitchen, a storage room, an archive and toilets",
    "accessible flat in Australia with a bedroom and a toilet for two people",
    "two-bedroom flat with a robot vacuum that docks in the living room",
];

fn made(prompt: &str) -> Sample {
    let request = Request { prompt: prompt.to_owned(), seed: 7, ..Request::default() };
    let made = generate_world(&request, &REGISTRY, &Settings::default(), &mut |_| {}, &AtomicBool::new(false)).unwrap();
    let plugin = REGISTRY.get(&made.world.scene_graph.domain).unwrap();
    let retrieval = retrieve_world(&made.world.scene_graph, plugin);
    Sample { world: made.world, domain: plugin.domain(), retrieval }
}

/// Gap between the fronts of the two desks of [`facing_desks`], m.
const AISLE_M: f64 = 1.6;

/// Returns the office with nothing in its open office but two desks whose fronts face each other.
fn facing_desks() -> Sample {
    let sample = &SAMPLES[1];
    let mut world = sample.world.clone();
    let room = world.floorplan.rooms.iter().find(|r| r.room_type == "open_office").unwrap().clone();
    let middle = room.net_polygon.bounds().center();
    let all = &mut world.placements.placements;
    let mut desk = all.iter().find(|p| p.room_id == room.room_id && p.object == "desk").unwrap().clone();
    all.retain(|p| p.room_id != room.room_id);
    desk.group = None;
    for (n, yaw_rad, side) in [(1, 0.0, -1.0), (2, std::f64::consts::PI, 1.0)] {
        let x = middle.x + side * (AISLE_M + desk.size_m[1]) / 2.0;
        let pose = Pose { x, y: middle.y, yaw_rad, ..desk.pose };
        all.push(Placement { placement_id: format!("facing_{n}"), pose, ..desk.clone() });
    }
    Sample { world, domain: sample.domain, retrieval: sample.retrieval.clone() }
}

/// Returns the flat with two single beds, so far (m) apart, and nothing else in its first bedroom.
fn twin_beds(apart: f64) -> Sample {
    let sample = &SAMPLES[0];
    let mut world = sample.world.clone();
    let room = world.floorplan.rooms.iter().find(|r| r.room_type == "bedroom").unwrap().clone();
    let bounds = room.net_polygon.bounds();
    let all = &mut world.placements.placements;
    let bed = all.iter().find(|p| p.room_id == room.room_id && p.object.ends_with("bed")).unwrap().clone();
    all.retain(|p| p.room_id != room.room_id);
    for n in [0.0, 1.0] {
        let size_m = [0.9, 1.96, 0.5];
        let pose = Pose { x: bounds.x0 + 0.98, y: bounds.y0 + 0.6 + n * (0.9 + apart), yaw_rad: 0.0, ..bed.pose };
        let placement_id = format!("twin_{n}");
        all.push(Placement { placement_id, pose, size_m, object: "single_bed".into(), group: None, ..bed.clone() });
    }
    Sample { world, domain: sample.domain, retrieval: sample.retrieval.clone() }
}

/// Returns an office of so many people that it needs two exits, its corridor made straight with both of them at one place,
/// so that the corridor's ends are dead.
fn two_exits() -> Sample {
    let mut sample = made("office in the US with an open office for 70 people and toilets");
    let world = &mut sample.world;
    let corridor = world.floorplan.rooms.iter_mut().find(|r| r.circulation).unwrap();
    let b = corridor.net_polygon.bounds();
    corridor.net_polygon.0 =
        [(b.x0, b.y0), (b.x1, b.y0), (b.x1, b.y1), (b.x0, b.y1)].map(|(x, y)| Point::new(x, y)).to_vec();
    let room_ids = vec![corridor.room_id.clone()];
    let entrance = world.floorplan.doors.iter().find(|d| d.room_ids.len() == 1).unwrap().clone();
    for door_id in ["exit_a", "exit_b"] {
        world.floorplan.doors.push(Door { door_id: door_id.into(), room_ids: room_ids.clone(), ..entrance.clone() });
    }
    sample
}

/// Returns an office that one leaves by its entrance only.
fn one_exit() -> Sample {
    let sample = &SAMPLES[1];
    let mut world = sample.world.clone();
    world.floorplan.doors.retain(|d| d.room_ids.len() > 1 || d.entrance);
    Sample { world, domain: sample.domain, retrieval: sample.retrieval.clone() }
}

#[test]
fn worlds_aim_at_advice() {
    let prompts = [
        "two-bedroom flat in Germany",
        "four-bedroom house in the US, for a cleaning robot",
        "office in London with an open office for 12 people and two meeting rooms",
        "office in Austria with 8 rooms, for a delivery robot",
        "hospital ward with 8 rooms in Germany, for a delivery robot",
        "hospital in India with 6 rooms",
    ];
    let (mut kept, mut broken) = (0, 0);
    for prompt in prompts {
        let sample = made(prompt);
        let (_, summary) = compliance::evaluate(&sample.world, sample.domain, &sample.retrieval);
        kept += summary.satisfied;
        broken += summary.violated;
    }
    let share = f64::from(kept) / f64::from(kept + broken);
    assert!(share > 0.92, "{broken} of {} constraints are broken", kept + broken);
    // the sizes and the floor that are asked for beside a bed are known where it is placed
    let sample = made(prompts[0]);
    let bed = sample.domain.object("double_bed").unwrap();
    let aims = sample.retrieval.limits.objects.in_room(sample.domain, "bedroom", false);
    let aim = &aims["double_bed"];
    let best = aim.breaches.iter().min().unwrap();
    assert!(aim.breaches.iter().any(|b| b > best) && aim.clear.front > 0.9 && aim.clear.sides > 0.6, "{aim:?}");
    let size = sample.world.placements.placements.iter().find(|p| p.object == "double_bed").unwrap().size_m;
    let picked = bed.sizes_m.iter().position(|s| *s == size).unwrap();
    assert_eq!(aim.breaches[picked], *best, "of the sizes it comes in, one that breaks least");
}

#[test]
fn rules_for_twin_beds_hold_where_two_stand() {
    let gap = |apart| {
        let sample = twin_beds(apart);
        verdicts(&sample, &sample.world, "twin_bed_gap").first().map(|r| (r.status, r.measured))
    };
    assert_eq!(gap(0.9), Some((Status::Satisfied, Some(0.9))));
    assert_eq!(gap(0.6), Some((Status::Violated, Some(0.6))));
    let sample = &SAMPLES[0];
    assert!(verdicts(sample, &sample.world, "twin_bed_gap").is_empty(), "no room has two single beds");
}

/// Returns the verdicts on a world whose constraint id contains a name.
fn verdicts(sample: &Sample, world: &World, name: &str) -> Vec<ConstraintResult> {
    let (results, _) = compliance::evaluate(world, sample.domain, &sample.retrieval);
    results.into_iter().filter(|r| r.constraint_id.contains(name)).collect()
}

/// Returns the status and figure of the only verdict.
fn verdict(sample: &Sample, world: &World, name: &str) -> (Status, f64) {
    let found = verdicts(sample, world, name);
    let [only] = found.as_slice() else { panic!("{name}: {found:?}") };
    (only.status, only.measured.unwrap())
}

#[test]
fn aisles_between_desks_are_measured_front_to_front() {
    let sample = facing_desks();
    assert_eq!(verdict(&sample, &sample.world, "back_to_back_desk_aisle"), (Status::Satisfied, AISLE_M));
    let mut narrow = sample.world.clone();
    let desk = narrow.placements.placements.iter_mut().find(|p| p.placement_id == "facing_2").unwrap();
    desk.pose.x -= 0.3;
    let found = verdicts(&sample, &narrow, "back_to_back_desk_aisle");
    assert_eq!(found.len(), 2, "each desk is reported");
    assert!(found.iter().all(|r| r.status == Status::Violated && r.measured == Some(1.3)), "{found:?}");
}

#[test]
fn sizes_of_objects_are_held_against_their_rules() {
    let sample = facing_desks();
    let resized = |depth: f64| {
        let mut world = sample.world.clone();
        let desks = world.placements.placements.iter_mut().filter(|p| p.object.ends_with("desk"));
        desks.for_each(|p| p.size_m = [1.6, depth, 0.74]);
        world
    };
    assert_eq!(verdict(&sample, &resized(0.85), "desk_depth"), (Status::Satisfied, 0.85));
    assert_eq!(verdict(&sample, &resized(0.85), "desk_surface").0, Status::Satisfied);
    assert_eq!(verdict(&sample, &resized(0.85), "desk_standard"), (Status::Satisfied, 0.0));
    let small = resized(0.6);
    assert!(verdicts(&sample, &small, "desk_depth").iter().all(|r| r.measured == Some(0.6)));
    for name in ["desk_depth", "desk_surface", "desk_standard"] {
        let found = verdicts(&sample, &small, name);
        assert!(!found.is_empty() && found.iter().all(|r| r.status == Status::Violated), "{name}: {found:?}");
    }
    // 0.8 m less a tenth is 0.72 m: 0.12 m more than there is
    assert!(verdicts(&sample, &small, "desk_standard").iter().all(|r| r.measured == Some(0.12)));
}

#[test]
fn toilets_are_measured_from_their_middle_to_what_stands_beside() {
    let sample = &SAMPLES[0];
    let mut world = sample.world.clone();
    let all = &mut world.placements.placements;
    let toilet = all.iter().find(|p| p.object == "toilet").unwrap().clone();
    all.retain(|p| p.room_id != toilet.room_id || p.placement_id == toilet.placement_id);
    let room = world.floorplan.room(&toilet.room_id).unwrap().net_polygon.bounds();
    let place = |world: &mut World, from_wall: f64| {
        let p = world.placements.placements.iter_mut().find(|p| p.placement_id == toilet.placement_id).unwrap();
        p.pose = Pose { x: room.x0 + from_wall, y: room.y0 + toilet.size_m[1] / 2.0, z: 0.0, ..toilet.pose };
        p.pose.yaw_rad = std::f64::consts::FRAC_PI_2;
    };
    place(&mut world, 0.45);
    assert_eq!(verdict(sample, &world, "toilet_centerline_to_side"), (Status::Satisfied, 0.45));
    place(&mut world, 0.30);
    assert_eq!(verdict(sample, &world, "toilet_centerline_to_side"), (Status::Violated, 0.3));
}

/// Returns the one verdict on a constraint of the office whose condition is or is not told, with this least figure.
fn with_condition(unsure: Option<&str>, least: f64) -> ConstraintResult {
    let sample = &SAMPLES[1];
    let name = "corridor_width";
    let mut retrieval = sample.retrieval.clone();
    retrieval.constraints.retain(|a| a.constraint.name.contains(name) && a.decision.is_ok());
    retrieval.constraints.truncate(1);
    for a in &mut retrieval.constraints {
        a.unsure = unsure.map(str::to_owned);
        let rule = a.decision.as_mut().expect("kept above");
        (rule.bounds.min, rule.bounds.max) = (Some(least), None);
    }
    compliance::evaluate(&sample.world, sample.domain, &retrieval).0.remove(0)
}

#[test]
fn a_condition_that_nobody_tells_leaves_only_broken_figures_open() {
    assert_eq!(with_condition(None, 90.0).status, Status::Violated);
    let open = with_condition(Some("depends on sprinklers"), 90.0);
    assert_eq!(open.status, Status::NotDecidable);
    assert!(open.note.starts_with("depends on sprinklers"), "{}", open.note);
    assert!(open.measured.is_some(), "the reader sees how far it is off");
    let kept = with_condition(Some("depends on sprinklers"), 0.1);
    assert_eq!(kept.status, Status::Satisfied);
    assert!(kept.note.contains("kept either way: depends on sprinklers"), "{}", kept.note);
}

#[test]
fn facilities_by_head_count_are_judged_where_the_head_count_is_stated() {
    let sample = made("office in the UK with an open office and toilets for 20 people");
    let statuses = |persons_stated| {
        let retrieval = Retrieval { persons_stated, ..sample.retrieval.clone() };
        let (results, _) = compliance::evaluate(&sample.world, sample.domain, &retrieval);
        let about = results.into_iter().filter(|r| r.constraint_id.contains("wc_cubicles_by_people"));
        about.map(|r| r.status).collect::<Vec<_>>()
    };
    assert!(!statuses(true).is_empty() && !statuses(true).contains(&Status::NotDecidable));
    assert_eq!(statuses(false), [Status::NotDecidable]);
}

#[test]
fn the_floor_around_a_toilet_counts_the_floor_under_it() {
    let sample = &SAMPLES[0];
    let retrieval = everywhere(sample).into_iter().find(|r| r.jurisdictions.iter().any(|j| j == "US")).unwrap();
    let sample = Sample { world: sample.world.clone(), domain: sample.domain, retrieval };
    let mut world = sample.world.clone();
    let all = &mut world.placements.placements;
    let toilet = all.iter().find(|p| p.object == "toilet").unwrap().clone();
    all.retain(|p| p.room_id != toilet.room_id || p.placement_id == toilet.placement_id);
    let room = world.floorplan.room(&toilet.room_id).unwrap().net_polygon.bounds();
    let own = world.placements.placements.iter_mut().find(|p| p.placement_id == toilet.placement_id).unwrap();
    let pose =
        Pose { x: room.x0 + 0.45, y: room.y0 + toilet.size_m[1] / 2.0, z: 0.0, yaw_rad: std::f64::consts::FRAC_PI_2 };
    own.pose = pose;
    let (id, whole) = ("toilet_clearance_width_depth", (room.width() * 1000.0).round() / 1000.0);
    assert_eq!(verdict(&sample, &world, id).1, whole, "nothing else stands there");
    // a box half a meter wide at the far wall takes its width, whatever is free beside the toilet
    let pose = Pose { x: room.x1 - 0.25, y: room.y0 + 0.3, ..pose };
    let placement =
        Placement { placement_id: "box_1".into(), pose, size_m: [0.6, 0.5, 0.9], object: "vanity".into(), ..toilet };
    world.placements.placements.push(Placement { pose: Pose { yaw_rad: 0.0, ..pose }, ..placement });
    let left = verdict(&sample, &world, id).1;
    assert!((left - (whole - 0.5)).abs() < 1e-3, "{left} of {whole}");
}

#[test]
fn sizes_by_bedspaces_are_asked_of_dwellings_for_so_many() {
    let asked = |prompt: &str| -> BTreeSet<String> {
        let sample = made(prompt);
        let about = verdicts(&sample, &sample.world, "residential_gb_gia_").into_iter();
        // what no document tells is listed, too
        let decided = about.filter(|r| r.status != Status::NotDecidable);
        decided.map(|r| r.name).filter(|n| n.starts_with("gia_")).collect()
    };
    let one = asked("one-bedroom flat in the UK");
    assert!(one.len() == 1 && one.iter().all(|n| n.starts_with("gia_1b")), "{one:?}");
    let three = asked("three-bedroom flat in the UK");
    assert!(three.iter().all(|n| n.starts_with("gia_3b")) && three.len() <= 1, "{three:?}");
}

/// Returns the measures of what was found with this status, all results being complete.
fn measures(sample: &Sample, retrieval: &Retrieval, status: Status) -> BTreeSet<Measure> {
    let (results, summary) = compliance::evaluate(&sample.world, sample.domain, retrieval);
    let decided = results.iter().filter(|r| r.status != Status::NotDecidable);
    let ids: BTreeSet<&str> = decided.clone().map(|r| r.constraint_id.as_str()).collect();
    assert_eq!(ids.len(), (summary.satisfied + summary.violated) as usize, "{}", sample.world.name);
    for r in decided.clone() {
        assert!(r.measured.is_some() && r.required_min.or(r.required_max).is_some(), "{}", r.constraint_id);
        assert!(!r.unit.is_empty() && !r.subject.is_empty(), "{}", r.constraint_id);
        assert!(!r.citation.source.title.is_empty() && !r.citation.jurisdiction.is_empty(), "{}", r.constraint_id);
    }
    let with: BTreeSet<&str> = decided.filter(|r| r.status == status).map(|r| r.constraint_id.as_str()).collect();
    let about = retrieval.constraints.iter().filter(|a| with.contains(a.constraint.constraint_id.as_str()));
    about.filter_map(|a| Some(a.decision.as_ref().ok()?.quantity.measure)).collect()
}

/// Returns the measures that constraints ask for, with the one verdict some of them are sure of.
fn asked(retrieval: &Retrieval) -> impl Iterator<Item = (Measure, Option<Sure>)> {
    let rules = retrieval.constraints.iter().filter_map(|a| a.decision.as_ref().ok());
    rules.map(|rule| (rule.quantity.measure, rule.quantity.sure))
}

#[test]
fn every_measure_at_hand_is_kept_by_one_figure_and_broken_by_another() {
    let (mut kept, mut broken) = (BTreeSet::new(), BTreeSet::new());
    let mut wanted = BTreeSet::new();
    let more = MORE.map(made);
    let moved = [facing_desks(), twin_beds(0.9), two_exits(), one_exit()];
    for sample in SAMPLES.iter().chain(&more).chain(&moved) {
        for retrieval in everywhere(sample) {
            wanted.extend(asked(&retrieval));
            kept.extend(measures(sample, &with_least(&retrieval, -1e9), Status::Satisfied));
            broken.extend(measures(sample, &with_least(&retrieval, 1e9), Status::Violated));
        }
    }
    // whether a room is needed goes by the head count: the figure is one room, whatever the constraint says
    wanted.retain(|(measure, _)| *measure != Measure::RoomNeededAbovePersons);
    let never = |verdicts: &BTreeSet<Measure>, unsure: Sure| -> BTreeSet<Measure> {
        let sure = wanted.iter().filter(|(_, sure)| sure.is_none_or(|s| s != unsure)).map(|(measure, _)| *measure);
        sure.filter(|measure| !verdicts.contains(measure)).collect()
    };
    assert_eq!(never(&kept, Sure::Broken), BTreeSet::new(), "kept in no world");
    assert_eq!(never(&broken, Sure::Kept), BTreeSet::new(), "broken in no world");
    assert!(kept.len() >= 90, "{} measures: {kept:?}", kept.len());
}

#[test]
fn a_shipped_figure_that_a_changed_world_breaks_is_reported_at_its_subject() {
    let sample = &SAMPLES[1];
    let mut world = sample.world.clone();
    let entry = world.floorplan.doors.iter_mut().find(|d| d.room_ids.len() == 2 && d.swing.is_some()).unwrap();
    entry.clear_width_m = 0.3;
    let id = entry.door_id.clone();
    let at_door = |world| {
        let (results, _) = compliance::evaluate(world, sample.domain, &sample.retrieval);
        results.into_iter().filter(|r| r.subject == id && r.status == Status::Violated).collect::<Vec<_>>()
    };
    let (before, after) = (at_door(&sample.world), at_door(&world));
    assert!(after.len() > before.len());
    assert!(after.iter().any(|r| r.measured == Some(0.3) && r.required_min.is_some_and(|m| m > 0.3)));
}

#[test]
fn shipped_knowledge_exceeds_the_papers_counts_and_most_of_it_is_decided() {
    let paper = [("residential", 24, 138, 12, 3), ("office", 29, 172, 16, 4), ("hospital", 41, 160, 82, 9)];
    for (domain, references, constraints, room_types, jurisdictions) in paper {
        let plugin = REGISTRY.get(domain).unwrap();
        let stats = Stats::of(plugin.knowledge(), plugin.domain(), plugin.knowledge().to_json().len());
        assert!(stats.references > references, "{domain}: {} references", stats.references);
        assert!(stats.constraints > constraints, "{domain}: {} constraints", stats.constraints);
        assert!(stats.room_types > room_types, "{domain}: {} room types", stats.room_types);
        assert!(stats.jurisdictions > jurisdictions, "{domain}: {} jurisdictions", stats.jurisdictions);
        assert_eq!(stats.confidence.values().sum::<usize>(), stats.constraints);
        assert_eq!(stats.decided + stats.not_decidable.values().sum::<usize>(), stats.constraints);
        assert!(stats.share_decided >= 0.68, "{domain}: {:.3} decided", stats.share_decided);
        let both_ways = (stats.decided - stats.decided_one_way) as f64 / stats.constraints as f64;
        assert!(both_ways >= 0.55, "{domain}: {both_ways:.3} decided either way");
    }
}
