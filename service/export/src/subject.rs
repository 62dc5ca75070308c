//! What is exported: a world with its domain and models, and the scene that formats share.

use std::sync::OnceLock;

use d3dgen_model::domain::Domain;
use d3dgen_model::world::World;

use crate::error::Error;
use crate::models::KeptModels;
use crate::scene::SimScene;

/// A world that is written in some formats.
///
/// Its scene is made when the first of them asks for it, and once for all of them.
pub struct Subject<'a> {
    /// Its documents.
    pub world: &'a World,
    /// The domain that it is of.
    pub domain: &'a Domain,
    /// Models that are kept, not made.
    pub kept: &'a dyn KeptModels,
    scene: OnceLock<SimScene>,
}

impl<'a> Subject<'a> {
    /// Returns a world as a subject.
    pub fn new(world: &'a World, domain: &'a Domain, kept: &'a dyn KeptModels) -> Self {
        Self { world, domain, kept, scene: OnceLock::new() }
    }

    /// Returns the world as simulators need it.
    ///
    /// # Errors
    /// As [`SimScene::of`].
    pub fn scene(&self) -> Result<&SimScene, Error> {
        if let Some(made) = self.scene.get() {
            return Ok(made);
        }
        let made = SimScene::of(self.world, self.domain, self.kept)?;
        Ok(self.scene.get_or_init(|| made))
    }
}
