//! Storeys that would be smaller than the one that stands on them get rooms more, of those that the domain has for that, and their
//! rooms grow: what is larger than the storey below hangs in the air. Rooms come down from a storey that nothing would carry.

use d3dgen_model::domain::RoomType;
use d3dgen_model::scene_graph::{GraphRoom, Note};

use super::deal::{self, Cluster, Likes, Load};
use super::storeys::Wanted;
use crate::built::planned::Planned;
use crate::built::rooms::tenth;
use crate::reading::Reading;
use crate::tokens::storey::Where;

/// How much smaller than the storey above a storey may be when its rooms are as large as they may be, and rooms that it gets at
/// most.
const SMALL: f64 = 0.75;
const MOST_ADDED: usize = 4;
/// How much larger than usual the rooms of a storey may be, as a factor.
const ROOMY: f64 = 1.3;

/// How much larger than meant rooms may be that carry others, as a factor, and the share of the storey above that a storey has by
/// its areas from which on they need not.
const MOST_TO_CARRY: f64 = 1.4;
const ENOUGH: f64 = 1.1;

/// Share of a storey that the one below has at least before rooms which the prompt puts above come down, and up to which they do.
const FOUNDATION: f64 = 0.4;
const CARRIES: f64 = 0.75;
/// Lets the rooms of a storey that people use grow beyond what their types have, where those above it are about as large or larger.
pub(super) fn grow(planned: &[Planned], rooms: &mut [GraphRoom], (lower, upper): (i32, i32)) {
    let (below, above) = (deal::area_on(rooms, lower), deal::area_on(rooms, upper));
    if below >= ENOUGH * above {
        return;
    }
    let grows = |p: &Planned, r: &GraphRoom| r.level == lower && p.area_m2.is_none() && deal::is_used(p.kind);
    let free: f64 = planned.iter().zip(&*rooms).filter(|(p, r)| grows(p, r)).map(|(_, r)| r.target_area_m2).sum();
    let factor = (1.0 + (above - below).max(0.0) / free.max(1.0)).min(MOST_TO_CARRY);
    for (p, room) in planned.iter().zip(rooms) {
        if grows(p, room) {
            let most = MOST_TO_CARRY * room.target_area_m2;
            room.target_area_m2 = tenth(factor * room.target_area_m2);
            room.area_range_m2[1] = room.area_range_m2[1].max(tenth(most));
        }
    }
}

/// Moves rooms that the prompt puts on a storey down to the one below where that has next to nothing to carry them with; those go
/// first that belong on the ground. Returns what moved, and where to.
pub(super) fn stand_on_ground(
    at: &mut [Option<i32>],
    clusters: &[Cluster],
    (above, used): (&[i32], &[bool]),
    load: &Load<'_>,
) -> Vec<(usize, i32)> {
    let mut moved = Vec::new();
    for pair in above.windows(2).rev() {
        let [lower, upper] = [pair[0], pair[1]];
        let carried = |at: &[Option<i32>]| load(at, clusters, lower) / load(at, clusters, upper).max(1.0);
        if carried(at) >= FOUNDATION {
            continue;
        }
        while carried(at) < CARRIES {
            let gap = load(at, clusters, upper) - load(at, clusters, lower);
            let moves = |i: usize| used[i] || clusters[i].likes == Likes::Ground;
            let here = |i: &usize| at[*i] == Some(upper) && clusters[*i].likes != Likes::Each && moves(*i);
            let several = (0..clusters.len()).filter(here).count() > 1;
            let fits = |i: &usize| clusters[*i].area < gap && several;
            let rank = |i: usize| (clusters[i].likes != Likes::Ground, clusters[i].likes == Likes::Upper);
            let off = |i: usize| (clusters[i].area - gap / 2.0).abs();
            let order = |a: &usize, b: &usize| rank(*a).cmp(&rank(*b)).then(off(*a).total_cmp(&off(*b)));
            let Some(i) = (0..clusters.len()).filter(here).filter(fits).min_by(order) else { break };
            at[i] = Some(lower);
            moved.push((i, lower));
        }
    }
    moved
}

/// Adds rooms to storeys that are smaller than the one above, where the prompt leaves the rooms open.
pub(crate) fn fill<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let above = reading.storeys.above_ground();
    let settled = reading.total.is_some() || reading.single || reading.only;
    let Some(rules) = reading.domain.circulation.storeys.as_ref().filter(|_| above > 1 && !settled) else { return };
    let levels: Vec<i32> = reading.storeys.levels.iter().copied().filter(|l| *l >= 0).collect();
    for pair in levels.windows(2).rev() {
        let mut added: Vec<String> = Vec::new();
        let kinds = rules.carrying_room_types.iter().filter_map(|id| reading.domain.room_type(id));
        for kind in kinds.filter(|k| !reading.wishes.forbidden.contains(&k.id)).collect::<Vec<&RoomType>>() {
            let (lower, upper) = loads(reading, rooms, (pair[0], pair[1]));
            if lower >= SMALL * upper || added.len() == MOST_ADDED {
                break;
            }
            if lower + kind.area_m2.target > upper {
                continue;
            }
            rooms.push(Planned::new(&kind.id, kind));
            // others of the type stay where they are
            if rooms.iter().filter(|r| r.room_type == kind.id).count() == 1 {
                let at = Where::Level(pair[0]);
                reading.storeys.wanted.push(Wanted { room_type: kind.id.clone(), count: 1, at });
            }
            added.push(kind.label.to_lowercase());
        }
        if !added.is_empty() {
            let which = if pair[0] == 0 { "the ground floor".into() } else { format!("level {}", pair[0]) };
            let message = format!("{which} would be smaller than the storey above; added {}", added.join(", "));
            reading.conflicts.push(Note::new("ground_floor_filled", message));
        }
    }
}

/// Returns how large a storey can be and how large the one above is, m^2.
fn loads(reading: &Reading, rooms: &[Planned], (lower, upper): (i32, i32)) -> (f64, f64) {
    let areas: Vec<f64> = rooms.iter().map(Planned::reckoned_m2).collect();
    let dealt = deal::deal(&mut reading.clone(), rooms, &areas, &reading.storeys.levels.clone());
    let grows = |room: &Planned| if deal::is_used(room.kind) && room.area_m2.is_none() { ROOMY } else { 1.0 };
    let dealt = &dealt;
    let on = |level: i32| (0..rooms.len()).filter(move |&i| dealt[i] == level);
    let can = on(lower).map(|i| grows(&rooms[i]) * areas[i]).sum();
    (can, on(upper).map(|i| areas[i]).sum())
}
