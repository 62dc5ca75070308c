//! Finding rules by words, by meaning and by filters.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::sync::Arc;

use d3dgen_model::domain::Domain;
use d3dgen_model::knowledge::{Constraint, Reference, Source, Value};
use d3dgen_store::KeyRange;
use d3dgen_store::embed::Embedder;
use d3dgen_store::index::{Document, Filter, Hit, Index, IndexSpec, Mode, Reason, Watch};

use super::change::{Edit, Target};
use super::records::{CONSTRAINTS, ConstraintRecord, REFERENCES, ReferenceRecord, decode, each, get, key};
use super::{Damage, Database};
use crate::error::Error;
use crate::phrase;
use crate::tables::{SpaceKind, TABLES};

/// Facets to filter by; also the names of the filters.
const FACETS: [&str; 10] = [
    "domain",
    "jurisdiction",
    "topic",
    "space_type",
    "constraint_type",
    "unit",
    "confidence",
    "source_type",
    "verified",
    "ref_id",
];
const VALUE: &str = "value";

/// What to find.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SearchQuery {
    /// Words; empty lists everything that the filters leave, in the order of ids.
    pub text: String,
    /// Values by filter name ([`filter_names`]): one of the values of each must hold.
    pub filters: BTreeMap<String, BTreeSet<String>>,
    /// Least and largest figure in SI units, ends included.
    pub value: (Option<f64>, Option<f64>),
    /// Most rules to return.
    pub limit: usize,
    /// By words, by meaning, or both.
    pub mode: Mode,
}

/// A rule that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Domain it is of.
    pub domain: String,
    /// Where it applies.
    pub jurisdiction: String,
    /// Document it is of.
    pub ref_id: String,
    /// Its first source.
    pub source: Option<Source>,
    /// The rule.
    pub constraint: Constraint,
    /// How well it fits, see [`Hit`].
    pub hit: Hit,
    /// Keys of the same rule in other domains.
    pub copies: Vec<String>,
}

/// The database with its index open.
pub struct Searcher {
    database: Database,
    index: Index,
    /// Why the index was made anew, if it was.
    pub rebuilt: Option<Reason>,
    /// Why the index could not be kept, if so.
    pub unsaved: Option<String>,
    /// Records that are damaged and were left out.
    pub damaged: Vec<Damage>,
}

/// Returns the names of the filters.
pub fn filter_names() -> &'static [&'static str] {
    &FACETS
}

impl Searcher {
    /// Opens the index of a database, made anew when it is missing, stale, damaged or of another embedder.
    ///
    /// # Errors
    /// `Store`: cancelled, or not readable.
    pub fn open(database: &Database, embedder: Arc<dyn Embedder>, watch: Watch<'_>) -> Result<Self, Error> {
        let dir = database.store.index_dir().join(CONSTRAINTS);
        let view = database.store.view()?;
        let mut damaged = Vec::new();
        let documents = || {
            let (documents, problems) = documents(&view)?;
            damaged = problems;
            Ok::<_, Error>(documents)
        };
        let opened = Index::open_or_rebuild(&dir, &spec(), embedder, view.revision()?, documents, watch)?;
        drop(view);
        Ok(Self {
            database: database.clone(),
            index: opened.index,
            rebuilt: opened.rebuilt,
            unsaved: opened.unsaved.map(|e| e.to_string()),
            damaged,
        })
    }

    /// Returns the searcher after a change of one domain, without making the index anew; none when too much has changed since
    /// it was made.
    ///
    /// # Errors
    /// `Store`, also when a changed rule is damaged.
    pub fn after(&self, domain: &str, edits: &[Edit]) -> Result<Option<Self>, Error> {
        let view = self.database.store.view()?;
        let (mut keys, mut documents) = (BTreeSet::new(), BTreeSet::new());
        for edit in edits {
            match &edit.target {
                Target::Constraint(id) => drop(keys.insert(key(domain, id))),
                Target::Reference(id) => drop(documents.insert(id.as_str())),
            }
        }
        if !documents.is_empty() {
            // the rules of a document are found by its source and by where it applies
            each(&view, CONSTRAINTS, &KeyRange::prefix(format!("{domain}/")), |at, record: ConstraintRecord| {
                if documents.contains(record.ref_id.as_str()) {
                    keys.insert(at.to_owned());
                }
                Ok(())
            })?;
        }
        let mut changes = Vec::with_capacity(keys.len());
        for at in keys {
            let record: Option<ConstraintRecord> = get(&view, CONSTRAINTS, &at)?;
            let now = record.map(|record| {
                let reference = get::<ReferenceRecord>(&view, REFERENCES, &key(domain, &record.ref_id))?;
                Ok::<_, Error>(document(&at, domain, &record, reference.map(|r| r.reference).as_ref()))
            });
            changes.push((at.clone(), now.transpose()?));
        }
        let index = self.index.changed(&spec(), view.revision()?, changes)?;
        let database = self.database.clone();
        Ok(index.map(|index| Self { database, index, rebuilt: None, unsaved: None, damaged: Vec::new() }))
    }

    /// Returns the revision of the database that it finds.
    pub fn revision(&self) -> u64 {
        self.index.revision()
    }

