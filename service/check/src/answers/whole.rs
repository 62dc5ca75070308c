//! Facts about the building as a whole: storeys, floor, access, manner, what is ruled out.

use d3dgen_model::brief::{
    AccessAsk, AreaAsk, Ask, AskedCount, Bound, ForbiddenAsk, OnlyAsk, SiteAsk, SiteKind, StoreysAsk, StyleAsk,
};
use d3dgen_model::courts;
use d3dgen_model::domain::{Attached, GENERIC_ROOM_TYPE};
use d3dgen_model::offer::Wet;
use d3dgen_model::report::Fate;
use d3dgen_model::scene_graph::GraphRoom;
use d3dgen_model::style::{Form, Style, StyleWord};

use super::{Asked, Finding, ids_of, listed, names_of};

/// The form of a building around open ground.
const COURTYARD: StyleWord = StyleWord::Form(Form::Courtyard);
/// Share by which the floor of a building may miss what was asked for: walls and corridors take what they need.
const FLOOR_MISS: f64 = 0.15;

impl Asked<'_> {
    pub(super) fn storeys(&self, asked: &StoreysAsk) -> Finding {
        let mut levels: Vec<i32> = self.world.scene_graph.rooms.iter().map(|r| r.level).collect();
        levels.sort_unstable();
        levels.dedup();
        let n = levels.len() as u32;
        let counted = Finding::number(asked.count, n, || format!("{} asked for, {n} built", asked.count));
        let basement = !asked.basement || levels.iter().any(|l| *l < 0);
        counted.and(Finding::when(basement, Vec::new(), || "no basement is built".into()))
    }

    pub(super) fn area(&self, asked: &AreaAsk) -> Finding {
        let net: f64 = self.world.floorplan.rooms.iter().map(|r| r.net_polygon.area()).sum();
        let found = Finding::measure(asked.area_m2, net, FLOOR_MISS, ("m2", "the floor is"));
        let kept = match asked.bound {
            Bound::AtLeast => net >= asked.area_m2,
            Bound::AtMost => net <= asked.area_m2,
            Bound::Exactly | Bound::About => return found,
        };
        if kept { Finding { fate: Fate::Honored, reason: String::new(), ..found } } else { found }
    }

    /// How a building stands among others follows from its kind: houses in a row have walls of their neighbors, flats lie in a house.
    /// A unit of one storey is one within a house too.
    pub(super) fn site(&self, asked: &SiteAsk) -> Finding {
        let graph = &self.world.scene_graph;
        let level = graph.rooms.first().map(|r| r.level);
        let on_one_storey = graph.rooms.iter().all(|r| Some(r.level) == level);
        let kind = graph.building_type.as_deref().and_then(|id| self.domain.building_type(id));
        let attached = kind.and_then(|b| b.attached);
        let (kept, reason) = match asked.kind {
            SiteKind::Inside => {
                (on_one_storey || attached == Some(Attached::Flat), "the building has a house of its own")
            }
            SiteKind::Terraced => (attached == Some(Attached::Row), "no wall of it is a neighbor's"),
            SiteKind::FreeStanding => (attached.is_none(), "it is built wall to wall with neighbors"),
            SiteKind::SemiDetached => (false, "no plan has a neighbor at one side only"),
            SiteKind::Corner => (false, "no plan has neighbors at two sides that meet"),
        };
        Finding::when(kept, Vec::new(), || reason.into())
    }

    pub(super) fn style(&self, asked: &StyleAsk) -> Finding {
        let style = &self.world.scene_graph.style;
        let label = asked.word.replace('_', " ");
        match StyleWord::of(&asked.word) {
            Some(word) => {
                let mut wished = Style::default();
                wished.add(word);
                let courts = || !courts::between(&self.world.floorplan.rooms).is_empty();
                let kept = wished.or(*style) == *style && (word != COURTYARD || courts());
                Finding::when(kept, Vec::new(), || format!("the building is not planned {label}"))
            }
            None => Finding::of(Fate::LeftOut, format!("no stage here makes a building {label}")),
        }
    }

    /// The rooms that are named, or the building with one toilet at least, are made for somebody in a wheelchair.
    pub(super) fn accessible(&self, ask: &Ask, asked: &AccessAsk) -> Finding {
        let Some(room) = &asked.room else {
            let wet = Wet::of(self.domain);
            let is_toilet =
                |r: &&GraphRoom| self.domain.room_type_or_lent(&r.room_type).is_some_and(|k| wet.has_toilet(k));
            let graph = &self.world.scene_graph;
            let toilets: Vec<&GraphRoom> = graph.rooms.iter().filter(is_toilet).collect();
            let own = toilets.is_empty() || toilets.iter().any(|r| self.is_accessible(r));
            let planned = Finding::when(graph.accessible, Vec::new(), || "the plan is not made for wheelchairs".into());
            return planned
                .and(Finding::when(own, Vec::new(), || "no toilet is made for wheelchairs".into()).or_near());
        };
        let rooms = self.rooms_meant(ask, room);
        let not: Vec<&GraphRoom> = rooms.iter().filter(|r| !self.is_accessible(r)).copied().collect();
        let reason = || match rooms.len() {
            0 => format!("there is no room `{}`", room.name),
            _ => format!("not made for wheelchairs: {}", names_of(&not)),
        };
        Finding::when(not.is_empty() && !rooms.is_empty(), ids_of(&rooms), reason)
    }

    pub(super) fn forbidden(&self, ask: &Ask, asked: &ForbiddenAsk) -> Finding {
        let mut ids: Vec<String> = Vec::new();
        let mut names: Vec<String> = Vec::new();
        if let Some(room) = &asked.room {
            // "no private offices, 30 desks in the open plan"
            let wanted = self.named_elsewhere(room);
            let found = self.rooms_called(room);
            let found: Vec<&GraphRoom> = found.into_iter().filter(|r| !wanted.contains(r.room_type.as_str())).collect();
            ids.extend(ids_of(&found));
            names.extend(found.iter().map(|r| r.name.clone()));
        }
        if let Some(object) = &asked.object {
            let rooms = asked.within.as_ref().map(|w| self.rooms_meant(ask, w));
            let within = |id: &str| rooms.as_ref().is_none_or(|rooms| rooms.iter().any(|r| r.id == id));
            let found = self.objects_called(object);
            for placement in found.iter().filter(|p| within(&p.room_id)) {
                ids.push(placement.placement_id.clone());
                names.push(format!("{} in {}", self.label_of(&placement.object), self.name_of(&placement.room_id)));
            }
        }
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        Finding::when(ids.is_empty(), ids, || format!("there is {}", listed(&names)))
    }

    /// Returns how many rooms there are as people count those of such a building: those to sleep in of a hotel.
    fn rooms_counted(&self, rooms: &[&GraphRoom]) -> u32 {
        let kind = self.world.scene_graph.building_type.as_deref();
        let kind = kind.and_then(|id| self.domain.building_type(id));
        let counted = kind.and_then(|b| self.domain.program(&b.program)).and_then(|p| p.means.get(GENERIC_ROOM_TYPE));
        rooms.iter().filter(|r| counted.is_none_or(|id| r.room_type.starts_with(id.as_str()))).count() as u32
    }

    pub(super) fn only(&self, asked: &OnlyAsk) -> Finding {
        let rooms: Vec<&GraphRoom> = self.world.scene_graph.rooms.iter().filter(|r| !r.circulation).collect();
        let counted = match asked.rooms {
            Some(n) => {
                let there = self.rooms_counted(&rooms);
                Finding::number(AskedCount::exactly(n), there, || format!("{n} rooms asked for, {there} built"))
            }
            None => Finding::honored(Vec::new()),
        };
        let added: Vec<&GraphRoom> = rooms.iter().filter(|r| asked.closed && !r.requested).copied().collect();
        let reason = || format!("added beside: {}", names_of(&added));
        counted.and(Finding::when(added.is_empty(), ids_of(&added), reason).or_near())
    }
}
