//! Bytes to text: the charset comes from a byte order mark, the content type, the document itself, or its bytes.
//!
//! What it is not for: refusing bytes; wrong ones become replacement characters and are warned about.

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// How far into an HTML document its charset is looked for.
const META_BYTES: usize = 4096;

/// A text with what went wrong in decoding it.
#[derive(Debug)]
pub struct Decoded {
    pub text: String,
    pub warnings: Vec<String>,
}

/// Returns the text of bytes. `declares` says that the document may name its charset itself, as HTML does.
pub fn decode(bytes: &[u8], content_type: Option<&str>, declares: bool) -> Decoded {
    let mut warnings = Vec::new();
    let stated =
        content_type.and_then(charset_of_header).or_else(|| declares.then(|| charset_of_meta(bytes)).flatten());
    let encoding = match Encoding::for_bom(bytes).map(|(e, _)| e).or_else(|| utf16_of(bytes)) {
        Some(encoding) => encoding,
        // Many pages say Latin-1 and are UTF-8; valid UTF-8 with letters beyond ASCII is no accident.
        None if std::str::from_utf8(bytes).is_ok() => UTF_8,
        None => match stated {
            Some(encoding) if encoding != UTF_16LE && encoding != UTF_16BE => encoding,
            _ if mostly_utf8(bytes) => UTF_8,
            _ => WINDOWS_1252,
        },
    };
    // `decode` removes the mark, and would follow a mark against the chosen encoding only when there is one.
    let (text, _, wrong) = encoding.decode(bytes);
    if wrong {
        let count = text.matches('\u{fffd}').count();
        warnings.push(format!("{count} characters could not be read as {}", encoding.name()));
    }
    if !text.contains(['\0', '\r', '\u{c}']) {
        return Decoded { text: text.into_owned(), warnings };
    }
    let zeros = text.matches('\0').count();
    if zeros > 0 {
        warnings.push(format!("{zeros} zero bytes left out"));
    }
    // A form feed is a page break of a plain text, which also ends a paragraph.
    let text = text.replace('\0', "").replace("\r\n", "\n").replace('\r', "\n").replace('\u{c}', "\n\n");
    Decoded { text, warnings }
}

fn charset_of_header(content_type: &str) -> Option<&'static Encoding> {
    content_type.split(';').skip(1).find_map(|parameter| {
        let (key, value) = parameter.split_once('=')?;
        let label = value.trim().trim_matches(['"', '\'']);
        key.trim().eq_ignore_ascii_case("charset").then(|| Encoding::for_label(label.as_bytes()))?
    })
}

/// Finds `charset=...` in the beginning of an HTML document, or `encoding="..."` of an XML declaration.
fn charset_of_meta(bytes: &[u8]) -> Option<&'static Encoding> {
    let head = bytes.get(..META_BYTES.min(bytes.len()))?.to_ascii_lowercase();
    let head = String::from_utf8_lossy(&head);
    let marks = [("<?xml", "encoding="), ("<meta", "charset=")];
    marks.iter().find_map(|(tag, key)| {
        head.match_indices(tag).find_map(|(at, _)| {
            let inside = head.get(at..)?.split('>').next()?;
            let value = inside.split_once(key)?.1.trim_start_matches(['"', '\'', ' ']);
            let label = value.split(['"', '\'', ' ', ';', '/', '?']).next()?;
            Encoding::for_label(label.as_bytes())
        })
    })
}

/// Tells UTF-16 without a mark by the zeros of its ASCII letters.
pub fn utf16_of(bytes: &[u8]) -> Option<&'static Encoding> {
    if let Some((encoding, _)) = Encoding::for_bom(bytes) {
        return (encoding != UTF_8).then_some(encoding);
    }
    let head = bytes.get(..256.min(bytes.len()))?;
    let pairs = head.len() / 2;
    if pairs < 8 {
        return None;
    }
    let zeros = |odd: usize| head.iter().skip(odd).step_by(2).filter(|b| **b == 0).count();
    let (even, odd) = (zeros(0), zeros(1));
    match () {
        () if odd * 10 > pairs * 7 && even * 10 < pairs => Some(UTF_16LE),
        () if even * 10 > pairs * 7 && odd * 10 < pairs => Some(UTF_16BE),
        () => None,
    }
}

/// Tells whether nearly all letters beyond ASCII are UTF-8: a page with a few broken bytes.
fn mostly_utf8(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let (mut good, mut bad) = (0usize, 0usize);
    for c in text.chars().filter(|c| !c.is_ascii()) {
        if c == '\u{fffd}' { bad += 1 } else { good += 1 }
    }
    good > bad * 4
}
