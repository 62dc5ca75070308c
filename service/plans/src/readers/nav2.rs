//! Occupancy map of nav2 (`map.yaml` with its PGM or PNG): free floor, cut at narrow places into rooms.
//!
//! Approximate by nature: a map knows neither names nor windows, furniture looks like walls, and an open door like a
//! passage. Every distance is in cells until the rooms are drawn.

use std::collections::VecDeque;

use d3dgen_model::Point;
use serde::Deserialize;

use super::{Plan, Reader, Source};
use crate::drawing::{Drawing, DrawnOpening, DrawnRoom, OpeningKind, note};
use crate::{Error, Options};

pub(super) const READER: Reader = Reader { name: "nav2", title: "nav2 occupancy map (map.yaml)", recognizes, read };

const FORMAT: &str = "nav2";
/// Most cells of a map, and the largest cell, m.
const MOST_CELLS: usize = 16_000_000;
const COARSEST_M: f64 = 0.5;
/// A passage up to this wide parts two rooms, m; up to the second width it is a door, else an open passage.
const PARTING_M: f64 = 1.25;
const DOOR_M: f64 = 1.6;
/// Least floor of a room, m^2.
const LEAST_ROOM_M2: f64 = 1.0;
/// Steps of an outline smaller than this are noise, m.
const NOISE_M: f64 = 0.3;
/// Most corners of a traced outline.
const MOST_CORNERS: usize = 1500;

#[derive(Deserialize)]
struct Map {
    image: String,
    resolution: f64,
    #[serde(default)]
    origin: Vec<f64>,
    #[serde(default)]
    negate: i64,
    #[serde(default = "free_thresh")]
    free_thresh: f64,
}

fn free_thresh() -> f64 {
    0.25
}

fn recognizes(source: &Source) -> bool {
    let head = source.head();
    source.has_ending(&[".yaml", ".yml"]) && head.contains("image:") && head.contains("resolution:")
}

/// Free cells, row 0 in the south.
struct Grid {
    width: usize,
    height: usize,
    free: Vec<bool>,
}

