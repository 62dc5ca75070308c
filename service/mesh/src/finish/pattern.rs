//! The patterns of finishes: shade, joint and height of each texel.

use super::noise::{hash, layers, points, value};
use super::{Finish, Pattern};

/// A texel of a pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Texel {
    /// From dark, 0, to light, 1.
    pub tone: f64,
    /// From 0 to 1 of the relief.
    pub height: f64,
    /// In a gap between units.
    pub joint: bool,
}

/// Where a texel lies.
struct Place {
    /// Width of a gap between units that is drawn: at least as wide as a texel, m.
    joint_m: f64,
    /// From 0 to 1 across and down the picture.
    x: f64,
    y: f64,
    /// How many units go across and down.
    cells: [usize; 2],
}

/// Returns the texels of a picture, row by row from the top.
pub(super) fn texels(finish: &Finish, side: usize) -> Vec<Texel> {
    let count = |i: usize| (finish.size_m[i] / finish.unit_m[i]).round().max(1.0) as usize;
    let cells = [count(0), count(1)];
    let at = |i: usize| (i as f64 + 0.5) / side as f64;
    let joint_m = finish.joint_m.max(1.02 * finish.size_m[0].max(finish.size_m[1]) / side as f64);
    let place = |i: usize| Place { joint_m, x: at(i % side), y: at(i / side), cells };
    (0..side * side).map(|i| texel(finish, &place(i))).collect()
}

fn texel(finish: &Finish, p: &Place) -> Texel {
    match finish.pattern {
        Pattern::Planks => planks(finish, p),
        Pattern::Tiles => tiles(finish, p),
        Pattern::Grain => even(grain(p.x, p.y, p.cells, 0.0)),
        Pattern::Weave => weave(p),
        Pattern::Pile => pile(p),
        Pattern::Pebbles => pebbles(p),
        Pattern::Chips => chips(p),
        Pattern::Veins => veins(p),
        Pattern::Clouds => clouds(p),
        Pattern::Stipple => stipple(p),
        Pattern::Brushed => even(0.7 * value(p.x, p.y, p.cells, 71) + 0.3 * value(p.x, p.y, [2, p.cells[1] * 2], 72)),
        Pattern::Plain => even(0.5),
    }
}

fn even(tone: f64) -> Texel {
    Texel { tone, height: 0.5, joint: false }
}

/// Grain of wood along x: fibers, and rings that wander.
fn grain(x: f64, y: f64, cells: [usize; 2], board: f64) -> f64 {
    let salt = (board * 997.0) as u32;
    let wander = layers(x, y, [2, cells[1] * 2], 3, 11 + salt);
    let rings = (y * cells[1] as f64 * 3.0 + wander * 3.4) * std::f64::consts::TAU;
    let fibers = value(x, y, [6, cells[1] * 14], 17 + salt);
    0.45 * (0.5 + 0.5 * rings.sin()) * (0.4 + 0.6 * wander) + 0.35 * fibers + 0.2 * wander
}

fn planks(finish: &Finish, p: &Place) -> Texel {
    let row = (p.y * p.cells[1] as f64).floor() as i64;
    // Rows are shifted against each other by shares of a board.
    let shifted = p.x + hash(row, 0, 3);
    let board = (shifted * p.cells[0] as f64).floor() as i64;
    let own = hash(row, board.rem_euclid(p.cells[0] as i64), 5);
    let edge = |t: f64, unit: f64| (t - t.floor()).min(1.0 - (t - t.floor())) * unit;
    let across = edge(p.y * p.cells[1] as f64, finish.unit_m[1]);
    let along = edge(shifted * p.cells[0] as f64, finish.unit_m[0]);
    let gap = across.min(along);
    let shade = 0.5 + (grain(p.x, p.y, p.cells, own) - 0.5) * 0.7 + (own - 0.5) * 0.6;
    Texel { tone: shade, height: (gap / p.joint_m).min(1.0), joint: gap < p.joint_m / 2.0 }
}

