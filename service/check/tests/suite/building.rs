//! Changes that break the rules about outlines, walls, sizes and how rooms hang together.

use d3dgen_model::domain::{Access, AdjacencyRelation, Mount, Privacy, Shape};
use d3dgen_model::floorplan::{DoorKind, PlanRoom};
use d3dgen_model::placements::Placement;
use d3dgen_model::sanitary;
use d3dgen_model::world::World;
use d3dgen_model::{Point, Polygon, Segment};

use super::{Break, Change, Sample, always, each, one, somewhere};

pub(super) const BREAKS: &[Break] = &[
    always("not_finite", not_finite),
    always("zone_invalid", spike),
    somewhere("zone_invalid", &[], |s| {
        let mut out = one(s, |w| {
            let room = w.floorplan.rooms.first_mut()?;
            room.net_polygon.0.insert(0, room.net_polygon.0[0]);
            Some(room.room_id.clone())
        });
        out.extend(spike(s));
        out
    }),
    always("zone_clockwise", |s| {
        each(s, 0..s.world.floorplan.rooms.len(), |w, i| {
            w.floorplan.rooms[i].net_polygon.0.reverse();
            Some(w.floorplan.rooms[i].room_id.clone())
        })
    }),
    somewhere("zone_overlap", &[], overlap),
    always("zone_net", |s| {
        each(s, 0..s.world.floorplan.rooms.len(), |w, i| {
            w.floorplan.rooms[i].net_area_m2 += 0.02;
            Some(w.floorplan.rooms[i].room_id.clone())
        })
    }),
    always("name_duplicate", |s| {
        each(s, 1..s.world.floorplan.windows.len().min(3), |w, i| {
            w.floorplan.windows[i].window_id = w.floorplan.windows[0].window_id.clone();
            Some(w.floorplan.windows[0].window_id.clone())
        })
    }),
    always("wall_gap", |s| {
        let walls = s.world.floorplan.walls.iter().enumerate();
        let inner = walls.filter(|(_, w)| w.room_ids.len() == 2 && w.line.length() > 0.3);
        each(s, inner.map(|(i, _)| i), |w, i| Some(w.floorplan.walls.remove(i).room_ids.remove(0)))
    }),
    always("wall_stray", |s| {
        each(s, 0..s.world.floorplan.walls.len().min(5), |w, i| {
            let wall = &mut w.floorplan.walls[i];
            let own = wall.room_ids.first()?.clone();
            wall.room_ids = w.floorplan.rooms.iter().map(|r| r.room_id.clone()).filter(|r| *r != own).take(1).collect();
            let wall = &mut w.floorplan.walls[i];
            wall.room_ids.push(own);
            wall.exterior = !wall.exterior;
            Some(wall.wall_id.clone())
        })
    }),
    always("graph_room_missing", |s| {
        one(s, |w| {
            let mut room = w.scene_graph.rooms[0].clone();
            room.id = "room_not_built".into();
            w.scene_graph.rooms.push(room);
            Some("room_not_built".into())
        })
    }),
    always("graph_edge_missing", |s| {
        let joined: Vec<_> = s.world.floorplan.doors.iter().map(|d| &d.room_ids).collect();
        let rooms = &s.world.floorplan.rooms;
        let pairs = rooms.iter().flat_map(|a| rooms.iter().map(move |b| (a.room_id.clone(), b.room_id.clone())));
        let apart = pairs.filter(|(a, b)| a < b && !joined.iter().any(|d| d.contains(a) && d.contains(b)));
        each(s, apart, |w, (a, b)| {
            let mut edge = w.scene_graph.edges.first()?.clone();
            edge.connector = d3dgen_model::scene_graph::Connector::Door;
            edge.required = true;
            (edge.a, edge.b) = (a.clone(), b.clone());
            w.scene_graph.edges.push(edge);
            Some(format!("{a}|{b}"))
        })
    }),
    somewhere(
        "adjacency_missing",
        &["graph_edge_missing", "private_passage", "wall_gap", "unreachable_zone", "free_space_split", "pose_taken"],
        adjacency,
    ),
    always("adjacency_forbidden", |s| {
        let walls = s.world.floorplan.walls.iter().filter(|w| w.room_ids.len() == 2 && w.line.length() > 0.5);
        let pairs: Vec<_> = walls.map(|w| [w.room_ids[0].clone(), w.room_ids[1].clone()]).collect();
        each(s, pairs.into_iter(), |w, pair| {
            w.scene_graph.apart.push(pair.clone());
            Some(pair.join("|"))
        })
    }),
    always("room_forbidden", |s| {
        each(s, 0..s.world.floorplan.rooms.len(), |w, i| {
            let room = &w.floorplan.rooms[i];
            w.scene_graph.forbidden_room_types.push(room.room_type.clone());
            Some(room.room_id.clone())
        })
    }),
    somewhere("toilet_missing", &["object_missing", "person_station", "object_unsupported"], |s| {
        one(s, |w| {
            let flushes =
                |id: &str| s.domain.object(id).is_some_and(|o| matches!(o.shape, Shape::Toilet | Shape::Cubicle));
            let before = w.placements.placements.len();
            w.placements.placements.retain(|p| !flushes(&p.object));
            (w.placements.placements.len() < before).then(|| "building".to_owned())
        })
    }),
    somewhere("toilet_missing", &["graph_room_missing", "object_missing"], |s| {
        one(s, |w| {
            let plain = |id: &str| s.domain.room_type(id).is_some_and(|k| sanitary::is_accessible(s.domain, k));
            let storage = s.domain.room_types.iter().find(|k| k.id == "storage")?;
            let room = w.scene_graph.rooms.iter_mut().find(|r| plain(&r.room_type))?;
            room.room_type.clone_from(&storage.id);
            Some("building".to_owned())
        })
    }),
    somewhere(
        "private_passage",
        &[
            "graph_edge_missing",
            "adjacency_missing",
            "adjacency_forbidden",
            "door_blocked",
            "free_space_split",
            "unreachable_zone",
        ],
        through_private,
    ),
    somewhere("public_path_in_restricted", &[], behind_lock),
    always("room_area", |s| range(s, |area| [area * 1.1, area * 1.2])),
    always("room_area", |s| range(s, |area| [area * 0.5, area * 0.9])),
    somewhere("room_dimension", &["room_proportion", "robot_stuck", "unreachable_zone", "object_clearance"], slits),
    somewhere("room_proportion", &["room_dimension", "robot_stuck", "unreachable_zone", "object_clearance"], slits),
    somewhere("room_height", &["object_too_high", "window_misplaced"], |s| {
        each(s, 0..s.world.floorplan.rooms.len(), |w, i| {
            let room = &mut w.floorplan.rooms[i];
            let limit = s.retrieval.limits.rooms.get(&room.room_type)?.ceiling_height_min.as_ref()?;
            room.ceiling_height_m = limit.value - 0.02;
            Some(room.room_id.clone())
        })
    }),
];

