//! What a run of words was found to be: a word with its senses, or what a rule made of several.

use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

use d3dgen_language::{Chunk, Reading, TokenKind};

/// A word, a number, a mark, or what a rule found.
#[derive(Debug, Clone, Default)]
pub(crate) struct Node {
    /// Class and value of each sense; what a rule makes has one class and no value.
    pub senses: Vec<(Arc<str>, Arc<str>)>,
    /// Tokens of the reading.
    pub tokens: Range<usize>,
    /// Value of a number.
    pub number: Option<f64>,
    /// Words as they are looked up.
    pub text: Arc<str>,
    /// What a rule captured, by name, in the order of the words.
    pub fields: Vec<(Arc<str>, Rc<Node>)>,
    /// Number of the rule that made it.
    pub rule: Option<usize>,
    /// True for a mark.
    pub mark: bool,
    /// True where names of several words have their noun last.
    pub head_last: bool,
    /// True where words for how things lie stand behind what they refer to.
    pub postpositions: bool,
    /// True when nothing stands between it and what comes before.
    pub joined: bool,
    /// True for the form of a word for more than one.
    pub plural: bool,
    /// True when it is written with a capital letter.
    pub capital: bool,
}

/// Names of marks in patterns.
const MARKS: &[(&str, &str)] = &[
    (",", "comma"),
    (";", "semicolon"),
    (":", "colon"),
    (".", "dot"),
    ("-", "dash"),
    ("(", "open"),
    (")", "close"),
    ("/", "slash"),
    ("x", "times"),
    ("+", "plus"),
    ("&", "plus"),
];

impl Node {
    pub fn of(chunk: &Chunk, reading: &Reading) -> Self {
        let first = &reading.tokens()[chunk.tokens.start];
        let mark = chunk.tokens.len() == 1 && first.kind == TokenKind::Mark;
        let mut senses: Vec<(Arc<str>, Arc<str>)> = Vec::new();
        // "pięć" is five, and without its marks an oven
        let thing = |class: &str| ["room", "object", "kind"].contains(&class);
        for sense in chunk.senses.iter().filter(|s| chunk.number.is_none() || !thing(s.class)) {
            let sense = (Arc::from(sense.class), Arc::from(sense.value));
            if !senses.contains(&sense) {
                senses.push(sense);
            }
        }
        Self {
            senses,
            tokens: chunk.tokens.clone(),
            number: chunk.number,
            text: chunk.text.as_str().into(),
            mark,
            head_last: reading.head_last(chunk.tokens.start),
            postpositions: reading.has_postpositions(chunk.tokens.start),
            joined: first.joined,
            plural: reading.is_plural(chunk.tokens.clone()),
            capital: first.capital,
            ..Self::default()
        }
    }

    /// Returns true when it is what an atom of a pattern asks for.
    pub fn is(&self, class: &str, value: Option<&str>) -> bool {
        match (class, value) {
            ("number", None) => self.number.is_some() && self.rule.is_none(),
            ("unknown", None) => self.is_unknown(),
            // a word of a class that stands by itself, not as the end of a longer one
            ("spaced", Some(class)) => !self.joined && self.senses.iter().any(|(c, _)| **c == *class),
            ("mark", None) => self.mark,
            ("mark", Some(name)) => self.mark && MARKS.iter().any(|(text, n)| *n == name && **text == *self.text),
            (_, None) => self.senses.iter().any(|(c, _)| **c == *class),
            (_, Some(value)) if self.senses.iter().any(|(c, v)| **c == *class && **v == *value) => true,
            (_, Some("bare")) => self.made() == Some(class) && self.field("count").is_none(),
            (_, Some("counted")) => self.made() == Some(class) && self.field("count").is_some(),
            // what a rule made may be asked for by what was captured in it
            (_, Some(value)) => self.made() == Some(class) && self.field(value).is_some(),
        }
    }

    /// Returns true for a word that nobody knows.
    pub fn is_unknown(&self) -> bool {
        self.senses.is_empty() && self.number.is_none() && !self.mark && self.rule.is_none()
    }

    /// Returns what a rule made it.
    pub fn made(&self) -> Option<&str> {
        self.rule.and(self.senses.first()).map(|s| &*s.0)
    }

    /// Returns the values that it may have in a class.
    pub fn values<'a>(&'a self, class: &'a str) -> impl Iterator<Item = &'a str> + 'a {
        self.senses.iter().filter(move |(c, _)| **c == *class).map(|(_, v)| &**v)
    }

    /// Returns what was captured under a name first.
    pub fn field(&self, name: &str) -> Option<&Rc<Node>> {
        self.fields.iter().find(|(n, _)| **n == *name).map(|(_, node)| node)
    }

    /// Returns all that was captured under a name.
    pub fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Rc<Node>> + 'a {
        self.fields.iter().filter(move |(n, _)| **n == *name).map(|(_, node)| node)
    }
}
