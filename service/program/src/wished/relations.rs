//! Which rooms the prompt wants beside, open to, within or away from each other, and which it does not want at all.

use d3dgen_model::domain::{Access, Domain, Privacy};
use d3dgen_model::scene_graph::Connector;

use crate::named::mention::{Mention, What};
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, tag_end, tag_ends_at};

/// How a pair is spread over the rooms of its types.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Spread {
    /// Each room of the first type with one of the second.
    Each,
    /// Every room of the first with every one of the second.
    All,
    /// One room of the first with two of the second.
    Between,
}

/// Two mentions that belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Relation {
    pub subject: usize,
    pub object: usize,
    pub connector: Connector,
    pub spread: Spread,
    /// True for rooms to be kept apart.
    pub apart: bool,
    /// True when the object belongs to the subject ("bedroom with its own bathroom").
    pub belongs: bool,
}

/// What the sentences say about mentions, by index.
#[derive(Debug, Default)]
pub(crate) struct Said {
    pub relations: Vec<Relation>,
    /// Mentions after "no", "without".
    pub negated: Vec<usize>,
    /// Mentions that are objects of a relation: they name a room again.
    pub objects: Vec<usize>,
    /// Mentions that are subjects of a relation.
    pub subjects: Vec<usize>,
    /// Mentions counted once for each room of another mention: (guest, host).
    pub each: Vec<(usize, usize)>,
    /// Mentions behind "every", "all".
    pub every: Vec<usize>,
    /// Mentions counted once for every room that can have one: "every room has an en suite".
    pub each_room: Vec<usize>,
    /// Pairs of mentions of which one is to be seen from the other.
    pub seen: Vec<(usize, usize)>,
    /// Mentions that are not to be open to others.
    pub closed: Vec<usize>,
}

pub(super) const RELATIONS: [Tag; 8] =
    [Tag::Near, Tag::Door, Tag::Open, Tag::Together, Tag::Between, Tag::Around, Tag::Sight, Tag::Apart];

/// Reads all relations and negations.
pub(crate) fn read(
    tokens: &[Token],
    mentions: &[Mention],
    spoken: &[&Spoken],
    language: &str,
    buildings: &[Span],
) -> Said {
    let mut said = Said { negated: negated(tokens, mentions, spoken, language), ..Said::default() };
    let reader = Reader::new(tokens, mentions, spoken, language, buildings);
    let mut i = 0;
    while i < tokens.len() {
        if mentions.iter().any(|m| m.span.contains(i)) {
            i += 1;
            continue;
        }
        let found = spoken.iter().find_map(|s| {
            let (end, tags) = s.tags.longest_at(tokens, i)?;
            RELATIONS.iter().rev().find(|t| tags.contains(t)).map(|tag| (end, *tag))
        });
        match found {
            Some((end, tag)) => {
                reader.relation(i, end, tag, &mut said);
                i = end;
            }
            None => i += 1,
        }
    }
    said.every = (0..mentions.len()).filter(|&m| reader.every(m)).collect();
    at_entrance(&reader, &mut said);
    belongings(&reader, &mut said);
    said
}

/// Reads "입구에 카페", "入口处咖啡厅": in these languages the place stands before what is there.
fn at_entrance(reader: &Reader, said: &mut Said) {
    for (e, entrance) in reader.mentions.iter().enumerate() {
        let wide = matches!(reader.tokens[entrance.span.start].kind, Kind::Han | Kind::Hangul);
        let next = reader.mentions.get(e + 1).filter(|m| {
            let gap = entrance.span.end..m.from.min(m.span.start);
            m.room_type().is_some() && gap.len() <= 2 && !gap.into_iter().any(|i| reader.tokens[i].is_mark())
        });
        // "카페가 입구에 있는", "咖啡厅在入口处"
        let particles = ["가", "이", "은", "는", "도", "在", "于", "位"];
        let before = e.checked_sub(1).filter(|&p| {
            let gap = reader.mentions[p].span.end..entrance.from;
            let plain = gap.clone().all(|i| particles.contains(&reader.tokens[i].text.as_str()));
            reader.mentions[p].room_type().is_some() && (1..=2).contains(&gap.len()) && plain
        });
        let room = before.or(next.map(|_| e + 1));
        let known = said.relations.iter().any(|r| r.subject == e || r.object == e);
        if let Some(room) = room.filter(|_| entrance.what == What::Entrance && wide && !known) {
            said.relations.push(Relation {
                subject: room,
                object: e,
                connector: Connector::Wall,
                spread: Spread::Each,
                apart: false,
                belongs: false,
            });
        }
    }
}

