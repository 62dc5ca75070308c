//! Several storeys: each is planned by itself around the common core, the ground floor first, the others above it.

use d3dgen_knowledge::Limits;
use d3dgen_model::domain::{Domain, Scheme, Storeys, Zone};
use d3dgen_model::floorplan::{CostTerm, Floorplan};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::scene_graph::{Note, SceneGraph};
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::{Error, Stop};
use d3dgen_model::storeys::{Level, LinkKind};
use d3dgen_model::style::Form;

use super::align::align;
use super::assemble::{Turn, assemble, turned_in_place};
use super::core::{Below, Core, in_core, merged, overhang};
use super::cost::open_share;
use super::genome::is_nestable;
use super::lattice::{CELL_M2, Cellbox, INNER_HALF_M, meters, nearest};
use super::party::Party;
use super::search::search;
use super::spec::{Brief, RoomSpec};
use super::{ATTEMPTS, LONGEST_BAR, net_area_m2, schemes};

/// Share of a storey that may jut out over the one below, and from which on it is said.
pub(crate) const OVERHANG_SHARE: f64 = 0.06;
const TOLD_SHARE: f64 = 0.02;
/// Share that may while there are few plans to compare, and how many are few.
const LITTLE_OVERHANG: f64 = 0.04;
const FEW_PLANS: usize = 3;
/// Plans of a storey that are compared when the first ones jut out further.
const COMPARED: usize = 6;
const COMPARED_LARGE: usize = 2;
/// How often a home is stacked at most, and how ragged a stack may be that is taken at once.
const STACKS: usize = 4;
const WELL_STACKED: f64 = 0.06;
/// The same of other buildings that are no wings, where a storey juts out further than it may without a word.
const STACKS_OF_OTHERS: usize = 3;
/// What makes a stack ragged: the share of a storey that juts out, that which the one above leaves open, in homes that of the rectangle
/// around it which it leaves open, and the share of hall and stairs beyond the usual one.
const JUTS: f64 = 3.0;
const SET_BACK: f64 = 0.3;
const NOTCHED: f64 = 0.3;
const USUAL_WAY: f64 = 0.15;
const LONG_WAY: f64 = 0.6;
/// Longest storey, about, that is one bar between two stairs, m: others walk less in wings.
const LONGEST_BAR_M: f64 = 64.0;
/// Heights of storeys are whole multiples of this, m.
const HEIGHT_STEP_M: f64 = 0.05;

/// Depth of rooms along a corridor by the side of a square of their area, and its range, m.
const DEPTH_BY_SIDE: f64 = 0.75;
const USUAL_DEPTH_M: f64 = 4.8;
const MOST_DEPTH_M: f64 = 10.0;

/// A planned storey.
struct Planned {
    plan: Floorplan,
    below: Below,
    overhang: f64,
    /// Share of the storey below that it leaves open.
    set_back: f64,
    /// Share of it that is hall and stairs.
    way: f64,
    /// Share of the rectangle around it that it leaves open.
    open: f64,
}

impl Planned {
    /// Returns how ragged it makes a stack of storeys, of a home how much of it is ways too.
    fn ragged(&self, home: bool) -> f64 {
        let way = if home { LONG_WAY * (self.way - USUAL_WAY).max(0.0) + NOTCHED * self.open } else { 0.0 };
        JUTS * self.overhang + SET_BACK * self.set_back + way
    }
}

