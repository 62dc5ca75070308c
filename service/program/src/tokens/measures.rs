//! Areas and robot sizes in prompts.

use super::numbers::Number;
use super::text::{Span, Token};
use super::words::{Spoken, Tag, is_tagged, words};

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

/// Returns the robot radius in m: "0.4 m radius", "radius of 40 cm", "60 cm wide".
pub(crate) fn robot_radius(tokens: &[Token], numbers: &[Number], spoken: &[&Spoken]) -> Option<(Span, f64)> {
    robot_measure(tokens, numbers, spoken, &[(Tag::Radius, 1.0), (Tag::Diameter, 0.5)])
}

/// Returns how long a robot is, m: "0.9 m long".
pub(crate) fn robot_length(tokens: &[Token], numbers: &[Number], spoken: &[&Spoken]) -> Option<(Span, f64)> {
    robot_measure(tokens, numbers, spoken, &[(Tag::Length, 1.0)])
}

/// Returns the length beside one of these words in a sentence about a robot, times the factor of the word, with the word
/// where that stands right behind it.
fn robot_measure(tokens: &[Token], numbers: &[Number], spoken: &[&Spoken], tags: &[(Tag, f64)]) -> Option<(Span, f64)> {
    for number in numbers {
        let Some((end, unit)) = words().length_units.longest_at(tokens, number.span.end) else { continue };
        let length = number.value * unit;
        if length <= 0.0 {
            continue;
        }
        let has = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
        // the next length has its own word
        let other = |i: &usize| numbers.iter().any(|n| n.span.contains(*i));
        let word = |i: usize| tags.iter().find(|t| has(i, t.0)).map(|t| (i, t.1));
        let behind = (end..(end + 3).min(tokens.len())).take_while(|i| !other(i)).find_map(word);
        let measured = [Tag::Radius, Tag::Diameter, Tag::Length].iter().any(|&t| end < tokens.len() && has(end, t));
        let ahead = || {
            let before = (number.span.start.saturating_sub(3)..number.span.start).rev();
            before.take_while(|i| !other(i)).find_map(word).filter(|_| !measured)
        };
        let near = behind.or_else(ahead);
        // "corridor 2 m wide" is no robot: one must be named in the same sentence
        let sentence = |i: &usize| !tokens[*i].ends_sentence();
        let named = |i: usize| {
            let tags = [Tag::Robot, Tag::Clean, Tag::Deliver, Tag::Serve, Tag::Transport];
            spoken.iter().any(|s| tags.iter().any(|&tag| s.tag_at(tokens, i, tag).is_some()))
        };
        let before = (0..number.span.start).rev().take_while(sentence).take(14).any(named);
        let after = (end..tokens.len()).take_while(sentence).take(8).any(named);
        if let Some((word, share)) = near
            && (before || after)
        {
            let end = if word == end { end + 1 } else { end };
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
            ("robot 0.9 m long and 0.7 m wide", Some(0.35)),
            ("corridor 2 m wide", None),
        ] {
            let tokens = tokens(text);
            let found = robot_radius(&tokens, &numbers(&tokens, "en", &spoken()), &spoken());
            assert_eq!(found.map(|f| (f.1 * 1000.0).round() / 1000.0), value, "{text}");
        }
    }
}
