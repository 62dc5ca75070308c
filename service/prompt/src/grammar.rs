//! The rules, read and checked.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use serde::Deserialize;

use crate::pattern::Pattern;

/// Files of `grammar/` in the order of the steps: their name, and their text.
const FILES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/grammar.rs"));

/// Why a grammar cannot be read.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum Error {
    /// A file is not TOML of the form that it should have.
    #[error("{file}: {reason}")]
    Form {
        /// Its name.
        file: String,
        /// What the reader of TOML says.
        reason: String,
    },
    /// A rule is wrong.
    #[error("{file}: rule `{rule}`: {reason}")]
    Rule {
        /// Name of the file.
        file: String,
        /// Name of the rule.
        rule: String,
        /// What is wrong with it.
        reason: String,
    },
}

/// All rules, step by step.
#[derive(Debug)]
pub(crate) struct Grammar {
    pub steps: Vec<Level>,
    pub rules: Vec<Rule>,
    /// Senses that may stand between the words of any pattern.
    pub small: Vec<(String, String)>,
}

/// One file of rules: they do not see what each other makes.
#[derive(Debug)]
pub(crate) struct Level {
    /// Numbers of its rules.
    pub rules: Vec<usize>,
    /// How often the step is done: what it makes may be part of more of the same.
    pub times: usize,
}

/// One rule.
#[derive(Debug)]
pub(crate) struct Rule {
    pub name: String,
    pub file: String,
    /// What it makes.
    pub makes: Makes,
    pub pattern: Pattern,
    /// Classes that its first node may have; any where there are none.
    pub first: Vec<String>,
    pub weight: f64,
    pub order: Option<Order>,
    /// Constant fields.
    pub set: BTreeMap<String, String>,
    #[cfg_attr(not(test), allow(dead_code, reason = "read by the test of the rules"))]
    pub examples: Vec<Example>,
}

/// What a rule makes of what it matches.
#[derive(Debug, PartialEq)]
pub(crate) enum Makes {
    /// Something of this class.
    New(String),
    /// More of what it captured under this name.
    More(String),
}

/// Where the noun stands in names of several words, or a relation behind what it refers to, for rules that are about them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Order {
    First,
    Last,
    Postposed,
    Preposed,
}

/// A text and what is asked for in it: the test of a rule.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(test), allow(dead_code, reason = "read by the test of the rules"))]
pub(crate) struct Example {
    pub text: String,
    /// Facts, one a line, as [`crate::facts::shown`] writes them.
    pub facts: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    small: Vec<String>,
    #[serde(default = "one")]
    times: usize,
    #[serde(default)]
    rule: Vec<RuleFile>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RuleFile {
    name: String,
    makes: Option<String>,
    extends: Option<String>,
    pattern: String,
    #[serde(default)]
    weight: f64,
    order: Option<Order>,
    #[serde(default)]
    set: BTreeMap<String, String>,
    #[serde(default)]
    examples: Vec<Example>,
}

fn one() -> usize {
    1
}

impl Grammar {
    /// Returns the grammar of the crate.
    ///
    /// # Panics
    /// Never: a test reads the files.
    pub fn shipped() -> &'static Self {
        static SHIPPED: OnceLock<Grammar> = OnceLock::new();
        SHIPPED.get_or_init(|| Self::read(FILES).expect("a test reads the files of the crate"))
    }

    fn read(files: &[(&str, &str)]) -> Result<Self, Error> {
        let mut grammar = Self { steps: Vec::new(), rules: Vec::new(), small: Vec::new() };
        let mut names = BTreeSet::new();
        for (name, text) in files {
            let file: File =
                toml::from_str(text).map_err(|e| Error::Form { file: (*name).to_owned(), reason: e.to_string() })?;
            let small = file.small.iter().filter_map(|s| s.split_once('.'));
            grammar.small.extend(small.map(|(class, value)| (class.to_owned(), value.to_owned())));
            let mut level = Level { rules: Vec::new(), times: file.times };
            for rule in file.rule {
                let wrong = |reason: String| Error::Rule { file: (*name).to_owned(), rule: rule.name.clone(), reason };
                if !names.insert(rule.name.clone()) {
                    return Err(wrong("another rule has that name".to_owned()));
                }
                let pattern = Pattern::parse(&rule.pattern).map_err(wrong)?;
                let makes = match (&rule.makes, &rule.extends) {
                    (Some(class), None) => Makes::New(class.clone()),
                    (None, Some(field)) => Makes::More(field.clone()),
                    _ => return Err(wrong("it either `makes` or `extends` something".to_owned())),
                };
                let first = pattern.first_classes().into_iter().map(str::to_owned).collect();
                level.rules.push(grammar.rules.len());
                let (weight, order, set, examples) = (rule.weight, rule.order, rule.set, rule.examples);
                let file = (*name).to_owned();
                let name = rule.name;
                grammar.rules.push(Rule { name, file, makes, pattern, first, weight, order, set, examples });
            }
            grammar.steps.push(level);
        }
        Ok(grammar)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_of_a_pattern_is_one_of_words_or_made_by_a_rule() {
        let grammar = Grammar::read(FILES).unwrap_or_else(|e| panic!("{e}"));
        let classes = include_str!("../../language/data/classes.toml");
        let mut known: BTreeSet<String> =
            classes.lines().filter_map(|l| l.strip_prefix('[')?.strip_suffix(']').map(str::to_owned)).collect();
        known.extend(["unknown", "mark", "number", "building", "location", "spaced"].map(str::to_owned));
        for rule in &grammar.rules {
            if let Makes::New(class) = &rule.makes {
                known.insert(class.clone());
            }
        }
        for rule in &grammar.rules {
            for (class, _) in rule.pattern.classes() {
                assert!(
                    known.contains(class),
                    "{}: rule `{}` asks for `{class}`, which nothing makes",
                    rule.file,
                    rule.name
                );
            }
        }
    }

    #[test]
    fn wrong_rules_are_named_with_their_file() {
        let check = |text: &str, part: &str| {
            let error = Grammar::read(&[("10_x.toml", text)]).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        };
        check(
            "[[rule]]\nname = \"a\"\nmakes = \"b\"\npattern = \"( c\"",
            "10_x.toml: rule `a`: a bracket is not closed",
        );
        check("[[rule]]\nname = \"a\"\npattern = \"c\"", "either `makes` or `extends`");
        check("[[rul]]", "10_x.toml");
    }
}
