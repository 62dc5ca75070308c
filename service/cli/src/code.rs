//! Codes of errors: a short stable name for each thing that can go wrong, for programs and for `d3dgen explain`.
//!
//! `docs/errors.md` explains each under its name; a test compares the two.

use d3dgen_assets::Error as AssetsError;
use d3dgen_dataset::Error as DatasetError;
use d3dgen_export::Error as ExportError;
use d3dgen_knowledge::Error as KnowledgeError;
use d3dgen_model::Error as DocumentError;
use d3dgen_pipeline::Error as StageError;
use d3dgen_plans::Error as PlanError;
use d3dgen_plugins::Error as DomainError;
use d3dgen_server::Error as ServerError;
use d3dgen_store::Error as StoreError;

use crate::error::Error;

impl Error {
    /// Returns the code of the error; it stays the same over releases.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Input(_) => "input",
            Self::Read { .. } => "file.read",
            Self::Write { .. } => "file.write",
            Self::Document { source, .. } => document(source),
            Self::Plan { source, .. } => plan(source),
            Self::Domain(source) => domain(source),
            Self::Knowledge(source) => knowledge(source),
            Self::Assets(source) => assets(source),
            Self::Stage(source) => stage(source),
            Self::Export(source) => export(source),
            Self::Dataset(source) => dataset(source),
            Self::Eval(_) => "program.data",
            Self::Server(source) => server(source),
            Self::Remote(_) => "server.remote",
            Self::Unsound(_) => "world.unsound",
            Self::Interrupted => "interrupted",
        }
    }
}

fn document(error: &DocumentError) -> &'static str {
    match error {
        DocumentError::NotJson { .. } => "document.not_json",
        DocumentError::Invalid { .. } => "document.invalid",
    }
}

fn plan(error: &PlanError) -> &'static str {
    match error {
        PlanError::UnknownFormat(_) => "plan.format",
        PlanError::Broken { .. } => "plan.broken",
        PlanError::Refused { .. } => "plan.refused",
    }
}

fn domain(error: &DomainError) -> &'static str {
    match error {
        DomainError::Unreadable { .. } => "domain.unreadable",
        DomainError::Invalid { .. } => "domain.invalid",
        DomainError::Taken { .. } => "domain.taken",
    }
}

fn stage(error: &StageError) -> &'static str {
    match error {
        StageError::Refused { .. } | StageError::UnknownBuilding { .. } => "request.refused",
        StageError::Mismatch { .. } => "documents.mismatch",
        StageError::Infeasible { .. } | StageError::Breaks { .. } => "request.infeasible",
        StageError::Cancelled => "interrupted",
    }
}

fn knowledge(error: &KnowledgeError) -> &'static str {
    match error {
        KnowledgeError::Store(source) => store(source),
        KnowledgeError::Document(source) => document(source),
        KnowledgeError::NoDomain { .. } => "knowledge.no_domain",
        KnowledgeError::NoChange { .. } | KnowledgeError::NotUndoable { .. } => "knowledge.undo",
        KnowledgeError::Breaks { .. } => "knowledge.breaks",
        KnowledgeError::Outdated { .. } => "knowledge.outdated",
        KnowledgeError::Input(_) => "input",
    }
}

fn assets(error: &AssetsError) -> &'static str {
    match error {
        AssetsError::Store(source) => store(source),
        AssetsError::Document(source) => document(source),
        AssetsError::NoAsset { .. } => "assets.no_asset",
        AssetsError::File { .. } => "file.read",
        AssetsError::Start { .. } => "assets.reader",
        AssetsError::Input(_) => "input",
    }
}

fn export(error: &ExportError) -> &'static str {
    match error {
        ExportError::NoFormat { .. } => "export.format",
        ExportError::Unsupported { .. } => "export.unsupported",
        ExportError::Model(_) | ExportError::Asset { .. } | ExportError::Kept { .. } => "export.model",
        ExportError::TooLarge { .. } | ExportError::Picture { .. } => "export.picture",
    }
}

fn dataset(error: &DatasetError) -> &'static str {
    match error {
        DatasetError::Input(_) => "input",
        DatasetError::Spec { .. } => "dataset.spec",
        DatasetError::Read { .. } => "file.read",
        DatasetError::Write { .. } => "file.write",
        DatasetError::Damaged { .. } => "dataset.damaged",
        DatasetError::Export(source) => export(source),
        DatasetError::Cluster(_) => "dataset.cluster",
        DatasetError::Full(_) => "disk.full",
        DatasetError::Interrupted => "interrupted",
    }
}

fn server(error: &ServerError) -> &'static str {
    match error {
        ServerError::Config { .. } => "server.config",
        ServerError::File { .. } => "file.read",
        ServerError::Listen { .. } => "server.listen",
        ServerError::Tls(_) => "server.tls",
        ServerError::Transport(_) => "server.stopped",
        ServerError::Store(source) => store(source),
        ServerError::Knowledge(source) => knowledge(source),
        ServerError::Assets(source) => assets(source),
        ServerError::Domain { .. } => "domain.invalid",
        ServerError::Record { .. } => "store.damaged",
    }
}

fn store(error: &StoreError) -> &'static str {
    match error {
        StoreError::Full { .. } => "disk.full",
        StoreError::NotFound { .. } | StoreError::Exists { .. } | StoreError::NotAStore { .. } => "store.place",
        StoreError::InUse { .. } | StoreError::StillReading { .. } => "store.in_use",
        StoreError::ReadOnly { .. } | StoreError::NeedsWriter { .. } => "store.read_only",
        StoreError::Damaged { .. } | StoreError::Corrupt { .. } | StoreError::Snapshot { .. } => "store.damaged",
        StoreError::Newer { .. } => "store.newer",
        StoreError::NoBackend { .. } => "store.backend",
        StoreError::Embedder { .. } => "store.embedder",
        StoreError::Limit { .. } | StoreError::UnknownField { .. } => "input",
        StoreError::Cancelled => "interrupted",
        StoreError::Io { .. } | StoreError::Index { .. } => "store.failed",
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use crate::commands::explanations;

    #[test]
    fn every_code_is_explained_and_nothing_else() {
        let (source, _) = include_str!("code.rs").split_once("#[cfg(test)]").unwrap();
        let given: BTreeSet<&str> =
            source.split("=> \"").skip(1).filter_map(|rest| rest.split_once('"')).map(|(code, _)| code).collect();
        let explained: Vec<&str> = explanations().into_iter().map(|(code, _)| code).collect();
        assert!(given.len() > 30, "{given:?}");
        assert_eq!(explained.iter().copied().collect::<BTreeSet<_>>(), given);
        assert_eq!(explained.len(), given.len(), "a code is explained twice");
    }
}
