//! The one retry policy: what is tried again, after which wait. It decides; `client.rs` waits.

use std::time::Duration;

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

use crate::error::Error;

/// When to try again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RetryPolicy {
    /// Tries for trouble that passes by itself, the first one included.
    pub max_tries: u32,
    /// First step of the back-off; each further one is twice as long.
    pub base_delay: Duration,
    /// Longest wait. A provider that asks for more gets no further try.
    pub max_delay: Duration,
    /// Time for one request with all its tries and waits.
    pub deadline: Duration,
    /// How often a provider may pause in the middle of an answer and be asked to go on.
    pub max_continuations: u32,
    /// Seed of the jitter.
    pub seed: u64,
}

impl Default for RetryPolicy {
    fn default() -> Self {
        Self {
            max_tries: 4,
            base_delay: Duration::from_secs(1),
            max_delay: Duration::from_secs(60),
            deadline: Duration::from_secs(600),
            max_continuations: 8,
            seed: 0,
        }
    }
}

impl RetryPolicy {
    /// Returns how long to wait before the next try, or `None` if there is to be none.
    ///
    /// `tries` counts those made; `should_retry` is the provider's own word; `elapsed` is the time spent so far.
    pub(crate) fn wait(
        &self,
        error: &Error,
        should_retry: Option<bool>,
        tries: u32,
        elapsed: Duration,
        jitter: &mut Jitter,
    ) -> Option<Duration> {
        if tries >= self.max_tries || !should_retry.map_or(passes_by_itself(error), |yes| yes && may_pass(error)) {
            return None;
        }
        let step = self.base_delay.saturating_mul(2_u32.saturating_pow(tries.saturating_sub(1))).min(self.max_delay);
        let wait = match error.retry_after_ms() {
            // A wait of nothing, such as a date that has passed, is no reason to hammer.
            Some(ms) if ms > 0 => Duration::from_millis(ms),
            _ => jitter.up_to(step),
        };
        (wait <= self.max_delay && elapsed.saturating_add(wait) < self.deadline).then_some(wait)
    }
}

/// Returns whether the same request may well succeed a little later.
fn passes_by_itself(error: &Error) -> bool {
    matches!(
        error,
        Error::RateLimited { .. } | Error::Unavailable { .. } | Error::Timeout { before_first_byte: true, .. }
    )
}

/// Returns whether a provider that says "try again" is believed; of a used-up quota or a wrong key it is not.
fn may_pass(error: &Error) -> bool {
    passes_by_itself(error) || matches!(error, Error::BadRequest { .. } | Error::BadResponse { .. })
}

/// Full jitter: a wait anywhere between nothing and the step, so that many clients do not come back at once.
pub(crate) struct Jitter(ChaCha8Rng);

impl Jitter {
    /// Starts the sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn up_to(&mut self, step: Duration) -> Duration {
        let unit = (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        step.mul_f64(unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unavailable(retry_after_ms: Option<u64>) -> Error {
        Error::Unavailable { status: Some(503), retry_after_ms, message: String::new() }
    }

    #[test]
    fn waits_grow_up_to_the_cap_and_stop_after_the_last_try() {
        let policy = RetryPolicy { max_tries: 12, ..RetryPolicy::default() };
        let mut jitter = Jitter::new(7);
        let mut longest = Duration::ZERO;
        for tries in 1..12 {
            let wait = policy.wait(&unavailable(None), None, tries, Duration::ZERO, &mut jitter).unwrap();
            assert!(wait <= Duration::from_secs(1 << (tries - 1)).min(policy.max_delay), "{tries}: {wait:?}");
            longest = longest.max(wait);
        }
        assert!(longest > Duration::from_secs(10), "jitter has to spread, not to vanish: {longest:?}");
        assert_eq!(policy.wait(&unavailable(None), None, 12, Duration::ZERO, &mut jitter), None);
    }

    #[test]
    fn the_provider_has_its_say_within_limits() {
        let policy = RetryPolicy::default();
        let wait = |error: &Error, says, elapsed| {
            policy.wait(error, says, 1, Duration::from_secs(elapsed), &mut Jitter::new(0))
        };
        assert_eq!(wait(&unavailable(Some(2400)), None, 0), Some(Duration::from_millis(2400)));
        assert_eq!(wait(&unavailable(Some(60_001)), None, 0), None);
        assert_eq!(wait(&unavailable(Some(30_000)), None, 580), None);
        assert_eq!(wait(&unavailable(None), Some(false), 0), None);
        let bad = Error::BadRequest { message: String::new() };
        assert!(wait(&bad, None, 0).is_none() && wait(&bad, Some(true), 0).is_some());
        let quota = Error::QuotaExhausted { message: String::new() };
        assert_eq!(wait(&quota, Some(true), 0), None);
        let late = |before_first_byte| Error::Timeout { after_ms: 1, before_first_byte };
        assert!(wait(&late(true), None, 0).is_some() && wait(&late(false), None, 0).is_none());
    }
}
