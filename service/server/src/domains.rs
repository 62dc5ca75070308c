//! The domains of a server at run time: those shipped, and those that clients register, with effect on all calls at once.
//!
//! A call works with the [`Snapshot`] it began with. Registered domains are stored before they are acknowledged; shipped
//! ones cannot be replaced or removed.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::{Arc, OnceLock};

use arc_swap::ArcSwap;
use d3dgen_assets::catalog::Catalog;
use d3dgen_assets::stock::Stock;
use d3dgen_knowledge::classify::{self, Classified};
use d3dgen_knowledge::database::{Provenance, digest};
use d3dgen_knowledge::glossary::Glossary;
use d3dgen_model::domain::Domain;
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_model::{Document, Problem};
use d3dgen_plugins::{Custom, Plugin, Registry, is_shipped};
use d3dgen_store::{Batch, KeyRange};
use serde::{Deserialize, Serialize};

use crate::databases::Databases;
use crate::error::Error;
use crate::own::{self, DOMAIN_RULES, DOMAIN_VERSIONS, DOMAINS};

/// Registered domains at most.
const LIMIT: usize = 500;

/// The domains at one moment.
pub struct Snapshot {
    /// All domains, with the rules and assets that the databases have changed: what worlds are made of.
    pub registry: Registry,
    /// All domains with the changed rules, and objects as they were shipped or registered: what clients are shown.
    pub as_given: Registry,
    /// Their objects.
    pub catalog: Arc<Catalog>,
    /// Registered ones, by id.
    pub registered: BTreeMap<String, Entry>,
    words: Arc<Words>,
    /// Both registries with the rules that the domains brought.
    bare: (Registry, Registry),
    /// Rules that have changed since, by domain.
    rules: BTreeMap<String, Arc<KnowledgeBase>>,
}

/// What domains call things, made when first asked for; the same for as long as no domain comes, changes or goes.
#[derive(Default)]
struct Words {
    glossary: OnceLock<Glossary>,
    rooms: OnceLock<classify::Words>,
}

impl Snapshot {
    /// Returns the words for what rules speak of.
    pub fn glossary(&self) -> &Glossary {
        self.words.glossary.get_or_init(|| Glossary::of(self.as_given.iter().map(Plugin::domain)))
    }

    /// Returns what each domain takes labels of rooms for, or one domain, by its place; the best first.
    pub fn classify(&self, labels: &[String], domain_id: Option<&str>) -> Vec<Classified> {
        let domains: Vec<&Domain> = self.as_given.iter().map(Plugin::domain).collect();
        let words = self.words.rooms.get_or_init(|| classify::Words::of(&domains));
        match domain_id {
            None => words.classify(labels, &domains),
            Some(id) => {
                let at = domains.iter().position(|d| d.id == id);
                at.map_or_else(Vec::new, |at| words.classify_in(labels, at, domains[at]))
            }
        }
    }

    /// Returns the domains with their rules; `bare` are all domains, with the assets of the database and without.
    fn new(
        bare: (Registry, Registry),
        rules: BTreeMap<String, Arc<KnowledgeBase>>,
        catalog: Arc<Catalog>,
        registered: BTreeMap<String, Entry>,
        words: Arc<Words>,
    ) -> Self {
        let (mut registry, mut as_given) = bare.clone();
        for (id, knowledge) in &rules {
            registry.set_knowledge(id, KnowledgeBase::clone(knowledge));
            as_given.set_knowledge(id, KnowledgeBase::clone(knowledge));
        }
        Self { registry, as_given, catalog, registered, words, bare, rules }
    }
}

/// A registered domain.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// Counts its registrations, from 1; goes on after it was removed.
    pub version: u64,
    /// By whom.
    pub by: String,
    /// When, ms since 1970.
    pub at_ms: u64,
}

/// A version of a registered domain, as it is stored.
#[derive(Serialize, Deserialize)]
struct Version {
    entry: Entry,
    domain: Domain,
    knowledge: KnowledgeBase,
}

/// What is stored of a registered domain: its last version, and whether it is there.
#[derive(Serialize, Deserialize)]
struct Head {
    version: u64,
    removed: bool,
}

