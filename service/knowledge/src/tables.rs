//! The tables that give constraints a meaning: quantities, spaces and conditions, read from `data/*.toml`.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use d3dgen_model::domain::Shape;
use d3dgen_model::knowledge::Constraint;
use serde::Deserialize;

use crate::measure::Measure;

/// The tables that ship with the crate.
pub(crate) static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    let quantities: Quantities = toml::from_str(include_str!("../data/quantities.toml"))
        .expect("data/quantities.toml is part of the crate and read by its tests");
    let named: Reported = toml::from_str(include_str!("../data/quantities_named.toml"))
        .expect("data/quantities_named.toml is part of the crate and read by its tests");
    let reported: Reported = toml::from_str(include_str!("../data/quantities_reported.toml"))
        .expect("data/quantities_reported.toml is part of the crate and read by its tests");
    let spaces: Spaces = toml::from_str(include_str!("../data/spaces.toml"))
        .expect("data/spaces.toml is part of the crate and read by its tests");
    let conditions: Conditions = toml::from_str(include_str!("../data/conditions.toml"))
        .expect("data/conditions.toml is part of the crate and read by its tests");
    let built: Built = toml::from_str(include_str!("../data/conditions_built.toml"))
        .expect("data/conditions_built.toml is part of the crate and read by its tests");
    let mut tables = Tables {
        quantities: [named.quantity, reported.quantity, quantities.quantity].concat(),
        unknown: quantities.unknown,
        spaces: spaces.space,
        conditions: conditions.condition.into_iter().chain(built.condition).collect(),
        documents: conditions.document,
        by_unit_and_space: BTreeMap::new(),
        by_phrase: BTreeMap::new(),
    };
    tables.index();
    tables
});

/// Key of units and spaces that no row names.
const OTHER: &str = "";

