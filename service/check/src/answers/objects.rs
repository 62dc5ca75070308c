//! Objects: in the rooms that they were asked for in, in each of them where that is said, and as they were said to be.

use d3dgen_model::brief::{Ask, AskedCount, ObjectsAsk};
use d3dgen_model::placements::Placement;
use d3dgen_model::scene_graph::GraphRoom;

use super::claims::has_word;
use super::rooms::storey_name;
use super::{Asked, Finding, listed, names_of};

/// Where objects are asked for.
struct Place<'a> {
    rooms: Vec<&'a GraphRoom>,
    /// True where a room is named, and not only the building or a storey.
    named: bool,
    /// What people call it: `in Kitchen`.
    name: String,
}

impl Place<'_> {
    fn has(&self, placement: &Placement) -> bool {
        self.rooms.iter().any(|r| r.id == placement.room_id)
    }
}

impl<'a> Asked<'a> {
    pub(super) fn objects(&self, ask: &Ask, asked: &ObjectsAsk) -> Finding {
        let place = self.place_of(ask, asked);
        let all = self.objects_called(&asked.object);
        let there: Vec<&Placement> = all.iter().copied().filter(|p| place.has(p)).collect();
        if there.is_empty() {
            return self.no_objects(asked, &place, &all);
        }
        let so: Vec<&Placement> =
            there.iter().copied().filter(|p| asked.attributes.iter().all(|a| self.is_so(a, p))).collect();
        let each = place.named && place.rooms.len() > 1 && (asked.each_room || asked.count == AskedCount::default());
        let found = if each { self.in_each(asked, &place, &so) } else { of_all(asked, &place, &so) };
        let found = if so.is_empty() {
            let words: Vec<String> = asked.attributes.iter().map(|a| a.replace('_', " ")).collect();
            let reason = format!("none {} is known to be {}", place.name, words.join(" and "));
            Finding { reason, ..found.with(ids_of(&there)) }.or_near()
        } else {
            found
        };
        found.and(self.room_instead(asked, &there))
    }

    fn place_of(&self, ask: &Ask, asked: &ObjectsAsk) -> Place<'a> {
        if let Some(room) = &asked.room {
            let rooms = self.rooms_meant(ask, room);
            return Place { name: format!("in {}", names_of(&rooms)), named: true, rooms };
        }
        let level = self.level_of(ask);
        let rooms = self.world.scene_graph.rooms.iter().filter(|r| level.is_none_or(|l| r.level == l)).collect();
        let name = level.map_or_else(|| "in the building".to_owned(), |l| format!("on {}", storey_name(l)));
        Place { rooms, named: false, name }
    }

    /// Answers for objects of which none is where they were asked for, with what is there or elsewhere instead.
    fn no_objects(&self, asked: &ObjectsAsk, place: &Place, all: &[&Placement]) -> Finding {
        let lacking = match &asked.room {
            Some(room) if place.rooms.is_empty() => format!("there is no room `{}`", room.name),
            _ => format!("none {}", place.name),
        };
        let none = Finding::number(asked.count, 0, String::new);
        if let Some(other) = all.first() {
            let reason = format!("{lacking}; it stands in {}", self.name_of(&other.room_id));
            return Finding { reason, ..none.with(ids_of(all)) }.or_near();
        }
        let like = self.like(asked, place);
        match like.first() {
            Some(other) => {
                let reason = format!("{lacking}; what stands there is {}", self.label_of(&other.object));
                Finding { reason, ..none.with(ids_of(&like)) }.or_near()
            }
            None => Finding { reason: lacking, ..none },
        }
    }

    /// Returns the objects of another kind that stand where one was asked for: a single bed in the place of a double one, a sofa in
    /// that of a sofa bed.
    fn like(&self, asked: &ObjectsAsk, place: &Place) -> Vec<&'a Placement> {
        let Some(id) = asked.object.id.as_deref() else { return Vec::new() };
        let of_it = |other: &str| other.strip_prefix(id).is_some_and(|rest| rest.starts_with('_'));
        let instead = |other: &str| head_of(other) == head_of(id) || id.split('_').any(|part| part == other);
        let is_like = |other: &str| of_it(other) || place.named && instead(other);
        let placements = self.world.placements.placements.iter();
        placements.filter(|p| place.has(p) && is_like(&p.object)).collect()
    }

    /// Counts the rooms that have as many as each of them is to have.
    fn in_each(&self, asked: &ObjectsAsk, place: &Place, so: &[&Placement]) -> Finding {
        let held = |r: &GraphRoom| so.iter().filter(|p| p.room_id == r.id).count() as u32;
        let lacking: Vec<&GraphRoom> = place.rooms.iter().filter(|r| !asked.count.allows(held(r))).copied().collect();
        let n = place.rooms.len() - lacking.len();
        let reason = || match asked.count.n {
            1 => format!("{n} of {} rooms have one: not so {}", place.rooms.len(), names_of(&lacking)),
            each => format!("{n} of {} rooms have {each} each: not so {}", place.rooms.len(), names_of(&lacking)),
        };
        let found = Finding::number(AskedCount::at_least(place.rooms.len() as u32), n as u32, reason);
        found.or_near().with(ids_of(so))
    }

    /// Returns the rooms of that name that an object became, which nobody asked for: a bar beside the kitchen is no bar in it.
    fn room_instead(&self, asked: &ObjectsAsk, there: &[&Placement]) -> Finding {
        let own = |p: &&Placement| {
            let room = self.world.scene_graph.room(&p.room_id)?;
            let kind = self.domain.room_type_or_lent(&room.room_type)?;
            let became =
                room.requested && !self.claims.is_taken(&room.id) && has_word(&kind.keywords, &asked.object.name);
            became.then_some(room.name.as_str())
        };
        let rooms: Vec<&str> = there.iter().map_while(own).collect();
        let reason = || format!("a room of its own was planned for it: {}", listed(&rooms[..1]));
        Finding::when(asked.room.is_some() || rooms.len() < there.len(), Vec::new(), reason).or_near()
    }
}

/// Counts objects of a building, a storey or a room. Of a building the number may be that of one of its rooms: 24 racks in the data hall,
/// and one more in the control room.
fn of_all(asked: &ObjectsAsk, place: &Place, so: &[&Placement]) -> Finding {
    let in_room = |r: &&GraphRoom| so.iter().copied().filter(|p| p.room_id == r.id).collect::<Vec<_>>();
    let of_rooms = || place.rooms.iter().map(in_room).find(|own| asked.count.allows(own.len() as u32));
    let counted = match asked.count.allows(so.len() as u32) || place.named {
        true => so.to_vec(),
        false => of_rooms().unwrap_or_else(|| so.to_vec()),
    };
    let n = counted.len() as u32;
    Finding::number(asked.count, n, || format!("{} asked for, {n} {}", asked.count, place.name)).with(ids_of(&counted))
}

/// Returns the word of an id that says what it is: `table` of `dining_table_8`.
fn head_of(id: &str) -> &str {
    id.rsplit('_').find(|part| part.chars().any(char::is_alphabetic)).unwrap_or(id)
}

fn ids_of(placements: &[&Placement]) -> Vec<String> {
    placements.iter().map(|p| p.placement_id.clone()).collect()
}
