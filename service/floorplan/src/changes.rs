//! Small changes of a genome, as annealing makes them, and how much worse one may be.

use d3dgen_model::domain::Scheme;
use d3dgen_model::seed::Stream;

use super::genome::{Cell, Cover, Genome, guest_of, is_nestable};
use super::spec::Brief;

/// Steps from one look at the wish to stop to the next.
pub(crate) const LOOK: usize = 64;

/// The exponential distribution in 32 steps of equal chance, from the most patient to the least.
pub(crate) const PATIENCE: [f64; 32] = [
    4.159, 3.060, 2.549, 2.213, 1.962, 1.761, 1.594, 1.451, 1.326, 1.214, 1.114, 1.023, 0.940, 0.863, 0.792, 0.725,
    0.662, 0.604, 0.548, 0.495, 0.445, 0.398, 0.352, 0.309, 0.267, 0.227, 0.189, 0.152, 0.116, 0.081, 0.048, 0.016,
];

/// Returns how much worse a step may be, in units of the heat: drawn from the exponential distribution, as annealing
/// asks, by a table, for logarithms differ between machines.
pub(crate) fn patience(rng: &mut Stream) -> f64 {
    PATIENCE[rng.below(PATIENCE.len())]
}

/// Changes one thing; returns false when the drawn change does not apply.
pub(crate) fn mutate(brief: &Brief, genome: &mut Genome, rng: &mut Stream) -> bool {
    match rng.below(100) {
        0..25 => change_depth(genome, rng),
        25..45 => swap_cells(brief, genome, rng),
        45..62 => move_cell(brief, genome, rng),
        62..72 => renest(brief, genome, rng),
        72..80 => unnest(brief, genome, rng),
        80..88 => change_nest(genome, rng),
        88..92 => reverse(genome, rng),
        _ => change_caps(brief, genome, rng),
    }
}

pub(crate) fn change_depth(genome: &mut Genome, rng: &mut Stream) -> bool {
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

fn swap_cells(brief: &Brief, genome: &mut Genome, rng: &mut Stream) -> bool {
    let (Some(x), Some(y)) = (any_cell(genome, rng), any_cell(genome, rng)) else { return false };
    if x == y {
        return false;
    }
    let (first, second) = (genome.bands[x.0].cells[x.1], genome.bands[y.0].cells[y.1]);
    if x.0 != y.0 && (brief.in_core(first.host) || brief.in_core(second.host)) {
        return false;
    }
    genome.bands[x.0].cells[x.1] = second;
    genome.bands[y.0].cells[y.1] = first;
    true
}

fn move_cell(brief: &Brief, genome: &mut Genome, rng: &mut Stream) -> bool {
    let Some((b, c)) = any_cell(genome, rng) else { return false };
    let cell = genome.bands[b].cells.remove(c);
    let to = if brief.in_core(cell.host) { b } else { rng.below(genome.bands.len()) };
    let at = rng.below(genome.bands[to].cells.len() + 1);
    genome.bands[to].cells.insert(at, cell);
    true
}

/// Turns a small room that stands alone into one beside a larger room.
fn renest(brief: &Brief, genome: &mut Genome, rng: &mut Stream) -> bool {
    let Some((b, c)) = any_cell(genome, rng) else { return false };
    let cell = &genome.bands[b].cells[c];
    if cell.has_nests() || !is_nestable(brief, cell.host) {
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
    if !cell.has_nests() {
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

pub(crate) fn change_nest(genome: &mut Genome, rng: &mut Stream) -> bool {
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
        Scheme::Courtyard => {
            let step = 1 + rng.below(8) as i32;
            genome.court = (genome.court + if rng.chance(0.5) { step } else { -step }).max(1);
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
            if !brief.rooms[cell.host].on_spine
                || brief.in_core(cell.host)
                || brief.rooms[cell.host].area_target < 8.0
                || cell.nest_depth > 0
            {
                return false;
            }
            std::mem::swap(&mut cell.host, &mut cap.room);
        }
    }
    true
}
