//! From a drawing to rooms that meet at their walls.
//!
//! Rooms drawn with a gap between them are drawn on wall faces: the gap is the wall, its middle the line that both rooms
//! end at. Rooms that share edges are drawn on center lines and get walls of the usual thickness. Both may occur in one
//! plan; each stretch of wall knows how far its two faces are from its line.

use d3dgen_model::scene_graph::Note;
use d3dgen_model::{Point, Polygon};

use crate::attach::attach;
use crate::cells::Stretch;
use crate::drawing::{Drawing, OpeningKind, SolidKind, note};
use crate::error::Error;
use crate::levels::{LaidLevel, Storey};
use crate::options::Options;
use crate::rooms::{name, rooms_and_floor, strips};
use crate::shape::polygon;
use crate::walls::{outlines, walls};
use crate::words::is_number;
use crate::{cabins, evidence, leaves, levels, solids, upright};

/// Wall left at the ends of the open side between two pieces of one room, mm, and the shortest such side.
const PIECE_JAMB: i64 = 120;
const PIECE_SIDE: i64 = 600;
/// Rooms that a hub joins at least, and how many times as long as wide it is when it joins no more.
const HUB_ROOMS: usize = 3;
const HUB_LONG: f64 = 2.2;
/// A plan this far from the origin is moved to it, m.
const FAR_M: f64 = 10_000.0;
/// Largest side of a plan, m.
const LARGEST_M: f64 = 2000.0;

/// Rooms, walls and openings, in place; not typed yet.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layout {
    /// Rooms in the order of the drawing.
    pub rooms: Vec<LaidRoom>,
    /// Openings in walls.
    pub openings: Vec<LaidOpening>,
    /// Columns and walls that stand free.
    pub obstacles: Vec<LaidObstacle>,
    /// What was assumed and changed.
    pub notes: Vec<Note>,
    /// What the file calls the building.
    pub titles: Vec<String>,
    /// Storeys from the lowest to the highest; empty for a plan of one.
    pub(crate) levels: Vec<LaidLevel>,
    pub(crate) stretches: Vec<Stretch>,
}

/// A room with its outlines.
#[derive(Debug, Clone, PartialEq)]
pub struct LaidRoom {
    /// Name on the plan; empty when it has none.
    pub label: String,
    /// What the file says it is, beside the name.
    pub kind: Option<String>,
    /// Other words that stand in it.
    pub also: Vec<String>,
    /// True when it has no name but a number at most, and joins so many rooms that it is circulation.
    pub hub: bool,
    /// True when it has no name, or a number only.
    pub unnamed: bool,
    /// Outline on wall center lines.
    pub polygon: Polygon,
    /// Outline on wall faces.
    pub net_polygon: Polygon,
    /// Clear height, m, where the file states it.
    pub height_m: Option<f64>,
    /// Which of the storeys it is on.
    pub(crate) storey: usize,
}

/// Something that stands in a room from floor to ceiling.
#[derive(Debug, Clone, PartialEq)]
pub struct LaidObstacle {
    /// What it is.
    pub kind: SolidKind,
    /// Its outline within the room, counter-clockwise, at any angle.
    pub outline: Polygon,
    /// Room it stands in.
    pub room: usize,
}

/// An opening in its stretch of wall.
#[derive(Debug, Clone, PartialEq)]
pub struct LaidOpening {
    /// What it is.
    pub kind: OpeningKind,
    /// Rooms it joins: two, or one for an outer wall.
    pub rooms: Vec<usize>,
    pub(crate) stretch: usize,
    /// Along the stretch, mm.
    pub(crate) from: i64,
    pub(crate) to: i64,
    pub(crate) sill_m: Option<f64>,
    pub(crate) head_m: Option<f64>,
    pub(crate) sliding: bool,
    /// Room the leaf is drawn in (`Some(None)`: outdoors) and whether it hinges at the start.
    pub(crate) swing: Option<(Option<usize>, bool)>,
}

