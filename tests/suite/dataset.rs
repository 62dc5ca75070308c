//! Data sets through the command: the same bytes however the work was dealt out, stopped, or extended; nothing lost in silence.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use d3dgen_tests::{command, files, run, run_well};

/// A spec of 12 small worlds in two splits, one prompt of it refused.
const SPEC: &str = r#"
name = "rooms"
seeds = 3
worlds_per_shard = 4
formats = ["plan.svg"]
splits = { train = 0.5, test = 0.5 }

[[prompts]]
text = "{kind} with {rooms} rooms"
kind = ["flat", "office"]
rooms = [2, 3]

[[prompts]]
text = "office with 3000 rooms"
"#;

fn with_spec(text: &str) -> tempfile::TempDir {
    let home = tempfile::tempdir().unwrap();
    std::fs::write(home.path().join("spec.toml"), text).unwrap();
    home
}

fn dataset(home: &Path, line: &str) -> String {
    run_well(home, &[&["dataset"], line.split_whitespace().collect::<Vec<_>>().as_slice()].concat())
}

/// Returns the files of a data set by name.
fn made(home: &Path, name: &str) -> BTreeMap<String, Vec<u8>> {
    let found = files(&home.join(name));
    assert!(found.contains_key("SHA256SUMS") && found.contains_key("index/train.parquet"), "{:?}", found.keys());
    assert!(found.keys().all(|k| !k.starts_with(".part")), "{:?}", found.keys());
    found
}

fn assert_same(a: &BTreeMap<String, Vec<u8>>, b: &BTreeMap<String, Vec<u8>>) {
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (name, bytes) in a {
        assert!(*bytes == b[name], "{name} differs");
    }
}

#[test]
fn shards_in_any_order_come_to_the_bytes_of_one_run() {
    let home = with_spec(SPEC);
    let home = home.path();
    let snapshot = dataset(home, "snapshot --out pinned");
    let snapshot = snapshot.trim();
    dataset(home, &format!("make spec.toml --snapshot {snapshot} --out whole --block 4 --threads 2"));
    for shard in [2, 0, 1] {
        dataset(
            home,
            &format!("make spec.toml --snapshot {snapshot} --shard {shard}/3 --out part-{shard} --block 2 --threads 1"),
        );
    }
    let early = run(home, &["dataset", "merge", "part-0", "part-2", "--out", "merged"]);
    let said = String::from_utf8_lossy(&early.stderr).into_owned();
    assert!(early.status.code() == Some(2) && said.contains("tasks are in no part"), "{said}");
    dataset(home, "merge part-1 part-2 part-0 --out merged");
    let whole = made(home, "whole");
    assert_same(&whole, &made(home, "merged"));
    let failures = String::from_utf8(whole["failures.jsonl"].clone()).unwrap();
    assert_eq!(failures.lines().filter(|l| l.contains("\"refused\"") && l.contains("3000")).count(), 3, "{failures}");
    dataset(home, "verify whole");
    let status = dataset(home, "status whole --json");
    assert!(status.contains("\"worlds\":12") && status.contains("\"failed\":3"), "{status}");
    assert!(status.contains("\"reason\":\"scene_graph: the prompt asks for 3000 rooms"), "{status}");
    dataset(home, "sample whole --count 2 --out some");
    let some: Vec<_> = std::fs::read_dir(home.join("some")).unwrap().map(|e| e.unwrap().path()).collect();
    assert!(some.len() == 2 && some.iter().all(|w| w.join("world.json").is_file() && w.join("plan.svg").is_file()));
}

#[test]
fn more_seeds_of_a_data_set_are_those_of_a_new_one() {
    let home = with_spec(SPEC);
    let home = home.path();
    dataset(home, "make spec.toml --out few");
    dataset(home, "extend few --seeds 4 --out more");
    std::fs::write(home.join("spec.toml"), SPEC.replace("seeds = 3", "seeds = 4")).unwrap();
    dataset(home, "make spec.toml --out anew");
    assert_same(&made(home, "more"), &made(home, "anew"));
    let fewer = run(home, &["dataset", "extend", "few", "--seeds", "2", "--out", "less"]);
    assert_eq!(fewer.status.code(), Some(2));
}

#[test]
fn a_damaged_data_set_is_known() {
    let home = with_spec(&SPEC.replace("seeds = 3", "seeds = 1"));
    let home = home.path();
    dataset(home, "make spec.toml --out set");
    let shard = home.join("set/shards/train-000000.tar");
    let mut bytes = std::fs::read(&shard).unwrap();
    bytes[1500] ^= 1;
    std::fs::write(&shard, bytes).unwrap();
    let verdict = run(home, &["dataset", "verify", "set"]);
    let said = String::from_utf8_lossy(&verdict.stderr);
    assert!(verdict.status.code() == Some(1) && said.contains("train-000000.tar: does not match its sum"), "{said}");
    let again = run(home, &["dataset", "make", "spec.toml", "--out", "set"]);
    assert!(String::from_utf8_lossy(&again.stderr).contains("holds a finished data set"));
}

