//! What all providers over HTTP share: send, sort out errors, take keys out of texts. The formats are in their files.

use serde_json::Value;

use crate::answer::{Answer, Finish, Usage};
use crate::classify::{Fault, shortened};
use crate::error::Error;
use crate::providers::{BoxFuture, Config, Failure, Fix, Provider, Turn, Tweaks};
use crate::request::{Request, estimated_tokens};
use crate::secret::{Secret, redact};
use crate::stream::{Documents, documents};
use crate::transport::{Call, Transport};

/// The format of one provider.
pub(crate) trait Wire: Send + Sync {
    /// Writes a request.
    fn encode(&self, request: &Request, tweaks: &Tweaks) -> Result<Call, Error>;

    /// Reads what came with a status of success.
    fn decode(&self, request: &Request, tweaks: &Tweaks, documents: Documents) -> Result<Turn, Failure>;

    /// Amends what an error means, where this provider differs.
    fn amend(&self, _request: &Request, _fault: &Fault, _failure: &mut Failure) {}

    /// Returns the call that lists models.
    fn models_call(&self) -> Result<Call, Error>;

    /// Returns a change to try when an answer is no valid JSON.
    fn fix_for_invalid(&self) -> Option<Fix> {
        None
    }
}

/// A provider over HTTP.
pub(crate) struct Http<W> {
    name: &'static str,
    model: String,
    key: Option<Secret>,
    transport: Transport,
    wire: W,
}

impl<W: Wire + 'static> Http<W> {
    /// Makes a provider of a configuration.
    pub fn build(
        name: &'static str,
        base_url: &str,
        config: Config,
        wire: fn(Config) -> W,
    ) -> Result<Box<dyn Provider>, Error> {
        let base_url = config.base_url.as_deref().unwrap_or(base_url);
        let transport = Transport::new(base_url, config.response_limit_bytes)?;
        let (model, key) = (config.model.clone(), config.key.clone());
        let wire = wire(config);
        // Whatever is wrong with the configuration shows here, not in the middle of a run.
        wire.encode(&Request::new("check", "check"), &Tweaks::default())?;
        Ok(Box::new(Self { name, model, key, transport, wire }))
    }

    async fn once(&self, request: &Request, tweaks: &Tweaks) -> Result<Turn, Failure> {
        let call = self.wire.encode(request, tweaks)?;
        let response = self.transport.send(&call, request.timeout).await.map_err(|e| spent_prompt(e, request))?;
        if !(200..300).contains(&response.status) {
            let fault = Fault::of_response(&response);
            let mut failure = fault.failure(&self.model, Some(&response));
            self.wire.amend(request, &fault, &mut failure);
            return Err(self.useful_fix(request, tweaks, &call, failure));
        }
        let documents = documents(&response).map_err(|e| spent_prompt(e, request))?;
        let fault = documents.items.iter().find_map(|d| Fault::of_body(d).filter(|_| is_fault(d)));
        if let Some(fault) = fault {
            let mut failure = fault.failure(&self.model, Some(&response));
            self.wire.amend(request, &fault, &mut failure);
            return Err(failure);
        }
        let turn = self.wire.decode(request, tweaks, documents);
        turn.map_err(|f| self.useful_fix(request, tweaks, &call, f))
    }

    /// Keeps a fix only if it changes what is sent.
    fn useful_fix(&self, request: &Request, tweaks: &Tweaks, call: &Call, mut failure: Failure) -> Failure {
        failure.fix = failure.fix.filter(|fix| {
            let mut fixed = tweaks.clone();
            fixed.fixes.insert(*fix) && self.wire.encode(request, &fixed).is_ok_and(|c| c.body != call.body)
        });
        failure
    }

    fn clean(&self, mut failure: Failure) -> Failure {
        failure.error = failure.error.map_text(&|text| redact(text, self.key.as_ref()));
        failure
    }
}

impl<W: Wire + 'static> Provider for Http<W> {
    fn name(&self) -> &str {
        self.name
    }

    fn model(&self) -> &str {
        &self.model
    }

    fn ask<'a>(&'a self, request: &'a Request, tweaks: &'a Tweaks) -> BoxFuture<'a, Result<Turn, Failure>> {
        Box::pin(async move { self.once(request, tweaks).await.map_err(|f| self.clean(f)) })
    }

    fn models(&self) -> BoxFuture<'_, Result<Vec<String>, Failure>> {
        Box::pin(async move {
            let list = async {
                let call = self.wire.models_call()?;
                let response = self.transport.send(&call, std::time::Duration::from_secs(30)).await?;
                if !(200..300).contains(&response.status) {
                    return Err(Fault::of_response(&response).failure(&self.model, Some(&response)));
                }
                names(&documents(&response)?).ok_or_else(|| Error::bad_response("no list of models").into())
            };
            list.await.map_err(|f| self.clean(f))
        })
    }

    fn fix_for_invalid(&self) -> Option<Fix> {
        self.wire.fix_for_invalid()
    }
}

