//! Takes documents in any order, one at a time, and keeps of each only what the parts of an index are made of: a
//! hundred thousand whole documents would need more memory than the index itself.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use super::Take;
use super::columns::Columns;
use super::document::{Document, IndexSpec, Phase, Watch};
use super::vectors::Vectors;
use crate::embed::Embedder;
use crate::error::{Error, Result};

/// Documents embedded at a time.
const EMBED_BATCH: usize = 256;
/// Batches that wait for the embedder before the reading waits for it.
const WAITING: usize = 4;

/// Gives documents to an index, one after the other, until it has no more or the index refuses one.
pub(super) type Feed<'a, E> = &'a mut dyn FnMut(Take<'_>) -> Result<(), E>;

/// What the documents come to, in the order of their keys.
pub(super) struct Gathered {
    pub(super) columns: Columns,
    pub(super) vectors: Vectors,
    /// The texts of each row, in the order of the fields.
    pub(super) texts: Vec<Box<[Box<str>]>>,
}

/// Takes all documents. Vectors are made beside the reading; neither sees the other, so the result is the same.
///
/// # Errors
/// Those of `feed`; [`Error::UnknownField`]; [`Error::Index`] when two documents have one key; [`Error::Embedder`];
/// [`Error::Cancelled`].
pub(super) fn gather<E: From<Error>>(
    spec: &IndexSpec,
    embedder: &dyn Embedder,
    expected: usize,
    feed: Feed<'_, E>,
    watch: Watch<'_>,
) -> Result<Gathered, E> {
    let (read, vectors) = std::thread::scope(|scope| {
        let (sender, receiver) = sync_channel(WAITING);
        let embedding = scope.spawn(|| embed(embedder, receiver, expected, watch));
        let mut reading = Reading { columns: Columns::new(spec), texts: Vec::new(), batch: Vec::new(), sender };
        let read = feed(&mut |document| reading.take(spec, document, expected, watch));
        let read = read.map(|()| reading.finish());
        let vectors = embedding.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        (read, vectors)
    });
    // When the embedder fails, the reading ends with it; the cause is what counts.
    let (mut full, (mut columns, mut texts)) = (vectors?, read?);
    if u32::try_from(texts.len()).is_err() {
        return Err(Error::Index { what: format!("{} documents, the limit is {}", texts.len(), u32::MAX) }.into());
    }
    let mut places = columns.sort_by_key()?;
    move_to(&mut places.clone(), |a, b| texts.swap(a, b));
    let dim = embedder.dim();
    move_to(&mut places, |a, b| swap_rows(&mut full, dim, a, b));
    Ok(Gathered { columns, vectors: Vectors::new(dim, full), texts })
}

/// What is read so far; rows in the order of arrival.
struct Reading {
    columns: Columns,
    texts: Vec<Box<[Box<str>]>>,
    batch: Vec<String>,
    sender: SyncSender<Vec<String>>,
}

impl Reading {
    fn take(&mut self, spec: &IndexSpec, mut document: Document, expected: usize, watch: Watch<'_>) -> Result<()> {
        if self.texts.len().is_multiple_of(1000) {
            watch.step(Phase::Reading, self.texts.len(), expected)?;
        }
        spec.check(&document)?;
        let texts = spec.fields.iter().map(|f| document.texts.remove(&f.name).unwrap_or_default().into_boxed_str());
        self.texts.push(texts.collect());
        self.batch.push(std::mem::take(&mut document.embed_text));
        self.columns.push(document);
        if self.batch.len() == EMBED_BATCH { self.send() } else { Ok(()) }
    }

    fn send(&mut self) -> Result<()> {
        // The other end is gone only when it has failed, and then says why.
        self.sender.send(std::mem::take(&mut self.batch)).map_err(|_| Error::Cancelled)
    }

    fn finish(mut self) -> (Columns, Vec<Box<[Box<str>]>>) {
        // As above: nobody who takes it means an error that is reported.
        let _ = self.send();
        (self.columns, self.texts)
    }
}

/// Returns one vector a text, one after the other; zeros for empty ones.
fn embed(
    embedder: &dyn Embedder,
    batches: Receiver<Vec<String>>,
    expected: usize,
    watch: Watch<'_>,
) -> Result<Vec<f32>> {
    let dim = embedder.dim();
    let mut full = Vec::with_capacity(expected * dim);
    for batch in batches {
        watch.step(Phase::Meaning, full.len() / dim.max(1), expected)?;
        let texts: Vec<&str> = batch.iter().map(String::as_str).collect();
        let vectors = embedder.embed(&texts)?;
        let fits = vectors.len() == texts.len() && vectors.iter().all(|v| v.len() == dim);
        if !fits {
            let what = format!("{} vectors for {} texts, or of another length than {dim}", vectors.len(), texts.len());
            return Err(Error::Embedder { id: embedder.id().to_owned(), what });
        }
        for (text, vector) in texts.iter().zip(vectors) {
            // A transformer has a vector for the empty text too, near to anything.
            let kept = !text.trim().is_empty();
            full.extend(vector.into_iter().map(|x| if kept { x } else { 0.0 }));
        }
    }
    Ok(full)
}

/// Brings rows to their places by swaps: `places` says for each row where it goes, and ends as 0, 1, 2, ...
fn move_to(places: &mut [u32], mut swap: impl FnMut(usize, usize)) {
    for row in 0..places.len() {
        while let Some(&place) = places.get(row)
            && place as usize != row
        {
            swap(row, place as usize);
            places.swap(row, place as usize);
        }
    }
}

fn swap_rows(full: &mut [f32], dim: usize, a: usize, b: usize) {
    let (low, high) = (a.min(b), a.max(b));
    if let Some((first, second)) = full.split_at_mut_checked(high * dim)
        && let (Some(x), Some(y)) = (first.get_mut(low * dim..(low + 1) * dim), second.get_mut(..dim))
    {
        x.swap_with_slice(y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_go_where_their_places_say() {
        let mut places = [3, 0, 4, 1, 2];
        let mut rows = ["d", "a", "e", "b", "c"];
        let mut full: Vec<f32> = [3.0, 0.0, 4.0, 1.0, 2.0].iter().flat_map(|x| [*x, -x]).collect();
        move_to(&mut places.clone(), |a, b| rows.swap(a, b));
        move_to(&mut places, |a, b| swap_rows(&mut full, 2, a, b));
        assert_eq!(rows, ["a", "b", "c", "d", "e"]);
        assert_eq!(full, (0..5).flat_map(|x| [x as f32, -(x as f32)]).collect::<Vec<_>>());
        assert_eq!(places, [0, 1, 2, 3, 4]);
    }
}
