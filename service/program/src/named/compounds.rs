//! Words for several rooms at once: "kitchen-living room", "Wohn-Essbereich", "salón comedor" are joined by openings, a
//! "master suite" is a bedroom and the bathroom entered from it, a "living room with kitchen corner" one room. And "open
//! kitchen": open to whatever room it serves.

use d3dgen_model::domain::{Access, Domain};
use d3dgen_model::scene_graph::Connector;

use crate::named::mention::{Mention, What};
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end, words};
use crate::wished::relations::{Relation, Said, Spread};

/// Words before a suite that say whose it is, at most: "elderly grandparents' suite".
const MOST_OF_SUITE: usize = 2;
/// Words between an annexe and what it has, at most: "for the grandmother".
const MOST_TO_OWNER: usize = 5;
/// Words between a room to live in and the kitchen in it, at most: "living room with a small kitchenette".
const MOST_TO_CORNER: usize = 4;

/// Words for several rooms.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Compound {
    pub span: Span,
    /// Types of its rooms, no type twice.
    pub room_types: Vec<String>,
    /// True for rooms that only share a noun: "single and double rooms".
    pub mixed: bool,
    /// True for rooms of which the first is the way to the others: a suite, an annexe.
    pub suite: bool,
}

/// Returns the compounds of a prompt whose rooms the domain knows, in order; none overlaps what is taken.
pub(crate) fn find(
    tokens: &[Token],
    prompt: &str,
    domain: &Domain,
    spoken: &[&Spoken],
    names_room: impl Fn(usize) -> bool,
    taken: impl Fn(Span) -> bool,
) -> Vec<Compound> {
    let mut out: Vec<Compound> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let suite = spoken.iter().filter_map(|s| s.suites.longest_at(tokens, i)).max_by_key(|f| f.0);
        let mix = spoken.iter().filter_map(|s| s.mixes.longest_at(tokens, i)).max_by_key(|f| f.0);
        let mixed = mix.is_some();
        let mut suite_of_rooms = !mixed && suite.is_some();
        let found = match mix.or(suite) {
            Some((end, types)) => Some((end, types.clone())),
            None => with_corner(tokens, i, spoken)
                .map(|end| (end, vec![words().dwelling.living_kitchen.clone()]))
                .or_else(|| joint(tokens, prompt, i, spoken))
                .or_else(|| {
                    let found = any_suite(tokens, i, spoken, &names_room);
                    suite_of_rooms = found.is_some();
                    found
                }),
        };
        let known = |t: &String| domain.room_type(t).is_some();
        match found.filter(|(end, types)| types.iter().all(known) && !taken(Span { start: i, end: *end })) {
            Some((end, room_types)) => {
                out.push(Compound { span: Span { start: i, end }, room_types, mixed, suite: suite_of_rooms });
                i = end;
            }
            None => i += 1,
        }
    }
    out
}

