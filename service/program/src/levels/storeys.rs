//! Storeys in a prompt: how many there are, and which rooms are to be on which.

use d3dgen_model::gazetteer::first_floor_is_ground;
use d3dgen_model::scene_graph::Note;

use crate::named::mention::{Mention, What};
use crate::subject::places::country_of;
use crate::tokens::numbers::Number;
use crate::tokens::storey::Where;
use crate::tokens::text::{Kind, Phrases, Span, Token, fold};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end};

/// Storeys above the ground that a prompt may ask for.
const MOST_LEVELS: u32 = 12;

/// A phrase that names a storey.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Phrase {
    pub span: Span,
    pub at: Where,
    /// True for a storey that the building is to have ("a basement"), not one that something is on.
    pub noun: bool,
}

/// Rooms that the prompt wants on a storey.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wanted {
    pub room_type: String,
    pub count: u32,
    pub at: Where,
}

/// What a prompt says of storeys.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Storeys {
    /// Numbers of the storeys from the lowest; `[0]` for a building of one.
    pub levels: Vec<i32>,
    pub wanted: Vec<Wanted>,
    /// True when an elevator is named, false when it is ruled out.
    pub elevator: Option<bool>,
    /// Elevators that are counted; 0 where none are.
    pub lifts: u32,
    /// Stairs that are counted: "two staircases"; 0 where none are.
    pub stairs: u32,
    /// Robots that are wanted on every storey.
    pub robots_on_each: Vec<Span>,
    /// True for a basement of which the prompt says no room.
    pub bare_basement: bool,
}

impl Storeys {
    /// Returns how many storeys stand above ground.
    pub(crate) fn above_ground(&self) -> usize {
        self.levels.iter().filter(|l| **l >= 0).count()
    }
}

/// Returns the phrases that name storeys, in order; `room_end` tells where a word for a room ends that begins at a token.
pub(crate) fn phrases(
    tokens: &[Token],
    numbers: &[Number],
    spoken: &[&Spoken],
    head: Option<Span>,
    basements: bool,
    room_end: impl Fn(usize) -> Option<usize>,
) -> Vec<Phrase> {
    let is_room = |i: usize| room_end(i).is_some();
    let full = |i: usize| spoken.iter().filter_map(|s| s.levels.longest_at(tokens, i)).max_by_key(|f| f.0);
    // "on the ground floor ..., on the first ...": the noun is not said again
    let named = (0..tokens.len()).any(|i| full(i).is_some_and(|f| !matches!(f.1, Where::Each)));
    let elided = |i: usize| {
        let found = spoken.iter().filter_map(|s| s.levels_elided.longest_at(tokens, i)).max_by_key(|f| f.0);
        // "en la primera planta", "in the first bedroom"
        let whole = |end: usize| (i..end).any(|k| full(k).is_some_and(|f| f.0 > end));
        let counts_rooms = |end: usize| {
            let noun = is_tagged(spoken, tokens, end, Tag::Storeys);
            noun || room_end(end).is_some_and(|to| tokens.get(to).is_none_or(Token::is_mark))
        };
        found.filter(|f| named && !whole(f.0) && !counts_rooms(f.0))
    };
    let mut out = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let eastern = || nth_in_east(tokens, i, numbers, head, &is_room);
        let level = numbered(tokens, i, spoken).map(|(end, level)| (end, Where::Level(level)));
        if let Some((end, at)) = level.or_else(eastern) {
            out.push(Phrase { span: Span { start: i, end }, at, noun: false });
            i = end;
            continue;
        }
        let found = full(i).or_else(|| elided(i));
        // a wine cellar is a room
        let inner = || (i.saturating_sub(3)..i).any(|k| room_end(k).is_some_and(|end| end > i));
        let below = tag_end(spoken, tokens, i, Tag::Basement).filter(|_| basements && !inner());
        match (found, below) {
            (Some((end, &at)), below) if below.is_none_or(|b| b < end || inside(tokens, i, spoken)) => {
                out.push(Phrase { span: Span { start: i, end }, at, noun: false });
                i = end;
            }
            (_, Some(end)) => {
                let noun = !inside(tokens, i, spoken);
                out.push(Phrase { span: Span { start: i, end }, at: Where::Level(-1), noun });
                i = end;
            }
            _ => i += 1,
        }
    }
    out
}

