//! A film of those who move in a world, over its plan: an animated PNG with roles by color and a clock.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use d3dgen_model::hours;
use d3dgen_model::occupancy::FLAT_M;
use d3dgen_model::placements::Placement;
use d3dgen_model::trajectory::{Track, Trajectory};
use d3dgen_model::world::World;
use d3dgen_model::{Point, Polygon, Rect};
use resvg::{tiny_skia, usvg};

use crate::error::Error;
use crate::font::{Font, Weight};

/// Largest width and height of the plans, px.
const MOST_PX: [f64; 2] = [860.0, 720.0];
/// Width of the legend, margin, and height of a line of it, px.
const LEGEND_PX: f64 = 190.0;
const MARGIN_PX: f64 = 14.0;
const LINE_PX: f64 = 20.0;
/// Time between two frames, s, frames a second of the film, and frames at most.
const STEP_S: f64 = 2.0;
const FPS: u16 = 8;
const MOST_FRAMES: usize = 450;
/// Least radius of somebody, px.
const LEAST_PX: f64 = 3.6;
/// Steps of each color of the plan's part of the palette.
const STEPS: u8 = 6;
/// Index of what a frame leaves as it was, and of the first color of a role.
const SAME: u8 = 255;
const FIRST_ROLE: u8 = 217;
/// Colors of roles, in the order of the legend; robots have their own.
const COLORS: [[u8; 3]; 16] = [
    [214, 39, 40],
    [31, 119, 180],
    [44, 160, 44],
    [148, 103, 189],
    [188, 140, 20],
    [23, 160, 180],
    [227, 119, 194],
    [110, 70, 50],
    [60, 60, 60],
    [120, 170, 20],
    [20, 60, 140],
    [180, 70, 120],
    [0, 130, 110],
    [150, 150, 150],
    [90, 20, 90],
    [200, 90, 60],
];
const ROBOT: [u8; 3] = [255, 127, 14];
const OUTLINE: u8 = 216;

/// A picture of indexes into the palette.
#[derive(Clone)]
struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

/// A plan of a storey on the picture.
struct Frame {
    level: i32,
    scale: f64,
    origin: Point,
    at: (f64, f64),
}

impl Frame {
    fn map(&self, p: Point) -> (f64, f64) {
        (self.at.0 + (p.x - self.origin.x) * self.scale, self.at.1 - (p.y - self.origin.y) * self.scale)
    }
}

/// Returns the film of the first `seconds` as an animated PNG: who is still on its way then is followed no further.
///
/// # Errors
/// `Picture` when the encoder refuses it: a bug of ours.
pub fn film(world: &World, trajectory: &Trajectory, seconds: f64) -> Result<Vec<u8>, Error> {
    let roles: Vec<&str> =
        trajectory.agents.iter().map(|t| t.role.as_str()).collect::<BTreeSet<_>>().into_iter().collect();
    let kinds: Vec<&str> =
        trajectory.robots.iter().map(|t| t.role.as_str()).collect::<BTreeSet<_>>().into_iter().collect();
    let (frames, size) = layout(world);
    let lines = roles.len() + kinds.len() + 4;
    let height = size.1.max(lines as f64 * LINE_PX + 2.0 * MARGIN_PX);
    let (width, height) = ((size.0 + LEGEND_PX) as usize, height as usize);
    let svg = background(world, trajectory, (&frames, size.0), (&roles, &kinds), (width, height));
    let base = raster(&svg, width, height)?;
    let digits = digits()?;
    let end = trajectory.agents.iter().chain(&trajectory.robots).filter_map(|t| t.samples.last()).map(|s| s.t);
    let end = end.fold(0.0, f64::max).min(seconds);
    let step = STEP_S.max(end / MOST_FRAMES as f64);
    let count = (end / step) as usize + 1;
    let start = trajectory.hour.as_deref().and_then(hours::get).map_or(0, |h| seconds_of(&h.clock));
    let draw = |k: usize| {
        let t = k as f64 * step;
        let mut canvas = base.clone();
        let movers = trajectory.agents.iter().chain(&trajectory.robots);
        for (n, track) in movers.enumerate() {
            let robot = n >= trajectory.agents.len();
            let role = roles.iter().position(|r| *r == track.role).unwrap_or(0);
            let color = if robot { FIRST_ROLE + COLORS.len() as u8 } else { FIRST_ROLE + (role % COLORS.len()) as u8 };
            mover(&mut canvas, &frames, track, (t, robot, color));
        }
        clock(&mut canvas, &digits, start + t as u32, (size.0 + MARGIN_PX) as usize);
        canvas
    };
    encode(count, draw)
}

