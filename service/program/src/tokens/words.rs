//! How people speak in prompts, from `words.toml`: read once, the same for every request.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use serde::Deserialize;

use super::text::{Phrases, Token};
use crate::tokens::storey::Where;

/// What a phrase does in a sentence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Tag {
    Detect,
    NumberJoins,
    Vague,
    Articles,
    Definite,
    Counters,
    Each,
    Both,
    Them,
    Own,
    Starts,
    Stops,
    Joins,
    No,
    /// Turns a relation round: "must not be next to".
    Not,
    /// All of those before it: "each other".
    Mutual,
    /// Goes on to say something else of the same: "but".
    But,
    /// How much of something: "not too large".
    Degree,
    /// Stands for the room that was spoken of: "with a door to it".
    It,
    /// Where robots are not to go: "keep out of".
    KeepOut,
    /// Behind what is not wanted: "not needed".
    Unneeded,
    /// Robots that meet in a corridor: "two-way".
    TwoWay,
    /// Between the first and the last of numbered rooms: "bedrooms 1 to 4".
    Range,
    Negative,
    Halves,
    Near,
    Door,
    Open,
    Together,
    Between,
    Around,
    Apart,
    /// What one sees from a room: "in sight of".
    Sight,
    Entrance,
    Total,
    Storeys,
    Lift,
    Habitable,
    Accessible,
    Wheelchair,
    Staff,
    People,
    Visitors,
    VisitorsBefore,
    StaffBefore,
    Beds,
    Desks,
    Residents,
    Clean,
    /// Robots that disinfect rooms, most by ultraviolet light: tall, and none for floors.
    Disinfect,
    DisinfectVerbs,
    Deliver,
    Serve,
    Transport,
    Robot,
    CleanVerbs,
    DeliverVerbs,
    ServeVerbs,
    TransportVerbs,
    TableWords,
    Charge,
    ChargePlace,
    Radius,
    Diameter,
    RoomWords,
    SpaceWords,
    /// What makes a kind of the word before it: "loft-style".
    OfKind,
    NotNames,
    Repeat,
    StyleWords,
    PlaceBefore,
    Nowhere,
    Inject,
    Inside,
    Singular,
    Holds,
    RoomCounters,
    /// What counts the beds of a room: "4-bed room", "Vierbettzimmer", "四人间".
    BedUnits,
    /// Words for a room behind these: "six-bed bay".
    BedRooms,
    /// Ends of compounds that number the beds of a room: "bettzimmer".
    BedRoomEnds,
    /// Places to be treated at, of which one room has several: "stations", "Plätze".
    Stations,
    /// The storey below the ground.
    Basement,
    /// Children who live in a home or visit a place.
    Children,
    Adults,
    /// A family of unknown size.
    Family,
    /// "family of" before a number.
    ResidentsBefore,
    /// Machines of kinds that are not planned.
    OtherRobot,
    /// Words between a thing and its measure: "at least".
    Measure,
    /// Wishes that nothing in a plan can follow: "facing south".
    Unread,
    /// Things of which a plan has no given number: "two windows".
    UnreadThings,
    /// Units of what is no length and no area: "kg", "lux".
    UnreadUnits,
    /// Units of time behind a length: "m/s".
    UnreadRates,
    /// Words that ask for nothing by themselves: "please".
    Polite,
    /// Rooms that flow into others: "open-plan", "offene", "abierta".
    OpenPlan,
    /// Who uses one of two rooms: "men's and women's toilets".
    Sexes,
    /// "Only", "and nothing else": a list that is all there is to be.
    Only,
    /// "Including": what follows is of the rooms before it.
    PartOf,
    /// Words for a small kitchen that is a part of the room it is named with: "kitchen corner".
    Corners,
    /// A bedroom with its bathroom, whoever it is for: the "suite" of "grandparents' suite".
    SuiteWords,
    /// Who has something of their own: "everyone".
    Everyone,
    /// All have a room of their own: "a room each".
    SingleRooms,
    /// Words for a place to work behind a door, that may mean a whole building too: "bureau".
    OfficeWords,
    /// What those do who have one room together: "sharing".
    Sharing,
    /// "Half open plan, half offices": those who work there are shared out.
    Half,
    /// Counters of a room at which people are served: "service windows", "Schalter".
    ServicePoints,
    /// "Separate" of toilets: men and women have their own.
    Parted,
    /// How wide a robot is: "0.7 m wide".
    Width,
    /// How long a robot is: "0.9 m long".
    Length,
    /// How high a robot is: "1.2 m high".
    Height,
    /// The circle in which a robot turns: "turning radius".
    TurningRadius,
    /// The step that a robot drives over: "climbs 2 cm".
    Climb,
    /// Parts of a building that are measured too: "ceilings", "aisles".
    MeasuredParts,
    /// Those who stay with a patient: "parents".
    Companions,
    /// What they do there: "stay overnight".
    Overnight,
    /// Words that say both: "rooming-in".
    RoomingIn,
    /// Babies, who sleep in a bed of their own beside their parents.
    Babies,
    /// One more of the same: "another bathroom".
    Another,
    /// One of the rooms counted before: "four bedrooms, the main one with a bathroom".
    OneOfThem,
    /// Rooms with a door of their own to those they serve: "separate kitchen", "cuisine fermée".
    ClosedPlan,
    /// People for whom a home is without steps and with room for a walking frame: "seniors".
    Frail,
    /// What a robot does where it has nothing to do: "waits".
    Waits,
    /// Rooms that several have together: "shared bathroom".
    SharedWords,
    /// Where one sleeps in a room that is for more: "sleeping area", "coin nuit".
    SleepingPlaces,
    /// People who are counted together and have rooms of their own: "groups", "teams".
    Groups,
    /// Homes, of which a building may have several: "flats", "units".
    Homes,
    /// Leads to those that something is for: "for".
    For,
    /// What a number behind them is the name of: "class 100", "type 2".
    NumberNames,
    /// The same where the number stands before them: "100级", "3호".
    NumberNamesBehind,
    /// "Fewer bedrooms than bathrooms".
    Fewer,
    More,
    Than,
    /// Words for streets behind their names: "Street", "road".
    Streets,
    /// The same before the name: "rue", "calle".
    StreetsBefore,
    /// Ends of German names of streets: "-strasse".
    StreetEnds,
}

