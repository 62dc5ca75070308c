//! Storeys in a prompt: how many there are, and which rooms are to be on which.

use d3dgen_model::scene_graph::Note;

use super::mentions::{Mention, What};
use super::numbers::Number;
use super::places::note;
use super::text::{Kind, Phrases, Span, Token};
use super::words::{Spoken, Tag, words};

/// Storeys above the ground that a prompt may ask for.
const MOST_LEVELS: u32 = 12;

/// A word for a storey.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Where {
    /// So many storeys above the ground.
    Level(i32),
    /// "First floor": the ground floor or the one above it, by country.
    Nth(i32),
    /// Any but the ground floor.
    Upper,
    /// The highest.
    Top,
    /// Every one.
    Each,
}

impl Where {
    /// Reads `level 1`, `nth 2`, `upper`, `top`, `each` of `words.toml`.
    pub(super) fn of(text: &str) -> Option<Self> {
        let (word, number) = text.split_once(' ').unwrap_or((text, "0"));
        let n: i32 = number.parse().ok()?;
        match word {
            "level" => Some(Self::Level(n)),
            "nth" => Some(Self::Nth(n)),
            "upper" => Some(Self::Upper),
            "top" => Some(Self::Top),
            "each" => Some(Self::Each),
            _ => None,
        }
    }
}

/// A phrase that names a storey.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Phrase {
    pub span: Span,
    pub at: Where,
}

/// Rooms that the prompt wants on a storey.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wanted {
    pub room_type: String,
    pub count: u32,
    pub at: Where,
}

/// What a prompt says of storeys.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Storeys {
    /// Numbers of the storeys from the lowest; `[0]` for a building of one.
    pub levels: Vec<i32>,
    pub wanted: Vec<Wanted>,
    /// True when an elevator is named, false when it is ruled out.
    pub elevator: Option<bool>,
}

/// Returns the phrases that name storeys, in order.
pub(super) fn phrases(tokens: &[Token], spoken: &[&Spoken]) -> Vec<Phrase> {
    let mut out = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        if let Some((end, level)) = numbered(tokens, i, spoken) {
            out.push(Phrase { span: Span { start: i, end }, at: Where::Level(level) });
            i = end;
            continue;
        }
        let found = spoken.iter().filter_map(|s| s.levels.longest_at(tokens, i)).max_by_key(|f| f.0);
        match found {
            Some((end, &at)) => {
                out.push(Phrase { span: Span { start: i, end }, at });
                i = end;
            }
            None => i += 1,
        }
    }
    out
}

