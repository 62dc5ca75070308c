//! What is asked of a backend: changes that belong together, and ranges of keys.

use std::collections::BTreeMap;
use std::ops::{Bound, RangeBounds};

/// Changes that are stored together or not at all. The last change of a key counts.
#[derive(Debug, Clone, Default)]
pub struct Batch {
    changes: BTreeMap<String, BTreeMap<Vec<u8>, Option<Vec<u8>>>>,
}

impl Batch {
    /// Returns a batch without changes.
    pub fn new() -> Self {
        Self::default()
    }

    /// Stores `value` under `key`, in place of what is there.
    pub fn put(&mut self, table: &str, key: impl Into<Vec<u8>>, value: impl Into<Vec<u8>>) -> &mut Self {
        self.change(table, key.into(), Some(value.into()))
    }

    /// Removes `key`, if it is there.
    pub fn delete(&mut self, table: &str, key: impl Into<Vec<u8>>) -> &mut Self {
        self.change(table, key.into(), None)
    }

    /// How many keys are changed.
    pub fn len(&self) -> usize {
        self.changes.values().map(BTreeMap::len).sum()
    }

    /// Whether nothing is changed.
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// The changes of each table, sorted; `None` removes.
    pub fn tables(&self) -> impl Iterator<Item = (&str, &BTreeMap<Vec<u8>, Option<Vec<u8>>>)> {
        self.changes.iter().map(|(table, changes)| (table.as_str(), changes))
    }

    fn change(&mut self, table: &str, key: Vec<u8>, value: Option<Vec<u8>>) -> &mut Self {
        match self.changes.get_mut(table) {
            Some(changes) => changes.insert(key, value),
            None => self.changes.entry(table.to_owned()).or_default().insert(key, value),
        };
        self
    }
}

/// A range of keys in the order of their bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyRange {
    /// Where it begins.
    pub start: Bound<Vec<u8>>,
    /// Where it ends.
    pub end: Bound<Vec<u8>>,
}

impl KeyRange {
    /// Every key.
    pub fn all() -> Self {
        Self { start: Bound::Unbounded, end: Bound::Unbounded }
    }

    /// The keys that begin with `prefix`.
    pub fn prefix(prefix: impl AsRef<[u8]>) -> Self {
        let prefix = prefix.as_ref();
        // The first key behind them: the prefix with its last byte that can be raised, raised.
        let raised = prefix.iter().rposition(|b| *b < u8::MAX).map(|last| {
            let mut end = prefix[..=last].to_vec();
            end[last] += 1;
            end
        });
        Self { start: Bound::Included(prefix.to_vec()), end: raised.map_or(Bound::Unbounded, Bound::Excluded) }
    }

    /// The same range, beginning behind `key`: how a scan goes on later.
    pub fn after(mut self, key: impl AsRef<[u8]>) -> Self {
        self.start = Bound::Excluded(key.as_ref().to_vec());
        self
    }

    /// The same range, beginning with `key`.
    pub fn from(mut self, key: impl AsRef<[u8]>) -> Self {
        self.start = Bound::Included(key.as_ref().to_vec());
        self
    }

    /// The same range, ending before `key`.
    pub fn until(mut self, key: impl AsRef<[u8]>) -> Self {
        self.end = Bound::Excluded(key.as_ref().to_vec());
        self
    }

    /// Whether `key` lies in it.
    pub fn contains(&self, key: &[u8]) -> bool {
        RangeBounds::<[u8]>::contains(&self.bounds(), key)
    }

    /// Whether no key can lie in it; backends differ in how they take such a range, so they are not asked.
    pub fn is_empty(&self) -> bool {
        use Bound::{Excluded, Included};
        match (&self.start, &self.end) {
            (Included(start), Included(end)) => start > end,
            (Included(start), Excluded(end)) | (Excluded(start), Included(end) | Excluded(end)) => start >= end,
            _ => false,
        }
    }

    /// Start and end as borrowed bytes.
    pub(super) fn bounds(&self) -> (Bound<&[u8]>, Bound<&[u8]>) {
        (self.start.as_ref().map(Vec::as_slice), self.end.as_ref().map(Vec::as_slice))
    }
}
