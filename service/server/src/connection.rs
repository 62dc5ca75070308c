//! Connections: accepted up to a number, with TLS where it is configured, and dropped when they say nothing, take nothing,
//! or when a handshake takes too long.

mod guarded;
mod slots;

use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::task::{Context, Poll};
use std::time::Duration;

use rustls::ServerConfig;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpListener;
use tokio::sync::mpsc;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::server::TlsStream;
use tokio_stream::wrappers::ReceiverStream;
use tonic::transport::server::Connected;

use crate::config::Tls;
use crate::error::Error;
use crate::metrics::Metrics;
use guarded::Guarded;
use slots::Slots;

/// Longest time of a TLS handshake.
const HANDSHAKE: Duration = Duration::from_secs(10);
/// Pause after the system refused to accept, for instance for want of file handles.
const PAUSE: Duration = Duration::from_millis(50);

/// Where a call comes from.
#[derive(Debug, Clone, Copy)]
pub struct Peer {
    /// The address.
    pub address: SocketAddr,
    /// True when the connection has no place of its own: only health is answered.
    pub spare: bool,
}

/// A connection of a client.
pub struct Connection {
    stream: Stream,
    peer: Peer,
    metrics: Arc<Metrics>,
}

enum Stream {
    Plain(Box<Guarded>),
    Tls(Box<TlsStream<Guarded>>),
}

/// Reads certificate and key.
///
/// # Errors
/// `Tls` with the file at fault.
pub fn acceptor(tls: &Tls) -> Result<TlsAcceptor, Error> {
    let failed = |what: &std::path::Path, e: &dyn std::fmt::Display| Error::Tls(format!("{}: {e}", what.display()));
    let chain = CertificateDer::pem_file_iter(&tls.certificate_file)
        .and_then(|all| all.collect::<Result<Vec<_>, _>>())
        .map_err(|e| failed(&tls.certificate_file, &e))?;
    let key = PrivateKeyDer::from_pem_file(&tls.key_file).map_err(|e| failed(&tls.key_file, &e))?;
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let mut config = ServerConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .map_err(|e| Error::Tls(e.to_string()))?
        .with_no_client_auth()
        .with_single_cert(chain, key)
        .map_err(|e| failed(&tls.certificate_file, &e))?;
    config.alpn_protocols = vec![b"h2".to_vec(), b"http/1.1".to_vec()];
    Ok(TlsAcceptor::from(Arc::new(config)))
}

/// Accepts connections until the stream is dropped, at most `limit` at a time and `each` of one address; beyond that a few
/// on which only health is answered.
pub fn accept(
    listener: TcpListener,
    tls: Option<TlsAcceptor>,
    (limit, each): (usize, usize),
    metrics: Arc<Metrics>,
) -> ReceiverStream<io::Result<Connection>> {
    let (send, receive) = mpsc::channel(16);
    let slots = Slots::new(limit, each);
    tokio::spawn(async move {
        loop {
            let accepted = tokio::select! {
                accepted = listener.accept() => accepted,
                () = send.closed() => break,
            };
            let (stream, address) = match accepted {
                Ok(accepted) => accepted,
                Err(refused) => {
                    tracing::warn!(reason = %refused, "cannot accept");
                    tokio::time::sleep(PAUSE).await;
                    continue;
                }
            };
            let _ = stream.set_nodelay(true);
            let (send, tls, metrics) = (send.clone(), tls.clone(), Arc::clone(&metrics));
            let stream = Guarded::new(stream, slots.take(address.ip()));
            let peer = Peer { address, spare: stream.is_spare() };
            let wrap = move |stream| {
                metrics.connections.fetch_add(1, Ordering::Relaxed);
                Connection { stream, peer, metrics }
            };
            match tls {
                None => drop(send.send(Ok(wrap(Stream::Plain(Box::new(stream))))).await),
                Some(tls) => drop(tokio::spawn(async move {
                    match tokio::time::timeout(HANDSHAKE, tls.accept(stream)).await {
                        Ok(Ok(stream)) => drop(send.send(Ok(wrap(Stream::Tls(Box::new(stream))))).await),
                        Ok(Err(refused)) => tracing::debug!(peer = %address, reason = %refused, "no TLS"),
                        Err(_) => tracing::debug!(peer = %address, "TLS took too long"),
                    }
                })),
            }
        }
    });
    ReceiverStream::new(receive)
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.metrics.connections.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Connected for Connection {
    type ConnectInfo = Peer;

    fn connect_info(&self) -> Peer {
        self.peer
    }
}

impl AsyncRead for Connection {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        match &mut self.stream {
            Stream::Plain(stream) => Pin::new(stream).poll_read(cx, buf),
            Stream::Tls(stream) => Pin::new(stream).poll_read(cx, buf),
        }
    }
}

impl AsyncWrite for Connection {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        match &mut self.stream {
            Stream::Plain(stream) => Pin::new(stream).poll_write(cx, bytes),
            Stream::Tls(stream) => Pin::new(stream).poll_write(cx, bytes),
        }
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        match &mut self.stream {
            Stream::Plain(stream) => Pin::new(stream).poll_flush(cx),
            Stream::Tls(stream) => Pin::new(stream).poll_flush(cx),
        }
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        match &mut self.stream {
            Stream::Plain(stream) => Pin::new(stream).poll_shutdown(cx),
            Stream::Tls(stream) => Pin::new(stream).poll_shutdown(cx),
        }
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        match &mut self.stream {
            Stream::Plain(stream) => Pin::new(stream).poll_write_vectored(cx, bytes),
            Stream::Tls(stream) => Pin::new(stream).poll_write_vectored(cx, bytes),
        }
    }

    fn is_write_vectored(&self) -> bool {
        match &self.stream {
            Stream::Plain(stream) => stream.is_write_vectored(),
            Stream::Tls(stream) => stream.is_write_vectored(),
        }
    }
}
