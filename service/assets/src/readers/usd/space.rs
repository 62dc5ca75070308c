//! The files that a USD scene may consist of, as the USD library asks for them: in the folder of the model and in
//! packages, under names of our own, so that nothing else can be reached.
//!
//! Such a name is a path from the folder of the model; files in a package follow its name as if it were a folder. The
//! name under which a layer is opened ends in `#.usda` or `#.usdc` by its content, since files lie about their endings.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::io::{self, Cursor};
use std::rc::Rc;

use openusd::ar::{Asset, ResolvedPath, Resolver};

use super::guard;
use super::package::{Package, is_layer, is_zip};
use crate::readers::facts::Refusal;
use crate::readers::folder::{Folder, MAX_FILE_BYTES};

/// The most bytes of all layers of a scene.
const MAX_TOTAL_BYTES: usize = 384 << 20;
/// The most openings of layers of a scene.
const MAX_OPENINGS: usize = 4_000;
/// The deepest nesting of packages.
const MAX_NESTING: usize = 16;

/// The files of a scene; clones share them.
#[derive(Clone)]
pub struct Space(Rc<Inner>);

struct Inner {
    folder: Folder,
    /// The name of the model's own file.
    main: String,
    files: RefCell<BTreeMap<String, Option<Rc<File>>>>,
    bytes: Cell<usize>,
    openings: Cell<usize>,
    /// The first reason why a layer was not given.
    refused: RefCell<Vec<String>>,
}

/// A file with its package, when it is one.
struct File {
    bytes: Vec<u8>,
    package: Option<Package>,
}

impl Space {
    /// Returns the files around a model's own file, whose content is given.
    ///
    /// # Errors
    ///
    /// When it is a package that cannot be used.
    pub fn new(folder: &Folder, bytes: &[u8]) -> Result<(Self, Vec<String>), Refusal> {
        let package = if is_zip(bytes) { Some(Package::read(bytes)?) } else { None };
        let mut warnings = Vec::new();
        let mut main = "model.usd";
        if let Some(package) = &package {
            main = "model.usdz";
            warnings.extend(package.warnings.iter().cloned());
            package.root()?.content(bytes)?;
        }
        let file = Rc::new(File { bytes: bytes.to_vec(), package });
        // A name that no file beside it can have.
        let main = format!("<>{main}");
        let inner = Inner {
            folder: folder.clone(),
            files: RefCell::new(BTreeMap::from([(main.clone(), Some(file))])),
            main,
            bytes: Cell::new(bytes.len()),
            openings: Cell::new(0),
            refused: RefCell::new(Vec::new()),
        };
        Ok((Self(Rc::new(inner)), warnings))
    }

    /// Returns the name of the model's own file.
    pub fn main(&self) -> &str {
        &self.0.main
    }

    /// Returns why layers were not given, for whoever misses them.
    pub fn refused(&self) -> Vec<String> {
        self.0.refused.borrow().clone()
    }

    /// Returns the content of a file by the name under which it was found, of at most so many bytes.
    pub fn content(&self, name: &str, most: u64) -> Option<Vec<u8>> {
        self.with(plain(name), |bytes| (bytes.len() as u64 <= most).then(|| bytes.to_vec()), most)?
    }

    /// Splits a name at its outermost package: the file on disk, and the rest.
    fn split(name: &str) -> (&str, Option<&str>) {
        let lower = name.to_ascii_lowercase();
        match lower.find(".usdz/") {
            Some(at) => (&name[..at + 5], Some(&name[at + 6..])),
            None => (name, None),
        }
    }

    fn file(&self, name: &str, most: u64) -> Option<Rc<File>> {
        if let Some(file) = self.0.files.borrow().get(name) {
            return file.clone();
        }
        let bytes = self.0.folder.read(name, most.min(MAX_FILE_BYTES)).ok();
        let file = bytes.map(|bytes| {
            let package = if is_zip(&bytes) { Package::read(&bytes).ok() } else { None };
            Rc::new(File { bytes, package })
        });
        // Pictures are read once, layers and packages stay.
        if file.is_none() || is_layer(name) {
            let length = file.as_ref().map_or(0, |f| f.bytes.len());
            self.0.bytes.set(self.0.bytes.get() + length);
            if self.0.bytes.get() > MAX_TOTAL_BYTES {
                self.note("its layers have more than 384 MiB in all");
                return None;
            }
            self.0.files.borrow_mut().insert(name.to_owned(), file.clone());
        }
        file
    }

    /// Gives the content of a file to a function, when it is there.
    fn with<T>(&self, name: &str, look: impl FnOnce(&[u8]) -> T, most: u64) -> Option<T> {
        let (outer, inside) = Self::split(name);
        let file = self.file(outer, most)?;
        match inside {
            None => Some(look(&file.bytes)),
            Some(inside) => self.within(&file.bytes, file.package.as_ref()?, inside, look, MAX_NESTING),
        }
    }

    /// Gives the content of a file in a package, or in a package in it, to a function.
    fn within<T>(
        &self,
        bytes: &[u8],
        package: &Package,
        name: &str,
        look: impl FnOnce(&[u8]) -> T,
        left: usize,
    ) -> Option<T> {
        let (entry, deeper) = Self::split(name);
        let content = match package.find(entry)?.content(bytes) {
            Ok(content) => content,
            Err(refusal) => {
                self.note(&refusal.reason);
                return None;
            }
        };
        match deeper {
            None => Some(look(content)),
            Some(deeper) => self.within(content, &Package::read(content).ok()?, deeper, look, left.checked_sub(1)?),
        }
    }

