//! Places that the prompt gives a room: "boardroom for 16", "waiting area with 40 seats", "hot desks for 30", "6 agents open
//! plan", "counter hall with 6 service windows". They are no staff of the building and no rooms of their own.

use d3dgen_model::domain::{Arrangement, Domain, Furnishing, Program, RoomType, Shape, Zone};
use d3dgen_model::offer;
use d3dgen_model::offer::{has_counters, most_desks, seating, seats_of, works_in};
use d3dgen_model::placements::Placements;
use d3dgen_model::scene_graph::{GraphRoom, Note, SceneGraph};

use crate::named::mention::{Mention, What};
use crate::named::unknown;
use crate::people::held::Held;
use crate::subject::programs::is_office;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, tag_end, words};

/// Words between a room and the number of its places, at most: "with seating for up to".
const MOST_BETWEEN: usize = 4;
/// Words between a number and the counters that it counts, at most: "6 modern service windows".
const MOST_TO_COUNTERS: usize = 2;
/// Words before a word for a room that are of its name, at most: "model making workshop".
const MOST_BEFORE: usize = 2;
/// Most places of one room that are taken at their word.
const MOST_PLACES: i64 = 500;
/// Most people at the one table of a room that no domain knows.
const MOST_AT_TABLE: u32 = 30;

/// What a prompt says about places.
#[derive(Debug, Default)]
pub(crate) struct Found {
    /// Rooms with so many desks.
    pub desks: Vec<Held>,
    /// Rooms with so many seats or counters.
    pub seats: Vec<Held>,
    /// Types of rooms that those who work there are shared out to: "half open plan, half offices".
    pub halves: Vec<String>,
    /// Words that are read.
    pub spans: Vec<Span>,
}

/// What the reading needs to see.
pub(crate) struct Reader<'a> {
    pub tokens: &'a [Token],
    pub numbers: &'a [Number],
    pub domain: &'a Domain,
    pub program: &'a Program,
    pub spoken: &'a [&'a Spoken],
    /// Places, areas, robots, the name of the building.
    pub taken: &'a [Span],
    /// Rooms of which the desks are read already: "three team offices for 6 people each".
    pub seated: &'a [Held],
}

