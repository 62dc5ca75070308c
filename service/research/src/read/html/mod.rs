//! HTML to blocks: what a reader of the page sees, without menus and hidden text.
//!
//! What it is not for: scripts, style sheets and frames outside of the page; nothing is fetched.

mod color;
mod guard;
mod style;
mod table;
mod words;

pub use words::{is_bullet_line, without_bullet};

use scraper::{ElementRef, Html, Node};

use super::blocks::{Block, Reading, primary_tag, tidy};
use style::{Look, Sheet};

/// Elements that are no text of the page, or only its frame.
const DROPPED: &[&str] = &[
    "script", "style", "noscript", "template", "nav", "footer", "aside", "svg", "math", "iframe", "object", "embed",
    "canvas", "audio", "video", "map", "select", "button", "textarea", "input", "datalist", "head", "title", "menu",
    "progress", "meter", "rp", "del", "s", "strike",
];
/// What these roles mark is dropped like the elements above.
const DROPPED_ROLES: &[&str] = &[
    "navigation",
    "banner",
    "contentinfo",
    "search",
    "complementary",
    "menu",
    "menubar",
    "dialog",
    "alertdialog",
    "tooltip",
];
/// Elements that stand in a line of text; all others begin a new paragraph.
const INLINE: &[&str] = &[
    "a", "abbr", "acronym", "b", "bdi", "bdo", "big", "cite", "code", "data", "dfn", "em", "font", "i", "ins", "kbd",
    "label", "mark", "nobr", "output", "q", "ruby", "rt", "samp", "small", "span", "strong", "sub", "sup", "time",
    "tt", "u", "var", "wbr",
];
const HEADINGS: &[&str] = &["h1", "h2", "h3", "h4", "h5", "h6"];
/// The walk stops here in any case; the parser's guard keeps pages far below it.
const MAX_DEPTH: usize = 1_500;
/// Stands for `<br>` until the paragraph is complete.
const BREAK: char = '\u{1}';

/// Returns the blocks of a page.
pub fn read(text: &str) -> Reading {
    let (page, cut) = guard::parse(text);
    let mut walker =
        Walker { sheet: Sheet::of(&page), reading: Reading::default(), line: String::new(), hidden: 0, cut };
    walker.facts(&page);
    walker.children(page.root_element(), Look::default(), 0);
    walker.flush();
    let Walker { mut reading, hidden, cut, sheet, .. } = walker;
    if hidden > 0 {
        reading.warnings.push(format!("hidden parts left out: {hidden}"));
    }
    if cut || sheet.exhausted() {
        reading.warnings.push("the page is too deep or too large to be read whole; its end is left out".into());
    }
    reading
}

struct Walker {
    sheet: Sheet,
    reading: Reading,
    /// The paragraph so far.
    line: String,
    hidden: usize,
    cut: bool,
}

impl Walker {
    /// Reads what the page says about itself.
    fn facts(&mut self, page: &Html) {
        self.reading.language = page.root_element().value().attr("lang").and_then(primary_tag);
        for element in page.tree.nodes().filter_map(ElementRef::wrap) {
            let value = element.value();
            match value.name() {
                // A drawing has titles too.
                "title" if self.reading.title.is_none() && !inside(element, "svg") => {
                    self.reading.title = Some(tidy(&element.text().collect::<String>())).filter(|t| !t.is_empty());
                }
                "meta" => {
                    let name = value.attr("name").or_else(|| value.attr("property")).unwrap_or_default();
                    let key = match name.to_ascii_lowercase().as_str() {
                        "author" | "dc.creator" | "citation_author" => "author",
                        "publisher" | "dc.publisher" | "og:site_name" | "citation_publisher" => "publisher",
                        "date" | "dc.date" | "article:published_time" | "citation_publication_date" => "date",
                        "description" | "og:description" => "description",
                        _ => continue,
                    };
                    let content = tidy(value.attr("content").unwrap_or_default());
                    self.fact(key, content);
                }
                "link" if value.attr("rel").is_some_and(|r| r.eq_ignore_ascii_case("canonical")) => {
                    self.fact("canonical", tidy(value.attr("href").unwrap_or_default()));
                }
                _ => {}
            }
        }
    }

    fn fact(&mut self, key: &str, value: String) {
        if !value.is_empty() && value.len() < 2000 {
            self.reading.meta.entry(key.to_owned()).or_insert(value);
        }
    }

    /// Returns how an element looks, or `None` when it is not read.
    fn look(&mut self, element: ElementRef<'_>, above: Look, depth: usize) -> Option<Look> {
        let value = element.value();
        let role = value.attr("role").unwrap_or_default().to_ascii_lowercase();
        if DROPPED.contains(&value.name()) || DROPPED_ROLES.contains(&role.as_str()) {
            return None;
        }
        if depth > MAX_DEPTH || self.sheet.exhausted() {
            self.cut = true;
            return None;
        }
        let look = self.sheet.look(element, above);
        self.hidden += usize::from(look.is_none() && element.text().any(|t| !t.trim().is_empty()));
        look
    }

