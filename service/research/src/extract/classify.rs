//! Which figures of a sentence are limits, of what kind, and which only say when a limit holds or report a fact.

use std::cell::OnceCell;

use super::lexicon::{Bound, Lexicon};
use super::mention::{Figure, Mention};
use super::subject::Noun;
use super::token::{Kind, Token};
use super::{Confidence, ConstraintType};

/// How far behind a figure "minimum" may stand, in tokens.
const AFTER_REACH: usize = 9;
/// How far before a comparator the word may stand that makes it a condition, in tokens.
const OPENER_REACH: usize = 6;
/// Where the subject's noun may stand at the latest, in tokens.
const MAX_ADJECTIVES_OF_SUBJECT: usize = 3;
/// How far behind a figure "preferred" may stand, in tokens.
const ADVICE_REACH: usize = 2;
/// Longest head of a note that is not known, in words.
const MAX_TITLE: usize = 4;
/// Longest note that may hold a verb that is not known, in words.
const MAX_SHORT_NOTE: usize = 8;
/// Longest note without a verb, in words.
const MAX_NOTE: usize = 14;
/// How far behind a comparator its negation may stand in languages whose verb comes last, in tokens.
const DENIAL_REACH: usize = 9;
/// How far before a range the words may stand that make it one, in tokens.
const SPAN_REACH: usize = 4;
/// How far before a figure "within" and the like may stand, in tokens.
const CLOSE_REACH: usize = 3;

/// A sentence and its figures.
pub struct Sentence<'a> {
    pub lexicon: &'a Lexicon,
    pub text: &'a str,
    pub lang: &'a str,
    pub tokens: &'a [Token],
    pub mentions: &'a [Mention],
    /// What is asked again for each figure.
    pub memo: Memo,
}

/// Answers about the whole sentence.
#[derive(Debug, Default)]
pub struct Memo {
    pub nouns: OnceCell<Vec<Noun>>,
    /// For each token the end and index of the quantity that begins there, or that the word ends with.
    pub quantities: OnceCell<Vec<Option<(usize, usize)>>>,
    generic: OnceCell<bool>,
    /// The first token with which a note is about something known.
    known_from: OnceCell<usize>,
    plain: OnceCell<bool>,
    soft_duty: OnceCell<bool>,
}

/// What stands at a figure.
#[derive(Debug, Clone, Copy)]
struct Sided {
    bound: Bound,
    strong: bool,
    /// "within", "up to": words of place as well.
    fixed: bool,
    /// Where the comparator begins.
    at: usize,
    /// It stands behind the figure.
    behind: bool,
}

/// What the sentence as a whole is.
struct Tone {
    duty: bool,
    advice: bool,
    habit: bool,
    reckoned: bool,
    report: bool,
    former: bool,
    past: bool,
    plain: bool,
}

/// What speaks for a figure being a rule.
struct Weight {
    /// The sentence is a note.
    form: bool,
    /// It speaks of all things of a kind.
    generic: bool,
    /// A comparator stands at one of its figures.
    any_strong: bool,
    /// Duty, advice or the form make it a rule.
    normative: bool,
    /// It only describes.
    reported: bool,
}

