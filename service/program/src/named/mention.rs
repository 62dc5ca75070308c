//! One mention: a room, people or a total that a prompt names, with its number.

use crate::tokens::text::Span;

/// What a mention is about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum What {
    /// A room type of the domain, of another domain, or a slug of the prompt's own words.
    Room(String),
    /// A robot's charging, named by a verb or a place that need not be a room.
    Charge,
    /// The entrance of the building.
    Entrance,
    /// Rooms in total.
    Total,
    Staff,
    People,
    Visitors,
    Beds,
    Desks,
    Residents,
}

/// One mention.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mention {
    pub span: Span,
    pub what: What,
    /// The number before (or, in some languages, after) it.
    pub count: Option<i64>,
    /// True for "a", "eine": one of them, perhaps only an article.
    pub article: bool,
    /// True for "several".
    pub vague: bool,
    /// True for a plural form.
    pub plural: bool,
    /// True after "the" and the like.
    pub definite: bool,
    /// First token of the number or article, or of the mention itself.
    pub from: usize,
    /// Where the number stands.
    pub number: Option<Span>,
    /// Beds of each such room, where the prompt says so.
    pub beds: Option<u32>,
    /// Places to be treated at of each such room, where the prompt says so.
    pub places: Option<u32>,
    /// Its own number: "bedroom 2".
    pub numbered: Option<Numbered>,
}

impl Mention {
    /// Returns a mention of which nothing more is known yet.
    pub(crate) fn plain(span: Span, what: What) -> Self {
        let from = span.start;
        Self {
            span,
            what,
            count: None,
            article: false,
            vague: false,
            plural: false,
            definite: false,
            from,
            number: None,
            beds: None,
            places: None,
            numbered: None,
        }
    }

    /// Returns the end of its words, with the number of its own.
    pub(crate) fn end(&self) -> usize {
        self.numbered.map_or(self.span.end, |n| n.span.end)
    }

    pub(crate) fn room_type(&self) -> Option<&str> {
        if let What::Room(id) = &self.what { Some(id) } else { None }
    }
}

/// The number of a room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Numbered {
    pub n: u32,
    /// Where it stands.
    pub span: Span,
}
