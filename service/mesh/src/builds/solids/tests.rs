use std::collections::BTreeMap;

use d3dgen_model::domain::Side;
use d3dgen_model::seed::Stream;

use super::*;
use crate::affine::{cross, dot, sub};

/// Fails when an edge of the surface has not one triangle on each side, or a normal points inward.
pub(crate) fn assert_closed(surface: &Surface, what: &str) {
    let key = |i: u32| surface.positions[i as usize].map(|v| (v + 0.0).to_bits());
    let mut edges: BTreeMap<([u64; 3], [u64; 3]), i32> = BTreeMap::new();
    for t in &surface.triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            *edges.entry((key(a), key(b))).or_default() += 1;
            *edges.entry((key(b), key(a))).or_default() -= 1;
        }
    }
    let open = edges.values().filter(|count| **count != 0).count();
    assert_eq!(open, 0, "{what} has {open} open edges of {}", edges.len());
    assert!(surface.volume() > 0.0, "{what} is inside out or flat");
    for t in &surface.triangles {
        let [a, b, c] = t.map(|i| surface.positions[i as usize]);
        let face = cross(sub(b, a), sub(c, a));
        let agree: f64 = t.iter().map(|i| dot(face, surface.normals[*i as usize])).sum();
        assert!(agree >= -1e-9, "{what} has a normal against its triangle {t:?}");
    }
    assert!(surface.normals.iter().all(|n| (dot(*n, *n) - 1.0).abs() < 1e-6), "{what} has normals that are no unit");
}

fn assert_touches(surface: &Surface, frame: &Frame, what: &str) {
    let [min, max] = surface.bounds();
    for k in 0..3 {
        assert!(
            (min[k] - frame.min[k]).abs() < 1e-9 && (max[k] - frame.max[k]).abs() < 1e-9,
            "{what}: {min:?} {max:?}"
        );
    }
}

/// From plates to bars, of all proportions.
const SIZES: [[f64; 3]; 6] =
    [[0.6, 0.6, 0.9], [2.0, 0.9, 0.02], [0.03, 0.2, 0.1], [0.5, 0.005, 1.2], [0.02, 0.02, 0.02], [5.0, 1.1, 6.0]];

fn frames() -> impl Iterator<Item = Frame> {
    SIZES.into_iter().map(|s| Frame { min: [0.1, -0.2, 0.3], max: [0.1 + s[0], -0.2 + s[1], 0.3 + s[2]] })
}

fn details() -> [Detail; 3] {
    [Detail(1.0), Detail(0.6), Detail(0.4)]
}

#[test]
fn solids_with_a_box_are_closed_and_touch_it() {
    for frame in frames() {
        for detail in details() {
            for bevel in [0.0, 0.002, 0.5] {
                let made = upright_box(&frame, bevel);
                assert_closed(&made.surface, "box");
                assert_touches(&made.surface, &frame, "box");
            }
            for round in [0.0, 0.004, 0.05, 9.0] {
                let made = cushion(&frame, round, detail);
                assert_closed(&made.surface, "cushion");
                assert_touches(&made.surface, &frame, "cushion");
            }
            for axis in 0..3 {
                for top in [0.0, 0.5, 1.0, 1.6] {
                    let made = cone(&frame, axis, top, 0.003 * top, detail);
                    assert_closed(&made.surface, "cone");
                    assert_touches(&made.surface, &frame, "cone");
                }
                let least = frame.size().into_iter().fold(f64::MAX, f64::min);
                let made = torus(&frame, least * 0.1, axis, detail).unwrap();
                assert_touches(&made.surface, &frame, "torus");
                // Rings much longer than wide cross themselves at their ends.
                let (a, b) = (frame.size()[(axis + 1) % 3], frame.size()[(axis + 2) % 3]);
                if a.max(b) < 1.6 * a.min(b) {
                    assert_closed(&made.surface, "torus");
                }
            }
            let made = sphere(&frame, detail);
            assert_closed(&made.surface, "sphere");
            assert_touches(&made.surface, &frame, "sphere");
            let made = leaves(&frame, 20, &mut Stream::new(3, "test"), detail);
            assert_closed(&made.surface, "leaves");
            assert_touches(&made.surface, &frame, "leaves");
            for open in [Side::Top, Side::Bottom, Side::Front, Side::Back, Side::Left, Side::Right] {
                let least = frame.size().into_iter().fold(f64::MAX, f64::min);
                let made = shell(&frame, least * 0.2, least * 0.1, open).unwrap();
                assert_closed(&made.surface, "shell");
                assert_touches(&made.surface, &frame, "shell");
                let full: f64 = frame.size().iter().product();
                assert!(made.surface.volume() < 0.95 * full);
            }
        }
    }
}

