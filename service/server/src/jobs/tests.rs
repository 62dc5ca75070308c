//! Jobs wait, run, stop, go on, and are there again after a start.

use d3dgen_store::Options;
use tempfile::TempDir;

use super::batch::{Batch as Worlds, Building};
use super::*;

fn limits() -> config::Jobs {
    config::Jobs { workers: 1, waiting: 3, waiting_per_client: 2, kept: 2, batch_worlds: 10 }
}

fn open(dir: &TempDir) -> Jobs {
    let store = Store::open_or_create(dir.path().join("store"), &Options::default()).expect("a store");
    Jobs::open(&store, limits(), Clock::new(|| Duration::from_secs(5)), Arc::default()).expect("jobs")
}

fn start(jobs: &Jobs, owner: &str) -> Result<Job, Status> {
    let spec = Spec::Batch(Worlds { building: Building { prompt: "a flat".into(), ..Building::default() }, count: 2 });
    jobs.start(owner, "worlds".into(), spec, None, |_, _| ())
}

#[tokio::test]
async fn a_job_that_was_cut_short_goes_on_after_a_start() {
    let dir = TempDir::new().expect("a folder");
    let jobs = open(&dir);
    let id = start(&jobs, "a").expect("started").id;
    let (job, _) = jobs.next().await.expect("its turn");
    assert_eq!((job.id.as_str(), job.state, job.runs), (id.as_str(), State::Running, 1));
    drop(jobs); // as if the process were killed
    let jobs = open(&dir);
    let job = jobs.get(&id).expect("kept");
    assert_eq!((job.state, job.cut_short), (State::Queued, 1));
    jobs.next().await.expect("its turn again");
    jobs.end(&id, Ok(serde_json::json!({ "n": 1 })));
    drop(jobs);
    let jobs = open(&dir);
    let job = jobs.get(&id).expect("kept");
    assert_eq!((job.state, job.outcome["n"].as_u64(), job.runs), (State::Succeeded, Some(1), 2));
    let lines = jobs.lines(&id, 0, 100).expect("a log");
    assert_eq!(lines.len() as u64, job.lines);
    assert!(lines.iter().any(|l| l.level == Level::Warning), "{lines:?}");
    assert_eq!(jobs.lines(&id, 1, 1).expect("a log")[0].seq, 2);
}

#[tokio::test]
async fn too_many_jobs_are_refused_with_a_time_to_come_back() {
    let dir = TempDir::new().expect("a folder");
    let jobs = open(&dir);
    for owner in ["a", "a", "b"] {
        start(&jobs, owner).expect("room for it");
    }
    for owner in ["a", "c"] {
        let refused = start(&jobs, owner).expect_err("full");
        assert_eq!(refused.code(), tonic::Code::ResourceExhausted);
        assert!(refused.metadata().contains_key("retry-after"), "{owner}");
    }
}

#[tokio::test]
async fn stopped_jobs_go_on_when_they_are_resumed() {
    let dir = TempDir::new().expect("a folder");
    let jobs = open(&dir);
    let waiting = start(&jobs, "a").expect("started").id;
    assert_eq!(jobs.cancel(&waiting).expect("there").state, State::Cancelled);
    let running = start(&jobs, "a").expect("started").id;
    let (_, stop) = jobs.next().await.expect("its turn");
    jobs.cancel(&running).expect("there");
    assert!(stop.load(Ordering::SeqCst));
    jobs.end(&running, Err(Status::cancelled("stopped")));
    assert_eq!(jobs.get(&running).expect("kept").state, State::Cancelled);
    assert_eq!(jobs.resume(&running).expect("resumed").state, State::Queued);
    assert_eq!(jobs.resume(&running).expect_err("it waits").code(), tonic::Code::FailedPrecondition);
    assert_eq!(jobs.resume("nothing").expect_err("no such job").code(), tonic::Code::NotFound);
    let (job, _) = jobs.next().await.expect("its turn");
    jobs.end(&job.id, Err(Status::invalid_argument("no")));
    assert_eq!(jobs.get(&running).expect("kept").failure.expect("a reason").code, "INVALID_ARGUMENT");
    // a stop of the server is no failure
    start(&jobs, "a").expect("started");
    let (job, _) = jobs.next().await.expect("its turn");
    jobs.stop();
    jobs.end(&job.id, Err(Status::cancelled("stopped")));
    assert_eq!(jobs.get(&job.id).expect("kept").state, State::Queued);
    assert!(jobs.next().await.is_none());
}

#[tokio::test]
async fn old_jobs_are_forgotten() {
    let dir = TempDir::new().expect("a folder");
    let jobs = open(&dir);
    for _ in 0..4 {
        let id = start(&jobs, "a").expect("started").id;
        jobs.next().await.expect("its turn");
        jobs.end(&id, Ok(serde_json::Value::Null));
    }
    assert_eq!(jobs.forget().expect("removed").len(), 2);
    assert_eq!(jobs.list(|_| true).len(), 2);
    drop(jobs);
    let jobs = open(&dir);
    assert_eq!(jobs.list(|_| true).len(), 2);
    assert!(jobs.reserve() > jobs.list(|_| true)[0].id);
}
