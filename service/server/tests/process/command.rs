//! `d3dgen --server URL`: the command asks a server and prints and writes what it would have made itself.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Output;

use d3dgen_tests::{command, files, run_well, workspace};

use crate::support::Server;

/// Runs the command with a token.
fn run(folder: &Path, token: &str, args: &[&str]) -> Output {
    command().args(args).current_dir(folder).env("D3DGEN_TOKEN", token).output().expect("it runs")
}

/// Runs the command and returns what it prints.
fn well(folder: &Path, token: &str, args: &[&str]) -> String {
    let output = run(folder, token, args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

#[test]
fn a_server_answers_as_the_command_does() {
    let dir = tempfile::tempdir().expect("a folder");
    let home = dir.path();
    let server = Server::with_tokens(&home.join("data"), &[]);
    let url = server.url.as_str();
    // worlds: the same files, byte for byte
    let prompt = "apartment with a kitchen, a bathroom and two bedrooms in Germany";
    let make = ["generate", prompt, "--seed", "7", "--out"];
    run_well(home, &[&make[..], &["here"]].concat());
    well(home, "r-secret", &[&make[..], &["there", "--server", url]].concat());
    let (here, there) = (files(&home.join("here")), files(&home.join("there")));
    let names = |all: &BTreeMap<String, Vec<u8>>| all.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&here), names(&there));
    for (name, bytes) in &here {
        assert!(bytes == &there[name], "{name} differs");
    }
    let many =
        ["generate", prompt, "--seed", "8", "--count", "2", "--json", "--no-png", "--out", "many", "--server", url];
    assert_eq!(well(home, "r-secret", &many).lines().count(), 2);
    assert!(home.join("many/8/world.json").exists() && home.join("many/9/plan.svg").exists());
    assert!(!home.join("many/9/plan.png").exists());

    // lists and searches
    for args in [
        &["domains", "list"][..],
        &["domains", "list", "--json"],
        &["domains", "show", "hospital", "--json"],
        &["assets", "search", "office chair", "--limit", "5"],
        &["assets", "search", "--filter", "height<0.5", "--kind", "table", "--json"],
    ] {
        let remote = well(home, "r-secret", &[args, &["--server", url]].concat());
        assert_eq!(remote, run_well(home, args), "{args:?}");
    }
    let search = ["knowledge", "search", "corridor width", "--country", "DE", "--domain", "hospital", "--limit", "5"];
    let store = home.join("store").display().to_string();
    let local = run_well(home, &[&search[..], &["--store", &store]].concat());
    assert_eq!(well(home, "r-secret", &[&search[..], &["--server", url]].concat()), local);

    // who may not, what is not, who is not there
    let school = workspace().join("domains/school").display().to_string();
    let academy = home.join("academy");
    std::fs::create_dir(&academy).expect("a folder");
    for entry in std::fs::read_dir(&school).expect("shipped").flatten().filter(|e| e.path().is_file()) {
        let text = std::fs::read_to_string(entry.path()).expect("text").replace("\"school\"", "\"academy\"");
        std::fs::write(academy.join(entry.file_name()), text).expect("written");
    }
    let register = ["domains", "register", "academy", "--server", url];
    let refused = |token: &str, args: &[&str], said: &str| {
        let output = run(home, token, args);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && text.contains(said), "{args:?}: {:?} {text}", output.status);
        assert!(!text.contains("-secret"), "a token is printed: {text}");
    };
    refused("r-secret", &register, "PERMISSION_DENIED");
    refused("wrong", &register, "--token-file");
    refused("r-secret", &["domains", "show", "nothing", "--server", url], "NOT_FOUND");
    refused("r-secret", &["domains", "list", "--server", "http://127.0.0.1:1"], "127.0.0.1:1");
    refused("r-secret", &["domains", "list", "--server", "ftp://x"], "write http://HOST:PORT");
    refused("r-secret", &["domains", "list", "--server", url, "--store", "x"], "--store x and --server");
    refused("r-secret", &["domains", "register", "academy"], "--server URL");
    assert_eq!(well(home, "w-secret", &register), "academy: registered, version 1\n");
    assert!(well(home, "r-secret", &["domains", "list", "--server", url]).contains("academy"));
    well(home, "w-secret", &["domains", "remove", "academy", "--server", url]);
    refused("w-secret", &["domains", "remove", "academy", "--server", url], "NOT_FOUND");

    // models and jobs; the token of a file
    std::fs::write(home.join("token"), "w-secret\n").expect("written");
    let models = workspace().join("service/assets/tests/models").display().to_string();
    let ingest = ["assets", "ingest", &models, "--json", "--server", url, "--token-file", "token"];
    let said = well(home, "wrong", &ingest);
    let counts: serde_json::Value = serde_json::from_str(said.lines().last().expect("counts")).expect("JSON");
    assert!(counts["added"].as_u64().is_some_and(|n| n > 4), "{said}");
    let listed = well(home, "w-secret", &["jobs", "list", "--json", "--server", url]);
    let job: serde_json::Value = serde_json::from_str(listed.lines().next().expect("a job")).expect("JSON");
    assert_eq!((job["kind"].as_str(), job["state"].as_str()), (Some("ingest"), Some("succeeded")));
    let id = job["job_id"].as_str().expect("an id");
    assert!(well(home, "w-secret", &["jobs", "watch", id, "--json", "--server", url]).contains("succeeded"));
    assert!(well(home, "w-secret", &["jobs", "list", "--server", url]).contains(id));
    refused("w-secret", &["jobs", "cancel", "job-99999999", "--server", url], "NOT_FOUND");
}
