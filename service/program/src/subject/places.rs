//! Countries, their divisions and cities in prompts: which jurisdiction applies. Their names stand in `model::gazetteer`.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use d3dgen_model::gazetteer::PLACES;
use d3dgen_model::knowledge::is_jurisdiction;
use d3dgen_model::scene_graph::Note;
use serde::Deserialize;

use crate::tokens::text::{Kind, Phrases, Span, Token, tokens};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end, tag_ends_at};

/// One line of the names of places.
#[derive(Debug, Deserialize)]
struct Line {
    /// ISO 3166 code of a country (`CA`) or a division (`CA-ON`); of a city, the nearest of both that is known.
    #[serde(default)]
    code: Option<String>,
    /// Countries and divisions that share the name.
    #[serde(default)]
    codes: Vec<String>,
    names: Vec<String>,
    /// True for names that are also common words ("Nice", "Reading", "Turkey").
    #[serde(default)]
    strict: bool,
    #[serde(default)]
    city: bool,
    /// True for codes that are words or abbreviations too ("IT", "ER"): alone they name no country.
    #[serde(default)]
    code_is_word: bool,
}

#[derive(Debug, Clone)]
struct Place {
    codes: Vec<String>,
    strict: bool,
    city: bool,
}

struct Gazetteer {
    phrases: Phrases<Place>,
    /// Names as they are written, folded, one space between their words: "in de" is no "Inde".
    written: BTreeSet<String>,
    /// Codes of countries and divisions with their names.
    names: BTreeMap<String, String>,
    /// Codes of countries that name them in a sentence.
    spoken_codes: BTreeSet<String>,
}

impl Gazetteer {
    /// Returns true for a country whose divisions are listed.
    fn lists_divisions_of(&self, country: &str) -> bool {
        let after = format!("{country}-");
        self.names.range(after.clone()..).next().is_some_and(|(code, _)| code.starts_with(&after))
    }
}

fn gazetteer() -> &'static Gazetteer {
    static GAZETTEER: LazyLock<Gazetteer> = LazyLock::new(|| {
        let mut phrases = Phrases::new("");
        let (mut known, mut spoken_codes, mut written) = (BTreeMap::new(), BTreeSet::new(), BTreeSet::new());
        for line in PLACES.lines() {
            let line: Line = serde_json::from_str(line).expect("a test reads the places");
            let codes: Vec<String> = line.code.clone().into_iter().chain(line.codes).collect();
            if let (Some(code), Some(name), false) = (&line.code, line.names.first(), line.city) {
                known.entry(code.clone()).or_insert_with(|| name.clone());
                if !line.code_is_word && !code.contains('-') {
                    spoken_codes.insert(code.clone());
                }
            }
            for name in &line.names {
                written.insert(spelled(&tokens(name)));
                let place = Place { codes: codes.clone(), strict: line.strict, city: line.city };
                phrases.put(name, place, |old: &Place, new| {
                    // a country wins over a city of the same name; a listed ambiguity over both
                    if new.codes.len() > old.codes.len() || (old.city && !new.city) { new.clone() } else { old.clone() }
                });
            }
        }
        Gazetteer { phrases, written, names: known, spoken_codes }
    });
    &GAZETTEER
}

/// Returns words with one space between them.
fn spelled(words: &[Token]) -> String {
    let words: Vec<&str> = words.iter().filter(|t| !t.is_mark()).map(|t| t.text.as_str()).collect();
    words.join(" ")
}

/// What the prompt says about the place.
#[derive(Debug, Default)]
pub(crate) struct Whereabouts {
    pub country_code: Option<String>,
    pub spans: Vec<Span>,
    pub assumptions: Vec<Note>,
    pub conflicts: Vec<Note>,
}

/// Returns the ISO 3166 code of a country or of one of its divisions, for a code (`ca-on`) or a name in one of six
/// languages; a city gives where it lies.
pub(crate) fn code_of(text: &str) -> Option<String> {
    let upper = text.trim().to_uppercase();
    if gazetteer().names.contains_key(&upper) || is_unlisted_division(&upper) {
        return Some(upper);
    }
    let place = gazetteer().phrases.whole(text)?;
    if let [code] = place.codes.as_slice() { Some(code.clone()) } else { None }
}

