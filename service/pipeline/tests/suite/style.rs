//! The knobs of style move what they are named for, over many seeds, and leave worlds sound.

use std::sync::atomic::AtomicBool;

use d3dgen_model::Rect;
use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::{DoorKind, Floorplan};
use d3dgen_model::style::Style;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::{Settings, generate_world, retrieve};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::{floorplan, scene_graph};
use d3dgen_plugins::Registry;

const SEEDS: u64 = 20;

fn request(prompt: &str, seed: u64, words: &[&str]) -> Request {
    let style = Style::of_words(words.iter().copied()).unwrap();
    Request { prompt: prompt.into(), seed, style, ..Request::default() }
}

fn world(prompt: &str, seed: u64, words: &[&str]) -> World {
    let registry = Registry::builtin();
    let made = generate_world(
        &request(prompt, seed, words),
        &registry,
        &Settings::default(),
        &mut |_| (),
        &AtomicBool::new(false),
    )
    .unwrap();
    let broken: Vec<_> = made.report.rules.iter().flat_map(|r| &r.violations).collect();
    assert!(made.report.is_writable(), "{prompt} {words:?}, seed {seed}: {broken:?}");
    made.world
}

/// Returns the mean of a measure over the seeds.
fn mean(prompt: &str, words: &[&str], measure: impl Fn(&World) -> f64) -> f64 {
    (0..SEEDS).map(|seed| measure(&world(prompt, seed, words))).sum::<f64>() / SEEDS as f64
}

fn mean_room_area(world: &World) -> f64 {
    let areas: Vec<f64> = world.floorplan.rooms.iter().filter(|r| !r.circulation).map(|r| r.net_area_m2).collect();
    areas.iter().sum::<f64>() / areas.len() as f64
}

/// Returns the share of rooms to work in that are small ones with a door.
fn cellular_share(world: &World) -> f64 {
    let kinds: Vec<&str> = world.floorplan.rooms.iter().map(|r| r.room_type.as_str()).collect();
    let open = kinds.iter().filter(|k| **k == "open_office").count() as f64;
    let cells = kinds.iter().filter(|k| matches!(**k, "office" | "shared_office" | "team_office")).count() as f64;
    cells / (open + cells).max(1.0)
}

fn passages(world: &World) -> f64 {
    world.floorplan.doors.iter().filter(|d| d.kind == DoorKind::Open && d.room_ids.len() == 2).count() as f64
}

#[test]
fn compact_and_generous_move_the_mean_area_of_rooms() {
    // guidelines advise how large the rooms of a ward are; compact ones have no less
    let cases = [
        ("two-bedroom flat in Germany", 0.1, 0.1),
        ("office for 12 people", 0.1, 0.1),
        ("hospital ward with 8 rooms in Germany", -0.02, 0.02),
    ];
    for (prompt, less, more) in cases {
        let [compact, usual, generous] =
            [&["compact"][..], &[], &["generous"]].map(|words| mean(prompt, words, mean_room_area));
        println!("{prompt}: compact {compact:.1} m2, usual {usual:.1} m2, generous {generous:.1} m2");
        assert!(
            compact < (1.0 - less) * usual && usual * (1.0 + more) < generous,
            "{prompt}: {compact} {usual} {generous}"
        );
    }
}

#[test]
fn cellular_and_open_move_the_share_of_cells_and_the_openings() {
    let prompt = "office for 20 people";
    let [cellular, usual, open] = [&["cellular"][..], &[], &["open"]].map(|words| mean(prompt, words, cellular_share));
    println!("{prompt}: cellular {cellular:.2}, usual {usual:.2}, open {open:.2} of the work rooms are cells");
    assert!(cellular > 0.99 && usual > 0.05 && usual < 0.95 && open < 0.01, "{cellular} {usual} {open}");
    let prompt = "house with 3 bedrooms, kitchen, living room, dining room and bathroom";
    let [cellular, usual, open] = [&["cellular"][..], &[], &["open"]].map(|words| mean(prompt, words, passages));
    println!("{prompt}: cellular {cellular:.2}, usual {usual:.2}, open {open:.2} openings");
    assert!(cellular < 0.01 && open >= usual + 1.0, "{cellular} {usual} {open}");
}

