//! What every call passes: who it is, whether they may, how much at once and how long, a request id, a line in the log.
//!
//! What it is not for: knowing what a call does. It lies inside of gRPC-Web, so that its refusals reach browsers too.

mod body;
mod origin;
mod rate;

use std::collections::HashMap;
use std::convert::Infallible;
use std::future::Future;
use std::pin::Pin;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};

use axum::body::Body;
use http::{HeaderMap, HeaderValue, Request, Response, Uri};
use tokio::sync::watch;
use tonic::{Code, Status};
use tower::{Layer, Service};

use crate::access::{Access, Caller, Scope};
use crate::config::{Config, Limits};
use crate::connection::Peer;
use crate::methods::{Kind, Methods};
use crate::metrics::Metrics;
use crate::pool::{self, Asked};
use crate::status;
use body::{Call, Until, Watched};
use origin::Origins;
use rate::Rates;

/// Header of the id that a client or the server gives a call.
const REQUEST_ID: &str = "x-request-id";
/// Longest id of a client that is taken over.
const REQUEST_ID_LIMIT: usize = 64;
/// When to come back after too many calls at once.
const RETRY: Duration = Duration::from_millis(250);

/// What all calls share.
#[derive(Debug)]
pub struct Rules {
    access: Access,
    origins: Origins,
    methods: Methods,
    limits: Limits,
    metrics: Arc<Metrics>,
    rates: Rates,
    in_flight: Mutex<InFlight>,
    ids: AtomicU64,
    /// First part of request ids: another one each start.
    start: u64,
    /// True once the server stops.
    stop: watch::Receiver<bool>,
}

/// Calls under way.
#[derive(Debug, Default)]
struct InFlight {
    all: usize,
    by_client: HashMap<String, usize>,
}

impl Rules {
    /// Returns the rules of a server; `start` tells its request ids from those of its last run, `stop` becomes true when it
    /// stops: what would go on for as long as its client wants ends then.
    pub fn new(config: &Config, metrics: Arc<Metrics>, start: u64, stop: watch::Receiver<bool>) -> Arc<Self> {
        let limits = config.limits.clone();
        Arc::new(Self {
            access: Access::new(config.tokens.clone()),
            origins: Origins::new(config),
            methods: Methods::shipped(),
            rates: Rates::new(limits.rate_per_s, limits.burst),
            limits,
            metrics,
            in_flight: Mutex::default(),
            ids: AtomicU64::new(0),
            start,
            stop,
        })
    }

    /// Returns the id of a call: the client's own where it is plain, else a new one.
    fn id(&self, headers: &HeaderMap) -> String {
        let given = headers.get(REQUEST_ID).and_then(|v| v.to_str().ok());
        let plain = |id: &&str| {
            (1..=REQUEST_ID_LIMIT).contains(&id.len())
                && id.bytes().all(|b| b.is_ascii_alphanumeric() || b"-_.".contains(&b))
        };
        match given.filter(plain) {
            Some(id) => id.to_owned(),
            None => format!("{:x}-{:x}", self.start, self.ids.fetch_add(1, Ordering::Relaxed)),
        }
    }

    /// Returns who calls, when they may.
    fn admit(&self, uri: &Uri, headers: &HeaderMap, peer: &str, spare: bool) -> Result<Caller, (Status, String)> {
        let need = self.methods.need(uri.path());
        self.origins.check(uri, headers).map_err(|refused| (refused, peer.to_owned()))?;
        let authorization = headers.get(http::header::AUTHORIZATION).map(HeaderValue::as_bytes);
        let caller = self.access.caller(authorization, peer);
        let Some(least) = need.scope else {
            // Health answers everybody.
            return Ok(caller.unwrap_or(Caller { name: peer.to_owned(), scope: Scope::Read }));
        };
        if spare {
            let message = "there are as many connections as the server takes, from this address or in all";
            return Err((status::exhausted(message, RETRY), peer.to_owned()));
        }
        let Some(caller) = caller else {
            // Guessing is bounded as any other call is, by address.
            let refused = match self.rates.take(&format!("without a token: {peer}")) {
                Ok(()) => {
                    let message = "the token is missing or wrong: send `authorization: Bearer TOKEN`";
                    status::because(status::reason::TOKEN, &Status::unauthenticated(message))
                }
                Err(wait) => status::exhausted("too many calls without a token", wait),
            };
            return Err((refused, peer.to_owned()));
        };
        if caller.scope < least {
            let message =
                format!("token `{}` has scope {}, this call needs {}", caller.name, caller.scope.name(), least.name());
            let refused = status::because(status::reason::SCOPE, &Status::permission_denied(message));
            return Err((refused, caller.name));
        }
        match self.rates.take(&caller.name) {
            Ok(()) => Ok(caller),
            Err(wait) => Err((status::exhausted("too many calls in a second", wait), caller.name)),
        }
    }