/// Why a domain is not registered.
#[derive(Debug)]
pub enum Refusal {
    /// Something is wrong with it; every problem is listed, by document.
    Problems(&'static str, Vec<Problem>),
    /// Its id belongs to a shipped domain.
    Shipped,
    /// There are as many as a server takes.
    Full,
    /// The databases failed.
    Failed(Error),
}

impl<E: Into<Error>> From<E> for Refusal {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

/// The domains of a server.
pub struct Domains {
    /// As they are shipped, parsed once.
    shipped: Registry,
    current: ArcSwap<Snapshot>,
}

impl Domains {
    /// Reads the registered domains and makes the first snapshot; rules of the release that the database lacks are brought
    /// in, and rules of domains whose registration was cut short.
    ///
    /// # Errors
    /// `Store`, `Knowledge`, `Assets`; `Domain` when one that is stored cannot be read.
    pub fn open(databases: &Databases, by: &Provenance) -> Result<Self, Error> {
        let shipped = Registry::builtin();
        bring_shipped(databases, &shipped, by)?;
        for (id, version) in registered(databases)? {
            keep_rules(databases, &id, &version, by)?;
        }
        let current = ArcSwap::from_pointee(snapshot(databases, &shipped)?);
        Ok(Self { shipped, current })
    }

    /// Returns the domains as they are now.
    pub fn now(&self) -> Arc<Snapshot> {
        self.current.load_full()
    }

    /// Makes a new snapshot after rules of one domain have changed; for a caller who sees to it that nobody else changes
    /// anything meanwhile.
    ///
    /// # Errors
    /// `Knowledge`.
    pub fn refresh_rules(&self, databases: &Databases, id: &str) -> Result<(), Error> {
        let now = self.now();
        if now.bare.0.get(id).is_none() {
            return Ok(());
        }
        let mut rules = now.rules.clone();
        match databases.rules.knowledge_base(id) {
            Ok(knowledge) => drop(rules.insert(id.to_owned(), Arc::new(knowledge))),
            Err(d3dgen_knowledge::Error::NoDomain { .. }) => drop(rules.remove(id)), // taken back
            Err(other) => return Err(other.into()),
        }
        self.replace(&now, now.bare.clone(), rules);
        Ok(())
    }

    /// Makes a new snapshot after assets have changed; for a caller who sees to it that nobody else changes anything meanwhile.
    ///
    /// # Errors
    /// `Store`, `Assets`.
    pub fn refresh_assets(&self, databases: &Databases) -> Result<Arc<Snapshot>, Error> {
        let now = self.now();
        let without = now.bare.1.clone();
        let with = stocked(databases, without.clone(), &now.catalog)?;
        self.replace(&now, (with, without), now.rules.clone());
        Ok(self.now())
    }

    /// Puts a snapshot of the same domains in the place of the one that there is.
    fn replace(&self, now: &Snapshot, bare: (Registry, Registry), rules: BTreeMap<String, Arc<KnowledgeBase>>) {
        let (catalog, registered, words) = (Arc::clone(&now.catalog), now.registered.clone(), Arc::clone(&now.words));
        self.current.store(Arc::new(Snapshot::new(bare, rules, catalog, registered, words)));
    }

    /// Makes a new snapshot after domains have changed.
    ///
    /// # Errors
    /// `Store`, `Knowledge`, `Assets`.
    fn refresh(&self, databases: &Databases) -> Result<(), Error> {
        self.current.store(Arc::new(snapshot(databases, &self.shipped)?));
        Ok(())
    }

    /// Looks at everything about a domain, and changes nothing.
    ///
    /// # Errors
    /// See [`Refusal`].
    pub fn check(&self, domain: &Domain, knowledge: &KnowledgeBase) -> Result<(), Refusal> {
        check(domain, knowledge)
    }

    /// Returns an earlier version of a registered domain.
    ///
    /// # Errors
    /// `Store`; `Record`.
    pub fn version(
        &self,
        databases: &Databases,
        id: &str,
        version: u64,
    ) -> Result<Option<(Entry, Domain, KnowledgeBase)>, Error> {
        let stored: Option<Version> = own::get(&databases.own, DOMAIN_VERSIONS, &version_key(id, version))?;
        Ok(stored.map(|s| (s.entry, s.domain, s.knowledge)))
    }

