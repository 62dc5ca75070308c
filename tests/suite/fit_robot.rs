//! `--fit-robot`: a narrow robot, a wide one and an impossible one in three domains; what the report, the scenario and
//! `eval` say of the fit is one and the same.

use std::path::Path;

use d3dgen_tests::{run, run_well};
use serde_json::Value;

const PROMPTS: [&str; 3] = [
    "two-bedroom flat in Germany, for a delivery robot",
    "office for 12 people with two meeting rooms, for a delivery robot",
    "hospital ward with 8 rooms in Germany, for a delivery robot",
];

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Makes a world and returns it with its report and the measures of `eval`.
fn made(home: &Path, prompt: &str, flags: &[&str]) -> (Value, Value, Value) {
    let mut args = vec!["generate", prompt, "--seed", "2", "--out", "w"];
    args.extend(flags);
    run_well(home, &args);
    let folder = home.join("w");
    let evaluation = run_well(home, &["eval", "w", "--json", "-"]);
    (json(&folder.join("world.json")), json(&folder.join("report.json")), serde_json::from_str(&evaluation).unwrap())
}

#[test]
fn doors_and_corridors_grow_until_the_robot_fits_and_all_judges_agree() {
    let home = tempfile::tempdir().unwrap();
    for prompt in PROMPTS {
        let mut least_door = Vec::new();
        for size in ["0.40", "0.80"] {
            let flags = ["--robot-width", size, "--robot-length", size, "--robot-height", "1.1", "--fit-robot"];
            let (world, report, evaluation) = made(home.path(), prompt, &flags);
            let fit = &report["robot_fit"][0];
            assert_eq!(fit["fits"], true, "{prompt} {size}: {fit}");
            let needed = 2.0 * fit["radius_m"].as_f64().unwrap();
            let ways = fit["rooms"].as_array().unwrap().iter().chain(fit["points"].as_array().unwrap());
            for way in ways {
                assert!(way["clear_width_m"].as_f64().unwrap() >= needed - 0.002, "{prompt} {size}: {way}");
                assert_ne!(way["narrowest"], "", "{way}");
            }
            let task = &world["scenario"]["robots"][0];
            let goals = task["goals"].as_array().unwrap();
            assert!(task["ways"].as_array().unwrap().len() >= goals.len(), "{task}");
            assert!(task["ways"].as_array().unwrap().iter().all(|w| w["reachable"] == true), "{task}");
            let measured = &evaluation["worlds"][0]["robots"][0];
            assert_eq!(measured["fits"], true, "{prompt} {size}: {measured}");
            assert_eq!(measured["rooms_share"].as_f64(), Some(1.0), "{prompt} {size}: {measured}");
            let doors = world["floorplan"]["doors"].as_array().unwrap();
            let widths = doors.iter().map(|d| d["clear_width_m"].as_f64().unwrap());
            least_door.push(widths.fold(f64::MAX, f64::min));
        }
        assert!(least_door[0] < least_door[1], "{prompt}: {least_door:?}");
    }
}

#[test]
fn a_robot_that_cannot_fit_is_refused_with_one_that_does() {
    let home = tempfile::tempdir().unwrap();
    // offices have room for it, and a studio grows until it has
    for prompt in ["flat with 5 rooms, for a delivery robot", "flat with 7 rooms, for a delivery robot", PROMPTS[2]] {
        let flags = ["generate", prompt, "--seed", "2", "--robot-width", "2.8", "--fit-robot", "--out", "w"];
        let output = run(home.path(), &flags);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{prompt}: {said}");
        assert!(said.contains("does not fit") && said.contains("--robot-turning-radius"), "{prompt}: {said}");
        assert!(!home.path().join("w").exists());
    }
    let output = run(home.path(), &["generate", PROMPTS[0], "--robot-width", "9", "--out", "w"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("width of 9 m"));
}

#[test]
fn without_fitting_the_report_says_where_a_robot_is_stopped() {
    let home = tempfile::tempdir().unwrap();
    std::fs::write(home.path().join("robot.toml"), "width_m = 0.5\nlength_m = 0.6\nheight_m = 0.9\n").unwrap();
    let (_, report, evaluation) = made(home.path(), PROMPTS[1], &["--robot-file", "robot.toml"]);
    let fit = &report["robot_fit"][0];
    assert_eq!((fit["radius_m"].as_f64(), fit["height_m"].as_f64()), (Some(0.391), Some(0.9)));
    assert_eq!(fit["fits"], evaluation["worlds"][0]["robots"][0]["fits"]);
    std::fs::write(home.path().join("bad.toml"), "girth_m = 0.5\n").unwrap();
    let output = run(home.path(), &["generate", PROMPTS[1], "--robot-file", "bad.toml", "--out", "x"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("girth_m"));
}
