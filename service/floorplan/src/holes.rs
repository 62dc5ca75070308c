//! Holes between rooms that are too narrow for a court: a room beside one takes its ground where the plan stays sound. What
//! is left is a shaft, which nobody enters and no window looks into.

use super::cost::{Judge, Weights};
use super::lattice::{Cellbox, up};
use super::outline::Mosaic;
use super::spec::Brief;
use crate::candidate::Candidate;
use crate::lattice::{is_narrow, tidied};

/// Gives the holes of a sound plan that are no courts to the rooms beside them.
pub(crate) fn close(brief: &Brief, weights: &Weights, found: &mut Candidate) {
    if !found.score.is_sound() {
        return;
    }
    let least = up(brief.court_width);
    let holes: Vec<Vec<Cellbox>> =
        Mosaic::new(&found.layout.boxes).courts().into_iter().filter(|hole| is_narrow(hole, least)).collect();
    if holes.is_empty() {
        return;
    }
    let mut judge = Judge::new(brief);
    for hole in holes {
        let ways = (0..brief.rooms.len()).filter_map(|room| taken(&found.layout.boxes, room, &hole)).map(|boxes| {
            let mut way = found.clone();
            way.layout.boxes = boxes;
            way.score = judge.score(&way.layout);
            way
        });
        let cost = |way: &Candidate| way.score.total(weights);
        let best = ways.filter(|way| way.score.is_sound()).min_by(|a, b| cost(a).total_cmp(&cost(b)));
        if let Some(best) = best {
            let symmetry = found.score.symmetry;
            *found = best;
            found.score.symmetry = symmetry;
        }
    }
}

/// Returns the rectangles of a plan in which a room has a hole that it borders on.
fn taken(boxes: &[(usize, Cellbox)], room: usize, hole: &[Cellbox]) -> Option<Vec<(usize, Cellbox)>> {
    let own: Vec<Cellbox> = boxes.iter().filter(|(r, _)| *r == room).map(|(_, b)| *b).collect();
    let touches = own.iter().any(|b| hole.iter().any(|h| h.contact(b).is_some()));
    let others = boxes.iter().filter(|(r, _)| *r != room).copied();
    let with_hole = tidied(&[&own[..], hole].concat());
    touches.then(|| others.chain(with_hole.into_iter().map(|b| (room, b))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_room_beside_a_hole_takes_it_and_one_apart_does_not() {
        let ring = [
            (0, Cellbox::new(0, 0, 90, 30)),
            (1, Cellbox::new(0, 30, 30, 60)),
            (2, Cellbox::new(0, 60, 90, 90)),
            (3, Cellbox::new(60, 30, 90, 60)),
            (4, Cellbox::new(90, 0, 120, 90)),
        ];
        let holes = Mosaic::new(&ring).courts();
        assert_eq!(holes, [vec![Cellbox::new(30, 30, 60, 60)]]);
        assert!(is_narrow(&holes[0], 31) && !is_narrow(&holes[0], 30));
        assert!(taken(&ring, 4, &holes[0]).is_none());
        let closed = taken(&ring, 1, &holes[0]).expect("it borders on the hole");
        assert!(closed.contains(&(1, Cellbox::new(0, 30, 60, 60))));
        assert!(Mosaic::new(&closed).courts().is_empty());
    }
}
