//! How large a prompt says that its robots are: "0.6 m wide and 0.8 m long", "Breite 60 cm", "0.6 x 0.8 x 1.2 m".
//!
//! What is said means what the flags of the same names mean. A measure is a robot's where nothing else that is measured
//! stands between: in "a delivery robot and corridors 2 m wide" the corridors are as wide as that.

use d3dgen_model::robot_body::RobotBody;

use super::robots::Robots;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end, words};

/// Words between a number with its unit and the word before it that says what is measured, at most: "width of about 0.6 m".
const MOST_AHEAD: usize = 3;
/// The same for a word behind it: "60 cm de large".
const MOST_BEHIND: usize = 2;
/// The same for what a robot drives over: "climbs thresholds of up to 2 cm".
const MOST_CLIMB: usize = 5;
/// Words between a robot and its measures, at most.
const MOST_BETWEEN: usize = 40;
/// Words between measures and the robot behind them, at most: "a 60 cm wide and 80 cm long delivery robot".
const MOST_BEFORE: usize = 14;
/// The same without another measure between: "a 60 cm wide autonomous robot".
const NEXT: usize = 2;

/// What of a robot is measured, by the tags of its words.
const MEASURES: [(Tag, Measure); 7] = [
    (Tag::TurningRadius, Measure::TurningRadius),
    (Tag::Radius, Measure::Radius),
    (Tag::Diameter, Measure::Diameter),
    (Tag::Width, Measure::Width),
    (Tag::Length, Measure::Length),
    (Tag::Height, Measure::Height),
    (Tag::Climb, Measure::Climb),
];

/// What of a robot is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Measure {
    Width,
    Length,
    Height,
    Radius,
    Diameter,
    TurningRadius,
    Climb,
}

/// One measure of robots.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Said {
    /// The words for the robots that it is said of.
    robot: Span,
    measure: Measure,
    value_m: f64,
}

/// Measures of the robots of a prompt.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Sizes {
    said: Vec<Said>,
    /// Their words.
    pub spans: Vec<Span>,
}

impl Sizes {
    /// Returns the body that the prompt gives robots of a kind, and the radius of a round one, m. What is said of one kind
    /// says nothing of another; what is said of robots without a kind is said of all.
    pub(crate) fn of(&self, kind: &str, wanted: &[&str], robots: &Robots) -> (RobotBody, Option<f64>) {
        let meant = |said: &&Said| match robots.kind_at(said.robot) {
            Some(own) => own == kind || !wanted.contains(&own),
            None => true,
        };
        let (mut body, mut radius) = (RobotBody::default(), None);
        for Said { measure, value_m, .. } in self.said.iter().filter(meant) {
            let place = match measure {
                Measure::Width => &mut body.width_m,
                Measure::Length => &mut body.length_m,
                Measure::Height => &mut body.height_m,
                Measure::TurningRadius => &mut body.turning_radius_m,
                Measure::Climb => &mut body.climb_m,
                Measure::Radius | Measure::Diameter => &mut radius,
            };
            let share = if *measure == Measure::Diameter { 0.5 } else { 1.0 };
            place.get_or_insert(value_m * share);
        }
        (body, radius)
    }

