//! What a person set of people's steps: it stays when the scenario is made anew, as far as its rooms and stations are there.

use std::collections::BTreeSet;

use d3dgen_model::scenario::{Agent, Scenario, Station, Step};
use d3dgen_model::{Point, Pose};

use super::ground::Building;
use super::stations;

/// How far off its place a step may be where something stands there now, m.
const OFF_M: f64 = 1.0;

/// Gives locked people the steps that they have in an earlier scenario.
pub(crate) fn keep(scenario: &mut Scenario, before: &Scenario, building: &Building) {
    let people: BTreeSet<String> = scenario.agents.iter().map(|a| a.agent_id.clone()).collect();
    for agent in &mut scenario.agents {
        let Some(own) = before.agents.iter().find(|a| a.locked && a.agent_id == agent.agent_id) else { continue };
        let mut used: Vec<Station> = Vec::new();
        let steps: Vec<Step> =
            own.steps.iter().filter_map(|step| still_there(step, building, &people, &mut used)).collect();
        if steps.is_empty() && !own.steps.is_empty() {
            continue; // nothing of it is left
        }
        // stations are listed by who uses them
        used.retain(|s| !scenario.stations.iter().any(|known| known.station_id == s.station_id));
        scenario.stations.extend(used);
        take(agent, own, steps);
    }
}

/// Returns a step where it is done now; `None` where its room or station is gone. Stations go into `used`.
fn still_there(step: &Step, building: &Building, people: &BTreeSet<String>, used: &mut Vec<Station>) -> Option<Step> {
    let room = building.rooms.iter().find(|r| r.plan.room_id == step.room_id)?;
    let ground = &building.grounds[room.ground];
    let pose = match &step.station {
        Some(id) => {
            let station = stations::of_room(ground, room, step.act).into_iter().find(|s| &s.station_id == id)?;
            let before = station.before;
            if !used.contains(&station) {
                used.push(station);
            }
            before
        }
        None => {
            let at = ground.near(room.plan, Point::new(step.pose.x, step.pose.y), OFF_M)?;
            Pose { x: at.x, y: at.y, ..step.pose }
        }
    };
    let with = step.with.clone().filter(|id| people.contains(id));
    Some(Step { pose, with, ..step.clone() })
}

/// Has somebody take steps, or walk between the rooms that were chosen where there are none.
fn take(agent: &mut Agent, own: &Agent, steps: Vec<Step>) {
    if steps.is_empty() {
        agent.waypoints.clone_from(&own.waypoints);
    } else {
        agent.waypoints = steps.iter().map(|s| s.room_id.clone()).collect();
        agent.waypoints.dedup();
        agent.waypoints.truncate(super::MOST_WAYPOINTS);
    }
    agent.steps = steps;
    agent.locked = true;
}
