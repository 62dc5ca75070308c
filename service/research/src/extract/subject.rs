//! What a figure limits, in which space, and when.

use super::classify::Sentence;
use super::lexicon::Quantity;
use super::mention::{Figure, Mention};
use super::token::Kind;

/// The name of a length that the sentence does not name.
pub const UNNAMED: &str = "dimension";
/// How far behind a figure its quantity may stand ("1.8 m wide"), in tokens.
const BEHIND: usize = 3;
/// Longest condition that is kept, in tokens.
const MAX_CONDITION: usize = 24;
/// How far before a noun its preposition may stand, in tokens.
const GOVERNOR_REACH: usize = 3;
/// Longest subject that is not known, in words.
const MAX_SUBJECT: usize = 3;
/// Past so many figures what a sentence is about is looked up no further back.
const MAX_CARRIED: usize = 8;

/// A space or object that a sentence names.
#[derive(Debug, Clone)]
pub struct Noun {
    from: usize,
    to: usize,
    name: String,
    is_space: bool,
    /// Mostly named as part of a space ("ceilings in bedrooms").
    is_part: bool,
    /// A preposition stands before it.
    governed: bool,
    /// It belongs to the name of a quantity ("floor area").
    covered: bool,
}

impl Sentence<'_> {
    fn dimension(&self, mention: &Mention) -> &str {
        match (&mention.figure, mention.unit.and_then(|u| self.lexicon.units.get(u))) {
            (Figure::Ratio(_), _) => "ratio",
            (_, Some(unit)) => &unit.dimension,
            _ => "count",
        }
    }

    /// Returns the quantity a figure is one of: right behind it, else the nearest before it, else any behind.
    pub fn quantity(&self, i: usize) -> Option<&Quantity> {
        let mention = self.mentions.get(i)?;
        let dimension = self.dimension(mention);
        let fits = |k: usize| {
            self.lexicon.quantities.get(self.quantity_at(k)?.1).filter(|q| q.dimensions.iter().any(|d| d == dimension))
        };
        let next = self.mentions.get(i + 1).map_or(self.tokens.len(), |m| m.from);
        let behind = (mention.to..next.min(mention.to + BEHIND)).find_map(fits);
        let before = || {
            let mut best: Option<(usize, &Quantity)> = None;
            let mut k = 0;
            while k < mention.from {
                if let Some(quantity) = fits(k) {
                    best = Some((k, quantity));
                }
                k = self.quantity_at(k).map_or(k + 1, |q| q.0);
            }
            best.map(|b| b.1)
        };
        let default = || {
            self.lexicon.quantities.iter().find(|q| !q.upper && q.dimensions.first().is_some_and(|d| d == dimension))
        };
        behind
            .or_else(before)
            .or_else(|| (mention.to..next).find_map(fits))
            .or_else(|| default().filter(|_| dimension != "length"))
    }

    /// Returns the end and index of the quantity that begins at a token, or that its word ends with.
    pub fn quantity_at(&self, k: usize) -> Option<(usize, usize)> {
        let find = |(k, token)| {
            let whole = self.lexicon.quantity.at(self.tokens, k);
            whole.or_else(|| self.lexicon.quantity.part(token, true).map(|q| (k + 1, q)))
        };
        let all = self.memo.quantities.get_or_init(|| self.tokens.iter().enumerate().map(find).collect());
        all.get(k).copied().flatten()
    }

    /// Returns the name of what is limited.
    pub fn name(&self, i: usize) -> String {
        let Some(mention) = self.mentions.get(i) else { return String::new() };
        if let Some(side) = mention.side {
            return ["width", "length", "height"].get(side).copied().unwrap_or("length").to_owned();
        }
        if let Some(thing) = mention.thing.and_then(|t| self.lexicon.things.get(t)) {
            return thing.name.clone();
        }
        let name = self.quantity(i).map_or(UNNAMED, |q| q.name.as_str());
        let per = mention.basis.as_ref().filter(|_| self.dimension(mention) == "area");
        per.map_or_else(|| name.to_owned(), |basis| format!("area_per_{basis}"))
    }

    /// Returns the space or object a figure is about, empty when none is named.
    ///
    /// The noun right before the figure wins, then the subject of its clause, then a space that the clause names
    /// elsewhere ("beds are spaced 3.6 m in wards"), then what the figure before it is about.
    pub fn space(&self, i: usize) -> String {
        let Some(mention) = self.mentions.get(i) else { return String::new() };
        let previous = i.checked_sub(1);
        let since = previous.and_then(|k| self.mentions.get(k)).map_or(0, |m| m.to);
        let next = self.mentions.iter().skip(i + 1).find(|m| !m.weak).map_or(self.tokens.len(), |m| m.from);
        let stop = |k: &usize| self.tokens.get(*k).is_some_and(|t| matches!(t.text.as_str(), "," | ";"));
        let next = (mention.to..next).find(stop).unwrap_or(next);
        let nouns = self.memo.nouns.get_or_init(|| self.nouns());
        let within = |from: usize, to: usize| nouns.iter().filter(move |n| n.from >= from && n.to <= to);
        let name = |n: &Noun| n.name.clone();
        if let Some(touching) = within(since, mention.from).find(|n| self.touches(n.to, mention.from)) {
            return name(touching);
        }
        if matches!(mention.figure, Figure::Per(..)) {
            // What is given, not what it is given for.
            let given = within(mention.from, mention.to).find(|n| !self.lexicon.basis.is_at(self.tokens, n.from));
            if let Some(given) = given {
                return name(given);
            }
        }
        // "1.2 m (offices), 1.8 m (schools)"
        if self.tokens.get(mention.to).is_some_and(|t| t.is("("))
            && let Some(bracketed) = nouns.iter().find(|n| n.from == mention.to + 1)
        {
            return name(bracketed);
        }
        // "six toilets on each floor": where something is counted, an object can be the place as well.
        let counted = mention.thing.is_some();
        let behind = || within(mention.to, next).find(|n| n.is_space || counted && n.governed);
        let ahead = || within(since, mention.from);
        let subject =
            || ahead().find(|n| !n.governed && !n.covered && (n.is_space || !n.is_part && behind().is_none()));
        let carried = || previous.filter(|_| i < MAX_CARRIED).map(|k| self.space(k)).filter(|s| !s.is_empty());
        subject()
            .or_else(|| ahead().find(|n| n.is_space && !n.covered))
            .map(name)
            .or_else(|| behind().filter(|_| i == 0 || mention.side.is_none()).map(name))
            .or_else(|| ahead().find(|n| !n.covered).map(name))
            .or_else(carried)
            .or_else(|| within(mention.to, self.tokens.len()).find(|n| n.is_space && !n.covered).map(name))
            .or_else(|| within(mention.from, mention.to).next().map(name))
            .or_else(|| within(0, self.tokens.len()).next().map(name))
            .or_else(|| self.unknown_noun(mention.from))
            .unwrap_or_default()
    }

    /// Returns a subject that is not in the vocabulary ("Dormitories shall", "Seating areas:"), English plurals only.
    fn unknown_noun(&self, to: usize) -> Option<String> {
        let known = |k: usize| {
            ["duty", "plain", "stops", "advice", "habit", "soft_openers", "definite", "negations", "hard_openers"]
                .iter()
                .any(|c| self.lexicon.cues.get(c).is_at(self.tokens, k))
                || self.lexicon.quantity.is_at(self.tokens, k)
                || self.lexicon.before.is_at(self.tokens, k)
        };
        let word = |k: usize| self.tokens.get(k).is_some_and(|t| t.kind == Kind::Word) && !known(k);
        let opener = self.lexicon.cues.get("generic_openers").at(self.tokens, 0).map_or(0, |c| c.0);
        let end = (opener..to).find(|&k| !word(k)).unwrap_or(to);
        let run = self.tokens.get(opener..end).filter(|r| (1..=MAX_SUBJECT).contains(&r.len()))?;
        let last = run.last().filter(|_| matches!(self.lang, "" | "en"))?.text.as_str();
        let stem = match last.strip_suffix("ies") {
            Some(stem) => format!("{stem}y"),
            None => last.strip_suffix('s').filter(|s| s.len() > 2 && !s.ends_with('s'))?.to_owned(),
        };
        let mut words: Vec<&str> = run.iter().rev().skip(1).rev().map(|t| t.text.as_str()).collect();
        words.push(&stem);
        Some(words.join("_"))
    }

    /// Returns what the sentence as a whole is about, empty when it names no space.
    pub fn topic(&self) -> String {
        let nouns = self.memo.nouns.get_or_init(|| self.nouns());
        let free = nouns.iter().find(|n| n.is_space && !n.governed && !n.covered);
        free.or_else(|| nouns.iter().find(|n| n.is_space && !n.covered))
            .or_else(|| nouns.iter().find(|n| !n.governed && !n.covered))
            .map(|n| n.name.clone())
            .unwrap_or_default()
    }

    /// Whether only "of" and comparators stand between a noun and the figure.
    fn touches(&self, from: usize, to: usize) -> bool {
        let mut k = from;
        while k < to {
            let linked = self.lexicon.cues.get("touching").at(self.tokens, k).map(|c| c.0);
            let Some(end) = linked.or_else(|| self.lexicon.before.at(self.tokens, k).map(|c| c.0)) else {
                return false;
            };
            k = end;
        }
        from <= to
    }

    /// Returns the spaces and objects that the sentence names, in its order.
    fn nouns(&self) -> Vec<Noun> {
        let mut out: Vec<Noun> = Vec::new();
        let mut covered = 0;
        let mut k = 0;
        while k < self.tokens.len() {
            if let Some((end, _)) = self.lexicon.quantity.at(self.tokens, k).filter(|q| q.0 > k + 1) {
                covered = covered.max(end);
            }
            let space = self.lexicon.space.at(self.tokens, k);
            let object = self.lexicon.object.at(self.tokens, k);
            let object_wins = object.as_ref().is_some_and(|o| space.as_ref().is_none_or(|s| o.0 > s.0));
            let whole = if object_wins { object } else { space };
            let whole = whole.filter(|w| !self.is_label(k, w.0));
            let found = whole.map(|(end, name)| (end, name, !object_wins)).or_else(|| self.compound(k));
            let Some((to, name, is_space)) = found else {
                k += 1;
                continue;
            };
            let is_part = self.lexicon.cues.get("parts").is_at(self.tokens, k);
            let governed = self.governed(k, out.last().map_or(0, |n| n.to));
            // "bathroom door": the last of a row of nouns is meant.
            if let Some(last) = out.last_mut().filter(|n| n.to == k && !is_part && k >= covered && self.lang != "de") {
                *last = Noun { to, name, is_space, ..last.clone() };
            } else {
                out.push(Noun { from: k, to, name, is_space, is_part, governed, covered: k < covered });
            }
            k = to;
        }
        out
    }

    /// Returns the noun that a German compound ends or begins with.
    fn compound(&self, k: usize) -> Option<(usize, String, bool)> {
        let token = self.tokens.get(k).filter(|_| self.lang == "de" && !self.lexicon.thing.is_at(self.tokens, k))?;
        let (space, object) = (&self.lexicon.space, &self.lexicon.object);
        [(space, true), (object, true), (space, false), (object, false)]
            .into_iter()
            .find_map(|(list, end)| list.part(token, end).map(|name| (k + 1, name, std::ptr::eq(list, space))))
    }

    /// Whether a noun only says which one by its number: "Table 3".
    fn is_label(&self, from: usize, to: usize) -> bool {
        let numbered = self.tokens.get(to).is_some_and(|t| matches!(t.kind, Kind::Number(_) | Kind::Label));
        numbered
            && self.lexicon.cues.get("labels").is_at(self.tokens, from)
            && !self.mentions.iter().any(|m| m.from == to)
    }

    /// Whether a preposition stands before a noun, articles and adjectives aside.
    fn governed(&self, at: usize, since: usize) -> bool {
        for k in (since.max(at.saturating_sub(GOVERNOR_REACH))..at).rev() {
            if self.lexicon.cues.get("governors").at(self.tokens, k).is_some_and(|c| c.0 <= at) {
                return true;
            }
            let verb = ["duty", "plain"].iter().any(|c| self.lexicon.cues.get(c).is_at(self.tokens, k));
            if verb || self.tokens.get(k).is_none_or(|t| t.kind != Kind::Word) {
                return false;
            }
        }
        false
    }

    /// Returns the clauses that say when the sentence holds, as printed.
    pub fn conditions(&self) -> Vec<String> {
        let mut out = Vec::new();
        let mut k = 0;
        while k < self.tokens.len() {
            let opens = self.lexicon.cues.get("hard_openers").is_at(self.tokens, k);
            if !opens || self.lexicon.cues.get("idioms").is_at(self.tokens, k) {
                k += 1;
                continue;
            }
            let last = self.tokens.len();
            let end =
                (k..last).find(|&j| matches!(self.tokens[j].text.as_str(), "," | ";" | "." | "。")).unwrap_or(last);
            let end = end.min(k + MAX_CONDITION);
            let text = self
                .tokens
                .get(k)
                .zip(self.tokens.get(end.saturating_sub(1)))
                .and_then(|(a, b)| self.text.get(a.start..b.end));
            out.extend(text.map(str::to_owned));
            k = end.max(k + 1);
        }
        out
    }
}
