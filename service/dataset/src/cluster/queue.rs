//! The queue: one stream of NATS JetStream, a subject and a consumer for each run. It holds numbers of blocks and nothing else.

use std::time::Duration;

use async_nats::jetstream::consumer::{AckPolicy, PullConsumer, pull};
use async_nats::jetstream::message::PublishMessage;
use async_nats::jetstream::stream::{Config, RetentionPolicy, Stream};
use async_nats::jetstream::{self, Context, Message};
use futures_util::{StreamExt, TryStreamExt};
use serde::{Deserialize, Serialize};

use super::failed;
use crate::error::Error;

/// Name of the stream.
const STREAM: &str = "D3DGEN";
/// Before the run in a subject.
const SUBJECT: &str = "d3dgen.blocks";
/// How long the queue takes the same block for one.
const SAME: Duration = Duration::from_secs(120);
/// How long a fetch waits for a block.
const WAIT: Duration = Duration::from_secs(1);

/// How a queue treats those who take from it.
#[derive(Debug, Clone, Copy)]
pub struct QueueSettings {
    /// Copies of the stream: 1, or 3 in a cluster.
    pub replicas: usize,
    /// How long a block is a worker's own without a sign of life.
    pub lease: Duration,
    /// How often a block is given to somebody before it is set aside.
    pub deliveries: u32,
    /// Blocks that workers hold at once, all together.
    pub in_hand: u32,
}

impl Default for QueueSettings {
    fn default() -> Self {
        Self { replicas: 1, lease: Duration::from_secs(20), deliveries: 8, in_hand: 1024 }
    }
}

/// A connection to the queue.
#[derive(Clone)]
pub struct Queue {
    context: Context,
    settings: QueueSettings,
}

/// The number of a block of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ticket {
    /// The run.
    pub run: String,
    /// The block.
    pub block: u64,
}

/// How many blocks of a run the queue knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Queued {
    /// Not given to anybody yet.
    pub waiting: u64,
    /// In the hands of workers.
    pub in_hand: u64,
}

impl Queue {
    /// Connects to servers, with commas between their URLs; one that is not there yet is waited for.
    ///
    /// # Errors
    /// `Input` for what is no URL; `Cluster`.
    pub async fn connect(
        urls: &str,
        credentials: Option<&std::path::Path>,
        settings: QueueSettings,
    ) -> Result<Self, Error> {
        let refused = failed("the queue");
        let servers: Result<Vec<async_nats::ServerAddr>, _> = urls.split(',').map(|u| u.trim().parse()).collect();
        let servers = servers.map_err(|e| Error::Input(format!("`{urls}` is no list of nats://host:port: {e}")))?;
        let options = match credentials {
            Some(file) => async_nats::ConnectOptions::with_credentials_file(file).await.map_err(Error::read(file))?,
            None => async_nats::ConnectOptions::new(),
        };
        let options = options.name("d3dgen").retry_on_initial_connect();
        let client = options.connect(servers).await.map_err(|e| refused(&e))?;
        Ok(Self { context: jetstream::new(client), settings })
    }

    /// Returns how the queue treats those who take from it.
    pub fn settings(&self) -> QueueSettings {
        self.settings
    }

    async fn stream(&self) -> Result<Stream, Error> {
        let config = Config {
            name: STREAM.into(),
            subjects: vec![format!("{SUBJECT}.>")],
            retention: RetentionPolicy::WorkQueue,
            num_replicas: self.settings.replicas,
            duplicate_window: SAME,
            ..Config::default()
        };
        self.context.get_or_create_stream(config).await.map_err(|e| failed("the queue's stream")(&e))
    }

    /// Opens the place of a run in the queue, made where it is not there.
    ///
    /// # Errors
    /// `Cluster`.
    pub async fn open(&self, run: &str) -> Result<PullConsumer, Error> {
        let s = self.settings;
        let config = pull::Config {
            durable_name: Some(run.to_owned()),
            filter_subject: format!("{SUBJECT}.{run}"),
            ack_policy: AckPolicy::Explicit,
            ack_wait: s.lease,
            // the worker that gets it once more than allowed sets it aside
            max_deliver: i64::from(s.deliveries) + 2,
            max_ack_pending: i64::from(s.in_hand),
            ..pull::Config::default()
        };
        let stream = self.stream().await?;
        stream.get_or_create_consumer(run, config).await.map_err(|e| failed("the queue's consumer")(&e))
    }

    /// Returns the place of a run in the queue; none where it was closed meanwhile.
    ///
    /// # Errors
    /// `Cluster`.
    pub async fn join(&self, run: &str) -> Result<Option<PullConsumer>, Error> {
        Ok(self.stream().await?.get_consumer(run).await.ok())
    }

    /// Closes the place of a run.
    ///
    /// # Errors
    /// `Cluster`.
    pub async fn close(&self, run: &str) -> Result<(), Error> {
        let stream = self.stream().await?;
        let refused = failed("the queue");
        stream.delete_consumer(run).await.map_err(|e| refused(&e))?;
        let purged = stream.purge().filter(format!("{SUBJECT}.{run}")).await;
        purged.map(|_| ()).map_err(|e| refused(&e))
    }

    /// Returns the runs that have a place in the queue, sorted.
    ///
    /// # Errors
    /// `Cluster`.
    pub async fn runs(&self) -> Result<Vec<String>, Error> {
        let names = self.stream().await?.consumer_names().try_collect::<Vec<String>>().await;
        let mut names = names.map_err(|e| failed("the queue's runs")(&e))?;
        names.sort();
        Ok(names)
    }

    /// Puts a block in; `pass` tells a later time from an earlier one, and is one for the same.
    ///
    /// # Errors
    /// `Cluster`.
    pub async fn put(&self, ticket: &Ticket, pass: u64) -> Result<(), Error> {
        let payload = serde_json::to_vec(ticket).expect("it has string keys only");
        let id = format!("{}/{}/{pass}", ticket.run, ticket.block);
        let message = PublishMessage::build().payload(payload.into()).message_id(id);
        let refused = failed("the queue does not take a block");
        let sent =
            self.context.send_publish(format!("{SUBJECT}.{}", ticket.run), message).await.map_err(|e| refused(&e))?;
        sent.await.map(|_| ()).map_err(|e| refused(&e))
    }

    /// Returns how many blocks of a run are in the queue.
    ///
    /// # Errors
    /// `Cluster`.
    pub async fn queued(&self, run: &str) -> Result<Queued, Error> {
        let mut consumer = self.open(run).await?;
        let info = consumer.info().await.map_err(|e| failed("the queue")(&e))?;
        Ok(Queued { waiting: info.num_pending, in_hand: info.num_ack_pending as u64 })
    }
}

/// Takes one block; none when there is none now.
///
/// # Errors
/// `Cluster`.
pub async fn take(consumer: &PullConsumer) -> Result<Option<Message>, Error> {
    let refused = failed("the queue gives nothing");
    let mut batch = consumer.fetch().max_messages(1).expires(WAIT).messages().await.map_err(|e| refused(&e))?;
    batch.next().await.transpose().map_err(|e| refused(&e))
}
