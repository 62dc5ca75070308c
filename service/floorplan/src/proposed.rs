//! Plans out of sketches: rectangles that somebody proposes for rooms, set on the lattice and made sound with the least
//! change; where that does not work out, the plan of our own that comes nearest to the sketch.

use d3dgen_knowledge::Limits;
use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::geometry::Rect;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::{Error, Stop};

use super::assemble::{Turn, assemble, turned};
use super::board::{Board, units};
use super::cost::{Judge, WEIGHTS};
use super::insert::Chooser;
use super::lattice::{Cellbox, INNER_HALF_M, OUTER_HALF_M, nearest, up};
use super::revise::{Aim, Task};
use super::search::search;
use super::spec::Brief;
use super::{one_storey_graph, schemes};
use crate::lattice::tidied;

/// Most rooms whose sketch is looked at.
pub const MOST_SKETCHED: usize = 60;

/// Farthest that the lines of walls are pulled together, lattice units: 0.25 m, the thickness of an outer wall.
const PULL: i32 = 5;
/// Longest side of a sketched room, m, and the farthest that one may lie from the origin.
const LARGEST_M: f64 = 300.0;
/// Shortest side of a sketched rectangle, lattice units: 0.5 m.
const LEAST: i32 = 10;
/// Most rectangles of one room.
const MOST_RECTS: usize = 4;
/// Wall that a gap between rooms shares with the room it is entered from, lattice units: 1.2 m.
const DOORWAY: i32 = 24;
/// How much larger or smaller than a room a gap may be that the room is set into, as a factor.
const MISFIT: f64 = 2.0;
/// Repairs tried.
const REPAIRS: usize = 6;
/// Own plans among which the nearest is chosen.
const OWN_PLANS: u64 = 4;
/// Least share of the floor whose use is as sketched; a plan with less has nothing of the sketch.
const ALIKE: f64 = 0.35;

/// Turns nothing.
const AS_IT_IS: Turn = Turn { flip_x: false, flip_y: false, swap: false };

/// What somebody proposes for one room.
#[derive(Debug, Clone, PartialEq)]
pub struct Sketch {
    /// Room of the scene graph.
    pub room_id: String,
    /// Its outline in parts, on the center lines of the walls, m; whatever numbers somebody wrote.
    pub rects: Vec<Rect>,
}

/// How a plan follows a sketch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Follow {
    /// Its own rectangles, with the least change that makes them sound.
    Closely,
    /// A plan of our own, the one of several that uses most of the floor as sketched.
    Roughly,
}

/// Plans a scene graph of one storey as it is sketched.
///
/// Sketches of rooms that the graph does not have, and rectangles without a sane size, are passed over; rooms without a
/// sketch are set where they disturb least. All hard rules of [`super::generate`] hold.
///
/// # Errors
/// `Refused` for several storeys and for more than [`MOST_SKETCHED`] rooms; `Infeasible` when no sound plan is like the
/// sketch; `Mismatch` as [`super::generate`]; `Cancelled`.
pub fn propose(
    graph: &SceneGraph,
    domain: &Domain,
    limits: &Limits,
    sketches: &[Sketch],
    follow: Follow,
    stop: Stop<'_>,
) -> Result<Floorplan, Error> {
    one_storey_graph(graph)?;
    if graph.rooms.len() > MOST_SKETCHED {
        return Err(Error::Refused {
            stage: "floorplan",
            message: format!("{} rooms are more than the {MOST_SKETCHED} of a sketch", graph.rooms.len()),
        });
    }
    let brief = Brief::new(graph, domain, limits)?;
    let mut rng = Stream::new(graph.seed, "floorplan/proposal");
    let sketch = read(&brief, sketches, PULL);
    if sketch.rooms.iter().all(Vec::is_empty) {
        return Err(infeasible("no rectangle of it is of use"));
    }
    let found = match follow {
        Follow::Closely => {
            let exact = read(&brief, sketches, 0);
            let as_drawn = finished(&brief, &exact, graph.seed, &mut rng);
            as_drawn.or_else(|| {
                let board = complete(&brief, &sketch)?;
                repaired(&brief, &board, graph.seed, &mut rng, stop)
            })
        }
        Follow::Roughly => nearest_own(&brief, domain, &sketch, graph.seed, stop)?,
    };
    stop.check()?;
    found.ok_or_else(|| infeasible("no sound plan is like it"))
}

fn infeasible(message: &str) -> Error {
    Error::Infeasible { stage: "floorplan", message: message.into() }
}

