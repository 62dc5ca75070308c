//! The words of knowledge bases, read once from `data/`: topics, kinds of source, spaces, ways of measuring.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use serde::Deserialize;
use serde::de::DeserializeOwned;

/// One of the eight topics.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Topic {
    /// As knowledge bases spell it.
    pub id: String,
    /// For people.
    pub title: String,
    /// What a model is asked to look up.
    pub question: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TopicRule {
    topic: String,
    #[serde(default)]
    spaces: Vec<String>,
    #[serde(default)]
    names: Vec<String>,
    #[serde(default)]
    units: Vec<String>,
    #[serde(default)]
    words: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Topics {
    topic: Vec<Topic>,
    rules: Vec<TopicRule>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SourceType {
    id: String,
    confidence: String,
    aliases: Vec<String>,
    #[serde(default)]
    hosts: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SourceTypes {
    source_type: Vec<SourceType>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Spaces {
    space_types: BTreeMap<String, String>,
    by_domain: BTreeMap<String, BTreeMap<String, String>>,
    conditions: BTreeMap<String, String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Basis {
    #[serde(default)]
    per: Vec<String>,
    #[serde(default)]
    units: Vec<String>,
    #[serde(default)]
    names: Vec<String>,
    #[serde(default)]
    spaces: Vec<String>,
    basis: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Bases {
    basis: Vec<Basis>,
}

struct Vocabulary {
    topics: Topics,
    source_types: SourceTypes,
    spaces: Spaces,
    bases: Bases,
}

fn shared() -> &'static Vocabulary {
    fn read<T: DeserializeOwned>(text: &str) -> T {
        toml::from_str(text).expect("shipped data is tested")
    }
    static SHARED: OnceLock<Vocabulary> = OnceLock::new();
    SHARED.get_or_init(|| Vocabulary {
        topics: read(include_str!("../../data/topics.toml")),
        source_types: read(include_str!("../../data/source_types.toml")),
        spaces: read(include_str!("../../data/space_types.toml")),
        bases: read(include_str!("../../data/measurement_bases.toml")),
    })
}

/// Returns the eight topics in the paper's order.
pub fn topics() -> impl Iterator<Item = &'static Topic> {
    shared().topics.topic.iter()
}

/// Returns the seven kinds of source, most binding first.
pub fn source_types() -> impl Iterator<Item = &'static str> {
    shared().source_types.source_type.iter().map(|t| t.id.as_str())
}

/// Returns the kind of source that a word stands for; `None` for a word nobody has listed.
pub fn source_type(word: &str) -> Option<&'static str> {
    let word = word.trim().to_lowercase().replace([' ', '-'], "_");
    let fits = |t: &&SourceType| t.id == word || t.aliases.contains(&word);
    shared().source_types.source_type.iter().find(fits).map(|t| t.id.as_str())
}

/// Returns the kind of a page by who publishes it, where that is known.
pub fn source_type_of_host(host: &str) -> Option<&'static str> {
    let host = host.to_lowercase();
    let below = |known: &String| host == *known || host.strip_suffix(known.as_str()).is_some_and(|h| h.ends_with('.'));
    shared().source_types.source_type.iter().find(|t| t.hosts.iter().any(below)).map(|t| t.id.as_str())
}

/// Returns how binding a kind is, 0 the most, and the most that its figures can be trusted.
pub fn rank_and_confidence(kind: Option<&str>) -> (usize, &'static str) {
    let list = &shared().source_types.source_type;
    let found = list.iter().enumerate().find(|(_, t)| Some(t.id.as_str()) == kind);
    found.map_or((list.len(), "medium"), |(rank, t)| (rank, t.confidence.as_str()))
}

/// Returns the `space_type` of a space as found, and what its name says beyond that.
pub fn space_type<'a>(domain: &str, space: &'a str) -> (&'a str, Option<&'static str>) {
    if space.is_empty() {
        return ("unspecified", None);
    }
    let spaces = &shared().spaces;
    if let Some(own) = spaces.by_domain.get(domain).and_then(|d| d.get(space)) {
        return (own, None);
    }
    (spaces.space_types.get(space).map_or(space, String::as_str), spaces.conditions.get(space).map(String::as_str))
}

