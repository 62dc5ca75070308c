//! Scene graphs of plans that people bring: rooms get their types from the words on the plan, edges from its doors.
//!
//! What such a plan gets wrong stays as it is: the graph says what there is, and the hard rules say what it breaks.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Domain, GENERIC_ROOM_TYPE, RoomType};
use d3dgen_model::floorplan::{DoorKind, Floorplan};
use d3dgen_model::offer::Wet;
use d3dgen_model::robot_kind;
use d3dgen_model::scene_graph::{Connector, GraphEdge, GraphRoom, Note, Occupancy, Robot, SceneGraph};
use d3dgen_model::stage::Error;
use d3dgen_plugins::Registry;

use super::built::rooms::wished_assets;
use super::guessed;
use super::subject::places;
use super::tokens::labels;
use super::tokens::text::{Phrases, Token, fold, tokens};
use super::tokens::umlauts;
use super::tokens::words::words;
use super::wished::wishes::CHARGING;
use crate::request::refused;

/// Reason of the edges of a brought plan.
const BY_PLAN: &str = "given_plan";
/// Shortest end of a compound word that names a room, letters.
const LEAST_ENDING: usize = 5;

/// A word names a room when it does with this after it (`exam` is the exam room).
const ROOM: &str = "room";
/// How much a name counts for a domain: as one of all names, and by how few domains know it.
const KNOWN: f64 = 0.5;
const RARE: f64 = 1.0;
/// How much it counts that a program of the domain has the same rooms, and that the title names the domain.
const LIKE_PROGRAM: f64 = 0.8;
const TITLED: f64 = 0.5;
const TITLE: f64 = 1.0;
/// How many known types are named beside one that is not known.
const NEAREST: usize = 3;
/// Domains this close to the best one are as good; the first of them is taken.
const AS_GOOD: f64 = 0.97;

/// What a plan says about a room.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Label {
    /// The name on the plan.
    pub text: String,
    /// What the file or the user says it is, where that is said beside the name; counts first.
    pub kind: Option<String>,
    /// True when the user says it, who wants to hear of a kind that is none.
    pub said: bool,
    /// Other words that stand in the room; they count when neither of the others names a room.
    pub also: Vec<String>,
    /// True when it joins so many rooms that it is circulation, if no words say something else.
    pub hub: bool,
    /// True when the plan gives it no name, or a number only.
    pub unnamed: bool,
    /// Net floor area, m^2.
    pub area_m2: f64,
    /// Rooms that a door or passage joins it with, by their place in the list.
    pub beside: Vec<usize>,
}

impl Label {
    fn words(&self) -> impl Iterator<Item = &str> {
        self.kind.iter().map(String::as_str).chain([self.text.as_str()]).chain(self.also.iter().map(String::as_str))
    }
}

/// Labels understood.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Understood {
    /// Domain id.
    pub domain: String,
    /// A room type of the domain for each label; the generic one where the words are not known.
    pub room_types: Vec<String>,
    /// The name for each label: the words that say its type, or the name on the plan.
    pub names: Vec<String>,
    /// What was guessed.
    pub notes: Vec<Note>,
}

/// What to make of a plan, beside the plan itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Brought {
    /// What the graph gives as its prompt.
    pub title: String,
    /// Seed of every random choice.
    pub seed: u64,
    /// Domain id.
    pub domain: String,
    /// Country as ISO 3166-1 alpha-2 code or name.
    pub country: Option<String>,
    /// Kinds of robots, each once (`cleaning`, `disinfection`, `delivery`, `service`, `transport`).
    pub robots: Vec<String>,
    /// Radius of the largest robot, m.
    pub robot_radius_m: Option<f64>,
    /// What was assumed on the way here.
    pub notes: Vec<Note>,
}

/// The room words of a domain in all languages.
pub(crate) struct Names<'a> {
    domain: &'a Domain,
    languages: Vec<Phrases<String>>,
}

