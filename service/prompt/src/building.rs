//! The kind of building and the place that a prompt is about.

use std::collections::BTreeMap;
use std::rc::Rc;

use d3dgen_language::{Reading, TokenKind};
use d3dgen_model::brief::{AskedBuilding, AskedPlace, PromptWords};
use d3dgen_plugins::Registry;

use crate::node::Node;
use crate::places::{is_name, parts};

/// How sure a kind is that is named where a building is named.
const NAMED: f64 = 1.0;
/// How sure a kind is that is named later.
const LATER: f64 = 0.6;
/// How sure a kind is that only tells more of another: the airport of an airport hotel.
const TELLS_MORE: f64 = 0.6;
/// Small words between two kinds of which one tells more of the other, at most: "office of the brewery".
const MOST_BETWEEN: usize = 2;
/// How sure a kind is whose word is also a room.
const ROOM_TOO: f64 = 0.8;
/// What an object says of the building it stands in, beside a room.
const THING: f64 = 0.5;
/// How sure a domain is that most rooms suggest.
const SUGGESTED: f64 = 0.5;

/// A node that names the building, and what it names.
struct Named {
    node: usize,
    building: AskedBuilding,
    /// True where it only tells more of another kind that stands beside it.
    tells_more: bool,
}

/// The kind of building, the next best ones, and the nodes that name it.
#[derive(Debug, Default)]
pub(crate) struct Building {
    pub first: Option<AskedBuilding>,
    pub others: Vec<AskedBuilding>,
    /// Nodes that are about nothing else.
    pub nodes: Vec<usize>,
}

/// Returns the kind of building that the words name, or that the rooms suggest.
pub(crate) fn building(registry: &Registry, nodes: &[Rc<Node>], reading: &Reading) -> Building {
    let head = nodes.iter().position(|n| ends_head(n)).unwrap_or(nodes.len());
    let mut named: Vec<Named> = Vec::new();
    for (i, node) in nodes.iter().enumerate() {
        let Some(confidence) = confidence(nodes, i, head, reading) else { continue };
        named.extend(meant(registry, node, reading).into_iter().take(3).enumerate().map(|(n, mut building)| {
            building.confidence = confidence * if n == 0 { 1.0 } else { 0.5 };
            let tells_more = among_kinds(nodes, i, head, reading) == Some(Among::TellsMore);
            Named { node: i, building, tells_more }
        }));
    }
    // surest first; of equal ones a kind before a mere domain, then the longer name, then the earlier one
    let rank = |n: &Named| (n.building.confidence, n.building.building_type.is_some(), nodes[n.node].tokens.len());
    named.sort_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)).then(b.2.cmp(&a.2))
    });
    let mut named = named.into_iter();
    let Some(first) = named.next() else {
        let first = suggested(registry, nodes);
        return Building { first, ..Building::default() };
    };
    let mut found = Building { nodes: vec![first.node], first: Some(first.building), others: Vec::new() };
    named.for_each(|next| found.add(next, nodes, head));
    found.first.as_mut().into_iter().for_each(|f| f.words.sort());
    found
}

/// Returns how sure a word is to name the building, if it may; `head` is where the words end that do.
fn confidence(nodes: &[Rc<Node>], i: usize, head: usize, reading: &Reading) -> Option<f64> {
    let node = &nodes[i];
    // "staff" of an office names those in it
    if refused(nodes, i) || node.is("person", None) {
        return None;
    }
    let room_too = is_room_too(node) || node.is("room_word", None);
    let place = if i < head || i == 0 { NAMED } else { LATER };
    // a room that a list names is a room: "shop", "gym", "library"
    let listed = i >= head && i > 0;
    let counted = i > 0 && nodes[i - 1].number.is_some_and(|n| n > 1.0);
    // "botenloods", "clubbar": nor does a part of a word name a building there
    if listed && is_part_of_word(nodes, i, reading) {
        return None;
    }
    // "four bankjes" in a list are no bank
    if listed && counted || room_too && (listed || counted) {
        return None;
    }
    Some(match among_kinds(nodes, i, head, reading) {
        Some(Among::Head) => place,
        Some(Among::TellsMore) => place * TELLS_MORE,
        None if room_too => place * ROOM_TOO,
        None => place,
    })
}

/// Returns true for a part of a longer word, in scripts that set spaces between words.
fn is_part_of_word(nodes: &[Rc<Node>], i: usize, reading: &Reading) -> bool {
    let is_word = |n: &Rc<Node>| reading.tokens()[n.tokens.start].kind == TokenKind::Word;
    let goes_on = |a: usize| nodes.get(a..a + 2).is_some_and(|n| n.iter().all(is_word) && n[1].joined);
    goes_on(i) || i.checked_sub(1).is_some_and(goes_on)
}

