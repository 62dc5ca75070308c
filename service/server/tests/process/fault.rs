//! The process is killed in the middle of its work: what it has acknowledged is there after the next start.

use std::time::Duration;

use d3dgen_proto::v1::{
    GenerateBatchRequest, GetDomainRequest, GetJobRequest, JobState, KnowledgeBase, ListBatchWorldsRequest,
    ListDomainsRequest, RegisterDomainRequest,
};

use crate::support::{Clients, Server, flat};

/// Rounds of the ordinary test; `D3DGEN_KILL_ROUNDS` asks for more.
const ROUNDS: u64 = 4;

#[tokio::test(flavor = "multi_thread")]
async fn nothing_acknowledged_is_lost_and_jobs_go_on() {
    let dir = tempfile::tempdir().expect("a folder");
    let data = dir.path().join("data");
    let rounds = std::env::var("D3DGEN_KILL_ROUNDS").ok().and_then(|n| n.parse().ok()).unwrap_or(ROUNDS);
    let (mut registered, mut jobs): (Vec<(String, u64)>, Vec<String>) = (Vec::new(), Vec::new());
    let mut manifest = None;
    for round in 0..rounds {
        let server = Server::start(&data, &["jobs.kept=1000"]);
        let mut c = Clients::of(&server).await;
        // all that was acknowledged is there
        let listed = c.domains.list_domains(ListDomainsRequest { page_size: 500, ..Default::default() }).await;
        let listed = listed.expect("a list").into_inner().domains;
        for (id, version) in &registered {
            let found = listed.iter().find(|d| d.domain_id == *id).unwrap_or_else(|| panic!("{id} is lost"));
            assert!(found.domain_version >= *version, "{id}: {} < {version}", found.domain_version);
        }
        for id in &jobs {
            let job = c.jobs.get_job(GetJobRequest { job_id: id.clone() }).await.expect("kept").into_inner().job;
            let job = job.expect("a job");
            assert_ne!(job.state, JobState::Failed as i32, "{job:?}");
        }
        if manifest.is_none() {
            let get = GetDomainRequest { domain_id: "warehouse".into(), include_manifest: true, ..Default::default() };
            manifest = c.domains.get_domain(get).await.expect("shipped").into_inner().manifest;
        }
        let asked =
            GenerateBatchRequest { building: flat(round * 100), world_count: 5, request_id: format!("b{round}") };
        let job = c.worlds.generate_batch(asked).await.expect("started").into_inner().job.expect("a job");
        jobs.push(job.job_id);
        // registrations go on until the process is gone
        let mut domains = c.domains.clone();
        let mine = manifest.clone().expect("a manifest");
        let work = tokio::spawn(async move {
            let mut done = Vec::new();
            for n in 0_u64.. {
                let id = format!("hall_{}", n % 3);
                let manifest = d3dgen_proto::v1::DomainManifest { domain_id: id.clone(), ..mine.clone() };
                let asked = RegisterDomainRequest {
                    manifest: Some(manifest),
                    knowledge_base: None::<KnowledgeBase>,
                    request_id: format!("r{round}-{n}"),
                    ..Default::default()
                };
                match domains.register_domain(asked).await {
                    Ok(answer) => done.push((id, answer.into_inner().domain.expect("one").domain_version)),
                    Err(_) => break,
                }
            }
            done
        });
        tokio::time::sleep(Duration::from_millis(600 + 370 * (round % 7))).await;
        server.kill();
        registered.extend(work.await.expect("it ended"));
    }
    // at last every job comes to its end
    let server = Server::start(&data, &["jobs.kept=1000"]);
    let mut c = Clients::of(&server).await;
    for id in &jobs {
        let job = c.ended(id).await;
        assert_eq!(job.state, JobState::Succeeded as i32, "{job:?}");
        let list = ListBatchWorldsRequest { job_id: id.clone(), ..Default::default() };
        let worlds = c.worlds.list_batch_worlds(list).await.expect("a list").into_inner().worlds;
        let mut seeds: Vec<u64> = worlds.iter().map(|w| w.seed).collect();
        seeds.dedup();
        assert_eq!(seeds.len(), 5, "{id}: each world once");
    }
    println!("{rounds} rounds: {} registrations acknowledged, {} jobs ended", registered.len(), jobs.len());
}

#[cfg(unix)]
#[tokio::test(flavor = "multi_thread")]
async fn a_stop_lets_jobs_go_on_at_the_next_start() {
    let dir = tempfile::tempdir().expect("a folder");
    let data = dir.path().join("data");
    let mut server = Server::start(&data, &[]);
    let mut c = Clients::of(&server).await;
    let asked = GenerateBatchRequest { building: flat(1), world_count: 40, request_id: String::new() };
    let job = c.worlds.generate_batch(asked).await.expect("started").into_inner().job.expect("a job").job_id;
    tokio::time::sleep(Duration::from_millis(500)).await;
    drop(c); // an open connection would be waited for
    let asked = std::process::Command::new("kill").arg(server.pid().to_string()).status().expect("asked to stop");
    assert!(asked.success());
    let begun = std::time::Instant::now();
    assert!(server.wait(), "{}", server.log());
    assert!(begun.elapsed() < Duration::from_secs(25));
    let server = Server::start(&data, &[]);
    let mut c = Clients::of(&server).await;
    let found = c.jobs.get_job(GetJobRequest { job_id: job }).await.expect("kept").into_inner().job.expect("a job");
    assert!(matches!(JobState::try_from(found.state), Ok(JobState::Queued | JobState::Running)), "{found:?}");
    assert!(found.error.is_none());
}
