//! Reading: single records, ranges, and iterators over an unchanging sight of the store.

use std::cell::RefCell;
use std::ops::ControlFlow;

use super::envelope;
use super::state;
use super::store::Store;
use super::verify::Problem;
use crate::error::{Error, Result};
use crate::kv::{self, KeyRange};

/// A key and its payload.
pub type Record = (String, Vec<u8>);

/// How many records, and bytes of them, an iterator reads ahead.
const PAGE: (usize, usize) = (256, 1 << 20);

/// What is wrong with a key that lies before its predecessor.
pub(super) const OUT_OF_ORDER: &str = "it is out of order";

thread_local! {
    /// Which stores this thread is reading, by [`Store::id`].
    static READING: RefCell<Vec<usize>> = const { RefCell::new(Vec::new()) };
}

/// Whether this thread holds a view of that store.
pub(super) fn is_reading(id: usize) -> bool {
    READING.with_borrow(|reading| reading.contains(&id))
}

/// The records as they were when the view was taken, however they are changed meanwhile.
///
/// Take one to read several things that must fit each other, and drop it soon: with `sled`, writers wait for it. The
/// thread that holds it cannot change the store ([`Error::StillReading`]).
pub struct View<'a> {
    records: Box<dyn kv::View + 'a>,
    _reading: Reading,
}

impl<'a> View<'a> {
    pub(super) fn new(store: &'a Store, records: Box<dyn kv::View + 'a>) -> Self {
        Self { records, _reading: Reading::new(store.id()) }
    }

    /// Returns the payload of `key`, if there is such a record.
    ///
    /// # Errors
    /// [`Error::Damaged`] when it is not what was stored.
    pub fn get(&self, table: &str, key: &str) -> Result<Option<Vec<u8>>> {
        super::check_table(table)?;
        let Some(mut bytes) = self.records.get(table, key.as_bytes())? else { return Ok(None) };
        let payload = envelope::unwrap(table, key.as_bytes(), &bytes).map(<[u8]>::len);
        let payload = payload.map_err(|reason| damaged(table, key.as_bytes(), reason))?;
        bytes.drain(..bytes.len() - payload);
        Ok(Some(bytes))
    }

    /// Calls `visit` with keys and payloads of `range` in ascending order, until it returns `Break`.
    ///
    /// # Errors
    /// Those of `visit`; [`Error::Damaged`] at the first record that is not what was stored.
    pub fn scan<E: From<Error>>(
        &self,
        table: &str,
        range: &KeyRange,
        mut visit: impl FnMut(&str, &[u8]) -> Result<ControlFlow<()>, E>,
    ) -> Result<(), E> {
        self.scan_all(table, range, |record| {
            let (key, payload) = record?;
            visit(key, payload)
        })
    }

    /// Does as [`View::scan`], passes over damaged records, and returns what is wrong with them.
    ///
    /// # Errors
    /// Those of `visit`, and what keeps the table from being read at all.
    pub fn scan_sound<E: From<Error>>(
        &self,
        table: &str,
        range: &KeyRange,
        mut visit: impl FnMut(&str, &[u8]) -> Result<ControlFlow<()>, E>,
    ) -> Result<Vec<Problem>, E> {
        let mut problems = Vec::new();
        self.scan_all(table, range, |record| match record {
            Ok((key, payload)) => visit(key, payload),
            Err(Error::Damaged { table, key, reason }) => {
                problems.push(Problem { table, key: Some(key), reason });
                Ok(ControlFlow::Continue(()))
            }
            Err(other) => Err(other.into()),
        })?;
        Ok(problems)
    }

    /// Iterates over the records of `range`, holding a page of them in memory. The first error is the last item.
    pub fn records(&self, table: &str, range: KeyRange) -> Records<'_> {
        Records { view: self, table: table.to_owned(), range, page: Vec::new().into_iter(), done: false }
    }

    /// Returns how many records a table has, without counting them.
    pub fn count(&self, table: &str) -> Result<u64> {
        super::check_table(table)?;
        Ok(state::tally(&*self.records, table)?.count)
    }

    /// Returns how often the store was changed, see [`Store::revision`].
    pub fn revision(&self) -> Result<u64> {
        state::revision(&*self.records)
    }

    /// Returns the names of the tables that were written to, sorted. A table may be empty by now.
    pub fn tables(&self) -> Result<Vec<String>> {
        let mut names = self.records.tables()?;
        names.retain(|n| n != state::TABLE);
        Ok(names)
    }

    /// What the backend shows.
    pub(crate) fn raw(&self) -> &dyn kv::View {
        &*self.records
    }

    fn scan_all<E: From<Error>>(
        &self,
        table: &str,
        range: &KeyRange,
        mut visit: impl FnMut(Result<(&str, &[u8])>) -> Result<ControlFlow<()>, E>,
    ) -> Result<(), E> {
        super::check_table(table)?;
        let mut refused = None;
        self.records.scan(table, range, &mut |key, bytes| {
            let record = envelope::unwrap(table, key, bytes).and_then(|payload| {
                let key = std::str::from_utf8(key).map_err(|_| "its key is no UTF-8 text".to_owned())?;
                Ok((key, payload))
            });
            visit(record.map_err(|reason| damaged(table, key, reason))).or_else(|e| {
                refused = Some(e);
                Ok(ControlFlow::Break(()))
            })
        })?;
        refused.map_or(Ok(()), Err)
    }
}

/// The records of a range, see [`View::records`].
pub struct Records<'a> {
    view: &'a View<'a>,
    table: String,
    range: KeyRange,
    page: std::vec::IntoIter<Record>,
    done: bool,
}

impl Records<'_> {
    fn read_page(&mut self) -> Result<()> {
        let (mut page, mut bytes): (Vec<Record>, _) = (Vec::new(), 0);
        self.view.scan(&self.table, &self.range, |key, payload| {
            // A damaged file may lead in circles.
            if !self.range.contains(key.as_bytes()) || page.last().is_some_and(|(last, _)| last.as_str() >= key) {
                return Err(damaged(&self.table, key.as_bytes(), OUT_OF_ORDER.to_owned()));
            }
            bytes += payload.len();
            page.push((key.to_owned(), payload.to_vec()));
            let full = page.len() >= PAGE.0 || bytes >= PAGE.1;
            Ok(if full { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        })?;
        match page.last() {
            Some((key, _)) => self.range = self.range.clone().after(key),
            None => self.done = true,
        }
        self.page = page.into_iter();
        Ok(())
    }
}

impl Iterator for Records<'_> {
    type Item = Result<Record>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.page.len() == 0
            && !self.done
            && let Err(error) = self.read_page()
        {
            self.done = true;
            return Some(Err(error));
        }
        self.page.next().map(Ok)
    }
}

/// Notes that a thread reads a store, until it is dropped. A view cannot leave its thread.
struct Reading(usize, std::marker::PhantomData<*const ()>);

impl Reading {
    fn new(id: usize) -> Self {
        READING.with_borrow_mut(|reading| reading.push(id));
        Self(id, std::marker::PhantomData)
    }
}

impl Drop for Reading {
    fn drop(&mut self) {
        READING.with_borrow_mut(|reading| {
            if let Some(at) = reading.iter().rposition(|id| *id == self.0) {
                reading.swap_remove(at);
            }
        });
    }
}

pub(super) fn damaged(table: &str, key: &[u8], reason: String) -> Error {
    Error::Damaged { table: table.to_owned(), key: String::from_utf8_lossy(key).into_owned(), reason }
}
