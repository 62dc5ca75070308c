//! The prompt as it is written: text into tokens, and which of them are words that are known, numbers, measures and
//! negations. Nothing here knows a room.
//!
//! `words.toml` has how people speak, one table a language; `labels.toml` the words of plans that people bring,
//! `lookalikes.toml` words that look like a misspelling and are none.

pub(crate) mod labels;
pub(crate) mod language;
pub(crate) mod measures;
pub(crate) mod negation;
pub(crate) mod numbers;
pub(crate) mod storey;
pub(crate) mod text;
pub(crate) mod typos;
pub(crate) mod umlauts;
pub(crate) mod words;
