//! Messages of rules that are no documents: what was found, what applies, what changed.

use d3dgen_knowledge::database::{Change, Edit, Entry, Found, Kind, Provenance};
use d3dgen_knowledge::{Applicable, Limit, Limits, Retrieval, Scope, Stats, phrase};
use d3dgen_model::knowledge::{Constraint, Reference};
use d3dgen_model::plausible::Quarantined;
use d3dgen_proto::v1::{
    ApplicableConstraint, AreaLimits, ConstraintConflict, ConstraintScope, FoundConstraint, GetKnowledgeStatsResponse,
    KnowledgeChange, KnowledgeChangeKind, KnowledgeEdit, KnowledgeEntry, PlacedConstraint, PlanLimit, PlanLimits,
    Provenance as ProvenanceMessage, QuarantinedConstraint, RetrieveConstraintsResponse, RoomPlanLimits,
    knowledge_entry,
};

use crate::convert::message;
use crate::domains::Snapshot;
use crate::grpc::timestamp_of;

/// Returns a rule that a search found.
pub(super) fn found(found: &Found, now: &Snapshot) -> FoundConstraint {
    let knowledge = now.registry.get(&found.domain).map(|p| p.knowledge());
    let reference = knowledge.and_then(|k| k.references.iter().find(|r| r.ref_id == found.ref_id));
    let (c, score) = (&found.constraint, found.hit.score);
    match reference {
        Some(reference) => {
            FoundConstraint { copies: found.copies.clone(), ..placed(c, reference, &found.domain, score) }
        }
        // removed in this moment
        None => FoundConstraint {
            constraint: Some(message(c)),
            ref_id: found.ref_id.clone(),
            domain_id: found.domain.clone(),
            jurisdiction: found.jurisdiction.clone(),
            sources: found.source.iter().map(message).collect(),
            score,
            copies: found.copies.clone(),
        },
    }
}

/// Returns a rule with its sources.
pub(super) fn placed(c: &Constraint, reference: &Reference, domain: &str, score: f64) -> FoundConstraint {
    let source = |id: &String| reference.sources.iter().find(|s| s.source_id == *id);
    FoundConstraint {
        constraint: Some(message(c)),
        ref_id: reference.ref_id.clone(),
        domain_id: domain.to_owned(),
        jurisdiction: reference.jurisdiction.clone(),
        sources: c.source_ids.iter().filter_map(source).map(message).collect(),
        score,
        copies: Vec::new(),
    }
}

/// Returns what was kept apart at import.
pub(super) fn quarantined(rules: Vec<Quarantined>) -> Vec<QuarantinedConstraint> {
    rules.into_iter().map(|q| QuarantinedConstraint { constraint_id: q.constraint_id, reason: q.reason }).collect()
}

/// Returns the rules of a building.
pub(super) fn retrieval(domain: &str, tied: Vec<String>, found: &Retrieval) -> RetrieveConstraintsResponse {
    let conflict = |c: &d3dgen_knowledge::Conflict| ConstraintConflict {
        space_type: c.space_type.clone(),
        kept_constraint_id: c.kept.clone(),
        against_constraint_id: c.against.clone(),
        reason: c.by.to_owned(),
    };
    RetrieveConstraintsResponse {
        domain_id: domain.to_owned(),
        jurisdictions: found.jurisdictions.clone(),
        constraints: found.constraints.iter().map(applicable).collect(),
        not_applicable_count: found.not_applicable,
        limits: Some(limits(&found.limits)),
        conflicts: found.conflicts.iter().map(conflict).collect(),
        person_count: found.persons,
        tied_domain_ids: tied,
    }
}

fn applicable(a: &Applicable) -> ApplicableConstraint {
    let bounds = a.decision.as_ref().ok().map(|rule| &rule.bounds);
    let (scope, room_types) = match &a.scope {
        Scope::Rooms(types) => (ConstraintScope::Rooms, types.iter().cloned().collect()),
        Scope::Circulation => (ConstraintScope::Circulation, Vec::new()),
        Scope::Doors => (ConstraintScope::Doors, Vec::new()),
        Scope::Entrance => (ConstraintScope::Entrance, Vec::new()),
        Scope::Building => (ConstraintScope::Building, Vec::new()),
        Scope::Objects(_) => (ConstraintScope::Objects, Vec::new()),
    };
    ApplicableConstraint {
        constraint: Some(message(&a.constraint)),
        ref_id: a.ref_id.clone(),
        citation: Some(message(&a.citation)),
        mandatory: a.mandatory,
        scope: scope as i32,
        room_types,
        required_min: bounds.and_then(|b| b.min),
        required_max: bounds.and_then(|b| b.max),
        undecidable_reason: a.decision.as_ref().err().cloned(),
        superseded_by_constraint_id: a.superseded_by.clone(),
        sentence: phrase::sentence(&a.constraint),
    }
}

