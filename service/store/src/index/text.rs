//! Full text by tantivy: an inverted index of the terms of `analyze.rs`, ranked by BM25 with boosts of fields.
//!
//! It lives in memory: its files are read whole to compare their checksums anyway, and a mapped file that another
//! process cuts off would end this one. The words of a question are looked up one by one and never go through a query
//! language, so that no text can be refused. Row numbers are tantivy's document numbers: there is one segment.

use std::path::Path;
use std::sync::{Mutex, OnceLock};

use tantivy::directory::{Directory, MmapDirectory, RamDirectory};
use tantivy::query::{BooleanQuery, BoostQuery, EnableScoring, Occur, Query, TermQuery};
use tantivy::schema::{Field, IndexRecordOption, Schema, TextFieldIndexing, TextOptions};
use tantivy::tokenizer::{PreTokenizedString, Token};
use tantivy::{Index, IndexSettings, ReloadPolicy, Searcher, TantivyDocument, TantivyError, Term};

use super::analyze::{Analyzer, Word, is_stop_word};
use super::document::{IndexSpec, Phase, Watch};
use super::guess::{Guesser, Vocabulary};
use super::row_set::RowSet;
use super::top::{Scored, Top};
use crate::error::{Error, Result};

/// Weight of a stem against the word as it is written.
const STEM_WEIGHT: f32 = 0.5;
/// Weight of a word that differs in one letter, or is a part of the word asked for.
const GUESS_WEIGHT: f32 = 0.6;
/// Words of a question that are looked at; the rest of a pasted page adds nothing.
const WORDS_MOST: usize = 64;
/// Memory of tantivy's writer before it complains, in bytes; one segment is written at the end either way.
const WRITER_BYTES: usize = 256 << 20;

/// The inverted index of all rows.
pub(crate) struct TextIndex {
    directory: RamDirectory,
    searcher: Searcher,
    fields: Vec<(Field, f32)>,
    analyzer: Mutex<Analyzer>,
    vocabulary: OnceLock<Vocabulary>,
}

impl std::fmt::Debug for TextIndex {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "TextIndex of {} rows", self.searcher.num_docs())
    }
}

impl TextIndex {
    /// Indexes the texts of rows, each in the order of the fields.
    pub(crate) fn new(spec: &IndexSpec, rows: Vec<Box<[Box<str>]>>, watch: Watch<'_>) -> Result<Self> {
        let (schema, fields) = schema(spec);
        let directory = RamDirectory::create();
        let builder = Index::builder().schema(schema).settings(IndexSettings::default());
        let mut writer = builder.single_segment_index_writer(directory.clone(), WRITER_BYTES).map_err(failed)?;
        let mut analyzer = Analyzer::new();
        let count = rows.len();
        for (done, texts) in rows.into_iter().enumerate() {
            if done % 1000 == 0 {
                watch.step(Phase::Words, done, count)?;
            }
            let mut row = TantivyDocument::default();
            for ((field, _), text) in fields.iter().zip(&texts) {
                row.add_pre_tokenized_text(*field, tokens(&mut analyzer, text));
            }
            writer.add_document(row).map_err(failed)?;
        }
        writer.finalize().map_err(failed)?;
        Self::open(spec, directory)
    }

