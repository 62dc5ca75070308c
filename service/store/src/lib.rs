//! Embedded storage: records behind a key-value trait, and the full text and vector indexes derived from them.

pub mod error;

pub use error::{Error, Result};
