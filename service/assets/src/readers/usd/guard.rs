//! Looks at the bytes of a layer before the USD library does: it takes memory for whatever a count says, and recurses as
//! deep as a layer is nested.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Cursor};
use std::ops::Range;

use openusd::ar::{Asset, ResolvedPath, Resolver};
use openusd::sdf::{LayerData, LayerRegistry, ListOp, Path, Value};

use crate::readers::facts::Refusal;

/// The largest layer of text.
const MAX_TEXT_BYTES: usize = 192 << 20;
/// The deepest nesting of prims, dictionaries and lists.
const MAX_DEPTH: usize = 256;
/// The most items of a table of a binary layer.
const MAX_ITEMS: u64 = 20_000_000;

/// The bytes of a layer as the library may read them.
pub struct Checked {
    /// The bytes.
    pub bytes: Vec<u8>,
    /// What was changed in them.
    pub warning: Option<&'static str>,
}

/// Returns the bytes of a layer as the library may read them.
///
/// # Errors
///
/// When the library must not read them.
pub fn checked(bytes: &[u8]) -> Result<Checked, Refusal> {
    let sound = |bytes: &[u8]| Checked { bytes: bytes.to_vec(), warning: None };
    if bytes.starts_with(b"PXR-USDC") {
        tables(bytes)?;
        return Ok(sound(bytes));
    }
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if !text.starts_with(b"#usda ") && !text.starts_with(b"#sdf ") {
        return Err("a layer of it is no USD: it begins neither with `#usda 1.0` nor as a binary layer".into());
    }
    if text.len() > MAX_TEXT_BYTES {
        return Err(format!("a layer of it has more than {} MiB of text", MAX_TEXT_BYTES >> 20).into());
    }
    let cleaned = without_comments(text, nesting(text)?);
    let text = cleaned.as_ref();
    let inherits = |word: &[u8]| text.windows(word.len()).any(|w| w == word);
    if inherits(b"inherits") || inherits(b"specializes") {
        return Ok(match without_circles(text)? {
            Some(bytes) => Checked { bytes, warning: Some("prims inherit in a circle, which is cut") },
            None => sound(text),
        });
    }
    Ok(sound(text))
}

/// Checks the table of contents of a binary layer, and the count at the beginning of each table.
fn tables(bytes: &[u8]) -> Result<(), Refusal> {
    let word = |at: u64| -> Result<u64, Refusal> {
        let at = usize::try_from(at).map_err(|_| CUT)?;
        let bytes = at.checked_add(8).and_then(|end| bytes.get(at..end)).ok_or(CUT)?;
        Ok(bytes.try_into().map(u64::from_le_bytes).map_err(|_| CUT)?)
    };
    let version = bytes.get(8..11).ok_or(CUT)?;
    if version[0] != 0 || !(4..=20).contains(&version[1]) {
        let [a, b, c] = [version[0], version[1], version[2]];
        return Err(format!("a binary layer of it is of version {a}.{b}.{c}, only 0.4 to 0.20 are read").into());
    }
    let length = bytes.len() as u64;
    let contents = word(16)?;
    let count = word(contents)?;
    if count > 64 {
        return Err(format!("a binary layer of it says that it has {count} tables").into());
    }
    for index in 0..count {
        let at = contents + 8 + index * 32;
        let name_at = at as usize;
        let name = bytes.get(name_at..name_at + 16).ok_or(CUT)?;
        let (start, size) = (word(at + 16)?, word(at + 24)?);
        if start.checked_add(size).is_none_or(|end| end > length) {
            return Err("a table of a binary layer of it lies past its end".into());
        }
        let items = word(start)?;
        // The coding of numbers packs them a thousandfold at best.
        if items > MAX_ITEMS || items / 1024 > length {
            return Err(format!("a table of a binary layer of it says that it has {items} items").into());
        }
        if name.starts_with(b"TOKENS") && word(start + 8)? / 256 > length {
            return Err("the words of a binary layer of it are longer than can be packed into it".into());
        }
    }
    Ok(())
}

