//! Robots that a prompt names: kind, number, charging.

use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::scene_graph::{Note, Robot};

use super::Request;
use super::mentions::{Mention, number_after};
use super::numbers::Number;
use super::places::note;
use super::text::{Kind, Span, Token, fold};
use super::wishes::{CHARGING, Wishes};
use super::words::{Spoken, Tag, words};

/// Most robots of one kind.
const MOST: f64 = 100.0;
/// Words between a number and the robots that it counts, at most: "two small autonomous delivery robots".
const MOST_BETWEEN: usize = 3;

/// Robots of one kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Wanted {
    pub kind: &'static str,
    pub count: u32,
}

/// Words for robots, or for the place of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Named {
    span: Span,
    /// What they do, where the words say it.
    kind: Option<&'static str>,
    /// True for a place of theirs ("robot garage"), which says nothing of how many there are.
    place: bool,
}

/// Where a prompt speaks of robots.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Robots {
    found: Vec<Named>,
    /// Their words.
    pub spans: Vec<Span>,
    /// Words for a dock right behind them: "robot vacuum dock".
    pub docks: Vec<Span>,
    /// True when robots are named at all.
    pub named: bool,
}

/// Which robots a prompt wants.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Fleet {
    pub wanted: Vec<Wanted>,
    /// True when the kind was not said.
    pub kind_assumed: bool,
}

const KINDS: [(Tag, &str); 4] =
    [(Tag::Clean, "cleaning"), (Tag::Deliver, "delivery"), (Tag::Serve, "service"), (Tag::Transport, "transport")];
const VERBS: [(Tag, &str); 4] = [
    (Tag::CleanVerbs, "cleaning"),
    (Tag::DeliverVerbs, "delivery"),
    (Tag::ServeVerbs, "service"),
    (Tag::TransportVerbs, "transport"),
];

/// Finds the robots of a prompt.
pub(super) fn find(tokens: &[Token], spoken: &[&Spoken]) -> Robots {
    let mut out = Robots::default();
    let mut i = 0;
    while i < tokens.len() {
        // the longest phrase of any language decides: "robot docking" is no kind of robot
        let found = spoken.iter().filter_map(|s| s.tags.longest_at(tokens, i)).max_by_key(|f| f.0);
        let Some((end, tags)) = found else {
            i += 1;
            continue;
        };
        let span = Span { start: i, end };
        if let Some((_, kind)) = KINDS.iter().find(|(tag, _)| tags.contains(tag)) {
            let kind = if *kind == "delivery" && serves(tokens, i, spoken) { "service" } else { kind };
            out.found.push(Named { span, kind: Some(kind), place: false });
        } else if tags.contains(&Tag::Robot) {
            out.found.push(Named { span, kind: None, place: false });
        } else if tags.contains(&Tag::ChargePlace) && robot_inside(tokens, i, end, spoken) {
            out.found.push(Named { span, kind: None, place: true });
        }
        i = end.max(i + 1);
    }
    out.spans = out.found.iter().filter(|f| !f.place).map(|f| f.span).collect();
    let dock = |s: &Span| {
        let end = spoken.iter().find_map(|l| l.tag_at(tokens, s.end, Tag::Charge))?;
        Some(Span { start: s.end, end })
    };
    out.docks = out.spans.iter().filter_map(dock).collect();
    out.named = !out.found.is_empty();
    out
}

/// What can count robots, and what stands between.
pub(super) struct Counting<'a> {
    pub tokens: &'a [Token],
    pub numbers: &'a [Number],
    pub mentions: &'a [Mention],
    /// Words that others have read: places, areas, storeys, the name of the building.
    pub taken: &'a [Span],
    pub spoken: &'a [&'a Spoken],
    pub language: &'a str,
    /// Robots that are wanted on every storey, and how many storeys there are.
    pub on_each: (&'a [Span], u32),
}

impl Robots {
    /// Returns the robots with their numbers; a number that counts rooms, people or storeys counts no robots.
    pub(super) fn counted(&self, by: &Counting) -> Fleet {
        let mut out = Fleet::default();
        let free = |n: &&Number| {
            let used = by.mentions.iter().any(|m| m.number == Some(n.span) && !m.vague);
            !used && !by.taken.iter().any(|s| s.overlaps(n.span)) && !by.tagged(n.span.end, Tag::Storeys)
        };
        let free: Vec<&Number> = by.numbers.iter().filter(free).collect();
        let (on_each, storeys) = by.on_each;
        let times = |f: &Named| if on_each.contains(&f.span) { storeys } else { 1 };
        let count = |f: &Named| if f.place { 1 } else { by.count(f.span, &free) * times(f) };
        for f in &self.found {
            if let Some(kind) = f.kind {
                add(&mut out.wanted, kind, count(f));
            }
        }
        for f in self.found.iter().filter(|f| f.kind.is_none()) {
            let (kinds, count) = (verbs(by.tokens, f.span.start, by.spoken), count(f));
            match (kinds.as_slice(), out.wanted.as_mut_slice()) {
                // "AMR charging area for 4 robots": the same robots again
                (_, [one]) if !kinds.iter().any(|k| k != &one.kind) => one.count = one.count.max(count),
                (_, [_, ..]) if kinds.is_empty() => {}
                ([], _) => {
                    out.kind_assumed = true;
                    add(&mut out.wanted, "service", count);
                }
                (kinds, _) => kinds.iter().for_each(|kind| add(&mut out.wanted, kind, count)),
            }
        }
        out
    }
}

