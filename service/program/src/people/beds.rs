//! Rooms that are told by their beds: "four 4-bed rooms", "Sechsbettzimmer", "4 rooms with 4 beds each", "16 beds in
//! double rooms"; and beds that contradict the rooms.

use d3dgen_model::domain::{Access, Domain, Occupants, Privacy, Program, ProgramRoom, RoomType, Zone};
use d3dgen_model::offer::sleeps;
use d3dgen_model::scene_graph::{Note, Occupancy};

use crate::named::mention::{Mention, What};
use crate::people::held::Held;
use crate::tokens::numbers::{self, Number};
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end};
use crate::wished::relations::Said;
use crate::wished::wishes::{Wish, Wishes};

/// Most beds of one room.
const MOST_BEDS: f64 = 24.0;

/// Words between rooms and their beds, at most: "rooms, each of them with".
const MOST_BETWEEN: usize = 5;

/// What a program calls its places to be treated at.
const STATION: &str = "station";

/// Words for a room with so many beds.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BedRoom {
    pub span: Span,
    pub beds: u32,
    pub plural: bool,
    /// Type of the domain that it is planned as.
    pub room_type: String,
}

/// Returns the sleeping room of the domain that is nearest to a number of beds, and how many people it usually sleeps.
///
/// Of equals the program's own comes first; rather a type that gets a bed more than one that gets a bed too few.
pub(crate) fn nearest<'a>(domain: &'a Domain, program: &Program, beds: u32) -> Option<&'a RoomType> {
    let listed = |id: &str| program.rooms.iter().any(|e| e.room_type == id);
    let found = domain.room_types.iter().enumerate().filter(|(_, kind)| is_bed_room(kind)).filter_map(|(i, kind)| {
        let [low, high] = sleeps(domain, kind)?;
        let off = low.saturating_sub(beds) + beds.saturating_sub(high);
        Some(((off, beds < low, !is_for_beds(domain, kind), !listed(&kind.id), i), kind))
    });
    found.min_by_key(|f| f.0).map(|f| f.1)
}

/// Returns true for rooms that people simply stay in: no bays, and none that one enters through another.
fn is_bed_room(kind: &RoomType) -> bool {
    kind.zone == Zone::Night && kind.privacy == Privacy::Private && kind.access != Access::Host
}

/// Returns true for rooms of which a program counts the beds, and their variants: a room to calm down in is no bedroom for
/// several, however wide its couch is.
fn is_for_beds(domain: &Domain, kind: &RoomType) -> bool {
    let of = |e: &ProgramRoom| e.occupants == Occupants::Beds && kind.id.starts_with(&e.room_type);
    domain.programs.iter().flat_map(|p| &p.rooms).any(of)
}

/// Returns the beds of a room that the prompt tells by them alone: "a 4-bed room", "Vierbettzimmer", "chambre à 4 lits".
pub(crate) fn told(tokens: &[Token], numbers: &[Number], spoken: &[&Spoken]) -> Option<u32> {
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    let unit = |i: usize| {
        let text = &tokens.get(i)?.text;
        let known = spoken.iter().any(|s| s.tags.word(text).is_some_and(|tags| tags.contains(&Tag::BedUnits)));
        tagged(i, Tag::BedUnits).or(known.then_some(i + 1))
    };
    let ends = || spoken.iter().filter_map(|s| s.words.phrases.get(&Tag::BedRoomEnds)).flatten();
    let exact = |n: &&Number| !n.article && !n.vague;
    for number in numbers.iter().filter(exact) {
        let Some(beds) = bed_count(number.value).filter(|n| *n > 1) else { continue };
        let at = number.span.end;
        if tokens.get(at).is_some_and(|t| !t.spaced && ends().any(|e| *e == t.text)) {
            return Some(beds);
        }
        let Some(unit) = unit(at) else { continue };
        // "2 bed rooms" are bedrooms
        let before = numbers.iter().any(|n| n.span.end == number.span.start);
        let one = |end: usize| tokens[unit].kind != Kind::Word || !tokens[end - 1].text.ends_with('s');
        if tagged(unit, Tag::BedRooms).is_some_and(|end| before || one(end)) {
            return Some(beds);
        }
        let of = number.span.start.checked_sub(1).is_some_and(|i| tagged(i, Tag::Stops).is_some());
        let closes = tokens.get(unit).is_none_or(Token::is_mark);
        if of && closes && beds > 2 && number.span.start <= MOST_BETWEEN {
            return Some(beds);
        }
    }
    tokens.iter().find_map(|t| {
        let head = ends().find_map(|e| t.text.strip_suffix(e.as_str())).filter(|h| !h.is_empty())?;
        let value = spoken.iter().find_map(|s| numbers::in_one_word(head, s))?;
        bed_count(value).filter(|n| *n > 1)
    })
}

