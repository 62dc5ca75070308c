//! Rooms that are some of those counted before them: "10 single rooms, two of which are isolation rooms" are ten.

use d3dgen_model::domain::{Domain, Zone};

use super::mentions::Mention;
use super::text::Token;
use super::words::{Spoken, Tag};

/// Takes rooms to sleep in that are a part of a number from that number.
pub(super) fn settle(tokens: &[Token], spoken: &[&Spoken], mentions: &mut [Mention], domain: &Domain) {
    let sleeps =
        |m: &Mention| m.room_type().and_then(|id| domain.room_type(id)).is_some_and(|kind| kind.zone == Zone::Night);
    for k in 1..mentions.len() {
        let (before, part) = (&mentions[k - 1], &mentions[k]);
        let both = sleeps(before) && sleeps(part) && before.what != part.what;
        let Some((all, some)) = before.count.zip(part.count).filter(|(all, some)| both && *some > 0 && all > some)
        else {
            continue;
        };
        let between = before.span.end..part.span.start;
        if between.into_iter().any(|i| spoken.iter().any(|s| s.tag_at(tokens, i, Tag::PartOf).is_some())) {
            mentions[k - 1].count = Some(all - some);
        }
    }
}