/// Tags of words that only their own reader hears: to all others these are words like any.
const QUIET: [Tag; 17] = [
    Tag::Width,
    Tag::Length,
    Tag::Height,
    Tag::TurningRadius,
    Tag::Climb,
    Tag::MeasuredParts,
    Tag::Groups,
    Tag::Homes,
    Tag::For,
    Tag::NumberNames,
    Tag::NumberNamesBehind,
    Tag::Fewer,
    Tag::More,
    Tag::Than,
    Tag::Streets,
    Tag::StreetsBefore,
    Tag::StreetEnds,
];

/// Words of one language.
#[derive(Debug, Deserialize)]
pub(crate) struct Language {
    pub numbers: BTreeMap<String, f64>,
    pub multipliers: BTreeMap<String, f64>,
    pub quantities: BTreeMap<String, f64>,
    /// Adjectives of nationality by country code.
    pub demonyms: BTreeMap<String, Vec<String>>,
    /// Words that name a storey, with which one they mean.
    #[serde(default)]
    pub levels: BTreeMap<String, String>,
    /// Such words without the noun, in a prompt that names another storey in full: "en la primera", "im zweiten".
    #[serde(default)]
    pub levels_elided: BTreeMap<String, String>,
    /// Words that say how many storeys a building has.
    #[serde(default)]
    pub storey_counts: BTreeMap<String, f64>,
    /// Words for people who share a home, with how many they are.
    #[serde(default)]
    pub households: BTreeMap<String, f64>,
    /// Words for rooms whose first word only says what for: "model workshop".
    #[serde(default)]
    pub heads: Vec<String>,
    /// What a room is for that no domain knows by name, with the room types that serve it, the best first: "plotter".
    #[serde(default)]
    pub matters: BTreeMap<String, Vec<String>>,
    /// Words that name a room of the day or several, with the room types; in a row they name rooms that are open to each other.
    #[serde(default)]
    pub joint: BTreeMap<String, Vec<String>>,
    /// Words for a room and its bathroom, with the room types.
    #[serde(default)]
    pub suites: BTreeMap<String, Vec<String>>,
    /// Words for how large a room is, with the factor on its usual area.
    #[serde(default)]
    pub sizes: BTreeMap<String, f64>,
    /// Words for a room that say what stands in it: its type and the object.
    #[serde(default)]
    pub furnished: BTreeMap<String, Vec<String>>,
    /// Words for a place in a room and not a room: the object that stands there, and the room types, the usual one first.
    #[serde(default)]
    pub nooks: BTreeMap<String, Vec<String>>,
    /// Words for rooms of several types that share a noun, with the room types: "single and double rooms".
    #[serde(default)]
    pub mixes: BTreeMap<String, Vec<String>>,
    #[serde(flatten)]
    pub phrases: BTreeMap<Tag, Vec<String>>,
}