fn seconds_of(clock: &str) -> u32 {
    clock.split(':').filter_map(|part| part.parse::<u32>().ok()).fold(0, |sum, part| sum * 60 + part) * 60
}

/// Returns where the storeys lie on the picture, one below the other, and how much they take.
fn layout(world: &World) -> (Vec<Frame>, (f64, f64)) {
    let levels = world.floorplan.level_numbers();
    let bounds = |level: i32| {
        let rooms = world.floorplan.rooms.iter().filter(|r| r.level == level).map(|r| r.polygon.bounds());
        rooms.reduce(|a, b| a.union(&b)).unwrap_or(Rect::new(0.0, 0.0, 1.0, 1.0)).grown(0.3)
    };
    let all: Vec<(i32, Rect)> = levels.iter().rev().map(|level| (*level, bounds(*level))).collect();
    let width = all.iter().map(|(_, r)| r.width()).fold(1.0, f64::max);
    let height: f64 = all.iter().map(|(_, r)| r.height()).sum();
    let free = MOST_PX[1] - MARGIN_PX * all.len() as f64;
    let scale = (MOST_PX[0] / width).min(free / height).clamp(4.0, 60.0);
    let mut y = MARGIN_PX;
    let mut frames = Vec::new();
    for (level, r) in all {
        let at = (MARGIN_PX, y + r.height() * scale);
        frames.push(Frame { level, scale, origin: Point::new(r.x0, r.y0), at });
        y = at.1 + MARGIN_PX;
    }
    (frames, (width * scale + 2.0 * MARGIN_PX, y))
}

fn background(
    world: &World,
    trajectory: &Trajectory,
    (frames, left): (&[Frame], f64),
    (roles, kinds): (&[&str], &[&str]),
    (width, height): (usize, usize),
) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\"><rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>"
    );
    for frame in frames {
        plan(&mut svg, world, frame);
    }
    let (bold, regular) = (Font::new(Weight::SemiBold), Font::new(Weight::Regular));
    let x = left + MARGIN_PX;
    let hour = trajectory.hour.as_deref().and_then(hours::get).map_or("", |h| h.label.as_str());
    text(&mut svg, &bold, hour, (x, 3.4 * LINE_PX), 16.0);
    let mut y = 4.6 * LINE_PX;
    let mut line = |svg: &mut String, name: &str, color: [u8; 3], square: bool, count: usize| {
        let [r, g, b] = color;
        let mark = match square {
            true => {
                format!("<rect x=\"{}\" y=\"{}\" width=\"11\" height=\"11\" fill=\"rgb({r},{g},{b})\"/>", x, y - 10.0)
            }
            false => format!("<circle cx=\"{}\" cy=\"{}\" r=\"5.5\" fill=\"rgb({r},{g},{b})\"/>", x + 5.5, y - 4.5),
        };
        svg.push_str(&mark);
        text(svg, &regular, &format!("{} ({count})", name.replace('_', " ")), (x + 18.0, y), 13.0);
        y += LINE_PX;
    };
    for (k, role) in roles.iter().enumerate() {
        let count = trajectory.agents.iter().filter(|t| t.role == *role).count();
        line(&mut svg, role, COLORS[k % COLORS.len()], false, count);
    }
    for kind in kinds {
        let count = trajectory.robots.iter().filter(|t| t.role == *kind).count();
        line(&mut svg, &format!("{kind} robot"), ROBOT, true, count);
    }
    svg + "</svg>"
}

