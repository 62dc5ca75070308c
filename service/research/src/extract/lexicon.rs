//! The vocabulary, read once from `data/*.toml`, and finding its phrases among tokens.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use serde::Deserialize;

use super::token::{Kind, Token, is_dense, tokens};

/// Shortest word that stands for itself at an end of a German compound.
const MIN_COMPOUND_PART: usize = 3;
/// A longer word is no compound but nonsense, in letters.
const MAX_COMPOUND: usize = 60;

#[derive(Debug, Deserialize)]
pub struct Unit {
    pub id: String,
    pub dimension: String,
    pub factor: f64,
    spellings: Vec<String>,
    #[serde(default)]
    langs: Vec<String>,
    /// The spelling is a preposition too.
    #[serde(default)]
    pub preposition: bool,
    /// A minus sign before the figure belongs to it.
    #[serde(default)]
    pub signed: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Bound {
    Min,
    Max,
}

#[derive(Debug, Deserialize)]
pub struct Comparator {
    pub bound: Bound,
    pub strong: bool,
    /// Negation does not turn it around.
    #[serde(default)]
    pub fixed: bool,
    before: Vec<String>,
    after: Vec<String>,
    #[serde(default)]
    prefixes: Vec<String>,
}

#[derive(Debug, Deserialize)]
pub struct Quantity {
    pub name: String,
    pub dimensions: Vec<String>,
    /// A bare figure of it is a largest one.
    #[serde(default)]
    pub upper: bool,
    words: Vec<String>,
}

#[derive(Debug, Deserialize)]
pub struct Thing {
    pub name: String,
    words: Vec<String>,
    /// Such counts mostly say when a rule holds.
    #[serde(default)]
    pub condition: bool,
}

#[derive(Debug, Deserialize)]
pub struct Numbers {
    pub weak: Vec<String>,
    /// Those of them that are articles far more often than figures.
    pub articles: Vec<String>,
    pub hundred: Vec<String>,
    pub thousand: Vec<String>,
    pub joiner: Vec<String>,
    pub german_joiner: String,
    pub words: BTreeMap<String, f64>,
    pub symbols: BTreeMap<String, f64>,
    fractions: BTreeMap<String, (f64, f64)>,
    multiples: BTreeMap<String, f64>,
}

/// Phrases of several tokens by their first, each with what it means.
#[derive(Debug)]
pub struct Phrases<T> {
    by_first: BTreeMap<String, Vec<(Vec<String>, T)>>,
    /// First words of phrases that stand for all words with that beginning (`super*`) or ending (`*rá`).
    open: Vec<String>,
    plurals: bool,
}

impl<T: Clone> Phrases<T> {
    fn new(entries: impl IntoIterator<Item = (String, T)>, plurals: bool) -> Self {
        let mut by_first: BTreeMap<String, Vec<(Vec<String>, T)>> = BTreeMap::new();
        for (phrase, meaning) in entries {
            let words = words_of(&phrase);
            if let Some(first) = words.first() {
                by_first.entry(first.clone()).or_default().push((words, meaning));
            }
        }
        for list in by_first.values_mut() {
            list.sort_by_key(|e| std::cmp::Reverse(e.0.len()));
        }
        let open = by_first.keys().filter(|word| is_open(word)).cloned().collect();
        Self { by_first, open, plurals }
    }

    /// Returns the end and meaning of the longest phrase that begins at `i`.
    pub fn at(&self, tokens: &[Token], i: usize) -> Option<(usize, T)> {
        let first = tokens.get(i)?;
        let mut keys = if self.plurals { singulars(&first.text) } else { vec![first.text.as_str().to_owned()] };
        keys.extend(self.open.iter().filter(|word| first.kind == Kind::Word && is_word(&first.text, word)).cloned());
        let mut best: Option<(usize, usize, T)> = None;
        for key in keys {
            for (words, meaning) in self.by_first.get(&key).into_iter().flatten() {
                if let Some(end) = self.rest(tokens, i, words)
                    && best.as_ref().is_none_or(|b| b.0 < words.len())
                {
                    best = Some((words.len(), end, meaning.clone()));
                }
            }
        }
        best.map(|(_, end, meaning)| (end, meaning))
    }

