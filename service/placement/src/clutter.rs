//! Small everyday things on furniture that stands, by the domain's clutter lines: in rows along the back of a shelf, in
//! stacks, at each seat. And their opposite: the things a tidy room does without.
//!
//! It moves nothing and takes no floor, so that a cluttered room has the furniture of an ordinary one.

use std::rc::Rc;

use d3dgen_model::domain::{Arrangement, ClutterLine, ClutterPattern, Mount, ObjectType, RoomType, Shape};

use super::demand::Task;
use super::geom::{Box2, turn};
use super::nav::Nav;
use super::search::{Job, LEVELS, Outcome};
use super::seats::is_seat;
use super::state::{Placed, State, at_frame};
use super::style::grain;
use super::unit::{Forms, Part, Unit, variants};

/// Distance kept from the edge of a top, mm.
const EDGE: i32 = 25;
/// Distance between things side by side, mm.
const GAP: i32 = 25;
/// Step in which a place is sought along an edge, mm.
const STEP: i32 = 25;
/// How far a seat may be from the top it belongs to, mm.
const SEAT_REACH: i32 = 450;
/// Highest stack, in things.
const MOST_STACKED: u32 = 8;

/// Returns true for a task that a tidy room does without: decoration and small things that its type does not ask for.
pub(crate) fn is_spare(task: &Task, kind: &RoomType) -> bool {
    let free = kind.furnishing.get(task.line).is_some_and(|line| line.min == 0 && line.item == task.item);
    let decor = task.anchor.shape == Shape::Plant || task.anchor.affordances.iter().all(|a| a == "see");
    let apart = matches!(task.arrangement, Arrangement::Overhead | Arrangement::AtWindow | Arrangement::Facing);
    free && task.required == 0 && !apart && (task.arrangement == Arrangement::OnSurface || decor && on_show(task))
}

/// Returns true for what is only looked at and stands or hangs freely; signs and lamps are of use.
fn on_show(task: &Task) -> bool {
    let tagged = |what: &str| task.anchor.tags.iter().any(|t| t == what);
    !tagged("safety") && matches!(task.anchor.shape, Shape::Plant | Shape::Panel | Shape::Cylinder | Shape::Box)
}

/// Takes away what stands on the furniture of groups and is no essential part of them, from a unit counted from the
/// number of locked ones on.
pub(crate) fn tidy(outcome: &mut Outcome, locked: usize) {
    for placed in outcome.placed.iter_mut().skip(locked) {
        let loose = |p: &Part| p.mount == Mount::Surface && !p.object.affordances.iter().any(|a| a == "operate");
        if let Some(bare) = placed.unit.cleared(loose) {
            placed.unit = Rc::new(bare);
        }
    }
}

/// Puts small things on the furniture of a room, and returns a task for each line that put something down; the units
/// come last in the outcome, with the tasks numbered on from those of the job.
pub(crate) fn strew<'a>(job: &Job<'a, '_>, room_type: &str, outcome: &mut Outcome<'a>) -> Vec<Task<'a>> {
    let lines: Vec<&ClutterLine> = job.domain.clutter.iter().filter(|l| l.holds_in(room_type)).collect();
    if lines.is_empty() {
        return Vec::new();
    }
    // routes do not matter: nothing here takes floor
    let mut state = State::new(job.space, Nav::new(job.space, job.radius), None, LEVELS[0].open);
    state.add(std::mem::take(&mut outcome.placed));
    let mut strewing = Strewing { job, state, tasks: Vec::new() };
    let hosts: Vec<(usize, usize)> = strewing.hosts(&lines);
    for host in hosts {
        let id = &strewing.part(host).object.id;
        let own: Vec<&ClutterLine> = lines.iter().copied().filter(|l| l.on.contains(id)).collect();
        for line in own {
            strewing.lay(line, host);
        }
    }
    outcome.placed = strewing.state.placed;
    strewing.tasks
}

/// A room on whose furniture things are put.
struct Strewing<'j, 'a, 's> {
    job: &'j Job<'a, 's>,
    state: State<'a, 's>,
    tasks: Vec<Task<'a>>,
}

