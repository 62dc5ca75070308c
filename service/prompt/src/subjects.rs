//! Rooms and objects that words name: which of their senses the building at hand knows.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;
use std::sync::LazyLock;

use d3dgen_language::{Reading, fold};
use d3dgen_model::brief::Subject;
use d3dgen_model::domain::{Domain, GENERIC_ROOM_TYPE, Program};
use d3dgen_model::offer::furniture;
use d3dgen_plugins::Registry;
use serde::Deserialize;

use crate::likely;
use crate::node::Node;

/// Id of the way into the building, as words have it.
const ENTRANCE: &str = "entrance";

/// What prompts mean beside what words say, from `facts.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FactsData {
    /// What half a room of a type is.
    halves: BTreeMap<String, Vec<String>>,
    /// Domain whose rooms those of a building are that no domain knows.
    stand_in: String,
    /// Kinds of homes that lie within one storey of a house.
    pub within_a_storey: Vec<String>,
    /// Rooms that a list of all rooms of a home names.
    pub lists: Vec<String>,
    /// Rooms that the figure in a home's name counts, by the room that it is read as.
    pub counted: BTreeMap<String, Vec<String>>,
}

pub(crate) fn facts_data() -> &'static FactsData {
    static DATA: LazyLock<FactsData> =
        LazyLock::new(|| toml::from_str(include_str!("facts.toml")).expect("a test reads facts.toml"));
    &DATA
}

/// What a building knows.
#[derive(Clone, Default)]
pub(crate) struct Known<'d> {
    pub rooms: BTreeSet<String>,
    pub objects: BTreeSet<String>,
    /// What such a building has.
    program: Option<&'d Program>,
    domain: Option<&'d Domain>,
    registry: Option<&'d Registry>,
    /// Names of rooms of which only a part told the type, with that type.
    pub told_by_a_part: Rc<RefCell<BTreeMap<String, String>>>,
}

impl<'d> Known<'d> {
    /// Returns what a domain and a kind of building in it know; nothing for a building that no domain knows.
    pub fn of(registry: &'d Registry, domain: Option<&str>, building_type: Option<&str>) -> Self {
        let Some(plugin) = domain.and_then(|d| registry.get(d)) else { return Self::default() };
        let kind = building_type.and_then(|id| plugin.domain().building_type(id));
        let program = kind.and_then(|b| plugin.domain().program(&b.program));
        Self {
            program,
            rooms: plugin.domain().room_types.iter().map(|r| r.id.clone()).collect(),
            objects: plugin.domain().objects.iter().map(|o| o.id.clone()).collect(),
            domain: Some(plugin.domain()),
            registry: Some(registry),
            ..Self::default()
        }
    }

