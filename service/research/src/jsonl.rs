//! Sentences as JSON lines: `{id, text, lang}` in, `{id, constraints}` out.

use serde::{Deserialize, Serialize};

use crate::Error;
use crate::extract::{Constraint, Extractor};

/// A line in.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct Passage {
    /// Repeated in the answer.
    pub id: String,
    /// One or more sentences, or a table with `|` between cells.
    pub text: String,
    /// ISO 639-1 code; it decides how `1.500` is read. May be absent.
    #[serde(default)]
    pub lang: String,
}

/// A line out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// That of the passage.
    pub id: String,
    /// In the order of the text.
    pub constraints: Vec<Constraint>,
}

/// Returns the passages of a file; blank lines are skipped.
///
/// # Errors
/// Every line that is no passage.
pub fn parse(text: &str) -> Result<Vec<Passage>, Vec<Error>> {
    let mut passages = Vec::new();
    let mut errors = Vec::new();
    for (i, line) in text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty()) {
        match serde_json::from_str(line) {
            Ok(passage) => passages.push(passage),
            Err(e) => {
                let said = e.to_string();
                let reason = said.split(" at line ").next().unwrap_or_default().to_owned();
                errors.push(Error::Line { line: i + 1, reason });
            }
        }
    }
    if errors.is_empty() { Ok(passages) } else { Err(errors) }
}

/// Returns the answers as JSON lines.
pub fn extract(passages: &[Passage]) -> String {
    let extractor = Extractor::shared();
    let mut lines = String::new();
    for passage in passages {
        let findings = extractor.extract(&passage.text, &passage.lang);
        let constraints = findings.into_iter().map(|f| f.constraint).collect();
        let answer = Answer { id: passage.id.clone(), constraints };
        lines += &serde_json::to_string(&answer).expect("strings and finite numbers serialize");
        lines.push('\n');
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bad_line_is_reported() {
        let errors = parse("{\"id\":\"a\",\"text\":\"x\"}\n\nnope\n{\"id\":1}\n").expect_err("two lines are broken");
        let lines: Vec<String> = errors.iter().map(ToString::to_string).collect();
        assert!(lines[0].starts_with("line 3: ") && lines[1].starts_with("line 4: "), "{lines:?}");
    }

    #[test]
    fn the_answer_has_the_form_the_scorer_reads() {
        let passages =
            parse(r#"{"id":"a","text":"Corridors shall be at least 1.2 m wide.","lang":"en"}"#).expect("well formed");
        let value: serde_json::Value = serde_json::from_str(&extract(&passages)).expect("JSON");
        let constraint = &value["constraints"][0];
        assert_eq!(value["id"], "a");
        for (key, expected) in [("name", "width"), ("constraint_type", "minimum"), ("unit", "m"), ("space", "corridor")]
        {
            assert_eq!(constraint[key], expected);
        }
        assert_eq!(constraint["value"], 1.2);
    }
}
