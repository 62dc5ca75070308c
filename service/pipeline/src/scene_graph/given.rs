//! Scene graphs of plans that people bring: rooms get their types from the words on the plan, edges from its doors.
//!
//! What such a plan gets wrong stays as it is: the graph says what there is, and the hard rules say what it breaks.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use d3dgen_model::domain::{Domain, GENERIC_ROOM_TYPE};
use d3dgen_model::floorplan::{DoorKind, Floorplan};
use d3dgen_model::scene_graph::{Connector, GraphEdge, GraphRoom, Note, Occupancy, Robot, SceneGraph};
use d3dgen_plugins::Registry;

use super::places::{self, note};
use super::reading::refused;
use super::rooms::wished_assets;
use super::text::{Phrases, fold, tokens};
use super::wishes::CHARGING;
use super::words::words;
use crate::Error;

/// Reason of the edges of a brought plan.
const BY_PLAN: &str = "given_plan";
/// Shortest end of a compound word that names a room, letters.
const LEAST_ENDING: usize = 5;

/// What a plan says about a room.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Label {
    /// The name on the plan.
    pub text: String,
    /// What the file says it is, where it says so beside the name; counts first.
    pub kind: Option<String>,
}

/// Labels understood.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Understood {
    /// Domain id.
    pub domain: String,
    /// A room type of the domain for each label; the generic one where the words are not known.
    pub room_types: Vec<String>,
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
    /// Kinds of robots, each once (`cleaning`, `delivery`, `service`, `transport`).
    pub robots: Vec<String>,
    /// Radius of the largest robot, m.
    pub robot_radius_m: Option<f64>,
    /// What was assumed on the way here.
    pub notes: Vec<Note>,
}

/// The room words of a domain in all languages.
pub(super) struct Names<'a> {
    domain: &'a Domain,
    languages: Vec<Phrases<String>>,
}

impl<'a> Names<'a> {
    /// Returns the words of a domain.
    pub(super) fn new(domain: &'a Domain) -> Self {
        let of = |language: &String| {
            let mut phrases = Phrases::new(language);
            for room in domain.room_types.iter().filter(|r| r.id != GENERIC_ROOM_TYPE) {
                if language == "en" {
                    phrases.insert(&room.id.replace('_', " "), room.id.clone());
                }
                room.keywords.get(language).into_iter().flatten().for_each(|w| phrases.insert(w, room.id.clone()));
            }
            phrases
        };
        Self { domain, languages: words().languages.keys().map(of).collect() }
    }

    /// Returns the room type that the longest words of a label name, and how many letters they have.
    pub(super) fn find(&self, label: &str) -> Option<(&str, usize)> {
        if self.domain.room_type(label).is_some_and(|r| r.id != GENERIC_ROOM_TYPE) {
            return self.domain.room_type(label).map(|r| (r.id.as_str(), label.len()));
        }
        let list = tokens(&spaced(label));
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
                if let Some((end, id)) = phrases.longest_at(&list, i) {
                    hear(id, list[i..end].iter().map(|t| t.text.chars().count()).sum());
                }
                if let Some((id, cut)) = phrases.ending(&list[i].text, LEAST_ENDING) {
                    hear(id, list[i].text.len() - cut);
                }
            }
        }
        best
    }

    fn room_type(&self, label: &Label) -> Option<(&str, usize)> {
        label.kind.as_deref().and_then(|k| self.find(k)).or_else(|| self.find(&label.text))
    }
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