/// Reads one room to live and cook in: "living room with a kitchen corner", "Kochnische im Wohnzimmer"; returns its end.
fn with_corner(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> Option<usize> {
    let living = &words().dwelling.living;
    let tagged = |k: usize, tag| tag_end(spoken, tokens, k, tag);
    let lives = |k: usize| {
        let found = spoken.iter().filter_map(|s| s.joint.longest_at(tokens, k)).max_by_key(|f| f.0);
        let (end, _) = found.filter(|(_, types)| types.len() == 1 && types[0] == *living)?;
        // "living area"
        let noun = tagged(end, Tag::SpaceWords).or_else(|| tagged(end, Tag::RoomWords));
        Some(noun.filter(|e| *e == end + 1).unwrap_or(end))
    };
    let corner = |k: usize| tagged(k, Tag::Corners);
    let (end, link, second): (usize, Tag, &dyn Fn(usize) -> Option<usize>) = match (lives(i), corner(i)) {
        (Some(end), _) => (end, Tag::Starts, &corner),
        (None, Some(end)) => (end, Tag::Inside, &lives),
        (None, None) => return None,
    };
    let from = tagged(end, link)?;
    (from..(from + MOST_TO_CORNER).min(tokens.len())).take_while(|&k| !tokens[k].is_mark()).find_map(second)
}

/// Reads a suite by its last word, whoever it is for: "grandparents' suite", "two guest suites".
fn any_suite(
    tokens: &[Token],
    i: usize,
    spoken: &[&Spoken],
    names_room: &impl Fn(usize) -> bool,
) -> Option<(usize, Vec<String>)> {
    let tagged = |k: usize, tag| tag_end(spoken, tokens, k, tag);
    // what a phrase for something else begins with is no name of a suite; "en suite" is no suite
    let part = [Tag::Stops, Tag::Starts, Tag::Joins, Tag::Articles, Tag::Definite, Tag::Own, Tag::Near, Tag::No];
    let name = |k: usize| {
        let token = &tokens[k];
        let number = spoken.iter().any(|s| s.numbers.contains_key(&token.text));
        let other = part.iter().any(|&t| tagged(k, t).is_some());
        token.kind == Kind::Word && token.text != "en" && !number && !other && !names_room(k)
    };
    let end = |k: usize| tagged(k, Tag::SuiteWords).filter(|_| tokens[k].kind == Kind::Word);
    let named = (i..(i + MOST_OF_SUITE + 1).min(tokens.len()))
        .take_while(|&k| k == i || name(k - 1))
        .find(|&k| end(k).is_some())?;
    // "bathroom suite", "en suite"
    if named == i && (i == 0 || tokens[i - 1].text == "en" || names_room(i - 1) || tagged(i - 1, Tag::Own).is_some()) {
        return None;
    }
    let d = &words().dwelling;
    end(named).map(|end| (end, vec![d.bedroom.clone(), d.ensuite.clone()]))
}

/// Reads rooms of the day that one phrase names: "open plan kitchen, dining and living area".
fn joint(tokens: &[Token], prompt: &str, i: usize, spoken: &[&Spoken]) -> Option<(usize, Vec<String>)> {
    let open = i > 0 && is_open(tokens, i - 1, spoken, true);
    let at = |k: usize| spoken.iter().filter_map(|s| s.joint.longest_at(tokens, k)).max_by_key(|f| f.0);
    let tagged = |k: usize, tag| tag_end(spoken, tokens, k, tag);
    let (mut end, first) = at(i)?;
    let mut types: Vec<String> = first.clone();
    let words = tokens[i].kind == Kind::Word;
    loop {
        // "living room", "Wohn-Ess-Bereich"
        if tokens.get(end).is_some_and(|t| !t.is_mark()) && at(end).is_none() {
            let noun = tagged(end, Tag::SpaceWords).or_else(|| tagged(end, Tag::RoomWords));
            end = noun.filter(|e| *e == end + 1 && words).unwrap_or(end);
        }
        let mut next = end;
        let slash = |k: usize| {
            let t = &tokens[k];
            t.mark() == Some('/') && prompt.get(t.start..).is_some_and(|p| p.starts_with(['/', '&']))
        };
        while next < tokens.len() && next < end + 3 && at(next).is_none() {
            let joins = open && (tokens[next].mark() == Some(',') || tagged(next, Tag::Joins).is_some());
            let little = open && next > end && tagged(next, Tag::Articles).or(tagged(next, Tag::Definite)).is_some();
            if !(joins || little || slash(next)) {
                break;
            }
            next += 1;
        }
        let Some((to, more)) = tokens.get(next).and_then(|_| at(next)).filter(|_| words || open) else { break };
        let fresh: Vec<String> = more.iter().filter(|t| !types.contains(t)).cloned().collect();
        if fresh.is_empty() {
            break;
        }
        types.extend(fresh);
        end = to;
    }
    // "open-plan living"
    (types.len() > 1 || open).then_some((end, types))
}

/// Returns true for a word such as "open-plan" that ends at a token (`before` a room) or begins at one (behind it).
fn is_open(tokens: &[Token], i: usize, spoken: &[&Spoken], before: bool) -> bool {
    let from = if before { i.saturating_sub(2) } else { i };
    (from..=i).any(|k| {
        spoken.iter().any(|s| s.tag_at(tokens, k, Tag::OpenPlan).is_some_and(|end| !before && k == i || end == i + 1))
    })
}

/// Returns the mentions of a compound, one a room; numbers are not yet with them.
pub(crate) fn mentions(compound: &Compound) -> impl Iterator<Item = Mention> + '_ {
    compound.room_types.iter().map(|t| Mention::plain(compound.span, What::Room(t.clone())))
}

