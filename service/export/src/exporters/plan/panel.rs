//! Title block, facts, legend, scale bar and north arrow, beside the drawing or below it.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Domain, Zone};
use d3dgen_model::floorplan::DoorKind;
use d3dgen_model::geometry::Rect;
use d3dgen_model::scenario::{Poi, RoiKind};
use d3dgen_model::world::World;

use super::labels;
use super::page::{Anchor, Block, Page, Path};
use super::ways::{self, Named};
use super::{EDGE, GAP, robots, style};
use crate::font::Weight;

/// Width of a column of the title block, sheet units.
pub(super) const WIDTH: f64 = 372.0;
/// Type size of facts and legend.
const SIZE: f64 = 15.5;
/// Distance between two baselines.
const ROW: f64 = 24.0;
/// Most rooms that are listed one by one.
const MOST_LISTED: usize = 40;
/// Distance between two blocks.
const BLOCK_GAP: f64 = 34.0;

/// What the title block speaks about.
pub(super) struct Facts<'a> {
    pub world: &'a World,
    pub domain: &'a Domain,
    /// For each room of the plan: its number, where the drawing has no space for its name.
    pub numbers: &'a [Option<usize>],
    /// Outer faces of the building, m.
    pub around: &'a Rect,
    /// Sheet units per meter.
    pub scale: f64,
    /// Factor of line weights.
    pub k: f64,
}

/// A print size with a round scale.
pub(super) struct Paper {
    pub width_mm: f64,
    pub height_mm: f64,
    /// `1:100`.
    pub ratio: u32,
    /// `A3`, where the sheet fits one.
    pub name: Option<&'static str>,
}

