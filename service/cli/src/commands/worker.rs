//! `d3dgen worker`: makes worlds of data sets that somebody leads with `dataset make --nats`.

use std::io::{self, BufRead, BufReader, Write};
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use d3dgen_dataset::cluster::{Counters, Worker};

use super::assets::Kept;
use super::dataset::cluster::{QueueArgs, open, runtime};
use crate::database::StoreArgs;
use crate::error::Error;
use crate::interrupt;
use crate::parallel::default_threads;

/// How long a client of the metrics may take.
const PATIENCE: Duration = Duration::from_secs(5);

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Servers of NATS, as nats://a:4222,nats://b:4222
    #[arg(long, value_name = "URL")]
    nats: String,
    /// Store for the results, the leader's --objects: a folder, s3://bucket/prefix or nats://host/bucket
    #[arg(long, value_name = "URL")]
    store: String,
    /// Blocks in hand at once; otherwise one for each core
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// End after this many seconds without a block; otherwise it waits for ever
    #[arg(long, value_name = "SECONDS")]
    idle: Option<u64>,
    /// Address for Prometheus to ask, as 127.0.0.1:9100
    #[arg(long, value_name = "ADDRESS")]
    metrics: Option<String>,
    #[command(flatten)]
    queue: QueueArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        interrupt::listen();
        let kept = Arc::new(Kept::of(&StoreArgs::default())?);
        let counters = Arc::new(Counters::default());
        if let Some(address) = &self.metrics {
            let refused = |e: io::Error| Error::Input(format!("--metrics {address} cannot be used: {e}"));
            let listener = TcpListener::bind(address).map_err(refused)?;
            let counters = Arc::clone(&counters);
            std::thread::spawn(move || tell_metrics(&listener, &counters));
        }
        let hands = self.threads.map_or_else(default_threads, usize::from);
        let runtime = runtime()?;
        let worked = runtime.block_on(async {
            let queue = self.queue.connect(&self.nats).await?;
            let objects = open(&self.store).await?;
            let mut worker = Worker::new(queue, objects, kept, interrupt::flag());
            worker.counters = Arc::clone(&counters);
            worker.idle = self.idle.map(Duration::from_secs);
            Arc::new(worker).work(hands, |what| eprintln!("{what}")).await
        });
        let n = |counter: &std::sync::atomic::AtomicU64| counter.load(Ordering::Relaxed);
        eprintln!(
            "{} blocks, {} worlds, {} tasks without one",
            n(&counters.blocks),
            n(&counters.worlds),
            n(&counters.failed)
        );
        Ok(worked?)
    }
}

/// Answers every request with the counters.
fn tell_metrics(listener: &TcpListener, counters: &Counters) {
    for stream in listener.incoming().flatten() {
        let _ = stream.set_read_timeout(Some(PATIENCE)).and_then(|()| stream.set_write_timeout(Some(PATIENCE)));
        let mut line = String::new();
        let mut reader = BufReader::new(io::Read::take(&stream, 8 << 10));
        while reader.read_line(&mut line).is_ok_and(|n| n > 2) {
            line.clear();
        }
        let text = metrics(counters);
        let head = "HTTP/1.1 200 OK\r\nContent-Type: text/plain; version=0.0.4\r\nConnection: close\r\n";
        let _ = write!(&stream, "{head}Content-Length: {}\r\n\r\n{text}", text.len()); // a client that has gone away
    }
}

/// Returns the counters as Prometheus reads them.
fn metrics(counters: &Counters) -> String {
    let c = counters;
    let rows = [
        ("blocks_total", "counter", "Blocks entered into the ledger by this worker.", &c.blocks),
        ("worlds_total", "counter", "Worlds in them.", &c.worlds),
        ("failed_total", "counter", "Tasks in them that came to no world.", &c.failed),
        ("bytes_total", "counter", "Bytes of them.", &c.bytes),
        ("doubled_total", "counter", "Blocks that another worker had done already.", &c.doubled),
        ("errors_total", "counter", "Blocks given back after an error.", &c.errors),
        ("poisoned_total", "counter", "Blocks set aside.", &c.poisoned),
        ("in_hand", "gauge", "Blocks in hand now.", &c.in_hand),
    ];
    let row = |(name, kind, help, value): (&str, &str, &str, &std::sync::atomic::AtomicU64)| {
        let value = value.load(Ordering::Relaxed);
        let name = format!("d3dgen_worker_{name}");
        format!("# HELP {name} {help}\n# TYPE {name} {kind}\n{name} {value}\n")
    };
    rows.into_iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metrics_have_help_type_and_value() {
        let counters = Counters::default();
        counters.worlds.store(7, Ordering::Relaxed);
        let text = metrics(&counters);
        assert!(text.contains("# TYPE d3dgen_worker_worlds_total counter\nd3dgen_worker_worlds_total 7\n"));
        assert_eq!(text.lines().count(), 24);
    }
}
