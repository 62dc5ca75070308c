//! The domains shipped inside the program.

use std::sync::OnceLock;

use d3dgen_model::domain::Domain;
use d3dgen_model::knowledge::KnowledgeBase;
use serde_json::Value;

use crate::{Plugin, complete};

/// A shipped domain: JSON texts made at build time, parsed when first used.
pub struct Builtin {
    id: &'static str,
    domain_json: &'static str,
    knowledge_json: &'static str,
    domain: OnceLock<Domain>,
    knowledge: OnceLock<KnowledgeBase>,
}

macro_rules! builtin {
    ($id:literal) => {
        Builtin {
            id: $id,
            domain_json: include_str!(concat!(env!("OUT_DIR"), "/", $id, ".json")),
            knowledge_json: include_str!(concat!("../../domains/", $id, "/knowledge.json")),
            domain: OnceLock::new(),
            knowledge: OnceLock::new(),
        }
    };
}

/// Returns the objects and groups that domains share: what the `use` of a domain names.
pub(crate) fn common() -> &'static Value {
    static COMMON: OnceLock<Value> = OnceLock::new();
    let text = include_str!(concat!(env!("OUT_DIR"), "/common.json"));
    COMMON.get_or_init(|| serde_json::from_str(text).expect("the build script writes it"))
}

/// Returns the shipped domains, in the order in which `domains list` shows them.
pub fn all() -> Vec<Builtin> {
    vec![
        builtin!("residential"),
        builtin!("office"),
        builtin!("hospital"),
        builtin!("school"),
        builtin!("warehouse"),
        builtin!("general"),
    ]
}

impl Builtin {
    /// Reads the domain's own rules and those it shares.
    fn read_knowledge(&self) -> Result<KnowledgeBase, String> {
        let mut knowledge = serde_json::from_str(self.knowledge_json).map_err(|e| e.to_string())?;
        complete(&mut knowledge).map_err(|e| e.to_string())?;
        Ok(knowledge)
    }
}

impl Plugin for Builtin {
    fn id(&self) -> &str {
        self.id
    }

    fn domain(&self) -> &Domain {
        self.domain.get_or_init(|| serde_json::from_str(self.domain_json).expect("a test reads every shipped domain"))
    }

    fn knowledge(&self) -> &KnowledgeBase {
        self.knowledge.get_or_init(|| self.read_knowledge().expect("a test reads every shipped knowledge base"))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use d3dgen_model::Document;

    use super::*;

    #[test]
    fn every_shipped_domain_holds_its_schema_and_rules() {
        for builtin in all() {
            let domain = Domain::from_json(builtin.domain_json).unwrap_or_else(|e| panic!("{}: {e}", builtin.id));
            assert_eq!(domain.id, builtin.id);
            let knowledge =
                KnowledgeBase::from_json(builtin.knowledge_json).unwrap_or_else(|e| panic!("{}: {e}", builtin.id));
            assert_eq!(knowledge.metadata.domain, builtin.id);
            assert_eq!(builtin.domain(), &domain);
            let whole = builtin.knowledge();
            assert!(whole.check().is_empty(), "{}: {:?}", builtin.id, whole.check());
            assert!(knowledge.references.iter().all(|r| whole.references.iter().any(|w| w.ref_id == r.ref_id)));
        }
    }

    #[test]
    fn what_domains_share_is_used_by_more_than_one() {
        let has = |domain: &Domain, id: &str| domain.object(id).is_some() || domain.group(id).is_some();
        for entry in ["objects", "groups"].iter().flat_map(|key| common()[key].as_array().expect("a list")) {
            let id = entry["id"].as_str().expect("an id");
            let users = all().into_iter().filter(|b| has(b.domain(), id)).count();
            assert!(users > 1, "{id} is of {users} domain; it belongs into its folder");
        }
    }

    #[test]
    fn the_knowledge_bases_hold_every_researched_fact() {
        // those of the domain alone, and the shared ones that join them
        let expected = [("residential", 362), ("office", 376), ("hospital", 514), ("general", 158)];
        for (id, count) in expected {
            let builtin = all().into_iter().find(|b| b.id == id).expect("shipped");
            let constraints: usize = builtin.knowledge().references.iter().map(|r| r.constraints.len()).sum();
            assert_eq!(constraints, count, "{id}");
        }
    }

    #[test]
    fn every_room_type_has_enough_objects_to_wish_for() {
        for builtin in all() {
            let domain = builtin.domain();
            // stairwells and shafts hold nothing but what makes them so
            let vertical = |id: &str| domain.circulation.storeys.as_ref().is_some_and(|s| s.joins(id));
            // a room that no domain knows has a name of its own, a table and a cupboard
            let unknown = |id: &str| id == "room";
            for room in domain.room_types.iter().filter(|r| !vertical(&r.id) && !unknown(&r.id)) {
                let mut objects = BTreeSet::new();
                for line in &room.furnishing {
                    match domain.group(&line.item) {
                        Some(group) => {
                            objects.insert(&group.anchor);
                            objects.extend(group.members.iter().map(|m| &m.object));
                        }
                        None => {
                            objects.insert(&line.item);
                        }
                    }
                }
                assert!(objects.len() >= 8, "{}: {} knows {} objects, needs 8", builtin.id, room.id, objects.len());
            }
        }
    }
}