/// Returns whether a document of success is an error all the same.
fn is_fault(document: &Value) -> bool {
    let error = document.get("error");
    error.is_some_and(|e| !e.is_null()) || document.get("object").and_then(Value::as_str) == Some("error")
}

/// Counts the prompt of a call that reached the provider without a word about its usage.
fn spent_prompt(error: Error, request: &Request) -> Failure {
    let reached = matches!(error, Error::Timeout { .. } | Error::TooLarge { .. } | Error::BadResponse { .. });
    let input = if reached { request.estimated_input_tokens() } else { 0 };
    Failure::from(error).with_usage(Usage { input, estimated: reached, ..Usage::default() })
}

/// Returns the names in a list of models, in any of its forms.
fn names(documents: &Documents) -> Option<Vec<String>> {
    let body = documents.items.first()?;
    let list = body.get("data").or_else(|| body.get("models"))?.as_array()?;
    let name = |m: &Value| {
        let name = m.get("id").or_else(|| m.get("name"))?.as_str()?;
        Some(if m.get("id").is_some() { name } else { name.strip_prefix("models/").unwrap_or(name) }.to_owned())
    };
    Some(list.iter().filter_map(name).collect())
}

/// Makes the failure of an answer that was cut off, with what had been said.
pub(crate) fn truncated(request: &Request, answer: Answer) -> Failure {
    let answer = with_guess(request, answer);
    let usage = answer.usage;
    let partial = (!answer.text.trim().is_empty()).then(|| Box::new(answer));
    Failure::from(Error::Truncated { limit: request.max_output_tokens, partial }).with_usage(usage)
}

/// Makes the failure of a declined request.
pub(crate) fn refused(reason: &str, usage: Usage) -> Failure {
    let reason = if reason.trim().is_empty() { "no reason given".to_owned() } else { shortened(reason) };
    Failure::from(Error::Refused { reason }).with_usage(usage)
}

/// Makes the failure of a filtered exchange.
pub(crate) fn blocked(reason: &str, usage: Usage) -> Failure {
    Failure::from(Error::Blocked { reason: shortened(reason) }).with_usage(usage)
}

/// Guesses usage where there is none.
fn with_guess(request: &Request, mut answer: Answer) -> Answer {
    if answer.usage.tokens() == 0 {
        answer.usage.input = request.estimated_input_tokens();
        answer.usage.output = estimated_tokens(answer.text.len());
        answer.usage.estimated = true;
    }
    answer
}

/// Finishes an answer: guesses usage where there is none, and refuses an empty one.
pub(crate) fn done(request: &Request, model: &str, answer: Answer) -> Result<Turn, Failure> {
    let mut answer = with_guess(request, answer);
    if answer.model.is_empty() {
        answer.model = model.to_owned();
    }
    answer.grounded = !answer.citations.is_empty();
    if answer.text.trim().is_empty() && answer.json.is_none() {
        let reason = if let Finish::Other(reason) = &answer.finish {
            format!(" ({})", shortened(reason))
        } else {
            String::new()
        };
        let error = Error::bad_response(format!("the answer is empty{reason}"));
        return Err(Failure::from(error).with_usage(answer.usage));
    }
    Ok(Turn::Done(Box::new(answer)))
}

/// Returns a whole number that is not negative; 0 for anything else.
pub(crate) fn count(value: Option<&Value>) -> u64 {
    let number = value.and_then(|v| v.as_u64().or_else(|| v.as_f64().filter(|f| *f > 0.0).map(|f| f as u64)));
    number.unwrap_or_default()
}

/// Returns the text at a key; empty for anything else.
pub(crate) fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value.get(key).and_then(Value::as_str).unwrap_or_default()
}

/// Returns the items of a list at a key; none for anything else.
pub(crate) fn list<'a>(value: &'a Value, key: &str) -> impl Iterator<Item = &'a Value> {
    value.get(key).and_then(Value::as_array).into_iter().flatten()
}
