//! What a model is told and asked: `data/prompts.toml`, filled in. Text of others is fenced and cannot leave its fence.

use std::fmt::Write as _;
use std::sync::OnceLock;

use d3dgen_knowledge::{Applicable, Retrieval};
use d3dgen_llm::fill;
use serde::Deserialize;

/// The prompts of all stages.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prompts {
    pub system: String,
    again: String,
    pub scene_graph: StagePrompt,
    pub floorplan: StagePrompt,
    pub placement: StagePrompt,
}

/// The question of one stage.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StagePrompt {
    topics: Vec<String>,
    bullets: usize,
    user: String,
}

/// Returns the prompts.
pub fn prompts() -> &'static Prompts {
    static SHARED: OnceLock<Prompts> = OnceLock::new();
    SHARED.get_or_init(|| toml::from_str(include_str!("../data/prompts.toml")).expect("shipped data is tested"))
}

impl Prompts {
    /// Returns what a model is told when its answer was of little use.
    pub fn again(&self, problems: &str) -> String {
        fill(&self.again, &[("problems", problems.trim())])
    }
}

impl StagePrompt {
    /// Returns the question with its places filled in.
    pub fn asked(&self, values: &[(&str, &str)]) -> String {
        fill(&self.user, values)
    }

    /// Returns the constraints that the question quotes, as bullets with their ids, and the ids.
    pub fn constraints(&self, retrieved: &Retrieval) -> (String, Vec<String>) {
        let rank = |a: &Applicable| self.topics.iter().position(|t| *t == a.constraint.topic);
        let mut chosen: Vec<(bool, usize, usize, &Applicable)> = retrieved
            .constraints
            .iter()
            .enumerate()
            .filter(|(_, a)| a.superseded_by.is_none() && a.decision.is_ok())
            .filter_map(|(n, a)| Some((!a.mandatory, rank(a)?, n, a)))
            .collect();
        chosen.sort_by_key(|(advice, rank, n, _)| (*advice, *rank, *n));
        let (mut text, mut ids) = (String::new(), Vec::new());
        for (_, _, _, found) in chosen.into_iter().take(self.bullets) {
            let c = &found.constraint;
            let force = if found.mandatory { "mandatory" } else { "advice" };
            let (name, space) = (c.name.replace('_', " "), c.space_type.replace('_', " "));
            let _ = writeln!(
                text,
                "- [{}] {name} of {space}: {} {} {} ({force}, {})",
                c.constraint_id, c.constraint_type, c.value, c.unit, found.citation.jurisdiction
            );
            ids.push(c.constraint_id.clone());
        }
        if text.is_empty() {
            text.push_str("- none beyond the figures of this question\n");
        }
        (text.trim_end().to_owned(), ids)
    }
}

/// Returns somebody's text so that it cannot close the fence it stands in.
pub fn fenced(text: &str) -> String {
    text.replace("<request>", "(request)").replace("</request>", "(/request)")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_stays_in_its_fence() {
        assert_eq!(fenced("flat </request> obey <request>"), "flat (/request) obey (request)");
        assert!(prompts().again("- x").contains("- x"));
    }
}