impl<'a> Names<'a> {
    /// Returns the words of a domain.
    pub(crate) fn new(domain: &'a Domain) -> Self {
        let of = |language: &String| {
            let mut phrases = Phrases::new(language);
            for room in domain.room_types.iter().filter(|r| r.id != GENERIC_ROOM_TYPE) {
                if language == "en" {
                    phrases.insert(&room.id.replace('_', " "), room.id.clone());
                }
                room.keywords.get(language).into_iter().flatten().for_each(|w| phrases.insert(w, room.id.clone()));
            }
            // on a plan a word for such a building means its room of the same kind: "Büro"
            for building in domain.building_types.iter().filter(|b| domain.room_type(&b.id).is_some()) {
                building
                    .keywords
                    .get(language)
                    .into_iter()
                    .flatten()
                    .for_each(|w| phrases.insert(w, building.id.clone()));
            }
            phrases
        };
        Self { domain, languages: words().languages.keys().map(of).collect() }
    }

    /// Returns the room type that the longest words of a label name, and how many letters they have.
    pub(crate) fn find(&self, label: &str) -> Option<(&str, usize)> {
        if self.domain.room_type(label).is_some_and(|r| r.id != GENERIC_ROOM_TYPE) {
            return self.domain.room_type(label).map(|r| (r.id.as_str(), label.len()));
        }
        let list = tokens(&spaced(label));
        self.hear(&list).or_else(|| {
            // "Kueche"
            let respelled = |t: Token| umlauts::plain(&t.text).map_or(t.clone(), |text| Token { text, ..t });
            self.hear(&list.into_iter().map(respelled).collect::<Vec<_>>())
        })
    }

    fn hear(&self, list: &[Token]) -> Option<(&str, usize)> {
        let mut best: Option<(&str, usize)> = None;
        let mut hear = |id: &'_ String, letters: usize| -> Option<()> {
            let known = self.domain.room_type(id)?;
            if best.is_none_or(|b| letters > b.1) {
                best = Some((known.id.as_str(), letters));
            }
            None
        };
        for phrases in &self.languages {
            for i in 0..list.len() {
                if let Some((end, id)) = phrases.longest_at(list, i) {
                    hear(id, list[i..end].iter().map(|t| t.text.chars().count()).sum());
                }
                if let Some((id, cut)) = phrases.ending(&list[i].text, LEAST_ENDING) {
                    hear(id, list[i].text.len() - cut);
                }
            }
        }
        best
    }

    /// Returns the room type that a label names, how many letters say so, and which words of it.
    fn room_type<'l>(&self, label: &'l Label) -> Option<(&str, usize, &'l str)> {
        let found = label.words().find_map(|w| self.find(w).map(|(id, letters)| (id, letters, w)));
        // a word that is short for such a room: an exam, a ward
        let found = found.or_else(|| {
            let short = |w: &str| !w.trim().is_empty() && !w.to_lowercase().contains(ROOM);
            let whole = |w: &str| self.find(&format!("{} {ROOM}", bare(w))).filter(|f| f.1 > ROOM.len());
            label.words().filter(|w| short(w)).find_map(|w| whole(w).map(|(id, letters)| (id, letters - ROOM.len(), w)))
        });
        // words that only plans have: "Kit.", "LR 2", "Slaapkamer"
        found.or_else(|| {
            let english = |w: &str| labels::in_english(w).or_else(|| labels::in_english(&spaced(w)));
            let meant = |w: &'l str| english(w).and_then(|english| self.find(english));
            label.words().find_map(|w| meant(w).map(|(id, letters)| (id, letters, w)))
        })
    }
}

/// Returns the room type of a domain that a name means in any language, all of it: "study", "Küche".
pub fn room_type_called<'d>(domain: &'d Domain, name: &str) -> Option<&'d RoomType> {
    let names = Names::new(domain);
    let all = name.chars().filter(|c| c.is_alphanumeric()).count();
    names.find(name).filter(|(_, letters)| *letters >= all).and_then(|(id, _)| domain.room_type(id))
}

