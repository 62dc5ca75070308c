//! Notes of a model's search: eight topics, some passes each, and what of its answers rests on a source.
//!
//! No link is followed. A passage here is what the provider returned with a source: its own quotation of the page, or the
//! sentence that it says the page supports. Text without a source is kept as a note and proves nothing.

use std::collections::BTreeSet;

use d3dgen_llm::{Answer, Grounding, Request, fill};
use serde::{Deserialize, Serialize};

use super::prompts::{fenced, prompts};
use super::structure::sentence;
use crate::corpus::canonical_url;
use crate::corpus::document_id_of_url;
use crate::corpus::record::{DocumentRecord, PassageRecord, Record};
use crate::synthesis::slug::hash;
use crate::synthesis::topics;

/// Output tokens of a search answer, thoughts included.
const OUTPUT_TOKENS: u32 = 8_192;

/// An answer to a search, for people to read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Note {
    /// One of the eight topics.
    pub topic: String,
    /// From 1.
    pub pass: u32,
    /// Whether the provider attached sources.
    pub grounded: bool,
    /// Addresses it attached.
    pub sources: Vec<String>,
    /// What was searched for.
    pub queries: Vec<String>,
    /// All that was said.
    pub text: String,
}

impl Record for Note {
    const FILE: &'static str = "notes.jsonl";

    fn problems(&self) -> Vec<String> {
        let known = topics().any(|t| t.id == self.topic);
        if known { Vec::new() } else { vec![format!("topic `{}` is none of the eight", self.topic)] }
    }
}

/// Returns the requests of all topics and passes, each with its topic and pass.
pub fn requests(domain: &str, country: Option<&str>, passes: u32, max_searches: u32) -> Vec<(String, u32, Request)> {
    let prompts = prompts();
    let code = country.and_then(|c| c.get(..2)).filter(|c| !matches!(*c, "EU" | "IN" if country != Some("IN")));
    let mut out = Vec::new();
    for pass in 1..=passes {
        for topic in topics() {
            let focus = (pass as usize - 1) % prompts.focus.len().max(1);
            let focus = prompts.focus.get(focus).map_or("", |f| f.text.as_str());
            let domain = fenced(domain);
            let values = [
                ("domain", domain.as_str()),
                ("country", country.unwrap_or("not given; international rules")),
                ("topic", topic.title.as_str()),
                ("question", topic.question.as_str()),
                ("focus", focus),
            ];
            let mut request = Request::new(format!("search/{}/{pass}", topic.id), fill(&prompts.search.user, &values))
                .with_system(fill(&prompts.search.system, &values))
                .with_grounding(Grounding { max_searches, country: code.map(str::to_owned), ..Grounding::default() });
            request.max_output_tokens = OUTPUT_TOKENS;
            out.push((topic.id.clone(), pass, request));
        }
    }
    out
}

/// What an answer brings.
#[derive(Debug, Default)]
pub struct Found {
    /// Pages it cites; known only by what was quoted of them.
    pub documents: Vec<DocumentRecord>,
    /// What was quoted, each for the page it rests on.
    pub passages: Vec<PassageRecord>,
}

/// Returns the cited pages of an answer and the passages that rest on them.
pub fn found(answer: &Answer, topic: &str, country: Option<&str>, date: &str) -> Found {
    let mut out = Found::default();
    if !answer.grounded {
        return out;
    }
    let ids: Vec<Option<String>> = answer
        .citations
        .iter()
        .map(|citation| {
            let url = canonical_url(&citation.uri)?;
            let document_id = document_id_of_url(&url);
            let title = Some(citation.title.trim().to_owned()).filter(|t| !t.is_empty());
            out.documents.push(DocumentRecord {
                document_id: document_id.clone(),
                source: url.clone(),
                url: Some(url),
                sha256: String::new(),
                title,
                publisher: None,
                edition: None,
                jurisdiction: country.map(str::to_owned),
                source_type: None,
                language: String::new(),
                retrieved_at: date.to_owned(),
                quoted_only: true,
                warnings: Vec::new(),
            });
            Some(document_id)
        })
        .collect();
    let mut seen = BTreeSet::new();
    let mut add = |document_id: &str, text: &str| {
        let text = text.trim();
        let passage_id = format!("q_{}", hash(text));
        if !text.is_empty() && seen.insert((document_id.to_owned(), passage_id.clone())) {
            out.passages.push(PassageRecord {
                passage_id,
                document_id: document_id.to_owned(),
                heading: Vec::new(),
                kind: "quote".to_owned(),
                page: None,
                topic: Some(topic.to_owned()),
                text: text.to_owned(),
            });
        }
    };
    for (citation, id) in answer.citations.iter().zip(&ids) {
        let Some(id) = id else { continue };
        citation.quotes.iter().for_each(|quote| add(id, quote));
    }
    for note in answer.notes() {
        let text = supported(answer, note.segment);
        for id in note.citations.iter().filter_map(|i| ids.get(*i)).flatten() {
            add(id, text);
        }
    }
    out
}

/// Returns the passage that a segment marks: itself, or the sentence it stands in where it is only a reference mark.
fn supported<'a>(answer: &'a Answer, segment: &'a d3dgen_llm::Segment) -> &'a str {
    let digits = segment.text.bytes().any(|b| b.is_ascii_digit());
    let whole = segment.start.zip(segment.end).filter(|_| !digits || segment.text.contains("](http"));
    whole.and_then(|(start, end)| answer.text.get(sentence(&answer.text, start, end))).unwrap_or(&segment.text)
}

#[cfg(test)]
mod tests {
    use d3dgen_llm::{Citation, Segment};

    use super::*;

    fn answer(grounded: bool) -> Answer {
        let text = "Corridors are 1.5 m wide ([x](https://a.test)). Doors are 0.9 m wide.";
        let segment = |start: usize, end: usize| Segment {
            start: Some(start),
            end: Some(end),
            text: text[start..end].to_owned(),
        };
        Answer {
            text: text.to_owned(),
            grounded,
            citations: vec![
                Citation {
                    uri: "http://a.test/?utm_source=openai".into(),
                    title: "A".into(),
                    segments: vec![segment(25, 46)],
                    quotes: vec!["Corridors: 1.5 m".into()],
                },
                Citation {
                    uri: "javascript:alert(1)".into(),
                    segments: vec![segment(48, text.len())],
                    ..Citation::default()
                },
            ],
            ..Answer::default()
        }
    }

    #[test]
    fn only_what_rests_on_an_address_is_evidence() {
        let found = found(&answer(true), "room_size", Some("DE"), "2026-11-21");
        assert_eq!(found.documents.len(), 1);
        assert!(found.documents[0].quoted_only);
        let texts: Vec<&str> = found.passages.iter().map(|p| p.text.as_str()).collect();
        assert_eq!(texts, ["Corridors: 1.5 m", "Corridors are 1.5 m wide ([x](https://a.test))."]);
        assert!(super::found(&answer(false), "room_size", None, "2026-11-21").documents.is_empty());
    }

    #[test]
    fn every_topic_is_asked_in_every_pass() {
        let requests = requests("hospital", Some("DE"), 2, 5);
        assert_eq!(requests.len(), 16);
        let labels: BTreeSet<&str> = requests.iter().map(|r| r.2.stage.as_str()).collect();
        assert_eq!(labels.len(), 16);
        assert!(requests.iter().all(|r| !r.2.messages[0].text.contains('{')));
        assert_ne!(requests[0].2.messages, requests[8].2.messages);
    }
}
