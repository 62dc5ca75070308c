//! What robots and people do, under edits: what a person sets is locked, so that it outlives later changes of the plan.

use std::collections::BTreeSet;

use d3dgen_model::edits::StepKept;
use d3dgen_model::scenario::{Agent, Scenario};
use d3dgen_model::stage::Error;

use super::{mismatch, refused};

/// What changes of a job; the rest stays.
pub(super) struct JobChange<'a> {
    pub from: Option<&'a str>,
    pub to: &'a [String],
    pub load_kg: Option<f64>,
    pub seconds: Option<f64>,
}

/// Changes a robot's job.
///
/// # Errors
/// `Mismatch` when there is no such robot, job or point; `Refused` where nothing is to change.
pub(super) fn change_job(
    scenario: &mut Scenario,
    robot_id: &str,
    job_id: &str,
    change: &JobChange,
) -> Result<(), Error> {
    for id in change.from.into_iter().chain(change.to.iter().map(String::as_str)) {
        if !scenario.pois.iter().any(|p| p.poi_id == id) {
            return Err(mismatch(format!("the scenario has no point `{id}`")));
        }
    }
    let known = listed(scenario.robots.iter().map(|r| r.robot_id.as_str()));
    let robot = scenario.robots.iter_mut().find(|r| r.robot_id == robot_id);
    let robot = robot.ok_or_else(|| mismatch(format!("the scenario has no robot `{robot_id}`; it has {known}")))?;
    let known = listed(robot.jobs.iter().map(|j| j.job_id.as_str()));
    let job = robot.jobs.iter_mut().find(|j| j.job_id == job_id);
    let job = job.ok_or_else(|| mismatch(format!("`{robot_id}` has no job `{job_id}`; it has {known}")))?;
    let before = job.clone();
    if let Some(from) = change.from {
        job.from = Some(from.to_owned());
    }
    if !change.to.is_empty() {
        job.to = change.to.to_vec();
    }
    job.load_kg = change.load_kg.unwrap_or(job.load_kg);
    job.seconds = change.seconds.unwrap_or(job.seconds);
    if *job == before {
        return Err(refused(format!("job `{job_id}` of `{robot_id}` is as it is asked to be")));
    }
    robot.locked = true;
    Ok(())
}

/// Puts the steps of a person, or the rooms of one without steps, in another turn.
///
/// # Errors
/// `Mismatch` when there is no such person or step; `Refused` where a step is named twice, none is left or nothing changes.
pub(super) fn change_steps(scenario: &mut Scenario, agent_id: &str, kept: &[StepKept]) -> Result<(), Error> {
    let agent = scenario.agents.iter_mut().find(|a| a.agent_id == agent_id);
    let agent = agent.ok_or_else(|| mismatch(format!("the scenario has nobody called `{agent_id}`")))?;
    let count = if agent.steps.is_empty() { agent.waypoints.len() } else { agent.steps.len() };
    let mut seen: BTreeSet<u32> = BTreeSet::new();
    for step in kept {
        if step.number == 0 || step.number as usize > count {
            return Err(mismatch(format!("`{agent_id}` has no step {}; it has {count}", step.number)));
        }
        if !seen.insert(step.number) {
            return Err(refused(format!("step {} of `{agent_id}` is named twice", step.number)));
        }
    }
    if kept.is_empty() {
        return Err(refused(format!("`{agent_id}` would have nothing to do: name the steps that stay")));
    }
    let before = agent.clone();
    take(agent, kept);
    if *agent == before {
        return Err(refused(format!("the steps of `{agent_id}` are as they are asked to be")));
    }
    agent.locked = true;
    Ok(())
}

fn take(agent: &mut Agent, kept: &[StepKept]) {
    let index = |step: &StepKept| step.number as usize - 1;
    if agent.steps.is_empty() {
        agent.waypoints = kept.iter().map(|step| agent.waypoints[index(step)].clone()).collect();
        return;
    }
    let steps = kept.iter().map(|step| {
        let mut own = agent.steps[index(step)].clone();
        own.seconds = step.seconds.unwrap_or(own.seconds);
        own
    });
    agent.steps = steps.collect();
}

fn listed<'a>(ids: impl Iterator<Item = &'a str>) -> String {
    let ids: Vec<&str> = ids.collect();
    if ids.is_empty() { "none".into() } else { ids.join(", ") }
}
