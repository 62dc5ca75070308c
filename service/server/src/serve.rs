//! A running server: listens, answers, works on jobs, and stops in order.

use std::future::Future;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::State;
use axum::routing::get;
use http::{HeaderName, HeaderValue, Method, StatusCode};
use tokio::net::TcpListener;
use tonic::service::Routes;
use tonic::transport::Server;
use tower_http::cors::{AllowOrigin, CorsLayer};

use crate::connection;
use crate::core::Core;
use crate::error::Error;
use crate::gate::{GateLayer, Rules};
use crate::jobs::Run;
use crate::pool::{self, Pool};
use crate::{grpc, health, page, pictures};

/// How often a client is asked whether it is still there, and how long it may take to say so.
const ALIVE: (Duration, Duration) = (Duration::from_secs(30), Duration::from_secs(20));
/// Streams of one connection at a time.
const STREAMS: u32 = 256;
/// How often the end of running jobs is looked for while the server stops.
const POLL: Duration = Duration::from_millis(20);
/// Time between two looks for what is to be forgotten.
const HOUSEKEEPING: Duration = Duration::from_secs(3600);
/// Threads that wait for the disk or for work, beside those of the pool.
const MORE_THREADS: usize = 16;
/// Headers of answers that web pages may read.
const EXPOSED: [&str; 5] = ["grpc-status", "grpc-message", "grpc-status-details-bin", "x-request-id", "retry-after"];

/// Returns the runtime for a server of so many threads.
///
/// # Errors
/// `Transport` when the system gives no threads.
pub fn runtime(core: &Core) -> Result<tokio::runtime::Runtime, Error> {
    let threads = core.config.limits.threads;
    tokio::runtime::Builder::new_multi_thread()
        .worker_threads(threads.clamp(2, 8))
        .max_blocking_threads(Pool::threads_for(threads) + core.config.jobs.workers + MORE_THREADS)
        .enable_all()
        .build()
        .map_err(|e| Error::Transport(e.to_string()))
}

/// Serves until `stop` is done: then takes no new calls, waits for those under way and for jobs to reach what they can go
/// on from, at most as long as the configuration says. `ready` hears the address once calls are answered.
///
/// # Errors
/// `Listen`, `Tls`, `Transport`.
pub async fn serve(
    core: Arc<Core>,
    ready: impl FnOnce(std::net::SocketAddr),
    stop: impl Future<Output = ()>,
) -> Result<(), Error> {
    let config = &core.config;
    let failed = |source| Error::Listen { address: config.listen.to_string(), source };
    let tls = config.tls.as_ref().map(connection::acceptor).transpose()?;
    let listener = TcpListener::bind(config.listen).await.map_err(failed)?;
    let address = listener.local_addr().map_err(failed)?;
    let (health_reporter, health) = tonic_health::server::health_reporter();
    let (stopping, stops) = tokio::sync::watch::channel(false);
    let rules = Rules::new(config, Arc::clone(&core.metrics), core.clock.now_ms(), stops.clone());
    let routes = router(&core, rules, health)?;
    let connections = (config.limits.connections, config.limits.connections_per_address);
    let incoming = connection::accept(listener, tls, connections, Arc::clone(&core.metrics));
    open_indexes(&core);
    health::look(&core, &health_reporter).await;
    let watching = pool::spawn(health::watch(Arc::clone(&core), health_reporter.clone()));
    let housekeeping = pool::spawn(keep_house(Arc::clone(&core)));
    for _ in 0..config.jobs.workers {
        tokio::spawn(Run::work(Arc::clone(&core)));
    }
    let server = Server::builder()
        .accept_http1(true)
        .http2_keepalive_interval(Some(ALIVE.0))
        .http2_keepalive_timeout(Some(ALIVE.1))
        .max_concurrent_streams(Some(STREAMS))
        .add_routes(Routes::from(routes))
        .serve_with_incoming_shutdown(incoming, async move {
            let mut stops = stops;
            let _ = stops.wait_for(|stops| *stops).await;
        });
    let mut server = std::pin::pin!(server);
    ready(address);
    tracing::info!(%address, tls = config.tls.is_some(), tokens = config.tokens.len(), "serving");
    tokio::select! {
        ended = &mut server => return ended.map_err(|e| Error::Transport(e.to_string())),
        () = stop => {}
    }
    tracing::info!("stopping");
    drop((watching, housekeeping));
    health::report_stop(&health_reporter).await;
    core.jobs.stop();
    stopping.send_replace(true);
    let drained = async {
        let ended = server.await;
        while core.jobs.running() > 0 {
            tokio::time::sleep(POLL).await;
        }
        ended
    };
    match tokio::time::timeout(config.drain, drained).await {
        Ok(ended) => ended.map_err(|e| Error::Transport(e.to_string()))?,
        Err(_) => tracing::warn!("calls or jobs were cut short: they took longer than drain_s"),
    }
    tracing::info!("stopped");
    Ok(())
}

