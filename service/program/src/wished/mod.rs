//! From what is named to what is wished for: how many rooms of which type (`wishes`), how they lie to each other
//! (`relations`, `listed`), which are part of others (`subsets`) or only compared, and what nobody can plan (`unread`).

pub(crate) mod closed;
pub(crate) mod comparisons;
pub(crate) mod listed;
pub(crate) mod relations;
pub(crate) mod subsets;
pub(crate) mod totals;
pub(crate) mod unread;
pub(crate) mod wishes;
