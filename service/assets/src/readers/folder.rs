//! The only way to a file: inside of a folder, of a bounded size, never a pipe, a device or a link out of the folder.

use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use super::facts::Refusal;

/// The largest file that is read.
pub const MAX_FILE_BYTES: u64 = 256 << 20;
/// The largest picture that is kept with a model.
pub const MAX_PICTURE_BYTES: u64 = 16 << 20;
/// How many folders above its own a model may name files in, where no root is given.
const CLIMB: usize = 4;
/// Endings of files that a model may name above its own folder.
const ENDINGS: &[&str] = &[
    "usd", "usda", "usdc", "usdz", "gltf", "glb", "bin", "obj", "mtl", "dae", "stl", "png", "jpg", "jpeg", "tga",
    "bmp", "tif", "tiff", "webp", "ktx", "ktx2", "exr", "hdr", "dds", "gif", "avif", "sdf", "config",
];

/// The folder of a model, and how far around it files may be read.
#[derive(Debug, Clone)]
pub struct Folder {
    /// Where relative paths begin.
    base: PathBuf,
    /// No file outside of it is read.
    root: PathBuf,
    /// The files that were asked for and are there.
    used: Arc<Mutex<BTreeSet<PathBuf>>>,
}

impl Folder {
    /// Returns the folder of a file, and the file's own name in it. Files may be read in `root`, or, when it is none, in
    /// the folder of the file and a few above it.
    ///
    /// # Errors
    ///
    /// When the folder is not there, or the file is outside of the root.
    pub fn of(file: &Path, root: Option<&Path>) -> Result<(Self, PathBuf), Refusal> {
        let parent = match file.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let name = file.file_name().ok_or("is no file")?;
        let base = parent.canonicalize().map_err(|e| format!("its folder cannot be read: {e}"))?;
        let root = match root {
            Some(root) => root.canonicalize().map_err(|e| format!("{} cannot be read: {e}", root.display()))?,
            None => {
                // Never the top of the file system, nor a folder in it.
                let depth = base.components().count();
                let climb = CLIMB.min(depth.saturating_sub(3));
                base.ancestors().nth(climb).unwrap_or(&base).to_path_buf()
            }
        };
        if !base.starts_with(&root) {
            return Err(format!("is outside of {}", root.display()).into());
        }
        Ok((Self { base, root, used: Arc::default() }, PathBuf::from(name)))
    }

    /// Returns the folder that a file named in this one is in.
    pub fn of_named(&self, path: &str) -> Option<Self> {
        let file = self.resolve(path)?;
        Some(Self { base: file.parent()?.to_path_buf(), ..self.clone() })
    }

    /// Returns where relative paths begin.
    pub fn base(&self) -> &Path {
        &self.base
    }

    /// Returns how many folders above its own files may be read in.
    pub fn height(&self) -> usize {
        self.base.strip_prefix(&self.root).map_or(0, |below| below.components().count())
    }

    /// Returns the file that a model names, when it is there and may be read. Backslashes part folders too, as in files
    /// made on Windows.
    pub fn resolve(&self, path: &str) -> Option<PathBuf> {
        let path = path.replace('\\', "/");
        if path.is_empty() || path.contains(['\0', '\n']) || path.contains("://") || path.starts_with("data:") {
            return None;
        }
        let mut joined = self.base.clone();
        for part in Path::new(&path).components() {
            match part {
                Component::Normal(part) => joined.push(part),
                Component::CurDir => {}
                Component::ParentDir => drop(joined.pop().then_some(())?),
                Component::RootDir | Component::Prefix(_) => return None,
            }
        }
        self.allowed(&joined)
    }

    /// Returns a file beside the model by its name alone, whatever letters the name has.
    pub fn file(&self, name: &Path) -> Option<PathBuf> {
        let parts: Vec<Component> = name.components().collect();
        matches!(parts.as_slice(), [Component::Normal(_)]).then(|| self.allowed(&self.base.join(name)))?
    }

    fn allowed(&self, path: &Path) -> Option<PathBuf> {
        let within = |path: &Path| {
            let known = || {
                let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
                ENDINGS.contains(&ending.as_str())
            };
            path.starts_with(&self.base) || path.starts_with(&self.root) && known()
        };
        // Before the file system is asked: what is outside is not even looked at.
        if !within(path) {
            return None;
        }
        let real = path.canonicalize().ok()?;
        if !within(&real) || !real.metadata().is_ok_and(|m| m.is_file()) {
            return None;
        }
        self.used.lock().unwrap_or_else(PoisonError::into_inner).insert(real.clone());
        Some(real)
    }

    /// Returns the files that a model, and what it names, asked for so far, its own among them.
    pub fn used(&self) -> Vec<PathBuf> {
        self.used.lock().unwrap_or_else(PoisonError::into_inner).iter().cloned().collect()
    }

    /// Returns the content of a file that a model names.
    ///
    /// # Errors
    ///
    /// When it is not there, outside of the root, no plain file, or larger than `most` bytes.
    pub fn read(&self, path: &str, most: u64) -> Result<Vec<u8>, Refusal> {
        let file = self.resolve(path).ok_or_else(|| {
            format!("names the file `{}`, which is not there or outside of its folder", shortened(path))
        })?;
        read(&file, most).map_err(|e| format!("names the file `{}`, which {e}", shortened(path)).into())
    }

    /// Returns the content of the model's own file.
    ///
    /// # Errors
    ///
    /// As of [`Folder::read`].
    pub fn read_own(&self, name: &Path) -> Result<Vec<u8>, Refusal> {
        let path = self.base.join(name);
        let meta = path.symlink_metadata().map_err(|e| e.to_string())?;
        let file = self.file(name).ok_or(match () {
            () if meta.is_dir() => "is a folder",
            () if meta.is_symlink() => "is a link to nothing, to no file, or out of its folder; name the file itself",
            () => "is no plain file",
        })?;
        read(&file, MAX_FILE_BYTES)
    }
}

fn read(file: &Path, most: u64) -> Result<Vec<u8>, Refusal> {
    let handle = std::fs::File::open(file).map_err(|e| format!("cannot be read: {e}"))?;
    let length = handle.metadata().map_err(|e| format!("cannot be read: {e}"))?.len();
    let too_long = || Refusal::new(format!("is larger than {} MiB", most >> 20));
    if length > most {
        return Err(too_long());
    }
    let mut bytes = Vec::with_capacity(length as usize);
    handle.take(most + 1).read_to_end(&mut bytes).map_err(|e| format!("cannot be read: {e}"))?;
    if bytes.len() as u64 > most { Err(too_long()) } else { Ok(bytes) }
}

/// Returns a text from a file so that it can stand in a message.
pub fn shortened(text: &str) -> String {
    let text: String = text.chars().take(120).map(|c| if c.is_control() { '?' } else { c }).collect();
    if text.chars().count() == 120 { text + "..." } else { text }
}
