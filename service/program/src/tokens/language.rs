//! Which language a prompt is in.

use super::text::{Kind, Token};
use super::words::words;

/// Letters of a script that tell a language.
const LEAST_LETTERS: usize = 2;

/// Scripts of languages that are not read.
const SCRIPTS: &[(&str, &[(char, char)])] = &[
    ("Japanese", &[('\u{3041}', '\u{30fa}'), ('\u{30fc}', '\u{30ff}')]),
    ("a language in Cyrillic letters", &[('\u{400}', '\u{52f}')]),
    ("Greek", &[('\u{370}', '\u{3ff}')]),
    ("Hebrew", &[('\u{590}', '\u{5ff}')]),
    ("a language in Arabic letters", &[('\u{600}', '\u{6ff}')]),
    ("a language of India", &[('\u{900}', '\u{dff}')]),
    ("Thai", &[('\u{e00}', '\u{e7f}')]),
    ("Georgian", &[('\u{10a0}', '\u{10ff}')]),
    ("Armenian", &[('\u{530}', '\u{58f}')]),
];

/// Score that tells a language by itself: one of its most usual words.
const SURE: f64 = 1.0;

/// Returns the ISO 639-1 code of the prompt's language (`en de fr es zh ko`); English when nothing tells.
///
/// Where the usual words do not tell, `known` is asked how many words of the prompt name rooms or buildings in a language.
pub(crate) fn detect(tokens: &[Token], known: impl Fn(&str) -> usize) -> &'static str {
    let count = |test: fn(&Token) -> bool| tokens.iter().filter(|t| test(t)).count();
    let hangul = count(|t| t.kind == Kind::Hangul);
    let han = count(|t| t.kind == Kind::Han);
    let latin = count(|t| t.kind == Kind::Word);
    // A syllable or character weighs less than a word; a foreign name or two does not change the language.
    if hangul > 0 && hangul >= han && hangul > latin {
        return "ko";
    }
    if han > 0 && han > latin {
        return "zh";
    }
    let mut scores: Vec<(&'static str, f64)> = Vec::new();
    for code in ["en", "de", "fr", "es"] {
        let Some(spoken) = words().languages.get(code) else { continue };
        let mut score = if code == "en" { 0.01 } else { 0.0 };
        for (i, token) in tokens.iter().enumerate() {
            if token.kind != Kind::Word {
                continue;
            }
            let known = spoken.detect.contains(&token.text);
            let number = spoken.numbers.contains_key(&token.text);
            let phrase = spoken.tags.longest_at(tokens, i).is_some();
            score += if known { 1.0 } else { 0.0 } + if number { 0.7 } else { 0.0 } + if phrase { 0.3 } else { 0.0 };
        }
        scores.push((code, score));
    }
    if scores.iter().all(|(_, score)| *score < SURE) {
        scores.iter_mut().for_each(|(code, score)| *score += known(code) as f64);
    }
    // of equals the first
    scores.into_iter().rev().max_by(|a, b| a.1.total_cmp(&b.1)).map_or("en", |best| best.0)
}

/// Returns the English name of a language that is not read, where the prompt seems to be in one.
///
/// `known` tells which words of the prompt name rooms or buildings in the language that it was taken for.
pub(crate) fn unread(prompt: &str, tokens: &[Token], language: &str, known: usize) -> Option<&'static str> {
    let script = |range: &[(char, char)]| {
        prompt.chars().filter(|c| range.iter().any(|(a, b)| (*a..=*b).contains(c))).count() >= LEAST_LETTERS
    };
    if let Some((name, _)) = SCRIPTS.iter().find(|(_, range)| script(range)) {
        return Some(name);
    }
    let own = words().languages.get(language)?;
    let is_own = |t: &Token| own.numbers.contains_key(&t.text) || own.detect.contains(&t.text);
    let latin: Vec<&Token> = tokens.iter().filter(|t| t.kind == Kind::Word).collect();
    let ours = latin.iter().filter(|t| is_own(t)).count().max(known);
    let counts = words().unread_languages.iter().map(|(name, words)| {
        let theirs = latin.iter().filter(|t| words.contains(&t.text)).count();
        (name.as_str(), theirs)
    });
    counts.rev().max_by_key(|c| c.1).filter(|c| c.1 >= 2 && c.1 > ours).map(|c| c.0)
}

#[cfg(test)]
mod tests {
    use super::super::text::tokens;
    use super::*;

    #[test]
    fn tells_six_languages() {
        for (text, code) in [
            ("two-bedroom flat in Germany", "en"),
            ("Eine Dreizimmerwohnung in Berlin mit Küche", "de"),
            ("Un appartement T3 à Paris avec deux chambres", "fr"),
            ("Oficina en Madrid para 25 empleados", "es"),
            ("上海一套三室两厅两卫的住宅", "zh"),
            ("서울에 있는 방 2개와 화장실 1개짜리 아파트", "ko"),
            ("", "en"),
            ("???", "en"),
        ] {
            assert_eq!(detect(&tokens(text), |_| 0), code, "{text}");
        }
    }

    #[test]
    fn tells_languages_that_are_not_read() {
        for (text, language, name) in [
            ("appartamento con due camere da letto e un bagno", "es", Some("Italian")),
            ("appartement met twee slaapkamers en een badkamer", "fr", Some("Dutch")),
            ("寝室が2つあるアパート", "zh", Some("Japanese")),
            ("квартира с двумя спальнями", "en", Some("a language in Cyrillic letters")),
            ("上海一套三室两厅两卫的住宅", "zh", None),
            ("Oficina en Madrid con dos salas", "es", None),
            ("two-bedroom flat in Germany with a home office", "en", None),
            ("Eine Wohnung mit zwei Zimmern und Bad", "de", None),
            ("Un appartement avec deux chambres", "fr", None),
        ] {
            assert_eq!(unread(text, &tokens(text), language, 0), name, "{text}");
        }
    }

    #[test]
    fn words_for_rooms_tell_where_usual_words_do_not() {
        let known = |code: &str| if code == "de" { 2 } else { 0 };
        assert_eq!(detect(&tokens("Grundschule 8 Klassenräume Leipzig"), known), "de");
        assert_eq!(detect(&tokens("the Grundschule of Leipzig"), known), "en", "usual words go first");
    }
}