impl Counting<'_> {
    fn tagged(&self, i: usize, tag: Tag) -> bool {
        self.spoken.iter().any(|s| s.tag_at(self.tokens, i, tag).is_some())
    }

    /// Returns the number before robots, or behind them: "机器人三台", "로봇 2대", "robots: 3", "robots x 2".
    fn count(&self, span: Span, free: &[&Number]) -> u32 {
        let behind = || number_after(self.tokens, span.end, free, self.spoken, self.language);
        let with_counter =
            || free.iter().position(|n| n.span.start == span.end && self.tagged(n.span.end, Tag::Counters));
        let found = if self.language == "ko" {
            with_counter().or_else(behind).or_else(|| self.before(span.start, free))
        } else {
            self.before(span.start, free).or_else(with_counter).or_else(behind)
        };
        found.map_or(1, |k| free[k].value.clamp(1.0, MOST) as u32)
    }

    /// Returns the number before robots, over adjectives and counters but no other thing.
    fn before(&self, start: usize, free: &[&Number]) -> Option<usize> {
        let mut at = start;
        for _ in 0..=MOST_BETWEEN {
            if let Some(k) = free.iter().position(|n| n.span.end == at) {
                return Some(k);
            }
            at = at.checked_sub(1)?;
            let token = &self.tokens[at];
            let other = token.is_mark()
                || matches!(token.kind, Kind::Number(_))
                || self.mentions.iter().any(|m| m.span.contains(at))
                || self.taken.iter().any(|s| s.contains(at));
            let parts = [Tag::Stops, Tag::Starts, Tag::Joins, Tag::No, Tag::Near, Tag::Door, Tag::Each, Tag::Storeys];
            let parts = parts.iter().any(|&tag| self.tagged(at, tag)) && !self.tagged(at, Tag::Counters);
            if other || parts && token.text != "的" && token.text != "의" {
                return None;
            }
        }
        None
    }
}

/// Returns the robots of the scene graph: what the prompt wants with the bodies that it or the request gives them.
pub(super) fn of_graph(
    fleet: &Fleet,
    wishes: &Wishes,
    radius: Option<f64>,
    request: &Request,
    assumptions: &mut Vec<Note>,
    conflicts: &mut Vec<Note>,
) -> Vec<Robot> {
    let mut wanted = fleet.wanted.clone();
    if wanted.is_empty()
        && (wishes.charging || request.robot_radius_m.is_some() || request.robot != RobotBody::default())
    {
        wanted.push(Wanted { kind: "service", count: 1 });
    }
    if fleet.kind_assumed {
        assumptions
            .push(note("robot_kind", "the prompt does not say what its robots do; service robots were assumed".into()));
    }
    let radius = match radius {
        Some(r) if !(0.05..=2.0).contains(&r) => {
            conflicts.push(note(
                "robot_radius",
                format!("a robot radius of {r} m is outside 0.05-2 m; the usual one was taken"),
            ));
            None
        }
        other => other,
    };
    if let (Some(flag), Some(named)) = (request.robot_radius_m, radius)
        && (flag - named).abs() > 1e-9
    {
        conflicts.push(note(
            "radius_flag",
            format!("the prompt says {named} m robot radius, the request {flag} m; {flag} m was used"),
        ));
    }
    let charging = wishes.charging || wishes.wishes.iter().any(|w| w.room_type == CHARGING);
    wanted
        .iter()
        .filter_map(|w| {
            let body = words().robot_kinds.get(w.kind)?;
            let own = request.robot;
            let stated = request.robot_radius_m.or(own.radius_m()).or(radius);
            Some(Robot {
                kind: w.kind.into(),
                count: w.count,
                radius_m: stated.unwrap_or(body.radius_m),
                height_m: own.height_m.unwrap_or(body.height_m),
                charging,
                body: (own != RobotBody::default()).then_some(own),
            })
        })
        .collect()
}

fn add(wanted: &mut Vec<Wanted>, kind: &'static str, count: u32) {
    match wanted.iter_mut().find(|w| w.kind == kind) {
        Some(known) => known.count = known.count.max(count),
        None => wanted.push(Wanted { kind, count }),
    }
}

fn robot_inside(tokens: &[Token], start: usize, end: usize, spoken: &[&Spoken]) -> bool {
    (start..end).any(|i| spoken.iter().any(|s| s.tag_at(tokens, i, Tag::Robot).is_some())) || {
        let text: String = tokens[start..end].iter().map(|t| t.text.as_str()).collect();
        let words = spoken.iter().filter_map(|s| s.words.phrases.get(&Tag::Robot)).flatten();
        words.map(|w| fold(w)).any(|w| text.contains(&w))
    }
}

fn sentence(tokens: &[Token], at: usize) -> std::ops::Range<usize> {
    let start = (0..at).rev().find(|&i| tokens[i].ends_sentence()).map_or(0, |i| i + 1);
    let end = (at..tokens.len()).find(|&i| tokens[i].ends_sentence()).unwrap_or(tokens.len());
    start..end
}

/// Returns true when a delivery robot brings things to guests at tables.
fn serves(tokens: &[Token], at: usize, spoken: &[&Spoken]) -> bool {
    let range = at..sentence(tokens, at).end.min(at + 12);
    range.into_iter().any(|i| spoken.iter().any(|s| s.tag_at(tokens, i, Tag::TableWords).is_some()))
}

fn verbs(tokens: &[Token], at: usize, spoken: &[&Spoken]) -> Vec<&'static str> {
    let range = sentence(tokens, at);
    let from = range.start.max(at.saturating_sub(8));
    let mut kinds = Vec::new();
    for i in from..range.end.min(at + 12) {
        for (tag, kind) in VERBS {
            let here = spoken.iter().any(|s| s.tag_at(tokens, i, tag).is_some());
            if here && !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
    }
    kinds
}