/// One number of each kind of thing is none.
fn not_finite(s: &Sample) -> Vec<Change> {
    const NAN: f64 = f64::NAN;
    let kinds: [fn(&mut World) -> Option<String>; 11] = [
        |w| w.floorplan.rooms.first_mut().map(|r| (r.polygon.0[0].x = NAN, r.room_id.clone()).1),
        |w| w.floorplan.walls.first_mut().map(|x| (x.line.start.y = f64::INFINITY, x.wall_id.clone()).1),
        |w| w.floorplan.doors.first_mut().map(|d| (d.wall_thickness_m = NAN, d.door_id.clone()).1),
        |w| w.floorplan.doors.last_mut().map(|d| (d.height_m = NAN, d.door_id.clone()).1),
        |w| w.floorplan.windows.first_mut().map(|x| (x.head_m = NAN, x.window_id.clone()).1),
        |w| w.floorplan.windows.last_mut().map(|x| (x.wall_thickness_m = NAN, x.window_id.clone()).1),
        |w| w.placements.placements.first_mut().map(|p| (p.pose.yaw_rad = NAN, p.placement_id.clone()).1),
        |w| w.scenario.pois.first_mut().map(|p| (p.pose.x = NAN, p.poi_id.clone()).1),
        |w| w.scenario.agents.first_mut().map(|a| (a.start.y = NAN, a.agent_id.clone()).1),
        |w| w.scenario.rois.first_mut().map(|r| (r.polygon.0[1].y = NAN, r.roi_id.clone()).1),
        |w| w.scenario.robots.first_mut().map(|r| (r.start.x = NAN, r.robot_id.clone()).1),
    ];
    each(s, kinds.into_iter(), |w, change| change(w))
}

