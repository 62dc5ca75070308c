//! Beds: the head at the rear, the user gets in from the front and the sides.

use super::Tone::{Dark, Light, Main, Metal, White};
use super::body::Body;

/// Frame, mattress, one or two pillows, blanket and headboard.
pub(super) fn bed(b: &mut Body) {
    let top = (b.h * 0.6).min(0.5);
    let head = b.d - 0.06_f64.min(b.d * 0.05);
    b.block([0.0, b.w], [head, b.d], [0.0, b.h], Dark);
    b.block([0.0, b.w], [0.0, head], [top * 0.2, top * 0.6], Dark);
    b.legs(0.06, 0.0, [0.0, top * 0.2], Dark);
    b.block([0.02, b.w - 0.02], [0.02, head], [top * 0.6, top], White);
    b.block([0.0, b.w], [0.0, b.d * 0.68], [top * 0.75, top + 0.03], Main);
    let count = if b.w > 1.25 { 2 } else { 1 };
    let width = (b.w / f64::from(count)).min(0.8);
    for i in 0..count {
        let middle = b.w * (f64::from(i) + 0.5) / f64::from(count);
        b.block(
            [middle - width * 0.42, middle + width * 0.42],
            [head - b.d * 0.2, head - 0.03],
            [top, top + 0.1],
            Light,
        );
    }
}

/// Wheels, frame, mattress, head and foot panels, side rails.
pub(super) fn hospital_bed(b: &mut Body) {
    let top = (b.h * 0.65).min(0.6);
    let panel = 0.05_f64.min(b.d * 0.04);
    let floor = b.wheels(0.15);
    b.block([b.w * 0.25, b.w * 0.75], [b.d * 0.2, b.d * 0.8], [floor * 0.6, top * 0.6], Metal);
    b.block([0.04, b.w - 0.04], [panel, b.d - panel], [top * 0.6, top * 0.72], Metal);
    b.block([0.06, b.w - 0.06], [panel, b.d - panel], [top * 0.72, top], White);
    b.block([0.06, b.w - 0.06], [panel, b.d * 0.62], [top, top + 0.03], Light);
    b.block([b.w * 0.22, b.w * 0.78], [b.d * 0.76, b.d * 0.93], [top, top + 0.09], White);
    b.block([0.0, b.w], [b.d - panel, b.d], [floor, b.h], Main);
    b.block([0.0, b.w], [0.0, panel], [floor, b.h * 0.85], Main);
    for x in [[0.0, 0.03], [b.w - 0.03, b.w]] {
        b.block(x, [b.d * 0.42, b.d * 0.85], [top * 0.95, (top + 0.3).min(b.h)], Main);
    }
}
