//! How things of a shape like to stand: what makes one valid position better than another.

use d3dgen_model::domain::{Mount, Shape};

/// Preferences of one kind of body; 0 means it does not care.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Style {
    /// Middle of a free stretch of wall.
    pub centered: f64,
    /// Flush with a corner or a neighbor.
    pub flush: f64,
    /// No window behind it.
    pub solid_behind: f64,
    /// Its side to a window: on the wall next to the window wall.
    pub side_light: f64,
    /// Away from the door.
    pub far_from_door: f64,
    /// Not with its user's back to the door.
    pub door_in_view: f64,
    /// On the shortest stretch of wall it fits.
    pub tight: f64,
    /// Far from others of its kind rather than in line with them.
    pub spread: f64,
}

const PLAIN: Style = Style {
    centered: 0.0,
    flush: 0.5,
    solid_behind: 0.2,
    side_light: 0.0,
    far_from_door: 0.0,
    door_in_view: 0.0,
    tight: 0.4,
    spread: 0.0,
};

/// Returns the preferences of a shape; `both_sides` when it is used from its left and right.
pub(crate) fn style(shape: Shape, mount: Mount, both_sides: bool) -> Style {
    if mount == Mount::Wall {
        return match shape {
            Shape::Sink | Shape::Basin | Shape::Toilet => Style { flush: 0.1, solid_behind: 0.6, ..PLAIN },
            Shape::Panel => Style { centered: 0.8, flush: 0.0, tight: 0.0, ..PLAIN },
            _ => Style { centered: 0.3, flush: 0.0, tight: 0.1, spread: 0.6, ..PLAIN },
        };
    }
    match shape {
        Shape::Bed | Shape::HospitalBed => Style {
            centered: if both_sides { 0.9 } else { 0.0 },
            flush: if both_sides { 0.0 } else { 0.7 },
            solid_behind: 3.0,
            far_from_door: 1.2,
            tight: 0.0,
            ..PLAIN
        },
        Shape::Sofa => Style {
            centered: 0.7,
            flush: 0.0,
            solid_behind: 0.3,
            far_from_door: 0.6,
            door_in_view: 0.0,
            tight: 0.0,
            ..PLAIN
        },
        Shape::Desk => Style {
            flush: 0.4,
            solid_behind: 0.4,
            side_light: 1.0,
            far_from_door: 0.4,
            door_in_view: 0.8,
            tight: 0.2,
            ..PLAIN
        },
        Shape::Table | Shape::RoundTable => Style { centered: 0.5, flush: 0.1, tight: 0.0, ..PLAIN },
        Shape::Stove => Style { flush: 0.8, far_from_door: 1.5, solid_behind: 0.8, ..PLAIN },
        Shape::Sink | Shape::Counter | Shape::Appliance => Style { flush: 0.8, far_from_door: 0.2, ..PLAIN },
        Shape::Cabinet | Shape::Shelf | Shape::Rack => Style { flush: 0.8, solid_behind: 1.0, tight: 0.6, ..PLAIN },
        Shape::Bench | Shape::Panel => Style { centered: 0.4, flush: 0.2, tight: 0.2, ..PLAIN },
        Shape::Bathtub | Shape::Shower | Shape::Cubicle => {
            Style { flush: 1.0, far_from_door: 0.8, solid_behind: 0.6, ..PLAIN }
        }
        Shape::Toilet => Style { flush: 0.0, far_from_door: 0.5, solid_behind: 0.4, tight: 0.3, ..PLAIN },
        Shape::Basin => Style { flush: 0.1, solid_behind: 0.5, ..PLAIN },
        Shape::Plant | Shape::Lamp | Shape::Pole => {
            Style { flush: 1.0, tight: 0.8, far_from_door: 0.3, solid_behind: 0.0, spread: 1.0, ..PLAIN }
        }
        _ => PLAIN,
    }
}

/// Returns a number in 0..1 that depends on the salt and the place only, so that it does not matter how many places
/// were looked at before.
pub(crate) fn grain(salt: u64, a: i64, b: i64) -> f64 {
    let mut z = salt ^ (a as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (b as u64).wrapping_mul(0xd1b5_4a32_d192_ed03);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