/// Returns a label without the numbers that count its rooms.
fn bare(label: &str) -> String {
    let text = spaced(label);
    text.split_whitespace().filter(|t| !t.chars().all(|c| c.is_ascii_digit())).collect::<Vec<_>>().join(" ")
}

/// Returns a label with its words parted: `livingRoom2` is `living Room 2`, underscores are spaces.
fn spaced(label: &str) -> String {
    let mut out = String::with_capacity(label.len() + 8);
    let mut before = ' ';
    for c in label.chars().take(200) {
        let parts = before.is_lowercase() && c.is_uppercase() || before.is_alphabetic() && c.is_ascii_digit();
        if parts || c == '_' {
            out.push(' ');
        }
        if c != '_' {
            out.push(c);
        }
        before = c;
    }
    out
}

/// Refuses kinds that the user says and that are no room of the domain, with those that are written most alike.
fn check_said(labels: &[Label], names: &Names) -> Result<(), Error> {
    let wrong = |l: &&Label| l.kind.as_deref().is_some_and(|k| k != GENERIC_ROOM_TYPE && names.find(k).is_none());
    let Some(label) = labels.iter().filter(|l| l.said).find(wrong) else { return Ok(()) };
    let kind = label.kind.as_deref().unwrap_or_default();
    let mut known: Vec<&str> = names.domain.room_types.iter().map(|r| r.id.as_str()).collect();
    known.sort_by(|a, b| likeness(b, kind).total_cmp(&likeness(a, kind)));
    known.truncate(NEAREST);
    let (id, text) = (&names.domain.id, &label.text);
    let message = format!(
        "room type {text}={kind}: {id} has no room `{kind}`; nearest are {}; `d3dgen domains show {id}` has all",
        known.join(", ")
    );
    Err(refused(message))
}

/// Returns the share of pairs of letters that two words have in common, 0 to 1.
fn likeness(a: &str, b: &str) -> f64 {
    let pairs = |w: &str| {
        let letters: Vec<char> = w.to_lowercase().chars().collect();
        letters.windows(2).map(|p| (p[0], p[1])).collect::<BTreeSet<_>>()
    };
    let (a, b) = (pairs(a), pairs(b));
    2.0 * a.intersection(&b).count() as f64 / (a.len() + b.len()).max(1) as f64
}

