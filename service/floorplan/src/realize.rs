//! From genome to rectangles: widths follow from areas, all bands along one corridor share its length.

use std::cmp::Ordering;

use d3dgen_model::domain::Scheme;
use d3dgen_model::measures::JAMB_M;
use d3dgen_model::style::Form;

use super::core::Comb;
use super::genome::{CORE_BAND, Cap, Cell, Cover, EAST_BAND, Genome, WEST_BAND};
use super::lattice::{Cellbox, Frame, INNER_HALF_M, OUTER_HALF_M, meters, nearest, up};
use super::spec::Brief;

/// Room proportions stay below 1 : 2.5; the search aims a little lower.
pub(crate) const MAX_PROPORTION: f64 = 2.4;
/// A notch in the outline shorter than this is a stagger without a reason, m.
pub(crate) const MIN_NOTCH_M: f64 = 1.5;
/// The same of a home, m: a narrow one is a shaft between two rooms.
const MIN_NOTCH_AT_HOME_M: f64 = 2.4;

/// How many times longer than wide a court is at most.
const MOST_COURT: f64 = 3.0;

/// How much wider than it must be a court is that a building of other than one household is made around, m.
const BEYOND_LEAST_M: f64 = 2.0;
/// How wide a court is at least, as a share of the side of a square as large as all rooms: a large building has no shaft.
const COURT_SHARE: f64 = 0.28;
/// How much more a corridor around a court counts than a notch as long that has no room on its facade.
pub(crate) const BARE: f64 = 5.0;
/// How much more a notch in the outline around a court counts.
const AROUND_COURT: f64 = 5.0;

/// How far each arm of an L that is asked for reaches beyond the other at least, m.
const ARM_M: f64 = 3.0;

/// What a ring of corridors misses that nothing closes or that goes around nothing, in meters.
const NO_RING: f64 = 10.0;

/// Longest corridor from which there is one way out only, m (Approved Document B, table 2.1: 18 m to walk in one direction, and
/// a room lies at its end).
pub(crate) const ONE_WAY_M: f64 = 15.0;

/// What a cell between the core and the end of its band misses, in meters, where the other end has stairs too.
const AT_END: f64 = 2.0;

/// What a meter between the depth of the core and that of its band counts, in meters of notch.
const CORE_STEP: f64 = 6.0;

/// Rectangles of a plan on the lattice; a room may own several.
#[derive(Debug, Clone, Default)]
pub(crate) struct Layout {
    pub boxes: Vec<(usize, Cellbox)>,
    /// How far sizes miss what is possible, m: 0 for a plan that can be built.
    pub misfit: f64,
    /// Total length of notches, m.
    pub notch: f64,
    /// True where all rooms lie along one straight corridor: nothing but the sizes of rooms is a reason for a notch.
    pub bar: bool,
    /// How much too long a corridor with one way out is, m.
    pub one_way: f64,
    /// True where the stairs are right beside the only end of the hall that has a wall to outdoors.
    pub stairs_at_door: bool,
    /// Where the core is: its corner at the corridor, along the corridor, away from it.
    pub core: Option<Frame>,
    /// How the wings stand, in a building of wings.
    pub comb: Comb,
    /// Where the second stairwell of a bar begins, along the corridor from the core.
    pub far: Option<i32>,
    /// The rectangle whose sides a ring of corridors runs along.
    pub round: Option<Cellbox>,
}

/// Least, wished and largest width of a cell for a band depth, lattice units.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Span {
    pub min: i32,
    pub target: i32,
    pub max: i32,
}

/// Clear width from which a door is one for beds, m.
pub(crate) const BED_DOOR_M: f64 = 1.1;
/// What a passage beside small rooms has beyond such a door, m: a bed 1.0 m wide and 2.2 m long turns from 1.8 m into 1.25 m.
const BED_TURN_M: f64 = 0.2;

