//! What large halls are known by; the side one comes from is at the front (+v).

use crate::exporters::plan::pen::Pen;

/// Width of a swimmer's lane, of the coping around the water, and the distance of sleepers, m.
const LANE_M: f64 = 2.2;
const COPING_M: f64 = 0.4;
const SLEEPERS_M: f64 = 0.7;
/// Half of the gauge, and half the length of a sleeper, m.
const HALF_GAUGE_M: f64 = 0.75;
const HALF_SLEEPER_M: f64 = 1.2;

/// Water inside a coping, with the lines of its lanes.
pub(super) fn pool(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.outline("b", 0.0);
    let rim = COPING_M.min(0.1 * p.w);
    let (a, b) = (u - rim, v - rim);
    p.rect("wa", (-a, -b), (a, b), 0.0);
    let lanes = (2.0 * a / LANE_M).floor().max(1.0);
    let at = |i: usize| -a + 2.0 * a * i as f64 / lanes;
    let lines: Vec<[(f64, f64); 2]> = (1..lanes as usize).map(|i| [(at(i), -b), (at(i), b)]).collect();
    let lines: Vec<&[(f64, f64)]> = lines.iter().map(|l| l.as_slice()).collect();
    p.lines("f", &lines);
}

/// Sleepers and two rails, and the edge of the platform.
pub(super) fn track(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.rect("s", (-u, -v), (u, v), 0.0);
    let middle = -0.12 * p.d;
    let count = (p.w / SLEEPERS_M).floor().max(1.0);
    let at = |i: usize| -u + p.w * (i as f64 + 0.5) / count;
    let (low, high) = (middle - HALF_SLEEPER_M, middle + HALF_SLEEPER_M);
    let lines: Vec<[(f64, f64); 2]> = (0..count as usize).map(|i| [(at(i), low), (at(i), high)]).collect();
    let lines: Vec<&[(f64, f64)]> = lines.iter().map(|l| l.as_slice()).collect();
    p.lines("f", &lines);
    for rail in [middle - HALF_GAUGE_M, middle + HALF_GAUGE_M] {
        p.rect("d", (-u, rail - 0.05), (u, rail + 0.05), 0.0);
    }
    p.rect("d", (-u, 0.88 * v - 0.05), (u, 0.88 * v + 0.05), 0.0);
}

/// Rails on three sides, and the animal's place between them.
pub(super) fn stall(p: &mut Pen<'_>) {
    let (u, v) = p.half();
    p.rect("s", (-u, -v), (u, v), 0.0);
    let rail = 0.05;
    p.rect("d", (-u, -v), (-u + rail, v), 0.0);
    p.rect("d", (u - rail, -v), (u, v), 0.0);
    p.rect("d", (-u, -v), (u, -v + rail), 0.0);
    p.ellipse("b", (0.0, -0.05 * p.d), 0.28 * p.w.min(p.d), 0.3 * p.d);
    p.circle("b", (0.0, -0.38 * p.d), 0.14 * p.w.min(p.d));
}
