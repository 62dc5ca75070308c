//! What the prompt asks for and no plan can follow: directions, speeds, lengths, counts of doors, things that no domain
//! knows. It is left out, and said: nothing is dropped in silence.

use d3dgen_model::scene_graph::Note;

use crate::machines::robots::Prompt;
use crate::named::mention::{Mention, What};
use crate::subject::building::Part;
use crate::tokens::measures::Area;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, tag_end, words};

/// Words behind a measure that say what it is of, at most: "1.2 m wide doors".
const MOST_AFTER: usize = 3;
/// Words of an item of a list that nobody reads, at most; longer ones are sentences.
const MOST_IN_ITEM: usize = 4;
/// Notes of one prompt, at most.
const MOST_NOTES: usize = 20;
/// Letters of a word that can be a thing, at least.
const LEAST_LETTERS: usize = 4;
/// Largest number that counts things that somebody wishes for; larger ones are years and prices.
const MOST_COUNTED: f64 = 500.0;

/// What the others have read.
pub(crate) struct Text<'a> {
    pub tokens: &'a [Token],
    /// True when the prompt is in a language that is read.
    pub known_language: bool,
    /// "Two entrances", by `doors`.
    pub doors: &'a [Span],
    pub prompt: &'a str,
    pub numbers: &'a [Number],
    pub mentions: &'a [Mention],
    pub spoken: &'a [&'a Spoken],
    pub areas: &'a [Area],
    /// Places, areas, storeys, robots, styles, objects, the name of the building.
    pub taken: &'a [Span],
    /// First token of the list of rooms.
    pub list_from: usize,
    /// Departments that were planned.
    pub planned: &'a [Span],
    /// Departments that were not.
    pub parts: &'a [Part],
}

impl Text<'_> {
    fn tagged(&self, i: usize, tag: Tag) -> Option<usize> {
        tag_end(self.spoken, self.tokens, i, tag)
    }

    fn is_taken(&self, i: usize) -> bool {
        self.taken.iter().any(|s| s.contains(i))
    }
}

/// Words of a prompt that nothing was made of, and what was said of them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unread {
    /// Where they stand in the prompt.
    pub bytes: std::ops::Range<usize>,
    pub note: Note,
}

/// Adds a conflict for every wish that is left out; returns those of which nothing at all was planned.
pub(crate) fn state(text: &Text, conflicts: &mut Vec<Note>) -> Vec<Unread> {
    let prompt = Prompt { text: text.prompt, tokens: text.tokens };
    let mut spans: Vec<Span> = Vec::new();
    let put = |span: Span, spans: &mut Vec<Span>| {
        if !spans.iter().any(|s| s.overlaps(span)) {
            spans.push(span);
        }
    };
    measures(text).into_iter().for_each(|s| put(s, &mut spans));
    phrases(text).into_iter().for_each(|s| put(s, &mut spans));
    text.doors.iter().for_each(|s| put(*s, &mut spans));
    text.parts.iter().for_each(|p| put(p.span, &mut spans));
    if text.known_language {
        items(text, &spans).into_iter().for_each(|s| put(s, &mut spans));
        counted(text).into_iter().for_each(|s| put(s, &mut spans));
    }
    spans.sort_by_key(|s| s.start);
    let mut left = Vec::new();
    for span in spans.into_iter().take(MOST_NOTES) {
        let message = format!("`{}` is nothing that can be planned; it was left out", prompt.words(span));
        let note = Note::new("unread_wish", message);
        let (first, last) = (&text.tokens[span.start], &text.tokens[span.end - 1]);
        left.push(Unread { bytes: first.start..last.end, note: note.clone() });
        conflicts.push(note);
    }
    for area in text.areas.iter().filter(|a| a.sides).take(MOST_NOTES) {
        let (words, value) = (prompt.words(area.span), area.value);
        let message = format!("of `{words}` the area was taken ({value:.1} m2); the two lengths are not planned");
        let note = Note::new("unread_wish", message);
        let (first, last) = (&text.tokens[area.span.start], &text.tokens[area.span.end - 1]);
        left.push(Unread { bytes: first.start..last.end, note: note.clone() });
        conflicts.push(note);
    }
    left
}

/// Returns the words of a prompt without a word for a building that could be one.
pub(crate) fn nouns<'t>(tokens: &'t [Token], numbers: &[Number], spoken: &[&Spoken], taken: &[Span]) -> Vec<&'t Token> {
    let free = |i: usize| !taken.iter().chain(numbers.iter().map(|n| &n.span)).any(|s| s.contains(i));
    let tagged = |i: usize| spoken.iter().any(|s| s.tags.longest_at(tokens, i).is_some());
    let noun = |&(i, t): &(usize, &Token)| {
        t.kind == Kind::Word && t.text.chars().count() >= LEAST_LETTERS && free(i) && !tagged(i)
    };
    tokens.iter().enumerate().filter(noun).map(|f| f.1).take(MOST_IN_ITEM).collect()
}