/// Returns the length of wall a door needs between two room corners, lattice units.
pub(crate) fn door_need(clear_m: f64) -> i32 {
    up(Brief::opening(clear_m) + 2.0 * JAMB_M + INNER_HALF_M + OUTER_HALF_M)
}

/// Returns the corridor's width between wall center lines, lattice units.
pub(crate) fn spine_units(brief: &Brief) -> i32 {
    // wings and courtyards put outer walls on both sides; the hall of a home has rooms along one at least
    let walls = OUTER_HALF_M + if brief.for_homes { INNER_HALF_M } else { OUTER_HALF_M };
    let width = up(brief.spine_width + walls);
    // The entrance door stands in the corridor's end wall, between two corners with outer walls.
    let upper = brief.upper && !brief.for_homes;
    let entered = brief.spine.is_some_and(|s| brief.rooms[s].entrance) || brief.second_exit || upper;
    let least = if entered { width.max(door_need(brief.entrance_width) + 1) } else { width };
    least + nearest(brief.spine_extra)
}

/// Working memory of [`realize`], so that a candidate costs no allocation.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    /// Spans of the cells of all rows, row after row.
    spans: Vec<Span>,
    widths: Vec<i32>,
}

/// A band waiting for its length: `len = var + offset`.
struct Row<'a> {
    cells: &'a [Cell],
    depth: i32,
    offset: i32,
    frame: Frame,
    /// Where its spans begin.
    spans: usize,
    sum: Span,
}

impl<'a> Row<'a> {
    fn new(task: &mut Task<'a, '_>, band: usize, offset: i32) -> Self {
        let band = &task.genome.bands[band];
        let spans = task.scratch.spans.len();
        let mut sum = Span::default();
        for cell in &band.cells {
            let one = span(task.brief, cell, band.depth, &mut task.misfit);
            sum = Span { min: sum.min + one.min, target: sum.target + one.target, max: sum.max + one.max };
            task.scratch.spans.push(one);
        }
        let frame = Frame { origin: (0, 0), u: (1, 0), v: (0, 1) };
        Self { cells: &band.cells, depth: band.depth, offset, frame, spans, sum }
    }

    fn at(mut self, origin: (i32, i32), u: (i32, i32), v: (i32, i32)) -> Self {
        self.frame = Frame { origin, u, v };
        self
    }
}

/// A genome on its way to rectangles.
struct Task<'a, 's> {
    brief: &'a Brief,
    genome: &'a Genome,
    spine: usize,
    scratch: &'s mut Scratch,
    misfit: f64,
    layout: &'s mut Layout,
}

impl Task<'_, '_> {
    fn spine_box(&mut self, shape: Cellbox) {
        self.layout.boxes.push((self.spine, shape));
    }
}

/// Writes the rectangles of a genome to `layout`.
pub(crate) fn realize(brief: &Brief, genome: &Genome, scratch: &mut Scratch, layout: &mut Layout) {
    layout.boxes.clear();
    (layout.misfit, layout.notch, layout.one_way, layout.core) = (0.0, 0.0, 0.0, None);
    layout.stairs_at_door = false;
    (layout.far, layout.round) = (None, None);
    layout.bar = matches!(genome.scheme, Scheme::Straight | Scheme::Capped);
    scratch.spans.clear();
    let Some(spine) = brief.spine else { return };
    let mut task = Task { brief, genome, spine, scratch, misfit: 0.0, layout };
    match genome.scheme {
        Scheme::Straight | Scheme::Capped => straight(&mut task),
        Scheme::Angle => angle(&mut task),
        Scheme::Racetrack | Scheme::Courtyard => ring(&mut task),
        // wings are realized one by one
        Scheme::Comb => {}
    }
    let misfit = task.misfit;
    layout.misfit += misfit;
}

