//! What lies around the services: TLS, origins of web pages, backups, calls that are given up.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use d3dgen_proto::v1::admin_service_client::AdminServiceClient;
use d3dgen_proto::v1::generate_world_request::Start;
use d3dgen_proto::v1::research_document::Source;
use d3dgen_proto::v1::{
    BuildingRequest, CreateBackupRequest, DomainManifest, GenerateFloorplanRequest, GenerateSceneGraphRequest,
    GenerateWorldRequest, GetDomainRequest, JobState, ListDomainsRequest, RegisterDomainRequest, ResearchDocument,
    ResearchKnowledgeRequest, job,
};
use d3dgen_tests::{program, workspace};
use tonic::Code;

use crate::support::{Clients, Server, code, manifest, page, raw, with};

/// Certificate and key of a server on loopback, and of who signed it; of no use for anything else.
pub fn tls_files() -> (PathBuf, PathBuf, PathBuf) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/process/tls");
    (folder.join("certificate.pem"), folder.join("key.pem"), folder.join("ca.pem"))
}

/// Settings of a server with TLS.
pub fn tls_settings() -> [String; 2] {
    let (certificate, key, _) = tls_files();
    [
        format!("tls.certificate_file={:?}", certificate.display().to_string()),
        format!("tls.key_file={:?}", key.display().to_string()),
    ]
}

/// More than a server with its usual settings has places for.
#[test]
fn connections_that_say_nothing_shut_nobody_out() {
    const SILENT: usize = 520;
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::start(&dir.path().join("data"), &[]);
    let address = server.url.trim_start_matches("http://");
    let silent: Vec<_> = (0..SILENT).map(|_| std::net::TcpStream::connect(address).expect("a connection")).collect();
    let begun = Instant::now();
    for path in ["/healthz", "/livez", "/metrics"] {
        assert_eq!(page(&server.url, path, "").0, 200, "{path}");
    }
    let listed = d3dgen_tests::command().args(["domains", "list", "--server", &server.url]).output().expect("it runs");
    assert!(listed.status.success(), "{}", String::from_utf8_lossy(&listed.stderr));
    assert!(begun.elapsed() < Duration::from_secs(5), "{:.1} s", begun.elapsed().as_secs_f64());
    assert_eq!(silent.len(), SILENT); // open until here
}

#[tokio::test(flavor = "multi_thread")]
async fn pages_of_listed_origins_may_call_and_no_others() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::start(&dir.path().join("data"), &["cors_origins=[\"https://studio.example\"]"]);
    let ask = |origin: &str| {
        raw(
            &server.url,
            &format!(
                "OPTIONS /d3dgen.v1.DomainService/ListDomains HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\norigin: {origin}\r\n\
                 access-control-request-method: POST\r\naccess-control-request-headers: x-grpc-web,authorization\r\n\r\n"
            ),
        )
        .to_lowercase()
    };
    let allowed = ask("https://studio.example");
    assert!(allowed.contains("access-control-allow-origin: https://studio.example\r\n"), "{allowed}");
    assert!(allowed.contains("x-grpc-web"), "{allowed}");
    for other in ["https://studio.example.evil.org", "http://studio.example", "https://evil.org", "null"] {
        let refused = ask(other);
        assert!(!refused.contains("access-control-allow-origin"), "{other}: {refused}");
    }
    let called = raw(
        &server.url,
        "GET /healthz HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\norigin: https://evil.org\r\n\r\n",
    );
    assert!(!called.to_lowercase().contains("access-control-allow-origin"), "{called}");
    // without a list there are no such headers at all
    let other = Server::start(&dir.path().join("other"), &[]);
    let plain = raw(
        &other.url,
        "GET /healthz HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\norigin: https://studio.example\r\n\r\n",
    );
    assert!(!plain.to_lowercase().contains("access-control-allow-origin"), "{plain}");
}

