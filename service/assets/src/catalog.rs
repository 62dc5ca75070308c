//! What a thing can be: the objects of all domains with every name they go by, their sizes and where they belong.
//!
//! The objects come from the domains; `data/words_*.txt` adds names, German ones, and what each is for.

mod makers;
mod thesaurus;

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Domain, Mount, ObjectType, Shape};

use crate::words;
pub use makers::{Makers, ModelFacts};
pub use thesaurus::{kind_affordances, kind_density, kind_fits_people, kinds};

/// The objects of some domains.
#[derive(Debug, Clone, Default)]
pub struct Catalog {
    objects: Vec<CatalogObject>,
    by_id: BTreeMap<String, usize>,
    /// First word, or the whole joined, of each name -> object and name.
    names: BTreeMap<String, Vec<(usize, usize)>>,
    labels: BTreeMap<String, String>,
    /// The words of each, singular.
    label_words: BTreeMap<String, Vec<String>>,
    makers: Makers,
}

/// One object under all its names, of all domains that have it.
#[derive(Debug, Clone, PartialEq)]
pub struct CatalogObject {
    /// Id.
    pub object_id: String,
    /// Name for people.
    pub label: String,
    /// Domains that have it, in the order in which they were given.
    pub domains: Vec<String>,
    /// `[width, depth, height]` in m, most common first, of all its domains.
    pub sizes_m: Vec<[f64; 3]>,
    /// Where it is fixed.
    pub mount: Mount,
    /// Height of its underside above the floor, m.
    pub mount_height_m: Option<f64>,
    /// Kind word of the ASA tag standard.
    pub kind: String,
    /// Its build.
    pub shape: Shape,
    /// CSS color of the main part.
    pub color: String,
    /// Main material word.
    pub material: String,
    /// What a person does with it, main thing first.
    pub affordances: Vec<String>,
    /// Free tags of its domains.
    pub tags: Vec<String>,
    /// Room types that want it, over all its domains.
    pub room_types: Vec<String>,
    /// Other English names.
    pub names: Vec<String>,
    /// German names, and those of other languages.
    pub foreign_names: Vec<String>,
    /// What it is for, a phrase.
    pub purpose: String,
    /// Each name as words.
    terms: Vec<Vec<String>>,
    /// All words of names and purpose, singular.
    words: BTreeSet<String>,
    /// All words of its rooms, singular.
    room_words: BTreeSet<String>,
}

/// An object that a name may mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NameMatch<'c> {
    /// The object.
    pub object: &'c CatalogObject,
    /// Share of the telling words of the name that the object's name explains, 0 to 1.
    pub coverage: f64,
    /// How many words of the name are explained.
    pub matched_words: usize,
}

impl Catalog {
    /// Returns the catalog of some domains; an object that several have is one entry.
    pub fn new<'d>(domains: impl IntoIterator<Item = &'d Domain>) -> Self {
        let mut catalog = Self::default();
        for domain in domains {
            let rooms = rooms_of(domain);
            catalog.makers.add(domain);
            catalog.labels.extend(domain.room_types.iter().map(|t| (t.id.clone(), t.label.clone())));
            for object in &domain.objects {
                catalog.add(domain, object, rooms.get(object.id.as_str()));
            }
        }
        catalog.label_words =
            catalog.labels.iter().map(|(id, label)| (id.clone(), singular_words(label).collect())).collect();
        for (index, object) in catalog.objects.iter_mut().enumerate() {
            object.finish(&catalog.labels);
            for (at, term) in object.terms.iter().enumerate() {
                let keys: BTreeSet<String> = term.first().cloned().into_iter().chain([term.concat()]).collect();
                keys.into_iter().for_each(|key| catalog.names.entry(key).or_default().push((index, at)));
            }
        }
        catalog
    }

    /// Returns the objects, in the order of the domains.
    pub fn objects(&self) -> &[CatalogObject] {
        &self.objects
    }

    /// Returns what the models of the objects say.
    pub fn makers(&self) -> &Makers {
        &self.makers
    }

    /// Returns an object by its id.
    pub fn object(&self, object_id: &str) -> Option<&CatalogObject> {
        self.by_id.get(object_id).map(|&i| &self.objects[i])
    }

    /// Returns the name of a room type for people.
    pub fn room_label(&self, room_type: &str) -> Option<&str> {
        self.labels.get(room_type).map(String::as_str)
    }

    /// Returns the ids of all room types with the words of their names, singular.
    pub fn room_types(&self) -> impl Iterator<Item = (&str, &[String])> {
        self.label_words.iter().map(|(id, words)| (id.as_str(), words.as_slice()))
    }

    /// Returns what a name may mean, best first: objects of which one name is wholly in it.
    pub fn match_name(&self, name: &[String]) -> Vec<NameMatch<'_>> {
        let name: Vec<String> = name.iter().map(|w| words::singular(w)).collect();
        let have: BTreeSet<&str> = name.iter().map(String::as_str).collect();
        let joined: BTreeMap<String, [&str; 2]> = name.windows(2).map(|p| (p.concat(), [&*p[0], &*p[1]])).collect();
        let telling = have.iter().filter(|w| !words::is_beside_the_point(w)).count();
        let mut best: BTreeMap<usize, (usize, f64)> = BTreeMap::new();
        for key in have.iter().copied().chain(joined.keys().map(String::as_str)) {
            for &(index, at) in self.names.get(key).into_iter().flatten() {
                let term = &self.objects[index].terms[at];
                let explained: BTreeSet<&str> = if term.iter().all(|w| have.contains(w.as_str())) {
                    term.iter().map(String::as_str).collect()
                } else {
                    let whole = term.concat();
                    match (have.get(whole.as_str()), joined.get(&whole)) {
                        (Some(word), _) => BTreeSet::from([*word]),
                        (None, Some(pair)) => pair.iter().copied().collect(),
                        (None, None) => continue,
                    }
                };
                let told = explained.iter().filter(|w| !words::is_beside_the_point(w)).count();
                if told == 0 {
                    continue;
                }
                let found = (explained.len(), told as f64 / telling.max(1) as f64);
                let entry = best.entry(index).or_insert(found);
                if found.1 > entry.1 || found.1 == entry.1 && found.0 > entry.0 {
                    *entry = found;
                }
            }
        }
        let mut matches: Vec<(usize, NameMatch<'_>)> = best
            .into_iter()
            .map(|(i, (matched_words, coverage))| (i, NameMatch { object: &self.objects[i], coverage, matched_words }))
            .collect();
        matches.sort_by(|(i, a), (j, b)| {
            let order = b.coverage.total_cmp(&a.coverage).then(b.matched_words.cmp(&a.matched_words));
            order.then(i.cmp(j))
        });
        matches.into_iter().map(|(_, m)| m).collect()
    }

    fn add(&mut self, domain: &Domain, object: &ObjectType, rooms: Option<&BTreeSet<&str>>) {
        let index = *self.by_id.entry(object.id.clone()).or_insert_with(|| {
            self.objects.push(CatalogObject::new(object));
            self.objects.len() - 1
        });
        let entry = &mut self.objects[index];
        entry.domains.push(domain.id.clone());
        extend(&mut entry.tags, object.tags.iter().cloned());
        extend(&mut entry.affordances, object.affordances.iter().cloned());
        extend(&mut entry.room_types, rooms.into_iter().flatten().map(|r| (*r).to_owned()));
        for size in &object.sizes_m {
            if !entry.sizes_m.contains(size) {
                entry.sizes_m.push(*size);
            }
        }
        for (language, list) in &object.keywords {
            let names = if language == "en" { &mut entry.names } else { &mut entry.foreign_names };
            extend(names, list.iter().cloned());
        }
    }
}

