//! Tops.

use crate::exporters::plan::pen::Pen;

/// A top with soft corners and an inner line.
pub(super) fn table(p: &mut Pen<'_>) {
    p.outline("b", 0.06);
    p.inset("f", 0.07_f64.min(0.15 * p.w.min(p.d)), 0.04);
}

/// A round top.
pub(super) fn round_table(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.ellipse("b", (0.0, 0.0), u, v);
    p.ellipse("f", (0.0, 0.0), 0.86 * u, 0.86 * v);
}

/// A top with a cable strip at the rear and drawers at the right.
pub(super) fn desk(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.02);
    let drawers = (p.w * 0.3).min(0.42);
    p.lines("f", &[&[(-u, -v + 0.07), (u, -v + 0.07)]]);
    p.lines("h", &[&[(u - drawers, v - 0.02), (u - drawers, -v + 0.07)]]);
}

/// A worktop; high ones show the shelf for guests along the front.
pub(super) fn counter(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.01);
    if p.h > 1.0 {
        p.rect("s", (-u, 0.1 * v), (u, v), 0.0);
    } else {
        p.lines("f", &[&[(-u, v - 0.04), (u, v - 0.04)]]);
    }
}
