//! `AssetService`.

mod change;
pub(crate) mod files;
mod upload;

use d3dgen_assets::catalog::Catalog;
use d3dgen_assets::database::Shelf;
use d3dgen_assets::search::{FACETS, Filters, Found, Range, SearchQuery};
use d3dgen_proto::v1::asset_service_server::AssetService;
use d3dgen_proto::v1::{
    AnnotateAssetRequest, AnnotateAssetResponse, AssetFilter, DownloadAssetRequest, DownloadAssetResponse, FoundAsset,
    GenerateAssetsRequest, GenerateAssetsResponse, GetAssetRequest, GetAssetResponse, GetAssetStatsRequest,
    GetAssetStatsResponse, IngestAssetsRequest, IngestAssetsResponse, IngestFolderRequest, IngestFolderResponse,
    ListAssetsRequest, ListAssetsResponse, RemoveAssetsRequest, RemoveAssetsResponse, RestoreAssetsRequest,
    RestoreAssetsResponse, SearchAssetsRequest, SearchAssetsResponse, Size, ValueCounts,
};
use tonic::{Request, Response, Status, Streaming};

use super::page::Page;
use super::world::export;
use super::{Answer, Api, Once, caller, limits, mode};
use crate::convert::message;
use crate::core::Core;
use crate::jobs::Spec;
use crate::jobs::ingest::Ingest;
use crate::names;
use crate::pool::Lane;
use crate::status::{self, invalid};

#[tonic::async_trait]
impl AssetService for Api {
    async fn ingest_assets(&self, request: Request<Streaming<IngestAssetsRequest>>) -> Answer<IngestAssetsResponse> {
        let who = caller(&request).name;
        self.upload(&who, request.into_inner()).await.map(Response::new)
    }

    async fn ingest_folder(&self, request: Request<IngestFolderRequest>) -> Answer<IngestFolderResponse> {
        let who = caller(&request).name;
        let change = move |core: &Core, asked: IngestFolderRequest, once: &Once| {
            let folder = names::under_roots("server_path", &asked.server_path, &core.config.read_roots)?;
            let domain = asked.domain_id.as_deref().map(|d| names::id("domain_id", d)).transpose()?.map(str::to_owned);
            let name = folder.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            let title = format!("models of {name}");
            let spec = Spec::Ingest(Ingest {
                folder: Some(folder),
                name,
                domain,
                why: asked.why,
                refused: Default::default(),
            });
            let job = core.jobs.start(&who, title, spec, None, |job, batch| {
                once.also(core, &IngestFolderResponse { job: Some(super::job::message(job)) }, batch);
            })?;
            Ok(IngestFolderResponse { job: Some(super::job::message(&job)) })
        };
        {
            let id = request.get_ref().request_id.clone();
            self.change("IngestFolder", request, id, change).await
        }
    }

    async fn search_assets(&self, request: Request<SearchAssetsRequest>) -> Answer<SearchAssetsResponse> {
        let mut asked = request.into_inner();
        let (page_size, token) = (std::mem::take(&mut asked.page_size), std::mem::take(&mut asked.page_token));
        let page = Page::new(page_size, &token, &asked)?;
        let query = SearchQuery {
            filters: filters(asked.filter)?,
            mode: mode(asked.mode)?,
            size_m: asked.size_m.map(|s| size("size_m", s)).transpose()?,
            text: asked.query,
            room_type: asked.room_type,
            domain: asked.domain_id,
            limit: page.wanted(),
            one_per_object: !asked.all_sizes,
        };
        self.lookup(move |core| {
            let found = match &asked.like_asset_id {
                Some(id) => core.databases.like(names::reference("like_asset_id", id)?, &query)?,
                None => core.databases.search_assets(&query)?,
            };
            let (found, next_page_token) = page.cut(found);
            let entry =
                |f: Found| FoundAsset { asset: Some(message(&f.annotation)), score: f.score, reasons: f.reasons };
            Ok(SearchAssetsResponse { assets: found.into_iter().map(entry).collect(), next_page_token })
        })
        .await
    }

    async fn list_assets(&self, request: Request<ListAssetsRequest>) -> Answer<ListAssetsResponse> {
        let mut asked = request.into_inner();
        let (page_size, token) = (std::mem::take(&mut asked.page_size), std::mem::take(&mut asked.page_token));
        let page = Page::new(page_size, &token, &asked)?;
        let query = SearchQuery {
            filters: filters(asked.filter)?,
            limit: page.wanted(),
            one_per_object: !asked.all_sizes,
            ..SearchQuery::default()
        };
        self.lookup(move |core| {
            let (found, next_page_token) = page.cut(core.databases.search_assets(&query)?);
            Ok(ListAssetsResponse { assets: found.iter().map(|f| message(&f.annotation)).collect(), next_page_token })
        })
        .await
    }

    async fn get_asset(&self, request: Request<GetAssetRequest>) -> Answer<GetAssetResponse> {
        let id = request.into_inner().asset_id;
        self.lookup(move |core| {
            names::reference("asset_id", &id)?;
            let now = core.domains.now();
            let asset = shelf(core, &now.catalog)?.get(&id).map_err(status::assets)?;
            let thumbnail_png = files::thumbnail(core, &now, &asset)?;
            Ok(GetAssetResponse { asset: Some(message(&asset)), thumbnail_png })
        })
        .await
    }

    type DownloadAssetStream = export::Pieces<DownloadAssetResponse>;

