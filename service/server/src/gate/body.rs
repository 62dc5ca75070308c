//! The answer of a call on its way out: watched for its end, its status and its deadline.

use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker};
use std::time::Instant;

use axum::body::{Body, Bytes};
use http::HeaderMap;
use http_body::Frame;
use tokio::sync::watch;
use tokio::task::AbortHandle;
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
///
/// A timer of its own ends both at the deadline. A client that takes nothing has the transport ask for nothing, so what
/// makes the answer would otherwise go on for as long as the connection lives.
pub(super) struct Watched {
    shared: Arc<Mutex<Shared>>,
    timer: AbortHandle,
}

struct Shared {
    state: State,
    /// Who asked last and was told to wait.
    waker: Option<Waker>,
}

enum State {
    Open(Body, Call),
    /// Cut short; the client is told why when it asks.
    Cut(Status),
    Ended,
}

/// When an answer is cut short, whether it is taken or not.
pub(super) struct Until {
    /// At its deadline.
    pub deadline: tokio::time::Instant,
    /// When the server stops; none for answers that come to an end by themselves.
    pub stop: Option<watch::Receiver<bool>>,
}

impl Watched {
    pub(super) fn new(inner: Body, call: Call, until: Until) -> Self {
        let shared = Arc::new(Mutex::new(Shared { state: State::Open(inner, call), waker: None }));
        let held = Arc::downgrade(&shared);
        let timer = tokio::spawn(async move {
            let status = until.cause().await;
            if let Some(shared) = held.upgrade() {
                cut(&shared, status);
            }
        });
        Self { shared, timer: timer.abort_handle() }
    }
}

impl Until {
    /// Waits until the answer is to be cut short, and returns what to say.
    async fn cause(self) -> Status {
        let stopping = async {
            if let Some(mut stop) = self.stop
                && stop.wait_for(|stops| *stops).await.is_ok()
            {
                return;
            }
            std::future::pending().await
        };
        tokio::select! {
            () = tokio::time::sleep_until(self.deadline) => Status::deadline_exceeded("the stream took longer than it may"),
            () = stopping => Status::unavailable("the server stops; ask again when it is back"),
        }
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        self.timer.abort();
    }
}

fn locked(shared: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends the work of an answer and its call.
fn cut(shared: &Mutex<Shared>, status: Status) {
    let mut guard = locked(shared);
    if !matches!(guard.state, State::Open(..)) {
        return;
    }
    let code = status.code();
    let before = std::mem::replace(&mut guard.state, State::Cut(status));
    let waker = guard.waker.take();
    drop(guard);
    if let State::Open(body, mut call) = before {
        call.code = Some(code);
        drop(body); // what makes the answer hears of it
    }
    if let Some(waker) = waker {
        waker.wake();
    }
}

/// Notes how a call ended, when this is the end, and gives a refusal its reason.
fn ended_with(frame: Frame<Bytes>, call: &mut Call) -> Frame<Bytes> {
    let trailers = match frame.into_trailers() {
        Ok(trailers) => trailers,
        Err(other) => return other,
    };
    let Some(status) = Status::from_header_map(&trailers) else { return Frame::trailers(trailers) };
    call.code = Some(status.code());
    let mut explained = HeaderMap::new();
    match status.code() != Code::Ok && status::explained(status).add_header(&mut explained).is_ok() {
        true => Frame::trailers(explained),
        false => Frame::trailers(trailers),
    }
}

/// Returns the status that headers or trailers tell.
pub(super) fn code(headers: &HeaderMap) -> Option<Code> {
    Status::from_header_map(headers).map(|s| s.code())
}

impl http_body::Body for Watched {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        let mut shared = locked(&self.shared);
        let frame = match &mut shared.state {
            State::Ended => return Poll::Ready(None),
            State::Cut(status) => {
                let mut trailers = HeaderMap::new();
                let told = status::explained(status.clone()).add_header(&mut trailers);
                shared.state = State::Ended;
                return Poll::Ready(told.ok().map(|()| Ok(Frame::trailers(trailers))));
            }
            State::Open(inner, call) => {
                let frame = Pin::new(inner).poll_frame(context);
                frame.map(|frame| frame.map(|frame| frame.map(|frame| ended_with(frame, call))))
            }
        };
        match &frame {
            Poll::Ready(None) => {
                let ended = std::mem::replace(&mut shared.state, State::Ended);
                drop(shared);
                drop(ended);
            }
            Poll::Ready(_) => {}
            Poll::Pending => shared.waker = Some(context.waker().clone()),
        }
        frame
    }

    fn is_end_stream(&self) -> bool {
        match &locked(&self.shared).state {
            State::Open(inner, _) => inner.is_end_stream(),
            State::Cut(_) => false,
            State::Ended => true,
        }
    }

    fn size_hint(&self) -> http_body::SizeHint {
        match &locked(&self.shared).state {
            State::Open(inner, _) => inner.size_hint(),
            _ => http_body::SizeHint::default(),
        }
    }
}
