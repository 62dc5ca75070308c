//! Which rooms and objects of a world are meant by a name of the brief.

use d3dgen_model::brief::Subject;
use d3dgen_model::domain::Words;
use d3dgen_model::floorplan::Door;
use d3dgen_model::placements::Placement;
use d3dgen_model::scene_graph::GraphRoom;

use super::Asked;

/// Id of the way into the building, which is no room: the rooms that one enters it through.
const ENTRANCE: &str = "entrance";

/// What goes by a name.
#[derive(Default)]
pub(super) struct Found<'a> {
    pub rooms: Vec<&'a GraphRoom>,
    pub placements: Vec<&'a Placement>,
}

impl Found<'_> {
    /// Returns the ids of the placements.
    pub fn ids(&self) -> Vec<String> {
        self.placements.iter().map(|p| p.placement_id.clone()).collect()
    }
}

/// Returns a name as ids are written: `Patient Room` is `patient_room`.
fn as_id(name: &str) -> String {
    let id: String = name.to_lowercase().chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
    id.trim_matches('_').to_owned()
}

/// Returns true for an id that is another, or a kind of it: `patient_room_double` and `accessible_toilet` of `patient_room`
/// and `toilet`.
fn is_kind_of(id: &str, of: &str) -> bool {
    id == of
        || id.strip_prefix(of).is_some_and(|r| r.starts_with('_'))
        || id.strip_suffix(of).is_some_and(|r| r.ends_with('_'))
}

/// Returns true when one of the words names it, in any language.
fn has_word(words: &Words, name: &str) -> bool {
    let name = name.to_lowercase();
    words.values().flatten().any(|w| *w == name)
}

impl<'a> Asked<'a> {
    /// Returns the rooms that go by a name: of its type or a kind of it; of a type that has the same word; called so in the plan.
    pub fn rooms_called(&self, subject: &Subject) -> Found<'a> {
        let name = as_id(&subject.name);
        let id = subject.id.as_deref().unwrap_or(&name);
        let is_so = |r: &&GraphRoom| {
            if id == ENTRANCE {
                return r.entrance;
            }
            let worded =
                || self.domain.room_type_or_lent(&r.room_type).is_some_and(|t| has_word(&t.keywords, &subject.name));
            is_kind_of(&r.room_type, id) || worded() || !name.is_empty() && is_kind_of(&as_id(&r.name), &name)
        };
        Found { rooms: self.world.scene_graph.rooms.iter().filter(is_so).collect(), ..Found::default() }
    }

    /// Returns the objects that go by a name, as rooms do.
    pub fn objects_called(&self, subject: &Subject) -> Found<'a> {
        let name = as_id(&subject.name);
        let id = subject.id.as_deref().unwrap_or(&name);
        let is_so = |p: &&Placement| {
            let worded = || self.domain.object(&p.object).is_some_and(|o| has_word(&o.keywords, &subject.name));
            is_kind_of(&p.object, id) || worded()
        };
        Found { placements: self.world.placements.placements.iter().filter(is_so).collect(), ..Found::default() }
    }

    /// Returns true for an object of which its type, model or size tells that it is as an attribute says.
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
                _ => false,
            }
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
}
