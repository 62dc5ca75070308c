//! Ids that a person can read and that depend on nothing but what they stand for.

use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};

/// Returns lower-case words joined by `_`, at most `limit` bytes; German letters in their ASCII spelling.
pub fn slug(text: &str, limit: usize) -> String {
    let mut out = String::new();
    for c in text.chars().flat_map(char::to_lowercase) {
        match c {
            'ä' => out.push_str("ae"),
            'ö' => out.push_str("oe"),
            'ü' => out.push_str("ue"),
            'ß' => out.push_str("ss"),
            'é' | 'è' | 'ê' => out.push('e'),
            'á' | 'à' | 'â' => out.push('a'),
            c if c.is_ascii_alphanumeric() => out.push(c),
            _ if out.ends_with('_') || out.is_empty() => {}
            _ => out.push('_'),
        }
    }
    out.truncate(limit);
    out.trim_end_matches('_').to_owned()
}

/// Returns a slug; one that had to be cut ends with a hash of the whole, so that two long titles stay apart.
pub fn whole_slug(text: &str, limit: usize) -> String {
    let long = slug(text, usize::MAX);
    if long.len() <= limit { long } else { format!("{}_{}", slug(text, limit), &hash(&long)[..4]) }
}

/// Returns eight hexadecimal digits of the SHA-256 of a text.
pub fn hash(text: &str) -> String {
    HEXLOWER.encode(&Sha256::digest(text)[..4])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slugs_are_plain_and_stay_apart() {
        assert_eq!(slug("ASR A1.8 – Verkehrswege für Büros", 48), "asr_a1_8_verkehrswege_fuer_bueros");
        assert_eq!(slug("  ", 8), "");
        let long =
            |n: u32| whole_slug(&format!("Design guidelines for hospitals and day procedure centers, part {n}"), 48);
        assert_ne!(long(1), long(2));
        assert!(long(1).len() <= 53);
    }
}
