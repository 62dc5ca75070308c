//! How the models of the objects are made, and what each says of itself: the one source of what the library tells of
//! triangles, masses and joints.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use d3dgen_mesh::{Joint, Model3d, builds, mass};
use d3dgen_model::domain::{Domain, ObjectType};

/// What a model says of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelFacts {
    /// Number of triangles.
    pub triangle_count: u64,
    /// Mass of all its bodies, where it is and how it resists, with every joint at zero.
    pub inertia: mass::Inertia,
    /// Its joints.
    pub joints: Vec<Joint>,
}

impl ModelFacts {
    /// Returns what a model says of itself.
    pub fn of(model: &Model3d) -> Self {
        Self {
            triangle_count: model.triangle_count() as u64,
            inertia: mass::whole(model),
            joints: model.joints.clone(),
        }
    }
}

/// Domain, object and size in mm.
type Key = (String, String, [i64; 3]);

/// Makes models of the objects of some domains, and remembers what they said.
#[derive(Debug, Clone, Default)]
pub struct Makers {
    types: BTreeMap<String, BTreeMap<String, ObjectType>>,
    builds: BTreeMap<String, builds::Library>,
    known: Arc<Mutex<BTreeMap<Key, Option<Arc<ModelFacts>>>>>,
}

impl Makers {
    /// Takes the objects and builds of a domain in.
    pub fn add(&mut self, domain: &Domain) {
        let types = domain.objects_by_id().into_values().map(|o| (o.id.clone(), o.clone())).collect();
        self.types.insert(domain.id.clone(), types);
        self.builds.insert(domain.id.clone(), builds::Library::shipped().with(&domain.builds));
    }

    /// Returns what the model of an object says, as its domain makes it with seed 0; none when it cannot be made.
    pub fn facts(&self, domain: &str, object: &str, size_m: [f64; 3]) -> Option<Arc<ModelFacts>> {
        let key = (domain.to_owned(), object.to_owned(), size_m.map(|v| (v * 1000.0).round() as i64));
        if let Some(known) = self.known.lock().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return known.clone();
        }
        // Made without the lock: what two make at once is the same.
        let object = self.types.get(domain).and_then(|types| types.get(object));
        let model = object.zip(self.builds.get(domain)).and_then(|(o, b)| builds::generate(b, o, size_m, 0).ok());
        let facts = model.map(|m| Arc::new(ModelFacts::of(&m)));
        self.known.lock().unwrap_or_else(PoisonError::into_inner).insert(key, facts.clone());
        facts
    }
}
