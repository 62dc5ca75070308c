//! The process is killed in the middle of its work: what it has acknowledged is there after the next start.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use d3dgen_mesh::{builds, writers};
use d3dgen_plugins::Registry;
use d3dgen_proto::v1::{
    AmendKnowledgeRequest, AnyOf, AssetFilter, GenerateBatchRequest, GetJobRequest, IngestFolderRequest, JobState,
    KnowledgeBase, ListAssetsRequest, ListBatchWorldsRequest, ListDomainsRequest, ListKnowledgeChangesRequest,
    RegisterDomainRequest, RuleSentence, SearchConstraintsRequest, amend_knowledge_request, job,
};

use crate::support::{self, Clients, Server, code, flat, page};

/// Rounds of the ordinary test; `D3DGEN_KILL_ROUNDS` asks for more.
const ROUNDS: u64 = 4;
/// Models of the ingest of a round.
const MODELS: usize = 60;

#[tokio::test(flavor = "multi_thread")]
async fn nothing_acknowledged_is_lost_and_jobs_go_on() {
    let dir = tempfile::tempdir().expect("a folder");
    let data = dir.path().join("data");
    let rounds = std::env::var("D3DGEN_KILL_ROUNDS").ok().and_then(|n| n.parse().ok()).unwrap_or(ROUNDS);
    let (mut registered, mut jobs): (Vec<(String, u64)>, Vec<String>) = (Vec::new(), Vec::new());
    let mut manifest = None;
    let root = dir.path().join("models");
    let settings = ["jobs.kept=1000", "jobs.workers=2", &format!("read_roots=[{:?}]", root.display().to_string())];
    let (mut ingests, mut assets, mut in_the_middle): (Vec<String>, BTreeSet<String>, u64) = Default::default();
    for round in 0..rounds {
        let server = Server::start(&data, &settings);
        let mut c = Clients::of(&server).await;
        // all that was acknowledged is there
        let listed = c.domains.list_domains(ListDomainsRequest { page_size: 500, ..Default::default() }).await;
        let listed = listed.expect("a list").into_inner().domains;
        for (id, version) in &registered {
            let found = listed.iter().find(|d| d.domain_id == *id).unwrap_or_else(|| panic!("{id} is lost"));
            assert!(found.domain_version >= *version, "{id}: {} < {version}", found.domain_version);
        }
        let kept = kept_assets(&mut c).await;
        assert!(assets.is_subset(&kept), "lost: {:?}", assets.difference(&kept));
        for id in jobs.iter().chain(&ingests) {
            let job = c.jobs.get_job(GetJobRequest { job_id: id.clone() }).await.expect("kept").into_inner().job;
            let job = job.expect("a job");
            assert_ne!(job.state, JobState::Failed as i32, "{job:?}");
        }
        if manifest.is_none() {
            manifest = Some(support::manifest(&mut c, "warehouse").await);
        }
        let asked =
            GenerateBatchRequest { building: flat(round * 100), world_count: 5, request_id: format!("b{round}") };
        let job = c.worlds.generate_batch(asked).await.expect("started").into_inner().job.expect("a job");
        jobs.push(job.job_id);
        // registrations go on until the process is gone
        let mut domains = c.domains.clone();
        let mine = manifest.clone().expect("a manifest");
        let acknowledged = Arc::new(AtomicU64::new(0));
        let counter = Arc::clone(&acknowledged);
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
                    Ok(answer) => {
                        done.push((id, answer.into_inner().domain.expect("one").domain_version));
                        counter.fetch_add(1, Ordering::SeqCst);
                    }
                    Err(_) => break,
                }
            }
            done
        });
        while acknowledged.load(Ordering::SeqCst) < 1 + round % 3 {
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
        let folder = root.join(format!("round_{round}"));
        write_models(&folder, round);
        let asked = IngestFolderRequest { server_path: folder.display().to_string(), ..Default::default() };
        let ingest = c.assets.ingest_folder(asked).await.expect("started").into_inner().job.expect("a job").job_id;
        ingests.push(ingest.clone());
        in_the_middle += u64::from(wait_for_part(&mut c, &ingest, 0.1 + 0.12 * (round % 7) as f64).await);
        assets.extend(kept_assets(&mut c).await);
        server.kill();
        registered.extend(work.await.expect("it ended"));
    }
    // at last every job comes to its end
    let server = Server::start(&data, &settings);
    let mut c = Clients::of(&server).await;
    for (round, id) in ingests.iter().enumerate() {
        let job = c.ended(id).await;
        assert_eq!(job.state, JobState::Succeeded as i32, "{job:?}");
        let Some(job::Result::Ingest(result)) = job.result else { panic!("round {round}: no result") };
        let found: BTreeSet<String> = result.files.iter().filter_map(|f| f.asset_id.clone()).collect();
        assert_eq!((found.len(), result.refused_count), (MODELS, 0), "round {round}: {result:?}");
        assets.extend(found);
    }
    let kept = kept_assets(&mut c).await;
    assert!(kept.len() == MODELS * ingests.len() && assets == kept, "{} of {} assets", kept.len(), assets.len());
    assert!(in_the_middle > 0, "no ingest was cut short: make MODELS larger");
    for id in &jobs {
        let job = c.ended(id).await;
        assert_eq!(job.state, JobState::Succeeded as i32, "{job:?}");
        let list = ListBatchWorldsRequest { job_id: id.clone(), ..Default::default() };
        let worlds = c.worlds.list_batch_worlds(list).await.expect("a list").into_inner().worlds;
        let mut seeds: Vec<u64> = worlds.iter().map(|w| w.seed).collect();
        seeds.dedup();
        assert_eq!(seeds.len(), 5, "{id}: each world once");
    }
    println!(
        "{rounds} rounds, {in_the_middle} of them in the middle of an ingest: {} registrations acknowledged, {} jobs ended, {} assets",
        registered.len(),
        jobs.len() + ingests.len(),
        kept.len()
    );
}

