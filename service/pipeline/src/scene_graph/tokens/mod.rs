//! The prompt as it is written: text into tokens, and which of them are words that are known, numbers, measures and
//! negations. Nothing here knows a room.
//!
//! `words.toml` has how people speak, one table a language; `labels.toml` the words of plans that people bring,
//! `lookalikes.toml` words that look like a misspelling and are none.

pub(super) mod labels;
pub(super) mod language;
pub(super) mod measures;
pub(super) mod negation;
pub(super) mod numbers;
pub(super) mod storey;
pub(super) mod text;
pub(super) mod typos;
pub(super) mod umlauts;
pub(super) mod words;
