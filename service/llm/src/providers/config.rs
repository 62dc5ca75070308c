//! What a provider is told by its configuration. Nothing here is read from files or the environment.

use serde::Deserialize;

use crate::error::Error;
use crate::secret::Secret;

/// Largest response, unpacked, that is accepted by default, in bytes.
const RESPONSE_LIMIT_BYTES: u64 = 8 * 1024 * 1024;

/// Configuration of one provider with one model.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Name of the provider, as in [`super::all`].
    pub provider: String,
    /// Name of the model, as the provider has it today.
    pub model: String,
    /// Where the provider is; its own address if missing.
    #[serde(default)]
    pub base_url: Option<String>,
    /// The key; never part of a configuration file.
    #[serde(skip)]
    pub key: Option<Secret>,
    /// How much to think, by the provider's own word (`low`, `medium`, ...); its default if missing.
    #[serde(default)]
    pub thinking: Option<String>,
    /// Sampling temperature; several providers no longer take one.
    #[serde(default)]
    pub temperature: Option<f64>,
    /// Sampling seed, where there is one.
    #[serde(default)]
    pub seed: Option<u64>,
    /// How to ask for JSON.
    #[serde(default)]
    pub structured: Structured,
    /// How to say the limit of tokens (chat completions only).
    #[serde(default)]
    pub token_field: Option<TokenField>,
    /// Context of a local model in tokens (Ollama only); fitted to the request if missing.
    #[serde(default)]
    pub context_tokens: Option<u32>,
    /// Name of the search tool's version (Anthropic only).
    #[serde(default = "web_search_tool")]
    pub web_search_tool: String,
    /// Whether to have answers streamed (Gemini only).
    #[serde(default)]
    pub stream: bool,
    /// Largest response, unpacked, in bytes.
    #[serde(default = "response_limit_bytes")]
    pub response_limit_bytes: u64,
}

/// How to ask for JSON.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Structured {
    /// By the provider's output format.
    #[default]
    Format,
    /// By a tool that has to be called, for older models (Anthropic only).
    Tool,
    /// By the instructions only, for servers that know neither (chat completions only).
    Prompt,
}

/// How to say the limit of tokens.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TokenField {
    /// `max_tokens`, for compatible servers.
    MaxTokens,
    /// `max_completion_tokens`, for OpenAI itself.
    MaxCompletionTokens,
}

fn web_search_tool() -> String {
    "web_search_20250305".to_owned()
}

fn response_limit_bytes() -> u64 {
    RESPONSE_LIMIT_BYTES
}

impl Config {
    /// Makes a configuration with defaults.
    pub fn new(provider: impl Into<String>, model: impl Into<String>) -> Self {
        Self {
            provider: provider.into(),
            model: model.into(),
            base_url: None,
            key: None,
            thinking: None,
            temperature: None,
            seed: None,
            structured: Structured::default(),
            token_field: None,
            context_tokens: None,
            web_search_tool: web_search_tool(),
            stream: false,
            response_limit_bytes: RESPONSE_LIMIT_BYTES,
        }
    }

    /// Returns `base/version/tail`; a base that ends in the version already is left so.
    ///
    /// # Errors
    /// [`Error::Config`] if the base is no http or https URL, holds a password or a query, or would carry a key in the
    /// clear to another machine.
    pub(crate) fn url(&self, default: &str, version: &str, tail: &str) -> Result<String, Error> {
        let base = self.base_url.as_deref().unwrap_or(default);
        let url = reqwest::Url::parse(base)
            .map_err(|e| Error::config(format!("base URL is not usable ({e}); write it like {default}")))?;
        let host = url.host_str().unwrap_or_default();
        let ip = host.trim_matches(['[', ']']).parse::<std::net::IpAddr>();
        let local = host == "localhost" || ip.is_ok_and(|ip| ip.is_loopback());
        if !matches!(url.scheme(), "http" | "https") || host.is_empty() {
            return Err(Error::config(format!("base URL has to begin with https:// or http://, like {default}")));
        }
        if !url.username().is_empty() || url.password().is_some() || url.query().is_some() || url.fragment().is_some() {
            return Err(Error::config("base URL has to be without user, password, query and fragment; keys go apart"));
        }
        if url.scheme() == "http" && !local && self.key.as_ref().is_some_and(|k| !k.is_empty()) {
            return Err(Error::config(
                "the key would travel in the clear to another machine; use https or leave it out",
            ));
        }
        let base = url.as_str().trim_end_matches('/');
        let versioned = if version.is_empty() || base.ends_with(&format!("/{version}")) {
            base.to_owned()
        } else {
            format!("{base}/{version}")
        };
        Ok(format!("{versioned}/{tail}"))
    }

    /// Returns the name of the model for a path.
    ///
    /// # Errors
    /// [`Error::Config`] if it has characters that would change the path.
    pub(crate) fn model_in_path(&self) -> Result<&str, Error> {
        let plain = |b: u8| b.is_ascii_alphanumeric() || b"._-:@/".contains(&b);
        if self.model.is_empty() || self.model.contains("..") || !self.model.bytes().all(plain) {
            return Err(Error::config(format!("model name `{}` has characters that no model name has", self.model)));
        }
        Ok(&self.model)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn url(base: &str, key: Option<&str>) -> Result<String, Error> {
        let mut config = Config::new("openai", "m");
        (config.base_url, config.key) = (Some(base.to_owned()), key.map(Secret::new));
        config.url("https://api.test", "v1", "chat")
    }

    #[test]
    fn base_urls_are_joined_and_checked() {
        let check = |base, expected| assert_eq!(url(base, Some("k")).as_deref(), Ok(expected));
        check("https://a.test", "https://a.test/v1/chat");
        check("https://a.test/v1/", "https://a.test/v1/chat");
        check("http://127.0.0.1:8080", "http://127.0.0.1:8080/v1/chat");
        check("http://[::1]:8080/x", "http://[::1]:8080/x/v1/chat");
        assert!(url("http://10.0.0.5:8080", None).is_ok());
        for (base, says) in [
            ("http://10.0.0.5:8080", "in the clear"),
            ("http://127.0.0.1.evil.test", "in the clear"),
            ("ftp://a.test", "https://"),
            ("https://u:p@a.test", "keys go apart"),
            ("https://a.test?key=k", "keys go apart"),
            ("nonsense", "not usable"),
        ] {
            assert!(url(base, Some("k")).unwrap_err().to_string().contains(says), "{base}");
        }
    }

    #[test]
    fn a_configuration_file_cannot_hold_a_key() {
        let read = |text: &str| toml::from_str::<Config>(text);
        assert_eq!(read("provider = 'openai'\nmodel = 'm'").unwrap().response_limit_bytes, RESPONSE_LIMIT_BYTES);
        assert!(read("provider = 'openai'\nmodel = 'm'\nkey = 'k'").is_err());
    }
}
