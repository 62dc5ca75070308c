//! From mentions to wishes: how many rooms of each type, which pairs, what is forbidden.

use std::collections::BTreeMap;

use d3dgen_model::domain::{Domain, Privacy, RoomType, Zone};
use d3dgen_model::scene_graph::{Connector, Note};

use super::relations::{Relation, Said, Spread};
use crate::named::compounds;
use crate::named::mention::{Mention, What};
use crate::named::numbered;
use crate::named::qualities;
use crate::people::short_form::ShortForm;
use crate::request::MANY;
use crate::tokens::measures::Area;
use crate::tokens::storey::Where;
use crate::tokens::text::Token;
use crate::tokens::words::{Spoken, Tag, tag_ends_at, words};

/// Rooms of one type that the prompt names.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wish {
    pub room_type: String,
    pub count: u32,
    /// True when the prompt gives a number (or one thing in the singular); false for "offices".
    pub exact: bool,
    /// Words of the prompt, for types no domain knows.
    pub name: String,
    /// Area of one such room, m^2.
    pub area_m2: Option<f64>,
    /// Lengths of the sides of one such room, m.
    pub sides_m: Option<[f64; 2]>,
    /// Factor on the usual area that the prompt asks for: "big kitchen".
    pub size: Option<f64>,
    /// True when the rooms are listed, not only part of the building's name ("two-bedroom flat").
    pub listed: bool,
}

impl Wish {
    /// Returns the wish for a room that the prompt does not list by its type.
    pub(crate) fn one(room_type: &str, name: &str) -> Self {
        let (room_type, name) = (room_type.to_owned(), name.to_owned());
        Self { room_type, count: 1, exact: false, name, area_m2: None, sides_m: None, size: None, listed: false }
    }
}

/// Two room types that belong together.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pair {
    pub a: String,
    pub b: String,
    pub connector: Connector,
    pub spread: Spread,
    /// True when `a` belongs to `b` (an en suite).
    pub belongs: bool,
    /// Which of the rooms are meant, where they have numbers of their own.
    pub which: Which,
}

/// Numbers of the rooms of a pair; none means any of their type.
pub(crate) type Which = [Option<u32>; 2];

/// Two room types that share neither door nor wall.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Apart {
    pub rooms: [String; 2],
    pub which: Which,
}

impl Apart {
    /// Returns true for a pair of which no room could be beside the other.
    fn rules_out(&self, pair: &Pair) -> bool {
        let side = |i: usize, kind: &String, number: Option<u32>| {
            &self.rooms[i] == kind && (self.which[i].is_none() || self.which[i] == number)
        };
        let [a, b] = pair.which;
        let alike = side(0, &pair.a, a) && side(1, &pair.b, b) || side(1, &pair.a, a) && side(0, &pair.b, b);
        alike && !pair.belongs && pair.connector != Connector::Near
    }
}

/// A room that comes with each room of another type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PerHost {
    pub guest: String,
    /// `None`: with each room that can have one.
    pub host: Option<String>,
}

/// Everything the prompt wants in terms of room types.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Wishes {
    pub wishes: Vec<Wish>,
    pub pairs: Vec<Pair>,
    pub apart: Vec<Apart>,
    pub forbidden: Vec<String>,
    pub entrance: Vec<String>,
    /// What comes with each room of a type whose number the prompt leaves open.
    pub per_host: Vec<PerHost>,
    /// Types of rooms that are to be open to what they serve: "open kitchen".
    pub open: Vec<String>,
    /// Types of rooms that are to have doors to those they serve: "separate kitchen".
    pub closed: Vec<String>,
    /// Types of rooms that are to be near the entrance of the building.
    pub by_entrance: Vec<String>,
    /// Types of rooms that have a door to the garden.
    pub garden: Vec<String>,
    /// True when some charging place near a room is asked for.
    pub charging_room: bool,
    /// True when charging is mentioned at all.
    pub charging: bool,
}