/// Room types behind short forms of dwellings.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Dwelling {
    pub living: String,
    pub dining: String,
    pub bedroom: String,
    pub kitchen: String,
    pub bathroom: String,
    pub studio: String,
    pub toilet: String,
    /// A room with a shower and no toilet.
    pub shower: String,
    /// One room to live and cook in.
    pub living_kitchen: String,
    /// The sitting room of a suite.
    pub suite_sitting: String,
    /// The room of an annexe that its bedroom and bathroom are entered from, with its kitchen.
    pub annexe: String,
    /// What those sleep in who are alone in their room.
    pub own_bed: String,
    /// Rooms in which those sleep who do not keep the home.
    pub of_others: Vec<String>,
    pub of_guests: Vec<String>,
    /// The room of a baby, and what stands in its parents' room where it has none.
    pub baby_room: String,
    pub baby_bed: String,
    pub ensuite: String,
    /// Building types of homes that people share who have a room each.
    pub shared: Vec<String>,
    /// What those work at in their rooms.
    pub own_desk: String,
    /// The room in which they eat, and at what.
    pub shared_meals: [String; 2],
    /// Rooms that a word for a bathroom may mean where no one lives.
    pub toilets: Vec<String>,
    /// Rooms that no dwelling is without, each with what can stand for it.
    pub essential: Vec<Vec<String>>,
    /// Rooms that every dwelling has whose rooms are left open, each with what can stand for it.
    pub vital: Vec<Vec<String>>,
    /// Building types within one storey of a larger house: a word for a basement means a room for things there.
    pub within_a_storey: Vec<String>,
    /// Rooms that a basement has when nothing is said of it, the first that the domain knows.
    pub basement: Vec<String>,
    pub bhk: Vec<String>,
    pub ldk: Vec<String>,
    pub rooms_to_live: Vec<String>,
    /// Rooms to live in, in the order in which homes of more and more of them have them.
    pub live_in: Vec<String>,
    /// Programs of homes by how many bedrooms the prompt gives them, in place of their usual program.
    pub by_bedrooms: Vec<ByBedrooms>,
    pub zh_units: BTreeMap<String, String>,
    pub bed_letters: Vec<String>,
    pub bath_letters: Vec<String>,
    pub bedroom_words: BTreeMap<String, f64>,
}

/// A program of homes with so many bedrooms.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ByBedrooms {
    /// Programs that it replaces.
    pub programs: Vec<String>,
    pub bedrooms: u32,
    pub program: String,
}

#[derive(Debug, Deserialize)]
struct File {
    /// Usual words of languages that are not read, by English name of the language.
    unread_languages: BTreeMap<String, Vec<String>>,
    /// What stands between two lengths.
    times: BTreeSet<String>,
    area_units: BTreeMap<String, f64>,
    length_units: BTreeMap<String, f64>,
    /// Seconds of units of time.
    time_units: BTreeMap<String, f64>,
    #[serde(flatten)]
    languages: BTreeMap<String, Language>,
}

/// Room types by what they do for the reader, from `rooms.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rooms {
    /// Rooms that no place to work at is without, each with what can stand for it.
    work_vital: Vec<Vec<String>>,
    /// Desks from which on more is vital.
    many_desks: u32,
    /// What is vital then.
    many_vital: Vec<Vec<String>>,
    /// Rooms of one use: the program adds none beside one that the prompt names.
    alike: Vec<Vec<String>>,
    /// Share of those who work there that has a seat in a room to eat in, by room type.
    eating: BTreeMap<String, f64>,
    /// Seats in a room to wait in for each counter of the building, by room type.
    waiting: BTreeMap<String, f64>,
    /// Whose the toilets of a place to work at are, one word each, as names of rooms begin.
    sexes: Vec<String>,
    /// Domain whose rooms are of all kinds of buildings.
    common_domain: String,
    dwelling: Dwelling,
}

