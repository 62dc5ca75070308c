//! Whether questions in six languages find the rules that answer them: mean reciprocal rank over questions that were
//! written before the words were.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use d3dgen_knowledge::database::{Answer, Database, Provenance, SearchQuery, Searcher};
use d3dgen_knowledge::glossary::Glossary;
use d3dgen_knowledge::jurisdiction;
use d3dgen_model::knowledge::Constraint;
use d3dgen_plugins::Registry;
use d3dgen_store::Options;
use d3dgen_store::embed::StaticTable;
use d3dgen_store::index::Watch;
use serde_json::Value;

/// What the sixty questions must reach.
const LEAST: f64 = 0.8;
/// How many rules are looked at.
const LIMIT: usize = 10;

/// The shipped rules with their index, and the words of the shipped domains.
struct Desk {
    _folder: tempfile::TempDir,
    searcher: Searcher,
    glossary: Glossary,
}

impl Desk {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let database =
            Database::open_or_create(&folder.path().join("store"), &Options::default()).expect("a new store");
        let registry = Registry::builtin();
        let by = Provenance { who: "test".into(), when: "2026-11-27T00:00:00Z".into(), why: "test".into() };
        for plugin in registry.iter() {
            database.import(plugin.knowledge(), false, &by).expect("stored");
        }
        let searcher = Searcher::open(&database, Arc::new(StaticTable::new()), Watch::nobody()).expect("an index");
        let glossary = Glossary::of(registry.iter().map(|p| p.domain()));
        Self { _folder: folder, searcher, glossary }
    }

    fn ask(&self, text: &str, country: Option<&str>) -> Answer {
        let places: BTreeSet<String> = jurisdiction::chain(country).into_iter().collect();
        let filters = country.map(|_| ("jurisdiction".to_owned(), places)).into_iter().collect();
        let query = SearchQuery { text: text.into(), filters, limit: LIMIT, ..SearchQuery::default() };
        self.searcher.answer(&query, &self.glossary).expect("an answer")
    }

    /// Returns the mean of one over the rank of the first right rule.
    fn mean_reciprocal_rank(&self, file: &str) -> f64 {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/questions").join(file);
        let text = fs::read_to_string(path).expect("the file is there");
        let mut ranks = Vec::new();
        for question in text.lines().map(|line| serde_json::from_str::<Value>(line).expect("each line is JSON")) {
            let words = question["words"].as_str().expect("each has words");
            let found = self.ask(words, question["country"].as_str()).found;
            let gold: Vec<&str> =
                question["gold"].as_array().expect("a list").iter().flat_map(|g| g.as_str()).collect();
            let named = |i: usize| format!("{}:{}", found[i].constraint.space_type, found[i].constraint.name);
            let rank = (0..found.len()).find(|&i| gold.iter().any(|g| is_like(&named(i), g)));
            if rank != Some(0) {
                let first = (0..found.len().min(4)).map(named).collect::<Vec<_>>().join(", ");
                println!("{:?} {words} ({}): {first}", rank.map(|r| r + 1), question["country"]);
            }
            ranks.push(rank.map_or(0.0, |r| 1.0 / (r as f64 + 1.0)));
        }
        ranks.iter().sum::<f64>() / ranks.len() as f64
    }
}

fn is_corridor(c: &Constraint) -> bool {
    ["corridor", "hallway"].contains(&c.space_type.as_str()) || c.name.contains("corridor")
}

/// Returns whether a name is of a pattern in which `*` stands for anything.
fn is_like(name: &str, pattern: &str) -> bool {
    let Some((head, rest)) = pattern.split_once('*') else { return name == pattern };
    let Some(left) = name.strip_prefix(head) else { return false };
    rest.is_empty() || left.char_indices().map(|c| c.0).chain([left.len()]).any(|at| is_like(&left[at..], rest))
}

#[test]
fn questions_in_six_languages_find_their_rules() {
    let desk = Desk::new();
    let rank = desk.mean_reciprocal_rank("sixty.jsonl");
    let fresh = desk.mean_reciprocal_rank("thirty.jsonl");
    println!("mean reciprocal rank {rank:.3}, and {fresh:.3} on questions that nothing was made for");
    assert!(rank >= LEAST && fresh >= LEAST, "{rank:.3} {fresh:.3}");
}

#[test]
fn an_answer_is_of_the_country_asked_first_and_has_each_rule_once() {
    let desk = Desk::new();
    for (words, country) in [("couloir", "FR"), ("largeur minimale d'un couloir", "FR"), ("走廊宽度", "CN")] {
        let found = desk.ask(words, Some(country)).found;
        assert_eq!(found.first().map(|f| f.jurisdiction.as_str()), Some(country), "{words}");
        let others: Vec<_> = found.iter().map(|f| &f.constraint).filter(|c| !is_corridor(c)).collect();
        assert!(others.is_empty(), "{words}: {others:?}");
    }
    let found = desk.ask("egress door width by persons", Some("AT")).found;
    let named: Vec<String> =
        found.iter().map(|f| format!("{} {} {:?}", f.jurisdiction, f.constraint.name, f.constraint.value)).collect();
    assert_eq!(named.iter().collect::<BTreeSet<_>>().len(), named.len(), "{named:?}");
}

#[test]
fn what_is_not_understood_is_said_and_not_answered() {
    let desk = Desk::new();
    for words in ["szerokość korytarza", "larghezza delle scale", "ширина коридора", "qwertz uiop"] {
        let answer = desk.ask(words, Some("DE"));
        let note = answer.note.unwrap_or_default();
        assert!(answer.found.is_empty() && note.starts_with("not understood"), "{words}: {note}");
    }
    let named = desk.ask("DIN 18040-2", Some("DE"));
    assert!(named.found.iter().all(|f| f.source.as_ref().is_some_and(|s| s.title.contains("18040"))));
    assert!(!named.found.is_empty());
    // understood, and no rule of the place speaks of it
    assert_eq!(desk.ask("slope of a ramp", Some("JP")).note, None);
}
