//! Models made from builds: which build an object uses, and the model it gives at a size.
//!
//! Builds are data (`d3dgen_model::domain::Build`, shipped ones in `domains/builds/`); nothing here names a chair.

mod bodies;
mod collide;
mod copies;
mod make;
mod scope;
mod solids;
pub(crate) mod tones;
mod unwrap;

pub use solids::triangulate;
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use d3dgen_model::document::Problem;
use d3dgen_model::domain::{Build, Domain, ObjectType, Shape};

use crate::error::Error;
use crate::model3d::Model3d;
use solids::Detail;

/// Most triangles of a generated model.
pub const MOST_TRIANGLES: usize = 5_000;

/// The builds that objects can use.
#[derive(Debug, Clone, Default)]
pub struct Library {
    builds: BTreeMap<String, Arc<Entry>>,
    /// Object id -> id of the build whose `for` lists it.
    by_object: BTreeMap<String, String>,
}

/// A build, read when it is first used: a world uses a few dozen of hundreds.
#[derive(Debug)]
struct Entry {
    json: &'static str,
    build: OnceLock<Build>,
}

impl Entry {
    fn get(&self) -> &Build {
        self.build.get_or_init(|| serde_json::from_str(self.json).expect("a test reads every shipped build"))
    }
}

impl Library {
    /// Returns the shipped builds (`domains/builds/*.toml`), read once.
    pub fn shipped() -> &'static Self {
        static SHIPPED: OnceLock<Library> = OnceLock::new();
        SHIPPED.get_or_init(|| {
            let mut library = Self::default();
            // A line a build: id, the objects of its `for`, JSON.
            for line in include_str!(concat!(env!("OUT_DIR"), "/builds.txt")).lines() {
                let mut fields = line.splitn(3, '\t');
                let (Some(id), Some(objects), Some(json)) = (fields.next(), fields.next(), fields.next()) else {
                    continue;
                };
                library.builds.insert(id.to_owned(), Arc::new(Entry { json, build: OnceLock::new() }));
                library.by_object.extend(objects.split_whitespace().map(|o| (o.to_owned(), id.to_owned())));
            }
            library
        })
    }

    /// Returns a library of these builds alone.
    ///
    /// # Errors
    /// `Builds` with the first problem and its place.
    pub fn from_builds(builds: &[Build]) -> Result<Self, Error> {
        match Self::problems(builds).into_iter().next() {
            Some(problem) => Err(Error::Builds { path: problem.path, reason: problem.message }),
            None => Ok(Self::default().with(builds)),
        }
    }

    /// Returns every problem of a list of builds.
    pub fn problems(builds: &[Build]) -> Vec<Problem> {
        let mut problems = Vec::new();
        let (mut ids, mut objects) = (BTreeMap::new(), BTreeMap::new());
        for (i, build) in builds.iter().enumerate() {
            build.check(&format!("/builds/{i}"), &mut problems);
            if let Some(first) = ids.insert(&build.id, i) {
                problems.push(Problem::new(
                    format!("/builds/{i}/id"),
                    format!("`{}` is the id of builds/{first} too", build.id),
                ));
            }
            for (j, object) in build.objects.iter().enumerate() {
                if let Some(first) = objects.insert(object, &build.id) {
                    let reason = format!("object `{object}` is made by the build `{first}` already");
                    problems.push(Problem::new(format!("/builds/{i}/for/{j}"), reason));
                }
            }
        }
        problems
    }

    /// Returns this library with the builds of a domain, which win over shipped ones of the same id or objects.
    pub fn with(&self, builds: &[Build]) -> Self {
        let mut library = self.clone();
        for build in builds {
            library.builds.insert(build.id.clone(), Arc::new(Entry { json: "", build: build.clone().into() }));
            for object in &build.objects {
                library.by_object.insert(object.clone(), build.id.clone());
            }
        }
        library
    }

    /// Returns the build with this id.
    pub fn get(&self, id: &str) -> Option<&Build> {
        self.builds.get(id).map(|e| e.get())
    }

    /// Returns whether the build of this id is a shipped one.
    fn is_shipped(&self, id: &str) -> bool {
        self.builds.get(id).is_some_and(|e| !e.json.is_empty())
    }

    /// Returns every build, by id.
    pub fn builds(&self) -> impl Iterator<Item = &Build> {
        self.builds.values().map(|e| e.get())
    }

    /// Returns the build of an object: the one it names, else that of its id, else one that lists it, else that of its
    /// shape.
    ///
    /// # Errors
    /// `NoBuild` when the object names a build that does not exist, or there is none for its shape.
    pub fn of(&self, object: &ObjectType) -> Result<&Build, Error> {
        let missing = |build: &str| Error::NoBuild { object: object.id.clone(), build: build.to_owned() };
        if let Some(id) = &object.build {
            return self.get(id).ok_or_else(|| missing(id));
        }
        self.own(object).or_else(|| self.get(object.shape.name())).ok_or_else(|| missing(object.shape.name()))
    }

    /// Returns the build that an object has beside that of its shape.
    pub fn own(&self, object: &ObjectType) -> Option<&Build> {
        let named = object.build.as_deref().and_then(|id| self.get(id));
        named.or_else(|| self.get(&object.id)).or_else(|| self.by_object.get(&object.id).and_then(|id| self.get(id)))
    }
}

