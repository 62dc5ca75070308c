//! Short forms of dwellings: "3BHK", "T3", "2LDK", "Dreizimmerwohnung", "三室两厅两卫", "2 bed 2 bath", "투룸".

use std::collections::BTreeMap;

use d3dgen_model::domain::Domain;

use crate::named::mention::Mention;
use crate::named::objects::Thing;
use crate::people::short_form::ShortForm;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Dwelling, Spoken, Tag, tag_end, words};
use crate::wished::wishes::Wishes;

/// Returns the short forms of a prompt; none in domains without the room types of a dwelling.
///
/// In a home that people share each of the rooms to live in is somebody's own (`shared`).
pub(crate) fn short_forms(
    tokens: &[Token],
    numbers: &[Number],
    domain: &Domain,
    spoken: &[&Spoken],
    shared: bool,
) -> Vec<ShortForm> {
    let d = &words().dwelling;
    if [&d.living, &d.bedroom, &d.kitchen].iter().any(|id| domain.room_type(id).is_none()) {
        return Vec::new();
    }
    let mut out: Vec<ShortForm> = Vec::new();
    for i in 0..tokens.len() {
        if out.iter().any(|f| f.span.contains(i)) {
            continue;
        }
        let found = lettered(tokens, i, d)
            .or_else(|| counted(tokens, i, numbers, d, domain, spoken))
            .or_else(|| one_word(tokens, i, d, spoken))
            .or_else(|| chinese(tokens, i, numbers, d));
        let form = |f| if shared { own_rooms(f, d) } else { one_room(f, domain, d) };
        out.extend(found.filter(|f| f.rooms.values().all(|n| (0..=60).contains(n))).map(form));
    }
    out
}

/// Turns a dwelling of one room to live in into one to live and sleep in, where the domain knows such a room.
fn one_room(form: ShortForm, domain: &Domain, d: &Dwelling) -> ShortForm {
    let alone = form.rooms.len() == 1 && form.rooms.get(&d.living) == Some(&1);
    match domain.room_type(&d.studio).filter(|_| alone) {
        Some(kind) => ShortForm { rooms: BTreeMap::from([(kind.id.clone(), 1)]), ..form },
        None => form,
    }
}

/// Turns all rooms to live in into bedrooms: "WG mit 4 Zimmern".
fn own_rooms(form: ShortForm, d: &Dwelling) -> ShortForm {
    let lived_in = form.rooms.iter().filter(|(id, _)| d.live_in.contains(id)).map(|r| r.1).sum::<i64>();
    if !form.rooms.contains_key(&d.living) {
        return form;
    }
    let mut rooms: BTreeMap<String, i64> = form.rooms.into_iter().filter(|(id, _)| !d.live_in.contains(id)).collect();
    rooms.insert(d.bedroom.clone(), lived_in);
    ShortForm { rooms, ..form }
}

fn rooms_to_live(n: f64, d: &Dwelling) -> BTreeMap<String, i64> {
    // Half rooms ("2,5-Zimmer-Wohnung") are niches, not rooms.
    let count = (n.floor() as usize).max(1);
    let mut rooms = BTreeMap::new();
    // beyond those that are told one by one there are as many of the last as are left
    for id in d.live_in.iter().chain(d.live_in.last().into_iter().cycle()).take(count) {
        *rooms.entry(id.clone()).or_default() += 1;
    }
    rooms
}

/// "T3", "F2"
fn lettered(tokens: &[Token], i: usize, d: &Dwelling) -> Option<ShortForm> {
    let token = &tokens[i];
    let digits = token.text.strip_prefix(['t', 'f'])?;
    if !token.capital || digits.is_empty() || digits.len() > 2 {
        return None;
    }
    let n: f64 = digits.parse().ok()?;
    (n >= 1.0).then(|| ShortForm::pooled(Span { start: i, end: i + 1 }, rooms_to_live(n, d)))
}

