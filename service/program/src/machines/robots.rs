//! Robots that a prompt names: kind, number, charging.

use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::robot_kind;
use d3dgen_model::scene_graph::{GraphRoom, Note, Robot};

use super::sizes::Sizes;
use crate::named::counts::number_after;
use crate::named::mention::{Mention, What};
use crate::request::Request;
use crate::tokens::negation::is_ruled_out;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Kind, Span, Token, fold};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end, tag_ends_at};
use crate::wished::wishes::{CHARGING, Wishes};

/// Most robots of one kind.
const MOST: f64 = 100.0;
/// Words between a number and the robots that it counts, at most: "two small autonomous delivery robots".
const MOST_BETWEEN: usize = 3;
/// Words behind robots that say what they do, at most.
const MOST_AFTER: usize = 16;
/// Robots that a plural without a number stands for.
const SEVERAL: u32 = 2;

/// Robots of one kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Wanted {
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
    /// True for a plural form.
    plural: bool,
    /// True where it shares the word for robots with another kind: "cleaning and delivery robots".
    shared: bool,
    /// First word of a name that is none of the kinds: "lawn mowing robot".
    name_from: Option<usize>,
}

/// A kind of work beside robots: the "2 cleaning" of "robots: 2 cleaning, 3 delivery".
#[derive(Debug, Clone, Copy, PartialEq)]
struct Work {
    at: usize,
    kind: &'static str,
    own: Option<u32>,
}

/// What a reader of robots may assume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Assumed {
    /// The kind was not said.
    Kind,
    /// They do more than one kind of work, and the prompt does not say how many do which.
    Shares,
    /// There are several, and the prompt does not say how many.
    Number,
}

/// Where a prompt speaks of robots.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Robots {
    found: Vec<Named>,
    /// Their words.
    pub spans: Vec<Span>,
    /// Words for a dock right behind them: "robot vacuum dock", "a robot that docks".
    pub docks: Vec<Span>,
    /// True when robots are named at all.
    pub named: bool,
}

/// Which robots a prompt wants.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Fleet {
    pub wanted: Vec<Wanted>,
    pub assumed: Vec<Assumed>,
    /// Words for robots of kinds that are not planned, for which service robots are.
    pub unknown: Vec<Span>,
    /// The same beside robots of other kinds, which stand for none of them: drones beside transport robots.
    pub left_out: Vec<Span>,
}

const KINDS: [(Tag, &str); 5] = [
    (Tag::Disinfect, "disinfection"),
    (Tag::Clean, "cleaning"),
    (Tag::Deliver, "delivery"),
    (Tag::Serve, "service"),
    (Tag::Transport, "transport"),
];
const VERBS: [(Tag, &str); 5] = [
    (Tag::DisinfectVerbs, "disinfection"),
    (Tag::CleanVerbs, "cleaning"),
    (Tag::DeliverVerbs, "delivery"),
    (Tag::ServeVerbs, "service"),
    (Tag::TransportVerbs, "transport"),
];

