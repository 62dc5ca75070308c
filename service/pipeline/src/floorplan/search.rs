//! Annealing over genomes: many short runs from random starts, the best sound plan wins.

use d3dgen_model::domain::Scheme;
use d3dgen_model::seed::Stream;

use super::cost::{Score, score, taste};
use super::genome::{Cell, Cover, Genome, guest_of, is_nestable};
use super::realize::{Layout, realize};
use super::spec::Brief;

/// Steps of one run per room, and the runs at most.
const STEPS_PER_ROOM: usize = 220;
const MAX_RUNS: usize = 24;
/// Sound plans to compare before the best is taken.
const WANTED: usize = 3;
/// Rooms from which on the first sound plan is taken: large ones differ less from run to run, and cost more.
const LARGE: usize = 40;
/// Temperature at the start and the end of a run, in cost units.
const HEAT: (f64, f64) = (1.5, 0.02);

/// A finished candidate.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub genome: Genome,
    pub layout: Layout,
    pub score: Score,
}

/// Returns the best candidate found; its `score.hard` is above 0 when none is sound.
pub(super) fn search(brief: &Brief, schemes: &[Scheme], rng: &mut Stream) -> Option<Candidate> {
    let mut best: Option<Candidate> = None;
    let mut sound = 0;
    let wanted = if brief.rooms.len() > LARGE { 1 } else { WANTED };
    let weights = taste(rng);
    for run in 0..MAX_RUNS {
        // The first choice of the seed gets most runs; the others step in when it does not work out.
        let scheme = if run < 4 { schemes.first() } else { schemes.get(run % schemes.len().max(1)) };
        let Some(&scheme) = scheme else { break };
        let found = anneal(brief, scheme, &weights, rng);
        let is_sound = found.score.hard < 1e-9;
        sound += usize::from(is_sound);
        let better = best
            .as_ref()
            .is_none_or(|b| (b.score.hard >= 1e-9, b.score.total(&weights)) > (!is_sound, found.score.total(&weights)));
        if better {
            best = Some(found);
        }
        if sound >= wanted {
            break;
        }
    }
    best
}

fn anneal(brief: &Brief, scheme: Scheme, weights: &[f64; 9], rng: &mut Stream) -> Candidate {
    let steps = (STEPS_PER_ROOM * brief.rooms.len()).clamp(600, 12_000);
    let mut current = candidate(brief, Genome::random(brief, scheme, rng));
    let mut best = current.clone();
    let cooling = (HEAT.1 / HEAT.0).powf(1.0 / steps as f64);
    let mut heat = HEAT.0;
    for _ in 0..steps {
        heat *= cooling;
        let mut genome = current.genome.clone();
        if !mutate(brief, &mut genome, rng) {
            continue;
        }
        let next = candidate(brief, genome);
        let worse = next.score.total(weights) - current.score.total(weights);
        if worse <= 0.0 || rng.unit() < (-worse / heat).exp() {
            current = next;
            if current.score.total(weights) < best.score.total(weights) {
                best = current.clone();
            }
        }
    }
    best
}

fn candidate(brief: &Brief, genome: Genome) -> Candidate {
    let layout = realize(brief, &genome);
    let score = score(brief, &layout);
    Candidate { genome, layout, score }
}

/// Changes one thing; returns false when the drawn change does not apply.
pub(super) fn mutate(brief: &Brief, genome: &mut Genome, rng: &mut Stream) -> bool {
    match rng.below(100) {
        0..25 => change_depth(genome, rng),
        25..45 => swap_cells(genome, rng),
        45..62 => move_cell(genome, rng),
        62..72 => renest(brief, genome, rng),
        72..80 => unnest(brief, genome, rng),
        80..88 => change_nest(genome, rng),
        88..92 => reverse(genome, rng),
        _ => change_caps(brief, genome, rng),
    }
}

fn change_depth(genome: &mut Genome, rng: &mut Stream) -> bool {
    let b = rng.below(genome.bands.len());
    let step = 1 + rng.below(8) as i32;
    let depth = &mut genome.bands[b].depth;
    *depth = (*depth + if rng.chance(0.5) { step } else { -step }).clamp(24, 240);
    true
}

/// Returns a random cell as (band, index).
fn any_cell(genome: &Genome, rng: &mut Stream) -> Option<(usize, usize)> {
    let total: usize = genome.bands.iter().map(|b| b.cells.len()).sum();
    let mut at = rng.below(total);
    for (b, band) in genome.bands.iter().enumerate() {
        if at < band.cells.len() {
            return Some((b, at));
        }
        at -= band.cells.len();
    }
    None
}

