//! Which documents count at all, before anything is ranked.

/// A condition on facets and numbers. A document without the facet or number never fulfills a condition on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Filter {
    /// Every document.
    #[default]
    Everything,
    /// One of the values is among the document's.
    Facet {
        /// The facet.
        name: String,
        /// Values, compared exactly.
        any_of: Vec<String>,
    },
    /// The number is within both limits, themselves included.
    Number {
        /// The number.
        name: String,
        /// The least, if any.
        min: Option<f64>,
        /// The greatest, if any.
        max: Option<f64>,
    },
    /// All of these; of none, every document.
    All(Vec<Filter>),
    /// One of these at least; of none, no document.
    Any(Vec<Filter>),
    /// Not this.
    Not(Box<Filter>),
}

impl Filter {
    /// Asks for one of these values of a facet.
    #[must_use]
    pub fn facet<V: AsRef<str>>(name: &str, any_of: impl IntoIterator<Item = V>) -> Self {
        Self::Facet { name: name.to_owned(), any_of: any_of.into_iter().map(|v| v.as_ref().to_owned()).collect() }
    }

    /// Asks for a number from `min` to `max`.
    #[must_use]
    pub fn number(name: &str, min: Option<f64>, max: Option<f64>) -> Self {
        Self::Number { name: name.to_owned(), min, max }
    }

    /// Asks for this and that.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Everything, filter) | (filter, Self::Everything) => filter,
            (Self::All(mut all), filter) => {
                all.push(filter);
                Self::All(all)
            }
            (filter, other) => Self::All(vec![filter, other]),
        }
    }

    /// Asks for what this leaves out.
    #[must_use]
    pub fn negate(self) -> Self {
        Self::Not(Box::new(self))
    }
}