#[tokio::test(flavor = "multi_thread")]
async fn plain_text_gets_no_answer_from_a_server_with_tls() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::start(&dir.path().join("data"), &tls_settings().each_ref().map(String::as_str));
    let (_, _, ca) = tls_files();
    let list = |more: &[&str]| {
        let url = server.url.replace("http://", "https://");
        let args = ["domains", "list", "--json", "--server", &url];
        Command::new(program()).args(args).args(more).env("D3DGEN_STORE", "").output().expect("it runs")
    };
    let ca = ca.display().to_string();
    let listed = list(&["--ca", &ca]);
    let text = String::from_utf8_lossy(&listed.stdout).into_owned();
    assert!(listed.status.success(), "{}", String::from_utf8_lossy(&listed.stderr));
    assert!(text.lines().any(|l| l.contains("\"id\":\"hospital\"")), "{text}");
    // a server that nobody known has signed is not talked to
    let stranger = list(&[]);
    assert_eq!(stranger.status.code(), Some(2), "{}", String::from_utf8_lossy(&stranger.stdout));
    let plain = tonic::transport::Endpoint::new(server.url.clone()).expect("an address").connect().await;
    if let Ok(channel) = plain {
        let mut client = d3dgen_proto::v1::domain_service_client::DomainServiceClient::new(channel);
        assert_ne!(code(client.list_domains(ListDomainsRequest::default()).await), Code::Ok);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_backup_of_a_running_server_is_a_server_again() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::with_tokens(&dir.path().join("data"), &[]);
    let mut c = Clients::of(&server).await;
    let shipped = c.domains.get_domain(with(
        "r-secret",
        GetDomainRequest { domain_id: "warehouse".into(), include_manifest: true, ..Default::default() },
    ));
    let shipped = shipped.await.expect("shipped").into_inner().manifest.expect("a manifest");
    let mine = DomainManifest { domain_id: "depot".into(), ..shipped };
    let register = RegisterDomainRequest { manifest: Some(mine.clone()), ..Default::default() };
    c.domains.register_domain(with("w-secret", register)).await.expect("registered");

    let mut admin = AdminServiceClient::new(server.channel().await);
    for token in ["r-secret", "w-secret"] {
        let refused = admin.create_backup(with(token, CreateBackupRequest {})).await;
        assert_eq!(code(refused), Code::PermissionDenied, "{token}");
    }
    let made = admin.create_backup(with("a-secret", CreateBackupRequest {})).await.expect("a backup").into_inner();
    assert!(made.record_count > 0);
    // what comes later is not in it
    let later = DomainManifest { domain_id: "annex".into(), ..mine.clone() };
    let register = RegisterDomainRequest { manifest: Some(later), ..Default::default() };
    c.domains.register_domain(with("w-secret", register)).await.expect("registered");
    server.kill();

    let backup = dir.path().join("data/backups").join(&made.backup_name);
    let again = dir.path().join("again");
    let restored =
        Command::new(program()).args(["serve", "restore"]).arg(&backup).arg(&again).output().expect("it runs");
    assert!(restored.status.success(), "{}", String::from_utf8_lossy(&restored.stderr));
    let server = Server::start(&again, &[]);
    let mut c = Clients::of(&server).await;
    assert_eq!(manifest(&mut c, "depot").await, mine);
    let get = GetDomainRequest { domain_id: "annex".into(), ..Default::default() };
    assert_eq!(code(c.domains.get_domain(get).await), Code::NotFound);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_research_runs_as_a_job_and_its_rules_are_found() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::start(&dir.path().join("data"), &[]);
    let mut c = Clients::of(&server).await;
    // a domain of its own, so that every rule found is of the document
    let mine = DomainManifest { domain_id: "depot".into(), ..manifest(&mut c, "warehouse").await };
    let register = RegisterDomainRequest { manifest: Some(mine), ..Default::default() };
    c.domains.register_domain(register).await.expect("registered");
    let text = std::fs::read(workspace().join("service/research/tests/documents/office.md")).expect("a document");
    let document =
        ResearchDocument { name: "office.md".into(), source: Some(Source::Content(text)), ..Default::default() };
    let asked = ResearchKnowledgeRequest {
        domain_id: "depot".into(),
        country_code: Some("DE".into()),
        documents: vec![document],
        import_result: true,
        ..Default::default()
    };
    let started = c.knowledge.research_knowledge(asked).await.expect("started").into_inner().job.expect("a job");
    assert_eq!(started.kind, "research");
    let ended = c.ended(&started.job_id).await;
    assert_eq!(ended.state, JobState::Succeeded as i32, "{ended:?}");
    let Some(job::Result::Research(found)) = ended.result else { panic!("a result") };
    assert!(found.document_count == 1 && found.constraint_count > 0, "{found:?}");
    let export = d3dgen_proto::v1::ExportKnowledgeRequest { domain_id: "depot".into() };
    let base = c.knowledge.export_knowledge(export).await.expect("rules").into_inner().knowledge_base.expect("one");
    let count: usize = base.references.iter().map(|r| r.constraints.len()).sum();
    assert_eq!(count as u64, u64::from(found.constraint_count));
}

