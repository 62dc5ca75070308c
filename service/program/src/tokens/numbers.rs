//! Numbers in digits and words.

use super::text::{Kind, Span, Token};
use super::words::{Spoken, Tag, is_tagged, tag_end};

/// Words before a number that it is the name of, at most: "biosafety level".
const MOST_IN_NAME: usize = 3;
/// Letters behind a number that are a unit or mean "times".
const UNIT_LETTERS: [&str; 3] = ["m", "x", "k"];

/// A number in the prompt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Number {
    pub span: Span,
    pub value: f64,
    /// True for "a", "eine", "un": one, or just an article.
    pub article: bool,
    /// True for "several", "einige": the prompt leaves the number open.
    pub vague: bool,
}

/// Returns all numbers in order, without overlaps.
pub(crate) fn numbers(tokens: &[Token], language: &str, spoken: &[&Spoken]) -> Vec<Number> {
    let mut out = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        match number_at(tokens, i, language, spoken) {
            Some(number) => {
                i = number.span.end.max(i + 1);
                out.push(number);
            }
            None => i += 1,
        }
    }
    out
}

fn number_at(tokens: &[Token], i: usize, language: &str, spoken: &[&Spoken]) -> Option<Number> {
    // "-3 bedrooms", "minus three"
    let sign = if tokens[i].mark() == Some('-') { Some(i + 1) } else { tag_end(spoken, tokens, i, Tag::Negative) };
    if let Some(next) = sign {
        let number = unsigned_at(tokens, next, language, spoken).filter(|n| !n.article && !n.vague)?;
        return Some(Number { span: Span { start: i, end: number.span.end }, value: -number.value, ..number });
    }
    let number = unsigned_at(tokens, i, language, spoken)?;
    // "two and a half baths"
    let half = tag_end(spoken, tokens, number.span.end, Tag::Halves);
    Some(match half {
        Some(end) => Number { span: Span { end, ..number.span }, value: number.value + 0.5, ..number },
        None => number,
    })
}

fn unsigned_at(tokens: &[Token], i: usize, language: &str, spoken: &[&Spoken]) -> Option<Number> {
    let token = tokens.get(i)?;
    let found = |end: usize, value: f64| Number { span: Span { start: i, end }, value, article: false, vague: false };
    if let Kind::Number(value) = token.kind {
        return (!is_name(tokens, i, spoken)).then(|| digits_at(tokens, i, value, spoken));
    }
    for s in spoken {
        if let Some((end, value)) = s.quantities.longest_at(tokens, i) {
            let vague = s.tag_at(tokens, i, Tag::Vague) == Some(end);
            // "a couple", "both" and the like; "twin", "single" only before a further word
            let bare = tokens.get(end).is_none_or(Token::is_mark);
            if !(bare && end == i + 1) {
                return Some(Number { vague, ..found(end, *value) });
            }
        }
    }
    match token.kind {
        Kind::Han => chinese(tokens, i).map(|(end, value)| found(end, value)),
        Kind::Hangul => korean(tokens, i, spoken).map(|(end, value)| found(end, value)),
        Kind::Word => spoken.iter().find_map(|s| {
            let (end, value) = words_at(tokens, i, s, language)?;
            let article = end == i + 1 && s.tag_at(tokens, i, Tag::Articles).is_some();
            Some(Number { article, ..found(end, value) })
        }),
        _ => None,
    }
}

