//! Text into tokens, and phrases found among tokens: case, accents, plurals and hyphens aside.

use std::collections::HashMap;

/// What a token is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// Letters of an alphabet, with digits after the first letter ("m2", "T3").
    Word,
    /// A number in digits.
    Number(f64),
    /// One Chinese or Japanese character.
    Han,
    /// One Korean syllable.
    Hangul,
    /// One mark that parts phrases.
    Mark(char),
}

/// A word, number, syllable or mark of the prompt.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Token {
    /// Lower case, without accents.
    pub text: String,
    pub kind: Kind,
    /// Bytes in the prompt.
    pub start: usize,
    pub end: usize,
    /// True after a space or at the start.
    pub spaced: bool,
    /// True when the prompt has it in capitals or with a capital.
    pub capital: bool,
}

impl Token {
    pub(crate) fn is_mark(&self) -> bool {
        matches!(self.kind, Kind::Mark(_))
    }

    pub(crate) fn mark(&self) -> Option<char> {
        if let Kind::Mark(c) = self.kind { Some(c) } else { None }
    }

    /// Returns true at the end of a sentence.
    pub(crate) fn ends_sentence(&self) -> bool {
        matches!(self.kind, Kind::Mark('.' | ';' | '!' | '?'))
    }
}

/// Longest prompt that is read; the rest is ignored with a note.
pub(crate) const MAX_TOKENS: usize = 4000;

/// Words whose dot ends no sentence.
const ABBREVIATIONS: [&str; 10] = ["sq", "approx", "ca", "env", "aprox", "incl", "inkl", "min", "max", "bzw"];

/// Returns the tokens of a text, `MAX_TOKENS` at most.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let chars: Vec<(usize, char)> = text.char_indices().map(|(i, c)| (i, plain(c))).collect();
    let mut out = Vec::new();
    let mut i = 0;
    let mut spaced = true;
    while i < chars.len() && out.len() < MAX_TOKENS {
        let (start, c) = chars[i];
        let mut j = i + 1;
        if c.is_ascii_digit() {
            let (end, value, digits) = number(&chars, i);
            let ordinal = is_ordinal(&chars, end);
            let after = if ordinal { skip_letters(&chars, end) } else { end };
            let kind = if ordinal { Kind::Word } else { Kind::Number(value) };
            // "2nd floor" is no "2 floor"
            let letters: String = chars[end..after].iter().map(|c| c.1).collect();
            let (end, text_of) = (after, digits + &fold(&letters));
            out.push(Token { text: text_of, kind, start, end: at(&chars, end, text), spaced, capital: false });
            j = end;
            spaced = false;
        } else if c == '㎡' {
            let end = at(&chars, j, text);
            out.push(Token { text: "m2".into(), kind: Kind::Word, start, end, spaced, capital: false });
            spaced = false;
        } else if is_han(c) || is_hangul(c) {
            let kind = if is_han(c) { Kind::Han } else { Kind::Hangul };
            out.push(Token { text: c.to_string(), kind, start, end: at(&chars, j, text), spaced, capital: false });
            spaced = false;
        } else if c.is_alphabetic() {
            // "cleaning robot x2", "4x5 m": the x counts, and is no part of a name
            let times = matches!(c, 'x' | 'X') && chars.get(j).is_some_and(|n| n.1.is_ascii_digit());
            while !times && j < chars.len() && continues_word(&chars, j) {
                j += 1;
            }
            let raw: String = chars[i..j].iter().map(|x| x.1).collect();
            let folded = fold(&raw);
            if !folded.is_empty() {
                let end = at(&chars, j, text);
                out.push(Token { text: folded, kind: Kind::Word, start, end, spaced, capital: c.is_uppercase() });
            }
            spaced = false;
        } else if c.is_whitespace() {
            spaced = true;
            if c == '\n' {
                let end = at(&chars, j, text);
                out.push(Token { text: ";".into(), kind: Kind::Mark(';'), start, end, spaced, capital: false });
            }
        } else if c == '.' && out.last().is_some_and(|t| ABBREVIATIONS.contains(&t.text.as_str())) {
            // "800 sq. ft." goes on after its first dot
            spaced = true;
        } else if let Some(mark) = mark_of(&chars, i, spaced) {
            let end = at(&chars, j, text);
            out.push(Token { text: mark.to_string(), kind: Kind::Mark(mark), start, end, spaced, capital: false });
            spaced = true;
        } else if c != '-' {
            spaced = true;
        }
        i = j;
    }
    out
}

