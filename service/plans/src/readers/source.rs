//! A file of a plan, what it holds, and what a format is.

use d3dgen_model::floorplan::Floorplan;
use serde::de::DeserializeOwned;

use crate::drawing::Drawing;
use crate::error::Error;
use crate::options::Options;

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
    pub(super) fn text(&self, format: &'static str) -> Result<&str, Error> {
        let text = std::str::from_utf8(self.bytes)
            .map_err(|e| Error::broken(format, format!("byte {}", e.valid_up_to()), "is no UTF-8 text"))?;
        Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
    }

    /// Reads YAML; the place of an error is its line.
    pub(super) fn yaml<T: DeserializeOwned>(&self, format: &'static str) -> Result<T, Error> {
        // what is no number is for the reader to judge: some programs write it where a 0 was meant
        let options = serde_saphyr::options! {
            non_finite_float_policy: serde_saphyr::options::NonFiniteFloatPolicy::PassThrough,
        };
        serde_saphyr::from_str_with_options(self.text(format)?, options).map_err(|e| {
            let said = e.to_string();
            let first = said.lines().next().unwrap_or_default().trim_start_matches("error: ");
            match first.split_once(": ").filter(|(place, _)| place.starts_with("line ")) {
                Some((place, message)) => Error::broken(format, place, message),
                None => Error::broken(format, "file", first),
            }
        })
    }

    pub(super) fn has_ending(&self, endings: &[&str]) -> bool {
        let name = self.name.to_ascii_lowercase();
        endings.iter().any(|e| name.ends_with(e))
    }

    /// Returns the first bytes as far as they are text.
    pub(super) fn head(&self) -> String {
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
    pub(super) recognizes: fn(&Source) -> bool,
    pub(super) read: fn(&Source, &Options) -> Result<Plan, Error>,
}
