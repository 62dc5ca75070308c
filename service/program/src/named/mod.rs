//! What the prompt calls by a name: rooms (`mentions` finds them, the others say what a word means where it stands), objects,
//! qualities and styles.

pub(crate) mod access;
pub(crate) mod aside;
pub(crate) mod compounds;
pub(crate) mod counts;
pub(crate) mod fixtures;
pub(crate) mod mention;
pub(crate) mod mentions;
pub(crate) mod named_for;
pub(crate) mod numbered;
pub(crate) mod objects;
pub(crate) mod qualities;
pub(crate) mod rooms_named;
pub(crate) mod senses;
pub(crate) mod styles;
pub(crate) mod taken;
pub(crate) mod things;
pub(crate) mod unknown;
