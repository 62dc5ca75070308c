//! Folders: which become stores, which are refused, and what the refusal says.

use std::fs;
use std::path::Path;

use d3dgen_store::{Access, Backend, Batch, Error, FORMAT, KeyRange, Store};

use crate::common::{each, filled, options, patient, payload, verify};

/// Everything in a folder, with its bytes.
fn contents(dir: &Path) -> Vec<(String, Vec<u8>)> {
    let Ok(entries) = fs::read_dir(dir) else { return Vec::new() };
    let mut found: Vec<_> = entries
        .map(|e| e.unwrap().path())
        .map(|p| (p.display().to_string(), if p.is_file() { fs::read(&p).unwrap() } else { Vec::new() }))
        .collect();
    found.sort();
    found
}

#[test]
fn a_store_is_made_once_and_keeps_what_it_is_given() {
    each(|backend, dir| {
        assert!(matches!(Store::open(dir, Access::Write, &options(backend)), Err(Error::NotFound { .. })));
        assert!(!dir.exists(), "to look for a store leaves nothing behind");
        let store = Store::open_or_create(dir, &options(backend)).unwrap();
        assert_eq!((store.revision().unwrap(), store.backend(), store.access()), (0, backend, Access::Write));
        let mut batch = Batch::new();
        batch.put("a", "x", "1").put("a", "y", "2").put("b", "x", "3");
        assert_eq!(store.apply(batch).unwrap(), 1);
        let mut batch = Batch::new();
        batch.put("a", "x", "new").delete("a", "y").delete("b", "none");
        assert_eq!(store.clone().apply(batch).unwrap(), 2);
        assert_eq!(store.apply(Batch::new()).unwrap(), 2, "nothing to store, nothing changed");
        drop(store);

        assert!(matches!(Store::create(dir, &options(backend)), Err(Error::Exists { .. })));
        for access in [Access::Read, Access::Write] {
            let store = Store::open(dir, access, &patient(Backend::Redb)).unwrap();
            assert_eq!(store.backend(), backend, "a store knows its backend");
            assert_eq!(store.get("a", "x").unwrap().as_deref(), Some(&b"new"[..]));
            assert_eq!((store.get("a", "y").unwrap(), store.get("never", "x").unwrap()), (None, None));
            let counts = ["a", "b", "never"].map(|t| store.count(t).unwrap());
            assert_eq!((counts, store.revision().unwrap()), ([1, 1, 0], 2));
            assert_eq!(store.view().unwrap().tables().unwrap(), ["a", "b"]);
            assert_eq!(verify(&store).unwrap(), []);
        }
    });
}

#[test]
fn an_empty_folder_becomes_a_store_wherever_it_is() {
    each(|backend, dir| {
        let dir = dir.join("with spaces").join("größe 部屋 🏥");
        fs::create_dir_all(&dir).unwrap();
        filled(&dir, backend, 3);
        let store = Store::open(&dir, Access::Read, &options(backend)).unwrap();
        assert_eq!(store.get("things", "k0002").unwrap(), Some(payload(2).into_bytes()));
        assert!(store.index_dir().starts_with(&dir));
    });
}

