//! Robot zones under the furniture; docks, goals and starts above it.

use d3dgen_model::geometry::{Pose, Rect};
use d3dgen_model::scenario::{Poi, RoiKind, Scenario};

use super::page::{Anchor, Frame, Page, Path, Type, on_sheet};
use super::style;
use crate::font::Weight;

/// Figures in goal marks.
const MARK: Type = Type { weight: Weight::SemiBold, fill: style::ROBOT, halo: None };

/// Tints and hatches the robot zones, the large ones first.
pub(super) fn zones(page: &mut Page, frame: &Frame, scenario: &Scenario, k: f64) {
    page.open_group("robot-zones");
    let mut rois: Vec<_> = scenario.rois.iter().collect();
    rois.sort_by_key(|r| r.kind);
    for roi in rois {
        let outline = Path::new().polygon(&on_sheet(frame, &roi.polygon));
        let rects: Vec<Rect> = roi.polygon.rects().iter().map(|r| frame.rect(r)).collect();
        area(page, roi.kind, outline, &rects, k, 0.36);
    }
    page.close_group();
}

/// Draws one zone in the look of its kind, its hatching this opaque; also the swatch of the legend.
pub(super) fn area(page: &mut Page, kind: RoiKind, outline: Path, rects: &[Rect], k: f64, opacity: f64) {
    let (fill, stroke) = style::roi_colors(kind);
    match kind {
        RoiKind::CleaningZone => {
            let lines = rects.iter().fold(Path::new(), |path, r| hatch(path, r, 17.0 * k, false));
            page.path_with(&line(stroke, &opacity.to_string(), 0.9 * k), lines);
        }
        RoiKind::KeepOut => {
            let lines =
                rects.iter().fold(Path::new(), |path, r| hatch(hatch(path, r, 13.0 * k, false), r, 13.0 * k, true));
            page.path_with(&line(stroke, &format!("{:.2}", 0.78 * opacity), 0.9 * k), lines);
        }
        RoiKind::SpeedZone => {
            let look = tint(fill, ".07", &stroke_of(stroke, ".5", 0.8 * k)) + &dashes(1.5 * k, 4.0 * k);
            page.path_with(&look, outline);
        }
        RoiKind::StagingArea => {
            page.path_with(&tint(fill, ".14", &stroke_of(stroke, ".85", 1.1 * k)), outline);
            // a cross from corner to corner, as pallets are marked on floors
            let cross =
                |path: Path, r: &Rect| path.segment((r.x0, r.y0), (r.x1, r.y1)).segment((r.x0, r.y1), (r.x1, r.y0));
            page.path_with(&line(stroke, ".45", 0.8 * k), rects.iter().fold(Path::new(), cross));
        }
        RoiKind::ServiceZone | RoiKind::ChargingBuffer => {
            let look = tint(fill, ".16", &stroke_of(stroke, ".8", 1.1 * k)) + &dashes(5.0 * k, 4.0 * k);
            page.path_with(&look, outline);
        }
    }
}

/// Returns the look of a line: color, opacity, width on the sheet.
fn stroke_of(color: &str, opacity: &str, width: f64) -> String {
    format!("stroke=\"{color}\" stroke-opacity=\"{opacity}\" stroke-width=\"{width:.2}\"")
}

/// Returns the look of lines around nothing.
fn line(color: &str, opacity: &str, width: f64) -> String {
    format!("fill=\"none\" {}", stroke_of(color, opacity, width))
}

/// Returns the look of an area with a line around it.
fn tint(color: &str, opacity: &str, stroke: &str) -> String {
    format!("fill=\"{color}\" fill-opacity=\"{opacity}\" {stroke}")
}

/// Returns what makes a line one of dashes, this long and this far apart on the sheet.
fn dashes(length: f64, gap: f64) -> String {
    format!(" stroke-dasharray=\"{length:.1} {gap:.1}\"")
}

