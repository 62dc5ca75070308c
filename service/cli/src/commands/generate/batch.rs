//! Many worlds on all cores. Each depends on its own seed alone, so the order of the threads cannot show; results are
//! printed in the order of the seeds.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use super::Job;
use super::one::{Maker, print_json};
use crate::error::Error;
use crate::progress::Progress;
use crate::summary::Summary;

/// Makes the worlds; returns them with the number of seeds for which no world was found.
///
/// # Errors
/// The first error in order of seeds that is not about one seed alone; worlds finished before it stay.
pub fn run(maker: &Maker<'_>, jobs: &[Job], progress: &Progress, json: bool) -> Result<(Vec<Summary>, usize), Error> {
    let next = AtomicUsize::new(0);
    let stop = AtomicBool::new(false);
    let (send, receive) = mpsc::channel();
    // a model is asked for one world after the other, so that a recording answers them in their order
    let most = if maker.proposals.is_some() { 1 } else { jobs.len() };
    let threads = thread::available_parallelism().map_or(1, usize::from).min(most);
    thread::scope(|scope| {
        for _ in 0..threads {
            let send = send.clone();
            scope.spawn(|| {
                let send = send; // moved in: the channel closes when the last thread is done
                while !stop.load(Ordering::Relaxed) {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(job) = jobs.get(index) else { break };
                    if send.send((index, maker.make(job, &Progress::silent()))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(send);
        let result = collect(jobs, receive, progress, json);
        stop.store(true, Ordering::Relaxed);
        progress.finish();
        result
    })
}

fn collect(
    jobs: &[Job],
    receive: mpsc::Receiver<(usize, Result<Summary, Error>)>,
    progress: &Progress,
    json: bool,
) -> Result<(Vec<Summary>, usize), Error> {
    let (mut worlds, mut failed, mut waiting) = (Vec::new(), 0, BTreeMap::new());
    let mut due = 0;
    for (index, result) in receive {
        waiting.insert(index, result);
        while let Some(result) = waiting.remove(&due) {
            due += 1;
            progress.count();
            match result {
                Ok(summary) => {
                    if json {
                        print_json(&summary)?;
                    }
                    progress.done(&format!("{due} of {}: {}", jobs.len(), summary.name()));
                    worlds.push(summary);
                }
                Err(Error::Stage(error @ d3dgen_pipeline::Error::Infeasible { .. })) => {
                    failed += 1;
                    progress.say(&format!("{due} of {}: seed {}: {error}", jobs.len(), jobs[due - 1].request.seed));
                }
                Err(error) => return Err(error),
            }
        }
    }
    Ok((worlds, failed))
}
