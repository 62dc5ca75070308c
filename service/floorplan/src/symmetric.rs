//! Plans that are alike on both sides of an axis by construction: the search sees one half of the rooms and what stands on
//! the axis, and every layout it looks at is that half and its mirror image.

use std::ops::Range;

use d3dgen_model::domain::{Daylight, Scheme, Zone};
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::Stop;

use super::cost::{Judge, Weights};
use super::genome::{Band, Cap, Cell, Cover, Genome, is_nestable, nest_depth};
use super::lattice::{Cellbox, Frame, INNER_HALF_M, OUTER_HALF_M, meters, up};
use super::mirror::{self, Axis};
use super::realize::{
    BARE, Layout, MIN_NOTCH_M, ONE_WAY_M, Span, cap_box, core_misfit, court_misfit, court_need, door_need, fill_cell,
    shares, span, spine_units,
};
use super::spec::Brief;
use super::twins::{Twins, tie};
use crate::candidate::Candidate;
use crate::changes::{LOOK, mutate, patience};

/// Sound plans that are compared, the runs at most, and the rooms from which on fewer do.
const WANTED: usize = 8;
const MOST_RUNS: usize = 16;
const MANY: usize = 24;
/// Steps of one run per room, at least and at most; one for so many of them is added with the order of rooms in view.
const STEPS_PER_ROOM: usize = 110;
const STEPS: (usize, usize) = (700, 5_000);
const IN_ORDER: usize = 3;
/// What it costs in the end that a plan misses a hard rule by ever so little.
const UNSOUND: f64 = 5.0;
/// Changes drawn at most for each step.
const TRIES: usize = 6;
/// Temperature at the start and the end of a run, and at the start of its end, where the order of rooms counts.
const HEAT: (f64, f64) = (1.5, 0.02);
const HEAT_IN_ORDER: f64 = 0.3;
/// What it costs that nothing of the floor is mirrored in rooms of the same kind.
const NOT_ALIKE: f64 = 45.0;
/// What it costs beside that nothing is mirrored in rooms of the same type.
const OTHER_TYPE: f64 = 8.0;
/// What it costs that the room one enters by does not stand on the axis.
const ASIDE: f64 = 4.0;
/// Rooms up to which a plan has its axis along the corridor too, and the area of a room from which on it closes its end, m^2.
const MOST_ALONG: usize = 12;
const LEAST_CAP_M2: f64 = 9.0;
/// What a room on the axis counts beside areas when another looks for its place, and what is in a block.
const FULL: f64 = 1000.0;
const FILLED: f64 = 3.0;
/// What a meter costs by which the rows along a corridor are shorter than it.
const SHORT_ROW: f64 = 0.35;
/// The first of the rows inside a ring of corridors.
const CORE_ROWS: usize = 2;
/// Share of small rooms that begin beside a larger one.
const NESTED: f64 = 0.6;

/// How the axis lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Figure {
    /// Across one corridor.
    Across,
    /// Along one corridor.
    Along,
    /// Across both long sides of a ring of corridors.
    Ring(Scheme),
}

impl Figure {
    /// Returns how many rows of rooms one half has.
    fn rows(self) -> usize {
        match self {
            Self::Along => 1,
            Self::Across => 2,
            Self::Ring(_) => 4,
        }
    }

    /// Returns the bands of what stands on the axis, one for each row; along a corridor nothing does but at its ends.
    fn middles(self) -> Range<usize> {
        self.rows()..if self == Self::Along { self.rows() } else { 2 * self.rows() }
    }

    /// Returns the bands of rooms without twins: those on the axis, and blocks of one length on both sides of it.
    fn singles(self) -> Range<usize> {
        self.middles().start + usize::from(self == Self::Along)..4 * self.rows()
    }

    /// Returns the band of rooms on the short sides of a court, mirrored as a whole.
    fn side(self) -> Option<usize> {
        (self == Self::Ring(Scheme::Courtyard)).then_some(4 * self.rows())
    }