/// Plans a building of several storeys.
///
/// # Errors
/// As [`super::generate`]; `Mismatch` for storeys that nothing joins.
pub(crate) fn generate(
    graph: &SceneGraph,
    domain: &Domain,
    limits: &Limits,
    stop: Stop<'_>,
) -> Result<Floorplan, Error> {
    let mismatch = |message: String| Error::Mismatch { stage: "floorplan", message };
    let storeys = domain.circulation.storeys.as_ref().ok_or_else(|| {
        mismatch(format!("domain `{}` says nothing of stairs; its buildings have one storey", domain.id))
    })?;
    let mut rng = Stream::new(graph.seed, "floorplan");
    let turn = Turn { flip_x: rng.chance(0.5), flip_y: rng.chance(0.5), swap: rng.chance(0.3) };
    let numbers = graph.level_numbers();
    let mut briefs = Vec::new();
    for &level in &numbers {
        let mut brief = Brief::new(&graph.storey(level), domain, limits)?;
        brief.vary(&mut rng);
        brief.party = brief.attached.map(Party::of);
        briefs.push(brief);
    }
    let ground = numbers.iter().position(|&l| l == 0).unwrap_or(0);
    carry(&mut briefs[ground..]);
    for upper in ground + 1..briefs.len() {
        let rooms = briefs[upper].rooms.iter().filter(|r| !r.circulation);
        briefs[upper - 1].carries = rooms.map(|r| r.area_target).sum();
    }
    let heights: Vec<f64> = briefs.iter().map(|b| height(b, storeys)).collect();
    let tallest = heights.iter().copied().fold(0.0, f64::max);
    for (i, brief) in briefs.iter_mut().enumerate() {
        let core = Core::new(brief, graph, domain, tallest);
        let missing = || mismatch(format!("level {} has no stairs in `links`", numbers[i]));
        brief.core = Some(core.ok_or_else(missing)?);
        raise_stairwells(brief, graph, (i + 1 < numbers.len()).then(|| heights[i] - 0.01));
    }
    // two stairs of a storey that is one bar are at its ends; where that does not work out it has wings, which are nearer to no
    // other form either
    let mut bars = briefs.iter().all(|b| {
        let along = b.rooms.iter().filter(|r| r.host.is_none()).count();
        let two = b.core.as_ref().is_some_and(|c| c.far.is_some());
        along <= LONGEST_BAR && b.form != Some(Form::Wings) && two
    });
    let least = briefs.iter().map(bar_length).max().unwrap_or(0);
    bars &= meters(least) <= LONGEST_BAR_M;
    briefs.iter_mut().filter_map(|b| b.core.as_mut()).for_each(|c| c.least = least);
    let order = (ground..numbers.len()).map(|i| (i, i.checked_sub(1).filter(|_| i > ground)));
    let order: Vec<(usize, Option<usize>)> = order.chain((0..ground).rev().map(|i| (i, Some(i + 1)))).collect();
    let plan = Plan { graph, domain, turn, numbers: &numbers, order: &order };
    loop {
        briefs.iter_mut().filter_map(|b| b.core.as_mut()).for_each(|c| c.gable = bars);
        match plan.best_stack(&mut briefs, stop) {
            Ok(planned) => return Ok(stacked(graph, planned, &numbers, &heights, ground)),
            Err(Error::Infeasible { .. }) if bars => bars = false,
            Err(error) => return Err(error),
        }
    }
}

/// Makes each storey as large as those above it where its rooms may be larger, and these smaller by half of what it lacks: what is
/// larger than the storey below hangs in the air. What is advised of areas yields where that is not enough. The lowest comes first.
fn carry(briefs: &mut [Brief]) {
    for advised in [true, false] {
        for upper in (1..briefs.len()).rev() {
            let lacks = |briefs: &[Brief]| (all_m2(&briefs[upper]) - all_m2(&briefs[upper - 1])).max(0.0);
            let smaller = if advised { lacks(briefs) / 2.0 } else { 0.0 };
            resize(&mut briefs[upper], -smaller, advised);
            let larger = lacks(briefs);
            resize(&mut briefs[upper - 1], larger, advised);
            let left = lacks(briefs);
            resize(&mut briefs[upper], -left, advised);
        }
    }
}

/// Returns the areas that the rooms of a storey are to have together, m^2.
fn all_m2(brief: &Brief) -> f64 {
    brief.rooms.iter().map(|r| r.area_target).sum()
}

/// Changes the areas aimed for of rooms that people use by so much together, m^2, as far as they may change: as `advised`, or as
/// their rules allow.
fn resize(brief: &mut Brief, by: f64, advised: bool) {
    let used = |r: &RoomSpec| !r.circulation && matches!(r.zone, Zone::Day | Zone::Night | Zone::Public | Zone::Staff);
    let all: f64 = brief.rooms.iter().filter(|r| used(r)).map(|r| r.area_target).sum();
    if by == 0.0 || all <= 0.0 {
        return;
    }
    let mut changed = 0.0;
    for room in brief.rooms.iter_mut().filter(|r| used(r)) {
        let [least, most] = room.limits.area_advised.filter(|_| advised).unwrap_or([0.0, f64::MAX]);
        let low = (1.02 * room.area_min).max(least).min(room.area_target);
        let high = (0.98 * room.area_max).min(most).max(room.area_target);
        let area = (room.area_target * (1.0 + by / all)).clamp(low, high);
        changed += area - room.area_target;
        room.area_target = area;
    }
    brief.area = brief.area.map(|area| area + changed);
}

