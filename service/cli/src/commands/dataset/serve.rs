//! `d3dgen dataset serve`: the gallery and the files of a data set over HTTP, to this machine.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use d3dgen_dataset::assemble::is_finished;

use crate::error::Error;
use crate::interrupt;

/// How long a client may take for a request.
const PATIENCE: Duration = Duration::from_secs(20);
/// Longest line of a request, bytes.
const MOST_LINE: u64 = 8 << 10;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// A finished data set
    dataset: PathBuf,
    /// Port on the loopback address; 0 takes a free one
    #[arg(long, value_name = "PORT", default_value_t = 8080)]
    port: u16,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        if !is_finished(&self.dataset) {
            return Err(Error::Input(format!("{} is no finished data set", self.dataset.display())));
        }
        let refused = |e: io::Error| Error::Input(format!("port {} cannot be used: {e}", self.port));
        let listener = TcpListener::bind(("127.0.0.1", self.port)).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        interrupt::listen();
        eprintln!("http://{}/", listener.local_addr().map_err(refused)?);
        let root = Arc::new(self.dataset);
        while interrupt::check().is_ok() {
            match listener.accept() {
                Ok((stream, _)) => {
                    let root = Arc::clone(&root);
                    thread::spawn(move || answer(&stream, &root));
                }
                Err(e) if e.kind() == io::ErrorKind::WouldBlock => thread::sleep(Duration::from_millis(50)),
                Err(e) => return Err(refused(e)),
            }
        }
        Ok(())
    }
}

/// Answers one request; a client that has gone away is no error.
fn answer(stream: &TcpStream, root: &Path) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut reader = BufReader::new(stream).take(MOST_LINE);
    let mut line = String::new();
    reader.read_line(&mut line)?;
    let mut rest = String::new();
    while reader.read_line(&mut rest)? > 2 {
        rest.clear(); // headers say nothing that matters here
    }
    let mut words = line.split_ascii_whitespace();
    let (method, target) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let file = inside(root, target).and_then(|path| Some((File::open(&path).ok()?, path)));
    let mut out = io::BufWriter::new(stream);
    match file {
        Some((mut file, path)) if method == "GET" || method == "HEAD" => {
            let length = file.metadata()?.len();
            write!(
                out,
                "HTTP/1.1 200 OK\r\nContent-Type: {}\r\nContent-Length: {length}\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
                content_type(&path)
            )?;
            if method == "GET" {
                io::copy(&mut file, &mut out)?;
            }
        }
        _ => write!(out, "HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n")?,
    }
    out.flush()
}

/// Returns the file that a request names, where it is one of the folder.
fn inside(root: &Path, target: &str) -> Option<PathBuf> {
    let path = target.split(['?', '#']).next()?.strip_prefix('/')?;
    let path = if path.is_empty() { "index.html" } else { path };
    let plain = Path::new(path).components().all(|c| matches!(c, Component::Normal(_)));
    let found = root.join(path);
    (plain && !path.contains('\\') && found.is_file()).then_some(found)
}

fn content_type(path: &Path) -> &'static str {
    match path.extension().and_then(|e| e.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("json" | "jsonl") => "application/json",
        Some("md" | "toml" | "py") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_the_folder_are_served() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("index.html"), "x").unwrap();
        assert!(inside(folder.path(), "/").is_some() && inside(folder.path(), "/index.html?x=1").is_some());
        for target in ["/../x", "//etc/passwd", "/.", "index.html", "/no", "/a/../index.html"] {
            assert!(inside(folder.path(), target).is_none(), "{target}");
        }
    }
}
