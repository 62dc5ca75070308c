//! `d3dgen assets annotate`: what a person knows better.

use std::path::PathBuf;

use d3dgen_assets::annotation::{Annotation, Basis, FrontAxis, asa};
use d3dgen_model::Document;

use super::common::{by, open};
use crate::error::Error;
use crate::input::write_text;
use crate::registry::RegistryArgs;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Asset that is kept in the database
    #[arg(value_name = "ASSET_ID")]
    asset_id: String,
    /// Field and value: name, description, kind, mount, front, object, or a list: rooms, domains, tags, affordances,
    /// materials (by commas); may be given more than once
    #[arg(long, value_name = "FIELD=VALUE")]
    set: Vec<String>,
    /// An annotation.yaml whose statements are taken over
    #[arg(long, value_name = "FILE")]
    file: Option<PathBuf>,
    /// Who does it; otherwise the user's name
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
    /// Why, for the history
    #[arg(long, default_value = "annotated by hand", value_name = "SENTENCE")]
    why: String,
    /// Print the new annotation as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        if self.set.is_empty() && self.file.is_none() {
            return Err(Error::Input("there is nothing to change: give --set FIELD=VALUE or --file FILE".into()));
        }
        let database = open(&self.registry.store)?;
        let Some(mut annotation) = database.get(&self.asset_id)? else {
            return Err(Error::Input(format!(
                "{} is not kept in the database; only ingested and generated assets are annotated",
                self.asset_id
            )));
        };
        if let Some(path) = &self.file {
            let text = std::fs::read_to_string(path).map_err(|source| Error::Read { path: path.clone(), source })?;
            let asa = asa::read(&text).map_err(|reason| Error::Input(format!("{} {reason}", path.display())))?;
            let sets = [
                ("name", asa.name.clone()),
                ("description", asa.description.clone()),
                ("front", asa.face.map(|f| f.name().to_owned())),
                ("kind", asa.values("kind").next().map(str::to_owned)),
                ("mount", asa.values("mount").next().map(str::to_owned)),
            ];
            let lists = [("rooms", "room"), ("domains", "domain"), ("affordances", "hoi"), ("materials", "material")];
            for (field, value) in sets {
                value.map(|v| set(&mut annotation, field, &v)).transpose()?;
            }
            for (field, key) in lists {
                let values: Vec<&str> = asa.values(key).collect();
                if !values.is_empty() {
                    set(&mut annotation, field, &values.join(","))?;
                }
            }
        }
        for text in &self.set {
            let (field, value) = text
                .split_once('=')
                .ok_or_else(|| Error::Input(format!("--set {text}: write FIELD=VALUE, such as kind=chair")))?;
            set(&mut annotation, field.trim(), value.trim())?;
        }
        database.annotate(annotation.clone(), &by(self.by.as_deref(), &self.why))?;
        let text = if self.json { annotation.to_json() } else { format!("{} is changed\n", self.asset_id) };
        write_text(None, &text)
    }
}

fn set(a: &mut Annotation, field: &str, value: &str) -> Result<(), Error> {
    let list = || value.split(',').map(|v| v.trim().to_owned()).filter(|v| !v.is_empty()).collect::<Vec<String>>();
    let wrong = |known: &str| Error::Input(format!("--set {field}={value}: there are {known}"));
    match field {
        "name" => a.name = value.to_owned(),
        "description" => a.description = value.to_owned(),
        "kind" => a.kind = value.to_owned(),
        "object" => a.object = Some(value.to_owned()).filter(|v| !v.is_empty()),
        "mount" => a.mount = asa::mount_from_name(value).ok_or_else(|| wrong("floor, wall, ceiling, surface"))?,
        "front" => {
            a.front.axis = FrontAxis::from_name(value).ok_or_else(|| wrong("-y, +y, -x, +x, xy"))?;
            a.front.found_by = "a person".into();
        }
        "rooms" | "room_types" => a.room_types = list(),
        "domains" => a.domains = list(),
        "tags" => a.tags = list(),
        "affordances" => a.affordances = list(),
        "materials" => a.materials = list(),
        _ => {
            return Err(Error::Input(format!(
                "--set {field}: no such field; there are name, description, kind, object, mount, front, rooms, domains, \
                 tags, affordances, materials"
            )));
        }
    }
    let field = if field == "rooms" { "room_types" } else { field };
    a.basis.insert(field.to_owned(), Basis::Given);
    Ok(())
}
