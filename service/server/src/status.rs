//! Answers to clients when something goes wrong: canonical codes, with the place in the input where there is one.

use std::time::Duration;

use d3dgen_model::Problem;
use http::StatusCode;
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

/// Returns the status of plain HTTP for a code.
pub fn http(code: Code) -> StatusCode {
    match code {
        Code::Unauthenticated => StatusCode::UNAUTHORIZED,
        Code::PermissionDenied => StatusCode::FORBIDDEN,
        Code::NotFound => StatusCode::NOT_FOUND,
        Code::ResourceExhausted => StatusCode::TOO_MANY_REQUESTS,
        Code::DeadlineExceeded => StatusCode::GATEWAY_TIMEOUT,
        _ => StatusCode::INTERNAL_SERVER_ERROR,
    }
}

/// Domain of the reasons that answers give (`google.rpc.ErrorInfo`).
const DOMAIN: &str = "d3dgen";
/// Reasons that say more than the code does; docs/api.md lists them, and they stay.
pub mod reason {
    /// A change would leave a hard rule broken: `rule` and `subject` say which.
    pub const BREAKS: &str = "BREAKS_RULE";
    /// The prompt contradicts itself; `allow_conflicts` has it built all the same.
    pub const CONTRADICTS: &str = "CONTRADICTS_ITSELF";
    /// What is to be changed is no more as the client saw it last.
    pub const CHANGED: &str = "CHANGED_SINCE";
    /// A field of the request cannot be used.
    pub const FIELD: &str = "INVALID_FIELD";
    /// Too much at once; the answer says when to come again.
    pub const BUSY: &str = "TOO_MUCH_AT_ONCE";
    /// What was handed in does not fit the rest: `stage` says where that was found.
    pub const MISFIT: &str = "PARTS_DO_NOT_FIT";
    /// No result keeps all hard rules: `stage` says where it was looked for.
    pub const NO_SOLUTION: &str = "NO_SOLUTION";
    /// What is asked for cannot be made in any form: `stage` says who refuses.
    pub const REFUSED: &str = "REQUEST_REFUSED";
    /// No domain knows such a kind of building: `name`, and the `nearest` ones.
    pub const UNKNOWN_BUILDING: &str = "UNKNOWN_BUILDING";
    /// A world that breaks a hard rule goes into no file: `rule` says which.
    pub const UNSOUND: &str = "NOT_SOUND";
    /// The server has no room to keep anything.
    pub const FULL: &str = "DISK_FULL";
    /// The server was asked by a name that is not its own.
    pub const HOST: &str = "UNKNOWN_HOST";
    /// A web page called from an origin that may not.
    pub const ORIGIN: &str = "FOREIGN_ORIGIN";
    /// The scope of the token is too small.
    pub const SCOPE: &str = "SCOPE_TOO_SMALL";
    /// The token is missing or wrong.
    pub const TOKEN: &str = "TOKEN_MISSING_OR_WRONG";
}

/// Returns an answer with a stable reason for programs, in place of one it may have.
pub fn because(reason: &str, status: &Status) -> Status {
    because_of(reason, &[], status)
}

/// Returns an answer with a stable reason and what is to be known of it, by names that stay too.
pub fn because_of(reason: &str, facts: &[(&str, &str)], status: &Status) -> Status {
    let mut details = status.get_error_details();
    details.set_error_info(
        reason,
        DOMAIN,
        facts.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect::<std::collections::HashMap<_, _>>(),
    );
    let mut with = Status::with_error_details(status.code(), status.message(), details);
    for pair in status.metadata().iter() {
        if let tonic::metadata::KeyAndValueRef::Ascii(key, value) = pair {
            with.metadata_mut().insert(key, value.clone());
        }
    }
    with
}

