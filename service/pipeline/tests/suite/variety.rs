//! Fifty seeds of one prompt give fifty different plans, not one plan turned, mirrored or scaled.

use std::collections::BTreeSet;

use d3dgen_model::floorplan::Floorplan;
use d3dgen_pipeline::generate::retrieve;
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::{floorplan, scene_graph};
use d3dgen_plugins::Registry;

const SEEDS: u64 = 50;
/// Plans that another seed gives too, at most: a ward of six rooms has few good ones.
const MOST_ALIKE: usize = 1;
/// Least share of plans with a room or an outline that is no rectangle.
const SHAPED: f64 = 0.15;

/// Which rooms doors join, by type, and where every room lies on a 10 cm raster, whichever way the plan is turned.
type Signature = (Vec<[String; 2]>, Vec<(String, [i64; 4])>);

fn signature(plan: &Floorplan) -> Signature {
    let kind = |id: &String| plan.room(id).map_or_else(|| id.clone(), |r| r.room_type.clone());
    let mut joined: Vec<[String; 2]> = plan
        .doors
        .iter()
        .filter_map(|d| <&[String; 2]>::try_from(d.room_ids.as_slice()).ok())
        .map(|[a, b]| {
            let mut pair = [kind(a), kind(b)];
            pair.sort();
            pair
        })
        .collect();
    joined.sort();
    let boxes: Vec<(String, [f64; 4])> = plan
        .rooms
        .iter()
        .map(|r| (r.room_type.clone(), r.polygon.bounds()))
        .map(|(kind, b)| (kind, [b.x0, b.y0, b.x1, b.y1]))
        .collect();
    let turned = (0..8).map(|turn| {
        let moved = boxes.iter().map(|(kind, [x0, y0, x1, y1])| {
            let (xa, xb) = if turn & 1 == 0 { (*x0, *x1) } else { (-x1, -x0) };
            let (ya, yb) = if turn & 2 == 0 { (*y0, *y1) } else { (-y1, -y0) };
            (kind.clone(), if turn & 4 == 0 { [xa, ya, xb, yb] } else { [ya, xa, yb, xb] })
        });
        let moved: Vec<(String, [f64; 4])> = moved.collect();
        let low = |i: usize| moved.iter().map(|m| m.1[i]).fold(f64::MAX, f64::min);
        let (x, y) = (low(0), low(1));
        let raster = |v: f64| (v * 10.0).round() as i64;
        let mut cells: Vec<(String, [i64; 4])> = moved
            .into_iter()
            .map(|(kind, [x0, y0, x1, y1])| (kind, [raster(x0 - x), raster(y0 - y), raster(x1 - x), raster(y1 - y)]))
            .collect();
        cells.sort();
        cells
    });
    (joined, turned.min().unwrap_or_default())
}

/// Returns true when a room is no rectangle, or the building is none.
fn is_shaped(plan: &Floorplan) -> bool {
    let bounds = plan.rooms.iter().map(|r| r.polygon.bounds()).reduce(|a, b| a.union(&b));
    let covered: f64 = plan.rooms.iter().map(|r| r.polygon.area()).sum();
    let notched = bounds.is_some_and(|b| covered < b.area() - 0.5);
    notched || plan.rooms.iter().any(|r| !r.circulation && r.polygon.corners().len() > 4)
}

/// Returns the plans of a prompt that the seeds from 0 give.
fn plans(prompt: &str) -> Vec<Floorplan> {
    let registry = Registry::builtin();
    let plan = |seed| {
        let request = Request { prompt: prompt.into(), seed, ..Request::default() };
        let graph = scene_graph::generate(&request, &registry).expect("a plain prompt");
        let plugin = registry.get(&graph.domain).expect("a shipped domain");
        floorplan::generate(&graph, plugin.domain(), &retrieve(&graph, plugin).limits, None).ok()
    };
    let made: Vec<Floorplan> = (0..SEEDS).filter_map(plan).collect();
    assert!(made.len() as u64 >= SEEDS * 4 / 5, "`{prompt}`: {} of {SEEDS} seeds gave a plan", made.len());
    made
}

#[test]
fn seeds_give_different_plans_and_many_are_no_boxes() {
    let prompts = [
        "family house in Germany with 8 rooms",
        "office in the United States with 10 rooms",
        "hospital ward with 10 rooms",
        "Three patient rooms, a nurse station and a medication room",
        "one-bedroom flat",
    ];
    for prompt in prompts {
        let plans = plans(prompt);
        let seen: BTreeSet<Signature> = plans.iter().map(signature).collect();
        let alike = plans.len() - seen.len();
        assert!(alike <= MOST_ALIKE, "`{prompt}`: {alike} of {} plans are those of another seed", plans.len());
        let share = plans.iter().filter(|plan| is_shaped(plan)).count() as f64 / plans.len() as f64;
        assert!(share >= SHAPED, "`{prompt}`: {:.0} % of the plans have more than rectangles", 100.0 * share);
    }
}

#[test]
fn tiny_flats_differ_and_have_small_bathrooms() {
    for prompt in ["studio flat", "flat with 2 rooms"] {
        let plans = plans(prompt);
        let area = |plan: &Floorplan, kinds: &[&str]| -> f64 {
            let named = plan.rooms.iter().filter(|r| kinds.contains(&r.room_type.as_str()));
            named.map(|r| r.net_polygon.area()).sum()
        };
        let small = |plan: &&Floorplan| area(plan, &["bathroom"]) < 0.6 * area(plan, &["studio", "living_room"]);
        let good = plans.iter().filter(small).count();
        assert!(good >= plans.len() - 2, "`{prompt}`: {good} of {} bathrooms are small", plans.len());
        // so few rooms have few arrangements, which two of fifty seeds may share
        let seen: BTreeSet<Signature> = plans.iter().map(signature).collect();
        assert!(seen.len() >= plans.len() - 4, "`{prompt}`: {} different ones of {} plans", seen.len(), plans.len());
    }
}
