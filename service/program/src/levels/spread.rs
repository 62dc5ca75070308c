//! Open offices of buildings with several storeys: one that has desks for all who work there may be larger than a storey is
//! to be, so its desks are shared out to the storeys as far as these have floor for them.

use d3dgen_model::domain::Domain;
use d3dgen_model::offer::{MOST_IN_TEAM, most_desks};
use d3dgen_model::scene_graph::Note;

use super::deal;
use super::storeys::Wanted;
use crate::built::planned::Planned;
use crate::built::workers;
use crate::reading::Reading;
use crate::subject::programs::is_office;
use crate::tokens::storey::Where;

/// Least desks of a part of an open office.
const LEAST_PART: u32 = 8;
/// How much larger than the mean a storey may be with all of the open office before its desks are shared out.
const LARGE: f64 = 1.2;
/// The same of desks that the prompt gives this room, and the share of the mean storey from which on it takes one by itself.
const LARGE_TOLD: f64 = 1.8;
const WHOLE_STOREY: f64 = 0.7;

/// Shares the desks of the open office out to the storeys, where it is much larger than one of them is to be.
pub(crate) fn open_offices<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let domain = reading.domain;
    let levels: Vec<i32> = reading.storeys.levels.iter().copied().filter(|l| *l >= 0).collect();
    let settled = reading.total.is_some() || reading.single || domain.circulation.storeys.is_none();
    if levels.len() < 2 || settled || !is_office(reading.program) {
        return;
    }
    let open: Vec<usize> = (0..rooms.len()).filter(|&i| is_open(domain, &rooms[i])).collect();
    let told = |r: &Planned| {
        let named = reading.held.iter().any(|h| h.room_type == r.room_type);
        named && r.requested || r.area_m2.is_some() || r.unit.is_some()
    };
    let [first, ..] = open[..] else { return };
    let desks: u32 = open.iter().filter_map(|&i| rooms[i].occupants).sum();
    if desks < 2 * LEAST_PART || open.len() >= levels.len() {
        return;
    }
    // a number that the prompt gives stays together as long as the storeys can carry it, or where the prompt puts it
    let told = open.iter().any(|&i| told(&rooms[i]));
    if told && reading.storeys.wanted.iter().any(|w| w.room_type == rooms[first].room_type) {
        return;
    }
    let large = if told { LARGE_TOLD } else { LARGE };
    let areas: Vec<f64> = rooms.iter().map(Planned::reckoned_m2).collect();
    let dealt = deal::deal(&mut reading.clone(), rooms, &areas, &reading.storeys.levels.clone());
    let others = |level: i32| -> f64 {
        let here = |i: &usize| dealt[*i] == level && !open.contains(i);
        (0..rooms.len()).filter(here).map(|i| areas[i]).sum()
    };
    let loads: Vec<f64> = levels.iter().map(|&l| others(l)).collect();
    let spare: f64 = open.iter().map(|&i| areas[i]).sum();
    let mean = (loads.iter().sum::<f64>() + spare) / levels.len() as f64;
    let largest = levels
        .iter()
        .zip(&loads)
        .map(|(l, load)| load + open.iter().filter(|&&i| dealt[i] == *l).map(|&i| areas[i]).sum::<f64>());
    if largest.fold(0.0, f64::max) < large * mean && spare < WHOLE_STOREY * mean {
        return;
    }
    let more = |parts: &Vec<u32>| parts.iter().filter(|n| **n > 0).count() > open.len();
    let by_load = Some(shares(desks, spare, &loads)).filter(more);
    // else what stands beside it is dealt anew
    let alike = || Some(shares(desks, spare, &vec![0.0; levels.len()])).filter(|_| spare >= WHOLE_STOREY * mean);
    let Some(parts) = by_load.or_else(|| alike().filter(more)) else { return };
    let id = rooms[first].room_type.clone();
    reading.storeys.wanted.retain(|w| w.room_type != id);
    let mut said = Vec::new();
    let mut own = open.into_iter();
    for (&level, &desks) in levels.iter().zip(&parts).filter(|(_, n)| **n > 0) {
        let at = own.next().unwrap_or_else(|| {
            rooms.push(Planned { people_area_m2: None, ..rooms[first].clone() });
            rooms.len() - 1
        });
        workers::seat(reading, &mut rooms[at], desks);
        reading.storeys.wanted.push(Wanted { room_type: id.clone(), count: 1, at: Where::Level(level) });
        said.push(format!("{desks} on level {level}"));
    }
    let message = format!(
        "{} for {desks} would be larger than the other storeys; its desks are shared out: {}",
        rooms[first].kind.label.to_lowercase(),
        said.join(", ")
    );
    reading.conflicts.push(Note::new("open_office_shared_out", message));
}

fn is_open(domain: &Domain, room: &Planned) -> bool {
    most_desks(domain, room.kind) > MOST_IN_TEAM
}

/// Returns the desks of each storey, so that all have about as much floor: `area_m2` is what all desks need, `loads` what the
/// storeys have beside them.
fn shares(desks: u32, area_m2: f64, loads: &[f64]) -> Vec<u32> {
    let mut takes = vec![true; loads.len()];
    loop {
        let count = takes.iter().filter(|t| **t).count() as f64;
        let sum: f64 = loads.iter().zip(&takes).filter(|(_, t)| **t).map(|(l, _)| l).sum();
        let level = (sum + area_m2) / count;
        let each = |l: f64| f64::from(desks) * (level - l).max(0.0) / area_m2;
        // a storey that has floor for a few desks only has none
        let least = (0..loads.len()).filter(|&i| takes[i]).max_by(|a, b| loads[*a].total_cmp(&loads[*b]));
        let Some(least) = least else { return vec![0; loads.len()] };
        if count > 1.0 && each(loads[least]) < f64::from(LEAST_PART) {
            takes[least] = false;
            continue;
        }
        let mut out: Vec<u32> =
            loads.iter().zip(&takes).map(|(l, t)| if *t { each(*l).floor() as u32 } else { 0 }).collect();
        let mut left = desks.saturating_sub(out.iter().sum());
        for i in (0..loads.len()).cycle().take(loads.len() * (1 + desks as usize)) {
            if left > 0 && takes[i] {
                out[i] += 1;
                left -= 1;
            }
        }
        return out;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn storeys_get_desks_by_the_floor_they_have_left() {
        // 30 desks of 10 m2: the full storey has none, the others as many as make them equal
        assert_eq!(shares(30, 300.0, &[400.0, 100.0, 200.0]), [0, 20, 10]);
        assert_eq!(shares(31, 310.0, &[0.0, 0.0]), [16, 15]);
        assert_eq!(shares(10, 100.0, &[90.0, 80.0]), [0, 10]);
    }
}
