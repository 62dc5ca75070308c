//! Repair of lying units and axes: what a model is and how large it really is, decided together.
//!
//! Every way a file may be meant (as it says, with another axis up, in another unit, not to scale at all) is weighed
//! against every object its name may mean. The cheapest way wins; a way that contradicts what the file says costs, the
//! more the surer the file can know, so that files that are right stay as they are.

mod cost;

use d3dgen_model::domain::Mount;

use crate::annotation::Change;
use crate::catalog::{Catalog, CatalogObject, NameMatch};
pub use cost::{Trust, misfit};

/// What a file says about its axes and unit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Declared {
    /// Format of the content: `usdc`, `glb`, `obj`, `dae`.
    pub format: String,
    /// The axis it says is up; none where the format has no such thing.
    pub up_axis: Option<char>,
    /// Whether the file itself says so, or its format does for it.
    pub up_axis_authored: bool,
    /// Whether the file itself says its unit, or its format does for it; false where the format has none.
    pub unit_authored: bool,
    /// Factor of the unit by which most of the files beside it were repaired, 1 where they were right; none where they do not
    /// agree.
    pub unit_beside: Option<f64>,
    /// What the simulator's model around the file says.
    pub simulator: Option<Simulator>,
}

/// A Gazebo model folder around a mesh: its simulator shows meshes z up whatever they declare.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simulator {
    /// Scale that the model gives to this mesh; none when the model does not show this mesh.
    pub scale: Option<[f64; 3]>,
}

/// Which axis is taken as up, in the frame that the file's own declaration leads to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Turn {
    /// As declared.
    None,
    /// Declared y up, but z is.
    UndoYUp,
    /// Declared z up or nothing, but y is.
    YUp,
    /// Declared z up or nothing, but x is.
    XUp,
}

/// How a model is to be taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict<'c> {
    /// Axis repair.
    pub turn: Turn,
    /// Factors along the axes after the turn.
    pub scale: [f64; 3],
    /// What it most likely is, by name and size.
    pub object: Option<&'c CatalogObject>,
    /// How sure that is, 0 to 1.
    pub confidence: f64,
    /// What was changed, and why.
    pub changes: Vec<Change>,
}

/// Cost from which an object is not what the name meant.
const UNLIKE: f64 = 2.2;
/// The same for a name of which every word is explained, and for one of which some are, where the proportions are those
/// of the object.
const UNLIKE_SURE: f64 = 8.0;
const UNLIKE_PROPORTIONED: f64 = 3.4;
/// Names matched this badly say nothing about the size.
const LEAST_COVERAGE: f64 = 0.3;
/// The same for names beside the model's own: folders, parts and materials are about other things too.
const LEAST_COVERAGE_BESIDE: f64 = 0.6;
/// Objects that are weighed at most.
const MOST_OBJECTS: usize = 24;

impl Turn {
    /// Returns where the turn puts a point.
    pub fn apply(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::None => [x, y, z],
            Self::UndoYUp => [x, z, -y],
            Self::YUp => [x, -z, y],
            Self::XUp => [-z, y, x],
        }
    }

    fn shown(self) -> &'static str {
        match self {
            Self::None => "as declared",
            Self::UndoYUp => "Z",
            Self::YUp => "Y",
            Self::XUp => "X",
        }
    }
}

/// One way to take a file.
#[derive(Debug, Clone, Copy)]
struct Way {
    turn: Turn,
    /// Uniform factor.
    factor: f64,
    /// What it costs to contradict the file.
    prior: f64,
}

/// One way with the object that fits it best.
struct Weighed<'c> {
    way: Way,
    cost: f64,
    object: Option<(&'c CatalogObject, f64)>,
    to_catalog: bool,
}

