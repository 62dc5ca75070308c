//! From genome to rectangles: widths follow from areas, all bands along one corridor share its length.

use d3dgen_model::domain::Scheme;

use super::genome::{Cap, Cell, Cover, Genome};
use super::lattice::{Cellbox, Frame, INNER_HALF_M, JAMB_M, OUTER_HALF_M, meters, nearest, up};
use super::spec::Brief;

/// Room proportions stay below 1 : 2.5; the search aims a little lower.
pub(super) const MAX_PROPORTION: f64 = 2.4;
/// A notch in the outline shorter than this is a stagger without a reason, m.
const MIN_NOTCH_M: f64 = 1.5;
/// Width of the courtyard between two wings, m.
const COURTYARD_M: f64 = 7.0;

/// Rectangles of a plan on the lattice; a room may own several.
#[derive(Debug, Clone, Default)]
pub(super) struct Layout {
    pub boxes: Vec<(usize, Cellbox)>,
    /// How far sizes miss what is possible, m: 0 for a plan that can be built.
    pub misfit: f64,
    /// Total length of notches, m.
    pub notch: f64,
}

/// Least, wished and largest width of a cell for a band depth, lattice units.
#[derive(Debug, Clone, Copy)]
struct Span {
    min: i32,
    target: i32,
    max: i32,
}

/// Returns the length of wall a door needs between two room corners, lattice units.
pub(super) fn door_need(clear_m: f64) -> i32 {
    up(Brief::opening(clear_m) + 2.0 * JAMB_M + INNER_HALF_M + OUTER_HALF_M)
}

/// Returns the corridor's width between wall center lines, lattice units.
pub(super) fn spine_units(brief: &Brief) -> i32 {
    // wings and courtyards put outer walls on both sides
    let width = up(brief.spine_width + 2.0 * OUTER_HALF_M);
    // The entrance door stands in the corridor's end wall, between two corners with outer walls.
    let entered = brief.spine.is_some_and(|s| brief.rooms[s].entrance) || brief.second_exit;
    if entered { width.max(door_need(brief.entrance_width) + 1) } else { width }
}

/// A band waiting for its length: `len = var + offset`.
struct Row<'a> {
    cells: &'a [Cell],
    depth: i32,
    offset: i32,
    frame: Frame,
    spans: Vec<Span>,
}

impl<'a> Row<'a> {
    fn new(brief: &Brief, genome: &'a Genome, band: usize, offset: i32, misfit: &mut f64) -> Self {
        let band = &genome.bands[band];
        let spans = band.cells.iter().map(|c| span(brief, c, band.depth, misfit)).collect();
        let frame = Frame { origin: (0, 0), u: (1, 0), v: (0, 1) };
        Self { cells: &band.cells, depth: band.depth, offset, frame, spans }
    }

    fn at(mut self, origin: (i32, i32), u: (i32, i32), v: (i32, i32)) -> Self {
        self.frame = Frame { origin, u, v };
        self
    }

    fn sum(&self, f: impl Fn(&Span) -> i32) -> i32 {
        self.spans.iter().map(f).sum()
    }
}

/// Returns the rectangles of a genome.
pub(super) fn realize(brief: &Brief, genome: &Genome) -> Layout {
    let mut layout = Layout::default();
    let Some(spine) = brief.spine else { return layout };
    match genome.scheme {
        Scheme::Straight | Scheme::Capped => straight(brief, genome, spine, &mut layout),
        Scheme::Angle => angle(brief, genome, spine, &mut layout),
        Scheme::Racetrack => racetrack(brief, genome, spine, &mut layout),
        Scheme::Comb => comb(brief, genome, spine, &mut layout),
    }
    layout
}

fn straight(brief: &Brief, genome: &Genome, spine: usize, layout: &mut Layout) {
    let (dt, db) = (used_depth(genome, 0), used_depth(genome, 1));
    let mut w = spine_units(brief);
    let mut misfit = 0.0;
    let caps = genome.caps.map(|cap| cap.map(|c| (c, cap_box(brief, c, w, dt, db, &mut misfit))));
    let extra = |top: bool| -> [i32; 2] {
        caps.map(|cap| match cap {
            Some((Cap { cover: Cover::Both, .. }, _)) | None => 0,
            Some((c, width)) if c.under && (c.cover == Cover::Top) != top => width,
            Some(_) => 0,
        })
    };
    let (et, eb) = (extra(true), extra(false));
    let top = Row::new(brief, genome, 0, et[0] + et[1], &mut misfit);
    let bottom = Row::new(brief, genome, 1, eb[0] + eb[1], &mut misfit);
    let mut len = solve(&[&top, &bottom], &mut misfit);
    if brief.hub {
        (len, w) = hub_size(brief, spine, len, &mut misfit);
    }
    len = len.max(door_need(brief.entrance_width));
    layout.boxes.push((spine, Cellbox::new(0, 0, len, w)));
    fill(brief, &top.at((-et[0], w), (1, 0), (0, 1)), len + et[0] + et[1], layout);
    fill(brief, &bottom.at((-eb[0], 0), (1, 0), (0, -1)), len + eb[0] + eb[1], layout);
    for (side, cap) in caps.iter().enumerate() {
        let Some((cap, width)) = cap else { continue };
        let (y0, y1) =
            (if cap.cover == Cover::Top { 0 } else { -db }, if cap.cover == Cover::Bottom { w } else { w + dt });
        let (x0, x1) = if side == 0 { (-width, 0) } else { (len, len + width) };
        layout.boxes.push((cap.room, Cellbox::new(x0, y0, x1, y1)));
    }
    layout.misfit += misfit;
}

