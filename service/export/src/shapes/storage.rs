//! Things that hold things.

use super::Axis;
use super::Tone::{Dark, Light, Main, Metal};
use super::body::Body;

/// A plain body.
pub(super) fn plain(b: &mut Body) {
    b.block([0.0, b.w], [0.0, b.d], [0.0, b.h], Main);
}

/// A carcass with doors (tall) or drawers (low) in front.
pub(super) fn cabinet(b: &mut Body) {
    let door = 0.02_f64.min(b.d * 0.1);
    b.block([0.0, b.w], [door, b.d], [0.0, b.h], Main);
    let (columns, rows) = if b.h > 1.0 {
        ((b.w / 0.5).round().max(1.0), 1.0)
    } else {
        ((b.w / 0.6).round().max(1.0), (b.h / 0.25).round().max(1.0))
    };
    let plinth = if b.h > 0.5 { 0.06 } else { 0.0 };
    let (width, height) = (b.w / columns, (b.h - plinth) / rows);
    for c in 0..columns as usize {
        for r in 0..rows as usize {
            let (x, z) = (width * c as f64, plinth + height * r as f64);
            b.block([x + 0.004, x + width - 0.004], [0.0, door], [z + 0.004, z + height - 0.004], Light);
        }
    }
}

/// Sides, back and boards every 35 cm.
pub(super) fn shelf(b: &mut Body) {
    let board = 0.025_f64.min(b.h * 0.1).min(b.w * 0.1);
    for x in [[0.0, board], [b.w - board, b.w]] {
        b.block(x, [0.0, b.d], [0.0, b.h], Main);
    }
    b.block([board, b.w - board], [b.d - 0.01, b.d], [0.0, b.h], Dark);
    let levels = (b.h / 0.35).round().max(1.0);
    for i in 0..=levels as usize {
        let z = (b.h - board) * i as f64 / levels;
        b.block([board, b.w - board], [0.0, b.d - 0.01], [z, z + board], Main);
    }
}

/// Uprights, beams and decks of pallet racking.
pub(super) fn rack(b: &mut Body) {
    let bays = (b.w / 2.7).round().max(1.0);
    let post = 0.1_f64.min(b.w * 0.1).min(b.d * 0.2);
    for i in 0..=bays as usize {
        let x = (b.w - post) * i as f64 / bays;
        for y in [0.0, b.d - post] {
            b.block([x, x + post], [y, y + post], [0.0, b.h], Main);
        }
    }
    let levels = (b.h / 1.6).floor().max(1.0);
    for i in 0..levels as usize {
        let z = (b.h * 0.97) * (i as f64 + 0.6) / levels;
        for y in [[0.0, 0.05], [b.d - 0.05, b.d]] {
            b.block([0.0, b.w], y, [z, z + 0.1], Dark);
        }
        b.block([0.0, b.w], [0.05, b.d - 0.05], [z + 0.06, z + 0.09], Metal);
    }
}

/// A body on wheels with a push handle at the rear.
pub(super) fn trolley(b: &mut Body) {
    let floor = b.wheels(0.1);
    let top = b.h * 0.88;
    let shelf = 0.03_f64.min(b.h * 0.1);
    for z in [floor, (floor + top) / 2.0, top - shelf] {
        b.block([0.0, b.w], [0.0, b.d * 0.94], [z, z + shelf], Main);
    }
    b.block([b.w * 0.08, b.w * 0.92], [b.d * 0.06, b.d * 0.8], [floor + shelf, (floor + top) / 2.0], Light);
    for x in [[0.0, 0.025], [b.w - 0.025, b.w]] {
        b.block(x, [b.d * 0.9, b.d], [floor, b.h], Metal);
        b.block(x, [0.0, 0.025], [floor, top], Metal);
    }
    b.bar([b.w / 2.0, b.d * 0.95, b.h - 0.015], 0.015, b.w, Axis::X, Metal);
}
