//! The asset database through the command: models in, found, shown, changed, drawn, removed, and what worlds make of it.

use std::path::{Path, PathBuf};

use d3dgen_tests::{digest, program};
use serde_json::Value;
use tempfile::TempDir;

struct Home {
    dir: TempDir,
}

impl Home {
    fn new() -> Self {
        Self { dir: tempfile::tempdir().expect("a folder") }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// Writes a box as OBJ: extents along x, y, z (up), m, and what its folder is called.
    fn model(&self, path: &str, [x, y, z]: [f64; 3]) {
        let file = self.path("models").join(path);
        std::fs::create_dir_all(file.parent().expect("a folder")).expect("made");
        let mut text = String::new();
        for k in 0..8 {
            let at = |i: u32, v: f64| if k >> i & 1 == 0 { 0.0 } else { v };
            text += &format!("v {} {} {}\n", at(0, x) - x / 2.0, at(1, y) - y / 2.0, at(2, z));
        }
        text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
        std::fs::write(file, text).expect("written");
    }

    fn run(&self, args: &[&str]) -> (bool, String, String) {
        let store = self.path("store");
        let mut command = std::process::Command::new(program());
        command.args(args).args(["--store", store.to_str().expect("UTF-8")]).env("D3DGEN_STORE", "");
        let out = command.output().expect("it starts");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (out.status.success(), text(&out.stdout), text(&out.stderr))
    }

    #[track_caller]
    fn ok(&self, args: &[&str]) -> String {
        let (done, out, talk) = self.run(args);
        assert!(done, "{args:?}: {talk}");
        out
    }

    #[track_caller]
    fn refused(&self, args: &[&str]) -> String {
        let (done, out, talk) = self.run(args);
        assert!(!done, "{args:?}: {out}");
        talk
    }
}

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|l| serde_json::from_str(l).unwrap_or_else(|e| panic!("{e}: {l}"))).collect()
}

fn png(path: &Path) -> bool {
    std::fs::read(path).is_ok_and(|bytes| bytes.starts_with(b"\x89PNG"))
}

#[test]
fn models_come_in_are_found_and_go() {
    let home = Home::new();
    home.model("office/Desk_Oslo.obj", [1.7, 0.82, 0.73]);
    home.model("office/copy/Desk_Oslo.obj", [1.7, 0.82, 0.73]);
    home.model("chairs/dining_chair.obj", [44.0, 50.0, 88.0]);
    std::fs::write(home.path("models/broken.glb"), "glTF but not").expect("written");
    std::fs::write(
        home.path("models/chairs/annotation.yaml"),
        "name: dining_chair\ndesc: A chair of kings.\ntags: [domain::residential, kind::chair, hoi::sit, color::red]\n",
    )
    .expect("written");
    let folder = home.path("models");
    let folder = folder.to_str().expect("UTF-8");
    let first = lines(&home.ok(&["ingest", "usdz-folder", folder, "--domain", "Office", "--json"]));
    let counts = first.last().expect("counts");
    assert_eq!((&counts["added"], &counts["unchanged"], &counts["refused"]), (&2.into(), &1.into(), &1.into()));
    let refused = first.iter().find(|l| l["is"] == "refused").expect("the broken one");
    assert_eq!(refused["file"], "broken.glb");
    assert!(!refused["reason"].as_str().expect("a text").is_empty());
    let again = home.ok(&["assets", "ingest", folder, "--domain", "Office"]);
    assert!(again.starts_with("0 added, 0 updated, 3 unchanged, 1 refused"), "{again}");

    let found = lines(&home.ok(&["assets", "search", "Schreibtisch Oslo", "--json", "--limit", "3"]));
    assert_eq!(found[0]["asset_id"], "Office/Desk_Oslo");
    assert!(!found[0]["reasons"].as_array().expect("a list").is_empty());
    let chair: Value =
        serde_json::from_str(&home.ok(&["assets", "show", "Office/dining_chair", "--json"])).expect("JSON");
    assert_eq!(chair["size_m"], serde_json::json!([0.44, 0.5, 0.88]));
    assert_eq!((&chair["changes"][0]["what"], &chair["basis"]["kind"]), (&"unit".into(), &"given".into()));
    assert!(chair["description"].as_str().expect("a text").starts_with("A chair of kings."));
    let low = lines(&home.ok(&["assets", "list", "--origin", "ingested", "-f", "height<0.8", "--json"]));
    assert_eq!(low.len(), 1);
    let like = lines(&home.ok(&["assets", "search", "--like", "Office/Desk_Oslo", "--json", "--limit", "2"]));
    assert!(like.iter().all(|l| l["kind"] == "desk"), "{like:?}");

    let (sheet, picture) = (home.path("sheet.png"), home.path("one.png"));
    home.ok(&["assets", "sheet", "--origin", "ingested", "--out", sheet.to_str().expect("UTF-8"), "--px", "48"]);
    home.ok(&["assets", "show", "Office/Desk_Oslo", "--thumbnail", picture.to_str().expect("UTF-8"), "--px", "64"]);
    assert!(png(&sheet) && png(&picture));
    home.ok(&["assets", "show", "Office/Desk_Oslo", "--thumbnail", picture.to_str().expect("UTF-8")]);
    let desk: Value = serde_json::from_str(&home.ok(&["assets", "show", "Office/Desk_Oslo", "--json"])).expect("JSON");
    let kept = std::fs::read(&picture).expect("written");
    assert_eq!(desk["thumbnail"], serde_json::json!({"size_px": 128, "sha256": digest(&kept)}));

    let out = home.path("out");
    home.ok(&["assets", "export", "Office/Desk_Oslo", "Hospital/HospitalBed", "--out", out.to_str().expect("UTF-8")]);
    for file in ["Office/Object/Desk_Oslo/Desk_Oslo.glb", "Hospital/Object/HospitalBed/HospitalBed.usdz"] {
        assert!(out.join(file).is_file(), "{file}");
    }
    let yaml = std::fs::read_to_string(out.join("Office/Object/Desk_Oslo/annotation.yaml")).expect("written");
    assert!(yaml.contains("- kind::desk") && yaml.contains("name: Desk_Oslo"), "{yaml}");

    home.ok(&["assets", "annotate", "Office/Desk_Oslo", "--set", "name=Treasure table", "--set", "front=+x"]);
    assert_eq!(lines(&home.ok(&["assets", "search", "treasure", "--json"]))[0]["asset_id"], "Office/Desk_Oslo");
    assert!(home.refused(&["assets", "annotate", "Office/Desk_Oslo", "--set", "mount=roof"]).contains("floor, wall"));
    assert!(home.refused(&["assets", "show", "Office/Desk_Osl"]).contains("Office/Desk_Oslo"));
    assert!(home.refused(&["assets", "search", "desk", "-f", "hight<1"]).contains("height"));
    assert!(home.ok(&["assets", "verify"]).contains("nothing wrong"));
    let removed = home.ok(&["assets", "remove", "Office/Desk_Oslo"]);
    assert!(removed.starts_with("1 kept assets"), "{removed}");
    assert!(home.ok(&["assets", "stats"]).contains("1 are kept"));
}

