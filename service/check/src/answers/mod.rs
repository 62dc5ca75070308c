//! What became of everything that the brief asks for: each fact measured in the finished world, from its documents alone.
//!
//! A fact is honored when the world has what it says, whoever put it there: in the rooms that it says, which are those that the
//! wish for them became ([`claims`]), and nowhere else. What is not there as asked is answered with what is there instead, or with
//! the reason; what no document can tell is said to be left out, never to be there.

mod claims;
mod objects;
mod people;
mod places;
mod relations;
mod robots;
mod rooms;
mod subjects;
mod whole;

use d3dgen_model::brief::{Ask, AskedCount, Brief, Fact, PromptWords, Subject};
use d3dgen_model::domain::Domain;
use d3dgen_model::report::{AskAnswer, Fate};
use d3dgen_model::scene_graph::GraphRoom;
use d3dgen_model::world::World;

use self::claims::{Claims, Kinds};

/// Share by which a floor area or side that was asked for may be missed.
const MEASURE_MISS: f64 = 0.05;
/// Letters of a name from which a conflict that has it is taken to speak of the wish that has it too; names in scripts whose words are
/// short have fewer.
const TELLING_LETTERS: usize = 4;
/// Code of the conflict that lists all words that nobody understood: it speaks of no wish.
const NOT_UNDERSTOOD: &str = "not_understood";
/// Rooms and things that a reason names, at most.
const MOST_NAMED: usize = 4;

/// What the answers are looked up in.
struct Asked<'a> {
    brief: &'a Brief,
    world: &'a World,
    domain: &'a Domain,
    kinds: Kinds<'a>,
    claims: Claims<'a>,
}

/// What was found of one fact, before it is written down.
struct Finding {
    fate: Fate,
    /// Ids of what answers it.
    ids: Vec<String>,
    /// Number or measure asked for.
    asked: Option<f64>,
    /// What the world has.
    measured: Option<f64>,
    unit: &'static str,
    /// Why it is not as asked; empty where it is.
    reason: String,
}

impl Finding {
    fn honored(ids: Vec<String>) -> Self {
        Self { fate: Fate::Honored, ids, asked: None, measured: None, unit: "", reason: String::new() }
    }

    fn of(fate: Fate, reason: String) -> Self {
        Self { fate, reason, ..Self::honored(Vec::new()) }
    }

    /// Returns what a yes or no comes to.
    fn when(holds: bool, ids: Vec<String>, reason: impl FnOnce() -> String) -> Self {
        if holds { Self::honored(ids) } else { Self { ids, ..Self::of(Fate::LeftOut, reason()) } }
    }

    /// Returns what so many of a number asked for come to: fewer or more are a substitute, none are left out. The reason is asked
    /// for where the number is not kept.
    fn number(count: AskedCount, n: u32, reason: impl FnOnce() -> String) -> Self {
        let fate = match (count.allows(n), n) {
            (true, _) => Fate::Honored,
            (false, 0) => Fate::LeftOut,
            (false, _) => Fate::Substituted,
        };
        let reason = if fate == Fate::Honored { String::new() } else { reason() };
        Self { asked: Some(f64::from(count.n)), measured: Some(f64::from(n)), ..Self::of(fate, reason) }
    }

    /// Returns what a measure comes to that may be missed by a share of it.
    fn measure(asked: f64, measured: f64, miss: f64, (unit, what): (&'static str, &str)) -> Self {
        let holds = (measured - asked).abs() <= miss * asked;
        let fate = if holds { Fate::Honored } else { Fate::Substituted };
        let reason =
            if holds { String::new() } else { format!("{what} {measured:.1} {unit}, {asked:.1} {unit} asked for") };
        Self { asked: Some(asked), measured: Some(measured), unit, ..Self::of(fate, reason) }
    }

    /// Returns the worse of two findings about the same things, with the reasons of both.
    fn and(self, other: Self) -> Self {
        let (worse, better) = if other.fate > self.fate { (other, self) } else { (self, other) };
        let reason = [worse.reason.as_str(), better.reason.as_str()].into_iter().filter(|r| !r.is_empty());
        Self {
            reason: reason.collect::<Vec<_>>().join("; "),
            ids: if worse.ids.is_empty() { better.ids } else { worse.ids },
            ..worse
        }
    }

    /// Returns it with the ids of what answers it.
    fn with(self, ids: Vec<String>) -> Self {
        Self { ids, ..self }
    }

    /// Returns something near to it where it was left out.
    fn or_near(self) -> Self {
        Self { fate: self.fate.min(Fate::Substituted), ..self }
    }
}

/// Returns what became of each thing that a brief asks for, in the order of the brief.
pub fn answers(brief: &Brief, world: &World, domain: &Domain) -> Vec<AskAnswer> {
    let kinds = Kinds::of(domain, world.scene_graph.building_type.as_deref());
    let asked = Asked { brief, world, domain, kinds, claims: Claims::of(brief, world, &kinds) };
    brief.asks.iter().enumerate().map(|(at, ask)| asked.answer(at, ask)).collect()
}

impl<'a> Asked<'a> {
    fn answer(&self, at: usize, ask: &Ask) -> AskAnswer {
        let mut found = self.find(at, ask).and(self.unread_part(ask));
        // what is there and of another kind or not wholly read is not what a conflict is about
        let is_short = found.fate == Fate::LeftOut || found.fate == Fate::Substituted && found.asked.is_some();
        if is_short && let Some(message) = self.told_of(&ask.fact) {
            found.fate = Fate::Contradicted;
            found.reason = if found.reason.is_empty() { message } else { format!("{}; {message}", found.reason) };
        }
        AskAnswer {
            ask_id: ask.id.clone(),
            said: ask.said(),
            kind: ask.fact.name().to_owned(),
            fate: found.fate,
            ids: found.ids,
            asked: found.asked,
            measured: found.measured.map(|m| (m * 1000.0).round() / 1000.0),
            unit: found.unit.to_owned(),
            reason: found.reason,
        }
    }

