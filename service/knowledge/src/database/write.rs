//! Changes going in: each is one batch, stored whole or not at all, together with its entry in the history.

use d3dgen_model::Document;
use d3dgen_model::knowledge::{KnowledgeBase, Reference};
use d3dgen_store::{Batch, View};
use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};

use super::Database;
use super::change::{Change, Edit, Entry, Kind, Provenance, Target, difference};
use super::records::{
    CHANGES, CONSTRAINTS, ConstraintRecord, DOMAINS, DomainRecord, EDITS, REFERENCES, ReferenceRecord, Stored, encode,
    get, key,
};
use crate::error::Error;

/// Edits kept in one record of the history.
const PAGE: usize = 200;

/// Returns the digest of a knowledge base: another one means another release.
pub fn digest(knowledge: &KnowledgeBase) -> String {
    HEXLOWER.encode(&Sha256::digest(knowledge.to_json())[..16])
}

/// A change about to be stored.
struct Draft<'a> {
    kind: Kind,
    provenance: &'a Provenance,
    edits: Vec<Edit>,
    undoes: Option<u64>,
}

pub(super) fn seq_key(seq: u64) -> String {
    format!("{seq:010}")
}

impl Database {
    /// Stores a knowledge base. With `keep`, what the database holds of the domain beside it stays; otherwise the domain
    /// holds exactly this afterwards. Returns `None` when there is nothing to do.
    ///
    /// # Errors
    /// `Breaks` when what results breaks the rules of knowledge bases; `Store`.
    pub fn import(&self, knowledge: &KnowledgeBase, keep: bool, by: &Provenance) -> Result<Option<Change>, Error> {
        let domain = &knowledge.metadata.domain;
        let stored = Stored::read(&self.store.view()?, domain)?;
        let before = stored.as_ref().map_or_else(|| KnowledgeBase::empty(domain), Stored::assemble);
        let edits = difference(&before, knowledge, keep);
        if edits.is_empty() && stored.is_some() {
            return Ok(None);
        }
        let created = stored.is_none();
        let mut stored = stored.unwrap_or_else(|| fresh(knowledge));
        if created || !keep {
            stored.domain.metadata = knowledge.metadata.clone();
        }
        self.write(stored, created, Draft { kind: Kind::Import, provenance: by, edits, undoes: None }).map(Some)
    }

    /// Brings the shipped knowledge bases into the database: new ones, and newer texts of those it has. Rules that were
    /// changed here keep their change.
    ///
    /// # Errors
    /// `Store`.
    pub fn bring_shipped(&self, shipped: &[&KnowledgeBase], by: &Provenance) -> Result<Vec<Change>, Error> {
        let mut changes = Vec::new();
        for &knowledge in shipped {
            let digest = digest(knowledge);
            let stored = Stored::read(&self.store.view()?, &knowledge.metadata.domain)?;
            let created = stored.is_none();
            let mut stored = match stored {
                Some(stored) if stored.domain.shipped.as_deref().is_none_or(|d| d == digest) => continue,
                Some(stored) => stored,
                None => fresh(knowledge),
            };
            let history = self.history()?;
            let is_shipped = |seq: u64| history.iter().any(|c| c.seq == seq && c.kind == Kind::Shipped);
            let untouched = |edit: &Edit| match &edit.target {
                Target::Reference(id) => stored.references.get(id).is_none_or(|r| is_shipped(r.change)),
                Target::Constraint(id) => stored.constraints.get(id).is_none_or(|c| is_shipped(c.change)),
            };
            let mut edits = difference(&stored.assemble(), knowledge, false);
            edits.retain(untouched);
            stored.domain.shipped = Some(digest);
            stored.domain.metadata = knowledge.metadata.clone();
            changes.push(self.write(
                stored,
                created,
                Draft { kind: Kind::Shipped, provenance: by, edits, undoes: None },
            )?);
        }
        Ok(changes)
    }

