//! Documents of a client on their way into a research job.

use std::io::Write;

use d3dgen_model::knowledge::is_jurisdiction;
use d3dgen_proto::v1::research_document::Source;
use d3dgen_proto::v1::{ResearchDocument, ResearchKnowledgeRequest};
use tonic::Status;

use crate::core::Core;
use crate::grpc::Once;
use crate::grpc::domain::plugin;
use crate::jobs::research::{Research, documents_dir};
use crate::jobs::{Job, Spec};
use crate::names;
use crate::status::{self, invalid};

/// Keeps the documents and starts the job.
pub(super) fn start(core: &Core, who: &str, asked: ResearchKnowledgeRequest, once: &Once) -> Result<Job, Status> {
    plugin(&core.domains.now(), "domain_id", &asked.domain_id)?;
    if asked.documents.is_empty() {
        return Err(invalid("documents", "is empty: give a document"));
    }
    let country = asked.country_code.map(|c| c.to_ascii_uppercase());
    if let Some(code) = country.as_ref().filter(|c| !is_jurisdiction(c)) {
        return Err(invalid("country_code", format!("`{code}` is no ISO 3166 code")));
    }
    let id = core.jobs.reserve();
    let dir = core.job_dir(&id);
    let made = (|| {
        let mut spec = Research {
            domain: asked.domain_id.clone(),
            country,
            places: Vec::new(),
            sources: String::new(),
            import: asked.import_result,
        };
        let mut facts = toml::Table::new();
        for (i, document) in asked.documents.iter().enumerate() {
            let field = format!("documents[{i}]");
            let (name, place) = keep(core, &dir, &field, document)?;
            spec.places.extend(place);
            let known = described(&field, document)?;
            if !known.is_empty() {
                facts.insert(name, toml::Value::Table(known));
            }
        }
        if !facts.is_empty() {
            let whole = toml::Table::from_iter([("documents".to_owned(), toml::Value::Table(facts))]);
            spec.sources = whole.to_string();
        }
        let title = format!("rules for {} out of {} documents", spec.domain, asked.documents.len());
        core.jobs.start(who, title, Spec::Research(spec), Some(id.clone()), |job, batch| {
            let answer = d3dgen_proto::v1::ResearchKnowledgeResponse { job: Some(crate::grpc::job::message(job)) };
            once.also(core, &answer, batch);
        })
    })();
    if made.is_err() {
        core.remove_files_of(&id);
    }
    made
}

/// Keeps one document; returns the name that facts about it go under, and where it is when it is not an upload.
fn keep(
    core: &Core,
    dir: &std::path::Path,
    field: &str,
    document: &ResearchDocument,
) -> Result<(String, Option<String>), Status> {
    match &document.source {
        None => Err(invalid(field, "says neither content nor url nor server_path")),
        Some(Source::Content(bytes)) => {
            let path = names::upload_path(&format!("{field}.name"), &document.name)?;
            let file = documents_dir(dir).join(&path);
            if file.exists() {
                return Err(invalid(&format!("{field}.name"), "is given twice"));
            }
            let folder = file.parent().unwrap_or(dir);
            let written = std::fs::create_dir_all(folder).and_then(|()| {
                let mut out = std::fs::File::create(&file)?;
                out.write_all(bytes)?;
                out.sync_data()
            });
            written.map_err(|e| status::io(&e))?;
            Ok((document.name.clone(), None))
        }
        Some(Source::Url(url)) => {
            if !core.config.fetch_documents {
                return Err(Status::permission_denied(format!(
                    "{field}.url: the configuration does not let the server fetch documents (fetch_documents)"
                )));
            }
            if !url.starts_with("https://") && !url.starts_with("http://") {
                return Err(invalid(&format!("{field}.url"), "is no http or https address"));
            }
            Ok((url.clone(), Some(url.clone())))
        }
        Some(Source::ServerPath(path)) => {
            let real = names::under_roots(&format!("{field}.server_path"), path, &core.config.read_roots)?;
            let name = real.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            Ok((name, Some(real.display().to_string())))
        }
    }
}

fn described(field: &str, document: &ResearchDocument) -> Result<toml::Table, Status> {
    let mut table = toml::Table::new();
    if let Some(code) = &document.jurisdiction {
        let code = code.to_ascii_uppercase();
        if !is_jurisdiction(&code) {
            return Err(invalid(&format!("{field}.jurisdiction"), "is no ISO 3166 code, EU or INT"));
        }
        table.insert("jurisdiction".into(), code.into());
    }
    for (key, value) in [("source_type", &document.source_type), ("publisher", &document.publisher)] {
        if let Some(value) = value {
            table.insert(key.into(), value.clone().into());
        }
    }
    Ok(table)
}
