//! `d3dgen jobs`: the long work of a server.

use clap::Subcommand;
use d3dgen_proto::v1::{Job, JobLog, JobState};

use crate::error::Error;
use crate::input::write_text;
use crate::remote::{ServerArgs, jobs};
use crate::table::table;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    /// One line for each job, newest first
    List {
        /// Print one JSON line for each job
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        server: ServerArgs,
    },
    /// Follow a job to its end, with what it writes about its work
    Watch {
        /// Id of the job
        id: String,
        /// Print one JSON line for the job as it ended
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        server: ServerArgs,
    },
    /// Ask a job to stop; what it has finished stays
    Cancel {
        /// Id of the job
        id: String,
        #[command(flatten)]
        server: ServerArgs,
    },
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        match self.action {
            Action::List { json, server } => {
                let found = jobs::list(&server.required()?)?;
                if json {
                    return write_text(None, &found.iter().map(|job| format!("{}\n", line(job))).collect::<String>());
                }
                let rows: Vec<Vec<String>> = found.iter().map(row).collect();
                write_text(None, &table(&["job", "kind", "state", "done", "title"], &rows))
            }
            Action::Watch { id, json, server } => {
                let mut hear = |job: &Job, logs: &[JobLog]| tell(job, logs);
                let job = jobs::watch(&server.required()?, &id, false, &mut hear)?;
                if json {
                    write_text(None, &format!("{}\n", line(&job)))?;
                }
                if job.state == JobState::Succeeded as i32 { Ok(()) } else { Err(jobs::failure(&job)) }
            }
            Action::Cancel { id, server } => {
                let job = jobs::cancel(&server.required()?, &id)?;
                write_text(None, &format!("{}: {}\n", job.job_id, jobs::state(&job)))
            }
        }
    }
}

fn done(job: &Job) -> f64 {
    job.progress.as_ref().map_or(0.0, |p| p.fraction)
}

fn row(job: &Job) -> Vec<String> {
    let (kind, state) = (job.kind.clone(), jobs::state(job).to_owned());
    vec![job.job_id.clone(), kind, state, format!("{:.0} %", done(job) * 100.0), job.title.clone()]
}

fn line(job: &Job) -> serde_json::Value {
    let error = job.error.as_ref().map(|e| serde_json::json!({ "code": e.code, "message": e.message }));
    serde_json::json!({
        "job_id": job.job_id, "kind": job.kind, "title": job.title, "state": jobs::state(job), "fraction": done(job),
        "run_count": job.run_count, "error": error,
    })
}

fn tell(job: &Job, logs: &[JobLog]) {
    for log in logs {
        eprintln!("{}", log.message);
    }
    if let Some(now) = &job.progress {
        eprintln!("{} {:.0} %: {}", jobs::state(job), now.fraction * 100.0, now.message);
    }
}
