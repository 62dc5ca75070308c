//! What a home takes for granted that the words of a prompt do not say one by one: a bathroom behind a bedroom is none for
//! the others, a flat of so many rooms counts those that are listed, a studio is one room, and who lives there has a bed.

use d3dgen_model::domain::{Domain, Program, Zone};
use d3dgen_model::offer::sleeps;
use d3dgen_model::scene_graph::{GraphRoom, Note};
use d3dgen_plugins::Registry;

use crate::built::planned::Planned;
use crate::named::mention::{Mention, What};
use crate::named::objects::{self, Thing};
use crate::named::qualities::Nook;
use crate::people::short_form::ShortForm;
use crate::reading::Reading;
use crate::subject::programs::is_dwelling;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end, tag_ends_at, words};
use crate::wished::relations::Said;
use crate::wished::wishes::{Wish, Wishes};

/// Words between a thing and those that it is for, at most: "table for the".
const MOST_TO_SEATED: usize = 3;

fn night(domain: &Domain, m: &Mention) -> bool {
    m.room_type().and_then(|id| domain.room_type(id)).is_some_and(|k| k.zone == Zone::Night)
}

/// Lets no bathroom that is called shared belong to a bedroom: "two bedrooms with a shared bathroom" have one.
pub(crate) fn share_bathrooms(
    tokens: &[Token],
    mentions: &[Mention],
    domain: &Domain,
    spoken: &[&Spoken],
    said: &mut Said,
) {
    let tagged = |i: usize| tag_end(spoken, tokens, i, Tag::SharedWords);
    let shared = |m: usize| {
        let wet = mentions[m].room_type().and_then(|id| domain.room_type(id)).is_some_and(|k| k.wet);
        let span = mentions[m].span;
        let before = span.start.checked_sub(1).and_then(tagged) == Some(span.start);
        wet && (before || span.end < tokens.len() && tagged(span.end).is_some())
    };
    said.relations.retain(|r| !(r.belongs && shared(r.subject)));
    said.each.retain(|e| !shared(e.0));
}

/// Tells the bathrooms that belong to a bedroom from those for all, where a prompt names both: "a bedroom with its own
/// bathroom, two bedrooms, a bathroom". Of "two bathrooms, the main bedroom has its own" one is meant.
pub(crate) fn name_ensuites(mentions: &mut [Mention], said: &Said, domain: &Domain) {
    let d = &words().dwelling;
    let Some(ensuite) = domain.room_type(&d.ensuite) else { return };
    let hosts = |m: usize| mentions[m].room_type().is_some_and(|id| ensuite.hosts.iter().any(|h| h == id));
    let bath = |m: usize| mentions[m].room_type() == Some(&d.bathroom) && !said.negated.contains(&m);
    let host = |m: usize| {
        let told = said.relations.iter().find(|r| r.belongs && r.subject == m && hosts(r.object)).map(|r| r.object);
        told.or_else(|| said.each.iter().find(|e| e.0 == m && hosts(e.1)).map(|e| e.1))
    };
    let baths: Vec<usize> = (0..mentions.len()).filter(|&m| bath(m)).collect();
    let own: Vec<(usize, usize)> = baths.iter().filter_map(|&m| Some((m, host(m)?))).collect();
    let shared: Vec<usize> = baths.into_iter().filter(|&m| host(m).is_none()).collect();
    if own.is_empty() || shared.is_empty() {
        return;
    }
    for (m, host) in own {
        // "the main bedroom": one of those that the prompt has counted, so that its bathroom is too
        let again = mentions[host].definite && mentions[m].count.is_none_or(|n| n == 1);
        let counted = shared.iter().copied().find(|&s| s < m && mentions[s].count.is_some_and(|n| n > 1));
        if let Some(all) = counted.filter(|_| again) {
            mentions[all].count = mentions[all].count.map(|n| n - 1);
        }
        mentions[m].what = What::Room(d.ensuite.clone());
    }
}

