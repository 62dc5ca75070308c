//! Things that hold things: the side one opens is at the front (+v).

use crate::exporters::plan::pen::Pen;

/// A plain body.
pub(super) fn plain(p: &mut Pen<'_>) {
    p.outline("b", 0.015);
}

/// A line for the doors; tall ones show the rail with its hangers.
pub(super) fn cabinet(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.0);
    if p.h > 1.5 && p.d > 0.5 {
        let count = (p.w / 0.14).floor().clamp(2.0, 16.0);
        let mut lines: Vec<[(f64, f64); 2]> = vec![[(-u + 0.05, 0.0), (u - 0.05, 0.0)]];
        for i in 1..count as usize {
            let x = -u + p.w * i as f64 / count;
            // Hangers hang a little askew, as drawn by hand.
            let lean = [0.02, -0.01, 0.03][i % 3];
            lines.push([(x - lean, -0.55 * v), (x + lean, 0.55 * v)]);
        }
        let lines: Vec<&[(f64, f64)]> = lines.iter().map(|l| l.as_slice()).collect();
        p.lines("f", &lines);
    } else {
        let doors = (p.w / 0.6).round().max(1.0);
        let front = v - 0.04_f64.min(0.12 * p.d);
        let mut lines: Vec<[(f64, f64); 2]> = vec![[(-u, front), (u, front)]];
        for i in 1..doors as usize {
            let x = -u + p.w * i as f64 / doors;
            lines.push([(x, front), (x, v)]);
        }
        let lines: Vec<&[(f64, f64)]> = lines.iter().map(|l| l.as_slice()).collect();
        p.lines("f", &lines);
    }
}

/// Boards seen from above: a back line and dividers.
pub(super) fn shelf(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.0);
    let bays = (p.w / 0.45).round().max(1.0);
    let back = -v + 0.15 * p.d;
    let mut lines: Vec<[(f64, f64); 2]> = vec![[(-u, back), (u, back)]];
    for i in 1..bays as usize {
        let x = -u + p.w * i as f64 / bays;
        lines.push([(x, back), (x, v)]);
    }
    let lines: Vec<&[(f64, f64)]> = lines.iter().map(|l| l.as_slice()).collect();
    p.lines("f", &lines);
}

/// Bays with a cross and dark uprights.
pub(super) fn rack(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.0);
    let bays = (p.w / 2.7).round().max(1.0);
    let post = 0.09_f64.min(0.1 * p.d);
    for i in 0..bays as usize {
        let (a, b) = (-u + p.w * i as f64 / bays, -u + p.w * (i + 1) as f64 / bays);
        p.lines("f", &[&[(a, -v), (b, v)], &[(a, v), (b, -v)]]);
    }
    for i in 0..=bays as usize {
        let x = -u + (p.w - post) * i as f64 / bays;
        p.rect("d", (x, -v), (x + post, -v + post), 0.0);
        p.rect("d", (x, v - post), (x + post, v), 0.0);
    }
}

/// A tray on four wheels, the handle at the rear.
pub(super) fn trolley(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.rect("b", (-u, -v + 0.1 * p.d), (u, v), 0.04);
    p.rect("f", (-0.78 * u, -v + 0.2 * p.d), (0.78 * u, 0.82 * v), 0.03);
    p.rect("s", (-0.9 * u, -v), (0.9 * u, -v + 0.06 * p.d), 0.02);
    p.lines(
        "f",
        &[
            &[(-0.7 * u, -v + 0.06 * p.d), (-0.7 * u, -v + 0.1 * p.d)],
            &[(0.7 * u, -v + 0.06 * p.d), (0.7 * u, -v + 0.1 * p.d)],
        ],
    );
}

/// Two flights with their treads, the landing at the rear, and an arrow along the way up.
pub(super) fn stairs(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.0);
    let landing = (u - 0.05).min(0.4 * p.d);
    let rear = -v + landing;
    let run = p.d - landing;
    let treads = (run / 0.28).round().max(1.0) as usize;
    let mut lines: Vec<Vec<(f64, f64)>> = Vec::new();
    for k in 1..=treads {
        let y = rear + run * (k as f64 - 1.0) / treads as f64;
        lines.push(vec![(-u, y), (-0.05, y)]);
        lines.push(vec![(0.05, y), (u, y)]);
    }
    lines.push(vec![(-0.05, v), (-0.05, rear), (0.05, rear), (0.05, v)]);
    let (way, head) = (u / 2.0 + 0.025, 0.12);
    lines.push(vec![(way, v), (way, -v + landing / 2.0), (-way, -v + landing / 2.0), (-way, v - 0.05)]);
    lines.push(vec![(-way - head, v - 0.05 - 1.6 * head), (-way, v - 0.05), (-way + head, v - 0.05 - 1.6 * head)]);
    let lines: Vec<&[(f64, f64)]> = lines.iter().map(Vec::as_slice).collect();
    p.lines("f", &lines);
}