/// Lays out a drawing: one storey after the other, in one frame.
///
/// # Errors
/// `Refused` for what is no building: no rooms, rooms on top of each other, outlines that cross themselves, slanted walls
/// (unless `rectify`), rooms that walls leave no floor of; always with the room and the place.
pub fn lay_out(mut drawing: Drawing, options: &Options) -> Result<Layout, Error> {
    drawing.check_numbers()?;
    evidence::decide(&mut drawing);
    drawing.tell_of_unread();
    let layers = drawing.tell_of_layers();
    if let Some(level) = options.level.as_deref() {
        levels::keep(&mut drawing, level)?;
    }
    if let Some(thickness) =
        [options.inner_wall_m, options.outer_wall_m].into_iter().flatten().find(|t| !(0.02..=1.0).contains(t))
    {
        return Err(Error::refused("wall thickness", format!("{thickness} m is outside 0.02-1 m")));
    }
    upright::turn(&mut drawing);
    move_near(&mut drawing, &layers)?;
    let (titles, notes) = (std::mem::take(&mut drawing.titles), std::mem::take(&mut drawing.notes));
    let mut layout = Layout { notes, titles, ..Layout::default() };
    let storeys = if options.level.is_some() { vec![levels::whole(drawing)] } else { levels::split(drawing) };
    let several = storeys.len() > 1;
    for Storey { level, drawing } in storeys {
        let found = storey(drawing, options, layout.rooms.len()).map_err(|e| e.with_layers(&layers));
        let mut found = if several { found.map_err(|e| e.on_level(&level.name))? } else { found? };
        if several {
            found.notes.iter_mut().for_each(|n| n.message = format!("level {}: {}", level.name, n.message));
            layout.levels.push(level);
        }
        layout.stack(found);
    }
    layout.notes.extend(levels::tell(&layout.levels));
    Ok(layout)
}

/// Lays out one storey; rooms that were found are named by their number, counted from `before`.
fn storey(mut drawing: Drawing, options: &Options, before: usize) -> Result<Layout, Error> {
    leaves::pair(&mut drawing.openings);
    strips(&mut drawing);
    cabins::enclose(&mut drawing);
    let (mut drawn, cells) = rooms_and_floor(&mut drawing, options)?;
    let words = name(&mut drawn, &cells, &mut drawing);
    let mut walls = walls(cells, options, &mut drawing.notes)?;
    let assumed = walls.are_assumed();
    let outlines = outlines(&mut drawn, &mut walls, &mut drawing.notes)?;
    let mut rooms: Vec<LaidRoom> = Vec::with_capacity(outlines.rooms.len());
    for (room, ring, net) in outlines.rooms {
        rooms.push(LaidRoom {
            label: drawn[room].label.trim().to_owned(),
            kind: drawn[room].kind.clone(),
            also: words.get(outlines.origin[room]).cloned().unwrap_or_default(),
            hub: false,
            unnamed: false,
            net_polygon: polygon(&net),
            polygon: polygon(&ring),
            height_m: drawn[room].height_m.filter(|h| h.is_finite() && (1.5..=50.0).contains(h)),
            storey: 0,
        });
    }
    cabins::mark(&mut rooms, &mut drawing);
    let stretches = outlines.stretches;
    let mut notes = std::mem::take(&mut drawing.notes);
    let obstacles = solids::stand(&drawing, &rooms, &mut notes);
    let mut openings = attach(&drawing.openings, &stretches, &rooms, assumed, &mut notes);
    openings.extend(open_sides(&stretches, &outlines.family, &openings));
    mark_hubs(&mut rooms, &openings);
    rooms.iter_mut().for_each(|r| r.unnamed = has_no_name(r));
    // rooms that were found get a name by which the user can say what they are
    for (i, (room, family)) in rooms.iter_mut().zip(&outlines.family).enumerate() {
        if room.label.is_empty() && drawn[*family].traced {
            room.label = format!("room_{}", before + i + 1);
        }
    }
    Ok(Layout { rooms, openings, obstacles, notes, stretches, ..Layout::default() })
}

impl Layout {
    /// Adds the next storey; levels are listed before.
    fn stack(&mut self, upper: Layout) {
        let (rooms, stretches) = (self.rooms.len(), self.stretches.len());
        let storey = self.levels.len().saturating_sub(1);
        let room = |r: &mut usize| *r += rooms;
        self.rooms.extend(upper.rooms.into_iter().map(|r| LaidRoom { storey, ..r }));
        self.stretches.extend(upper.stretches.into_iter().map(|mut s| {
            s.low.iter_mut().chain(&mut s.high).for_each(room);
            s
        }));
        self.openings.extend(upper.openings.into_iter().map(|mut o| {
            o.rooms.iter_mut().for_each(room);
            o.swing.iter_mut().flat_map(|s| &mut s.0).for_each(room);
            LaidOpening { stretch: o.stretch + stretches, ..o }
        }));
        self.obstacles.extend(upper.obstacles.into_iter().map(|o| LaidObstacle { room: o.room + rooms, ..o }));
        self.notes.extend(upper.notes);
    }

    /// Returns for each room those that a door or passage joins it with.
    pub fn joined(&self) -> Vec<Vec<usize>> {
        let mut out = vec![Vec::new(); self.rooms.len()];
        for o in self.openings.iter().filter(|o| o.kind != OpeningKind::Window) {
            if let [a, b] = o.rooms[..] {
                out[a].push(b);
                out[b].push(a);
            }
        }
        out
    }

