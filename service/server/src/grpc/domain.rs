//! `DomainService`.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use d3dgen_knowledge::classify::ties;
use d3dgen_model::domain::Domain;
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_pipeline::brief;
use d3dgen_pipeline::scene_graph::Request as Asked;
use d3dgen_plugins::{Custom, Plugin};
use d3dgen_proto::v1::domain_service_server::DomainService;
use d3dgen_proto::v1::{
    ClassifiedRoom, ClassifyDomainRequest, ClassifyDomainResponse, Domain as DomainMessage, DomainReading,
    DomainVersion, GetDomainRequest, GetDomainResponse, ListDomainVersionsRequest, ListDomainVersionsResponse,
    ListDomainsRequest, ListDomainsResponse, ParseDomainRequest, ParseDomainResponse, Problem, Provenance,
    RegisterDomainRequest, RegisterDomainResponse, RemoveDomainRequest, RemoveDomainResponse,
};
use tonic::{Request, Status};

use super::page::Page;
use super::{Answer, Api, caller, timestamp};
use crate::convert::{document, message, with_shared};
use crate::core::Core;
use crate::domains::{Entry, Refusal, Snapshot};
use crate::names;
use crate::pool::Lane;
use crate::status::{self, invalid};

#[tonic::async_trait]
impl DomainService for Api {
    async fn list_domains(&self, request: Request<ListDomainsRequest>) -> Answer<ListDomainsResponse> {
        let asked = request.into_inner();
        let page = Page::new(asked.page_size, &asked.page_token, &ListDomainsRequest::default())?;
        self.lookup(move |core| {
            let now = core.domains.now();
            let (page, next_page_token) = page.cut(now.as_given.iter());
            Ok(ListDomainsResponse { domains: page.into_iter().map(|p| short(p, &now)).collect(), next_page_token })
        })
        .await
    }

    async fn get_domain(&self, request: Request<GetDomainRequest>) -> Answer<GetDomainResponse> {
        let asked = request.into_inner();
        self.lookup(move |core| {
            let now = core.domains.now();
            plugin(&now, "domain_id", &asked.domain_id)?;
            let plugin = now.as_given.get(&asked.domain_id).ok_or_else(|| no_domain(&now, &asked.domain_id))?;
            let in_force = now.registered.get(&asked.domain_id).map_or(1, |e| e.version);
            if let Some(version) = asked.domain_version.filter(|v| *v != in_force) {
                let found = core.domains.version(&core.databases, &asked.domain_id, version);
                let (entry, domain, knowledge) = found
                    .map_err(status::own)?
                    .ok_or_else(|| Status::not_found(format!("{} has no version {version}", asked.domain_id)))?;
                let manifest = asked.include_manifest.then(|| message(&domain));
                let custom = Custom::of(domain, knowledge);
                return Ok(GetDomainResponse { domain: Some(described(&custom, Some(&entry))), manifest });
            }
            let manifest = asked.include_manifest.then(|| message(plugin.domain()));
            Ok(GetDomainResponse { domain: Some(short(plugin, &now)), manifest })
        })
        .await
    }

    async fn parse_domain(&self, request: Request<ParseDomainRequest>) -> Answer<ParseDomainResponse> {
        let asked = request.into_inner();
        self.work(move |_, _| {
            let files = texts(asked)?;
            Ok(match Custom::from_texts(&files) {
                Ok(custom) => ParseDomainResponse {
                    manifest: Some(message(custom.domain())),
                    knowledge_base: files.contains_key("knowledge.json").then(|| message(custom.knowledge())),
                    problems: Vec::new(),
                },
                Err((file, error)) => {
                    let found = match error {
                        d3dgen_model::Error::Invalid { problems, .. } => problems,
                        other => vec![d3dgen_model::Problem::new("", other.to_string())],
                    };
                    let problems = found
                        .into_iter()
                        .map(|p| Problem { path: format!("{file}{}", p.path), message: p.message })
                        .collect();
                    ParseDomainResponse { manifest: None, knowledge_base: None, problems }
                }
            })
        })
        .await
    }