/// Returns length and width of a hub room that must be `len` long at least, from its area.
fn hub_size(brief: &Brief, spine: usize, len: i32, misfit: &mut f64) -> (i32, i32) {
    let spec = &brief.rooms[spine];
    let walls = INNER_HALF_M + OUTER_HALF_M;
    let natural = up((spec.area_target * 1.4).sqrt() + walls);
    let proportion = meters(len).powi(2) / spec.area_target;
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

fn angle(brief: &Brief, genome: &Genome, spine: usize, layout: &mut Layout) {
    let w = spine_units(brief);
    let (dt, dr) = (used_depth(genome, 0), used_depth(genome, 2));
    let mut misfit = 0.0;
    let beyond = if genome.corner { dr } else { 0 };
    let top = Row::new(brief, genome, 0, 0, &mut misfit);
    let bottom = Row::new(brief, genome, 1, w + beyond, &mut misfit);
    let right = Row::new(brief, genome, 2, 0, &mut misfit);
    let inner = Row::new(brief, genome, 3, -w - dt, &mut misfit);
    let x = solve(&[&top, &bottom], &mut misfit).max(w);
    let y = solve(&[&right, &inner], &mut misfit).max(w + dt + up(1.5));
    layout.boxes.push((spine, Cellbox::new(0, 0, x + w, w)));
    layout.boxes.push((spine, Cellbox::new(x, w, x + w, y)));
    fill(brief, &top.at((0, w), (1, 0), (0, 1)), x, layout);
    fill(brief, &bottom.at((0, 0), (1, 0), (0, -1)), x + w + beyond, layout);
    fill(brief, &right.at((x + w, 0), (0, 1), (1, 0)), y, layout);
    fill(brief, &inner.at((x, w + dt), (0, 1), (-1, 0)), y - w - dt, layout);
    layout.misfit += misfit;
}

fn racetrack(brief: &Brief, genome: &Genome, spine: usize, layout: &mut Layout) {
    let w = spine_units(brief);
    let core = used_depth(genome, 2) + used_depth(genome, 3);
    let mut misfit = if core == 0 { 10.0 } else { 0.0 };
    let top = Row::new(brief, genome, 0, 0, &mut misfit);
    let bottom = Row::new(brief, genome, 1, 0, &mut misfit);
    let lower = Row::new(brief, genome, 2, -w, &mut misfit);
    let upper = Row::new(brief, genome, 3, -w, &mut misfit);
    let len = solve(&[&top, &bottom, &lower, &upper], &mut misfit).max(3 * w);
    layout.boxes.push((spine, Cellbox::new(0, 0, len, w)));
    layout.boxes.push((spine, Cellbox::new(0, w, w, w + core)));
    layout.boxes.push((spine, Cellbox::new(0, w + core, len, 2 * w + core)));
    fill(brief, &top.at((0, 2 * w + core), (1, 0), (0, 1)), len, layout);
    fill(brief, &bottom.at((0, 0), (1, 0), (0, -1)), len, layout);
    fill(brief, &lower.at((w, w), (1, 0), (0, 1)), len - w, layout);
    fill(brief, &upper.at((w, w + core), (1, 0), (0, -1)), len - w, layout);
    // A core that ends short leaves a hole in the building rather than a notch in its outline.
    layout.misfit += misfit + layout.notch;
}

fn comb(brief: &Brief, genome: &Genome, spine: usize, layout: &mut Layout) {
    let w = spine_units(brief);
    let mut misfit = 0.0;
    // Where the spine goes on from, and where the last wing ends.
    let (mut from, mut ceiling) = (0, None);
    for wing in 0..genome.bands.len() / 2 {
        let (above, below) = (used_depth(genome, 2 * wing), used_depth(genome, 2 * wing + 1));
        let top = Row::new(brief, genome, 2 * wing, -w, &mut misfit);
        let bottom = Row::new(brief, genome, 2 * wing + 1, -w, &mut misfit);
        let len = solve(&[&top, &bottom], &mut misfit).max(2 * w);
        let base = ceiling.map_or(0, |c: i32| c + up(COURTYARD_M) + below);
        layout.boxes.push((spine, Cellbox::new(0, from, w, base + w)));
        layout.boxes.push((spine, Cellbox::new(w, base, len, base + w)));
        fill(brief, &top.at((w, base + w), (1, 0), (0, 1)), len - w, layout);
        fill(brief, &bottom.at((w, base), (1, 0), (0, -1)), len - w, layout);
        (from, ceiling) = (base + w, Some(base + w + above));
    }
    layout.misfit += misfit;
}

/// Returns the depth of a band, 0 when nothing stands in it.
fn used_depth(genome: &Genome, band: usize) -> i32 {
    if genome.bands[band].cells.is_empty() { 0 } else { genome.bands[band].depth }
}

/// Returns the width of a cap from its area and the bands it covers, lattice units.
fn cap_box(brief: &Brief, cap: Cap, w: i32, dt: i32, db: i32, misfit: &mut f64) -> i32 {
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
fn span(brief: &Brief, cell: &Cell, depth: i32, misfit: &mut f64) -> Span {
    let spec = &brief.rooms[cell.host];
    let clear_depth = meters(depth) - INNER_HALF_M - OUTER_HALF_M;
    let nests: i32 = cell.nests().map(|n| nest_width(brief, n, cell.nest_depth)).sum();
    let has_nests = nests > 0;
    let main_depth =
        if has_nests { meters(depth - cell.nest_depth) - INNER_HALF_M - OUTER_HALF_M } else { clear_depth };
    if main_depth < spec.min_dimension {
        *misfit += spec.min_dimension - main_depth;
    }
    let carved = meters(nests) * meters(cell.nest_depth);
    let width_for = |area: f64| (area + carved) / clear_depth.max(0.5) + 2.0 * INNER_HALF_M;
    let leg = if spec.on_spine { door_need(spec.door_width) } else { 0 };
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
    let used: Vec<&&Row<'_>> = rows.iter().filter(|r| !r.cells.is_empty()).collect();
    let Some(low) = used.iter().map(|r| r.sum(|s| s.min) - r.offset).max() else { return 0 };
    let high = used.iter().map(|r| r.sum(|s| s.max) - r.offset).min().unwrap_or(low);
    let wish: i32 = used.iter().map(|r| r.sum(|s| s.target) - r.offset).sum::<i32>() / used.len() as i32;
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

/// Lays the cells of a row along its frame.
fn fill(brief: &Brief, row: &Row<'_>, len: i32, layout: &mut Layout) {
    if row.cells.is_empty() {
        return;
    }
    let widths = shares(&row.spans, len);
    let total: i32 = widths.iter().sum();
    let gap = meters(len - total);
    if gap > 0.0 {
        layout.notch += gap;
        if gap < MIN_NOTCH_M {
            layout.misfit += gap.min(MIN_NOTCH_M - gap).max(0.05);
        }
    } else if gap < 0.0 {
        layout.misfit -= gap;
    }
    let mut at = 0;
    for (cell, &width) in row.cells.iter().zip(&widths) {
        fill_cell(brief, row, cell, at, width, layout);
        at += width;
    }
}

fn fill_cell(brief: &Brief, row: &Row<'_>, cell: &Cell, at: i32, width: i32, layout: &mut Layout) {
    let depth = row.depth;
    if cell.left.is_empty() && cell.right.is_empty() {
        layout.boxes.push((cell.host, row.frame.place(at, at + width, 0, depth)));
        return;
    }
    let d = cell.nest_depth.min(depth - 1);
    let mut widths: Vec<i32> = cell.nests().map(|n| nest_width(brief, n, d)).collect();
    if !brief.rooms[cell.host].on_spine {
        // Nobody walks past: the small rooms take the whole front.
        let spare = width - widths.iter().sum::<i32>();
        let count = widths.len() as i32;
        for (i, w) in widths.iter_mut().enumerate() {
            *w += spare / count + i32::from((i as i32) < spare % count);
        }
    }
    let left: i32 = widths[..cell.left.len()].iter().sum();
    let right: i32 = widths[cell.left.len()..].iter().sum();
    layout.boxes.push((cell.host, row.frame.place(at, at + width, d, depth)));
    if left + right < width {
        layout.boxes.push((cell.host, row.frame.place(at + left, at + width - right, 0, d)));
    } else if left + right > width {
        layout.misfit += meters(left + right - width);
    }
    let mut x = at;
    for (room, w) in cell.nests().zip(&widths) {
        if x == at + left {
            x = at + width - right;
        }
        layout.boxes.push((room, row.frame.place(x, x + w, 0, d)));
        x += w;
    }
}

/// Returns widths that add up to `len` where the spans allow it, each within its span, close to its target.
fn shares(spans: &[Span], len: i32) -> Vec<i32> {
    let mut widths: Vec<i32> = spans.iter().map(|s| s.target).collect();
    let mut rest = len - widths.iter().sum::<i32>();
    while rest != 0 {
        let sign = rest.signum();
        let room = |i: usize, w: i32| if sign > 0 { spans[i].max - w } else { w - spans[i].min };
        let open: Vec<usize> = (0..widths.len()).filter(|&i| room(i, widths[i]) > 0).collect();
        if open.is_empty() {
            break;
        }
        let each = (rest.abs() / open.len() as i32).max(1);
        for i in open {
            let step = each.min(room(i, widths[i])).min(rest.abs());
            widths[i] += sign * step;
            rest -= sign * step;
        }
    }
    widths
}