const CUT: &str = "a binary layer of it is cut off";

/// Checks how deep a layer of text is nested, strings, paths of assets and comments aside. Returns where comments of C
/// and C++ are, which USD has and the library has not.
fn nesting(text: &[u8]) -> Result<Vec<Range<usize>>, Refusal> {
    let mut comments = Vec::new();
    let mut depth = 0usize;
    let mut at = 0;
    while let Some(&byte) = text.get(at) {
        at += 1;
        match byte {
            0 => return Err("a layer of text of it has zero bytes".into()),
            b'{' | b'(' | b'[' => {
                depth += 1;
                if depth > MAX_DEPTH {
                    return Err(format!("a layer of it is nested deeper than {MAX_DEPTH} levels").into());
                }
            }
            b'}' | b')' | b']' => depth = depth.saturating_sub(1),
            b'#' => at += text.get(at..).unwrap_or_default().iter().take_while(|b| **b != b'\n').count(),
            b'"' | b'\'' | b'@' => at = string_end(text, at, byte),
            b'<' => {
                let rest = text.get(at..).unwrap_or_default();
                let end = rest.iter().position(|b| matches!(b, b'>' | b'\n'));
                at += end.filter(|end| rest[*end] == b'>').ok_or("a path in a layer of it is not closed")?;
            }
            b'/' if matches!(text.get(at), Some(b'/' | b'*')) => {
                let end: &[u8] = if text.get(at) == Some(&b'/') { b"\n" } else { b"*/" };
                let rest = text.get(at + 1..).unwrap_or_default();
                let length = rest.windows(end.len()).position(|w| w == end).map_or(rest.len(), |p| p + end.len());
                comments.push(at - 1..at + 1 + length);
                at += 1 + length;
            }
            _ => {}
        }
    }
    Ok(comments)
}

/// Returns a text with blanks in place of comments.
fn without_comments(text: &[u8], comments: Vec<Range<usize>>) -> Cow<'_, [u8]> {
    if comments.is_empty() {
        return Cow::Borrowed(text);
    }
    let mut text = text.to_vec();
    for range in comments {
        let blank = |byte: &mut u8| *byte = if *byte == b'\n' { b'\n' } else { b' ' };
        text.get_mut(range).unwrap_or_default().iter_mut().for_each(blank);
    }
    Cow::Owned(text)
}

/// Returns where a string ends that began before `at` with a quote, which may be tripled.
fn string_end(text: &[u8], at: usize, quote: u8) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    let triple = rest.starts_with(&[quote, quote]);
    let mut index = if triple { 2 } else { 0 };
    while let Some(&byte) = rest.get(index) {
        match byte {
            b'\\' if quote != b'@' => index += 1,
            b'\n' if !triple => break,
            byte if byte == quote => {
                if !triple {
                    return at + index + 1;
                }
                if rest.get(index..).unwrap_or_default().starts_with(&[quote; 3]) {
                    return at + index + 3;
                }
            }
            _ => {}
        }
        index += 1;
    }
    at + index.min(rest.len())
}

/// One layer, for the library to read alone.
struct Alone<'a>(&'a [u8]);

impl Resolver for Alone<'_> {
    fn create_identifier(&self, asset_path: &str, _: Option<&ResolvedPath>) -> String {
        asset_path.to_owned()
    }

    fn resolve(&self, _: &str) -> Option<ResolvedPath> {
        None
    }

    fn resolve_for_new_asset(&self, _: &str) -> Option<ResolvedPath> {
        None
    }

    fn open_asset(&self, _: &ResolvedPath) -> io::Result<Box<dyn Asset>> {
        Ok(Box::new(Cursor::new(self.0.to_vec())))
    }
}

