//! Machines, lamps, plants and everything else with one body.

use super::Axis;
use super::Tone::{Black, Dark, Glass, Green, Light, Main, Metal, White};
use super::body::Body;

/// A thin upright panel: a frame around a face; a thick one (a screen on its foot) gets a foot.
pub(super) fn panel(b: &mut Body) {
    let footed = b.d > 0.12 && b.h > 0.25;
    let (front, back) = if footed { (b.d * 0.4, b.d * 0.4 + 0.05_f64.min(b.d * 0.4)) } else { (0.0, b.d) };
    let low = if footed { b.h * 0.15 } else { 0.0 };
    if footed {
        b.block([b.w * 0.25, b.w * 0.75], [0.0, b.d], [0.0, 0.02], Dark);
        b.block([b.w * 0.46, b.w * 0.54], [b.d * 0.4, b.d * 0.6], [0.02, low + 0.05], Dark);
    }
    let face = (back - front) * 0.2;
    b.block([0.0, b.w], [front + face, back], [low, b.h], Dark);
    let edge = 0.02_f64.min(b.w * 0.05).min(b.h * 0.05);
    b.block([edge, b.w - edge], [front, front + face], [low + edge, b.h - edge], Main);
}

/// A pole on a cross of feet with a crossbar on top.
pub(super) fn pole(b: &mut Body) {
    let (cx, cy) = (b.w / 2.0, b.d / 2.0);
    b.block([0.0, b.w], [cy - 0.02, cy + 0.02], [0.0, 0.05], Metal);
    b.block([cx - 0.02, cx + 0.02], [0.0, b.d], [0.0, 0.05], Metal);
    b.post(cx, cy, 0.015, [0.05, b.h], Main);
    b.block([b.w * 0.2, b.w * 0.8], [cy - 0.01, cy + 0.01], [b.h - 0.04, b.h - 0.02], Main);
}

/// Foliage in a pot.
pub(super) fn plant(b: &mut Body) {
    let (cx, cy, small) = (b.w / 2.0, b.d / 2.0, b.w.min(b.d));
    let pot = b.h * 0.3;
    b.post(cx, cy, small * 0.32, [0.0, pot], Main);
    b.post(cx, cy, small * 0.05, [pot, b.h * 0.6], Dark);
    let crown = (b.h - pot).min(small) / 2.0;
    // A flat disc keeps the foliage as wide as the footprint says.
    b.round(0.0, [pot + crown * 0.7, pot + crown * 1.1], Green);
    b.ball(cx, cy, pot + crown, crown, Green);
    b.ball(cx, cy, b.h - small * 0.35, small * 0.35, Green);
}

/// A foot, a stem and a shade; the shade of a hanging lamp hangs from its cord.
pub(super) fn lamp(b: &mut Body) {
    let (cx, cy, small) = (b.w / 2.0, b.d / 2.0, b.w.min(b.d));
    if b.h < 0.15 {
        b.block([b.w * 0.05, b.w * 0.95], [b.d * 0.05, b.d * 0.95], [0.0, b.h * 0.6], White);
        b.block([0.0, b.w], [0.0, b.d], [b.h * 0.6, b.h], Main);
        return;
    }
    b.post(cx, cy, small * 0.35, [0.0, b.h * 0.03], Dark);
    b.post(cx, cy, small * 0.04, [b.h * 0.03, b.h * 0.8], Metal);
    b.round(0.0, [b.h * 0.68, b.h], Main);
}

/// A body with a door or window in front and a strip of controls above it.
pub(super) fn appliance(b: &mut Body) {
    let front = 0.03_f64.min(b.d * 0.1);
    b.block([0.0, b.w], [front, b.d], [0.0, b.h], Main);
    let strip = (b.h * 0.15).min(0.15);
    b.block([0.01, b.w - 0.01], [front * 0.4, front], [b.h * 0.03, b.h - strip], Light);
    b.block([0.01, b.w - 0.01], [front * 0.4, front], [b.h - strip * 0.9, b.h - 0.01], Black);
    b.block([b.w * 0.86, b.w * 0.9], [0.0, front * 0.4], [b.h * 0.35, (b.h - strip) * 0.8], Metal);
}

