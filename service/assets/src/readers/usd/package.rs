//! USDZ packages: ZIP archives whose files are stored as they are. Nothing is unpacked to disk.

use std::collections::BTreeSet;

use crate::readers::facts::Refusal;

/// The most entries of a package.
const MAX_ENTRIES: usize = 20_000;

/// A package: where each file is in its bytes.
#[derive(Debug)]
pub struct Package {
    /// Files in the order of the directory.
    pub entries: Vec<Entry>,
    /// What is odd about it without being a reason to refuse it.
    pub warnings: Vec<String>,
    names: BTreeSet<String>,
}

/// A file in a package.
#[derive(Debug)]
pub struct Entry {
    /// Name with folders, parted by `/`.
    pub name: String,
    start: usize,
    length: usize,
    packed: usize,
    crc: u32,
    /// Whether it is stored, and not compressed or encrypted.
    plain: bool,
}

/// Tells whether bytes are a ZIP archive.
pub fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06")
}

/// Tells whether a name ends as a USD layer or package does.
pub fn is_layer(name: &str) -> bool {
    let ending = name.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase()).unwrap_or_default();
    matches!(ending.as_str(), "usd" | "usda" | "usdc" | "usdz")
}

struct Directory<'a>(&'a [u8]);

impl Directory<'_> {
    fn u16(&self, at: usize) -> Option<usize> {
        Some(usize::from(u16::from_le_bytes(self.0.get(at..at.checked_add(2)?)?.try_into().ok()?)))
    }

    fn u32(&self, at: usize) -> Option<u32> {
        Some(u32::from_le_bytes(self.0.get(at..at.checked_add(4)?)?.try_into().ok()?))
    }
}

impl Package {
    /// Reads the directory of a package.
    ///
    /// # Errors
    ///
    /// When it is no whole archive, or a name in it leaves the package.
    pub fn read(bytes: &[u8]) -> Result<Self, Refusal> {
        let data = Directory(bytes);
        let end = end_record(bytes).ok_or("is no whole package: its directory is cut off or was never there")?;
        let count = data.u16(end + 10).unwrap_or(0);
        let (size, start) = (data.u32(end + 12).unwrap_or(0) as usize, data.u32(end + 16).unwrap_or(0) as usize);
        if count > MAX_ENTRIES {
            return Err(format!("has {count} files in its package, more than {MAX_ENTRIES}").into());
        }
        // Bytes before the first file move everything by their length.
        let shift = end.checked_sub(size).and_then(|real| real.checked_sub(start));
        let shift = shift.ok_or("its directory is longer than the file")?;
        let mut at = start + shift;
        let mut package = Self { entries: Vec::new(), names: BTreeSet::new(), warnings: Vec::new() };
        if shift > 0 {
            package.warnings.push("has bytes before its package".into());
        }
        let mut total = 0usize;
        for _ in 0..count {
            let cut = || Refusal::new("the directory of its package is damaged");
            if data.u32(at) != Some(0x0201_4b50) {
                return Err(cut());
            }
            let length = |offset: usize| data.u16(at + offset).ok_or_else(cut);
            let (name, extra, comment) = (length(28)?, length(30)?, length(32)?);
            let raw = bytes.get(at + 46..at + 46 + name).ok_or_else(cut)?;
            if let Some(entry) = entry(&data, at, raw, shift, &mut package.warnings)? {
                total = total.saturating_add(entry.packed);
                if package.names.insert(entry.name.clone()) {
                    package.entries.push(entry);
                } else {
                    package.warnings.push(format!(
                        "has `{}` twice in its package; the first is read",
                        crate::readers::folder::shortened(&entry.name)
                    ));
                }
            }
            at += 46 + name + extra + comment;
        }
        if total > bytes.len() {
            return Err("the files of its package lie over each other".into());
        }
        Ok(package)
    }