/// Returns true for a division of a country of which no division is listed: which there are nobody here can say.
fn is_unlisted_division(code: &str) -> bool {
    let country = country_of(code);
    country != code
        && is_jurisdiction(code)
        && gazetteer().names.contains_key(country)
        && !gazetteer().lists_divisions_of(country)
}

/// Returns the country of a code.
pub(crate) fn country_of(code: &str) -> &str {
    code.split('-').next().unwrap_or(code)
}

/// Returns the nearer of two codes where one lies in the other.
pub(crate) fn nearer<'a>(a: &'a str, b: &'a str) -> Option<&'a str> {
    match (country_of(a), country_of(b)) {
        (x, y) if x != y => None,
        _ if a == b || country_of(b) == b => Some(a),
        _ if country_of(a) == a => Some(b),
        _ => None,
    }
}

/// Words of a place's name before one of them, at most.
const MOST_BEFORE: usize = 2;

/// Returns true for a word of the name of a place.
pub(crate) fn names(tokens: &[Token], at: usize) -> bool {
    let ends = |i: usize| gazetteer().phrases.longest_at(tokens, i).is_some_and(|(end, _)| end > at);
    (at.saturating_sub(MOST_BEFORE)..=at).any(ends)
}

/// Returns the name of a country or a division.
pub(super) fn name_of(code: &str) -> &str {
    gazetteer().names.get(code).map_or(code, String::as_str)
}

/// Finds the place a prompt names.
pub(crate) fn locate(tokens: &[Token], prompt: &str, spoken: &[&Spoken]) -> Whereabouts {
    let mut out = Whereabouts::default();
    let mut found: Vec<(Span, Place)> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let before = found
            .last()
            .filter(|(span, _)| tokens[span.end..i].iter().all(|t| t.mark() == Some(',')) && i <= span.end + 1);
        let written = code_at(tokens, i, prompt, spoken, before.map(|(_, place)| place));
        match written.or_else(|| place_at(tokens, i, prompt, spoken)) {
            Some((end, place)) => {
                out.spans.push(Span { start: i, end });
                found.push((Span { start: i, end }, place));
                i = end;
            }
            None => i += 1,
        }
    }
    let mut codes: Vec<&str> = Vec::new();
    for (_, place) in &found {
        let [code] = place.codes.as_slice() else { continue };
        // "Toronto, Canada" is one place
        match codes.iter().position(|known| nearer(known, code).is_some()) {
            Some(at) => codes[at] = nearer(codes[at], code).unwrap_or(code),
            None => codes.push(code),
        }
    }
    let text = |span: &Span| prompt.get(tokens[span.start].start..tokens[span.end - 1].end).unwrap_or("");
    let open = found.iter().find(|(_, place)| place.codes.len() > 1);
    match (codes.as_slice(), open) {
        ([code], _) => out.country_code = Some((*code).to_owned()),
        ([], Some((span, place))) => {
            let names: Vec<&str> = place.codes.iter().map(|c| name_of(c)).collect();
            out.conflicts.push(Note::new(
                "ambiguous_place",
                format!(
                    "`{}` can be in {}; no country's rules were applied, name the country to choose",
                    text(span),
                    names.join(" or ")
                ),
            ));
        }
        ([first, .., last], _) => {
            // "London, Ontario" and "Paris, Texas": the wider place comes last; "Berlin or Paris" has no winner.
            let adjacent =
                found.windows(2).all(|w| tokens[w[0].0.end..w[1].0.start].iter().all(|t| t.mark() == Some(',')));
            let one_country = codes.iter().all(|c| country_of(c) == country_of(first));
            let code = match (adjacent, one_country) {
                (true, _) => last,
                (false, true) => country_of(first),
                (false, false) => first,
            };
            out.country_code = Some(code.to_owned());
            // "Portland, Maine"
            if !(adjacent && one_country) {
                let names: Vec<&str> = codes.iter().map(|c| name_of(c)).collect();
                out.conflicts.push(Note::new(
                    "several_places",
                    format!(
                        "the prompt names places in {}; the rules of {} were applied",
                        names.join(", "),
                        name_of(code)
                    ),
                ));
            }
        }
        ([], None) => {}
    }
    if out.country_code.is_none() && out.conflicts.is_empty() {
        nationality(tokens, spoken, &mut out);
    }
    if let Some(note) = nowhere(tokens, prompt, spoken, &out.spans) {
        if out.country_code.is_some() { out.assumptions.push(note) } else { out.conflicts.push(note) }
    }
    out
}

