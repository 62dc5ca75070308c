//! Ids that every format takes: letters, digits and underscores, none twice in a scene.

use std::collections::BTreeSet;

/// The ids given so far.
#[derive(Default)]
pub(super) struct Ids(BTreeSet<String>);

impl Ids {
    /// Returns an id that nothing else has: the name itself where it is one and free.
    pub fn new_id(&mut self, name: &str) -> String {
        let mut id: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        if id.starts_with(|c: char| !c.is_ascii_alphabetic()) || id.is_empty() {
            id.insert_str(0, "id_");
        }
        let numbered = (2..).map(|n| format!("{id}_{n}"));
        let free = std::iter::once(id.clone()).chain(numbered).find(|id| !self.0.contains(id));
        let id = free.unwrap_or(id);
        self.0.insert(id.clone());
        id
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_names_everywhere_and_each_is_given_once() {
        let mut ids = Ids::default();
        let given = ["door_1", "door_1", "3rd-floor/küche", "", "door_1_2"].map(|name| ids.new_id(name));
        assert_eq!(given, ["door_1", "door_1_2", "id_3rd_floor_k_che", "id_", "door_1_2_2"]);
    }
}