/// What a kind is beside others that the same name has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Among {
    /// What is built: the hotel of an "airport hotel", the office of the "bureaux d'un institut".
    Head,
    /// What only tells more of that.
    TellsMore,
}

/// Returns what a kind is among those that it stands beside; none where it stands alone.
fn among_kinds(nodes: &[Rc<Node>], i: usize, head: usize, reading: &Reading) -> Option<Among> {
    let named = nodes.get(..head).filter(|named| i < named.len())?;
    let before = (0..i).rev().take(1 + MOST_BETWEEN).find(|j| is_kind(&named[*j]));
    let after = (i + 1..named.len()).take(1 + MOST_BETWEEN).find(|j| is_kind(&named[*j]));
    let decides = |a: usize, b: usize| is_last_built(&named[a..=b], reading);
    let over_next = after.and_then(|j| decides(i, j)).map(|last| !last);
    let over_last = before.and_then(|j| decides(j, i));
    match (over_last, over_next) {
        (None, None) => None,
        (Some(false), _) | (_, Some(false)) => Some(Among::TellsMore),
        _ => Some(Among::Head),
    }
}

fn is_kind(node: &Node) -> bool {
    node.is("kind", None) || node.is("domain", None)
}

/// Returns whether of the kinds at both ends of some words the last is what is built; none where they are no one name.
fn is_last_built(words: &[Rc<Node>], reading: &Reading) -> Option<bool> {
    let (first, between) = (words.first()?, words.get(1..words.len() - 1)?);
    let owns = between.iter().any(|n| n.is("particle", Some("of")));
    let small = |n: &Rc<Node>| n.is("particle", Some("of")) || n.is("particle", Some("article"));
    match between {
        [] => Some(first.head_last),
        _ if !between.iter().all(small) => None,
        _ if owns => Some(reading.owner_first(first.tokens.start)),
        // "Büro einer Brauerei"
        _ => Some(false),
    }
}

/// Returns true for a word that names a room or an object as well.
fn is_room_too(node: &Node) -> bool {
    node.is("room", None) || node.is("object", None)
}

impl Building {
    /// Takes one more kind that is named: the same once more, or a next best one.
    fn add(&mut self, next: Named, nodes: &[Rc<Node>], head: usize) {
        let same = self.first.as_ref().is_some_and(|f| f.domain == next.building.domain);
        // "hospital ward", "family house": one building, said twice; an "airport hotel" has one name
        let one_name = same && !is_room_too(&nodes[next.node]) || next.tells_more;
        if one_name && next.node < head.max(1) && !self.nodes.contains(&next.node) {
            self.nodes.push(next.node);
            self.first.as_mut().into_iter().for_each(|f| f.words.extend(next.building.words.clone()));
        }
        let new = |b: &AskedBuilding| (b.domain.clone(), b.building_type.clone(), b.name.clone());
        let known = self.others.iter().chain(&self.first).any(|o| new(o) == new(&next.building));
        if !known && self.others.len() < 3 {
            self.others.push(next.building);
        }
    }
}

/// Returns true for what ends the words that name the building: "with", a colon, a comma.
fn ends_head(node: &Node) -> bool {
    ["colon", "comma", "semicolon", "dot"].iter().any(|m| node.is("mark", Some(m)))
        || (node.is("particle", Some("with")) && !node.is("particle", Some("from")))
}

/// Returns true for a kind that is not to be: "not a hotel".
fn refused(nodes: &[Rc<Node>], at: usize) -> bool {
    let before = nodes[..at].iter().rev().take(2);
    before
        .filter(|n| n.is("particle", None))
        .any(|n| ["no", "not", "instead"].iter().any(|v| n.is("particle", Some(v))))
}

/// Returns what a node may mean as a building.
fn meant(registry: &Registry, node: &Node, reading: &Reading) -> Vec<AskedBuilding> {
    let words = words(reading, node);
    let of = |domain: Option<&str>, kind: Option<&str>| AskedBuilding {
        domain: domain.map(str::to_owned),
        building_type: kind.map(str::to_owned),
        name: reading.written(node.tokens.clone()).to_owned(),
        confidence: 0.0,
        words: words.clone(),
    };
    let mut found: Vec<AskedBuilding> = Vec::new();
    for value in node.values("kind") {
        let building = match value.split_once(':') {
            Some((domain, kind)) => of(Some(domain), Some(kind)),
            None => match registry.iter().find(|p| p.domain().building_types.iter().any(|b| b.id == value)) {
                Some(plugin) => of(Some(plugin.id()), Some(value)),
                None => of(None, Some(value)),
            },
        };
        if !found.contains(&building) {
            found.push(building);
        }
    }
    // a kind that some domain knows is more than one that none does
    found.sort_by_key(|b| b.domain.is_none());
    found.extend(
        node.values("domain")
            .filter(|d| found.iter().all(|f| f.domain.as_deref() != Some(*d)))
            .map(|d| of(Some(d), None))
            .collect::<Vec<_>>(),
    );
    found
}