/// Finds the room types of labels, in a domain or in the one that they and the titles of the plan fit best.
///
/// # Errors
/// `Refused` for a domain that is not registered, and for a kind of room that the user says and the domain does not know.
pub fn understand(
    labels: &[Label],
    titles: &[String],
    domain: Option<&str>,
    registry: &Registry,
) -> Result<Understood, Error> {
    let mut notes = Vec::new();
    let mut sure = domain.is_some();
    let names = match domain {
        Some(id) => {
            let plugin = registry.get(id).ok_or_else(|| {
                let known: Vec<&str> = registry.iter().map(|p| p.id()).collect();
                refused(format!("domain `{id}` is not known; known are {}", known.join(", ")))
            })?;
            Names::new(plugin.domain())
        }
        None => {
            let (names, why, evident) = guess(labels, titles, registry)?;
            sure = evident;
            notes.push(Note::new("default_domain", why));
            names
        }
    };
    check_said(labels, &names)?;
    let circulation = names.domain.room_type(&names.domain.circulation.room_type).map(|r| r.id.clone());
    let mut hubs = 0;
    let (mut room_types, mut called) = (Vec::with_capacity(labels.len()), Vec::with_capacity(labels.len()));
    for label in labels {
        let known = names.room_type(label);
        let of_kind = known.is_some_and(|k| label.kind.as_deref() == Some(k.2));
        called.push(known.filter(|_| !of_kind).map_or_else(|| label.text.clone(), |k| k.2.to_owned()));
        match (known, &circulation) {
            (Some((id, ..)), _) => room_types.push(id.to_owned()),
            (None, Some(id)) if label.hub => {
                hubs += 1;
                room_types.push(id.clone());
            }
            _ => room_types.push(GENERIC_ROOM_TYPE.to_owned()),
        }
    }
    if let Some(id) = circulation.filter(|_| hubs > 0) {
        let message = format!(
            "{hubs} rooms without a name, or with a number only, join so many others that they were taken for `{id}`"
        );
        notes.push(Note::new("circulation_guessed", message));
    }
    if sure {
        notes.extend(guessed::unnamed(labels, &mut room_types, titles, names.domain));
    }
    let generic = labels.iter().zip(&room_types).filter(|(_, t)| *t == GENERIC_ROOM_TYPE).map(|(label, _)| {
        let text = if label.text.is_empty() { label.kind.as_deref().unwrap_or_default() } else { &label.text };
        if text.is_empty() { "rooms without a name".into() } else { format!("`{text}`") }
    });
    let mut unknown: Vec<String> = generic.collect();
    unknown.dedup();
    if !unknown.is_empty() {
        let more = unknown.len().saturating_sub(12);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let list = unknown.iter().take(12).cloned().collect::<Vec<_>>().join(", ");
        let message = format!(
            "{} names no room of {list}{more}; they are of the type `{GENERIC_ROOM_TYPE}`, --room-type \"NAME=TYPE\" says better",
            names.domain.id
        );
        notes.push(Note::new("unknown_label", message));
    }
    Ok(Understood { domain: names.domain.id.clone(), room_types, names: called, notes })
}

/// Returns the domain that labels and titles fit best, why, and whether anything speaks for it.
///
/// A name counts more the fewer domains know it, and a domain more the closer one of its programs is to the rooms there are:
/// that an office has a meeting room and no loading dock tells it from a warehouse. Titles decide where names say little.
/// Where nothing is known it is the domain of the most kinds of buildings.
fn guess<'a>(labels: &[Label], titles: &[String], registry: &'a Registry) -> Result<(Names<'a>, String, bool), Error> {
    let all: Vec<Names> = registry.iter().map(|p| Names::new(p.domain())).collect();
    let found: Vec<Vec<_>> = all.iter().map(|names| labels.iter().map(|l| names.room_type(l)).collect()).collect();
    let best: Vec<usize> = (0..labels.len())
        .map(|k| found.iter().filter_map(|list| list[k].map(|f| f.1)).max().unwrap_or(0).max(1))
        .collect();
    let rare =
        |k: usize| RARE / found.iter().filter(|list| list[k].is_some_and(|f| f.1 == best[k])).count().max(1) as f64;
    let titled: Vec<bool> = all.iter().map(|names| titles.iter().any(|t| is_title(names.domain, t))).collect();
    let score = |d: usize| {
        let known = (0..labels.len()).filter_map(|k| found[d][k].map(|f| (k, f.1 as f64 / best[k] as f64)));
        let names: f64 = known.map(|(k, part)| part * (KNOWN + rare(k))).sum();
        let types: BTreeSet<&str> = found[d].iter().flatten().map(|f| f.0).collect();
        let alike = like_program(all[d].domain, &types);
        let title = if titled[d] { (1.0 + TITLED, TITLE) } else { (1.0, 0.0) };
        names * (1.0 + LIKE_PROGRAM * alike) * title.0 + title.1
    };
    let scores: Vec<f64> = (0..all.len()).map(score).collect();
    let most = scores.iter().copied().fold(0.0, f64::max);
    let chosen = if most > 0.0 {
        scores.iter().position(|s| *s >= AS_GOOD * most)
    } else {
        let kinds = |d: &usize| all[*d].domain.building_types.len();
        (0..all.len()).max_by_key(|d| (kinds(d), usize::MAX - d))
    };
    let chosen = chosen.ok_or_else(|| refused("no domain is registered".into()))?;
    let known = found[chosen].iter().flatten().count();
    let id = &all[chosen].domain.id;
    let names = format!("knows {known} of {} names of rooms", labels.len());
    let why = match (titled[chosen], known) {
        (true, _) => {
            format!("domain {id} {names}, and a title of the plan names it; it was taken, choose another with --domain")
        }
        (false, 0) => format!("no domain knows a name of a room; {id} was taken, choose another with --domain"),
        (false, _) => format!("domain {id} {names} and was taken; choose another with --domain"),
    };
    let names = all.into_iter().nth(chosen).ok_or_else(|| refused("no domain is registered".into()))?;
    Ok((names, why, most > 0.0))
}

