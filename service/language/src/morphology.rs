//! Inflected words meet their lemma: both lose what does not count.

use crate::data::LanguageData;

/// Returns what a folded word and its other forms have in common in a language; the word itself where nothing is known.
pub(crate) fn stem(word: &str, language: &LanguageData) -> String {
    let mut word = word.to_owned();
    for (from, to) in &language.same {
        if word.contains(from.as_str()) {
            word = word.replace(from.as_str(), to);
        }
    }
    let length = word.chars().count();
    if length <= 3 {
        return word;
    }
    let fits = language
        .endings
        .iter()
        .find(|e| word.ends_with(e.strip.as_str()) && length >= e.strip.chars().count() + e.keep);
    if let Some(ending) = fits {
        word.truncate(word.len() - ending.strip.len());
        word.push_str(&ending.put);
    }
    word
}
