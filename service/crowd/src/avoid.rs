//! The next velocity of somebody among others: of a fan of headings and speeds the one that is nearest to what it wants and
//! meets nobody soon (sampled velocity obstacles, van den Berg et al. 2008). What would touch a wall or somebody is never taken.

use std::sync::LazyLock;

use d3dgen_model::Point;

/// Headings aside of the wanted one, degrees, the nearest first; to the right before to the left.
const ASIDE_DEG: [f64; 13] = [0.0, -15.0, 15.0, -32.0, 32.0, -52.0, 52.0, -75.0, 75.0, -105.0, 105.0, -140.0, 140.0];
/// Speeds, as shares of the wanted one.
const SPEEDS: [f64; 3] = [1.0, 0.6, 0.3];
/// Time ahead that meetings count in, s.
const AHEAD_S: f64 = 3.0;
/// What a meeting in a second costs against a change of velocity as large as the wanted one.
const MEETING: f64 = 0.9;
/// What the left costs against the right.
const LEFT: f64 = 0.02;
/// How near two may come who push past each other, below the sum of their radii, m.
const TOUCH_M: f64 = 0.05;
/// Room that somebody likes to leave to others, m, and what it costs to leave none.
const ROOM_M: f64 = 0.25;
const ROOM: f64 = 0.5;

static TURNS: LazyLock<[(f64, f64); 13]> = LazyLock::new(|| ASIDE_DEG.map(|deg| deg.to_radians().sin_cos()));

/// Somebody near, seen from who chooses.
#[derive(Debug, Clone, Copy)]
pub struct Other {
    pub offset: Point,
    pub velocity: Point,
    /// Sum of both radii, m.
    pub reach: f64,
}

/// Returns the velocity for the next `dt` seconds.
pub fn choose(wanted: Point, others: &[Other], dt: f64, is_free: &mut dyn FnMut(Point) -> bool) -> Point {
    let speed = (wanted.x * wanted.x + wanted.y * wanted.y).sqrt();
    let still = Point::new(0.0, 0.0);
    if speed < 1e-9 {
        return still;
    }
    let mut tried: Vec<(f64, Point)> = Vec::with_capacity(TURNS.len() * SPEEDS.len() + 1);
    for (k, (sin, cos)) in TURNS.iter().enumerate() {
        for share in SPEEDS {
            let v = Point::new((wanted.x * cos - wanted.y * sin) * share, (wanted.x * sin + wanted.y * cos) * share);
            let change = v.distance(wanted) / speed;
            let left = if ASIDE_DEG[k] > 0.0 { LEFT } else { 0.0 };
            tried.push((change + left + worst(v, others), v));
        }
    }
    tried.push((1.05 + worst(still, others), still));
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let touches = |v: Point| {
        others.iter().any(|o| {
            let (x, y) = (o.offset.x - v.x * dt, o.offset.y - v.y * dt);
            let (now, next) = (o.offset.x.hypot(o.offset.y), x.hypot(y));
            next < o.reach - TOUCH_M && next < now
        })
    };
    tried.into_iter().map(|(_, v)| v).find(|v| !touches(*v) && (*v == still || is_free(*v))).unwrap_or(still)
}

/// Returns what the nearest meeting at a velocity costs.
fn worst(v: Point, others: &[Other]) -> f64 {
    others.iter().map(|o| meeting(v, o)).fold(0.0, f64::max)
}

fn meeting(v: Point, o: &Other) -> f64 {
    let (vx, vy) = (v.x - o.velocity.x, v.y - o.velocity.y);
    let apart = o.offset.x.hypot(o.offset.y);
    let near = o.offset.x * vx + o.offset.y * vy;
    let crowded = if near > 0.0 { ROOM * ((o.reach + ROOM_M - apart) / ROOM_M).clamp(0.0, 1.0) } else { 0.0 };
    let (a, c) = (vx * vx + vy * vy, apart * apart - (o.reach - TOUCH_M).powi(2));
    let disc = near * near - a * c;
    if near <= 0.0 || disc < 0.0 || a < 1e-9 {
        return crowded;
    }
    let when = ((near - disc.sqrt()) / a).max(0.1);
    crowded + if when < AHEAD_S { MEETING * (1.0 / when - 1.0 / AHEAD_S) } else { 0.0 }
}
