//! A plan as a small SVG: floors, walls, doors with their swings, windows, objects, room names. Nothing but lines and
//! text, a few kilobytes, colored by the page's own style sheet.

use std::fmt::Write;

use d3dgen_model::domain::Mount;
use d3dgen_model::floorplan::{Door, DoorKind};
use d3dgen_model::world::World;
use d3dgen_model::{Point, Rect};

use crate::evaluation::WorldMeasures;
use crate::html::escape;
use crate::metrics::navigability::around;
use crate::solid::{Scene, Solid, along};
use crate::storeys::side_by_side;

/// Free space around the building, cm.
const MARGIN: f64 = 30.0;

/// Returns the plan of a world; objects and doors that a measure found fault with are marked.
pub fn svg(world: &World, measures: &WorldMeasures) -> String {
    let laid_out = side_by_side(world);
    let (scene, world) = (Scene::new(&laid_out), &*laid_out);
    let outer: Vec<Rect> = world.floorplan.walls.iter().map(|w| along(&w.line, w.thickness_m / 2.0)).collect();
    let bounds = around(outer.iter().chain(scene.floor()));
    let (width, height) = (bounds.width() * 100.0 + 2.0 * MARGIN, bounds.height() * 100.0 + 2.0 * MARGIN);
    let mut page = Page {
        origin: (bounds.x0, bounds.y1),
        text: format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plan\" viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" aria-label=\"plan of {}\">",
            escape(&world.name)
        ),
    };
    for (room, rects) in world.floorplan.rooms.iter().zip(&scene.rooms) {
        page.rects(if room.circulation { "c" } else { "f" }, rects.iter());
    }
    page.rects("f", scene.thresholds.iter());
    page.rects("w", outer.iter());
    let glass: Vec<Rect> = world.floorplan.windows.iter().map(|w| along(&w.line, w.wall_thickness_m / 2.0)).collect();
    page.rects("g", glass.iter());
    let faults = faults(measures);
    for door in world.floorplan.doors.iter().filter(|d| d.swing.is_some()) {
        page.swing(door, opens_left(&scene, door), faults.contains(&door.door_id.as_str()));
    }
    page.objects("o", scene.solids.iter().filter(|s| s.placement.mount == Mount::Floor));
    page.objects("p", scene.solids.iter().filter(|s| s.placement.mount != Mount::Floor && !hangs_high(s)));
    page.objects("x", scene.solids.iter().filter(|s| faults.contains(&s.placement.placement_id.as_str())));
    for (room, rects) in world.floorplan.rooms.iter().zip(&scene.rooms) {
        if let Some(largest) = rects.iter().max_by(|a, b| a.area().total_cmp(&b.area())) {
            page.label(largest, &room.name);
        }
    }
    page.text + "</svg>"
}

/// Returns true for what hangs above one's head: it would only hide what stands below.
fn hangs_high(s: &Solid<'_>) -> bool {
    s.z0 > 1.9
}

/// Returns true when the leaf opens to the left of the door's line: where its room is, or where none is for outdoors.
fn opens_left(scene: &Scene<'_>, door: &Door) -> bool {
    let (a, b, m) = (door.line.start, door.line.end, door.line.middle());
    let k = (door.wall_thickness_m / 2.0 + 0.1) / door.line.length().max(1e-9);
    let left = Point::new(m.x - (b.y - a.y) * k, m.y + (b.x - a.x) * k);
    let holds = |r: &Rect| r.x0 <= left.x && left.x <= r.x1 && r.y0 <= left.y && left.y <= r.y1;
    match door.swing.as_ref().and_then(|s| s.into_room_id.as_deref()) {
        Some(into) => {
            let rooms = scene.world.floorplan.rooms.iter().zip(&scene.rooms);
            rooms.filter(|(r, _)| r.room_id == into).any(|(_, rects)| rects.iter().any(holds))
        }
        None => !scene.rooms.iter().flatten().any(holds),
    }
}

/// Returns the ids that a measure names.
fn faults(m: &WorldMeasures) -> Vec<&str> {
    let pairs = m.collisions.pairs.iter().flatten();
    let ids =
        pairs.chain(&m.out_of_bounds.objects).chain(&m.support.unsupported).chain(m.openings.blocked.iter().flatten());
    ids.map(String::as_str).collect()
}

struct Page {
    /// West and north edge of the building, m.
    origin: (f64, f64),
    text: String,
}