/// A top in the frame of what it belongs to: x towards its front.
#[derive(Clone, Copy)]
struct Top {
    host: (usize, usize),
    /// Quarter turns of the frame against the world.
    q: u8,
    face: Box2,
    z: i32,
}

impl<'a> Strewing<'_, 'a, '_> {
    /// Returns the parts that lines put things on, in the order of placing.
    fn hosts(&self, lines: &[&ClutterLine]) -> Vec<(usize, usize)> {
        let named = |p: &Part| lines.iter().any(|l| l.on.contains(&p.object.id));
        let standing = self.state.placed.iter().enumerate().filter(|(_, p)| p.support.is_none());
        standing
            .flat_map(|(i, p)| {
                p.unit.parts.iter().enumerate().filter(|(_, part)| named(part)).map(move |(k, _)| (i, k))
            })
            .collect()
    }

    fn part(&self, (i, k): (usize, usize)) -> &Part<'a> {
        &self.state.placed[i].unit.parts[k]
    }

    fn top(&self, host: (usize, usize)) -> Top {
        let placed = &self.state.placed[host.0];
        let part = self.part(host);
        let solid = placed.solid(part);
        let q = (placed.q + part.quarter) % 4;
        Top { host, q, face: solid.rect.turned((4 - q) % 4), z: solid.z1 }
    }

    /// Puts the things of one line on one piece of furniture.
    fn lay(&mut self, line: &ClutterLine, host: (usize, usize)) {
        let top = self.top(host);
        let (x, y) = top.face.center();
        let salt = self.job.salt ^ u64::from(top.q);
        let chance = |n: i64| grain(salt, i64::from(x) + 7 * n, i64::from(y) + 13 * self.tasks.len() as i64);
        let count =
            line.min + ((line.max - line.min + 1) as f64 * chance(1)).min(f64::from(line.max - line.min)) as u32;
        let from_left = chance(2) < 0.5;
        let items: Vec<Rc<Unit<'a>>> = line.items.iter().filter_map(|id| self.unit(id)).collect();
        if items.is_empty() || count == 0 {
            return;
        }
        let task = self.job.tasks.len() + self.tasks.len();
        let laid = match line.pattern {
            ClutterPattern::Row => self.row(&top, &items, count, from_left, task),
            ClutterPattern::Stack => self.stack(&top, &items, count, from_left, task),
            ClutterPattern::BySeat => self.by_seat(&top, &items, count, task),
            ClutterPattern::Ends => self.ends(&top, &items, count, from_left, task),
            ClutterPattern::Middle => self.middle(&top, &items, count, task),
        };
        if let Some(object) = items.first().map(|u| u.anchor().object).filter(|_| laid > 0) {
            self.tasks.push(task_of(line, object, self.part(host).object, laid));
        }
    }

    fn unit(&self, id: &str) -> Option<Rc<Unit<'a>>> {
        let object = self.job.domain.object(id)?;
        let (sizes, aims, ceiling) = (self.job.sizes, self.job.aims, self.job.space.ceiling);
        let forms = Forms { sizes, aims, tightness: 1.0, advised: false, lawful: false, ceiling, robot: 0 };
        let units = variants(self.job.domain, &object.id, &forms);
        units.into_iter().next().map(Rc::new)
    }

    /// Puts a thing down with its back left corner at a place of the top's frame, where nothing stands.
    fn put(&mut self, top: &Top, unit: &Rc<Unit<'a>>, x: i32, y: i32, task: usize) -> bool {
        let own = outline(unit);
        let rect = own.shifted(x - own.x0, y - own.y0);
        if !top.face.contains(&rect) {
            return false;
        }
        let (u, v) = (x - own.x0, y - own.y0);
        let mut placed: Placed<'a> = at_frame(unit, top.q, u, v, task);
        placed.at = turn(top.q, u, v);
        placed.support = Some(top.host);
        placed.z = top.z;
        let free = self.state.test(&placed, false).is_ok();
        if free {
            self.state.add(vec![placed]);
        }
        free
    }

    /// Side by side along the back, from one end.
    fn row(&mut self, top: &Top, items: &[Rc<Unit<'a>>], count: u32, from_left: bool, task: usize) -> u32 {
        let face = top.face;
        let mut laid = 0;
        let mut at = EDGE;
        while laid < count {
            let unit = &items[laid as usize % items.len()];
            let own = outline(unit);
            let inset = EDGE.min((face.width() - own.width()) / 2).max(0);
            let y = if from_left { face.y1 - at - own.height() } else { face.y0 + at };
            if at + own.height() > face.height() {
                break;
            }
            if self.put(top, unit, face.x0 + inset, y, task) {
                laid += 1;
                // books stand close, boxes do not
                at += own.height() + GAP.min(own.height() / 6);
            } else {
                at += STEP;
            }
        }
        laid
    }

    /// One on the other, at the back near an end; a lower thing carries only what is no larger.
    fn stack(&mut self, top: &Top, items: &[Rc<Unit<'a>>], count: u32, from_left: bool, task: usize) -> u32 {
        let face = top.face;
        let first = &items[0];
        let own = outline(first);
        let (room_x, room_y) = (face.width() - own.width(), face.height() - own.height());
        if room_x < 0 || room_y < 0 {
            return 0;
        }
        let (dx, dy) = (EDGE.min(room_x / 2), EDGE.min(room_y / 2));
        let mut places = Vec::new();
        for x in [face.x0 + dx, face.x1 - dx - own.width()] {
            let along = (0..=(room_y - 2 * dy).max(0)).step_by(STEP as usize);
            places
                .extend(along.map(|s| (x, if from_left { face.y1 - dy - own.height() - s } else { face.y0 + dy + s })));
        }
        let Some((x, y)) = places.into_iter().find(|&(x, y)| self.put(top, first, x, y, task)) else { return 0 };
        let mut laid = 1;
        let mut below = own.shifted(x - own.x0, y - own.y0);
        while laid < count.min(MOST_STACKED) {
            let unit = &items[laid as usize % items.len()];
            let own = outline(unit);
            let host = (self.state.placed.len() - 1, 0);
            let z = self.top(host).z;
            let (x, y) = (below.x0 + (below.width() - own.width()) / 2, below.y0 + (below.height() - own.height()) / 2);
            let on = Top { host, q: top.q, face: below, z };
            if !self.put(&on, unit, x, y, task) {
                break;
            }
            below = own.shifted(x - own.x0, y - own.y0);
            laid += 1;
        }
        laid
    }

    /// Beside each other before each seat; before the middle of the front where there is none.
    fn by_seat(&mut self, top: &Top, items: &[Rc<Unit<'a>>], count: u32, task: usize) -> u32 {
        let mut seats = self.seats(top);
        if seats.is_empty() {
            let (_, cy) = top.face.center();
            seats.push((0, cy));
        }
        let mut laid = 0;
        for (side, along) in seats {
            for n in 0..count {
                // the first before the seat, the next to its right and left in turn
                let unit = &items[n as usize % items.len()];
                let out = if n == 0 { 0 } else { 110 + 90 * (i64::from(n) as i32 - 1) / 2 };
                let toward = if n % 2 == 1 { 1 } else { -1 };
                let slips = (0..10).flat_map(|s| [(0, s), (60, s), (120, s), (180, s)]);
                let found = slips.into_iter().find_map(|(deep, s)| {
                    let (x, y) = before(top, outline(unit), side, along + toward * (out + STEP * s), EDGE + deep);
                    self.put(top, unit, x, y, task).then_some(())
                });
                laid += u32::from(found.is_some());
            }
        }
        laid
    }

    /// Returns the seats at a top: the side of it they are at (0 front, 1 left, 2 back, 3 right), and where along it.
    fn seats(&self, top: &Top) -> Vec<(u8, i32)> {
        let back = (4 - top.q) % 4;
        let mut out = Vec::new();
        for placed in self.state.placed.iter().filter(|p| p.support.is_none()) {
            for part in placed.unit.parts.iter().filter(|p| is_seat(p.object.shape)) {
                let seat = placed.solid(part).rect.turned(back);
                let look = (placed.q + part.quarter + back) % 4;
                let (cx, cy) = seat.center();
                let f = top.face;
                let within = |v: i32, low: i32, high: i32| (low..=high).contains(&v);
                let near = |gap: i32| within(gap, -SEAT_REACH, SEAT_REACH);
                let found = match look {
                    2 if within(cy, f.y0, f.y1) && near(seat.x0 - f.x1) && cx > f.center().0 => Some((0, cy)),
                    0 if within(cy, f.y0, f.y1) && near(f.x0 - seat.x1) && cx < f.center().0 => Some((2, cy)),
                    3 if within(cx, f.x0, f.x1) && near(seat.y0 - f.y1) && cy > f.center().1 => Some((1, cx)),
                    1 if within(cx, f.x0, f.x1) && near(f.y0 - seat.y1) && cy < f.center().1 => Some((3, cx)),
                    _ => None,
                };
                out.extend(found);
            }
        }
        out
    }

    /// One at each end of the top, at the middle of its depth, or behind it.
    fn ends(&mut self, top: &Top, items: &[Rc<Unit<'a>>], count: u32, from_left: bool, task: usize) -> u32 {
        let face = top.face;
        let mut laid = 0;
        for n in 0..count.min(2) {
            let unit = &items[n as usize % items.len()];
            let own = outline(unit);
            let left = from_left == (n == 0);
            let y = if left { face.y1 - EDGE - own.height() } else { face.y0 + EDGE };
            let middle = face.x0 + (face.width() - own.width()) / 2;
            let found = [middle, face.x0 + EDGE].into_iter().any(|x| self.put(top, unit, x, y, task));
            laid += u32::from(found);
        }
        laid
    }

    /// Side by side about the middle, in a line with the longer side.
    fn middle(&mut self, top: &Top, items: &[Rc<Unit<'a>>], count: u32, task: usize) -> u32 {
        let face = top.face;
        let (cx, cy) = face.center();
        let along_y = face.height() >= face.width();
        let mut laid = 0;
        for n in 0..count {
            let unit = &items[n as usize % items.len()];
            let own = outline(unit);
            let side = if n % 2 == 1 { 1 } else { -1 };
            let found = (0..40).find(|s| {
                let off = side * STEP * s;
                let (x, y) = (cx - own.width() / 2, cy - own.height() / 2);
                let (x, y) = if along_y { (x, y + off) } else { (x + off, y) };
                self.put(top, unit, x, y, task)
            });
            laid += u32::from(found.is_some());
        }
        laid
    }
}

/// Returns the outline of a small thing in its own frame.
fn outline(unit: &Unit) -> Box2 {
    unit.anchor().solid.rect
}

/// Returns the back left corner of a thing that lies `deep` behind one side of a top, about a place along that side.
fn before(top: &Top, own: Box2, side: u8, along: i32, deep: i32) -> (i32, i32) {
    let f = top.face;
    let (w, h) = (own.width(), own.height());
    match side {
        0 => (f.x1 - deep - w, along - h / 2),
        2 => (f.x0 + deep, along - h / 2),
        1 => (along - w / 2, f.y1 - deep - h),
        _ => (along - w / 2, f.y0 + deep),
    }
}

fn task_of<'a>(line: &ClutterLine, object: &'a ObjectType, host: &ObjectType, count: u32) -> Task<'a> {
    Task {
        item: &object.id,
        anchor: object,
        arrangement: Arrangement::OnSurface,
        count,
        required: 0,
        spare: 0,
        line: 0,
        leads: false,
        instead_of: &[],
        first_choice: false,
        asked: false,
        for_guests: false,
        for_many: false,
        usual_width_m: None,
        seats: None,
        rule: format!("clutter ({} on {}): {}", line.items.join(", "), host.id, line.pattern.name()),
    }
}