    fn rest(&self, tokens: &[Token], i: usize, words: &[String]) -> Option<usize> {
        let mut j = i + 1;
        for word in words.iter().skip(1) {
            while tokens.get(j).is_some_and(|t| is_joint(t) && !t.is(word)) {
                j += 1;
            }
            let token = tokens.get(j)?;
            if !(is_word(&token.text, word) || self.plurals && singulars(&token.text).contains(word)) {
                return None;
            }
            j += 1;
        }
        Some(j)
    }

    /// Returns the meaning of the longest known word that a compound begins or ends with.
    pub fn part(&self, token: &Token, ends: bool) -> Option<T> {
        let length = token.text.chars().count();
        if token.kind != Kind::Word || !(2 * MIN_COMPOUND_PART..=MAX_COMPOUND).contains(&length) {
            return None;
        }
        let forms = if ends { singulars(&token.text) } else { vec![token.text.clone()] };
        let single = |part: &str| {
            let fits = part.chars().count() >= MIN_COMPOUND_PART && !part.starts_with(is_dense);
            let list = self.by_first.get(part).filter(|_| fits)?;
            list.iter().find(|e| e.0.len() == 1).map(|e| (part.len(), e.1.clone()))
        };
        let longest = |form: &String| {
            let mut cuts = form.char_indices().map(|c| c.0).filter(|at| *at > 0);
            if ends { cuts.find_map(|at| single(&form[at..])) } else { cuts.rev().find_map(|at| single(&form[..at])) }
        };
        forms.iter().filter_map(longest).max_by_key(|found| found.0).map(|found| found.1)
    }

    /// Whether a phrase begins at `i`.
    pub fn is_at(&self, tokens: &[Token], i: usize) -> bool {
        self.at(tokens, i).is_some()
    }

    /// Whether a phrase begins anywhere in these tokens.
    pub fn any(&self, tokens: &[Token]) -> bool {
        (0..tokens.len()).any(|i| self.is_at(tokens, i))
    }
}

/// Returns the words of a phrase of the vocabulary; a star belongs to the word it is written at.
fn words_of(phrase: &str) -> Vec<String> {
    let parts = tokens(phrase, "");
    let whole = parts.len() == 1;
    let mut words: Vec<String> = Vec::new();
    let mut ending = false;
    for token in parts.into_iter().filter(|t| whole || !is_joint(t)) {
        match words.last_mut() {
            Some(word) if token.is("*") && token.glued && !whole => word.push('*'),
            Some(word) if ending && token.glued => word.push_str(&token.text),
            _ => words.push(token.text.clone()),
        }
        ending = token.is("*") && !token.glued && !whole;
    }
    words
}

fn is_open(word: &str) -> bool {
    word.len() > 1 && (word.starts_with('*') || word.ends_with('*'))
}

/// Whether a word is one of the vocabulary, or one of those an open one stands for.
fn is_word(text: &str, word: &str) -> bool {
    match (word.strip_prefix('*'), word.strip_suffix('*')) {
        (Some(end), _) if !end.is_empty() => text.len() > end.len() + 1 && text.ends_with(end),
        (_, Some(begin)) if !begin.is_empty() => text.starts_with(begin),
        _ => text == word,
    }
}

fn is_joint(token: &Token) -> bool {
    token.kind == Kind::Symbol && matches!(token.text.as_str(), "-" | "‐" | "‑" | "'" | "’" | "." | ".-")
}

/// Returns a word and what it may be the plural or an inflected form of.
fn singulars(word: &str) -> Vec<String> {
    let mut forms = vec![word.to_owned()];
    if let Some(stem) = word.strip_suffix("ies") {
        forms.push(format!("{stem}y"));
    }
    for suffix in ["s", "es", "n", "en", "e", "er", "ern", "i", "x"] {
        if let Some(stem) = word.strip_suffix(suffix).filter(|s| s.chars().count() >= 3) {
            forms.push(stem.to_owned());
        }
    }
    forms
}

/// Sets of cue phrases by name.
#[derive(Debug)]
pub struct Cues(BTreeMap<String, Phrases<()>>, Phrases<()>);

impl Cues {
    /// Returns the phrases of a cue.
    pub fn get(&self, name: &str) -> &Phrases<()> {
        self.0.get(name).unwrap_or(&self.1)
    }
}

/// All words.
#[derive(Debug)]
pub struct Lexicon {
    pub units: Vec<Unit>,
    /// Spellings of units by their first letter, the longest first.
    spellings: BTreeMap<char, Vec<(Vec<char>, usize)>>,
    pub comparators: Vec<Comparator>,
    pub before: Phrases<usize>,
    pub after: Phrases<usize>,
    pub prefixes: Phrases<usize>,
    pub quantities: Vec<Quantity>,
    pub quantity: Phrases<usize>,
    pub things: Vec<Thing>,
    pub thing: Phrases<usize>,
    pub basis: Phrases<String>,
    pub space: Phrases<String>,
    pub object: Phrases<String>,
    pub numbers: Numbers,
    pub fractions: Phrases<(f64, f64)>,
    pub multiples: Phrases<f64>,
    pub cues: Cues,
    /// Languages whose words of comparison are known.
    pub languages: Vec<String>,
    /// Letters that none of them writes.
    pub strange_letters: String,
}

impl Lexicon {
    /// Returns the shipped vocabulary.
    pub fn shared() -> &'static Self {
        static SHARED: OnceLock<Lexicon> = OnceLock::new();
        SHARED.get_or_init(|| Self::load().expect("the shipped vocabulary is well formed, as a test reads it"))
    }

