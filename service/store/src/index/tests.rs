//! Searching as callers do, on an index in memory.

use std::sync::Arc;

use super::*;
use crate::embed::StaticTable;

fn spec() -> IndexSpec {
    IndexSpec::default().field("name", 3.0).field("text", 1.0).facets(&["country", "room"]).numbers(&["value"])
}

fn document(key: &str, name: &str, text: &str, country: &str, rooms: &[&str], value: Option<f64>) -> Document {
    Document {
        key: key.to_owned(),
        texts: [("name", name), ("text", text)].map(|(n, t)| (n.to_owned(), t.to_owned())).into(),
        facets: [
            ("country".to_owned(), vec![country.to_owned()]),
            ("room".to_owned(), rooms.iter().map(|r| (*r).to_owned()).collect()),
        ]
        .into(),
        numbers: value.map(|v| ("value".to_owned(), v)).into_iter().collect(),
        embed_text: format!("{name}. {text}").replace('_', " "),
    }
}

/// Returns one of the documents of [`index`].
fn document_of(key: &str) -> Document {
    documents().into_iter().find(|d| d.key == key).expect("one of them")
}

fn documents() -> [Document; 7] {
    [
        document("de_corridor", "corridor_width", "clear width of corridors, 1.50 m", "DE", &["corridor"], Some(1.5)),
        document("us_corridor", "corridor_width", "clear width of corridors, 44 in", "US", &["corridor"], Some(1.118)),
        document(
            "de_door",
            "door_clear_width",
            "Lichte Türbreite mindestens 0,90 m",
            "DE",
            &["door", "corridor"],
            Some(0.9),
        ),
        document("de_kitchen", "kitchen_area", "Grundfläche der Küche in m²", "DE", &["kitchen"], Some(8.0)),
        document(
            "at_height",
            "ceiling_height",
            "clear height of habitable rooms",
            "AT",
            &["bedroom", "kitchen"],
            Some(2.5),
        ),
        document("de_smoke", "smoke_alarm", "a smoke alarm in each bedroom", "DE", &["bedroom"], None),
        document("de_flur", "flur", "Flur und Breite", "DE", &["corridor"], None),
    ]
}

fn index() -> Index {
    Index::in_memory(&spec(), Arc::new(StaticTable::new()), 1, documents(), Watch::nobody()).unwrap()
}

#[track_caller]
fn keys(index: &Index, text: &str, filter: &Filter, mode: Mode) -> Vec<String> {
    index.search(text, filter, 10, mode).unwrap().into_iter().map(|hit| hit.key).collect()
}

#[test]
fn words_are_found_in_their_forms_languages_and_with_slips() {
    let index = index();
    for (text, best) in [
        ("corridors width", "de_corridor"),
        ("kitchen", "de_kitchen"),
        ("KITCHEN_AREA", "de_kitchen"),
        ("Türbreiten", "de_door"),
        ("Tuerbreite", "de_door"),
        ("kuche", "de_kitchen"),
        ("Kuechen", "de_kitchen"),
        ("smoke alarms", "de_smoke"),
        ("celing", "at_height"),
        ("0.9", "de_door"),
        ("44 in", "us_corridor"),
        ("Flurbreite", "de_flur"),
        ("the area of the kitchen?", "de_kitchen"),
    ] {
        let found = keys(&index, text, &Filter::Everything, Mode::Text);
        assert_eq!(found.first().map(String::as_str), Some(best), "{text}: {found:?}");
    }
    assert!(keys(&index, "zzzzzzz", &Filter::Everything, Mode::Text).is_empty());
}

#[test]
fn meaning_finds_what_no_word_does() {
    let index = index();
    let found = keys(&index, "hallway", &Filter::Everything, Mode::Vector);
    assert!(found[..3].iter().any(|key| key.ends_with("corridor")), "{found:?}");
    assert!(keys(&index, "hallway", &Filter::Everything, Mode::Text).is_empty());
    let hits = index.search("fire detector where people sleep", &Filter::Everything, 3, Mode::Hybrid).unwrap();
    assert_eq!(hits[0].key, "de_smoke");
    assert!(hits[0].similarity.is_some_and(|s| s > 0.2));
}

