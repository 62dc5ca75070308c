//! Writes XML with one element a line.

/// A document being written.
#[derive(Default)]
pub(crate) struct Xml {
    out: String,
    open: Vec<String>,
}

/// The attributes of an element.
pub(crate) type Attributes<'a> = &'a [(&'a str, String)];

impl Xml {
    /// Returns a document with its declaration and a remark for who opens it.
    pub fn new(remark: &str) -> Self {
        let mut xml = Self { out: "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n".to_owned(), open: Vec::new() };
        // Two dashes end a remark.
        xml.out.push_str(&format!("<!-- {} -->\n", remark.replace("--", "- -")));
        xml
    }

    /// Begins an element.
    pub fn begin(&mut self, tag: &str, attributes: Attributes<'_>) {
        self.element(tag, attributes, ">\n");
        self.open.push(tag.to_owned());
    }

    /// Ends the element that was begun last.
    pub fn end(&mut self) {
        if let Some(tag) = self.open.pop() {
            self.indent();
            self.out.push_str(&format!("</{tag}>\n"));
        }
    }

    /// Writes an element without content.
    pub fn leaf(&mut self, tag: &str, attributes: Attributes<'_>) {
        self.element(tag, attributes, "/>\n");
    }

    /// Writes an element that holds a text.
    pub fn text(&mut self, tag: &str, attributes: Attributes<'_>, text: &str) {
        self.element(tag, attributes, ">");
        escape(&mut self.out, text);
        self.out.push_str(&format!("</{tag}>\n"));
    }

    /// Returns the document, its elements closed.
    pub fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.end();
        }
        self.out
    }

    fn element(&mut self, tag: &str, attributes: Attributes<'_>, end: &str) {
        self.indent();
        self.out.push('<');
        self.out.push_str(tag);
        for (name, value) in attributes {
            self.out.push_str(&format!(" {name}=\""));
            escape(&mut self.out, value);
            self.out.push('"');
        }
        self.out.push_str(end);
    }

    fn indent(&mut self) {
        self.out.extend(std::iter::repeat_n("  ", self.open.len()));
    }
}

fn escape(out: &mut String, text: &str) {
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // What XML has no way to write.
            c if c.is_control() && !matches!(c, '\n' | '\t') => out.push(' '),
            c => out.push(c),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_closed_and_texts_escaped() {
        let mut xml = Xml::new("made -- by hand");
        xml.begin("a", &[("name", "x<\"y\">&\u{1}".to_owned())]);
        xml.leaf("b", &[]);
        xml.text("c", &[], "1 < 2");
        let expected = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<!-- made - - by hand -->\n<a name=\"x&lt;&quot;y&quot;&gt;&amp; \
                        \">\n  <b/>\n  <c>1 &lt; 2</c>\n</a>\n";
        assert_eq!(xml.finish(), expected);
    }
}
