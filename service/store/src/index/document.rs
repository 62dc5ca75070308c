//! What goes into an index and what comes out; nothing here is stored as it is.

use std::collections::BTreeMap;

use serde::Serialize;
use twox_hash::XxHash3_64;

use crate::error::{Error, Result};

/// One thing to be found: the texts to search in, what to filter by, and the key to find the record again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// Key of the record; unique in an index. Equal scores are ordered by it.
    pub key: String,
    /// Texts by name of field, see [`IndexSpec::fields`]. Fields that are left out are empty.
    pub texts: BTreeMap<String, String>,
    /// Values to filter by, see [`IndexSpec::facets`]; several values of one facet are alternatives.
    pub facets: BTreeMap<String, Vec<String>>,
    /// Numbers to filter by, see [`IndexSpec::numbers`].
    pub numbers: BTreeMap<String, f64>,
    /// What the embedder reads; when empty, the document is not found by meaning.
    pub embed_text: String,
}

/// A text field and its weight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TextField {
    /// Its name.
    pub name: String,
    /// How much a word here counts against a word in a field of boost 1.
    pub boost: f32,
}

/// Which fields the documents of an index have. An index that was made with another one is rebuilt.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct IndexSpec {
    /// Fields that full text searches.
    pub fields: Vec<TextField>,
    /// Names of facets.
    pub facets: Vec<String>,
    /// Names of numbers.
    pub numbers: Vec<String>,
}

impl IndexSpec {
    /// Adds a text field.
    #[must_use]
    pub fn field(mut self, name: &str, boost: f32) -> Self {
        self.fields.push(TextField { name: name.to_owned(), boost });
        self
    }

    /// Adds facets.
    #[must_use]
    pub fn facets(mut self, names: &[&str]) -> Self {
        self.facets.extend(names.iter().map(|&n| n.to_owned()));
        self
    }

    /// Adds numbers.
    #[must_use]
    pub fn numbers(mut self, names: &[&str]) -> Self {
        self.numbers.extend(names.iter().map(|&n| n.to_owned()));
        self
    }

    /// Returns a digest that changes with every name and boost.
    pub(crate) fn digest(&self) -> String {
        let text = serde_json::to_string(self).expect("names and numbers are always JSON");
        format!("{:016x}", XxHash3_64::oneshot(text.as_bytes()))
    }

    /// Refuses a document with a field that this index does not have: it would silently not be found by it.
    pub(crate) fn check(&self, document: &Document) -> Result<()> {
        let fields: Vec<&String> = self.fields.iter().map(|f| &f.name).collect();
        let facets: Vec<&String> = self.facets.iter().collect();
        let numbers: Vec<&String> = self.numbers.iter().collect();
        known("text field", document.texts.keys(), &fields)?;
        known("facet", document.facets.keys(), &facets)?;
        known("number", document.numbers.keys(), &numbers)
    }
}

/// Refuses the first name that is not known.
pub(crate) fn known<'a>(
    kind: &'static str,
    mut names: impl Iterator<Item = &'a String>,
    known: &[&String],
) -> Result<()> {
    match names.find(|name| !known.contains(name)) {
        None => Ok(()),
        Some(name) => Err(Error::UnknownField {
            kind,
            name: name.clone(),
            known: known.iter().map(|k| k.as_str()).collect::<Vec<_>>().join(", "),
        }),
    }
}

/// How to search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// By words and by meaning, both rankings fused.
    #[default]
    Hybrid,
    /// By words only.
    Text,
    /// By meaning only.
    Vector,
}

/// One document that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Hit {
    /// Its key.
    pub key: String,
    /// The sum over the rankings it is in of 1 / (60 + rank); 0 when everything was asked for.
    pub score: f64,
    /// Its place by words, from 1; none when they did not find it.
    pub text_rank: Option<usize>,
    /// Its place by meaning, from 1; none when it was not among the nearest.
    pub vector_rank: Option<usize>,
    /// The cosine between its vector and the question's, when it was found by meaning.
    pub similarity: Option<f32>,
}

/// How far a rebuild has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is being done.
    pub phase: Phase,
    /// How many documents this phase has done.
    pub done: u64,
    /// How many there are; 0 while that is not known.
    pub total: u64,
}

/// The steps of a rebuild.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Another process rebuilds the same index; waiting for it.
    Waiting,
    /// The documents are being read.
    Reading,
    /// Words are being indexed; beside [`Phase::Meaning`], so that reports of both mix.
    Words,
    /// Vectors are being made.
    Meaning,
    /// The graph of neighbors is being made; only large indexes have one.
    Linking,
    /// The files are being written.
    Writing,
}

/// What a rebuild tells and asks its caller meanwhile, possibly from another thread.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Called now and then, at the latest every 1,000 documents.
    pub progress: &'a (dyn Fn(Progress) + Sync),
    /// Asked now and then; when it answers true the rebuild ends with [`Error::Cancelled`] and leaves nothing behind.
    pub cancel: &'a (dyn Fn() -> bool + Sync),
}

impl Watch<'_> {
    /// Tells nobody and is never cancelled.
    #[must_use]
    pub fn nobody() -> Self {
        Self { progress: &|_| (), cancel: &|| false }
    }

    /// Tells how far the phase has come, and ends it when the caller wants that.
    pub(crate) fn step(&self, phase: Phase, done: usize, total: usize) -> Result<()> {
        if (self.cancel)() {
            return Err(Error::Cancelled);
        }
        (self.progress)(Progress { phase, done: done as u64, total: total as u64 });
        Ok(())
    }
}
