//! The database as its users see it: in, out, changed, undone, searched, damaged.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use d3dgen_model::knowledge::Value;
use d3dgen_store::embed::StaticTable;
use d3dgen_store::index::Watch;

use super::*;
use crate::tests::knowledge;

fn by(why: &str) -> Provenance {
    Provenance { who: "tester".into(), when: "2026-11-21T12:00:00Z".into(), why: why.into() }
}

fn fresh() -> (tempfile::TempDir, Database) {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let database = Database::open_or_create(&dir.path().join("store"), &Options::default()).expect("a new store");
    (dir, database)
}

/// Returns the edit that gives a constraint another figure.
fn edit(knowledge: &KnowledgeBase, id: &str, figure: f64) -> Vec<Edit> {
    let mut after = knowledge.clone();
    let mut all = after.references.iter_mut().flat_map(|r| &mut r.constraints);
    all.find(|c| c.constraint_id == id).expect("the constraint is there").value = Value::Number(figure);
    difference(knowledge, &after, false)
}

fn some_number(knowledge: &KnowledgeBase) -> String {
    let mut all = knowledge.references.iter().flat_map(|r| &r.constraints);
    all.find(|c| matches!(c.value, Value::Number(_))).expect("there is one").constraint_id.clone()
}

#[test]
fn what_goes_in_comes_out() {
    let (_dir, database) = fresh();
    for domain in ["hospital", "office", "residential"] {
        let shipped = knowledge(domain);
        let change = database.import(&shipped, false, &by("test")).expect("stored").expect("new");
        assert_eq!(change.added as usize, shipped.references.len() + count(&shipped));
        assert_eq!(database.knowledge_base(domain).expect("there"), shipped);
        assert_eq!(database.import(&shipped, false, &by("again")).expect("the same"), None);
    }
    assert_eq!(database.domains().expect("readable").len(), 3);
    assert_eq!(database.verify(&mut |_, _| (), &AtomicBool::new(false)).expect("readable"), []);
    let missing = database.knowledge_base("school").expect_err("never imported").to_string();
    assert_eq!(missing, "the database holds no rules of domain `school`; it has hospital, office, residential");
}

fn count(knowledge: &KnowledgeBase) -> usize {
    knowledge.references.iter().map(|r| r.constraints.len()).sum()
}

#[test]
fn an_import_keeps_or_replaces_what_was_there() {
    let (_dir, database) = fresh();
    let whole = knowledge("office");
    let mut part = whole.clone();
    part.references.truncate(3);
    database.import(&whole, false, &by("whole")).expect("stored");
    assert_eq!(database.import(&part, true, &by("part, beside")).expect("stored"), None, "nothing is new in it");
    assert_eq!(database.knowledge_base("office").expect("there"), whole);
    let change = database.import(&part, false, &by("part, instead")).expect("stored").expect("a change");
    assert_eq!((change.added, change.changed), (0, 0));
    assert_eq!(database.knowledge_base("office").expect("there"), part);
    database.undo(change.seq, &by("a mistake")).expect("undone");
    assert_eq!(database.knowledge_base("office").expect("there"), whole);
}

#[test]
fn changes_are_listed_and_undone_in_turn() {
    let (_dir, database) = fresh();
    let shipped = knowledge("hospital");
    let id = some_number(&shipped);
    database.import(&shipped, false, &by("shipped")).expect("stored");
    let first = database.amend("hospital", edit(&shipped, &id, 7.0), &by("seven")).expect("amended");
    let after_first = database.knowledge_base("hospital").expect("there");
    let second = database.amend("hospital", edit(&after_first, &id, 8.0), &by("eight")).expect("amended");
    assert_eq!((first.changed, second.seq), (1, 3));

    let refused = database.undo(first.seq, &by("out of turn")).expect_err("the second builds on it").to_string();
    assert!(refused.contains("change 3 touched it later"), "{refused}");
    let stale = database.amend("hospital", edit(&shipped, &id, 9.0), &by("of an old look"));
    assert!(matches!(stale, Err(Error::Outdated { .. })), "{stale:?}");

    database.undo(second.seq, &by("too much")).expect("undone");
    assert_eq!(database.knowledge_base("hospital").expect("there"), after_first);
    database.undo(first.seq, &by("that too")).expect("undone");
    assert_eq!(database.knowledge_base("hospital").expect("there"), shipped);
    let history = database.history().expect("readable");
    let kinds: Vec<&str> = history.iter().map(|c| c.kind.name()).collect();
    assert_eq!(kinds, ["import", "amend", "amend", "undo", "undo"]);
    assert_eq!(history[1].undone_by, Some(5));
    assert!(database.undo(first.seq, &by("twice")).is_err());
    let fields = database.edits(first.seq).expect("there")[0].fields();
    assert_eq!(fields.iter().map(|f| f.field.as_str()).collect::<Vec<_>>(), ["value"]);
}

