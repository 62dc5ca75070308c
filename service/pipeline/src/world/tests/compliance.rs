//! Constraints of the shipped knowledge bases on built worlds: kept by one figure, broken by another, always with source.

use std::collections::BTreeSet;

use d3dgen_knowledge::{Measure, Query, Retrieval, compliance, retrieve};
use d3dgen_model::report::Status;

use super::{REGISTRY, SAMPLES, Sample};

/// Returns the retrieval with every required figure replaced by one least figure.
fn with_least(retrieval: &Retrieval, least: f64) -> Retrieval {
    let mut retrieval = retrieval.clone();
    for rule in retrieval.constraints.iter_mut().filter_map(|a| a.decision.as_mut().ok()) {
        (rule.bounds.min, rule.bounds.max) = (Some(least), None);
    }
    retrieval
}

/// Returns what applies to a world wherever its knowledge base has rules and access is asked for.
fn everywhere(sample: &Sample) -> Vec<Retrieval> {
    let graph = &sample.world.scene_graph;
    let knowledge = REGISTRY.get(&graph.domain).unwrap().knowledge();
    let places: BTreeSet<&str> = knowledge.references.iter().map(|r| r.jurisdiction.as_str()).collect();
    let query = |place: &&str| Query {
        country_code: Some((*place).to_owned()),
        accessible: true,
        ..Query::of_graph(graph, sample.domain)
    };
    places.iter().map(|place| retrieve(knowledge, &query(place))).collect()
}

/// Returns the measures of what was found with this status, all results being complete.
fn measures(sample: &Sample, retrieval: &Retrieval, status: Status) -> BTreeSet<Measure> {
    let (results, summary) = compliance::evaluate(&sample.world, sample.domain, retrieval);
    let decided = results.iter().filter(|r| r.status != Status::NotDecidable);
    let ids: BTreeSet<&str> = decided.clone().map(|r| r.constraint_id.as_str()).collect();
    assert_eq!(ids.len(), (summary.satisfied + summary.violated) as usize, "{}", sample.world.name);
    for r in decided.clone() {
        assert!(r.measured.is_some() && r.required_min.or(r.required_max).is_some(), "{}", r.constraint_id);
        assert!(!r.unit.is_empty() && !r.subject.is_empty(), "{}", r.constraint_id);
        assert!(!r.citation.source.title.is_empty() && !r.citation.jurisdiction.is_empty(), "{}", r.constraint_id);
    }
    let with: BTreeSet<&str> = decided.filter(|r| r.status == status).map(|r| r.constraint_id.as_str()).collect();
    let about = retrieval.constraints.iter().filter(|a| with.contains(a.constraint.constraint_id.as_str()));
    about.filter_map(|a| Some(a.decision.as_ref().ok()?.quantity.measure)).collect()
}

#[test]
fn every_measure_at_hand_is_kept_by_one_figure_and_broken_by_another() {
    let (mut kept, mut broken) = (BTreeSet::new(), BTreeSet::new());
    let mut asked = BTreeSet::new();
    for sample in SAMPLES.iter() {
        for retrieval in everywhere(sample) {
            asked.extend(retrieval.constraints.iter().filter_map(|a| Some(a.decision.as_ref().ok()?.quantity.measure)));
            kept.extend(measures(sample, &with_least(&retrieval, -1e9), Status::Satisfied));
            broken.extend(measures(sample, &with_least(&retrieval, 1e9), Status::Violated));
        }
    }
    // whether a room is needed goes by the head count: the figure is one room, whatever the constraint says
    kept.remove(&Measure::RoomNeededAbovePersons);
    broken.remove(&Measure::RoomNeededAbovePersons);
    assert_eq!(kept, broken);
    asked.remove(&Measure::RoomNeededAbovePersons);
    assert_eq!(asked.difference(&kept).collect::<Vec<_>>(), [&Measure::RoomArea; 0], "measured in no world");
    assert!(kept.len() >= 30, "{} measures: {kept:?}", kept.len());
}

#[test]
fn a_shipped_figure_that_a_changed_world_breaks_is_reported_at_its_subject() {
    let sample = &SAMPLES[1];
    let mut world = sample.world.clone();
    let entry = world.floorplan.doors.iter_mut().find(|d| d.room_ids.len() == 2 && d.swing.is_some()).unwrap();
    entry.clear_width_m = 0.3;
    let id = entry.door_id.clone();
    let at_door = |world| {
        let (results, _) = compliance::evaluate(world, sample.domain, &sample.retrieval);
        results.into_iter().filter(|r| r.subject == id && r.status == Status::Violated).collect::<Vec<_>>()
    };
    let (before, after) = (at_door(&sample.world), at_door(&world));
    assert!(after.len() > before.len());
    assert!(after.iter().any(|r| r.measured == Some(0.3) && r.required_min.is_some_and(|m| m > 0.3)));
}
