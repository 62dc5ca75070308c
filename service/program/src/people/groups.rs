//! Rooms by whom they are for: "48 children in 4 groups, each group with its own play room and nap room" has four of each, "a
//! bedroom for each of our three kids" three, and "a bedroom for us, one for guests" two.

use d3dgen_model::domain::{Access, Domain, Program, Zone};
use d3dgen_model::scene_graph::Connector;

use crate::named::mention::{Mention, What};
use crate::named::named_for;
use crate::people::held::Held;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end};
use crate::wished::relations::{Relation, Said, Spread};
use crate::wished::wishes::{Wish, Wishes};

/// Groups that have rooms of their own, at most.
const MOST: i64 = 60;
/// Words between a number and the groups that it counts, at most: "mixed-age".
const MOST_OF_NAME: usize = 2;
/// Words from "each" to the first room, and from one room of the list to the next, at most.
const MOST_TO_FIRST: usize = 6;
const MOST_TO_NEXT: usize = 4;
/// Words from a room to those it is for, at most: "for each one of our".
const MOST_TO_WHOM: usize = 6;
/// What a program calls the room that a group has.
const GROUP: &str = "group";

/// What the reading needs to see.
pub(crate) struct Reader<'a> {
    pub tokens: &'a [Token],
    pub numbers: &'a [Number],
    pub domain: &'a Domain,
    pub program: &'a Program,
    pub spoken: &'a [&'a Spoken],
}

/// People who are counted together.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Group {
    span: Span,
    n: i64,
}

/// What was read of groups.
#[derive(Debug, Default)]
pub(crate) struct Found {
    /// Words that say it.
    pub spans: Vec<Span>,
    /// Rooms for as many as a group has.
    pub held: Vec<Held>,
    /// Types of the rooms that groups are in and that the prompt does not name, with how many groups there are.
    pub rooms: Vec<(String, u32)>,
}

