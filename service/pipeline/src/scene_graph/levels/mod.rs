//! Buildings with several storeys, and large ones of several units: what the prompt says of storeys, and which room goes
//! where.

pub(super) mod deal;
pub(super) mod spread;
pub(super) mod storey_wishes;
pub(super) mod storeys;
pub(super) mod units;