impl Wishes {
    /// Adds to a list of rooms the one that an "open kitchen" is open to, where it names none.
    pub(crate) fn open_to(&mut self, domain: &Domain) {
        let listed = |id: &str, all: &[Wish]| all.iter().any(|w| w.room_type == id);
        for id in &self.open {
            let mut partners = compounds::opens_to(domain, id).peekable();
            let Some(first) = partners.peek().map(|p| (*p).clone()) else { continue };
            if !partners.any(|p| listed(p, &self.wishes)) && !self.forbidden.contains(&first) {
                self.wishes.push(Wish::one(&first, &first.replace('_', " ")));
            }
        }
    }
}

impl Wishes {
    /// Lets one enter a home through its halls, and another building through what is for anybody: "a bike store near the front door",
    /// "resuscitation by the ambulance entrance" only say where that is.
    pub(crate) fn enter_through_halls(&mut self, domain: &Domain, lives: bool) {
        let halls = &domain.circulation;
        let hall = |id: &String| {
            let received = |k: &RoomType| !lives && (k.zone == Zone::Public || k.privacy == Privacy::Public);
            let circulates = domain.room_type(id).is_some_and(|k| k.zone == Zone::Circulation || received(k));
            circulates || *id == halls.room_type || halls.entrance_room_types.contains(id)
        };
        let (entrance, near) = std::mem::take(&mut self.entrance).into_iter().partition(hall);
        (self.entrance, self.by_entrance) = (entrance, near);
    }

    /// Makes one room of a kitchen and a living room that are open to each other where a fixed number of rooms has no place
    /// for both: "three rooms: bedroom, bathroom, living room with open kitchen".
    pub(crate) fn join_to_fit(&mut self, total: Option<u32>, domain: &Domain) {
        let d = &words().dwelling;
        let listed: u32 = self.wishes.iter().map(|w| w.count).fold(0, u32::saturating_add);
        let Some(total) = total.filter(|n| *n < listed && domain.room_type(&d.living_kitchen).is_some()) else {
            return;
        };
        let over = listed - total;
        let joined = |a: &str, b: &str, pairs: &[Pair]| {
            let of = |p: &Pair| p.a == a && p.b == b || p.a == b && p.b == a;
            pairs.iter().any(|p| p.connector == Connector::Open && of(p))
        };
        let one = |id: &str, all: &[Wish]| all.iter().any(|w| w.room_type == id && w.count == 1);
        let open = |id: &String, with: &[&String], all: &Self| {
            one(id, &all.wishes) && with.iter().any(|o| joined(id, o, &all.pairs)) || all.open.contains(id)
        };
        let both = one(&d.kitchen, &self.wishes) && one(&d.living, &self.wishes);
        if !both || !open(&d.kitchen, &[&d.living, &d.dining], self) {
            return;
        }
        let dining = one(&d.dining, &self.wishes) && open(&d.dining, &[&d.living, &d.kitchen], self);
        let gone: Vec<&String> = if dining && (over > 1 || !joined(&d.kitchen, &d.living, &self.pairs)) {
            vec![&d.kitchen, &d.dining]
        } else {
            vec![&d.kitchen]
        };
        self.wishes.retain(|w| !gone.contains(&&w.room_type));
        self.open.retain(|id| !gone.contains(&id));
        if let Some(wish) = self.wishes.iter_mut().find(|w| w.room_type == d.living) {
            wish.room_type.clone_from(&d.living_kitchen);
        }
        for pair in &mut self.pairs {
            for id in [&mut pair.a, &mut pair.b] {
                if *id == d.living || gone.contains(&&*id) {
                    id.clone_from(&d.living_kitchen);
                }
            }
        }
        self.pairs.retain(|p| p.a != p.b);
    }
}

/// Room type of a charging place; every domain may have it.
pub(crate) const CHARGING: &str = "robot_charging";

/// Words between a room and its area, at most: "of at least".
const MOST_TO_AREA: usize = 4;