    /// Finds the measures of robots; `other` says where a word for something else that has measures begins.
    pub(crate) fn read(
        tokens: &[Token],
        numbers: &[Number],
        spoken: &[&Spoken],
        robots: &Robots,
        other: impl Fn(usize) -> bool,
    ) -> Self {
        let mut out = Self::default();
        if robots.spans.is_empty() {
            return out;
        }
        let reader = Reader { tokens, numbers, spoken, robots: &robots.spans, words: size_words(tokens, spoken) };
        let mut used = vec![false; reader.words.len()];
        let mut k = 0;
        while k < numbers.len() {
            if let Some((sides, span)) = reader.product(k) {
                k += sides.len();
                if let Some(robot) = reader.owner(span, &other) {
                    let measures = [Measure::Width, Measure::Length, Measure::Height];
                    let say = |(measure, value_m): (Measure, f64)| Said { robot, measure, value_m };
                    out.said.extend(measures.into_iter().zip(sides).map(say));
                    out.spans.push(span);
                }
                continue;
            }
            let number = &numbers[k];
            k += 1;
            let Some((end, unit)) = reader.unit(number) else { continue };
            let Some(word) = reader.word_of(number.span.start, end, &used) else { continue };
            used[word] = true;
            let (said, measure) = reader.words[word];
            let span = Span { start: number.span.start.min(said.start), end: end.max(said.end) };
            if let Some(robot) = reader.owner(span, &other) {
                out.said.push(Said { robot, measure, value_m: number.value * unit });
                out.spans.push(span);
            }
        }
        out
    }
}

/// Returns the words that say what is measured, the longest where several begin.
fn size_words(tokens: &[Token], spoken: &[&Spoken]) -> Vec<(Span, Measure)> {
    let mut out = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let ends = MEASURES.iter().filter_map(|(tag, measure)| Some((tag_end(spoken, tokens, i, *tag)?, *measure)));
        match ends.max_by_key(|(end, _)| *end) {
            Some((end, measure)) => {
                out.push((Span { start: i, end }, measure));
                i = end.max(i + 1);
            }
            None => i += 1,
        }
    }
    out
}

/// What stands before a measure.
enum Before {
    Robot(Span),
    /// Something else that has measures.
    Other,
    Nothing,
}

/// What a prompt has to say of sizes.
struct Reader<'a> {
    tokens: &'a [Token],
    numbers: &'a [Number],
    spoken: &'a [&'a Spoken],
    /// Words for robots.
    robots: &'a [Span],
    /// Words that say what is measured.
    words: Vec<(Span, Measure)>,
}