/// Reads relations of the rooms of a prompt.
pub(crate) struct Reader<'a> {
    pub tokens: &'a [Token],
    pub mentions: &'a [Mention],
    pub spoken: &'a [&'a Spoken],
    /// True where the relation can stand behind both rooms.
    postposed: bool,
    /// True where what turns a relation round stands behind it.
    pub verb_last: bool,
    /// Words for buildings.
    buildings: &'a [Span],
}

impl<'a> Reader<'a> {
    pub(crate) fn new(
        tokens: &'a [Token],
        mentions: &'a [Mention],
        spoken: &'a [&'a Spoken],
        language: &str,
        buildings: &'a [Span],
    ) -> Self {
        let postposed = matches!(language, "zh" | "ko" | "de");
        Self { tokens, mentions, spoken, postposed, verb_last: language == "ko", buildings }
    }
}

impl Reader<'_> {
    /// Returns the end of the longest phrase with a tag that begins at a token.
    pub(crate) fn tag_end(&self, i: usize, tag: Tag) -> Option<usize> {
        tag_end(self.spoken, self.tokens, i, tag)
    }

    pub(crate) fn place(&self, i: usize) -> bool {
        matches!(self.mentions[i].what, What::Room(_) | What::Charge | What::Entrance)
    }

    pub(crate) fn tagged(&self, i: usize, tag: Tag) -> bool {
        self.tag_end(i, tag).is_some()
    }

    /// Returns up to `n` mentions before a token in its sentence, nearest first.
    fn before(&self, at: usize, n: usize) -> Vec<usize> {
        let from = (0..at).rev().find(|&i| self.tokens[i].ends_sentence()).map_or(0, |i| i + 1);
        (0..self.mentions.len())
            .rev()
            .filter(|&m| self.place(m) && self.mentions[m].end() <= at && self.mentions[m].span.start >= from)
            .take(n)
            .collect()
    }

    /// Returns the mentions after a token up to the end of its clause.
    fn after(&self, at: usize, n: usize) -> Vec<usize> {
        let mut out = Vec::new();
        let mut i = at;
        let mut steps = 0;
        while i < self.tokens.len() && out.len() < n && steps < 7 {
            if let Some(m) = self.mentions.iter().position(|m| m.span.start == i) {
                if !self.place(m) {
                    break;
                }
                out.push(m);
                i = self.mentions[m].end();
                steps = 0;
                continue;
            }
            let token = &self.tokens[i];
            // "있고", "있다": the Korean clause ends; "있는" goes on to a noun
            let verb = token.text == "있" && self.tokens.get(i + 1).is_some_and(|t| t.text != "는");
            let again = !out.is_empty() && !self.tagged(i, Tag::Joins) && !self.tagged(i, Tag::Definite);
            if token.is_mark() || verb || self.tagged(i, Tag::Starts) || self.tagged(i, Tag::No) || again {
                break;
            }
            i += 1;
            steps += 1;
        }
        out
    }

    /// Returns true when a mention begins a statement of its own: "and the office is close to the entrance".
    pub(crate) fn goes_on(&self, m: usize) -> bool {
        let end = self.mentions[m].end();
        (end..(end + 3).min(self.tokens.len()))
            .take_while(|&i| !self.tokens[i].is_mark() && !self.tagged(i, Tag::Joins))
            .any(|i| RELATIONS.iter().any(|&tag| self.tagged(i, tag)))
    }

    /// Returns true for "every patient room", "all bedrooms".
    fn every(&self, m: usize) -> bool {
        let start = self.mentions[m].span.start;
        let each = |i: usize| tag_ends_at(self.spoken, self.tokens, i, Tag::Each, start);
        self.mentions[m].count.is_none() && (start.saturating_sub(2)..start).any(each)
    }

    pub(super) fn is_group(&self, m: usize) -> bool {
        self.mentions[m].plural || self.mentions[m].count.is_some_and(|n| n > 1)
    }

    fn relation(&self, start: usize, end: usize, tag: Tag, said: &mut Said) {
        let connector = match tag {
            Tag::Door => Connector::Door,
            Tag::Open => Connector::Open,
            Tag::Around | Tag::Sight => Connector::Near,
            _ => Connector::Wall,
        };
        let mut before = self.before(start, 3);
        let mut after = self.after(end, 2);
        // "between them": the last group named
        let them = after.is_empty()
            && (end..(end + 2).min(self.tokens.len()))
                .take_while(|&i| !self.tokens[i].is_mark())
                .any(|i| self.tagged(i, Tag::Them));
        if them && before.len() > 1 {
            let group = before[1..].iter().find(|&&m| self.is_group(m)).copied();
            after = group.map_or_else(|| before[1..].to_vec(), |g| vec![g]);
        }
        if after.is_empty() {
            after.extend(self.spoken_of(end, &before, said));
        }
        let mut told_at = start;
        if let Some(told) = before.first().and_then(|&nearest| self.told_before(nearest, start, said)) {
            before[0] = told;
            told_at = self.mentions[told].end();
        }
        let mutual = tag == Tag::Together || after.is_empty() && self.tagged(end, Tag::Mutual);
        let listed = !mutual && tag != Tag::Between;
        if let ([subject, ..], [object, ..], true) = (&before[..], &after[..], listed) {
            after = self.all_after(*subject, *object, start);
        }
        let group_object = after.first().is_some_and(|&m| self.is_group(m) || self.both_before(m));
        let one_to_many = |s: usize, o: usize| {
            let counted = self.mentions[o].count.is_some_and(|n| n > 1) && !self.mentions[o].article;
            counted && !self.is_group(s) && self.mentions[o].what != self.mentions[s].what
        };
        let spread = match tag {
            Tag::Around => Spread::All,
            Tag::Between if group_object => Spread::Between,
            _ if after.first().is_some_and(|&m| self.both_before(m)) => Spread::All,
            _ => Spread::Each,
        };
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        match (tag, before.as_slice(), after.as_slice()) {
            (_, [b, rest @ ..], _) if mutual => {
                let all = self.all_before(*b, told_at, said);
                pairs.extend(all.windows(2).map(|w| (w[0], w[1])));
                let alone = pairs.is_empty();
                pairs.extend(rest.first().filter(|_| alone && !self.is_group(*b)).map(|a| (*a, *b)));
                pairs.extend((alone && self.is_group(*b)).then_some((*b, *b)));
            }
            (Tag::Between, [s, ..], [a, b, ..]) => pairs.extend([(*s, *a), (*s, *b)]),
            (Tag::Between, [b, a, ..], [s]) if self.postposed && !group_object => pairs.extend([(*s, *a), (*s, *b)]),
            (Tag::Between, [s, ..], [group]) => pairs.push((*s, *group)),
            (Tag::Between, ..) => {}
            (_, [s, ..], [_, ..]) => {
                let subjects = self.all_before(*s, told_at, said);
                pairs.extend(subjects.into_iter().flat_map(|s| after.iter().map(move |&o| (s, o))));
            }
            (_, [b, a, ..], []) if self.postposed => {
                let (subject, objects) = self.verb_behind(*b).unwrap_or((*a, vec![*b]));
                pairs.extend(objects.into_iter().map(|o| (subject, o)));
            }
            (_, [], [o, s, ..]) => pairs.push((*s, *o)),
            _ => {}
        }
        for (subject, object) in pairs {
            said.subjects.push(subject);
            said.objects.push(object);
            let turned = self.is_turned((subject, object), Span { start, end });
            if subject == object && !self.is_group(subject) {
                continue;
            }
            if turned && tag == Tag::Open {
                said.closed.push(subject);
                continue;
            }
            if tag == Tag::Sight && !turned {
                said.seen.push((subject, object));
            }
            let apart = (tag == Tag::Apart) != turned;
            // "not far from the kitchen"
            let connector = if turned && tag == Tag::Apart { Connector::Near } else { connector };
            let spread = if spread == Spread::Each && one_to_many(subject, object) { Spread::All } else { spread };
            said.relations.push(Relation { subject, object, connector, spread, apart, belongs: false });
        }
    }

    /// Returns true where one of several is told of: "the main one with".
    fn one_of_them(&self, i: usize) -> bool {
        let end = self.spoken.iter().filter_map(|s| s.tag_at(self.tokens, i, Tag::OneOfThem)).max();
        end.is_some_and(|end| self.tagged(end, Tag::Starts))
    }

    fn both_before(&self, m: usize) -> bool {
        let from = self.mentions[m].from;
        (from.saturating_sub(2)..=from).any(|i| i < self.tokens.len() && self.tagged(i, Tag::Both))
    }
}

