//! Buildings with several storeys: levels, what joins them, and each level as a plan of its own.
//!
//! Every stage works level by level: a storey is a complete document in the building's frame, so what plans, furnishes,
//! checks or exports one floor needs to know nothing of the others.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use crate::document::Problem;
use crate::floorplan::Floorplan;
use crate::geometry::{Point, to_mm};
use crate::placements::Placements;
use crate::scenario::{Scenario, Step};
use crate::scene_graph::SceneGraph;
use crate::world::World;

pub use crate::levels::{Level, LinkKind, VerticalLink};

/// Returns true when rooms lie on different storeys.
fn differ(mut levels: impl Iterator<Item = i32>) -> bool {
    let first = levels.next();
    levels.any(|level| Some(level) != first)
}

impl SceneGraph {
    /// Returns true for a building with rooms on several storeys.
    pub fn has_storeys(&self) -> bool {
        differ(self.rooms.iter().map(|r| r.level))
    }

    /// Returns the numbers of the storeys that have rooms, from the lowest; `[0]` for a building of one storey.
    pub fn level_numbers(&self) -> Vec<i32> {
        self.rooms.iter().map(|r| r.level).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Returns one storey as a graph of its own: its rooms, and what is between them. The links stay whole.
    pub fn storey(&self, level: i32) -> Self {
        let level_of: BTreeMap<&str, i32> = self.rooms.iter().map(|r| (r.id.as_str(), r.level)).collect();
        let here = |id: &String| level_of.get(id.as_str()) == Some(&level);
        Self {
            rooms: self.rooms.iter().filter(|r| r.level == level).cloned().collect(),
            edges: self.edges.iter().filter(|e| here(&e.a) && here(&e.b)).cloned().collect(),
            apart: self.apart.iter().filter(|p| p.iter().all(here)).cloned().collect(),
            robot_rules: self.robot_rules.iter().filter(|r| here(&r.room_id)).cloned().collect(),
            ..self.clone()
        }
    }
}

impl Floorplan {
    /// Returns true for a building with rooms on several storeys.
    pub fn has_storeys(&self) -> bool {
        differ(self.rooms.iter().map(|r| r.level))
    }

    /// Returns the plan of the storey with this number: a building's own where it has no other.
    pub fn storey_at(&self, level: i32) -> Cow<'_, Self> {
        if self.has_storeys() { Cow::Owned(self.storey(level)) } else { Cow::Borrowed(self) }
    }