/// Takes numbers of hours, kilograms and the like for what they are: a "24-hour ATM area" is one.
pub(crate) fn uncount_measures(tokens: &[Token], mentions: &mut [Mention], spoken: &[&Spoken]) {
    for mention in mentions {
        let measured = |number: &Span| {
            let at =
                if tokens.get(number.end).is_some_and(|t| t.mark() == Some('-')) { number.end + 1 } else { number.end };
            spoken.iter().any(|s| s.tag_at(tokens, at, Tag::UnreadUnits).is_some_and(|end| end <= mention.span.start))
        };
        if mention.number.as_ref().is_some_and(measured) {
            (mention.count, mention.number, mention.from) = (None, None, mention.span.start);
        }
    }
}

/// Lengths, speeds, weights and the like that nobody has read.
fn measures(text: &Text) -> Vec<Span> {
    let tokens = text.tokens;
    let mut out = Vec::new();
    for number in text.numbers.iter().filter(|n| !n.article) {
        let at = number.span.end;
        let length = words().length_units.longest_at(tokens, at).map(|f| f.0).filter(|_| is_unit(tokens, at));
        let Some(mut end) = text.tagged(at, Tag::UnreadUnits).or(length) else { continue };
        if text.is_taken(number.span.start) {
            continue;
        }
        // "0.5 m/s", "5 km/h"
        let rate =
            tokens.get(end).filter(|t| t.mark() == Some('/')).and_then(|_| text.tagged(end + 1, Tag::UnreadRates));
        let per = text.tagged(end, Tag::Each).and_then(|each| text.tagged(each, Tag::UnreadRates));
        end = rate.or(per).unwrap_or(end);
        out.push(Span { start: number.span.start, end: tail(text, end) });
    }
    out
}

/// Returns false for "two in the north": there the unit is a little word.
fn is_unit(tokens: &[Token], at: usize) -> bool {
    tokens.get(at).is_some_and(|t| t.text != "in") || tokens.get(at + 1).is_none_or(Token::is_mark)
}

/// Returns the end of what a measure is of: "wide doors".
fn tail(text: &Text, end: usize) -> usize {
    let parts = [Tag::Stops, Tag::Starts, Tag::Joins, Tag::No, Tag::Near];
    let plain = |i: &usize| {
        let token = &text.tokens[*i];
        let mention = text.mentions.iter().any(|m| m.from <= *i && *i < m.span.end && m.room_type().is_some());
        token.kind == Kind::Word
            && !text.is_taken(*i)
            && !mention
            && !parts.iter().any(|&t| text.tagged(*i, t).is_some())
    };
    (end..text.tokens.len().min(end + MOST_AFTER)).take_while(plain).last().map_or(end, |i| i + 1)
}

/// Phrases such as "facing south", and "two windows".
fn phrases(text: &Text) -> Vec<Span> {
    let mut out: Vec<Span> = Vec::new();
    for i in 0..text.tokens.len() {
        let counted = text.numbers.iter().find(|n| n.span.start == i && !n.article);
        let things = counted.and_then(|n| Some((n.span.start, text.tagged(n.span.end, Tag::UnreadThings)?)));
        let things = things.filter(|(_, end)| !text.mentions.iter().any(|m| m.span.start < *end && i < m.span.end));
        let unread = text.tagged(i, Tag::Unread).map(|end| (i, end)).or(things);
        if let Some((start, end)) = unread.filter(|_| !text.is_taken(i)) {
            out.push(Span { start, end });
        }
    }
    out
}

/// Takes "two entrances" for one: a plan has one, and the exits that rules ask for. Returns where they are named.
pub(crate) fn doors(tokens: &[Token], mentions: &mut [Mention], spoken: &[&Spoken]) -> Vec<Span> {
    let end = |m: &Mention| tag_end(spoken, tokens, m.span.start, Tag::UnreadThings);
    let mut out = Vec::new();
    // "four gates" of an airport have been read as its lounges, and have no number of their own here
    for m in mentions.iter_mut().filter(|m| m.number.is_some() && m.count.is_some_and(|n| n > 1) && !m.article) {
        if (m.what == What::Entrance || m.room_type().is_some()) && end(m) == Some(m.span.end) {
            out.push(Span { start: m.from, end: m.span.end });
            m.count = Some(1);
            m.article = true;
        }
    }
    out
}

