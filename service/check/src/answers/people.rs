//! The people of a building: whether it has for so many what they are there for.

use d3dgen_model::brief::{AskedCount, Fact, PeopleAsk};
use d3dgen_model::report::Fate;
use d3dgen_model::scene_graph::GraphRoom;

use super::places::{Seat, desks, guest_seats, is_sat_in, seats_of, sleepers};
use super::{Asked, Finding};

impl Asked<'_> {
    /// Returns whether the building has for so many people what it was planned to have for them: beds for who lives or is nursed there,
    /// desks for who works, seats for who visits.
    pub(super) fn people(&self, asked: &PeopleAsk) -> Finding {
        let (what, n) = self.offered(asked);
        let role = asked.role.replace('_', " ");
        let reason = || match n {
            0 => format!("there are no {what} for {role}s"),
            n => format!("{n} {what} for {} {role}s", asked.count),
        };
        let found = Finding::number(AskedCount::at_least(asked.count.n), n, reason);
        if found.fate == Fate::Honored && !self.is_planned_for(asked.count.n) {
            let reason = format!("the building was planned for other numbers of people; it has {n} {what}");
            return Finding { fate: Fate::Substituted, reason, ..found };
        }
        found
    }

    /// Returns what the building offers to such people, and how many of it.
    fn offered(&self, asked: &PeopleAsk) -> (&'static str, u32) {
        let rooms: Vec<&GraphRoom> = self.world.scene_graph.rooms.iter().collect();
        let count = |each: fn(&Seat<'_>) -> u32| self.held(each, &rooms).places;
        let occupancy = &self.world.scene_graph.occupancy;
        let is_of = |told: Option<u32>| told.is_some_and(|n| n == asked.count.n || n == self.told_together());
        let work_places = || match count(desks) {
            0 => ("seats", count(seats_of)),
            n => ("work places", n),
        };
        let beds = count(sleepers);
        if is_of(occupancy.residents) || is_of(occupancy.beds) {
            return ("places to sleep", beds);
        }
        if is_of(occupancy.staff) || is_of(occupancy.desks) {
            return work_places();
        }
        if is_of(occupancy.visitors) {
            let sat_in = |r: &&GraphRoom| {
                self.domain.room_type_or_lent(&r.room_type).is_some_and(|kind| is_sat_in(self.domain, kind))
            };
            let seats = self.held(guest_seats, &rooms.iter().copied().filter(sat_in).collect::<Vec<_>>()).places;
            return ("seats", seats.max(beds));
        }
        if beds > 0 { ("places to sleep", beds) } else { work_places() }
    }

    /// Returns true for a number of people that the scene graph has, alone or together with those of other facts.
    fn is_planned_for(&self, n: u32) -> bool {
        let occupancy = &self.world.scene_graph.occupancy;
        let told = [occupancy.staff, occupancy.beds, occupancy.desks, occupancy.visitors, occupancy.residents];
        told.iter().flatten().any(|told| *told == n || *told == self.told_together())
            || told.iter().all(Option::is_none) && self.told_together() == n
    }

    /// Returns how many people all facts about people have together.
    fn told_together(&self) -> u32 {
        let people = |fact: &Fact| if let Fact::People(people) = fact { people.count.n } else { 0 };
        self.brief.asks.iter().fold(0, |sum, ask| sum.saturating_add(people(&ask.fact)))
    }
}