/// Returns how alike a plan is on both sides of the better of two axes through the room one enters by: the share of each
/// room that its best counterpart covers when the plan is mirrored, by area.
fn likeness(plan: &Floorplan) -> f64 {
    let entrance = plan.doors.iter().find(|d| d.entrance).and_then(|d| plan.room(&d.room_ids[0])).unwrap();
    let rooms: Vec<Vec<Rect>> = plan.rooms.iter().map(|r| r.polygon.rects()).collect();
    let largest = |rects: &[Rect]| *rects.iter().max_by(|a, b| a.area().total_cmp(&b.area())).unwrap();
    let middle = largest(&entrance.polygon.rects()).center();
    let upright = |r: &Rect| Rect { x0: 2.0 * middle.x - r.x1, x1: 2.0 * middle.x - r.x0, ..*r };
    let level = |r: &Rect| Rect { y0: 2.0 * middle.y - r.y1, y1: 2.0 * middle.y - r.y0, ..*r };
    let area = |rects: &[Rect]| rects.iter().map(Rect::area).sum::<f64>();
    let common = |a: &[Rect], b: &[Rect]| -> f64 {
        let pair = |x: &Rect, y: &Rect| {
            (x.x1.min(y.x1) - x.x0.max(y.x0)).max(0.0) * (x.y1.min(y.y1) - x.y0.max(y.y0)).max(0.0)
        };
        a.iter().flat_map(|x| b.iter().map(move |y| pair(x, y))).sum()
    };
    let alike = |mirror: &dyn Fn(&Rect) -> Rect| {
        let covered = rooms.iter().map(|room| {
            let image: Vec<Rect> = room.iter().map(mirror).collect();
            let best = rooms.iter().map(|other| {
                let both = common(&image, other);
                both / (area(&image) + area(other) - both)
            });
            area(room) * best.fold(0.0, f64::max)
        });
        covered.sum::<f64>() / rooms.iter().map(|r| area(r)).sum::<f64>()
    };
    alike(&upright).max(alike(&level))
}

#[test]
fn symmetric_plans_are_more_alike_on_both_sides() {
    let registry = Registry::builtin();
    let mean = |prompt: &str, words: &[&str]| {
        let of = |seed| {
            let graph = scene_graph::generate(&request(prompt, seed, words), &registry).unwrap();
            let plugin = registry.get(&graph.domain).unwrap();
            let limits = retrieve(&graph, plugin).limits;
            likeness(&floorplan::generate(&graph, plugin.domain(), &limits, None).unwrap())
        };
        (0..SEEDS).map(of).sum::<f64>() / SEEDS as f64
    };
    let cases = [
        ("house with 4 bedrooms and 2 bathrooms", 0.3),
        ("10-room office", 0.4),
        ("hospital ward with 8 rooms in Germany", 0.2),
    ];
    for (prompt, gain) in cases {
        let [unlike, usual, alike] = [&["asymmetric"][..], &[], &["symmetric"]].map(|words| mean(prompt, words));
        println!("{prompt}: asymmetric {unlike:.2}, usual {usual:.2}, symmetric {alike:.2}");
        assert!(alike >= usual + gain && unlike <= usual + 0.03, "{prompt}: {unlike} {usual} {alike}");
    }
    for seed in 0..5 {
        world("house with 4 bedrooms and 2 bathrooms", seed, &["symmetric"]);
    }
}

