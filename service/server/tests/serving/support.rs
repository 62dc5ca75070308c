//! A server in this process, and clients without manners.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use bytes::Bytes;
use d3dgen_proto::v1::generate_world_request::Start;
use d3dgen_proto::v1::{BuildingRequest, GenerateWorldRequest};
use d3dgen_server::clock::Clock;
use d3dgen_server::core::{Core, Programs};
use d3dgen_server::{config, serve};
use d3dgen_store::embed::StaticTable;
use h2::client::SendRequest;
use prost::Message;
use tempfile::TempDir;
use tokio::net::TcpStream;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tonic::transport::{Channel, Endpoint};

/// Longest wait for something that comes.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// A server in this process; it ends with the test.
pub struct Server {
    pub core: Arc<Core>,
    pub address: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    pub ended: JoinHandle<()>,
    _home: TempDir,
}

impl Server {
    /// Starts a server with settings like `limits.threads=1`.
    pub async fn start(settings: &[&str]) -> Self {
        let home = TempDir::new().expect("a folder");
        let mut flags = vec![("listen".to_owned(), "127.0.0.1:0".to_owned())];
        flags.extend(settings.iter().map(|s| {
            let (key, value) = s.split_once('=').expect("KEY=VALUE");
            (key.to_owned(), value.to_owned())
        }));
        let config = config::read(None, &[], &flags, Some(home.path().join("data"))).expect("settings");
        let clock = Clock::new(|| SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default());
        let opened = move || Core::open(config, clock, Arc::new(StaticTable::new()), Programs::default());
        let core = tokio::task::spawn_blocking(opened).await.expect("no panic").expect("a server");
        let (ready, address) = oneshot::channel();
        let (stop, stopped) = oneshot::channel::<()>();
        let served = Arc::clone(&core);
        let ended = tokio::spawn(async move {
            let ready = |address| {
                let _ = ready.send(address);
            };
            let stop = async { drop(stopped.await) };
            serve::serve(served, ready, stop).await.expect("it serves");
        });
        let address = address.await.expect("an address");
        Self { core, address, stop: Some(stop), ended, _home: home }
    }

    /// Asks the server to stop.
    pub fn stop(&mut self) {
        drop(self.stop.take());
    }

    /// Returns a connection with manners.
    pub async fn channel(&self) -> Channel {
        Endpoint::new(format!("http://{}", self.address)).expect("an address").connect().await.expect("a connection")
    }

    /// Waits until a gauge shows a figure; panics when it takes longer than `within`.
    pub async fn gauge(&self, name: &str, gauge: impl Fn(&Core) -> &AtomicI64, wanted: i64, within: Duration) {
        let begun = Instant::now();
        loop {
            let now = gauge(&self.core).load(Ordering::SeqCst);
            if now == wanted {
                return;
            }
            assert!(begun.elapsed() < within, "{name} is {now} after {:.1} s, wanted {wanted}", within.as_secs_f64());
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }
}

/// A building; rooms of a hospital take seconds, those of a flat less.
pub fn building(prompt: &str, seed: u64) -> GenerateWorldRequest {
    let building = BuildingRequest { prompt: prompt.into(), seed, ..Default::default() };
    GenerateWorldRequest { start: Some(Start::Building(building)), ..Default::default() }
}

/// A flat.
pub const SMALL: &str = "apartment with a kitchen, a bathroom and two bedrooms in Germany";
/// A building that takes longer than the deadlines of these tests.
pub const LARGE: &str = "hospital ward with 120 patient rooms, 20 offices and 30 storage rooms in Germany";

/// Returns a message as gRPC frames it.
pub fn framed(message: &impl Message) -> Bytes {
    let body = message.encode_to_vec();
    let length = u32::try_from(body.len()).expect("small");
    [&[0][..], &length.to_be_bytes(), &body].concat().into()
}

/// Returns an HTTP/2 connection on which the server may send nothing of an answer's body.
pub async fn unread_connection(server: &Server) -> SendRequest<Bytes> {
    let stream = TcpStream::connect(server.address).await.expect("a connection");
    let (client, connection) =
        h2::client::Builder::new().initial_window_size(0).handshake::<_, Bytes>(stream).await.expect("HTTP/2");
    tokio::spawn(connection);
    client
}

/// Calls a method on such a connection and returns the answer once its headers are there.
pub async fn call_unread(
    client: &SendRequest<Bytes>,
    path: &str,
    timeout: &str,
    message: Bytes,
) -> (h2::client::ResponseFuture, h2::SendStream<Bytes>) {
    let mut client = client.clone().ready().await.expect("room for a stream");
    let request = http::Request::post(format!("http://127.0.0.1{path}"))
        .header("content-type", "application/grpc")
        .header("te", "trailers")
        .header("grpc-timeout", timeout)
        .body(())
        .expect("a request");
    let (answer, mut body) = client.send_request(request, false).expect("sent");
    body.send_data(message, true).expect("sent");
    (answer, body)
}
