//! What a model said: text, checked JSON, citations and what it used. Whether it is true is not decided here.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The answer to one request.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Answer {
    /// All that was said, without thoughts; for a structured answer the JSON as it was written.
    pub text: String,
    /// The answer as checked JSON, if the request had a schema.
    pub json: Option<Value>,
    /// Sources that the provider attached, merged by URI, in order of appearance.
    pub citations: Vec<Citation>,
    /// Whether sources are attached. If not, the text is the model's memory and is not to be cited.
    pub grounded: bool,
    /// Whether the model searched, with or without result.
    pub searched: bool,
    /// What it searched for.
    pub queries: Vec<String>,
    /// Why a search failed, in the provider's words.
    pub search_error: Option<String>,
    /// Markup that the provider's terms ask to show beside grounded results.
    pub search_entry_point: Option<String>,
    /// Tokens and searches used, all tries of this request together.
    pub usage: Usage,
    /// The model that answered, as the provider names it; may be more precise than what was asked for.
    pub model: String,
    /// How the answer ended.
    pub finish: Finish,
    /// How often the provider was asked, retries and continuations included.
    pub tries: u32,
}

impl Answer {
    /// Returns the supported passages in order of their position, each with the indices of the citations behind it.
    pub fn notes(&self) -> Vec<Note<'_>> {
        let mut notes: Vec<Note<'_>> = Vec::new();
        for (index, citation) in self.citations.iter().enumerate() {
            for segment in &citation.segments {
                match notes.iter_mut().find(|n| n.segment == segment) {
                    Some(note) => note.citations.push(index),
                    None => notes.push(Note { segment, citations: vec![index] }),
                }
            }
        }
        notes.sort_by_key(|n| (n.segment.start.unwrap_or(usize::MAX), n.segment.end));
        notes
    }

    /// Adds a citation, or what it says to the one with the same URI. Returns its index.
    pub(crate) fn cite(&mut self, uri: &str, title: &str) -> usize {
        let uri = plain_uri(uri);
        if let Some(index) = self.citations.iter().position(|c| c.uri == uri) {
            return index;
        }
        self.citations.push(Citation { uri, title: title.trim().to_owned(), ..Citation::default() });
        self.citations.len() - 1
    }

    /// Adds a passage to a citation, once.
    pub(crate) fn support(&mut self, index: usize, segment: Segment) {
        if let Some(citation) = self.citations.get_mut(index)
            && !citation.segments.contains(&segment)
        {
            citation.segments.push(segment);
        }
    }
}

/// A source that the provider attached to an answer.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Citation {
    /// Where it is; may be a redirect of the provider that expires. Nothing here follows it.
    pub uri: String,
    /// Title; with some providers only the domain.
    pub title: String,
    /// Passages of the answer that rest on it.
    pub segments: Vec<Segment>,
    /// What the source itself says, if the provider quotes it.
    pub quotes: Vec<String>,
}

/// A passage of the answer.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Segment {
    /// First byte in [`Answer::text`]; missing where the provider's position does not fit its own text.
    pub start: Option<usize>,
    /// One past the last byte.
    pub end: Option<usize>,
    /// The passage.
    pub text: String,
}

impl Segment {
    /// Makes the segment `start..end` of `text`; `None` where that is no passage of it.
    pub(crate) fn of(text: &str, start: usize, end: usize) -> Option<Self> {
        let passage = text.get(start..end).filter(|p| !p.is_empty())?;
        Some(Self { start: Some(start), end: Some(end), text: passage.to_owned() })
    }
}

/// A supported passage with the sources behind it.
#[derive(Debug, Clone, PartialEq)]
pub struct Note<'a> {
    /// The passage.
    pub segment: &'a Segment,
    /// Indices into [`Answer::citations`].
    pub citations: Vec<usize>,
}

/// Tokens and searches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Usage {
    /// Tokens of the prompt, with what tools put into it.
    pub input: u64,
    /// Tokens of the answer, without thoughts.
    pub output: u64,
    /// Tokens of thoughts; providers bill them as output.
    pub thoughts: u64,
    /// Searches that ran.
    pub searches: u64,
    /// Whether a figure was guessed from the length of the text, because the provider gave none.
    pub estimated: bool,
}

impl Usage {
    /// Returns all tokens.
    pub fn tokens(&self) -> u64 {
        self.input.saturating_add(self.output).saturating_add(self.thoughts)
    }

    /// Adds another usage.
    pub fn add(&mut self, other: &Self) {
        self.input = self.input.saturating_add(other.input);
        self.output = self.output.saturating_add(other.output);
        self.thoughts = self.thoughts.saturating_add(other.thoughts);
        self.searches = self.searches.saturating_add(other.searches);
        self.estimated |= other.estimated;
    }
}

/// How an answer ended.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finish {
    /// As the model meant it to.
    #[default]
    Stop,
    /// The provider did not say.
    Unknown,
    /// For a reason this crate does not know, by the provider's name.
    Other(String),
}

/// Returns a URI without the marks that a provider adds to count visits, so that the same page is one source.
fn plain_uri(uri: &str) -> String {
    let (rest, fragment) = match uri.split_once('#') {
        Some((rest, fragment)) => (rest, Some(fragment)),
        None => (uri, None),
    };
    let Some((page, query)) = rest.split_once('?') else { return uri.trim().to_owned() };
    let kept: Vec<&str> = query.split('&').filter(|p| !p.starts_with("utm_source=") && !p.is_empty()).collect();
    let mut plain = page.to_owned();
    if !kept.is_empty() {
        plain = format!("{page}?{}", kept.join("&"));
    }
    if let Some(fragment) = fragment {
        plain = format!("{plain}#{fragment}");
    }
    plain.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_visits_are_dropped_and_the_rest_is_kept() {
        let check = |uri: &str, expected: &str| assert_eq!(plain_uri(uri), expected);
        check("https://a.test/b?utm_source=openai", "https://a.test/b");
        check("https://a.test/b?x=1&utm_source=openai&y=2#part", "https://a.test/b?x=1&y=2#part");
        check("https://a.test/b?utm_source=openai#part", "https://a.test/b#part");
        check("https://a.test/b#utm_source=openai", "https://a.test/b#utm_source=openai");
    }

    #[test]
    fn a_page_cited_twice_is_one_citation_and_passages_become_notes() {
        let mut answer = Answer { text: "one two".into(), ..Answer::default() };
        let a = answer.cite("https://a.test/?utm_source=openai", "A");
        let b = answer.cite("https://b.test/", "B");
        assert_eq!(answer.cite("https://a.test/", "again"), a);
        let segment = |s, e| Segment::of("one two", s, e).unwrap();
        answer.support(b, segment(0, 3));
        answer.support(a, segment(4, 7));
        answer.support(a, segment(0, 3));
        answer.support(9, segment(0, 3));
        let notes = answer.notes();
        assert_eq!(notes.iter().map(|n| n.segment.text.as_str()).collect::<Vec<_>>(), ["one", "two"]);
        assert_eq!((&notes[0].citations, &notes[1].citations), (&vec![a, b], &vec![a]));
        assert!(Segment::of("m²", 0, 2).is_none() && Segment::of("m", 1, 9).is_none());
    }
}
