//! Walls that other buildings stand against: a flat between others, a house in a row. They have no windows, and no doors but that
//! of a flat to the stairs of its building.
//!
//! Neighbors stand along one axis only, so that a wall is one of theirs by the way it runs, wherever a notch puts it.

use d3dgen_model::domain::Attached;
use d3dgen_model::floorplan::Floorplan;

use super::outline::Stretch;

/// All outer walls that run one way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Party {
    /// True for walls that run north-south, false for those that run east-west.
    pub vertical: bool,
    /// True where one comes in through one of them, from the stairs of the building.
    pub entered: bool,
}

impl Party {
    /// Returns the walls of neighbors in the frame of a search, whose corridor runs from west to east: the ends of the corridor
    /// of a flat, which one enters there; the long sides of a house in a row, which is narrow and entered from the street.
    pub(crate) fn of(attached: Attached) -> Self {
        let flat = attached == Attached::Flat;
        Self { vertical: flat, entered: flat }
    }

    /// Returns the walls of neighbors of a finished plan: those of the one way in which no window is.
    pub(crate) fn of_plan(attached: Attached, plan: &Floorplan) -> Option<Self> {
        let lit = |vertical: bool| plan.windows.iter().any(|w| w.line.is_vertical() == vertical);
        (lit(true) != lit(false)).then(|| Self { vertical: lit(false), entered: attached == Attached::Flat })
    }

    /// Returns true for an outer wall with neighbors behind it.
    pub(crate) fn covers(self, s: &Stretch) -> bool {
        s.is_outer() && s.vertical == self.vertical
    }
}
