//! The answer of a call on its way out: watched for its end, its status and its deadline.

use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Instant;

use axum::body::{Body, Bytes};
use http::HeaderMap;
use http_body::Frame;
use tokio::time::Sleep;
use tonic::{Code, Status};

use super::Place;
use crate::metrics::Metrics;
use crate::status;

/// A call under way; counted and logged when it is dropped.
pub(super) struct Call {
    pub metrics: Arc<Metrics>,
    pub method: String,
    pub id: String,
    pub client: String,
    pub peer: String,
    pub begun: Instant,
    /// How it ended; none while it has not.
    pub code: Option<Code>,
    pub place: Option<Place>,
}

impl Drop for Call {
    fn drop(&mut self) {
        // An answer that nobody waited for to its end was given up by the client.
        let code = self.code.unwrap_or(Code::Cancelled);
        let (time, name) = (self.begun.elapsed(), status::code_name(code));
        self.metrics.count(&self.method, name, time);
        let ms = time.as_secs_f64() * 1000.0;
        let (id, method, client, peer) = (&self.id, &self.method, &self.client, &self.peer);
        match code {
            Code::Internal | Code::Unknown | Code::DataLoss => {
                tracing::error!(request_id = %id, %method, status = name, ms, %client, %peer, "call");
            }
            _ => tracing::info!(request_id = %id, %method, status = name, ms, %client, %peer, "call"),
        }
    }
}

/// The body of an answer, with its call.
pub(super) struct Watched {
    inner: Body,
    call: Call,
    late: Pin<Box<Sleep>>,
    ended: bool,
}

impl Watched {
    pub(super) fn new(inner: Body, call: Call, until: tokio::time::Instant) -> Self {
        Self { inner, call, late: Box::pin(tokio::time::sleep_until(until)), ended: false }
    }
}

/// Returns the status that headers or trailers tell.
pub(super) fn code(headers: &HeaderMap) -> Option<Code> {
    Status::from_header_map(headers).map(|s| s.code())
}

impl http_body::Body for Watched {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        if self.ended {
            return Poll::Ready(None);
        }
        if self.late.as_mut().poll(context).is_ready() {
            self.ended = true;
            self.call.code = Some(Code::DeadlineExceeded);
            self.inner = Body::empty(); // what makes the answer hears of it
            let mut trailers = HeaderMap::new();
            let said = Status::deadline_exceeded("the stream took longer than it may");
            return Poll::Ready(said.add_header(&mut trailers).ok().map(|()| Ok(Frame::trailers(trailers))));
        }
        let frame = Pin::new(&mut self.inner).poll_frame(context);
        match &frame {
            Poll::Ready(Some(Ok(frame))) => {
                if let Some(found) = frame.trailers_ref().and_then(code) {
                    self.call.code = Some(found);
                }
            }
            Poll::Ready(None) => self.ended = true,
            _ => {}
        }
        frame
    }

    fn is_end_stream(&self) -> bool {
        self.ended || self.inner.is_end_stream()
    }

    fn size_hint(&self) -> http_body::SizeHint {
        self.inner.size_hint()
    }
}
