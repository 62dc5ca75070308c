//! Where the settings of a server come from: a file, variables, flags.

use std::path::PathBuf;

use d3dgen_server::Config;
use d3dgen_server::config::{PREFIX, read};

use crate::error::Error;

/// Variable that names the file.
const FILE_VARIABLE: &str = "D3DGEN_CONFIG";

/// Flags of `serve`.
#[derive(clap::Args, Clone, Default)]
pub struct SettingsArgs {
    /// Settings in TOML; otherwise $D3DGEN_CONFIG. Variables such as D3DGEN_SERVER_LIMITS__WORK_S go before it
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Address to listen on; port 0 takes a free one
    #[arg(long, value_name = "ADDRESS")]
    listen: Option<String>,
    /// Folder of the databases; otherwise d3dgen in the user's data folder
    #[arg(long, value_name = "DIR")]
    data_dir: Option<PathBuf>,
    /// Any setting, such as limits.work_s=60; may be given more than once
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl SettingsArgs {
    /// Returns the checked settings.
    ///
    /// # Errors
    /// `Read` when the file cannot be read, `Server` with what is wrong and where it stands.
    pub fn config(&self) -> Result<Config, Error> {
        let path = self.config.clone().or_else(|| std::env::var_os(FILE_VARIABLE).map(PathBuf::from));
        let file = match path {
            Some(path) => {
                let text =
                    std::fs::read_to_string(&path).map_err(|source| Error::Read { path: path.clone(), source })?;
                Some((path.display().to_string(), text))
            }
            None => None,
        };
        let file = file.as_ref().map(|(name, text)| (name.as_str(), text.as_str()));
        let variables: Vec<(String, String)> = std::env::vars_os()
            .filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)))
            .filter(|(name, _)| name.starts_with(PREFIX))
            .collect();
        let mut flags = Vec::new();
        for pair in &self.set {
            let (key, value) = pair
                .split_once('=')
                .ok_or_else(|| Error::Input(format!("--set {pair}: write KEY=VALUE, such as limits.work_s=60")))?;
            flags.push((key.trim().to_owned(), value.trim().to_owned()));
        }
        if let Some(listen) = &self.listen {
            flags.push(("listen".to_owned(), listen.clone()));
        }
        if let Some(dir) = &self.data_dir {
            flags.push(("data_dir".to_owned(), dir.display().to_string()));
        }
        Ok(read(file, &variables, &flags, crate::database::data_folder())?)
    }
}

/// Writes the log as lines of JSON on standard error.
pub fn start_log(level: &str) {
    use tracing_subscriber::filter::{LevelFilter, Targets};
    use tracing_subscriber::layer::SubscriberExt;
    use tracing_subscriber::util::SubscriberInitExt;
    let level = level.parse().unwrap_or(LevelFilter::INFO);
    // other crates speak of their own affairs: only what went wrong there
    let filter = Targets::new().with_default(LevelFilter::WARN.min(level)).with_target("d3dgen", level);
    let filter = ["d3dgen_server", "d3dgen_cli"].into_iter().fold(filter, |f, name| f.with_target(name, level));
    let lines = tracing_subscriber::fmt::layer()
        .json()
        .flatten_event(true)
        .with_current_span(false)
        .with_span_list(false)
        .with_writer(std::io::stderr);
    // a second server in one process has the log of the first
    let _ = tracing_subscriber::registry().with(filter).with(lines).try_init();
}