fn at(chars: &[(usize, char)], i: usize, text: &str) -> usize {
    chars.get(i).map_or(text.len(), |c| c.0)
}

/// Maps full-width forms, superscripts and odd spaces and hyphens to plain characters.
fn plain(c: char) -> char {
    match c {
        '\u{ff01}'..='\u{ff5e}' => char::from_u32(c as u32 - 0xfee0).unwrap_or(c),
        '²' => '2',
        '³' => '3',
        '‐' | '‑' | '‒' | '–' | '—' | '−' => '-',
        '’' | '‘' | '`' | '´' => '\'',
        '×' => 'x',
        '。' => '.',
        '、' => ',',
        _ => c,
    }
}

fn is_han(c: char) -> bool {
    matches!(c, '\u{3041}'..='\u{30ff}' | '\u{3400}'..='\u{4dbf}' | '\u{4e00}'..='\u{9fff}' | '\u{f900}'..='\u{faff}')
}

fn is_hangul(c: char) -> bool {
    matches!(c, '\u{ac00}'..='\u{d7a3}')
}

fn continues_word(chars: &[(usize, char)], j: usize) -> bool {
    let c = chars[j].1;
    if is_han(c) || is_hangul(c) {
        return false;
    }
    // An elision ("l'entrée") parts words, a genitive ("dentist's") does not.
    if c == '\'' {
        let start = (0..j).rev().take_while(|&k| chars[k].1.is_alphabetic()).count();
        let next = chars.get(j + 1).is_some_and(|n| n.1.is_alphabetic());
        return next && start > 2;
    }
    c.is_alphanumeric() || matches!(c, '\u{300}'..='\u{36f}')
}

/// Returns the end, the value and the digits of a number: thousands marks ("1,500", "2.000", "1 500"), decimals ("7.5", "7,5").
fn number(chars: &[(usize, char)], i: usize) -> (usize, f64, String) {
    let digits_from = |k: usize| chars[k.min(chars.len())..].iter().take_while(|c| c.1.is_ascii_digit()).count();
    let mut end = i + digits_from(i);
    let mut digits: String = chars[i..end].iter().map(|c| c.1).collect();
    let mut decimals = String::new();
    while let Some(&(_, mark)) = chars.get(end) {
        let run = digits_from(end + 1);
        let thousands = matches!(mark, ',' | '.' | ' ' | '\u{a0}' | '\u{202f}' | '\'' | '_')
            && run == 3
            && (digits.len() <= 3 || digits.len().is_multiple_of(3) || end > i + 3)
            && digits != "0";
        if thousands {
            digits.extend(chars[end + 1..end + 4].iter().map(|c| c.1));
            end += 4;
        } else if matches!(mark, '.' | ',') && (1..=2).contains(&run) {
            decimals = chars[end + 1..=end + run].iter().map(|c| c.1).collect();
            end += 1 + run;
            break;
        } else {
            break;
        }
    }
    let value: f64 = format!("{digits}.{decimals}0").parse().unwrap_or(f64::MAX);
    (end, value, digits)
}

fn is_ordinal(chars: &[(usize, char)], end: usize) -> bool {
    let tail: String = chars[end.min(chars.len())..].iter().map(|c| c.1).take_while(|c| c.is_alphabetic()).collect();
    let more = chars.get(end + tail.chars().count()).is_some_and(|c| c.1.is_numeric());
    !more
        && matches!(
            tail.to_lowercase().as_str(),
            "st" | "nd" | "rd" | "th" | "er" | "e" | "ère" | "ème" | "º" | "ª" | "eme" | "o" | "a"
        )
}

