//! `d3dgen knowledge search` of a server.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_knowledge::database::{Answer, Found, SearchQuery};
use d3dgen_proto::v1::knowledge_service_client::KnowledgeServiceClient;
use d3dgen_proto::v1::{
    AnyOf, FoundConstraint, Limits, ListConstraintFiltersRequest, SearchConstraintsRequest, SearchMode,
};
use d3dgen_store::index::{Hit, Mode};
use tonic::transport::Channel;

use super::{MESSAGE_BYTES, Remote, part};
use crate::error::Error;

/// Entries of one answer at most.
const PAGE: usize = 1000;

fn client(remote: &Remote) -> KnowledgeServiceClient<Channel> {
    KnowledgeServiceClient::new(remote.channel()).max_decoding_message_size(MESSAGE_BYTES)
}

/// Returns the values of each filter.
///
/// # Errors
/// `Remote`.
pub fn filter_values(remote: &Remote) -> Result<BTreeMap<String, BTreeSet<String>>, Error> {
    let (mut found, mut page_token) = (BTreeMap::new(), String::new());
    loop {
        let asked = ListConstraintFiltersRequest { page_token, ..Default::default() };
        let page = remote.ask(client(remote).list_constraint_filters(remote.request(asked)))?;
        found.extend(page.filters.into_iter().map(|f| (f.name, f.counts.into_keys().collect())));
        page_token = page.next_page_token;
        if page_token.is_empty() {
            return Ok(found);
        }
    }
}

/// Returns the rules that fit best, best first. How they were ranked by words and by meaning a server does not tell.
///
/// # Errors
/// `Remote`.
pub fn search(remote: &Remote, query: &SearchQuery) -> Result<Answer, Error> {
    let (mut found, mut note, mut page_token) = (Vec::new(), None, String::new());
    let any_of = |values: &BTreeSet<String>| AnyOf { values: values.iter().cloned().collect() };
    let (min, max) = query.value;
    while found.len() < query.limit {
        let asked = SearchConstraintsRequest {
            query: query.text.clone(),
            filters: query.filters.iter().map(|(name, values)| (name.clone(), any_of(values))).collect(),
            value: (min.is_some() || max.is_some()).then_some(Limits { min, max }),
            mode: mode(query.mode) as i32,
            page_size: i32::try_from(query.limit.min(PAGE)).unwrap_or(i32::MAX),
            page_token,
        };
        let page = remote.ask(client(remote).search_constraints(remote.request(asked)))?;
        found.extend(page.constraints.iter().map(read).collect::<Result<Vec<_>, _>>()?);
        note = Some(page.note).filter(|n| !n.is_empty());
        page_token = page.next_page_token;
        if page_token.is_empty() {
            break;
        }
    }
    found.truncate(query.limit);
    Ok(Answer { found, note })
}

fn read(found: &FoundConstraint) -> Result<Found, Error> {
    let constraint = found.constraint.as_ref().ok_or_else(|| Error::Remote("the answer lacks a rule".into()))?;
    let key = format!("{}/{}", found.domain_id, constraint.constraint_id);
    Ok(Found {
        domain: found.domain_id.clone(),
        jurisdiction: found.jurisdiction.clone(),
        ref_id: found.ref_id.clone(),
        source: found.sources.first().map(part).transpose()?,
        constraint: part(constraint)?,
        hit: Hit { key, score: found.score, text_rank: None, vector_rank: None, similarity: None },
        copies: found.copies.clone(),
    })
}

/// Returns how to rank, as messages say it.
pub fn mode(mode: Mode) -> SearchMode {
    match mode {
        Mode::Hybrid => SearchMode::Hybrid,
        Mode::Text => SearchMode::Text,
        Mode::Vector => SearchMode::Vector,
    }
}
