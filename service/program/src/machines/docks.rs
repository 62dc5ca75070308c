//! Docks that a prompt puts into a room: "robot vacuum dock in the storage room".

use d3dgen_model::domain::Domain;

use crate::named::mention::{Mention, What};
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, tag_end, tag_ends_at};
use crate::wished::wishes::CHARGING;

/// Words between a dock and its room, at most: "charging station for two robots in the".
const MOST_BETWEEN: usize = 8;

/// Takes a word for a room of other buildings that is one for a dock as well for the latter: "a cleaning robot with its dock" has
/// no loading dock.
pub(crate) fn not_of_goods(tokens: &[Token], mentions: &mut [Mention], domain: &Domain, spoken: &[&Spoken]) {
    for mention in mentions {
        let strange = mention.room_type().is_some_and(|id| domain.room_type(id).is_none());
        let span = mention.span;
        if strange && tag_ends_at(spoken, tokens, span.start, Tag::Charge, span.end) {
            mention.what = What::Charge;
        }
    }
}

/// Takes docks inside of other rooms for what they are, no rooms of their own; returns the types of those rooms.
///
/// `machines` are the words for robots, which may stand between a dock and its room.
pub(crate) fn inside_rooms(
    tokens: &[Token],
    mentions: &mut [Mention],
    machines: &[Span],
    spoken: &[&Spoken],
) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for m in 0..mentions.len() {
        let charges = mentions[m].what == What::Charge || mentions[m].room_type() == Some(CHARGING);
        if !charges || mentions[m].count.is_some_and(|n| n > 1) && mentions[m].room_type().is_some() {
            continue;
        }
        let Some(room) = host(tokens, mentions, m, machines, spoken) else { continue };
        mentions[m].what = What::Charge;
        if !out.contains(&room) {
            out.push(room);
        }
    }
    out
}

/// Words between a robot and the place where it waits, at most: "that always waits near the".
const MOST_TO_PLACE: usize = 7;

/// Returns the types of the rooms that robots wait in: "a delivery robot waits in the pantry"; `None` for the entrance, which
/// is then said of the robot and of no room.
pub(crate) fn where_robots_wait(
    tokens: &[Token],
    mentions: &mut Vec<Mention>,
    machines: &[Span],
    spoken: &[&Spoken],
) -> Vec<Option<String>> {
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    let mut out = Vec::new();
    for robot in machines {
        let Some(m) = mentions.iter().position(|m| m.span.start >= robot.end) else { continue };
        let gap = robot.end..mentions[m].from.min(mentions[m].span.start);
        if gap.len() > MOST_TO_PLACE || gap.clone().any(|i| tokens[i].ends_sentence()) {
            continue;
        }
        let Some(end) = gap.clone().find_map(|i| tagged(i, Tag::Waits)) else { continue };
        // nothing but small words between the verb and the place
        let little = [Tag::Stops, Tag::Definite, Tag::Articles, Tag::Inside, Tag::Near, Tag::PlaceBefore];
        let leads = (end..gap.end).all(|i| little.iter().any(|&t| tagged(i, t).is_some()));
        match &mentions[m].what {
            What::Entrance if leads => {
                out.push(None);
                mentions.remove(m);
            }
            What::Room(id) if leads && end < gap.end && mentions[m].definite => out.push(Some(id.clone())),
            _ => {}
        }
    }
    out
}

/// Returns the type of the room that a dock stands in.
fn host(tokens: &[Token], mentions: &[Mention], dock: usize, machines: &[Span], spoken: &[&Spoken]) -> Option<String> {
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    let room = |m: &&Mention| m.room_type().is_some_and(|id| id != CHARGING);
    let marks = |range: std::ops::Range<usize>| range.into_iter().any(|i| tokens[i].is_mark());
    let span = mentions[dock].span;
    if matches!(tokens[span.start].kind, Kind::Han | Kind::Hangul) {
        // "充电站在储藏室里"
        let at = tokens.get(span.end).is_some_and(|t| matches!(t.text.as_str(), "在" | "位" | "放" | "设"));
        let next = mentions.get(dock + 1).filter(|m| at && room(m) && !marks(span.end..m.span.start));
        if let Some(next) = next.filter(|m| tagged(m.span.end, Tag::Inside).is_some()) {
            return next.room_type().map(str::to_owned);
        }
        // "储藏室里有充电座", "창고에 충전 도크": the room stands before
        let before = mentions[..dock].iter().rev().find(room)?;
        let gap = before.span.end..span.start;
        let near = gap.len() <= MOST_BETWEEN && !marks(gap) && tagged(before.span.end, Tag::Inside).is_some();
        return before.room_type().filter(|_| near).map(str::to_owned);
    }
    let after = mentions[dock + 1..].iter().find(room)?;
    let gap = span.end..after.from.min(after.span.start);
    if gap.is_empty() || gap.len() > MOST_BETWEEN || marks(gap.clone()) {
        return None;
    }
    // the last words are "in the"; those before them speak of the robots
    let inside = gap.clone().rev().find(|&i| tagged(i, Tag::Inside).is_some_and(|end| end <= gap.end))?;
    let lead = (tagged(inside, Tag::Inside)?..gap.end)
        .all(|i| [Tag::Definite, Tag::Articles, Tag::Own].iter().any(|&t| tagged(i, t).is_some()));
    let rest = (gap.start..inside).all(|i| {
        machines.iter().any(|s| s.contains(i))
            || [Tag::Stops, Tag::Definite, Tag::Articles].iter().any(|&t| tagged(i, t).is_some())
            || matches!(tokens[i].kind, Kind::Number(_))
            || spoken.iter().any(|s| s.numbers.contains_key(&tokens[i].text))
    });
    after.room_type().filter(|_| lead && rest).map(str::to_owned)
}