#[test]
fn filters_leave_what_they_say() {
    let index = index();
    let german = Filter::facet("country", ["DE"]);
    let check = |filter: Filter, expected: &[&str]| {
        for mode in [Mode::Hybrid, Mode::Text, Mode::Vector] {
            assert_eq!(keys(&index, "", &filter, mode), expected, "{filter:?}");
            let found = keys(&index, "clear width of corridors in the kitchen", &filter, mode);
            assert!(found.iter().all(|key| expected.contains(&key.as_str())), "{filter:?}: {found:?}");
        }
        assert_eq!(index.count(&filter).unwrap(), expected.len());
    };
    check(german.clone().and(Filter::facet("room", ["corridor"])), &["de_corridor", "de_door", "de_flur"]);
    check(Filter::facet("room", ["kitchen", "bedroom"]), &["at_height", "de_kitchen", "de_smoke"]);
    check(Filter::number("value", Some(0.9), Some(1.5)), &["de_corridor", "de_door", "us_corridor"]);
    check(Filter::number("value", Some(2.5), None), &["at_height", "de_kitchen"]);
    check(Filter::number("value", None, None).negate(), &["de_flur", "de_smoke"]);
    check(german.negate(), &["at_height", "us_corridor"]);
    check(Filter::facet("country", ["FR"]), &[]);
    check(
        Filter::Any(vec![Filter::facet("country", ["US"]), Filter::facet("room", ["door"])]),
        &["de_door", "us_corridor"],
    );
    check(Filter::Any(Vec::new()), &[]);
    assert_eq!(index.facet_counts("country").unwrap()["DE"], 5);
}

#[test]
fn unknown_fields_are_named() {
    let index = index();
    let error = index.search("x", &Filter::facet("jurisdiction", ["DE"]), 5, Mode::Hybrid).unwrap_err();
    assert_eq!(error.to_string(), "no facet of the index is called jurisdiction: it has country, room");
    assert!(index.search("x", &Filter::number("price", None, None).negate(), 5, Mode::Text).is_err());
    let strange = Document { key: "k".to_owned(), numbers: [("weight".to_owned(), 1.0)].into(), ..Document::default() };
    let made = Index::in_memory(&spec(), Arc::new(StaticTable::new()), 1, [strange], Watch::nobody());
    assert!(matches!(made, Err(Error::UnknownField { kind: "number", .. })));
    let twice = || Document { key: "k".to_owned(), ..Document::default() };
    assert!(Index::in_memory(&spec(), Arc::new(StaticTable::new()), 1, [twice(), twice()], Watch::nobody()).is_err());
}

#[test]
fn any_text_is_a_question() {
    let index = index();
    let long = "corridor ".repeat(20_000);
    for text in [
        "\"",
        "a AND (b OR",
        "name:x^",
        "*",
        "\u{0}",
        "\u{202e}\u{200d}",
        "👩‍⚕️",
        "-",
        "[a TO b]",
        "病房",
        "\u{301}",
        &long,
    ] {
        for mode in [Mode::Hybrid, Mode::Text, Mode::Vector] {
            index.search(text, &Filter::Everything, 5, mode).unwrap();
        }
    }
}

#[test]
fn limits_ranks_and_ties_are_as_said() {
    let index = index();
    for limit in [0, 1, 3, 7, usize::MAX] {
        let hits = index.search("corridor width", &Filter::Everything, limit, Mode::Hybrid).unwrap();
        assert_eq!(hits.len(), limit.min(7));
        assert!(hits.is_sorted_by(|a, b| a.score > b.score || (a.score == b.score && a.key < b.key)));
        assert_eq!(hits, index.search("corridor width", &Filter::Everything, limit, Mode::Hybrid).unwrap());
    }
    let same = ["b", "c", "a"].map(|key| document(key, "corridor", "same", "DE", &[], None));
    let index = Index::in_memory(&spec(), Arc::new(StaticTable::new()), 1, same, Watch::nobody()).unwrap();
    for mode in [Mode::Hybrid, Mode::Text, Mode::Vector] {
        assert_eq!(keys(&index, "corridor", &Filter::Everything, mode), ["a", "b", "c"]);
    }
}

