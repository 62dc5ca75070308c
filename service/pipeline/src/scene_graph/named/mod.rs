//! What the prompt calls by a name: rooms (`mentions` finds them, the others say what a word means where it stands), objects,
//! qualities and styles.

pub(super) mod access;
pub(super) mod aside;
pub(super) mod compounds;
pub(super) mod counts;
pub(super) mod fixtures;
pub(super) mod mention;
pub(super) mod mentions;
pub(super) mod named_for;
pub(super) mod numbered;
pub(super) mod objects;
pub(super) mod qualities;
pub(super) mod rooms_named;
pub(super) mod senses;
pub(super) mod styles;
pub(super) mod taken;
pub(super) mod things;
pub(super) mod unknown;