/// Finds the robots of a prompt, but for those that it rules out.
pub(crate) fn find(tokens: &[Token], spoken: &[&Spoken], language: &str) -> Robots {
    let mut out = Robots::default();
    let mut i = 0;
    while i < tokens.len() {
        // the longest phrase of any language decides: "robot docking" is no kind of robot
        let found = spoken.iter().filter_map(|s| s.tags.longest_at(tokens, i)).max_by_key(|f| f.0);
        let Some((end, tags)) = found else {
            out.found.extend(compound(tokens, i, spoken));
            i += 1;
            continue;
        };
        let span = Span { start: i, end };
        // "a robot delivers" is one
        let is_verb = |tag| tag_ends_at(spoken, tokens, end - 1, tag, end);
        let noun_end = if VERBS.iter().any(|(tag, _)| is_verb(*tag)) { end - 1 } else { end };
        let plural = is_plural(&tokens[i..noun_end.max(i + 1)]);
        let named = Named { span, kind: None, place: false, plural, shared: false, name_from: None };
        if let Some((_, kind)) = KINDS.iter().find(|(tag, _)| tags.contains(tag)) {
            let kind = if *kind == "delivery" && serves(tokens, i, spoken) { "service" } else { kind };
            out.found.push(Named { kind: Some(kind), ..named });
        } else if tags.contains(&Tag::OtherRobot) {
            out.found.push(Named { name_from: Some(i), ..named });
        } else if tags.contains(&Tag::Robot) {
            out.found.push(Named { name_from: name_before(tokens, i, spoken), ..named });
        } else if tags.contains(&Tag::ChargePlace) && robot_inside(tokens, i, end, spoken) {
            out.found.push(Named { place: true, ..named });
        }
        i = end.max(i + 1);
    }
    let shared = elliptic(tokens, &out.found, spoken);
    for f in &mut out.found {
        f.shared = shared.iter().any(|s| s.1 == f.span);
    }
    out.found.extend(shared.into_iter().map(|s| s.0));
    out.found.sort_by_key(|f| f.span.start);
    out.spans = out.found.iter().filter(|f| !f.place).map(|f| f.span).collect();
    out.found.retain(|f| !is_denied(tokens, spoken, language, f));
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    let dock = |s: &Span| {
        let relative = [Tag::Stops, Tag::Definite].iter().find_map(|&tag| tagged(s.end, tag));
        let starts = std::iter::once(s.end).chain(relative);
        starts.filter_map(|start| Some(Span { start, end: tagged(start, Tag::Charge)? })).next()
    };
    out.docks = out.spans.iter().filter_map(dock).collect();
    out.named = !out.found.is_empty();
    out
}

/// Returns true for robots that a prompt does not want: "no cleaning robots", "robots not needed"; where they are to stay
/// out of rooms, it wants them.
fn is_denied(tokens: &[Token], spoken: &[&Spoken], language: &str, robots: &Named) -> bool {
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    let keep_out = (robots.span.start.saturating_sub(MOST_BETWEEN)..=robots.span.end)
        .any(|i| spoken.iter().any(|s| s.tag_at(tokens, i, Tag::KeepOut).is_some_and(|end| end > robots.span.start)));
    let named = Span { start: robots.name_from.unwrap_or(robots.span.start), ..robots.span };
    let denied = is_ruled_out(tokens, spoken, language, named) || tagged(named.end, Tag::Unneeded);
    denied && !keep_out
}

