//! `d3dgen assets search` and `ingest` of a server.

use std::io::Read;
use std::path::{Path, PathBuf};

use d3dgen_assets::ingest::{Outcome, Summary};
use d3dgen_assets::search::{Filters, Found, SearchQuery};
use d3dgen_proto::v1::asset_service_client::AssetServiceClient;
use d3dgen_proto::v1::ingest_assets_request::Part;
use d3dgen_proto::v1::{
    AnyOf, AssetFilter, FileChunk, FoundAsset, IngestAssetsRequest, IngestHeader, IngestResult, IngestedFile, JobState,
    Limits, SearchAssetsRequest, Size, job,
};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::transport::Channel;

use super::{MESSAGE_BYTES, Remote, jobs, knowledge, part, refused};
use crate::error::Error;
use crate::progress::Progress;

/// Entries of one answer at most.
const PAGE: usize = 1000;
/// Bytes of one piece of an upload.
const PIECE: usize = 512 << 10;

fn client(remote: &Remote) -> AssetServiceClient<Channel> {
    AssetServiceClient::new(remote.channel()).max_decoding_message_size(MESSAGE_BYTES)
}

/// Returns the assets that fit best, best first; with `like`, those most like one.
///
/// # Errors
/// `Remote`.
pub fn search(remote: &Remote, query: &SearchQuery, like: Option<&str>) -> Result<Vec<Found>, Error> {
    let (mut found, mut page_token) = (Vec::new(), String::new());
    while found.len() < query.limit {
        let asked = SearchAssetsRequest {
            query: query.text.clone(),
            filter: Some(filter(&query.filters)),
            like_asset_id: like.map(str::to_owned),
            domain_id: query.domain.clone(),
            room_type: query.room_type.clone(),
            size_m: query.size_m.map(|[width_m, depth_m, height_m]| Size { width_m, depth_m, height_m }),
            mode: knowledge::mode(query.mode) as i32,
            all_sizes: !query.one_per_object,
            page_size: i32::try_from(query.limit.min(PAGE)).unwrap_or(i32::MAX),
            page_token,
        };
        let page = remote.ask(client(remote).search_assets(remote.request(asked)))?;
        found.extend(page.assets.into_iter().map(read).collect::<Result<Vec<_>, _>>()?);
        page_token = page.next_page_token;
        if page_token.is_empty() {
            break;
        }
    }
    found.truncate(query.limit);
    Ok(found)
}

fn read(found: FoundAsset) -> Result<Found, Error> {
    let asset = found.asset.ok_or_else(|| Error::Remote("the answer lacks an asset".into()))?;
    Ok(Found { annotation: part(&asset)?, score: found.score, reasons: found.reasons })
}

fn filter(filters: &Filters) -> AssetFilter {
    let values = |all: &std::collections::BTreeMap<String, std::collections::BTreeSet<String>>| {
        all.iter().map(|(name, values)| (name.clone(), AnyOf { values: values.iter().cloned().collect() })).collect()
    };
    let limits = |name: &str| filters.numbers.get(name).map(|range| Limits { min: range.min, max: range.max });
    AssetFilter {
        any_of: values(&filters.facets),
        none_of: values(&filters.not),
        width_m: limits("width"),
        depth_m: limits("depth"),
        height_m: limits("height"),
        mass_kg: limits("mass"),
        volume_m3: limits("volume"),
        triangle_count: limits("triangles"),
    }
}

