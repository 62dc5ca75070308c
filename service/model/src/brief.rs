//! What was asked for: one fact an entry, each with the words that state it, before anything is planned.
//!
//! Anyone may write a brief (the rules that read prompts, a language model, a form, a person). Every fact in it is answered for:
//! the report of the finished world says what became of each (`report::AskAnswer`), and what nobody understood stands in
//! [`Brief::not_understood`]. A brief holds nothing that was not said; what a building of its kind needs beside that is added by
//! the scene graph.
//!
//! ```
//! use d3dgen_model::Document;
//! use d3dgen_model::brief::{Ask, AskedCount, Brief, Fact, PromptWords, RoomsAsk, Subject};
//!
//! let mut brief = Brief::of_prompt("flat with 3 bedrooms");
//! brief.asks.push(Ask {
//!     id: "ask_1".into(),
//!     words: vec![PromptWords::of(&brief.prompt, 10, 20)],
//!     read_by: Default::default(),
//!     fact: Fact::Rooms(RoomsAsk {
//!         room: Subject::known("bedroom", "bedrooms"),
//!         count: AskedCount::exactly(3),
//!         ..RoomsAsk::default()
//!     }),
//! });
//! assert_eq!(brief.asks[0].said(), "3 bedrooms");
//! assert!(Brief::from_json(&brief.to_json()).is_ok());
//! ```

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::{Document, Problem, check_unique};

/// Most facts of one brief.
pub const MAX_ASKS: usize = 1000;

/// What was asked for, fact by fact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Brief {
    /// Format version; 1.
    pub version: u32,
    /// The prompt as given; empty for a brief that no prompt states.
    pub prompt: String,
    /// ISO 639-1 codes of the languages of the prompt, the one with most words first.
    #[serde(default)]
    pub languages: Vec<String>,
    /// Kind of building; absent when nothing names one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub building: Option<AskedBuilding>,
    /// The next best readings of the kind of building, best first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub other_buildings: Vec<AskedBuilding>,
    /// Where it stands, which says whose rules apply.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<AskedPlace>,
    /// The facts, in the order of their words.
    pub asks: Vec<Ask>,
    /// Words that no fact, no kind of building and no place covers, and that are not mere grammar.
    #[serde(default)]
    pub not_understood: Vec<PromptWords>,
}

/// A stretch of the prompt.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PromptWords {
    /// First character, counted from 0 in Unicode code points.
    pub start: u32,
    /// First character behind it.
    pub end: u32,
    /// The characters themselves.
    pub text: String,
}

/// A kind of building.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AskedBuilding {
    /// Domain id; absent for a kind of building that no domain knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub domain: Option<String>,
    /// Building type inside the domain (`ward`, `hotel`), where one is named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub building_type: Option<String>,
    /// What the prompt calls it.
    pub name: String,
    /// How sure the reader is, 0 to 1: 1 for a word that means nothing else.
    pub confidence: f64,
    /// The words that name it; none where rooms alone suggest it.
    #[serde(default)]
    pub words: Vec<PromptWords>,
}

/// A place on earth.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AskedPlace {
    /// ISO 3166-1 alpha-2 code.
    pub country_code: String,
    /// ISO 3166-2 code of the state, province or emirate (`CA-ON`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub division_code: Option<String>,
    /// City as the prompt names it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub city: Option<String>,
    /// The words that name it.
    #[serde(default)]
    pub words: Vec<PromptWords>,
}

/// One fact that is asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ask {
    /// Unique: `ask_3`.
    #[schemars(regex(pattern = "^[a-z0-9_]+$"))]
    pub id: String,
    /// The words that state it, in their order; empty where no prompt does.
    #[serde(default)]
    pub words: Vec<PromptWords>,
    /// Who read it.
    #[serde(default, skip_serializing_if = "ReadBy::is_rules")]
    pub read_by: ReadBy,
    /// The fact.
    pub fact: Fact,
}

/// Who put a fact into a brief.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReadBy {
    /// The rules that read prompts.
    #[default]
    Rules,
    /// A language model alone: its words and numbers stand in the prompt.
    Model,
    /// Rules and language model alike.
    Both,
    /// A person or a form.
    Person,
}

impl ReadBy {
    fn is_rules(&self) -> bool {
        *self == Self::Rules
    }
}