/// Returns true behind "in the": what is said lies on the storey, and the storey itself is nothing new.
fn inside(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> bool {
    let tagged = |k: usize, tag: Tag| is_tagged(spoken, tokens, k, tag);
    let before = |k: usize| i.checked_sub(k);
    before(1).is_some_and(|k| tagged(k, Tag::Inside))
        || before(2).is_some_and(|k| tagged(k, Tag::Inside) && tagged(k + 1, Tag::Definite))
}

/// Returns end and number of "2. OG", "3. Stock": a number with a dot before a word for a storey.
fn numbered(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> Option<(usize, i32)> {
    let Kind::Number(n) = tokens[i].kind else { return None };
    if !(1.0..=f64::from(MOST_LEVELS)).contains(&n) || tokens.get(i + 1)?.mark() != Some('.') || i + 2 >= tokens.len() {
        return None;
    }
    let end = spoken.iter().find_map(|s| {
        let upper = s.levels.longest_at(tokens, i + 2).filter(|f| *f.1 == Where::Upper).map(|f| f.0);
        upper.or_else(|| s.tag_at(tokens, i + 2, Tag::Storeys))
    })?;
    Some((end, n as i32))
}

/// Returns end and number of "二楼", "第3层", "1층에", "2층 침실": a storey by its number where rooms or a particle follow;
/// "三层办公楼" and "2층 주택" have so many.
fn nth_in_east(
    tokens: &[Token],
    i: usize,
    numbers: &[Number],
    head: Option<Span>,
    is_room: &impl Fn(usize) -> bool,
) -> Option<(usize, Where)> {
    let ordinal = tokens[i].text == "第";
    let number = numbers.iter().find(|n| n.span.start == i + usize::from(ordinal))?;
    if !(1.0..=f64::from(MOST_LEVELS)).contains(&number.value) {
        return None;
    }
    let (at, end) = (number.span.end, number.span.end + 1);
    let unit = tokens.get(at).filter(|t| matches!(t.kind, Kind::Han | Kind::Hangul))?;
    let next = tokens.get(end).filter(|t| !t.is_mark());
    let follows = |words: &[&str]| next.is_some_and(|t| !t.spaced && words.contains(&t.text.as_str()));
    let of_building = head.is_some_and(|h| h.contains(end) || h.contains(at));
    let named = match unit.text.as_str() {
        "楼" => !of_building && !follows(&["房", "宇", "栋", "盘"]),
        "层" => {
            let two = tokens[number.span.start].text == "两";
            let head =
                tokens.get(end).is_some_and(|t| t.mark() == Some(':')) || follows(&["有", "是", "为", "设", "布"]);
            // "二层6间办公室", but "办公楼三层 12间办公室"
            let counted = numbers.iter().find(|n| n.span.start == end).filter(|n| !tokens[n.span.start].spaced);
            let rooms = counted.is_some_and(|n| is_room(n.span.end) || is_room(n.span.end + 1));
            ordinal || !two && !of_building && (head || rooms || is_room(end))
        }
        "층" => !of_building && (follows(&["에", "은", "는", "엔", "의"]) || is_room(end)),
        _ => return None,
    };
    named.then_some((end, Where::Nth(number.value as i32)))
}

/// Returns the number of storeys that the prompt states: "two-storey", "auf 3 Etagen", "zweistöckig", "three floor bank",
/// "G+2".
fn stated(text: &Text) -> Option<f64> {
    let Text { tokens, numbers, spoken, phrases, head, .. } = *text;
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    // "a three floor bank", "library, 3 floor": the singular where nothing but the building follows
    let singular = |n: &Number| {
        let after = tagged(n.span.end, Tag::Singular).filter(|_| n.value >= 2.0);
        after.is_some_and(|end| tokens.get(end).is_none_or(Token::is_mark) || head.is_some_and(|h| h.start == end))
    };
    let counted = |n: &&Number| {
        let nth = phrases.iter().any(|p| p.span.overlaps(n.span));
        !n.article && !n.vague && !nth && (tagged(n.span.end, Tag::Storeys).is_some() || singular(n))
    };
    let ground_plus = (2..tokens.len()).find_map(|i| {
        let Kind::Number(n) = tokens[i].kind else { return None };
        let plus = tokens[i - 1].mark() == Some('/') && !tokens[i - 1].spaced && tokens[i - 2].text == "g";
        plus.then_some(n + 1.0)
    });
    if ground_plus.is_some() {
        return ground_plus;
    }
    let by_number = numbers.iter().find(counted).map(|n| n.value);
    by_number.or_else(|| said_by_word(text))
}

/// Returns the number of storeys that a word for the building says: "bungalow", "duplex".
fn said_by_word(text: &Text) -> Option<f64> {
    let Text { tokens, spoken, phrases, head, .. } = *text;
    let by_word = |counts: &Phrases<f64>| (0..tokens.len()).find_map(|i| counts.longest_at(tokens, i).map(|f| *f.1));
    // a "ground-floor maisonette" has one storey of its house
    let placed = phrases.iter().any(|p| !p.noun && head.is_some_and(|h| h.start == p.span.end));
    spoken.iter().find_map(|s| by_word(&s.storey_counts)).filter(|_| !placed)
}

/// Says that a building of one storey is to have more: "bungalow with three storeys", "one-storey house with an upper floor".
fn state_more_than_one(text: &Text, stated: i32, conflicts: &mut Vec<Note>) {
    let Text { tokens, spoken, phrases, .. } = *text;
    if stated > 1 && said_by_word(text) == Some(1.0) {
        let message = format!("the prompt asks for one storey and for {stated}; {stated} were planned");
        conflicts.push(Note::new("contradicting_storeys", message));
    }
    let tagged = |i: usize, tags: &[Tag]| spoken.iter().any(|s| tags.iter().any(|&t| s.tag_at(tokens, i, t).is_some()));
    let above = |at: Where| match at {
        Where::Level(n) => n > 0,
        Where::Nth(n) => n > 1,
        Where::Upper | Where::Top => true,
        Where::Each => false,
    };
    // "with an upper floor" is what the building has, "on the upper floor" where something is
    let own = |p: &Phrase| {
        let before = p.span.start.checked_sub(1);
        before.is_some_and(|i| tagged(i, &[Tag::Articles, Tag::Starts, Tag::Joins])) && above(p.at)
    };
    if stated == 1 && phrases.iter().any(own) {
        let message = "one storey was asked for, and one above it too; the number was followed".to_owned();
        conflicts.push(Note::new("contradicting_storeys", message));
    }
}

/// Words between a number and the elevators that it counts, at most: "two large passenger lifts".
const MOST_TO_LIFT: usize = 2;

/// What words in the plural end in where that is all that makes them one.
const PLURAL_ENDS: [&str; 2] = ["s", "es"];

/// What a prompt says of elevators.
struct Lifts {
    /// True when one is named, false when it is ruled out.
    wanted: Option<bool>,
    /// How many are counted; 0 where none are.
    count: u32,
    /// True where a room is to be beside one.
    beside: bool,
}

/// Reads whether elevators are asked for or ruled out, and how many: those of several kinds are added up.
fn lifts(text: &Text) -> Lifts {
    let Text { tokens, numbers, mentions, spoken, .. } = *text;
    let tagged = |i: usize, tag: Tag| tag_end(spoken, tokens, i, tag);
    // a "lift lobby" is a room
    let in_room = |i: usize| mentions.iter().any(|m| m.room_type().is_some() && m.span.contains(i));
    let named = |i: &usize| tagged(*i, Tag::Lift).is_some() && !in_room(*i);
    let all: Vec<usize> = (0..tokens.len()).filter(named).collect();
    let wanted = all.first().map(|&at| !(at.saturating_sub(2)..at).any(|k| tagged(k, Tag::No).is_some()));
    let counted = |&at: &usize| {
        let between = |n: &&Number| {
            let gap = n.span.end..at;
            let parted = |i: usize| {
                tokens[i].is_mark() || tagged(i, Tag::Joins).is_some() || mentions.iter().any(|m| m.span.contains(i))
            };
            n.span.end <= at && gap.len() <= MOST_TO_LIFT && !gap.into_iter().any(parted)
        };
        // "电梯4部", "엘리베이터 3대"
        let end = tagged(at, Tag::Lift).unwrap_or(at);
        let behind = |n: &&Number| n.span.start == end && tagged(n.span.end, Tag::Counters).is_some();
        // "3 storeys with lifts" counts no lifts
        let of_storeys = |n: &&Number| tagged(n.span.end, Tag::Storeys).is_some();
        let before = numbers.iter().rev().find(between).filter(|n| !of_storeys(n));
        let number = before.or_else(|| numbers.iter().find(behind))?;
        (number.value >= 1.0).then_some(number.value as u32)
    };
    let near = |&at: &usize| (at.saturating_sub(MOST_TO_LIFT + 1)..at).any(|k| tagged(k, Tag::Near).is_some());
    let single = |word: &str| {
        let mut all = spoken.iter().filter_map(|s| s.words.phrases.get(&Tag::Lift)).flatten();
        all.any(|w| fold(w) == word)
    };
    // "with lifts": the plural of a word that is known without its ending
    let plural = |&at: &usize| {
        let word = tagged(at, Tag::Lift).and_then(|end| tokens.get(end - 1)).map_or("", |t| t.text.as_str());
        PLURAL_ENDS.iter().any(|end| word.strip_suffix(end).is_some_and(single))
    };
    let told = all.iter().filter_map(counted).fold(0, u32::saturating_add);
    let beside = all.iter().any(near);
    let several = if all.iter().any(plural) && wanted == Some(true) && !beside { 2 } else { 0 };
    Lifts { wanted, beside, count: if told > 0 { told } else { several } }
}

/// What the reading of storeys needs to see.
pub(crate) struct Text<'a> {
    pub tokens: &'a [Token],
    pub numbers: &'a [Number],
    pub mentions: &'a [Mention],
    pub phrases: &'a [Phrase],
    pub spoken: &'a [&'a Spoken],
    /// Words that name the building.
    pub head: Option<Span>,
    /// Words for robots.
    pub machines: &'a [Span],
}

