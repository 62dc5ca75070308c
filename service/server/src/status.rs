//! Answers to clients when something goes wrong: canonical codes, with the place in the input where there is one.

use std::time::Duration;

use d3dgen_model::Problem;
use tonic::{Code, Status};
use tonic_types::{ErrorDetails, FieldViolation, StatusExt};

/// Most problems that an answer lists.
const LISTED: usize = 100;

/// Returns the canonical name of a code.
pub fn code_name(code: Code) -> &'static str {
    match code {
        Code::Ok => "OK",
        Code::Cancelled => "CANCELLED",
        Code::Unknown => "UNKNOWN",
        Code::InvalidArgument => "INVALID_ARGUMENT",
        Code::DeadlineExceeded => "DEADLINE_EXCEEDED",
        Code::NotFound => "NOT_FOUND",
        Code::AlreadyExists => "ALREADY_EXISTS",
        Code::PermissionDenied => "PERMISSION_DENIED",
        Code::ResourceExhausted => "RESOURCE_EXHAUSTED",
        Code::FailedPrecondition => "FAILED_PRECONDITION",
        Code::Aborted => "ABORTED",
        Code::OutOfRange => "OUT_OF_RANGE",
        Code::Unimplemented => "UNIMPLEMENTED",
        Code::Internal => "INTERNAL",
        Code::Unavailable => "UNAVAILABLE",
        Code::DataLoss => "DATA_LOSS",
        Code::Unauthenticated => "UNAUTHENTICATED",
    }
}

/// Returns the answer to one field that cannot be used.
pub fn invalid(field: &str, reason: impl Into<String>) -> Status {
    let reason = reason.into();
    let message = format!("{field}: {reason}");
    let details = ErrorDetails::with_bad_request(vec![FieldViolation::new(field, reason)]);
    Status::with_error_details(Code::InvalidArgument, message, details)
}

/// Returns the answer to a document with problems; `field` is where it stands in the request.
pub fn problems(field: &str, problems: &[Problem]) -> Status {
    // JSON pointers of documents, and paths of messages
    let at = |p: &Problem| match p.path.strip_prefix('/') {
        Some(path) => format!("{field}.{}", path.replace('/', ".")),
        None if p.path.is_empty() => field.to_owned(),
        None if field.is_empty() => p.path.clone(),
        None => format!("{field}.{}", p.path),
    };
    let listed: Vec<FieldViolation> =
        problems.iter().take(LISTED).map(|p| FieldViolation::new(at(p), p.message.clone())).collect();
    let message = match problems {
        [] => format!("{field} cannot be used"),
        [one] => format!("{}: {}", at(one), one.message),
        [first, ..] => format!("{} problems, first {}: {}", problems.len(), at(first), first.message),
    };
    Status::with_error_details(Code::InvalidArgument, message, ErrorDetails::with_bad_request(listed))
}

/// Returns the answer to too much, with the time after which to try again.
pub fn exhausted(message: &str, retry: Duration) -> Status {
    let mut status = Status::with_error_details(
        Code::ResourceExhausted,
        format!("{message}; try again in {:.2} s", retry.as_secs_f64()),
        ErrorDetails::with_retry_info(Some(retry)),
    );
    let seconds = retry.as_secs_f64().ceil().max(1.0) as u64;
    status.metadata_mut().insert("retry-after", seconds.into());
    status
}

/// Returns the answer to a document that cannot be read.
pub fn document(field: &str, error: d3dgen_model::Error) -> Status {
    match error {
        d3dgen_model::Error::Invalid { problems: found, .. } => problems(field, &found),
        other => invalid(field, other.to_string()),
    }
}

/// Returns the answer to what a stage refuses; `field` is what it was asked with.
pub fn stage(field: &str, error: d3dgen_pipeline::Error) -> Status {
    use d3dgen_pipeline::Error;
    match error {
        Error::Refused { .. } | Error::Mismatch { .. } => invalid(field, error.to_string()),
        Error::Infeasible { .. } => Status::failed_precondition(error.to_string()),
        Error::Cancelled => Status::cancelled("the call was given up"),
    }
}

