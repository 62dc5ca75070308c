//! Rooms with numbers of their own: "bedroom 1, bedroom 2", "bedrooms 1 to 4", "office A and office B". Such a number says
//! which room is meant, and not how many there are.

use d3dgen_model::scene_graph::GraphRoom;

use crate::named::mention::{Mention, Numbered, What};
use crate::tokens::numbers::{self, Number};
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, tag_end};

/// Largest number of a room that is one of several; larger ones name doors ("office 204").
const MOST: f64 = 99.0;
/// Largest number that a room alone of its kind tells that there are so many of: "next to bedroom 3".
const MOST_ALONE: u32 = 9;

/// What may stand behind a room with its number: the sentence goes on, and nothing there is counted.
const GOES_ON: [Tag; 15] = [
    Tag::Joins,
    Tag::Stops,
    Tag::Starts,
    Tag::Near,
    Tag::Door,
    Tag::Open,
    Tag::Together,
    Tag::Between,
    Tag::Around,
    Tag::Apart,
    Tag::Not,
    Tag::No,
    Tag::Each,
    Tag::Both,
    Tag::Range,
];

struct Reader<'a> {
    tokens: &'a [Token],
    numbers: &'a [Number],
    spoken: &'a [&'a Spoken],
}

/// Gives rooms the numbers behind them; "bedrooms 1, 2 and 3" becomes three mentions. In languages whose numbers stand behind
/// what they count (`counts_behind`), only rooms of one type with different numbers have such.
pub(crate) fn read(
    tokens: &[Token],
    numbers: &[Number],
    spoken: &[&Spoken],
    counts_behind: bool,
    mentions: &mut Vec<Mention>,
) {
    let reader = Reader { tokens, numbers, spoken };
    let found: Vec<Vec<Numbered>> =
        mentions.iter().map(|m| if m.room_type().is_some() { reader.numbers_behind(m) } else { Vec::new() }).collect();
    let same = |m: usize, o: usize| mentions[o].what == mentions[m].what && found[o] != found[m];
    let meant = |m: usize| {
        let others = || (0..mentions.len()).any(|o| !found[o].is_empty() && same(m, o));
        // "bedrooms 3, bathrooms 2" are counts
        let counts = mentions[m].plural && found[m].len() == 1;
        !found[m].is_empty() && !counts && (!counts_behind || found[m].len() > 1 || others())
    };
    let mut out = Vec::with_capacity(mentions.len());
    for (m, mention) in mentions.iter().enumerate() {
        let Some((first, rest)) = found[m].split_first().filter(|_| meant(m)) else {
            out.push(mention.clone());
            continue;
        };
        out.push(Mention { numbered: Some(*first), plural: false, ..mention.clone() });
        out.extend(rest.iter().map(|number| Mention {
            numbered: Some(*number),
            beds: mention.beds,
            places: mention.places,
            ..Mention::plain(number.span, mention.what.clone())
        }));
    }
    for m in out.iter_mut().filter(|m| m.room_type().is_some() || m.what == What::Total) {
        if let Some((count, doors)) = reader.doors_behind(m) {
            (m.count, m.number) = (Some(count), Some(doors));
        }
    }
    *mentions = out;
}

