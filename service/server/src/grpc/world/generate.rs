//! All stages in one call, with an event for each.

use std::sync::Arc;

use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::Placements;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::generate::{Artifact, Event, Settings, Stage, contradictions, furnish_and_check};
use d3dgen_pipeline::{Error, brief};
use d3dgen_proto::v1::generate_world_request::Start;
use d3dgen_proto::v1::generate_world_response::Event as Sent;
use d3dgen_proto::v1::{GenerateWorldRequest, GenerateWorldResponse, Progress, Stage as StageMessage};
use tonic::Status;

use super::{building, checked, has_locked_rooms, world_named};
use crate::convert::{document, message};
use crate::grpc::Api;
use crate::grpc::domain::plugin;
use crate::grpc::outbox::{Inbox, Outbox, Weight};
use crate::pool::{self, Lane, Stop, StopOnDrop};
use crate::status::{self, invalid, reason};

/// Attempts of one call at most.
const ATTEMPTS: u32 = 100;
/// Shares of an attempt's time that the stages take, about.
const SHARES: [f64; Stage::ALL.len()] = [0.05, 0.25, 0.5, 0.05, 0.15];
/// Share of the way that the attempt under way takes of what is left.
const ATTEMPT: f64 = 0.9;

/// What is sent; the work ends when nobody takes it any more.
pub type Events = Inbox<GenerateWorldResponse>;

impl Api {
    /// Starts the stages and returns what they send.
    pub(super) fn generate(&self, asked: GenerateWorldRequest) -> Result<Events, Status> {
        let start = crate::grpc::required("start", asked.start)?;
        let name = world_named(asked.name)?;
        if asked.attempt_count > ATTEMPTS {
            return Err(invalid("attempt_count", format!("is {}, at most {ATTEMPTS}", asked.attempt_count)));
        }
        let outbox = Outbox::new();
        let stop = Stop::default();
        let guard = StopOnDrop(Arc::clone(&stop));
        let (pool, core) = (Arc::clone(&self.core), Arc::clone(&self.core));
        let (pins, attempts, allow) =
            ((asked.pinned_floorplan, asked.pinned_placements), asked.attempt_count, asked.allow_conflicts);
        let send = outbox.clone();
        let queue = pool::spawn(async move {
            let answers = send.clone();
            let done = pool.pool.run_with(Lane::Work, stop, move |stop| {
                let pinned: Option<Floorplan> = pins.0.map(|p| document("pinned_floorplan", Some(p))).transpose()?;
                let kept: Option<Placements> = pins.1.map(|p| document("pinned_placements", Some(p))).transpose()?;
                let mut settings =
                    Settings { name, pinned_floorplan: pinned, pinned_placements: kept, ..Settings::default() };
                if attempts > 0 {
                    settings.attempts = attempts;
                }
                let from = match &start {
                    Start::Building(_) => "building",
                    Start::SceneGraph(_) => "scene_graph",
                };
                let now = core.domains.now();
                let mut told = Told { send: answers, seed: 0, begun: 0.0, fraction: 0.0 };
                let graph = match start {
                    Start::Building(asked) => {
                        let request = building(Some(asked))?;
                        told.hear(Event::Started(Stage::SceneGraph, 0));
                        let made = brief::rooms(&request, &now.registry).map_err(|e| status::stage("building", e))?;
                        settings.brief = made.1;
                        made.0
                    }
                    Start::SceneGraph(graph) => document::<SceneGraph>("scene_graph", Some(graph))?,
                };
                plugin(&now, "scene_graph.domain", &graph.domain)?;
                let contradicting = contradictions(&graph);
                if !allow && !contradicting.is_empty() {
                    let said = contradicting.join("; ");
                    let field = if from == "building" { "building.prompt" } else { "scene_graph.conflicts" };
                    let refused = invalid(field, format!("contradicts itself: {said}; or set allow_conflicts"));
                    return Err(status::because_of(reason::CONTRADICTS, &[("conflicts", &said)], &refused));
                }
                told.hear(Event::Finished(Stage::SceneGraph, 0, Artifact::SceneGraph(&graph)));
                let made = furnish_and_check(&graph, &now.registry, &settings, &mut |e| told.hear(e), stop);
                let made = made.map_err(|e| status::stage(at_fault(&e, from, &settings), e))?;
                told.end(checked(&made.world, &made.report), made.attempts.saturating_sub(1));
                Ok(())
            });
            if let Err(refused) = done.await {
                send.end(Err(refused));
            }
        });
        Ok(outbox.inbox(guard, queue))
    }
}

