//! Which text of a page a reader does not see: hidden by attributes, by styles, or by having the color of its background.
//!
//! What it is not for: laying out a page. Style sheets outside of the page are never fetched; where text could be hidden by
//! one, it is read.

use scraper::{ElementRef, Html, Selector};

use super::color::{Color, color};

/// How often selectors are tried on elements in one page; a page that needs more is read no further.
const MAX_TRIES: usize = 40_000_000;
/// How many rules of a page are kept.
const MAX_RULES: usize = 4_000;

/// What a text inherits.
#[derive(Debug, Clone, Copy)]
pub struct Look {
    color: Color,
    background: Color,
}

impl Default for Look {
    fn default() -> Self {
        Self { color: Color::BLACK, background: Color::WHITE }
    }
}

impl Look {
    /// Tells whether text of this look can be seen.
    pub fn shows(&self) -> bool {
        !self.color.vanishes_on(self.background)
    }
}

#[derive(Debug, Clone)]
struct Declaration {
    property: String,
    value: String,
    important: bool,
}

struct Rule {
    selector: Selector,
    weight: Weight,
    declarations: Vec<Declaration>,
}

/// How many ids, classes with attributes, and element names a selector has: the larger one wins over the later one.
type Weight = (usize, usize, usize);

/// The style rules of a page that can hide text.
pub struct Sheet {
    rules: Vec<Rule>,
    tries: usize,
}

impl Sheet {
    /// Returns the rules in the `<style>` elements of a page.
    pub fn of(page: &Html) -> Self {
        let mut rules = Vec::new();
        let styles = page.tree.nodes().filter_map(ElementRef::wrap).filter(|e| e.value().name() == "style");
        for style in styles {
            let text: String = style.text().collect();
            collect(&without_comments(&text), 0, &mut rules);
        }
        rules.sort_by_key(|r| r.weight);
        Self { rules, tries: 0 }
    }

    /// Tells whether trying the rules has taken more than a page may take.
    pub fn exhausted(&self) -> bool {
        self.tries > MAX_TRIES
    }

    /// Returns how text directly in an element looks, or `None` when the element is hidden with all inside it.
    pub fn look(&mut self, element: ElementRef<'_>, above: Look) -> Option<Look> {
        let value = element.value();
        let attribute = |name: &str| value.attr(name);
        let is = |name: &str, wanted: &str| attribute(name).is_some_and(|v| v.trim().eq_ignore_ascii_case(wanted));
        if attribute("hidden").is_some() || is("aria-hidden", "true") || is("type", "hidden") {
            return None;
        }
        if value.name() == "dialog" && attribute("open").is_none() {
            return None;
        }
        self.tries += self.rules.len();
        let own = attribute("style").map(|s| declarations(&without_comments(s))).unwrap_or_default();
        let fitting: Vec<&Declaration> =
            self.rules.iter().filter(|r| r.selector.matches(&element)).flat_map(|r| &r.declarations).collect();
        let mut seen = Seen::default();
        if let Some(c) = attribute(if value.name() == "body" { "text" } else { "color" }) {
            seen.color = Some(color(c));
        }
        if let Some(c) = attribute("bgcolor") {
            seen.background = Some(color(c));
        }
        for important in [false, true] {
            let all = fitting.iter().copied().chain(&own);
            all.filter(|d| d.important == important).for_each(|d| seen.apply(&d.property, &d.value));
        }
        if seen.hides() {
            return None;
        }
        let background = match seen.background {
            None | Some(Color::Transparent) => above.background,
            Some(background) => background,
        };
        Some(Look { color: seen.color.unwrap_or(above.color), background })
    }
}

/// What declarations make of an element.
#[derive(Debug, Default)]
struct Seen {
    display: bool,
    visibility: bool,
    opacity: bool,
    tiny: bool,
    clipped: bool,
    shifted: bool,
    indented: bool,
    moved: bool,
    flat: bool,
    cut: bool,
    color: Option<Color>,
    background: Option<Color>,
}

