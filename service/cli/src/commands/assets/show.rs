//! `d3dgen assets show`: all that is known of an asset.

use std::path::PathBuf;

use d3dgen_assets::annotation::{Annotation, Basis, asa};
use d3dgen_mesh::picture;
use d3dgen_model::Document;

use super::common::{World, size_text, write_picture};
use crate::error::Error;
use crate::input::write_text;
use crate::registry::RegistryArgs;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Asset, as worlds name it: Hospital/HospitalBed
    #[arg(value_name = "ASSET_ID")]
    asset_id: String,
    /// Print the whole annotation as JSON
    #[arg(long, conflicts_with = "asa")]
    json: bool,
    /// Print the annotation as Arena reads it (annotation.yaml)
    #[arg(long)]
    asa: bool,
    /// Also write a picture of it: the thumbnail that is kept with it, or one drawn now
    #[arg(long, value_name = "FILE.png")]
    thumbnail: Option<PathBuf>,
    /// Draw the picture anew with this side, px; 512 where none is kept
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u32).range(16..=2048))]
    px: Option<u32>,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let world = World::load(&self.registry)?;
        let shelf = world.shelf(&self.registry.store)?;
        let annotation = shelf.get(&self.asset_id)?;
        if let Some(path) = &self.thumbnail {
            let kept = if self.px.is_none() { shelf.thumbnail(&self.asset_id)? } else { None };
            match kept {
                Some(png) => std::fs::write(path, png).map_err(|source| Error::Write { path: path.clone(), source })?,
                None => {
                    let model = world.model(&shelf, &self.asset_id)?;
                    write_picture(path, &picture::thumbnail(&model, self.px.unwrap_or(512) as usize))?;
                }
            }
        }
        let text = match (self.json, self.asa) {
            (true, _) => annotation.to_json(),
            (_, true) => asa::write(&annotation),
            _ => shown(&annotation),
        };
        write_text(None, &text)
    }
}

fn shown(a: &Annotation) -> String {
    let list = |values: &[String]| if values.is_empty() { "-".to_owned() } else { values.join(", ") };
    let basis = |field: &str| match a.basis.get(field) {
        Some(Basis::Guessed) => " (guessed)",
        Some(Basis::Measured) => " (measured)",
        Some(Basis::Given) | None => "",
    };
    let colors: Vec<String> =
        a.palette.iter().map(|s| format!("{} {} {:.0} %", s.name, s.hex, s.share * 100.0)).collect();
    let mass = a.mass.as_ref().map_or("-".to_owned(), |m| format!("{} kg", m.mass_kg));
    let joints: Vec<String> = a.joints.iter().map(|j| format!("{} ({})", j.name, j.kind)).collect();
    let mut rows = vec![
        ("asset", a.asset_id.clone()),
        ("name", a.name.clone()),
        ("description", a.description.clone()),
        ("object", format!("{}{}", a.object.clone().unwrap_or_else(|| "unknown".into()), basis("object"))),
        ("kind", format!("{}{}", a.kind, basis("kind"))),
        ("size", format!("{} m{}", size_text(a.size_m), basis("size_m"))),
        ("front", format!("{}: {}", a.front.axis.name(), a.front.found_by)),
        ("mount", format!("{}{}", asa::mount_name(a.mount), basis("mount"))),
        ("use", format!("{}{}", list(&a.affordances), basis("affordances"))),
        ("materials", format!("{}{}", list(&a.materials), basis("materials"))),
        ("colors", list(&colors)),
        ("mass", format!("{mass}{}", basis("mass"))),
        ("triangles", a.triangle_count.to_string()),
        (
            "thumbnail",
            a.thumbnail.as_ref().map_or("drawn when asked for".into(), |t| format!("{0} x {0} px", t.size_px)),
        ),
        ("moving parts", list(&joints)),
        ("domains", list(&a.domains)),
        ("rooms", list(&a.room_types)),
        ("tags", list(&a.tags)),
        ("origin", serde_json::to_value(&a.origin).map(|v| v.to_string()).unwrap_or_default()),
    ];
    rows.extend(a.changes.iter().map(|c| ("changed", format!("{} from {} to {}: {}", c.what, c.from, c.to, c.why))));
    rows.iter().map(|(name, value)| format!("{name:<13} {value}\n")).collect()
}