impl Page {
    fn at(&self, p: Point) -> (i64, i64) {
        let round = |v: f64| (v * 100.0 + MARGIN).round() as i64;
        (round(p.x - self.origin.0), round(self.origin.1 - p.y))
    }

    /// Draws rectangles as one path.
    fn rects<'a>(&mut self, class: &str, rects: impl Iterator<Item = &'a Rect>) {
        let mut d = String::new();
        for r in rects {
            let (x0, y0) = self.at(Point::new(r.x0, r.y1));
            let (x1, y1) = self.at(Point::new(r.x1, r.y0));
            let _ = write!(d, "M{x0} {y0}H{x1}V{y1}H{x0}z"); // writing to a string cannot fail
        }
        self.path(class, &d);
    }

    /// Draws the outlines of objects as one path, each with a tick at its front.
    fn objects<'a>(&mut self, class: &str, solids: impl Iterator<Item = &'a Solid<'a>>) {
        let mut d = String::new();
        for s in solids {
            for (i, corner) in s.quad.iter().enumerate() {
                let (x, y) = self.at(*corner);
                let _ = write!(d, "{}{x} {y}", if i == 0 { 'M' } else { 'L' });
            }
            d.push('z');
        }
        self.path(class, &d);
    }

    fn path(&mut self, class: &str, d: &str) {
        if !d.is_empty() {
            let _ = write!(self.text, "<path class=\"{class}\" d=\"{d}\"/>");
        }
    }

    /// Draws the leaves of a door, open, with the arcs they sweep.
    fn swing(&mut self, door: &Door, left: bool, fault: bool) {
        let Some(swing) = &door.swing else { return };
        let (a, b) = (door.line.start, door.line.end);
        let (dx, dy) = ((b.x - a.x) / door.line.length().max(1e-9), (b.y - a.y) / door.line.length().max(1e-9));
        let side = if left { 1.0 } else { -1.0 };
        let (nx, ny) = (-dy * side, dx * side);
        let leaf = |hinge: Point, (ux, uy): (f64, f64), length: f64| {
            let tip = Point::new(hinge.x + nx * length, hinge.y + ny * length);
            let closed = Point::new(hinge.x + ux * length, hinge.y + uy * length);
            (hinge, tip, closed, length)
        };
        let leaves = match (door.kind, swing.hinge_at_start) {
            (DoorKind::DoubleHinged, _) => {
                let half = door.line.length() / 2.0;
                vec![leaf(a, (dx, dy), half), leaf(b, (-dx, -dy), half)]
            }
            (_, true) => vec![leaf(a, (dx, dy), door.line.length())],
            (_, false) => vec![leaf(b, (-dx, -dy), door.line.length())],
        };
        let mut d = String::new();
        for (hinge, tip, closed, length) in leaves {
            let ((hx, hy), (tx, ty), (cx, cy)) = (self.at(hinge), self.at(tip), self.at(closed));
            let cross = (tx - hx) * (cy - hy) - (ty - hy) * (cx - hx);
            let r = (length * 100.0).round();
            let _ = write!(d, "M{hx} {hy}L{tx} {ty}A{r} {r} 0 0 {} {cx} {cy}", u8::from(cross > 0));
        }
        self.path(if fault { "s x" } else { "s" }, &d);
    }

    fn label(&mut self, rect: &Rect, name: &str) {
        let (x, y) = self.at(rect.center());
        let fit = rect.width() * 100.0 / (name.chars().count().max(1) as f64 * 0.55);
        let size = fit.clamp(14.0, 34.0).round();
        let _ = write!(self.text, "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\">{}</text>", escape(name));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::measure;
    use crate::sample;

    #[test]
    fn a_plan_is_small_and_shows_what_is_wrong() {
        let mut world = sample::world();
        let picture = |world: &World| svg(world, &measure(world, None, "a", &Default::default()));
        let sound = picture(&world);
        assert!(sound.len() < 2500, "{} bytes", sound.len());
        assert!(sound.contains(">a_1</text>") && !sound.contains("class=\"x\""));
        // the door between the rooms is hinged at (4, 1) and opens west into the first room
        assert!(sound.contains("M440 240L340 240A100 100 0 0 1 440 140"), "{sound}");
        sample::object_mut(&mut world, "table").pose.z = 0.5;
        world.name = "a<b".into();
        let faulty = picture(&world);
        assert!(faulty.contains("class=\"x\"") && faulty.contains("a&lt;b"));
    }
}
