//! Finds the JSON object in what a model wrote: fences, prose around it, leaked thoughts, comments, Python.
//!
//! It is careful: it never invents a bracket or a value, so an answer that was cut off stays broken.

use serde_json::Value;

/// Starts that are tried in one text; more is not an answer but noise.
const MAX_STARTS: usize = 64;

/// Returns the JSON objects that a text may mean, the likeliest first.
pub fn json_candidates(text: &str) -> Vec<Value> {
    let mut found = Vec::new();
    let trimmed = text.trim_start_matches('\u{feff}').trim();
    // Some models write their JSON into a JSON text.
    let unquoted: Option<String> = trimmed.starts_with('"').then(|| serde_json::from_str(trimmed).ok()).flatten();
    let trimmed = unquoted.as_deref().map_or(trimmed, str::trim);
    if let Some(value) = parse(trimmed) {
        return with_inner(value);
    }
    let said = without_thoughts(trimmed);
    if let Some(value) = parse(said) {
        return with_inner(value);
    }
    for block in fenced(said) {
        push(&mut found, parse(block));
    }
    let mut rest = said;
    for _ in 0..MAX_STARTS {
        let Some(start) = rest.find('{') else { break };
        let tail = &rest[start..];
        match balanced(tail) {
            Some(end) => {
                let value = parse(&tail[..end]);
                // A brace of prose, such as `{see below}`, may have an object inside.
                rest = if value.is_some() { &tail[end..] } else { &tail[1..] };
                push(&mut found, value);
            }
            // The start of an object without its end was cut off: what lies inside is a part, not the answer.
            None if tail[1..].trim_start().starts_with('"') => break,
            None => rest = &tail[1..],
        }
    }
    found
}

/// Returns the object, and the one inside if it only wraps another, as in `{"result": {...}}`.
fn with_inner(value: Value) -> Vec<Value> {
    let fields = value.as_object().into_iter().flatten();
    let inner = fields.clone().map(|(_, v)| v).find(|v| v.is_object() && fields.clone().count() == 1).cloned();
    [Some(value.clone()), inner].into_iter().flatten().collect()
}

fn push(found: &mut Vec<Value>, value: Option<Value>) {
    if let Some(value) = value
        && !found.contains(&value)
    {
        found.push(value);
    }
}

/// Returns the text after thoughts that leaked into it.
fn without_thoughts(text: &str) -> &str {
    for (open, close) in [("<think>", "</think>"), ("<thinking>", "</thinking>"), ("<thought>", "</thought>")] {
        let opened = text.trim_start().starts_with(open);
        if let Some(end) = text.rfind(close).map(|i| i + close.len()) {
            // Some servers swallow the opening tag; a closing one inside of a JSON text is content.
            if opened || !text.trim_start().starts_with(['{', '`']) {
                return text.get(end..).unwrap_or_default().trim();
            }
        } else if opened {
            return "";
        }
    }
    text
}

/// Returns the contents of fenced blocks.
fn fenced(text: &str) -> Vec<&str> {
    let mut blocks = Vec::new();
    let mut rest = text;
    while let Some(open) = rest.find("```") {
        let after = &rest[open + 3..];
        let Some(body) = after.find('\n').map(|i| &after[i + 1..]) else { break };
        let Some(close) = body.find("```") else { break };
        blocks.push(body[..close].trim());
        rest = &body[close + 3..];
    }
    blocks
}

/// Returns where the object at the start of `text` ends; braces in strings and comments do not count.
fn balanced(text: &str) -> Option<usize> {
    let mut depth = 0_usize;
    let mut scanner = Scanner::default();
    for (i, c) in text.char_indices() {
        if scanner.step(c, text.as_bytes().get(i + 1).copied()) != Place::Code {
            continue;
        }
        match c {
            '{' | '[' => depth += 1,
            '}' | ']' => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return Some(i + 1);
                }
            }
            _ => {}
        }
    }
    None
}

/// Parses an object, as it is or after the careful repair.
fn parse(text: &str) -> Option<Value> {
    if !text.starts_with('{') {
        return None;
    }
    let value = serde_json::from_str(text).or_else(|_| serde_json::from_str(&repaired(text)));
    let value = value.or_else(|_| serde_json::from_str(&repaired(&from_python(text))));
    value.ok().filter(Value::is_object)
}

/// Returns the text with strings and constants as JSON has them, where it is written as Python: `{'a': None}`.
fn from_python(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut quote = None;
    let mut word = String::new();
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        if quote.is_none() && c.is_alphabetic() {
            word.push(c);
            continue;
        }
        out.push_str(match word.as_str() {
            "True" => "true",
            "False" => "false",
            "None" => "null",
            other => other,
        });
        word.clear();
        match (quote, c) {
            (None, '\'' | '"') => {
                quote = Some(c);
                out.push('"');
            }
            (Some(open), c) if c == open => {
                quote = None;
                out.push('"');
            }
            (Some(_), '"') => out.push_str("\\\""),
            (Some(_), '\\') => match chars.next() {
                Some('\'') => out.push('\''),
                next => out.extend([Some('\\'), next].into_iter().flatten()),
            },
            _ => out.push(c),
        }
    }
    out
}