/// Returns the domain that knows most of the rooms and objects, when no words name a building.
fn suggested(registry: &Registry, nodes: &[Rc<Node>]) -> Option<AskedBuilding> {
    let mut votes: BTreeMap<&str, (f64, usize)> = BTreeMap::new();
    for (order, plugin) in registry.iter().enumerate() {
        let knows = |id: &str| plugin.domain().room_type(id).is_some();
        let owns = |id: &str| plugin.domain().object(id).is_some();
        let vote = |n: &Rc<Node>| match () {
            () if n.is("shorthand", None) => {
                if order == 0 {
                    2.0
                } else {
                    0.0
                }
            }
            () if n.is("object", None) => {
                if n.values("object").any(owns) || n.values("room").any(knows) {
                    THING
                } else {
                    0.0
                }
            }
            () => f64::from(u8::from(n.values("room").any(knows))),
        };
        let votes_of = nodes.iter().map(vote);
        votes.insert(plugin.id(), (votes_of.sum(), order));
    }
    let (domain, (most, _)) = votes.into_iter().max_by(|a, b| a.1.0.total_cmp(&b.1.0).then(b.1.1.cmp(&a.1.1)))?;
    let title = registry.get(domain)?.domain().title.clone();
    (most > 0.0).then(|| AskedBuilding {
        domain: Some(domain.to_owned()),
        building_type: None,
        name: title,
        confidence: SUGGESTED,
        words: Vec::new(),
    })
}

/// Returns the place that the words name, and the nodes that do.
pub(crate) fn place(nodes: &[Rc<Node>], reading: &Reading) -> (Option<AskedPlace>, Vec<usize>) {
    let mut place: Option<AskedPlace> = None;
    let mut taken = Vec::new();
    for (i, node) in nodes.iter().enumerate() {
        let Some(value) = node.values("place").next() else { continue };
        let parts = parts(value);
        let before = i.checked_sub(1).map(|b| &nodes[b]);
        let led = before.is_some_and(|b| ["in", "at", "from", "to", "of"].iter().any(|v| b.is("particle", Some(v))));
        let other = node.senses.iter().any(|(class, _)| &**class != "place");
        let latin = node.text.chars().any(|c| c.is_ascii_alphabetic());
        // "Nice", "Reading", and words that are something else as well
        if (parts.strict || other) && latin && !(led && node.capital) {
            continue;
        }
        // "malto" is no form of Malta
        if latin && !led && !node.capital && !is_name(&node.text) {
            continue;
        }
        let Some(country) = parts.country else { continue };
        let city = parts.city.then(|| reading.written(node.tokens.clone()).to_owned());
        match &mut place {
            None => {
                let division_code = parts.division.map(str::to_owned);
                place = Some(AskedPlace {
                    country_code: country.to_owned(),
                    division_code,
                    city,
                    words: words(reading, node),
                });
            }
            Some(place) if place.country_code == country => {
                place.words.extend(words(reading, node));
                place.city = place.city.take().or(city);
                place.division_code = place.division_code.take().or(parts.division.map(str::to_owned));
            }
            // a country beside a city of its name elsewhere: the country is meant
            Some(place) if place.city.is_some() && !parts.city => {
                place.country_code = country.to_owned();
                place.words.extend(words(reading, node));
            }
            Some(_) => continue,
        }
        taken.push(i);
    }
    (place, taken)
}

/// Returns the words of a node.
pub(crate) fn words(reading: &Reading, node: &Node) -> Vec<PromptWords> {
    stretch(reading, node.tokens.clone()).into_iter().collect()
}

/// Returns a run of tokens as words of the prompt.
pub(crate) fn stretch(reading: &Reading, tokens: std::ops::Range<usize>) -> Option<PromptWords> {
    let (first, last) = (reading.tokens().get(tokens.start)?, reading.tokens().get(tokens.end.checked_sub(1)?)?);
    let (start, end) = (first.chars.start as u32, last.chars.end as u32);
    Some(PromptWords { start, end, text: reading.written(tokens).to_owned() })
}