    async fn download_asset(&self, request: Request<DownloadAssetRequest>) -> Answer<Self::DownloadAssetStream> {
        let asked = request.into_inner();
        names::reference("asset_id", &asked.asset_id)?;
        self.work(move |core, stop| {
            let files = files::of(core, &asked.asset_id, &asked.formats)?;
            export::archive(files, stop, |chunk| DownloadAssetResponse { chunk })
        })
        .await
    }

    async fn annotate_asset(&self, request: Request<AnnotateAssetRequest>) -> Answer<AnnotateAssetResponse> {
        let who = caller(&request).name;
        let change = move |core: &Core, asked: AnnotateAssetRequest, once: &Once| {
            let asset = change::annotate(core, &who, asked, once)?;
            Ok(AnnotateAssetResponse { asset: Some(message(&asset)) })
        };
        {
            let id = request.get_ref().request_id.clone();
            self.change("AnnotateAsset", request, id, change).await
        }
    }

    async fn generate_assets(&self, request: Request<GenerateAssetsRequest>) -> Answer<GenerateAssetsResponse> {
        let who = caller(&request).name;
        let change = move |core: &Core, asked: GenerateAssetsRequest, once: &Once| {
            let assets = change::generate(core, &who, &asked, once)?;
            Ok(GenerateAssetsResponse { assets: assets.iter().map(message).collect() })
        };
        {
            let id = request.get_ref().request_id.clone();
            self.change("GenerateAssets", request, id, change).await
        }
    }

    async fn remove_assets(&self, request: Request<RemoveAssetsRequest>) -> Answer<RemoveAssetsResponse> {
        let who = caller(&request).name;
        let q = request.get_ref();
        let id = (!q.validate_only).then(|| q.request_id.clone());
        let change = move |core: &Core, asked: RemoveAssetsRequest, once: &Once| {
            let asset_ids = change::remove(core, &who, asked, once)?;
            Ok(RemoveAssetsResponse { asset_ids })
        };
        self.change_read(("RemoveAssets", Lane::Short), request, id, |_, asked, _| Ok(asked), change).await
    }

    async fn restore_assets(&self, request: Request<RestoreAssetsRequest>) -> Answer<RestoreAssetsResponse> {
        let who = caller(&request).name;
        let change = move |core: &Core, asked: RestoreAssetsRequest, once: &Once| {
            let object_ids = change::restore(core, &who, asked, once)?;
            Ok(RestoreAssetsResponse { object_ids })
        };
        {
            let id = request.get_ref().request_id.clone();
            self.change("RestoreAssets", request, id, change).await
        }
    }

    async fn get_asset_stats(&self, _: Request<GetAssetStatsRequest>) -> Answer<GetAssetStatsResponse> {
        self.lookup(|core| {
            let stats = core.databases.assets.stats().map_err(status::assets)?;
            let (asset_count, values) = core.databases.asset_values(&FACETS)?;
            let counts = |all: std::collections::BTreeMap<String, usize>| ValueCounts {
                counts: all.into_iter().map(|(value, n)| (value, n as u64)).collect(),
            };
            Ok(GetAssetStatsResponse {
                asset_count,
                kept_count: stats.assets,
                removed_object_count: stats.removed,
                model_bytes: stats.model_bytes,
                change_count: stats.changes,
                // an id has one asset: to filter by, not to count
                properties: values
                    .into_iter()
                    .filter(|(n, _)| *n != "id")
                    .map(|(n, v)| (n.into(), counts(v)))
                    .collect(),
            })
        })
        .await
    }
}

/// Returns all assets as they are now.
fn shelf<'c>(core: &Core, catalog: &'c Catalog) -> Result<Shelf<'c>, Status> {
    Shelf::new(Some(core.databases.assets.clone()), catalog).map_err(status::assets)
}

/// Returns extents that something can have.
fn size(field: &str, size: Size) -> Result<[f64; 3], Status> {
    let extents = [size.width_m, size.depth_m, size.height_m];
    match extents.iter().all(|v| (0.001..=100.0).contains(v)) {
        true => Ok(extents),
        false => Err(invalid(field, "needs width, depth and height between 0.001 and 100 m")),
    }
}

fn filters(asked: Option<AssetFilter>) -> Result<Filters, Status> {
    let Some(asked) = asked else { return Ok(Filters::default()) };
    let values = |field: &str, all: std::collections::BTreeMap<String, d3dgen_proto::v1::AnyOf>| {
        if let Some(name) = all.keys().find(|n| !FACETS.contains(&n.as_str())) {
            return Err(invalid(field, format!("`{name}` is no property; there are {}", FACETS.join(", "))));
        }
        Ok(all.into_iter().map(|(name, any)| (name, any.values.into_iter().collect())).collect())
    };
    let mut numbers = std::collections::BTreeMap::new();
    for (field, name, asked) in [
        ("filter.width_m", "width", asked.width_m),
        ("filter.depth_m", "depth", asked.depth_m),
        ("filter.height_m", "height", asked.height_m),
        ("filter.mass_kg", "mass", asked.mass_kg),
        ("filter.volume_m3", "volume", asked.volume_m3),
        ("filter.triangle_count", "triangles", asked.triangle_count),
    ] {
        if asked.is_some() {
            let (min, max) = limits(field, asked)?;
            numbers.insert(name.to_owned(), Range { min, max });
        }
    }
    Ok(Filters {
        facets: values("filter.any_of", asked.any_of)?,
        not: values("filter.none_of", asked.none_of)?,
        numbers,
    })
}
