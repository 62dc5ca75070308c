//! Whole runs without a language model, over documents made up for it in `run/documents`.

#![allow(clippy::unwrap_used)] // helpers of tests are tests

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use d3dgen_model::document::Document;
use d3dgen_model::knowledge::{Constraint, KnowledgeBase, Reference, Value};
use d3dgen_research::read::{self, pdf};
use d3dgen_research::run::{BoxFuture, Context, Facts, Fetch, Outcome, Page, Plan, Stage, Status, Stop, places, run};
use d3dgen_research::{Error, corpus::Corpus};
use tempfile::TempDir;

const STAGE_FILES: [&str; 5] =
    ["documents.jsonl", "passages.jsonl", "constraints.jsonl", "corpus.json", "knowledge.json"];
/// Names this test program to itself when it reads a PDF file.
const PDF_CHILD: &str = "pdf-child";

fn documents() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/run/documents").display().to_string()
}

/// The process that reads a PDF file: this program again, with two figures behind the names of tests.
#[test]
fn pdf_child() {
    let arguments: Vec<String> = std::env::args().collect();
    let Some(at) = arguments.iter().position(|a| a == PDF_CHILD) else { return };
    let figure = |i: usize| arguments[at + i].parse().unwrap();
    pdf::run_child(std::io::stdin().lock(), std::io::stdout().lock(), figure(1), figure(2)).unwrap();
}

fn options() -> read::Options {
    let arguments = ["pdf_child", "--exact", "--nocapture", PDF_CHILD].map(str::to_owned).to_vec();
    let program = pdf::Program { path: std::env::current_exe().unwrap(), arguments, limits: pdf::Limits::default() };
    read::Options { pdf: Some(program), ..read::Options::default() }
}

/// Pages by address; an address that is not there fails.
#[derive(Default)]
struct Pages {
    by_url: BTreeMap<String, String>,
    asked: AtomicUsize,
    stop_after: Option<usize>,
    stop: AtomicBool,
}

impl Pages {
    fn of(pages: &[(&str, &str)]) -> Self {
        Self { by_url: pages.iter().map(|(u, t)| ((*u).to_owned(), (*t).to_owned())).collect(), ..Self::default() }
    }
}

impl Fetch for Pages {
    fn get<'a>(&'a self, url: &'a str) -> BoxFuture<'a, Result<Page, Error>> {
        Box::pin(async move {
            let asked = self.asked.fetch_add(1, Ordering::SeqCst) + 1;
            if self.stop_after.is_some_and(|n| asked >= n) {
                self.stop.store(true, Ordering::SeqCst);
            }
            let text = self.by_url.get(url).ok_or_else(|| Error::Problems(vec!["is not there".into()]))?;
            Ok(Page {
                bytes: text.clone().into_bytes(),
                content_type: Some("text/html; charset=utf-8".into()),
                url: Some(url.to_owned()),
                retrieved_at: "2026-11-20".into(),
            })
        })
    }
}

fn plan(out: &Path, words: &[&str]) -> Plan {
    let words: Vec<String> = words.iter().map(|w| (*w).to_owned()).collect();
    Plan {
        out: out.to_path_buf(),
        from: Stage::Documents,
        domain: Some("hospital".into()),
        country: None,
        date: Some("2026-11-21".into()),
        places: places(&words).unwrap(),
        sources: None,
        flags: Facts::default(),
        overwrite: false,
    }
}

fn start(plan: &Plan, pages: &Pages) -> Result<Outcome, Error> {
    let read = options();
    let context = Context { date: "2026-11-21", fetch: pages, read: &read, stop: Stop(&pages.stop), progress: &|_| {} };
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(run(&context, plan, None))
}

fn run_documents(out: &Path) -> Outcome {
    start(&plan(out, &[&documents()]), &Pages::default()).unwrap()
}

fn restart(out: &Path, from: Stage) -> Result<Outcome, Error> {
    let plan = Plan { from, domain: None, date: None, places: Vec::new(), ..plan(out, &[]) };
    start(&plan, &Pages::default())
}

fn files(out: &Path) -> BTreeMap<String, Vec<u8>> {
    STAGE_FILES.iter().map(|name| ((*name).to_owned(), std::fs::read(out.join(name)).unwrap())).collect()
}

