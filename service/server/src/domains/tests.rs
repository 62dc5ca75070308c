//! Domains come, change and go, and are there again after a start.

use d3dgen_knowledge::database::SearchQuery;
use d3dgen_store::embed::StaticTable;

use super::*;

fn by() -> Provenance {
    Provenance { who: "tester".into(), when: "2026-11-21T00:00:00Z".into(), why: "test".into() }
}

/// Returns the shipped school under another name, with its rules.
fn academy() -> (Domain, KnowledgeBase) {
    let registry = Registry::builtin();
    let school = registry.get("school").expect("shipped");
    let mut knowledge = school.knowledge().clone();
    knowledge.metadata.domain = "academy".into();
    (Domain { id: "academy".into(), ..school.domain().clone() }, knowledge)
}

#[test]
fn a_registered_domain_is_there_at_once_and_after_a_start() {
    let dir = tempfile::tempdir().expect("a folder");
    let open = || Databases::open(dir.path(), Arc::new(StaticTable::new())).expect("databases");
    let mut databases = open();
    let mut domains = Domains::open(&databases, &by()).expect("domains");
    let before = domains.now();
    let (domain, knowledge) = academy();
    let register = |domains: &Domains, databases: &Databases, domain: &Domain| {
        domains.register(databases, domain.clone(), knowledge.clone(), &by(), 1, |_, _| ()).map(|e| e.version)
    };
    assert_eq!(register(&domains, &databases, &domain).expect("registered"), 1);
    assert!(before.registry.get("academy").is_none(), "calls that began keep what they had");
    for _ in 0..2 {
        let now = domains.now();
        assert_eq!(now.registry.get("academy").expect("there").knowledge(), &knowledge);
        assert_eq!(now.registered["academy"].version, 1);
        databases.index_rules().expect("an index");
        let filters = BTreeMap::from([("domain".to_owned(), ["academy".to_owned()].into())]);
        let query = SearchQuery { filters, limit: 5, ..SearchQuery::default() };
        assert_eq!(
            databases.searcher().expect("made").search(&query).expect("an answer").is_empty(),
            knowledge.references.is_empty()
        );
        drop((domains, now, databases));
        databases = open();
        domains = Domains::open(&databases, &by()).expect("domains");
    }
    assert_eq!(register(&domains, &databases, &domain).expect("again"), 2);
    assert!(domains.remove(&databases, "academy", &by(), |_| ()).expect("removed"));
    assert!(!domains.remove(&databases, "academy", &by(), |_| ()).expect("nothing to do"));
    assert!(domains.now().registry.get("academy").is_none());
    assert_eq!(register(&domains, &databases, &domain).expect("once more"), 3);
}

#[test]
fn a_bad_domain_changes_nothing() {
    let dir = tempfile::tempdir().expect("a folder");
    let databases = Databases::open(dir.path(), Arc::new(StaticTable::new())).expect("databases");
    let domains = Domains::open(&databases, &by()).expect("domains");
    let (domain, knowledge) = academy();
    let register = |domain: Domain, knowledge: KnowledgeBase| {
        domains.register(&databases, domain, knowledge, &by(), 1, |_, _| ()).expect_err("refused")
    };
    let shipped = Domain { id: "school".into(), ..domain.clone() };
    assert!(matches!(register(shipped, knowledge.clone()), Refusal::Shipped));
    for id in ["../academy", "Academy", "", "a/b"] {
        let bad = Domain { id: id.into(), ..domain.clone() };
        assert!(matches!(register(bad, knowledge.clone()), Refusal::Problems("domain", _)), "{id}");
    }
    let mut bad = domain.clone();
    bad.objects[0].id = "../../etc/x".into();
    assert!(matches!(register(bad, knowledge.clone()), Refusal::Problems("domain", _)));
    let other = KnowledgeBase::empty("school");
    assert!(matches!(register(domain, other), Refusal::Problems("knowledge_base", _)));
    assert_eq!(domains.now().registry.iter().count(), Registry::builtin().iter().count());
}

#[test]
fn words_of_domains_are_made_once_for_as_long_as_the_domains_are_the_same() {
    let dir = tempfile::tempdir().expect("a folder");
    let databases = Databases::open(dir.path(), Arc::new(StaticTable::new())).expect("databases");
    let domains = Domains::open(&databases, &by()).expect("domains");
    let labels = ["patient room".to_owned(), "corridor".to_owned()];
    let before = domains.now();
    let best = before.classify(&labels, None).into_iter().next().expect("known rooms");
    assert_eq!(best.domain, "hospital");
    domains.refresh_rules(&databases, "hospital").expect("rules");
    domains.refresh_assets(&databases).expect("assets");
    assert!(Arc::ptr_eq(&before.words, &domains.now().words), "neither rules nor assets name rooms");
    assert_eq!(before.classify(&labels, Some("hospital")).len(), 1);
    assert!(before.classify(&labels, Some("castle")).is_empty());
    let (domain, knowledge) = academy();
    domains.register(&databases, domain, knowledge, &by(), 1, |_, _| ()).expect("registered");
    assert!(!Arc::ptr_eq(&before.words, &domains.now().words), "another domain names other rooms");
    assert_eq!(domains.now().classify(&["classroom".to_owned()], Some("academy")).len(), 1);
}
