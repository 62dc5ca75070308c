//! The one suite that every backend must pass.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

use twox_hash::XxHash3_64;

use super::*;

/// The built-in backends, each with a fresh place for its records.
fn check(case: impl Fn(Backend, &Path)) {
    for backend in Backend::ALL.iter().filter(|b| b.is_built_in()) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        case(*backend, &folder.path().join("records"));
    }
}

fn opened(backend: Backend, path: &Path, mode: Mode) -> Box<dyn KeyValue> {
    match backend.open(path, mode, 8 << 20).expect("records that open") {
        Opened::Ready(records) => records,
        Opened::Busy => panic!("{backend:?} is busy"),
        Opened::NeedsRepair => panic!("{backend:?} needs repair"),
    }
}

fn put(records: &dyn KeyValue, entries: &[(&str, &[u8], &[u8])]) {
    let mut batch = Batch::new();
    for (table, key, value) in entries {
        batch.put(table, *key, *value);
    }
    records.apply(&batch).expect("a batch that is stored");
}

fn all(view: &dyn View, table: &str, range: &KeyRange) -> Vec<(Vec<u8>, Vec<u8>)> {
    let mut found = Vec::new();
    let visit = &mut |key: &[u8], value: &[u8]| {
        found.push((key.to_vec(), value.to_vec()));
        Ok(ControlFlow::Continue(()))
    };
    view.scan(table, range, visit).expect("a scan");
    found
}

fn keys(view: &dyn View, table: &str, range: &KeyRange) -> Vec<Vec<u8>> {
    all(view, table, range).into_iter().map(|(key, _)| key).collect()
}

#[test]
fn what_was_never_written_is_empty() {
    check(|backend, path| {
        let records = opened(backend, path, Mode::Create);
        let view = records.view().unwrap();
        assert_eq!(view.get("rooms", b"a").unwrap(), None);
        assert!(!view.contains("rooms", b"a").unwrap());
        assert!(all(&*view, "rooms", &KeyRange::all()).is_empty());
        assert!(view.tables().unwrap().is_empty());
    });
}

#[test]
fn a_batch_changes_several_tables_and_its_last_word_counts() {
    check(|backend, path| {
        let records = opened(backend, path, Mode::Create);
        put(&*records, &[("a", b"gone", b"1"), ("b", b"kept", b"1"), ("b", b"changed", b"1")]);
        let mut batch = Batch::new();
        batch.delete("a", "gone").delete("a", "never there").put("b", "changed", "2").put("c", "new", "");
        batch.put("c", "twice", "1").delete("c", "twice").delete("b", "back").put("b", "back", "3");
        assert_eq!((batch.len(), batch.is_empty()), (6, false));
        records.apply(&batch).unwrap();
        let view = records.view().unwrap();
        let pairs = |table| {
            let text = |b: Vec<u8>| String::from_utf8(b).unwrap();
            all(&*view, table, &KeyRange::all()).into_iter().map(|(k, v)| (text(k), text(v))).collect::<Vec<_>>()
        };
        let of = |pairs: &[(&str, &str)]| pairs.iter().map(|(k, v)| ((*k).into(), (*v).into())).collect::<Vec<_>>();
        assert_eq!(pairs("a"), of(&[]));
        assert_eq!(pairs("b"), of(&[("back", "3"), ("changed", "2"), ("kept", "1")]));
        assert_eq!(pairs("c"), of(&[("new", "")]));
        assert!(view.contains("c", b"new").unwrap() && !view.contains("c", b"twice").unwrap());
    });
}

