//! Robots: how many of which kind, where they rest, what their rounds and jobs are, and where they never go.

use std::collections::BTreeSet;

use d3dgen_model::brief::{Ask, AskedTask, RobotsAsk, Subject};
use d3dgen_model::report::Fate;
use d3dgen_model::scenario::{RobotJob, RobotTask};
use d3dgen_model::scene_graph::{GraphRoom, Robot};

use super::{Asked, Finding, MEASURE_MISS, names_of};

/// Kind of a robot of which nothing is said but that it is one: any does.
const ANY_KIND: &str = "service";
/// Verbs of tasks that are no work: a robot does them where its dock is, or where it starts.
const RESTS: [&str; 3] = ["wait", "charge", "park"];

impl<'a> Asked<'a> {
    pub(super) fn robots(&self, ask: &Ask, asked: &RobotsAsk) -> Finding {
        let robots = &self.world.scene_graph.robots;
        let own = robots.iter().any(|r| r.kind == asked.kind);
        let any = asked.kind.is_empty() || asked.kind == ANY_KIND && !own;
        let is_meant = |r: &Robot| any || r.kind == asked.kind;
        let of_kind: Vec<&Robot> = robots.iter().filter(|r| is_meant(r)).collect();
        let count = of_kind.iter().map(|r| r.count).sum();
        let mut out = Finding::number(asked.count, count, || format!("{} asked for, {count} there", asked.count));
        if of_kind.is_empty() && !robots.is_empty() {
            let kinds: Vec<&str> = robots.iter().map(|r| r.kind.as_str()).collect();
            out = Finding::of(Fate::Substituted, format!("the robots are for {}", kinds.join(", ")));
        }
        if let Some(width) = asked.width_m
            && let Some(robot) = of_kind.first()
        {
            out = out.and(Finding::measure(width, robot.width_m(), MEASURE_MISS, ("m", "its width is")));
        }
        if let Some(misfit) = of_kind.iter().find(|r| r.misfit) {
            out = out.and(Finding::of(Fate::Substituted, format!("the {} robot does not fit everywhere", misfit.kind)));
        }
        let tasks: Vec<&RobotTask> = self.world.scenario.robots.iter().filter(|t| is_meant(&t.robot)).collect();
        for task in &asked.tasks {
            out = out.and(if RESTS.contains(&task.verb.as_str()) {
                self.rests(task, &tasks)
            } else {
                self.task(ask, task, &tasks)
            });
        }
        out.and(self.strays(ask, asked, &tasks)).and(self.kept_out(asked))
    }