/// Forgets, now and then, what is kept for a while only.
async fn keep_house(core: Arc<Core>) {
    loop {
        let asked = Arc::clone(&core);
        match tokio::task::spawn_blocking(move || grpc::forget_old(&asked)).await {
            Ok(Ok(0)) | Err(_) => {}
            Ok(Ok(count)) => tracing::info!(count, "old answers forgotten"),
            Ok(Err(error)) => tracing::error!(reason = %error, "old answers cannot be forgotten"),
        }
        tokio::time::sleep(HOUSEKEEPING).await;
    }
}

/// Opens the indexes beside the first answers; searches wait for them.
fn open_indexes(core: &Arc<Core>) {
    let core = Arc::clone(core);
    drop(tokio::task::spawn_blocking(move || {
        if let Err(error) = core.open_indexes() {
            tracing::error!(reason = %error, "the indexes cannot be made: searches are not answered");
        }
    }));
}

/// Returns everything that is answered: gRPC and gRPC-Web behind the gate, and plain pages beside them.
fn router(
    core: &Arc<Core>,
    rules: Arc<Rules>,
    health: tonic_health::pb::health_server::HealthServer<impl tonic_health::pb::health_server::Health>,
) -> Result<Router, Error> {
    let gate = GateLayer(rules);
    let reflection = || {
        tonic_reflection::server::Builder::configure()
            .register_encoded_file_descriptor_set(d3dgen_proto::FILE_DESCRIPTOR_SET)
            .register_encoded_file_descriptor_set(tonic_health::pb::FILE_DESCRIPTOR_SET)
    };
    let failed = |e: tonic_reflection::server::Error| Error::Transport(e.to_string());
    // older clients, such as grpcurl 1.8, ask for v1alpha only
    let alpha = reflection().build_v1alpha().map_err(failed)?;
    let reflection = reflection().build_v1().map_err(failed)?;
    let grpc = grpc::routes(core)
        .add_service(health)
        .add_service(reflection)
        .add_service(alpha)
        .into_axum_router()
        .layer(gate.clone())
        .layer(tonic_web::GrpcWebLayer::new());
    let pages = Router::new()
        .route("/healthz", get(|| async { "ok\n" }))
        .route("/livez", get(livez))
        .route("/readyz", get(readyz))
        .route("/metrics", get(metrics))
        .merge(pictures::router())
        .merge(page::router())
        .with_state(Arc::clone(core))
        .layer(gate);
    let all = pages.fallback_service(grpc);
    if core.config.cors_origins.is_empty() {
        return Ok(all);
    }
    let origins: Vec<HeaderValue> =
        core.config.cors_origins.iter().filter_map(|o| HeaderValue::from_str(o).ok()).collect();
    let cors = CorsLayer::new()
        .allow_origin(AllowOrigin::list(origins))
        .allow_methods([Method::POST, Method::GET])
        .allow_headers(tower_http::cors::AllowHeaders::mirror_request())
        .expose_headers(EXPOSED.map(HeaderName::from_static))
        .max_age(Duration::from_secs(3600));
    Ok(all.layer(cors))
}

async fn metrics(State(core): State<Arc<Core>>) -> ([(HeaderName, &'static str); 1], String) {
    ([(http::header::CONTENT_TYPE, "text/plain; version=0.0.4")], core.metrics.text())
}

/// Returns what is well, with a status that has an orchestrator start the process anew when nothing else helps.
async fn livez(State(core): State<Arc<Core>>) -> (StatusCode, String) {
    let health = core.health.load();
    (if health.is_live() { StatusCode::OK } else { StatusCode::SERVICE_UNAVAILABLE }, health.text())
}

/// Returns what is well, with a status that has an orchestrator send calls elsewhere while not all are answered.
async fn readyz(State(core): State<Arc<Core>>) -> (StatusCode, String) {
    let health = core.health.load();
    (if health.is_ready() { StatusCode::OK } else { StatusCode::SERVICE_UNAVAILABLE }, health.text())
}
