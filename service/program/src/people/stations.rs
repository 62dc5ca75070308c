//! Places that one room has several of: to be treated at ("10 dialysis stations", "PACU with 6 bays", "6-bay recovery",
//! "infusion for 8 patients") and those that words of its type count ("60 cars", "40 racks", "80 cows"). They are no rooms of
//! their own, and nobody who sits there stays overnight.

use d3dgen_model::domain::{Domain, Program, RoomType};
use d3dgen_model::offer::places;

use crate::named::mention::{Mention, What};
use crate::named::mentions::Vocabulary;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Phrases, Span, Token, fold};
use crate::tokens::words::{Spoken, Tag, tag_end};

/// Words between a number and the places that it counts, at most: "10 reclining treatment chairs".
const MOST_BETWEEN: usize = 2;
/// Words between a room and its places, at most: "recovery room with a total of".
const MOST_TO_ROOM: usize = 5;
/// What programs call places to be treated at that are rooms of their own.
const STATION: &str = "station";
/// Letters before the word for places in a compound, at least: "Dialyseplätze".
const LEAST_HEAD: usize = 3;
/// Most places that are taken at their word.
const MOST_PLACES: f64 = 400.0;

/// Reads places.
pub(crate) struct Reader<'a> {
    pub tokens: &'a [Token],
    pub numbers: &'a [Number],
    pub vocabulary: &'a Vocabulary,
    pub domain: &'a Domain,
    pub program: &'a Program,
    pub spoken: &'a [&'a Spoken],
    /// Places, areas, robots: no word of these is one for places to be treated at.
    pub taken: &'a [Span],
    /// Words that room types are counted by, in the prompt's languages.
    pub counted: &'a [Phrases<Counted>],
}

/// What a word of a room type counts.
#[derive(Debug, Clone)]
pub(crate) struct Counted {
    room_type: String,
    /// True for the rooms themselves, false for the places in one.
    rooms: bool,
}

/// Returns the words by which room types of a domain and their places are counted, by language; rooms of the program come first.
pub(crate) fn counted(domain: &Domain, program: &Program, languages: &[&str]) -> Vec<Phrases<Counted>> {
    let own = |kind: &RoomType| program.rooms.iter().any(|e| e.room_type == kind.id);
    let (mut kinds, others): (Vec<&RoomType>, Vec<&RoomType>) = domain.room_types.iter().partition(|k| own(k));
    kinds.extend(others);
    let phrases = |language: &&str| {
        let mut out = Phrases::new(language);
        for (kind, words, rooms) in kinds.iter().flat_map(|k| [(k, &k.called, true), (k, &k.places, false)]) {
            let counted = Counted { room_type: kind.id.clone(), rooms };
            words.get(*language).into_iter().flatten().for_each(|word| out.insert(word, counted.clone()));
        }
        out
    };
    languages.iter().map(phrases).collect()
}

/// Words for so many places.
struct Found {
    /// With the number.
    span: Span,
    count: u32,
    /// The words without the number.
    noun: Span,
    /// Room that the word itself names: "Dialyseplätze".
    named: Option<String>,
    /// Mention that these words are read as so far.
    mention: Option<usize>,
    /// True for words that count the rooms themselves.
    rooms: bool,
}

