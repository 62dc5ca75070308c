//! Figures that are formulas: "1.8 * n + 2", "15 + 6n", "twice the width of the bed".
//!
//! What it is not for: evaluating them.

use super::mention::{Figure, Finder};
use super::token::{Kind, Token};

/// Longest name of what is multiplied, in words.
const MAX_FACTOR_WORDS: usize = 4;

impl Finder<'_> {
    /// Returns the end and text of the formula that begins at a token, its parts with blanks between.
    pub fn formula(&self, i: usize) -> Option<(usize, Figure)> {
        let (to, expr) = self.polynomial(i).or_else(|| self.multiple(i))?;
        Some((to, Figure::Formula(expr)))
    }

    /// Reads `a * n + b`, `b + a * n`, `n * a + b`, each with or without its second half.
    fn polynomial(&self, i: usize) -> Option<(usize, String)> {
        let (mut to, mut expr, mut has_variable) = self.term(i)?;
        if let Some(sign) = self.tokens.get(to).filter(|t| matches!(t.text.as_str(), "+" | "-" | "−"))
            && let Some((end, term, variable)) = self.term(to + 1)
        {
            let sign = if sign.is("+") { "+" } else { "-" };
            expr = format!("{expr} {sign} {term}");
            to = end;
            has_variable |= variable;
        }
        (has_variable && expr.contains(' ')).then_some((to, expr))
    }

    /// Reads `a`, `a * n`, `a n`, `n * a`: the end, the text and whether a variable stands in it.
    fn term(&self, i: usize) -> Option<(usize, String, bool)> {
        let variable = |k: usize| {
            let token = self.tokens.get(k)?;
            let known = self.lexicon.cues.get("variables").is_at(self.tokens, k);
            (known && token.kind == Kind::Word).then(|| token.text.clone())
        };
        let times = |k: usize| self.tokens.get(k).is_some_and(is_times);
        let number = |k: usize| self.tokens.get(k).and_then(Token::number);
        if let Some(a) = number(i) {
            return Some(match (times(i + 1), variable(i + 2), variable(i + 1)) {
                (true, Some(n), _) => (i + 3, format!("{a} * {n}"), true),
                (_, _, Some(n)) => (i + 2, format!("{a} * {n}"), self.is_sum(i + 2)),
                _ => (i + 1, format!("{a}"), false),
            });
        }
        let (n, a) = (variable(i).filter(|_| times(i + 1))?, number(i + 2)?);
        Some((i + 3, format!("{a} * {n}"), true))
    }

    /// Whether a sign of a sum stands at a token or before the figure: "6 n" alone are newtons.
    fn is_sum(&self, at: usize) -> bool {
        let sign = |k: usize| self.tokens.get(k).is_some_and(|t| matches!(t.text.as_str(), "+" | "-" | "−"));
        sign(at) || at.checked_sub(3).is_some_and(sign)
    }

    /// Reads "twice the width of the bed", "1.5 times the vehicle width".
    fn multiple(&self, i: usize) -> Option<(usize, String)> {
        let cue = |name: &str, k: usize| self.lexicon.cues.get(name).at(self.tokens, k).map(|c| c.0);
        let (factor, start) = match self.lexicon.multiples.at(self.tokens, i) {
            Some((end, factor)) => (factor, end),
            None => (self.tokens.get(i)?.number()?, cue("times", i + 1)?),
        };
        let mut words = Vec::new();
        let mut k = start;
        while let Some(token) = self.tokens.get(k).filter(|t| t.kind == Kind::Word && words.len() < MAX_FACTOR_WORDS) {
            let glue = cue("stops", k).is_some();
            if glue && !(cue("determiners", k).is_some() || token.is("of")) {
                break;
            }
            if !glue {
                words.push(token.text.as_str());
            }
            k += 1;
        }
        (!words.is_empty()).then(|| (k, format!("{factor} * {}", words.join("_"))))
    }
}

fn is_times(token: &Token) -> bool {
    matches!(token.text.as_str(), "*" | "×" | "·" | "x")
}
