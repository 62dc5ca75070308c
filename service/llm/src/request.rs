//! One request, the same for all providers. What a provider makes of it is in `providers/`.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::schema::Schema;

/// Output tokens that a request has at least, unless it says otherwise: thinking counts against them, and a smaller
/// allowance is used up before the first word of the answer.
pub const MIN_OUTPUT_TOKENS: u32 = 4096;

/// What to ask.
#[derive(Debug, Clone)]
pub struct Request {
    /// Label for the execution table, such as `infer` or `research/egress`.
    pub stage: String,
    /// Instructions; text of others belongs into messages.
    pub system: Option<String>,
    /// The conversation; the last one is the user's.
    pub messages: Vec<Message>,
    /// Asks for JSON of this form. With [`Request::grounding`] this becomes two calls: prose with sources, then JSON.
    pub schema: Option<Schema>,
    /// Lets the model search the web.
    pub grounding: Option<Grounding>,
    /// Output tokens allowed, thoughts included.
    pub max_output_tokens: u32,
    /// Time for one try.
    pub timeout: Duration,
}

impl Request {
    /// Makes a request of one user message, with [`MIN_OUTPUT_TOKENS`] and two minutes.
    pub fn new(stage: impl Into<String>, user: impl Into<String>) -> Self {
        Self {
            stage: stage.into(),
            system: None,
            messages: vec![Message { role: Role::User, text: user.into() }],
            schema: None,
            grounding: None,
            max_output_tokens: MIN_OUTPUT_TOKENS,
            timeout: Duration::from_secs(120),
        }
    }

    /// Sets the instructions.
    pub fn with_system(mut self, system: impl Into<String>) -> Self {
        self.system = Some(system.into());
        self
    }

    /// Asks for JSON.
    pub fn with_schema(mut self, schema: Schema) -> Self {
        self.schema = Some(schema);
        self
    }

    /// Lets the model search.
    pub fn with_grounding(mut self, grounding: Grounding) -> Self {
        self.grounding = Some(grounding);
        self
    }

    /// Returns the length of all that is sent, in bytes.
    pub fn prompt_bytes(&self) -> usize {
        let schema = self.schema.as_ref().map_or(0, |s| s.wire().to_string().len());
        self.system.as_ref().map_or(0, String::len) + self.messages.iter().map(|m| m.text.len()).sum::<usize>() + schema
    }

    /// Returns a guess of the tokens of the prompt, rather too many than too few: three bytes a token, while English
    /// and German prose have four to five.
    pub fn estimated_input_tokens(&self) -> u64 {
        estimated_tokens(self.prompt_bytes())
    }

    /// # Errors
    /// [`Error::Config`] for a request that no provider takes.
    pub(crate) fn check(&self) -> Result<(), Error> {
        if self.messages.last().is_none_or(|m| m.role != Role::User) {
            return Err(Error::config("the last message of a request has to be the user's"));
        }
        if self.max_output_tokens == 0 {
            return Err(Error::config("a request needs at least one output token"));
        }
        Ok(())
    }
}

/// Returns a guess of the tokens of a text of so many bytes.
pub(crate) fn estimated_tokens(bytes: usize) -> u64 {
    (bytes as u64).div_ceil(3)
}

/// One turn of the conversation.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Message {
    /// Who speaks.
    pub role: Role,
    /// What is said.
    pub text: String,
}

/// Who speaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// The one who asks.
    User,
    /// The model.
    Assistant,
}

/// How a model may search the web.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Grounding {
    /// Searches that are budgeted for; providers that take a limit are given it.
    pub max_searches: u32,
    /// ISO 3166-1 alpha-2 code of the country to search from, where the provider takes one.
    pub country: Option<String>,
    /// Only pages of these domains, where the provider takes a list; empty means all.
    pub allowed_domains: Vec<String>,
}

impl Default for Grounding {
    /// Ten searches: what one grounded call has been seen to run at most.
    fn default() -> Self {
        Self { max_searches: 10, country: None, allowed_domains: Vec::new() }
    }
}