/// Reads "bedroom with its own bathroom", "8 guest rooms each with bathroom", "isolation room with anteroom".
fn belongings(reader: &Reader, said: &mut Said) {
    let tokens = reader.tokens;
    // "3 ensuite bedrooms"
    for h in 1..reader.mentions.len() {
        let (guest, host) = (&reader.mentions[h - 1], &reader.mentions[h]);
        let rooms = guest.room_type().is_some() && host.room_type().is_some() && !said.negated.contains(&h);
        if rooms && guest.span.end == host.span.start && reader.tagged(guest.span.start, Tag::Own) {
            // the "ensuite master bedroom" among others has one
            if reader.is_group(h) {
                said.each.push((h - 1, h));
            }
            let (connector, spread) = (Connector::Door, Spread::Each);
            said.relations.push(Relation { subject: h - 1, object: h, connector, spread, apart: false, belongs: true });
        }
    }
    for g in 1..reader.mentions.len() {
        let guest = &reader.mentions[g];
        let Some(h) = (0..g).rev().find(|&h| reader.mentions[h].room_type().is_some() || !reader.place(h)) else {
            continue;
        };
        let host = &reader.mentions[h];
        let any_room = host.what == What::Total && host.count.is_none();
        if host.room_type().is_none() && !any_room || guest.room_type().is_none() || said.negated.contains(&g) {
            continue;
        }
        let between = host.span.end..guest.from.min(guest.span.start);
        // "two-bedroom flat with a kitchen": the flat has it, not the bedroom
        let of_building = reader.buildings.iter().any(|b| between.clone().any(|i| b.contains(i)));
        let apart = of_building || between.clone().any(|i| tokens[i].ends_sentence());
        if between.is_empty() || between.len() > 7 || apart {
            continue;
        }
        let has = |tag| between.clone().any(|i| reader.tagged(i, tag));
        // the words after the guest count too: "with a bathroom each"
        let tail = guest.span.end..(guest.span.end + 2).min(tokens.len());
        // "each bedroom has its own bathroom", "각 객실에 욕실"
        let each_host =
            (host.span.start.saturating_sub(3)..host.span.start).rev().take_while(|&i| !tokens[i].is_mark()).any(|i| {
                reader
                    .spoken
                    .iter()
                    .any(|s| s.tag_at(tokens, i, Tag::Each).is_some_and(|end| end + 1 >= host.span.start))
            });
        let each = each_host
            || has(Tag::Each)
            || tail.clone().take_while(|&i| !tokens[i].is_mark()).any(|i| reader.tagged(i, Tag::Each));
        let at_host = between.clone().all(|i| matches!(tokens[i].text.as_str(), "에" | "는" | "마" | "다" | "엔"));
        let starts = has(Tag::Starts) || each_host && at_host;
        let comma = between.clone().any(|i| tokens[i].is_mark());
        let many = host.count.is_some_and(|n| n > 1) || host.plural || each_host;
        let numbered = guest.count.is_some() && !guest.article;
        let joined = between.clone().any(|i| reader.tagged(i, Tag::Joins));
        let related = RELATIONS.iter().any(|&t| has(t));
        // "single rooms and private bathrooms"
        let own = |i: usize| reader.tagged(i, Tag::Own);
        let joins = |i: usize| reader.tagged(i, Tag::Joins) || own(i);
        let own_too = reader.is_group(h) && guest.plural && guest.count.is_none() && between.clone().all(joins);
        if own_too && joined && (has(Tag::Own) || own(guest.span.end) || (guest.span.start..guest.span.end).any(own)) {
            said.each.push((g, h));
            let (connector, spread) = (Connector::Door, Spread::Each);
            said.relations.push(Relation { subject: g, object: h, connector, spread, apart: false, belongs: true });
            continue;
        }
        if related || !starts && !each {
            continue;
        }
        if any_room {
            // "moves between all rooms, with a dock in the laundry" says nothing of what each room has
            said.each_room.extend((each_host && starts && !comma && (!guest.definite || has(Tag::Own))).then_some(g));
            continue;
        }
        // "three bedrooms including a master suite": one of them has it
        // "four bedrooms, the main one with a bathroom"
        let one = many && comma && between.clone().any(|i| tokens[i].mark() == Some(',') && reader.one_of_them(i + 1));
        let part = has(Tag::PartOf) && guest.count == Some(1) || one && guest.count.is_none_or(|n| n == 1);
        let of_each = each && many && (starts || has(Tag::Own)) || starts && !comma && !joined && many && !numbered;
        if of_each && !part {
            said.each.push((g, h));
        } else if !part && (!(starts && !comma && !joined && !numbered) || many) {
            continue;
        }
        let (connector, spread) = (Connector::Door, Spread::Each);
        said.relations.push(Relation { subject: g, object: h, connector, spread, apart: false, belongs: true });
    }
}

