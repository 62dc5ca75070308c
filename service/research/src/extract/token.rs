//! Text to tokens with their places in it: words in lower case, numbers with their value, symbols.

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    Word,
    /// A figure and its value.
    Number(f64),
    /// Digits that are no figure: `4.2.1`, `0142`, `A4`.
    Label,
    Symbol,
}

/// A piece of text; `start..end` are bytes of the whole text.
#[derive(Debug, Clone)]
pub struct Token {
    pub text: String,
    pub start: usize,
    pub end: usize,
    pub kind: Kind,
    /// Whether it stands right behind the one before.
    pub glued: bool,
    /// Whether a line ends before it.
    pub new_line: bool,
    /// Whether a blank line stands before it.
    pub paragraph: bool,
    /// Whether it begins with a capital.
    pub capital: bool,
}

impl Token {
    pub fn is(&self, text: &str) -> bool {
        self.text == text
    }

    pub fn number(&self) -> Option<f64> {
        if let Kind::Number(n) = self.kind { Some(n) } else { None }
    }
}

/// Whether a script writes words without blanks between, so that each sign is a token.
pub fn is_dense(c: char) -> bool {
    matches!(c, '\u{3040}'..='\u{30ff}' | '\u{3400}'..='\u{9fff}' | '\u{ac00}'..='\u{d7af}' | '\u{f900}'..='\u{faff}')
}

fn is_blank(c: char) -> bool {
    c.is_whitespace() || c.is_control() || matches!(c, '\u{feff}' | '\u{200b}' | '\u{2060}' | '\u{ad}')
}

/// Returns the tokens of a text; `lang` decides what dots and commas in figures mean.
pub fn tokens(text: &str, lang: &str) -> Vec<Token> {
    let chars: Vec<(usize, char)> = text.char_indices().collect();
    let at = |i: usize| chars.get(i).map(|c| c.1);
    let byte = |i: usize| chars.get(i).map_or(text.len(), |c| c.0);
    let mut out: Vec<Token> = Vec::new();
    let (mut i, mut glued, mut lines) = (0, false, 0_usize);
    while let Some(c) = at(i) {
        if is_blank(c) {
            lines += usize::from(c == '\n');
            glued = false;
            i += 1;
            continue;
        }
        let start = i;
        let mut kind = Kind::Symbol;
        if c.is_ascii_digit() {
            i = number_end(&at, i);
            let after_letter = glued
                && out.last().is_some_and(|t: &Token| {
                    t.kind == Kind::Word && t.text.chars().all(|c| c.is_alphabetic() && !is_dense(c))
                });
            let digits = text.get(byte(start)..byte(i)).unwrap_or_default();
            kind = match value(digits, lang) {
                Some(n) if !after_letter => Kind::Number(n),
                _ => Kind::Label,
            };
        } else if is_dense(c) {
            i += 1;
            kind = Kind::Word;
        } else if c.is_alphabetic() {
            while at(i).is_some_and(|c| c.is_alphabetic() && !is_dense(c)) {
                i += 1;
            }
            kind = Kind::Word;
        } else {
            i += 1;
            if matches!((c, at(i)), ('>' | '<' | '=', Some('=')) | ('=', Some('>'))) {
                i += 1;
            }
        }
        let piece = text.get(byte(start)..byte(i)).unwrap_or_default();
        let (text, capital) = (piece.to_lowercase(), c.is_uppercase());
        let (new_line, paragraph) = (lines > 0, lines > 1);
        out.push(Token { text, start: byte(start), end: byte(i), kind, glued, new_line, paragraph, capital });
        glued = true;
        lines = 0;
    }
    out
}

/// Returns where a figure ends: digits, with dots, commas or blanks between groups.
fn number_end(at: &impl Fn(usize) -> Option<char>, start: usize) -> usize {
    let digits = |from: usize| {
        let mut i = from;
        while at(i).is_some_and(|c| c.is_ascii_digit()) {
            i += 1;
        }
        i
    };
    let mut i = digits(start);
    let mut group = i - start;
    let zero = at(start) == Some('0');
    while let Some(c) = at(i) {
        let end = digits(i + 1);
        let len = end - i - 1;
        let thousand = len == 3 && (1..=3).contains(&group) && !zero;
        let blank = matches!(c, ' ' | '\u{a0}' | '\u{202f}' | '\u{2009}' | '\'' | '’');
        if !(matches!(c, '.' | ',') && len > 0 || blank && thousand) {
            break;
        }
        (i, group) = (end, len);
    }
    i
}

/// Returns the value of printed digits, none for section numbers, dates and the like.
fn value(printed: &str, lang: &str) -> Option<f64> {
    let comma_is_decimal = !matches!(lang, "" | "en" | "zh" | "ja" | "ko");
    let plain: String = printed.chars().filter(|c| c.is_ascii_digit() || matches!(c, '.' | ',')).collect();
    let seps: Vec<char> = plain.chars().filter(|c| !c.is_ascii_digit()).collect();
    let groups: Vec<&str> = plain.split(['.', ',']).collect();
    let last_is_three = groups.last().is_some_and(|g| g.len() == 3);
    let leading = groups.first().copied().unwrap_or_default();
    let decimal = match seps.as_slice() {
        [] if plain.len() > 1 && plain.starts_with('0') => return None,
        [] => None,
        [sep] if last_is_three && leading.len() <= 3 && leading != "0" && (*sep == ',') != comma_is_decimal => None,
        [sep] => Some(*sep),
        all if all.iter().all(|c| Some(c) == all.first()) => {
            if groups.iter().skip(1).any(|g| g.len() != 3) {
                return None;
            }
            None
        }
        all => all.last().copied(),
    };
    let number: String = match decimal {
        None => plain.chars().filter(char::is_ascii_digit).collect(),
        Some(sep) => {
            let (whole, part) = plain.rsplit_once(sep)?;
            format!("{}.{part}", whole.chars().filter(char::is_ascii_digit).collect::<String>())
        }
    };
    number.parse().ok().filter(|n: &f64| n.is_finite() && *n < 1e12)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_read_as_printed_in_their_language() {
        let cases = [
            ("1,000", "en", Some(1000.0)),
            ("1,50", "en", Some(1.5)),
            ("1.500", "de", Some(1500.0)),
            ("1,500", "de", Some(1.5)),
            ("1.500", "en", Some(1.5)),
            ("1.234,5", "de", Some(1234.5)),
            ("0,125", "en", Some(0.125)),
            ("1 100", "en", Some(1100.0)),
            ("4.2.1", "en", None),
            ("12.03.2021", "de", None),
            ("0142", "en", None),
        ];
        for (printed, lang, expected) in cases {
            assert_eq!(tokens(printed, lang)[0].number(), expected, "{printed} in {lang}");
        }
    }
}