/// The net outline of a room runs out from a corner and back on itself.
fn spike(s: &Sample) -> Vec<Change> {
    each(s, 0..s.world.floorplan.rooms.len(), |w, i| {
        let room = &mut w.floorplan.rooms[i];
        let corner = room.net_polygon.0[0];
        let out = corner.x - room.net_polygon.bounds().center().x;
        room.net_polygon.0.insert(1, Point::new(corner.x + 0.3 * out.signum(), corner.y));
        room.net_polygon.0.insert(2, corner);
        Some(room.room_id.clone())
    })
}

/// A side of a room moves into its neighbor, by less than a wall may lie off.
fn overlap(s: &Sample) -> Vec<Change> {
    let walls = s.world.floorplan.walls.iter().filter(|w| w.room_ids.len() == 2 && w.line.length() > 0.8);
    each(s, walls, |w, wall| {
        let mut pair: Vec<usize> =
            (0..w.floorplan.rooms.len()).filter(|i| wall.room_ids.contains(&w.floorplan.rooms[*i].room_id)).collect();
        let subject = format!("{}|{}", w.floorplan.rooms[pair[0]].room_id, w.floorplan.rooms[*pair.get(1)?].room_id);
        pair.retain(|i| w.floorplan.rooms[*i].polygon.0.len() == 4);
        let room = &mut w.floorplan.rooms[*pair.first()?];
        let (center, line) = (room.polygon.bounds().center(), wall.line.start);
        for p in &mut room.polygon.0 {
            if wall.line.is_vertical() && (p.x - line.x).abs() < 1e-3 {
                p.x += 0.018 * (line.x - center.x).signum();
            } else if !wall.line.is_vertical() && (p.y - line.y).abs() < 1e-3 {
                p.y += 0.018 * (line.y - center.y).signum();
            }
        }
        Some(subject)
    })
}

/// A door that a rule of the domain asks for joins two other rooms, by its name only.
fn adjacency(s: &Sample) -> Vec<Change> {
    let must = s.domain.adjacency.iter().filter(|p| p.relation == AdjacencyRelation::Must && p.via != "wall");
    let rooms = &s.world.floorplan.rooms;
    let pairs = must.flat_map(|p| rooms.iter().filter(|r| r.room_type == p.a).map(move |r| (p, r.room_id.clone())));
    each(s, pairs, |w, (pair, id)| {
        let kinds: Vec<String> =
            w.floorplan.rooms.iter().filter(|r| r.room_type == pair.b).map(|r| r.room_id.clone()).collect();
        w.floorplan.doors.retain(|d| !(d.room_ids.contains(&id) && d.room_ids.iter().any(|r| kinds.contains(r))));
        (!kinds.is_empty()).then_some(id)
    })
}

/// The only door of a room moves, by its name and place, to a private neighbor; a wall closes where it was.
fn through_private(s: &Sample) -> Vec<Change> {
    let private = |id: &String| {
        let room = s.world.floorplan.room(id).unwrap();
        let kind = s.domain.room_type_or_generic(&room.room_type);
        let hub = s.domain.circulation.hub_room_types.contains(&room.room_type);
        !room.circulation && !hub && kind.privacy == Privacy::Private && kind.access == Access::Circulation
    };
    let walls = s
        .world
        .floorplan
        .walls
        .iter()
        .filter(|w| w.room_ids.len() == 2 && w.line.length() > 1.3 && w.room_ids.iter().all(private));
    let turned = walls.flat_map(|w| [(w, 0), (w, 1)]).flat_map(|(w, i)| [0.2, 0.5, 0.8].map(|at| (w, i, at)));
    each(s, turned, |w, (wall, inner, at)| {
        let id = wall.room_ids[inner].clone();
        let mut doors = w.floorplan.doors.iter().enumerate().filter(|(_, d)| d.room_ids.contains(&id));
        let (k, old) = doors.next().map(|(k, d)| (k, d.clone()))?;
        if doors.next().is_some() {
            return None;
        }
        let k_wall = w.floorplan.walls.iter().position(|x| x.wall_id == wall.wall_id)?;
        let width = old.line.length();
        let (a, b) = (wall.line.start, wall.line.end);
        let on = |t: f64| {
            let f = t / wall.line.length();
            Point::new(a.x + (b.x - a.x) * f, a.y + (b.y - a.y) * f)
        };
        let from = 0.2 + at * (wall.line.length() - 0.4 - width).max(0.0);
        let opening = Segment { start: on(from), end: on(from + width) };
        let mut closing = w.floorplan.walls[k_wall].clone();
        (closing.wall_id, closing.line, closing.room_ids) = ("wall_closing".into(), old.line, old.room_ids.clone());
        let mut rest = w.floorplan.walls[k_wall].clone();
        (rest.wall_id, rest.line) = ("wall_rest".into(), Segment { start: opening.end, end: b });
        w.floorplan.walls[k_wall].line.end = opening.start;
        w.floorplan.walls.extend([closing, rest]);
        let door = &mut w.floorplan.doors[k];
        (door.line, door.kind, door.swing, door.room_ids) = (opening, DoorKind::Open, None, wall.room_ids.clone());
        Some(id)
    })
}

