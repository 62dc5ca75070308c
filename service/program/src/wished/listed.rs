//! Relations of several rooms at once: "next to the kitchen, the study and the hall", "a kitchen and a study, all with doors
//! to the living room"; what "it" stands for, and words that turn a relation round.

use super::relations::{RELATIONS, Reader, Said};
use crate::named::mention::Mention;
use crate::tokens::text::Span;
use crate::tokens::words::Tag;

/// Words between two rooms of a list, at most: ", and next to the".
const MOST_BETWEEN: usize = 4;
/// Words behind a relation up to what stands for a room, at most.
const MOST_TO_IT: usize = 2;
/// Words behind a relation that turn it round, at most, in languages whose verb comes last.
const MOST_TO_VERB: usize = 4;

/// Little words before a room in a list: those that only repeat how the first of them is bound to the relation.
const BINDS: [&str; 8] = ["to", "de", "d", "a", "an", "von", "zu", "from"];

impl Reader<'_> {
    /// Returns the rooms a relation leads to: the first behind it, and those that are listed with it.
    ///
    /// In a prompt that lists the rooms of a building the next of them stand there too, so only rooms named for sure go with
    /// the first: those with "the" or a number of their own, and all where the sentence is about one room ("the kitchen must be
    /// next to a pantry, a hall and a terrace").
    pub(super) fn all_after(&self, subject: usize, first: usize, start: usize) -> Vec<usize> {
        let about = self.is_one(subject) && self.is_said(subject, start);
        let numbered = self.mentions[first].numbered.is_some();
        let mut out = vec![first];
        for m in first + 1..self.mentions.len() {
            let (last, mention) = (&self.mentions[m - 1], &self.mentions[m]);
            let counted = mention.count.is_some() && !(about && mention.article);
            let sure = self.is_one(m) || (about || numbered) && !counted;
            if mention.room_type().is_none() || !sure || !self.is_next(last, mention) || self.goes_on(m) {
                break;
            }
            out.push(m);
        }
        out
    }

    /// Returns the rooms before a relation that it is said of: the nearest, and in "a kitchen, a bathroom and a study, all with
    /// doors to" or "the kitchen and the study must be next to" those that are listed with it.
    pub(super) fn all_before(&self, nearest: usize, start: usize, said: &Said) -> Vec<usize> {
        let behind = self.mentions[nearest].end()..start;
        let all = behind.clone().any(|i| [Tag::Each, Tag::Both].iter().any(|&t| self.tagged(i, t)));
        let about = self.is_one(nearest) && self.is_said(nearest, start);
        let mut out = vec![nearest];
        if self.is_group(nearest) {
            return out;
        }
        for m in (0..nearest).rev() {
            let told = all || about && self.is_one(m) && !said.objects.contains(&m);
            if self.mentions[m].room_type().is_none()
                || !told
                || !self.is_next(&self.mentions[m], &self.mentions[m + 1])
            {
                break;
            }
            out.push(m);
        }
        out.reverse();
        out
    }

    /// Returns the room that a relation right behind another one is said of: "next to the garage but away from the bedrooms".
    pub(crate) fn told_before(&self, nearest: usize, start: usize, said: &Said) -> Option<usize> {
        let gap = self.mentions[nearest].end()..start;
        let goes_on = |i: usize| self.tagged(i, Tag::Joins) || self.tagged(i, Tag::But);
        let told = !gap.is_empty() && gap.into_iter().all(goes_on);
        said.relations.iter().rev().find(|r| r.object == nearest).map(|r| r.subject).filter(|_| told)
    }

    /// Returns the subject and the objects of a verb behind them: "die Küche, die an das Bad, das Zimmer und den Flur grenzt".
    pub(super) fn verb_behind(&self, last: usize) -> Option<(usize, Vec<usize>)> {
        let objects = self.row_to(last);
        let first = *objects.first()?;
        let bound = self.mentions[first].from.checked_sub(2)?;
        let binds = self.tagged(bound + 1, Tag::Definite) && BINDS.contains(&self.tokens[bound].text.as_str());
        let subject = first.checked_sub(1).filter(|&s| binds && self.mentions[s].room_type().is_some())?;
        Some((subject, objects))
    }

    /// Returns the rooms listed from one on.
    pub(crate) fn row_from(&self, first: usize) -> Vec<usize> {
        let goes_on = |m: &usize| {
            let (last, mention) = (&self.mentions[m - 1], &self.mentions[*m]);
            mention.room_type().is_some() && mention.count.is_none() && self.is_next(last, mention)
        };
        std::iter::once(first).chain((first + 1..self.mentions.len()).take_while(goes_on)).collect()
    }

    /// Returns the rooms listed up to one.
    pub(crate) fn row_to(&self, last: usize) -> Vec<usize> {
        let goes_on = |m: &usize| {
            let (mention, next) = (&self.mentions[*m], &self.mentions[m + 1]);
            mention.room_type().is_some() && self.is_one(*m) && self.is_next(mention, next)
        };
        let mut out: Vec<usize> = (0..last).rev().take_while(goes_on).collect();
        out.reverse();
        out.push(last);
        out
    }

    /// Returns the room that "it" behind a relation stands for: the one that those before it were said to be beside, else the
    /// first of the sentence.
    pub(super) fn spoken_of(&self, end: usize, before: &[usize], said: &Said) -> Option<usize> {
        let it = (end..(end + MOST_TO_IT).min(self.tokens.len()))
            .take_while(|&i| !self.tokens[i].is_mark())
            .any(|i| self.tagged(i, Tag::It));
        let nearest = *before.first().filter(|_| it)?;
        let told = said.relations.iter().rev().find(|r| r.object == nearest).map(|r| r.subject);
        told.or(before.last().copied()).filter(|&m| m != nearest)
    }

    /// Returns true where a relation of two rooms is turned round: "must not be next to".
    pub(super) fn is_turned(&self, (a, b): (usize, usize), relation: Span) -> bool {
        let (first, last) = if self.mentions[a].span.start <= self.mentions[b].span.start { (a, b) } else { (b, a) };
        let to = relation.start.max(if a == b { 0 } else { self.mentions[last].from });
        // what follows the last mark is said of these two
        let from = (self.mentions[first].end()..to)
            .rev()
            .find(|&i| self.tokens[i].is_mark())
            .map_or(self.mentions[first].end(), |i| i + 1);
        let behind = relation.end..(relation.end + MOST_TO_VERB).min(self.tokens.len());
        let behind = behind.take_while(|&i| self.verb_last && !self.tokens[i].is_mark());
        // "a kitchen not too large next to the hall"
        let of_size = |end: usize| self.tag_end(end, Tag::Degree).is_some_and(|end| end < relation.start);
        let turns = |i: usize| self.tag_end(i, Tag::Not).is_some_and(|end| !of_size(end));
        (from..to).filter(|&i| !relation.contains(i)).chain(behind).any(turns)
    }

    /// Returns true for a room that is told of by name: "the kitchen", "bedroom 2".
    fn is_one(&self, m: usize) -> bool {
        self.mentions[m].definite || self.mentions[m].numbered.is_some()
    }

    /// Returns true for a room that a sentence is about: "the kitchen must be next to".
    fn is_said(&self, m: usize, start: usize) -> bool {
        let verb = |i: usize| self.tagged(i, Tag::Stops) && !self.tagged(i, Tag::Joins);
        // "must not be next to" is one phrase, and so is "near"
        let has =
            |tag| self.spoken.iter().any(|s| s.tags.word(&self.tokens[start].text).is_some_and(|t| t.contains(&tag)));
        let turned = has(Tag::Stops) && !has(Tag::Near);
        turned || (self.mentions[m].end()..start).any(verb)
    }

    /// Returns true for a room that stands behind another in one list.
    fn is_next(&self, last: &Mention, next: &Mention) -> bool {
        // all of "bedrooms 1 to 4" stand in one place
        if next.span.start < last.end() {
            return true;
        }
        let gap = last.end()..next.from.min(next.span.start);
        let parts =
            |i: usize| self.tokens[i].mark().is_some_and(|c| matches!(c, ',' | '/')) || self.tagged(i, Tag::Joins);
        let binds = |i: usize| self.tagged(i, Tag::Definite) || BINDS.contains(&self.tokens[i].text.as_str());
        let relates = |i: usize| RELATIONS.iter().any(|&t| self.tagged(i, t)) && !self.tagged(i, Tag::Definite);
        let ends = |i: usize| self.tokens[i].ends_sentence();
        (1..=MOST_BETWEEN).contains(&gap.len())
            && gap.clone().any(parts)
            && gap.clone().all(|i| (parts(i) || binds(i)) && !relates(i) && !ends(i))
    }
}