/// Lines at 45 degrees through a rectangle, on one grid for the whole sheet.
fn hatch(mut path: Path, r: &Rect, spacing: f64, falling: bool) -> Path {
    // x + y = c for rising lines, x - y = c for falling ones (y runs down).
    let range = if falling { (r.x0 - r.y1, r.x1 - r.y0) } else { (r.x0 + r.y0, r.x1 + r.y1) };
    let mut i = (range.0 / spacing).ceil();
    while i * spacing < range.1 {
        let c = i * spacing;
        let y = |x: f64| if falling { x - c } else { c - x };
        let (from, to) =
            if falling { (r.x0.max(r.y0 + c), r.x1.min(r.y1 + c)) } else { (r.x0.max(c - r.y1), r.x1.min(c - r.y0)) };
        if to - from > 0.5 {
            path = path.segment((from, y(from)), (to, y(to)));
        }
        i += 1.0;
    }
    path
}

/// Draws where robots charge, start and go; returns the marks' places for the labels to avoid.
pub(super) fn marks(page: &mut Page, frame: &Frame, scenario: &Scenario, size: f64) -> Vec<Rect> {
    page.open_group("robot-marks");
    let mut taken = Vec::new();
    let mut around = |c: (f64, f64), r: f64| taken.push(Rect::new(c.0 - r, c.1 - r, c.0 + r, c.1 + r));
    for poi in scenario.pois.iter().filter(|p| p.kind == Poi::DOCK) {
        let at = frame.map(super::at(&poi.pose));
        dock(page, at, 0.75 * size);
        around(at, size);
    }
    for (robot, letter) in scenario.robots.iter().zip(letters(scenario)) {
        for (i, id) in robot.goals.iter().enumerate() {
            let Some(poi) = scenario.pois.iter().find(|p| &p.poi_id == id && p.kind != Poi::DOCK) else { continue };
            let at = frame.map(super::at(&poi.pose));
            goal(page, at, &format!("{letter}{}", i + 1), 0.62 * size);
            around(at, size);
        }
        let radius = (robot.robot.radius_m * frame.scale).max(0.5 * size);
        start(page, frame, &robot.start, radius);
        around(frame.map(super::at(&robot.start)), radius);
    }
    page.close_group();
    taken
}

/// A green disc with a bolt.
pub(super) fn dock(page: &mut Page, (x, y): (f64, f64), r: f64) {
    page.path("ck", Path::new().circle((x, y), r));
    let bolt = [(0.12, -0.72), (-0.42, 0.12), (-0.04, 0.12), (-0.12, 0.72), (0.42, -0.12), (0.04, -0.12)];
    page.path("wt", Path::new().polygon(&bolt.map(|(a, b)| (x + a * r, y + b * r))));
}

/// Returns what the stops of each robot are called by before their number: a letter where there are several robots.
fn letters(scenario: &Scenario) -> impl Iterator<Item = String> {
    let several = scenario.robots.len() > 1;
    ('A'..='Z').cycle().map(move |letter| if several { letter.to_string() } else { String::new() })
}

/// A ring with the goal's name.
pub(super) fn goal(page: &mut Page, (x, y): (f64, f64), name: &str, r: f64) {
    page.path("ro", Path::new().circle((x, y), r));
    let size = [1.25, 1.0, 0.8].get(name.len().saturating_sub(1)).copied().unwrap_or(0.65) * r;
    page.text(name, (x, y + 0.36 * size), size, MARK, Anchor::Middle);
}

/// A robot as large as it is, with its heading.
pub(super) fn start(page: &mut Page, frame: &Frame, pose: &Pose, r: f64) {
    let (x, y) = frame.map(super::at(pose));
    let (sin, cos) = super::pen::turn(pose.yaw_rad);
    robot(page, (x, y), (cos, -sin), r);
}

/// A disc with a wedge that points along a unit vector on the sheet.
pub(super) fn robot(page: &mut Page, (x, y): (f64, f64), (dx, dy): (f64, f64), r: f64) {
    page.path("rs", Path::new().circle((x, y), r));
    let at = |along: f64, across: f64| (x + (dx * along - dy * across) * r, y + (dy * along + dx * across) * r);
    page.path("rd", Path::new().polygon(&[at(0.62, 0.0), at(-0.34, 0.42), at(-0.12, 0.0), at(-0.34, -0.42)]));
}