    fn bands(self) -> usize {
        4 * self.rows() + usize::from(self.side().is_some())
    }

    /// Returns true for a band of rooms that have twins.
    fn is_mirrored(self, band: usize) -> bool {
        band < self.rows() || Some(band) == self.side()
    }
}

/// Returns the best sound plan that is alike on both sides; `None` where none was found.
pub(crate) fn search(
    brief: &Brief,
    schemes: &[Scheme],
    weights: &Weights,
    rng: &mut Stream,
    stop: Stop<'_>,
) -> Option<Candidate> {
    let figures: &[Figure] = match schemes {
        _ if brief.hub || brief.core.is_some() || brief.spine.is_none() => return None,
        [Scheme::Courtyard] if brief.ring.is_some() => &[Figure::Ring(Scheme::Courtyard)],
        [Scheme::Racetrack] if brief.ring.is_some() => &[Figure::Ring(Scheme::Racetrack)],
        [Scheme::Angle | Scheme::Comb] => return None,
        _ if brief.rooms.len() > MOST_ALONG => &[Figure::Across],
        _ => &[Figure::Across, Figure::Along],
    };
    // what is not alike is told exactly here
    let plain = Brief { symmetry: None, ..brief.clone() };
    let [wanted, runs] = [WANTED, MOST_RUNS].map(|n| if brief.rooms.len() > MANY { n / 2 } else { n });
    let (mut best, mut sound): (Option<(bool, f64, Candidate)>, usize) = (None, 0);
    for run in 0..runs {
        let mut half = Half::new(&plain, figures[run % figures.len()], rng);
        let mut judge = Judge::new(&plain);
        let found = half.anneal(&mut judge, weights, rng, stop);
        let cost = found.score.total(weights) + SHORT_ROW * found.layout.notch + judge.disorder(&found.layout);
        let unsound = !found.score.is_sound();
        sound += usize::from(!unsound);
        if best.as_ref().is_none_or(|(worse, least, _)| (unsound, cost) < (*worse, *least)) {
            best = Some((unsound, cost, found));
        }
        if sound >= wanted || stop.is_set() {
            break;
        }
    }
    best.filter(|(unsound, ..)| !unsound).map(|(_, _, found)| found)
}

/// Half a plan: who is in it, and how it lies.
struct Half<'b> {
    brief: &'b Brief,
    twins: Twins,
    figure: Figure,
    /// True where the blocks of rooms without twins are at the ends of the rows.
    at_end: bool,
    spans: Vec<Span>,
    widths: Vec<i32>,
}

/// Cells of a band: where their spans begin, and their sum.
#[derive(Clone, Copy, Default)]
struct Cells {
    band: usize,
    first: usize,
    sum: Span,
}

/// A row of rooms on one side of a corridor.
struct Row {
    /// What it reaches beyond the corridor on each side, lattice units.
    beyond: i32,
    mirrored: Cells,
    middle: Cells,
    /// The blocks of rooms without twins on both sides of the axis, and the lengths that both can have.
    blocks: [Cells; 2],
    block: Span,
}

impl<'b> Half<'b> {
    fn new(brief: &'b Brief, figure: Figure, rng: &mut Stream) -> Self {
        let seats = match figure {
            Figure::Along if brief.second_exit => 0,
            Figure::Along => 1 + rng.below(2),
            Figure::Across | Figure::Ring(_) => figure.rows(),
        };
        let twins = Twins::draw(brief, seats, rng);
        Self { brief, twins, figure, at_end: rng.chance(0.5), spans: Vec::new(), widths: Vec::new() }
    }

    /// Returns true for a genome whose rooms with twins are in mirrored bands and the others are not.
    fn keeps_twins(&self, genome: &Genome) -> bool {
        let keeps = |(band, row): (usize, &Band)| {
            let is_twin = self.figure.is_mirrored(band);
            if !is_twin && !self.figure.singles().contains(&band) {
                return row.cells.is_empty();
            }
            let right = |room: usize| self.twins.other[room].is_some() == is_twin;
            row.cells.iter().all(|cell| right(cell.host) && cell.nests().all(right))
        };
        genome.bands.iter().enumerate().all(keeps)
            && genome.caps.iter().flatten().all(|cap| self.twins.single[cap.room])
    }