    async fn register_domain(&self, request: Request<RegisterDomainRequest>) -> Answer<RegisterDomainResponse> {
        let who = caller(&request).name;
        let q = request.get_ref();
        let id = (!q.validate_only).then(|| q.request_id.clone());
        let read = |_: &Core, mut asked: RegisterDomainRequest, _: &AtomicBool| {
            let domain: Domain = document("manifest", asked.manifest.take())?;
            let knowledge: KnowledgeBase = match asked.knowledge_base.take() {
                Some(given) => with_shared(document("knowledge_base", Some(given))?)?,
                None => KnowledgeBase::empty(&domain.id),
            };
            Ok((domain, knowledge, asked))
        };
        type Read = (Domain, KnowledgeBase, RegisterDomainRequest);
        let change = move |core: &Core, (domain, knowledge, asked): Read, once: &super::Once| {
            let now = core.domains.now();
            let in_force = now.registered.get(&domain.id).map_or(0, |e| e.version);
            if asked.expected_version.is_some_and(|v| v != in_force) {
                return Err(Status::aborted(format!("version {in_force} of `{}` is in force", domain.id)));
            }
            let id = domain.id.clone();
            let custom = Custom::of(domain, knowledge);
            if asked.validate_only {
                core.domains.check(custom.domain(), custom.knowledge()).map_err(refused)?;
                let entry = Entry { version: in_force + 1, by: who.clone(), at_ms: core.clock.now_ms() };
                return Ok(RegisterDomainResponse { domain: Some(described(&custom, Some(&entry))) });
            }
            let by = core.provenance(&who, &format!("domain {id} registered"));
            let (domain, knowledge) = (custom.domain().clone(), custom.knowledge().clone());
            let answer = |entry: &Entry| RegisterDomainResponse { domain: Some(described(&custom, Some(entry))) };
            let entry = core
                .domains
                .register(&core.databases, domain, knowledge, &by, core.clock.now_ms(), |entry, batch| {
                    once.also(core, &answer(entry), batch);
                })
                .map_err(refused)?;
            core.open_indexes().map_err(status::own)?;
            Ok(answer(&entry))
        };
        self.change_read(("RegisterDomain", Lane::Work), request, id, read, change).await
    }

    async fn remove_domain(&self, request: Request<RemoveDomainRequest>) -> Answer<RemoveDomainResponse> {
        let who = caller(&request).name;
        let change = move |core: &Core, asked: RemoveDomainRequest, once: &super::Once| {
            let id = names::id("domain_id", &asked.domain_id)?;
            if d3dgen_plugins::is_shipped(id) {
                return Err(Status::failed_precondition(format!("`{id}` came with the server and stays")));
            }
            let by = core.provenance(&who, &format!("domain {id} removed"));
            let answer = RemoveDomainResponse {};
            let removed = core.domains.remove(&core.databases, id, &by, |batch| once.also(core, &answer, batch));
            if !removed.map_err(status::own)? {
                return Err(no_domain(&core.domains.now(), id));
            }
            core.open_indexes().map_err(status::own)?;
            Ok(answer)
        };
        {
            let id = request.get_ref().request_id.clone();
            self.change("RemoveDomain", request, id, change).await
        }
    }

    async fn list_domain_versions(
        &self,
        request: Request<ListDomainVersionsRequest>,
    ) -> Answer<ListDomainVersionsResponse> {
        let mut asked = request.into_inner();
        let (size, token) = (std::mem::take(&mut asked.page_size), std::mem::take(&mut asked.page_token));
        let page = Page::new(size, &token, &asked)?;
        self.lookup(move |core| {
            let now = core.domains.now();
            plugin(&now, "domain_id", &asked.domain_id)?;
            let in_force = now.registered.get(&asked.domain_id).map(|e| e.version);
            let all = core.domains.versions(&core.databases, &asked.domain_id).map_err(status::own)?;
            let versions = all.into_iter().rev().map(|(entry, digest)| DomainVersion {
                domain_version: entry.version,
                sha256_hex: digest,
                provenance: Some(Provenance {
                    who: entry.by,
                    changed_at: Some(timestamp(entry.at_ms)),
                    why: "registered".into(),
                }),
                in_force: Some(entry.version) == in_force,
            });
            let (versions, next_page_token) = page.cut(versions);
            Ok(ListDomainVersionsResponse { versions, next_page_token })
        })
        .await
    }

