//! Changes going in: each is one batch, stored whole or not at all, together with its entry in the history.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;

use d3dgen_mesh::{Model3d, picture};
use d3dgen_model::Document;
use d3dgen_store::{Batch, KeyRange};

use super::Database;
use super::files;
use super::records::{
    ASSETS, AssetRecord, CHANGES, CONTENTS, Change, IngestedFile, Kind, PATHS, Provenance, REMOVED, RemovedRecord,
    decode, encode, get,
};
use crate::annotation::{Annotation, Origin, Thumbnail};
use crate::error::Error;

/// Side of the pictures that are kept, px.
const THUMBNAIL_PX: usize = 128;

/// An asset to be kept.
#[derive(Debug, Clone)]
pub struct NewAsset {
    annotation: Annotation,
    model: Option<Model3d>,
    companions: BTreeMap<String, String>,
    thumbnail: Option<Vec<u8>>,
}

impl NewAsset {
    /// Returns an asset with its model in its own frame, if there is one, and draws its thumbnail.
    ///
    /// An id that another asset has gets a number when it is kept. `companions` are the digests of the files it was read
    /// from beside its own, by their paths below the folder that was ingested.
    pub fn new(mut annotation: Annotation, model: Option<Model3d>, companions: BTreeMap<String, String>) -> Self {
        // A picture that cannot be written is no reason to refuse a model.
        let thumbnail = model.as_ref().and_then(|m| picture::thumbnail(m, THUMBNAIL_PX).png().ok());
        annotation.thumbnail =
            thumbnail.as_ref().map(|png| Thumbnail { size_px: THUMBNAIL_PX as u32, sha256: files::digest(png) });
        Self { annotation, model, companions, thumbnail }
    }
}

impl Database {
    /// Keeps assets; one whose path was ingested before takes the place of what was there. Returns their ids.
    ///
    /// # Errors
    /// `Store`; `File`; `Document` when an annotation breaks its rules.
    pub fn put(&self, kind: Kind, assets: Vec<NewAsset>, by: &Provenance) -> Result<Vec<String>, Error> {
        if assets.is_empty() {
            return Ok(Vec::new());
        }
        let _alone = self.changing();
        let seq = self.next_change()?;
        let mut batch = Batch::new();
        let (mut ids, mut taken, mut orphans) = (Vec::new(), BTreeSet::new(), Vec::new());
        for NewAsset { mut annotation, model, companions, thumbnail } in assets {
            let problems = annotation.check();
            if !problems.is_empty() {
                return Err(d3dgen_model::Error::Invalid { kind: Annotation::KIND, problems }.into());
            }
            let model = model.map(|m| files::write(&self.files_dir(), &m, thumbnail.as_deref())).transpose()?;
            let source = match &annotation.origin {
                Origin::Ingested { path, hash } => Some((path.clone(), hash.clone())),
                _ => None,
            };
            let before = source.as_ref().map(|(path, _)| self.ingested(path)).transpose()?.flatten();
            let own = before.as_ref().map(|b| b.asset_id.clone()).filter(|id| is_variant(id, &annotation.asset_id));
            if let Some(before) = &before {
                batch.delete(CONTENTS, content_key(&before.hash, &before.asset_id));
                orphans.extend(self.model_hash(&before.asset_id)?.filter(|old| Some(old) != model.as_ref()));
            }
            annotation.asset_id = match own {
                Some(id) => id,
                None => self.free_id(&annotation.asset_id, &taken)?,
            };
            taken.insert(annotation.asset_id.clone());
            if let Some((path, hash)) = source {
                let asset_id = annotation.asset_id.clone();
                batch.put(CONTENTS, content_key(&hash, &asset_id), encode(&asset_id));
                batch.put(PATHS, path, encode(&IngestedFile { hash, asset_id, companions }));
            }
            ids.push(annotation.asset_id.clone());
            let key = annotation.asset_id.clone();
            batch.put(ASSETS, key, encode(&AssetRecord { annotation, model, change: seq }));
        }
        self.finish(batch, Change { seq, kind, provenance: by.clone(), assets: ids.clone() })?;
        self.clean(orphans)?;
        Ok(ids)
    }

    /// Remembers that a path is a copy of an asset that is kept.
    ///
    /// # Errors
    /// `Store`.
    pub fn note_copies(&self, copies: &[(String, IngestedFile)]) -> Result<(), Error> {
        let mut batch = Batch::new();
        for (path, copy) in copies {
            batch.put(PATHS, path.as_str(), encode(copy));
        }
        self.store.apply(batch)?;
        Ok(())
    }

    /// Returns the assets made of a source with this digest; several when other files are with it.
    ///
    /// # Errors
    /// `Store`.
    pub fn with_content(&self, hash: &str) -> Result<Vec<String>, Error> {
        let mut found = Vec::new();
        self.store.view()?.scan(CONTENTS, &KeyRange::prefix(hash), |key, payload| {
            found.push(decode(CONTENTS, key, payload)?);
            Ok::<_, Error>(ControlFlow::Continue(()))
        })?;
        Ok(found)
    }

