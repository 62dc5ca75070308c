//! From placed units to the document: ids, poses in meters, support, rule.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_PI_2, PI};

use d3dgen_model::Pose;
use d3dgen_model::domain::{Domain, Mount, ObjectType};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::placements::{AssetChoice, AssetSource, Placement, Unplaced};

use super::demand::Task;
use super::search::{LEVELS, Outcome};

/// Headings of the four quarter turns, rad, in (-pi, pi].
const YAW: [f64; 4] = [0.0, FRAC_PI_2, PI, -FRAC_PI_2];

/// Returns the model reference of an object: `Hospital/HospitalBed`.
pub fn asset(domain: &Domain, object: &ObjectType) -> String {
    format!("{}/{}", camel(&domain.id), camel(&object.id))
}

/// Returns the model reference of an object of a size, mm, and why it is that one, where a database has a say.
pub fn stocked(domain: &Domain, object: &ObjectType, size: [i32; 3]) -> (String, Option<AssetChoice>) {
    let same = |size_m: &[f64; 3]| size_m.iter().zip(size).all(|(m, mm)| (m * 1000.0).round() == f64::from(mm));
    if let Some(own) = object.stock.assets.iter().find(|a| same(&a.size_m)) {
        let choice = AssetChoice { source: AssetSource::Database, reason: own.reason.clone() };
        return (own.asset.clone(), Some(choice));
    }
    let made = object.stock.made_because.clone();
    (asset(domain, object), made.map(|reason| AssetChoice { source: AssetSource::Generated, reason }))
}

fn camel(id: &str) -> String {
    let capital = |word: &str| {
        let mut chars = word.chars();
        chars.next().map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
    };
    id.split('_').map(capital).collect()
}

/// Counts things of a name within one room, passing over names that are taken.
struct Names<'n> {
    room_id: &'n str,
    taken: BTreeSet<&'n str>,
    next: BTreeMap<String, u32>,
}

impl Names<'_> {
    fn name(&mut self, what: &str) -> String {
        let n = self.next.entry(what.to_owned()).or_insert(0);
        loop {
            *n += 1;
            let name = format!("{}_{what}_{n}", self.room_id);
            if !self.taken.contains(name.as_str()) {
                return name;
            }
        }
    }
}

/// Returns the placements of a furnished room, locked ones first and unchanged.
pub(crate) fn placements(
    domain: &Domain,
    room_id: &str,
    tasks: &[Task],
    outcome: &Outcome,
    locked: &[&Placement],
) -> Vec<Placement> {
    let mut out: Vec<Placement> = locked.iter().map(|p| (*p).clone()).collect();
    let taken = locked.iter().flat_map(|p| [Some(p.placement_id.as_str()), p.group.as_deref()]).flatten().collect();
    let mut names = Names { room_id, taken, next: BTreeMap::new() };
    // ids of the parts of each placed unit; locked ones come first in both lists
    let mut ids: Vec<Vec<String>> = locked.iter().map(|p| vec![p.placement_id.clone()]).collect();
    for unit in outcome.placed.iter().skip(locked.len()) {
        let own: Vec<String> = unit.unit.parts.iter().map(|p| names.name(&p.object.id)).collect();
        let group = unit.unit.group.then(|| names.name(unit.unit.item));
        let rule = tasks.get(unit.task).map_or(String::new(), |t| rule(t, outcome.level));
        for (k, part) in unit.unit.parts.iter().enumerate() {
            let solid = unit.solid(part);
            let center = solid.rect.center_m();
            let q = (unit.q + part.quarter) % 4;
            let r = solid.rect;
            let (w, d) = if q.is_multiple_of(2) { (r.height(), r.width()) } else { (r.width(), r.height()) };
            let meters = |v: i32| f64::from(v) / 1000.0;
            let on = match (part.support, unit.support) {
                (Some(k), _) => own.get(k),
                (None, Some((i, k))) => ids.get(i).and_then(|parts| parts.get(k)),
                (None, None) => None,
            };
            let (asset, asset_choice) = stocked(domain, part.object, [w, d, solid.z1 - solid.z0]);
            out.push(Placement {
                placement_id: own[k].clone(),
                room_id: room_id.to_owned(),
                object: part.object.id.clone(),
                asset,
                asset_choice,
                pose: Pose {
                    x: to_mm(center.x),
                    y: to_mm(center.y),
                    z: meters(solid.z0),
                    yaw_rad: YAW[usize::from(q)],
                },
                size_m: [meters(w), meters(d), meters(solid.z1 - solid.z0)],
                mount: match (on, part.mount) {
                    (Some(_), _) => Mount::Surface,
                    (None, Mount::Surface) => Mount::Floor,
                    (None, mount) => mount,
                },
                support: on.cloned(),
                group: group.clone(),
                rule: rule.clone(),
                locked: false,
            });
        }
        ids.push(own);
    }
    out
}

fn rule(task: &Task, level: usize) -> String {
    let tightness = LEVELS[level].tightness_of(task);
    if tightness < 1.0 {
        return format!("{}, clearances at {:.0} %", task.rule, tightness * 100.0);
    }
    task.rule.clone()
}

/// Returns what could not be placed, in the order of the furnishing lines.
pub(crate) fn unplaced(room_id: &str, tasks: &[Task], outcome: &Outcome, present: &[u32]) -> Vec<Unplaced> {
    let mut missing: Vec<_> = outcome.missing.iter().collect();
    missing.sort_by_key(|m| tasks[m.0].line);
    missing
        .into_iter()
        .map(|&(index, count, rule)| {
            let task = &tasks[index];
            let there = present[index] + task.count.saturating_sub(present[index]) - count;
            Unplaced {
                room_id: room_id.to_owned(),
                item: task.item.to_owned(),
                required: there < task.required,
                reason: format!("{there} of {} placed ({}): {}", task.count, task.rule, rule.text()),
            }
        })
        .collect()
}