impl Reader<'_> {
    /// Gives the rooms their places; what is read leaves the head counts.
    pub(crate) fn read(&self, mentions: &mut Vec<Mention>) -> Found {
        let mut out = Found::default();
        self.counters(mentions, &mut out);
        let mut gone: Vec<usize> = Vec::new();
        for m in 0..mentions.len() {
            if let Some((kind, n, noun)) = self.meets(mentions, m) {
                mentions[m].what = What::Room(kind.id.clone());
                out.seats.push(Held { room_type: kind.id.clone(), count: 1, beds: n });
                gone.extend(noun);
                continue;
            }
            let Some(kind) = mentions[m].room_type().and_then(|id| self.domain.room_type(id)) else { continue };
            let seated = self.seated.iter().any(|s| s.room_type == kind.id);
            if seated || mentions[m].beds.is_some() || mentions[m].places.is_some() {
                continue;
            }
            // "recovery for six": they lie there, each at a place of their own
            if offer::places(self.domain, kind).is_some() {
                let found = self.after(mentions, m).or_else(|| self.before(mentions, m));
                if let Some((n, noun)) = found.filter(|f| (1..=MOST_PLACES).contains(&f.0)) {
                    mentions[m].places = Some(n as u32);
                    gone.extend(noun);
                }
                continue;
            }
            let (desks, seats) = (most_desks(self.domain, kind), seating(self.domain, kind, 1).is_some());
            // "an office with workshop for 15 people" is for so many
            if desks == 0 && (!seats || kind.zone == Zone::Service) {
                continue;
            }
            let team = |m: &Mention| desks > 2 && !m.plural && self.workers_before(m);
            let found = if team(&mentions[m]) {
                let count = mentions[m].count.filter(|n| *n > 0);
                (mentions[m].count, mentions[m].number) = (None, None);
                count.map(|n| (n, None))
            } else {
                let found = self.after(mentions, m).or_else(|| self.before(mentions, m));
                found.or_else(|| self.desks_in(mentions, m).filter(|_| desks > 2))
            };
            let Some((n, noun)) = found else { continue };
            let Some(n) = Some(n).filter(|n| (1..=MOST_PLACES).contains(n)).map(|n| n as u32) else { continue };
            let mention = mentions[m].clone();
            let counted = mention.count.filter(|n| *n > 0 && !mention.article).map(|n| n.min(MOST_PLACES) as u32);
            if counted.is_none() && mention.plural && desks == 0 {
                continue;
            }
            let (id, rooms) = (kind.id.clone(), counted.unwrap_or(1));
            // "4 offices for 8 people" share them; "two meeting rooms for 6" have as many each, and so have "8 offices for 4"
            let least = offer::desks(self.domain, kind).map_or(1, |d| d[0]);
            let shared = desks > 0 && n.div_ceil(rooms) >= least && n >= rooms;
            let each = if shared { n.div_ceil(rooms) } else { n };
            let held = Held { room_type: id, count: rooms, beds: each };
            if desks == 0 {
                out.seats.push(held);
                // who meets or waits there is not who works there
                gone.extend(noun);
                continue;
            }
            if desks > 2 || each <= desks || counted.is_some() || !mention.plural {
                // "newsroom for 20", "private offices for 4" are larger than such rooms are otherwise
                let larger = self.larger(each).filter(|_| each > desks);
                if larger.is_none() && each > desks && desks <= 2 {
                    continue;
                }
                let held = Held { room_type: larger.map_or(held.room_type, |k| k.id.clone()), ..held };
                mentions[m].what = What::Room(held.room_type.clone());
                // hot desks are one room
                if desks > 2 && counted.is_none() && mention.plural {
                    (mentions[m].count, mentions[m].plural) = (Some(1), false);
                }
                out.desks.push(held);
            }
        }
        let mut at = 0;
        mentions.retain(|_| {
            at += 1;
            !gone.contains(&(at - 1))
        });
        out.halves = self.halves(mentions);
        out
    }

    /// Returns the type of room that an unknown one for so many people is, "signing room for 12 people": they sit around
    /// one table there, and are none who work in the building.
    fn meets(&self, mentions: &[Mention], m: usize) -> Option<(&RoomType, u32, Option<usize>)> {
        let mention = &mentions[m];
        let id = mention.room_type().filter(|id| self.domain.room_type(id).is_none() && is_office(self.program))?;
        let one = mention.count.is_none_or(|n| n == 1) && !mention.plural;
        if !one || !unknown::is_name_of(self.tokens, mention.span, id) {
            return None;
        }
        let (n, noun) = self.after(mentions, m).or_else(|| self.before(mentions, m))?;
        let n = u32::try_from(n).ok().filter(|n| (2..=MOST_AT_TABLE).contains(n))?;
        let at_table = |k: &&RoomType| {
            let table = |f: &Furnishing| f.max == 1 && f.required && f.arrangement == Arrangement::Center;
            k.furnishing.iter().any(table) && seating(self.domain, k, n).is_some_and(|s| (n..500).contains(&s.most))
        };
        let listed = |k: &&RoomType| self.domain.programs.iter().flat_map(|p| &p.rooms).any(|e| e.room_type == k.id);
        let kinds = self.domain.room_types.iter().filter(listed).filter(at_table);
        let kind = kinds.min_by_key(|k| seating(self.domain, k, n).map(|s| s.most))?;
        Some((kind, n, noun))
    }

    fn tagged(&self, i: usize, tag: Tag) -> Option<usize> {
        tag_end(self.spoken, self.tokens, i, tag)
    }

    fn any(&self, i: usize, tags: &[Tag]) -> bool {
        tags.iter().any(|&t| self.tagged(i, t).is_some())
    }

    /// Returns the smallest type of rooms to work in that holds so many desks, of those that a program of the domain has.
    fn larger(&self, desks: u32) -> Option<&RoomType> {
        let kinds = self.domain.room_types.iter().filter(|k| most_desks(self.domain, k) >= desks);
        let listed = |k: &&RoomType| self.domain.programs.iter().flat_map(|p| &p.rooms).any(|e| e.room_type == k.id);
        kinds.filter(listed).min_by_key(|k| most_desks(self.domain, k))
    }

    /// Returns true for "6 agents open plan": the number counts who works there.
    fn workers_before(&self, m: &Mention) -> bool {
        let Some(number) = m.number.filter(|n| n.end < m.span.start && !m.article && !m.vague) else { return false };
        let plural = |i: usize| self.tokens[i].text.ends_with(['s', 'n', 'r']);
        (number.end..m.span.start).any(|i| plural(i) && self.any(i, &[Tag::Staff, Tag::People]))
    }

    /// Returns the number behind a room, and the mention of who sits there: "for 16", "with seats for 40 people".
    fn after(&self, mentions: &[Mention], m: usize) -> Option<(i64, Option<usize>)> {
        let start = mentions[m].span.end;
        let number = self.numbers.iter().find(|n| n.span.start > start && n.span.start <= start + MOST_BETWEEN)?;
        if number.article || number.vague || number.value.fract() != 0.0 || self.overlaps_taken(number.span) {
            return None;
        }
        let gap = start..number.span.start;
        let leads = |i: usize| self.any(i, &[Tag::Stops, Tag::Starts, Tag::VisitorsBefore, Tag::Measure]);
        let joins = |i: usize| self.any(i, &[Tag::Joins, Tag::No, Tag::Near, Tag::Inside]) && !self.is_for(i);
        // "waiting area (40 seats)": a bracket is a mark
        let bracket = gap.len() == 1 && self.tokens[start].is_mark();
        let words = gap.clone().all(|i| !self.tokens[i].is_mark()) && leads(start) && !gap.clone().any(joins);
        let end = number.span.end;
        let noun = mentions.iter().position(|o| o.from == number.span.start && o.room_type().is_none());
        let people = noun.filter(|&k| {
            matches!(mentions[k].what, What::People | What::Visitors | What::Staff)
                || mentions[k].what == What::Desks && !bracket
        });
        let closed = self.tokens.get(end).is_none_or(Token::is_mark) || self.any(end, &[Tag::Joins]);
        // "for 16": nothing else is counted
        let bare = noun.is_none() && closed && self.is_for(start);
        let held = people.is_some_and(|k| mentions[k].what != What::Desks);
        ((words && (bare || held)) || bracket && held && self.is_seat_word(mentions, people))
            .then_some((number.value as i64, people))
    }

    /// Returns true for seats and people behind a room in brackets.
    fn is_seat_word(&self, mentions: &[Mention], noun: Option<usize>) -> bool {
        let bracketed = noun.map(|k| mentions[k].span.end);
        bracketed.is_some_and(|end| self.tokens.get(end).is_none_or(Token::is_mark))
            && noun.is_some_and(|k| self.any(mentions[k].span.start, &[Tag::Holds, Tag::Visitors]))
    }

    /// Returns true for words that say whom a room is for.
    fn is_for(&self, i: usize) -> bool {
        self.tokens.get(i).is_some_and(|t| matches!(t.text.as_str(), "for" | "fur" | "pour" | "para" | "seating"))
    }

    /// Returns the number in "12-person meeting room".
    fn before(&self, mentions: &[Mention], m: usize) -> Option<(i64, Option<usize>)> {
        let start = mentions[m].from.min(mentions[m].span.start);
        let hyphen = |i: &usize| self.tokens[*i].mark() == Some('-');
        let mut back = (0..start).rev().filter(|i| !hyphen(i));
        let noun = back.next().filter(|&i| self.tagged(i, Tag::Holds).is_some())?;
        let last = back.next()?;
        let number = self.numbers.iter().find(|n| n.span.end == last + 1 && !n.article && !n.vague)?;
        (!self.overlaps_taken(number.span)).then(|| {
            let who = mentions.iter().position(|o| o.span.start == noun && o.room_type().is_none());
            (number.value as i64, who)
        })
    }

    /// Returns the number in "40 desks in an open space".
    fn desks_in(&self, mentions: &[Mention], m: usize) -> Option<(i64, Option<usize>)> {
        let start = mentions[m].from.min(mentions[m].span.start);
        let beside = |o: &Mention| o.span.end + 1 == start && self.tagged(o.span.end, Tag::Inside).is_some();
        let desks = mentions.iter().find(|o| o.what == What::Desks && !o.article && !o.vague && beside(o))?;
        desks.count.map(|n| (n, None))
    }

    fn overlaps_taken(&self, span: Span) -> bool {
        self.taken.iter().any(|s| s.overlaps(span))
    }

    /// Reads counters: those of the room they are named with, else a room for them is meant.
    fn counters(&self, mentions: &mut Vec<Mention>, out: &mut Found) {
        let has = |kind: &RoomType| has_counters(self.domain, kind);
        let own = |id: &str| self.domain.room_type(id).is_some_and(has);
        let listed = self.program.rooms.iter().map(|e| e.room_type.as_str()).find(|id| own(id));
        let Some(usual) =
            listed.map(str::to_owned).or_else(|| self.domain.room_types.iter().find(|k| has(k)).map(|k| k.id.clone()))
        else {
            return;
        };
        let mut i = 0;
        while i < self.tokens.len() {
            let Some(end) = self.tagged(i, Tag::ServicePoints) else {
                i += 1;
                continue;
            };
            let span = Span { start: i, end };
            // "customer service counter hall" is a room, whatever stands in it
            let is_room = |m: &Mention| m.room_type().is_some_and(|id| self.domain.room_type(id).is_some());
            // "8 Schalter" are in one hall, also where the hall goes by that word
            let several = |m: &Mention| m.count.is_some_and(|n| (2..=MOST_PLACES).contains(&n));
            let hall = |m: &Mention| is_room(m) && several(m) && m.span.start >= i && m.span.end <= end;
            if let Some(m) = mentions.iter_mut().find(|m| hall(m)) {
                let id = m.room_type().filter(|id| own(id)).unwrap_or(&usual).to_owned();
                let count = m.count.take().map_or(1, |n| n as u32);
                (m.what, m.plural) = (What::Room(id.clone()), false);
                out.seats.push(Held { room_type: id, count: 1, beds: count });
                i = end;
                continue;
            }
            let inside = mentions.iter().any(|m| is_room(m) && m.span.overlaps(span));
            i = end;
            if inside || self.overlaps_taken(span) {
                continue;
            }
            let number = (0..=MOST_TO_COUNTERS).find_map(|gap| {
                let at = span.start.checked_sub(gap)?;
                let parted =
                    (at..span.start).any(|k| self.tokens[k].is_mark() || self.any(k, &[Tag::Stops, Tag::Joins]));
                self.numbers.iter().find(|n| n.span.end == at && !n.article && !n.vague && !parted)
            });
            out.spans.push(Span { start: number.map_or(span.start, |n| n.span.start), end });
            mentions.retain(|m| is_room(m) || !m.span.overlaps(span));
            let count = number.map(|n| n.value as i64).filter(|n| (1..=MOST_PLACES).contains(n)).map(|n| n as u32);
            let place = |m: &Mention| m.room_type().is_some_and(own);
            let before = mentions.iter().rposition(|m| m.span.end <= span.start && place(m));
            let room = before.or_else(|| mentions.iter().position(place));
            let id = match room {
                Some(m) => mentions[m].room_type().unwrap_or(&usual).to_owned(),
                None => {
                    let at = mentions.iter().position(|m| m.span.start >= end).unwrap_or(mentions.len());
                    let from = number.map_or(span.start, |n| n.span.start);
                    mentions.insert(at, Mention { from, ..Mention::plain(span, What::Room(usual.clone())) });
                    usual.clone()
                }
            };
            // "teller counters": two at least
            let plural = self.tokens[end - 1].text.ends_with(['s', 'n']);
            let count = count.or(plural.then_some(2));
            out.seats.extend(count.map(|n| Held { room_type: id, count: 1, beds: n }));
        }
    }

    /// Returns the types of rooms in "half open plan, half offices".
    fn halves(&self, mentions: &[Mention]) -> Vec<String> {
        let half = |m: &&Mention| {
            (m.from.saturating_sub(3)..m.from).any(|i| self.tagged(i, Tag::Half).is_some_and(|end| end == m.from))
        };
        let mut all: Vec<String> =
            mentions.iter().filter(half).filter_map(|m| m.room_type().map(str::to_owned)).collect();
        all.dedup();
        if all.len() == 2 { all } else { Vec::new() }
    }
}

