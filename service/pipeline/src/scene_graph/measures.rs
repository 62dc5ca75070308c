//! Areas and robot sizes in prompts.

use super::numbers::Number;
use super::text::{Span, Token};
use super::words::{Spoken, Tag, words};

/// A floor area in the prompt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub span: Span,
    /// m^2.
    pub value: f64,
    /// True for two lengths, of which only the product is kept.
    pub sides: bool,
}

/// Returns all areas: a number and a unit, or two lengths ("4 x 5 m").
pub(super) fn areas(tokens: &[Token], numbers: &[Number]) -> Vec<Area> {
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
            let between = &tokens[number.span.end..next.span.start];
            let times = between.iter().any(|t| matches!(t.text.as_str(), "x" | "by" | "mal" | "sur" | "por"))
                && between.iter().all(|t| {
                    matches!(
                        t.text.as_str(),
                        "x" | "by" | "mal" | "sur" | "por" | "m" | "meters" | "metres" | "ft" | "feet"
                    )
                });
            if times {
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

/// Returns the robot radius in m: "0.4 m radius", "radius of 40 cm", "60 cm wide".
pub(super) fn robot_radius(tokens: &[Token], numbers: &[Number], spoken: &[&Spoken]) -> Option<(Span, f64)> {
    for number in numbers {
        let Some((end, unit)) = words().length_units.longest_at(tokens, number.span.end) else { continue };
        let length = number.value * unit;
        if length <= 0.0 {
            continue;
        }
        let near = (number.span.start.saturating_sub(3)..(end + 3).min(tokens.len()))
            .filter(|&i| i < number.span.start || i >= end)
            .find_map(|i| {
                let has = |tag| spoken.iter().any(|s| s.tag_at(tokens, i, tag).is_some());
                if has(Tag::Radius) {
                    Some(1.0)
                } else if has(Tag::Diameter) {
                    Some(0.5)
                } else {
                    None
                }
            });
        // "corridor 2 m wide" is no robot: one must be named in the same sentence
        let sentence = |i: &usize| !tokens[*i].ends_sentence();
        let named = |i: usize| {
            let tags = [Tag::Robot, Tag::Clean, Tag::Deliver, Tag::Serve, Tag::Transport];
            spoken.iter().any(|s| tags.iter().any(|&tag| s.tag_at(tokens, i, tag).is_some()))
        };
        let before = (0..number.span.start).rev().take_while(sentence).take(14).any(named);
        let after = (end..tokens.len()).take_while(sentence).take(8).any(named);
        if let Some(share) = near
            && (before || after)
        {
            return Some((Span { start: number.span.start, end }, length * share));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::numbers::numbers;
    use super::super::text::tokens;
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

    #[test]
    fn reads_robot_radii() {
        for (text, value) in [
            ("delivery robot of 0.4 m radius", Some(0.4)),
            ("a robot with a radius of 35 cm", Some(0.35)),
            ("robot 60 cm wide", Some(0.3)),
            ("corridor 2 m wide", None),
        ] {
            let tokens = tokens(text);
            let found = robot_radius(&tokens, &numbers(&tokens, "en", &spoken()), &spoken());
            assert_eq!(found.map(|f| (f.1 * 1000.0).round() / 1000.0), value, "{text}");
        }
    }
}
