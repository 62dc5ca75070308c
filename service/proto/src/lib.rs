//! The gRPC contract of `proto/d3dgen/v1` in Rust: messages, clients and servers, all generated.
//!
//! What it is not for: answering calls (`server`) and checking documents (`model`).

pub mod bounds;
pub mod codec;
pub mod convert;

/// Messages, clients (`*_client`) and servers (`*_server`) of package `d3dgen.v1`; the comments are in `proto/`.
#[allow(missing_docs, unused_qualifications, clippy::all)]
pub mod v1 {
    tonic::include_proto!("d3dgen.v1");
}

/// The encoded `google.protobuf.FileDescriptorSet` of the contract, for server reflection.
pub const FILE_DESCRIPTOR_SET: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/descriptors.bin"));
