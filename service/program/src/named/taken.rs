//! The words that other readers have taken before rooms are looked for.

use super::compounds::Compound;
use crate::people::beds::BedRoom;
use crate::tokens::text::Span;

/// What the other readers have taken already.
pub(crate) struct Taken<'a> {
    /// Places, areas, short forms, robots.
    pub spans: &'a [Span],
    /// Words that name the building.
    pub head: Option<Span>,
    /// All words for buildings.
    pub buildings: &'a [Span],
    pub list_from: usize,
    /// Things that a number before them counts: robots, areas. No number counts what stands behind them.
    pub counted: &'a [Span],
    /// Words for a robot's dock.
    pub docks: &'a [Span],
    /// Rooms that are told by their beds.
    pub bed_rooms: &'a [BedRoom],
    /// Words for several rooms.
    pub compounds: &'a [Compound],
    /// True for a prompt in a language that is not read: no word of it is the name of a room by its form alone.
    pub unread: bool,
}