fn straight(task: &mut Task<'_, '_>) {
    let (brief, genome) = (task.brief, task.genome);
    let (dt, db) = (used_depth(genome, 0), used_depth(genome, 1));
    let mut w = spine_units(brief);
    let caps = genome.caps.map(|cap| cap.map(|c| (c, cap_box(brief, c, w, dt, db, &mut task.misfit))));
    let extra = |top: bool| -> [i32; 2] {
        caps.map(|cap| match cap {
            Some((Cap { cover: Cover::Both, .. }, _)) | None => 0,
            Some((c, width)) if c.under && (c.cover == Cover::Top) != top => width,
            Some(_) => 0,
        })
    };
    let (et, eb) = (extra(true), extra(false));
    // the second stairs close the row that the core begins
    let gable = brief.core.as_ref().filter(|c| c.gable).and_then(|c| Some((c, c.far?.1)));
    let stairs = gable.map_or(0, |(_, width)| width);
    let top = Row::new(task, CORE_BAND, et[0] + et[1] - stairs);
    let bottom = Row::new(task, 1, eb[0] + eb[1]);
    let mut len = solve(&[&top, &bottom], &mut task.misfit);
    // of rows that cannot be as long as each other, the longer one is as long as it wants to be where it carries a storey
    let short = |row: &&Row<'_>| !row.cells.is_empty() && row.sum.max - row.offset < len;
    if brief.carries > 0.0 && [&top, &bottom].into_iter().any(|row| short(&row)) {
        let wish = (top.sum.target - top.offset).max(bottom.sum.target - bottom.offset);
        len = within(&[&top, &bottom], wish).unwrap_or(len);
    }
    if let Some((core, width)) = gable {
        let wish = core.below.as_ref().and_then(|b| b.far).map_or(len.max(core.least), |far| far + width);
        len = within(&[&top, &bottom], wish).unwrap_or(len);
    }
    if brief.hub {
        (len, w) = hub_size(brief, task.spine, len, &mut task.misfit);
    }
    len = len.max(door_need(brief.entrance_width));
    if brief.second_exit && !brief.upper && caps.iter().any(Option::is_some) {
        // a room at its end leaves a corridor one way out
        task.layout.one_way = (meters(len) - ONE_WAY_M).max(0.0);
    }
    task.spine_box(Cellbox::new(0, 0, len, w));
    if brief.stem {
        // the spine that the wing hangs on
        task.spine_box(Cellbox::new(-w, -db, 0, w + dt));
    }
    fill(task, &top.at((-et[0], w), (1, 0), (0, 1)), len + et[0] + et[1] - stairs);
    fill(task, &bottom.at((-eb[0], 0), (1, 0), (0, -1)), len + eb[0] + eb[1]);
    if gable.is_some() {
        second_stairs(task, len, w);
    }
    task.layout.stairs_at_door = stairs_at_door(brief, task.layout.core.as_ref(), caps.map(|c| c.is_some()), len);
    for (side, cap) in caps.iter().enumerate() {
        let Some((cap, width)) = cap else { continue };
        let (y0, y1) =
            (if cap.cover == Cover::Top { 0 } else { -db }, if cap.cover == Cover::Bottom { w } else { w + dt });
        let (x0, x1) = if side == 0 { (-width, 0) } else { (len, len + width) };
        task.layout.boxes.push((cap.room, Cellbox::new(x0, y0, x1, y1)));
    }
}

/// Returns true where a straight hall of a home is entered at one end and the stairs are within a leaf's swing of it.
fn stairs_at_door(brief: &Brief, core: Option<&Frame>, [west, east]: [bool; 2], len: i32) -> bool {
    let Some((frame, core)) = core.zip(brief.core.as_ref()).filter(|_| brief.of_home && !brief.upper) else {
        return false;
    };
    let leaf = up(Brief::opening(brief.entrance_width) + JAMB_M);
    let (from, to) = (frame.origin.0, frame.origin.0 + core.width);
    match (west, east) {
        (false, true) => from < leaf,
        (true, false) => to > len - leaf,
        _ => false,
    }
}

