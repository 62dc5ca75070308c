//! What makes a plan unbuildable, and what makes one better than another.
//!
//! Hard shortfalls are measured in meters or relative units, so that the search feels which way is out; a plan is
//! accepted only when they are zero. Soft terms are weighted sums, reported in the floorplan's `cost`.

use d3dgen_model::domain::{Daylight, Zone};
use d3dgen_model::scene_graph::Connector;
use d3dgen_model::seed::Stream;

use super::PROPORTION_LIMIT;
use super::lattice::{Cellbox, INNER_HALF_M, OUTER_HALF_M, meters, up};
use super::realize::{Layout, door_need};
use super::spec::Brief;

/// Names of the soft terms, in the order of [`Score::soft`].
pub(super) const TERMS: [&str; 9] = [
    "area_error",
    "proportion",
    "wished_adjacency",
    "daylight",
    "circulation_share",
    "wet_walls",
    "outline",
    "zoning",
    "narrow_parts",
];
/// Standard weights of the soft terms; each plan's search varies them by its taste.
pub(super) const WEIGHTS: [f64; 9] = [1.0, 0.6, 1.2, 0.5, 10.0, 0.35, 0.8, 0.5, 0.4];
/// Least outer wall of a room that needs a window, m.
pub(super) const WINDOW_WALL_M: f64 = 1.2;

/// Share by which the whole may miss the area asked for before it costs.
const AREA_TOLERANCE: f64 = 0.03;

/// Verdict on a layout.
#[derive(Debug, Clone, Default)]
pub(super) struct Score {
    /// Shortfalls against hard rules; 0 for a sound plan.
    pub hard: f64,
    /// Unweighted soft terms, in the order of [`TERMS`].
    pub soft: [f64; 9],
}

impl Score {
    /// Returns the figure the search minimizes, under the taste of one plan.
    pub(super) fn total(&self, weights: &[f64; 9]) -> f64 {
        self.hard * 30.0 + self.soft.iter().zip(weights).map(|(s, w)| s * w).sum::<f64>()
    }

    /// Returns the soft terms under the standard weights, so that plans can be compared.
    pub(super) fn weighted(&self) -> [f64; 9] {
        std::array::from_fn(|i| self.soft[i] * WEIGHTS[i])
    }
}

/// Returns the weights one plan is searched with: another architect for every seed.
pub(super) fn taste(rng: &mut Stream) -> [f64; 9] {
    WEIGHTS.map(|w| w * (0.5 + rng.unit()))
}

/// A shared stretch of wall between two rooms.
#[derive(Debug, Clone, Copy)]
struct Contact {
    a: usize,
    b: usize,
    len: i32,
}

/// Lengths of walls per room and pair, computed once a layout.
pub(super) struct Survey {
    contacts: Vec<Contact>,
    /// Outer wall per room: the longest straight piece, and the sum.
    outer: Vec<(i32, i32)>,
    gross_m2: Vec<f64>,
    net_m2: Vec<f64>,
    /// Largest box of each room.
    main: Vec<Option<Cellbox>>,
    /// Clear width and height of that box, m.
    clear: Vec<(f64, f64)>,
}

