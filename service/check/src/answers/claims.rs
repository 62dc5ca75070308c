//! Which rooms of a world each wish for rooms became. A room answers one wish; only a wish that names rooms again (in a later
//! sentence, or within the words of a relation or of a robot's task) shares those that were named first.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::brief::{Ask, Bound, Brief, Fact, RoomsAsk, Subject};
use d3dgen_model::domain::{Domain, GENERIC_ROOM_TYPE, RoomType, Words};
use d3dgen_model::offer::sleeps;
use d3dgen_model::scene_graph::GraphRoom;
use d3dgen_model::world::World;

/// Id of the way into the building, which is no room: the rooms that one enters it through.
pub(super) const ENTRANCE: &str = "entrance";

/// How near a room is to one that is asked for by a name, nearest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Likeness {
    /// Called so on the plan, and what stands there is what the name says.
    Named,
    /// Called so on the plan, and furnished as a room that the domain has other words for.
    NamedOnly,
    /// Of the type.
    Type,
    /// Of a type that has the same word.
    Word,
    /// Of a kind of the type: `patient_room_double` of `patient_room`.
    Kind,
}

impl Likeness {
    const ALL: [Self; 5] = [Self::Named, Self::NamedOnly, Self::Type, Self::Word, Self::Kind];
}

/// What names of rooms stand for in a building.
#[derive(Clone, Copy)]
pub(super) struct Kinds<'a> {
    domain: &'a Domain,
    /// Room types that the building has in the place of others: the bedroom of a psychiatric ward is its patient room.
    means: Option<&'a BTreeMap<String, String>>,
}

impl<'a> Kinds<'a> {
    /// Returns what they stand for in a building of that kind.
    pub fn of(domain: &'a Domain, building_type: Option<&str>) -> Self {
        let kind = building_type.and_then(|id| domain.building_type(id));
        let program = kind.and_then(|b| domain.program(&b.program));
        Self { domain, means: program.map(|p| &p.means) }
    }

    /// Returns how near a room is to the one that goes by a name; `None` for another room.
    pub fn likeness(&self, subject: &Subject, room: &GraphRoom) -> Option<Likeness> {
        let name = as_id(&subject.name);
        let id = subject.id.as_deref().unwrap_or(&name);
        let is_called = !name.is_empty() && is_same_name(&as_id(plan_name(room)), &name);
        let meant = self.meant(id).is_some_and(|meant| is_kind_of(&room.room_type, meant));
        let of_type = room.room_type == id || meant || id == ENTRANCE && room.entrance;
        let kind = self.domain.room_type_or_lent(&room.room_type);
        let has = |k: &RoomType| has_word(&k.keywords, &subject.name) || has_word(&k.called, &subject.name);
        let worded = kind.is_some_and(has);
        let like = of_type || worded || is_kind_of(&room.room_type, id);
        match (is_called, like) {
            // a room whose type nobody knows is nothing but its name
            (true, false) if kind.is_none() => Some(Likeness::Named),
            (true, true) => Some(Likeness::Named),
            (true, false) => Some(Likeness::NamedOnly),
            (false, true) if of_type => Some(Likeness::Type),
            (false, true) if worded => Some(Likeness::Word),
            (false, true) => Some(Likeness::Kind),
            (false, false) => None,
        }
    }

    /// Returns the type that the building has in the place of another: of a room to sleep in that only other kinds of buildings have
    /// the one that its guests sleep in.
    fn meant(&self, id: &str) -> Option<&'a str> {
        let means = self.means?;
        let domain = self.domain;
        let lent = domain.room_type(id).is_none();
        let asleep = || lent && domain.room_type_or_lent(id).is_some_and(|kind| sleeps(domain, kind).is_some());
        means.get(id).or_else(|| means.get(GENERIC_ROOM_TYPE).filter(|_| asleep())).map(String::as_str)
    }

    /// Returns true for a room that stands for one that is asked for and not there: of the same part of the building, and furnished
    /// first with a thing of the same shape (the bed of a care home's room for that of a ward).
    fn is_near(&self, subject: &Subject, room: &GraphRoom) -> bool {
        let first = |id: &str| {
            let kind = self.domain.room_type_or_lent(id)?;
            let line = kind.furnishing.iter().find(|line| line.required)?;
            Some((kind.zone, self.domain.anchor(&line.item)?.shape))
        };
        let asked = subject.id.as_deref().and_then(first);
        asked.is_some() && asked == first(&room.room_type)
    }
}

/// Returns true for a name that is another, or the same in the singular.
fn is_same_name(name: &str, asked: &str) -> bool {
    name == asked || asked.strip_suffix('s') == Some(name)
}

/// Returns the name of a room on the plan without its number: `Patient room` of `Patient room 3`.
fn plan_name(room: &GraphRoom) -> &str {
    room.name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end()
}

