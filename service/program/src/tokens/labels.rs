//! Words that stand on plans and not in prompts (`labels.toml`), as the English words they stand for: "Kit.", "Slaapkamer", "寝室".

use std::collections::BTreeMap;
use std::sync::LazyLock;

use super::text::fold;

/// English words by folded label; the languages share no word with different meanings.
static LABELS: LazyLock<BTreeMap<String, String>> = LazyLock::new(|| {
    let data: BTreeMap<String, BTreeMap<String, String>> =
        toml::from_str(include_str!("labels.toml")).expect("a test reads labels.toml");
    data.into_values().flatten().map(|(label, english)| (folded(&label), english)).collect()
});

/// Returns the English words for a label, or for the first of its words that stands for any; figures do not count.
pub(crate) fn in_english(label: &str) -> Option<&'static str> {
    let label = folded(label);
    let meaning = |words: &str| LABELS.get(words).map(String::as_str);
    meaning(&label).or_else(|| label.split(' ').find_map(meaning))
}

/// Returns the words of a label in lower case without accents, marks and figures.
fn folded(label: &str) -> String {
    let words = label.split(|c: char| !c.is_alphabetic() && !is_letter_mark(c)).map(fold);
    words.filter(|w| !w.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Returns true for marks inside of words: the long vowels of Japanese, and accents written as letters of their own.
fn is_letter_mark(c: char) -> bool {
    matches!(c, 'ー' | '\'' | '’' | '\u{300}'..='\u{36f}')
}

#[cfg(test)]
mod tests {
    use d3dgen_plugins::Registry;

    use super::*;
    use crate::given::Names;

    #[test]
    fn every_label_means_a_room_of_some_domain_and_is_said_once() {
        let registry = Registry::builtin();
        let names: Vec<Names> = registry.iter().map(|p| Names::new(p.domain())).collect();
        for (label, english) in LABELS.iter() {
            assert!(names.iter().any(|n| n.find(english).is_some()), "{label} = {english}");
        }
        let lines = include_str!("labels.toml").lines().filter(|l| l.contains(" = ")).count();
        assert_eq!(LABELS.len(), lines);
    }

    #[test]
    fn figures_and_marks_do_not_count() {
        assert_eq!(in_english("Kit."), Some("kitchen"));
        assert_eq!(in_english("LR 2"), Some("living room"));
        assert_eq!(in_english("Ch. 1 (12 m2)"), Some("bedroom"));
        assert_eq!(in_english("Foundry"), None);
    }
}
