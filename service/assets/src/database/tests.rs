//! Assets going in, coming out and going away.

use std::collections::BTreeSet;
use std::sync::Arc;

use d3dgen_store::embed::StaticTable;
use d3dgen_store::index::Watch;
use tempfile::TempDir;

use super::*;
use crate::annotation::Origin;
use crate::library::Library;
use crate::measure::tests::boxes;
use crate::sample;
use crate::search::SearchQuery;

fn by(why: &str) -> Provenance {
    Provenance { who: "tester".into(), when: "2026-11-21T00:00:00Z".into(), why: why.into() }
}

fn fresh() -> (TempDir, Database) {
    let dir = tempfile::tempdir().expect("a folder");
    let database = Database::open_or_create(&dir.path().join("store"), &Options::default()).expect("a new store");
    (dir, database)
}

fn asset(path: &str, hash: &str, size: f32) -> NewAsset {
    let library = Library::new(sample::catalog());
    let mut annotation = library.get("Residential/DiningChair").expect("shipped").annotation(sample::catalog());
    annotation.asset_id = "Office/Seat".into();
    annotation.name = "Throne of plywood".into();
    annotation.origin = Origin::Ingested { path: path.into(), hash: hash.into() };
    NewAsset::new(annotation, Some(boxes(&[[[0.0; 3], [size; 3]]])), BTreeMap::new())
}

fn verify(database: &Database) -> Vec<Damage> {
    database.verify(&mut |_, _| (), &AtomicBool::new(false)).expect("readable")
}

#[test]
fn what_goes_in_comes_out_and_goes_away() {
    let (_dir, database) = fresh();
    let put = |assets: Vec<NewAsset>| database.put(Kind::Ingest, assets, &by("test")).expect("stored");
    assert_eq!(put(vec![asset("a.glb", "1", 1.0), asset("b.glb", "2", 2.0)]), ["Office/Seat", "Office/Seat_2"]);
    assert_eq!(database.ids().expect("readable"), ["Office/Seat", "Office/Seat_2"]);
    let model = database.model("Office/Seat_2").expect("readable").expect("a file");
    assert_eq!(model, boxes(&[[[0.0; 3], [2.0; 3]]]));
    assert_eq!(put(vec![asset("b.glb", "3", 3.0)]), ["Office/Seat_2"]);
    assert_eq!(database.with_content("2").expect("readable"), Vec::<String>::new());
    assert_eq!(database.with_content("3").expect("readable"), ["Office/Seat_2"]);
    assert_eq!(verify(&database), []);
    let stats = database.stats().expect("readable");
    assert_eq!((stats.assets, stats.paths, stats.changes), (2, 2, 2));
    database.remove(&["Office/Seat_2".into()], &["dining_chair".into()], &by("away")).expect("removed");
    assert_eq!(database.ingested("b.glb").expect("readable"), None);
    assert_eq!((database.get("Office/Seat_2").expect("readable"), verify(&database)), (None, vec![]));
    assert_eq!(database.removed().expect("readable").keys().collect::<Vec<_>>(), ["dining_chair"]);
    database.restore(&["dining_chair".into()], &by("back")).expect("restored");
    assert!(database.removed().expect("readable").is_empty());
    assert_eq!(database.history().expect("readable").len(), 4);
}

#[test]
fn lost_and_left_files_are_noticed() {
    let (_dir, database) = fresh();
    database.put(Kind::Ingest, vec![asset("a.glb", "1", 1.0)], &by("test")).expect("stored");
    let files = files::list(&database.files_dir()).expect("readable");
    let file = database.files_dir().join(&files[0].0[..2]).join(format!("{}.model", files[0].0));
    let stray = file.with_file_name("0000.model");
    std::fs::write(&stray, "x").expect("written");
    assert_eq!(verify(&database).len(), 1);
    std::fs::remove_file(&stray).expect("removed");
    let (picture, kept) = (file.with_extension("png"), database.thumbnail("Office/Seat").expect("readable"));
    let annotation = database.get("Office/Seat").expect("readable").expect("kept");
    let png = kept.expect("a picture");
    assert_eq!(annotation.thumbnail.map(|t| t.sha256), Some(files::digest(&png)));
    assert_eq!(png, std::fs::read(&picture).expect("beside the model"));
    std::fs::write(&picture, "damaged").expect("changed");
    assert!(verify(&database)[0].reason.contains("thumbnail"), "{:?}", verify(&database));
    std::fs::write(&picture, png).and_then(|()| std::fs::write(&file, "damaged")).expect("changed");
    assert!(verify(&database)[0].reason.contains("digest"), "{:?}", verify(&database));
    std::fs::remove_file(&file).expect("removed");
    assert_eq!(verify(&database).len(), 1);
}