/// Returns about how long a storey is whose rooms stand on both sides of one corridor, lattice units.
fn bar_length(brief: &Brief) -> i32 {
    let depth = |area: f64| (DEPTH_BY_SIDE * area.sqrt()).clamp(USUAL_DEPTH_M, MOST_DEPTH_M);
    let room = |&i: &usize| Some(i) != brief.spine && !brief.in_core(i);
    let fronts = (0..brief.rooms.len()).filter(room).map(|i| {
        let spec = &brief.rooms[i];
        let front = (spec.area_target / depth(spec.area_target)).max(spec.min_dimension) + 2.0 * INNER_HALF_M;
        // half of the small ones are cut out of larger rooms
        if is_nestable(brief, i) { 0.5 * front } else { front }
    });
    let fronts: Vec<f64> = fronts.collect();
    let core = brief.core.as_ref().map_or(0.0, |c| meters(c.width + c.far.map_or(0, |far| far.1)));
    let half = (core + fronts.iter().sum::<f64>()) / 2.0;
    nearest(fronts.into_iter().fold(half, f64::max))
}

/// What the storeys of one building have in common.
struct Plan<'a> {
    graph: &'a SceneGraph,
    domain: &'a Domain,
    turn: Turn,
    numbers: &'a [i32],
    /// Storeys as they are planned, each with the one that it goes by.
    order: &'a [(usize, Option<usize>)],
}

impl Plan<'_> {
    /// Plans the storeys one after the other, from the ground up and then down. What stands well above depends on what is
    /// below: a home is stacked a few times, another building where it juts out, and the best stack is taken.
    fn best_stack(&self, briefs: &mut [Brief], stop: Stop<'_>) -> Result<Vec<Planned>, Error> {
        let homes = briefs.iter().all(|b| b.of_home);
        let stacks = if homes { STACKS } else { STACKS_OF_OTHERS };
        let mut best: Option<(f64, Vec<Planned>)> = None;
        let mut failed = None;
        for n in 0..stacks {
            let done = match self.stack(briefs, n, stop) {
                Ok(stack) => {
                    let juts = stack.iter().any(|p| p.overhang > OVERHANG_SHARE && p.below.comb.is_none());
                    let ragged = stack.iter().map(|p| p.ragged(homes)).sum::<f64>();
                    if best.as_ref().is_none_or(|b| ragged < b.0) {
                        best = Some((ragged, stack));
                    }
                    !homes && !juts
                }
                Err(error) => {
                    failed = failed.or(Some(error));
                    !homes
                }
            };
            stop.check()?;
            if done || best.as_ref().is_some_and(|b| b.0 <= WELL_STACKED) {
                break;
            }
        }
        match best {
            Some((_, planned)) => Ok(planned),
            None => Err(failed.expect("every stack is planned or fails")),
        }
    }

    /// Plans all storeys, for the `n`-th time.
    fn stack(&self, briefs: &mut [Brief], n: usize, stop: Stop<'_>) -> Result<Vec<Planned>, Error> {
        let mut planned: Vec<Option<Planned>> = self.numbers.iter().map(|_| None).collect();
        for &(i, next_to) in self.order {
            if let Some(core) = &mut briefs[i].core {
                core.below = next_to.and_then(|n| planned[n].as_ref()).map(|p| p.below.clone());
            }
            let level = self.numbers[i];
            let name = format!("floorplan/level/{level}");
            let name = if n == 0 { name } else { format!("{name}/again/{n}") };
            let mut rng = Stream::new(self.graph.seed, &name);
            let found = storey(&briefs[i], self.domain, (self.turn, self.graph.seed), &mut rng, stop);
            stop.check()?;
            let infeasible =
                |reason: String| Error::Infeasible { stage: "floorplan", message: format!("level {level}: {reason}") };
            planned[i] = Some(found.map_err(infeasible)?);
        }
        Ok(planned.into_iter().flatten().collect())
    }
}