/// What is asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fact {
    /// Rooms of one kind.
    Rooms(RoomsAsk),
    /// Objects of one kind.
    Objects(ObjectsAsk),
    /// Places for people, vehicles or animals.
    Capacity(CapacityAsk),
    /// How two rooms, or a room and the outdoors, lie to each other.
    Relation(RelationAsk),
    /// Storeys of the building.
    Storeys(StoreysAsk),
    /// Floor area of the whole, m^2.
    Area(AreaAsk),
    /// Robots, and what they do.
    Robots(RobotsAsk),
    /// People who live, work or stay there.
    People(PeopleAsk),
    /// The manner of the building.
    Style(StyleAsk),
    /// Wheelchair access throughout.
    Accessible(AccessAsk),
    /// A room or object that must not be there.
    Forbidden(ForbiddenAsk),
    /// The list is all there is to be.
    Only(OnlyAsk),
    /// How it stands among others.
    Site(SiteAsk),
    /// A wish that was understood as one and that nothing else here can hold: it is told, never dropped.
    Other(OtherAsk),
}

/// A room, an object or a part of the outdoors as the prompt names it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Subject {
    /// Room type or object id of the domain; absent for one that only the prompt knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// What the prompt calls it, without number and attributes.
    pub name: String,
}

impl Subject {
    /// Returns one that the domain knows.
    pub fn known(id: &str, name: &str) -> Self {
        Self { id: Some(id.to_owned()), name: name.to_owned() }
    }

    /// Returns one that only the prompt knows.
    pub fn unknown(name: &str) -> Self {
        Self { id: None, name: name.to_owned() }
    }

    /// Returns its id as words, or else what the prompt calls it.
    pub fn label(&self) -> String {
        self.id.as_deref().map_or_else(|| self.name.clone(), |id| id.replace('_', " "))
    }
}

/// A number that is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AskedCount {
    /// The number.
    pub n: u32,
    /// How it binds.
    #[serde(default, skip_serializing_if = "Bound::is_exactly")]
    pub bound: Bound,
}

impl Default for AskedCount {
    fn default() -> Self {
        Self { n: 1, bound: Bound::AtLeast }
    }
}

impl AskedCount {
    /// Returns the count of a plain number: exactly so many.
    pub fn exactly(n: u32) -> Self {
        Self { n, bound: Bound::Exactly }
    }

    /// Returns the count of "at least so many"; of things that are named without a number, 1.
    pub fn at_least(n: u32) -> Self {
        Self { n, bound: Bound::AtLeast }
    }

    /// Returns true when so many are what is asked for. "About" allows a tenth more or less, and 1.
    pub fn allows(&self, found: u32) -> bool {
        match self.bound {
            Bound::Exactly => found == self.n,
            Bound::AtLeast => found >= self.n,
            Bound::AtMost => found <= self.n,
            Bound::About => found.abs_diff(self.n) <= (self.n / 10).max(1),
        }
    }
}

impl fmt::Display for AskedCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.bound {
            Bound::Exactly => write!(f, "{}", self.n),
            Bound::AtLeast => write!(f, "{} or more", self.n),
            Bound::AtMost => write!(f, "{} at most", self.n),
            Bound::About => write!(f, "about {}", self.n),
        }
    }
}

/// How a number binds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// So many, no more and no fewer.
    #[default]
    Exactly,
    /// So many or more.
    AtLeast,
    /// So many or fewer.
    AtMost,
    /// So many, or nearly.
    About,
}

impl Bound {
    fn is_exactly(&self) -> bool {
        *self == Self::Exactly
    }
}

/// Rooms of one kind.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoomsAsk {
    /// What rooms.
    pub room: Subject,
    /// How many.
    #[serde(default)]
    pub count: AskedCount,
    /// Net floor area of each, m^2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area_m2: Option<f64>,
    /// Lengths of the sides of each, m, in the order said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sides_m: Option<[f64; 2]>,
    /// Storey they lie on: 0 at the ground, 1 above it, -1 below it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub level: Option<i32>,
    /// Ids of what is asked of each: `accessible`, `open`, `glazed`, `windowless`, `with_window`, `own_bathroom`, `garden_door`, `large`, ...
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub attributes: Vec<String>,
    /// Room that each one of them comes with: one en suite for each bedroom.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub each: Option<Subject>,
    /// True for rooms that are some of those another fact asks for: "22 rooms, 2 of them accessible".
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub among: bool,
}