/// Decides how a model is to be taken. `bounds` is its box as declared, z up and in meters; `names` are the words of its
/// file, folder and parts, the most telling first.
pub fn judge<'c>(
    bounds: [[f64; 3]; 2],
    declared: &Declared,
    names: &[Vec<String>],
    catalog: &'c Catalog,
) -> Verdict<'c> {
    let shown = declared.simulator.and_then(|s| s.scale).filter(|s| s.iter().all(|f| f.is_finite() && *f != 0.0));
    let given = shown.unwrap_or([1.0; 3]).map(f64::abs);
    let matches = matches(names, catalog);
    let trust = Trust::of(declared);
    let unit_is_told = declared.unit_authored || declared.simulator.is_some();
    let mut best: Option<Weighed<'c>> = None;
    for way in ways(declared, &trust) {
        let (low, size) = placed(bounds, way, given);
        let (fit, object) = best_object(size, &matches, way.factor != 1.0 && unit_is_told);
        let stands = object.is_some_and(|(o, _)| o.mount == Mount::Floor);
        let lying = if stands { cost::lying(low, size) } else { 0.0 };
        let odd = if way.factor == 1.0 { cost::unlike_all(size, &matches) } else { 0.0 };
        let base = way.prior + cost::origin(low[2], size[2]) + cost::bounds(size) + lying + odd;
        let weighed = Weighed { way, cost: base + fit, object, to_catalog: false };
        if best.as_ref().is_none_or(|b| weighed.cost < b.cost - 1e-9) {
            best = Some(weighed);
        }
        if let Some((factor, object)) = cost::to_catalog(size, &matches, &trust) {
            let way = Way { factor: way.factor * factor, ..way };
            let cost = base + trust.not_to_scale;
            if way.factor != 1.0 && best.as_ref().is_some_and(|b| cost < b.cost - 1e-9) {
                best = Some(Weighed { way, cost, object: Some((object, 1.0)), to_catalog: true });
            }
        }
    }
    let Some(best) = best else {
        return Verdict { turn: Turn::None, scale: given, object: None, confidence: 0.0, changes: Vec::new() };
    };
    let scale = given.map(|g| g * best.way.factor);
    let changes = changes(bounds, declared, given, &best);
    let (object, confidence) = best.object.map_or((None, 0.0), |(o, c)| (Some(o), c));
    Verdict { turn: best.way.turn, scale, object, confidence, changes }
}

/// Returns the objects that the names may mean; the first name that means any decides, the others help it.
fn matches<'c>(names: &[Vec<String>], catalog: &'c Catalog) -> Vec<NameMatch<'c>> {
    for (place, name) in names.iter().enumerate() {
        let least = if place == 0 { LEAST_COVERAGE } else { LEAST_COVERAGE_BESIDE };
        let mut found = catalog.match_name(name);
        found.retain(|m| m.coverage >= least);
        found.truncate(MOST_OBJECTS);
        if !found.is_empty() {
            return found;
        }
    }
    Vec::new()
}

fn ways(declared: &Declared, trust: &Trust) -> Vec<Way> {
    let turns: &[(Turn, f64)] = match declared.up_axis {
        Some('Y') => &[(Turn::None, trust.declared_axis), (Turn::UndoYUp, trust.other_axis)],
        Some(_) => &[(Turn::None, trust.declared_axis), (Turn::YUp, trust.other_axis)],
        None => &[(Turn::None, 0.0), (Turn::YUp, trust.other_axis), (Turn::XUp, trust.other_axis + 0.6)],
    };
    let mut ways = Vec::new();
    for &(turn, axis_prior) in turns {
        for (factor, rarity) in cost::UNITS {
            let alone = if *factor == 1.0 { 0.0 } else { trust.other_unit + rarity };
            let unit_prior = match declared.unit_beside {
                Some(unit) if (factor / unit - 1.0).abs() < 0.01 => 0.0,
                Some(_) => alone + cost::UNLIKE_NEIGHBORS,
                None => alone,
            };
            ways.push(Way { turn, factor: *factor, prior: axis_prior + unit_prior });
        }
    }
    ways
}

