//! The knowledge database through the command: changes reach worlds, reports cite what is in it, nothing acknowledged is
//! lost when a run is killed.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Stdio;
use std::time::Instant;

use d3dgen_model::document::Document;
use d3dgen_model::report::Report;
use d3dgen_store::{Options, Store};
use d3dgen_tests::{command, files, run, run_well};
use serde_json::{Value, json};

const WARD: &str = "hospital ward with 4 rooms in Germany";

fn report(folder: &Path) -> Report {
    Report::from_json(&std::fs::read_to_string(folder.join("report.json")).unwrap()).unwrap()
}

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Makes the ward from the rules of a database.
fn ward(home: &Path, out: &str) {
    run_well(home, &["generate", WARD, "--no-png", "--store", "store", "--out", out]);
}

#[test]
fn an_amended_rule_changes_the_next_world_and_its_undoing_changes_it_back() {
    let dir = tempfile::tempdir().unwrap();
    let home = dir.path();
    run_well(home, &["knowledge", "history", "--store", "store"]); // makes the database
    ward(home, "before");
    assert_eq!(files(&home.join("before")), {
        run_well(home, &["generate", WARD, "--no-png", "--out", "none"]);
        files(&home.join("none"))
    });
    let sentence = "corridors in our ward are at least 2.9 m";
    let shown = run(home, &["knowledge", "amend", sentence, "--domain", "hospital", "--store", "store"]);
    assert!(String::from_utf8_lossy(&shown.stderr).contains("nothing was changed"), "nobody has agreed yet");
    let amend =
        ["knowledge", "amend", sentence, "--domain", "hospital", "--store", "store", "--by", "head nurse", "--yes"];
    let change = lines(&run_well(home, &[&amend[..], &["--json"]].concat())).remove(0);
    ward(home, "after");
    let after = report(&home.join("after"));
    let cited: Vec<_> = after.constraints.iter().filter(|c| c.citation.jurisdiction == "LOCAL").collect();
    assert!(!cited.is_empty() && cited.iter().all(|c| c.measured.is_some_and(|m| m >= 2.9 - 1e-6)), "{cited:?}");
    assert_eq!(cited[0].citation.source.publisher, "head nurse");
    assert_ne!(files(&home.join("before"))["floorplan.json"], files(&home.join("after"))["floorplan.json"]);

    run_well(home, &["knowledge", "undo", &change["seq"].to_string(), "--store", "store"]);
    ward(home, "again");
    assert_eq!(files(&home.join("before")), files(&home.join("again")));
    let kinds: Vec<String> = lines(&run_well(home, &["knowledge", "history", "--json", "--store", "store"]))
        .iter()
        .map(|c| c["kind"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(kinds[kinds.len() - 2..], ["amend", "undo"]);
}

#[test]
fn every_rule_a_report_cites_is_in_the_database() {
    let dir = tempfile::tempdir().unwrap();
    let home = dir.path();
    run_well(
        home,
        &[
            "knowledge",
            "amend",
            "corridors are at least 2.5 m wide",
            "--domain",
            "hospital",
            "--store",
            "store",
            "--yes",
        ],
    );
    ward(home, "ward");
    let all = run_well(
        home,
        &["knowledge", "search", "--json", "--limit", "100000", "--domain", "hospital", "--store", "store"],
    );
    let known: BTreeSet<String> =
        lines(&all).iter().map(|f| f["constraint"]["constraint_id"].as_str().unwrap().to_owned()).collect();
    let cited = report(&home.join("ward")).constraints;
    assert!(cited.len() > 20);
    for rule in cited {
        assert!(known.contains(&rule.constraint_id), "{}", rule.constraint_id);
    }
}

#[test]
fn export_is_what_was_imported_and_problems_have_paths() {
    let dir = tempfile::tempdir().unwrap();
    let home = dir.path();
    let file = d3dgen_tests::workspace().join("domains/office/knowledge.json");
    let text = std::fs::read_to_string(&file).unwrap();
    assert_eq!(run_well(home, &["knowledge", "export", "--domain", "office", "--store", "store"]), {
        let mut value: d3dgen_model::knowledge::KnowledgeBase = serde_json::from_str(&text).unwrap();
        d3dgen_plugins::complete(&mut value).unwrap();
        value.to_json()
    });
    let mut broken: Value = serde_json::from_str(&text).unwrap();
    broken["references"][2]["jurisdiction"] = "Mars".into();
    broken["references"][3]["constraints"][0]["source_ids"] = json!(["nobody"]);
    std::fs::write(home.join("broken.json"), broken.to_string()).unwrap();
    let refused = run(home, &["knowledge", "import", "broken.json", "--store", "other"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2));
    for path in ["/references/2/jurisdiction", "/references/3/constraints/0/source_ids/0"] {
        assert!(said.contains(path), "{said}");
    }
    assert!(!home.join("other").exists(), "a broken file makes no database");
}

#[test]
fn a_second_writer_is_told_who_writes() {
    let dir = tempfile::tempdir().unwrap();
    let home = dir.path();
    run_well(home, &["knowledge", "history", "--store", "store"]);
    let held = Store::open(home.join("store"), d3dgen_store::Access::Write, &Options::default()).unwrap();
    let amend =
        ["knowledge", "amend", "corridors are at least 2.5 m wide", "--domain", "office", "--store", "store", "--yes"];
    let refused = run(home, &amend);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2));
    assert!(said.contains(&format!("process {}", std::process::id())), "{said}");
    run_well(home, &["knowledge", "search", "corridor", "--store", "store"]); // readers go on
    drop(held);
    run_well(home, &amend);
}

