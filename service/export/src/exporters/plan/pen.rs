//! Draws a symbol in an object's own frame.
//!
//! `u` runs to the right of somebody who looks out of the object's front, `v` towards the front, both from the middle of
//! the footprint, m.

use d3dgen_model::Point;
use d3dgen_model::domain::Mount;
use d3dgen_model::placements::Placement;

use super::page::{Frame, Page, Path};

/// A quadratic piece of an outline: its control point and its end.
pub(super) type Curve = ((f64, f64), (f64, f64));

/// A pen over one object.
pub(super) struct Pen<'a> {
    page: &'a mut Page,
    frame: &'a Frame,
    center: Point,
    /// Sine and cosine of the yaw.
    turn: (f64, f64),
    /// Width, m.
    pub w: f64,
    /// Depth, m.
    pub d: f64,
    /// Height, m.
    pub h: f64,
    /// Where the object is fixed.
    pub mount: Mount,
}

impl<'a> Pen<'a> {
    pub fn new(page: &'a mut Page, frame: &'a Frame, placement: &Placement) -> Self {
        let [w, d, h] = placement.size_m;
        let center = Point::new(placement.pose.x, placement.pose.y);
        Self { page, frame, center, turn: turn(placement.pose.yaw_rad), w, d, h, mount: placement.mount }
    }

    fn at(&self, u: f64, v: f64) -> (f64, f64) {
        let (sin, cos) = self.turn;
        self.frame.map(Point::new(self.center.x + cos * v + sin * u, self.center.y + sin * v - cos * u))
    }

    /// Half the width and half the depth.
    pub fn half(&self) -> (f64, f64) {
        (self.w / 2.0, self.d / 2.0)
    }

    /// A rectangle between two corners, its corners rounded by `r`.
    pub fn rect(&mut self, class: &str, a: (f64, f64), b: (f64, f64), r: f64) {
        let (u0, u1) = (a.0.min(b.0), a.0.max(b.0));
        let (v0, v1) = (a.1.min(b.1), a.1.max(b.1));
        let r = r.min((u1 - u0) / 2.0).min((v1 - v0) / 2.0);
        let p = |u: f64, v: f64| self.at(u, v);
        let path = if r < 0.005 {
            Path::new().polygon(&[p(u0, v0), p(u1, v0), p(u1, v1), p(u0, v1)])
        } else {
            Path::new()
                .to(p(u0 + r, v0))
                .line(p(u1 - r, v0))
                .quad(p(u1, v0), p(u1, v0 + r))
                .line(p(u1, v1 - r))
                .quad(p(u1, v1), p(u1 - r, v1))
                .line(p(u0 + r, v1))
                .quad(p(u0, v1), p(u0, v1 - r))
                .line(p(u0, v0 + r))
                .quad(p(u0, v0), p(u0 + r, v0))
                .close()
        };
        self.page.path(class, path);
    }

    /// The whole footprint, its corners rounded by `r`.
    pub fn outline(&mut self, class: &str, r: f64) {
        let (u, v) = self.half();
        self.rect(class, (-u, -v), (u, v), r);
    }

    /// The footprint less a margin on all sides.
    pub fn inset(&mut self, class: &str, margin: f64, r: f64) {
        let (u, v) = (self.w / 2.0 - margin, self.d / 2.0 - margin);
        if u > 0.01 && v > 0.01 {
            self.rect(class, (-u, -v), (u, v), r);
        }
    }

    /// An ellipse around a point.
    pub fn ellipse(&mut self, class: &str, c: (f64, f64), ru: f64, rv: f64) {
        let (k, l) = (ru * 0.5523, rv * 0.5523);
        let p = |u: f64, v: f64| self.at(c.0 + u, c.1 + v);
        let path = Path::new()
            .to(p(ru, 0.0))
            .cubic(p(ru, l), p(k, rv), p(0.0, rv))
            .cubic(p(-k, rv), p(-ru, l), p(-ru, 0.0))
            .cubic(p(-ru, -l), p(-k, -rv), p(0.0, -rv))
            .cubic(p(k, -rv), p(ru, -l), p(ru, 0.0))
            .close();
        self.page.path(class, path);
    }

    /// A circle around a point.
    pub fn circle(&mut self, class: &str, c: (f64, f64), r: f64) {
        self.ellipse(class, c, r, r);
    }

    /// Open lines, each through the given points.
    pub fn lines(&mut self, class: &str, lines: &[&[(f64, f64)]]) {
        let mut path = Path::new();
        for line in lines {
            for (i, (u, v)) in line.iter().enumerate() {
                let p = self.at(*u, *v);
                path = if i == 0 { path.to(p) } else { path.line(p) };
            }
        }
        self.page.path(class, path);
    }

    /// A closed outline of quadratic curves from `start`.
    pub fn blob(&mut self, class: &str, start: (f64, f64), curves: &[Curve]) {
        let mut path = Path::new().to(self.at(start.0, start.1));
        for (control, end) in curves {
            path = path.quad(self.at(control.0, control.1), self.at(end.0, end.1));
        }
        self.page.path(class, path.close());
    }

    /// An open curve of quadratic pieces.
    pub fn curve(&mut self, class: &str, start: (f64, f64), curves: &[Curve]) {
        let mut path = Path::new().to(self.at(start.0, start.1));
        for (control, end) in curves {
            path = path.quad(self.at(control.0, control.1), self.at(end.0, end.1));
        }
        self.page.path(class, path);
    }

    /// A filled polygon.
    pub fn polygon(&mut self, class: &str, points: &[(f64, f64)]) {
        let points: Vec<(f64, f64)> = points.iter().map(|(u, v)| self.at(*u, *v)).collect();
        self.page.path(class, Path::new().polygon(&points));
    }
}

/// Returns sine and cosine, exact for quarter turns.
pub(super) fn turn(yaw_rad: f64) -> (f64, f64) {
    let quarters = yaw_rad / std::f64::consts::FRAC_PI_2;
    if (quarters - quarters.round()).abs() > 1e-9 {
        return yaw_rad.sin_cos();
    }
    match (quarters.round() as i64).rem_euclid(4) {
        0 => (0.0, 1.0),
        1 => (1.0, 0.0),
        2 => (0.0, -1.0),
        _ => (-1.0, 0.0),
    }
}
