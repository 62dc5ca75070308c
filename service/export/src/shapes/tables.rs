//! Tops to work, eat and serve at.

use super::Tone::{Dark, Light, Main, Metal};
use super::body::Body;

/// A top on four legs.
pub(super) fn table(b: &mut Body) {
    let top = 0.04_f64.min(b.h * 0.2);
    b.legs(0.06, 0.02, [0.0, b.h - top], Dark);
    b.block([0.0, b.w], [0.0, b.d], [b.h - top, b.h], Main);
}

/// A round top on a column with a foot plate.
pub(super) fn round_table(b: &mut Body) {
    let top = 0.04_f64.min(b.h * 0.2);
    let (cx, cy, small) = (b.w / 2.0, b.d / 2.0, b.w.min(b.d));
    b.post(cx, cy, small * 0.28, [0.0, 0.03], Metal);
    b.post(cx, cy, small * 0.06, [0.03, b.h - top], Metal);
    b.round(0.0, [b.h - top, b.h], Main);
}

/// A top on two panels, a modesty panel at the rear, drawers on the right.
pub(super) fn desk(b: &mut Body) {
    let top = 0.03_f64.min(b.h * 0.2);
    let under = b.h - top;
    b.block([0.0, b.w], [0.0, b.d], [under, b.h], Main);
    for x in [[0.0, 0.03], [b.w - 0.03, b.w]] {
        b.block(x, [0.02, b.d], [0.0, under], Dark);
    }
    b.block([0.03, b.w - 0.03], [b.d - 0.02, b.d], [under * 0.45, under], Dark);
    let drawers = (b.w * 0.3).min(0.42);
    b.block([b.w - 0.03 - drawers, b.w - 0.03], [0.05, b.d * 0.75], [under * 0.2, under], Light);
}

/// A body with a front panel under a wider worktop; high ones carry a shelf for guests.
pub(super) fn counter(b: &mut Body) {
    let top = 0.04_f64.min(b.h * 0.1);
    if b.h > 1.0 {
        let work = b.h - 0.3;
        b.block([0.0, b.w], [0.0, b.d * 0.35], [0.0, b.h - top], Main);
        b.block([0.0, b.w], [0.0, b.d * 0.45], [b.h - top, b.h], Dark);
        b.block([0.0, b.w], [b.d * 0.35, b.d], [work - top, work], Light);
        for x in [[0.0, 0.03], [b.w - 0.03, b.w]] {
            b.block(x, [b.d * 0.35, b.d], [0.0, work - top], Main);
        }
    } else {
        b.block([0.02, b.w - 0.02], [0.06, b.d - 0.01], [0.0, 0.1_f64.min(b.h * 0.3)], Dark);
        b.block([0.0, b.w], [0.02, b.d], [0.1_f64.min(b.h * 0.3), b.h - top], Main);
        b.block([0.0, b.w], [0.0, b.d], [b.h - top, b.h], Light);
    }
}