/// What the counting needs to see.
pub(crate) struct Text<'a> {
    pub tokens: &'a [Token],
    pub prompt: &'a str,
    pub mentions: &'a [Mention],
    pub said: &'a Said,
    pub short_forms: &'a [ShortForm],
    pub areas: &'a [Area],
    pub list_from: usize,
    /// True when robots are named; then charging is about them.
    pub robots: bool,
    pub language: &'a str,
    pub spoken: &'a [&'a Spoken],
    /// The storey of every mention that the prompt puts on one.
    pub storeys: &'a [Option<Where>],
}

/// Counts rooms and gathers pairs; contradictions become conflicts.
pub(crate) fn gather(text: &Text, conflicts: &mut Vec<Note>) -> Wishes {
    let mut out = Wishes::default();
    let type_of = |m: usize| match &text.mentions[m].what {
        What::Room(id) => Some(id.clone()),
        What::Charge if text.robots => Some(CHARGING.to_owned()),
        _ => None,
    };
    out.charging =
        text.robots && text.mentions.iter().any(|m| m.what == What::Charge || m.room_type() == Some(CHARGING));
    let mut order: Vec<String> = Vec::new();
    let mut by_type: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    let shorts = text.short_forms.iter().flat_map(|f| f.rooms.keys().map(move |k| (f.span.start, k.clone())));
    let named =
        text.mentions.iter().enumerate().filter_map(|(i, m)| Some((m.span.start, m.room_type()?.to_owned(), i)));
    let mut seen: Vec<(usize, String)> = shorts.chain(named.clone().map(|(at, id, _)| (at, id))).collect();
    seen.sort_by_key(|s| s.0);
    for (_, id) in seen {
        if !order.contains(&id) {
            order.push(id);
        }
    }
    for (_, id, i) in named {
        by_type.entry(id).or_default().push(i);
    }
    let open = open_hosts(text, &by_type);
    for &(guest, host) in &open {
        let guest = text.mentions[guest].room_type().map(str::to_owned);
        let host = host.and_then(|h| text.mentions[h].room_type()).map(str::to_owned);
        out.per_host.extend(guest.map(|guest| PerHost { guest, host }));
    }
    let per_host = |m: &usize| open.iter().any(|o| o.0 == *m || o.1 == Some(*m));
    // "every exam room has a sink" says nothing of how many there are
    let told = |m: &usize| {
        let mention = &text.mentions[*m];
        let related = text.said.subjects.contains(m) || text.said.objects.contains(m);
        text.said.every.contains(m) && !mention.plural && !related && !text.said.each.iter().any(|e| e.1 == *m)
    };
    by_type.values_mut().for_each(|list| list.retain(|m| !per_host(m) && !told(m)));
    let silent: Vec<String> = by_type.iter().filter(|(_, list)| list.is_empty()).map(|(id, _)| id.clone()).collect();
    for id in order {
        let none = Vec::new();
        let list = by_type.get(&id).unwrap_or(&none);
        if silent.contains(&id) {
            let short = text.short_forms.iter().any(|f| f.rooms.contains_key(&id));
            if !short {
                continue;
            }
        }
        count_type(text, &id, list, &mut out, conflicts);
    }
    each_of_host(text, &mut out);
    for relation in &text.said.relations {
        // "cafe at the entrance"
        let (s, o) = (relation.subject, relation.object);
        for (place, other) in [(s, o), (o, s)] {
            if text.mentions[place].what == What::Entrance
                && !relation.apart
                && let Some(id) = type_of(other)
                && !out.entrance.contains(&id)
            {
                out.entrance.push(id);
            }
        }
        let (Some(a), Some(b)) = (type_of(s), type_of(o)) else {
            let entrance = [s, o].iter().any(|&m| text.mentions[m].what == What::Entrance);
            if relation.apart
                && entrance
                && let Some(id) = type_of(s).or_else(|| type_of(o))
            {
                let message = format!(
                    "{} is to be away from the entrance; how far it is from there is not planned",
                    id.replace('_', " ")
                );
                conflicts.push(Note::new("unread_wish", message));
            }
            continue;
        };
        let which = [s, o].map(|m| text.mentions[m].numbered.map(|n| n.n));
        if relation.apart {
            let apart = Apart { rooms: [a, b], which };
            out.apart.extend((!out.apart.contains(&apart)).then_some(apart));
            continue;
        }
        out.charging_room |= a == CHARGING || b == CHARGING;
        let Relation { connector, spread, belongs, .. } = *relation;
        out.join(Pair { a, b, connector, spread, belongs, which });
    }
    for &(a, b) in &text.said.seen {
        let [Some(a), Some(b)] = [a, b].map(|m| type_of(m).map(|id| id.replace('_', " "))) else { continue };
        let message = format!(
            "{a} and {b} are to be in sight of each other; they were wished near each other, what is seen from where is not assured"
        );
        conflicts.push(Note::new("sight_not_assured", message));
    }
    for &m in &text.said.closed {
        out.closed.extend(type_of(m));
    }
    out.keep_apart(conflicts);
    out
}

