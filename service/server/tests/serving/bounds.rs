//! Every text, list and bytes field that a client can send, far too large: refused at once, with its path.

use std::collections::{BTreeMap, BTreeSet};

use bytes::{Buf, BufMut, Bytes};
use d3dgen_proto::v1::admin_service_client::AdminServiceClient;
use d3dgen_proto::v1::amend_knowledge_request::Change;
use d3dgen_proto::v1::knowledge_service_client::KnowledgeServiceClient;
use d3dgen_proto::v1::server_service_client::ServerServiceClient;
use d3dgen_proto::v1::{
    AmendKnowledgeRequest, AnyOf, CreateBackupRequest, GetServerInfoRequest, RuleSentence, SearchConstraintsRequest,
};
use http::uri::PathAndQuery;
use prost::Message;
use prost::encoding::{WireType, encode_key, encode_varint};
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorSet};
use tonic::client::Grpc;
use tonic::codec::{Codec, DecodeBuf, Decoder, EncodeBuf, Encoder};
use tonic::{Code, Request, Status};
use tonic_types::StatusExt;

use crate::support::Server;

/// Bytes that are sent at least.
const LARGE: usize = 5 << 20;

/// Sends and takes bytes as they are.
#[derive(Clone, Copy)]
struct Raw;

impl Codec for Raw {
    type Encode = Bytes;
    type Decode = Bytes;
    type Encoder = Self;
    type Decoder = Self;

    fn encoder(&mut self) -> Self {
        Self
    }

    fn decoder(&mut self) -> Self {
        Self
    }
}

impl Encoder for Raw {
    type Item = Bytes;
    type Error = Status;

    fn encode(&mut self, item: Bytes, buf: &mut EncodeBuf<'_>) -> Result<(), Status> {
        buf.put(item);
        Ok(())
    }
}

impl Decoder for Raw {
    type Item = Bytes;
    type Error = Status;

    fn decode(&mut self, buf: &mut DecodeBuf<'_>) -> Result<Option<Bytes>, Status> {
        Ok(Some(buf.copy_to_bytes(buf.remaining())))
    }
}

/// A message with one field too large.
struct Case {
    method: String,
    path: String,
    message: Bytes,
}

struct Contract {
    messages: BTreeMap<String, DescriptorProto>,
    /// Fields that have their case.
    seen: BTreeSet<(String, String)>,
    cases: Vec<Case>,
}

impl Contract {
    fn keep(&mut self, above: &str, message: &DescriptorProto) {
        let name = format!("{above}.{}", message.name());
        message.nested_type.iter().for_each(|inner| self.keep(&name, inner));
        self.messages.insert(name, message.clone());
    }

    /// Adds a case for each field of a type, and of the types in it; `wrap` puts a message of the type into the request.
    fn walk(&mut self, method: &str, name: &str, above: &str, wrap: &dyn Fn(Vec<u8>) -> Vec<u8>) {
        let Some(message) = self.messages.get(name).cloned() else { panic!("{name} is not in the contract") };
        for field in &message.field {
            if !self.seen.insert((name.to_owned(), field.name().to_owned())) {
                continue;
            }
            let path = if above.is_empty() { field.name().to_owned() } else { format!("{above}.{}", field.name()) };
            let is_list = field.label() == Label::Repeated;
            if let Some(content) = too_large(name, field) {
                let content = wrap(content);
                self.cases.push(Case { method: method.to_owned(), path: path.clone(), message: content.into() });
            }
            if matches!(field.r#type(), Type::String | Type::Bytes) && is_list {
                let entry = delimited(field, &vec![b'x'; LARGE.max(bound(name, field) + 1)]);
                let path = format!("{path}[0]");
                self.cases.push(Case { method: method.to_owned(), path, message: wrap(entry).into() });
            }
            if field.r#type() == Type::Message {
                let path = if is_list { format!("{path}[0]") } else { path };
                let inner = field.type_name().trim_start_matches('.').to_owned();
                self.walk(method, &inner, &path, &|content| wrap(delimited(field, &content)));
            }
        }
    }
}

fn bound(message: &str, field: &FieldDescriptorProto) -> usize {
    d3dgen_proto::bounds::of(message).get(field.name()).copied().unwrap_or_default()
}

/// Returns a field with a content of its own length.
fn delimited(field: &FieldDescriptorProto, content: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(content.len() + 16);
    encode_key(u32::try_from(field.number()).expect("a number"), WireType::LengthDelimited, &mut bytes);
    encode_varint(content.len() as u64, &mut bytes);
    bytes.extend_from_slice(content);
    bytes
}

/// Returns a field of 5 MB, more where its bound is larger; none for a field that cannot be large.
fn too_large(message: &str, field: &FieldDescriptorProto) -> Option<Vec<u8>> {
    let most = bound(message, field);
    if field.label() != Label::Repeated {
        let is_text = matches!(field.r#type(), Type::String | Type::Bytes);
        return is_text.then(|| delimited(field, &vec![b'x'; LARGE.max(most + 1)]));
    }
    Some(match field.r#type() {
        Type::String | Type::Bytes | Type::Message => delimited(field, &[]).repeat((LARGE / 2).max(most + 1)),
        _ => delimited(field, &vec![0; LARGE.max(8 * (most + 1))]),
    })
}

