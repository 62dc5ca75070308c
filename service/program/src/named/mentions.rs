//! Rooms, people and totals that a prompt names, each with its number.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Access, Domain, GENERIC_ROOM_TYPE, RoomType, Zone};
use d3dgen_model::offer;
use d3dgen_model::offer::{MOST_IN_TEAM, works_in};
use d3dgen_plugins::Registry;

use super::compounds::{self};
use super::counts;
use super::named_for;
use super::numbered;
use super::unknown;
use crate::named::mention::{Mention, What};
use crate::named::taken::Taken;
use crate::subject::programs::is_dwelling;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Kind, Phrases, Span, Token, fold};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end, tag_ends_at, words};

/// Words between a room and those who say for whom it is, at most: "toilets for men and women".
const MOST_TO_SEXES: usize = 5;

/// A word for a room.
#[derive(Debug, Clone, PartialEq)]
struct RoomWord {
    id: String,
    /// Letters of the phrase, of its first word in languages whose noun comes first; a longer form of it is its plural.
    letters: usize,
    /// Further types with the same word: the control room of either scanner.
    others: Vec<String>,
}

/// Words for rooms in the prompt's languages.
pub(crate) struct Vocabulary {
    own: Vec<Phrases<RoomWord>>,
    foreign: Vec<Phrases<RoomWord>>,
    /// Room types of the domain itself.
    ids: BTreeSet<String>,
    /// Those that people have desks in, and the open one of them.
    desks: BTreeSet<String>,
    open_office: Option<String>,
    /// Types with a desk for so many, by the number: offices that are called by it.
    by_desks: BTreeMap<u32, String>,
    /// Offices of other domains that this one does not know, with the least desks of each.
    strange_offices: BTreeMap<String, u32>,
    /// True for homes.
    lives: bool,
    /// Those of which men and women have one each.
    parted: BTreeSet<String>,
}

impl Vocabulary {
    /// Collects the room words of the domain and, for rooms it does not know, of all other domains.
    pub(crate) fn new(domain: &Domain, registry: &Registry, languages: &[&str]) -> Self {
        let own = languages.iter().map(|l| phrases(std::iter::once(domain), l)).collect();
        // what all kinds of buildings have comes before what one kind has
        let common = |d: &&Domain| d.id == words().common_domain;
        let all = || registry.iter().map(|p| p.domain()).filter(|d| d.id != domain.id);
        let others = || all().filter(common).chain(all().filter(|d| !common(d)));
        let foreign = languages.iter().map(|l| phrases(others(), l)).collect();
        let ids = |test: &dyn Fn(&RoomType) -> bool| -> BTreeSet<String> {
            domain.room_types.iter().filter(|r| test(r)).map(|r| r.id.clone()).collect()
        };
        let desks = |kind: &RoomType| offer::desks(domain, kind);
        let most = |kind: &&RoomType| desks(kind).map_or(0, |d| d[1]);
        let open = domain.room_types.iter().filter(|k| desks(k).is_some()).max_by_key(most);
        let lives = domain.programs.iter().all(is_dwelling);
        Self {
            own,
            foreign,
            ids: ids(&|_| true),
            desks: ids(&|k| desks(k).is_some()),
            open_office: open.filter(|k| most(k) > MOST_IN_TEAM).map(|k| k.id.clone()),
            by_desks: (1..=20).filter_map(|n| Some((n, named_for::with_desks(domain, n)?.id.clone()))).collect(),
            strange_offices: all()
                .flat_map(|d| d.room_types.iter().filter(|k| works_in(d, k)).map(move |k| (d, k)))
                .filter(|(_, k)| domain.room_type(&k.id).is_none())
                .filter_map(|(d, k)| Some((k.id.clone(), offer::desks(d, k)?[0])))
                .collect(),
            lives,
            // "WC séparés" of a home are one, apart from its bathroom
            parted: ids(&|k| !lives && (k.wet && k.access != Access::Host || k.zone == Zone::Staff)),
        }
    }