#[test]
fn the_library_needs_no_database_and_objects_are_made() {
    let home = Home::new();
    let store = home.path("none");
    let run = |args: &[&str]| {
        let out =
            std::process::Command::new(program()).args(args).env("D3DGEN_STORE", &store).output().expect("it starts");
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        String::from_utf8_lossy(&out.stdout).into_owned()
    };
    let found = lines(&run(&["assets", "search", "bed for a patient", "--json", "--limit", "5"]));
    assert!(found.iter().any(|f| f["object"] == "hospital_bed"), "{found:?}");
    assert!(!store.exists());
    let made = lines(&home.ok(&["assets", "generate", "wardrobe", "--seed", "3", "--count", "2", "--json"]));
    assert_eq!(made.len(), 2);
    assert_eq!(made[0]["asset_id"], "Residential/Wardrobe_v3");
    assert!(made[0]["annotation"]["triangle_count"].as_u64().expect("a count") > 12);
    assert!(home.refused(&["assets", "generate", "warp_drive"]).contains("warp_drive"));
}

#[test]
fn worlds_use_the_assets_there_are() {
    let home = Home::new();
    let world = |name: &str| -> Value {
        let out = home.path(name);
        let out = out.to_str().expect("UTF-8");
        home.ok(&["generate", "office with 3 meeting rooms", "--seed", "5", "--out", out]);
        serde_json::from_str(&std::fs::read_to_string(Path::new(out).join("world.json")).expect("written"))
            .expect("JSON")
    };
    // Model reference, and the source of the choice.
    let seats = |world: &Value| -> Vec<(String, Option<String>)> {
        let all = world["placements"]["placements"].as_array().expect("a list").iter();
        let chairs = all.filter(|p| p["object"].as_str().is_some_and(|o| o.contains("chair")));
        let text = |v: &Value| v.as_str().map(str::to_owned);
        chairs.map(|p| (text(&p["asset"]).expect("an asset"), text(&p["asset_choice"]["source"]))).collect()
    };
    home.model("odd_bench.obj", [3.0, 0.4, 0.45]);
    let folder = home.path("models");
    let folder = folder.to_str().expect("UTF-8").to_owned();
    home.ok(&["assets", "ingest", &folder]);
    let before = world("before");
    assert!(seats(&before).iter().all(|(asset, source)| asset.starts_with("Office/") && source.is_none()));

    home.ok(&["assets", "remove", "--kind", "chair"]);
    let without = world("without");
    assert!(seats(&without).iter().all(|(_, source)| source.as_deref() == Some("generated")), "{:?}", seats(&without));
    let report = std::fs::read_to_string(home.path("without/report.json")).expect("written");
    assert!(report.contains("objects_made_for_want_of_an_asset"));

    home.model("oak/conference_chair.obj", [0.6, 0.61, 0.93]);
    home.ok(&["assets", "ingest", &folder, "--domain", "Own"]);
    let after = world("after");
    let (own, others): (Vec<_>, Vec<_>) =
        seats(&after).into_iter().partition(|(asset, _)| asset == "Own/conference_chair");
    assert!(!own.is_empty(), "{others:?}");
    assert!(own.iter().all(|(_, source)| source.as_deref() == Some("database")), "{own:?}");
}
