//! What a figure limits, in which space, and when.

use super::classify::Sentence;
use super::lexicon::{Phrases, Quantity};
use super::mention::{Figure, Mention};

/// How far behind a figure its quantity may stand ("1.8 m wide"), in tokens.
const BEHIND: usize = 3;
/// Longest condition that is kept, in tokens.
const MAX_CONDITION: usize = 24;

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
            let token = self.tokens.get(k)?;
            let known = self.lexicon.quantity.at(self.tokens, k).map(|q| q.1);
            let index = known.or_else(|| self.lexicon.quantity.part(token, true))?;
            self.lexicon.quantities.get(index).filter(|q| q.dimensions.iter().any(|d| d == dimension))
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
                k = self.lexicon.quantity.at(self.tokens, k).map_or(k + 1, |q| q.0);
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

    /// Returns the name of what is limited.
    pub fn name(&self, i: usize) -> String {
        let Some(mention) = self.mentions.get(i) else { return String::new() };
        if let Some(side) = mention.side {
            return ["width", "length", "height"].get(side).copied().unwrap_or("length").to_owned();
        }
        if let Some(thing) = mention.thing.and_then(|t| self.lexicon.things.get(t)) {
            return thing.name.clone();
        }
        let name = self.quantity(i).map_or("dimension", |q| q.name.as_str());
        let per = mention.basis.as_ref().filter(|_| self.dimension(mention) == "area");
        per.map_or_else(|| name.to_owned(), |basis| format!("area_per_{basis}"))
    }

    /// Returns the space or object a figure is about, empty when none is named.
    pub fn space(&self, i: usize) -> String {
        let Some(mention) = self.mentions.get(i) else { return String::new() };
        let since = i.checked_sub(1).and_then(|k| self.mentions.get(k)).map_or(0, |m| m.to);
        let end = self.tokens.len();
        let (space, object) = (&self.lexicon.space, &self.lexicon.object);
        let near = self.first(space, since, mention.from).or_else(|| self.first(space, 0, mention.from));
        near.or_else(|| self.first(object, 0, mention.from).filter(|_| self.first(space, mention.to, end).is_none()))
            .or_else(|| self.first(space, mention.to, end))
            .or_else(|| self.first(object, 0, end))
            .unwrap_or_default()
    }

    fn first(&self, phrases: &Phrases<String>, from: usize, to: usize) -> Option<String> {
        (from..to).find_map(|k| {
            let known = phrases.at(self.tokens, k).map(|p| p.1);
            let part = || {
                let token = self.tokens.get(k).filter(|_| self.lang == "de")?;
                phrases.part(token, true).or_else(|| phrases.part(token, false))
            };
            known.or_else(part)
        })
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
