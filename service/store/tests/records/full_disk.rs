//! A write that the system refuses: nothing of the batch is stored, and what was acknowledged stays.
#![cfg(unix)]

use std::process::Command;

use d3dgen_store::{Access, Backend, Batch, Error, Store};

use crate::common::{each, filled, options, part, part_input, patient, payload, verify};

/// Largest file that the part may write, KiB.
const LIMIT_KIB: u64 = 6 * 1024;

fn batch(n: u64) -> Batch {
    let mut batch = Batch::new();
    for i in 0..50 {
        // Not compressible: sled may do so one day.
        let mut random = crate::common::Random(n * 1000 + i);
        let payload: Vec<u8> = (0..2000).map(|_| random.below(256) as u8).collect();
        batch.put("many", format!("{n:06}/{i:02}"), payload);
    }
    batch
}

/// Lifts the limit of this process, as when somebody makes room on a disk. Returns false where the system has no way.
fn make_room() -> bool {
    let pid = std::process::id().to_string();
    let lifted = Command::new("prlimit").args(["--pid", &pid, "--fsize=unlimited:unlimited"]).status();
    lifted.is_ok_and(|status| status.success())
}

/// Stores batches until one is refused.
#[test]
#[ignore = "a part of another test"]
fn writes_until_refused() {
    let input = part_input();
    let (backend, dir) = input.split_once(' ').unwrap();
    let store = Store::open(dir, Access::Write, &options(Backend::from_name(backend).unwrap())).unwrap();
    for n in 1..2000 {
        match store.apply(batch(n)) {
            Ok(_) => println!("\nstored {n}"),
            Err(error) => {
                println!("\nrefused: {error}");
                assert!(backend != "redb" || matches!(error, Error::Full { .. }), "{error}");
                // Reading goes on, and it stays refused, or works, but does not lie.
                if backend == "redb" {
                    assert_eq!(store.get("things", "k0019").unwrap(), Some(payload(19).into_bytes()));
                }
                let mut stored = store.apply(batch(n)).is_ok();
                if make_room() && backend == "redb" {
                    store.check_writable().unwrap();
                    store.apply(batch(n)).unwrap();
                    assert_eq!(store.get("things", "k0019").unwrap(), Some(payload(19).into_bytes()));
                    println!("\nwrites again");
                    stored = true;
                }
                if stored {
                    println!("\nstored {n}");
                }
                return;
            }
        }
    }
}

#[test]
fn a_full_disk_takes_nothing_that_was_acknowledged() {
    each(|backend, dir| {
        filled(dir, backend, 20);
        let before = Store::open(dir, Access::Read, &patient(backend)).unwrap().revision().unwrap();
        let model = part("full_disk::writes_until_refused", &format!("{} {}", backend.name(), dir.display()));
        // A limit for the size of files stands for a full disk; the signal that goes with it is ignored.
        let output = Command::new("sh")
            .args(["-c", &format!("trap '' XFSZ; ulimit -S -f {}; exec \"$0\" \"$@\"", LIMIT_KIB * 2)])
            .arg(model.get_program())
            .args(model.get_args())
            .envs(model.get_envs().filter_map(|(k, v)| Some((k, v?))))
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        let stored =
            said.lines().filter_map(|l| l.strip_prefix("stored ")?.parse::<u64>().ok()).next_back().unwrap_or(0);
        assert!(output.status.success(), "{backend:?}: {said}{}", String::from_utf8_lossy(&output.stderr));
        assert!(said.contains("refused: "), "{backend:?}: {said}{}", String::from_utf8_lossy(&output.stderr));

        let store = Store::open(dir, Access::Write, &patient(backend)).unwrap();
        assert_eq!(verify(&store).unwrap(), []);
        let revision = store.revision().unwrap();
        assert!([before + stored, before + stored + 1].contains(&revision), "{stored} stored, revision {revision}");
        assert_eq!(store.count("many").unwrap(), (revision - before) * 50);
        assert_eq!(store.get("things", "k0019").unwrap(), Some(payload(19).into_bytes()));
        store.apply(batch(revision - before + 1)).unwrap();
    });
}