impl Survey {
    pub(super) fn new(brief: &Brief, layout: &Layout) -> Self {
        let rooms = brief.rooms.len();
        let boxes = &layout.boxes;
        let mut side = vec![[0_i32; 4]; boxes.len()];
        let mut own = vec![[0_i32; 4]; boxes.len()];
        let mut survey = Self {
            contacts: Vec::with_capacity(4 * rooms),
            outer: vec![(0, 0); rooms],
            gross_m2: vec![0.0; rooms],
            net_m2: vec![0.0; rooms],
            main: vec![None; rooms],
            clear: vec![(0.0, 0.0); rooms],
        };
        // A sweep from west to east: only boxes that begin before this one ends can touch it.
        let mut by_west: Vec<usize> = (0..boxes.len()).collect();
        by_west.sort_unstable_by_key(|&i| (boxes[i].1.x0, i));
        for (k, &i) in by_west.iter().enumerate() {
            let (a, first) = &boxes[i];
            for &j in &by_west[k + 1..] {
                let (b, second) = &boxes[j];
                if second.x0 > first.x1 {
                    break;
                }
                let Some((s, from, to)) = first.contact(second) else { continue };
                side[i][s] += to - from;
                side[j][s ^ 1] += to - from;
                if a == b {
                    own[i][s] += to - from;
                    own[j][s ^ 1] += to - from;
                } else {
                    survey.contacts.push(Contact { a: *a, b: *b, len: to - from });
                }
            }
        }
        for (i, (room, shape)) in boxes.iter().enumerate() {
            survey.gross_m2[*room] += shape.area_m2();
            let mut net = shape.area_m2();
            let mut walls = [0.0; 2];
            for s in 0..4 {
                let len = if s < 2 { shape.height() } else { shape.width() };
                let free = len - side[i][s];
                let outer = &mut survey.outer[*room];
                outer.0 = outer.0.max(free);
                outer.1 += free;
                net -= meters(free) * OUTER_HALF_M + meters(len - own[i][s] - free) * INNER_HALF_M;
                // the clear extent ends at the thickest wall of a side
                let half = if free > 0 { OUTER_HALF_M } else { INNER_HALF_M };
                walls[s / 2] += if own[i][s] == len { 0.0 } else { half };
            }
            survey.net_m2[*room] += net;
            let larger = survey.main[*room].is_none_or(|m| m.area_m2() < shape.area_m2());
            if larger {
                survey.main[*room] = Some(*shape);
                survey.clear[*room] = (meters(shape.width()) - walls[0], meters(shape.height()) - walls[1]);
            }
        }
        for net in &mut survey.net_m2 {
            *net += 4.0 * INNER_HALF_M * INNER_HALF_M;
        }
        survey
    }

    /// Returns the longest shared wall of two rooms, lattice units.
    fn contact(&self, a: usize, b: usize) -> i32 {
        self.contacts.iter().filter(|c| (c.a, c.b) == (a, b) || (c.b, c.a) == (a, b)).map(|c| c.len).max().unwrap_or(0)
    }
}

/// Judges a layout.
pub(super) fn score(brief: &Brief, layout: &Layout) -> Score {
    let survey = Survey::new(brief, layout);
    let mut score = Score { hard: layout.misfit, ..Score::default() };
    rooms(brief, &survey, &mut score);
    links(brief, &survey, &mut score);
    whole(brief, layout, &survey, &mut score);
    score
}

fn rooms(brief: &Brief, survey: &Survey, score: &mut Score) {
    let spine = brief.spine.unwrap_or(usize::MAX);
    for (i, spec) in brief.rooms.iter().enumerate() {
        if survey.main[i].is_none() {
            score.hard += 5.0;
            continue;
        }
        let corridor = i == spine && !brief.hub;
        if !corridor {
            let net = survey.net_m2[i];
            score.hard += ((spec.area_min - net) / spec.area_min).max(0.0) * 4.0;
            score.hard += ((net - spec.area_max) / spec.area_max).max(0.0) * 4.0;
            // Readers who measure on center lines should find the area in range too.
            let over = ((survey.gross_m2[i] - spec.area_max) / spec.area_max).max(0.0);
            // half the area is as wrong as double the area
            let off = (net - spec.area_target) / net.min(spec.area_target).max(0.1);
            let [least, most] = spec.limits.area_advised.unwrap_or([0.0, f64::MAX]);
            let ill_advised = ((least - net).max(net - most) / spec.area_target).max(0.0);
            score.soft[0] += off.powi(2) + 3.0 * over + 3.0 * ill_advised;
            let (w, h) = survey.clear[i];
            score.hard += (spec.min_dimension - w.min(h)).max(0.0);
            let proportion = w.max(h) / w.min(h).max(0.1);
            score.hard += (proportion - PROPORTION_LIMIT).max(0.0);
            score.soft[1] += (proportion - 1.5).max(0.0).powi(2);
        }
        if spec.on_spine && i != spine {
            let short = door_need(spec.door_width) - survey.contact(i, spine);
            score.hard += meters(short.max(0));
        }
        let (longest, total) = survey.outer[i];
        match spec.daylight {
            _ if spec.needs_outer_wall() => score.hard += meters((up(WINDOW_WALL_M) - longest).max(0)),
            Daylight::Preferred if longest < up(WINDOW_WALL_M) && !corridor => score.soft[3] += 1.0,
            Daylight::None if !spec.circulation => score.soft[3] += 0.03 * meters(total).min(6.0),
            _ => {}
        }
        if spec.entrance {
            score.hard += meters((door_need(brief.entrance_width) - longest).max(0));
        }
    }
}