/// What can count robots, and what stands between.
pub(crate) struct Counting<'a> {
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
    /// Returns the kind of the robots at a span, where their words say it.
    pub(crate) fn kind_at(&self, span: Span) -> Option<&'static str> {
        self.found.iter().find(|f| f.span == span)?.kind
    }

    /// Returns the robots with their numbers; a number that counts rooms, people or storeys counts no robots.
    pub(crate) fn counted(&self, by: &Counting) -> Fleet {
        let mut out = Fleet::default();
        let free = |n: &&Number| {
            let used = by.mentions.iter().any(|m| m.number == Some(n.span) && !m.vague);
            !used && !by.taken.iter().any(|s| s.overlaps(n.span)) && !by.tagged(n.span.end, Tag::Storeys)
        };
        let free: Vec<&Number> = by.numbers.iter().filter(free).collect();
        let (on_each, storeys) = by.on_each;
        let times = |f: &Named| if on_each.contains(&f.span) { storeys } else { 1 };
        let count = |f: &Named| if f.place { 1 } else { by.count(f.span, &free).unwrap_or(1) * times(f) };
        // "robots" without a number are two; on every storey one
        let told = |f: &Named| by.count(f.span, &free).is_some() || f.place || times(f) > 1;
        let several = |f: &Named| f.plural && !told(f);
        for f in &self.found {
            let Some(kind) = f.kind else { continue };
            let open = several(f) && !f.shared;
            if several(f) {
                out.assume(Assumed::Number);
            }
            add(&mut out.wanted, kind, if open { SEVERAL } else { count(f) });
        }
        for f in self.found.iter().filter(|f| f.kind.is_none()) {
            let n = if several(f) { SEVERAL } else { count(f) };
            self.add_generic(f, n, several(f), by, &free, &mut out);
        }
        out
    }

    /// Adds robots whose words do not say the kind: by the work beside them, as the same robots again, or as service robots.
    fn add_generic(&self, f: &Named, n: u32, several: bool, by: &Counting, free: &[&Number], out: &mut Fleet) {
        let works = self.works(f, by, free);
        let other_kind = f.name_from == Some(f.span.start);
        if other_kind && works.is_empty() && !out.wanted.is_empty() {
            out.left_out.push(f.span);
            return;
        }
        let mut kinds: Vec<&'static str> = Vec::new();
        works.iter().for_each(|w| kinds.extend((!kinds.contains(&w.kind)).then_some(w.kind)));
        match (kinds.as_slice(), out.wanted.as_mut_slice()) {
            // "AMR charging area for 4 robots": the same robots again
            (_, [one]) if !kinds.iter().any(|k| k != &one.kind) && works.iter().all(|w| w.own.is_none()) => {
                if !several {
                    one.count = one.count.max(n);
                }
            }
            (_, [_, ..]) if kinds.is_empty() => {}
            ([], _) => {
                // places and rooms before robots are no kind of them
                let other = |s: &Span| s.start < f.span.start && f.name_from.is_some_and(|from| s.end > from);
                let elsewhere = by.taken.iter().any(other) || by.mentions.iter().any(|m| other(&m.span));
                match f.name_from.filter(|_| !elsewhere) {
                    Some(start) => out.unknown.push(Span { start, end: f.span.end }),
                    None => out.assume(Assumed::Kind),
                }
                if several {
                    out.assume(Assumed::Number);
                }
                add(&mut out.wanted, "service", n);
            }
            _ => {
                if several && works.iter().any(|w| w.own.is_none()) {
                    out.assume(Assumed::Number);
                }
                share(&works, n, f.span.end, out);
            }
        }
    }

    /// Returns what robots do by the words beside them, each with its own number: "two for cleaning", "cleaning x2".
    fn works(&self, f: &Named, by: &Counting, free: &[&Number]) -> Vec<Work> {
        let range = sentence(by.tokens, f.span.start);
        let mut out: Vec<Work> = Vec::new();
        for i in range.start.max(f.span.start.saturating_sub(8))..range.end.min(f.span.start + MOST_AFTER) {
            let other = by.mentions.iter().any(|m| m.room_type().is_some() && m.span.contains(i));
            if other || self.found.iter().any(|o| o.span.contains(i)) {
                continue;
            }
            let Some((_, kind)) = VERBS.iter().find(|(tag, _)| by.tagged(i, *tag)) else { continue };
            let own = by.own_number(i, f.span, free);
            match out.iter_mut().find(|w| w.kind == *kind) {
                Some(known) => known.own = known.own.or(own),
                None => out.push(Work { at: i, kind, own }),
            }
        }
        out
    }
}

impl Fleet {
    fn assume(&mut self, what: Assumed) {
        if !self.assumed.contains(&what) {
            self.assumed.push(what);
        }
    }
}

