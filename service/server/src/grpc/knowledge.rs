//! `KnowledgeService`.

mod messages;
mod research;

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use d3dgen_knowledge::amend::states;
use d3dgen_knowledge::classify::{Building, Classified, ties};
use d3dgen_knowledge::database::{Change, Edit, SearchQuery, difference, filter_names};
use d3dgen_knowledge::{Policy, Stats, retrieve_with};
use d3dgen_model::Document;
use d3dgen_model::knowledge::{Constraint, KnowledgeBase, Statement, is_jurisdiction};
use d3dgen_proto::v1::amend_knowledge_request::Change as Wanted;
use d3dgen_proto::v1::knowledge_service_server::KnowledgeService;
use d3dgen_proto::v1::{
    AmendKnowledgeRequest, AmendKnowledgeResponse, ConstraintRemoval, ConstraintUpdate, ExportKnowledgeRequest,
    ExportKnowledgeResponse, GetConstraintRequest, GetConstraintResponse, GetKnowledgeChangeRequest,
    GetKnowledgeChangeResponse, GetKnowledgeStatsRequest, GetKnowledgeStatsResponse, ImportKnowledgeRequest,
    ImportKnowledgeResponse, ListConstraintFiltersRequest, ListConstraintFiltersResponse, ListKnowledgeChangesRequest,
    ListKnowledgeChangesResponse, ResearchKnowledgeRequest, ResearchKnowledgeResponse, RetrieveConstraintsRequest,
    RetrieveConstraintsResponse, SearchConstraintsRequest, SearchConstraintsResponse, SearchFilter,
    UndoKnowledgeChangeRequest, UndoKnowledgeChangeResponse, source_policy,
};
use d3dgen_research::extract::Extractor;
use tonic::{Request, Status};

use super::domain::plugin;
use super::page::Page;
use super::{Answer, Api, Once, caller, limits, mode};
use crate::convert::{document, masked, message, part, with_shared};
use crate::core::Core;
use crate::domains::Snapshot;
use crate::pool::Lane;
use crate::status::{self, invalid};

#[tonic::async_trait]
impl KnowledgeService for Api {
    async fn import_knowledge(&self, request: Request<ImportKnowledgeRequest>) -> Answer<ImportKnowledgeResponse> {
        let who = caller(&request).name;
        let q = request.get_ref();
        let id = (!q.validate_only).then(|| q.request_id.clone());
        let read = |core: &Core, mut asked: ImportKnowledgeRequest, _: &AtomicBool| {
            let given: KnowledgeBase = with_shared(document("knowledge_base", asked.knowledge_base.take())?)?;
            // once more as a text: formulas and printed units are looked at there
            let read = d3dgen_knowledge::import::read(&given.to_json()).map_err(status::knowledge)?;
            let (given, quarantined) = (read.knowledge, messages::quarantined(read.quarantined));
            plugin(&core.domains.now(), "knowledge_base.metadata.domain", &given.metadata.domain)?;
            Ok((given, quarantined, asked))
        };
        type Read = (KnowledgeBase, Vec<d3dgen_proto::v1::QuarantinedConstraint>, ImportKnowledgeRequest);
        let change = move |core: &Core, (given, quarantined, asked): Read, once: &Once| {
            let domain = given.metadata.domain.clone();
            if asked.validate_only {
                let before = match core.databases.rules.knowledge_base(&domain) {
                    Err(d3dgen_knowledge::Error::NoDomain { .. }) => KnowledgeBase::empty(&domain),
                    found => found.map_err(status::knowledge)?,
                };
                let by = core.provenance(&who, &asked.why);
                let edits = difference(&before, &given, asked.keep_others);
                let planned = messages::planned(&domain, &edits, by);
                let change = (!edits.is_empty()).then(|| messages::change(&planned));
                return Ok(ImportKnowledgeResponse { change, quarantined });
            }
            let changed = changed_once(core, once, &who, &asked.why, |by| {
                core.databases.rules.import(&given, asked.keep_others, by)
            })?;
            Ok(ImportKnowledgeResponse { change: changed.as_ref().map(messages::change), quarantined })
        };
        self.change_read(("ImportKnowledge", Lane::Work), request, id, read, change).await
    }

