//! What people and robots of the scenario do, for those who run it: HuNavSim's agents, nav2's waypoints, Open-RMF's tasks, and
//! the scenario itself as JSON.
//!
//! HuNavSim and nav2 know one floor: what lies on another storey has its number behind the name of its file.

use std::f64::consts::TAU;

use d3dgen_model::document::Document;
use d3dgen_model::geometry::{Pose, to_mm};
use d3dgen_model::scenario::{Act, Agent, RobotJob, RobotJobKind, RobotTask, Scenario};
use serde_json::{Map, Value, json};

use super::Exporter;
use crate::error::Error;
use crate::file::File;
use crate::subject::Subject;
use crate::yaml;

/// HuNavSim's `REGULAR` behavior, the radius that its social forces are tuned for, m, and the height of its models' middle, m.
const REGULAR: u32 = 1;
const HUNAV_RADIUS_M: f64 = 0.4;
const HUNAV_Z_M: f64 = 1.25;
/// How near a goal counts as reached, m.
const GOAL_M: f64 = 0.3;

/// Writes the tasks.
pub struct Tasks;

impl Exporter for Tasks {
    fn name(&self) -> &'static str {
        "tasks"
    }

    fn about(&self) -> &'static str {
        "what people and robots do: HuNavSim agents.yaml, nav2 waypoints, Open-RMF dispatch requests, the scenario as JSON"
    }

    fn roots(&self) -> &'static [&'static str] {
        &["tasks"]
    }

    fn export(&self, subject: &Subject<'_>) -> Result<Vec<File>, Error> {
        let world = subject.world;
        let mut files = vec![File::new("tasks/scenario.json", world.scenario.to_json())];
        for (level, storey) in world.storeys() {
            let tag = if level == 0 { String::new() } else { format!("_level_{level}") };
            let agents = hunav(&storey.scenario, &world.name);
            files.push(File::new(format!("tasks/hunav_agents{tag}.yaml"), yaml::to_string(&agents)));
            for robot in &storey.scenario.robots {
                let document = yaml::to_string(&waypoints(robot, &storey.scenario));
                files.push(File::new(format!("tasks/nav2_waypoints_{}.yaml", robot.robot_id), document));
            }
        }
        for robot in &world.scenario.robots {
            let requests: Vec<Value> = robot.jobs.iter().flat_map(requests).collect();
            let text = format!("{:#}\n", Value::Array(requests));
            files.push(File::new(format!("tasks/rmf_dispatch_{}.json", robot.robot_id), text));
        }
        files.sort_by(|a, b| a.path.cmp(&b.path));
        files.dedup_by(|a, b| a.path == b.path);
        Ok(files)
    }
}

/// Returns the agents of a storey who walk, as HuNavSim's loader reads them.
fn hunav(scenario: &Scenario, map: &str) -> Value {
    let walks = |a: &&Agent| a.steps.iter().any(|s| s.act != Act::Lie) && !a.steps.is_empty();
    let agents: Vec<&Agent> = scenario.agents.iter().filter(walks).collect();
    let mut parameters = Map::new();
    parameters.insert("map".into(), json!(map));
    parameters.insert("publish_people".into(), json!(true));
    let name = |k: usize| format!("agent{}", k + 1);
    parameters.insert("agents".into(), (0..agents.len()).map(name).collect());
    for (k, agent) in agents.iter().enumerate() {
        parameters.insert(name(k), hunav_agent(agent, k + 1));
    }
    json!({"hunav_loader": {"ros__parameters": parameters}})
}

fn hunav_agent(agent: &Agent, id: usize) -> Value {
    let mut out = Map::new();
    let start = &agent.start;
    let fixed = json!({
        "id": id, "skin": id % 5, "behavior": REGULAR, "group_id": -1, "max_vel": agent.speed_m_s, "radius": HUNAV_RADIUS_M,
        "init_pose": {"x": start.x, "y": start.y, "z": HUNAV_Z_M, "h": heading(start)},
        "goal_radius": GOAL_M, "cyclic_goals": !agent.leaves,
    });
    out.extend(fixed.as_object().cloned().unwrap_or_default());
    out.insert("goals".into(), (0..agent.steps.len()).map(|k| format!("g{k}")).collect());
    for (k, step) in agent.steps.iter().enumerate() {
        out.insert(format!("g{k}"), json!({"x": step.pose.x, "y": step.pose.y, "h": heading(&step.pose)}));
    }
    Value::Object(out)
}