/// Sets the second stairwell at the end of the row that the core begins, where that of the storey below is.
fn second_stairs(task: &mut Task<'_, '_>, len: i32, w: i32) {
    let Some(core) = task.brief.core.as_ref() else { return };
    let (Some((stairs, width)), Some(frame)) = (core.far, task.layout.core) else { return };
    // the core is at one end, so that the corridor is as long on every storey
    let place = |cells: &[Cell]| cells.iter().position(|c| c.host == core.host);
    let before = task.genome.bands.iter().filter_map(|b| place(&b.cells)).sum::<usize>();
    task.misfit += AT_END * before as f64 + if task.genome.caps.iter().any(Option::is_some) { AT_END } else { 0.0 };
    let end = len - width - frame.origin.0;
    let from = core.below.as_ref().and_then(|b| b.far).unwrap_or(end);
    // rooms where the stairs are, or a corridor that goes on alone to them
    let gap = meters(from - end);
    task.misfit += (-gap).max(0.0) + if gap > 0.0 { gap.min((MIN_NOTCH_M - gap).max(0.0)) } else { 0.0 };
    task.layout.notch += 2.0 * gap.max(0.0);
    if gap > 0.0 {
        let reach = frame.origin.0 + from + width;
        task.spine_box(Cellbox::new(len, 0, reach, w));
    }
    let shape = frame.place(from, from + width, 0, core.depth);
    task.layout.boxes.push((stairs, shape));
    task.layout.far = Some(from);
}

/// Returns length and width of a hub room that must be `len` long at least, from its area.
fn hub_size(brief: &Brief, spine: usize, len: i32, misfit: &mut f64) -> (i32, i32) {
    let spec = &brief.rooms[spine];
    // a room by itself has no neighbor to share a wall with
    let walls = OUTER_HALF_M + if brief.rooms.len() == 1 { OUTER_HALF_M } else { INNER_HALF_M };
    if let Some([a, b]) = spec.sides {
        return (nearest(a.max(b) + walls), nearest(a.min(b) + walls));
    }
    let natural = up((spec.area_target * 1.4).sqrt() + walls);
    let proportion = meters(len).powi(2) / spec.area_target;
    // the small rooms of a small home are as long as the room they open to
    let natural = if brief.for_homes { up((spec.area_target * 0.5).sqrt() + walls) } else { natural };
    let length = if (0.5..=2.2).contains(&proportion) { len } else { len.max(natural) };
    let length = length.max(up(spec.min_dimension + walls));
    let mut width = nearest(spec.area_target / (meters(length) - walls) + walls);
    let least = up(spec.min_dimension + walls).max(up((meters(length) - walls) / MAX_PROPORTION + walls));
    if width < least {
        width = least;
        let area = (meters(width) - walls) * (meters(length) - walls);
        *misfit += (area - spec.area_max).max(0.0) / 4.0;
    }
    (length, width)
}

fn angle(task: &mut Task<'_, '_>) {
    let (brief, genome) = (task.brief, task.genome);
    let w = spine_units(brief);
    let (dt, dr) = (used_depth(genome, 0), used_depth(genome, 2));
    // an L that is asked for has no notch where its arms meet
    let asked = brief.form == Some(Form::LShaped);
    let beyond = if genome.corner || asked { dr } else { 0 };
    let top = Row::new(task, 0, 0);
    let bottom = Row::new(task, 1, w + beyond);
    let right = Row::new(task, 2, 0);
    let inner = Row::new(task, 3, -w - dt);
    let x = solve(&[&top, &bottom], &mut task.misfit).max(w);
    let y = solve(&[&right, &inner], &mut task.misfit).max(w + dt + up(1.5));
    if asked {
        let arms = [x - used_depth(genome, 3), y - w - dt];
        task.misfit += arms.map(|arm| (ARM_M - meters(arm)).max(0.0)).iter().sum::<f64>();
    }
    let before = task.layout.notch;
    task.spine_box(Cellbox::new(0, 0, x + w, w));
    task.spine_box(Cellbox::new(x, w, x + w, y));
    fill(task, &top.at((0, w), (1, 0), (0, 1)), x);
    fill(task, &bottom.at((0, 0), (1, 0), (0, -1)), x + w + beyond);
    fill(task, &right.at((x + w, 0), (0, 1), (1, 0)), y);
    fill(task, &inner.at((x, w + dt), (0, 1), (-1, 0)), y - w - dt);
    if asked {
        task.misfit += task.layout.notch - before;
    }
}

