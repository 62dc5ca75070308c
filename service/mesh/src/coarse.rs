//! Fewer collision shapes: those whose common box adds least space become one.

use crate::affine::Vec3;
use crate::model3d::Collision;

/// Most space that a merge may fill that nothing filled, m3.
const FILLED_M3: f64 = 0.005;

/// Merges shapes as long as `goes_on` says so of their number and of the space, m3, that the next merge fills.
pub(crate) fn merged(mut shapes: Vec<Collision>, goes_on: impl Fn(usize, f64) -> bool) -> Vec<Collision> {
    while let Some((_, [a, b])) = next(&shapes).filter(|(filled, _)| goes_on(shapes.len(), *filled)) {
        let [min, max] = union(&shapes[a].bounds(), &shapes[b].bounds());
        shapes[a] = Collision::Box { min, max };
        shapes.remove(b);
    }
    shapes
}

/// Returns shapes that fill nearly the same space with fewer of them: the feet of a chair are one box, a picture with its frame
/// another, and what is under a table stays free.
pub fn few(shapes: Vec<Collision>) -> Vec<Collision> {
    merged(shapes, |_, filled| filled <= FILLED_M3)
}

/// Returns the two shapes whose common box adds least, the first of several, and the space that it adds, m3.
fn next(shapes: &[Collision]) -> Option<(f64, [usize; 2])> {
    let boxes: Vec<[Vec3; 2]> = shapes.iter().map(Collision::bounds).collect();
    let pairs = (0..boxes.len()).flat_map(|a| (a + 1..boxes.len()).map(move |b| [a, b]));
    let filled = |[a, b]: [usize; 2]| volume(&union(&boxes[a], &boxes[b])) - volume(&boxes[a]) - volume(&boxes[b]);
    pairs.map(|pair| (filled(pair), pair)).min_by(|a, b| a.0.total_cmp(&b.0))
}

fn union(a: &[Vec3; 2], b: &[Vec3; 2]) -> [Vec3; 2] {
    [std::array::from_fn(|i| a[0][i].min(b[0][i])), std::array::from_fn(|i| a[1][i].max(b[1][i]))]
}

fn volume(bounds: &[Vec3; 2]) -> f64 {
    (0..3).map(|i| bounds[1][i] - bounds[0][i]).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cuboid(min: Vec3, max: Vec3) -> Collision {
        Collision::Box { min, max }
    }

    #[test]
    fn a_framed_picture_is_one_box() {
        let bar = |x: [f64; 2], z: [f64; 2]| cuboid([x[0], 0.0, z[0]], [x[1], 0.03, z[1]]);
        let pane = cuboid([0.0, 0.01, 0.0], [0.6, 0.02, 0.4]);
        let frame = [bar([0.0, 0.6], [0.0, 0.02]), bar([0.0, 0.6], [0.38, 0.4]), bar([0.0, 0.02], [0.0, 0.4])];
        let found = few(frame.into_iter().chain([pane]).collect());
        assert_eq!(found, [cuboid([0.0; 3], [0.6, 0.03, 0.4])]);
    }

    #[test]
    fn what_is_under_a_table_stays_free() {
        let leg = |x: f64, y: f64| cuboid([x, y, 0.0], [x + 0.05, y + 0.05, 0.7]);
        let mut shapes = vec![cuboid([0.0, 0.0, 0.7], [1.2, 0.8, 0.73])];
        shapes.extend([leg(0.0, 0.0), leg(1.15, 0.0), leg(1.15, 0.75), leg(0.0, 0.75)]);
        shapes.push(Collision::Cylinder { center: [0.025, 0.025, 0.01], radius: 0.02, length: 0.02, axis: 2 });
        let found = few(shapes);
        assert_eq!(found.len(), 5, "the foot is in its leg: {found:?}");
        let middle = found.iter().any(|s| s.bounds()[0][2] < 0.6 && s.bounds()[0][0] < 0.6 && s.bounds()[1][0] > 0.6);
        assert!(!middle, "{found:?}");
    }

    #[test]
    fn shapes_are_merged_down_to_a_number_the_cheapest_first() {
        let shapes: Vec<Collision> = [0.0, 1.0, 1.1, 5.0].map(|x| cuboid([x, 0.0, 0.0], [x + 0.1, 1.0, 1.0])).to_vec();
        let found = merged(shapes, |count, _| count > 3);
        assert_eq!(found.len(), 3);
        assert_eq!(found[1].bounds()[0][0], 1.0);
        assert!((found[1].bounds()[1][0] - 1.2).abs() < 1e-12);
        assert!(few(Vec::new()).is_empty());
    }
}
