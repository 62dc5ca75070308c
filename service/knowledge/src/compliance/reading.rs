//! One measured figure, and how near it may come to its limit.

/// Lengths and areas closer than this to their limit meet it.
pub(crate) const SLACK: f64 = 1e-3;

/// A measured figure of one thing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reading {
    /// Id of the room, door or placement, or `building`.
    pub subject: String,
    /// The figure, in the constraint's unit.
    pub value: f64,
}

impl Reading {
    /// Returns the figure of a thing.
    pub(super) fn new(subject: &str, value: f64) -> Self {
        Self { subject: subject.to_owned(), value }
    }

    /// Returns the reading of a statement: 1 when it holds.
    pub(super) fn flag(subject: &str, holds: bool) -> Self {
        Self::new(subject, if holds { 1.0 } else { 0.0 })
    }
}
