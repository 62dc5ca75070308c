//! Annealing over genomes: many short runs from random starts, the best sound plan wins.

use d3dgen_model::domain::Scheme;
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::Stop;
use d3dgen_model::style::Form;

use super::compose::{LARGE, compose};
use super::core::Below;
use super::cost::{Judge, Score, Weights, taste};
use super::genome::{Cell, Cover, Genome, guest_of, is_nestable};
use super::holes;
use super::order::put_in_order;
use super::outline::Mosaic;
use super::realize::{Layout, Scratch, realize};
use super::spec::Brief;
use super::symmetric;

/// Steps of one run per room, of a small plan and of others, and the runs at most.
const STEPS_OF_SMALL: usize = 100;
const STEPS_PER_ROOM: usize = 150;
const MAX_RUNS: usize = 24;
/// Steps of one run at most.
const MAX_STEPS: usize = 12_000;
/// Sound plans to compare before the best is taken.
const WANTED: usize = 3;
/// Cost of a room up to which a plan is good enough, and the sound plans more to compare where none is.
const CONTENT: f64 = 0.75;
const MORE: usize = 2;
/// Sound plans more to compare where a form is asked for: one that is bought with the inside is no good.
const MORE_OF_A_FORM: usize = 4;
/// Runs with the scheme that the seed drew, before others step in.
const OWN_RUNS: usize = 4;
/// Rooms up to which a building is tiny: few schemes suit so few rooms, which ones only a look at all of them tells.
const TINY: usize = 5;
/// Runs with one scheme for a large building in one body, the rooms from which on the first sound one of them does, and what
/// its first choice counts beside others.
const WHOLE_RUNS: usize = 2;
/// Runs of which the best is taken where corridors run around, for these plans differ much; with one station the first sound one
/// is taken as elsewhere, for what that station sees counts little beside the rest.
const RING_RUNS: usize = 4;
const MEDIUM: usize = 40;
const FAVORED: f64 = 0.92;
/// Rooms up to which so many are compared; larger plans cost more and differ less.
const SMALL: usize = 14;
/// Share of a run that is left when it is compared with others, and what it may cost more than they to go on.
const LATE: f64 = 0.5;
const FAR: f64 = 0.3;
/// Temperature at the start and the end of a run, in cost units.
const HEAT: (f64, f64) = (1.5, 0.02);

/// Steps from the best plan to one that is nearly as good, and what they may cost: small programs have one best plan
/// whatever the seed.
const STROLL: usize = 120;
const NEARLY: f64 = 0.2;
const NEARLY_TINY: f64 = 0.45;

/// Steps from one look at the wish to stop to the next.
pub(crate) const LOOK: usize = 64;

/// The exponential distribution in 32 steps of equal chance, from the most patient to the least.
const PATIENCE: [f64; 32] = [
    4.159, 3.060, 2.549, 2.213, 1.962, 1.761, 1.594, 1.451, 1.326, 1.214, 1.114, 1.023, 0.940, 0.863, 0.792, 0.725,
    0.662, 0.604, 0.548, 0.495, 0.445, 0.398, 0.352, 0.309, 0.267, 0.227, 0.189, 0.152, 0.116, 0.081, 0.048, 0.016,
];

/// A finished candidate.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub scheme: Scheme,
    pub layout: Layout,
    pub score: Score,
}

impl Candidate {
    /// Returns true for a building of a form, not only one whose corridors run so: an L has one corner that turns inwards, and
    /// wings lie side by side.
    pub(crate) fn has_form(&self, form: Form) -> bool {
        let slots = &self.layout.comb.slots;
        self.scheme == Scheme::of(form).0
            && match form {
                Form::LShaped => Mosaic::new(&self.layout.boxes).reflex_corners() == 1,
                Form::Wings => [0, 1].iter().any(|side| slots.iter().filter(|s| s.side == *side).count() > 1),
                Form::Linear | Form::Racetrack | Form::Courtyard => true,
            }
    }
}

