//! What a prompt asks of robots room by room: where they stay out ("keep robots out of the pharmacy"), and how fast they
//! drive ("at most 0.4 m/s in the corridors").

use d3dgen_model::scene_graph::{GraphRoom, ROBOT_SPEEDS_M_S, RobotRule};

use crate::named::numbered::is_meant;
use crate::tokens::numbers::Number;
use crate::tokens::text::Span;
use crate::tokens::words::{Tag, words};
use crate::wished::relations::Reader;

/// Words between robots or a speed and the rooms that are spoken of, at most.
const MOST_BETWEEN: usize = 5;

/// What is asked of robots in rooms of a type, or in all.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rule {
    /// `None`: all rooms.
    room_type: Option<String>,
    /// The one of them that is meant, where it has a number of its own.
    number: Option<u32>,
    keep_out: bool,
    max_speed_m_s: Option<f64>,
}

/// Rules of a prompt, and the words for them.
#[derive(Debug, Default)]
pub(crate) struct Found {
    pub rules: Vec<Rule>,
    pub spans: Vec<Span>,
}

/// Reads where the robots of a prompt, named at `machines`, stay out and how fast they drive.
pub(crate) fn read(reader: &Reader, numbers: &[Number], machines: &[Span]) -> Found {
    let mut out = Found::default();
    for i in 0..reader.tokens.len() {
        let Some(end) = reader.tag_end(i, Tag::KeepOut) else { continue };
        let span = Span { start: i, end };
        let inside = (i..end).any(|k| reader.tagged(k, Tag::Robot));
        let robots = machines.iter().filter(|m| in_one_clause(reader, **m, span)).min_by_key(|m| gap(**m, span));
        if !inside && robots.is_none_or(|r| gap(*r, span) > MOST_BETWEEN) {
            continue;
        }
        let about = robots.map_or(span, |r| Span { start: r.start.min(i), end: r.end.max(end) });
        let rooms = rooms_at(reader, about);
        out.rules.extend(rooms.iter().map(|&m| Rule { keep_out: true, ..Rule::of(reader, m) }));
        out.spans.extend((!rooms.is_empty()).then_some(span));
    }
    for (span, speed) in speeds(reader, numbers).into_iter().filter(|_| !machines.is_empty()) {
        let rooms = rooms_at(reader, span);
        let all = Rule { room_type: None, number: None, keep_out: false, max_speed_m_s: None };
        let of: Vec<Rule> = rooms.iter().map(|&m| Rule::of(reader, m)).collect();
        let of = if of.is_empty() { vec![all] } else { of };
        out.rules.extend(of.into_iter().map(|r| Rule { max_speed_m_s: Some(speed), ..r }));
        out.spans.push(span);
    }
    out
}

/// Returns the words that ask for corridors in which the robots of a prompt, named at `machines`, pass each other.
pub(crate) fn two_way(reader: &Reader, machines: &[Span]) -> Option<Span> {
    let mut said =
        (0..reader.tokens.len()).filter_map(|i| Some(Span { start: i, end: reader.tag_end(i, Tag::TwoWay)? }));
    said.next().filter(|_| !machines.is_empty())
}

/// Returns what is asked of robots in each room.
pub(crate) fn of_rooms(rules: &[Rule], rooms: &[GraphRoom]) -> Vec<RobotRule> {
    let of = |room: &GraphRoom| {
        let here: Vec<&Rule> = rules.iter().filter(|r| r.is_of(room)).collect();
        let max_speed_m_s = here.iter().filter_map(|r| r.max_speed_m_s).reduce(f64::min);
        let keep_out = here.iter().any(|r| r.keep_out);
        (!here.is_empty()).then(|| RobotRule { room_id: room.id.clone(), keep_out, max_speed_m_s })
    };
    rooms.iter().filter_map(of).collect()
}

impl Rule {
    /// Returns the rule that keeps robots out of all rooms of a type.
    pub(crate) fn keep_out_of(room_type: String) -> Self {
        Self { room_type: Some(room_type), number: None, keep_out: true, max_speed_m_s: None }
    }

    fn of(reader: &Reader, mention: usize) -> Self {
        let mention = &reader.mentions[mention];
        let room_type = mention.room_type().map(str::to_owned);
        Self { room_type, number: mention.numbered.map(|n| n.n), keep_out: false, max_speed_m_s: None }
    }

    fn is_of(&self, room: &GraphRoom) -> bool {
        self.room_type.as_ref().is_none_or(|kind| is_meant(room, kind, self.number))
    }
}

/// Returns the rooms that words are about: those among them ("Roboter sollen die Küche meiden"), else those right behind
/// them, else those right before.
fn rooms_at(reader: &Reader, span: Span) -> Vec<usize> {
    let is_room = |m: &usize| reader.mentions[*m].room_type().is_some();
    let near = |m: &usize, from: usize, to: usize| {
        let between = from..to;
        from <= to
            && between.len() <= MOST_BETWEEN
            && !between.clone().any(|i| reader.tokens[i].is_mark())
            && is_room(m)
    };
    let all = || 0..reader.mentions.len();
    let among = all().find(|m| is_room(m) && span.contains(reader.mentions[*m].span.start));
    let behind = || all().find(|m| near(m, span.end, reader.mentions[*m].from.min(reader.mentions[*m].span.start)));
    let before = || all().rev().find(|m| near(m, reader.mentions[*m].end(), span.start));
    match among.or_else(behind) {
        Some(first) => reader.row_from(first),
        None => before().map(|last| reader.row_to(last)).unwrap_or_default(),
    }
}

/// Returns true where no sentence ends and no comma stands between two spans.
fn in_one_clause(reader: &Reader, a: Span, b: Span) -> bool {
    let (first, second) = if a.start <= b.start { (a, b) } else { (b, a) };
    !(first.end..second.start).any(|i| reader.tokens[i].is_mark())
}

fn gap(a: Span, b: Span) -> usize {
    a.start.saturating_sub(b.end).max(b.start.saturating_sub(a.end))
}

/// Returns the speeds that are named, m/s.
fn speeds(reader: &Reader, numbers: &[Number]) -> Vec<(Span, f64)> {
    let speed = |n: &Number| {
        let (unit, length) = words().length_units.longest_at(reader.tokens, n.span.end)?;
        let per = reader.tokens.get(unit).filter(|t| t.mark() == Some('/')).map(|_| unit + 1);
        let per = per.or_else(|| reader.tag_end(unit, Tag::Each))?;
        let (end, time) = words().time_units.longest_at(reader.tokens, per)?;
        let value = n.value * length / time;
        ROBOT_SPEEDS_M_S.contains(&value).then_some((Span { start: n.span.start, end }, value))
    };
    numbers.iter().filter(|n| !n.article).filter_map(speed).collect()
}