    fn find(&self, at: usize, ask: &Ask) -> Finding {
        match &ask.fact {
            Fact::Rooms(rooms) => self.rooms(at, ask, rooms),
            Fact::Objects(objects) => self.objects(ask, objects),
            Fact::Capacity(capacity) => self.capacity(ask, capacity),
            Fact::Relation(relation) => self.relation(ask, relation),
            Fact::Storeys(storeys) => self.storeys(storeys),
            Fact::Area(area) => self.area(area),
            Fact::Robots(robots) => self.robots(ask, robots),
            Fact::People(people) => self.people(people),
            Fact::Style(style) => self.style(style),
            Fact::Accessible(access) => self.accessible(ask, access),
            Fact::Forbidden(forbidden) => self.forbidden(ask, forbidden),
            Fact::Only(only) => self.only(only),
            Fact::Site(site) => self.site(site),
            Fact::Other(_) => Finding::of(Fate::LeftOut, "nothing here builds that".into()),
        }
    }

    /// Returns what of a wish for something was not read: a word that touches its own says what it is to be, a "massage" chair.
    fn unread_part(&self, ask: &Ask) -> Finding {
        let is_thing = matches!(ask.fact, Fact::Rooms(_) | Fact::Objects(_) | Fact::Capacity(_) | Fact::Robots(_));
        let Some(own) = ask.words.last().filter(|_| is_thing) else { return Finding::honored(Vec::new()) };
        let own = named_in(own, &ask.fact);
        let unread: Vec<String> =
            self.brief.not_understood.iter().filter(|w| self.touch(&own, w)).map(|w| format!("`{}`", w.text)).collect();
        let reason = || format!("{} was not understood", unread.join(" and "));
        Finding::when(unread.is_empty(), Vec::new(), reason).or_near()
    }

    /// Returns true for words of the prompt with nothing between them but a blank, a hyphen or an apostrophe.
    fn touch(&self, a: &PromptWords, b: &PromptWords) -> bool {
        let (first, second) = if a.start <= b.start { (a, b) } else { (b, a) };
        let gap = second.start.saturating_sub(first.end);
        let is_joint = |c: char| c == ' ' || matches!(c, '-' | '\'' | '\u{2019}' | '\u{2011}');
        self.brief.prompt.chars().skip(first.end as usize).take(gap as usize).all(is_joint)
    }

    /// Returns the conflict of the world that speaks of what a fact names.
    fn told_of(&self, fact: &Fact) -> Option<String> {
        let subjects: Vec<&Subject> = match fact {
            Fact::Rooms(rooms) => vec![&rooms.room],
            Fact::Objects(objects) => vec![&objects.object],
            Fact::Relation(relation) => vec![&relation.a, &relation.b],
            _ => return None,
        };
        let graph = &self.world.scene_graph;
        let said = graph.conflicts.iter().chain(&self.world.floorplan.conflicts);
        let said = said.filter(|n| n.code != NOT_UNDERSTOOD);
        said.map(|n| &n.message).find(|m| subjects.iter().all(|s| names(m, s))).cloned()
    }

    /// Returns the storey that a fact is said of, where it is said.
    fn level_of(&self, ask: &Ask) -> Option<i32> {
        claims::level_said(self.brief, ask)
    }
}

/// Returns the words of a fact that name what it asks for, of all that state it.
fn named_in(words: &PromptWords, fact: &Fact) -> PromptWords {
    let name = match fact {
        Fact::Rooms(rooms) => &rooms.room.name,
        Fact::Objects(objects) => &objects.object.name,
        _ => return words.clone(),
    };
    let Some(at) = words.text.find(name.as_str()).filter(|_| !name.is_empty()) else { return words.clone() };
    let start = words.start + words.text[..at].chars().count() as u32;
    PromptWords { start, end: start + name.chars().count() as u32, text: name.clone() }
}

/// Returns true for a message with the name or the id of something in it.
fn names(message: &str, subject: &Subject) -> bool {
    let message = message.to_lowercase();
    let is_telling =
        |word: &str| word.chars().count() >= TELLING_LETTERS || word.chars().nth(1).is_some() && !word.is_ascii();
    let id = subject.id.clone().unwrap_or_default();
    let words = [subject.name.to_lowercase(), id.replace('_', " "), id];
    let ends = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric());
    words.iter().filter(|w| is_telling(w)).any(|word| {
        message.match_indices(word.as_str()).any(|(at, _)| {
            let own_letters = !word.is_ascii();
            let before = message[..at].chars().next_back();
            own_letters || ends(before) && ends(message[at + word.len()..].chars().next())
        })
    })
}

/// Returns the ids of rooms.
fn ids_of(rooms: &[&GraphRoom]) -> Vec<String> {
    rooms.iter().map(|r| r.id.clone()).collect()
}

/// Returns names as people list them: `Kitchen, Office 1 and 3 more`.
fn listed(names: &[&str]) -> String {
    let some = names.iter().take(MOST_NAMED).copied().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MOST_NAMED) {
        0 => some,
        more => format!("{some} and {more} more"),
    }
}

/// Returns the names of rooms as people list them.
fn names_of(rooms: &[&GraphRoom]) -> String {
    listed(&rooms.iter().map(|r| r.name.as_str()).collect::<Vec<_>>())
}