/// All words of the module, ready for matching.
pub(crate) struct Words {
    pub languages: BTreeMap<String, Spoken>,
    pub times: BTreeSet<String>,
    pub area_units: Phrases<f64>,
    pub length_units: Phrases<f64>,
    pub time_units: Phrases<f64>,
    pub dwelling: Dwelling,
    pub work_vital: Vec<Vec<String>>,
    pub many_desks: u32,
    pub many_vital: Vec<Vec<String>>,
    pub alike: Vec<Vec<String>>,
    pub eating: BTreeMap<String, f64>,
    pub waiting: BTreeMap<String, f64>,
    pub sexes: Vec<String>,
    pub common_domain: String,
    /// Usual words of languages that are not read, folded, by English name of the language.
    pub unread_languages: BTreeMap<String, BTreeSet<String>>,
}

/// One language ready for matching.
pub(crate) struct Spoken {
    pub words: Language,
    pub tags: Phrases<Vec<Tag>>,
    /// Phrases of tags that only one reader hears.
    quiet: Phrases<Vec<Tag>>,
    pub quantities: Phrases<f64>,
    pub levels: Phrases<Where>,
    pub levels_elided: Phrases<Where>,
    pub storey_counts: Phrases<f64>,
    pub households: Phrases<f64>,
    pub heads: Phrases<()>,
    pub matters: Phrases<Vec<String>>,
    pub joint: Phrases<Vec<String>>,
    pub suites: Phrases<Vec<String>>,
    pub sizes: Phrases<f64>,
    pub furnished: Phrases<Vec<String>>,
    pub nooks: Phrases<Vec<String>>,
    pub mixes: Phrases<Vec<String>>,
    /// Usual words that tell the language, folded.
    pub detect: BTreeSet<String>,
    /// Number words, folded.
    pub numbers: BTreeMap<String, f64>,
    pub multipliers: BTreeMap<String, f64>,
}

impl Spoken {
    /// Returns the code of the language.
    pub(crate) fn language(&self) -> &str {
        self.quantities.language()
    }

    /// Returns the end of the longest phrase with this tag that begins at a token.
    pub(crate) fn tag_at(&self, tokens: &[Token], i: usize, tag: Tag) -> Option<usize> {
        let phrases = if QUIET.contains(&tag) { &self.quiet } else { &self.tags };
        phrases.longest_at(tokens, i).filter(|(_, tags)| tags.contains(&tag)).map(|(end, _)| end)
    }
}

/// Returns the end of a phrase with this tag that begins at a token, in the first of the languages that has one.
pub(crate) fn tag_end(spoken: &[&Spoken], tokens: &[Token], i: usize, tag: Tag) -> Option<usize> {
    spoken.iter().find_map(|s| s.tag_at(tokens, i, tag))
}

/// Returns true where a phrase with this tag begins at a token.
pub(crate) fn is_tagged(spoken: &[&Spoken], tokens: &[Token], i: usize, tag: Tag) -> bool {
    tag_end(spoken, tokens, i, tag).is_some()
}

/// Returns true where a phrase with this tag, in any of the languages, is the tokens from one up to another.
pub(crate) fn tag_ends_at(spoken: &[&Spoken], tokens: &[Token], i: usize, tag: Tag, end: usize) -> bool {
    spoken.iter().any(|s| s.tag_at(tokens, i, tag) == Some(end))
}

/// Returns the words of all languages.
pub(crate) fn words() -> &'static Words {
    static WORDS: LazyLock<Words> = LazyLock::new(|| {
        let file: File = toml::from_str(include_str!("words.toml")).expect("a test reads words.toml");
        let rooms: Rooms = toml::from_str(include_str!("rooms.toml")).expect("a test reads rooms.toml");
        let units = |units: &BTreeMap<String, f64>| {
            let mut phrases = Phrases::new("");
            units.iter().for_each(|(unit, factor)| phrases.insert(unit, *factor));
            phrases
        };
        Words {
            times: file.times,
            area_units: units(&file.area_units),
            length_units: units(&file.length_units),
            time_units: units(&file.time_units),
            languages: file.languages.into_iter().map(|(code, words)| (code.clone(), spoken(&code, words))).collect(),
            dwelling: rooms.dwelling,
            work_vital: rooms.work_vital,
            many_desks: rooms.many_desks,
            many_vital: rooms.many_vital,
            alike: rooms.alike,
            eating: rooms.eating,
            waiting: rooms.waiting,
            sexes: rooms.sexes,
            common_domain: rooms.common_domain,
            unread_languages: file
                .unread_languages
                .into_iter()
                .map(|(name, words)| (name, words.iter().map(|w| super::text::fold(w)).collect()))
                .collect(),
        }
    });
    &WORDS
}

