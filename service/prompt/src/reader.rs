//! A prompt from its words to its brief.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

use d3dgen_language::{Lexicon, Reading, TokenKind};
use d3dgen_model::brief::{Ask, Bound, Brief, Fact, MAX_ASKS, PromptWords, ReadBy, RoomsAsk, Subject};
use d3dgen_model::gazetteer::{first_floor_is_ground, first_floor_is_ground_in};
use d3dgen_plugins::Registry;

use crate::building::{building, place, stretch};
use crate::facts::{Maker, Stated};
use crate::grammar::Grammar;
use crate::homes;
use crate::node::Node;
use crate::parse::{Applied, parse};
use crate::shown::shown;
use crate::storeys;
use crate::subjects::Known;
use crate::vocabulary::lexicon;

/// Reads prompts about the buildings of the domains that it was made with.
pub struct PromptReader {
    registry: Registry,
    lexicon: Arc<Lexicon>,
}

/// A rule that took words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Step {
    /// Name of the rule.
    pub rule: String,
    /// File of the grammar that it stands in.
    pub file: String,
    /// The words.
    pub words: String,
}

/// What came of a prompt.
#[derive(Debug, Clone)]
pub struct ReadPrompt {
    /// The facts.
    pub brief: Brief,
    /// Name of the language of the prompt when it is none that is read, in English: only words that languages share are understood.
    pub unread_language: Option<String>,
    /// Words read as others, as they are written and as they were read.
    pub misspelled: Vec<(String, String)>,
    /// Which rule took which words, in the order in which they did.
    pub steps: Vec<Step>,
    /// The facts in short, one for each of the brief.
    pub facts: Vec<String>,
    /// Names of rooms that no lexicon has and of which a part told the type of room, with that type.
    pub told_by_a_part: BTreeMap<String, String>,
}

impl PromptReader {
    /// Returns a reader that knows the words of these domains. The first one takes longer than reading a prompt; later ones
    /// of the same domains share its words.
    pub fn new(registry: &Registry) -> Self {
        let lexicon = registry.digest("prompt::lexicon", || lexicon(registry));
        Self { registry: registry.clone(), lexicon }
    }

    /// Reads a prompt. Every prompt has a brief, if only one that says what was not understood.
    pub fn read(&self, prompt: &str) -> ReadPrompt {
        let reading = self.lexicon.read(prompt);
        let grammar = Grammar::shipped();
        let leaves: Vec<Rc<Node>> = reading.chunks().iter().map(|c| Rc::new(Node::of(c, &reading))).collect();
        let (place, places) = place(&leaves, &reading);
        let leaves = without_places(leaves, &places);
        let building = building(&self.registry, &leaves, &reading);
        let leaves = named(leaves, &building.nodes, &places);
        let domain = building.first.as_ref().map(|b| b.domain.as_deref().unwrap_or(Known::stand_in()));
        let country = place.as_ref().map(|p| p.country_code.as_str());
        let first_is_ground = match country {
            Some(country) => first_floor_is_ground(country),
            None => reading.languages().first().is_some_and(|l| first_floor_is_ground_in(l)),
        };
        let building_type = building.first.as_ref().and_then(|b| b.building_type.as_deref());
        let known = Known::of(&self.registry, domain, building_type);
        let (nodes, applied) = parse(grammar, leaves.into_iter().map(|n| known.as_meant(n)).collect());
        let told = Rc::clone(&known.told_by_a_part);
        let (facts, spoken_of) = (Vec::new(), Vec::new());
        let mut maker = Maker { reading: &reading, known, first_is_ground, facts, spoken_of };
        nodes.iter().for_each(|n| {
            maker.add(n);
        });
        let facts = storeys::settled(maker.facts, building.first.as_ref());
        let (facts, named) = homes::named_among(facts);
        let (facts, mut spoken_of) = settled(facts);
        spoken_of.extend(named.into_iter().chain(maker.spoken_of));
        let brief = Brief {
            languages: reading.languages().iter().map(|l| (*l).to_owned()).collect(),
            building: building.first,
            other_buildings: building.others,
            place,
            ..Brief::of_prompt(prompt)
        };
        let brief = finished(brief, facts, &spoken_of, &reading);
        let facts = brief.asks.iter().map(|a| shown(&a.fact)).collect();
        ReadPrompt {
            brief,
            unread_language: reading.unread().map(str::to_owned),
            misspelled: misspelled(&reading),
            steps: steps(grammar, &applied, &reading),
            facts,
            told_by_a_part: told.take(),
        }
    }
}

