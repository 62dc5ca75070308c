//! One world: made, timed, written.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use d3dgen_model::document::Document;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::brief;
use d3dgen_pipeline::generate::{Artifact, Event, Settings, Stage, contradictions, furnish_and_check};
use d3dgen_plugins::Registry;

use super::Job;
use super::proposals::{Proposals, lines};
use crate::bundle;
use crate::commands::Formats;
use crate::error::Error;
use crate::input::write_text;
use crate::interrupt;
use crate::output::Output;
use crate::progress::Progress;
use crate::registry::domain;
use crate::stage_clock::StageClock;
use crate::summary::Summary;

/// What all worlds of a run share.
pub struct Maker<'a> {
    pub registry: &'a Registry,
    pub formats: Formats,
    pub allow_conflicts: bool,
    /// A language model to ask, with the stages it is asked for.
    pub proposals: Option<Proposals>,
    /// Ends the work when it becomes true.
    pub flag: &'a AtomicBool,
}

impl Maker<'_> {
    /// Makes a world and writes its folder; of an unsound one only the report and the documents of the stages.
    pub fn make(&self, job: &Job, progress: &Progress) -> Result<Summary, Error> {
        let output = Output::new(&job.path)?;
        let mut settings = Settings { name: job.name.clone(), ..Settings::default() };
        let mut clock = StageClock::default();
        let mut observe = |event: Event<'_>| {
            clock.hear(&event);
            talk(&event, &clock, progress);
        };
        observe(Event::Started(Stage::SceneGraph, 0));
        let (graph, brief) = brief::rooms(&job.request, self.registry)?;
        settings.brief = brief;
        if !self.allow_conflicts {
            refuse_contradictions(&graph)?;
        }
        observe(Event::Finished(Stage::SceneGraph, 0, Artifact::SceneGraph(&graph)));
        let (made, proposal) = match &self.proposals {
            Some(proposals) => {
                let asked = (&job.request, &graph);
                let found = proposals.make(asked, (self.registry, &settings), &mut observe, progress, self.flag)?;
                (found.made, Some(found.proposal))
            }
            None => (furnish_and_check(&graph, self.registry, &settings, &mut observe, self.flag)?, None),
        };
        let begun = Instant::now();
        progress.doing("files");
        let domain = domain(self.registry, &made.world.scene_graph.domain)?.domain();
        bundle::write(&made.world, &made.report, domain, &self.formats, &output)?;
        if let Some(proposal) = &proposal {
            output.write("proposal.json", proposal.to_json().as_bytes())?;
        }
        interrupt::check()?;
        let kept = output.commit()?;
        let mut times = clock.times();
        times.push(("files", begun.elapsed()));
        progress.done(&format!("files ({:.0} ms)", begun.elapsed().as_secs_f64() * 1000.0));
        let proposed = proposal.as_ref().map(lines).unwrap_or_default();
        Ok(Summary::new(&made, &job.path, times).with_proposals(proposed).with_kept(kept))
    }
}

/// Refuses a request that says two things at once.
fn refuse_contradictions(graph: &SceneGraph) -> Result<(), Error> {
    let messages = contradictions(graph);
    if messages.is_empty() {
        return Ok(());
    }
    Err(Error::Input(format!(
        "the prompt contradicts itself: {}; say which you want, or take that with --allow-conflicts",
        messages.join("; ")
    )))
}

fn talk(event: &Event<'_>, clock: &StageClock, progress: &Progress) {
    match event {
        Event::Started(stage, _) => progress.doing(stage.name()),
        Event::Furnished(..) => {}
        Event::Rejected(attempt, reason) => progress.done(&format!("attempt {}: {reason}", attempt + 1)),
        Event::Finished(stage, _, artifact) => {
            let found = match artifact {
                Artifact::SceneGraph(g) => format!("{} rooms, {} connections", g.rooms.len(), g.edges.len()),
                Artifact::Floorplan(p) => {
                    format!("{} walls, {} doors, {} windows", p.walls.len(), p.doors.len(), p.windows.len())
                }
                Artifact::Placements(p) => format!("{} objects", p.placements.len()),
                Artifact::Scenario(s) => {
                    format!("{} robots, {} people, {} areas", s.robots.len(), s.agents.len(), s.rois.len())
                }
                Artifact::World(_, report) => format!("{} rules checked", report.rules.len()),
            };
            progress.done(&format!("{}: {found} ({:.0} ms)", stage.name(), clock.last().as_secs_f64() * 1000.0));
        }
    }
}

/// Prints the JSON line of a world.
pub fn print_json(summary: &Summary) -> Result<(), Error> {
    write_text(None, &format!("{}\n", summary.json()))
}
