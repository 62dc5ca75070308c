//! `d3dgen domains` of a server: list, show, register, remove.

use std::path::Path;

use d3dgen_model::domain::Domain;
use d3dgen_plugins::{Custom, Plugin};
use d3dgen_proto::convert::to_proto;
use d3dgen_proto::v1::domain_service_client::DomainServiceClient;
use d3dgen_proto::v1::{
    Domain as Listed, GetDomainRequest, ListDomainsRequest, RegisterDomainRequest, RemoveDomainRequest,
};
use tonic::transport::Channel;

use super::{MESSAGE_BYTES, Remote, document};
use crate::error::Error;

/// Entries of one answer.
const PAGE: i32 = 200;

fn client(remote: &Remote) -> DomainServiceClient<Channel> {
    DomainServiceClient::new(remote.channel()).max_decoding_message_size(MESSAGE_BYTES)
}

/// Returns the server's domains, with the number of programs of each.
///
/// # Errors
/// `Remote`.
pub fn list(remote: &Remote) -> Result<Vec<(Listed, Domain)>, Error> {
    let (mut client, mut found, mut page_token) = (client(remote), Vec::new(), String::new());
    loop {
        let asked = remote.request(ListDomainsRequest { page_size: PAGE, page_token });
        let page = remote.ask(client.list_domains(asked))?;
        for listed in page.domains {
            let manifest = manifest(remote, &listed.domain_id)?;
            found.push((listed, manifest));
        }
        page_token = page.next_page_token;
        if page_token.is_empty() {
            return Ok(found);
        }
    }
}

/// Returns a domain as it was registered or shipped.
///
/// # Errors
/// `Remote`; also when there is no such domain.
pub fn manifest(remote: &Remote, id: &str) -> Result<Domain, Error> {
    let get = GetDomainRequest { domain_id: id.to_owned(), include_manifest: true, ..Default::default() };
    document(remote.ask(client(remote).get_domain(remote.request(get)))?.manifest)
}

/// Registers the domain of a folder and returns it as the server keeps it.
///
/// # Errors
/// `Domain` with every problem of the folder; `Remote`.
pub fn register(remote: &Remote, folder: &Path) -> Result<Listed, Error> {
    let custom = Custom::read(folder)?;
    let unfit = |e: d3dgen_proto::convert::Error| Error::Remote(format!("{}: {e}", folder.display()));
    let asked = RegisterDomainRequest {
        manifest: Some(to_proto(custom.domain()).map_err(unfit)?),
        knowledge_base: Some(to_proto(custom.knowledge()).map_err(unfit)?),
        ..Default::default()
    };
    let answer = remote.ask(client(remote).register_domain(remote.request(asked)))?;
    answer.domain.ok_or_else(|| Error::Remote("the answer lacks the domain".into()))
}

/// Removes a registered domain.
///
/// # Errors
/// `Remote`; also when there is none.
pub fn remove(remote: &Remote, id: &str) -> Result<(), Error> {
    let asked = RemoveDomainRequest { domain_id: id.to_owned(), request_id: String::new() };
    remote.ask(client(remote).remove_domain(remote.request(asked))).map(drop)
}
