//! Occupancy map of nav2 (`map.yaml` with its PGM or PNG): free floor, parted into rooms at the doors (`trace`).
//!
//! Approximate by nature: a map knows neither names nor windows, furniture looks like walls, and an open door like a
//! passage. Every distance is in cells until the rooms are drawn.

use d3dgen_model::Point;
use serde::Deserialize;
use serde_json::Value;

use super::source::{Plan, Reader, Source};
use super::trace::{DOOR_M, Map as Cells, trace};
use crate::clean;
use crate::drawing::{Drawing, DrawnOpening, DrawnRoom, DrawnSolid, OpeningKind, SolidKind, note};
use crate::error::Error;
use crate::options::Options;

pub(super) const READER: Reader = Reader { name: "nav2", title: "nav2 occupancy map (map.yaml)", recognizes, read };

const FORMAT: &str = "nav2";
/// Most cells of a map, and the largest cell, m.
const MOST_CELLS: usize = 16_000_000;
const COARSEST_M: f64 = 0.5;
/// Steps of an outline up to this are noise, m.
const NOISE_M: f64 = 0.15;
/// Most corners of a traced outline.
const MOST_CORNERS: usize = 1500;
/// Least floor never scanned that is worth a note, m^2.
const LEAST_UNSCANNED_M2: f64 = 0.5;
/// What a map saver writes for cells that nobody has seen; some maps have a threshold that would make them free.
const UNSEEN: u8 = 205;

#[derive(Deserialize)]
struct Map {
    image: String,
    resolution: f64,
    #[serde(default)]
    origin: Vec<Value>,
    #[serde(default)]
    negate: i64,
    #[serde(default = "free_thresh")]
    free_thresh: f64,
    #[serde(default = "occupied_thresh")]
    occupied_thresh: f64,
}

fn free_thresh() -> f64 {
    0.25
}

fn occupied_thresh() -> f64 {
    0.65
}

/// Returns where the picture's lower left corner lies, m.
///
/// # Errors
/// `Broken` for what is no number, and for a picture that is turned: rooms are found along its rows and columns.
fn origin(given: &[Value], drawing: &mut Drawing) -> Result<Point, Error> {
    let broken = |message: String| Error::broken(FORMAT, "origin", message);
    let number = |value: &Value| match value {
        Value::Number(n) => n.as_f64(),
        // as C and Python print what is no number
        Value::String(s) => s.trim().parse::<f64>().ok(),
        Value::Null => Some(f64::NAN),
        _ => None,
    };
    let numbers: Vec<f64> = given
        .iter()
        .map(|v| number(v).ok_or_else(|| broken(format!("`{v}` is no number"))))
        .collect::<Result<_, _>>()?;
    let at = |k: usize| numbers.get(k).copied().unwrap_or(0.0);
    if !(at(0).is_finite() && at(1).is_finite()) {
        return Err(broken(format!("({}, {}) is no place", at(0), at(1))));
    }
    if at(2).is_nan() {
        drawing.notes.push(note("yaw_assumed", "the map's yaw is no number (nan); it was taken for 0"));
    } else if at(2).abs() > 1e-6 {
        return Err(broken("is turned; rooms are traced of maps with a yaw of 0".into()));
    }
    Ok(Point::new(at(0), at(1)))
}

fn recognizes(source: &Source) -> bool {
    let head = source.head();
    source.has_ending(&[".yaml", ".yml"]) && head.contains("image:") && head.contains("resolution:")
}