/// Reads a code of a country or a division, in capitals: `office in DE`, `hospital, US-NC`, and, behind a place,
/// `Austin, TX`. In lower case, and where all is in capitals, the letters are words ("toilet in de hal").
fn code_at(
    tokens: &[Token],
    i: usize,
    prompt: &str,
    spoken: &[&Spoken],
    behind: Option<&Place>,
) -> Option<(usize, Place)> {
    let raw = |t: &Token| prompt.get(t.start..t.end).unwrap_or("");
    let code = raw(&tokens[i]);
    if code.len() != 2 || !code.bytes().all(|b| b.is_ascii_uppercase()) {
        return None;
    }
    let place = |code: String, end: usize| Some((end, Place { codes: vec![code], strict: false, city: false }));
    if let Some(division) = tokens.get(i + 1).filter(|t| prompt.get(tokens[i].end..t.start) == Some("-")) {
        let whole = format!("{code}-{}", raw(division));
        return if code_of(&whole).is_some_and(|c| c == whole) { place(whole, i + 2) } else { None };
    }
    let shouted = |t: &Token| t.kind != Kind::Word || raw(t).chars().all(char::is_uppercase);
    let ends = tokens.get(i + 1).is_none_or(Token::is_mark);
    if !ends || tokens.iter().all(shouted) {
        return None;
    }
    if let Some([of]) = behind.map(|p| p.codes.as_slice()) {
        let division = format!("{}-{code}", country_of(of));
        if gazetteer().names.contains_key(&division) {
            return place(division, i + 1);
        }
    }
    let inside = i.checked_sub(1).is_some_and(|b| tag_ends_at(spoken, tokens, b, Tag::Inside, i));
    let named = (inside || behind.is_some()) && gazetteer().spoken_codes.contains(code);
    if named { place(code.to_owned(), i + 1) } else { None }
}

fn place_at(tokens: &[Token], i: usize, prompt: &str, spoken: &[&Spoken]) -> Option<(usize, Place)> {
    let token = &tokens[i];
    // "US" is a country, "us" is not
    let raw = |end: usize| prompt.get(token.start..tokens[end - 1].end).unwrap_or("");
    if token.text == "us" && raw(i + 1) == "US" {
        return Some((i + 1, Place { codes: vec!["US".into()], strict: false, city: false }));
    }
    for (letters, code) in [(["u", "s"], "US"), (["u", "k"], "GB")] {
        let dotted = token.text == letters[0]
            && tokens.get(i + 1).and_then(Token::mark) == Some('.')
            && tokens.get(i + 2).is_some_and(|t| t.text == letters[1]);
        if dotted && token.capital {
            return Some((i + 3, Place { codes: vec![code.into()], strict: false, city: false }));
        }
    }
    let phrases = &gazetteer().phrases;
    let whole = |end: &usize| {
        *end == i + 1 || token.kind != Kind::Word || gazetteer().written.contains(&spelled(&tokens[i..*end]))
    };
    let longest = phrases.longest_at(tokens, i).filter(|(end, _)| whole(end));
    let (end, place) = longest.or_else(|| Some((i + 1, phrases.word(&token.text)?)))?;
    let before = (1..=2).any(|k| i.checked_sub(k).is_some_and(|b| tag_ends_at(spoken, tokens, b, Tag::PlaceBefore, i)));
    let apart = i.checked_sub(1).is_none_or(|b| tokens[b].is_mark());
    let last = tokens.get(end).is_none_or(Token::is_mark);
    match token.kind {
        Kind::Hangul => {
            // inside a Korean word a name is chance ("이란" in "공간이란")
            (token.spaced && end > i + 1).then(|| (end, place.clone()))
        }
        Kind::Han => Some((end, place.clone())),
        _ => {
            let strict = place.strict || (end == i + 1 && token.text.len() < 4 && !token.capital);
            let fits = !strict || (token.capital && (before || (apart && last && i > 0)));
            // "Paris-style": a name joined to a following word is a kind, not a place
            let joined = is_tagged(spoken, tokens, end, Tag::OfKind);
            // nor the "Check-in-Halle" the town of Halle
            let end_of_word = !token.spaced && i.checked_sub(1).is_some_and(|b| tokens[b].kind == Kind::Word);
            (fits && !joined && !end_of_word).then(|| (end, place.clone()))
        }
    }
}

