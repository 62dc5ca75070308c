//! The services of the contract, one file each, over one [`Core`].
//!
//! A handler reads its request, hands the work to a thread of the pool, and answers with messages. What is wrong with a
//! request is said with its field ([`crate::status`]).

mod admin;
pub(crate) mod asset;
pub(crate) mod domain;
mod job;
mod knowledge;
mod library;
mod once;
mod outbox;
mod page;
mod server;
pub(crate) mod world;
mod zip;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use d3dgen_proto::v1;
use prost::Message;
use tonic::service::Routes;
use tonic::{Request, Response, Status};

use crate::access::{Caller, Scope};
use crate::core::Core;
use crate::pool::Lane;
use once::Once;

pub use once::forget_old;

/// Names of the services.
pub const NAMES: [&str; 8] = [
    "d3dgen.v1.DomainService",
    "d3dgen.v1.KnowledgeService",
    "d3dgen.v1.AssetService",
    "d3dgen.v1.WorldService",
    "d3dgen.v1.LibraryService",
    "d3dgen.v1.JobService",
    "d3dgen.v1.AdminService",
    "d3dgen.v1.ServerService",
];

/// Returns the services.
pub fn routes(core: &Arc<Core>) -> Routes {
    let api = Api { core: Arc::clone(core) };
    let limit = core.config.limits.message_bytes;
    macro_rules! service {
        ($module:ident, $server:ident) => {
            v1::$module::$server::new(api.clone()).max_decoding_message_size(limit)
        };
    }
    Routes::new(service!(domain_service_server, DomainServiceServer))
        .add_service(service!(knowledge_service_server, KnowledgeServiceServer))
        .add_service(service!(asset_service_server, AssetServiceServer))
        .add_service(service!(world_service_server, WorldServiceServer))
        .add_service(service!(library_service_server, LibraryServiceServer))
        .add_service(service!(job_service_server, JobServiceServer))
        .add_service(service!(admin_service_server, AdminServiceServer))
        .add_service(service!(server_service_server, ServerServiceServer))
}

/// All services.
#[derive(Clone)]
pub struct Api {
    core: Arc<Core>,
}

type Answer<T> = Result<Response<T>, Status>;

impl Api {
    /// Looks something up on a thread.
    async fn lookup<T: Send + 'static>(
        &self,
        look: impl FnOnce(&Core) -> Result<T, Status> + Send + 'static,
    ) -> Answer<T> {
        let core = Arc::clone(&self.core);
        self.core.pool.run(Lane::Lookup, move |_| look(&core)).await.map(Response::new)
    }

    /// Makes something on a thread, with a flag that tells when nobody waits for it any more.
    async fn work<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Core, &AtomicBool) -> Result<T, Status> + Send + 'static,
    ) -> Answer<T> {
        self.on(Lane::Work, work).await
    }

    /// Does as [`Api::work`] what takes tens of milliseconds, beside the calls that take longer.
    async fn short<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Core, &AtomicBool) -> Result<T, Status> + Send + 'static,
    ) -> Answer<T> {
        self.on(Lane::Short, work).await
    }

    async fn on<T: Send + 'static>(
        &self,
        lane: Lane,
        work: impl FnOnce(&Core, &AtomicBool) -> Result<T, Status> + Send + 'static,
    ) -> Answer<T> {
        let core = Arc::clone(&self.core);
        self.core.pool.run(lane, move |stop| work(&core, stop)).await.map(Response::new)
    }

    /// Changes something, alone, and once for each request id of a client.
    ///
    /// A call waits for its turn without a thread, and leaves the queue when it is given up. Once begun, the change goes on
    /// when the client goes away: half of one is not possible, and the answer is kept for a repeat.
    async fn change<Q, T>(
        &self,
        method: &'static str,
        request: Request<Q>,
        id: String,
        change: impl FnOnce(&Core, Q, &Once) -> Result<T, Status> + Send + 'static,
    ) -> Answer<T>
    where
        Q: Message + Send + 'static,
        T: Message + Default + Send + 'static,
    {
        self.change_read((method, Lane::Short), request, Some(id), |_, asked, _| Ok(asked), change).await
    }

    /// Does as [`Api::change`] with what `read` makes of the request first: on a thread of its lane, beside the changes of
    /// others, and with a flag that tells when nobody waits for it any more. Without an id nothing is to be changed, so that
    /// nobody's turn is waited for.
    async fn change_read<Q, P, T>(
        &self,
        (method, lane): (&'static str, Lane),
        request: Request<Q>,
        id: Option<String>,
        read: impl FnOnce(&Core, Q, &AtomicBool) -> Result<P, Status> + Send + 'static,
        change: impl FnOnce(&Core, P, &Once) -> Result<T, Status> + Send + 'static,
    ) -> Answer<T>
    where
        Q: Message + Send + 'static,
        P: Send + 'static,
        T: Message + Default + Send + 'static,
    {
        let caller = caller(&request);
        let request = request.into_inner();
        let once = Once::new(&caller.name, method, id.as_deref().unwrap_or_default(), &request)?;
        if id.is_none() {
            return self.on(lane, move |core, stop| change(core, read(core, request, stop)?, &once)).await;
        }
        let read = self.on(lane, move |core, stop| read(core, request, stop)).await?.into_inner();
        self.alone(move |core| {
            if let Some(answer) = once.answered(core)? {
                return Ok(answer);
            }
            let answer = change(core, read, &once)?;
            once.keep(core, &answer)?;
            Ok(answer)
        })
        .await
        .map(Response::new)
    }

    /// Does something on a thread while nobody else changes rules, assets or domains.
    async fn alone<T: Send + 'static>(
        &self,
        change: impl FnOnce(&Core) -> Result<T, Status> + Send + 'static,
    ) -> Result<T, Status> {
        let turn = self.core.pool.waits(self.core.turn()).await?;
        let core = Arc::clone(&self.core);
        let changed = self.core.pool.run(Lane::Write, move |_| {
            let _turn = turn;
            change(&core)
        });
        changed.await
    }
}