    /// Puts a changed annotation in the place of an asset's own.
    ///
    /// # Errors
    /// `NoAsset`; `Document` when it breaks its rules; `Store`.
    pub fn annotate(&self, annotation: Annotation, by: &Provenance) -> Result<(), Error> {
        let id = annotation.asset_id.clone();
        let problems = annotation.check();
        if !problems.is_empty() {
            return Err(d3dgen_model::Error::Invalid { kind: Annotation::KIND, problems }.into());
        }
        let record = get::<AssetRecord>(&self.store.view()?, ASSETS, &id)?;
        let Some(record) = record else { return Err(Error::NoAsset { asset_id: id, known: Vec::new() }) };
        let _alone = self.changing();
        let seq = self.next_change()?;
        let mut batch = Batch::new();
        batch.put(ASSETS, id.as_str(), encode(&AssetRecord { annotation, change: seq, ..record }));
        self.finish(batch, Change { seq, kind: Kind::Annotate, provenance: by.clone(), assets: vec![id] })
    }

    /// Removes assets that are kept here, and objects of the shipped library, which are remembered as removed.
    ///
    /// # Errors
    /// `Store`; `File`.
    pub fn remove(&self, asset_ids: &[String], objects: &[String], by: &Provenance) -> Result<(), Error> {
        let _alone = self.changing();
        let seq = self.next_change()?;
        let (mut batch, mut files) = (Batch::new(), Vec::new());
        let gone: BTreeSet<&String> = asset_ids.iter().collect();
        for id in asset_ids {
            files.extend(self.model_hash(id)?);
            batch.delete(ASSETS, id.as_str());
        }
        let mut paths: BTreeMap<String, IngestedFile> = BTreeMap::new();
        super::records::each(&self.store.view()?, PATHS, |path, record: IngestedFile| {
            if gone.contains(&record.asset_id) {
                paths.insert(path.to_owned(), record);
            }
            Ok(())
        })?;
        for (path, record) in paths {
            batch.delete(CONTENTS, content_key(&record.hash, &record.asset_id));
            batch.delete(PATHS, path);
        }
        for object in objects {
            batch.put(REMOVED, object.as_str(), encode(&RemovedRecord { change: seq }));
        }
        let assets = asset_ids.iter().chain(objects).cloned().collect();
        self.finish(batch, Change { seq, kind: Kind::Remove, provenance: by.clone(), assets })?;
        self.clean(files)
    }

    /// Brings removed objects of the library back.
    ///
    /// # Errors
    /// `Store`.
    pub fn restore(&self, objects: &[String], by: &Provenance) -> Result<(), Error> {
        let _alone = self.changing();
        let seq = self.next_change()?;
        let mut batch = Batch::new();
        for object in objects {
            batch.delete(REMOVED, object.as_str());
        }
        self.finish(batch, Change { seq, kind: Kind::Restore, provenance: by.clone(), assets: objects.to_vec() })
    }

    fn finish(&self, mut batch: Batch, change: Change) -> Result<(), Error> {
        batch.put(CHANGES, format!("{:010}", change.seq), encode(&change));
        self.store.apply(batch)?;
        Ok(())
    }

    fn next_change(&self) -> Result<u64, Error> {
        Ok(self.store.count(CHANGES)? + 1)
    }

    fn model_hash(&self, asset_id: &str) -> Result<Option<String>, Error> {
        Ok(get::<AssetRecord>(&self.store.view()?, ASSETS, asset_id)?.and_then(|r| r.model))
    }

    /// Returns the id, with a number when another asset has it.
    fn free_id(&self, wanted: &str, taken: &BTreeSet<String>) -> Result<String, Error> {
        let there: BTreeSet<String> = self.with_prefix(ASSETS, wanted)?.into_iter().collect();
        let free = |id: &String| !there.contains(id) && !taken.contains(id);
        let numbered = (2..).map(|n: u64| format!("{wanted}_{n}"));
        let mut ids = std::iter::once(wanted.to_owned()).chain(numbered);
        Ok(ids.find(free).unwrap_or_else(|| wanted.to_owned()))
    }

    /// Removes files that no asset names any more.
    fn clean(&self, hashes: Vec<String>) -> Result<(), Error> {
        if hashes.is_empty() {
            return Ok(());
        }
        let mut used = BTreeSet::new();
        super::records::each(&self.store.view()?, ASSETS, |_, record: AssetRecord| {
            used.extend(record.model);
            Ok(())
        })?;
        hashes.iter().filter(|hash| !used.contains(*hash)).try_for_each(|hash| files::remove(&self.files_dir(), hash))
    }
}

fn content_key(hash: &str, asset_id: &str) -> String {
    format!("{hash} {asset_id}")
}

/// Tells whether an id is another one, perhaps with a number.
fn is_variant(id: &str, wanted: &str) -> bool {
    let rest = id.strip_prefix(wanted);
    rest.is_some_and(|r| r.is_empty() || r.strip_prefix('_').is_some_and(|n| n.bytes().all(|b| b.is_ascii_digit())))
}
