//! Convex pieces of a simple polygon.

use d3dgen_mesh::triangulate;
use d3dgen_model::geometry::{Point, Polygon};

/// Returns convex pieces, counter-clockwise, that together are the polygon: rectangles of one with right angles, else
/// triangles joined where what comes out is convex. Nothing of an outline that crosses itself.
pub(super) fn pieces(polygon: &Polygon) -> Vec<Vec<Point>> {
    if polygon.is_rectilinear() {
        return polygon.rects().iter().map(|r| r.corners().to_vec()).collect();
    }
    let corners: Vec<[f64; 2]> = polygon.corners().iter().map(|p| [p.x, p.y]).collect();
    let mut pieces: Vec<Vec<usize>> = triangulate(&corners).unwrap_or_default().into_iter().map(Vec::from).collect();
    let mut i = 0;
    while i < pieces.len() {
        let joined = (i + 1..pieces.len()).find_map(|j| joined(&pieces[i], &pieces[j], &corners).map(|p| (j, p)));
        match joined {
            Some((j, piece)) => {
                pieces[i] = piece;
                pieces.remove(j);
            }
            None => i += 1,
        }
    }
    pieces.into_iter().map(|piece| piece.into_iter().map(|k| polygon.corners()[k]).collect()).collect()
}

/// Returns two pieces as one, when they share an edge and it is convex.
fn joined(a: &[usize], b: &[usize], corners: &[[f64; 2]]) -> Option<Vec<usize>> {
    let edge = |piece: &[usize], k: usize| (piece[k % piece.len()], piece[(k + 1) % piece.len()]);
    let shared = (0..a.len()).flat_map(|i| (0..b.len()).map(move |j| (i, j)));
    let (i, j) = shared.into_iter().find(|&(i, j)| {
        let ((from, to), (back, forth)) = (edge(a, i), edge(b, j));
        (from, to) == (forth, back)
    })?;
    // From the end of the edge around a, then around b.
    let around_a = (1..=a.len()).map(|k| a[(i + k) % a.len()]);
    let around_b = (2..b.len()).map(|k| b[(j + k) % b.len()]);
    let ring: Vec<usize> = around_a.chain(around_b).collect();
    let turn = |k: usize| {
        let [p, q, r] = [0, 1, 2].map(|d| corners[ring[(k + d) % ring.len()]]);
        (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0])
    };
    (0..ring.len()).all(|k| turn(k) >= -1e-9).then_some(ring)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(piece: &[Point]) -> f64 {
        Polygon(piece.to_vec()).signed_area()
    }

    #[test]
    fn a_slanted_l_becomes_few_convex_pieces_that_tile_it() {
        let l = [(0., 0.), (4., 1.), (3.5, 3.), (1.5, 2.5), (1.0, 4.5), (-1.0, 4.0)];
        let polygon = Polygon(l.map(|(x, y)| Point::new(x, y)).to_vec());
        let found = pieces(&polygon);
        assert!(found.len() == 2, "{found:?}");
        let sum: f64 = found.iter().map(|p| area(p)).sum();
        assert!(found.iter().all(|p| area(p) > 0.0) && (sum - polygon.area()).abs() < 1e-9);
        let bow = Polygon([(0., 0.), (2., 2.), (2., 0.), (0., 2.1)].map(|(x, y)| Point::new(x, y)).to_vec());
        assert!(pieces(&bow).is_empty(), "an outline that crosses itself has no pieces");
    }
}
