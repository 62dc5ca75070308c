//! What the knowledge base of a domain says about a building: the constraints that apply, the figures a plan must keep,
//! and how a finished world fares against each of them.
//!
//! What it is not for: deciding whether a world is sound (hard rules live in the pipeline's `world` stage) and reading
//! files. Which measurable quantity a constraint speaks of, and what its conditions mean, is data: `data/*.toml`.

mod aims;
pub mod amend;
pub mod classify;
pub mod clearance;
pub mod compliance;
mod conditions;
pub mod database;
mod draw_limits;
pub mod error;
mod figure;
pub mod freespace;
pub mod glossary;
pub mod import;
pub mod jurisdiction;
mod limits;
mod measure;
pub mod phrase;
mod query;
pub mod resolve;
mod retrieve;
mod stats;
mod tables;
pub mod travel;

pub use aims::{Aim, Clear, ObjectAims};
pub use conditions::Guard;
pub use error::Error;
pub use figure::Bounds;
pub use limits::{AreaLimit, Limit, Limits, RoomLimits};
pub use measure::Measure;
pub use query::{Query, QueryRoom};
pub use resolve::{Conflict, Policy};
pub use retrieve::{Applicable, Retrieval, Rule, Scope, missing_rooms, retrieve, retrieve_with};
pub use stats::{Stats, decidable};
pub use tables::{ConditionRow, QuantityRow, Sure};

#[cfg(test)]
mod tests;
