//! Which building a prompt is about: domain, building type, the words that say so, and where its list of rooms begins.

use std::sync::Arc;

use d3dgen_model::domain::{Domain, Words};
use d3dgen_plugins::Registry;

use crate::tokens::negation::is_ruled_out;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Kind, Phrases, Span, Token, fold};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end, tag_ends_at, words};

/// The building a prompt names.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Building {
    pub domain: String,
    pub building_type: Option<String>,
    /// Words that name it; these are no rooms.
    pub head: Option<Span>,
    /// First token of the list of rooms.
    pub list_from: usize,
    /// True when the prompt has no word for a building, and its rooms decided.
    pub by_rooms: bool,
    /// Other buildings and departments that its list names.
    pub parts: Vec<Part>,
    /// True when its type stands in the list: "hospital: a maternity unit, two operating rooms".
    pub listed_type: bool,
    /// All words for buildings.
    pub words: Vec<Span>,
    /// Room types of the departments that it is to be without: "hospital, no ICU".
    pub without: Vec<String>,
}

impl Building {
    /// Returns the building of a prompt without a word for one.
    pub(crate) fn none(domain: &str) -> Self {
        Self {
            domain: domain.to_owned(),
            building_type: None,
            head: None,
            list_from: 0,
            by_rooms: false,
            parts: Vec::new(),
            listed_type: false,
            words: Vec::new(),
            without: Vec::new(),
        }
    }
}

/// A building or department named beside the one that is built: "ward with radiology".
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    pub span: Span,
    pub domain: String,
    pub building_type: String,
}

/// Adjectives between a number and what it counts, at most.
const MOST_ADJECTIVES: usize = 3;
/// Words before a building named late, back to the mark that it stands behind: "..., a small family home".
const MOST_BEFORE_LATE: usize = 3;

/// Words that join two buildings, at most: "and an".
const MOST_JOINING: usize = 2;

/// A word for a building: domain and, where it is one, building type.
type Meaning = Vec<(usize, Option<usize>)>;