/// All tables.
pub(crate) struct Tables {
    pub quantities: Vec<QuantityRow>,
    pub unknown: Vec<UnknownRow>,
    pub spaces: Vec<SpaceRow>,
    pub conditions: Vec<ConditionRow>,
    pub documents: Vec<DocumentRow>,
    /// Rows of `quantities` that may speak of a unit and a space, in their order; [`OTHER`] stands for those no row names.
    by_unit_and_space: BTreeMap<String, BTreeMap<String, Vec<usize>>>,
    /// The first row of `conditions` that lists a phrase whole.
    by_phrase: BTreeMap<String, usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Quantities {
    quantity: Vec<QuantityRow>,
    unknown: Vec<UnknownRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Reported {
    quantity: Vec<QuantityRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Spaces {
    space: Vec<SpaceRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Conditions {
    condition: Vec<ConditionRow>,
    document: Vec<DocumentRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Built {
    condition: Vec<ConditionRow>,
}

/// Which constraints speak of which quantity.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuantityRow {
    /// The quantity.
    pub measure: Measure,
    #[serde(default)]
    units: Vec<String>,
    #[serde(default)]
    bases: Vec<String>,
    #[serde(default)]
    bases_containing: Vec<String>,
    #[serde(default)]
    spaces: Vec<String>,
    #[serde(default)]
    not_spaces: Vec<String>,
    #[serde(default)]
    names: Vec<String>,
    #[serde(default)]
    names_without: Vec<String>,
    /// The other space of distances and pairs of rooms.
    #[serde(default)]
    pub to: Vec<String>,
    /// Builds of the objects that a clearance is about.
    #[serde(default)]
    pub shapes: Vec<Shape>,
    /// Ids of the objects that a size or distance is about.
    #[serde(default)]
    pub objects: Vec<String>,
    /// Builds of the other objects of a distance.
    #[serde(default)]
    pub to_shapes: Vec<Shape>,
    /// Figure that goes before the first step (area of the first workplace, m^2).
    #[serde(default)]
    pub base: f64,
    /// True for ways that count only where the building has one exit.
    #[serde(default)]
    pub single_exit: bool,
    /// True for figures that even regulations only reckon with: breaking them breaks no rule.
    #[serde(default)]
    pub advice: bool,
    /// True when reports judge it and plans do not aim at it.
    #[serde(default)]
    pub reported_only: bool,
    /// Conditions that the name of the constraint says (`gia_2b3p`), as phrases of the conditions.
    #[serde(default)]
    pub conditions: Vec<String>,
    /// True when it is enough that one of the subjects keeps it.
    #[serde(default)]
    pub any: bool,
    /// The only verdict the quantity is sure of; absent when it is sure of both.
    #[serde(default)]
    pub sure: Option<Sure>,
    /// Why it is not sure of the other.
    #[serde(default)]
    pub why: String,
}

/// Why constraints of a unit cannot be decided.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct UnknownRow {
    #[serde(default)]
    pub units: Vec<String>,
    #[serde(default)]
    pub spaces: Vec<String>,
    #[serde(default)]
    pub names: Vec<String>,
    pub reason: String,
}

/// What a general space name stands for.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpaceRow {
    pub names: Vec<String>,
    pub kind: SpaceKind,
    #[serde(default)]
    pub room_types: Vec<String>,
    #[serde(default)]
    pub shapes: Vec<Shape>,
    #[serde(default)]
    pub only_domains: Vec<String>,
    #[serde(default)]
    pub except_domains: Vec<String>,
}

/// Kind of a general space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SpaceKind {
    Circulation,
    AllRooms,
    Doors,
    Entrance,
    Building,
    Rooms,
    Objects,
    Robots,
}

/// What a condition means.
#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConditionRow {
    pub(crate) when: When,
    #[serde(default)]
    pub(crate) phrases: Vec<String>,
    #[serde(default)]
    pub(crate) containing: Vec<String>,
    #[serde(default)]
    pub(crate) min: Option<f64>,
    #[serde(default)]
    pub(crate) max: Option<f64>,
    #[serde(default)]
    pub(crate) room_types: Vec<String>,
    #[serde(default)]
    pub(crate) except: Vec<String>,
    #[serde(default)]
    pub(crate) except_domains: Vec<String>,
    #[serde(default)]
    pub(crate) reason: Option<String>,
    /// Builds of the objects that are counted.
    #[serde(default)]
    pub(crate) shapes: Vec<Shape>,
    /// Ids of the objects that are counted.
    #[serde(default)]
    pub(crate) objects: Vec<String>,
    /// Words of the room's name.
    #[serde(default)]
    pub(crate) words: Vec<String>,
    /// True when reports judge what has it and plans do not aim at it.
    #[serde(default)]
    pub(crate) reported_only: bool,
    /// True when plans aim at the figure for all rooms, though reports ask it of some.
    #[serde(default)]
    pub(crate) planned: bool,
}

/// A document all of whose constraints have one more condition.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DocumentRow {
    pub when: When,
    pub domains: Vec<String>,
    /// Words of its title.
    pub titles: Vec<String>,
}

/// The fact a condition asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum When {
    Always,
    Never,
    Accessible,
    Wheelchair,
    Beds,
    NoBeds,
    Public,
    TwoRobots,
    Persons,
    Area,
    RoomsOf,
    BedsInRoom,
    SeatsInRoom,
    ObjectsInRoom,
    Exits,
    Named,
    OpensInto,
    OpensOut,
    BedspacesInRoom,
    Ceiling,
    Rows,
    DoorsOfRoom,
    RoomLength,
    BothSides,
    Bedspaces,
    BuildingArea,
    Storeys,
    ObjectsInBuilding,
    Robots,
    RobotKind,
    RobotModel,
    BuildingType,
    Unknown,
}

impl When {
    /// Returns true for facts that no document holds.
    pub(crate) fn is_unknown(self) -> bool {
        matches!(self, Self::Unknown | Self::RobotModel)
    }

