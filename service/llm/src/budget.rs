//! What a run may use and what it has used: tokens, money, time, by stage. Prices are configuration, not knowledge.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde::{Deserialize, Serialize};

use crate::answer::Usage;
use crate::error::Error;
use crate::request::{Request, estimated_tokens};

/// What a run may use at most; nothing means no limit.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Tokens, of prompts, answers and thoughts together.
    pub max_tokens: Option<u64>,
    /// Money, in the currency of the prices.
    pub max_cost: Option<f64>,
}

/// What a model costs. The currency is the same for all models of a budget.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Prices {
    /// For a million tokens of prompts.
    pub input_per_million: f64,
    /// For a million tokens of answers and thoughts.
    pub output_per_million: f64,
    /// For one search.
    pub per_search: f64,
}

impl Prices {
    /// Returns what a usage costs.
    pub fn cost(&self, usage: &Usage) -> f64 {
        let output = usage.output.saturating_add(usage.thoughts) as f64;
        (usage.input as f64 * self.input_per_million + output * self.output_per_million) / 1e6
            + usage.searches as f64 * self.per_search
    }
}

/// Calls of one kind that are planned.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Plan {
    /// How many.
    pub calls: u64,
    /// Tokens of the prompt of each.
    pub input_tokens: u64,
    /// Tokens of the answer of each, at most.
    pub output_tokens: u64,
    /// Searches of each, at most.
    pub searches: u64,
}

impl Plan {
    /// Plans one call of a request. With grounding and a schema it is two calls, the second with the first's answer.
    pub fn of(request: &Request) -> Self {
        let (input, output) = (request.estimated_input_tokens(), u64::from(request.max_output_tokens));
        match (&request.grounding, &request.schema) {
            (Some(g), Some(_)) => Self {
                calls: 1,
                input_tokens: 2 * input + output,
                output_tokens: 2 * output,
                searches: u64::from(g.max_searches),
            },
            (g, _) => Self {
                calls: 1,
                input_tokens: input,
                output_tokens: output,
                searches: g.as_ref().map_or(0, |g| u64::from(g.max_searches)),
            },
        }
    }
}

/// What plans may use at most, retries aside.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Estimate {
    /// Calls.
    pub calls: u64,
    /// Tokens and searches.
    pub usage: Usage,
    /// Money; missing if the model has no price.
    pub cost: Option<f64>,
    /// Whether it fits what is left of the budget.
    pub fits: bool,
}

/// One request as it went, for the execution table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CallRecord {
    /// Label of the request.
    pub stage: String,
    /// Name of the provider.
    pub provider: String,
    /// Name of the model.
    pub model: String,
    /// `ok` or the category of the error.
    pub outcome: String,
    /// Of all tries.
    pub usage: Usage,
    /// Of all tries; missing if the model has no price.
    pub cost: Option<f64>,
    /// How often the provider was asked.
    pub tries: u32,
    /// Time in milliseconds, waits included.
    pub elapsed_ms: u64,
    /// Of it, waits between tries.
    pub waited_ms: u64,
}

/// A row of the execution table.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct StageRow {
    /// Label up to the first `/`.
    pub stage: String,
    /// Requests.
    pub calls: u64,
    /// Of them, without answer.
    pub failed: u64,
    /// How often the provider was asked.
    pub tries: u64,
    /// Tokens and searches.
    pub usage: Usage,
    /// Money; missing if a model has no price.
    pub cost: Option<f64>,
    /// Time of the requests one after the other, in milliseconds.
    pub elapsed_ms: u64,
}

#[derive(Default)]
struct State {
    limits: Limits,
    prices: BTreeMap<String, Prices>,
    tokens: u64,
    cost: f64,
    reserved_tokens: u64,
    reserved_cost: f64,
    records: Vec<CallRecord>,
}

/// The budget of a run. Clones share it, so several clients can draw on one.
#[derive(Clone, Default)]
pub struct Budget(Arc<Mutex<State>>);

impl Budget {
    /// Makes a budget. `prices` are by model; a key that the name begins with counts too, the longest first, so that
    /// an empty key is the price of all others.
    pub fn new(limits: Limits, prices: BTreeMap<String, Prices>) -> Self {
        Self(Arc::new(Mutex::new(State { limits, prices, ..State::default() })))
    }

    /// Makes a budget without limits and prices; it still keeps the records.
    pub fn unlimited() -> Self {
        Self::default()
    }

    /// Counts the records of an interrupted run, so that it goes on with what is left.
    pub fn resume(&self, records: impl IntoIterator<Item = CallRecord>) {
        let mut state = self.lock();
        for record in records {
            state.tokens = state.tokens.saturating_add(record.usage.tokens());
            state.cost += record.cost.unwrap_or_default();
            state.records.push(record);
        }
    }

