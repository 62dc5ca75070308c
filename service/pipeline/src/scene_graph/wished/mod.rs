//! From what is named to what is wished for: how many rooms of which type (`wishes`), how they lie to each other
//! (`relations`, `listed`), which are part of others (`subsets`) or only compared, and what nobody can plan (`unread`).

pub(super) mod closed;
pub(super) mod comparisons;
pub(super) mod listed;
pub(super) mod relations;
pub(super) mod subsets;
pub(super) mod totals;
pub(super) mod unread;
pub(super) mod wishes;
