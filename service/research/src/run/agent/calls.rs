//! Requests to the model, each answer kept as a file in `calls/`: an interrupted run goes on without asking again.

use std::future::poll_fn;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::task::Poll;

use d3dgen_llm::{Answer, CallRecord, Client, Request};
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::Error;
use crate::run::files::{Folder, sha256};
use crate::run::{BoxFuture, Context};
use crate::synthesis::slug::slug;

/// Folder of the answers.
pub const CALLS: &str = "calls";

/// An answer as kept.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    version: u32,
    stage: String,
    provider: String,
    model: String,
    system: Option<String>,
    messages: serde_json::Value,
    answer: Answer,
    /// What it took, for the budget of the run that goes on.
    record: Option<CallRecord>,
}

/// Asks the model and keeps what it says.
pub struct Calls<'a> {
    client: &'a Client,
    folder: &'a Folder,
    kept: AtomicU64,
    warnings: Mutex<Vec<String>>,
}

impl<'a> Calls<'a> {
    /// Returns the calls of a run.
    pub fn new(client: &'a Client, folder: &'a Folder) -> Self {
        Self { client, folder, kept: AtomicU64::new(0), warnings: Mutex::default() }
    }

    /// Returns how many answers were there already.
    pub fn kept(&self) -> u64 {
        self.kept.load(Ordering::SeqCst)
    }

    /// Returns what was noticed about kept answers.
    pub fn take_warnings(&self) -> Vec<String> {
        self.warnings.lock().map(|mut w| std::mem::take(&mut *w)).unwrap_or_default()
    }

    /// Returns the answer to a request: the one that is kept, or a new one.
    ///
    /// # Errors
    /// `Model`, `File`, `Interrupted`.
    pub async fn ask(&self, context: &Context<'_>, request: &Request) -> Result<Answer, Error> {
        let name = self.name(request);
        if let Some(answer) = self.find(&name, request)? {
            return Ok(answer);
        }
        context.say(&format!("asking {} about {}", self.client.provider().model(), request.stage));
        let answer = context.stop.race(self.client.complete(request)).await?;
        let answer = answer.map_err(|e| Error::Model { stage: request.stage.clone(), source: Box::new(e) })?;
        let kept = Kept {
            version: 1,
            stage: request.stage.clone(),
            provider: self.client.provider().name().to_owned(),
            model: self.client.provider().model().to_owned(),
            system: request.system.clone(),
            messages: json!(request.messages),
            answer,
            record: self.client.budget().records().into_iter().rev().find(|r| r.stage == request.stage),
        };
        let text = serde_json::to_string_pretty(&kept).expect("answers hold only finite numbers and string keys");
        self.folder.write(&name, (text + "\n").as_bytes())?;
        Ok(kept.answer)
    }

    fn find(&self, name: &str, request: &Request) -> Result<Option<Answer>, Error> {
        let Some(text) = self.folder.text(name)? else { return Ok(None) };
        let kept = serde_json::from_str::<Kept>(&text).map_err(|e| e.to_string());
        let checked = kept.and_then(|mut kept| {
            // Someone may have edited it: it is data like any other answer.
            let json = match (&request.schema, kept.answer.json.take()) {
                (Some(schema), Some(json)) => Some(schema.check(json).map_err(|p| p.join("; "))?),
                (Some(_), None) => return Err("holds no JSON".to_owned()),
                (None, _) => None,
            };
            kept.answer.json = json;
            Ok(kept)
        });
        match checked {
            Ok(kept) => {
                self.kept.fetch_add(1, Ordering::SeqCst);
                self.client.budget().resume(kept.record);
                Ok(Some(kept.answer))
            }
            Err(reason) => {
                if let Ok(mut warnings) = self.warnings.lock() {
                    warnings.push(format!("{name}: {reason}; asked again"));
                }
                Ok(None)
            }
        }
    }

    /// Returns the name of an answer's file: what was asked of whom.
    fn name(&self, request: &Request) -> String {
        let asked = json!({
            "provider": self.client.provider().name(),
            "model": self.client.provider().model(),
            "system": request.system,
            "messages": request.messages,
            "schema": request.schema.as_ref().map(|s| s.wire()),
            "grounded": request.grounding.is_some(),
            "max_output_tokens": request.max_output_tokens,
        });
        let key = sha256(asked.to_string().as_bytes());
        format!("{CALLS}/{}_{}.json", slug(&request.stage, 60), key.get(..12).unwrap_or_default())
    }
}

/// Returns what futures give, in their order, with at most `width` on their way at a time.
pub async fn all<T>(mut waiting: Vec<BoxFuture<'_, T>>, width: usize) -> Vec<T> {
    waiting.reverse();
    let mut running: Vec<(usize, BoxFuture<'_, T>)> = Vec::new();
    let mut done: Vec<(usize, T)> = Vec::new();
    let mut next = 0;
    poll_fn(|cx| {
        loop {
            while running.len() < width.max(1) {
                let Some(future) = waiting.pop() else { break };
                running.push((next, future));
                next += 1;
            }
            let before = done.len();
            let mut i = 0;
            while let Some((index, future)) = running.get_mut(i) {
                match future.as_mut().poll(cx) {
                    Poll::Ready(value) => {
                        done.push((*index, value));
                        drop(running.swap_remove(i));
                    }
                    Poll::Pending => i += 1,
                }
            }
            if running.is_empty() && waiting.is_empty() {
                return Poll::Ready(());
            }
            if done.len() == before {
                return Poll::Pending;
            }
        }
    })
    .await;
    done.sort_by_key(|d| d.0);
    done.into_iter().map(|d| d.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::atomic::AtomicUsize;

    #[tokio::test]
    async fn futures_keep_their_order_and_their_number() {
        let running = Arc::new(AtomicUsize::new(0));
        let most = Arc::new(AtomicUsize::new(0));
        let futures: Vec<BoxFuture<'_, usize>> = (0..9)
            .map(|i| {
                let (running, most) = (Arc::clone(&running), Arc::clone(&most));
                let future: BoxFuture<'_, usize> = Box::pin(async move {
                    most.fetch_max(running.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                    for _ in 0..(9 - i) {
                        tokio::task::yield_now().await;
                    }
                    running.fetch_sub(1, Ordering::SeqCst);
                    i
                });
                future
            })
            .collect();
        assert_eq!(all(futures, 3).await, (0..9).collect::<Vec<_>>());
        assert_eq!(most.load(Ordering::SeqCst), 3);
    }
}
