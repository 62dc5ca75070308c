//! Things with water: the wall is at the rear.

use super::Tone::{Dark, Glass, Light, Main, Metal, White};
use super::body::Body;

/// A cupboard with a worktop, a bowl let into it and a tap.
pub(super) fn sink(b: &mut Body) {
    let top = (b.h - 0.22).max(b.h * 0.75);
    b.block([0.0, b.w], [0.03, b.d], [0.0, top - 0.04], Main);
    let bowl = [(b.w * 0.5 - 0.28).max(b.w * 0.12), (b.w * 0.5 + 0.28).min(b.w * 0.88)];
    let deep = [b.d * 0.15, b.d * 0.78];
    b.block([0.0, bowl[0]], [0.0, b.d], [top - 0.04, top], Light);
    b.block([bowl[1], b.w], [0.0, b.d], [top - 0.04, top], Light);
    b.block(bowl, [0.0, deep[0]], [top - 0.04, top], Light);
    b.block(bowl, [deep[1], b.d], [top - 0.04, top], Light);
    b.block(bowl, deep, [top - 0.04, top - 0.02], Metal);
    tap(b, b.d * 0.88, top);
}

/// A bowl with a rim on a pedestal (or on the wall) and a tap.
pub(super) fn basin(b: &mut Body) {
    let top = b.h - (b.h * 0.15).min(0.15);
    let bowl = (top * 0.6).min(0.18);
    b.block([b.w * 0.38, b.w * 0.62], [b.d * 0.5, b.d], [0.0, top - bowl], Main);
    b.block([b.w * 0.08, b.w * 0.92], [b.d * 0.08, b.d], [top - bowl, top - 0.05_f64.min(bowl * 0.4)], Main);
    let rim = 0.05_f64.min(bowl * 0.4);
    b.block([0.0, b.w], [0.0, b.d * 0.14], [top - rim, top], Main);
    b.block([0.0, b.w], [b.d * 0.75, b.d], [top - rim, top], Main);
    b.block([0.0, b.w * 0.12], [b.d * 0.14, b.d * 0.75], [top - rim, top], Main);
    b.block([b.w * 0.88, b.w], [b.d * 0.14, b.d * 0.75], [top - rim, top], Main);
    tap(b, b.d * 0.88, top);
}

fn tap(b: &mut Body, y: f64, top: f64) {
    let radius = 0.018_f64.min(b.w * 0.1);
    b.post(b.w / 2.0, y, radius, [top, b.h], Metal);
    b.block([b.w / 2.0 - radius, b.w / 2.0 + radius], [b.d * 0.55, y], [b.h - 0.03_f64.min(b.h * 0.05), b.h], Metal);
}

/// Cistern at the wall, bowl and seat before it.
pub(super) fn toilet(b: &mut Body) {
    let seat = (b.h * 0.55).min(0.42);
    let cistern = b.d * 0.72;
    b.block([0.0, b.w], [cistern, b.d], [seat * 0.8, b.h], Main);
    b.block([b.w * 0.25, b.w * 0.75], [b.d * 0.25, b.d * 0.9], [0.0, seat * 0.6], Main);
    b.block([b.w * 0.06, b.w * 0.94], [b.d * 0.2, cistern], [seat * 0.6, seat], Main);
    let r = b.w * 0.44;
    b.block([b.w * 0.35, b.w * 0.65], [0.0, b.d * 0.3], [seat * 0.65, seat], Main);
    b.post(b.w / 2.0, r, r, [seat * 0.65, seat], Main);
    b.post(b.w / 2.0, r, r * 0.7, [seat, seat + 0.02], Dark);
}

/// Four walls, a floor and a tap.
pub(super) fn bathtub(b: &mut Body) {
    let rim = 0.07_f64.min(b.w.min(b.d) * 0.12);
    b.block([0.0, b.w], [0.0, b.d], [0.0, b.h * 0.25], Main);
    b.block([0.0, b.w], [0.0, rim], [b.h * 0.25, b.h], Main);
    b.block([0.0, b.w], [b.d - rim, b.d], [b.h * 0.25, b.h], Main);
    b.block([0.0, rim], [rim, b.d - rim], [b.h * 0.25, b.h], Main);
    b.block([b.w - rim, b.w], [rim, b.d - rim], [b.h * 0.25, b.h], Main);
}

/// A toilet between partitions on feet; the door stands in front.
pub(super) fn cubicle(b: &mut Body) {
    let panel = 0.02_f64.min(b.w.min(b.d) * 0.1);
    let foot = 0.12_f64.min(b.h * 0.1);
    for x in [[0.0, panel], [b.w - panel, b.w]] {
        b.block(x, [0.0, b.d], [foot, b.h], Main);
        b.block(x, [b.d * 0.04, b.d * 0.08], [0.0, foot], Metal);
        b.block(x, [b.d * 0.92, b.d * 0.96], [0.0, foot], Metal);
    }
    b.block([panel, b.w - panel], [0.0, panel], [foot, b.h], Main);
    b.block([b.w * 0.75, b.w * 0.85], [panel, panel * 1.5], [b.h * 0.48, b.h * 0.52], Metal);
    b.block([b.w * 0.29, b.w * 0.71], [b.d * 0.87, b.d], [b.h * 0.18, b.h * 0.4], White);
    b.block([b.w * 0.37, b.w * 0.63], [b.d * 0.65, b.d * 0.92], [0.0, b.h * 0.15], White);
    b.block([b.w * 0.3, b.w * 0.7], [b.d * 0.58, b.d * 0.87], [b.h * 0.15, b.h * 0.21], White);
}

/// Tray, a glass screen at the left, pole and head at the rear.
pub(super) fn shower(b: &mut Body) {
    let tray = 0.05_f64.min(b.h * 0.2);
    b.block([0.0, b.w], [0.0, b.d], [0.0, tray], White);
    b.block([0.0, 0.01], [0.0, b.d], [tray, b.h * 0.92], Glass);
    b.block([b.w / 2.0 - 0.012, b.w / 2.0 + 0.012], [b.d - 0.03, b.d], [b.h * 0.45, b.h], Metal);
    b.block([b.w / 2.0 - 0.012, b.w / 2.0 + 0.012], [b.d * 0.65, b.d], [b.h - 0.025, b.h], Metal);
    b.post(b.w / 2.0, b.d * 0.65, 0.1, [b.h - 0.04, b.h - 0.02], Metal);
}
