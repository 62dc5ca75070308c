//! Openings find the wall they lie in.

use d3dgen_model::Point;
use d3dgen_model::scene_graph::Note;

use crate::cells::Stretch;
use crate::drawing::{DrawnOpening, OpeningKind, note};
use crate::layout::{LaidOpening, LaidRoom};

/// An opening belongs to the nearest wall within this distance of its faces, mm.
const REACH: i64 = 300;
/// Narrowest opening that is read, mm.
const NARROWEST: i64 = 300;
/// Width of openings drawn as a point without saying it, mm.
const DOOR: i64 = 900;
const PANE: i64 = 1200;
/// Least distance from a corner to which an opening drawn as a point is moved, mm.
const JAMB: i64 = 100;
/// Ends closer than this to the middle of a crossing wall stop at its face.
const SILL_HIGH_M: f64 = 20.0;

/// Where an opening may be.
struct Fit {
    stretch: usize,
    from: i64,
    to: i64,
    off: i64,
    swing: Option<(Option<usize>, bool)>,
}

/// Puts every opening in its wall; those that find none are left out with a note.
pub(crate) fn attach(
    drawn: &[DrawnOpening],
    stretches: &[Stretch],
    rooms: &[LaidRoom],
    assumed: bool,
    notes: &mut Vec<Note>,
) -> Vec<LaidOpening> {
    let mut moved = 0_usize;
    let mut out: Vec<LaidOpening> = Vec::new();
    for opening in drawn {
        let Some(mut fit) = best(opening, stretches) else {
            let is_window = opening.kind == OpeningKind::Window;
            let why = if is_window { "the window lies in no outer wall" } else { "the door lies in no wall" };
            notes.push(left_out(opening, why));
            continue;
        };
        if assumed && opening.kind == OpeningKind::Door {
            let stretch = &stretches[fit.stretch];
            moved += usize::from(clear_of_corners(&mut fit, stretch, rooms));
        }
        let clash = out.iter().any(|o| o.stretch == fit.stretch && o.from < fit.to && fit.from < o.to);
        if clash {
            notes.push(left_out(opening, "overlaps another opening"));
            continue;
        }
        out.push(laid(opening, fit, stretches));
    }
    if moved > 0 {
        let message = format!(
            "{moved} doors end where walls meet; as the plan does not say how thick walls are, they were moved or narrowed by the \
             thickness that was assumed"
        );
        notes.push(note("doors_moved", message));
    }
    out
}

fn left_out(opening: &DrawnOpening, why: &str) -> Note {
    let p = opening.arc.map(|a| a[0]).or_else(|| opening.points.first().copied()).unwrap_or(Point::new(0.0, 0.0));
    let message = format!("{} at ({:.2}, {:.2}) m: {why}; it was left out", opening.place, p.x, p.y);
    note("opening_left_out", message)
}

fn laid(opening: &DrawnOpening, fit: Fit, stretches: &[Stretch]) -> LaidOpening {
    let meters = |v: Option<f64>| v.filter(|m| m.is_finite() && (0.0..=SILL_HIGH_M).contains(m));
    LaidOpening {
        kind: opening.kind,
        rooms: stretches[fit.stretch].rooms().collect(),
        stretch: fit.stretch,
        from: fit.from,
        to: fit.to,
        sill_m: meters(opening.sill_m),
        head_m: meters(opening.head_m),
        sliding: opening.sliding,
        swing: fit.swing,
    }
}

/// Moves a door along its wall to where the faces of the walls that meet there leave it a jamb; narrows it where that is not
/// enough. Returns whether it did.
fn clear_of_corners(fit: &mut Fit, s: &Stretch, rooms: &[LaidRoom]) -> bool {
    let width = fit.to - fit.from;
    let faces = s.rooms().filter_map(|room| face_beside(fit, s, room, &rooms[room]));
    let Some((low, high)) = faces.reduce(|a, b| (a.0.max(b.0), a.1.min(b.1))) else { return false };
    if fit.from >= low + JAMB && fit.to <= high - JAMB {
        return false;
    }
    let (least, most) = (low + JAMB, high - JAMB);
    let width = width.min(most - least);
    if width < NARROWEST {
        return false;
    }
    fit.from = fit.from.clamp(least, most - width);
    fit.to = fit.from + width;
    true
}

