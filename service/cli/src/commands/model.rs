//! The language model of a command: which one, its key from the environment, what it may cost.

use std::collections::BTreeMap;

use d3dgen_llm::providers::{Replay, all, build};
use d3dgen_llm::{Budget, Client, Config, Limits, Prices, RetryPolicy, Secret};

use crate::error::Error;

/// Name of the provider that answers from a file.
const REPLAY: &str = "replay";

/// Flags of the model.
#[derive(clap::Args)]
pub struct LlmArgs {
    /// Language model to use, such as gemini:gemini-3.8-flash or ollama:llama3; replay:FILE answers from a recording
    #[arg(long, value_name = "PROVIDER:MODEL")]
    pub model: Option<String>,
    /// Address of the provider, for compatible and local servers
    #[arg(long, value_name = "URL", requires = "model")]
    pub base_url: Option<String>,
    /// How much the model may think, in the provider's word
    #[arg(long, value_name = "LEVEL", requires = "model")]
    pub thinking: Option<String>,
    /// Most tokens that the run may use, prompts and answers together
    #[arg(long, value_name = "N", requires = "model")]
    pub budget_tokens: Option<u64>,
    /// Most money that the run may cost, in US dollars; needs --price
    #[arg(long, value_name = "USD", requires = "price")]
    pub budget_usd: Option<f64>,
    /// US dollars for a million tokens in and out, and for one search, such as 0.30,2.50,0.014
    #[arg(long, value_name = "IN,OUT[,SEARCH]", requires = "model")]
    pub price: Option<String>,
}

impl LlmArgs {
    /// Returns the client of the model, none when none is named.
    ///
    /// # Errors
    /// `Input` for unknown providers, missing keys and prices that are none.
    pub fn client(&self) -> Result<Option<Client>, Error> {
        let Some((provider, model)) = self.named()? else { return Ok(None) };
        let input = |e: d3dgen_llm::Error| Error::Input(format!("--model {provider}: {e}"));
        let prices = self.price.as_deref().map(prices).transpose()?;
        let limits = Limits { max_tokens: self.budget_tokens, max_cost: self.budget_usd };
        let budget = Budget::new(limits, prices.map(|p| BTreeMap::from([(String::new(), p)])).unwrap_or_default());
        if provider == REPLAY {
            let path = std::path::PathBuf::from(model);
            let text = std::fs::read_to_string(&path).map_err(|source| Error::Read { path, source })?;
            let replay = Replay::new(&text).map_err(input)?;
            return Ok(Some(Client::new(Box::new(replay), RetryPolicy::default(), budget)));
        }
        let mut config = Config::new(provider, model);
        config.base_url.clone_from(&self.base_url);
        config.thinking.clone_from(&self.thinking);
        let variable = all().iter().find(|e| e.name == provider).and_then(|e| e.key_variable);
        let key = variable.and_then(|v| std::env::var(v).ok()).filter(|k| !k.trim().is_empty());
        if let (Some(variable), None, None) = (variable, &key, &self.base_url) {
            return Err(Error::Input(format!(
                "--model {provider}: the key is missing; set {variable} in the environment"
            )));
        }
        config.key = key.map(Secret::new);
        let provider = build(config).map_err(input)?;
        Ok(Some(Client::new(provider, RetryPolicy::default(), budget)))
    }

    /// Returns whether the provider can search the web.
    pub fn searches(&self) -> bool {
        let name = self.model.as_deref().and_then(|m| m.split_once(':')).map_or("", |m| m.0);
        name == REPLAY || all().iter().any(|e| e.name == name && e.searches)
    }

    fn named(&self) -> Result<Option<(&str, &str)>, Error> {
        let Some(word) = self.model.as_deref() else { return Ok(None) };
        let named = word.split_once(':').filter(|(p, m)| !p.is_empty() && !m.is_empty());
        named.map(Some).ok_or_else(|| {
            let names: Vec<&str> = all().iter().map(|e| e.name).collect();
            Error::Input(format!("--model {word}: write PROVIDER:MODEL; providers are {}, {REPLAY}", names.join(", ")))
        })
    }
}

fn prices(text: &str) -> Result<Prices, Error> {
    let parts: Option<Vec<f64>> = text.split(',').map(|p| p.trim().parse().ok()).collect();
    let parts = parts.filter(|p| p.iter().all(|n: &f64| n.is_finite() && *n >= 0.0));
    match parts.as_deref() {
        Some([input, output]) => Ok(Prices { input_per_million: *input, output_per_million: *output, per_search: 0.0 }),
        Some([input, output, search]) => {
            Ok(Prices { input_per_million: *input, output_per_million: *output, per_search: *search })
        }
        _ => Err(Error::Input(format!("--price {text}: write two or three figures like 0.30,2.50,0.014"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prices_are_two_or_three_figures() {
        assert_eq!(prices("0.3, 2.5").unwrap().output_per_million, 2.5);
        assert_eq!(prices("0.3,2.5,0.014").unwrap().per_search, 0.014);
        for wrong in ["", "1", "a,b", "1,-2", "1,2,3,4", "nan,1"] {
            assert!(prices(wrong).is_err(), "{wrong}");
        }
    }
}
