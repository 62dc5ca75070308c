//! `JobService`.

mod data_set;

use std::time::Duration;

use d3dgen_proto::v1::job_service_server::JobService;
use d3dgen_proto::v1::{
    BatchResult, CancelJobRequest, CancelJobResponse, GetJobRequest, GetJobResponse, IngestResult, IngestedFile,
    Job as JobMessage, JobError, JobLog, JobState, ListJobLogsRequest, ListJobLogsResponse, ListJobsRequest,
    ListJobsResponse, LogLevel, Problem, Progress, ResearchResult, ResumeJobRequest, ResumeJobResponse,
    WatchJobRequest, WatchJobResponse, job,
};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Request, Response, Status};

use super::page::Page;
use super::{Answer, Api, caller, timestamp};
use crate::access::{Caller, Scope};
use crate::jobs::batch::Done;
use crate::jobs::research::Found;
use crate::jobs::{Job, Level, Line, Spec, State, ingest, no_job};
use crate::status;

/// Shortest time between two events of a watch.
const PAUSE: Duration = Duration::from_millis(100);
/// Lines of one event.
const LINES: usize = 200;

/// Returns true when a caller may see a job: their own, or any as an administrator.
fn is_of(job: &Job, caller: &Caller) -> bool {
    caller.scope >= Scope::Admin || job.owner == caller.name
}

impl Api {
    /// Returns a job that the caller may see; other clients' jobs are as if they were not there.
    pub(super) fn job_of(&self, id: &str, caller: &Caller) -> Result<Job, Status> {
        self.core.jobs.get(id).filter(|job| is_of(job, caller)).ok_or_else(|| no_job(id))
    }

    fn logs(&self, id: &str, after: u64, most: usize) -> Result<Vec<JobLog>, Status> {
        let lines = self.core.jobs.lines(id, after, most).map_err(status::own)?;
        Ok(lines.into_iter().map(log).collect())
    }
}

#[tonic::async_trait]
impl JobService for Api {
    async fn list_jobs(&self, request: Request<ListJobsRequest>) -> Answer<ListJobsResponse> {
        let caller = caller(&request);
        let mut asked = request.into_inner();
        let (size, token) = (std::mem::take(&mut asked.page_size), std::mem::take(&mut asked.page_token));
        let page = Page::new(size, &token, &asked)?;
        for state in &asked.states {
            JobState::try_from(*state).map_err(|_| status::invalid("states", format!("{state} is no state")))?;
        }
        let fits = |job: &Job| {
            is_of(job, &caller)
                && (asked.states.is_empty() || asked.states.contains(&(state(job.state) as i32)))
                && asked.kind.as_ref().is_none_or(|kind| kind == job.spec.kind())
        };
        let own = self.core.jobs.list(fits).into_iter().map(|job| JobMessage { result: None, ..message(&job) });
        let own: Vec<JobMessage> = own.collect();
        let api = self.clone();
        self.lookup(move |_| {
            let wanted = asked.kind.as_ref().is_none_or(|kind| kind == data_set::KIND);
            let mut sets = if wanted { api.data_sets(&caller) } else { Vec::new() };
            sets.retain(|set| asked.states.is_empty() || asked.states.contains(&set.state));
            let (jobs, next_page_token) = page.cut(sets.into_iter().chain(own));
            Ok(ListJobsResponse { jobs, next_page_token })
        })
        .await
    }

    async fn get_job(&self, request: Request<GetJobRequest>) -> Answer<GetJobResponse> {
        if let Some(found) = self.data_set(&request.get_ref().job_id, &caller(&request)) {
            return self.lookup(move |_| Ok(GetJobResponse { job: Some(data_set::message(&found)?) })).await;
        }
        let job = self.job_of(&request.get_ref().job_id, &caller(&request))?;
        Ok(Response::new(GetJobResponse { job: Some(message(&job)) }))
    }

    type WatchJobStream = ReceiverStream<Result<WatchJobResponse, Status>>;

    async fn watch_job(&self, request: Request<WatchJobRequest>) -> Answer<Self::WatchJobStream> {
        let caller = caller(&request);
        let asked = request.into_inner();
        let (send, receive) = mpsc::channel(4);
        let api = self.clone();
        if let Some(found) = self.data_set(&asked.job_id, &caller) {
            tokio::spawn(async move { api.watch_data_set(found, asked.include_logs, send).await });
            return Ok(Response::new(ReceiverStream::new(receive)));
        }
        self.job_of(&asked.job_id, &caller)?;
        let mut changes = self.core.jobs.changes();
        tokio::spawn(async move {
            let mut seen = 0;
            loop {
                changes.mark_unchanged();
                let event = api.job_of(&asked.job_id, &caller).and_then(|job| {
                    let logs = if asked.include_logs { api.logs(&job.id, seen, LINES)? } else { Vec::new() };
                    Ok((job, logs))
                });
                let (job, logs) = match event {
                    Ok(found) => found,
                    Err(refused) => return drop(send.send(Err(refused)).await),
                };
                seen = logs.last().map_or(seen, |l| l.seq);
                let ended = job.state.is_ended() && (!asked.include_logs || logs.len() < LINES);
                let behind = logs.len() == LINES;
                if send.send(Ok(WatchJobResponse { job: Some(message(&job)), logs })).await.is_err() || ended {
                    return;
                }
                if behind {
                    continue;
                }
                tokio::select! {
                    changed = changes.changed() => if changed.is_err() { return },
                    () = send.closed() => return,
                }
                tokio::time::sleep(PAUSE).await;
            }
        });
        Ok(Response::new(ReceiverStream::new(receive)))
    }