impl CatalogObject {
    fn new(object: &ObjectType) -> Self {
        let known = thesaurus::entry(&object.id);
        let kind = known.map(|k| k.kind).filter(|k| !k.is_empty());
        let list = |text: &str| text.split(',').map(|w| w.trim().to_owned()).filter(|w| !w.is_empty()).collect();
        Self {
            object_id: object.id.clone(),
            label: object.label.clone(),
            domains: Vec::new(),
            sizes_m: Vec::new(),
            mount: object.mount,
            mount_height_m: object.mount_height_m,
            kind: kind.unwrap_or_else(|| thesaurus::kind_of_shape(object.shape)).to_owned(),
            shape: object.shape,
            color: object.color.clone(),
            material: object.material.clone(),
            affordances: Vec::new(),
            tags: Vec::new(),
            room_types: Vec::new(),
            names: known.map(|k| list(k.names)).unwrap_or_default(),
            foreign_names: known.map(|k| list(k.german)).unwrap_or_default(),
            purpose: known.map(|k| k.purpose.to_owned()).unwrap_or_default(),
            terms: Vec::new(),
            words: BTreeSet::new(),
            room_words: BTreeSet::new(),
        }
    }

    /// Collects the names as words, once all domains have said theirs.
    fn finish(&mut self, labels: &BTreeMap<String, String>) {
        if self.affordances.is_empty() {
            self.affordances = kind_affordances(&self.kind).iter().map(|a| (*a).to_owned()).collect();
        }
        let id = self.object_id.replace('_', " ");
        let mut terms: Vec<Vec<String>> = Vec::new();
        for name in [&self.label, &id].into_iter().chain(&self.names).chain(&self.foreign_names) {
            let mut term: Vec<String> = words::split(name).iter().map(|w| words::singular(w)).collect();
            term.retain(|w| !w.is_empty() && !w.starts_with(|c: char| c.is_ascii_digit()));
            if !term.is_empty() && !terms.contains(&term) {
                terms.push(term);
            }
        }
        self.words = terms.iter().flatten().cloned().collect();
        self.words.extend(singular_words(&self.purpose));
        let rooms = self.room_types.iter().filter_map(|r| labels.get(r));
        self.room_words = rooms.flat_map(|label| singular_words(label)).collect();
        self.terms = terms;
    }

    /// Returns all words of its names and its purpose, singular.
    pub fn words(&self) -> &BTreeSet<String> {
        &self.words
    }

    /// Returns all words of the names of its rooms, singular.
    pub fn room_words(&self) -> &BTreeSet<String> {
        &self.room_words
    }

    /// Returns its names as words: label, id, other names.
    pub fn terms(&self) -> &[Vec<String>] {
        &self.terms
    }
}

/// Returns for each object the room types whose furniture has it.
fn rooms_of(domain: &Domain) -> BTreeMap<&str, BTreeSet<&str>> {
    let mut found: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for room in &domain.room_types {
        for line in &room.furnishing {
            let mut add = |object: &'_ str| {
                if let Some(object) = domain.objects.iter().find(|o| o.id == object) {
                    found.entry(&object.id).or_default().insert(&room.id);
                }
            };
            match domain.groups.iter().find(|g| g.id == line.item) {
                Some(group) => {
                    add(&group.anchor);
                    group.members.iter().for_each(|m| add(&m.object));
                }
                None => add(&line.item),
            }
        }
    }
    found
}

fn singular_words(text: &str) -> impl Iterator<Item = String> + use<> {
    words::split(text).into_iter().map(|w| words::singular(&w))
}

fn extend(list: &mut Vec<String>, new: impl Iterator<Item = String>) {
    for value in new {
        if !list.contains(&value) {
            list.push(value);
        }
    }
}

#[cfg(test)]
mod tests;
