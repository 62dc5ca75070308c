//! How long it takes to make the reader, to read a prompt of 40 words (at most 3 ms) and one of 10 kB (at most 100 ms).
//!
//! `cargo bench -p d3dgen-prompt` measures; run as a test, it reads each once.

use std::hint::black_box;
use std::time::{Duration, Instant};

use d3dgen_plugins::Registry;
use d3dgen_prompt::PromptReader;

const FORTY_WORDS: &str = "Outpatient clinic in Hamburg on two floors with a reception, a waiting area for thirty people, six consulting \
    rooms next to the lab, two treatment rooms, a staff room, accessible toilets and a delivery robot that brings samples from \
    every room";
const LONG_BYTES: usize = 10_000;
const TIMES: usize = 31;

fn main() {
    let times = if std::env::args().any(|a| a == "--bench") { TIMES } else { 1 };
    let registry = Registry::builtin();
    for plugin in registry.iter() {
        black_box(plugin.domain());
    }
    let begun = Instant::now();
    let reader = PromptReader::new(&registry);
    show("the reader is made", begun.elapsed(), None);
    let long = [FORTY_WORDS, ". "].concat().repeat(1 + LONG_BYTES / FORTY_WORDS.len());
    for (what, text, most_ms) in [("40 words", FORTY_WORDS, 3.0), ("10 kB", &long[..LONG_BYTES], 100.0)] {
        let mut laps: Vec<Duration> = (0..times).map(|_| lap(&reader, text)).collect();
        laps.sort();
        show(what, laps[times / 2], Some(most_ms));
    }
}

fn lap(reader: &PromptReader, text: &str) -> Duration {
    let begun = Instant::now();
    black_box(reader.read(black_box(text)));
    begun.elapsed()
}

fn show(what: &str, time: Duration, most_ms: Option<f64>) {
    let ms = 1000.0 * time.as_secs_f64();
    let target = most_ms
        .map_or(String::new(), |most| format!(", at most {most} ms: {}", if ms <= most { "kept" } else { "MISSED" }));
    println!("{what:20} {ms:8.2} ms{target}");
}
