//! Truly different plans of one request: seeds whose plans share as little as possible, whichever way they are turned.

use d3dgen_knowledge::Limits;
use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::geometry::Rect;
use d3dgen_model::scene_graph::SceneGraph;

use d3dgen_model::stage::{Error, Stop};
use d3dgen_plugins::Registry;

use crate::generate::{plugin_of, retrieve};
use crate::scene_graph::Request;
use crate::{brief, floorplan};

/// Plans made for each one wanted.
const POOL: usize = 5;

/// A plan among several of one graph.
#[derive(Debug, Clone)]
pub struct Variation {
    /// The plan; `seed` is in it.
    pub plan: Floorplan,
    /// Cost of the layout search, lower is better.
    pub cost: f64,
    /// Share of the floor, 0 to 1, whose use differs from the most similar of the others.
    pub difference: f64,
}

/// Returns `count` plans of a graph that differ as much as the pool allows, the best plan of the pool first.
///
/// The pool has five plans for each one wanted, of the graph's seed and those after it; the first is the cheapest, and
/// each next one is farthest from those chosen (Gonzalez 1985). Each is the plan that its seed gives by itself. What is
/// locked in `pinned` stays in all of them.
///
/// # Errors
/// `Infeasible` when no seed of the pool gives a plan, as [`floorplan::generate`] otherwise; `Cancelled`.
pub fn variations(
    graph: &SceneGraph,
    domain: &Domain,
    limits: &Limits,
    pinned: Option<&Floorplan>,
    count: usize,
    stop: Stop<'_>,
) -> Result<Vec<Variation>, Error> {
    let plan = |seed| {
        let graph = SceneGraph { seed, ..graph.clone() };
        floorplan::generate_until(&graph, domain, limits, pinned, stop)
    };
    choose(graph.seed, count, plan)
}

/// Returns seeds, from that of a request on, whose worlds have plans that differ as [`variations`] do.
///
/// # Errors
/// As [`variations`], and those of the scene graph.
pub fn seeds(request: &Request, registry: &Registry, count: usize, stop: Stop<'_>) -> Result<Vec<Variation>, Error> {
    let plan = |seed| {
        let (graph, _) = brief::rooms(&Request { seed, ..request.clone() }, registry)?;
        let plugin = plugin_of(registry, &graph)?;
        floorplan::generate_until(&graph, plugin.domain(), &retrieve(&graph, plugin).limits, None, stop)
    };
    choose(request.seed, count, plan)
}

/// Makes a pool of plans and chooses those that differ most.
fn choose(first: u64, count: usize, plan: impl Fn(u64) -> Result<Floorplan, Error>) -> Result<Vec<Variation>, Error> {
    let mut pool: Vec<(f64, Floorplan)> = Vec::new();
    let mut refused = None;
    for offset in 0..(count * POOL) as u64 {
        match plan(first.wrapping_add(offset)) {
            Ok(plan) => pool.push((plan.cost.iter().map(|c| c.cost).sum(), plan)),
            Err(error @ Error::Infeasible { .. }) => refused = refused.or(Some(error)),
            Err(error) => return Err(error),
        }
    }
    pool.sort_by(|a, b| a.0.total_cmp(&b.0));
    let shapes: Vec<Shape> = pool.iter().map(|(_, plan)| Shape::new(plan)).collect();
    let Some(best) = shapes.first() else {
        let message = String::from("no plan was asked for");
        return Err(refused.unwrap_or(Error::Infeasible { stage: "floorplan", message }));
    };
    let mut nearest: Vec<f64> = shapes.iter().map(|s| best.difference(s)).collect();
    let mut chosen = vec![0];
    while chosen.len() < count.min(pool.len()) {
        let farthest = (0..pool.len())
            .filter(|i| !chosen.contains(i))
            .max_by(|&a, &b| nearest[a].total_cmp(&nearest[b]).then(b.cmp(&a)));
        let Some(next) = farthest else { break };
        chosen.push(next);
        for (i, shape) in shapes.iter().enumerate() {
            nearest[i] = nearest[i].min(shapes[next].difference(shape));
        }
    }
    let difference = |i: usize| {
        let others = chosen.iter().filter(|&&j| j != i).map(|&j| shapes[i].difference(&shapes[j]));
        others.fold(1.0, f64::min)
    };
    let out = chosen.iter().map(|&i| Variation { plan: pool[i].1.clone(), cost: pool[i].0, difference: difference(i) });
    Ok(out.collect())
}

/// Which use lies where, about the middle of the building.
struct Shape {
    rects: Vec<(String, i32, Rect)>,
    area_m2: f64,
}

