//! The services as tools ask for them, by both versions of gRPC's reflection: grpcurl 1.8 knows the first only.

use d3dgen_proto::v1::{GetServerInfoRequest, server_service_client::ServerServiceClient};

use crate::support::Server;

/// Asks by a version of reflection for the services, and for the file of one of them; returns names and files.
macro_rules! reflected {
    ($version:ident, $server:expr) => {{
        use tonic_reflection::pb::$version::ServerReflectionRequest;
        use tonic_reflection::pb::$version::server_reflection_client::ServerReflectionClient;
        use tonic_reflection::pb::$version::server_reflection_request::MessageRequest;
        use tonic_reflection::pb::$version::server_reflection_response::MessageResponse;
        let ask = |request| ServerReflectionRequest { host: String::new(), message_request: Some(request) };
        let asked = [
            ask(MessageRequest::ListServices(String::new())),
            ask(MessageRequest::FileContainingSymbol("d3dgen.v1.WorldService".into())),
        ];
        let mut client = ServerReflectionClient::new($server.channel().await);
        let answers = client.server_reflection_info(tokio_stream::iter(asked)).await.expect("answered");
        let mut answers = answers.into_inner();
        let (mut names, mut files) = (Vec::new(), 0);
        while let Some(answer) = answers.message().await.expect("an answer") {
            match answer.message_response {
                Some(MessageResponse::ListServicesResponse(list)) => {
                    names.extend(list.service.into_iter().map(|s| s.name));
                }
                Some(MessageResponse::FileDescriptorResponse(found)) => files += found.file_descriptor_proto.len(),
                other => panic!("{other:?}"),
            }
        }
        names.sort();
        (names, files)
    }};
}

#[tokio::test(flavor = "multi_thread")]
async fn both_versions_of_reflection_tell_the_same() {
    let server = Server::start(&[]).await;
    let (names, files) = reflected!(v1, server);
    let (alpha, alpha_files) = reflected!(v1alpha, server);
    assert!(files > 0 && files == alpha_files, "{files} and {alpha_files} files");
    assert!(names.iter().any(|n| n == "d3dgen.v1.WorldService"), "{names:?}");
    let ours = |names: &[String]| names.iter().filter(|n| n.starts_with("d3dgen.")).cloned().collect::<Vec<_>>();
    assert_eq!(ours(&names), ours(&alpha));
    let info = ServerServiceClient::new(server.channel().await).get_server_info(GetServerInfoRequest {}).await;
    assert!(!info.expect("an answer").into_inner().languages.is_empty());
}