/// Reads what a prompt says of storeys; contradictions become conflicts.
pub(crate) fn read(text: &Text, country: Option<&str>, conflicts: &mut Vec<Note>) -> Storeys {
    let Text { tokens, mentions, phrases, spoken, .. } = *text;
    let stated = stated(text);
    if let Some(n) = stated.filter(|n| !(1.0..=f64::from(MOST_LEVELS)).contains(n)) {
        let message = format!("{n} storeys were asked for; one world has 1 to {MOST_LEVELS}");
        conflicts.push(Note::new("impossible_storeys", message));
    }
    let stated = stated.filter(|n| (1.0..=f64::from(MOST_LEVELS)).contains(n)).map(|n| n.floor() as i32);
    let of_robots: Vec<(usize, Span)> = (0..phrases.len()).filter_map(|p| Some((p, robot_on(text, p)?))).collect();
    let mut on = attach(tokens, mentions, phrases, spoken);
    on.retain(|(_, p)| !of_robots.iter().any(|r| r.0 == *p));
    let robots_on_each = of_robots.iter().filter(|r| phrases[r.0].at == Where::Each).map(|r| r.1).collect();
    let american = counts_from_one(phrases, stated, country);
    let fixed = |at: Where| match at {
        Where::Level(n) => Some(n),
        Where::Nth(n) => Some(if american { n - 1 } else { n }),
        Where::Upper | Where::Top | Where::Each => None,
    };
    // "flat on the third floor" is where the flat is; rooms on a floor are what it is made of
    let below = phrases.iter().filter(|p| p.noun).map(|p| p.at);
    let used: Vec<Where> = on.iter().map(|o| phrases[o.1].at).chain(below).collect();
    let mut named: Vec<i32> = used.iter().filter_map(|at| fixed(*at)).collect();
    named.sort_unstable();
    named.dedup();
    let above = used.iter().any(|at| matches!(at, Where::Upper));
    // "ground floor ..., upper floor ..., attic floor ...": the top is above all others that have rooms
    let topped = (!named.is_empty() || above) && used.contains(&Where::Top);
    let several = named.len() > 1 || above || topped || named.iter().any(|n| *n < 0);
    let highest = named.last().copied().unwrap_or(0).max(i32::from(above)) + i32::from(topped);
    let mut top = match stated {
        Some(n) => n - 1,
        None if several => highest,
        None => 0,
    };
    let own = stated.filter(|_| highest <= top);
    own.into_iter().for_each(|n| state_more_than_one(text, n, conflicts));
    if stated.is_some() && highest > top {
        let message = format!(
            "{} storeys were asked for, but rooms on {} are named; {} were planned",
            top + 1,
            highest + 1,
            highest + 1
        );
        conflicts.push(Note::new("contradicting_storeys", message));
        top = highest;
    }
    let lowest = named.first().copied().unwrap_or(0).min(0);
    let levels: Vec<i32> = if several || top > 0 { (lowest..=top).collect() } else { vec![0] };
    // "im Obergeschoss ..., im Dachgeschoss ...": upper storeys are those that have no name of their own
    let own = |at: Where| if at == Where::Top { Some(top) } else { fixed(at) };
    let told: Vec<i32> = used.iter().filter_map(|at| own(*at)).collect();
    let mut others = (1..=top).filter(|l| !told.contains(l));
    let upper = others.next().filter(|_| others.next().is_none()).map_or(Where::Upper, Where::Level);
    let mut wanted: Vec<Wanted> = Vec::new();
    for (m, p) in on.into_iter().filter(|_| levels.len() > 1) {
        let mention = &mentions[m];
        let Some(room_type) = mention.room_type() else { continue };
        let count = mention.count.unwrap_or(if mention.plural { 2 } else { 1 }).clamp(0, 500) as u32;
        let at = match phrases[p].at {
            Where::Top => Where::Level(top),
            Where::Upper => upper,
            at => fixed(at).map_or(at, Where::Level),
        };
        wanted.push(Wanted { room_type: room_type.to_owned(), count, at });
    }
    let bare = (0..phrases.len()).any(|p| phrases[p].noun) && !wanted.iter().any(|w| w.at == Where::Level(-1));
    let Lifts { wanted: elevator, count: lifts, beside } = lifts(text);
    if elevator == Some(true) && levels.len() < 2 {
        let message =
            "an elevator was asked for, but the building has one storey; none was planned, say how many storeys it has";
        conflicts.push(Note::new("elevator_on_one_storey", message.into()));
    }
    if elevator == Some(true) && levels.len() > 1 && beside {
        let message = "no room was planned beside an elevator: it stands where it joins the storeys";
        conflicts.push(Note::new("not_beside", message.into()));
    }
    Storeys { levels, wanted, elevator, lifts, stairs: 0, robots_on_each, bare_basement: bare }
}