    fn children(&mut self, element: ElementRef<'_>, look: Look, depth: usize) {
        for child in element.children() {
            match child.value() {
                Node::Text(text) => self.text(text, look),
                Node::Element(_) => {
                    if let Some(child) = ElementRef::wrap(child) {
                        self.element(child, look, depth + 1);
                    }
                }
                _ => {}
            }
        }
    }

    fn text(&mut self, text: &str, look: Look) {
        if look.shows() {
            self.line.push_str(&text.replace(BREAK, ""));
        } else if !text.trim().is_empty() {
            self.hidden += 1;
        }
    }

    fn element(&mut self, element: ElementRef<'_>, above: Look, depth: usize) {
        let Some(look) = self.look(element, above, depth) else { return };
        match element.value().name() {
            "br" => self.line.push(BREAK),
            "sup" | "sub" => {
                let raised = self.plain(element, look, depth);
                words::raise(&mut self.line, element, &raised);
            }
            name if INLINE.contains(&name) => self.children(element, look, depth),
            name if HEADINGS.contains(&name) => {
                let text = self.plain(element, look, depth);
                self.flush();
                let level = name.bytes().last().map_or(6, |b| b - b'0');
                self.reading.push(Block::Heading { level, text });
            }
            "header" => self.header(element, look, depth),
            "form" if !is_page(element) => {}
            "table" => {
                self.flush();
                self.table(element, look, depth);
            }
            "ul" | "ol" if !holds(element, HEADINGS) && !holds(element, &["table"]) => {
                self.flush();
                let mut items = Vec::new();
                self.list(element, look, depth, 0, &mut items);
                self.reading.push(Block::List(items));
            }
            "dl" => {
                self.flush();
                self.definitions(element, look, depth);
            }
            "pre" => {
                self.flush();
                let text = self.raw(element, look, depth);
                self.reading.blocks.extend(super::text::read(&text).blocks);
            }
            _ => {
                self.flush();
                self.children(element, look, depth);
                self.flush();
            }
        }
    }

    /// Reads a page's or article's header for its headings alone; the rest of it is menus, dates and names.
    fn header(&mut self, element: ElementRef<'_>, look: Look, depth: usize) {
        self.flush();
        let headings = element.descendent_elements().filter(|e| HEADINGS.contains(&e.value().name()));
        for heading in headings.collect::<Vec<_>>() {
            // Inside of the header anything may be hidden; a heading in a hidden part must stay so.
            let between = heading.ancestors().filter_map(ElementRef::wrap).take_while(|a| a.id() != element.id());
            let path: Vec<_> = between.collect();
            let look = path.iter().rev().try_fold(look, |look, e| self.look(*e, look, depth));
            if let Some(look) = look {
                self.element(heading, look, depth + path.len() + 1);
            }
        }
    }

    /// Returns the text of an element as one line.
    fn plain(&mut self, element: ElementRef<'_>, look: Look, depth: usize) -> String {
        let outer = std::mem::take(&mut self.line);
        self.inline(element, look, depth);
        let text = std::mem::replace(&mut self.line, outer);
        tidy(&text.replace(BREAK, " "))
    }

    /// Adds the text of an element to the line, blocks inside it set apart by a space.
    fn inline(&mut self, element: ElementRef<'_>, look: Look, depth: usize) {
        for child in element.children() {
            if let Node::Text(text) = child.value() {
                self.text(text, look);
                continue;
            }
            let Some(child) = ElementRef::wrap(child) else { continue };
            let Some(look) = self.look(child, look, depth + 1) else { continue };
            match child.value().name() {
                "br" => self.line.push(' '),
                "sup" | "sub" => {
                    let raised = self.plain(child, look, depth + 1);
                    words::raise(&mut self.line, child, &raised);
                }
                name if INLINE.contains(&name) => self.inline(child, look, depth + 1),
                name => {
                    // Items inside a cell are statements of their own.
                    let mark = if name == "li" && !self.line.trim().is_empty() { "; " } else { " " };
                    self.line.push_str(mark);
                    self.inline(child, look, depth + 1);
                    self.line.push(' ');
                }
            }
        }
    }

    /// Returns the text of an element with its line ends.
    fn raw(&mut self, element: ElementRef<'_>, look: Look, depth: usize) -> String {
        let outer = std::mem::take(&mut self.line);
        self.inline(element, look, depth);
        std::mem::replace(&mut self.line, outer)
    }