/// Lets no room that is open to the corridor belong to rooms that one locks behind oneself: "double rooms with nurse station" have one
/// station, and nobody goes to it through somebody's bedroom.
pub(crate) fn keep_at_corridors(mentions: &[Mention], domain: &Domain, said: &mut Said) {
    let kind = |m: usize| mentions[m].room_type().and_then(|id| domain.room_type(id));
    let open = |m: usize| kind(m).is_some_and(|k| k.open_front && k.access != Access::Host);
    let locked = |m: usize| kind(m).is_some_and(|k| k.privacy == Privacy::Private);
    said.relations.retain(|r| !(r.belongs && open(r.subject) && locked(r.object)));
    said.each.retain(|&(guest, host)| !(open(guest) && locked(host)));
}

/// Words before the last of "everywhere in the house except", at most.
const MOST_OF_PLACE: usize = 4;
/// What stands between a word that rules out and a room that it says nothing of: "no carpet in the bathroom".
const PARTS: [Tag; 5] = [Tag::Starts, Tag::Near, Tag::Between, Tag::Inside, Tag::UnreadThings];

/// Returns the mentions after "no", "without", or before "없는".
fn negated(tokens: &[Token], mentions: &[Mention], spoken: &[&Spoken], language: &str) -> Vec<usize> {
    let end_of = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    let mut out = Vec::new();
    for i in 0..tokens.len() {
        let Some(end) = end_of(i, Tag::No) else { continue };
        // "darf nicht an das Bad grenzen" turns a relation round
        let relates = |k: usize| RELATIONS.iter().any(|&t| end_of(k, t).is_some());
        let turns = end_of(i, Tag::Not).is_some();
        let turned = turns && (end..tokens.len()).take_while(|&k| !tokens[k].is_mark()).any(relates);
        // "everywhere except the bathroom" keeps a robot out
        let keeps = (i.saturating_sub(MOST_OF_PLACE)..=i).any(|k| end_of(k, Tag::KeepOut).is_some_and(|to| to >= end));
        if turned || keeps || mentions.iter().any(|m| m.span.contains(i)) {
            continue;
        }
        if language == "ko" {
            let before =
                mentions.iter().rposition(|m| m.span.end <= i && m.span.end + 1 >= i && m.room_type().is_some());
            out.extend(before);
            continue;
        }
        let mut at = end;
        let mut first = true;
        while let Some(m) = mentions.iter().position(|m| m.from >= at) {
            let mention = &mentions[m];
            let gap = at..mention.from;
            let blocked = gap.clone().any(|k| tokens[k].is_mark() || PARTS.iter().any(|&t| end_of(k, t).is_some()));
            let joined = gap.len() <= 1 && gap.clone().all(|k| end_of(k, Tag::Joins).is_some());
            let fits = if first { gap.len() <= 3 && !blocked } else { joined && mention.count.is_none() };
            if !fits || mention.room_type().is_none() {
                break;
            }
            out.push(m);
            at = mention.span.end;
            first = false;
        }
    }
    out
}