impl Reader<'_> {
    fn tagged(&self, i: usize, tag: Tag) -> Option<usize> {
        tag_end(self.spoken, self.tokens, i, tag)
    }

    /// Returns the end of a word for each of several.
    fn each(&self, i: usize) -> Option<usize> {
        self.tagged(i, Tag::Each).or_else(|| self.tagged(i, Tag::Everyone))
    }

    fn number_at(&self, i: usize) -> Option<&Number> {
        self.numbers.iter().find(|n| n.span.start == i && !n.vague && n.value.fract() == 0.0)
    }

    /// Counts the rooms of groups, and of those that the prompt names one by one.
    pub(crate) fn read(&self, mentions: &mut Vec<Mention>) -> Found {
        let mut found = Found::default();
        for group in self.groups(mentions) {
            self.rooms_of(group, mentions, &mut found);
        }
        self.for_each_of(mentions);
        self.one_for(mentions);
        found
    }

    /// Returns the groups that the prompt counts.
    fn groups(&self, mentions: &[Mention]) -> Vec<Group> {
        let taken = |i: usize| mentions.iter().any(|m| m.room_type().is_some() && m.span.contains(i));
        let group = |number: &Number| {
            let n = number.value as i64;
            let counts = !number.article && !number.vague && number.value.fract() == 0.0 && (2..=MOST).contains(&n);
            // "3 mixed-age groups", "4个班"
            let from = self.tagged(number.span.end, Tag::Counters).unwrap_or(number.span.end);
            let plain = |i: &usize| {
                let parts = [Tag::Stops, Tag::Starts, Tag::Joins];
                self.tokens.get(*i).is_some_and(|t| t.kind == Kind::Word)
                    && !parts.iter().any(|&t| self.tagged(*i, t).is_some())
            };
            let noun = |i: usize| self.tagged(i, Tag::Groups).filter(|_| !taken(i));
            let words = (from..=from + MOST_OF_NAME).take_while(|i| *i == from || plain(&(i - 1)));
            let end = words.into_iter().find_map(noun)?;
            (counts && !taken(number.span.start)).then_some(Group { span: Span { start: number.span.start, end }, n })
        };
        self.numbers.iter().filter_map(group).collect()
    }

    /// Gives every group its rooms: those that each of them is said to have, and the one that it is in.
    fn rooms_of(&self, group: Group, mentions: &mut [Mention], found: &mut Found) {
        let has_heads = self.heads_of_each(group, mentions);
        let people = self.people_of(group, mentions);
        let mut listed = self.listed(group, mentions);
        if listed.is_empty() {
            listed = self.told_before(group, mentions);
            let more = self.with_each(group, mentions).filter(|m| !listed.contains(m));
            listed.extend(more);
        }
        let by_day = |m: &usize| {
            let kind = mentions[*m].room_type().and_then(|id| self.domain.room_type(id));
            kind.is_some_and(|k| k.zone == Zone::Day) || mentions[*m].what == What::Total
        };
        let own = listed.iter().any(by_day);
        for &m in &listed {
            let mention = &mut mentions[m];
            // "each team in its own room"
            if mention.what == What::Total {
                let kind = people.and_then(|n| named_for::with_desks(self.domain, n));
                let Some(id) = kind.map(|k| &k.id).or_else(|| self.program.means.get(GROUP)) else { continue };
                mention.what = What::Room(id.clone());
                let count = group.n as u32;
                found.held.extend(people.map(|beds| Held { room_type: id.clone(), count, beds }));
            }
            let each = mention.count.filter(|n| *n > 0 && !mention.article && !mention.vague).unwrap_or(1);
            (mention.count, mention.article, mention.vague) = (Some(each.saturating_mul(group.n)), false, false);
            mention.plural = true;
        }
        let room = self.program.means.get(GROUP).filter(|_| !own);
        if let Some(id) = room {
            match mentions.iter_mut().find(|m| m.room_type() == Some(id)) {
                Some(known) if known.count.is_none() => known.count = Some(group.n),
                Some(_) => {}
                None => found.rooms.push((id.clone(), group.n as u32)),
            }
        }
        if !listed.is_empty() || room.is_some() || has_heads {
            found.spans.push(group.span);
        }
    }

    /// Returns the people of one group, and counts all: "4 teams of 6 people".
    fn people_of(&self, group: Group, mentions: &mut [Mention]) -> Option<u32> {
        let of = self.tagged(group.span.end, Tag::Stops)?;
        let who = |m: &&mut Mention| matches!(m.what, What::People | What::Staff | What::Visitors) && m.from == of;
        let people = mentions.iter_mut().find(who)?;
        let each = people.count.filter(|n| *n > 0 && !people.article && !people.vague)?;
        people.count = Some(each.saturating_mul(group.n));
        u32::try_from(each).ok()
    }

    /// Counts the desks or people of all groups by those of each: "each team has 8 desks"; returns false where nothing tells.
    fn heads_of_each(&self, group: Group, mentions: &mut [Mention]) -> bool {
        let Some(each) = self.each_has(group, mentions) else { return false };
        let Some(first) = mentions.iter_mut().find(|m| m.span.start >= each) else { return false };
        let heads = matches!(first.what, What::Desks | What::People | What::Staff | What::Visitors);
        let lead = each..first.from;
        let has = lead.len() <= MOST_TO_NEXT && lead.clone().any(|i| self.tagged(i, Tag::Starts).is_some());
        let own = first.count.filter(|n| *n > 0 && heads && has && !first.article && !first.vague);
        first.count = own.map(|n| n.saturating_mul(group.n)).or(first.count);
        own.is_some()
    }

    /// Returns where the words end that give each of the groups something: "each", "each group", not "12 children per group".
    fn each_has(&self, group: Group, mentions: &[Mention]) -> Option<usize> {
        let mut near = true;
        let mut i = group.span.end;
        while i < self.tokens.len() {
            near &= !self.tokens[i].ends_sentence()
                && !mentions.iter().any(|m| m.room_type().is_some() && m.span.contains(i));
            if let Some(end) = self.each(i) {
                let named = self.tagged(end, Tag::Groups);
                if near || named.is_some() {
                    return Some(named.unwrap_or(end));
                }
            }
            i += 1;
        }
        None
    }

    /// Returns the rooms that each of the groups is said to have: those behind that up to the "and" that closes their list.
    fn listed(&self, group: Group, mentions: &[Mention]) -> Vec<usize> {
        let Some(each) = self.each_has(group, mentions) else { return Vec::new() };
        let heads = |m: usize| matches!(mentions[m].what, What::Desks | What::People | What::Staff | What::Visitors);
        let behind = (0..mentions.len()).filter(|&m| mentions[m].span.start >= each);
        // "each with 12 children and its own nap room"
        let behind: Vec<usize> = behind.enumerate().filter(|&(k, m)| k > 0 || !heads(m)).map(|f| f.1).collect();
        let Some(&first) = behind.first() else { return Vec::new() };
        let has = |i: usize| [Tag::Starts, Tag::Own, Tag::Inside].iter().any(|&t| self.tagged(i, t).is_some());
        // "3 groups with one nap room each"
        let lead = each..mentions[first].from;
        let is_room = |m: usize| mentions[m].room_type().is_some() || mentions[m].what == What::Total;
        let goes = lead.len() <= MOST_TO_FIRST
            && lead.clone().any(has)
            && !lead.into_iter().any(|i| self.tokens[i].ends_sentence());
        // "mit je einem Schlafraum", "with one each": what leads there stands before "each"
        let before = (group.span.end..each).any(has) && mentions[first].from <= each + 1;
        if !is_room(first) || !(goes || before) {
            return Vec::new();
        }
        self.closed_list(&behind, mentions, is_room)
    }

    /// Returns the first rooms of a list as far as they are of one form and closed by "and": of "its own play room, nap room
    /// and toilet, one kitchen" three, of "its own nap room, a kitchen" one.
    fn closed_list(&self, behind: &[usize], mentions: &[Mention], is_room: impl Fn(usize) -> bool) -> Vec<usize> {
        let counted = |m: usize| mentions[m].count.is_some();
        let first = behind[0];
        let (mut out, mut closed) = (vec![first], 1);
        for pair in behind.windows(2) {
            let (last, m) = (pair[0], pair[1]);
            let gap = mentions[last].end()..mentions[m].from;
            let joins = gap.clone().any(|i| self.tagged(i, Tag::Joins).is_some());
            let ends = gap.clone().any(|i| self.tokens[i].ends_sentence());
            let form = !counted(m) || counted(first);
            if gap.len() > MOST_TO_NEXT || ends || !form || !is_room(m) || mentions[m].definite {
                break;
            }
            out.push(m);
            if joins {
                closed = out.len();
                break;
            }
        }
        out.truncate(closed);
        out
    }

    /// Returns the room before "each" of "4 groups with a nap room each".
    fn with_each(&self, group: Group, mentions: &[Mention]) -> Option<usize> {
        let m = mentions.iter().position(|m| m.span.start >= group.span.end)?;
        let mut lead = group.span.end..mentions[m].from;
        let has = lead.len() <= MOST_TO_NEXT && lead.any(|i| self.tagged(i, Tag::Starts).is_some());
        (has && mentions[m].room_type().is_some() && self.each(mentions[m].span.end).is_some()).then_some(m)
    }

    /// Returns the room before "per group", "for each group".
    fn told_before(&self, group: Group, mentions: &[Mention]) -> Vec<usize> {
        let per = |i: usize| {
            let each = self.each(self.tagged(i, Tag::For).unwrap_or(i))?;
            self.tagged(each, Tag::Groups)
        };
        let told = |m: &Mention| m.room_type().is_some() && m.span.end < self.tokens.len() && per(m.span.end).is_some();
        let here = |m: &usize| told(&mentions[*m]) && !mentions[*m].span.overlaps(group.span);
        (0..mentions.len()).filter(here).collect()
    }

    /// Counts rooms of which each of a number has one: "a bedroom for each of our three kids".
    fn for_each_of(&self, mentions: &mut [Mention]) {
        let heads: Vec<(Span, i64)> = mentions
            .iter()
            .filter(|m| m.room_type().is_none() && !m.article && !m.vague)
            .filter_map(|m| Some((m.span, m.count.filter(|n| (2..=MOST).contains(n))?)))
            .collect();
        for m in mentions.iter_mut().filter(|m| m.room_type().is_some()) {
            let open = m.count.is_none_or(|n| n == 1) && !m.vague;
            let told = || self.each_child(m.span.end, &heads).or_else(|| self.those_before(m, &heads));
            if let Some(n) = self.each_of(m.span.end).or_else(told).filter(|_| open) {
                (m.count, m.article, m.plural) = (Some(n), false, true);
            }
        }
    }

    /// Returns the number of children that the prompt counts elsewhere: "a bedroom for each child".
    fn each_child(&self, i: usize, heads: &[(Span, i64)]) -> Option<i64> {
        let each = self.each(self.tagged(i, Tag::For)?)?;
        self.tagged(each, Tag::Children)?;
        heads.iter().find(|(span, _)| self.tagged(span.start, Tag::Children).is_some()).map(|(_, n)| *n)
    }

    /// Returns the number of those right before that have one room each: "三个孩子每人一间卧室", "three kids each one bedroom".
    fn those_before(&self, room: &Mention, heads: &[(Span, i64)]) -> Option<i64> {
        let one = room.count == Some(1);
        let (span, n) = heads.iter().rev().find(|(span, _)| span.end <= room.from && one)?;
        let each = self.each(span.end)?;
        let to = self.tagged(each, Tag::People).unwrap_or(each);
        (to == room.from).then_some(*n)
    }

    /// Returns the number of "for each of our three".
    fn each_of(&self, i: usize) -> Option<i64> {
        let to = self.tagged(i, Tag::For)?;
        let words = || (to..(to + MOST_TO_WHOM).min(self.tokens.len())).take_while(|&k| !self.tokens[k].is_mark());
        let number = words().find_map(|k| self.number_at(k).filter(|n| !n.article && n.value > 1.0))?;
        let each = words().take_while(|&k| k < number.span.start).any(|k| self.each(k).is_some());
        Some(number.value as i64).filter(|n| each && (2..=MOST).contains(n))
    }

    /// Adds the rooms of "a bedroom for us, one for each of our three kids, one for guests", of which only the number is named.
    fn one_for(&self, mentions: &mut Vec<Mention>) {
        let taken = |n: &Number| mentions.iter().any(|m| m.number == Some(n.span) || m.span.overlaps(n.span));
        let alone = |n: &&Number| !n.vague && !taken(n) && n.value >= 1.0 && n.value <= MOST as f64;
        let numbers: Vec<Number> = self.numbers.iter().filter(alone).copied().collect();
        let is_for = |i: usize| self.tagged(i, Tag::For).is_some();
        for number in numbers.into_iter().filter(|n| is_for(n.span.end)) {
            let last = mentions.iter().rposition(|m| m.room_type().is_some() && m.span.end <= number.span.start);
            let Some(last) = last else { continue };
            let room = &mentions[last];
            // "3 bedrooms, one for guests" has three
            let gap = room.span.end..number.span.start;
            let goes_on = is_for(room.span.end) && !gap.into_iter().any(|i| self.tokens[i].ends_sentence());
            if !goes_on {
                continue;
            }
            let count = self.each_of(number.span.end).filter(|_| number.value == 1.0).unwrap_or(number.value as i64);
            let plain = Mention::plain(number.span, room.what.clone());
            let more = Mention { count: Some(count), number: Some(number.span), plural: count > 1, ..plain };
            mentions.insert(last + 1, more);
        }
    }
}