fn skip_letters(chars: &[(usize, char)], end: usize) -> usize {
    end + chars[end.min(chars.len())..].iter().take_while(|c| c.1.is_alphabetic()).count()
}

fn mark_of(chars: &[(usize, char)], i: usize, spaced: bool) -> Option<char> {
    let next = chars.get(i + 1).map(|c| c.1);
    match chars[i].1 {
        ',' => Some(','),
        ':' => Some(':'),
        '(' | ')' | '[' | ']' | '|' => Some(','),
        '.' | ';' | '!' | '?' => Some(chars[i].1),
        '/' | '&' | '+' => Some('/'),
        '•' | '*' | '·' => Some(','),
        // "- three bedrooms" is a list item, "-3" a negative number, "two-bedroom" one phrase
        '-' if spaced && next.is_some_and(|n| n.is_ascii_digit()) => Some('-'),
        '-' if spaced => Some(','),
        _ => None,
    }
}

/// Returns words that begin with a capital letter.
pub(crate) fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Returns a text in lower case without accents, letters and digits only.
pub(crate) fn fold(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars().flat_map(char::to_lowercase) {
        match c {
            'a'..='z' | '0'..='9' => out.push(c),
            'ß' => out.push_str("ss"),
            'æ' => out.push_str("ae"),
            'œ' => out.push_str("oe"),
            '㎡' => out.push_str("m2"),
            _ if c.is_alphanumeric() => out.push(base(c)),
            _ => {}
        }
    }
    out
}

/// Returns the letter under the accent.
fn base(c: char) -> char {
    const BASES: [(char, &str); 21] = [
        ('a', "àáâãäåāăąạảấầẩẫậắằẳẵặǎ"),
        ('c', "çćĉċč"),
        ('d', "ďđð"),
        ('e', "èéêëēĕėęěẹẻẽếềểễệ"),
        ('g', "ĝğġģ"),
        ('h', "ĥħ"),
        ('i', "ìíîïĩīĭįıỉịǐ"),
        ('j', "ĵ"),
        ('k', "ķ"),
        ('l', "ĺļľłŀ"),
        ('n', "ñńņňŋ"),
        ('o', "òóôõöøōŏőơọỏốồổỗộớờởỡợǒ"),
        ('r', "ŕŗř"),
        ('s', "śŝşšș"),
        ('t', "ţťŧț"),
        ('u', "ùúûüũūŭůűųưụủứừửữựǔ"),
        ('w', "ŵ"),
        ('y', "ýÿŷỳỵỷỹ"),
        ('z', "źżž"),
        ('p', "þ"),
        ('i', "ĳ"),
    ];
    if c.is_ascii() || is_han(c) || is_hangul(c) {
        return c;
    }
    BASES.iter().find(|(_, accented)| accented.contains(c)).map_or(c, |(plain, _)| *plain)
}

/// Returns a folded word without the endings of number and case, so that "Küchen" meets "Küche".
pub(crate) fn stem<'a>(word: &'a str, language: &str) -> &'a str {
    let strip = |word: &'a str, endings: &[&str], rest: usize| -> &'a str {
        endings.iter().find_map(|e| word.strip_suffix(e).filter(|w| w.len() >= rest)).unwrap_or(word)
    };
    if !word.is_ascii() {
        return word;
    }
    match language {
        "" => word,
        "de" => {
            let mut word = word;
            loop {
                let shorter = strip(word, &["ern", "en", "em", "er", "es", "e", "n", "s"], 3);
                if shorter.len() == word.len() {
                    return word;
                }
                word = shorter;
            }
        }
        "fr" => strip(word, &["s", "x"], 3),
        "es" => strip(strip(word, &["s"], 3), &["e"], 3),
        _ => {
            if ["ss", "us", "is"].iter().any(|e| word.ends_with(e)) {
                return word;
            }
            let sibilant = ["ches", "shes", "xes", "sses", "zes"].iter().any(|e| word.ends_with(e));
            if sibilant {
                return strip(word, &["es"], 3);
            }
            let singular = strip(word, &["s"], 3);
            // "party" and "parties", but "storey" and "storeys"
            let keeps_y = ["ay", "ey", "oy", "uy"].iter().any(|e| singular.ends_with(e));
            if keeps_y { singular } else { strip(singular, &["ie", "y"], 3) }
        }
    }
}