    fn begin(self: &Arc<Self>, caller: &str) -> Result<Place, Status> {
        let mut in_flight = self.in_flight.lock().unwrap_or_else(PoisonError::into_inner);
        let own = in_flight.by_client.get(caller).copied().unwrap_or_default();
        if own >= self.limits.calls_per_client {
            let message = format!("{own} calls of this client are under way, the limit");
            return Err(status::exhausted(&message, RETRY));
        }
        if in_flight.all >= self.limits.calls {
            return Err(status::exhausted("the server has as many calls as it takes", RETRY));
        }
        in_flight.all += 1;
        *in_flight.by_client.entry(caller.to_owned()).or_default() += 1;
        self.metrics.in_flight.fetch_add(1, Ordering::Relaxed);
        Ok(Place { rules: Arc::clone(self), client: caller.to_owned() })
    }
}

/// A call's place among those under way, given back when it is dropped.
#[derive(Debug)]
struct Place {
    rules: Arc<Rules>,
    client: String,
}

impl Drop for Place {
    fn drop(&mut self) {
        self.rules.metrics.in_flight.fetch_sub(1, Ordering::Relaxed);
        let mut in_flight = self.rules.in_flight.lock().unwrap_or_else(PoisonError::into_inner);
        in_flight.all -= 1;
        if let Some(own) = in_flight.by_client.get_mut(&self.client) {
            *own -= 1;
            if *own == 0 {
                in_flight.by_client.remove(&self.client);
            }
        }
    }
}

/// Puts the gate before a service.
#[derive(Debug, Clone)]
pub struct GateLayer(pub Arc<Rules>);

impl<S> Layer<S> for GateLayer {
    type Service = Gate<S>;

    fn layer(&self, inner: S) -> Gate<S> {
        Gate { rules: Arc::clone(&self.0), inner }
    }
}

/// A service behind the gate.
#[derive(Debug, Clone)]
pub struct Gate<S> {
    rules: Arc<Rules>,
    inner: S,
}

impl<S, B> Service<Request<B>> for Gate<S>
where
    S: Service<Request<B>, Response = Response<Body>, Error = Infallible> + Clone + Send + 'static,
    S::Future: Send + 'static,
    B: Send + 'static,
{
    type Response = Response<Body>;
    type Error = Infallible;
    type Future = Pin<Box<dyn Future<Output = Result<Response<Body>, Infallible>> + Send>>;

    fn poll_ready(&mut self, context: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
        self.inner.poll_ready(context)
    }

    fn call(&mut self, mut request: Request<B>) -> Self::Future {
        let begun = Instant::now();
        let rules = Arc::clone(&self.rules);
        let path = request.uri().path().to_owned();
        let is_grpc = is_grpc(request.headers());
        let id = rules.id(request.headers());
        let from = request.extensions().get::<Peer>().copied();
        let peer = from.map_or_else(|| "unknown".to_owned(), |p| p.address.ip().to_string());
        let mut call = Call {
            metrics: Arc::clone(&rules.metrics),
            method: rules.methods.label(&path).to_owned(),
            id: id.clone(),
            client: peer.clone(),
            peer: peer.clone(),
            begun,
            code: None,
            place: None,
        };
        let need = rules.methods.need(&path);
        let spare = from.is_some_and(|p| p.spare);
        let admitted = rules.admit(request.uri(), request.headers(), &peer, spare).map_err(|(status, client)| {
            call.client = client;
            status
        });
        let admitted = admitted.and_then(|caller| {
            call.client.clone_from(&caller.name);
            // health has a place whatever else goes on
            if need.scope.is_some() {
                call.place = Some(rules.begin(&caller.name)?);
            }
            Ok(caller)
        });
        let caller = match admitted {
            Ok(caller) => caller,
            Err(status) => return Box::pin(async move { Ok(refusal(status, is_grpc, call)) }),
        };
        let kind = need.kind;
        let longest = kind.limit(&rules.limits);
        let time = asked_time(request.headers()).map_or(longest, |t| t.min(longest));
        let asked = Asked { method: call.method.as_str().into(), id: id.as_str().into(), until: begun + time };
        request.extensions_mut().insert(caller);
        request.extensions_mut().insert(RequestId(id));
        request.extensions_mut().insert(kind);
        // The clone takes the place of the service that is ready, which is used up.
        let ready = self.inner.clone();
        let mut inner = std::mem::replace(&mut self.inner, ready);
        Box::pin(async move {
            let deadline = tokio::time::Instant::from_std(begun + time);
            let answer = pool::asked(asked, inner.call(request));
            match tokio::time::timeout_at(deadline, answer).await {
                Ok(Ok(response)) => {
                    let stop = (kind == Kind::Stream).then(|| rules.stop.clone());
                    Ok(watched(response, is_grpc, call, Until { deadline, stop }))
                }
                Ok(Err(never)) => match never {},
                Err(_) => Ok(refusal(late(time), is_grpc, call)),
            }
        })
    }
}

