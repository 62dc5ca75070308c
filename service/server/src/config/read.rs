//! Layers into a configuration: defaults, then a TOML text, then variables, then flags; a later one wins.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use serde::Deserialize;
use toml::{Table, Value};

use super::{Config, Jobs, Limits, Tls};
use crate::access::{Scope, Token, digest_from_hex};
use crate::error::Error;

/// What the names of variables begin with: `D3DGEN_SERVER_LISTEN`, `D3DGEN_SERVER_LIMITS__WORK_S`.
pub const PREFIX: &str = "D3DGEN_SERVER_";

/// The defaults, as a file would say them.
const DEFAULTS: &str = include_str!("../../data/defaults.toml");
const VERSION: u32 = 1;
/// Levels of the log.
const LEVELS: [&str; 4] = ["error", "warn", "info", "debug"];
/// Settings without a default.
const OPTIONAL: [&str; 3] = ["data_dir", "tls", "tokens"];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    version: u32,
    data_dir: Option<PathBuf>,
    listen: String,
    log_level: String,
    drain_s: f64,
    allow_plain_text: bool,
    read_roots: Vec<PathBuf>,
    data_sets: Vec<PathBuf>,
    cors_origins: Vec<String>,
    hosts: Vec<String>,
    fetch_documents: bool,
    #[serde(default)]
    tls: RawTls,
    #[serde(default)]
    tokens: Vec<RawToken>,
    limits: RawLimits,
    jobs: Jobs,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawTls {
    certificate_file: Option<PathBuf>,
    key_file: Option<PathBuf>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawToken {
    name: String,
    scope: Scope,
    sha256: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLimits {
    message_bytes: usize,
    upload_bytes: u64,
    connections: usize,
    connections_per_address: usize,
    calls: usize,
    calls_per_client: usize,
    rate_per_s: f64,
    burst: f64,
    threads: usize,
    waiting: usize,
    lookup_s: f64,
    work_s: f64,
    stream_s: f64,
}

fn wrong(place: &str, reason: impl Into<String>) -> Error {
    Error::Config { place: place.to_owned(), reason: reason.into() }
}

/// Returns the configuration that the layers make: name and text of a file, variables whose names begin with [`PREFIX`],
/// and flags as `(listen, 127.0.0.1:0)` or `(limits.work_s, 60)`.
///
/// # Errors
/// `Config` with the layer and the key at fault.
pub fn read(
    file: Option<(&str, &str)>,
    variables: &[(String, String)],
    flags: &[(String, String)],
    default_data_dir: Option<PathBuf>,
) -> Result<Config, Error> {
    let mut whole: Table = DEFAULTS.parse().map_err(|e: toml::de::Error| wrong("defaults", e.to_string()))?;
    if let Some((name, text)) = file {
        let table: Table = text.parse().map_err(|e: toml::de::Error| wrong(name, e.to_string()))?;
        if let Some(stranger) = stranger(&whole, &table) {
            return Err(wrong(name, format!("`{stranger}` is no setting; docs/server.md lists them")));
        }
        merge(&mut whole, table);
    }
    for (name, value) in variables {
        let Some(key) = name.strip_prefix(PREFIX) else { continue };
        let path = key.to_lowercase().replace("__", ".");
        set(&mut whole, &path, value).map_err(|reason| wrong(name, reason))?;
    }
    for (key, value) in flags {
        set(&mut whole, key, value).map_err(|reason| wrong(&format!("--{}", key.replace('_', "-")), reason))?;
    }
    let raw: Raw = whole.try_into().map_err(|e: toml::de::Error| wrong("configuration", e.message()))?;
    raw.check(default_data_dir)
}

/// Returns a key of a file that is no setting: where the layers are still apart, the file can be named.
fn stranger(known: &Table, given: &Table) -> Option<String> {
    given.iter().find_map(|(key, value)| match (known.get(key), value) {
        (Some(Value::Table(known)), Value::Table(given)) => {
            given.keys().find(|k| !known.contains_key(*k)).map(|inner| format!("{key}.{inner}"))
        }
        (None, _) if !OPTIONAL.contains(&key.as_str()) => Some(key.clone()),
        _ => None,
    })
}

fn merge(into: &mut Table, from: Table) {
    for (key, value) in from {
        match (into.get_mut(&key), value) {
            (Some(Value::Table(old)), Value::Table(new)) => merge(old, new),
            (_, value) => {
                into.insert(key, value);
            }
        }
    }
}

/// Sets the value at a dotted path; text that is no TOML value is taken as a string.
fn set(whole: &mut Table, path: &str, text: &str) -> Result<(), String> {
    let parsed = format!("v = {text}").parse::<Table>().ok().and_then(|mut t| t.remove("v"));
    let mut value = parsed.unwrap_or_else(|| Value::String(text.to_owned()));
    let mut table = whole;
    let (above, last) = path.rsplit_once('.').unwrap_or(("", path));
    for part in above.split('.').filter(|p| !p.is_empty()) {
        let inner = table.entry(part).or_insert_with(|| Value::Table(Table::new()));
        table = inner.as_table_mut().ok_or_else(|| format!("`{part}` is not a section"))?;
    }
    if table.get(last).is_some_and(Value::is_str) && !value.is_str() {
        value = Value::String(text.to_owned());
    }
    table.insert(last.to_owned(), value);
    Ok(())
}

impl Raw {
    fn check(self, default_data_dir: Option<PathBuf>) -> Result<Config, Error> {
        if self.version != VERSION {
            return Err(wrong("version", format!("is {}, this release reads {VERSION}", self.version)));
        }
        let listen: SocketAddr = self
            .listen
            .parse()
            .map_err(|_| wrong("listen", format!("`{}` is no address; write 127.0.0.1:50051", self.listen)))?;
        let data_dir = self.data_dir.or(default_data_dir);
        let data_dir = data_dir.ok_or_else(|| wrong("data_dir", "is missing: name the folder of the databases"))?;
        let tls = match (self.tls.certificate_file, self.tls.key_file) {
            (Some(certificate_file), Some(key_file)) => Some(Tls { certificate_file, key_file }),
            (None, None) => None,
            _ => return Err(wrong("tls", "needs both certificate_file and key_file")),
        };
        let tokens = self.tokens.into_iter().map(RawToken::check).collect::<Result<Vec<_>, _>>()?;
        let names: std::collections::BTreeSet<&str> = tokens.iter().map(|t| t.name.as_str()).collect();
        if names.len() != tokens.len() {
            return Err(wrong("tokens", "two have the same name"));
        }
        if !listen.ip().is_loopback() {
            let outside = format!("{listen} can be reached from outside");
            if tokens.is_empty() {
                return Err(wrong("listen", format!("{outside}: give tokens, or listen on 127.0.0.1")));
            }
            if tls.is_none() && !self.allow_plain_text {
                let ways =
                    "give tls.certificate_file and tls.key_file, or allow_plain_text = true where a proxy does TLS";
                return Err(wrong("listen", format!("{outside}: {ways}")));
            }
        }
        if !LEVELS.contains(&self.log_level.as_str()) {
            return Err(wrong("log_level", format!("`{}`: there are {}", self.log_level, LEVELS.join(", "))));
        }
        let is_origin = |o: &&String| o.starts_with("https://") || o.starts_with("http://");
        if let Some(origin) = self.cors_origins.iter().find(|o| !is_origin(o)) {
            return Err(wrong("cors_origins", format!("`{origin}` is no origin; write https://example.org")));
        }
        for (key, value) in
            [("jobs.workers", self.jobs.workers), ("jobs.batch_worlds", self.jobs.batch_worlds as usize)]
        {
            at_least_one(key, value)?;
        }
        Ok(Config {
            data_dir,
            listen,
            tls,
            tokens,
            cors_origins: self.cors_origins,
            hosts: self.hosts,
            read_roots: self.read_roots,
            data_sets: self.data_sets,
            fetch_documents: self.fetch_documents,
            limits: self.limits.check()?,
            jobs: self.jobs,
            drain: seconds("drain_s", self.drain_s)?,
            log_level: self.log_level,
        })
    }
}

impl RawToken {
    fn check(self) -> Result<Token, Error> {
        let place = format!("token `{}`", self.name);
        if self.name.is_empty() || self.name.len() > 64 || self.name.chars().any(char::is_control) {
            return Err(wrong(&place, "has no usable name"));
        }
        let digest = digest_from_hex(&self.sha256);
        let digest = digest.ok_or_else(|| {
            wrong(&place, "sha256 needs 64 hexadecimal digits; `d3dgen serve token` makes a token and prints them")
        })?;
        Ok(Token { name: self.name, scope: self.scope, digest })
    }
}

impl RawLimits {
    fn check(self) -> Result<Limits, Error> {
        for (key, value) in [
            ("limits.message_bytes", self.message_bytes),
            ("limits.connections", self.connections),
            ("limits.connections_per_address", self.connections_per_address),
            ("limits.calls", self.calls),
            ("limits.calls_per_client", self.calls_per_client),
        ] {
            at_least_one(key, value)?;
        }
        let positive = |key: &str, value: f64| match value.is_finite() && value > 0.0 {
            true => Ok(value),
            false => Err(wrong(key, format!("is {value}, needs more than 0"))),
        };
        let cores = std::thread::available_parallelism().map_or(2, usize::from);
        Ok(Limits {
            message_bytes: self.message_bytes,
            upload_bytes: self.upload_bytes,
            connections: self.connections,
            connections_per_address: self.connections_per_address,
            calls: self.calls,
            calls_per_client: self.calls_per_client,
            rate_per_s: positive("limits.rate_per_s", self.rate_per_s)?,
            burst: positive("limits.burst", self.burst)?.max(1.0),
            threads: if self.threads == 0 { cores } else { self.threads },
            waiting: self.waiting,
            lookup: seconds("limits.lookup_s", self.lookup_s)?,
            work: seconds("limits.work_s", self.work_s)?,
            stream: seconds("limits.stream_s", self.stream_s)?,
        })
    }
}

fn at_least_one(key: &str, value: usize) -> Result<(), Error> {
    if value == 0 { Err(wrong(key, "is 0, needs at least 1")) } else { Ok(()) }
}

fn seconds(key: &str, value: f64) -> Result<Duration, Error> {
    match (0.0..=1e6).contains(&value) {
        true => Ok(Duration::from_secs_f64(value)),
        false => Err(wrong(key, format!("is {value}, needs 0 to 1000000 seconds"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(all: &[(&str, &str)]) -> Vec<(String, String)> {
        all.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect()
    }

    fn configured(file: &str, variables: &[(&str, &str)], flags: &[(&str, &str)]) -> Result<Config, String> {
        let file = (!file.is_empty()).then_some(("server.toml", file));
        read(file, &pairs(variables), &pairs(flags), Some("data".into())).map_err(|e| e.to_string())
    }

    #[test]
    fn later_layers_win() {
        let file = "listen = \"127.0.0.1:1\"\n[limits]\nwork_s = 5\nwaiting = 7";
        let found = configured(file, &[("D3DGEN_SERVER_LIMITS__WORK_S", "6")], &[("listen", "[::1]:2")]).unwrap();
        assert_eq!(found.listen.to_string(), "[::1]:2");
        assert_eq!((found.limits.work.as_secs(), found.limits.waiting), (6, 7));
        assert_eq!(found.data_dir, PathBuf::from("data"));
        assert!(found.limits.threads > 0);
    }

    #[test]
    fn what_cannot_be_meant_is_refused_with_its_place() {
        let token = format!("[[tokens]]\nname = \"a\"\nscope = \"read\"\nsha256 = \"{}\"", "0".repeat(64));
        type Case<'a> = (&'a str, &'a [(&'a str, &'a str)], &'a str);
        let cases: [Case<'_>; 9] = [
            ("listne = 1", &[], "server.toml: `listne` is no setting"),
            ("[limits]\nspeed = 1", &[], "limits.speed"),
            ("version = 2", &[], "version"),
            ("", &[("listen", "localhost")], "`localhost` is no address"),
            ("", &[("listen", "0.0.0.0:1")], "give tokens"),
            (&token, &[("listen", "0.0.0.0:1")], "tls.certificate_file"),
            ("[tls]\nkey_file = \"k\"", &[], "needs both"),
            ("[[tokens]]\nname = \"a\"\nscope = \"read\"\nsha256 = \"ab\"", &[], "token `a`"),
            ("[jobs]\nworkers = 0", &[], "jobs.workers"),
        ];
        for (file, flags, expected) in cases {
            let message = configured(file, &[], flags).expect_err(expected);
            assert!(message.contains(expected), "{message}");
        }
        assert!(configured("", &[("D3DGEN_SERVER_NOTHING", "1")], &[]).is_err());
    }
}
