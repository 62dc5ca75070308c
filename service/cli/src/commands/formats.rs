//! The flags that say which files to write of a world, shared by `generate` and `export`.

use std::path::PathBuf;

use d3dgen_export::Subject;
use d3dgen_export::exporters::{self, File, plan};
use d3dgen_export::manifest::{self, Manifest};
use d3dgen_model::domain::Domain;
use d3dgen_model::world::World;

use super::assets::Kept;
use crate::database::StoreArgs;
use crate::error::Error;
use crate::interrupt;
use crate::output::Output;
use crate::shelf::Shelf;

/// Flags for formats.
#[derive(clap::Args, Clone)]
pub struct FormatArgs {
    /// Formats to write, with commas between, or `all` (`d3dgen version` lists them)
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_values_t = usual())]
    format: Vec<String>,
    /// Leave out plan.png, which takes longer than all the rest
    #[arg(long)]
    no_png: bool,
    /// Folder in which models are kept once for many worlds; those of a world are hard links to it
    #[arg(long, value_name = "DIR")]
    models: Option<PathBuf>,
}

/// The formats chosen.
pub struct Formats {
    names: Vec<&'static str>,
    png: bool,
    kept: Kept,
    shelf: Option<Shelf>,
}

/// Returns the names of the formats that are written where none is named.
pub fn usual() -> Vec<String> {
    exporters::usual().map(|e| e.name().to_owned()).collect()
}

impl FormatArgs {
    /// Returns the flags for these formats, pictures and all.
    pub fn with_png(format: Vec<String>) -> Self {
        Self { format, no_png: false, models: None }
    }

    /// Returns the flags for these formats, plan.png left out.
    pub fn without_png(format: Vec<String>) -> Self {
        Self { format, no_png: true, models: None }
    }

    /// Returns the formats, each once, with the models of the database of assets.
    ///
    /// # Errors
    /// `Input` with the formats there are; `Assets` when the database is damaged; `Write` when the folder of models cannot be
    /// made.
    pub fn chosen(&self, store: &StoreArgs) -> Result<Formats, Error> {
        let shelf = self.models.as_deref().map(Shelf::at).transpose()?;
        Ok(Formats { names: self.names()?, png: self.png(), kept: Kept::of(store)?, shelf })
    }

    /// Returns the names of the formats, each once.
    ///
    /// # Errors
    /// `Input` with the formats there are.
    pub fn names(&self) -> Result<Vec<&'static str>, Error> {
        let named = exporters::named(self.format.iter().map(|name| name.trim()));
        Ok(named.map_err(|e| Error::Input(e.to_string()))?.iter().map(|e| e.name()).collect())
    }

    /// Returns true when plans are drawn as PNG too.
    pub fn png(&self) -> bool {
        !self.no_png
    }
}

impl Formats {
    /// Returns the names of the formats.
    pub fn names(&self) -> &[&'static str] {
        &self.names
    }

    /// Writes the files of the world, and `manifest.json`, in which the formats that the folder has already stay.
    ///
    /// # Errors
    /// `Export`, `Write`, or `Interrupted` between two formats.
    pub fn write(&self, world: &World, domain: &Domain, output: &Output) -> Result<(), Error> {
        let subject = Subject::new(world, domain, &self.kept);
        let mut manifest = Manifest::of(&subject)?;
        for exporter in self.names.iter().filter_map(|name| exporters::get(name)) {
            interrupt::check()?;
            let files = if exporter.name() == "plan" && !self.png {
                plan::files(world, domain, false)? // the picture is never drawn
            } else {
                exporter.export(&subject)?
            };
            manifest.add(exporter, &files);
            for file in files {
                match self.shelf.as_ref().filter(|_| file.is_shared()) {
                    Some(shelf) => output.link(&file.path, &shelf.place(&file)?)?,
                    None => output.write(&file.path, &file.bytes)?,
                }
            }
        }
        let File { path, bytes } = manifest.file(output.earlier(manifest::FILE).as_deref());
        output.write(&path, &bytes)
    }
}