fn limits(limits: &Limits) -> PlanLimits {
    let limit =
        |l: &Option<Limit>| l.as_ref().map(|l| PlanLimit { value: l.value, constraint_id: l.constraint_id.clone() });
    let rooms = limits.rooms.iter().map(|(id, r)| {
        let limits = RoomPlanLimits {
            area_min_m2: limit(&r.area_min),
            area_max_m2: limit(&r.area_max),
            area_advised_m2: r.area_advised.map(|[min_m2, max_m2]| AreaLimits { min_m2, max_m2 }),
            dimension_min_m: limit(&r.dimension_min),
            door_width_m: limit(&r.door_width),
            ceiling_height_min_m: limit(&r.ceiling_height_min),
        };
        (id.clone(), limits)
    });
    PlanLimits {
        corridor_width_m: limit(&limits.corridor_width),
        corridor_width_advised_m: limits.corridor_width_advised,
        entrance_width_m: limit(&limits.entrance_width),
        rooms: rooms.collect(),
    }
}

/// Returns the counts of a knowledge base.
pub(super) fn stats(stats: Stats) -> GetKnowledgeStatsResponse {
    let counted =
        |all: std::collections::BTreeMap<String, usize>| all.into_iter().map(|(k, n)| (k, n as u64)).collect();
    GetKnowledgeStatsResponse {
        domain_id: stats.domain,
        reference_count: stats.references as u64,
        constraint_count: stats.constraints as u64,
        space_count: stats.room_types as u64,
        type_count: stats.type_families as u64,
        jurisdiction_count: stats.jurisdictions as u64,
        confidence_counts: counted(stats.confidence),
        decided_count: stats.decided as u64,
        not_decidable_counts: counted(stats.not_decidable),
    }
}

/// Returns an entry of the history.
pub(super) fn change(change: &Change) -> KnowledgeChange {
    let kind = match change.kind {
        Kind::Shipped => KnowledgeChangeKind::Shipped,
        Kind::Import => KnowledgeChangeKind::Import,
        Kind::Amend => KnowledgeChangeKind::Amend,
        Kind::Undo => KnowledgeChangeKind::Undo,
    };
    let by = &change.provenance;
    KnowledgeChange {
        seq: change.seq,
        kind: kind as i32,
        domain_id: change.domain.clone(),
        provenance: Some(ProvenanceMessage {
            who: by.who.clone(),
            changed_at: timestamp_of(&by.when),
            why: by.why.clone(),
        }),
        added_count: change.added,
        changed_count: change.changed,
        removed_count: change.removed,
        undoes_seq: change.undoes,
        undone_by_seq: change.undone_by,
    }
}

/// Returns the change that an import would be, with number 0.
pub(super) fn planned(domain: &str, edits: &[Edit], by: Provenance) -> Change {
    let count = |fits: fn(&Edit) -> bool| edits.iter().filter(|e| fits(e)).count() as u64;
    Change {
        seq: 0,
        kind: Kind::Import,
        domain: domain.to_owned(),
        provenance: by,
        added: count(|e| e.before.is_none()),
        changed: count(|e| e.before.is_some() && e.after.is_some()),
        removed: count(|e| e.after.is_none()),
        created_domain: false,
        undoes: None,
        undone_by: None,
    }
}

/// Returns the difference in one entry.
pub(super) fn edit(edit: &Edit) -> KnowledgeEdit {
    let entry = |entry: &Entry| KnowledgeEntry {
        kind: Some(match entry {
            Entry::Reference(reference) => knowledge_entry::Kind::Reference(message(reference)),
            Entry::Constraint(ref_id, constraint) => knowledge_entry::Kind::Constraint(PlacedConstraint {
                constraint: Some(message(&**constraint)),
                ref_id: ref_id.clone(),
            }),
        }),
    };
    KnowledgeEdit {
        target_id: edit.target.id().to_owned(),
        before: edit.before.as_ref().map(entry),
        after: edit.after.as_ref().map(entry),
    }
}
