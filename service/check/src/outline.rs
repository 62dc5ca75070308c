//! Outlines of objects on the floor, turned by any angle.

use d3dgen_model::placements::Placement;
use d3dgen_model::{Rect, Segment};
use geo::{Area, BooleanOps};
use parry2d::math::{Pose, Vector};
use parry2d::query;
use parry2d::shape::{Cuboid, Segment as Line};

/// Sine of twice the angle below which an object stands along the walls.
const ALONG_WALLS: f64 = 1e-6;

/// The rectangle that an object covers seen from above.
#[derive(Debug, Clone)]
pub struct Outline {
    /// Rectangle along x and y around it; the outline itself where the object stands along the walls.
    pub bounds: Rect,
    /// Where it lies, and what it is in its own frame; none where the object stands along the walls.
    turned: Option<(Pose, Cuboid)>,
}

impl Outline {
    /// Returns the outline of an object.
    pub fn of(p: &Placement) -> Self {
        let turned = ((2.0 * p.pose.yaw_rad).sin().abs() > ALONG_WALLS).then(|| {
            let half = Vector::new((p.size_m[1] / 2.0).max(0.0), (p.size_m[0] / 2.0).max(0.0));
            (Pose::new(Vector::new(p.pose.x, p.pose.y), p.pose.yaw_rad), Cuboid::new(half))
        });
        Self { bounds: p.footprint().bounds(), turned }
    }

    /// Returns the area, m2.
    pub fn area(&self) -> f64 {
        self.turned.as_ref().map_or(self.bounds.area(), |(_, c)| 4.0 * c.half_extents.x * c.half_extents.y)
    }

    /// Returns the area in a rectangle, m2.
    pub fn area_in(&self, rect: &Rect) -> f64 {
        let within = self.bounds.common_area(rect);
        match self.polygon().filter(|_| within > 0.0) {
            Some(own) => own.intersection(&polygon_of(rect)).unsigned_area(),
            None => within,
        }
    }

    /// Returns the area that two outlines share, m2.
    pub fn common_area(&self, other: &Self) -> f64 {
        if self.bounds.common_area(&other.bounds) <= 0.0 {
            return 0.0;
        }
        match (&self.turned, &other.turned) {
            (None, None) => self.bounds.common_area(&other.bounds),
            (None, Some(_)) => other.area_in(&self.bounds),
            (Some(_), None) => self.area_in(&other.bounds),
            (Some((at, own)), Some((there, its))) => {
                let meet = query::intersection_test(at, own, there, its).is_ok_and(|found| found.intersecting);
                let both = self.polygon().zip(other.polygon()).filter(|_| meet);
                both.map_or(0.0, |(a, b)| a.intersection(&b).unsigned_area())
            }
        }
    }

    /// Returns the outline after giving way by so much on each side, m.
    pub fn shrunk(&self, by: f64) -> Self {
        match &self.turned {
            None => {
                let by = by.min(self.bounds.width() / 2.0).min(self.bounds.height() / 2.0);
                Self { bounds: self.bounds.grown(-by), turned: None }
            }
            Some((at, own)) => {
                let half = Vector::new((own.half_extents.x - by).max(0.0), (own.half_extents.y - by).max(0.0));
                Self { bounds: self.bounds, turned: Some((*at, Cuboid::new(half))) }
            }
        }
    }

    /// Returns the distance from a line, m; 0 where the line runs through the outline.
    pub fn distance_to(&self, line: &Segment) -> f64 {
        let (at, own) = self.turned.unwrap_or_else(|| along_walls(&self.bounds));
        let line = Line::new(Vector::new(line.start.x, line.start.y), Vector::new(line.end.x, line.end.y));
        query::distance(&at, &own, &Pose::IDENTITY, &line).map_or(f64::INFINITY, |found| found.distance)
    }