/// Returns true for domains with a room for so many beds.
pub(crate) fn has_room_for(domain: &Domain, beds: u32) -> bool {
    let mut kinds = domain.room_types.iter().filter(|k| is_bed_room(k)).filter_map(|k| sleeps(domain, k));
    kinds.any(|[low, high]| (low..=high).contains(&beds)) || beds > 2 && domain.room_types.iter().any(is_bed_room)
}

/// How rooms get their types from beds.
pub(crate) struct Choice<'a> {
    pub domain: &'a Domain,
    pub program: &'a Program,
    pub spoken: &'a [&'a Spoken],
}

impl Choice<'_> {
    /// Returns the words for rooms with so many beds; `known` gives the type of words that the domain has itself.
    pub(crate) fn phrases(
        &self,
        tokens: &[Token],
        numbers: &[Number],
        known: impl Fn(Span) -> Option<String>,
    ) -> Vec<BedRoom> {
        let mut out: Vec<BedRoom> = Vec::new();
        for i in 0..tokens.len() {
            let found = self.numbered(tokens, numbers, i).or_else(|| self.compound(tokens, numbers, i));
            let Some((end, beds)) = found else { continue };
            let span = Span { start: i, end };
            if out.last().is_some_and(|o| o.span.overlaps(span)) {
                continue;
            }
            let near = || nearest(self.domain, self.program, beds).map(|k| k.id.clone());
            let Some(room_type) = known(span).or_else(near) else { continue };
            let last = &tokens[end - 1].text;
            let plural = last.ends_with('s') || last.ends_with("zimmern") || last.starts_with("raume");
            out.push(BedRoom { span, beds, plural, room_type });
        }
        out
    }

    fn tagged(&self, tokens: &[Token], i: usize, tag: Tag) -> Option<usize> {
        tag_end(self.spoken, tokens, i, tag)
    }

    /// "4-bed rooms", "six bed bay", "3-Bett-Zimmer", "六人间", "6인실"
    fn numbered(&self, tokens: &[Token], numbers: &[Number], i: usize) -> Option<(usize, u32)> {
        let number = numbers.iter().find(|n| n.span.start == i && !n.article && !n.vague)?;
        let beds = bed_count(number.value)?;
        let unit = self.unit(tokens, number.span.end)?;
        let end = self.tagged(tokens, unit, Tag::BedRooms)?;
        // "10인 회의실" ends in a longer word
        let whole =
            tokens[unit].kind == Kind::Word || tokens.get(end).is_none_or(|t| t.spaced || t.kind != tokens[unit].kind);
        (whole || tokens[unit].kind == Kind::Han).then_some((end, beds))
    }

    /// Returns the end of a word that counts beds; a tag of a longer phrase ("bed rooms") does not hide it.
    fn unit(&self, tokens: &[Token], i: usize) -> Option<usize> {
        self.tagged(tokens, i, Tag::BedUnits).or_else(|| {
            let text = &tokens.get(i)?.text;
            let known = self.spoken.iter().any(|s| s.tags.word(text).is_some_and(|tags| tags.contains(&Tag::BedUnits)));
            known.then_some(i + 1)
        })
    }

    /// "Sechsbettzimmer", "4-Bettzimmer"
    fn compound(&self, tokens: &[Token], numbers: &[Number], i: usize) -> Option<(usize, u32)> {
        let ends = || self.spoken.iter().filter_map(|s| s.words.phrases.get(&Tag::BedRoomEnds)).flatten();
        if let Some(number) = numbers.iter().find(|n| n.span.start == i && !n.article && !n.vague) {
            let at = number.span.end;
            let next = tokens.get(at).filter(|t| !t.spaced && ends().any(|e| *e == t.text))?;
            return Some(at + 1).filter(|_| !next.text.is_empty()).zip(bed_count(number.value));
        }
        let text = &tokens[i].text;
        let head = ends().find_map(|e| text.strip_suffix(e.as_str())).filter(|h| !h.is_empty())?;
        let value = self.spoken.iter().find_map(|s| numbers::in_one_word(head, s))?;
        bed_count(value).map(|beds| (i + 1, beds))
    }

    /// Takes rooms with their beds for what they are: "4 rooms with 4 beds each", "10 beds in five rooms"; the words for
    /// beds that one room has are no head count of the building.
    pub(crate) fn read_lists(&self, tokens: &[Token], mentions: &mut Vec<Mention>) {
        let mut drop: Vec<usize> = Vec::new();
        for b in 0..mentions.len() {
            let Some(n) = counted(&mentions[b]).filter(|_| mentions[b].what == What::Beds) else { continue };
            if let Some(p) = b.checked_sub(1).filter(|&p| self.each_has(tokens, mentions, p, b)) {
                if self.give(&mut mentions[p], n) {
                    drop.push(b);
                }
                continue;
            }
            let inside = (b + 1 < mentions.len()).then_some(b + 1).filter(|&q| self.lies_in(tokens, mentions, b, q));
            if let Some((q, rooms)) = inside.and_then(|q| Some((q, counted(&mentions[q])?))) {
                self.give(&mut mentions[q], n.div_ceil(rooms));
            }
        }
        for b in drop.into_iter().rev() {
            mentions.remove(b);
        }
    }

    /// Takes rooms for several for those of the program: the double rooms of a nursing home are for residents. Variants of
    /// the program's own room begin with its id.
    pub(crate) fn adopt(&self, mentions: &mut [Mention]) {
        let own =
            self.program.rooms.iter().find(|e| e.occupants == Occupants::Beds).map(|e| format!("{}_", e.room_type));
        let variant = |kind: &RoomType| own.as_ref().is_some_and(|own| kind.id.starts_with(own));
        let listed = |kind: &RoomType| variant(kind) || self.program.rooms.iter().any(|e| e.room_type == kind.id);
        let bedroom = |kind: &RoomType| is_for_beds(self.domain, kind);
        for m in mentions.iter_mut() {
            let kind = m
                .room_type()
                .and_then(|id| self.domain.room_type(id))
                .filter(|k| is_bed_room(k) && bedroom(k) && !listed(k));
            let beds = kind.and_then(|k| sleeps(self.domain, k)).filter(|[low, _]| *low > 1);
            let alike = |k: &&RoomType| listed(k) && is_bed_room(k) && bedroom(k) && sleeps(self.domain, k) == beds;
            if let Some(other) = beds.and_then(|_| self.domain.room_types.iter().find(alike)) {
                m.what = What::Room(other.id.clone());
            }
        }
    }

    /// Gives a mention of rooms so many beds each; returns false where the domain has no room to sleep in.
    fn give(&self, mention: &mut Mention, beds: u32) -> bool {
        let own = mention.room_type().and_then(|id| self.domain.room_type(id));
        let fits = own.filter(|kind| sleeps(self.domain, kind).is_some_and(|[low, high]| (low..=high).contains(&beds)));
        let Some(kind) = fits.or_else(|| nearest(self.domain, self.program, beds)) else { return false };
        mention.what = What::Room(kind.id.clone());
        mention.beds = Some(beds);
        true
    }

    /// Returns true for mentions of rooms that could have beds.
    fn may_sleep(&self, mention: &Mention) -> bool {
        let known =
            |id: &str| self.domain.room_type(id).is_some_and(|k| is_bed_room(k) && sleeps(self.domain, k).is_some());
        mention.beds.is_none() && (mention.what == What::Total || mention.room_type().is_some_and(known))
    }

    /// "4 rooms with 4 beds each", "each room has two beds", "rooms of six beds", "a room with three beds"
    fn each_has(&self, tokens: &[Token], mentions: &[Mention], p: usize, b: usize) -> bool {
        let (rooms, beds) = (&mentions[p], &mentions[b]);
        let gap = rooms.span.end..beds.from.min(beds.span.start);
        if !self.may_sleep(rooms) || gap.len() > MOST_BETWEEN || gap.clone().any(|i| tokens[i].ends_sentence()) {
            return false;
        }
        let has = |mut range: std::ops::Range<usize>, tag| range.any(|i| self.tagged(tokens, i, tag).is_some());
        let tail = beds.span.end..(beds.span.end + 2).min(tokens.len());
        let each = has(gap.clone(), Tag::Each)
            || has(tail, Tag::Each)
            || has(rooms.from.saturating_sub(2)..rooms.from, Tag::Each);
        let starts = has(gap.clone(), Tag::Starts);
        let of = gap.len() == 1 && matches!(tokens[gap.start].text.as_str(), "of" | "a" | "de");
        let open = rooms.count.is_none() || rooms.count == Some(1);
        let comma = gap.clone().any(|i| tokens[i].is_mark());
        !gap.is_empty() && (of || starts && (each || open && !comma))
    }

    /// "10 beds in five rooms", "16 Betten, verteilt auf 8 Zimmer"
    fn lies_in(&self, tokens: &[Token], mentions: &[Mention], b: usize, q: usize) -> bool {
        let (beds, rooms) = (&mentions[b], &mentions[q]);
        let gap = beds.span.end..rooms.from.min(rooms.span.start);
        let inside = gap.clone().any(|i| {
            self.tagged(tokens, i, Tag::Inside).is_some()
                || matches!(tokens[i].text.as_str(), "auf" | "across" | "over")
        });
        let others = mentions.iter().filter(|m| m.what != What::Total && self.may_sleep(m)).count();
        let joins = gap.clone().any(|i| self.tagged(tokens, i, Tag::Joins).is_some());
        self.may_sleep(rooms)
            && inside
            && !joins
            && gap.len() <= MOST_BETWEEN
            && (rooms.what == What::Total || others == 1)
    }
}

