//! From a layout on the lattice to the floorplan document.

use d3dgen_knowledge::freespace::FreeSpace;
use d3dgen_model::Segment;
use d3dgen_model::domain::{Daylight, Zone};
use d3dgen_model::floorplan::{CostTerm, Door, Floorplan, PlanRoom, Wall, Window};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::measures::MOST_ELONGATED;
use d3dgen_model::seed::Stream;
use d3dgen_model::slides;

use super::cost::{OVERHANG, Score, TERMS};
use super::doors::{Site, place_doors, shut_courts};
use super::lattice::{Cellbox, INNER_HALF_M, OUTER_HALF_M, meters, up};
use super::outline::{Mosaic, Stretch, outline};
use super::spec::Brief;
use super::windows::place_windows;
use crate::numbers::highest;

/// How a plan is turned before it is written, so that not every building has its corridor from west to east.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turn {
    pub flip_x: bool,
    pub flip_y: bool,
    pub swap: bool,
}

/// Returns the boxes turned and moved so that the building's south-west corner is the origin.
pub(crate) fn turned(boxes: &[(usize, Cellbox)], turn: Turn) -> Vec<(usize, Cellbox)> {
    let mut out = turned_in_place(boxes, turn);
    let x0 = out.iter().map(|(_, b)| b.x0).min().unwrap_or(0);
    let y0 = out.iter().map(|(_, b)| b.y0).min().unwrap_or(0);
    for (_, b) in &mut out {
        *b = Cellbox::new(b.x0 - x0, b.y0 - y0, b.x1 - x0, b.y1 - y0);
    }
    out
}

/// Returns the boxes turned about the origin.
pub(crate) fn turned_in_place(boxes: &[(usize, Cellbox)], turn: Turn) -> Vec<(usize, Cellbox)> {
    boxes
        .iter()
        .map(|(room, b)| {
            let (xa, xb) = if turn.flip_x { (-b.x1, -b.x0) } else { (b.x0, b.x1) };
            let (ya, yb) = if turn.flip_y { (-b.y1, -b.y0) } else { (b.y0, b.y1) };
            let b = if turn.swap { Cellbox::new(ya, xa, yb, xb) } else { Cellbox::new(xa, ya, xb, yb) };
            (*room, b)
        })
        .collect()
}

/// A plan that is being changed: what still stands of it stays, with its ids.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Earlier<'a> {
    pub plan: &'a Floorplan,
    /// By room of the brief: true for those that stay to the millimeter.
    pub kept: &'a [bool],
}

/// Returns the finished plan, or why these boxes cannot become one.
pub(crate) fn assemble(
    brief: &Brief,
    boxes: &[(usize, Cellbox)],
    score: &Score,
    seed: u64,
    scheme: &str,
    earlier: Option<&Earlier<'_>>,
    rng: &mut Stream,
) -> Result<Floorplan, String> {
    let mosaic = Mosaic::new(boxes);
    let stretches = mosaic.stretches();
    let mut rooms = Vec::with_capacity(brief.rooms.len());
    for (i, spec) in brief.rooms.iter().enumerate() {
        let ring = outline(i, &stretches).ok_or_else(|| format!("{} is not one simple polygon", spec.id))?;
        let net_polygon = ring.net_polygon();
        if !net_polygon.is_simple() {
            return Err(format!("a part of {} is no wider than its walls", spec.id));
        }
        let net_area_m2 = to_mm(net_polygon.signed_area());
        let proportion = FreeSpace::new(&net_polygon, &[]).proportion();
        if proportion > MOST_ELONGATED && !spec.circulation && spec.zone != Zone::Circulation {
            return Err(format!("{} is {proportion:.1} times as long as wide", spec.id));
        }
        let polygon = ring.polygon();
        let old = earlier.and_then(|e| e.plan.room(&spec.id));
        if let Some(same) = old.filter(|r| r.polygon == polygon && r.net_polygon == net_polygon) {
            rooms.push(same.clone());
            continue;
        }
        if earlier.is_some_and(|e| e.kept[i]) {
            return Err(format!("locked {} would not stay as it is", spec.id));
        }
        rooms.push(PlanRoom {
            room_id: spec.id.clone(),
            room_type: spec.room_type.clone(),
            name: spec.name.clone(),
            circulation: spec.circulation,
            polygon,
            net_area_m2,
            net_polygon,
            ceiling_height_m: spec.ceiling_height.max(spec.limits.ceiling_height(net_area_m2).unwrap_or(0.0)),
            materials: spec.materials.clone(),
            locked: false,
            level: 0,
        });
    }
    let net_m2: Vec<f64> = rooms.iter().map(|r| r.net_area_m2).collect();
    let standing = earlier.map_or(&[][..], |e| &e.plan.doors);
    let mut doors = place_doors(&Site { brief, boxes, stretches: &stretches, net_m2: &net_m2, standing }, rng)?;
    let shafts = mosaic.shafts(up(brief.court_width));
    let in_shaft = |s: &Stretch| s.court.is_some_and(|court| shafts.contains(&court));
    let open: Vec<Stretch> = stretches.iter().filter(|s| !in_shaft(s)).copied().collect();
    let mut windows = place_windows(brief, &open, &net_m2, &doors);
    let dark = |i: &usize| {
        let needs = brief.rooms[*i].daylight == Daylight::Required;
        needs && !windows.iter().any(|w| w.room_id == brief.rooms[*i].id)
    };
    if let Some(i) = (0..brief.rooms.len()).find(dark).filter(|_| earlier.is_none()) {
        return Err(format!("the outer wall of {} has no place for a window", brief.rooms[i].id));
    }
    let mut walls = walls(brief, &stretches, &doors);
    slides::aim(&mut doors, &walls);
    if let Some(earlier) = earlier {
        keep_windows(&mut windows, &rooms, &doors, earlier.plan);
        keep_wall_ids(&mut walls, earlier.plan);
    }
    let cost = costs(brief, score);
    let conflicts = brief.conflicts.iter().cloned().chain(shut_courts(&open, &doors)).collect();
    Ok(Floorplan {
        version: 1,
        seed,
        scheme: scheme.into(),
        rooms,
        walls,
        doors,
        windows,
        obstacles: Vec::new(),
        cost,
        conflicts,
        levels: Vec::new(),
        links: Vec::new(),
    })
}