fn read(source: &Source, options: &Options) -> Result<Plan, Error> {
    let map: Map = source.yaml(FORMAT)?;
    let resolution = options.meters_per_unit.unwrap_or(map.resolution);
    if !(resolution.is_finite() && resolution > 0.001 && resolution <= COARSEST_M) {
        let message = format!("{resolution} m a cell; rooms can be traced at 0.001 to {COARSEST_M} m");
        return Err(Error::broken(FORMAT, "resolution", message));
    }
    let bytes = (source.companion)(&map.image)
        .ok_or_else(|| Error::broken(FORMAT, "image", format!("`{}` is not beside the yaml file", map.image)))?;
    let (width, height, gray) = picture(&bytes, &map.image)?;
    let value = |g: u8| if map.negate == 0 { 255 - g } else { g };
    // a map all in this gray has no other floor
    let seen = gray.iter().any(|g| *g > 250 || *g == 0) && map.negate == 0;
    let (mut free, mut unknown) = (vec![false; width * height], vec![false; width * height]);
    for row in 0..height {
        for column in 0..width {
            let shade = gray[row * width + column];
            let occupied = f64::from(value(shade)) / 255.0;
            let cell = (height - 1 - row) * width + column;
            free[cell] = occupied < map.free_thresh && !(seen && shade == UNSEEN);
            unknown[cell] = !free[cell] && occupied < map.occupied_thresh;
        }
    }
    let mut drawing = Drawing::default();
    let origin = origin(&map.origin, &mut drawing)?;
    let found = trace(Cells { width, height, free, unknown, per_meter: 1.0 / resolution });
    // rooms are found on a map that is turned upright, and drawn where they are on the map as it is
    let meters = |p: Point| {
        let (x, y) = (p.x / resolution, p.y / resolution);
        let (x, y) = found.turn.map_or((x, y), |t| t.back((x, y)));
        Point::new(origin.x + x * resolution, origin.y + y * resolution)
    };
    let upright = |x: f64, y: f64| Point::new(x * resolution, y * resolution);
    for (i, ring) in found.standing.iter().enumerate() {
        let outline = ring.iter().map(|(x, y)| meters(upright(*x as f64, *y as f64))).collect();
        drawing.solids.push(DrawnSolid {
            kind: SolidKind::Wall,
            outline,
            level: None,
            place: format!("free wall {}", i + 1),
        });
    }
    for (room, mut loops) in found.rooms.into_iter().enumerate() {
        let corners =
            |ring: Vec<(i64, i64)>| ring.into_iter().map(|(x, y)| upright(x as f64, y as f64)).collect::<Vec<Point>>();
        let placed = |ring: Vec<Point>| ring.into_iter().map(meters).collect::<Vec<Point>>();
        let holes = loops.split_off(1).into_iter().map(|hole| placed(corners(hole))).collect();
        let place = format!("room_{}", room + 1);
        let outline = placed(settle(loops.pop().map(corners).unwrap_or_default(), &place));
        drawing.rooms.push(DrawnRoom { holes, traced: true, ..DrawnRoom::new(String::new(), outline, place) });
    }
    if drawing.rooms.is_empty() {
        return Err(Error::broken(FORMAT, map.image, "has no free floor as large as a room"));
    }
    for gap in &found.gaps {
        let [from, to] = gap.ends.map(|(x, y)| meters(upright(x, y)));
        let kind = if from.distance(to) <= DOOR_M { OpeningKind::Door } else { OpeningKind::Passage };
        let name = |room: Option<usize>| room.map_or("outdoors".to_owned(), |r| format!("room_{}", r + 1));
        let place = format!("between {} and {}", name(gap.rooms[0]), name(gap.rooms[1]));
        drawing.openings.push(DrawnOpening::new(kind, vec![from, to], None, place));
    }
    drawing.notes.push(note(
        "traced",
        format!(
            "{} rooms were traced of an occupancy map: approximate, without names, windows and closed doors; {} things that \
             stand free were taken for furniture and left out, and what stands at walls was filled up to them",
            drawing.rooms.len(),
            found.things
        ),
    ));
    if found.unscanned_m2 >= LEAST_UNSCANNED_M2 {
        let message = format!(
            "{:.1} m2 of the map lie between what was scanned and were never scanned themselves; what encloses them was taken for \
             the edge of rooms, and what they leave inside of rooms for floor",
            found.unscanned_m2
        );
        drawing.notes.push(note("unscanned", message));
    }
    Ok(Plan::Drawing(drawing))
}

