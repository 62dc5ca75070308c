//! Buildings with several storeys, laid out side by side: what lies above each other must not meet on a top view.

use std::borrow::Cow;

use d3dgen_model::world::World;

/// Free space between storeys, m.
const BETWEEN_M: f64 = 10.0;

/// Returns the world with its storeys beside each other, the lowest in the west; a world of one storey as it is.
pub(crate) fn side_by_side(world: &World) -> Cow<'_, World> {
    let levels = world.floorplan.level_numbers();
    if levels.len() < 2 {
        return Cow::Borrowed(world);
    }
    let corners = || world.floorplan.rooms.iter().flat_map(|r| r.polygon.corners()).map(|p| p.x);
    let step = corners().fold(f64::MIN, f64::max) - corners().fold(f64::MAX, f64::min) + BETWEEN_M;
    let offset = |level: i32| levels.iter().position(|l| *l == level).map_or(0.0, |k| k as f64 * step);
    let of_room = |id: &str| world.floorplan.room(id).map_or(0.0, |r| offset(r.level));

    let mut out = world.clone();
    let plan = &mut out.floorplan;
    (plan.rooms, plan.walls, plan.doors, plan.windows) = Default::default();
    for level in &levels {
        let storey = world.floorplan.storey(*level).moved(offset(*level), 0.0);
        plan.rooms.extend(storey.rooms);
        plan.walls.extend(storey.walls);
        plan.doors.extend(storey.doors);
        plan.windows.extend(storey.windows);
    }
    for p in &mut out.placements.placements {
        p.pose.x += of_room(&p.room_id);
    }
    for poi in &mut out.scenario.pois {
        poi.pose.x += of_room(&poi.room_id);
    }
    for robot in &mut out.scenario.robots {
        robot.start.x += offset(robot.level);
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use d3dgen_model::storeys::{LinkKind, VerticalLink};

    use super::*;
    use crate::measure::measure;
    use crate::sample;

    /// The sample with a copy of itself on top, joined by stairs through its first room.
    fn two_storeys() -> World {
        let mut world = sample::world();
        let upper = sample::world();
        let rename = |id: &str| format!("upper_{id}");
        for mut room in upper.floorplan.rooms {
            (room.room_id, room.level) = (rename(&room.room_id), 1);
            world.floorplan.rooms.push(room);
        }
        for mut wall in upper.floorplan.walls {
            wall.room_ids.iter_mut().for_each(|r| *r = rename(r));
            world.floorplan.walls.push(wall);
        }
        for mut door in upper.floorplan.doors.into_iter().filter(|d| !d.entrance) {
            door.room_ids.iter_mut().for_each(|r| *r = rename(r));
            world.floorplan.doors.push(door);
        }
        for mut p in upper.placements.placements {
            (p.room_id, p.placement_id) = (rename(&p.room_id), rename(&p.placement_id));
            p.support = p.support.as_deref().map(rename);
            world.placements.placements.push(p);
        }
        let room_ids = vec!["a_1".into(), "upper_a_1".into()];
        world.floorplan.links = vec![VerticalLink { link_id: "stairs_a".into(), kind: LinkKind::Stairs, room_ids }];
        world
    }

    #[test]
    fn storeys_do_not_collide_and_are_reached_by_stairs() {
        let mut world = two_storeys();
        let found = measure(&world, None, "a", &Default::default());
        assert_eq!((found.layout.objects, found.collisions.pairs.len(), found.support.object_share), (10, 0, 1.0));
        assert_eq!((found.navigability.house, found.navigability.reached_in_public), (1.0, 1.0));
        assert!(found.out_of_bounds.objects.is_empty() && found.robots[0].fits);
        world.floorplan.links.clear();
        let found = measure(&world, None, "a", &Default::default());
        assert_eq!(found.navigability.behind_private, ["upper_a_1", "upper_b_1"], "nothing leads up");
    }
}
