//! Constraint compliance by source: what the world's own report says of each rule it knows, added up by document.
//!
//! Shares are of constraints that could be decided; those that could not are counted beside them.

use std::collections::BTreeMap;

use d3dgen_model::report::{Report, Status};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::share;

/// Counts of constraint results.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tally {
    /// They hold.
    pub satisfied: u32,
    /// They do not.
    pub violated: u32,
    /// Geometry and objects cannot tell.
    pub not_decidable: u32,
}

impl Tally {
    fn count(&mut self, status: Status) {
        match status {
            Status::Satisfied => self.satisfied += 1,
            Status::Violated => self.violated += 1,
            Status::NotDecidable => self.not_decidable += 1,
            Status::NotApplicable => {}
        }
    }

    fn add(&mut self, other: &Self) {
        self.satisfied += other.satisfied;
        self.violated += other.violated;
        self.not_decidable += other.not_decidable;
    }

    /// Returns the share of decided constraints that hold; `None` when none was decided.
    pub fn satisfied_share(&self) -> Option<f64> {
        let decided = self.satisfied + self.violated;
        (decided > 0).then(|| share(self.satisfied as usize, decided as usize))
    }
}

/// Constraints of one world.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Compliance {
    /// Of regulations and standards.
    pub mandatory: Tally,
    /// Of recommendations.
    pub advice: Tally,
    /// By source, for the table of all worlds.
    #[serde(skip)]
    pub sources: Vec<SourceTally>,
}

/// How the constraints of a source fared.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SourceTally {
    /// Where the source applies.
    pub jurisdiction: String,
    /// Title of the document.
    pub title: String,
    /// Who published it.
    pub publisher: String,
    /// True for constraints that are law or standard, false for advice; a document can have both.
    pub mandatory: bool,
    /// Worlds with a decided constraint of it.
    pub worlds: u32,
    /// Results.
    pub tally: Tally,
    /// Names of the violated constraints and how often, most often first.
    pub violated: Vec<(String, u32)>,
}

/// Advice, jurisdiction, title, publisher: law comes first.
type Key<'a> = (bool, &'a str, &'a str, &'a str);
/// Results of a source, and how often each constraint of it is violated.
type Found<'a> = (Tally, BTreeMap<&'a str, u32>);

/// Measures a report.
pub(crate) fn measure(report: &Report) -> Compliance {
    let mut out = Compliance::default();
    let mut sources: BTreeMap<Key, Found> = BTreeMap::new();
    for c in report.constraints.iter().filter(|c| c.status != Status::NotApplicable) {
        if c.mandatory { &mut out.mandatory } else { &mut out.advice }.count(c.status);
        let source = &c.citation.source;
        let key = (!c.mandatory, c.citation.jurisdiction.as_str(), source.title.as_str(), source.publisher.as_str());
        let (tally, violated) = sources.entry(key).or_default();
        tally.count(c.status);
        if c.status == Status::Violated {
            *violated.entry(&c.name).or_default() += 1;
        }
    }
    let entry = |(key, (tally, violated)): (Key, Found)| SourceTally {
        jurisdiction: key.1.to_owned(),
        title: key.2.to_owned(),
        publisher: key.3.to_owned(),
        mandatory: !key.0,
        worlds: u32::from(tally.satisfied + tally.violated > 0),
        tally,
        violated: violated.into_iter().map(|(name, n)| (name.to_owned(), n)).collect(),
    };
    out.sources = sources.into_iter().map(entry).collect();
    out
}

/// Adds up the sources of many worlds: law before advice, then by jurisdiction and title.
pub(crate) fn together<'a>(worlds: impl Iterator<Item = &'a Compliance>) -> Vec<SourceTally> {
    type Key<'a> = (bool, &'a str, &'a str, &'a str);
    let mut all: BTreeMap<Key<'_>, (u32, Tally, BTreeMap<&str, u32>)> = BTreeMap::new();
    for source in worlds.flat_map(|c| &c.sources) {
        let key = (!source.mandatory, source.jurisdiction.as_str(), source.title.as_str(), source.publisher.as_str());
        let (count, tally, violated) = all.entry(key).or_default();
        *count += source.worlds;
        tally.add(&source.tally);
        source.violated.iter().for_each(|(name, n)| *violated.entry(name).or_default() += n);
    }
    let entry = |(key, (worlds, tally, violated)): (Key<'_>, (u32, Tally, BTreeMap<&str, u32>))| {
        let mut violated: Vec<(String, u32)> = violated.into_iter().map(|(name, n)| (name.to_owned(), n)).collect();
        violated.sort_by_key(|(_, n)| std::cmp::Reverse(*n)); // stable: ties stay by name
        SourceTally {
            jurisdiction: key.1.to_owned(),
            title: key.2.to_owned(),
            publisher: key.3.to_owned(),
            mandatory: !key.0,
            worlds,
            tally,
            violated,
        }
    };
    all.into_iter().map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn results_are_counted_by_force_and_source() {
        let report = sample::report(&[
            ("door_width", "Code A", true, Status::Satisfied),
            ("door_width", "Code A", true, Status::Satisfied),
            ("room_area", "Code A", true, Status::Violated),
            ("room_area", "Guide B", false, Status::NotDecidable),
            ("robot_dock", "Guide B", false, Status::NotApplicable),
        ]);
        let found = measure(&report);
        assert_eq!(found.mandatory, Tally { satisfied: 2, violated: 1, not_decidable: 0 });
        assert_eq!(found.advice, Tally { satisfied: 0, violated: 0, not_decidable: 1 });
        assert_eq!(found.mandatory.satisfied_share(), Some(0.666667));
        assert_eq!(found.advice.satisfied_share(), None);
        let all = together([found.clone(), found].iter());
        assert_eq!(
            all.iter().map(|s| (s.title.as_str(), s.worlds)).collect::<Vec<_>>(),
            [("Code A", 2), ("Guide B", 0)]
        );
        assert_eq!(all[0].violated, [("room_area".to_owned(), 2)]);
        assert_eq!(all[0].tally, Tally { satisfied: 4, violated: 2, not_decidable: 0 });
    }
}