/// Gives all rooms of a compound the number of the first, and takes a room out that is one of those before it: "three
/// bedrooms including a master suite".
pub(crate) fn settle(tokens: &[Token], compounds: &[Compound], spoken: &[&Spoken], mentions: &mut Vec<Mention>) {
    for compound in compounds {
        let Some(first) = mentions.iter().position(|m| m.span == compound.span) else { continue };
        let head = mentions[first].clone();
        if compound.mixed {
            share(mentions, compound, &head);
            continue;
        }
        let before = mentions[..first].iter().rev().find(|m| m.what == head.what && m.count.is_some_and(|n| n > 1));
        let single = head.count.is_none() && !head.plural;
        let part = before.is_some_and(|m| {
            let mut gap = m.span.end..compound.span.start;
            // "four bedrooms, master suite with closet": no article, no number and nothing that adds it
            let apposed =
                compound.suite && single && gap.len() == 1 && gap.clone().all(|k| tokens[k].mark() == Some(','));
            apposed || gap.any(|k| is_tagged(spoken, tokens, k, Tag::PartOf))
        });
        for m in mentions.iter_mut().filter(|m| m.span == compound.span) {
            m.from = head.from;
            if single {
                (m.count, m.article) = (Some(1), true);
            } else {
                (m.count, m.article, m.vague) = (head.count, head.article, head.vague);
            }
        }
        if part {
            mentions.remove(first);
        }
    }
    // "house with an annexe: ..., and an annexe with bedroom and bath" has one
    let annexes = || compounds.iter().filter(|c| c.room_types[0] == words().dwelling.annexe);
    let last = annexes().next_back().map(|c| c.span);
    for earlier in annexes().filter(|c| Some(c.span) != last) {
        mentions.retain(|m| m.span != earlier.span || m.count.is_some_and(|n| n > 1));
    }
    // "Wohnküche, Wohnzimmer": what one word names beside the kitchen may be named by itself
    let alone = |c: &&Compound| !c.mixed && c.span.end == c.span.start + 1;
    // an annexe has its own bedroom beside all others
    for compound in compounds.iter().filter(alone).filter(|c| c.room_types[0] != words().dwelling.annexe) {
        let own = |m: &Mention| m.span == compound.span;
        let elsewhere = |what: &What| mentions.iter().any(|m| !own(m) && &m.what == what);
        let spare: Vec<What> = mentions.iter().filter(|m| own(m)).skip(1).map(|m| m.what.clone()).collect();
        let spare: Vec<What> = spare.into_iter().filter(|w| elsewhere(w)).collect();
        mentions.retain(|m| !(own(m) && spare.contains(&m.what)));
    }
}

