//! Formulas of constraints (`1.8 * n + 2`) and of builds (`min(0.48, h*0.55)`): the four operations, powers, brackets,
//! comparisons (1 when they hold, 0 when not), a few functions and named figures.
//!
//! Functions: `sqrt abs floor ceil round` of one figure, `sin cos` of degrees, `mod` of two, `min max` of any number,
//! `clamp(value, low, high)` and `if(condition, then, else)` with a condition above 0.

/// Deepest nesting that is read: formulas of building rules have one or two levels, those of builds a few.
const DEEPEST: u8 = 16;

/// Returns the value of a formula; `None` when it is no formula, a name has no figure or the value is not finite.
pub fn evaluate(text: &str, figure: &dyn Fn(&str) -> Option<f64>) -> Option<f64> {
    read(text, figure).filter(|v| v.is_finite())
}

/// Says what is wrong with a formula, whatever its figures are.
///
/// # Errors
/// What is wrong, as text: a name that is not `known`, or that it is no formula.
pub fn check(text: &str, known: &dyn Fn(&str) -> bool) -> Result<(), String> {
    let unknown = std::cell::RefCell::new(None);
    let figure = |name: &str| {
        if !name.is_empty() && !known(name) {
            unknown.borrow_mut().get_or_insert_with(|| name.to_owned());
        }
        (!name.is_empty()).then_some(1.234_567)
    };
    let read = read(text, &figure);
    match (unknown.into_inner(), read) {
        (Some(name), _) => Err(format!("`{text}` names `{name}`, which is not known here")),
        (None, None) => Err(format!("`{text}` is no formula")),
        (None, Some(_)) => Ok(()),
    }
}

fn read(text: &str, figure: &dyn Fn(&str) -> Option<f64>) -> Option<f64> {
    let mut reader = Reader { rest: text.trim(), figure, depth: 0 };
    let value = reader.comparison()?;
    reader.rest.is_empty().then_some(value)
}

struct Reader<'a> {
    rest: &'a str,
    figure: &'a dyn Fn(&str) -> Option<f64>,
    depth: u8,
}

impl<'a> Reader<'a> {
    fn take(&mut self, sign: &str) -> bool {
        match self.rest.strip_prefix(sign) {
            Some(rest) => {
                self.rest = rest.trim_start();
                true
            }
            None => false,
        }
    }

    fn comparison(&mut self) -> Option<f64> {
        let left = self.sum()?;
        let holds: fn(f64, f64) -> bool = if self.take("<=") {
            |a, b| a <= b
        } else if self.take(">=") {
            |a, b| a >= b
        } else if self.take("==") {
            |a, b| a == b
        } else if self.take("<") {
            |a, b| a < b
        } else if self.take(">") {
            |a, b| a > b
        } else {
            return Some(left);
        };
        let right = self.sum()?;
        Some(f64::from(u8::from(holds(left, right))))
    }

    fn sum(&mut self) -> Option<f64> {
        let mut value = self.product()?;
        loop {
            if self.take("+") {
                value += self.product()?;
            } else if self.take("-") {
                value -= self.product()?;
            } else {
                return Some(value);
            }
        }
    }

    fn product(&mut self) -> Option<f64> {
        let mut value = self.power()?;
        loop {
            if self.take("*") {
                value *= self.power()?;
            } else if self.take("/") {
                value /= self.power()?;
            } else {
                return Some(value);
            }
        }
    }

    fn power(&mut self) -> Option<f64> {
        let negative = self.take("-");
        let value = self.term()?;
        let value = if self.take("^") { value.powf(self.term()?) } else { value };
        Some(if negative { -value } else { value })
    }

    fn term(&mut self) -> Option<f64> {
        if self.take("(") {
            let mut values = self.arguments()?;
            return if values.len() == 1 { values.pop() } else { None };
        }
        let word = self.word(|c| c.is_ascii_alphanumeric() || c == '_' || c == '.');
        if word.starts_with(|c: char| c.is_ascii_digit()) {
            return word.parse().ok();
        }
        if !word.is_empty() && self.take("(") {
            let values = self.arguments()?;
            return function(word, &values);
        }
        (self.figure)(word)
    }