/// Returns the building, or `None` when neither a building nor a room is named.
pub(crate) fn recognize(
    tokens: &[Token],
    registry: &Registry,
    languages: &[&str],
    spoken: &[&Spoken],
    numbers: &[Number],
    places: &[Span],
    only: Option<&str>,
) -> Option<Building> {
    let domains: Vec<&Domain> =
        registry.iter().map(|p| p.domain()).filter(|d| only.is_none_or(|o| o == d.id)).collect();
    let list_from = list_start(tokens, spoken, languages);
    let mut found = occurrences(tokens, registry, &domains, languages, spoken, numbers, places);
    // a "loft-style office" is no loft
    found.retain(|(span, _)| !is_tagged(spoken, tokens, span.end, Tag::OfKind));
    let named = found.iter().map(|f| f.0).collect();
    let language = languages.first().copied().unwrap_or_default();
    let (denied, found): (Vec<_>, Vec<_>) =
        found.into_iter().partition(|(span, _)| is_ruled_out(tokens, spoken, language, *span));
    let rooms = domains.iter().flat_map(|d| room_words(d, registry, languages)).collect::<Vec<_>>();
    let head_final = matches!(languages.first(), Some(&("zh" | "ko")));
    let plural = |span: &Span| {
        let before = numbers.iter().any(|n| {
            let after = counter(tokens, n, languages, spoken);
            [Some(n.span.end), after]
                .into_iter()
                .flatten()
                .any(|from| counts_rooms(tokens, n, from, *span, &rooms, spoken))
        });
        // "offices 1 to 12"
        let range = |n: &Number| is_tagged(spoken, tokens, n.span.end, Tag::Range);
        let numbered = tokens[span.end - 1].text.ends_with('s')
            && numbers.iter().any(|n| n.span.start == span.end && !n.article && range(n));
        before || numbered || head_final && numbers.iter().any(|n| counts_before(tokens, n, *span, spoken))
    };
    let pick = if head_final {
        found.iter().filter(|(s, _)| !plural(s)).max_by_key(|(span, _)| {
            let ends = tokens.get(span.end).is_none_or(Token::is_mark);
            let first = found.first().is_some_and(|f| f.0 == *span);
            let item = is_item(tokens, span.start, spoken, first);
            (!item, span.end - span.start + if ends { 3 } else { 0 } + usize::from(span.start == 0), span.start)
        })
    } else {
        let before: Vec<&(Span, Meaning)> = found.iter().filter(|(s, _)| s.start < list_from && !plural(s)).collect();
        // "veterinary practice" beside "practice": the longer of two neighbors
        match before.as_slice() {
            [a, b, ..] if a.0.end == b.0.start && b.0.end - b.0.start > a.0.end - a.0.start => Some(*b),
            [a, ..] => Some(*a),
            [] => None,
        }
    };
    let (pick, list_from) = match pick {
        None if !head_final => {
            let late = found
                .iter()
                .filter(|(s, _)| !plural(s))
                .find(|(s, _)| is_late(tokens, *s, numbers, &rooms, spoken, places));
            (late, if late.is_some() { 0 } else { list_from })
        }
        pick => (pick, list_from),
    };
    let votes = || room_votes(tokens, registry, &domains, languages, spoken, places);
    let Some((span, meaning)) = pick else {
        let mut votes = votes();
        // "two offices": rooms here, but a word for that building all the same
        found.iter().flat_map(|f| &f.1).for_each(|m| votes[m.0] += 1);
        let best = votes.into_iter().enumerate().max_by_key(|&(i, n)| (n, usize::MAX - i)).filter(|v| v.1 > 0);
        // A building named only inside the list ("there is an office") still says more than nothing.
        let late = found.first().map(|(_, m)| m[0].0);
        let domain = best.map(|b| b.0).or(late)?;
        return Some(Building {
            domain: domains[domain].id.clone(),
            building_type: None,
            head: None,
            list_from: 0,
            by_rooms: true,
            parts: Vec::new(),
            listed_type: false,
            words: named,
            without: Vec::new(),
        });
    };
    let (domain, kind) = if meaning.len() > 1 {
        let votes = votes();
        let typed = |m: &&(usize, Option<usize>)| (m.1.is_some(), votes[m.0], usize::MAX - m.0);
        *meaning.iter().max_by_key(typed)?
    } else {
        *meaning.first()?
    };
    let own_kind = kind;
    let kind = kind.or_else(|| other_type(&found, domain));
    let listed_type = own_kind.is_none() && kind.is_some() && !head_final;
    let parts = if head_final {
        Vec::new()
    } else {
        parts(&found, *span, list_from, (domain, kind), &domains, (tokens, spoken))
    };
    Some(Building {
        domain: domains[domain].id.clone(),
        building_type: kind.map(|k| domains[domain].building_types[k].id.clone()),
        head: Some(without_count(tokens, *span, numbers, spoken)),
        list_from: if head_final || list_from == 0 { 0 } else { list_from.max(span.end) },
        by_rooms: false,
        parts,
        listed_type,
        words: named,
        without: denied.iter().filter_map(|(_, meaning)| purpose(domains[domain], domain, meaning)).collect(),
    })
}

/// Returns the room type that a department of a domain is for.
fn purpose(of: &Domain, domain: usize, meaning: &Meaning) -> Option<String> {
    let kind = meaning.iter().find(|m| m.0 == domain)?.1?;
    Some(of.program(&of.building_types[kind].program)?.rooms.first()?.room_type.clone())
}

/// Returns the buildings and departments that the list names, beside the building itself.
fn parts(
    found: &[(Span, Meaning)],
    own: Span,
    list_from: usize,
    built: (usize, Option<usize>),
    domains: &[&Domain],
    words: (&[Token], &[&Spoken]),
) -> Vec<Part> {
    // "hospital pharmacy and outpatient department": as a list of two, without a word that begins one
    let joined = |span: &Span| {
        let (tokens, spoken) = words;
        let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
        built.1.is_some()
            && (own.end..span.start).len() <= MOST_JOINING
            && tagged(own.end, Tag::Joins)
            && (own.end + 1..span.start).all(|i| [Tag::Articles, Tag::Definite].iter().any(|&t| tagged(i, t)))
    };
    let typed = |meaning: &Meaning| meaning.iter().any(|m| m.0 == built.0 && m.1.is_some_and(|k| Some(k) != built.1));
    let listed = found.iter().filter(|(span, meaning)| {
        *span != own && span.start > own.start && (span.start >= list_from || joined(span) && typed(meaning))
    });
    listed
        .filter_map(|(span, meaning)| {
            let same = meaning.iter().find(|m| m.0 == built.0);
            let (domain, kind) = same.or(meaning.first()).copied()?;
            let kind = kind.or_else(|| begun_by(domains[domain], *span, words));
            let kind = kind.filter(|_| (domain, kind) != built)?;
            let building_type = domains[domain].building_types[kind].id.clone();
            Some(Part { span: *span, domain: domains[domain].id.clone(), building_type })
        })
        .collect()
}