/// Wishes for the rooms that groups are in.
pub(crate) fn house(rooms: &[(String, u32)], wishes: &mut Wishes, domain: &Domain) {
    for (id, count) in rooms {
        let settled = wishes.forbidden.contains(id) || wishes.wishes.iter().any(|w| &w.room_type == id);
        if let Some(kind) = domain.room_type(id).filter(|_| !settled) {
            let one = Wish::one(id, &kind.label.to_lowercase());
            wishes.wishes.push(Wish { count: *count, exact: true, listed: true, ..one });
        }
    }
}

/// Gives each of several rooms all that is joined to what it has: "each of 3 bedrooms has its own bathroom and balcony".
pub(crate) fn belong_together(
    tokens: &[Token],
    mentions: &[Mention],
    domain: &Domain,
    spoken: &[&Spoken],
    said: &mut Said,
) {
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    let entered = |m: usize, host: usize| {
        let kind = mentions[m].room_type().and_then(|id| domain.room_type(id));
        let from = mentions[host].room_type();
        kind.is_some_and(|k| k.access == Access::Host && k.hosts.iter().any(|h| Some(h.as_str()) == from))
    };
    for (first, host) in said.each.clone() {
        for m in first + 1..mentions.len() {
            let gap = mentions[m - 1].end()..mentions[m].from;
            let next = gap.len() <= MOST_OF_NAME
                && gap.clone().all(|i| tokens[i].mark() == Some(',') || tagged(i, Tag::Joins) || tagged(i, Tag::Own));
            let bare = mentions[m].count.is_none_or(|n| n == 1 && mentions[m].article);
            let known = said.each.iter().any(|e| e.0 == m) || said.negated.contains(&m);
            if !next || !bare || known || !entered(m, host) {
                break;
            }
            said.each.push((m, host));
            let (connector, spread) = (Connector::Door, Spread::Each);
            said.relations.push(Relation { subject: m, object: host, connector, spread, apart: false, belongs: true });
        }
    }
}
