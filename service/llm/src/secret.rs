//! Keys that cannot be printed, and texts of others with keys taken out. It does not know where a key comes from.

use std::fmt;

/// Stands where a key was.
const REDACTED: &str = "[redacted]";
/// The shortest piece of a key that is taken out of any text; shorter pieces occur in ordinary words.
const PIECE: usize = 6;
/// The shortest head or tail of a key that is taken out where it stands as a word of its own.
const TAIL: usize = 4;

/// The key of a provider. Neither `Debug` nor an error nor a recording shows it.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret(String);

impl Secret {
    /// Wraps a key; white space around it, as a file or a shell leaves, is dropped.
    pub fn new(key: impl AsRef<str>) -> Self {
        Self(key.as_ref().trim().to_owned())
    }

    /// Returns whether there is no key.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the key, for a header and for nothing else.
    pub(crate) fn expose(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Secret([redacted])")
    }
}

/// Returns `text` without `key`, without pieces of it, and without anything that looks like a masked or foreign key.
pub(crate) fn redact(text: &str, key: Option<&Secret>) -> String {
    let text = match key {
        Some(key) if key.0.len() >= TAIL => text.replace(&key.0, REDACTED),
        _ => text.to_owned(),
    };
    let mut out = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while !rest.is_empty() {
        let word_end = rest.find(|c| !in_word(c)).unwrap_or(rest.len());
        let (word, tail) = rest.split_at(word_end);
        // A full stop or a bracket at the end belongs to the sentence.
        let core = word.trim_end_matches(['.', '[', ']']);
        out.push_str(if is_secret(core, key) { REDACTED } else { core });
        out.push_str(&word[core.len()..]);
        let gap_end = tail.find(in_word).unwrap_or(tail.len());
        out.push_str(&tail[..gap_end]);
        rest = &tail[gap_end..];
    }
    out
}

/// Characters that keys and their masks are written with.
fn in_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '*' | '.' | '…' | '•' | '+' | '/' | '=' | '[' | ']')
}

/// Returns whether a word is a key, a masked key, or holds a piece of `key`.
fn is_secret(word: &str, key: Option<&Secret>) -> bool {
    if word.is_empty() || REDACTED.starts_with(word) {
        return false;
    }
    let word = word.trim_start_matches('[');
    let masked = word.contains("**") || word.contains("••");
    let known = ["sk-", "sk_", "AIza", "AQ.", "gsk_", "hf_", "xai-"].iter().any(|p| word.starts_with(p));
    if (masked && word.chars().any(|c| c.is_ascii_alphanumeric())) || (known && word.len() >= 8) {
        return true;
    }
    let Some(key) = key.map(Secret::expose).filter(|k| k.is_ascii() && k.len() >= TAIL) else { return false };
    let is_end = |piece: &str| piece.len() >= TAIL && (key.starts_with(piece) || key.ends_with(piece));
    let end_of_key = is_end(word) || word.split(['.', '…', '*']).any(is_end);
    // Short keys are stand-ins of local servers ("local", "none"), whose pieces are ordinary words.
    let piece_of_key = key.len() >= 2 * PIECE && (0..=key.len() - PIECE).any(|i| word.contains(&key[i..i + PIECE]));
    end_of_key || piece_of_key
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_pieces_of_keys_are_taken_out() {
        let key = Secret::new(" sk-fx1234567890abcdefWXYZ\n");
        let check = |text: &str, expected: &str| assert_eq!(redact(text, Some(&key)), expected);
        check("key sk-fx1234567890abcdefWXYZ is bad", "key [redacted] is bad");
        check("provided: sk-fx************WXYZ. You can", "provided: [redacted]. You can");
        check("key ending in WXYZ.", "key ending in [redacted].");
        check("'sk-fx12...'", "'[redacted]...'");
        check("sk-f...WXYZ or ...WXYZ", "[redacted] or [redacted]");
        check("got 567890abcd", "got [redacted]");
        check("url?key=sk-fx1234567890abcdefWXYZ&x=1", "url?key=[redacted]&x=1");
        check("Rate limit 500, used 500 of gpt-5.4-mini", "Rate limit 500, used 500 of gpt-5.4-mini");
        check("maße ** größe 1 ** 2", "maße ** größe 1 ** 2");
        assert_eq!(redact("foreign AIzaSyA-secret-key here", None), "foreign [redacted] here");
    }

    #[test]
    fn a_secret_does_not_print() {
        assert!(!format!("{:?}", Secret::new("sk-verysecret")).contains("very"));
    }
}
