//! Commands that a server answers: with `--server URL` the same flags and the same output, worked on elsewhere.
//!
//! What it is not for: starting a server (`commands/serve.rs`).

pub mod assets;
mod connect;
pub mod domains;
pub mod generate;
pub mod jobs;
pub mod knowledge;

use std::future::Future;
use std::path::PathBuf;

use d3dgen_proto::convert::Contract;
use tonic::metadata::{Ascii, MetadataValue};
use tonic::transport::Channel;
use tonic::{Code, Request, Response, Status};

use crate::error::Error;
use crate::registry::RegistryArgs;

/// Largest answer that is taken, bytes.
pub const MESSAGE_BYTES: usize = 256 << 20;
/// Variable with the token.
const TOKEN: &str = "D3DGEN_TOKEN";

/// Flags of commands that a server can answer.
#[derive(clap::Args, Clone, Default)]
pub struct ServerArgs {
    /// Have this server do it: http://127.0.0.1:50051, or https://HOST:PORT
    #[arg(long, value_name = "URL")]
    pub server: Option<String>,
    /// File with the token for the server; otherwise $D3DGEN_TOKEN
    #[arg(long, value_name = "FILE", requires = "server")]
    token_file: Option<PathBuf>,
    /// File (PEM) with the certificates that the server's is signed with; otherwise those the system trusts
    #[arg(long, value_name = "FILE", requires = "server")]
    ca: Option<PathBuf>,
}

impl ServerArgs {
    /// Returns the server to ask, or none when the command works here.
    ///
    /// # Errors
    /// `Input` for an address that is none, for a token or certificates that cannot be used, and for flags about databases
    /// here; `Read`.
    pub fn instead_of(&self, here: &RegistryArgs) -> Result<Option<Remote>, Error> {
        let Some(remote) = self.remote()? else { return Ok(None) };
        if let Some(folder) = here.domains_dir.first() {
            let folder = folder.display();
            return Err(Error::Input(format!(
                "--domains-dir {folder} and --server: a server has domains of its own; `d3dgen domains register {folder} --server URL` adds one"
            )));
        }
        if let Some(store) = &here.store.store {
            let store = store.display();
            return Err(Error::Input(format!("--store {store} and --server: a server has a database of its own")));
        }
        Ok(Some(remote))
    }

    /// Returns the server to ask, for commands that only a server can answer.
    ///
    /// # Errors
    /// As [`ServerArgs::instead_of`]; `Input` when none is named.
    pub fn required(&self) -> Result<Remote, Error> {
        self.remote()?
            .ok_or_else(|| Error::Input("--server URL says which server to ask; this works on a server only".into()))
    }

    /// Returns the server to ask, or none when none is named.
    ///
    /// # Errors
    /// As [`ServerArgs::instead_of`].
    pub fn remote(&self) -> Result<Option<Remote>, Error> {
        self.server.as_deref().map(|url| Remote::new(url, self)).transpose()
    }
}

/// A server to ask.
pub struct Remote {
    runtime: tokio::runtime::Runtime,
    channel: Channel,
    token: Option<MetadataValue<Ascii>>,
}

impl Remote {
    fn new(url: &str, args: &ServerArgs) -> Result<Self, Error> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|e| Error::Input(format!("--server: the system gives no runtime: {e}")))?;
        let channel = {
            let _inside = runtime.enter();
            connect::channel(url, args.ca.as_deref())?
        };
        Ok(Self { runtime, channel, token: token(args)? })
    }

    /// Returns a server to ask what needs no token.
    ///
    /// # Errors
    /// `Input` for an address or certificates that cannot be used; `Read`.
    pub fn to(url: &str, ca: Option<&std::path::Path>) -> Result<Self, Error> {
        let args = ServerArgs { server: Some(url.to_owned()), token_file: None, ca: ca.map(PathBuf::from) };
        Self::new(url, &args)
    }

    /// Returns the connection, for a client of one of the services.
    pub fn channel(&self) -> Channel {
        self.channel.clone()
    }

    /// Returns a request with the token.
    pub fn request<T>(&self, message: T) -> Request<T> {
        let mut request = Request::new(message);
        if let Some(token) = &self.token {
            request.metadata_mut().insert("authorization", token.clone());
        }
        request
    }

    /// Waits for an answer.
    ///
    /// # Errors
    /// `Remote`, see [`refused`].
    pub fn ask<T>(&self, call: impl Future<Output = Result<Response<T>, Status>>) -> Result<T, Error> {
        self.runtime.block_on(call).map(Response::into_inner).map_err(refused)
    }

    /// Waits for something else that a server does.
    pub fn wait<T>(&self, work: impl Future<Output = T>) -> T {
        self.runtime.block_on(work)
    }
}

/// Reads the token from its file or the variable.
fn token(args: &ServerArgs) -> Result<Option<MetadataValue<Ascii>>, Error> {
    let (text, place) = match &args.token_file {
        Some(path) => {
            let read = std::fs::read_to_string(path).map_err(|source| Error::Read { path: path.clone(), source })?;
            (read, path.display().to_string())
        }
        None => match std::env::var(TOKEN) {
            Ok(text) => (text, format!("${TOKEN}")),
            Err(_) => return Ok(None),
        },
    };
    let value = MetadataValue::try_from(format!("Bearer {}", text.trim()));
    let mut value = value.map_err(|_| Error::Input(format!("{place} holds no token: one line of plain text")))?;
    value.set_sensitive(true);
    Ok(Some(value))
}

/// Returns what a server refused, as the command says it.
pub fn refused(status: Status) -> Error {
    match status.code() {
        Code::Cancelled if crate::interrupt::check().is_err() => Error::Interrupted,
        Code::Unauthenticated => {
            Error::Remote(format!("{}: --token-file FILE or ${TOKEN} gives the token", status.message()))
        }
        code => Error::Remote(format!("{}: {}", d3dgen_server::status::code_name(code), status.message())),
    }
}

/// Returns the document of an answer.
///
/// # Errors
/// `Remote` when the server's release has other documents.
pub fn document<D: Contract>(message: Option<D::Message>) -> Result<D, Error> {
    let message = message.ok_or_else(|| Error::Remote("the answer lacks a document".into()))?;
    d3dgen_proto::convert::from_proto(&message)
        .map_err(|e| Error::Remote(format!("the answer is of another release: {e}")))
}

/// Returns a part of a document of an answer.
///
/// # Errors
/// As [`document`].
pub fn part<T: serde::de::DeserializeOwned, M: prost::Message + prost::Name>(message: &M) -> Result<T, Error> {
    d3dgen_proto::convert::from_message(message)
        .map_err(|e| Error::Remote(format!("the answer is of another release: {e}")))
}
