//! The judge of finished worlds, from their documents alone: every hard rule, and how the building fares against the knowledge
//! base, and what became of everything that was asked for.
//!
//! `rules` lists every hard rule, `check` runs them. Nothing is repaired here: a stage that made something unsound is told so
//! by the report. No code of the stages is used, so that no fault of theirs hides itself.

mod answers;
mod check;
mod context;
mod figures;
mod fit;
mod outline;
pub mod rules;

pub use answers::answers;
pub use check::check;
