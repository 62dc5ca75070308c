//! Output folders that are either complete or not there.
//!
//! Everything is written into a temporary folder first: beside a folder to be made, inside one that exists (which may be
//! a mount point or the current folder and cannot be renamed). Dropping an [`Output`] leaves the disk as it was.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use d3dgen_export::{exporters, manifest};
use tempfile::TempDir;

use crate::error::Error;
use crate::interrupt;

/// Documents of a world's folder. Beside them it holds what exporters write; a folder with anything else in it is
/// somebody's work and is never replaced.
const DOCUMENTS: &[&str] = &[
    WORLD,
    MARK,
    "brief.json",
    "scene_graph.json",
    "floorplan.json",
    "placements.json",
    "scenario.json",
    "proposal.json",
    "scenarios",
    VIEW,
    PICTURES,
    manifest::FILE,
];
/// Folders of the page and the pictures that `view` and `render` make of a world.
pub const VIEW: &str = "view";
pub const PICTURES: &str = "pictures";
/// Files of a simulation's folder; one with anything else in it is somebody's work.
const RUN: &[&str] = &["trajectory.json", "walkable.geojson", "metrics.json", "scenario.json", "crowd.png"];
/// The file that only the folder of a world has which may be used.
const WORLD: &str = "world.json";
/// The file that every world's folder has, sound or not.
const MARK: &str = "report.json";
const TMP_PREFIX: &str = ".d3dgen-";
const TMP_SUFFIX: &str = ".tmp";

/// A folder being written.
pub struct Output {
    path: PathBuf,
    tmp: TempDir,
    exists: bool,
    adds: bool,
}

/// The folder of an earlier world that stays, for what came now is none.
pub struct Kept(PathBuf);

impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "nothing was written; {} keeps the earlier world, name another folder", self.0.display())
    }
}

impl Output {
    /// Returns an output for a folder that is absent, empty, or an earlier output.
    ///
    /// # Errors
    /// `Input` when the folder holds other things, `Write` when it cannot be written.
    pub fn new(path: &Path) -> Result<Self, Error> {
        Self::begin(path, check_free(path)?, false)
    }

    /// Returns an output that replaces only the files and folders it writes itself.
    ///
    /// # Errors
    /// As [`Output::new`]; an earlier export, which is no whole world, is taken too.
    pub fn adding_to(path: &Path) -> Result<Self, Error> {
        Self::begin(path, check_ours(path, false)?, true)
    }

    /// Returns an output that adds its files to whatever a folder holds, and replaces those of the same names.
    ///
    /// # Errors
    /// `Input` when the path is a file, `Write` when it cannot be written.
    pub fn among(path: &Path) -> Result<Self, Error> {
        match fs::metadata(path) {
            Ok(found) if !found.is_dir() => {
                Err(Error::Input(format!("{} is a file; --out needs a folder", path.display())))
            }
            found => Self::begin(path, found.is_ok(), true),
        }
    }

    /// Returns an output for a folder that is absent, empty, or that of an earlier simulation.
    ///
    /// # Errors
    /// As [`Output::new`].
    pub fn run_of(path: &Path) -> Result<Self, Error> {
        let exists = path.is_dir();
        let names = if exists { entries(path) } else { Ok(Vec::new()) };
        let names = names.map_err(|source| Error::Write { path: path.to_path_buf(), source })?;
        let foreign = names.iter().find(|n| !is_leftover(n) && !RUN.contains(&n.as_str()));
        match foreign {
            _ if path.exists() && !exists => {
                Err(Error::Input(format!("{} is a file; --out needs a folder", path.display())))
            }
            Some(name) => {
                let message =
                    format!("{} holds {name}, which is of no simulation; name another folder", path.display());
                Err(Error::Input(message))
            }
            None => Self::begin(path, exists, true),
        }
    }