#[test]
fn ranges_begin_and_end_where_they_say() {
    check(|backend, path| {
        let records = opened(backend, path, Mode::Create);
        let stored: [&[u8]; 8] = [b"", b"a", b"a\0", b"ab", b"ab\xff", b"ac", b"\xff", b"\xff\xff\x01"];
        put(&*records, &stored.map(|key| ("t", key, &b"v"[..])));
        // Neighbors in the order of names: nothing of theirs may show.
        put(&*records, &[("s", b"ab", b"v"), ("t0", b"ab", b"v"), ("ta", b"ab", b"v")]);
        let view = records.view().unwrap();
        let cases: &[(KeyRange, &[usize])] = &[
            (KeyRange::all(), &[0, 1, 2, 3, 4, 5, 6, 7]),
            (KeyRange::prefix(""), &[0, 1, 2, 3, 4, 5, 6, 7]),
            (KeyRange::prefix("a"), &[1, 2, 3, 4, 5]),
            (KeyRange::prefix("ab"), &[3, 4]),
            (KeyRange::prefix(b"\xff"), &[6, 7]),
            (KeyRange::prefix(b"\xff\xff"), &[7]),
            (KeyRange::prefix("b"), &[]),
            (KeyRange::prefix("a").after("ab"), &[4, 5]),
            (KeyRange::all().from("ab").until("ac"), &[3, 4]),
            (KeyRange::all().until("a"), &[0]),
            (KeyRange::all().after("ac"), &[6, 7]),
            (KeyRange::all().from("b").until("a"), &[]),
            (KeyRange::all().after("a").until("a"), &[]),
            (KeyRange::all().from("a").until("a"), &[]),
        ];
        for (range, expected) in cases {
            let inside: Vec<_> = (0..stored.len()).filter(|i| range.contains(stored[*i])).collect();
            assert_eq!(inside, *expected, "{range:?}");
            let expected: Vec<_> = expected.iter().map(|i| stored[*i].to_vec()).collect();
            assert_eq!(keys(&*view, "t", range), expected, "{backend:?} {range:?}");
        }
        assert_eq!(view.tables().unwrap(), ["s", "t", "t0", "ta"]);
    });
}

