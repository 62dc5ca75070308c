//! Places for people, vehicles and animals, and the people themselves: counted by what stands in the finished world.

use d3dgen_model::brief::{AskedCount, CapacityAsk, PeopleAsk, PlaceKind};
use d3dgen_model::domain::Shape;
use d3dgen_model::measures::BED_FOR_TWO_M;
use d3dgen_model::offer::seats_across;
use d3dgen_model::placements::Placement;
use d3dgen_model::report::Fate;
use d3dgen_model::scene_graph::GraphRoom;

use super::{Asked, Finding};

/// Width of a place on a sofa, m.
const SOFA_SEAT_M: f64 = 0.65;

/// Returns what people call such places.
fn label(kind: PlaceKind) -> &'static str {
    match kind {
        PlaceKind::Seats => "seats",
        PlaceKind::Desks => "desks",
        PlaceKind::Beds => "beds",
        PlaceKind::Cars => "places for cars",
        PlaceKind::Bicycles => "places for bicycles",
        PlaceKind::Docks => "loading docks",
        PlaceKind::Animals => "places for animals",
        PlaceKind::Counters => "counters",
        PlaceKind::Treatment => "places to be treated at",
        PlaceKind::Pallets => "places for pallets",
    }
}

impl<'a> Asked<'a> {
    pub(super) fn capacity(&self, asked: &CapacityAsk) -> Finding {
        let Some(room) = &asked.room else {
            return self.places(asked, |_| true);
        };
        let rooms = self.rooms_called(room).rooms;
        if rooms.is_empty() {
            return Finding::of(Fate::LeftOut, format!("there is no {}", room.label()));
        }
        if !asked.each_room {
            return self.places(asked, |id| rooms.iter().any(|r| r.id == id));
        }
        let holds = |r: &&&GraphRoom| self.held(asked.of, |id| id == r.id).is_some_and(|n| asked.count.allows(n.0));
        let n = rooms.iter().filter(holds).count() as u32;
        let what = format!("{} with {} {} each", room.label(), asked.count, label(asked.of));
        Finding::number(AskedCount::at_least(rooms.len() as u32), n, &what)
    }

    fn places(&self, asked: &CapacityAsk, within: impl Fn(&str) -> bool) -> Finding {
        match self.held(asked.of, within) {
            Some((n, ids)) => Finding { ids, ..Finding::number(asked.count, n, label(asked.of)) },
            None => Finding::of(Fate::LeftOut, format!("no document counts {}", label(asked.of))),
        }
    }

    /// Returns how many places of a kind rooms hold, and the ids of what holds them; `None` for kinds that nothing here counts.
    fn held(&self, kind: PlaceKind, within: impl Fn(&str) -> bool) -> Option<(u32, Vec<String>)> {
        let each: fn(&Placement, Shape) -> u32 = match kind {
            PlaceKind::Seats => seats,
            PlaceKind::Desks => |_, shape| u32::from(shape == Shape::Desk),
            PlaceKind::Beds => |_, shape| u32::from(matches!(shape, Shape::Bed | Shape::HospitalBed)),
            PlaceKind::Cars => |_, shape| u32::from(shape == Shape::Vehicle),
            PlaceKind::Counters => |_, shape| u32::from(shape == Shape::Counter),
            PlaceKind::Treatment => return self.treated(within),
            PlaceKind::Bicycles | PlaceKind::Docks | PlaceKind::Animals | PlaceKind::Pallets => return None,
        };
        let shape = |p: &Placement| self.domain.object(&p.object).map(|o| o.shape);
        let inside = self.world.placements.placements.iter().filter(|p| within(&p.room_id));
        let holding = inside.filter_map(|p| Some((p, each(p, shape(p)?)))).filter(|(_, n)| *n > 0);
        let (mut total, mut ids) = (0, Vec::new());
        for (placement, n) in holding {
            total += n;
            ids.push(placement.placement_id.clone());
        }
        Some((total, ids))
    }

    /// Returns how many places to lie or sit at while treated there are: what one lies on that is no bed to sleep in.
    fn treated(&self, within: impl Fn(&str) -> bool) -> Option<(u32, Vec<String>)> {
        let lies = |p: &&Placement| {
            self.domain
                .object(&p.object)
                .is_some_and(|o| o.shape != Shape::Bed && o.affordances.iter().any(|a| a == "lie"))
        };
        let found = self.world.placements.placements.iter().filter(|p| within(&p.room_id)).filter(lies);
        let ids: Vec<String> = found.map(|p| p.placement_id.clone()).collect();
        Some((ids.len() as u32, ids))
    }

    /// Returns whether the building is for so many people: counted so by the scene graph, with a place for each to sleep,
    /// work or sit at.
    pub(super) fn people(&self, asked: &PeopleAsk) -> Finding {
        let occupancy = &self.world.scene_graph.occupancy;
        let counted = [occupancy.staff, occupancy.beds, occupancy.desks, occupancy.visitors, occupancy.residents];
        let everywhere = |kind| self.held(kind, |_| true).map_or(0, |h| h.0);
        let places = [self.sleepers(), everywhere(PlaceKind::Desks), everywhere(PlaceKind::Seats)];
        let most = places.into_iter().max().unwrap_or(0);
        let what = format!("places for {}", asked.role.replace('_', " "));
        let found = Finding::number(AskedCount::at_least(asked.count.n), most, &what);
        if found.fate == Fate::Honored || !counted.contains(&Some(asked.count.n)) {
            return found;
        }
        Finding { fate: Fate::Substituted, ..found }
    }

    fn sleepers(&self) -> u32 {
        let beds = self.world.placements.placements.iter().filter(|p| {
            self.domain.object(&p.object).is_some_and(|o| matches!(o.shape, Shape::Bed | Shape::HospitalBed))
        });
        beds.map(|p| if p.size_m[0] >= BED_FOR_TWO_M { 2 } else { 1 }).sum()
    }
}

/// Returns how many sit on an object.
fn seats(placement: &Placement, shape: Shape) -> u32 {
    let width_m = placement.size_m[0];
    match shape {
        Shape::Sofa => ((width_m / SOFA_SEAT_M) as u32).max(1),
        other => seats_across(other, width_m),
    }
}