    /// Returns the rules that fit, best first.
    ///
    /// # Errors
    /// `Input` for a filter that is none; `Store`, also when a rule found is damaged: it is never served.
    pub fn search(&self, query: &SearchQuery) -> Result<Vec<Found>, Error> {
        let mut filter = Filter::default();
        for (name, values) in &query.filters {
            if !FACETS.contains(&name.as_str()) {
                return Err(Error::Input(format!("`{name}` is no filter; there are {}", FACETS.join(", "))));
            }
            filter = filter.and(Filter::facet(name, values));
        }
        if let (least, most) = query.value
            && (least.is_some() || most.is_some())
        {
            filter = filter.and(Filter::number(VALUE, least, most));
        }
        let hits = self.index.search(&query.text, &filter, query.limit, query.mode)?;
        let view = self.database.store.view()?;
        let mut found = Vec::with_capacity(hits.len());
        for hit in hits {
            // a rule that was removed since the index was opened is not there any more
            let Some(record) = get::<ConstraintRecord>(&view, CONSTRAINTS, &hit.key)? else { continue };
            let domain = hit.key.split('/').next().unwrap_or_default().to_owned();
            let reference =
                get::<ReferenceRecord>(&view, REFERENCES, &key(&domain, &record.ref_id))?.map(|r| r.reference);
            let source = reference.as_ref().and_then(|r| first_source(&record.constraint, r)).cloned();
            let jurisdiction = reference.map(|r| r.jurisdiction).unwrap_or_default();
            found.push(Found {
                domain,
                jurisdiction,
                ref_id: record.ref_id,
                source,
                constraint: record.constraint,
                hit,
                copies: Vec::new(),
            });
        }
        Ok(found)
    }

    /// Returns the index below.
    pub(super) fn index(&self) -> &Index {
        &self.index
    }

    /// Returns the values of a filter with how many rules have each.
    pub fn values(&self, filter: &str) -> BTreeMap<String, usize> {
        self.index.facet_counts(filter).unwrap_or_default()
    }

    /// Returns the space names under which the database speaks of a room type.
    pub fn spaces_of(&self, room_type: &str, domain: &Domain) -> BTreeSet<String> {
        let own = domain.room_type(room_type).map(|t| t.spaces.as_slice()).unwrap_or_default();
        let covers = |space: &String| {
            space == room_type
                || own.contains(space)
                || TABLES
                    .space(space, &domain.id)
                    .is_some_and(|row| row.kind == SpaceKind::Rooms && row.room_types.iter().any(|t| t == room_type))
        };
        let mut found: BTreeSet<String> = self.values("space_type").into_keys().filter(covers).collect();
        found.insert(room_type.to_owned());
        found
    }
}

fn spec() -> IndexSpec {
    IndexSpec::default()
        .field("space", 3.0)
        .field("name", 2.0)
        .field("rule", 1.0)
        .field("source", 1.0)
        .facets(&FACETS)
        .numbers(&[VALUE])
}

/// Returns a document for each rule, and the damaged records, which have none.
fn documents(view: &d3dgen_store::View<'_>) -> Result<(Vec<Document>, Vec<Damage>), Error> {
    let mut references: BTreeMap<String, Reference> = BTreeMap::new();
    let mut problems = view.scan_sound(REFERENCES, &KeyRange::all(), |key, payload| {
        references.insert(key.to_owned(), decode::<ReferenceRecord>(REFERENCES, key, payload)?.reference);
        Ok::<_, Error>(ControlFlow::Continue(()))
    })?;
    let mut documents = Vec::new();
    problems.extend(view.scan_sound(CONSTRAINTS, &KeyRange::all(), |at, payload| {
        let record: ConstraintRecord = decode(CONSTRAINTS, at, payload)?;
        let domain = at.split('/').next().unwrap_or_default();
        documents.push(document(at, domain, &record, references.get(&key(domain, &record.ref_id))));
        Ok::<_, Error>(ControlFlow::Continue(()))
    })?);
    let damage = problems
        .into_iter()
        .map(|p| Damage { place: format!("{} {}", p.table, p.key.unwrap_or_default()), reason: p.reason });
    Ok((documents, damage.collect()))
}

fn document(at: &str, domain: &str, record: &ConstraintRecord, reference: Option<&Reference>) -> Document {
    let c = &record.constraint;
    let source = reference.and_then(|r| first_source(c, r));
    let cited = source.map(|s| format!("{} {} {}", s.title, s.publisher, s.edition_or_year)).unwrap_or_default();
    let rule = phrase::sentence(c);
    let texts = [
        ("space", c.space_type.replace('_', " ")),
        ("name", format!("{} {}", c.name.replace('_', " "), c.constraint_id)),
        ("rule", format!("{rule} {}", c.note)),
        ("source", cited.clone()),
    ];
    let facets = [
        ("domain", domain),
        ("jurisdiction", reference.map_or("", |r| r.jurisdiction.as_str())),
        ("topic", &c.topic),
        ("space_type", &c.space_type),
        ("constraint_type", &c.constraint_type),
        ("unit", &c.unit),
        ("confidence", &c.confidence),
        ("source_type", source.map_or("", |s| s.source_type.as_str())),
        ("verified", &c.verified),
        ("ref_id", &record.ref_id),
    ];
    Document {
        key: at.to_owned(),
        texts: texts.map(|(name, text)| (name.to_owned(), text)).into(),
        facets: facets.map(|(name, value)| (name.to_owned(), vec![value.to_owned()])).into(),
        numbers: figure(&c.value).map(|v| (VALUE.to_owned(), v)).into_iter().collect(),
        embed_text: format!("{rule}. {}", c.topic.replace('_', " ")),
    }
}

/// Returns the one figure a filter by value compares: the number, or the lower end of a range.
fn figure(value: &Value) -> Option<f64> {
    match value {
        Value::Number(v) => Some(*v),
        Value::Range { min, .. } => Some(*min),
        _ => None,
    }
}

fn first_source<'a>(c: &Constraint, reference: &'a Reference) -> Option<&'a Source> {
    c.source_ids.iter().find_map(|id| reference.sources.iter().find(|s| &s.source_id == id))
}