/// Takes the rooms to live in that a prompt lists from the number of those that a short form counts: "Dreizimmerwohnung mit
/// Wohnzimmer, Schlafzimmer und Kinderzimmer" has one bedroom.
pub(crate) fn count_listed(forms: &mut [ShortForm], mentions: &[Mention], domain: &Domain) {
    let d = &words().dwelling;
    let of = |test: &dyn Fn(&str) -> bool| -> i64 {
        let named = mentions.iter().filter(|m| m.room_type().is_some_and(test));
        named.map(|m| m.count.unwrap_or(if m.plural { 2 } else { 1 }).max(0)).sum()
    };
    let lived_in = |id: &str| {
        let kind = domain.room_type(id);
        kind.is_some_and(|k| k.spaces.iter().any(|s| s == "habitable_room")) && id != d.living_kitchen
    };
    let others = of(&|id| lived_in(id) && ![&d.living, &d.bedroom, &d.dining, &d.studio].iter().any(|t| *t == id));
    let (bedrooms, dining) = (of(&|id| id == d.bedroom), of(&|id| id == d.dining));
    for form in forms.iter_mut().filter(|f| f.pooled && f.rooms.contains_key(&d.living)) {
        let total: i64 = form.rooms.values().sum();
        let Some(own) = form.rooms.get_mut(&d.bedroom) else { continue };
        // where one eats counts where the list is whole with it
        let dines = if bedrooms > 0 && 1 + bedrooms + others + dining == total { dining } else { 0 };
        *own = (*own - others - dines).max(bedrooms.min(*own)).max(1);
    }
}

/// Returns true for a home whose program begins with the one room that it is.
fn is_studio(program: &Program) -> bool {
    program.rooms.first().is_some_and(|e| e.room_type == words().dwelling.studio)
}

/// Makes one room of what a studio is said to be made of: "sleeping area, living area". In other homes a place to sleep is a
/// bedroom where the prompt names no other. Returns the words that name no room of their own.
pub(crate) fn sleep_where_one_lives(
    tokens: &[Token],
    mentions: &mut Vec<Mention>,
    (domain, program): (&Domain, &Program),
    spoken: &[&Spoken],
) -> Vec<Span> {
    let d = &words().dwelling;
    let place = |m: &Mention| tag_ends_at(spoken, tokens, m.span.start, Tag::SleepingPlaces, m.span.end);
    let mut told = Vec::new();
    if !is_studio(program) {
        let sleeps = mentions.iter().any(|m| night(domain, m) && !place(m));
        mentions.retain(|m| {
            let spare = sleeps && place(m);
            told.extend(spare.then_some(m.span));
            !spare
        });
        return told;
    }
    let corner = |m: &Mention| is_tagged(spoken, tokens, m.span.start, Tag::Corners);
    let mut has = false;
    mentions.retain_mut(|m| {
        let Some(id) = m.room_type() else { return true };
        let (lives, cooks) = (id == d.living || id == d.studio || place(m), id == d.kitchen && corner(m));
        if cooks || lives && has {
            told.push(m.span);
            return false;
        }
        if lives && m.count.is_none_or(|n| n == 1) {
            has = true;
            m.what = What::Room(d.studio.clone());
        }
        true
    });
    told
}

/// Wishes for the room that a studio is, where a list takes it for granted.
pub(crate) fn add_studio(wishes: &mut Wishes, program: &Program, domain: &Domain) {
    let d = &words().dwelling;
    let lived_in = |w: &Wish| [&d.studio, &d.living, &d.living_kitchen].contains(&&w.room_type);
    let kind = domain.room_type(&d.studio).filter(|k| !wishes.forbidden.contains(&k.id));
    let Some(kind) = kind.filter(|_| is_studio(program) && !wishes.wishes.is_empty()) else { return };
    if !wishes.wishes.iter().any(lived_in) {
        wishes.wishes.insert(0, Wish::one(&kind.id, &kind.label.to_lowercase()));
    }
}

/// Wishes for the entrance hall that things are to stand in: "un armario grande en la entrada".
pub(crate) fn furnish_entrance(things: &[Thing], wishes: &mut Wishes, domain: &Domain) {
    for id in &domain.circulation.entrance_room_types {
        let here = |t: &Thing| t.room_type.as_ref() == Some(id) && domain.anchor(&t.object).is_some();
        let settled = wishes.forbidden.contains(id) || wishes.wishes.iter().any(|w| &w.room_type == id);
        if !settled && things.iter().any(here) {
            wishes.wishes.push(Wish::one(id, &domain.room_type_or_generic(id).label.to_lowercase()));
        }
    }
}

