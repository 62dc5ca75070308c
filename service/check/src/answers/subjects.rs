//! Which rooms and objects of a world are meant by a name of the brief.

use d3dgen_model::brief::{Ask, Fact, RoomsAsk, Subject};
use d3dgen_model::floorplan::Door;
use d3dgen_model::placements::Placement;
use d3dgen_model::scene_graph::GraphRoom;

use super::Asked;
use super::claims::{Likeness, as_id, has_word, is_kind_of};

/// Attribute of what stands before a window.
pub(super) const AT_WINDOW: &str = "at_window";
/// Floor between a window and what stands at it, at most, m.
const AT_WINDOW_M: f64 = 1.0;

impl<'a> Asked<'a> {
    /// Returns the rooms that go by a name: those that are likest to it where several kinds of rooms are.
    pub fn rooms_called(&self, subject: &Subject) -> Vec<&'a GraphRoom> {
        let rooms = &self.world.scene_graph.rooms;
        let like = |r: &'a GraphRoom| Some((self.kinds.likeness(subject, r)?, r));
        let found: Vec<(Likeness, &GraphRoom)> = rooms.iter().filter_map(like).collect();
        // kinds of a type count with it, but where there are none of its own the likest do
        let own = found.iter().any(|(likeness, _)| *likeness <= Likeness::Type);
        found.into_iter().filter(|(likeness, _)| !own || *likeness <= Likeness::Type).map(|(_, r)| r).collect()
    }

    /// Returns the wishes for rooms that a name of another fact means: of the same name, or else of the same type.
    fn wishes_for(&self, subject: &Subject) -> Vec<(usize, &'a Ask)> {
        let rooms = |(at, ask): (usize, &'a Ask)| match &ask.fact {
            Fact::Rooms(rooms) if !rooms.among => Some((at, ask, rooms)),
            _ => None,
        };
        let all: Vec<(usize, &Ask, &RoomsAsk)> = self.brief.asks.iter().enumerate().filter_map(rooms).collect();
        let named = |r: &RoomsAsk| r.room.name == subject.name && r.room.id == subject.id;
        let typed = |r: &RoomsAsk| subject.id.is_some() && r.room.id == subject.id;
        let by = |is_so: &dyn Fn(&RoomsAsk) -> bool| -> Vec<(usize, &'a Ask)> {
            all.iter().filter(|(_, _, r)| is_so(r)).map(|(at, ask, _)| (*at, *ask)).collect()
        };
        let same = by(&named);
        if same.is_empty() { by(&typed) } else { same }
    }

    /// Returns the rooms that a fact means by a name: those that the wish for rooms of that name became, of several wishes the one whose
    /// words are nearest; else all that go by the name.
    pub fn rooms_meant(&self, ask: &Ask, subject: &Subject) -> Vec<&'a GraphRoom> {
        let start = |ask: &Ask| ask.words.last().map_or(0, |w| w.start);
        let wishes = self.wishes_for(subject);
        let nearest = wishes.iter().min_by_key(|(_, wish)| start(wish).abs_diff(start(ask)));
        nearest.map_or_else(|| self.rooms_called(subject), |(at, _)| self.claims.rooms(*at).to_vec())
    }

    /// Returns all rooms that are meant by a name, whichever wish they became of.
    pub fn all_meant(&self, subject: &Subject) -> Vec<&'a GraphRoom> {
        let wishes = self.wishes_for(subject);
        if wishes.is_empty() {
            return self.rooms_called(subject);
        }
        let mut rooms: Vec<&GraphRoom> = Vec::new();
        for room in wishes.iter().flat_map(|(at, _)| self.claims.rooms(*at)) {
            if !rooms.iter().any(|r| r.id == room.id) {
                rooms.push(room);
            }
        }
        rooms
    }

    /// Returns the objects that go by a name: of its type or a kind of it, or of a type that has the same word.
    pub fn objects_called(&self, subject: &Subject) -> Vec<&'a Placement> {
        let name = as_id(&subject.name);
        let id = subject.id.as_deref().unwrap_or(&name);
        let shape = self.domain.object(id).map(|o| o.shape);
        let is_so = |p: &&Placement| {
            let kind = self.domain.object(&p.object);
            let worded = || kind.is_some_and(|o| has_word(&o.keywords, &subject.name));
            // a stand for a television is none, and a brush of a toilet is none either
            let alike = || shape.is_none() || kind.map(|o| o.shape) == shape;
            p.object == id || is_kind_of(&p.object, id) && alike() || worded()
        };
        self.world.placements.placements.iter().filter(is_so).collect()
    }

    /// Returns true for an object of which its type, model, size or place tells that it is as an attribute says.
    pub fn is_so(&self, attribute: &str, placement: &Placement) -> bool {
        let named = |id: &str| id.split(['_', '/']).any(|part| part.eq_ignore_ascii_case(attribute));
        let sizes = self.domain.object(&placement.object).map_or(&[][..], |o| &o.sizes_m);
        let floor = |s: &[f64; 3]| s[0] * s[1];
        let own = floor(&placement.size_m);
        let usual = sizes.first().map(floor);
        named(&placement.object)
            || named(&placement.asset)
            || match attribute {
                "large" => usual.is_some_and(|usual| own > usual) || sizes.iter().all(|s| floor(s) <= own),
                "small" => usual.is_some_and(|usual| own < usual) || sizes.iter().all(|s| floor(s) >= own),
                AT_WINDOW => self.is_at_window(placement),
                _ => false,
            }
    }

    fn is_at_window(&self, placement: &Placement) -> bool {
        let mut windows = self.world.floorplan.windows.iter().filter(|w| w.room_id == placement.room_id);
        let bounds = placement.footprint().bounds();
        windows.any(|w| w.line.bounds().distance(&bounds) <= AT_WINDOW_M + w.wall_thickness_m / 2.0)
    }

    /// Returns the passages from a room to those that `is_other` takes.
    pub fn doors_between(
        &self,
        room_id: &'a str,
        is_other: impl Fn(&str) -> bool + 'a,
    ) -> impl Iterator<Item = &'a Door> {
        let doors = self.world.floorplan.doors_of(room_id);
        doors.filter(move |d| d.room_ids.iter().any(|id| id != room_id && is_other(id)))
    }

    /// Returns the name on the plan of a room.
    pub fn name_of(&self, room_id: &str) -> &'a str {
        self.world.scene_graph.room(room_id).map_or("another room", |r| r.name.as_str())
    }

    /// Returns what people call an object of a type.
    pub fn label_of(&self, object: &str) -> String {
        self.domain.object(object).map_or_else(|| object.replace('_', " "), |o| o.label.to_lowercase())
    }
}