/// An oven with its door, and four rings on the hob.
pub(super) fn stove(b: &mut Body) {
    let top = b.h - 0.015_f64.min(b.h * 0.1);
    b.block([0.0, b.w], [0.02, b.d], [0.0, top - 0.01], Main);
    b.block([0.0, b.w], [0.0, b.d], [top - 0.01, top], Black);
    b.block([b.w * 0.08, b.w * 0.92], [0.005, 0.02], [b.h * 0.2, b.h * 0.7], Black);
    for (x, y) in [(0.27, 0.3), (0.73, 0.3), (0.27, 0.72), (0.73, 0.72)] {
        b.post(b.w * x, b.d * y, b.w.min(b.d) * 0.17, [top, b.h], Metal);
    }
}

/// A thin cover with a border.
pub(super) fn rug(b: &mut Body) {
    let edge = 0.08 * b.w.min(b.d);
    b.block([0.0, b.w], [0.0, b.d], [0.0, b.h * 0.8], Dark);
    b.block([edge, b.w - edge], [edge, b.d - edge], [b.h * 0.8, b.h], Main);
}

/// A rail with folds hanging from it.
pub(super) fn curtain(b: &mut Body) {
    b.bar([b.w / 2.0, b.d / 2.0, b.h - 0.015], 0.015, b.w, Axis::X, Metal);
    let folds = (b.w / 0.12).round().clamp(2.0, 40.0);
    let width = b.w / folds;
    for i in 0..folds as usize {
        let (y, tone) = if i % 2 == 0 { ([0.0, b.d * 0.6], Main) } else { ([b.d * 0.4, b.d], Light) };
        b.block([width * i as f64, width * (i + 1) as f64], y, [0.0, b.h - 0.0101], tone);
    }
    b.block([0.0, 0.01], [0.0, b.d], [b.h - 0.03, b.h], Metal);
}

/// A back plate at the wall, a ramp with two contacts before it.
pub(super) fn dock(b: &mut Body) {
    let plate = (b.d * 0.3).min(0.15);
    b.block([0.0, b.w], [b.d - plate, b.d], [0.0, b.h], Main);
    b.block([0.0, b.w], [0.0, b.d - plate], [0.0, 0.015_f64.min(b.h * 0.2)], Dark);
    for x in [0.3, 0.6] {
        let z = [b.h * 0.3, b.h * 0.4];
        b.block([b.w * x, b.w * (x + 0.1)], [b.d - plate - 0.01, b.d - plate], z, Metal);
    }
}

/// A drum.
pub(super) fn cylinder(b: &mut Body) {
    b.round(0.0, [0.0, b.h], Main);
}

/// Wheels, hull, cabin and windows; it drives towards its front.
pub(super) fn vehicle(b: &mut Body) {
    let r = (b.h * 0.2).min(0.325).min(b.d * 0.15);
    for x in [0.11, b.w - 0.11] {
        for y in [b.d * 0.2, b.d * 0.8] {
            b.bar([x, y, r], r, 0.22, Axis::X, Black);
        }
    }
    b.block([0.0, b.w], [0.0, b.d], [r * 0.8, b.h * 0.58], Main);
    b.block([b.w * 0.08, b.w * 0.92], [b.d * 0.25, b.d * 0.85], [b.h * 0.58, b.h * 0.9], Glass);
    b.block([b.w * 0.08, b.w * 0.92], [b.d * 0.3, b.d * 0.82], [b.h * 0.9, b.h], Main);
}

/// An upright ring of four beams with a couch through it.
pub(super) fn scanner(b: &mut Body) {
    let ring = [b.d * 0.55, b.d];
    let (hole, low, high) = ([b.w * 0.3, b.w * 0.7], b.h * 0.32, b.h * 0.76);
    b.block([0.0, hole[0]], ring, [0.0, b.h], Main);
    b.block([hole[1], b.w], ring, [0.0, b.h], Main);
    b.block(hole, ring, [0.0, low], Main);
    b.block(hole, ring, [high, b.h], Main);
    b.block([b.w * 0.4, b.w * 0.6], [b.d * 0.12, b.d * 0.5], [0.0, low], Light);
    b.block([b.w * 0.36, b.w * 0.64], [0.0, b.d * 0.95], [low, low + 0.08], White);
}