/// Shares robots out to kinds of work: those with a number of their own have it, the others what is left.
fn share(works: &[Work], n: u32, from: usize, out: &mut Fleet) {
    let own: u32 = works.iter().filter_map(|w| w.own).sum();
    let open: Vec<&Work> = works.iter().filter(|w| w.own.is_none()).collect();
    for w in works {
        if let Some(count) = w.own {
            add(&mut out.wanted, w.kind, count);
        }
    }
    let first = works.iter().find(|w| w.at >= from);
    match open.as_slice() {
        // "three robots, one of them for cleaning"
        [] if n > own && works.iter().any(|w| w.own.is_some()) && first.is_some() => {
            out.assume(Assumed::Kind);
            add(&mut out.wanted, "service", n - own);
        }
        [] => {}
        // "two robots for delivery and one for cleaning", but "three robots: one for cleaning, the rest for delivery"
        [one] => {
            let all = own == 0 || first == Some(*one);
            add(&mut out.wanted, one.kind, if all { n } else { n.saturating_sub(own).max(1) });
        }
        several => {
            let k = several.len() as u32;
            let left = n.saturating_sub(own);
            if left > k || n > 1 {
                out.assume(Assumed::Shares);
            }
            for (i, w) in several.iter().enumerate() {
                add(&mut out.wanted, w.kind, (left / k + u32::from((i as u32) < left % k)).max(1));
            }
        }
    }
}

impl Counting<'_> {
    fn tagged(&self, i: usize, tag: Tag) -> bool {
        is_tagged(self.spoken, self.tokens, i, tag)
    }

    /// Returns the number before robots, or behind them: "机器人三台", "로봇 2대", "robots: 3", "robots x 2".
    fn count(&self, span: Span, free: &[&Number]) -> Option<u32> {
        let behind = || number_after(self.tokens, span.end, free, self.spoken, self.language);
        let with_counter =
            || free.iter().position(|n| n.span.start == span.end && self.tagged(n.span.end, Tag::Counters));
        let found = if self.language == "ko" {
            with_counter().or_else(behind).or_else(|| self.before(span.start, free))
        } else {
            self.before(span.start, free).or_else(with_counter).or_else(behind)
        };
        found.map(|k| free[k].value.clamp(1.0, MOST) as u32)
    }

    /// Returns the number of a kind of work: "2 cleaning", "one for delivery", "cleaning x2", "cleaning (2)".
    fn own_number(&self, i: usize, robots: Span, free: &[&Number]) -> Option<u32> {
        let value = |n: &&&Number| n.value.clamp(1.0, MOST) as u32;
        let mut at = i;
        for _ in 0..MOST_BETWEEN {
            if let Some(n) = free.iter().find(|n| n.span.end == at && !n.vague) {
                return Some(value(&n));
            }
            let before = at.checked_sub(1).filter(|&k| !robots.contains(k) && !self.tokens[k].is_mark());
            let Some(before) = before else { break };
            let leads = [Tag::Stops, Tag::Definite, Tag::PlaceBefore].iter().any(|&tag| self.tagged(before, tag));
            if !leads && self.tokens[before].text != "x" || self.tagged(before, Tag::Joins) {
                break;
            }
            at = before;
        }
        let next = self.tokens.get(i + 1)?;
        let at = if next.text == "x" || matches!(next.mark(), Some(':' | ',')) { i + 2 } else { i + 1 };
        let bracket = next.mark() != Some(',') || self.tokens.get(i + 3).is_some_and(|t| t.mark() == Some(','));
        let found = free.iter().find(|n| n.span.start == at && !n.vague && !n.article)?;
        // "cleaning, 3 delivery": the number is of what follows it
        let closes =
            self.tokens.get(found.span.end).is_none_or(|t| t.is_mark() || self.tagged(found.span.end, Tag::Joins));
        (closes && bracket).then(|| value(&found))
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
pub(crate) fn of_graph(
    fleet: &Fleet,
    wishes: &Wishes,
    (robots, sizes): (&Robots, &Sizes),
    request: &Request,
    prompt: &Prompt,
    assumptions: &mut Vec<Note>,
    conflicts: &mut Vec<Note>,
) -> Vec<Robot> {
    let mut wanted = fleet.wanted.clone();
    if wanted.is_empty()
        && (wishes.charging || request.robot_radius_m.is_some() || request.robot != RobotBody::default())
    {
        wanted.push(Wanted { kind: "service", count: 1 });
    }
    state_assumed(fleet, prompt, assumptions);
    for span in &fleet.left_out {
        let words = prompt.words(*span);
        let message = format!("`{words}` is no kind of robot that is planned; it was left out beside the others");
        conflicts.push(Note::new("unread_wish", message));
    }
    let charging = wishes.charging || wishes.wishes.iter().any(|w| w.room_type == CHARGING);
    let kinds: Vec<&str> = wanted.iter().map(|w| w.kind).collect();
    let mut bodies = Bodies { request, sizes, robots, conflicts };
    wanted
        .iter()
        .filter_map(|w| {
            let usual = robot_kind::typical(w.kind)?;
            let (own, stated) = bodies.of(w.kind, &kinds);
            Some(Robot {
                kind: w.kind.into(),
                count: w.count,
                radius_m: stated.unwrap_or(usual.radius_m),
                height_m: own.height_m.unwrap_or(usual.height_m),
                charging,
                body: (own != RobotBody::default()).then_some(own),
                // its rooms have no ids yet
                stops: Vec::new(),
                room_types: Vec::new(),
                misfit: false,
            })
        })
        .collect()
}

/// Puts together what the prompt and the request say of the bodies of robots.
struct Bodies<'a> {
    request: &'a Request,
    sizes: &'a Sizes,
    robots: &'a Robots,
    conflicts: &'a mut Vec<Note>,
}