fn counted(mention: &Mention) -> Option<u32> {
    let n = mention.count.filter(|&n| n > 0 && !mention.vague)?;
    u32::try_from(n).ok().filter(|n| f64::from(*n) <= 5000.0)
}

fn bed_count(value: f64) -> Option<u32> {
    (value.fract() == 0.0 && (1.0..=MOST_BEDS).contains(&value)).then_some(value as u32)
}

/// Multiplies the beds of "two 12-bed wards" and "two wards of 12 beds each".
pub(crate) fn of_several_wards(
    (tokens, spoken): (&[Token], &[&Spoken]),
    mentions: &mut [Mention],
    numbers: &[Number],
    wards: &[Span],
) {
    let each = |i: usize| is_tagged(spoken, tokens, i, Tag::Each);
    let before = |ward: &Span| numbers.iter().find(|n| n.span.end == ward.start && !n.article && n.value > 1.0);
    let told_each = |m: &Mention| {
        let near = |w: &&Span| w.end <= m.from && m.from - w.end <= MOST_BETWEEN;
        let between = |w: &Span| (w.end..m.from).any(each);
        let ward = wards.iter().filter(near).max_by_key(|w| w.end)?;
        let whole = (ward.end..m.from).all(|i| !tokens[i].is_mark());
        before(ward).filter(|_| m.what == What::Beds && whole && (each(m.span.end) || between(ward)))
    };
    for m in mentions.iter_mut() {
        if let (Some(wards), Some(beds)) = (told_each(m), m.count) {
            m.count = Some(beds.saturating_mul(wards.value as i64));
        }
    }
    let of_ward = |m: &Mention| {
        let holds = |w: &Span| w.start == m.span.end || w.start == m.span.start && w.end > m.span.end;
        m.what == What::Beds && wards.iter().any(holds)
    };
    for m in mentions.iter_mut().filter(|m| of_ward(m)) {
        let Some(number) = m.number else { continue };
        let wards = numbers.iter().find(|n| n.span.end == number.start && !n.article && n.value > 1.0);
        if let (Some(wards), Some(beds)) = (wards, m.count) {
            m.count = Some(beds.saturating_mul(wards.value as i64));
        }
    }
}