impl Reader<'_> {
    fn tagged(&self, i: usize, tag: Tag) -> Option<usize> {
        tag_end(self.spoken, self.tokens, i, tag)
    }

    /// Returns the numbers behind a room: one, a list of them, or all from the first to the last.
    fn numbers_behind(&self, room: &Mention) -> Vec<Numbered> {
        let mut out: Vec<Numbered> =
            self.range_at(room.span.end).or_else(|| Some(vec![self.number_at(room.span.end)?])).unwrap_or_default();
        while let Some(last) = out.last().copied() {
            let at = last.span.end;
            let to = self.tagged(at, Tag::Range).and_then(|to| self.number_at(to));
            if let Some(end) = to.filter(|to| to.n > last.n) {
                out.extend((last.n + 1..=end.n).map(|n| Numbered { n, span: end.span }));
                continue;
            }
            let comma = self.tokens.get(at).filter(|t| matches!(t.mark(), Some(',' | '/'))).map(|_| at + 1);
            let parted = comma.or_else(|| self.tagged(at, Tag::Joins)).map(|i| self.tagged(i, Tag::Joins).unwrap_or(i));
            let next = parted.and_then(|i| self.number_at(i));
            let Some(next) = next.filter(|n| n.n == last.n + 1 && self.closes(n.span.end)) else { break };
            out.push(next);
        }
        let closed = out.last().is_some_and(|last| self.closes(last.span.end));
        if closed { out } else { Vec::new() }
    }

    /// Returns the numbers of "1-4", which is one number of things elsewhere.
    fn range_at(&self, i: usize) -> Option<Vec<Numbered>> {
        let number = self.numbers.iter().find(|n| n.span == Span { start: i, end: i + 2 })?;
        let at = |k: usize| if let Kind::Number(value) = self.tokens[k].kind { Some(value as u32) } else { None };
        let (first, last) = (at(i)?, at(i + 1)?);
        let numbered =
            |n: u32| Numbered { n, span: if n == first { Span { end: i + 1, ..number.span } } else { number.span } };
        (1 <= first && first < last && f64::from(last) <= MOST).then(|| (first..=last).map(numbered).collect())
    }

    /// Returns the number or letter of a room at a token.
    fn number_at(&self, i: usize) -> Option<Numbered> {
        let token = self.tokens.get(i)?;
        // "office A", but no article
        let letter =
            token.text.bytes().next().filter(|b| token.capital && token.text.len() == 1 && b.is_ascii_lowercase());
        if let Some(letter) = letter.filter(|_| token.kind == Kind::Word) {
            return Some(Numbered { n: u32::from(letter - b'a') + 1, span: Span { start: i, end: i + 1 } });
        }
        let (value, span) = match token.kind {
            // "bedroom-2"
            Kind::Number(value) if numbers::is_name(self.tokens, i, self.spoken) => {
                (value, Span { start: i, end: i + 1 })
            }
            _ => {
                let number = self.numbers.iter().find(|n| n.span.start == i && !n.article && !n.vague)?;
                (number.value, number.span)
            }
        };
        let whole = (1.0..=MOST).contains(&value) && value.fract() == 0.0;
        whole.then_some(Numbered { n: value as u32, span })
    }

    /// Returns how many rooms the numbers of their doors tell, and where these stand: "rooms 101 to 110".
    fn doors_behind(&self, rooms: &Mention) -> Option<(i64, Span)> {
        let value = |i: usize| match self.tokens.get(i)?.kind {
            Kind::Number(value) => Some(value),
            _ => None,
        };
        let from = rooms.span.end;
        let joint = self.tagged(from + 1, Tag::Range).filter(|end| value(*end).is_some());
        let unspaced = || self.tokens.get(from + 1).filter(|t| !t.spaced).map(|_| from + 1);
        let last = joint.or_else(unspaced)?;
        let (first, to) = (value(from)?, value(last)?);
        let doors = first > MOST && to > first && to - first < MOST && self.closes(last + 1);
        doors.then_some((1 + (to - first) as i64, Span { start: from, end: last + 1 }))
    }

    /// Returns true where nothing follows that a number before it could count.
    fn closes(&self, i: usize) -> bool {
        self.tokens.get(i).is_none_or(Token::is_mark) || GOES_ON.iter().any(|&tag| self.tagged(i, tag).is_some())
    }
}

/// Returns how many rooms of a type there are by the numbers of those that are named, and whether they begin at one; nothing where none has a number.
pub(crate) fn count<'m>(mentions: impl Iterator<Item = &'m Mention>) -> Option<(u32, bool)> {
    let mut all: Vec<u32> = mentions.filter_map(|m| Some(m.numbered?.n)).collect();
    all.sort_unstable();
    all.dedup();
    let (first, last) = (*all.first()?, *all.last()?);
    let named = all.len() as u32;
    // "master bedroom, bedroom 2, bedroom 3": the first has a name of its own
    let told = if named == 1 { last <= MOST_ALONE } else { last <= named + 1 };
    Some((if told { last } else { named }, first == 1))
}

/// Returns true for a room of a type, where a number is given for the one that has it as its own.
pub(crate) fn is_meant(room: &GraphRoom, kind: &str, number: Option<u32>) -> bool {
    room.room_type == kind && number.is_none_or(|n| room.id == format!("{kind}_{n}"))
}
