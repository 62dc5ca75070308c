//! `LibraryService`.

use d3dgen_model::Document;
use d3dgen_model::world::World;
use d3dgen_proto::v1::library_service_server::LibraryService;
use d3dgen_proto::v1::{
    CreateWorldRequest, CreateWorldResponse, DeleteWorldRequest, DeleteWorldResponse, DuplicateWorldRequest,
    DuplicateWorldResponse, GetWorldRequest, GetWorldResponse, KeptWorld, ListWorldRevisionsRequest,
    ListWorldRevisionsResponse, ListWorldsRequest, ListWorldsResponse, ParseWorldRequest, ParseWorldResponse,
    RestoreWorldRequest, RestoreWorldResponse, UpdateWorldRequest, UpdateWorldResponse, World as WorldMessage,
    WorldRevision,
};
use tonic::{Request, Status};

use super::page::Page;
use super::world::{checked, report};
use super::{Answer, Api, Once, caller, required, timestamp};
use crate::convert::document;
use crate::core::Core;
use crate::library::{self, Kept, State};
use crate::pool::Lane;
use crate::status::{self, invalid};

/// A repeated change of a kept world is refused by its etag, so that it needs no id.
const NO_ID: &str = "";

#[tonic::async_trait]
impl LibraryService for Api {
    async fn parse_world(&self, request: Request<ParseWorldRequest>) -> Answer<ParseWorldResponse> {
        let asked = request.into_inner();
        self.work(move |core, _| {
            let text = String::from_utf8(asked.content).map_err(|_| invalid("content", "is no text in UTF-8"))?;
            let world = World::from_json(&text).map_err(|e| status::document("content", e))?;
            let found = report(core, &world)?;
            Ok(ParseWorldResponse { world: Some(checked(&world, &found)) })
        })
        .await
    }

    async fn create_world(&self, request: Request<CreateWorldRequest>) -> Answer<CreateWorldResponse> {
        let owner = caller(&request).name;
        let id = request.get_ref().request_id.clone();
        let read = |core: &Core, asked: CreateWorldRequest, _: &_| {
            let state = judged(core, required("world", asked.world)?)?;
            Ok((asked.title, asked.label, state))
        };
        let change = move |core: &Core, (title, label, state): (String, String, State), once: &Once| {
            let kept = library::create(core, &owner, title, label, &state, |kept, batch| {
                once.also(core, &CreateWorldResponse { kept: Some(message(kept)) }, batch);
            })?;
            Ok(CreateWorldResponse { kept: Some(message(&kept)) })
        };
        self.change_read(("CreateWorld", Lane::Work), request, Some(id), read, change).await
    }

    async fn get_world(&self, request: Request<GetWorldRequest>) -> Answer<GetWorldResponse> {
        let caller = caller(&request);
        let asked = request.into_inner();
        self.lookup(move |core| {
            let kept = library::get(core, &asked.world_id, &caller)?;
            let state = library::state(core, &kept, asked.revision.unwrap_or(kept.revision))?;
            Ok(GetWorldResponse { kept: Some(message(&kept)), world: Some(checked(&state.world, &state.report)) })
        })
        .await
    }

    async fn list_worlds(&self, request: Request<ListWorldsRequest>) -> Answer<ListWorldsResponse> {
        let caller = caller(&request);
        let mut asked = request.into_inner();
        let (size, token) = (std::mem::take(&mut asked.page_size), std::mem::take(&mut asked.page_token));
        let page = Page::new(size, &token, &asked)?;
        self.lookup(move |core| {
            let (found, next_page_token) = page.cut(library::list(core, &caller)?);
            Ok(ListWorldsResponse { worlds: found.iter().map(message).collect(), next_page_token })
        })
        .await
    }