impl Wishes {
    /// Adds a pair; what is said of the same rooms again makes the first say more.
    fn join(&mut self, pair: Pair) {
        let same = |p: &&mut Pair| {
            p.a == pair.a && p.b == pair.b && p.which == pair.which
                || p.a == pair.b && p.b == pair.a && p.which == [pair.which[1], pair.which[0]]
        };
        match self.pairs.iter_mut().find(same) {
            Some(known) if known.belongs => {}
            Some(known) if pair.belongs => *known = pair,
            // "next to 25 offices, all with a door to it"
            Some(known) => {
                if strength(pair.connector) > strength(known.connector) {
                    known.connector = pair.connector;
                }
                if pair.spread == Spread::All {
                    known.spread = Spread::All;
                }
            }
            None => self.pairs.push(pair),
        }
    }

    /// Takes back the pairs that are to be apart too, and says so.
    fn keep_apart(&mut self, conflicts: &mut Vec<Note>) {
        let apart = &self.apart;
        self.pairs.retain(|pair| {
            let kept = !apart.iter().any(|a| a.rules_out(pair));
            if !kept {
                let [a, b] = [&pair.a, &pair.b].map(|id| id.replace('_', " "));
                let message = format!("{a} and {b} are to be beside each other and apart; they were kept apart");
                conflicts.push(Note::new("near_and_apart", message));
            }
            kept
        });
    }
}

/// Returns how much a connector asks for: who has a door has a wall.
fn strength(connector: Connector) -> u8 {
    match connector {
        Connector::Near => 0,
        Connector::Wall => 1,
        Connector::Door => 2,
        Connector::Open => 3,
    }
}

/// Returns guests and hosts of "every patient room has an en suite" where no other words say how many hosts there are.
fn open_hosts(text: &Text, by_type: &BTreeMap<String, Vec<usize>>) -> Vec<(usize, Option<usize>)> {
    let short = |id: &str| text.short_forms.iter().any(|f| f.rooms.contains_key(id));
    let open = |&(guest, host): &(usize, usize)| {
        let id = text.mentions[host].room_type()?;
        let all = by_type.get(id)?;
        let uncounted = |m: &usize| {
            let mention = &text.mentions[*m];
            let every = text.said.every.contains(m);
            mention.count.is_none() && (every || !mention.plural) && text.said.each.iter().any(|e| e.1 == *m)
        };
        (all.iter().all(uncounted) && !short(id)).then_some((guest, Some(host)))
    };
    let any = text.said.each_room.iter().map(|&guest| (guest, None));
    text.said.each.iter().filter_map(open).chain(any).collect()
}