/// Objects of one kind.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectsAsk {
    /// What objects.
    pub object: Subject,
    /// How many; in each of the rooms where `each_room` says so.
    #[serde(default)]
    pub count: AskedCount,
    /// Room they stand in, where the prompt says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room: Option<Subject>,
    /// True when every such room has so many.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub each_room: bool,
    /// What is asked of each: `large`, `round`, `double`, ...
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub attributes: Vec<String>,
}

/// Places for people, vehicles or animals.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CapacityAsk {
    /// What the places are.
    pub of: PlaceKind,
    /// How many; in each of the rooms or groups where `each` says so.
    pub count: AskedCount,
    /// Room that has them, where the prompt says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room: Option<Subject>,
    /// True when every such room has so many.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub each_room: bool,
    /// Groups that so many make: "4 groups of 12" has 12 places and 4 groups.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub groups: Option<u32>,
    /// Of how many of such rooms it is said: "three meeting rooms, one for 14"; absent where it is said of all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of_rooms: Option<u32>,
    /// True for places that are some of those another fact asks for: "16 places, 2 of them in isolation rooms".
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub among: bool,
}

/// What places are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PlaceKind {
    /// To sit.
    #[default]
    Seats,
    /// To work at.
    Desks,
    /// To sleep, or to be nursed, in.
    Beds,
    /// For cars.
    Cars,
    /// For bicycles.
    Bicycles,
    /// For trucks at a dock.
    Docks,
    /// For animals.
    Animals,
    /// At tills and counters.
    Counters,
    /// To be treated at: dental chairs, dialysis places.
    Treatment,
    /// Pallets in racks.
    Pallets,
}

/// How two subjects lie to each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelationAsk {
    /// The first: the one that is spoken of.
    pub a: Subject,
    /// How they lie.
    pub relation: RelationKind,
    /// The second: a room, an object, or the outdoors (`garden`, `street`).
    pub b: Subject,
}

/// How two subjects lie to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RelationKind {
    /// A wall in common, or close by.
    NextTo,
    /// A door or opening between them.
    Door,
    /// A wide opening, no door.
    OpenTo,
    /// One enters `a` from `b` and from nowhere else.
    OnlyFrom,
    /// One does not enter `a` from `b`.
    NotFrom,
    /// No wall in common.
    AwayFrom,
    /// From `a` one sees `b`.
    Sees,
    /// `a` has windows, or a door, on the side of `b`.
    Faces,
    /// `a` lies above `b`.
    Above,
    /// `a` lies between two subjects; there is one such fact for each.
    Between,
}

/// Storeys of the building.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StoreysAsk {
    /// How many, the ground among them.
    pub count: AskedCount,
    /// True when a basement is asked for, beside or among them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub basement: bool,
}

/// Floor area of the whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AreaAsk {
    /// Net floor area, m^2.
    pub area_m2: f64,
    /// How it binds.
    #[serde(default, skip_serializing_if = "Bound::is_exactly")]
    pub bound: Bound,
}

/// Robots, and what they do.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotsAsk {
    /// `cleaning`, `disinfection`, `delivery`, `service`, `transport`, `guide`, `patrol`, ...; as the prompt says, snake case.
    pub kind: String,
    /// How many.
    #[serde(default)]
    pub count: AskedCount,
    /// Width, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width_m: Option<f64>,
    /// Length, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length_m: Option<f64>,
    /// Height, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// What it is to do, in the order said.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tasks: Vec<AskedTask>,
    /// Rooms it stays out of.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keep_out: Vec<Subject>,
}

/// One piece of work of a robot.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AskedTask {
    /// What it does: `bring`, `clean`, `inspect`, `patrol`, `guide`, ...
    pub verb: String,
    /// What it carries or looks at, in the prompt's words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub what: Option<String>,
    /// Where from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<Subject>,
    /// Where to, or where it works.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub to: Vec<Subject>,
}

/// People who live, work or stay there.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PeopleAsk {
    /// Who, snake case: `resident`, `child`, `patient`, `doctor`, `lawyer`, `visitor`, `employee`, ...
    pub role: String,
    /// How many.
    #[serde(default)]
    pub count: AskedCount,
}

/// The manner of the building.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StyleAsk {
    /// A word of `style` (`compact`, `l_shaped`, `clutter_high`), or the prompt's own, snake case.
    pub word: String,
}