/// Lays a ring of corridors: rooms outside along its long sides, and inside, back to back around a core or apart on a court.
fn ring(task: &mut Task<'_, '_>) {
    let (brief, genome) = (task.brief, task.genome);
    let Some(link) = brief.ring else {
        task.misfit += NO_RING;
        return;
    };
    let w = spine_units(brief);
    let inside = [2, 3].map(|band| used_depth(genome, band));
    let around = genome.scheme == Scheme::Courtyard;
    // the short sides of a court have rooms too: the corridors go on between them to the facade, where the ways out are; at home,
    // where the entrance is way out enough, one row goes on past the end of the next at the corners in the west
    let [west, east] = [WEST_BAND, EAST_BAND].map(|band| if around { used_depth(genome, band) } else { 0 });
    let out = if brief.second_exit { west } else { 0 };
    let [over, under] = [west, if west > out { used_depth(genome, 1) } else { 0 }];
    let top = Row::new(task, 0, over + east);
    let bottom = Row::new(task, 1, out + east);
    let lower = Row::new(task, 2, -2 * w);
    let upper = Row::new(task, 3, -2 * w);
    let len = solve(&[&top, &bottom, &lower, &upper], &mut task.misfit).max(4 * w);
    let mut core = inside[0] + inside[1] + genome.court;
    let corner = if west > out { 2 * w + under } else { 0 };
    let sides = around.then(|| [Row::new(task, WEST_BAND, corner), Row::new(task, EAST_BAND, 0)]);
    if let Some([left, right]) = &sides {
        core = core.max(solve(&[left, right], &mut task.misfit));
    }
    task.misfit += if core == 0 { NO_RING } else { 0.0 };
    let high = 2 * w + core;
    task.layout.round = Some(Cellbox::new(0, 0, len, high));
    task.spine_box(Cellbox::new(-out, 0, len + east, w));
    task.spine_box(Cellbox::new(0, w, w, w + core));
    task.spine_box(Cellbox::new(-out, w + core, len + east, high));
    // what closes the ring has no doors: around a court it is as short as its width and area allow; a core has no rooms on its
    // short sides
    let least = up(brief.rooms[link].area_min / (meters(w) - 2.0 * OUTER_HALF_M) + 2.0 * INNER_HALF_M).max(w);
    let closing = if around && core > least + w { least } else { core };
    task.layout.boxes.push((link, Cellbox::new(len - w, w, len, w + closing)));
    if closing < core {
        task.spine_box(Cellbox::new(len - w, w + closing, len, w + core));
    }
    fill(task, &top.at((-over, high), (1, 0), (0, 1)), len + over + east);
    fill(task, &bottom.at((-out, 0), (1, 0), (0, -1)), len + out + east);
    if let Some([left, right]) = sides {
        fill(task, &left.at((0, if west > out { -under } else { w }), (0, 1), (-1, 0)), core + corner);
        fill(task, &right.at((len, w), (0, 1), (1, 0)), core);
    }
    if around {
        // a corridor along a facade without rooms is a way for nothing
        let bare = |band: usize, length: i32| if used_depth(genome, band) == 0 { meters(length) } else { 0.0 };
        let legs = bare(0, len) + bare(1, len) + bare(WEST_BAND, core) + bare(EAST_BAND, core);
        task.layout.notch += BARE * legs;
        task.layout.notch *= AROUND_COURT;
    }
    let before = task.layout.notch;
    fill(task, &lower.at((w, w), (1, 0), (0, 1)), len - 2 * w);
    let first = task.layout.notch - before;
    fill(task, &upper.at((w, w + core), (1, 0), (0, -1)), len - 2 * w);
    let second = task.layout.notch - before - first;
    task.misfit += if around {
        court_misfit([core - inside[0] - inside[1], len - 2 * w], court_need(brief))
    } else {
        core_misfit([first, second], inside, brief.court_width)
    };
}

