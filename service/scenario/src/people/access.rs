//! Who may go where: the rooms that a role gets to through rooms it may enter.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Domain, Role, RoomType};
use d3dgen_model::floorplan::Floorplan;

use super::Neighbors;

/// The rooms of a building, by what they are and what they open to.
pub(super) struct Access<'a> {
    kinds: BTreeMap<&'a str, (&'a RoomType, BTreeSet<&'a str>)>,
    neighbors: Neighbors<'a>,
}

impl<'a> Access<'a> {
    pub fn new(plan: &'a Floorplan, domain: &'a Domain) -> Self {
        let kind = |id: &str| domain.room_type_or_generic(id);
        let kinds = plan.rooms.iter().map(|r| {
            let kind = kind(&r.room_type);
            (r.room_id.as_str(), (kind, domain.tags_of(kind)))
        });
        let mut neighbors: Neighbors = BTreeMap::new();
        let doors = plan.doors.iter().map(|d| &d.room_ids);
        for ids in doors.chain(plan.links.iter().map(|l| &l.room_ids)) {
            for a in ids {
                neighbors.entry(a).or_default().extend(ids.iter().filter(|b| *b != a).map(String::as_str));
            }
        }
        Self { kinds: kinds.collect(), neighbors }
    }

    /// Returns the rooms that a role gets to from one of them through those it may enter; all that it may enter, where it
    /// begins nowhere.
    pub fn reach(&self, role: &Role, from: Option<&str>) -> BTreeSet<&'a str> {
        let may = |id: &str| self.kinds.get(id).is_some_and(|(kind, tags)| role.may_enter(kind, tags));
        let Some(from) = from.and_then(|id| self.kinds.get_key_value(id)).map(|(id, _)| *id).filter(|id| may(id))
        else {
            return self.kinds.keys().copied().filter(|id| may(id)).collect();
        };
        let mut out = BTreeSet::from([from]);
        let mut open = vec![from];
        while let Some(room) = open.pop() {
            for next in self.neighbors.get(room).into_iter().flatten().copied() {
                if may(next) && out.insert(next) {
                    open.push(next);
                }
            }
        }
        out
    }
}