/// Returns the field of the request that a stage refuses.
fn at_fault(error: &Error, from: &'static str, settings: &Settings) -> &'static str {
    let (Error::Refused { stage, .. } | Error::Mismatch { stage, .. }) = error else { return from };
    match *stage {
        "floorplan" if settings.pinned_floorplan.as_ref().is_some_and(has_locked_rooms) => "pinned_floorplan",
        "placement" if settings.pinned_placements.is_some() => "pinned_placements",
        _ => from,
    }
}

/// Tells a client what the stages do.
struct Told {
    send: Outbox<GenerateWorldResponse>,
    /// Seed of the attempt under way.
    seed: u64,
    /// Fraction at which the attempt under way began.
    begun: f64,
    fraction: f64,
}

impl Told {
    fn hear(&mut self, event: Event<'_>) {
        let (stage, attempt, sent, text) = match event {
            Event::Started(stage, attempt) => (stage, attempt, None, format!("{} begins", stage.name())),
            Event::Furnished(attempt, room) => {
                let share = room.done as f64 / room.total.max(1) as f64;
                let placements = room.placements.to_vec();
                let placements = Placements { version: 1, seed: self.seed, placements, unplaced: Vec::new() };
                let sent = Sent::Placements(message(&placements));
                let text = format!("{} is furnished, {} of {} rooms", room.room_id, room.done, room.total);
                let news = self.news(Stage::Placement, attempt, Some(sent), text, self.at(Stage::Placement, share));
                return self.send.tell(Weight::Passing, news);
            }
            Event::Rejected(attempt, reason) => {
                self.begun = self.fraction;
                let sent = Sent::Rejected(reason.to_owned());
                let news = self.news(Stage::World, attempt, Some(sent), reason.to_owned(), self.begun);
                return self.send.tell(Weight::Passing, news);
            }
            Event::Finished(stage, attempt, artifact) => {
                let sent = match artifact {
                    Artifact::SceneGraph(graph) => Sent::SceneGraph(message(graph)),
                    Artifact::Floorplan(plan) => {
                        self.seed = plan.seed;
                        Sent::Floorplan(message(plan))
                    }
                    Artifact::Placements(placements) => Sent::Placements(message(placements)),
                    Artifact::Scenario(scenario) => Sent::Scenario(message(scenario)),
                    // the last one is sent at the end: another attempt may follow
                    Artifact::World(..) => return,
                };
                (stage, attempt, Some(sent), format!("{} is done", stage.name()))
            }
        };
        let (share, weight) = if sent.is_some() { (1.0, Weight::Kept) } else { (0.0, Weight::Passing) };
        let news = self.news(stage, attempt, sent, text, self.at(stage, share));
        self.send.tell(weight, news);
    }

    /// Returns how far the call is when a share of a stage is done.
    ///
    /// An attempt takes most of what the ones before it have left: most worlds need one.
    fn at(&self, stage: Stage, share: f64) -> f64 {
        let before: f64 = SHARES[..stage as usize].iter().sum();
        self.begun + (1.0 - self.begun) * ATTEMPT * (before + share * SHARES[stage as usize])
    }

    fn end(&mut self, world: d3dgen_proto::v1::CheckedWorld, attempt: u32) {
        let news = self.news(Stage::World, attempt, Some(Sent::World(world)), "the world is done".into(), 1.0);
        self.send.end(Ok(news));
    }

    fn news(
        &mut self,
        stage: Stage,
        attempt: u32,
        event: Option<Sent>,
        text: String,
        fraction: f64,
    ) -> GenerateWorldResponse {
        self.fraction = self.fraction.max(fraction);
        let progress = Progress { stage: stage.name().into(), fraction: self.fraction, message: text };
        let stage = match stage {
            Stage::SceneGraph => StageMessage::SceneGraph,
            Stage::Floorplan => StageMessage::Floorplan,
            Stage::Placement => StageMessage::Placement,
            Stage::Scenario => StageMessage::Scenario,
            Stage::World => StageMessage::World,
        };
        GenerateWorldResponse { progress: Some(progress), stage: stage as i32, attempt, event }
    }
}