    /// Returns the versions of a registered domain, oldest first, each with a digest of what was registered.
    ///
    /// # Errors
    /// `Store`; `Record`.
    pub fn versions(&self, databases: &Databases, id: &str) -> Result<Vec<(Entry, String)>, Error> {
        let mut found = Vec::new();
        own::each(&databases.own, DOMAIN_VERSIONS, &KeyRange::prefix(format!("{id}/")), |_, stored: Version| {
            let both = stored.domain.to_json() + &stored.knowledge.to_json();
            found.push((stored.entry, crate::access::hex(&crate::access::digest(both.as_bytes()))));
            Ok(ControlFlow::Continue(()))
        })?;
        Ok(found)
    }

    /// Registers a domain, in place of an earlier version of it. `batch` goes to the disk with it. The caller sees to it
    /// that nobody else changes domains meanwhile.
    ///
    /// # Errors
    /// See [`Refusal`].
    pub fn register(
        &self,
        databases: &Databases,
        domain: Domain,
        knowledge: KnowledgeBase,
        by: &Provenance,
        at_ms: u64,
        also: impl FnOnce(&Entry, &mut Batch),
    ) -> Result<Entry, Refusal> {
        let id = domain.id.clone();
        check(&domain, &knowledge)?;
        let head: Option<Head> = own::get(&databases.own, DOMAINS, &id)?;
        let there = self.now().registered.len();
        if there >= LIMIT && head.as_ref().is_none_or(|h| h.removed) {
            return Err(Refusal::Full);
        }
        let version = head.map_or(1, |h| h.version + 1);
        let entry = Entry { version, by: by.who.clone(), at_ms };
        let stored = Version { entry: entry.clone(), domain, knowledge };
        let mut batch = Batch::new();
        own::put(&mut batch, DOMAINS, &id, &Head { version, removed: false });
        own::put(&mut batch, DOMAIN_VERSIONS, &version_key(&id, version), &stored);
        also(&entry, &mut batch);
        databases.own.apply(batch)?;
        keep_rules(databases, &id, &stored, by)?;
        self.refresh(databases)?;
        Ok(entry)
    }