#[test]
fn a_damaged_index_is_noticed_and_made_anew() {
    let dir = tempfile::tempdir().unwrap();
    let home = dir.path();
    let search = ["knowledge", "search", "corridor width", "--json", "--store", "store"];
    let first = run_well(home, &search);
    let index = home.join("store/index");
    let broken: Vec<String> = files(&index).into_keys().filter(|f| !f.ends_with("lock")).collect();
    assert!(broken.len() > 3, "{broken:?}");
    for file in broken.iter().step_by(3) {
        let path = index.join(file);
        let Ok(mut bytes) = std::fs::read(&path) else { continue }; // an earlier round has made other files
        match bytes.len() {
            0 => continue,
            n => bytes[n / 2] ^= 1,
        }
        std::fs::write(&path, bytes).unwrap();
        let again = run(home, &search);
        assert!(String::from_utf8_lossy(&again.stderr).contains("index made anew"), "{file}");
        assert_eq!(String::from_utf8(again.stdout).unwrap(), first, "{file}");
    }
}

/// A knowledge base of many rules, so that storing it takes a while.
fn many(round: usize) -> String {
    let constraint = |n: usize| {
        json!({
            "constraint_id": format!("c{round}_{n}"), "name": "clear_width", "topic": "room_size",
            "constraint_type": "minimum", "value": 1.0 + n as f64 / 1000.0, "unit": "m",
            "measurement_basis": "clear_width", "space_type": "corridor", "conditions": [format!("case {n}")],
            "confidence": "high", "verified": "seen", "source_ids": ["s"]
        })
    };
    json!({
        "metadata": {"version": 1, "domain": "many", "generated_by": "test", "date": "2026-11-21"},
        "references": [{
            "ref_id": format!("r{round}"), "building_type": "many", "jurisdiction": "INT", "retrieved_at": "2026-11-21",
            "sources": [{"source_id": "s", "title": "T", "publisher": "P", "edition_or_year": "2020", "type": "standard"}],
            "constraints": (0..2000).map(constraint).collect::<Vec<_>>()
        }]
    })
    .to_string()
}

#[test]
fn killed_imports_lose_nothing_that_was_acknowledged() {
    for backend in ["redb", "sled"] {
        let dir = tempfile::tempdir().unwrap();
        let home = dir.path();
        std::fs::write(home.join("first.json"), many(99)).unwrap();
        let begun = Instant::now();
        run_well(home, &["knowledge", "import", "first.json", "--backend", backend, "--store", "store"]);
        let whole = begun.elapsed();
        let mut acknowledged = Vec::new();
        let mut killed = 0;
        for round in 0..20 {
            std::fs::write(home.join("many.json"), many(round)).unwrap();
            let args = ["knowledge", "import", "many.json", "--json", "--store", "store"];
            let mut child =
                command().args(args).current_dir(home).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
            // from before the file is read to after it is stored, at other moments in every round
            std::thread::sleep(whole * (round as u32 + 1) / 20);
            child.kill().unwrap();
            let output = child.wait_with_output().unwrap();
            if output.stdout.ends_with(b"\n") {
                acknowledged.push(round);
            } else {
                killed += 1;
            }
            let found = lines(&run_well(home, &["knowledge", "verify", "--json", "--store", "store"])).remove(0);
            assert_eq!(found["sound"], true, "{backend}, round {round}: {found}");
        }
        assert!(killed > 2, "{backend}: no import was killed in the middle");
        let text = match acknowledged.is_empty() {
            true => continue,
            false => run_well(home, &["knowledge", "export", "--domain", "many", "--store", "store"]),
        };
        let stored: Value = serde_json::from_str(&text).unwrap();
        for reference in stored["references"].as_array().unwrap() {
            assert_eq!(reference["constraints"].as_array().unwrap().len(), 2000, "{backend}: half an import");
        }
        for round in acknowledged {
            let id = format!("r{round}");
            assert!(
                stored["references"].as_array().unwrap().iter().any(|r| r["ref_id"] == id.as_str()),
                "{backend} {id}"
            );
        }
        run_well(home, &["knowledge", "search", "clear width", "--domain", "many", "--store", "store"]);
    }
}