/// A request that takes long.
fn large() -> GenerateWorldRequest {
    let prompt = "hospital ward in Germany, for a delivery robot".into();
    let building = BuildingRequest { prompt, seed: 1, room_count: Some(500), ..Default::default() };
    GenerateWorldRequest { start: Some(Start::Building(building)), ..Default::default() }
}

/// Waits until no call takes a thread any more.
async fn idle(server: &Server) -> Duration {
    let begun = Instant::now();
    // the call that asks is one itself
    while !page(&server.url, "/metrics", "").1.contains("d3dgen_threads_busy 0\n") {
        assert!(begun.elapsed() < Duration::from_secs(5), "the work goes on though nobody waits for it");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    begun.elapsed()
}

#[tokio::test(flavor = "multi_thread")]
async fn work_ends_when_nobody_waits_for_it() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::start(&dir.path().join("data"), &[]);
    let mut c = Clients::of(&server).await;
    // a client that goes away
    let mut stream = c.worlds.generate_world(large()).await.expect("a stream").into_inner();
    stream.message().await.expect("it began").expect("an event");
    tokio::time::sleep(Duration::from_millis(300)).await;
    drop(stream);
    let gone = idle(&server).await;
    // a deadline, in a stream and in a single answer
    let mut asked = tonic::Request::new(large());
    asked.set_timeout(Duration::from_millis(400));
    let ended = match c.worlds.generate_world(asked).await {
        Ok(stream) => {
            let mut stream = stream.into_inner();
            loop {
                match stream.message().await {
                    Ok(Some(_)) => {}
                    Ok(None) => panic!("no world of 500 rooms is made in 0.4 s"),
                    Err(status) => break status,
                }
            }
        }
        Err(status) => status,
    };
    assert!(matches!(ended.code(), Code::DeadlineExceeded | Code::Cancelled), "{ended}");
    let late = idle(&server).await;
    let Some(Start::Building(building)) = large().start else { panic!("a building") };
    let asked = GenerateSceneGraphRequest { building: Some(building) };
    let graph = c.worlds.generate_scene_graph(asked).await.expect("rooms").into_inner().scene_graph;
    let mut asked =
        tonic::Request::new(GenerateFloorplanRequest { scene_graph: graph, alternative_count: 8, pinned: None });
    asked.set_timeout(Duration::from_millis(400));
    let ended = c.worlds.generate_floorplan(asked).await.expect_err("too short a time");
    assert!(matches!(ended.code(), Code::DeadlineExceeded | Code::Cancelled), "{ended}");
    let single = idle(&server).await;
    println!("threads free {gone:?} after a client went, {late:?} and {single:?} after a deadline");
}