/// Returns an answer with a stable reason for programs: its own, or what its details and its code tell.
pub fn explained(status: Status) -> Status {
    let details = status.get_error_details();
    match (status.code(), details.error_info(), details.bad_request(), details.retry_info()) {
        (Code::Ok, ..) | (_, Some(_), ..) => status,
        (_, None, Some(_), _) => because(reason::FIELD, &status),
        (_, None, None, Some(_)) => because(reason::BUSY, &status),
        (code, ..) => because(code_name(code), &status),
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
    let said = error.to_string();
    match error {
        Error::Refused { stage, .. } => because_of(reason::REFUSED, &[("stage", stage)], &invalid(field, said)),
        Error::Mismatch { stage, .. } => because_of(reason::MISFIT, &[("stage", stage)], &invalid(field, said)),
        Error::UnknownBuilding { name, nearest, .. } => {
            let facts = [("name", name.as_str()), ("nearest", &nearest.join(", "))];
            because_of(reason::UNKNOWN_BUILDING, &facts, &invalid(field, said))
        }
        Error::Infeasible { stage, .. } => {
            because_of(reason::NO_SOLUTION, &[("stage", stage)], &Status::failed_precondition(said))
        }
        Error::Breaks { stage, rule, subject, .. } => {
            let facts = [("stage", stage), ("rule", rule.as_str()), ("subject", subject.as_str())];
            because_of(reason::BREAKS, &facts, &Status::failed_precondition(said))
        }
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
        Error::Full { .. } => full(&error),
        other => internal(&other),
    }
}

/// When to come back after the disk was full.
const ROOM: Duration = Duration::from_secs(30);

fn full(error: &dyn std::fmt::Display) -> Status {
    tracing::error!(reason = %error, "no room");
    because(reason::FULL, &exhausted("the disk of the server is full; nothing was changed", ROOM))
}

/// Returns the answer to what the server's own records, or anything else of it, refuse.
pub fn own(error: crate::Error) -> Status {
    use crate::Error;
    match error {
        Error::Store(inner) => store(inner),
        Error::Knowledge(inner) => knowledge(inner),
        Error::Assets(inner) => assets(inner),
        Error::File { source, .. } => io(&source),
        other => internal(&other),
    }
}

/// Returns the answer to what the system refuses of a file of the server.
pub fn io(error: &std::io::Error) -> Status {
    if d3dgen_store::is_full(error) { full(error) } else { internal(error) }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_answer_has_a_reason_that_stays() {
        let reason_of = |status: &Status| status.get_error_details().error_info().map(|i| i.reason.clone());
        let told = |status: Status| reason_of(&explained(status)).unwrap_or_default();
        assert_eq!(told(invalid("edits[0].lock", "is empty")), "INVALID_FIELD");
        assert_eq!(told(exhausted("too many calls wait", RETRY)), "TOO_MUCH_AT_ONCE");
        assert_eq!(told(Status::not_found("there is no job")), "NOT_FOUND");
        let full = explained(store(d3dgen_store::Error::Full { path: "x".into() }));
        assert_eq!((full.code(), reason_of(&full).as_deref()), (Code::ResourceExhausted, Some("DISK_FULL")));
        assert!(full.metadata().contains_key("retry-after") && full.get_details_retry_info().is_some());
        assert_eq!(reason_of(&explained(Status::new(Code::Ok, ""))), None);
    }

    #[test]
    fn what_a_stage_refuses_is_told_in_words_that_stay() {
        use d3dgen_pipeline::Error;
        let told = |error: Error| {
            let status = explained(stage("edits[0]", error));
            let info = status.get_error_details().error_info().cloned().expect("a reason");
            (status.code(), info.reason, std::collections::BTreeMap::from_iter(info.metadata))
        };
        let (rule, subject, message) = ("door_narrow".to_owned(), "door_3".to_owned(), "edit 1: it would".to_owned());
        let (code, reason, facts) = told(Error::Breaks { stage: "edit", rule, subject, message });
        assert_eq!((code, reason.as_str()), (Code::FailedPrecondition, "BREAKS_RULE"));
        assert_eq!((facts["rule"].as_str(), facts["subject"].as_str()), ("door_narrow", "door_3"));
        let unknown = Error::UnknownBuilding {
            name: "zorblatt".into(),
            nearest: vec!["boathouse".into(), "sports hall".into()],
            domains: vec!["general".into()],
            fallback: "general".into(),
        };
        let (code, reason, facts) = told(unknown);
        assert_eq!((code, reason.as_str()), (Code::InvalidArgument, "UNKNOWN_BUILDING"));
        assert_eq!((facts["name"].as_str(), facts["nearest"].as_str()), ("zorblatt", "boathouse, sports hall"));
        let (_, reason, facts) = told(Error::Infeasible { stage: "floorplan", message: "it is too dense".into() });
        assert_eq!((reason.as_str(), facts["stage"].as_str()), ("NO_SOLUTION", "floorplan"));
    }

    const RETRY: Duration = Duration::from_secs(1);
}