/// Returns the robots that a phrase says the storey of: "a cleaning robot on each floor", not "upstairs bedrooms".
fn robot_on(text: &Text, phrase: usize) -> Option<Span> {
    let span = text.phrases[phrase].span;
    let robot = text.machines.iter().rev().find(|m| m.end <= span.start)?;
    let between = robot.end..span.start;
    let other = |i: usize| text.tokens[i].is_mark() || text.mentions.iter().any(|m| m.span.contains(i));
    let follows = text.mentions.iter().any(|m| m.from == span.end || m.span.start == span.end);
    (between.len() <= 3 && !between.into_iter().any(other) && !follows).then_some(*robot)
}

/// Returns how many of the rooms behind a basement are its own: "with a laundry and a gym, three bedrooms" has two.
fn listed_with(
    tokens: &[Token],
    mentions: &[Mention],
    rooms: &[usize],
    tagged: impl Fn(usize, &[Tag]) -> bool,
) -> usize {
    let mut joined = false;
    for (k, pair) in rooms.windows(2).enumerate() {
        let mut gap = mentions[pair[0]].span.end..mentions[pair[1]].from;
        if joined && gap.clone().any(|i| tokens[i].is_mark()) {
            return k + 1;
        }
        joined |= gap.any(|i| tagged(i, &[Tag::Joins]));
    }
    rooms.len()
}