/// A run is killed in the middle, the rules are amended, and it goes on: with the rules that it began with.
#[cfg(unix)]
#[test]
fn a_killed_run_goes_on_under_the_rules_it_began_with() {
    let home = with_spec(&SPEC.replace("\"flat\"", "\"hospital ward\"").replace("[2, 3]", "[4, 5]"));
    let home = home.path();
    dataset(home, "make spec.toml --out whole --block 1");
    let mut start = command();
    let start = start.args(["dataset", "make", "spec.toml", "--out", "set", "--block", "1", "--threads", "1"]);
    let mut child = start.current_dir(home).stderr(Stdio::null()).spawn().unwrap();
    let ledger = home.join("set/.part/ledger.jsonl");
    let begun = Instant::now();
    while std::fs::read_to_string(&ledger).unwrap_or_default().lines().count() < 3 {
        assert!(begun.elapsed() < Duration::from_secs(120), "no block in two minutes");
        std::thread::sleep(Duration::from_millis(5));
    }
    let killed = Command::new("kill").args(["-KILL", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    child.wait().unwrap();
    assert!(!home.join("set/SHA256SUMS").exists());
    // the power went while a line of the ledger was written, and while a block was
    let mut torn = std::fs::read(&ledger).unwrap();
    torn.extend_from_slice(b"{\"block\":7,\"sha");
    std::fs::write(&ledger, torn).unwrap();
    std::fs::write(home.join("set/.part/blocks/000009.tar.tmp"), b"half").unwrap();
    let status = dataset(home, "status set --json");
    assert!(status.contains("\"doing\":\"stopped\""), "{status}");
    let sentence = "corridors in our ward are at least 2.9 m";
    run_well(home, &["knowledge", "amend", sentence, "--domain", "hospital", "--store", "rules", "--yes"]);
    dataset(home, "make spec.toml --out set --store rules");
    let whole = made(home, "whole");
    assert_same(&whole, &made(home, "set"));
    dataset(home, "make spec.toml --out amended --store rules");
    assert_ne!(whole["shards/train-000000.tar"], made(home, "amended")["shards/train-000000.tar"]);
}

#[test]
fn a_dry_run_and_a_quota_write_no_data_set() {
    let home = with_spec(SPEC);
    let home = home.path();
    let dry = run(home, &["dataset", "make", "spec.toml", "--out", "set", "--dry-run"]);
    let said = String::from_utf8_lossy(&dry.stderr);
    assert!(dry.status.success() && said.contains("15 tasks of 5 prompts") && said.contains("disk"), "{said}");
    assert!(!home.join("set").exists());
    let full = run(home, &["dataset", "make", "spec.toml", "--out", "set", "--quota", "10kB", "--block", "1"]);
    let said = String::from_utf8_lossy(&full.stderr);
    assert!(full.status.code() == Some(2) && said.contains("of its quota"), "{said}");
    let status = dataset(home, "status set --json");
    assert!(status.contains("\"finished\":false") && !status.contains("\"worlds\":0"), "{status}");
    dataset(home, "make spec.toml --out set");
    made(home, "set");
}

#[test]
fn stages_variants_filters_and_assets() {
    let home = with_spec("");
    let home = home.path();
    let spec =
        "name = \"x\"\nseeds = 1\nprompts = [{ text = \"flat with 3 rooms\" }, { text = \"office with 3 rooms\" }]\n";
    let make = |name: &str, more: &str| {
        std::fs::write(home.join("spec.toml"), format!("{more}\n{spec}")).unwrap();
        dataset(home, &format!("make spec.toml --out {name}"));
        dataset(home, &format!("verify {name}"));
        made(home, name)
    };
    let plans = make("plans", "stages = [\"floorplan\"]");
    let shard = String::from_utf8_lossy(&plans["shards/train-000000.tar"]).into_owned();
    assert!(shard.contains("world-000000.floorplan.json.gz") && !shard.contains("world.json.gz"));
    let varied = make("varied", "variants = { placement = 2, scenario = 2 }");
    let shard = String::from_utf8_lossy(&varied["shards/train-000000.tar"]).into_owned();
    assert!(shard.contains("world-000007.world.json.gz"));
    let kept = make(
        "kept",
        "filters = [{ measure = \"rooms\", min = 3 }, { measure = \"objects\", max = 1000 }]\nmeasures = [\"objects_per_m2\"]",
    );
    assert!(kept["failures.jsonl"].is_empty());
    std::fs::write(home.join("spec.toml"), format!("filters = [{{ measure = \"rooms\", min = 30 }}]\n{spec}")).unwrap();
    let none = run(home, &["dataset", "make", "spec.toml", "--out", "none"]);
    assert!(String::from_utf8_lossy(&none.stderr).contains("rooms is 3, less than 30"));
    let dealt =
        make("dealt", "splits = { by = [\"prompt\", \"asset\"], held_out_assets = 0.5, train = 0.5, test = 0.5 }");
    assert!(dealt.contains_key("index/test.parquet"));
    let modelled = make("modelled", "formats = [\"arena\"]");
    assert!(modelled["shards/models-000000.tar"].len() > 100_000);
}