    /// Returns the layer that stands for the package: its first file.
    ///
    /// # Errors
    ///
    /// When that is no USD layer.
    pub fn root(&self) -> Result<&Entry, Refusal> {
        let junk = |name: &str| {
            name.starts_with("__MACOSX/") || name.split('/').any(|p| p.starts_with("._") || p == ".DS_Store")
        };
        let mut files = self.entries.iter().filter(|e| !e.name.ends_with('/') && !junk(&e.name));
        let first = files.next().ok_or("its package is empty")?;
        if !is_layer(&first.name) {
            let name = crate::readers::folder::shortened(&first.name);
            return Err(format!("the first file of its package, `{name}`, is no USD layer, which it has to be").into());
        }
        Ok(first)
    }

    /// Returns a file by its name.
    pub fn find(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|e| e.name == name)
    }
}

impl Entry {
    /// Returns the content.
    ///
    /// # Errors
    ///
    /// When it is compressed, encrypted or damaged.
    pub fn content<'a>(&self, bytes: &'a [u8]) -> Result<&'a [u8], Refusal> {
        let name = crate::readers::folder::shortened(&self.name);
        if !self.plain {
            return Err(
                format!("`{name}` in its package is compressed or encrypted; USDZ stores files as they are").into()
            );
        }
        let content = self.start.checked_add(self.length).and_then(|end| bytes.get(self.start..end));
        let content = content.ok_or_else(|| format!("`{name}` in its package is longer than the file"))?;
        let mut crc = flate2::Crc::new();
        crc.update(content);
        if crc.sum() != self.crc {
            return Err(format!("`{name}` in its package is damaged: its checksum is wrong").into());
        }
        Ok(content)
    }
}

/// Finds the record at the end, which a comment may follow.
fn end_record(bytes: &[u8]) -> Option<usize> {
    let last = bytes.len().checked_sub(22)?;
    let data = Directory(bytes);
    (last.saturating_sub(65_535)..=last).rev().find(|at| {
        data.u32(*at) == Some(0x0605_4b50) && data.u16(at + 20).is_some_and(|comment| at + 22 + comment == bytes.len())
    })
}

fn entry(
    data: &Directory,
    at: usize,
    raw: &[u8],
    shift: usize,
    warnings: &mut Vec<String>,
) -> Result<Option<Entry>, Refusal> {
    let cut = || Refusal::new("the directory of its package is damaged");
    let (flags, method) = (data.u16(at + 8).ok_or_else(cut)?, data.u16(at + 10).ok_or_else(cut)?);
    let (packed, length) = (data.u32(at + 20).ok_or_else(cut)?, data.u32(at + 24).ok_or_else(cut)?);
    let mode = data.u32(at + 38).ok_or_else(cut)? >> 16;
    let local = data.u32(at + 42).ok_or_else(cut)? as usize + shift;
    let Ok(name) = std::str::from_utf8(raw) else {
        warnings.push("a name in its package is not UTF-8; that file is left out".into());
        return Ok(None);
    };
    let shown = crate::readers::folder::shortened(name);
    if name.contains('\0') || name.len() > 4096 {
        warnings.push(format!("a name in its package cannot be used and its file is left out: `{shown}`"));
        return Ok(None);
    }
    let parts = || name.split(['/', '\\']);
    if parts().any(|p| p == "..") || name.starts_with(['/', '\\']) || name.get(1..2) == Some(":") {
        return Err(format!("`{shown}` in its package leads out of it").into());
    }
    if mode & 0o170_000 == 0o120_000 {
        return Err(format!("`{shown}` in its package is a link, which a package must not have").into());
    }
    // The directory may be right where the file's own header is not, but only the header knows where the content is.
    let start = match (data.u32(local), data.u16(local + 26), data.u16(local + 28)) {
        (Some(0x0403_4b50), Some(name), Some(extra)) => local + 30 + name + extra,
        _ => return Err(format!("`{shown}` in its package is not where its directory says").into()),
    };
    if packed as usize > data.0.len() || method == 0 && length != packed {
        return Err(format!("`{shown}` in its package is longer than the whole file").into());
    }
    if start % 64 != 0 && !name.ends_with('/') && warnings.is_empty() {
        warnings.push("the files of its package do not begin at multiples of 64 bytes".into());
    }
    let plain = method == 0 && flags & 1 == 0 && packed == length;
    let crc = data.u32(at + 16).ok_or_else(cut)?;
    Ok(Some(Entry { name: name.to_owned(), start, length: length as usize, packed: packed as usize, crc, plain }))
}
