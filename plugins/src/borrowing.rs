//! Domains beside others: each is lent the room types that it does not know itself.

use std::sync::{Arc, OnceLock};

use d3dgen_model::domain::{Domain, Lent};
use d3dgen_model::knowledge::KnowledgeBase;

use crate::Plugin;

/// A domain with what others lend it, worked out when its domain is first asked for.
#[derive(Clone)]
pub(crate) struct Borrowing {
    own: Arc<dyn Plugin>,
    others: Arc<[Arc<dyn Plugin>]>,
    /// Kept where only the rules change.
    domain: Arc<OnceLock<Domain>>,
}

impl Borrowing {
    /// Lends to each of these domains what the others have.
    pub(crate) fn among(plugins: Vec<Arc<dyn Plugin>>) -> Vec<Arc<Self>> {
        let others: Arc<[Arc<dyn Plugin>]> = plugins.iter().cloned().collect();
        let one = |own| Arc::new(Self { own, others: Arc::clone(&others), domain: Arc::default() });
        plugins.into_iter().map(one).collect()
    }

    /// Returns the domain as it was registered.
    pub(crate) fn own(&self) -> &Arc<dyn Plugin> {
        &self.own
    }

    /// Returns the same domain with other rules.
    pub(crate) fn with_rules(&self, own: Arc<dyn Plugin>) -> Self {
        Self { own, ..self.clone() }
    }
}

impl Plugin for Borrowing {
    fn id(&self) -> &str {
        self.own.id()
    }

    fn domain(&self) -> &Domain {
        self.domain.get_or_init(|| {
            let own = self.own.domain();
            let lent = Lent::to(own, self.others.iter().map(|p| p.domain()));
            Domain { lent: Arc::new(lent), ..own.clone() }
        })
    }

    fn knowledge(&self) -> &KnowledgeBase {
        self.own.knowledge()
    }
}

#[cfg(test)]
mod tests {
    use crate::Registry;

    #[test]
    fn a_domain_borrows_the_rooms_that_it_does_not_know() {
        let registry = Registry::builtin();
        for plugin in registry.iter() {
            let domain = plugin.domain();
            for other in registry.iter().map(|p| p.domain()) {
                for kind in &other.room_types {
                    let known = domain.room_type_or_lent(&kind.id).unwrap_or_else(|| panic!("{}", kind.id));
                    let owned = domain.room_type(&kind.id).is_some();
                    assert_eq!(domain.lender_of(&kind.id).is_none(), owned, "{} in {}", kind.id, domain.id);
                    for line in &known.furnishing {
                        let objects: Vec<_> = domain.objects_of(&line.item).collect();
                        let all = objects.iter().all(|o| domain.object(o).is_some());
                        assert!(all, "{}: {} of {}", domain.id, line.item, kind.id);
                    }
                }
            }
        }
        let own = |id: &str| registry.get(id).expect("shipped").domain();
        assert_eq!(own("general").lender_of("operating_room"), Some("hospital"));
        assert!(own("hospital").room_type("sales_floor").is_none(), "what is lent is no room type of its own");
    }
}