/// Returns the largest round scale at which the sheet fits a common paper.
pub(super) fn paper(width: f64, height: f64, scale: f64) -> Paper {
    const PAPERS: [(&str, f64, f64); 2] = [("A4", 297.0, 210.0), ("A3", 420.0, 297.0)];
    let at = |ratio: u32| {
        let mm = 1000.0 / (scale * f64::from(ratio));
        (width * mm, height * mm)
    };
    for ratio in [50, 100, 200, 500, 1000] {
        let (w, h) = at(ratio);
        let fits = |paper: &&(&'static str, f64, f64)| w.max(h) <= paper.1 && w.min(h) <= paper.2;
        if let Some(paper) = PAPERS.iter().find(fits) {
            return Paper { width_mm: w, height_mm: h, ratio, name: Some(paper.0) };
        }
    }
    let (width_mm, height_mm) = at(2000);
    Paper { width_mm, height_mm, ratio: 2000, name: None }
}

/// Returns the plan's title: what the domain calls this kind of building.
pub(super) fn title(world: &World, domain: &Domain) -> String {
    let id = world.scene_graph.building_type.as_deref();
    let kind = id.and_then(|id| domain.building_type(id));
    let program = kind.and_then(|b| domain.program(&b.program));
    program.map_or_else(|| domain.title.clone(), |p| p.title.clone())
}

impl Facts<'_> {
    /// Draws the panel right of (`beside`) or below the drawing; returns the size of the sheet.
    pub fn draw(&self, page: &mut Page, drawing: &Rect, beside: bool) -> (f64, f64) {
        let mut blocks = vec![self.heading(page), self.figures(page)];
        blocks.extend(self.schedule(page));
        blocks.push(self.legend(page));
        if beside { self.draw_beside(page, drawing, &blocks) } else { self.draw_below(page, drawing, &blocks) }
    }

    fn draw_beside(&self, page: &mut Page, drawing: &Rect, blocks: &[Block]) -> (f64, f64) {
        let total: f64 = blocks.iter().map(|b| b.height + BLOCK_GAP).sum();
        let paper_width = drawing.x1 + 2.0 * GAP + WIDTH + EDGE;
        let height = (drawing.y1 + EDGE).max(2.0 * EDGE + GAP + total + 96.0);
        let x = drawing.x1 + GAP;
        page.path("fr", Path::new().segment((drawing.x1, EDGE), (drawing.x1, height - EDGE)));
        let mut y = EDGE + GAP * 0.8;
        for block in blocks {
            page.place(block, (x, y));
            y += block.height + BLOCK_GAP;
        }
        let foot = self.foot(page, paper_width, height);
        page.place(&foot, (x, height - EDGE - foot.height - 0.6 * GAP));
        (paper_width, height)
    }

    fn draw_below(&self, page: &mut Page, drawing: &Rect, blocks: &[Block]) -> (f64, f64) {
        let width = (drawing.x1 + EDGE).max(2.0 * EDGE + 4.0 * (WIDTH + GAP) + GAP);
        let count = ((width - 2.0 * EDGE - GAP) / (WIDTH + GAP)).floor().max(2.0) as usize;
        let step = (width - 2.0 * EDGE - GAP) / count as f64;
        let foot = self.foot(page, width, drawing.y1 + 400.0);
        // The legend stands over the scale in the last column; the others fill the columns before it, shortest first.
        let mut columns = vec![0.0_f64; count];
        let mut places = Vec::new();
        for (i, block) in blocks.iter().enumerate() {
            let column = if i + 1 == blocks.len() {
                count - 1
            } else {
                (0..count - 1).min_by(|a, b| columns[*a].total_cmp(&columns[*b])).unwrap_or(0)
            };
            places.push((column, columns[column]));
            columns[column] += block.height + BLOCK_GAP;
        }
        columns[count - 1] += foot.height;
        let strip = columns.iter().copied().fold(0.0, f64::max);
        let height = drawing.y1 + GAP * 0.8 + strip + 0.6 * GAP + EDGE;
        page.path("fr", Path::new().segment((EDGE, drawing.y1), (width - EDGE, drawing.y1)));
        for (block, (column, down)) in blocks.iter().zip(places) {
            page.place(block, (EDGE + GAP + column as f64 * step, drawing.y1 + GAP * 0.8 + down));
        }
        let foot = self.foot(page, width, height);
        let x = EDGE + GAP + (count - 1) as f64 * step;
        page.place(&foot, (x, height - EDGE - foot.height - 0.6 * GAP));
        (width, height)
    }

    /// Domain, kind of building and the prompt.
    fn heading(&self, page: &mut Page) -> Block {
        let (world, domain) = (self.world, self.domain);
        page.block(|page| {
            let mut y = 0.0;
            if world.scene_graph.building_type.is_some() && title(world, domain) != domain.title {
                y += 13.0;
                page.text(&domain.title.to_uppercase(), (0.0, y), 13.0, style::SMALL, Anchor::Start);
                y += 8.0;
            }
            for line in wrap(page, &title(world, domain), 33.0, Weight::SemiBold, 3) {
                y += 33.0;
                page.text(&line, (0.0, y), 33.0, style::HEADING, Anchor::Start);
            }
            y += 10.0;
            let prompt = world.scene_graph.prompt.trim();
            if !prompt.is_empty() {
                for line in wrap(page, &format!("“{prompt}”"), 16.5, Weight::Regular, 6) {
                    y += 22.0;
                    page.text(&line, (0.0, y), 16.5, style::SMALL, Anchor::Start);
                }
            }
            y
        })
    }

    /// The table of facts.
    fn figures(&self, page: &mut Page) -> Block {
        let world = self.world;
        let rooms = world.floorplan.rooms.iter().filter(|r| !r.circulation).count();
        let circulation = world.floorplan.rooms.len() - rooms;
        let area = |outdoor: bool| -> f64 {
            let rooms = world.floorplan.rooms.iter().filter(|r| self.outdoor(&r.room_type) == outdoor);
            rooms.map(|r| r.net_area_m2).sum()
        };
        let (inside, outside) = (area(false), area(true));
        let beside = if outside > 0.0 { format!(" + {outside:.1} m² outdoors") } else { String::new() };
        let doors = world.floorplan.doors.iter().filter(|d| d.kind != DoorKind::Open).count();
        let plus = if circulation > 0 { format!(" + {circulation} circulation") } else { String::new() };
        let mut rows = vec![
            ("Rooms", format!("{rooms}{plus}")),
            ("Net floor area", format!("{inside:.1} m²{beside}")),
            ("Outer size", format!("{:.2} × {:.2} m", self.around.width(), self.around.height())),
            ("Doors, windows", format!("{doors}, {}", world.floorplan.windows.len())),
            ("Objects", world.placements.placements.len().to_string()),
        ];
        let robots: Vec<String> = world
            .scene_graph
            .robots
            .iter()
            .map(|r| format!("{} {} (Ø {:.2} m)", r.count, r.kind.replace('_', " "), 2.0 * r.radius_m))
            .collect();
        if !robots.is_empty() {
            rows.push(("Robots", robots.join(", ")));
        }
        let country = world.scene_graph.place_code();
        match (&world.rules, country) {
            (Some(rules), _) => rows.push(("Building rules", rules.line(country))),
            // it was never held against them
            (None, Some(code)) => rows.push(("Country", code.to_owned())),
            (None, None) => {}
        }
        rows.push(("Seed", world.scene_graph.seed.to_string()));
        rows.push(("Made by", world.generator.clone()));
        page.block(|page| {
            let mut y = 0.0;
            for (name, value) in &rows {
                page.path("fr", Path::new().segment((0.0, y), (WIDTH, y)));
                let lines = wrap_to(page, value, SIZE, Weight::Regular, 2, WIDTH - 130.0);
                page.text(name, (0.0, y + 17.0), SIZE, style::SMALL, Anchor::Start);
                for (i, line) in lines.iter().enumerate() {
                    y += if i == 0 { 0.0 } else { ROW - 4.0 };
                    page.text(line, (130.0, y + 17.0), SIZE, style::TEXT, Anchor::Start);
                }
                y += ROW;
            }
            page.path("fr", Path::new().segment((0.0, y), (WIDTH, y)));
            y
        })
    }

    fn outdoor(&self, room_type: &str) -> bool {
        self.domain.room_type_or_generic(room_type).zone == Zone::Outdoor
    }

    /// The list of rooms with their net areas, or only those that are numbers in the drawing when there are many.
    fn schedule(&self, page: &mut Page) -> Option<Block> {
        let named = ways::named(&self.world.floorplan);
        let mut all: Vec<(Option<usize>, &Named<'_>)> =
            named.iter().map(|named| (self.numbers.get(named.pieces[0]).copied().flatten(), named)).collect();
        all.sort_by_key(|(_, room)| by_name(&room.name));
        let numbered: Vec<_> = all.iter().filter(|(n, _)| n.is_some()).copied().collect();
        let rows = if all.len() <= MOST_LISTED { all } else { numbered };
        if rows.is_empty() {
            return None;
        }
        let columns = if rows.len() > 9 { 2 } else { 1 };
        let per_column = rows.len().div_ceil(columns);
        let width = (WIDTH - 22.0 * (columns as f64 - 1.0)) / columns as f64;
        let size = if columns > 1 { 13.5 } else { SIZE };
        let row = if columns > 1 { ROW - 2.0 } else { ROW };
        Some(page.block(|page| {
            let top = heading(page, "Rooms, net floor area");
            for (i, (number, room)) in rows.iter().enumerate() {
                let (x, y) = ((i / per_column) as f64 * (width + 22.0), top + (i % per_column) as f64 * row);
                let mut left = x;
                if let Some(number) = number {
                    labels::badge(page, (x + 9.0, y + 11.5), *number, 9.0);
                    left += 25.0;
                }
                let area = format!("{:.1} m²", room.area_m2());
                let taken = page.text(&area, (x + width, y + 16.5), size, style::SMALL, Anchor::End);
                let space = x + width - left - taken - 8.0;
                // A long name may be set a little tighter before it is cut.
                let long = page.font(Weight::Regular).width(&room.name, size) > space;
                let size = if long { 0.88 * size } else { size };
                let name = with_number(page, &room.name, size, space);
                page.text(&name, (left, y + 16.5), size, style::TEXT, Anchor::Start);
            }
            top + per_column as f64 * row
        }))
    }

    /// Tints with the rooms that have them, each a line; robot zones and marks that occur, in two columns.
    fn legend(&self, page: &mut Page) -> Block {
        let world = self.world;
        let robots = !world.scenario.robots.is_empty();
        let rois: BTreeSet<RoiKind> = world.scenario.rois.iter().filter(|_| robots).map(|r| r.kind).collect();
        let goals = world.scenario.robots.iter().any(|r| !r.goals.is_empty());
        let docks = world.scenario.pois.iter().any(|p| p.kind == Poi::DOCK);
        let tints = self.tints();
        let mut rows: Vec<(&str, Swatch)> = rois.into_iter().map(|r| (style::roi_label(r), Swatch::Roi(r))).collect();
        if world.floorplan.doors.iter().any(|d| d.automatic) {
            rows.push(("Opens by itself", Swatch::Automatic));
        }
        if docks {
            rows.push(("Charging dock", Swatch::Dock));
        }
        if robots {
            rows.push(("Robot at its start", Swatch::Start));
        }
        if goals {
            rows.push(("Stops in order", Swatch::Goal));
        }
        page.block(|page| {
            let mut y = heading(page, "Legend");
            for (zone, kinds) in &tints {
                Swatch::Zone(*zone).draw(page, (0.0, y + 3.0), self.k);
                let text = page_list(page, kinds, SIZE - 1.0, WIDTH - 38.0);
                page.text(&text, (38.0, y + 16.5), SIZE - 1.0, style::TEXT, Anchor::Start);
                y += ROW + 3.0;
            }
            let half = rows.len().div_ceil(2);
            for (i, (text, swatch)) in rows.iter().enumerate() {
                let (column, row) = (i / half, i % half);
                let (x, y) = (column as f64 * (WIDTH * 0.54), y + row as f64 * (ROW + 3.0));
                swatch.draw(page, (x, y + 3.0), self.k);
                page.text(text, (x + 38.0, y + 16.5), SIZE - 1.0, style::TEXT, Anchor::Start);
            }
            y + half as f64 * (ROW + 3.0)
        })
    }

    /// Returns the parts of the building that occur, each with what the domain calls its rooms, the largest first.
    fn tints<'s>(&'s self) -> BTreeMap<Zone, Vec<&'s str>> {
        let mut areas: BTreeMap<Zone, BTreeMap<&'s str, f64>> = BTreeMap::new();
        for room in &self.world.floorplan.rooms {
            let kind = self.domain.room_type_or_generic(&room.room_type);
            *areas.entry(kind.zone).or_default().entry(&kind.label).or_default() += room.net_area_m2;
        }
        if !super::building::courts(&self.world.floorplan).is_empty() {
            areas.entry(Zone::Outdoor).or_default().entry("Courtyard").or_default();
        }
        let by_area = |(zone, kinds): (Zone, BTreeMap<&'s str, f64>)| {
            let mut kinds: Vec<(&'s str, f64)> = kinds.into_iter().collect();
            kinds.sort_by(|a, b| b.1.total_cmp(&a.1));
            (zone, kinds.into_iter().map(|k| k.0).collect())
        };
        areas.into_iter().map(by_area).collect()
    }

    /// Scale bar, scale and north arrow.
    fn foot(&self, page: &mut Page, width: f64, height: f64) -> Block {
        let paper = paper(width, height, self.scale);
        page.block(|page| {
            let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|m| m * self.scale >= 48.0).unwrap_or(20.0);
            let bar = step * self.scale;
            let pieces = ((WIDTH - 110.0) / bar).floor().clamp(1.0, 4.0) as usize;
            for i in 0..pieces {
                let x = i as f64 * bar;
                let r = Rect { x0: x, y0: 30.0, x1: x + bar, y1: 37.0 };
                page.path(if i % 2 == 0 { "sb" } else { "sw" }, Path::new().rect(&r));
            }
            for i in 0..=pieces {
                let meters = step * i as f64;
                let unit = if i == pieces { " m" } else { "" };
                page.text(&format!("{meters:.0}{unit}"), (i as f64 * bar, 23.0), 13.5, style::SMALL, Anchor::Middle);
            }
            let on = paper.name.map_or(String::new(), |n| format!(" on {n}"));
            page.text(&format!("1:{}{on}", paper.ratio), (0.0, 58.0), 13.5, style::SMALL, Anchor::Start);
            north(page, (WIDTH - 26.0, 34.0), 24.0);
            62.0
        })
    }
}

