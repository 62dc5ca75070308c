//! Kept worlds: their states, who changes them, and their pictures.

use d3dgen_proto::v1::asset_service_client::AssetServiceClient;
use d3dgen_proto::v1::generate_world_response::Event;
use d3dgen_proto::v1::library_service_client::LibraryServiceClient;
use d3dgen_proto::v1::world_service_client::WorldServiceClient;
use d3dgen_proto::v1::{
    CreateWorldRequest, DeleteWorldRequest, DuplicateWorldRequest, GetWorldRequest, KeptWorld,
    ListWorldRevisionsRequest, ListWorldsRequest, ParseWorldRequest, RestoreWorldRequest, SearchAssetsRequest,
    UpdateWorldRequest, World,
};
use tonic::Code;
use tonic::transport::Channel;
use tonic_types::StatusExt;

use crate::page::get;
use crate::support::{SMALL, Server, building};

type Library = LibraryServiceClient<Channel>;

async fn world(server: &Server) -> World {
    let mut worlds = WorldServiceClient::new(server.channel().await);
    let mut events = worlds.generate_world(building(SMALL, 1)).await.expect("begun").into_inner();
    while let Some(event) = events.message().await.expect("an event") {
        if let Some(Event::World(made)) = event.event {
            return made.world.expect("a world");
        }
    }
    panic!("no world came");
}

async fn create(library: &mut Library, world: &World) -> KeptWorld {
    let asked = CreateWorldRequest {
        title: "A flat".into(),
        world: Some(world.clone()),
        label: "made".into(),
        request_id: "once".into(),
    };
    library.create_world(asked).await.expect("kept").into_inner().kept.expect("kept")
}

async fn update(library: &mut Library, kept: &KeptWorld, world: &World) -> Result<KeptWorld, tonic::Status> {
    let asked = UpdateWorldRequest {
        world_id: kept.world_id.clone(),
        etag: kept.etag.clone(),
        world: Some(world.clone()),
        label: "changed".into(),
        ..Default::default()
    };
    Ok(library.update_world(asked).await?.into_inner().kept.expect("kept"))
}

async fn objects(library: &mut Library, kept: &KeptWorld, revision: Option<u64>) -> Result<usize, Code> {
    let asked = GetWorldRequest { world_id: kept.world_id.clone(), revision };
    let got = library.get_world(asked).await.map_err(|s| s.code())?.into_inner();
    let world = got.world.and_then(|w| w.world).expect("a world");
    Ok(world.placements.map_or(0, |p| p.placements.len()))
}

#[tokio::test(flavor = "multi_thread")]
async fn a_world_is_kept_with_its_states_and_changed_by_who_saw_it_last() {
    let server = Server::start(&[]).await;
    let mut library = LibraryServiceClient::new(server.channel().await);
    let first = world(&server).await;
    let all = first.placements.as_ref().map_or(0, |p| p.placements.len());
    let mut second = first.clone();
    let placements = &mut second.placements.as_mut().expect("placements").placements;
    placements.retain(|p| p.support_placement_id.is_none());
    let fewer = placements.len();
    assert!(fewer < all, "something stands on something");

    let kept = create(&mut library, &first).await;
    assert_eq!(create(&mut library, &first).await, kept, "a repeated request is the same world");
    assert!(kept.sound && kept.revision == 1 && kept.title == "A flat");

    let changed = update(&mut library, &kept, &second).await.expect("changed");
    assert_eq!((changed.revision, objects(&mut library, &changed, None).await), (2, Ok(fewer)));
    assert_eq!(objects(&mut library, &changed, Some(1)).await, Ok(all), "the first state is there");
    let refused = update(&mut library, &kept, &first).await.expect_err("seen before the change");
    assert_eq!(refused.code(), Code::Aborted);
    assert!(refused.message().contains(&changed.etag), "{refused}");

    let undo = RestoreWorldRequest { world_id: kept.world_id.clone(), etag: changed.etag.clone(), revision: 1 };
    let undone = library.restore_world(undo).await.expect("undone").into_inner().kept.expect("kept");
    assert_eq!(objects(&mut library, &undone, None).await, Ok(all));
    assert_eq!(objects(&mut library, &undone, Some(2)).await, Ok(fewer), "what was undone can be redone");
    let anew = update(&mut library, &undone, &first).await.expect("changed");
    assert_eq!(objects(&mut library, &anew, Some(2)).await, Ok(all), "what was undone is gone after a change");
    assert_eq!(objects(&mut library, &anew, Some(3)).await, Err(Code::NotFound));
    let asked = ListWorldRevisionsRequest { world_id: kept.world_id.clone(), ..Default::default() };
    let states = library.list_world_revisions(asked).await.expect("states").into_inner().revisions;
    assert_eq!(states.iter().map(|s| s.label.as_str()).collect::<Vec<_>>(), ["made", "changed"]);

    let asked = DuplicateWorldRequest { world_id: kept.world_id.clone(), ..Default::default() };
    let copy = library.duplicate_world(asked).await.expect("copied").into_inner().kept.expect("kept");
    assert!(copy.world_id != kept.world_id && copy.revision == 1);
    let listed = library.list_worlds(ListWorldsRequest::default()).await.expect("listed").into_inner().worlds;
    assert_eq!(listed, [copy.clone(), anew.clone()], "the one changed last first");

    let gone = DeleteWorldRequest { world_id: anew.world_id.clone(), etag: anew.etag.clone() };
    library.delete_world(gone.clone()).await.expect("deleted");
    assert_eq!(library.delete_world(gone).await.expect_err("gone").code(), Code::NotFound);
    assert_eq!(objects(&mut library, &anew, None).await, Err(Code::NotFound));
    assert_eq!(objects(&mut library, &copy, None).await, Ok(all), "a copy stands by itself");
}

