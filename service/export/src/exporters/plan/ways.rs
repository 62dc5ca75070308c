//! Corridors in several pieces: a ring is two rooms of a plan and one corridor to who looks at the picture.

use d3dgen_model::floorplan::{Door, DoorKind, Floorplan, PlanRoom};

/// A room as it is named in the picture, with all its pieces.
pub(super) struct Named<'a> {
    pub name: String,
    /// Its pieces, by their places in the list of rooms.
    pub pieces: Vec<usize>,
    pub rooms: Vec<&'a PlanRoom>,
}

impl Named<'_> {
    /// Returns the net area of all its pieces, m^2.
    pub fn area_m2(&self) -> f64 {
        self.rooms.iter().map(|r| r.net_area_m2).sum()
    }
}

/// Returns the rooms of a plan, those pieces of corridor together that are open to each other.
pub(super) fn named(plan: &Floorplan) -> Vec<Named<'_>> {
    let mut out: Vec<Named<'_>> = Vec::with_capacity(plan.rooms.len());
    for (n, room) in plan.rooms.iter().enumerate() {
        let joined = |named: &Named<'_>| {
            room.circulation
                && named.rooms.iter().filter(|r| r.circulation).any(|r| plan.doors.iter().any(|d| joins(d, [r, room])))
        };
        match out.iter_mut().find(|named| joined(named)) {
            Some(whole) => {
                whole.pieces.push(n);
                whole.rooms.push(room);
            }
            None => out.push(Named { name: room.name.clone(), pieces: vec![n], rooms: vec![room] }),
        }
    }
    // the only one of its kind needs no number
    let kinds = |kind: &str| out.iter().filter(|named| named.rooms[0].room_type == kind).count();
    let alone: Vec<bool> =
        out.iter().map(|named| named.pieces.len() > 1 && kinds(&named.rooms[0].room_type) == 1).collect();
    for (named, _) in out.iter_mut().zip(alone).filter(|(_, alone)| *alone) {
        let bare = named.name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end().len();
        named.name.truncate(bare);
    }
    out
}

/// Returns true for the passage between two pieces of one corridor.
pub(super) fn is_between_pieces(plan: &Floorplan, door: &Door) -> bool {
    let rooms: Vec<&PlanRoom> = door.room_ids.iter().filter_map(|id| plan.room(id)).collect();
    matches!(rooms[..], [a, b] if joins(door, [a, b]))
}

fn joins(door: &Door, [a, b]: [&PlanRoom; 2]) -> bool {
    let between = [a, b].iter().all(|r| r.circulation && door.room_ids.contains(&r.room_id));
    // a stairwell is entered by a door
    between && door.kind == DoorKind::Open && a.room_type == b.room_type && a.level == b.level
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn pieces_of_one_corridor_have_one_name() {
        let mut plan = sample::world().floorplan;
        let hall = plan.rooms.iter().position(|r| r.circulation).expect("the sample has a hallway");
        plan.rooms[hall].name = "Hallway 1".into();
        let piece = PlanRoom { room_id: "piece".into(), name: "Hallway 2".into(), ..plan.rooms[hall].clone() };
        let ids = vec![plan.rooms[hall].room_id.clone(), piece.room_id.clone()];
        plan.rooms.push(piece);
        assert_eq!(named(&plan).len(), plan.rooms.len(), "a wall between them parts them");
        let passage = Door { kind: DoorKind::Open, room_ids: ids, ..plan.doors[0].clone() };
        assert!(is_between_pieces(&plan, &passage) && !is_between_pieces(&plan, &plan.doors[0]));
        plan.doors.push(passage);
        let named = named(&plan);
        assert_eq!(named.len(), plan.rooms.len() - 1);
        assert!(named.iter().any(|n| n.name == "Hallway" && n.pieces == [hall, plan.rooms.len() - 1]));
    }
}
