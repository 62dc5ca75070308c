//! Rules about people: where they may go, what they use, how fast they walk and how many go together.

use std::collections::BTreeMap;

use d3dgen_model::domain::{RoleKind, VISITORS_NEVER};
use d3dgen_model::scenario::{Agent, Flow, GROUP_SIZES, PERSON_RADIUS_M, Step, WALKING_SPEEDS_M_S};
use d3dgen_model::{Point, Pose, robot_kind};

use super::Findings;
use crate::context::Context;

fn point(pose: &Pose) -> Point {
    Point::new(pose.x, pose.y)
}

/// What is known of those who do something: name, role, steps.
fn all(c: &Context) -> Vec<(String, String, Vec<Step>)> {
    let of_agent = |a: &Agent| (a.agent_id.clone(), a.role.clone(), a.steps.clone());
    let of_flow = |f: &Flow| (f.flow_id.clone(), f.role.clone(), f.steps().cloned().collect());
    let scenario = &c.world.scenario;
    scenario.agents.iter().map(of_agent).chain(scenario.flows.iter().map(of_flow)).collect()
}

/// Nobody goes where its role may not; no visitor to rooms of the staff, to service, dirty or restricted ones.
pub fn access(c: &Context, out: &mut Findings) {
    for (name, role, steps) in all(c) {
        out.look();
        // of roles that the domain does not know nothing is forbidden
        let Some(role) = c.domain.roles.iter().find(|r| r.id == role) else { continue };
        for step in &steps {
            let Some(room) = c.room(&step.room_id) else { continue };
            let kind = c.domain.room_type_or_generic(&room.plan.room_type);
            let tags = c.domain.tags_of(kind);
            let closed = VISITORS_NEVER.iter().find(|tag| role.kind == RoleKind::Visitor && tags.contains(*tag));
            if closed.is_some() || !role.may_enter(kind, &tags) {
                let why = closed.map_or(String::new(), |tag| format!(", which is {tag}"));
                out.add(&name, format!("goes to `{}`{why}; a {} may not enter it", step.room_id, role.id));
            }
        }
    }
}

/// What people use is there, affords it, and can be stood before.
pub fn stations(c: &Context, out: &mut Findings) {
    let clear = c.clear(PERSON_RADIUS_M);
    for station in &c.world.scenario.stations {
        out.look();
        let mut objects = c.objects_in(&station.room_id);
        let object = objects.find(|o| o.placement.placement_id == station.placement_id);
        let Some(object) = object else {
            let message = format!("`{}` does not stand in `{}`", station.placement_id, station.room_id);
            out.add(&station.station_id, message);
            continue;
        };
        let wanted = station.act.affordance();
        let affords = |a: &str| object.kind.is_some_and(|k| k.affordances.iter().any(|known| known == a));
        if let Some(wanted) = wanted.filter(|a| !affords(a)) {
            out.add(&station.station_id, format!("nobody can {wanted} `{}`", station.placement_id));
        }
        if !c.is_clear(&clear, point(&station.before)) {
            out.add(&station.station_id, "nobody can stand before it");
        }
        if let Some(at) = station.queue.iter().find(|p| !c.is_clear(&clear, **p)) {
            out.add(&station.station_id, format!("nobody can wait at {:.2} {:.2}", at.x, at.y));
        }
    }
    let used: BTreeMap<&str, &str> =
        c.world.scenario.stations.iter().map(|s| (s.station_id.as_str(), s.room_id.as_str())).collect();
    for (name, _, steps) in all(c) {
        for step in &steps {
            let elsewhere =
                step.station.as_ref().and_then(|s| used.get(s.as_str())).is_some_and(|r| *r != step.room_id);
            if elsewhere {
                out.add(&name, format!("uses what is not in `{}`", step.room_id));
            } else if !c.is_clear(&clear, point(&step.pose)) {
                out.add(&name, format!("cannot stand where it goes to in `{}`", step.room_id));
            }
        }
    }
}

/// People walk as fast as people do, in groups as large as groups are.
pub fn pace(c: &Context, out: &mut Findings) {
    let [low, high] = WALKING_SPEEDS_M_S;
    let scenario = &c.world.scenario;
    let agents = scenario.agents.iter().map(|a| (&a.agent_id, a.speed_m_s));
    for (name, speed) in agents.chain(scenario.flows.iter().map(|f| (&f.flow_id, f.speed_m_s))) {
        out.look();
        if !(low..=high).contains(&speed) {
            let message = format!("walks at {speed} m/s, people do at {low} to {high} m/s");
            out.add_figure(name, message, speed, if speed < low { low } else { high }, "m/s");
        }
    }
    for flow in scenario.flows.iter().filter(|f| f.group[1] > GROUP_SIZES[1]) {
        let (most, found) = (f64::from(GROUP_SIZES[1]), f64::from(flow.group[1]));
        out.add_figure(
            &flow.flow_id,
            format!("has groups of {found} people, of {most} at most are seen"),
            found,
            most,
            "",
        );
    }
}

/// What robots are to do is at points that they get to, and done with one charge of the battery.
pub fn jobs(c: &Context, out: &mut Findings) {
    let scenario = &c.world.scenario;
    let place = |id: &str| scenario.pois.iter().find(|p| p.poi_id == id).map(|p| point(&p.pose));
    for robot in &scenario.robots {
        out.look();
        let charge = robot_kind::charge_s(&robot.robot.kind);
        for job in &robot.jobs {
            let needed = job.least_seconds(place);
            if needed > charge {
                let minutes = |s: f64| (s / 60.0).ceil();
                let message = format!("takes {} minutes, a charge lasts {}", minutes(needed), minutes(charge));
                out.add(format!("{}|{}", robot.robot_id, job.job_id), message);
            }
            let ends = job.from.iter().chain(&job.to);
            for end in ends.filter(|id| !robot.goals.contains(id) && robot.dock.as_ref() != Some(id)) {
                out.add(format!("{}|{}", robot.robot_id, job.job_id), format!("`{end}` is none of its goals"));
            }
            let clear = c.clear(robot.robot.radius_m);
            if let Some(p) = job.path.iter().find(|p| !c.is_clear(&clear, **p)) {
                let message = format!("does not fit at {:.2} {:.2} of its way", p.x, p.y);
                out.add(format!("{}|{}", robot.robot_id, job.job_id), message);
            }
        }
    }
}
