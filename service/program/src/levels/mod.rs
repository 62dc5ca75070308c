//! Buildings with several storeys, and large ones of several units: what the prompt says of storeys, and which room goes
//! where.

pub(crate) mod carry;
pub(crate) mod deal;
pub(crate) mod spread;
pub(crate) mod storey_wishes;
pub(crate) mod storeys;
pub(crate) mod units;
