//! A domain from any folder: data only, no rebuild.

use std::collections::BTreeMap;
use std::path::Path;

use d3dgen_model::domain::Domain;
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_model::{Document, Problem};

use crate::builtin::common;
use crate::merge::{self, Merged};
use crate::{Error, Plugin, complete};

/// A domain read from a folder.
pub struct Custom {
    domain: Domain,
    knowledge: KnowledgeBase,
}

impl Custom {
    /// Reads `domain.toml`, the other `*.toml` beside it, and `knowledge.json` when there is one.
    ///
    /// # Errors
    /// `Unreadable` when a file is missing or does not parse, `Invalid` with every problem found.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let merged = merge::domain_folder(folder, common())
            .map_err(|reason| Error::Unreadable { folder: folder.to_path_buf(), reason })?;
        let domain = checked(&merged).map_err(|source| Error::Invalid { file: folder.join("domain.toml"), source })?;
        let file = folder.join("knowledge.json");
        let knowledge = if file.is_file() {
            let text = std::fs::read_to_string(&file).map_err(|e| Error::Unreadable {
                folder: folder.to_path_buf(),
                reason: format!("knowledge.json: {e}"),
            })?;
            whole(&text).map_err(|source| Error::Invalid { file, source })?
        } else {
            KnowledgeBase::empty(&domain.id)
        };
        Ok(Self { domain, knowledge })
    }

    /// Reads a domain from the texts of its files by name, as [`Custom::read`] does from a folder; problems name the file.
    ///
    /// # Errors
    /// Every problem of the first file that has any; JSON pointers of `domain.toml` are into the merged tables.
    pub fn from_texts(files: &BTreeMap<String, String>) -> Result<Self, (String, d3dgen_model::Error)> {
        let main = "domain.toml";
        let not = |file: &str, reason: String| {
            (
                file.to_owned(),
                d3dgen_model::Error::Invalid { kind: Domain::KIND, problems: vec![Problem::new("", reason)] },
            )
        };
        let Some(first) = files.get(main) else {
            return Err(not(main, "is missing; a domain has a domain.toml".into()));
        };
        let mut others: Vec<_> = files.iter().filter(|(name, _)| *name != main && name.ends_with(".toml")).collect();
        others.sort_by_key(|(name, _)| merge::is_of_a_kind(Path::new(name)));
        let others = others.into_iter().map(|(name, text)| (name.as_str(), text.as_str()));
        let texts = std::iter::once((main, first.as_str())).chain(others);
        let merged = merge::texts(texts, common()).map_err(|(file, reason)| not(&file, reason))?;
        let domain = checked(&merged).map_err(|source| (main.to_owned(), source))?;
        let knowledge = match files.get("knowledge.json") {
            Some(text) => whole(text).map_err(|source| ("knowledge.json".to_owned(), source))?,
            None => KnowledgeBase::empty(&domain.id),
        };
        Ok(Self { domain, knowledge })
    }

    /// Returns a domain of its two documents, both checked before.
    pub fn of(domain: Domain, knowledge: KnowledgeBase) -> Self {
        Self { domain, knowledge }
    }
}

/// Returns the domain of merged tables; its problems say in which file the entry is that they are about.
fn checked(merged: &Merged) -> Result<Domain, d3dgen_model::Error> {
    Domain::from_value(merged.table.clone()).map_err(|error| match error {
        d3dgen_model::Error::Invalid { kind, mut problems } => {
            for problem in &mut problems {
                if let Some(place) = merged.place(&problem.path) {
                    problem.message = format!("{} (in {place})", problem.message);
                }
            }
            d3dgen_model::Error::Invalid { kind, problems }
        }
        other => other,
    })
}

/// Reads rules with those they share.
fn whole(text: &str) -> Result<KnowledgeBase, d3dgen_model::Error> {
    let mut knowledge = KnowledgeBase::from_json(text)?;
    complete(&mut knowledge)?;
    Ok(knowledge)
}

impl Plugin for Custom {
    fn id(&self) -> &str {
        &self.domain.id
    }

    fn domain(&self) -> &Domain {
        &self.domain
    }

    fn knowledge(&self) -> &KnowledgeBase {
        &self.knowledge
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::PathBuf;

    use super::*;
    use crate::Registry;

    fn shipped(id: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../domains").join(id)
    }

    #[test]
    fn a_folder_works_like_a_built_in_domain() {
        let dir = tempfile::tempdir().unwrap();
        for entry in fs::read_dir(shipped("school")).unwrap() {
            let path = entry.unwrap().path();
            let text = fs::read_to_string(&path).unwrap().replace("id = \"school\"", "id = \"academy\"");
            fs::write(dir.path().join(path.file_name().unwrap()), text).unwrap();
        }
        let mut registry = Registry::builtin();
        assert_eq!(registry.add_folder(dir.path()).unwrap().id(), "academy");
        let (academy, school) = (registry.get("academy").unwrap(), registry.get("school").unwrap());
        assert_eq!(academy.domain().room_types, school.domain().room_types);
    }

    #[test]
    fn texts_are_read_as_their_folder_is() {
        let mut files: BTreeMap<String, String> = fs::read_dir(shipped("school"))
            .unwrap()
            .map(|e| e.unwrap().path())
            .map(|p| (p.file_name().unwrap().to_string_lossy().into_owned(), fs::read_to_string(&p).unwrap()))
            .collect();
        let (texts, folder) = (Custom::from_texts(&files).ok().unwrap(), Custom::read(&shipped("school")).unwrap());
        assert_eq!((texts.domain(), texts.knowledge()), (folder.domain(), folder.knowledge()));
        files.insert("more.toml".into(), "id = \"x\"".into());
        assert_eq!(Custom::from_texts(&files).err().unwrap().0, "more.toml");
        files.remove("more.toml");
        files.insert("knowledge.json".into(), "{}".into());
        assert_eq!(Custom::from_texts(&files).err().unwrap().0, "knowledge.json");
        assert_eq!(Custom::from_texts(&BTreeMap::new()).err().unwrap().0, "domain.toml");
    }

    #[test]
    fn a_broken_folder_reports_every_problem() {
        let dir = tempfile::tempdir().unwrap();
        assert!(matches!(Custom::read(dir.path()), Err(Error::Unreadable { .. })));
        for entry in fs::read_dir(shipped("school")).unwrap() {
            let path = entry.unwrap().path();
            fs::copy(&path, dir.path().join(path.file_name().unwrap())).unwrap();
        }
        fs::write(
            dir.path().join("broken.toml"),
            "[[groups]]\nid = \"x\"\nanchor = \"no_such_thing\"\nmembers = []\n\
            [[roles]]\nid = \"r\"\nmodel = \"Common/x\"\nspeed_m_s = 1.0\nvisits = [\"no_such_room\"]\n",
        )
        .unwrap();
        let message = Custom::read(dir.path()).err().expect("two problems").to_string();
        assert!(message.contains("no_such_thing") && message.contains("no_such_room"), "{message}");
        assert!(message.contains("(in `x` of broken.toml)"), "{message}");
    }

    #[test]
    fn an_id_is_given_once() {
        let mut registry = Registry::builtin();
        assert!(matches!(registry.add_folder(&shipped("school")), Err(Error::Taken { .. })));
    }
}