    async fn update_world(&self, request: Request<UpdateWorldRequest>) -> Answer<UpdateWorldResponse> {
        let caller = caller(&request);
        let read = |core: &Core, mut asked: UpdateWorldRequest, _: &_| {
            let state = asked.world.take().map(|world| judged(core, world)).transpose()?;
            Ok((asked, state))
        };
        let change = move |core: &Core, (asked, state): (UpdateWorldRequest, Option<State>), _: &Once| {
            let state = state.as_ref().map(|state| (asked.label, state));
            let kept = library::update(core, (&asked.world_id, &asked.etag, &caller), asked.title, state)?;
            Ok(UpdateWorldResponse { kept: Some(message(&kept)) })
        };
        self.change_read(("UpdateWorld", Lane::Work), request, Some(NO_ID.into()), read, change).await
    }

    async fn restore_world(&self, request: Request<RestoreWorldRequest>) -> Answer<RestoreWorldResponse> {
        let caller = caller(&request);
        self.change("RestoreWorld", request, NO_ID.into(), move |core, asked, _| {
            let of = (asked.world_id.as_str(), asked.etag.as_str(), &caller);
            let (kept, state) = library::restore(core, of, asked.revision)?;
            Ok(RestoreWorldResponse { kept: Some(message(&kept)), world: Some(checked(&state.world, &state.report)) })
        })
        .await
    }

    async fn list_world_revisions(
        &self,
        request: Request<ListWorldRevisionsRequest>,
    ) -> Answer<ListWorldRevisionsResponse> {
        let caller = caller(&request);
        let mut asked = request.into_inner();
        let (size, token) = (std::mem::take(&mut asked.page_size), std::mem::take(&mut asked.page_token));
        let page = Page::new(size, &token, &asked)?;
        self.lookup(move |core| {
            let kept = library::get(core, &asked.world_id, &caller)?;
            let (found, next_page_token) = page.cut(library::revisions(core, &kept)?);
            let entry = |r: library::Revision| WorldRevision {
                revision: r.number,
                label: r.label,
                created_at: Some(timestamp(r.created_ms)),
            };
            Ok(ListWorldRevisionsResponse { revisions: found.into_iter().map(entry).collect(), next_page_token })
        })
        .await
    }

    async fn duplicate_world(&self, request: Request<DuplicateWorldRequest>) -> Answer<DuplicateWorldResponse> {
        let caller = caller(&request);
        let id = request.get_ref().request_id.clone();
        self.change("DuplicateWorld", request, id, move |core, asked: DuplicateWorldRequest, once| {
            let original = library::get(core, &asked.world_id, &caller)?;
            let state = library::state(core, &original, original.revision)?;
            let title = if asked.title.is_empty() { original.title } else { asked.title };
            let label = format!("copy of {}", original.id);
            let kept = library::create(core, &caller.name, title, label, &state, |kept, batch| {
                once.also(core, &DuplicateWorldResponse { kept: Some(message(kept)) }, batch);
            })?;
            Ok(DuplicateWorldResponse { kept: Some(message(&kept)) })
        })
        .await
    }

    async fn delete_world(&self, request: Request<DeleteWorldRequest>) -> Answer<DeleteWorldResponse> {
        let caller = caller(&request);
        self.change("DeleteWorld", request, NO_ID.into(), move |core, asked: DeleteWorldRequest, _| {
            library::delete(core, (&asked.world_id, &asked.etag, &caller))?;
            Ok(DeleteWorldResponse {})
        })
        .await
    }
}

/// Reads a world and judges it.
fn judged(core: &Core, world: WorldMessage) -> Result<State, Status> {
    let world: World = document("world", Some(world))?;
    let report = report(core, &world)?;
    Ok(State { world, report })
}

fn message(kept: &Kept) -> KeptWorld {
    KeptWorld {
        world_id: kept.id.clone(),
        title: kept.title.clone(),
        etag: kept.etag(),
        revision: kept.revision,
        sound: kept.sound,
        room_count: u32::try_from(kept.rooms).unwrap_or(u32::MAX),
        created_at: Some(timestamp(kept.created_ms)),
        updated_at: Some(timestamp(kept.updated_ms)),
    }
}