fn spoken(code: &str, words: Language) -> Spoken {
    let (mut tags, mut quiet) = (Phrases::new(""), Phrases::new(""));
    let robots = [Tag::Clean, Tag::Deliver, Tag::Serve, Tag::Transport, Tag::OtherRobot];
    for (tag, phrases) in &words.phrases {
        let plurals = phrases.iter().filter(|_| robots.contains(tag)).flat_map(|p| robot_forms(code, p));
        let known = if QUIET.contains(tag) { &mut quiet } else { &mut tags };
        for phrase in phrases.iter().cloned().chain(plurals) {
            known.put(&phrase, vec![*tag], |old: &Vec<Tag>, new| {
                if old.contains(&new[0]) { old.clone() } else { [old.clone(), new.clone()].concat() }
            });
        }
    }
    let mut quantities = Phrases::new(code);
    words.quantities.iter().for_each(|(phrase, value)| quantities.insert(phrase, *value));
    let folded =
        |map: &BTreeMap<String, f64>| map.iter().map(|(word, value)| (super::text::fold(word), *value)).collect();
    let (numbers, multipliers) = (folded(&words.numbers), folded(&words.multipliers));
    let storeys = |map: &BTreeMap<String, String>| {
        let mut phrases = Phrases::new("");
        for (phrase, text) in map {
            phrases.insert(phrase, Where::of(text).expect("a test reads words.toml"));
        }
        phrases
    };
    let (levels, levels_elided) = (storeys(&words.levels), storeys(&words.levels_elided));
    let mut storey_counts = Phrases::new("");
    words.storey_counts.iter().for_each(|(phrase, value)| storey_counts.insert(phrase, *value));
    let mut households = Phrases::new("");
    words.households.iter().for_each(|(phrase, value)| households.insert(phrase, *value));
    let mut heads = Phrases::new(code);
    words.heads.iter().for_each(|phrase| heads.insert(phrase, ()));
    let mut matters = Phrases::new(code);
    words.matters.iter().for_each(|(phrase, types)| matters.insert(phrase, types.clone()));
    let table = |map: &BTreeMap<String, Vec<String>>| {
        let mut phrases = Phrases::new("");
        map.iter().for_each(|(phrase, types)| phrases.insert(phrase, types.clone()));
        phrases
    };
    let (joint, suites, mixes) = (table(&words.joint), table(&words.suites), table(&words.mixes));
    let furnished = table(&words.furnished);
    let nooks = table(&words.nooks);
    let mut sizes = Phrases::new("");
    words.sizes.iter().for_each(|(phrase, value)| sizes.insert(phrase, *value));
    let detect = words.phrases.get(&Tag::Detect).into_iter().flatten().map(|w| super::text::fold(w)).collect();
    Spoken {
        detect,
        numbers,
        multipliers,
        words,
        tags,
        quiet,
        quantities,
        levels,
        levels_elided,
        storey_counts,
        households,
        heads,
        matters,
        joint,
        suites,
        sizes,
        furnished,
        nooks,
        mixes,
    }
}

/// Returns the further forms of a word for robots: English plurals, German ones of the third case and of the second.
fn robot_forms(code: &str, phrase: &str) -> Vec<String> {
    match code {
        "en" => vec![format!("{phrase}s")],
        "de" if phrase.ends_with("er") => vec![format!("{phrase}n"), format!("{phrase}s")],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_language_has_numbers_relations_and_robots() {
        let words = words();
        assert_eq!(words.languages.keys().collect::<Vec<_>>(), ["de", "en", "es", "fr", "ko", "zh"]);
        for (code, spoken) in &words.languages {
            for tag in [Tag::No, Tag::Near, Tag::Door, Tag::Apart, Tag::Between, Tag::Staff, Tag::Clean, Tag::Charge] {
                assert!(spoken.words.phrases.get(&tag).is_some_and(|p| !p.is_empty()), "{code} has no {tag:?}");
            }
        }
        assert_eq!(words.area_units.whole("square feet"), Some(&0.092_903_04));
    }
}