    async fn export_knowledge(&self, request: Request<ExportKnowledgeRequest>) -> Answer<ExportKnowledgeResponse> {
        let asked = request.into_inner();
        self.work(move |core, _| {
            let now = core.domains.now();
            let knowledge = plugin(&now, "domain_id", &asked.domain_id)?.knowledge();
            Ok(ExportKnowledgeResponse { knowledge_base: Some(message(knowledge)) })
        })
        .await
    }

    async fn search_constraints(
        &self,
        request: Request<SearchConstraintsRequest>,
    ) -> Answer<SearchConstraintsResponse> {
        let mut asked = request.into_inner();
        let (size, token) = (std::mem::take(&mut asked.page_size), std::mem::take(&mut asked.page_token));
        let page = Page::new(size, &token, &asked)?;
        if let Some(name) = asked.filters.keys().find(|n| !filter_names().contains(&n.as_str())) {
            return Err(invalid("filters", format!("`{name}` is no filter; there are {}", filter_names().join(", "))));
        }
        let query = SearchQuery {
            mode: mode(asked.mode)?,
            value: limits("value", asked.value)?,
            filters: asked.filters.into_iter().map(|(k, v)| (k, v.values.into_iter().collect())).collect(),
            text: asked.query,
            limit: page.wanted(),
        };
        self.lookup(move |core| {
            let now = core.domains.now();
            let answer = core.databases.searcher()?.answer(&query, now.glossary()).map_err(status::knowledge)?;
            let (found, next_page_token) = page.cut(answer.found);
            let constraints = found.iter().map(|f| messages::found(f, &now)).collect();
            Ok(SearchConstraintsResponse { constraints, next_page_token, note: answer.note.unwrap_or_default() })
        })
        .await
    }

    async fn list_constraint_filters(
        &self,
        request: Request<ListConstraintFiltersRequest>,
    ) -> Answer<ListConstraintFiltersResponse> {
        let asked = request.into_inner();
        let page = Page::new(asked.page_size, &asked.page_token, &ListConstraintFiltersRequest::default())?;
        self.lookup(move |core| {
            let searcher = core.databases.searcher()?;
            let mut names = filter_names().to_vec();
            names.sort_unstable();
            let (names, next_page_token) = page.cut(names);
            let filter = |name: &str| SearchFilter {
                name: name.to_owned(),
                counts: searcher.values(name).into_iter().map(|(value, n)| (value, n as u64)).collect(),
            };
            Ok(ListConstraintFiltersResponse { filters: names.into_iter().map(filter).collect(), next_page_token })
        })
        .await
    }

    async fn get_constraint(&self, request: Request<GetConstraintRequest>) -> Answer<GetConstraintResponse> {
        let asked = request.into_inner();
        self.lookup(move |core| {
            let now = core.domains.now();
            let knowledge = plugin(&now, "domain_id", &asked.domain_id)?.knowledge();
            let (reference, constraint) = find(knowledge, &asked.constraint_id)?;
            let found = messages::placed(constraint, reference, &asked.domain_id, 0.0);
            Ok(GetConstraintResponse { constraint: Some(found) })
        })
        .await
    }