/// Uploads a folder, or one file, and waits until the server has read its models.
///
/// # Errors
/// `Read` when a file cannot be read: nothing is ingested then; `Remote`; `Interrupted`.
pub fn ingest(
    remote: &Remote,
    folder: &Path,
    (domain, why): (Option<&str>, &str),
    progress: &Progress,
) -> Result<Summary, Error> {
    let (name, files) = files(folder)?;
    let header = IngestHeader {
        folder_name: name,
        domain_id: domain.map(str::to_owned),
        why: why.to_owned(),
        request_id: String::new(),
    };
    let started = remote.wait(async {
        let (send, receive) = mpsc::channel(4);
        let mut client = client(remote);
        let mut call = std::pin::pin!(client.ingest_assets(remote.request(ReceiverStream::new(receive))));
        let mut pieces = std::pin::pin!(upload(header, &files, send.clone(), progress));
        let answer = tokio::select! {
            answer = &mut call => answer, // refused before the end
            read = &mut pieces => {
                read?; // the upload never ends then: the call goes with this function, and the server forgets it
                drop(send);
                call.await
            }
        };
        answer.map_err(refused)
    })?;
    let job = started.into_inner().job.ok_or_else(|| Error::Remote("the answer lacks the job".into()))?;
    let ended = jobs::watch(remote, &job.job_id, true, &mut |job, _| {
        progress.doing(&job.progress.as_ref().map(|p| p.message.clone()).unwrap_or_default());
    })?;
    let cancelled = ended.state == JobState::Cancelled as i32;
    match ended.result {
        Some(job::Result::Ingest(result)) => Ok(summary(result, cancelled)),
        _ if cancelled => Err(Error::Interrupted),
        _ => Err(jobs::failure(&ended)),
    }
}

fn summary(result: IngestResult, cancelled: bool) -> Summary {
    let outcome = |file: IngestedFile| {
        let (asset_id, reason) = (file.asset_id.unwrap_or_default(), file.reason.unwrap_or_default());
        let outcome = match file.outcome.as_str() {
            "added" => Outcome::Added { asset_id },
            "updated" => Outcome::Updated { asset_id },
            "unchanged" => Outcome::Unchanged { asset_id },
            _ => Outcome::Refused { reason },
        };
        (file.path, outcome)
    };
    Summary { files: result.files.into_iter().map(outcome).collect(), cancelled }
}

/// Returns the name of a folder, and its files by path below it with `/`; hidden folders and links are left out.
fn files(folder: &Path) -> Result<(String, Vec<(String, PathBuf)>), Error> {
    let failed = |source| Error::Read { path: folder.to_path_buf(), source };
    let whole = std::fs::canonicalize(folder).map_err(failed)?;
    let name = |path: &Path| path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    if whole.is_file() {
        let home = whole.parent().map(name).unwrap_or_default();
        return Ok((home, vec![(name(&whole), whole)]));
    }
    let mut found = Vec::new();
    let mut left = vec![(String::new(), whole.clone())];
    while let Some((below, folder)) = left.pop() {
        for entry in std::fs::read_dir(&folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let (kind, name) = (entry.file_type().map_err(failed)?, entry.file_name().to_string_lossy().into_owned());
            let path = format!("{below}{name}");
            if kind.is_dir() && !name.starts_with('.') {
                left.push((format!("{path}/"), entry.path()));
            } else if kind.is_file() {
                found.push((path, entry.path()));
            }
        }
    }
    found.sort();
    Ok((name(&whole), found))
}

/// Sends a header and the pieces of files, until nobody takes them.
async fn upload(
    header: IngestHeader,
    files: &[(String, PathBuf)],
    send: mpsc::Sender<IngestAssetsRequest>,
    progress: &Progress,
) -> Result<(), Error> {
    let mut parts = vec![Part::Header(header)];
    for (at, (path, file)) in files.iter().enumerate() {
        let failed = |source| Error::Read { path: file.clone(), source };
        progress.doing(&format!("sending {} of {}: {path}", at + 1, files.len()));
        let mut open = std::fs::File::open(file).map_err(failed)?;
        let mut first = true;
        loop {
            let mut content = Vec::new();
            open.by_ref().take(PIECE as u64).read_to_end(&mut content).map_err(failed)?;
            if content.is_empty() && !first {
                break;
            }
            first = false;
            parts.push(Part::Chunk(FileChunk { path: path.clone(), content }));
            for part in parts.drain(..) {
                crate::interrupt::check()?;
                if send.send(IngestAssetsRequest { part: Some(part) }).await.is_err() {
                    return Ok(()); // the answer tells why
                }
            }
        }
    }
    for part in parts {
        let _ = send.send(IngestAssetsRequest { part: Some(part) }).await;
    }
    Ok(())
}