/// Returns true where the ground floor is the first floor.
fn counts_from_one(phrases: &[Phrase], stated: Option<i32>, country: Option<&str>) -> bool {
    let ground = phrases.iter().any(|p| p.at == Where::Level(0));
    let nth = || phrases.iter().filter_map(|p| if let Where::Nth(n) = p.at { Some(n) } else { None });
    // the highest storey named tells how they are counted
    if let Some(n) = stated
        && nth().any(|k| k >= n)
    {
        return true;
    }
    match country {
        Some(code) => first_floor_is_ground(country_of(code)),
        None => !ground,
    }
}

/// Returns for every mention which storey the prompt puts it on, where it says so.
pub(crate) fn storey_of(
    tokens: &[Token],
    mentions: &[Mention],
    phrases: &[Phrase],
    spoken: &[&Spoken],
) -> Vec<Option<Where>> {
    let mut out = vec![None; mentions.len()];
    for (m, p) in attach(tokens, mentions, phrases, spoken) {
        out[m] = Some(phrases[p].at);
    }
    out
}

/// Returns which rooms are on which storey, as pairs of a mention and a phrase.
fn attach(tokens: &[Token], mentions: &[Mention], phrases: &[Phrase], spoken: &[&Spoken]) -> Vec<(usize, usize)> {
    let tagged = |i: usize, tags: &[Tag]| spoken.iter().any(|s| tags.iter().any(|&t| s.tag_at(tokens, i, t).is_some()));
    let ends = |i: usize| tokens.get(i).is_none_or(Token::ends_sentence);
    // where the words that lead to a phrase begin: "on the" upper floor
    let lead = |p: &Phrase| {
        let mut at = p.span.start;
        while at > 0 && !tokens[at - 1].is_mark() && tagged(at - 1, &[Tag::Stops, Tag::Definite, Tag::Articles]) {
            let joins = tagged(at - 1, &[Tag::Joins]);
            if joins || mentions.iter().any(|m| m.span.contains(at - 1)) {
                break;
            }
            at -= 1;
        }
        at
    };
    let rooms: Vec<usize> = (0..mentions.len()).filter(|&m| matches!(mentions[m].what, What::Room(_))).collect();
    let mut out: Vec<(usize, usize)> = Vec::new();
    // the phrase before, where it heads a list
    let mut headed: Option<usize> = None;
    for (p, phrase) in phrases.iter().enumerate() {
        let from = lead(phrase);
        let before = |m: &&usize| mentions[**m].span.end == from;
        let follows_room = rooms.iter().any(|m| before(&m));
        let next = tokens.get(phrase.span.end);
        // "2층 침실", "一楼厨房": the storey stands before its rooms, but "厨房在一楼"
        let first = &tokens[phrase.span.start];
        let postposed = phrase.span.start > 0 && matches!(tokens[phrase.span.start - 1].text.as_str(), "在" | "于");
        let room_next = |m: &usize| (phrase.span.end..phrase.span.end + 2).contains(&mentions[*m].from);
        let east = matches!(first.kind, Kind::Han | Kind::Hangul) || next.is_some_and(|t| t.kind == Kind::Hangul);
        let leads = east && first.spaced && !postposed && rooms.iter().any(room_next);
        let opens = leads
            || next.is_some_and(|t| matches!(t.mark(), Some(':' | '(' | '-')))
            || next.is_some() && tagged(phrase.span.end, &[Tag::Starts]);
        let stop = phrases.get(p + 1).map_or(tokens.len(), lead);
        let end = (phrase.span.end..stop).find(|&i| ends(i)).unwrap_or(stop);
        let after: Vec<usize> =
            rooms.iter().copied().filter(|&m| (phrase.span.end..end).contains(&mentions[m].span.start)).collect();
        if phrase.noun && !opens {
            // "a basement garage"
            let here = after.iter().copied().find(|&m| mentions[m].span.start == phrase.span.end);
            out.extend(here.map(|m| (m, p)));
            continue;
        }
        if opens || !follows_room && !after.is_empty() {
            // "an upstairs bathroom" is one room, "upstairs: a bathroom, ..." a list
            let article = phrase.span.start > 0 && tagged(phrase.span.start - 1, &[Tag::Articles]);
            let adjective =
                article && !opens && after.first().is_some_and(|&m| mentions[m].span.start == phrase.span.end);
            let rooms_of = if phrase.noun { listed_with(tokens, mentions, &after, tagged) } else { after.len() };
            let taken = if adjective { &after[..1] } else { &after[..rooms_of] };
            out.extend(taken.iter().map(|&m| (m, p)));
            headed = Some(p);
            continue;
        }
        let mut since = p.checked_sub(1).map_or(0, |b| phrases[b].span.end);
        since = (since..from).rev().find(|&i| ends(i) || tokens[i].mark() == Some(':')).map_or(since, |i| i + 1);
        let sentence = (0..phrase.span.start).rev().find(|&i| ends(i)).map_or(0, |i| i + 1);
        let alone =
            phrases.iter().filter(|q| q.span.start >= sentence && !(phrase.span.end..q.span.start).any(ends)).count()
                < 2;
        if alone && let Some(comma) = (since..from).rev().find(|&i| tokens[i].mark() == Some(',')) {
            since = comma;
        }
        // "a ground floor with a kitchen and 3 bedrooms upstairs": the last of a list goes where it says itself
        if let Some(head) = headed.take().filter(|h| p.checked_sub(1) == Some(*h)) {
            let last = rooms.iter().copied().filter(|&m| mentions[m].span.end <= from).max();
            let to = last.map_or(from, |m| mentions[m].from);
            since = (since..to)
                .rev()
                .find(|&i| tokens[i].is_mark() || tagged(i, &[Tag::Joins]) && i + 1 == to)
                .map_or(since.max(to), |i| i + 1);
            out.retain(|(m, q)| *q != head || mentions[*m].span.start < since);
        }
        let taken = rooms.iter().copied().filter(|&m| (since..from).contains(&mentions[m].span.start));
        out.extend(taken.map(|m| (m, p)));
    }
    let mut seen = Vec::new();
    out.retain(|(m, _)| {
        let new = !seen.contains(m);
        seen.push(*m);
        new
    });
    out
}
