//! Measures that several stages and the checks share, each once.

/// Width of one seat of a bench, m.
pub const BENCH_SEAT_M: f64 = 0.55;

/// Beds at least so wide are for two, m.
pub const BED_FOR_TWO_M: f64 = 1.35;

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
