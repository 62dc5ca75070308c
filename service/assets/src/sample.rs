//! What the tests of this crate share: the catalog of the shipped domains.

use std::sync::OnceLock;

use d3dgen_model::domain::Domain;
use d3dgen_plugins::{Plugin, Registry};

use crate::catalog::Catalog;

/// Returns the shipped domains.
pub fn domains() -> &'static [Domain] {
    static DOMAINS: OnceLock<Vec<Domain>> = OnceLock::new();
    DOMAINS.get_or_init(|| Registry::builtin().iter().map(|p| Plugin::domain(p).clone()).collect())
}

/// Returns the catalog of the shipped domains.
pub fn catalog() -> &'static Catalog {
    static CATALOG: OnceLock<Catalog> = OnceLock::new();
    CATALOG.get_or_init(|| Catalog::new(domains()))
}
