//! Rules that many domains share, kept once: general building law and what is known of robots.
//!
//! A knowledge base names the ones it uses in `metadata.uses`; [`complete`] adds their rules. The ids of rules and documents
//! get the domain before them, so that they are as unique as the domain's own and can be amended domain by domain.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use d3dgen_model::knowledge::{KnowledgeBase, Reference};
use d3dgen_model::{Error, Problem};

macro_rules! base {
    ($id:literal) => {
        ($id, include_str!(concat!("../../domains/common/knowledge/", $id, ".json")))
    };
}

/// The shared knowledge bases by id.
const TEXTS: [(&str, &str); 8] = [
    base!("egress"),
    base!("accessibility"),
    base!("workplace"),
    base!("offices"),
    base!("robots"),
    base!("robots_in_public"),
    base!("robots_at_home"),
    base!("robots_at_work"),
];

static BASES: LazyLock<Vec<KnowledgeBase>> = LazyLock::new(|| {
    let read = |(id, text): &(&str, &str)| {
        serde_json::from_str(text).unwrap_or_else(|e| panic!("a test reads the shared rules of `{id}`: {e}"))
    };
    TEXTS.iter().map(read).collect()
});

/// Adds the rules of the shared knowledge bases that this one uses; its own rules go before shared ones of the same id.
///
/// # Errors
/// `Invalid` with every name that is of none.
pub fn complete(knowledge: &mut KnowledgeBase) -> Result<(), Error> {
    let uses = std::mem::take(&mut knowledge.metadata.uses);
    if uses.is_empty() {
        return Ok(());
    }
    let known = || TEXTS.map(|(id, _)| id).join(", ");
    let wrong = uses.iter().enumerate().filter(|(_, id)| !TEXTS.iter().any(|(known, _)| known == id));
    let problems: Vec<Problem> = wrong
        .map(|(i, id)| Problem::new(format!("/metadata/uses/{i}"), format!("`{id}` is none of {}", known())))
        .collect();
    if !problems.is_empty() {
        return Err(Error::Invalid { kind: "knowledge_base", problems });
    }
    let mut ids: BTreeSet<String> =
        knowledge.references.iter().flat_map(|r| &r.constraints).map(|c| c.constraint_id.clone()).collect();
    for base in BASES.iter().filter(|b| uses.contains(&b.metadata.domain)) {
        for shared in &base.references {
            add(knowledge, shared, &mut ids);
        }
    }
    knowledge.references.sort_by(|a, b| a.ref_id.cmp(&b.ref_id));
    Ok(())
}

