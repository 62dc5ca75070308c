//! A server that answers as a test says, and a resolver that says where names lead.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use d3dgen_research::Error;
use d3dgen_research::fetch::{Cache, Code, Fetched, Fetcher, Options, Resolve, Resolved};

/// A part of an answer: bytes, then a pause.
pub type Part = (Vec<u8>, Duration);

/// What was asked: the host as the client named it, the path, and the address that was connected to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Asked {
    pub host: String,
    pub path: String,
    pub at: IpAddr,
}

pub struct Server {
    pub port: u16,
    pub asked: Arc<Mutex<Vec<Asked>>>,
}

impl Server {
    /// Starts a server on all addresses of loopback. It ends with the test.
    pub fn start(answer: impl Fn(&Asked) -> Vec<Part> + Send + Sync + 'static) -> Self {
        let listener = TcpListener::bind(("0.0.0.0", 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        let asked = Arc::new(Mutex::new(Vec::new()));
        let (log, answer) = (Arc::clone(&asked), Arc::new(answer));
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (log, answer) = (Arc::clone(&log), Arc::clone(&answer));
                std::thread::spawn(move || serve(stream, &log, answer.as_ref()));
            }
        });
        Self { port, asked }
    }

    pub fn url(&self, path: &str) -> String {
        format!("http://site.test:{}{path}", self.port)
    }

    pub fn paths(&self) -> Vec<String> {
        self.asked.lock().unwrap().iter().map(|a| a.path.clone()).collect()
    }
}

fn serve(mut stream: TcpStream, log: &Mutex<Vec<Asked>>, answer: &dyn Fn(&Asked) -> Vec<Part>) {
    let mut head = Vec::new();
    let mut byte = [0];
    while !head.ends_with(b"\r\n\r\n") && stream.read(&mut byte).is_ok_and(|n| n == 1) {
        head.push(byte[0]);
    }
    let head = String::from_utf8_lossy(&head).into_owned();
    let field =
        |name: &str| head.lines().find_map(|l| l.to_lowercase().strip_prefix(name).map(|v| v.trim().to_owned()));
    let path = head.split(' ').nth(1).unwrap_or_default().to_owned();
    let asked = Asked { host: field("host:").unwrap_or_default(), path, at: stream.local_addr().unwrap().ip() };
    log.lock().unwrap().push(asked.clone());
    for (bytes, pause) in answer(&asked) {
        if stream.write_all(&bytes).and_then(|()| stream.flush()).is_err() {
            return;
        }
        std::thread::sleep(pause);
    }
}

/// Returns a whole answer.
pub fn reply(status: u16, headers: &[(&str, &str)], body: &[u8]) -> Vec<Part> {
    let mut bytes =
        format!("HTTP/1.1 {status} Some\r\nContent-Length: {}\r\nConnection: close\r\n", body.len()).into_bytes();
    headers.iter().for_each(|(k, v)| bytes.extend(format!("{k}: {v}\r\n").bytes()));
    bytes.extend(b"\r\n");
    bytes.extend(body);
    vec![(bytes, Duration::ZERO)]
}

pub fn page(text: &str) -> Vec<Part> {
    reply(200, &[("Content-Type", "text/html")], text.as_bytes())
}

pub fn not_found() -> Vec<Part> {
    reply(404, &[], b"")
}

/// Names with their addresses, one set a lookup; the last set stays.
#[derive(Default)]
pub struct Names(pub Mutex<BTreeMap<String, Vec<Vec<IpAddr>>>>);

impl Names {
    pub fn of(name: &str, answers: &[&[&str]]) -> Arc<Self> {
        let sets = answers.iter().map(|a| a.iter().map(|t| t.parse().unwrap()).collect()).collect();
        Arc::new(Self(Mutex::new(BTreeMap::from([(name.to_owned(), sets)]))))
    }
}

impl Resolve for Names {
    fn resolve<'a>(&'a self, host: &'a str) -> Resolved<'a> {
        let mut names = self.0.lock().unwrap();
        let answer = match names.get_mut(host) {
            Some(sets) if sets.len() > 1 => Ok(sets.remove(0)),
            Some(sets) => Ok(sets[0].clone()),
            None => Err(std::io::Error::other("no such name")),
        };
        Box::pin(async move { answer })
    }
}

/// Options under which a server of ours may be reached.
pub fn options(port: u16) -> Options {
    Options {
        ports: vec![port],
        allow_addresses: vec!["127.0.0.0/8".parse().unwrap()],
        crawl_delay: Duration::ZERO,
        max_crawl_delay: Duration::from_millis(300),
        max_bytes: 1 << 20,
        ..Options::default()
    }
}

pub fn fetcher(options: Options, cache: Option<Cache>) -> Fetcher {
    let names = Names::of("site.test", &[&["127.0.0.1"]]);
    Fetcher::with_resolver(options, cache, Arc::new(|| 1_795_271_460), names)
}

/// Fetches from a server of ours with usual options.
pub async fn get(server: &Server, path: &str) -> Result<Fetched, Error> {
    fetcher(options(server.port), None).fetch(&server.url(path)).await
}

pub fn code<T: std::fmt::Debug>(result: Result<T, Error>) -> Code {
    match result {
        Err(Error::Fetch { code, .. }) => code,
        other => panic!("no error of fetching: {other:?}"),
    }
}

/// The address of the server as a socket address, for tests that name it by number.
pub fn numbers(server: &Server) -> SocketAddr {
    SocketAddr::from(([127, 0, 0, 1], server.port))
}