    async fn retrieve_constraints(
        &self,
        request: Request<RetrieveConstraintsRequest>,
    ) -> Answer<RetrieveConstraintsResponse> {
        let asked = request.into_inner();
        if asked.room_labels.is_empty() {
            return Err(invalid("room_labels", "is empty: name a room"));
        }
        let country = asked.country_code.as_ref().map(|c| c.to_ascii_uppercase());
        if let Some(code) = country.as_ref().filter(|c| !is_jurisdiction(c)) {
            return Err(invalid("country_code", format!("`{code}` is no ISO 3166 code like DE or US-NC")));
        }
        self.lookup(move |core| {
            let now = core.domains.now();
            let (reading, tied) = reading(&now, &asked)?;
            let plugin = plugin(&now, "domain_id", &reading.domain)?;
            let building = Building {
                country_code: country,
                building_type: asked.building_type.clone().or(reading.building_type),
                accessible: asked.accessible || asked.wheelchair,
                wheelchair: asked.wheelchair,
                rooms: counted(&reading.rooms),
                persons: asked.person_count,
                robots: asked
                    .robots
                    .iter()
                    .enumerate()
                    .map(|(i, r)| part(&format!("robots[{i}]"), r))
                    .collect::<Result<_, _>>()?,
            };
            let policy = policy(asked.policy);
            let found = retrieve_with(plugin.knowledge(), &building.query(plugin.domain()), &policy);
            Ok(messages::retrieval(&reading.domain, tied, &found))
        })
        .await
    }

    async fn get_knowledge_stats(
        &self,
        request: Request<GetKnowledgeStatsRequest>,
    ) -> Answer<GetKnowledgeStatsResponse> {
        let asked = request.into_inner();
        self.work(move |core, _| {
            let now = core.domains.now();
            let plugin = plugin(&now, "domain_id", &asked.domain_id)?;
            Ok(messages::stats(Stats::of(plugin.knowledge(), plugin.domain(), 0)))
        })
        .await
    }

    async fn amend_knowledge(&self, request: Request<AmendKnowledgeRequest>) -> Answer<AmendKnowledgeResponse> {
        let who = caller(&request).name;
        let q = request.get_ref();
        let id = (!q.validate_only).then(|| q.request_id.clone());
        let read = |core: &Core, mut asked: AmendKnowledgeRequest, _: &AtomicBool| {
            plugin(&core.domains.now(), "domain_id", &asked.domain_id)?;
            let wanted = super::required("change", asked.change.take())?;
            if let Wanted::Sentence(said) = &wanted
                && asked.why.is_empty()
            {
                asked.why.clone_from(&said.text);
            }
            Ok((Intended::of(wanted)?, asked))
        };
        let change = move |core: &Core, (wanted, asked): (Intended, AmendKnowledgeRequest), once: &Once| {
            let rules = &core.databases.rules;
            let why = asked.why;
            // as the database has it: whoever changes it makes a snapshot before the next may
            let now = core.domains.now();
            let knowledge = plugin(&now, "domain_id", &asked.domain_id)?.knowledge();
            if asked.validate_only {
                let edits = edits(knowledge, wanted, &core.provenance(&who, &why))?;
                return Ok(AmendKnowledgeResponse { change: None, edits: edits.iter().map(messages::edit).collect() });
            }
            let made = |by: &_| edits(knowledge, wanted, by);
            let mut kept = Vec::new();
            let mut refused = None;
            let changed = changed_once(core, once, &who, &why, |by| match made(by) {
                Ok(edits) if edits.is_empty() => Ok(None),
                Ok(edits) => {
                    kept.clone_from(&edits);
                    rules.amend(&asked.domain_id, edits, by).map(Some)
                }
                Err(status) => {
                    refused = Some(status);
                    Ok(None)
                }
            })?;
            if let Some(refused) = refused {
                return Err(refused);
            }
            let changed = changed.ok_or_else(|| invalid("change", "nothing differs from what the database holds"))?;
            if kept.is_empty() {
                kept = rules.edits(changed.seq).map_err(status::knowledge)?; // of an attempt that was cut short
            }
            Ok(AmendKnowledgeResponse {
                change: Some(messages::change(&changed)),
                edits: kept.iter().map(messages::edit).collect(),
            })
        };
        self.change_read(("AmendKnowledge", Lane::Short), request, id, read, change).await
    }

