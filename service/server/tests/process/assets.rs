//! Models of clients: ingested while nothing else changes, and found by searches and worlds.

use std::io::Read;

use d3dgen_proto::v1::{
    DomainManifest, DownloadAssetRequest, GenerateAssetsRequest, GetDomainRequest, IngestFolderRequest, JobState,
    RegisterDomainRequest, RemoveAssetsRequest, Size, job,
};

use crate::support::{Clients, Server, manifest};

/// Returns the files of a zip archive by name.
fn unpack(archive: Vec<u8>) -> Vec<(String, Vec<u8>)> {
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(archive)).expect("an archive");
    let count = archive.len();
    let file = |at| {
        let mut file = archive.by_index(at).expect("a file");
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).expect("whole");
        (file.name().to_owned(), bytes)
    };
    (0..count).map(file).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn what_was_registered_is_returned_after_an_ingest() {
    let dir = tempfile::tempdir().expect("a folder");
    let root = dir.path().join("root");
    let roots = format!("read_roots=[{:?}]", root.display().to_string());
    let server = Server::start(&dir.path().join("data"), &[&roots]);
    let mut c = Clients::of(&server).await;
    let mine = DomainManifest { domain_id: "depot".into(), ..manifest(&mut c, "warehouse").await };
    let register = RegisterDomainRequest { manifest: Some(mine.clone()), ..Default::default() };
    let registered = c.domains.register_domain(register).await.expect("registered").into_inner().domain;
    let object = mine.objects.iter().find(|o| o.object_id == "pallet_rack").expect("an object").clone();
    let size = object.sizes_m.first().expect("a size");
    let size = Size { width_m: size.width_m + 0.137, ..*size };

    // a model of one of its objects, of a size that the domain does not know
    let asked = GenerateAssetsRequest {
        object_id: object.object_id.clone(),
        domain_id: Some("depot".into()),
        size_m: Some(size),
        count: 1,
        ..Default::default()
    };
    let made = c.assets.generate_assets(asked).await.expect("made").into_inner().assets.remove(0);
    let download = DownloadAssetRequest { asset_id: made.asset_id.clone(), formats: vec!["usdz".into()] };
    let mut pieces = c.assets.download_asset(download).await.expect("files").into_inner();
    let mut archive = Vec::new();
    while let Some(piece) = pieces.message().await.expect("a piece") {
        archive.extend(piece.chunk);
    }
    for (name, bytes) in unpack(archive) {
        let file = root.join(name);
        std::fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
        std::fs::write(file, bytes).expect("written");
    }
    let remove = RemoveAssetsRequest { asset_ids: vec![made.asset_id], ..Default::default() };
    c.assets.remove_assets(remove).await.expect("removed");
    let ingest = IngestFolderRequest { server_path: root.display().to_string(), ..Default::default() };
    let started = c.assets.ingest_folder(ingest).await.expect("started").into_inner().job.expect("a job");
    let ended = c.ended(&started.job_id).await;
    assert_eq!(ended.state, JobState::Succeeded as i32, "{ended:?}");
    let Some(job::Result::Ingest(result)) = ended.result else { panic!("a result") };
    assert_eq!(result.added_count, 1, "{result:?}");
    let asset_id = result.files[0].asset_id.clone().expect("an id");
    let get = d3dgen_proto::v1::GetAssetRequest { asset_id };
    let asset = c.assets.get_asset(get).await.expect("there").into_inner().asset.expect("one");
    assert_eq!(asset.object_id.as_deref(), Some("pallet_rack"), "worlds choose it: {asset:?}");

    let get = GetDomainRequest { domain_id: "depot".into(), include_manifest: true, ..Default::default() };
    let found = c.domains.get_domain(get).await.expect("there").into_inner();
    assert_eq!(found.manifest.expect("a manifest"), mine);
    assert_eq!(found.domain, registered);
}