fn count_type(text: &Text, id: &str, list: &[usize], out: &mut Wishes, conflicts: &mut Vec<Note>) {
    let label = id.replace('_', " ");
    let short: Option<i64> = text.short_forms.iter().filter_map(|f| f.rooms.get(id)).copied().max();
    let negated: Vec<usize> = list.iter().copied().filter(|m| text.said.negated.contains(m)).collect();
    let mut positive: Vec<usize> = list.iter().copied().filter(|m| !negated.contains(m)).collect();
    let bad = |m: usize| text.mentions[m].count.filter(|&n| n <= 0);
    let mut zero = false;
    for m in positive.clone() {
        if let Some(n) = bad(m) {
            positive.retain(|&p| p != m);
            zero |= n == 0;
            let choice = if n == 0 { "none was planned" } else { "the usual number was planned" };
            conflicts
                .push(Note::new("impossible_count", format!("{n} rooms of type {label} cannot be built; {choice}")));
        }
    }
    if !negated.is_empty() || zero {
        // Objects of a relation do not ask for a room, so "no kitchen next to the bedroom" stays a ban.
        if positive.iter().any(|m| text.mentions[*m].count.is_some()) {
            conflicts.push(Note::new(
                "wanted_and_forbidden",
                format!("{label} is both asked for and ruled out; it was planned"),
            ));
        } else {
            out.forbidden.push(id.to_owned());
            return;
        }
    }
    let Some(counted) = count_mentions(text, &positive, short, &label, conflicts) else { return };
    let area_m2 = positive.iter().find_map(|&m| room_area(text, &text.mentions[m]));
    let behind = !matches!(text.language, "en" | "de" | "zh" | "ko");
    let size = positive.iter().find_map(|&m| qualities::size(text.tokens, &text.mentions[m], text.spoken, behind));
    let name = positive.first().map_or(label.clone(), |&m| {
        let span = text.mentions[m].span;
        text.prompt.get(text.tokens[span.start].start..text.tokens[span.end - 1].end).unwrap_or(&label).to_owned()
    });
    out.wishes.push(Wish {
        room_type: id.to_owned(),
        count: counted.0,
        exact: counted.1,
        name,
        area_m2,
        sides_m: None,
        size,
        listed: counted.2,
    });
}

/// Returns count, whether it is exact, and whether the type is listed.
fn count_mentions(
    text: &Text,
    positive: &[usize],
    short: Option<i64>,
    label: &str,
    conflicts: &mut Vec<Note>,
) -> Option<(u32, bool, bool)> {
    let (mut head, mut sum, mut explicit, mut exact, mut listed) = (short, 0i64, false, true, false);
    let mut references = 0i64;
    let mut first = true;
    for &m in positive {
        let mention = &text.mentions[m];
        if mention.numbered.is_some() {
            listed |= !is_reference(text, m, first);
            continue;
        }
        let n = mention.count.unwrap_or(if mention.plural { 2 } else { 1 });
        let in_name = mention.span.start < text.list_from && mention.count.is_some() && !mention.article;
        let again = is_reference(text, m, first);
        if in_name && text.list_from < text.tokens.len() {
            head = Some(head.map_or(n, |h| h.max(n)));
        } else if again {
            references = references.max(n);
        } else {
            sum += n;
            listed = true;
            explicit |= mention.count.is_some() && !mention.article;
            exact &= !mention.vague && (mention.count.is_some() || !mention.plural);
            first = false;
        }
    }
    let listed_any = listed || !positive.is_empty();
    if let Some((numbered, from_one)) = numbered::count(positive.iter().map(|&m| &text.mentions[m])) {
        // "master bedroom, bedroom 1, bedroom 2", but "three bedrooms; bedroom 1 is next to the bathroom"
        sum = if explicit || !from_one { sum.max(numbered.into()) } else { sum + i64::from(numbered) };
        explicit = true;
    }
    if let Some(h) = head {
        if sum > h && explicit {
            conflicts.push(Note::new(
                "contradicting_counts",
                format!("the prompt asks for {h} and for {sum} rooms of type {label}; {sum} were planned"),
            ));
            return Some((clamp(sum), true, listed_any));
        }
        return Some((clamp(h), true, listed_any));
    }
    let n = if sum > 0 { sum } else { references };
    (n > 0).then(|| (clamp(n), exact, true))
}

fn clamp(n: i64) -> u32 {
    u32::try_from(n.clamp(0, MANY * 1000)).unwrap_or(0)
}

