//! What the knowledge base of a domain says about a building: the constraints that apply, the figures a plan must keep,
//! and how a finished world fares against each of them.
//!
//! What it is not for: deciding whether a world is sound (hard rules live in the pipeline's `world` stage) and reading
//! files. Which measurable quantity a constraint speaks of is data: `data/quantities.toml`.

mod limits;
mod query;

pub use limits::{Limit, Limits, RoomLimits};
pub use query::{Query, QueryRoom};
