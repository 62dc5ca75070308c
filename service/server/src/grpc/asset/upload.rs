//! A folder of models on its way in: files in pieces, under names that stay in their folder, whole before a job begins.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use d3dgen_proto::v1::ingest_assets_request::Part;
use d3dgen_proto::v1::{IngestAssetsRequest, IngestAssetsResponse, IngestHeader};
use prost::Message;
use sha2::{Digest, Sha256};
use tokio::fs::File;
use tokio::io::AsyncWriteExt;
use tonic::{Status, Streaming};

use crate::grpc::{Api, Once, job};
use crate::jobs::Spec;
use crate::jobs::ingest::Ingest;
use crate::names;
use crate::status::{self, invalid};

/// Files of one upload at most.
const FILES: usize = 100_000;

/// Files refused for their names that are remembered.
const REFUSED: usize = 1000;

/// What came of an upload.
#[derive(Default)]
struct Received {
    /// The content of each file, for the digest of the whole.
    files: BTreeMap<PathBuf, Sha256>,
    /// Files that were left out, with the reason.
    refused: BTreeMap<String, String>,
}

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
        let mut upload = Upload { api: self, id: self.core.jobs.reserve(), kept: false };
        let dir = self.core.upload_dir(&upload.id).join(&name);
        tokio::fs::create_dir_all(&dir).await.map_err(|e| status::io(&e))?;
        let Received { refused, files } = self.receive(&dir, &mut parts).await?;
        // the same id with other files is another request, so that all files are looked at before an answer is repeated
        let mut whole = Sha256::new_with_prefix(header.encode_to_vec());
        for (path, content) in files {
            whole.update(path.to_string_lossy().as_bytes());
            whole.update([0]);
            whole.update(content.finalize());
        }
        let (id, digest) = (header.request_id.clone(), whole.finalize().into());
        let once = Once::of("header.request_id", who, "IngestAssets", &id, &digest)?;
        let (who, id) = (who.to_owned(), upload.id.clone());
        let started = self.alone(move |core| {
            if let Some(answer) = once.answered::<IngestAssetsResponse>(core)? {
                return Ok((answer, false)); // the same upload twice at once
            }
            let title = format!("models of {name}");
            let spec = Ingest { folder: None, name, domain: header.domain_id, why: header.why, refused };
            let job = core.jobs.start(&who, title, Spec::Ingest(spec), Some(id), |job, batch| {
                once.also(core, &IngestAssetsResponse { job: Some(job::message(job)) }, batch);
            })?;
            Ok((IngestAssetsResponse { job: Some(job::message(&job)) }, true))
        });
        let (answer, is_new) = started.await?;
        upload.kept = is_new;
        Ok(answer)
    }

    /// Writes the files. One whose name not every system can hold is refused by itself.
    async fn receive(&self, dir: &Path, parts: &mut Streaming<IngestAssetsRequest>) -> Result<Received, Status> {
        let limit = self.core.config.limits.upload_bytes;
        let (mut bytes, mut received) = (0, Received::default());
        let mut open: Option<(PathBuf, File)> = None;
        while let Some(message) = parts.message().await? {
            let Some(Part::Chunk(chunk)) = message.part else {
                return Err(invalid("chunk", "is missing: every message after the first is a piece of a file"));
            };
            names::inside("chunk.path", &chunk.path)?;
            bytes += chunk.content.len() as u64;
            if bytes > limit {
                return Err(Status::resource_exhausted(format!("the upload has more than {limit} bytes, the limit")));
            }
            let path = match names::upload_path("chunk.path", &chunk.path) {
                Ok(path) => path,
                Err(refused) => {
                    if received.refused.len() < REFUSED {
                        received.refused.insert(chunk.path, refused.message().to_owned());
                    }
                    continue;
                }
            };
            let failed = |e: std::io::Error| match e.kind() {
                // a file where others have a folder
                std::io::ErrorKind::NotADirectory
                | std::io::ErrorKind::AlreadyExists
                | std::io::ErrorKind::IsADirectory => invalid("chunk.path", "is a file and a folder"),
                _ => status::io(&e),
            };
            if open.as_ref().is_none_or(|(current, _)| *current != path) {
                if let Some((_, file)) = open.take() {
                    file.sync_data().await.map_err(failed)?;
                }
                if received.files.len() >= FILES && !received.files.contains_key(&path) {
                    return Err(invalid("chunk", format!("is of one file more than {FILES}")));
                }
                let file = dir.join(&path);
                tokio::fs::create_dir_all(file.parent().unwrap_or(dir)).await.map_err(failed)?;
                let file = File::options().create(true).append(true).open(file).await.map_err(failed)?;
                open = Some((path, file));
            }
            if let Some((path, file)) = &mut open {
                file.write_all(&chunk.content).await.map_err(failed)?;
                received.files.entry(path.clone()).or_default().update(&chunk.content);
            }
        }
        if let Some((_, mut file)) = open {
            file.flush().await.map_err(|e| status::io(&e))?;
            file.sync_data().await.map_err(|e| status::io(&e))?;
        }
        match received.refused.first_key_value() {
            _ if !received.files.is_empty() => Ok(received),
            Some((_, reason)) => Err(invalid("chunk.path", reason.clone())),
            None => Err(invalid("chunk", "is missing: the upload has no files")),
        }
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