    /// Returns end, room type and whether it is a plural of the longest room word at a token.
    fn at(&self, tokens: &[Token], i: usize, numbers: &[Number], spoken: &[&Spoken]) -> Option<(usize, &str, bool)> {
        let longest = |list: &'_ [Phrases<RoomWord>]| {
            let mut best: Option<(usize, String, usize)> = None;
            for found in list.iter().filter_map(|p| p.longest_at(tokens, i)) {
                if best.as_ref().is_none_or(|b| found.0 > b.0) {
                    best = Some((found.0, found.1.id.clone(), found.1.letters));
                }
            }
            best
        };
        let (own, foreign) = (longest(&self.own), longest(&self.foreign));
        // "two bedrooms" and "large kitchen" of another domain are numbers and adjectives before a room of this one
        let sized = spoken.iter().any(|s| s.sizes.longest_at(tokens, i).is_some());
        let loose = sized || numbers.iter().any(|n| n.span.start == i) || is_tagged(spoken, tokens, i, Tag::NotNames);
        let inside = |end: usize| {
            (i + 1..end).any(|k| self.own.iter().any(|p| p.longest_at(tokens, k).is_some_and(|o| o.0 >= end)))
        };
        // "salle de bains privée": the own word and an adjective; "Zimmer" anywhere but in a hotel: rooms in total
        let adjective = |from: usize, end: usize| {
            from > i
                && (from..end).all(|k| {
                    [Tag::Own, Tag::NotNames, Tag::Accessible].iter().any(|&t| is_tagged(spoken, tokens, k, t))
                })
        };
        let total = |end: usize| tag_ends_at(spoken, tokens, i, Tag::Total, end);
        let own_to = own.as_ref().map_or(0, |o| o.0);
        // "salón comedor" is a living room and a dining room where both are known
        let two = |end: usize| {
            own_to > i && self.own.iter().any(|p| p.longest_at(tokens, own_to).is_some_and(|o| o.0 >= end))
        };
        let foreign = foreign.filter(|f| !(loose && inside(f.0) || adjective(own_to, f.0) || total(f.0) || two(f.0)));
        let own_end = own.as_ref().map_or(0, |o| o.0);
        let from_own = foreign.as_ref().is_none_or(|f| f.0 <= own_end);
        let (end, ..) = if from_own { own? } else { foreign? };
        let list = if from_own { &self.own } else { &self.foreign };
        let (phrases, word) =
            list.iter().find_map(|p| p.longest_at(tokens, i).filter(|f| f.0 == end).map(|f| (p, f.1)))?;
        // a keyword may be a plural itself ("single rooms"): its singular has the same stem
        let singular =
            phrases.by_stems(&tokens[i..end]).filter(|w| w.id == word.id).map_or(word.letters, |w| w.letters);
        let letters = letters(tokens[i..end].iter().map(|t| t.text.as_str()), phrases.language());
        Some((end, word.id.as_str(), letters > singular.min(word.letters)))
    }

    /// Returns the end and the type of an open room to work in: "open drafting room", "open studio space".
    fn open_work(&self, tokens: &[Token], i: usize, spoken: &[&Spoken]) -> Option<(usize, String)> {
        let id = self.open_office.as_ref()?;
        let from = tag_end(spoken, tokens, i, Tag::OpenPlan)?;
        let noun = |k: usize| [Tag::RoomWords, Tag::SpaceWords].iter().any(|&t| is_tagged(spoken, tokens, k, t));
        let plain = |k: &usize| tokens[*k].kind == Kind::Word && !is_tagged(spoken, tokens, *k, Tag::Stops);
        let last = (from + 1..(from + 3).min(tokens.len())).take_while(plain).find(|&k| noun(k))?;
        let known = self.own.iter().find_map(|p| p.longest_at(tokens, from)).filter(|f| f.0 == last + 1);
        let works = known.is_none_or(|f| self.desks.contains(&f.1.id));
        (works && tokens[from].kind == Kind::Word).then(|| (last + 1, id.clone()))
    }

    /// Returns the domain's room type that the words for the building end in ("chemistry lab").
    pub(crate) fn room_named(&self, tokens: &[Token]) -> Option<String> {
        let ends = |i: usize| self.own.iter().find_map(|p| p.longest_at(tokens, i).filter(|f| f.0 == tokens.len()));
        (0..tokens.len()).find_map(|i| ends(i).map(|f| f.1.id.clone()))
    }

    /// Returns the domain's own room type whose words are exactly these.
    pub(crate) fn own_at(&self, tokens: &[Token], span: Span) -> Option<String> {
        let found = self.own.iter().find_map(|p| p.longest_at(tokens, span.start).filter(|f| f.0 == span.end));
        found.map(|f| f.1.id.clone())
    }

    /// Returns the domain's own room types with the word at a span, where there are several.
    pub(super) fn senses_at(&self, tokens: &[Token], span: Span) -> Vec<String> {
        let at = |p: &Phrases<RoomWord>| {
            let (_, word) = p.longest_at(tokens, span.start).filter(|f| f.0 == span.end)?;
            (!word.others.is_empty()).then(|| std::iter::once(&word.id).chain(&word.others).cloned().collect())
        };
        self.own.iter().find_map(at).unwrap_or_default()
    }

    /// Returns the room types of all domains that the word at a span may mean, its own first.
    pub(super) fn meanings_at(&self, tokens: &[Token], span: Span) -> impl Iterator<Item = &String> {
        let words = self.own.iter().chain(&self.foreign).filter_map(move |p| p.longest_at(tokens, span.start));
        words.filter(move |f| f.0 == span.end).flat_map(|(_, word)| std::iter::once(&word.id).chain(&word.others))
    }

    /// Returns the end of the word for a room that begins at a token.
    pub(crate) fn room_end(&self, tokens: &[Token], i: usize, numbers: &[Number], spoken: &[&Spoken]) -> Option<usize> {
        if i < tokens.len() { self.at(tokens, i, numbers, spoken).map(|f| f.0) } else { None }
    }

    /// Returns true when a word for a room begins at a token.
    pub(crate) fn names_room(&self, tokens: &[Token], i: usize, numbers: &[Number], spoken: &[&Spoken]) -> bool {
        self.room_end(tokens, i, numbers, spoken).is_some()
    }

    /// Returns true when a room word of several tokens begins at a token and reaches an end.
    fn known_to(&self, tokens: &[Token], i: usize, end: usize) -> bool {
        let reaches = |p: &Phrases<RoomWord>| p.longest_at(tokens, i).is_some_and(|f| f.0 >= end && f.0 > i + 1);
        self.own.iter().chain(&self.foreign).any(reaches)
    }

    /// Returns the type and the desks of an office that one word names: "Teamleiterbüro", "Dreierbüros".
    fn office_at(&self, token: &Token, spoken: &[&Spoken]) -> Option<(&str, Option<u32>, bool)> {
        let office = named_for::office(token, spoken).filter(|_| !self.lives)?;
        let for_one = || self.by_desks.get(&1).map(String::as_str);
        let id = match office.desks {
            Some(n) => self.by_desks.get(&n).map(String::as_str)?,
            None => self.own.iter().find_map(|p| p.word(office.head)).map(|w| w.id.as_str()).or_else(for_one)?,
        };
        Some((id, office.desks, office.plural))
    }

    /// Returns the domain's own type for an office that only another one has: as many have their desk there.
    fn strange_office(&self, id: &str) -> Option<&str> {
        let desks = self.strange_offices.get(id).filter(|_| !self.lives)?;
        self.by_desks.get(desks).map(String::as_str)
    }

    /// Returns the domain's own room type for an unknown room, by what it is for or by a word for a room in its name.
    fn room_for(&self, tokens: &[Token], span: Span, spoken: &[&Spoken]) -> Option<String> {
        if self.lives {
            return None;
        }
        let matters = named_for::matters(tokens, span, spoken);
        let served = matters.into_iter().find(|id| self.ids.contains(*id)).cloned();
        served.or_else(|| named_for::known_part(tokens, span, &self.own).map(|w| w.id))
    }

    /// Returns the room type of a compound's ending ("Damentoilette").
    fn ending(&self, word: &str) -> Option<&str> {
        self.own.iter().find_map(|p| p.ending(word, 5)).map(|(w, _)| w.id.as_str())
    }

    /// Returns the room type of a phrase.
    pub(crate) fn whole(&self, text: &str) -> Option<&str> {
        self.own.iter().chain(&self.foreign).find_map(|p| p.whole(text)).map(|w| w.id.as_str())
    }
}

