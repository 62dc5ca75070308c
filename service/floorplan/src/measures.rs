//! Measures of plans that several parts of the stage go by.

/// Clear width from which a door gets two leaves, m.
pub(crate) const DOUBLE_FROM_M: f64 = 1.25;

/// Share of the floor area from which on a plan is symmetric whose mirror images are rooms of the same kind.
pub(crate) const SYMMETRIC: f64 = 0.8;

/// Wall left between a window and a corner, and between two windows, m.
pub(crate) const MARGIN_M: f64 = 0.35;

/// Widest and narrowest single window, m.
pub(crate) const PANE_M: (f64, f64) = (2.4, 0.6);

/// Outer wall that takes the narrowest window, m: the least of a room that needs one.
pub(crate) const LEAST_WALL_M: f64 = PANE_M.1 + 2.0 * MARGIN_M;

/// Clear width of a door to the garden, m: two glazed leaves.
pub(crate) const GARDEN_DOOR_M: f64 = 1.4;
