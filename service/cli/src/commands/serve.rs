//! `d3dgen serve`: the service; and what its operators need besides: tokens, backups.

mod notify;
mod settings;

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use clap::Subcommand;
use d3dgen_server::access::{digest, hex};
use d3dgen_server::clock::Clock;
use d3dgen_server::core::{Core, Programs};
use d3dgen_server::{backup, serve};

use crate::database::embedder;
use crate::error::Error;
use crate::input::write_text;
use crate::interrupt;

/// How often a wish to stop is looked for.
const POLL: Duration = Duration::from_millis(25);
/// Random bytes of a token.
const TOKEN_BYTES: usize = 32;

/// Arguments.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Args {
    #[command(subcommand)]
    action: Option<Action>,
    #[command(flatten)]
    settings: settings::SettingsArgs,
}

#[derive(Subcommand)]
enum Action {
    /// Make a token, and print it with the lines for the configuration file
    Token {
        /// Name of whoever gets it, for logs
        name: String,
        /// How much it allows
        #[arg(long, default_value = "read", value_parser = ["read", "write", "admin"])]
        scope: String,
    },
    /// Print the settings that file, variables and flags make, without secrets
    Check {
        #[command(flatten)]
        settings: settings::SettingsArgs,
    },
    /// Copy the databases of a server into a new folder below its backups/; a server that runs makes it itself when asked, by call or by file
    Backup {
        #[command(flatten)]
        settings: settings::SettingsArgs,
    },
    /// Ask a server whether it answers every call; status 0 when it does
    Health {
        /// Server to ask
        #[arg(long, value_name = "URL", default_value = "http://127.0.0.1:50051")]
        server: String,
        /// File (PEM) with the certificates that the server's is signed with; otherwise those the system trusts
        #[arg(long, value_name = "FILE")]
        ca: Option<PathBuf>,
        /// Part to ask for: store, index, lanes, or a service; otherwise all
        #[arg(long, default_value = "")]
        part: String,
    },
    /// Make the folder of a server's databases of a backup
    Restore {
        /// Folder of the backup
        backup: PathBuf,
        /// Folder to make: new or empty
        data_dir: PathBuf,
    },
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        match self.action {
            None => run(&self.settings),
            Some(Action::Token { name, scope }) => token(&name, &scope),
            Some(Action::Check { settings }) => write_text(None, &format!("{:#?}\n", settings.config()?)),
            Some(Action::Backup { settings }) => {
                let core = Core::open(settings.config()?, clock(), embedder()?, Programs::default())?;
                interrupt::listen();
                let made = backup::write(&core, interrupt::flag()).map_err(|s| Error::Input(s.message().to_owned()))?;
                write_text(
                    None,
                    &format!("{}: {} records, {} files\n", made.folder.display(), made.records, made.files),
                )
            }
            Some(Action::Health { server, ca, part }) => health(&server, ca, &part),
            Some(Action::Restore { backup, data_dir }) => {
                let records = backup::restore(&backup, &data_dir)?;
                write_text(None, &format!("{}: {records} records\n", data_dir.display()))
            }
        }
    }
}

/// Serves until the process is asked to stop; one line on standard output tells the address.
fn run(settings: &settings::SettingsArgs) -> Result<(), Error> {
    let config = settings.config()?;
    settings::start_log(&config.log_level);
    keep_private();
    let core = Core::open(config, clock(), embedder()?, programs())?;
    let runtime = serve::runtime(&core)?;
    interrupt::listen();
    let ready = |address| {
        let mut out = std::io::stdout().lock();
        // nobody may be listening any more; the log has it too
        let _ = writeln!(out, "listening on {address}").and_then(|()| out.flush());
        notify::tell("READY=1");
    };
    let stop = async {
        while !interrupt::flag().load(Ordering::SeqCst) {
            tokio::time::sleep(POLL).await;
        }
        notify::tell("STOPPING=1");
    };
    let asked = backups_on_request(Arc::clone(&core));
    runtime.block_on(async {
        tokio::spawn(asked);
        serve::serve(core, ready, stop).await
    })?;
    runtime.shutdown_timeout(Duration::from_secs(1));
    Ok(())
}

/// Writes a backup whenever somebody puts a file `backup.request` into the folder of the databases, and takes it away.
async fn backups_on_request(core: Arc<Core>) {
    let request = core.config.data_dir.join("backup.request");
    loop {
        tokio::time::sleep(Duration::from_secs(1)).await;
        if !request.exists() {
            continue;
        }
        let core = Arc::clone(&core);
        let made = tokio::task::spawn_blocking(move || backup::write(&core, interrupt::flag())).await;
        if let Ok(Err(status)) = made {
            tracing::error!(reason = status.message(), "no backup");
        }
        if let Err(error) = std::fs::remove_file(&request) {
            tracing::error!(reason = %error, "backup.request cannot be removed: no more backups on request");
            return;
        }
    }
}

/// Has every file that the server makes be for its own user only: tokens are in the settings, but what clients bring is here.
fn keep_private() {
    #[cfg(target_os = "linux")]
    let _ = rustix::process::umask(rustix::fs::Mode::from_raw_mode(0o077));
}

/// Asks a server whether it answers.
fn health(url: &str, ca: Option<PathBuf>, part: &str) -> Result<(), Error> {
    use tonic_health::pb::health_check_response::ServingStatus;
    let remote = crate::remote::Remote::to(url, ca.as_deref())?;
    let mut client = tonic_health::pb::health_client::HealthClient::new(remote.channel());
    let asked = tonic_health::pb::HealthCheckRequest { service: part.to_owned() };
    let answer = remote.ask(client.check(asked))?;
    match answer.status() {
        ServingStatus::Serving => write_text(None, "serving\n"),
        other => Err(Error::Input(format!("{url}: {}", other.as_str_name().to_lowercase().replace('_', " ")))),
    }
}

fn clock() -> Clock {
    Clock::new(|| SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default())
}

/// Returns this very program as the reader of files of others.
fn programs() -> Programs {
    let Ok(path) = std::env::current_exe() else { return Programs::default() };
    let arguments = vec!["assets".to_owned(), super::assets::reader::READ_MODELS.to_owned()];
    let limits = d3dgen_assets::readers::Limits::default();
    Programs {
        models: Some(d3dgen_assets::readers::Program { path, arguments, limits }),
        pdf: super::research::pdf_program(),
    }
}

fn token(name: &str, scope: &str) -> Result<(), Error> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes).map_err(|e| Error::Input(format!("the system gives no random numbers: {e}")))?;
    let token = format!("d3dgen_{}", hex(&bytes));
    let digest = hex(&digest(token.as_bytes()));
    let quoted = toml::Value::String(name.to_owned());
    eprintln!("the token is shown this once; the file needs only its digest:\n");
    write_text(None, &format!("# {token}\n[[tokens]]\nname = {quoted}\nscope = \"{scope}\"\nsha256 = \"{digest}\"\n"))
}