    /// Returns the number of the storey that a room is on: 0 at the ground.
    pub(crate) fn number_of(&self, room: usize) -> i32 {
        self.levels.get(self.rooms[room].storey).map_or(0, |l| l.number)
    }
}

/// Returns true for a room without a name, or with a number only.
fn has_no_name(room: &LaidRoom) -> bool {
    room.kind.as_deref().is_none_or(str::is_empty) && (room.label.is_empty() || is_number(&room.label))
}

/// Marks rooms without a name that join many others: long ones, or those that join more.
fn mark_hubs(rooms: &mut [LaidRoom], openings: &[LaidOpening]) {
    for (room, laid) in rooms.iter_mut().enumerate().filter(|(_, r)| has_no_name(r)) {
        let walkable = openings.iter().filter(|o| o.kind != OpeningKind::Window && o.rooms.contains(&room));
        let mut joined: Vec<usize> = walkable.flat_map(|o| o.rooms.iter().copied()).filter(|r| *r != room).collect();
        joined.sort_unstable();
        joined.dedup();
        let bounds = laid.net_polygon.bounds();
        let (long, short) = (bounds.width().max(bounds.height()), bounds.width().min(bounds.height()));
        // an angled corridor fills little of the box around it
        let bent = laid.net_polygon.area() < 0.5 * bounds.width() * bounds.height();
        let slender = long >= HUB_LONG * short || bent;
        laid.hub = joined.len() > HUB_ROOMS || joined.len() == HUB_ROOMS && slender;
    }
    // where one comes in through another room, that one is circulation too
    let leads_out = |room: usize| openings.iter().any(|o| o.kind != OpeningKind::Window && o.rooms == [room]);
    let hubs: Vec<bool> = rooms.iter().map(|r| r.hub).collect();
    if (0..rooms.len()).any(|r| hubs[r] && leads_out(r)) {
        return;
    }
    for (room, laid) in rooms.iter_mut().enumerate() {
        let at_hub = openings.iter().any(|o| {
            o.kind != OpeningKind::Window && o.rooms.contains(&room) && o.rooms.iter().any(|r| *r != room && hubs[*r])
        });
        laid.hub |= has_no_name(laid) && at_hub && leads_out(room);
    }
}

/// Returns passages on the sides that the pieces of one room share.
fn open_sides(stretches: &[Stretch], family: &[usize], openings: &[LaidOpening]) -> Vec<LaidOpening> {
    let mut out = Vec::new();
    for (k, s) in stretches.iter().enumerate() {
        let (Some(a), Some(b)) = (s.low, s.high) else { continue };
        let (from, to) = (s.from + PIECE_JAMB, s.to - PIECE_JAMB);
        let taken = openings.iter().any(|o| o.stretch == k && o.from < to && from < o.to);
        if family[a] == family[b] && to - from >= PIECE_SIDE && !taken {
            out.push(LaidOpening {
                kind: OpeningKind::Passage,
                rooms: vec![a, b],
                stretch: k,
                from,
                to,
                sill_m: None,
                head_m: None,
                sliding: false,
                swing: None,
            });
        }
    }
    out
}

/// Refuses what is too large for a building and moves what is drawn far away to the origin.
fn move_near(drawing: &mut Drawing, layers: &str) -> Result<(), Error> {
    let rooms = drawing.rooms.iter().chain(drawing.unclear.iter().map(|s| &s.room));
    let corners: Vec<Point> = rooms.flat_map(|r| r.corners.iter().copied()).collect();
    let lines = drawing.walls.iter().flat_map(|w| w.line);
    let all: Vec<Point> = if corners.is_empty() { lines.collect() } else { corners };
    if all.is_empty() {
        let message = format!("holds no rooms: no closed outlines and no walls that could enclose any{layers}");
        return Err(Error::refused("plan", message));
    }
    let around = Polygon(all).bounds();
    if around.width().max(around.height()) > LARGEST_M {
        let message = format!(
            "is {:.0} m by {:.0} m, a building has {LARGEST_M} m at most; is the unit right? say it with --meters-per-unit",
            around.width(),
            around.height()
        );
        return Err(Error::refused("plan", message));
    }
    if around.width().min(around.height()) < 0.5 {
        let message = format!(
            "is only {:.3} m by {:.3} m; is the unit right? say it with --meters-per-unit",
            around.width(),
            around.height()
        );
        return Err(Error::refused("plan", message));
    }
    if around.x0.abs().max(around.y0.abs()) > FAR_M {
        for p in drawing.points_mut() {
            *p = Point::new(p.x - around.x0, p.y - around.y0);
        }
        let message = format!("the plan was moved by ({:.3}, {:.3}) m, to the origin", -around.x0, -around.y0);
        drawing.notes.push(note("moved", message));
    }
    Ok(())
}