/// Returns the letters of a phrase that say how many there are: in French and Spanish those of the first word ("salles de
/// réunion"); in English whose a thing is says nothing of that ("visitors lounge").
fn letters<'t>(mut words: impl DoubleEndedIterator<Item = &'t str>, language: &str) -> usize {
    let count = |w: &str| w.chars().filter(|c| c.is_alphanumeric()).count();
    if matches!(language, "es" | "fr") {
        return words.next().map_or(0, count);
    }
    let mut words = words.rev();
    let last = words.next().map_or(0, count);
    // "class" is no plural
    let whose = |w: &'t str| w.strip_suffix('s').filter(|stem| language == "en" && !stem.ends_with('s')).unwrap_or(w);
    last + words.map(|w| count(whose(w))).sum::<usize>()
}

fn phrases<'a>(domains: impl Iterator<Item = &'a Domain>, language: &str) -> Phrases<RoomWord> {
    let mut phrases: Phrases<RoomWord> = Phrases::new(language);
    for domain in domains {
        for room in domain.room_types.iter().filter(|r| r.id != GENERIC_ROOM_TYPE) {
            let words = room.keywords.get(language).into_iter().flatten().map(String::as_str);
            let id = room.id.replace('_', " ");
            let id = if language == "en" { Some(id.as_str()) } else { None };
            for phrase in words.chain(id) {
                let folded: Vec<String> = phrase.split_whitespace().map(fold).collect();
                let letters = letters(folded.iter().map(String::as_str), language);
                phrases.put(phrase, RoomWord { id: room.id.clone(), letters, others: Vec::new() }, |old, new| {
                    let mut merged = old.clone();
                    if old.id == new.id {
                        merged.letters = old.letters.min(new.letters);
                    } else if !merged.others.contains(&new.id) {
                        merged.others.push(new.id.clone());
                    }
                    merged
                });
            }
        }
    }
    phrases
}

