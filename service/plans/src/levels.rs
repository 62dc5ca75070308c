//! The storeys of a drawing: which there are, how they are numbered, and each as a drawing of its own.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::scene_graph::Note;

use crate::drawing::{Drawing, note};
use crate::error::Error;
use crate::words::{self, StoreyWord, storey_word};

/// Floors closer than this to one another are no storeys, m.
const LOWEST_STOREY_M: f64 = 1.8;
/// Most storeys that one range (`0-12`) names.
const MOST_IN_RANGE: i32 = 200;

/// A storey with what is drawn on it.
pub(crate) struct Storey {
    pub level: LaidLevel,
    pub drawing: Drawing,
}

/// A storey of a laid-out plan.
#[derive(Debug, Clone, PartialEq)]
pub struct LaidLevel {
    /// What the file calls it.
    pub name: String,
    /// Its number: 0 at the ground, 1 above it, -1 below it.
    pub number: i32,
    /// Height of its floor, m, where the file states it for all storeys.
    pub elevation_m: Option<f64>,
}

/// Returns the storeys that a thing is on: `0;1` and `0-2` are several, as in OpenStreetMap.
fn on(level: &str) -> Vec<String> {
    let range = |part: &str| {
        let (from, to) = part.split_once('-').filter(|(from, _)| !from.is_empty())?;
        let (from, to): (i32, i32) = (from.trim().parse().ok()?, to.trim().parse().ok()?);
        (from < to && to - from < MOST_IN_RANGE).then(|| (from..=to).map(|n| n.to_string()).collect::<Vec<_>>())
    };
    level.split(';').map(str::trim).flat_map(|part| range(part).unwrap_or_else(|| vec![part.to_owned()])).collect()
}

/// Returns the storeys that have rooms, walls or floors, in the order of the file; things on several name none.
fn names(drawing: &Drawing) -> Vec<String> {
    let all = drawing.rooms.iter().map(|r| &r.level).chain(drawing.walls.iter().map(|w| &w.level));
    let all = all.chain(drawing.floors.iter().map(|f| &f.level));
    let mut out: Vec<String> = Vec::new();
    for name in all.flatten().map(|level| on(level)).filter(|names| names.len() == 1).flatten() {
        if !out.contains(&name) {
            out.push(name);
        }
    }
    out
}

/// Keeps what is on one storey, and what is on none.
///
/// # Errors
/// `Refused` with the storeys there are.
pub(crate) fn keep(drawing: &mut Drawing, wanted: &str) -> Result<(), Error> {
    let names = names(drawing);
    let chosen = names.iter().find(|l| l.eq_ignore_ascii_case(wanted.trim())).ok_or_else(|| {
        let there = if names.is_empty() { "names no levels".to_owned() } else { format!("has {}", names.join(", ")) };
        Error::refused("--level", format!("`{wanted}` is not there; the plan {there}"))
    })?;
    retain(drawing, |level| level.as_ref().is_none_or(|l| on(l).contains(chosen)));
    Ok(())
}

fn retain(drawing: &mut Drawing, here: impl Fn(&Option<String>) -> bool) {
    drawing.rooms.retain(|r| here(&r.level));
    drawing.walls.retain(|w| here(&w.level));
    drawing.openings.retain(|o| here(&o.level));
    drawing.labels.retain(|l| here(&l.level));
    drawing.floors.retain(|f| here(&f.level));
    drawing.cabins.retain(|c| here(&c.level));
    drawing.solids.retain(|s| here(&s.level));
    drawing.unclear.retain(|s| here(&s.room.level));
}

/// Parts a drawing into its storeys, from the lowest to the highest; what is on none is on the ground floor. A drawing of one
/// storey stays whole.
pub(crate) fn split(drawing: Drawing) -> Vec<Storey> {
    let names = names(&drawing);
    if names.len() < 2 {
        return vec![whole(drawing)];
    }
    let levels = numbered(&names, &drawing.elevations_m);
    let storey = |level: LaidLevel| {
        let mut own = drawing.clone();
        retain(&mut own, |l| l.as_ref().map_or(level.number == 0, |l| on(l).contains(&level.name)));
        Storey { level, drawing: own }
    };
    levels.into_iter().map(storey).collect()
}

/// Returns all of a drawing as one storey.
pub(crate) fn whole(drawing: Drawing) -> Storey {
    Storey { level: LaidLevel { name: String::new(), number: 0, elevation_m: None }, drawing }
}

/// Says how storeys are numbered, and how to read one alone.
pub(crate) fn tell(levels: &[LaidLevel]) -> Option<Note> {
    let list: Vec<String> = levels.iter().map(|l| format!("`{}` is {}", l.name, l.number)).collect();
    let last = levels.last().filter(|_| levels.len() > 1)?;
    let message = format!(
        "the plan has {} levels: {}; a run with `--level \"{}\"` reads that one alone",
        levels.len(),
        list.join(", "),
        last.name
    );
    Some(note("levels", message))
}

