//! Outlines at any angle: area, containment, union and hull by the `geo` crate; and the lattice of millimeters.

use d3dgen_model::{Point, Polygon};
use geo::{Area, BooleanOps, ConvexHull, Distance, Euclidean, LineString, MultiPoint, MultiPolygon, Validation};

/// A corner on the lattice of millimeters.
pub(crate) type Corner = (i64, i64);

/// Returns an outline on the lattice in meters.
pub(crate) fn polygon(ring: &[Corner]) -> Polygon {
    Polygon(ring.iter().map(|&c| point(c)).collect())
}

/// Returns a corner of the lattice in meters.
pub(crate) fn point(c: Corner) -> Point {
    Point::new(c.0 as f64 / 1000.0, c.1 as f64 / 1000.0)
}

/// Returns the sides of an outline, the closing one last.
pub(crate) fn edges(corners: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]))
}

/// Returns the area of an outline in either sense, m^2.
pub(crate) fn area(corners: &[Point]) -> f64 {
    of(corners).unsigned_area()
}

/// Returns true for an outline of three corners or more that does not cross or touch itself.
pub(crate) fn is_simple(corners: &[Point]) -> bool {
    corners.len() > 2 && of(corners).is_valid()
}

/// Returns the share of the area of `inner` that lies in `outer`, 0 to 1; 0 for an inner outline without area.
pub(crate) fn share_inside(inner: &[Point], outer: &[Point]) -> f64 {
    let whole = area(inner);
    if whole > 0.0 { of(inner).intersection(&of(outer)).unsigned_area() / whole } else { 0.0 }
}

/// Returns the area that outlines take together, m^2, however they overlap.
pub(crate) fn area_together<'a>(outlines: impl Iterator<Item = &'a [Point]>) -> f64 {
    let all: Vec<geo::Polygon> = outlines.map(of).collect();
    geo::unary_union(&all).unsigned_area()
}

/// Returns what two outlines have in common, piece by piece, each counter-clockwise and in whole millimeters.
pub(crate) fn common(a: &[Point], b: &[Point]) -> Vec<Polygon> {
    rings(of(a).intersection(&of(b)))
}

/// Returns the outline of a line with a thickness, m.
pub(crate) fn thickened([a, b]: [Point; 2], thickness_m: f64) -> Vec<Point> {
    let length = a.distance(b).max(1e-9);
    let (x, y) = (-(b.y - a.y) / length * thickness_m / 2.0, (b.x - a.x) / length * thickness_m / 2.0);
    let at = |p: Point, side: f64| Point::new(p.x + side * x, p.y + side * y);
    vec![at(a, -1.0), at(b, -1.0), at(b, 1.0), at(a, 1.0)]
}

/// Returns the smallest outline without a dent around points.
pub(crate) fn hull(points: &[Point]) -> Vec<Point> {
    let all: MultiPoint = points.iter().map(|p| geo::Point::new(p.x, p.y)).collect();
    open(all.convex_hull().exterior())
}

/// Returns the distance of a point to a line of points, m.
pub(crate) fn distance(line: &[Point], p: Point) -> f64 {
    Euclidean.distance(&geo::Point::new(p.x, p.y), &line_of(line))
}

/// Returns the length of an outline along its longest direction and the one across it, m: of the box around it that fits best.
pub(crate) fn extents(corners: &[Point]) -> (f64, f64) {
    let around = hull(corners);
    let boxes = edges(&around).filter(|(a, b)| a.distance(*b) > 1e-6).map(|(a, b)| {
        let (ux, uy) = ((b.x - a.x) / a.distance(b), (b.y - a.y) / a.distance(b));
        let width = |x: f64, y: f64| {
            let along = around.iter().map(|p| p.x * x + p.y * y);
            along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
        };
        let (one, other) = (width(ux, uy), width(-uy, ux));
        (one.max(other), one.min(other))
    });
    boxes.min_by(|a, b| (a.0 * a.1).total_cmp(&(b.0 * b.1))).unwrap_or((0.0, 0.0))
}

fn line_of(points: &[Point]) -> LineString {
    points.iter().map(|p| (p.x, p.y)).collect::<Vec<_>>().into()
}

fn of(corners: &[Point]) -> geo::Polygon {
    geo::Polygon::new(line_of(corners), Vec::new())
}

/// Returns the corners of a closed line, the first one not repeated.
fn open(line: &LineString) -> Vec<Point> {
    let mut points: Vec<Point> = line.coords().map(|c| Point::new(c.x, c.y)).collect();
    points.pop();
    points
}

fn rings(found: MultiPolygon) -> Vec<Polygon> {
    let mm = |p: Point| Point::new(d3dgen_model::geometry::to_mm(p.x), d3dgen_model::geometry::to_mm(p.y));
    let ring = |p: &geo::Polygon| {
        let mut corners: Vec<Point> = open(p.exterior()).into_iter().map(mm).collect();
        corners.dedup();
        let mut polygon = Polygon(corners);
        if polygon.signed_area() < 0.0 {
            polygon.0.reverse();
        }
        polygon
    };
    found.iter().map(ring).filter(|p| p.0.len() > 2).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(list: &[(f64, f64)]) -> Vec<Point> {
        list.iter().map(|p| Point::new(p.0, p.1)).collect()
    }

    #[test]
    fn outlines_at_an_angle_have_area_containment_and_extents() {
        let square = points(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]);
        let lozenge = points(&[(2.0, 1.0), (3.0, 2.0), (2.0, 3.0), (1.0, 2.0)]);
        assert!((area(&lozenge) - 2.0).abs() < 1e-9 && (share_inside(&lozenge, &square) - 1.0).abs() < 1e-6);
        assert!((share_inside(&square, &lozenge) - 0.125).abs() < 1e-6);
        assert!((area_together([&square[..], &lozenge[..]].into_iter()) - 16.0).abs() < 1e-6);
        let bow = points(&[(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 4.0)]);
        assert!(is_simple(&lozenge) && !is_simple(&bow) && !is_simple(&bow[..2]));
        let (long, short) = extents(&thickened([Point::new(0.0, 0.0), Point::new(3.0, 3.0)], 0.1));
        assert!((long - 4.243).abs() < 0.001 && (short - 0.1).abs() < 1e-6, "{long} by {short}");
        assert_eq!(common(&lozenge, &square).len(), 1);
        assert_eq!(hull(&[square.clone(), lozenge].concat()).len(), 4);
        assert!((distance(&square, Point::new(2.0, -1.0)) - 1.0).abs() < 1e-9);
    }
}
