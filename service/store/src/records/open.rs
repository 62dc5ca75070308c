//! How a folder becomes an open store: lock, format, upgrade, repair, and waiting for others.

use std::fs::File;
use std::io::ErrorKind;
use std::path::Path;
use std::time::Duration;

use super::loader::Loader;
use super::store::{Access, Options, Store};
use super::witness::Witness;
use super::{state, witness};
use crate::error::{Error, Result};
use crate::files;
use crate::format::{self, Found, Manifest};
use crate::kv::{Backend, KeyValue, Mode, Opened};
use crate::lock::{self, Lock};

pub(super) fn open(dir: &Path, access: Access, options: &Options) -> Result<Store> {
    match access {
        Access::Write => open_to_write(dir, options),
        Access::Read => open_to_read(dir, options),
    }
}

pub(super) fn create(dir: &Path, options: &Options) -> Result<Store> {
    fill(dir, options, |records| Loader::new(records).finish(0))
}

pub(super) fn open_or_create(dir: &Path, options: &Options) -> Result<Store> {
    if !format::is_free(dir)? {
        return open_to_write(dir, options);
    }
    match create(dir, options) {
        // Somebody else made it in this moment.
        Err(Error::Exists { .. }) => open_to_write(dir, options),
        made => made,
    }
}

/// Makes a store in `dir`, which is free, with what `load` puts into it. It is a store only when that is done: after a
/// crash the folder is free again.
pub(crate) fn fill(dir: &Path, options: &Options, load: impl FnOnce(&dyn KeyValue) -> Result<()>) -> Result<Store> {
    let backend = options.backend;
    if !backend.is_built_in() {
        return Err(Error::NoBackend { name: backend.name().to_owned() });
    }
    let exists = || Error::Exists { path: dir.to_path_buf() };
    if !format::is_free(dir)? {
        return Err(exists());
    }
    std::fs::create_dir_all(dir).map_err(Error::io(dir))?;
    let lock = Lock::take(dir, options.wait, backend.shares())?;
    // Again, now that nobody else can be at it.
    if !format::is_free(dir)? {
        return Err(exists());
    }
    let mut manifest = Manifest::new(backend, &options.written_by);
    let made = make(dir, &mut manifest, backend, options, load);
    if made.is_err() {
        // What is left counts as free anyhow; this gives its space back.
        let _ = format::remove(&manifest.records_path(dir)).and_then(|()| format::remove(&dir.join(format::FILE)));
    }
    Ok(Store::new(dir, backend, Access::Write, made?, Some(lock), Some(Witness::open(dir)?)))
}

fn make(
    dir: &Path,
    manifest: &mut Manifest,
    backend: Backend,
    options: &Options,
    load: impl FnOnce(&dyn KeyValue) -> Result<()>,
) -> Result<Box<dyn KeyValue>> {
    manifest.write(dir)?;
    let path = manifest.records_path(dir);
    format::remove(&path)?;
    format::remove(&dir.join(witness::FILE))?;
    format::sweep(dir, manifest)?;
    let records = ready(backend.open(&path, Mode::Create, options.cache_bytes)?, dir, backend)?;
    load(&*records)?;
    files::sync_folder(dir)?;
    manifest.complete = true;
    manifest.write(dir)?;
    Ok(records)
}

fn open_to_write(dir: &Path, options: &Options) -> Result<Store> {
    // First, so that no lock file is put into a folder that is none of ours.
    let shared = match Manifest::read(dir)? {
        Found::Current(manifest) => Backend::from_name(&manifest.backend)?.shares(),
        Found::Older(..) => false,
    };
    let lock = Lock::take(dir, options.wait, shared)?;
    format::upgrade(dir, options)?;
    let manifest = finished(dir)?;
    format::sweep(dir, &manifest)?;
    let backend = Backend::from_name(&manifest.backend)?;
    let records = ready(backend.open(&manifest.records_path(dir), Mode::Write, options.cache_bytes)?, dir, backend)?;
    let revision = check_loss(dir, &*records, witness::noted(dir), options)?;
    let mut witness = Witness::open(dir)?;
    if let (true, Some(revision)) = (options.accept_loss, revision) {
        witness.note(revision);
    }
    Ok(Store::new(dir, backend, Access::Write, records, Some(lock), Some(witness)))
}

