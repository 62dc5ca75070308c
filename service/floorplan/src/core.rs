//! The core of a building with several storeys: stairs and elevator side by side, the same on every storey, and what a
//! storey must know of the one below it.
//!
//! A core is a block of fixed boxes in a frame of its own: along the corridor, and away from it. The stairwell is as deep
//! as the core; the elevator stands at its back, behind an alcove of the corridor where people and robots wait. All
//! storeys are turned and moved so that their cores coincide, so a storey is planned without knowing where it will stand.

use d3dgen_model::domain::{Domain, Scheme, Stairs};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::storeys::LinkKind;

use super::lattice::{Cellbox, Frame, INNER_HALF_M, OUTER_HALF_M, up};
use super::realize::spine_units;
use super::spec::Brief;
use crate::measures::DOUBLE_FROM_M;

/// Stairs and elevator as one storey sees them.
#[derive(Debug, Clone)]
pub(crate) struct Core {
    /// The stairwell; stands for the whole core in a genome.
    pub host: usize,
    /// Boxes in the core's frame: `x` along the corridor, `y` away from it.
    pub boxes: Vec<(usize, Cellbox)>,
    pub width: i32,
    pub depth: i32,
    /// Second stairwell, at the other end of a building of wings, and its width.
    pub far: Option<(usize, i32)>,
    /// True where the second stairwell stands at the other end of the row of rooms that the core begins: a storey is one bar.
    pub gable: bool,
    /// Length of the longest storey of such a building, about: the second stairs stand no nearer, lattice units.
    pub least: i32,
    /// The storey below.
    pub below: Option<Below>,
}

/// What is below a storey.
#[derive(Debug, Clone, Default)]
pub(crate) struct Below {
    /// Its boxes, in the core's frame where `by_core`, else in the layout's own.
    pub outline: Vec<Cellbox>,
    /// Boxes of its rooms, in the same frame, where walls are to be put over its walls.
    pub boxes: Vec<Cellbox>,
    /// Those of rooms that people sleep, live or work in, in the same frame: water of the storey above runs down elsewhere.
    pub quiet: Vec<Cellbox>,
    pub by_core: bool,
    pub comb: Option<Comb>,
    /// Where the second stairwell of a bar begins, along the corridor from the core.
    pub far: Option<i32>,
    /// How its corridor runs, where that is known.
    pub scheme: Option<Scheme>,
    /// How far south and north a wing may reach before it pushes others away, in its own layout.
    pub between: Option<(i32, i32)>,
}

impl Below {
    /// Returns how deep its rooms are on the other side of the corridor than the core, lattice units; `None` where there are none.
    pub(crate) fn depth_across(&self, brief: &Brief) -> Option<i32> {
        let far = self.outline.iter().map(|b| b.y0).min()?;
        let depth = -far - spine_units(brief);
        (depth > 0).then_some(depth)
    }
}

/// How the wings of a storey stand along its spine.
#[derive(Debug, Clone, Default)]
pub(crate) struct Comb {
    /// Side of the first wing: 0 east, 1 west of the spine.
    pub first: usize,
    pub slots: Vec<Slot>,
    /// Where the second stairwell begins.
    pub far: Option<i32>,
}

/// Where a wing stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slot {
    /// 0 east, 1 west of the spine.
    pub side: usize,
    /// Its corridor along the spine.
    pub at: i32,
    /// How far it reaches from there.
    pub south: i32,
    pub north: i32,
}

impl Core {
    /// Returns the core of a storey, or `None` where nothing leads up or down. Areas of its rooms are set in `brief`.
    ///
    /// `height_m` is the greatest height of a storey: all have the same stairwell.
    pub(crate) fn new(brief: &mut Brief, graph: &SceneGraph, domain: &Domain, height_m: f64) -> Option<Self> {
        let storeys = domain.circulation.storeys.as_ref()?;
        let room = |ids: &[String]| brief.rooms.iter().position(|r| ids.contains(&r.id));
        let of_kind = |kind: LinkKind| {
            graph.links.iter().filter(|l| l.kind == kind).filter_map(|l| room(&l.room_ids)).collect::<Vec<usize>>()
        };
        let (stairs, lifts) = (of_kind(LinkKind::Stairs), of_kind(LinkKind::Elevator));
        let host = *stairs.first()?;
        let (width, depth) = stairwell(&storeys.stairs, height_m);
        let spine = brief.spine?;
        let mut boxes = vec![(host, Cellbox::new(0, 0, width, depth))];
        let mut along = width;
        if let Some(elevator) = &storeys.elevator {
            let walls = INNER_HALF_M + OUTER_HALF_M;
            let wide = up(elevator.shaft_width_m.max(brief.spine_width) + walls);
            let deep = up(elevator.shaft_depth_m + walls).min(depth - 1);
            for &lift in &lifts {
                boxes.push((spine, Cellbox::new(along, 0, along + wide, depth - deep)));
                boxes.push((lift, Cellbox::new(along, depth - deep, along + wide, depth)));
                along += wide;
            }
        }
        for &(r, b) in &boxes {
            if r != spine {
                set_area(brief, r, b);
            }
        }
        let far = stairs.get(1).copied();
        if let Some(far) = far {
            set_area(brief, far, Cellbox::new(0, 0, width, depth));
        }
        two_leaves(brief, &stairs, storeys.stairs.landing_m);
        Some(Self {
            host,
            boxes,
            width: along,
            depth,
            far: far.map(|f| (f, width)),
            gable: false,
            least: 0,
            below: None,
        })
    }

