//! `d3dgen knowledge verify`.

use crate::error::Error;
use crate::input::write_lines;
use crate::interrupt;
use crate::progress::Progress;
use crate::registry::RegistryArgs;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let database = self.registry.store.open_as_it_is()?;
        interrupt::listen();
        let progress = Progress::of(1);
        let damage =
            database.verify(&mut |done, all| progress.doing(&format!("records: {done} of {all}")), interrupt::flag());
        progress.finish();
        let damage = damage?;
        let (constraints, references) = database.counts()?;
        if self.json {
            let listed: Vec<_> =
                damage.iter().map(|d| serde_json::json!({"place": d.place, "reason": d.reason})).collect();
            let line = serde_json::json!({
                "sound": damage.is_empty(), "constraints": constraints, "references": references, "damage": listed,
            });
            write_lines([line])?;
        } else {
            for d in &damage {
                eprintln!("{}: {}", d.place, d.reason);
            }
        }
        if !damage.is_empty() {
            return Err(Error::Input(format!(
                "{} of the database's entries are damaged and not served; restore a snapshot, or import them again",
                damage.len()
            )));
        }
        if !self.json {
            eprintln!("sound: {constraints} rules of {references} documents");
        }
        Ok(())
    }
}
