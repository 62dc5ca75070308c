//! The providers: one file each, and the list of them.
//!
//! A provider turns a [`Request`] into its own wire format and what comes back into an [`Answer`] or a category of
//! error. It asks once: retries, budget and the check of JSON are the client's. A new one is a new file and one entry
//! in [`all`].

mod anthropic;
mod config;
mod gemini;
mod gemini_interactions;
mod http;
mod ollama;
mod openai;
mod openai_responses;
mod replay;

use std::collections::BTreeSet;
use std::future::Future;
use std::pin::Pin;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::answer::{Answer, Usage};
use crate::error::Error;
use crate::request::Request;

pub use config::{Config, Structured, TokenField};
pub use replay::{Recorder, Replay};

/// A future that may be sent between threads.
pub type BoxFuture<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;

/// Something that answers requests.
pub trait Provider: Send + Sync {
    /// Returns its name in [`all`].
    fn name(&self) -> &str;

    /// Returns the model it asks.
    fn model(&self) -> &str;

    /// Asks once. JSON is returned as text, unless the provider parses it itself.
    fn ask<'a>(&'a self, request: &'a Request, tweaks: &'a Tweaks) -> BoxFuture<'a, Result<Turn, Failure>>;

    /// Returns the names of the models on offer.
    fn models(&self) -> BoxFuture<'_, Result<Vec<String>, Failure>>;

    /// Returns a change to try when an answer is no valid JSON.
    fn fix_for_invalid(&self) -> Option<Fix> {
        None
    }
}

/// What differs from the plain request in a further try.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tweaks {
    /// Changes to the wire format.
    pub fixes: BTreeSet<Fix>,
    /// What the provider said before it paused, to be sent back unchanged.
    pub resume: Vec<Value>,
}

/// A change to the wire format that a provider's error asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fix {
    /// Says nothing about thinking.
    WithoutThinking,
    /// The other one of `max_tokens` and `max_completion_tokens`.
    OtherTokenField,
    /// Says nothing about temperature.
    WithoutTemperature,
    /// A tool that has to be called, instead of an output format.
    ForcedTool,
    /// The schema in the instructions, instead of a response format.
    SchemaInPrompt,
    /// Thinking on instead of off, or off instead of on.
    OtherThink,
}

/// What a provider says when all went well.
#[derive(Debug, Clone, PartialEq)]
pub enum Turn {
    /// The answer.
    Done(Box<Answer>),
    /// It wants to be asked again with this as [`Tweaks::resume`].
    Paused {
        /// All it has said so far.
        resume: Vec<Value>,
        /// Used so far.
        usage: Usage,
    },
}

/// What a provider says when something went wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// What it was.
    pub error: Error,
    /// A change that would help.
    pub fix: Option<Fix>,
    /// The provider's own word on whether to try again.
    pub should_retry: Option<bool>,
    /// Used for nothing.
    pub usage: Usage,
}

impl Default for Failure {
    fn default() -> Self {
        Error::bad_response("no answer").into()
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self { error, fix: None, should_retry: None, usage: Usage::default() }
    }
}

impl Failure {
    /// Sets what was used for nothing.
    pub(crate) fn with_usage(mut self, usage: Usage) -> Self {
        self.usage = usage;
        self
    }
}

/// A provider on offer.
pub struct Entry {
    /// Its name in configurations.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
    /// Where it is, unless the configuration says otherwise.
    pub base_url: &'static str,
    /// The variable of the environment that holds its key by custom; this crate reads none.
    pub key_variable: Option<&'static str>,
    /// Whether it can search the web.
    pub searches: bool,
    /// Makes it.
    pub build: fn(Config) -> Result<Box<dyn Provider>, Error>,
}

/// Returns all providers that are reached over the network. [`Replay`] is made from a recording instead.
pub fn all() -> &'static [Entry] {
    &[
        gemini::ENTRY,
        gemini_interactions::ENTRY,
        openai::ENTRY,
        openai_responses::ENTRY,
        anthropic::ENTRY,
        ollama::ENTRY,
    ]
}

/// Makes the provider that a configuration names.
///
/// # Errors
/// [`Error::Config`] if there is none of that name, or a value is not usable.
pub fn build(config: Config) -> Result<Box<dyn Provider>, Error> {
    let Some(entry) = all().iter().find(|e| e.name == config.provider) else {
        let names: Vec<&str> = all().iter().map(|e| e.name).collect();
        return Err(Error::config(format!("no provider `{}`; choose one of {}", config.provider, names.join(", "))));
    };
    (entry.build)(config)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_usable() {
        let names: BTreeSet<&str> = all().iter().map(|e| e.name).collect();
        assert_eq!(names.len(), all().len());
        for entry in all() {
            let provider = build(Config::new(entry.name, "some-model")).unwrap();
            assert_eq!((provider.name(), provider.model()), (entry.name, "some-model"));
            assert!(!entry.about.is_empty());
        }
        assert!(build(Config::new("nobody", "m")).err().unwrap().to_string().contains("gemini"));
    }
}