/// Returns end and number of "2. OG", "3. Stock": a number with a dot before a word for a storey.
fn numbered(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> Option<(usize, i32)> {
    let Kind::Number(n) = tokens[i].kind else { return None };
    if !(1.0..=f64::from(MOST_LEVELS)).contains(&n) || tokens.get(i + 1)?.mark() != Some('.') || i + 2 >= tokens.len() {
        return None;
    }
    let end = spoken.iter().find_map(|s| {
        let upper = s.levels.longest_at(tokens, i + 2).filter(|f| *f.1 == Where::Upper).map(|f| f.0);
        upper.or_else(|| s.tag_at(tokens, i + 2, Tag::Storeys))
    })?;
    Some((end, n as i32))
}

/// Returns the number of storeys that the prompt states: "two-storey", "auf 3 Etagen", "zweistöckig".
fn stated(tokens: &[Token], numbers: &[Number], spoken: &[&Spoken]) -> Option<f64> {
    let counted = |n: &&Number| {
        !n.article && !n.vague && spoken.iter().any(|s| s.tag_at(tokens, n.span.end, Tag::Storeys).is_some())
    };
    let by_number = numbers.iter().find(counted).map(|n| n.value);
    let by_word = |counts: &Phrases<f64>| (0..tokens.len()).find_map(|i| counts.longest_at(tokens, i).map(|f| *f.1));
    by_number.or_else(|| spoken.iter().find_map(|s| by_word(&s.storey_counts)))
}

/// Returns whether an elevator is asked for or ruled out.
fn elevator(tokens: &[Token], spoken: &[&Spoken]) -> Option<bool> {
    let tagged = |i: usize, tag: Tag| spoken.iter().any(|s| s.tag_at(tokens, i, tag).is_some());
    let at = (0..tokens.len()).find(|&i| tagged(i, Tag::Lift))?;
    Some(!(at.saturating_sub(2)..at).any(|k| tagged(k, Tag::No)))
}

/// Reads what a prompt says of storeys; contradictions become conflicts.
pub(super) fn read(
    tokens: &[Token],
    numbers: &[Number],
    mentions: &[Mention],
    phrases: &[Phrase],
    spoken: &[&Spoken],
    country: Option<&str>,
    conflicts: &mut Vec<Note>,
) -> Storeys {
    let stated = stated(tokens, numbers, spoken);
    if let Some(n) = stated.filter(|n| !(1.0..=f64::from(MOST_LEVELS)).contains(n)) {
        let message = format!("{n} storeys were asked for; one world has 1 to {MOST_LEVELS}");
        conflicts.push(note("impossible_storeys", message));
    }
    let stated = stated.filter(|n| (1.0..=f64::from(MOST_LEVELS)).contains(n)).map(|n| n.floor() as i32);
    let on = attach(tokens, mentions, phrases, spoken);
    let american = counts_from_one(phrases, stated, country);
    let fixed = |at: Where| match at {
        Where::Level(n) => Some(n),
        Where::Nth(n) => Some(if american { n - 1 } else { n }),
        Where::Upper | Where::Top | Where::Each => None,
    };
    // "flat on the third floor" is where the flat is; rooms on a floor are what it is made of
    let used: Vec<Where> = on.iter().map(|o| phrases[o.1].at).collect();
    let mut named: Vec<i32> = used.iter().filter_map(|at| fixed(*at)).collect();
    named.sort_unstable();
    named.dedup();
    let above = used.iter().any(|at| matches!(at, Where::Upper));
    let several = named.len() > 1 || above || named.iter().any(|n| *n < 0);
    let highest = named.last().copied().unwrap_or(0).max(i32::from(above));
    let mut top = match stated {
        Some(n) => n - 1,
        None if several => highest,
        None => 0,
    };
    if stated.is_some() && highest > top {
        let message = format!(
            "{} storeys were asked for, but rooms on {} are named; {} were planned",
            top + 1,
            highest + 1,
            highest + 1
        );
        conflicts.push(note("contradicting_storeys", message));
        top = highest;
    }
    let lowest = named.first().copied().unwrap_or(0).min(0);
    let levels: Vec<i32> = if several || top > 0 { (lowest..=top).collect() } else { vec![0] };
    let mut wanted: Vec<Wanted> = Vec::new();
    for (m, p) in on.into_iter().filter(|_| levels.len() > 1) {
        let mention = &mentions[m];
        let Some(room_type) = mention.room_type() else { continue };
        let count = mention.count.unwrap_or(if mention.plural { 2 } else { 1 }).clamp(0, 500) as u32;
        let at = match phrases[p].at {
            Where::Top => Where::Level(top),
            at => fixed(at).map_or(at, Where::Level),
        };
        wanted.push(Wanted { room_type: room_type.to_owned(), count, at });
    }
    Storeys { levels, wanted, elevator: elevator(tokens, spoken) }
}

/// Returns true where the ground floor is the first floor.
fn counts_from_one(phrases: &[Phrase], stated: Option<i32>, country: Option<&str>) -> bool {
    let ground = phrases.iter().any(|p| p.at == Where::Level(0));
    let nth = || phrases.iter().filter_map(|p| if let Where::Nth(n) = p.at { Some(n) } else { None });
    // the highest storey named tells how they are counted
    if let Some(n) = stated
        && nth().any(|k| k >= n)
    {
        return true;
    }
    match country {
        Some(code) => words().first_is_ground.iter().any(|c| c == code),
        None => !ground,
    }
}

/// Returns which rooms are on which storey, as pairs of a mention and a phrase.
fn attach(tokens: &[Token], mentions: &[Mention], phrases: &[Phrase], spoken: &[&Spoken]) -> Vec<(usize, usize)> {
    let tagged = |i: usize, tags: &[Tag]| spoken.iter().any(|s| tags.iter().any(|&t| s.tag_at(tokens, i, t).is_some()));
    let ends = |i: usize| tokens.get(i).is_none_or(Token::ends_sentence);
    // where the words that lead to a phrase begin: "on the" upper floor
    let lead = |p: &Phrase| {
        let mut at = p.span.start;
        while at > 0 && !tokens[at - 1].is_mark() && tagged(at - 1, &[Tag::Stops, Tag::Definite, Tag::Articles]) {
            let joins = tagged(at - 1, &[Tag::Joins]);
            if joins || mentions.iter().any(|m| m.span.contains(at - 1)) {
                break;
            }
            at -= 1;
        }
        at
    };
    let rooms: Vec<usize> = (0..mentions.len()).filter(|&m| matches!(mentions[m].what, What::Room(_))).collect();
    let mut out: Vec<(usize, usize)> = Vec::new();
    // the phrase before, where it heads a list
    let mut headed: Option<usize> = None;
    for (p, phrase) in phrases.iter().enumerate() {
        let from = lead(phrase);
        let before = |m: &&usize| mentions[**m].span.end == from;
        let follows_room = rooms.iter().any(|m| before(&m));
        let next = tokens.get(phrase.span.end);
        let opens = next.is_some_and(|t| matches!(t.mark(), Some(':' | '(' | '-')))
            || next.is_some() && tagged(phrase.span.end, &[Tag::Starts]);
        let stop = phrases.get(p + 1).map_or(tokens.len(), lead);
        let end = (phrase.span.end..stop).find(|&i| ends(i)).unwrap_or(stop);
        let after: Vec<usize> =
            rooms.iter().copied().filter(|&m| (phrase.span.end..end).contains(&mentions[m].span.start)).collect();
        if opens || !follows_room && !after.is_empty() {
            // "an upstairs bathroom" is one room, "upstairs: a bathroom, ..." a list
            let article = phrase.span.start > 0 && tagged(phrase.span.start - 1, &[Tag::Articles]);
            let adjective =
                article && !opens && after.first().is_some_and(|&m| mentions[m].span.start == phrase.span.end);
            let taken = if adjective { &after[..1] } else { &after[..] };
            out.extend(taken.iter().map(|&m| (m, p)));
            headed = Some(p);
            continue;
        }
        let mut since = p.checked_sub(1).map_or(0, |b| phrases[b].span.end);
        since = (since..from).rev().find(|&i| ends(i) || tokens[i].mark() == Some(':')).map_or(since, |i| i + 1);
        let sentence = (0..phrase.span.start).rev().find(|&i| ends(i)).map_or(0, |i| i + 1);
        let alone =
            phrases.iter().filter(|q| q.span.start >= sentence && !(phrase.span.end..q.span.start).any(ends)).count()
                < 2;
        if alone && let Some(comma) = (since..from).rev().find(|&i| tokens[i].mark() == Some(',')) {
            since = comma;
        }
        // "a ground floor with a kitchen and 3 bedrooms upstairs": the last of a list goes where it says itself
        if let Some(head) = headed.take().filter(|h| p.checked_sub(1) == Some(*h)) {
            let last = rooms.iter().copied().filter(|&m| mentions[m].span.end <= from).max();
            let to = last.map_or(from, |m| mentions[m].from);
            since = (since..to)
                .rev()
                .find(|&i| tokens[i].is_mark() || tagged(i, &[Tag::Joins]) && i + 1 == to)
                .map_or(since.max(to), |i| i + 1);
            out.retain(|(m, q)| *q != head || mentions[*m].span.start < since);
        }
        let taken = rooms.iter().copied().filter(|&m| (since..from).contains(&mentions[m].span.start));
        out.extend(taken.map(|m| (m, p)));
    }
    let mut seen = Vec::new();
    out.retain(|(m, _)| {
        let new = !seen.contains(m);
        seen.push(*m);
        new
    });
    out
}
