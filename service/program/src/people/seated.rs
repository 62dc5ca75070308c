//! Desks of rooms: "two open offices with 20 desks each", "three rooms of 4 desks", "je 6 Arbeitsplätze".

use std::cmp::Reverse;

use d3dgen_model::domain::{Domain, Program, RoomType};
use d3dgen_model::offer;
use d3dgen_model::offer::works_in;

use crate::named::mention::{Mention, What};
use crate::people::held::Held;
use crate::tokens::text::{Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged};

/// Words between a room and the number of its desks, at most: "with up to".
const MOST_BETWEEN: usize = 5;

/// Reads how many desks rooms have, with the words for them; rooms "of 4 desks" become those of the domain that have as many.
pub(crate) fn read(
    tokens: &[Token],
    mentions: &mut [Mention],
    (domain, program): (&Domain, &Program),
    spoken: &[&Spoken],
) -> (Vec<Held>, Vec<Span>) {
    let (mut out, mut words): (Vec<Held>, Vec<Span>) = (Vec::new(), Vec::new());
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    for d in 1..mentions.len() {
        let people = matches!(mentions[d].what, What::Staff | What::People);
        let Some(count) = mentions[d].count.filter(|_| people || mentions[d].what == What::Desks) else { continue };
        let Some(each) = u32::try_from(count).ok().filter(|n| *n > 0 && !mentions[d].article) else { continue };
        let host = &mentions[d - 1];
        let gap = host.span.end..mentions[d].from.min(mentions[d].span.start);
        let tail = mentions[d].span.end..(mentions[d].span.end + 2).min(tokens.len());
        let per_room = gap.clone().any(|i| tagged(i, Tag::Each))
            || tail.take_while(|&i| !tokens[i].is_mark()).any(|i| tagged(i, Tag::Each));
        let of = gap.len() == 1
            && gap.clone().all(|i| tagged(i, Tag::Stops) || matches!(tokens[i].text.as_str(), "a" | "de"));
        let stops = gap.clone().any(|i| {
            tokens[i].ends_sentence() || tokens[i].is_mark() && !per_room || tagged(i, Tag::Joins) || tagged(i, Tag::No)
        });
        if gap.len() > MOST_BETWEEN || stops || people && !per_room {
            continue;
        }
        let rooms = host.count.filter(|n| *n > 0).and_then(|n| u32::try_from(n).ok());
        let rooms = rooms.unwrap_or(if host.plural { 2 } else { 1 });
        let each = if per_room || of || rooms == 1 { each } else { each.div_ceil(rooms) };
        let fits = |k: &&RoomType| offer::desks(domain, k).is_some_and(|[low, high]| (low..=high).contains(&each));
        let strange = |k: &&RoomType| !program.rooms.iter().any(|e| e.room_type == k.id);
        let least = |k: &&RoomType| (strange(k), offer::desks(domain, k).map(|[low, high]| (Reverse(low), high)));
        let id = match &host.what {
            What::Room(id) => {
                // "a shared office with four desks" is larger than such a room is otherwise
                let own = domain.room_type(id).filter(|k| works_in(domain, k));
                let small = own.and_then(|k| offer::desks(domain, k)).is_some_and(|[_, high]| each > high);
                let larger = |k: &&RoomType| works_in(domain, k) && fits(k);
                let kind = domain.room_types.iter().filter(|_| small).filter(larger).min_by_key(least);
                kind.map_or_else(|| id.clone(), |k| k.id.clone())
            }
            What::Total if host.count.is_some() && !host.article && (of || per_room) => {
                let Some(kind) = domain.room_types.iter().filter(fits).min_by_key(least) else { continue };
                kind.id.clone()
            }
            _ => continue,
        };
        mentions[d - 1].what = What::Room(id.clone());
        if domain.room_type(&id).and_then(|k| offer::desks(domain, k)).is_some() {
            out.push(Held { room_type: id, count: rooms, beds: each });
            words.push(mentions[d].span);
        }
    }
    (out, words)
}
