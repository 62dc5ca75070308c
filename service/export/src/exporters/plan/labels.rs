//! Puts each room's name and area where nothing else is: clear of furniture always, of door swings, robot zones and rugs
//! where smaller type or another break of lines allows it, as near the middle of the room as may be.

use d3dgen_model::geometry::Rect;

use super::page::{Anchor, Page, Path, Type};
use super::style;
use crate::font::{Font, Weight};

/// Edge of a cell of the search grid, sheet units.
const CELL: f64 = 3.0;
/// Sizes tried, largest first, as shares of the usual one.
const SIZES: [f64; 5] = [1.0, 0.9, 0.8, 0.72, 0.64];
/// What smaller type costs, by the share of the size that is lost.
const SMALLER: f64 = 4.0;
/// What a name on several lines, one that runs upwards and one without its area cost.
const BROKEN: f64 = 0.12;
const UPRIGHT: f64 = 0.5;
const NAME_ONLY: f64 = 2.0;
/// What a number in a line by itself costs.
const TORN: f64 = 0.4;
/// What it costs to be as far from the middle of a room as its diagonal is long.
const ASIDE: f64 = 0.8;
/// Sizes of the ring around a number, as shares of the type size.
const RINGS: [f64; 3] = [0.72, 0.62, 0.54];
/// Leading, as a share of the type size.
const LEADING: f64 = 1.16;

/// A room to be labeled.
pub(super) struct Room<'a> {
    pub name: &'a str,
    pub area_m2: f64,
    /// Color of the floor: the soft edge of the type.
    pub tint: &'static str,
    /// Rectangles that make up its floor, sheet units.
    pub floor: Vec<Rect>,
}

/// Things labels keep away from.
pub(super) struct Obstacles {
    /// Never written over.
    pub hard: Vec<Rect>,
    /// Written over when nothing else is left, with how much that hurts where all of a label lies on it.
    pub soft: Vec<(Rect, u32)>,
}

/// Where labels stand on the sheet.
pub(super) struct Labels {
    /// Each room's number where it had no space for more.
    pub numbers: Vec<Option<usize>>,
    /// What each room's label takes.
    pub boxes: Vec<Rect>,
}

#[derive(Clone)]
struct Line {
    text: String,
    size: f64,
    style: Type,
}

/// Lines that belong together, and the box they need.
struct Layout {
    lines: Vec<Line>,
    width: f64,
    height: f64,
    upright: bool,
    /// What it costs beside the full size on one line.
    cost: f64,
}