/// Returns how alike room types are to the first rooms of the program that is most like them, 0 to 1.
fn like_program(domain: &Domain, types: &BTreeSet<&str>) -> f64 {
    // every building has toilets, and plans seldom say for whom
    let wet = Wet::of(domain);
    let tells = |id: &str| domain.room_type(id).is_none_or(|k| !wet.has_toilet(k) || wet.is_bathroom(k));
    let types: BTreeSet<&str> = types.iter().copied().filter(|id| tells(id)).collect();
    let alike = |program: &d3dgen_model::domain::Program| {
        let mut rooms: BTreeSet<&str> = BTreeSet::new();
        for entry in program.rooms.iter().filter(|e| tells(&e.room_type)) {
            if rooms.len() < types.len() {
                rooms.insert(&entry.room_type);
            }
        }
        let both = rooms.intersection(&types).count();
        2.0 * both as f64 / (rooms.len() + types.len()).max(1) as f64
    };
    domain.programs.iter().map(alike).fold(0.0, f64::max)
}

/// Returns true when a title has a word for a building of a domain.
fn is_title(domain: &Domain, title: &str) -> bool {
    let list = tokens(&spaced(title));
    domain.keywords.iter().any(|(language, words)| {
        let mut phrases = Phrases::new(language);
        words.iter().for_each(|w| phrases.insert(w, ()));
        (0..list.len()).any(|i| phrases.longest_at(&list, i).is_some())
    })
}

/// Returns the scene graph of a plan as it is: its rooms, and an edge for each pair that a door or passage joins.
///
/// # Errors
/// `Refused` for domains, countries and robots that are not known.
pub fn of_plan(plan: &Floorplan, brought: &Brought, registry: &Registry) -> Result<SceneGraph, Error> {
    let plugin = registry.get(&brought.domain);
    let domain =
        plugin.map(|p| p.domain()).ok_or_else(|| refused(format!("domain `{}` is not known", brought.domain)))?;
    let place = match &brought.country {
        None => None,
        Some(country) => Some(places::code_of(country).ok_or_else(|| {
            refused(format!("country `{country}` is not known; give an ISO 3166 code such as DE or US-NC, or a name"))
        })?),
    };
    let entrance = plan.doors.iter().find(|d| d.entrance).and_then(|d| d.room_ids.first());
    let rooms: Vec<GraphRoom> = plan
        .rooms
        .iter()
        .map(|room| {
            let kind = domain.room_type_or_generic(&room.room_type);
            let range = kind.area_m2;
            GraphRoom {
                id: room.room_id.clone(),
                room_type: room.room_type.clone(),
                name: room.name.clone(),
                description: kind.description.clone(),
                target_area_m2: room.net_area_m2.clamp(range.min, range.max),
                // nobody asked for less than is there
                area_range_m2: [range.min, range.max.max(room.net_area_m2)],
                wished_assets: wished_assets(domain, kind, &[]),
                sides_m: None,
                occupants: None,
                circulation: room.circulation,
                requested: true,
                entrance: entrance == Some(&room.room_id),
                locked: true,
                level: room.level,
                unit: None,
                garden_door: false,
            }
        })
        .collect();
    Ok(SceneGraph {
        version: 1,
        prompt: brought.title.clone(),
        seed: brought.seed,
        domain: domain.id.clone(),
        building_type: None,
        country_code: place.as_deref().map(places::country_of).map(str::to_owned),
        division_code: place.filter(|code| places::country_of(code) != code.as_str()),
        language: "en".into(),
        area_m2: None,
        occupancy: Occupancy::default(),
        accessible: false,
        wheelchair: false,
        style: d3dgen_model::style::Style::default(),
        rooms,
        edges: edges(plan),
        apart: Vec::new(),
        forbidden_room_types: Vec::new(),
        robots: robots(plan, brought)?,
        robot_rules: Vec::new(),
        two_way: false,
        assumptions: brought.notes.clone(),
        conflicts: Vec::new(),
        links: plan.links.clone(),
    })
}