fn read(source: &Source, options: &Options) -> Result<Plan, Error> {
    let map: Map = serde_saphyr::from_str(source.text(FORMAT)?)
        .map_err(|e| Error::broken(FORMAT, source.name, e.to_string().lines().next().unwrap_or_default().to_owned()))?;
    let resolution = options.meters_per_unit.unwrap_or(map.resolution);
    if !(resolution.is_finite() && resolution > 0.001 && resolution <= COARSEST_M) {
        let message = format!("{resolution} m a cell; rooms can be traced at 0.001 to {COARSEST_M} m");
        return Err(Error::broken(FORMAT, "resolution", message));
    }
    let bytes = (source.companion)(&map.image)
        .ok_or_else(|| Error::broken(FORMAT, "image", format!("`{}` is not beside the yaml file", map.image)))?;
    let (width, height, gray) = picture(&bytes, &map.image)?;
    let value = |g: u8| if map.negate == 0 { 255 - g } else { g };
    let mut free = vec![false; width * height];
    for row in 0..height {
        for column in 0..width {
            let occupied = f64::from(value(gray[row * width + column])) / 255.0;
            free[(height - 1 - row) * width + column] = occupied < map.free_thresh;
        }
    }
    let grid = Grid { width, height, free };
    let labels = rooms(&grid, resolution);
    let origin = Point::new(map.origin.first().copied().unwrap_or(0.0), map.origin.get(1).copied().unwrap_or(0.0));
    if map.origin.get(2).is_some_and(|yaw| yaw.abs() > 1e-6) {
        return Err(Error::broken(FORMAT, "origin", "is turned; rooms are traced of maps with a yaw of 0"));
    }
    let meters = |x: f64, y: f64| Point::new(origin.x + x * resolution, origin.y + y * resolution);
    let mut drawing = Drawing::default();
    let count = labels.iter().flatten().max().map_or(0, |m| m + 1);
    for (room, ring) in outlines(&grid, &labels, count)? {
        drawing.rooms.push(DrawnRoom {
            label: format!("room_{}", room + 1),
            kind: None,
            corners: settle(ring.into_iter().map(|(x, y)| meters(x as f64, y as f64)).collect()),
            level: None,
            height_m: None,
            place: format!("room_{}", room + 1),
        });
    }
    if drawing.rooms.is_empty() {
        return Err(Error::broken(FORMAT, map.image, "has no free floor as large as a room"));
    }
    openings(&grid, &labels, resolution, &mut drawing, &meters);
    drawing.notes.push(note(
        "traced",
        format!(
            "{} rooms were traced of an occupancy map: approximate, without names, windows and closed doors; floor is cut \
             where it is less than {PARTING_M} m wide",
            drawing.rooms.len()
        ),
    ));
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

/// Returns for each cell the distance to the nearest cell that is not free, in cells (chessboard).
fn distances(grid: &Grid) -> Vec<u32> {
    let (w, h) = (grid.width, grid.height);
    let mut out: Vec<u32> = grid.free.iter().map(|f| if *f { u32::MAX / 2 } else { 0 }).collect();
    let relax = |out: &mut Vec<u32>, i: usize, j: usize, from: &[(isize, isize)]| {
        let k = j * w + i;
        if out[k] == 0 {
            return;
        }
        for (di, dj) in from {
            let (x, y) = (i as isize + di, j as isize + dj);
            let near =
                if x < 0 || y < 0 || x >= w as isize || y >= h as isize { 0 } else { out[y as usize * w + x as usize] };
            out[k] = out[k].min(near + 1);
        }
    };
    for j in 0..h {
        for i in 0..w {
            relax(&mut out, i, j, &[(-1, 0), (-1, -1), (0, -1), (1, -1)]);
        }
    }
    for j in (0..h).rev() {
        for i in (0..w).rev() {
            relax(&mut out, i, j, &[(1, 0), (1, 1), (0, 1), (-1, 1)]);
        }
    }
    out
}

/// Returns the room of each cell: free floor wider than a door, grown back into the narrow places around it.
fn rooms(grid: &Grid, resolution: f64) -> Vec<Option<usize>> {
    let (w, h) = (grid.width, grid.height);
    let distance = distances(grid);
    let core = (PARTING_M / 2.0 / resolution).ceil() as u32;
    let mut labels: Vec<Option<usize>> = vec![None; w * h];
    let mut seeds: VecDeque<usize> = VecDeque::new();
    let mut count = 0;
    let least = (LEAST_ROOM_M2 / resolution / resolution) as usize;
    let around = |k: usize| {
        let (i, j) = (k % w, k / w);
        [(i > 0, k.wrapping_sub(1)), (i + 1 < w, k + 1), (j > 0, k.wrapping_sub(w)), (j + 1 < h, k + w)]
            .into_iter()
            .filter(|n| n.0)
            .map(|n| n.1)
    };
    for start in 0..w * h {
        if labels[start].is_some() || distance[start] <= core {
            continue;
        }
        labels[start] = Some(count);
        let mut todo = vec![start];
        while let Some(k) = todo.pop() {
            seeds.push_back(k);
            for n in around(k) {
                if labels[n].is_none() && distance[n] > core {
                    labels[n] = Some(count);
                    todo.push(n);
                }
            }
        }
        count += 1;
    }
    // grow back layer by layer: the floor of a room before the doorway beyond it
    let mut layers: Vec<VecDeque<usize>> = vec![VecDeque::new(); core as usize + 1];
    layers[core as usize].extend(seeds);
    for depth in (1..=core as usize).rev() {
        while let Some(k) = layers[depth].pop_front() {
            for n in around(k) {
                if labels[n].is_none() && grid.free[n] {
                    if distance[n] as usize >= depth {
                        labels[n] = labels[k];
                        layers[depth].push_back(n);
                    } else {
                        layers[depth - 1].push_back(k);
                    }
                }
            }
        }
        let again = std::mem::take(&mut layers[depth - 1]);
        let mut seen: Vec<usize> = again.into();
        seen.sort_unstable();
        seen.dedup();
        layers[depth - 1] = seen.into();
    }
    renumber(&mut labels, count, least);
    labels
}

/// Leaves out rooms that are too small and numbers the others from the south-west.
fn renumber(labels: &mut [Option<usize>], count: usize, least: usize) {
    let mut sizes = vec![0_usize; count];
    labels.iter().flatten().for_each(|l| sizes[*l] += 1);
    let mut names: Vec<Option<usize>> = vec![None; count];
    let mut next = 0;
    for label in labels.iter_mut() {
        let Some(old) = *label else { continue };
        if sizes[old] < least {
            *label = None;
            continue;
        }
        let name = *names[old].get_or_insert_with(|| {
            next += 1;
            next - 1
        });
        *label = Some(name);
    }
}

/// A room with the corners of its outline, in cells.
type Traced = (usize, Vec<(i64, i64)>);

/// Returns the outer outline of each room, counter-clockwise, in cells.
fn outlines(grid: &Grid, labels: &[Option<usize>], count: usize) -> Result<Vec<Traced>, Error> {
    let (w, h) = (grid.width as i64, grid.height as i64);
    let at = |i: i64, j: i64| if i < 0 || j < 0 || i >= w || j >= h { None } else { labels[(j * w + i) as usize] };
    let mut starts: Vec<Option<(i64, i64)>> = vec![None; count];
    for j in 0..h {
        for i in 0..w {
            if let Some(room) = at(i, j) {
                starts[room].get_or_insert((i, j));
            }
        }
    }
    let mut out = Vec::new();
    for (room, start) in starts.into_iter().enumerate() {
        let Some(start) = start else { continue };
        // along the boundary with the room on the left, from the lowest and then westernmost corner eastwards
        let inside = |i: i64, j: i64| at(i, j) == Some(room);
        let (mut p, mut d) = (start, (1_i64, 0_i64));
        let mut ring = Vec::new();
        for _ in 0..4 * (w + 1) * (h + 1) {
            let next = (p.0 + d.0, p.1 + d.1);
            // cells ahead of the next corner, on its left and right
            let cell = |side: i64| {
                let (lx, ly) = (-d.1 * side, d.0 * side);
                ((2 * next.0 + d.0 + lx - 1).div_euclid(2), (2 * next.1 + d.1 + ly - 1).div_euclid(2))
            };
            let (left, right) = (cell(1), cell(-1));
            let turn = if inside(right.0, right.1) && inside(left.0, left.1) {
                Some((d.1, -d.0))
            } else if inside(left.0, left.1) {
                None
            } else {
                Some((-d.1, d.0))
            };
            p = next;
            if let Some(turn) = turn {
                ring.push(p);
                d = turn;
            }
            if p == start && d == (1, 0) {
                break;
            }
        }
        out.push((room, ring));
    }
    Ok(out)
}

/// Takes the steps out of an outline that are noise: sides close to a longer parallel one move onto it.
fn settle(ring: Vec<Point>) -> Vec<Point> {
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
    tidy(out)
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

/// Adds an opening for each run of cells where two rooms meet, or a room meets the floor outdoors.
fn openings(
    grid: &Grid,
    labels: &[Option<usize>],
    resolution: f64,
    drawing: &mut Drawing,
    meters: &impl Fn(f64, f64) -> Point,
) {
    use std::collections::BTreeMap;
    let (w, h) = (grid.width, grid.height);
    let mut meets: BTreeMap<(usize, usize), Vec<(f64, f64)>> = BTreeMap::new();
    let mut meet = |a: usize, b: usize, at: (f64, f64)| {
        if let (Some(p), Some(q)) = (labels[a], labels[b])
            && p != q
        {
            meets.entry((p.min(q), p.max(q))).or_default().push(at);
        }
    };
    for j in 0..h {
        for i in 0..w {
            let k = j * w + i;
            if i + 1 < w {
                meet(k, k + 1, (i as f64 + 1.0, j as f64 + 0.5));
            }
            if j + 1 < h {
                meet(k, k + w, (i as f64 + 0.5, j as f64 + 1.0));
            }
        }
    }
    for ((a, b), points) in meets {
        for group in runs(points, 0.4 / resolution) {
            let x = group.iter().map(|p| p.0).fold((f64::MAX, f64::MIN), |b, v| (b.0.min(v), b.1.max(v)));
            let y = group.iter().map(|p| p.1).fold((f64::MAX, f64::MIN), |b, v| (b.0.min(v), b.1.max(v)));
            let along_x = x.1 - x.0 >= y.1 - y.0;
            let (mx, my) = ((x.0 + x.1) / 2.0, (y.0 + y.1) / 2.0);
            let (from, to) = if along_x {
                (meters(x.0 - 0.5, my), meters(x.1 + 0.5, my))
            } else {
                (meters(mx, y.0 - 0.5), meters(mx, y.1 + 0.5))
            };
            let kind = if from.distance(to) <= DOOR_M { OpeningKind::Door } else { OpeningKind::Passage };
            let place = format!("between room_{} and room_{}", a + 1, b + 1);
            drawing.openings.push(DrawnOpening::new(kind, vec![from, to], None, place));
        }
    }
}

/// Parts points into groups that are connected by steps of at most `reach`; the points come row by row.
fn runs(points: Vec<(f64, f64)>, reach: f64) -> Vec<Vec<(f64, f64)>> {
    let mut groups: Vec<Vec<(f64, f64)>> = Vec::new();
    for p in points {
        let near = |g: &Vec<(f64, f64)>| {
            g.iter().rev().take(200).any(|q| (q.0 - p.0).abs() <= reach.max(1.5) && (q.1 - p.1).abs() <= reach.max(1.5))
        };
        match groups.iter_mut().find(|g| near(g)) {
            Some(group) => group.push(p),
            None => groups.push(vec![p]),
        }
    }
    groups
}