/// The corridor becomes the one behind the lock, which nobody who visits goes through.
fn behind_lock(s: &Sample) -> Vec<Change> {
    let Some(part) = s.domain.circulation.locked.first() else { return Vec::new() };
    let rooms = s.world.floorplan.rooms.iter().filter(|r| !r.circulation).map(|r| r.room_id.clone());
    each(s, rooms, |w, id| {
        w.floorplan.rooms.iter_mut().filter(|r| r.circulation).for_each(|r| r.name.clone_from(&part.corridor));
        Some(id)
    })
}

/// The prompt wanted another area.
fn range(s: &Sample, wanted: impl Fn(f64) -> [f64; 2]) -> Vec<Change> {
    let rooms = s.world.floorplan.rooms.iter().filter(|r| !r.circulation);
    // a least area by a rule stands whatever the prompt says
    let free = rooms.filter(|r| s.retrieval.limits.rooms.get(&r.room_type).is_none_or(|l| l.area_min.is_none()));
    each(s, free, |w, room| {
        let asked = w.scene_graph.rooms.iter_mut().find(|r| r.id == room.room_id)?;
        asked.area_range_m2 = wanted(room.net_area_m2);
        Some(room.room_id.clone())
    })
}

/// A thin fin of wall runs through most of a room, at several places of each.
fn slits(s: &Sample) -> Vec<Change> {
    let rooms = s.world.floorplan.rooms.iter().filter(|r| !r.circulation && r.net_polygon.0.len() == 4);
    // the middle of every room first
    let shares = (0..=20).map(|i: i32| 0.5 + 0.04 * f64::from(if i % 2 == 0 { i / 2 } else { -(i + 1) / 2 }));
    let all = shares.flat_map(|at| rooms.clone().flat_map(move |r| [(r, at, true), (r, at, false)]));
    // a slit through furniture would break the rules about furniture too; what hangs from the ceiling there is taken down
    let crosses = |p: &Placement, room: &PlanRoom, at: f64, upright: bool| {
        let (o, b) = (p.footprint().bounds(), room.net_polygon.bounds());
        let (from, to, edge) =
            if upright { (o.x0, o.x1, b.x0 + at * b.width()) } else { (o.y0, o.y1, b.y0 + at * b.height()) };
        p.room_id == room.room_id && from < edge + 0.01 && edge < to
    };
    let places = all.filter(|(room, at, upright)| {
        let mut standing = s.world.placements.placements.iter().filter(|p| p.mount != Mount::Ceiling);
        !standing.any(|p| crosses(p, room, *at, *upright))
    });
    each(s, places, |w, (room, at, upright)| {
        w.placements.placements.retain(|p| !crosses(p, room, at, upright));
        let b = room.net_polygon.bounds();
        let along = if upright { b.x0 + at * b.width() } else { b.y0 + at * b.height() };
        let points = if upright {
            [(b.x0, b.y0), (along, b.y0), (along, b.y1 - 0.05), (along + 0.01, b.y1 - 0.05), (along + 0.01, b.y0)]
                .into_iter()
                .chain([(b.x1, b.y0), (b.x1, b.y1), (b.x0, b.y1)])
                .collect::<Vec<_>>()
        } else {
            [(b.x0, b.y0), (b.x1, b.y0), (b.x1, along), (b.x0 + 0.05, along), (b.x0 + 0.05, along + 0.01)]
                .into_iter()
                .chain([(b.x1, along + 0.01), (b.x1, b.y1), (b.x0, b.y1)])
                .collect()
        };
        let changed = w.floorplan.rooms.iter_mut().find(|r| r.room_id == room.room_id)?;
        changed.net_polygon = Polygon(points.into_iter().map(|(x, y)| Point::new(x, y)).collect());
        changed.net_area_m2 = changed.net_polygon.area();
        Some(room.room_id.clone())
    })
}
