//! Between messages and documents: what comes in is checked as a file would be, and said with its field.

use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_proto::convert::{self, Contract, Error};
use prost::{Message, Name};
use prost_types::FieldMask;
use serde::Serialize;
use serde::de::DeserializeOwned;
use tonic::Status;

use crate::status::{self, invalid};

/// Returns the message of a document, or of a part of one.
pub fn message<M: Message + Name + Default>(document: &impl Serialize) -> M {
    convert::to_message(document).expect("the contract is made of the schemas of documents: its tests compare them")
}

/// Returns the document of a message.
///
/// # Errors
/// `INVALID_ARGUMENT` with every problem and its field; also when the message is missing.
pub fn document<D: Contract>(field: &str, message: Option<D::Message>) -> Result<D, Status> {
    let message = message.ok_or_else(|| invalid(field, "is missing"))?;
    convert::from_proto(&message).map_err(|e| refused(field, e))
}

/// Returns a knowledge base with the shared rules that it uses.
///
/// # Errors
/// `INVALID_ARGUMENT` for a name that is of none.
pub fn with_shared(mut knowledge: KnowledgeBase) -> Result<KnowledgeBase, Status> {
    let complete = d3dgen_plugins::complete(&mut knowledge);
    complete.map_err(|e| invalid("knowledge_base.metadata.uses", e.to_string()))?;
    Ok(knowledge)
}

/// Returns the part of a document that a message is; only its shape is checked.
///
/// # Errors
/// As [`document`].
pub fn part<T: DeserializeOwned, M: Message + Name>(field: &str, message: &M) -> Result<T, Status> {
    convert::from_message(message).map_err(|e| refused(field, e))
}

/// Returns a message with the fields of another that the mask names. Fields that the other lacks are cleared.
///
/// # Errors
/// `INVALID_ARGUMENT` for an empty mask, a path that is no field, or one of `fixed`.
pub fn masked<M: Message + Name + Default>(
    field: &str,
    mut base: M,
    update: &M,
    mask: Option<FieldMask>,
    fixed: &[&str],
) -> Result<M, Status> {
    let paths = mask.unwrap_or_default().paths;
    convert::apply_mask(&mut base, update, &paths, fixed).map_err(|e| refused(field, e))?;
    Ok(base)
}

fn refused(field: &str, error: Error) -> Status {
    match error {
        Error::Invalid { problems, .. } => status::problems(field, &problems),
        stale => status::internal(&stale),
    }
}
