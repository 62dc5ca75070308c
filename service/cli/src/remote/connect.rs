//! The connection to a server: plain, or TLS by rustls with ring.

use std::io;
use std::path::Path;
use std::sync::Arc;

use hyper_util::rt::TokioIo;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, ServerName};
use rustls::{ClientConfig, RootCertStore};
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;
use tokio_rustls::TlsConnector;
use tonic::transport::{Channel, Endpoint, Uri};

use crate::error::Error;

/// A connection of either kind.
trait Stream: AsyncRead + AsyncWrite + Send + Unpin {}
impl<T: AsyncRead + AsyncWrite + Send + Unpin> Stream for T {}

/// Returns a connection, made when it is first used.
///
/// # Errors
/// `Input` for an address that is none, and certificates that cannot be used; `Read`.
pub fn channel(url: &str, ca: Option<&Path>) -> Result<Channel, Error> {
    let wrong = || Error::Input(format!("--server {url}: write http://HOST:PORT or https://HOST:PORT"));
    let uri: Uri = url.parse().map_err(|_| wrong())?;
    let host = uri.host().ok_or_else(wrong)?.to_owned();
    let (tls, usual) = match uri.scheme_str() {
        Some("https") => (Some(tls(&host, ca)?), 443),
        Some("http") => (None, 80),
        _ => return Err(wrong()),
    };
    let address = format!("{host}:{}", uri.port_u16().unwrap_or(usual));
    let connect = tower::service_fn(move |_: Uri| {
        let (address, tls) = (address.clone(), tls.clone());
        async move { open(&address, tls).await.map(TokioIo::new) }
    });
    Ok(Endpoint::from(uri).tcp_nodelay(true).connect_with_connector_lazy(connect))
}

async fn open(address: &str, tls: Option<(TlsConnector, ServerName<'static>)>) -> io::Result<Box<dyn Stream>> {
    let named = |e: io::Error| io::Error::new(e.kind(), format!("{address}: {e}"));
    let stream = TcpStream::connect(address).await.map_err(named)?;
    stream.set_nodelay(true)?;
    Ok(match tls {
        None => Box::new(stream),
        Some((connector, name)) => Box::new(connector.connect(name, stream).await.map_err(named)?),
    })
}

fn tls(host: &str, ca: Option<&Path>) -> Result<(TlsConnector, ServerName<'static>), Error> {
    let mut roots = RootCertStore::empty();
    match ca {
        Some(path) => {
            let unusable = |e: &dyn std::fmt::Display| Error::Input(format!("--ca {}: {e}", path.display()));
            for certificate in CertificateDer::pem_file_iter(path).map_err(|e| unusable(&e))? {
                roots.add(certificate.map_err(|e| unusable(&e))?).map_err(|e| unusable(&e))?;
            }
            if roots.is_empty() {
                return Err(unusable(&"holds no certificate"));
            }
        }
        None => {
            roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
        }
    }
    let failed = |e: &dyn std::fmt::Display| Error::Input(format!("--server: TLS: {e}"));
    let mut config = ClientConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
        .with_safe_default_protocol_versions()
        .map_err(|e| failed(&e))?
        .with_root_certificates(roots)
        .with_no_client_auth();
    config.alpn_protocols = vec![b"h2".to_vec()];
    let name = host.trim_start_matches('[').trim_end_matches(']').to_owned();
    let name = ServerName::try_from(name).map_err(|e| failed(&e))?;
    Ok((TlsConnector::from(Arc::new(config)), name))
}