/// Draws all labels.
pub(super) fn draw(page: &mut Page, rooms: &[Room<'_>], obstacles: &Obstacles, size: f64) -> Labels {
    page.open_group("labels");
    let mut out = Labels { numbers: Vec::new(), boxes: Vec::new() };
    let mut last = 0;
    let around = |(x, y): (f64, f64), w: f64, h: f64| Rect::new(x - w / 2.0, y - h / 2.0, x + w / 2.0, y + h / 2.0);
    for room in rooms {
        let area = format!("{:.1} m²", room.area_m2);
        let grid = Grid::new(room, obstacles);
        let mut layouts: Vec<Layout> =
            SIZES.iter().flat_map(|share| layouts(page, room, &area, (size, *share))).collect();
        layouts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let mut best: Option<(f64, &Layout, (f64, f64))> = None;
        for layout in &layouts {
            // the rest costs more wherever it goes
            if best.is_some_and(|(cost, ..)| cost <= layout.cost) {
                break;
            }
            if let Some((at, cost)) = grid.place(layout, 0.3 * size)
                && best.is_none_or(|(least, ..)| cost + layout.cost < least)
            {
                best = Some((cost + layout.cost, layout, at));
            }
        }
        if let Some((_, layout, at)) = best {
            write(page, layout, at);
            out.boxes.push(around(at, layout.width, layout.height));
            out.numbers.push(None);
        } else {
            last += 1;
            let rings = RINGS.map(|share| share * size);
            let free = rings.into_iter().find_map(|r| Some((grid.free(2.0 * r)?, r)));
            let (at, r) = free.unwrap_or_else(|| (grid.freest(2.0 * rings[2]), rings[2]));
            badge(page, at, last, r);
            out.boxes.push(around(at, 2.0 * r, 2.0 * r));
            out.numbers.push(Some(last));
        }
    }
    page.close_group();
    out
}

/// A ring with a room's number.
pub(super) fn badge(page: &mut Page, (x, y): (f64, f64), number: usize, r: f64) {
    page.path("kn", Path::new().circle((x, y), r));
    let size = if number < 10 { 1.3 * r } else { 1.05 * r };
    let style = Type { halo: None, ..style::NAME };
    page.text(&number.to_string(), (x, y + 0.36 * size), size, style, Anchor::Middle);
}

/// Returns the ways to set a label at a share of the usual size.
fn layouts(page: &Page, room: &Room<'_>, area: &str, (usual, share): (f64, f64)) -> Vec<Layout> {
    let size = usual * share;
    let line = |text: &str, size: f64, style: Type| {
        let style = Type { halo: Some(room.tint), ..style };
        Line { text: text.to_owned(), size, style }
    };
    let names = |names: &[&str]| -> Vec<Line> { names.iter().map(|n| line(n, size, style::NAME)).collect() };
    let smaller = SMALLER * (1.0 - share);
    let words: Vec<&str> = room.name.split(' ').collect();
    let split = halves(&words, page.font(Weight::SemiBold));
    let mut ways = vec![(names(&[room.name]), 0.0)];
    ways.extend(split.as_ref().map(|(first, second)| {
        let torn = second.parse::<u32>().is_ok();
        (names(&[first, second]), if torn { TORN } else { BROKEN })
    }));
    if words.len() == 3 {
        ways.push((names(&words), 5.0 * BROKEN));
    }
    let mut layouts = Vec::new();
    for (lines, cost) in ways {
        let mut whole = lines.clone();
        whole.push(line(area, 0.84 * size, style::AREA));
        layouts.push(measure(page, whole, false, smaller + cost));
        layouts.push(measure(page, lines, false, smaller + cost + NAME_ONLY));
    }
    // Long thin rooms read better along their length.
    let bounds = room.floor.iter().copied().reduce(|a, b| a.union(&b)).unwrap_or(Rect::new(0.0, 0.0, 1.0, 1.0));
    if bounds.height() > 1.8 * bounds.width() {
        let lines = vec![line(room.name, size, style::NAME), line(area, 0.84 * size, style::AREA)];
        layouts.push(measure(page, lines, true, smaller + UPRIGHT));
    }
    layouts
}

/// Splits words into two lines of the least width.
fn halves(words: &[&str], font: &Font) -> Option<(String, String)> {
    (1..words.len())
        .map(|i| (words[..i].join(" "), words[i..].join(" ")))
        .map(|(a, b)| (font.width(&a, 10.0).max(font.width(&b, 10.0)), a, b))
        .min_by(|x, y| x.0.total_cmp(&y.0))
        .map(|(_, a, b)| (a, b))
}

fn measure(page: &Page, lines: Vec<Line>, upright: bool, cost: f64) -> Layout {
    let width = lines.iter().map(|l| page.font(l.style.weight).width(&l.text, l.size)).fold(0.0, f64::max);
    let height = lines.iter().map(|l| l.size * LEADING).sum::<f64>();
    let (width, height) = if upright { (height, width) } else { (width, height) };
    Layout { lines, width, height, upright, cost }
}

/// Writes a layout around its middle.
fn write(page: &mut Page, layout: &Layout, (x, y): (f64, f64)) {
    let set = |page: &mut Page| {
        let total = layout.lines.iter().map(|l| l.size * LEADING).sum::<f64>();
        let mut top = y - total / 2.0;
        for line in &layout.lines {
            // The baseline sits where capitals look centered in their line.
            page.text(&line.text, (x, top + line.size * 0.92), line.size, line.style, Anchor::Middle);
            top += line.size * LEADING;
        }
    };
    if layout.upright { page.upright((x, y), set) } else { set(page) }
}

/// Free and taken cells of one room, as sums over all cells above and left.
struct Grid {
    x0: f64,
    y0: f64,
    columns: usize,
    rows: usize,
    hard: Vec<u32>,
    soft: Vec<u32>,
    center: (f64, f64),
    diagonal: f64,
}

impl Grid {
    fn new(room: &Room<'_>, obstacles: &Obstacles) -> Self {
        let bounds = room.floor.iter().copied().reduce(|a, b| a.union(&b)).unwrap_or(Rect::new(0.0, 0.0, 1.0, 1.0));
        let (columns, rows) = ((bounds.width() / CELL) as usize + 1, (bounds.height() / CELL) as usize + 1);
        let diagonal = bounds.width().hypot(bounds.height()).max(CELL);
        let mut grid = Self {
            x0: bounds.x0,
            y0: bounds.y0,
            columns,
            rows,
            hard: vec![],
            soft: vec![],
            center: (0.0, 0.0),
            diagonal,
        };
        let mut hard = vec![1; columns * rows];
        let mut soft = vec![0; columns * rows];
        room.floor.iter().for_each(|r| grid.paint(&mut hard, r, 0));
        obstacles.hard.iter().for_each(|r| grid.paint(&mut hard, &r.grown(2.0), 1));
        // what hurts most is painted last
        let mut hurts: Vec<&(Rect, u32)> = obstacles.soft.iter().collect();
        hurts.sort_by_key(|(_, weight)| *weight);
        hurts.into_iter().for_each(|(r, weight)| grid.paint(&mut soft, r, *weight));
        let total: f64 = room.floor.iter().map(Rect::area).sum();
        let mean = |of: fn(&Rect) -> f64| room.floor.iter().map(|r| of(r) * r.area()).sum::<f64>() / total.max(1e-9);
        grid.center = (mean(|r| r.center().x), mean(|r| r.center().y));
        grid.hard = grid.sums(&hard);
        grid.soft = grid.sums(&soft);
        grid
    }

    /// Sets every cell that a rectangle touches, or for `0` covers, to a value.
    fn paint(&self, cells: &mut [u32], r: &Rect, value: u32) {
        let e = if value == 0 { 0.5 } else { 0.0 };
        let span = |from: f64, to: f64, start: f64, count: usize| {
            let a = ((from - start) / CELL + e - 1e-6).floor().clamp(0.0, count as f64) as usize;
            let b = ((to - start) / CELL - e + 1e-6).ceil().clamp(0.0, count as f64) as usize;
            a..b.max(a)
        };
        let columns = span(r.x0, r.x1, self.x0, self.columns);
        for row in span(r.y0, r.y1, self.y0, self.rows) {
            cells[row * self.columns + columns.start..row * self.columns + columns.end].fill(value);
        }
    }

    fn sums(&self, cells: &[u32]) -> Vec<u32> {
        let stride = self.columns + 1;
        let mut sums = vec![0; stride * (self.rows + 1)];
        for row in 0..self.rows {
            let mut line = 0;
            for column in 0..self.columns {
                line += cells[row * self.columns + column];
                sums[(row + 1) * stride + column + 1] = sums[row * stride + column + 1] + line;
            }
        }
        sums
    }

    fn count(&self, sums: &[u32], (c0, r0): (usize, usize), (w, h): (usize, usize)) -> u32 {
        let stride = self.columns + 1;
        sums[(r0 + h) * stride + c0 + w] + sums[r0 * stride + c0]
            - sums[r0 * stride + c0 + w]
            - sums[(r0 + h) * stride + c0]
    }

    /// Returns the middle of the best free place for a label and what it costs, or `None` when it fits nowhere.
    fn place(&self, layout: &Layout, margin: f64) -> Option<((f64, f64), f64)> {
        let cells = |extent: f64| ((extent + margin) / CELL).ceil() as usize;
        self.best((cells(layout.width), cells(layout.height)), 0)
    }

    /// Returns the middle of the best place where a square covers nothing.
    fn free(&self, side: f64) -> Option<(f64, f64)> {
        let cells = (side / CELL).ceil() as usize;
        self.best((cells, cells), 0).map(|(at, _)| at)
    }

    /// Returns the middle of the place where a square covers least.
    fn freest(&self, side: f64) -> (f64, f64) {
        let cells = ((side / CELL).ceil() as usize).min(self.columns).min(self.rows).max(1);
        self.best((cells, cells), u32::MAX).map_or(self.center, |(at, _)| at)
    }

    /// Returns the best place for a box of cells over at most `allowed` cells that are taken, and what it costs.
    fn best(&self, (w, h): (usize, usize), allowed: u32) -> Option<((f64, f64), f64)> {
        if w > self.columns || h > self.rows {
            return None;
        }
        let cells = (w * h).max(1) as f64;
        let mut best: Option<((f64, f64), f64)> = None;
        for row in 0..=self.rows - h {
            for column in 0..=self.columns - w {
                let hard = self.count(&self.hard, (column, row), (w, h));
                if hard > allowed {
                    continue;
                }
                let soft = self.count(&self.soft, (column, row), (w, h));
                let x = self.x0 + (column as f64 + w as f64 / 2.0) * CELL;
                let y = self.y0 + (row as f64 + h as f64 / 2.0) * CELL;
                let far = ASIDE * (x - self.center.0).hypot(y - self.center.1) / self.diagonal;
                let cost = (f64::from(hard) * 1e4 + f64::from(soft)) / cells + far;
                if best.is_none_or(|(_, least)| cost < least) {
                    best = Some(((x, y), cost));
                }
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn room(floor: Vec<Rect>) -> Room<'static> {
        Room { name: "Storage room", area_m2: 3.2, tint: "#fff", floor }
    }

    #[test]
    fn labels_avoid_furniture_and_stay_inside() {
        let room = room(vec![Rect::new(0.0, 0.0, 200.0, 100.0)]);
        let obstacles = Obstacles { hard: vec![Rect::new(60.0, 0.0, 200.0, 100.0)], soft: vec![] };
        let grid = Grid::new(&room, &obstacles);
        let layout = |width, height| Layout { lines: vec![], width, height, upright: false, cost: 0.0 };
        let ((x, y), _) = grid.place(&layout(40.0, 20.0), 2.0).unwrap();
        assert!((20.0..40.0).contains(&x) && (40.0..60.0).contains(&y), "({x}, {y})");
        assert!(grid.place(&layout(70.0, 20.0), 2.0).is_none());
    }

    #[test]
    fn a_room_too_small_for_its_name_gets_a_number() {
        let mut page = Page::new();
        let rooms = [room(vec![Rect::new(0.0, 0.0, 300.0, 200.0)]), room(vec![Rect::new(0.0, 0.0, 30.0, 20.0)])];
        let labels = draw(&mut page, &rooms, &Obstacles { hard: vec![], soft: vec![] }, 16.0);
        assert_eq!(labels.numbers, [None, Some(1)]);
        assert!(labels.boxes[0].width() > 40.0 && labels.boxes[1].width() < 30.0);
    }

    #[test]
    fn labels_shrink_or_break_before_they_cross_a_swing() {
        let mut page = Page::new();
        let floor = Rect::new(0.0, 0.0, 200.0, 120.0);
        let leaf = Rect::new(70.0, 0.0, 200.0, 120.0);
        let obstacles = Obstacles { hard: vec![], soft: vec![(leaf, 8)] };
        let labels = draw(&mut page, &[room(vec![floor])], &obstacles, 16.0);
        assert_eq!(labels.numbers, [None]);
        assert!(!labels.boxes[0].overlaps(&leaf), "{:?}", labels.boxes[0]);
        // with no other place it is written across
        let all = Obstacles { hard: vec![], soft: vec![(floor, 8)] };
        assert_eq!(draw(&mut page, &[room(vec![floor])], &all, 16.0).numbers, [None]);
    }
}