/// Takes away what prims inherit in a circle, which the library would follow without end.
fn without_circles(text: &[u8]) -> Result<Option<Vec<u8>>, Refusal> {
    let format = LayerRegistry::find_by_id("usda").ok_or("text layers are not read")?;
    let layer = format.read(&Alone(text), &ResolvedPath::new("layer.usda"));
    let mut layer: LayerData = layer.map_err(|e| super::reason(&e))?;
    const FIELDS: [&str; 2] = ["inheritPaths", "specializes"];
    let mut edges: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for path in layer.spec_paths() {
        for field in FIELDS {
            let targets = layer.try_field(&path, field).ok().flatten().map(|v| targets(&v)).unwrap_or_default();
            edges.entry(path.as_str().to_owned()).or_default().extend(targets);
        }
    }
    edges.retain(|_, targets| !targets.is_empty());
    let circular: Vec<&String> = edges.keys().filter(|prim| goes_round(&edges, prim)).collect();
    if circular.is_empty() {
        return Ok(None);
    }
    for prim in circular {
        let path = Path::new(prim).map_err(|e| super::reason(&e))?;
        FIELDS.iter().for_each(|field| layer.erase_field(&path, field));
    }
    let text = openusd::usda::TextWriter::write_to_string(layer.as_ref()).map_err(|e| super::reason(&e))?;
    Ok(Some(text.into_bytes()))
}

fn targets(value: &Value) -> Vec<String> {
    let Value::PathListOp(list) = value else { return Vec::new() };
    let ListOp { explicit_items, added_items, prepended_items, appended_items, .. } = list;
    let all = [explicit_items, added_items, prepended_items, appended_items].into_iter().flatten();
    all.map(|p| p.as_str().to_owned()).collect()
}

/// Tells whether a prim inherits itself, what it is in, or what is in it, over any number of steps.
fn goes_round(edges: &BTreeMap<String, BTreeSet<String>>, prim: &str) -> bool {
    let inside = |a: &str, b: &str| a == b || a.strip_prefix(b).is_some_and(|rest| rest.starts_with('/'));
    let mut seen: BTreeSet<&str> = BTreeSet::new();
    let mut open: Vec<&str> = vec![prim];
    while let Some(at) = open.pop() {
        for (from, targets) in edges.iter().filter(|(from, _)| inside(from, at) || from.as_str() == at) {
            for target in targets {
                if inside(prim, target) || inside(from, target) {
                    return true;
                }
                if seen.insert(target) {
                    open.push(target);
                }
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_of_inheritance_are_cut_and_other_inheritance_stays() {
        let circle = b"#usda 1.0\ndef \"A\" (inherits = </B>) { def Cube \"x\" {} }\ndef \"B\" (inherits = </A>) {}\n";
        let text = String::from_utf8(checked(circle).unwrap().bytes).unwrap();
        assert!(!text.contains("inherits") && text.contains("Cube"), "{text}");
        let fine = b"#usda 1.0\nclass \"C\" { def Cube \"x\" {} }\ndef \"A\" (inherits = </C>) {}\n";
        assert_eq!(checked(fine).unwrap().bytes, fine);
    }

    #[test]
    fn comments_of_c_are_blanked_where_they_are_comments() {
        let text = b"#usda 1.0\n// one\ndef \"a\" { /* two\n{{{ */ string s = \"//\" asset a = @http://x@ }\n";
        let bytes = checked(text).unwrap().bytes;
        let text = String::from_utf8(bytes).unwrap();
        assert!(
            !text.contains("one") && !text.contains("two") && text.contains("\"//\"") && text.contains("@http://x@")
        );
    }

    #[test]
    fn deep_nesting_is_refused_and_brackets_in_strings_are_not_counted() {
        let deep = format!("#usda 1.0\n{}", "def \"a\" {".repeat(300));
        assert!(checked(deep.as_bytes()).err().unwrap().reason.contains("nested deeper"));
        let text = format!(
            "#usda 1.0\n# {}\ndef \"a\" {{ string s = \"\"\"{}\"\"\"\n string t = '{}' }}\n",
            "{".repeat(300),
            "[\"".repeat(300),
            "(".repeat(300)
        );
        assert!(checked(text.as_bytes()).is_ok());
    }
}