/// Returns how wide a court is at least, m.
pub(crate) fn court_need(brief: &Brief) -> f64 {
    let all: f64 = brief.rooms.iter().map(|r| r.area_target).sum();
    let least = if brief.is_home() { brief.court_width } else { brief.court_width + BEYOND_LEAST_M };
    least.max(COURT_SHARE * all.sqrt())
}

/// Returns what the sides of a court miss, in meters: all have light, and one looks across it, not along a shaft.
pub(crate) fn court_misfit([deep, long]: [i32; 2], least: f64) -> f64 {
    let short = |side: i32| (least - meters(side)).max(0.0);
    let slot = meters(long.max(deep)) - MOST_COURT * meters(long.min(deep));
    short(deep) + short(long) + slot.max(0.0)
}

/// Returns what the rows of a core of these depths miss that end so far before the corridor, in meters: what they leave open is
/// a court at least so wide, or a hole that is none.
pub(crate) fn core_misfit(gaps: [f64; 2], depths: [i32; 2], least: f64) -> f64 {
    let court = |gap: f64| if gap < least { gap.min(least - gap) } else { 0.0 };
    let step = (gaps[0] - gaps[1]).abs();
    let stagger = if step < MIN_NOTCH_M { step.min(MIN_NOTCH_M - step) } else { 0.0 };
    // beside a row that goes on, a court is only as deep as the row that ends
    let deep = match gaps[0].total_cmp(&gaps[1]) {
        Ordering::Greater => depths[0],
        Ordering::Less => depths[1],
        Ordering::Equal => depths[0] + depths[1],
    };
    let shallow = if gaps[0] + gaps[1] > 0.0 { (least - meters(deep)).max(0.0) } else { 0.0 };
    gaps.map(court).iter().sum::<f64>() + stagger + shallow
}

/// Returns the depth of a band, 0 when nothing stands in it.
pub(crate) fn used_depth(genome: &Genome, band: usize) -> i32 {
    if genome.bands[band].cells.is_empty() { 0 } else { genome.bands[band].depth }
}

/// Returns the width of a cap from its area and the bands it covers, lattice units.
pub(crate) fn cap_box(brief: &Brief, cap: Cap, w: i32, dt: i32, db: i32, misfit: &mut f64) -> i32 {
    let height = match cap.cover {
        Cover::Both => dt + w + db,
        Cover::Top => w + dt,
        Cover::Bottom => w + db,
    };
    let spec = &brief.rooms[cap.room];
    let walls = INNER_HALF_M + OUTER_HALF_M;
    let clear = meters(height) - walls - INNER_HALF_M;
    let least = up(spec.min_dimension.max(clear / MAX_PROPORTION) + walls);
    let width = nearest(spec.area_target / clear.max(0.5) + walls).max(least);
    if spec.min_dimension > clear {
        *misfit += spec.min_dimension - clear;
    }
    width
}