/// "3 BHK", "2LDK", "3-Zimmer-Wohnung", "3 pièces", "2 bed 1 bath", "2BR/2BA"
fn counted(
    tokens: &[Token],
    i: usize,
    numbers: &[Number],
    d: &Dwelling,
    domain: &Domain,
    spoken: &[&Spoken],
) -> Option<ShortForm> {
    let number = numbers.iter().find(|n| n.span.start == i && !n.vague && n.value > 0.0)?;
    let at = number.span.end;
    let unit = tokens.get(at)?;
    let n = number.value as i64;
    let form = |end: usize, rooms: BTreeMap<String, i64>| Some(ShortForm::of_each(Span { start: i, end }, rooms));
    let to_live = |end: usize| Some(ShortForm::pooled(Span { start: i, end }, rooms_to_live(number.value, d)));
    let with = |others: &[String]| {
        let mut rooms: BTreeMap<String, i64> =
            others.iter().filter(|t| domain.room_type(t).is_some()).map(|t| (t.clone(), 1)).collect();
        rooms.insert(d.bedroom.clone(), n);
        rooms
    };
    match unit.text.as_str() {
        "bhk" => return form(at + 1, with(&d.bhk)),
        "ldk" => return form(at + 1, with(&d.ldk)),
        "dk" if !unit.spaced => return form(at + 1, with(std::slice::from_ref(&d.kitchen))),
        _ => {}
    }
    // "2.5 rooms": only rooms to live in are counted by halves
    let halves = number.value.fract() > 0.0 && matches!(unit.text.as_str(), "room" | "rooms");
    if halves || d.rooms_to_live.contains(&unit.text) {
        return to_live(at + 1);
    }
    let joined = |k: usize| tokens.get(k).is_some_and(|t| !t.is_mark());
    if let Some(end) = tag_end(spoken, tokens, at, Tag::Habitable)
        && !number.article
    {
        return to_live(end);
    }
    // "2 bed flat", "2 bed 2 bath", "3BR": letters or the bare singular; "5 beds" stays with the people
    // "4 beds, 3.5 baths" sleep in bedrooms
    let baths = || {
        let next = numbers.iter().find(|n| n.span.start > at && n.span.start <= at + 2);
        next.is_some_and(|n| tokens.get(n.span.end).is_some_and(|t| d.bath_letters.contains(&t.text)))
    };
    if matches!(unit.text.as_str(), "bed" | "beds") && baths() {
        return form(at + 1, BTreeMap::from([(d.bedroom.clone(), n)]));
    }
    let short = d.bed_letters.contains(&unit.text) && (unit.text != "bed" || joined(at + 1)) && unit.text != "beds";
    if short && tokens.get(at + 1).is_none_or(|t| t.text != "room" && t.text != "rooms") {
        return form(at + 1, BTreeMap::from([(d.bedroom.clone(), n)]));
    }
    let bath = d.bath_letters.contains(&unit.text) && tokens.get(at + 1).is_none_or(|t| !t.text.starts_with("room"));
    bath.then(|| {
        let mut rooms = BTreeMap::from([(d.bathroom.clone(), n)]);
        // a half bath is a toilet
        if number.value.fract() > 0.0 && domain.room_type(&d.toilet).is_some() {
            rooms.insert(d.toilet.clone(), 1);
        }
        rooms.retain(|_, n| *n > 0);
        ShortForm::of_each(Span { start: i, end: at + 1 }, rooms)
    })
}

/// Returns how many people share the home: "couple", "family of five", "fünfköpfige Familie", "family with two kids".
pub(crate) fn household(
    tokens: &[Token],
    numbers: &[Number],
    spoken: &[&Spoken],
    children: Option<u32>,
) -> Option<u32> {
    let number_at = |i: usize| numbers.iter().find(|n| n.span.start == i && !n.article && n.value >= 1.0);
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    let told = (0..tokens.len()).find_map(|i| {
        let behind = tagged(i, Tag::ResidentsBefore).and_then(number_at).map(|n| n.value);
        behind.or_else(|| headed(&tokens[i], spoken))
    });
    if told.is_some() {
        return told.map(|n| n as u32);
    }
    let adults = (0..tokens.len()).find_map(|i| {
        let (end, n) = spoken.iter().find_map(|s| s.households.longest_at(tokens, i))?;
        // "a couple of bedrooms", "ein paar Räume"
        let longer = numbers.iter().any(|m| m.span.contains(i) && m.span.end > end);
        let counts = numbers.iter().any(|m| m.span.contains(i))
            && tokens.get(end).is_some_and(|t| {
                let parts = [Tag::Stops, Tag::Starts, Tag::Joins].iter().any(|&tag| tagged(end, tag).is_some());
                !t.is_mark() && !parts
            });
        (!longer && !counts).then_some(*n)
    });
    let family = (0..tokens.len()).any(|i| tagged(i, Tag::Family).is_some());
    let parents = adults.or((family && children.is_some()).then_some(2.0))?;
    Some(parents as u32 + children.unwrap_or(0))
}

