//! Counters of a server as Prometheus reads them.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Upper bounds of the classes of time, s.
const BOUNDS: [f64; 11] = [0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.5, 1.0, 5.0, 30.0];

/// What a server counts.
#[derive(Debug, Default)]
pub struct Metrics {
    calls: Mutex<BTreeMap<(String, &'static str), Times>>,
    /// Calls under way.
    pub in_flight: AtomicI64,
    /// Connections that are open.
    pub connections: AtomicI64,
    /// Calls that wait for a thread.
    pub waiting: AtomicI64,
    /// Threads at work.
    pub threads_busy: AtomicI64,
    /// Work that goes on after the deadline of its call.
    pub overdue: AtomicI64,
    /// Jobs that wait.
    pub jobs_waiting: AtomicI64,
    /// Jobs that run.
    pub jobs_running: AtomicI64,
}

#[derive(Debug, Clone, Default)]
struct Times {
    count: u64,
    seconds: f64,
    within: [u64; BOUNDS.len()],
}

impl Metrics {
    /// Counts a call that ended, by method and status.
    pub fn count(&self, method: &str, status: &'static str, time: Duration) {
        let seconds = time.as_secs_f64();
        let mut calls = self.calls.lock().unwrap_or_else(PoisonError::into_inner);
        let times = calls.entry((method.to_owned(), status)).or_default();
        times.count += 1;
        times.seconds += seconds;
        for (within, bound) in times.within.iter_mut().zip(BOUNDS) {
            *within += u64::from(seconds <= bound);
        }
    }

    /// Returns all counters in the text format of Prometheus.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let gauges = [
            ("calls_in_flight", "Calls under way", &self.in_flight),
            ("connections", "Connections that are open", &self.connections),
            ("calls_waiting", "Calls that wait for a thread", &self.waiting),
            ("threads_busy", "Threads of the pool at work", &self.threads_busy),
            ("work_overdue", "Work that goes on after the deadline of its call", &self.overdue),
            ("jobs_waiting", "Jobs that wait", &self.jobs_waiting),
            ("jobs_running", "Jobs that run", &self.jobs_running),
        ];
        for (name, help, value) in gauges {
            let value = value.load(Ordering::Relaxed);
            let _ = writeln!(text, "# HELP d3dgen_{name} {help}.\n# TYPE d3dgen_{name} gauge\nd3dgen_{name} {value}");
        }
        let calls = self.calls.lock().unwrap_or_else(PoisonError::into_inner).clone();
        text +=
            "# HELP d3dgen_call_seconds Time of calls by method and status.\n# TYPE d3dgen_call_seconds histogram\n";
        for ((method, status), times) in &calls {
            let labels = format!("method=\"{method}\",status=\"{status}\"");
            for (within, bound) in times.within.iter().zip(BOUNDS) {
                let _ = writeln!(text, "d3dgen_call_seconds_bucket{{{labels},le=\"{bound}\"}} {within}");
            }
            let Times { count, seconds, .. } = times;
            let _ = writeln!(text, "d3dgen_call_seconds_bucket{{{labels},le=\"+Inf\"}} {count}");
            let _ = writeln!(text, "d3dgen_call_seconds_sum{{{labels}}} {seconds}");
            let _ = writeln!(text, "d3dgen_call_seconds_count{{{labels}}} {count}");
        }
        text
    }
}

/// A gauge raised for as long as this lives.
pub struct Raised<'a>(&'a AtomicI64);

impl<'a> Raised<'a> {
    /// Raises a gauge by one.
    pub fn new(gauge: &'a AtomicI64) -> Self {
        gauge.fetch_add(1, Ordering::Relaxed);
        Self(gauge)
    }
}

impl Drop for Raised<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_are_counted_by_method_status_and_time() {
        let metrics = Metrics::default();
        for ms in [1, 3, 700] {
            metrics.count("/a/B", "OK", Duration::from_millis(ms));
        }
        metrics.count("/a/B", "NOT_FOUND", Duration::from_millis(1));
        let text = metrics.text();
        for line in [
            "d3dgen_call_seconds_bucket{method=\"/a/B\",status=\"OK\",le=\"0.005\"} 2",
            "d3dgen_call_seconds_count{method=\"/a/B\",status=\"OK\"} 3",
            "d3dgen_call_seconds_count{method=\"/a/B\",status=\"NOT_FOUND\"} 1",
            "d3dgen_calls_in_flight 0",
        ] {
            assert!(text.lines().any(|l| l == line), "{line} is not in\n{text}");
        }
    }
}
