//! The robots of a brief: kind, number, body, where they go and where they stay out.

use d3dgen_model::brief::{Brief, Fact, RobotsAsk};
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::robot_kind;
use d3dgen_model::scene_graph::{Note, Robot};

use super::wishes::Facts;
use super::{Notes, Request, Wishes};
use crate::machines::{robot_rules, robots};
use crate::wished::wishes::CHARGING;

/// Id of the way into the building, where robots fetch and bring things.
const ENTRANCE: &str = "entrance";
/// Kind that stands for those that are not planned.
const SERVICE: &str = "service";

fn asks(brief: &Brief) -> impl Iterator<Item = &RobotsAsk> {
    brief.asks.iter().filter_map(|a| if let Fact::Robots(robots) = &a.fact { Some(robots) } else { None })
}

/// Returns the robots, those of the request's flags where the brief names none.
pub(super) fn robots(brief: &Brief, request: &Request, wishes: &Wishes, notes: &mut Notes) -> Vec<Robot> {
    let charging = wishes.wishes.iter().any(|w| w.room_type == CHARGING);
    let flagged = request.robot_radius_m.is_some() || request.robot != RobotBody::default();
    let asked: Vec<RobotsAsk> = asks(brief).cloned().collect();
    let any = RobotsAsk { kind: SERVICE.into(), ..RobotsAsk::default() };
    let all = if asked.is_empty() && flagged { vec![any] } else { asked };
    all.iter().filter_map(|asked| robot(asked, request, charging, notes)).collect()
}

fn robot(asked: &RobotsAsk, request: &Request, charging: bool, notes: &mut Notes) -> Option<Robot> {
    let known = robot_kind::typical(&asked.kind);
    if known.is_none() {
        let message = format!("`{}` is no kind of robot that is planned; service robots stand for it", asked.kind);
        notes.assumptions.push(Note::new("robot_kind", message));
    }
    let kind = if known.is_some() { asked.kind.as_str() } else { SERVICE };
    let typical = known.or_else(|| robot_kind::typical(SERVICE))?;
    let told = RobotBody {
        width_m: asked.width_m,
        length_m: asked.length_m.or(asked.width_m),
        height_m: asked.height_m,
        ..RobotBody::default()
    };
    let body = if request.robot == RobotBody::default() { told } else { request.robot };
    Some(Robot {
        kind: kind.to_owned(),
        count: asked.count.n.max(1),
        radius_m: request.robot_radius_m.or(body.radius_m()).unwrap_or(typical.radius_m),
        height_m: body.height_m.unwrap_or(typical.height_m),
        charging,
        body: (body != RobotBody::default()).then_some(body),
        stops: Vec::new(),
        room_types: Vec::new(),
        misfit: false,
    })
}

/// Returns where each robot of a brief goes: to the rooms that its tasks name, or that have the objects which they name.
pub(super) fn errands(brief: &Brief, facts: &Facts) -> Vec<robots::Errand> {
    asks(brief).map(|asked| errand(asked, facts)).collect()
}

fn errand(asked: &RobotsAsk, facts: &Facts) -> robots::Errand {
    let mut out = robots::Errand::default();
    for place in asked.tasks.iter().flat_map(|t| t.from.iter().chain(&t.to)) {
        if place.id.as_deref() == Some(ENTRANCE) {
            out.entrance = true;
        }
        for id in facts.rooms_at(place) {
            if !out.room_types.contains(&id) {
                out.room_types.push(id);
            }
        }
    }
    // what brings things to one place takes them where its kind does
    let places = out.room_types.len() + usize::from(out.entrance);
    if robot_kind::brings(&asked.kind) && places < 2 { robots::Errand::default() } else { out }
}

/// Returns for each robot where the brief sends its kind; robots that it says nothing of go where they went.
pub(super) fn restored(
    robots: &[Robot],
    errands: &[robots::Errand],
    brief: &Brief,
    facts: &Facts,
) -> Vec<robots::Errand> {
    let told: Vec<(&RobotsAsk, robots::Errand)> = asks(brief).map(|a| (a, errand(a, facts))).collect();
    let of = |(i, robot): (usize, &Robot)| {
        let own = errands.get(i).filter(|e| **e != robots::Errand::default()).cloned();
        let one = robots.len() == 1 && told.len() == 1;
        let found = || told.iter().find(|(a, _)| one || a.kind == robot.kind).map(|(_, e)| e.clone());
        own.or_else(found).unwrap_or_default()
    };
    robots.iter().enumerate().map(of).collect()
}

/// Returns the rooms that robots stay out of.
pub(super) fn keep_out(brief: &Brief, facts: &Facts) -> Vec<robot_rules::Rule> {
    asks(brief).flat_map(|a| &a.keep_out).map(|s| robot_rules::Rule::keep_out_of(facts.type_of(s))).collect()
}
