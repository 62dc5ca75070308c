//! Between the documents of `model` and the messages of the contract, without a line for each field.
//!
//! A plan is read once from the descriptors: which key of a document is which field. A field has the key of its
//! `json_name` where the proto file gives one, else its own name. Documents become JSON, JSON becomes the wire form of
//! the message by that plan, and the other way round; what a message holds beside the plan, or a document beside the
//! contract, is an error with its place.

mod decode;
mod encode;
mod forms;
mod mask;
mod path;
mod plan;
pub(crate) mod wire;

use d3dgen_model::brief::Brief;
use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_model::placements::Placements;
use d3dgen_model::report::Report;
use d3dgen_model::scenario::Scenario;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::world::World;
use d3dgen_model::{Document, Problem};
use prost::{Message, Name};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::v1;
pub use mask::apply_mask;
pub use path::field_path;
use plan::PLAN;

/// Why a message and a document do not fit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The message breaks the rules of its document. Paths are those of the message: `rooms[3].area_range_m2.min_m2`.
    #[error("{message} has {} problem(s):{}", problems.len(), listed(problems))]
    Invalid {
        /// Name of the message: `SceneGraph`.
        message: String,
        /// Every problem found, in the order of the message.
        problems: Vec<Problem>,
    },
    /// The document holds something the contract does not know: the proto files are stale. Paths are JSON pointers.
    #[error("the contract's {message} cannot hold this document:{}", listed(problems))]
    Contract {
        /// Name of the message: `SceneGraph`.
        message: String,
        /// Every problem found, in the order of the document.
        problems: Vec<Problem>,
    },
}

fn listed(problems: &[Problem]) -> String {
    problems
        .iter()
        .map(|p| format!("\n  {}: {}", if p.path.is_empty() { "message" } else { &p.path }, p.message))
        .collect()
}

/// A document with a message of its own.
pub trait Contract: Document {
    /// The message.
    type Message: Message + Name + Default;
}

macro_rules! contract {
    ($($document:ty => $message:ty),* $(,)?) => {
        $(impl Contract for $document {
            type Message = $message;
        })*
    };
}

contract! {
    Domain => v1::DomainManifest,
    Floorplan => v1::Floorplan,
    KnowledgeBase => v1::KnowledgeBase,
    Placements => v1::Placements,
    Report => v1::Report,
    Scenario => v1::Scenario,
    SceneGraph => v1::SceneGraph,
    World => v1::World,
    Brief => v1::Brief,
}

/// Returns the message of a document.
///
/// # Errors
/// `Contract` when the proto files are older than the document's type.
pub fn to_proto<D: Contract>(document: &D) -> Result<D::Message, Error> {
    to_message(document)
}

/// Returns the document of a message after the check that every document passes.
///
/// # Errors
/// `Invalid` with every problem and its path in the message.
pub fn from_proto<D: Contract>(message: &D::Message) -> Result<D, Error> {
    let value = value(message)?;
    D::from_value(value).map_err(|error| {
        let problems = match error {
            d3dgen_model::Error::Invalid { problems, .. } => problems,
            other => vec![Problem::new("", other.to_string())],
        };
        let named = |p: Problem| Problem::new(field_path::<D::Message>(&p.path), p.message);
        Error::Invalid { message: D::Message::NAME.to_owned(), problems: problems.into_iter().map(named).collect() }
    })
}

/// Returns a message of the same shape as any value of a document's kind: a part of a document, or a type of another
/// crate whose schema the contract holds (`AssetAnnotation`).
///
/// # Errors
/// `Contract` when the message has no field for something in the value.
pub fn to_message<M: Message + Name + Default>(value: &impl Serialize) -> Result<M, Error> {
    let stale = |problems| Error::Contract { message: M::NAME.to_owned(), problems };
    let value = serde_json::to_value(value).map_err(|e| stale(vec![Problem::new("", e.to_string())]))?;
    let mut problems = Vec::new();
    let mut bytes = Vec::new();
    match PLAN.message(&M::full_name()) {
        Some(own) => encode::message(&PLAN, own, &value, &encode::Place::Root, &mut bytes, &mut problems),
        None => problems.push(Problem::new("", "is no message of the contract")),
    }
    if !problems.is_empty() {
        return Err(stale(problems));
    }
    M::decode(bytes.as_slice()).map_err(|e| stale(vec![Problem::new("", e.to_string())]))
}

/// Returns the value of a message, of which only the shape is checked; the opposite of [`to_message`].
///
/// # Errors
/// `Invalid` with every problem and its path in the message.
pub fn from_message<T: DeserializeOwned, M: Message + Name>(message: &M) -> Result<T, Error> {
    serde_json::from_value(value(message)?)
        .map_err(|e| Error::Invalid { message: M::NAME.to_owned(), problems: vec![Problem::new("", e.to_string())] })
}

/// Returns a message in the JSON form of its document.
///
/// # Errors
/// `Invalid` with what is missing, unknown or not finite.
pub fn value<M: Message + Name>(message: &M) -> Result<serde_json::Value, Error> {
    let invalid = |problems| Error::Invalid { message: M::NAME.to_owned(), problems };
    let own = PLAN
        .message(&M::full_name())
        .ok_or_else(|| invalid(vec![Problem::new("", "is no message of the contract")]))?;
    let mut problems = Vec::new();
    let value = decode::message(&PLAN, own, &message.encode_to_vec(), &decode::Place::Root, &mut problems);
    if problems.is_empty() { Ok(value) } else { Err(invalid(problems)) }
}

#[cfg(test)]
mod tests;