/// Makes the model of an object at `[width, depth, height]`, m.
///
/// The same library, object, size and seed give the same model. Its bounds are the size exactly, the origin is in the
/// middle of the footprint, the front at -y. Where a shipped build cannot be made at a size it was not written for, the
/// build of the object's shape stands in, then a plain box; a build that the object or its domain names must do.
///
/// # Errors
/// `NoBuild` when the object names no build there is, `Size` for a size out of range, `Build` with the part and field
/// when the build cannot be made at this size.
pub fn generate(library: &Library, object: &ObjectType, size_m: [f64; 3], seed: u64) -> Result<Model3d, Error> {
    let build = library.of(object)?;
    let made = generate_by(build, object, size_m, seed);
    if made.is_ok() || object.build.is_some() || !library.is_shipped(&build.id) {
        return made;
    }
    let stand_ins = [object.shape.name(), Shape::Box.name()].into_iter().filter_map(|id| library.get(id));
    let mut others = stand_ins.filter(|b| b.id != build.id).map(|b| generate_by(b, object, size_m, seed));
    others.find(Result::is_ok).unwrap_or(made)
}

/// Makes the model of an object by one build; as [`generate`] without stand-ins.
///
/// # Errors
/// As [`generate`].
pub fn generate_by(build: &Build, object: &ObjectType, size_m: [f64; 3], seed: u64) -> Result<Model3d, Error> {
    if size_m.iter().any(|v| !(0.001..=100.0).contains(v)) {
        return Err(Error::Size { object: object.id.clone(), size: size_text(size_m) });
    }
    let mut triangles = 0;
    // Builds with many copies are cut more coarsely until they keep the budget.
    for detail in [Detail(1.0), Detail(0.6), Detail(0.4)] {
        let model = make::model(build, object, size_m, seed, detail)?;
        triangles = model.triangle_count();
        if triangles <= MOST_TRIANGLES {
            return Ok(model);
        }
    }
    Err(Error::Build {
        build: build.id.clone(),
        size: size_text(size_m),
        place: "parts".to_owned(),
        reason: format!("gives {triangles} triangles, the limit is {MOST_TRIANGLES}; use fewer or plainer parts"),
    })
}

/// Returns every object of a domain whose model cannot be made, by its path in the domain.
///
/// Only builds of the domain itself and those its objects name are tried: shipped ones have stand-ins.
pub fn problems(domain: &Domain) -> Vec<Problem> {
    let library = Library::shipped().with(&domain.builds);
    let mut problems = Vec::new();
    for (i, object) in domain.objects.iter().enumerate() {
        match library.of(object) {
            Err(error) => problems.push(Problem::new(format!("/objects/{i}/build"), error.to_string())),
            Ok(build) if object.build.is_none() && library.is_shipped(&build.id) => {}
            Ok(build) => {
                for (j, size) in object.sizes_m.iter().enumerate() {
                    if let Err(error) = generate_by(build, object, *size, 0) {
                        problems.push(Problem::new(format!("/objects/{i}/sizes_m/{j}"), error.to_string()));
                    }
                }
            }
        }
    }
    problems
}

fn size_text(size: [f64; 3]) -> String {
    let [w, d, h] = size.map(|v| (v * 1e4).round() / 1e4);
    format!("{w} x {d} x {h}")
}

#[cfg(test)]
mod tests;