fn misspelled(reading: &Reading) -> Vec<(String, String)> {
    let written = |m: &d3dgen_language::Misspelling| reading.text().get(m.bytes.clone()).unwrap_or_default().to_owned();
    reading.misspellings().iter().map(|m| (written(m), m.meant.clone())).collect()
}

fn steps(grammar: &Grammar, applied: &[Applied], reading: &Reading) -> Vec<Step> {
    let step = |a: &Applied| {
        let rule = &grammar.rules[a.rule];
        let words = reading.written(a.node.tokens.clone()).to_owned();
        Step { rule: rule.name.clone(), file: rule.file.clone(), words }
    };
    applied.iter().map(step).collect()
}

/// Takes the sense of a place from words that are not meant as one here: a "reading room" is not in Reading.
fn without_places(nodes: Vec<Rc<Node>>, places: &[usize]) -> Vec<Rc<Node>> {
    let of = |(i, node): (usize, Rc<Node>)| {
        if places.contains(&i) || !node.is("place", None) {
            return node;
        }
        let mut node = (*node).clone();
        node.senses.retain(|(class, _)| **class != *"place");
        Rc::new(node)
    };
    nodes.into_iter().enumerate().map(of).collect()
}

/// Leaves of words that name the building or the place only that, so that no rule makes a room of them.
fn named(nodes: Vec<Rc<Node>>, building: &[usize], places: &[usize]) -> Vec<Rc<Node>> {
    let of = |(i, node): (usize, Rc<Node>)| {
        let sense = match () {
            () if building.contains(&i) => "building",
            () if places.contains(&i) => "location",
            () => return node,
        };
        let mut node = (*node).clone();
        // "3-Zimmer-Wohnung" names a building and counts its rooms, "bungalow" its storeys
        node.senses.retain(|(class, _)| matches!(&**class, "shorthand" | "storeys" | "site"));
        node.senses.push((sense.into(), "".into()));
        Rc::new(node)
    };
    nodes.into_iter().enumerate().map(of).collect()
}

/// Returns true for rooms of which a number is told.
fn is_counted(rooms: &RoomsAsk) -> bool {
    rooms.count.bound != Bound::AtLeast || rooms.count.n > 2
}

/// Returns true for one room or object under two names.
pub(crate) fn is_same(a: &Subject, b: &Subject) -> bool {
    match (&a.id, &b.id) {
        (Some(a), Some(b)) => a == b,
        (None, None) => a.name.to_lowercase() == b.name.to_lowercase(),
        _ => false,
    }
}

/// Returns true where a room has in its name what another is called.
fn is_called_so(a: &Subject, b: &Subject) -> bool {
    let (a, b) = (a.name.to_lowercase(), b.name.to_lowercase());
    a.contains(&b) || b.contains(&a)
}

/// Returns the rooms or objects that a fact asks for.
fn subject_of(fact: &Fact) -> Option<&Subject> {
    match fact {
        Fact::Rooms(rooms) => Some(&rooms.room),
        Fact::Objects(objects) => Some(&objects.object),
        _ => None,
    }
}

fn rooms_of(stated: &Stated) -> Option<&RoomsAsk> {
    if let Fact::Rooms(rooms) = &stated.fact { Some(rooms) } else { None }
}

/// What is asked for somewhere in a prompt.
struct Elsewhere {
    /// Rooms and objects that are asked for, and rooms that come with each of others.
    asked: Vec<Subject>,
    /// Rooms whose number is told, with where.
    numbered: Vec<(Subject, Range<usize>)>,
}