/// Returns the answer to a plan that cannot be brought; `field` is what it was sent in.
pub fn plan(field: &str, error: d3dgen_pipeline::bring::Error) -> Status {
    use d3dgen_pipeline::bring::Error;
    match error {
        Error::Plan(unreadable) => invalid(field, unreadable.to_string()),
        Error::Stage(refused) => stage(field, refused),
    }
}

/// Returns the answer to what the storage refuses.
pub fn store(error: d3dgen_store::Error) -> Status {
    use d3dgen_store::Error;
    match error {
        Error::Cancelled => Status::cancelled("the call was given up"),
        Error::Limit { .. } | Error::UnknownField { .. } => Status::invalid_argument(error.to_string()),
        Error::Damaged { .. } | Error::Corrupt { .. } | Error::Snapshot { .. } => {
            tracing::error!(reason = %error, "damage");
            Status::data_loss("a record is damaged: the server's log tells which; restore a backup")
        }
        other => internal(&other),
    }
}

/// Returns the answer to what the database of rules refuses.
pub fn knowledge(error: d3dgen_knowledge::Error) -> Status {
    use d3dgen_knowledge::Error;
    match error {
        Error::Store(inner) => store(inner),
        Error::Document(inner) => document("knowledge_base", inner),
        Error::NoDomain { .. } | Error::NoChange { .. } => Status::not_found(error.to_string()),
        Error::NotUndoable { .. } => Status::failed_precondition(error.to_string()),
        Error::Breaks { ref problems, .. } => self::problems("knowledge_base", problems),
        Error::Outdated { .. } => Status::aborted(error.to_string()),
        Error::Input(message) => Status::invalid_argument(message),
    }
}

/// Returns the answer to what the database of assets refuses.
pub fn assets(error: d3dgen_assets::Error) -> Status {
    use d3dgen_assets::Error;
    match error {
        Error::Store(inner) => store(inner),
        Error::Document(inner) => document("asset", inner),
        Error::NoAsset { .. } => Status::not_found(error.to_string()),
        Error::File { .. } | Error::Start { .. } => internal(&error),
        Error::Input(message) => Status::invalid_argument(message),
    }
}

/// Returns the answer to what an exporter refuses.
pub fn export(error: d3dgen_export::Error) -> Status {
    Status::failed_precondition(error.to_string())
}

/// How the transport begins to say that a message is no message: not Protobuf, cut off, packed in an unknown way.
const UNREADABLE: [&str; 5] = [
    "failed to decode Protobuf message",
    "protocol error: received message",
    "Unexpected EOF decoding stream",
    "Error decompressing",
    "Missing request message",
];
/// How it begins to say that a message is above the limit.
const TOO_LARGE: &str = "Error, decoded message length too large";

/// Returns what an answer of the transport means where its code blames the server for what a client sent: it has INTERNAL
/// for a message that cannot be read, and OUT_OF_RANGE for one above the limit.
pub fn of_transport(said: &Status) -> Option<Status> {
    let text = said.message();
    match said.code() {
        Code::Internal if UNREADABLE.iter().any(|begin| text.starts_with(begin)) => {
            Some(Status::invalid_argument(format!("the message cannot be read: {text}")))
        }
        Code::OutOfRange if text.starts_with(TOO_LARGE) => {
            Some(Status::resource_exhausted(format!("the message is too large: {text}")))
        }
        _ => None,
    }
}

/// Returns the answer to what is nobody's fault but the server's: the log has the reason, the client none of it.
pub fn internal(error: &dyn std::fmt::Display) -> Status {
    tracing::error!(reason = %error, "internal");
    Status::internal("the server failed; its log tells why")
}
