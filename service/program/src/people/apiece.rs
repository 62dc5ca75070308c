//! Offices by who works in them: "8 lawyers, each with a private office", "jeder Anwalt ein Einzelbüro", "un bureau par
//! avocat" are 8 single offices; "24 hot desks, five team offices" has an open area beside the team offices.

use d3dgen_model::domain::{Domain, Program, RoomType};
use d3dgen_model::offer;
use d3dgen_model::offer::{MOST_IN_TEAM, most_desks};

use crate::named::mention::{Mention, What};
use crate::named::named_for;
use crate::people::held::Held;
use crate::subject::programs::is_office;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, tag_end};

/// Words from those who have an office to the word for it, at most: "each of them with their own spacious private office".
const MOST_TO_OFFICE: usize = 7;
/// Words from "with" to "own offices", at most.
const MOST_TO_OWN: usize = 3;
/// Words from an office to whose it is, at most: "a private office for each of the 8 lawyers".
const MOST_TO_WHOM: usize = 6;
/// Words before an office that say whose it is, and behind it, at most: "offices for two of the associates".
const MOST_OF_OWNER: usize = 2;
const MOST_TO_OWNER: usize = 5;
/// Words between two titles of one list, at most: "and", a comma.
const LIST_GAP: usize = 2;
/// Words of a title, at most: "senior team leaders".
const MOST_OF_TITLE: usize = 3;
/// Most people who have an office each.
const MOST: i64 = 60;

/// What the reading needs to see.
pub(crate) struct Reader<'a> {
    pub tokens: &'a [Token],
    pub numbers: &'a [Number],
    pub domain: &'a Domain,
    pub program: &'a Program,
    pub spoken: &'a [&'a Spoken],
    pub list_from: usize,
}