/// Draws a storey: floors, things, walls, names of the larger rooms.
fn plan(svg: &mut String, world: &World, frame: &Frame) {
    let plan = world.floorplan.storey_at(frame.level);
    for room in &plan.rooms {
        shape(svg, frame, &room.polygon, "#50545c");
    }
    for room in &plan.rooms {
        let fill = if room.circulation { "#f4efe4" } else { "#ffffff" };
        shape(svg, frame, &room.net_polygon, fill);
    }
    for door in &plan.doors {
        let (line, half) = (&door.line, door.wall_thickness_m / 2.0 + 0.02);
        let length = line.length().max(1e-6);
        let (nx, ny) = (-(line.end.y - line.start.y) / length * half, (line.end.x - line.start.x) / length * half);
        let corners = [(line.start, -1.0), (line.end, -1.0), (line.end, 1.0), (line.start, 1.0)];
        let fill = if door.room_ids.len() == 1 { "#c8a060" } else { "#f4efe4" };
        let outline = corners.map(|(p, s)| Point::new(p.x + s * nx, p.y + s * ny)).to_vec();
        shape(svg, frame, &Polygon(outline), fill);
    }
    let stands = |p: &&Placement| p.top_m() > FLAT_M && p.support.is_none() && p.pose.z < 1.0;
    let here = |p: &&Placement| plan.room(&p.room_id).is_some();
    for thing in world.placements.placements.iter().filter(here).filter(stands) {
        shape(svg, frame, &thing.footprint(), "#d6d9de");
    }
    let font = Font::new(Weight::Regular);
    for room in &plan.rooms {
        // at the corner that is farthest up, and there farthest to the left: the names of others stand at theirs
        let corners = room.net_polygon.corners();
        let Some(at) = corners.iter().max_by(|a, b| a.y.total_cmp(&b.y).then(b.x.total_cmp(&a.x))) else { continue };
        let top = corners.iter().filter(|p| (p.y - at.y).abs() < 1e-6).map(|p| p.x).fold(at.x, f64::max);
        let width = font.width(&room.name, 9.0);
        if width < (top - at.x) * frame.scale - 4.0 && room.net_polygon.bounds().height() * frame.scale > 22.0 {
            let (x, y) = frame.map(*at);
            text_in(svg, &font, &room.name, (x + 3.0, y + 11.0), 9.0, "#8a8f98");
        }
    }
}

fn shape(svg: &mut String, frame: &Frame, outline: &Polygon, fill: &str) {
    let points: Vec<String> =
        outline.corners().iter().map(|p| frame.map(*p)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    // writing to a string cannot fail
    let _ = write!(svg, "<polygon points=\"{}\" fill=\"{fill}\"/>", points.join(" "));
}

fn text(svg: &mut String, font: &Font, text: &str, at: (f64, f64), size: f64) {
    text_in(svg, font, text, at, size, "#202328");
}

fn text_in(svg: &mut String, font: &Font, text: &str, (x, y): (f64, f64), size: f64, fill: &str) {
    let mut path = String::new();
    font.outline(text, x, y, size, &mut path);
    let _ = write!(svg, "<path d=\"{path}\" fill=\"{fill}\"/>");
}

/// Draws an SVG with the colors of the palette.
fn raster(svg: &str, width: usize, height: usize) -> Result<Canvas, Error> {
    let refused = |reason: String| Error::Picture { picture: "film", reason };
    let tree = usvg::Tree::from_str(svg, &usvg::Options::default()).map_err(|e| refused(e.to_string()))?;
    let mut pixmap =
        tiny_skia::Pixmap::new(width as u32, height as u32).ok_or_else(|| refused("it has no size".into()))?;
    resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixmap.as_mut());
    let level = |v: u8| (u16::from(v) * u16::from(STEPS - 1) + 127) / 255;
    let index = |p: &tiny_skia::PremultipliedColorU8| {
        let own = |known: &[u8; 3]| [p.red(), p.green(), p.blue()] == *known;
        let role = COLORS.iter().position(own).or(own(&ROBOT).then_some(COLORS.len()));
        let mixed = level(p.red()) * 36 + level(p.green()) * 6 + level(p.blue());
        role.map_or(mixed as u8, |k| FIRST_ROLE + k as u8)
    };
    Ok(Canvas { width, height, pixels: pixmap.pixels().iter().map(index).collect() })
}

/// Returns the palette: a cube of colors, the outline, the roles, and what is left as it was.
fn palette() -> Vec<u8> {
    let level = |k: u16| (k * 255 / u16::from(STEPS - 1)) as u8;
    let mut out: Vec<u8> = (0..216_u16).flat_map(|k| [level(k / 36), level(k / 6 % 6), level(k % 6)]).collect();
    out.extend([30, 30, 30]);
    out.extend(COLORS.iter().flatten());
    out.extend(ROBOT);
    out.resize(256 * 3, 0);
    out
}

/// Returns how wide a sign of the clock is: digits all alike, so that it stands still.
fn digit_px(sign: char) -> usize {
    if sign == ':' { 9 } else { 17 }
}

fn digits() -> Result<BTreeMap<char, Canvas>, Error> {
    let font = Font::new(Weight::SemiBold);
    let draw = |c: char| {
        let mut svg = String::from(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"17\" height=\"28\"><rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>",
        );
        let text_of = c.to_string();
        let left = (digit_px(c) as f64 - font.width(&text_of, 26.0)) / 2.0;
        text(&mut svg, &font, &text_of, (left, 23.0), 26.0);
        Ok((c, raster(&(svg + "</svg>"), digit_px(c), 28)?))
    };
    "0123456789:".chars().map(draw).collect()
}