/// Finds the room types of labels, in a domain or in the one that knows most of them.
///
/// # Errors
/// `Refused` for a domain that is not registered.
pub fn understand(labels: &[Label], domain: Option<&str>, registry: &Registry) -> Result<Understood, Error> {
    let mut notes = Vec::new();
    let names = match domain {
        Some(id) => {
            let plugin = registry.get(id).ok_or_else(|| {
                let known: Vec<&str> = registry.iter().map(|p| p.id()).collect();
                refused(format!("domain `{id}` is not known; known are {}", known.join(", ")))
            })?;
            Names::new(plugin.domain())
        }
        None => {
            // of domains that know as many names in as many letters, the one more of whose programs have them, and of those
            // the one that knows fewer rooms besides: it is about less
            type Rank = (usize, usize, usize, Reverse<usize>);
            let mut best: Option<(Rank, Names)> = None;
            for plugin in registry.iter() {
                let names = Names::new(plugin.domain());
                let found: Vec<(&str, usize)> = labels.iter().filter_map(|l| names.room_type(l)).collect();
                let letters = found.iter().map(|f| f.1).sum();
                let programs = &names.domain.programs;
                let with = |id: &str| programs.iter().filter(|p| p.rooms.iter().any(|e| e.room_type == id)).count();
                let usual = found.iter().map(|f| 1000 * with(f.0) / programs.len().max(1)).sum();
                let rank = (found.len(), letters, usual, Reverse(names.domain.room_types.len()));
                if best.as_ref().is_none_or(|b| rank > b.0) {
                    best = Some((rank, names));
                }
            }
            let ((known, ..), names) = best.ok_or_else(|| refused("no domain is registered".into()))?;
            let message = format!(
                "domain {} knows {known} of {} names of rooms and was taken; choose another with --domain",
                names.domain.id,
                labels.len()
            );
            notes.push(note("default_domain", message));
            names
        }
    };
    let mut unknown: Vec<String> = Vec::new();
    let mut room_types = Vec::with_capacity(labels.len());
    for label in labels {
        match names.room_type(label) {
            Some((id, _)) => room_types.push(id.to_owned()),
            None => {
                let text = if label.text.is_empty() { label.kind.as_deref().unwrap_or_default() } else { &label.text };
                unknown.push(if text.is_empty() { "rooms without a name".into() } else { format!("`{text}`") });
                room_types.push(GENERIC_ROOM_TYPE.to_owned());
            }
        }
    }
    unknown.dedup();
    if !unknown.is_empty() {
        let more = unknown.len().saturating_sub(12);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let list = unknown.iter().take(12).cloned().collect::<Vec<_>>().join(", ");
        let message =
            format!("{} names no room of {list}{more}; they are of the type `{GENERIC_ROOM_TYPE}`", names.domain.id);
        notes.push(note("unknown_label", message));
    }
    Ok(Understood { domain: names.domain.id.clone(), room_types, notes })
}

/// Returns the scene graph of a plan as it is: its rooms, and an edge for each pair that a door or passage joins.
///
/// # Errors
/// `Refused` for domains, countries and robots that are not known.
pub fn of_plan(plan: &Floorplan, brought: &Brought, registry: &Registry) -> Result<SceneGraph, Error> {
    let plugin = registry.get(&brought.domain);
    let domain =
        plugin.map(|p| p.domain()).ok_or_else(|| refused(format!("domain `{}` is not known", brought.domain)))?;
    let country_code = match &brought.country {
        None => None,
        Some(country) => Some(places::code_of(country).ok_or_else(|| {
            refused(format!("country `{country}` is not known; give an ISO 3166-1 code such as DE or US"))
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
                area_range_m2: [range.min, range.max],
                wished_assets: wished_assets(domain, kind, &[]),
                occupants: None,
                circulation: room.circulation,
                requested: true,
                entrance: entrance == Some(&room.room_id),
                locked: true,
                level: room.level,
                unit: None,
            }
        })
        .collect();
    Ok(SceneGraph {
        version: 1,
        prompt: brought.title.clone(),
        seed: brought.seed,
        domain: domain.id.clone(),
        building_type: None,
        country_code,
        language: "en".into(),
        area_m2: None,
        occupancy: Occupancy::default(),
        accessible: false,
        style: d3dgen_model::style::Style::default(),
        rooms,
        edges: edges(plan),
        apart: Vec::new(),
        forbidden_room_types: Vec::new(),
        robots: robots(plan, brought)?,
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
        let body = words().robot_kinds.get(&kind).ok_or_else(|| {
            let known: Vec<&str> = words().robot_kinds.keys().map(String::as_str).collect();
            refused(format!("robot `{kind}` is not known; known are {}", known.join(", ")))
        })?;
        let radius_m = brought.robot_radius_m.unwrap_or(body.radius_m);
        Ok(Robot { kind, count: 1, radius_m, height_m: body.height_m, charging, body: None })
    };
    kinds.into_iter().map(robot).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn types(labels: &[&str], domain: Option<&str>) -> Understood {
        let labels: Vec<Label> = labels.iter().map(|t| Label { text: (*t).into(), kind: None }).collect();
        understand(&labels, domain, &Registry::builtin()).expect("a known domain")
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
}