impl Bodies<'_> {
    /// Returns the body of robots of one of the kinds that are wanted, and the radius that is planned for, where one of its
    /// measures is known: the request's, and where that says nothing the prompt's.
    fn of(&mut self, kind: &str, wanted: &[&str]) -> (RobotBody, Option<f64>) {
        let (said, radius) = self.sizes.of(kind, wanted, self.robots);
        let said = if said.problems().is_empty() {
            said
        } else {
            let problems = said.problems().join("; ");
            self.tell("robot_size", format!("{problems}; the usual one was taken"));
            RobotBody::default()
        };
        let radius = radius.filter(|r| {
            let plausible = (0.05..=2.0).contains(r);
            if !plausible {
                let message = format!("a robot radius of {r} m is outside 0.05-2 m; the usual one was taken");
                self.tell("robot_radius", message);
            }
            plausible
        });
        let Request { robot: flags, robot_radius_m: flag, .. } = self.request;
        let other = |a: Option<f64>, b: Option<f64>| Some(a.zip(b)?).filter(|(a, b)| (a - b).abs() > 1e-9);
        if let Some((flag, named)) = other(*flag, radius) {
            let message = format!("the prompt says {named} m robot radius, the request {flag} m; {flag} m was used");
            self.tell("radius_flag", message);
        }
        for (name, flag, named) in [
            ("width", flags.width_m, said.width_m),
            ("length", flags.length_m, said.length_m),
            ("height", flags.height_m, said.height_m),
            ("turning radius", flags.turning_radius_m, said.turning_radius_m),
            ("climb", flags.climb_m, said.climb_m),
        ] {
            if let Some((flag, named)) = other(flag, named) {
                let message =
                    format!("the prompt says {named} m robot {name}, the request {flag} m; {flag} m was used");
                self.tell("robot_flag", message);
            }
        }
        let own = flags.or(said);
        // one that is told by its circle alone has no body
        (own, flag.or(flags.radius_m().and(own.radius_m())).or(radius).or(own.radius_m()))
    }

    fn tell(&mut self, code: &str, message: String) {
        if !self.conflicts.iter().any(|note| note.message == message) {
            self.conflicts.push(Note::new(code, message));
        }
    }
}

/// Where the prompt has robots go: room types, and whether to the entrance.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Errand {
    pub room_types: Vec<String>,
    pub entrance: bool,
}