/// Takes the country from "a German hospital" or "by Swiss rules"; cuisines and styles are no places.
fn nationality(tokens: &[Token], spoken: &[&Spoken], out: &mut Whereabouts) {
    for (i, token) in tokens.iter().enumerate() {
        for s in spoken {
            let Some((code, _)) = s
                .words
                .demonyms
                .iter()
                .find(|(_, words)| words.iter().any(|w| crate::tokens::text::fold(w) == token.text))
            else {
                continue;
            };
            let styled = (i + 1..(i + 4).min(tokens.len()))
                .take_while(|&j| !tokens[j].is_mark())
                .any(|j| is_tagged(spoken, tokens, j, Tag::StyleWords));
            if styled || !token.capital {
                continue;
            }
            out.country_code = Some(code.clone());
            out.spans.push(Span { start: i, end: i + 1 });
            out.assumptions.push(Note::new(
                "country_from_adjective",
                format!("`{}` was read as the country {}", token.text, name_of(code)),
            ));
            return;
        }
    }
}

/// Takes the country from the adjective beside the word for the building: "deutsches Krankenhaus", "hôpital français".
pub(crate) fn of_building(
    tokens: &[Token],
    spoken: &[&Spoken],
    (language, buildings): (&str, &[Span]),
    assumptions: &mut Vec<Note>,
) -> Option<(String, Span)> {
    // in these languages adjectives follow their noun, at times behind another: "clínica dental española"
    let behind = if matches!(language, "fr" | "es") { 2 } else { 0 };
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    for (i, token) in tokens.iter().enumerate() {
        let follows = |s: &Span| (s.end..s.end + behind).contains(&i) && (s.end..i).all(|k| !tokens[k].is_mark());
        if !buildings.iter().any(|s| i + 1 == s.start || follows(s)) {
            continue;
        }
        let named = |w: &String| crate::tokens::text::fold(w) == token.text;
        let mut all = spoken.iter().flat_map(|s| &s.words.demonyms);
        let Some((code, _)) = all.find(|(_, words)| words.iter().any(named)) else { continue };
        let kitchen = |s: &Span| (s.start..s.end).any(|k| tagged(k, Tag::StyleWords));
        if buildings.iter().any(kitchen) {
            continue;
        }
        let after = (i + 1..(i + 4).min(tokens.len())).take_while(|&j| !tokens[j].is_mark());
        if after.into_iter().any(|j| tagged(j, Tag::StyleWords)) {
            continue;
        }
        let message = format!("`{}` was read as the country {}", token.text, name_of(code));
        assumptions.push(Note::new("country_from_adjective", message));
        return Some((code.clone(), Span { start: i, end: i + 1 }));
    }
    None
}

