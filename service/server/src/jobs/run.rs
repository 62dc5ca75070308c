//! What a job works with: its record, its folder, the wish to stop, and how it tells what it has done.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use d3dgen_store::Batch;
use serde::Serialize;
use tonic::Status;

use super::{Job, Jobs, Level, Spec, batch, ingest, research};
use crate::core::Core;
use crate::pool::Stop;
use crate::status;

/// How a run ends that lets others go first.
pub(super) const GIVES_WAY: &str = "others wait";

/// A run of a job.
pub struct Run {
    /// What the server has.
    pub core: Arc<Core>,
    /// The job as it was when the run began.
    pub job: Job,
    stop: Stop,
}

impl Run {
    /// Runs jobs until the server stops.
    pub async fn work(core: Arc<Core>) {
        while let Some((job, stop)) = core.jobs.next().await {
            let id = job.id.clone();
            let run = Self { core: Arc::clone(&core), job, stop };
            let done = tokio::task::spawn_blocking(move || run.run()).await;
            core.jobs.end(&id, done.unwrap_or_else(|panic| Err(status::internal(&panic))));
            match core.jobs.forget() {
                Ok(gone) => gone.iter().for_each(|id| core.remove_files_of(id)),
                Err(error) => tracing::error!(reason = %error, "old jobs cannot be removed"),
            }
        }
    }

    fn run(&self) -> Result<serde_json::Value, Status> {
        match &self.job.spec {
            Spec::Batch(spec) => batch::run(self, spec),
            Spec::Ingest(spec) => ingest::run(self, spec),
            Spec::Research(spec) => research::run(self, spec),
        }
    }

    fn jobs(&self) -> &Jobs {
        &self.core.jobs
    }

    /// Returns the job's folder for files, which is there.
    ///
    /// # Errors
    /// `INTERNAL` when it cannot be made.
    pub fn dir(&self) -> Result<PathBuf, Status> {
        let dir = self.core.job_dir(&self.job.id);
        std::fs::create_dir_all(&dir).map_err(|e| status::io(&e))?;
        Ok(dir)
    }

    /// Returns the flag that is set when the job is to stop.
    pub fn flag(&self) -> &AtomicBool {
        &self.stop
    }

    /// Returns an error when the job is to stop.
    ///
    /// # Errors
    /// `CANCELLED`.
    pub fn check(&self) -> Result<(), Status> {
        if self.stop.load(Ordering::SeqCst) { Err(Status::cancelled("stopped")) } else { Ok(()) }
    }

    /// Returns an error when other jobs wait for their turn; what is finished is kept by then.
    ///
    /// # Errors
    /// `UNAVAILABLE`: the job goes back into the queue, and on from there.
    pub fn give_way(&self) -> Result<(), Status> {
        match self.jobs().is_waiting() {
            true => Err(Status::unavailable(GIVES_WAY)),
            false => Ok(()),
        }
    }

    /// Returns how many things to do side by side: as many as there are processors, one while calls wait for them.
    pub fn cores(&self) -> usize {
        let calls_wait = self.core.metrics.waiting.load(Ordering::Relaxed) > 0;
        if calls_wait { 1 } else { self.core.config.limits.threads }
    }

    /// Shows how far the job is.
    pub fn step(&self, stage: &str, fraction: f64, message: &str) {
        self.jobs().show(&self.job.id, |job| {
            stage.clone_into(&mut job.stage);
            message.clone_into(&mut job.message);
            job.fraction = job.fraction.max(fraction.clamp(0.0, 1.0));
        });
    }

    /// Keeps what is finished; `also` goes to the disk with it.
    ///
    /// # Errors
    /// `INTERNAL` when it cannot be kept.
    pub fn checkpoint<T: Serialize>(&self, value: &T, also: impl FnOnce(&mut Batch)) -> Result<(), Status> {
        let value = serde_json::to_value(value).map_err(|e| status::internal(&e))?;
        let kept = self.jobs().change(&self.job.id, |job, batch| {
            job.checkpoint = value;
            job.cut_short = 0;
            also(batch);
        });
        kept.map(drop).map_err(status::own)
    }

    /// Writes a line into the job's log.
    pub fn log(&self, level: Level, text: &str) {
        let kept = self.jobs().change(&self.job.id, |job, batch| self.jobs().line(job, batch, level, text));
        if let Err(error) = kept {
            tracing::error!(job = self.job.id, reason = %error, "a line of a job cannot be kept");
        }
    }
}

/// Removes a folder, if it is there.
pub(crate) fn remove_dir(dir: &Path) {
    match std::fs::remove_dir_all(dir) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            tracing::warn!(path = %dir.display(), reason = %e, "cannot be removed");
        }
        _ => {}
    }
}