impl Reader<'_> {
    /// Gives rooms of the prompt their places; returns the words that say so.
    pub(crate) fn read(&self, mentions: &mut Vec<Mention>) -> Vec<Span> {
        let mut out: Vec<Span> = Vec::new();
        let mut at = 0;
        while at < self.tokens.len() {
            let found = self.found(mentions, at).filter(|f| !out.iter().any(|s| s.overlaps(f.span)));
            let Some(found) = found else {
                at += 1;
                continue;
            };
            at = found.noun.end;
            if self.give(mentions, &found) {
                out.push(found.span);
            }
        }
        out
    }

    fn tagged(&self, i: usize, tag: Tag) -> Option<usize> {
        tag_end(self.spoken, self.tokens, i, tag)
    }

    /// Returns true for rooms with many places.
    fn has_places(&self, id: &str) -> bool {
        self.domain.room_type(id).is_some_and(|k| places(self.domain, k).is_some())
    }

    /// Returns the room that the building is for, where it has places.
    fn main(&self) -> Option<&str> {
        self.program.rooms.first().map(|e| e.room_type.as_str()).filter(|id| self.has_places(id))
    }

    fn found(&self, mentions: &[Mention], at: usize) -> Option<Found> {
        if let Some(found) = self.counted_by(mentions, at) {
            return Some(found);
        }
        let free = |span: Span| !self.taken.iter().any(|s| s.overlaps(span));
        let known = mentions.iter().position(|m| m.span.contains(at));
        if let Some(m) = known.filter(|&m| mentions[m].span.start == at) {
            let mention = &mentions[m];
            let count = mention.count.filter(|_| !mention.article && !mention.vague && mention.beds.is_none());
            let last = self.tagged(mention.span.end - 1, Tag::Stations).is_some();
            let counts = match &mention.what {
                What::Beds | What::Visitors | What::People => true,
                What::Desks => last,
                // "6 curtained bays" of a recovery room; where the building has such bays they are rooms. "8 chemo bays"
                What::Room(id) => {
                    let own = self.program.rooms.iter().any(|e| &e.room_type == id);
                    last && (!own || self.has_places(id) && mention.span.end > mention.span.start + 1)
                }
                _ => false,
            };
            let count = count.filter(|_| counts)?;
            let span = Span { start: mention.from, end: mention.span.end };
            return Some(Found {
                span,
                count: bounded(count as f64)?,
                noun: mention.span,
                named: None,
                mention: Some(m),
                rooms: false,
            });
        }
        let token = &self.tokens[at];
        let compound = || {
            // where rooms told by their beds are one word, these are too
            let compounds = self.spoken.iter().filter(|s| s.words.phrases.contains_key(&Tag::BedRoomEnds));
            let mut ends = compounds.filter_map(|s| s.words.phrases.get(&Tag::Stations)).flatten().map(|w| fold(w));
            let head = ends.find_map(|end| token.text.strip_suffix(&end).map(str::to_owned))?;
            (head.len() > LEAST_HEAD).then(|| (at + 1, Some(head.trim_end_matches('s').to_owned())))
        };
        let plain = self.tagged(at, Tag::Stations).map(|end| (end, None));
        let (end, head) = plain.or_else(compound).filter(|_| known.is_none())?;
        let number = self.number_before(at)?;
        let span = Span { start: number.span.start, end };
        let named = head.and_then(|h| self.vocabulary.whole(&h)).filter(|id| self.has_places(id)).map(str::to_owned);
        let count = bounded(number.value)?;
        let noun = Span { start: at, end };
        free(span).then_some(Found { span, count, noun, named, mention: None, rooms: false })
    }

    /// Returns the number in "10 reclining treatment chairs", of the words at a token.
    fn number_before(&self, at: usize) -> Option<&Number> {
        (0..=MOST_BETWEEN).find_map(|gap| {
            let start = at.checked_sub(gap)?;
            let closed = (start..at).any(|k| {
                self.tokens[k].is_mark()
                    || [Tag::Joins, Tag::Starts, Tag::Stops].iter().any(|&t| self.tagged(k, t).is_some())
            });
            self.numbers.iter().find(|n| n.span.end == start && !n.article && !n.vague && !closed)
        })
    }

    /// Returns places that words of a room type count, where the building has such a room or the prompt names one.
    fn counted_by(&self, mentions: &[Mention], at: usize) -> Option<Found> {
        let (end, what) = self.counted.iter().filter_map(|p| p.longest_at(self.tokens, at)).max_by_key(|f| f.0)?;
        let id = &what.room_type;
        let named = |m: &Mention| m.room_type() == Some(id.as_str());
        let named_too = !what.rooms && mentions.iter().any(named);
        if !self.program.rooms.iter().any(|e| &e.room_type == id) && !named_too {
            return None;
        }
        let noun = Span { start: at, end };
        // "car wash": what is counted is the whole of a name
        let mention = mentions.iter().position(|m| m.span.overlaps(noun));
        let longer = |m: usize| mentions[m].span.start < at || mentions[m].span.end > end;
        let counted = |m: usize| what.rooms && named(&mentions[m]);
        if mention.is_some_and(|m| longer(m) || counted(m)) || self.taken.iter().any(|s| s.overlaps(noun)) {
            return None;
        }
        let number = self.number_before(at)?;
        let span = Span { start: number.span.start, end };
        let (count, rooms) = (bounded(number.value)?, what.rooms);
        Some(Found { span, count, noun, named: Some(id.clone()), mention, rooms })
    }

    /// Gives a room the places; returns false where the prompt has none that they could be of.
    fn give(&self, mentions: &mut Vec<Mention>, found: &Found) -> bool {
        let Some(room) = self.room_of(mentions, found) else {
            let Some(id) = found.named.clone().or_else(|| self.alone(mentions, found)) else { return false };
            if let Some(m) = found.mention.filter(|&m| mentions[m].room_type().is_some()) {
                mentions[m].what = What::Room(id);
                self.settle(&mut mentions[m], found);
                return true;
            }
            let at = mentions.iter().position(|m| m.span.start >= found.noun.start).unwrap_or(mentions.len());
            let mut mention = Mention { from: found.span.start, ..Mention::plain(found.noun, What::Room(id)) };
            self.settle(&mut mention, found);
            mentions.insert(at, mention);
            return true;
        };
        self.settle(&mut mentions[room], found);
        if let Some(m) = found.mention.filter(|&m| m != room) {
            mentions.remove(m);
        }
        true
    }

    /// Returns true for the chairs of a waiting room.
    fn of_another(&self, mentions: &[Mention], found: &Found) -> bool {
        let (noun, span) = (found.noun, found.span);
        let room = |m: &&Mention| m.room_type().is_some_and(|id| self.main() != Some(id));
        let before = mentions.iter().rev().filter(room).find(|m| m.span.end <= span.start);
        let after = mentions.iter().filter(room).find(|m| m.from >= noun.end);
        before.is_some_and(|m| self.joins(m.span.end..span.start, &[Tag::Starts, Tag::Inside]))
            || before.is_some_and(|m| m.span.end + 1 == span.start && self.tokens[m.span.end].is_mark())
                && self.tokens.get(noun.end).is_none_or(Token::is_mark)
            || after.is_some_and(|m| self.joins(noun.end..m.from, &[Tag::Inside]))
    }

    /// Returns true where words between a room and its places say that they are of it.
    fn joins(&self, gap: std::ops::Range<usize>, tags: &[Tag]) -> bool {
        let tagged = |tags: &[Tag]| gap.clone().any(|i| tags.iter().any(|&t| self.tagged(i, t).is_some()));
        !gap.is_empty()
            && gap.len() <= MOST_TO_ROOM
            && !gap.clone().any(|i| self.tokens[i].is_mark())
            && tagged(tags)
            && !tagged(&[Tag::Joins])
    }

    /// Returns the mention of the room that places belong to.
    fn room_of(&self, mentions: &[Mention], found: &Found) -> Option<usize> {
        if found.rooms {
            // "vehicle bays for three engines": each has its own
            let bare = |m: &Mention| m.room_type() == found.named.as_deref() && (m.number.is_none() || m.article);
            return mentions.iter().position(bare);
        }
        let fits = |m: &usize| {
            let mention = &mentions[*m];
            let own = |id: &str| found.named.as_ref().is_none_or(|named| named == id) && self.has_places(id);
            mention.places.is_none() && mention.room_type().is_some_and(own)
        };
        let (noun, span) = (found.noun, found.span);
        let own = |m: usize| Some(m) != found.mention;
        // "10 dialysis stations", "6-bay recovery", "10 postes de dialyse"
        let joint = |i: usize| matches!(self.tokens[i].text.as_str(), "de" | "d" | "of" | "fur");
        let beside = (0..mentions.len()).filter(|&m| own(m)).find(|&m| {
            let s = mentions[m].span;
            let inside = span.start <= s.start && s.end <= noun.start;
            let behind = s.start == noun.end || s.start == noun.end + 1 && joint(noun.end);
            inside || behind
        });
        if let Some(m) = beside.filter(fits) {
            return Some(m);
        }
        let before = (0..mentions.len()).rev().find(|&m| own(m) && mentions[m].span.end <= span.start);
        let after = (0..mentions.len()).find(|&m| own(m) && mentions[m].from >= noun.end);
        let with = before.filter(fits).filter(|&m| {
            // "a recovery room (6 bays)"
            let gap = mentions[m].span.end..span.start;
            let bracket =
                gap.len() == 1 && self.tokens.get(noun.end).is_none_or(Token::is_mark) && found.mention.is_none();
            bracket && self.tokens[gap.start].is_mark() || self.joins(gap, &[Tag::Starts, Tag::Stops])
        });
        let itself = || found.mention.filter(|m| fits(m));
        let alike = |m: &usize| found.mention.is_none_or(|f| !fits(&f) || mentions[*m].what == mentions[f].what);
        with.filter(alike)
            .or_else(itself)
            .or_else(|| after.filter(fits).filter(|&m| self.joins(noun.end..mentions[m].from, &[Tag::Inside])))
    }

    /// Returns the room that the building is for, of which places without a room are, or that each of them is.
    fn alone(&self, mentions: &[Mention], found: &Found) -> Option<String> {
        if self.of_another(mentions, found) {
            return None;
        }
        let main = self.main().or_else(|| {
            let each = self.program.means.get(STATION).filter(|_| found.mention.is_none())?;
            Some(each.as_str())
        })?;
        let given = mentions.iter().any(|m| m.room_type() == Some(main));
        let heads = found.mention.is_some_and(|m| mentions[m].room_type().is_none());
        let listed = found.mention.is_none_or(|m| matches!(mentions[m].what, What::Visitors) || !heads);
        (!given && listed).then(|| main.to_owned())
    }

    /// Gives a mention its places, in as many rooms as they need.
    fn settle(&self, mention: &mut Mention, found: &Found) {
        let count = found.count;
        let kind = mention.room_type().and_then(|id| self.domain.room_type(id));
        let kind = kind.filter(|_| !found.rooms);
        let Some((kind, of)) = kind.and_then(|k| Some((k, places(self.domain, k)?))) else {
            // each of them is a room
            mention.count = Some(i64::from(count));
            (mention.plural, mention.article, mention.vague) = (true, false, false);
            return;
        };
        let told = mention.count.filter(|_| mention.number.is_some() && !mention.article && !mention.vague);
        let own = told.filter(|&n| (2..=20).contains(&n) && mention.places.is_none()).map(|n| n as u32);
        let counted = own.filter(|&n| n != count);
        let rooms = counted.unwrap_or_else(|| count.div_ceil(of.most(kind.area_m2.max))).max(1);
        mention.places = Some(if counted.is_some() { count } else { count.div_ceil(rooms) });
        mention.count = Some(i64::from(rooms));
        (mention.plural, mention.article, mention.vague) = (false, false, false);
    }
}

fn bounded(value: f64) -> Option<u32> {
    (value.fract() == 0.0 && (1.0..=MOST_PLACES).contains(&value)).then_some(value as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_whole_numbers_count_places() {
        assert_eq!(bounded(8.0), Some(8));
        assert_eq!(bounded(8.5), None);
        assert_eq!(bounded(0.0), None);
    }
}
