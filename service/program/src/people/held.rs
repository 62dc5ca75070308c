//! Rooms of which a prompt says how many places they have.

/// Rooms of a type with so many beds each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Held {
    pub room_type: String,
    pub count: u32,
    pub beds: u32,
}