/// Returns the department whose name begins with a word that is an item of the list by itself: "ICU, outpatient".
fn begun_by(domain: &Domain, span: Span, (tokens, spoken): (&[Token], &[&Spoken])) -> Option<usize> {
    let parts = |i: usize| tokens.get(i).is_none_or(|t| t.is_mark() || is_tagged(spoken, tokens, i, Tag::Joins));
    let whole = span.start > 0 && parts(span.start - 1) && parts(span.end);
    let name = tokens.get(span.start).filter(|_| whole && span.end == span.start + 1)?.text.as_str();
    let begins = |phrase: &String| phrase.split_once(' ').is_some_and(|(first, _)| fold(first) == name);
    domain.building_types.iter().position(|b| b.keywords.values().flatten().any(begins))
}

/// Returns true for a building word that a number before it makes a word for rooms: "two offices", "two large offices",
/// and, where a longer word for a room holds it, "one private office".
fn counts_rooms(
    tokens: &[Token],
    number: &Number,
    from: usize,
    span: Span,
    rooms: &[Arc<Phrases<()>>],
    spoken: &[&Spoken],
) -> bool {
    let plain = |i: usize| {
        let tags = spoken.iter().filter_map(|s| s.tags.longest_at(tokens, i)).flat_map(|f| f.1).collect::<Vec<_>>();
        !tags.is_empty() && tags.iter().all(|t| matches!(t, Tag::NotNames | Tag::Own | Tag::StyleWords | Tag::OpenPlan))
    };
    // the number of "12-bed ward" is of its beds
    let held = [Tag::Beds, Tag::Desks, Tag::Holds];
    let holds =
        |s: &&Spoken| held.iter().any(|&tag| s.tag_at(tokens, span.start, tag).is_some_and(|end| end < span.end));
    let inside = |i: usize| {
        spoken.iter().any(|s| s.tags.word(&tokens[i].text).is_some_and(|t| held.iter().any(|h| t.contains(h))))
    };
    if from == span.start && (spoken.iter().any(holds) || span.end > span.start + 1 && inside(span.start)) {
        return false;
    }
    let several = number.value > 1.0;
    let longer = |i: usize| rooms.iter().any(|r| r.longest_at(tokens, i).is_some_and(|f| f.0 >= span.end));
    // behind adjectives only in the plural: "floor 2 public library" has one library
    let ends_plural = tokens[span.end - 1].text.ends_with('s');
    let last = (from + MOST_ADJECTIVES).min(span.start);
    (from..=last).take_while(|&i| i == from || plain(i - 1)).any(|i| {
        let counted = several && i == span.start && (i == from || ends_plural);
        counted || i < span.start && number.value >= 1.0 && !number.article && !number.vague && longer(i)
    })
}

/// Returns the end of the counter behind a number, where what is counted can follow: "两间办公室", but in Korean only
/// before "의" ("두 개의 사무실"), since a Korean number counts the noun before it. Storeys are no counter of rooms.
fn counter(tokens: &[Token], number: &Number, languages: &[&str], spoken: &[&Spoken]) -> Option<usize> {
    let at = number.span.end;
    let tagged = |tag| tag_end(spoken, tokens, at, tag);
    if words().area_units.longest_at(tokens, at).is_some() || tagged(Tag::Storeys).is_some() {
        return None;
    }
    let end = tagged(Tag::Counters)?;
    if languages.first() != Some(&"ko") {
        return Some(end);
    }
    tokens.get(end).filter(|t| t.text == "의").map(|_| end + 1)
}

/// Returns true for "病房8间", "병실 8개": the number counts the word before it, and nothing else follows it.
fn counts_before(tokens: &[Token], number: &Number, span: Span, spoken: &[&Spoken]) -> bool {
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    let Some(end) = tagged(number.span.end, Tag::RoomCounters).filter(|_| number.span.start == span.end) else {
        return false;
    };
    tokens.get(end).is_none_or(|t| t.is_mark() || t.spaced) || tagged(end, Tag::Joins).is_some()
}