/// Returns the bed of a baby who lives in a home without a room for babies: it stands in the room of the parents.
pub(crate) fn cradle(
    tokens: &[Token],
    mentions: &[Mention],
    wishes: &Wishes,
    (domain, things): (&Domain, &[Thing]),
    spoken: &[&Spoken],
    read: &mut Vec<Span>,
) -> Option<Thing> {
    let d = &words().dwelling;
    let taken = |i: usize| {
        mentions.iter().any(|m| m.room_type().is_some() && m.span.contains(i)) || read.iter().any(|s| s.contains(i))
    };
    let found = (0..tokens.len()).filter(|&i| !taken(i)).find_map(|i| {
        let end = tag_end(spoken, tokens, i, Tag::Babies)?;
        Some(Span { start: i, end })
    });
    let span = found.filter(|_| domain.object(&d.baby_bed).is_some())?;
    read.push(span);
    let has = wishes.wishes.iter().any(|w| w.room_type == d.baby_room) || things.iter().any(|t| t.object == d.baby_bed);
    (!has).then(|| Thing::of_one(&d.baby_bed, Some(d.bedroom.clone())))
}

/// Reads the number of "fünfköpfig", "vierköpfige".
fn headed(token: &Token, spoken: &[&Spoken]) -> Option<f64> {
    let at = token.text.find("kopfig").filter(|&at| at > 0)?;
    spoken.iter().find_map(|s| crate::tokens::numbers::in_one_word(&token.text[..at], s))
}

/// "Dreizimmerwohnung", "투룸"
fn one_word(tokens: &[Token], i: usize, d: &Dwelling, spoken: &[&Spoken]) -> Option<ShortForm> {
    let token = &tokens[i];
    if token.kind == Kind::Hangul {
        let text: String = tokens[i..].iter().take(2).map(|t| t.text.as_str()).collect();
        let n = *d.bedroom_words.get(&text)? as i64;
        let rooms = BTreeMap::from([(d.bedroom.clone(), n)]);
        return Some(ShortForm::of_each(Span { start: i, end: i + 2 }, rooms));
    }
    let head = d.rooms_to_live.iter().find_map(|w| {
        let plural = token.text.strip_suffix('n').unwrap_or(&token.text);
        token.text.strip_suffix(w.as_str()).or_else(|| plural.strip_suffix(w.as_str()))
    })?;
    let n = spoken.iter().find_map(|s| s.numbers.get(head)).copied()?;
    Some(ShortForm::pooled(Span { start: i, end: i + 1 }, rooms_to_live(n, d)))
}

/// "三室两厅两卫", "3室1厅", "两房一厅一厨一卫"
fn chinese(tokens: &[Token], i: usize, numbers: &[Number], d: &Dwelling) -> Option<ShortForm> {
    let mut rooms: BTreeMap<String, i64> = BTreeMap::new();
    let mut end = i;
    let mut units = 0;
    let mut sleeps = false;
    while let Some(number) = numbers.iter().find(|n| n.span.start == end && n.value >= 0.0) {
        let at = number.span.end;
        let mut unit = None;
        for len in [2, 1] {
            let Some(part) = tokens.get(at..at + len) else { continue };
            let text: String = part.iter().map(|t| t.text.as_str()).collect();
            if let Some(room) = d.zh_units.get(&text) {
                unit = Some((len, text, room));
                break;
            }
        }
        let Some((len, text, room)) = unit else { break };
        let n = number.value as i64;
        // "三室的房子", but not "三房间"
        sleeps = units == 0 && room == &d.bedroom && tokens.get(at + len).is_none_or(|t| t.text != "间");
        if text == "厅" && n > 1 {
            *rooms.entry(d.living.clone()).or_default() += n - 1;
            *rooms.entry(d.dining.clone()).or_default() += 1;
        } else {
            *rooms.entry(room.clone()).or_default() += n;
        }
        units += 1;
        end = at + len;
        if end >= tokens.len() {
            break;
        }
    }
    (units >= 2 || sleeps).then(|| ShortForm::of_each(Span { start: i, end }, rooms))
}
