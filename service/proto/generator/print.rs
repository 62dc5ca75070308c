//! Proto text of messages and enums.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::numbers::{Given, Numbers, screaming};
use super::types::{Body, Field, Item};

/// Where other languages put what is made of the contract.
const OPTIONS: &str = r#"
option csharp_namespace = "D3dgen.V1";
option go_package = "github.com/d3dgen/d3dgen/proto/d3dgen/v1;d3dgenv1";
option java_multiple_files = true;
option java_package = "io.github.d3dgen.v1";
"#;
/// Longest line of a comment.
const WIDTH: usize = 118;

/// Returns a whole file.
pub fn file(own: &str, about: &str, imports: &BTreeSet<String>, body: &str) -> String {
    let mut out =
        comment("", &format!("{about}\n\nMade of the schemas by `update_contract`; see `proto/documents.toml`."));
    out.push_str("syntax = \"proto3\";\n\npackage d3dgen.v1;\n");
    let imports: Vec<_> = imports.iter().filter(|i| *i != own).collect();
    if !imports.is_empty() {
        out.push('\n');
    }
    for import in imports {
        let _ = writeln!(out, "import \"d3dgen/v1/{import}.proto\";");
    }
    out + OPTIONS + body
}

/// Returns a message or an enum.
pub fn item(item: &Item, numbers: &mut Numbers) -> String {
    let mut out = comment("", &item.about);
    match &item.body {
        Body::Message(fields, choice) => {
            let names: Vec<&str> = fields.iter().map(|f| f.name.as_str()).collect();
            let given = numbers.give(&item.name, &names);
            let _ = writeln!(out, "message {} {{", item.name);
            reserved(&mut out, &given);
            let indent = if let Some(choice) = choice {
                let _ = writeln!(out, "  // Which one it is.\n  oneof {choice} {{");
                "    "
            } else {
                "  "
            };
            for f in fields {
                field(&mut out, indent, f, given.numbers[&f.name]);
            }
            if choice.is_some() {
                out.push_str("  }\n");
            }
        }
        Body::Enum(values) => {
            let zero = format!("{}_UNSPECIFIED", screaming(&item.name));
            let mut names = vec![zero.as_str()];
            names.extend(values.iter().map(|v| v.0.as_str()));
            let mut given = numbers.give(&item.name, &names);
            if given.numbers.get(&zero) != Some(&0) {
                // a new enum counts from zero
                given.numbers.values_mut().for_each(|n| *n -= 1);
            }
            let _ = writeln!(out, "enum {} {{", item.name);
            reserved(&mut out, &given);
            let _ = writeln!(out, "  // Not said.\n  {zero} = 0;");
            for (name, about) in values {
                out.push_str(&comment("  ", about));
                let _ = writeln!(out, "  {name} = {};", given.numbers[name]);
            }
        }
    }
    out + "}\n"
}

fn field(out: &mut String, indent: &str, field: &Field, number: i32) {
    out.push_str(&comment(indent, &field.about));
    let key = if field.key == field.name || field.key == "[]" {
        String::new()
    } else {
        format!(" [json_name = \"{}\"]", field.key)
    };
    let _ = writeln!(out, "{indent}{}{} {} = {number}{key};", field.label, field.kind, field.name);
}

fn reserved(out: &mut String, given: &Given) {
    let list = |words: Vec<String>| words.join(", ");
    if !given.reserved.is_empty() {
        let _ = writeln!(out, "  reserved {};", list(given.reserved.iter().map(i32::to_string).collect()));
    }
    if !given.reserved_names.is_empty() {
        let quoted = given.reserved_names.iter().map(|n| format!("\"{n}\"")).collect();
        let _ = writeln!(out, "  reserved {};", list(quoted));
    }
}

/// Returns a comment, its paragraphs broken at words.
fn comment(indent: &str, text: &str) -> String {
    let mut out = String::new();
    for paragraph in text.split("\n\n") {
        if !out.is_empty() {
            let _ = writeln!(out, "{indent}//");
        }
        let mut line = format!("{indent}//");
        for word in paragraph.split_whitespace() {
            if line.len() + 1 + word.len() > WIDTH {
                let _ = writeln!(out, "{line}");
                line = format!("{indent}//");
            }
            let _ = write!(line, " {word}");
        }
        let _ = writeln!(out, "{line}");
    }
    out
}
