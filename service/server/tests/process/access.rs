//! Who may do what: with no token, a wrong one, and tokens of each scope.

use d3dgen_proto::v1::{
    ClassifyDomainRequest, GenerateBatchRequest, IngestFolderRequest, ListDomainsRequest, ListJobsRequest,
    RegisterDomainRequest, RemoveAssetsRequest, RemoveDomainRequest, UndoKnowledgeChangeRequest,
};
use tonic::Code;
use tonic_health::pb::HealthCheckRequest;
use tonic_health::pb::health_client::HealthClient;

use crate::support::{Clients, Server, TOKENS, code, flat, page, with};

#[tokio::test(flavor = "multi_thread")]
async fn without_the_right_token_only_health_answers() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::with_tokens(&dir.path().join("data"), &[]);
    let mut clients = Clients::of(&server).await;
    let list = ListDomainsRequest::default;
    assert_eq!(code(clients.domains.list_domains(list()).await), Code::Unauthenticated);
    for wrong in ["wrong", "", "r-secre", "r-secret2", "R-SECRET"] {
        assert_eq!(code(clients.domains.list_domains(with(wrong, list())).await), Code::Unauthenticated, "{wrong}");
    }
    let mut health = HealthClient::new(server.channel().await);
    let checked = health.check(HealthCheckRequest { service: "d3dgen.v1.WorldService".into() }).await;
    assert_eq!(checked.expect("health answers").into_inner().status, 1);
    assert_eq!(page(&server.url, "/healthz", "").0, 200);
    assert_eq!(page(&server.url, "/metrics", "").0, 401);
    assert!((400..500).contains(&page(&server.url, "/nothing", "").0));
    let (status, text) = page(&server.url, "/metrics", "authorization: Bearer r-secret\r\n");
    assert!(status == 200 && text.contains("d3dgen_call_seconds_count"), "{text}");
    assert!(!server.log().contains("secret"), "a token is in the log");
}

#[tokio::test(flavor = "multi_thread")]
async fn scopes_are_kept_apart() {
    let dir = tempfile::tempdir().expect("a folder");
    let (root, outside) = (dir.path().join("root"), dir.path().join("outside"));
    std::fs::create_dir_all(root.join("inner")).expect("a folder");
    std::fs::create_dir_all(&outside).expect("a folder");
    let roots = format!("read_roots=[{:?}]", root.display().to_string());
    let server = Server::with_tokens(&dir.path().join("data"), &[&roots]);
    let mut c = Clients::of(&server).await;
    for (scope, token) in TOKENS {
        let writes = scope != "read";
        assert_eq!(code(c.domains.list_domains(with(token, ListDomainsRequest::default())).await), Code::Ok);
        let asked = ClassifyDomainRequest { prompt: "a school in Spain".into(), ..Default::default() };
        assert_eq!(code(c.domains.classify_domain(with(token, asked)).await), Code::Ok);
        let got = [
            code(c.domains.register_domain(with(token, RegisterDomainRequest::default())).await),
            code(c.domains.remove_domain(with(token, RemoveDomainRequest::default())).await),
            code(c.knowledge.undo_knowledge_change(with(token, UndoKnowledgeChangeRequest::default())).await),
            code(c.assets.remove_assets(with(token, RemoveAssetsRequest::default())).await),
            code(c.worlds.generate_batch(with(token, GenerateBatchRequest::default())).await),
        ];
        for (i, got) in got.into_iter().enumerate() {
            assert_eq!(got == Code::PermissionDenied, !writes, "call {i} with scope {scope}: {got:?}");
            assert!(got != Code::Ok, "call {i} with scope {scope} was empty");
        }
        // folders of the server's machine: who may write may have the configured ones read, and nobody any other
        let inner = root.join("inner").display().to_string();
        let others = [outside.display().to_string(), format!("{inner}/../../outside"), "/".into(), String::new()];
        for (path, allowed) in others.map(|p| (p, false)).into_iter().chain([(inner, true)]) {
            let asked = IngestFolderRequest { server_path: path.clone(), ..Default::default() };
            match c.assets.ingest_folder(with(token, asked)).await {
                Ok(_) => assert!(writes && allowed, "{path:?} was read with scope {scope}"),
                Err(refused) => {
                    assert_eq!(refused.code(), Code::PermissionDenied, "{path:?} with scope {scope}: {refused}");
                    assert!(!(writes && allowed), "{path:?} with scope {scope}: {refused}");
                    let by_scope = refused.message().contains("this call needs write");
                    assert_eq!(by_scope, !writes, "{path:?} with scope {scope}: {refused}");
                }
            }
        }
    }
    // what one client started, another does not see, and an administrator does
    let batch = GenerateBatchRequest { building: flat(1), world_count: 1, request_id: String::new() };
    assert_eq!(code(c.worlds.generate_batch(with("w-secret", batch)).await), Code::Ok);
    for (token, sees) in [("r-secret", 0), ("w-secret", 1), ("a-secret", 1)] {
        let listed = c.jobs.list_jobs(with(token, ListJobsRequest::default())).await.expect("a list");
        let batches = listed.into_inner().jobs.into_iter().filter(|job| job.kind == "batch").count();
        assert_eq!(batches, sees, "{token}");
    }
}

#[test]
fn what_is_open_to_all_is_not_served_without_tokens() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = dir.path().join("server.toml");
    std::fs::write(&file, "listen = \"0.0.0.0:0\"\n").expect("written");
    let answered = d3dgen_server::config::read(
        Some(("server.toml", "listen = \"0.0.0.0:0\"")),
        &[],
        &[],
        Some(dir.path().to_path_buf()),
    );
    assert!(answered.expect_err("refused").to_string().contains("give tokens"));
}

/// Rules, assets and tokens of a server are nobody else's.
#[cfg(unix)]
#[test]
fn what_a_server_writes_is_for_its_own_user_only() {
    use std::os::unix::fs::PermissionsExt;
    let dir = tempfile::tempdir().expect("a folder");
    let data = dir.path().join("data");
    let server = Server::start(&data, &[]);
    let begun = std::time::Instant::now();
    while page(&server.url, "/readyz", "").0 != 200 {
        assert!(begun.elapsed() < std::time::Duration::from_secs(60), "the indexes are made");
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    let (mut folders, mut count) = (vec![data], 0);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("readable") {
            let path = entry.expect("an entry").path();
            let mode = std::fs::metadata(&path).expect("there").permissions().mode();
            assert_eq!(mode & 0o077, 0, "{} is {:o}", path.display(), mode & 0o777);
            count += 1;
            if path.is_dir() {
                folders.push(path);
            }
        }
    }
    assert!(count > 5, "{count} files");
}