    /// Returns the outline of a turned object.
    fn polygon(&self) -> Option<geo::Polygon> {
        let (at, own) = self.turned.as_ref()?;
        let corners = own.to_polyline().into_iter().map(|p| at.transform_point(p));
        Some(geo::Polygon::new(corners.map(|p| (p.x, p.y)).collect::<Vec<_>>().into(), Vec::new()))
    }
}

fn along_walls(rect: &Rect) -> (Pose, Cuboid) {
    let (center, half) = (rect.center(), Vector::new(rect.width() / 2.0, rect.height() / 2.0));
    (Pose::from_translation(Vector::new(center.x, center.y)), Cuboid::new(half))
}

fn polygon_of(rect: &Rect) -> geo::Polygon {
    geo::Rect::new((rect.x0, rect.y0), (rect.x1, rect.y1)).to_polygon()
}

#[cfg(test)]
mod tests {
    use super::*;
    use d3dgen_model::Pose as At;
    use d3dgen_model::domain::Mount;

    fn outline(x: f64, y: f64, yaw_rad: f64, [width, depth]: [f64; 2]) -> Outline {
        Outline::of(&Placement {
            placement_id: "crate_1".into(),
            room_id: "room_1".into(),
            object: "crate".into(),
            asset: "Test/Crate".into(),
            asset_choice: None,
            pose: At { x, y, z: 0.0, yaw_rad },
            size_m: [width, depth, 1.0],
            mount: Mount::Floor,
            support: None,
            group: None,
            rule: "by hand".into(),
            locked: false,
        })
    }

    #[test]
    fn turned_outlines_share_what_they_share() {
        let (square, eighth) = ([1.0, 1.0], std::f64::consts::FRAC_PI_4);
        let diamond = outline(0.0, 0.0, eighth, square);
        assert!((diamond.area() - 1.0).abs() < 1e-9 && diamond.bounds.area() > 1.9);
        // the bounds share a corner of 0.2 m by 0.2 m, the outlines nothing
        let beside = outline(1.2, 1.2, eighth, square);
        assert!(diamond.bounds.common_area(&beside.bounds) > 0.04 && diamond.common_area(&beside) < 1e-9);
        // a quarter of the diamond lies in the first quadrant
        assert!((diamond.area_in(&Rect::new(0.0, 0.0, 5.0, 5.0)) - 0.25).abs() < 1e-6);
        assert!((diamond.common_area(&outline(2.5, 2.5, 0.0, [5.0, 5.0])) - 0.25).abs() < 1e-6);
        assert!((outline(2.5, 2.5, 0.0, [5.0, 5.0]).common_area(&diamond) - 0.25).abs() < 1e-6);
        assert!((diamond.shrunk(0.1).area() - 0.64).abs() < 1e-9);
    }

    #[test]
    fn outlines_along_walls_are_rectangles() {
        let a = outline(1.0, 1.0, std::f64::consts::FRAC_PI_2, [2.0, 1.0]);
        assert_eq!((a.area(), a.area_in(&Rect::new(1.0, 0.0, 9.0, 9.0))), (2.0, 1.0));
        assert_eq!(a.common_area(&outline(3.0, 1.0, 0.0, [1.0, 1.0])), 0.0);
    }

    #[test]
    fn distances_are_those_of_the_nearest_corner() {
        let wall = Segment { start: d3dgen_model::Point::new(2.0, -5.0), end: d3dgen_model::Point::new(2.0, 5.0) };
        let diamond = outline(0.0, 0.0, std::f64::consts::FRAC_PI_4, [1.0, 1.0]);
        assert!((diamond.distance_to(&wall) - (2.0 - 0.5f64.sqrt())).abs() < 1e-6);
        assert!((outline(0.0, 0.0, 0.0, [1.0, 1.0]).distance_to(&wall) - 1.5).abs() < 1e-6);
        assert_eq!(outline(2.0, 0.0, 0.3, [1.0, 1.0]).distance_to(&wall), 0.0);
    }
}
