//! Changes of the database: what differs between two knowledge bases, by whom, when and why it was changed.

use std::collections::BTreeMap;

use d3dgen_model::knowledge::{Constraint, KnowledgeBase, Reference};
use serde::{Deserialize, Serialize};

/// Who changes the database, when and why; the clock and the user's name come from outside.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// Name of the person or program.
    pub who: String,
    /// Date and time in UTC, `2026-11-21T14:13:00Z`.
    pub when: String,
    /// Reason, in a sentence.
    pub why: String,
}

/// What sort of change it was.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The rules shipped with a release.
    Shipped,
    /// A knowledge base from a file.
    Import,
    /// A reviewed change of single rules.
    Amend,
    /// The opposite of an earlier change.
    Undo,
}

impl Kind {
    /// Returns the name that tables show.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shipped => "shipped",
            Self::Import => "import",
            Self::Amend => "amend",
            Self::Undo => "undo",
        }
    }
}

/// One change, as `history` lists it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Change {
    /// Number, from 1.
    pub seq: u64,
    /// What sort.
    pub kind: Kind,
    /// Domain it concerns.
    pub domain: String,
    /// By whom, when, why.
    #[serde(flatten)]
    pub provenance: Provenance,
    /// Rules and documents that are new.
    pub added: u64,
    /// Those that are other than before.
    pub changed: u64,
    /// Those that are gone.
    pub removed: u64,
    /// True when the domain was not there before.
    pub created_domain: bool,
    /// The change that this one takes back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undoes: Option<u64>,
    /// The change that took this one back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undone_by: Option<u64>,
}

/// A reference or a constraint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Entry {
    /// A document, its list of constraints left empty.
    Reference(Reference),
    /// A rule with the id of its document.
    Constraint(String, Box<Constraint>),
}

/// What an edit is about.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// A document by its id.
    Reference(String),
    /// A rule by its id.
    Constraint(String),
}

impl Target {
    /// Returns the id.
    pub fn id(&self) -> &str {
        match self {
            Self::Reference(id) | Self::Constraint(id) => id,
        }
    }
}

/// The difference in one reference or constraint: added without `before`, removed without `after`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Edit {
    /// What it is about.
    pub target: Target,
    /// As it was.
    pub before: Option<Entry>,
    /// As it is to be.
    pub after: Option<Entry>,
}

/// One field that differs, for people to review.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FieldChange {
    /// Name of the field; `added` or `removed` for whole entries.
    pub field: String,
    /// Its value before, as JSON; empty when there was none.
    pub before: String,
    /// Its value after.
    pub after: String,
}

impl Edit {
    /// Returns the fields that differ, in the order of the document.
    pub fn fields(&self) -> Vec<FieldChange> {
        let json = |entry: &Option<Entry>| match entry {
            Some(Entry::Reference(r)) => serde_json::to_value(r).unwrap_or_default(),
            Some(Entry::Constraint(ref_id, c)) => {
                let mut value = serde_json::to_value(c).unwrap_or_default();
                value["ref_id"] = ref_id.as_str().into();
                value
            }
            None => serde_json::Value::Null,
        };
        let (before, after) = (json(&self.before), json(&self.after));
        let mut names: Vec<&String> =
            [&before, &after].into_iter().filter_map(|v| v.as_object()).flat_map(|o| o.keys()).collect();
        let mut seen = std::collections::BTreeSet::new();
        names.retain(|n| n.as_str() != "constraints" && seen.insert((*n).clone()));
        let shown = |value: Option<&serde_json::Value>| value.map(ToString::to_string).unwrap_or_default();
        let changes = names.into_iter().map(|name| FieldChange {
            field: name.clone(),
            before: shown(before.get(name)),
            after: shown(after.get(name)),
        });
        changes.filter(|c| c.before != c.after).collect()
    }
}

/// Returns what has to be done to `before` to get `after`: documents first, each group in the order of the files.
///
/// With `keep`, what `after` does not hold stays as it is.
pub fn difference(before: &KnowledgeBase, after: &KnowledgeBase, keep: bool) -> Vec<Edit> {
    let (old, new) = (entries(before), entries(after));
    let was: BTreeMap<&Target, &Entry> = old.iter().map(|(t, e)| (t, e)).collect();
    let is: BTreeMap<&Target, &Entry> = new.iter().map(|(t, e)| (t, e)).collect();
    let mut edits: Vec<Edit> = Vec::new();
    for (target, entry) in &new {
        let before = was.get(target).copied();
        if before != Some(entry) {
            edits.push(Edit { target: target.clone(), before: before.cloned(), after: Some(entry.clone()) });
        }
    }
    for (target, entry) in old.iter().filter(|(t, _)| !keep && !is.contains_key(t)) {
        edits.push(Edit { target: target.clone(), before: Some(entry.clone()), after: None });
    }
    edits
}

/// Makes edits in a knowledge base; new entries come last.
pub fn apply(knowledge: &mut KnowledgeBase, edits: &[Edit]) {
    for edit in edits {
        let id = edit.target.id();
        match (&edit.target, &edit.after) {
            (Target::Reference(_), Some(Entry::Reference(new))) => {
                match knowledge.references.iter_mut().find(|r| r.ref_id == id) {
                    Some(old) => *old = Reference { constraints: std::mem::take(&mut old.constraints), ..new.clone() },
                    None => knowledge.references.push(new.clone()),
                }
            }
            (Target::Constraint(_), Some(Entry::Constraint(ref_id, new))) => {
                for reference in &mut knowledge.references {
                    let old = reference.constraints.iter().position(|c| c.constraint_id == id);
                    match (old, reference.ref_id == *ref_id) {
                        (Some(at), true) => reference.constraints[at] = (**new).clone(),
                        (Some(at), false) => drop(reference.constraints.remove(at)),
                        (None, true) => reference.constraints.push((**new).clone()),
                        (None, false) => {}
                    }
                }
            }
            (Target::Reference(_), _) => knowledge.references.retain(|r| r.ref_id != id),
            (Target::Constraint(_), _) => {
                knowledge.references.iter_mut().for_each(|r| r.constraints.retain(|c| c.constraint_id != id));
            }
        }
    }
}

/// Returns all references, then all constraints.
fn entries(knowledge: &KnowledgeBase) -> Vec<(Target, Entry)> {
    let references = knowledge.references.iter().map(|r| {
        let head = Reference { constraints: Vec::new(), ..r.clone() };
        (Target::Reference(r.ref_id.clone()), Entry::Reference(head))
    });
    let constraints = knowledge.references.iter().flat_map(|r| {
        r.constraints.iter().map(|c| {
            (Target::Constraint(c.constraint_id.clone()), Entry::Constraint(r.ref_id.clone(), Box::new(c.clone())))
        })
    });
    references.chain(constraints).collect()
}