impl Reader<'_> {
    fn tagged(&self, i: usize, tag: Tag) -> Option<usize> {
        tag_end(self.spoken, self.tokens, i, tag)
    }

    /// Returns the domain's office for one.
    fn single(&self) -> Option<&RoomType> {
        self.domain.room_types.iter().find(|k| most_desks(self.domain, k) == 1)
    }

    fn is_single(&self, m: &Mention) -> bool {
        let kind = m.room_type().and_then(|id| self.domain.room_type(id));
        kind.is_some_and(|k| most_desks(self.domain, k) == 1)
    }

    /// Gives everyone an office who is said to have one; returns the offices, and the words that say so.
    pub(crate) fn each_an_office(&self, mentions: &mut Vec<Mention>) -> (Vec<Held>, Vec<Span>) {
        let (mut held, mut spans) = (Vec::new(), Vec::new());
        if !is_office(self.program) {
            return (held, spans);
        }
        let groups = self.groups(mentions);
        for (k, &(group, n)) in groups.iter().enumerate() {
            let until = groups.get(k + 1).map_or(self.tokens.len(), |g| g.0.start);
            let Some(office) = self.office_of(mentions, group, until) else { continue };
            let Some(kind) = self.single() else { continue };
            spans.push(Span { start: group.start.min(office.start), end: group.end.max(office.end) });
            let known = mentions.iter_mut().find(|m| m.span == office);
            let id = match known {
                Some(m) => {
                    (m.count, m.article, m.vague, m.plural) = (Some(n), false, false, true);
                    m.room_type().unwrap_or(&kind.id).to_owned()
                }
                None => {
                    let at = mentions.iter().position(|m| m.span.start > office.start).unwrap_or(mentions.len());
                    let plain = Mention::plain(office, What::Room(kind.id.clone()));
                    mentions.insert(at, Mention { count: Some(n), plural: true, ..plain });
                    kind.id.clone()
                }
            };
            held.push(Held { room_type: id, count: n as u32, beds: 1 });
        }
        (held, spans)
    }

    /// Gives offices to those whom a title names again: "5 partners, 12 associates: a corner office for each partner, shared
    /// associate offices for two" are 5 and 6. Returns the offices, and how many they are who are counted in one list with
    /// those who have them.
    pub(crate) fn by_title(&self, mentions: &mut [Mention]) -> (Vec<Held>, u32) {
        let mut held = Vec::new();
        if !is_office(self.program) {
            return (held, 0);
        }
        // the list that one reads on: where it ends, how many are in it, whether one of them has an office
        let (mut end, mut listed, mut seated, mut heads) = (0, 0, false, 0);
        for (group, n) in self.groups(mentions) {
            let people = n as u32;
            if group.start > end + LIST_GAP {
                (listed, seated) = (0, false);
            }
            (end, listed) = (group.end, listed + people);
            for m in mentions.iter_mut() {
                let open = m.count.is_none() || m.article && m.count == Some(1);
                let kind = m.room_type().and_then(|id| self.domain.room_type(id)).filter(|_| open);
                let Some(kind) = kind.filter(|k| most_desks(self.domain, k) > 0 && !m.span.overlaps(group)) else {
                    continue;
                };
                let Some(title) = self.named_again(group, m.span) else { continue };
                let least = offer::desks(self.domain, kind).map_or(1, |d| d[0]);
                let each = (m.span.end..title).any(|i| self.is_each(i));
                let behind = self.numbers.iter().find(|k| k.span.start == m.span.end + 1 && !k.article && !k.vague);
                let said = behind.filter(|_| self.tagged(m.span.end, Tag::Stops).is_some()).map(|k| k.value as u32);
                let desks = if each { 1 } else { said.unwrap_or(least).max(1) };
                // "offices for two": the number is the last word
                let plural = m.plural || (m.span.start..m.span.end).any(|i| self.tokens[i].text.ends_with('s'));
                if !each && (!plural || desks == 1) || desks > most_desks(self.domain, kind) || least > desks {
                    continue;
                }
                let (id, count) = (kind.id.clone(), people.div_ceil(desks));
                (m.count, m.article, m.vague, m.plural) = (Some(i64::from(count)), false, false, true);
                held.push(Held { room_type: id, count, beds: desks });
                seated = true;
            }
            if seated {
                heads = heads.max(listed);
            }
        }
        (held, heads)
    }

    /// Returns where a title is named again beside an office: before it, in its name or behind it.
    fn named_again(&self, group: Span, office: Span) -> Option<usize> {
        let title = singular(&self.tokens[group.end.checked_sub(1)?].text);
        let plain = |i: &usize| !self.tokens[*i].is_mark();
        let before = (office.start.saturating_sub(MOST_OF_OWNER)..office.end).filter(plain);
        let behind = (office.end..(office.end + MOST_TO_OWNER).min(self.tokens.len())).take_while(plain);
        let own = |i: &usize| title.len() > 3 && !group.contains(*i) && singular(&self.tokens[*i].text) == title;
        before.chain(behind).find(own)
    }

    /// Returns the desks of offices that are called by their number: "six Dreierbüros".
    pub(crate) fn by_number(&self, mentions: &[Mention]) -> Vec<Held> {
        let desks = |m: &Mention| {
            let office = named_for::office(self.tokens.get(m.span.start)?, self.spoken)?;
            let kind = m.room_type().and_then(|id| self.domain.room_type(id))?;
            let count = m.count.filter(|n| *n > 0).map_or(if office.plural { 2 } else { 1 }, |n| n.min(MOST) as u32);
            let beds = office.desks?;
            offer::desks(self.domain, kind).map(|_| Held { room_type: kind.id.clone(), count, beds })
        };
        mentions.iter().filter(|m| m.span.end == m.span.start + 1).filter_map(desks).collect()
    }

    /// Gives those who share one room an office with a desk for each: "four paralegals sharing one room".
    pub(crate) fn one_for_all(&self, mentions: &mut Vec<Mention>) -> (Vec<Held>, Vec<Span>) {
        let (mut held, mut spans) = (Vec::new(), Vec::new());
        if !is_office(self.program) {
            return (held, spans);
        }
        for (group, n) in self.groups(mentions) {
            let most = (group.end + MOST_TO_OWN).min(self.tokens.len());
            let Some(verb) = (group.end..most).find(|&i| self.tagged(i, Tag::Sharing).is_some()) else { continue };
            let room = |i: &usize| {
                [Tag::OfficeWords, Tag::Total, Tag::RoomWords].iter().any(|&t| self.tagged(*i, t).is_some())
            };
            let until = (verb + 1 + MOST_TO_OFFICE).min(self.tokens.len());
            let words = (verb + 1..until).take_while(|&i| !self.tokens[i].is_mark());
            let Some(at) = words.into_iter().find(room) else { continue };
            let desks = n as u32;
            let fits = |k: &&RoomType| {
                let range = offer::desks(self.domain, k).filter(|_| most_desks(self.domain, k) > 0);
                range.is_some_and(|[low, high]| (low..=high).contains(&desks))
            };
            let kind = self.domain.room_types.iter().filter(fits).min_by_key(|k| most_desks(self.domain, k));
            let Some(kind) = kind else { continue };
            let own = Span { start: verb, end: at + 1 };
            mentions.retain(|m| !m.span.overlaps(own));
            let place = mentions.iter().position(|m| m.span.start > at).unwrap_or(mentions.len());
            let plain = Mention::plain(own, What::Room(kind.id.clone()));
            // in the plural it is called as its type is, not "one room"
            mentions.insert(place, Mention { count: Some(1), plural: true, ..plain });
            held.push(Held { room_type: kind.id.clone(), count: 1, beds: desks });
            spans.push(Span { start: group.start, end: own.end });
        }
        (held, spans)
    }

    /// Returns those who may have an office each, and how many they are: people, and whoever is counted by a title that is no
    /// word for a room: "six team leaders".
    fn groups(&self, mentions: &[Mention]) -> Vec<(Span, i64)> {
        let who = |m: &Mention| matches!(m.what, What::Staff | What::People) && !m.article && !m.vague;
        let heads = |m: &Mention| m.count.filter(|n| who(m) && (2..=MOST).contains(n));
        let mut groups: Vec<(Span, i64)> = mentions.iter().filter_map(|m| Some((m.span, heads(m)?))).collect();
        let taken = |i: usize| mentions.iter().any(|m| (m.from..m.span.end).contains(&i));
        for number in self.numbers.iter().filter(|n| !n.article && !n.vague && n.value.fract() == 0.0) {
            let n = number.value as i64;
            let plain = |i: &usize| {
                let parts = [Tag::Stops, Tag::Starts, Tag::Joins, Tag::Inside, Tag::Each, Tag::Everyone, Tag::Own];
                let word = self.tokens[*i].kind == Kind::Word && !taken(*i);
                word && !parts.iter().any(|&t| self.tagged(*i, t).is_some())
            };
            let most = (number.span.end + MOST_OF_TITLE).min(self.tokens.len());
            let end = (number.span.end..most).take_while(plain).last().map(|i| i + 1);
            if let Some(end) = end.filter(|_| (2..=MOST).contains(&n) && !taken(number.span.start)) {
                groups.push((Span { start: number.span.start, end }, n));
            }
        }
        groups.sort_by_key(|g| g.0.start);
        groups
    }

    /// Returns the word for the office that each of a group has.
    fn office_of(&self, mentions: &[Mention], group: Span, until: usize) -> Option<Span> {
        let room_at = |i: usize| mentions.iter().find(|m| m.room_type().is_some() && m.span.start == i);
        // a word for an office that is no room by itself: "chacun son bureau"
        let office_at = |i: usize| match room_at(i) {
            Some(m) => self.is_single(m).then_some(m.span),
            None => self.tagged(i, Tag::OfficeWords).map(|end| Span { start: i, end }),
        };
        let other = |i: usize| room_at(i).is_some_and(|m| !self.is_single(m));
        let counted = |office: Span| mentions.iter().any(|m| m.span == office && m.count.is_some() && !m.article);
        let office_behind = |from: usize, most: usize| {
            let words = (from..(from + most).min(until)).take_while(|&i| !self.tokens[i].ends_sentence() && !other(i));
            words.filter_map(office_at).next().filter(|o| !counted(*o))
        };
        // "8 lawyers: each ...": up to the first room that is none of theirs
        let sentence = (group.end..until).take_while(|&i| !self.tokens[i].ends_sentence() && !other(i));
        let each = sentence.into_iter().find(|&i| self.is_each(i));
        if let Some(each) = each {
            // "for 8 people each" counts the people of a room
            let office = office_behind(each + 1, MOST_TO_OFFICE);
            if office.is_some() {
                return office;
            }
        }
        // "six attorneys with their own offices", "in Einzelbüros"
        let leads = [Tag::Starts, Tag::Inside].iter().any(|&t| self.tagged(group.end, t).is_some());
        if let Some(office) = office_behind(group.end, MOST_TO_OWN + 1).filter(|_| leads) {
            let own = (group.end..office.start).any(|i| self.tagged(i, Tag::Own).is_some());
            let plural = mentions.iter().any(|m| m.span == office && m.plural && m.count.is_none());
            if own || plural {
                return Some(office);
            }
        }
        // "a private office for each of the 8 lawyers", "Einzelbüros für 8 Anwälte", "8 avocats, un bureau par avocat"
        let from = group.start.saturating_sub(MOST_TO_WHOM);
        let office = (from..group.start).rev().find_map(office_at).filter(|o| o.end <= group.start && !counted(*o))?;
        let between = || office.end..group.start;
        if between().any(|i| self.tokens[i].is_mark() || other(i)) {
            return None;
        }
        let plural = mentions.iter().any(|m| m.span == office && m.plural && m.count.is_none());
        let whose = self.tagged(office.end, Tag::Stops).is_some();
        (between().any(|i| self.is_each(i)) || plural && whose).then_some(office)
    }

    fn is_each(&self, i: usize) -> bool {
        [Tag::Everyone, Tag::Each].iter().any(|&t| self.tagged(i, t).is_some())
    }

    /// Gives desks that the list of rooms counts by themselves a room to stand in: they are no sum of the desks of others.
    /// `taken` are the words for desks of rooms.
    pub(crate) fn desks_of_the_list(&self, mentions: &mut [Mention], taken: &[Span]) -> Option<Held> {
        let kind = self.domain.room_types.iter().max_by_key(|k| most_desks(self.domain, k))?;
        if !is_office(self.program) || most_desks(self.domain, kind) <= MOST_IN_TEAM || self.list_from == 0 {
            return None;
        }
        let rooms = mentions.iter().filter(|m| m.room_type().is_some());
        if rooms.clone().any(|m| m.room_type() == Some(&kind.id)) || rooms.count() == 0 {
            return None;
        }
        let colon = |i: usize| self.tokens.get(i).is_some_and(|t| t.mark() == Some(':'));
        // "with 90 desks: ..." is of the whole building
        let item = |m: &Mention| {
            let number = m.count.is_some_and(|n| (2..=500).contains(&n)) && !m.article && !m.vague;
            let listed = m.from.min(m.span.start) >= self.list_from && !colon(m.span.end);
            m.what == What::Desks && number && listed && !taken.contains(&m.span)
        };
        let m = mentions.iter_mut().find(|m| item(m))?;
        let desks = m.count.and_then(|n| u32::try_from(n).ok())?;
        (m.what, m.count, m.plural) = (What::Room(kind.id.clone()), Some(1), false);
        Some(Held { room_type: kind.id.clone(), count: 1, beds: desks })
    }
}

/// Returns a title without what makes it a plural or says whose something is.
fn singular(title: &str) -> &str {
    let endings = ["'s", "s'", "es", "en", "s", "n", "e"];
    endings.iter().find_map(|e| title.strip_suffix(e)).unwrap_or(title)
}