    /// Returns the numbers of the storeys that have rooms, from the lowest; `[0]` for a building of one storey.
    pub fn level_numbers(&self) -> Vec<i32> {
        self.rooms.iter().map(|r| r.level).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Returns one storey as a plan of its own: its rooms with their walls, doors and windows. The list of levels and
    /// the links stay whole.
    pub fn storey(&self, level: i32) -> Self {
        let ids: BTreeSet<&str> = self.rooms.iter().filter(|r| r.level == level).map(|r| r.room_id.as_str()).collect();
        let here = |room_ids: &[String]| room_ids.iter().any(|r| ids.contains(r.as_str()));
        Self {
            version: self.version,
            seed: self.seed,
            scheme: self.scheme.clone(),
            rooms: self.rooms.iter().filter(|r| r.level == level).cloned().collect(),
            walls: self.walls.iter().filter(|w| here(&w.room_ids)).cloned().collect(),
            doors: self.doors.iter().filter(|d| here(&d.room_ids)).cloned().collect(),
            windows: self.windows.iter().filter(|w| ids.contains(w.room_id.as_str())).cloned().collect(),
            obstacles: self.obstacles.iter().filter(|o| ids.contains(o.room_id.as_str())).cloned().collect(),
            cost: self.cost.clone(),
            conflicts: self.conflicts.clone(),
            levels: self.levels.clone(),
            links: self.links.clone(),
        }
    }

    /// Returns the plan moved by `dx` and `dy`, m.
    pub fn moved(mut self, dx: f64, dy: f64) -> Self {
        let point = |p: &mut Point| *p = Point::new(to_mm(p.x + dx), to_mm(p.y + dy));
        for room in &mut self.rooms {
            room.polygon.0.iter_mut().chain(&mut room.net_polygon.0).for_each(point);
        }
        self.obstacles.iter_mut().flat_map(|o| &mut o.outline.0).for_each(point);
        let lines = self.walls.iter_mut().map(|w| &mut w.line);
        let lines = lines.chain(self.doors.iter_mut().map(|d| &mut d.line));
        for line in lines.chain(self.windows.iter_mut().map(|w| &mut w.line)) {
            point(&mut line.start);
            point(&mut line.end);
        }
        self
    }

    /// Returns the rooms that hang in the air on a storey: stairwells and shafts, whose floor is further down.
    fn shafts(&self, level: i32) -> BTreeSet<String> {
        if level == 0 {
            return BTreeSet::new();
        }
        let ids = self.links.iter().flat_map(|l| &l.room_ids);
        ids.filter(|id| self.room(id).is_some_and(|r| r.level == level)).cloned().collect()
    }

    /// Returns the link that a room belongs to.
    pub fn link_of(&self, room_id: &str) -> Option<&VerticalLink> {
        self.links.iter().find(|l| l.room_ids.iter().any(|r| r == room_id))
    }

    /// Checks that the levels rise, and that walls, doors and links stay on one storey each.
    pub(crate) fn check_levels(&self, problems: &mut Vec<Problem>) {
        for (i, pair) in self.levels.windows(2).enumerate() {
            let rises = pair[1].level > pair[0].level && pair[1].elevation_m > pair[0].elevation_m;
            if !rises {
                let path = format!("/levels/{}/elevation_m", i + 1);
                problems.push(Problem::new(path, "is not above the level before it; levels go from the lowest up"));
            }
        }
        let level_of: BTreeMap<&str, i32> = self.rooms.iter().map(|r| (r.room_id.as_str(), r.level)).collect();
        let known: BTreeSet<i32> = self.levels.iter().map(|l| l.level).collect();
        for (i, room) in self.rooms.iter().enumerate() {
            if !known.contains(&room.level) && (room.level != 0 || !known.is_empty()) {
                problems.push(Problem::new(format!("/rooms/{i}/level"), format!("{} is not in levels", room.level)));
            }
        }
        let lists = [
            ("walls", self.walls.iter().map(|w| &w.room_ids).collect::<Vec<_>>()),
            ("doors", self.doors.iter().map(|d| &d.room_ids).collect()),
        ];
        for (list, all) in lists {
            for (i, room_ids) in all.into_iter().enumerate() {
                let levels: BTreeSet<_> = room_ids.iter().filter_map(|r| level_of.get(r.as_str())).collect();
                if levels.len() > 1 {
                    let path = format!("/{list}/{i}/room_ids");
                    problems.push(Problem::new(path, "names rooms of two storeys; stairs and elevators are links"));
                }
            }
        }
    }
}

impl Placements {
    /// Returns what stands in the rooms of `plan`, the plan of one storey.
    pub fn storey(&self, plan: &Floorplan) -> Self {
        let ids: BTreeSet<&str> = plan.rooms.iter().map(|r| r.room_id.as_str()).collect();
        Self {
            version: self.version,
            seed: self.seed,
            placements: self.placements.iter().filter(|p| ids.contains(p.room_id.as_str())).cloned().collect(),
            unplaced: self.unplaced.iter().filter(|u| ids.contains(u.room_id.as_str())).cloned().collect(),
        }
    }
}

impl Scenario {
    /// Returns what happens on one storey, whose plan is `plan`; robots keep the goals that they have on it.
    pub fn storey(&self, level: i32, plan: &Floorplan) -> Self {
        let ids: BTreeSet<&str> = plan.rooms.iter().map(|r| r.room_id.as_str()).collect();
        let pois: Vec<_> = self.pois.iter().filter(|p| ids.contains(p.room_id.as_str())).cloned().collect();
        let known = |id: &String| pois.iter().any(|p| &p.poi_id == id);
        let mut robots: Vec<_> = self.robots.iter().filter(|r| r.level == level).cloned().collect();
        for robot in &mut robots {
            robot.goals.retain(known);
        }
        let here = |step: &Step| ids.contains(step.room_id.as_str());
        let mut agents: Vec<_> = self.agents.iter().filter(|a| a.level == level).cloned().collect();
        for agent in &mut agents {
            agent.waypoints.retain(|id| ids.contains(id.as_str()));
            agent.steps.retain(here);
        }
        let mut flows: Vec<_> = self.flows.iter().filter(|f| ids.contains(f.room_id.as_str())).cloned().collect();
        flows.iter_mut().flat_map(|f| &mut f.itineraries).for_each(|i| i.steps.retain(here));
        for robot in &mut robots {
            robot.jobs.iter_mut().for_each(|job| job.to.retain(known));
            robot.jobs.retain(|job| job.from.iter().all(known) && !(job.to.is_empty() && job.path.is_empty()));
        }
        Self {
            version: self.version,
            seed: self.seed,
            name: self.name.clone(),
            hour: self.hour.clone(),
            stations: self.stations.iter().filter(|s| ids.contains(s.room_id.as_str())).cloned().collect(),
            conditions: self.conditions.iter().filter(|c| ids.contains(c.room_id.as_str())).cloned().collect(),
            flows,
            rois: self.rois.iter().filter(|r| ids.contains(r.room_id.as_str())).cloned().collect(),
            robots,
            agents,
            pois,
        }
    }
}

impl World {
    /// Returns every storey as people and robots on it see it, by level; a world of one storey as it is.
    pub fn storeys(&self) -> Vec<(i32, Self)> {
        match self.floorplan.level_numbers().as_slice() {
            [] | [_] => vec![(0, self.clone())],
            levels => levels.iter().map(|&level| (level, self.storey_as_seen(level))).collect(),
        }
    }

