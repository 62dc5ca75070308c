//! From the measures of single worlds to the document of all.

use std::collections::BTreeMap;

use crate::evaluation::{BrokenFile, Evaluation, Group, WorldMeasures};
use crate::figures::means;
use crate::metrics::{compliance, distance, diversity};

/// Puts the measures together; `reference` is another set of worlds to compare layouts with, and may be empty.
pub fn evaluation(mut worlds: Vec<WorldMeasures>, reference: &[WorldMeasures], broken: Vec<BrokenFile>) -> Evaluation {
    worlds.sort_by(|a, b| a.path.cmp(&b.path));
    let mut groups: BTreeMap<(&str, u32), Vec<&WorldMeasures>> = BTreeMap::new();
    for world in &worlds {
        groups.entry((&world.domain, world.fidelity.rooms_asked)).or_default().push(world);
    }
    let group = |domain: &str, rooms, set: &[&WorldMeasures]| Group {
        domain: domain.to_owned(),
        rooms,
        worlds: set.len() as u32,
        figures: means(set.iter().copied()),
    };
    let mut groups: Vec<Group> = groups.iter().map(|((d, rooms), set)| group(d, Some(*rooms), set)).collect();
    if !worlds.is_empty() {
        groups.push(group("all", None, &worlds.iter().collect::<Vec<_>>()));
    }
    Evaluation {
        version: 1,
        groups,
        sources: compliance::together(worlds.iter().filter_map(|w| w.compliance.as_ref())),
        prompts: diversity::together(&worlds),
        distances: distance::together(&worlds, reference),
        worlds,
        broken,
    }
}

#[cfg(test)]
mod tests {
    use d3dgen_model::Document;
    use d3dgen_model::report::Status;

    use super::*;
    use crate::measure::measure;
    use crate::sample;

    #[test]
    fn an_evaluation_is_a_document() {
        let report = sample::report(&[("door_width", "Code A", true, Status::Satisfied)]);
        let of = |path: &str| measure(&sample::world(), Some(&report), path, &Default::default());
        let broken = vec![BrokenFile { path: "c/world.json".into(), message: "is not JSON".into() }];
        let found = evaluation(vec![of("b"), of("a")], &[], broken);
        let rows: Vec<_> = found.groups.iter().map(|g| (g.domain.as_str(), g.rooms, g.worlds)).collect();
        assert_eq!(rows, [("general", Some(2), 2), ("all", None, 2)]);
        assert_eq!((found.sources.len(), found.prompts[0].plans), (1, 0.5));
        let mut read = Evaluation::from_json(&found.to_json()).expect("it fits its own schema");
        for (read, made) in read.worlds.iter_mut().zip(&found.worlds) {
            read.compliance.clone_from(&made.compliance); // sources stand in the table of all worlds only
        }
        assert_eq!(read, found);
        read.worlds.reverse();
        assert_eq!(read.check()[0].path, "/worlds/1/path");
    }
}
