//! Machines, lamps, plants and the rest.

use crate::exporters::plan::pen::{Curve, Pen};

/// A thin upright panel; a deep one shows its foot.
pub(super) fn panel(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    if p.d > 0.12 {
        p.ellipse("s", (0.0, 0.0), (0.45 * u).max(0.08).min(u), 0.9 * v);
        let t = 0.025_f64.min(0.3 * v);
        p.rect("d", (-u, -t), (u, t), 0.0);
    } else {
        p.outline("d", 0.0);
    }
}

/// A star foot with the pole in its middle.
pub(super) fn pole(p: &mut Pen<'_>) {
    let r = p.w.min(p.d) / 2.0;
    // Five feet: cosines and sines of multiples of 72 degrees.
    const FEET: [(f64, f64); 5] = [(0.0, 1.0), (0.9511, 0.309), (0.5878, -0.809), (-0.5878, -0.809), (-0.9511, 0.309)];
    let feet = FEET.map(|(x, y)| [(0.0, 0.0), (r * x, r * y)]);
    let feet: Vec<&[(f64, f64)]> = feet.iter().map(|l| l.as_slice()).collect();
    p.lines("f", &feet);
    for (x, y) in FEET {
        p.circle("b", (0.88 * r * x, 0.88 * r * y), 0.12 * r);
    }
    p.circle("b", (0.0, 0.0), 0.28 * r);
}

/// A crown of leaves around the stem.
pub(super) fn plant(p: &mut Pen<'_>) {
    let r = p.w.min(p.d) / 2.0;
    // Eight leaves: sixteen directions of the compass, tips and notches in turn.
    const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const QUARTER: [(f64, f64); 4] = [(1.0, 0.0), (0.9239, 0.3827), (D, D), (0.3827, 0.9239)];
    let ray = |i: usize| {
        let (x, y) = QUARTER[i % 4];
        match (i / 4) % 4 {
            0 => (x, y),
            1 => (-y, x),
            2 => (-x, -y),
            _ => (y, -x),
        }
    };
    let at = |i: usize, s: f64| (ray(i).0 * r * s, ray(i).1 * r * s);
    let curves: Vec<Curve> = (0..8).map(|i| (at(2 * i + 1, 1.36), at(2 * i + 2, 0.62))).collect();
    p.blob("p", at(0, 0.62), &curves);
    let veins: Vec<[(f64, f64); 2]> = (0..8).map(|i| [(0.0, 0.0), at(2 * i + 1, 0.62)]).collect();
    let veins: Vec<&[(f64, f64)]> = veins.iter().map(|l| l.as_slice()).collect();
    p.lines("pf", &veins);
}

/// A circle with a cross.
pub(super) fn lamp(p: &mut Pen<'_>) {
    let r = p.w.min(p.d) / 2.0;
    let x = std::f64::consts::FRAC_1_SQRT_2 * r;
    p.circle("b", (0.0, 0.0), r);
    p.lines("f", &[&[(-x, -x), (x, x)], &[(-x, x), (x, -x)]]);
    p.circle("s", (0.0, 0.0), 0.3 * r);
}

/// A body with its door line; low machines show a drum, tall ones a cross.
pub(super) fn appliance(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    let front = v - 0.06_f64.min(0.12 * p.d);
    p.outline("b", 0.02);
    p.lines("f", &[&[(-u, front), (u, front)]]);
    if p.h > 1.3 {
        p.lines("f", &[&[(-u, -v), (u, front)], &[(-u, front), (u, -v)]]);
    } else {
        let r = 0.5 * u.min(v);
        p.circle("f", (0.0, (front - v) / 2.0), r);
    }
}

/// A hob with four rings and its knobs.
pub(super) fn stove(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.02);
    let r = 0.32 * u.min(v);
    for (x, y, s) in [(-0.48, -0.45, 1.0), (0.48, -0.45, 0.8), (-0.48, 0.35, 0.8), (0.48, 0.35, 1.0)] {
        p.circle("s", (x * u, y * v), r * s);
        p.circle("f", (x * u, y * v), 0.45 * r * s);
    }
    p.lines("f", &[&[(-u, v - 0.04), (u, v - 0.04)]]);
}

/// A border and fringes at both ends.
pub(super) fn rug(p: &mut Pen<'_>) {
    p.outline("r", 0.0);
    let margin = 0.07 * p.w.min(p.d);
    p.inset("r", margin, 0.0);
    p.inset("r", 1.6 * margin, 0.0);
}

/// Folds along the rail.
pub(super) fn curtain(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    let folds = (p.w / 0.16).round().clamp(2.0, 60.0);
    let step = p.w / folds;
    let mut curves = Vec::new();
    for i in 0..folds as usize {
        let x = -u + step * i as f64;
        let side = if i % 2 == 0 { 1.0 } else { -1.0 };
        curves.push(((x + step / 2.0, side * 1.4 * v), (x + step, 0.0)));
    }
    p.curve("f", (-u, 0.0), &curves);
}

/// A back plate, a tray and a bolt.
pub(super) fn dock(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("g", 0.03);
    p.rect("g", (-u, -v), (u, -v + 0.25 * p.d), 0.02);
    let s = 0.62 * u.min(v);
    bolt(p, (0.0, 0.22 * v), s);
}

/// A bolt of lightning of half height `s`.
fn bolt(p: &mut Pen<'_>, (u, v): (f64, f64), s: f64) {
    let points = [(0.15, 1.0), (-0.55, -0.15), (-0.05, -0.15), (-0.15, -1.0), (0.55, 0.15), (0.05, 0.15)];
    p.polygon("gd", &points.map(|(x, y)| (u + x * s, v + y * s)));
}

/// Two circles.
pub(super) fn cylinder(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.ellipse("b", (0.0, 0.0), u, v);
    p.ellipse("f", (0.0, 0.0), 0.75 * u, 0.75 * v);
}

/// Hull, windows and lights; its front is up.
pub(super) fn vehicle(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.22 * p.w);
    let w = 0.8 * u;
    p.polygon("s", &[(-w, 0.35 * v), (w, 0.35 * v), (0.85 * w, 0.1 * v), (-0.85 * w, 0.1 * v)]);
    p.polygon("s", &[(-0.85 * w, -0.55 * v), (0.85 * w, -0.55 * v), (w, -0.75 * v), (-w, -0.75 * v)]);
    p.lines("f", &[&[(-0.85 * w, 0.1 * v), (-0.85 * w, -0.55 * v)], &[(0.85 * w, 0.1 * v), (0.85 * w, -0.55 * v)]]);
}

/// The ring of the machine and the couch through it.
pub(super) fn scanner(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.rect("b", (-u, -v), (u, -v + 0.42 * p.d), 0.12);
    p.lines("f", &[&[(-u, -v + 0.32 * p.d), (u, -v + 0.32 * p.d)]]);
    let couch = (0.3 * p.w).min(0.35);
    p.rect("b", (-couch, -v + 0.05 * p.d), (couch, v), 0.12);
    p.rect("s", (-0.6 * couch, -v + 0.1 * p.d), (0.6 * couch, -v + 0.22 * p.d), 0.06);
    p.lines("f", &[&[(-couch, 0.1 * v), (couch, 0.1 * v)]]);
}
