//! Changes that break the rules about objects, docks, robots and people.

use std::f64::consts::PI;

use d3dgen_knowledge::clearance::quarter;
use d3dgen_model::domain::{Arrangement, Mount, RoomType, Shape};
use d3dgen_model::placements::{Placement, Unplaced};
use d3dgen_model::world::World;
use d3dgen_model::{Point, Pose, Rect};

use super::{Break, Change, SAMPLES, Sample, add_thing, always, each, ids, one, placement, somewhere};

pub(super) const BREAKS: &[Break] = &[
    always("object_no_size", |s| {
        each(s, ids(s, |p| p.mount == Mount::Ceiling), |w, id| {
            placement(w, &id).size_m[1] = 0.0;
            Some(id)
        })
    }),
    always("object_no_size", |s| {
        one(s, |w| {
            let id =
                add_thing(w, s.domain, &w.floorplan.rooms[0].room_id.clone(), Rect::new(0.0, 0.0, 0.1, 0.1), 0.02)?;
            placement(w, &id).object = "no_such_thing".into();
            placement(w, &id).pose = w.placements.placements.iter().find(|p| p.mount == Mount::Ceiling)?.pose;
            placement(w, &id).mount = Mount::Ceiling;
            Some(id)
        })
    }),
    always("object_outside", |s| {
        each(s, ids(s, |p| p.mount == Mount::Ceiling), |w, id| {
            placement(w, &id).pose.x += 500.0;
            Some(id)
        })
    }),
    always("object_collision", |s| {
        each(s, ids(s, |p| p.mount != Mount::Surface && p.size_m[2] > 0.05), |w, id| {
            let mut second = placement(w, &id).clone();
            second.placement_id = "added_copy".into();
            w.placements.placements.push(second);
            Some(format!("{id}|added_copy"))
        })
    }),
    always("object_unsupported", |s| {
        each(s, ids(s, |p| p.mount == Mount::Surface), |w, id| {
            placement(w, &id).support = None;
            Some(id)
        })
    }),
    always("object_unsupported", |s| {
        each(s, ids(s, |p| p.mount == Mount::Floor), |w, id| {
            placement(w, &id).pose.z = 0.04;
            Some(id)
        })
    }),
    always("object_unsupported", |s| {
        each(s, ids(s, |p| p.mount == Mount::Surface), |w, id| {
            placement(w, &id).pose.z += 0.05;
            Some(id)
        })
    }),
    always("object_unsupported", |s| {
        each(s, ids(s, |p| p.mount == Mount::Surface), |w, id| {
            placement(w, &id).support = Some("no_such_table".into());
            Some(id)
        })
    }),
    somewhere("object_unsupported", &[], |s| {
        each(s, ids(s, |p| p.mount == Mount::Wall), |w, id| {
            let p = placement(w, &id);
            match quarter(p.pose.yaw_rad) {
                0 => p.pose.x += 0.15,
                1 => p.pose.y += 0.15,
                2 => p.pose.x -= 0.15,
                _ => p.pose.y -= 0.15,
            }
            Some(id)
        })
    }),
    always("object_too_high", |s| {
        each(s, ids(s, |p| p.mount == Mount::Ceiling), |w, id| {
            placement(w, &id).pose.z += 5.0;
            Some(id)
        })
    }),
    always("object_missing", |s| {
        one(s, |w| {
            let room_id = w.floorplan.rooms[0].room_id.clone();
            let reason = "no wall is long enough".into();
            w.placements.unplaced.push(Unplaced {
                room_id: room_id.clone(),
                item: "bed".into(),
                required: true,
                reason,
            });
            Some(room_id)
        })
    }),
    somewhere("object_missing", &[], missing),
    somewhere("object_facing", &[], |s| {
        each(s, ids(s, |p| p.group.is_some() && p.mount == Mount::Floor), |w, id| {
            turn_round(placement(w, &id));
            Some(id)
        })
    }),
    somewhere("object_back", &[], |s| {
        let to_wall = |p: &Placement| {
            let room = s.world.floorplan.room(&p.room_id).unwrap();
            let kind = s.domain.room_type_or_generic(&room.room_type);
            let mut lines = kind.furnishing.iter().filter(|f| f.item == p.object).peekable();
            let walls = [Arrangement::Wall, Arrangement::SolidWall, Arrangement::WindowWall, Arrangement::Corner];
            p.mount == Mount::Floor
                && p.group.is_none()
                && lines.peek().is_some()
                && lines.all(|f| walls.contains(&f.arrangement))
        };
        each(s, ids(s, to_wall), |w, id| {
            turn_round(placement(w, &id));
            Some(id)
        })
    }),
    somewhere("object_clearance", &[], |s| crowded(s, false)),
    somewhere("dock_blocked", &["object_clearance", "pose_taken", "robot_stuck"], |s| crowded(s, true)),
    always("dock_missing", |s| {
        one(s, |w| {
            let mut robot = SAMPLES.iter().find_map(|o| o.world.scene_graph.robots.first())?.clone();
            (robot.radius_m, robot.charging) = (0.2, true);
            let dock = |p: &Placement| s.domain.object(&p.object).is_some_and(|o| o.shape == Shape::Dock);
            let has_dock = w.placements.placements.iter().any(dock);
            w.scene_graph.robots.push(robot);
            (!has_dock).then(|| "building".into())
        })
    }),
    somewhere("dock_missing", &["object_missing"], |s| {
        one(s, |w| {
            let dock = |object: &str| s.domain.object(object).is_some_and(|o| o.shape == Shape::Dock);
            let charging = w.scene_graph.robots.iter().any(|r| r.charging);
            w.placements.placements.retain(|p| !dock(&p.object));
            charging.then(|| "building".into())
        })
    }),
    always("dock_missing", |s| {
        one(s, |w| {
            // another robot at the same dock
            let mut task = w.scenario.robots.iter().find(|t| t.robot.charging && t.dock.is_some())?.clone();
            task.robot_id.push_str("_twin");
            w.scenario.robots.push(task.clone());
            Some(task.robot_id)
        })
    }),
    always("robot_stuck", |s| {
        one(s, |w| {
            let task = w.scenario.robots.first_mut()?;
            task.goals.push("no_such_point".into());
            Some(task.robot_id.clone())
        })
    }),
    always("robot_stuck", |s| {
        one(s, |w| {
            let task = w.scenario.robots.first_mut()?;
            task.start.x += 500.0;
            Some(task.robot_id.clone())
        })
    }),
    always("robot_stuck", |s| {
        one(s, |w| {
            let task = w.scenario.robots.first_mut()?;
            task.robot.radius_m = 4.0;
            Some(task.robot_id.clone())
        })
    }),
    always("robot_stuck", |s| {
        each(s, legs(s).into_iter(), |w, (robot, leg)| {
            // a detour into the nearest wall
            let task = &mut w.scenario.robots[robot];
            let path = &mut task.routes[leg].path;
            let beyond = Point::new(path[0].x + 100.0, path[0].y);
            path.insert(1, beyond);
            Some(format!("{}|{}", task.robot_id, task.routes[leg].to))
        })
    }),
    always("robot_stuck", |s| {
        each(s, legs(s).into_iter(), |w, (robot, leg)| {
            let task = &mut w.scenario.robots[robot];
            task.routes[leg].clear_width_m += 0.05;
            Some(format!("{}|{}", task.robot_id, task.routes[leg].to))
        })
    }),
    always("robot_stuck", |s| {
        each(s, legs(s).into_iter(), |w, (robot, leg)| {
            // something narrow 1 cm too near to its first line
            let (task, plan) = (&w.scenario.robots[robot], &w.floorplan);
            let path = &task.routes[leg].path;
            let (a, b) = (path[0], path[1]);
            let middle = Point::new((a.x + b.x) / 2.0, (a.y + b.y) / 2.0);
            let room = plan.rooms.iter().find(|r| r.net_polygon.contains(middle))?.room_id.clone();
            let (long, far) = (a.distance(b), task.robot.radius_m + 0.01);
            let normal = ((a.y - b.y) / long, (b.x - a.x) / long);
            let name = format!("{}|{}", task.robot_id, task.routes[leg].to);
            let at = Point::new(middle.x + far * normal.0, middle.y + far * normal.1);
            add_thing(w, s.domain, &room, Rect::new(at.x - 0.02, at.y - 0.02, at.x + 0.02, at.y + 0.02), 1.0)?;
            (long > 0.2).then_some(name)
        })
    }),
    always("pose_taken", |s| {
        each(s, 0..s.world.scenario.agents.len(), |w, i| {
            let blocker = w
                .placements
                .placements
                .iter()
                .find(|p| p.mount == Mount::Floor && p.size_m[2] > 0.3 && p.size_m[0].min(p.size_m[1]) > 0.4)?;
            let agent = &mut w.scenario.agents[i];
            agent.start = Pose { z: 0.0, ..blocker.pose };
            Some(agent.agent_id.clone())
        })
    }),
    always("pose_taken", |s| {
        each(s, 0..s.world.scenario.agents.len(), |w, i| {
            w.scenario.agents[i].waypoints.push("no_such_room".into());
            Some(w.scenario.agents[i].agent_id.clone())
        })
    }),
    somewhere("person_access", &[], |s| {
        // whoever may not enter a room is sent there
        let closed = |w: &World, i: usize| {
            let role = s.domain.roles.iter().find(|r| r.id == w.scenario.agents[i].role)?;
            let shut = |kind: &RoomType| !role.may_enter(kind, &s.domain.tags_of(kind));
            let room = w.floorplan.rooms.iter().find(|r| shut(s.domain.room_type_or_generic(&r.room_type)))?;
            Some(room.room_id.clone())
        };
        each(s, 0..s.world.scenario.agents.len(), |w, i| {
            let room_id = closed(w, i)?;
            let agent = &mut w.scenario.agents[i];
            agent.steps.first_mut()?.room_id = room_id;
            agent.steps[0].station = None;
            Some(agent.agent_id.clone())
        })
    }),
    somewhere("person_station", &[], |s| {
        each(s, 0..s.world.scenario.stations.len(), |w, i| {
            w.scenario.stations[i].placement_id = "no_such_thing".into();
            Some(w.scenario.stations[i].station_id.clone())
        })
    }),
    always("person_station", |s| {
        each(s, 0..s.world.scenario.stations.len(), |w, i| {
            w.scenario.stations[i].before.x += 500.0;
            Some(w.scenario.stations[i].station_id.clone())
        })
    }),
    always("person_pace", |s| {
        each(s, 0..s.world.scenario.agents.len(), |w, i| {
            w.scenario.agents[i].speed_m_s = 4.0;
            Some(w.scenario.agents[i].agent_id.clone())
        })
    }),
    somewhere("robot_job", &[], |s| {
        each(s, 0..s.world.scenario.robots.len(), |w, i| {
            let robot = &mut w.scenario.robots[i];
            let goal = robot.jobs.first()?.to.first()?.clone();
            robot.goals.retain(|g| *g != goal);
            Some(format!("{}|{}", robot.robot_id, robot.jobs[0].job_id))
        })
    }),
    somewhere("robot_job", &[], |s| {
        each(s, 0..s.world.scenario.robots.len(), |w, i| {
            let robot = &mut w.scenario.robots[i];
            let job = robot.jobs.iter_mut().find(|j| j.path.is_empty() && !j.to.is_empty())?;
            job.seconds = 100_000.0; // longer than any battery lasts
            Some(format!("{}|{}", robot.robot_id, job.job_id))
        })
    }),
    somewhere("pose_taken", &["robot_stuck"], |s| {
        each(s, 0..s.world.scenario.pois.len(), |w, i| {
            w.scenario.pois[i].pose.x += 500.0;
            Some(w.scenario.pois[i].poi_id.clone())
        })
    }),
    always("region_outside", |s| {
        each(s, 0..s.world.scenario.rois.len(), |w, i| {
            let roi = &mut w.scenario.rois[i];
            roi.polygon.0.iter_mut().for_each(|p| p.x += 500.0);
            Some(roi.roi_id.clone())
        })
    }),
];

