//! Names and paths that clients send: plain, or refused with their field.

use std::path::{Component, Path, PathBuf};

use tonic::Status;

use crate::status::invalid;

/// Longest name, bytes.
const NAME_LIMIT: usize = 128;
/// Longest relative path of an uploaded file, bytes.
const PATH_LIMIT: usize = 512;
/// Longest part of one, bytes.
const PART_LIMIT: usize = 200;

/// Checks an id of lower-case words: a letter, then letters, digits and underscores.
///
/// # Errors
/// `INVALID_ARGUMENT` with the field.
pub fn id<'a>(field: &str, text: &'a str) -> Result<&'a str, Status> {
    let plain = text.bytes().all(|b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'_'));
    let begins = text.bytes().next().is_some_and(|b| b.is_ascii_lowercase());
    match plain && begins && text.len() <= NAME_LIMIT {
        true => Ok(text),
        false => Err(invalid(field, format!("{} is no id: needs a-z, 0-9 and _, a letter first", quoted(text)))),
    }
}

/// Checks a name of something stored: letters, digits and `._-/` without empty parts and parts of dots.
///
/// # Errors
/// `INVALID_ARGUMENT` with the field.
pub fn reference<'a>(field: &str, text: &'a str) -> Result<&'a str, Status> {
    let plain = |part: &str| {
        !part.is_empty()
            && part.bytes().any(|b| b != b'.')
            && part.chars().all(|c| c.is_alphanumeric() || "._-+() ".contains(c))
    };
    match text.len() <= NAME_LIMIT * 2 && text.split('/').all(plain) {
        true => Ok(text),
        false => Err(invalid(field, format!("{} is no name of anything stored", quoted(text)))),
    }
}

/// Checks that a relative path stays in its folder.
///
/// # Errors
/// `INVALID_ARGUMENT` with the field.
pub fn inside(field: &str, text: &str) -> Result<(), Status> {
    let leads_out = |part: &str| part.bytes().all(|b| b == b'.'); // an empty part too
    match text.split(['/', '\\']).any(leads_out) || Path::new(text).is_absolute() {
        true => Err(invalid(
            field,
            format!("{}: a path stays in its folder: no empty parts, no `.` and no `..`", quoted(text)),
        )),
        false => Ok(()),
    }
}

/// Returns the relative path of an uploaded file.
///
/// # Errors
/// `INVALID_ARGUMENT` with the field, for paths that lead out of their folder or that not every system can hold.
pub fn upload_path(field: &str, text: &str) -> Result<PathBuf, Status> {
    let refused = |why: &str| invalid(field, format!("{}: {why}", quoted(text)));
    if text.is_empty() || text.len() > PATH_LIMIT {
        return Err(refused("a path has 1 to 512 bytes"));
    }
    inside(field, text)?;
    if text.chars().any(|c| c.is_control() || "\\:*?\"<>|".contains(c)) {
        return Err(refused("a path is written with / between its parts and without control characters"));
    }
    let parts: Vec<&str> = text.split('/').collect();
    if parts.iter().any(|p| p.len() > PART_LIMIT) {
        return Err(refused("a part of a path has at most 200 bytes"));
    }
    Ok(parts.iter().collect())
}

/// Returns a folder or file of the server's machine when it lies under one of the roots that the configuration names, with
/// all links followed.
///
/// # Errors
/// `PERMISSION_DENIED` for anything else, whether it exists or not.
pub fn under_roots(field: &str, text: &str, roots: &[PathBuf]) -> Result<PathBuf, Status> {
    let refused = || {
        Status::permission_denied(format!(
            "{field}: the server reads only below the folders that its configuration names as read_roots; upload the \
             files instead"
        ))
    };
    let path = Path::new(text);
    let climbs = path.components().any(|c| matches!(c, Component::ParentDir));
    if text.contains('\0') || !path.is_absolute() || climbs {
        return Err(refused());
    }
    let real = path.canonicalize().map_err(|_| refused())?;
    let inside = roots.iter().filter_map(|root| root.canonicalize().ok()).any(|root| real.starts_with(root));
    if inside { Ok(real) } else { Err(refused()) }
}

fn quoted(text: &str) -> String {
    let short: String = text.chars().take(60).collect();
    format!("{short:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const ESCAPES: [&str; 12] =
        ["../x", "a/../../x", "/etc/passwd", "a//b", "./a", "a/.", "..", ".", "", "a\0b", "..\\x", "C:\\x"];

    #[test]
    fn nothing_leads_out_of_its_folder() {
        for text in ESCAPES {
            assert!(id("f", text).is_err(), "{text:?}");
            assert!(upload_path("f", text).is_err(), "{text:?}");
            assert!(reference("f", text).is_err(), "{text:?}");
        }
        assert_eq!(id("f", "school_2").unwrap(), "school_2");
        assert_eq!(upload_path("f", "a b/c.usdz").unwrap(), PathBuf::from("a b/c.usdz"));
        assert_eq!(reference("f", "Hospital/HospitalBed").unwrap(), "Hospital/HospitalBed");
    }

    #[test]
    fn folders_are_read_under_the_roots_only() {
        let dir = tempfile::tempdir().unwrap();
        let (root, outside) = (dir.path().join("root"), dir.path().join("outside"));
        std::fs::create_dir_all(root.join("models")).unwrap();
        std::fs::create_dir_all(&outside).unwrap();
        let roots = [root.clone()];
        let read = |path: &Path| under_roots("folder", &path.display().to_string(), &roots);
        assert!(read(&root.join("models")).is_ok());
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&outside, root.join("link")).unwrap();
            assert!(read(&root.join("link")).is_err());
        }
        for wrong in [outside.clone(), root.join("models/../../outside"), root.join("none"), PathBuf::from("models")] {
            let refused = read(&wrong).expect_err("outside");
            assert_eq!(refused.code(), tonic::Code::PermissionDenied, "{}", wrong.display());
        }
        assert!(under_roots("folder", &root.display().to_string(), &[]).is_err());
    }
}