impl Elsewhere {
    fn of(facts: &[Stated]) -> Self {
        let asked = facts.iter().filter(|f| !f.mention).filter_map(|f| subject_of(&f.fact));
        let with_each = facts.iter().filter_map(|f| rooms_of(f)?.each.as_ref());
        let numbered = facts.iter().filter_map(|f| Some((rooms_of(f)?, &f.tokens)));
        let numbered = numbered.filter(|(r, _)| is_counted(r) && r.count.n > 1 && !r.among);
        Self {
            asked: asked.chain(with_each).cloned().collect(),
            numbered: numbered.map(|(r, tokens)| (r.room.clone(), tokens.clone())).collect(),
        }
    }

    /// Returns true for words that only speak of what is asked for elsewhere or was `kept` before.
    fn has(&self, stated: &Stated, kept: &[Stated]) -> bool {
        let Some(subject) = subject_of(&stated.fact) else { return false };
        // "3 bedrooms ..., master bedroom with a balcony": one of them
        let open = rooms_of(stated).is_some_and(|r| !is_counted(r) && !r.among) && !stated.own;
        let one_of = || self.numbered.iter().any(|(room, at)| is_same(room, subject) && *at != stated.tokens);
        let kind = std::mem::discriminant(&stated.fact);
        // "beside the bride's waiting room": of several waiting rooms the one that is called so
        let meant = |a: &Subject| is_same(a, subject) && (!stated.own || is_called_so(a, subject));
        let again = |k: &Stated| std::mem::discriminant(&k.fact) == kind && subject_of(&k.fact).is_some_and(meant);
        let spoken_of = || self.asked.iter().any(meant) || kept.iter().any(again);
        open && one_of() || stated.mention && spoken_of()
    }
}

/// Drops what is asked for elsewhere already, and doubles; returns what is left, and the words of what is not.
fn settled(facts: Vec<Stated>) -> (Vec<Stated>, Vec<Range<usize>>) {
    let elsewhere = Elsewhere::of(&facts);
    let mut kept: Vec<Stated> = Vec::new();
    let mut spoken_of = Vec::new();
    for stated in facts {
        let double = kept.iter().any(|k| k.fact == stated.fact && k.tokens == stated.tokens);
        if double || elsewhere.has(&stated, &kept) {
            spoken_of.push(stated.tokens);
        } else {
            kept.push(stated);
        }
    }
    kept.sort_by_key(|f| (f.tokens.start, f.tokens.end));
    (kept, spoken_of)
}

