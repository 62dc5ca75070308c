//! Spellings that count as one: case, accents, and widths of letters.

use unicode_normalization::UnicodeNormalization;
use unicode_normalization::char::is_combining_mark;

/// Letters with a stroke or a ligature, which no decomposition takes apart.
const LETTERS: &[(char, &str)] =
    &[('ł', "l"), ('ø', "o"), ('đ', "d"), ('ß', "ss"), ('æ', "ae"), ('œ', "oe"), ('ı', "i"), ('ð', "d"), ('þ', "th")];

/// Returns a text without case and accents: "Büro" and "buro" are one, and so are "１２" and "12". Syllables of Korean and
/// voiced kana keep their marks, which make other letters of them.
pub fn fold(text: &str) -> String {
    let mut folded = String::with_capacity(text.len());
    text.chars().for_each(|c| fold_char(c, &mut folded));
    folded
}

/// Appends one character, folded.
pub(crate) fn fold_char(c: char, folded: &mut String) {
    if c.is_ascii() {
        folded.push(c.to_ascii_lowercase());
        return;
    }
    if is_kana(c) || is_hangul(c) || is_han(c) {
        // half-width kana and the like: a form of compatibility, composed again
        folded.extend(c.nfkc());
        return;
    }
    for lower in c.to_lowercase().nfkd().filter(|c| !is_combining_mark(*c)) {
        match LETTERS.iter().find(|(letter, _)| *letter == lower) {
            Some((_, plain)) => folded.push_str(plain),
            None => folded.push(lower),
        }
    }
}

/// Returns true for hiragana and katakana, the mark of long vowels among them.
pub(crate) fn is_kana(c: char) -> bool {
    matches!(c, '\u{3040}'..='\u{30ff}' | '\u{31f0}'..='\u{31ff}' | '\u{ff66}'..='\u{ff9f}')
}

/// Returns true for syllables and letters of Korean.
pub(crate) fn is_hangul(c: char) -> bool {
    matches!(c, '\u{1100}'..='\u{11ff}' | '\u{3130}'..='\u{318f}' | '\u{ac00}'..='\u{d7af}')
}

/// Returns true for Chinese characters.
pub(crate) fn is_han(c: char) -> bool {
    matches!(c, '\u{3400}'..='\u{4dbf}' | '\u{4e00}'..='\u{9fff}' | '\u{f900}'..='\u{faff}' | '\u{20000}'..='\u{2fa1f}' | '々' | '〇')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn case_accents_and_widths_do_not_count() {
        for (written, folded) in [
            ("Büro", "buro"),
            ("ÉTÉ", "ete"),
            ("Łazienka", "lazienka"),
            ("Straße", "strasse"),
            ("１２㎡", "12m2"),
            ("バー", "バー"),
            ("방", "방"),
            ("ё", "е"),
        ] {
            assert_eq!(fold(written), folded);
        }
    }
}
