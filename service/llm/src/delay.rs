//! Reads how long a provider asks to wait, from headers, details or the message. It does not wait; see `policy.rs`.

use serde_json::Value;
use time::OffsetDateTime;
use time::format_description::well_known::{Rfc2822, Rfc3339};

use crate::transport::Response;

/// Longest wait that is read, in milliseconds: a day. Anything above is cut, so that sums cannot overflow.
const MAX_MS: f64 = 86_400_000.0;

/// Returns the wait that headers ask for, in milliseconds. Dates count from the response's own date, since no clock is
/// read here and clocks differ.
pub(crate) fn of_headers(response: &Response) -> Option<u64> {
    let number = |name: &str| response.header(name)?.trim().parse::<f64>().ok();
    let now = response.header("date").and_then(parse_date);
    let until = |text: &str| Some((parse_date(text)? - now?).as_seconds_f64() * 1000.0);
    if let Some(ms) = number("retry-after-ms").and_then(whole) {
        return Some(ms);
    }
    if let Some(ms) = number("retry-after").and_then(|s| whole(s * 1000.0)) {
        return Some(ms);
    }
    if let Some(ms) = response.header("retry-after").and_then(until) {
        return whole(ms.max(0.0));
    }
    of_limits(response, &until)
}

/// Returns when the limits that are used up are reset; when none says so, the last reset of all.
fn of_limits(response: &Response, until: &dyn Fn(&str) -> Option<f64>) -> Option<u64> {
    let mut all: Option<u64> = None;
    let mut used_up: Option<u64> = None;
    for (name, value) in &response.headers {
        if !name.contains("ratelimit") || !name.contains("reset") {
            continue;
        }
        let wait = duration_ms(value).or_else(|| until(value).and_then(|ms| whole(ms.max(0.0))));
        let left = response.header(&name.replace("reset", "remaining"));
        all = all.max(wait);
        if left.is_some_and(|l| l.trim() == "0") {
            used_up = used_up.max(wait);
        }
    }
    used_up.or(all)
}

/// Returns the wait of a `google.rpc.RetryInfo`, in milliseconds.
pub(crate) fn of_details(details: &[Value]) -> Option<u64> {
    details.iter().find_map(|d| duration_ms(d.get("retryDelay")?.as_str()?))
}

/// Returns the wait that a message names, as in "try again in 2.4s".
pub(crate) fn of_message(message: &str) -> Option<u64> {
    let message = message.to_lowercase();
    let start = ["try again in ", "retry in ", "retry after "].iter().find_map(|p| Some(message.find(p)? + p.len()))?;
    let words = message.get(start..)?;
    let end = words.find(|c: char| !c.is_ascii_alphanumeric() && c != '.').unwrap_or(words.len());
    duration_ms(words.get(..end)?.trim_end_matches('.'))
}

/// Returns whether a quota of a day or longer is used up: waiting seconds does not help.
pub(crate) fn is_long_quota(details: &[Value]) -> bool {
    let violations = details.iter().filter_map(|d| d.get("violations")?.as_array()).flatten();
    let ids = violations.filter_map(|v| v.get("quotaId").or(v.get("subject"))?.as_str());
    ids.into_iter().any(|id| ["PerDay", "PerWeek", "PerMonth"].iter().any(|p| id.contains(p)))
}

/// Reads a duration such as `33.117s`, `620ms` or `1m12.5s`, in milliseconds.
fn duration_ms(text: &str) -> Option<u64> {
    let mut total = 0.0;
    let mut rest = text.trim();
    if rest.is_empty() {
        return None;
    }
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.')?;
        let number: f64 = rest.get(..digits)?.parse().ok()?;
        let tail = rest.get(digits..)?;
        let unit_end = tail.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(tail.len());
        total += number
            * match tail.get(..unit_end)? {
                "ms" => 1.0,
                "s" => 1000.0,
                "m" => 60_000.0,
                "h" => 3_600_000.0,
                _ => return None,
            };
        rest = tail.get(unit_end..)?;
    }
    whole(total)
}

fn whole(ms: f64) -> Option<u64> {
    (ms.is_finite() && ms >= 0.0).then(|| ms.min(MAX_MS).round() as u64)
}

fn parse_date(text: &str) -> Option<OffsetDateTime> {
    OffsetDateTime::parse(text.trim(), &Rfc2822).or_else(|_| OffsetDateTime::parse(text.trim(), &Rfc3339)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(headers: &[(&str, &str)], expected: Option<u64>) {
        let headers = headers.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
        let response = Response { status: 429, headers, body: Vec::new() };
        assert_eq!(of_headers(&response), expected, "{:?}", response.headers);
    }

    #[test]
    fn headers_say_how_long_to_wait() {
        let date = ("date", "Fri, 20 Nov 2026 10:00:00 GMT");
        check(&[("retry-after", "3"), ("retry-after-ms", "2400")], Some(2400));
        check(&[("retry-after", "1.5")], Some(1500));
        check(&[("retry-after", "Fri, 20 Nov 2026 10:00:30 GMT"), date], Some(30_000));
        check(&[("retry-after", "Fri, 20 Nov 2026 09:00:30 GMT"), date], Some(0));
        check(&[("retry-after", "Fri, 20 Nov 2026 10:00:30 GMT")], None);
        check(&[("anthropic-ratelimit-requests-reset", "2026-11-20T10:01:00Z"), date], Some(60_000));
        check(&[("retry-after", "-5")], None);
        check(&[("retry-after", "nan")], None);
        check(&[("retry-after", "1e300")], Some(86_400_000));
        let resets = [("x-ratelimit-reset-requests", "1m12.5s"), ("x-ratelimit-reset-tokens", "620ms")];
        check(&resets, Some(72_500));
        check(&[resets[0], resets[1], ("x-ratelimit-remaining-tokens", "0")], Some(620));
        check(&[], None);
    }

    #[test]
    fn messages_say_how_long_to_wait() {
        assert_eq!(of_message("Please try again in 2.4s. Thanks"), Some(2400));
        assert_eq!(of_message("Please retry in 33.117s."), Some(33_117));
        assert_eq!(of_message("try again in a while"), None);
        assert_eq!(of_message("try again in 2 parsecs"), None);
    }
}