    /// Returns a random start.
    fn start(&self, rng: &mut Stream) -> Genome {
        let (brief, figure) = (&self.twins.even, self.figure);
        let scheme = match figure {
            Figure::Along => Scheme::Capped,
            Figure::Across => Scheme::Straight,
            Figure::Ring(scheme) => scheme,
        };
        let bands = (0..figure.bands()).map(|_| Band { depth: 0, cells: Vec::new() }).collect();
        let mut genome = Genome { scheme, bands, caps: [None, None], corner: false, court: 0 };
        if scheme == Scheme::Courtyard {
            genome.court = up(court_need(self.brief) * (1.0 + 0.4 * rng.unit()));
        }
        let of = |chosen: &dyn Fn(usize) -> bool| (0..brief.rooms.len()).filter(|r| chosen(*r)).collect::<Vec<usize>>();
        let mut twins = of(&|r| self.twins.other[r].is_some());
        let mut singles = of(&|r| self.twins.single[r]);
        rng.shuffle(&mut twins);
        rng.shuffle(&mut singles);
        if figure == Figure::Along {
            self.choose_caps(&mut genome, &mut singles, rng);
        }
        // the largest first: what is small may be cut out of it
        singles.sort_by(|a, b| brief.rooms[*b].area_target.total_cmp(&brief.rooms[*a].area_target));
        let (nested, cells): (Vec<usize>, Vec<usize>) = twins
            .into_iter()
            .chain(singles)
            .partition(|&r| is_nestable(brief, r) && (tie(self.brief, r).is_some() || rng.chance(NESTED)));
        for room in cells {
            let band = self.lightest(&genome, room, rng);
            let cells = &mut genome.bands[band].cells;
            cells.insert(rng.below(cells.len() + 1), Cell::new(room));
        }
        for room in nested {
            self.nest(&mut genome, room, rng);
        }
        for band in &mut genome.bands {
            let area: f64 = band.cells.iter().map(|c| brief.rooms[c.host].area_target).sum();
            let mean = if band.cells.is_empty() { 16.0 } else { area / band.cells.len() as f64 };
            band.depth = up((mean.sqrt() * (0.85 + 0.5 * rng.unit())).clamp(2.0, 9.0) + 0.18);
        }
        genome
    }

    /// Closes the ends of a corridor with large rooms on the axis.
    fn choose_caps(&self, genome: &mut Genome, singles: &mut Vec<usize>, rng: &mut Stream) {
        let rooms = &self.brief.rooms;
        let fits = |r: usize| rooms[r].on_spine && rooms[r].area_target >= LEAST_CAP_M2 && rooms[r].gate.is_none();
        let cap = |room: usize| Some(Cap { room, cover: Cover::Both, under: false });
        if self.brief.second_exit {
            return;
        }
        if let Some(at) = singles.iter().position(|&r| fits(r) && rooms[r].entrance) {
            genome.caps[0] = cap(singles.remove(at));
        }
        let largest = |list: &[usize]| {
            let fitting = list.iter().enumerate().filter(|(_, r)| fits(**r));
            fitting.max_by(|a, b| rooms[*a.1].area_target.total_cmp(&rooms[*b.1].area_target)).map(|(at, _)| at)
        };
        if let Some(at) = largest(singles) {
            genome.caps[1] = cap(singles.remove(at));
        }
        // an odd one has nothing to stand across from
        if genome.caps[0].is_none()
            && (singles.len() % 2 == 1 || rng.chance(0.3))
            && let Some(at) = largest(singles)
        {
            genome.caps[0] = cap(singles.remove(at));
        }
    }