/// Returns the height of a storey from floor to floor, m.
pub(crate) fn height(brief: &Brief, storeys: &Storeys) -> f64 {
    let ceiling = brief.rooms.iter().map(|r| {
        let by_rule = r.limits.ceiling_height(r.area_max).unwrap_or(0.0);
        r.ceiling_height.max(if r.circulation { 0.0 } else { by_rule })
    });
    let clear = ceiling.fold(0.0, f64::max) + storeys.slab_m;
    to_mm((clear / HEIGHT_STEP_M - 1e-6).ceil() * HEIGHT_STEP_M)
}

/// Flights go up through the ceiling; over those of the highest storey it is a usual one.
pub(crate) fn raise_stairwells(brief: &mut Brief, graph: &SceneGraph, height_m: Option<f64>) {
    let Some(height) = height_m else { return };
    let stairs = |id: &String| graph.links.iter().any(|l| l.kind == LinkKind::Stairs && l.room_ids.contains(id));
    for room in brief.rooms.iter_mut().filter(|r| stairs(&r.id)) {
        room.ceiling_height = to_mm(height + 0.01);
    }
}

/// Plans one storey around its core; of several plans the one that juts out least.
fn storey(
    brief: &Brief,
    domain: &Domain,
    (turn, seed): (Turn, u64),
    rng: &mut Stream,
    stop: Stop<'_>,
) -> Result<Planned, String> {
    let mut last = String::from("no layout was found");
    let mut best: Option<Planned> = None;
    let mut compared = 0;
    let form = brief.form;
    let mut brief = brief.clone();
    for attempt in 0..ATTEMPTS {
        if attempt == ATTEMPTS / 2 {
            brief.take_any_form();
            if best.is_none() {
                brief.stand_free();
            }
        }
        let mut schemes = schemes(&brief, domain, rng);
        // a bar lies best on a bar
        let bar = |s: Scheme| matches!(s, Scheme::Straight | Scheme::Capped);
        if brief.core.as_ref().and_then(|c| c.below.as_ref()?.scheme).is_some_and(bar) {
            schemes.sort_by_key(|s| !bar(*s));
        }
        let Some(mut found) = search(&brief, &schemes, rng, stop) else { continue };
        if found.score.is_sound() {
            align(&brief, &mut found);
        }
        if stop.is_set() {
            break;
        }
        let Some(frame) = found.layout.core.filter(|_| found.score.is_sound()) else {
            last = format!("the best layout misses hard rules by {:.2} (sizes, doors or daylight)", found.score.hard);
            continue;
        };
        let boxes: Vec<(usize, Cellbox)> = in_core(&found.layout.boxes, &frame);
        let name = format!("{:?}", found.scheme).to_lowercase();
        brief.tell_form(form, |f| found.has_form(f));
        match assemble(&brief.turned(turn.swap), &turned_in_place(&boxes, turn), &found.score, seed, &name, None, rng) {
            Ok(plan) => {
                let wings = brief.core.as_ref().is_some_and(|c| c.far.is_some() && !c.gable);
                let comb = wings.then_some(found.layout.comb);
                let comb_built = comb.is_some();
                let walls = if comb_built { Vec::new() } else { boxes.iter().map(|b| b.1).collect() };
                let below = Below {
                    outline: merged(&boxes),
                    boxes: walls,
                    quiet: if comb_built { Vec::new() } else { quiet(&brief, &boxes) },
                    by_core: true,
                    comb,
                    far: found.layout.far,
                    scheme: Some(found.scheme),
                    between: None,
                };
                let overhang = found.score.overhang;
                let set_back = set_back(&brief, &boxes);
                if best.as_ref().is_none_or(|b| overhang < b.overhang) {
                    let (way, open) = (way_share(&plan), open_share(&boxes));
                    best = Some(Planned { plan, below, overhang, set_back, way, open });
                }
                compared += 1;
                let most = if comb_built { COMPARED_LARGE } else { COMPARED };
                let few = !comb_built && !brief.of_home && compared < FEW_PLANS;
                let enough = if few { LITTLE_OVERHANG } else { OVERHANG_SHARE };
                if best.as_ref().is_some_and(|b| b.overhang <= enough) || compared == most {
                    break;
                }
            }
            Err(reason) => last = reason,
        }
    }
    best.ok_or(last)
}

/// Returns the share of the net floor of a plan that is hall, corridor and stairs.
fn way_share(plan: &Floorplan) -> f64 {
    let ways = plan.rooms.iter().filter(|r| r.circulation).map(|r| r.net_area_m2);
    ways.sum::<f64>() / net_area_m2(plan).max(1.0)
}