    /// Reads the values of a bracket that has been opened, and its end.
    fn arguments(&mut self) -> Option<Vec<f64>> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return None;
        }
        let mut values = vec![self.comparison()?];
        while self.take(",") {
            values.push(self.comparison()?);
        }
        self.depth -= 1;
        self.take(")").then_some(values)
    }

    fn word(&mut self, part: impl Fn(char) -> bool) -> &'a str {
        let end = self.rest.find(|c| !part(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest.trim_start();
        word
    }
}

fn function(name: &str, values: &[f64]) -> Option<f64> {
    Some(match (name, values) {
        ("sqrt", [v]) => v.sqrt(),
        ("abs", [v]) => v.abs(),
        ("floor", [v]) => v.floor(),
        ("ceil", [v]) => v.ceil(),
        ("round", [v]) => v.round(),
        ("sin", [v]) => v.to_radians().sin(),
        ("cos", [v]) => v.to_radians().cos(),
        ("mod", [a, b]) => a.rem_euclid(*b),
        ("clamp", [v, low, high]) => v.max(*low).min(*high),
        ("if", [condition, then, other]) => *if *condition > 0.0 { then } else { other },
        ("min", [first, rest @ ..]) => rest.iter().copied().fold(*first, f64::min),
        ("max", [first, rest @ ..]) => rest.iter().copied().fold(*first, f64::max),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(name: &str) -> Option<f64> {
        [("n", 3.0), ("robot_width", 0.6)].iter().find(|f| f.0 == name).map(|f| f.1)
    }

    fn value(text: &str) -> Option<f64> {
        evaluate(text, &figure).map(|v| (v * 1e6).round() / 1e6)
    }

    #[test]
    fn formulas_of_building_rules() {
        assert_eq!(value("1.8 * n + 2"), Some(7.4));
        assert_eq!(value("robot_width + 2*0.10"), Some(0.8));
        assert_eq!(value("sqrt(robot_width^2 + robot_width^2) - 0.1/2"), Some(0.798528));
        assert_eq!(value("2 - 3 * (n - 1)"), Some(-4.0));
        for wrong in ["", "1 +", "2 n", "m + 1", "(1", "1)", "1/0", "sqrt 4", "1.2.3", &"(".repeat(5000)] {
            assert_eq!(evaluate(wrong, &figure), None, "{wrong:.20}");
        }
    }

    #[test]
    fn functions_comparisons_and_signs() {
        for (text, expected) in [
            ("-8", -8.0),
            ("-n^2 - -1", -8.0),
            ("min(4, n, 5) + max(1, 2)", 5.0),
            ("clamp(n*10, 0, 7.5)", 7.5),
            ("if(n > 2, 1/4, 1/0)", 0.25),
            ("if(n <= 2, 1, if(n == 3, 5, 6))", 5.0),
            ("(n >= 3) * (n < 3.5)", 1.0),
            ("floor(2.7) + ceil(2.1) + round(2.5) + abs(0-1)", 9.0),
            ("mod(7, 3) + sin(30) + cos(60)", 2.0),
        ] {
            assert_eq!(value(text), Some(expected), "{text}");
        }
        for wrong in
            ["min()", "min(1,)", "floor(1, 2)", "tan(1)", "(1, 2)", "1 < 2 < 3", "- ", "n(2)", &"-".repeat(5000)]
        {
            assert_eq!(evaluate(wrong, &figure), None, "{wrong:.20}");
        }
    }

    #[test]
    fn a_check_needs_no_figures() {
        let known = |name: &str| name == "w";
        assert_eq!(check("1/(w - w)", &known), Ok(()));
        assert!(check("w + dd", &known).unwrap_err().contains("`dd`"));
        assert!(check("w +", &known).unwrap_err().contains("no formula"));
    }
}
