//! The example of `domains/README.md` is a domain that works.

use std::fs;

use d3dgen_tests::{run, run_well, workspace};

/// Returns the code block of a language in the guide that begins with a text.
pub(crate) fn block<'a>(guide: &'a str, language: &str, begins: &str) -> &'a str {
    let mut blocks = guide.split("\n```").skip(1).step_by(2);
    let mut texts = blocks.by_ref().filter_map(|b| b.strip_prefix(language)?.strip_prefix('\n'));
    texts.find(|t| t.starts_with(begins)).expect("the guide has this block")
}

#[test]
fn the_domain_of_the_guide_makes_worlds() {
    let guide = fs::read_to_string(workspace().join("domains/README.md")).unwrap();
    let home = tempfile::tempdir().unwrap();
    let folder = home.path().join("observatory");
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("domain.toml"), block(&guide, "toml", "version = 1")).unwrap();
    fs::write(folder.join("knowledge.json"), block(&guide, "json", "{")).unwrap();

    assert!(run_well(home.path(), &["domains", "validate", "observatory"]).contains("6 room types"));
    let prompt = "observatory with two telescope rooms";
    let request = ["generate", prompt, "--domains-dir", ".", "--no-png", "--json", "--out", "o", "--count", "3"];
    for line in run_well(home.path(), &request).lines() {
        let world: serde_json::Value = serde_json::from_str(line).unwrap();
        assert_eq!((&world["domain"], &world["rooms"]), (&"observatory".into(), &5.into()), "{world}");
        assert!(world["constraints"]["satisfied"].as_u64() > Some(0), "the rule of the guide holds: {world}");
    }
    let world = fs::read_to_string(home.path().join("o/0/world.json")).unwrap();
    assert!(world.contains("telescope_room_2") && world.contains("telescope_room_1_telescope_1"));

    // What it takes of the common objects and groups, one of them lower.
    fs::write(folder.join("taken.toml"), block(&guide, "toml", "use = [")).unwrap();
    let shown = run_well(home.path(), &["domains", "show", "observatory", "--json", "--domains-dir", "."]);
    let shown: serde_json::Value = serde_json::from_str(&shown).unwrap();
    let entry = |key: &str, id: &str| shown[key].as_array().unwrap().iter().find(|e| e["id"] == id).cloned().unwrap();
    let cabinet = entry("objects", "filing_cabinet");
    assert!(cabinet["sizes_m"][0][2] == 1.0 && cabinet["shape"] == "cabinet", "{cabinet}");
    assert_eq!(entry("groups", "reading_corner")["anchor"], "reading_chair");
    fs::write(folder.join("taken.toml"), "use = [\"filing_cabinett\"]").unwrap();
    let output = run(home.path(), &["domains", "validate", "observatory"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() == Some(2) && said.contains("taken.toml") && said.contains("filing_cabinett"),
        "{said}"
    );
    fs::remove_file(folder.join("taken.toml")).unwrap();

    // The parts that stand in files of their own.
    fs::write(folder.join("clutter.toml"), block(&guide, "toml", "[[clutter]]")).unwrap();
    fs::write(folder.join("layouts.toml"), block(&guide, "toml", "[layouts]")).unwrap();
    let request = ["generate", "observatory", "--domains-dir", ".", "--no-png", "--clutter", "high", "--style", "open"];
    run_well(home.path(), &[&request[..], &["--seed", "3", "--out", "lived_in"]].concat());
    let world = fs::read_to_string(home.path().join("lived_in/world.json")).unwrap();
    assert!(world.contains("star_atlas_3") && world.contains("_mug_1"), "things lie on shelves and desks");
    assert!(!world.contains("workshop_1"), "another room took its place");
    for file in ["clutter.toml", "layouts.toml"] {
        fs::remove_file(folder.join(file)).unwrap();
    }

    // A mistake is named with its place.
    let broken = block(&guide, "toml", "version = 1").replace("anchor = \"desk\"", "anchor = \"desc\"");
    fs::write(folder.join("domain.toml"), broken).unwrap();
    let output = run(home.path(), &["domains", "validate", "observatory"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(said.contains("/groups/0/anchor") && said.contains("`desc`"), "{said}");
}