    /// Returns what a building is planned as that no domain knows.
    pub fn stand_in() -> &'static str {
        &facts_data().stand_in
    }

    /// Returns what half a room of a type is, where such are counted in halves.
    pub fn half_of(&self, id: &str) -> Option<String> {
        let half = &facts_data().halves.get(id)?;
        half.iter().find(|h| self.rooms.contains(*h)).or(half.first()).cloned()
    }

    /// Returns the room that a kind of building is there for, where this one knows it too: a restaurant's is to eat in.
    pub fn main_room(&self, kind: &Node) -> Option<String> {
        let types = self.registry?.iter().flat_map(|p| p.domain().building_types.iter().map(move |b| (p.domain(), b)));
        let named = |id: &str| kind.values("kind").any(|v| v == id || v.split_once(':').is_some_and(|(_, v)| v == id));
        let programs = types.filter(|(_, b)| named(&b.id)).filter_map(|(domain, b)| domain.program(&b.program));
        let mut rooms = programs.filter_map(|p| p.rooms.first()).map(|entry| &entry.room_type);
        rooms.find(|id| self.rooms.contains(*id)).cloned()
    }

    /// Returns the sense of a node that the building knows, or else its first one.
    fn sense<'n>(&self, node: &'n Node, class: &'n str) -> Option<&'n str> {
        let known = if class == "room" { &self.rooms } else { &self.objects };
        // of those that the building knows, the one that is called so
        let named = |v: &&str| node.text.contains(&v.replace('_', " "));
        let fits = || node.values(class).filter(|v| known.contains(*v));
        // the building's own word for it before that of other buildings: "1인실" is an office elsewhere
        let own = |v: &&str| fits().nth(1).is_some() && self.has_word(class, v, &node.text);
        // "кабинет" of a practice is to treat in, of an office to work in
        let usual =
            |v: &&str| class == "room" && self.program.is_some_and(|p| p.rooms.iter().any(|e| e.room_type == **v));
        let first = || fits().next().or_else(|| node.values(class).next());
        fits().find(named).or_else(|| fits().find(own)).or_else(|| fits().find(usual)).or_else(first)
    }

    /// Returns true where the building's own domain has a word for a room or object.
    fn has_word(&self, class: &str, id: &str, word: &str) -> bool {
        let words = self.domain.and_then(|d| match class {
            "room" => d.room_type(id).map(|r| &r.keywords),
            _ => d.object(id).map(|o| &o.keywords),
        });
        words.is_some_and(|w| w.values().flatten().any(|w| fold(w) == word))
    }

    /// Returns the object that a word names and a room is furnished with: the bikes of a spinning studio are no places to park.
    pub fn thing_of(&self, room: &Subject, word: &Node) -> Option<String> {
        let domain = self.domain?;
        let kind = domain.room_type(room.id.as_deref()?)?;
        word.values("object").find(|id| furniture(domain, kind).any(|own| own == *id)).map(str::to_owned)
    }

    /// Returns the room that a mere "room" or "hall" is in such a building, or the one that it is there for.
    pub fn of_kind(&self) -> Option<&str> {
        let first = || self.program?.rooms.first().map(|entry| &entry.room_type);
        self.program?.means.get(GENERIC_ROOM_TYPE).or_else(first).map(String::as_str)
    }

    /// Returns the object that a word names beside the room which has several of it: the tills of a checkout.
    pub fn station_of(&self, node: &Node) -> Option<String> {
        let kind = self.domain?.room_type(self.sense(node, "room")?)?;
        let line = kind.furnishing.first().filter(|line| line.required && line.max > 1)?;
        let station = &self.domain?.anchor(&line.item)?.id;
        node.values("object").any(|id| id == station).then(|| station.clone())
    }

    /// Returns the room or object that a node of the grammar is about: a field of that class, or words of the prompt's own. With a
    /// word beside it that nobody knows, a room of another trade is one of its own name: no brewery's "cella fredda" is a prison's.
    pub fn subject(&self, node: &Node, class: &str, reading: &Reading) -> Subject {
        let own: Vec<&Node> = node.all("own").map(|n| &**n).collect();
        let named = node.field(class);
        let id = named.and_then(|n| self.sense(n, class)).map(str::to_owned);
        let ends = own.iter().map(|n| n.tokens.clone()).chain(named.map(|n| n.tokens.clone()));
        let span = ends.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end));
        let name = span.map_or("", |s| reading.written(s)).to_owned();
        let strange = class == "room" && own.iter().any(|n| n.is_unknown());
        let id = id.filter(|id| !strange || self.rooms.is_empty() || self.rooms.contains(id));
        let told = || likely::room_called(&name, id.as_deref(), reading.languages(), |room| self.rooms.contains(room));
        // "home office", "chambre d'amis": the building's own name for it
        let whole = own.is_empty() && id.as_ref().is_some_and(|id| self.rooms.contains(id));
        let Some(likely) = (class == "room" && !whole).then(told).flatten() else {
            // "viewing gallery": called so, and furnished as what its noun names
            if let Some(lent) = id.clone().filter(|_| strange) {
                self.told_by_a_part.borrow_mut().insert(name.clone(), lent);
            }
            return Subject { id, name };
        };
        self.told_by_a_part.borrow_mut().insert(name.clone(), likely.to_owned());
        Subject::known(likely, &name)
    }

    /// Returns the object that a node of the grammar is about; what only some domains have is told by its words where this one has not.
    pub fn object(&self, node: &Node, reading: &Reading) -> Subject {
        let mut object = self.subject(node, "object", reading);
        let own = node.all("own").flat_map(|n| n.values("unbuilt")).find(|id| self.objects.contains(*id));
        object.id = object.id.or_else(|| own.map(str::to_owned));
        object
    }

    /// Takes the sense of a room from a word that names one of other buildings only, and an object of this one: the screens of an
    /// office, the wardrobe of a flat.
    pub fn as_meant(&self, node: Rc<Node>) -> Rc<Node> {
        let known = |class, of: &BTreeSet<String>| node.values(class).any(|v| of.contains(v));
        let elsewhere = !self.rooms.is_empty() && node.is("room", None) && !known("room", &self.rooms);
        if !elsewhere || !known("object", &self.objects) || node.is("attribute", None) {
            return node;
        }
        let mut node = (*node).clone();
        node.senses.retain(|(class, _)| **class != *"room");
        Rc::new(node)
    }

    /// Returns the object that places are: desks, beds.
    fn places(&self, node: &Node, reading: &Reading) -> Subject {
        let id =
            node.field("what").into_iter().flat_map(|w| w.values("capacity")).find(|id| self.objects.contains(*id));
        Subject { id: id.map(str::to_owned), name: reading.written(node.tokens.clone()).to_owned() }
    }

    /// Takes an object for so many people: the one of its kind that is made for them, else it is said of it.
    pub fn size_for(&self, object: &mut Subject, people: u32, attributes: &mut Vec<String>) {
        let family = object.id.as_deref().map(|id| id.trim_end_matches(|c: char| c.is_ascii_digit()));
        let sized = family.map(|f| format!("{}_{people}", f.trim_end_matches('_')));
        match sized.filter(|id| self.objects.contains(id)) {
            Some(id) => object.id = Some(id),
            None => attributes.push(format!("for_{people}")),
        }
    }

    /// Returns the room or object of a node, whichever it is about.
    pub fn any(&self, node: &Node, reading: &Reading) -> Subject {
        match node.made() {
            Some("objects") => self.object(node, reading),
            Some("rooms") => self.subject(node, "room", reading),
            Some("capacity") => self.places(node, reading),
            _ if node.is("thing", Some(ENTRANCE)) || node.made() == Some("by_entrance") => {
                Subject::known(ENTRANCE, reading.written(node.tokens.clone()))
            }
            _ => Subject::unknown(reading.written(node.tokens.clone())),
        }
    }
}