/// A found phrase: tokens `start..end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Span {
    pub start: usize,
    pub end: usize,
}

impl Span {
    pub(crate) fn contains(&self, i: usize) -> bool {
        (self.start..self.end).contains(&i)
    }

    pub(crate) fn overlaps(&self, other: Span) -> bool {
        self.start < other.end && other.start < self.end
    }
}

/// Phrases of one language with what they mean; the longest match wins, an exact one before one by stems.
#[derive(Debug)]
pub(crate) struct Phrases<T> {
    language: String,
    exact: HashMap<String, T>,
    stems: HashMap<String, T>,
    /// Tokens of the longest phrase.
    longest: usize,
    /// Bytes of the longest phrase.
    widest: usize,
}

/// Most bytes that endings, one after the other, add to a word.
const INFLECTION: usize = 8;

impl<T: Clone> Phrases<T> {
    pub(crate) fn new(language: &str) -> Self {
        Self { language: language.into(), exact: HashMap::new(), stems: HashMap::new(), longest: 0, widest: 0 }
    }

    /// Adds a phrase; the first meaning of a phrase stays.
    pub(crate) fn insert(&mut self, phrase: &str, meaning: T) {
        self.put(phrase, meaning, |old, _| old.clone());
    }

    /// Returns the language of the phrases.
    pub(crate) fn language(&self) -> &str {
        &self.language
    }

    /// Adds a phrase and merges meanings.
    pub(crate) fn put(&mut self, phrase: &str, meaning: T, merge: impl Fn(&T, &T) -> T) {
        let (mut exact, mut stems, mut tokens) = (String::new(), String::new(), 0);
        for word in words(phrase) {
            let folded = fold(word);
            let wide = folded.chars().filter(|&c| is_han(c) || is_hangul(c)).count();
            tokens += wide.max(1);
            stems.push_str(stem(&folded, &self.language));
            exact.push_str(&folded);
        }
        if exact.is_empty() {
            return;
        }
        self.longest = self.longest.max(tokens);
        self.widest = self.widest.max(exact.len());
        for (map, key) in [(&mut self.exact, exact), (&mut self.stems, stems)] {
            let value = map.get(&key).map_or_else(|| meaning.clone(), |old| merge(old, &meaning));
            map.insert(key, value);
        }
    }

    /// Returns the end and the meaning of the longest phrase that begins at a token.
    pub(crate) fn longest_at(&self, tokens: &[Token], i: usize) -> Option<(usize, &T)> {
        let (mut exact, mut stems) = (String::new(), String::new());
        let mut found = None;
        for (j, token) in tokens.iter().enumerate().skip(i).take(self.longest + 1) {
            if token.is_mark() {
                break;
            }
            exact.push_str(&token.text);
            stems.push_str(stem(&token.text, &self.language));
            if let Some(meaning) = self.exact.get(&exact).or_else(|| self.stems.get(&stems)) {
                found = Some((j + 1, meaning));
            }
        }
        found
    }

    /// Returns what a phrase means by its stems, the form in which singular and plural are one.
    pub(crate) fn by_stems(&self, tokens: &[Token]) -> Option<&T> {
        let stems: String = tokens.iter().map(|t| stem(&t.text, &self.language)).collect();
        self.stems.get(&stems)
    }