    /// Returns the bands that a room may be in.
    fn bands_for(&self, room: usize) -> Vec<usize> {
        let is_twin = self.twins.other[room].is_some();
        let figure = self.figure;
        let suits = |b: &usize| figure.is_mirrored(*b) == is_twin && (is_twin || figure.singles().contains(b));
        (0..figure.bands()).filter(suits).collect()
    }

    /// Returns the band with the least in it for a room, mostly; one room stands on the axis of each row.
    fn lightest(&self, genome: &Genome, room: usize, rng: &mut Stream) -> usize {
        let rooms = &self.twins.even.rooms;
        let of = |band: usize| genome.bands[band].cells.iter().map(|c| rooms[c.host].area_target).sum::<f64>();
        let count = self.figure.rows();
        let load = |band: usize| -> f64 {
            if self.figure.side() == Some(band) {
                return 2.0 * of(band);
            }
            let row = band % count;
            let all = 2.0 * of(row) + of(row + count) + of(row + 2 * count) + of(row + 3 * count);
            let taken = self.figure.middles().contains(&band) && !genome.bands[band].cells.is_empty();
            let paired = if band < count || self.figure.middles().contains(&band) { 0.0 } else { FILLED * of(band) };
            all + paired + if taken { FULL } else { 0.0 }
        };
        let mut bands = self.bands_for(room);
        if self.figure == Figure::Ring(Scheme::Racetrack) {
            // the core has no facade, and its stations see the doors on both sides of it
            let spec = &rooms[room];
            let dark = matches!(spec.daylight, Daylight::None | Daylight::Optional);
            let inside = dark || spec.open_front && spec.zone == Zone::Staff;
            bands.retain(|band| (band % count >= CORE_ROWS) == inside);
        }
        let best = bands.iter().copied().min_by(|a, b| load(*a).total_cmp(&load(*b))).unwrap_or(0);
        if rng.chance(0.75) { best } else { *rng.pick(&bands).unwrap_or(&best) }
    }

    /// Puts a small room beside a larger one of the same half, else by itself.
    fn nest(&self, genome: &mut Genome, room: usize, rng: &mut Stream) {
        let brief = &self.twins.even;
        let tied = tie(self.brief, room);
        let mut places = Vec::new();
        for band in self.bands_for(room) {
            for (c, cell) in genome.bands[band].cells.iter().enumerate() {
                let host = &brief.rooms[cell.host];
                let large = host.gate.is_none() && host.area_target >= 1.8 * brief.rooms[room].area_target;
                let spared = brief.is_home() || host.spares_a_corner();
                if tied.map_or(large && spared, |h| cell.host == h) && !(cell.left.is_full() || cell.right.is_full()) {
                    places.push((band, c));
                }
            }
        }
        let Some(&(band, c)) = rng.pick(&places) else {
            let band = self.lightest(genome, room, rng);
            let cells = &mut genome.bands[band].cells;
            cells.insert(rng.below(cells.len() + 1), Cell::new(room));
            return;
        };
        let cell = &mut genome.bands[band].cells[c];
        if cell.nest_depth == 0 {
            cell.nest_depth = nest_depth(brief, room);
        }
        if rng.chance(0.5) { cell.left.push(room) } else { cell.right.push_front(room) }
    }

    /// One run: from a random start, hot to cold; then from its best plan with the order of rooms in view.
    fn anneal(&mut self, judge: &mut Judge<'_>, weights: &Weights, rng: &mut Stream, stop: Stop<'_>) -> Candidate {
        let start = self.start(rng);
        let steps = (STEPS_PER_ROOM * self.brief.rooms.len()).clamp(STEPS.0, STEPS.1);
        let best = self.cool(judge, (weights, HEAT.0, false), start, steps, rng, stop);
        let best = self.cool(judge, (weights, HEAT_IN_ORDER, true), best, steps / IN_ORDER, rng, stop);
        let mut layout = Layout::default();
        self.realize(&best, &mut layout);
        let mut score = judge.score(&layout);
        score.symmetry = self.unlike(&layout);
        Candidate { scheme: if best.scheme == Scheme::Capped { Scheme::Straight } else { best.scheme }, layout, score }
    }