/// Returns all mentions in order.
pub(crate) fn mentions(
    tokens: &[Token],
    numbers: &[Number],
    vocabulary: &Vocabulary,
    spoken: &[&Spoken],
    language: &str,
    taken: &Taken,
) -> Vec<Mention> {
    let nouns = Nouns { tokens, numbers, vocabulary, spoken, language, taken };
    let mut out: Vec<Mention> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        if let Some(span) = taken.spans.iter().chain(&taken.head).find(|s| s.contains(i)) {
            i = span.end.max(i + 1);
            continue;
        }
        if tokens[i].is_mark() {
            i += 1;
            continue;
        }
        if let Some(compound) = taken.compounds.iter().find(|c| c.span.start == i) {
            out.extend(compounds::mentions(compound));
            i = compound.span.end;
            continue;
        }
        let told = taken.bed_rooms.iter().find(|b| b.span.start == i);
        let told = told.map(|b| (b.span.end, What::Room(b.room_type.clone()), b.plural, Some(b.beds)));
        let noun = || nouns.at(i).map(|(end, what, plural)| (end, what, plural, None));
        match told.or_else(noun) {
            Some((end, what, plural, beds)) => {
                out.push(Mention { plural, beds, ..Mention::plain(Span { start: i, end }, what) });
                i = end;
            }
            None => i += 1,
        }
    }
    ellipses(tokens, vocabulary, &mut out);
    drop_modifiers(tokens, vocabulary, &mut out);
    numbered::read(tokens, numbers, spoken, matches!(language, "zh" | "ko"), &mut out);
    counts::attach_numbers(tokens, numbers, spoken, language, taken, &mut out);
    compounds::settle(tokens, taken.compounds, spoken, &mut out);
    part_by_sex(tokens, vocabulary, spoken, &mut out);
    counts::count_hosts(tokens, spoken, &mut out);
    drop_echoes(tokens, taken, &mut out);
    out
}

/// Finds what a token names.
struct Nouns<'a> {
    tokens: &'a [Token],
    numbers: &'a [Number],
    vocabulary: &'a Vocabulary,
    spoken: &'a [&'a Spoken],
    language: &'a str,
    taken: &'a Taken<'a>,
}

/// What begins at a token: its end, what it is, and whether it is a plural.
type Noun = (usize, What, bool);

