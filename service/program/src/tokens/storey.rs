//! Which storey a word means: "first floor", "upstairs".

/// A word for a storey.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Where {
    /// So many storeys above the ground.
    Level(i32),
    /// "First floor": the ground floor or the one above it, by country.
    Nth(i32),
    /// Any but the ground floor.
    Upper,
    /// The highest.
    Top,
    /// Every one.
    Each,
}

impl Where {
    /// Reads `level 1`, `nth 2`, `upper`, `top`, `each` of `words.toml`.
    pub(crate) fn of(text: &str) -> Option<Self> {
        let (word, number) = text.split_once(' ').unwrap_or((text, "0"));
        let n: i32 = number.parse().ok()?;
        match word {
            "level" => Some(Self::Level(n)),
            "nth" => Some(Self::Nth(n)),
            "upper" => Some(Self::Upper),
            "top" => Some(Self::Top),
            "each" => Some(Self::Each),
            _ => None,
        }
    }
}
