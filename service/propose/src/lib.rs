//! Proposals of a language model for the scene graph, the floorplan and the placement of a world.
//!
//! A model is asked with the rules that apply, the ids that there are and examples that the rules engine made for the
//! domain. What it says is a proposal: each room, connection and object is judged by the rules that hold for everything,
//! repaired where a near place is sound, and left out otherwise; the [`Proposal`] says what became of it. A stage whose
//! proposal is of no use is as without a model, byte for byte, so that the world is as sound as any other.
//!
//! Related: D3D-GEN (arXiv 2608.11876) for retrieved constraints as bullets, strict JSON and examples of the domain.
//!
//! It knows no network, file, clock or runtime: whoever calls it hands in how to ask ([`Proposer::ask`]).

mod ask;
pub mod examples;
mod floorplan;
pub mod json;
mod placement;
mod prompt;
mod scene_graph;

use std::sync::atomic::AtomicBool;

use d3dgen_knowledge::Retrieval;
use d3dgen_llm::{Answer, Client, Error as LlmError, Request as LlmRequest};
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::Placements;
use d3dgen_model::proposal::{Proposal, TokenUsage};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::generate::{Event, Generated, Settings, Stage, finish, furnish_and_check, plugin_of, world_name};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::{Error, Stop};
use d3dgen_plugins::{Plugin, Registry};

/// The stages that a model can propose something for.
pub const STAGES: [Stage; 3] = [Stage::SceneGraph, Stage::Floorplan, Stage::Placement];

/// What came of a question to a model.
#[derive(Debug, Clone)]
pub struct Asked {
    /// The answer, with checked JSON, or why there is none.
    pub answer: Result<Answer, LlmError>,
    /// What it took.
    pub usage: TokenUsage,
}

impl Asked {
    /// Returns an answer with what it took, as the client's records tell.
    pub fn new(client: &Client, stage: &str, answer: Result<Answer, LlmError>) -> Self {
        let record = client.budget().records().into_iter().rev().find(|r| r.stage == stage);
        let usage = record.map_or_else(TokenUsage::default, |r| TokenUsage {
            input: r.usage.input,
            output: r.usage.output.saturating_add(r.usage.thoughts),
            tries: r.tries,
        });
        Self { answer, usage }
    }
}

/// Who is asked, and for what.
pub struct Proposer<'a> {
    /// Stages to ask for, of [`STAGES`].
    pub stages: Vec<Stage>,
    /// Name of the provider, for the record.
    pub provider: String,
    /// Name of the model, for the record.
    pub model: String,
    /// Asks and waits. The answer's JSON is checked against the schema of the request.
    pub ask: &'a dyn Fn(&LlmRequest) -> Asked,
    /// Hears which stage is being asked for.
    pub say: &'a dyn Fn(Stage),
}

/// A world with the record of its proposals.
#[derive(Debug, Clone)]
pub struct Proposed {
    /// The world with its verdict.
    pub made: Generated,
    /// What was proposed and what became of it.
    pub proposal: Proposal,
}

/// Makes and checks a world, with proposals for some of its stages.
///
/// `graph` is the scene graph of the request without proposals. As
/// [`d3dgen_pipeline::generate::furnish_and_check`] when nothing of the proposals is of use.
///
/// # Errors
/// What the stages return without proposals; trouble with the model is no error but a line of the record.
pub fn generate(
    request: &Request,
    graph: &SceneGraph,
    registry: &Registry,
    settings: &Settings,
    proposer: &Proposer<'_>,
    observe: &mut dyn FnMut(Event<'_>),
    cancelled: &AtomicBool,
) -> Result<Proposed, Error> {
    let plugin = plugin_of(registry, graph)?;
    let name = settings.name.clone().unwrap_or_else(|| world_name(graph));
    let mut desk = Desk { request, registry, plugin, settings, proposer, observe, cancelled, name, trouble: None };
    let mut stages = Vec::new();
    let asks = |stage: Stage| proposer.stages.contains(&stage);
    let mut wished = None;
    let mut base = None;
    if asks(Stage::SceneGraph) {
        let (found, record) = scene_graph::propose(&mut desk, graph)?;
        base = found;
        wished = Some(stages.len());
        stages.push(record);
    }
    let mut base = match base {
        Some(base) => base,
        None => furnish_and_check(graph, registry, settings, desk.observe, cancelled)?,
    };
    if asks(Stage::Floorplan) {
        let (found, record) = floorplan::propose(&mut desk, &base)?;
        base = found.unwrap_or(base);
        stages.push(record);
    }
    if asks(Stage::Placement) {
        let (found, record) = placement::propose(&mut desk, &base)?;
        base = found.unwrap_or(base);
        stages.push(record);
    }
    if let Some(record) = wished.and_then(|i| stages.get_mut(i)) {
        scene_graph::look_at_wishes(record, &base.world);
    }
    let proposal = Proposal {
        version: 1,
        world: base.world.name.clone(),
        seed: base.world.scene_graph.seed,
        provider: proposer.provider.clone(),
        model: proposer.model.clone(),
        stages,
    };
    Ok(Proposed { made: base, proposal })
}

/// What every stage needs at hand.
struct Desk<'d, 'o> {
    request: &'d Request,
    registry: &'d Registry,
    plugin: &'d dyn Plugin,
    settings: &'d Settings,
    proposer: &'d Proposer<'d>,
    observe: &'o mut dyn FnMut(Event<'_>),
    cancelled: &'d AtomicBool,
    name: String,
    /// Why no further question is worth asking.
    trouble: Option<LlmError>,
}

impl Desk<'_, '_> {
    fn stop(&self) -> Stop<'_> {
        self.cancelled.into()
    }

    /// Goes on unless the caller wants to stop.
    fn check(&self) -> Result<(), Error> {
        self.stop().check()
    }

    /// Puts a world together and judges it.
    fn judged(
        &self,
        (graph, retrieved): (&SceneGraph, &Retrieval),
        plan: Floorplan,
        placements: Placements,
    ) -> Result<Generated, Error> {
        let domain = self.plugin.domain();
        let (world, report) = finish(
            &self.name,
            graph.clone(),
            (plan, placements),
            domain,
            retrieved,
            self.settings.brief.clone(),
            None,
        )?;
        Ok(Generated { world, report, attempts: 1 })
    }
}

/// Returns true for what says that a proposal does not work out, as opposed to what ends the whole run.
fn works_not_out(error: &Error) -> bool {
    !matches!(error, Error::Cancelled)
}
