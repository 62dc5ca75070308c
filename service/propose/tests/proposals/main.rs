//! Answers that are good, half good and hopeless, for every stage and several domains: the world is sound each time, and
//! the record says what became of what was proposed.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on panics where it stands")]

mod floorplan;
mod placement;
mod scene_graph;
mod trouble;

use std::sync::atomic::AtomicBool;

use d3dgen_llm::providers::Replay;
use d3dgen_llm::{Budget, Client, RetryPolicy};
use d3dgen_model::document::Document;
use d3dgen_model::proposal::{FateCounts, Proposal, StageProposal};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::generate::{Generated, Settings, Stage, furnish_and_check};
use d3dgen_pipeline::scene_graph::{Request, generate as graph_of};
use d3dgen_plugins::Registry;
use d3dgen_propose::{Asked, Proposed, Proposer, generate};
use serde_json::{Value, json};

/// A building of each of several domains; `school` is data only.
pub const BUILDINGS: [&str; 4] = [
    "two-bedroom flat in Germany",
    "hospital ward with 8 rooms in Germany, for a delivery robot",
    "office for 12 people in France with 7 rooms",
    "primary school with 6 classrooms, in Germany",
];

/// Says nothing.
static RUNNING: AtomicBool = AtomicBool::new(false);

/// Returns the request of a prompt, with one seed for all.
pub fn request(prompt: &str) -> Request {
    Request { prompt: prompt.to_owned(), seed: 3, ..Request::default() }
}

/// Returns the scene graph without a model.
pub fn own_graph(prompt: &str) -> SceneGraph {
    graph_of(&request(prompt), &Registry::builtin()).unwrap()
}

/// Returns the world without a model.
pub fn own_world(prompt: &str) -> Generated {
    furnish_and_check(&own_graph(prompt), &Registry::builtin(), &Settings::default(), &mut |_| (), &RUNNING).unwrap()
}

/// Returns the line of a recording with an answer.
pub fn line(stage: Stage, text: &str) -> String {
    json!({"stage": stage.name(), "answer": {"text": text, "model": "test-model"}}).to_string()
}

/// Makes a world with the stages of a recording.
pub fn with_recording(prompt: &str, stages: &[Stage], recording: &str) -> Proposed {
    let client = Client::new(Box::new(Replay::new(recording).unwrap()), RetryPolicy::default(), Budget::unlimited());
    with_client(prompt, stages, &client)
}

/// Makes a world with proposals of a client's model, and asserts what holds of every such world.
pub fn with_client(prompt: &str, stages: &[Stage], client: &Client) -> Proposed {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().unwrap();
    let ask = |question: &d3dgen_llm::Request| {
        Asked::new(client, &question.stage, runtime.block_on(client.complete(question)))
    };
    let proposer = Proposer {
        stages: stages.to_vec(),
        provider: client.provider().name().to_owned(),
        model: client.provider().model().to_owned(),
        ask: &ask,
        say: &|_| (),
    };
    let (registry, settings) = (Registry::builtin(), Settings::default());
    let found =
        generate(&request(prompt), &own_graph(prompt), &registry, &settings, &proposer, &mut |_| (), &RUNNING).unwrap();
    assert!(found.made.report.sound, "{prompt}: {:?}", broken(&found.made));
    // the record is a document like the others
    let again = Proposal::from_json(&found.proposal.to_json()).unwrap();
    assert_eq!(again, found.proposal);
    found
}

/// Makes a world with an answer for one stage.
pub fn with_answer(prompt: &str, stage: Stage, answer: &Value) -> Proposed {
    with_recording(prompt, &[stage], &line(stage, &answer.to_string()))
}

/// Returns the record of the one stage that was asked for.
pub fn only(found: &Proposed) -> &StageProposal {
    assert_eq!(found.proposal.stages.len(), 1);
    &found.proposal.stages[0]
}

/// Returns the share of the proposed things that are as proposed, and of those that are so or near it.
pub fn shares(counts: FateCounts) -> (f64, f64) {
    let all = f64::from(counts.proposed().max(1));
    (f64::from(counts.kept) / all, f64::from(counts.kept + counts.moved) / all)
}

/// Asserts that a world is byte for byte the one without a model.
pub fn assert_own(prompt: &str, found: &Proposed) {
    let own = own_world(prompt);
    assert!(found.made.world == own.world, "{prompt}: the world differs from the one without a model");
    assert_eq!(found.made.world.to_json(), own.world.to_json());
    assert_eq!(found.made.report.to_json(), own.report.to_json());
}

fn broken(made: &Generated) -> Vec<String> {
    let violations = made.report.rules.iter().flat_map(|r| &r.violations);
    violations.map(|v| format!("{} {}: {}", v.code, v.subject, v.message)).collect()
}
