//! The circle on which a wheelchair turns, kept free while a room is furnished whose rules ask for one.

use super::geom::Box2;

/// Grain of the places that are looked at, mm.
const GRAIN: i32 = 50;

/// Free floor to turn on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Circle {
    radius: i32,
    center: (i32, i32),
}

impl Circle {
    /// Returns a circle of a radius, mm, that has a place within bounds beside what is no floor or takes some of it.
    pub(crate) fn find(b: &Box2, holes: &[Box2], bodies: &[&[Box2]], radius: i32) -> Option<Self> {
        let steps = |low: i32, high: i32| {
            let (low, high) = (low + radius, high - radius);
            (low..=high).step_by(GRAIN as usize).chain((low <= high).then_some(high))
        };
        let at = |x: i32, y: i32| Self { radius, center: (x, y) };
        let places = || steps(b.x0, b.x1).flat_map(|x| steps(b.y0, b.y1).map(move |y| at(x, y)));
        let others = || holes.iter().chain(bodies.iter().copied().flatten());
        // what is in the way of one place is mostly in the way of the next
        let mut last: Option<&Box2> = None;
        places().find(|circle| {
            if last.is_some_and(|other| !circle.is_clear_of(other)) {
                return false;
            }
            last = others().find(|other| !circle.is_clear_of(other));
            last.is_none()
        })
    }

    /// Returns true when a body takes none of it.
    pub(crate) fn is_clear_of(&self, other: &Box2) -> bool {
        let (x, y) = self.center;
        let dx = i64::from((other.x0 - x).max(x - other.x1).max(0));
        let dy = i64::from((other.y0 - y).max(y - other.y1).max(0));
        dx * dx + dy * dy >= i64::from(self.radius).pow(2)
    }
}

#[cfg(test)]
mod tests {
    use super::super::geom::Box2;
    use super::Circle;

    #[test]
    fn finds_a_circle_beside_what_stands_there() {
        let room = Box2::new(0, 0, 2000, 3000);
        let cabinet = |y0: i32| [Box2::new(0, y0, 1000, y0 + 300)];
        let has = |holes: &[Box2], bodies: &[Box2], radius| Circle::find(&room, holes, &[bodies], radius).is_some();
        assert!(has(&[], &[], 750));
        assert!(has(&[], &cabinet(600), 750));
        assert!(!has(&[], &cabinet(1350), 750));
        assert!(!has(&cabinet(1350), &[], 750));
        assert!(!has(&[], &[], 1010));
    }
}