/// Takes the rooms that are told of a suite for its own: "grandparents' suite (bedroom, bathroom, sitting room)" has one
/// bedroom. Returns the words that name nothing more.
pub(crate) fn hold_own(
    tokens: &[Token],
    prompt: &str,
    compounds: &[Compound],
    mentions: &mut Vec<Mention>,
    domain: &Domain,
    spoken: &[&Spoken],
) -> Vec<Span> {
    let d = &words().dwelling;
    let mut told: Vec<Span> = Vec::new();
    let at = |k: usize, c: char| tokens.get(k).is_some_and(|t| prompt.get(t.start..).is_some_and(|p| p.starts_with(c)));
    let tagged = |k: usize, tag| tag_end(spoken, tokens, k, tag);
    let is_suite = |c: &&Compound| c.suite && c.room_types.len() > 1;
    for compound in compounds.iter().filter(is_suite) {
        let annexe = compound.room_types[0] == d.annexe;
        let from = compound.span.end;
        // "granny annexe for the mother with ..."
        let from = if annexe {
            (from..tokens.len().min(from + MOST_TO_OWNER))
                .find(|&k| tagged(k, Tag::Starts).is_some() || tokens[k].is_mark())
                .unwrap_or(from)
        } else {
            from
        };
        let bracket = at(from, '(');
        let Some(start) = bracket.then_some(from + 1).or_else(|| tagged(from, Tag::Starts)) else { continue };
        let mut end = (start..tokens.len()).find(|&k| at(k, ')')).unwrap_or(tokens.len());
        if !bracket {
            // "suite with bedroom, bathroom and sitting room": up to what is joined by "and", or the next thing
            let stop = |k: &usize| tokens[*k].ends_sentence() || tagged(*k, Tag::Starts).is_some();
            end = (start..tokens.len()).find(stop).unwrap_or(tokens.len());
        }
        let (mut last, mut washed) = (false, false);
        let mut count = None;
        for m in mentions.iter_mut().filter(|m| m.span.start >= start && m.span.end <= end) {
            let Some(kind) = m.room_type().and_then(|id| domain.room_type(id)) else { break };
            let sleeps = compound.room_types[0] == kind.id || kind.id == d.bedroom;
            let washes = kind.id == d.bathroom || kind.id == d.ensuite || kind.id == d.shower;
            let joined = m.from.checked_sub(1).is_some_and(|k| tagged(k, Tag::Joins).is_some());
            let lives = annexe && [&d.living, &d.suite_sitting, &d.kitchen, &d.living_kitchen].contains(&&kind.id);
            let cooks = annexe && words().alike.iter().any(|set| set.contains(&d.kitchen) && set.contains(&kind.id));
            // "master suite with shower room, a bathroom": a suite has one, and the next is for the others
            if last || !(bracket || sleeps || washes || joined || lives || cooks) || washes && washed && !bracket {
                break;
            }
            washed |= washes;
            last = !bracket && joined;
            if sleeps {
                count = m.count.filter(|n| *n > 1 && !m.article);
            }
            if sleeps || washes || lives || cooks {
                told.push(m.span);
            } else if kind.id == d.living && domain.room_type(&d.suite_sitting).is_some() {
                m.what = What::Room(d.suite_sitting.clone());
            }
        }
        let sleeps = |m: &&mut Mention| m.span == compound.span && m.room_type().is_some_and(|id| id == d.bedroom);
        if let Some(n) = count.and_then(|n| mentions.iter_mut().find(sleeps).map(|m| (m, n))) {
            (n.0.count, n.0.article) = (Some(n.1), false);
        }
    }
    mentions.retain(|m| !told.contains(&m.span));
    told
}

/// Shares the number of "12 single and double rooms" out to them; without one their beds say how many there are.
fn share(mentions: &mut [Mention], compound: &Compound, head: &Mention) {
    let kinds = compound.room_types.len() as i64;
    let told = head.count.filter(|n| !head.article && *n >= kinds);
    for (k, m) in mentions.iter_mut().filter(|m| m.span == compound.span).enumerate() {
        let k = k as i64;
        m.from = head.from;
        m.count = told.map(|n| n / kinds + i64::from(k < n % kinds));
        (m.plural, m.article, m.vague) = (true, false, head.vague);
    }
}

/// Joins the rooms of each compound: an en suite to the room it is entered from, others by openings.
pub(crate) fn relate(compounds: &[Compound], mentions: &[Mention], domain: &Domain, said: &mut Said) {
    for compound in compounds.iter().filter(|c| !c.mixed) {
        let all: Vec<usize> = (0..mentions.len()).filter(|&m| mentions[m].span == compound.span).collect();
        for pair in all.windows(2) {
            let kind = mentions[pair[1]].room_type().and_then(|id| domain.room_type(id));
            let belongs = compound.suite || kind.is_some_and(|k| k.access == Access::Host);
            let (subject, object) = if belongs { (pair[1], all[0]) } else { (pair[0], pair[1]) };
            let connector = if belongs { Connector::Door } else { Connector::Open };
            said.relations.push(Relation { subject, object, connector, spread: Spread::Each, apart: false, belongs });
        }
    }
}

