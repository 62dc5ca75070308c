//! How stores of earlier formats become stores of today, one step after the other.
//!
//! A step writes new records beside the old ones and then `store.json`, which is what counts: when it is interrupted,
//! the old store is still whole, and the next open begins the step again.

use std::ops::ControlFlow;
use std::path::Path;

use serde::Deserialize;

use super::{Found, Manifest, remove};
use crate::error::{Error, Result};
use crate::kv::{Backend, KeyRange, KeyValue, Mode, Opened};
use crate::records::{Loader, Options, wrap};

/// One step.
pub(crate) struct Upgrade {
    /// The format it begins with; it ends with the next one.
    pub(crate) from: u32,
    run: fn(&Path, serde_json::Value, &Options) -> Result<()>,
}

/// All steps, in their order. `tests/samples/` has a store of each format.
pub(crate) const UPGRADES: &[Upgrade] = &[
    // Format 1 had the bare payloads. Format 2 surrounds them with checksums, counts changes and keys, and names the
    // file of the records in `store.json`.
    Upgrade { from: 1, run: checksums_and_counts },
];

/// Brings the store in `dir` to the format of today. Only the holder of its lock may do so.
pub(crate) fn upgrade(dir: &Path, options: &Options) -> Result<()> {
    loop {
        let (format, value) = match Manifest::read(dir)? {
            Found::Current(_) => return Ok(()),
            Found::Older(format, value) => (format, value),
        };
        let step = UPGRADES.iter().find(|step| step.from == format).ok_or_else(|| Error::NotAStore {
            dir: dir.to_path_buf(),
            reason: format!("there has never been a format {format}: restore a snapshot into a new folder"),
        })?;
        (step.run)(dir, value, options)?;
    }
}

#[derive(Deserialize)]
struct Format1 {
    backend: String,
}

fn checksums_and_counts(dir: &Path, value: serde_json::Value, options: &Options) -> Result<()> {
    let old: Format1 = serde_json::from_value(value).map_err(|e| Error::NotAStore {
        dir: dir.to_path_buf(),
        reason: format!("{} cannot be read ({e}): restore a snapshot into a new folder", super::FILE),
    })?;
    let backend = Backend::from_name(&old.backend)?;
    let from_path = dir.join(format!("records.{}", backend.name()));
    let mut manifest = Manifest::new(backend, &options.written_by);
    let to_path = manifest.records_path(dir);
    remove(&to_path)?;
    {
        let from = ready(backend.open(&from_path, Mode::Write, options.cache_bytes)?, dir)?;
        let to = ready(backend.open(&to_path, Mode::Create, options.cache_bytes)?, dir)?;
        let view = from.view()?;
        let mut loader = Loader::new(&*to);
        for table in view.tables()? {
            view.scan(&table, &KeyRange::all(), &mut |key, payload| {
                loader.add(&table, key, wrap(&table, key, payload))?;
                Ok(ControlFlow::Continue(()))
            })?;
        }
        loader.finish(1)?;
    }
    crate::files::sync_folder(dir)?;
    manifest.complete = true;
    manifest.write(dir)?;
    remove(&from_path)
}

fn ready(opened: Opened, dir: &Path) -> Result<Box<dyn KeyValue>> {
    match opened {
        Opened::Ready(records) => Ok(records),
        Opened::Busy | Opened::NeedsRepair => Err(Error::InUse { dir: dir.to_path_buf(), pid: None, shared: false }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_lead_from_the_first_format_to_that_of_today() {
        let from: Vec<_> = UPGRADES.iter().map(|step| step.from).collect();
        assert_eq!(from, (1..super::super::FORMAT).collect::<Vec<_>>());
    }
}
