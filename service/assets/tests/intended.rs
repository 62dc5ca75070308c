//! Plausibility over the open pack of real models, from the boxes and declarations that the referee read: models that
//! lie become as large as they are meant, and those that do not lie stay as they are. Runs where the pack is there.

use std::path::{Path, PathBuf};

use d3dgen_assets::annotate::look_around;
use d3dgen_assets::catalog::Catalog;
use d3dgen_assets::plausibility::{Declared, Turn, Verdict, judge};
use d3dgen_assets::words;
use d3dgen_model::domain::Domain;
use d3dgen_plugins::{Plugin, Registry};
use serde_json::Value;

type Bounds = [[f64; 3]; 2];

fn pack() -> Option<PathBuf> {
    let pack = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets/open");
    pack.join("MANIFEST.jsonl").is_file().then_some(pack)
}

fn bounds(value: &Value) -> Option<Bounds> {
    serde_json::from_value(value.clone()).ok()
}

fn size(bounds: Bounds, verdict: &Verdict<'_>) -> [f64; 3] {
    let (a, b) = (verdict.turn.apply(bounds[0]), verdict.turn.apply(bounds[1]));
    std::array::from_fn(|i| (a[i] - b[i]).abs() * verdict.scale[i])
}

fn close(a: [f64; 3], b: [f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 0.002_f64.max(0.005 * b.abs()))
}

#[test]
fn lying_models_become_as_large_as_meant_and_others_stay() {
    let Some(pack) = pack() else {
        eprintln!("skipped: the open pack of models is not here");
        return;
    };
    let registry = Registry::builtin();
    let domains: Vec<&Domain> = registry.iter().map(Plugin::domain).collect();
    let catalog = Catalog::new(domains);
    let manifest = std::fs::read_to_string(pack.join("MANIFEST.jsonl")).expect("readable");
    let (mut reached, mut meant, mut kept, mut others) = (0, 0, 0, 0);
    for line in manifest.lines().filter(|l| !l.trim().is_empty()) {
        let entry: Value = serde_json::from_str(line).expect("JSON");
        let (file, truth) = (entry["file"].as_str().expect("a path"), &entry["ground_truth"]);
        let Some(found) = bounds(&truth["bbox_zup"]).or_else(|| bounds(&truth["bbox_stage"])) else { continue };
        let path = pack.join(file);
        let around = look_around(&path, Some(&pack));
        let declared = Declared {
            format: path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default(),
            up_axis: truth["up_axis"].as_str().and_then(|a| a.chars().next()).filter(|a| "XYZ".contains(*a)),
            up_axis_authored: truth["up_axis_authored"].as_bool().unwrap_or(true),
            unit_authored: truth["unit_authored"].as_bool().or(truth["meters_per_unit_authored"].as_bool())
                != Some(false),
            unit_beside: None,
            simulator: around.simulator,
        };
        let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        let names: Vec<Vec<String>> = [stem].iter().chain(&around.folders).map(|n| words::split(n)).collect();
        let verdict = judge(found, &declared, &names, &catalog);
        match serde_json::from_value::<[f64; 3]>(entry["intended"]["size_zup"].clone()) {
            Ok(intended) => {
                meant += 1;
                let is = size(found, &verdict);
                if close(is, intended) {
                    reached += 1;
                } else {
                    println!("{file}: {is:?} m, meant {intended:?} m: {:?}", verdict.changes);
                }
            }
            Err(_) => {
                others += 1;
                if verdict.turn == Turn::None && verdict.scale == [1.0; 3] {
                    kept += 1;
                } else {
                    println!("{file} changed: {:?}", verdict.changes);
                }
            }
        }
    }
    println!("{reached} of {meant} reached, {kept} of {others} others kept");
    assert!(
        f64::from(reached) >= 0.85 * f64::from(meant),
        "{reached} of {meant} models reach the size they are meant to have"
    );
    assert!(f64::from(kept) >= 0.9 * f64::from(others), "{kept} of {others} models that do not lie stay as they are");
}