/// Returns true for a building named behind its rooms, at the head of a phrase: "three bedrooms, a bath, family home in
/// Leeds". A word that may be a room as well is one unless no other room is named.
fn is_late(
    tokens: &[Token],
    span: Span,
    numbers: &[Number],
    rooms: &[Arc<Phrases<()>>],
    spoken: &[&Spoken],
    places: &[Span],
) -> bool {
    // of "3 bedroom house" the number and its room
    let count = numbers.iter().find(|n| n.span.end < span.start && n.span.end + MOST_BEFORE_LATE > span.start);
    let counts =
        count.filter(|n| rooms.iter().any(|r| r.longest_at(tokens, n.span.end).is_some_and(|f| f.0 == span.start)));
    let plain = |i: usize| {
        counts.is_some_and(|n| i >= n.span.start)
            || [Tag::Articles, Tag::NotNames, Tag::Own].iter().any(|&t| is_tagged(spoken, tokens, i, t))
    };
    let first = (span.start.saturating_sub(MOST_BEFORE_LATE)..span.start).rev().find(|&i| !plain(i));
    let heads = first.map_or(span.start <= MOST_BEFORE_LATE, |i| tokens[i].is_mark());
    let room = |i: usize| rooms.iter().filter_map(|r| r.longest_at(tokens, i)).map(|f| f.0).max();
    let own = room(span.start).is_some_and(|end| end >= span.end);
    let others = || {
        let free = |i: &usize| {
            !counts.is_some_and(|n| *i >= n.span.start && *i < span.start)
                && !span.contains(*i)
                && !places.iter().any(|p| p.contains(*i))
        };
        (0..tokens.len()).filter(free).any(|i| room(i).is_some())
    };
    heads && (!own || !others())
}

/// Leaves a count in the building's name to the rooms: of "one-bedroom flat" only "flat" is the building, of "12-bed ward"
/// only "ward".
fn without_count(tokens: &[Token], span: Span, numbers: &[Number], spoken: &[&Spoken]) -> Span {
    let beds = spoken.iter().any(|s| s.tags.word(&tokens[span.start].text).is_some_and(|t| t.contains(&Tag::Beds)));
    let of_beds = span.end > span.start + 1 && beds && numbers.iter().any(|n| n.span.end == span.start && !n.article);
    let counted = of_beds || numbers.iter().any(|n| span.start <= n.span.start && n.span.end < span.end);
    Span { start: if counted { span.end - 1 } else { span.start }, ..span }
}

/// Returns true for a building word that is an item in a Chinese or Korean list of rooms: "有装卸区、办公室和".
fn is_item(tokens: &[Token], start: usize, spoken: &[&Spoken], first: bool) -> bool {
    let modified = start > 0 && matches!(tokens[start - 1].text.as_str(), "的" | "는" | "은" | "한" | "춘");
    if modified {
        return false;
    }
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    for i in (start.saturating_sub(4)..start).rev() {
        let han = tokens[i].kind == Kind::Han;
        if tokens[i].is_mark() {
            return !first;
        }
        if tagged(i, Tag::Joins) || han && tagged(i, Tag::Starts) {
            return true;
        }
    }
    false
}

/// Returns a building type of the domain named elsewhere ("hospital: an intensive care unit").
fn other_type(found: &[(Span, Meaning)], domain: usize) -> Option<usize> {
    let mut kinds = found.iter().flat_map(|(_, m)| m).filter_map(|(d, kind)| kind.filter(|_| *d == domain));
    let first = kinds.next()?;
    // a building with several departments is none of them
    kinds.all(|kind| kind == first).then_some(first)
}

/// Returns where a list of rooms begins: after "with", a colon, or the first comma.
fn list_start(tokens: &[Token], spoken: &[&Spoken], languages: &[&str]) -> usize {
    if matches!(languages.first(), Some(&("zh" | "ko"))) {
        return 0;
    }
    (1..tokens.len())
        .find(|&i| {
            tokens[i].mark() == Some(':')
                || (tokens[i].mark() == Some(',') && i > 1)
                || spoken.iter().any(|s| s.tag_at(tokens, i, Tag::Starts).is_some() && tokens[i].text != "rooms")
        })
        .unwrap_or(tokens.len())
}

