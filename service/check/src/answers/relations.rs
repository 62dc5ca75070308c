//! How rooms and things lie to each other in the finished plan.

use d3dgen_model::brief::{Ask, AskedCount, RelationAsk, RelationKind, Subject};
use d3dgen_model::floorplan::DoorKind;
use d3dgen_model::placements::Placement;
use d3dgen_model::report::Fate;
use d3dgen_model::scene_graph::GraphRoom;

use super::claims::ENTRANCE;
use super::{Asked, Finding, ids_of, names_of};

/// Floor between two rooms up to which they are next to each other without a wall in common, m.
const NEAR_M: f64 = 6.0;
/// Floor between two things that stand beside each other, at most, m.
const BESIDE_M: f64 = 1.5;
/// Id of what is no room of the building: a garden, a street, a yard.
const OUTDOORS: &str = "outdoors";

impl<'a> Asked<'a> {
    pub(super) fn relation(&self, ask: &Ask, asked: &RelationAsk) -> Finding {
        let a = self.rooms_meant(ask, &asked.a);
        if a.is_empty() {
            return self.things_in(ask, asked).unwrap_or_else(|| missing(&asked.a));
        }
        if asked.b.id.as_deref() == Some(ENTRANCE) && asked.relation == RelationKind::NextTo {
            return self.by_entrance(&a);
        }
        let b = self.rooms_meant(ask, &asked.b);
        if b.is_empty() {
            return self.outdoors(asked, &a);
        }
        if a.len() == 1 && b.len() == 1 && a[0].id == b[0].id {
            return Finding::of(Fate::LeftOut, format!("both are one room: {}", a[0].name)).with(ids_of(&a));
        }
        let ids = || ids_of(&a).into_iter().chain(ids_of(&b)).collect();
        let negative = matches!(asked.relation, RelationKind::NotFrom | RelationKind::AwayFrom);
        let lies = |x: &GraphRoom, y: &GraphRoom| x.id == y.id || self.lie_so(asked.relation, x, y);
        let holds = |x: &&&'a GraphRoom| {
            let mut others = b.iter().filter(|y| x.id != y.id);
            if negative { b.iter().all(|y| lies(x, y)) } else { others.any(|y| self.lie_so(asked.relation, x, y)) }
        };
        let not: Vec<&GraphRoom> = a.iter().filter(|x| !holds(x)).copied().collect();
        if not.is_empty() {
            return Finding::honored(ids());
        }
        if asked.relation == RelationKind::Sees {
            let reason = "no document tells what one sees through walls and glass";
            return Finding::of(Fate::LeftOut, reason.into()).with(ids());
        }
        let near = a.iter().any(|x| b.iter().any(|y| self.gap_m(x, y).is_some_and(|gap| gap <= NEAR_M)));
        let fate = if (near || not.len() < a.len()) && !negative { Fate::Substituted } else { Fate::LeftOut };
        let reason = format!(
            "not so: {} to {}{}",
            names_of(&not),
            names_of(&b),
            if near && !negative { ", only near" } else { "" }
        );
        let n = (a.len() - not.len()) as u32;
        let of = AskedCount::at_least(a.len() as u32);
        Finding { asked: Some(f64::from(of.n)), measured: Some(f64::from(n)), ..Finding::of(fate, reason).with(ids()) }
    }

    /// Answers for rooms at the way into the building: measured from its doors, not from the hall behind them.
    fn by_entrance(&self, rooms: &[&'a GraphRoom]) -> Finding {
        let plan = &self.world.floorplan;
        let doors = || plan.doors.iter().filter(|d| d.entrance);
        let gap_m = |r: &GraphRoom| {
            let bounds = plan.room(&r.id)?.polygon.bounds();
            doors().map(|d| bounds.distance_to(d.line.middle())).min_by(f64::total_cmp)
        };
        let gaps: Vec<f64> = rooms.iter().filter(|r| r.level == 0).filter_map(|r| gap_m(r)).collect();
        let far = gaps.iter().copied().max_by(f64::total_cmp).filter(|_| gaps.len() == rooms.len());
        match far {
            Some(gap) if gap <= NEAR_M => Finding::honored(ids_of(rooms)),
            Some(gap) => {
                let reason = format!("{gap:.1} m from the entrance, at most {NEAR_M} m is beside it");
                Finding::of(Fate::LeftOut, reason).with(ids_of(rooms))
            }
            None => Finding::of(Fate::LeftOut, "not on the storey of the entrance".into()).with(ids_of(rooms)),
        }
    }

    fn lie_so(&self, relation: RelationKind, a: &'a GraphRoom, b: &GraphRoom) -> bool {
        let plan = &self.world.floorplan;
        let joined = || plan.doors_of(&a.id).any(|d| d.room_ids.contains(&b.id));
        let open = || plan.doors_of(&a.id).any(|d| d.room_ids.contains(&b.id) && d.kind == DoorKind::Open);
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
    fn outdoors(&self, asked: &RelationAsk, rooms: &[&'a GraphRoom]) -> Finding {
        let things = self.objects_called(&asked.b);
        if things.iter().any(|p| rooms.iter().any(|r| r.id == p.room_id)) {
            return Finding::honored(ids_of(rooms));
        }
        let plan = &self.world.floorplan;
        let leads = |r: &&&GraphRoom| plan.doors_of(&r.id).any(|d| d.room_ids.len() == 1);
        let looks = |r: &&&GraphRoom| plan.windows.iter().any(|w| w.room_id == r.id) || leads(r);
        let so: Vec<&GraphRoom> = match asked.relation {
            RelationKind::Door | RelationKind::OpenTo => rooms.iter().filter(leads).copied().collect(),
            RelationKind::Faces | RelationKind::Sees | RelationKind::NextTo => {
                rooms.iter().filter(looks).copied().collect()
            }
            _ => return missing(&asked.b),
        };
        let reason = || format!("{} has no way there", names_of(rooms));
        Finding::when(!so.is_empty() && asked.b.id.as_deref() == Some(OUTDOORS), ids_of(&so), reason)
    }

    /// Answers for a thing in a room, or beside another thing; `None` where nothing goes by that name.
    fn things_in(&self, ask: &Ask, asked: &RelationAsk) -> Option<Finding> {
        let things = self.objects_called(&asked.a);
        let first = things.first()?;
        let rooms = self.rooms_meant(ask, &asked.b);
        let others = self.objects_called(&asked.b);
        let ids = |so: Vec<&Placement>| so.iter().map(|p| p.placement_id.clone()).collect::<Vec<_>>();
        if rooms.is_empty() && !others.is_empty() {
            let beside = |p: &&Placement| others.iter().any(|o| is_beside(p, o));
            let so: Vec<&Placement> = things.iter().copied().filter(beside).collect();
            let reason = || format!("it stands in {}, not beside `{}`", self.name_of(&first.room_id), asked.b.name);
            return Some(Finding::when(!so.is_empty(), ids(so), reason).or_near());
        }
        let inside: Vec<&Placement> =
            things.iter().copied().filter(|p| rooms.iter().any(|r| r.id == p.room_id)).collect();
        let reason = || format!("it stands in {}", self.name_of(&first.room_id));
        Some(Finding::when(!inside.is_empty(), ids(inside), reason).or_near())
    }
}

/// Returns true for things that stand beside each other in one room.
fn is_beside(a: &Placement, b: &Placement) -> bool {
    let apart = a.footprint().bounds().distance(&b.footprint().bounds());
    a.room_id == b.room_id && a.placement_id != b.placement_id && apart <= BESIDE_M
}

fn missing(subject: &Subject) -> Finding {
    Finding::of(Fate::LeftOut, format!("there is no `{}`", subject.name))
}
