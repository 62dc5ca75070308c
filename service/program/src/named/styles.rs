//! Words of style in prompts, from `styles.toml`: "cluttered", "kompakt", "plan ouvert", "对称".

use std::collections::BTreeMap;
use std::sync::LazyLock;

use d3dgen_model::scene_graph::Note;
use d3dgen_model::style::{Style, StyleWord};

use crate::named::mention::Mention;
use crate::tokens::text::{Phrases, Span, Token};

/// A word of style in a prompt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Said {
    pub span: Span,
    pub word: StyleWord,
}

/// Key of the words that take back a word of style right after them.
const NOT: &str = "not";

/// Returns the phrases of each language; `None` is one that takes the next back.
fn phrases() -> &'static BTreeMap<String, Phrases<Option<StyleWord>>> {
    static ALL: LazyLock<BTreeMap<String, Phrases<Option<StyleWord>>>> = LazyLock::new(|| {
        let file: BTreeMap<String, BTreeMap<String, Vec<String>>> =
            toml::from_str(include_str!("styles.toml")).expect("a test reads styles.toml");
        let language = |words: BTreeMap<String, Vec<String>>| {
            let mut out = Phrases::new("");
            for (word, list) in words {
                let meaning = (word != NOT).then(|| StyleWord::of(&word).expect("a test reads styles.toml"));
                list.iter().for_each(|phrase| out.insert(phrase, meaning));
            }
            out
        };
        file.into_iter().map(|(code, words)| (code, language(words))).collect()
    });
    &ALL
}

/// Returns the words of style in a prompt, in its order: not those that it takes back, as "not too compact" does.
pub(crate) fn said(tokens: &[Token], languages: &[&str]) -> Vec<Said> {
    let spoken: Vec<_> = languages.iter().filter_map(|l| phrases().get(*l)).collect();
    let mut out = Vec::new();
    let mut not_until = None;
    let mut i = 0;
    while i < tokens.len() {
        let found = spoken.iter().filter_map(|p| p.longest_at(tokens, i)).max_by_key(|(end, _)| *end);
        match found {
            Some((end, Some(word))) => {
                if not_until != Some(i) {
                    out.push(Said { span: Span { start: i, end }, word: *word });
                }
                i = end;
            }
            Some((end, None)) => {
                not_until = Some(end);
                i = end;
            }
            None => i += 1,
        }
    }
    out
}

/// Leaves to rooms what is said of one: "a spacious kitchen" makes no generous building.
pub(crate) fn of_building(said: Vec<Said>, mentions: &[Mention], language: &str) -> Vec<Said> {
    let after = matches!(language, "fr" | "es");
    let of_room = |s: &Said| {
        mentions.iter().filter(|m| m.room_type().is_some()).any(|m| {
            let before = (s.span.end..=s.span.end + 1).contains(&m.span.start);
            before && (language == "zh" || m.span.start == s.span.end) || after && m.span.end == s.span.start
        })
    };
    said.into_iter()
        .filter(|s| !matches!(s.word, StyleWord::Space(_) | StyleWord::Symmetry(_)) || !of_room(s))
        .collect()
}

/// Returns the style that flags ask for, and where they are silent the prompt; of two opposites the first is taken.
pub(crate) fn wished(said: &[Said], flags: Style, conflicts: &mut Vec<Note>) -> Style {
    let mut style = Style::default();
    for Said { word, .. } in said {
        if !style.add(*word) {
            let message = format!("the prompt asks for {} and the opposite; what came first was taken", word.label());
            conflicts.push(Note::new("contradicting_styles", message));
        }
    }
    let all = flags.or(style);
    if all != style.or(flags) {
        conflicts.push(Note::new(
            "style_flag",
            "the prompt and the request differ in style; the request was followed".into(),
        ));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tokens::text::tokens;

    fn style(prompt: &str, language: &str) -> String {
        let said = said(&tokens(prompt), &[language, "en"]);
        serde_json::to_string(&wished(&said, Style::default(), &mut Vec::new())).unwrap()
    }

    #[test]
    fn every_language_has_every_word() {
        assert_eq!(phrases().keys().collect::<Vec<_>>(), ["de", "en", "es", "fr", "ko", "zh"]);
        let file: BTreeMap<String, BTreeMap<String, Vec<String>>> =
            toml::from_str(include_str!("styles.toml")).unwrap();
        for (code, words) in &file {
            assert_eq!(words.len(), 15, "{code}");
            assert!(words.values().all(|list| !list.is_empty()), "{code}");
        }
    }

    #[test]
    fn prompts_in_all_languages_state_their_style() {
        let cases = [
            ("a messy two-bedroom flat", "en", r#"{"clutter":"high"}"#),
            ("Lived-in apartment with a study", "en", r#"{"clutter":"high"}"#),
            ("an uncluttered, spacious office", "en", r#"{"clutter":"low","space":"generous"}"#),
            ("compact symmetrical clinic", "en", r#"{"space":"compact","symmetry":"symmetric"}"#),
            ("office with an open floor plan", "en", r#"{"layout":"open"}"#),
            ("open-plan office for 20 people", "en", "{}"),
            ("racetrack ward with 24 patient rooms", "en", r#"{"form":"racetrack"}"#),
            ("Büro mit 20 Räumen um einen Innenhof", "de", r#"{"form":"courtyard"}"#),
            ("L-shaped house", "en", r#"{"form":"l_shaped"}"#),
            ("a not too compact flat", "en", "{}"),
            ("not spacious, not symmetrical and tidy", "en", r#"{"clutter":"low","symmetry":"asymmetric"}"#),
            ("nicht zu kompakte Wohnung", "de", "{}"),
            ("kompakte, aufgeräumte Wohnung", "de", r#"{"clutter":"low","space":"compact"}"#),
            ("appartement spacieux et encombré", "fr", r#"{"clutter":"high","space":"generous"}"#),
            ("oficina de planta abierta y ordenada", "es", r#"{"clutter":"low","layout":"open"}"#),
            ("凌乱的三室两厅", "zh", r#"{"clutter":"high"}"#),
            ("깔끔한 사무실", "ko", r#"{"clutter":"low"}"#),
        ];
        for (prompt, language, wished) in cases {
            assert_eq!(style(prompt, language), wished, "{prompt}");
        }
    }

    #[test]
    fn flags_win_and_opposites_are_told() {
        let said = said(&tokens("tidy but cluttered flat"), &["en"]);
        let mut conflicts = Vec::new();
        assert_eq!(wished(&said, Style::default(), &mut conflicts).clutter, Some(d3dgen_model::style::Clutter::Low));
        assert_eq!(conflicts.len(), 1, "{conflicts:?}");
        let flags = Style { clutter: Some(d3dgen_model::style::Clutter::High), ..Style::default() };
        let style = wished(&said[..1], flags, &mut conflicts);
        assert_eq!(style.clutter, flags.clutter);
        assert_eq!(conflicts[1].code, "style_flag");
    }
}