#[tokio::test(flavor = "multi_thread")]
async fn only_the_newest_states_are_kept() {
    let server = Server::start(&[]).await;
    let mut library = LibraryServiceClient::new(server.channel().await);
    let world = world(&server).await;
    let mut kept = create(&mut library, &world).await;
    for _ in 0..52 {
        kept = update(&mut library, &kept, &world).await.expect("changed");
    }
    assert_eq!(kept.revision, 53);
    assert_eq!(objects(&mut library, &kept, Some(3)).await, Err(Code::NotFound));
    assert!(objects(&mut library, &kept, Some(4)).await.is_ok());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_document_is_read_as_messages_and_what_is_wrong_in_it_is_said_with_its_place() {
    let server = Server::start(&[]).await;
    let mut library = LibraryServiceClient::new(server.channel().await);
    let refused = |content: &str| ParseWorldRequest { content: content.as_bytes().to_vec() };
    for (content, said) in [("", "content"), ("{}", "version"), ("{\"version\": 1, \"rooms\": []}", "rooms")] {
        let status = library.parse_world(refused(content)).await.expect_err("no world");
        assert_eq!(status.code(), Code::InvalidArgument, "{content}");
        let problems = status.get_details_bad_request().map(|b| b.field_violations).unwrap_or_default();
        let named = problems.iter().any(|p| format!("{} {}", p.field, p.description).contains(said));
        assert!(named, "{content}: {problems:?}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_plan_of_a_kept_world_has_an_address_and_an_etag() {
    let server = Server::start(&[]).await;
    let mut library = LibraryServiceClient::new(server.channel().await);
    let kept = create(&mut library, &world(&server).await).await;
    let path = format!("/worlds/{}/plan.svg", kept.world_id);
    let plan = get(&server, &path, "").await;
    assert!(plan.starts_with("HTTP/1.1 200") && plan.contains("<svg"), "{}", &plan[..200]);
    let tag = format!("if-none-match: \"{}\"\r\n", kept.etag);
    let again = get(&server, &path, &tag).await;
    assert!(again.starts_with("HTTP/1.1 304") && !again.contains("<svg"), "{again}");
    let model = get(&server, &format!("/worlds/{}/world.glb", kept.world_id), "").await;
    assert!(model.starts_with("HTTP/1.1 200") && model.contains("model/gltf-binary") && model.contains("glTF"));
    assert!(get(&server, "/worlds/world_99/plan.svg", "").await.starts_with("HTTP/1.1 404"));
    assert!(get(&server, "/worlds/world_1/../../x", "").await.starts_with("HTTP/1.1 4"));
}

#[tokio::test(flavor = "multi_thread")]
async fn assets_have_a_picture_and_a_model_at_an_address() {
    let server = Server::start(&[]).await;
    let mut assets = AssetServiceClient::new(server.channel().await);
    let asked = SearchAssetsRequest { query: "desk".into(), domain_id: Some("office".into()), ..Default::default() };
    let found = assets.search_assets(asked).await.expect("assets").into_inner().assets;
    let id = found[0].asset.as_ref().expect("one").asset_id.clone();
    for (file, kind, begins) in [("thumbnail.png", "image/png", "PNG"), ("model.glb", "model/gltf-binary", "glTF")] {
        let path = format!("/models/{id}/{file}");
        let whole = get(&server, &path, "").await;
        assert!(whole.starts_with("HTTP/1.1 200") && whole.contains(kind) && whole.contains(begins), "{path}");
        let etag = whole.lines().find_map(|line| line.strip_prefix("etag: ")).expect("an etag").trim().to_owned();
        let again = get(&server, &path, &format!("if-none-match: {etag}\r\n")).await;
        assert!(again.starts_with("HTTP/1.1 304") && !again.contains(begins), "{path}");
    }
    assert!(get(&server, "/models/Common/NoSuchThing/thumbnail.png", "").await.starts_with("HTTP/1.1 404"));
}