/// Returns true for digits that count nothing and belong to a name: "BSL-2", "221B", "class 100", "100级".
pub(crate) fn is_name(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> bool {
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    // "80sqm-100sqm" ends a measure with a word, "cleaning robot x2" counts
    let word = |k: usize| tokens[k].kind == Kind::Word && tokens[k].text != "x";
    let of_number = |k: usize| !tokens[k].spaced && k > 0 && matches!(tokens[k - 1].kind, Kind::Number(_));
    let hyphened = !tokens[i].spaced && i.checked_sub(1).is_some_and(|k| word(k) && !of_number(k));
    let lettered = tokens.get(i + 1).is_some_and(|t| {
        let letter = t.kind == Kind::Word && t.capital && t.text.len() == 1;
        letter && !t.spaced && !UNIT_LETTERS.contains(&t.text.as_str())
    });
    let named = (i.saturating_sub(MOST_IN_NAME)..i).any(|k| tagged(k, Tag::NumberNames) == Some(i));
    let behind = tokens.get(i + 1).is_some_and(|t| !t.spaced) && tagged(i + 1, Tag::NumberNamesBehind).is_some();
    hyphened || lettered || named || behind
}

/// Reads "4", "3-4" (the larger), "2.5 thousand".
fn digits_at(tokens: &[Token], i: usize, value: f64, spoken: &[&Spoken]) -> Number {
    let (mut end, mut value) = (i + 1, value);
    if let Some(Token { kind: Kind::Number(upper), spaced: false, .. }) = tokens.get(end)
        && *upper > value
        && *upper < value * 4.0 + 10.0
    {
        value = *upper;
        end += 1;
    }
    if let Some(next) = tokens.get(end).filter(|t| t.kind == Kind::Word)
        && let Some(factor) = spoken.iter().find_map(|s| s.multipliers.get(&next.text))
    {
        value *= factor;
        end += 1;
    }
    let myriad = tokens.get(end).filter(|t| !t.spaced && matches!(t.kind, Kind::Han | Kind::Hangul));
    if let Some(factor) = myriad.and_then(|t| match t.text.as_str() {
        "万" | "만" => Some(10_000.0),
        "千" | "천" => Some(1000.0),
        "百" | "백" => Some(100.0),
        _ => None,
    }) {
        value *= factor;
        end += 1;
    }
    Number { span: Span { start: i, end }, value, article: false, vague: false }
}

/// Reads number words of an alphabetic language: "twenty-four", "three hundred", "vierundzwanzig", "treinta y dos".
fn words_at(tokens: &[Token], i: usize, spoken: &Spoken, language: &str) -> Option<(usize, f64)> {
    let word = |k: usize| tokens.get(k).filter(|t| t.kind == Kind::Word).map(|t| t.text.as_str());
    let single = |k: usize| {
        let text = word(k)?;
        spoken.numbers.get(text).copied().or_else(|| if language == "de" { german(text, spoken) } else { None })
    };
    let mut total = 0.0;
    let mut group = single(i).or_else(|| spoken.multipliers.get(word(i)?).map(|_| 1.0))?;
    let mut end = if single(i).is_some() { i + 1 } else { i };
    while let Some(next) = word(end) {
        if let Some(factor) = spoken.multipliers.get(next) {
            group *= factor;
            if *factor >= 1000.0 {
                total += group;
                group = 0.0;
            }
            end += 1;
        } else if let Some(value) = single(end)
            && fits(group, value)
            && tokens[end].text != "a"
        {
            group += value;
            end += 1;
        } else if let Some(after) = spoken.tag_at(tokens, end, Tag::NumberJoins)
            && let Some(value) = single(after)
            && fits(group, value)
            && group >= 20.0
        {
            group += value;
            end = after + 1;
        } else {
            break;
        }
    }
    Some((end, total + group))
}

/// Returns true when a smaller number can follow: units after tens, tens after hundreds.
fn fits(group: f64, value: f64) -> bool {
    value > 0.0
        && ((group >= 20.0 && group % 10.0 == 0.0 && value < 10.0)
            || (group >= 60.0 && group % 20.0 == 0.0 && value < 20.0)
            || (group >= 100.0 && group % 100.0 == 0.0 && value < 100.0)
            || (group == 0.0))
}

/// Reads a number at the head of a compound: the "sechs" of "Sechsbettzimmer".
pub(crate) fn in_one_word(head: &str, spoken: &Spoken) -> Option<f64> {
    german(head, spoken)
}

/// Reads a German number written in one word: "einundzwanzig", "zweihundertfünfzig".
fn german(text: &str, spoken: &Spoken) -> Option<f64> {
    if let Some(value) = spoken.numbers.get(text) {
        return Some(*value);
    }
    for (word, factor) in spoken.multipliers.iter().rev() {
        if let Some((head, tail)) = text.split_once(word.as_str()) {
            let head = if head.is_empty() { 1.0 } else { german(head, spoken)? };
            let tail = if tail.is_empty() { 0.0 } else { german(tail.strip_prefix("und").unwrap_or(tail), spoken)? };
            return Some(head * factor + tail);
        }
    }
    let (units, tens) = text.split_once("und")?;
    let (units, tens) = (spoken.numbers.get(units)?, spoken.numbers.get(tens)?);
    (*units < 10.0 && *tens >= 20.0).then_some(units + tens)
}

/// Reads Chinese numerals up to 万.
fn chinese(tokens: &[Token], i: usize) -> Option<(usize, f64)> {
    let digit = |t: &Token| {
        "零一二三四五六七八九".chars().position(|c| t.text.starts_with(c)).or(match t.text.as_str() {
            "两" | "俩" | "兩" => Some(2),
            "〇" => Some(0),
            _ => None,
        })
    };
    let unit = |t: &Token| match t.text.as_str() {
        "十" => Some(10.0),
        "百" => Some(100.0),
        "千" => Some(1000.0),
        "万" => Some(10_000.0),
        _ => None,
    };
    let (mut total, mut current, mut end, mut seen) = (0.0, 0.0, i, false);
    while let Some(token) = tokens.get(end).filter(|t| t.kind == Kind::Han) {
        if let Some(value) = digit(token) {
            current = value as f64;
        } else if let Some(factor) = unit(token) {
            let base = if current > 0.0 || seen { current } else { 1.0 };
            if factor >= 10_000.0 {
                total = (total + base) * factor;
            } else {
                total += base * factor;
            }
            current = 0.0;
        } else {
            break;
        }
        seen = true;
        end += 1;
    }
    seen.then_some((end, total + current))
}

/// Reads a Korean numeral: native ones at the start of a word, Chinese ones before a counter.
fn korean(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> Option<(usize, f64)> {
    if !tokens[i].spaced {
        return None;
    }
    let counter = |end: usize| is_tagged(spoken, tokens, end, Tag::Counters);
    let mut text = String::new();
    let mut native = None;
    for (j, token) in tokens.iter().enumerate().skip(i).take(4) {
        if token.kind != Kind::Hangul || (j > i && token.spaced) {
            break;
        }
        text.push_str(&token.text);
        if let Some(value) = spoken.iter().find_map(|s| s.numbers.get(&text)) {
            let ends = counter(j + 1) || tokens.get(j + 1).is_some_and(|t| t.spaced && t.kind == Kind::Hangul);
            if ends {
                native = Some((j + 1, *value));
            }
        }
    }
    if native.is_some() {
        return native;
    }
    let (mut total, mut current, mut end) = (0.0, 0.0, i);
    while let Some(token) = tokens.get(end).filter(|t| t.kind == Kind::Hangul && (end == i || !t.spaced)) {
        if let Some(value) = "영일이삼사오육칠팔구".chars().position(|c| token.text.starts_with(c)) {
            current = value as f64;
        } else if let Some(factor) = match token.text.as_str() {
            "십" => Some(10.0),
            "백" => Some(100.0),
            "천" => Some(1000.0),
            "만" => Some(10_000.0),
            _ => None,
        } {
            total += if current > 0.0 { current } else { 1.0 } * factor;
            current = 0.0;
        } else {
            break;
        }
        end += 1;
    }
    (end > i && counter(end)).then_some((end, total + current))
}

#[cfg(test)]
mod tests {
    use super::super::text::tokens;
    use super::super::words::words;
    use super::*;

    #[test]
    fn digits_of_names_count_nothing() {
        for (language, text, values) in [
            ("en", "2 BSL-2 labs and 1 BSL-3 lab", vec![2.0, 1.0]),
            ("en", "221B Baker Street", vec![]),
            ("en", "class 100 cleanroom, Type-2 meeting room, 3 offices", vec![3.0]),
            ("en", "60-80 employees, 80sqm-100sqm, robots x2", vec![80.0, 80.0, 100.0, 2.0]),
            ("de", "Reinraum der Klasse 5, 3 Labore", vec![3.0]),
            ("zh", "100级洁净室，会议室3间", vec![3.0]),
        ] {
            let spoken = [&words().languages[language], &words().languages["en"]];
            let found: Vec<f64> = numbers(&tokens(text), language, &spoken).iter().map(|n| n.value).collect();
            assert_eq!(found, values, "{text}");
        }
    }

    #[test]
    fn reads_numbers_in_six_languages() {
        for (language, text, value) in [
            ("en", "twenty-four beds", 24.0),
            ("en", "three hundred and five desks", 305.0),
            ("en", "a dozen bedrooms", 12.0),
            ("en", "half a dozen rooms", 6.0),
            ("en", "minus three bedrooms", -3.0),
            ("en", "-3 bedrooms", -3.0),
            ("en", "1,500 people", 1500.0),
            ("en", "3-4 bedrooms", 4.0),
            ("de", "zwölf Betten", 12.0),
            ("de", "einundzwanzig Zimmer", 21.0),
            ("de", "zweihundertfünfzig Personen", 250.0),
            ("fr", "deux chambres", 2.0),
            ("fr", "vingt-cinq employés", 25.0),
            ("fr", "quatre-vingt-dix personnes", 90.0),
            ("es", "treinta y dos camas", 32.0),
            ("es", "veintidós empleados", 22.0),
            ("zh", "三十二张床", 32.0),
            ("zh", "两间教室", 2.0),
            ("zh", "十间客房", 10.0),
            ("ko", "두 개의 회의실", 2.0),
            ("ko", "열두 명", 12.0),
            ("ko", "십이 명", 12.0),
            ("ko", "10만 개", 100_000.0),
            ("en", "two and a half baths", 2.5),
        ] {
            let spoken = [&words().languages[language], &words().languages["en"]];
            let found = numbers(&tokens(text), language, &spoken);
            assert_eq!(found.first().map(|n| n.value), Some(value), "{text}: {found:?}");
        }
    }
}