/// Returns true when a mention speaks of rooms named before, or elsewhere.
fn is_reference(text: &Text, m: usize, first: bool) -> bool {
    let mention = &text.mentions[m];
    let numbered = mention.count.is_some() && !mention.article;
    // "the main one with a bathroom, and another bathroom"
    let another = |i: usize| tag_ends_at(text.spoken, text.tokens, i, Tag::Another, mention.span.start);
    if (mention.span.start.saturating_sub(2)..mention.span.start).any(another) {
        return false;
    }
    let same = |other: &Mention| other.what == mention.what;
    let others =
        text.mentions.iter().enumerate().any(|(o, other)| {
            o != m && same(other) && !text.said.objects.contains(&o) && !text.said.negated.contains(&o)
        });
    // "3 bedrooms; each bedroom has a bathroom"
    let host = mention.count.is_none() && !mention.plural && text.said.each.iter().any(|e| e.1 == m);
    if host && others {
        return true;
    }
    let object = text.said.objects.contains(&m);
    if !first && on_its_own_storey(text, m) {
        return false;
    }
    if object && (others || !first) {
        return true;
    }
    if first {
        return is_told_again(text, m);
    }
    let subject = text.said.subjects.contains(&m);
    if mention.definite || subject && !numbered {
        return true;
    }
    if mention.count.is_some() {
        return false;
    }
    // A bare repeated word is a room of its own only as a list item.
    let mark = |i: Option<usize>| i.and_then(|i| text.tokens.get(i)).is_none_or(Token::is_mark);
    !(mark(mention.from.checked_sub(1)) && mark(Some(mention.end())))
}

/// Returns true for the first mention of a room that only says something of it, where the prompt lists it behind that: "the
/// kitchen must be next to the hall. A house with a kitchen ...", "robots stay out of the bathroom, one bathroom, ...".
fn is_told_again(text: &Text, m: usize) -> bool {
    let mention = &text.mentions[m];
    if mention.count.is_some() || mention.numbered.is_some() || text.said.every.contains(&m) {
        return false;
    }
    let mark = |i: Option<usize>| i.and_then(|i| text.tokens.get(i)).is_none_or(Token::is_mark);
    let related = text.said.subjects.contains(&m) || text.said.objects.contains(&m);
    let listed = |o: usize| {
        let other = &text.mentions[o];
        let item = mark(other.from.checked_sub(1)) && mark(Some(other.end()));
        let counted = other.count.is_some() && !other.vague;
        let told = text.said.subjects.contains(&o) || text.said.objects.contains(&o);
        other.what == mention.what
            && !other.definite
            && other.numbered.is_none()
            && !text.said.negated.contains(&o)
            && (counted || item && !told)
    };
    let parted = |o: usize| (mention.end()..text.mentions[o].from).any(|i| text.tokens[i].ends_sentence());
    (m + 1..text.mentions.len()).any(|o| listed(o) && (mention.definite || related && parted(o)))
}

/// Returns true for a room on a storey where the prompt names no other of its type: "two bedrooms on the first floor, on the
/// second a bedroom with its own bathroom".
fn on_its_own_storey(text: &Text, m: usize) -> bool {
    let mention = &text.mentions[m];
    let storey = |i: usize| text.storeys.get(i).copied().flatten();
    let Some(here) = storey(m).filter(|_| !mention.definite || mention.count.is_some()) else { return false };
    let mut before = (0..m).filter(|&o| text.mentions[o].what == mention.what && !text.said.negated.contains(&o));
    let beside = text.said.relations.iter().any(|r| r.object == m && !r.belongs);
    !beside && before.all(|o| storey(o).is_some_and(|other| other != here))
}