/// Returns the sketch on the lattice: walls that lie within `pull` of each other meet, and of two rooms that overlap the smaller one stays whole.
fn read(brief: &Brief, sketches: &[Sketch], pull: i32) -> Board {
    let mut rooms: Vec<Vec<Cellbox>> = vec![Vec::new(); brief.rooms.len()];
    for sketch in sketches {
        let Some(room) = brief.rooms.iter().position(|r| r.id == sketch.room_id) else { continue };
        if rooms[room].is_empty() {
            rooms[room] = sketch.rects.iter().take(MOST_RECTS).filter_map(on_lattice).collect();
        }
    }
    pull_together(&mut rooms, pull);
    let mut board = Board { rooms: vec![Vec::new(); rooms.len()] };
    let size = |cells: &Vec<Cellbox>| cells.iter().map(units).sum::<i64>();
    let mut order: Vec<usize> = (0..rooms.len()).collect();
    // the largest first: whoever comes later takes what is his
    order.sort_by_key(|&r| (-size(&rooms[r]), r));
    for room in order {
        rooms[room].iter().for_each(|cell| board.give(room, cell));
    }
    for room in 0..board.rooms.len() {
        if !board.is_whole(room) {
            board.rooms[room].truncate(1);
        }
    }
    board
}

/// Returns a rectangle on the lattice, if it is one that somebody could mean.
fn on_lattice(rect: &Rect) -> Option<Cellbox> {
    let edges = [rect.x0, rect.y0, rect.x1, rect.y1];
    if edges.iter().any(|e| !e.is_finite() || e.abs() > LARGEST_M) {
        return None;
    }
    let [xa, ya, xb, yb] = edges.map(nearest);
    let cell = Cellbox::new(xa, ya, xb, yb);
    (cell.width() >= LEAST && cell.height() >= LEAST).then_some(cell)
}

/// Moves edges that lie within a distance of each other onto one line.
fn pull_together(rooms: &mut [Vec<Cellbox>], pull: i32) {
    let lines = |edges: Vec<i32>| {
        let mut edges = edges;
        edges.sort_unstable();
        let mut groups: Vec<Vec<i32>> = Vec::new();
        for edge in edges {
            match groups.last_mut().filter(|g| edge - g[0] <= pull) {
                Some(group) => group.push(edge),
                None => groups.push(vec![edge]),
            }
        }
        groups
    };
    let to =
        |groups: &[Vec<i32>], edge: i32| groups.iter().find(|g| g.contains(&edge)).map_or(edge, |g| g[g.len() / 2]);
    let all = || rooms.iter().flatten();
    let xs = lines(all().flat_map(|b| [b.x0, b.x1]).collect());
    let ys = lines(all().flat_map(|b| [b.y0, b.y1]).collect());
    for cell in rooms.iter_mut().flatten() {
        *cell = Cellbox { x0: to(&xs, cell.x0), y0: to(&ys, cell.y0), x1: to(&xs, cell.x1), y1: to(&ys, cell.y1) };
    }
    rooms.iter_mut().for_each(|cells| cells.retain(|c| c.width() > 0 && c.height() > 0));
}

/// Adds the rooms that the sketch lacks; `None` when it lacks the corridor or has no place for one.
fn complete(brief: &Brief, sketch: &Board) -> Option<Board> {
    if brief.spine.is_some_and(|s| sketch.rooms[s].is_empty()) {
        return None;
    }
    let free = vec![false; brief.rooms.len()];
    let mut chooser = Chooser::new(brief, &WEIGHTS, &free, sketch, &[]);
    let mut board = sketch.clone();
    widen_corridor(brief, &mut board);
    for room in (0..brief.rooms.len()).filter(|&r| sketch.rooms[r].is_empty()) {
        match gap_for(brief, &board, room) {
            Some(gap) => board.give(room, &gap),
            None => board = chooser.insert(&board, room, 0)?,
        }
    }
    Some(board)
}

/// Returns the place between the rooms that suits a room best, if there is one: it may be the one that was forgotten.
fn gap_for(brief: &Brief, board: &Board, room: usize) -> Option<Cellbox> {
    let all = board.layout().boxes;
    let whole = all.iter().map(|(_, b)| *b).reduce(|a, b| a.union(&b))?;
    let free = all.iter().fold(vec![whole], |free, (_, b)| free.iter().flat_map(|f| f.without(b)).collect());
    let target = brief.rooms[room].area_target;
    let misfit = |b: &Cellbox| (b.area_m2() / target).max(target / b.area_m2());
    let hosts: Vec<usize> = brief.rooms[room].host.into_iter().chain(brief.spine).collect();
    let entered = |b: &Cellbox| {
        let mut cells = hosts.iter().flat_map(|h| &board.rooms[*h]);
        cells.any(|c| b.contact(c).is_some_and(|(_, from, to)| to - from >= DOORWAY))
    };
    let gaps = tidied(&free).into_iter().filter(|b| b.width() >= LEAST && b.height() >= LEAST);
    gaps.filter(|b| misfit(b) <= MISFIT && entered(b)).min_by(|a, b| misfit(a).total_cmp(&misfit(b)))
}

