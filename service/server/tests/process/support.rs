//! A server process on loopback, with folders of its own, ended when it is dropped.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use d3dgen_proto::v1::asset_service_client::AssetServiceClient;
use d3dgen_proto::v1::domain_service_client::DomainServiceClient;
use d3dgen_proto::v1::job_service_client::JobServiceClient;
use d3dgen_proto::v1::knowledge_service_client::KnowledgeServiceClient;
use d3dgen_proto::v1::world_service_client::WorldServiceClient;
use d3dgen_proto::v1::{BuildingRequest, DomainManifest, GetDomainRequest, GetJobRequest, Job};
use d3dgen_server::access::{digest, hex};
use d3dgen_tests::program;
use tonic::metadata::MetadataValue;
use tonic::transport::{Channel, Endpoint};
use tonic::{Request, Status};

/// The tokens of a server that has some, by scope.
pub const TOKENS: [(&str, &str); 3] = [("read", "r-secret"), ("write", "w-secret"), ("admin", "a-secret")];
/// Longest time of a whole test's wait.
const PATIENCE: Duration = Duration::from_secs(120);

/// A server process.
pub struct Server {
    child: Child,
    /// `http://127.0.0.1:PORT`.
    pub url: String,
    /// Folder of its databases.
    pub data: PathBuf,
}

impl Server {
    /// Starts a server on a folder, with further settings.
    pub fn start(data: &Path, settings: &[&str]) -> Self {
        Self::start_by(Command::new(program()), data, settings)
    }

    /// Does as [`Server::start`] with a command that runs the program with the arguments it is given.
    pub fn start_by(mut command: Command, data: &Path, settings: &[&str]) -> Self {
        command.args(["serve", "--listen", "127.0.0.1:0", "--data-dir"]).arg(data).env("D3DGEN_STORE", "");
        for setting in settings {
            command.args(["--set", setting]);
        }
        let log = std::fs::File::options().create(true).append(true).open(data.with_extension("log")).expect("a log");
        let mut child = command.stdout(Stdio::piped()).stderr(log).spawn().expect("the command starts");
        let mut line = String::new();
        let out = child.stdout.take().expect("piped");
        BufReader::new(out).read_line(&mut line).expect("a line with the address");
        let address = line.trim().strip_prefix("listening on ").unwrap_or_else(|| {
            panic!("said {line:?}: {}", std::fs::read_to_string(data.with_extension("log")).unwrap_or_default())
        });
        Self { url: format!("http://{address}"), child, data: data.to_path_buf() }
    }

    /// Starts a server that knows [`TOKENS`], with further settings.
    pub fn with_tokens(data: &Path, settings: &[&str]) -> Self {
        let tokens: Vec<String> = TOKENS
            .iter()
            .map(|(scope, token)| {
                let sha256 = hex(&digest(token.as_bytes()));
                format!("{{ name = \"{scope}-client\", scope = \"{scope}\", sha256 = \"{sha256}\" }}")
            })
            .collect();
        let tokens = format!("tokens=[{}]", tokens.join(", "));
        Self::start(data, &[&[tokens.as_str()], settings].concat())
    }

    /// Returns a connection.
    pub async fn channel(&self) -> Channel {
        Endpoint::new(self.url.clone()).expect("an address").connect().await.expect("a connection")
    }

    /// Ends the process at once, as a power failure would.
    pub fn kill(mut self) {
        self.child.kill().expect("it runs");
        self.child.wait().expect("it ended");
    }

    /// Returns true while the process runs.
    pub fn runs(&mut self) -> bool {
        self.child.try_wait().expect("its state").is_none()
    }

    /// Returns the id of the process.
    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Waits for the process to end and returns whether it ended well.
    pub fn wait(&mut self) -> bool {
        self.child.wait().expect("it ended").success()
    }

    /// Returns the lines of its log.
    pub fn log(&self) -> String {
        std::fs::read_to_string(self.data.with_extension("log")).expect("a log")
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The clients of all services, with a token perhaps.
#[derive(Clone)]
pub struct Clients {
    pub domains: DomainServiceClient<Channel>,
    pub knowledge: KnowledgeServiceClient<Channel>,
    pub assets: AssetServiceClient<Channel>,
    pub worlds: WorldServiceClient<Channel>,
    pub jobs: JobServiceClient<Channel>,
}

impl Clients {
    pub async fn of(server: &Server) -> Self {
        let channel = server.channel().await;
        let most = 64 << 20;
        Self {
            domains: DomainServiceClient::new(channel.clone()).max_decoding_message_size(most),
            knowledge: KnowledgeServiceClient::new(channel.clone()).max_decoding_message_size(most),
            assets: AssetServiceClient::new(channel.clone()).max_decoding_message_size(most),
            worlds: WorldServiceClient::new(channel.clone()).max_decoding_message_size(most),
            jobs: JobServiceClient::new(channel).max_decoding_message_size(most),
        }
    }

    /// Waits until a job ends.
    pub async fn ended(&mut self, job_id: &str) -> Job {
        let begun = std::time::Instant::now();
        loop {
            let job = self.jobs.get_job(GetJobRequest { job_id: job_id.into() }).await.expect("there");
            let job = job.into_inner().job.expect("a job");
            if job.ended_at.is_some() {
                return job;
            }
            assert!(begun.elapsed() < PATIENCE, "{job:?}");
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
    }
}

/// Returns a request with a token.
pub fn with<T>(token: &str, message: T) -> Request<T> {
    let mut request = Request::new(message);
    let value = MetadataValue::try_from(format!("Bearer {token}")).expect("plain");
    request.metadata_mut().insert("authorization", value);
    request
}

/// Returns a small building.
pub fn flat(seed: u64) -> Option<BuildingRequest> {
    let prompt = "apartment with a kitchen, a bathroom and two bedrooms in Germany".into();
    Some(BuildingRequest { prompt, seed, ..BuildingRequest::default() })
}

/// Returns the manifest of a domain that is there.
pub async fn manifest(clients: &mut Clients, domain_id: &str) -> DomainManifest {
    let get = GetDomainRequest { domain_id: domain_id.into(), include_manifest: true, ..Default::default() };
    clients.domains.get_domain(get).await.expect("there").into_inner().manifest.expect("a manifest")
}

/// Returns the code of an answer.
pub fn code<T>(answer: Result<T, Status>) -> tonic::Code {
    answer.err().map_or(tonic::Code::Ok, |s| s.code())
}

/// Sends bytes over plain TCP and returns the whole answer.
pub fn raw(url: &str, request: &str) -> String {
    use std::io::{Read, Write};
    let mut stream = std::net::TcpStream::connect(url.trim_start_matches("http://")).expect("a connection");
    stream.write_all(request.as_bytes()).expect("sent");
    let mut text = String::new();
    stream.read_to_string(&mut text).expect("an answer");
    text
}

/// Asks for a page over plain HTTP/1 and returns status and body.
pub fn page(url: &str, path: &str, headers: &str) -> (u16, String) {
    let text = raw(url, &format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n{headers}\r\n"));
    let status = text.split(' ').nth(1).and_then(|s| s.parse().ok()).unwrap_or_default();
    (status, text.split("\r\n\r\n").nth(1).unwrap_or_default().to_owned())
}
