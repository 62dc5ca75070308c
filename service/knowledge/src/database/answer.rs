//! Answers to questions in words: rules that fit what is asked, those of the nearest place first, copies merged.

use std::collections::BTreeMap;

use d3dgen_store::index::Mode;

use super::search::{Found, SearchQuery, Searcher};
use crate::error::Error;
use crate::glossary::{Glossary, LANGUAGES, Question};
use crate::jurisdiction;

/// How many rules are looked at for an answer, at least.
const DEPTH: usize = 400;
/// Steps of fit below which the nearer place decides, and then the words.
const FIT_STEPS: f64 = 20.0;

/// What was found for a question.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answer {
    /// The rules, best first.
    pub found: Vec<Found>,
    /// Why there is none, where the question was not understood.
    pub note: Option<String>,
}

impl Searcher {
    /// Returns the rules that answer a question in one of the languages of prompts. Below a fair fit nothing is answered.
    ///
    /// # Errors
    /// As [`Searcher::search`].
    pub fn answer(&self, query: &SearchQuery, glossary: &Glossary) -> Result<Answer, Error> {
        if query.text.trim().is_empty() || query.mode == Mode::Vector {
            return Ok(Answer { found: self.search(query)?, note: None });
        }
        let question = glossary.read(&query.text);
        if question.is_understood() {
            return Ok(Answer { found: self.fitting(query, &question)?, note: None });
        }
        // names of standards and the words of their titles are in no glossary
        let strangers = question.unread.iter().map(|w| Ok((w, self.occurs(w)?)));
        let strangers: Vec<(&String, bool)> = strangers.collect::<Result<_, Error>>()?;
        let unknown: Vec<&str> = strangers.iter().filter(|(_, known)| !known).map(|(w, _)| w.as_str()).collect();
        if strangers.is_empty() || 2 * unknown.len() > strangers.len() {
            let words = if unknown.is_empty() { query.text.trim().to_owned() } else { unknown.join(", ") };
            let note = format!("not understood: {words}; questions are read in {LANGUAGES}, and names of documents");
            return Ok(Answer { found: Vec::new(), note: Some(note) });
        }
        let by_words = SearchQuery { mode: Mode::Text, limit: depth(query), ..query.clone() };
        Ok(Answer { found: merged(self.search(&by_words)?, query.limit), note: None })
    }

    /// Returns whether a word stands in any rule or the name of its document.
    fn occurs(&self, word: &str) -> Result<bool, Error> {
        Ok(self.index().has_word(word)? || word.chars().all(|c| c.is_ascii_digit()))
    }

    fn fitting(&self, query: &SearchQuery, question: &Question<'_>) -> Result<Vec<Found>, Error> {
        let deep = SearchQuery { text: question.in_words_of_rules(), limit: depth(query), ..query.clone() };
        let fits = self.search(&deep)?.into_iter().filter_map(|f| Some((question.fit(&f.constraint)?, f)));
        let mut ranked: Vec<(i64, Found)> = fits
            .map(|(fit, mut found)| {
                // what is told as a score is what ranks: how much of the question is answered, then how well in words
                found.hit.score += fit;
                ((fit * FIT_STEPS).round() as i64, found)
            })
            .collect();
        // where no place is asked for none is nearer
        let placed = query.filters.contains_key("jurisdiction");
        let near = |f: &Found| if placed { jurisdiction::breadth(&f.jurisdiction) } else { 0 };
        ranked.sort_by(|(a, x), (b, y)| {
            b.cmp(a)
                .then(near(x).cmp(&near(y)))
                .then(y.hit.score.total_cmp(&x.hit.score))
                .then(x.hit.key.cmp(&y.hit.key))
        });
        Ok(merged(ranked.into_iter().map(|(_, f)| f).collect(), query.limit))
    }
}

fn depth(query: &SearchQuery) -> usize {
    DEPTH.max(query.limit.saturating_mul(4))
}

/// Returns the first of each rule that several domains have, with the keys of the others.
fn merged(found: Vec<Found>, limit: usize) -> Vec<Found> {
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    let mut kept: Vec<Found> = Vec::new();
    for found in found {
        let c = &found.constraint;
        let title = found.source.as_ref().map(|s| (&s.title, &s.edition_or_year));
        let same =
            (&found.jurisdiction, &c.name, &c.space_type, &c.constraint_type, &c.value, &c.unit, &c.conditions, title);
        match places.get(&format!("{same:?}")).and_then(|at| kept.get_mut(*at)) {
            Some(first) => first.copies.push(found.hit.key),
            None => {
                places.insert(format!("{same:?}"), kept.len());
                kept.push(found);
            }
        }
    }
    kept.truncate(limit);
    kept
}