/// Returns a key that puts `Patient room 10` after `Patient room 9`.
fn by_name(name: &str) -> (String, u32) {
    let word = name.trim_end_matches(|c: char| c.is_ascii_digit());
    (word.to_lowercase(), name[word.len()..].parse().unwrap_or(0))
}

/// A needle in a ring with its N.
fn north(page: &mut Page, (x, y): (f64, f64), r: f64) {
    page.path("nr", Path::new().circle((x, y), r));
    page.path("ea", Path::new().polygon(&[(x, y - 0.8 * r), (x + 0.34 * r, y + 0.62 * r), (x, y + 0.36 * r)]));
    page.path("ex", Path::new().polygon(&[(x, y - 0.8 * r), (x - 0.34 * r, y + 0.62 * r), (x, y + 0.36 * r)]));
    page.text("N", (x, y - r - 6.0), 15.0, style::HEADING, Anchor::Middle);
}

/// What stands before a legend's words.
enum Swatch {
    Zone(Zone),
    Roi(RoiKind),
    Automatic,
    Dock,
    Start,
    Goal,
}

impl Swatch {
    fn draw(&self, page: &mut Page, (x, y): (f64, f64), k: f64) {
        let r = Rect { x0: x, y0: y, x1: x + 28.0, y1: y + 17.0 };
        let middle = (x + 14.0, y + 8.5);
        match self {
            Self::Zone(zone) => {
                let fill = format!("fill=\"{}\" stroke=\"{}\" stroke-width=\"0.8\"", style::tint(*zone), style::RULE);
                page.path_with(&fill, Path::new().rect(&r));
            }
            Self::Roi(kind) => {
                robots::area(page, *kind, Path::new().rect(&r), &[r], 0.5 * k.max(0.9), 0.9);
                if matches!(kind, RoiKind::CleaningZone | RoiKind::KeepOut) {
                    page.path("fr", Path::new().rect(&r));
                }
            }
            Self::Automatic => {
                let leaf = Rect { y0: middle.1 - 2.0, y1: middle.1 + 2.0, ..r };
                page.path("dx", Path::new().rect(&leaf));
            }
            Self::Dock => robots::dock(page, middle, 9.5),
            Self::Start => robots::robot(page, middle, (1.0, 0.0), 9.5),
            Self::Goal => robots::goal(page, middle, "1", 9.0),
        }
    }
}