    /// Returns true for figures of a finished room.
    pub(crate) fn is_of_room(self) -> bool {
        matches!(self, Self::BedspacesInRoom | Self::Ceiling | Self::Rows | Self::DoorsOfRoom)
            || matches!(self, Self::RoomLength | Self::BothSides)
    }

    /// Returns true for figures of a finished building.
    pub(crate) fn is_of_building(self) -> bool {
        matches!(self, Self::Bedspaces | Self::BuildingArea | Self::Storeys | Self::ObjectsInBuilding)
    }
}

/// Which verdict a quantity is sure of, where documents bound it from one side only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sure {
    /// That the constraint is kept.
    Kept,
    /// That it is broken.
    Broken,
}

impl QuantityRow {
    /// Returns true when the row is about this kind of object.
    pub(crate) fn picks(&self, kind: &d3dgen_model::domain::ObjectType) -> bool {
        self.shapes.contains(&kind.shape) || self.objects.contains(&kind.id)
    }

    /// Returns true when the row names the objects it is about.
    pub(crate) fn names_objects(&self) -> bool {
        !self.shapes.is_empty() || !self.objects.is_empty()
    }

    /// Returns true when the row speaks of this constraint.
    pub(crate) fn matches(&self, c: &Constraint) -> bool {
        let among = |list: &[String], word: &str| list.is_empty() || list.iter().any(|w| w == word);
        let part = |list: &[String], text: &str| list.iter().any(|w| text.contains(w.as_str()));
        let basis = match (self.bases.is_empty(), self.bases_containing.is_empty()) {
            (true, true) => true,
            _ => self.bases.contains(&c.measurement_basis) || part(&self.bases_containing, &c.measurement_basis),
        };
        basis
            && among(&self.units, &c.unit)
            && among(&self.spaces, &c.space_type)
            && !self.not_spaces.contains(&c.space_type)
            && (self.names.is_empty() || part(&self.names, &c.name))
            && !part(&self.names_without, &c.name)
    }
}

impl UnknownRow {
    fn explains(&self, c: &Constraint) -> bool {
        self.units.contains(&c.unit)
            || self.spaces.contains(&c.space_type)
            || self.names.iter().any(|n| c.name.contains(n.as_str()))
    }
}

impl ConditionRow {
    /// Returns true when the row counts this kind of object.
    pub(crate) fn counts(&self, kind: &d3dgen_model::domain::ObjectType) -> bool {
        self.shapes.contains(&kind.shape) || self.objects.contains(&kind.id)
    }

    /// Returns true when a figure lies within the row's interval.
    pub(crate) fn holds(&self, figure: f64) -> bool {
        self.min.is_none_or(|m| figure >= m) && self.max.is_none_or(|m| figure <= m)
    }
}

impl Tables {
    /// Sorts the rows by what a constraint can be looked up with: every building asks hundreds of constraints.
    fn index(&mut self) {
        let among = |list: &[String], name: &String| list.is_empty() || list.contains(name);
        let names = |list: fn(&QuantityRow) -> &[String]| -> BTreeSet<String> {
            self.quantities.iter().flat_map(list).cloned().chain([OTHER.to_owned()]).collect()
        };
        let (units, spaces) = (names(|q| &q.units), names(|q| &q.spaces));
        for unit in units {
            let of_unit: Vec<usize> =
                (0..self.quantities.len()).filter(|&i| among(&self.quantities[i].units, &unit)).collect();
            let by_space = spaces.iter().map(|space| {
                let rows = of_unit.iter().copied().filter(|&i| among(&self.quantities[i].spaces, space));
                (space.clone(), rows.collect())
            });
            let by_space = by_space.collect();
            self.by_unit_and_space.insert(unit, by_space);
        }
        for (row, condition) in self.conditions.iter().enumerate() {
            for phrase in &condition.phrases {
                self.by_phrase.entry(phrase.clone()).or_insert(row);
            }
        }
    }