/// What the topic and the way of measuring of a rule are decided from.
#[derive(Debug, Clone, Copy)]
pub struct Traits<'a> {
    /// What is limited.
    pub name: &'a str,
    /// Space as found, and its `space_type`.
    pub spaces: [&'a str; 2],
    /// SI unit.
    pub unit: &'a str,
    /// What it is given for (`bed`), empty for the whole.
    pub per: &'a str,
    /// The quoted sentences.
    pub words: &'a str,
}

fn has(list: &[String], word: &str) -> bool {
    list.is_empty() || list.iter().any(|known| known == word)
}

fn holds(list: &[String], text: &str) -> bool {
    list.is_empty() || list.iter().any(|part| text.contains(part.as_str()))
}

impl Traits<'_> {
    /// Returns the topic.
    pub fn topic(&self) -> &'static str {
        let text: String =
            self.words.to_lowercase().chars().map(|c| if c.is_alphanumeric() { c } else { ' ' }).collect();
        let text = format!(" {} ", text.split_whitespace().collect::<Vec<_>>().join(" "));
        let fits = |rule: &&TopicRule| {
            (rule.spaces.is_empty() || self.spaces.iter().any(|s| !s.is_empty() && has(&rule.spaces, s)))
                && holds(&rule.names, self.name)
                && has(&rule.units, self.unit)
                && (rule.words.is_empty() || rule.words.iter().any(|w| text.contains(&format!(" {w} "))))
        };
        let rule = shared().topics.rules.iter().find(fits);
        rule.map_or("room_size", |r| r.topic.as_str())
    }

    /// Returns how the figure is measured.
    pub fn basis(&self) -> String {
        let fits = |b: &&Basis| {
            (if b.per.is_empty() { self.per.is_empty() } else { has(&b.per, self.per) })
                && has(&b.units, self.unit)
                && holds(&b.names, self.name)
                && (b.spaces.is_empty() || self.spaces.iter().any(|s| has(&b.spaces, s)))
        };
        match shared().bases.basis.iter().find(fits) {
            Some(known) => known.basis.clone(),
            None if self.per.is_empty() => self.name.to_owned(),
            None if self.unit == "count" => format!("{}s per {}", self.per, self.name.trim_end_matches('s')),
            None => format!("per_{}", self.per),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_data_is_consistent() {
        assert_eq!((topics().count(), source_types().count()), (8, 7));
        for rule in &shared().topics.rules {
            assert!(topics().any(|t| t.id == rule.topic), "{}", rule.topic);
        }
        for kind in &shared().source_types.source_type {
            assert!(d3dgen_model::knowledge::CONFIDENCES.contains(&kind.confidence.as_str()));
        }
    }

    #[test]
    fn words_for_kinds_of_source() {
        assert_eq!(source_type("Verordnung"), Some("regulation"));
        assert_eq!(source_type("data sheet"), Some("manufacturer_doc"));
        assert_eq!(source_type("rumor"), None);
        assert_eq!(source_type_of_host("www.gesetze-im-internet.de"), Some("regulation"));
        assert_eq!(source_type_of_host("notgesetze-im-internet.de"), None);
    }

    #[test]
    fn topics_and_bases() {
        let traits = |name, space, unit, per, words| Traits {
            name,
            spaces: [space, space_type("hospital", space).0],
            unit,
            per,
            words,
        };
        for (given, topic, basis) in [
            (
                traits("width", "corridor", "m", "", "Corridors are 1.5 m wide."),
                "convenience_accessibility",
                "clear_width",
            ),
            (traits("width", "door", "m", "", ""), "convenience_accessibility", "clear_opening"),
            (traits("floor_area", "patient_room", "m^2", "bed", ""), "room_size", "per_bed"),
            (traits("toilets", "toilet", "count", "bed", ""), "room_types_support_spaces", "beds per toilet"),
            (traits("toilets", "toilet", "count", "person", ""), "room_types_support_spaces", "persons per WC"),
            (traits("clearance", "charging_dock", "m", "", ""), "robot_placement_charging_circulation", "front"),
            (
                traits("width", "corridor", "m", "", "Flure für Roboter."),
                "robot_placement_charging_circulation",
                "clear_width",
            ),
            (traits("illuminance", "desk", "lx", "", ""), "energy_hvac_daylight", "illuminance"),
            (traits("travel_distance", "room", "m", "", ""), "fire_safety_evacuation", "walking_path"),
        ] {
            assert_eq!((given.topic(), given.basis().as_str()), (topic, basis), "{given:?}");
        }
    }
}