    /// Removes a registered domain and its rules; its versions and the history of its rules stay. Returns false when there
    /// is none.
    ///
    /// # Errors
    /// `Store`, `Knowledge`.
    pub fn remove(
        &self,
        databases: &Databases,
        id: &str,
        by: &Provenance,
        also: impl FnOnce(&mut Batch),
    ) -> Result<bool, Error> {
        let Some(head) = own::get::<Head>(&databases.own, DOMAINS, id)?.filter(|h| !h.removed) else {
            return Ok(false);
        };
        // The rules first: cut short here, the domain is still there, and registering or removing it again mends it.
        databases.rules.import(&KnowledgeBase::empty(id), false, by)?;
        let mut batch = Batch::new();
        own::put(&mut batch, DOMAINS, id, &Head { removed: true, ..head });
        batch.delete(DOMAIN_RULES, id);
        also(&mut batch);
        databases.own.apply(batch)?;
        self.refresh(databases)?;
        Ok(true)
    }
}

/// Looks at everything about a domain: ids, documents, models of its objects.
fn check(domain: &Domain, knowledge: &KnowledgeBase) -> Result<(), Refusal> {
    if is_shipped(&domain.id) {
        return Err(Refusal::Shipped);
    }
    let mut problems = domain.check();
    if crate::names::id("id", &domain.id).is_err() {
        problems.push(Problem::new("/id", "needs a-z, 0-9 and _, a letter first"));
    }
    // Ids become names of folders and files of worlds.
    for (i, object) in domain.objects.iter().enumerate() {
        if crate::names::id("id", &object.id).is_err() {
            problems.push(Problem::new(format!("/objects/{i}/id"), "needs a-z, 0-9 and _, a letter first"));
        }
    }
    if problems.is_empty() {
        let builds = d3dgen_mesh::builds::problems(domain);
        problems.extend(builds.into_iter().map(|p| Problem::new("/builds", p.to_string())));
    }
    if !problems.is_empty() {
        return Err(Refusal::Problems("domain", problems));
    }
    let mut problems = knowledge.check();
    if knowledge.metadata.domain != domain.id {
        let reason = format!("is `{}`, the domain is `{}`", knowledge.metadata.domain, domain.id);
        problems.push(Problem::new("/metadata/domain", reason));
    }
    if problems.is_empty() { Ok(()) } else { Err(Refusal::Problems("knowledge_base", problems)) }
}

fn version_key(id: &str, version: u64) -> String {
    format!("{id}/{version:010}")
}

/// Returns the registered domains by id.
fn registered(databases: &Databases) -> Result<BTreeMap<String, Version>, Error> {
    let mut heads = Vec::new();
    own::each(&databases.own, DOMAINS, &KeyRange::all(), |id, head: Head| {
        if !head.removed {
            heads.push((id.to_owned(), head.version));
        }
        Ok(ControlFlow::Continue(()))
    })?;
    let mut found = BTreeMap::new();
    for (id, version) in heads {
        let stored: Option<Version> = own::get(&databases.own, DOMAIN_VERSIONS, &version_key(&id, version))?;
        let stored = stored.ok_or_else(|| Error::Domain {
            id: id.clone(),
            reason: format!("its version {version} is not there: restore a backup"),
        })?;
        found.insert(id, stored);
    }
    Ok(found)
}

/// Puts the rules of a version into the database of rules, unless they are there.
fn keep_rules(databases: &Databases, id: &str, version: &Version, by: &Provenance) -> Result<(), Error> {
    let kept: Option<u64> = own::get(&databases.own, DOMAIN_RULES, id)?;
    if kept == Some(version.entry.version) {
        return Ok(());
    }
    databases.rules.import(&version.knowledge, false, by)?;
    let mut batch = Batch::new();
    own::put(&mut batch, DOMAIN_RULES, id, &version.entry.version);
    databases.own.apply(batch)?;
    Ok(())
}

fn bring_shipped(databases: &Databases, shipped: &Registry, by: &Provenance) -> Result<(), Error> {
    let entries = databases.rules.domains()?;
    let is_held = |knowledge: &KnowledgeBase| {
        let entry = entries.iter().find(|e| e.domain == knowledge.metadata.domain);
        entry.is_some_and(|e| e.shipped.as_ref().is_none_or(|d| *d == digest(knowledge)))
    };
    let rules: Vec<&KnowledgeBase> = shipped.iter().map(Plugin::knowledge).filter(|k| !is_held(k)).collect();
    if !rules.is_empty() {
        for change in databases.rules.bring_shipped(&rules, by)? {
            tracing::info!(domain = change.domain, rules = change.added + change.changed, "shipped rules brought in");
        }
    }
    Ok(())
}

fn snapshot(databases: &Databases, shipped: &Registry) -> Result<Snapshot, Error> {
    let mut registry = shipped.clone();
    let mut entries = BTreeMap::new();
    for (id, version) in registered(databases)? {
        entries.insert(id, version.entry);
        registry.add(Arc::new(Custom::of(version.domain, version.knowledge)));
    }
    let mut rules = BTreeMap::new();
    for entry in databases.rules.domains()? {
        // a registration counts as a change, so registered domains have what was amended since
        if entry.changes > 0 && registry.get(&entry.domain).is_some() {
            rules.insert(entry.domain.clone(), Arc::new(databases.rules.knowledge_base(&entry.domain)?));
        }
    }
    let catalog = Arc::new(Catalog::new(registry.iter().map(Plugin::domain)));
    let with = stocked(databases, registry.clone(), &catalog)?;
    Ok(Snapshot::new((with, registry), rules, catalog, entries, Arc::default()))
}

/// Returns domains with the assets of the database in the place of objects of the library.
fn stocked(databases: &Databases, mut registry: Registry, catalog: &Catalog) -> Result<Registry, Error> {
    if !databases.assets.is_empty()?
        && let Some(stock) = Stock::read(&databases.assets, catalog)?
    {
        let stocked: Vec<Domain> = registry.iter().filter_map(|p| stock.stocked(p.domain())).collect();
        for domain in stocked {
            registry.set_domain(domain);
        }
    }
    Ok(registry)
}

#[cfg(test)]
mod tests;
