//! Small print in a line of text: raised and lowered figures, and lines that are items.
//!
//! What it is not for: units; it only keeps `m²` from becoming `m2`.

use scraper::{ElementRef, Node};

/// Adds the text of a `<sup>` or `<sub>` to a line: an exponent as one character, a fraction as `1/2`, a mark of a footnote
/// not at all.
pub fn raise(line: &mut String, element: ElementRef<'_>, raised: &str) {
    if raised.is_empty() {
        return;
    }
    if element.value().name() == "sub" {
        // "1⁄2" and "1/2" are figures; "CO2" and "h min" read well without.
        if line.ends_with('\u{2044}') {
            line.pop();
            line.push('/');
        }
        line.push_str(raised);
        return;
    }
    let digits = raised.bytes().all(|b| b.is_ascii_digit());
    let follows = |marks: &[char]| {
        let next = element.next_sibling();
        next.is_some_and(|n| matches!(n.value(), Node::Text(t) if t.trim_start().starts_with(marks)))
    };
    if digits && follows(&['\u{2044}', '/']) {
        if line.ends_with(|c: char| c.is_ascii_digit()) {
            line.push(' ');
        }
        line.push_str(raised);
        return;
    }
    let unit = line.rsplit(|c: char| !c.is_alphabetic()).next().unwrap_or_default();
    let is_unit = matches!(unit, "m" | "cm" | "mm" | "dm" | "km" | "ft" | "in" | "yd" | "s" | "feet" | "foot" | "inch");
    let after_digit = line.trim_end().ends_with(|c: char| c.is_ascii_digit());
    let exponent = raised.chars().all(|c| c.is_ascii_digit() || matches!(c, '-' | '−' | '+')) && raised.len() <= 5;
    match raised {
        "2" if is_unit => line.push('²'),
        "3" if is_unit => line.push('³'),
        "-1" | "−1" | "-2" | "−2" | "-3" | "−3" if is_unit => line.extend(raised.chars().filter_map(superscript)),
        "o" | "0" | "°" if after_digit && follows(&['C', 'F']) => line.push('°'),
        _ if exponent && line.ends_with("10") => line.extend(raised.chars().filter_map(superscript)),
        // "1st", "2e", "No" are words; all else that is raised marks a note below.
        _ if raised.chars().all(char::is_alphabetic) && raised.chars().count() > 1 => line.push_str(raised),
        _ => {}
    }
}

fn superscript(c: char) -> Option<char> {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match c {
        '-' | '−' => Some('⁻'),
        _ => c.to_digit(10).and_then(|d| DIGITS.get(d as usize)).copied(),
    }
}

/// Tells whether a line that ends with a break is an item: it has a bullet, or states a figure after a colon.
pub fn is_item(line: &str) -> bool {
    let stated = line.split_once(':').is_some_and(|(_, after)| after.contains(|c: char| c.is_ascii_digit()));
    without_bullet(line).len() < line.len() || (stated && line.len() < 160)
}

/// Returns a line without the mark of an item in front.
pub fn without_bullet(line: &str) -> &str {
    let line = line.trim_start();
    let rest = line.strip_prefix(['-', '–', '—', '*', '•', '·', '▪', '◦', '‣', '●', '○', '■', '□', '\u{f0b7}']);
    match rest {
        Some(rest) if rest.starts_with(char::is_whitespace) => rest.trim_start(),
        _ => line,
    }
}

/// Tells whether a line begins with the mark of an item.
pub fn is_bullet_line(line: &str) -> bool {
    without_bullet(line).len() < line.trim_start().len()
}
