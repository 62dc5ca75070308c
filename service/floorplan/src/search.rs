//! Annealing over genomes: many short runs from random starts, the best sound plan wins.

use d3dgen_model::domain::Scheme;
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::Stop;
use d3dgen_model::style::Form;

use super::compose::{LARGE, compose};
use super::core::Below;
use super::cost::{Judge, Weights, taste};
use super::genome::Genome;
use super::holes;
use super::order::put_in_order;
use super::realize::{Layout, Scratch, realize};
use super::spec::Brief;
use super::symmetric;
use crate::candidate::Candidate;
use crate::changes::{LOOK, PATIENCE, change_depth, change_nest, mutate, patience};

/// Steps of one run per room, of a small plan and of others, and the runs at most.
const STEPS_OF_SMALL: usize = 100;
const STEPS_PER_ROOM: usize = 150;
/// The same of a storey of a home: few rooms around stairs that stand where they stand on the others, with as short a hall as can be.
const STEPS_ON_STOREY: usize = 400;
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

/// Returns true for a storey of a home with stairs.
fn is_home_storey(brief: &Brief) -> bool {
    brief.of_home && brief.core.is_some()
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
    // what a hall takes of a storey of a home, or of a plot between neighbors, depends most on how the rooms lie along it
    let compared = brief.party.is_some() || is_home_storey(brief);
    let own_runs = if compared && !tiny { 1 } else { own_runs };
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
    let per_room = match brief.rooms.len() > SMALL || !easy {
        _ if is_home_storey(brief) => STEPS_ON_STOREY,
        true => STEPS_PER_ROOM,
        false => STEPS_OF_SMALL,
    };
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
