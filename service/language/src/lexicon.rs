//! What words of all languages stand for.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

use crate::data::{self, LanguageData, Shipped, Unread, Words};
use crate::morphology::stem;
use crate::spelling::Vocabulary;
use crate::tokens::{Token, TokenKind, tokens};

/// Code of what is the same in all languages.
pub(crate) const ANY: &str = "any";

/// Threads that fill a lexicon, at most.
const MOST_THREADS: usize = 4;

/// Class of the small words that build sentences.
const SMALL: &str = "particle";

/// The phrases of all languages with what they stand for.
#[derive(Debug, Clone)]
pub struct Lexicon {
    pub(crate) languages: Vec<Language>,
    /// Classes whose words count only as they are written.
    exact: Vec<String>,
    /// Classes whose words are also understood amid another language.
    pub(crate) travels: Vec<String>,
    pub(crate) unread: Arc<Unread>,
}

/// One language, ready to look words up.
#[derive(Debug, Clone)]
pub(crate) struct Language {
    pub data: LanguageData,
    keys: HashMap<String, u32>,
    /// From a node and the key of a word to the next node.
    steps: HashMap<(u32, u32), u32>,
    /// What the phrase that ends in a node stands for.
    ends: Vec<Vec<Entry>>,
    pub vocabulary: Vocabulary,
}

/// What one phrase stands for.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub class: Arc<str>,
    pub value: Arc<str>,
    /// Its words, folded and not stemmed.
    words: Box<str>,
    /// True when only these very words count.
    exact: bool,
}

/// A run of tokens that a language has entries for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Match {
    pub from: usize,
    pub to: usize,
    /// Index of the language.
    pub language: usize,
    /// Where its entries are.
    pub node: u32,
    /// True when one entry is written exactly so.
    pub exact: bool,
}

impl Lexicon {
    /// Returns the lexicon of the crate: the words that build sentences, not yet those of any building.
    ///
    /// # Panics
    /// Never: a test reads the files of the crate.
    pub fn shipped() -> Self {
        Self::of(data::shipped().expect("a test reads the files of the crate"))
    }

    fn of(shipped: Shipped) -> Self {
        let exact = shipped.classes.iter().filter(|(_, c)| c.exact).map(|(name, _)| name.clone()).collect();
        let travels = shipped.classes.iter().filter(|(_, c)| c.travels).map(|(name, _)| name.clone()).collect();
        let mut lexicon = Self { languages: Vec::new(), exact, travels, unread: Arc::new(shipped.unread) };
        let mut words = Vec::new();
        for mut data in shipped.languages {
            words.push(std::mem::take(&mut data.words));
            lexicon.languages.push(Language::of(data));
        }
        lexicon.fill(words);
        lexicon
    }

    /// Adds a phrase of a language: `any` for all of them. A language without a folder is as if it had one that says nothing.
    pub fn add(&mut self, language: &str, class: &str, value: &str, phrase: &str) {
        let at = self.place_of(language);
        let word = Words { class: class.to_owned(), value: value.to_owned(), phrase: phrase.to_owned() };
        self.languages[at].add(&self.exact, &word);
    }

    /// Adds many phrases, each of a language, as [`Self::add`] does in their order; the languages are filled side by side.
    pub fn add_all(&mut self, words: Vec<(String, Words)>) {
        let mut of: Vec<Vec<Words>> = vec![Vec::new(); self.languages.len()];
        for (language, word) in words {
            let at = self.place_of(&language);
            of.resize(self.languages.len(), Vec::new());
            of[at].push(word);
        }
        self.fill(of);
    }

    fn fill(&mut self, words: Vec<Vec<Words>>) {
        let exact = &self.exact;
        side_by_side(self.languages.iter_mut().zip(words).collect(), |(language, words)| {
            words.iter().for_each(|word| language.add(exact, word));
        });
    }

    fn place_of(&mut self, language: &str) -> usize {
        self.languages.iter().position(|l| l.data.code == language).unwrap_or_else(|| {
            self.languages.push(Language::of(bare(language)));
            self.languages.len() - 1
        })
    }

    /// Returns the languages that a name is to be added for: all at once, and once more those that inflect names.
    pub fn languages_of_names(&self) -> Vec<String> {
        let decline = self.languages.iter().filter(|l| l.data.names_decline).map(|l| l.data.code.clone());
        std::iter::once(ANY.to_owned()).chain(decline).collect()
    }

    /// Returns the codes of the languages it reads, and their names in English.
    pub fn languages(&self) -> BTreeMap<&str, &str> {
        let read = self.languages.iter().filter(|l| l.data.code != ANY);
        read.map(|l| (l.data.code.as_str(), l.data.name.as_str())).collect()
    }

    /// Returns every run of tokens that some language has an entry for, in no order that matters.
    pub(crate) fn matches(&self, tokens: &[Token]) -> Vec<Match> {
        let mut found = Vec::new();
        for (at, language) in self.languages.iter().enumerate() {
            let keys: Vec<Option<u32>> = tokens.iter().map(|t| language.key(t)).collect();
            for from in 0..tokens.len() {
                language.walk(at, tokens, &keys, from, &mut found);
            }
        }
        found
    }
}

