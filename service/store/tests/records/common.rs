//! What the tests share: stores with known contents, and processes that play a part.

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use d3dgen_store::{Backend, Batch, Options, Problem, Store};

/// Runs `case` with each built-in backend and a path in a temporary folder, where nothing is yet.
pub fn each(case: impl Fn(Backend, &Path)) {
    for backend in Backend::ALL.iter().filter(|b| b.is_built_in()) {
        let folder = tempfile::tempdir().unwrap();
        case(*backend, &folder.path().join("store"));
    }
}

/// Options that do not wait.
pub fn options(backend: Backend) -> Options {
    Options { backend, wait: Duration::ZERO, ..Options::default() }
}

/// Options that wait longer than any other process needs.
pub fn patient(backend: Backend) -> Options {
    Options { wait: Duration::from_secs(30), ..options(backend) }
}

/// The payload of a record of [`filled`].
pub fn payload(n: usize) -> String {
    format!("payload-of-record-{n:04}-").repeat(10 + n % 30)
}

/// Makes a store with `count` records `k0000`... in table `things`, in batches of 50, and closes it.
pub fn filled(dir: &Path, backend: Backend, count: usize) {
    let store = Store::create(dir, &options(backend)).unwrap();
    for start in (0..count).step_by(50) {
        let mut batch = Batch::new();
        for n in start..count.min(start + 50) {
            batch.put("things", format!("k{n:04}"), payload(n));
        }
        store.apply(batch).unwrap();
    }
}

pub fn verify(store: &Store) -> d3dgen_store::Result<Vec<Problem>> {
    store.verify(&mut |_| {}, &AtomicBool::new(false))
}

/// A command that runs the ignored test `part` of this binary in a process of its own, with `input` as its standard
/// input's place: `D3DGEN_PART`.
pub fn part(part: &str, input: &str) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", part, "--ignored", "--nocapture", "--test-threads", "1"]);
    command.env("D3DGEN_PART", input).stdin(Stdio::piped()).stdout(Stdio::piped());
    command
}

/// What a part was given; fails when the test was not started by [`part`].
pub fn part_input() -> String {
    std::env::var("D3DGEN_PART").expect("this is a part of another test, which starts it")
}

/// Numbers that look random and are the same in each run.
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, limit: u64) -> u64 {
        // splitmix64
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % limit
    }
}