/// Returns a sound plan at or near a board.
fn repaired(brief: &Brief, board: &Board, seed: u64, rng: &mut Stream, stop: Stop<'_>) -> Option<Floorplan> {
    let free = vec![false; brief.rooms.len()];
    let as_drawn = finished(brief, board, seed, rng);
    for attempt in 0..if as_drawn.is_some() { 0 } else { REPAIRS } {
        let task = Task { brief, kept: &free, pins: &[], aim: Aim::Repair, moves_spine: attempt % 2 == 1 };
        let found = task.revise(board, &WEIGHTS, rng, stop);
        if stop.is_set() {
            return None;
        }
        let plan = finished(brief, &found, seed, rng);
        if plan.is_some() {
            return plan;
        }
    }
    as_drawn
}

/// Returns the plan of a board, if it is sound.
fn finished(brief: &Brief, board: &Board, seed: u64, rng: &mut Stream) -> Option<Floorplan> {
    let free = vec![false; brief.rooms.len()];
    let task = Task { brief, kept: &free, pins: &[], aim: Aim::Repair, moves_spine: false };
    if !task.accepts(board) || !narrow_parts(brief, board).is_empty() {
        return None;
    }
    let layout = board.layout();
    let score = Judge::new(brief).score(&layout);
    assemble(brief, &layout.boxes, &score, seed, "proposed", None, rng).ok()
}

/// Returns the parts of the corridor that are narrower than corridors are built, and by how much; what only widens another
/// part along its whole length is none.
fn narrow_parts(brief: &Brief, board: &Board) -> Vec<(Cellbox, i32)> {
    let least = up(brief.spine_width + 2.0 * INNER_HALF_M);
    let Some(spine) = brief.spine.filter(|_| !brief.hub) else { return Vec::new() };
    let parts = &board.rooms[spine];
    let widens = |c: &Cellbox| {
        parts.iter().any(|d| c.contact(d).is_some_and(|(_, from, to)| to - from >= c.width().max(c.height())))
    };
    let short = |c: &Cellbox| least - c.width().min(c.height());
    parts.iter().filter(|c| short(c) > 0 && !widens(c)).map(|c| (*c, short(c))).collect()
}

/// Gives the corridor its width, at the cost of the rooms on both sides.
fn widen_corridor(brief: &Brief, board: &mut Board) {
    let Some(spine) = brief.spine else { return };
    for (part, short) in narrow_parts(brief, board) {
        // as wide as our own: between outer walls, too
        let short = short + up(2.0 * (OUTER_HALF_M - INNER_HALF_M));
        let sides = if part.width() < part.height() { [0, 1] } else { [2, 3] };
        board.give(spine, &part.strip(sides[0], short / 2));
        board.give(spine, &part.strip(sides[1], short - short / 2));
    }
}

/// Returns the plan of our own, turned in whichever way, that uses most of the floor as sketched.
fn nearest_own(
    brief: &Brief,
    domain: &Domain,
    sketch: &Board,
    seed: u64,
    stop: Stop<'_>,
) -> Result<Option<Floorplan>, Error> {
    let wanted: Vec<(usize, Cellbox)> = turned(&sketch.layout().boxes, AS_IT_IS);
    let mut found = Vec::new();
    for n in 0..OWN_PLANS {
        let mut rng = Stream::new(seed, &format!("floorplan/proposal/{n}"));
        let mut brief = brief.clone();
        brief.vary(&mut rng);
        brief.widen(&mut rng);
        let schemes = schemes(&brief, domain, &mut rng);
        let candidate = search(&brief, &schemes, &mut rng, stop);
        stop.check()?;
        let Some(candidate) = candidate.filter(|c| c.score.is_sound()) else { continue };
        for way in 0..8 {
            let turn = Turn { flip_x: way & 1 > 0, flip_y: way & 2 > 0, swap: way & 4 > 0 };
            let boxes = turned(&candidate.layout.boxes, turn);
            let alike = alike(&wanted, &boxes);
            if alike >= ALIKE {
                let scheme = format!("{:?}", candidate.scheme).to_lowercase();
                found.push((alike, n, way, boxes, candidate.score, scheme));
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    for (_, n, way, boxes, score, scheme) in found {
        let mut rng = Stream::new(seed, &format!("floorplan/proposal/{n}/{way}"));
        if let Ok(plan) = assemble(brief, &boxes, &score, seed, &scheme, None, &mut rng) {
            return Ok(Some(plan));
        }
    }
    Ok(None)
}

/// Returns the share of the floor sketched that the same room has in a plan.
fn alike(sketch: &[(usize, Cellbox)], plan: &[(usize, Cellbox)]) -> f64 {
    let all: i64 = sketch.iter().map(|(_, b)| units(b)).sum();
    let own = |(room, b): &(usize, Cellbox)| {
        plan.iter().filter(|(r, _)| r == room).filter_map(|(_, p)| p.overlap(b)).map(|o| units(&o)).sum::<i64>()
    };
    sketch.iter().map(own).sum::<i64>() as f64 / all.max(1) as f64
}
