//! Every fixture through the real client: the project's own, and those of the shared reference material where it is
//! (or of the folder that `D3DGEN_LLM_FIXTURES` names).

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::cases::Case;
use crate::check::check;
use crate::server::Reply;

/// Folders of fixtures that are not about language models.
const OTHERS: &[&str] = &["web"];

fn read(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    paths
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap().to_string_lossy().into_owned()
}

/// Returns the fixtures of a folder with one file for each exchange.
fn exchanges(root: &Path) -> Vec<Case> {
    let folders = entries(root).into_iter().filter(|p| p.is_dir() && !OTHERS.contains(&stem(p).as_str()));
    let files = folders.flat_map(|f| entries(&f));
    let case = |file: PathBuf| {
        let folder = stem(file.parent().unwrap());
        Case::of(&folder, &stem(&file), read(&file))
    };
    files.filter(|f| f.extension().is_some_and(|e| e == "json")).map(case).collect()
}

async fn play_all(cases: Vec<Case>) -> usize {
    let count = cases.len();
    // The answer that a paused turn goes on to.
    let end = cases.iter().find(|c| c.fixture["expect"]["n_citations"].is_number() && c.name.starts_with("anthropic/"));
    let end: Option<Reply> = end.map(|c| c.replies[0].clone());
    let mut failed = Vec::new();
    for mut case in cases {
        if case.fixture["expect"].get("continue").is_some() {
            case.replies.push(end.clone().expect("a paused turn needs an answer to go on to"));
        }
        let name = case.name.clone();
        // In a task of its own, so that one that fails does not hide the others.
        let task = tokio::spawn(async move {
            let outcome = case.play().await;
            check(&case, &outcome);
        });
        if task.await.is_err() {
            failed.push(name);
        }
    }
    assert!(failed.is_empty(), "{} of {count} fixtures are not as expected: {failed:?}", failed.len());
    count
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_projects_own_fixtures_are_as_expected() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let mut providers: Vec<&str> = d3dgen_llm::providers::all().iter().map(|e| e.name).collect();
    providers.sort_unstable();
    assert_eq!(entries(&root).iter().map(|p| stem(p)).collect::<Vec<_>>(), providers, "a file for each provider");
    for file in entries(&root) {
        let fixtures = read(&file).as_array().cloned().unwrap_or_else(|| panic!("{} is no list", file.display()));
        let cases: Vec<Case> = fixtures.into_iter().map(|f| Case::own(&stem(&file), f)).collect();
        // What every provider has to get right, by the category that comes of it.
        let needed = [
            "truncated",
            "rate_limited",
            "quota_exhausted",
            "unavailable",
            "auth",
            "model_not_found",
            "bad_request",
            "too_long",
            "bad_response",
        ];
        for category in needed {
            let has = cases.iter().any(|c| c.fixture["expect"]["error"] == category);
            assert!(has, "{} has no case of {category}", file.display());
        }
        assert!(cases.iter().any(|c| c.fixture["expect"]["json"].is_object()), "{}", file.display());
        play_all(cases).await;
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_shared_fixtures_are_as_expected() {
    let elsewhere = std::env::var_os("D3DGEN_LLM_FIXTURES").map(PathBuf::from);
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/llm/fixtures");
    let root = elsewhere.unwrap_or(shared);
    if !root.is_dir() {
        println!("skipped: there is no {}", root.display());
        return;
    }
    let count = play_all(exchanges(&root)).await;
    println!("{count} fixtures of {}", root.display());
    assert!(count > 0);
}
