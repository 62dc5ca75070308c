//! Asks a provider under the one retry policy and the budget, and checks what comes back. The only door to providers.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::answer::{Answer, Usage};
use crate::budget::{Budget, CallRecord};
use crate::error::Error;
use crate::json_text::json_candidates;
use crate::policy::{Jitter, RetryPolicy};
use crate::providers::{BoxFuture, Failure, Provider, Turn, Tweaks};
use crate::request::{Message, Request, Role};

/// How to wait between tries; tests pass one that does not.
pub type Sleep = Arc<dyn Fn(Duration) -> BoxFuture<'static, ()> + Send + Sync>;

/// The most of an invalid answer that is shown to the model again, in bytes.
const MAX_SHOWN_BYTES: usize = 60_000;
/// The most of an invalid answer that an error keeps, in characters.
const MAX_KEPT_CHARS: usize = 400;

/// Asks one provider. It can be shared between threads; dropping the future of a request cancels it.
pub struct Client {
    provider: Box<dyn Provider>,
    policy: RetryPolicy,
    budget: Budget,
    sleep: Sleep,
    jitter: Mutex<Jitter>,
}

impl Client {
    /// Makes a client. Clients may share a budget.
    pub fn new(provider: Box<dyn Provider>, policy: RetryPolicy, budget: Budget) -> Self {
        let sleep: Sleep = Arc::new(|wait| Box::pin(tokio::time::sleep(wait)));
        let jitter = Mutex::new(Jitter::new(policy.seed));
        Self { provider, policy, budget, sleep, jitter }
    }

    /// Replaces the way to wait between tries.
    pub fn with_sleep(mut self, sleep: Sleep) -> Self {
        self.sleep = sleep;
        self
    }

    /// Returns the provider.
    pub fn provider(&self) -> &dyn Provider {
        &*self.provider
    }

    /// Returns the budget with its records.
    pub fn budget(&self) -> &Budget {
        &self.budget
    }

    /// Returns the models on offer.
    ///
    /// # Errors
    /// As the provider says; there is no retry.
    pub async fn models(&self) -> Result<Vec<String>, Error> {
        self.provider.models().await.map_err(|f| f.error)
    }

    /// Asks, again where that may help, and returns a checked answer. What was asked is in the budget's records.
    ///
    /// With grounding and a schema it asks twice: for prose with sources, and for that prose as JSON. The answer then
    /// has the text and citations of the first and the JSON of the second.
    ///
    /// # Errors
    /// One of the categories of [`Error`].
    pub async fn complete(&self, request: &Request) -> Result<Answer, Error> {
        request.check()?;
        let (Some(_), Some(_)) = (&request.grounding, &request.schema) else { return self.one(request).await };
        let mut prose = request.clone();
        prose.schema = None;
        let mut answer = self.one(&prose).await?;
        let structured = self.one(&structuring(request, &answer.text)).await?;
        answer.json = structured.json;
        answer.usage.add(&structured.usage);
        answer.tries += structured.tries;
        Ok(answer)
    }

    /// Asks for one answer and keeps the record.
    async fn one(&self, request: &Request) -> Result<Answer, Error> {
        let mut run = Run::new(request);
        let result = self.tries(&mut run).await;
        self.budget.record(CallRecord {
            stage: request.stage.clone(),
            provider: self.provider.name().to_owned(),
            model: self.provider.model().to_owned(),
            outcome: result.as_ref().map_or_else(Error::category, |_| "ok").to_owned(),
            usage: run.usage,
            cost: None,
            tries: run.tries,
            elapsed_ms: run.elapsed.as_millis() as u64,
            waited_ms: run.waited.as_millis() as u64,
        });
        result.map(|answer| Answer { usage: run.usage, tries: run.tries, ..answer })
    }

    async fn tries(&self, run: &mut Run) -> Result<Answer, Error> {
        loop {
            let reserved = match self.budget.reserve(self.provider.model(), &run.request, run.resumed_bytes()) {
                Ok(reserved) => reserved,
                // A second chance that does not fit the budget leaves the first result.
                Err(error) => return Err(run.fallback.take().unwrap_or(error)),
            };
            let left = self.policy.deadline.saturating_sub(run.elapsed);
            run.request.timeout = run.timeout.min(left);
            let start = Instant::now();
            let turn = self.provider.ask(&run.request, &run.tweaks).await;
            run.elapsed += start.elapsed();
            run.tries += 1;
            let usage = match &turn {
                Ok(Turn::Done(answer)) => answer.usage,
                Ok(Turn::Paused { usage, .. }) | Err(Failure { usage, .. }) => *usage,
            };
            reserved.settle(&usage);
            run.usage.add(&usage);
            let outcome = match turn {
                Ok(Turn::Done(answer)) => self.check(run, *answer),
                Ok(Turn::Paused { resume, .. }) => run.go_on(resume, &self.policy),
                Err(failure) => self.failed(run, failure),
            };
            match outcome {
                Next::Return(result) => return *result,
                Next::Again => {}
                Next::Wait(wait) => {
                    (self.sleep)(wait).await;
                    run.elapsed += wait;
                    run.waited += wait;
                }
            }
        }
    }

