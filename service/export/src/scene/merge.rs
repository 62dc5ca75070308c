//! Boxes in line with each other as one.

use std::collections::BTreeMap;

use super::SimBox;

/// What is taken for the same place, m and rad.
const SAME: f64 = 1e-5;

/// From where to where a box goes along its own axes, in a frame turned by its heading.
type Spans = [[f64; 2]; 3];

/// Returns boxes that fill the same space with fewer of them: those that go on where another ends become one with it.
pub fn merged(boxes: &[SimBox]) -> Vec<SimBox> {
    let mut boxes = boxes.to_vec();
    loop {
        let before = boxes.len();
        for axis in [0, 2, 1] {
            boxes = along(&boxes, axis);
        }
        if boxes.len() == before {
            return boxes;
        }
    }
}

/// Joins boxes along one of their own axes.
fn along(boxes: &[SimBox], axis: usize) -> Vec<SimBox> {
    let number = |v: f64| (v / SAME / 10.0).round() as i64;
    // heading, and the two other extents -> the spans along the axis
    let mut rows: BTreeMap<[i64; 5], (f64, Vec<Spans>)> = BTreeMap::new();
    for own in boxes {
        let yaw = own.yaw_rad.rem_euclid(std::f64::consts::PI);
        let yaw = if std::f64::consts::PI - yaw < SAME { 0.0 } else { yaw };
        let spans = spans(own, yaw);
        let [a, b] = [spans[(axis + 1) % 3], spans[(axis + 2) % 3]];
        let key = [number(yaw), number(a[0]), number(a[1]), number(b[0]), number(b[1])];
        rows.entry(key).or_insert((yaw, Vec::new())).1.push(spans);
    }
    let mut out = Vec::new();
    for (yaw, mut row) in rows.into_values() {
        row.sort_by(|a, b| a[axis][0].total_cmp(&b[axis][0]));
        let mut joined: Vec<Spans> = Vec::new();
        for spans in row {
            match joined.last_mut() {
                Some(last) if spans[axis][0] <= last[axis][1] + SAME => {
                    last[axis][1] = last[axis][1].max(spans[axis][1])
                }
                _ => joined.push(spans),
            }
        }
        out.extend(joined.iter().map(|spans| solid(spans, yaw)));
    }
    out
}

/// Returns from where to where a box goes along its own axes, in a frame turned by its heading.
fn spans(own: &SimBox, yaw: f64) -> Spans {
    let (sin, cos) = yaw.sin_cos();
    let [x, y, z] = own.center_m;
    let center = [cos * x + sin * y, cos * y - sin * x, z];
    std::array::from_fn(|i| [center[i] - own.half_m[i], center[i] + own.half_m[i]])
}

fn solid(spans: &Spans, yaw_rad: f64) -> SimBox {
    let (sin, cos) = yaw_rad.sin_cos();
    let [u, v, z] = spans.map(|[a, b]| (a + b) / 2.0);
    SimBox { center_m: [cos * u - sin * v, sin * u + cos * v, z], half_m: spans.map(|[a, b]| (b - a) / 2.0), yaw_rad }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_a_wall_become_one_and_an_opening_stays() {
        for yaw_rad in [0.0, 0.6, 3.0] {
            let (sin, cos) = f64::sin_cos(yaw_rad);
            let piece = |from: f64, to: f64, z: [f64; 2], turned: bool| SimBox {
                center_m: [cos * (from + to) / 2.0, sin * (from + to) / 2.0, (z[0] + z[1]) / 2.0],
                half_m: [(to - from) / 2.0, 0.06, (z[1] - z[0]) / 2.0],
                // the same box, seen from its other end
                yaw_rad: if turned { yaw_rad + std::f64::consts::PI } else { yaw_rad },
            };
            let wall = [
                piece(0.0, 1.0, [0.0, 2.5], false),
                piece(1.0, 2.0, [0.0, 2.5], true),
                piece(2.0, 3.0, [2.0, 2.5], false),
                piece(3.0, 4.0, [0.0, 1.0], false),
                piece(3.0, 4.0, [1.0, 2.5], false),
            ];
            let found = merged(&wall);
            assert_eq!(found.len(), 3, "{found:?}");
            let volume: f64 = found.iter().map(|b| b.half_m.iter().product::<f64>() * 8.0).sum();
            let expected: f64 = wall.iter().map(|b| b.half_m.iter().product::<f64>() * 8.0).sum();
            assert!((volume - expected).abs() < 1e-6);
        }
    }
}
