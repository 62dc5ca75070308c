//! Figures in a sentence: a number, range, ratio or formula with its unit or with the thing it counts.

use super::lexicon::{Bound, Lexicon};
use super::token::{Kind, Token, is_dense};

/// Words that may stand between a number and the thing counted.
const MAX_ADJECTIVES: usize = 2;
/// Words that may stand between the thing counted and "per".
const MAX_RATIO_GAP: usize = 10;
/// Words that may stand between "for every 25 employees" and what they get.
const MAX_AHEAD_GAP: usize = 8;
/// Words that may stand between a figure and "per bed".
const MAX_BASIS_GAP: usize = 5;
/// How far before a figure what it counts may begin, in tokens.
const MAX_THING_BEFORE: usize = 6;
/// A unit this long, in letters, is a word and not an abbreviation.
const MIN_SPELLED_UNIT: usize = 3;
/// Two figures side by side, one in brackets, are the same one converted when they differ by less.
const CONVERSION_TOLERANCE: f64 = 0.04;

/// What is printed.
#[derive(Debug, Clone, PartialEq)]
pub enum Figure {
    Number(f64),
    Range(f64, f64),
    /// `1 per 25`.
    Per(f64, f64),
    /// `1:12`, `1/10`.
    Ratio(String),
    /// `15 + 6 * n`.
    Formula(String),
}

/// A figure at tokens `from..to`.
#[derive(Debug, Clone)]
pub struct Mention {
    pub from: usize,
    pub to: usize,
    pub figure: Figure,
    /// Index in the lexicon.
    pub unit: Option<usize>,
    /// What is counted.
    pub thing: Option<usize>,
    /// Given for each of these.
    pub basis: Option<String>,
    /// Position among the factors of `2 m by 3 m`, counting from 0.
    pub side: Option<usize>,
    /// The number is an article as well ("a", "ein").
    pub weak: bool,
}

/// Finds figures in tokens of a text.
pub struct Finder<'a> {
    pub lexicon: &'a Lexicon,
    pub text: &'a str,
    pub lang: &'a str,
    pub tokens: &'a [Token],
}