#[test]
fn volumes_are_those_of_the_forms() {
    let frame = Frame { min: [0.0; 3], max: [1.0, 1.0, 2.0] };
    let near = |made: Made, expected: f64| {
        let volume = made.surface.volume();
        assert!((volume / expected - 1.0).abs() < 0.03, "{volume} {expected}");
    };
    near(upright_box(&frame, 0.0), 2.0);
    near(cone(&frame, 2, 1.0, 0.0, Detail(1.0)), 0.25 * std::f64::consts::PI * 2.0);
    near(cone(&frame, 2, 0.0, 0.0, Detail(1.0)), 0.25 * std::f64::consts::PI * 2.0 / 3.0);
    near(sphere(&frame, Detail(1.0)), 4.0 / 3.0 * std::f64::consts::PI * 0.25);
    near(shell(&frame, 0.1, 0.2, Side::Top).unwrap(), 2.0 - 0.8 * 0.8 * 1.8);
    near(prism(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]], 1, [0.5, 1.0]).unwrap(), 1.5);
}

#[test]
fn tubes_are_closed_and_mitered() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let bent = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.2, 1.0], [0.5, 0.2, 0.4], [0.1, 0.1, 0.1]];
    for path in [&square[..], &bent[..], &square[..2]] {
        for smooth in [false, true] {
            for closed in [false, true] {
                for detail in details() {
                    if closed && path.len() < 3 {
                        continue;
                    }
                    let made = tube(path, 0.02, smooth, closed, detail).unwrap();
                    assert_closed(&made.surface, "tube");
                    assert!(!made.hulls.is_empty());
                }
            }
        }
    }
    let straight = tube(&square[..2], 0.02, false, false, Detail(1.0)).unwrap();
    assert_touches(&straight.surface, &Frame { min: [0.0, -0.02, -0.02], max: [1.0, 0.02, 0.02] }, "straight tube");
    assert!(tube(&square, 0.0, false, false, Detail(1.0)).is_err());
    assert!(tube(&[[0.0; 3], [0.0; 3]], 0.1, false, false, Detail(1.0)).is_err());
}

#[test]
fn lathes_close_their_ends_and_rings() {
    let bowl = [[0.0, 0.0], [0.2, 0.0], [0.3, 0.2], [0.28, 0.2], [0.18, 0.02], [0.0, 0.02]];
    let barrel = [[0.2, 0.0], [0.25, 0.3], [0.2, 0.6]];
    let ring = [[0.2, 0.0], [0.3, 0.0], [0.3, 0.1], [0.2, 0.1], [0.2, 0.0]];
    let upside_down = [[0.2, 0.6], [0.25, 0.3], [0.2, 0.0]];
    for profile in [&bowl[..], &barrel[..], &ring[..], &upside_down[..]] {
        for axis in 0..3 {
            let made = lathe(profile, [1.0, 2.0], [1.0, 1.5], axis, Detail(1.0)).unwrap();
            assert_closed(&made.surface, "lathe");
        }
    }
    let made = lathe(&barrel, [1.0, 2.0], [1.0, 1.5], 1, Detail(1.0)).unwrap();
    let expected = Frame { min: [0.75, 0.0, 2.0 - 0.375], max: [1.25, 0.6, 2.0 + 0.375] };
    assert_touches(&made.surface, &expected, "lathe along y: at is x and z");
    assert!(lathe(&[[-0.1, 0.0], [0.2, 1.0]], [0.0; 2], [1.0; 2], 2, Detail(1.0)).is_err());
    assert!(lathe(&[[0.0, 0.0], [0.0, 1.0]], [0.0; 2], [1.0; 2], 2, Detail(1.0)).is_err());
}

#[test]
fn prisms_take_concave_outlines_in_either_sense() {
    let arch =
        [[0.0, 0.0], [0.2, 0.0], [0.2, 0.6], [0.5, 0.9], [0.8, 0.6], [0.8, 0.0], [1.0, 0.0], [1.0, 1.2], [0.0, 1.2]];
    let mut reversed = arch;
    reversed.reverse();
    for outline in [arch, reversed] {
        for axis in 0..3 {
            let made = prism(&outline, axis, [0.1, 0.3]).unwrap();
            assert_closed(&made.surface, "prism");
            assert!(made.hulls.len() > 1, "a concave outline needs several boxes");
        }
    }
    assert!(prism(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]], 0, [0.0, 1.0]).is_err(), "it crosses itself");
    assert!(prism(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], 0, [0.0, 1.0]).is_err(), "it has no area");
}