fn links(brief: &Brief, survey: &Survey, score: &mut Score) {
    for link in &brief.links {
        let len = survey.contact(link.a, link.b);
        let need = match link.connector {
            Connector::Door | Connector::Open => door_need(brief.door_width(link.a, link.b)),
            Connector::Wall | Connector::Near => up(0.6),
        };
        let short = meters((need - len).max(0));
        if link.required && link.connector != Connector::Near {
            score.hard += short;
        } else if short > 0.0 {
            let far = match (survey.main[link.a], survey.main[link.b]) {
                (Some(a), Some(b)) => distance(a, b),
                _ => 10.0,
            };
            score.soft[2] += 0.3 + 0.04 * far;
        }
    }
    for [a, b] in &brief.apart {
        score.hard += meters(survey.contact(*a, *b)) * 0.5;
    }
    let wet = |i: usize| brief.rooms[i].wet;
    let total = brief.rooms.iter().filter(|r| r.wet).count();
    let paired = (0..brief.rooms.len())
        .filter(|&i| wet(i) && survey.contacts.iter().any(|c| wet(c.a) && wet(c.b) && (c.a == i || c.b == i)))
        .count();
    if total > 1 {
        score.soft[5] += (total - paired) as f64;
    }
}

fn whole(brief: &Brief, layout: &Layout, survey: &Survey, score: &mut Score) {
    let total: f64 = survey.gross_m2.iter().sum();
    if let Some(spine) = brief.spine
        && !brief.hub
    {
        // From a fifth on, circulation is what a reviewer objects to first.
        let share = survey.gross_m2[spine] / total;
        score.soft[4] += (share - 0.10).max(0.0) + 5.0 * (share - 0.20).max(0.0);
    }
    if let Some(area) = brief.area {
        let net: f64 = survey.net_m2.iter().sum();
        score.soft[0] += 20.0 * ((net - area).abs() / area - AREA_TOLERANCE).max(0.0);
    }
    let perimeter: f64 = survey.outer.iter().map(|o| meters(o.1)).sum();
    score.soft[6] += perimeter / (4.0 * total.sqrt()) - 1.0 + 0.02 * layout.notch;
    let entrance = brief.rooms.iter().position(|r| r.entrance).and_then(|i| survey.main[i]);
    let size = total.sqrt().max(1.0);
    for (i, spec) in brief.rooms.iter().enumerate() {
        let (Some(main), Some(door)) = (survey.main[i], entrance) else { continue };
        let far = distance(main, door) / size;
        score.soft[7] += match spec.zone {
            Zone::Public | Zone::Day => 0.25 * far,
            Zone::Night => 0.4 * (1.2 - far).max(0.0),
            Zone::Staff | Zone::Service | Zone::Circulation | Zone::Outdoor => 0.0,
        };
    }
    for (room, shape) in &layout.boxes {
        if Some(*room) != brief.spine && survey.main[*room] != Some(*shape) {
            // A leg beside a small room: fine as a lobby, a waste as a corridor.
            let (w, h) = (meters(shape.width()), meters(shape.height()));
            score.soft[8] += (w.max(h) / w.min(h).max(0.1) - 1.6).max(0.0) + 0.15;
        }
    }
}

fn distance(a: Cellbox, b: Cellbox) -> f64 {
    let ((ax, ay), (bx, by)) = (a.center2(), b.center2());
    (f64::from((ax - bx).abs()) + f64::from((ay - by).abs())) * 0.025
}
