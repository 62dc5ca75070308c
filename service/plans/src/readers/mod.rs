//! One file a format; [`all`] is the list.

mod dxf;
mod floorplan;
mod geojson;
mod nav2;
mod rmf;
mod svg;
mod trace;

use d3dgen_model::floorplan::Floorplan;
use serde::de::DeserializeOwned;

use crate::{Drawing, Error, Options};

/// Largest file that is read, bytes.
pub const MOST_BYTES: usize = 64 << 20;

/// A file of a plan.
pub struct Source<'a> {
    /// Its name, for its ending.
    pub name: &'a str,
    /// What is in it.
    pub bytes: &'a [u8],
    /// Returns a file that it names, of the same folder (the picture of a map).
    pub companion: &'a dyn Fn(&str) -> Option<Vec<u8>>,
}

impl Source<'_> {
    fn text(&self, format: &'static str) -> Result<&str, Error> {
        let text = std::str::from_utf8(self.bytes)
            .map_err(|e| Error::broken(format, format!("byte {}", e.valid_up_to()), "is no UTF-8 text"))?;
        Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
    }

    /// Reads YAML; the place of an error is its line.
    fn yaml<T: DeserializeOwned>(&self, format: &'static str) -> Result<T, Error> {
        serde_saphyr::from_str(self.text(format)?).map_err(|e| {
            let said = e.to_string();
            let first = said.lines().next().unwrap_or_default().trim_start_matches("error: ");
            match first.split_once(": ").filter(|(place, _)| place.starts_with("line ")) {
                Some((place, message)) => Error::broken(format, place, message),
                None => Error::broken(format, "file", first),
            }
        })
    }

    fn has_ending(&self, endings: &[&str]) -> bool {
        let name = self.name.to_ascii_lowercase();
        endings.iter().any(|e| name.ends_with(e))
    }

    /// Returns the first bytes as far as they are text.
    fn head(&self) -> String {
        String::from_utf8_lossy(&self.bytes[..self.bytes.len().min(4096)]).into_owned()
    }
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Plan {
    /// A floorplan document of ours.
    Document(Floorplan),
    /// A drawing, to be laid out.
    Drawing(Drawing),
}

/// A format.
pub struct Reader {
    /// Name for `--format`.
    pub name: &'static str,
    /// What it is, for people.
    pub title: &'static str,
    recognizes: fn(&Source) -> bool,
    read: fn(&Source, &Options) -> Result<Plan, Error>,
}

/// Every reader; the first that recognizes a file reads it.
pub fn all() -> &'static [Reader] {
    &[floorplan::READER, geojson::READER, svg::READER, dxf::READER, rmf::READER, nav2::READER]
}

/// Reads a plan.
///
/// # Errors
/// `UnknownFormat` with the formats there are; `Broken` with the place in the file; `Refused` for a scale that is missing.
pub fn read(source: &Source, options: &Options) -> Result<Plan, Error> {
    let known = || all().iter().map(|r| r.name).collect::<Vec<_>>().join(", ");
    if source.bytes.len() > MOST_BYTES {
        let message = format!("has {} MiB, at most {} MiB are read", source.bytes.len() >> 20, MOST_BYTES >> 20);
        return Err(Error::refused(source.name, message));
    }
    if let Some(m) = options.meters_per_unit.filter(|m| !(m.is_finite() && (1e-7..=1e4).contains(m))) {
        return Err(Error::refused("--meters-per-unit", format!("{m} m is no length of a unit")));
    }
    let reader = match &options.format {
        Some(name) => all().iter().find(|r| r.name == name).ok_or_else(|| {
            Error::UnknownFormat(format!("format `{name}` is not known; plans are read of {}", known()))
        })?,
        None => all().iter().find(|r| (r.recognizes)(source)).ok_or_else(|| {
            Error::UnknownFormat(format!("{} is no plan that is known; plans are read of {}", source.name, known()))
        })?,
    };
    (reader.read)(source, options)
}