/// Returns the best candidate found, of few steps when asked to stop; its `score.hard` is above 0 when none is sound.
pub(crate) fn search(brief: &Brief, schemes: &[Scheme], rng: &mut Stream, stop: Stop<'_>) -> Option<Candidate> {
    let weights = taste(brief, rng);
    let alike = if brief.mirrored { symmetric::search(brief, schemes, &weights, rng, stop) } else { None };
    let mut found = alike.or_else(|| search_freely(brief, schemes, weights, rng, stop))?;
    holes::close(brief, &weights, &mut found);
    Some(found)
}

/// Searches among all plans, alike on both sides or not.
fn search_freely(
    brief: &Brief,
    schemes: &[Scheme],
    weights: Weights,
    rng: &mut Stream,
    stop: Stop<'_>,
) -> Option<Candidate> {
    if brief.core.as_ref().is_some_and(|c| c.far.is_some() && !c.gable) {
        return compose(brief, &weights, rng, stop);
    }
    if schemes == [Scheme::Comb] && !brief.hub && brief.core.is_none() {
        return compose(brief, &weights, rng, stop);
    }
    if brief.core.is_some() || brief.rooms.len() < LARGE || brief.hub {
        let wanted = if brief.rooms.len() > SMALL { WANTED - 1 } else { WANTED };
        let wanted = wanted + if brief.form.is_some() { MORE_OF_A_FORM } else { 0 };
        return search_with(brief, schemes, (&weights, wanted), None, rng, stop);
    }
    // one body where the size allows it and it is the better plan, else wings
    if schemes.first() != Some(&Scheme::Comb)
        && let Some(whole) = search_whole(brief, schemes, &weights, rng, stop)
    {
        return Some(whole);
    }
    if brief.form.is_some() && schemes != [Scheme::Comb] {
        return None; // wings are not what was asked for
    }
    compose(brief, &weights, rng, stop)
}

/// Returns the best sound plan of a large building in one body: every scheme that suits it is looked at, for what a corridor
/// costs depends on the rooms; the seed's first choice may cost a little more.
fn search_whole(
    brief: &Brief,
    schemes: &[Scheme],
    weights: &Weights,
    rng: &mut Stream,
    stop: Stop<'_>,
) -> Option<Candidate> {
    let mut judge = Judge::new(brief);
    let compared = brief.ring.is_some() && judge.stations.len() != 1 || brief.form == Some(Form::LShaped);
    let mut best: Option<(f64, (Genome, Candidate))> = None;
    for (n, scheme) in schemes.iter().filter(|s| **s != Scheme::Comb).enumerate() {
        for _ in 0..if compared { RING_RUNS } else { WHOLE_RUNS } {
            let least = best.as_ref().map_or(f64::MAX, |b| b.0);
            let found = anneal(brief, &mut judge, *scheme, (weights, least, true), rng, stop);
            if found.1.score.is_sound() {
                let cost = found.1.score.total(weights) + judge.disorder(&found.1.layout);
                let cost = if n == 0 { FAVORED * cost } else { cost };
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, found));
                }
                if brief.rooms.len() > MEDIUM && !compared {
                    break;
                }
            }
        }
    }
    let (_, best) = best?;
    Some(put_in_order(brief, &mut judge, weights, best, rng, stop))
}

/// Returns the best of several runs, which end when `wanted` sound ones are found.
pub(crate) fn search_with(
    brief: &Brief,
    schemes: &[Scheme],
    (weights, wanted): (&Weights, usize),
    below: Option<&Below>,
    rng: &mut Stream,
    stop: Stop<'_>,
) -> Option<Candidate> {
    // wings are composed of plans, and are none themselves
    let schemes: Vec<Scheme> = schemes.iter().copied().filter(|s| *s != Scheme::Comb).collect();
    let mut best: Option<(bool, f64, (Genome, Candidate))> = None;
    let mut sound = 0;
    let mut judge = Judge::new(brief);
    judge.below = judge.below.or(below);
    let tiny = brief.rooms.len() <= TINY;
    let (own_runs, more) = if tiny { (OWN_RUNS / 2, MAX_RUNS / 2) } else { (OWN_RUNS, MORE) };
    for run in 0..MAX_RUNS {
        // The first choice of the seed gets most runs; the others step in when it does not work out.
        let scheme = if run < own_runs { schemes.first() } else { schemes.get(run % schemes.len().max(1)) };
        let Some(&scheme) = scheme else { break };
        let least = best.as_ref().filter(|b| !b.0).map_or(f64::MAX, |b| b.1);
        let found = anneal(brief, &mut judge, scheme, (weights, least, run < own_runs || sound > 0), rng, stop);
        let unsound = !found.1.score.is_sound();
        let cost = found.1.score.total(weights) + judge.disorder(&found.1.layout);
        sound += usize::from(!unsound);
        if best.as_ref().is_none_or(|(worse, least, _)| (unsound, cost) < (*worse, *least)) {
            best = Some((unsound, cost, found));
        }
        let poor = best.as_ref().is_some_and(|(_, least, _)| *least > CONTENT * brief.rooms.len() as f64);
        if sound >= wanted + if poor { more } else { 0 } || stop.is_set() {
            break;
        }
    }
    let (_, _, best) = best?;
    let best = stroll(brief, &mut judge, weights, best, rng);
    Some(put_in_order(brief, &mut judge, weights, best, rng, stop))
}