/// Returns a name as ids are written: `Patient Room` is `patient_room`.
pub(super) fn as_id(name: &str) -> String {
    let id: String = name.to_lowercase().chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
    id.trim_matches('_').to_owned()
}

/// Returns true for an id that is another, or a kind of it: `patient_room_double` and `accessible_toilet` of `patient_room`
/// and `toilet`.
pub(super) fn is_kind_of(id: &str, of: &str) -> bool {
    id == of
        || id.strip_prefix(of).is_some_and(|r| r.starts_with('_'))
        || id.strip_suffix(of).is_some_and(|r| r.ends_with('_'))
}

/// Returns true when one of the words names it, in any language.
pub(super) fn has_word(words: &Words, name: &str) -> bool {
    let name = name.to_lowercase();
    words.values().flatten().any(|w| *w == name)
}

/// A wish for rooms with what it became.
struct Wish<'a> {
    ask: &'a Ask,
    asked: &'a RoomsAsk,
    /// How near each room of the world is to it; `None` on another storey than the one asked for too.
    likeness: Vec<Option<Likeness>>,
    rooms: Vec<&'a GraphRoom>,
}

impl Wish<'_> {
    fn is_full(&self) -> bool {
        self.rooms.len() >= self.asked.count.n.max(1) as usize
    }
}

/// The rooms of each wish.
pub(super) struct Claims<'a> {
    /// By the place of the ask in the brief.
    rooms: BTreeMap<usize, Vec<&'a GraphRoom>>,
    taken: BTreeSet<&'a str>,
}

impl<'a> Claims<'a> {
    /// Deals the rooms of a world to the wishes for rooms of a brief: the likest first, those that somebody asked for before those that
    /// the program of the building added.
    pub fn of(brief: &'a Brief, world: &'a World, kinds: &Kinds) -> Self {
        let all = countable(world, kinds.domain);
        let wish = |(at, ask): (usize, &'a Ask)| {
            let Fact::Rooms(asked) = &ask.fact else { return None };
            let level = asked.level.or_else(|| level_said(brief, ask));
            let on_level = |room: &GraphRoom| level.is_none_or(|level| room.level == level);
            let like = |room: &&GraphRoom| kinds.likeness(&asked.room, room).filter(|_| !asked.among && on_level(room));
            Some((at, Wish { ask, asked, likeness: all.iter().map(like).collect(), rooms: Vec::new() }))
        };
        let mut wishes: Vec<(usize, Wish)> = brief.asks.iter().enumerate().filter_map(wish).collect();
        let mut taken = vec![false; all.len()];
        for likeness in Likeness::ALL {
            for requested in [true, false] {
                for (_, wish) in &mut wishes {
                    for (i, room) in all.iter().enumerate() {
                        let fits = wish.likeness[i] == Some(likeness) && room.requested == requested;
                        if fits && !taken[i] && !wish.is_full() {
                            taken[i] = true;
                            wish.rooms.push(room);
                        }
                    }
                }
            }
        }
        take_rest(&mut wishes, &all, &mut taken);
        share(brief, &mut wishes, &all);
        take_near(&mut wishes, &all, &mut taken, kinds);
        let ids = all.iter().zip(&taken).filter(|(_, taken)| **taken).map(|(room, _)| room.id.as_str());
        Self { taken: ids.collect(), rooms: wishes.into_iter().map(|(at, wish)| (at, wish.rooms)).collect() }
    }

    /// Returns the rooms that the wish at this place of the brief became.
    pub fn rooms(&self, at: usize) -> &[&'a GraphRoom] {
        self.rooms.get(&at).map_or(&[], Vec::as_slice)
    }

    /// Returns true for a room that a wish for rooms became.
    pub fn is_taken(&self, room_id: &str) -> bool {
        self.taken.contains(room_id)
    }
}

/// Gives rooms that somebody asked for and that no wish took to one for such rooms: three bedrooms where two were asked for are three.
fn take_rest<'a>(wishes: &mut [(usize, Wish<'a>)], all: &[&'a GraphRoom], taken: &mut [bool]) {
    for (i, room) in all.iter().enumerate().filter(|(_, room)| room.requested) {
        let suits =
            |wish: &Wish| matches!(wish.likeness[i], Some(Likeness::Named | Likeness::NamedOnly | Likeness::Type));
        let open = |wish: &Wish| suits(wish) && wish.asked.count.bound == Bound::AtLeast;
        if taken[i] {
            continue;
        }
        let at = wishes.iter().position(|(_, w)| open(w)).or_else(|| wishes.iter().position(|(_, w)| suits(w)));
        if let Some(at) = at {
            taken[i] = true;
            wishes[at].1.rooms.push(room);
        }
    }
}

