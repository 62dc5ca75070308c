//! Formulas of constraints (`1.8 * n + 2`): the four operations, powers, brackets, square roots and named figures.

/// Deepest nesting that is read: formulas of building rules have one or two levels.
const DEEPEST: u8 = 16;

/// Returns the value of a formula; `None` when it is no formula or a name has no figure.
pub(crate) fn evaluate(text: &str, figure: &dyn Fn(&str) -> Option<f64>) -> Option<f64> {
    let mut reader = Reader { rest: text.trim(), figure, depth: 0 };
    let value = reader.sum()?;
    (reader.rest.is_empty() && value.is_finite()).then_some(value)
}

struct Reader<'a> {
    rest: &'a str,
    figure: &'a dyn Fn(&str) -> Option<f64>,
    depth: u8,
}

impl<'a> Reader<'a> {
    fn take(&mut self, sign: char) -> bool {
        match self.rest.strip_prefix(sign) {
            Some(rest) => {
                self.rest = rest.trim_start();
                true
            }
            None => false,
        }
    }

    fn sum(&mut self) -> Option<f64> {
        let mut value = self.product()?;
        loop {
            if self.take('+') {
                value += self.product()?;
            } else if self.take('-') {
                value -= self.product()?;
            } else {
                return Some(value);
            }
        }
    }

    fn product(&mut self) -> Option<f64> {
        let mut value = self.power()?;
        loop {
            if self.take('*') {
                value *= self.power()?;
            } else if self.take('/') {
                value /= self.power()?;
            } else {
                return Some(value);
            }
        }
    }

    fn power(&mut self) -> Option<f64> {
        let value = self.term()?;
        Some(if self.take('^') { value.powf(self.term()?) } else { value })
    }

    fn term(&mut self) -> Option<f64> {
        if self.take('(') {
            return self.bracket();
        }
        let word = self.word(|c| c.is_ascii_alphanumeric() || c == '_' || c == '.');
        if word == "sqrt" {
            return if self.take('(') { self.bracket().map(f64::sqrt) } else { None };
        }
        if word.starts_with(|c: char| c.is_ascii_digit()) { word.parse().ok() } else { (self.figure)(word) }
    }

    /// Reads the rest of a bracket that has been opened.
    fn bracket(&mut self) -> Option<f64> {
        self.depth += 1;
        let value = if self.depth > DEEPEST { None } else { self.sum() };
        self.depth -= 1;
        value.filter(|_| self.take(')'))
    }

    fn word(&mut self, part: impl Fn(char) -> bool) -> &'a str {
        let end = self.rest.find(|c| !part(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest.trim_start();
        word
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_of_building_rules() {
        let figure = |name: &str| [("n", 3.0), ("robot_width", 0.6)].iter().find(|f| f.0 == name).map(|f| f.1);
        let value = |text| evaluate(text, &figure).map(|v| (v * 1e6).round() / 1e6);
        assert_eq!(value("1.8 * n + 2"), Some(7.4));
        assert_eq!(value("robot_width + 2*0.10"), Some(0.8));
        assert_eq!(value("sqrt(robot_width^2 + robot_width^2) - 0.1/2"), Some(0.798528));
        assert_eq!(value("2 - 3 * (n - 1)"), Some(-4.0));
        for wrong in ["", "1 +", "2 n", "m + 1", "(1", "1)", "1/0", "sqrt 4", "1.2.3", &"(".repeat(5000)] {
            assert_eq!(evaluate(wrong, &figure), None, "{wrong:.20}");
        }
    }
}