impl Seen {
    fn apply(&mut self, property: &str, value: &str) {
        match property {
            "display" => self.display = value == "none",
            "visibility" => self.visibility = matches!(value, "hidden" | "collapse"),
            "content-visibility" => self.visibility = value == "hidden",
            "opacity" => {
                self.opacity = number(value).is_some_and(|n| n < if value.ends_with('%') { 5.0 } else { 0.05 })
            }
            "font-size" => self.tiny = is_tiny(value),
            "font" => self.tiny = is_tiny_font(value),
            "clip" => self.clipped = value.starts_with("rect(") && is_empty_rectangle(value),
            "clip-path" => self.clipped = matches!(value, "inset(50%)" | "inset(100%)" | "circle(0)" | "circle(0px)"),
            "text-indent" => self.indented = is_far(value),
            "left" | "top" | "right" | "bottom" | "margin-left" | "margin-top" | "inset" => {
                self.shifted |= value.split(' ').any(is_far);
            }
            "transform" => {
                let squeezed = ["scale(0)", "scale(0,0)", "scale(0, 0)", "scalex(0)", "scaley(0)"].contains(&value);
                self.moved = squeezed || value.split(['(', ',', ')']).any(is_far);
            }
            "width" | "height" | "max-height" | "max-width" => {
                self.flat |= number(value).is_some_and(|n| n <= 1.0) && !value.ends_with('%');
            }
            "overflow" | "overflow-x" | "overflow-y" => self.cut = matches!(value, "hidden" | "clip"),
            "color" | "-webkit-text-fill-color" if value != "inherit" => self.color = Some(color(value)),
            "background-color" => self.background = Some(color(value)),
            // A picture or gradient may be any color.
            "background" | "background-image" if value != "none" => {
                let single = !value.contains("url(") && !value.contains("gradient");
                self.background = Some(if single { color(value) } else { Color::Unknown });
            }
            _ => {}
        }
    }

    fn hides(&self) -> bool {
        self.display
            || self.visibility
            || self.opacity
            || self.tiny
            || self.clipped
            || self.indented
            || self.moved
            || self.shifted
            || (self.flat && self.cut)
    }
}

/// Returns the figure that a value begins with.
fn number(value: &str) -> Option<f64> {
    let end = value.find(|c: char| !matches!(c, '0'..='9' | '.' | '-' | '+')).unwrap_or(value.len());
    value.get(..end)?.parse().ok()
}

/// Tells whether a whole font, such as `bold 12px/1.5 serif`, is tiny. A figure without unit is a weight, or a size of 0.
fn is_tiny_font(value: &str) -> bool {
    let sizes = value.split(' ').filter_map(|part| part.split('/').next());
    let is_size = |v: &str| number(v) == Some(0.0) || v.ends_with(|c: char| c.is_ascii_alphabetic() || c == '%');
    sizes.filter(|v| is_size(v)).any(is_tiny)
}

fn is_tiny(value: &str) -> bool {
    let least = match value {
        v if v.ends_with("em") => 0.15,
        v if v.ends_with('%') => 15.0,
        v if v.ends_with("vw") || v.ends_with("vh") => 0.05,
        _ => 2.0,
    };
    number(value).is_some_and(|n| n < least)
}

/// Tells whether a length leads out of any screen.
fn is_far(value: &str) -> bool {
    let value = value.trim();
    let factor = match value {
        v if v.ends_with("em") => 16.0,
        v if v.ends_with('%') || v.ends_with("vw") || v.ends_with("vh") => 10.0,
        _ => 1.0,
    };
    number(value).is_some_and(|n| n * factor <= -500.0)
}

fn is_empty_rectangle(value: &str) -> bool {
    let inner = value.trim_start_matches("rect(").trim_end_matches(')');
    inner.split([',', ' ']).filter(|v| !v.is_empty()).all(|v| number(v).is_some_and(|n| n <= 1.0))
}