/// Numbers storeys by their elevations, by what their names say, or in the order of the file; returns them from the lowest.
fn numbered(names: &[String], elevations_m: &BTreeMap<String, f64>) -> Vec<LaidLevel> {
    let level = |(name, number): (&String, i32)| LaidLevel { name: name.clone(), number, elevation_m: None };
    let mut levels = by_elevation(names, elevations_m).unwrap_or_else(|| match by_name(names) {
        Some(numbers) => names.iter().zip(numbers).map(level).collect(),
        None => names.iter().zip(0..).map(level).collect(),
    });
    levels.sort_by_key(|l| l.number);
    levels
}

fn by_elevation(names: &[String], elevations_m: &BTreeMap<String, f64>) -> Option<Vec<LaidLevel>> {
    let known = names.iter().map(|n| Some((n, *elevations_m.get(n).filter(|e| e.is_finite())?)));
    let mut list: Vec<(&String, f64)> = known.collect::<Option<_>>()?;
    list.sort_by(|a, b| a.1.total_cmp(&b.1));
    if list.windows(2).any(|p| p[1].1 - p[0].1 < LOWEST_STOREY_M) {
        return None;
    }
    let ground = list.iter().position(|l| l.1 > -LOWEST_STOREY_M / 2.0).unwrap_or(list.len() - 1);
    let level = |(i, (name, elevation)): (usize, &(&String, f64))| LaidLevel {
        name: (*name).clone(),
        number: i as i32 - ground as i32,
        elevation_m: Some(elevation - list[ground].1),
    };
    Some(list.iter().enumerate().map(level).collect())
}

/// What the name of a storey says of its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Said {
    Number(i32),
    Top,
}

fn by_name(names: &[String]) -> Option<Vec<i32>> {
    let said: Vec<Said> = names.iter().map(|n| said(n)).collect::<Option<_>>()?;
    let numbers = || said.iter().filter_map(|s| if let Said::Number(n) = s { Some(*n) } else { None });
    let highest = numbers().max().unwrap_or(0);
    // where no name says which storey is the ground floor, it is the first one
    let first = if numbers().any(|n| n == 0) { 0 } else { numbers().filter(|n| *n > 0).min().unwrap_or(0) };
    let number = |s: &Said| match *s {
        Said::Number(n) if n > 0 => n - first,
        Said::Number(n) => n,
        Said::Top => highest + 1 - first,
    };
    let out: Vec<i32> = said.iter().map(number).collect();
    let different: BTreeSet<i32> = out.iter().copied().collect();
    (different.len() == out.len() && different.contains(&0)).then_some(out)
}

fn said(name: &str) -> Option<Said> {
    if let Ok(number) = name.trim().parse::<i32>() {
        return Some(Said::Number(number));
    }
    let words = words::parts(name);
    let mut figures = words.iter().filter_map(|w| w.parse::<i32>().ok());
    let number = figures.next();
    if figures.next().is_some() || number.is_some_and(|n| n.abs() > MOST_IN_RANGE) {
        return None;
    }
    match words.iter().find_map(|w| storey_word(w)) {
        Some(StoreyWord::Below) => Some(Said::Number(-number.unwrap_or(1))),
        Some(StoreyWord::Ground) => Some(Said::Number(0)),
        Some(StoreyWord::Above) => Some(Said::Number(number.unwrap_or(1))),
        Some(StoreyWord::Top) => Some(Said::Top),
        None => number.map(Said::Number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(names: &[&str], elevations: &[f64]) -> Vec<(String, i32)> {
        let names: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
        let elevations = names.iter().cloned().zip(elevations.iter().copied()).collect();
        numbered(&names, &elevations).into_iter().map(|l| (l.name, l.number)).collect()
    }

    #[test]
    fn storeys_are_numbered_by_elevation_names_or_order() {
        for (names, elevations, expected) in [
            (&["L1", "L2", "B1"][..], &[0.0, 3.0, -3.0][..], &[("B1", -1), ("L1", 0), ("L2", 1)][..]),
            (&["L2", "L1"], &[], &[("L1", 0), ("L2", 1)]),
            (&["1", "0", "-1"], &[], &[("-1", -1), ("0", 0), ("1", 1)]),
            (&["EG", "1. OG", "UG", "DG"], &[], &[("UG", -1), ("EG", 0), ("1. OG", 1), ("DG", 2)]),
            (&["Ground floor", "Floor 1"], &[], &[("Ground floor", 0), ("Floor 1", 1)]),
            (&["west", "east"], &[], &[("west", 0), ("east", 1)]),
            // floors that do not rise say nothing
            (&["L2", "L1"], &[0.0, 0.0], &[("L1", 0), ("L2", 1)]),
        ] {
            let found = numbers(names, elevations);
            let found: Vec<(&str, i32)> = found.iter().map(|(n, k)| (n.as_str(), *k)).collect();
            assert_eq!(found, expected, "{names:?}");
        }
        assert_eq!(on("0;2"), ["0", "2"]);
        assert_eq!(on("0-2"), ["0", "1", "2"]);
        assert_eq!(on("-1"), ["-1"]);
        assert_eq!(on("B-1"), ["B-1"]);
    }
}
