//! From the reading to the graph: the rooms there are (`program`, `vital`, `large`, `workers`, `layout`), who is in them and what they are
//! entered from (`occupants`, `hosts`), what they are like
//! (`rooms`), and how they connect (`edges`, `ring`).

pub(super) mod edges;
pub(super) mod growth;
pub(super) mod hosts;
pub(super) mod large;
pub(super) mod layout;
pub(super) mod occupants;
pub(super) mod planned;
pub(super) mod program;
pub(super) mod ring;
pub(super) mod rooms;
pub(super) mod vital;
pub(super) mod workers;