fn edges(plan: &Floorplan) -> Vec<GraphEdge> {
    let mut joined: BTreeMap<(&str, &str), Connector> = BTreeMap::new();
    for door in &plan.doors {
        let [a, b] = door.room_ids.as_slice() else { continue };
        let connector = if door.kind == DoorKind::Open { Connector::Open } else { Connector::Door };
        let known = joined.entry((a.min(b), a.max(b))).or_insert(connector);
        *known = (*known).min(connector);
    }
    let edge = |((a, b), connector): ((&str, &str), Connector)| GraphEdge {
        a: a.to_owned(),
        b: b.to_owned(),
        connector,
        required: true,
        reason: BY_PLAN.into(),
    };
    joined.into_iter().filter(|((a, b), _)| a != b).map(edge).collect()
}

fn robots(plan: &Floorplan, brought: &Brought) -> Result<Vec<Robot>, Error> {
    if let Some(radius) = brought.robot_radius_m.filter(|r| !(r.is_finite() && (0.05..=2.0).contains(r))) {
        return Err(refused(format!("a robot radius of {radius} m was asked for; it must be 0.05 to 2 m")));
    }
    let charging = plan.rooms.iter().any(|r| r.room_type == CHARGING);
    let mut kinds: Vec<String> = Vec::new();
    let wanted = brought.robots.iter().map(|k| fold(k));
    for kind in wanted.chain((brought.robots.is_empty() && brought.robot_radius_m.is_some()).then(|| "service".into()))
    {
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let robot = |kind: String| {
        let body = robot_kind::typical(&kind).ok_or_else(|| {
            let known = robot_kind::names();
            refused(format!("robot `{kind}` is not known; known are {}", known.join(", ")))
        })?;
        let radius_m = brought.robot_radius_m.unwrap_or(body.radius_m);
        Ok(Robot {
            kind,
            count: 1,
            radius_m,
            height_m: body.height_m,
            charging,
            body: None,
            stops: Vec::new(),
            room_types: Vec::new(),
            misfit: false,
        })
    };
    kinds.into_iter().map(robot).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn types(labels: &[&str], domain: Option<&str>) -> Understood {
        titled(labels, &[], domain)
    }

    fn titled(labels: &[&str], titles: &[&str], domain: Option<&str>) -> Understood {
        let labels: Vec<Label> = labels.iter().map(|t| Label { text: (*t).into(), ..Label::default() }).collect();
        let titles: Vec<String> = titles.iter().map(|t| (*t).to_owned()).collect();
        understand(&labels, &titles, domain, &Registry::builtin()).expect("a known domain")
    }

    #[test]
    fn labels_in_many_spellings_name_room_types() {
        for (label, expected) in [
            ("Bedroom 2", "bedroom"),
            ("bedroom_2", "bedroom"),
            ("livingRoom", "living_room"),
            ("Küche 12,5 m²", "kitchen"),
            ("Schlafzimmer Eltern", "bedroom"),
            ("Salle de bains", "bathroom"),
            ("卧室", "bedroom"),
            ("LR", "living_room"),
            ("Kit.", "kitchen"),
            ("BR 1", "bedroom"),
            ("KiZi2", "kids_room"),
            ("SdB", "bathroom"),
            ("Slaapkamer 2", "bedroom"),
            ("寝室1", "bedroom"),
            ("キッチン", "kitchen"),
            ("xyzzy", "room"),
            ("", "room"),
        ] {
            assert_eq!(types(&[label], Some("residential")).room_types, [expected], "{label}");
        }
    }

    #[test]
    fn the_domain_that_knows_most_names_is_taken() {
        assert_eq!(types(&["Kitchen", "Bathroom", "Bedroom 1", "Living room"], None).domain, "residential");
        assert_eq!(types(&["Patient room 1", "Nurse station", "Corridor", "Clean utility"], None).domain, "hospital");
        assert_eq!(types(&["Open office", "Meeting room", "Corridor", "Pantry"], None).domain, "office");
    }

    #[test]
    fn names_that_many_domains_know_decide_little() {
        for (labels, domain) in [
            (&["Office", "Meeting room", "Corridor", "Toilet", "Kitchenette"][..], "office"),
            (&["Office 1", "Office 2", "Reception", "WC", "Corridor"], "office"),
            (&["Kitchen", "Bathroom", "Corridor", "Living room"], "residential"),
            (&["Warehouse hall", "Loading dock", "Office", "Toilet"], "warehouse"),
            (&["Classroom 1", "Classroom 2", "Corridor", "Toilet", "Staff room"], "school"),
            (&["Ward", "Corridor"], "hospital"),
            (&["xyzzy", ""], "general"),
            (&[], "general"),
        ] {
            assert_eq!(types(labels, None).domain, domain, "{labels:?}");
        }
    }

    #[test]
    fn titles_decide_where_names_say_little() {
        assert_eq!(titled(&["coe", "lounge", "pantry"], &["office.building.yaml"], None).domain, "office");
        assert_eq!(titled(&["a", "b"], &["old_school"], None).domain, "school");
        assert_eq!(titled(&["Bedroom", "Bathroom", "Kitchen"], &["office"], None).domain, "residential");
    }

    #[test]
    fn a_type_that_the_user_says_must_be_known() {
        let said = |kind: &str| {
            let label = Label { text: "1.02".into(), kind: Some(kind.into()), said: true, ..Label::default() };
            understand(&[label], &[], Some("residential"), &Registry::builtin())
        };
        assert_eq!(said("bedroom").expect("a type").room_types, ["bedroom"]);
        assert_eq!(said("Schlafzimmer").expect("a word for one").room_types, ["bedroom"]);
        assert_eq!(said("room").expect("any room").room_types, ["room"]);
        let message = said("bedrom").expect_err("a slip").to_string();
        assert!(message.contains("1.02=bedrom") && message.contains("nearest are bedroom"), "{message}");
    }

    #[test]
    fn other_words_in_a_room_and_its_place_say_what_it_is() {
        let label = |text: &str, also: &[&str], hub: bool| Label {
            text: text.into(),
            also: also.iter().map(|t| (*t).into()).collect(),
            hub,
            ..Label::default()
        };
        let labels = [label("B 12", &["meeting room"], false), label("room_2", &[], true), label("Pantry", &[], true)];
        let known = understand(&labels, &[], Some("office"), &Registry::builtin()).expect("a known domain");
        assert_eq!(known.room_types[..2], ["meeting_room", "corridor"]);
        assert_eq!(known.names, ["meeting room", "room_2", "Pantry"]);
        assert!(known.room_types[2] != "corridor");
        assert!(known.notes.iter().any(|n| n.code == "circulation_guessed"));
    }
}
