//! What the closed shapes of a drawing are, by evidence: rooms, columns, or nothing of the building.
//!
//! Layers that say it come first, then walls, then names. A shape inside another, one too small, and one on a layer of
//! which nothing is known is no room where something better is. What is left out is counted with its layer.

use std::collections::BTreeSet;

use d3dgen_model::{Point, Polygon, Rect};

use crate::drawing::{Drawing, DrawnShape, DrawnSolid, DrawnWall, Evidence, SolidKind, extent};
use crate::shape::{area, area_together, edges, extents, is_simple, share_inside};
use crate::words::is_name;

/// Least floor of a room, m^2.
const LEAST_ROOM_M2: f64 = 1.0;
/// A shape this small on a layer of walls is a column, m^2, unless it is so many times as long as wide.
const COLUMN_M2: f64 = 1.0;
const COLUMN_LONG: f64 = 2.5;
/// Share of a shape that lies in another one when it is inside of it.
const INSIDE: f64 = 0.9;
/// Share of a shape that the shapes inside of it cover when it is the outline of the building.
const OUTLINE: f64 = 0.6;
/// Share of the drawing that shapes with names cover when these are its rooms, whatever walls there are.
const NAMED_SHARE: f64 = 0.3;

/// Sorts the shapes of a drawing in meters: into rooms, walls and columns, and what is left out.
pub(crate) fn decide(drawing: &mut Drawing) {
    walls_of_faces(drawing);
    uncertain_walls(drawing);
    let shapes = std::mem::take(&mut drawing.shapes);
    if shapes.is_empty() {
        return;
    }
    let names: Vec<Point> = drawing.labels.iter().filter(|l| is_name(&l.text)).map(|l| l.at).collect();
    let mut shapes: Vec<DrawnShape> = shapes.into_iter().map(|s| with_names(s, &names)).collect();
    by_layer(&mut shapes);
    let (rooms, others) = chosen(drawing, shapes);
    let (rooms, dropped) = apart(rooms);
    drawing.rooms.extend(rooms.into_iter().map(|s| s.room));
    // where walls are known and enclose nothing in the end, shapes are all that there is
    if drawing.rooms.is_empty() {
        let best = others.iter().filter(|s| !s.curved).map(|s| s.evidence).max();
        let (perhaps, others): (Vec<DrawnShape>, Vec<DrawnShape>) =
            others.into_iter().partition(|s| !s.curved && Some(s.evidence) == best);
        let (unclear, dropped) = apart(perhaps);
        others.iter().chain(&dropped).for_each(|s| drawing.leave_out(s.told()));
        drawing.unclear = unclear;
        return;
    }
    others.iter().chain(&dropped).for_each(|s| drawing.leave_out(s.told()));
}

/// Turns closed shapes on layers of walls into the faces of walls, or into columns.
fn walls_of_faces(drawing: &mut Drawing) {
    let (faces, shapes): (Vec<DrawnShape>, Vec<DrawnShape>) =
        std::mem::take(&mut drawing.shapes).into_iter().partition(|s| s.evidence == Evidence::Wall);
    drawing.shapes = shapes;
    for shape in faces {
        let corners = &shape.room.corners;
        let (long, short) = extents(corners);
        let room = shape.room;
        if area(&room.corners) < COLUMN_M2 && long < COLUMN_LONG * short {
            let (kind, level) = (SolidKind::Column, room.level.clone());
            drawing.solids.push(DrawnSolid { kind, outline: room.corners, level, place: room.place });
            continue;
        }
        drawing.walls.extend(edges(&room.corners).map(|(a, b)| DrawnWall {
            line: [a, b],
            level: room.level.clone(),
            place: room.place.clone(),
        }));
    }
}

/// Takes lines on the layer that every drawing has for walls where no layer says that it has walls or rooms.
fn uncertain_walls(drawing: &mut Drawing) {
    let lines = std::mem::take(&mut drawing.perhaps_walls);
    let known = !drawing.walls.is_empty() || drawing.shapes.iter().any(|s| s.evidence == Evidence::Room);
    if known {
        lines.iter().for_each(|(layer, _)| drawing.leave_out(layer.clone()));
    } else {
        drawing.walls.extend(lines.into_iter().map(|(_, wall)| wall));
    }
}

