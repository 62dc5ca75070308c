//! What the rooms and buildings of one domain are called, made ready to look labels up in.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use d3dgen_model::domain::{Domain, GENERIC_ROOM_TYPE, Program};

use super::text::{Phrase, forms, is_wide, stem_of};

/// What a label means in a domain, and how sure that is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Match {
    /// Place of the room type in the domain.
    pub at: usize,
    /// 1 for a name of the type, less the more of label and name differ.
    pub grade: f64,
}

/// Grade of a name that is not the first by which a room type is known in its language.
const BY_THE_WAY: f64 = 0.95;
/// Grade of a label that differs from a name in words for rooms as such: `operating area`, `operating room`.
const SAME_HEART: f64 = 0.92;
/// Grade of the name of a building that stands for its main room: `ward`, `restaurant`.
const BUILDING: f64 = 0.9;
/// Grade of a label that has a name in it, were the name all of it: `staff WC`.
const HOLDS_NAME: f64 = 0.75;
/// Grade of a label that is part of a name, were it all of the name: `triage` of `triage desk`.
const PART_OF_NAME: f64 = 0.7;

/// Place in a program from which on a room says half of what the first says of its building.
const FIRST: f64 = 4.0;

/// Language of ids and labels of room types: they are English, and code.
const OWN: &str = "";

/// What a room type is called in a language.
#[derive(Debug, Clone, PartialEq)]
struct Name {
    /// Place of the room type in the domain.
    at: usize,
    /// Language.
    language: Arc<str>,
    /// 1 for the first name, less for others.
    grade: f64,
}

impl Name {
    fn less_sure(self) -> Self {
        Self { grade: self.grade * SAME_HEART, ..self }
    }
}

/// The words of one domain.
#[derive(Debug)]
pub(super) struct Vocabulary {
    /// Names by their letters, spaces left out.
    names: HashMap<String, Vec<Name>>,
    /// Names by the same, without words for rooms as such.
    hearts: HashMap<String, Vec<Name>>,
    /// Names of buildings, with the main room of each.
    buildings: HashMap<String, Vec<Name>>,
    /// Words of names with the room types that have them.
    words: HashMap<String, BTreeSet<usize>>,
    /// Letters that say something in each name of each room type.
    lengths: Vec<Vec<usize>>,
    /// How much each room type belongs to the buildings of the domain, 0 to 1.
    usual: Vec<f64>,
}

impl Vocabulary {
    pub fn new(domain: &Domain) -> Self {
        let usual: Vec<f64> = domain.room_types.iter().map(|t| usual(&t.id, domain)).collect();
        let mut out = Self {
            names: HashMap::new(),
            hearts: HashMap::new(),
            buildings: HashMap::new(),
            words: HashMap::new(),
            lengths: vec![Vec::new(); domain.room_types.len()],
            usual,
        };
        let own: Arc<str> = OWN.into();
        for (at, room_type) in domain.room_types.iter().enumerate() {
            let is_kind = room_type.id != GENERIC_ROOM_TYPE;
            for name in [room_type.id.replace('_', " "), room_type.label.clone()].iter().filter(|_| is_kind) {
                out.add(&Phrase::new(name), Name { at, language: Arc::clone(&own), grade: 1.0 });
            }
            for (language, names) in &room_type.keywords {
                let language: Arc<str> = language.as_str().into();
                for (n, name) in names.iter().enumerate() {
                    let phrase = Phrase::new(name);
                    out.lengths[at].push(phrase.heart().chars().count());
                    let grade = if n == 0 { 1.0 } else { BY_THE_WAY };
                    if is_kind {
                        out.add(&phrase, Name { at, language: Arc::clone(&language), grade });
                    }
                }
            }
        }
        out.add_buildings(domain);
        out
    }

    fn add_buildings(&mut self, domain: &Domain) {
        for building in &domain.building_types {
            let main = domain.program(&building.program).and_then(|p| p.rooms.first());
            let main = main.and_then(|m| domain.room_types.iter().position(|t| t.id == m.room_type));
            let Some(at) = main else { continue };
            for (language, names) in &building.keywords {
                let language: Arc<str> = language.as_str().into();
                for name in names {
                    let name_of = Name { at, language: Arc::clone(&language), grade: BUILDING };
                    self.buildings.entry(Phrase::new(name).whole()).or_default().push(name_of);
                }
            }
        }
    }

