//! The records of an encoded message.

use prost::encoding::{WireType, decode_key, decode_varint};

/// What one record holds.
#[derive(Debug, Clone, Copy)]
pub enum Content<'a> {
    Varint(u64),
    Fixed64([u8; 8]),
    /// Not in documents.
    Fixed32,
    Bytes(&'a [u8]),
}

/// One record: a field's number and what it holds.
#[derive(Debug, Clone, Copy)]
pub struct Record<'a> {
    pub number: u32,
    pub content: Content<'a>,
    /// The whole record as it is written.
    pub raw: &'a [u8],
}

/// Returns the next record and moves behind it; none at the end, or where nothing can be read.
pub fn next<'a>(bytes: &mut &'a [u8]) -> Option<Record<'a>> {
    let start = *bytes;
    let (number, wire) = decode_key(bytes).ok()?;
    let content = match wire {
        WireType::Varint => Content::Varint(decode_varint(bytes).ok()?),
        WireType::SixtyFourBit => Content::Fixed64(take(bytes, 8)?.try_into().ok()?),
        WireType::ThirtyTwoBit => take(bytes, 4).map(|_| Content::Fixed32)?,
        WireType::LengthDelimited => {
            let len = usize::try_from(decode_varint(bytes).ok()?).ok()?;
            Content::Bytes(take(bytes, len)?)
        }
        WireType::StartGroup | WireType::EndGroup => return None,
    };
    Some(Record { number, content, raw: &start[..start.len() - bytes.len()] })
}

/// Returns the first bytes and moves behind them.
pub fn take<'a>(bytes: &mut &'a [u8], len: usize) -> Option<&'a [u8]> {
    let (head, rest) = bytes.split_at_checked(len)?;
    *bytes = rest;
    Some(head)
}