/// Wheelchair access.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AccessAsk {
    /// The room that is to have it; the whole building when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room: Option<Subject>,
}

/// What must not be there.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ForbiddenAsk {
    /// Room, where it is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room: Option<Subject>,
    /// Object, where it is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<Subject>,
    /// Room that the object must not be in; the whole building when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<Subject>,
}

/// The list is all there is to be.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OnlyAsk {
    /// Rooms in total, circulation aside, where the prompt counts them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rooms: Option<u32>,
    /// True when the rooms listed are all there are; false for a number of rooms alone, which says nothing of their types.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub closed: bool,
}

/// How the building stands among others.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SiteAsk {
    /// How it stands.
    pub kind: SiteKind,
}

/// How a building stands among others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SiteKind {
    /// By itself.
    FreeStanding,
    /// With one neighbor.
    SemiDetached,
    /// In a row, neighbors at two opposite sides.
    Terraced,
    /// At a corner, neighbors at two sides that meet.
    Corner,
    /// One unit of a larger building, with neighbors at some sides.
    Inside,
}

/// A wish that nothing else here can hold.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OtherAsk {
    /// The wish, in the prompt's words.
    pub wish: String,
}

impl Brief {
    /// Returns a brief of which nothing is read yet.
    pub fn of_prompt(prompt: &str) -> Self {
        Self {
            version: 1,
            prompt: prompt.to_owned(),
            languages: Vec::new(),
            building: None,
            other_buildings: Vec::new(),
            place: None,
            asks: Vec::new(),
            not_understood: Vec::new(),
        }
    }
}

impl PromptWords {
    /// Returns a stretch of a prompt by its characters (Unicode code points), cut to the prompt.
    pub fn of(prompt: &str, start: u32, end: u32) -> Self {
        let text = prompt.chars().skip(start as usize).take(end.saturating_sub(start) as usize).collect();
        Self { start, end, text }
    }
}

impl Ask {
    /// Returns its words, joined; what the fact says of itself where no words state it.
    pub fn said(&self) -> String {
        if self.words.is_empty() {
            return serde_json::to_string(&self.fact).unwrap_or_default();
        }
        self.words.iter().map(|w| w.text.as_str()).collect::<Vec<_>>().join(" … ")
    }
}

impl Document for Brief {
    const KIND: &'static str = "brief";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        if self.asks.len() > MAX_ASKS {
            problems.push(Problem::new(
                "/asks",
                format!("has {} facts, one brief has {MAX_ASKS} at most", self.asks.len()),
            ));
        }
        check_unique("/asks", self.asks.iter().map(|a| a.id.as_str()), &mut problems);
        let prompt: Vec<char> = self.prompt.chars().collect();
        let building = self.building.iter().flat_map(|b| &b.words).map(|w| ("/building/words".to_owned(), w));
        let place = self.place.iter().flat_map(|p| &p.words).map(|w| ("/place/words".to_owned(), w));
        let asks = self.asks.iter().enumerate();
        let asked = asks.flat_map(|(i, a)| a.words.iter().map(move |w| (format!("/asks/{i}/words"), w)));
        let unread = self.not_understood.iter().map(|w| ("/not_understood".to_owned(), w));
        for (path, words) in building.chain(place).chain(asked).chain(unread) {
            problems.extend(words.problem(&path, &prompt));
        }
        for (i, ask) in self.asks.iter().enumerate() {
            for (field, value, low, high) in ask.fact.figures() {
                if !(low..=high).contains(&value) {
                    let message = format!("{value} is outside {low} to {high}");
                    problems.push(Problem::new(format!("/asks/{i}/fact/{field}"), message));
                }
            }
        }
        problems
    }
}

impl PromptWords {
    /// Returns what is wrong with a stretch, if anything: it is to quote the prompt.
    fn problem(&self, path: &str, prompt: &[char]) -> Option<Problem> {
        let quoted = prompt.get(self.start as usize..self.end as usize);
        let right = quoted.is_some_and(|q| q.iter().copied().eq(self.text.chars()));
        let message =
            || format!("`{}` does not stand at characters {} to {} of the prompt", self.text, self.start, self.end);
        (!right).then(|| Problem::new(path, message()))
    }
}

/// Least and largest side of a room that can be asked for, m.
const SIDES_M: (f64, f64) = (0.5, 500.0);
/// Least and largest floor area that can be asked for, m^2.
const AREAS_M2: (f64, f64) = (0.5, 1_000_000.0);
/// Least and largest measure of a robot that can be asked for, m.
const ROBOTS_M: (f64, f64) = (0.05, 4.0);