/// What is known of those who stay overnight when rooms are counted by them.
pub(crate) struct Sleepers<'a> {
    pub domain: &'a Domain,
    pub program: &'a Program,
    pub mentions: &'a [Mention],
    pub said: &'a Said,
    /// Beds, and people where the prompt counts no beds.
    pub beds: Option<u32>,
    pub people: Option<u32>,
}

impl Sleepers<'_> {
    /// Counts rooms to sleep in by who sleeps there: "16 beds in double rooms" are 8 rooms; the beds that are left over go
    /// to rooms of the program. Returns which rooms have how many beds, and the beds of the building.
    pub(crate) fn settle(
        &self,
        wishes: &mut Wishes,
        assumptions: &mut Vec<Note>,
        conflicts: &mut Vec<Note>,
    ) -> Settled {
        // "10 beds in single rooms, an isolation room": there these are beside the beds
        let apart = if self.told(wishes).is_empty() { self.apart(wishes) } else { 0 };
        let Some(beds) = self.beds.filter(|n| apart > 0 && *n > apart) else {
            return self.settle_open(wishes, assumptions, conflicts);
        };
        let message = format!("of the {beds} beds {apart} are in the isolation rooms");
        assumptions.push(Note::new("beds_apart", message));
        let others = Sleepers { beds: Some(beds - apart), ..*self };
        let settled = others.settle_open(wishes, assumptions, conflicts);
        Settled { beds: settled.beds.map(|n| n + apart), ..settled }
    }

    /// Returns the beds of rooms that are entered through a lock: who counts the beds of a ward counts these too.
    fn apart(&self, wishes: &Wishes) -> u32 {
        let lock = |w: &Wish| {
            self.domain.room_type(&w.room_type).filter(|k| k.access == Access::Host && k.zone == Zone::Night)
        };
        let beds = |w: &Wish| Some(w.count * sleeps(self.domain, lock(w)?)?[0]);
        wishes.wishes.iter().filter_map(beds).sum()
    }

    /// As [`Self::settle`], for the beds of all other rooms.
    fn settle_open(&self, wishes: &mut Wishes, assumptions: &mut Vec<Note>, conflicts: &mut Vec<Note>) -> Settled {
        let told = self.told(wishes);
        let counts_beds = self.program.rooms.iter().any(|e| e.occupants == Occupants::Beds);
        if told.is_empty() {
            if let (Some(beds), true) = (self.beds, counts_beds) {
                self.rest(wishes, beds, assumptions);
            }
            return Settled { held: Vec::new(), beds: self.beds };
        }
        let counted = self.beds.or(self.people).is_some_and(|n| self.count_open(wishes, &told, n));
        let people = self.people.filter(|_| counted && counts_beds);
        let held = self.held(wishes);
        self.note_nearest(&held, assumptions);
        let [low, high] =
            told.iter().filter_map(|t| self.capacity(wishes, t)).fold([0, 0], |s, r| [s[0] + r[0], s[1] + r[1]]);
        let beds = match self.beds.or(people) {
            Some(beds) if beds > high && counts_beds => {
                self.rest(wishes, beds - high, assumptions);
                Some(beds)
            }
            Some(beds) if beds < low && !self.spare(wishes, &told, low - beds) => {
                let message = format!(
                    "the prompt asks for {beds} beds, but its rooms have {low}; the rooms were followed, {low} beds were planned"
                );
                conflicts.push(Note::new("contradicting_beds", message));
                Some(low)
            }
            None if !held.is_empty() && counts_beds => Some(low),
            other => other,
        };
        Settled { held, beds }
    }

    /// Returns the types of rooms to stay in that the prompt names.
    fn told(&self, wishes: &Wishes) -> Vec<String> {
        let known = |w: &&Wish| {
            self.domain.room_type(&w.room_type).is_some_and(|k| is_bed_room(k) && sleeps(self.domain, k).is_some())
        };
        wishes.wishes.iter().filter(known).map(|w| w.room_type.clone()).collect()
    }

    fn mentions_of<'m>(&'m self, id: &'m str) -> impl Iterator<Item = &'m Mention> {
        let positive = self.mentions.iter().enumerate().filter(|(i, _)| !self.said.negated.contains(i));
        positive.map(|(_, m)| m).filter(move |m| m.room_type() == Some(id))
    }

    /// Returns the beds of one room of a type: those that the prompt gives, or the usual ones.
    fn each(&self, id: &str) -> Option<[u32; 2]> {
        let told = self.mentions_of(id).find_map(|m| m.beds).map(|n| [n, n]);
        told.or_else(|| sleeps(self.domain, self.domain.room_type(id)?))
    }

    /// Returns the beds of all rooms of a type, least and most.
    fn capacity(&self, wishes: &Wishes, id: &str) -> Option<[u32; 2]> {
        let count = wishes.wishes.iter().find(|w| w.room_type == id)?.count;
        let numbered: Vec<(u32, u32)> = self.mentions_of(id).filter_map(|m| Some((counted(m)?, m.beds?))).collect();
        let listed: u32 = numbered.iter().map(|n| n.0).sum();
        if listed == count && !numbered.is_empty() {
            let sum = numbered.iter().map(|(n, beds)| n * beds).sum();
            return Some([sum, sum]);
        }
        self.each(id).map(|[low, high]| [low.saturating_mul(count), high.saturating_mul(count)])
    }

    /// Gives rooms without a number so many that all have a bed; returns false where there are none.
    fn count_open(&self, wishes: &mut Wishes, told: &[String], sleepers: u32) -> bool {
        let open: Vec<&String> = told.iter().filter(|id| self.mentions_of(id).all(|m| m.count.is_none())).collect();
        let fixed: u32 =
            told.iter().filter(|id| !open.contains(id)).filter_map(|id| Some(self.capacity(wishes, id)?[0])).sum();
        let rest = sleepers.saturating_sub(fixed);
        let caps: Vec<u32> = open.iter().map(|id| self.each(id).map_or(1, |r| r[0].max(1))).collect();
        let sum: u32 = caps.iter().sum();
        if rest == 0 || sum == 0 {
            return false;
        }
        let smallest = (0..caps.len()).min_by_key(|&k| caps[k]).unwrap_or(0);
        let over = (rest % sum).div_ceil(caps[smallest]);
        for (k, id) in open.iter().enumerate() {
            let count = if open.len() == 1 {
                rest.div_ceil(caps[0])
            } else {
                rest / sum + if k == smallest { over } else { 0 }
            };
            if let Some(wish) = wishes.wishes.iter_mut().find(|w| &w.room_type == *id) {
                wish.count = count.max(1);
                wish.exact = true;
            }
        }
        true
    }

    /// Returns true when so few beds too many only mean that the last room is not full.
    fn spare(&self, wishes: &Wishes, told: &[String], over: u32) -> bool {
        let counted_by_beds = |id: &&String| self.mentions_of(id).all(|m| m.count.is_none());
        let largest = told.iter().filter(counted_by_beds).filter_map(|id| Some(self.each(id)?[0])).max();
        largest.is_some_and(|n| over < n) && !wishes.wishes.is_empty()
    }

    fn held(&self, wishes: &Wishes) -> Vec<Held> {
        let mut out = Vec::new();
        for m in self.mentions.iter().enumerate().filter(|(i, _)| !self.said.negated.contains(i)).map(|(_, m)| m) {
            let (Some(beds), Some(id)) = (m.beds, m.room_type()) else { continue };
            let wish = wishes.wishes.iter().find(|w| w.room_type == id).map_or(0, |w| w.count);
            let count = counted(m).unwrap_or(wish);
            out.push(Held { room_type: id.to_owned(), count, beds });
        }
        out
    }

    fn note_nearest(&self, held: &[Held], assumptions: &mut Vec<Note>) {
        for h in held {
            let Some(kind) = self.domain.room_type(&h.room_type) else { continue };
            if sleeps(self.domain, kind).is_some_and(|[low, high]| !(low..=high).contains(&h.beds)) {
                let (beds, label) = (h.beds, kind.label.to_lowercase());
                let message = format!("rooms with {beds} beds are planned as {label}, the nearest type that is known");
                assumptions.push(Note::new("nearest_room_type", message));
            }
        }
    }

    /// Puts beds that the named rooms do not have into rooms of the program, where the prompt fixes the others.
    fn rest(&self, wishes: &mut Wishes, beds: u32, assumptions: &mut Vec<Note>) {
        let night = |w: &Wish| self.domain.room_type(&w.room_type).is_some_and(|k| k.zone == Zone::Night);
        let counts = self.program.rooms.iter().any(|e| e.occupants == Occupants::Beds);
        let rooms = room_for_beds(self.domain, self.program).filter(|_| counts);
        if let Some(rooms) = rooms.filter(|_| wishes.wishes.iter().any(|w| w.exact && night(w))) {
            assumptions.extend(add_rooms(self.domain, rooms, beds, wishes));
        }
    }
}

