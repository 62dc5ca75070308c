//! The date, which comes from whoever starts the server.

use std::sync::Arc;
use std::time::{Duration, UNIX_EPOCH};

/// Tells the time since 1970 UTC.
#[derive(Clone)]
pub struct Clock(Arc<dyn Fn() -> Duration + Send + Sync>);

impl std::fmt::Debug for Clock {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Clock")
    }
}

impl Clock {
    /// Returns a clock that asks a function for the time since 1970 UTC.
    pub fn new(ask: impl Fn() -> Duration + Send + Sync + 'static) -> Self {
        Self(Arc::new(ask))
    }

    /// Returns the milliseconds since 1970.
    pub fn now_ms(&self) -> u64 {
        u64::try_from((self.0)().as_millis()).unwrap_or(u64::MAX)
    }

    /// Returns date and time in UTC, `2026-11-21T14:13:00Z`.
    pub fn text(&self) -> String {
        text(self.now_ms())
    }

    /// Returns the date in UTC, `2026-11-21`.
    pub fn date(&self) -> String {
        self.text().chars().take("YYYY-MM-DD".len()).collect()
    }
}

/// Returns a time in milliseconds since 1970 as date and time in UTC.
pub fn text(ms: u64) -> String {
    // year 9999 is the last that the form can write
    let ms = ms.min(253_402_300_799_000);
    humantime::format_rfc3339_seconds(UNIX_EPOCH + Duration::from_millis(ms)).to_string()
}
