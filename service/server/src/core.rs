//! What all services work with: databases, domains, jobs, threads, the clock.

use std::path::PathBuf;
use std::sync::Arc;

use arc_swap::ArcSwap;
use d3dgen_knowledge::database::{Change, Provenance};
use d3dgen_store::embed::Embedder;
use tokio::sync::{Mutex, MutexGuard, OwnedMutexGuard};
use tonic::Status;

use crate::clock::Clock;
use crate::config::Config;
use crate::databases::Databases;
use crate::domains::Domains;
use crate::error::Error;
use crate::health::Health;
use crate::jobs::Jobs;
use crate::metrics::Metrics;
use crate::pool::Pool;
use crate::status;

/// Programs that read files of others, in processes of their own.
#[derive(Debug, Clone, Default)]
pub struct Programs {
    /// Reads 3D models; none where the server was started without.
    pub models: Option<d3dgen_assets::readers::Program>,
    /// Reads PDF files.
    pub pdf: Option<d3dgen_research::read::pdf::Program>,
}

/// What a server has.
pub struct Core {
    /// What it was told.
    pub config: Config,
    /// The date.
    pub clock: Clock,
    /// Counters.
    pub metrics: Arc<Metrics>,
    /// Threads.
    pub pool: Pool,
    /// Records, rules, assets.
    pub databases: Databases,
    /// Kinds of building.
    pub domains: Domains,
    /// Long work.
    pub jobs: Jobs,
    /// Programs that read files of others.
    pub programs: Programs,
    /// What is well, as it was looked at last.
    pub health: ArcSwap<Health>,
    writing: Arc<Mutex<()>>,
}

impl Core {
    /// Opens everything; indexes are opened by [`Core::open_indexes`].
    ///
    /// # Errors
    /// `Store`, `Knowledge`, `Assets`, `Domain`, `Record`, `File`.
    pub fn open(
        config: Config,
        clock: Clock,
        embedder: Arc<dyn Embedder>,
        programs: Programs,
    ) -> Result<Arc<Self>, Error> {
        let metrics = Arc::new(Metrics::default());
        let databases = Databases::open(&config.data_dir, embedder)?;
        let release = concat!("d3dgen ", env!("CARGO_PKG_VERSION"));
        let by =
            Provenance { who: release.into(), when: clock.text(), why: format!("the rules shipped with {release}") };
        let domains = Domains::open(&databases, &by)?;
        let jobs = Jobs::open(&databases.own, config.jobs.clone(), clock.clone(), Arc::clone(&metrics))?;
        let pool = Pool::new(config.limits.threads, config.limits.waiting, Arc::clone(&metrics));
        let writing = Arc::default();
        let early = Health { store: Ok(()), index: Err("is being made".into()), lanes: Ok(()) };
        let health = ArcSwap::from_pointee(early);
        let core = Self { config, clock, metrics, pool, databases, domains, jobs, programs, health, writing };
        core.remove_leftovers();
        Ok(Arc::new(core))
    }

    /// Opens the indexes, made anew where they are missing or stale.
    ///
    /// # Errors
    /// `Knowledge`, `Assets`.
    pub fn open_indexes(&self) -> Result<(), Error> {
        self.databases.index_rules()?;
        self.databases.index_assets(&self.domains.now().catalog)
    }

    /// Waits on its thread until nobody else changes rules, assets or domains; for jobs, which have threads of their own.
    ///
    /// # Panics
    /// On a thread that answers calls: those wait with [`Core::turn`].
    pub fn writing(&self) -> MutexGuard<'_, ()> {
        self.writing.blocking_lock()
    }

    /// Waits without a thread until nobody else changes rules, assets or domains.
    pub async fn turn(&self) -> OwnedMutexGuard<()> {
        Arc::clone(&self.writing).lock_owned().await
    }

    /// Changes rules; searches and worlds know of it when this returns.
    ///
    /// # Errors
    /// What `change` returns; `INTERNAL` when the index cannot be made.
    pub fn change_rules(
        &self,
        change: impl FnOnce(&d3dgen_knowledge::database::Database) -> Result<Option<Change>, d3dgen_knowledge::Error>,
    ) -> Result<Option<Change>, Status> {
        let _alone = self.writing();
        let changed = change(&self.databases.rules).map_err(status::knowledge)?;
        if let Some(changed) = &changed {
            self.changed_rules(changed)?;
        }
        Ok(changed)
    }

    /// Makes searches and worlds know of a change of rules; for a caller that has its turn ([`Core::turn`]).
    ///
    /// # Errors
    /// `INTERNAL` when the index cannot be made.
    pub fn changed_rules(&self, change: &Change) -> Result<(), Status> {
        self.domains.refresh_rules(&self.databases, &change.domain).map_err(status::own)?;
        self.databases.index_change(change).map_err(status::own)
    }

    /// Makes searches and worlds know of changed assets: kept ones by their ids, objects of the library by theirs.
    ///
    /// # Errors
    /// `INTERNAL` when the index cannot be made.
    pub fn changed_assets(&self, changed: &[String]) -> Result<(), Status> {
        let now = self.domains.refresh_assets(&self.databases).map_err(status::own)?;
        self.databases.index_changed_assets(&now.catalog, changed).map_err(status::own)
    }

    /// Returns who changes something now, and why.
    pub fn provenance(&self, who: &str, why: &str) -> Provenance {
        Provenance { who: who.to_owned(), when: self.clock.text(), why: why.to_owned() }
    }

    /// Returns the folder of a job's files.
    pub fn job_dir(&self, id: &str) -> PathBuf {
        self.config.data_dir.join("jobs").join(id)
    }

    /// Returns the folder of the files that were uploaded for a job.
    pub fn upload_dir(&self, id: &str) -> PathBuf {
        self.config.data_dir.join("uploads").join(id)
    }

    /// Removes the files of a job that is forgotten.
    pub fn remove_files_of(&self, id: &str) {
        for dir in [self.job_dir(id), self.upload_dir(id)] {
            if let Err(e) = std::fs::remove_dir_all(&dir)
                && e.kind() != std::io::ErrorKind::NotFound
            {
                tracing::warn!(path = %dir.display(), reason = %e, "cannot be removed");
            }
        }
    }

    /// Removes uploads and folders whose job was never acknowledged.
    fn remove_leftovers(&self) {
        for folder in ["uploads", "jobs"] {
            let Ok(entries) = std::fs::read_dir(self.config.data_dir.join(folder)) else { continue };
            for name in entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()) {
                if self.jobs.get(&name).is_none() {
                    self.remove_files_of(&name);
                }
            }
        }
    }
}