    /// Changes a plan step by step, from a temperature down; returns the best one that it came past.
    fn cool(
        &mut self,
        judge: &mut Judge<'_>,
        (weights, heat, in_order): (&Weights, f64, bool),
        start: Genome,
        steps: usize,
        rng: &mut Stream,
        stop: Stop<'_>,
    ) -> Genome {
        let mut layout = Layout::default();
        let mut value = |half: &mut Self, genome: &Genome, most: f64| {
            half.realize(genome, &mut layout);
            if in_order {
                let score = judge.score(&layout);
                let unsound = if score.is_sound() { 0.0 } else { UNSOUND };
                return score.total(weights) + half.misses(&layout) + judge.disorder(&layout) + unsound;
            }
            let cost = judge.cost_up_to(&layout, weights, most);
            if cost > most { cost } else { cost + half.misses(&layout) }
        };
        let even = self.twins.even.clone();
        let mut current = start;
        let mut cost = value(self, &current, f64::MAX);
        let (mut best, mut least) = (current.clone(), cost);
        let mut trial = current.clone();
        let mut step = 0;
        // changes that part twins are no steps
        for tries in 0..TRIES * steps {
            if step == steps || tries % LOOK == 0 && stop.is_set() {
                break;
            }
            let left = 1.0 - step as f64 / steps as f64;
            let heat = HEAT.1 + (heat - HEAT.1) * left * left * left;
            trial.clone_from(&current);
            if !mutate(&even, &mut trial, rng) || !self.keeps_twins(&trial) {
                continue;
            }
            step += 1;
            let worst = cost + heat * patience(rng);
            let next = value(self, &trial, worst);
            if next <= worst {
                std::mem::swap(&mut current, &mut trial);
                cost = next;
                if cost < least {
                    best.clone_from(&current);
                    least = cost;
                }
            }
        }
        best
    }

    /// Returns what it costs that not all of a layout has its like across the axis, and that one enters beside it.
    fn unlike(&self, layout: &Layout) -> f64 {
        let Some(found) = mirror::likeness(self.brief, &layout.boxes) else { return NOT_ALIKE };
        let hall = self.brief.rooms.iter().position(|r| r.entrance).filter(|hall| Some(*hall) != self.brief.spine);
        let aside = hall.is_some_and(|hall| found.images[hall] != Some(hall));
        NOT_ALIKE * (1.0 - found.share) + OTHER_TYPE * (1.0 - found.of_type) + if aside { ASIDE } else { 0.0 }
    }

    /// Returns what is against a layout beside what the judge knows.
    fn misses(&self, layout: &Layout) -> f64 {
        self.unlike(layout) + SHORT_ROW * layout.notch
    }

    /// Writes the rectangles of both halves to `layout`.
    fn realize(&mut self, genome: &Genome, layout: &mut Layout) {
        layout.boxes.clear();
        (layout.misfit, layout.notch, layout.one_way, layout.round) = (0.0, 0.0, 0.0, None);
        self.spans.clear();
        match self.figure {
            Figure::Across => self.across(genome, layout),
            Figure::Along => self.along(genome, layout),
            Figure::Ring(_) => self.ring(genome, layout),
        }
    }

    fn across(&mut self, genome: &Genome, layout: &mut Layout) {
        let w = spine_units(self.brief);
        let rows = [0, 1].map(|band| self.row(genome, band, 0, layout));
        let len = even_length(&rows, layout).max(door_need(self.brief.entrance_width) / 2 * 2 + 2);
        self.way(layout, Cellbox::new(0, 0, len, w));
        let [top, bottom] = rows;
        self.fill(genome, &top, (len, w, 1), layout);
        self.fill(genome, &bottom, (len, 0, -1), layout);
    }

