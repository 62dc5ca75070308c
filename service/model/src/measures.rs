//! Measures that several stages and the checks share, each once.

/// Width of one seat of a bench, m.
pub const BENCH_SEAT_M: f64 = 0.55;

/// Beds at least so wide are for two, m.
pub const BED_FOR_TWO_M: f64 = 1.35;

/// Beds at least so high have another one above, m.
pub const BUNK_BED_M: f64 = 1.4;

/// Returns how many people sleep in a bed of a size (width, depth, height), m: side by side, and one above the other.
pub fn sleepers_in(size_m: [f64; 3]) -> u32 {
    let [width, _, height] = size_m;
    let side_by_side = if width >= BED_FOR_TWO_M { 2 } else { 1 };
    if height >= BUNK_BED_M { side_by_side * 2 } else { side_by_side }
}

/// Least wall between a door and a corner of its room, m.
pub const JAMB_M: f64 = 0.10;

/// Height of a usual door, m.
pub const DOOR_HEIGHT_M: f64 = 2.1;

/// Least radius of the disc that must find its way, m: a person, or a small robot.
pub const LEAST_RADIUS_M: f64 = 0.30;

/// Share of a storey that may jut out over the one below: more is a building in the air.
pub const MOST_OVERHANG: f64 = 0.10;

/// How many times as long as wide a room may be before that is called a fault.
pub const MOST_ELONGATED: f64 = 2.5;