    fn add(&mut self, phrase: &Phrase, name: Name) {
        for word in &phrase.core {
            self.words.entry(word.clone()).or_default().insert(name.at);
        }
        if !phrase.says_nothing() {
            self.hearts.entry(phrase.heart()).or_default().push(name.clone().less_sure());
        }
        self.names.entry(phrase.whole()).or_default().push(name);
    }

    /// Returns the languages in which a label is a name here.
    pub fn languages(&self, label: &Phrase) -> BTreeSet<&str> {
        let names = Self::all(&self.names, &label.whole());
        names.iter().map(|n| &*n.language).filter(|l| *l != OWN).collect()
    }

    fn all<'m>(map: &'m HashMap<String, Vec<Name>>, letters: &str) -> &'m [Name] {
        forms(letters).iter().find_map(|f| map.get(f)).map_or(&[], Vec::as_slice)
    }

    /// Returns the best name with these letters: in the language spoken, the first of its type, of the usual type.
    fn look_up(&self, map: &HashMap<String, Vec<Name>>, letters: &str, language: Option<&str>) -> Option<Name> {
        let rank = |n: &Name| {
            let spoken = &*n.language == OWN && language.is_none_or(|l| l == "en") || Some(&*n.language) == language;
            (u8::from(spoken), n.grade, self.usual[n.at])
        };
        let better = |a: &Name, b: &Name| {
            let ((x, p, u), (y, q, v)) = (rank(a), rank(b));
            x.cmp(&y).then(p.total_cmp(&q)).then(u.total_cmp(&v)).then(b.at.cmp(&a.at))
        };
        Self::all(map, letters).iter().max_by(|a, b| better(a, b)).cloned()
    }

    /// Returns what a label means here, where it is known which language is spoken; `None` when no name is like it.
    pub fn meaning(&self, label: &Phrase, language: Option<&str>) -> Option<Match> {
        let found = |at: usize, grade: f64| Match { at, grade };
        let whole = label.whole();
        if let Some(name) = self.look_up(&self.names, &whole, language) {
            return Some(found(name.at, name.grade));
        }
        if label.says_nothing() {
            return None;
        }
        let heart = label.heart();
        let same = self.look_up(&self.hearts, &heart, language);
        let same = same.or_else(|| self.look_up(&self.names, &heart, language).map(|n| n.less_sure()));
        if let Some(name) = same.or_else(|| self.look_up(&self.buildings, &whole, language)) {
            return Some(found(name.at, name.grade));
        }
        let within = self.name_within(label, language).map(|(at, share)| (at, HOLDS_NAME * share.sqrt()));
        let part = self.part_of_name(label).map(|(at, share)| (at, PART_OF_NAME * share));
        let best = within.into_iter().chain(part).max_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(at, grade)| found(at, grade))
    }

    /// Returns the room type with the longest name in a label, and the share of the label's letters that it has.
    fn name_within(&self, label: &Phrase, language: Option<&str>) -> Option<(usize, f64)> {
        let letters = |words: &[String]| words.iter().map(|w| w.chars().count()).sum::<usize>();
        let all = letters(&label.words).max(1);
        let mut best: Option<(usize, usize)> = None;
        let mut try_part = |part: &str, length: usize| {
            if best.is_some_and(|(_, l)| length <= l) || Phrase::new(part).says_nothing() {
                return;
            }
            let known = self.look_up(&self.names, part, language);
            if let Some(name) = known.or_else(|| self.look_up(&self.hearts, part, language)) {
                best = Some((name.at, length));
            }
        };
        for start in 0..label.words.len() {
            for end in start + 1..=label.words.len() {
                let run = &label.words[start..end];
                try_part(&run.concat(), letters(run));
            }
        }
        for word in &label.words {
            for (part, length) in parts(word) {
                try_part(part, length);
            }
        }
        best.map(|(at, length)| (at, length as f64 / all as f64))
    }

    /// Returns the room type in whose names all words of a label are, and the share of its letters that the label has.
    fn part_of_name(&self, label: &Phrase) -> Option<(usize, f64)> {
        let mut types: Option<BTreeSet<usize>> = None;
        for word in &label.core {
            let with: BTreeSet<usize> =
                forms(word).iter().filter_map(|f| self.words.get(f)).flatten().copied().collect();
            types = Some(types.map_or_else(|| with.clone(), |t| t.intersection(&with).copied().collect()));
        }
        let best = types?.into_iter().max_by(|a, b| self.usual[*a].total_cmp(&self.usual[*b]).then(b.cmp(a)))?;
        let length = label.heart().chars().count();
        let longer = self.lengths[best].iter().copied().filter(|n| *n > length);
        let shortest = longer.min().unwrap_or(2 * length);
        Some((best, length as f64 / shortest as f64))
    }

    /// Returns how much the room type at a place belongs to the buildings of the domain, 0 to 1.
    pub fn usual(&self, at: usize) -> f64 {
        self.usual[at]
    }

    /// Returns how many names of room types have a word in them.
    pub fn uses(&self, word: &str) -> usize {
        forms(word).iter().filter_map(|f| self.words.get(f)).map(BTreeSet::len).max().unwrap_or(0)
    }
}

