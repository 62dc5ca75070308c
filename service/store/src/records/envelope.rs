//! What surrounds a payload: a checksum over table, key and payload, so that damage, and a value that slipped under
//! another key, is noticed before it is handed out.
//!
//! Layout: XXH3-64 (8 bytes, little endian) of all that follows, seeded with [`key_hash`];
//! then the record format (1 byte); then the payload.

use twox_hash::XxHash3_64;

/// Format of a record: the payload as it is.
const PLAIN: u8 = 1;

const CHECKSUM: usize = 8;

/// Surrounds `payload`.
pub(crate) fn wrap(table: &str, key: &[u8], payload: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(CHECKSUM + 1 + payload.len());
    bytes.extend_from_slice(&[0; CHECKSUM]);
    bytes.push(PLAIN);
    bytes.extend_from_slice(payload);
    let (checksum, rest) = bytes.split_at_mut(CHECKSUM);
    checksum.copy_from_slice(&XxHash3_64::oneshot_with_seed(key_hash(table, key), rest).to_le_bytes());
    bytes
}

/// Returns the payload, or what is wrong.
pub(crate) fn unwrap<'a>(table: &str, key: &[u8], bytes: &'a [u8]) -> Result<&'a [u8], String> {
    let Some((checksum, rest)) = bytes.split_first_chunk::<CHECKSUM>() else {
        return Err(format!("{} bytes are too few", bytes.len()));
    };
    if u64::from_le_bytes(*checksum) != XxHash3_64::oneshot_with_seed(key_hash(table, key), rest) {
        return Err("its checksum differs".to_owned());
    }
    match rest.split_first() {
        Some((&PLAIN, payload)) => Ok(payload),
        Some((format, _)) => Err(format!("record format {format} is unknown to this release")),
        None => Err("it has no record format".to_owned()),
    }
}

/// Returns the hash of a table's key.
pub(crate) fn key_hash(table: &str, key: &[u8]) -> u64 {
    XxHash3_64::oneshot_with_seed(XxHash3_64::oneshot(table.as_bytes()), key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flipped_bit_and_every_cut_is_noticed() {
        let whole = wrap("rooms", b"kitchen", b"at least 6 m2");
        assert_eq!(unwrap("rooms", b"kitchen", &whole), Ok(&b"at least 6 m2"[..]));
        for bit in 0..whole.len() * 8 {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert!(unwrap("rooms", b"kitchen", &bytes).is_err(), "bit {bit}");
        }
        for length in 0..whole.len() {
            assert!(unwrap("rooms", b"kitchen", &whole[..length]).is_err(), "{length} bytes");
        }
    }

    #[test]
    fn a_value_belongs_to_its_key_and_table() {
        let whole = wrap("rooms", b"kitchen", b"x");
        for (table, key) in [("rooms", "kitchens"), ("room", "skitchen"), ("doors", "kitchen")] {
            assert!(unwrap(table, key.as_bytes(), &whole).is_err(), "{table} {key}");
        }
    }
}