    fn load() -> Result<Self, toml::de::Error> {
        #[derive(Deserialize)]
        struct Units {
            unit: Vec<Unit>,
        }
        #[derive(Deserialize)]
        struct Negations {
            words: Vec<String>,
            forbidden: Vec<String>,
        }
        #[derive(Deserialize)]
        struct Comparators {
            languages: Vec<String>,
            strange_letters: String,
            comparator: Vec<Comparator>,
            negations: Negations,
        }
        #[derive(Deserialize)]
        struct Quantities {
            quantity: Vec<Quantity>,
        }
        #[derive(Deserialize)]
        struct Counts {
            thing: Vec<Thing>,
            basis: Vec<Thing>,
        }
        #[derive(Deserialize)]
        struct Spaces {
            spaces: BTreeMap<String, Vec<String>>,
            objects: BTreeMap<String, Vec<String>>,
        }
        let Units { unit: units } = toml::from_str(include_str!("../../data/units.toml"))?;
        let Comparators { languages, strange_letters, comparator: comparators, negations } =
            toml::from_str(include_str!("../../data/comparators.toml"))?;
        let Quantities { quantity: quantities } = toml::from_str(include_str!("../../data/quantities.toml"))?;
        let Counts { thing: things, basis } = toml::from_str(include_str!("../../data/counts.toml"))?;
        let Spaces { spaces, objects } = toml::from_str(include_str!("../../data/spaces.toml"))?;
        let numbers: Numbers = toml::from_str(include_str!("../../data/numbers.toml"))?;
        let mut cues: BTreeMap<String, Vec<String>> = toml::from_str(include_str!("../../data/cues.toml"))?;
        cues.insert("negations".into(), negations.words);
        cues.insert("forbidden".into(), negations.forbidden);

        let mut spellings: BTreeMap<char, Vec<(Vec<char>, usize)>> = BTreeMap::new();
        for (i, unit) in units.iter().enumerate() {
            for spelling in &unit.spellings {
                let letters: Vec<char> = spelling.to_lowercase().chars().collect();
                let Some(first) = letters.first().copied() else { continue };
                spellings.entry(first).or_default().push((letters, i));
            }
        }
        for list in spellings.values_mut() {
            list.sort_by_key(|s| std::cmp::Reverse(s.0.len()));
        }
        fn indexed<'a, T>(list: &'a [T], words: fn(&T) -> &[String]) -> impl Iterator<Item = (String, usize)> + 'a {
            list.iter().enumerate().flat_map(move |(i, e)| words(e).iter().map(move |w| (w.to_lowercase(), i)))
        }
        fn named(map: BTreeMap<String, Vec<String>>) -> impl Iterator<Item = (String, String)> {
            map.into_iter().flat_map(|(name, words)| words.into_iter().map(move |w| (w.to_lowercase(), name.clone())))
        }
        let basis = basis.into_iter().map(|t| (t.name, t.words)).collect();
        Ok(Self {
            before: Phrases::new(indexed(&comparators, |c| &c.before), false),
            after: Phrases::new(indexed(&comparators, |c| &c.after), false),
            prefixes: Phrases::new(indexed(&comparators, |c| &c.prefixes), false),
            quantity: Phrases::new(indexed(&quantities, |q| &q.words), true),
            thing: Phrases::new(indexed(&things, |t| &t.words), true),
            basis: Phrases::new(named(basis), true),
            space: Phrases::new(named(spaces), true),
            object: Phrases::new(named(objects), true),
            fractions: Phrases::new(numbers.fractions.clone(), false),
            multiples: Phrases::new(numbers.multiples.clone(), false),
            cues: Cues(
                cues.into_iter()
                    .map(|(n, words)| (n, Phrases::new(words.into_iter().map(|w| (w, ())), false)))
                    .collect(),
                Phrases::new([], false),
            ),
            languages,
            strange_letters,
            units,
            spellings,
            comparators,
            quantities,
            things,
            numbers,
        })
    }

    /// Returns the unit written at a byte of the text, after at most a blank or hyphen, and where it ends.
    pub fn unit_at(&self, text: &str, from: usize, lang: &str) -> Option<(usize, usize)> {
        let rest = text.get(from..)?;
        let skipped: usize =
            rest.chars().take(2).take_while(|c| c.is_whitespace() || matches!(c, '-' | '‑')).map(char::len_utf8).sum();
        let rest: Vec<(usize, char)> = rest.get(skipped..)?.char_indices().take(40).collect();
        let first = rest.first()?.1.to_lowercase().next()?;
        for (spelling, unit) in self.spellings.get(&first)? {
            let langs = &self.units.get(*unit)?.langs;
            if !langs.is_empty() && !langs.iter().any(|l| l == lang) {
                continue;
            }
            if let Some(length) = spelled(spelling, &rest) {
                return Some((*unit, from + skipped + length));
            }
        }
        None
    }
}

