//! How well assets of the shipped library are found: own questions in English and German, and those of the open set
//! where it is there. With the transformer too, where `ORT_DYLIB_PATH` and `D3DGEN_MODEL_DIR` name one.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use d3dgen_assets::annotation::Annotation;
use d3dgen_assets::catalog::Catalog;
use d3dgen_assets::library::Library;
use d3dgen_assets::search::{AssetIndex, Assets, SearchQuery, document};
use d3dgen_assets::{Error, words};
use d3dgen_model::domain::Domain;
use d3dgen_plugins::{Plugin, Registry};
use d3dgen_store::embed::{Embedder, StaticTable};
use d3dgen_store::index::Watch;
use serde_json::Value;

struct Shipped(Catalog);

impl Assets for Shipped {
    fn annotation(&self, key: &str) -> Result<Option<Annotation>, Error> {
        Ok(Library::new(&self.0).get(key).map(|a| a.annotation(&self.0)))
    }
}

struct Bench {
    shipped: Shipped,
    index: AssetIndex,
}

impl Bench {
    fn new(embedder: Arc<dyn Embedder>) -> Self {
        let registry = Registry::builtin();
        let domains: Vec<&Domain> = registry.iter().map(Plugin::domain).collect();
        let catalog = Catalog::new(domains);
        let documents: Vec<_> = Library::new(&catalog)
            .assets()
            .map(|a| {
                let annotation = a.annotation(&catalog);
                document(&annotation.asset_id, &annotation, &catalog)
            })
            .collect();
        let index = AssetIndex::in_memory(embedder, documents, Watch::nobody()).expect("an index");
        Self { shipped: Shipped(catalog), index }
    }

    /// Returns one over the place of the first object that is right.
    fn reciprocal_rank(&self, question: &str, right: &BTreeSet<String>) -> f64 {
        let query = SearchQuery { text: question.into(), limit: 50, one_per_object: true, ..SearchQuery::default() };
        let found = self.index.search(&query, &self.shipped.0, &self.shipped).expect("an answer");
        let objects: Vec<&str> = found.iter().filter_map(|f| f.annotation.object.as_deref()).collect();
        let place = objects.iter().position(|o| right.contains(*o));
        if place != Some(0) {
            println!(
                "  {:?} {question:?}: {:?}, right are {right:?}",
                place.map(|p| p + 1),
                &objects[..objects.len().min(4)]
            );
        }
        place.map_or(0.0, |p| 1.0 / (p as f64 + 1.0))
    }

    fn own(&self) -> Vec<f64> {
        let questions: Vec<Value> =
            include_str!("questions.jsonl").lines().map(|l| serde_json::from_str(l).expect("JSON")).collect();
        assert!(questions.len() >= 80);
        let mut ranks = Vec::new();
        for question in &questions {
            let right: BTreeSet<String> = serde_json::from_value(question["rel"].clone()).expect("object ids");
            let unknown: Vec<&String> = right.iter().filter(|o| self.shipped.0.object(o).is_none()).collect();
            assert!(unknown.is_empty(), "{unknown:?}");
            ranks.push(self.reciprocal_rank(question["q"].as_str().expect("a text"), &right));
        }
        ranks
    }

    /// Returns the ranks of the questions of the open set whose answers the library has: an object is right when it
    /// goes by the name of a right answer.
    fn open(&self) -> Option<Vec<f64>> {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/embedder/retrieval_open.json");
        let Ok(text) = std::fs::read_to_string(file) else {
            println!("skipped: the open set of questions is not here");
            return None;
        };
        let set: Value = serde_json::from_str(&text).expect("JSON");
        let mut ranks = Vec::new();
        for question in set["queries"].as_array().expect("a list") {
            let names: Vec<String> = serde_json::from_value(question["rel"].clone()).expect("names");
            let meant = names.iter().flat_map(|n| self.shipped.0.match_name(&words::split(n)));
            let right: BTreeSet<String> =
                meant.filter(|m| m.coverage > 0.99).map(|m| m.object.object_id.clone()).collect();
            if right.is_empty() {
                println!("  the library has none of {names:?}");
                continue;
            }
            ranks.push(self.reciprocal_rank(question["q"].as_str().expect("a text"), &right));
        }
        Some(ranks)
    }
}

/// Reciprocal ranks of own and of open questions.
#[derive(Debug)]
struct Ranks {
    own: Vec<f64>,
    open: Option<Vec<f64>>,
}

impl Ranks {
    fn mean(&self) -> f64 {
        mean(&[self.own.as_slice(), self.open.as_deref().unwrap_or_default()].concat())
    }
}

fn mean(ranks: &[f64]) -> f64 {
    ranks.iter().sum::<f64>() / ranks.len() as f64
}

fn check(embedder: Arc<dyn Embedder>) -> Ranks {
    let name = embedder.id().to_owned();
    let bench = Bench::new(embedder);
    println!("own questions:");
    let own = bench.own();
    println!("open questions:");
    let open = bench.open();
    let (of_own, of_open) = (mean(&own), open.as_deref().map(mean));
    println!("{name}: mean reciprocal rank {of_own:.3} of own questions, {of_open:.3?} of the open ones");
    Ranks { own, open }
}

#[test]
fn questions_find_their_objects_with_the_table() {
    let ranks = check(Arc::new(StaticTable::new()));
    assert!(mean(&ranks.own) >= 0.75);
    assert!(ranks.open.is_none_or(|open| mean(&open) >= 0.75));
}

#[cfg(feature = "fastembed")]
#[test]
fn questions_find_their_objects_no_worse_with_the_transformer() {
    use d3dgen_store::embed::{Ensemble, Transformer, TransformerFiles};
    let path = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(std::path::PathBuf::from);
    let Some((runtime, model_dir)) = path("ORT_DYLIB_PATH").zip(path("D3DGEN_MODEL_DIR")) else {
        println!("skipped: ORT_DYLIB_PATH and D3DGEN_MODEL_DIR are not both set");
        return;
    };
    let transformer = Transformer::load(&TransformerFiles { runtime, model_dir }).expect("it loads");
    let both = check(Arc::new(Ensemble::of_table_and(Arc::new(transformer))));
    let table = check(Arc::new(StaticTable::new()));
    assert!(both.mean() >= table.mean(), "{both:?} against {table:?}");
}