    async fn list_knowledge_changes(
        &self,
        request: Request<ListKnowledgeChangesRequest>,
    ) -> Answer<ListKnowledgeChangesResponse> {
        let mut asked = request.into_inner();
        let (size, token) = (std::mem::take(&mut asked.page_size), std::mem::take(&mut asked.page_token));
        let page = Page::new(size, &token, &asked)?;
        self.lookup(move |core| {
            let all = core.databases.rules.history().map_err(status::knowledge)?;
            let fits = |c: &Change| asked.domain_id.as_ref().is_none_or(|d| *d == c.domain);
            let (found, next_page_token) = page.cut(all.into_iter().rev().filter(fits));
            Ok(ListKnowledgeChangesResponse { changes: found.iter().map(messages::change).collect(), next_page_token })
        })
        .await
    }

    async fn get_knowledge_change(
        &self,
        request: Request<GetKnowledgeChangeRequest>,
    ) -> Answer<GetKnowledgeChangeResponse> {
        let seq = request.into_inner().seq;
        self.lookup(move |core| {
            let edits = core.databases.rules.edits(seq).map_err(status::knowledge)?;
            let all = core.databases.rules.history().map_err(status::knowledge)?;
            let change = all.iter().find(|c| c.seq == seq);
            let change = change.ok_or_else(|| status::knowledge(d3dgen_knowledge::Error::NoChange { seq }))?;
            Ok(GetKnowledgeChangeResponse {
                change: Some(messages::change(change)),
                edits: edits.iter().map(messages::edit).collect(),
            })
        })
        .await
    }

    async fn undo_knowledge_change(
        &self,
        request: Request<UndoKnowledgeChangeRequest>,
    ) -> Answer<UndoKnowledgeChangeResponse> {
        let who = caller(&request).name;
        let change = move |core: &Core, asked: UndoKnowledgeChangeRequest, once: &Once| {
            let changed =
                changed_once(core, once, &who, &asked.why, |by| core.databases.rules.undo(asked.seq, by).map(Some))?;
            Ok(UndoKnowledgeChangeResponse { change: changed.as_ref().map(messages::change) })
        };
        {
            let id = request.get_ref().request_id.clone();
            self.change("UndoKnowledgeChange", request, id, change).await
        }
    }

    async fn research_knowledge(
        &self,
        request: Request<ResearchKnowledgeRequest>,
    ) -> Answer<ResearchKnowledgeResponse> {
        let who = caller(&request).name;
        let change = move |core: &Core, asked: ResearchKnowledgeRequest, once: &Once| {
            let job = research::start(core, &who, asked, once)?;
            Ok(ResearchKnowledgeResponse { job: Some(super::job::message(&job)) })
        };
        {
            let id = request.get_ref().request_id.clone();
            self.change("ResearchKnowledge", request, id, change).await
        }
    }
}

/// Makes a change of rules, or finds it when an attempt was cut short after it; searches know of it when this returns.
fn changed_once(
    core: &Core,
    once: &Once,
    who: &str,
    why: &str,
    change: impl FnOnce(&d3dgen_knowledge::database::Provenance) -> Result<Option<Change>, d3dgen_knowledge::Error>,
) -> Result<Option<Change>, Status> {
    let (at_ms, again) = once.intend(core)?;
    let by = d3dgen_knowledge::database::Provenance {
        who: who.to_owned(),
        when: crate::clock::text(at_ms),
        why: why.to_owned(),
    };
    let before = if again {
        let all = core.databases.rules.history().map_err(status::knowledge)?;
        all.into_iter().rev().find(|c| c.provenance == by)
    } else {
        None
    };
    let changed = match before {
        Some(found) => Some(found),
        None => change(&by).map_err(status::knowledge)?,
    };
    if let Some(changed) = &changed {
        core.changed_rules(changed)?;
    }
    Ok(changed)
}

fn find<'a>(
    knowledge: &'a KnowledgeBase,
    id: &str,
) -> Result<(&'a d3dgen_model::knowledge::Reference, &'a Constraint), Status> {
    let mut all = knowledge.references.iter().flat_map(|r| r.constraints.iter().map(move |c| (r, c)));
    all.find(|(_, c)| c.constraint_id == id).ok_or_else(|| {
        let domain = &knowledge.metadata.domain;
        Status::not_found(format!("domain `{domain}` has no rule {:?}", id.chars().take(80).collect::<String>()))
    })
}

