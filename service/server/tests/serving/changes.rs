//! Uploads that are repeated or hold a bad name; batches beside other jobs.

use std::time::{Duration, Instant};

use d3dgen_proto::v1::asset_service_client::AssetServiceClient;
use d3dgen_proto::v1::ingest_assets_request::Part;
use d3dgen_proto::v1::job_service_client::JobServiceClient;
use d3dgen_proto::v1::world_service_client::WorldServiceClient;
use d3dgen_proto::v1::{
    BuildingRequest, CancelJobRequest, FileChunk, GenerateBatchRequest, GetJobRequest, IngestAssetsRequest,
    IngestHeader, Job, JobState, WatchJobRequest,
};
use tonic::{Code, Status};

use crate::support::{PATIENCE, SMALL, Server};

/// Uploads files under a request id and returns the id of the job.
async fn upload(server: &Server, id: &str, files: &[(&str, &[u8])]) -> Result<String, Status> {
    let mut assets = AssetServiceClient::new(server.channel().await);
    let header = IngestHeader { folder_name: "models".into(), request_id: id.into(), ..Default::default() };
    let chunk =
        |(path, content): &(&str, &[u8])| Part::Chunk(FileChunk { path: (*path).into(), content: content.to_vec() });
    let parts: Vec<_> = std::iter::once(Part::Header(header)).chain(files.iter().map(chunk)).collect();
    let parts = parts.into_iter().map(|part| IngestAssetsRequest { part: Some(part) });
    let answer = assets.ingest_assets(tokio_stream::iter(parts.collect::<Vec<_>>())).await?;
    Ok(answer.into_inner().job.expect("a job").job_id)
}

#[tokio::test(flavor = "multi_thread")]
async fn an_upload_is_repeated_with_the_same_files_only() {
    let server = Server::start(&[]).await;
    let first = upload(&server, "u1", &[("a.glb", b"one"), ("b.glb", b"two")]).await.expect("kept");
    // the same files in other pieces
    let again = upload(&server, "u1", &[("a.glb", b"o"), ("a.glb", b"ne"), ("b.glb", b"two")]).await.expect("repeated");
    assert_eq!(first, again);
    for others in [&[("a.glb", &b"one"[..])][..], &[("a.glb", b"one"), ("b.glb", b"TWO")]] {
        let refused = upload(&server, "u1", others).await.expect_err("other files");
        assert_eq!(refused.code(), Code::InvalidArgument);
        assert!(refused.message().starts_with("header.request_id"), "{refused}");
    }
    // a name that not every system can hold is left out, the rest is taken
    upload(&server, "u2", &[("a.glb", b"one"), ("what?.glb", b"two")]).await.expect("the rest is taken");
    let refused = upload(&server, "u3", &[("a.glb", b"one"), ("../b.glb", b"two")]).await.expect_err("it leads out");
    assert_eq!(refused.code(), Code::InvalidArgument);
}

async fn job(jobs: &mut JobServiceClient<tonic::transport::Channel>, id: &str) -> Job {
    let found = jobs.get_job(GetJobRequest { job_id: id.into() }).await.expect("there");
    found.into_inner().job.expect("a job")
}

#[tokio::test(flavor = "multi_thread")]
async fn a_batch_lets_others_go_first_and_goes_on() {
    let server = Server::start(&["jobs.workers=1"]).await;
    let mut worlds = WorldServiceClient::new(server.channel().await);
    let mut jobs = JobServiceClient::new(server.channel().await);
    let building = BuildingRequest { prompt: SMALL.into(), seed: 1, ..Default::default() };
    let asked = GenerateBatchRequest { building: Some(building), world_count: 500, request_id: String::new() };
    let batch = worlds.generate_batch(asked).await.expect("started").into_inner().job.expect("a job").job_id;
    let begun = Instant::now();
    while job(&mut jobs, &batch).await.progress.is_none_or(|p| p.fraction == 0.0) {
        assert!(begun.elapsed() < PATIENCE, "the batch begins");
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    let ingest = upload(&server, "", &[("a.glb", b"no model")]).await.expect("kept");
    while job(&mut jobs, &ingest).await.ended_at.is_none() {
        assert!(begun.elapsed() < 2 * PATIENCE, "the ingest does not wait for 500 worlds");
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    let before = job(&mut jobs, &batch).await;
    assert!(before.ended_at.is_none(), "{before:?}");
    let done = before.progress.map_or(0.0, |p| p.fraction);
    while job(&mut jobs, &batch).await.progress.is_none_or(|p| p.fraction <= done) {
        assert!(begun.elapsed() < 3 * PATIENCE, "the batch goes on");
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    jobs.cancel_job(CancelJobRequest { job_id: batch.clone() }).await.expect("asked to stop");
    while job(&mut jobs, &batch).await.ended_at.is_none() {
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    assert_eq!(job(&mut jobs, &batch).await.state, JobState::Cancelled as i32);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_open_watch_of_a_job_holds_up_no_stop() {
    let mut server = Server::start(&[]).await;
    let mut worlds = WorldServiceClient::new(server.channel().await);
    let mut jobs = JobServiceClient::new(server.channel().await);
    let building = BuildingRequest { prompt: SMALL.into(), seed: 1, ..Default::default() };
    let asked = GenerateBatchRequest { building: Some(building), world_count: 500, request_id: String::new() };
    let batch = worlds.generate_batch(asked).await.expect("started").into_inner().job.expect("a job").job_id;
    let asked = WatchJobRequest { job_id: batch, include_logs: true };
    let mut watch = jobs.watch_job(asked).await.expect("a watch").into_inner();
    watch.message().await.expect("news");
    let begun = Instant::now();
    server.stop();
    tokio::time::timeout(Duration::from_secs(10), &mut server.ended).await.expect("it stops").expect("well");
    assert!(begun.elapsed() < Duration::from_secs(10));
}
