//! Lines of a USD layer: prims in braces, each level four spaces further in.

use std::fmt::{Display, Write};

use crate::affine::Vec3;
use crate::writers::number::n;

/// A layer while it is written.
#[derive(Debug, Default)]
pub struct Text {
    pub(super) out: String,
    depth: usize,
}

impl Text {
    /// Returns an empty layer whose header holds these lines.
    pub fn layer(header: &[String]) -> Self {
        let mut text = Self { out: "#usda 1.0\n(\n".to_owned(), depth: 1 };
        header.iter().for_each(|line| text.line(line));
        text.out.push_str(")\n");
        text.depth = 0;
        text
    }

    /// Returns the text of the layer.
    pub fn finish(self) -> String {
        self.out
    }

    /// Writes a line; one of several lines goes in as a whole.
    pub fn line(&mut self, line: impl Display) {
        self.indent();
        let _ = writeln!(self.out, "{line}");
    }

    pub(super) fn indent(&mut self) {
        for _ in 0..self.depth {
            self.out.push_str("    ");
        }
    }

    /// Writes a prim: what it is (`def Xform`), its name, the lines in its parentheses, and what is in it.
    pub fn prim(&mut self, what: &str, name: &str, metadata: &[String], inside: impl FnOnce(&mut Self)) {
        self.out.push('\n');
        if metadata.is_empty() {
            self.line(format_args!("{what} \"{name}\""));
        } else {
            self.line(format_args!("{what} \"{name}\" ("));
            self.depth += 1;
            metadata.iter().for_each(|line| self.line(line));
            self.depth -= 1;
            self.line(")");
        }
        self.line("{");
        self.depth += 1;
        inside(self);
        self.depth -= 1;
        self.line("}");
    }

    /// Writes where a prim is: its way, and its turn as a quaternion w, x, y, z.
    pub fn placed(&mut self, at: Vec3, turn: Option<[f64; 4]>) {
        let mut order = vec!["\"xformOp:translate\""];
        self.line(format_args!("double3 xformOp:translate = {}", triple(at)));
        if let Some(turn) = turn {
            self.line(format_args!("quatf xformOp:orient = {}", quat(turn)));
            order.push("\"xformOp:orient\"");
        }
        self.line(format_args!("uniform token[] xformOpOrder = [{}]", order.join(", ")));
    }

    /// Writes what a prim is called by those who look at pictures of it.
    pub fn labels(&mut self, taxonomy: &str, labels: &[&str]) {
        let list: Vec<String> = labels.iter().map(|l| quoted(l)).collect();
        self.line(format_args!("token[] semantics:labels:{taxonomy} = [{}]", list.join(", ")));
    }
}

/// Returns the line that applies schemas to a prim.
pub fn schemas(list: &[&str]) -> String {
    let list: Vec<String> = list.iter().map(|s| format!("\"{s}\"")).collect();
    format!("prepend apiSchemas = [{}]", list.join(", "))
}

/// Returns a text in quotes, as USD reads it back.
pub fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// Returns a vector in parentheses.
pub fn triple(v: Vec3) -> String {
    let [x, y, z] = v.map(n);
    format!("({x}, {y}, {z})")
}

/// Returns a quaternion w, x, y, z in parentheses.
pub fn quat(q: [f64; 4]) -> String {
    let [w, x, y, z] = q.map(n);
    format!("({w}, {x}, {y}, {z})")
}

/// Returns a prim name: letters, digits and underscores, no digit first.
pub fn identifier(name: &str) -> String {
    let mut id: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if id.is_empty() || id.starts_with(|c: char| c.is_ascii_digit()) {
        id.insert(0, '_');
    }
    id
}

/// Returns prim names of a list: valid, different from each other and from `taken`.
pub fn names<'a>(taken: &str, list: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for name in list {
        let base = identifier(name);
        let mut name = base.clone();
        let mut number = 1;
        while name == taken || out.contains(&name) {
            number += 1;
            name = format!("{base}_{number}");
        }
        out.push(name);
    }
    out
}
