//! Things to sit on: the seat is at 45 cm or at half the height of low pieces, the back at the rear.

use super::Tone::{Dark, Light, Main, Metal};
use super::body::Body;

/// Height of the seat's top for a piece with a back.
fn seat_height(b: &Body) -> f64 {
    (b.h * 0.52).min(0.46)
}

/// Seat, back, four legs.
pub(super) fn chair(b: &mut Body) {
    let seat = seat_height(b);
    b.legs(0.035, 0.0, [0.0, seat - 0.04], Dark);
    b.block([0.0, b.w], [0.0, b.d], [seat - 0.04, seat], Main);
    b.block([0.0, 0.035], [b.d - 0.035, b.d], [seat, b.h], Dark);
    b.block([b.w - 0.035, b.w], [b.d - 0.035, b.d], [seat, b.h], Dark);
    b.block([0.035, b.w - 0.035], [b.d - 0.03, b.d], [seat + 0.4 * (b.h - seat), b.h], Main);
}

/// Seat, back, arms, column and a cross of feet on the floor.
pub(super) fn swivel_chair(b: &mut Body) {
    let seat = seat_height(b);
    let (cx, cy) = (b.w / 2.0, b.d / 2.0);
    b.block([0.0, b.w], [cy - 0.025, cy + 0.025], [0.0, 0.06], Dark);
    b.block([cx - 0.025, cx + 0.025], [0.0, b.d], [0.0, 0.06], Dark);
    b.post(cx, cy, 0.03, [0.06, seat - 0.07], Metal);
    b.block([b.w * 0.1, b.w * 0.9], [b.d * 0.05, b.d * 0.88], [seat - 0.07, seat], Main);
    b.block([b.w * 0.12, b.w * 0.88], [b.d * 0.88, b.d * 0.97], [seat + 0.05, b.h], Main);
    for x in [[b.w * 0.02, b.w * 0.1], [b.w * 0.9, b.w * 0.98]] {
        b.block(x, [b.d * 0.3, b.d * 0.75], [seat + 0.17, seat + 0.2], Dark);
        b.block(x, [b.d * 0.5, b.d * 0.56], [seat - 0.05, seat + 0.17], Dark);
    }
}

/// A round seat on four legs.
pub(super) fn stool(b: &mut Body) {
    b.legs(0.03, 0.12 * b.w.min(b.d), [0.0, b.h - 0.04], Metal);
    b.round(0.0, [b.h - 0.04, b.h], Main);
}

/// Base, cushions one per 0.7 m, back and arms.
pub(super) fn sofa(b: &mut Body) {
    let seat = (b.h * 0.52).min(0.44);
    let arm = (b.w * 0.12).min(0.18);
    let back = (b.d * 0.28).min(0.24);
    b.block([arm, b.w - arm], [0.02, b.d - back], [0.05, seat - 0.14], Dark);
    b.block([0.0, b.w], [b.d - back, b.d], [0.0, b.h], Main);
    for x in [[0.0, arm], [b.w - arm, b.w]] {
        b.block(x, [0.0, b.d - back], [0.0, (seat + 0.2).min(b.h)], Main);
    }
    let seats = ((b.w - 2.0 * arm) / 0.7).round().max(1.0);
    let width = (b.w - 2.0 * arm) / seats;
    for i in 0..seats as usize {
        let x = arm + width * i as f64;
        b.block([x + 0.005, x + width - 0.005], [0.0, b.d - back], [seat - 0.14, seat], Light);
    }
}

/// A row of seats on a beam; without room for a back it is a plain bench.
pub(super) fn bench(b: &mut Body) {
    let backed = b.h > 0.6;
    let seat = if backed { seat_height(b) } else { b.h };
    for x in [b.w * 0.12, b.w * 0.82] {
        b.block([x, x + 0.06 * b.w.min(1.0)], [0.0, b.d], [0.0, 0.03], Metal);
        b.block([x, x + 0.06 * b.w.min(1.0)], [b.d * 0.4, b.d * 0.55], [0.03, seat - 0.08], Metal);
    }
    b.block([0.0, b.w], [b.d * 0.42, b.d * 0.52], [seat - 0.08, seat - 0.04], Metal);
    let seats = (b.w / 0.6).round().max(1.0);
    let width = b.w / seats;
    for i in 0..seats as usize {
        let gap = if seats > 1.0 { 0.015 } else { 0.0 };
        let left = width * i as f64 + if i == 0 { 0.0 } else { gap };
        let right = width * (i + 1) as f64 - if i + 1 == seats as usize { 0.0 } else { gap };
        b.block([left, right], [0.0, b.d], [seat - 0.04, seat], Main);
        if backed {
            b.block([left, right], [b.d - 0.04, b.d], [seat + 0.08, b.h], Main);
        }
    }
}
