//! Changes that break the rules about doors, windows and ways.

use d3dgen_model::floorplan::{Door, DoorKind};
use d3dgen_model::world::World;
use d3dgen_model::{Point, Rect};

use super::{Break, Change, Sample, add_thing, always, at_door, at_line, each, one, room_at, somewhere};

pub(super) const BREAKS: &[Break] = &[
    somewhere("door_floating", &[], |s| {
        // the wall beside the door reaches 8 cm into it
        let pairs =
            (0..s.world.floorplan.doors.len()).flat_map(|d| (0..s.world.floorplan.walls.len()).map(move |w| (d, w)));
        each(s, pairs, |w, (d, k)| {
            let (door, wall) = (w.floorplan.doors[d].clone(), &mut w.floorplan.walls[k]);
            let parallel = door.line.is_vertical() == wall.line.is_vertical();
            let meets = parallel && wall.line.end.distance(door.line.start) < 0.01;
            let f = 0.08 / door.line.length();
            wall.line.end.x += f * (door.line.end.x - door.line.start.x);
            wall.line.end.y += f * (door.line.end.y - door.line.start.y);
            meets.then_some(door.door_id)
        })
    }),
    always("door_unlinked", |s| {
        doors(s, |w, i| {
            let mut passage = w.floorplan.doors[i].clone();
            let two = passage.room_ids.len() == 2;
            (passage.door_id, passage.kind, passage.swing) = ("door_added".into(), DoorKind::Open, None);
            passage.room_ids.truncate(1);
            w.floorplan.doors.push(passage);
            two.then(|| "door_added".into())
        })
    }),
    always("door_narrow", |s| {
        doors(s, |w, i| {
            let door = &mut w.floorplan.doors[i];
            door.clear_width_m = door.line.length() + 0.05;
            Some(door.door_id.clone())
        })
    }),
    somewhere("door_narrow", &["wall_gap", "door_width", "unreachable_zone", "free_space_split"], |s| {
        doors(s, |w, i| {
            let door = &mut w.floorplan.doors[i];
            shorten(door, 0.5);
            Some(door.door_id.clone())
        })
    }),
    somewhere("door_jamb", &["door_swing", "door_blocked"], jamb),
    always("door_width", |s| {
        doors(s, |w, i| {
            let door = &mut w.floorplan.doors[i];
            door.clear_width_m = 0.55;
            Some(door.door_id.clone())
        })
    }),
    somewhere("door_blocked", &[], |s| before_doors(s, (0.3, 0.45), 0.1)),
    somewhere("door_swing", &[], |s| before_doors(s, (0.55, 0.7), 0.15)),
    always("no_entrance", |s| {
        one(s, |w| {
            w.floorplan.doors.iter_mut().for_each(|d| d.entrance = false);
            Some("building".into())
        })
    }),
    always("no_entrance", |s| {
        let inner = s.world.floorplan.rooms.iter().map(|r| &r.room_id);
        let inner = inner.filter(|id| !s.world.floorplan.doors_of(id).any(|d| d.room_ids.len() == 1));
        each(s, inner, |w, id| {
            w.scene_graph.rooms.iter_mut().find(|r| r.id == *id)?.entrance = true;
            Some(id.clone())
        })
    }),
    always("window_misplaced", |s| {
        windows(s, |w, i| {
            w.floorplan.windows[i].head_m = 30.0;
            Some(w.floorplan.windows[i].window_id.clone())
        })
    }),
    always("window_misplaced", |s| {
        windows(s, |w, i| {
            let inner = w.floorplan.walls.iter().find(|x| !x.exterior && x.line.length() > 0.5)?.line;
            w.floorplan.windows[i].line = inner;
            Some(w.floorplan.windows[i].window_id.clone())
        })
    }),
    always("window_overlap", |s| {
        windows(s, |w, i| {
            let mut second = w.floorplan.windows[i].clone();
            second.window_id = "window_added".into();
            let subject = format!("{}|window_added", w.floorplan.windows[i].window_id);
            w.floorplan.windows.push(second);
            Some(subject)
        })
    }),
    somewhere("window_blocked", &[], |s| {
        let places = (0..s.world.floorplan.windows.len()).flat_map(|i| [(i, true), (i, false)]);
        let places = places.flat_map(|(i, side)| [0.1, 0.5, 0.9].map(|at| (i, side, at)));
        each(s, places, |w, (i, ahead, at)| {
            let window = w.floorplan.windows[i].clone();
            let (off, from) = (window.wall_thickness_m / 2.0, at * (window.line.length() - 0.3));
            let rect = at_line(&window.line, ahead, (off + 0.02, off + 0.22), (from, from + 0.3));
            let room = room_at(w, &rect)?;
            let id = add_thing(w, s.domain, &room, rect, window.sill_m + 0.4)?;
            Some(format!("{}|{id}", window.window_id))
        })
    }),
    always("daylight_missing", |s| {
        let dark = s.world.floorplan.rooms.iter().filter(|r| {
            s.domain.room_type_or_generic(&r.room_type).daylight == d3dgen_model::domain::Daylight::Required
        });
        each(s, dark, |w, room| {
            w.floorplan.windows.retain(|x| x.room_id != room.room_id);
            Some(room.room_id.clone())
        })
    }),
    somewhere("unreachable_zone", &["no_entrance", "pose_taken", "private_passage", "wall_gap", "robot_stuck"], |s| {
        one(s, |w| {
            w.floorplan.doors.iter_mut().filter(|d| d.room_ids.len() == 1).for_each(|d| d.room_ids.push("?".into()));
            w.floorplan.doors.retain(|d| !d.room_ids.iter().any(|r| r == "?"));
            Some("building".into())
        })
    }),
    somewhere("unreachable_zone", &["free_space_split"], |s| barriers(s, false)),
    somewhere("free_space_split", &["unreachable_zone"], |s| barriers(s, true)),
    somewhere("corridor_narrow", &[], |s| {
        let halls = s.world.floorplan.rooms.iter().filter(|r| r.circulation);
        let places = halls
            .flat_map(|r| (1..10).flat_map(move |k| [(r, f64::from(k) / 10.0, true), (r, f64::from(k) / 10.0, false)]));
        each(s, places, |w, (room, at, upright)| {
            let b = room.net_polygon.bounds();
            // leaves a little over 0.7 m beside it
            let rect = if upright {
                let x = b.x0 + at * b.width();
                Rect::new(x, b.y0 + 0.72, x + 0.1, b.y1)
            } else {
                let y = b.y0 + at * b.height();
                Rect::new(b.x0 + 0.72, y, b.x1, y + 0.1)
            };
            add_thing(w, s.domain, &room.room_id, rect, 0.5)?;
            Some(room.room_id.clone())
        })
    }),
];