/// Returns the share of the floor area of a plan whose mirror image, about the better of two axes through the middle, is a room of
/// the same zone; pieces of corridor are one room.
fn mirrored(plan: &Floorplan, domain: &Domain) -> f64 {
    let kind = |room_type: &str| domain.room_type_or_generic(room_type).zone;
    let (ways, rooms): (Vec<_>, Vec<_>) = plan.rooms.iter().partition(|r| r.circulation);
    let mut all: Vec<_> = rooms.iter().map(|r| (kind(&r.room_type), r.polygon.rects())).collect();
    all.extend(ways.first().map(|r| (kind(&r.room_type), ways.iter().flat_map(|w| w.polygon.rects()).collect())));
    let around = all.iter().flat_map(|(_, rects)| rects).copied().reduce(|a, b| a.union(&b)).unwrap();
    let c = around.center();
    let upright = |r: &Rect| Rect { x0: 2.0 * c.x - r.x1, x1: 2.0 * c.x - r.x0, ..*r };
    let level = |r: &Rect| Rect { y0: 2.0 * c.y - r.y1, y1: 2.0 * c.y - r.y0, ..*r };
    let area = |rects: &[Rect]| rects.iter().map(Rect::area).sum::<f64>();
    let common = |a: &[Rect], b: &[Rect]| -> f64 {
        let pair = |x: &Rect, y: &Rect| {
            (x.x1.min(y.x1) - x.x0.max(y.x0)).max(0.0) * (x.y1.min(y.y1) - x.y0.max(y.y0)).max(0.0)
        };
        a.iter().flat_map(|x| b.iter().map(move |y| pair(x, y))).sum()
    };
    let share = |mirror: &dyn Fn(&Rect) -> Rect| {
        let has_image = |(kind, rects): &&(_, Vec<Rect>)| {
            let image: Vec<Rect> = rects.iter().map(mirror).collect();
            all.iter().any(|(other, its)| other == kind && common(&image, its) > 0.98 * area(rects).max(area(its)))
        };
        let alike: f64 = all.iter().filter(has_image).map(|(_, rects)| area(rects)).sum();
        alike / all.iter().map(|(_, rects)| area(rects)).sum::<f64>()
    };
    share(&upright).max(share(&level))
}

#[test]
fn symmetric_plans_mirror_four_fifths_of_their_floor() {
    let registry = Registry::builtin();
    let prompts = [
        "symmetric flat with 2 bedrooms",
        "symmetric house with 8 rooms",
        "symmetric house with 4 bedrooms and 2 bathrooms",
        "symmetric 10-room office",
        "symmetrisches Büro mit 12 Räumen",
        "symmetric office with 16 rooms",
        "symmetric cellular office for 30 people",
        "symmetric hospital ward with 10 patient rooms",
        "symmetric primary school with 6 classrooms",
        "symmetric hotel with 12 guest rooms",
        "symmetric office with a courtyard and 24 rooms",
    ];
    let (mut symmetric, mut all) = (0, 0);
    for prompt in prompts {
        for seed in 0..5 {
            let graph = scene_graph::generate(&request(prompt, seed, &[]), &registry).unwrap();
            let plugin = registry.get(&graph.domain).unwrap();
            let limits = retrieve(&graph, plugin).limits;
            let plan = floorplan::generate(&graph, plugin.domain(), &limits, None).unwrap();
            let share = mirrored(&plan, plugin.domain());
            println!("{prompt}, seed {seed}: {share:.2}");
            let told = plan.conflicts.iter().any(|n| n.code == "not_symmetric");
            assert_eq!(told, share < 0.8, "{prompt}, seed {seed}: {share:.3}");
            assert_eq!(plan.rooms.len(), graph.rooms.len(), "{prompt}, seed {seed}");
            symmetric += usize::from(share >= 0.8);
            all += 1;
        }
    }
    assert!(symmetric * 10 >= all * 8, "{symmetric} of {all} plans are symmetric");
}

#[test]
fn words_of_the_prompt_work_as_flags_do() {
    let said = world("kompakte 3-Zimmer-Wohnung mit offenem Grundriss", 3, &[]);
    assert_eq!(said.scene_graph.style, Style::of_words(["compact", "open"]).unwrap());
    let flagged = world("3-Zimmer-Wohnung", 3, &["compact", "open"]);
    let areas = |w: &World| w.scene_graph.rooms.iter().map(|r| r.target_area_m2).collect::<Vec<_>>();
    assert_eq!(areas(&said), areas(&flagged));
}