/// Returns how many bytes a spelling takes at the beginning of `rest`, when it ends there.
fn spelled(spelling: &[char], rest: &[(usize, char)]) -> Option<usize> {
    let mut i = 0;
    for &c in spelling {
        if c == ' ' {
            while rest.get(i).is_some_and(|r| matches!(r.1, ' ' | '.' | '-' | '\u{a0}' | '\u{202f}')) {
                i += 1;
            }
            continue;
        }
        let found = rest.get(i)?.1;
        if !(found == c || found.to_lowercase().eq([c])) {
            return None;
        }
        i += 1;
    }
    let last = *spelling.last()?;
    if let Some(&(_, next)) = rest.get(i) {
        let goes_on = last.is_alphanumeric() && next.is_alphanumeric() && !is_dense(next);
        let power = matches!(next, '²' | '³' | '^') && last.is_alphanumeric();
        if goes_on && !is_dense(last) || power {
            return None;
        }
    }
    let end = rest.get(i).map_or_else(|| rest.last().map_or(0, |r| r.0 + r.1.len_utf8()), |r| r.0);
    (i > 0).then_some(end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_vocabulary_loads_and_every_unit_can_be_read_back() {
        let lexicon = Lexicon::load().expect("data is well formed");
        for unit in &lexicon.units {
            for spelling in &unit.spellings {
                let (found, end) = lexicon.unit_at(spelling, 0, "en").expect(spelling);
                assert_eq!((&lexicon.units[found].id, end), (&unit.id, spelling.len()), "{spelling}");
            }
        }
        assert!(!lexicon.cues.get("duty").by_first.is_empty());
    }
}
