//! Data sets that somebody makes in a folder of the server: how far they are, who may see it, and how they are stopped.

use d3dgen_dataset::part::{Part, Shard};
use d3dgen_dataset::snapshot::Snapshot;
use d3dgen_dataset::standing::{self, Pace, WORK};
use d3dgen_proto::v1::{
    CancelJobRequest, DataSetResult, GetJobRequest, Job, JobState, ListJobsRequest, ResumeJobRequest, WatchJobRequest,
    job,
};
use tonic::Code;

use crate::support::{Clients, Server, code, with};

const ADMIN: &str = "a-secret";
const ID: &str = "data_set/0/wards";
const SPEC: &str = "name = \"wards\"\nseeds = 8\nprompts = [{ text = \"flat\" }]\n";

fn result(job: &Job) -> DataSetResult {
    match job.result {
        Some(job::Result::DataSet(result)) => result,
        _ => panic!("no data set: {job:?}"),
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_data_set_in_the_making_is_among_the_jobs_and_can_be_stopped() {
    let dir = tempfile::tempdir().expect("a folder");
    let root = dir.path().join("sets");
    let snapshot = Snapshot::take(&d3dgen_plugins::Registry::builtin()).expect("a snapshot");
    let begin = || Part::begin(&root.join("wards").join(WORK), SPEC, &snapshot, Shard::WHOLE, 2).expect("a part");
    let part = begin();
    let roots = format!("data_sets=[{:?}]", root.display().to_string());
    let server = Server::with_tokens(&dir.path().join("data"), &[&roots]);
    let mut c = Clients::of(&server).await;

    let get = || GetJobRequest { job_id: ID.into() };
    for token in ["r-secret", "w-secret"] {
        let listed = c.jobs.list_jobs(with(token, ListJobsRequest::default())).await.expect("a list").into_inner();
        assert!(listed.jobs.is_empty(), "{token}");
        assert_eq!(code(c.jobs.get_job(with(token, get())).await), Code::NotFound, "{token}");
    }
    let listed = c.jobs.list_jobs(with(ADMIN, ListJobsRequest::default())).await.expect("a list").into_inner();
    let first = &listed.jobs[0];
    assert_eq!((first.job_id.as_str(), first.kind.as_str(), first.title.as_str()), (ID, "data_set", "wards"));
    assert_eq!((first.state(), result(first).task_count, result(first).tasks_per_second), (JobState::Running, 8, None));

    let watch = WatchJobRequest { job_id: ID.into(), include_logs: true };
    let mut news = c.jobs.watch_job(with(ADMIN, watch)).await.expect("a stream").into_inner();
    let next = news.message().await.expect("news").expect("news").job.expect("a job");
    assert_eq!(result(&next).world_count, 0);
    part.keep(0, &[], 2).expect("a block");
    standing::tell(&part, &Pace { per_second: 0.5, seconds_left: 12.0 }).expect("a note");
    let mut seen = result(&next);
    while seen.tasks_per_second.is_none() {
        seen = result(&news.message().await.expect("news").expect("news").job.expect("a job"));
    }
    assert_eq!(
        (seen.world_count, seen.failed_count, seen.tasks_per_second, seen.seconds_left),
        (2, 0, Some(0.5), Some(12.0))
    );

    let cancel = || CancelJobRequest { job_id: ID.into() };
    assert_eq!(code(c.jobs.cancel_job(with("w-secret", cancel())).await), Code::NotFound);
    assert!(!standing::is_to_stop(&part));
    c.jobs.cancel_job(with(ADMIN, cancel())).await.expect("asked to stop");
    assert!(standing::is_to_stop(&part));
    drop(part);
    let mut last = None;
    while let Some(event) = news.message().await.expect("news") {
        last = event.job;
    }
    assert_eq!(last.map(|job| job.state()), Some(JobState::Cancelled), "the watch ends with the run");
    let resume = ResumeJobRequest { job_id: ID.into() };
    assert_eq!(code(c.jobs.resume_job(with(ADMIN, resume)).await), Code::FailedPrecondition);
    assert_eq!(code(c.jobs.cancel_job(with(ADMIN, cancel())).await), Code::FailedPrecondition);
    assert!(!standing::is_to_stop(&begin()), "the next run goes on");
}
