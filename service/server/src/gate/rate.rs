//! How often a client may call: a bucket of tokens for each, filled at a steady rate.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Clients that are remembered; those whose bucket is full are forgotten first.
const REMEMBERED: usize = 10_000;

/// The buckets of all clients.
#[derive(Debug)]
pub(super) struct Rates {
    per_s: f64,
    burst: f64,
    buckets: Mutex<HashMap<String, (f64, Instant)>>,
}

impl Rates {
    pub(super) fn new(per_s: f64, burst: f64) -> Self {
        Self { per_s, burst, buckets: Mutex::default() }
    }

    /// Takes one call of a client, or returns how long to wait for the next.
    pub(super) fn take(&self, client: &str) -> Result<(), Duration> {
        self.take_at(client, Instant::now())
    }

    fn take_at(&self, client: &str, now: Instant) -> Result<(), Duration> {
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if buckets.len() >= REMEMBERED && !buckets.contains_key(client) {
            let refilled = Duration::from_secs_f64((self.burst / self.per_s).min(1e6));
            buckets.retain(|_, (_, last)| now.saturating_duration_since(*last) < refilled);
            if buckets.len() >= REMEMBERED {
                return Err(refilled);
            }
        }
        let (left, last) = buckets.entry(client.to_owned()).or_insert((self.burst, now));
        *left = (*left + now.saturating_duration_since(*last).as_secs_f64() * self.per_s).min(self.burst);
        *last = now;
        if *left >= 1.0 {
            *left -= 1.0;
            return Ok(());
        }
        Err(Duration::from_secs_f64((1.0 - *left) / self.per_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_is_taken_and_then_the_rate() {
        let rates = Rates::new(10.0, 3.0);
        let begun = Instant::now();
        let at = |ms: u64| begun + Duration::from_millis(ms);
        for _ in 0..3 {
            assert_eq!(rates.take_at("a", at(0)), Ok(()));
        }
        assert_eq!(rates.take_at("a", at(0)), Err(Duration::from_millis(100)));
        assert_eq!(rates.take_at("b", at(0)), Ok(()));
        assert_eq!(rates.take_at("a", at(101)), Ok(()));
        assert!(rates.take_at("a", at(102)).is_err());
    }
}
