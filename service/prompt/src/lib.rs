//! Reads prompts by rules: words become a [`Brief`], fact by fact.
//!
//! The words come from `language` and from the domains; what they mean together is a grammar of data in `grammar/`, a file
//! for each step. A rule is a pattern over words and over what earlier rules found, with a weight that settles conflicts and
//! with examples that are its tests. No language is named in code or grammar. Every word of a prompt ends in a fact, in the
//! kind of building, in the place, is a small word, or stands in [`Brief::not_understood`]; nothing is dropped in silence.
//! What a building needs beside what was said is not here: `program` completes a brief.
//!
//! ```
//! use d3dgen_model::brief::Fact;
//! use d3dgen_plugins::Registry;
//! use d3dgen_prompt::PromptReader;
//!
//! let reader = PromptReader::new(&Registry::builtin());
//! let brief = reader.read("Wohnung mit drei Schlafzimmern in Wien").brief;
//! assert_eq!(brief.languages, ["de"]);
//! assert_eq!(brief.place.expect("it is named").country_code, "AT");
//! let Fact::Rooms(rooms) = &brief.asks[0].fact else { panic!("rooms are asked for") };
//! assert_eq!((rooms.room.id.as_deref(), rooms.count.n), (Some("bedroom"), 3));
//! ```

mod building;
mod facts;
mod grammar;
mod homes;
mod likely;
mod node;
mod parse;
mod pattern;
mod places;
mod reader;
mod shown;
mod storeys;
mod subjects;
mod vocabulary;

pub use d3dgen_model::brief::Brief;
pub use grammar::Error;
pub use reader::{PromptReader, ReadPrompt, Step};