#[test]
fn what_is_no_store_is_refused_and_left_alone() {
    // What store.json is replaced by, if at all, and words of the refusal.
    let cases: &[(Option<&str>, &[&str])] = &[
        (None, &["store.json is missing", "snapshot"]),
        (Some("{\"format\": 2, \"backend"), &["store.json cannot be read", "snapshot"]),
        (Some("[]"), &["store.json cannot be read"]),
        (Some("{\"format\": 99, \"written_by\": \"d3dgen 7.0\"}"), &["format 99", "up to 2", "d3dgen 7.0"]),
        (Some("{\"format\": 0}"), &["never been a format 0"]),
        (
            Some(r#"{"format":2,"backend":"redb","records":"../records","written_by":"","complete":true}"#),
            &["no name of records"],
        ),
        (
            Some(r#"{"format":2,"backend":"rocks","records":"records-2.rocks","written_by":"","complete":true}"#),
            &["backend rocks"],
        ),
        (
            Some(r#"{"format":2,"backend":"redb","records":"records-2.redb","written_by":"","complete":false}"#),
            &["interrupted", "make it again"],
        ),
    ];
    for (text, words) in cases {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("store");
        filled(&dir, Backend::Redb, 3);
        match text {
            Some(text) => fs::write(dir.join("store.json"), text).unwrap(),
            None => fs::remove_file(dir.join("store.json")).unwrap(),
        }
        let before = contents(&dir);
        for access in [Access::Read, Access::Write] {
            let said = Store::open(&dir, access, &options(Backend::Redb)).err().unwrap().to_string();
            for word in *words {
                assert!(said.contains(word), "{said}: lacks {word}");
            }
        }
        let names = |c: &[(String, Vec<u8>)]| c.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&contents(&dir)), names(&before));
    }
}

#[test]
fn a_foreign_folder_is_refused_and_left_alone() {
    each(|backend, dir| {
        fs::create_dir_all(dir).unwrap();
        fs::write(dir.join("thesis.tex"), "x").unwrap();
        let before = contents(dir);
        assert!(matches!(Store::open(dir, Access::Write, &options(backend)), Err(Error::NotFound { .. })));
        assert!(matches!(Store::open(dir, Access::Read, &options(backend)), Err(Error::NotFound { .. })));
        assert!(matches!(Store::create(dir, &options(backend)), Err(Error::Exists { .. })));
        let made = Store::open_or_create(dir, &options(backend));
        assert!(made.is_err(), "no store is made between other files");
        let file = dir.join("thesis.tex");
        assert!(Store::open(&file, Access::Read, &options(backend)).is_err());
        assert!(Store::create(&file, &options(backend)).is_err());
        assert_eq!(contents(dir), before);
    });
}

#[test]
fn a_store_that_was_never_finished_is_made_again() {
    each(|backend, dir| {
        fs::create_dir_all(dir).unwrap();
        let name = backend.name();
        let text = format!(
            r#"{{"format":{FORMAT},"backend":"{name}","records":"records-{FORMAT}.{name}","written_by":"","complete":false}}"#
        );
        fs::write(dir.join("store.json"), text).unwrap();
        fs::write(dir.join(format!("records-{FORMAT}.{name}")), "rubbish").unwrap();
        fs::write(dir.join(".unfinished-1234"), "rubbish").unwrap();
        let store = Store::open_or_create(dir, &options(backend)).unwrap();
        assert_eq!((store.revision().unwrap(), verify(&store).unwrap()), (0, vec![]));
        assert!(!dir.join(".unfinished-1234").exists());
    });
}

#[test]
fn handles_of_one_process_exclude_each_other_as_processes_do() {
    each(|backend, dir| {
        let store = Store::create(dir, &options(backend)).unwrap();
        let second = Store::open(dir, Access::Write, &options(backend)).err().unwrap();
        assert!(matches!(second, Error::InUse { pid: Some(pid), .. } if pid == std::process::id()), "{second}");
        let reader = Store::open(dir, Access::Read, &options(backend));
        assert_eq!(reader.is_ok(), backend == Backend::Redb);
        let clone = store.clone();
        drop((store, reader));
        assert!(Store::open(dir, Access::Write, &options(backend)).is_err(), "a clone holds the store");
        drop(clone);
        Store::open(dir, Access::Write, &patient(backend)).unwrap();
    });
}

#[test]
fn changes_that_cannot_be_made_change_nothing() {
    each(|backend, dir| {
        filled(dir, backend, 3);
        let store = Store::open(dir, Access::Write, &patient(backend)).unwrap();
        let before = store.revision().unwrap();
        let long = "k".repeat(1025);
        let cases: &[(&str, &[u8], usize)] = &[
            ("", b"k", 1),
            ("Things", b"k", 1),
            ("_store", b"revision", 1),
            ("a/b", b"k", 1),
            ("9", b"k", 1),
            ("t", b"", 1),
            ("t", long.as_bytes(), 1),
            ("t", b"\xff", 1),
            ("t", b"k", (16 << 20) + 1),
        ];
        for (table, key, size) in cases {
            let mut batch = Batch::new();
            batch.put("things", "k9999", "x").put(table, *key, vec![0; *size]);
            assert!(matches!(store.apply(batch), Err(Error::Limit { .. })), "{table} {size}");
        }
        let view = store.view().unwrap();
        let mut batch = Batch::new();
        batch.put("things", "k9999", "x");
        assert!(matches!(store.apply(batch.clone()), Err(Error::StillReading { .. })));
        assert_eq!(view.get("things", "k9999").unwrap(), None);
        drop(view);
        assert!(matches!(store.view().unwrap().get("No table", "k"), Err(Error::Limit { .. })));
        assert_eq!((store.revision().unwrap(), store.count("things").unwrap()), (before, 3));
        drop(store);
        let reader = Store::open(dir, Access::Read, &patient(backend)).unwrap();
        assert!(matches!(reader.apply(batch), Err(Error::ReadOnly { .. })));
    });
}

#[test]
fn iterators_read_page_by_page_what_a_scan_reads_at_once() {
    each(|backend, dir| {
        filled(dir, backend, 700);
        let store = Store::open(dir, Access::Read, &patient(backend)).unwrap();
        let view = store.view().unwrap();
        for (range, expected) in [
            (KeyRange::all(), 0..700),
            (KeyRange::prefix("k01"), 100..200),
            (KeyRange::all().after("k0255").until("k0600"), 256..600),
            (KeyRange::prefix("none"), 0..0),
        ] {
            let found: Vec<_> = view.records("things", range.clone()).map(Result::unwrap).collect();
            let expected: Vec<_> = expected.map(|n| (format!("k{n:04}"), payload(n).into_bytes())).collect();
            assert!(found == expected, "{backend:?} {range:?}");
            let mut scanned = Vec::new();
            let visit = |key: &str, payload: &[u8]| {
                scanned.push((key.to_owned(), payload.to_vec()));
                Ok::<_, Error>(std::ops::ControlFlow::Continue(()))
            };
            view.scan("things", &range, visit).unwrap();
            assert!(scanned == expected);
        }
    });
}

#[cfg(unix)]
mod read_only {
    //! A folder that may be read and not written, as a user who is not root meets it.

    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    use std::os::unix::process::CommandExt;

    use super::*;
    use crate::common::{part, part_input};

    /// Nobody, on most systems; any number that is not ours and not root's will do.
    const STRANGER: u32 = 65534;

    #[test]
    #[ignore = "a part of another test"]
    fn reads_without_permission_to_write() {
        let input = part_input();
        let (backend, dir) = input.split_once(' ').unwrap();
        let backend = Backend::from_name(backend).unwrap();
        assert!(fs::write(Path::new(dir).join("probe"), "").is_err(), "the folder can be written to");
        match Store::open(dir, Access::Read, &options(backend)) {
            Ok(store) => {
                assert_eq!(store.get("things", "k0001").unwrap(), Some(payload(1).into_bytes()));
                assert_eq!(verify(&store).unwrap(), []);
                println!("\nread");
            }
            Err(error) => println!("\n{error}"),
        }
        let error = Store::open(dir, Access::Write, &options(backend)).err().unwrap();
        assert!(
            matches!(&error, Error::Io { source, .. }
            if source.kind() == std::io::ErrorKind::PermissionDenied),
            "{error}"
        );
    }

    /// Runs the part as a user who owns nothing in the folder, and returns what it says.
    fn as_stranger(backend: Backend, dir: &Path, home: &Path) -> String {
        // Whoever that is may not look into our build folder.
        let program = home.join("program");
        fs::copy(std::env::current_exe().unwrap(), &program).unwrap();
        let model = part(
            "open::read_only::reads_without_permission_to_write",
            &format!("{} {}", backend.name(), dir.display()),
        );
        let mut command = std::process::Command::new(&program);
        command.args(model.get_args()).envs(model.get_envs().filter_map(|(k, v)| Some((k, v?)))).current_dir("/");
        if fs::metadata(home).unwrap().uid() == 0 {
            command.uid(STRANGER).gid(STRANGER);
        }
        // A process that another test started meanwhile holds the copy open until it runs its own program.
        let output = loop {
            match command.output() {
                Err(e) if e.kind() == std::io::ErrorKind::ExecutableFileBusy => {
                    std::thread::sleep(std::time::Duration::from_millis(5));
                }
                output => break output.unwrap(),
            }
        };
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
        said
    }

    fn set_mode(path: &Path, mode: u32) {
        fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    }

    #[test]
    fn a_folder_that_may_only_be_read_is_read_where_the_backend_can() {
        each(|backend, dir| {
            filled(dir, backend, 3);
            let home = dir.parent().unwrap();
            set_mode(home, 0o755);
            for entry in fs::read_dir(dir).unwrap() {
                let path = entry.unwrap().path();
                set_mode(&path, if path.is_dir() { 0o555 } else { 0o444 });
            }
            set_mode(dir, 0o555);
            let said = as_stranger(backend, dir, home);
            match backend {
                Backend::Redb => assert!(said.contains("\nread"), "{said}"),
                Backend::Sled => assert!(said.contains("write permission"), "{said}"),
            }
            set_mode(dir, 0o755);
        });
    }
}