/// Returns the text without comments and trailing commas, with control characters in strings escaped.
fn repaired(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut scanner = Scanner::default();
    for (i, c) in text.char_indices() {
        match scanner.step(c, text.as_bytes().get(i + 1).copied()) {
            Place::Comment => {}
            Place::Text if c.is_control() => match c {
                '\n' => out.push_str("\\n"),
                '\t' => out.push_str("\\t"),
                '\r' => out.push_str("\\r"),
                _ => {}
            },
            Place::Text => out.push(c),
            Place::Code => {
                if matches!(c, '}' | ']') {
                    let kept = out.trim_end();
                    if let Some(before) = kept.strip_suffix(',') {
                        out.truncate(before.len());
                    }
                }
                out.push(c);
            }
        }
    }
    out
}

/// Where a character stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Code,
    Text,
    Comment,
}

/// Follows strings and comments through a text.
#[derive(Default)]
struct Scanner {
    in_string: bool,
    escaped: bool,
    /// The character that ends a comment: a line's or a block's.
    comment: Option<char>,
    /// The last character, inside of a block comment.
    last: char,
}

impl Scanner {
    /// Takes the next character and the byte after it.
    fn step(&mut self, c: char, next: Option<u8>) -> Place {
        if let Some(end) = self.comment {
            let over = c == end && (end == '\n' || self.last == '*');
            // The star that opens a comment does not close it.
            self.last = if self.last == '\u{1}' { '\u{2}' } else { c };
            if over {
                self.comment = None;
                return if end == '\n' { Place::Code } else { Place::Comment };
            }
            return Place::Comment;
        }
        if self.in_string {
            match c {
                _ if self.escaped => self.escaped = false,
                '\\' => self.escaped = true,
                '"' => {
                    self.in_string = false;
                    return Place::Code;
                }
                _ => {}
            }
            return Place::Text;
        }
        match (c, next) {
            ('"', _) => self.in_string = true,
            ('/', Some(b'/')) => self.comment = Some('\n'),
            ('/', Some(b'*')) => {
                self.comment = Some('/');
                self.last = '\u{1}';
            }
            _ => {}
        }
        if self.comment.is_some() { Place::Comment } else { Place::Code }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn check(text: &str, expected: &[Value]) {
        assert_eq!(json_candidates(text), expected, "{text}");
    }

    #[test]
    fn objects_are_found_in_what_models_write() {
        let a = || json!({"a": 1});
        check(r#" {"a":1} "#, &[a()]);
        check("\u{feff}{\"a\":1}", &[a()]);
        check("Sure:\n```json\n{\n \"a\": 1, // one\n}\n```\nAnything else?", &[a()]);
        check("```\n{\"a\":1}\n```", &[a()]);
        check("```json\n{\"a\":1}", &[a()]);
        check("<think>\n{\"a\":2}?\n</think>\n\n{\"a\":1}", &[a()]);
        check("so {\"a\":2}?\n</think>{\"a\":1}", &[a()]);
        check("see [1] and {x}: {\"a\":1} or {\"b\":[1,2,],}", &[a(), json!({"b": [1, 2]})]);
        check("{\"a\": /* } \" */ 1}", &[a()]);
        check("{ see {\"a\":1} }", &[a()]);
        check("[{\"a\":1}]", &[a()]);
        check("{'a': 1,}", &[a()]);
        check(
            r#"{'u': 'http://a.test/"x"', "it's": None, 'b': [True, 'it\'s \n']}"#,
            &[json!({"u": "http://a.test/\"x\"", "it's": null, "b": [true, "it's \n"]})],
        );
        check("\"{\\\"a\\\":1}\"", &[a()]);
        check("{\"result\": {\"a\":1}}", &[json!({"result": {"a": 1}}), a()]);
    }

    #[test]
    fn what_stands_in_strings_is_kept() {
        check(r#"{"u":"http://a.test/*x*/","b":",}"}"#, &[json!({"u": "http://a.test/*x*/", "b": ",}"})]);
        check("{\"u\":\"// no \\\" comment\",}", &[json!({"u": "// no \" comment"})]);
        check("{\"u\":\"two\nlines\"}", &[json!({"u": "two\nlines"})]);
        check("{\"u\":\"</think> {\\\"a\\\":1}\"}", &[json!({"u": "</think> {\"a\":1}"})]);
    }

    #[test]
    fn nothing_is_invented() {
        for text in [
            "",
            "{",
            "{\"a\":1",
            "{\"a\":\"cut",
            "no json",
            "[1,2]",
            "<think>{\"a\":1}",
            "{\"a\":}",
            "{'a':1",
            "{'a':'b}",
            "{a:1}",
            "{\"a\":[{\"b\":1},",
        ] {
            check(text, &[]);
        }
        check(&"{".repeat(100_000), &[]);
        check(&"{\"a\":".repeat(10_000), &[]);
    }
}
