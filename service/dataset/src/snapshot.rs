//! A snapshot: all that worlds depend on beside their request, as one file named by its digest.
//!
//! It holds the domains with the assets that stand for their objects, the rules as they were amended, and the program's
//! version, with a world made of them as a probe. A run makes every world of its snapshot, so what is amended meanwhile
//! changes nothing in it, and workers on other machines need neither the domains' folders nor the database.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use d3dgen_model::document::Document;
use d3dgen_model::domain::{Domain, Stock, StockedAsset};
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_pipeline::generate::{Settings, generate_world};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_plugins::{Custom, Registry};
use serde::{Deserialize, Serialize};

use crate::digest::sha256;
use crate::error::Error;

/// Name and version of the program, as worlds state it.
const PROGRAM: &str = concat!("d3dgen ", env!("CARGO_PKG_VERSION"));
/// Seed of the probe.
const PROBE_SEED: u64 = 1;
/// Version of the form.
const VERSION: u32 = 1;
/// Most bytes of a snapshot once it is unpacked: far above any, so that a damaged file cannot fill the memory.
const MOST_BYTES: u64 = 1 << 30;

/// What worlds depend on beside their request.
#[derive(Debug, Clone)]
pub struct Snapshot {
    content: Content,
    digest: String,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Content {
    version: u32,
    program: String,
    probe: Probe,
    domains: Vec<Pinned>,
}

/// A world made of the snapshot, by which another build of the program is known that would make other worlds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Probe {
    prompt: String,
    world_sha256: String,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Pinned {
    domain: serde_json::Value,
    knowledge: serde_json::Value,
    /// By object.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    stock: BTreeMap<String, PinnedStock>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PinnedStock {
    assets: Vec<PinnedAsset>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    made_because: Option<String>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PinnedAsset {
    size_m: [f64; 3],
    asset: String,
    reason: String,
}

impl Snapshot {
    /// Takes a snapshot of the domains.
    ///
    /// # Errors
    /// `Input` when no world can be made of them.
    pub fn take(registry: &Registry) -> Result<Self, Error> {
        let pinned = |plugin: &dyn d3dgen_plugins::Plugin| {
            let value = |v: serde_json::Result<serde_json::Value>| v.expect("documents hold only finite numbers");
            Pinned {
                domain: value(serde_json::to_value(plugin.domain())),
                knowledge: value(serde_json::to_value(plugin.knowledge())),
                stock: stock(plugin.domain()),
            }
        };
        let domains: Vec<Pinned> = registry.iter().map(pinned).collect();
        let probe = Probe { prompt: probe_prompt(registry)?, world_sha256: String::new() };
        let mut content = Content { version: VERSION, program: PROGRAM.to_owned(), probe, domains };
        let pinned = registry_of(&content)?; // numbers read back from text, as every later run has them
        content.probe.world_sha256 = probe_digest(&content.probe.prompt, &pinned)?;
        Ok(Self { digest: sha256(&text(&content)), content })
    }

    /// Returns the SHA-256 of its text, hexadecimal.
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// Returns the name of its file.
    pub fn file_name(&self) -> String {
        format!("snapshot-{}.json.gz", &self.digest[..16])
    }

    /// Returns the program that took it, with its version.
    pub fn program(&self) -> &str {
        &self.content.program
    }

    /// Returns the ids of its domains.
    pub fn domain_ids(&self) -> impl Iterator<Item = &str> {
        self.content.domains.iter().filter_map(|d| d.domain["id"].as_str())
    }

    /// Returns the bytes of its file.
    pub fn to_bytes(&self) -> Vec<u8> {
        crate::pack::gzip(&text(&self.content))
    }

    /// Reads a snapshot from the bytes of its file; `path` is how errors call it.
    ///
    /// # Errors
    /// `Damaged` when it is none, or its name is not that of its content.
    pub fn from_bytes(bytes: &[u8], path: &Path) -> Result<Self, Error> {
        let mut text = Vec::new();
        let unpacked = flate2::read::GzDecoder::new(bytes).take(MOST_BYTES).read_to_end(&mut text);
        unpacked.map_err(|e| Error::damaged(path, format!("is no snapshot: {e}")))?;
        let content: Content =
            serde_json::from_slice(&text).map_err(|e| Error::damaged(path, format!("is no snapshot: {e}")))?;
        let snapshot = Self { digest: sha256(&text), content };
        let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
        if name.starts_with("snapshot-") && name != snapshot.file_name() {
            let reason = format!("its content is that of {}: it was changed or cut off", snapshot.file_name());
            return Err(Error::damaged(path, reason));
        }
        Ok(snapshot)
    }

    /// Reads the file of a snapshot.
    ///
    /// # Errors
    /// `Read`, and as [`Snapshot::from_bytes`].
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::from_bytes(&std::fs::read(path).map_err(Error::read(path))?, path)
    }

    /// Writes its file into a folder, whole or not at all.
    ///
    /// # Errors
    /// `Write`.
    pub fn write(&self, folder: &Path) -> Result<std::path::PathBuf, Error> {
        let path = folder.join(self.file_name());
        crate::pack::write_whole(&path, |file| file.write_all(&self.to_bytes()))?;
        Ok(path)
    }

    /// Returns the domains of the snapshot, after a look that this program makes the worlds of it that the one did which took it.
    ///
    /// # Errors
    /// `Input` for another version of the program, or a build of it that makes other worlds; `Damaged` for documents that
    /// break their schema.
    pub fn registry(&self) -> Result<Registry, Error> {
        if self.content.program != PROGRAM {
            let (its, this) = (&self.content.program, PROGRAM);
            return Err(Error::Input(format!(
                "the snapshot is of {its}, this is {this}: run it with the program that took it"
            )));
        }
        let registry = registry_of(&self.content)?;
        let probe = &self.content.probe;
        if probe_digest(&probe.prompt, &registry)? != probe.world_sha256 {
            return Err(Error::Input(format!(
                "this build of {PROGRAM} makes another world of `{}` than the one that took the snapshot: use the same build on every machine",
                probe.prompt
            )));
        }
        Ok(registry)
    }
}

fn text(content: &Content) -> Vec<u8> {
    serde_json::to_vec(content).expect("documents hold only finite numbers and string keys")
}

fn stock(domain: &Domain) -> BTreeMap<String, PinnedStock> {
    let stocked = domain.objects.iter().filter(|o| o.stock != Stock::default());
    let asset = |a: &StockedAsset| PinnedAsset { size_m: a.size_m, asset: a.asset.clone(), reason: a.reason.clone() };
    let pinned = |stock: &Stock| PinnedStock {
        assets: stock.assets.iter().map(asset).collect(),
        made_because: stock.made_because.clone(),
    };
    stocked.map(|o| (o.id.clone(), pinned(&o.stock))).collect()
}

fn registry_of(content: &Content) -> Result<Registry, Error> {
    let mut registry = Registry::builtin();
    for pinned in &content.domains {
        let refused = |e: d3dgen_model::Error| Error::Input(format!("the snapshot cannot be used: {e}"));
        let mut domain = Domain::from_value(pinned.domain.clone()).map_err(refused)?;
        let knowledge = KnowledgeBase::from_value(pinned.knowledge.clone()).map_err(refused)?;
        for object in &mut domain.objects {
            if let Some(stock) = pinned.stock.get(&object.id) {
                let asset = |a: &PinnedAsset| StockedAsset {
                    size_m: a.size_m,
                    asset: a.asset.clone(),
                    reason: a.reason.clone(),
                };
                object.stock = Stock {
                    assets: stock.assets.iter().map(asset).collect(),
                    made_because: stock.made_because.clone(),
                };
            }
        }
        let id = domain.id.clone();
        if registry.get(&id).is_some() {
            registry.set_domain(domain);
            registry.set_knowledge(&id, knowledge);
        } else {
            registry.add(Arc::new(Custom::of(domain, knowledge)));
        }
    }
    Ok(registry)
}

/// Returns the prompt of the probe: the first word for the first domain that has one.
fn probe_prompt(registry: &Registry) -> Result<String, Error> {
    let word = registry.iter().find_map(|p| p.domain().keywords.values().flatten().next().cloned());
    word.ok_or_else(|| Error::Input("no domain has a word that names it".into()))
}

fn probe_digest(prompt: &str, registry: &Registry) -> Result<String, Error> {
    let request = Request { prompt: prompt.to_owned(), seed: PROBE_SEED, ..Request::default() };
    let made = generate_world(&request, registry, &Settings::default(), &mut |_| (), &AtomicBool::new(false));
    let made = made.map_err(|e| Error::Input(format!("no world can be made of `{prompt}`: {e}")))?;
    Ok(sha256(made.world.to_json().as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_snapshot_comes_back_as_it_was_and_is_named_by_its_content() {
        let registry = Registry::builtin();
        let snapshot = Snapshot::take(&registry).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = snapshot.write(folder.path()).unwrap();
        let read = Snapshot::read(&path).unwrap();
        assert_eq!(read.digest(), snapshot.digest());
        let pinned = read.registry().unwrap();
        for plugin in registry.iter() {
            let same = pinned.get(plugin.id()).unwrap();
            assert_eq!((same.domain(), same.knowledge()), (plugin.domain(), plugin.knowledge()), "{}", plugin.id());
        }
        let renamed = folder.path().join("snapshot-0000000000000000.json.gz");
        std::fs::copy(&path, &renamed).unwrap();
        assert!(Snapshot::read(&renamed).unwrap_err().to_string().contains("changed or cut off"));
    }

    #[test]
    fn another_build_that_makes_other_worlds_is_refused() {
        let mut snapshot = Snapshot::take(&Registry::builtin()).unwrap();
        snapshot.content.probe.world_sha256 = sha256(b"another world");
        assert!(snapshot.registry().err().unwrap().to_string().contains("same build on every machine"));
        snapshot.content.program = "d3dgen 0.0.1".into();
        assert!(snapshot.registry().err().unwrap().to_string().contains("run it with the program that took it"));
    }
}