    fn note(&self, reason: &str) {
        let mut refused = self.0.refused.borrow_mut();
        if refused.len() < 20 && !refused.iter().any(|r| r == reason) {
            refused.push(reason.to_owned());
        }
    }

    fn exists(&self, name: &str) -> bool {
        match Self::split(name) {
            (outer, None) if outer != self.0.main => self.0.folder.resolve(outer).is_some(),
            _ => self.with(name, |_| (), MAX_FILE_BYTES).is_some(),
        }
    }
}

/// Returns a name without the mark of what a layer is.
fn plain(name: &str) -> &str {
    name.strip_suffix("#.usda").or_else(|| name.strip_suffix("#.usdc")).unwrap_or(name)
}

/// Returns the path that a layer names, seen from the folder `from`; none when it leaves the package it is in.
fn joined(from: &str, path: &str) -> Option<String> {
    let mut parts: Vec<&str> = from.split('/').filter(|p| !p.is_empty()).collect();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => match parts.last() {
                Some(last) if last.to_ascii_lowercase().ends_with(".usdz") => return None,
                Some(&"..") | None => parts.push(".."),
                Some(_) => drop(parts.pop()),
            },
            part => parts.push(part),
        }
    }
    Some(parts.join("/"))
}

/// What no file is called: a path that cannot be reached.
const NOWHERE: &str = "<nowhere>/";

impl Resolver for Space {
    fn create_identifier(&self, asset_path: &str, anchor: Option<&ResolvedPath>) -> String {
        // Names of our own come back without an anchor.
        let own = anchor.is_none() && asset_path.starts_with(&self.0.main) || asset_path.starts_with(NOWHERE);
        if asset_path.is_empty() || own {
            return asset_path.to_owned();
        }
        // `package.usdz[inner.usd]` names a file in a package.
        let path = asset_path.replace('[', "/").replace(']', "").replace('\\', "/");
        let drive = path.get(1..2) == Some(":");
        if path.starts_with('/') || drive || path.contains("://") || path.contains("<>") {
            return format!("{NOWHERE}{path}");
        }
        let anchor = anchor.map(|a| a.to_string_lossy().into_owned()).unwrap_or_default();
        let from = plain(&anchor).rsplit_once('/').map_or("", |(folder, _)| folder);
        let nowhere = || format!("{NOWHERE}{path}");
        let Some(near) = joined(from, &path) else { return nowhere() };
        // In a package, a path that is not said to be relative to its layer may also begin at the top.
        let relative = path.starts_with("./") || path.starts_with("../");
        let package = from.to_ascii_lowercase().rfind(".usdz/").map(|at| &from[..at + 5]);
        if let (Some(package), false) = (package, relative)
            && !self.exists(&near)
        {
            return joined(package, &path).unwrap_or_else(nowhere);
        }
        near
    }

    fn resolve(&self, asset_path: &str) -> Option<ResolvedPath> {
        let name = plain(asset_path);
        if name.is_empty() || name.starts_with(NOWHERE) {
            return None;
        }
        if !is_layer(name) {
            return self.exists(name).then(|| ResolvedPath::new(name));
        }
        enum Kind {
            Text,
            Crate,
            Root(Option<String>),
        }
        let kind = self.with(
            name,
            |bytes| match () {
                () if is_zip(bytes) => {
                    let package = Package::read(bytes).ok();
                    Kind::Root(package.and_then(|p| p.root().ok().map(|e| e.name.clone())))
                }
                () if bytes.starts_with(b"PXR-USDC") => Kind::Crate,
                () => Kind::Text,
            },
            MAX_FILE_BYTES,
        )?;
        match kind {
            Kind::Text => Some(ResolvedPath::new(format!("{name}#.usda"))),
            Kind::Crate => Some(ResolvedPath::new(format!("{name}#.usdc"))),
            Kind::Root(root) if name.matches(".usdz").count() <= MAX_NESTING => {
                self.resolve(&format!("{name}/{}", root?))
            }
            Kind::Root(_) => None,
        }
    }

    fn resolve_for_new_asset(&self, _: &str) -> Option<ResolvedPath> {
        None
    }

    fn open_asset(&self, resolved_path: &ResolvedPath) -> io::Result<Box<dyn Asset>> {
        let name = resolved_path.to_string_lossy().into_owned();
        self.0.openings.set(self.0.openings.get() + 1);
        if self.0.openings.get() > MAX_OPENINGS {
            return Err(io::Error::other(format!("it opens more than {MAX_OPENINGS} layers")));
        }
        let missing = || io::Error::new(io::ErrorKind::NotFound, "it is not there");
        let checked = self.with(plain(&name), guard::checked, MAX_FILE_BYTES).ok_or_else(missing)?;
        let checked = checked.map_err(|refusal| {
            self.note(&refusal.reason);
            io::Error::other(refusal.reason)
        })?;
        checked.warning.into_iter().for_each(|w| self.note(w));
        Ok(Box::new(Cursor::new(checked.bytes)))
    }

    fn identity(&self) -> String {
        self.0.main.clone()
    }
}
