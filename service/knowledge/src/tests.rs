//! What the shipped knowledge bases come to for buildings of several countries.

use d3dgen_model::document::Document;
use d3dgen_model::domain::{Daylight, Zone};
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_plugins::Registry;

use crate::*;

pub(crate) fn knowledge(domain: &str) -> KnowledgeBase {
    let registry = Registry::builtin();
    registry.get(domain).expect("every domain has a knowledge base").knowledge().clone()
}

fn room(room_type: &str, spaces: &[&str], beds: bool) -> QueryRoom {
    QueryRoom {
        room_type: room_type.into(),
        spaces: spaces.iter().map(|s| (*s).to_owned()).collect(),
        count: 1,
        circulation: matches!(room_type, "corridor" | "hallway"),
        zone: Zone::Day,
        daylight: Daylight::Required,
        beds,
        area_max_m2: 60.0,
    }
}

fn query(domain: &str, country: Option<&str>) -> Query {
    let rooms = match domain {
        "residential" => vec![
            room("bedroom", &[], false),
            room("living_room", &[], false),
            room("kitchen", &[], false),
            room("bathroom", &[], false),
            room("hallway", &[], false),
        ],
        "hospital" => vec![
            room("patient_room", &["patient_room_single"], true),
            room("nurse_station", &[], false),
            room("corridor", &["corridor", "ward"], false),
        ],
        _ => vec![room("open_office", &[], false), room("meeting_room", &[], false), room("corridor", &[], false)],
    };
    Query {
        country_code: country.map(str::to_owned),
        domain: domain.into(),
        building_type: None,
        accessible: false,
        wheelchair: false,
        rooms,
        persons: 18,
        persons_stated: false,
        robots: Vec::new(),
    }
}

#[test]
fn limits_are_the_figures_of_the_nearest_rules() {
    let limits = |domain, country| retrieve(&knowledge(domain), &query(domain, country)).limits;
    let value = |l: &Option<Limit>| l.as_ref().map(|l| l.value);
    let room = |l: &Limits, id: &str| l.rooms.get(id).cloned().unwrap_or_default();

    let us = limits("residential", Some("US"));
    assert_eq!(value(&room(&us, "bedroom").area_min), Some(6.5));
    assert_eq!(value(&room(&us, "bedroom").dimension_min), Some(2.134));
    assert_eq!(value(&room(&us, "kitchen").dimension_min), None, "kitchens are exempt");
    assert_eq!(value(&us.corridor_width), Some(0.914));

    let us = limits("hospital", Some("US"));
    assert_eq!(value(&us.corridor_width), Some(2.438));
    assert_eq!(value(&room(&us, "patient_room").area_min), Some(11.15));
    let de = limits("hospital", Some("DE"));
    assert_eq!(value(&de.corridor_width), Some(2.25));
    assert_eq!(value(&room(&de, "patient_room").door_width), Some(1.25));

    let de = limits("office", Some("DE"));
    assert_eq!(value(&de.corridor_width), Some(1.0), "ASR A1.8 for up to 20 people");
    assert_eq!(value(&room(&de, "open_office").door_width), Some(0.9));
    let int = limits("office", None);
    assert_eq!(value(&int.corridor_width), Some(1.2), "ISO 21542");
}

#[test]
fn documents_about_accessible_homes_hold_only_where_access_is_asked_for() {
    let count = |accessible| {
        let query = Query { accessible, ..query("residential", Some("US")) };
        let found = retrieve(&knowledge("residential"), &query).constraints;
        found.iter().filter(|a| a.citation.source.title.contains("ADA Standards")).count()
    };
    assert_eq!(count(false), 0);
    assert!(count(true) > 0);
}

#[test]
fn more_people_need_wider_corridors() {
    let width = |persons| {
        let query = Query { persons, persons_stated: true, ..query("office", Some("DE")) };
        retrieve(&knowledge("office"), &query).limits.corridor_width.map(|l| l.value)
    };
    assert_eq!(width(18), Some(1.0));
    assert!(width(150) > width(18), "{:?}", width(150));
}

#[test]
fn ceilings_by_area_hold_within_their_steps_only() {
    let limits = retrieve(&knowledge("office"), &query("office", Some("DE"))).limits;
    let room = &limits.rooms["open_office"];
    assert!(!room.ceiling_heights_by_area.is_empty());
    for step in &room.ceiling_heights_by_area {
        let inside = step.up_to_m2.min(step.above_m2.max(0.0) + 1.0);
        assert!(room.ceiling_height(inside).is_some_and(|h| h >= step.limit.value), "{step:?}");
    }
}

