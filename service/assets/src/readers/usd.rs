//! USD: layers of text and binary layers whatever their ending, and USDZ packages.
//!
//! The library `openusd` parses and composes; this module gives it files ([`space`]), keeps it from what it cannot bear
//! ([`guard`]), and makes a model of the composed scene ([`scene`]) at the earliest time.

mod guard;
mod instances;
mod package;
mod scene;
mod shape;
mod space;
mod surface;
mod value;

use openusd::sdf::Value;
use openusd::usd::Stage;

use self::space::Space;
use super::builder::Builder;
use super::facts::{ReadModel, Refusal};
use super::{Reader, Source};

pub use self::shape::{Triangles, cuboid, turned_solid};

/// Reads USD.
pub struct Usd;

impl Reader for Usd {
    fn name(&self) -> &'static str {
        "usd"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["usdz", "usda", "usdc", "usd"]
    }

    fn recognizes(&self, head: &[u8], ending: &str) -> bool {
        let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
        head.starts_with(b"PXR-USDC")
            || text.starts_with(b"#usda ")
            || self.endings().contains(&ending) && (text.starts_with(b"#sdf ") || package::is_zip(head))
    }

    fn read(&self, source: &Source) -> Result<ReadModel, Refusal> {
        let format = match source.bytes {
            bytes if package::is_zip(bytes) => "usdz",
            bytes if bytes.starts_with(b"PXR-USDC") => "usdc",
            _ => "usda",
        };
        let mut builder = Builder::new(format);
        match fill(&mut builder, source) {
            Ok(()) => builder.finish(&source.name),
            Err(refusal) => Err(builder.refuse(refusal)),
        }
    }
}

fn fill(builder: &mut Builder, source: &Source) -> Result<(), Refusal> {
    if !package::is_zip(source.bytes) {
        guard::checked(source.bytes)?;
    }
    let (space, warnings) = Space::new(source.folder, source.bytes)?;
    warnings.into_iter().for_each(|w| builder.facts.warn(w));
    let stage = Stage::builder()
        .resolver(space.clone())
        .open(space.main())
        .map_err(|error| space.refused().into_iter().next().map_or_else(|| reason(&error), Refusal::new))?;
    let word = |field: &str| stage.stage_metadata(field).ok().flatten();
    let up = word("upAxis");
    let unit = word("metersPerUnit");
    let meters = match &unit {
        Some(value) => value::number(value).ok_or("its metersPerUnit is no number")?,
        None => 0.01,
    };
    let axis = up.as_ref().and_then(value::token);
    if axis.as_deref().is_some_and(|a| !matches!(a, "X" | "Y" | "Z")) {
        builder.facts.warn("its upAxis is neither X, Y nor Z; taken as Z");
    }
    let axis: String = axis.unwrap_or_else(|| "Y".into()).chars().take(32).collect();
    builder.set_frame((&axis, up.is_some()), (meters, unit.is_some()))?;
    let result = scene::read(builder, &stage, &space);
    for error in stage.composition_errors().iter().take(10) {
        builder.facts.warn(super::folder::shortened(&error.to_string().replace("<>model.", "its own file: .")));
    }
    space.refused().into_iter().for_each(|r| builder.facts.warn(r));
    let default = stage.default_prim().map(|p| p.as_str().to_owned());
    if default.is_some_and(|name| !stage.prim(format!("/{name}").as_str()).is_valid().unwrap_or(false)) {
        builder.facts.warn("its defaultPrim names nothing");
    }
    result
}

/// Returns an error of the library as a refusal.
fn reason(error: &dyn std::fmt::Display) -> Refusal {
    let text = format!("{error:#}").replace("<>model.", ".").replace('\n', " ");
    Refusal::new(format!("is no USD that can be read: {}", super::folder::shortened(&text)))
}

/// Returns the value of a field as a text, when it is one.
fn text(value: &Value) -> Option<String> {
    value::token(value)
}