/// Returns the type of the rooms that beds are in and how many of them: of the program itself, else of its places to be treated
/// at, else of the domain.
fn room_for_beds<'a>(domain: &'a Domain, program: &'a Program) -> Option<(&'a String, u32)> {
    let own = |p: &'a Program| p.rooms.iter().find(|e| e.occupants == Occupants::Beds);
    let of_program = |p| own(p).map(|e| (&e.room_type, e.occupants_per_room.unwrap_or(1).max(1)));
    let stations = || program.means.get(STATION).map(|id| (id, 1));
    of_program(program).or_else(stations).or_else(|| domain.programs.iter().find_map(of_program))
}

/// Adds rooms for so many beds, where the prompt neither names nor forbids them, and says so.
fn add_rooms(domain: &Domain, (id, each): (&String, u32), beds: u32, wishes: &mut Wishes) -> Option<Note> {
    if wishes.forbidden.contains(id) || wishes.wishes.iter().any(|w| &w.room_type == id) {
        return None;
    }
    let rooms = beds.div_ceil(each);
    let label = domain.room_type_or_generic(id).label.to_lowercase();
    wishes.wishes.push(Wish { count: rooms, exact: true, ..Wish::one(id, &label) });
    let message = format!("{beds} beds are in none of the rooms named; {rooms} x {label} were added for them");
    Some(Note::new("beds_left", message))
}

