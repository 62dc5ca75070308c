//! Answers from a recording, for tests and for runs without a network; and the recorder that writes one.
//!
//! A recording is lines of JSON, one answer a line. A line with a `key` answers that very request; one without answers
//! requests of its `stage` in order, which is the form to write by hand. Files are the business of the caller.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Mutex, PoisonError};

use data_encoding::HEXLOWER;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::answer::Answer;
use crate::error::Error;
use crate::providers::{BoxFuture, Failure, Fix, Provider, Turn, Tweaks};
use crate::request::Request;

/// A line of a recording.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Line {
    #[serde(skip_serializing_if = "Option::is_none")]
    key: Option<String>,
    stage: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    answer: Option<Answer>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    paused: Vec<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<Error>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fix: Option<Fix>,
}

impl Line {
    fn play(self) -> Result<Turn, Failure> {
        match (self.answer, self.failure) {
            (Some(answer), _) => Ok(Turn::Done(Box::new(answer))),
            (None, Some(error)) => Err(Failure { error, fix: self.fix, ..Failure::default() }),
            (None, None) => Ok(Turn::Paused { resume: self.paused, usage: Default::default() }),
        }
    }
}

/// Returns the key of a request: what is asked, not how long it may take or how much may be said.
fn key(request: &Request) -> String {
    let asked = json!({
        "system": request.system,
        "messages": request.messages,
        "schema": request.schema.as_ref().map(|s| s.wire()),
        "grounding": request.grounding.is_some(),
    });
    HEXLOWER.encode(&Sha256::digest(asked.to_string())[..16])
}

/// Answers from a recording.
pub struct Replay {
    model: String,
    by_key: Mutex<BTreeMap<String, VecDeque<Line>>>,
    by_stage: Mutex<BTreeMap<String, VecDeque<Line>>>,
}

impl Replay {
    /// Reads a recording.
    ///
    /// # Errors
    /// [`Error::Config`] with the number of the first line that is none.
    pub fn new(recording: &str) -> Result<Self, Error> {
        let mut by_key: BTreeMap<String, VecDeque<Line>> = BTreeMap::new();
        let mut by_stage: BTreeMap<String, VecDeque<Line>> = BTreeMap::new();
        let mut model = None;
        for (number, text) in recording.lines().enumerate().filter(|(_, t)| !t.trim().is_empty()) {
            let wrong = |what: String| Error::config(format!("line {} of the recording {what}", number + 1));
            let line: Line = serde_json::from_str(text).map_err(|e| wrong(format!("is not usable: {e}")))?;
            if line.answer.is_none() && line.failure.is_none() && line.paused.is_empty() {
                return Err(wrong("needs an answer, a failure or a pause".to_owned()));
            }
            model = model.or_else(|| line.answer.as_ref().map(|a| a.model.clone()).filter(|m| !m.is_empty()));
            match line.key.clone() {
                Some(key) => by_key.entry(key).or_default().push_back(line),
                None => by_stage.entry(line.stage.clone()).or_default().push_back(line),
            }
        }
        let model = model.unwrap_or_else(|| "replay".to_owned());
        Ok(Self { model, by_key: Mutex::new(by_key), by_stage: Mutex::new(by_stage) })
    }

    fn next(&self, request: &Request) -> Result<Turn, Failure> {
        let key = key(request);
        let mut by_key = self.by_key.lock().unwrap_or_else(PoisonError::into_inner);
        // The last answer to a request stays, so that a stage that is run again finds it again.
        let known = by_key.get_mut(&key).and_then(|l| if l.len() > 1 { l.pop_front() } else { l.front().cloned() });
        drop(by_key);
        let mut by_stage = self.by_stage.lock().unwrap_or_else(PoisonError::into_inner);
        let line = known.or_else(|| by_stage.get_mut(&request.stage)?.pop_front());
        line.ok_or_else(|| Error::NotRecorded { key, stage: request.stage.clone() })?.play()
    }
}

impl Provider for Replay {
    fn name(&self) -> &str {
        "replay"
    }

    fn model(&self) -> &str {
        &self.model
    }

    fn ask<'a>(&'a self, request: &'a Request, _tweaks: &'a Tweaks) -> BoxFuture<'a, Result<Turn, Failure>> {
        Box::pin(async move { self.next(request) })
    }

    fn models(&self) -> BoxFuture<'_, Result<Vec<String>, Failure>> {
        Box::pin(async move { Ok(vec![self.model.clone()]) })
    }
}

/// Takes the lines of a recording.
type Sink = Box<dyn FnMut(&str) + Send>;

/// Passes requests on and writes a recording of what comes back. Trouble that passes by itself is left out.
///
/// Gemini's terms forbid to keep grounded results: whoever records them has to ask the user first.
pub struct Recorder {
    inner: Box<dyn Provider>,
    sink: Mutex<Sink>,
}

impl Recorder {
    /// Records what `inner` says; `sink` gets each line, without its end, as soon as it is known.
    pub fn new(inner: Box<dyn Provider>, sink: impl FnMut(&str) + Send + 'static) -> Self {
        Self { inner, sink: Mutex::new(Box::new(sink)) }
    }

    fn write(&self, request: &Request, turn: &Result<Turn, Failure>) {
        let mut line = Line { key: Some(key(request)), stage: request.stage.clone(), ..Line::default() };
        match turn {
            Ok(Turn::Done(answer)) => line.answer = Some((**answer).clone()),
            Ok(Turn::Paused { resume, .. }) => line.paused.clone_from(resume),
            Err(Failure {
                error: Error::RateLimited { .. } | Error::Unavailable { .. } | Error::Timeout { .. },
                ..
            }) => return,
            Err(failure) => (line.failure, line.fix) = (Some(failure.error.clone()), failure.fix),
        }
        let text = serde_json::to_string(&line).expect("a line has only texts as keys");
        (self.sink.lock().unwrap_or_else(PoisonError::into_inner))(&text);
    }
}

impl Provider for Recorder {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn model(&self) -> &str {
        self.inner.model()
    }

    fn ask<'a>(&'a self, request: &'a Request, tweaks: &'a Tweaks) -> BoxFuture<'a, Result<Turn, Failure>> {
        Box::pin(async move {
            let turn = self.inner.ask(request, tweaks).await;
            self.write(request, &turn);
            turn
        })
    }

    fn models(&self) -> BoxFuture<'_, Result<Vec<String>, Failure>> {
        self.inner.models()
    }

    fn fix_for_invalid(&self) -> Option<Fix> {
        self.inner.fix_for_invalid()
    }
}