/// What a request wants changed, as far as it can be read without the rules that it changes.
#[allow(clippy::large_enum_variant)] // one is made for a call, and moved once
enum Intended {
    Rules(Vec<Statement>),
    Update(ConstraintUpdate),
    Removal(ConstraintRemoval),
}

impl Intended {
    /// Reads what is wanted.
    fn of(wanted: Wanted) -> Result<Self, Status> {
        Ok(match wanted {
            Wanted::Sentence(said) => {
                let found = Extractor::shared().extract_best(&said.text, said.language.as_deref());
                if found.is_empty() {
                    let help = "has no rule with a figure; say it like \"corridors are at least 2.6 m wide\"";
                    return Err(invalid("sentence.text", help));
                }
                Self::Rules(found.iter().map(|f| f.statement()).collect())
            }
            Wanted::Update(update) => Self::Update(update),
            Wanted::Removal(removal) => Self::Removal(removal),
        })
    }
}

/// Returns the edits that are wanted.
fn edits(
    knowledge: &KnowledgeBase,
    wanted: Intended,
    by: &d3dgen_knowledge::database::Provenance,
) -> Result<Vec<Edit>, Status> {
    match wanted {
        Intended::Rules(said) => states(knowledge, &said, by).map_err(status::knowledge),
        Intended::Update(update) => {
            let given = super::required("update.constraint", update.constraint)?;
            let (_, was) = find(knowledge, &given.constraint_id)?;
            let base: d3dgen_proto::v1::Constraint = message(was);
            let changed = masked("update", base, &given, update.update_mask, &["constraint_id"])?;
            let changed: Constraint = part("update.constraint", &changed)?;
            if let Some(reason) = d3dgen_model::plausible::doubt_of(&changed) {
                return Err(invalid("update.constraint.value", reason));
            }
            let mut after = knowledge.clone();
            for constraint in after.references.iter_mut().flat_map(|r| &mut r.constraints) {
                if constraint.constraint_id == changed.constraint_id {
                    constraint.clone_from(&changed);
                }
            }
            Ok(difference(knowledge, &after, true))
        }
        Intended::Removal(removal) => {
            let mut after = knowledge.clone();
            for id in &removal.constraint_ids {
                find(knowledge, id)?;
                after.references.iter_mut().for_each(|r| r.constraints.retain(|c| c.constraint_id != *id));
            }
            Ok(difference(knowledge, &after, false))
        }
    }
}

/// Returns the best reading of the rooms, and the domains that they fit as well.
fn reading(now: &Snapshot, asked: &RetrieveConstraintsRequest) -> Result<(Classified, Vec<String>), Status> {
    if let Some(id) = &asked.domain_id {
        plugin(now, "domain_id", id)?;
    }
    let found = now.classify(&asked.room_labels, asked.domain_id.as_deref());
    let tied = ties(&found).iter().map(|r| r.domain.clone()).collect();
    let best = found.into_iter().next().filter(|r| r.score > 0.0);
    let best =
        best.ok_or_else(|| invalid("room_labels", "no domain knows any of these rooms, or they are of no kind"))?;
    Ok((best, tied))
}

fn counted(rooms: &[(String, Option<String>)]) -> BTreeMap<String, u32> {
    let mut counts = BTreeMap::new();
    for id in rooms.iter().filter_map(|(_, t)| t.clone()) {
        *counts.entry(id).or_insert(0) += 1;
    }
    counts
}

fn policy(asked: Option<d3dgen_proto::v1::SourcePolicy>) -> Policy {
    match asked.and_then(|p| p.kind) {
        None | Some(source_policy::Kind::Strictest(_)) => Policy::Strictest,
        Some(source_policy::Kind::Newest(_)) => Policy::Newest,
        Some(source_policy::Kind::Preferred(p)) => Policy::Preferred(p.words),
    }
}