    fn begin(path: &Path, exists: bool, adds: bool) -> Result<Self, Error> {
        interrupt::listen();
        let home = if exists { path } else { nearest_folder(path) };
        let refused = |source: io::Error| {
            // Without the temporary name, which tells the reader nothing.
            let said = source.to_string();
            let reason = said.split(" at path ").next().unwrap_or_default().to_owned();
            Error::Write { path: path.to_path_buf(), source: io::Error::new(source.kind(), reason) }
        };
        let tmp = tempfile::Builder::new().prefix(TMP_PREFIX).suffix(TMP_SUFFIX).tempdir_in(home).map_err(refused)?;
        fs::create_dir(tmp.path().join("new")).map_err(refused)?;
        Ok(Self { path: path.to_path_buf(), tmp, exists, adds })
    }

    /// Writes a file of the folder, with the folders above it.
    ///
    /// # Errors
    /// `Write` with the path the file would have had.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        let file = self.fresh().join(name);
        let folder = file.parent().map_or(Ok(()), fs::create_dir_all);
        folder
            .and_then(|()| fs::write(&file, bytes))
            .map_err(|source| Error::Write { path: self.path.join(name), source })
    }

    /// Puts a file of the folder that is kept elsewhere: a hard link, or a copy where the system can make none.
    ///
    /// # Errors
    /// As [`Output::write`].
    pub fn link(&self, name: &str, kept: &Path) -> Result<(), Error> {
        let file = self.fresh().join(name);
        let folder = file.parent().map_or(Ok(()), fs::create_dir_all);
        folder
            .and_then(|()| fs::hard_link(kept, &file).or_else(|_| fs::copy(kept, &file).map(|_| ())))
            .map_err(|source| Error::Write { path: self.path.join(name), source })
    }

    /// Returns a file that stays in the folder unless it is written anew; none in a folder that goes away whole.
    pub fn earlier(&self, name: &str) -> Option<Vec<u8>> {
        self.adds.then(|| fs::read(self.path.join(name)).ok()).flatten()
    }

    /// Puts the folder in its place; an earlier output goes away whole. A folder without a world takes the place of none
    /// with one: that one stays as it is, and so the name of its folder is returned.
    ///
    /// # Errors
    /// `Write`; what was there before is then still there.
    pub fn commit(self) -> Result<Option<Kept>, Error> {
        if !self.adds && self.path.join(WORLD).exists() && !self.fresh().join(WORLD).exists() {
            return Ok(Some(Kept(self.path.clone())));
        }
        let moved = match (self.exists, self.adds) {
            (false, _) => self.rename(),
            (true, false) => self.swap().or_else(|_| self.exchange()),
            (true, true) => self.exchange(),
        };
        moved.map(|()| None).map_err(|source| Error::Write { path: self.path.clone(), source })
    }

    fn fresh(&self) -> PathBuf {
        self.tmp.path().join("new")
    }

    fn rename(&self) -> io::Result<()> {
        if let Some(parent) = self.path.parent() {
            fs::create_dir_all(parent)?;
        }
        fs::rename(self.fresh(), &self.path)
    }

    /// Swaps the whole folder with the old one in a single step that cannot be seen half done.
    ///
    /// It fails, with nothing changed, for a mount point, a link, the current folder, and where the system cannot do it.
    #[cfg(target_os = "linux")]
    fn swap(&self) -> io::Result<()> {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        if fs::symlink_metadata(&self.path)?.is_symlink() {
            return Err(io::ErrorKind::Unsupported.into());
        }
        let beside =
            tempfile::Builder::new().prefix(TMP_PREFIX).suffix(TMP_SUFFIX).tempdir_in(nearest_folder(&self.path))?;
        let fresh = beside.path().join("new");
        fs::rename(self.fresh(), &fresh)?;
        renameat_with(CWD, &fresh, CWD, &self.path, RenameFlags::EXCHANGE).or_else(|refused| {
            fs::rename(&fresh, self.fresh())?;
            Err(refused.into())
        }) // what was there before goes with `beside`
    }

    #[cfg(not(target_os = "linux"))]
    fn swap(&self) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Swaps the entries of an existing folder: the mark of a finished output goes first and comes last, so that a folder
    /// that was being swapped when the power went is known by its missing mark and its temporary folder.
    fn exchange(&self) -> io::Result<()> {
        let old = self.tmp.path().join("old");
        fs::create_dir(&old)?;
        let mut done: Vec<(PathBuf, PathBuf)> = Vec::new();
        let mut step = |from: PathBuf, to: PathBuf| {
            fs::rename(&from, &to)?;
            done.push((from, to));
            Ok(())
        };
        let mut incoming = entries(&self.fresh())?;
        incoming.sort_by_key(|name| name == MARK);
        let goes = |name: &String| !self.tmp.path().ends_with(name) && (!self.adds || incoming.contains(name));
        let mut outgoing: Vec<String> = entries(&self.path)?.into_iter().filter(goes).collect();
        outgoing.sort_by_key(|name| name != MARK);
        let result = outgoing
            .iter()
            .map(|name| (self.path.join(name), old.join(name)))
            .chain(incoming.iter().map(|name| (self.fresh().join(name), self.path.join(name))))
            .try_for_each(|(from, to)| step(from, to));
        if result.is_err() {
            for (from, to) in done.iter().rev() {
                // The first error is the one to report; what cannot be moved back stays in the temporary folder's place.
                let _ = fs::rename(to, from);
            }
        }
        result
    }
}

