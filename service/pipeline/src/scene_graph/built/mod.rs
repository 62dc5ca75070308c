//! From the reading to the graph: the rooms there are (`program`, `vital`, `workers`, `layout`), what they are like
//! (`rooms`), and how they connect (`edges`, `ring`).

pub(super) mod edges;
pub(super) mod layout;
pub(super) mod program;
pub(super) mod ring;
pub(super) mod rooms;
pub(super) mod vital;
pub(super) mod workers;
