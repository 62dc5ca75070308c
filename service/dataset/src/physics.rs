//! Measures that a physics engine takes of a world, in programs that are built with one.

use std::collections::BTreeMap;

use d3dgen_export::Subject;

use crate::error::Error;

/// Share of the movable things that stay where they were put for four seconds.
pub const AT_REST: &str = "at_rest";
/// Deepest overlap of two things at the start, m.
pub const START_OVERLAP_M: &str = "start_overlap_m";
/// All of them.
pub const MEASURES: &[&str] = &[AT_REST, START_OVERLAP_M];

/// True in a program that can take them: one with the feature `physics`.
pub const HERE: bool = cfg!(feature = "physics");

/// Returns these measures of a world; none where none is wanted.
///
/// # Errors
/// `Export` when the world is no scene for simulators.
#[cfg(feature = "physics")]
pub fn measured(subject: &Subject<'_>, wanted: &[&str]) -> Result<BTreeMap<String, f64>, Error> {
    if wanted.is_empty() {
        return Ok(BTreeMap::new());
    }
    let settled = d3dgen_physics::settle(subject.scene()?);
    let rounded = |value: f64| (value * 1e4).round() / 1e4;
    let all = [(AT_REST, settled.share_at_rest()), (START_OVERLAP_M, settled.deepest_m())];
    Ok(all.into_iter().filter(|(name, _)| wanted.contains(name)).map(|(n, v)| (n.to_owned(), rounded(v))).collect())
}

/// Returns no measure: a spec that wants one was refused.
///
/// # Errors
/// None.
#[cfg(not(feature = "physics"))]
pub fn measured(_: &Subject<'_>, _: &[&str]) -> Result<BTreeMap<String, f64>, Error> {
    Ok(BTreeMap::new())
}

#[cfg(feature = "physics")]
#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use d3dgen_export::models::NothingKept;
    use d3dgen_plugins::Registry;

    use super::*;
    use crate::maker::{Maker, Outcome};
    use crate::row::Why;
    use crate::snapshot::Snapshot;
    use crate::spec::Spec;
    use crate::tasks::Tasks;

    fn outcome(more: &str) -> Outcome {
        let text =
            format!("name = \"stands\"\nseeds = 1\nfirst_seed = 4\n{more}\n[[prompts]]\ntext = \"studio flat\"\n");
        let spec = Spec::from_toml(&text, "spec.toml").unwrap();
        let snapshot = Snapshot::take(&Registry::builtin()).unwrap();
        let maker = Maker::new(&spec, &snapshot, &NothingKept).unwrap();
        let tasks = Tasks::of(&spec).unwrap();
        maker.bench().make(&tasks.get(0).unwrap(), &AtomicBool::new(false)).unwrap()
    }

    #[test]
    fn worlds_are_stepped_for_the_measures_and_filters_that_name_them() {
        let Outcome::World(made) = outcome("measures = [\"at_rest\"]") else { panic!("a studio flat stands") };
        assert_eq!(made.row.figures.get(AT_REST), Some(&1.0));
        assert!(!made.row.figures.contains_key(START_OVERLAP_M), "it was not asked for");
        let Outcome::World(made) = outcome("measures = [\"all\"]") else { panic!("a studio flat stands") };
        assert!(!made.row.figures.contains_key(AT_REST), "stepping takes its time: only by name");
        let Outcome::Nothing(failure) = outcome("[[filters]]\nmeasure = \"at_rest\"\nmin = 1.1") else {
            panic!("no world has more than all of its things at rest")
        };
        assert_eq!((failure.why, failure.reason.as_str()), (Why::Filtered, "at_rest is 1, less than 1.1"));
    }
}