/// Draws the time of the day.
fn clock(canvas: &mut Canvas, digits: &BTreeMap<char, Canvas>, seconds: u32, x: usize) {
    let text = format!("{:02}:{:02}:{:02}", seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    let mut left = x;
    for c in text.chars() {
        let Some(digit) = digits.get(&c) else { continue };
        for j in 0..digit.height {
            for i in 0..digit.width {
                canvas.set((left + i) as i64, (j + 12) as i64, digit.pixels[j * digit.width + i]);
            }
        }
        left += digit.width;
    }
}

/// Draws one who moves as it is at a time: people as discs, smaller ones on seats, robots as squares.
fn mover(canvas: &mut Canvas, frames: &[Frame], track: &Track, (t, robot, color): (f64, bool, u8)) {
    let Some(here) = track.at(t) else { return };
    let Some(frame) = frames.iter().find(|f| f.level == here.level) else { return };
    let (x, y) = frame.map(here.at);
    let seated = track.pause_at(t).is_some_and(|kind| matches!(kind, "seat" | "bed"));
    let r = (track.radius * frame.scale).max(LEAST_PX) * if seated { 0.8 } else { 1.0 };
    let reach = r.ceil() as i64 + 1;
    for j in -reach..=reach {
        for i in -reach..=reach {
            let (px, py) = ((x as i64 + i) as f64 + 0.5 - x, (y as i64 + j) as f64 + 0.5 - y);
            let off = if robot { px.abs().max(py.abs()) } else { px.hypot(py) };
            if off <= r {
                let edge = off > r - 1.0 && !seated;
                canvas.set(x as i64 + i, y as i64 + j, if edge { OUTLINE } else { color });
            }
        }
    }
}

impl Canvas {
    fn set(&mut self, x: i64, y: i64, color: u8) {
        if x >= 0 && y >= 0 && (x as usize) < self.width && (y as usize) < self.height {
            self.pixels[y as usize * self.width + x as usize] = color;
        }
    }

    /// Returns what of another picture is not as in this one: the rectangle around it (left, top, width, height) and its pixels.
    fn change(&self, next: &Self) -> ([usize; 4], Vec<u8>) {
        let (mut x0, mut y0, mut x1, mut y1) = (self.width, self.height, 0, 0);
        for (n, (a, b)) in self.pixels.iter().zip(&next.pixels).enumerate() {
            if a != b {
                let (x, y) = (n % self.width, n / self.width);
                (x0, y0, x1, y1) = (x0.min(x), y0.min(y), x1.max(x), y1.max(y));
            }
        }
        if x0 > x1 {
            (x0, y0, x1, y1) = (0, 0, 0, 0);
        }
        let rows = (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| y * self.width + x));
        let pixels = rows.map(|n| if self.pixels[n] == next.pixels[n] { SAME } else { next.pixels[n] }).collect();
        ([x0, y0, x1 - x0 + 1, y1 - y0 + 1], pixels)
    }
}

fn encode(count: usize, draw: impl Fn(usize) -> Canvas) -> Result<Vec<u8>, Error> {
    let refused = |e: png::EncodingError| Error::Picture { picture: "film", reason: e.to_string() };
    let mut last = draw(0);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, last.width as u32, last.height as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette());
    let mut alpha = vec![255; 256];
    alpha[usize::from(SAME)] = 0;
    encoder.set_trns(alpha);
    if count > 1 {
        encoder.set_animated(count as u32, 0).map_err(refused)?;
        encoder.set_frame_delay(1, FPS).map_err(refused)?;
        encoder.set_blend_op(png::BlendOp::Over).map_err(refused)?;
        encoder.set_dispose_op(png::DisposeOp::None).map_err(refused)?;
    }
    let mut writer = encoder.write_header().map_err(refused)?;
    writer.write_image_data(&last.pixels).map_err(refused)?;
    for k in 1..count {
        let next = draw(k);
        let ([x, y, w, h], pixels) = last.change(&next);
        // a smaller frame fits only where the one before allows it
        writer.reset_frame_position().map_err(refused)?;
        writer.set_frame_dimension(w as u32, h as u32).map_err(refused)?;
        writer.set_frame_position(x as u32, y as u32).map_err(refused)?;
        writer.write_image_data(&pixels).map_err(refused)?;
        last = next;
    }
    writer.finish().map_err(refused)?;
    Ok(bytes)
}
