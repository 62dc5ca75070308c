//! One room asked for by itself: "a bathroom", "just one meeting room", "classroom for 30 pupils".

use super::building::Building;
use crate::named::mention::{Mention, What};
use crate::named::mentions::Vocabulary;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_ends_at};
use crate::wished::wishes::Wishes;

/// Words before a room that a building's word is the end of, at most: "a private office".
const MOST_BEFORE: usize = 3;
/// People from whose number on no room of that kind holds them.
const MANY_PEOPLE: f64 = 5.0;

/// Takes a word for a building that is the end of a word for a room for that room, where the prompt names nothing else: "a
/// private office"; and words for people for no building.
pub(crate) fn unname(
    building: &mut Building,
    tokens: &[Token],
    vocabulary: &Vocabulary,
    numbers: &[Number],
    spoken: &[&Spoken],
) {
    let Some(head) = building.head.filter(|_| building.parts.is_empty()) else { return };
    // "Klassenzimmer für 30 Schüler": pupils are no school
    let tagged = |tag| tag_ends_at(spoken, tokens, head.start, tag, head.end);
    let rooms = || (0..head.start).any(|i| vocabulary.names_room(tokens, i, numbers, spoken));
    if tagged(Tag::Visitors) && rooms() {
        building.head = None;
        building.list_from = 0;
        return;
    }
    // "cellular office with 14 rooms" is a building
    let total = |n: &Number| is_tagged(spoken, tokens, n.span.end, Tag::Total);
    // and so is "private office for 20 people"
    let held = [Tag::People, Tag::Staff, Tag::Desks];
    let people = |n: &Number| held.iter().any(|t| is_tagged(spoken, tokens, n.span.end, *t));
    if numbers.iter().any(|n| n.value > 1.0 && total(n) || n.value >= MANY_PEOPLE && people(n)) {
        return;
    }
    let own = |start: usize| vocabulary.own_at(tokens, Span { start, end: head.end });
    let from = (head.start.saturating_sub(MOST_BEFORE)..head.start).find(|&i| own(i).is_some());
    let same = building.building_type.is_none() && own(head.start).is_some();
    let Some(start) = from.or(same.then_some(head.start)) else { return };
    let here = Span { start, end: head.end };
    let others =
        (0..tokens.len()).filter(|i| !here.contains(*i)).any(|i| vocabulary.names_room(tokens, i, numbers, spoken));
    let several = tokens[head.end - 1].text.ends_with('s') && !tokens[head.end - 1].text.ends_with("ss");
    let counted = numbers.iter().any(|n| n.span.end == start && n.value > 1.0);
    if !others && !several && !counted {
        building.head = None;
        building.list_from = 0;
    }
}

/// Returns true when the prompt names one room, and neither a building nor anything else that has rooms.
pub(crate) fn is_single(building: &Building, mentions: &[Mention], wishes: &Wishes) -> bool {
    let rooms: Vec<&Mention> = mentions.iter().filter(|m| m.room_type().is_some()).collect();
    let [room] = rooms.as_slice() else { return false };
    let one = match room.count {
        Some(n) => n == 1,
        None => !room.plural && !room.definite,
    };
    let totals = mentions.iter().any(|m| m.what == What::Total && m.count.is_none_or(|n| n != 1));
    let wished = wishes.wishes.len() == 1 && wishes.wishes[0].count == 1;
    let plain = wishes.forbidden.is_empty() && wishes.per_host.is_empty();
    building.head.is_none() && building.parts.is_empty() && one && !totals && wished && plain
}
