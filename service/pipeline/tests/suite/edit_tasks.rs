//! Robots' jobs and people's steps under edits: what a person sets is what they do, routes follow, later edits leave it.

use std::sync::atomic::AtomicBool;

use d3dgen_model::document::Document;
use d3dgen_model::edits::{Edit, StepKept};
use d3dgen_model::scenario::{Agent, RobotTask};
use d3dgen_model::world::World;
use d3dgen_pipeline::edit::{self, Edited};
use d3dgen_pipeline::generate::{Settings, generate_world};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::{Error, Stop};
use d3dgen_plugins::Registry;

const WARD: &str = "hospital ward with 8 rooms in Germany, for a delivery robot";
const STOREYS: &str = "three floor office building for a delivery robot";

fn world(registry: &Registry, prompt: &str) -> World {
    let request = Request { prompt: prompt.into(), seed: 1, ..Request::default() };
    let settings = Settings::default();
    generate_world(&request, registry, &settings, &mut |_| {}, &AtomicBool::new(false)).expect(prompt).world
}

fn edited(registry: &Registry, world: &World, edits: &[Edit]) -> Result<Edited, Error> {
    let plugin = registry.get(&world.scene_graph.domain).expect("its domain is built in");
    let edited = edit::apply(world, edits, plugin, Stop::never())?;
    assert!(edited.report.sound, "{edits:?}");
    assert_eq!(edited.world.check(), []);
    Ok(edited)
}

fn job_change(robot: &RobotTask, to: &[String], load_kg: Option<f64>) -> Edit {
    let job_id = robot.jobs[0].job_id.clone();
    Edit::ChangeJob { robot_id: robot.robot_id.clone(), job_id, from: None, to: to.to_vec(), load_kg, seconds: None }
}

fn person(world: &World) -> &Agent {
    world.scenario.agents.iter().find(|a| a.steps.len() > 2).expect("somebody who walks")
}

#[test]
fn a_robot_goes_where_a_person_says_and_still_does_after_other_edits() {
    let registry = Registry::builtin();
    for prompt in [WARD, STOREYS] {
        let before = world(&registry, prompt);
        let robot = &before.scenario.robots[0];
        let mut to = robot.jobs[0].to.clone();
        to.reverse();
        to.pop();
        let made = edited(&registry, &before, &[job_change(robot, &to, Some(4.5))]).expect(prompt);
        assert_eq!(made.changed_room_ids, [] as [String; 0], "{prompt}: no room has changed");
        let task = &made.world.scenario.robots[0];
        assert_eq!((&task.jobs[0].to, task.jobs[0].load_kg, task.locked), (&to, 4.5, true), "{prompt}");
        // its round leads to what it is to do, in that turn
        let goals: Vec<&String> = task.jobs.iter().flat_map(|j| j.from.iter().chain(&j.to)).collect();
        assert!(task.goals.iter().all(|g| goals.contains(&g)), "{prompt}: {:?}", task.goals);
        let routed: Vec<&String> = task.routes.iter().map(|r| &r.to).filter(|id| task.goals.contains(id)).collect();
        let in_turn: Vec<&String> = task.goals.iter().filter(|g| routed.contains(g)).collect();
        assert_eq!(routed, in_turn, "{prompt}");
        assert!(!routed.is_empty(), "{prompt}");
        // nobody else does anything else
        assert_eq!(made.world.scenario.agents, before.scenario.agents, "{prompt}");

        let thing = made.world.placements.placements.iter().find(|p| p.object == "waste_bin").expect("a bin");
        let remove = Edit::RemoveObject { placement_id: thing.placement_id.clone() };
        let Ok(later) = edited(&registry, &made.world, &[remove]) else { continue };
        assert_eq!(later.world.scenario.robots[0].jobs[0].to, to, "{prompt}: kept");
        let free = Edit::Lock { ids: vec![task.robot_id.clone()], locked: false, contents: false };
        let usual = edited(&registry, &later.world, &[free]).expect(prompt);
        assert_eq!(usual.world.scenario.robots[0].jobs[0].to, robot.jobs[0].to, "{prompt}: as usual again");
        assert!(!usual.world.scenario.robots[0].locked);
    }
}

#[test]
fn a_person_does_the_steps_that_stay_in_their_new_turn() {
    let registry = Registry::builtin();
    let before = world(&registry, WARD);
    let agent = person(&before);
    let count = u32::try_from(agent.steps.len()).expect("few");
    let kept = |number: u32, seconds: Option<f64>| StepKept { number, seconds };
    let steps: Vec<StepKept> = (2..=count).rev().map(|n| kept(n, (n == 2).then_some(7.0))).collect();
    let change = Edit::ChangeSteps { agent_id: agent.agent_id.clone(), steps };
    let made = edited(&registry, &before, &[change]).expect("a turn");
    let after = made.world.scenario.agents.iter().find(|a| a.agent_id == agent.agent_id).expect("still there");
    assert!(after.locked);
    let rooms = |steps: &[d3dgen_model::scenario::Step]| steps.iter().map(|s| s.room_id.clone()).collect::<Vec<_>>();
    let mut expected = rooms(&agent.steps[1..]);
    expected.reverse();
    assert_eq!(rooms(&after.steps), expected);
    assert_eq!(after.steps.last().map(|s| s.seconds), Some(7.0));
    assert_eq!(made.world.floorplan, before.floorplan);
    assert_eq!(made.world.placements, before.placements);
}

#[test]
fn what_is_not_there_or_breaks_a_rule_is_refused() {
    let registry = Registry::builtin();
    let before = world(&registry, WARD);
    let robot = &before.scenario.robots[0];
    let refused = |edit: Edit| edited(&registry, &before, &[edit]).expect_err("refused").to_string();
    assert!(refused(job_change(robot, &["nowhere".into()], None)).contains("no point `nowhere`"));
    assert!(refused(job_change(robot, &robot.jobs[0].to, None)).contains("as it is asked to be"));
    let unknown = RobotTask { robot_id: "robot_9".into(), ..robot.clone() };
    assert!(refused(job_change(&unknown, &[], Some(1.0))).contains("no robot `robot_9`; it has delivery_robot_1"));
    let agent = person(&before);
    let steps = |numbers: &[u32]| Edit::ChangeSteps {
        agent_id: agent.agent_id.clone(),
        steps: numbers.iter().map(|&number| StepKept { number, seconds: None }).collect(),
    };
    assert!(refused(steps(&[0])).contains("no step 0"));
    assert!(refused(steps(&[1, 1])).contains("named twice"));
    assert!(refused(steps(&[])).contains("nothing to do"));
    // work for many hours is not done with one charge
    let job_id = robot.jobs[0].job_id.clone();
    let robot_id = robot.robot_id.clone();
    let days = Edit::ChangeJob { robot_id, job_id, from: None, to: Vec::new(), load_kg: None, seconds: Some(80_000.0) };
    let error = edited(&registry, &before, &[days]).expect_err("too long");
    assert!(matches!(&error, Error::Breaks { rule, .. } if rule == "robot_job"), "{error}");
}