fn doors(s: &Sample, f: impl Fn(&mut World, usize) -> Option<String>) -> Vec<Change> {
    each(s, 0..s.world.floorplan.doors.len(), f)
}

fn windows(s: &Sample, f: impl Fn(&mut World, usize) -> Option<String>) -> Vec<Change> {
    each(s, 0..s.world.floorplan.windows.len(), f)
}

/// Makes an opening this wide, its start kept.
fn shorten(door: &mut Door, width: f64) {
    let (a, b, f) = (door.line.start, door.line.end, width / door.line.length());
    door.line.end = Point::new(a.x + (b.x - a.x) * f, a.y + (b.y - a.y) * f);
    door.clear_width_m = door.clear_width_m.min(width);
}

/// A door slides along its wall, a few centimeters a time; the walls beside it follow.
fn jamb(s: &Sample) -> Vec<Change> {
    let steps = (1..9).flat_map(|k| [0.05 * f64::from(k), -0.05 * f64::from(k)]);
    let slides = steps.flat_map(|by| (0..s.world.floorplan.doors.len()).map(move |i| (i, by)));
    each(s, slides, |w, (i, by)| {
        let old = w.floorplan.doors[i].clone();
        let vertical = old.line.is_vertical();
        let moved = |p: Point| if vertical { Point::new(p.x, p.y + by) } else { Point::new(p.x + by, p.y) };
        let at_end = |p: Point| p.distance(old.line.start) < 1e-3 || p.distance(old.line.end) < 1e-3;
        for wall in w.floorplan.walls.iter_mut().filter(|x| x.line.is_vertical() == vertical) {
            for end in [&mut wall.line.start, &mut wall.line.end] {
                if at_end(*end) {
                    *end = moved(*end);
                }
            }
        }
        let line = &mut w.floorplan.doors[i].line;
        (line.start, line.end) = (moved(line.start), moved(line.end));
        Some(old.door_id)
    })
}

/// Something small stands before one end of a door, this far off its center line and so far into its width.
fn before_doors(s: &Sample, off: (f64, f64), into: f64) -> Vec<Change> {
    let places = (0..s.world.floorplan.doors.len())
        .flat_map(|i| [(i, true), (i, false)])
        .flat_map(|(i, ahead)| [(i, ahead, true), (i, ahead, false)]);
    each(s, places, |w, (i, ahead, at_start)| {
        let door = w.floorplan.doors[i].clone();
        let width = door.line.length();
        let along = if at_start { (into - 0.15, into) } else { (width - into, width - into + 0.15) };
        let rect = at_door(&door, ahead, off, along);
        let room = room_at(w, &rect)?;
        let id = add_thing(w, s.domain, &room, rect, 0.4)?;
        Some(format!("{}|{id}", door.door_id))
    })
}

/// A low barrier stands across a room, at several places of each room.
fn barriers(s: &Sample, whole: bool) -> Vec<Change> {
    // every room at one place, then at the next: few rooms have a line from wall to wall without furniture
    let rooms = || s.world.floorplan.rooms.iter().filter(|r| r.net_polygon.0.len() == 4);
    let places = [0.5, 0.35, 0.65, 0.25, 0.75]
        .into_iter()
        .flat_map(|at| rooms().flat_map(move |r| [(r, at, true), (r, at, false)]));
    each(s, places, |w, (room, at, upright)| {
        let b = room.net_polygon.bounds();
        let rect = if upright {
            let x = b.x0 + at * b.width();
            Rect::new(x, b.y0, x + 0.1, b.y1)
        } else {
            let y = b.y0 + at * b.height();
            Rect::new(b.x0, y, b.x1, y + 0.1)
        };
        add_thing(w, s.domain, &room.room_id, rect, 0.3)?;
        Some(if whole { "building".into() } else { room.room_id.clone() })
    })
}
