//! How fast records are stored, read, verified, saved and restored, with every built-in backend. Prints figures and
//! judges none: `cargo bench -p d3dgen-store --bench records --features sled` takes 100,000 records; run as a test it
//! does everything once with 2,000.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use d3dgen_store::{Access, Backend, Batch, Error, KeyRange, Options, Result, Store, snapshot};

const BATCH: usize = 1000;
const PAYLOAD: usize = 1024;

fn main() -> Result<()> {
    let count = if std::env::args().any(|a| a == "--bench") { 100_000 } else { 2_000 };
    println!("{count} records of {PAYLOAD} bytes, in durable batches of {BATCH}");
    println!("what each batch waits for the disk is in it: a plain write and flush of the same bytes comes first");
    // Beside the build: a temporary folder may be in memory.
    let home = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).map_err(Error::io(env!("CARGO_TARGET_TMPDIR")))?;
    baseline(home.path(), count)?;
    for backend in Backend::ALL.iter().filter(|b| b.is_built_in()) {
        measure(*backend, home.path(), count)?;
    }
    Ok(())
}

fn report(what: &str, count: usize, since: Instant) {
    let seconds = since.elapsed().as_secs_f64();
    println!("{what:<34} {:>10.0} records/s  {seconds:>7.2} s", count as f64 / seconds);
}

fn payload(n: usize) -> Vec<u8> {
    format!("{n:08} at least 1.20 m clear width; ").into_bytes().into_iter().cycle().take(PAYLOAD).collect()
}

fn baseline(home: &Path, count: usize) -> Result<()> {
    use std::io::Write;
    let path = home.join("plain");
    let since = Instant::now();
    let mut file = std::fs::File::create(&path).map_err(Error::io(&path))?;
    for start in (0..count).step_by(BATCH) {
        let bytes: Vec<u8> = (start..start + BATCH).flat_map(payload).collect();
        file.write_all(&bytes).and_then(|()| file.sync_data()).map_err(Error::io(&path))?;
    }
    report("plain file, flushed", count, since);
    Ok(())
}

fn measure(backend: Backend, home: &Path, count: usize) -> Result<()> {
    let name = backend.name();
    let (dir, file) = (home.join(name), home.join(format!("{name}.snapshot")));
    let options = Options { backend, ..Options::default() };
    let store = Store::create(&dir, &options)?;

    let since = Instant::now();
    for start in (0..count).step_by(BATCH) {
        let mut batch = Batch::new();
        for n in start..start + BATCH {
            // As ids come: in no order of their bytes.
            batch.put("constraints", key(n), payload(n));
        }
        store.apply(batch)?;
    }
    report(&format!("{name}: import"), count, since);
    drop(store);

    let since = Instant::now();
    let store = Store::open(&dir, Access::Write, &options)?;
    println!("{:<34} {:>10.1} ms", format!("{name}: open"), since.elapsed().as_secs_f64() * 1000.0);

    let since = Instant::now();
    for n in 0..count {
        assert!(store.get("constraints", &key(n * 7919 % count))?.is_some(), "a record that was stored");
    }
    report(&format!("{name}: get"), count, since);

    let since = Instant::now();
    let mut bytes = 0;
    store.view()?.scan("constraints", &KeyRange::all(), |_, payload| {
        bytes += payload.len();
        Ok::<_, Error>(ControlFlow::Continue(()))
    })?;
    assert_eq!(bytes, count * PAYLOAD);
    report(&format!("{name}: scan"), count, since);

    let go_on = AtomicBool::new(false);
    let since = Instant::now();
    assert!(store.verify(&mut |_| {}, &go_on)?.is_empty());
    report(&format!("{name}: verify"), count, since);

    let since = Instant::now();
    snapshot::write(&store, &file, "a bench", &mut |_| {}, &go_on)?;
    report(&format!("{name}: snapshot"), count, since);

    let since = Instant::now();
    drop(snapshot::restore(&file, home.join(format!("{name}-restored")), &options, &mut |_| {}, &go_on)?);
    report(&format!("{name}: restore"), count, since);
    let size: u64 = files(&dir).iter().filter_map(|p| p.metadata().ok()).map(|m| m.len()).sum();
    println!("{:<34} {:>10.1} MB", format!("{name}: on the disk"), size as f64 / 1e6);
    Ok(())
}

fn key(n: usize) -> String {
    format!("{:08x}/rule-{n}", (n as u32).wrapping_mul(0x9E37_79B9))
}

fn files(dir: &Path) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten().map(|e| e.path());
    entries.flat_map(|p| if p.is_dir() { files(&p) } else { vec![p] }).collect()
}