/// Returns the room that a place is said to be in: "living room with a desk corner", "coin bureau du séjour".
pub(crate) fn room_of_nook<'n>(
    tokens: &[Token],
    mentions: &[Mention],
    nook: &'n Nook,
    spoken: &[&Spoken],
) -> Option<&'n String> {
    let own = |m: &Mention| nook.room_types.iter().find(|id| m.room_type() == Some(id));
    let tagged = |i: usize, tags: &[Tag]| tags.iter().any(|&t| is_tagged(spoken, tokens, i, t));
    let little = [Tag::Inside, Tag::Stops, Tag::Definite, Tag::Articles];
    let behind = mentions.iter().find(|m| m.span.start >= nook.span.end).filter(|m| {
        let mut gap = nook.span.end..m.from.min(m.span.start);
        !gap.is_empty() && gap.all(|i| !tokens[i].is_mark() && tagged(i, &little) && !tagged(i, &[Tag::Joins]))
    });
    let before = mentions.iter().rev().find(|m| m.span.end <= nook.span.start).filter(|m| {
        let mut gap = m.span.end..nook.span.start;
        !gap.clone().any(|i| tokens[i].is_mark()) && gap.any(|i| tagged(i, &[Tag::Starts]))
    });
    behind.and_then(own).or_else(|| before.and_then(own))
}

/// Counts a toilet for the half of "two and a half bathrooms", "dos baños y medio".
pub(crate) fn halve_bathrooms(
    (tokens, spoken): (&[Token], &[&Spoken]),
    numbers: &[Number],
    mentions: &mut Vec<Mention>,
    domain: &Domain,
) {
    let d = &words().dwelling;
    let half = |m: &Mention| {
        let of_number = |span: Span| numbers.iter().any(|n| n.span == span && n.value.fract() == 0.5);
        m.number.is_some_and(|span| of_number(span) || is_tagged(spoken, tokens, m.span.end, Tag::Halves))
    };
    for at in (0..mentions.len()).rev() {
        let bathroom = mentions[at].room_type() == Some(&d.bathroom) && domain.room_type(&d.toilet).is_some();
        if bathroom && half(&mentions[at]) {
            let toilet = Mention::plain(mentions[at].span, What::Room(d.toilet.clone()));
            mentions.insert(at + 1, Mention { count: Some(1), ..toilet });
        }
    }
}

/// Takes people whom a thing is for from those who live there: "mesa para cuatro personas". Returns their words.
pub(crate) fn not_of_things(
    tokens: &[Token],
    mentions: &mut Vec<Mention>,
    (domain, registry): (&Domain, &Registry),
    (languages, spoken): (&[&str], &[&Spoken]),
) -> Vec<Span> {
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    let thing = |end: usize| objects::ends_at(tokens, end, (domain, registry), languages);
    let mut told = Vec::new();
    mentions.retain(|m| {
        if !matches!(m.what, What::People | What::Visitors | What::Residents) || m.count.is_none() {
            return true;
        }
        let from = m.from.min(m.span.start);
        let little = |i: &usize| !tokens[*i].is_mark() && (tagged(*i, Tag::Stops) || tagged(*i, Tag::PlaceBefore));
        let first = (from.saturating_sub(MOST_TO_SEATED)..from).rev().take_while(little).last();
        // "table for four people": the number may be of the word for the thing
        let of_thing = first.is_some_and(thing) || (m.span.start > from && thing(m.span.start));
        told.extend(of_thing.then_some(m.span));
        !of_thing
    });
    told
}

