//! Where a robot works: "a disinfection robot drives through the corridors at night". Where the prompt says nothing of it a
//! robot works wherever its kind does.

use crate::named::mention::Mention;
use crate::tokens::text::{Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged};

/// Words between a robot and the corridors that it keeps to, at most: "drives at night through the".
const MOST_BETWEEN: usize = 6;

/// Returns the words for robots that keep to some rooms, and the types of these: corridors that are named behind a robot, with the rooms that go on with
/// them ("the corridors and the waiting area"); `way` is the type of corridors.
pub(crate) fn read(
    tokens: &[Token],
    mentions: &[Mention],
    machines: &[Span],
    way: &str,
    spoken: &[&Spoken],
) -> Option<(Span, Vec<String>)> {
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    let named: Vec<&Mention> = mentions.iter().filter(|m| m.room_type().is_some()).collect();
    for robot in machines {
        let Some(first) = named.iter().position(|m| m.span.start >= robot.end) else { continue };
        let gap = robot.end..named[first].span.start;
        let beside = gap.clone().any(|i| [Tag::Near, Tag::Door, Tag::No].iter().any(|&t| tagged(i, t)));
        let parted = gap.clone().any(|i| tokens[i].is_mark() || tagged(i, Tag::Joins) || tagged(i, Tag::Starts));
        if named[first].room_type() != Some(way) || gap.is_empty() || gap.len() > MOST_BETWEEN || beside || parted {
            continue;
        }
        let mut out: Vec<String> = vec![way.to_owned()];
        let mut end = named[first].span.end;
        for m in &named[first + 1..] {
            let joined = (end..m.span.start).any(|i| tagged(i, Tag::Joins)) && m.from.min(m.span.start) <= end + 2;
            if !joined || (end..m.span.start).any(|i| tokens[i].is_mark()) {
                break;
            }
            out.extend(m.room_type().map(str::to_owned));
            end = m.span.end;
        }
        return Some((*robot, out));
    }
    None
}