/// Returns true where the name of a living room says that one eats there too: "salón-comedor", "living-dining room".
pub(crate) fn eats_where_one_lives(tokens: &[Token], mentions: &[Mention], spoken: &[&Spoken]) -> bool {
    let d = &words().dwelling;
    let dines = |k: usize| {
        let found = spoken.iter().filter_map(|s| s.joint.longest_at(tokens, k));
        found.into_iter().any(|(_, types)| types.len() == 1 && types[0] == d.dining)
    };
    let living = mentions.iter().filter(|m| m.room_type() == Some(&d.living));
    living.into_iter().any(|m| (m.span.start..m.span.end).any(dines))
}

/// Opens rooms of the day to each other that "living area with open kitchen" puts one into the other.
pub(crate) fn open_belongings(
    tokens: &[Token],
    mentions: &[Mention],
    domain: &Domain,
    spoken: &[&Spoken],
    said: &mut Said,
) {
    let types = |m: usize| mentions[m].room_type();
    for r in said.relations.iter_mut().filter(|r| r.belongs) {
        let (Some(a), Some(b)) = (types(r.subject), types(r.object)) else { continue };
        let joins = domain.layouts.open_joins.iter().any(|j| j.iter().any(|t| t == a) && j.iter().any(|t| t == b));
        if a != b && joins && is_called_open(tokens, &mentions[r.subject], spoken) {
            (r.belongs, r.connector) = (false, Connector::Open);
        }
    }
}

/// Returns true for "open kitchen", "cuisine ouverte".
fn is_called_open(tokens: &[Token], m: &Mention, spoken: &[&Spoken]) -> bool {
    let before = m.span.start.checked_sub(1).is_some_and(|i| is_open(tokens, i, spoken, true));
    // "cuisine ouverte", but "kitchen open study"
    let noun = |i: usize| spoken.iter().any(|s| s.joint.longest_at(tokens, i).is_some());
    before
        || tokens.get(m.span.end).is_some_and(|t| !t.is_mark())
            && is_open(tokens, m.span.end, spoken, false)
            && !noun(m.span.end + 1)
}

/// Returns the types of rooms that an open layout of the domain joins to one, best first.
pub(crate) fn opens_to<'d>(domain: &'d Domain, id: &'d String) -> impl Iterator<Item = &'d String> {
    domain.layouts.open_joins.iter().filter(move |join| join.contains(id)).flatten().filter(move |other| *other != id)
}

/// Returns the types of rooms that the prompt calls closed or separate and that an open layout of the domain joins to others.
pub(crate) fn closed_rooms(tokens: &[Token], mentions: &[Mention], domain: &Domain, spoken: &[&Spoken]) -> Vec<String> {
    let tagged = |i: usize| tag_end(spoken, tokens, i, Tag::ClosedPlan);
    let mut out: Vec<String> = Vec::new();
    for m in mentions {
        let joined = |id: &&str| domain.layouts.open_joins.iter().flatten().any(|j| j == id);
        let Some(id) = m.room_type().filter(joined) else { continue };
        let before = m.span.start.checked_sub(1).and_then(tagged) == Some(m.span.start);
        // "cuisine fermée", but "kitchen, separate toilet" and "Küche getrennte Toilette"
        let next = || tagged(m.span.end).is_some_and(|end| !mentions.iter().any(|o| o.from.min(o.span.start) == end));
        if (before || m.span.end < tokens.len() && next()) && !out.iter().any(|o| o == id) {
            out.push(id.to_owned());
        }
    }
    out
}

/// Returns the types of rooms that the prompt calls open and that an open layout of the domain joins to others.
pub(crate) fn open_rooms(tokens: &[Token], mentions: &[Mention], domain: &Domain, spoken: &[&Spoken]) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for m in mentions {
        let Some(id) = m.room_type().filter(|id| domain.layouts.open_joins.iter().flatten().any(|j| j == id)) else {
            continue;
        };
        if is_called_open(tokens, m, spoken) && !out.iter().any(|o| o == id) {
            out.push(id.to_owned());
        }
    }
    out
}