/// Returns whether the folder exists; refuses one that holds other things than an output.
///
/// # Errors
/// `Input` when it is no folder or holds other things, `Write` when it cannot be looked into.
pub fn check_free(path: &Path) -> Result<bool, Error> {
    check_ours(path, true)
}

fn check_ours(path: &Path, marked: bool) -> Result<bool, Error> {
    match fs::metadata(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound && fs::symlink_metadata(path).is_err() => return Ok(false),
        Err(source) => return Err(Error::Write { path: path.to_path_buf(), source }),
        Ok(found) if !found.is_dir() => {
            return Err(Error::Input(format!("{} is a file; --out needs a folder", path.display())));
        }
        Ok(_) => {}
    }
    let all = entries(path).map_err(|source| Error::Write { path: path.to_path_buf(), source })?;
    let names: Vec<&String> = all.iter().filter(|n| !is_leftover(n)).collect();
    let foreign = names.iter().find(|n| !is_ours(n));
    // A leftover stands for the mark: a run was killed while it put the mark in place.
    let has_mark = all.iter().any(|n| n == MARK || is_leftover(n));
    if let Some(name) = foreign.or(names.first().filter(|_| marked && !has_mark)) {
        return Err(Error::Input(format!(
            "{} holds `{name}` and is not an output of d3dgen; name an empty or new folder",
            path.display()
        )));
    }
    Ok(true)
}

/// Refuses a folder for many worlds that holds anything but worlds in numbered folders.
///
/// # Errors
/// As [`check_free`].
pub fn check_collection(path: &Path) -> Result<(), Error> {
    let Ok(names) = entries(path) else {
        return check_free(path).map(|_| ());
    };
    match names.iter().find(|n| !is_leftover(n) && !n.bytes().all(|b| b.is_ascii_digit())) {
        Some(name) => Err(Error::Input(format!(
            "{} holds `{name}`, and with --count it may hold only worlds in numbered folders; name an empty or new folder",
            path.display()
        ))),
        None => Ok(()),
    }
}

/// Returns true for the name of a document or of what an exporter writes.
fn is_ours(name: &str) -> bool {
    DOCUMENTS.contains(&name) || exporters::roots().any(|root| root == name)
}

fn is_leftover(name: &str) -> bool {
    name.starts_with(TMP_PREFIX) && name.ends_with(TMP_SUFFIX)
}

fn entries(folder: &Path) -> io::Result<Vec<String>> {
    let mut names = fs::read_dir(folder)?
        .map(|e| e.map(|e| e.file_name().to_string_lossy().into_owned()))
        .collect::<io::Result<Vec<String>>>()?;
    names.sort();
    Ok(names)
}

