//! What the prompt is about: the building with its parts, the place and so the country it stands in, and whether a single
//! room is asked for.

pub(crate) mod addresses;
pub(crate) mod building;
pub(crate) mod parts;
pub(crate) mod places;
pub(crate) mod practitioners;
pub(crate) mod programs;
pub(crate) mod single;
pub(crate) mod site;
