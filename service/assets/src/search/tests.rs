//! Questions over the shipped library.

use d3dgen_store::embed::StaticTable;

use super::*;
use crate::library::Library;
use crate::sample;

struct Shipped;

impl Assets for Shipped {
    fn annotation(&self, key: &str) -> Result<Option<Annotation>, Error> {
        let catalog = sample::catalog();
        Ok(Library::new(catalog).get(key).map(|a| a.annotation(catalog)))
    }
}

fn index() -> AssetIndex {
    let catalog = sample::catalog();
    let documents = Library::new(catalog).assets().map(|a| {
        let annotation = a.annotation(catalog);
        document(&annotation.asset_id, &annotation, catalog)
    });
    AssetIndex::in_memory(Arc::new(StaticTable::new()), documents, Watch::nobody()).expect("an index")
}

fn ask(index: &AssetIndex, text: &str) -> Vec<Found> {
    let query = SearchQuery { text: text.into(), limit: 10, one_per_object: true, ..SearchQuery::default() };
    index.search(&query, sample::catalog(), &Shipped).expect("an answer")
}

#[test]
fn conditions_in_the_question_hold() {
    let index = index();
    let found = ask(&index, "cupboard height<1.0");
    assert!(!found.is_empty() && found.iter().all(|f| f.annotation.size_m[2] <= 1.0));
    let found = ask(&index, "mirror mount=wall");
    assert!(found.iter().all(|f| f.annotation.mount == d3dgen_model::domain::Mount::Wall));
    assert!(found[0].reasons.iter().any(|r| r.contains("is called mirror")), "{:?}", found[0].reasons);
    let query = SearchQuery { text: "height<0".into(), limit: 3, ..SearchQuery::default() };
    assert_eq!(index.search(&query, sample::catalog(), &Shipped).expect("none"), []);
    let all = SearchQuery { limit: 5000, one_per_object: true, ..SearchQuery::default() };
    let listed = index.search(&all, sample::catalog(), &Shipped).expect("everything");
    assert_eq!(listed.len(), sample::catalog().objects().len());
}

#[test]
fn size_room_and_likeness_count() {
    let index = index();
    let catalog = sample::catalog();
    let sized = SearchQuery {
        text: "meeting table".into(),
        size_m: Some([2.6, 1.2, 0.74]),
        limit: 1,
        ..SearchQuery::default()
    };
    let found = index.search(&sized, catalog, &Shipped).expect("an answer");
    assert!(found[0].annotation.size_m[0] > 2.0, "{}", found[0].annotation.asset_id);
    let bed = Library::new(catalog).get("Hospital/HospitalBed").expect("shipped").annotation(catalog);
    let query = SearchQuery { limit: 5, one_per_object: true, ..SearchQuery::default() };
    let like = index.like(&bed, &query, catalog, &Shipped).expect("an answer");
    assert_eq!(like.len(), 5);
    assert!(like.iter().all(|f| f.annotation.asset_id != bed.asset_id));
    assert!(like.iter().filter(|f| f.annotation.kind == "bed").count() >= 3, "{like:#?}");
}
