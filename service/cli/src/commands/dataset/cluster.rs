//! The flags of runs on many machines, and the leader of one.

use std::path::PathBuf;
use std::time::Duration;

use d3dgen_dataset::Error as DatasetError;
use d3dgen_dataset::cluster::{Leader, Objects, Queue, QueueSettings, Standing};
use d3dgen_dataset::part::{Done, Part};

use super::Runs;
use crate::error::Error;
use crate::interrupt;

/// Flags of a leader.
#[derive(clap::Args)]
pub struct LeaderArgs {
    /// Have the worlds made by workers: servers of NATS, as nats://a:4222,nats://b:4222
    #[arg(long, value_name = "URL", requires = "objects")]
    nats: Option<String>,
    /// Store that workers lay results into: a folder, s3://bucket/prefix or nats://host/bucket
    #[arg(long, value_name = "URL", requires = "nats")]
    objects: Option<String>,
    /// Turns that workers give this run for each turn of a run of priority 1
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=10))]
    priority: u8,
    #[command(flatten)]
    queue: QueueArgs,
}

/// Flags of everybody who uses the queue.
#[derive(clap::Args, Clone)]
pub struct QueueArgs {
    /// File with the credentials for NATS
    #[arg(long, value_name = "FILE")]
    nats_creds: Option<PathBuf>,
    /// Copies of the queue: 3 in a cluster of NATS
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=5))]
    nats_replicas: u8,
    /// Seconds that a block is a worker's own without a sign of life
    #[arg(long, value_name = "SECONDS", default_value_t = 20, value_parser = clap::value_parser!(u16).range(2..=3600))]
    lease: u16,
}

impl QueueArgs {
    /// Returns how the queue treats those who take from it.
    pub fn settings(&self) -> QueueSettings {
        let (replicas, lease) = (self.nats_replicas.into(), Duration::from_secs(self.lease.into()));
        QueueSettings { replicas, lease, ..QueueSettings::default() }
    }

    /// Connects to the queue.
    pub async fn connect(&self, urls: &str) -> Result<Queue, DatasetError> {
        Queue::connect(urls, self.nats_creds.as_deref(), self.settings()).await
    }
}

/// Opens a store; S3 is told by the usual AWS_ variables what the URL does not say.
pub async fn open(url: &str) -> Result<Objects, DatasetError> {
    let named = std::env::vars().filter(|(name, _)| name.starts_with("AWS_"));
    let options: Vec<(String, String)> = named.map(|(name, value)| (name.to_ascii_lowercase(), value)).collect();
    Objects::open(url, &options).await
}

/// Starts what runs connections.
pub fn runtime() -> Result<tokio::runtime::Runtime, Error> {
    // one provider for all: S3 is spoken to over the TLS that the rest of the program uses
    let _ = rustls::crypto::ring::default_provider().install_default();
    let built = tokio::runtime::Builder::new_multi_thread().enable_all().build();
    built.map_err(|e| Error::Input(format!("cannot start the network: {e}")))
}

/// A run that workers make.
pub struct Asked<'a> {
    args: &'a LeaderArgs,
    nats: &'a str,
    objects: &'a str,
}

impl LeaderArgs {
    /// Returns who leads; none where the worlds are made here.
    pub fn asked(&self) -> Result<Option<Asked<'_>>, Error> {
        Ok(self.nats.as_deref().zip(self.objects.as_deref()).map(|(nats, objects)| Asked { args: self, nats, objects }))
    }
}

impl Asked<'_> {
    /// Leads until every block is at home; `guard` is asked with what is written here.
    pub fn lead(&self, part: &Part, guard: &(dyn Fn(u64) -> Result<(), DatasetError> + Sync)) -> Result<(), Error> {
        interrupt::listen();
        let runtime = runtime()?;
        let runs = Runs::of(part);
        let news = |done: Option<&Done>, standing: &Standing| {
            runs.go_on()?;
            let Standing { waiting, in_hand, again, .. } = standing;
            runs.moved(done, &format!("; {waiting} blocks wait, {in_hand} in hand, {again} put in again"))?;
            guard(runs.bytes())
        };
        let led = runtime.block_on(async {
            let queue = self.args.queue.connect(self.nats).await?;
            let objects = open(self.objects).await?;
            let leader = Leader { part, queue, objects, priority: self.args.priority };
            leader.lead(interrupt::flag(), &news).await
        });
        runs.talk.progress.finish();
        Ok(led?)
    }
}