/// Returns the boxes of rooms that people sleep, live or work in.
fn quiet(brief: &Brief, boxes: &[(usize, Cellbox)]) -> Vec<Cellbox> {
    let lived_in = |room: usize| matches!(brief.rooms[room].zone, Zone::Day | Zone::Night) && !brief.rooms[room].wet;
    boxes.iter().filter(|(room, _)| lived_in(*room)).map(|(_, b)| *b).collect()
}

/// Returns the share of the storey below that boxes in the core's frame leave open.
fn set_back(brief: &Brief, boxes: &[(usize, Cellbox)]) -> f64 {
    let below = brief.core.as_ref().and_then(|c| c.below.as_ref()).filter(|b| b.by_core);
    let Some(below) = below else { return 0.0 };
    let lower: Vec<(usize, Cellbox)> = below.outline.iter().map(|b| (0, *b)).collect();
    let own: Vec<Cellbox> = boxes.iter().map(|b| b.1).collect();
    let area: f64 = below.outline.iter().map(Cellbox::area_m2).sum();
    overhang(&lower, &own, (0, 0)) as f64 * CELL_M2 / area.max(1.0)
}

/// Puts the storeys into one document, the building's south-west corner at the origin.
fn stacked(graph: &SceneGraph, planned: Vec<Planned>, numbers: &[i32], heights: &[f64], ground: usize) -> Floorplan {
    let corners = || planned.iter().flat_map(|p| &p.plan.rooms).map(|r| r.polygon.bounds());
    let west = corners().map(|b| b.x0).fold(f64::MAX, f64::min);
    let south = corners().map(|b| b.y0).fold(f64::MAX, f64::min);
    let basement: f64 = heights[..ground].iter().sum();
    let mut elevation_m = -basement;
    let mut levels = Vec::new();
    for (&level, &height_m) in numbers.iter().zip(heights) {
        levels.push(Level { level, elevation_m: to_mm(elevation_m), height_m });
        elevation_m += height_m;
    }
    let mut out = Floorplan {
        version: 1,
        seed: graph.seed,
        scheme: planned.get(ground).map_or(String::new(), |p| p.plan.scheme.clone()),
        rooms: Vec::new(),
        walls: Vec::new(),
        doors: Vec::new(),
        windows: Vec::new(),
        obstacles: Vec::new(),
        cost: Vec::new(),
        conflicts: Vec::new(),
        levels,
        links: graph.links.clone(),
    };
    for (storey, &level) in planned.into_iter().zip(numbers) {
        if storey.overhang > TOLD_SHARE {
            out.conflicts.push(overhang_note(level, storey.overhang));
        }
        add(&mut out, storey.plan.moved(-west, -south), level);
    }
    let order = |id: &str| graph.rooms.iter().position(|r| r.id == id);
    out.rooms.sort_by_key(|r| order(&r.room_id));
    out
}

/// Says how far a storey juts out; `share` of its area, 0 to 1.
pub(crate) fn overhang_note(level: i32, share: f64) -> Note {
    let message = format!("{:.0} % of level {level} juts out over the level below it", 100.0 * share);
    Note { code: "overhang".into(), message }
}

/// Adds a storey, whose walls, doors and windows are counted on.
fn add(out: &mut Floorplan, storey: Floorplan, level: i32) {
    let (walls, doors, windows) = (out.walls.len(), out.doors.len(), out.windows.len());
    for (i, mut wall) in storey.walls.into_iter().enumerate() {
        wall.wall_id = format!("wall_{}", walls + i + 1);
        out.walls.push(wall);
    }
    for (i, mut door) in storey.doors.into_iter().enumerate() {
        door.door_id = format!("door_{}", doors + i + 1);
        out.doors.push(door);
    }
    for (i, mut window) in storey.windows.into_iter().enumerate() {
        window.window_id = format!("window_{}", windows + i + 1);
        out.windows.push(window);
    }
    out.rooms.extend(storey.rooms.into_iter().map(|mut room| {
        room.level = level;
        room
    }));
    for CostTerm { term, cost } in storey.cost {
        match out.cost.iter_mut().find(|c| c.term == term) {
            Some(known) => known.cost = to_mm(known.cost + cost),
            None => out.cost.push(CostTerm { term, cost }),
        }
    }
    for conflict in storey.conflicts {
        if !out.conflicts.contains(&conflict) {
            out.conflicts.push(conflict);
        }
    }
}
