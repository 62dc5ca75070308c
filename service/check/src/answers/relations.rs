//! How rooms lie to each other in the finished plan.

use d3dgen_model::brief::{RelationAsk, RelationKind, Subject};
use d3dgen_model::floorplan::DoorKind;
use d3dgen_model::report::Fate;
use d3dgen_model::scene_graph::GraphRoom;

use super::{Asked, Finding};

/// Floor between two rooms up to which they are next to each other without a wall in common, m.
const NEAR_M: f64 = 6.0;

impl Asked<'_> {
    pub(super) fn relation(&self, asked: &RelationAsk) -> Finding {
        let a = self.rooms_called(&asked.a).rooms;
        if a.is_empty() {
            return self.things_in(asked).unwrap_or_else(|| missing(&asked.a));
        }
        let b = self.rooms_called(&asked.b).rooms;
        if b.is_empty() {
            return self.outdoors(asked, &a);
        }
        let holds = |x: &GraphRoom| b.iter().any(|y| x.id != y.id && self.lie_so(asked.relation, x, y));
        let negative = matches!(asked.relation, RelationKind::NotFrom | RelationKind::AwayFrom);
        let kept = |x: &GraphRoom| b.iter().all(|y| x.id == y.id || self.lie_so(asked.relation, x, y));
        let so = if negative { a.iter().all(|x| kept(x)) } else { a.iter().any(|x| holds(x)) };
        let ids = || a.iter().chain(&b).map(|r| r.id.clone()).collect();
        if so {
            return Finding::honored(ids());
        }
        if asked.relation == RelationKind::Sees {
            let reason = "no document tells what one sees through walls and glass";
            return Finding { ids: ids(), ..Finding::of(Fate::LeftOut, reason.into()) };
        }
        let near = a.iter().any(|x| b.iter().any(|y| self.gap_m(x, y).is_some_and(|gap| gap <= NEAR_M)));
        let fate = if near && !negative { Fate::Substituted } else { Fate::LeftOut };
        let reason = format!(
            "{} and {} do not lie so{}",
            asked.a.label(),
            asked.b.label(),
            if near { ", only near" } else { "" }
        );
        Finding { ids: ids(), ..Finding::of(fate, reason) }
    }

    fn lie_so(&self, relation: RelationKind, a: &GraphRoom, b: &GraphRoom) -> bool {
        let plan = &self.world.floorplan;
        let joined = || self.doors_between(&a.id, |id| id == b.id).next().is_some();
        let open = || self.doors_between(&a.id, |id| id == b.id).any(|d| d.kind == DoorKind::Open);
        let wall = || plan.walls.iter().any(|w| w.room_ids.contains(&a.id) && w.room_ids.contains(&b.id));
        match relation {
            RelationKind::NextTo | RelationKind::Between => joined() || wall(),
            RelationKind::Door => joined(),
            RelationKind::OpenTo => open(),
            RelationKind::OnlyFrom => joined() && self.is_entered_only(a, b),
            RelationKind::NotFrom => !joined(),
            RelationKind::AwayFrom => !joined() && !wall(),
            RelationKind::Sees | RelationKind::Faces => open(),
            RelationKind::Above => {
                let boxes = plan.room(&a.id).zip(plan.room(&b.id));
                a.level > b.level && boxes.is_some_and(|(x, y)| x.polygon.bounds().overlaps(&y.polygon.bounds()))
            }
        }
    }

    /// Returns true where every door of a room leads to another, or to what is entered from the room itself: its bathroom.
    fn is_entered_only(&self, a: &GraphRoom, from: &GraphRoom) -> bool {
        let plan = &self.world.floorplan;
        let serves = |id: &String| plan.doors_of(id).all(|d| d.room_ids.contains(&a.id));
        plan.doors_of(&a.id).all(|d| {
            let others = || d.room_ids.iter().filter(|id| **id != a.id);
            d.room_ids.contains(&from.id) || others().next().is_some() && others().all(serves)
        })
    }

    /// Returns the floor between two rooms of one storey, m.
    fn gap_m(&self, a: &GraphRoom, b: &GraphRoom) -> Option<f64> {
        let (x, y) = (self.world.floorplan.room(&a.id)?, self.world.floorplan.room(&b.id)?);
        (x.level == y.level).then(|| x.polygon.bounds().distance(&y.polygon.bounds()))
    }

    /// Answers for what is no room: the garden, the street. A door or window in an outer wall leads or looks there.
    fn outdoors(&self, asked: &RelationAsk, rooms: &[&GraphRoom]) -> Finding {
        if self.objects_called(&asked.b).placements.iter().any(|p| rooms.iter().any(|r| r.id == p.room_id)) {
            return Finding::honored(rooms.iter().map(|r| r.id.clone()).collect());
        }
        let plan = &self.world.floorplan;
        let leads = |r: &&&GraphRoom| plan.doors_of(&r.id).any(|d| d.room_ids.len() == 1);
        let looks = |r: &&&GraphRoom| plan.windows.iter().any(|w| w.room_id == r.id) || leads(r);
        let so: Vec<String> = match asked.relation {
            RelationKind::Door | RelationKind::OpenTo => rooms.iter().filter(leads).map(|r| r.id.clone()).collect(),
            RelationKind::Faces | RelationKind::Sees | RelationKind::NextTo => {
                rooms.iter().filter(looks).map(|r| r.id.clone()).collect()
            }
            _ => return missing(&asked.b),
        };
        let reason = || format!("{} has no way there", asked.a.label());
        Finding::when(!so.is_empty() && asked.b.id.as_deref() == Some(OUTDOORS), so, reason)
    }

    /// Answers for a thing beside a room or another thing; `None` where nothing goes by that name.
    fn things_in(&self, asked: &RelationAsk) -> Option<Finding> {
        let things = self.objects_called(&asked.a).placements;
        let first = things.first()?;
        let rooms = self.rooms_called(&asked.b).rooms;
        let inside: Vec<String> =
            things.iter().filter(|p| rooms.iter().any(|r| r.id == p.room_id)).map(|p| p.placement_id.clone()).collect();
        let reason = || format!("it stands in {}", first.room_id);
        Some(Finding::when(!inside.is_empty(), inside, reason))
    }
}

/// Id of what is no room of the building: a garden, a street, a yard.
const OUTDOORS: &str = "outdoors";

fn missing(subject: &Subject) -> Finding {
    Finding::of(Fate::LeftOut, format!("there is no {}", subject.label()))
}
