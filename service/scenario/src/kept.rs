//! What a person set of robots' jobs: it stays when the scenario is made anew, as far as its points are still there. Routes
//! follow the jobs.

use std::collections::BTreeSet;

use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::Placements;
use d3dgen_model::scenario::{Poi, RobotJob, RobotTask, Scenario};
use d3dgen_model::scene_graph::SceneGraph;

use super::floor::Floor;
use super::robots;

/// A storey as robots on it see it.
pub(crate) struct Storey<'a> {
    pub level: i32,
    pub graph: &'a SceneGraph,
    pub plan: &'a Floorplan,
    pub placements: &'a Placements,
}

/// Gives locked robots the jobs that they have in an earlier scenario.
pub(crate) fn keep(scenario: &mut Scenario, before: &Scenario, storeys: &[Storey], domain: &Domain) {
    let points: BTreeSet<String> = scenario.pois.iter().map(|p| p.poi_id.clone()).collect();
    let mut changed: BTreeSet<i32> = BTreeSet::new();
    for task in &mut scenario.robots {
        let Some(own) = before.robots.iter().find(|r| r.locked && r.robot_id == task.robot_id) else { continue };
        let jobs: Vec<RobotJob> = own.jobs.iter().filter_map(|job| still_there(job, &points)).collect();
        if !jobs.is_empty() {
            task.goals = goals(&jobs);
            task.jobs = jobs;
            task.locked = true;
            changed.insert(task.level);
        }
    }
    for storey in storeys.iter().filter(|s| changed.contains(&s.level)) {
        find_routes(scenario, storey, domain);
    }
}

/// Returns the points of jobs in their turn, each once.
fn goals(jobs: &[RobotJob]) -> Vec<String> {
    let mut seen: BTreeSet<&str> = BTreeSet::new();
    jobs.iter().flat_map(|j| j.from.iter().chain(&j.to)).filter(|id| seen.insert(id)).cloned().collect()
}

/// Returns a job without the points that are gone; `None` where nothing is left of it.
fn still_there(job: &RobotJob, points: &BTreeSet<String>) -> Option<RobotJob> {
    let is_there = |id: &&String| points.contains(*id);
    let to: Vec<String> = job.to.iter().filter(is_there).cloned().collect();
    let left = !to.is_empty() || !job.path.is_empty();
    left.then(|| RobotJob { from: job.from.clone().filter(|id| points.contains(id)), to, ..job.clone() })
}

/// Looks for the routes of a storey's robots to their goals on it, and how wide their ways are.
fn find_routes(scenario: &mut Scenario, storey: &Storey, domain: &Domain) {
    let floor = Floor::new(storey.graph, storey.plan, storey.placements, domain);
    let here = |p: &&Poi| storey.plan.room(&p.room_id).is_some();
    let pois: Vec<Poi> = scenario.pois.iter().filter(here).cloned().collect();
    let is_here = |task: &RobotTask| task.level == storey.level;
    let own: Vec<RobotTask> = scenario.robots.iter().filter(|t| is_here(t)).cloned().collect();
    let mut alone = Scenario { pois, robots: own, ..Scenario::empty(scenario.seed) };
    robots::add_routes(&floor, &mut alone);
    let Scenario { robots: mut routed, pois, .. } = alone;
    for task in &mut routed {
        if task.robot.body.is_some() {
            let fresh = robots::ways(task, (storey.plan, storey.placements), &pois);
            task.ways.retain(|way| task.goals.contains(&way.to) && !fresh.iter().any(|f| f.to == way.to));
            task.ways.splice(0..0, fresh);
        }
    }
    let mut routed = routed.into_iter();
    for task in scenario.robots.iter_mut().filter(|t| is_here(t)) {
        *task = routed.next().expect("as many as were taken");
    }
}
