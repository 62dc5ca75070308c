//! Tables with seats where rows leave floor: in line with those that stand there, and at the walls.

use std::rc::Rc;

use super::{Find, Rule};
use crate::geom::{Box2, turn};
use crate::state::{Placed, at_frame};
use crate::unit::Unit;

/// What a place is worth in line with a table that stands there, along each axis, and turned as most of them are.
const IN_LINE: f64 = 0.9;
const ALIKE: f64 = 1.2;
/// What it loses for each meter to the nearest table or wall: what is left stays in one piece.
const APART: f64 = 0.8;
/// How near to a line something is in it, mm.
const ON_LINE: i32 = 30;

impl<'a> Find<'_, 'a, '_> {
    /// Offers places for one more table beside rows of them.
    pub(super) fn beside_rows(&mut self, unit: &Rc<Unit<'a>>) {
        let boxes: Vec<Box2> = self.siblings().map(|p| p.world(&p.unit.bbox)).collect();
        let alike = |q: u8| self.siblings().filter(|p| p.q % 2 == q).count();
        let usual = u8::from(alike(1) > alike(0));
        let before = self.out.len();
        for q in [0, 1] {
            let (own, reach) = (unit.bbox.turned(q), unit.reach.turned(q));
            // the low edges that its outline may have along an axis: as others have it, beyond them, with its free floor at a wall
            let floor = self.state.space.floor_rects();
            let edges = |of: fn(&Box2) -> (i32, i32)| {
                let ((low, high), (least, most)) = (of(&own), of(&reach));
                let length = high - low;
                let gap = (low - least).max(most - high);
                let beside = |b: &Box2| {
                    let (from, to) = of(b);
                    [gap, self.aisle].map(|gap| [to + gap, from - gap - length]).concat().into_iter().chain([from])
                };
                let at_walls =
                    floor.iter().map(of).flat_map(|(from, to)| [from + low - least, to - length - (most - high)]);
                let mut all: Vec<i32> = boxes.iter().flat_map(beside).chain(at_walls).collect();
                all.sort_unstable();
                all.dedup_by(|a, b| *a - *b < ON_LINE);
                all
            };
            let (xs, ys) = (edges(|b| (b.x0, b.x1)), edges(|b| (b.y0, b.y1)));
            for (x, y) in xs.iter().flat_map(|x| ys.iter().map(move |y| (*x, *y))) {
                let (u, v) = turn(4 - q, x - own.x0, y - own.y0);
                let placed = at_frame(unit, q, u, v, self.index);
                self.offer(placed, u32::from(q), |find, p| {
                    find.beside_score(p, &boxes) + if q == usual { ALIKE } else { 0.0 }
                });
            }
        }
        if self.out.len() == before {
            self.none(Rule::NoPlace);
        }
    }

    fn beside_score(&self, p: &Placed<'a>, tables: &[Box2]) -> f64 {
        let own = p.world(&p.unit.bbox);
        let along = |of: fn(&Box2) -> i32| tables.iter().any(|t| (of(t) - of(&own)).abs() < ON_LINE);
        let lines = u8::from(along(|b| b.x0)) + u8::from(along(|b| b.y0));
        let walls = self.state.space.walls.iter().map(|w| w.strip(w.v0, w.v1, 0, 0));
        let apart = tables.iter().copied().chain(walls).map(|b| b.distance(&own)).min().unwrap_or(0);
        IN_LINE * f64::from(lines) - APART * f64::from(apart) / 1000.0
    }
}