fn rules(base: &KnowledgeBase) -> impl Iterator<Item = (&Reference, &Constraint)> {
    base.references.iter().flat_map(|r| r.constraints.iter().map(move |c| (r, c)))
}

fn has(base: &KnowledgeBase, place: &str, space: &str, name: &str, kind: &str, value: &Value, unit: &str) -> bool {
    rules(base).any(|(r, c)| {
        r.jurisdiction == place
            && c.space_type == space
            && c.name.contains(name)
            && c.constraint_type == kind
            && c.value == *value
            && c.unit == unit
    })
}

#[test]
fn documents_become_a_knowledge_base() {
    let out = TempDir::new().unwrap();
    let outcome = run_documents(out.path());
    assert_eq!(outcome.execution.status, Status::Complete, "{:?}", outcome.execution.warnings);
    let base = &outcome.knowledge;
    let number = Value::Number;
    for (place, space, name, kind, value, unit) in [
        ("ZZ", "patient_room_single", "floor_area", "minimum", number(16.0), "m^2"),
        ("ZZ", "corridor", "clear_width", "minimum", number(2.4), "m"),
        ("ZZ", "treatment_room", "floor_area", "minimum", number(14.0), "m^2"),
        ("ZZ", "waiting_area", "floor_area", "minimum", number(10.5), "m^2"),
        ("DE", "corridor", "clear_width", "minimum", number(2.4), "m"),
        ("DE", "door", "width", "minimum", number(0.9), "m"),
        ("DE", "patient_room_single", "floor_area", "minimum", number(16.0), "m^2"),
        ("DE", "patient_room", "illuminance", "minimum", number(300.0), "lx"),
        ("INT", "ramp", "slope", "maximum", number(0.0833333), "ratio"),
        ("INT", "door", "clear_width", "minimum", number(0.9), "m"),
        ("ZZ", "stair", "width", "minimum", number(1.5), "m"),
    ] {
        assert!(
            has(base, place, space, name, kind, &value, unit),
            "{place} {space} {name} {value:?}\n{}",
            base.to_json()
        );
    }
    for (_, constraint) in rules(base) {
        for figure in [99.0, 500.0, 24.0, 1998.0, 12.0, 1200.0, 2019.0] {
            assert_ne!(constraint.value, number(figure), "{}", constraint.note);
        }
        assert_eq!(constraint.verified, "seen");
        assert!(constraint.note.contains('"') && !constraint.source_ids.is_empty());
    }
    let text = std::fs::read_to_string(out.path().join("passages.jsonl")).unwrap();
    assert!(!text.contains("IGNORE PREVIOUS"), "hidden text was read");
}

#[test]
fn evidence_is_the_quoted_sentence_and_duplicates_keep_all_of_it() {
    let out = TempDir::new().unwrap();
    run_documents(out.path());
    let text = |name: &str| std::fs::read_to_string(out.path().join(name)).unwrap();
    let json = |line: &str| serde_json::from_str::<serde_json::Value>(line).unwrap();
    let passages: BTreeMap<(String, String), String> = text("passages.jsonl")
        .lines()
        .map(json)
        .map(|p| {
            let word = |key: &str| p[key].as_str().unwrap().to_owned();
            ((word("document_id"), word("passage_id")), word("text"))
        })
        .collect();
    for found in text("constraints.jsonl").lines().map(json) {
        let evidence = &found["evidence"];
        let word = |key: &str| evidence[key].as_str().unwrap().to_owned();
        let passage = &passages[&(word("document_id"), word("passage_id"))];
        let end = |i: usize| evidence["span"][i].as_u64().unwrap() as usize;
        assert_eq!(passage[end(0)..end(1)].trim(), word("quote"));
        assert!(word("quote").contains(&word("printed")), "{found}");
    }
    // The ordinance says 2,40 m and the guide 240 cm: one rule, two places, the ordinance first.
    let corpus = Corpus::from_json(&text("corpus.json")).unwrap();
    let german = corpus
        .constraints
        .iter()
        .find(|c| c.jurisdiction.as_deref() == Some("DE") && c.space == "corridor" && c.value == Value::Number(2.4));
    assert_eq!(german.unwrap().evidence.len(), 2, "{german:#?}");
    let base = KnowledgeBase::from_json(&text("knowledge.json")).unwrap();
    let (reference, rule) = rules(&base).find(|(r, c)| r.jurisdiction == "DE" && c.space_type == "corridor").unwrap();
    assert_eq!(rule.source_ids.len(), 2);
    assert_eq!(reference.sources[0].source_type, "regulation");
    assert_eq!(reference.sources[0].url.as_deref(), Some("https://recht.example.org/pflege"));
    assert!(reference.ref_id.starts_with("hospital_de_verordnung_ueber_den_bau_von_pflegestationen"));
}

