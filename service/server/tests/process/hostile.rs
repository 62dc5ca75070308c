//! Requests that are malformed, cut off, oversized, or that lead out of their folder.

use std::time::{Duration, Instant};

use d3dgen_proto::v1::ingest_assets_request::Part;
use d3dgen_proto::v1::research_document::Source;
use d3dgen_proto::v1::{
    DomainFile, DownloadAssetRequest, FileChunk, GetAssetRequest, IngestAssetsRequest, IngestFolderRequest,
    IngestHeader, ListDomainsRequest, ParseDomainRequest, ResearchDocument, ResearchKnowledgeRequest,
};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tonic::Code;

use crate::support::{Clients, Server, code, page};

/// Paths that lead out of a folder, or that are none.
const ESCAPES: [&str; 8] =
    ["../x.usdz", "a/../../x.usdz", "/etc/passwd", "a//x.usdz", "./x.usdz", "..", "a\0b", "a\\..\\x"];
/// Requests of the ordinary test; `D3DGEN_HOSTILE_REQUESTS` asks for more.
const REQUESTS: usize = 10_000;

#[tokio::test(flavor = "multi_thread")]
async fn no_name_leads_out_of_its_folder() {
    let dir = tempfile::tempdir().expect("a folder");
    let (root, outside) = (dir.path().join("root"), dir.path().join("outside"));
    std::fs::create_dir_all(root.join("inner")).expect("a folder");
    std::fs::create_dir_all(&outside).expect("a folder");
    let server = Server::start(&dir.path().join("data"), &[&format!("read_roots=[{:?}]", root.display().to_string())]);
    let mut c = Clients::of(&server).await;
    for path in ESCAPES {
        let header = IngestHeader { folder_name: "models".into(), ..Default::default() };
        let parts = |path: &str, folder: &str| {
            let header = IngestHeader { folder_name: folder.into(), ..header.clone() };
            let chunk = FileChunk { path: path.into(), content: vec![1, 2, 3] };
            let parts = [Part::Header(header), Part::Chunk(chunk)];
            tokio_stream::iter(parts.map(|p| IngestAssetsRequest { part: Some(p) }))
        };
        assert_eq!(code(c.assets.ingest_assets(parts(path, "models")).await), Code::InvalidArgument, "{path}");
        assert_eq!(code(c.assets.ingest_assets(parts("x.usdz", path)).await), Code::InvalidArgument, "{path}");
        assert_eq!(code(c.assets.get_asset(GetAssetRequest { asset_id: path.into() }).await), Code::InvalidArgument);
        let download = DownloadAssetRequest { asset_id: path.into(), formats: Vec::new() };
        assert_eq!(code(c.assets.download_asset(download).await), Code::InvalidArgument, "{path}");
        let files = vec![DomainFile { name: path.into(), content: Vec::new() }];
        assert_eq!(code(c.domains.parse_domain(ParseDomainRequest { files }).await), Code::InvalidArgument, "{path}");
        let document =
            ResearchDocument { name: path.into(), source: Some(Source::Content(vec![1])), ..Default::default() };
        let research =
            ResearchKnowledgeRequest { domain_id: "office".into(), documents: vec![document], ..Default::default() };
        assert_eq!(code(c.knowledge.research_knowledge(research).await), Code::InvalidArgument, "{path}");
    }
    let inside = root.join("inner").display().to_string();
    let folder = |path: &str| IngestFolderRequest { server_path: path.into(), ..Default::default() };
    for path in [outside.display().to_string(), format!("{inside}/../../outside"), "/etc".into(), "inner".into()] {
        assert_eq!(code(c.assets.ingest_folder(folder(&path)).await), Code::PermissionDenied, "{path}");
    }
    assert_eq!(code(c.assets.ingest_folder(folder(&inside)).await), Code::Ok);
    let url = ResearchDocument { source: Some(Source::Url("http://127.0.0.1/".into())), ..Default::default() };
    let research = ResearchKnowledgeRequest { domain_id: "office".into(), documents: vec![url], ..Default::default() };
    assert_eq!(code(c.knowledge.research_knowledge(research).await), Code::PermissionDenied);
    let left: Vec<_> = std::fs::read_dir(dir.path()).expect("a folder").flatten().map(|e| e.file_name()).collect();
    assert_eq!(left.len(), 4, "data, its log, root, outside: {left:?}");
}

/// A generator of bytes: xorshift.
struct Bytes(u64);

impl Bytes {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn take(&mut self, most: usize) -> Vec<u8> {
        let length = self.next() as usize % (most + 1);
        (0..length).map(|_| self.next() as u8).collect()
    }
}

