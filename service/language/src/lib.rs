//! Words of many languages, and what they stand for.
//!
//! A language is a folder in `data/`; no language is named in code. A [`Lexicon`] holds what words of every language stand
//! for (a [`Sense`]: a class and a value, for instance `room` and `kitchen`, or `particle` and `no`), and reads a text with
//! them: into tokens that keep their place in it, into [`Chunk`]s (the best way to take the tokens for entries of the
//! lexicon), and into the languages that it is written in. Words that are inflected, compounded or misspelled meet their
//! entry. What the words of a text mean together is not here: `prompt` knows that.
//!
//! ```
//! use d3dgen_language::Lexicon;
//!
//! let mut lexicon = Lexicon::shipped();
//! lexicon.add("de", "room", "meeting_room", "Besprechungsraum");
//! let reading = lexicon.read("drei Besprechungsräume");
//! assert_eq!(reading.languages(), ["de"]);
//! assert_eq!(reading.chunks()[0].number, Some(3.0));
//! assert!(reading.chunks()[1].is("room", "meeting_room"));
//! ```

mod chunks;
mod compounds;
mod data;
mod detect;
mod fold;
mod lexicon;
mod morphology;
mod numbers;
mod reading;
mod spelling;
mod tokens;

pub use chunks::{Chunk, Sense};
pub use data::{Error, LanguageData, Words};
pub use fold::fold;
pub use lexicon::Lexicon;
pub use reading::{Misspelling, Reading};
pub use tokens::{Token, TokenKind};
