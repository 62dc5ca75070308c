//! Sizes on the disk: what a run may take, and what is free.

use std::path::{Path, PathBuf};

use d3dgen_dataset::Error as DatasetError;

/// Flags that guard the disk.
#[derive(clap::Args, Clone)]
pub struct DiskArgs {
    /// Most that the run may write, as 50GB; it stops there and can go on later
    #[arg(long, value_name = "SIZE", value_parser = parse)]
    quota: Option<u64>,
    /// What must stay free on the disk; the run stops before that
    #[arg(long, value_name = "SIZE", value_parser = parse, default_value = "500MB")]
    keep_free: u64,
}

/// The guard of one run.
pub struct Guard {
    args: DiskArgs,
    folder: PathBuf,
}

impl DiskArgs {
    /// Returns the guard of a run that writes into a folder.
    pub fn guard(&self, folder: &Path) -> Guard {
        Guard { args: self.clone(), folder: folder.to_path_buf() }
    }
}

impl Guard {
    /// Goes on while there is room; `written` is what the run has on the disk.
    ///
    /// # Errors
    /// `Full` with what would help.
    pub fn check(&self, written: u64) -> Result<(), DatasetError> {
        if let Some(quota) = self.args.quota.filter(|quota| written >= *quota) {
            return Err(DatasetError::Full(format!(
                "the run has written {} of its quota of {}; what is done is kept: run it again with a larger --quota",
                size(written),
                size(quota)
            )));
        }
        match free(&self.folder) {
            Some(free) if free < self.args.keep_free => Err(DatasetError::Full(format!(
                "{} has {} free, and {} are to stay so; what is done is kept: free some and run the same command again",
                self.folder.display(),
                size(free),
                size(self.args.keep_free)
            ))),
            _ => Ok(()),
        }
    }
}

/// Returns what is free on the disk of a folder, where the system says so.
#[cfg(target_os = "linux")]
pub fn free(folder: &Path) -> Option<u64> {
    let found = rustix::fs::statvfs(folder).ok()?;
    Some(found.f_bavail * found.f_frsize)
}

/// Returns what is free on the disk of a folder, where the system says so.
#[cfg(not(target_os = "linux"))]
pub fn free(_: &Path) -> Option<u64> {
    None
}

const UNITS: [(&str, u64); 5] =
    [("TB", 1_000_000_000_000), ("GB", 1_000_000_000), ("MB", 1_000_000), ("kB", 1_000), ("B", 1)];

/// Returns a size for people.
pub fn size(bytes: u64) -> String {
    let (unit, factor) = UNITS.iter().find(|(_, factor)| bytes >= *factor).unwrap_or(&("B", 1));
    if *factor == 1 { format!("{bytes} B") } else { format!("{:.1} {unit}", bytes as f64 / *factor as f64) }
}

/// Reads a size as people write it.
pub fn parse(text: &str) -> Result<u64, String> {
    let wrong = || format!("`{text}` is no size; write one as 500MB or 2.5GB");
    let lower = text.trim().to_ascii_lowercase();
    let at = lower.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(lower.len());
    let (number, unit) = lower.split_at(at);
    let number: f64 = number.parse().map_err(|_| wrong())?;
    let unit = if unit.is_empty() { "b" } else { unit.trim() };
    let factor = UNITS.iter().find(|(name, _)| name.eq_ignore_ascii_case(unit)).ok_or_else(wrong)?.1;
    Ok((number * factor as f64) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_written() {
        for (text, bytes) in [("500MB", 500_000_000), ("2.5 gb", 2_500_000_000), ("12", 12), ("0B", 0)] {
            assert_eq!(parse(text), Ok(bytes), "{text}");
        }
        assert!(parse("many").is_err() && parse("5 pounds").is_err() && parse("").is_err());
        assert_eq!((size(999), size(1_500), size(2_000_000)), ("999 B".into(), "1.5 kB".into(), "2.0 MB".into()));
    }
}