/// Returns the widths a cell can have at this band depth.
pub(crate) fn span(brief: &Brief, cell: &Cell, depth: i32, misfit: &mut f64) -> Span {
    if let Some(core) = brief.core.as_ref().filter(|c| c.host == cell.host) {
        return Span { min: core.width, target: core.width, max: core.width };
    }
    let spec = &brief.rooms[cell.host];
    let clear_depth = meters(depth) - INNER_HALF_M - OUTER_HALF_M;
    let has_nests = cell.has_nests();
    let nests: i32 = if has_nests { cell.nests().map(|n| nest_width(brief, n, cell.nest_depth)).sum() } else { 0 };
    let main_depth =
        if has_nests { meters(depth - cell.nest_depth) - INNER_HALF_M - OUTER_HALF_M } else { clear_depth };
    if main_depth < spec.min_dimension {
        *misfit += spec.min_dimension - main_depth;
    }
    let carved = meters(nests) * meters(cell.nest_depth);
    let width_for = |area: f64| (area + carved) / clear_depth.max(0.5) + 2.0 * INNER_HALF_M;
    let turn = if spec.door_width >= BED_DOOR_M { up(BED_TURN_M) } else { 0 };
    let leg = if spec.on_spine { door_need(spec.door_width) + turn } else { 0 };
    let proportion_min = main_depth / MAX_PROPORTION + 2.0 * INNER_HALF_M;
    let proportion_max = main_depth * MAX_PROPORTION + 2.0 * INNER_HALF_M;
    let min = up(width_for(spec.area_min * 1.01).max(spec.min_dimension + 2.0 * INNER_HALF_M).max(proportion_min))
        .max(nests + leg);
    let max = nearest(width_for(spec.area_max * 0.99).min(proportion_max));
    if max < min {
        *misfit += meters(min - max);
    }
    let max = max.max(min);
    Span { min, target: nearest(width_for(spec.area_target)).clamp(min, max), max }
}

/// Returns the width of a small room at the given depth, lattice units.
fn nest_width(brief: &Brief, room: usize, depth: i32) -> i32 {
    let spec = &brief.rooms[room];
    let clear = (meters(depth) - 2.0 * INNER_HALF_M).max(0.3);
    let door = if spec.on_spine { door_need(spec.door_width) } else { 0 };
    nearest(spec.area_target / clear + 2.0 * INNER_HALF_M)
        .max(up(spec.area_min * 1.02 / clear + 2.0 * INNER_HALF_M))
        .max(up(spec.min_dimension + 2.0 * INNER_HALF_M))
        .max(door)
}