#[test]
fn a_scan_ends_when_it_is_told_to_and_hands_errors_on() {
    check(|backend, path| {
        let records = opened(backend, path, Mode::Create);
        put(&*records, &[("t", b"1", b""), ("t", b"2", b""), ("t", b"3", b"")]);
        let view = records.view().unwrap();
        let mut seen = 0;
        let stop = &mut |_: &[u8], _: &[u8]| {
            seen += 1;
            Ok(if seen == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        };
        view.scan("t", &KeyRange::all(), stop).unwrap();
        assert_eq!(seen, 2);
        let refuse = &mut |_: &[u8], _: &[u8]| Err(Error::Cancelled);
        assert!(matches!(view.scan("t", &KeyRange::all(), refuse), Err(Error::Cancelled)));
    });
}

#[test]
fn a_view_does_not_change_while_another_thread_writes() {
    check(|backend, path| {
        let records = opened(backend, path, Mode::Create);
        put(&*records, &[("t", b"a", b"old"), ("t", b"b", b"old")]);
        let view = records.view().unwrap();
        std::thread::scope(|scope| {
            let writer = scope.spawn(|| put(&*records, &[("t", b"a", b"new"), ("t", b"c", b"new")]));
            // The writer may or may not be done in between; the view must not tell.
            for _ in 0..50 {
                assert_eq!(keys(&*view, "t", &KeyRange::all()), [b"a", b"b"]);
                assert_eq!(view.get("t", b"a").unwrap().as_deref(), Some(&b"old"[..]));
                std::thread::yield_now();
            }
            drop(view);
            writer.join().unwrap();
        });
        assert_eq!(keys(&*records.view().unwrap(), "t", &KeyRange::all()), [b"a", b"b", b"c"]);
    });
}

#[test]
fn readers_never_see_half_a_batch() {
    check(|backend, path| {
        let records = opened(backend, path, Mode::Create);
        let write = |n: u32| {
            let n = n.to_le_bytes();
            put(&*records, &[("left", b"n", &n), ("right", b"n", &n), ("right", b"z", &n)]);
        };
        write(0);
        std::thread::scope(|scope| {
            let readers: Vec<_> = (0..3)
                .map(|_| {
                    scope.spawn(|| {
                        let mut last = 0;
                        while last < 40 {
                            let view = records.view().unwrap();
                            let get = |table, key| {
                                let value = view.get(table, key).unwrap().unwrap();
                                u32::from_le_bytes(value.try_into().unwrap())
                            };
                            let seen = [get("left", b"n"), get("right", b"n"), get("right", b"z")];
                            assert_eq!(seen, [seen[0]; 3]);
                            assert!(seen[0] >= last, "time does not run backwards");
                            last = seen[0];
                            drop(view);
                            std::thread::yield_now();
                        }
                    })
                })
                .collect();
            (1..=40).for_each(write);
            readers.into_iter().for_each(|r| r.join().unwrap());
        });
    });
}

#[test]
fn nobody_waits_in_a_circle() {
    check(|backend, path| {
        let records = opened(backend, path, Mode::Create);
        put(&*records, &[("t", b"a", b"old")]);
        let view = records.view().unwrap();
        std::thread::scope(|scope| {
            let writer = scope.spawn(|| put(&*records, &[("t", b"a", b"new")]));
            // Long enough that it waits, where the backend lets it wait.
            std::thread::sleep(std::time::Duration::from_millis(50));
            for _ in 0..200 {
                records.view().unwrap().get("t", b"a").unwrap().unwrap();
            }
            let helper = scope.spawn(|| records.view().unwrap().get("t", b"a").unwrap());
            assert!(helper.join().unwrap().is_some());
            assert_eq!(view.get("t", b"a").unwrap().as_deref(), Some(&b"old"[..]));
            drop(view);
            writer.join().unwrap();
        });
        assert_eq!(records.view().unwrap().get("t", b"a").unwrap().as_deref(), Some(&b"new"[..]));
    });
}

#[test]
fn large_values_and_odd_keys_survive() {
    check(|backend, path| {
        let large: Vec<u8> = (0..crate::records::PAYLOAD_LIMIT).map(|i| (i * 31 % 251) as u8).collect();
        let long_key = vec![7; crate::records::KEY_LIMIT];
        {
            let records = opened(backend, path, Mode::Create);
            put(&*records, &[("t", b"large", &large), ("t", &long_key, b"x"), ("t", b"\0\x01\0", b"\0")]);
        }
        let records = opened(backend, path, Mode::Write);
        let view = records.view().unwrap();
        assert!(view.get("t", b"large").unwrap().as_deref() == Some(&large[..]));
        assert_eq!(view.get("t", &long_key).unwrap().as_deref(), Some(&b"x"[..]));
        assert_eq!(view.get("t", b"\0\x01\0").unwrap().as_deref(), Some(&b"\0"[..]));
    });
}

/// Many random batches against a plain map, with the records closed and opened in between.
#[test]
fn it_behaves_like_a_map() {
    check(|backend, path| {
        let mut expected: BTreeMap<(String, Vec<u8>), Vec<u8>> = BTreeMap::new();
        let mut random = Random(7);
        let mut records = opened(backend, path, Mode::Create);
        for round in 0..60 {
            let mut batch = Batch::new();
            for _ in 0..random.below(40) {
                let table = ["a", "b", "b_c"][random.below(3)];
                let key = format!("{:03}", random.below(120)).into_bytes();
                if random.below(3) == 0 {
                    batch.delete(table, key.clone());
                    expected.remove(&(table.to_owned(), key));
                } else {
                    let value = vec![round as u8; random.below(3000)];
                    batch.put(table, key.clone(), value.clone());
                    expected.insert((table.to_owned(), key), value);
                }
            }
            records.apply(&batch).unwrap();
            if round % 20 == 19 {
                drop(records);
                records = opened(backend, path, Mode::Write);
            }
        }
        let view = records.view().unwrap();
        for table in ["a", "b", "b_c"] {
            let mine = expected.iter().filter(|((t, _), _)| t == table);
            let mine: Vec<_> = mine.map(|((_, key), value)| (key.clone(), value.clone())).collect();
            assert!(all(&*view, table, &KeyRange::all()) == mine, "{backend:?}, table {table}");
        }
        for ((table, key), value) in &expected {
            assert!(view.get(table, key).unwrap().as_ref() == Some(value));
        }
    });
}

/// Numbers that look random and are the same in each run.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 += 1;
        (XxHash3_64::oneshot(&self.0.to_le_bytes()) % limit as u64) as usize
    }
}