/// Reads what one robot does between rooms: "a delivery robot that brings parcels from the entrance to kitchen and study".
pub(crate) fn errand(robots: &Robots, tokens: &[Token], mentions: &[Mention], spoken: &[&Spoken]) -> Errand {
    let mut out = Errand::default();
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    let carries = [Tag::DeliverVerbs, Tag::TransportVerbs, Tag::ServeVerbs];
    let [robot] = robots.spans.as_slice() else { return out };
    let ends = |i: &usize| !(tokens[*i].ends_sentence() || tokens[*i].mark() == Some(':'));
    let clause = robot.start..(robot.end..tokens.len()).take_while(ends).last().map_or(robot.end, |i| i + 1);
    let Some(verb) = (robot.end..clause.end).find(|&i| carries.iter().any(|&t| tagged(i, t))) else { return out };
    // "from ... to ...": what stands before such a word is no place that it goes to
    let leads = |i: usize| tagged(i, Tag::PlaceBefore) || tagged(i, Tag::Stops) && !tagged(i, Tag::Joins);
    let Some(first) = (verb + 1..clause.end).find(|&i| leads(i)) else { return out };
    let mut last = first;
    for m in mentions.iter().filter(|m| m.span.start > first && m.span.end <= clause.end) {
        let gap = last..m.from.min(m.span.start);
        // a list of rooms goes on behind the errand
        let comma = gap.clone().any(|i| tokens[i].is_mark());
        if comma && out.room_types.len() + usize::from(out.entrance) > 1 || m.count.is_some() && !m.article {
            break;
        }
        match &m.what {
            What::Entrance => out.entrance = true,
            What::Room(id) if !out.room_types.contains(id) => out.room_types.push(id.clone()),
            _ => {}
        }
        last = m.span.end;
    }
    if out.room_types.len() + usize::from(out.entrance) < 2 { Errand::default() } else { out }
}

/// Gives each robot of an errand the rooms it goes to.
pub(crate) fn send(errands: &[Errand], rooms: &[GraphRoom], robots: &mut [Robot]) {
    for (robot, errand) in robots.iter_mut().zip(errands) {
        let goes = |r: &&GraphRoom| errand.entrance && r.entrance || errand.room_types.contains(&r.room_type);
        robot.stops = rooms.iter().filter(goes).map(|r| r.id.clone()).collect();
    }
}

/// A prompt with its tokens.
pub(crate) struct Prompt<'a> {
    pub text: &'a str,
    pub tokens: &'a [Token],
}

impl Prompt<'_> {
    /// Returns the words of a span as the prompt has them.
    pub(crate) fn words(&self, span: Span) -> &str {
        let (Some(first), Some(last)) = (self.tokens.get(span.start), self.tokens.get(span.end.saturating_sub(1)))
        else {
            return "";
        };
        self.text.get(first.start..last.end).unwrap_or("")
    }
}

fn state_assumed(fleet: &Fleet, prompt: &Prompt, assumptions: &mut Vec<Note>) {
    for assumed in &fleet.assumed {
        let (code, message) = match assumed {
            Assumed::Kind => {
                ("robot_kind", "the prompt does not say what its robots do; service robots were assumed".into())
            }
            Assumed::Shares => {
                ("robot_shares", "the prompt does not say how many robots do which work; they were shared out".into())
            }
            Assumed::Number => (
                "robot_count",
                format!(
                    "the prompt does not say how many robots there are; {SEVERAL} were assumed for robots in the plural, one of each kind where it names several kinds"
                ),
            ),
        };
        assumptions.push(Note::new(code, message));
    }
    for span in &fleet.unknown {
        let kinds = robot_kind::names();
        let message = format!(
            "`{}` is none of the kinds of robots that are planned ({}); a service robot was taken for it",
            prompt.words(*span),
            kinds.join(", ")
        );
        assumptions.push(Note::new("robot_kind", message));
    }
}