/// Adds the rules of a shared document, to the domain's own part of it where it has one.
fn add(knowledge: &mut KnowledgeBase, shared: &Reference, ids: &mut BTreeSet<String>) {
    let domain = knowledge.metadata.domain.clone();
    let mut constraints = shared.constraints.clone();
    for c in &mut constraints {
        c.constraint_id = format!("{domain}_{}", c.constraint_id);
        c.superseded_by =
            c.superseded_by.take().map(|by| match shared.constraints.iter().any(|o| o.constraint_id == by) {
                true => format!("{domain}_{by}"),
                false => by,
            });
    }
    constraints.retain(|c| ids.insert(c.constraint_id.clone()));
    if constraints.is_empty() {
        return;
    }
    let mut ref_id = format!("{domain}_{}", shared.ref_id);
    match knowledge.references.iter_mut().find(|r| r.ref_id == ref_id) {
        Some(own) if own.sources == shared.sources && own.jurisdiction == shared.jurisdiction => {
            own.constraints.extend(constraints);
            return;
        }
        Some(_) => ref_id += "_shared",
        None => {}
    }
    let building_type = domain;
    knowledge.references.push(Reference { ref_id, building_type, constraints, ..shared.clone() });
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use d3dgen_model::Document;

    use super::*;
    use crate::Plugin;
    use crate::all;

    #[test]
    fn shared_rules_hold_their_schema_and_are_used() {
        let used: BTreeSet<String> = shipped_files().iter().flat_map(|k| k.metadata.uses.clone()).collect();
        for (id, text) in TEXTS {
            let base = KnowledgeBase::from_json(text).unwrap_or_else(|e| panic!("{id}: {e}"));
            assert_eq!(base.metadata.domain, id);
            assert!(base.metadata.uses.is_empty() && used.contains(id), "{id}");
        }
    }

    fn shipped_files() -> Vec<KnowledgeBase> {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../domains");
        let read = |id: &str| std::fs::read_to_string(root.join(id).join("knowledge.json")).expect("it is there");
        all().iter().map(|b| KnowledgeBase::from_json(&read(b.id())).expect("it is valid")).collect()
    }

    #[test]
    fn one_copy_of_each_rule_is_kept() {
        let shared = TEXTS.map(|(_, text)| KnowledgeBase::from_json(text).expect("it is valid"));
        let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for knowledge in shared.iter().chain(&shipped_files()) {
            for (reference, c) in knowledge.references.iter().flat_map(|r| r.constraints.iter().map(move |c| (r, c))) {
                let titles: Vec<&str> = reference.sources.iter().map(|s| s.title.as_str()).collect();
                let figure = (&c.name, &c.space_type, &c.constraint_type, &c.value, &c.unit, &c.conditions);
                let same = format!("{} {titles:?} {figure:?}", reference.jurisdiction);
                places.entry(same).or_default().push(format!("{}/{}", knowledge.metadata.domain, c.constraint_id));
            }
        }
        let copies: Vec<_> = places.values().filter(|p| p.len() > 1).collect();
        assert!(copies.is_empty(), "{copies:#?}");
    }

    #[test]
    fn a_domain_has_the_general_law_of_a_country_that_its_own_rules_do_not_know() {
        let jurisdictions = |id: &str| -> BTreeSet<String> {
            let all = all();
            let domain = all.iter().find(|b| b.id() == id).expect("it is shipped");
            domain.knowledge().references.iter().map(|r| r.jurisdiction.clone()).collect()
        };
        for id in ["hospital", "office", "school", "warehouse", "general"] {
            let known = jurisdictions(id);
            for country in ["AT", "AU", "CA", "CH", "DE", "GB", "SG", "US"] {
                assert!(known.contains(country), "{id}: {country}");
            }
        }
    }

    #[test]
    fn own_rules_go_before_shared_ones_and_unknown_bases_are_named() {
        let mut knowledge = KnowledgeBase::empty("castle");
        knowledge.metadata.uses = vec!["egress".into()];
        complete(&mut knowledge).expect("there is one");
        let count = |k: &KnowledgeBase| k.references.iter().map(|r| r.constraints.len()).sum::<usize>();
        assert!(count(&knowledge) >= 9 && knowledge.check().is_empty(), "{:?}", knowledge.check());
        let mut again = knowledge.clone();
        again.references[0].constraints[0].note = "ours".into();
        again.metadata.uses = vec!["egress".into()];
        complete(&mut again).expect("there is one");
        assert_eq!((count(&again), again.references[0].constraints[0].note.as_str()), (count(&knowledge), "ours"));
        again.metadata.uses = vec!["robots".into(), "martian".into()];
        let message = complete(&mut again).expect_err("there is none").to_string();
        assert!(message.contains("/metadata/uses/1") && message.contains("`martian` is none of egress"), "{message}");
    }

    #[test]
    fn rules_past_their_end_are_these() {
        let mut ended: BTreeMap<String, String> = BTreeMap::new();
        for builtin in all() {
            let knowledge = builtin.knowledge();
            let of = knowledge.references.iter().flat_map(|r| &r.constraints);
            for c in of.filter(|c| c.has_ended(&knowledge.metadata.date)) {
                let by = c.superseded_by.clone().unwrap_or_default();
                assert!(!by.is_empty(), "{} ended and nothing says what replaced it", c.constraint_id);
                let prefix = format!("{}_", builtin.id());
                ended.insert(c.constraint_id.trim_start_matches(&prefix).to_owned(), by);
            }
        }
        let expected = [
            "ca_on_bedroom_area_bedroom",
            "ca_on_dwelling_entrance_door_entry",
            "ca_on_hallway_width_hallway",
            "ca_on_kitchen_area_kitchen",
            "ca_on_kitchen_area_two_person_kitchen",
            "ca_on_living_area_combined_two_person_living_room",
            "ca_on_living_area_living_room",
            "ca_on_living_ceiling_height_living_room",
            "ca_on_master_bedroom_area_bedroom",
            "ca_on_studio_combined_area_studio",
            "ie_apartment_studio_area_studio",
            "sg_accessible_route_width_corridor",
            "sg_door_clear_opening_door",
            "sg_door_clear_opening_entry",
            "sg_door_threshold_height_entry",
        ];
        assert_eq!(ended.keys().map(String::as_str).collect::<Vec<_>>(), expected, "{ended:#?}");
    }
}
