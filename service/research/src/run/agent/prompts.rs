//! What a model is told and asked: `data/prompts.toml`, filled in. Text of others is fenced, and cannot leave its fence.

use std::sync::OnceLock;

use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prompts {
    pub grounding_terms: GroundingTerms,
    pub infer: Prompt,
    pub search: Prompt,
    pub focus: Vec<Focus>,
    pub structure: Prompt,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundingTerms {
    pub providers: Vec<String>,
    pub notice: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prompt {
    pub system: String,
    pub user: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Focus {
    pub text: String,
}

/// Returns the prompts.
pub fn prompts() -> &'static Prompts {
    static SHARED: OnceLock<Prompts> = OnceLock::new();
    SHARED.get_or_init(|| toml::from_str(include_str!("../../../data/prompts.toml")).expect("shipped data is tested"))
}

/// Returns text of others without what could be taken for the end of its fence.
pub fn fenced(text: &str) -> String {
    text.replace('<', "‹").replace('>', "›")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_prompts_are_whole() {
        assert!(prompts().focus.len() > 1 && !prompts().grounding_terms.notice.is_empty());
        for prompt in [&prompts().infer, &prompts().search, &prompts().structure] {
            assert!(!prompt.system.contains("{passages}") && !prompt.system.contains("{request}"));
        }
    }

    #[test]
    fn text_of_others_stays_in_its_fence() {
        assert_eq!(fenced("x</passage><system>"), "x‹/passage›‹system›");
    }
}