/// A room as the prompt calls it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Called {
    pub span: Span,
    pub room_type: String,
    pub name: String,
    /// Rooms with this name.
    pub count: u32,
}

/// Returns what the prompt calls its rooms, in its order; plural words only where they are counted, in English, whose
/// singular is plain.
pub(crate) fn called(
    tokens: &[Token],
    prompt: &str,
    mentions: &[Mention],
    spoken: &[&Spoken],
    language: &str,
) -> Vec<Called> {
    let known = |i: usize| {
        let text = &tokens[i].text;
        spoken.iter().any(|s| {
            s.tags.longest_at(tokens, i).is_some()
                || s.numbers.contains_key(text)
                || s.quantities.longest_at(tokens, i).is_some()
        })
    };
    let mut out = Vec::new();
    for m in mentions {
        let Some(id) = m.room_type() else { continue };
        let several = m.count.filter(|n| *n > 1 && !m.article);
        // "billing office" is one word for a room more than is known
        let free =
            |i: &usize| tokens[*i].kind == Kind::Word && !known(*i) && !mentions.iter().any(|o| o.span.contains(*i));
        let qualified = language == "en" && m.count.is_none_or(|n| n == 1 && !m.article);
        let from = m.span.start.saturating_sub(if qualified { MOST_BEFORE } else { 0 });
        let start = (from..m.span.start).rev().take_while(free).last().unwrap_or(m.span.start);
        // "print/plot room"
        let slash = |at: usize| at.checked_sub(2).filter(|_| tokens[at - 1].mark() == Some('/')).filter(free);
        let start = slash(start).unwrap_or(start);
        let words = prompt.get(tokens[start].start..tokens[m.span.end - 1].end).unwrap_or("").trim();
        let plural = several.is_some() || m.plural;
        if words.is_empty() || plural && (several.is_none() || language != "en") {
            continue;
        }
        let singular = if plural { words.strip_suffix('s').unwrap_or(words) } else { words };
        let mut letters = singular.chars();
        let name = letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect());
        let span = Span { start, end: m.span.end };
        out.push(Called {
            span,
            room_type: id.to_owned(),
            name,
            count: several.map_or(1, |n| n.clamp(1, MOST_PLACES) as u32),
        });
    }
    out
}

