//! From the reading to the graph: the rooms there are (`program`, `vital`, `large`, `workers`, `layout`, `toilets`), who is in them and what they are
//! entered from (`occupants`, `hosts`), what they are like
//! (`rooms`), and how they connect (`edges`, `ring`, `locks`).

pub(crate) mod edges;
pub(crate) mod growth;
pub(crate) mod hosts;
pub(crate) mod large;
pub(crate) mod layout;
pub(crate) mod locks;
pub(crate) mod occupants;
pub(crate) mod planned;
pub(crate) mod program;
pub(crate) mod ring;
pub(crate) mod rooms;
pub(crate) mod toilets;
pub(crate) mod vital;
pub(crate) mod workers;
