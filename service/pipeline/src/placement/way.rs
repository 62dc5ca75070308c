//! The way through circulation: how wide it must stay from door to door.

use d3dgen_knowledge::freespace::FreeSpace;
use d3dgen_model::floorplan::{Door, Floorplan, PlanRoom};
use d3dgen_model::{Polygon, TOLERANCE_M};

use super::geom::Box2;

/// What has to get through a circulation room.
#[derive(Debug, Clone)]
pub(super) struct Way {
    outline: Polygon,
    doors: Vec<Door>,
    /// Clear width to keep, m.
    width_m: f64,
}

impl Way {
    /// Returns the way of a clear width, m, through a room; `None` where it is no circulation, or narrower without furniture already (then
    /// only robots' own room counts).
    pub fn new(plan: &Floorplan, room: &PlanRoom, width_m: f64) -> Option<Self> {
        let out =
            Self { outline: room.net_polygon.clone(), doors: plan.doors_of(&room.room_id).cloned().collect(), width_m };
        (room.circulation && out.stays_open(&[])).then_some(out)
    }

    /// Returns true when the obstacles leave the width between all doors.
    pub fn stays_open(&self, obstacles: &[Box2]) -> bool {
        let taken: Vec<_> = obstacles.iter().map(Box2::meters).collect();
        let doors: Vec<&Door> = self.doors.iter().collect();
        FreeSpace::new(&self.outline, &taken).passes(&doors, self.width_m - TOLERANCE_M)
    }
}
