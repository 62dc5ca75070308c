//! How a building is to be, beside what rooms it has: cluttered or bare, compact or generous, cells or open floor,
//! symmetric or not.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Wishes about the manner of a building; what is absent is left to the domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Style {
    /// How many small everyday things stand on furniture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clutter: Option<Clutter>,
    /// How large rooms are within the ranges of their types.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub space: Option<SpaceStyle>,
    /// Whether rooms that may be one are parted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layout: Option<LayoutStyle>,
    /// Whether plans are alike on both sides of the axis of the entrance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub symmetry: Option<Symmetry>,
    /// What form the building has, seen from above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<Form>,
}

/// How many small everyday things stand on furniture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Clutter {
    /// Tops are bare but for what a room is about.
    Low,
    /// As the furnishing lines of the domain say.
    Normal,
    /// As people live and work: the domain's clutter lines too.
    High,
}

/// How large rooms are within the ranges of their types.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpaceStyle {
    /// Smaller than usual.
    Compact,
    /// Larger than usual.
    Generous,
}

/// Whether rooms that may be one are parted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LayoutStyle {
    /// Rooms with walls and doors; small offices rather than an open floor.
    Cellular,
    /// Wide openings between the rooms of the day; an open floor rather than small offices.
    Open,
}

/// Whether plans are alike on both sides of the axis of the entrance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Symmetry {
    /// As alike as the rooms allow.
    Symmetric,
    /// Unlike on purpose.
    Asymmetric,
}

/// What form a building has, seen from above.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// A bar along one corridor.
    Linear,
    /// Two wings at a right angle.
    LShaped,
    /// A ring of corridors around a core.
    Racetrack,
    /// A court with the building all around it.
    Courtyard,
    /// Wings off a spine, with courtyards between.
    Wings,
}

/// One word of style.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StyleWord {
    /// Of `clutter`.
    Clutter(Clutter),
    /// Of `space`.
    Space(SpaceStyle),
    /// Of `layout`.
    Layout(LayoutStyle),
    /// Of `symmetry`.
    Symmetry(Symmetry),
    /// Of `form`.
    Form(Form),
}

impl Clutter {
    /// Every grade by its name.
    pub const NAMES: [(&'static str, Self); 3] = [("low", Self::Low), ("normal", Self::Normal), ("high", Self::High)];

    /// Returns the grade of a name; `None` for any other.
    pub fn of(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|n| n.0 == name).map(|n| n.1)
    }

    /// Returns its name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|n| n.1 == self).map_or("normal", |n| n.0)
    }
}

impl StyleWord {
    /// Every word that a flag or request may say, clutter aside.
    pub const NAMES: [(&'static str, Self); 11] = [
        ("compact", Self::Space(SpaceStyle::Compact)),
        ("generous", Self::Space(SpaceStyle::Generous)),
        ("cellular", Self::Layout(LayoutStyle::Cellular)),
        ("open", Self::Layout(LayoutStyle::Open)),
        ("symmetric", Self::Symmetry(Symmetry::Symmetric)),
        ("asymmetric", Self::Symmetry(Symmetry::Asymmetric)),
        ("linear", Self::Form(Form::Linear)),
        ("l_shaped", Self::Form(Form::LShaped)),
        ("racetrack", Self::Form(Form::Racetrack)),
        ("courtyard", Self::Form(Form::Courtyard)),
        ("wings", Self::Form(Form::Wings)),
    ];

    /// Returns its name as people say it: `compact`, `low clutter`.
    pub fn label(self) -> String {
        match self {
            Self::Clutter(grade) => format!("{} clutter", grade.name()),
            other => Self::NAMES.iter().find(|n| n.1 == other).map_or("", |n| n.0).to_owned(),
        }
    }

    /// Returns the word of a name, `clutter_low` among them; `None` for any other.
    pub fn of(name: &str) -> Option<Self> {
        let clutter = || Some(Self::Clutter(Clutter::of(name.strip_prefix("clutter_")?)?));
        Self::NAMES.iter().find(|n| n.0 == name).map(|n| n.1).or_else(clutter)
    }
}

impl Style {
    /// Returns true when nothing is wished.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }

    /// Returns its words, clutter aside.
    pub fn words(&self) -> impl Iterator<Item = &'static str> {
        let own = [
            self.space.map(StyleWord::Space),
            self.layout.map(StyleWord::Layout),
            self.symmetry.map(StyleWord::Symmetry),
            self.form.map(StyleWord::Form),
        ];
        own.into_iter().flatten().filter_map(|word| StyleWord::NAMES.iter().find(|n| n.1 == word).map(|n| n.0))
    }

    /// Adds a word; false, and no change, when the opposite was said before.
    pub fn add(&mut self, word: StyleWord) -> bool {
        fn put<T: PartialEq>(place: &mut Option<T>, value: T) -> bool {
            let free = place.as_ref().is_none_or(|old| *old == value);
            if free {
                *place = Some(value);
            }
            free
        }
        match word {
            StyleWord::Clutter(v) => put(&mut self.clutter, v),
            StyleWord::Space(v) => put(&mut self.space, v),
            StyleWord::Layout(v) => put(&mut self.layout, v),
            StyleWord::Symmetry(v) => put(&mut self.symmetry, v),
            StyleWord::Form(v) => put(&mut self.form, v),
        }
    }

    /// Returns the wishes of `self`, and where it has none those of `other`.
    pub fn or(self, other: Self) -> Self {
        Self {
            clutter: self.clutter.or(other.clutter),
            space: self.space.or(other.space),
            layout: self.layout.or(other.layout),
            symmetry: self.symmetry.or(other.symmetry),
            form: self.form.or(other.form),
        }
    }

    /// Returns the style that a list of words states, clutter aside.
    ///
    /// # Errors
    /// A sentence that names the word and what would work.
    pub fn of_words<'a>(words: impl IntoIterator<Item = &'a str>) -> Result<Self, String> {
        let mut style = Self::default();
        for word in words {
            let known = StyleWord::NAMES.iter().find(|n| n.0 == word).map(|n| n.1);
            let Some(known) = known else {
                let names: Vec<&str> = StyleWord::NAMES.iter().map(|n| n.0).collect();
                return Err(format!("style `{word}` is not known; known are {}", names.join(", ")));
            };
            if !style.add(known) {
                return Err(format!("style `{word}` contradicts a word before it; leave one of the two out"));
            }
        }
        Ok(style)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_add_up_and_opposites_are_refused() {
        let style = Style::of_words(["compact", "open", "symmetric"]).unwrap();
        assert_eq!(style.space, Some(SpaceStyle::Compact));
        assert_eq!(style.layout, Some(LayoutStyle::Open));
        assert!(Style::of_words(["compact", "generous"]).unwrap_err().contains("`generous` contradicts"));
        assert!(Style::of_words(["baroque"]).unwrap_err().contains("known are compact, generous"));
        assert_eq!(StyleWord::of("clutter_high"), Some(StyleWord::Clutter(Clutter::High)));
        let wished = Style { clutter: Some(Clutter::Low), ..Style::default() };
        assert_eq!(wished.or(Style { clutter: Some(Clutter::High), ..style }).clutter, Some(Clutter::Low));
        assert_eq!(serde_json::to_value(wished).unwrap(), serde_json::json!({ "clutter": "low" }));
    }
}