#[test]
fn an_empty_index_answers() {
    let index = Index::in_memory(&spec(), Arc::new(StaticTable::new()), 0, [], Watch::nobody()).unwrap();
    assert!(index.is_empty());
    for mode in [Mode::Hybrid, Mode::Text, Mode::Vector] {
        assert!(keys(&index, "corridor", &Filter::facet("country", ["DE"]), mode).is_empty());
    }
}

#[test]
fn an_index_of_another_format_is_made_anew() {
    let dir = tempfile::tempdir().unwrap();
    let open = || {
        let documents = || Ok::<_, Error>([document("a", "corridor", "", "DE", &[], None)]);
        let table = Arc::new(StaticTable::new());
        Index::open_or_rebuild(dir.path(), &spec(), table, 1, documents, Watch::nobody()).unwrap().rebuilt
    };
    assert_eq!(open(), Some(Reason::Missing));
    let mut manifest = manifest::Manifest::read(dir.path()).unwrap_or_else(|_| panic!("it was just written"));
    manifest.format += 1;
    let format = manifest.format;
    manifest.write(dir.path()).unwrap();
    assert_eq!(open(), Some(Reason::OtherFormat { format }));
    assert_eq!(open(), None);
}

#[test]
fn every_changed_byte_of_a_manifest_is_noticed() {
    let dir = tempfile::tempdir().unwrap();
    manifest::Manifest::new(spec().digest(), "table", 7, 12).write(dir.path()).unwrap();
    let path = dir.path().join(manifest::FILE);
    let whole = std::fs::read(&path).unwrap();
    assert!(manifest::Manifest::read(dir.path()).is_ok());
    for at in 0..whole.len() {
        let mut changed = whole.clone();
        changed[at] ^= 1;
        std::fs::write(&path, changed).unwrap();
        assert!(manifest::Manifest::read(dir.path()).is_err(), "byte {at}");
    }
}

/// Rules that say different things, enough for a graph of neighbors to be worth a test.
fn many() -> Vec<Document> {
    let words = ["corridor", "kitchen", "door", "window", "bed", "ramp", "lift", "desk", "stair", "robot", "toilet"];
    let word = |i: usize, step: usize| words[i / step % words.len()];
    let one = |i: usize| {
        document(&format!("{i:04}"), word(i, 1), &format!("{} {} {i}", word(i, 11), word(i, 121)), "DE", &[], None)
    };
    (0..1300).map(one).collect()
}

#[test]
fn a_graph_of_neighbors_is_kept_checked_and_as_good_as_the_scan() {
    let dir = tempfile::tempdir().unwrap();
    let embedder: Arc<dyn Embedder> = Arc::new(StaticTable::new());
    let open = |graph_from| {
        let (spec, revision) = (&spec(), u64::from(graph_from));
        let wanted = Wanted { spec, embedder: &embedder, revision, graph_from };
        let mut feed = |take: Take<'_>| many().into_iter().try_for_each(take);
        let found = lifecycle::open_or_rebuild::<Error>(dir.path(), &wanted, 0, &mut feed, Watch::nobody()).unwrap();
        (
            Index {
                inner: Arc::new(Inner {
                    parts: Arc::new(found.parts),
                    changed: None,
                    embedder: embedder.clone(),
                    revision,
                }),
            },
            found.rebuilt,
        )
    };
    let scanned = open(u32::MAX).0;
    assert!(scanned.inner.parts.graph().is_none());
    assert!(matches!(open(500).1, Some(Reason::Stale { .. })));
    let (linked, rebuilt) = open(500);
    assert!(rebuilt.is_none() && linked.inner.parts.graph().is_some());
    let (mut same, mut all) = (0, 0);
    for text in
        ["width of the door", "where to sleep", "kitchen window", "robot in the lift", "wheelchair", "stairs 77"]
    {
        // A filter that leaves nearly all goes by the graph too.
        for filter in [Filter::Everything, Filter::facet("country", ["DE"])] {
            let search = |index: &Index| index.search(text, &filter, 10, Mode::Vector).unwrap();
            let (exact, found) = (search(&scanned), search(&linked));
            same += found.iter().filter(|hit| exact[9].similarity <= hit.similarity).count();
            all += exact.len();
            assert_eq!(search(&linked), found);
        }
    }
    assert!(same * 100 >= all * 98, "recall {same} of {all}");
    let folder =
        dir.path().join(manifest::Manifest::read(dir.path()).map(|m| m.folder).unwrap_or_default()).join("graph");
    let files: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()).collect();
    assert_eq!(files.len(), 2);
    // Damaged after the index was opened: the scan answers instead.
    let (late, _) = open(500);
    let mut content = std::fs::read(&files[0]).unwrap();
    let middle = content.len() / 2;
    content[middle] ^= 4;
    std::fs::write(&files[0], content).unwrap();
    assert!(late.inner.parts.graph().is_none());
    assert_eq!(late.search("ramp", &Filter::Everything, 9, Mode::Vector).unwrap().len(), 9);
    assert!(matches!(open(500).1, Some(Reason::Damaged { .. })));
}