/// A room that has fewer places than it is for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Short {
    /// Id of the room.
    pub room_id: String,
    /// Its name on the plan.
    pub name: String,
    /// Places that it is for.
    pub wanted: u32,
    /// Places that stand in it.
    pub have: u32,
    /// What they are: seats, desks, counters or places.
    pub what: &'static str,
}

/// Returns what a graph says of rooms with fewer places than they are for.
pub fn shortages(domain: &Domain, graph: &SceneGraph, placements: &Placements) -> Vec<Note> {
    let said =
        |s: Short| Note::new("too_few_places", format!("{} is for {} and has {} {}", s.name, s.wanted, s.have, s.what));
    short_rooms(domain, graph, placements).into_iter().map(said).collect()
}

/// Returns the rooms with fewer places than they are for.
pub fn short_rooms(domain: &Domain, graph: &SceneGraph, placements: &Placements) -> Vec<Short> {
    let short = |room: &GraphRoom| {
        let kind = domain.room_type_or_lent(&room.room_type)?;
        // nobody counts the chairs of those who eat in turns
        let eats = words().eating.contains_key(&room.room_type);
        let wanted = room.occupants.filter(|_| kind.zone != Zone::Night && !eats)?;
        let (have, what) = places_in(domain, kind, &room.id, placements)?;
        let (room_id, name) = (room.id.clone(), room.name.clone());
        (have < wanted).then_some(Short { room_id, name, wanted, have, what })
    };
    graph.rooms.iter().filter_map(short).collect()
}

/// Returns how many places of what stand in a room; `None` for rooms that nobody counts places of.
fn places_in(domain: &Domain, kind: &RoomType, room_id: &str, placements: &Placements) -> Option<(u32, &'static str)> {
    let here = || placements.placements.iter().filter(|p| p.room_id == room_id);
    let count = |shapes: &[Shape]| -> u32 {
        here().filter(|p| domain.object(&p.object).is_some_and(|o| shapes.contains(&o.shape))).count() as u32
    };
    if let Some(of) = offer::places(domain, kind).filter(|_| !kind.places.is_empty()) {
        let anchor = domain.anchor(&of.line.item)?;
        Some((of.each * here().filter(|p| p.object == anchor.id).count() as u32, "places"))
    } else if works_in(domain, kind) {
        Some((count(&[Shape::Desk]), "desks"))
    } else if has_counters(domain, kind) {
        Some((count(&[Shape::Counter]), "counters"))
    } else {
        seating(domain, kind, 1)?;
        Some((here().map(|p| seats_of(domain, &p.object)).sum(), "seats"))
    }
}