impl Finder<'_> {
    /// Returns the figures that could be limits, in the order of the text.
    pub fn mentions(&self) -> Vec<Mention> {
        let raws = self.drop_labels(self.numbers());
        let mut out: Vec<Mention> = Vec::new();
        for raw in raws {
            let joined = out.last().and_then(|last| self.join(last, &raw));
            match joined {
                Some(Joined::One(mention)) => {
                    out.pop();
                    out.push(mention);
                }
                Some(Joined::Two(first, second)) => {
                    out.pop();
                    out.extend([first, second]);
                }
                None => out.push(raw),
            }
        }
        let used: Vec<bool> = out
            .iter()
            .map(|m| {
                m.unit.is_some() || m.thing.is_some() || !matches!(m.figure, Figure::Number(_) | Figure::Range(..))
            })
            .collect();
        out.into_iter().zip(used).filter(|(_, used)| *used).map(|(m, _)| m).collect()
    }

    fn cue(&self, name: &str, i: usize) -> Option<usize> {
        self.lexicon.cues.get(name).at(self.tokens, i).map(|c| c.0)
    }

    fn numbers(&self) -> Vec<Mention> {
        let mut out = Vec::new();
        let mut i = 0;
        while i < self.tokens.len() {
            let formula = self.formula(i).map(|(to, figure)| (to, figure, false));
            let Some((to, figure, weak)) = formula.or_else(|| self.number(i)) else {
                i += 1;
                continue;
            };
            let mut mention = Mention { from: i, to, figure, unit: None, thing: None, basis: None, side: None, weak };
            self.add_unit(&mut mention);
            if mention.unit.is_none() {
                self.add_thing(&mut mention);
            }
            self.add_basis(&mut mention);
            i = mention.to.max(i + 1);
            out.push(mention);
        }
        out
    }

    /// Returns the number that begins at a token, its end, and whether it may be an article.
    fn number(&self, i: usize) -> Option<(usize, Figure, bool)> {
        let numbers = &self.lexicon.numbers;
        let token = self.tokens.get(i)?;
        if let Some((to, (a, b))) = self.lexicon.fractions.at(self.tokens, i) {
            let length = self.unit_after(to).is_some_and(|u| self.dimension(u.0) != "share");
            let figure = if length { Figure::Number(a / b) } else { Figure::Ratio(format!("{a}/{b}")) };
            return Some((to, figure, false));
        }
        if let Some(n) = token.number() {
            let (mut value, mut to) = (n, i + 1);
            let hyphen = self.tokens.get(i + 1).is_some_and(|t| t.glued && matches!(t.text.as_str(), "-" | "‑"));
            if let Some(part) = self.tokens.get(i + 1).and_then(|t| numbers.symbols.get(&t.text)) {
                (value, to) = (n + part, i + 2);
            } else if let Some((over, end)) = self.over(i + 2).filter(|_| hyphen) {
                (value, to) = (n + over, end);
            } else if let Some((over, end)) = self.over(i + 1)
                && self.tokens.get(i + 1).is_some_and(|t| !t.glued)
            {
                (value, to) = (n + over, end);
            } else if let Some((over, end)) = self.over(i) {
                let with_unit = self.unit_after(end).is_some_and(|u| self.dimension(u.0) == "length");
                let [a, b] = [i, i + 2].map(|k| self.tokens.get(k).map_or("", |t| t.text.as_str()));
                let figure = if with_unit { Figure::Number(over) } else { Figure::Ratio(format!("{a}/{b}")) };
                return Some((end, figure, false));
            } else if let Some(b) = self.after_colon(i) {
                return Some((i + 3, Figure::Ratio(format!("{n}:{b}")), false));
            }
            return Some(self.inverse(to, value).unwrap_or((to, Figure::Number(value), false)));
        }
        if let Some(part) = numbers.symbols.get(&token.text) {
            return Some((i + 1, Figure::Number(*part), false));
        }
        let (value, to) = self.words(i)?;
        if let Some(inverse) = self.inverse(to, value) {
            return Some(inverse);
        }
        Some((to, Figure::Number(value), to == i + 1 && numbers.weak.contains(&token.text)))
    }

    /// Returns "12분의 1" and "七分之一", whose parts stand the other way round.
    fn inverse(&self, to: usize, below: f64) -> Option<(usize, Figure, bool)> {
        let (end, Figure::Number(above), _) = self.number(self.cue("inverse_of", to)?)? else { return None };
        Some((end, Figure::Ratio(format!("{above}/{below}")), false))
    }

    /// Returns the value of `a/b` at a token, and its end; both are small whole numbers side by side.
    fn over(&self, i: usize) -> Option<(f64, usize)> {
        let [a, slash, b] = self.tokens.get(i..i + 3)? else { return None };
        let (x, y) = (a.number()?, b.number()?);
        let fits = matches!(slash.text.as_str(), "/" | "⁄") && slash.glued && b.glued && x < y && y <= 64.0;
        (fits && x.fract() == 0.0 && y.fract() == 0.0 && x > 0.0).then_some((x / y, i + 3))
    }

    /// Returns the second figure of `a:b` unless it is a time of day.
    fn after_colon(&self, i: usize) -> Option<f64> {
        let [a, colon, b] = self.tokens.get(i..i + 3)? else { return None };
        let (x, y) = (a.number()?, b.number()?);
        let tight = colon.is(":") && y > 0.0 && (colon.glued && b.glued || !colon.glued && x == 1.0);
        let clock = b.text.len() == 2 && x > 1.0 && x < 25.0 && (y % 15.0 == 0.0 || y == 0.0);
        (tight && !clock && !self.cue("label_after", i + 3).is_some_and(|_| clock)).then_some(y)
    }

    /// Returns a number in words and its end.
    fn words(&self, i: usize) -> Option<(f64, usize)> {
        let numbers = &self.lexicon.numbers;
        let word = |k: usize| self.tokens.get(k).filter(|t| t.kind == Kind::Word).map(|t| t.text.as_str());
        let simple = |k: usize| word(k).and_then(|w| numbers.words.get(w).copied().or_else(|| self.german(w, 0)));
        let first = word(i)?;
        if numbers.hundred.iter().any(|h| h == first) && i > 0 {
            return Some((100.0, i + 1));
        }
        let (mut total, mut part, mut k) = (0.0, simple(i)?, i + 1);
        loop {
            let skip = self.tokens.get(k).is_some_and(|t| t.is("-") && t.glued)
                || word(k).is_some_and(|w| part >= 100.0 && numbers.joiner.iter().any(|j| j == w));
            let next = k + usize::from(skip);
            let Some(w) = word(next) else { break };
            if numbers.hundred.iter().any(|h| h == w) && part < 100.0 {
                part *= 100.0;
            } else if numbers.thousand.iter().any(|t| t == w) {
                total += part * 1000.0;
                part = 0.0;
            } else if let Some(n) = simple(next).filter(|n| {
                *n < 10.0 && part % 10.0 == 0.0 && part >= 20.0 || *n < 100.0 && part >= 100.0 && part % 100.0 == 0.0
            }) {
                part += n;
            } else {
                break;
            }
            k = next + 1;
        }
        Some((total + part, k))
    }

    /// Returns the value of a German number written as one word (`fünfundachtzig`, `zweihundert`).
    fn german(&self, word: &str, depth: usize) -> Option<f64> {
        let numbers = &self.lexicon.numbers;
        if depth > 3 || word.len() > 60 {
            return None;
        }
        if let Some(n) = numbers.words.get(word) {
            return Some(*n);
        }
        for (names, scale) in [(&numbers.thousand, 1000.0), (&numbers.hundred, 100.0)] {
            for name in names {
                if let Some((before, after)) = word.split_once(name.as_str()) {
                    let head = if before.is_empty() { Some(1.0) } else { self.german(before, depth + 1) };
                    let tail = if after.is_empty() { Some(0.0) } else { self.german(after, depth + 1) };
                    return Some(head? * scale + tail?);
                }
            }
        }
        let (ones, tens) = word.split_once(numbers.german_joiner.as_str())?;
        let (ones, tens) = (*numbers.words.get(ones)?, *numbers.words.get(tens)?);
        (ones < 10.0 && tens % 10.0 == 0.0 && tens >= 20.0).then_some(ones + tens)
    }

    fn dimension(&self, unit: usize) -> &str {
        self.lexicon.units.get(unit).map_or("", |u| u.dimension.as_str())
    }

    fn factor(&self, unit: Option<usize>) -> f64 {
        unit.and_then(|u| self.lexicon.units.get(u)).map_or(1.0, |u| u.factor)
    }

    /// Returns the unit that follows the tokens before `to`, and the token after it.
    fn unit_after(&self, to: usize) -> Option<(usize, usize)> {
        let last = self.tokens.get(to.checked_sub(1)?)?;
        let (unit, end) = self.lexicon.unit_at(self.text, last.end, self.lang)?;
        let mut next = to;
        while self.tokens.get(next).is_some_and(|t| t.start < end) {
            next += 1;
        }
        let preposition = self.lexicon.units.get(unit)?.preposition;
        let follows = self.tokens.get(next);
        if preposition {
            let noun = follows.is_some_and(|t| t.kind == Kind::Word && !t.glued)
                && (self.lexicon.space.is_at(self.tokens, next)
                    || self.lexicon.cues.get("stops").is_at(self.tokens, next)
                        && self.cue("determiners", next).is_some());
            if noun || self.number(next).is_some_and(|n| !n.2) {
                return None;
            }
        }
        if follows.is_some_and(|t| t.is(".") && t.glued) && self.tokens.get(next + 1).is_some_and(|t| !t.capital) {
            next += 1;
        }
        Some((unit, next))
    }

    fn add_unit(&self, mention: &mut Mention) {
        if mention.weak && self.tokens.get(mention.to).is_some_and(|t| t.kind != Kind::Word) {
            return;
        }
        let Some((unit, to)) = self.unit_after(mention.to) else { return };
        // "one m" may be an article and a name; "one hour" is a figure.
        let spelled = self.tokens.get(mention.to).map_or(0, |t| t.text.chars().count());
        if mention.weak && self.dimension(unit) != "length" && spelled < MIN_SPELLED_UNIT {
            return;
        }
        if let Figure::Ratio(_) = mention.figure {
            return;
        }
        (mention.unit, mention.to) = (Some(unit), to);
        let id = |u: usize| self.lexicon.units.get(u).map_or("", |u| u.id.as_str());
        if id(unit) == "ft" {
            let start =
                to + usize::from(self.tokens.get(to).is_some_and(|t| matches!(t.text.as_str(), "-" | "‑" | "–")));
            if let (Some((end, Figure::Number(inches), false)), Figure::Number(feet)) =
                (self.number(start), &mention.figure)
                && let Some((inch, end)) = self.unit_after(end)
                && id(inch) == "in"
                && inches < 12.0
            {
                mention.figure = Figure::Number(feet + inches / 12.0);
                mention.to = end;
            }
        }
        let signed = self.lexicon.units.get(unit).is_some_and(|u| u.signed);
        let minus = mention.from.checked_sub(1).and_then(|k| self.tokens.get(k));
        if signed
            && minus.is_some_and(|t| matches!(t.text.as_str(), "-" | "−") && !t.glued)
            && let Figure::Number(n) = mention.figure
        {
            mention.figure = Figure::Number(-n);
            mention.from -= 1;
        }
    }

    fn add_thing(&self, mention: &mut Mention) {
        if self.tokens.get(mention.to).is_some_and(|t| t.glued && t.kind != Kind::Word) {
            return;
        }
        let whole = self.cue("partitive", mention.to).filter(|_| !mention.weak);
        let whole = whole.filter(|&at| self.lexicon.thing.is_at(self.tokens, at)).unwrap_or(mention.to);
        for skip in 0..=MAX_ADJECTIVES {
            let at = whole + skip;
            if let Some((to, thing)) = self.lexicon.thing.at(self.tokens, at) {
                // The last noun of a row is the thing: "exit doors".
                let (to, thing) = self.lexicon.thing.at(self.tokens, to).unwrap_or((to, thing));
                (mention.thing, mention.to) = (Some(thing), to);
                return;
            }
            if skip == 0
                && let Some((end, _)) = self.lexicon.after.at(self.tokens, at)
                && let Some((_, thing)) = (end..=end + 1).find_map(|k| self.lexicon.thing.at(self.tokens, k))
            {
                mention.thing = Some(thing); // "five or more charging points": the comparator is read later
                return;
            }
            let between = self.tokens.get(at);
            if between.is_none_or(|t| t.kind != Kind::Word) || self.lexicon.cues.get("stops").is_at(self.tokens, at) {
                break;
            }
        }
        if let Some(end) = self.cue("classifiers", mention.to).filter(|_| self.tokens[mention.from].number().is_some())
            && let Some(thing) = self.thing_before(mention.from)
        {
            (mention.thing, mention.to) = (Some(thing), end);
            return;
        }
        if let Some(thing) =
            self.tokens.get(mention.to).filter(|_| self.lang == "de").and_then(|t| self.lexicon.thing.part(t, true))
        {
            (mention.thing, mention.to) = (Some(thing), mention.to + 1);
        }
    }

    /// Returns the thing right before a figure, with a particle between at most: "출구를 2개소".
    fn thing_before(&self, from: usize) -> Option<usize> {
        (1..=MAX_THING_BEFORE).find_map(|n| {
            let (end, thing) = self.lexicon.thing.at(self.tokens, from.checked_sub(n)?)?;
            let particle = end == from || end + 1 == from && self.cue("particles", end) == Some(from);
            particle.then_some(thing)
        })
    }

    /// Reads "per person", "/bed", "je Arbeitsplatz" behind a figure with a unit or a thing.
    fn add_basis(&self, mention: &mut Mention) {
        if mention.unit.is_none() && mention.thing.is_none() {
            return;
        }
        let Some(mut at) = self.cue("plain_per", mention.to) else {
            mention.basis = self.basis_behind(mention);
            return;
        };
        if let Some(end) = self.cue("additional", at) {
            at = end;
        }
        if let Some((to, basis)) = self.lexicon.basis.at(self.tokens, at) {
            (mention.basis, mention.to) = (Some(basis), to);
        }
    }

    /// Reads "per bed" behind what is measured: "18.5 m² of clear floor area per bed".
    fn basis_behind(&self, mention: &Mention) -> Option<String> {
        mention.unit?;
        for k in mention.to..mention.to + MAX_BASIS_GAP {
            if let Some(at) = self.cue("plain_per", k).filter(|_| self.cue("english_per", k).is_none()) {
                return self.lexicon.basis.at(self.tokens, at).map(|b| b.1);
            }
            let measured = k > mention.to
                || self.tokens.get(k).is_some_and(|t| t.is("of"))
                || self.lexicon.quantity.is_at(self.tokens, k)
                || self.tokens.get(k).is_some_and(|t| self.lexicon.quantity.part(t, true).is_some());
            if !measured || self.cue("duty", k).is_some() || self.tokens.get(k).is_none_or(|t| t.kind != Kind::Word) {
                return None;
            }
        }
        None
    }

    /// Leaves out numbers that name something, and parts of dates.
    fn drop_labels(&self, raws: Vec<Mention>) -> Vec<Mention> {
        let labels = self.lexicon.cues.get("labels");
        let mut labelled: Option<usize> = None; // end of the last number that is a label
        let mut out = Vec::new();
        for raw in raws {
            let before = raw.from.checked_sub(1);
            let dot = usize::from(before.and_then(|k| self.tokens.get(k)).is_some_and(|t| t.is(".")));
            let word = before.and_then(|k| k.checked_sub(dot));
            let is_plain = matches!(raw.figure, Figure::Number(_) | Figure::Ratio(_)) && raw.unit.is_none();
            let digits = self.tokens.get(raw.from).is_some_and(|t| t.number().is_some());
            let named =
                word.is_some_and(|k| labels.is_at(self.tokens, k) && !self.lexicon.before.is_at(self.tokens, k));
            let money = [word, Some(raw.to)]
                .into_iter()
                .flatten()
                .any(|k| self.lexicon.cues.get("currency").is_at(self.tokens, k));
            let date =
                is_plain && raw.thing.is_none() && self.lexicon.cues.get("label_after").is_at(self.tokens, raw.to);
            let joined = is_plain
                && self.tokens.get(raw.to).is_some_and(|t| t.glued && t.is("-"))
                && self.tokens.get(raw.to + 1).is_some_and(|t| t.glued && t.kind == Kind::Word);
            let list = labelled.is_some_and(|end| raw.from <= end + 1 && is_plain);
            let year = is_plain
                && raw.thing.is_none()
                && matches!(raw.figure, Figure::Number(n) if n.fract() == 0.0 && (1500.0..2100.0).contains(&n))
                && self.tokens.get(raw.from).is_some_and(|t| t.text.len() == 4);
            let scale = matches!(raw.figure, Figure::Ratio(_))
                && self
                    .tokens
                    .get(raw.from.saturating_sub(3)..(raw.to + 2).min(self.tokens.len()))
                    .is_some_and(|t| self.lexicon.cues.get("scale").any(t));
            if is_plain && digits && (named || list || joined) || money || date || year || scale {
                labelled = (named || list).then_some(raw.to);
                continue;
            }
            labelled = None;
            out.push(raw);
        }
        out
    }

    /// Joins a figure with the one before it where both are one: ranges, tolerances, conversions, ratios, sums.
    fn join(&self, a: &Mention, b: &Mention) -> Option<Joined> {
        let between = self.tokens.get(a.to..b.from)?;
        let at = |name: &str| self.cue(name, a.to).is_some_and(|end| end == b.from);
        let (Figure::Number(x), Figure::Number(y)) = (&a.figure, &b.figure) else {
            return None;
        };
        let (x, y) = (*x, *y);
        let (fa, fb) = (self.factor(a.unit), self.factor(b.unit));
        if let Some(joined) = self.for_each(a, b, x, y).or_else(|| self.both_bounds(a, b, x, y)) {
            return Some(Joined::One(joined));
        }
        let whole = Mention { from: a.from, to: b.to, weak: false, ..b.clone() };
        if let (Some(p), Some(q)) = (a.unit, b.unit) {
            let same = self.dimension(p) == self.dimension(q);
            let equal = (x * fa - y * fb).abs() <= CONVERSION_TOLERANCE * (x * fa).abs();
            if same && equal && self.is_conversion(a, b, between) {
                return Some(Joined::One(self.converted(a, b)));
            }
            let bracket = between.last().is_some_and(|t| t.is("("));
            if same && equal && bracket && self.lexicon.after.is_at(self.tokens, a.to) {
                return Some(Joined::One(a.clone())); // "44 in. min. (1118 mm)": the comparator is read later
            }
            if !same {
                return None;
            }
        }
        let signs: Vec<&str> = between.iter().map(|t| t.text.as_str()).collect();
        if at("tolerance") || matches!(signs.as_slice(), ["+", "/", _]) {
            let unit = b.unit.or(a.unit)?;
            let x = if a.unit.is_some() { x * fa / self.factor(Some(unit)) } else { x };
            let (low, high) = (round(x - y), round(x + y));
            return Some(Joined::One(Mention { figure: Figure::Range(low, high), unit: Some(unit), ..whole }));
        }
        let opened = a.from.checked_sub(1).is_some_and(|k| {
            (0..3).any(|n| k.checked_sub(n).is_some_and(|k| self.cue("between_only", k).is_some_and(|e| e <= a.from)))
        });
        let inner_bound =
            b.from.checked_sub(1).is_some_and(|k| self.lexicon.before.is_at(self.tokens, k) && !at("ranges"));
        let and_then = || {
            let end = self.cue("and", a.to)?;
            (end < b.from && self.cue("articles", end) == Some(b.from)).then_some(())
        };
        if (at("ranges") || opened && (at("and") || and_then().is_some()))
            && !inner_bound
            && (b.unit.is_some() || b.thing.is_some())
            && a.thing.is_none()
        {
            let low = if a.unit.is_some() { x * fa / fb } else { x };
            if low < y {
                return Some(Joined::One(Mention { figure: Figure::Range(round(low), y), ..whole }));
            }
        }
        if at("by") && b.unit.is_some() && a.thing.is_none() {
            let side = a.side.unwrap_or(0);
            let first = Mention { unit: a.unit.or(b.unit), side: Some(side), thing: None, basis: None, ..a.clone() };
            return Some(Joined::Two(first, Mention { side: Some(side + 1), basis: None, ..b.clone() }));
        }
        if self.lexicon.cues.get("hard_plus").is_at(self.tokens, a.to) && a.to + 1 == b.from && b.basis.is_some() {
            return Some(Joined::One(Mention {
                figure: Figure::Formula(format!("{x} + {y} * n")),
                basis: None,
                ..whole
            }));
        }
        if self.is_ahead(a, b)
            && self.names_something(a)
            && self.names_something(b)
            && b.basis.is_none()
            && x > 0.0
            && between.len() <= MAX_AHEAD_GAP
        {
            let basis = self.basis_before(a.to);
            return Some(Joined::One(Mention { figure: Figure::Per(y, x), basis, ..whole }));
        }
        self.ratio(a, b, between, whole, x, y)
    }

    /// Joins "20명당 변기 1개" and "1인당 1.8㎡".
    fn for_each(&self, a: &Mention, b: &Mention, x: f64, y: f64) -> Option<Mention> {
        let at = [a.to, a.to + 1].into_iter().find(|&k| self.cue("behind_per", k).is_some_and(|end| end <= b.from))?;
        if a.unit.is_some() || x <= 0.0 || at > a.to && self.cue("classifiers", a.to) != Some(at) {
            return None;
        }
        let whole = Mention { from: a.from, weak: false, basis: self.basis_before(a.to), ..b.clone() };
        match b.unit {
            Some(_) if x == 1.0 => Some(whole),
            None if self.names_something(b) => Some(Mention { figure: Figure::Per(y, x), ..whole }),
            _ => None,
        }
    }

    /// Joins "0.8m 이상 0.9m 이하".
    fn both_bounds(&self, a: &Mention, b: &Mention, x: f64, y: f64) -> Option<Mention> {
        let bound = |k: usize| {
            let (end, index) = self.lexicon.after.at(self.tokens, k)?;
            let dense = self.tokens.get(k).is_some_and(|t| t.text.starts_with(is_dense));
            self.lexicon.comparators.get(index).filter(|c| c.strong && dense).map(|c| (end, c.bound))
        };
        let (least, most) = (bound(a.to)?, bound(b.to)?);
        let apart = self.tokens.get(least.0..b.from)?.iter().all(|t| t.is(",") || t.is("、"));
        let (fa, fb) = (self.factor(a.unit), self.factor(b.unit));
        let low = x * fa / fb;
        let fits = least.1 == Bound::Min && most.1 == Bound::Max && a.unit.is_some() && b.unit.is_some() && low < y;
        (apart && fits).then(|| Mention { from: a.from, figure: Figure::Range(round(low), y), ..b.clone() })
    }

    /// Whether the first figure says for how many the second is given: "each group of 12 desks".
    fn is_ahead(&self, a: &Mention, b: &Mention) -> bool {
        let ahead = (1..=MAX_ADJECTIVES + 2).any(|n| {
            a.from
                .checked_sub(n)
                .is_some_and(|k| self.cue("plain_per", k) == Some(a.from) || self.cue("ahead_per", k) == Some(a.from))
        });
        let on = (1..=2).any(|n| a.from.checked_sub(n).is_some_and(|k| self.cue("ahead_on", k) == Some(a.from)));
        ahead || on && (a.to..b.from).any(|k| self.cue("falls_to", k).is_some())
    }

    /// Returns the first of two figures of which the second is the same converted, with the bracket that closes.
    fn converted(&self, a: &Mention, b: &Mention) -> Mention {
        let close = usize::from(self.tokens.get(b.to).is_some_and(|t| matches!(t.text.as_str(), ")" | "]")));
        let mut kept = Mention { to: b.to + close, ..a.clone() };
        self.add_basis(&mut kept);
        kept
    }

    /// Joins "one toilet for every 25 employees", "1 per 10", "1 in 12".
    fn ratio(&self, a: &Mention, b: &Mention, between: &[Token], whole: Mention, x: f64, y: f64) -> Option<Joined> {
        if between.len() > MAX_RATIO_GAP || y <= 0.0 {
            return None;
        }
        if let Some(unit) = a.unit {
            // "1 m² of storage for every 10 m² of floor"
            let foreign = |k: usize| self.cue("english_per", k).is_some() && !matches!(self.lang, "" | "en");
            let per = (a.to..b.from).any(|k| self.cue("plain_per", k) == Some(b.from) && !foreign(k));
            let share = per && b.unit == Some(unit);
            return share.then_some(Joined::One(Mention {
                figure: Figure::Per(x, y),
                unit: None,
                thing: None,
                ..whole
            }));
        }
        let noun = self.tokens.get(b.to).is_some_and(|t| t.kind == Kind::Word && self.cue("stops", b.to).is_none());
        if a.weak && x == 1.0 && (b.thing.is_some() || noun) && self.cue("one_in", a.to) == Some(b.from) {
            return Some(Joined::One(Mention { figure: Figure::Per(x, y), thing: b.thing, unit: None, ..whole }));
        }
        let bare = a.thing.is_none() && b.thing.is_none() && b.unit.is_none();
        if bare && x == 1.0 && y > 1.0 && self.cue("one_in", a.to) == Some(b.from) {
            return Some(Joined::One(Mention { figure: Figure::Ratio(format!("{x}:{y}")), ..whole }));
        }
        let foreign = |k: usize| self.cue("english_per", k).is_some() && !matches!(self.lang, "" | "en");
        let shared_out = |k: usize| k > 0 && self.cue("distributive", k - 1) == Some(b.from);
        let per = (a.to..b.from).find(|&k| self.cue("per", k) == Some(b.from) && !foreign(k) && !shared_out(k))?;
        let plain = self.cue("plain_per", per) == Some(b.from);
        if (a.to..per).any(|k| {
            self.tokens.get(k).is_some_and(|t| t.kind != Kind::Word && !matches!(t.text.as_str(), "'" | "’" | "-"))
                || !plain && self.lexicon.cues.get("duty").is_at(self.tokens, k)
        }) {
            return None;
        }
        let counted = a.thing.is_some() || per > a.to || b.thing.is_some();
        let describes = a.weak && self.cue("duty", b.to).is_some(); // "a flat for two persons needs"
        if !(plain || counted && x <= 4.0 && !describes) {
            return None;
        }
        let basis = self
            .basis_before(b.to)
            .or_else(|| self.lexicon.basis.at(self.tokens, b.to).map(|b| b.1))
            .or(b.basis.clone())
            .or_else(|| b.unit.and_then(|u| self.lexicon.units.get(u)).map(|u| u.id.clone()));
        Some(Joined::One(Mention { figure: Figure::Per(x, y), thing: a.thing, basis, unit: None, ..whole }))
    }

    /// Whether a noun follows a bare number, known or not.
    fn names_something(&self, mention: &Mention) -> bool {
        let noun = self.tokens.get(mention.to).is_some_and(|t| t.kind == Kind::Word && !t.glued)
            && self.cue("stops", mention.to).is_none();
        mention.unit.is_none() && (mention.thing.is_some() || noun)
    }

    /// Returns the basis whose words end at a token.
    fn basis_before(&self, to: usize) -> Option<String> {
        (1..=2).find_map(|n| {
            let from = to.checked_sub(n)?;
            self.lexicon.basis.at(self.tokens, from).filter(|b| b.0 == to).map(|b| b.1)
        })
    }

    /// Whether the second figure stands in brackets, behind a slash or an equals sign.
    fn is_conversion(&self, a: &Mention, b: &Mention, between: &[Token]) -> bool {
        let sign = between.first().is_some_and(|t| matches!(t.text.as_str(), "(" | "[" | "/" | "=" | "≈"));
        sign && between.len() <= 4 || between.is_empty() && a.unit != b.unit
    }
}

enum Joined {
    One(Mention),
    Two(Mention, Mention),
}

/// Without the dust of binary fractions.
fn round(x: f64) -> f64 {
    (x * 1e9).round() / 1e9
}
