//! Areas in prompts.

use super::numbers::Number;
use super::text::{Span, Token};
use super::words::words;

/// A floor area in the prompt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Area {
    pub span: Span,
    /// m^2.
    pub value: f64,
    /// True for two lengths, of which only the product is kept.
    pub sides: bool,
}

/// Returns all areas: a number and a unit, or two lengths ("4 x 5 m").
pub(crate) fn areas(tokens: &[Token], numbers: &[Number]) -> Vec<Area> {
    let mut out = Vec::new();
    for (k, number) in numbers.iter().enumerate() {
        if number.value <= 0.0 {
            continue;
        }
        if let Some((end, factor)) = words().area_units.longest_at(tokens, number.span.end) {
            let span = Span { start: number.span.start, end };
            out.push(Area { span, value: number.value * factor, sides: false });
            continue;
        }
        // "4 x 5 m"
        if let Some(next) = numbers.get(k + 1)
            && next.value > 0.0
            && let Some((end, unit)) = words().length_units.longest_at(tokens, next.span.end)
        {
            let between = number.span.end..next.span.start;
            let times = |i: usize| words().times.contains(&tokens[i].text);
            let measures = |i: usize| times(i) || words().length_units.longest_at(tokens, i).is_some();
            if between.clone().any(times) && between.clone().all(measures) {
                out.push(Area {
                    span: Span { start: number.span.start, end },
                    value: number.value * next.value * unit * unit,
                    sides: true,
                });
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::numbers::numbers;
    use super::super::text::tokens;
    use super::super::words::Spoken;
    use super::*;

    fn spoken() -> Vec<&'static Spoken> {
        words().languages.values().collect()
    }

    #[test]
    fn reads_areas_in_many_units() {
        for (text, value) in [
            ("about 25 m2", 25.0),
            ("etwa 75 qm", 75.0),
            ("75 m²", 75.0),
            ("90㎡的住宅", 90.0),
            ("1,500 sq ft", 139.354_56),
            ("roughly 350 square metres", 350.0),
            ("100平方米", 100.0),
            ("30평 아파트", 99.173_55),
            ("30坪", 99.173_55),
            ("80 metros cuadrados", 80.0),
            ("4 x 5 m", 20.0),
            ("120m2", 120.0),
            ("12 m by 8 m", 96.0),
            ("4×5 m", 20.0),
        ] {
            let tokens = tokens(text);
            let found = areas(&tokens, &numbers(&tokens, "en", &spoken()));
            assert_eq!(found.len(), 1, "{text}");
            assert!((found[0].value - value).abs() < 1e-3, "{text}: {}", found[0].value);
        }
    }
}
