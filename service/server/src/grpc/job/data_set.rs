//! Data sets among the jobs: those that an administrator sees in the folders of the configuration.

use std::time::Duration;

use d3dgen_dataset::standing::{Doing, Standing};
use d3dgen_proto::v1::{DataSetResult, Job as JobMessage, JobLog, JobState, LogLevel, Progress, WatchJobResponse, job};
use tokio::sync::mpsc;
use tonic::Status;

use super::super::{Api, timestamp};
use crate::access::{Caller, Scope};
use crate::data_sets::{self, Found};

/// Name of the kind.
pub(super) const KIND: &str = "data_set";
/// How often a watch looks at one.
const LOOK: Duration = Duration::from_secs(1);

impl Api {
    /// Returns a data set by its id among the jobs, for those who may see it.
    pub(super) fn data_set(&self, id: &str, caller: &Caller) -> Option<Found> {
        let roots = Some(&self.core.config.data_sets).filter(|_| caller.scope >= Scope::Admin)?;
        data_sets::get(roots, id)
    }

    /// Returns the data sets that a caller may see, as jobs; one that cannot be read is a job that failed.
    pub(super) fn data_sets(&self, caller: &Caller) -> Vec<JobMessage> {
        if caller.scope < Scope::Admin {
            return Vec::new();
        }
        data_sets::all(&self.core.config.data_sets)
            .iter()
            .map(|found| message(found).unwrap_or_else(|e| damaged(found, &e)))
            .collect()
    }

    /// Sends how far a data set is until no run adds to it.
    pub(super) async fn watch_data_set(
        &self,
        found: Found,
        with_logs: bool,
        send: mpsc::Sender<Result<WatchJobResponse, Status>>,
    ) {
        let mut last = None;
        let mut seen = 0;
        loop {
            let found = found.clone();
            let event = self.lookup(move |_| {
                let job = message(&found)?;
                Ok((job, if with_logs { logs(&found, usize::MAX)? } else { Vec::new() }))
            });
            let (job, all) = match event.await {
                Ok(event) => event.into_inner(),
                Err(refused) => return drop(send.send(Err(refused)).await),
            };
            let ended = job.state != JobState::Running as i32;
            let logs = all.into_iter().skip(seen).collect::<Vec<_>>();
            seen += logs.len();
            if last.as_ref() != Some(&job) || !logs.is_empty() {
                last = Some(job.clone());
                if send.send(Ok(WatchJobResponse { job: Some(job), logs })).await.is_err() {
                    return;
                }
            }
            if ended {
                return;
            }
            tokio::select! {
                () = tokio::time::sleep(LOOK) => {}
                () = send.closed() => return,
            }
        }
    }
}

/// Returns a data set as clients see it.
pub(super) fn message(found: &Found) -> Result<JobMessage, Status> {
    let standing = found.standing()?;
    let Standing { tasks, worlds, failed, bytes, pace, .. } = standing;
    let state = match standing.doing {
        Doing::Running => JobState::Running,
        Doing::Stopped => JobState::Cancelled,
        Doing::Finished => JobState::Succeeded,
    };
    let result = DataSetResult {
        task_count: tasks,
        world_count: worlds,
        failed_count: failed,
        bytes,
        tasks_per_second: pace.map(|p| p.per_second),
        seconds_left: pace.map(|p| p.seconds_left),
    };
    let message = format!("{} of {tasks} tasks", standing.done());
    let fraction = standing.done() as f64 / tasks.max(1) as f64;
    Ok(JobMessage {
        title: standing.name.clone(),
        state: state as i32,
        progress: Some(Progress { stage: KIND.into(), fraction, message }),
        result: Some(job::Result::DataSet(result)),
        ..plain(found)
    })
}

fn damaged(found: &Found, why: &Status) -> JobMessage {
    let error = d3dgen_proto::v1::JobError {
        code: crate::status::code_name(why.code()).into(),
        message: why.message().into(),
        problems: Vec::new(),
    };
    JobMessage { state: JobState::Failed as i32, title: found.id.clone(), error: Some(error), ..plain(found) }
}

fn plain(found: &Found) -> JobMessage {
    let begun = found.begun_ms().map(timestamp);
    JobMessage {
        job_id: found.id.clone(),
        kind: KIND.into(),
        created_at: begun,
        started_at: begun,
        run_count: 1,
        ..JobMessage::default()
    }
}

/// Returns the tasks that came to no world, a line each, in the order of the tasks.
pub(super) fn logs(found: &Found, most: usize) -> Result<Vec<JobLog>, Status> {
    let line = |(seq, failure): (u64, d3dgen_dataset::row::Failure)| JobLog {
        seq,
        written_at: None,
        level: LogLevel::Warning as i32,
        message: format!("`{}`, seed {}: {}", failure.prompt, failure.seed, failure.reason),
    };
    Ok((1..).zip(found.failed(most)?).map(line).collect())
}
