//! Seats and beds: the back or head is at the rear (-v).

use crate::exporters::plan::pen::Pen;

/// A seat and a curved back.
pub(super) fn chair(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.rect("b", (-u, -v + 0.12 * p.d), (u, v), 0.25 * u);
    back(p, 0.9 * u);
}

/// A thick curved bar along the rear edge, as wide as twice `u`.
fn back(p: &mut Pen<'_>, u: f64) {
    let v = p.d / 2.0;
    let (outer, inner) = (-v, -v + 0.16 * p.d);
    let bow = 0.06 * p.d;
    p.blob(
        "b",
        (-u, outer + bow),
        &[
            ((0.0, outer - bow), (u, outer + bow)),
            ((u * 1.02, inner), (u * 0.96, inner + bow)),
            ((0.0, inner - bow), (-u * 0.96, inner + bow)),
            ((-u * 1.02, inner), (-u, outer + bow)),
        ],
    );
}

/// A round seat with arms and a curved back.
pub(super) fn swivel_chair(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.rect("s", (-u, -0.35 * v), (-0.78 * u, 0.45 * v), 0.1 * u);
    p.rect("s", (0.78 * u, -0.35 * v), (u, 0.45 * v), 0.1 * u);
    p.rect("b", (-0.8 * u, -0.8 * v), (0.8 * u, 0.9 * v), 0.5 * u);
    back(p, 0.75 * u);
}

/// Two circles.
pub(super) fn stool(p: &mut Pen<'_>) {
    let r = p.w.min(p.d) / 2.0;
    p.circle("b", (0.0, 0.0), r);
    p.circle("f", (0.0, 0.0), 0.68 * r);
}

/// Body, back, arms and a cushion per seat.
pub(super) fn sofa(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    let arm = (p.w * 0.12).min(0.18);
    let back = (p.d * 0.26).min(0.24);
    p.outline("b", 0.1);
    let seats = ((p.w - 2.0 * arm) / 0.7).round().max(1.0);
    let width = (p.w - 2.0 * arm) / seats;
    for i in 0..seats as usize {
        let left = -u + arm + width * i as f64;
        p.rect("s", (left, -v + back), (left + width, v - 0.03), 0.07);
    }
    p.lines("f", &[&[(-u + 0.04, -v + back), (-u + arm, -v + back)], &[(u - 0.04, -v + back), (u - arm, -v + back)]]);
}

/// Seats in a row with a rail behind them.
pub(super) fn bench(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    let seats = (p.w / 0.6).round().max(1.0);
    let width = p.w / seats;
    let backed = p.h > 0.6;
    let rail = if backed { 0.14 * p.d } else { 0.0 };
    for i in 0..seats as usize {
        let left = -u + width * i as f64;
        let gap = if seats > 1.0 { 0.012 } else { 0.0 };
        p.rect("b", (left + gap, -v + rail), (left + width - gap, v), if backed { 0.07 } else { 0.02 });
    }
    if backed {
        p.rect("b", (-u, -v), (u, -v + rail), 0.03);
    }
}

/// Narrowest bed to sleep in, and shortest couch to be treated on, m.
const NARROWEST_BED_M: f64 = 0.85;
const SHORTEST_COUCH_M: f64 = 1.7;

/// The padded top of a couch to be examined or treated on, with its head part; nobody sleeps there.
fn couch(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    let head = -v + 0.28 * p.d;
    p.rect("b", (-u, -v), (u, v), 0.08);
    p.lines("f", &[&[(-u, head), (u, head)], &[(-0.45 * u, -v + 0.12), (0.45 * u, -v + 0.12)]]);
}

/// Headboard, mattress, pillows and the blanket with its corner turned back.
pub(super) fn bed(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    if p.w < NARROWEST_BED_M && p.d > SHORTEST_COUCH_M {
        return couch(p);
    }
    let head = 0.06_f64.min(0.05 * p.d);
    p.rect("b", (-u, -v + head), (u, v), 0.05);
    p.rect("s", (-u, -v), (u, -v + head), 0.0);
    let count = if p.w > 1.25 { 2 } else { 1 };
    let width = (p.w / f64::from(count)).min(0.85);
    let pillow = (p.d * 0.19).min(0.4);
    for i in 0..count {
        let middle = -u + p.w * (f64::from(i) + 0.5) / f64::from(count);
        let low = -v + head + 0.06;
        p.rect("s", (middle - 0.41 * width, low), (middle + 0.41 * width, low + pillow), 0.09);
    }
    let fold = -v + head + pillow + 0.16;
    let corner = (0.36 * p.w).min(0.36);
    p.rect("b", (-u, fold), (u, v), 0.05);
    p.lines("f", &[&[(-u, fold + 0.14), (u - corner, fold + 0.14)]]);
    p.polygon("s", &[(u, fold), (u - corner, fold), (u, fold + corner)]);
}

/// Panels at head and foot, mattress, pillow, blanket, rails and four wheels.
pub(super) fn hospital_bed(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    let panel = 0.05_f64.min(0.04 * p.d);
    p.rect("b", (-0.94 * u, -v + panel), (0.94 * u, v - panel), 0.05);
    p.rect("s", (-0.55 * u, -v + panel + 0.08), (0.55 * u, -v + panel + 0.42), 0.09);
    let fold = -v + 0.3 * p.d;
    p.rect("b", (-0.94 * u, fold), (0.94 * u, v - panel), 0.05);
    p.lines("f", &[&[(-0.94 * u, fold + 0.16), (0.94 * u, fold + 0.16)]]);
    for side in [-1.0, 1.0] {
        p.rect("s", (side * 0.94 * u, -v + 0.18 * p.d), (side * u, -v + 0.42 * p.d), 0.0);
        p.rect("s", (side * 0.94 * u, -v + 0.46 * p.d), (side * u, -v + 0.7 * p.d), 0.0);
    }
    p.rect("d", (-u, -v), (u, -v + panel), 0.0);
    p.rect("d", (-0.9 * u, v - panel), (0.9 * u, v), 0.0);
}
