//! Messages to bytes and back, as gRPC has them; what a client sends is held against the contract's bounds first.

use std::marker::PhantomData;

use prost::bytes::Buf;
use prost::{Message, Name};
use tonic::codec::{Codec, DecodeBuf, Decoder, EncodeBuf, Encoder};
use tonic::{Code, Status};
use tonic_types::{ErrorDetails, FieldViolation, StatusExt};

use crate::bounds::{self, Excess};

/// The codec of the contract's clients and servers.
#[derive(Debug, Clone)]
pub struct Bounded<T, U>(PhantomData<(T, U)>);

impl<T, U> Default for Bounded<T, U> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

impl<T, U> Codec for Bounded<T, U>
where
    T: Message + Send + 'static,
    U: Message + Name + Default + Send + 'static,
{
    type Encode = T;
    type Decode = U;
    type Encoder = Out<T>;
    type Decoder = In<U>;

    fn encoder(&mut self) -> Out<T> {
        Out(PhantomData)
    }

    fn decoder(&mut self) -> In<U> {
        In(PhantomData)
    }
}

/// Writes messages.
#[derive(Debug, Clone)]
pub struct Out<T>(PhantomData<T>);

impl<T: Message> Encoder for Out<T> {
    type Item = T;
    type Error = Status;

    fn encode(&mut self, item: T, buf: &mut EncodeBuf<'_>) -> Result<(), Status> {
        item.encode(buf).map_err(|e| Status::internal(format!("the message has no room: {e}")))
    }
}

/// Reads messages.
#[derive(Debug, Clone)]
pub struct In<U>(PhantomData<U>);

impl<U: Message + Name + Default> Decoder for In<U> {
    type Item = U;
    type Error = Status;

    fn decode(&mut self, buf: &mut DecodeBuf<'_>) -> Result<Option<U>, Status> {
        // one piece already: the transport gathers a message before it is read
        let bytes = buf.copy_to_bytes(buf.remaining());
        bounds::check(&U::full_name(), &bytes).map_err(refused)?;
        let message = U::decode(bytes);
        message.map(Some).map_err(|e| Status::internal(format!("failed to decode Protobuf message: {e}")))
    }
}

/// Returns the answer to what is too large.
fn refused(Excess { path, reason }: Excess) -> Status {
    if path.is_empty() {
        return Status::invalid_argument(format!("the message {reason}"));
    }
    let message = format!("{path}: {reason}");
    let details = ErrorDetails::with_bad_request(vec![FieldViolation::new(path, reason)]);
    Status::with_error_details(Code::InvalidArgument, message, details)
}