    async fn classify_domain(&self, request: Request<ClassifyDomainRequest>) -> Answer<ClassifyDomainResponse> {
        let asked = request.into_inner();
        if asked.prompt.trim().is_empty() && asked.room_labels.is_empty() {
            return Err(invalid("prompt", "is empty: give a sentence, or room_labels"));
        }
        self.short(move |core, _| {
            let now = core.domains.now();
            if !asked.room_labels.is_empty() {
                let found = now.classify(&asked.room_labels, None);
                let tied = ties(&found).len();
                let found = found.into_iter().filter(|r| r.score > 0.0).enumerate();
                let room = |(label, room_type)| ClassifiedRoom { label, room_type };
                let readings = found.map(|(n, r)| DomainReading {
                    domain_id: r.domain,
                    score: r.score,
                    building_type: r.building_type,
                    tied: tied > 0 && n <= tied,
                    rooms: r.rooms.into_iter().map(room).collect(),
                });
                return Ok(ClassifyDomainResponse {
                    readings: readings.collect(),
                    country_code: None,
                    division_code: None,
                    language: None,
                });
            }
            let request = Asked { prompt: asked.prompt, ..Asked::default() };
            let graph = brief::rooms(&request, &now.registry).map_err(|e| status::stage("prompt", e))?.0;
            let rooms = graph.rooms.iter().filter(|r| !r.circulation);
            let rooms = rooms.map(|r| ClassifiedRoom { label: r.id.clone(), room_type: Some(r.room_type.clone()) });
            let reading = DomainReading {
                domain_id: graph.domain.clone(),
                score: 1.0,
                building_type: graph.building_type.clone(),
                tied: false,
                rooms: rooms.collect(),
            };
            Ok(ClassifyDomainResponse {
                readings: vec![reading],
                division_code: graph.division_code,
                country_code: graph.country_code,
                language: Some(graph.language).filter(|l| !l.is_empty()),
            })
        })
        .await
    }
}

/// Returns a domain by id.
pub(crate) fn plugin<'a>(now: &'a Snapshot, field: &str, id: &str) -> Result<&'a dyn Plugin, Status> {
    names::id(field, id)?;
    now.registry.get(id).ok_or_else(|| no_domain(now, id))
}

fn no_domain(now: &Snapshot, id: &str) -> Status {
    let known: Vec<&str> = now.registry.iter().map(Plugin::id).collect();
    Status::not_found(format!("there is no domain `{id}`; there are {}", known.join(", ")))
}

fn refused(refusal: Refusal) -> Status {
    match refusal {
        Refusal::Problems(kind, problems) => {
            status::problems(if kind == "domain" { "manifest" } else { "knowledge_base" }, &problems)
        }
        Refusal::Shipped => {
            Status::already_exists("the id belongs to a domain that came with the server; choose another")
        }
        Refusal::Full => Status::resource_exhausted("there are as many registered domains as a server takes"),
        Refusal::Failed(error) => status::own(error),
    }
}

fn short(plugin: &dyn Plugin, now: &Snapshot) -> DomainMessage {
    described(plugin, now.registered.get(plugin.id()))
}

fn described(plugin: &dyn Plugin, entry: Option<&Entry>) -> DomainMessage {
    let (domain, knowledge) = (plugin.domain(), plugin.knowledge());
    let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    DomainMessage {
        domain_id: domain.id.clone(),
        title: domain.title.clone(),
        description: domain.description.clone(),
        room_types: domain.room_types.iter().map(|t| t.id.clone()).collect(),
        building_types: domain.building_types.iter().map(|t| t.id.clone()).collect(),
        object_count: count(domain.objects.len()),
        constraint_count: count(knowledge.references.iter().map(|r| r.constraints.len()).sum()),
        shipped: entry.is_none(),
        domain_version: entry.map_or(1, |e| e.version),
        registered_at: entry.map(|e| timestamp(e.at_ms)),
    }
}

/// Returns the texts of a domain folder by name.
fn texts(asked: ParseDomainRequest) -> Result<BTreeMap<String, String>, Status> {
    let mut files = BTreeMap::new();
    for (i, file) in asked.files.into_iter().enumerate() {
        let field = format!("files[{i}].name");
        names::upload_path(&field, &file.name)?;
        let known = file.name.ends_with(".toml") || file.name == "knowledge.json";
        if file.name.contains('/') || !known {
            return Err(invalid(&field, "is no file of a domain: name domain.toml, other *.toml or knowledge.json"));
        }
        let text =
            String::from_utf8(file.content).map_err(|_| invalid(&format!("files[{i}].content"), "is no UTF-8 text"))?;
        if files.insert(file.name, text).is_some() {
            return Err(invalid(&field, "is given twice"));
        }
    }
    Ok(files)
}