/// Gives wishes that name rooms again those that were named before.
fn share<'a>(brief: &Brief, wishes: &mut [(usize, Wish<'a>)], all: &[&'a GraphRoom]) {
    for i in 0..wishes.len() {
        let (_, wish) = &wishes[i];
        let open = wish.asked.count.bound == Bound::AtLeast || is_summary(brief, wish.ask);
        if !wish.rooms.is_empty() || !open || wish.asked.among {
            continue;
        }
        let likes =
            |room: &GraphRoom| all.iter().position(|r| r.id == room.id).is_some_and(|at| wish.likeness[at].is_some());
        let same = |other: &Wish| {
            other.rooms.iter().all(|r| likes(r)) && is_again(brief, (other.ask, other.asked), (wish.ask, wish.asked))
        };
        let first = wishes.iter().find(|(_, w)| !w.rooms.is_empty() && same(w));
        if let Some(rooms) = first.map(|(_, w)| w.rooms.clone()) {
            wishes[i].1.rooms = rooms;
        }
    }
}

/// Gives wishes of which nothing is there the rooms that somebody asked for, that no wish took and that are near to it.
fn take_near<'a>(wishes: &mut [(usize, Wish<'a>)], all: &[&'a GraphRoom], taken: &mut [bool], kinds: &Kinds) {
    for (_, wish) in wishes.iter_mut().filter(|(_, w)| w.rooms.is_empty() && !w.asked.among) {
        for (i, room) in all.iter().enumerate() {
            let on_level = wish.asked.level.is_none_or(|level| room.level == level);
            if room.requested && !taken[i] && on_level && !wish.is_full() && kinds.is_near(&wish.asked.room, room) {
                taken[i] = true;
                wish.rooms.push(room);
            }
        }
    }
}

/// Returns the rooms that wishes count. Stairs and lifts have a room on each storey, and are one; what joins no storeys is neither.
fn countable<'a>(world: &'a World, domain: &Domain) -> Vec<&'a GraphRoom> {
    let graph = &world.scene_graph;
    let joins = |r: &GraphRoom| domain.circulation.storeys.as_ref().is_some_and(|s| s.joins(&r.room_type));
    let first = |r: &GraphRoom| graph.links.iter().any(|link| link.room_ids.first() == Some(&r.id));
    graph.rooms.iter().filter(|r| !joins(r) || first(r)).collect()
}

/// Returns true where a wish for rooms speaks of what another named, and asks for nothing more: by the same name without a word more, in
/// another sentence, as a part of what is said of something else, or where one of them sums up what there is.
fn is_again(brief: &Brief, (first, named): (&Ask, &RoomsAsk), (again, asked): (&Ask, &RoomsAsk)) -> bool {
    let plain = RoomsAsk { room: named.room.clone(), ..RoomsAsk::default() };
    if *asked == plain || is_summary(brief, first) || is_summary(brief, again) {
        return true;
    }
    let (Some(a), Some(b)) = (first.words.last(), again.words.last()) else { return false };
    let (start, end) = if a.end <= b.start { (a.end, b.start) } else { (b.end, a.start) };
    let between: Vec<char> =
        brief.prompt.chars().skip(start as usize).take(end.saturating_sub(start) as usize).collect();
    let is_end = |i: usize| match between[i] {
        '.' => between.get(i + 1).is_none_or(|c| c.is_whitespace()),
        c => matches!(c, '!' | '?' | '\n' | '。' | '！' | '？'),
    };
    let tells = |ask: &&Ask| matches!(ask.fact, Fact::Relation(_) | Fact::Robots(_) | Fact::Forbidden(_));
    let around = |ask: &Ask| ask.words.iter().any(|w| w.start <= b.start && b.end <= w.end);
    (0..between.len()).any(is_end) || brief.asks.iter().filter(tells).any(around)
}

/// Returns true for words that several wishes for rooms share: "5 BHK" and "3-room flat" sum up what may be named one by one.
fn is_summary(brief: &Brief, ask: &Ask) -> bool {
    let same = |other: &&Ask| matches!(&other.fact, Fact::Rooms(r) if !r.among) && other.words == ask.words;
    !ask.words.is_empty() && brief.asks.iter().filter(same).count() > 1
}

/// Returns the storey that a fact is said of by words that it shares with rooms of which the storey is known: "upstairs ... a bath"
/// beside "upstairs ... two bedrooms".
pub(super) fn level_said(brief: &Brief, ask: &Ask) -> Option<i32> {
    let [said, _, ..] = &ask.words[..] else { return None };
    let of = |other: &Ask| match &other.fact {
        Fact::Rooms(rooms) if other.words.len() > 1 && other.words[0] == *said => rooms.level,
        _ => None,
    };
    brief.asks.iter().find_map(of)
}