/// Changes depths here and there as long as the plan stays nearly as good.
fn stroll(
    brief: &Brief,
    judge: &mut Judge<'_>,
    weights: &Weights,
    (mut genome, mut found): (Genome, Candidate),
    rng: &mut Stream,
) -> (Genome, Candidate) {
    // what is to be alike on both sides is better left as it was found
    if !found.score.is_sound() || brief.symmetry.is_some() {
        return (genome, found);
    }
    let most = found.score.total(weights) + if brief.rooms.len() <= TINY { NEARLY_TINY } else { NEARLY };
    let (mut scratch, mut layout) = (Scratch::default(), Layout::default());
    let mut trial = genome.clone();
    for _ in 0..STROLL {
        trial.clone_from(&genome);
        if !(if rng.chance(0.6) { change_depth(&mut trial, rng) } else { change_nest(&mut trial, rng) }) {
            continue;
        }
        realize(brief, &trial, &mut scratch, &mut layout);
        let score = judge.score(&layout);
        if score.is_sound() && score.total(weights) <= most {
            std::mem::swap(&mut genome, &mut trial);
            found = Candidate { layout: layout.clone(), score, ..found };
        }
    }
    (genome, found)
}

/// One run: from a random start, hot to cold; it ends early when it is far from the `known` cost of another. Where the first
/// runs found nothing sound a small plan is not `easy` and takes longer.
fn anneal(
    brief: &Brief,
    judge: &mut Judge<'_>,
    scheme: Scheme,
    (weights, known, easy): (&Weights, f64, bool),
    rng: &mut Stream,
    stop: Stop<'_>,
) -> (Genome, Candidate) {
    let per_room = if brief.rooms.len() > SMALL || !easy { STEPS_PER_ROOM } else { STEPS_OF_SMALL };
    let steps = (per_room * brief.rooms.len()).clamp(600, MAX_STEPS);
    let (mut scratch, mut layout) = (Scratch::default(), Layout::default());
    let mut value = |genome: &Genome, most: f64| {
        realize(brief, genome, &mut scratch, &mut layout);
        judge.cost_up_to(&layout, weights, most)
    };
    let mut current = Genome::random(brief, scheme, rng);
    let mut cost = value(&current, f64::MAX);
    let (mut best, mut least) = (current.clone(), cost);
    let mut trial = current.clone();
    for step in 0..steps {
        if step % LOOK == 0 && stop.is_set() {
            break;
        }
        let left = 1.0 - step as f64 / steps as f64;
        if step % LOOK == 0 && left < LATE && least > known + FAR {
            break;
        }
        let heat = HEAT.1 + (HEAT.0 - HEAT.1) * left * left * left;
        trial.clone_from(&current);
        if !mutate(brief, &mut trial, rng) {
            continue;
        }
        let next = value(&trial, cost + heat * PATIENCE[0]);
        if next <= cost || next - cost < heat * patience(rng) {
            std::mem::swap(&mut current, &mut trial);
            cost = next;
            if cost < least {
                best.clone_from(&current);
                least = cost;
            }
        }
    }
    let mut layout = Layout::default();
    realize(brief, &best, &mut scratch, &mut layout);
    let score = judge.score(&layout);
    let found = Candidate { scheme: best.scheme, layout, score };
    (best, found)
}

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