    fn ring(&mut self, genome: &Genome, layout: &mut Layout) {
        let Some(link) = self.brief.ring else { return };
        let w = spine_units(self.brief);
        let used = |band: usize| !genome.bands[band].cells.is_empty();
        let deep = |row: usize| if (0..4).any(|k| used(row + 4 * k)) { genome.bands[row].depth } else { 0 };
        let side = self.figure.side().filter(|&band| used(band));
        let reach = side.map_or(0, |band| genome.bands[band].depth);
        let rows = [reach, reach, -w, -w];
        let rows: [Row; 4] = std::array::from_fn(|band| self.row(genome, band, rows[band], layout));
        let len = even_length(&rows, layout).max(4 * w);
        let inside = deep(2) + deep(3);
        let mut core = inside + genome.court;
        let along_side = side.map(|band| self.cells_of(genome, band, genome.bands[band].depth, layout));
        if let Some(Cells { sum, .. }) = along_side {
            core = core.max(sum.target.clamp(sum.min, sum.max.max(sum.min)));
        }
        let high = 2 * w + core;
        layout.round = Some(Cellbox::new(0, 0, len, high));
        self.way(layout, Cellbox::new(-reach, 0, len + reach, w));
        self.way(layout, Cellbox::new(-reach, w + core, len + reach, high));
        self.way(layout, Cellbox::new(0, w, w, w + core));
        let least = up(self.brief.rooms[link].area_min / (meters(w) - 2.0 * OUTER_HALF_M) + 2.0 * INNER_HALF_M).max(w);
        let closing = if genome.court > 0 && core > least + w { least } else { core };
        layout.boxes.push((link, Cellbox::new(len - w, w, len, w + closing)));
        if closing < core {
            self.way(layout, Cellbox::new(len - w, w + closing, len, w + core));
        }
        let [top, bottom, lower, upper] = rows;
        self.fill(genome, &top, (len, high, 1), layout);
        self.fill(genome, &bottom, (len, 0, -1), layout);
        let bare = |row: usize| if deep(row) == 0 { meters(len) } else { 0.0 };
        layout.notch += BARE * (bare(0) + bare(1));
        // what the rows inside leave open at each end
        let gaps = [(&lower, w, 1), (&upper, w + core, -1)].map(|(row, y, v)| {
            let before = layout.notch;
            self.fill(genome, row, (len, y, v), layout);
            (layout.notch - before) / 2.0
        });
        if let Some(cells) = along_side {
            let frame = Frame { origin: (len, w), u: (0, 1), v: (1, 0) };
            let from = layout.boxes.len();
            self.lay(genome, cells, (&frame, genome.bands[cells.band].depth), core, layout);
            self.mirror(from, Axis::Upright(len), layout);
        }
        layout.misfit += if genome.court > 0 {
            court_misfit([core - inside, len - 2 * w], court_need(self.brief))
        } else {
            core_misfit(gaps, [deep(2), deep(3)], self.brief.court_width) + if core == 0 { meters(4 * w) } else { 0.0 }
        };
    }

    fn along(&mut self, genome: &Genome, layout: &mut Layout) {
        let w = spine_units(self.brief);
        let depth = genome.bands[0].depth;
        let row = self.row(genome, 0, 0, layout);
        let part = row.block.target;
        let len = (row.mirrored.sum.target + part).max(door_need(self.brief.entrance_width));
        let (from, to) = if self.at_end { (0, len - part) } else { (part, 0) };
        self.way(layout, Cellbox::new(0, 0, len, w));
        let begin = layout.boxes.len();
        let frame = Frame { origin: (from, w), u: (1, 0), v: (0, 1) };
        self.lay(genome, row.mirrored, (&frame, depth), len - part, layout);
        self.mirror(begin, Axis::Level(w), layout);
        for (cells, (y, v)) in row.blocks.into_iter().zip([(w, 1), (0, -1)]) {
            let frame = Frame { origin: (to, y), u: (1, 0), v: (0, v) };
            self.lay(genome, cells, (&frame, depth), part, layout);
        }
        for (end, cap) in genome.caps.iter().enumerate() {
            let Some(cap) = cap.map(|cap| Cap { cover: Cover::Both, ..cap }) else { continue };
            let width = cap_box(self.brief, cap, w, depth, depth, &mut layout.misfit);
            let (x0, x1) = if end == 0 { (-width, 0) } else { (len, len + width) };
            layout.boxes.push((cap.room, Cellbox::new(x0, -depth, x1, w + depth)));
            if self.brief.second_exit {
                layout.one_way = (meters(len) - ONE_WAY_M).max(0.0);
            }
        }
    }