/// Returns the common variable of rows that share a corridor: as wished on the mean, within what all can do.
fn solve(rows: &[&Row<'_>], misfit: &mut f64) -> i32 {
    let used = || rows.iter().filter(|r| !r.cells.is_empty());
    let Some(low) = used().map(|r| r.sum.min - r.offset).max() else { return 0 };
    let high = used().map(|r| r.sum.max - r.offset).min().unwrap_or(low);
    let wish: i32 = used().map(|r| r.sum.target - r.offset).sum::<i32>() / used().count() as i32;
    if high < low {
        // The shorter rows end early; whether that is a notch or a stagger is judged where they are filled.
        return low;
    }
    let len = wish.clamp(low, high);
    if len <= 0 {
        *misfit += meters(1 - len);
    }
    len.max(1)
}

/// Returns the length closest to a wish that the longest row can have; shorter ones end early.
fn within(rows: &[&Row<'_>], wish: i32) -> Option<i32> {
    let used = || rows.iter().filter(|r| !r.cells.is_empty());
    let low = used().map(|r| r.sum.min - r.offset).max()?;
    let high = used().map(|r| r.sum.max - r.offset).max()?;
    Some(wish.clamp(low, high.max(low)).max(1))
}

/// Lays the cells of a row along its frame.
fn fill(task: &mut Task<'_, '_>, row: &Row<'_>, len: i32) {
    if row.cells.is_empty() {
        return;
    }
    let Scratch { spans, widths } = &mut *task.scratch;
    shares(&spans[row.spans..row.spans + row.cells.len()], len, widths);
    let total: i32 = widths.iter().sum();
    let gap = meters(len - total);
    if gap > 0.0 {
        task.layout.notch += gap;
        let least = if task.brief.for_homes { MIN_NOTCH_AT_HOME_M } else { MIN_NOTCH_M };
        if gap < least {
            task.misfit += gap.min(least - gap).max(0.05);
        }
    } else if gap < 0.0 {
        task.misfit -= gap;
    }
    let mut at = 0;
    for (i, cell) in row.cells.iter().enumerate() {
        let width = task.scratch.widths[i];
        task.misfit += fill_cell((task.brief, &mut *task.layout), (&row.frame, row.depth), cell, at, width);
        at += width;
    }
}

/// Lays a cell from `at` on along a frame; returns what it misses, in meters.
pub(crate) fn fill_cell(
    (brief, layout): (&Brief, &mut Layout),
    (frame, depth): (&Frame, i32),
    cell: &Cell,
    at: i32,
    width: i32,
) -> f64 {
    if let Some(core) = brief.core.as_ref().filter(|c| c.host == cell.host) {
        let corner = frame.place(at, at, 0, 0);
        layout.core = Some(Frame { origin: (corner.x0, corner.y0), ..*frame });
        layout.boxes.extend(core.boxes.iter().map(|(r, b)| (*r, frame.place(at + b.x0, at + b.x1, b.y0, b.y1))));
        // a step in the facade between the core and its neighbors needs a reason
        let step = meters((depth - core.depth).abs());
        layout.notch += CORE_STEP * step.min(3.0);
        return if step < MIN_NOTCH_M { step.min(MIN_NOTCH_M - step) } else { 0.0 };
    }
    if !cell.has_nests() {
        layout.boxes.push((cell.host, frame.place(at, at + width, 0, depth)));
        return 0.0;
    }
    let d = cell.nest_depth.min(depth - 1);
    let own = |room: usize| nest_width(brief, room, d);
    // Where nobody walks past, the small rooms take the whole front.
    let (mut each, mut more) = (0, 0);
    if !brief.rooms[cell.host].on_spine {
        let spare = width - cell.nests().map(own).sum::<i32>();
        let count = cell.nests().count() as i32;
        (each, more) = (spare / count, spare % count);
    }
    let wide = |(i, room): (usize, usize)| own(room) + each + i32::from((i as i32) < more);
    let first_right = cell.left.len();
    let left: i32 = cell.left.iter().enumerate().map(wide).sum();
    let right: i32 = cell.right.iter().enumerate().map(|(i, room)| wide((first_right + i, room))).sum();
    layout.boxes.push((cell.host, frame.place(at, at + width, d, depth)));
    if left + right < width {
        layout.boxes.push((cell.host, frame.place(at + left, at + width - right, 0, d)));
    }
    let mut x = at;
    for (i, room) in cell.nests().enumerate() {
        if i == first_right {
            x = at + width - right;
        }
        let w = wide((i, room));
        layout.boxes.push((room, frame.place(x, x + w, 0, d)));
        x += w;
    }
    meters((left + right - width).max(0))
}

/// Finds widths that add up to `len` where the spans allow it, each within its span, close to its target.
pub(crate) fn shares(spans: &[Span], len: i32, widths: &mut Vec<i32>) {
    widths.clear();
    widths.extend(spans.iter().map(|s| s.target));
    let mut rest = len - widths.iter().sum::<i32>();
    while rest != 0 {
        let sign = rest.signum();
        let room = |i: usize, w: i32| if sign > 0 { spans[i].max - w } else { w - spans[i].min };
        let open = (0..widths.len()).filter(|&i| room(i, widths[i]) > 0).count();
        if open == 0 {
            break;
        }
        let each = (rest.abs() / open as i32).max(1);
        for (i, width) in widths.iter_mut().enumerate() {
            let step = each.min(room(i, *width)).min(rest.abs()).max(0);
            *width += sign * step;
            rest -= sign * step;
        }
    }
}