impl Shape {
    fn new(plan: &Floorplan) -> Self {
        let corners = plan.rooms.iter().flat_map(|r| r.polygon.corners());
        let (mut low, mut high) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
        for p in corners {
            low = (low.0.min(p.x), low.1.min(p.y));
            high = (high.0.max(p.x), high.1.max(p.y));
        }
        let (cx, cy) = ((low.0 + high.0) / 2.0, (low.1 + high.1) / 2.0);
        let moved = |r: Rect| Rect { x0: r.x0 - cx, y0: r.y0 - cy, x1: r.x1 - cx, y1: r.y1 - cy };
        let rects: Vec<(String, i32, Rect)> = plan
            .rooms
            .iter()
            .flat_map(|r| r.polygon.rects().into_iter().map(|b| (r.room_type.clone(), r.level, moved(b))))
            .collect();
        let area_m2 = rects.iter().map(|(_, _, r)| r.area()).sum();
        Self { rects, area_m2 }
    }

    /// Returns the share of the floor whose use differs, under the best of the eight turns and mirrorings.
    fn difference(&self, other: &Self) -> f64 {
        let alike = (0..8).map(|turn| self.alike_m2(other, turn)).fold(0.0, f64::max);
        1.0 - alike / self.area_m2.max(other.area_m2).max(1e-9)
    }

    fn alike_m2(&self, other: &Self, turn: u8) -> f64 {
        let turned = |r: &Rect| {
            let (xa, xb) = if turn & 1 == 0 { (r.x0, r.x1) } else { (-r.x1, -r.x0) };
            let (ya, yb) = if turn & 2 == 0 { (r.y0, r.y1) } else { (-r.y1, -r.y0) };
            if turn & 4 == 0 { Rect::new(xa, ya, xb, yb) } else { Rect::new(ya, xa, yb, xb) }
        };
        let mut sum = 0.0;
        for (kind, level, rect) in &other.rects {
            let rect = turned(rect);
            for (_, _, own) in self.rects.iter().filter(|(k, l, _)| k == kind && l == level) {
                sum += own.common_area(&rect);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variations_differ_more_than_seeds_in_a_row() {
        let registry = Registry::builtin();
        for prompt in ["apartment with a living room, a kitchen, two bedrooms and a bathroom", "office with 9 rooms"] {
            let request = Request { prompt: prompt.into(), seed: 3, ..Request::default() };
            let graph = crate::scene_graph::generate(&request, &registry).expect(prompt);
            let plugin = registry.get(&graph.domain).expect("built in");
            let limits = retrieve(&graph, plugin).limits;
            let found = variations(&graph, plugin.domain(), &limits, None, 4, Stop::never()).expect(prompt);
            assert_eq!(found.len(), 4);
            let row: Vec<Shape> = (3..7)
                .map(|seed| SceneGraph { seed, ..graph.clone() })
                .map(|g| Shape::new(&floorplan::generate(&g, plugin.domain(), &limits, None).expect(prompt)))
                .collect();
            let closest = |shapes: &[Shape]| {
                let pairs = shapes.iter().enumerate().flat_map(|(i, a)| shapes[i + 1..].iter().map(move |b| (a, b)));
                pairs.map(|(a, b)| a.difference(b)).fold(1.0, f64::min)
            };
            let chosen: Vec<Shape> = found.iter().map(|v| Shape::new(&v.plan)).collect();
            assert!(closest(&chosen) >= closest(&row), "{prompt}");
            assert!(
                found.iter().all(|v| v.difference > 0.2),
                "{prompt}: {:?}",
                found.iter().map(|v| v.difference).collect::<Vec<_>>()
            );
            // the plan is the one that its seed gives
            let own = SceneGraph { seed: found[1].plan.seed, ..graph.clone() };
            assert_eq!(floorplan::generate(&own, plugin.domain(), &limits, None).expect(prompt), found[1].plan);
        }
    }

    #[test]
    fn a_plan_does_not_differ_from_itself_turned() {
        let registry = Registry::builtin();
        let request = Request { prompt: "two-bedroom flat".into(), seed: 1, ..Request::default() };
        let graph = crate::scene_graph::generate(&request, &registry).expect("a graph");
        let plugin = registry.get(&graph.domain).expect("built in");
        let limits = retrieve(&graph, plugin).limits;
        let plan = floorplan::generate(&graph, plugin.domain(), &limits, None).expect("a plan");
        let shape = Shape::new(&plan);
        let mut mirrored = Shape::new(&plan);
        for (_, _, r) in &mut mirrored.rects {
            *r = Rect::new(-r.y1, r.x0, -r.y0, r.x1);
        }
        assert!(shape.difference(&mirrored) < 1e-9);
    }
}
