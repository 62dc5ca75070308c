//! The jobs of a server: list, watch, cancel.

use std::time::Duration;

use d3dgen_proto::v1::job_service_client::JobServiceClient;
use d3dgen_proto::v1::{CancelJobRequest, Job, JobLog, JobState, ListJobsRequest, WatchJobRequest};
use tonic::transport::Channel;

use super::{MESSAGE_BYTES, Remote, refused};
use crate::error::Error;
use crate::interrupt;

/// How often a wish to stop is looked for.
const POLL: Duration = Duration::from_millis(50);

fn client(remote: &Remote) -> JobServiceClient<Channel> {
    JobServiceClient::new(remote.channel()).max_decoding_message_size(MESSAGE_BYTES)
}

/// Returns the jobs that whoever asks may see, newest first.
///
/// # Errors
/// `Remote`.
pub fn list(remote: &Remote) -> Result<Vec<Job>, Error> {
    let (mut found, mut page_token) = (Vec::new(), String::new());
    loop {
        let asked = ListJobsRequest { page_size: 200, page_token, ..Default::default() };
        let page = remote.ask(client(remote).list_jobs(remote.request(asked)))?;
        found.extend(page.jobs);
        page_token = page.next_page_token;
        if page_token.is_empty() {
            return Ok(found);
        }
    }
}

/// Watches a job to its end and returns it. After Ctrl-C the job is asked to stop when it is `own`, and left alone
/// otherwise.
///
/// # Errors
/// `Remote`; `Interrupted` for a job that is left alone.
pub fn watch(remote: &Remote, id: &str, own: bool, hear: &mut dyn FnMut(&Job, &[JobLog])) -> Result<Job, Error> {
    interrupt::listen();
    let asked = WatchJobRequest { job_id: id.to_owned(), include_logs: true };
    let mut events = remote.ask(client(remote).watch_job(remote.request(asked)))?;
    let (mut last, mut asked_to_stop) = (None, false);
    loop {
        let event = remote.wait(async {
            loop {
                tokio::select! {
                    event = events.message() => break Some(event),
                    () = tokio::time::sleep(POLL) => if !asked_to_stop && interrupt::check().is_err() { break None },
                }
            }
        });
        match event {
            None if own => {
                cancel(remote, id)?;
                asked_to_stop = true;
            }
            None => return Err(Error::Interrupted),
            Some(event) => match event.map_err(refused)? {
                Some(event) => {
                    if let Some(job) = event.job {
                        hear(&job, &event.logs);
                        last = Some(job);
                    }
                }
                None => break,
            },
        }
    }
    last.filter(|job| job.ended_at.is_some())
        .ok_or_else(|| Error::Remote(format!("{id}: the server ended the stream before the job")))
}

/// Asks a job to stop and returns it.
///
/// # Errors
/// `Remote`; also when there is no such job, or it has ended.
pub fn cancel(remote: &Remote, id: &str) -> Result<Job, Error> {
    let asked = CancelJobRequest { job_id: id.to_owned() };
    let answer = remote.ask(client(remote).cancel_job(remote.request(asked)))?;
    answer.job.ok_or_else(|| Error::Remote("the answer lacks the job".into()))
}

/// Returns the word for the state of a job.
pub fn state(job: &Job) -> &'static str {
    match JobState::try_from(job.state) {
        Ok(JobState::Queued) => "queued",
        Ok(JobState::Running) => "running",
        Ok(JobState::Succeeded) => "succeeded",
        Ok(JobState::Failed) => "failed",
        Ok(JobState::Cancelled) => "cancelled",
        Ok(JobState::Unspecified) | Err(_) => "unknown",
    }
}

/// Returns why a job did not come to a result.
pub fn failure(job: &Job) -> Error {
    let said = job.error.as_ref().map_or_else(String::new, |e| format!(": {}: {}", e.code, e.message));
    Error::Remote(format!("{} {}{said}", job.job_id, state(job)))
}