/// Writes models for an ingest, each of a size of its own.
fn write_models(folder: &Path, round: u64) {
    std::fs::create_dir_all(folder).expect("a folder");
    let registry = Registry::builtin();
    let office = registry.get("office").expect("shipped").domain();
    let desk = office.objects.iter().find(|o| o.id == "desk").expect("an object");
    let library = builds::Library::shipped().with(&office.builds);
    for n in 0..MODELS {
        let size = [1.2 + 0.01 * n as f64, 0.7 + 0.001 * round as f64, 0.73];
        let mut model = builds::generate(&library, desk, size, round).expect("a desk");
        model.name = format!("desk_{round}_{n}");
        std::fs::write(folder.join(format!("{}.glb", model.name)), writers::glb(&model).expect("bytes"))
            .expect("written");
    }
}

/// Waits until a job has done a part; returns false when it ended before it was seen at work.
async fn wait_for_part(c: &mut Clients, job_id: &str, part: f64) -> bool {
    loop {
        let job = c.jobs.get_job(GetJobRequest { job_id: job_id.into() }).await.expect("there").into_inner().job;
        let job = job.expect("a job");
        if job.ended_at.is_some() {
            return false;
        }
        if job.progress.is_some_and(|p| p.fraction >= part) {
            return true;
        }
        tokio::time::sleep(Duration::from_millis(2)).await;
    }
}

/// Returns the ids of the assets that are kept in the database.
async fn kept_assets(c: &mut Clients) -> BTreeSet<String> {
    let any_of = [("origin".to_owned(), AnyOf { values: vec!["ingested".into()] })].into();
    let ingested = AssetFilter { any_of, ..Default::default() };
    let (mut found, mut page_token) = (BTreeSet::new(), String::new());
    loop {
        let list =
            ListAssetsRequest { filter: Some(ingested.clone()), page_size: 1000, page_token, ..Default::default() };
        let page = c.assets.list_assets(list).await.expect("a list").into_inner();
        found.extend(page.assets.into_iter().map(|a| a.asset_id));
        page_token = page.next_page_token;
        if page_token.is_empty() {
            return found;
        }
    }
}