#[test]
fn a_change_that_breaks_the_rules_changes_nothing() {
    let (_dir, database) = fresh();
    let shipped = knowledge("office");
    database.import(&shipped, false, &by("shipped")).expect("stored");
    let mut broken = shipped.clone();
    broken.references[0].constraints[0].source_ids = vec!["nobody".into()];
    let refused = database.amend("office", difference(&shipped, &broken, false), &by("no"));
    match refused {
        Err(Error::Breaks { problems, .. }) => assert!(problems[0].path.ends_with("/source_ids/0"), "{problems:?}"),
        other => panic!("{other:?}"),
    }
    assert_eq!(database.knowledge_base("office").expect("there"), shipped);
    assert_eq!(database.history().expect("readable").len(), 1);
}

#[test]
fn a_newer_release_brings_its_rules_and_leaves_changed_ones() {
    let (_dir, database) = fresh();
    let old = knowledge("office");
    let numbers: Vec<String> = old
        .references
        .iter()
        .flat_map(|r| &r.constraints)
        .filter(|c| matches!(c.value, Value::Number(_)))
        .map(|c| c.constraint_id.clone())
        .collect();
    let (mine, theirs) = (&numbers[0], &numbers[1]);
    let release = by("d3dgen 1");
    database.bring_shipped(&[&old], &release).expect("stored");
    assert_eq!(database.domains().expect("readable")[0].changes, 0);
    database.amend("office", edit(&old, mine, 7.0), &by("ours")).expect("amended");
    let mut new = old.clone();
    for c in new.references.iter_mut().flat_map(|r| &mut r.constraints) {
        if [mine, theirs].contains(&&c.constraint_id) {
            c.value = Value::Number(5.0);
        }
    }
    new.references.pop();
    let shipped = [&new];
    assert_eq!(database.bring_shipped(&shipped, &release).expect("stored").len(), 1);
    assert_eq!(database.bring_shipped(&shipped, &release).expect("the same").len(), 0);
    let now = database.knowledge_base("office").expect("there");
    let figure = |id: &str| {
        let mut all = now.references.iter().flat_map(|r| &r.constraints);
        all.find(|c| c.constraint_id == id).map(|c| c.value.clone())
    };
    assert_eq!((figure(mine), figure(theirs)), (Some(Value::Number(7.0)), Some(Value::Number(5.0))));
    assert_eq!(now.references.len(), new.references.len());
    assert_eq!(database.domains().expect("readable")[0].changes, 1);
}

#[test]
fn rules_are_found_by_words_meaning_and_filters() {
    let (_dir, database) = fresh();
    for domain in ["hospital", "office"] {
        database.import(&knowledge(domain), false, &by("shipped")).expect("stored");
    }
    let searcher = Searcher::open(&database, Arc::new(StaticTable::new()), Watch::nobody()).expect("an index");
    assert!(searcher.rebuilt.is_some() && searcher.unsaved.is_none());
    let ask = |text: &str, filters: &[(&str, &str)]| {
        let mut query = SearchQuery { text: text.into(), limit: 10, ..SearchQuery::default() };
        for (name, value) in filters {
            query.filters.entry((*name).into()).or_default().insert((*value).into());
        }
        searcher.search(&query).expect("an answer")
    };
    let found = ask("minimum corridor width for moving beds", &[("domain", "hospital"), ("jurisdiction", "DE")]);
    assert!(found.iter().all(|f| f.domain == "hospital" && f.jurisdiction == "DE"));
    assert!(found[..3].iter().any(|f| f.constraint.space_type.contains("corridor")), "{found:?}");
    let found = ask("", &[("unit", "lx")]);
    assert!(!found.is_empty() && found.iter().all(|f| f.constraint.unit == "lx"));
    let all = searcher.values("domain");
    assert_eq!(all["hospital"], count(&knowledge("hospital")));
    let wrong = SearchQuery { filters: [("country".to_owned(), Default::default())].into(), ..SearchQuery::default() };
    assert!(searcher.search(&wrong).is_err());

    let again = Searcher::open(&database, Arc::new(StaticTable::new()), Watch::nobody()).expect("an index");
    assert!(again.rebuilt.is_none(), "{:?}", again.rebuilt);
    database
        .amend("hospital", edit(&knowledge("hospital"), &some_number(&knowledge("hospital")), 7.25), &by("x"))
        .expect("amended");
    let later = Searcher::open(&database, Arc::new(StaticTable::new()), Watch::nobody()).expect("an index");
    assert!(later.rebuilt.is_some());
    let found = later.search(&SearchQuery { value: (Some(7.25), Some(7.25)), limit: 5, ..SearchQuery::default() });
    assert_eq!(found.expect("an answer").len(), 1);
}
