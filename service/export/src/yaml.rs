//! Writes JSON values as block-style YAML, as PyYAML's `safe_dump(sort_keys=False, allow_unicode=True)` does.
//!
//! The consumers read with PyYAML (YAML 1.1): strings that it would take for something else are quoted, and floats always
//! carry a point, because some of the readers tell `1` from `1.0`.

use std::fmt::Write;

use serde_json::Value;

/// Returns the YAML text of a value, with a final line break.
pub fn to_string(value: &Value) -> String {
    let mut out = String::new();
    match value {
        Value::Object(map) if !map.is_empty() => write_map(&mut out, map, 0, false),
        Value::Array(list) if !list.is_empty() => write_list(&mut out, list, 0, false),
        _ => {
            write_scalar(&mut out, value);
            out.push('\n');
        }
    }
    out
}

fn write_map(out: &mut String, map: &serde_json::Map<String, Value>, indent: usize, inline_first: bool) {
    for (i, (key, value)) in map.iter().enumerate() {
        if i > 0 || !inline_first {
            pad(out, indent);
        }
        write_text(out, key);
        out.push(':');
        match value {
            Value::Object(inner) if !inner.is_empty() => {
                out.push('\n');
                write_map(out, inner, indent + 2, false);
            }
            // A list under a key is not indented further: the house style of the consumers' own files.
            Value::Array(inner) if !inner.is_empty() => {
                out.push('\n');
                write_list(out, inner, indent, false);
            }
            _ => {
                out.push(' ');
                write_scalar(out, value);
                out.push('\n');
            }
        }
    }
}

fn write_list(out: &mut String, list: &[Value], indent: usize, inline_first: bool) {
    for (i, value) in list.iter().enumerate() {
        if i > 0 || !inline_first {
            pad(out, indent);
        }
        out.push_str("- ");
        match value {
            Value::Object(inner) if !inner.is_empty() => write_map(out, inner, indent + 2, true),
            Value::Array(inner) if !inner.is_empty() => write_list(out, inner, indent + 2, true),
            _ => {
                write_scalar(out, value);
                out.push('\n');
            }
        }
    }
}

fn pad(out: &mut String, indent: usize) {
    out.extend(std::iter::repeat_n(' ', indent));
}

fn write_scalar(out: &mut String, value: &Value) {
    match value {
        Value::Null => out.push_str("null"),
        Value::Bool(b) => out.push_str(if *b { "true" } else { "false" }),
        Value::Number(n) => write_number(out, n),
        Value::String(s) => write_text(out, s),
        Value::Array(_) => out.push_str("[]"),
        Value::Object(_) => out.push_str("{}"),
    }
}

fn write_number(out: &mut String, n: &serde_json::Number) {
    let Some(float) = n.as_f64().filter(|_| n.is_f64()) else {
        let _ = write!(out, "{n}");
        return;
    };
    // Ten decimals are finer than any length here, and keep clear of exponents, which YAML 1.1 reads as text.
    let text = format!("{float:.10}");
    let text = text.trim_end_matches('0');
    out.push_str(if text == "-0." { "0." } else { text });
    if text.ends_with('.') {
        out.push('0');
    }
}

fn write_text(out: &mut String, text: &str) {
    if is_plain(text) {
        out.push_str(text);
        return;
    }
    // Line separators and the BOM end a scalar in YAML 1.1, so they are escaped like control characters.
    let escape = |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}');
    if !text.contains(escape) {
        let _ = write!(out, "'{}'", text.replace('\'', "''"));
        return;
    }
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            c if escape(c) => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
}

/// Returns true when PyYAML and libyaml take the bare text for that very string.
fn is_plain(text: &str) -> bool {
    const WORDS: [&str; 8] = ["true", "false", "yes", "no", "on", "off", "null", "nan"];
    let starts_well =
        text.trim_start_matches('-').starts_with(|c: char| c.is_alphabetic() || c == '_') && !text.starts_with("--");
    starts_well
        && !text.ends_with(' ')
        && text.chars().all(|c| c.is_alphanumeric() || " _-./(),'+:".contains(c))
        && !text.contains(": ")
        && !text.ends_with(':')
        && !WORDS.contains(&text.to_ascii_lowercase().as_str())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn blocks_look_as_the_consumers_write_them() {
        let value = json!({"zones": [{"name": "hall", "material": ["Oak", {}], "corners": [{"x": 0.0, "y": -1.5}],
            "elevators": [], "bbox": [[-0.5, 0.5], [0.0, 1.0]]}]});
        let expected = "zones:\n- name: hall\n  material:\n  - Oak\n  - {}\n  corners:\n  - x: 0.0\n    y: -1.5\n  \
            elevators: []\n  bbox:\n  - - -0.5\n    - 0.5\n  - - 0.0\n    - 1.0\n";
        assert_eq!(to_string(&value), expected);
    }

    #[test]
    fn scalars_keep_their_type() {
        for (value, text) in [
            (json!(1.0), "1.0"),
            (json!(-0.0), "0.0"),
            (json!(0.1 + 0.2), "0.3"),
            (json!(12), "12"),
            (json!("no"), "'no'"),
            (json!("12"), "'12'"),
            (json!(""), "''"),
            (json!("-y"), "-y"),
            (json!("a: b # c"), "'a: b # c'"),
            (json!("two\nlines \"x\""), "\"two\\nlines \\\"x\\\"\""),
            (json!("Großküche 病房"), "Großküche 病房"),
            (json!("Object/Patient_Bed"), "Object/Patient_Bed"),
            (json!("--x"), "'--x'"),
            (json!("it's: so"), "'it''s: so'"),
            (json!("kind::bed"), "kind::bed"),
        ] {
            assert_eq!(to_string(&value), format!("{text}\n"));
        }
    }
}