/// Things that the prompt counts and nobody has read: "3 appliance bays", "two dance floors".
fn counted(text: &Text) -> Vec<Span> {
    let tokens = text.tokens;
    let mentioned = |i: usize| text.mentions.iter().any(|m| m.from <= i && i < m.span.end);
    let of_mention = |n: &Number| text.mentions.iter().any(|m| m.number == Some(n.span));
    let free = |i: usize| !text.is_taken(i) && !mentioned(i) && !text.planned.iter().any(|s| s.contains(i));
    let parts = [Tag::Stops, Tag::Starts, Tag::Joins, Tag::No, Tag::Near, Tag::Each, Tag::PlaceBefore, Tag::Inside];
    let plain = |i: &usize| {
        let word = tokens[*i].kind == Kind::Word && !text.numbers.iter().any(|n| n.span.contains(*i));
        word && free(*i) && !parts.iter().any(|&t| text.tagged(*i, t).is_some())
    };
    let several = |n: &&Number| n.value >= 2.0 && n.value.fract() == 0.0 && n.value <= MOST_COUNTED;
    let mut out = Vec::new();
    for n in text.numbers.iter().filter(several).filter(|n| !n.article && !n.vague && !of_mention(n)) {
        let end = (n.span.end..tokens.len().min(n.span.end + MOST_IN_ITEM)).take_while(plain).last().map(|i| i + 1);
        let Some(end) = end.filter(|_| free(n.span.start)) else { continue };
        // "24 hours", "two of them": no word of it is a thing; "2 bedroom" of another room is read on
        let thing = (n.span.end..end).any(|i| is_thing(text, i));
        let closed = tokens.get(end).is_none_or(|t| t.kind != Kind::Word) || free(end);
        if thing && closed {
            out.push(Span { start: n.span.start, end });
        }
    }
    out
}

/// Returns true for a word that nothing knows and that could be a thing.
fn is_thing(text: &Text, i: usize) -> bool {
    let token = &text.tokens[i];
    let unknown = text.spoken.iter().all(|s| s.tags.longest_at(text.tokens, i).is_none());
    let number = text.numbers.iter().any(|n| n.span.contains(i));
    let letters = token.text.chars().count();
    // "NOC"
    let name = letters + 1 >= LEAST_LETTERS
        && text.prompt.get(token.start..token.end).is_some_and(|word| word.chars().all(char::is_uppercase));
    token.kind == Kind::Word && (letters >= LEAST_LETTERS || name) && unknown && !number
}

/// Items of the list of rooms of which no word says anything to anybody: "a swimming pool", "helipad".
fn items(text: &Text, known: &[Span]) -> Vec<Span> {
    let tokens = text.tokens;
    let parts =
        |i: usize| tokens[i].is_mark() || [Tag::Starts, Tag::Joins].iter().any(|&tag| text.tagged(i, tag).is_some());
    let mut out = Vec::new();
    let mut start = text.list_from;
    while start < tokens.len() {
        let end = (start..tokens.len()).find(|&i| parts(i)).unwrap_or(tokens.len());
        let item = Span { start, end };
        start = end + 1;
        if end > item.start && end - item.start <= MOST_IN_ITEM && is_unread(text, item, known) {
            out.push(item);
        }
    }
    out
}

/// Returns true when no word of an item has been read, and one of them could be a thing.
fn is_unread(text: &Text, item: Span, known: &[Span]) -> bool {
    let read = |s: &Span| s.overlaps(item);
    let mentioned = text.mentions.iter().any(|m| Span { start: m.from, end: m.span.end }.overlaps(item));
    if mentioned || text.taken.iter().chain(known).chain(text.planned).any(read) {
        return false;
    }
    // words that say whose or what kind of a thing it is: "large helipad"
    let little = [Tag::Articles, Tag::Definite, Tag::Own, Tag::Both, Tag::Measure, Tag::NotNames];
    let word = |i: usize| {
        let tags = text.spoken.iter().filter_map(|s| s.tags.longest_at(text.tokens, i)).flat_map(|f| f.1);
        // what tells the language says nothing of the thing: "a helipad"
        let all: Vec<&Tag> = tags.filter(|t| **t != Tag::Detect).collect();
        let number = text.numbers.iter().any(|n| n.span.contains(i));
        (number || !all.is_empty() && all.iter().all(|t| little.contains(t)), all.is_empty() && !number)
    };
    let plain: Vec<(bool, bool)> = (item.start..item.end).map(word).collect();
    plain.iter().all(|w| w.0 || w.1) && (item.start..item.end).any(|i| is_thing(text, i))
}
