//! The circle on which a wheelchair turns, kept free while a room is furnished whose rules ask for one.

use super::geom::Box2;

/// Grain of the places that are looked at, mm.
const GRAIN: i32 = 50;

/// Returns true when a circle of a radius, mm, has a place within bounds beside what is no floor or takes some of it.
pub(super) fn has_circle(b: &Box2, holes: &[Box2], bodies: &[Box2], radius: i32) -> bool {
    let squared = i64::from(radius).pow(2);
    let clear = |x: i32, y: i32, other: &Box2| {
        let dx = i64::from((other.x0 - x).max(x - other.x1).max(0));
        let dy = i64::from((other.y0 - y).max(y - other.y1).max(0));
        dx * dx + dy * dy >= squared
    };
    let steps = |low: i32, high: i32| {
        let (low, high) = (low + radius, high - radius);
        (low..=high).step_by(GRAIN as usize).chain((low <= high).then_some(high))
    };
    steps(b.x0, b.x1).any(|x| steps(b.y0, b.y1).any(|y| holes.iter().chain(bodies).all(|other| clear(x, y, other))))
}

#[cfg(test)]
mod tests {
    use super::super::geom::Box2;
    use super::has_circle;

    #[test]
    fn finds_a_circle_beside_what_stands_there() {
        let room = Box2::new(0, 0, 2000, 3000);
        let cabinet = |y0: i32| [Box2::new(0, y0, 1000, y0 + 300)];
        assert!(has_circle(&room, &[], &[], 750));
        assert!(has_circle(&room, &[], &cabinet(600), 750));
        assert!(!has_circle(&room, &[], &cabinet(1350), 750));
        assert!(!has_circle(&room, &cabinet(1350), &[], 750));
        assert!(!has_circle(&room, &[], &[], 1010));
    }
}