fn heading(pose: &Pose) -> f64 {
    (pose.yaw_rad.rem_euclid(TAU) * 1e4).round() / 1e4
}

/// Returns the points of a robot's jobs in turn, as nav2's panel in RViz saves and loads them.
fn waypoints(robot: &RobotTask, scenario: &Scenario) -> Value {
    let poses = robot.jobs.iter().flat_map(|job| job.from.iter().chain(&job.to));
    let poses = poses.chain(&robot.dock).filter_map(|id| scenario.pois.iter().find(|p| &p.poi_id == id));
    let waypoint = |(k, pose): (usize, &Pose)| {
        let (sin, cos) = (pose.yaw_rad / 2.0).sin_cos();
        let round = |v: f64| (v * 1e6).round() / 1e6;
        let value =
            json!({"pose": [to_mm(pose.x), to_mm(pose.y), 0.0], "orientation": [round(cos), 0.0, 0.0, round(sin)]});
        (format!("waypoint{k}"), value)
    };
    let all: Map<String, Value> = poses.map(|p| &p.pose).enumerate().map(waypoint).collect();
    json!({"waypoints": all})
}

/// Returns a job as Open-RMF's task API takes it: deliveries from one place to each other one, all else as a patrol.
fn requests(job: &RobotJob) -> Vec<Value> {
    let request = |category: &str, description: Value| {
        json!({"type": "dispatch_task_request", "request": {
            "unix_millis_earliest_start_time": 0, "category": category, "description": description,
        }})
    };
    let sku = if job.what.is_empty() { "goods" } else { &job.what };
    match (&job.from, job.kind) {
        (Some(from), RobotJobKind::Deliver) => {
            let stop =
                |place: &String| json!({"place": place, "handler": place, "payload": [{"sku": sku, "quantity": 1}]});
            job.to.iter().map(|to| request("delivery", json!({"pickup": stop(from), "dropoff": stop(to)}))).collect()
        }
        _ if job.to.is_empty() => Vec::new(),
        _ => vec![request("patrol", json!({"places": job.to, "rounds": 1}))],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::NothingKept;
    use crate::sample;

    #[test]
    fn agents_have_the_keys_that_the_loader_reads() {
        let world = sample::world();
        let agents = hunav(&world.scenario, "sample");
        let first = &agents["hunav_loader"]["ros__parameters"]["agent1"];
        let keys: Vec<&String> = first.as_object().expect("it is a map").keys().collect();
        let known = [
            "id",
            "skin",
            "behavior",
            "group_id",
            "max_vel",
            "radius",
            "init_pose",
            "goal_radius",
            "cyclic_goals",
            "goals",
            "g0",
        ];
        assert_eq!(keys, known);
        assert_eq!(first["g0"]["x"], 8.2);
    }

    #[test]
    fn deliveries_name_both_places_and_rounds_are_patrols() {
        let job = |kind, from: Option<&str>| RobotJob {
            job_id: "job_1".into(),
            kind,
            what: "linen".into(),
            load_kg: 5.0,
            from: from.map(str::to_owned),
            to: vec!["a".into(), "b".into()],
            path: Vec::new(),
            seconds: 10.0,
            ask_id: None,
        };
        let deliveries = requests(&job(RobotJobKind::Deliver, Some("store")));
        assert_eq!(deliveries.len(), 2);
        assert_eq!(deliveries[1]["request"]["description"]["dropoff"]["place"], "b");
        assert_eq!(deliveries[0]["request"]["description"]["pickup"]["payload"][0]["sku"], "linen");
        let rounds = requests(&job(RobotJobKind::Inspect, None));
        assert_eq!(rounds[0]["request"]["category"], "patrol");
        assert_eq!(rounds[0]["request"]["description"]["places"], json!(["a", "b"]));
    }

    #[test]
    fn one_file_a_robot() {
        let files =
            Tasks.export(&Subject::new(&sample::world(), &sample::domain(), &NothingKept)).expect("it can be written");
        let names: Vec<&str> = files.iter().map(|f| f.path.as_str()).collect();
        let wanted = [
            "tasks/hunav_agents.yaml",
            "tasks/nav2_waypoints_cleaning_robot_1.yaml",
            "tasks/rmf_dispatch_cleaning_robot_1.json",
            "tasks/scenario.json",
        ];
        assert_eq!(names, wanted);
    }
}
