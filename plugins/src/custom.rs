//! A domain from any folder: data only, no rebuild.

use std::path::Path;

use d3dgen_model::Document;
use d3dgen_model::domain::Domain;
use d3dgen_model::knowledge::KnowledgeBase;

use crate::{Error, Plugin, merge};

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
        let table = merge::domain_folder(folder)
            .map_err(|reason| Error::Unreadable { folder: folder.to_path_buf(), reason })?;
        let domain =
            Domain::from_value(table).map_err(|source| Error::Invalid { file: folder.join("domain.toml"), source })?;
        let file = folder.join("knowledge.json");
        let knowledge = if file.is_file() {
            let text = std::fs::read_to_string(&file).map_err(|e| Error::Unreadable {
                folder: folder.to_path_buf(),
                reason: format!("knowledge.json: {e}"),
            })?;
            KnowledgeBase::from_json(&text).map_err(|source| Error::Invalid { file, source })?
        } else {
            KnowledgeBase::empty(&domain.id)
        };
        Ok(Self { domain, knowledge })
    }
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
    }

    #[test]
    fn an_id_is_given_once() {
        let mut registry = Registry::builtin();
        assert!(matches!(registry.add_folder(&shipped("school")), Err(Error::Taken { .. })));
    }
}