    /// Returns the rooms of a place that a task names: the rooms of that name, else those with such things.
    fn rooms_of_place(&self, subject: &Subject) -> Vec<&'a GraphRoom> {
        let rooms = self.all_meant(subject);
        if !rooms.is_empty() {
            return rooms;
        }
        let things = self.objects_called(subject);
        self.world.scene_graph.rooms.iter().filter(|r| things.iter().any(|p| p.room_id == r.id)).collect()
    }

    /// Returns the room of a point of the scenario.
    fn room_of(&self, poi_id: &str) -> Option<&'a str> {
        self.world.scenario.pois.iter().find(|p| p.poi_id == poi_id).map(|p| p.room_id.as_str())
    }

    /// Returns the jobs that a fact asks for, of all robots; where none says which fact it answers, all of them.
    fn jobs_of(&self, ask: &Ask, tasks: &[&'a RobotTask]) -> Vec<&'a RobotJob> {
        let all: Vec<&RobotJob> = tasks.iter().flat_map(|t| &t.jobs).collect();
        let own: Vec<&RobotJob> = all.iter().copied().filter(|j| j.ask_id.as_ref() == Some(&ask.id)).collect();
        if own.is_empty() { all } else { own }
    }

    /// Returns whether a robot rests in the room that was said.
    fn rests(&self, asked: &AskedTask, tasks: &[&RobotTask]) -> Finding {
        let wanted: Vec<&GraphRoom> = asked.to.iter().flat_map(|s| self.rooms_of_place(s)).collect();
        let place = |t: &&RobotTask| t.dock.as_deref().and_then(|dock| self.room_of(dock));
        let at: Vec<&str> = tasks.iter().filter_map(place).collect();
        let holds = asked.to.is_empty() || at.iter().any(|id| wanted.iter().any(|r| r.id == *id));
        let named = asked.to.iter().map(|s| s.name.as_str()).collect::<Vec<_>>().join(", ");
        let reason = || match at.first() {
            Some(id) => format!("its dock is in {}, not in `{named}`", self.name_of(id)),
            None => format!("it has no dock in `{named}`"),
        };
        Finding::when(holds, Vec::new(), reason).or_near()
    }

    /// Returns whether robots go where a task has them go: to all rooms of each place, from the one that it names.
    fn task(&self, ask: &Ask, asked: &AskedTask, tasks: &[&'a RobotTask]) -> Finding {
        let jobs = self.jobs_of(ask, tasks);
        let goals = tasks.iter().flat_map(|t| &t.goals).filter_map(|id| self.room_of(id));
        let visited: BTreeSet<&str> = goals
            .chain(jobs.iter().flat_map(|j| j.from.iter().chain(&j.to)).filter_map(|id| self.room_of(id)))
            .collect();
        let mut lacking: Vec<String> = Vec::new();
        for place in asked.to.iter().chain(&asked.from) {
            let rooms = self.rooms_of_place(place);
            let missed: Vec<&GraphRoom> = rooms.iter().filter(|r| !visited.contains(r.id.as_str())).copied().collect();
            // who is sent to a kind of thing goes to one of the rooms that have it
            let things = self.all_meant(place).is_empty();
            if rooms.is_empty() || things && missed.len() == rooms.len() {
                lacking.push(format!("`{}`", place.name));
            } else if !things && !missed.is_empty() {
                lacking.push(names_of(&missed));
            }
        }
        let goes = Finding::when(lacking.is_empty(), Vec::new(), || format!("no robot goes to {}", lacking.join(", ")));
        goes.and(self.begins(asked, &jobs))
    }

    /// Returns whether what is carried is fetched where the task says.
    fn begins(&self, asked: &AskedTask, jobs: &[&RobotJob]) -> Finding {
        let Some(from) = &asked.from else { return Finding::honored(Vec::new()) };
        let rooms = self.rooms_of_place(from);
        let begins = |j: &&&RobotJob| {
            let room = j.from.as_deref().and_then(|id| self.room_of(id));
            room.is_some_and(|id| rooms.iter().any(|r| r.id == id))
        };
        let other = jobs.iter().filter_map(|j| j.from.as_deref()).find_map(|id| self.room_of(id));
        let reason = || match other {
            Some(id) => format!("its task begins in {}, not in `{}`", self.name_of(id), from.name),
            None => format!("its task does not begin in `{}`", from.name),
        };
        Finding::when(jobs.iter().any(|j| begins(&j)), Vec::new(), reason).or_near()
    }

    /// Returns whether the jobs that a fact asks for keep to the places that its tasks name, where each of them names one.
    fn strays(&self, ask: &Ask, asked: &RobotsAsk, tasks: &[&'a RobotTask]) -> Finding {
        let work = || asked.tasks.iter().filter(|t| !RESTS.contains(&t.verb.as_str()));
        if work().next().is_none() || work().any(|t| t.to.is_empty()) {
            return Finding::honored(Vec::new());
        }
        let named: Vec<&GraphRoom> =
            work().flat_map(|t| t.to.iter().chain(&t.from)).flat_map(|s| self.rooms_of_place(s)).collect();
        let jobs = self.jobs_of(ask, tasks);
        let goals = jobs.iter().flat_map(|j| &j.to).filter_map(|id| self.room_of(id));
        let others: BTreeSet<&str> = goals.filter(|id| !named.iter().any(|r| r.id == *id)).collect();
        let others: Vec<&GraphRoom> = others.iter().filter_map(|id| self.world.scene_graph.room(id)).collect();
        Finding::when(others.is_empty(), Vec::new(), || format!("it works in {}", names_of(&others))).or_near()
    }

    /// Returns whether robots stay out of the rooms that they are to stay out of: no rule lets them in, and no round leads through.
    fn kept_out(&self, asked: &RobotsAsk) -> Finding {
        let rooms: Vec<&GraphRoom> = asked.keep_out.iter().flat_map(|s| self.rooms_of_place(s)).collect();
        let entered: Vec<&GraphRoom> = rooms.into_iter().filter(|r| self.may_be_entered(r)).collect();
        Finding::when(entered.is_empty(), Vec::new(), || format!("robots may enter {}", names_of(&entered)))
    }

    fn may_be_entered(&self, room: &GraphRoom) -> bool {
        let Some(plan) = self.world.floorplan.room(&room.id) else { return true };
        let through = |t: &RobotTask| {
            let stops = t.goals.iter().any(|id| self.room_of(id) == Some(room.id.as_str()));
            let corners = || t.routes.iter().flat_map(|r| &r.path).chain(t.jobs.iter().flat_map(|j| &j.path));
            stops || t.level == room.level && corners().any(|p| plan.net_polygon.contains(*p))
        };
        !self.world.scene_graph.keeps_robots_out(&room.id) || self.world.scenario.robots.iter().any(through)
    }
}