#[test]
fn advised_areas_lie_between_the_least_figure_and_what_the_room_may_have() {
    let mut seen = 0;
    for (domain, country) in [("residential", "US"), ("hospital", "DE"), ("hospital", "US"), ("office", "DE")] {
        for (room_type, room) in retrieve(&knowledge(domain), &query(domain, Some(country))).limits.rooms {
            let Some([low, high]) = room.area_advised else { continue };
            assert!(0.0 <= low && low <= high && high <= 60.0, "{domain} {country} {room_type}: {low} to {high} m2");
            assert!(room.area_min.is_none_or(|l| l.value <= low), "{domain} {country} {room_type}");
            seen += 1;
        }
    }
    assert!(seen > 0);
}

/// A knowledge base of two sources and a rule of the owner on the width of corridors.
fn corridors() -> KnowledgeBase {
    let reference = |ref_id: &str, place: &str, kind: &str, year: &str, width: f64| {
        serde_json::json!({
            "ref_id": ref_id, "building_type": "office", "jurisdiction": place, "retrieved_at": "2026-11-21",
            "sources": [{"source_id": "s", "title": ref_id, "publisher": "P", "edition_or_year": year, "type": kind}],
            "constraints": [{
                "constraint_id": format!("{ref_id}_width"), "name": "corridor_clear_width",
                "topic": "fire_safety_evacuation", "constraint_type": "minimum", "value": width, "unit": "m",
                "measurement_basis": "clear_width", "space_type": "corridor", "confidence": "high", "verified": "seen",
                "source_ids": ["s"]
            }]
        })
    };
    KnowledgeBase::from_value(serde_json::json!({
        "metadata": {"version": 1, "domain": "office", "generated_by": "test", "date": "2026-11-21"},
        "references": [
            reference("old_strict", "DE", "standard", "1999", 2.0),
            reference("new_loose", "DE", "regulation", "2015 (2020 am.)", 1.5),
            reference("world", "INT", "standard", "2021", 1.2),
            reference("owner", "LOCAL", "amendment", "2026-11-21", 1.8),
        ]
    }))
    .expect("valid")
}

#[test]
fn sources_that_contradict_each_other_are_settled_as_asked() {
    let planned = |knowledge: &KnowledgeBase, policy: &Policy| {
        let found = retrieve_with(knowledge, &query("office", Some("DE")), policy);
        let width = found.limits.corridor_width.clone().map(|l| (l.value, l.constraint_id));
        let all: Vec<_> = found.conflicts.into_iter().map(|c| (c.kept, c.against, c.by)).collect();
        (width, all)
    };
    let by = |id: &str, against: &str, why| (format!("{id}_width"), format!("{against}_width"), why);
    let (width, conflicts) = planned(&corridors(), &Policy::Strictest);
    assert_eq!(width, Some((2.0, "old_strict_width".into())));
    assert!(conflicts.contains(&by("old_strict", "world", "nearest jurisdiction")), "{conflicts:?}");
    assert!(conflicts.contains(&by("old_strict", "new_loose", "strictest")), "{conflicts:?}");
    assert!(conflicts.contains(&by("old_strict", "owner", "strictest")), "{conflicts:?}");

    let mut law = corridors();
    law.references.retain(|r| r.jurisdiction != "LOCAL");
    assert_eq!(planned(&law, &Policy::Newest).0, Some((1.5, "new_loose_width".into())));
    let preferred = Policy::Preferred(vec!["nothing".into(), "old_STRICT".into()]);
    assert_eq!(planned(&law, &preferred).0, Some((2.0, "old_strict_width".into())));
}

#[test]
fn the_owners_rules_stand_beside_the_law_everywhere() {
    let width = |owner: f64, country| {
        let mut knowledge = corridors();
        let rule =
            &mut knowledge.references.iter_mut().find(|r| r.jurisdiction == "LOCAL").expect("there").constraints[0];
        rule.value = d3dgen_model::knowledge::Value::Number(owner);
        let found = retrieve(&knowledge, &query("office", country));
        found.limits.corridor_width.map(|l| l.value)
    };
    assert_eq!(width(2.6, Some("DE")), Some(2.6), "stricter than the law: planned for");
    assert_eq!(width(1.0, Some("DE")), Some(2.0), "looser than the law: the law stays");
    assert_eq!(width(2.6, None), Some(2.6));
    assert_eq!(width(1.0, None), Some(1.2));
}
