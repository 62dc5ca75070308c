//! The one error type of this crate: categories that mean the same whoever the provider is.

use serde::{Deserialize, Serialize};

use crate::answer::Answer;

/// Why there is no usable answer. Texts of providers are shortened, and keys are taken out of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(tag = "error", rename_all = "snake_case")]
pub enum Error {
    /// The answer hit the limit of tokens, also after one retry with twice as many.
    #[error("the answer was cut off at {limit} tokens; allow more output tokens or ask for less at once")]
    Truncated {
        /// Output tokens allowed in the last try.
        limit: u32,
        /// What had been said; its JSON and its end are not to be trusted.
        partial: Option<Box<Answer>>,
    },
    /// The model declined.
    #[error("the model refused: {reason}; reword the request")]
    Refused {
        /// In the model's words.
        reason: String,
    },
    /// A filter of the provider stopped the prompt or the answer; what had been said is not kept.
    #[error("the provider blocked the exchange ({reason}); reword the request or use another provider")]
    Blocked {
        /// The provider's name of the reason.
        reason: String,
    },
    /// Too many requests for now.
    #[error("too many requests: {message}{}", .hint.as_deref().map(|h| format!("; {h}")).unwrap_or_default())]
    RateLimited {
        /// How long the provider asks to wait, if it says so.
        retry_after_ms: Option<u64>,
        /// What may be behind it.
        hint: Option<String>,
        /// In the provider's words.
        message: String,
    },
    /// The quota of a day or the money is used up: waiting seconds does not help.
    #[error("quota is used up: {message}; raise it with the provider, or go on with what was gathered")]
    QuotaExhausted {
        /// In the provider's words.
        message: String,
    },
    /// The provider is not there, overloaded, or broke off.
    #[error("the provider is not available: {message}; try again later")]
    Unavailable {
        /// HTTP status, if there was an answer.
        status: Option<u16>,
        /// How long the provider asks to wait, if it says so.
        retry_after_ms: Option<u64>,
        /// In the provider's words, or of the connection.
        message: String,
    },
    /// No complete answer in the time allowed.
    #[error("no complete answer within {after_ms} ms; allow more time or ask for less")]
    Timeout {
        /// The time allowed, in milliseconds.
        after_ms: u64,
        /// Whether nothing at all had arrived.
        before_first_byte: bool,
    },
    /// The key is missing, wrong or not entitled.
    #[error("the provider does not accept the key: {message}; check the key and what it may use")]
    Auth {
        /// In the provider's words.
        message: String,
    },
    /// The provider does not take the request as it is.
    #[error("the provider does not accept the request: {message}")]
    BadRequest {
        /// In the provider's words.
        message: String,
    },
    /// There is no such model (any more).
    #[error("model {model} is not available: {message}; choose another one in the configuration")]
    ModelNotFound {
        /// As configured.
        model: String,
        /// In the provider's words.
        message: String,
    },
    /// The prompt does not fit.
    #[error("the prompt is too long: {message}; send smaller chunks")]
    TooLong {
        /// In the provider's words.
        message: String,
    },
    /// The response is larger than the limit.
    #[error("the response is larger than {limit_bytes} bytes; raise the limit if that is expected")]
    TooLarge {
        /// Bytes allowed.
        limit_bytes: u64,
    },
    /// The provider says it succeeded, yet what it sent cannot be read.
    #[error("the response cannot be read: {message}; check the base URL and that the server speaks this protocol")]
    BadResponse {
        /// What is wrong with it.
        message: String,
    },
    /// The answer does not match the schema, also after one retry that showed what is wrong.
    #[error("the answer does not match the schema: {}; ask for less at once or use a stronger model", .problems.join("; "))]
    InvalidAnswer {
        /// What the check says, one entry a problem.
        problems: Vec<String>,
        /// The start of the answer.
        text: String,
    },
    /// The next call could pass the budget, so it was not made.
    #[error("the next call may need {needs}, and {left} is left of the budget; raise the budget or stop here")]
    Budget {
        /// What the call may need at most, with unit.
        needs: String,
        /// What is left, with unit.
        left: String,
    },
    /// The configuration or the request is not usable.
    #[error("{message}")]
    Config {
        /// What is wrong, and what to do.
        message: String,
    },
    /// The recording has no answer to this request.
    #[error("the recording has no answer to request {key} of stage {stage}; record it again")]
    NotRecorded {
        /// Key of the request.
        key: String,
        /// Label of the request.
        stage: String,
    },
}

impl Error {
    /// Returns the name of the category, as in recordings and execution tables.
    pub fn category(&self) -> &'static str {
        match self {
            Self::Truncated { .. } => "truncated",
            Self::Refused { .. } => "refused",
            Self::Blocked { .. } => "blocked",
            Self::RateLimited { .. } => "rate_limited",
            Self::QuotaExhausted { .. } => "quota_exhausted",
            Self::Unavailable { .. } => "unavailable",
            Self::Timeout { .. } => "timeout",
            Self::Auth { .. } => "auth",
            Self::BadRequest { .. } => "bad_request",
            Self::ModelNotFound { .. } => "model_not_found",
            Self::TooLong { .. } => "too_long",
            Self::TooLarge { .. } => "too_large",
            Self::BadResponse { .. } => "bad_response",
            Self::InvalidAnswer { .. } => "invalid_answer",
            Self::Budget { .. } => "budget",
            Self::Config { .. } => "config",
            Self::NotRecorded { .. } => "not_recorded",
        }
    }

    /// Returns how long the provider asks to wait, in milliseconds.
    pub fn retry_after_ms(&self) -> Option<u64> {
        match self {
            Self::RateLimited { retry_after_ms, .. } | Self::Unavailable { retry_after_ms, .. } => *retry_after_ms,
            _ => None,
        }
    }

    /// Returns whether a whole run has to stop: every further call would fail the same way.
    pub fn stops_run(&self) -> bool {
        matches!(
            self,
            Self::QuotaExhausted { .. }
                | Self::Auth { .. }
                | Self::ModelNotFound { .. }
                | Self::Budget { .. }
                | Self::Config { .. }
        )
    }

    /// Makes a [`Error::Config`].
    pub(crate) fn config(message: impl Into<String>) -> Self {
        Self::Config { message: message.into() }
    }

    /// Makes a [`Error::BadResponse`].
    pub(crate) fn bad_response(message: impl Into<String>) -> Self {
        Self::BadResponse { message: message.into() }
    }

    /// Applies `f` to every text that came from outside.
    pub(crate) fn map_text(mut self, f: &dyn Fn(&str) -> String) -> Self {
        match &mut self {
            Self::Refused { reason: text } | Self::Blocked { reason: text } => *text = f(text),
            Self::RateLimited { message, .. }
            | Self::QuotaExhausted { message }
            | Self::Unavailable { message, .. }
            | Self::Auth { message }
            | Self::BadRequest { message }
            | Self::ModelNotFound { message, .. }
            | Self::TooLong { message }
            | Self::BadResponse { message }
            | Self::Config { message } => *message = f(message),
            Self::InvalidAnswer { problems, text } => {
                *text = f(text);
                problems.iter_mut().for_each(|p| *p = f(p));
            }
            _ => {}
        }
        self
    }
}