/// Returns true where the prompt names rooms to sleep in.
pub(crate) fn names_rooms(domain: &Domain, wishes: &Wishes) -> bool {
    let bedded = |w: &Wish| domain.room_type(&w.room_type).is_some_and(|k| sleeps(domain, k).is_some());
    wishes.wishes.iter().any(bedded)
}

/// Adds the rooms to sleep in that a list of rooms takes for granted, for all who are to have a bed: "ward: 12 beds, nurse
/// station, clean utility".
pub(crate) fn house(
    (domain, program): (&Domain, &Program),
    heads: &Occupancy,
    residents: Option<u32>,
    wishes: &mut Wishes,
) -> Option<Note> {
    if names_rooms(domain, wishes) {
        return None;
    }
    // who visits a building that is all for beds is its patient
    let all = program.rooms.first().is_some_and(|e| e.occupants == Occupants::Beds);
    let patients = residents.or(heads.visitors.filter(|_| all));
    let counts = program.rooms.iter().any(|e| e.occupants == Occupants::Beds);
    let beds = heads.beds.or(patients.filter(|_| counts))?;
    add_rooms(domain, room_for_beds(domain, program)?, beds, wishes)
}

/// Beds as they were settled.
pub(crate) struct Settled {
    pub held: Vec<Held>,
    pub beds: Option<u32>,
}
