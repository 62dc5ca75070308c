//! Ways through a room that furniture must leave open: from door to door in circulation and between the entrance and
//! what lies behind a reception, and for beds from where they stand to the corridor.

use d3dgen_knowledge::freespace::FreeSpace;
use d3dgen_model::floorplan::{Door, Floorplan, PlanRoom};
use d3dgen_model::{Polygon, Rect, TOLERANCE_M};

use super::geom::Box2;

/// Width of the way from the entrance through a room, m: what accessible routes have at least (ISO 21542), and what two who
/// meet need, which a room with a counter still has beside those who wait across it. Buildings whose corridors are narrower ask for no more than those have.
const THROUGH_M: [f64; 2] = [1.2, 1.5];
/// Floor that a bed takes beside its own width when it is pushed, m, at least and as one would have it.
const BESIDE_BED_M: [f64; 2] = [0.05, 0.2];

/// Clear width of a door to outdoors from which on patients are brought in through it, m.
const BROUGHT_M: f64 = 1.2;
/// Floor around a bed that is turned through a door, m, over its width and its length.
const BED_SPARE_M: f64 = 0.05;

/// What has to get through a room.
#[derive(Debug, Clone)]
pub(crate) struct Way {
    outline: Polygon,
    doors: Vec<Door>,
    /// Clear width to keep, m; of a way for beds what goes beyond the width of the bed.
    width_m: f64,
    pub kind: Kind,
}

/// Who goes there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Everybody, through circulation.
    Circulation,
    /// Everybody, from the entrance to circulation, through a room that is something else.
    Through,
    /// Beds, to the corridor.
    Beds,
}

/// What stands in a room, as ways see it.
#[derive(Debug, Clone, Default)]
pub(crate) struct InTheWay {
    /// Outlines of what narrows a way for people.
    pub narrowing: Vec<Box2>,
    /// Floor that robots take at their docks.
    pub parked: Vec<Box2>,
    /// Outlines of beds on wheels.
    pub beds: Vec<Box2>,
    /// Outlines of what does not go with a bed.
    pub fixed: Vec<Box2>,
}

impl InTheWay {
    /// Returns true when nothing is in anybody's way.
    pub fn is_empty(&self) -> bool {
        self.narrowing.is_empty() && self.parked.is_empty() && self.beds.is_empty()
    }

    /// Adds what else stands there.
    pub fn extend(&mut self, more: &Self) {
        self.narrowing.extend_from_slice(&more.narrowing);
        self.parked.extend_from_slice(&more.parked);
        self.beds.extend_from_slice(&more.beds);
        self.fixed.extend_from_slice(&more.fixed);
    }
}

impl Way {
    /// Returns the ways that a room keeps, the least one and the one that is advised, where the empty room has them;
    /// `widths_m` are those of circulation, `beds` tells whether patients are brought in their beds.
    pub fn of_room(plan: &Floorplan, room: &PlanRoom, widths_m: [f64; 2], beds: bool) -> [Option<Self>; 2] {
        let circulation = |id: &String| *id != room.room_id && plan.room(id).is_some_and(|r| r.circulation);
        let doors = || plan.doors_of(&room.room_id);
        let inward: Vec<Door> = doors().filter(|d| d.room_ids.iter().any(circulation)).cloned().collect();
        // where an ambulance brings patients they come in on a stretcher, past those that wait for the next
        let brought = |d: &&Door| beds && d.room_ids.len() == 1 && d.clear_width_m >= BROUGHT_M;
        let entrance = doors().find(|d| d.entrance).or_else(|| doors().find(brought));
        let (kind, doors, widths): (_, Vec<Door>, _) = if room.circulation {
            (Kind::Circulation, doors().cloned().collect(), widths_m)
        } else if let Some(entrance) = entrance.filter(|_| !inward.is_empty()) {
            let widths = [0, 1].map(|k| THROUGH_M[k].min(widths_m[k]));
            (Kind::Through, inward.into_iter().chain([entrance.clone()]).collect(), widths)
        } else if beds && !inward.is_empty() {
            (Kind::Beds, inward, BESIDE_BED_M)
        } else {
            return [None, None];
        };
        let way = |width_m: f64| {
            let out = Self { outline: room.net_polygon.clone(), doors: doors.clone(), width_m, kind };
            // narrower without furniture already: only robots' own room counts then
            out.stays_open(&InTheWay::default()).then_some(out)
        };
        let least = way(widths[0]);
        let advised = way(widths[1].max(widths[0])).or_else(|| least.clone());
        [least, advised]
    }

    /// Returns true when what stands there leaves the width.
    pub fn stays_open(&self, there: &InTheWay) -> bool {
        let doors: Vec<&Door> = self.doors.iter().collect();
        let free = |taken: &mut dyn Iterator<Item = &Box2>| {
            let taken: Vec<Rect> = taken.map(Box2::meters).collect();
            FreeSpace::new(&self.outline, &taken)
        };
        match self.kind {
            Kind::Circulation => free(&mut there.narrowing.iter()).passes(&doors, self.width_m - TOLERANCE_M),
            Kind::Through => {
                let taken = &mut there.narrowing.iter().chain(&there.parked);
                free(taken).passes(&doors, self.width_m - TOLERANCE_M)
            }
            Kind::Beds => there.beds.iter().enumerate().all(|(k, bed)| {
                let others = there.beds.iter().enumerate().filter(|(n, _)| *n != k).map(|(_, b)| b);
                let floor = free(&mut there.fixed.iter().chain(others));
                let bed = bed.meters();
                let [short, long] = [bed.width().min(bed.height()), bed.width().max(bed.height())];
                let width = short + self.width_m - TOLERANCE_M;
                let turned = [long, short].map(|side| side + BED_SPARE_M);
                let out = |door: &&Door| floor.leads(door, &bed, width) && floor.turns_in(door, turned[0], turned[1]);
                self.doors.iter().any(|door| out(&door))
            }),
        }
    }
}