fn open_to_read(dir: &Path, options: &Options) -> Result<Store> {
    let mut left = lock::retries(options.wait);
    loop {
        if let Found::Older(..) = Manifest::read(dir)? {
            let _lock = lock_to_change(dir, options.wait, "has an earlier format")?;
            format::upgrade(dir, options)?;
        }
        let manifest = finished(dir)?;
        let (backend, path) = (Backend::from_name(&manifest.backend)?, manifest.records_path(dir));
        if !backend.shares() {
            let lock = lock_to_change(dir, options.wait, "has a backend that writes even to read")?;
            let records = ready(backend.open(&path, Mode::Write, options.cache_bytes)?, dir, backend)?;
            check_loss(dir, &*records, witness::noted(dir), options)?;
            return Ok(Store::new(dir, backend, Access::Read, records, Some(lock), None));
        }
        // Before the records: a writer may be ahead of what it has noted, but not behind.
        let noted = witness::noted(dir);
        match backend.open(&path, Mode::Read, options.cache_bytes) {
            Ok(Opened::Ready(records)) => {
                check_loss(dir, &*records, noted, options)?;
                return Ok(Store::new(dir, backend, Access::Read, records, None, None));
            }
            Ok(Opened::NeedsRepair) if repair(dir, backend, &path, options)? => {}
            Ok(_) if left == 0 => return Err(in_use(dir, backend)),
            Ok(_) => std::thread::sleep(lock::PAUSE),
            // An upgrade has put others in their place since the manifest was read.
            Err(Error::Io { source, .. }) if left > 0 && source.kind() == ErrorKind::NotFound => {}
            Err(other) => return Err(other),
        }
        left = left.saturating_sub(1);
    }
}

/// Compares the records with what was noted, and returns their revision. What is damaged is left to those who read it.
fn check_loss(dir: &Path, records: &dyn KeyValue, noted: Option<u64>, options: &Options) -> Result<Option<u64>> {
    let revision = match state::revision(&*records.view()?) {
        Ok(revision) => revision,
        Err(Error::Damaged { .. }) => return Ok(None),
        Err(other) => return Err(other),
    };
    match noted {
        Some(noted) if noted > revision && !options.accept_loss => {
            let reason = format!("{noted} changes were acknowledged and only {revision} are there");
            Err(Error::Corrupt { path: dir.to_path_buf(), reason })
        }
        _ => Ok(Some(revision)),
    }
}

/// Lets the backend repair what a killed writer left. Returns false when another process is at it, or writes.
fn repair(dir: &Path, backend: Backend, path: &Path, options: &Options) -> Result<bool> {
    match lock_to_change(dir, Duration::ZERO, "was not closed by its last writer") {
        Ok(_lock) => ready(backend.open(path, Mode::Write, options.cache_bytes)?, dir, backend).map(|_| true),
        Err(Error::InUse { .. }) => Ok(false),
        Err(other) => Err(other),
    }
}

/// Takes the lock for a reader that has to change files; `what` tells why, where that is not allowed.
fn lock_to_change(dir: &Path, wait: Duration, what: &'static str) -> Result<Lock> {
    Lock::take(dir, wait, false).map_err(|e| match e {
        Error::Io { source, .. }
            if matches!(source.kind(), ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem) =>
        {
            Error::NeedsWriter { dir: dir.to_path_buf(), what }
        }
        other => other,
    })
}

/// Reads the manifest of a store of today.
fn finished(dir: &Path) -> Result<Manifest> {
    let not = |reason: &str| Error::NotAStore { dir: dir.to_path_buf(), reason: reason.to_owned() };
    match Manifest::read(dir)? {
        Found::Current(manifest) if manifest.complete => Ok(manifest),
        Found::Current(_) => Err(not("it is being made, or its making was interrupted: make it again")),
        Found::Older(..) => Err(not("it was put back to an earlier format while it was opened: open it again")),
    }
}

fn ready(opened: Opened, dir: &Path, backend: Backend) -> Result<Box<dyn KeyValue>> {
    match opened {
        Opened::Ready(records) => Ok(records),
        Opened::Busy | Opened::NeedsRepair => Err(in_use(dir, backend)),
    }
}

fn in_use(dir: &Path, backend: Backend) -> Error {
    let pid = File::open(dir.join(lock::FILE)).ok().and_then(|mut file| lock::holder(&mut file));
    Error::InUse { dir: dir.to_path_buf(), pid, shared: backend.shares() }
}
