//! The numbers of fields and enum values: those of the proto files there are, and new ones behind them.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;

/// What one message or enum has given away.
#[derive(Debug, Default, Clone)]
pub struct Given {
    /// Number by name.
    pub numbers: BTreeMap<String, i32>,
    /// Numbers that are not to be used again.
    pub reserved: BTreeSet<i32>,
    /// Names that are not to be used again.
    pub reserved_names: BTreeSet<String>,
}

/// What the contract has given away so far.
#[derive(Debug, Default)]
pub struct Numbers {
    by_type: BTreeMap<String, Given>,
}

impl Numbers {
    /// Reads the proto files below `root`; there may be none yet.
    pub fn read(root: &Path) -> Result<Self, Box<dyn Error>> {
        let mut files: Vec<_> = std::fs::read_dir(root.join("d3dgen/v1"))?
            .map(|entry| Ok(entry?.path()))
            .collect::<Result<_, std::io::Error>>()?;
        files.retain(|f| f.extension().is_some_and(|e| e == "proto"));
        files.sort();
        let mut by_type = BTreeMap::new();
        for file in protox::compile(&files, [root])?.file {
            for message in file.message_type {
                let mut given = Given::default();
                for field in &message.field {
                    given.numbers.insert(field.name().to_owned(), field.number());
                }
                given.reserved.extend(message.reserved_range.iter().flat_map(|r| r.start()..r.end()));
                given.reserved_names.extend(message.reserved_name.iter().cloned());
                by_type.insert(message.name().to_owned(), given);
            }
            for list in file.enum_type {
                let mut given = Given::default();
                for value in &list.value {
                    given.numbers.insert(value.name().to_owned(), value.number());
                }
                given.reserved.extend(list.reserved_range.iter().flat_map(|r| r.start()..=r.end()));
                given.reserved_names.extend(list.reserved_name.iter().cloned());
                by_type.insert(list.name().to_owned(), given);
            }
        }
        Ok(Self { by_type })
    }

    /// Returns a number for each name, those given away before kept; what is no longer named becomes reserved.
    pub fn give(&mut self, owner: &str, names: &[&str]) -> Given {
        let mut given = self.by_type.remove(owner).unwrap_or_default();
        let gone: Vec<String> = given.numbers.keys().filter(|n| !names.contains(&n.as_str())).cloned().collect();
        for name in gone {
            given.reserved.extend(given.numbers.remove(&name));
            given.reserved_names.insert(name);
        }
        let mut next = given.numbers.values().chain(&given.reserved).copied().max().unwrap_or(0) + 1;
        for name in names {
            if !given.numbers.contains_key(*name) {
                given.reserved_names.remove(*name);
                given.numbers.insert((*name).to_owned(), next);
                next += 1;
            }
        }
        given
    }
}

/// Returns `RoomType` as `ROOM_TYPE`.
pub fn screaming(name: &str) -> String {
    let mut out = String::new();
    for (i, c) in name.chars().enumerate() {
        if i > 0 && c.is_ascii_uppercase() {
            out.push('_');
        }
        out.push(c.to_ascii_uppercase());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_and_are_not_used_again() {
        let mut numbers = Numbers::default();
        let first = numbers.give("Size", &["width_m", "depth_m", "height_m"]);
        assert_eq!(first.numbers["height_m"], 3);
        numbers.by_type.insert("Size".into(), first);
        let next = numbers.give("Size", &["height_m", "color", "width_m"]);
        let found: Vec<(&str, i32)> = next.numbers.iter().map(|(n, i)| (n.as_str(), *i)).collect();
        assert_eq!(found, [("color", 4), ("height_m", 3), ("width_m", 1)]);
        assert_eq!((next.reserved, next.reserved_names), ([2].into(), ["depth_m".to_owned()].into()));
    }
}
