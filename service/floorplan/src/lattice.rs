//! Integer geometry on the 5 cm lattice that plans are searched on: exact, and the same bytes on every machine.

use d3dgen_model::Rect;

/// Lattice step, m.
pub(crate) const STEP_M: f64 = 0.05;
/// Half the thickness of an inner wall, m.
pub(crate) const INNER_HALF_M: f64 = 0.06;
/// Half the thickness of an outer wall, m.
pub(crate) const OUTER_HALF_M: f64 = 0.12;
/// Returns meters as lattice units, rounded up.
pub(crate) fn up(meters: f64) -> i32 {
    // By hand: the processor's own way to round is not in every machine, and the library's is slow.
    let units = meters / STEP_M - 1e-6;
    let whole = units as i32;
    whole + i32::from(units > f64::from(whole))
}

/// Returns meters as the nearest lattice unit.
pub(crate) fn nearest(meters: f64) -> i32 {
    let units = meters / STEP_M;
    (if units < 0.0 { units - 0.5 } else { units + 0.5 }) as i32
}

/// Returns lattice units in meters.
pub(crate) fn meters(units: i32) -> f64 {
    f64::from(units) * STEP_M
}

/// A rectangle on the lattice; `x0 < x1`, `y0 < y1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cellbox {
    pub x0: i32,
    pub y0: i32,
    pub x1: i32,
    pub y1: i32,
}

/// Area of a cell of the lattice, m^2.
pub(crate) const CELL_M2: f64 = 0.0025;

impl Cellbox {
    pub(crate) fn new(xa: i32, ya: i32, xb: i32, yb: i32) -> Self {
        Self { x0: xa.min(xb), y0: ya.min(yb), x1: xa.max(xb), y1: ya.max(yb) }
    }

    pub(crate) fn width(&self) -> i32 {
        self.x1 - self.x0
    }

    pub(crate) fn height(&self) -> i32 {
        self.y1 - self.y0
    }

    pub(crate) fn area_m2(&self) -> f64 {
        meters(self.width()) * meters(self.height())
    }

    /// Returns the smallest rectangle around two.
    pub(crate) fn around(self, other: Self) -> Self {
        let (x0, y0) = (self.x0.min(other.x0), self.y0.min(other.y0));
        Self { x0, y0, x1: self.x1.max(other.x1), y1: self.y1.max(other.y1) }
    }

    /// Returns what two rectangles share.
    pub(crate) fn overlap(&self, other: &Self) -> Option<Self> {
        let (x0, y0) = (self.x0.max(other.x0), self.y0.max(other.y0));
        let (x1, y1) = (self.x1.min(other.x1), self.y1.min(other.y1));
        (x0 < x1 && y0 < y1).then_some(Self { x0, y0, x1, y1 })
    }

    /// Returns the least rectangle around both.
    pub(crate) fn union(&self, other: &Self) -> Self {
        Self {
            x0: self.x0.min(other.x0),
            y0: self.y0.min(other.y0),
            x1: self.x1.max(other.x1),
            y1: self.y1.max(other.y1),
        }
    }

    /// Returns what is left of a rectangle without another: up to four rectangles.
    pub(crate) fn without(&self, other: &Self) -> Vec<Self> {
        let Some(cut) = self.overlap(other) else { return vec![*self] };
        let pieces = [
            (self.x0, self.y0, cut.x0, self.y1),
            (cut.x1, self.y0, self.x1, self.y1),
            (cut.x0, self.y0, cut.x1, cut.y0),
            (cut.x0, cut.y1, cut.x1, self.y1),
        ];
        let whole = |(x0, y0, x1, y1)| (x0 < x1 && y0 < y1).then_some(Self { x0, y0, x1, y1 });
        pieces.into_iter().filter_map(whole).collect()
    }

    /// Returns the strip `deep` units wide along the outside of a side (0 west, 1 east, 2 south, 3 north); along its
    /// inside for a negative `deep`.
    pub(crate) fn strip(&self, side: usize, deep: i32) -> Self {
        match side {
            0 => Self::new(self.x0 - deep, self.y0, self.x0, self.y1),
            1 => Self::new(self.x1, self.y0, self.x1 + deep, self.y1),
            2 => Self::new(self.x0, self.y0 - deep, self.x1, self.y0),
            _ => Self::new(self.x0, self.y1, self.x1, self.y1 + deep),
        }
    }

    /// Returns the center times two, so that it stays on the lattice.
    pub(crate) fn center2(&self) -> (i32, i32) {
        (self.x0 + self.x1, self.y0 + self.y1)
    }

    pub(crate) fn to_rect(self) -> Rect {
        Rect::new(meters(self.x0), meters(self.y0), meters(self.x1), meters(self.y1))
    }