#[cfg(unix)]
#[tokio::test(flavor = "multi_thread")]
async fn a_stop_lets_jobs_go_on_at_the_next_start() {
    let dir = tempfile::tempdir().expect("a folder");
    let data = dir.path().join("data");
    let mut server = Server::start(&data, &[]);
    let mut c = Clients::of(&server).await;
    let asked = GenerateBatchRequest { building: flat(1), world_count: 1000, request_id: String::new() };
    let job = c.worlds.generate_batch(asked).await.expect("started").into_inner().job.expect("a job").job_id;
    assert!(wait_for_part(&mut c, &job, 0.01).await, "it ended before it could be stopped");
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

/// Lets the files of a process grow to so many bytes and no further, as a full disk would; `None` for as far as they like.
#[cfg(target_os = "linux")]
fn limit_files(pid: u32, bytes: Option<u64>) {
    let limit = bytes.map_or_else(|| "unlimited".to_owned(), |b| b.to_string());
    let mut prlimit = std::process::Command::new("prlimit");
    let done = prlimit.args(["--pid", &pid.to_string(), &format!("--fsize={limit}:unlimited")]).status();
    assert!(done.expect("prlimit, of util-linux").success());
}

/// What a client sees of a disk that is full, and of one that has room again.
#[cfg(target_os = "linux")]
#[tokio::test(flavor = "multi_thread")]
async fn a_full_disk_stops_writes_only_and_only_while_it_is_full() {
    let dir = tempfile::tempdir().expect("a folder");
    let data = dir.path().join("data");
    // the signal of this limit would end the process; a disk that is full sends none
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", "trap '' XFSZ; exec \"$0\" \"$@\""]).arg(d3dgen_tests::program());
    let server = Server::start_by(shell, &data, &[]);
    let mut c = Clients::of(&server).await;
    let amend = async |c: &mut Clients, width: &str| {
        let text = format!("Corridors are at least {width} m wide.");
        let change = Some(amend_knowledge_request::Change::Sentence(RuleSentence { text, language: None }));
        let asked = AmendKnowledgeRequest { domain_id: "hospital".into(), change, ..Default::default() };
        code(c.knowledge.amend_knowledge(asked).await)
    };
    let search = async |c: &mut Clients| {
        let asked = SearchConstraintsRequest { query: "corridor width".into(), page_size: 5, ..Default::default() };
        c.knowledge.search_constraints(asked).await.expect("an answer").into_inner().constraints.len()
    };
    let until = async |path: &str, status: u16| {
        let begun = std::time::Instant::now();
        while page(&server.url, path, "").0 != status {
            assert!(begun.elapsed() < Duration::from_secs(60), "{path} never says {status}: {}", server.log());
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
    };
    until("/readyz", 200).await;
    assert_eq!(amend(&mut c, "2.61").await, tonic::Code::Ok);
    for round in 0..2 {
        limit_files(server.pid(), Some(4096));
        for width in ["2.62", "2.63", "2.64"] {
            assert_eq!(amend(&mut c, width).await, tonic::Code::ResourceExhausted, "round {round}: {}", server.log());
            assert!(search(&mut c).await > 0, "reading goes on");
            c.domains.list_domains(ListDomainsRequest::default()).await.expect("reading goes on");
        }
        until("/readyz", 503).await;
        assert_eq!(page(&server.url, "/livez", "").0, 200, "no restart would help");
        limit_files(server.pid(), None);
        until("/readyz", 200).await;
        assert_eq!(amend(&mut c, &format!("2.7{round}")).await, tonic::Code::Ok, "{}", server.log());
    }
    // what was acknowledged, and nothing else, is there after a start
    drop(c);
    server.kill();
    let server = Server::start(&data, &[]);
    let mut c = Clients::of(&server).await;
    let asked = ListKnowledgeChangesRequest { domain_id: Some("hospital".into()), ..Default::default() };
    let made = c.knowledge.list_knowledge_changes(asked).await.expect("a list").into_inner().changes;
    let whys: Vec<String> = made.into_iter().filter_map(|m| Some(m.provenance?.why)).collect();
    let amended: Vec<&str> = whys.iter().filter_map(|w| w.strip_prefix("Corridors are at least ")).collect();
    assert_eq!(amended, ["2.71 m wide.", "2.70 m wide.", "2.61 m wide."]);
}