impl Sentence<'_> {
    /// Returns for each figure its kind and how plain it is, none where it is no limit.
    pub fn verdicts(&self) -> Vec<Option<(ConstraintType, Confidence)>> {
        let tone = self.tone();
        let unread = self.is_unread();
        if tone.former || tone.report && !self.is_physical() || tone.past && !tone.duty {
            return vec![None; self.mentions.len()];
        }
        let sides = self.sides();
        let mut conditions: Vec<bool> = (0..self.mentions.len()).map(|i| self.is_condition(i, sides[i])).collect();
        let main = self.first_duty();
        for i in 0..self.mentions.len() {
            let before = main.is_some_and(|d| self.mentions[i].to <= d);
            let later =
                (i + 1..self.mentions.len()).any(|j| !conditions[j] && main.is_some_and(|d| self.mentions[j].from > d));
            let bare = sides[i].is_none_or(|s| !s.strong || s.at > 0 && self.ends_noun(s.at));
            if before && later && bare && self.mentions[i].thing.is_none_or(|_| sides[i].is_some()) && !self.chained(i)
            {
                conditions[i] = true;
            }
        }
        if conditions.iter().all(|c| *c) {
            // "If doors are powered a width of 850 mm is required": nothing else is left that the duty could be about.
            for i in 0..self.mentions.len() {
                let to = self.mentions[i].to;
                let comma = (to..self.tokens.len()).find(|&k| self.tokens[k].is(","));
                let duty = (to..self.tokens.len()).find(|&k| self.cue("duty", k));
                let since = (0..self.mentions[i].from).any(|k| self.cue("duty", k))
                    && sides[i].is_some_and(|s| !self.ends_noun(s.at));
                let own = sides[i].is_none_or(|s| s.strong) && duty.is_some_and(|d| comma.is_none_or(|c| d < c));
                conditions[i] = !(own || since) || self.condition_thing(i);
            }
        }
        let any_strong = sides.iter().flatten().any(|s| s.strong);
        (0..self.mentions.len())
            .map(|i| {
                let told = sides[i].is_some_and(|s| s.strong);
                let strange = sides[i].is_none() && self.is_compared(i);
                let skipped = conditions[i] || strange || !told && (unread || self.is_remark(i));
                if skipped { None } else { self.verdict(i, sides[i], &tone, any_strong) }
            })
            .collect()
    }

    /// Whether the sentence is in a language whose words of comparison are not known: there only one that is makes a rule.
    fn is_unread(&self) -> bool {
        let read = &self.lexicon.languages;
        if !self.lang.is_empty() && !read.iter().any(|l| l == self.lang) {
            return true;
        }
        let words = || self.tokens.iter().filter(|t| t.kind == Kind::Word);
        let strange = |t: &Token| t.text.chars().any(|c| self.lexicon.strange_letters.contains(c));
        words().any(strange)
    }

    /// Whether a figure stands in brackets behind another: "1:20 (5 cm a metre)".
    fn is_remark(&self, i: usize) -> bool {
        let Some(mention) = self.mentions.get(i) else { return false };
        let opened = (0..mention.from).rev().find(|&k| matches!(self.tokens[k].text.as_str(), "(" | ")" | "（" | "）"));
        let Some(at) = opened.filter(|&k| matches!(self.tokens[k].text.as_str(), "(" | "（")) else { return false };
        self.mentions.iter().any(|m| m.to <= at) && !(at..mention.from).any(|k| self.cue("duty", k))
    }

    /// Whether a figure is compared with in a word that is not known: "no skimpier than 2 m".
    fn is_compared(&self, i: usize) -> bool {
        self.mentions.get(i).and_then(|m| m.from.checked_sub(1)).is_some_and(|k| self.cue("than", k))
            || self.mentions.get(i).is_some_and(|m| self.cue("than_behind", m.to))
    }

    fn cue(&self, name: &str, i: usize) -> bool {
        self.lexicon.cues.get(name).is_at(self.tokens, i)
    }

    fn tone(&self) -> Tone {
        let any = |name: &str| self.lexicon.cues.get(name).any(self.tokens);
        Tone {
            duty: any("duty"),
            advice: any("advice"),
            habit: any("habit"),
            reckoned: any("reckoned"),
            report: self.tokens.iter().enumerate().any(|(k, _)| self.cue("report", k) && !self.in_noun(k)),
            former: any("former"),
            past: self.has_past_cue() || self.has_past_verb(),
            plain: any("plain") && !any("announces"),
        }
    }

    /// Whether a word of the past stands there, other than in "where beds are moved" and "wo Waren liegen".
    fn has_past_cue(&self) -> bool {
        let present = |k: usize| k.checked_sub(1).is_some_and(|before| self.cue("present_passive", before));
        let named = |t: &Token| t.capital && !t.new_line;
        let noun = |k: usize| k > 0 && self.lang == "de" && self.tokens.get(k).is_some_and(named);
        (0..self.tokens.len()).any(|k| self.cue("past", k) && !present(k) && !noun(k))
    }

    /// Whether a word in "-ed" governs a figure ("travelled 14 km") and is not passive.
    fn has_past_verb(&self) -> bool {
        self.lang == "en"
            && self.mentions.iter().any(|m| {
                let Some(verb) = m.from.checked_sub(1) else { return false };
                let passive = verb == 0 || (verb.saturating_sub(2)..verb).any(|k| self.cue("passive", k));
                let ed = self.tokens.get(verb).is_some_and(|t| t.kind == Kind::Word && t.text.ends_with("ed"));
                ed && !passive && !self.cue("past_exceptions", verb)
            })
    }

    /// Whether a token belongs to a longer name of a thing: "phone booth", "call button".
    fn in_noun(&self, at: usize) -> bool {
        (at.saturating_sub(2)..=at).any(|k| {
            let ends = [
                self.lexicon.thing.at(self.tokens, k).map(|e| e.0),
                self.lexicon.space.at(self.tokens, k).map(|e| e.0),
                self.lexicon.object.at(self.tokens, k).map(|e| e.0),
            ];
            ends.into_iter().flatten().any(|end| end > at && end > k + 1)
        })
    }

    /// Whether a report word is outweighed: duty, and a length or an area.
    fn is_physical(&self) -> bool {
        let dimension = |m: &Mention| m.unit.and_then(|u| self.lexicon.units.get(u)).map(|u| u.dimension.clone());
        self.lexicon.cues.get("duty").any(self.tokens)
            && self.mentions.iter().filter_map(dimension).any(|d| !matches!(d.as_str(), "share" | "time" | "mass"))
    }

    fn first_duty(&self) -> Option<usize> {
        (0..self.tokens.len()).find(|&k| self.cue("duty", k))
    }

    /// Returns the comparator of each figure: the nearest before it, one behind it, or that of the figure it goes with.
    fn sides(&self) -> Vec<Option<Sided>> {
        let mut sides: Vec<Option<Sided>> = Vec::new();
        let mut from = 0;
        for (i, mention) in self.mentions.iter().enumerate() {
            if self.is_place(mention) {
                sides.push(None);
                continue; // the comparator before it belongs to the next figure
            }
            let mut side = self.side_before(from, mention);
            from = mention.to;
            if side.is_none_or(|s| !s.strong) {
                let next = self.mentions.get(i + 1).map_or(self.tokens.len(), |m| m.from);
                if let Some((behind, end)) = self.side_behind(mention, next).filter(|b| b.0.strong || side.is_none()) {
                    side = Some(behind);
                    from = end;
                }
            }
            if side.is_none() && i > 0 && self.goes_with_previous(i) && !self.is_advised(mention) {
                side = sides.get(i - 1).copied().flatten();
            }
            sides.push(side);
        }
        sides
    }

    /// "between two beds" in a sentence about something else, "that two beds can pass".
    fn is_place(&self, mention: &Mention) -> bool {
        let before = mention.from.checked_sub(1);
        let counted = mention.thing.is_some() && matches!(mention.figure, Figure::Number(_)) && self.figures() > 1;
        counted && before.is_some_and(|k| self.cue("between_only", k) || self.cue("relatives", k))
    }

    fn side_before(&self, from: usize, mention: &Mention) -> Option<Sided> {
        let mut found: Option<Sided> = None;
        let mut k = from;
        while k < mention.from {
            let known = self.lexicon.before.at(self.tokens, k).filter(|c| c.0 <= mention.from);
            let part = || self.tokens.get(k).and_then(|t| self.lexicon.prefixes.part(t, false)).map(|c| (k + 1, c));
            let Some((end, index)) = known.or_else(part) else {
                k += 1;
                continue;
            };
            if let Some(comparator) = self.lexicon.comparators.get(index) {
                let near = !comparator.fixed || mention.from - end <= CLOSE_REACH;
                // "unter Treppen ist eine Durchgangshöhe von 2 m": the word says where
                let placed = !comparator.strong
                    && !self.is_negated(from, k)
                    && (end..mention.from)
                        .any(|j| self.lexicon.space.is_at(self.tokens, j) || self.lexicon.object.is_at(self.tokens, j));
                if placed {
                    k = end;
                    continue;
                }
                let before_thing = comparator.strong || mention.from - end <= OPENER_REACH + CLOSE_REACH;
                let article = self.tokens.get(k).is_some_and(|t| t.is("every")) && mention.unit.is_none();
                if near && before_thing && !article {
                    let negated = !comparator.fixed && !comparator.strong && self.is_negated(from, k);
                    let bound = if negated { opposite(comparator.bound) } else { comparator.bound };
                    let weak_after_strong = !comparator.strong && !negated && found.is_some_and(|f| f.strong);
                    if !weak_after_strong {
                        found = Some(Sided {
                            bound,
                            strong: comparator.strong || negated,
                            fixed: comparator.fixed,
                            at: k,
                            behind: false,
                        });
                    }
                }
            }
            k = end;
        }
        let forbidden = (mention.to..self.tokens.len()).any(|k| self.cue("forbidden", k));
        found.map(|s| if forbidden && !s.strong { Sided { bound: opposite(s.bound), strong: true, ..s } } else { s })
    }

    /// Whether a comparator is denied; "never below 19 °C or above 26 °C" denies both.
    fn is_negated(&self, from: usize, at: usize) -> bool {
        let from = if self.cue("or", from) { 0 } else { from };
        (from..at).any(|k| self.cue("negations", k))
    }

    /// Whether what a comparator says is denied behind it: "1.2m보다 좁아서는 안 된다".
    fn is_denied(&self, end: usize) -> bool {
        let rest = end..self.tokens.len().min(end + DENIAL_REACH);
        rest.take_while(|&k| !self.tokens[k].is(",")).any(|k| self.cue("denials", k))
    }

    fn side_behind(&self, mention: &Mention, next: usize) -> Option<(Sided, usize)> {
        for k in mention.to..next.min(mention.to + AFTER_REACH) {
            if let Some((end, index)) =
                self.lexicon.after.at(self.tokens, k).filter(|c| c.0 < next || next == self.tokens.len())
            {
                let comparator = self.lexicon.comparators.get(index)?;
                let negated = !comparator.strong
                    && (self.is_negated(mention.to.saturating_sub(OPENER_REACH), k) || self.is_denied(end));
                let bound = if negated { opposite(comparator.bound) } else { comparator.bound };
                return Some((
                    Sided { bound, strong: comparator.strong || negated, fixed: false, at: k, behind: true },
                    end,
                ));
            }
            let token = self.tokens.get(k)?;
            if token.is(",") && self.ends_with_bound(k + 1) {
                continue; // "36 inches wide, minimum."
            }
            if matches!(token.text.as_str(), "," | ";" | ":" | ")") || self.cue("and", k) || self.cue("duty", k) {
                return None;
            }
        }
        None
    }

    /// "24 in. preferred"
    fn is_advised(&self, mention: &Mention) -> bool {
        (mention.to..mention.to + ADVICE_REACH).any(|k| self.cue("advice", k))
    }

    /// Whether nothing but "minimum" or "or more" follows in the clause.
    fn ends_with_bound(&self, at: usize) -> bool {
        self.lexicon.after.at(self.tokens, at).is_some_and(|(end, index)| {
            self.lexicon.comparators.get(index).is_some_and(|c| c.strong)
                && self.tokens.get(end).is_none_or(|t| t.kind == Kind::Symbol)
        })
    }

    /// Whether a figure follows the one before by "and", "by" or a comma alone, without a verb between.
    fn goes_with_previous(&self, i: usize) -> bool {
        let (Some(a), Some(b)) = (i.checked_sub(1).and_then(|k| self.mentions.get(k)), self.mentions.get(i)) else {
            return false;
        };
        let between = a.to..b.from;
        a.unit.is_some() == b.unit.is_some()
            && between.len() <= OPENER_REACH + 2
            && between.clone().any(|k| self.cue("links", k))
            && !between.clone().any(|k| {
                self.cue("duty", k) || self.cue("plain", k) || self.cue("advice", k) || self.cue("hard_openers", k)
            })
    }

    /// Whether the figure after this one belongs to it (`2 m by 3 m`).
    fn chained(&self, i: usize) -> bool {
        self.mentions.get(i).is_some_and(|m| m.side.is_some())
    }

    /// Whether the token before is the end of a noun that is known.
    fn ends_noun(&self, at: usize) -> bool {
        (1..=3).any(|n| {
            at.checked_sub(n).is_some_and(|k| {
                let ends = |end: Option<usize>| end == Some(at);
                ends(self.lexicon.space.at(self.tokens, k).map(|e| e.0))
                    || ends(self.lexicon.thing.at(self.tokens, k).map(|e| e.0))
                    || ends(self.lexicon.object.at(self.tokens, k).map(|e| e.0))
            })
        })
    }

    /// Returns how many figures are no articles.
    fn figures(&self) -> usize {
        self.mentions.iter().filter(|m| !m.weak || matches!(m.figure, Figure::Per(..))).count()
    }

    /// Returns the token behind a figure and a comparator that follows it.
    fn side_end(&self, side: Option<Sided>, mention: &Mention) -> usize {
        let behind = side.filter(|s| s.behind && s.at >= mention.to);
        behind.and_then(|s| self.lexicon.after.at(self.tokens, s.at)).map_or(mention.to, |a| a.0)
    }

    fn condition_thing(&self, i: usize) -> bool {
        self.mentions.get(i).is_some_and(|m| {
            matches!(m.figure, Figure::Number(_) | Figure::Range(..))
                && m.thing.and_then(|t| self.lexicon.things.get(t)).is_some_and(|t| t.condition)
        })
    }

    fn is_condition(&self, i: usize, side: Option<Sided>) -> bool {
        let Some(mention) = self.mentions.get(i) else { return true };
        let permitted = side.is_some_and(|s| s.fixed && s.at == 0) && self.permits(mention);
        if self.condition_thing(i) && side.is_none_or(|s| !s.strong) && !permitted {
            return true;
        }
        if matches!(mention.figure, Figure::Per(..)) {
            return false;
        }
        let counted_later =
            || self.mentions.iter().skip(i + 1).enumerate().any(|(n, _)| !self.condition_thing(i + 1 + n));
        if self.condition_thing(i) && counted_later() && self.cue("condition_ends", self.side_end(side, mention)) {
            return true; // "100명 이상이 이용하는 실에는 출구를 2개소"
        }
        if mention.weak
            && side.is_none()
            && self.figures() > 0
            && !self.lexicon.cues.get("hard_openers").any(self.tokens)
        {
            return true; // "a single room needs 14 m²"
        }
        for k in (0..mention.from).rev() {
            let token = &self.tokens[k];
            if self.cue("idioms", k) || self.cue("duty", k) || matches!(token.text.as_str(), "," | ";" | ":") {
                break;
            }
            if self.cue("hard_openers", k) {
                // The opener's own figure stands between: "from 12 m up not lower than 1.10 m".
                let own = i.checked_sub(1).and_then(|p| self.mentions.get(p)).filter(|p| p.from > k);
                let linked = own.is_some_and(|p| (p.to..mention.from).any(|j| self.cue("links", j)));
                return !(own.is_some() && !linked && side.is_some_and(|s| s.strong && !s.behind));
            }
        }
        let preposition = |k: usize| self.cue("soft_openers", k) || self.cue("between_only", k);
        if self.is_place(mention) {
            return true;
        }
        let counted = mention.thing.is_some() && side.is_none() && self.figures() > 1;
        if counted && mention.from.checked_sub(1).is_some_and(preposition) {
            return true; // "between two beds"
        }
        let Some(side) = side.filter(|s| !s.strong && !s.behind) else { return false };
        let after_duty = side.fixed && self.first_duty().is_some_and(|d| d < side.at);
        if self.ends_noun(side.at) && !after_duty {
            return !self.follows_duty_alone(side.at, i);
        }
        (side.at.saturating_sub(OPENER_REACH)..side.at)
            .rev()
            .take_while(|&k| !self.cue("duty", k) && !self.cue("plain", k))
            .any(|k| self.cue("soft_openers", k))
            && (self.figures() > 1 || self.first_duty().is_some_and(|d| mention.to <= d) && !self.permits(mention))
    }

    /// "Provide storage rooms up to 10 m²": the only figure, after the duty.
    fn follows_duty_alone(&self, at: usize, i: usize) -> bool {
        let permitted = self.mentions.get(i).is_some_and(|m| self.permits(m));
        self.figures() == 1 && (self.first_duty().is_some_and(|d| d < at) || permitted)
    }

    /// Whether what the figure describes is then permitted.
    fn permits(&self, mention: &Mention) -> bool {
        (mention.to..self.tokens.len()).any(|k| self.cue("permission", k))
    }

    fn verdict(
        &self,
        i: usize,
        side: Option<Sided>,
        tone: &Tone,
        any_strong: bool,
    ) -> Option<(ConstraintType, Confidence)> {
        use Confidence::{High, Low, Medium};
        let mention = self.mentions.get(i)?;
        let to_type = |bound| if bound == Bound::Min { ConstraintType::Minimum } else { ConstraintType::Maximum };
        let form = self.is_form(mention);
        let generic = mention.unit.is_some()
            && !tone.past
            && !tone.report
            && *self.memo.generic.get_or_init(|| self.is_generic());
        let ruled = tone.duty || tone.advice || tone.habit || tone.reckoned || generic;
        let weight = Weight {
            form,
            generic,
            any_strong,
            normative: ruled || form && !tone.plain,
            reported: tone.plain && !ruled,
        };
        match &mention.figure {
            Figure::Range(..) if weight.normative || any_strong || self.is_span(mention) => {
                return Some((ConstraintType::Range, Medium));
            }
            Figure::Range(..) => return None,
            Figure::Per(..) if tone.habit => return Some((ConstraintType::RuleOfThumb, Low)),
            Figure::Per(..) if !weight.reported || side.is_some_and(|s| s.strong) => {
                return Some((ConstraintType::Ratio, Medium));
            }
            Figure::Per(..) => return None,
            _ => {}
        }
        if tone.reckoned && mention.basis.is_some() {
            return Some((ConstraintType::Ratio, Medium));
        }
        let article = mention.weak
            && self.tokens.get(mention.from).is_some_and(|t| self.lexicon.numbers.articles.contains(&t.text));
        if article && mention.unit.is_none() && mention.basis.is_none() && side.is_none_or(|s| !s.strong) {
            return None; // "ein Aufzug ist erforderlich" counts nothing
        }
        if let Some(side) = side {
            if side.strong || tone.duty || tone.advice || !tone.plain && form {
                return Some((to_type(side.bound), if side.strong { High } else { Medium }));
            }
            return None;
        }
        self.bare_verdict(i, tone, &weight)
    }

    /// Whether a range is said to be one: "comprise entre 13 et 17 cm".
    fn is_span(&self, mention: &Mention) -> bool {
        (mention.from.saturating_sub(SPAN_REACH)..mention.from).any(|k| self.cue("spans", k))
    }

    /// Returns the kind of a figure without a comparator.
    fn bare_verdict(&self, i: usize, tone: &Tone, weight: &Weight) -> Option<(ConstraintType, Confidence)> {
        use Confidence::{Low, Medium};
        let mention = self.mentions.get(i)?;
        let Weight { form, generic, any_strong, normative, reported } = *weight;
        if matches!(mention.figure, Figure::Ratio(_)) {
            return (normative || any_strong).then_some((ConstraintType::Ratio, Medium));
        }
        if mention.thing.is_some() && mention.basis.is_some() && !tone.duty && form {
            return Some((ConstraintType::Ratio, Low)); // "Bicycle parking: 2 spaces per dwelling"
        }
        if mention.thing.is_some() && mention.weak && !tone.duty && mention.basis.is_none() {
            return None;
        }
        let approximate = mention.from.checked_sub(1).is_some_and(|k| {
            self.cue("approximate", k) || self.tokens[k].is(".") && k > 0 && self.cue("approximate", k - 1)
        });
        if tone.habit || approximate && !tone.advice {
            return (tone.habit || tone.duty).then_some((ConstraintType::RuleOfThumb, Low));
        }
        let quantity = self.quantity(i);
        let should = *self.memo.soft_duty.get_or_init(|| self.lexicon.cues.get("soft_duty").any(self.tokens));
        if tone.advice || should {
            return Some((ConstraintType::Recommendation, Medium));
        }
        if tone.duty {
            let upper = quantity.is_some_and(|q| q.upper);
            return Some((if upper { ConstraintType::Maximum } else { ConstraintType::Minimum }, Medium));
        }
        if mention.thing.is_some() && !form {
            return None;
        }
        if generic {
            return Some((ConstraintType::Recommendation, Low));
        }
        (form && !reported || any_strong && mention.thing.is_none()).then_some((ConstraintType::Recommendation, Low))
    }

    /// Whether the sentence speaks of all things of a kind ("Worktops are fixed 85 to 90 cm above the floor"): its first
    /// noun is in the plural without an article, or one of "each" and "a" stands before it, and nothing dates it.
    fn is_generic(&self) -> bool {
        let year = |t: &Token| t.text.len() == 4 && t.number().is_some_and(|n| (1500.0..2100.0).contains(&n));
        if self.tokens.iter().any(year) || self.lexicon.cues.get("average").any(self.tokens) {
            return false;
        }
        let opener = self.lexicon.cues.get("generic_openers").at(self.tokens, 0).map_or(0, |c| c.0);
        let noun = |k: usize| {
            [self.lexicon.space.at(self.tokens, k), self.lexicon.object.at(self.tokens, k)]
                .into_iter()
                .flatten()
                .map(|n| n.0)
                .max()
        };
        let Some(end) = (opener..opener + MAX_ADJECTIVES_OF_SUBJECT).find_map(noun) else { return false };
        if (0..end).any(|k| self.cue("definite", k)) {
            return false;
        }
        let last = end.checked_sub(1).and_then(|k| self.tokens.get(k));
        opener > 0 || last.is_some_and(|t| t.text.ends_with('s') || t.text.ends_with("en"))
    }

    /// Whether the sentence is a note ("Corridors: 1.5 m", "Window area 10 %") up to this figure.
    fn is_form(&self, mention: &Mention) -> bool {
        let head = self.tokens.get(..mention.from).unwrap_or_default();
        let known_from = self.memo.known_from.get_or_init(|| {
            let known = |k: &usize| {
                self.lexicon.space.is_at(self.tokens, *k)
                    || self.lexicon.object.is_at(self.tokens, *k)
                    || self.lexicon.thing.is_at(self.tokens, *k)
                    || self.quantity_at(*k).is_some()
            };
            (0..self.tokens.len()).find(known).unwrap_or(usize::MAX)
        });
        let known = *known_from < mention.from;
        let words = self.tokens.iter().filter(|t| t.kind == Kind::Word).count();
        let colon =
            head.iter().any(|t| matches!(t.text.as_str(), ":" | "：" | "=" | "≥" | "≤" | ">=" | "<=" | "–" | "—"));
        let bound = self.side_before(0, mention).is_some_and(|s| s.strong);
        let counted = matches!(mention.figure, Figure::Per(..)) || mention.basis.is_some();
        let verbless = mention.unit.is_some()
            && words <= MAX_NOTE
            && !self.cue("definite", 0)
            && !self.memo.plain.get_or_init(|| self.lexicon.cues.get("plain").any(self.tokens));
        // "Docking bays: 1.0 m × 1.0 m": a short head that is not known, and right behind it a figure with its unit.
        let titled = self.mentions.first().is_some_and(|m| {
            m.unit.is_some() && (1..=MAX_TITLE + 1).contains(&m.from) && self.tokens[m.from - 1].is(":")
        });
        (known || bound) && (colon || bound || words <= MAX_SHORT_NOTE && !self.cue("definite", 0) || verbless)
            || titled
            || counted && words <= 12
    }
}

fn opposite(bound: Bound) -> Bound {
    if bound == Bound::Min { Bound::Max } else { Bound::Min }
}