fn tiles(finish: &Finish, p: &Place) -> Texel {
    let (tx, ty) = (p.x * p.cells[0] as f64, p.y * p.cells[1] as f64);
    let own = hash(tx.floor() as i64, ty.floor() as i64, 21);
    let edge = |t: f64, unit: f64| (t - t.floor()).min(1.0 - (t - t.floor())) * unit;
    let gap = edge(tx, finish.unit_m[0]).min(edge(ty, finish.unit_m[1]));
    let cloud = layers(p.x, p.y, p.cells.map(|c| c * 3), 3, 22 + (own * 50.0) as u32);
    let tone = 0.5 + (own - 0.5) * 0.6 + (cloud - 0.5) * 0.8;
    Texel { tone, height: (gap / (1.5 * p.joint_m)).min(1.0), joint: gap < p.joint_m / 2.0 }
}

fn weave(p: &Place) -> Texel {
    let (tx, ty) = (p.x * p.cells[0] as f64, p.y * p.cells[1] as f64);
    let over = (tx.floor() as i64 + ty.floor() as i64).rem_euclid(2) == 0;
    let (fx, fy) = (tx - tx.floor(), ty - ty.floor());
    let round = |t: f64| (std::f64::consts::PI * t).sin();
    // The thread above runs along x or y; it is round across and sinks at its ends.
    let (across, along) = if over { (fy, fx) } else { (fx, fy) };
    let height = round(across) * (0.55 + 0.45 * round(along));
    let own = hash(tx.floor() as i64, ty.floor() as i64, 31);
    Texel { tone: 0.25 + 0.55 * height + 0.2 * (own - 0.3), height, joint: false }
}

fn pile(p: &Place) -> Texel {
    let (near, _, own) = points(p.x, p.y, p.cells, 41);
    let loops = (1.0 - near).clamp(0.0, 1.0);
    let patch = layers(p.x, p.y, [4, 4], 3, 44);
    Texel { tone: 0.2 + 0.35 * loops + 0.3 * own + 0.15 * patch, height: loops, joint: false }
}

fn pebbles(p: &Place) -> Texel {
    let (first, second, own) = points(p.x, p.y, p.cells, 51);
    let crease = ((second - first) * 2.5).clamp(0.0, 1.0);
    let patch = layers(p.x, p.y, [3, 3], 3, 54);
    Texel { tone: 0.3 + 0.45 * crease + 0.1 * own + 0.25 * (patch - 0.4), height: crease, joint: false }
}

fn chips(p: &Place) -> Texel {
    let (first, second, own) = points(p.x, p.y, p.cells, 61);
    let ground = 0.62 + 0.15 * (value(p.x, p.y, p.cells.map(|c| c * 3), 64) - 0.5);
    let chip = second - first > 0.18 && own > 0.3;
    even(if chip { (own - 0.3) / 0.7 } else { ground })
}

fn veins(p: &Place) -> Texel {
    let wander = layers(p.x, p.y, p.cells.map(|c| c * 2), 5, 81);
    let line = |salt: u32, shift: f64| {
        let bent = layers(p.x, p.y, p.cells, 5, salt) + 0.25 * (wander - 0.5) + shift;
        (1.0 - (bent - 0.5).abs() * 14.0).clamp(0.0, 1.0)
    };
    even(0.92 - 0.55 * line(85, 0.0) - 0.25 * line(91, 0.06) - 0.25 * (wander - 0.5))
}

fn clouds(p: &Place) -> Texel {
    let cloud = layers(p.x, p.y, p.cells, 5, 101);
    let pore = hash((p.x * 1024.0) as i64, (p.y * 1024.0) as i64, 107) > 0.9975;
    Texel {
        tone: if pore { 0.05 } else { 0.5 + (cloud - 0.5) * 1.7 },
        height: if pore { 0.0 } else { cloud },
        joint: false,
    }
}

fn stipple(p: &Place) -> Texel {
    let bumps = value(p.x, p.y, p.cells, 111);
    let patch = layers(p.x, p.y, [3, 3], 3, 113);
    Texel { tone: 0.45 + 0.35 * (bumps - 0.5) + 0.5 * (patch - 0.45), height: bumps, joint: false }
}
