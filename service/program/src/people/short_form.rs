//! Short forms of homes: "2BHK", "3LDK", "T3", "3-Zimmer-Wohnung".

use std::collections::BTreeMap;

use crate::tokens::text::Span;

/// Rooms that a short form stands for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ShortForm {
    pub span: Span,
    /// Room types and how many.
    pub rooms: BTreeMap<String, i64>,
    /// True where one number counts all rooms to live in, whichever they are: "3-Zimmer-Wohnung", "T3".
    pub pooled: bool,
}

impl ShortForm {
    pub(crate) fn pooled(span: Span, rooms: BTreeMap<String, i64>) -> Self {
        Self { span, rooms, pooled: true }
    }

    pub(crate) fn of_each(span: Span, rooms: BTreeMap<String, i64>) -> Self {
        Self { span, rooms, pooled: false }
    }
}