    /// Returns what plans may use at most with a model, to be shown before a run.
    pub fn estimate(&self, model: &str, plans: &[Plan]) -> Estimate {
        let mut usage = Usage { estimated: true, ..Usage::default() };
        for plan in plans {
            usage.input += plan.calls * plan.input_tokens;
            usage.output += plan.calls * plan.output_tokens;
            usage.searches += plan.calls * plan.searches;
        }
        let state = self.lock();
        let cost = state.price(model).map(|p| p.cost(&usage));
        let fits = state.check(usage.tokens(), cost.unwrap_or_default()).is_ok();
        Estimate { calls: plans.iter().map(|p| p.calls).sum(), usage, cost, fits }
    }

    /// Returns tokens and money used so far.
    pub fn spent(&self) -> (u64, f64) {
        let state = self.lock();
        (state.tokens, state.cost)
    }

    /// Returns the requests so far, in the order they ended.
    pub fn records(&self) -> Vec<CallRecord> {
        self.lock().records.clone()
    }

    /// Returns the execution table: a row for each stage, in the order the stages first ended a request.
    pub fn table(&self) -> Vec<StageRow> {
        let mut rows: Vec<StageRow> = Vec::new();
        for record in &self.lock().records {
            let stage = record.stage.split('/').next().unwrap_or_default();
            let index = rows.iter().position(|r| r.stage == stage).unwrap_or_else(|| {
                rows.push(StageRow { stage: stage.to_owned(), cost: Some(0.0), ..StageRow::default() });
                rows.len() - 1
            });
            let row = &mut rows[index];
            row.calls += 1;
            row.failed += u64::from(record.outcome != "ok");
            row.tries += u64::from(record.tries);
            row.usage.add(&record.usage);
            row.cost = row.cost.zip(record.cost).map(|(a, b)| a + b);
            row.elapsed_ms += record.elapsed_ms;
        }
        rows
    }

    /// Sets aside what a call may use at most. `resumed_bytes` are sent back to a provider that has paused.
    ///
    /// # Errors
    /// [`Error::Budget`] if that is more than what is left; [`Error::Config`] if money is limited and the model has no
    /// price.
    pub(crate) fn reserve(&self, model: &str, request: &Request, resumed_bytes: usize) -> Result<Reservation, Error> {
        let most = Usage {
            input: request.estimated_input_tokens() + estimated_tokens(resumed_bytes),
            output: u64::from(request.max_output_tokens),
            searches: request.grounding.as_ref().map_or(0, |g| u64::from(g.max_searches)),
            ..Usage::default()
        };
        let mut state = self.lock();
        let price = state.price(model);
        if price.is_none() && state.limits.max_cost.is_some() {
            return Err(Error::config(format!("model {model} has no price; add one, or do not limit the cost")));
        }
        let prices = price.unwrap_or_default();
        let (tokens, cost) = (most.tokens(), prices.cost(&most));
        state.check(tokens, cost)?;
        state.reserved_tokens += tokens;
        state.reserved_cost += cost;
        drop(state);
        Ok(Reservation { budget: self.clone(), tokens, cost, prices, input: most.input, settled: false })
    }

    /// Keeps a record.
    pub(crate) fn record(&self, mut record: CallRecord) {
        let mut state = self.lock();
        record.cost = state.price(&record.model).map(|p| p.cost(&record.usage));
        state.records.push(record);
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing panics while it holds the lock, and sums stay sums if it did.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn price(&self, model: &str) -> Option<Prices> {
        let fits = self.prices.iter().filter(|(name, _)| model.starts_with(name.as_str()));
        fits.max_by_key(|(name, _)| name.len()).map(|(_, prices)| *prices)
    }

    fn check(&self, tokens: u64, cost: f64) -> Result<(), Error> {
        if let Some(most) = self.limits.max_tokens {
            let left = most.saturating_sub(self.tokens).saturating_sub(self.reserved_tokens);
            if tokens > left {
                return Err(Error::Budget { needs: format!("{tokens} tokens"), left: format!("{left} tokens") });
            }
        }
        if let Some(most) = self.limits.max_cost {
            let left = (most - self.cost - self.reserved_cost).max(0.0);
            // A price of zero fits any budget.
            if cost > left {
                return Err(Error::Budget { needs: format!("{cost:.4} money"), left: format!("{left:.4} money") });
            }
        }
        Ok(())
    }
}

/// What one call may use, set aside until it is known. A call that is dropped on its way counts with its prompt.
pub(crate) struct Reservation {
    budget: Budget,
    tokens: u64,
    cost: f64,
    prices: Prices,
    input: u64,
    settled: bool,
}

impl Reservation {
    /// Counts what the call has really used.
    pub fn settle(mut self, usage: &Usage) {
        self.count(usage);
    }

    fn count(&mut self, usage: &Usage) {
        self.settled = true;
        let mut state = self.budget.lock();
        state.reserved_tokens = state.reserved_tokens.saturating_sub(self.tokens);
        state.reserved_cost = (state.reserved_cost - self.cost).max(0.0);
        state.tokens = state.tokens.saturating_add(usage.tokens());
        state.cost += self.prices.cost(usage);
    }
}

impl Drop for Reservation {
    fn drop(&mut self) {
        if !self.settled {
            let usage = Usage { input: self.input, estimated: true, ..Usage::default() };
            self.count(&usage);
        }
    }
}