    /// Applies reviewed edits to a domain. The `before` of each edit must be what the database holds.
    ///
    /// # Errors
    /// `NoDomain`; `Outdated` when the domain was changed since the edits were made; `Breaks`; `Input` without edits.
    pub fn amend(&self, domain: &str, edits: Vec<Edit>, by: &Provenance) -> Result<Change, Error> {
        if edits.is_empty() {
            return Err(Error::Input("there is nothing to change".into()));
        }
        let Some(stored) = Stored::read(&self.store.view()?, domain)? else { return Err(self.no_domain(domain)) };
        if edits.iter().any(|edit| held(&stored, &edit.target) != edit.before) {
            return Err(Error::Outdated { domain: domain.into() });
        }
        self.write(stored, false, Draft { kind: Kind::Amend, provenance: by, edits, undoes: None })
    }

    /// Takes a change back: everything it touched is as before it.
    ///
    /// # Errors
    /// `NoChange`; `NotUndoable` when a later change touched the same, when it is undone already, or for shipped rules.
    pub fn undo(&self, seq: u64, by: &Provenance) -> Result<Change, Error> {
        let refused = |reason: String| Error::NotUndoable { seq, reason };
        let mut change = get::<Change>(&self.store.view()?, CHANGES, &seq_key(seq))?.ok_or(Error::NoChange { seq })?;
        match (change.kind, change.undone_by) {
            (_, Some(later)) => return Err(refused(format!("change {later} has done it already"))),
            (Kind::Shipped, _) => {
                return Err(refused("the rules shipped with a release are changed by `amend`".into()));
            }
            (Kind::Undo, _) => return Err(refused("make the change again instead".into())),
            _ => {}
        }
        let edits = self.edits(seq)?;
        let Some(mut stored) = Stored::read(&self.store.view()?, &change.domain)? else {
            return Err(self.no_domain(&change.domain));
        };
        for edit in &edits {
            let last = match &edit.target {
                Target::Reference(id) => stored.references.get(id).map(|r| r.change),
                Target::Constraint(id) => stored.constraints.get(id).map(|c| c.change),
            };
            let removed = edit.after.is_none();
            if last.is_some_and(|last| removed || last != seq) || last.is_none() && !removed {
                let later = last.map_or("a later change removed it".into(), |l| format!("change {l} touched it later"));
                return Err(refused(format!("{}: {later}; undo that first", edit.target.id())));
            }
        }
        let inverse: Vec<Edit> =
            edits.into_iter().map(|e| Edit { target: e.target, before: e.after, after: e.before }).collect();
        let whole_domain = change.created_domain && stored.references.len() + stored.constraints.len() == inverse.len();
        stored.domain.changes = stored.domain.changes.saturating_sub(2); // of the change, and of this one to come
        let draft = Draft { kind: Kind::Undo, provenance: by, edits: inverse, undoes: Some(seq) };
        let (mut batch, undo) = self.prepare(stored, false, draft)?;
        if whole_domain {
            batch.delete(DOMAINS, change.domain.as_str());
        }
        change.undone_by = Some(undo.seq);
        batch.put(CHANGES, seq_key(seq), encode(&change));
        self.store.apply(batch)?;
        Ok(undo)
    }

    fn write(&self, stored: Stored, created: bool, draft: Draft<'_>) -> Result<Change, Error> {
        let (batch, change) = self.prepare(stored, created, draft)?;
        self.store.apply(batch)?;
        Ok(change)
    }

