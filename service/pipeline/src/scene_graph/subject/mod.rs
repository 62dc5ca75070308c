//! What the prompt is about: the building with its parts, the place and so the country it stands in, and whether a single
//! room is asked for.

pub(super) mod addresses;
pub(super) mod building;
pub(super) mod parts;
pub(super) mod places;
pub(super) mod practitioners;
pub(super) mod programs;
pub(super) mod single;
pub(super) mod site;
