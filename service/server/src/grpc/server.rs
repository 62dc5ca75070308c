//! `ServerService`.

use std::time::Duration;

use d3dgen_pipeline::scene_graph::languages;
use d3dgen_proto::bounds;
use d3dgen_proto::v1::server_service_server::ServerService;
use d3dgen_proto::v1::{GetServerInfoRequest, GetServerInfoResponse, ServerLimits};
use tonic::{Request, Response};

use super::{Answer, Api, caller};
use crate::access::Scope;

#[tonic::async_trait]
impl ServerService for Api {
    async fn get_server_info(&self, request: Request<GetServerInfoRequest>) -> Answer<GetServerInfoResponse> {
        let caller = caller(&request);
        let (limits, jobs) = (&self.core.config.limits, &self.core.config.jobs);
        let prompt = bounds::of("d3dgen.v1.BuildingRequest").get("prompt").copied().unwrap_or_default();
        let seconds = |time: Duration| time.as_secs_f64();
        let limits = ServerLimits {
            message_bytes: limits.message_bytes as u64,
            upload_bytes: limits.upload_bytes,
            calls_per_client: u32::try_from(limits.calls_per_client).unwrap_or(u32::MAX),
            rate_per_s: limits.rate_per_s,
            lookup_s: seconds(limits.lookup),
            work_s: seconds(limits.work),
            stream_s: seconds(limits.stream),
            batch_worlds: jobs.batch_worlds,
            prompt_bytes: prompt as u64,
        };
        let allowed = Scope::ALL.into_iter().filter(|scope| *scope <= caller.scope);
        Ok(Response::new(GetServerInfoResponse {
            version: env!("CARGO_PKG_VERSION").into(),
            limits: Some(limits),
            languages: languages().into_iter().map(str::to_owned).collect(),
            client_name: caller.name,
            scopes: allowed.map(|scope| scope.name().to_owned()).collect(),
        }))
    }
}
