//! Facts about the building as a whole: storeys, floor, robots, manner, what is ruled out.

use d3dgen_model::brief::{
    AccessAsk, AreaAsk, AskedCount, Bound, ForbiddenAsk, OnlyAsk, RobotsAsk, SiteAsk, SiteKind, StoreysAsk, StyleAsk,
    Subject,
};
use d3dgen_model::domain::GENERIC_ROOM_TYPE;
use d3dgen_model::report::Fate;
use d3dgen_model::scene_graph::{GraphRoom, Robot};
use d3dgen_model::style::{Style, StyleWord};

use super::{Asked, Finding};

/// Share by which the floor of a building may miss what was asked for: walls and corridors take what they need.
const FLOOR_MISS: f64 = 0.15;

impl Asked<'_> {
    pub(super) fn storeys(&self, asked: &StoreysAsk) -> Finding {
        let mut levels: Vec<i32> = self.world.scene_graph.rooms.iter().map(|r| r.level).collect();
        levels.sort_unstable();
        levels.dedup();
        let counted = Finding::number(asked.count, levels.len() as u32, "storeys");
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

    pub(super) fn robots(&self, asked: &RobotsAsk) -> Finding {
        let robots = &self.world.scene_graph.robots;
        let kind = |r: &&Robot| asked.kind.is_empty() || r.kind == asked.kind;
        let of_kind: Vec<&Robot> = robots.iter().filter(kind).collect();
        let count = of_kind.iter().map(|r| r.count).sum();
        let mut out = Finding::number(asked.count, count, &format!("{} robots", asked.kind));
        if of_kind.is_empty() && !robots.is_empty() {
            let kinds: Vec<&str> = robots.iter().map(|r| r.kind.as_str()).collect();
            out = Finding::of(Fate::Substituted, format!("the robots are {}", kinds.join(", ")));
        }
        if let Some(width) = asked.width_m
            && let Some(robot) = of_kind.first()
        {
            out = out.and(Finding::measure(width, robot.width_m(), super::MEASURE_MISS, ("m", "its width is")));
        }
        if let Some(misfit) = of_kind.iter().find(|r| r.misfit) {
            out = out.and(Finding::of(Fate::Substituted, format!("the {} robot does not fit everywhere", misfit.kind)));
        }
        let places = asked.tasks.iter().flat_map(|t| t.from.iter().chain(&t.to));
        let lacking: Vec<String> = places.filter(|s| !self.is_visited(s, &of_kind)).map(Subject::label).collect();
        let out = out
            .and(Finding::when(lacking.is_empty(), Vec::new(), || format!("no robot goes to {}", lacking.join(", "))));
        let entered: Vec<String> = asked.keep_out.iter().filter(|s| !self.is_kept_out(s)).map(Subject::label).collect();
        out.and(Finding::when(entered.is_empty(), Vec::new(), || format!("robots may enter {}", entered.join(", "))))
    }

    /// Returns true for rooms that robots go to: by name, or because they go wherever their kind works.
    fn is_visited(&self, subject: &Subject, robots: &[&Robot]) -> bool {
        let mut rooms = self.rooms_called(subject).rooms;
        if rooms.is_empty() {
            let things = self.objects_called(subject).placements;
            let holds = |r: &&GraphRoom| things.iter().any(|p| p.room_id == r.id);
            rooms = self.world.scene_graph.rooms.iter().filter(holds).collect();
        }
        let goes = |room: &GraphRoom| {
            robots.iter().any(|r| {
                let everywhere = r.stops.is_empty() && r.room_types.is_empty();
                everywhere || r.stops.contains(&room.id) || r.room_types.contains(&room.room_type)
            }) && !self.world.scene_graph.keeps_robots_out(&room.id)
        };
        rooms.iter().any(|r| goes(r))
    }

    fn is_kept_out(&self, subject: &Subject) -> bool {
        self.rooms_called(subject).rooms.iter().all(|r| self.world.scene_graph.keeps_robots_out(&r.id))
    }

    /// A unit within a house is one where it has one storey; how a building stands among others changes no plan beside that.
    pub(super) fn site(&self, asked: &SiteAsk) -> Finding {
        let level = self.world.scene_graph.rooms.first().map(|r| r.level);
        let flat = self.world.scene_graph.rooms.iter().all(|r| Some(r.level) == level);
        let reason = || "how a building stands among others changes no plan yet".into();
        Finding::when(asked.kind == SiteKind::Inside && flat, Vec::new(), reason)
    }

    pub(super) fn style(&self, asked: &StyleAsk) -> Finding {
        let style = &self.world.scene_graph.style;
        let label = asked.word.replace('_', " ");
        match StyleWord::of(&asked.word) {
            Some(word) => {
                let mut wished = Style::default();
                wished.add(word);
                let kept = wished.or(*style) == *style;
                Finding::when(kept, Vec::new(), || format!("the building is not planned {label}"))
            }
            None => Finding::of(Fate::LeftOut, format!("no stage here makes a building {label}")),
        }
    }

    pub(super) fn accessible(&self, asked: &AccessAsk) -> Finding {
        let holds = self.world.scene_graph.accessible;
        let rooms = asked.room.as_ref().map(|room| self.rooms_called(room).rooms);
        // an accessible room is a type of its own in many domains
        let own = rooms.iter().flatten().filter(|r| r.room_type.split('_').any(|p| p == "accessible"));
        let ids: Vec<String> = own.map(|r| r.id.clone()).collect();
        Finding::when(holds || !ids.is_empty(), ids, || "the plan is not made for wheelchairs".into())
    }

    pub(super) fn forbidden(&self, asked: &ForbiddenAsk) -> Finding {
        let mut ids: Vec<String> = Vec::new();
        if let Some(room) = &asked.room {
            // "no private offices, 30 desks in the open plan"
            let wanted = self.named_elsewhere(room);
            let found = self.rooms_called(room).rooms;
            ids.extend(found.iter().filter(|r| !wanted.contains(r.room_type.as_str())).map(|r| r.id.clone()));
        }
        if let Some(object) = &asked.object {
            let rooms = asked.within.as_ref().map(|w| self.rooms_called(w).rooms);
            let within = |id: &str| rooms.as_ref().is_none_or(|rooms| rooms.iter().any(|r| r.id == id));
            let found = self.objects_called(object).placements;
            ids.extend(found.iter().filter(|p| within(&p.room_id)).map(|p| p.placement_id.clone()));
        }
        let reason = format!("{} is there", ids.first().map_or("", String::as_str));
        Finding::when(ids.is_empty(), ids, || reason)
    }

    /// Returns how many rooms there are as people count those of such a building: those to sleep in of a hotel.
    fn rooms_counted(&self, rooms: &[&GraphRoom]) -> u32 {
        let kind = self.world.scene_graph.building_type.as_deref();
        let kind = self.domain.building_types.iter().find(|b| Some(b.id.as_str()) == kind);
        let counted = kind.and_then(|b| self.domain.program(&b.program)).and_then(|p| p.means.get(GENERIC_ROOM_TYPE));
        rooms.iter().filter(|r| counted.is_none_or(|id| r.room_type.starts_with(id.as_str()))).count() as u32
    }

    pub(super) fn only(&self, asked: &OnlyAsk) -> Finding {
        let rooms: Vec<&GraphRoom> = self.world.scene_graph.rooms.iter().filter(|r| !r.circulation).collect();
        let counted = match asked.rooms {
            Some(n) => Finding::number(AskedCount::exactly(n), self.rooms_counted(&rooms), "rooms"),
            None => Finding::honored(Vec::new()),
        };
        let added: Vec<String> = rooms.iter().filter(|r| asked.closed && !r.requested).map(|r| r.id.clone()).collect();
        let reason = format!("{} rooms were added", added.len());
        counted.and(Finding {
            fate: if added.is_empty() { Fate::Honored } else { Fate::Substituted },
            ..Finding::when(added.is_empty(), added, || reason)
        })
    }
}