fn swap_cells(genome: &mut Genome, rng: &mut Stream) -> bool {
    let (Some(x), Some(y)) = (any_cell(genome, rng), any_cell(genome, rng)) else { return false };
    if x == y {
        return false;
    }
    let first = genome.bands[x.0].cells[x.1].clone();
    let second = std::mem::replace(&mut genome.bands[y.0].cells[y.1], first);
    genome.bands[x.0].cells[x.1] = second;
    true
}

fn move_cell(genome: &mut Genome, rng: &mut Stream) -> bool {
    let Some((b, c)) = any_cell(genome, rng) else { return false };
    let cell = genome.bands[b].cells.remove(c);
    let to = rng.below(genome.bands.len());
    let at = rng.below(genome.bands[to].cells.len() + 1);
    genome.bands[to].cells.insert(at, cell);
    true
}

/// Turns a small room that stands alone into one beside a larger room.
fn renest(brief: &Brief, genome: &mut Genome, rng: &mut Stream) -> bool {
    let Some((b, c)) = any_cell(genome, rng) else { return false };
    let cell = &genome.bands[b].cells[c];
    if cell.nests().next().is_some() || !is_nestable(brief, cell.host) {
        return false;
    }
    let room = genome.bands[b].cells.remove(c).host;
    genome.nest_somewhere(brief, room, rng);
    true
}

/// Takes a nested room out: to another place, or to stand alone.
fn unnest(brief: &Brief, genome: &mut Genome, rng: &mut Stream) -> bool {
    let Some((b, c)) = any_cell(genome, rng) else { return false };
    let cell = &mut genome.bands[b].cells[c];
    let from_left = rng.chance(0.5);
    let room = if from_left { cell.left.pop() } else { cell.right.pop() }
        .or_else(|| cell.left.pop())
        .or_else(|| cell.right.pop());
    let Some(room) = room else { return false };
    if cell.nests().next().is_none() {
        cell.nest_depth = 0;
    }
    let tied = brief.rooms[room].host.is_some() || guest_of(brief, room).is_some();
    if tied || rng.chance(0.6) {
        genome.nest_somewhere(brief, room, rng);
    } else {
        let to = rng.below(genome.bands.len());
        let at = rng.below(genome.bands[to].cells.len() + 1);
        genome.bands[to].cells.insert(at, Cell::new(room));
    }
    true
}

fn change_nest(genome: &mut Genome, rng: &mut Stream) -> bool {
    let Some((b, c)) = any_cell(genome, rng) else { return false };
    let depth = genome.bands[b].depth;
    let cell = &mut genome.bands[b].cells[c];
    if cell.nest_depth == 0 {
        return false;
    }
    if rng.chance(0.35) {
        std::mem::swap(&mut cell.left, &mut cell.right);
    } else {
        let step = 1 + rng.below(4) as i32;
        cell.nest_depth = (cell.nest_depth + if rng.chance(0.5) { step } else { -step }).clamp(20, depth.max(21));
    }
    true
}

fn reverse(genome: &mut Genome, rng: &mut Stream) -> bool {
    let b = rng.below(genome.bands.len());
    let cells = &mut genome.bands[b].cells;
    if cells.len() < 2 {
        return false;
    }
    let from = rng.below(cells.len() - 1);
    let to = from + 2 + rng.below(cells.len() - from - 1);
    cells[from..to].reverse();
    true
}

fn change_caps(brief: &Brief, genome: &mut Genome, rng: &mut Stream) -> bool {
    match genome.scheme {
        Scheme::Capped => {}
        Scheme::Angle => {
            genome.corner = !genome.corner;
            return true;
        }
        Scheme::Straight | Scheme::Racetrack | Scheme::Comb => return false,
    }
    let side = rng.below(2);
    let cell = any_cell(genome, rng);
    let Some(cap) = &mut genome.caps[side] else { return false };
    match rng.below(3) {
        0 => cap.cover = *rng.pick(&[Cover::Both, Cover::Top, Cover::Bottom]).unwrap_or(&cap.cover),
        1 => cap.under = !cap.under,
        _ => {
            // Another large room takes the end.
            let Some((b, c)) = cell else { return false };
            let cell = &mut genome.bands[b].cells[c];
            if !brief.rooms[cell.host].on_spine || brief.rooms[cell.host].area_target < 8.0 || cell.nest_depth > 0 {
                return false;
            }
            std::mem::swap(&mut cell.host, &mut cap.room);
        }
    }
    true
}