/// Returns the ends of a compound, the longest first, with how many letters each has: what it is stands there.
fn parts(word: &str) -> impl Iterator<Item = (&str, usize)> {
    let least = if is_wide(word) { 2 } else { stem_of(word) + 1 };
    let count = word.chars().count();
    let ends = word.char_indices().enumerate().skip(1).map(move |(n, (at, _))| (&word[at..], count - n));
    let starts = word.char_indices().enumerate().skip(1).filter(|_| is_wide(word)).map(|(n, (at, _))| (&word[..at], n));
    ends.chain(starts).filter(move |(_, length)| *length >= least)
}

/// Returns how much a room type belongs to the buildings of a domain: 1 where each of them has it always.
fn usual(room_type: &str, domain: &Domain) -> f64 {
    let in_program = |program: &Program| -> f64 {
        let at = program.rooms.iter().position(|r| r.room_type == room_type || r.with.iter().any(|w| w == room_type));
        let serves = program.support.iter().flat_map(|s| s.room_types()).any(|t| t == room_type);
        match at {
            // the most important rooms come first
            Some(at) => FIRST / (FIRST + at as f64) * if program.rooms[at].min > 0 { 1.0 } else { 0.7 },
            None if serves || program.vital.iter().any(|v| v == room_type) => 0.3,
            None => 0.0,
        }
    };
    if domain.circulation.room_type == room_type {
        return 1.0;
    }
    let count = domain.programs.len().max(1) as f64;
    (domain.programs.iter().map(in_program).sum::<f64>() / count).sqrt()
}

/// Returns the room types of a program with all that belongs to it.
pub(super) fn rooms_of(program: &Program) -> BTreeSet<&str> {
    let rooms = program.rooms.iter().flat_map(|r| std::iter::once(&r.room_type).chain(&r.with));
    let support = program.support.iter().flat_map(|s| s.room_types());
    let large = program.large.iter().flat_map(|l| l.rooms.iter().flat_map(|s| s.room_types()));
    rooms.chain(support).chain(large).chain(&program.vital).map(String::as_str).collect()
}

/// How the words of labels that nobody knows whole are shared among domains.
pub(super) fn shares(label: &Phrase, vocabularies: &[&Vocabulary]) -> Vec<f64> {
    let mut of_word: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for word in &label.core {
        let uses: Vec<f64> = vocabularies.iter().map(|v| v.uses(word) as f64).collect();
        let all: f64 = uses.iter().sum();
        if all > 0.0 {
            of_word.insert(word, uses.iter().map(|u| u / all).collect());
        }
    }
    let count = label.core.len().max(1) as f64;
    (0..vocabularies.len()).map(|at| of_word.values().map(|s| s[at]).sum::<f64>() / count).collect()
}
