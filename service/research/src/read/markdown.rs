//! Markdown to blocks: it is turned into HTML first, so that HTML inside it meets the same rules about hidden text.
//!
//! What it is not for: front matter that is more than lines of `key: value`.

use std::collections::BTreeMap;

use pulldown_cmark::{Options, Parser};

use super::blocks::{Reading, primary_tag, tidy};
use super::html;

/// Returns the blocks of a Markdown text.
pub fn read(text: &str) -> Reading {
    let (front, body) = front_matter(text);
    let options = Options::ENABLE_TABLES | Options::ENABLE_FOOTNOTES | Options::ENABLE_DEFINITION_LIST;
    let mut page = String::with_capacity(body.len() * 5 / 4);
    pulldown_cmark::html::push_html(&mut page, Parser::new_ext(body, options));
    let mut reading = html::read(&page);
    if let Some(title) = front.get("title") {
        reading.title = Some(title.clone());
    }
    if let Some(language) = front.get("lang").or_else(|| front.get("language")) {
        reading.language = primary_tag(language);
    }
    reading.meta = front;
    reading
}

/// Returns the lines `key: value` (or `key = "value"`) between the two marks at the beginning, and the text after them.
fn front_matter(text: &str) -> (BTreeMap<String, String>, &str) {
    let none = (BTreeMap::new(), text);
    let (mark, separator) = if text.starts_with("---\n") {
        ("---", ':')
    } else if text.starts_with("+++\n") {
        ("+++", '=')
    } else {
        return none;
    };
    let mut at = mark.len() + 1;
    let mut found = BTreeMap::new();
    for line in text.get(at..).unwrap_or_default().split_inclusive('\n') {
        at += line.len();
        if line.trim_end() == mark {
            return (found, text.get(at..).unwrap_or_default());
        }
        if let Some((key, value)) = line.split_once(separator) {
            let value = tidy(value.trim().trim_matches(['"', '\'']));
            let key = key.trim().to_lowercase();
            if !value.is_empty() && !key.is_empty() && key.len() < 60 {
                found.insert(key, value);
            }
        }
    }
    none
}