impl Nouns<'_> {
    fn at(&self, i: usize) -> Option<Noun> {
        let Self { tokens, numbers, vocabulary, spoken, taken, .. } = *self;
        // "a dozen rooms", "ein einzelnes Zimmer": what lies within a number names no room
        let counts = numbers.iter().any(|n| !n.article && n.span.start < i && i < n.span.end);
        if counts || is_tagged(spoken, tokens, i, Tag::Storeys) {
            return None;
        }
        if let Some(dock) = taken.docks.iter().find(|d| d.start == i) {
            return Some((dock.end, What::Charge, false));
        }
        if let Some((end, id)) = vocabulary.open_work(tokens, i, spoken).filter(|f| self.is_free(i, f.0)) {
            return Some((end, What::Room(id), false));
        }
        let room = self.room_at(i);
        if let Some(entrance) = self.entrance_at(i, room.as_ref()) {
            return Some(entrance);
        }
        match (room, self.people_at(i)) {
            (Some(room), Some(people)) if people.0 > room.0 => Some(people),
            // "30 hot desks" are places to work, not 30 offices
            (Some(room), Some(people))
                if people.1 == What::Desks
                    && people.0 == room.0
                    && numbers.iter().any(|n| n.span.end == i && !n.article) =>
            {
                Some(people)
            }
            (Some(room), _) => Some(room),
            (None, people) => self.unnamed_at(i, people),
        }
    }

    /// Returns true for words that name nothing else.
    fn is_free(&self, start: usize, end: usize) -> bool {
        !self.taken.spans.iter().chain(&self.taken.head).any(|s| s.overlaps(Span { start, end }))
    }

    /// Returns the room of a keyword.
    fn room_at(&self, i: usize) -> Option<Noun> {
        let Self { tokens, numbers, vocabulary, spoken, language, .. } = *self;
        vocabulary
            .at(tokens, i, numbers, spoken)
            // "für den Transport": a little word of the language names no room of another one
            .filter(|r| self.is_free(i, r.0) && !(r.0 == i + 1 && is_little(tokens, i, spoken, language)))
            // "cuarto de …" is no bedroom where nobody sleeps, "ascensor" the lift of the storeys and no room
            .filter(|r| {
                let span = Span { start: i, end: r.0 };
                let strange = !vocabulary.ids.contains(r.1) && !vocabulary.lives;
                !(strange && named_for::is_bare_noun(tokens, span, spoken))
            })
            // "Zweierbüro" is an office of this domain before it is a room of another
            .filter(|r| vocabulary.ids.contains(r.1) || vocabulary.office_at(&tokens[i], spoken).is_none())
            .map(|(end, id, plural)| (end, vocabulary.strange_office(id).unwrap_or(id), plural))
            .filter(|r| !spoken.iter().any(|s| s.tag_at(tokens, i, Tag::Lift).is_some_and(|end| end >= r.0)))
            // "open-plan" is no office where there are none
            .filter(|r| !tag_ends_at(spoken, tokens, i, Tag::OpenPlan, r.0) || vocabulary.ids.contains(r.1))
            .map(|(end, id, plural)| (end, What::Room(id.into()), plural))
    }

    /// Returns the entrance of the building, where that is no room.
    fn entrance_at(&self, i: usize, room: Option<&Noun>) -> Option<Noun> {
        let Self { tokens, spoken, .. } = *self;
        let end = tag_end(spoken, tokens, i, Tag::Entrance).filter(|&end| self.is_free(i, end))?;
        if room.is_some_and(|r| r.0 > end) {
            return None;
        }
        // "cafe at the entrance" means a place, "an entrance, a kitchen" a room
        let beside = |k: usize| [Tag::Near, Tag::Definite].iter().any(|&t| is_tagged(spoken, tokens, k, t));
        let near = (i.saturating_sub(2)..i).any(beside);
        // "입구에": the particle makes it a place
        let longer = room.is_some_and(|r| r.0 < end) && tokens[i].kind != Kind::Word;
        (near || longer || room.is_none()).then_some((end, What::Entrance, false))
    }

    /// Returns people and what is counted for them, all rooms, and places to charge.
    fn people_at(&self, i: usize) -> Option<Noun> {
        let whats = [
            (Tag::Staff, What::Staff),
            (Tag::StaffBefore, What::Staff),
            (Tag::Visitors, What::Visitors),
            (Tag::VisitorsBefore, What::Visitors),
            (Tag::Beds, What::Beds),
            (Tag::Desks, What::Desks),
            (Tag::Residents, What::Residents),
            (Tag::People, What::People),
            (Tag::Total, What::Total),
            (Tag::ChargePlace, What::Charge),
            (Tag::Charge, What::Charge),
        ];
        let found = whats.into_iter().filter_map(|(tag, what)| {
            let end = tag_end(self.spoken, self.tokens, i, tag)?;
            self.is_free(i, end).then_some((end, what, true))
        });
        found.max_by_key(|p| p.0)
    }

    /// Returns a room that no keyword names: an office by its people, a compound, one that only the prompt knows.
    fn unnamed_at(&self, i: usize, people: Option<Noun>) -> Option<Noun> {
        let Self { tokens, numbers, vocabulary, spoken, language, taken } = *self;
        let generic = people.as_ref().is_none_or(|p| p.1 == What::Total);
        let unknown = || {
            let (end, name) = unknown::room_at(tokens, i, spoken, language, taken.list_from)
                .filter(|_| !taken.unread && generic && !numbers.iter().any(|n| n.span.contains(i)))?;
            // "nurse treatment room" is a treatment room
            let named = (i + 1..end).any(|k| vocabulary.known_to(tokens, k, end));
            let known = vocabulary.room_for(tokens, Span { start: i, end }, spoken);
            (self.is_free(i, end) && !named).then(|| (end, What::Room(known.unwrap_or(name)), false))
        };
        let compound = || {
            let token = &tokens[i];
            let listed = token.kind == Kind::Word && i >= taken.list_from;
            let id = listed.then(|| vocabulary.ending(&token.text)).flatten()?;
            Some((i + 1, What::Room(id.into()), false))
        };
        let office = || {
            let (id, _, plural) = vocabulary.office_at(&tokens[i], spoken).filter(|_| !taken.unread)?;
            (i >= taken.list_from || plural).then(|| (i + 1, What::Room(id.into()), plural))
        };
        office().or_else(compound).or_else(unknown).or(people)
    }
}