    /// Adds a piece of corridor.
    fn way(&self, layout: &mut Layout, shape: Cellbox) {
        layout.boxes.extend(self.brief.spine.map(|spine| (spine, shape)));
    }

    /// Works out the spans of a band's cells.
    fn cells_of(&mut self, genome: &Genome, band: usize, depth: i32, layout: &mut Layout) -> Cells {
        let first = self.spans.len();
        let mut sum = Span::default();
        for cell in &genome.bands[band].cells {
            let one = span(&self.twins.even, cell, depth, &mut layout.misfit);
            sum = Span { min: sum.min + one.min, target: sum.target + one.target, max: sum.max + one.max };
            self.spans.push(one);
        }
        Cells { band, first, sum }
    }

    /// Makes the last cell wider by what the outer wall at its end is thicker than an inner one.
    fn widen_last(&mut self, genome: &Genome, cells: &mut Cells) {
        let more = up(OUTER_HALF_M - INNER_HALF_M);
        let count = genome.bands[cells.band].cells.len();
        let last = count.checked_sub(1).and_then(|last| self.spans.get_mut(cells.first + last));
        for span in last.into_iter().chain((count > 0).then_some(&mut cells.sum)) {
            *span = Span { min: span.min + more, target: span.target + more, max: span.max + more };
        }
    }

    fn row(&mut self, genome: &Genome, band: usize, beyond: i32, layout: &mut Layout) -> Row {
        let depth = genome.bands[band].depth;
        let count = self.figure.rows();
        let [mirrored, middle, left, right] =
            [0, 1, 2, 3].map(|kind| self.cells_of(genome, band + kind * count, depth, layout));
        let (mut mirrored, mut left, mut right) = (mirrored, left, right);
        if beyond >= 0 {
            let blocks = self.at_end && left.sum.max + right.sum.max > 0;
            let outermost = if blocks { [Some(&mut left), Some(&mut right)] } else { [Some(&mut mirrored), None] };
            outermost.into_iter().flatten().for_each(|cells| self.widen_last(genome, cells));
        }
        let low = left.sum.min.max(right.sum.min);
        let high = match (left.sum.max, right.sum.max) {
            (0, most) | (most, 0) => {
                // nothing stands across from what is there
                layout.misfit += meters(low);
                most
            }
            (first, second) => first.min(second),
        };
        layout.misfit += meters((low - high).max(0));
        let high = high.max(low);
        let block = Span { min: low, target: ((left.sum.target + right.sum.target) / 2).clamp(low, high), max: high };
        Row { beyond, mirrored, middle, blocks: [left, right], block }
    }