#[test]
fn a_changed_index_finds_what_one_made_anew_finds() {
    let changes = [
        ("at_height", None),
        (
            "de_corridor",
            Some(document(
                "de_corridor",
                "corridor_width",
                "clear width of wards, 2.25 m",
                "AT",
                &["ward"],
                Some(2.25),
            )),
        ),
        ("ch_stair", Some(document("ch_stair", "stair_width", "clear width of stairs", "CH", &["stairs"], Some(1.2)))),
        ("de_none", None),
    ];
    let changes = changes.map(|(key, document)| (key.to_owned(), document));
    let before = index();
    let changed = before.changed(&spec(), 2, changes.clone()).unwrap().expect("few have changed");
    assert_eq!((changed.revision(), before.revision(), changed.len(), before.len()), (2, 1, 7, 7));
    let mut documents: BTreeMap<String, Document> = changes.into_iter().filter_map(|(k, d)| Some((k, d?))).collect();
    for kept in ["us_corridor", "de_door", "de_kitchen", "de_smoke", "de_flur"] {
        documents.insert(kept.to_owned(), document_of(kept));
    }
    let anew = Index::in_memory(&spec(), Arc::new(StaticTable::new()), 2, documents.into_values(), Watch::nobody());
    let anew = anew.unwrap();
    let filters =
        [Filter::Everything, Filter::facet("country", ["AT", "DE"]), Filter::number("value", Some(1.0), None)];
    for filter in &filters {
        for text in ["", "corridor width", "clear height", "stairs", "width of wards", "smoke alarm", "Breite"] {
            for mode in [Mode::Text, Mode::Vector, Mode::Hybrid] {
                let (mut found, mut wanted) = (keys(&changed, text, filter, mode), keys(&anew, text, filter, mode));
                // how rare a word is differs a little while what is gone still counts; nearness does not
                if text.is_empty() || mode == Mode::Vector {
                    assert_eq!(found, wanted, "{text:?} {filter:?} {mode:?}");
                }
                found.sort();
                wanted.sort();
                assert_eq!(found, wanted, "{text:?} {filter:?} {mode:?}");
            }
        }
        assert_eq!(changed.count(filter).unwrap(), anew.count(filter).unwrap());
    }
    for facet in ["country", "room"] {
        assert_eq!(changed.facet_counts(facet), anew.facet_counts(facet), "{facet}");
    }
    // changes add up, and the last one counts
    let again = changed.changed(&spec(), 3, [("ch_stair".to_owned(), None)]).unwrap().expect("few");
    assert!(keys(&again, "stairs", &Filter::Everything, Mode::Text).is_empty() && again.len() == 6);
    let many = (0..=BESIDE).map(|n| (format!("n{n}"), Some(document(&format!("n{n}"), "a", "b", "DE", &[], None))));
    assert!(before.changed(&spec(), 2, many).unwrap().is_none(), "many changes make it anew");
}
