//! What is known of documents beside their text: `sources.toml`, front matter, the tags of a page, flags.
//!
//! The nearest word counts: `sources.toml`, then the document's own, then the flags. Nothing is guessed; only the
//! publishers of the law themselves are known by their host (`data/source_types.toml`).

use std::collections::BTreeMap;

use d3dgen_model::knowledge::is_jurisdiction;
use serde::Deserialize;

use crate::corpus::canonical_url;
use crate::synthesis::{source_type, source_type_of_host, source_types};

/// Name of the file that lies beside documents.
pub const SIDECAR: &str = "sources.toml";

/// Facts about one document; absent where nothing says them.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Facts {
    /// Address of the document.
    pub url: Option<String>,
    /// Title.
    pub title: Option<String>,
    /// Who published it.
    pub publisher: Option<String>,
    /// Edition or year.
    pub edition: Option<String>,
    /// ISO 3166 code, `EU` or `INT`.
    pub jurisdiction: Option<String>,
    /// Kind of source, by its own name or one that `data/source_types.toml` lists.
    pub source_type: Option<String>,
    /// ISO 639-1.
    pub language: Option<String>,
}

/// `[documents."name or address"]` tables.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sidecar {
    /// By file name below the folder of the file, or by address.
    #[serde(default)]
    pub documents: BTreeMap<String, Facts>,
}

impl Sidecar {
    /// Returns the sidecar in a text.
    ///
    /// # Errors
    /// Every problem, with `place` before it.
    pub fn parse(text: &str, place: &str) -> Result<Self, Vec<String>> {
        let mut sidecar: Self = toml::from_str(text).map_err(|e| {
            let line = e.span().and_then(|s| text.get(..s.start)).map_or(1, |t| t.matches('\n').count() + 1);
            vec![format!("{place}:{line}: {}", e.message())]
        })?;
        let mut problems = Vec::new();
        for (name, facts) in &mut sidecar.documents {
            problems.extend(facts.normalize().into_iter().map(|p| format!("{place}: documents.\"{name}\".{p}")));
        }
        if problems.is_empty() { Ok(sidecar) } else { Err(problems) }
    }

    /// Returns the facts of an address or of a file by its name below the sidecar's folder.
    pub fn facts(&self, name: &str) -> Option<&Facts> {
        let same = |known: &str| canonical_url(known).is_some_and(|k| canonical_url(name).is_some_and(|n| n == k));
        self.documents.get(name).or_else(|| self.documents.iter().find(|(k, _)| same(k)).map(|(_, f)| f))
    }
}

impl Facts {
    /// Brings codes, addresses and kinds into their one form; returns what cannot be.
    pub fn normalize(&mut self) -> Vec<String> {
        let mut problems = Vec::new();
        for field in [&mut self.title, &mut self.publisher, &mut self.edition, &mut self.language] {
            *field = field.take().map(|t| t.split_whitespace().collect::<Vec<_>>().join(" ")).filter(|t| !t.is_empty());
        }
        if let Some(code) = self.jurisdiction.take() {
            let upper = code.trim().to_uppercase();
            if is_jurisdiction(&upper) {
                self.jurisdiction = Some(upper);
            } else {
                problems.push(format!("jurisdiction: `{code}` is no ISO 3166 code (`DE`, `US-NC`), `EU` or `INT`"));
            }
        }
        if let Some(word) = self.source_type.take() {
            match source_type(&word) {
                Some(kind) => self.source_type = Some(kind.to_owned()),
                None => {
                    let known: Vec<&str> = source_types().collect();
                    problems.push(format!("source_type: `{word}` is none of {}", known.join(", ")));
                }
            }
        }
        if let Some(url) = self.url.take() {
            match canonical_url(&url) {
                Some(canonical) => self.url = Some(canonical),
                None => problems.push(format!("url: `{url}` is no address like https://...")),
            }
        }
        problems
    }

    /// Returns what a document says of itself: front matter, or the tags of a page. What is no code, kind or address is
    /// left out and said.
    pub fn of_document(
        title: Option<&str>,
        language: Option<&str>,
        meta: &BTreeMap<String, String>,
    ) -> (Self, Vec<String>) {
        let first = |keys: &[&str]| keys.iter().find_map(|k| meta.get(*k)).cloned();
        let mut facts = Self {
            url: first(&["url", "canonical"]),
            title: first(&["title"]).or_else(|| title.map(str::to_owned)),
            publisher: first(&["publisher", "author", "organization"]),
            edition: first(&["edition", "edition_or_year", "year", "date"]),
            jurisdiction: first(&["jurisdiction", "country_code", "country"]),
            source_type: first(&["source_type"]),
            language: language.map(str::to_owned),
        };
        let problems = facts.normalize();
        (facts, problems)
    }

    /// Returns these facts, with what they lack from others.
    pub fn or(self, other: &Self) -> Self {
        let pick = |a: Option<String>, b: &Option<String>| a.or_else(|| b.clone());
        Self {
            url: pick(self.url, &other.url),
            title: pick(self.title, &other.title),
            publisher: pick(self.publisher, &other.publisher),
            edition: pick(self.edition, &other.edition),
            jurisdiction: pick(self.jurisdiction, &other.jurisdiction),
            source_type: pick(self.source_type, &other.source_type),
            language: pick(self.language, &other.language),
        }
    }

    /// Returns the kind that the host of a fetched page stands for. Only for addresses that were really asked: a page may
    /// claim any.
    pub fn source_type_of(address: &str) -> Option<String> {
        let url = url::Url::parse(address).ok()?;
        url.host_str().and_then(source_type_of_host).map(str::to_owned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sidecar_names_documents_by_file_or_address() {
        let text = "[documents.\"asr.html\"]\njurisdiction = \"de\"\nsource_type = \"Verordnung\"\n\
                    [documents.\"http://example.org/a/\"]\ntitle = \" A  page \"\n";
        let sidecar = Sidecar::parse(text, "sources.toml").unwrap();
        let asr = sidecar.facts("asr.html").unwrap();
        assert_eq!((asr.jurisdiction.as_deref(), asr.source_type.as_deref()), (Some("DE"), Some("regulation")));
        assert_eq!(sidecar.facts("https://example.org/a?utm_source=x").unwrap().title.as_deref(), Some("A page"));
        assert_eq!(sidecar.facts("other.html"), None);
    }

    #[test]
    fn every_problem_of_a_sidecar_is_named() {
        let text = "[documents.a]\njurisdiction = \"Germany\"\nsource_type = \"rumor\"\nurl = \"a.html\"\n";
        let problems = Sidecar::parse(text, "sources.toml").unwrap_err();
        assert_eq!(problems.len(), 3, "{problems:?}");
        assert!(problems.iter().all(|p| p.starts_with("sources.toml: documents.\"a\".")), "{problems:?}");
        let problems = Sidecar::parse("[documents.a]\ntitel = \"x\"\n", "sources.toml").unwrap_err();
        assert!(problems[0].starts_with("sources.toml:2: unknown field `titel`"), "{problems:?}");
    }

    #[test]
    fn a_page_cannot_make_itself_law_by_claiming_an_address() {
        let meta = BTreeMap::from([("canonical".to_owned(), "https://www.gesetze-im-internet.de/x".to_owned())]);
        let (facts, problems) = Facts::of_document(Some("T"), None, &meta);
        assert_eq!((facts.source_type, problems), (None, Vec::new()));
        assert_eq!(Facts::source_type_of("https://www.gesetze-im-internet.de/x").as_deref(), Some("regulation"));
    }
}