    /// Opens the files that [`TextIndex::write`] wrote, given as names and contents.
    pub(crate) fn read<'a>(spec: &IndexSpec, files: impl Iterator<Item = (&'a str, &'a [u8])>) -> Result<Self> {
        let directory = RamDirectory::create();
        for (name, bytes) in files {
            let put = directory.atomic_write(Path::new(name), bytes);
            put.map_err(|e| Error::Index { what: format!("{name} was not read: {e}") })?;
        }
        Self::open(spec, directory)
    }

    /// Writes the files into an empty folder.
    pub(crate) fn write(&self, dir: &Path) -> Result<()> {
        let target = MmapDirectory::open(dir).map_err(|e| failed(e.into()))?;
        self.directory.persist(&target).map_err(failed)
    }

    fn open(spec: &IndexSpec, directory: RamDirectory) -> Result<Self> {
        let (schema, fields) = schema(spec);
        let index = Index::open(directory.clone()).map_err(failed)?;
        if index.schema() != schema {
            return Err(Error::Index { what: "the fields of the full text are others than asked for".to_owned() });
        }
        let reader = index.reader_builder().reload_policy(ReloadPolicy::Manual).try_into().map_err(failed)?;
        let searcher = reader.searcher();
        if searcher.segment_readers().len() > 1 {
            return Err(Error::Index { what: "the full text has several segments".to_owned() });
        }
        Ok(Self { directory, searcher, fields, analyzer: Mutex::new(Analyzer::new()), vocabulary: OnceLock::new() })
    }

    /// Returns how many rows there are.
    pub(crate) fn rows(&self) -> u64 {
        self.searcher.num_docs()
    }

    /// Returns the `limit` rows that fit best by their words, best first; rows without any of the words are not found.
    ///
    /// How much a word tells is taken from `among`, where there is one: a few rows say nothing of how rare a word is.
    pub(crate) fn search(
        &self,
        text: &str,
        limit: usize,
        allowed: Option<&RowSet>,
        among: Option<&Self>,
    ) -> Result<Vec<Scored>> {
        let words = self.analyzer.lock().unwrap_or_else(|broken| broken.into_inner()).words(text);
        let query = self.query(&words)?;
        let (Some(reader), Some(query)) = (self.searcher.segment_readers().first(), query) else {
            return Ok(Vec::new());
        };
        let statistics = among.map_or(&self.searcher, |other| &other.searcher);
        let scoring = EnableScoring::enabled_from_statistics_provider(statistics, &self.searcher);
        let weight = query.weight(scoring).map_err(failed)?;
        let mut top = Top::new(limit);
        let mut consider = |row, score| {
            if allowed.is_none_or(|allowed| allowed.contains(row)) {
                top.push(score, row);
            }
            top.threshold().unwrap_or(f32::MIN)
        };
        weight.for_each_pruning(f32::MIN, reader, &mut consider).map_err(failed)?;
        Ok(top.into_sorted())
    }

    /// Returns whether any row has every word of a text, or one that it is a slip of.
    pub(crate) fn has_word(&self, text: &str) -> Result<bool> {
        let words = self.analyzer.lock().unwrap_or_else(|broken| broken.into_inner()).words(text);
        for word in &words {
            if self.query(std::slice::from_ref(word))?.is_none() {
                return Ok(false);
            }
        }
        Ok(!words.is_empty())
    }

    /// Returns the question as alternatives of terms that occur, if any does.
    fn query(&self, words: &[Word]) -> Result<Option<BooleanQuery>> {
        let Some(reader) = self.searcher.segment_readers().first() else { return Ok(None) };
        let fields = self.fields.iter().map(|(field, boost)| Ok((*field, *boost, reader.inverted_index(*field)?)));
        let fields = fields.collect::<Result<Vec<_>, TantivyError>>().map_err(failed)?;
        let guesser = Guesser::new(fields.iter().map(|(_, _, index)| index.terms()).collect(), &self.vocabulary);
        let telling = words.iter().any(|word| !is_stop_word(word.text()));
        let mut alternatives: Vec<(Occur, Box<dyn Query>)> = Vec::new();
        let mut asked = Vec::new();
        for word in words.iter().filter(|word| !telling || !is_stop_word(word.text())).take(WORDS_MOST) {
            if asked.contains(&word.text()) {
                continue;
            }
            asked.push(word.text());
            let mut terms: Vec<(String, f32)> = Vec::new();
            for (place, term) in word.terms.iter().enumerate() {
                if guesser.occurs(term).map_err(failed_io)? {
                    terms.push((term.clone(), if place == 0 { 1.0 } else { STEM_WEIGHT }));
                }
            }
            if terms.is_empty() {
                let guesses = guesser.guess(word).map_err(failed_io)?;
                terms.extend(guesses.into_iter().map(|guess| (guess, GUESS_WEIGHT)));
            }
            for (term, weight) in terms {
                for (field, boost, index) in &fields {
                    if index.terms().get(&term).map_err(failed_io)?.is_some() {
                        let query = TermQuery::new(Term::from_field_text(*field, &term), IndexRecordOption::WithFreqs);
                        alternatives.push((Occur::Should, Box::new(BoostQuery::new(Box::new(query), boost * weight))));
                    }
                }
            }
        }
        Ok((!alternatives.is_empty()).then(|| BooleanQuery::new(alternatives)))
    }
}

fn schema(spec: &IndexSpec) -> (Schema, Vec<(Field, f32)>) {
    let mut builder = Schema::builder();
    // Positions would serve phrases, which nobody asks for.
    let indexing = TextFieldIndexing::default().set_tokenizer("raw").set_index_option(IndexRecordOption::WithFreqs);
    let options = TextOptions::default().set_indexing_options(indexing);
    let fields = spec.fields.iter().map(|f| (builder.add_text_field(&f.name, options.clone()), f.boost)).collect();
    (builder.build(), fields)
}

fn tokens(analyzer: &mut Analyzer, text: &str) -> PreTokenizedString {
    let words = analyzer.words(text);
    let tokens = words.into_iter().enumerate().flat_map(|(position, word)| {
        word.terms.into_iter().map(move |text| Token { position, text, ..Token::default() })
    });
    PreTokenizedString { text: String::new(), tokens: tokens.collect() }
}

fn failed(error: TantivyError) -> Error {
    Error::Index { what: format!("full text: {error}") }
}

fn failed_io(error: std::io::Error) -> Error {
    Error::Index { what: format!("full text: {error}") }
}