/// Puts facts into a brief, and accounts for every word; `spoken_of` are words of what is asked for by others.
fn finished(mut brief: Brief, facts: Vec<Stated>, spoken_of: &[Range<usize>], reading: &Reading) -> Brief {
    let mut covered: BTreeSet<usize> = spoken_of.iter().cloned().flatten().collect();
    for (i, stated) in facts.into_iter().take(MAX_ASKS).enumerate() {
        covered.extend(stated.tokens.clone());
        covered.extend(stated.also.clone().into_iter().flatten());
        let mut words: Vec<PromptWords> =
            [Some(stated.tokens), stated.also].into_iter().flatten().filter_map(|t| stretch(reading, t)).collect();
        words.sort();
        brief.asks.push(Ask { id: format!("ask_{}", i + 1), words, read_by: ReadBy::Rules, fact: stated.fact });
    }
    let named = brief.building.iter().flat_map(|b| &b.words).chain(brief.place.iter().flat_map(|p| &p.words));
    let named: Vec<(u32, u32)> = named.map(|w| (w.start, w.end)).collect();
    // "a dining room. There are six chairs in the room": that one
    let one_room = brief.asks.iter().filter(|a| matches!(a.fact, Fact::Rooms(_))).count() == 1;
    let chunks = reading.chunks();
    let definite = |at: usize| at.checked_sub(1).is_some_and(|before| chunks[before].is("particle", "article"));
    let open = chunks.iter().enumerate().filter(|(at, chunk)| {
        let spoken_of = one_room && chunk.is("room_word", "room") && definite(*at);
        let tokens = &reading.tokens()[chunk.tokens.clone()];
        let within = |t: &d3dgen_language::Token| {
            named.iter().any(|(s, e)| *s as usize <= t.chars.start && t.chars.end <= *e as usize)
        };
        let mark = tokens.iter().all(|t| t.kind == TokenKind::Mark);
        // "home" in "a flat ... works from home": the building once more
        let again = brief.building.as_ref().and_then(|b| b.domain.as_deref()).is_some_and(|d| chunk.is("domain", d));
        let small = chunk.has("particle") || chunk.has("classifier") || again || spoken_of;
        !mark && !small && !chunk.tokens.clone().all(|t| covered.contains(&t)) && !tokens.iter().all(within)
    });
    let mut left: Vec<Range<usize>> = Vec::new();
    for (_, chunk) in open {
        match left.last_mut() {
            Some(last) if last.end == chunk.tokens.start => last.end = chunk.tokens.end,
            _ => left.push(chunk.tokens.clone()),
        }
    }
    let left = left.into_iter().map(|tokens| with_noun(tokens, reading));
    brief.not_understood = left.filter_map(|tokens| stretch(reading, tokens)).collect::<Vec<PromptWords>>();
    brief
}

/// Returns words that were not understood with the noun beside them where they are a number alone: "phone booths (4", so that one
/// sees what was lost.
fn with_noun(tokens: Range<usize>, reading: &Reading) -> Range<usize> {
    let chunks = reading.chunks();
    let Some(at) = chunks.iter().position(|c| c.tokens.contains(&tokens.start)) else { return tokens };
    if chunks[at].number.is_none() || tokens.end > chunks[at].tokens.end {
        return tokens;
    }
    let is_noun = |c: &d3dgen_language::Chunk| {
        let mark = reading.tokens()[c.tokens.start].kind == TokenKind::Mark;
        !mark && c.number.is_none() && !c.has("particle") && !c.has("classifier")
    };
    let ends = |c: &d3dgen_language::Chunk| [",", ";", "."].contains(&reading.written(c.tokens.clone()));
    let near = |c: &&d3dgen_language::Chunk| !ends(c);
    let before = chunks[..at].iter().rev().take_while(near).find(|c| is_noun(c));
    let after = chunks[at + 1..].iter().take_while(near).find(|c| is_noun(c));
    match (before, after) {
        (_, Some(noun)) if noun.tokens.start == tokens.end => tokens.start..noun.tokens.end,
        (Some(noun), _) => noun.tokens.start..tokens.end,
        (None, Some(noun)) => tokens.start..noun.tokens.end,
        (None, None) => tokens,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every example of every rule is read as it says, and by that rule.
    #[test]
    fn the_examples_of_the_rules_are_read_as_they_say() {
        let reader = PromptReader::new(&Registry::builtin());
        let mut wrong = Vec::new();
        for rule in &Grammar::shipped().rules {
            for example in &rule.examples {
                let read = reader.read(&example.text);
                let sorted = |facts: &[String]| {
                    let mut facts = facts.to_vec();
                    facts.sort();
                    facts
                };
                if sorted(&read.facts) != sorted(&example.facts) {
                    wrong.push(format!(
                        "{} `{}`: `{}`\n  reads {:?}\n  wants {:?}",
                        rule.file, rule.name, example.text, read.facts, example.facts
                    ));
                } else if !read.steps.iter().any(|s| s.rule == rule.name) {
                    let steps: Vec<&str> = read.steps.iter().map(|s| s.rule.as_str()).collect();
                    wrong.push(format!("{} `{}`: `{}` is read by {steps:?}", rule.file, rule.name, example.text));
                }
            }
        }
        assert!(wrong.is_empty(), "{} examples:\n{}", wrong.len(), wrong.join("\n"));
    }
}
