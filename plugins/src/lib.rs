//! Domains as plugins: those built into the program, and any folder a user names.
//!
//! What a domain knows is data ([`d3dgen_model::domain::Domain`]); a [`Plugin`] is how the pipeline gets at it. Nothing
//! here knows the pipeline.

mod borrowing;
mod builtin;
mod custom;
mod digest;
mod error;
mod merge;
mod shared;

use std::any::Any;
use std::path::Path;
use std::sync::Arc;

use d3dgen_model::domain::Domain;
use d3dgen_model::knowledge::KnowledgeBase;

use self::borrowing::Borrowing;
pub use builtin::{Builtin, all};
pub use custom::Custom;
pub use error::Error;
pub use shared::complete;

/// A domain with its knowledge base.
pub trait Plugin: Send + Sync {
    /// Returns the id without reading anything else.
    fn id(&self) -> &str;

    /// Returns vocabulary, rooms, objects and rules.
    fn domain(&self) -> &Domain;

    /// Returns the citable building rules.
    fn knowledge(&self) -> &KnowledgeBase;
}

/// Returns true for the ids of the domains in the program.
pub fn is_shipped(id: &str) -> bool {
    all().iter().any(|b| b.id() == id)
}

/// All domains a process knows, in a stable order: built-in ones first, then others as they were added. Clones share the
/// domains. Each is lent the room types of the others that it does not know ([`d3dgen_model::domain::Lent`]).
#[derive(Clone)]
pub struct Registry {
    plugins: Vec<Arc<Borrowing>>,
    /// Worked out from exactly these domains; clones share it until one of them changes.
    digests: Arc<digest::Digests>,
}

impl Registry {
    /// Returns the built-in domains; each is parsed when it is first used.
    pub fn builtin() -> Self {
        let plugins = all().into_iter().map(|b| Arc::new(b) as Arc<dyn Plugin>).collect();
        Self { plugins: Borrowing::among(plugins), digests: Arc::default() }
    }

    /// Adds the domain in a folder and returns it.
    ///
    /// # Errors
    /// `Unreadable` when files are missing or not TOML, `Invalid` with every problem of a file that breaks its schema,
    /// `Taken` when the id is in use.
    pub fn add_folder(&mut self, folder: &Path) -> Result<&dyn Plugin, Error> {
        let plugin = Custom::read(folder)?;
        if self.get(plugin.id()).is_some() {
            return Err(Error::Taken { folder: folder.to_path_buf(), id: plugin.id().to_owned() });
        }
        self.register(self.plugins.len(), Arc::new(plugin));
        Ok(self.plugins.last().expect("just pushed").as_ref())
    }

    /// Adds a domain; false when its id is in use.
    pub fn add(&mut self, plugin: Arc<dyn Plugin>) -> bool {
        let free = self.get(plugin.id()).is_none();
        if free {
            self.register(self.plugins.len(), plugin);
        }
        free
    }

    /// Gives a domain other rules than it brings; false when no such domain is registered.
    ///
    /// What was worked out from the domains stays: see [`Registry::digest`].
    pub fn set_knowledge(&mut self, id: &str, knowledge: KnowledgeBase) -> bool {
        let Some(at) = self.plugins.iter().position(|p| p.id() == id) else { return false };
        let domain = Arc::clone(self.plugins[at].own());
        self.plugins[at] = Arc::new(self.plugins[at].with_rules(Arc::new(OtherRules { domain, knowledge })));
        true
    }

    /// Gives a domain other objects than it brings; false when no such domain is registered.
    pub fn set_domain(&mut self, domain: Domain) -> bool {
        let Some(at) = self.plugins.iter().position(|p| p.id() == domain.id) else { return false };
        let rules = Arc::clone(self.plugins[at].own());
        self.register(at, Arc::new(OtherObjects { rules, domain }));
        true
    }

    /// Puts a domain in the place of another, or behind all; what was worked out from the domains is forgotten.
    fn register(&mut self, at: usize, plugin: Arc<dyn Plugin>) {
        let mut own: Vec<Arc<dyn Plugin>> = self.plugins.iter().map(|p| Arc::clone(p.own())).collect();
        let end = own.len().min(at + 1);
        own.splice(at..end, [plugin]);
        self.plugins = Borrowing::among(own);
        self.digests = Arc::default();
    }

    /// Returns the domain with this id.
    pub fn get(&self, id: &str) -> Option<&dyn Plugin> {
        self.iter().find(|p| p.id() == id)
    }

    /// Returns what `make` works out from the domains, from memory where it was asked for before under this name and
    /// type; forgotten when a domain changes, and not when only its rules do: nothing of them belongs into it. Names must be few: nothing that a request says belongs into them.
    pub fn digest<T: Any + Send + Sync>(&self, name: &str, make: impl FnOnce() -> T) -> Arc<T> {
        self.digests.get(name, make)
    }

    /// Returns all domains in order.
    pub fn iter(&self) -> impl Iterator<Item = &dyn Plugin> {
        self.plugins.iter().map(|p| p.as_ref() as &dyn Plugin)
    }
}

/// A domain whose objects come from elsewhere.
struct OtherObjects {
    rules: Arc<dyn Plugin>,
    domain: Domain,
}

impl Plugin for OtherObjects {
    fn id(&self) -> &str {
        &self.domain.id
    }

    fn domain(&self) -> &Domain {
        &self.domain
    }

    fn knowledge(&self) -> &KnowledgeBase {
        self.rules.knowledge()
    }
}

/// A domain whose rules come from elsewhere.
struct OtherRules {
    domain: Arc<dyn Plugin>,
    knowledge: KnowledgeBase,
}

impl Plugin for OtherRules {
    fn id(&self) -> &str {
        self.domain.id()
    }

    fn domain(&self) -> &Domain {
        self.domain.domain()
    }

    fn knowledge(&self) -> &KnowledgeBase {
        &self.knowledge
    }
}
