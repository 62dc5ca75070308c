//! Doors of rooms that stand across from each other in a symmetric plan: they mirror each other too, where that disturbs no
//! other door.

use d3dgen_model::Segment;
use d3dgen_model::style::Symmetry;

use super::super::lattice::STEP_M;
use super::super::mirror::{Axis, Likeness, likeness, whole};
use super::spot::Spot;
use super::{Laid, Site};

/// What it may cost that two doors mirror each other; less than that one stands in the way of another.
const WORTH: f64 = 2.5;
/// How far a door may be from the mirror image of another, m.
const EXACT_M: f64 = 1e-4;

impl Site<'_> {
    /// Moves doors to where they mirror each other, those of rooms on the axis onto it.
    pub(super) fn mirror_doors(&self, laid: &mut Laid) {
        let brief = self.brief;
        if brief.symmetry != Some(Symmetry::Symmetric) || !self.standing.is_empty() {
            return;
        }
        let Some(Likeness { axis, images, .. }) = likeness(brief, self.boxes) else { return };
        let rooms = |spot: &Spot| -> Vec<usize> {
            let ids = spot.door.room_ids.iter();
            ids.filter_map(|id| Some(whole(brief, brief.rooms.iter().position(|r| r.id == *id)?))).collect()
        };
        for n in 0..laid.spots.len() {
            let own = &laid.spots[n];
            let Some(across) = rooms(own).into_iter().map(|room| images[room]).collect::<Option<Vec<usize>>>() else {
                continue;
            };
            let image = image_of(own.door.line, axis);
            let is_across = |spot: &Spot| {
                let there = rooms(spot);
                spot.door.kind == own.door.kind
                    && there.len() == across.len()
                    && across.iter().all(|room| there.contains(room))
            };
            let like = laid.spots.iter().enumerate().filter(|(_, spot)| is_across(spot));
            let apart = |spot: &Spot| spot.door.line.middle().distance(image.middle());
            let nearest = like.min_by(|a, b| apart(a.1).total_cmp(&apart(b.1))).map(|(m, _)| m);
            if let Some(m) = nearest.filter(|m| *m >= n) {
                laid.mirror_pair(n, m, axis);
            }
        }
    }
}

impl Laid {
    /// Moves two doors to the best two of their places that mirror each other; one door that is its own image onto the axis.
    fn mirror_pair(&mut self, n: usize, m: usize, axis: Axis) {
        let others = |spot: &Spot| -> f64 {
            let others = self.spots.iter().enumerate().filter(|(k, _)| *k != n && *k != m);
            spot.penalty + others.map(|(_, other)| spot.disturbs(other)).sum::<f64>()
        };
        let both = |a: &Spot, b: &Spot| if n == m { others(a) } else { others(a) + others(b) + a.disturbs(b) };
        let before = both(&self.spots[n], &self.spots[m]);
        let mut best: Option<(f64, Spot, Spot)> = None;
        for own in &self.choices[n] {
            let image = image_of(own.door.line, axis);
            let across = self.choices[m]
                .iter()
                .filter(|other| same(other.door.line, image) && (n != m || same(other.door.line, own.door.line)));
            for other in across {
                let cost = both(own, other);
                if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                    best = Some((cost, own.clone(), other.clone()));
                }
            }
        }
        if let Some((_, own, other)) = best.filter(|(cost, ..)| *cost <= before + WORTH) {
            self.spots[m] = other;
            self.spots[n] = own;
        }
    }
}

/// Returns the mirror image of an opening.
fn image_of(line: Segment, axis: Axis) -> Segment {
    let image = |mut p: d3dgen_model::Point| {
        match axis {
            Axis::Upright(x2) => p.x = f64::from(x2) * STEP_M - p.x,
            Axis::Level(y2) => p.y = f64::from(y2) * STEP_M - p.y,
        }
        p
    };
    Segment { start: image(line.start), end: image(line.end) }
}

/// Returns true for openings in one place, whichever end comes first.
fn same(a: Segment, b: Segment) -> bool {
    let ((at, from, to), (other, low, high)) = (a.span(), b.span());
    a.is_vertical() == b.is_vertical()
        && [(at, other), (from, low), (to, high)].iter().all(|(x, y)| (x - y).abs() < EXACT_M)
}