/// Returns least corner and size of the box, taken one way.
fn placed([min, max]: [[f64; 3]; 2], way: Way, given: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let (a, b) = (way.turn.apply(min), way.turn.apply(max));
    let factor = |i: usize| way.factor * given[i];
    let low = std::array::from_fn(|i| a[i].min(b[i]) * factor(i));
    (low, std::array::from_fn(|i| (a[i] - b[i]).abs() * factor(i)))
}

/// Returns what the best of the objects costs, and that object. Where the unit that the file tells is contradicted, a name
/// counts only with the proportions of what it means: a steel washer is no washing machine in another unit.
fn best_object<'c>(
    size: [f64; 3],
    matches: &[NameMatch<'c>],
    contradicts_unit: bool,
) -> (f64, Option<(&'c CatalogObject, f64)>) {
    let mut best: Option<(f64, f64, &NameMatch<'c>)> = None;
    for m in matches {
        let off = m.object.sizes_m.iter().map(|s| misfit(size, *s)).fold(f64::INFINITY, f64::min);
        let proportioned = m.object.sizes_m.iter().any(|s| cost::is_proportioned(size, *s));
        // A name that explains half of the words is half as sure: it may be the other half that counts.
        let cap = match (m.coverage > 0.99, proportioned) {
            (true, _) => UNLIKE_SURE,
            (false, true) => UNLIKE_PROPORTIONED,
            (false, false) => UNLIKE,
        };
        let fits = !contradicts_unit || proportioned;
        let cost = if fits { (cost::of_misfit(off) + cost::of_name(m.coverage)).min(cap) } else { cap };
        let order = cost + 0.02 * off;
        if best.is_none_or(|(_, b, _)| order < b - 1e-12) {
            best = Some((cost, order, m));
        }
    }
    match best {
        Some((cost, _, m)) => {
            let sure = m.coverage * (1.0 - (cost / UNLIKE).min(1.0) * 0.7);
            (cost, (cost < UNLIKE).then_some((m.object, sure)))
        }
        None => (0.0, None),
    }
}

fn changes(bounds: [[f64; 3]; 2], declared: &Declared, given: [f64; 3], best: &Weighed<'_>) -> Vec<Change> {
    let mut changes = Vec::new();
    let is =
        |what: &str| best.object.map_or(String::new(), |(o, _)| format!(" as a {} {what}", o.label.to_lowercase()));
    if best.way.turn != Turn::None {
        let why = if declared.simulator.is_some() {
            "the simulator's model around it shows it z up, whatever the file says".to_owned()
        } else {
            format!("it then stands on its base{}", is("does"))
        };
        let from = declared.up_axis.map_or("none".to_owned(), |a| a.to_string());
        changes.push(Change { what: "up_axis".into(), from, to: best.way.turn.shown().into(), why });
    }
    if given.iter().any(|g| (g - 1.0).abs() > 1e-9) {
        let to =
            if given[0] == given[1] && given[1] == given[2] { format!("{}", given[0]) } else { format!("{given:?}") };
        let why = "the simulator's model around it scales this mesh".to_owned();
        changes.push(Change { what: "scale".into(), from: "1".into(), to, why });
    }
    if (best.way.factor - 1.0).abs() > 1e-9 {
        let declared_size = placed(bounds, Way { factor: 1.0, ..best.way }, given).1;
        let size = placed(bounds, best.way, given).1;
        let largest = |s: [f64; 3]| s.iter().copied().fold(0.0, f64::max);
        let reason = if best.to_catalog { "it is not to scale" } else { "its unit is another" };
        let why =
            format!("{reason}: {:.4} m across becomes {:.3} m,{}", largest(declared_size), largest(size), is("is"));
        let to = format!("{:.6}", best.way.factor).trim_end_matches('0').trim_end_matches('.').to_owned();
        changes.push(Change { what: "unit".into(), from: "1".into(), to, why: why.trim_end_matches(',').to_owned() });
    }
    changes
}

#[cfg(test)]
mod tests;
