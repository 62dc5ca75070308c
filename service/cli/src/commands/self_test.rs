//! `d3dgen self-test`: the installed program on its own, from a sentence to checked files.

use std::fs;
use std::path::Path;
use std::time::Instant;

use d3dgen_pipeline::scene_graph::Request;
use d3dgen_plugins::{Plugin, Registry};

use super::formats::FormatArgs;
use super::generate::Job;
use super::generate::one::Maker;
use crate::database::StoreArgs;
use crate::error::Error;
use crate::input::write_text;
use crate::interrupt;
use crate::progress::Progress;
use crate::table::table;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Formats to write of each world, with commas between, or `all`
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "all")]
    format: Vec<String>,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let (registry, home) = (Registry::builtin(), temporary()?);
        let mut rows = Vec::new();
        for plugin in registry.iter() {
            interrupt::check()?;
            let begun = Instant::now();
            let made = [0, 1].map(|run| {
                let path = home.path().join(format!("{}_{run}", plugin.id()));
                self.world(&registry, plugin, &path).map(|()| path)
            });
            let [first, again] = made;
            let files = same_files(&first?, &again?)?;
            let seconds = format!("{:.2} s", begun.elapsed().as_secs_f64());
            rows.push(vec![plugin.id().to_owned(), "sound, twice the same".into(), files.to_string(), seconds]);
        }
        write_text(None, &table(&["domain", "", "files", "time"], &rows))
    }

    /// Makes the first building of a domain.
    fn world(&self, registry: &Registry, plugin: &dyn Plugin, path: &Path) -> Result<(), Error> {
        let domain = plugin.domain();
        let prompt = domain.programs.first().map_or(&domain.title, |p| &p.title).clone();
        let request = Request { prompt, domain: Some(domain.id.clone()), ..Request::default() };
        let formats = FormatArgs::with_png(self.format.clone()).chosen(&StoreArgs::default())?;
        let flag = interrupt::flag();
        let maker = Maker { registry, formats, allow_conflicts: false, proposals: None, flag };
        let name = Some(format!("{}_self_test", domain.id));
        let made = maker.make(&Job { request, name, path: path.to_path_buf() }, &Progress::silent())?;
        if made.sound() { Ok(()) } else { Err(Error::Unsound(made.page())) }
    }
}

fn temporary() -> Result<tempfile::TempDir, Error> {
    tempfile::TempDir::with_prefix("d3dgen-").map_err(|source| Error::Write { path: std::env::temp_dir(), source })
}

/// Returns the number of files of two folders that hold the same.
///
/// # Errors
/// `Unsound` with the first file that differs; `Read`.
fn same_files(a: &Path, b: &Path) -> Result<usize, Error> {
    let refused = |source| Error::Read { path: a.to_path_buf(), source };
    let names = |dir: &Path| -> std::io::Result<Vec<_>> {
        let mut names = fs::read_dir(dir)?.map(|e| e.map(|e| e.file_name())).collect::<Result<Vec<_>, _>>()?;
        names.sort();
        Ok(names)
    };
    let inside = names(a).map_err(refused)?;
    let differs = |path: &Path| Error::Unsound(format!("two runs differ in {}", path.display()));
    if inside != names(b).map_err(refused)? {
        return Err(differs(a));
    }
    let mut count = 0;
    for name in inside {
        let (a, b) = (a.join(&name), b.join(&name));
        if a.is_dir() {
            count += same_files(&a, &b)?;
        } else if fs::read(&a).map_err(refused)? == fs::read(&b).map_err(refused)? {
            count += 1;
        } else {
            return Err(differs(&a));
        }
    }
    Ok(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_compared_file_by_file() {
        let [a, b] = [0, 1].map(|_| tempfile::TempDir::new().unwrap());
        for home in [&a, &b] {
            fs::create_dir(home.path().join("maps")).unwrap();
            fs::write(home.path().join("maps/map.yaml"), "resolution: 0.05").unwrap();
            fs::write(home.path().join("world.json"), "{}").unwrap();
        }
        assert_eq!(same_files(a.path(), b.path()).unwrap(), 2);
        fs::write(b.path().join("maps/map.yaml"), "resolution: 0.10").unwrap();
        let message = same_files(a.path(), b.path()).unwrap_err().to_string();
        assert!(message.contains("map.yaml"), "{message}");
        fs::remove_file(b.path().join("maps/map.yaml")).unwrap();
        assert!(same_files(a.path(), b.path()).is_err());
    }
}