/// Sends bytes as the message of a call over gRPC-Web, which is plain HTTP/1, and returns HTTP and gRPC status.
async fn send(address: &str, path: &str, framed: &[u8]) -> std::io::Result<(u16, Option<u32>)> {
    let mut stream = tokio::net::TcpStream::connect(address).await?;
    let head = format!(
        "POST {path} HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/grpc-web+proto\r\nx-grpc-web: 1\r\n\
         connection: close\r\ncontent-length: {}\r\n\r\n",
        framed.len()
    );
    stream.write_all(head.as_bytes()).await?;
    stream.write_all(framed).await?;
    let mut answer = Vec::new();
    let read = tokio::time::timeout(Duration::from_secs(30), stream.read_to_end(&mut answer)).await;
    assert!(read.is_ok(), "no answer to {path} with {} bytes", framed.len());
    let text = String::from_utf8_lossy(&answer);
    let http = text.split(' ').nth(1).and_then(|s| s.parse().ok()).unwrap_or_default();
    let status =
        text.split("grpc-status:").nth(1).map(|s| s.trim_start().chars().take_while(char::is_ascii_digit).collect());
    Ok((http, status.and_then(|s: String| s.parse().ok())))
}

#[tokio::test(flavor = "multi_thread")]
async fn broken_requests_have_answers_and_break_nothing() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut server = Server::start(
        &dir.path().join("data"),
        &["limits.message_bytes=65536", "limits.rate_per_s=1e6", "limits.burst=1e6"],
    );
    let address = server.url.trim_start_matches("http://").to_owned();
    let methods: Vec<String> = d3dgen_server::methods::Methods::shipped()
        .paths()
        .filter(|p| p.starts_with("/d3dgen"))
        .map(str::to_owned)
        .collect();
    let count = std::env::var("D3DGEN_HOSTILE_REQUESTS").ok().and_then(|n| n.parse().ok()).unwrap_or(REQUESTS);
    let mut random = Bytes(0x9e37_79b9_7f4a_7c15);
    let mut tally = std::collections::BTreeMap::<(u16, Option<u32>), usize>::new();
    for n in 0..count {
        let method = &methods[random.next() as usize % methods.len()];
        let mut body = random.take(200);
        let mut framed = vec![0];
        match n % 5 {
            // any bytes as a message
            0 => framed.extend((body.len() as u32).to_be_bytes()),
            // more announced than sent
            1 => framed.extend((body.len() as u32 + 50).to_be_bytes()),
            // larger than the limit
            2 => {
                body = vec![b'x'; 70_000];
                framed.extend((body.len() as u32).to_be_bytes());
            }
            // a huge length, hardly a byte
            3 => framed.extend(u32::MAX.to_be_bytes()),
            // said to be compressed, in no known way
            _ => {
                framed[0] = 1;
                framed.extend((body.len() as u32).to_be_bytes());
            }
        }
        framed.extend(body);
        let answer = send(&address, method, &framed).await.unwrap_or((0, None));
        let known = matches!(answer, (200, Some(0..=16)) | (400..500, _));
        assert!(known || answer.0 == 0, "{method}, kind {}: {answer:?}", n % 5);
        assert!(!matches!(answer.1, Some(2 | 15)), "{method}, kind {}: {answer:?}", n % 5);
        // what a client sends is never the server's failure
        assert_ne!(answer.1, Some(13), "{method}, kind {}: {answer:?}", n % 5);
        let wanted = match n % 5 {
            0 => None,
            2 | 3 => Some(8), // RESOURCE_EXHAUSTED
            _ => Some(3),     // INVALID_ARGUMENT
        };
        if let (Some(_), Some(said)) = (wanted, answer.1) {
            assert_eq!(Some(said), wanted, "{method}, kind {}: {answer:?}", n % 5);
        }
        *tally.entry(answer).or_default() += 1;
    }
    assert!(!server.log().contains("ERROR"), "an error in the log: {}", server.log());
    println!("{count} broken requests: {tally:?}");
    assert!(server.runs());
    let mut c = Clients::of(&server).await;
    assert_eq!(code(c.domains.list_domains(ListDomainsRequest::default()).await), Code::Ok);
    assert_eq!(page(&server.url, "/healthz", "").0, 200);
    // the call that asks is one itself; what was given up ends soon after
    let begun = Instant::now();
    let mut metrics = page(&server.url, "/metrics", "").1;
    while !metrics.contains("d3dgen_calls_in_flight 1\n") && begun.elapsed() < Duration::from_secs(10) {
        tokio::time::sleep(Duration::from_millis(50)).await;
        metrics = page(&server.url, "/metrics", "").1;
    }
    assert!(metrics.contains("d3dgen_calls_in_flight 1\n"), "{metrics}");
}