/// Returns a note on a place that has no building law, or that nobody knows.
fn nowhere(tokens: &[Token], prompt: &str, spoken: &[&Spoken], known: &[Span]) -> Option<Note> {
    for i in 0..tokens.len() {
        let named = tag_end(spoken, tokens, i, Tag::Nowhere);
        let before =
            (1..=2).any(|k| i.checked_sub(k).is_some_and(|b| tag_ends_at(spoken, tokens, b, Tag::PlaceBefore, i)));
        let wide = matches!(tokens[i].kind, Kind::Han | Kind::Hangul);
        if let Some(end) = named
            && (before || tokens[i].capital || wide)
            && !known.iter().any(|s| s.contains(i))
        {
            let name = prompt.get(tokens[i].start..tokens[end - 1].end).unwrap_or("");
            return Some(Note::new(
                "unknown_place",
                format!(
                    "`{name}` has no building rules; only international rules were applied, name a country to choose"
                ),
            ));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tokens::words::words;

    fn located(text: &str) -> Option<String> {
        let spoken =
            [&words().languages["en"], &words().languages["de"], &words().languages["zh"], &words().languages["ko"]];
        locate(&tokens(text), text, &spoken).country_code
    }

    #[test]
    fn cities_and_countries_lead_to_codes() {
        for (text, code) in [
            ("two-bedroom flat in Germany", Some("DE")),
            ("flat in Tokyo", Some("JP")),
            ("Wohnung in München", Some("DE-BY")),
            ("上海一套住宅", Some("CN")),
            ("서울에 있는 아파트", Some("KR")),
            ("Italian restaurant in Chicago", Some("US-IL")),
            ("Italian restaurant", None),
            ("a German hospital", Some("DE")),
            ("Flat in Georgia", None),
            ("flat in Atlanta, Georgia", Some("US-GA")),
            ("flat in Tbilisi, Georgia", Some("GE")),
            ("hospital on Mars", None),
            ("house with a reading room and a bath", None),
            ("Mobile vacuum robot", None),
            ("house in Nice, with a nice kitchen", Some("FR")),
            ("give us an office", None),
            ("office, US", Some("US")),
            ("office in the U.S.", Some("US")),
            ("London, Ontario", Some("CA-ON")),
            ("flat in Toronto, Canada", Some("CA-ON")),
            ("Büro in Zürich", Some("CH-ZH")),
            ("hospital in North Carolina", Some("US-NC")),
            ("clinic in Dubai", Some("AE-DU")),
            ("Krankenhaus in Bayern", Some("DE-BY")),
            ("flat in Portland, Maine", Some("US-ME")),
            ("an office in Munich and one in Kiel", Some("DE")),
            ("offices, one in Munich, one in Paris", Some("DE-BY")),
            ("office in DE", Some("DE")),
            ("ward, US-NC", Some("US-NC")),
            ("house in Austin, TX", Some("US-TX")),
            ("house in San Francisco, CA, with a garage", Some("US-CA")),
            ("office in de hoek", None),
            ("toilet in de hal", None),
            ("TOILET IN DE HAL", None),
            ("the server racks in IT", None),
            ("beds in ER", None),
            ("rooms per u shape", None),
            ("flat in New Zealand, the usual", Some("NZ")),
            ("flat in CA-ZZ", None),
            ("office in New Zealand", Some("NZ")),
        ] {
            assert_eq!(located(text).as_deref(), code, "{text}");
        }
    }

    #[test]
    fn flags_read_codes_and_names() {
        for (text, code) in [
            ("de", Some("DE")),
            ("Germany", Some("DE")),
            ("UK", Some("GB")),
            ("CA-ON", Some("CA-ON")),
            ("us-nc", Some("US-NC")),
            ("Toronto", Some("CA-ON")),
            ("Zürich", Some("CH-ZH")),
            ("Bayern", Some("DE-BY")),
            ("Vorarlberg", Some("AT-8")),
            ("JP-13", Some("JP-13")),
            ("US-ZZ", None),
            ("XX", None),
            ("XX-1", None),
            ("", None),
        ] {
            assert_eq!(code_of(text).as_deref(), code, "{text}");
        }
    }
}