    /// Returns true for rooms that stand where the core puts them.
    pub(crate) fn has(&self, room: usize, spine: Option<usize>) -> bool {
        Some(room) != spine && (self.far.is_some_and(|f| f.0 == room) || self.boxes.iter().any(|b| b.0 == room))
    }
}

/// Where a door is so wide that one leaf would sweep beyond the landing of the stairs, onto the flights, it has two.
fn two_leaves(brief: &mut Brief, stairs: &[usize], landing_m: f64) {
    for &room in stairs {
        let open = brief.rooms[room].open_front;
        let width = &mut brief.rooms[room].door_width;
        if !open && Brief::opening(*width) > landing_m {
            *width = width.max(DOUBLE_FROM_M);
        }
    }
}

/// The stairwell has the size it needs, whatever others of its type have.
fn set_area(brief: &mut Brief, room: usize, b: Cellbox) {
    let entrance_width = brief.entrance_width;
    let spec = &mut brief.rooms[room];
    let area = b.area_m2();
    (spec.area_min, spec.area_target, spec.area_max) = (0.4 * area, 0.88 * area, 1.1 * area);
    spec.min_dimension = spec.min_dimension.min(1.0);
    spec.fixed = true;
    // stairs are a way out
    if !spec.elevator && !spec.open_front {
        spec.door_width = spec.door_width.max(entrance_width);
    }
}

/// Returns width and depth of a stairwell between wall center lines, lattice units.
fn stairwell(stairs: &Stairs, height_m: f64) -> (i32, i32) {
    let (width, depth) = stairs.size_m(height_m);
    let walls = INNER_HALF_M + OUTER_HALF_M;
    (up(width + walls), up(depth + walls))
}

/// Returns boxes of a layout as the core sees them.
pub(crate) fn in_core(boxes: &[(usize, Cellbox)], frame: &Frame) -> Vec<(usize, Cellbox)> {
    let at = |x: i32, y: i32| {
        let (dx, dy) = (x - frame.origin.0, y - frame.origin.1);
        (dx * frame.u.0 + dy * frame.u.1, dx * frame.v.0 + dy * frame.v.1)
    };
    let turn = |b: &Cellbox| {
        let ((xa, ya), (xb, yb)) = (at(b.x0, b.y0), at(b.x1, b.y1));
        Cellbox::new(xa, ya, xb, yb)
    };
    boxes.iter().map(|(room, b)| (*room, turn(b))).collect()
}

/// Returns boxes that the core sees as the layout with this core has them.
pub(crate) fn out_of_core(boxes: &[Cellbox], frame: &Frame) -> Vec<Cellbox> {
    boxes.iter().map(|b| frame.place(b.x0, b.x1, b.y0, b.y1)).collect()
}

/// Returns the area of the boxes that nothing of the outline supports, lattice units squared.
pub(crate) fn overhang(boxes: &[(usize, Cellbox)], outline: &[Cellbox], (dx, dy): (i32, i32)) -> i64 {
    let mut free = 0;
    for (_, b) in boxes {
        let (x0, y0, x1, y1) = (b.x0 - dx, b.y0 - dy, b.x1 - dx, b.y1 - dy);
        free += i64::from(x1 - x0) * i64::from(y1 - y0);
        for o in outline {
            let (w, h) = (x1.min(o.x1) - x0.max(o.x0), y1.min(o.y1) - y0.max(o.y0));
            if w > 0 && h > 0 {
                free -= i64::from(w) * i64::from(h);
            }
        }
    }
    free
}

/// Returns the same outline in fewer boxes: neighbors that make a rectangle are joined, again and again.
pub(crate) fn merged(boxes: &[(usize, Cellbox)]) -> Vec<Cellbox> {
    let mut out: Vec<Cellbox> = boxes.iter().map(|b| b.1).collect();
    let joins = |a: &Cellbox, b: &Cellbox| {
        let beside = a.y0 == b.y0 && a.y1 == b.y1 && (a.x1 == b.x0 || b.x1 == a.x0);
        let above = a.x0 == b.x0 && a.x1 == b.x1 && (a.y1 == b.y0 || b.y1 == a.y0);
        beside || above
    };
    let mut i = 0;
    while i < out.len() {
        let Some(j) = (i + 1..out.len()).find(|&j| joins(&out[i], &out[j])) else {
            i += 1;
            continue;
        };
        let other = out.remove(j);
        out[i] = out[i].union(&other);
        i = 0;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_into_the_core_comes_out_again() {
        let boxes = [(0, Cellbox::new(3, 4, 10, 20)), (1, Cellbox::new(-5, 4, 3, 9))];
        for (u, v) in [((1, 0), (0, 1)), ((0, 1), (-1, 0)), ((0, 1), (1, 0)), ((-1, 0), (0, 1))] {
            let frame = Frame { origin: (7, -2), u, v };
            let inside: Vec<Cellbox> = in_core(&boxes, &frame).into_iter().map(|b| b.1).collect();
            assert_eq!(out_of_core(&inside, &frame), boxes.map(|b| b.1));
        }
    }

    #[test]
    fn overhang_is_what_nothing_stands_under() {
        let below = merged(&[(0, Cellbox::new(0, 0, 10, 10)), (1, Cellbox::new(10, 0, 20, 10))]);
        assert_eq!(below, [Cellbox::new(0, 0, 20, 10)]);
        let above = [(0, Cellbox::new(5, 0, 25, 10))];
        assert_eq!(overhang(&above, &below, (0, 0)), 50);
        assert_eq!(overhang(&above, &below, (5, 0)), 0);
    }
}
