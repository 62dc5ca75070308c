//! Reads robots.txt as RFC 9309 says, and tells what may be fetched.
//!
//! What it is not for: getting the file; what a missing or failing one means is decided by the fetcher.

use std::time::Duration;

/// How much of the file is read; the RFC asks for at least this much.
pub(super) const MAX_BYTES: usize = 500 * 1024;
/// Rules beyond this many are not read: matching them would take a server's word for how long we work.
const MAX_RULES: usize = 10_000;
/// A rule longer than any sensible path is cut.
const MAX_PATTERN: usize = 1024;

#[derive(Debug, Clone, PartialEq, Eq)]
struct Rule {
    pattern: String,
    allow: bool,
}

#[derive(Debug, Clone, Default)]
struct Group {
    agents: Vec<String>,
    rules: Vec<Rule>,
    delay: Option<Duration>,
}

/// A robots.txt as it concerns one robot.
#[derive(Debug, Clone, Default)]
pub struct Robots {
    rules: Vec<Rule>,
    delay: Option<Duration>,
    is_failure: bool,
}

impl Robots {
    /// Returns one that allows everything.
    pub fn allow_all() -> Self {
        Self::default()
    }

    /// Returns one that forbids everything, for a server whose file cannot be had.
    pub fn disallow_all() -> Self {
        Self { rules: vec![Rule { pattern: "/".into(), allow: false }], delay: None, is_failure: true }
    }

    /// Tells whether this stands for a file that cannot be had.
    pub fn is_failure(&self) -> bool {
        self.is_failure
    }

    /// Returns what a file says to the robot of a name. Lines that mean nothing are passed over, as the RFC asks.
    pub fn parse(bytes: &[u8], robot: &str) -> Self {
        // Half a rule would forbid more than the whole one.
        let whole = |cut: &'_ [u8]| cut.iter().rposition(|b| *b == b'\n').unwrap_or(0);
        let bytes = bytes.get(..MAX_BYTES).map_or(bytes, |cut| cut.get(..whole(cut)).unwrap_or(cut));
        let text = String::from_utf8_lossy(bytes);
        let groups = groups(text.trim_start_matches('\u{feff}'));
        let named = |g: &&Group| g.agents.iter().any(|a| a.eq_ignore_ascii_case(robot));
        let general = |g: &&Group| g.agents.iter().any(|a| a == "*");
        let mut chosen: Vec<&Group> = groups.iter().filter(named).collect();
        if chosen.is_empty() {
            chosen = groups.iter().filter(general).collect();
        }
        Self {
            rules: chosen.iter().flat_map(|g| g.rules.iter().cloned()).collect(),
            delay: chosen.iter().filter_map(|g| g.delay).max(),
            is_failure: false,
        }
    }

    /// Tells whether a path with its query (`/a/b?c=d`) may be fetched. The longest rule that fits wins; allowing wins
    /// among equals.
    pub fn allows(&self, path: &str) -> bool {
        if path == "/robots.txt" {
            return true;
        }
        let path = plain(path);
        let fitting = self.rules.iter().filter(|r| fits(r.pattern.as_bytes(), path.as_bytes()));
        fitting.max_by_key(|r| (r.pattern.len(), r.allow)).is_none_or(|r| r.allow)
    }

    /// Returns the time between two requests that the file asks for.
    pub fn crawl_delay(&self) -> Option<Duration> {
        self.delay
    }
}

fn groups(text: &str) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    let mut in_agents = false;
    let mut rules = 0;
    for line in text.split(['\n', '\r']) {
        let line = line.split('#').next().unwrap_or_default();
        let Some((key, value)) = line.split_once(':') else { continue };
        let value = value.trim();
        match key.trim().to_ascii_lowercase().as_str() {
            "user-agent" => {
                if !in_agents {
                    groups.push(Group::default());
                }
                in_agents = true;
                // "Bot/1.2" in a file means the robot called "Bot".
                let agent = value.split(['/', ' ']).next().unwrap_or_default();
                groups.last_mut().into_iter().for_each(|g| g.agents.push(agent.to_owned()));
            }
            key @ ("allow" | "disallow") => {
                in_agents = false;
                rules += 1;
                // An empty rule forbids and allows nothing.
                if value.is_empty() || rules > MAX_RULES {
                    continue;
                }
                let mut pattern = plain(value);
                if let Some((end, _)) = pattern.char_indices().find(|(i, _)| *i >= MAX_PATTERN) {
                    pattern.truncate(end);
                }
                let rule = Rule { pattern, allow: key == "allow" };
                groups.last_mut().into_iter().for_each(|g| g.rules.push(rule.clone()));
            }
            "crawl-delay" => {
                in_agents = false;
                let seconds = value.parse::<f64>().ok().filter(|s| (0.0..86_400.0).contains(s));
                let delay = seconds.map(Duration::from_secs_f64);
                groups.last_mut().into_iter().for_each(|g| g.delay = g.delay.max(delay));
            }
            _ => {}
        }
    }
    groups
}

/// Returns a path in one spelling: letters that need no escape are plain, others are escaped in capitals.
fn plain(path: &str) -> String {
    let bytes = path.as_bytes();
    let mut out = String::with_capacity(path.len());
    let mut i = 0;
    while let Some(&byte) = bytes.get(i) {
        let escaped = (byte == b'%')
            .then(|| bytes.get(i + 1..i + 3))
            .flatten()
            .and_then(|h| std::str::from_utf8(h).ok())
            .and_then(|h| u8::from_str_radix(h, 16).ok());
        i += if escaped.is_some() { 3 } else { 1 };
        let value = escaped.unwrap_or(byte);
        let unreserved = value.is_ascii_alphanumeric() || matches!(value, b'-' | b'.' | b'_' | b'~');
        let keep = if escaped.is_some() { unreserved } else { value.is_ascii_graphic() };
        if keep {
            out.push(char::from(value));
        } else {
            out.push_str(&format!("%{value:02X}"));
        }
    }
    out
}

/// Tells whether a rule fits the beginning of a path; `*` stands for anything, `$` at the end for the path's end.
fn fits(pattern: &[u8], path: &[u8]) -> bool {
    let (pattern, to_end) = match pattern.split_last() {
        Some((b'$', rest)) => (rest, true),
        _ => (pattern, false),
    };
    let mut parts = pattern.split(|b| *b == b'*');
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = path.strip_prefix(first) else { return false };
    let mut parts = parts.peekable();
    if parts.peek().is_none() {
        return !to_end || rest.is_empty();
    }
    while let Some(part) = parts.next() {
        if parts.peek().is_none() && to_end {
            return rest.ends_with(part);
        }
        let at = if part.is_empty() { Some(0) } else { rest.windows(part.len()).position(|w| w == part) };
        let Some(after) = at.and_then(|at| rest.get(at + part.len()..)) else { return false };
        rest = after;
    }
    true
}