/// Counts rooms that come with each of another: 8 guest rooms with a bathroom each are 8 bathrooms.
fn each_of_host(text: &Text, out: &mut Wishes) {
    for &(guest, host) in &text.said.each {
        let (Some(g), Some(h)) = (text.mentions[guest].room_type(), text.mentions[host].room_type()) else { continue };
        let hosts = out.wishes.iter().find(|w| w.room_type == h).map_or(0, |w| w.count);
        // "6 double rooms, 2 single rooms, each with bathroom": all of them
        let alike = (0..=host).rev().take_while(|&m| text.mentions[m].room_type() == Some(h));
        let counted: u32 = alike.filter_map(|m| text.mentions[m].count).map(clamp).fold(0, u32::saturating_add);
        let here = text.mentions[host].count.map_or(hosts, |_| counted).max(1);
        let own = clamp(text.mentions[guest].count.unwrap_or(1).max(1));
        let elsewhere: u32 = text
            .mentions
            .iter()
            .enumerate()
            .filter(|(m, other)| {
                *m != guest
                    && other.room_type() == Some(g)
                    && !is_reference(text, *m, false)
                    && !text.said.negated.contains(m)
                    && !text.said.each.iter().any(|e| e.0 == *m)
            })
            .map(|(_, other)| clamp(other.count.unwrap_or(1)))
            .sum();
        if let Some(wish) = out.wishes.iter_mut().find(|w| w.room_type == g) {
            wish.count = wish.count.max(here.saturating_mul(own).saturating_add(elsewhere));
            wish.exact = true;
        }
    }
}

/// Counts what comes with each of rooms that were counted by those who sleep there: "14 residents in single rooms with private
/// bathrooms" have 14.
pub(crate) fn each_of_counted(mentions: &[Mention], each: &[(usize, usize)], wishes: &mut Wishes) {
    for &(guest, host) in each {
        let open = mentions[guest].count.is_none() && mentions[host].count.is_none();
        let (Some(g), Some(h)) = (mentions[guest].room_type(), mentions[host].room_type()) else { continue };
        let hosts = wishes.wishes.iter().find(|w| w.room_type == h && w.exact).map_or(0, |w| w.count);
        if let Some(wish) = wishes.wishes.iter_mut().find(|w| open && w.room_type == g) {
            wish.count = wish.count.max(hosts);
        }
    }
}

/// Returns the area that belongs to a mention: "kitchen of 12 m2", "12 m2 kitchen", "living room (30 m2)".
fn room_area(text: &Text, mention: &Mention) -> Option<f64> {
    text.areas
        .iter()
        .find(|area| {
            let after = mention.span.end..area.span.start;
            let before = area.span.end..mention.from;
            let short = |range: &std::ops::Range<usize>| {
                range.start <= range.end && range.len() <= MOST_TO_AREA && leads_to_area(text, range.clone())
            };
            // "flat, living room of at least 30 m2": an item by its mark
            let item = mention.from.checked_sub(1).is_some_and(|i| text.tokens[i].is_mark()) && !after.is_empty();
            (area.sides || item || mention.span.start >= text.list_from.min(text.tokens.len()))
                && (area.span.start >= mention.span.end && short(&after)
                    || area.span.end <= mention.from && before.is_empty())
        })
        .map(|area| area.value)
}

/// Returns true for words between a room and its area: "of", "larger than", "of at least".
fn leads_to_area(text: &Text, words: std::ops::Range<usize>) -> bool {
    let mut at = words.start;
    while at < words.end {
        let token = &text.tokens[at];
        let little = ["of", "with", "mit", "von", "de", "d", "con", "a", "à", "about", "each", "etwa"];
        let bracket = token.mark() == Some(',') && text.prompt.as_bytes().get(token.start) == Some(&b'(');
        match measure_end(text.tokens, at).filter(|end| *end <= words.end) {
            Some(end) => at = end,
            None if bracket || little.contains(&token.text.as_str()) => at += 1,
            None => return false,
        }
    }
    true
}

/// Returns the end of words between a thing and its measure: "at least".
fn measure_end(tokens: &[Token], i: usize) -> Option<usize> {
    words().languages.values().filter_map(|s| s.tag_at(tokens, i, Tag::Measure)).max()
}

/// Returns true when an area belongs to a room, not to the building.
pub(crate) fn is_room_area(text: &Text, area: &Area) -> bool {
    text.mentions
        .iter()
        .filter(|m| m.room_type().is_some())
        .any(|m| room_area(&Text { areas: std::slice::from_ref(area), ..*text }, m).is_some())
}
