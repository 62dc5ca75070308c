//! Keys, facets and numbers of all rows, kept in memory: they answer filters without touching the other indexes.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::document::{Document, IndexSpec, known};
use super::filter::Filter;
use super::row_set::RowSet;
use crate::error::{Error, Result};

/// One row a document, in the order of the keys.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Columns {
    keys: Vec<String>,
    /// For each facet and value the rows that have it, ascending.
    facets: BTreeMap<String, BTreeMap<String, Vec<u32>>>,
    /// For each number one value a row; not a number where the document has none.
    numbers: BTreeMap<String, Vec<f64>>,
}

impl Columns {
    pub(crate) fn new(spec: &IndexSpec) -> Self {
        Self {
            keys: Vec::new(),
            facets: spec.facets.iter().map(|f| (f.clone(), BTreeMap::new())).collect(),
            numbers: spec.numbers.iter().map(|n| (n.clone(), Vec::new())).collect(),
        }
    }

    /// Adds a document as the last row.
    pub(crate) fn push(&mut self, document: Document) {
        let row = self.rows();
        self.keys.push(document.key);
        for (name, values) in document.facets {
            let Some(column) = self.facets.get_mut(&name) else { continue };
            for value in values {
                let rows = column.entry(value).or_default();
                if rows.last() != Some(&row) {
                    rows.push(row);
                }
            }
        }
        for (name, column) in &mut self.numbers {
            column.push(document.numbers.get(name).copied().unwrap_or(f64::NAN));
        }
    }

    /// Brings the rows into the order of their keys, and returns for each old row its new one.
    ///
    /// # Errors
    /// [`Error::Index`] when two rows have one key.
    pub(crate) fn sort_by_key(&mut self) -> Result<Vec<u32>> {
        let mut order: Vec<u32> = (0..self.rows()).collect();
        order.sort_by(|a, b| self.key(*a).cmp(&self.key(*b)));
        let mut places = vec![0; order.len()];
        for (place, row) in (0..).zip(&order) {
            if let Some(cell) = places.get_mut(*row as usize) {
                *cell = place;
            }
        }
        self.keys.sort();
        if let Some([twice, _]) = self.keys.array_windows().find(|[a, b]| a == b) {
            return Err(Error::Index { what: format!("two documents have the key {twice}") });
        }
        for rows in self.facets.values_mut().flat_map(BTreeMap::values_mut) {
            rows.iter_mut().for_each(|row| *row = places.get(*row as usize).copied().unwrap_or_default());
            rows.sort_unstable();
            rows.shrink_to_fit();
        }
        for column in self.numbers.values_mut() {
            *column = order.iter().map(|row| column.get(*row as usize).copied().unwrap_or(f64::NAN)).collect();
        }
        Ok(places)
    }

    pub(crate) fn rows(&self) -> u32 {
        u32::try_from(self.keys.len()).unwrap_or(u32::MAX)
    }

    pub(crate) fn key(&self, row: u32) -> Option<&str> {
        self.keys.get(row as usize).map(String::as_str)
    }

    /// Returns the row of a key.
    pub(crate) fn row(&self, key: &str) -> Option<u32> {
        let place = self.keys.binary_search_by(|k| k.as_str().cmp(key)).ok()?;
        u32::try_from(place).ok()
    }

    /// Returns each value of a facet with how many rows have it, beside those that are gone.
    pub(crate) fn counts(&self, facet: &str, gone: Option<&RowSet>) -> Option<BTreeMap<String, usize>> {
        let there =
            |rows: &Vec<u32>| gone.map_or(rows.len(), |gone| rows.iter().filter(|r| !gone.contains(**r)).count());
        let counts = self.facets.get(facet)?.iter().map(|(value, rows)| (value.clone(), there(rows)));
        Some(counts.filter(|(_, count)| *count > 0).collect())
    }

    /// Returns the rows that fulfill a filter.
    ///
    /// # Errors
    /// [`Error::UnknownField`](crate::Error::UnknownField) when it names a facet or number that the index does not have.
    pub(crate) fn matching(&self, filter: &Filter) -> Result<RowSet> {
        Ok(match filter {
            Filter::Everything => RowSet::all(self.rows()),
            Filter::Facet { name, any_of } => {
                known("facet", [name].into_iter(), &self.facets.keys().collect::<Vec<_>>())?;
                let column = self.facets.get(name).into_iter();
                let mut set = RowSet::none(self.rows());
                let rows = column.flat_map(|column| any_of.iter().filter_map(|value| column.get(value))).flatten();
                rows.for_each(|&row| set.insert(row));
                set
            }
            Filter::Number { name, min, max } => {
                known("number", [name].into_iter(), &self.numbers.keys().collect::<Vec<_>>())?;
                let mut set = RowSet::none(self.rows());
                let inside = |x: f64| !x.is_nan() && min.is_none_or(|min| x >= min) && max.is_none_or(|max| x <= max);
                let rows = (0..).zip(self.numbers.get(name).into_iter().flatten());
                rows.filter(|(_, x)| inside(**x)).for_each(|(row, _)| set.insert(row));
                set
            }
            Filter::All(filters) => {
                let mut set = RowSet::all(self.rows());
                for filter in filters {
                    set.intersect(&self.matching(filter)?);
                }
                set
            }
            Filter::Any(filters) => {
                let mut set = RowSet::none(self.rows());
                for filter in filters {
                    set.unite(&self.matching(filter)?);
                }
                set
            }
            Filter::Not(filter) => {
                let mut set = self.matching(filter)?;
                set.invert();
                set
            }
        })
    }
}