    /// Returns the row that explains a condition: the first that lists the phrase or a part of it.
    pub(crate) fn condition(&self, phrase: &str) -> Option<&ConditionRow> {
        let whole = self.by_phrase.get(phrase).copied();
        let before = whole.unwrap_or(self.conditions.len());
        let part = |c: &&ConditionRow| c.containing.iter().any(|p| phrase.contains(p.as_str()));
        self.conditions[..before].iter().find(part).or_else(|| whole.map(|row| &self.conditions[row]))
    }

    /// Returns what a general space name stands for in a domain.
    pub(crate) fn space(&self, name: &str, domain: &str) -> Option<&SpaceRow> {
        self.spaces.iter().find(|s| {
            s.names.iter().any(|n| n == name)
                && (s.only_domains.is_empty() || s.only_domains.iter().any(|d| d == domain))
                && !s.except_domains.iter().any(|d| d == domain)
        })
    }

    /// Returns the quantity a constraint speaks of.
    pub(crate) fn quantity(&self, c: &Constraint) -> Option<&QuantityRow> {
        self.candidates(c).find(|q| q.matches(c))
    }

    /// Returns the quantity a constraint speaks of where it is one of some measures; most are told by their units alone.
    pub(crate) fn quantity_of(&self, c: &Constraint, wanted: fn(Measure) -> bool) -> Option<&QuantityRow> {
        let may_be = self.candidates(c).any(|q| wanted(q.measure));
        may_be.then(|| self.quantity(c))?.filter(|q| wanted(q.measure))
    }

    /// Returns the rows that know the unit and the space of a constraint.
    fn candidates(&self, c: &Constraint) -> impl Iterator<Item = &QuantityRow> {
        let by_space = self.by_unit_and_space.get(&c.unit).or_else(|| self.by_unit_and_space.get(OTHER));
        let rows = by_space.and_then(|by_space| by_space.get(&c.space_type).or_else(|| by_space.get(OTHER)));
        rows.into_iter().flatten().map(|&row| &self.quantities[row])
    }

    /// Returns why a constraint of no known quantity cannot be decided.
    pub(crate) fn unknown(&self, c: &Constraint) -> String {
        match self.unknown.iter().find(|u| u.explains(c)) {
            Some(row) => row.reason.clone(),
            None => format!("how to measure `{}` of `{}` is not known", c.measurement_basis, c.space_type),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_phrase_and_general_space_has_one_meaning() {
        let mut seen = BTreeSet::new();
        for phrase in TABLES.conditions.iter().flat_map(|c| &c.phrases) {
            assert!(seen.insert(phrase), "condition `{phrase}` stands twice in data/conditions*.toml");
        }
        let mut seen = BTreeSet::new();
        for name in TABLES.spaces.iter().flat_map(|s| &s.names) {
            assert!(seen.insert(name), "space `{name}` stands twice in data/spaces.toml");
        }
    }

    #[test]
    fn conditions_of_quantities_are_known_phrases() {
        for phrase in TABLES.quantities.iter().flat_map(|q| &q.conditions) {
            assert!(TABLES.condition(phrase).is_some(), "`{phrase}` is in no data/conditions*.toml");
        }
        for row in TABLES.quantities.iter().filter(|q| q.sure.is_some()) {
            assert!(!row.why.is_empty() && row.reported_only, "{:?} {:?}", row.measure, row.names);
        }
    }

    #[test]
    fn rows_that_need_figures_have_them() {
        for row in &TABLES.conditions {
            let figures = row.min.is_some() || row.max.is_some();
            let needs = matches!(row.when, When::Persons | When::Area | When::RoomsOf | When::BedsInRoom)
                || matches!(row.when, When::SeatsInRoom | When::ObjectsInRoom | When::Exits)
                || row.when.is_of_room()
                || row.when.is_of_building();
            assert_eq!(figures, needs, "row of {:?}: {:?}", row.when, row.phrases.first());
            assert!(row.when != When::Never || row.reason.is_some(), "{:?}", row.phrases.first());
        }
    }
}