    fn list(&mut self, list: ElementRef<'_>, look: Look, depth: usize, level: usize, items: &mut Vec<(usize, String)>) {
        for item in list.child_elements() {
            let Some(look) = self.look(item, look, depth + 1) else { continue };
            if matches!(item.value().name(), "ul" | "ol") {
                self.list(item, look, depth + 1, level + 1, items);
                continue;
            }
            let at = items.len();
            let outer = std::mem::take(&mut self.line);
            let mut nested = Vec::new();
            for child in item.children() {
                match (child.value(), ElementRef::wrap(child)) {
                    (Node::Text(text), _) => self.text(text, look),
                    (_, Some(child)) if matches!(child.value().name(), "ul" | "ol") => {
                        if let Some(look) = self.look(child, look, depth + 2) {
                            self.list(child, look, depth + 2, level + 1, &mut nested);
                        }
                    }
                    (_, Some(child)) => self.item_part(child, look, depth + 2),
                    _ => {}
                }
            }
            let text = std::mem::replace(&mut self.line, outer).replace(BREAK, " ");
            items.insert(at, (level, text));
            items.extend(nested);
        }
    }

    fn item_part(&mut self, element: ElementRef<'_>, above: Look, depth: usize) {
        let Some(look) = self.look(element, above, depth) else { return };
        match element.value().name() {
            "br" => self.line.push(' '),
            "sup" | "sub" => {
                let raised = self.plain(element, look, depth);
                words::raise(&mut self.line, element, &raised);
            }
            name => {
                let apart = !INLINE.contains(&name);
                self.line.push_str(if apart { " " } else { "" });
                self.inline(element, look, depth);
                self.line.push_str(if apart { " " } else { "" });
            }
        }
    }

    fn definitions(&mut self, list: ElementRef<'_>, look: Look, depth: usize) {
        let mut items: Vec<(usize, String)> = Vec::new();
        let mut term = String::new();
        // HTML allows the pairs to be wrapped in a <div> each.
        let parts = list.descendent_elements().filter(|e| matches!(e.value().name(), "dt" | "dd"));
        for part in parts.collect::<Vec<_>>() {
            let between: Vec<_> =
                part.ancestors().filter_map(ElementRef::wrap).take_while(|a| a.id() != list.id()).collect();
            if between.iter().any(|e| e.value().name() == "dl") {
                continue;
            }
            let look = between.iter().rev().try_fold(look, |look, e| self.look(*e, look, depth + 1));
            let Some(look) = look.and_then(|look| self.look(part, look, depth + 1)) else { continue };
            let text = self.plain(part, look, depth + 1);
            if part.value().name() == "dt" {
                term = text;
            } else if term.is_empty() {
                items.push((0, text));
            } else {
                items.push((0, format!("{}: {text}", term.trim_end_matches(':'))));
            }
        }
        self.reading.push(Block::List(items));
    }

    /// Ends the paragraph. Lines divided by `<br>` that each state a figure are items, not one sentence.
    fn flush(&mut self) {
        let line = std::mem::take(&mut self.line);
        let mut items = Vec::new();
        let mut paragraph = String::new();
        let lines: Vec<String> = line.split(BREAK).map(tidy).collect();
        let full = || lines.iter().filter(|l| !l.is_empty());
        // "Widths:", then a line an item.
        let lead = full().next().filter(|l| l.ends_with(':') && full().count() > 2);
        let skipped = usize::from(lead.is_some());
        let itemized = full().count() > 1 && full().skip(skipped).all(|l| words::is_item(l));
        for line in &lines {
            if itemized && lead == Some(line) {
                self.paragraph(&mut line.clone());
            } else if itemized && !line.is_empty() {
                items.push((0, without_bullet(line).to_owned()));
            } else if line.is_empty() && !itemized {
                self.paragraph(&mut paragraph);
            } else if !itemized {
                paragraph.push_str(if paragraph.is_empty() { "" } else { " " });
                paragraph.push_str(line);
            }
        }
        self.paragraph(&mut paragraph);
        if !items.is_empty() {
            self.reading.push(Block::List(items));
        }
    }

    fn paragraph(&mut self, paragraph: &mut String) {
        if !paragraph.is_empty() {
            self.reading.push(Block::Prose(std::mem::take(paragraph)));
        }
    }
}

fn inside(element: ElementRef<'_>, name: &str) -> bool {
    element.ancestors().filter_map(ElementRef::wrap).any(|a| a.value().name() == name)
}

fn holds(element: ElementRef<'_>, names: &[&str]) -> bool {
    element.descendent_elements().skip(1).any(|e| names.contains(&e.value().name()))
}

/// Tells whether a form is wrapped around the whole page, as some servers do, rather than something to fill in.
fn is_page(form: ElementRef<'_>) -> bool {
    holds(form, &["main", "article", "h1"])
        || form.descendent_elements().filter(|e| matches!(e.value().name(), "p" | "table" | "h2")).count() >= 3
}
