//! Finds building rules in text: sentences in, typed constraints out, each with the sentence that says so.
//!
//! What it is not for: reading files or the network, and judging whether a rule is law. It uses no language model. All
//! words it knows (units, comparators, spaces, quantities, cues of duty and of report) are data: `data/*.toml`.

pub mod corpus;
mod error;
pub mod extract;
pub mod fetch;
pub mod jsonl;
pub mod read;
pub mod run;
pub mod synthesis;

pub use error::Error;