/// Adds the rules of a style sheet. Rules for print and for small screens say nothing about what a reader sees.
fn collect(css: &str, depth: usize, rules: &mut Vec<Rule>) {
    let mut rest = css;
    while let Some(open) = rest.find('{') {
        if rules.len() >= MAX_RULES {
            return;
        }
        let (head, after) = (rest.get(..open).unwrap_or_default(), rest.get(open + 1..).unwrap_or_default());
        // What stands before a semicolon is a statement such as @charset.
        let head = head.rsplit(';').next().unwrap_or_default().trim();
        let end = closing(after);
        let body = after.get(..end).unwrap_or_default();
        rest = after.get(end + 1..).unwrap_or_default();
        if let Some(rule) = head.strip_prefix('@') {
            let rule = rule.to_ascii_lowercase();
            let groups = ["media", "supports", "layer", "container"].iter().any(|g| rule.starts_with(g));
            let other = rule.contains("print") || rule.contains("max-width") || rule.contains("speech");
            if groups && !other && depth < 4 {
                collect(body, depth + 1, rules);
            }
            continue;
        }
        let found: Vec<Declaration> = declarations(body).into_iter().filter(|d| matters(&d.property)).collect();
        if found.is_empty() {
            continue;
        }
        // One bad selector must not lose its neighbors, and states such as :hover are not how a page is first seen.
        for selector in head.split(',').filter(|s| !s.contains(':') && s.len() < 500) {
            let weight = weight(selector);
            if let Ok(selector) = Selector::parse(selector.trim()) {
                rules.push(Rule { selector, weight, declarations: found.clone() });
            }
        }
    }
}

/// Returns the weight of a selector without states, which are not kept.
fn weight(selector: &str) -> Weight {
    let ids = selector.matches('#').count();
    let classes = selector.matches(['.', '[']).count();
    let parts = selector.split([' ', '>', '+', '~']);
    (ids, classes, parts.filter(|p| p.starts_with(|c: char| c.is_ascii_alphabetic())).count())
}

fn matters(property: &str) -> bool {
    const PROPERTIES: &[&str] = &[
        "display",
        "visibility",
        "content-visibility",
        "opacity",
        "font-size",
        "font",
        "clip",
        "clip-path",
        "text-indent",
        "left",
        "top",
        "right",
        "bottom",
        "margin-left",
        "margin-top",
        "inset",
        "transform",
        "width",
        "height",
        "max-height",
        "max-width",
        "overflow",
        "overflow-x",
        "overflow-y",
        "color",
        "-webkit-text-fill-color",
        "background-color",
        "background",
        "background-image",
    ];
    PROPERTIES.contains(&property)
}

/// Returns where the brace that is open at the beginning closes.
fn closing(text: &str) -> usize {
    let mut depth = 0usize;
    for (i, c) in text.bytes().enumerate() {
        match c {
            b'{' => depth += 1,
            b'}' if depth == 0 => return i,
            b'}' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}

fn declarations(text: &str) -> Vec<Declaration> {
    let parts = text.split(';').filter_map(|d| d.split_once(':'));
    let read = |(property, value): (&str, &str)| {
        let value = unescaped(value).to_ascii_lowercase();
        let (value, important) = match value.split_once('!') {
            Some((value, mark)) => (value.trim().to_owned(), mark.trim().starts_with("important")),
            None => (value.trim().to_owned(), false),
        };
        Declaration { property: unescaped(property).trim().to_ascii_lowercase(), value, important }
    };
    parts.map(read).collect()
}

fn without_comments(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("/*") {
        out.push_str(before);
        rest = after.split_once("*/").map_or("", |(_, after)| after);
    }
    out.push_str(rest);
    out
}

/// Returns a text with escapes such as `\64 isplay` resolved.
fn unescaped(text: &str) -> String {
    if !text.contains('\\') {
        return text.to_owned();
    }
    let mut out = String::new();
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        if c != '\\' {
            out.push(c);
            continue;
        }
        let mut digits = String::new();
        while let Some(d) = chars.next_if(|d| d.is_ascii_hexdigit() && digits.len() < 6) {
            digits.push(d);
        }
        if digits.is_empty() {
            out.extend(chars.next());
        } else {
            chars.next_if(|c| c.is_whitespace());
            out.extend(u32::from_str_radix(&digits, 16).ok().and_then(char::from_u32));
        }
    }
    out
}