/// Returns what a plan costs, term by term.
pub(crate) fn costs(brief: &Brief, score: &Score) -> Vec<CostTerm> {
    let cost = TERMS.iter().zip(score.weighted()).map(|(t, c)| CostTerm { term: (*t).into(), cost: to_mm(c) });
    let hangs = brief.core.as_ref().is_some_and(|c| c.below.is_some());
    let overhang = CostTerm { term: "overhang".into(), cost: to_mm(OVERHANG * score.overhang) };
    let symmetry = CostTerm { term: "symmetry".into(), cost: to_mm(score.symmetry) };
    cost.chain(hangs.then_some(overhang)).chain(brief.symmetry.map(|_| symmetry)).collect()
}

/// Puts the windows of rooms that did not change back, where no new door stands in them.
fn keep_windows(windows: &mut Vec<Window>, rooms: &[PlanRoom], doors: &[Door], earlier: &Floorplan) {
    let same = |id: &str| {
        let now = rooms.iter().find(|r| r.room_id == id);
        now.zip(earlier.room(id)).is_some_and(|(a, b)| a.polygon == b.polygon && a.net_polygon == b.net_polygon)
    };
    let clear = |w: &Window| {
        let b = w.line;
        doors.iter().all(|d| {
            d.line.is_vertical() != b.is_vertical()
                || d.line.middle().distance(b.middle()) > (d.line.length() + b.length()) / 2.0
        })
    };
    windows.retain(|w| !same(&w.room_id));
    let standing = earlier.windows.iter().filter(|w| same(&w.room_id) && clear(w)).cloned();
    let fresh: Vec<Window> = std::mem::take(windows);
    windows.extend(standing);
    let next = 1 + highest(earlier.windows.iter().map(|w| w.window_id.as_str()));
    windows.extend((next..).zip(fresh).map(|(n, window)| Window { window_id: format!("window_{n}"), ..window }));
}

/// Gives walls that stand where they stood their ids and locks back; the others get new ids.
fn keep_wall_ids(walls: &mut [Wall], earlier: &Floorplan) {
    let mut next = 1 + highest(earlier.walls.iter().map(|w| w.wall_id.as_str()));
    for wall in walls {
        match earlier.walls.iter().find(|w| w.line == wall.line && w.room_ids == wall.room_ids) {
            Some(same) => wall.clone_from(same),
            None => {
                wall.wall_id = format!("wall_{next}");
                next += 1;
            }
        }
    }
}

/// Returns wall pieces with the doors cut out; windows stay part of their wall, which goes on below the sill.
fn walls(brief: &Brief, stretches: &[Stretch], doors: &[Door]) -> Vec<Wall> {
    let mut walls = Vec::new();
    for s in stretches {
        let along = |p: d3dgen_model::Point| if s.vertical { p.y } else { p.x };
        let across = |p: d3dgen_model::Point| if s.vertical { p.x } else { p.y };
        let (mut from, end) = (meters(s.from), meters(s.to));
        let mut cuts: Vec<(f64, f64)> = doors
            .iter()
            .filter(|d| d.line.is_vertical() == s.vertical && (across(d.line.start) - meters(s.at)).abs() < 1e-6)
            .map(|d| (along(d.line.start), along(d.line.end)))
            .filter(|(a, b)| *a >= from - 1e-6 && *b <= end + 1e-6)
            .collect();
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
        cuts.push((end, end));
        for (a, b) in cuts {
            if a - from > 1e-6 {
                let half = if s.is_outer() { OUTER_HALF_M } else { INNER_HALF_M };
                walls.push(Wall {
                    wall_id: format!("wall_{}", walls.len() + 1),
                    line: Segment { start: s.point(from), end: s.point(a) },
                    thickness_m: 2.0 * half,
                    room_ids: [s.low, s.high].into_iter().flatten().map(|r| brief.rooms[r].id.clone()).collect(),
                    exterior: s.is_outer(),
                    locked: false,
                });
            }
            from = b;
        }
    }
    walls
}