/// Returns true for articles of a prompt's language, where that is not English.
fn is_little(tokens: &[Token], i: usize, spoken: &[&Spoken], language: &str) -> bool {
    let own = spoken.first().filter(|_| language != "en");
    own.is_some_and(|s| [Tag::Definite, Tag::Articles].iter().any(|&t| s.tag_at(tokens, i, t) == Some(i + 1)))
}

/// Completes "clean and dirty utility", "men's and women's toilets", "Wohn- und Esszimmer".
fn ellipses(tokens: &[Token], vocabulary: &Vocabulary, out: &mut Vec<Mention>) {
    let mut added = Vec::new();
    for m in out.iter() {
        let Some(id) = m.room_type() else { continue };
        let Some(join) = m.span.start.checked_sub(1) else { continue };
        let Some(first) = join.checked_sub(1) else { continue };
        let joins = matches!(tokens[join].text.as_str(), "and" | "or" | "und" | "oder" | "y" | "et" | "/");
        let free = tokens[first].kind == Kind::Word && !out.iter().any(|o| o.span.contains(first));
        if !joins || !free {
            continue;
        }
        let word = &tokens[first].text;
        let rest: Vec<&str> = tokens[m.span.start + 1..m.span.end].iter().map(|t| t.text.as_str()).collect();
        let mut tries = Vec::new();
        if !rest.is_empty() {
            tries.push(format!("{word} {}", rest.join(" ")));
        }
        if let Some(head) = tokens.get(m.span.start).filter(|t| t.text.is_ascii() && m.span.end == m.span.start + 1) {
            tries.extend((3..head.text.len().saturating_sub(2)).map(|cut| format!("{word}{}", &head.text[cut..])));
        }
        if let Some(other) = tries.iter().find_map(|t| vocabulary.whole(t))
            && other != id
        {
            added.push(Mention {
                span: Span { start: first, end: join },
                what: What::Room(other.into()),
                from: first,
                ..m.clone()
            });
        }
    }
    out.extend(added);
    out.sort_by_key(|m| m.span.start);
}

