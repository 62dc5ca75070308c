//! Proposals of a language model on the way to a world: who is asked, for which stages, and how a command waits for it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::ValueEnum;
use d3dgen_llm::{Answer, Client, Error as LlmError, Request as LlmRequest};
use d3dgen_model::proposal::{Outcome, Proposal, StageProposal};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::generate::{Event, Settings, Stage};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_plugins::Registry;
use d3dgen_propose::{Asked, Proposed, Proposer};
use tokio::runtime::Runtime;

use crate::commands::LlmArgs;
use crate::error::Error;
use crate::progress::Progress;

/// How often a command that waits for a model looks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(100);

/// A stage that a model can propose something for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
enum Proposable {
    /// Rooms, their objects and connections
    SceneGraph,
    /// Outlines of rooms
    Floorplan,
    /// Objects at their places
    Placement,
}

/// Flags of proposals.
#[derive(clap::Args)]
pub struct ProposalArgs {
    /// Stages for which --model is asked; what it proposes is checked, repaired or left out, see proposal.json
    #[arg(long, value_enum, value_delimiter = ',', value_name = "STAGE,...", requires = "model")]
    propose: Vec<Proposable>,
    #[command(flatten)]
    llm: LlmArgs,
}

/// A model that is asked for some stages.
pub struct Proposals {
    client: Client,
    runtime: Runtime,
    stages: Vec<Stage>,
}

impl ProposalArgs {
    /// Returns the model with the stages it is asked for, none when none is named.
    ///
    /// # Errors
    /// `Input` for a model without stages, and as [`LlmArgs::client`].
    pub fn proposals(&self) -> Result<Option<Proposals>, Error> {
        if self.propose.is_empty() && self.llm.model.is_some() {
            return Err(Error::Input(
                "--model: say what it is asked for, with --propose scene_graph,floorplan,placement or some of these"
                    .into(),
            ));
        }
        let Some(client) = self.llm.client()? else { return Ok(None) };
        let asked = |stage: &Proposable| match stage {
            Proposable::SceneGraph => Stage::SceneGraph,
            Proposable::Floorplan => Stage::Floorplan,
            Proposable::Placement => Stage::Placement,
        };
        let stages = self.propose.iter().map(asked).collect();
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime = runtime.map_err(|e| Error::Input(format!("cannot start the network: {e}")))?;
        Ok(Some(Proposals { client, runtime, stages }))
    }

    /// Returns true when a model is named.
    pub fn is_asked(&self) -> bool {
        self.llm.model.is_some() || !self.propose.is_empty()
    }
}

impl Proposals {
    /// Makes a world with proposals.
    ///
    /// # Errors
    /// As [`d3dgen_propose::generate`].
    pub fn make(
        &self,
        (request, graph): (&Request, &SceneGraph),
        (registry, settings): (&Registry, &Settings),
        observe: &mut dyn FnMut(Event<'_>),
        progress: &Progress,
        flag: &AtomicBool,
    ) -> Result<Proposed, Error> {
        let provider = self.client.provider();
        let (provider, model) = (provider.name().to_owned(), provider.model().to_owned());
        let say = |stage: Stage| progress.doing(&format!("asking {model} for a proposal: {}", stage.name()));
        let ask = |question: &LlmRequest| {
            let answer = self.runtime.block_on(self.wait(question, flag));
            Asked::new(&self.client, &question.stage, answer)
        };
        let stages = self.stages.clone();
        let proposer = Proposer { stages, provider, model: model.clone(), ask: &ask, say: &say };
        let found = d3dgen_propose::generate(request, graph, registry, settings, &proposer, observe, flag)?;
        found.proposal.stages.iter().for_each(|stage| talk(stage, progress));
        Ok(found)
    }

    /// Waits for an answer, or for Ctrl-C.
    async fn wait(&self, question: &LlmRequest, flag: &AtomicBool) -> Result<Answer, LlmError> {
        let interrupted = async {
            while !flag.load(Ordering::Relaxed) {
                tokio::time::sleep(LOOK).await;
            }
        };
        tokio::select! {
            answer = self.client.complete(question) => answer,
            () = interrupted => Err(LlmError::Config { message: "interrupted".into() }),
        }
    }
}

/// Says what became of a stage's proposal.
fn talk(stage: &StageProposal, progress: &Progress) {
    let line = format!("proposal for {}: {}", stage.stage, in_words(stage));
    if stage.outcome == Outcome::Used { progress.done(&line) } else { progress.say(&line) }
}

/// Returns what became of a stage's proposal, in a line.
fn in_words(stage: &StageProposal) -> String {
    let c = stage.counts;
    match stage.outcome {
        Outcome::Used => format!(
            "{} kept, {} moved, {} replaced, {} dropped, {} added",
            c.kept, c.moved, c.replaced, c.dropped, c.added
        ),
        Outcome::NotUsed | Outcome::Failed => stage.note.clone(),
    }
}

/// Returns what became of each stage's proposal: its name, and a line.
pub fn lines(proposal: &Proposal) -> Vec<(String, String)> {
    proposal.stages.iter().map(|s| (s.stage.clone(), in_words(s))).collect()
}