impl Language {
    fn of(data: LanguageData) -> Self {
        let vocabulary = Vocabulary::new(&data.lookalikes);
        Self { data, keys: HashMap::new(), steps: HashMap::new(), ends: vec![Vec::new()], vocabulary }
    }

    /// Adds a phrase, and as it is typed without its marks.
    fn add(&mut self, exact: &[String], Words { class, value, phrase }: &Words) {
        let exact = exact.contains(class);
        self.put(class, value, phrase, exact);
        if self.data.transcriptions.is_empty() {
            return;
        }
        let plain = phrase.to_lowercase();
        let typed = self.data.transcriptions.iter().fold(plain.clone(), |p, (from, to)| p.replace(from, to));
        if typed != plain {
            self.put(class, value, &typed, exact);
        }
    }

    fn put(&mut self, class: &str, value: &str, phrase: &str, exact: bool) {
        let words = tokens(phrase);
        if words.is_empty() {
            return;
        }
        let mut node = 0;
        for word in &words {
            if word.kind == TokenKind::Word {
                self.vocabulary.add(&word.text);
            }
            let next_key = self.keys.len() as u32;
            let key = *self.keys.entry(self.stem(word)).or_insert(next_key);
            let next = self.ends.len() as u32;
            node = *self.steps.entry((node, key)).or_insert(next);
            if node == next {
                self.ends.push(Vec::new());
            }
        }
        let ends = &mut self.ends[node as usize];
        let words = joined(&words);
        if !ends.iter().any(|e| *e.class == *class && *e.value == *value && *e.words == *words) {
            ends.push(Entry { class: class.into(), value: value.into(), words: words.into(), exact });
        }
    }

    fn stem(&self, token: &Token) -> String {
        if token.kind == TokenKind::Word { stem(&token.text, &self.data) } else { token.text.clone() }
    }

    fn key(&self, token: &Token) -> Option<u32> {
        self.keys.get(&self.stem(token)).copied()
    }

    fn walk(&self, at: usize, tokens: &[Token], keys: &[Option<u32>], from: usize, found: &mut Vec<Match>) {
        let mut node = 0;
        for to in from..tokens.len() {
            let next = keys[to].and_then(|key| self.steps.get(&(node, key)));
            let Some(next) = next else { return };
            node = *next;
            if self.ends[node as usize].is_empty() {
                continue;
            }
            let words = joined(&tokens[from..=to]);
            let exact = self.ends[node as usize].iter().any(|e| *e.words == *words);
            if exact || self.ends[node as usize].iter().any(|e| !e.exact) {
                found.push(Match { from, to: to + 1, language: at, node, exact });
            }
        }
    }

    /// Returns the entries of a match: those written exactly so where there are any.
    pub fn entries(&self, node: u32, tokens: &[Token]) -> Vec<(&Entry, bool)> {
        let words = joined(tokens);
        let all = &self.ends[node as usize];
        let exact: Vec<(&Entry, bool)> = all.iter().filter(|e| *e.words == *words).map(|e| (e, true)).collect();
        if exact.is_empty() { all.iter().filter(|e| !e.exact).map(|e| (e, false)).collect() } else { exact }
    }

    /// Returns true where a match is of a small word that builds sentences.
    pub fn is_small(&self, node: u32) -> bool {
        self.ends[node as usize].iter().any(|e| *e.class == *SMALL)
    }

    /// Returns true for the form of a word for more than one, where the word for one stands in the lexicon.
    pub fn is_plural(&self, word: &str) -> bool {
        self.data.plural.iter().any(|e| {
            let one = word.strip_suffix(e.strip.as_str()).map(|root| format!("{root}{}", e.put));
            one.is_some_and(|one| self.vocabulary.has(&one))
        })
    }

    /// Returns the entries of one word that is not a token, with whether it is written exactly so.
    pub fn word(&self, word: &str) -> Option<&[Entry]> {
        let key = self.keys.get(&stem(word, &self.data))?;
        let node = self.steps.get(&(0, *key))?;
        let entries = &self.ends[*node as usize];
        let fits = entries.iter().any(|e| !e.exact || *e.words == *word);
        (fits && !entries.is_empty()).then_some(entries)
    }
}

/// Does a work for each of some items on a few threads; none sees what another does.
fn side_by_side<T: Send>(items: Vec<T>, work: impl Fn(T) + Sync) {
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(MOST_THREADS);
    let left = Mutex::new(items.into_iter());
    let next = || left.lock().unwrap_or_else(PoisonError::into_inner).next();
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(|| std::iter::from_fn(next).for_each(&work));
        }
        std::iter::from_fn(next).for_each(&work);
    });
}

fn joined(tokens: &[Token]) -> String {
    if let [token] = tokens {
        return token.text.clone();
    }
    tokens.iter().map(|t| t.text.as_str()).collect::<Vec<_>>().join(" ")
}

fn bare(code: &str) -> LanguageData {
    LanguageData {
        code: code.to_owned(),
        name: code.to_owned(),
        decimal: '.',
        head_last: true,
        owner_first: false,
        postpositions: false,
        endings: Vec::new(),
        plural: Vec::new(),
        same: Vec::new(),
        joints: Vec::new(),
        transcriptions: Vec::new(),
        lookalikes: Vec::new(),
        letters: Vec::new(),
        names_decline: false,
        words: Vec::new(),
    }
}