#[test]
fn every_restart_gives_the_same_bytes() {
    let out = TempDir::new().unwrap();
    run_documents(out.path());
    let first = files(out.path());
    for (from, lost) in [
        (Stage::Passages, &STAGE_FILES[2..]),
        (Stage::Constraints, &STAGE_FILES[3..]),
        (Stage::Corpus, &STAGE_FILES[4..]),
    ] {
        lost.iter().for_each(|name| std::fs::remove_file(out.path().join(name)).unwrap());
        restart(out.path(), from).unwrap();
        assert_eq!(files(out.path()), first, "{from:?}");
    }
}

#[test]
fn the_order_and_the_place_of_documents_change_nothing() {
    let (a, b, elsewhere) = (TempDir::new().unwrap(), TempDir::new().unwrap(), TempDir::new().unwrap());
    let copy = |from: &str, to: &str| {
        let to: PathBuf = elsewhere.path().join(to);
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(Path::new(&documents()).join(from), to).unwrap();
    };
    for name in ["ward_guide.html", "robots.md", "de/pflege.html", "de/hinweise.txt", "de/sources.toml", "fire.pdf"] {
        copy(name, name);
    }
    run_documents(a.path());
    start(&plan(b.path(), &[&elsewhere.path().display().to_string()]), &Pages::default()).unwrap();
    assert_eq!(files(a.path()), files(b.path()));

    let one = |out: &Path, words: &[&str]| {
        let words: Vec<String> = words.iter().map(|w| format!("{}/{w}", documents())).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        start(&plan(out, &words), &Pages::default()).unwrap().knowledge
    };
    let (c, d) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    assert_eq!(one(c.path(), &["robots.md", "ward_guide.html"]), one(d.path(), &["ward_guide.html", "robots.md"]));
}

