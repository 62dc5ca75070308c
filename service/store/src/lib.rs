//! Embedded storage: records behind a key-value trait, and the full text and vector indexes derived from them.
//!
//! Records are the truth: checked by checksum whenever they are read, changed in batches that are stored whole or not
//! at all. Indexes are derived from them and may be thrown away. What records mean is not known here.
//!
//! | module | what |
//! |---|---|
//! | [`kv`] | the trait, and its backends `redb` and `sled` |
//! | [`records`] | [`Store`]: open, read, change, verify |
//! | [`snapshot`] | one file with all records, and the way back; also from one backend to the other |
//! | `format` | `store.json` and upgrades |
//! | `lock` | one writer at a time |
//! | [`index`] | full text, vectors and filters over documents made of records |
//! | [`embed`] | texts to vectors |

pub mod embed;
pub mod error;
mod files;
mod format;
pub mod index;
pub mod kv;
mod lock;
pub mod records;
pub mod snapshot;

pub use error::{Error, Result, is_full};
pub use format::FORMAT;
pub use kv::{Backend, Batch, KeyRange};
pub use records::{Access, Options, Problem, Progress, Record, Records, Store, View};