/// Drops what only qualifies a room: people in "kids' bathroom", "staff toilets", and words for rooms of other kinds of
/// buildings, as in a home's "open-plan kitchen".
fn drop_modifiers(tokens: &[Token], vocabulary: &Vocabulary, out: &mut Vec<Mention>) {
    let rooms: Vec<usize> = out.iter().filter(|m| m.room_type().is_some()).map(|m| m.span.start).collect();
    out.retain(|m| {
        let person = matches!(m.what, What::Staff | What::People | What::Visitors | What::Desks | What::Residents);
        let latin = tokens[m.span.start].kind == Kind::Word;
        let stranger = m.room_type().is_some_and(|id| !vocabulary.ids.contains(id));
        !((person || stranger) && latin && rooms.contains(&m.span.end))
    });
}

/// Counts rooms of which men and women have their own: "WC Damen und Herren" are two, "Damen-WC und Herren-WC" one each.
fn part_by_sex(tokens: &[Token], vocabulary: &Vocabulary, spoken: &[&Spoken], out: &mut [Mention]) {
    let stem = |i: usize| -> Option<String> {
        let text = &tokens[i].text;
        if is_tagged(spoken, tokens, i, Tag::Sexes) {
            return Some(text.trim_end_matches('s').to_owned());
        }
        // "Herrentoilette"
        let all = spoken.iter().filter_map(|s| s.words.phrases.get(&Tag::Sexes)).flatten().map(|w| fold(w));
        all.filter(|w| w.len() > 3 && text.len() > w.len() + 1 && tokens[i].kind == Kind::Word)
            .find(|w| text.starts_with(w.as_str()))
    };
    let little = [Tag::Joins, Tag::Stops, Tag::Articles, Tag::Definite, Tag::Each, Tag::NotNames, Tag::Own];
    let plain = |i: usize| tokens[i].mark() == Some('/') || little.iter().any(|&t| is_tagged(spoken, tokens, i, t));
    let spans: Vec<Span> = out.iter().map(|m| m.span).collect();
    for m in out.iter_mut().filter(|m| m.room_type().is_some_and(|id| vocabulary.parted.contains(id))) {
        let other = |i: usize| spans.iter().any(|s| *s != m.span && s.contains(i));
        let reads = |i: &usize| !other(*i) && (stem(*i).is_some() || plain(*i));
        let before = (m.span.start.saturating_sub(MOST_TO_SEXES)..m.span.start).rev().take_while(reads);
        let mut sexes: BTreeSet<String> = before.chain(m.span.start..m.span.end).filter_map(stem).collect();
        let end = (m.span.end..(m.span.end + MOST_TO_SEXES).min(tokens.len())).take_while(reads).last();
        // what leads on to another room is of that room
        let behind = m.span.end..end.map_or(m.span.end, |e| e + 1);
        if !(behind.end < tokens.len() && other(behind.end)) {
            sexes.extend(behind.filter_map(stem));
        }
        // "getrennte WCs", "toilettes séparées"
        let end = m.span.end;
        let parted = |i: usize| i < tokens.len() && is_tagged(spoken, tokens, i, Tag::Parted);
        if m.span.start.checked_sub(1).is_some_and(parted) || parted(end) {
            sexes = ["", "s"].map(str::to_owned).into();
        }
        let open = m.count.is_none() || m.article || m.count == Some(1);
        if open && !sexes.is_empty() {
            (m.count, m.article, m.vague) = (Some(sexes.len().min(2) as i64), false, false);
        }
    }
}

/// Drops repeated words for the building outside the list of rooms ("office office office", "headquarters office").
fn drop_echoes(tokens: &[Token], taken: &Taken, out: &mut Vec<Mention>) {
    let Some(head) = taken.head else { return };
    let text = |span: Span| tokens[span.start..span.end].iter().map(|t| t.text.as_str()).collect::<String>();
    let name = text(head);
    out.retain(|m| {
        let before_list = m.span.start < taken.list_from;
        let beside = m.span.start == head.end || m.span.end == head.start;
        let second = beside && taken.buildings.iter().any(|b| b.overlaps(m.span));
        // "an office for an architecture studio"
        let part = |b: &Span| b.start <= m.span.start && m.span.end <= b.end && *b != m.span;
        let again = second || taken.buildings.iter().any(part) || name.contains(&text(m.span));
        !(m.room_type().is_some() && before_list && m.count.is_none() && again)
    });
}
