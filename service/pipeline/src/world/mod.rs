//! Stage `world`: puts the documents of all stages together and judges the result.
//!
//! `rules` lists every hard rule, `check` runs them and adds how the building fares against the knowledge base. Nothing
//! is repaired here: a stage that made something unsound is told so by the report.

mod assemble;
mod check;
mod context;
mod figures;
mod fit;
pub mod rules;

pub use assemble::assemble;
pub use check::check;

#[cfg(test)]
mod tests;