/// Returns width, height and gray values, row 0 on top.
fn picture(bytes: &[u8], name: &str) -> Result<(usize, usize, Vec<u8>), Error> {
    let broken = |message: String| Error::broken(FORMAT, name, message);
    let sized = |w: usize, h: usize| {
        if w.checked_mul(h).is_some_and(|n| n > 0 && n <= MOST_CELLS) {
            Ok(w * h)
        } else {
            Err(broken(format!("is {w} by {h} cells, at most {MOST_CELLS} are read")))
        }
    };
    if bytes.starts_with(b"P5") || bytes.starts_with(b"P2") {
        let (head, rest) =
            pgm_head(bytes).ok_or_else(|| broken("has no PGM head: P5, width, height, maximum".into()))?;
        let [width, height, most] = head;
        let count = sized(width, height)?;
        if most == 0 || most > 255 {
            return Err(broken(format!("has a maximum of {most}, 1 to 255 is read")));
        }
        let full = |v: usize| (v.min(most) * 255 / most) as u8;
        let gray: Vec<u8> = if bytes.starts_with(b"P5") {
            rest.iter().take(count).map(|v| full(usize::from(*v))).collect()
        } else {
            let text = std::str::from_utf8(rest).map_err(|_| broken("is no text after P2".into()))?;
            text.split_ascii_whitespace().take(count).filter_map(|t| t.parse().ok()).map(full).collect()
        };
        if gray.len() < count {
            return Err(broken(format!("ends after {} of {count} cells", gray.len())));
        }
        return Ok((width, height, gray));
    }
    let mut decoder = png::Decoder::new_with_limits(std::io::Cursor::new(bytes), png::Limits { bytes: 256 << 20 });
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|e| broken(format!("is no PGM and no PNG: {e}")))?;
    let count = sized(reader.info().width as usize, reader.info().height as usize)?;
    let size = reader.output_buffer_size().filter(|s| *s <= 4 * count);
    let mut buffer = vec![0; size.ok_or_else(|| broken("is too large".into()))?];
    let info = reader.next_frame(&mut buffer).map_err(|e| broken(e.to_string()))?;
    let samples = info.color_type.samples();
    // transparent cells are unknown, which is not free: middle gray
    let gray = buffer[..info.buffer_size()].chunks_exact(samples).map(|p| match p {
        [g] => *g,
        [g, a] if *a > 127 => *g,
        [r, g, b] => ((u16::from(*r) + u16::from(*g) + u16::from(*b)) / 3) as u8,
        [r, g, b, a] if *a > 127 => ((u16::from(*r) + u16::from(*g) + u16::from(*b)) / 3) as u8,
        _ => 128,
    });
    Ok((info.width as usize, info.height as usize, gray.collect()))
}

/// Returns width, height and maximum of a PGM, and what follows.
fn pgm_head(bytes: &[u8]) -> Option<([usize; 3], &[u8])> {
    let (mut head, mut at) = ([0; 3], 2);
    for slot in &mut head {
        loop {
            match bytes.get(at)? {
                b'#' => at += bytes[at..].iter().position(|b| *b == b'\n')?,
                b if b.is_ascii_whitespace() => at += 1,
                _ => break,
            }
        }
        let digits = bytes[at..].iter().take(9).take_while(|b| b.is_ascii_digit()).count();
        *slot = std::str::from_utf8(&bytes[at..at + digits]).ok()?.parse().ok()?;
        at += digits;
    }
    Some((head, bytes.get(at + 1..)?))
}

/// Takes the steps out of an outline that are noise: sides close to a longer parallel one move onto it. An outline that would
/// cross itself then stays as it is.
fn settle(ring: Vec<Point>, place: &str) -> Vec<Point> {
    let n = ring.len();
    let mut sides: Vec<(bool, f64, f64)> = (0..n)
        .map(|i| {
            let (a, b) = (ring[i], ring[(i + 1) % n]);
            let vertical = (a.x - b.x).abs() < (a.y - b.y).abs();
            (vertical, if vertical { a.x } else { a.y }, a.distance(b))
        })
        .collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| sides[b].2.total_cmp(&sides[a].2).then(a.cmp(&b)));
    let mut lines: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    for i in order {
        let (vertical, at, _) = sides[i];
        let known = &mut lines[usize::from(vertical)];
        match known.iter().find(|k| (**k - at).abs() <= NOISE_M) {
            Some(line) => sides[i].1 = *line,
            None if known.len() < MOST_CORNERS => known.push(at),
            None => {}
        }
    }
    let mut out: Vec<Point> = Vec::with_capacity(n);
    for i in 0..n {
        let (before, after) = (sides[(i + n - 1) % n], sides[i]);
        let p = if after.0 { Point::new(after.1, before.1) } else { Point::new(before.1, after.1) };
        out.push(p);
    }
    let settled = tidy(out);
    if clean::ring(&settled, place).is_ok() { settled } else { ring }
}

/// Removes sides of no length and the corners that are then straight, until none is left.
fn tidy(mut ring: Vec<Point>) -> Vec<Point> {
    loop {
        let n = ring.len();
        let needed = |i: usize| {
            let (a, b, c) = (ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
            let same = |p: f64, q: f64| (p - q).abs() < 1e-9;
            !(same(a.x, b.x) && same(b.x, c.x) || same(a.y, b.y) && same(b.y, c.y))
        };
        // one of two equal corners goes at a time, so that no real corner is lost with its double
        match (0..n).find(|&i| !needed(i)).filter(|_| n > 3) {
            Some(i) => {
                ring.remove(i);
            }
            None => return ring,
        }
    }
}