/// Says who sleeps where, as far as that is known: couples in double rooms, children in theirs, in a home that people share
/// everybody alone.
///
/// Returns how many live there; `None` where nothing tells.
pub(crate) fn house(reading: &Reading, planned: &[Planned], rooms: &mut [GraphRoom]) -> Option<u32> {
    if !is_dwelling(reading.program) {
        return None;
    }
    let d = &words().dwelling;
    let alone = |i: usize| rooms[i].wished_assets.iter().take(2).any(|o| *o == d.own_bed);
    let guests = |i: usize| d.of_guests.contains(&rooms[i].room_type);
    // beds of a room, least and most
    let beds = |i: usize| {
        let [least, most] = sleeps(reading.domain, planned[i].kind)?;
        Some(if alone(i) { [1, 1] } else { [least, most] })
    };
    let mut free: Vec<(usize, u32)> = (0..planned.len())
        .filter(|&i| rooms[i].occupants.is_none() && planned[i].kind.zone == Zone::Night && !guests(i))
        .filter_map(|i| Some((i, beds(i)?[0])))
        .collect();
    // who shares a home has a room each
    let counted = (reading.each_alone && !free.is_empty()).then_some(free.len() as u32);
    let residents = reading.residents.or(counted)?;
    let mut left = residents;
    if reading.each_alone && residents as usize <= free.len() {
        for (i, _) in free {
            rooms[i].occupants = (left > 0).then_some(1);
            left = left.saturating_sub(1);
        }
        return Some(residents);
    }
    // parents first, then those who have a room alone, then two in every double room that is left
    let adults = residents.saturating_sub(reading.children).min(2);
    // friends have a room each where there are enough
    let pair = reading.pair || residents as usize > free.len();
    let adults = if pair { adults } else { adults.min(1) };
    // rather the bedroom with a bathroom of its own
    let double = |own: bool| {
        let has = |i: usize| !own || planned.iter().any(|r| r.host == Some(i) && r.kind.wet);
        free.iter().position(|(i, beds)| *beds >= 2 && has(*i))
    };
    if let Some(k) = double(true).or_else(|| double(false)).filter(|_| adults > 0) {
        rooms[free.remove(k).0].occupants = Some(adults);
        left = left.saturating_sub(adults);
    }
    free.sort_by_key(|(_, beds)| *beds);
    let many = left as usize > free.len();
    let mut spare = left.saturating_sub(free.len() as u32);
    for (i, beds) in free {
        let more = if many { spare.min(beds.saturating_sub(1)) } else { 0 };
        let here = (1 + more).min(left);
        rooms[i].occupants = (here > 0).then_some(here);
        left -= here;
        spare -= more;
    }
    Some(residents)
}

/// Words between a number and the homes that it counts, at most: "identical".
const MOST_TO_HOMES: usize = 2;

/// States that several homes are asked for, of which one was planned: "two identical units, each with 2 bedrooms". Returns
/// their words too.
pub(crate) fn state_several(
    tokens: &[Token],
    prompt: &str,
    numbers: &[Number],
    spoken: &[&Spoken],
) -> Option<(Span, Note)> {
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    let several = |n: &Number| {
        let exact = n.value >= 2.0 && !n.article && !n.vague;
        let from = tagged(n.span.end, Tag::Counters).unwrap_or(n.span.end);
        let plain = |i: usize| tagged(i, Tag::NotNames).is_some();
        let mut words = (from..(from + MOST_TO_HOMES + 1).min(tokens.len())).take_while(|i| *i == from || plain(i - 1));
        let end = words.find_map(|i| tagged(i, Tag::Homes)).filter(|_| exact)?;
        // "two units of storage", but "4 flats of two bedrooms"
        let of = tokens.get(end).is_some_and(|t| t.text == "of");
        let of_thing = of && !numbers.iter().any(|n| n.span.start == end + 1);
        (!of_thing).then_some(Span { start: n.span.start, end })
    };
    let span = numbers.iter().find_map(several)?;
    let words = prompt.get(tokens[span.start].start..tokens[span.end - 1].end).unwrap_or_default();
    let message = format!(
        "`{words}` are homes of their own, and several in one building are not planned: one of them was, ask for each by itself"
    );
    Some((span, Note::new("one_dwelling", message)))
}

/// Rooms of one home, at most; more are a house of many homes, of which no plan is made.
const MOST_IN_HOME: u32 = 40;

/// States that a number of rooms is not that of one home.
pub(crate) fn state_size(rooms: Option<u32>) -> Option<Note> {
    let rooms = rooms.filter(|n| *n > MOST_IN_HOME)?;
    let message = format!(
        "{rooms} rooms are those of many homes; they were planned as one dwelling, for flats of their own are not planned: ask for one of them"
    );
    Some(Note::new("one_dwelling", message))
}
