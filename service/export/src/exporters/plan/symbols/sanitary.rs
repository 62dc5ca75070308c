//! Things with water: the wall is at the rear (-v).

use crate::exporters::plan::pen::Pen;

/// Worktop, bowl with drain, tap and the ribs of a draining board.
pub(super) fn sink(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.0);
    p.lines("f", &[&[(-u, v - 0.04), (u, v - 0.04)]]);
    // the bowl of a long top leaves room for what stands beside it; as models have it, it is to the left of who stands there
    let bowl = if p.w > 1.0 { 0.21 } else { (0.26_f64).min(0.8 * u) };
    let at = if p.w > 1.0 { u - bowl - 0.1 } else { 0.0 };
    p.rect("s", (at - bowl, -0.55 * v), (at + bowl, 0.62 * v), 0.07);
    p.circle("f", (at, 0.05 * v), 0.035);
    tap(p, at, -0.78 * v);
    if p.w > 1.0 {
        let right = at - bowl - 0.08;
        let left = (right - 0.4).max(0.06 - u);
        let ribs: Vec<[(f64, f64); 2]> =
            (0..5).map(|i| -0.45 + 0.24 * f64::from(i)).map(|y| [(left, y * v), (right, y * v)]).collect();
        let ribs: Vec<&[(f64, f64)]> = ribs.iter().map(|l| l.as_slice()).collect();
        p.lines("f", &ribs);
    }
}

/// A basin with a rounded front, an oval bowl and a tap.
pub(super) fn basin(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.blob(
        "b",
        (-u, -v),
        &[
            ((0.0, -v), (u, -v)),
            ((u, -0.4 * v), (u, 0.1 * v)),
            ((u, v), (0.0, v)),
            ((-u, v), (-u, 0.1 * v)),
            ((-u, -0.4 * v), (-u, -v)),
        ],
    );
    p.ellipse("s", (0.0, 0.12 * v), 0.7 * u, 0.62 * v);
    p.circle("f", (0.0, 0.12 * v), 0.03);
    tap(p, 0.0, -0.74 * v);
}

fn tap(p: &mut Pen<'_>, u: f64, v: f64) {
    p.circle("b", (u, v), 0.03);
    p.lines("f", &[&[(u, v), (u, v + 0.12)]]);
}

/// Cistern at the wall, oval bowl and seat.
pub(super) fn toilet(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    let cistern = -v + 0.26 * p.d;
    p.rect("b", (-u, -v), (u, cistern), 0.04);
    let w = 0.9 * u;
    let bowl = |s: f64, low: f64, high: f64, p: &mut Pen<'_>, class: &str| {
        let w = w * s;
        p.blob(
            class,
            (-0.72 * w, low),
            &[
                ((0.0, low), (0.72 * w, low)),
                ((w, low), (w, low + 0.35 * (high - low))),
                ((w, high), (0.0, high)),
                ((-w, high), (-w, low + 0.35 * (high - low))),
                ((-w, low), (-0.72 * w, low)),
            ],
        );
    };
    bowl(1.0, cistern, v, p, "b");
    bowl(0.68, cistern + 0.1 * p.d, v - 0.07 * p.d, p, "s");
}

/// A rim, the tub inside and its drain.
pub(super) fn bathtub(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.03);
    let rim = 0.08_f64.min(0.15 * p.d);
    p.rect("s", (-u + rim, -v + rim), (u - rim, v - rim), 0.22);
    p.circle("f", (u - rim - 0.2, 0.0), 0.035);
    p.circle("b", (u - 0.5 * rim, 0.0), 0.03);
}

/// Partitions on three sides, a door in front, the toilet at the back.
pub(super) fn cubicle(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("s", 0.0);
    p.rect("b", (-0.2, 0.02 - v), (0.2, 0.2 - v), 0.03);
    p.ellipse("b", (0.0, 0.44 - v), 0.18, 0.24);
    p.ellipse("f", (0.0, 0.44 - v), 0.11, 0.16);
    let partition = 0.03;
    for side in [-u, u - partition] {
        p.rect("d", (side, -v), (side + partition, v), 0.0);
    }
    p.rect("d", (-u, v - partition), (-0.5 * u, v), 0.0);
    p.rect("d", (0.7 * u, v - partition), (u, v), 0.0);
    p.lines("f", &[&[(0.7 * u, v - partition), (0.7 * u - 0.2, v - 1.1 * u)]]);
}

/// A tray with falls to the drain.
pub(super) fn shower(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.0);
    p.inset("s", 0.04, 0.04);
    let (a, b) = (u - 0.04, v - 0.04);
    p.lines("f", &[&[(-a, -b), (a, b)], &[(-a, b), (a, -b)]]);
    p.circle("b", (0.0, 0.0), 0.055);
}