/// Returns the nearest ancestor that exists: on the same file system as the folder to be made.
fn nearest_folder(path: &Path) -> &Path {
    let above = path.ancestors().skip(1).find(|p| p.as_os_str().is_empty() || p.exists());
    above.filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(folder: &Path) -> Vec<String> {
        entries(folder).unwrap()
    }

    #[test]
    fn a_new_folder_appears_whole_or_not_at_all() {
        let home = TempDir::new().unwrap();
        let path = home.path().join("a/b");
        let output = Output::new(&path).unwrap();
        output.write("arena/x.yaml", b"1").unwrap();
        assert!(!path.exists());
        drop(output);
        assert_eq!(files(home.path()), Vec::<String>::new());

        let output = Output::new(&path).unwrap();
        output.write("report.json", b"{}").unwrap();
        output.commit().unwrap();
        assert_eq!(files(home.path()), ["a"]);
        assert_eq!(files(&path), ["report.json"]);
    }

    #[test]
    fn what_is_kept_elsewhere_is_in_the_folder_and_stays_where_it_is_kept() {
        let home = TempDir::new().unwrap();
        let kept = home.path().join("kept");
        fs::write(&kept, b"oak").unwrap();
        let output = Output::new(&home.path().join("a")).unwrap();
        output.link("usd/textures/oak.png", &kept).unwrap();
        assert!(output.link("usd/lost.png", &home.path().join("none")).is_err());
        output.write("report.json", b"{}").unwrap();
        output.commit().unwrap();
        assert_eq!(fs::read(home.path().join("a/usd/textures/oak.png")).unwrap(), b"oak");
        fs::remove_dir_all(home.path().join("a")).unwrap();
        assert_eq!(fs::read(&kept).unwrap(), b"oak");
    }

    #[test]
    fn an_earlier_output_is_replaced_whole() {
        let home = TempDir::new().unwrap();
        for names in [["report.json", "arena/a.yaml"], ["report.json", "plan.svg"]] {
            let output = Output::new(home.path()).unwrap();
            names.iter().for_each(|n| output.write(n, n.as_bytes()).unwrap());
            output.commit().unwrap();
        }
        assert_eq!(files(home.path()), ["plan.svg", "report.json"]);
    }

    #[test]
    fn a_world_is_replaced_by_worlds_only() {
        let home = TempDir::new().unwrap();
        let put = |names: &[&str]| {
            let output = Output::new(home.path()).unwrap();
            names.iter().for_each(|n| output.write(n, n.as_bytes()).unwrap());
            output.commit().unwrap().is_none()
        };
        assert!(put(&["report.json"]) && put(&["report.json", "world.json", "plan.svg"]));
        assert!(!put(&["report.json", "floorplan.json"]));
        assert_eq!(files(home.path()), ["plan.svg", "report.json", "world.json"]);
        assert!(put(&["report.json", "world.json"]));
        assert_eq!(files(home.path()), ["report.json", "world.json"]);
    }

    #[test]
    fn what_any_exporter_writes_may_be_replaced() {
        for root in exporters::roots() {
            let home = TempDir::new().unwrap();
            fs::write(home.path().join(MARK), "{}").unwrap();
            fs::write(home.path().join(root), "").unwrap();
            assert!(check_free(home.path()).unwrap(), "{root}");
        }
        let home = TempDir::new().unwrap();
        fs::write(home.path().join(MARK), "{}").unwrap();
        fs::create_dir(home.path().join("no_exporter")).unwrap();
        assert!(check_free(home.path()).is_err());
    }

    #[test]
    fn what_a_killed_run_left_is_cleaned_up() {
        let home = TempDir::new().unwrap();
        let left = home.path().join(".d3dgen-abc.tmp/old");
        fs::create_dir_all(&left).and_then(|()| fs::write(left.join("report.json"), "{}")).unwrap();
        fs::write(home.path().join("plan.svg"), "").unwrap();
        let output = Output::new(home.path()).unwrap();
        output.write("report.json", b"{}").unwrap();
        output.commit().unwrap();
        assert_eq!(files(home.path()), ["report.json"]);
    }

    #[test]
    fn what_is_not_ours_is_left_alone() {
        let home = TempDir::new().unwrap();
        fs::write(home.path().join("report.json"), "{}").unwrap();
        assert!(check_free(home.path()).unwrap());
        fs::write(home.path().join("thesis.tex"), "x").unwrap();
        let message = Output::new(home.path()).err().unwrap().to_string();
        assert!(message.contains("thesis.tex"), "{message}");
        assert!(check_collection(home.path()).is_err());
        let file = home.path().join("thesis.tex");
        assert!(Output::new(&file).is_err() && Output::new(&file.join("below")).is_err());
        assert_eq!(files(home.path()), ["report.json", "thesis.tex"]);
    }
}