/// Returns a shape that holds a name as one that has a name.
fn with_names(mut shape: DrawnShape, names: &[Point]) -> DrawnShape {
    if shape.evidence == Evidence::None {
        let outline = Polygon(shape.room.corners.clone());
        if names.iter().any(|p| outline.contains(*p)) {
            shape.evidence = Evidence::Text;
        }
    }
    shape
}

/// Lets a layer speak for all of its shapes: where one has a name, the others of its kind are rooms too.
fn by_layer(shapes: &mut [DrawnShape]) {
    for evidence in [Evidence::Named, Evidence::Text] {
        let named: BTreeSet<(String, String)> =
            shapes.iter().filter(|s| s.evidence == evidence).map(|s| (s.layer.clone(), s.kind.clone())).collect();
        for shape in shapes.iter_mut().filter(|s| s.evidence == Evidence::None && !s.curved) {
            if named.contains(&(shape.layer.clone(), shape.kind.clone())) {
                shape.evidence = evidence;
            }
        }
    }
}

/// Returns the shapes with the best evidence that they are rooms, and the others.
fn chosen(drawing: &Drawing, shapes: Vec<DrawnShape>) -> (Vec<DrawnShape>, Vec<DrawnShape>) {
    let of = |evidence: Evidence| shapes.iter().filter(move |s| s.evidence == evidence);
    let whole = {
        let lines = drawing.walls.iter().flat_map(|w| w.line);
        let all = extent(shapes.iter().flat_map(|s| s.room.corners.iter().copied()).chain(lines));
        all.map_or(0.0, |b| (b[2] - b[0]) * (b[3] - b[1]))
    };
    let named = area_together(of(Evidence::Named).map(|s| &s.room.corners[..]));
    let walls = !drawing.walls.is_empty();
    let found = [
        (Evidence::Room, of(Evidence::Room).next().is_some()),
        (Evidence::Named, named > if walls { NAMED_SHARE * whole } else { 0.0 }),
        (Evidence::Wall, walls),
        (Evidence::Text, of(Evidence::Text).next().is_some()),
    ];
    let least = found.into_iter().find(|f| f.1).map_or(Evidence::None, |f| f.0);
    shapes.into_iter().partition(|s| s.evidence >= least && s.evidence != Evidence::Wall && !s.curved)
}

/// Returns the shapes that are rooms beside one another, and those that are not: small ones, those inside others, those that
/// cross themselves and say nothing of being a room, and the outline around the others.
fn apart(shapes: Vec<DrawnShape>) -> (Vec<DrawnShape>, Vec<DrawnShape>) {
    let areas: Vec<f64> = shapes.iter().map(|s| area(&s.room.corners)).collect();
    let bounds: Vec<Rect> = shapes.iter().map(|s| Polygon(s.room.corners.clone()).bounds()).collect();
    let alone = shapes.len() == 1;
    let mut keep: Vec<bool> = shapes.iter().zip(&areas).map(|(s, area)| alone || may_be_room(s, *area)).collect();
    let mut order: Vec<usize> = (0..shapes.len()).filter(|i| keep[*i]).collect();
    order.sort_by(|a, b| areas[*b].total_cmp(&areas[*a]).then(a.cmp(b)));
    for (at, &outer) in order.iter().enumerate() {
        if !keep[outer] {
            continue;
        }
        let ring = &shapes[outer].room.corners;
        let is_in = |inner: &usize| {
            let own = &shapes[*inner].room.corners;
            let near = bounds[*inner].overlaps(&bounds[outer]);
            keep[*inner] && areas[*inner] < areas[outer] && near && share_inside(own, ring) >= INSIDE
        };
        let inside: Vec<usize> = order[at + 1..].iter().copied().filter(is_in).collect();
        let covered = area_together(inside.iter().map(|i| &shapes[*i].room.corners[..]));
        if inside.len() > 1 && covered >= OUTLINE * areas[outer] {
            continue; // the outline of the building: `rooms` says so
        }
        inside.iter().for_each(|i| keep[*i] = false);
    }
    let mut at = 0;
    shapes.into_iter().partition(|_| {
        at += 1;
        keep[at - 1]
    })
}

/// Returns true for shapes that are whole and large enough, and those that say themselves that they are rooms.
fn may_be_room(shape: &DrawnShape, area: f64) -> bool {
    let large = area >= LEAST_ROOM_M2 || shape.evidence == Evidence::Named;
    shape.evidence == Evidence::Named || large && is_simple(&shape.room.corners)
}