/// Id of a call, for handlers that write logs of their own.
#[derive(Debug, Clone)]
pub struct RequestId(pub String);

fn late(time: Duration) -> Status {
    Status::deadline_exceeded(format!("the call took longer than {:.3} s", time.as_secs_f64()))
}

fn is_grpc(headers: &HeaderMap) -> bool {
    let kind = headers.get(http::header::CONTENT_TYPE).map(HeaderValue::as_bytes);
    kind.is_some_and(|k| k.starts_with(b"application/grpc"))
}

/// Returns the time that the client gives the call: up to eight digits and a unit.
fn asked_time(headers: &HeaderMap) -> Option<Duration> {
    let text = headers.get("grpc-timeout")?.to_str().ok()?;
    let (digits, unit) = text.split_at_checked(text.len().checked_sub(1)?)?;
    if digits.is_empty() || digits.len() > 8 || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let n: u64 = digits.parse().ok()?;
    match unit {
        "H" => Some(Duration::from_secs(n * 3600)),
        "M" => Some(Duration::from_secs(n * 60)),
        "S" => Some(Duration::from_secs(n)),
        "m" => Some(Duration::from_millis(n)),
        "u" => Some(Duration::from_micros(n)),
        "n" => Some(Duration::from_nanos(n)),
        _ => None,
    }
}

fn refusal(status: Status, is_grpc: bool, mut call: Call) -> Response<Body> {
    let status = status::explained(status);
    call.code = Some(status.code());
    let mut response = if is_grpc {
        status.into_http::<Body>()
    } else {
        let mut response = Response::new(Body::from(format!("{}\n", status.message())));
        *response.status_mut() = status::http(status.code());
        response
    };
    with_id(&mut response, &call.id);
    response
}

fn watched(response: Response<Body>, is_grpc: bool, mut call: Call, until: Until) -> Response<Body> {
    let refused = is_grpc.then(|| Status::from_header_map(response.headers())).flatten();
    let response = match refused.filter(|s| s.code() != Code::Ok) {
        Some(refused) => status::explained(status::of_transport(&refused).unwrap_or(refused)).into_http(),
        None => response,
    };
    // Answers without a body, and those that are no gRPC, say how they ended at once.
    call.code = body::code(response.headers()).or((!is_grpc).then_some(match response.status().as_u16() {
        200..400 => Code::Ok,
        404 => Code::NotFound,
        _ => Code::Unknown,
    }));
    let id = call.id.clone();
    let mut response = response.map(|inner| Body::new(Watched::new(inner, call, until)));
    with_id(&mut response, &id);
    response
}

fn with_id(response: &mut Response<Body>, id: &str) {
    if let Ok(value) = HeaderValue::from_str(id) {
        response.headers_mut().insert(REQUEST_ID, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn asked_times_are_read_as_the_protocol_says() {
        let with = |text: &str| {
            let mut headers = HeaderMap::new();
            headers.insert("grpc-timeout", HeaderValue::from_str(text).unwrap());
            asked_time(&headers)
        };
        assert_eq!(with("5S"), Some(Duration::from_secs(5)));
        assert_eq!(with("250m"), Some(Duration::from_millis(250)));
        assert_eq!(with("99999999H"), Some(Duration::from_secs(99_999_999 * 3600)));
        for wrong in ["", "S", "5", "5s", "-5S", "123456789S", "1.5S"] {
            assert_eq!(with(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn the_list_of_methods_is_read() {
        let methods = Methods::shipped();
        assert_eq!(methods.need("/healthz").scope, None);
        assert_eq!(methods.need("/d3dgen.v1.Nothing/Such").scope, Some(Scope::Admin));
        assert_eq!(methods.label("/d3dgen.v1.Nothing/Such"), "other");
    }
}
