//! The way of a client through the services: look, search, make, pin, edit, check, export, change and take back.

use d3dgen_proto::v1::amend_knowledge_request::Change;
use d3dgen_proto::v1::fact::Kind;
use d3dgen_proto::v1::generate_world_request::Start;
use d3dgen_proto::v1::generate_world_response::Event;
use d3dgen_proto::v1::world_edit::Edit;
use d3dgen_proto::v1::{
    AmendKnowledgeRequest, AnyOf, AssembleWorldRequest, BuildingRequest, CheckWorldRequest, CheckedWorld, DomainFile,
    EditWorldRequest, ExportBatchRequest, ExportWorldRequest, GenerateBatchRequest, GenerateBriefRequest,
    GenerateFloorplanRequest, GeneratePlacementsRequest, GenerateScenarioRequest, GenerateSceneGraphRequest,
    GenerateWorldRequest, GetBatchWorldRequest, GetDomainRequest, ImportFloorplanRequest, JobState,
    ListBatchWorldsRequest, ListConstraintFiltersRequest, ListDomainsRequest, ListExportersRequest, ListJobLogsRequest,
    LockUpdate, ObjectMove, ParseDomainRequest, RegisterDomainRequest, RemoveDomainRequest, RetrieveConstraintsRequest,
    RoomAddition, RuleSentence, SearchAssetsRequest, SearchConstraintsRequest, SimulateWorldRequest,
    UndoKnowledgeChangeRequest, WorldEdit,
};
use tonic::Code;
use tonic_types::StatusExt;

use crate::support::{Clients, Server, code, flat};

/// Makes a world and returns it with the names of the events.
async fn make(c: &mut Clients, asked: GenerateWorldRequest) -> (CheckedWorld, Vec<&'static str>) {
    let mut stream = c.worlds.generate_world(asked).await.expect("a stream").into_inner();
    let (mut events, mut last, mut fraction, mut steepest) = (Vec::new(), None, 0.0, 0.0);
    while let Some(news) = stream.message().await.expect("news") {
        let progress = news.progress.expect("progress").fraction;
        assert!(progress >= fraction, "progress falls from {fraction} to {progress}");
        steepest = f64::max(steepest, progress - fraction);
        fraction = progress;
        events.push(match news.event {
            Some(Event::SceneGraph(_)) => "scene_graph",
            Some(Event::Floorplan(_)) => "floorplan",
            Some(Event::Placements(_)) => "placements",
            Some(Event::Scenario(_)) => "scenario",
            Some(Event::World(world)) => {
                last = Some(world);
                "world"
            }
            Some(Event::Rejected(_)) => "rejected",
            None => continue,
        });
    }
    assert!((fraction - 1.0).abs() < 1e-9, "ends at {fraction}");
    assert!(steepest < 0.35, "progress jumps by {steepest}");
    (last.expect("a world"), events)
}