    /// Lays a row along a corridor of a length: the half away from the axis, its mirror image, and what has no twin.
    fn fill(&mut self, genome: &Genome, row: &Row, (len, y, v): (i32, i32, i32), layout: &mut Layout) {
        let cells = &genome.bands[row.mirrored.band].cells;
        if row.mirrored.sum.max + row.middle.sum.max + row.block.max == 0 {
            return;
        }
        let depth = genome.bands[row.mirrored.band].depth;
        let half = len / 2 + row.beyond;
        let Span { min, target, max } = row.middle.sum;
        // as one cell, of which half stands on each side
        let on_axis = Span { min: (min + 1) / 2, target: target / 2, max: (max / 2).max((min + 1) / 2) };
        let mut spans = self.spans[row.mirrored.first..row.mirrored.first + cells.len()].to_vec();
        spans.extend([row.block, on_axis]);
        shares(&spans, half, &mut self.widths);
        let gap = half - self.widths.iter().sum::<i32>();
        judge_gap(2 * gap, gap, layout);
        let middle = 2 * self.widths.pop().unwrap_or(0);
        let block = self.widths.pop().unwrap_or(0);
        let own: i32 = self.widths.iter().sum();
        let (from, to) = if self.at_end { (0, own) } else { (block, 0) };
        let axis = len / 2;
        let frame = Frame { origin: (axis + middle / 2 + from, y), u: (1, 0), v: (0, v) };
        let begin = layout.boxes.len();
        self.lay_widths(cells, (&frame, depth), layout);
        self.mirror(begin, Axis::Upright(len), layout);
        for (cells, side) in row.blocks.into_iter().zip([-1, 1]) {
            let frame = Frame { origin: (axis + side * (middle / 2 + to), y), u: (side, 0), v: (0, v) };
            self.lay(genome, cells, (&frame, depth), block, layout);
        }
        let frame = Frame { origin: (axis - middle / 2, y), ..frame };
        self.lay(genome, row.middle, (&frame, depth), middle, layout);
    }

    /// Lays cells along a frame over a length.
    fn lay(&mut self, genome: &Genome, cells: Cells, (frame, depth): (&Frame, i32), len: i32, layout: &mut Layout) {
        let list = &genome.bands[cells.band].cells;
        if !list.is_empty() {
            shares(&self.spans[cells.first..cells.first + list.len()], len, &mut self.widths);
            let gap = len - self.widths.iter().sum::<i32>();
            judge_gap(gap, gap, layout);
            self.lay_widths(list, (frame, depth), layout);
        }
    }

    fn lay_widths(&self, cells: &[Cell], (frame, depth): (&Frame, i32), layout: &mut Layout) {
        let mut at = 0;
        for (cell, &width) in cells.iter().zip(&self.widths) {
            let missed = fill_cell((&self.twins.even, &mut *layout), (frame, depth), cell, at, width);
            layout.misfit += missed;
            at += width;
        }
    }

    /// Adds the mirror images of the rectangles from `first` on: those of the twins.
    fn mirror(&self, first: usize, axis: Axis, layout: &mut Layout) {
        for at in first..layout.boxes.len() {
            let (room, shape) = layout.boxes[at];
            layout.boxes.extend(self.twins.other[room].map(|twin| (twin, axis.image(shape))));
        }
    }
}

/// Counts what rows leave open of a length in all, in pieces that long; or what they are too long by.
fn judge_gap(all: i32, piece: i32, layout: &mut Layout) {
    if all > 0 {
        layout.notch += meters(all);
        let piece = meters(piece);
        layout.misfit += if piece < MIN_NOTCH_M { piece.min(MIN_NOTCH_M - piece).max(0.05) } else { 0.0 };
    } else {
        layout.misfit += meters(-all);
    }
}

/// Returns the length of the corridor that rows share, as wished on the mean, within what all can do; an even one, for the axis
/// is a line of the lattice.
fn even_length(rows: &[Row], layout: &mut Layout) -> i32 {
    let used = || rows.iter().filter(|r| r.mirrored.sum.max + r.middle.sum.max + r.block.max > 0);
    let all = |of: fn(&Span) -> i32, r: &Row| 2 * (of(&r.mirrored.sum) + of(&r.block) - r.beyond) + of(&r.middle.sum);
    let low = used().map(|r| all(|s| s.min, r)).max().unwrap_or(0);
    let high = used().map(|r| all(|s| s.max, r)).min().unwrap_or(low);
    let wish = used().map(|r| all(|s| s.target, r)).sum::<i32>() / used().count().max(1) as i32;
    let len = if high < low { low } else { wish.clamp(low, high) };
    layout.misfit += meters((1 - len).max(0));
    let even = len + len.rem_euclid(2);
    (if even > high { len - len.rem_euclid(2) } else { even }).max(low).max(2) / 2 * 2
}