    /// Returns the meaning of one folded word.
    pub(crate) fn word(&self, folded: &str) -> Option<&T> {
        self.exact.get(folded).or_else(|| self.stems.get(stem(folded, &self.language)))
    }

    /// Returns the meaning of the longest end of a compound that is a phrase ("Damentoilette" ends in "Toilette").
    pub(crate) fn ending(&self, folded: &str, least: usize) -> Option<(&T, usize)> {
        if self.language != "de" || folded.len() < least + 3 || !folded.is_ascii() {
            return None;
        }
        let from = folded.len().saturating_sub(self.widest + INFLECTION).max(3);
        (from..=folded.len() - least).find_map(|cut| self.word(&folded[cut..]).map(|meaning| (meaning, cut)))
    }

    /// Returns the meaning of a whole text.
    pub(crate) fn whole(&self, text: &str) -> Option<&T> {
        let found = tokens(text);
        self.longest_at(&found, 0).filter(|(end, _)| *end == found.len()).map(|(_, meaning)| meaning)
    }
}

/// Returns the words of a phrase as [`tokens`] would cut them, without its care for numbers and marks.
fn words(phrase: &str) -> impl Iterator<Item = &str> {
    phrase
        .split(|c: char| {
            c.is_whitespace() || matches!(c, '-' | '‐' | '‑' | '/' | ',' | '.' | '(' | ')' | '+' | '&' | ':')
        })
        .flat_map(|word| {
            let (elided, rest) = match word.split_once(['\'', '’']) {
                Some((a, b)) if a.chars().count() <= 2 && !b.is_empty() => (a, b),
                _ => ("", word),
            };
            [elided, rest]
        })
        .filter(|w| !w.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(prompt: &str) -> Vec<String> {
        tokens(prompt).into_iter().map(|t| t.text).collect()
    }

    #[test]
    fn words_numbers_and_marks_part() {
        assert_eq!(texts("two-bedroom flat, 75 m²."), ["two", "bedroom", "flat", ",", "75", "m2", "."]);
        assert_eq!(texts("dentist's X-ray"), ["dentists", "x", "ray"]);
        assert_eq!(texts("près de l'entrée"), ["pres", "de", "l", "entree"]);
        assert_eq!(texts("방 2개"), ["방", "2", "개"]);
        assert_eq!(texts("robot x2, 4×5 m"), ["robot", "x", "2", ",", "4", "x", "5", "m"]);
    }

    #[test]
    fn numbers_keep_thousands_and_decimals() {
        for (text, value) in
            [("1,500", 1500.0), ("2.000", 2000.0), ("100,000", 1e5), ("7,5", 7.5), ("0.4", 0.4), ("1 500", 1500.0)]
        {
            let found = tokens(text);
            assert_eq!(found.len(), 1, "{text}");
            assert_eq!(found[0].kind, Kind::Number(value), "{text}");
        }
    }

    #[test]
    fn english_words_of_one_stem() {
        for (a, b, alike) in [("parties", "party", true), ("storeys", "storey", true), ("storey", "store", false)] {
            assert_eq!(stem(a, "en") == stem(b, "en"), alike, "{a} and {b}");
        }
    }

    #[test]
    fn phrases_meet_plurals_accents_and_compounds() {
        let mut phrases = Phrases::new("de");
        phrases.insert("Küche", 1);
        phrases.insert("Serverraum", 2);
        for text in ["küche", "Küchen", "KUECHE".replace("UE", "Ü").as_str()] {
            assert_eq!(phrases.whole(text), Some(&1), "{text}");
        }
        assert_eq!(phrases.whole("Server-Raum"), Some(&2));
    }

    #[test]
    fn odd_text_does_not_panic() {
        for text in ["", "-", "''", "1,", "1.000.", "\u{300}", "🏠🏠", "5e5", "½", "İ", "-3-"] {
            let _ = tokens(text);
        }
    }
}