#[test]
fn edited_files_are_taken_as_they_are_and_never_overwritten_unseen() {
    let out = TempDir::new().unwrap();
    run_documents(out.path());
    let path = out.path().join("constraints.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    let edited = text.replace("\"value\":2.0", "\"value\":2.25");
    assert_ne!(edited, text);
    std::fs::write(&path, &edited).unwrap();

    let refused = restart(out.path(), Stage::Passages).unwrap_err().to_string();
    assert!(refused.contains("constraints.jsonl: was edited") && refused.contains("--from constraints"), "{refused}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), edited);

    let base = restart(out.path(), Stage::Constraints).unwrap().knowledge;
    assert!(rules(&base).any(|(_, c)| c.space_type == "corridor" && c.value == Value::Number(2.25)));
    let plan = Plan { from: Stage::Passages, overwrite: true, places: Vec::new(), ..plan(out.path(), &[]) };
    let base = start(&plan, &Pages::default()).unwrap().knowledge;
    assert!(rules(&base).any(|(_, c)| c.space_type == "corridor" && c.value == Value::Number(2.0)));
}

#[test]
fn every_problem_of_a_stage_file_is_named_with_its_line() {
    let out = TempDir::new().unwrap();
    run_documents(out.path());
    let path = out.path().join("constraints.jsonl");
    let mut lines: Vec<String> = std::fs::read_to_string(&path).unwrap().lines().map(str::to_owned).collect();
    lines[0] = lines[0].replace("\"minimum\"", "\"least\"");
    lines[1] = "{\"name\":".into();
    lines[2] = lines[2].replace("\"confidence\":\"", "\"confidence\":\"very ");
    std::fs::write(&path, lines.join("\n")).unwrap();
    let message = restart(out.path(), Stage::Constraints).unwrap_err().to_string();
    for place in
        ["constraints.jsonl:1: constraint_type `least`", "constraints.jsonl:2: ", "constraints.jsonl:3: confidence"]
    {
        assert!(message.contains(place), "{message}");
    }
    std::fs::remove_file(out.path().join("corpus.json")).unwrap();
    let message = restart(out.path(), Stage::Corpus).unwrap_err().to_string();
    assert!(message.contains("corpus.json: is not there"), "{message}");
    std::fs::write(out.path().join("corpus.json"), "{\"version\": 1}").unwrap();
    let message = restart(out.path(), Stage::Corpus).unwrap_err().to_string();
    assert!(message.contains("corpus.json: ") && message.contains("domain"), "{message}");
}

const PAGE: &str =
    "<html lang=en><title>Rules</title><body><p>Corridors shall be at least 1.5 m wide.</p></body></html>";

#[test]
fn addresses_of_one_page_are_one_document_and_missing_pages_are_said() {
    let out = TempDir::new().unwrap();
    let pages = Pages::of(&[("http://a.test/rules/?utm_source=x", PAGE), ("https://a.test/rules", PAGE)]);
    let words = ["http://a.test/rules/?utm_source=x", "https://a.test/rules", "https://a.test/gone"];
    let outcome = start(&plan(out.path(), &words), &pages).unwrap();
    assert_eq!((outcome.documents, outcome.execution.status), (1, Status::Partial));
    assert!(outcome.execution.warnings.iter().any(|w| w.contains("https://a.test/gone: left out")));
    assert_eq!(outcome.knowledge.references.len(), 1);
    let nothing = start(&plan(out.path(), &["https://a.test/gone"]), &pages).unwrap_err().to_string();
    assert!(nothing.contains("no document could be read") && nothing.contains("a.test/gone"), "{nothing}");
}

#[test]
fn an_interrupted_run_leaves_no_half_file_and_goes_on() {
    let out = TempDir::new().unwrap();
    let all = [("https://a.test/1", PAGE), ("https://a.test/2", "<p>Doors shall be at least 0.9 m wide.</p>")];
    let mut pages = Pages::of(&all);
    pages.stop_after = Some(1);
    let words = ["https://a.test/1", "https://a.test/2"];
    assert_eq!(start(&plan(out.path(), &words), &pages).unwrap_err(), Error::Interrupted);
    assert_eq!(pages.asked.load(Ordering::SeqCst), 1);
    let left: Vec<String> =
        std::fs::read_dir(out.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    assert!(left.is_empty(), "{left:?}");
    let outcome = start(&plan(out.path(), &words), &Pages::of(&all)).unwrap();
    assert_eq!(outcome.documents, 2);
}

#[test]
fn adding_a_document_changes_no_id() {
    let (a, b) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    let one = format!("{}/robots.md", documents());
    let alone = start(&plan(a.path(), &[&one]), &Pages::default()).unwrap().knowledge;
    let all = run_documents(b.path()).knowledge;
    let ids = |base: &KnowledgeBase| -> Vec<String> {
        rules(base).map(|(r, c)| format!("{} {}", r.ref_id, c.constraint_id)).collect()
    };
    let all = ids(&all);
    assert!(!ids(&alone).is_empty());
    for id in ids(&alone) {
        assert!(all.contains(&id), "{id}");
    }
}

#[test]
fn settings_that_cannot_be_used_are_all_named() {
    let out = TempDir::new().unwrap();
    let bad = Plan {
        domain: Some("Hospital!".into()),
        country: Some("Germany".into()),
        date: Some("today".into()),
        ..plan(out.path(), &[&documents()])
    };
    let message = start(&bad, &Pages::default()).unwrap_err().to_string();
    for flag in ["--domain: `Hospital!`", "--country: `Germany`", "--date: `today`"] {
        assert!(message.contains(flag), "{message}");
    }
    let problem = places(&["/no/such/folder".to_owned(), "https://user:secret@a.test/x".to_owned()]).unwrap_err();
    let message = problem.to_string();
    assert!(message.contains("/no/such/folder: ") && message.contains("https://a.test/x"), "{message}");
    assert!(!message.contains("secret"), "{message}");
}
