//! On the top of other objects, and in front of windows.

use std::rc::Rc;

use d3dgen_model::domain::Mount;

use super::{Find, Rule};
use crate::geom::turn;
use crate::state::{Placed, at_frame};
use crate::unit::Unit;

/// Highest top something is put on, mm.
const REACH_HEIGHT: i32 = 1400;
/// Distance kept from the edge of a top where it is wide enough, mm.
const EDGE: i32 = 30;

impl<'a> Find<'_, 'a, '_> {
    /// Offers places on free tops of the room: the middle, then thirds and ends.
    pub(super) fn on_surfaces(&mut self, unit: &Rc<Unit<'a>>) {
        let mut offers: Vec<(Placed<'a>, u32, f64)> = Vec::new();
        for (i, host) in self.state.placed.iter().enumerate().filter(|(_, h)| h.support.is_none()) {
            for (k, part) in host.unit.parts.iter().enumerate() {
                let top = host.solid(part);
                if !part.object.surface || part.mount == Mount::Ceiling || top.z1 > REACH_HEIGHT {
                    continue;
                }
                let q = (host.q + part.quarter) % 4;
                let face = top.rect.turned((4 - q) % 4);
                let b = unit.bbox;
                let (room_x, room_y) = (face.width() - b.width(), face.height() - b.height());
                if room_x < 0 || room_y < 0 {
                    continue;
                }
                let used = self.state.placed.iter().filter(|p| p.support == Some((i, k))).count();
                let mut shares = vec![50, 15, 85, 30, 70, 0, 100];
                if !part.object.top_taken.is_empty() {
                    // what is left between a bowl and rings is narrow
                    shares.extend((0..=50).map(|k| 2 * k));
                }
                for (n, share) in shares.into_iter().enumerate() {
                    for deep in [35, 60, 0, 100] {
                        let inset = |room: i32, share: i32| {
                            let edge = EDGE.min(room / 2);
                            edge + (room - 2 * edge) * share / 100
                        };
                        let u = face.x0 - b.x0 + inset(room_x, deep);
                        let v = face.y0 - b.y0 + inset(room_y, share);
                        let mut placed = at_frame(unit, q, u, v, self.index);
                        placed.at = turn(q, u, v);
                        placed.support = Some((i, k));
                        placed.z = top.z1;
                        let score =
                            1.0 - 0.1 * n.min(8) as f64 - 0.3 * used as f64 - if deep == 35 { 0.0 } else { 0.05 };
                        offers.push((placed, i as u32, score));
                    }
                }
            }
        }
        if offers.is_empty() {
            self.none(Rule::NoPlace);
        }
        for (placed, class, score) in offers {
            self.offer(placed, class, |_, _| score);
        }
    }

    /// Offers a place before each window, for curtains and blinds.
    pub(super) fn at_windows(&mut self, unit: &Rc<Unit<'a>>) {
        let space = self.state.space;
        if space.windows.is_empty() {
            self.none(Rule::NoPlace);
        }
        for (i, w) in space.windows.iter().enumerate() {
            let wall = &space.walls[w.wall];
            let b = unit.bbox;
            let v = (w.v0 + w.v1) / 2 - (b.y0 + b.y1) / 2;
            let v = v.clamp(wall.v0 - b.y0, (wall.v1 - b.y1).max(wall.v0 - b.y0));
            let placed = at_frame(unit, wall.q, wall.u - b.x0, v, self.index);
            let misfit = f64::from((b.height() - (w.v1 - w.v0) - 200).abs()) / 1000.0;
            self.offer(placed, i as u32, |_, _| 2.0 - misfit);
        }
    }
}