#[tokio::test(flavor = "multi_thread")]
async fn worlds_are_made_pinned_edited_and_written() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::start(&dir.path().join("data"), &[]);
    let mut c = Clients::of(&server).await;
    let start = |seed| GenerateWorldRequest { start: flat(seed).map(Start::Building), ..Default::default() };
    let (made, events) = make(&mut c, start(3)).await;
    assert_eq!(events.first(), Some(&"scene_graph"));
    assert_eq!(events.last(), Some(&"world"));
    assert!(events.iter().filter(|e| **e == "placements").count() > 4, "a room at a time: {events:?}");
    assert_eq!(make(&mut c, start(3)).await.0, made, "the same request gives the same world");
    let world = made.world.expect("a world");
    assert!(made.report.expect("a report").sound);

    // a brief stands in the place of its prompt, edited too
    let prompt = "flat with a kitchen and two bedrooms".to_owned();
    let read = c.worlds.generate_brief(GenerateBriefRequest { prompt }).await.expect("read").into_inner();
    let mut brief = read.brief.expect("a brief");
    for kind in brief.asks.iter_mut().filter_map(|a| a.fact.as_mut()?.kind.as_mut()) {
        let Kind::Rooms(rooms) = kind else { continue };
        if rooms.room.as_ref().is_some_and(|r| r.id.as_deref() == Some("bedroom")) {
            rooms.count.as_mut().expect("a number").n = 3;
        }
    }
    let building = BuildingRequest { prompt: String::new(), brief: Some(brief.clone()), ..flat(3).expect("one") };
    let asked = GenerateSceneGraphRequest { building: Some(building.clone()) };
    let edited = c.worlds.generate_scene_graph(asked).await.expect("rooms").into_inner().scene_graph.expect("rooms");
    assert_eq!(edited.rooms.iter().filter(|r| r.room_type == "bedroom").count(), 3);
    let other = BuildingRequest { prompt: "a ward".into(), ..building };
    let asked = GenerateSceneGraphRequest { building: Some(other) };
    assert_eq!(code(c.worlds.generate_scene_graph(asked).await), Code::InvalidArgument);
    let nothing = GenerateBriefRequest { prompt: " ".into() };
    assert_eq!(code(c.worlds.generate_brief(nothing).await), Code::InvalidArgument);

    // the stages one by one give a world too
    let graph = c.worlds.generate_scene_graph(GenerateSceneGraphRequest { building: flat(3) }).await;
    let scene_graph = graph.expect("rooms").into_inner().scene_graph;
    let asked = GenerateFloorplanRequest { scene_graph: scene_graph.clone(), alternative_count: 3, pinned: None };
    let plans = c.worlds.generate_floorplan(asked).await.expect("plans").into_inner().alternatives;
    assert!(plans.len() > 1 && plans.windows(2).all(|p| p[0].cost <= p[1].cost));
    let floorplan = plans[0].floorplan.clone();
    let asked =
        GeneratePlacementsRequest { scene_graph: scene_graph.clone(), floorplan: floorplan.clone(), pinned: None };
    let placements = c.worlds.generate_placements(asked).await.expect("objects").into_inner().placements;
    let asked = GenerateScenarioRequest {
        scene_graph: scene_graph.clone(),
        floorplan: floorplan.clone(),
        placements: placements.clone(),
        hour: Some("night".into()),
        ..Default::default()
    };
    let nowhen = GenerateScenarioRequest { hour: Some("teatime".into()), ..asked.clone() };
    let refused = c.worlds.generate_scenario(nowhen).await.expect_err("refused");
    assert_eq!(refused.get_details_bad_request().expect("the place").field_violations[0].field, "hour");
    let scenario = c.worlds.generate_scenario(asked).await.expect("a scenario").into_inner().scenario;
    assert_eq!(scenario.as_ref().and_then(|s| s.hour.as_deref()), Some("night"));
    let asked = AssembleWorldRequest { scene_graph, floorplan, placements, scenario, name: Some("by_hand".into()) };
    let assembled = c.worlds.assemble_world(asked.clone()).await.expect("a world").into_inner().world.expect("one");
    assert_eq!(assembled.world.expect("a world").name, "by_hand");
    let escaping = AssembleWorldRequest { name: Some("../x".into()), ..asked };
    assert_eq!(code(c.worlds.assemble_world(escaping).await), Code::InvalidArgument);

    // pin all rooms, make another: the plan stays
    let ids = world.floorplan.as_ref().expect("a plan").rooms.iter().map(|r| r.room_id.clone()).collect();
    let lock = WorldEdit { edit: Some(Edit::Lock(LockUpdate { ids, include_contents: true, locked: true })) };
    let edited = c.worlds.edit_world(EditWorldRequest { world: Some(world.clone()), edits: vec![lock] }).await;
    let pinned = edited.expect("edited").into_inner().world.expect("one").world.expect("a world");
    let again = GenerateWorldRequest {
        start: pinned.scene_graph.clone().map(Start::SceneGraph),
        pinned_floorplan: pinned.floorplan.clone(),
        ..Default::default()
    };
    let (again, _) = make(&mut c, again).await;
    let rooms = |w: &d3dgen_proto::v1::World| w.floorplan.as_ref().expect("a plan").rooms.clone();
    assert_eq!(rooms(&again.world.expect("a world")), rooms(&pinned));

    // a plan that is of another building is refused at its field
    let mut part = pinned.floorplan.clone().expect("a plan");
    part.rooms[0].locked = false;
    let office = BuildingRequest { prompt: "office with 5 rooms".into(), ..Default::default() };
    let start_of_another = Some(Start::Building(office));
    let half = GenerateWorldRequest { start: start_of_another, pinned_floorplan: Some(part.clone()), ..start(3) };
    let mut stream = c.worlds.generate_world(half).await.expect("a stream").into_inner();
    let refused = loop {
        match stream.message().await {
            Ok(news) => assert!(news.expect("refused before the end").progress.is_some()),
            Err(refused) => break refused,
        }
    };
    assert_eq!(refused.code(), Code::InvalidArgument);
    let fields = refused.get_details_bad_request().expect("the place").field_violations;
    assert_eq!(fields[0].field, "pinned_floorplan", "{refused}");
    // of its own building, what is pinned stays and the rest is planned around it
    let asked = GenerateFloorplanRequest {
        scene_graph: pinned.scene_graph.clone(),
        alternative_count: 1,
        pinned: Some(part.clone()),
    };
    let around = c.worlds.generate_floorplan(asked).await.expect("planned").into_inner();
    let around = around.alternatives[0].floorplan.clone().expect("a plan");
    assert_eq!(around.rooms[1..], part.rooms[1..]);

    // an edit with repair: the room stands, nothing but what is said changed, and the world is sound
    let addition = RoomAddition { room_type: "storage".into(), area_m2: Some(4.0), ..Default::default() };
    let more = WorldEdit { edit: Some(Edit::AddedRoom(addition)) };
    let edited = c.worlds.edit_world(EditWorldRequest { world: Some(world.clone()), edits: vec![more] }).await;
    let edited = edited.expect("edited").into_inner();
    let checked = edited.world.expect("judged");
    assert!(checked.report.expect("a report").sound);
    let now = rooms(&checked.world.expect("a world"));
    assert_eq!(now.len(), rooms(&world).len() + 1);
    let unchanged = |r: &&d3dgen_proto::v1::PlanRoom| !edited.changed_room_ids.contains(&r.room_id);
    assert!(now.iter().filter(unchanged).all(|r| rooms(&world).contains(r)));
    let far = ObjectMove { placement_id: "nothing_1".into(), ..Default::default() };
    let far = WorldEdit { edit: Some(Edit::MovedObject(far)) };
    let refused = c.worlds.edit_world(EditWorldRequest { world: Some(world.clone()), edits: vec![far] }).await;
    let fields = refused.expect_err("refused").get_details_bad_request().expect("the place").field_violations;
    assert_eq!(fields[0].field, "edits[0]");

    // an unknown part, and an object moved into a wall
    let lock = WorldEdit { edit: Some(Edit::Lock(LockUpdate { ids: vec!["nothing".into()], ..Default::default() })) };
    let refused = c.worlds.edit_world(EditWorldRequest { world: Some(world.clone()), edits: vec![lock] }).await;
    let fields = refused.expect_err("refused").get_details_bad_request().expect("the place").field_violations;
    assert_eq!(fields[0].field, "edits[0].lock.ids");
    let mut broken = world.clone();
    for placement in &mut broken.placements.as_mut().expect("objects").placements {
        placement.pose.as_mut().expect("a pose").x_m += 50.0;
    }
    let report = c.worlds.check_world(CheckWorldRequest { world: Some(broken.clone()) }).await.expect("judged");
    assert!(!report.into_inner().report.expect("a report").sound);
    let refused = c.worlds.export_world(ExportWorldRequest { world: Some(broken), formats: Vec::new() }).await;
    assert_eq!(code(refused), Code::FailedPrecondition);

    // people and robots, moved
    let asked = SimulateWorldRequest { world: Some(world.clone()), seconds: Some(5.0), ..Default::default() };
    let mut stream = c.worlds.simulate_world(asked.clone()).await.expect("moved").into_inner();
    let mut bytes = Vec::new();
    while let Some(piece) = stream.message().await.expect("a piece") {
        bytes.extend(piece.chunk);
    }
    let archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("an archive");
    let names: Vec<&str> = archive.file_names().collect();
    assert_eq!(names, ["trajectory.json", "walkable.geojson", "metrics.json"]);
    let refused = c.worlds.simulate_world(SimulateWorldRequest { seconds: Some(-1.0), ..asked }).await;
    let fields = refused.expect_err("refused").get_details_bad_request().expect("the place").field_violations;
    assert_eq!(fields[0].field, "seconds");

    // files
    let exporters = c.worlds.list_exporters(ListExportersRequest::default()).await.expect("a list").into_inner();
    let formats = exporters.exporters.into_iter().map(|e| e.name).collect();
    let mut stream =
        c.worlds.export_world(ExportWorldRequest { world: Some(world), formats }).await.expect("files").into_inner();
    let mut bytes = Vec::new();
    while let Some(piece) = stream.message().await.expect("a piece") {
        bytes.extend(piece.chunk);
    }
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("an archive");
    assert!(archive.by_name("plan.svg").is_ok());
    assert!((0..archive.len()).all(|i| archive.by_index(i).expect("a file").enclosed_name().is_some()));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_brought_plan_is_furnished_as_it_is() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::start(&dir.path().join("data"), &[]);
    let mut c = Clients::of(&server).await;
    let plans = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../plans/tests/plans");
    let file = |name: &str| std::fs::read(plans.join(name)).expect("a plan");
    let asked = |name: &str| ImportFloorplanRequest {
        file_name: name.into(),
        content: file(name),
        country: Some("Germany".into()),
        robot_kinds: vec!["cleaning".into()],
        seed: 5,
        ..Default::default()
    };
    let brought = c.worlds.import_floorplan(asked("flat.geojson")).await.expect("read").into_inner();
    let graph = brought.scene_graph.expect("rooms");
    assert_eq!((graph.domain_id.as_str(), graph.seed, graph.robots.len()), ("residential", 5, 1));
    let again = GenerateWorldRequest {
        start: Some(Start::SceneGraph(graph)),
        pinned_floorplan: brought.floorplan.clone(),
        ..Default::default()
    };
    let (made, _) = make(&mut c, again).await;
    let world = made.world.expect("a world");
    let outlines = |plan: &Option<d3dgen_proto::v1::Floorplan>| {
        plan.as_ref().expect("a plan").rooms.iter().map(|r| r.polygon.clone()).collect::<Vec<_>>()
    };
    assert_eq!(outlines(&world.floorplan), outlines(&brought.floorplan));
    assert!(world.placements.expect("furniture").placements.len() > 20);

    // a map needs its picture
    let map = ImportFloorplanRequest { domain_id: Some("residential".into()), ..asked("flat_map.yaml") };
    let refused = c.worlds.import_floorplan(map.clone()).await.expect_err("no picture");
    assert!(refused.message().contains("flat_map.pgm"), "{refused}");
    let companions = [("flat_map.pgm".to_owned(), file("flat_map.pgm"))].into();
    let traced = c.worlds.import_floorplan(ImportFloorplanRequest { companions, ..map }).await;
    assert!(traced.expect("traced").into_inner().floorplan.expect("a plan").rooms.len() > 2);

    // refusals name the place
    let torn = ImportFloorplanRequest { content: b"{".to_vec(), ..asked("flat.geojson") };
    let attic = [("Attic".to_owned(), "bedroom".to_owned())].into();
    let attic = ImportFloorplanRequest { room_types: attic, ..asked("flat.geojson") };
    for (request, words) in [(torn, "geojson"), (attic, "Attic"), (ImportFloorplanRequest::default(), "empty")] {
        let refused = c.worlds.import_floorplan(request).await.expect_err(words);
        assert_eq!(refused.code(), Code::InvalidArgument);
        let fields = refused.get_details_bad_request().expect("the place").field_violations;
        assert!(fields[0].field == "content" && refused.message().contains(words), "{refused}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn rules_and_assets_are_found_changed_and_changed_back() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::start(&dir.path().join("data"), &[]);
    let mut c = Clients::of(&server).await;
    let ask = |query: &str, filters| SearchConstraintsRequest {
        query: query.into(),
        filters,
        page_size: 3,
        ..Default::default()
    };
    let german = [("jurisdiction".to_owned(), AnyOf { values: vec!["DE".into()] })];
    let found = c.knowledge.search_constraints(ask("corridor width", german.clone().into())).await.expect("found");
    let found = found.into_inner();
    assert!(found.constraints.len() == 3 && found.constraints.iter().all(|f| f.jurisdiction == "DE"));
    assert!(!found.constraints[0].sources.is_empty());
    let next = SearchConstraintsRequest {
        page_token: found.next_page_token.clone(),
        ..ask("corridor width", german.clone().into())
    };
    let next = c.knowledge.search_constraints(next).await.expect("more").into_inner();
    assert!(next.constraints.iter().all(|f| !found.constraints.contains(f)));
    let foreign = SearchConstraintsRequest { page_token: found.next_page_token, ..ask("doors", german.into()) };
    assert_eq!(code(c.knowledge.search_constraints(foreign).await), Code::InvalidArgument);
    let wrong = [("nothing".to_owned(), AnyOf::default())];
    assert_eq!(code(c.knowledge.search_constraints(ask("", wrong.into())).await), Code::InvalidArgument);
    let filters = c.knowledge.list_constraint_filters(ListConstraintFiltersRequest::default()).await.expect("a list");
    assert!(filters.into_inner().filters.iter().any(|f| f.name == "topic" && !f.counts.is_empty()));

    let rooms = RetrieveConstraintsRequest {
        domain_id: Some("hospital".into()),
        country_code: Some("DE".into()),
        room_labels: vec!["patient room".into(), "corridor".into()],
        ..Default::default()
    };
    let width = |answer: d3dgen_proto::v1::RetrieveConstraintsResponse| {
        answer.limits.and_then(|l| l.corridor_width_m).map(|l| l.value)
    };
    let before = width(c.knowledge.retrieve_constraints(rooms.clone()).await.expect("rules").into_inner());
    let amend = AmendKnowledgeRequest {
        domain_id: "hospital".into(),
        change: Some(Change::Sentence(RuleSentence {
            text: "corridors are at least 3.1 m wide".into(),
            language: None,
        })),
        request_id: "amend-1".into(),
        ..Default::default()
    };
    let changed = c.knowledge.amend_knowledge(amend.clone()).await.expect("changed").into_inner();
    let repeated = c.knowledge.amend_knowledge(amend.clone()).await.expect("the same answer").into_inner();
    assert_eq!(changed, repeated);
    let other = AmendKnowledgeRequest { why: "another".into(), ..amend };
    assert_eq!(code(c.knowledge.amend_knowledge(other).await), Code::InvalidArgument);
    let after = width(c.knowledge.retrieve_constraints(rooms.clone()).await.expect("rules").into_inner());
    assert!(after == Some(3.1) && before != after, "{before:?} {after:?}");
    let seq = changed.change.expect("a change").seq;
    let undo = UndoKnowledgeChangeRequest { seq, ..Default::default() };
    c.knowledge.undo_knowledge_change(undo.clone()).await.expect("undone");
    assert_eq!(code(c.knowledge.undo_knowledge_change(undo).await), Code::FailedPrecondition);
    assert_eq!(width(c.knowledge.retrieve_constraints(rooms).await.expect("rules").into_inner()), before);

    let asked = SearchAssetsRequest { query: "office chair".into(), page_size: 5, ..Default::default() };
    let assets = c.assets.search_assets(asked).await.expect("found").into_inner().assets;
    assert!(assets.iter().any(|a| a.asset.as_ref().expect("one").kind == "chair"));
}

#[tokio::test(flavor = "multi_thread")]
async fn domains_come_and_go_while_others_work() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::start(&dir.path().join("data"), &[]);
    let mut c = Clients::of(&server).await;
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../domains/school");
    let files = std::fs::read_dir(folder).expect("shipped").map(|entry| {
        let path = entry.expect("a file").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).expect("text");
        DomainFile { content: text.replace("\"school\"", "\"academy\"").into_bytes(), name }
    });
    let files: Vec<DomainFile> = files.filter(|f| f.name.ends_with(".toml") || f.name == "knowledge.json").collect();
    let parsed = c.domains.parse_domain(ParseDomainRequest { files }).await.expect("parsed").into_inner();
    assert_eq!(parsed.problems, []);
    let register = RegisterDomainRequest {
        manifest: parsed.manifest,
        knowledge_base: parsed.knowledge_base,
        request_id: "register-1".into(),
        ..Default::default()
    };
    let first = c.domains.register_domain(register.clone()).await.expect("registered").into_inner();
    assert_eq!(first.domain.as_ref().expect("one").domain_version, 1);
    assert_eq!(c.domains.register_domain(register.clone()).await.expect("the same").into_inner(), first);
    let mut building = flat(1).expect("one");
    building.domain_id = Some("academy".into());
    building.prompt = "a school with four classrooms".into();
    let asked = GenerateSceneGraphRequest { building: Some(building) };
    let graph = c.worlds.generate_scene_graph(asked.clone()).await.expect("at once").into_inner();
    assert_eq!(graph.scene_graph.expect("rooms").domain_id, "academy");

    // a broken one, a shipped one, a stale one: nothing changes
    let edit = |change: &dyn Fn(&mut RegisterDomainRequest)| {
        let mut asked = RegisterDomainRequest { request_id: String::new(), ..register.clone() };
        change(&mut asked);
        asked
    };
    let wrong = edit(&|r| r.manifest.as_mut().expect("one").room_types[0].area_m2.as_mut().expect("one").min_m2 = -5.0);
    let refused = c.domains.register_domain(wrong).await.expect_err("refused");
    assert_eq!(refused.code(), Code::InvalidArgument);
    let fields = refused.get_details_bad_request().expect("the place").field_violations;
    assert!(fields.iter().any(|f| f.field.starts_with("manifest.room_types[0].area_m2")), "{fields:?}");
    let shipped = edit(&|r| {
        r.manifest.as_mut().expect("one").domain_id = "school".into();
        r.knowledge_base = None;
    });
    assert_eq!(code(c.domains.register_domain(shipped).await), Code::AlreadyExists);
    let stale = edit(&|r| r.expected_version = Some(0));
    assert_eq!(code(c.domains.register_domain(stale).await), Code::Aborted);
    for id in ["../academy", "a/b", "", "ACADEMY"] {
        let wrong = edit(&|r| r.manifest.as_mut().expect("one").domain_id = id.into());
        assert_eq!(code(c.domains.register_domain(wrong).await), Code::InvalidArgument, "{id}");
        let get = GetDomainRequest { domain_id: id.into(), ..Default::default() };
        assert_eq!(code(c.domains.get_domain(get).await), Code::InvalidArgument, "{id}");
    }
    let listed = c.domains.list_domains(ListDomainsRequest::default()).await.expect("a list").into_inner().domains;
    assert!(listed.iter().any(|d| d.domain_id == "academy" && !d.shipped && d.domain_version == 1));
    let remove = |id: &str| RemoveDomainRequest { domain_id: id.into(), request_id: String::new() };
    assert_eq!(code(c.domains.remove_domain(remove("school")).await), Code::FailedPrecondition);
    c.domains.remove_domain(remove("academy")).await.expect("removed");
    assert_eq!(code(c.domains.remove_domain(remove("academy")).await), Code::NotFound);
    assert_eq!(code(c.worlds.generate_scene_graph(asked).await), Code::InvalidArgument);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_batch_runs_as_a_job() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = Server::start(&dir.path().join("data"), &[]);
    let mut c = Clients::of(&server).await;
    let asked = GenerateBatchRequest { building: flat(10), world_count: 3, request_id: "batch-1".into() };
    let job = c.worlds.generate_batch(asked.clone()).await.expect("started").into_inner().job.expect("a job");
    let again = c.worlds.generate_batch(asked).await.expect("the same").into_inner().job.expect("a job");
    assert_eq!(job.job_id, again.job_id);
    let ended = c.ended(&job.job_id).await;
    assert_eq!(ended.state, JobState::Succeeded as i32, "{ended:?}");
    let list = ListBatchWorldsRequest { job_id: job.job_id.clone(), page_size: 2, page_token: String::new() };
    let worlds = c.worlds.list_batch_worlds(list).await.expect("a list").into_inner();
    assert_eq!(worlds.worlds.iter().map(|w| w.seed).collect::<Vec<_>>(), [10, 11]);
    let get = |seed| GetBatchWorldRequest { job_id: job.job_id.clone(), seed };
    let world = c.worlds.get_batch_world(get(12)).await.expect("there").into_inner().world.expect("one");
    assert!(world.report.expect("a report").sound);
    assert_eq!(code(c.worlds.get_batch_world(get(13)).await), Code::NotFound);

    // all of them, and one of them, in an archive with a folder for each
    let export = |seeds: &[u64]| ExportBatchRequest {
        job_id: job.job_id.clone(),
        seeds: seeds.to_vec(),
        formats: vec!["plan".into()],
    };
    for (seeds, expected) in [(&[][..], &[10, 11, 12][..]), (&[11], &[11])] {
        let mut stream = c.worlds.export_batch(export(seeds)).await.expect("files").into_inner();
        let mut bytes = Vec::new();
        while let Some(piece) = stream.message().await.expect("a piece") {
            bytes.extend(piece.chunk);
        }
        let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("an archive");
        for seed in 10..13 {
            for file in ["world.json", "report.json", "plan.svg"] {
                let is_there = archive.by_name(&format!("world-{seed}/{file}")).is_ok();
                assert_eq!(is_there, expected.contains(&seed), "{file} of {seed}");
            }
        }
    }
    assert_eq!(code(c.worlds.export_batch(export(&[13])).await), Code::NotFound);
    for id in ["../../etc", "job-99999999", ""] {
        let get = GetBatchWorldRequest { job_id: id.into(), seed: 1 };
        assert_eq!(code(c.worlds.get_batch_world(get).await), Code::NotFound, "{id}");
    }
    let logs = ListJobLogsRequest { job_id: job.job_id, ..Default::default() };
    assert!(!c.jobs.list_job_logs(logs).await.expect("a log").into_inner().logs.is_empty());
}
