//! One writer, many readers, each in a process of its own.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::Child;

use d3dgen_store::{Access, Backend, Batch, Error, Store};

use crate::common::{each, filled, options, part, part_input, patient, verify};

/// Opens the store for writing, says so, and then does what it is told, line by line.
#[test]
#[ignore = "a part of another test"]
fn writes_on_demand() {
    let store = Store::open(part_input(), Access::Write, &options(Backend::Redb)).unwrap();
    println!("\nopen");
    for line in std::io::stdin().lines() {
        for _ in 0..line.unwrap().parse::<usize>().unwrap() {
            let n = (store.revision().unwrap() + 1).to_string();
            let mut batch = Batch::new();
            for i in 0..20 {
                batch.put("left", format!("k{i}"), n.clone()).put("right", format!("k{i}"), n.clone());
            }
            store.apply(batch).unwrap();
        }
        println!("done");
    }
}

struct Writer {
    child: Child,
    said: BufReader<std::process::ChildStdout>,
}

impl Writer {
    fn start(dir: &Path) -> Self {
        let mut child = part("processes::writes_on_demand", &dir.display().to_string()).spawn().unwrap();
        let said = BufReader::new(child.stdout.take().unwrap());
        let mut writer = Self { child, said };
        writer.wait_for("open");
        writer
    }

    fn tell(&mut self, batches: usize) {
        writeln!(self.child.stdin.as_mut().unwrap(), "{batches}").unwrap();
    }

    fn wait_for(&mut self, word: &str) {
        let mut line = String::new();
        while line.trim() != word {
            line.clear();
            assert!(self.said.read_line(&mut line).unwrap() > 0, "the writer ended before it said {word}");
        }
    }

    fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

#[test]
fn a_second_writer_is_told_who_writes_and_what_to_do() {
    each(|backend, dir| {
        filled(dir, backend, 10);
        let writer = Writer::start(dir);
        let error = Store::open(dir, Access::Write, &options(backend)).err().unwrap();
        assert!(matches!(&error, Error::InUse { pid: Some(pid), .. } if *pid == writer.child.id()), "{error}");
        let said = error.to_string();
        for words in [dir.to_str().unwrap(), &format!("process {}", writer.child.id()), "wait"] {
            assert!(said.contains(words), "{said}");
        }
        assert_eq!(said.contains("open the store for reading"), backend == Backend::Redb, "{said}");
        writer.kill();
        // The system lets go of a dead process's lock.
        Store::open(dir, Access::Write, &patient(backend)).unwrap();
    });
}

#[test]
fn readers_follow_a_writer_of_another_process_and_never_see_half_a_batch() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("store");
    filled(&dir, Backend::Redb, 10);
    let mut writer = Writer::start(&dir);
    let readers: Vec<_> = (0..2).map(|_| Store::open(&dir, Access::Read, &options(Backend::Redb)).unwrap()).collect();
    let first = readers[0].revision().unwrap();
    writer.tell(60);
    let mut last = first;
    while last < first + 60 {
        for reader in &readers {
            let view = reader.view().unwrap();
            let revision = view.revision().unwrap();
            assert!(revision >= last, "time does not run backwards");
            last = revision;
            let expected = (revision > first).then(|| revision.to_string().into_bytes());
            for i in [0, 19] {
                assert_eq!(view.get("left", &format!("k{i}")).unwrap(), expected);
                assert_eq!(view.get("right", &format!("k{i}")).unwrap(), expected);
            }
        }
    }
    writer.wait_for("done");
    writer.kill();

    // A reader that was open when the writer died goes on, a new one repairs first, and both follow the next writer.
    assert_eq!(readers[0].revision().unwrap(), first + 60);
    let late = Store::open(&dir, Access::Read, &patient(Backend::Redb)).unwrap();
    let mut writer = Writer::start(&dir);
    writer.tell(5);
    writer.wait_for("done");
    for reader in [&readers[0], &readers[1], &late] {
        assert_eq!(reader.revision().unwrap(), first + 65);
        assert_eq!(verify(reader).unwrap(), []);
        assert_eq!(reader.get("things", "k0003").unwrap(), Some(crate::common::payload(3).into_bytes()));
    }
    writer.kill();
}

#[cfg(feature = "sled")]
#[test]
fn a_reader_of_sled_waits_for_the_writer_and_then_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("store");
    filled(&dir, Backend::Sled, 10);
    let writer = Writer::start(&dir);
    let error = Store::open(&dir, Access::Read, &options(Backend::Sled)).err().unwrap();
    assert!(matches!(error, Error::InUse { pid: Some(_), shared: false, .. }), "{error}");
    let waiting = {
        let dir = dir.clone();
        std::thread::spawn(move || Store::open(dir, Access::Read, &patient(Backend::Sled)).map(|s| s.revision()))
    };
    std::thread::sleep(std::time::Duration::from_millis(100));
    writer.kill();
    assert_eq!(waiting.join().unwrap().unwrap().unwrap(), 1);
}