    /// Returns one storey as people and robots on it see it: off the ground, stairwells and shafts are no floor of it but
    /// the ways in, so that their doors are its entrances.
    fn storey_as_seen(&self, level: i32) -> Self {
        let shafts = self.floorplan.shafts(level);
        let mut world = self.storey(level);
        if shafts.is_empty() {
            return world;
        }
        let out = |ids: &mut Vec<String>| ids.retain(|id| !shafts.contains(id));
        let plan = &mut world.floorplan;
        plan.rooms.retain(|r| !shafts.contains(&r.room_id));
        plan.windows.retain(|w| !shafts.contains(&w.room_id));
        plan.obstacles.retain(|o| !shafts.contains(&o.room_id));
        for wall in &mut plan.walls {
            let sides = wall.room_ids.len();
            out(&mut wall.room_ids);
            wall.exterior |= wall.room_ids.len() < sides;
        }
        plan.walls.retain(|w| !w.room_ids.is_empty());
        plan.doors.retain(|d| d.room_ids.iter().any(|id| !shafts.contains(id)));
        let mut entered = None;
        for door in plan.doors.iter_mut().filter(|d| d.room_ids.iter().any(|id| shafts.contains(id))) {
            out(&mut door.room_ids);
            if let Some(swing) = &mut door.swing {
                swing.into_room_id = swing.into_room_id.take().filter(|id| !shafts.contains(id));
            }
            if entered.is_none() {
                door.entrance = true;
                entered = door.room_ids.first().cloned();
            }
        }
        plan.links.clear();
        plan.levels.clear();
        plan.rooms.iter_mut().for_each(|r| r.level = 0);
        let graph = &mut world.scene_graph;
        graph.rooms.retain(|r| !shafts.contains(&r.id));
        for room in &mut graph.rooms {
            room.level = 0;
            room.entrance |= entered.as_ref() == Some(&room.id);
        }
        graph.links.clear();
        graph.edges.retain(|e| !shafts.contains(&e.a) && !shafts.contains(&e.b));
        graph.apart.retain(|p| !p.iter().any(|id| shafts.contains(id)));
        world.placements.placements.retain(|p| !shafts.contains(&p.room_id));
        world.placements.unplaced.retain(|u| !shafts.contains(&u.room_id));
        let scenario = &mut world.scenario;
        scenario.rois.retain(|r| !shafts.contains(&r.room_id));
        scenario.pois.retain(|p| !shafts.contains(&p.room_id));
        scenario.robots.iter_mut().for_each(|r| r.level = 0);
        scenario.agents.iter_mut().for_each(|a| a.level = 0);
        world
    }

    /// Returns one storey as a world of its own, in the building's frame; a world of one storey as it is.
    pub fn storey(&self, level: i32) -> Self {
        let floorplan = self.floorplan.storey(level);
        Self {
            version: self.version,
            name: self.name.clone(),
            generator: self.generator.clone(),
            brief: None,
            scene_graph: self.scene_graph.storey(level),
            placements: self.placements.storey(&floorplan),
            scenario: self.scenario.storey(level, &floorplan),
            rules: self.rules.clone(),
            floorplan,
        }
    }
}