    /// As [`Cellbox::contact`] has it, of a rectangle that begins east of this one's west side and no farther than where this
    /// one ends: the one question of the search that is asked a million times.
    pub(crate) fn contact_eastward(&self, other: &Self) -> Option<(usize, i32, i32)> {
        if other.x0 == self.x1 {
            let (from, to) = (self.y0.max(other.y0), self.y1.min(other.y1));
            return (from < to).then_some((1, from, to));
        }
        let side = if other.y1 == self.y0 {
            2
        } else if other.y0 == self.y1 {
            3
        } else {
            return None;
        };
        Some((side, other.x0, self.x1.min(other.x1)))
    }

    /// Returns the shared edge of two rectangles that touch without overlapping, as the side of `self` it lies on
    /// (0 west, 1 east, 2 south, 3 north) and the stretch `from..to` along that side.
    pub(crate) fn contact(&self, other: &Self) -> Option<(usize, i32, i32)> {
        let (ylo, yhi) = (self.y0.max(other.y0), self.y1.min(other.y1));
        let (xlo, xhi) = (self.x0.max(other.x0), self.x1.min(other.x1));
        if ylo < yhi {
            if self.x0 == other.x1 {
                return Some((0, ylo, yhi));
            }
            if self.x1 == other.x0 {
                return Some((1, ylo, yhi));
            }
        }
        if xlo < xhi {
            if self.y0 == other.y1 {
                return Some((2, xlo, xhi));
            }
            if self.y1 == other.y0 {
                return Some((3, xlo, xhi));
            }
        }
        None
    }
}

/// A coordinate frame of a band: rooms are laid along `u` from `origin`, their depth along `v`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    pub origin: (i32, i32),
    pub u: (i32, i32),
    pub v: (i32, i32),
}

impl Frame {
    /// Returns the rectangle between `along0..along1` and `out0..out1` in world lattice units.
    pub(crate) fn place(&self, along0: i32, along1: i32, out0: i32, out1: i32) -> Cellbox {
        let at =
            |a: i32, o: i32| (self.origin.0 + self.u.0 * a + self.v.0 * o, self.origin.1 + self.u.1 * a + self.v.1 * o);
        let ((xa, ya), (xb, yb)) = (at(along0, out0), at(along1, out1));
        Cellbox::new(xa, ya, xb, yb)
    }
}

/// Returns the walking distance between the middles of two boxes, m.
pub(crate) fn distance(a: Cellbox, b: Cellbox) -> f64 {
    between(a.center2(), b.center2())
}

/// Returns the walking distance between points given by twice their coordinates, m.
pub(crate) fn between((ax, ay): (i32, i32), (bx, by): (i32, i32)) -> f64 {
    (f64::from((ax - bx).abs()) + f64::from((ay - by).abs())) * 0.025
}

/// Returns the same cells as few rectangles, the largest first: it is the one a room is judged by.
pub(crate) fn tidied(cells: &[Cellbox]) -> Vec<Cellbox> {
    if cells.len() < 2 {
        return cells.to_vec();
    }
    let lines = |edges: fn(&Cellbox) -> [i32; 2]| {
        let mut list: Vec<i32> = cells.iter().flat_map(edges).collect();
        list.sort_unstable();
        list.dedup();
        list
    };
    let (xs, ys) = (lines(|b| [b.x0, b.x1]), lines(|b| [b.y0, b.y1]));
    let (columns, rows) = (xs.len() - 1, ys.len() - 1);
    let at = |i: usize, j: usize| Cellbox { x0: xs[i], y0: ys[j], x1: xs[i + 1], y1: ys[j + 1] };
    let mut open: Vec<bool> =
        (0..columns * rows).map(|k| cells.iter().any(|b| b.overlap(&at(k % columns, k / columns)).is_some())).collect();
    let mut out = Vec::new();
    while open.contains(&true) {
        let mut best: Option<(i64, [usize; 4])> = None;
        for k in (0..open.len()).filter(|&k| open[k]) {
            let (i0, j0) = (k % columns, k / columns);
            let mut end = columns;
            for j1 in j0..rows {
                end = (i0..end).find(|&i| !open[j1 * columns + i]).unwrap_or(end);
                if end == i0 {
                    break;
                }
                let size = i64::from(xs[end] - xs[i0]) * i64::from(ys[j1 + 1] - ys[j0]);
                if best.is_none_or(|(b, _)| size > b) {
                    best = Some((size, [i0, j0, end, j1 + 1]));
                }
            }
        }
        let Some((_, [i0, j0, i1, j1])) = best else { break };
        for j in j0..j1 {
            open[j * columns + i0..j * columns + i1].fill(false);
        }
        out.push(Cellbox { x0: xs[i0], y0: ys[j0], x1: xs[i1], y1: ys[j1] });
    }
    out
}

/// Returns true for a hole in which two walls with windows would be too near to each other.
pub(crate) fn is_narrow(hole: &[Cellbox], least: i32) -> bool {
    let around = hole.iter().copied().reduce(Cellbox::around);
    around.is_some_and(|b| b.width().min(b.height()) < least)
}