#[test]
fn own_assets_and_the_library_are_found_together() {
    let (_dir, database) = fresh();
    database.put(Kind::Ingest, vec![asset("a.glb", "1", 1.0)], &by("test")).expect("stored");
    let ask = |text: &str| {
        let shelf = Shelf::new(Some(database.clone()), sample::catalog()).expect("readable");
        let searcher = Searcher::open(shelf, Arc::new(StaticTable::new()), Watch::nobody()).expect("an index");
        let query = SearchQuery { text: text.into(), limit: 400, one_per_object: true, ..SearchQuery::default() };
        let found = searcher.search(&query).expect("an answer");
        found.into_iter().map(|f| f.annotation.asset_id).collect::<Vec<_>>()
    };
    assert_eq!(ask("throne of plywood")[0], "Office/Seat");
    let chairs = ask("dining chair");
    assert!(chairs[..3].contains(&"Office/Seat".to_owned()) && chairs.contains(&"Residential/DiningChair".to_owned()));
    database.remove(&[], &["dining_chair".into()], &by("no chairs")).expect("removed");
    assert!(!ask("dining chair").contains(&"Residential/DiningChair".to_owned()));
    let shelf = Shelf::new(Some(database.clone()), sample::catalog()).expect("readable");
    let message = shelf.get("Office/Seatt").expect_err("a slip").to_string();
    assert!(message.contains("Office/Seat"), "{message}");
    let mut changed = database.get("Office/Seat").expect("readable").expect("there");
    changed.name = "Stool of iron".into();
    database.annotate(changed, &by("by hand")).expect("changed");
    assert_eq!(ask("stool of iron")[0], "Office/Seat");
}

#[test]
fn an_index_that_changes_finds_what_one_made_anew_finds() {
    let (_dir, database) = fresh();
    let catalog = sample::catalog();
    let shelf = || Shelf::new(Some(database.clone()), catalog).expect("a shelf");
    let anew = |shelf: &Shelf<'_>| shelf.open_index(Arc::new(StaticTable::new()), Watch::nobody()).expect("an index");
    let mut index = anew(&shelf());
    let chair = ["dining_chair".to_owned()];
    let steps: [&dyn Fn() -> Vec<String>; 5] = [
        &|| {
            database.put(Kind::Ingest, vec![asset("a.glb", "1", 1.0), asset("b.glb", "2", 2.0)], &by("in")).expect("in")
        },
        &|| {
            let mut seat = database.get("Office/Seat").expect("readable").expect("kept");
            seat.name = "Pew of oak".into();
            database.annotate(seat, &by("named")).expect("annotated");
            vec!["Office/Seat".into()]
        },
        &|| {
            database
                .remove(&["Office/Seat_2".into()], &chair, &by("away"))
                .map(|()| vec!["Office/Seat_2".into()])
                .expect("away")
        },
        &|| database.remove(&[], &chair, &by("away")).map(|()| chair.to_vec()).expect("away"),
        &|| database.restore(&chair, &by("back")).map(|()| chair.to_vec()).expect("back"),
    ];
    for (n, step) in steps.iter().enumerate() {
        let mut changed = step();
        if n == 2 {
            changed.extend(chair.iter().cloned());
        }
        let shelf = shelf();
        index = shelf.changed_index(&index, &changed).expect("readable").expect("few changes");
        let fresh = anew(&shelf);
        assert_eq!(index.len(), fresh.len(), "step {n}");
        assert_eq!(index.values("object"), fresh.values("object"), "step {n}");
        for text in ["throne of plywood", "pew of oak", "dining chair", "bed", ""] {
            let query = SearchQuery { text: text.into(), limit: 500, ..SearchQuery::default() };
            let ids = |index: &crate::search::AssetIndex| -> BTreeSet<String> {
                let found = index.search(&query, catalog, &shelf).expect("an answer");
                found.into_iter().map(|f| f.annotation.asset_id).collect()
            };
            let first = |index: &crate::search::AssetIndex| {
                let found = index.search(&query, catalog, &shelf).expect("an answer");
                found.first().map(|f| f.annotation.asset_id.clone())
            };
            assert_eq!(ids(&index), ids(&fresh), "step {n}, {text:?}");
            assert_eq!(first(&index), first(&fresh), "step {n}, {text:?}");
        }
    }
}