    /// Checks an answer against the schema; one that does not fit gets one repair.
    fn check(&self, run: &mut Run, mut answer: Answer) -> Next {
        let Some(schema) = run.request.schema.clone() else { return Next::ok(answer) };
        let candidates = match answer.json.take() {
            Some(json) => vec![json],
            None => json_candidates(&answer.text),
        };
        let mut first_problems = None;
        for candidate in candidates {
            match schema.check(candidate) {
                Ok(json) => {
                    answer.json = Some(json);
                    return Next::ok(answer);
                }
                Err(problems) => first_problems = first_problems.or(Some(problems)),
            }
        }
        let problems =
            first_problems.unwrap_or_else(|| vec!["there is no complete JSON object in the answer".to_owned()]);
        let text: String = answer.text.chars().take(MAX_KEPT_CHARS).collect();
        let error = Error::InvalidAnswer { problems: problems.clone(), text };
        if std::mem::replace(&mut run.repaired, true) {
            return Next::err(error);
        }
        run.tweaks.fixes.extend(self.provider.fix_for_invalid());
        run.tweaks.resume.clear();
        run.show(&answer.text, &problems, schema.wire());
        run.fallback = Some(error);
        Next::Again
    }

    /// Decides what to do after a failure: a fix that the error asks for, more tokens, a wait, or to give up.
    fn failed(&self, run: &mut Run, failure: Failure) -> Next {
        if let Some(fix) = failure.fix.filter(|f| !run.tweaks.fixes.contains(f)) {
            run.tweaks.fixes.insert(fix);
            return Next::Again;
        }
        if let Error::Truncated { .. } = failure.error
            && !std::mem::replace(&mut run.doubled, true)
        {
            run.request.max_output_tokens = run.request.max_output_tokens.saturating_mul(2);
            run.fallback = Some(failure.error);
            return Next::Again;
        }
        // The second chance was refused as such, for instance because the model does not write so many tokens.
        if matches!(failure.error, Error::BadRequest { .. } | Error::TooLong { .. })
            && let Some(first) = run.fallback.take()
        {
            return Next::err(first);
        }
        run.transient += 1;
        let mut jitter = self.jitter.lock().unwrap_or_else(PoisonError::into_inner);
        match self.policy.wait(&failure.error, failure.should_retry, run.transient, run.elapsed, &mut jitter) {
            Some(wait) => Next::Wait(wait),
            None => Next::err(failure.error),
        }
    }
}

/// What comes after a try.
enum Next {
    Return(Box<Result<Answer, Error>>),
    Again,
    Wait(Duration),
}

impl Next {
    fn ok(answer: Answer) -> Self {
        Self::Return(Box::new(Ok(answer)))
    }

    fn err(error: Error) -> Self {
        Self::Return(Box::new(Err(error)))
    }
}

/// The state of one request with all its tries.
struct Run {
    request: Request,
    timeout: Duration,
    tweaks: Tweaks,
    usage: Usage,
    elapsed: Duration,
    waited: Duration,
    tries: u32,
    transient: u32,
    continuations: u32,
    doubled: bool,
    repaired: bool,
    /// What to return if a second chance is not possible.
    fallback: Option<Error>,
}

impl Run {
    fn new(request: &Request) -> Self {
        Self {
            request: request.clone(),
            timeout: request.timeout,
            tweaks: Tweaks::default(),
            usage: Usage::default(),
            elapsed: Duration::ZERO,
            waited: Duration::ZERO,
            tries: 0,
            transient: 0,
            continuations: 0,
            doubled: false,
            repaired: false,
            fallback: None,
        }
    }

    /// Returns the length of what is sent back to a provider that has paused.
    fn resumed_bytes(&self) -> usize {
        self.tweaks.resume.iter().map(|block| block.to_string().len()).sum()
    }

    /// Lets a provider go on that has paused.
    fn go_on(&mut self, resume: Vec<serde_json::Value>, policy: &RetryPolicy) -> Next {
        self.continuations += 1;
        if self.continuations > policy.max_continuations || self.elapsed >= policy.deadline {
            let message = format!("the model paused {} times without an end", self.continuations);
            return Next::err(Error::bad_response(message));
        }
        self.tweaks.resume = resume;
        Next::Again
    }

    /// Adds what was said and what is wrong with it to the conversation. The schema goes along: some servers take a
    /// response format and ignore it.
    fn show(&mut self, said: &str, problems: &[String], schema: &serde_json::Value) {
        let mut end = said.len().min(MAX_SHOWN_BYTES);
        while !said.is_char_boundary(end) {
            end -= 1;
        }
        let said = said.get(..end).unwrap_or_default().trim();
        // Providers refuse an empty turn.
        let said = if said.is_empty() { "(no JSON)" } else { said };
        let problems: Vec<String> = problems.iter().map(|p| format!("- {p}")).collect();
        let template = include_str!("prompts/repair.txt").replace("{schema}", &schema.to_string());
        // Problems quote the answer, so they go in last.
        let text = template.replace("{problems}", &problems.join("\n"));
        self.request.messages.push(Message { role: Role::Assistant, text: said.to_owned() });
        self.request.messages.push(Message { role: Role::User, text: text.trim().to_owned() });
    }
}

/// Makes the second of two calls: the prose of the first as JSON, without a search.
fn structuring(request: &Request, notes: &str) -> Request {
    let asked = request.messages.last().map_or("", |m| m.text.as_str());
    // The notes go in last: what they say is not to be taken for a place to fill in.
    let template = include_str!("prompts/structure.txt").trim();
    let (before, after) = template.split_once("{notes}").unwrap_or((template, ""));
    let text = format!("{}{notes}{after}", before.replace("{request}", asked));
    let messages = vec![Message { role: Role::User, text }];
    Request { messages, grounding: None, ..request.clone() }
}