/// Returns true for robots in the plural: "cleaning robots", "robots de nettoyage", "Reinigungsrobotern".
fn is_plural(tokens: &[Token]) -> bool {
    let plural = |t: &Token| matches!(t.text.as_str(), "robots" | "bots") || t.text.ends_with("robotern");
    let last = tokens.last().is_some_and(|t| {
        t.kind == Kind::Word && t.text.len() > 3 && t.text.ends_with('s') && !t.text.ends_with("roboters")
    });
    tokens.iter().any(plural) || last
}

/// Returns where the words begin that name a kind of robot which is none of those known: "surgical robot".
fn name_before(tokens: &[Token], at: usize, spoken: &[&Spoken]) -> Option<usize> {
    let name = |i: usize| {
        let token = &tokens[i];
        let known = spoken.iter().any(|s| {
            s.tags.longest_at(tokens, i).is_some()
                || s.numbers.contains_key(&token.text)
                || s.quantities.word(&token.text).is_some()
        });
        token.kind == Kind::Word && token.text.len() > 2 && !known
    };
    let from = (at.saturating_sub(2)..at).rev().take_while(|&i| name(i)).last()?;
    Some(from)
}

/// Reads "Mähroboter", a compound of no kind that is known.
fn compound(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> Option<Named> {
    let text = &tokens[i].text;
    let ends = spoken.iter().filter_map(|s| s.words.phrases.get(&Tag::Robot)).flatten();
    let robot = ends
        .filter(|w| w.ends_with("er") || w.ends_with("ern"))
        .any(|w| text.len() > w.len() + 2 && text.ends_with(w.as_str()));
    robot.then(|| {
        let span = Span { start: i, end: i + 1 };
        Named { span, kind: None, place: false, plural: is_plural(&tokens[i..=i]), shared: false, name_from: Some(i) }
    })
}

/// Returns the kinds that share the word for robots with one behind them: "2 cleaning and 3 delivery robots",
/// "Reinigungs- und Transportroboter".
fn elliptic(tokens: &[Token], found: &[Named], spoken: &[&Spoken]) -> Vec<(Named, Span)> {
    let tagged = |i: usize, tag: Tag| is_tagged(spoken, tokens, i, tag);
    let kind_of = |i: usize| {
        let verb = VERBS.iter().find(|(tag, _)| tagged(i, *tag)).map(|v| v.1);
        verb.filter(|_| tokens[i].kind == Kind::Word && !found.iter().any(|f| f.span.contains(i)))
    };
    let mut out = Vec::new();
    for f in found.iter().filter(|f| f.kind.is_some() && !f.place) {
        let mut at = f.span.start;
        for _ in 0..KINDS.len() {
            // over the number of the kind behind
            let numbered = at.checked_sub(1).filter(|&k| {
                matches!(tokens[k].kind, Kind::Number(_))
                    || spoken.iter().any(|s| s.numbers.contains_key(&tokens[k].text))
            });
            let join = numbered.unwrap_or(at).checked_sub(1);
            let Some(join) =
                join.filter(|&k| tokens[k].mark().is_some_and(|m| m == ',' || m == '/') || tagged(k, Tag::Joins))
            else {
                break;
            };
            let Some((i, kind)) = join.checked_sub(1).and_then(|i| Some((i, kind_of(i)?))) else { break };
            let span = Span { start: i, end: i + 1 };
            let named = Named { span, kind: Some(kind), place: false, plural: true, shared: true, name_from: None };
            out.push((named, f.span));
            at = i;
        }
    }
    out
}

fn add(wanted: &mut Vec<Wanted>, kind: &'static str, count: u32) {
    match wanted.iter_mut().find(|w| w.kind == kind) {
        Some(known) => known.count = known.count.max(count),
        None => wanted.push(Wanted { kind, count }),
    }
}

fn robot_inside(tokens: &[Token], start: usize, end: usize, spoken: &[&Spoken]) -> bool {
    (start..end).any(|i| is_tagged(spoken, tokens, i, Tag::Robot)) || {
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
    range.into_iter().any(|i| is_tagged(spoken, tokens, i, Tag::TableWords))
}
