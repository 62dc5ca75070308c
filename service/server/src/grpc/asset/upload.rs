//! A folder of models on its way in: files in pieces, under names that stay in their folder, whole before a job begins.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use d3dgen_proto::v1::ingest_assets_request::Part;
use d3dgen_proto::v1::{IngestAssetsRequest, IngestAssetsResponse, IngestHeader};
use tokio::fs::File;
use tokio::io::AsyncWriteExt;
use tonic::{Status, Streaming};

use crate::grpc::{Api, Once, job};
use crate::jobs::Spec;
use crate::jobs::ingest::Ingest;
use crate::names;
use crate::status::{self, invalid};

/// Bytes of one piece at most.
const PIECE: usize = 1 << 20;
/// Files of one upload at most.
const FILES: usize = 100_000;

/// An upload that is removed when it does not become a job.
struct Upload<'a> {
    api: &'a Api,
    id: String,
    kept: bool,
}

impl Drop for Upload<'_> {
    fn drop(&mut self) {
        if !self.kept {
            self.api.core.remove_files_of(&self.id);
        }
    }
}

impl Api {
    /// Keeps an upload and starts its job.
    pub(super) async fn upload(
        &self,
        who: &str,
        mut parts: Streaming<IngestAssetsRequest>,
    ) -> Result<IngestAssetsResponse, Status> {
        let header = match parts.message().await?.and_then(|m| m.part) {
            Some(Part::Header(header)) => header,
            _ => return Err(invalid("header", "is missing: the first message is the header")),
        };
        let name = checked(&header)?;
        let once = Once::new(who, "IngestAssets", &header.request_id, &header)?;
        let answered = |once: &Once| once.answered::<IngestAssetsResponse>(&self.core);
        if let Some(answer) = answered(&once)? {
            return Ok(answer);
        }
        let mut upload = Upload { api: self, id: self.core.jobs.reserve(), kept: false };
        let dir = self.core.upload_dir(&upload.id).join(&name);
        tokio::fs::create_dir_all(&dir).await.map_err(|e| status::internal(&e))?;
        self.receive(&dir, &mut parts).await?;
        let (core, who, id) = (self.core.clone(), who.to_owned(), upload.id.clone());
        let started = self.core.pool.run(crate::pool::Lane::Work, move |_| {
            let _alone = core.writing();
            if let Some(answer) = once.answered::<IngestAssetsResponse>(&core)? {
                return Ok((answer, false)); // the same upload twice at once
            }
            let title = format!("models of {name}");
            let spec = Ingest { folder: None, name, domain: header.domain_id, why: header.why };
            let job = core.jobs.start(&who, title, Spec::Ingest(spec), Some(id), |job, batch| {
                once.also(&core, &IngestAssetsResponse { job: Some(job::message(job)) }, batch);
            })?;
            Ok((IngestAssetsResponse { job: Some(job::message(&job)) }, true))
        });
        let (answer, is_new) = started.await?;
        upload.kept = is_new;
        Ok(answer)
    }

    /// Writes the files.
    async fn receive(&self, dir: &Path, parts: &mut Streaming<IngestAssetsRequest>) -> Result<(), Status> {
        let limit = self.core.config.limits.upload_bytes;
        let (mut bytes, mut seen) = (0, BTreeSet::new());
        let mut open: Option<(PathBuf, File)> = None;
        while let Some(message) = parts.message().await? {
            let Some(Part::Chunk(chunk)) = message.part else {
                return Err(invalid("chunk", "is missing: every message after the first is a piece of a file"));
            };
            let path = names::upload_path("chunk.path", &chunk.path)?;
            if chunk.content.len() > PIECE {
                return Err(invalid("chunk.content", format!("has {} bytes, at most {PIECE}", chunk.content.len())));
            }
            bytes += chunk.content.len() as u64;
            if bytes > limit {
                return Err(Status::resource_exhausted(format!("the upload has more than {limit} bytes, the limit")));
            }
            let failed = |e: std::io::Error| match e.kind() {
                // a file where others have a folder
                std::io::ErrorKind::NotADirectory
                | std::io::ErrorKind::AlreadyExists
                | std::io::ErrorKind::IsADirectory => invalid("chunk.path", "is a file and a folder"),
                std::io::ErrorKind::StorageFull => Status::resource_exhausted("the disk of the server is full"),
                _ => status::internal(&e),
            };
            if open.as_ref().is_none_or(|(current, _)| *current != path) {
                if let Some((_, file)) = open.take() {
                    file.sync_data().await.map_err(failed)?;
                }
                if seen.insert(path.clone()) && seen.len() > FILES {
                    return Err(invalid("chunk", format!("is of file {}, at most {FILES}", seen.len())));
                }
                let file = dir.join(&path);
                tokio::fs::create_dir_all(file.parent().unwrap_or(dir)).await.map_err(failed)?;
                let file = File::options().create(true).append(true).open(file).await.map_err(failed)?;
                open = Some((path, file));
            }
            if let Some((_, file)) = &mut open {
                file.write_all(&chunk.content).await.map_err(failed)?;
            }
        }
        if let Some((_, mut file)) = open {
            file.flush().await.map_err(|e| status::internal(&e))?;
            file.sync_data().await.map_err(|e| status::internal(&e))?;
        }
        if seen.is_empty() {
            return Err(invalid("chunk", "is missing: the upload has no files"));
        }
        Ok(())
    }
}

/// Checks a header and returns the name of its folder.
fn checked(header: &IngestHeader) -> Result<String, Status> {
    let name = if header.folder_name.is_empty() { "upload" } else { &header.folder_name };
    names::upload_path("header.folder_name", name)?;
    if name.contains('/') {
        return Err(invalid("header.folder_name", "is a path; name the folder alone"));
    }
    if let Some(domain) = &header.domain_id {
        names::id("header.domain_id", domain)?;
    }
    Ok(name.to_owned())
}
