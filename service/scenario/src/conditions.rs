//! What is to come of a scenario: robots get to where they work, patients are visited, visitors stay out of where they must.

use std::collections::BTreeSet;

use d3dgen_model::domain::{Domain, RoleKind, tags};
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::scenario::{Condition, ConditionOp, Scenario};

/// Points of a robot that are to be reached, at most.
const MOST_POINTS: usize = 12;

/// Adds the conditions that follow from what people and robots do.
pub(crate) fn add(scenario: &mut Scenario, plan: &Floorplan, domain: &Domain) {
    let mut out = of_robots(scenario);
    out.extend(of_visits(scenario));
    out.extend(of_visitors(scenario, plan, domain));
    // one and the same may follow twice
    let mut known = BTreeSet::new();
    out.retain(|c| known.insert(c.condition_id.clone()));
    scenario.conditions = out;
}

fn condition(op: ConditionOp, subject: &str, room_id: &str, text: String) -> Condition {
    let name = match op {
        ConditionOp::Eventually => "in",
        ConditionOp::Never => "never_in",
        ConditionOp::Before => "first_in",
    };
    let condition_id = format!("{subject}_{name}_{room_id}");
    Condition { condition_id, op, subject: subject.to_owned(), room_id: room_id.to_owned(), then_room_id: None, text }
}

/// Robots get to all points of their jobs, and load before they deliver.
fn of_robots(scenario: &Scenario) -> Vec<Condition> {
    let room = |poi: &String| scenario.pois.iter().find(|p| &p.poi_id == poi).map(|p| p.room_id.as_str());
    let mut out = Vec::new();
    for robot in &scenario.robots {
        for job in &robot.jobs {
            let id = &robot.robot_id;
            let there = job.to.iter().filter_map(room).take(MOST_POINTS);
            out.extend(there.map(|r| condition(ConditionOp::Eventually, id, r, format!("{id} gets to {r}"))));
            let (from, to) = (job.from.as_ref().and_then(room), job.to.first().and_then(room));
            if let (Some(from), Some(to)) = (from, to)
                && from != to
            {
                let text = format!("{id} loads in {from} before it delivers to {to}");
                let first = condition(ConditionOp::Before, id, from, text);
                out.push(Condition { then_room_id: Some(to.to_owned()), ..first });
            }
        }
    }
    out
}

/// Whoever goes to somebody gets there.
fn of_visits(scenario: &Scenario) -> Vec<Condition> {
    let visits = scenario.agents.iter().filter(|a| a.spotlight);
    let visits = visits.flat_map(|a| a.steps.iter().filter_map(move |s| Some((a, s, s.with.as_ref()?))));
    let visits = visits.map(|(agent, step, with)| {
        let text = format!("{} visits {with} in {}", agent.agent_id, step.room_id);
        condition(ConditionOp::Eventually, &agent.agent_id, &step.room_id, text)
    });
    visits.collect()
}

/// Visitors are never in rooms that are closed to all but those who work there.
fn of_visitors(scenario: &Scenario, plan: &Floorplan, domain: &Domain) -> Vec<Condition> {
    let present: BTreeSet<&str> =
        scenario.agents.iter().map(|a| a.role.as_str()).chain(scenario.flows.iter().map(|f| f.role.as_str())).collect();
    let visitors = domain.roles.iter().filter(|r| r.kind == RoleKind::Visitor && present.contains(r.id.as_str()));
    let is_closed = |room_type: &str| {
        let own = domain.tags_of(domain.room_type_or_generic(room_type));
        own.contains(tags::RESTRICTED) || own.contains(tags::DIRTY)
    };
    let closed: Vec<&str> = plan.rooms.iter().filter(|r| is_closed(&r.room_type)).map(|r| r.room_id.as_str()).collect();
    let never = |role: &str, room: &str| condition(ConditionOp::Never, role, room, format!("no {role} is in {room}"));
    visitors.flat_map(|role| closed.iter().map(|room| never(&role.id, room))).collect()
}