/// A block's heading; returns where its rows begin.
fn heading(page: &mut Page, text: &str) -> f64 {
    page.text(&text.to_uppercase(), (0.0, 12.0), 13.0, style::SMALL, Anchor::Start);
    22.0
}

/// Returns as many names as a width holds, with commas between, the first with a capital; what is left out is an ellipsis.
fn page_list(page: &Page, names: &[&str], size: f64, width: f64) -> String {
    let font = page.font(Weight::Regular);
    let joined = |n: usize| {
        let list = names[..n].iter().enumerate().map(|(i, name)| {
            // abbreviations keep their capitals
            let plain = i > 0 && !name.chars().nth(1).is_some_and(char::is_uppercase);
            if plain { lowered(name) } else { (*name).to_owned() }
        });
        let more = if n < names.len() { ", …" } else { "" };
        list.collect::<Vec<_>>().join(", ") + more
    };
    let fits = (1..=names.len()).rev().find(|n| font.width(&joined(*n), size) <= width);
    fits.map_or_else(|| wrap_to(page, names.first().unwrap_or(&""), size, Weight::Regular, 1, width).concat(), joined)
}

/// Returns a name as it stands within a line.
fn lowered(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

fn wrap(page: &Page, text: &str, size: f64, weight: Weight, limit: usize) -> Vec<String> {
    wrap_to(page, text, size, weight, limit, WIDTH)
}

/// Returns the name of a room cut to a width; the number that tells it from others stays.
fn with_number(page: &Page, name: &str, size: f64, width: f64) -> String {
    let numbered = name.rsplit_once(' ').filter(|(_, n)| n.bytes().all(|b| b.is_ascii_digit()));
    let (stem, number) = numbered.map_or((name, String::new()), |(stem, n)| (stem, format!(" {n}")));
    let space = width - page.font(Weight::Regular).width(&number, size);
    let stem = wrap_to(page, stem, size, Weight::Regular, 1, space).into_iter().next().unwrap_or_default();
    format!("{stem}{number}")
}

/// Breaks a text into at most `limit` lines of a width; what does not fit ends in an ellipsis.
fn wrap_to(page: &Page, text: &str, size: f64, weight: Weight, limit: usize, width: f64) -> Vec<String> {
    let font = page.font(weight);
    let mut lines: Vec<String> = vec![String::new()];
    for (spaced, piece) in pieces(text) {
        let last = lines.last_mut().expect("there is always one line");
        let space = if spaced && !last.is_empty() { " " } else { "" };
        let longer = format!("{last}{space}{piece}");
        if last.is_empty() || font.width(&longer, size) <= width {
            *last = longer;
        } else {
            lines.push(piece);
        }
    }
    let cut = lines.len() > limit;
    lines.truncate(limit);
    for (i, line) in lines.iter_mut().enumerate() {
        let ellipsis = if cut && i + 1 == limit { "…" } else { "" };
        // One long word, or the last line with its ellipsis: letters go until it fits.
        while !line.is_empty() && font.width(&format!("{line}{ellipsis}"), size) > width {
            line.pop();
        }
        line.push_str(ellipsis);
    }
    lines
}

/// Returns the pieces between which a text may be broken, and whether a space stands before each: words, and every letter
/// of Chinese and Japanese, marks with the letter that they belong to.
fn pieces(text: &str) -> Vec<(bool, String)> {
    const OPENING: &str = "（「『【《〈“‘(";
    const CLOSING: &str = "、。，．：；！？）」』】》〉”’…),.:;!?%";
    let is_wide = |c: char| matches!(c, '\u{2e80}'..='\u{a4cf}' | '\u{f900}'..='\u{faff}' | '\u{ff00}'..='\u{ffef}');
    let mut out: Vec<(bool, String)> = Vec::new();
    for word in text.split_whitespace() {
        let mut before: Option<char> = None;
        for c in word.chars() {
            let breaks =
                before.is_some_and(|b| (is_wide(c) || is_wide(b)) && !CLOSING.contains(c) && !OPENING.contains(b));
            match (before, out.last_mut()) {
                (Some(_), Some(last)) if !breaks => last.1.push(c),
                (Some(_), _) => out.push((false, c.to_string())),
                (None, _) => out.push((true, c.to_string())),
            }
            before = Some(c);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_between_words_and_between_letters_of_chinese() {
        let words = |text: &str| pieces(text).into_iter().map(|p| p.1).collect::<Vec<_>>();
        assert_eq!(words("flat with 2 rooms"), ["flat", "with", "2", "rooms"]);
        assert_eq!(words("两室,一卫。"), ["两", "室,", "一", "卫。"]);
        assert_eq!(words("방 두 개"), ["방", "두", "개"]);
        let page = Page::new();
        let prompt = "“深圳市宝安区三室两厅两卫的住宅,带独立卫生间、衣帽间和书房,面积一百二十平方米。”";
        let lines = wrap(&page, prompt, 16.5, Weight::Regular, 6);
        assert!(lines.len() > 1 && lines.concat() == prompt, "{lines:?}");
    }

    #[test]
    fn a_legend_names_what_its_line_holds() {
        let page = Page::new();
        assert_eq!(page_list(&page, &["Living room", "Kitchen"], 14.0, 400.0), "Living room, kitchen");
        assert_eq!(
            page_list(&page, &["Living room", "Kitchen", "Dining room"], 14.0, 150.0),
            "Living room, kitchen, …"
        );
    }
}