    /// Returns the batch that makes a change, and the change as the history will have it.
    fn prepare(&self, mut stored: Stored, created: bool, draft: Draft<'_>) -> Result<(Batch, Change), Error> {
        let Draft { kind, provenance, edits, undoes } = draft;
        let domain = stored.domain.metadata.domain.clone();
        let view = self.store.view()?;
        let seq = next_seq(&view)?;
        let earlier = undoes.map(|undone| self.changes_before(&edits, undone)).transpose()?;
        let mut change = Change {
            seq,
            kind,
            domain: domain.clone(),
            provenance: provenance.clone(),
            added: 0,
            changed: 0,
            removed: 0,
            created_domain: created,
            undoes,
            undone_by: None,
        };
        let mut batch = Batch::new();
        for (n, edit) in edits.iter().enumerate() {
            match (&edit.before, &edit.after) {
                (None, _) => change.added += 1,
                (_, None) => change.removed += 1,
                _ => change.changed += 1,
            }
            let by = earlier.as_ref().and_then(|e| e.get(n).copied()).unwrap_or(seq);
            put(&mut stored, &mut batch, &domain, edit, by);
        }
        if kind != Kind::Shipped {
            stored.domain.changes += 1;
        }
        let problems = stored.assemble().check();
        if !problems.is_empty() {
            return Err(Error::Breaks { domain, problems });
        }
        batch.put(DOMAINS, domain.as_str(), encode(&stored.domain));
        batch.put(CHANGES, seq_key(seq), encode(&change));
        for (n, page) in edits.chunks(PAGE).enumerate() {
            batch.put(EDITS, format!("{}/{n:06}", seq_key(seq)), encode(&page));
        }
        Ok((batch, change))
    }

    /// Returns for each edit of an undo the change that the restored entry was last written by.
    fn changes_before(&self, edits: &[Edit], undone: u64) -> Result<Vec<u64>, Error> {
        let mut by: std::collections::BTreeMap<Target, u64> = Default::default();
        for change in
            self.history()?.into_iter().filter(|c| c.seq < undone && c.undone_by.is_none() && c.kind != Kind::Undo)
        {
            by.extend(self.edits(change.seq)?.into_iter().map(|e| (e.target, change.seq)));
        }
        Ok(edits.iter().map(|e| by.get(&e.target).copied().unwrap_or(undone)).collect())
    }
}

/// Returns a domain that holds nothing yet.
fn fresh(knowledge: &KnowledgeBase) -> Stored {
    let domain = DomainRecord { metadata: knowledge.metadata.clone(), shipped: None, changes: 0, next_place: 0 };
    Stored { domain, references: Default::default(), constraints: Default::default() }
}

/// Returns what the database holds of a target.
fn held(stored: &Stored, target: &Target) -> Option<Entry> {
    match target {
        Target::Reference(id) => stored.references.get(id).map(|r| Entry::Reference(r.reference.clone())),
        Target::Constraint(id) => {
            stored.constraints.get(id).map(|c| Entry::Constraint(c.ref_id.clone(), Box::new(c.constraint.clone())))
        }
    }
}

/// Makes an edit in what is stored of a domain, and in the batch.
fn put(stored: &mut Stored, batch: &mut Batch, domain: &str, edit: &Edit, change: u64) {
    let id = edit.target.id();
    let place = |old: Option<u64>, next: &mut u64| {
        old.unwrap_or_else(|| {
            *next += 1;
            *next
        })
    };
    match (&edit.target, &edit.after) {
        (Target::Reference(_), Some(Entry::Reference(reference))) => {
            let place = place(stored.references.get(id).map(|r| r.place), &mut stored.domain.next_place);
            let reference = Reference { constraints: Vec::new(), ..reference.clone() };
            let record = ReferenceRecord { place, change, reference };
            batch.put(REFERENCES, key(domain, id), encode(&record));
            stored.references.insert(id.to_owned(), record);
        }
        (Target::Constraint(_), Some(Entry::Constraint(ref_id, constraint))) => {
            let place = place(stored.constraints.get(id).map(|c| c.place), &mut stored.domain.next_place);
            let record = ConstraintRecord { place, change, ref_id: ref_id.clone(), constraint: (**constraint).clone() };
            batch.put(CONSTRAINTS, key(domain, id), encode(&record));
            stored.constraints.insert(id.to_owned(), record);
        }
        (Target::Reference(_), _) => {
            batch.delete(REFERENCES, key(domain, id));
            stored.references.remove(id);
        }
        (Target::Constraint(_), _) => {
            batch.delete(CONSTRAINTS, key(domain, id));
            stored.constraints.remove(id);
        }
    }
}

fn next_seq(view: &View<'_>) -> Result<u64, Error> {
    // numbers are never given twice: changes are not removed
    Ok(view.count(CHANGES)? + 1)
}