fn occurrences(
    tokens: &[Token],
    registry: &Registry,
    domains: &[&Domain],
    languages: &[&str],
    spoken: &[&Spoken],
    numbers: &[Number],
    places: &[Span],
) -> Vec<(Span, Meaning)> {
    let ids: Vec<&str> = domains.iter().map(|d| d.id.as_str()).collect();
    let digest = |l: &&str| registry.digest(&format!("{l}: {}", ids.join(" ")), || vocabulary(domains, l));
    let vocabularies: Vec<Arc<Phrases<Meaning>>> = languages.iter().map(digest).collect();
    let mut out = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        // "3 bath house" has three baths, and is no bath house
        let short = words().dwelling.bath_letters.contains(&tokens[i].text)
            && numbers.iter().any(|n| n.span.end == i && !n.article);
        if short || places.iter().any(|p| p.contains(i)) {
            i += 1;
            continue;
        }
        let mut best: Option<(usize, &Meaning)> = None;
        for v in &vocabularies {
            if let Some((end, meaning)) = v.longest_at(tokens, i)
                && best.is_none_or(|b| end > b.0)
            {
                best = Some((end, meaning));
            }
        }
        // a "Ladestation" charges robots, and is no ward ("Station")
        let charges = is_tagged(spoken, tokens, i, Tag::Charge);
        if best.is_none() && tokens[i].kind == Kind::Word && !charges {
            best = vocabularies.iter().find_map(|v| v.ending(&tokens[i].text, 4)).map(|(m, _)| (i + 1, m));
        }
        match best {
            Some((end, meaning)) => {
                out.push((Span { start: i, end }, meaning.clone()));
                i = end;
            }
            None => i += 1,
        }
    }
    out
}

fn vocabulary(domains: &[&Domain], language: &str) -> Phrases<Meaning> {
    let mut phrases: Phrases<Meaning> = Phrases::new(language);
    let mut add = |words: &Words, meaning: (usize, Option<usize>)| {
        for phrase in words.get(language).into_iter().flatten() {
            phrases.put(phrase, vec![meaning], |old, new| {
                let mut all: Meaning = old.iter().filter(|m| m.0 != new[0].0 || m.1.is_some()).copied().collect();
                if !all.iter().any(|m| m.0 == new[0].0) {
                    all.push(new[0]);
                }
                all
            });
        }
    };
    for (d, domain) in domains.iter().enumerate() {
        for (k, kind) in domain.building_types.iter().enumerate() {
            add(&kind.keywords, (d, Some(k)));
        }
        add(&domain.keywords, (d, None));
    }
    phrases
}

/// Returns how many tokens of the prompt name rooms, by domain.
fn room_votes(
    tokens: &[Token],
    registry: &Registry,
    domains: &[&Domain],
    languages: &[&str],
    spoken: &[&Spoken],
    taken: &[Span],
) -> Vec<usize> {
    // "3 Zimmer, Küche, Bad": a word for rooms in total is no guest room
    let total = |i: usize, end: usize| tag_ends_at(spoken, tokens, i, Tag::Total, end);

    domains
        .iter()
        .map(|domain| {
            let vocabularies = room_words(domain, registry, languages);
            let mut votes = 0;
            let mut i = 0;
            while i < tokens.len() {
                let end = vocabularies.iter().filter_map(|v| v.longest_at(tokens, i)).map(|f| f.0).max();
                let end = end.filter(|e| !taken.iter().any(|s| s.contains(i)) && !total(i, *e));
                votes += end.map_or(0, |e| e - i);
                i = end.unwrap_or(i + 1);
            }
            votes
        })
        .collect()
}

/// Returns how many words of the prompt name a building or a room in a language, by the words of all domains.
pub(crate) fn words_known(tokens: &[Token], registry: &Registry, language: &str) -> usize {
    let domains: Vec<&Domain> = registry.iter().map(|p| p.domain()).collect();
    let spoken: Vec<&Spoken> = words().languages.get(language).into_iter().collect();
    let buildings = occurrences(tokens, registry, &domains, &[language], &spoken, &[], &[]);
    let rooms: Vec<_> = domains.iter().flat_map(|d| room_words(d, registry, &[language])).collect();
    let mut known = vec![false; tokens.len()];
    buildings.iter().for_each(|(span, _)| known[span.start..span.end].fill(true));
    for i in 0..tokens.len() {
        let end = rooms.iter().filter_map(|r| r.longest_at(tokens, i)).map(|f| f.0).max();
        known[i..end.unwrap_or(i)].fill(true);
    }
    known.into_iter().filter(|k| *k).count()
}

/// Returns the words for a domain's rooms, one table a language.
fn room_words(domain: &Domain, registry: &Registry, languages: &[&str]) -> Vec<Arc<Phrases<()>>> {
    let words = |l: &str| {
        let mut phrases = Phrases::new(l);
        for room in &domain.room_types {
            room.keywords.get(l).into_iter().flatten().for_each(|p| phrases.insert(p, ()));
        }
        phrases
    };
    languages.iter().map(|l| registry.digest(&format!("{l}: {}", domain.id), || words(l))).collect()
}