impl Reader<'_> {
    fn tagged(&self, i: usize, tag: Tag) -> bool {
        is_tagged(self.spoken, self.tokens, i, tag)
    }

    /// Returns the words for robots that a token is of.
    fn robot_at(&self, i: usize) -> Option<Span> {
        self.robots.iter().find(|r| r.contains(i)).copied()
    }

    fn is_number(&self, i: usize) -> bool {
        self.numbers.iter().any(|n| !n.article && n.span.contains(i))
    }

    /// Returns the end of the unit behind a length more than nothing, and how many meters it is.
    fn unit(&self, number: &Number) -> Option<(usize, f64)> {
        let at = number.span.end;
        let (end, factor) = words().length_units.longest_at(self.tokens, at)?;
        // "two in the north": there the unit is a little word
        let measured = self.words.iter().any(|(span, _)| span.start == end);
        let little = self.tokens[at].text == "in" && !measured && self.tokens.get(end).is_some_and(|t| !t.is_mark());
        (number.value > 0.0 && !number.article && !number.vague && !little).then_some((end, *factor))
    }

    /// Returns the lengths that stand with an x between them from a number on, in meters, width before length, and their
    /// words: "0.6 x 0.8 m", "0.6 m by 0.8 m by 1.2 m".
    fn product(&self, first: usize) -> Option<(Vec<f64>, Span)> {
        let mut sides: Vec<(f64, Option<f64>)> = Vec::new();
        let mut end = self.numbers.get(first)?.span.start;
        for number in self.numbers[first..].iter().take(3) {
            let joined = end..number.span.start;
            let times = |i: usize| words().times.contains(&self.tokens[i].text);
            if !sides.is_empty() && (joined.is_empty() || !joined.clone().all(times)) {
                break;
            }
            let unit = self.unit(number);
            end = unit.map_or(number.span.end, |u| u.0);
            sides.push((number.value, unit.map(|u| u.1)));
        }
        // the unit of the last is that of all
        let last = sides.last()?.1?;
        let mut out: Vec<f64> = sides.iter().map(|(value, unit)| value * unit.unwrap_or(last)).collect();
        if out.len() < 2 || out.iter().any(|v| *v <= 0.0) {
            return None;
        }
        out[..2].sort_by(f64::total_cmp);
        Some((out, Span { start: self.numbers[first].span.start, end }))
    }

    /// Returns the word that says what a length from `start` to `end` is: the one before it, unless that has said so of
    /// another length, or the one behind it.
    fn word_of(&self, start: usize, end: usize, used: &[bool]) -> Option<usize> {
        let free = |(k, _): &(usize, &(Span, Measure))| !used[*k];
        let all = || self.words.iter().enumerate().filter(free);
        let most = |measure: Measure, usual: usize| if measure == Measure::Climb { MOST_CLIMB } else { usual };
        let plain = |i: usize| self.robot_at(i).is_none() && !self.is_number(i);
        let ahead = all().rfind(|(_, (span, _))| span.end <= start).filter(|(_, (span, measure))| {
            let mark = |i: usize| self.tokens[i].is_mark() && self.tokens[i].mark() != Some(':');
            start - span.end <= most(*measure, MOST_AHEAD) && (span.end..start).all(|i| plain(i) && !mark(i))
        });
        let behind = all().find(|(_, (span, _))| span.start >= end).filter(|(_, (span, measure))| {
            let between = end..span.start;
            between.len() <= most(*measure, MOST_BEHIND)
                && between.clone().all(|i| plain(i) && !self.tokens[i].is_mark() && !self.tagged(i, Tag::Joins))
        });
        ahead.or(behind).map(|(k, _)| k)
    }

    /// Returns the robots that measures are said of: those right behind them, those before them, or those further behind.
    fn owner(&self, span: Span, other: &impl Fn(usize) -> bool) -> Option<Span> {
        let close = |i: usize| self.tokens[i].is_mark() || self.tagged(i, Tag::Joins) || self.tagged(i, Tag::Articles);
        let next = (span.end..self.tokens.len()).take(NEXT + 1).take_while(|i| !close(*i) && !other(*i));
        let next = next.take_while(|i| !self.parts(*i) && !self.is_number(*i)).find_map(|i| self.robot_at(i));
        // "with a 60 cm wide ...": what has the measure is still to come
        let article = span.start.checked_sub(1).is_some_and(|i| self.tagged(i, Tag::Articles));
        let to_come = article && self.is_number(span.start);
        let behind = || self.owner_behind(span.end, other);
        next.or_else(|| match self.owner_before(span.start, other) {
            Before::Robot(robot) if to_come => behind().or(Some(robot)),
            Before::Robot(robot) => Some(robot),
            Before::Other if !to_come => None,
            Before::Other | Before::Nothing => behind(),
        })
    }

    /// Returns true for a word that what stands before it does not go beyond: "for", "with"; in Chinese and Korean such
    /// words stand behind what they are of.
    fn parts(&self, i: usize) -> bool {
        let eastern = matches!(self.tokens[i].kind, Kind::Han | Kind::Hangul);
        !eastern && self.tagged(i, Tag::Stops) && !self.tagged(i, Tag::Joins)
    }

    fn owner_before(&self, start: usize, other: &impl Fn(usize) -> bool) -> Before {
        let mut comma = false;
        for i in (start.saturating_sub(MOST_BETWEEN)..start).rev() {
            if let Some(robot) = self.robot_at(i) {
                return Before::Robot(robot);
            }
            // "For a delivery robot. It is 0.6 m wide."
            let goes_on = || [Tag::It, Tag::Them].iter().any(|tag| self.tagged(i + 1, *tag));
            if self.tokens[i].ends_sentence() && !goes_on() {
                break;
            }
            comma |= self.tokens[i].is_mark();
            // what stands right before a measure has it; a comma leads back to the robot
            if !comma && other(i) {
                return Before::Other;
            }
        }
        Before::Nothing
    }

    fn owner_behind(&self, end: usize, other: &impl Fn(usize) -> bool) -> Option<Span> {
        for i in end..(end + MOST_BEFORE).min(self.tokens.len()) {
            if let Some(robot) = self.robot_at(i) {
                return Some(robot);
            }
            if self.tokens[i].ends_sentence() || self.parts(i) || other(i) {
                return None;
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::super::robots::find;
    use super::*;
    use crate::tokens::numbers::numbers;
    use crate::tokens::text::tokens;

    /// Returns width, length, height, turning radius, climb and radius of the first robot, in whole centimeters.
    fn read(language: &'static str, text: &str) -> [Option<i64>; 6] {
        let tokens = tokens(text);
        let spoken: Vec<&Spoken> = [language, "en"].iter().map(|l| &words().languages[*l]).collect();
        let numbers = numbers(&tokens, language, &spoken);
        let robots = find(&tokens, &spoken, language);
        let other = |i: usize| {
            is_tagged(&spoken, &tokens, i, Tag::MeasuredParts)
                || ["corridor", "corridors", "kitchen"].contains(&tokens[i].text.as_str())
        };
        let sizes = Sizes::read(&tokens, &numbers, &spoken, &robots, other);
        let kind = robots.spans.first().and_then(|s| robots.kind_at(*s)).unwrap_or("service");
        let (body, radius) = sizes.of(kind, &[kind], &robots);
        let all = [body.width_m, body.length_m, body.height_m, body.turning_radius_m, body.climb_m, radius];
        all.map(|v| v.map(|v| (v * 100.0).round() as i64))
    }

    #[test]
    fn sizes_are_read_in_six_languages() {
        let (w, l, h) = (Some(60), Some(80), Some(120));
        for (language, text) in [
            ("en", "ward for a delivery robot 0.6 m wide, 0.8 m long and 1.2 m high"),
            ("en", "ward for a delivery robot with a width of 60 cm, a length of 80 cm and a height of 120 cm"),
            ("en", "ward for a 60 cm wide, 80 cm long and 1.2 m tall delivery robot"),
            ("en", "flat with kitchen with a 60 cm wide, 80 cm long and 1.2 m high delivery robot"),
            ("en", "ward; delivery robot (width: 0.6 m, length: 0.8 m, height: 1.2 m)"),
            ("en", "ward for a delivery robot of 0.8 x 0.6 x 1.2 m"),
            ("en", "ward for a delivery robot. It is 0.6 m wide, 0.8 m long and 1.2 m high."),
            ("de", "Station für einen Lieferroboter, 0,6 m breit, 0,8 m lang und 1,2 m hoch"),
            ("de", "Station für einen Lieferroboter mit 60 cm Breite, 80 cm Länge und 120 cm Höhe"),
            ("de", "Station für einen 60 cm breiten, 80 cm langen und 1,2 m hohen Lieferroboter"),
            ("fr", "service pour un robot de livraison de 0,6 m de large, 0,8 m de long et 1,2 m de haut"),
            ("fr", "robot de livraison, largeur 60 cm, longueur 80 cm, hauteur 1,2 m"),
            ("es", "planta para un robot de reparto de 60 cm de ancho, 80 cm de largo y 1,2 m de alto"),
            ("es", "robot de reparto con una anchura de 60 cm, una longitud de 80 cm y una altura de 1,2 m"),
            ("zh", "病房,配送机器人宽0.6米、长0.8米、高1.2米"),
            ("zh", "病房,一台宽60厘米、长80厘米、高1.2米的配送机器人"),
            ("ko", "병동, 배달 로봇 폭 0.6m, 길이 0.8m, 높이 1.2m"),
            ("ko", "폭 0.6m 길이 0.8m 높이 1.2m인 배달 로봇이 있는 병동"),
        ] {
            assert_eq!(read(language, text)[..3], [w, l, h], "{text}");
        }
    }

    #[test]
    fn circles_and_steps_of_robots_are_read() {
        for (language, text, expected) in [
            ("en", "robot of 0.4 m radius", [None, None, Some(40)]),
            ("en", "a robot with a radius of 35 cm", [None, None, Some(35)]),
            ("en", "a robot 0.7 m in diameter", [None, None, Some(35)]),
            ("en", "a robot with a turning radius of 0.7 m", [Some(70), None, None]),
            ("en", "a robot that climbs thresholds of up to 2 cm", [None, Some(2), None]),
            ("de", "ein Roboter mit einem Wenderadius von 70 cm", [Some(70), None, None]),
            ("fr", "un robot avec un rayon de braquage de 0,7 m", [Some(70), None, None]),
            ("es", "un robot con un radio de giro de 0,7 m", [Some(70), None, None]),
            ("zh", "机器人转弯半径0.7米", [Some(70), None, None]),
            ("ko", "회전 반경 0.7m 로봇", [Some(70), None, None]),
        ] {
            assert_eq!(read(language, text)[3..], expected, "{text}");
        }
    }

    #[test]
    fn what_is_measured_beside_robots_is_none_of_them() {
        for text in [
            "corridor 2 m wide",
            "a delivery robot and corridors 2 m wide",
            "corridors 2 m wide for a delivery robot",
            "a delivery robot, doors at least 1 m wide",
            "ceilings 3 m high, a delivery robot",
            "a cleaning robot for the kitchen 4 m long",
            "kitchen 4 m long, a delivery robot",
        ] {
            assert_eq!(read("en", text), [None; 6], "{text}");
        }
        let two = "a cleaning robot 0.4 m wide and a delivery robot 0.6 m wide";
        assert_eq!(read("en", two)[0], Some(40));
    }

    #[test]
    fn what_a_sentence_says_means_what_the_flags_mean() {
        use d3dgen_plugins::Registry;

        use crate::generate;
        use crate::request::Request;

        let flags = RobotBody { width_m: Some(0.6), length_m: Some(0.8), ..RobotBody::default() };
        for (bare, told) in [
            (
                "hospital ward with 8 rooms for a delivery robot",
                "hospital ward with 8 rooms for a delivery robot 0.6 m wide and 0.8 m long",
            ),
            (
                "Krankenstation mit 8 Zimmern für einen Lieferroboter",
                "Krankenstation mit 8 Zimmern für einen 60 cm breiten und 80 cm langen Lieferroboter",
            ),
            (
                "bureau de 8 pièces pour un robot de livraison",
                "bureau de 8 pièces pour un robot de livraison de 60 cm de large et 80 cm de long",
            ),
            (
                "oficina de 8 salas para un robot de reparto",
                "oficina de 8 salas para un robot de reparto de 60 cm de ancho y 80 cm de largo",
            ),
            ("8间办公室,一台配送机器人", "8间办公室,一台配送机器人,宽0.6米,长0.8米"),
            ("사무실 8개, 배달 로봇 1대", "사무실 8개, 배달 로봇 1대, 폭 0.6m, 길이 0.8m"),
        ] {
            let robots = |prompt: &str, robot: RobotBody| {
                let request = Request { prompt: prompt.into(), robot, ..Request::default() };
                let graph = generate(&request, &Registry::builtin()).expect("a plain prompt");
                let unread: Vec<_> = graph.conflicts.iter().filter(|c| c.code == "unread_wish").cloned().collect();
                (graph.robots, graph.rooms.len(), unread)
            };
            let (said, meant) = (robots(told, RobotBody::default()), robots(bare, flags));
            assert_eq!(said, meant, "{told}");
            assert_eq!(said.0[0].radius_m, 0.5, "half the diagonal: {told}");
        }
    }
}