impl Fact {
    /// Returns each measure by its place in the document, with the least and largest that can be meant.
    fn figures(&self) -> Vec<(&'static str, f64, f64, f64)> {
        let within = |(low, high): (f64, f64), field, value: Option<f64>| value.map(|v| (field, v, low, high));
        match self {
            Self::Rooms(rooms) => [
                within(AREAS_M2, "rooms/area_m2", rooms.area_m2),
                within(SIDES_M, "rooms/sides_m/0", rooms.sides_m.map(|s| s[0])),
                within(SIDES_M, "rooms/sides_m/1", rooms.sides_m.map(|s| s[1])),
            ]
            .into_iter()
            .flatten()
            .collect(),
            Self::Area(area) => within(AREAS_M2, "area/area_m2", Some(area.area_m2)).into_iter().collect(),
            Self::Robots(robots) => [
                within(ROBOTS_M, "robots/width_m", robots.width_m),
                within(ROBOTS_M, "robots/length_m", robots.length_m),
                within(ROBOTS_M, "robots/height_m", robots.height_m),
            ]
            .into_iter()
            .flatten()
            .collect(),
            _ => Vec::new(),
        }
    }

    /// Returns the name that documents have for its kind: `rooms`, `capacity`, ...
    pub fn name(&self) -> &'static str {
        match self {
            Self::Rooms(_) => "rooms",
            Self::Objects(_) => "objects",
            Self::Capacity(_) => "capacity",
            Self::Relation(_) => "relation",
            Self::Storeys(_) => "storeys",
            Self::Area(_) => "area",
            Self::Robots(_) => "robots",
            Self::People(_) => "people",
            Self::Style(_) => "style",
            Self::Accessible(_) => "accessible",
            Self::Forbidden(_) => "forbidden",
            Self::Only(_) => "only",
            Self::Site(_) => "site",
            Self::Other(_) => "other",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROMPT: &str = "Büro für 12 Leute";

    fn brief(words: PromptWords, fact: Fact) -> Brief {
        let ask = Ask { id: "ask_1".into(), words: vec![words], read_by: ReadBy::Rules, fact };
        Brief { asks: vec![ask], ..Brief::of_prompt(PROMPT) }
    }

    #[test]
    fn words_quote_the_prompt_by_characters() {
        let people = Fact::People(PeopleAsk { role: "employee".into(), count: AskedCount::exactly(12) });
        let right = brief(PromptWords::of(PROMPT, 9, 17), people.clone());
        assert_eq!(right.asks[0].words[0].text, "12 Leute");
        assert_eq!(Brief::from_json(&right.to_json()).expect("it is valid"), right);
        let wrong = brief(PromptWords { start: 9, end: 17, text: "13 Leute".into() }, people.clone());
        assert_eq!(wrong.check()[0].path, "/asks/0/words");
        let beyond = brief(PromptWords { start: 9, end: 40, text: "12 Leute".into() }, people);
        assert_eq!(beyond.check().len(), 1);
    }

    #[test]
    fn measures_that_nobody_means_are_refused_at_their_place() {
        let words = PromptWords::of(PROMPT, 0, 4);
        let area = brief(words.clone(), Fact::Area(AreaAsk { area_m2: -3.0, bound: Bound::Exactly }));
        assert_eq!(area.check()[0].path, "/asks/0/fact/area/area_m2");
        let sides = RoomsAsk { sides_m: Some([4.0, 9000.0]), ..RoomsAsk::default() };
        assert_eq!(brief(words, Fact::Rooms(sides)).check()[0].path, "/asks/0/fact/rooms/sides_m/1");
    }

    #[test]
    fn counts_bind_as_they_are_said() {
        let cases = [
            (Bound::Exactly, 5, [4, 5, 6], [false, true, false]),
            (Bound::AtLeast, 5, [4, 5, 6], [false, true, true]),
            (Bound::AtMost, 5, [4, 5, 6], [true, true, false]),
            (Bound::About, 40, [35, 37, 44], [false, true, true]),
        ];
        for (bound, n, found, allowed) in cases {
            assert_eq!(found.map(|f| AskedCount { n, bound }.allows(f)), allowed, "{bound:?}");
        }
    }
}