    async fn cancel_job(&self, request: Request<CancelJobRequest>) -> Answer<CancelJobResponse> {
        if let Some(found) = self.data_set(&request.get_ref().job_id, &caller(&request)) {
            let stop = move || found.stop().and_then(|()| data_set::message(&found));
            return self.lookup(move |_| Ok(CancelJobResponse { job: Some(stop()?) })).await;
        }
        let id = self.job_of(&request.get_ref().job_id, &caller(&request))?.id;
        let core = self.core.clone();
        self.lookup(move |_| Ok(CancelJobResponse { job: Some(message(&core.jobs.cancel(&id)?)) })).await
    }

    async fn resume_job(&self, request: Request<ResumeJobRequest>) -> Answer<ResumeJobResponse> {
        if self.data_set(&request.get_ref().job_id, &caller(&request)).is_some() {
            let how =
                "this server does not make the data set: run the command that made it again, it goes on from there";
            return Err(Status::failed_precondition(how));
        }
        let id = self.job_of(&request.get_ref().job_id, &caller(&request))?.id;
        let core = self.core.clone();
        self.lookup(move |_| Ok(ResumeJobResponse { job: Some(message(&core.jobs.resume(&id)?)) })).await
    }

    async fn list_job_logs(&self, request: Request<ListJobLogsRequest>) -> Answer<ListJobLogsResponse> {
        let caller = caller(&request);
        let mut asked = request.into_inner();
        let (size, token) = (std::mem::take(&mut asked.page_size), std::mem::take(&mut asked.page_token));
        let page = Page::new(size, &token, &asked)?;
        if let Some(found) = self.data_set(&asked.job_id, &caller) {
            let look = move || data_set::logs(&found, page.wanted()).map(|all| page.cut(all));
            return self
                .lookup(move |_| look().map(|(logs, next_page_token)| ListJobLogsResponse { logs, next_page_token }))
                .await;
        }
        let id = self.job_of(&asked.job_id, &caller)?.id;
        let api = self.clone();
        self.lookup(move |_| {
            let (logs, next_page_token) = page.cut(api.logs(&id, 0, page.wanted())?);
            Ok(ListJobLogsResponse { logs, next_page_token })
        })
        .await
    }
}

fn state(state: State) -> JobState {
    match state {
        State::Queued => JobState::Queued,
        State::Running => JobState::Running,
        State::Succeeded => JobState::Succeeded,
        State::Failed => JobState::Failed,
        State::Cancelled => JobState::Cancelled,
    }
}

fn log(line: Line) -> JobLog {
    let level = match line.level {
        Level::Info => LogLevel::Info,
        Level::Warning => LogLevel::Warning,
        Level::Error => LogLevel::Error,
    };
    JobLog { seq: line.seq, written_at: Some(timestamp(line.at_ms)), level: level as i32, message: line.text }
}

/// Returns a job as clients see it.
pub(super) fn message(job: &Job) -> JobMessage {
    let problems = |f: &crate::jobs::Failure| {
        f.problems.iter().map(|(path, message)| Problem { path: path.clone(), message: message.clone() }).collect()
    };
    JobMessage {
        job_id: job.id.clone(),
        kind: job.spec.kind().into(),
        title: job.title.clone(),
        state: state(job.state) as i32,
        progress: Some(Progress { stage: job.stage.clone(), fraction: job.fraction, message: job.message.clone() }),
        error: job.failure.as_ref().map(|f| JobError {
            code: f.code.clone(),
            message: f.message.clone(),
            problems: problems(f),
        }),
        result: job.state.is_ended().then(|| result(job)).flatten(),
        created_at: Some(timestamp(job.created_ms)),
        started_at: job.started_ms.map(timestamp),
        ended_at: job.ended_ms.map(timestamp),
        run_count: job.runs,
    }
}

/// Returns what came of a job, or what is finished of it.
fn result(job: &Job) -> Option<job::Result> {
    let value = if job.state == State::Succeeded { &job.outcome } else { &job.checkpoint };
    if value.is_null() {
        return None;
    }
    Some(match &job.spec {
        Spec::Batch(spec) => {
            let done: Done = serde_json::from_value(value.clone()).ok()?;
            job::Result::Batch(BatchResult {
                world_count: spec.count,
                sound_count: done.sound,
                failed_seeds: done.failed,
            })
        }
        Spec::Ingest(_) => {
            let summary = ingest::summary(value)?;
            let [added, updated, unchanged, refused] = summary.counts().map(|n| u32::try_from(n).unwrap_or(u32::MAX));
            let files = summary.files.iter().map(|(path, outcome)| {
                let (outcome, asset_id, reason) = ingest::words(outcome);
                IngestedFile {
                    path: path.clone(),
                    asset_id: asset_id.map(str::to_owned),
                    outcome: outcome.into(),
                    reason: reason.map(str::to_owned),
                }
            });
            job::Result::Ingest(IngestResult {
                added_count: added,
                updated_count: updated,
                unchanged_count: unchanged,
                refused_count: refused,
                files: files.collect(),
            })
        }
        Spec::Research(spec) => {
            let found: Found = serde_json::from_value(value.clone()).ok()?;
            job::Result::Research(ResearchResult {
                domain_id: spec.domain.clone(),
                document_count: u32::try_from(found.documents).unwrap_or(u32::MAX),
                constraint_count: u32::try_from(found.constraints).unwrap_or(u32::MAX),
                warnings: found.warnings,
                change_seq: found.change,
            })
        }
    })
}
