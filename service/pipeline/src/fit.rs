//! Robots that are to fit: a world in which they do, or a refusal that names the largest robot that does.

use d3dgen_model::passage::RobotWay;
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::scene_graph::{Note, Robot, SceneGraph};
use d3dgen_model::stage::Error;

use crate::generate::Generated;

/// Radius of a robot that every building has room for, m.
const SMALL_M: f64 = 0.2;
/// How closely the largest radius that fits is sought, m.
const STEP_M: f64 = 0.05;

/// Returns the graph of the same building made without the robots whose bodies are known, which then drive only where they
/// can; `None` where there are none, or the building is to be made for them.
pub(crate) fn without_robots(graph: &SceneGraph) -> Option<SceneGraph> {
    let is_own = |r: &&Robot| !r.misfit && r.body.is_some_and(|b| !b.fit);
    let widest = graph.robots.iter().filter(is_own).map(|r| r.radius_m).fold(0.0, f64::max);
    let mut out = graph.clone();
    out.robots.iter_mut().for_each(|r| r.misfit |= is_own(&&*r));
    let message = format!(
        "these rooms are too small for a robot that needs {:.2} m; they are made as without it, and the report says where it \
         fits (--fit-robot makes them for it)",
        2.0 * widest
    );
    out.conflicts.push(Note { code: "robot_does_not_fit".into(), message });
    (widest > 0.0).then_some(out)
}

/// Returns the world when the robots that are to fit do; else refuses, with the least change that would help.
///
/// # Errors
/// `Refused` when a smaller robot would fit; what came of the request itself when none would; `Cancelled`.
pub(crate) fn or_refused(
    made: Result<Generated, Error>,
    graph: &SceneGraph,
    make: &mut dyn FnMut(&SceneGraph) -> Result<Generated, Error>,
) -> Result<Generated, Error> {
    let reason = match &made {
        Ok(found) if fits(found) => return made,
        // no smaller circle would help
        Ok(found) if too_high(found).is_some() => {
            let message = too_high(found).unwrap_or_default();
            return Err(Error::Refused { stage: "floorplan", message });
        }
        Ok(found) => unfit(found),
        Err(Error::Infeasible { message, .. }) => message.clone(),
        Err(_) => return made,
    };
    let circle = |r: &Robot| r.body.and_then(|b| b.circle_m()).map_or(r.radius_m, |c| c.max(r.radius_m));
    let largest = graph.robots.iter().filter(|r| r.is_fitted()).map(circle).fold(0.0, f64::max);
    let with = |radius: f64| {
        let mut smaller = graph.clone();
        for robot in smaller.robots.iter_mut().filter(|r| r.is_fitted()) {
            robot.radius_m = circle(robot).min(radius);
            // as wide as it is long
            robot.body = robot.body.map(|b| RobotBody { width_m: None, length_m: None, ..b });
        }
        smaller
    };
    let mut works = |radius: f64| match make(&with(radius)) {
        Ok(found) => Ok(fits(&found)),
        Err(Error::Cancelled) => Err(Error::Cancelled),
        Err(_) => Ok(false),
    };
    // in steps, so that the figure is a round one
    let (mut low, mut high) = ((SMALL_M / STEP_M).round() as u32, (largest / STEP_M - 1e-6).ceil() as u32);
    if high <= low || !works(f64::from(low) * STEP_M)? {
        return made;
    }
    while high - low > 1 {
        let middle = (low + high) / 2;
        if works(f64::from(middle) * STEP_M)? { low = middle } else { high = middle }
    }
    let most = f64::from(low) * STEP_M;
    let side = most * std::f64::consts::SQRT_2;
    Err(Error::Refused {
        stage: "floorplan",
        message: format!(
            "a robot that turns within {:.2} m does not fit these rooms: {reason}; one that turns within {:.2} m does \
             (--robot-turning-radius {most:.2}, or a body of {side:.2} m by {side:.2} m)",
            2.0 * largest,
            2.0 * most
        ),
    })
}

/// Returns true for a world that can be written and that its robots fit into.
pub(crate) fn fits(found: &Generated) -> bool {
    found.report.is_writable() && found.report.robot_fit.iter().all(|f| f.fits)
}

/// Returns what to say of a robot that is higher than a door on its way.
fn too_high(found: &Generated) -> Option<String> {
    found.report.robot_fit.iter().find_map(|fit| {
        let low = |w: &&RobotWay| w.clear_height_m.is_some();
        let way = fit.rooms.iter().chain(&fit.points).filter(low).find(|w| !w.reachable)?;
        let (height, door) = (way.clear_height_m?, &way.narrowest);
        Some(format!(
            "a robot {:.2} m high does not fit through {door}, which is {height:.2} m high, on the way to {}; one up to \
             {height:.2} m high does (--robot-height {height})",
            fit.height_m, way.to
        ))
    })
}

/// Returns what keeps a robot from fitting.
fn unfit(found: &Generated) -> String {
    let violation = found.report.rules.iter().flat_map(|r| &r.violations).find(|v| !v.given);
    let missed = || {
        let mut ways = found.report.robot_fit.iter().flat_map(|f| f.points.iter().chain(&f.rooms));
        ways.find(|w| !w.reachable)
            .map(|w| format!("{} is reached through {:.2} m at {}", w.to, w.clear_width_m, w.narrowest))
    };
    match violation {
        Some(v) => format!("{}: {}", v.subject, v.message),
        None => missed().unwrap_or_else(|| "it does not reach every room".into()),
    }
}