/// Returns the legs of all robots' rounds.
fn legs(s: &Sample) -> Vec<(usize, usize)> {
    let robots = s.world.scenario.robots.iter().enumerate();
    robots.flat_map(|(i, task)| (0..task.routes.len()).map(move |k| (i, k))).collect()
}

fn turn_round(p: &mut Placement) {
    p.pose.yaw_rad = if p.pose.yaw_rad > 0.0 { p.pose.yaw_rad - PI } else { p.pose.yaw_rad + PI };
}

/// All of something that a room must have is gone, with what stands on it.
fn missing(s: &Sample) -> Vec<Change> {
    let rooms = s.world.floorplan.rooms.iter();
    let lines = rooms.flat_map(|r| {
        let kind = s.domain.room_type_or_generic(&r.room_type);
        kind.furnishing.iter().filter(|f| f.required).map(move |f| (r, f))
    });
    each(s, lines, |w, (room, line)| {
        let prefix = format!("{}_{}_", room.room_id, line.item);
        let gone = |p: &Placement| {
            p.room_id == room.room_id
                && (p.object == line.item || p.group.as_ref().is_some_and(|g| g.starts_with(&prefix)))
        };
        let lost: Vec<String> =
            w.placements.placements.iter().filter(|p| gone(p)).map(|p| p.placement_id.clone()).collect();
        let on_lost = |p: &Placement| p.support.as_ref().is_some_and(|id| lost.contains(id));
        w.placements.placements.retain(|p| !gone(p) && !on_lost(p));
        Some(room.room_id.clone())
    })
}

/// Something stands right in front of an object that needs free floor there.
fn crowded(s: &Sample, docks: bool) -> Vec<Change> {
    let needs = |p: &Placement| {
        let dock = |shape| (shape == Shape::Dock) == docks;
        let kind = s.domain.object(&p.object).filter(|k| k.clearance_front_m > 0.3 && dock(k.shape));
        kind.is_some() && p.mount == Mount::Floor && p.group.is_none()
    };
    each(s, ids(s, needs), |w, id| {
        let p = placement(w, &id).clone();
        let (near, far) = (p.size_m[1] / 2.0 + 0.05, p.size_m[1] / 2.0 + 0.2);
        let (x, y) = (p.pose.x, p.pose.y);
        let rect = match quarter(p.pose.yaw_rad) {
            0 => Rect::new(x + near, y - 0.08, x + far, y + 0.08),
            1 => Rect::new(x - 0.08, y + near, x + 0.08, y + far),
            2 => Rect::new(x - far, y - 0.08, x - near, y + 0.08),
            _ => Rect::new(x - 0.08, y - far, x + 0.08, y - near),
        };
        add_thing(w, s.domain, &p.room_id, rect, 0.4)?;
        Some(id)
    })
}