/// Returns from where to where the face of a wall in a room goes that a door lies in, mm.
fn face_beside(fit: &Fit, s: &Stretch, room: usize, laid: &LaidRoom) -> Option<(i64, i64)> {
    let at = s.at + if s.low == Some(room) { -s.half[0] } else { s.half[1] };
    let across = |p: Point| mm(if s.vertical { p.x } else { p.y });
    laid.net_polygon.edges().find_map(|e| {
        let (a, b) = (along(s, e.start), along(s, e.end));
        let (from, to) = (a.min(b), a.max(b));
        let on_wall = (across(e.start) - at).abs() <= 1 && (across(e.end) - at).abs() <= 1;
        (on_wall && from < fit.to && fit.from < to).then_some((from, to))
    })
}

fn best(opening: &DrawnOpening, stretches: &[Stretch]) -> Option<Fit> {
    let window = opening.kind == OpeningKind::Window;
    let fits = (0..stretches.len()).filter(|&k| !window || stretches[k].is_outer()).flat_map(|k| {
        let s = &stretches[k];
        match opening.arc {
            // the leaf closes onto one of the two ends of its arc; the other end is where it stands open
            Some([hinge, a, b]) => [(a, b), (b, a)]
                .into_iter()
                .filter_map(|(shut, open)| {
                    let mut fit = fit(s, k, &[hinge, shut], None)?;
                    let (h, e) = (along(s, hinge), along(s, shut));
                    let high = if s.vertical { open.x > hinge.x } else { open.y > hinge.y };
                    fit.swing = Some((if high { s.high } else { s.low }, h < e));
                    Some(fit)
                })
                .collect::<Vec<_>>(),
            None => {
                let width = opening.width_m.filter(|w| w.is_finite() && (0.3..=20.0).contains(w));
                let usual = if window { PANE } else { DOOR };
                let width = width.map_or(usual, mm);
                fit(s, k, &opening.points, Some(width)).into_iter().collect()
            }
        }
    });
    fits.min_by_key(|f| (f.off, f.stretch))
}

fn mm(v: f64) -> i64 {
    (v * 1000.0).round() as i64
}

fn along(s: &Stretch, p: Point) -> i64 {
    mm(if s.vertical { p.y } else { p.x })
}

/// Returns the part of a stretch that these points mean, or `None` when they lie elsewhere or across it.
fn fit(s: &Stretch, stretch: usize, points: &[Point], width: Option<i64>) -> Option<Fit> {
    let across = |p: &Point| mm(if s.vertical { p.x } else { p.y });
    let (a0, a1) = (points.iter().map(across).min()?, points.iter().map(across).max()?);
    let (from, to) = (points.iter().map(|p| along(s, *p)).min()?, points.iter().map(|p| along(s, *p)).max()?);
    let off = ((a0 + a1) / 2 - s.at).abs();
    let reach = REACH + s.thickness() / 2;
    let middle = (from + to) / 2;
    if off > reach || middle < s.from || middle > s.to {
        return None;
    }
    let dot = to - from < NARROWEST;
    if dot && a1 - a0 >= NARROWEST || !dot && a1 - a0 > (to - from).max(REACH) {
        return None;
    }
    // walls that meet the ends of the stretch take half of their thickness from it
    let (from, to) = if dot { around(s, middle, width?)? } else { (from.max(s.from), to.min(s.to)) };
    (to - from >= NARROWEST).then_some(Fit { stretch, from, to, off, swing: None })
}

/// Returns the part of a stretch around a point that is so wide, as far as the stretch allows.
fn around(s: &Stretch, middle: i64, width: i64) -> Option<(i64, i64)> {
    let width = width.min(s.len() - 2 * JAMB);
    let start = (width >= NARROWEST).then(|| (middle - width / 2).clamp(s.from + JAMB, s.to - JAMB - width))?;
    Some((start, start + width))
}