/// Returns who calls.
fn caller<T>(request: &Request<T>) -> Caller {
    let unknown = || Caller { name: "unknown".into(), scope: Scope::Read };
    request.extensions().get::<Caller>().cloned().unwrap_or_else(unknown)
}

/// Returns a message that must be there.
fn required<T>(field: &str, message: Option<T>) -> Result<T, Status> {
    message.ok_or_else(|| crate::status::invalid(field, "is missing"))
}

/// Returns a time as messages have it.
fn timestamp(ms: u64) -> prost_types::Timestamp {
    let seconds = i64::try_from(ms / 1000).unwrap_or(i64::MAX);
    let nanos = i32::try_from(ms % 1000).unwrap_or_default() * 1_000_000;
    prost_types::Timestamp { seconds, nanos }
}

/// Returns the time that a text like `2026-11-21T14:13:00Z` says; none for other texts.
fn timestamp_of(text: &str) -> Option<prost_types::Timestamp> {
    let time = humantime::parse_rfc3339_weak(text).ok()?;
    let since = time.duration_since(std::time::UNIX_EPOCH).ok()?;
    Some(timestamp(u64::try_from(since.as_millis()).ok()?))
}

/// Returns how a search ranks.
fn mode(mode: i32) -> Result<d3dgen_store::index::Mode, Status> {
    use d3dgen_store::index::Mode;
    match v1::SearchMode::try_from(mode) {
        Ok(v1::SearchMode::Unspecified | v1::SearchMode::Hybrid) => Ok(Mode::Hybrid),
        Ok(v1::SearchMode::Text) => Ok(Mode::Text),
        Ok(v1::SearchMode::Vector) => Ok(Mode::Vector),
        Err(_) => Err(crate::status::invalid("mode", format!("{mode} is no way to rank"))),
    }
}

/// Checks a pair of limits.
fn limits(field: &str, limits: Option<v1::Limits>) -> Result<(Option<f64>, Option<f64>), Status> {
    let Some(v1::Limits { min, max }) = limits else { return Ok((None, None)) };
    let finite = |v: Option<f64>| v.is_none_or(f64::is_finite);
    if !finite(min) || !finite(max) || matches!((min, max), (Some(a), Some(b)) if a > b) {
        return Err(crate::status::invalid(field, "needs finite limits, the least first"));
    }
    Ok((min, max))
}