#[tokio::test(flavor = "multi_thread")]
async fn no_field_takes_what_is_too_large() {
    let server = Server::start(&["limits.rate_per_s=1e6", "limits.burst=1e6"]).await;
    let set = FileDescriptorSet::decode(d3dgen_proto::FILE_DESCRIPTOR_SET).expect("the contract");
    let mut contract = Contract { messages: BTreeMap::new(), seen: BTreeSet::new(), cases: Vec::new() };
    for file in &set.file {
        file.message_type.iter().for_each(|message| contract.keep(file.package(), message));
    }
    for file in &set.file {
        for service in &file.service {
            for method in &service.method {
                let path = format!("/{}.{}/{}", file.package(), service.name(), method.name());
                contract.walk(&path, method.input_type().trim_start_matches('.'), "", &|content| content);
            }
        }
    }
    assert!(contract.cases.len() > 300, "{} cases", contract.cases.len());
    let mut client = Grpc::new(server.channel().await);
    for case in contract.cases {
        client.ready().await.expect("a connection");
        let path: PathAndQuery = case.method.parse().expect("a path");
        let asked = Request::new(tokio_stream::once(case.message));
        let refused = client.client_streaming(asked, path, Raw).await.expect_err(&case.path);
        assert_eq!(refused.code(), Code::InvalidArgument, "{} {}: {refused}", case.method, case.path);
        let fields = refused.get_details_bad_request().map(|b| b.field_violations).unwrap_or_default();
        let named = fields.first().map(|f| f.field.as_str());
        assert_eq!(named, Some(case.path.as_str()), "{}: {refused}", case.method);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_sentence_as_long_as_may_be_is_read_soon_and_holds_nobody_up() {
    let server = Server::start(&[]).await;
    let mut knowledge = KnowledgeServiceClient::new(server.channel().await);
    let sentence = "Corridors are at least 2.6 m wide. ";
    let text = sentence.repeat(2_000 / sentence.len());
    let asked = |validate_only| AmendKnowledgeRequest {
        domain_id: "hospital".into(),
        change: Some(Change::Sentence(RuleSentence { text: text.clone(), language: None })),
        validate_only,
        ..Default::default()
    };
    // nobody's turn is waited for when nothing is changed
    let turn = server.core.turn().await;
    let begun = std::time::Instant::now();
    let planned = knowledge.amend_knowledge(asked(true)).await.expect("planned").into_inner();
    assert!(!planned.edits.is_empty() && planned.change.is_none());
    let time = begun.elapsed();
    assert!(time < std::time::Duration::from_secs(3), "{time:?} for {} bytes, unoptimized", text.len());
    drop(turn);
    let made = knowledge.amend_knowledge(asked(false)).await.expect("made").into_inner();
    assert_eq!(made.edits.len(), planned.edits.len());
    // searches know of it when the call returns
    let filters = [("jurisdiction".to_owned(), AnyOf { values: vec!["LOCAL".into()] })].into();
    let asked = SearchConstraintsRequest { query: "width of corridors".into(), filters, ..Default::default() };
    let found = knowledge.search_constraints(asked).await.expect("found").into_inner().constraints;
    let ids: Vec<_> = found.into_iter().filter_map(|f| f.constraint).map(|c| c.constraint_id).collect();
    assert!(ids.iter().any(|id| id.starts_with("hospital_local_")), "{ids:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_says_what_it_is_and_why_it_refuses() {
    let server = Server::start(&["jobs.batch_worlds=7"]).await;
    let mut info = ServerServiceClient::new(server.channel().await);
    let info = info.get_server_info(GetServerInfoRequest {}).await.expect("told").into_inner();
    assert_eq!(info.version, env!("CARGO_PKG_VERSION"));
    assert!(info.languages.iter().any(|l| l == "de") && info.languages.iter().any(|l| l == "zh"), "{info:?}");
    assert_eq!(info.scopes, ["read", "write", "admin"], "without tokens everybody on loopback may do everything");
    let limits = info.limits.expect("limits");
    assert_eq!((limits.batch_worlds, limits.prompt_bytes), (7, 10_000));

    let limited = Server::start(&["limits.burst=1", "limits.rate_per_s=0.001"]).await;
    let mut admin = AdminServiceClient::new(limited.channel().await);
    admin.create_backup(CreateBackupRequest {}).await.expect("the first");
    let refused = admin.create_backup(CreateBackupRequest {}).await.expect_err("too soon");
    let reason = refused.get_details_error_info().expect("a reason");
    assert_eq!((reason.reason.as_str(), reason.domain.as_str()), ("TOO_MUCH_AT_ONCE", "d3dgen"));
}
